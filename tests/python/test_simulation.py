"""Simulations: the frames of `pliant bake`, as arrays."""

import copy
import gc
import json
import pickle
import weakref

import numpy as np
import pytest

import pliant


# -- Bits ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["sheet", "trampoline", "vase"])
def test_positions_are_those_of_a_bake(examples, command, tmp_path, name):
    path = examples / f"{name}.xml"
    scene = pliant.load(path)
    scene.end = min(scene.end, scene.start + 12)
    simulation = pliant.Simulation(scene)
    for surface in scene.surfaces:
        out = tmp_path / f"{surface.name}.npy"
        command("bake", path, "-o", out, "--surface", surface.name, "--frames", f"{scene.start}:{scene.end}")
        baked = np.load(out)
        assert (simulation.positions(surface.name) == baked).all()
        assert (simulation.positions(surface.name, dtype=np.float32) == baked.astype(np.float32)).all()


def test_frames_have_the_same_bits_in_any_order(scene):
    straight = pliant.Simulation(scene).positions()
    simulation = pliant.Simulation(scene, threads=2)
    for frame in (12, 3, 7, 1, 12):
        assert (simulation.at(frame)["sheet"].positions() == straight[frame - scene.start]).all()
    assert (simulation.positions(frames=[5, 2]) == straight[[4, 1]]).all()
    assert [frame.number for frame in simulation] == list(simulation.frames) == list(range(1, 13))
    for outside in (0, 13, 10**9):
        with pytest.raises(pliant.InvalidInput):
            simulation.at(outside)


def test_a_state_goes_on_in_another_simulation(scene):
    first = pliant.Simulation(scene)
    state = first.state(6)
    second = pliant.Simulation(scene)
    assert second.restore(state) == 6
    assert (second.at(12)["sheet"].positions() == first.at(12)["sheet"].positions()).all()
    with pytest.raises(pliant.InvalidInput):
        second.restore(state[:-3])
    other = copy.deepcopy(scene)
    other["sheet"].damping = 9
    with pytest.raises(pliant.InvalidInput):
        pliant.Simulation(other).restore(state)


def test_a_store_saves_what_is_solved_already(scene, tmp_path):
    for store in (pliant.MemoryStore(10**7), pliant.FolderStore(tmp_path / "states", 10**7)):
        first = pliant.Simulation(scene, store=store)
        frames = first.positions()
        again = pliant.Simulation(scene, store=store)
        assert (again.positions() == frames).all()
        assert again.frame_counts[0] == 0 and again.frame_counts[1] > 0
    assert store.trouble == ""


def test_a_simulation_has_its_own_copy(scene):
    simulation = pliant.Simulation(scene)
    before = simulation.positions()
    scene["poke"].magnitude = 1
    scene.surfaces.clear()
    assert (simulation.positions() == before).all()
    assert simulation.scene["sheet"].shape == pliant.Grid(13, 11, width=12, depth=10)
    assert simulation.scene is not simulation.scene


def test_reports_are_those_of_the_command(examples, command, tmp_path):
    path = examples / "sheet.xml"
    command("bake", path, "-o", tmp_path / "a.npy", "--regions", tmp_path / "a.json", "--frames", "1:6")
    written = json.loads((tmp_path / "a.json").read_text())
    entries = written["frames"]
    simulation = pliant.Simulation(pliant.load(path))
    for entry in entries:
        assert simulation.report(entry["frame"]) == entry


# -- Frames ----------------------------------------------------------------------------------------


def test_a_frame_is_a_mapping(scene):
    scene.surfaces.append(pliant.Surface("other", shape=pliant.Grid(4, 4)))
    frame = pliant.Simulation(scene).at(5)
    assert list(frame) == list(frame.keys()) == ["sheet", "other"] and len(frame) == 2
    assert "sheet" in frame and "none" not in frame and frame.get("none") is None
    assert [surface.name for surface in frame.values()] == ["sheet", "other"]
    with pytest.raises(KeyError, match="sheet"):
        frame["shet"]


