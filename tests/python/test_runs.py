"""Bakes, pages and replays: the bytes of the command."""

import copy
import html
import os
import pickle
import re
import signal
import threading

import numpy as np
import pytest

import pliant

formats = ("npy", "obj", "ply", "pc2", "mdd", "glb", "gltf", "usda")


@pytest.fixture
def two(scene):
    """Two surfaces, one turned, and a collider."""
    other = pliant.Surface("other", shape=pliant.Grid(5, 4), translate=(0, 3, 0), rotate=(0, 30, 0))
    scene.surfaces.append(other)
    scene.forces[0].targets = ("sheet",)
    scene.colliders.append(pliant.Collider("ball", shape=pliant.Sphere(radius=0.5), translate=(9, 9, 9)))
    return scene


def bytes_in(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("ending", formats)
@pytest.mark.parametrize("space", ["world", "object"])
def test_the_files_are_those_of_the_command(two, command, tmp_path, ending, space):
    file = tmp_path / "scene.xml"
    two.save(file)
    for name in ("own", "other"):
        (tmp_path / name).mkdir()
    done = pliant.bake(two, tmp_path / "own" / f"a.{ending}", space=space, frames=(2, 5))
    command("bake", file, "-o", tmp_path / "other" / f"a.{ending}", "--space", space, "--frames", "2:5", "--quiet")
    own = bytes_in(tmp_path / "own")
    assert own == bytes_in(tmp_path / "other")
    assert sorted(done.files) == sorted(str(tmp_path / "own" / name) for name in own)
    assert done.frames == 4 and done.vertices == 13 * 11 + 5 * 4


def test_a_bake_of_one_surface_is_what_a_simulation_has(two, tmp_path):
    done = pliant.bake(two, tmp_path / "a.npy", surface="sheet")
    array = np.load(tmp_path / "a.npy")
    simulation = pliant.Simulation(two)
    assert array.tobytes() == simulation.positions("sheet").tobytes()
    assert done.peak_displacement == max(frame["sheet"].peak_displacement for frame in simulation)
    assert done.warnings == tuple(simulation.warnings())
    assert done.files == (str(tmp_path / "a.npy"),) and done.seconds > 0


def test_progress_is_told_of_each_frame_and_may_end_the_bake(scene, tmp_path):
    told = []
    pliant.bake(scene, tmp_path / "a.npy", frames=(3, 5), progress=lambda *counts: told.append(counts))
    assert told == [(k, 5) for k in range(1, 6)]

    class Enough(Exception):
        pass

    def stop(done, total):
        if done == 4:
            raise Enough

    old = (tmp_path / "a.npy").read_bytes()
    for name in ("a.npy", "b.npy", "c.glb", "d.pc2", "e.usda"):
        with pytest.raises(Enough):
            pliant.bake(scene, tmp_path / name, progress=stop)
    assert bytes_in(tmp_path) == {"a.npy": old}
    with pytest.raises(Enough):
        pliant.bake(scene, tmp_path / "f.obj", progress=stop)
    assert sorted(bytes_in(tmp_path)) == ["a.npy"] + [f"f.{k:04}.obj" for k in range(1, 5)]
    whole = pliant.bake(scene, tmp_path / "f.obj", resume=True)
    assert len(whole.files) == 12 and set(whole.files) == {str(p) for p in tmp_path.glob("f.*")}


def test_a_store_and_threads_change_no_bit(two, tmp_path):
    pliant.bake(two, tmp_path / "a.glb")
    store = pliant.MemoryStore(2**24)
    pliant.bake(two, tmp_path / "b.glb", threads=3, store=store)
    assert store.bytes > 0
    pliant.bake(two, tmp_path / "c.glb", store=store, max_memory=2**28)
    a, b, c = (bytes_in(tmp_path)[f"{name}.glb"] for name in "abc")
    assert a == b == c


def test_a_bake_refuses_what_the_command_refuses(scene, tmp_path, command):
    file = tmp_path / "scene.xml"
    scene.surfaces[0].shape = pliant.Mesh([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 1, 2, 3)])
    scene.save(file)
    mesh = next(tmp_path.glob("*.obj"))
    loaded = pliant.load(file)
    with pytest.raises(pliant.InvalidInput, match="would overwrite .*, an input of the scene"):
        pliant.bake(loaded, mesh.with_suffix(".pc2"))
    with pytest.raises(pliant.InvalidInput, match="ending"):
        pliant.bake(scene, tmp_path / "a.xyz")
    with pytest.raises(pliant.InvalidInput, match="frames 1 to 12"):
        pliant.bake(scene, tmp_path / "a.npy", frames=(0, 5))
    with pytest.raises(pliant.InvalidInput, match="frames"):
        pliant.bake(scene, tmp_path / "a.npy", frames=(5, 3))
    with pytest.raises(pliant.Unwritable):
        pliant.bake(scene, tmp_path / "nowhere" / "a.npy")
    with pytest.raises(KeyError, match="sheet"):
        pliant.bake(scene, tmp_path / "a.npy", surface="shet")
    for wrong in ({"space": "there"}, {"threads": 0}, {"solver": "magic"}, {"frames": (1, 2, 3)}):
        with pytest.raises(ValueError):
            pliant.bake(scene, tmp_path / "a.npy", **wrong)
    for wrong in ({"frames": "1:2"}, {"frames": 3}, {"store": 1}):
        with pytest.raises(TypeError):
            pliant.bake(scene, tmp_path / "a.npy", **wrong)
    with pytest.raises(TypeError):
        pliant.bake("scene.xml", tmp_path / "a.npy")
    assert not list(tmp_path.glob("a.*"))


