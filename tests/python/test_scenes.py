"""Scenes and their parts: plain objects that say what a file says."""

import copy
import inspect
import os
import pathlib
import pickle
import xml.etree.ElementTree

import numpy as np
import pytest

import pliant


def all_examples(examples):
    return sorted(path for path in examples.rglob("*.xml") if "<scene" in path.read_text())


def snake(name):
    text = "".join("_" + c.lower() if c.isupper() else c for c in name)
    return text + "_" if text in ("yield", "from") else text


def classes():
    return {name: value for name, value in vars(pliant).items() if inspect.isclass(value)}


# -- Attributes ------------------------------------------------------------------------------------

ELEMENTS = {  # elements of the schema whose attributes a class has
    "scene": "Scene", "surface": "Surface", "transform": "Surface", "material": "Surface",
    "tangents": "Surface", "solver": "Surface", "map": "Map", "hold": "Hold", "group": "Group",
    "point": "Point", "radial": "Radial", "line": "Line", "uniform": "Uniform", "vortex": "Vortex",
    "noise": "Noise", "inertia": "Inertia", "pressure": "Pressure", "collider": "Collider",
    "sphere": "Sphere", "capsule": "Capsule", "box": "Box", "plane": "Plane", "subdivision": "Subdivision",
}  # fmt: skip


def test_every_attribute_of_the_schema_is_there():
    schema = xml.etree.ElementTree.fromstring(pliant.schema())
    xs = "{http://www.w3.org/2001/XMLSchema}"
    groups = {each.get("name"): each for each in schema.iter() if each.tag in (xs + "complexType", xs + "attributeGroup", xs + "group")}

    def attributes(node, seen=()):
        for each in node.iter(xs + "attribute"):
            if each.get("name"):
                yield each.get("name")

    found = 0
    for element in schema.iter(xs + "element"):
        name = ELEMENTS.get(element.get("name"))
        if name is None:
            continue
        kind = element if element.get("type") is None else groups[element.get("type").split(":")[-1]]
        own = classes()[name]._rows
        for attribute in attributes(kind):
            if attribute in ("version", "file", "object", "uvSet", "resolution") or element.get("name") == "subdivision" and snake(attribute) not in own:
                continue
            assert snake(attribute) in own, (element.get("name"), attribute)
            found += 1
    assert found > 60


def test_every_public_name_has_a_docstring():
    for name in pliant.__all__:
        value = getattr(pliant, name)
        if inspect.ismodule(value):
            continue
        assert value.__doc__ and value.__doc__.strip(), name
        if inspect.isclass(value):
            for method, attribute in vars(value).items():
                if not method.startswith("_") and (callable(attribute) or isinstance(attribute, property)):
                    assert attribute.__doc__, f"{name}.{method}"


def test_values_are_read_back_in_one_form():
    force = pliant.Line("edge", from_=[0, 1, 2], to=np.float32([1, 1, 1]), magnitude=np.int64(3), targets="sheet")
    assert force.from_ == (0.0, 1.0, 2.0) and type(force.from_) is tuple
    assert force.to == (1.0, 1.0, 1.0) and all(type(number) is float for number in force.to)
    assert force.magnitude == 3 and type(force.magnitude) is float
    assert force.targets == ("sheet",) and force.direction is None
    surface = pliant.Surface("sheet", edges="pinned")
    assert surface.edges == ("pinned",) * 4
    surface.edges = ["free", "free", "clamped", "pinned"]
    assert surface.edges == ("free", "free", "clamped", "pinned")
    assert surface.yield_ is None and surface.damping_ratio is None


def test_what_is_wrong_with_a_value_is_told_at_once():
    force = pliant.Point("poke")
    with pytest.raises(TypeError, match="magnitude"):
        force.magnitude = "strong"
    with pytest.raises(TypeError, match="enabled"):
        force.enabled = 1
    with pytest.raises(TypeError, match="magnitude"):
        force.magnitude = None
    with pytest.raises(ValueError, match="center"):
        force.center = (1, 2)
    with pytest.raises(ValueError, match="falloff.*smooth"):
        force.falloff = "round"
    with pytest.raises(AttributeError, match="magnitude"):
        force.magnitud = 1
    with pytest.raises(TypeError, match="magnitude"):
        pliant.Point("poke", magnitud=1)
    with pytest.raises(ValueError, match="center"):
        force.center = pliant.Curve([(1, 0.0)])
    with pytest.raises(TypeError, match="columns"):
        pliant.Grid(3.5, 3)
    with pytest.raises(TypeError):
        pliant.Point()
    with pytest.raises(TypeError, match="shape"):
        pliant.Surface("sheet", shape=pliant.Sphere())
    assert force == pliant.Point("poke")


