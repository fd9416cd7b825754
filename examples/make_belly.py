#!/usr/bin/env python3
"""Writes belly.obj: the front of a round body, open where the rest of it would be; rings of triangles
around the navel, without UVs.

    python3 make_belly.py [-o belly.obj]
"""

import math

import obj_file

RINGS = 15  # ring k has 6 k vertices
WIDTH, HEIGHT, DEPTH = 1.5, 1.75, 1.35


def place(k, angle):
    """A vertex of ring k: on an oval seen from the front, deeper below the navel than above."""
    s = k / RINGS
    x, y = WIDTH * s * math.cos(angle), HEIGHT * s * math.sin(angle)
    deep = DEPTH * math.sqrt(max(0.0, 1 - s * s))
    navel = -0.16 * math.exp(-((s / 0.1) ** 2))
    return x, y - 0.28 * deep, deep + navel


def belly():
    vertices = [place(0, 0)]
    faces = []
    first_inner, inner = 0, 1
    for k in range(1, RINGS + 1):
        first, count = len(vertices), 6 * k
        vertices += [place(k, 2 * math.pi * n / count) for n in range(count)]
        for sixth in range(6):
            for n in range(k):
                a = first + (sixth * k + n)
                b = first + (sixth * k + n + 1) % count
                c = first_inner + (sixth * (k - 1) + n) % inner
                faces.append((a, b, c))
                if n + 1 < k:
                    d = first_inner + (sixth * (k - 1) + n + 1) % inner
                    faces.append((b, d, c))
        first_inner, inner = first, count
    return vertices, faces


def main():
    obj_file.write(obj_file.chosen_file(__file__, __doc__), "belly", *belly())


if __name__ == "__main__":
    main()
