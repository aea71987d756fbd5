#!/usr/bin/env bash
# From a fresh machine to the lowest preheat that fills: installs what is missing, builds, reduces the die once, then casts
# into it at one preheat after the other.
set -euo pipefail
cd "$(dirname "$0")/../.."
. share/setup.sh
setup_run_study examples/preheat-study study.yaml