def test_a_switch_takes_curves_of_0_and_1():
    force = pliant.Point("poke", enabled=pliant.Curve([(1, 0), (5, 1)]))
    assert force.enabled([1, 4.9, 5]).tolist() == [0, 0, 1]
    with pytest.raises(ValueError, match="enabled.*0 and 1"):
        force.enabled = pliant.Curve([(1, 0), (5, 0.5)])


def test_a_part_stays_the_same_object(scene):
    assert scene.forces[0] is scene.forces[0] is scene["poke"]
    other = pliant.Scene(end=5, surfaces=scene.surfaces, forces=[scene["poke"]])
    scene["poke"].deformation_radius = 7
    assert other["poke"].deformation_radius == 7
    with pytest.raises(KeyError, match="poke"):
        scene["pokee"]


def test_ranges_and_references_are_told_together(scene):
    scene["sheet"].density = -1
    scene["poke"].targets = "cloth"
    for check in (scene.check, lambda: pliant.Simulation(scene)):
        with pytest.raises(pliant.InvalidInput) as caught:
            check()
        told = str(caught.value)
        assert "sheet.density" in told and "cloth" in told
        assert len(caught.value.problems) == len(told.splitlines()) >= 2


# -- Files -----------------------------------------------------------------------------------------


def test_examples_are_what_they_say(examples, tmp_path):
    for path in all_examples(examples):
        scene = pliant.load(path)
        assert scene.file == str(path)
        again = pliant.parse(scene.to_xml(folder=path.parent), folder=path.parent)
        assert again == scene, path
        assert copy.copy(scene) == copy.deepcopy(scene) == scene
        assert pickle.loads(pickle.dumps(scene)) == scene, path
        assert len(repr(scene)) < 200
        for part in scene._all():
            assert len(repr(part)) < 1000


def test_what_is_in_memory_is_saved_beside_the_scene(tmp_path):
    rng = np.random.default_rng(5)
    columns, rows = 5, 4
    places = np.array([(x, rng.uniform(0, 0.2), z) for z in range(rows) for x in range(columns)], float)
    faces = [
        (j * columns + i, j * columns + i + 1, (j + 1) * columns + i + 1, (j + 1) * columns + i)
        for j in range(rows - 1) for i in range(columns - 1)
    ]  # fmt: skip
    mesh = pliant.Mesh(places, faces)
    scene = pliant.Scene(
        end=6,
        surfaces=[
            pliant.Surface("skin", shape=mesh, uv="surface", maps=[pliant.Map("density", values=rng.random(20))]),
            pliant.Surface(
                "sheet",
                shape=pliant.Grid(5, 4, width=4, depth=3),
                maps=[pliant.Map("damping", values=rng.random((4, 5)), low=0.5)],
                cache=rng.random((3, 20, 3)) * 0.01 + places,
            ),
        ],
        forces=[pliant.Point("poke", magnitude=50, deformation_radius=5, force_radius=3)],
    )
    with pytest.raises(pliant.InvalidInput, match="skin|mesh"):
        scene.to_xml()
    scene.save(tmp_path / "shot.xml")
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["shot.sheet.cache.npy", "shot.sheet.damping.npy", "shot.skin.ply", "shot.xml"]
    loaded = pliant.load(tmp_path / "shot.xml")
    for name in ("skin", "sheet"):
        assert (pliant.Simulation(loaded).positions(name) == pliant.Simulation(scene).positions(name)).all()
    assert copy.deepcopy(scene) == pickle.loads(pickle.dumps(scene)) == scene


@pytest.mark.parametrize("wrap", ["none", "u", "v", "uv"])
def test_values_at_the_points_of_a_net_are_saved(tmp_path, wrap):
    rng = np.random.default_rng(6)
    points = np.array([[(x, rng.uniform(0, 0.2), z) for x in range(6)] for z in range(5)], float)
    net = pliant.Nurbs(points, degree_u=3, degree_v=2, wrap=wrap)
    scene = pliant.Scene(
        end=6,
        surfaces=[
            pliant.Surface(
                "net",
                shape=net,
                damping=3,
                maps=[pliant.Map("damping", values=rng.random((5, 6)), low=0.5)],
                holds=[pliant.Hold(values=rng.random((5, 6)), above=0.8)],
            )
        ],
        forces=[pliant.Point("poke", center=(3, 0, 2), magnitude=50, deformation_radius=5, force_radius=3)],
    )
    scene.save(tmp_path / "shot.xml")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["shot.net.damping.npy", "shot.net.hold.0.npy", "shot.xml"]
    for name, values in (("damping", scene["net"].maps[0].values), ("hold.0", scene["net"].holds[0].values)):
        assert (np.load(tmp_path / f"shot.net.{name}.npy") == values).all()
    loaded = pliant.load(tmp_path / "shot.xml")
    moved = pliant.Simulation(scene).positions()
    assert (pliant.Simulation(loaded).positions() == moved).all() and (moved[3] != moved[0]).any()
    loaded.save(tmp_path / "again.xml")
    assert (pliant.Simulation(pliant.load(tmp_path / "again.xml")).positions() == moved).all()


