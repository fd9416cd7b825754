#!/usr/bin/env python3
"""Writes soft.png: a map whose left half is black and whose right half is white, with a wavy border.

    python3 make_soft.py [-o soft.png]
"""

import argparse
import math
import pathlib
import struct
import zlib

SIDE = 64  # pixels


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def write_map(path):
    rows = b""
    for y in range(SIDE):
        rows += b"\0"  # no filter
        for x in range(SIDE):
            u, v = (x + 0.5) / SIDE, 1 - (y + 0.5) / SIDE
            across = (u - 0.5 - 0.06 * math.sin(2 * math.pi * v)) / 0.1
            share = min(1.0, max(0.0, 0.5 + across))
            rows += bytes([round(255 * share * share * (3 - 2 * share))])
    head = struct.pack(">IIBBBBB", SIDE, SIDE, 8, 0, 0, 0, 0)
    # Not compressed, so that each zlib writes the same bytes.
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) +
                     chunk(b"IDAT", zlib.compress(rows, 0)) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = pathlib.Path(__file__).with_name("soft.png")
    parser.add_argument("-o", dest="path", type=pathlib.Path, default=default)
    write_map(parser.parse_args().path)


if __name__ == "__main__":
    main()
