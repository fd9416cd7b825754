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


def bake(*changes):
    """The displacements of the surface's vertices at all frames, and for each collider its forces and numbers of nodes;
    with `changes` as those of --set."""
    with tempfile.TemporaryDirectory() as folder:
        out, report = os.path.join(folder, "a.npy"), os.path.join(folder, "a.json")
        subprocess.run([PLIANT, "bake", os.path.join(EXAMPLES, NAME + ".xml"), "-o", out, "--regions", report,
                        "--quiet", *(text for change in changes for text in ("--set", change))], check=True)
        with open(report, encoding="utf-8") as file:
            frames = [frame["surfaces"][0]["contacts"] for frame in json.load(file)["frames"]]
        names = [contact["collider"] for contact in max(frames, key=len)]
        at = [{contact["collider"]: contact for contact in frame} for frame in frames]
        force = {name: np.array([frame[name]["force"] if name in frame else (0, 0, 0) for frame in at])
                 for name in names}
        nodes = {name: np.array([frame[name]["nodes"] if name in frame else 0 for frame in at]) for name in names}
        places = np.load(out)
        return places - places[0], force, nodes


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


def size(moved):
    """The largest displacement at each frame."""
    return np.linalg.norm(moved, axis=2).max(axis=1)


def pillow():
    moved, _, nodes = bake()
    (begin, end), = runs(nodes["head"] > 0)
    down, aside = -moved[:, :, 1].min(axis=1), moved[:, :, 0].max(axis=1)
    assert down[23] > 0.6 and size(moved).argmax() <= end
    # Straight down, then to the side where the head turns; the cloth goes along because of the friction.
    assert aside[begin:23].max() < 0.1 * aside[39]
    slides, _, _ = bake("head.friction=0")
    assert slides[39, :, 0].max() < 0.5 * aside[39]
    assert (np.diff(size(moved)[end:]) < 0).all() and size(moved)[-1] < 0.02 * down[23], "it does not rise again"


def stroke():
    moved, _, nodes = bake()
    fingers = ("index", "middle", "ring")
    touches = sum(nodes[name] for name in fingers) > 0
    (begin, end), = runs(touches)
    assert not nodes["palm"].any() and not nodes["thumb"].any()
    slides, _, _ = bake(*(f"{name}.friction=0" for name in nodes))
    down = -moved[:, :, 1].min(axis=1)
    assert down.max() > 2 * -slides[:, :, 1].min(), "friction does not drag the skin"
    assert begin < down.argmax() <= end
    assert size(moved)[-1] < 0.05 * size(moved).max(), "it does not spring back"


def press():
    moved, _, nodes = bake()
    light, deep = runs(nodes["punch"] > 0)
    peak = [size(moved)[begin:end + 1].max() for begin, end in (light, deep)]
    assert size(moved)[deep[0] - 1] < 1e-3 * peak[0], "the light stroke leaves a dent"
    left = size(moved)[-1]
    assert 0.2 * peak[1] < left < 0.6 * peak[1], (left, peak)
    # Nothing swings any more: it is bent.
    assert abs(size(moved)[-6:] - left).max() < 1e-3 * left


def sticky():
    moved, _, nodes = bake()
    (begin, end), = runs(nodes["finger"] > 0)
    assert end == 39, "it sticks until frame 40"
    curve = subprocess.run([PLIANT, "curves", os.path.join(EXAMPLES, NAME + ".xml"), "--channel", "finger.translate"],
                           check=True, capture_output=True, text=True).stdout
    finger = np.array([[float(x) for x in line.split(",")[2:]] for line in curve.splitlines()[1:]])
    follows = np.diff(moved[19:end + 1], axis=0) - np.diff(finger[19:end + 1], axis=0)[:, None]
    held = abs(follows).max(axis=(0, 2)) < 1e-6
    assert held.sum() > 10, "nothing goes with the finger"
    assert moved[:begin + 8, :, 1].max() < 0.1, "the sheet climbs the finger"
    assert moved[end, held, 1].min() > 1.5 and size(moved)[end + 12:].max() < 0.5 * size(moved)[end]


{"trampoline": trampoline, "pillow": pillow, "stroke": stroke, "press": press, "sticky": sticky}[NAME]()
print("ok", NAME)
