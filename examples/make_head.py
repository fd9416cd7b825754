#!/usr/bin/env python3
"""Writes head.obj: a head-like relief over an even (u,v) grid, its vertices in shuffled order.

    python3 make_head.py [-o head.obj]

The face is the front of an ellipsoid, with u from ear to ear and v from chin to crown. Nose, brows,
eye sockets, cheeks and lips are raised or sunk along its normal. The vertex order is shuffled with
a fixed seed: pliant finds the grid from the (u,v) values alone.
"""

import argparse
import math
import pathlib
import random

COLUMNS = 97
ROWS = 121

# Features: (u, v, width along u, width along v, height), heights in units of the head's size (10).
FEATURES = [
    (0.500, 0.460, 0.030, 0.110, 0.55),   # bridge of the nose
    (0.500, 0.385, 0.045, 0.040, 0.85),   # tip of the nose
    (0.450, 0.378, 0.032, 0.028, 0.26),   # wings of the nose
    (0.550, 0.378, 0.032, 0.028, 0.26),
    (0.385, 0.545, 0.062, 0.036, -0.62),  # eye sockets
    (0.615, 0.545, 0.062, 0.036, -0.62),
    (0.385, 0.545, 0.034, 0.021, 0.40),   # eyeballs
    (0.615, 0.545, 0.034, 0.021, 0.40),
    (0.375, 0.607, 0.062, 0.024, 0.42),   # brows
    (0.625, 0.607, 0.062, 0.024, 0.42),
    (0.340, 0.420, 0.080, 0.065, 0.40),   # cheeks
    (0.660, 0.420, 0.080, 0.065, 0.40),
    (0.500, 0.292, 0.075, 0.014, 0.32),   # upper lip
    (0.500, 0.272, 0.080, 0.008, -0.30),  # mouth
    (0.500, 0.252, 0.062, 0.015, 0.36),   # lower lip
    (0.500, 0.160, 0.085, 0.050, 0.60),   # chin
]


def relief(u, v):
    """Height above the ellipsoid at (u,v)."""
    return sum(height * math.exp(-((u - a) / s) ** 2 - ((v - b) / t) ** 2)
               for a, b, s, t, height in FEATURES)


def position(u, v, height=None):
    """A point of the face, of its own height by default; it looks along +z, +y up."""
    around = math.radians(-80 + 160 * u)
    up = math.radians(-62 + 124 * v)
    normal = (math.cos(up) * math.sin(around), math.sin(up), math.cos(up) * math.cos(around))
    # The jaw is narrower than the crown.
    width = 3.7 * (1 - 0.16 * (1 - v) ** 2)
    radii = (width, 5.0, 4.3)
    height = relief(u, v) if height is None else height
    return tuple(radius * n + height * n for radius, n in zip(radii, normal))


def write_head(path):
    order = list(range(COLUMNS * ROWS))
    random.Random(2005).shuffle(order)  # order[k]: the node that is the file's vertex k
    vertex_of = {node: vertex for vertex, node in enumerate(order)}
    lines = ["# Made by make_head.py; vertices in shuffled order."]
    for node in order:
        u, v = node % COLUMNS / (COLUMNS - 1), node // COLUMNS / (ROWS - 1)
        lines.append("v {:.5f} {:.5f} {:.5f}".format(*position(u, v)))
    for node in order:
        u, v = node % COLUMNS / (COLUMNS - 1), node // COLUMNS / (ROWS - 1)
        lines.append(f"vt {u:.8f} {v:.8f}")
    for j in range(ROWS - 1):
        for i in range(COLUMNS - 1):
            first = j * COLUMNS + i
            nodes = (first, first + 1, first + COLUMNS + 1, first + COLUMNS)
            corners = " ".join(f"{vertex_of[n] + 1}/{vertex_of[n] + 1}" for n in nodes)
            lines.append(f"f {corners}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="out", type=pathlib.Path,
                        default=pathlib.Path(__file__).with_name("head.obj"))
    write_head(parser.parse_args().out)
