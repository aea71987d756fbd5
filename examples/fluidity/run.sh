#!/usr/bin/env bash
# From a fresh machine to flow lengths: installs what is missing, builds, reduces the die once, casts at two preheats and two
# pouring temperatures, draws, and puts the lengths beside Flemings' formula.
set -euo pipefail
cd "$(dirname "$0")/../.."
. share/setup.sh
setup_run_study examples/fluidity grid.yaml
echo
./flemings.sh study
