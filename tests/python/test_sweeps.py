"""Sweeps: the numbers and the folders of the command."""

import csv
import io
import os
import signal
import threading
import time

import numpy as np
import pytest

import pliant

measures = ("peak", "peak_frame", "final", "rms", "speed", "energy", "settle", "hash")


@pytest.fixture
def file(scene, tmp_path):
    scene.surfaces[0].density = 4
    path = tmp_path / "scene.xml"
    scene.save(path)
    return path


@pytest.fixture
def loaded(file):
    return pliant.load(file)


def rows_of(table):
    """A table as the command's CSV has it, as texts."""
    return list(csv.reader(io.StringIO(table)))


def assert_same(table, rows):
    head = [name.replace("_f", "F") if name == "peak_frame" else name for name in table.dtype.names]
    assert rows[0] == head and len(rows) == 1 + len(table)
    for own, row in zip(table, rows[1:]):
        for name, value, text in zip(table.dtype.names, own.tolist(), row):
            if own["status"] != "done" and name in measures:
                assert text == "" and (isinstance(value, int) or value == "" or np.isnan(value))
            elif isinstance(value, str):
                assert value == text
            else:
                assert value == float(text)  # all bits: the command writes the shortest text of a double


def test_the_numbers_are_those_of_the_command(loaded, file, command, tmp_path):
    vary = {"sheet.damping": [1, 5.5, 20], "poke.magnitude*": "0.5:2:3"}
    sweep = pliant.Sweep(loaded, vary=vary, set={"sheet.density": 2}, frames=(3, 10))
    assert len(sweep) == 9 and sweep.paths == ("sheet.damping", "poke.magnitude*")
    table = sweep.run(threads=2)
    assert table.dtype.names == ("take", "status", *sweep.paths, *measures, "error")
    assert table.dtype["status"] == "U7" and table.dtype["sheet.damping"] == float
    command("sweep", "run", file, "-o", tmp_path / "out", "--vary", "sheet.damping=1,5.5,20", "--vary",
            "poke.magnitude*=0.5:2:3", "--set", "sheet.density=2", "--frames", "3:10", "--quiet")  # fmt: skip
    assert_same(table, rows_of((tmp_path / "out" / "takes.csv").read_text()))
    opened = pliant.SweepFolder.open(tmp_path / "out")
    assert opened.table().tobytes() == table.tobytes() and opened.paths == sweep.paths
    # And the folder that Python makes is one of the command.
    made = pliant.SweepFolder(tmp_path / "own", file, vary=vary, set={"sheet.density": 2}, frames=(3, 10))
    assert made.status() == (0, 0, 9, ()) and made.table()["status"].tolist() == ["missing"] * 9
    assert made.run(threads=2) == (9, 0, 0, ())
    csvs = [(tmp_path / name / "takes.csv").read_bytes() for name in ("own", "out")]
    assert csvs[0] == csvs[1]
    command("sweep", "status", tmp_path / "own")
    command("sweep", "run", file, "-o", tmp_path / "own", "--vary", "sheet.damping=1,5.5,20", "--vary",
            "poke.magnitude*=0.5:2:3", "--set", "sheet.density=2", "--frames", "3:10", "--quiet")  # fmt: skip


def test_a_take_has_the_bits_of_its_scene(loaded):
    sweep = pliant.Sweep(loaded, vary={"poke.center": [(0, 0, 0), (1, 0, -2)], "sheet.damping+": [0, 1]})
    table = sweep.run()
    for take in range(4):
        simulation = pliant.Simulation(sweep.scene(take))
        frames = list(simulation)
        assert table["peak"][take] == max(frame["sheet"].peak_displacement for frame in frames)
        assert table["final"][take] == frames[-1]["sheet"].peak_displacement
    assert table["poke.center"].tolist() == ["0 0 0", "0 0 0", "1 0 -2", "1 0 -2"]
    assert sweep.scene(3)["sheet"].damping == loaded["sheet"].damping + 1
    some = sweep.run([2, 0], threads=3)
    assert some["take"].tolist() == [2, 0]
    assert some.tobytes() == table[[2, 0]].tobytes()
    assert sweep.run([]).shape == (0,)


def test_columns_that_are_given_are_columns_that_come_back(loaded):
    values = np.array([0.1, 1 / 3, 1e-5])
    first = pliant.Sweep(loaded, vary={"sheet.damping": values}).run()
    assert first["sheet.damping"].tolist() == values.tolist()
    # The result is a table of takes itself, as are its columns.
    for table in (first, {"sheet.damping": values}, {"sheet.damping": values.tolist(), "note": ["a", "b,", '"']}):
        again = pliant.Sweep(loaded, table=table).run()
        assert again.tobytes() == first.tobytes()