def test_positions_go_into_any_contiguous_array(scene):
    scene["sheet"].translate = (1, 2, 3)
    scene["sheet"].rotate = (0, 30, 10)
    surface = pliant.Simulation(scene).at(6)["sheet"]
    world = surface.positions()
    homogeneous = np.c_[surface.object_positions, np.ones(len(world))] @ surface.transform.T
    assert np.allclose(world, homogeneous[:, :3], rtol=0, atol=1e-12)
    assert (surface.positions(space="object") == surface.object_positions).all()
    for dtype in (np.float32, np.float64):
        for order in "CF":
            out = np.full(world.shape, np.nan, dtype, order=order)
            assert surface.positions(out=out) is out
            assert (out == world.astype(dtype)).all()
    frozen = np.zeros(world.shape)
    frozen.flags.writeable = False
    for wrong in (
        np.zeros((3, 3)), np.zeros(world.shape, int), np.zeros(world.shape, ">f8"), frozen, [[0]],
        np.zeros((len(world), 6))[:, ::2], np.zeros(world.shape + (1,)), np.zeros(world.shape, np.float16),
    ):  # fmt: skip
        with pytest.raises(ValueError):
            surface.positions(out=wrong)
        assert not np.any(wrong)
    with pytest.raises(ValueError, match="space"):
        surface.positions(space="screen")


def test_views_outlive_what_they_come_from(scene):
    simulation = pliant.Simulation(scene)
    frame = simulation.at(6)
    view = frame["sheet"].object_positions
    before = view.copy()
    rest = simulation.shape("sheet").rest
    assert not view.flags.writeable and not rest.flags.writeable and not view.flags.owndata
    with pytest.raises(ValueError):
        view[0, 0] = 3
    simulation.at(12)
    del simulation, frame
    gc.collect()
    assert (view == before).all() and rest.shape == (13 * 11, 3)


def test_the_rest_shape_moves_with_a_cache(scene):
    mesh = pliant.Simulation(scene).shape().mesh
    places = mesh.positions
    scene["sheet"].cache = np.array([places + (0, k, 0) for k in range(3)])
    frame = pliant.Simulation(scene).at(3)
    assert np.allclose(frame["sheet"].object_rest, places + (0, 2, 0))
    scene["sheet"].cache = ""
    frame = pliant.Simulation(scene).at(3)
    assert (frame["sheet"].object_rest == places).all()


def test_shapes_tell_what_is_simulated(scene, examples):
    shape = pliant.Simulation(scene).shape()
    assert shape.grid == (13, 11, 1 / 12, 1 / 10, "none") and shape.grid.wrap == "none"
    assert sorted(shape.vertex_nodes) == list(range(13 * 11)) and shape.nodes is None
    scene["sheet"].uv = "surface"
    shape = pliant.Simulation(scene).shape("sheet")
    assert shape.grid is None and shape.nodes == 13 * 11 and shape.pieces == 1
    assert shape.border_edges == 2 * (12 + 10) and shape.unit == (12, 10)


# -- Live ------------------------------------------------------------------------------------------


def test_a_performance_plays_what_was_played(scene):
    scene["poke"].magnitude = 0
    live = pliant.LiveSimulation(scene, records=True)
    played = [live.positions()["sheet"].positions()]
    for frame in range(1, 10):
        live["poke.magnitude"] = 100.0 * frame
        if frame == 4:
            live.set("poke.center", (1, 0, 0))
        live.advance()
        played.append(live.positions()["sheet"].positions())
    assert live.frame == 10
    performance = live.performance()
    assert (pliant.Simulation(performance).positions() == np.array(played)).all()
    with pytest.raises(pliant.InvalidInput, match="magnitude"):
        live.set("poke.magnitud", 1)
    with pytest.raises(ValueError):
        pliant.LiveSimulation(scene).performance()


# -- Custom forces ---------------------------------------------------------------------------------


def custom_like_point(force):
    """The same force as a point's, as a function."""
    center = np.array(force.center)

    def push(points, time):
        return np.tile([0.0, 1.0, 0.0], (len(points), 1))

    def distance(points, time):
        difference = points - center
        return np.sqrt(difference[:, 0] ** 2 + difference[:, 1] ** 2 + difference[:, 2] ** 2)

    return pliant.Custom(
        "poke", push, distance=distance, magnitude=force.magnitude,
        deformation_radius=force.deformation_radius, force_radius=force.force_radius,
    )  # fmt: skip


def test_a_custom_force_is_as_good_as_one_built_in(scene):
    built_in = pliant.Simulation(scene).positions()
    scene.forces = [custom_like_point(scene["poke"])]
    for threads in (1, 2):
        own = pliant.Simulation(scene, threads=threads).positions()
        assert np.allclose(own, built_in, rtol=0, atol=1e-12) and np.abs(own[:, :, 1]).max() > 0.01


def test_points_may_be_kept_and_not_changed(scene):
    kept = []

    def push(points, time):
        assert points.dtype == np.float64 and points.shape[1] == 3 and not points.flags.writeable
        assert type(time.frame) is int and type(time.seconds) is float
        kept.append((points, points.copy()))
        return np.zeros_like(points)

    scene.forces = [pliant.Custom("own", push, magnitude=1)]
    pliant.Simulation(scene).at(4)
    assert kept and all((points == copied).all() for points, copied in kept)


