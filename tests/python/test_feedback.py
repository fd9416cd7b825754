"""Previews and suggestions: those of the command."""

import json
import math
import pickle

import pytest

import pliant


@pytest.fixture
def several(scene):
    """A group, and a force that reaches nothing."""
    scene.surfaces[0].density = 4
    scene.groups.append(pliant.Group("both", center=(1, 0, 1), deformation_radius=3.5))
    for name, magnitude in (("one", 50), ("other", -20)):
        scene.forces.append(pliant.Radial(name, group="both", center=(1, 1, 1), force_radius=2, magnitude=magnitude))
    scene.forces.append(pliant.Point("far", center=(40, 0, 0), deformation_radius=3, force_radius=1, magnitude=5))
    return scene


def test_a_preview_is_that_of_the_command(several, command, tmp_path):
    file = tmp_path / "scene.xml"
    several.save(file)
    told = json.loads(command("info", file, "--json"))
    previews = pliant.preview(several)
    assert [each.of for each in previews] == ["force"] * 4 + ["group", "all"]
    by_name = {each.force or each.group or "": each for each in previews}
    assert list(by_name) == ["poke", "one", "other", "far", "both", ""]
    found = []

    def look(value):
        """Finds the previews in the command's answer, wherever they are."""
        if isinstance(value, dict):
            if "staticPeak" in value and "selected" in value:
                found.append(value)
            for each in value.values():
                look(each)
        elif isinstance(value, list):
            for each in value:
                look(each)

    look(told)
    assert len(found) == len(previews)
    own = sorted((each.static_peak if each.is_solved else -1, each.frame or -1) for each in previews)
    told = [(-1 if each["staticPeak"] is None else each["staticPeak"], each["frame"] or -1) for each in found]
    assert own == sorted(told)


def test_what_a_preview_says_is_so(several):
    previews = {each.force or each.group or "": each for each in pliant.preview(several, threads=2)}
    poke, far, both, every = (previews[name] for name in ("poke", "far", "both", ""))
    assert poke.surface == "sheet" and poke.largest_magnitude == poke.magnitude == 900
    assert poke.largest_magnitude_frame == poke.frame == 4 and poke.is_every_frame and poke.is_solved
    i0, i1, j0, j1 = poke.selected
    assert 0 <= i0 < i1 < 13 and 0 <= j0 < j1 < 11 and poke.counts is None
    assert poke.static_peak > 0 and poke.gap is None and poke.shares == ()
    assert far.frame is None and far.selected is None and not far.is_solved
    assert far.gap.to_vertex > far.gap.deformation_radius == 3
    assert far.gap.to_vertex == pytest.approx(34)  # from x = 6, the border, to x = 40
    assert [each.force for each in both.shares] == ["one", "other"]
    assert math.fsum(each.share for each in both.shares) == pytest.approx(1)
    region = poke.regions[0]
    assert region.is_solvable and region.has_vibration and region.first_frequency > 0
    assert region.static_peak == poke.static_peak and region.settling.frames >= 0
    peak = max(frame["sheet"].peak_displacement for frame in pliant.Simulation(several))
    assert every.played.peak == pytest.approx(peak, rel=1e-12)
    assert pickle.loads(pickle.dumps(poke)) == poke


def test_a_mesh_has_counts(scene):
    n = 9
    points = [(i, 0, j + 0.2 * (i % 2)) for j in range(n) for i in range(n)]
    faces = [(j * n + i, j * n + i + 1, (j + 1) * n + i) for j in range(n - 1) for i in range(n - 1)]
    faces += [(j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i) for j in range(n - 1) for i in range(n - 1)]
    scene.surfaces[0].shape = pliant.Mesh(points, faces)
    scene.forces[0].center = (4, 0, 4)
    poke = pliant.preview(scene)[0]
    assert poke.selected is None and poke.counts.cells > 0 and poke.counts.inside_nodes > 0


def test_a_suggestion_meets_its_goals_as_the_command_does(scene, command, tmp_path):
    scene.surfaces[0].density = 4
    file = tmp_path / "scene.xml"
    scene.save(file)
    before = scene["poke"].magnitude
    found = pliant.suggest(scene, peak=0.5)
    assert found.meets_goals and found.settling is found.frequency is None
    assert found.peak.wanted == 0.5 and found.peak.found == pytest.approx(0.5, rel=0.02)
    assert found.peak.obstacle is found.peak.reason is None
    assert scene["poke"].magnitude == before != found.scene["poke"].magnitude
    peak = max(frame["sheet"].peak_displacement for frame in pliant.Simulation(found.scene))
    assert peak == pytest.approx(found.peak.found, rel=1e-9)
    told = json.loads(command("suggest", file, "--peak", "0.5", "--json"))
    assert [each._asdict() for each in found.values] == [
        {"path": each["channel"], **{name: each[name] for name in ("before", "after", "keys")}}
        for each in told["values"]
    ]
    assert found.peak.found == told["peak"]["found"] and list(found.notes) == told["notes"]
    assert found.values[0].path == "poke.magnitude" and found.values[0].keys == 3


def test_a_goal_out_of_reach_has_a_reason(scene, command, tmp_path):
    scene.surfaces[0].density = 4
    file = tmp_path / "scene.xml"
    scene.save(file)
    found = pliant.suggest(scene, frequency=1000, force="poke", surface="sheet")
    told = json.loads(command("suggest", file, "--ring", "1000Hz", "--force", "poke", "--json", status=1))
    assert not found.meets_goals and found.frequency.obstacle == told["frequency"]["obstacle"] is not None
    assert found.frequency.reason == told["frequency"]["reason"]


def test_what_is_wrong_is_told(scene):
    for wrong in ({}, {"peak": 0}, {"peak": float("nan")}, {"peak": 1, "force": "pok"}, {"peak": 1, "surface": "x"}):
        with pytest.raises(pliant.InvalidInput):
            pliant.suggest(scene, **wrong)
    for wrong in ({"peak": "1"}, {"peak": 1, "force": 3}):
        with pytest.raises(TypeError):
            pliant.suggest(scene, **wrong)
    with pytest.raises(TypeError):
        pliant.preview("scene.xml")
    scene.surfaces[0].damping = -1
    with pytest.raises(pliant.InvalidInput, match="damping"):
        pliant.preview(scene)


def test_a_force_in_python_is_previewed(scene):
    scene.forces.append(pliant.Custom("own", lambda points, time: points * 0 + (0, 9, 0),
                                      magnitude=1, deformation_radius=4, force_radius=2))  # fmt: skip
    own = next(each for each in pliant.preview(scene) if each.force == "own")
    assert own.is_solved and own.static_peak > 0
    assert isinstance(pliant.suggest(scene, peak=1, force="poke").scene["own"], pliant.Custom)
    scene.forces[1].force = lambda points, time: 1 / 0
    with pytest.raises(ZeroDivisionError):
        pliant.preview(scene)
