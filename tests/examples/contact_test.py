"""Bakes an example with colliders and checks what its comment says.

usage: contact_test.py PLIANT EXAMPLES NAME
"""

import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

import numpy as np

PLIANT, EXAMPLES = (os.path.abspath(argument) for argument in sys.argv[1:3])
NAME = sys.argv[3]
sys.path.append(EXAMPLES)


def bake():
    """The vertices of the surface at all frames, and for each collider its forces and numbers of nodes."""
    with tempfile.TemporaryDirectory() as folder:
        out, report = os.path.join(folder, "a.npy"), os.path.join(folder, "a.json")
        subprocess.run([PLIANT, "bake", os.path.join(EXAMPLES, NAME + ".xml"), "-o", out, "--regions", report,
                        "--quiet"], check=True)
        with open(report, encoding="utf-8") as file:
            frames = [frame["surfaces"][0]["contacts"] for frame in json.load(file)["frames"]]
        names = [contact["collider"] for contact in max(frames, key=len)]
        at = [{contact["collider"]: contact for contact in frame} for frame in frames]
        force = {name: np.array([frame[name]["force"] if name in frame else (0, 0, 0) for frame in at])
                 for name in names}
        nodes = {name: np.array([frame[name]["nodes"] if name in frame else 0 for frame in at]) for name in names}
        return np.load(out), force, nodes


def runs(is_on):
    """The first and the last of each run of frames, counted from 0."""
    steps = np.diff(np.concatenate([[0], np.asarray(is_on, dtype=int), [0]]))
    return list(zip(np.flatnonzero(steps > 0), np.flatnonzero(steps < 0) - 1))


def trampoline():
    from make_trampoline import GRAVITY, MASS

    root = tree.parse(os.path.join(EXAMPLES, NAME + ".xml")).getroot()
    places = np.array([[float(x) for x in key.get("value").split()] for key in root.iter("key")])
    length = 1 / float(root.get("fps"))
    _, force, nodes = bake()
    touches = nodes["ball"] > 0
    landings = runs(touches)
    assert len(landings) == 3, landings

    # Keys have six digits.
    flies = ~(touches[:-2] | touches[1:-1] | touches[2:])
    bends = np.diff(places, 2, axis=0) / length ** 2
    assert flies.sum() > 20
    assert abs(bends - GRAVITY)[flies].max() < 0.02, "the ball does not fall freely"

    tops = [places[a:b, 1].max() for a, b in zip([0] + [end for _, end in landings],
                                                 [begin for begin, _ in landings] + [len(places)])]
    assert (np.diff(tops) < -0.2).all(), f"the bounces are not lower each time: {tops}"
    speed = np.diff(places, axis=0) / length
    for begin, end in landings:
        gained = MASS * (speed[end + 1] - speed[begin - 2])
        given = length * (MASS * GRAVITY * (end + 3 - begin) - force["ball"][begin:end + 1].sum(axis=0))
        # The force is known at frames only; the keys were made with that of each step between them.
        assert np.linalg.norm(gained - given) < 0.1 * np.linalg.norm(gained), (begin + 1, gained, given)


{"trampoline": trampoline}[NAME]()
print("ok", NAME)
