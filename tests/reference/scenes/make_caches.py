#!/usr/bin/env python3
"""Writes the caches of cache.xml and cache_surface.xml beside this file: shapes that wave, drift and
turn, each in one of the formats.

    python3 make_caches.py
"""

import os
import struct
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))

from scene import flat_grid  # noqa: E402
from triangle_mesh import read_obj_corners  # noqa: E402


def waved(vertices, time, height):
    """The vertices at a time: a wave runs through them while they drift and turn slowly."""
    size = np.ptp(vertices, axis=0).max()
    x, y, z = (vertices / size).T
    wave = height * size * np.sin(5.1 * x - 3.3 * z + 2 * y + 0.9 * time)
    moved = vertices + np.stack([0.3 * wave, wave, -0.2 * wave], axis=1)
    angle = 0.03 * time + 0.002 * time**2
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    drift = size * np.array([0.013 * time, 0.004 * time**2, -0.007 * time])
    return (moved @ turn.T + drift).astype("<f4")


def write(name, samples, first=1.0, rate=1.0, fps=24.0):
    samples = np.array(samples)
    count, vertices, _ = samples.shape
    path = os.path.join(HERE, name)
    if name.endswith(".npy"):
        np.save(path, samples)
        return
    with open(path, "wb") as file:
        if name.endswith(".pc2"):
            file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, vertices, first, rate, count))
            file.write(samples.tobytes())
        else:
            file.write(struct.pack(">ii", count, vertices))
            file.write((np.arange(count) * rate / fps).astype(">f4").tobytes())
            file.write(samples.astype(">f4").tobytes())


def main():
    sheet = flat_grid({"columns": "11", "rows": "9", "width": "5", "depth": "4"}).vertices
    relief, _ = read_obj_corners(os.path.join(HERE, "relief.obj"))
    octahedron, _ = read_obj_corners(os.path.join(HERE, "octahedron.obj"))
    lattice, _ = read_obj_corners(os.path.join(HERE, "lattice.obj"))
    write("cache_sheet.pc2", [waved(sheet, k, 0.05) for k in range(9)], first=2.5, rate=1.5)
    write("cache_relief.npy", [waved(relief, k, 0.04) for k in range(7)])
    write("cache_octahedron.mdd", [waved(octahedron, 0.5 * k, 0.03) for k in range(12)], rate=1.0, fps=25.0)
    write("cache_lattice.npy", [waved(lattice, k, 0.02) for k in range(15)])


if __name__ == "__main__":
    main()
