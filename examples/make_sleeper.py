#!/usr/bin/env python3
"""Writes sleeper.obj: the head of bust.obj, closed below the neck as a collider must be, of even triangles and
without UVs.

    python3 make_sleeper.py [-o sleeper.obj]
"""

import obj_file
from make_bust import icosphere, position

LEVELS = 4


def main():
    out = obj_file.chosen_file(__file__, __doc__)
    directions, triangles = icosphere(LEVELS)
    obj_file.write(out, "sleeper", [position(direction) for direction in directions], triangles)


if __name__ == "__main__":
    main()
