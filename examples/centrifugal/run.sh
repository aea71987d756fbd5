#!/usr/bin/env bash
# From a fresh machine to a tree of cast rings: installs what is missing, builds, reduces the mould, casts, draws.
set -euo pipefail
cd "$(dirname "$0")/../.."
. share/setup.sh
setup_run_example examples/centrifugal