def test_what_a_force_raises_comes_out(scene):
    calls = []

    def push(points, time):
        calls.append(time.frame)
        if len(calls) > 3 and not recovered:
            raise LookupError("mine")
        return np.zeros_like(points) + [0, 1, 0]

    recovered = []
    scene.forces = [pliant.Custom("own", push, magnitude=50, deformation_radius=9, force_radius=9)]
    simulation = pliant.Simulation(scene)
    with pytest.raises(LookupError, match="mine") as caught:
        simulation.at(8)
    assert any("push" in str(entry.name) for entry in caught.traceback)
    recovered.append(True)
    after = simulation.positions()
    assert (after == pliant.Simulation(scene).positions()).all()


@pytest.mark.parametrize(
    "answer, error",
    [
        (lambda points: np.zeros((len(points), 2)), ValueError),
        (lambda points: None, ValueError),
        (lambda points: "no", ValueError),
        (lambda points: np.zeros((len(points) + 1, 3)), ValueError),
        (lambda points: np.full((len(points), 3), np.nan), pliant.NotFinite),
    ],
)
def test_a_wrong_answer_names_the_force(scene, answer, error):
    scene.forces = [pliant.Custom("wild", lambda points, time: answer(points), magnitude=1)]
    with pytest.raises(error, match="wild"):
        pliant.Simulation(scene).positions()


def test_a_force_must_not_call_its_own_simulation(scene):
    inside = []

    def push(points, time):
        try:
            simulation.at(1)
        except RuntimeError as caught:
            inside.append(caught)
        return np.zeros_like(points)

    scene.forces = [pliant.Custom("own", push, magnitude=1)]
    for threads in (1, 2):
        inside.clear()
        simulation = pliant.Simulation(scene, threads=threads)
        simulation.at(3)
        assert inside


# -- Errors ----------------------------------------------------------------------------------------


def test_errors_are_also_what_python_calls_them(tmp_path):
    kinds = {
        pliant.InvalidInput: ValueError, pliant.Unreadable: OSError, pliant.Unwritable: OSError,
        pliant.OutOfMemory: MemoryError, pliant.SolverFailed: ArithmeticError,
        pliant.NotFinite: ArithmeticError, pliant.Interrupted: pliant.Error,
    }  # fmt: skip
    for kind, also in kinds.items():
        assert issubclass(kind, pliant.Error) and issubclass(kind, also)
        error = kind([pliant.Problem("error", "bad", "shot.xml", 3), pliant.Problem("error", "worse")])
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is kind and again.problems == error.problems
        assert str(again) == "shot.xml:3: error: bad\nerror: worse"
        assert (again.message, again.file, again.line) == ("bad", "shot.xml", 3)
    with pytest.raises(pliant.Unreadable) as caught:
        pliant.load(tmp_path / "none.xml")
    assert caught.value.file and caught.value.line is None


def test_memory_has_a_limit(scene):
    scene["sheet"].shape = pliant.Grid(2000, 2000)
    with pytest.raises(MemoryError):
        pliant.Simulation(scene, max_memory=10**6)


def test_wrong_arguments_are_python_errors(scene):
    for wrong in (None, 3, "poke.xml", object()):
        with pytest.raises(TypeError):
            pliant.Simulation(wrong)
    for arguments in ({"threads": 0}, {"solver": "magic"}):
        with pytest.raises(ValueError):
            pliant.Simulation(scene, **arguments)
    for arguments in ({"threads": "2"}, {"store": 3}, {"colour": 1}, {"max_memory": "1"}):
        with pytest.raises(TypeError):
            pliant.Simulation(scene, **arguments)
    simulation = pliant.Simulation(scene)
    with pytest.raises(TypeError):
        simulation.at("first")
    with pytest.raises(TypeError):
        pickle.dumps(simulation)
    with pytest.raises(KeyError, match="sheet"):
        simulation.positions("shet")
    with pytest.raises(ValueError):
        simulation.positions(dtype=int)
    scene.surfaces.append(3)
    with pytest.raises(TypeError, match="surfaces"):
        pliant.Simulation(scene)


# -- Lifetimes -------------------------------------------------------------------------------------


def test_a_simulation_dies_with_its_last_name(scene):
    marker = type("Push", (), {"__call__": lambda self, points, time: np.zeros_like(points)})()
    gone = weakref.ref(marker)
    scene.forces = [pliant.Custom("own", marker, magnitude=1)]
    simulation = pliant.Simulation(scene)
    simulation.at(2)
    scene.forces = []
    del marker
    assert gone() is not None
    del simulation
    gc.collect()
    assert gone() is None