def test_several_scenes_and_samples(loaded, command, file, tmp_path):
    other = tmp_path / "other.xml"
    softer = pliant.load(file)
    softer["sheet"].damping = 9
    softer.save(other)
    sweep = pliant.Sweep([loaded, pliant.load(other)], vary={"poke.magnitude*": "0.5:2"}, sample=3)
    table = sweep.run(threads=2)
    assert len(sweep) == 6 and table["scene"].tolist() == [str(file)] * 3 + [str(other)] * 3
    out = tmp_path / "out"
    command("sweep", "run", file, other, "-o", out, "--vary", "poke.magnitude*=0.5:2", "--sample", 3, "--quiet")
    assert_same(table, rows_of((tmp_path / "out" / "takes.csv").read_text()))
    folder = pliant.SweepFolder.open(tmp_path / "out")
    assert folder.files == (str(file), str(other)) and folder.table().tobytes() == table.tobytes()
    assert sweep.scene(5)["sheet"].damping == 9


def test_a_take_that_fails_stops_nothing(loaded):
    bad = pliant.Scene(start=1, end=3, surfaces=[loaded["sheet"]], forces=[pliant.Custom(
        "own", lambda points, time: points * 0 + (np.nan if len(points) > 120 else 1),
        magnitude=1, deformation_radius=50, force_radius=50)])  # fmt: skip
    sweep = pliant.Sweep(bad, vary={"sheet.columns": [13, 9]})
    table = sweep.run()
    assert table["status"].tolist() == ["failed", "done"]
    assert "own" in table["error"][0] and table["error"][1] == ""
    assert np.isnan(table["peak"][0]) and table["peak"][1] > 0 and table["hash"][0] == ""


def test_watch_sees_frames_and_ends_takes(loaded):
    seen = []
    sweep = pliant.Sweep(loaded, vary={"sheet.damping": [1, 5]})

    def watch(take, frame):
        seen.append((take, frame.number))
        return None if take == 0 else frame.number < 4

    told = []
    table = sweep.run(watch=watch, progress=lambda *counts: told.append(counts))
    assert seen == [(0, k) for k in range(1, 13)] + [(1, k) for k in range(1, 5)]
    assert told == [(1, 2), (2, 2)]
    shorter = pliant.Sweep(loaded, vary={"sheet.damping": [1, 5]}, frames=(1, 4)).run([1])
    assert table["hash"][1] == shorter["hash"][0]


@pytest.mark.parametrize("threads", [1, 3])
def test_what_callbacks_raise_ends_the_run(loaded, threads):
    class Enough(Exception):
        pass

    def stop(*_):
        raise Enough

    sweep = pliant.Sweep(loaded, vary={"sheet.damping": [1, 2, 3, 4]})
    for callback in ({"watch": stop}, {"progress": stop}):
        with pytest.raises(Enough):
            sweep.run(threads=threads, **callback)
    inside = lambda *_: sweep.run()  # noqa: E731
    with pytest.raises(RuntimeError, match="called from a function"):
        sweep.run(threads=threads, watch=inside)
    assert (sweep.run(threads=threads)["status"] == "done").all()


