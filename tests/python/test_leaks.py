"""Nothing leaks: objects of each bound class, made, used and dropped a thousand times."""

import gc
import os
import sys

import numpy as np
import pytest

import pliant
from pliant import _core, edit


class Case:
    """Small scenes, and what they refer to."""

    def __init__(self, folder):
        self.folder = folder
        self.force = lambda points, time: points * 0 + 1
        self.asked = lambda: False
        self.values = np.ones((3, 3))
        sheet = pliant.Surface("sheet", damping=4, maps=[pliant.Map("damping", values=self.values, low=0.5)])
        curve = pliant.Curve([(1, 0), (3, 9)])
        reach = {"deformation_radius": 9, "force_radius": 9}
        self.scene = pliant.Scene(end=3, surfaces=[sheet], forces=[pliant.Custom("own", self.force, magnitude=1, **reach)])
        plain = pliant.Scene(
            end=3, surfaces=[pliant.Surface("sheet", damping=4)], forces=[pliant.Point("poke", magnitude=curve, **reach)]
        )
        self.file = folder / "a.xml"
        plain.save(self.file)
        self.text = self.file.read_text()
        self.plain = pliant.load(self.file)
        pliant.SweepFolder(folder / "sweep", [self.file], vary={"sheet.damping": [1, 2]}).run()
        self.store = pliant.MemoryStore(10**5)

    def references(self):
        gc.collect()
        return [sys.getrefcount(each) for each in vars(self).values()]


# Each returns objects of bound classes that it has used.


def simulations(case):
    simulation = pliant.Simulation(case.scene, should_stop=case.asked)
    frame = simulation.at(3)
    surface = frame["sheet"]
    surface.object_positions, surface.object_rest, surface.positions(), surface.transform
    simulation.report(2), simulation.warnings(), simulation.restore(simulation.state(2)), simulation.scene
    return simulation, frame, surface, simulation.shape()


def stores(case):
    folder = pliant.FolderStore(str(case.folder / "store"), 10**5)
    own = pliant.MemoryStore(10**5)
    for store in (folder, own, case.store):
        pliant.Simulation(case.plain, store=store).at(3)
    return folder, own


def live_simulations(case):
    live = pliant.LiveSimulation(case.plain, records=True)
    live["poke.magnitude"] = 3
    live.advance()
    live.report(), live.performance(), live.positions()
    pliant.LiveSimulation(case.scene, should_stop=case.asked).advance()
    return (live,)


def sweeps(case):
    sweep = pliant.Sweep(case.plain, vary={"sheet.damping": [1, 2]})
    sweep.run([1]), sweep.scene(0)
    folder = pliant.SweepFolder.open(case.folder / "sweep")
    folder.status(), folder.table()
    return sweep._own, folder._own


def documents(case):
    document = pliant.SceneDocument.from_text(case.text, name="a.xml")
    document.apply(edit.Set("sheet.density", 5))
    document.undo(), document.redo(), document.text, document.scene
    return (document._own,)


def scenes(case):
    scene = pliant.load(case.file)
    scene.change("sheet.damping*=2")
    scene.to_xml(), scene.channels(), scene.notes, case.scene.check()
    return (scene._source,)


def shapes_and_curves(case):
    mesh = pliant.Mesh(np.eye(3), [(0, 1, 2)], attributes={"a": [1, 2, 3]})
    mesh.positions, mesh.uvs, mesh.face_sizes, mesh.corner_vertices
    curve = pliant.Curve([(0, 1), pliant.Key(3, 4, tangent="flat")]).insert_key(2)
    curve([1.0, 2.0]), curve.keys, curve.handles, curve.baked(0, 3)
    path = pliant.Path([(0, 0, 0), (1, 0, 0), (2, 1, 0)], progress=curve)
    path.at(0.5), path.waypoints
    return mesh, curve, path


def what_is_refused(case):
    def fails(points, time):
        raise LookupError(str(case.values))

    wrong = pliant.Scene(surfaces=[pliant.Surface("sheet"), pliant.Surface("sheet", maps=[pliant.Map("b", values=case.values)])])
    failing = pliant.Scene(end=3, surfaces=[pliant.Surface("sheet")], forces=[pliant.Custom("own", fails, magnitude=1)])
    for call in (
        lambda: pliant.Simulation(wrong, should_stop=case.asked),
        lambda: pliant.Simulation(failing, should_stop=case.asked).at(3),
        lambda: pliant.Mesh(case.values, [(0, 1, 9)]),
        lambda: pliant.Curve([]),
        lambda: pliant.parse("<scene>"),
        lambda: pliant.SceneDocument.from_text("<scene>"),
    ):
        with pytest.raises((pliant.InvalidInput, LookupError)):
            call()
    return ()


USES = [simulations, stores, live_simulations, sweeps, documents, scenes, shapes_and_curves, what_is_refused]


@pytest.fixture
def case(tmp_path):
    return Case(tmp_path)


def test_each_bound_class_is_used(case):
    used = {type(made) for use in USES for made in use(case)}
    assert used == {each for each in vars(_core).values() if isinstance(each, type)}


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.no_sanitizer  # freed memory is kept
@pytest.mark.parametrize("use", USES)
def test_nothing_leaks(case, use):
    for _ in range(50):
        use(case)
    references, objects, memory = case.references(), len(gc.get_objects()), resident()
    for _ in range(1000):
        use(case)
    assert case.references() == references
    assert len(gc.get_objects()) - objects < 500  # a leak is one a round
    assert resident() - memory < 10 * 2**20