class Holder:
    pass


@pytest.mark.parametrize("cls", [pliant.Simulation, pliant.LiveSimulation, pliant.Sweep])
@pytest.mark.parametrize("by", ["force", "distance", "should_stop"])
def test_what_refers_to_itself_is_collected(scene, cls, by):
    holder = Holder()

    def push(points, time):
        return points * 0 if holder else None

    def distance(points, time):
        return points[:, 0] * (0 if holder else 1)

    def should_stop():
        return holder is None

    functions = {"distance": distance} if by == "distance" else {}
    force = push if by == "force" else lambda points, time: points * 0
    scene.forces.append(pliant.Custom("push", force, deformation_radius=9, force_radius=9, **functions))
    if cls is pliant.Sweep:
        holder.own = cls(scene, vary={"push.magnitude": [1, 2]})
        holder.own.run()
    else:
        holder.own = cls(scene, **({"should_stop": should_stop} if by == "should_stop" else {}))
        holder.own.at(2) if cls is pliant.Simulation else holder.own.advance()
    gone = weakref.ref(holder)
    del holder, push, distance, should_stop, functions, force
    scene.forces.pop()
    gc.collect()
    assert gone() is None


def test_garbage_is_collected_while_one_is_made_and_dropped(scene):
    for _ in range(30):
        gc.set_threshold(1)
        try:
            pliant.Simulation(scene, should_stop=lambda: False).at(2)
            type("Own", (pliant.Simulation,), {})(scene).at(2)
            type("Own", (pliant.LiveSimulation,), {})(scene).advance()
        finally:
            gc.set_threshold(700, 10, 10)


def test_frames_are_whole_numbers_of_any_size(scene):
    simulation = pliant.Simulation(scene)
    for frame in (10**10, -(10**10), 2**70, 13, 0):
        for call in (simulation.at, simulation.report, simulation.state, lambda f: simulation.positions(frames=[f])):
            with pytest.raises(pliant.InvalidInput, match=str(frame)):
                call(frame)
    for frame in (1.5, "1", None):
        with pytest.raises(TypeError, match="frame"):
            simulation.at(frame)
    for frames in (5, "12", [1.5]):
        with pytest.raises(TypeError, match="frame"):
            simulation.positions(frames=frames)
    assert simulation.at(np.int64(3)).number == 3
    frame = simulation.at(3)
    assert "\udc80" not in frame
    with pytest.raises(KeyError):
        frame["\udc80"]
    with pytest.raises(ValueError, match="max_memory"):
        pliant.Simulation(scene, max_memory=-1)
    with pytest.raises(TypeError, match="value"):
        pliant.LiveSimulation(scene).set("poke.magnitude", "x")


def test_an_error_of_one_call_is_not_that_of_the_next(scene):
    def push(points, time):
        raise ValueError("it pushes")

    told = []

    def should_stop():
        if told:
            raise KeyError(told[-1])
        return False

    scene.forces.append(pliant.Custom("push", push, deformation_radius=9, force_radius=9))
    simulation = pliant.Simulation(scene, threads=2)
    for _ in range(3):
        with pytest.raises(ValueError, match="it pushes"):
            simulation.at(2)
    stopping = pliant.Simulation(scene, threads=2, should_stop=should_stop)
    for name in ("old", "new"):
        told.append(name)
        with pytest.raises((KeyError, ValueError)) as raised:
            stopping.at(2)
        assert name in str(raised.value) or "it pushes" in str(raised.value)


def test_threads_have_a_limit(scene, tmp_path):
    for call in (
        lambda threads: pliant.Simulation(scene, threads=threads),
        lambda threads: pliant.LiveSimulation(scene, threads=threads),
        lambda threads: pliant.bake(scene, tmp_path / "a.npy", threads=threads),
        lambda threads: pliant.preview(scene, threads=threads),
        lambda threads: pliant.Sweep(scene, vary={"sheet.damping": [1]}).run(threads=threads),
        lambda threads: pliant.record_replay(pliant.Simulation(scene), tmp_path / "a.replay", threads=threads),
    ):
        for threads in (0, -1, 1025, 10**7):
            with pytest.raises(ValueError, match="threads"):
                call(threads)


def test_frames_that_no_file_has_are_told(scene):
    for start in (2**31 - 1, -(2**31)):
        scene.start = scene.end = start
        with pytest.raises(pliant.InvalidInput, match="start"):
            scene.check()