def test_any_name_of_a_file_is_one(scene, tmp_path):
    name = os.fsencode(tmp_path) + b"/\xff \xc3\xa9.npy"
    done = pliant.bake(scene, name)
    assert [os.fsencode(file) for file in done.files] == [name] and os.path.exists(name)
    log = os.fsdecode(os.fsencode(tmp_path) + b"/\xff.replay")
    simulation = pliant.Simulation(scene)
    pliant.record_replay(simulation, log)
    assert pliant.verify_replay(log, simulation)
    for write in (pliant.bake, pliant.view):
        with pytest.raises(ValueError, match="NUL"):
            write(scene, "a.npy\0.html")


def test_ctrl_c_ends_a_bake_without_a_file(scene, tmp_path):
    scene.end = 100_000

    def interrupt(done, total):
        if done == 3:
            os.kill(os.getpid(), signal.SIGINT)

    for name in ("a.npy", "a.pc2", "a.usda"):
        with pytest.raises(KeyboardInterrupt):
            pliant.bake(scene, tmp_path / name, progress=interrupt)
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        pliant.record_replay(pliant.Simulation(scene), tmp_path / "a.replay")
    assert not list(tmp_path.iterdir())


def test_a_force_in_python_and_its_error_pass_through_a_bake(scene, tmp_path):
    scene.forces.append(pliant.Custom("own", lambda points, time: points * 0 + (0, 9, 0),
                                      magnitude=1, deformation_radius=4, force_radius=2))  # fmt: skip
    pliant.bake(scene, tmp_path / "a.npy")
    assert np.load(tmp_path / "a.npy").tobytes() == pliant.Simulation(scene).positions().tobytes()

    def wrong(points, time):
        raise KeyError("no such force")

    scene.forces[1].force = wrong
    with pytest.raises(KeyError, match="no such force"):
        pliant.bake(scene, tmp_path / "b.npy")
    assert not (tmp_path / "b.npy").exists()


def test_a_page_is_that_of_the_command(scene, command, tmp_path):
    file = tmp_path / "scene.xml"
    scene.save(file)
    loaded = pliant.load(file)
    try:
        pliant.view(loaded, tmp_path / "own.html", frames=(2, 6))
    except pliant.Unwritable as error:  # a build without the page, which the command tells too
        command("view", file, "-o", tmp_path / "other.html", status=1)
        assert "viewer" in error.message
        assert pliant.Simulation(scene)._repr_html_() is None
        return
    command("view", file, "-o", tmp_path / "other.html", "--frames", "2:6", "--quiet")
    page = (tmp_path / "own.html").read_bytes()
    assert page == (tmp_path / "other.html").read_bytes()
    simulation = pliant.Simulation(loaded)
    pliant.view(simulation, tmp_path / "own.html", frames=(2, 6))
    assert page == (tmp_path / "own.html").read_bytes()
    pliant.view(simulation, tmp_path / "all.html")
    shown = re.search(r'srcdoc="([^"]*)"', simulation._repr_html_())[1]
    assert html.unescape(shown).encode() == (tmp_path / "all.html").read_bytes()


def test_a_page_goes_to_no_other_place(scene, tmp_path):
    file = tmp_path / "scene.html"
    scene.save(file)
    text = file.read_bytes()
    with pytest.raises(pliant.InvalidInput, match="input of the scene"):
        pliant.view(pliant.load(file), file)
    with pytest.raises(pliant.InvalidInput, match=r"\.html"):
        pliant.view(scene, tmp_path / "a.png")
    with pytest.raises(TypeError):
        pliant.view(str(file), tmp_path / "a.html")
    assert bytes_in(tmp_path) == {"scene.html": text}


