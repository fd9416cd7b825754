#!/usr/bin/env python3
"""Writes cushion.obj: the cage of a cushion, a closed box of quads without UVs, thick in the middle.

    python3 make_cushion.py [-o cushion.obj]
"""

import argparse
import pathlib

CELLS = 14  # along each side


def write_cushion(path):
    lines = ["# Made by make_cushion.py."]
    numbers = {}

    def vertex(i, j, side):
        at_rim = i in (0, CELLS) or j in (0, CELLS)
        key = (i, j, 0 if at_rim else side)
        if key not in numbers:
            x, z = 2 * i / CELLS - 1, 2 * j / CELLS - 1
            # The sides curve inwards between the corners, where cloth is short.
            pull = 0.1 * (1 - x * x) * z * z, 0.1 * (1 - z * z) * x * x
            height = 0 if at_rim else 1.3 * ((1 - x ** 4) * (1 - z ** 4)) ** 0.5
            numbers[key] = len(numbers) + 1
            lines.append(f"v {5 * x * (1 - pull[1]):.5f} {side * height:.5f} {5 * z * (1 - pull[0]):.5f}")
        return numbers[key]

    faces = []
    for side in (1, -1):
        for j in range(CELLS):
            for i in range(CELLS):
                corners = [vertex(*p, side) for p in ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j))]
                faces.append("f " + " ".join(map(str, corners[::side])))
    path.write_text("\n".join(lines + faces) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="out", type=pathlib.Path,
                        default=pathlib.Path(__file__).with_name("cushion.obj"))
    write_cushion(parser.parse_args().out)