def test_a_custom_force_is_not_saved(scene, tmp_path):
    scene.forces.append(pliant.Custom("own", lambda points, time: 0 * points))
    for write in (scene.to_xml, lambda: scene.save(tmp_path / "shot.xml")):
        with pytest.raises(pliant.InvalidInput, match="own"):
            write()
    assert list(tmp_path.iterdir()) == []


def test_paths_may_be_objects(scene, tmp_path):
    scene.save(tmp_path / "shot.xml")
    assert pliant.load(pathlib.Path(tmp_path / "shot.xml")) == pliant.load(str(tmp_path / "shot.xml")) == scene
    with pytest.raises(TypeError):
        pliant.load(3)


def test_validate_raises_nothing(tmp_path, examples, command):
    bad = tmp_path / "bad.xml"
    bad.write_text('<scene version="1" start="1" end="x">\n<surface name="a" colour="red"/>\n</scene>\n')
    problems = pliant.validate(bad)
    assert [problem.severity for problem in problems] == ["error"] * len(problems) and len(problems) >= 2
    with pytest.raises(pliant.InvalidInput) as caught:
        pliant.load(bad)
    assert list(caught.value.problems) == problems
    assert caught.value.line == 1 and caught.value.file == str(bad)
    assert pliant.validate(tmp_path / "none.xml")[0].severity == "error"
    assert not [p for p in pliant.validate(examples / "sheet.xml") if p.severity == "error"]


def test_lines_are_those_of_the_file(examples):
    scene = pliant.load(examples / "sheet.xml")
    lines = (examples / "sheet.xml").read_text().splitlines()
    for part in scene._all():
        assert f'name="{part.name}"' in lines[scene.line_of(part.name) - 1]
    assert scene.line_of("nobody") == 0


# -- Channels --------------------------------------------------------------------------------------


def test_channels_can_be_set_by_their_paths(examples):
    for path in all_examples(examples)[::6]:
        scene = pliant.load(path)
        before = copy.deepcopy(scene)
        channels = scene.channels()
        assert channels
        for channel, value in channels.items():
            scene.set(channel, value)
        assert scene == before, path


def test_any_attribute_can_be_set(scene):
    scene.set("sheet.columns", 15)
    scene.set("poke.center.x", 2.5)
    scene.set("scene.fps", 30)
    scene.set("sheet.edges", "pinned")
    assert scene["sheet"].shape.columns == 15 and scene["poke"].center == (2.5, 0, 0) and scene.fps == 30
    for wrong, near in (("poke.magnitud", "poke.magnitude"), ("pok.magnitude", "poke"), ("poke.center.w", "x")):
        with pytest.raises(KeyError, match=near):
            scene.set(wrong, 1)


def test_changes_are_those_of_set(scene, command, tmp_path):
    scene.save(tmp_path / "shot.xml")
    scene.change("poke.magnitude*=2", "sheet.damping=7")
    assert scene["sheet"].damping == 7
    command("bake", tmp_path / "shot.xml", "-o", tmp_path / "a.npy", "--set", "poke.magnitude*=2", "--set", "sheet.damping=7")
    assert (np.load(tmp_path / "a.npy") == pliant.Simulation(scene).positions()).all()
    with pytest.raises(pliant.InvalidInput, match="poke.magnitude"):
        scene.to_xml()
    with pytest.raises(pliant.InvalidInput, match="poke.magnitud"):
        scene.change("poke.magnitud*=2")


def test_samples_have_the_bits_of_the_command(examples, command):
    path = examples / "sheet.xml"
    scene = pliant.load(path)
    channel = next(name for name, value in scene.channels().items() if isinstance(value, pliant.Curve))
    frames = np.arange(scene.start, scene.end + 1)
    curve = scene.channels()[channel]
    assert (scene.sample(channel, frames) == curve(frames)).all()
    assert scene.sample(channel, 3) == curve(3)
    assert scene.sample("poke.center" if "poke.center" in scene.channels() else channel, [1, 2]).shape[0] == 2
    with pytest.raises(KeyError):
        scene.sample("nobody.magnitude", 1)


