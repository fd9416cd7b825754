#!/usr/bin/env python3
"""Writes balloon.obj: a closed balloon of triangles with a neck, without UVs.

    python3 make_balloon.py [-o balloon.obj]
"""

import math

import obj_file

RINGS, AROUND = 26, 36  # ring k from the top, the poles apart
WIDTH, HEIGHT = 1.0, 1.3
NECK = 0.16  # how far the neck is drawn out


def place(k, n):
    """A vertex of ring k: of an ellipsoid, drawn out downwards near its lower pole."""
    down = math.pi * k / (RINGS + 1)
    turn = 2 * math.pi * (n + 0.5 * (k % 2)) / AROUND
    out, up = math.sin(down), math.cos(down)
    narrow = 1 - 0.25 * math.exp(-(((1 + up) / 0.35) ** 2))
    drop = NECK * math.exp(-(((1 + up) / 0.12) ** 2))
    return WIDTH * out * narrow * math.cos(turn), HEIGHT * up - drop, WIDTH * out * narrow * math.sin(turn)


def balloon():
    vertices = [(0, HEIGHT, 0)] + [place(k, n) for k in range(1, RINGS + 1) for n in range(AROUND)]
    vertices.append((0, -HEIGHT - NECK, 0))

    def at(k, n):
        return 1 + (k - 1) * AROUND + n % AROUND

    faces = [(0, at(1, n + 1), at(1, n)) for n in range(AROUND)]
    for k in range(1, RINGS):
        for n in range(AROUND):
            a, b = at(k, n), at(k, n + 1)
            # Odd rings are turned by half a step.
            c, d = at(k + 1, n + k % 2), at(k + 1, n + 1 + k % 2)
            if k % 2:
                faces += [(a, b, c), (a, c, at(k + 1, n))]
            else:
                faces += [(a, b, c), (b, d, c)]
    last = len(vertices) - 1
    faces += [(last, at(RINGS, n), at(RINGS, n + 1)) for n in range(AROUND)]
    return vertices, faces


def main():
    obj_file.write(obj_file.chosen_file(__file__, __doc__), "balloon", *balloon())


if __name__ == "__main__":
    main()
