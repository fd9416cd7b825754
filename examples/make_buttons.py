#!/usr/bin/env python3
"""Writes buttons.ply: a flat cushion of quads with a round rim. Its property `stitched` is 1 at the seam and
at nine buttons on each side, 0 elsewhere.

    python3 make_buttons.py [-o buttons.ply]
"""

import argparse
import math
import pathlib

CELLS = 40  # along each side
WIDTH, THICK = 4.0, 0.5
BUTTONS = (10, 20, 30)  # columns and rows


def place(i, j, side):
    # Denser towards the rim, where the cushion is round.
    x, z = (0.65 * s + 0.35 * math.sin(math.pi / 2 * s) for s in (2 * i / CELLS - 1, 2 * j / CELLS - 1))
    height = THICK / 2 * math.sqrt((1 - x ** 6) * (1 - z ** 6))
    # The sides are drawn in between the corners.
    return WIDTH / 2 * x * (1 - 0.06 * (1 - z * z)), side * height, WIDTH / 2 * z * (1 - 0.06 * (1 - x * x))


def cushion():
    vertices, stitched, faces, numbers = [], [], [], {}

    def at(i, j, side):
        is_seam = i in (0, CELLS) or j in (0, CELLS)
        key = i, j, 0 if is_seam else side
        if key not in numbers:
            numbers[key] = len(vertices)
            vertices.append(place(i, j, 0 if is_seam else side))
            is_button = any(abs(i - a) + abs(j - b) <= 1 for a in BUTTONS for b in BUTTONS)
            stitched.append(int(is_seam or is_button))
        return numbers[key]

    for side in (1, -1):
        for j in range(CELLS):
            for i in range(CELLS):
                corners = (i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)
                faces.append([at(*corner, side) for corner in corners[::side]])
    return vertices, stitched, faces


def write(out):
    vertices, stitched, faces = cushion()
    with out.open("w", encoding="utf-8") as file:
        file.write("ply\nformat ascii 1.0\ncomment made by make_buttons.py\n"
                   f"element vertex {len(vertices)}\n"
                   "property double x\nproperty double y\nproperty double z\nproperty uchar stitched\n"
                   f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        for (x, y, z), value in zip(vertices, stitched):
            file.write(f"{x:.5f} {y:.5f} {z:.5f} {value}\n")
        for face in faces:
            file.write(f"{len(face)} {' '.join(map(str, face))}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", type=pathlib.Path, default=pathlib.Path(__file__).with_name("buttons.ply"))
    write(parser.parse_args().out)


if __name__ == "__main__":
    main()
