#!/usr/bin/env python3
"""Writes pillow.ply: a pillow of quads, thick in the middle. Its property `under` is 1 on its lower side.

    python3 make_pillow.py [-o pillow.ply]
"""

from make_buttons import sewn, write

COLUMNS, ROWS = 54, 36  # cells
WIDTH, DEPTH, THICK = 6.0, 4.0, 1.6


def place(i, j, side):
    x, z = 2 * i / COLUMNS - 1, 2 * j / ROWS - 1
    height = 0.3 * THICK if side < 0 else 0.7 * THICK
    height *= ((1 - x ** 4) * (1 - z ** 4)) ** 0.5
    # The sides are drawn in between the corners.
    return WIDTH / 2 * x * (1 - 0.07 * (1 - z * z)), side * height, DEPTH / 2 * z * (1 - 0.09 * (1 - x * x))


if __name__ == "__main__":
    write(__file__, __doc__, "under", sewn(COLUMNS, ROWS, place, lambda i, j, side: side < 0))
