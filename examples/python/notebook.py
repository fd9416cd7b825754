#!/usr/bin/env python3
# %% [markdown]
# # A scene in a notebook
#
# Editors such as VS Code and Spyder run the cells of this file one by one, and Jupytext opens it as a notebook. In a
# notebook a simulation shows itself: the page of `pliant view`, to play and to turn. As a script,
#
#     python3 notebook.py [FOLDER]    # needs nothing beside pliant
#
# it writes what a notebook shows to notebook.html, and a page to send to others, drops.html, to FOLDER, by default
# the current one.

# %%
# IPython comes with notebooks only.
# mypy: disable-error-code="import"

import copy
import pathlib
import sys

import numpy as np

import pliant

is_notebook = "ipykernel" in sys.modules
# A notebook has arguments of its own.
folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 and not is_notebook else ".")
shown: list[str] = []


def show(simulation: pliant.Simulation) -> None:
    """Below the cell, as the name of a simulation in a cell's last line does; a script keeps it for its end."""
    if is_notebook:
        from IPython.display import display

        display(simulation)
    else:
        shown.append(simulation._repr_html_() or "a build without the viewer shows nothing")


# %% [markdown]
# ## A scene
#
# Drops fall on a sheet, one after the other. A part can be looked up by its name, and edited at any time.

# %%
drops = [(1, (-4, 0, -3)), (7, (3, 0, 4)), (13, (4, 0, -2)), (19, (-3, 0, 3))]  # when, where

scene = pliant.Scene(fps=24, start=1, end=72)
scene.surfaces.append(
    pliant.Surface(
        "sheet",
        shape=pliant.Grid(61, 61, width=20, depth=20),
        density=30,
        damping=8,
        region="all",  # waves run over all of the sheet, not only around the drops
    )
)
for first, center in drops:
    scene.forces.append(
        pliant.Point(
            f"drop{first}",
            center=center,
            direction=(0, -1, 0),
            force_radius=2,
            falloff="smooth",
            magnitude=pliant.Curve([(first, 0), (first + 2, 30000), (first + 4, 0)]),
        )
    )
scene.check()
print(scene, scene["drop7"], sep="\n")

# %% [markdown]
# ## What it does
#
# A simulation computes a frame when somebody asks for it, and has a copy of its scene.

# %%
simulation = pliant.Simulation(scene)
show(simulation)

# %% [markdown]
# ## Frames as arrays

# %%
positions = simulation.positions("sheet")
deepest = positions[:, :, 1].min(axis=1)
print(f"{positions.shape}, {positions.dtype}")
print(f"deepest: {deepest.min():.3g} at frame {simulation.frames[deepest.argmin()]}")

points = simulation.at(10)["sheet"].object_positions  # frames come in any order; this is a view, not a copy
print(f"frame 10 is deepest at {np.round(points[points[:, 1].argmin()], 3)}")

# %% [markdown]
# ## The same once more, with other values

# %%
calm = copy.deepcopy(scene)
calm["sheet"].damping = 80
calm.change("drop19.magnitude*=-2")  # as --set takes it: the last one pulls
show(pliant.Simulation(calm))

# %% [markdown]
# ## To send to others
#
# One file that plays in any browser, without a network.

# %%
folder.mkdir(parents=True, exist_ok=True)
pliant.view(simulation, folder / "drops.html")
if not is_notebook:
    text = "<!doctype html>\n<meta charset=utf-8>\n" + "\n".join(shown)
    (folder / "notebook.html").write_text(text, encoding="utf-8")
