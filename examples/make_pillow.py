#!/usr/bin/env python3
"""Writes pillow.ply: a pillow of quads, thick in the middle. Its property `under` is 1 on its lower side.

    python3 make_pillow.py [-o pillow.ply]
"""

import argparse
import pathlib

COLUMNS, ROWS = 54, 36  # cells
WIDTH, DEPTH, THICK = 6.0, 4.0, 1.6


def place(i, j, side):
    x, z = 2 * i / COLUMNS - 1, 2 * j / ROWS - 1
    height = 0.3 * THICK if side < 0 else 0.7 * THICK
    height *= ((1 - x ** 4) * (1 - z ** 4)) ** 0.5
    # The sides are drawn in between the corners.
    return WIDTH / 2 * x * (1 - 0.07 * (1 - z * z)), side * height, DEPTH / 2 * z * (1 - 0.09 * (1 - x * x))


def pillow():
    vertices, under, faces, numbers = [], [], [], {}

    def at(i, j, side):
        is_seam = i in (0, COLUMNS) or j in (0, ROWS)
        key = i, j, 1 if is_seam else side
        if key not in numbers:
            numbers[key] = len(vertices)
            vertices.append(place(i, j, side))
            under.append(int(is_seam or side < 0))
        return numbers[key]

    for side in (1, -1):
        for j in range(ROWS):
            for i in range(COLUMNS):
                corners = (i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)
                faces.append([at(*corner, side) for corner in corners[::side]])
    return vertices, under, faces


def write(out):
    vertices, under, faces = pillow()
    with out.open("w", encoding="utf-8") as file:
        file.write("ply\nformat ascii 1.0\ncomment made by make_pillow.py\n"
                   f"element vertex {len(vertices)}\n"
                   "property double x\nproperty double y\nproperty double z\nproperty uchar under\n"
                   f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        for (x, y, z), value in zip(vertices, under):
            file.write(f"{x:.5f} {y:.5f} {z:.5f} {value}\n")
        for face in faces:
            file.write(f"{len(face)} {' '.join(map(str, face))}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", type=pathlib.Path, default=pathlib.Path(__file__).with_name("pillow.ply"))
    write(parser.parse_args().out)


if __name__ == "__main__":
    main()
