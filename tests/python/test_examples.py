"""The scripts of examples/python: what they write, and that their own checks can fail."""

import csv
import html
import importlib.util
import pathlib
import re
import subprocess
import sys
import types

import numpy as np
import PIL.Image
import pytest

import pliant

pytestmark = pytest.mark.no_sanitizer  # what it calls is in the other tests
root = pathlib.Path(__file__).parents[2]
folder = root / "examples" / "python"


def run(script, *arguments, cwd, status=0):
    """Runs a script as a process of its own; what it printed."""
    done = subprocess.run([sys.executable, script, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout if status == 0 else done.stderr


def imported(name):
    """The functions and numbers of a script, without running it."""
    spec = importlib.util.spec_from_file_location(f"example_{name}", folder / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def altered(name, tmp_path, *changes):
    """A copy of a script in which texts are replaced."""
    text = (folder / f"{name}.py").read_text(encoding="utf-8")
    for before, after in changes:
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    copy = tmp_path / f"{name}.py"
    copy.write_text(text, encoding="utf-8")
    return copy


def assert_writes(name, where, *files):
    """These and no others, as its first lines tell."""
    assert sorted(path.name for path in where.iterdir()) == sorted(files)
    head = (folder / f"{name}.py").read_text(encoding="utf-8").partition("\nimport ")[0]
    for file in files:
        assert file in head


def assert_picture(path, size):
    """A PNG of a size, on which there is something, also in all of its quarters."""
    assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    with PIL.Image.open(path) as image:
        assert image.format == "PNG" and image.size == size
        pixels = np.asarray(image.convert("RGB")).astype(int)
    height, width = pixels.shape[:2]
    for half in (pixels[: height // 2], pixels[height // 2 :]):
        for quarter in (half[:, : width // 2], half[:, width // 2 :]):
            is_drawn = np.abs(quarter - 255).max(axis=2) > 40
            assert 0.005 < is_drawn.mean() < 0.995
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 50


# -- All of them -----------------------------------------------------------------------------------


def test_every_example_is_tested_and_told_of():
    files = [path for path in folder.iterdir() if path.name != "__pycache__"]
    page = (root / "docs" / "python.md").read_text(encoding="utf-8")
    for path in files:
        assert path.suffix == ".py"
        assert any(name.startswith(f"test_{path.stem}_") for name in globals()), path
        assert f"[{path.name}](../examples/python/{path.name})" in page
    told = re.findall(r"\(\.\./examples/python/(\w+\.py)\)", page)
    assert sorted(told) == sorted(path.name for path in files)


# -- displacement.py -------------------------------------------------------------------------------


def assert_tells_peaks(printed, scene):
    frames = list(pliant.Simulation(scene))
    for surface in scene.surfaces:
        peaks = [frame[surface.name].peak_displacement for frame in frames]
        told = re.search(rf"^{surface.name}: (\S+) at frame (\d+), vertex (\d+)$", printed, re.MULTILINE)
        # As many digits as are printed.
        assert float(told[1]) == pytest.approx(max(peaks), rel=1e-3)
        assert int(told[2]) == scene.start + np.argmax(peaks)
        moved = frames[int(told[2]) - scene.start][surface.name]
        distances = np.linalg.norm(moved.object_positions - moved.object_rest, axis=1)
        assert int(told[3]) == distances.argmax()


def test_displacement_plots_the_peaks_of_a_scene(examples, tmp_path):
    printed = run(folder / "displacement.py", cwd=tmp_path)
    assert_writes("displacement", tmp_path, "displacement.png")
    assert_picture(tmp_path / "displacement.png", (900, 600))
    assert_tells_peaks(printed, pliant.load(examples / "sheet.xml"))


def test_displacement_takes_any_scene(tmp_path, scene):
    scene.surfaces.append(pliant.Surface("still", shape=pliant.Grid(4, 4), translate=(40, 0, 0)))
    pushed = tmp_path / "pushed.xml"
    scene.save(pushed)
    scene.forces.clear()
    still = tmp_path / "still.xml"
    scene.save(still)
    for file in (pushed, still):
        out = tmp_path / "out" / file.stem
        printed = run(folder / "displacement.py", out, "--scene", file, cwd=tmp_path)
        assert_tells_peaks(printed, pliant.load(file))
        assert_writes("displacement", out, "displacement.png")


# -- study.py --------------------------------------------------------------------------------------


def test_study_finds_the_same_in_processes(tmp_path):
    out = tmp_path / "out" / "study"
    printed = run(folder / "study.py", out, cwd=tmp_path)
    study = imported("study")
    takes = len(pliant.Sweep(study.make_scene(), vary=study.VARY))
    assert f"{takes} takes, the same bits in one process and in 2\n" in printed
    assert_writes("study", out, "study.csv", "study.png")
    assert_picture(out / "study.png", (1000, 400))

    with open(out / "study.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["take"]) for row in rows] == list(range(takes))
    # By a third way: a simulation of the scene, edited by hand.
    row = rows[17]
    scene = study.make_scene()
    for path in study.VARY:
        scene.set(path, float(row[path]))
    frames = list(pliant.Simulation(scene))
    assert float(row["peak"]) == max(frame["sheet"].peak_displacement for frame in frames)
    assert float(row["final"]) == frames[-1]["sheet"].peak_displacement

    told = re.search(r"at frame (\d+): density (\S+), damping (\S+)$", printed, re.MULTILINE)
    far = [row for row in rows if float(row["peak"]) >= 1]
    quickest = min(far, key=lambda row: int(row["settle"]))
    assert [quickest["settle"], *(float(quickest[path]) for path in study.VARY)] == [
        told[1], float(told[2]), float(told[3])
    ]  # fmt: skip


def test_study_ends_with_1_if_a_process_finds_something_else(tmp_path):
    script = altered(
        "study", tmp_path,
        ("[5, 10, 20, 40, 80]", "[5, 10]"),  # fewer, to be quick
        ("[2, 5, 10, 20, 40, 80, 160, 320]", "[2]"),
        ("sweep = pliant.Sweep(make_scene(), vary=VARY)",
         "sweep = pliant.Sweep(make_scene(), vary=VARY, set={'sheet.b': 1 + 1e-12})"),
    )  # fmt: skip
    assert "other bits" in run(script, tmp_path / "out", cwd=tmp_path, status=1)
    assert not list((tmp_path / "out").iterdir())


# -- fit.py ----------------------------------------------------------------------------------------


def test_fit_finds_the_hidden_values(tmp_path):
    printed = run(folder / "fit.py", cwd=tmp_path)
    assert_writes("fit", tmp_path, "fit.png", "fit.xml")
    assert_picture(tmp_path / "fit.png", (900, 600))
    fit = imported("fit")
    fitted = pliant.load(tmp_path / "fit.xml")
    magnitude = max(key.value for key in fitted["poke"].magnitude.keys)
    found = np.array([magnitude, fitted["sheet"].density, fitted["sheet"].damping])
    # The noise is 1 % of the motion. The damping acts on the few swings after the push alone, and is known
    # to 4 %; the others to 1 %.
    assert (np.abs(fit.GUESS / fit.HIDDEN - 1) > 0.3).all()
    assert (np.abs(found / fit.HIDDEN - 1) < [0.04, 0.02, 0.12]).all()
    for name, value in zip(fit.NAMES, found):
        told = re.search(rf"^{name} .* fitted +(\S+) ±", printed, re.MULTILINE)
        assert float(told[1]) == pytest.approx(value, rel=1e-4)
    # Without noise, which the fit does not need, it finds them exactly.
    exact, shares = fit.fit(fit.heights(fit.HIDDEN))
    assert exact == pytest.approx(fit.HIDDEN, rel=1e-4) and (shares < 1e-4).all()


# -- custom_force.py -------------------------------------------------------------------------------


def test_custom_force_does_what_a_line_does_and_then_crawls(tmp_path):
    out = tmp_path / "out"
    printed = run(folder / "custom_force.py", out, cwd=tmp_path)
    assert float(re.search(r"differs from a line by (\S+) of", printed)[1]) < 1e-9
    assert_writes("custom_force", out, "crawl.npy", "crawl.png")
    assert_picture(out / "crawl.png", (1200, 500))

    force = imported("custom_force")
    positions = np.load(out / "crawl.npy")
    frames, vertices = positions.shape[:2]
    assert vertices == force.NODES**2 and f"crawling, {frames} frames" in printed
    heights = positions[:, :, 1]
    assert not heights[0].any()
    told = float(re.search(r"up to (\S+) high", printed)[1])
    assert told == pytest.approx(heights.max(), rel=1e-2)
    # The ridge follows the body: it is under the highest vertex at every frame from when it pushes fully.
    for frame in range(24, frames + 1, 6):
        highest = positions[frame - 1][heights[frame - 1].argmax()] * (1, 0, 1)
        assert force.nearest(highest[None], force.crawling(frame / force.FPS))[0][0] < force.HOW["force_radius"]
    assert 0 < force.FRAME <= frames


def test_custom_force_depends_on_no_number_of_points():
    """What the script says of its functions."""
    force = imported("custom_force")
    own = force.force_of(force.crawling, tapers=True)
    points = np.random.default_rng(1).uniform(-9, 9, (500, 3))
    time = pliant.ForceTime(40, 40 / force.FPS)
    for function in (own.force, own.distance):
        whole = function(points, time)
        for size in (1, 7, 333):
            parts = [function(points[first : first + size], time) for first in range(0, len(points), size)]
            assert np.concatenate(parts).tobytes() == whole.tobytes()


def test_custom_force_ends_with_1_if_it_is_no_line(tmp_path):
    script = altered("custom_force", tmp_path, ("result[:, 1] = 1\n", "result[:, 1] = 1 + 1e-6\n"))
    assert "same" in run(script, tmp_path / "out", cwd=tmp_path, status=1)
    assert not list((tmp_path / "out").iterdir())


# -- notebook.py -----------------------------------------------------------------------------------


@pytest.fixture
def page(scene):
    if pliant.Simulation(scene)._repr_html_() is None:
        pytest.skip("a build without the viewer's page")


def test_notebook_writes_what_a_notebook_shows(page, tmp_path):
    out = tmp_path / "out"
    printed = run(folder / "notebook.py", out, cwd=tmp_path)
    assert_writes("notebook", out, "drops.html", "notebook.html")
    shown = re.findall(r'<iframe [^>]*srcdoc="([^"]*)"></iframe>', (out / "notebook.html").read_text(encoding="utf-8"))
    pages = [html.unescape(text) for text in shown]
    # The first is the page by itself; the second has other values.
    assert len(pages) == 2 and pages[0] == (out / "drops.html").read_text(encoding="utf-8")
    assert pages[1] != pages[0] and pages[1].startswith("<!doctype html>")
    assert "(72, 3721, 3), float64\n" in printed


def test_notebook_shows_simulations_below_its_cells(page, tmp_path, monkeypatch, capsys):
    """One cell after the other, as a notebook runs them."""
    shown = []
    display = types.ModuleType("IPython.display")
    display.display = shown.append
    monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    monkeypatch.setitem(sys.modules, "IPython", types.ModuleType("IPython"))
    monkeypatch.setattr(sys, "argv", ["ipykernel_launcher.py", "-f", "kernel.json"])
    monkeypatch.chdir(tmp_path)
    text = (folder / "notebook.py").read_text(encoding="utf-8")
    cells = re.split(r"^# %%(.*)\n", text, flags=re.MULTILINE)[1:]
    names = {}
    for kind, cell in zip(cells[::2], cells[1::2]):
        if kind == " [markdown]":
            assert all(line.startswith("#") for line in cell.strip().split("\n"))
        else:
            assert kind == ""
            exec(compile(cell, "cell", "exec"), names)
    assert [type(each) for each in shown] == [pliant.Simulation] * 2 and shown[0] is names["simulation"]
    # The page is that of a file to send to others, and nothing else is written.
    assert [path.name for path in tmp_path.iterdir()] == ["drops.html"]
    calm = shown[1].scene
    assert calm["sheet"].damping != names["scene"]["sheet"].damping and "float64" in capsys.readouterr().out
