#!/usr/bin/env bash
# From a fresh machine to pins cast at two preheats: installs what is missing, builds, reduces the mould once, casts at 700 and
# at 900 degC, draws, and prints what stayed empty.
set -euo pipefail
cd "$(dirname "$0")/../.."
. share/setup.sh
export OMP_WAIT_POLICY=passive
setup_packages
setup_build build
build=$PWD/build
cd examples/microcast
"$build/reduce/castreduce" run mould.yaml
for preheat in 700 900; do
  "$build/cast/castrun" run cast.yaml --set "preheat=$preheat degC" --set "output.folder=at-$preheat"
  "$build/cast/castrun" draw "at-$preheat"
done
for preheat in 700 900; do
  echo
  echo "Mould at $preheat degC:"
  sed -n '/^Soundness/,/^  part/p' "at-$preheat/summary.txt"
done
echo
echo "Pictures: $PWD/at-700/filling.png and curves.png, and those of at-900"
