"""Documents: the text of a scene file, and operations on it."""

import copy
import inspect
import json
import pickle
import threading

import numpy as np
import pytest

import pliant
from pliant import edit

text = """<?xml version="1.0"?>
<!-- a sheet -->
<scene fps="24" start="1" end="12">
  <surface name="sheet">
    <grid columns="13" rows="11" width="12" depth="10"/>
    <material  density='4'   damping="4"/>  <!-- soft -->
  </surface>
  <point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2">
    <animate attribute="magnitude">
      <key frame="1" value="0"/>
      <key frame="6" value="900"/>
      <key frame="12" value="0"/>
    </animate>
  </point>
</scene>
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "scene.xml"
    path.write_text(text)
    return path


@pytest.fixture
def document(file):
    return pliant.SceneDocument(file)


def made(before, edits):
    """The text after edits, one after the other."""
    after = before.encode()
    for each in edits:
        end = each.at + len(each.removed.encode())
        assert after[each.at : end].decode() == each.removed
        after = after[: each.at] + each.inserted.encode() + after[end:]
    return after.decode()


def test_an_edit_changes_only_what_it_must(document):
    change = document.apply(edit.Set("sheet.density", 5.5))
    assert document.text == text.replace("density='4'", "density='5.5'")
    assert made(text, change.edits) == document.text
    assert change.parts == ("sheet.density",) and change.name == "set sheet.density"
    assert document.scene["sheet"].density == 5.5


def test_values_are_what_a_channel_takes(document):
    for value, as_text in [
        (3, "3"), (2.5, "2.5"), (0.1 + 0.2, "0.30000000000000004"), (np.float32(0.5), "0.5"), (1e300, "1e+300"),
        (np.int64(7), "7"), ("1.50", "1.50"),
    ]:  # fmt: skip
        assert edit.Set("sheet.density", value) == edit.Set("sheet.density", as_text)
        document.apply(edit.Set("sheet.density", value))
        assert f"density='{as_text}'" in document.text
        assert document.scene["sheet"].density == float(value)
    document.apply(edit.Set("poke.center", np.array([1, -2.5, 0.1])), edit.Set("poke.enabled", False))
    assert document.scene["poke"].center == (1, -2.5, 0.1) and document.scene["poke"].enabled is False
    document.apply(edit.Set("poke.targets", ["sheet"]), edit.Set("poke.center.y", 4))
    assert document.scene["poke"].targets == ("sheet",) and document.scene["poke"].center == (1, 4, 0.1)


def test_all_operations_on_keys(document):
    value = lambda frame: document.scene.sample("poke.magnitude", frame)  # noqa: E731
    document.apply(edit.SetKey("poke.magnitude", 9, 300))
    assert value(9) == 300
    before = value(7.5)
    document.apply(edit.SetKey("poke.magnitude", 7.5))
    assert value(7.5) == before
    document.apply(edit.DeleteKeys({"poke.magnitude": [7.5, 9]}))
    document.apply(edit.MoveKeys({"poke.magnitude": [6]}, 1, rise=100))
    assert value(7) == 1000
    with pytest.raises(pliant.InvalidInput):
        document.apply(edit.MoveKeys({"poke.magnitude": [7]}, 5))
    document.apply(edit.MoveKeys({"poke.magnitude": [7]}, 5, collision="replace"))
    assert [key.frame for key in document.scene["poke"].magnitude.keys] == [1, 12]
    document.apply(edit.SetTangent({"poke.magnitude": [1]}, side="out", tangent=50))
    assert document.scene["poke"].magnitude.keys[0].out_tangent == 50
    document.apply(edit.SetHandle("poke.magnitude", 12, (-2, 30), side="in"))
    assert document.scene["poke"].magnitude.keys[1].in_handle == (-2, 30)
    document.apply(edit.SetInterpolation({"poke.magnitude": [1]}, "elasticOut", amplitude=1.5, period=4))
    assert document.scene["poke"].magnitude.keys[0].period == 4
    document.apply(edit.SetExtrapolation("poke.magnitude", after="repeat 2"))
    assert document.scene["poke"].magnitude.after == "repeat 2"
    document.apply(edit.SetExtrapolation(["poke.magnitude"], after="hold"))
    document.apply(edit.BakeKeys(["poke.magnitude"], 1, 12, is_linear=True))
    assert len(document.scene["poke"].magnitude.keys) == 12
    document.apply(edit.Freeze(["poke.magnitude"], 12), edit.Scale("poke.magnitude", 2))
    assert document.scene["poke"].magnitude == 2 * value(1) / 2 == 2000
    document.apply(edit.Animate(["poke.magnitude"], 3), edit.Reset("sheet.damping"))
    assert document.scene["poke"].magnitude.keys == (pliant.Key(3, 2000),)


@pytest.mark.parametrize(
    "curve",
    [
        pliant.Curve([(1, 0.1), (4, 1 / 3), (12, -2e-17)]),
        pliant.Curve([pliant.Key(1, 5, interpolation="elasticOut", amplitude=2, period=3.5), (8, 7)], after="mirror"),
        pliant.Curve(
            [pliant.Key(2, 1, in_handle=(-0.3, 0.1), out_tangent=1 / 7, out_length=0.7), pliant.Key(9, 3, left=2)]
        ),
        pliant.Curve(
            [(1, 0), (5, 2)], loop=pliant.Loop(1, 5, after=2, offset=0.3), before="slope 2", overshoot="keepStart"
        ),
        pliant.Curve([(1, (0, 0.1, 2)), pliant.Key(6, (1, 2, 3), in_handle=(-1, 0.1, 0.2, 0.3))]),
    ],
)  # fmt: skip
def test_a_curve_is_set_exactly(document, curve):
    channel = "poke.center" if curve.dimension == 3 else "poke.magnitude"
    document.apply(edit.SetCurve(channel, curve))
    assert document.scene.channels()[channel] == curve
    back = pliant.SceneDocument.from_text(document.text)
    assert back.scene.channels()[channel] == curve


def test_a_piece_is_spliced_in_and_switches_step(document):
    curve = pliant.Curve([(3, 5), (5, 7)])
    document.apply(edit.Splice("poke.magnitude", 3, 6, curve))
    keys = document.scene["poke"].magnitude.keys
    assert [(key.frame, key.value) for key in keys if 3 <= key.frame <= 6] == [(3, 5), (5, 7)]
    switch = pliant.Curve([(1, 1), (5, 0)])
    document.apply(edit.SetCurve("poke.enabled", switch))
    own = document.scene
    own["poke"].enabled = switch
    assert own == document.scene
    document.apply(edit.Splice("poke.enabled", 7, 9, pliant.Curve([(7, 1), (9, 0)])))
    assert document.scene.sample("poke.enabled", [6, 7, 8, 9]).tolist() == [0, 1, 1, 0]
    document.undo()
    assert document.scene.sample("poke.enabled", [4, 5]).tolist() == [1, 0]


def test_objects(document):
    document.apply(
        edit.Add("radial", "blow", {"deformationRadius": 3, "forceRadius": 1.5, "magnitude": 20}),
        edit.Duplicate("poke", "jab"),
        edit.Rename("sheet", "cloth"),
        name="more",
    )
    assert document.undo_name == "more"
    scene = document.scene
    assert {force.name for force in scene.forces} == {"poke", "jab", "blow"}
    assert scene["blow"].deformation_radius == 3 and scene.surfaces[0].name == "cloth"
    document.apply(edit.Group(["poke", "jab"], "both"), edit.Target(["both"], "cloth"))
    assert document.scene["both"].targets == ("cloth",)
    document.apply(edit.Ungroup("both"), edit.Delete(["jab", "blow"]))
    assert [force.name for force in document.scene.forces] == ["poke"]
    document.apply(edit.SetPart("cloth", "material", {"density": 2, "damping": "3"}, comment="light"))
    assert document.scene["cloth"].damping == 3 and "<!-- light -->" in document.text


def test_undo_and_redo_come_back_to_the_byte(document):
    texts = [document.text]
    assert not document.can_undo and not document.can_redo and document.undo_name == document.redo_name == ""
    for value in range(5, 9):
        document.apply(edit.Set("sheet.density", value))
        texts.append(document.text)
    for before in texts[-2::-1]:
        after = document.text
        change = document.undo()
        assert document.text == before == made(after, change.edits)
    assert document.can_redo and not document.can_undo and document.is_saved
    assert document.redo_name == "set sheet.density"
    for after in texts[1:]:
        before = document.text
        assert made(before, document.redo().edits) == document.text == after
    with pytest.raises(pliant.Error):
        document.redo()
    assert document.apply(edit.Set("sheet.density", 8)).edits == ()


def test_a_refused_edit_changes_nothing(document):
    for wrong in [
        edit.Set("sheet.densty", 3),
        edit.Set("sheet.density", -3),
        edit.Set("sheet.density", "much"),
        edit.SetCurve("sheet.columns", pliant.Curve([(1, 3)])),
        edit.DeleteKeys({"poke.magnitude": [2]}),
        edit.DeleteKeys({"poke.magnitude": [1, 6, 12]}),
        edit.Delete("shee"),
        edit.Add("pointy", "new"),
        edit.Scale("poke.magnitude", 2, digits=-1),
    ]:
        with pytest.raises(pliant.InvalidInput) as told:
            document.apply(edit.Set("sheet.damping", 9), wrong)
        assert told.value.message and document.text == text and not document.can_undo
    with pytest.raises(pliant.InvalidInput, match="density"):
        document.apply(edit.Set("sheet.densty", 3))


def test_a_document_is_checked_as_validate_does(file):
    bad = text.replace('<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="none.obj"/>')
    file.write_text(bad)
    with pytest.raises(pliant.Error) as told:
        pliant.SceneDocument(file)
    assert list(told.value.problems) == [each for each in pliant.validate(file) if each.severity == "error"]
    document = pliant.SceneDocument.from_text(text, folder=file.parent)
    with pytest.raises(pliant.Error, match="none.obj"):
        document.apply(edit.Add("surface", "head", {"file": "none.obj"}, shape="mesh"))
    with pytest.raises(pliant.InvalidInput, match=r"own\.xml:3"):
        pliant.SceneDocument.from_text(text.replace("fps", "fsp"), name="own.xml")
    with pytest.raises(pliant.Unreadable):
        pliant.SceneDocument(file.parent / "other.xml")


def test_saving(document, file, tmp_path):
    assert document.file == str(file) and document.is_saved and not document.has_file_changed()
    document.apply(edit.Set("sheet.density", 5))
    assert not document.is_saved and file.read_text() == text
    document.save()
    assert document.is_saved and file.read_text() == document.text
    file.write_text(text)
    assert document.has_file_changed()
    document.apply(edit.Set("sheet.density", 6))
    with pytest.raises(pliant.Unwritable):
        document.save()
    assert file.read_text() == text
    document.save_as(tmp_path / "new.xml")
    assert document.file == str(tmp_path / "new.xml") and document.is_saved
    assert pliant.load(tmp_path / "new.xml") == document.scene
    untitled = pliant.SceneDocument.from_text(text, name="untitled")
    assert untitled.file == "untitled" and untitled.text == text


def test_a_document_plays_what_the_command_bakes(document, command, tmp_path):
    document.apply(edit.Set("poke.magnitude", 700))
    document.save()
    command("bake", document.file, "-o", tmp_path / "a.npy", "--quiet")
    assert np.load(tmp_path / "a.npy").tobytes() == pliant.Simulation(document.scene).positions().tobytes()


def test_operations_are_those_of_the_library():
    names = set(edit.__all__) - {"Operation"}
    assert len(names) >= 24 and {"Set", "SetKey", "MoveKeys", "SetCurve", "Splice", "Ungroup"} <= names
    for name in names:
        operation = getattr(edit, name)
        assert operation.__module__ == "pliant.edit" and operation.__name__ == name
        assert issubclass(operation, edit.Operation)
        parameters = list(inspect.signature(operation).parameters)
        assert parameters and all(each == each.lower() for each in parameters)
        assert all(f"    {each}: " in operation.__doc__ for each in parameters)


def test_operations_are_immutable_values():
    one = edit.MoveKeys({"poke.magnitude": [6, 7]}, frames=2)
    assert one == edit.MoveKeys(keys={"poke.magnitude": np.array([6, 7])}, frames=2, rise=(), collision="refuse")
    assert one != edit.MoveKeys({"poke.magnitude": [6]}, 2) and len({one, copy.copy(one)}) == 1
    assert one.frames == 2 and one.collision == "refuse"
    with pytest.raises(AttributeError):
        one.frames = 3
    curve = edit.SetCurve("a.magnitude", pliant.Curve([(1, 2)]))
    for each in (one, curve, edit.Set("a.b", True)):
        assert pickle.loads(pickle.dumps(each)) == each == copy.deepcopy(each)
    assert repr(edit.SetKey("a.magnitude", 3, 4)) == "SetKey('a.magnitude', 3.0, value='4')"


@pytest.mark.parametrize(
    "wrong, error",
    [
        (lambda: edit.Set("a.b"), TypeError),
        (lambda: edit.Set("a.b", 1, 2), TypeError),
        (lambda: edit.Set("a.b", valu=2), TypeError),
        (lambda: edit.Set("a.b", None), TypeError),
        (lambda: edit.Set(3, 1), TypeError),
        (lambda: edit.Set("a.b", pliant.Curve([(1, 2)])), TypeError),
        (lambda: edit.Set("a.b", float("nan")), ValueError),
        (lambda: edit.SetKey("a.b", float("inf")), ValueError),
        (lambda: edit.SetKey("a.b", "3"), TypeError),
        (lambda: edit.DeleteKeys(["a.b"]), (TypeError, ValueError)),
        (lambda: edit.DeleteKeys({"a.b": "3"}), TypeError),
        (lambda: edit.MoveKeys({"a.b": [1]}, collision="push"), ValueError),
        (lambda: edit.SetHandle("a.b", 1, (1, 2), "both"), ValueError),
        (lambda: edit.SetCurve("a.b", [(1, 2)]), TypeError),
        (lambda: edit.Scale("a.b", 2, digits=1.5), TypeError),
        (lambda: edit.BakeKeys("a.b", 1, 2, is_linear=1), TypeError),
    ],
)
def test_wrong_arguments_are_told_at_once(wrong, error):
    with pytest.raises(error):
        wrong()


def test_what_is_no_operation_is_refused(document):
    for wrong in ("set", {"op": "set"}, edit.Set):
        with pytest.raises(TypeError, match="pliant.edit"):
            document.apply(wrong)
    with pytest.raises(TypeError):
        pickle.dumps(document)
    assert document.text == text


def test_several_threads_may_use_one(document):
    def work(name):
        for value in range(20):
            document.apply(edit.Set(f"sheet.{name}", value + 1))
            json.dumps([document.text, document.scene.channels()["poke.magnitude"].dimension])

    threads = [threading.Thread(target=work, args=(name,)) for name in ("density", "damping")]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert document.scene["sheet"].density == document.scene["sheet"].damping == 20
    while document.can_undo:
        document.undo()
    assert document.text == text
