#!/usr/bin/env bash
# From a fresh machine to a filled casting: installs what is missing, builds, reduces the mould, casts, draws.
set -euo pipefail
export OMP_WAIT_POLICY=passive # waiting threads sleep: kinder, and on a shared machine much faster
cd "$(dirname "$0")/../.."
. share/setup.sh
setup_packages
setup_build build
cd examples/quickstart
../../build/reduce/castreduce run mould.yaml
../../build/cast/castrun run cast.yaml
../../build/cast/castrun draw results
echo
echo "Results:  $PWD/results   (results.xmf and mould.xmf open in ParaView)"
echo "Picture:  $PWD/results/filling.png"
echo "Summary:  $PWD/results/summary.txt"
