#!/usr/bin/env python3
"""Writes the keys of the ball in trampoline.xml: the flight of a ball with a mass.

    python3 make_trampoline.py [--pliant PLIANT] [-o trampoline.xml]    # needs numpy; takes a minute

The scene is played with a frame for each step of its solver. In each of these the ball falls freely
unless the mat touches it; then its place at the end is sought at which its mass, its weight and the
contact's force, which `pliant bake --regions` reports, are in balance. Each fifth place is a key.
"""

import argparse
import json
import pathlib
import re
import subprocess
import tempfile

import numpy as np

STEPS = 5  # in a frame
MASS = 2.5  # that of the mat is 1.2: its density, since (u,v) goes from 0 to 1
GRAVITY = np.array([0, -32.0, 0])  # length / s^2: what is 10 long here is 3 m wide
BEGIN = np.array([-1.6, 4.0, 0.5])
SPEED = np.array([0.7, 0, -0.2])  # length / s

KEYS = re.compile(r'(<animate attribute="translate" interpolation="linear">\n).*?(\n *</animate>)', re.DOTALL)


def text_of(place):
    return " ".join(f"{x:.6g}" for x in place)


def with_keys(scene, places):
    keys = "\n".join(f'        <key frame="{k + 1}" value="{text_of(place)}"/>' for k, place in enumerate(places))
    return KEYS.sub(lambda match: match[1] + keys + match[2], scene)


class Mat:
    """The force of the ball on the mat, from bakes of the scene in single steps."""

    def __init__(self, pliant, scene, folder):
        self.pliant, self.folder = pliant, folder
        fps, last = (float(re.search(rf'\b{name}="([\d.]+)"', scene)[1]) for name in ("fps", "end"))
        self.frames, self.dt = int(last), 1 / (STEPS * fps)
        self.scene = scene.replace(f'fps="{fps:g}"', f'fps="{STEPS * fps:g}"').replace(
            f'end="{last:g}"', f'end="{STEPS * last:g}"')

    def force(self, places):
        """On the mat, at the last of the places. Earlier ones are in the cache."""
        path, report = self.folder / "steps.xml", self.folder / "steps.json"
        path.write_text(with_keys(self.scene, places), encoding="utf-8")
        subprocess.run([self.pliant, "bake", path, "-o", self.folder / "steps.npy", "--frames", str(len(places)),
                        "--regions", report, "--cache", self.folder / "cache", "--quiet"], check=True)
        contacts = json.loads(report.read_text())["frames"][-1]["surfaces"][0]["contacts"]
        return np.array(contacts[0]["force"]) if contacts else np.zeros(3)


def flight(mat):
    """A place for each step, by momentum: m (v' - v) = dt (m g - f), and p' = p + dt v'."""
    places, speed = [BEGIN], SPEED
    while len(places) <= STEPS * (mat.frames - 1):
        free = places[-1] + mat.dt * (speed + mat.dt * GRAVITY)

        def excess(height):
            """How far above the balance a height is, and the place that the force sends the ball to."""
            force = mat.force([*places, np.array([free[0], height, free[2]])])
            sent = free - force * mat.dt ** 2 / MASS
            return height - sent[1], sent

        # The force falls with the height: Illinois, between the free fall and where that sends the ball.
        low, (low_excess, place) = free[1], excess(free[1])
        if low_excess < 0:
            high, (high_excess, place) = place[1], excess(place[1])
            side = 0
            while abs(high_excess) > 1e-6 and high - low > 1e-9:
                height = (low * high_excess - high * low_excess) / (high_excess - low_excess)
                rest, place = excess(height)
                if rest > 0:
                    high, high_excess = height, rest
                    low_excess /= 2 if side > 0 else 1
                    side = 1
                else:
                    low, low_excess = height, rest
                    high_excess /= 2 if side < 0 else 1
                    side = -1
                if abs(rest) <= 1e-6:
                    break
        speed = (place - places[-1]) / mat.dt
        places.append(place)
    return places[::STEPS]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    source = pathlib.Path(__file__).with_name("trampoline.xml")
    parser.add_argument("--pliant", default="pliant", help="the command")
    parser.add_argument("-o", "--out", type=pathlib.Path, default=source)
    arguments = parser.parse_args()
    scene = source.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        places = flight(Mat(arguments.pliant, scene, pathlib.Path(folder)))
    arguments.out.write_text(with_keys(scene, places), encoding="utf-8")


if __name__ == "__main__":
    main()
