"""Never run: what mypy accepts and what it refuses. The lines that end in `# refused` are errors."""

import os
import pathlib
from typing import Dict, List, Tuple, Union

import numpy as np
import pliant
from pliant import edit

sheet = pliant.Surface("sheet", shape=pliant.Grid(61, 61, width=20, depth=20), damping=20, edges="free")
poke = pliant.Point("poke", center=[-3, 0, 0], magnitude=pliant.Curve([(1, 0), pliant.Key(24, 0, tangent="flat")]))
scene = pliant.Scene(start=1, end=48, surfaces=[sheet], forces=(poke,))
scene.forces += [pliant.Custom("swirl", lambda points, time: points * time.seconds, magnitude=3)]
scene.surfaces.append(sheet)
poke.center = np.array([1.0, 2, 3])
poke.center = pliant.Path([(0, 0, 0), (1, 0, 0)])
sheet.cache = "a.npy"
sheet.cache = np.zeros((1, 3, 3))
sheet.maps.append(pliant.Map("density", values=np.ones((61, 61))))
edges: Tuple[str, str, str, str] = sheet.edges
center: Union[Tuple[float, float, float], pliant.Curve, pliant.Path] = poke.center
forces: List[pliant.Point] = [force for force in scene.forces if isinstance(force, pliant.Point)]

simulation = pliant.Simulation(scene, threads=2, store=pliant.MemoryStore(1 << 20))
for frame in simulation:
    for name, surface in frame.items():
        peak: float = surface.peak_displacement
        positions: np.ndarray[object, np.dtype[np.float64]] = surface.positions()
        surface.positions(out=np.zeros((3, 3), np.float32))
first: pliant.Frame = simulation.at(1)
times: Dict[str, float] = simulation.profile()
pliant.load(pathlib.Path("a"), root=os.fspath("b")).save("x")
document = pliant.SceneDocument("a.xml")
change: pliant.Change = document.apply(edit.Set("poke.magnitude", 900), edit.SetKey("poke.magnitude", 3, value=4))
peaks = pliant.Sweep(scene, vary={"sheet.damping": [1, 5, 20]}).run()["peak"]
summary: pliant.BakeSummary = pliant.bake(scene, "a.npy", frames=(1, 2), progress=lambda done, total: None)

poke.magnitud = 1  # refused
poke.magnitude = "strong"  # refused
sheet.shape = 3  # refused
pliant.Grid(2)  # refused
pliant.Nurbs(np.zeros((4, 4, 3)), degree_u=3)  # refused
pliant.Point("a", magnitud=1)  # refused
pliant.Scene(frames=3)  # refused
edit.Set("poke.magnitude")  # refused
simulation.at("first")  # refused
pliant.load(3)  # refused
scene.surfaces.append(poke)  # refused