def test_a_log_is_that_of_the_command(scene, command, tmp_path):
    file = tmp_path / "scene.xml"
    scene.save(file)
    pliant.record_replay(file, tmp_path / "own.replay", states_every=4, last_frame=9)
    command("replay", "record", file, "-o", tmp_path / "other.replay", "--states", 4, "--last", 9, "--quiet")
    assert (tmp_path / "own.replay").read_bytes() == (tmp_path / "other.replay").read_bytes()
    verdict = pliant.verify_replay(tmp_path / "own.replay")
    assert verdict and verdict.holds and verdict.frame_count == 9
    assert verdict.differences == verdict.mismatches == verdict.causes == ()
    assert pliant.verify_replay(tmp_path / "own.replay", file, threads=2)
    assert pliant.compare_replays(tmp_path / "own.replay", tmp_path / "other.replay")
    command("replay", "verify", tmp_path / "own.replay")


def test_a_simulation_is_recorded_and_verified(scene, tmp_path):
    simulation = pliant.Simulation(scene)
    pliant.record_replay(simulation, tmp_path / "a.replay", states_every=1)
    assert pliant.verify_replay(tmp_path / "a.replay", simulation)
    assert pliant.verify_replay(tmp_path / "a.replay", pliant.Simulation(scene, threads=2))
    other = copy.deepcopy(scene)
    other.forces[0].magnitude = 1000
    one = pliant.verify_replay(tmp_path / "a.replay", pliant.Simulation(other))
    assert not one and not one.holds and len(one.differences) == 1
    every = pliant.verify_replay(tmp_path / "a.replay", pliant.Simulation(other), keep_going=True)
    assert len(every.differences) > 1 and every.differences[0] == one.differences[0]
    assert every.frame_count == 12
    moved = next(each for each in every.differences if each.field == "positions")
    assert moved.surface == "sheet" and moved.size > 0 and len(moved.node) == len(moved.peaks) == 2
    assert str(moved) == moved.message and "sheet" in moved.message
    # The difference of the first frame that moves, by the positions themselves.
    own = pliant.Simulation(scene).at(moved.frame)["sheet"].object_positions
    new = pliant.Simulation(other).at(moved.frame)["sheet"].object_positions
    assert moved.size == pytest.approx(np.linalg.norm(own - new, axis=1).max(), rel=1e-12)
    assert pickle.loads(pickle.dumps(every)) == every


def test_logs_that_differ_have_a_verdict_and_damaged_ones_an_error(scene, tmp_path):
    pliant.record_replay(pliant.Simulation(scene), tmp_path / "a.replay")
    scene.surfaces[0].shape = pliant.Grid(14, 11)
    pliant.record_replay(pliant.Simulation(scene), tmp_path / "b.replay")
    verdict = pliant.compare_replays(tmp_path / "a.replay", tmp_path / "b.replay")
    assert not verdict and verdict.mismatches and not verdict.differences
    text = (tmp_path / "a.replay").read_text()
    (tmp_path / "a.replay").write_text(text[:-20])
    with pytest.raises(pliant.InvalidInput):
        pliant.compare_replays(tmp_path / "a.replay", tmp_path / "b.replay")
    with pytest.raises(pliant.Unreadable):
        pliant.verify_replay(tmp_path / "c.replay")
    with pytest.raises(pliant.InvalidInput):
        pliant.record_replay(pliant.Simulation(scene), tmp_path / "d.replay", last_frame=99)
    with pytest.raises(ValueError):
        pliant.record_replay(pliant.Simulation(scene), tmp_path / "d.replay", states_every=-1)
    with pytest.raises(TypeError):
        pliant.record_replay(scene, tmp_path / "d.replay")
    assert not (tmp_path / "d.replay").exists()


def test_what_runs_is_not_called_from_inside(scene, tmp_path):
    simulations = []
    scene.forces.append(pliant.Custom("own", lambda points, time: simulations[0].at(1) and 0,
                                      magnitude=1, deformation_radius=4, force_radius=2))  # fmt: skip
    simulations.append(pliant.Simulation(scene))
    with pytest.raises(RuntimeError, match="called from a function"):
        pliant.record_replay(simulations[0], tmp_path / "a.replay")
    assert not list(tmp_path.iterdir())
