#!/usr/bin/env bash
# From a fresh machine to a collapsed column: installs what is missing, builds, makes the tank, runs, draws.
set -euo pipefail
cd "$(dirname "$0")/../.."
. share/setup.sh
setup_run_example examples/dam-break
