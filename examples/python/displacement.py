#!/usr/bin/env python3
"""Plots how far the surfaces of a scene move, with the magnitudes of the forces below.

    python3 displacement.py [FOLDER] [--scene SCENE.xml]    # needs matplotlib

Writes displacement.png to FOLDER, by default the current one. A strong line is the peak of a surface, the
distance from rest of whichever vertex is farthest out in that frame. A thin one is the vertex that comes
farthest of all, along the way it went there: below zero it swings through to the other side. The scene is
sheet.xml, beside this script's folder, unless another is given.
"""

# Matplotlib may come without types.
# mypy: disable-error-code="import"

import argparse
import pathlib

import matplotlib.figure
import numpy as np
import numpy.typing as npt

import pliant

Array = npt.NDArray[np.float64]


def displacements(simulation: pliant.Simulation, name: str) -> Array:
    """(F, V, 3): each vertex of a surface minus its place at rest, in world space."""
    result = []
    for frame in simulation:
        surface = frame[name]
        # The rest shape of an animated mesh moves, so it is that of this very frame.
        moved = surface.object_positions - surface.object_rest
        result.append(moved @ surface.transform[:3, :3].T)
    return np.array(result)


def swing(moved: Array) -> tuple[int, Array]:
    """The vertex that comes farthest, and at each frame its displacement along the way it went there, (F,)."""
    distances = np.linalg.norm(moved, axis=2)
    frame, vertex = np.unravel_index(np.argmax(distances), distances.shape)
    farthest = moved[frame, vertex]
    return int(vertex), moved[:, vertex] @ farthest / max(distances[frame, vertex], np.finfo(float).tiny)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=pathlib.Path())
    example = pathlib.Path(__file__).resolve().parents[1] / "sheet.xml"
    parser.add_argument("--scene", type=pathlib.Path, default=example)
    arguments = parser.parse_args()

    scene = pliant.load(arguments.scene)
    simulation = pliant.Simulation(scene)
    frames = np.array(simulation.frames)

    figure = matplotlib.figure.Figure(figsize=(9, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True, gridspec_kw={"height_ratios": (2, 1)})
    for index, surface in enumerate(scene.surfaces):
        moved = displacements(simulation, surface.name)
        peaks = np.linalg.norm(moved, axis=2).max(axis=1)
        vertex, along = swing(moved)
        above.plot(frames, peaks, color=f"C{index}", linewidth=2.5, label=f"{surface.name}, peak")
        above.plot(frames, along, color=f"C{index}", linewidth=1, label=f"{surface.name}, vertex {vertex}")
        print(f"{surface.name}: {peaks.max():.4g} at frame {frames[peaks.argmax()]}, vertex {vertex}")
    for index, force in enumerate(scene.forces):
        # A channel as the simulation reads it at each frame: the numbers of `pliant curves`.
        magnitudes = scene.sample(f"{force.name}.magnitude", frames)
        enabled = scene.sample(f"{force.name}.enabled", frames)
        color = f"C{len(scene.surfaces) + index}"
        dashes = ("-", "--", ":", "-.")[index % 4]  # two forces may have the same values
        below.plot(frames, magnitudes * enabled, dashes, color=color, label=force.name)
    if not scene.forces:
        below.text(0.5, 0.5, "no forces", transform=below.transAxes, ha="center", va="center")

    above.set_title(arguments.scene.name)
    above.set_ylabel("displacement [length]")
    below.set_ylabel("magnitude")
    below.set_xlabel(f"frame, {scene.fps:g} a second")
    for axes in (above, below):
        axes.margins(x=0)
        axes.grid(alpha=0.3)
        if axes.lines:
            axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, frameon=False)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(arguments.folder / "displacement.png", dpi=100)


if __name__ == "__main__":
    main()
