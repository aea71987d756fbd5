"""Read a ROM file with h5py: python3 read_rom.py mould.rom.h5"""
import sys
import h5py
import numpy as np

with h5py.File(sys.argv[1]) as rom:
    rates, B = rom["model/lambda"][:], rom["model/B"][:]            # 1/s [r], sqrt(K/J) [r x m]
    names = rom["patches/name"][:].astype(str)
    t = 1.0                                                         # 1 W into the first patch for t seconds
    growth = np.where(rates > 1e-12, -np.expm1(-rates * t) / np.maximum(rates, 1e-12), t)
    for name, rise in zip(names, B.T @ (growth * B[:, 0])):
        print(f"{name:16s} {rise:.4g} K")