# -- Meshes ----------------------------------------------------------------------------------------


def test_a_mesh_takes_arrays_of_any_kind():
    places = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
    plain = pliant.Mesh(places, [(0, 1, 2, 3)])
    strided = np.zeros((4, 6), np.float32)
    strided[:, ::2] = places
    for positions in (np.array(places), np.asfortranarray(np.array(places, float)), strided[:, ::2], np.array(places, np.int16)):
        for faces in ([[0, 1, 2, 3]], np.array([[0, 1, 2, 3]], np.uint8), np.array([[0, 1, 2, 3]], np.int64)):
            assert pliant.Mesh(positions, faces) == plain
    mixed = pliant.Mesh(places, [(0, 1, 2), (0, 2, 3)], uvs=[(0, 0), (1, 1)], corner_uvs=[0, 1, -1, 0, 0, 1])
    assert mixed.face_sizes.tolist() == [3, 3] and mixed.corner_vertices.tolist() == [0, 1, 2, 0, 2, 3]
    assert mixed.corner_uvs.tolist() == [0, 1, -1, 0, 0, 1] and mixed.uvs.shape == (2, 2)
    assert not mixed.positions.flags.writeable
    assert pickle.loads(pickle.dumps(mixed)) == mixed != plain


def test_what_is_wrong_with_a_mesh_is_told():
    places = [(0, 0, 0), (1, 0, 0), (1, 0, 1)]
    for arguments in (
        (places, [(0, 1, 3)]), (places, [(0, 1)]), (places, []),
        ([(0, 0, np.nan), *places[1:]], [(0, 1, 2)]),
    ):  # fmt: skip
        with pytest.raises(pliant.InvalidInput):
            pliant.Mesh(*arguments)
    for arguments in (([(0, 0)], [(0, 1, 2)]), (places, np.zeros(3, int))):
        with pytest.raises(ValueError):
            pliant.Mesh(*arguments)
    for arguments in ((["a"], [(0, 1, 2)]), (places, [(0, 1, 2.5)]), (np.zeros((3, 3), complex), [(0, 1, 2)])):
        with pytest.raises(TypeError):
            pliant.Mesh(*arguments)


def test_a_view_keeps_its_mesh():
    import gc

    places = np.random.default_rng(1).random((2000, 3))
    view = pliant.Mesh(places, [(0, 1, 2)]).positions
    gc.collect()
    assert (view == places).all()


def test_names_of_files_may_be_any_bytes(tmp_path, scene):
    folder = os.fsencode(tmp_path) + b"/\xe9t\xff"
    os.mkdir(folder)
    name = os.fsdecode(folder + b"/a\xfe.xml")
    scene.save(name)
    read = pliant.load(name, root=os.fsdecode(folder))
    assert read == scene and read.file == name
    assert pliant.validate(name) == []
    assert "point" in scene.to_xml(folder=os.fsdecode(folder))
    assert pliant.parse(scene.to_xml(), folder=os.fsdecode(folder)) == scene

    pathlib.Path(name.replace(".xml", ".obj")).write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    mesh = os.fsdecode(folder + b"/a\xfe.obj")
    assert len(pliant.read_mesh(mesh).positions) == 4
    scene.surfaces[0].shape = pliant.MeshFile(mesh)
    assert pliant.Simulation(scene).shape().mesh == pliant.read_mesh(mesh)
    assert pliant.Simulation(scene).scene.surfaces[0].shape.file == mesh
    with pytest.raises(pliant.InvalidInput, match="file"):  # XML is text
        scene.to_xml()
    with pytest.raises(pliant.InvalidInput):
        scene.save(name)
    assert pliant.load(name).surfaces[0].shape == pliant.Grid(13, 11, width=12, depth=10)

    none = os.fsdecode(folder + b"/none.xml")
    for read in (pliant.load, pliant.read_mesh):
        with pytest.raises(pliant.Error) as raised:
            read(none.replace(".xml", ".obj") if read is pliant.read_mesh else none)
        assert str(raised.value).encode()  # can be printed
    found = pliant.validate(none)
    assert found[0].file == none and str(found[0]).encode()


# -- What is kept, and what is refused -------------------------------------------------------------

CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + """vt 0 0
vt 1 0
vt 1 1
vn 0 0 1
vn 0 1 0
o box
g side
usemtl red
f 1/1/1 2/2/1 4/3/1
usemtl blue
g top
f 3/1/2 4/2/2 8/3/1
l 1 2
"""


