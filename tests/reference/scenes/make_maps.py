#!/usr/bin/env python3
"""Makes the pictures and numbers of maps.xml and surface_maps.xml."""

import os
import struct
import zlib

import numpy as np

FOLDER = os.path.dirname(os.path.abspath(__file__))


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def write_png(name, pixels, colours):
    """Pixels are height x width x channels, of 8 or 16 bits; each row has a filter of its own."""
    height, width, channels = pixels.shape
    bits = 8 * pixels.dtype.itemsize
    size = channels * bits // 8
    rows, before = b"", np.zeros(width * size, dtype=int)
    for y in range(height):
        row = np.frombuffer(pixels[y].astype(pixels.dtype.newbyteorder(">")).tobytes(),
                            dtype=np.uint8).astype(int)
        kind = y % 3  # none, left, up
        left = np.concatenate([np.zeros(size, dtype=int), row[:-size]])
        rows += bytes([kind]) + bytes(((row - (0, left, before)[kind]) % 256).tolist())
        before = row
    head = struct.pack(">IIBBBBB", width, height, bits, colours, 0, 0, 0)
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) +
                   chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


rng = np.random.default_rng(7)
write_png("map_soft.png", rng.integers(0, 256, (5, 7, 1), dtype=np.uint8), 0)
write_png("map_heavy.png", rng.integers(0, 65536, (6, 4, 3), dtype=np.uint16), 2)
np.save(os.path.join(FOLDER, "map_numbers.npy"), rng.uniform(0, 1, (8, 10)))
