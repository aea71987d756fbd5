#!/bin/sh
# Reduce the block with given patches and elements, and say what it took.
#   run.sh CASTREDUCE FOLDER PATCH_SIZE MESH_SIZE [RANKS]     sizes in mm
# In FOLDER: mould.yaml, the ROM file, its log, and `time`: what the system counted.
set -e
here=$(cd "$(dirname "$0")" && pwd)
castreduce=$1 folder=$2 patch=$3 mesh=$4 ranks=${5:-1}
mkdir -p "$folder"
cp "$here/block.geo" "$folder/"
cat >"$folder/mould.yaml" <<EOF
title: block, patches of $patch mm, elements of $mesh mm at the cavity
geometry: { file: block.geo, unit: mm }
regions: { investment: { material: phosphate-bonded } }
boundaries: { outside: { type: robin, h: 15 W/m^2/K } }
cavity: { surfaces: { cavity: { patch_size: $patch mm, mesh_size: $mesh mm } } }
mesh: { outside_size: 8 mm, growth: ${GROWTH:-0.2} }
reduction: { times: [1 ms, 100 s], tolerance: 1e-3 ${MORE:+, $MORE} }
output: { file: mould.rom.h5, band: 0.1 mm }
EOF
cd "$folder"
if [ "$ranks" -gt 1 ]; then set -- mpiexec -n "$ranks" "$castreduce"; else set -- "$castreduce"; fi
/usr/bin/time -v -o time "$@" run mould.yaml