def test_a_pickled_mesh_has_all_that_its_file_had(tmp_path):
    (tmp_path / "box.obj").write_text(CUBE)
    read = pliant.read_mesh(tmp_path / "box.obj")
    own = pliant.Mesh(np.eye(3), [(0, 1, 2)], np.eye(3)[:, :2], corner_uvs=[2, -1, 0], attributes={"\udc80": [1, 2, 3]})
    for mesh in (read, own):
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            assert pickle.loads(pickle.dumps(mesh, protocol)) == mesh
        assert copy.deepcopy(mesh) == copy.copy(mesh) == mesh
    assert read != pliant.Mesh(read.positions, [(0, 1, 3), (2, 3, 7)], read.uvs, corner_uvs=read.corner_uvs)
    texts = []
    for name, mesh in (("a", read), ("b", pickle.loads(pickle.dumps(read)))):
        (tmp_path / name).mkdir()
        scene = pliant.Scene(end=1, surfaces=[pliant.Surface("box", shape=mesh, uv="surface", enabled=False)])
        pliant.bake(scene, tmp_path / name / "box.#.obj")
        texts += [path.read_bytes() for path in (tmp_path / name).iterdir()]
    assert len(texts) == 2 and texts[0] == texts[1] and b"usemtl blue" in texts[0]


def test_a_pickled_scene_is_changed_as_it_was(scene):
    scene["poke"].center = pliant.Path([(0, 0, 0), (1, 0, 0), (2, 1, 0)], progress=pliant.Curve([(1, 0), (12, 1)]))
    scene.forces.append(pliant.Point("pull", center=pliant.Curve([(1, (0, 1, 2)), (12, (3, 4, 5))]), magnitude=40))
    scene["sheet"].maps.append(pliant.Map("density", values=np.ones((11, 13))))
    scene["sheet"].cache = np.zeros((2, 143, 3))
    scene.change("poke.magnitude*=0", "poke.center.y+=0.5", "pull.center.z=7", "poke.center.progress*=0.5")
    scene.change("pull.center.x*=2")
    for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene), copy.copy(scene)):
        assert again == scene
        for path in ("poke.magnitude", "pull.center", "poke.center.progress"):
            assert (again.sample(path, np.linspace(0, 13, 40)) == scene.sample(path, np.linspace(0, 13, 40))).all()
        assert pickle.loads(pickle.dumps(again["poke"])) == scene["poke"]
        for array in (again["sheet"].cache, again["sheet"].maps[0].values):
            assert not array.flags.writeable
    scene["sheet"].cache = ""
    scene["sheet"].maps[0].values = None
    nurbs = pliant.Nurbs(np.zeros((4, 5, 3)), degree_u=3, degree_v=3, weights=np.ones((4, 5)))
    assert not pickle.loads(pickle.dumps(nurbs)).weights.flags.writeable


