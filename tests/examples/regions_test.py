"""Bakes an example of regions and checks the statements of its comment.

usage: regions_test.py PLIANT EXAMPLES_FOLDER hands|finger
"""

import json
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

PLIANT, EXAMPLES = (os.path.abspath(argument) for argument in sys.argv[1:3])


def bake(name, *changes, warns=""):
    """{surface: frames x rows x columns x 3}, displacements, and the output of --regions. `warns`: words of its one
    warning; without, there is none."""
    with open(os.path.join(EXAMPLES, name + ".xml"), encoding="utf-8") as file:
        text = file.read()
    for pattern, new in changes:
        text, count = re.subn(pattern, new, text, flags=re.DOTALL)
        assert count == 1, f"{name} has {count} of {pattern}"
    with tempfile.TemporaryDirectory() as folder:
        scene, out, regions = (os.path.join(folder, file) for file in ("a.xml", "o.npy", "r.json"))
        with open(scene, "w", encoding="utf-8") as file:
            file.write(text)
        run = subprocess.run([PLIANT, "bake", scene, "-o", out, "--regions", regions], check=True,
                             stderr=subprocess.PIPE, text=True)
        assert run.stderr.count("warning: ") == bool(warns) and warns in run.stderr, run.stderr
        with open(regions, encoding="utf-8") as file:
            told = json.load(file)["frames"]
        sizes = {surface: (int(rows), int(columns)) for surface, columns, rows in re.findall(
            r'<surface name="(\w+)">\s*<grid columns="(\d+)" rows="(\d+)"', text)}
        moved = {}
        for surface, (rows, columns) in sizes.items():
            file = out if len(sizes) == 1 else out.replace(".npy", f"-{surface}.npy")
            frames = np.load(file).reshape(-1, rows, columns, 3)
            moved[surface] = frames - frames[0]
    return moved, told


def hands():
    moved, told = bake("hands")
    moved = moved["membrane"]
    half = moved.shape[2] // 2
    left, right = moved[:, :, :half], moved[:, :, half:]
    for frame in told:
        assert len(frame["surfaces"][0]["regions"]) == 2, "not two islands"
    # Each hand has exactly the bits of a run with it alone; the sheet between them stays flat.
    alone, _ = bake("hands", (r'<point name="right".*?</point>', ""))
    assert np.array_equal(alone["membrane"][:, :, :half], left)
    assert not alone["membrane"][:, :, half:].any(), "the left hand moves the right half"
    alone, _ = bake("hands", (r'<point name="left".*?</point>', ""))
    assert np.array_equal(alone["membrane"][:, :, half:], right)
    first, second = (frame["surfaces"][0]["regions"] for frame in (told[0], told[-1]))
    assert first == second
    between = slice(first[0]["box"]["columns"][1], first[1]["box"]["columns"][0] + 1)
    assert not moved[:, :, between].any(), "the sheet between the hands moves"
    # The left hand presses down, and the sheet rings after it lets go; the right one, later,
    # presses up; then both.
    low, high = left[..., 1].min(axis=(1, 2)), left[..., 1].max(axis=(1, 2))
    assert low[17] < -0.3 and high[17] < 0.05 and high[23:30].max() > 0.03, "the left hand"
    assert not right[:24].any() and right[36, ..., 1].max() > 0.3, "the right hand"
    assert low[59] < -0.2 and right[59, ..., 1].max() > 0.2, "both hands"


def finger():
    moved, told = bake("finger", warns="\"clay\" is frozen while it moves")
    rubber, clay = moved["rubber"][..., 1], moved["clay"][..., 1]
    columns = rubber.shape[2]
    peak = np.abs(rubber).max()
    assert 0.3 < peak < 2 and np.abs(clay).max() > 0.3, "a dent that is no picture"
    # The dents travel with the finger.
    for frame in (16, 28, 40):
        finger_at = (told[frame]["surfaces"][0]["forces"][0]["center"][0] / 20 + 0.5) * (columns - 1)
        for dent in (rubber[frame], clay[frame]):
            deepest = np.unravel_index(dent.argmin(), dent.shape)[1]
            assert abs(deepest - finger_at) < 4, f"frame {frame}: deepest at column {deepest}"
    # Where the finger began, the rubber has closed while the finger still moves; the clay has not.
    start = slice(8, 14)
    assert np.abs(rubber[44, :, start]).max() < 0.05 * np.abs(rubber[:, :, start]).max()
    assert np.abs(clay[44, :, start]).max() > 5 * np.abs(rubber[44, :, start]).max()
    # After lifting, the rubber is exactly at rest before the end; the trail stays.
    assert (moved["rubber"][90:] == 0).all(), "the rubber is not at rest"
    assert (clay[50:] == clay[50]).all() and np.abs(clay[50]).max() > 0.5 * np.abs(clay).max()
    # The counts that --regions reports.
    recovering = [frame["surfaces"][0]["recovering"] for frame in told]
    assert recovering[0] == 0 and max(recovering) > 100 and recovering[-1] == 0
    assert all(frame["surfaces"][1]["recovering"] == 0 for frame in told)
    assert not told[-1]["surfaces"][0]["solved"]


if __name__ == "__main__":
    {"hands": hands, "finger": finger}[sys.argv[3]]()
    print(f"ok {sys.argv[3]}")
