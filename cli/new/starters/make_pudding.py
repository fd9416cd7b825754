#!/usr/bin/python3
"""Writes pudding.obj, the mesh of the starters `mesh` and `jiggle`: a pudding of 1.6 units height
with a rounded top, without (u,v), in 18 rings of 40 vertices. Its lowest ring is its border.

usage: make_pudding.py OUT.obj
"""

import math
import sys

RINGS, SIDES = 18, 40


def outline(s):
    """Radius and height along the side, s from 0 at the foot to 1 at the middle of the top."""
    # A cone whose upper edge is round: a power of a circle's arc.
    angle = s * math.pi / 2
    radius = math.cos(angle) ** 0.45
    height = math.sin(angle) ** 0.8
    return 1.5 * radius * (1 - 0.25 * height), 1.6 * height


def main():
    vertices, faces = [], []
    for ring in range(RINGS):
        radius, height = outline((ring / RINGS) ** 0.9)
        for side in range(SIDES):
            angle = 2 * math.pi * side / SIDES
            vertices.append((radius * math.sin(angle), height, radius * math.cos(angle)))
    vertices.append((0, 1.6, 0))
    for ring in range(RINGS - 1):
        for side in range(SIDES):
            a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
            faces.append((a, b, b + SIDES, a + SIDES))
    last = (RINGS - 1) * SIDES
    for side in range(SIDES):
        faces.append((last + side, last + (side + 1) % SIDES, len(vertices) - 1))
    with open(sys.argv[1], "w", encoding="utf-8", newline="\n") as file:
        file.write("# made by make_pudding.py\no pudding\n")
        file.writelines(f"v {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in vertices)
        file.writelines("f " + " ".join(str(k + 1) for k in face) + "\n" for face in faces)


if __name__ == "__main__":
    main()