def numeric_arguments():
    """Everything that takes a number, by what it must be named in an error."""
    yield "magnitude", lambda n: pliant.Point("p", magnitude=n)
    yield "center", lambda n: pliant.Point("p", center=(n, 0, 0))
    yield "fps", lambda n: pliant.Scene(fps=n)
    yield "su0", lambda n: pliant.Surface("s", su0=n)
    yield "frame", lambda n: pliant.Key(n, 0)
    yield "frame", lambda n: pliant.Curve([(n, 0)])
    yield "value", lambda n: pliant.Key(0, n)
    yield "value", lambda n: pliant.Curve([(0, (1, n, 2))])
    for name in ("in_length", "out_length", "amplitude", "period", "back", "left", "in_tangent"):
        yield name, lambda n, name=name: pliant.Key(0, 0, **{name: n})
    yield "control", lambda n: pliant.Key(0, 0, control=(n, 0, 1, 1))
    yield "out_handle", lambda n: pliant.Key(0, 0, out_handle=(n, 0))
    yield "to", lambda n: pliant.Loop(0, n)
    yield "offset", lambda n: pliant.Loop(0, 1, offset=n)
    yield "rise", lambda n: pliant.Curve([(0, 0), (1, 1)]).moved(0, n)
    yield "value_factor", lambda n: pliant.Curve([(0, 0), (1, 1)]).scaled(value_factor=n)
    yield "progress", lambda n: pliant.Path([(0, 0, 0), (1, 0, 0), (2, 1, 0)], progress=n)
    yield "frames", lambda n: pliant.Curve([(0, 0)])(n)
    yield "frames", lambda n: pliant.Curve([(0, 0)])([n, 1])
    yield "values", lambda n: pliant.Map("density", values=[[n, 1]])
    yield "cache", lambda n: pliant.Surface("s", cache=[[[n, 1, 2]]])
    yield "points", lambda n: pliant.Nurbs([[[n, 0, 0]] * 2] * 2, degree_u=1, degree_v=1)
    yield "positions", lambda n: pliant.Mesh([(n, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    yield "poke.center.x", lambda n: pliant.Scene(forces=[pliant.Point("poke")]).set("poke.center.x", n)
    yield "MoveKeys.frames", lambda n: pliant.edit.MoveKeys({"p.magnitude": [1]}, frames=n)


@pytest.mark.filterwarnings("error")
def test_a_number_is_a_real_number():
    class Real:
        def __float__(self):
            return 0.5

    for name, take in numeric_arguments():
        with pytest.raises(ValueError, match=name):
            take(10**400)
        for wrong in ("1", 1j, np.complex128(1), np.array("1"), {1}):
            if wrong == "1" and name == "in_tangent":
                continue  # a word
            with pytest.raises(TypeError, match=name):
                take(wrong)
    for number in (np.float32(0.5), np.array(0.5), np.int8(1), Real()):
        assert pliant.Point("p", magnitude=number, center=(number,) * 3).magnitude in (0.5, 1)
        assert pliant.Key(number, number, tangent=number).frame in (0.5, 1)
    for wrong in ({1, 2, 3}, {1: 2, 2: 3, 3: 4}, b"abc", "123"):
        with pytest.raises(TypeError, match="center"):
            pliant.Point("p", center=wrong)
        with pytest.raises(TypeError, match="value"):
            pliant.Key(0, wrong)


def test_a_whole_number_that_is_too_large_is_told_at_once():
    for name, least, most, take in (
        ("columns", -(2**31), 2**31 - 1, lambda n: pliant.Grid(n, 3)),
        ("start", -(2**31), 2**31 - 1, lambda n: pliant.Scene(start=n)),
        ("seed", 0, 2**64 - 1, lambda n: pliant.Scene(seed=n)),
        ("uv_set", -(2**31), 2**31 - 1, lambda n: pliant.MeshFile("m.obj", uv_set=n)),
        ("levels", -(2**31), 2**31 - 1, lambda n: pliant.Subdivision(levels=n)),
        ("after", -(2**31), 2**31 - 1, lambda n: pliant.Loop(0, 1, after=n)),
    ):
        for number in (least, most):
            take(number)
        for number in (least - 1, most + 1, 10**400):
            with pytest.raises(ValueError, match=f"{name}=-?\\d"):
                take(number)
    with pytest.raises(ValueError, match="uv_set"):
        pliant.read_mesh("m.obj", uv_set=2**31)


PLACES = [(x, 0, z) for z in range(4) for x in range(5)]
FACES = [(j * 5 + i, j * 5 + i + 1, j * 5 + i + 6, j * 5 + i + 5) for j in range(3) for i in range(4)]


def test_each_array_of_a_mesh_has_its_shape():
    corner_uvs = np.zeros(48, int)
    for name, arguments, named in (
        ("positions", (np.zeros((4, 2)), FACES), {}), ("positions", (np.zeros(12), FACES), {}),
        ("positions", ([], FACES), {}), ("faces", (PLACES, np.array([0, 1, 2])), {}),
        ("faces", (PLACES, np.zeros((2, 2, 3), int)), {}), ("a face", (PLACES, [[[0, 1, 2]]]), {}),
        ("a face", (PLACES, [(0, 1, 2**40)]), {}), ("a face", (PLACES, [(0, 1, 10**30)]), {}),
        ("faces", (PLACES, np.array([[0, 1, 2**64 - 1]], np.uint64)), {}),
        ("uvs", (PLACES, FACES, np.zeros((20, 3))), {}), ("uvs", (PLACES, FACES, np.zeros((3, 2))), {}),
        ("corner_uvs", (PLACES, FACES), {"corner_uvs": corner_uvs}),
        ("corner_uvs", (PLACES, FACES, [(0, 0)]), {"corner_uvs": corner_uvs.reshape(12, 4)}),
        ("corner_uvs", (PLACES, FACES, [(0, 0)]), {"corner_uvs": np.full(48, 2**64 - 1, np.uint64)}),
        ('"?a"?', (PLACES, FACES), {"attributes": {"a": np.zeros((4, 5))}}),
        ("name", (PLACES, FACES), {"attributes": {"": np.zeros(20)}}),
    ):  # fmt: skip
        with pytest.raises(pliant.InvalidInput, match=name):
            pliant.Mesh(*arguments, **named)
    for faces in (3, None):
        with pytest.raises(TypeError, match="faces"):
            pliant.Mesh(PLACES, faces)
    with pytest.raises(TypeError, match="attribute"):
        pliant.Mesh(PLACES, FACES, attributes={3: np.zeros(20)})
    whole = pliant.Mesh(PLACES, FACES)
    assert pliant.Mesh(PLACES, np.array(FACES, object)) == whole == pliant.Mesh(np.array(PLACES, object), FACES)


def test_values_of_a_map_have_the_shape_of_its_surface(scene):
    def put(shape, values):
        scene["sheet"].shape = shape
        scene["sheet"].uv = "surface" if isinstance(shape, pliant.Mesh) else "auto"
        for kind, name in ((pliant.Map("density", values=values), "maps"), (pliant.Hold(values=values), "holds")):
            scene["sheet"].maps, scene["sheet"].holds = [], []
            setattr(scene["sheet"], name, [kind])
            scene.check()

    grid, mesh = pliant.Grid(5, 4), pliant.Mesh(PLACES, FACES)
    net = pliant.Nurbs(np.reshape(PLACES, (4, 5, 3)), degree_u=2, degree_v=1)
    written = len(pliant.Simulation(pliant.Scene(surfaces=[pliant.Surface("net", shape=net)])).shape().vertex_nodes)
    for shape in (grid, net):
        put(shape, np.ones((4, 5)))
    put(mesh, np.ones(20))
    refused = [(shape, wrong) for shape in (grid, net) for wrong in ((5, 4), (2, 10), (19,), (3, 5))]
    for shape, values in (*refused, (grid, (20,)), (net, (written,)), (mesh, (4, 5)), (mesh, (19,))):
        with pytest.raises(pliant.InvalidInput, match="sheet"):
            put(shape, np.ones(values))
    for values in (3, np.ones((2, 2, 5))):
        with pytest.raises(ValueError, match="values"):
            pliant.Map("density", values=values)
    put(grid, np.ones((4, 5)))
    own = scene["sheet"].holds[0].values
    scene.change("sheet.columns=7")  # what is to be done with the values comes next
    assert scene["sheet"].holds[0].values is own
    with pytest.raises(pliant.InvalidInput):
        scene.check()
    scene.change("sheet.columns=5")
    scene.check()


def test_lists_have_parts_of_their_kind(scene):
    for list_name, wrong in (("maps", 3), ("maps", pliant.Grid(3, 3)), ("holds", pliant.Map("density"))):
        with pytest.raises(TypeError, match=list_name):
            pliant.Surface("s", **{list_name: [wrong]})
        getattr(scene["sheet"], list_name).append(wrong)
        for use in (scene.check, scene.channels, lambda: pliant.Simulation(scene)):
            with pytest.raises(TypeError, match=list_name):
                use()
        getattr(scene["sheet"], list_name).clear()
    with pytest.raises(TypeError, match="Force"):
        pliant.Force("x")
    assert pliant.Collider("floor", shape=pliant.Plane()).shape == pliant.Plane()
    for list_name in ("surfaces", "forces", "groups", "colliders"):
        with pytest.raises(TypeError, match=list_name):
            pliant.Scene(**{list_name: [pliant.Grid(3, 3)]})
        getattr(scene, list_name).append("junk")
        for use in (scene.check, lambda: scene["zz"], lambda: scene.set("zz.x", 1), lambda: "zz" in scene):
            with pytest.raises(TypeError, match=list_name):
                use()
        getattr(scene, list_name).pop()
    assert "poke" in scene and "zz" not in scene and 3 not in scene
    with pytest.raises(TypeError):
        list(scene)
    with pytest.raises(TypeError, match="path"):
        scene.set(3, 1)


def test_paths_name_what_there_is(scene):
    scene["sheet"].subdivision = pliant.Subdivision()
    scene.set("sheet.levels", 3)
    assert scene["sheet"].subdivision.levels == 3
    scene["sheet"].subdivision = None
    for path in ("poke.magnitude.x", "sheet.edges.x", "poke.deformation_radius.y", "sheet.levels"):
        with pytest.raises(KeyError):
            scene.set(path, 3)


def test_lines_are_found_by_names_of_python(examples):
    scene = pliant.load(examples / "sheet.xml")
    for part in scene._all():
        for name, row in part._rows.items():
            assert scene.line_of(part.name, name) == scene.line_of(part.name, row.attribute)
    assert any(scene.line_of(part.name, "deformation_radius") for part in scene.forces)


def test_a_change_keeps_the_objects_that_it_leaves(scene):
    sheet = scene["sheet"]
    sheet.maps = [pliant.Map("density", values=np.ones((11, 13))), pliant.Map("damping", values=np.ones((11, 13)))]
    sheet.holds = [pliant.Hold(values=np.ones((11, 13)))]
    before = {name: getattr(sheet, name) for name in ("shape", "maps", "holds")}
    objects = [*sheet.maps, *sheet.holds, scene["poke"], scene["poke"].magnitude, sheet, scene.forces]
    scene.change("sheet.damping=7", "poke.center.x=1")
    assert sheet.damping == 7 and scene["poke"].center == (1, 0, 0)
    assert all(getattr(sheet, name) is value for name, value in before.items())
    after = [*sheet.maps, *sheet.holds, scene["poke"], scene["poke"].magnitude, scene["sheet"], scene.forces]
    assert all(a is b for a, b in zip(objects, after))
    shared = sheet.shape
    scene.surfaces.append(pliant.Surface("other", shape=shared))
    sheet.maps, sheet.holds = [], []
    scene.change("sheet.columns=15")
    assert scene["other"].shape is shared and shared.columns == 13 and sheet.shape.columns == 15


def test_a_switch_keeps_nothing_that_shapes_a_motion():
    shaped = pliant.Curve(
        [
            pliant.Key(1, 0, out_handle=(2, 0.5)),
            pliant.Key(5, 1, in_handle=(-2, 0), out_tangent="flat", out_length=1),
            pliant.Key(9, 0, interpolation="step", in_tangent=3),
        ],
        overshoot="contain",
    )
    scene = pliant.Scene(start=1, end=9, forces=[pliant.Point("p", enabled=shaped)])
    scene.surfaces.append(pliant.Surface("s"))
    assert pliant.parse(scene.to_xml()) == scene
    assert scene.sample("p.enabled", [1, 4, 5, 8, 9]).tolist() == [0, 0, 1, 1, 0]


def test_a_switch_that_steps_stays_the_same_curve():
    steps = pliant.Curve([pliant.Key(1, 0, interpolation="step"), pliant.Key(5, 1, interpolation="step")])
    assert pliant.Point("p", enabled=steps).enabled is steps


def test_attributes_that_nothing_reads_are_not_saved(tmp_path):
    mesh = pliant.Mesh(PLACES, FACES, attributes={"soft": np.linspace(0, 1, 20)})
    scene = pliant.Scene(end=2, surfaces=[pliant.Surface("a", shape=mesh, uv="surface"), pliant.Surface("b", shape=mesh, uv="surface")])
    scene["b"].maps.append(pliant.Map("density", attribute="soft", low=0.5))
    scene.save(tmp_path / "shot.xml")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["shot.a.obj", "shot.b.ply", "shot.xml"]
    assert pliant.load(tmp_path / "shot.xml")["b"].maps == scene["b"].maps


def test_the_text_of_a_scene_is_the_scene(scene):
    scene.groups.append(pliant.Group("swarm", deformation_radius=3))
    scene["poke"].group = "swarm"
    scene.surfaces.append(pliant.Surface("skin", shape=pliant.MeshFile("./m.obj"), cache="./c.npy"))
    assert pliant.parse(scene.to_xml()) == scene
    assert pliant.Point("p", deformation_radius=2) != pliant.Point("p")  # without a group it counts
    assert pliant.MeshFile("m.obj") != pliant.MeshFile("n.obj") and pliant.MeshFile("") != pliant.MeshFile(".")
    for wrong in ({"cache_start": 0.5}, {"cache": np.zeros((2, 4, 3))}, {"shape": pliant.MeshFile("m.obj"), "cache_start": 1}):
        other = copy.copy(scene)
        other.colliders = [pliant.Collider("rock", **wrong)]
        with pytest.raises(pliant.InvalidInput, match="rock.*cache"):
            other.to_xml()


def test_what_is_told_of_a_part_is_short():
    force = pliant.Custom("own", lambda points, time: 0 * points)
    nurbs = pliant.Nurbs(np.zeros((18, 18, 3)), degree_u=3, degree_v=3)
    assert len(repr(nurbs)) < 120 and len(repr(force)) < 120
    for answer, told in (
        (lambda points, time: points.astype(complex), r"shape \(\d+, 3\), not of the dtype complex128"),
        (lambda points, time: points[:, :2], r"shape \(\d+, 3\), not \(\d+, 2\)"),
        (lambda points, time: None, "not of the dtype object"),
    ):
        scene = pliant.Scene(end=2, surfaces=[pliant.Surface("s", shape=pliant.Grid(9, 9))],
                             forces=[pliant.Custom("own", answer, deformation_radius=50)])  # fmt: skip
        with pytest.raises(ValueError, match=told + "$"):
            pliant.Simulation(scene).at(2)


def test_an_error_has_a_problem():
    with pytest.raises(ValueError):
        pliant.Error([])
    assert pliant.Error("one").message == "one"
