#!/usr/bin/env bash
# Gather the rows that the validation tests wrote (one file a case) into one table.
#   gather.sh FOLDER >validation.md
set -euo pipefail
cat <<'TEXT'
# Validation

Each row was written by the test that ran the case (`tests/validation`, `tests/run.sh --update`). "Error" is the error it
really has, at the resolution stated; a miss of the target stays in the table as a miss. CPU times are of a 2-core virtual
machine under varying load.

| case | quantity | reference | ours | error | target | resolution | CPU s |
|---|---|---|---|---|---|---|---|
TEXT
find "$1" -name '*.md' -print0 | LC_ALL=C sort -zV | xargs -0 -r cat
