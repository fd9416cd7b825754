"""Curves in files of other programs: those of the command."""

import json

import numpy as np
import pytest

import pliant

endings = ("json", "gltf", "glb", "anim")


@pytest.fixture
def curves():
    return {
        "poke.magnitude": pliant.Curve([(1, 0.1), pliant.Key(6, 900, out_tangent=3), (12, 0)]),
        "poke.center": pliant.Curve([(1, (0, 0, 0)), (12, (1, 0.5, -2))]),
        "sheet.rotate": pliant.Curve([(1, (0, 10, 0)), (9, (0, 40, 5))]),
    }


@pytest.mark.parametrize("ending", endings)
def test_the_bytes_are_those_of_the_command(scene, curves, command, tmp_path, ending):
    for path, curve in curves.items():
        scene.set(path, curve)
    file = tmp_path / "scene.xml"
    scene.save(file)
    losses = pliant.write_curves(curves, tmp_path / f"own.{ending}", first=1, last=12)
    options = [word for path in curves for word in ("--channel", path)]
    command("export", "curves", file, "-o", tmp_path / f"other.{ending}", "--quiet", *options)
    assert (tmp_path / f"own.{ending}").read_bytes() == (tmp_path / f"other.{ending}").read_bytes()
    assert all(loss.message and loss.curve for loss in losses)


@pytest.mark.parametrize("ending", ["json", "anim"])
def test_what_is_written_is_read_back(curves, tmp_path, ending):
    name = tmp_path / f"a.{ending}"
    pliant.write_curves(curves, name)
    file = pliant.read_curves(name)
    assert file.losses == () or all(loss.is_exact for loss in file.losses)
    frames = np.linspace(-2, 15, 50)
    by_name = {}
    for each in file.curves:
        by_name.setdefault(each.group, {})[each.component] = each
        assert isinstance(each.curve, pliant.Curve) and each.curve.dimension == 1
    for path, curve in curves.items():
        parts = by_name[path]
        values = curve(frames)
        scale = np.abs(values).max()
        if curve.dimension == 1:
            assert list(parts) == [None]
            np.testing.assert_allclose(parts[None].curve(frames), values, atol=2e-4 * scale)
        else:
            assert sorted(parts) == [0, 1, 2]
            for k in range(3):
                np.testing.assert_allclose(parts[k].curve(frames), values[:, k], atol=2e-4 * scale)


def test_keys_of_blender_are_exact(tmp_path):
    curve = pliant.Curve([(1, 0.1), (4, 1 / 3), pliant.Key(9, 2, interpolation="linear"), (12, -1e-7)])
    pliant.write_curves({"a.magnitude": curve}, tmp_path / "a.json", fps=25)
    file = pliant.read_curves(tmp_path / "a.json")
    assert file.fps == 25 and len(file.curves) == 1
    read = file.curves[0].curve
    assert [(key.frame, key.value) for key in read.keys] == [(key.frame, key.value) for key in curve.keys]
    assert json.loads((tmp_path / "a.json").read_text())


def test_units_follow_the_attributes(tmp_path):
    one = pliant.Curve([(1, (0, 0, 0)), (5, (1, 2, 3))])
    pliant.write_curves({"s.rotate": one, "s.translate": one, "p.center": one}, tmp_path / "a.anim")
    units = {each.group: each.unit for each in pliant.read_curves(tmp_path / "a.anim").curves}
    assert units["s.rotate"] == "degrees" and units["s.translate"] == "length"


def test_seconds_become_frames(tmp_path):
    curve = pliant.Curve([(1, 0), (25, 1)])
    pliant.write_curves({"s.translate": pliant.Curve([(1, (0, 0, 0)), (25, (1, 2, 3))])}, tmp_path / "a.glb", fps=24)
    for fps, zero in ((24, 1), (48, 1), (24, 0), (12, 100)):
        file = pliant.read_curves(tmp_path / "a.glb", fps=fps, frame_at_zero=zero)
        keys = file.curves[0].curve.keys
        assert keys[-1].frame - keys[0].frame == pytest.approx(fps)
        assert file.fps is None
    assert curve.dimension == 1


def test_what_is_wrong_is_told(curves, tmp_path):
    with pytest.raises(pliant.InvalidInput, match="ending"):
        pliant.write_curves(curves, tmp_path / "a.txt")
    with pytest.raises(pliant.InvalidInput):
        pliant.write_curves({"a.magnitude": pliant.Curve([(1, 1e300), (2, 0)])}, tmp_path / "a.glb")
    with pytest.raises(pliant.Unwritable):
        pliant.write_curves(curves, tmp_path / "none" / "a.json")
    assert not list(tmp_path.iterdir())
    with pytest.raises(pliant.Unreadable):
        pliant.read_curves(tmp_path / "none.json")
    (tmp_path / "bad.json").write_text("{")
    with pytest.raises(pliant.InvalidInput):
        pliant.read_curves(tmp_path / "bad.json")
    pliant.write_curves(curves, tmp_path / "a.json")
    for wrong in (
        {"fps": 0}, {"fps": float("nan")}, {"tolerance": -1}, {"rotate_order": "zzz"}, {"frame_at_zero": float("inf")},
    ):  # fmt: skip
        with pytest.raises(ValueError):
            pliant.read_curves(tmp_path / "a.json", **wrong)
    for wrong in ({"a.b": 3}, {3: curves["poke.magnitude"]}):
        with pytest.raises(TypeError):
            pliant.write_curves(wrong, tmp_path / "b.json")
    for wrong in ({}, {"nothing": curves["poke.magnitude"]}, {"a\n.b": curves["poke.magnitude"]}):
        with pytest.raises(ValueError):
            pliant.write_curves(wrong, tmp_path / "b.json")
    with pytest.raises(ValueError):
        pliant.write_curves(curves, tmp_path / "b.json", first=float("nan"))
    assert not (tmp_path / "b.json").exists()
