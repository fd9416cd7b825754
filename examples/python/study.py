#!/usr/bin/env python3
"""A study: how density and damping of a sheet decide how far a poke goes, and when all is quiet again.

    python3 study.py [FOLDER]    # needs matplotlib

Runs all combinations twice: as one `Sweep`, and in processes that share the takes out among themselves, as on
a farm of machines. The bits of a take do not depend on where it ran, so both tables must be the same, byte for
byte; the script ends with 1 if they are not. Writes study.csv and study.png to FOLDER, by default the current one.
"""

# Matplotlib may come without types.
# mypy: disable-error-code="import"

import csv
import multiprocessing
import pathlib
import sys
from typing import Any

import matplotlib.figure
import numpy as np
import numpy.typing as npt

import pliant

Table = npt.NDArray[Any]  # structured: a row for each take

PROCESSES = 2
VARY = {"sheet.density": [5, 10, 20, 40, 80], "sheet.damping": [2, 5, 10, 20, 40, 80, 160, 320]}


def make_scene() -> pliant.Scene:
    return pliant.Scene(
        fps=24,
        start=1,
        end=120,
        surfaces=[pliant.Surface("sheet", shape=pliant.Grid(31, 31, width=20, depth=20))],
        forces=[
            pliant.Point(
                "poke",
                deformation_radius=7,
                force_radius=2.5,
                magnitude=pliant.Curve([(1, 0), (6, 8000), (11, 0)]),
            )
        ],
    )


def run_part(part: int) -> Table:
    """Runs every so many-th take, in a process of its own: a module's function, so that it can be sent there."""
    # Neither a Sweep nor a Simulation can be sent; a Scene can, and here each process makes its own.
    sweep = pliant.Sweep(make_scene(), vary=VARY)
    return sweep.run(range(part, len(sweep), PROCESSES))


def run_in_processes() -> Table:
    # "spawn" works the same on every system, and shares no state of this process.
    with multiprocessing.get_context("spawn").Pool(PROCESSES) as pool:
        parts = pool.map(run_part, range(PROCESSES))
    return np.sort(np.concatenate(parts), order="take")


def write_csv(table: Table, path: pathlib.Path) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table.dtype.names or ())
        writer.writerows(table.tolist())  # floats in their shortest text, which reads back the same


def choose(table: Table, peak: float) -> int:
    """The take that is quiet first among those that go far enough."""
    return int(np.argmin(np.where(table["peak"] >= peak, table["settle"], np.inf)))


def draw(table: Table, scene: pliant.Scene, chosen: int, path: pathlib.Path) -> None:
    """A map of each measure; of the axes of a sweep the last one runs fastest, so it goes to the right."""
    (_, densities), (_, dampings) = VARY.items()
    # Who settles in the last frame only has not settled.
    seconds = np.where(table["settle"] < scene.end, (table["settle"] - scene.start) / scene.fps, np.nan)
    figure = matplotlib.figure.Figure(figsize=(10, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for axes, title, values in (
        (left, "peak [length]", table["peak"]),
        (right, "quiet after [s] (–: moves to the end)", seconds),
    ):
        cells = values.reshape(len(densities), len(dampings))
        image = axes.imshow(cells, origin="lower", aspect="auto", cmap="viridis")
        for (row, column), value in np.ndenumerate(cells):
            is_dark = image.norm(value) < 0.6  # False for NaN, which stays white
            text = "–" if np.isnan(value) else f"{value:.2f}"
            axes.text(column, row, text, ha="center", va="center", color="w" if is_dark else "k")
        row, column = divmod(chosen, len(dampings))
        axes.plot(column, row, "s", markersize=32, fillstyle="none", color="r", markeredgewidth=2)
        axes.set_title(title)
        axes.set_xticks(range(len(dampings)), dampings)
        axes.set_yticks(range(len(densities)), densities)
        axes.set_xlabel("damping")
        axes.set_ylabel("density")
    figure.savefig(path, dpi=100)


def main() -> int:
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    folder.mkdir(parents=True, exist_ok=True)
    scene = make_scene()
    table = pliant.Sweep(scene, vary=VARY).run()
    failed = table[table["status"] != "done"]
    if len(failed):
        print(f"take {failed['take'][0]}: {failed['error'][0]}", file=sys.stderr)
        return 1
    if run_in_processes().tobytes() != table.tobytes():
        print("the processes computed other bits than the sweep", file=sys.stderr)
        return 1
    print(f"{len(table)} takes, the same bits in one process and in {PROCESSES}")

    write_csv(table, folder / "study.csv")
    chosen = choose(table, peak=1)
    draw(table, scene, chosen, folder / "study.png")
    take = table[chosen]
    print(
        f"goes 1 far and is quiet first, at frame {take['settle']}: "
        f"density {take['sheet.density']:g}, damping {take['sheet.damping']:g}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
