"""Bakes an example and checks what must be true for every one: it starts at rest, moves visibly
within its size, stays finite, and does not jump between neighbouring frames. Of an animated shape
this is true for the displacement from it.

usage: example_test.py PLIANT SCENE.xml
"""

import os
import subprocess
import sys
import tempfile

import numpy as np

from shapes import without_cache


def check(frames):
    rest = frames[0]
    size = np.linalg.norm(np.ptp(rest, axis=0))
    motion = np.linalg.norm(frames - rest, axis=2)
    assert np.isfinite(frames).all(), "a position is not finite"
    assert motion[0].max() == 0, "the first frame is not at rest"
    assert motion.max() > 0.01 * size, f"the peak {motion.max():.3g} is hardly seen at size {size:.3g}"
    assert motion.max() < 0.5 * size, f"the peak {motion.max():.3g} is out of scale at size {size:.3g}"
    steps = np.linalg.norm(np.diff(frames, axis=0), axis=2).max(axis=1)
    assert steps.max() < 0.4 * motion.max(), "the motion jumps from one frame to the next"
    # The peak is before the end: then it rings and settles, or at least decreases.
    assert motion[-1].max() < 0.9 * motion.max(), "the animation ends at its peak"


def main():
    pliant, scene = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([pliant, "bake", scene, "-o", os.path.join(folder, "a.npy")], check=True)
        for name in sorted(os.listdir(folder)):
            surface = name[2:-4] if name != "a.npy" else 0  # a-NAME.npy: one of several
            frames = without_cache(scene, surface, np.load(os.path.join(folder, name)))
            check(frames)
            print(f"ok {name}: {frames.shape[0]} frames, {frames.shape[1]} vertices")


if __name__ == "__main__":
    main()
