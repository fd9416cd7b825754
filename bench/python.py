#!/usr/bin/python3
"""Measures what the Python module costs beyond the C++ library:

    PYTHONPATH=build/release/python bench/python.py [ROUNDS] (15 by default)

  copy    float32 positions of 101 x 99 vertices into a given array [us], and beside it NumPy's own
          conversion of an array of that size
  custom  a frame of a scene with a `Custom` force on 101 x 99 nodes less that with a `Point` [ms]
  import  the start of a Python that imports the module less one that imports NumPy [ms]

Medians of rounds, in which both of a pair are measured one after the other.
"""

import statistics
import subprocess
import sys
import time

import numpy as np
import pliant

ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 15
COLUMNS, ROWS = 101, 99


def seconds(work, count=1):
    begin = time.perf_counter()
    for _ in range(count):
        work()
    return (time.perf_counter() - begin) / count


def scene_with(force, end):
    sheet = pliant.Surface("sheet", shape=pliant.Grid(COLUMNS, ROWS, width=20, depth=20), density=40, damping=20)
    return pliant.Scene(end=end, surfaces=[sheet], forces=[force])


def copies():
    poke = pliant.Point("poke", magnitude=900, deformation_radius=30, force_radius=9)
    surface = pliant.Simulation(scene_with(poke, 2)).at(2)["sheet"]
    out = np.empty((COLUMNS * ROWS, 3), np.float32)
    doubles = np.array(surface.object_positions)
    assert (surface.positions(out=out) == doubles.astype(np.float32)).all()
    return seconds(lambda: surface.positions(out=out), 200), seconds(lambda: np.copyto(out, doubles, casting="same_kind"), 200)


def frames():
    end = 13

    def frame_of(force):
        simulation = pliant.Simulation(scene_with(force, end))
        simulation.at(1)
        return seconds(lambda: simulation.at(end)) / (end - 1)

    def push(points, time):
        distance = np.linalg.norm(points, axis=1)
        force = np.zeros_like(points)
        force[:, 1] = np.where(distance < 9, 1.0, 0.0)
        return force

    reach = {"magnitude": 900, "deformation_radius": 30, "force_radius": 9}
    return frame_of(pliant.Custom("push", push, **reach)), frame_of(pliant.Point("poke", **reach))


def starts():
    return tuple(seconds(lambda: subprocess.run([sys.executable, "-c", f"import {name}"], check=True))
                 for name in ("pliant", "numpy"))  # fmt: skip


def main():
    print(f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pliant {pliant.__version__}")
    own, numpy = zip(*(copies() for _ in range(ROUNDS)))
    ratio = statistics.median(a / b for a, b in zip(own, numpy))
    print(f"copy    {1e6 * statistics.median(own):6.1f} us, {ratio:.2f} of NumPy's own")
    custom, point = zip(*(frames() for _ in range(ROUNDS)))
    more = statistics.median(a - b for a, b in zip(custom, point))
    print(f"custom  {1e3 * more:6.2f} ms more a frame than {1e3 * statistics.median(point):.2f} ms")
    pliant_start, numpy_start = zip(*(starts() for _ in range(ROUNDS)))
    more = statistics.median(a - b for a, b in zip(pliant_start, numpy_start))
    print(f"import  {1e3 * more:6.1f} ms beyond NumPy's {1e3 * statistics.median(numpy_start):.0f} ms")


main()
