#!/usr/bin/env python3
"""Writes mask.obj: the face of head.obj without its relief, as a coarse even grid; a cage for it.

    python3 make_mask.py [-o mask.obj]
"""

import argparse
import pathlib

from make_head import position

COLUMNS, ROWS = 33, 41


def write_mask(path):
    places = [(i / (COLUMNS - 1), j / (ROWS - 1)) for j in range(ROWS) for i in range(COLUMNS)]
    lines = ["# Made by make_mask.py."]
    lines += ["v {:.5f} {:.5f} {:.5f}".format(*position(u, v, 0)) for u, v in places]
    lines += [f"vt {u:.8f} {v:.8f}" for u, v in places]
    for j in range(ROWS - 1):
        for i in range(COLUMNS - 1):
            a = j * COLUMNS + i + 1
            lines.append("f " + " ".join(f"{k}/{k}" for k in (a, a + 1, a + COLUMNS + 1, a + COLUMNS)))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="out", type=pathlib.Path,
                        default=pathlib.Path(__file__).with_name("mask.obj"))
    write_mask(parser.parse_args().out)
