#!/usr/bin/env bash
# Installs what is missing, builds, runs all tests, and gathers the validation table.
#   tests/run.sh            the table goes to build/validation.md
#   tests/run.sh --update   and replaces docs/validation.md
set -euo pipefail
cd "$(dirname "$0")/.."
. share/setup.sh
setup_packages
setup_build build
rm -rf build/validation
meson test -C build --no-rebuild --print-errorlogs --num-processes "${TEST_PROCESSES:-2}"
tests/validation/gather.sh build/validation >build/validation.md
[ "${1:-}" != --update ] || cp build/validation.md docs/validation.md
echo "Validation table: build/validation.md"
