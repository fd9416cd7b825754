#!/usr/bin/env python3
"""Writes vase.obj: a vase without a bottom, closed along u, over an even (u,v) grid.

    python3 make_vase.py [-o vase.obj]

The vertices of its seam are there once and have two (u,v), as most programs store them.
"""

import argparse
import math
import pathlib

COLUMNS, ROWS = 64, 49  # nodes round it, and from the foot to the lip
HEIGHT = 6.0


def radius(v):
    """Foot, belly, neck and lip."""
    return 1.15 + 0.75 * math.sin(math.pi * min(1.0, 1.25 * v)) ** 2 - 0.45 * math.exp(-((v - 0.84) / 0.13) ** 2)


def write_vase(path):
    lines = ["# Made by make_vase.py; closed along u."]
    for j in range(ROWS):
        v = j / (ROWS - 1)
        for i in range(COLUMNS):
            angle = 2 * math.pi * i / COLUMNS
            # Clockwise from above, so that its faces look outwards.
            lines.append(f"v {radius(v) * math.sin(angle):.5f} {HEIGHT * v:.5f} {radius(v) * math.cos(angle):.5f}")
    for j in range(ROWS):
        lines += [f"vt {i / COLUMNS:.8f} {j / (ROWS - 1):.8f}" for i in range(COLUMNS + 1)]
    for j in range(ROWS - 1):
        for i in range(COLUMNS):
            corners = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            lines.append("f " + " ".join(
                f"{q * COLUMNS + p % COLUMNS + 1}/{q * (COLUMNS + 1) + p + 1}" for p, q in corners))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="out", type=pathlib.Path,
                        default=pathlib.Path(__file__).with_name("vase.obj"))
    write_vase(parser.parse_args().out)
