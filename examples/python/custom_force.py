#!/usr/bin/env python3
"""A force written in NumPy: something crawls along a curve under a sheet, and pushes it up.

    python3 custom_force.py [FOLDER]    # needs matplotlib

No force that is built in bends along a curve; a `Custom` has any shape, by two functions of many points at once: how
far a point is from it, for the radii and the falloff, and which way it is pushed. First it is checked: a body that
lies straight must do what a `Line` does, and the script ends with 1 if it does not. Then it crawls. Writes crawl.npy,
the positions at all frames, and crawl.png, the surface at one of them, to FOLDER, by default the current one.
"""

# Matplotlib may come without types.
# mypy: disable-error-code="import"

import pathlib
import sys
from typing import Any, Callable

import matplotlib.figure
import numpy as np
import numpy.typing as npt

import pliant

Array = npt.NDArray[np.float64]
Body = Callable[[float], Array]  # seconds → the corners of a line through it, from tail to head, (n, 3)

SIZE = 20.0  # of the sheet [length]
NODES = 61  # along each side
FPS = 24.0
FRAME = 54  # the one that is drawn

# What all kinds of forces have.
HOW: dict[str, Any] = {
    "magnitude": pliant.Curve([(1, 0), (12, 1e6)]),
    "deformation_radius": 3.5,
    "force_radius": 1.3,
    "falloff": "smooth",
}


def crawling(seconds: float) -> Array:
    """A body on a figure of eight, which it goes along once in four seconds."""
    turn = 2 * np.pi * (seconds / 4 + np.linspace(-0.35, 0, 25))
    return np.column_stack([7 * np.sin(turn), 0 * turn, 6 * np.sin(2 * turn)])


def lying(seconds: float) -> Array:
    return np.array([[-6.0, 0, -3], [5, 0, 4]])


def nearest(points: Array, body: Array) -> tuple[Array, Array]:
    """How far points (n, 3) are from a body, and how far along it they are nearest, from 0 to 1; both (n,)."""
    begins, ways = body[:-1], np.diff(body, axis=0)
    # Each row by itself, as a simulation relies on. The last bits of a product of matrices may depend on how many
    # points come at once.
    offsets = points[:, None] - begins
    shares = np.clip((offsets * ways).sum(axis=2) / (ways * ways).sum(axis=1), 0, 1)
    distances = np.linalg.norm(offsets - shares[..., None] * ways, axis=2)
    segments = distances.argmin(axis=1)
    rows = np.arange(len(points))
    return distances[rows, segments], (segments + shares[rows, segments]) / len(ways)


def force_of(body: Body, tapers: bool) -> pliant.Custom:
    def distance(points: Array, time: pliant.ForceTime) -> Array:
        return nearest(points, body(time.seconds))[0]

    def push(points: Array, time: pliant.ForceTime) -> Array:
        """Up, for each unit of magnitude; less towards the ends of a body that tapers."""
        result = np.zeros(points.shape)
        result[:, 1] = 1
        if tapers:
            along = nearest(points, body(time.seconds))[1]
            result[:, 1] = 0.2 + 0.8 * np.sin(np.pi * along)
        return result

    return pliant.Custom("body", push, distance=distance, **HOW)


def make_scene(force: pliant.Force, end: int) -> pliant.Scene:
    sheet = pliant.Surface(
        "sheet",
        shape=pliant.Grid(NODES, NODES, width=SIZE, depth=SIZE),
        density=150,
        damping=4000,
        goal=3e5,  # a skin on something soft: only what is near is lifted
        release="recover",  # what it has passed goes back to rest
    )
    return pliant.Scene(fps=FPS, start=1, end=end, surfaces=[sheet], forces=[force])


def difference_from_line() -> float:
    """Between a straight body and the force that is built in [length]."""
    begin, end = lying(0)
    line = pliant.Line("body", from_=begin, to=end, direction=(0, 1, 0), **HOW)
    own = pliant.Simulation(make_scene(force_of(lying, tapers=False), end=12)).positions()
    built_in = pliant.Simulation(make_scene(line, end=12)).positions()
    return float(np.abs(own - built_in).max() / np.ptp(built_in[..., 1]))


def draw(positions: Array, path: pathlib.Path) -> None:
    x, height, z = np.moveaxis(positions.reshape(NODES, NODES, 3), 2, 0)
    figure = matplotlib.figure.Figure(figsize=(12, 5), layout="constrained")
    left = figure.add_subplot(1, 2, 1, projection="3d")
    # The axes of Matplotlib have z up.
    left.plot_surface(x, -z, height, cmap="viridis", rstride=1, cstride=1, antialiased=False)
    left.set_box_aspect((SIZE, SIZE, 3 * np.ptp(height)), zoom=1.15)
    left.set_axis_off()
    left.view_init(elev=40, azim=-60)
    left.set_title(f"frame {FRAME}, three times as high as it is")

    right = figure.add_subplot(1, 2, 2, aspect="equal")
    image = right.pcolormesh(x, z, height, cmap="viridis", shading="gouraud")
    body = crawling(FRAME / FPS)  # the seconds that a force is told
    right.plot(body[:, 0], body[:, 2], "w--", linewidth=1)
    right.plot(*body[-1, [0, 2]], "wo")
    right.invert_yaxis()
    right.set_title("from above, and what pushes")
    right.set_xlabel("x")
    right.set_ylabel("z")
    figure.colorbar(image, ax=right, label="height [length]")
    figure.savefig(path, dpi=100)


def main() -> int:
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    folder.mkdir(parents=True, exist_ok=True)

    difference = difference_from_line()
    print(f"lying straight, it differs from a line by {difference:.1g} of the height")
    if difference > 1e-9:  # both round, each in its own way
        print("it should do the same", file=sys.stderr)
        return 1

    # A bake is how what Python computes gets to other programs: a scene file cannot name a function.
    summary = pliant.bake(make_scene(force_of(crawling, tapers=True), end=96), folder / "crawl.npy")
    print(f"crawling, {summary.frames} frames: up to {summary.peak_displacement:.3g} high")
    draw(np.load(folder / "crawl.npy")[FRAME - 1], folder / "crawl.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
