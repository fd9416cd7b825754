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


def is_button(i, j):
    return any(abs(i - a) + abs(j - b) <= 1 for a in BUTTONS for b in BUTTONS)


def sewn(columns, rows, place, is_marked):
    """Two sides of quads, sewn together at their rims: vertices, faces, and 1 for each vertex at the seam or
    where `is_marked` of its column, row and side, 1 or -1. `place` has side 0 at the seam."""
    vertices, marks, faces, numbers = [], [], [], {}

    def at(i, j, side):
        is_seam = i in (0, columns) or j in (0, rows)
        key = i, j, 0 if is_seam else side
        if key not in numbers:
            numbers[key] = len(vertices)
            vertices.append(place(*key))
            marks.append(int(is_seam or is_marked(i, j, side)))
        return numbers[key]

    for side in (1, -1):
        for j in range(rows):
            for i in range(columns):
                corners = (i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)
                faces.append([at(*corner, side) for corner in corners[::side]])
    return vertices, faces, marks


def write(script, description, name, mesh):
    """Writes vertices, faces and marks, as the property `name`, to the file after -o; without it to NAME.ply
    beside the script make_NAME.py."""
    script = pathlib.Path(script)
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", type=pathlib.Path,
                        default=script.with_name(script.stem.removeprefix("make_") + ".ply"))
    vertices, faces, marks = mesh
    with parser.parse_args().out.open("w", encoding="utf-8") as file:
        file.write(f"ply\nformat ascii 1.0\ncomment made by {script.name}\n"
                   f"element vertex {len(vertices)}\n"
                   f"property double x\nproperty double y\nproperty double z\nproperty uchar {name}\n"
                   f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        for (x, y, z), mark in zip(vertices, marks):
            file.write(f"{x:.5f} {y:.5f} {z:.5f} {mark}\n")
        for face in faces:
            file.write(f"{len(face)} {' '.join(map(str, face))}\n")


if __name__ == "__main__":
    write(__file__, __doc__, "stitched", sewn(CELLS, CELLS, place, lambda i, j, side: is_button(i, j)))
