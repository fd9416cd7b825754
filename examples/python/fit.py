#!/usr/bin/env python3
"""Fits a simulation to a motion: the magnitude, density and damping with which a point of a surface follows it.

    python3 fit.py [FOLDER]    # needs scipy and matplotlib

The motion stands for one that was tracked, or keyed by hand: a height at each frame. Here it is made from values
that the fit does not get to see, with noise, so that what it finds can be judged; both are printed. Writes fit.xml,
the scene that follows the motion, and fit.png to FOLDER, by default the current one.
"""

# SciPy and Matplotlib may come without types.
# mypy: disable-error-code="import"

import pathlib
import sys

import matplotlib.figure
import numpy as np
import numpy.typing as npt
import scipy.optimize

import pliant

Array = npt.NDArray[np.float64]

NAMES = ("magnitude", "density", "damping")
HIDDEN = np.array([6500, 24, 35.0])  # what the fit is to find
GUESS = np.array([3000, 15, 100.0])
NOISE = 0.01  # [length]
POINT = (1, 0, 0.5)  # of the sheet at rest; its vertex that is nearest follows the motion


def make_scene(values: Array) -> pliant.Scene:
    magnitude, density, damping = values
    return pliant.Scene(
        fps=24,
        start=1,
        end=60,
        surfaces=[
            pliant.Surface(
                "sheet",
                shape=pliant.Grid(21, 21, width=20, depth=20),
                density=density,
                damping=damping,
            )
        ],
        forces=[
            pliant.Point(
                "poke",
                deformation_radius=7,
                force_radius=3,
                # A short push: how the sheet rings after it tells density and damping apart.
                magnitude=pliant.Curve([(1, 0), (4, magnitude), (8, 0)]),
            )
        ],
    )


def heights(values: Array) -> Array:
    """Of the vertex at POINT, at each frame [length]."""
    positions = pliant.Simulation(make_scene(values)).positions("sheet")
    at_rest = positions[0]  # no force has acted yet
    vertex = np.linalg.norm(at_rest - POINT, axis=1).argmin()
    result: Array = positions[:, vertex, 1]
    return result


def fit(motion: Array) -> tuple[Array, Array]:
    """The values that follow a motion best, and how sure each is, as a share of it."""

    # By what the guess is multiplied, as a logarithm: no value becomes negative, and all have one scale.
    def misses(logarithms: Array) -> Array:
        return heights(GUESS * np.exp(logarithms)) - motion

    found = scipy.optimize.least_squares(misses, np.zeros(len(GUESS)), diff_step=1e-4)
    variance = 2 * found.cost / (len(motion) - len(GUESS))
    shares = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)) * variance)
    print(f"{found.nfev} steps, misses by {np.sqrt(variance):.2g} on average")
    return GUESS * np.exp(found.x), shares


def draw(motion: Array, guessed: Array, fitted: Array, path: pathlib.Path) -> None:
    frames = np.arange(1, len(motion) + 1)
    figure = matplotlib.figure.Figure(figsize=(9, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True, gridspec_kw={"height_ratios": (3, 1)})
    above.plot(frames, guessed, "--", color="0.6", label="guess")
    above.plot(frames, fitted, "C0", linewidth=2, label="fitted")
    above.plot(frames, motion, "ko", markersize=4, label="motion to follow")
    above.set_ylabel("height of the point [length]")
    above.legend()
    below.axhline(0, color="C0", linewidth=2)
    below.plot(frames, motion - fitted, "ko", markersize=4)
    below.set_ylabel("left over")
    below.set_xlabel("frame")
    for axes in (above, below):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=100)


def main() -> None:
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    folder.mkdir(parents=True, exist_ok=True)

    exact = heights(HIDDEN)
    motion = exact + np.random.default_rng(1).normal(0, NOISE, len(exact))
    values, shares = fit(motion)
    for name, hidden, value, share in zip(NAMES, HIDDEN, values, shares):
        print(f"{name:9}  hidden {hidden:7.5g}  fitted {value:7.5g} ± {value * share:.2g}")
    make_scene(values).save(folder / "fit.xml")
    draw(motion, heights(GUESS), heights(values), folder / "fit.png")


if __name__ == "__main__":
    main()