def test_folders_are_run_in_parts_and_write_animations(file, command, tmp_path):
    folder = pliant.SweepFolder(tmp_path / "out", file, vary={"sheet.damping": "1:4:4"}, write="npy")
    told = []
    assert folder.run((1, 2), progress=lambda *counts: told.append(counts)) == (2, 0, 2, ())
    assert told == [(1, 2), (2, 2)] and folder.table()["status"].tolist() == ["missing", "done"] * 2
    assert not (tmp_path / "out" / "takes.csv").exists()
    command("sweep", "run", tmp_path / "out", "--quiet")
    assert folder.status() == (4, 0, 0, ()) and (tmp_path / "out" / "takes.csv").exists()
    command("bake", file, "--set", "sheet.damping=3", "-o", tmp_path / "a.npy", "--quiet")
    assert (tmp_path / "a.npy").read_bytes() == (tmp_path / "out" / "takes" / "00002.npy").read_bytes()
    with pytest.raises(pliant.InvalidInput):
        pliant.SweepFolder(tmp_path / "out", file, vary={"sheet.damping": "1:5:4"}, write="npy")
    with pytest.raises(ValueError, match="part"):
        folder.run((2, 2))
    with pytest.raises(pliant.Error):
        pliant.SweepFolder.open(tmp_path / "none")
    with pytest.raises(pliant.InvalidInput, match="xyz"):
        pliant.SweepFolder(tmp_path / "new", file, vary={"sheet.damping": [1]}, write="xyz")
    with pytest.raises(ValueError):
        pliant.SweepFolder(tmp_path / "new", [], vary={"sheet.damping": [1]})
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    "wrong, error, words",
    [
        ({"vary": {"sheet.dampng": [1]}}, pliant.InvalidInput, "damping"),
        ({"vary": {"sheet.damping": [-1]}}, pliant.InvalidInput, "damping"),
        ({"vary": {"sheet.damping": []}}, pliant.InvalidInput, ""),
        ({"vary": {"sheet.damping": "1:2"}}, pliant.InvalidInput, "sample"),
        ({}, pliant.InvalidInput, ""),
        ({"vary": {"sheet.damping": [1]}, "frames": (1, 99)}, pliant.InvalidInput, "12"),
        ({"vary": {"sheet.damping": 3}}, TypeError, "sequence"),
        ({"vary": {"sheet.damping": [None]}}, TypeError, "None"),
        ({"vary": {"sheet.damping": ["1,2"]}}, ValueError, "table"),
        ({"vary": {"sheet.damping": ["1:2:3"]}}, ValueError, "table"),
        ({"table": {"sheet.damping": [1, 2], "sheet.density": [1]}}, ValueError, "lengths"),
        ({"table": [1, 2]}, TypeError, "dict"),
        ({"vary": {"sheet.damping": [1]}, "solver": "magic"}, ValueError, "magic"),
    ],
)
def test_what_is_wrong_is_told_before_any_run(loaded, wrong, error, words):
    with pytest.raises(error, match=words):
        pliant.Sweep(loaded, **wrong)


def test_wrong_calls(loaded):
    sweep = pliant.Sweep(loaded, vary={"sheet.damping": [1, 2]})
    for take in (2, -1):
        with pytest.raises(IndexError, match="0 to 1"):
            sweep.run([take])
        with pytest.raises(IndexError):
            sweep.scene(take)
    with pytest.raises(ValueError, match="threads"):
        sweep.run(threads=0)
    with pytest.raises(TypeError):
        pliant.Sweep("scene.xml", vary={"a.b": [1]})
    with pytest.raises(TypeError):
        pliant.Sweep([loaded, 3], vary={"sheet.damping": [1]})


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_a_run(loaded, threads):
    loaded.end = 100_000
    sweep = pliant.Sweep(loaded, vary={"sheet.damping": [1, 2]})
    started = threading.Event()

    def watch(take, frame):
        started.set()

    def interrupt():
        started.wait()
        time.sleep(0.05)
        os.kill(os.getpid(), signal.SIGINT)

    other = threading.Thread(target=interrupt)
    other.start()
    # Of two threads the one that waits has no take: Ctrl-C reaches it all the same.
    with pytest.raises(KeyboardInterrupt):
        sweep.run([0], threads=threads, watch=watch)
    other.join()
    assert len(pliant.Sweep(loaded, vary={"sheet.damping": [1]}, frames=(1, 3)).run()) == 1


def test_arguments_of_a_wrong_kind_are_named(loaded):
    for name in ("vary", "set"):
        for wrong in (None, 3, [("a", 1)], {3: [1]}):
            with pytest.raises(TypeError, match=name):
                pliant.Sweep(loaded, **{name: wrong})
    for wrong in (3, [3], "scene", None):
        with pytest.raises(TypeError, match="pliant.Scene"):
            pliant.Sweep(wrong)
    for wrong in (1j, np.complex128(1)):
        with pytest.raises(TypeError, match="sheet.damping"):
            pliant.Sweep(loaded, vary={"sheet.damping": [wrong]})
    sweep = pliant.Sweep(loaded, vary={"sheet.damping": [1, 5]})
    for wrong in ([1.5], "0", ["0"], [None]):
        with pytest.raises(TypeError):
            sweep.run(wrong)
    for wrong in ("0", 0.0, None):
        with pytest.raises(TypeError):
            sweep.scene(wrong)
    for wrong in (2, -1, 10**30):
        with pytest.raises(IndexError):
            sweep.scene(wrong)
    assert len(sweep.run(np.array([1]))) == 1 and sweep.scene(np.int8(1))["sheet"].damping == 5
