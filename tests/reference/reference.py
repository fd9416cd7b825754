#!/usr/bin/env python3
"""Bakes a scene with the slow reference implementation of the specification (SPEC 1-7).

    python3 reference.py SCENE.xml -o OUT.npy [--frames A:B] [--space world|object]

writes float64 frames x vertices x 3, one file per surface (OUT-NAME.npy) when there are several.
"""

import argparse
import sys

import numpy as np

from bakes import bake
from diagnostics import Diagnostics
from scene import Scene


def output_path(path, scene, name):
    """OUT.npy, or OUT-NAME.npy when the scene has several surfaces (docs/command.md)."""
    if len(scene.surfaces) == 1:
        return path
    return f"{path[:-len('.npy')]}-{name}.npy"


def frame_slice(scene, text):
    """The part of a run that `--frames A:B` (ends included) asks for."""
    if text is None:
        return slice(None)
    first, last = (int(word) for word in text.split(":"))
    assert scene.start <= first <= last <= scene.end
    return slice(first - scene.start, last - scene.start + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True, metavar="OUT.npy")
    parser.add_argument("--frames", metavar="A:B")
    parser.add_argument("--space", choices=("world", "object"), default="world")
    arguments = parser.parse_args()
    assert arguments.output.endswith(".npy"), "the output is an .npy file"

    scene = Scene(arguments.scene)
    frames = frame_slice(scene, arguments.frames)
    diagnostics = Diagnostics()
    for name, result in bake(scene, diagnostics).items():
        positions = result.world if arguments.space == "world" else result.object
        np.save(output_path(arguments.output, scene, name), positions[frames])
        print(f"{name}: {len(positions[frames])} frames, {positions.shape[1]} vertices, "
              f"peak displacement {result.peak():.6g}")
    print(f"{len(diagnostics.solves)} solves, {len(diagnostics.skips)} frames without one, "
          f"{diagnostics.exact_ties} exact ties, tie margin {diagnostics.tie_margin:.3g}")


if __name__ == "__main__":
    sys.exit(main())
