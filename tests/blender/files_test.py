"""Import, export and bake. Run by inside.py."""

import contextlib
import os
import random
import re
import struct
import tempfile
import unittest
import zlib

import addon_utils
import bmesh
import bpy
import numpy as np
from built import clear, force, key, messages, sheet, shown, update

from pliant_blender import exporting, pliant, properties, translate

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")


def fresh():
    clear()
    return bpy.context.scene


def rounded(scene):
    """The scene with the meshes in single precision that Blender has: what a force selects may differ by a row."""
    simulation = pliant.Simulation(scene)
    for part in scene.surfaces:
        mesh = simulation.shape(part.name).mesh
        if isinstance(part.shape, pliant.Grid):
            if part.uv == "surface":
                part.unit = part.unit or (part.shape.width, part.shape.depth)
            else:
                part.uv = "grid"
        more: dict = {"uvs": mesh.uvs.astype(np.float32), "corner_uvs": mesh.corner_uvs} if len(mesh.uvs) else {}
        more["attributes"] = mesh.attributes
        faces = np.split(mesh.corner_vertices, np.cumsum(mesh.face_sizes)[:-1])
        part.shape = pliant.Mesh(mesh.positions.astype(np.float32), faces, **more)
    return scene


def can_be_imported(scene):
    return not scene.colliders and not any(
        each.subdivision or each.holds or isinstance(each.shape, pliant.Nurbs) for each in scene.surfaces
    )


class Test(unittest.TestCase):
    def setUp(self):
        self.scene = fresh()
        self.stack = contextlib.ExitStack()
        self.folder = self.stack.enter_context(tempfile.TemporaryDirectory())

    def tearDown(self):
        self.stack.close()

    def file(self, text, name="scene.xml"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)
        return path


class Import(Test):
    def test_examples_come_back(self):
        """An export of an import bakes to the same positions, but for the rounding of what is put in."""
        count = 0
        for name in sorted(os.listdir(EXAMPLES)):
            if not name.endswith(".xml") or not can_be_imported(pliant.load(os.path.join(EXAMPLES, name))):
                continue
            for up in "ZY":
                with self.subTest(name=name, up=up):
                    self.scene = fresh()
                    self.scene.pliant.live = False
                    before = pliant.load(os.path.join(EXAMPLES, name))
                    bpy.ops.pliant.import_scene(filepath=os.path.join(EXAMPLES, name), up=up)
                    path = os.path.join(self.folder, f"{up}{name}")
                    bpy.ops.pliant.export_scene(filepath=path)
                    self.compare(before, pliant.load(path))
                    count += 1
        self.assertGreater(count, 20)

    def compare(self, before, after):
        self.assertEqual((before.start, before.end, before.fps), (after.start, after.end, after.fps))
        for kind in ("surfaces", "forces", "groups"):
            names = [sorted(each.name for each in getattr(scene, kind)) for scene in (before, after)]
            self.assertEqual(*names)
        one, other = pliant.Simulation(rounded(before)), pliant.Simulation(after)
        for frame in {before.start, min(before.start + 12, before.end), min(before.start + 30, before.end)}:
            a, b = one.at(frame), other.at(frame)
            for surface in before.surfaces:
                expected, found = (each[surface.name].positions() for each in (a, b))
                size = np.ptp(expected, axis=0).max()
                error = abs(expected - found).max()
                self.assertLessEqual(error, 2e-6 * size, (surface.name, frame))


    # Each attribute by itself.

    def base(self):
        grid = pliant.Grid(9, 7, width=4, depth=3)
        scene = pliant.Scene(fps=24, start=3, end=20, seed=5)
        scene.surfaces = [
            pliant.Surface("Sheet", shape=grid, density=40, damping=20, region="all", dt=0.02),
            pliant.Surface("Other", shape=grid, translate=(0, 1, 0), density=40, damping=20),
            pliant.Surface("Ball", shape=grid, uv="surface", translate=(0, 2, 0), density=40, damping=20),
        ]
        scene.groups = [pliant.Group("Hand")]
        kinds = (pliant.Point, pliant.Radial, pliant.Line, pliant.Uniform, pliant.Vortex, pliant.Noise, pliant.Inertia,
                 pliant.Pressure)  # fmt: skip
        scene.forces = [kind(kind.__name__) for kind in kinds]
        return scene

    def candidates(self, row):
        """Values that differ from the default, a constant and a curve."""
        key = pliant.Key
        if row.kind in ("number", "integer", "unsigned integer"):
            return [2]
        if row.kind == "boolean":
            return [not row.standard]
        if row.kind == "switch":
            return [False, pliant.Curve([key(3, 1, interpolation="step"), key(9, 0, interpolation="step")])]
        if row.kind == "channel":
            return [0.7, pliant.Curve([(3, 0.6), (9, 0.7), (20, 0.65)])]
        if row.kind in ("vector channel", "position"):
            curve = pliant.Curve([(3, (0.3, 0.5, 0.4)), (9, (0.7, 0.8, 0.6)), (20, (0.3, 0.2, 0.4))], after="repeat")
            path = pliant.Path([(0, 0, 0), (1, 1, 0), (2, 0, 1)], progress=pliant.Curve([(3, 0), (20, 1)]))
            return [(0.3, 0.5, 0.7), curve] + [path] * (row.kind == "position")
        if row.kind == "tangent":
            return [0.25, (0.1, 0.2, 0.3), pliant.Curve([(3, 0.0), (9, 0.5), (20, 0.1)], before="slope 0.01"),
                    pliant.Curve([(3, (0, 0, 0)), (9, (0.5, 0, 1))])]  # fmt: skip
        if row.kind in ("word", "falloff"):
            more = [pliant.Curve([(0, 1), (0.5, 0.25), (1, 0)])] * (row.kind == "falloff")
            return [each for each in row.words if each != row.standard] + more
        if row.kind == "edges":
            return [("free", "pinned", "clamped", "free")]
        if row.kind == "pair":
            return [(2, 3)]
        if row.kind == "vector":
            return [(0, 0, 1)]
        names = {"targets": ("Other", "Sheet"), "follow": "Other", "driven_by": "Other", "group": "Hand"}
        return [names[row.name]] if row.name in names else []

    def test_no_attribute_is_forgotten(self):
        done, impossible = set(), set()
        for number, part in enumerate(self.base()._all()):
            for row in part._rows.values():
                if row.name in ("name", "shape", "maps", "holds", "subdivision", "cache", "cache_start"):
                    continue
                for value in self.candidates(row):
                    scene = self.base()
                    changed = scene._all()[number]
                    setattr(changed, row.name, value)
                    if row.name == "damping_ratio":
                        changed.damping = 1
                    if row.name == "driven_by":
                        scene.surfaces[number] = pliant.Surface(part.name, shape=part.shape, driven_by=value)
                    try:
                        scene.check()
                        pliant.Simulation(scene)
                    except pliant.Error:
                        impossible.add((type(part).__name__, row.name))
                        continue
                    done.add((type(part).__name__, row.name))
                    with self.subTest(part=part.name, attribute=row.name, value=value):
                        self.check_attribute(scene, part.name, row, scene._all()[number])
        self.assertEqual(impossible - done, {("Surface", "wrap"), ("Surface", "weld")})

    def check_attribute(self, scene, name, row, part):
        path = os.path.join(self.folder, "scene.xml")
        scene.save(path)
        bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.actions])
        self.scene.pliant.live = False
        bpy.ops.pliant.import_scene(filepath=path, up="Z")
        made = translate.translate(self.scene)
        self.assertIsNotNone(made.scene, made.problems)
        found, wanted = getattr(made.scene[name], row.name), getattr(part, row.name)
        frames = np.arange(scene.start, scene.end + 1)
        if row.kind in ("channel", "switch", "vector channel", "position", "tangent") and wanted is not None:
            size = 3 if row.kind in ("vector channel", "position", "tangent") else 1
            values = [self.values(each, frames, size) for each in (found, wanted)]
            np.testing.assert_allclose(*values, rtol=2e-6, atol=2e-6 * np.ptp(values[1]))
        elif isinstance(wanted, pliant.Curve):
            np.testing.assert_allclose(found(np.linspace(0, 1, 50)), wanted(np.linspace(0, 1, 50)), atol=1e-6)
        elif isinstance(wanted, float):
            self.assertAlmostEqual(found, wanted, 6)
        elif row.name == "uv":
            self.assertEqual(found == "surface", wanted == "surface")
        else:
            self.assertEqual(found, wanted)

    def values(self, value, frames, size):
        if isinstance(value, pliant.Path):
            return np.array([value.at(each) for each in value.progress(frames.astype(float))])
        found = np.asarray(value(frames.astype(float)) if isinstance(value, pliant.Curve) else value, float)
        if isinstance(value, pliant.Curve) and found.ndim == 1 and size > 1:
            found = found[:, None]
        return np.broadcast_to(found, (len(frames), size) if size > 1 else len(frames))

    def test_what_blender_has_not_is_named_and_nothing_is_made(self):
        before = {name: set(getattr(bpy.data, name)) for name in ("objects", "meshes", "actions", "images")}
        for example, names in (
            ("trampoline.xml", ["collider"]), ("canopy.xml", ["canopy", "net"]), ("cushion.xml", ["subdivision"]),
            ("buttons.xml", ["hold"]),
        ):  # fmt: skip
            with self.subTest(example=example):
                with self.assertRaises(RuntimeError) as caught:
                    bpy.ops.pliant.import_scene(filepath=os.path.join(EXAMPLES, example))
                for name in names:
                    self.assertIn(name, str(caught.exception))
                self.assertEqual({each[0] for each in messages()}, {"ERROR"})
                self.assertEqual({name: set(getattr(bpy.data, name)) for name in before}, before)
        for text, words in (
            ('<scene version="1" start="1" end="9" seed="4294967296"/>', "seed"),
            ('<scene version="1" start="1" end="2000000"/>', "frames"),
            ('<scene version="1" start="1" end="9"><point name="p" magnitude="1e300"/></scene>', "p: magnitude=1e"),
            ('<scene version="1" start="1" end="9"><noise name="n" seed="4294967296"/></scene>', "n: seed"),
            ('<scene version="1" start="1" end="9"><noise name="n" sed="1"/></scene>', "sed"),
            (f'<scene version="1" start="1" end="9"><noise name="{"n" * 64}"/></scene>', "names of more than 63"),
        ):
            with self.subTest(text=text):
                with self.assertRaisesRegex(RuntimeError, words):
                    bpy.ops.pliant.import_scene(filepath=self.file(text))
                self.assertEqual({name: set(getattr(bpy.data, name)) for name in before}, before)
        self.file('<scene version="1" start="1" end="9"/>')
        bpy.ops.pliant.import_scene(filepath=os.path.join(self.folder, "scene.xml"))
        self.assertEqual(messages(), [])

    def test_up_range_and_rate(self):
        text = """<scene version="1" fps="24000/1001" start="5" end="44" seed="3">
          <surface name="s"><grid columns="5" rows="5"/></surface><point name="p" center="1 2 3"/></scene>"""
        bpy.ops.pliant.import_scene(filepath=self.file(text))
        settings, render = self.scene.pliant, self.scene.render
        self.assertEqual((settings.frame_start, settings.frame_end, settings.seed), (5, 44, 3))
        self.assertEqual((self.scene.frame_start, self.scene.frame_end), (5, 44))
        self.assertEqual((render.fps, round(render.fps_base, 6)), (24, 1.001))
        place = bpy.data.objects["p"].matrix_world.translation
        np.testing.assert_allclose(place, (1, -3, 2), atol=1e-6)
        self.assertEqual(bpy.data.objects["p"].parent, settings.origin)
        self.assertEqual(bpy.data.objects["s"].parent, settings.origin)
        update()
        self.assertEqual(messages(), [])
        with self.subTest("a second one"):
            other = text.replace("24000/1001", "30").replace('end="44"', 'end="60"')
            bpy.ops.pliant.import_scene(filepath=self.file(other))
            self.assertEqual((settings.frame_end, render.fps), (44, 24))
            self.assertEqual(bpy.data.objects["p.001"].parent, settings.origin)
            self.assertEqual(len([each for each in bpy.data.objects if each.name.startswith("pliant")]), 1)
            self.assertEqual(sorted(each[2].split()[0] for each in messages()), ["end", "fps"])
        with self.subTest("z"):
            self.scene = fresh()
            bpy.ops.pliant.import_scene(filepath=self.file(text), up="Z")
            self.assertEqual(tuple(bpy.data.objects["p"].matrix_world.translation), (1, 2, 3))
            self.assertIsNone(self.scene.pliant.origin)

    def test_as_it_is_beside_what_was_turned(self):
        """Places and directions are those of the world, whatever the origin is."""
        text = """<scene version="1" start="1" end="9">
          <surface name="s"><grid columns="9" rows="9"/><transform translate="1 2 3" rotate="10 20 30"/>
          <material density="40" damping="20"/><solver region="all"/></surface>
          <point name="p" center="1 2 3" direction="1 0.5 0" magnitude="300" forceRadius="0.4" targets="s"/></scene>"""
        bpy.ops.pliant.import_scene(filepath=os.path.join(EXAMPLES, "sheet.xml"))
        path = self.file(text)
        bpy.ops.pliant.import_scene(filepath=path, up="Z")
        made = translate.translate(self.scene).scene
        made.surfaces = [made["s"]]
        made.forces = [made["p"]]
        turn = np.array(self.scene.pliant.origin.matrix_world)[:3, :3]
        found = pliant.Simulation(made).at(9)["s"].positions() @ turn.T
        np.testing.assert_allclose(found, pliant.Simulation(pliant.load(path)).at(9)["s"].positions(), atol=2e-6)

    def picture(self, name, bits, channels):
        """A picture whose first channel is a ramp, and whose others are not."""
        rng = np.random.default_rng(1)
        most = 2**bits - 1
        pixels = rng.integers(0, most, (5, 7, channels))
        pixels[:, :, 0] = np.linspace(most // 5, most, 35).reshape(5, 7)
        rows = b"".join(b"\0" + row.astype(">u2" if bits == 16 else "u1").tobytes() for row in pixels)
        header = struct.pack(">IIBBBBB", 7, 5, bits, {1: 0, 2: 4, 3: 2, 4: 6}[channels], 0, 0, 0)
        with open(os.path.join(self.folder, name), "wb") as stream:
            stream.write(b"\x89PNG\r\n\x1a\n")
            for kind, data in ((b"IHDR", header), (b"gAMA", struct.pack(">I", 45455)), (b"IDAT", zlib.compress(rows)),
                               (b"IEND", b"")):  # fmt: skip
                stream.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))

    def test_maps_of_all_sources(self):
        """Pictures of all kinds, and numbers of nodes, on grids, closed ones, and surfaces of triangles."""
        np.save(os.path.join(self.folder, "m.npy"), np.random.default_rng(2).random((9, 12)))
        shapes = ['<grid columns="12" rows="9"/>', '<grid columns="12" rows="9" uv="surface"/>']
        shapes += [f'<mesh file="{EXAMPLES}/vase.obj" wrap="u"/>', f'<mesh file="{EXAMPLES}/bust.obj" uv="surface"/>']
        sources = ["m.npy"]
        for bits in (8, 16):
            for channels in (1, 2, 3, 4):
                sources.append(f"m{bits}{channels}.png")
                self.picture(sources[-1], bits, channels)
        for shape in shapes:
            for source in sources if "grid" in shape else sources[1::3]:
                with self.subTest(shape=shape, source=source):
                    path = self.file(f"""<scene version="1" start="1" end="4"><surface name="s">{shape}
                      <material density="40" damping="20"><map channel="damping" file="{source}" low="0.5" high="2"/>
                      </material><solver region="all"/></surface><uniform name="u" magnitude="300"/></scene>""")
                    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes])
                    self.scene.pliant.live = False
                    bpy.ops.pliant.import_scene(filepath=path, up="Z")
                    made = translate.translate(self.scene)
                    self.assertIsNotNone(made.scene, made.problems)
                    a, b = (pliant.Simulation(each).at(4)["s"] for each in (pliant.load(path), made.scene))
                    moved, found = (each.positions() - each.object_rest for each in (a, b))
                    np.testing.assert_allclose(found, moved, atol=1e-5 * abs(moved).max())
                    self.assertGreater(abs(moved).max(), 0)
        self.assertEqual(list(bpy.data.images), [])

    def test_noise_keeps_the_seed_of_its_file(self):
        text = """<scene version="1" start="1" end="9" seed="3"><surface name="s"><grid columns="5" rows="5"/></surface>
          <noise name="n"/><noise name="m" seed="8"/></scene>"""
        for _ in range(2):
            bpy.ops.pliant.import_scene(filepath=self.file(text))
            text = text.replace('seed="3"', 'seed="4"')
        made = translate.translate(self.scene).scene
        seeds = {each.name: made.seed if each.seed is None else each.seed for each in made.forces}
        self.assertEqual(seeds, {"n": 3, "m": 8, "n_001": 4, "m_001": 8})

    def test_undo_and_redo(self):
        bpy.ops.ed.undo_push(message="start")
        bpy.ops.pliant.import_scene("EXEC_DEFAULT", True, filepath=os.path.join(EXAMPLES, "penguin.xml"))
        self.scene.frame_set(20)
        before = shown(bpy.data.objects["penguin"]).copy()
        bpy.ops.ed.undo_push(message="frame")
        bpy.ops.pliant.bake("EXEC_DEFAULT", True, directory=self.folder)
        bpy.ops.ed.undo()
        self.assertEqual([each.name for each in bpy.data.objects], ["penguin", "pliant.up", "walk"])
        self.assertFalse(bpy.data.objects["penguin"].hide_get())
        update()
        np.testing.assert_array_equal(shown(bpy.data.objects["penguin"]), before)
        bpy.ops.ed.undo()
        bpy.ops.ed.undo()
        self.assertEqual(list(bpy.data.objects), [])
        self.assertIsNone(bpy.context.scene.pliant.origin)
        bpy.ops.ed.redo()
        bpy.context.scene.frame_set(20)
        np.testing.assert_array_equal(shown(bpy.data.objects["penguin"]), before)

    def test_a_path_is_sampled_and_told(self):
        bpy.ops.pliant.import_scene(filepath=self.file("""<scene version="1" start="1" end="9">
          <surface name="s"><grid columns="5" rows="5"/></surface>
          <point name="p"><path attribute="center"><waypoint at="0 0 0"/><waypoint at="1 0 1"/><waypoint at="2 0 0"/>
          <animate attribute="progress"><key frame="1" value="0"/><key frame="9" value="1"/></animate></path></point>
          </scene>"""))  # fmt: skip
        self.assertEqual([each[:2] for each in messages()], [("NOTE", "p")])
        self.assertRegex(messages()[0][2], "center.*sampled")

    def test_caches_move_the_shape_at_rest(self):
        """Of all formats and starts; what inertia cannot know in Blender is an error."""
        shape = pliant.Grid(5, 5)
        rest = pliant.Simulation(pliant.Scene(surfaces=[pliant.Surface("s", shape=shape)])).shape("s").mesh.positions
        walk = rest + np.linspace(0, 1, 12)[:, None, None] ** 2 * (0.5, 1, 0)
        np.save(os.path.join(self.folder, "walk.npy"), walk)
        source = pliant.Scene(start=1, end=12, surfaces=[pliant.Surface("s", shape=shape, cache=walk, cache_start=1)])
        for ending in ("pc2", "mdd"):
            pliant.bake(source, os.path.join(self.folder, f"walk.{ending}"))
        for name in ("walk.npy", "walk.pc2", "walk.mdd"):
            for start in ("1", "3", "-1.5", "8"):
                for inertia in ("", '<inertia name="i" magnitude="3" forceRadius="9"/>'):
                    with self.subTest(name=name, start=start, inertia=inertia):
                        text = f"""<scene version="1" start="3" end="10"><surface name="s">
                          <grid columns="5" rows="5" cache="{name}" cacheStart="{start}"/>
                          <material density="40" damping="20"/><solver region="all"/></surface>{inertia}
                          <uniform name="u" magnitude="30"/></scene>"""
                        self.check_cache(text, is_whole=not inertia or start in ("1", "3"))

    def check_cache(self, text, is_whole):
        path = self.file(text)
        self.scene = fresh()
        self.scene.pliant.live = False
        if not is_whole:
            with self.assertRaisesRegex(RuntimeError, "its cache moves"):
                bpy.ops.pliant.import_scene(filepath=path)
            return
        bpy.ops.pliant.import_scene(filepath=path)
        made = translate.translate(self.scene)
        self.assertIsNotNone(made.scene, made.problems)
        one, other = pliant.Simulation(pliant.load(path)), pliant.Simulation(made.scene)
        for frame in range(3, 11):
            np.testing.assert_allclose(
                one.at(frame)["s"].positions(), other.at(frame)["s"].positions(), atol=2e-6, err_msg=str(frame)
            )


class Bake(Test):
    def build(self, **more):
        """A sheet that a keyed force moves, with modifiers and materials, in a saved file."""
        owner = sheet(**more)
        if owner.pliant.rest == "MODIFIERS":
            wave = owner.modifiers.new("Wave", "WAVE")
            wave.height, wave.width, wave.speed, wave.time_offset = 0.3, 0.7, 0.2, -4
        poke = force(magnitude=300)
        key(poke, "pliant.magnitude", (1, 0), (8, 400), (16, 0))
        key(owner, "pliant.damping", (1, 20), (20, 40))
        key(owner, "location", (1, (0, 0, 0)), (20, (1, 2, 3)))
        owner.data.materials.append(bpy.data.materials.new("Red"))
        self.scene.frame_start, self.scene.frame_end = 1, 20
        self.scene.pliant.frame_start, self.scene.pliant.frame_end = 3, 18
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(self.folder, "shot.blend"))
        update()
        return owner

    FRAMES = (-2, 0, 1, 2, 3, 4, 9, 10.25, 17, 18, 19, 30)

    def at(self, owner, frame):
        self.scene.frame_set(int(np.floor(frame)), subframe=frame % 1)
        return shown(owner).copy(), np.array(owner.evaluated_get(bpy.context.view_layer.depsgraph).matrix_world)

    def check_same(self, owner, made):
        self.assertGreater(np.ptp(self.at(owner, 9)[0][:, 2]), 0.01)
        # Of modifiers that move the shape at rest there are the frames of the scene, and the one ahead.
        frames = self.FRAMES[owner.pliant.rest == "MODIFIERS" :]
        expected = [self.at(owner, each) for each in frames]
        found = [self.at(made, each) for each in frames]
        addon_utils.disable("pliant_blender")
        without = [self.at(made, each) for each in frames]
        addon_utils.enable("pliant_blender")
        for frame, each, *others in zip(frames, expected, found, without):
            for other in others:
                np.testing.assert_array_equal(each[1], other[1])
                slack = 1e-5 * np.ptp(each[0]) if frame % 1 else 0
                np.testing.assert_allclose(each[0], other[0], rtol=0, atol=slack, err_msg=str(frame))

    def test_is_what_is_live_also_without_the_addon(self):
        for target in ("MESH_CACHE", "SHAPE_KEYS"):
            for rest in ("BASE", "MODIFIERS"):
                with self.subTest(target=target, rest=rest):
                    self.scene = fresh()
                    owner = self.build(rest=rest, region="ALL")
                    force("Swing", "INERTIA")
                    owner.modifiers.new("Fine", "SUBSURF")
                    update()
                    bpy.ops.pliant.bake(target=target, hide_original=False)
                    made = bpy.data.objects["Sheet.baked"]
                    self.assertEqual(made.modifiers[-1].type, "SUBSURF")
                    self.assertNotIn("WAVE", [each.type for each in made.modifiers])
                    self.check_same(owner, made)

    def test_all_else_stays(self):
        owner = self.build()
        other = bpy.data.collections.new("Other")
        self.scene.collection.children.link(other)
        other.objects.link(owner)
        update()
        self.scene.frame_set(7)
        action = owner.animation_data.action
        before = sorted(each.data_path for each in action.fcurves), shown(owner).copy()
        bpy.ops.pliant.bake()
        made = bpy.data.objects["Sheet.baked"]
        self.assertFalse(properties.has(made))
        self.assertEqual([each.name for each in made.data.materials], ["Red"])
        self.assertEqual(set(made.users_collection), set(owner.users_collection))
        self.assertEqual({each.data_path for each in made.animation_data.action.fcurves}, {"location"})
        self.assertEqual(sorted(each.data_path for each in action.fcurves), before[0])
        self.assertIs(owner.animation_data.action, action)
        self.assertEqual(self.scene.frame_current, 7)
        self.assertTrue(owner.hide_get() and owner.hide_render)
        self.assertFalse(made.hide_get() or made.hide_render)
        self.assertEqual(made.modifiers[0].filepath, "//pliant_cache/Sheet.pc2")
        owner.hide_set(False)
        update()
        np.testing.assert_array_equal(shown(owner), before[1])
        np.testing.assert_array_equal(shown(made), before[1])

    def test_a_second_bake_makes_another_object_and_file(self):
        owner = self.build()
        bpy.ops.pliant.bake()
        first = bpy.data.objects["Sheet.baked"]
        before = self.at(first, 9)[0]
        bpy.data.objects["Poke"].pliant.magnitude = 1
        key(bpy.data.objects["Poke"], "pliant.magnitude", (8, 900))
        bpy.ops.pliant.bake()
        second = bpy.data.objects["Sheet.baked.001"]
        self.assertNotEqual(first.modifiers[0].filepath, second.modifiers[0].filepath)
        self.assertFalse(second.hide_get() or second.hide_render)
        np.testing.assert_array_equal(self.at(first, 9)[0], before)
        owner.hide_set(False)
        np.testing.assert_array_equal(self.at(second, 9)[0], self.at(owner, 9)[0])
        self.assertGreater(abs(self.at(second, 9)[0] - before).max(), 0.01)

    def test_what_cannot_be_hidden_is_told(self):
        owner = self.build()
        key(owner, "hide_render", (1, False), (9, True))
        bpy.ops.pliant.bake(hide_original=False)
        self.assertEqual(messages(), [])
        bpy.ops.pliant.bake()
        self.assertEqual([each[:2] for each in messages()], [("WARNING", "Sheet")])

    def test_nothing_is_left_over(self):
        owner = self.build(rest="MODIFIERS")
        owner.shape_key_add(name="Basis")
        owner.shape_key_add(name="Up").data[40].co.z = 0.3
        key(owner.data.shape_keys, 'key_blocks["Up"].value', (3, 0.0), (12, 1.0))
        for target in ("MESH_CACHE", "SHAPE_KEYS"):
            before = {name: len(getattr(bpy.data, name)) for name in ("objects", "meshes", "shape_keys", "actions")}
            bpy.ops.pliant.bake(target=target, hide_original=False)
            after = {name: len(getattr(bpy.data, name)) - count for name, count in before.items()}
            has_keys = target == "SHAPE_KEYS"
            # The surface has keys of ours, so its own action is copied.
            self.assertEqual(after, {"objects": 1, "meshes": 1, "shape_keys": has_keys, "actions": 1 + has_keys})
        self.check_same(owner, bpy.data.objects["Sheet.baked.001"])

    def test_some_frames(self):
        owner = self.build()
        bpy.ops.pliant.bake(target="SHAPE_KEYS", frames=(5, 8), hide_original=False)
        made = bpy.data.objects["Sheet.baked"]
        self.assertFalse(owner.hide_get() or owner.hide_render)
        for frame in (5, 6, 8):
            np.testing.assert_array_equal(self.at(made, frame)[0], self.at(owner, frame)[0])
        with self.assertRaisesRegex(RuntimeError, "within 3 to 18"):
            bpy.ops.pliant.bake(target="SHAPE_KEYS", frames=(2, 8))

    def test_without_a_surface_it_says_so(self):
        with self.assertRaisesRegex(RuntimeError, "there is no surface"):
            bpy.ops.pliant.bake()

    def test_an_unsaved_file_has_no_folder(self):
        sheet()
        before = set(bpy.data.objects), set(bpy.data.meshes)
        with self.assertRaisesRegex(RuntimeError, "not saved"):
            bpy.ops.pliant.bake()
        self.assertIn(("ERROR", ""), [each[:2] for each in messages()])
        self.assertEqual((set(bpy.data.objects), set(bpy.data.meshes)), before)
        bpy.ops.pliant.bake(directory=self.folder)
        self.assertTrue(os.path.exists(os.path.join(self.folder, "Sheet.pc2")))
        self.assertEqual(messages(), [])

    def test_what_is_wrong_makes_nothing(self):
        owner = self.build(b=-1)
        before = set(bpy.data.objects)
        with self.assertRaisesRegex(RuntimeError, "b"):
            bpy.ops.pliant.bake()
        self.assertEqual(set(bpy.data.objects), before)
        self.assertFalse(owner.hide_render)
        self.assertFalse(os.path.exists(os.path.join(self.folder, "pliant_cache")))


OLD = """<?xml version="1.0" encoding="UTF-8"?>
<!-- A shot. -->
<scene version="1" fps="24" start="1" end="20">
  <!-- the sheet -->
  <surface name="Sheet">
    <grid columns="21" rows="21" width="2" depth="2"/>
    <material density="40"   damping="20"/> <!-- of rubber -->
    <solver dt="0.04"/>
  </surface>
  <point name="Zeta" center="0.3 0 0" magnitude="7"/>
  <!-- the first -->
  <point name="Alpha" center="0 0 0" direction="0 0 1" magnitude="5"
         deformationRadius="0.8" forceRadius="0.3">
  </point>
  <group name="Hand" center="0 0 0" deformationRadius="2"/> <!-- empty -->
  <radial name="Gone" magnitude="3"/>
</scene>
"""


class Modes(Test):
    """What is edited counts as it is, in all three."""

    def setUp(self):
        super().setUp()
        self.owner = sheet(columns=5, rows=5)
        bpy.context.view_layer.objects.active = self.owner
        bpy.ops.object.mode_set(mode="EDIT")
        form = bmesh.from_edit_mesh(self.owner.data)
        form.verts.ensure_lookup_table()
        form.verts[12].co.z = 0.5
        bmesh.update_edit_mesh(self.owner.data)

    def test_export(self):
        path = os.path.join(self.folder, "scene.xml")
        bpy.ops.pliant.export_scene(filepath=path)
        self.assertEqual(pliant.Simulation(pliant.load(path)).shape("Sheet").mesh.positions[12][2], 0.5)
        self.assertEqual(self.owner.mode, "EDIT")

    def test_bake(self):
        for target in ("MESH_CACHE", "SHAPE_KEYS"):
            bpy.ops.pliant.bake(target=target, directory=self.folder)
            self.assertEqual(self.owner.mode, "OBJECT")
        for name in ("Sheet.baked", "Sheet.baked.001"):
            self.assertEqual(shown(bpy.data.objects[name])[12][2], 0.5)

    def test_import(self):
        path = os.path.join(EXAMPLES, "trampoline.xml")
        with self.assertRaisesRegex(RuntimeError, "collider"):
            bpy.ops.pliant.import_scene(filepath=path)
        self.assertEqual(self.owner.mode, "EDIT")
        bpy.ops.pliant.import_scene(filepath=os.path.join(EXAMPLES, "sheet.xml"))
        self.assertEqual(self.owner.mode, "OBJECT")


class Export(Test):
    def build(self):
        owner = sheet()
        self.scene.pliant.frame_start, self.scene.pliant.frame_end = 1, 20
        poke = force("Poke 1", magnitude=300)
        key(poke, "pliant.magnitude", (1, 0), (8, 400), (16, 0))
        owner["x"] = 1
        return owner, poke

    def export(self, name="shot.xml", **more):
        path = os.path.join(self.folder, name)
        bpy.ops.pliant.export_scene(filepath=path, **more)
        self.assertEqual([each for each in pliant.validate(path) if each.severity == "error"], [])
        return path

    def test_bakes_to_what_is_live(self):
        owner, _ = self.build()
        group = owner.vertex_groups.new(name="soft")
        group.add(range(200), 0.5, "REPLACE")
        item = owner.pliant.maps.add()
        item.channel, item.source, item.low = "DENSITY", "soft", 0.5
        owner.pliant.rest = "MODIFIERS"
        owner.modifiers.new("Wave", "WAVE").height = 0.1
        update()
        path = self.export()
        self.assertEqual(sorted(os.listdir(self.folder)), ["shot.Sheet.cache.npy", "shot.Sheet.ply", "shot.xml"])
        simulation = pliant.Simulation(pliant.load(path))
        for frame in (1, 9, 20):
            self.scene.frame_set(frame)
            found = simulation.at(frame)["Sheet"].positions(space="object").astype(np.float32)
            np.testing.assert_array_equal(found, shown(owner))

    def test_rest_shapes_without_a_live_modifier(self):
        """What belongs behind it does so also while it is not there, as when a surface begins."""
        owner = sheet(rest="MODIFIERS", region="ALL")
        owner.modifiers.new("Wave", "WAVE").height = 0.1
        owner.modifiers.new("Fine", "SUBSURF")
        force(magnitude=300)
        self.scene.pliant.frame_end = 5
        update()
        self.assertEqual(messages(), [])
        self.assertEqual([each.name for each in owner.modifiers], ["Wave", "pliant", "Fine"])
        found = np.load(pliant.load(self.export()).surfaces[0].cache)
        self.assertGreater(abs(found[4] - found[0]).max(), 0)
        self.scene.pliant.live = False
        update()
        self.assertEqual([each.name for each in owner.modifiers], ["Wave", "Fine"])
        np.testing.assert_array_equal(np.load(pliant.load(self.export()).surfaces[0].cache), found)

    def test_forces_of_groups_may_have_any_names(self):
        self.build()
        for name in ("Right", "Left"):
            hand = bpy.data.objects.new(name, None)
            self.scene.collection.objects.link(hand)
            hand.pliant.role, hand.pliant.deformation_radius = "GROUP", 2
        for name, group in (("a", "Right"), ("b", "Left"), ("c", ""), ("d", "Right"), ("e", "Left")):
            force(name).pliant.group = bpy.data.objects.get(group)
        update()
        self.assertEqual(messages(), [])
        found = pliant.load(self.export())
        self.assertEqual([each.name for each in found.forces], ["Poke_1", "c", "b", "e", "a", "d"])

    def test_what_is_wrong_writes_nothing(self):
        owner, poke = self.build()
        owner.pliant.b = -1
        with self.assertRaisesRegex(RuntimeError, "must be greater than 0"):
            bpy.ops.pliant.export_scene(filepath=os.path.join(self.folder, "shot.xml"))
        self.assertEqual(os.listdir(self.folder), [])
        owner.pliant.b = 1
        with self.assertRaisesRegex(RuntimeError, "not saved"):
            bpy.ops.pliant.export_scene(filepath="//shot.xml")
        with self.assertRaisesRegex(RuntimeError, "there is no folder"):
            bpy.ops.pliant.export_scene(filepath=os.path.join(self.folder, "nowhere", "shot.xml"))
        path = self.file("no scene")
        with self.assertRaisesRegex(RuntimeError, "is there already"):
            bpy.ops.pliant.export_scene(filepath=path)
        self.assertEqual(os.listdir(self.folder), ["scene.xml"])
        with open(path) as stream:
            self.assertEqual(stream.read(), "no scene")

    def test_samples_are_told(self):
        _, poke = self.build()
        path = self.export(sampled=True)
        self.assertEqual(len(pliant.load(path)["Poke_1"].magnitude.keys), 18)  # of 0 to 21
        self.assertIn(("NOTE", "Poke 1"), [each[:2] for each in messages()])
        self.export()
        self.assertEqual(messages(), [])

    def test_places_are_those_of_blender(self):
        """Whatever begins to move an object only later is seen from the first frame on."""

        def influence(owner, constraint):
            constraint.influence = 0
            key(owner, 'constraints["Copy Location"].influence', (1, 0.0), (15, 1.0))

        def mute(owner, constraint):
            key(owner, 'constraints["Copy Location"].mute', (1, True), (9, False))

        def driver(_owner, constraint):
            constraint.influence = 0
            constraint.driver_add("influence").driver.expression = "frame / 40"

        def mode(owner, constraint):
            owner.constraints.remove(constraint)
            key(owner, "rotation_mode", (1, "XYZ"), (9, "ZYX"))

        for change in (influence, mute, driver, mode):
            with self.subTest(change=change.__name__):
                self.scene = fresh()
                owner, _ = self.build()
                key(owner, "location", (1, (0, 0, 0)), (20, (1, 0, 0)))
                key(owner, "rotation_euler", (1, (0.2, 0.4, 0.1)), (20, (1, 2, 3)))
                away = bpy.data.objects.new("Away", None)
                away.location = 3, 3, 3
                self.scene.collection.objects.link(away)
                constraint = owner.constraints.new("COPY_LOCATION")
                constraint.target = away
                change(owner, constraint)
                self.scene.frame_set(1)
                found = pliant.Simulation(pliant.load(self.export()))
                for frame in (1, 5, 12, 20):
                    self.scene.frame_set(frame)
                    part = found.at(frame)["Sheet"]
                    places = np.column_stack([part.positions(space="object"), np.ones(21 * 21)])
                    wanted = (np.array(owner.matrix_world) @ places.T)[:3].T
                    np.testing.assert_allclose(part.positions(), wanted, atol=1e-5)

    def test_the_same_changes_nothing(self):
        self.build()
        path = self.export()
        with open(path) as stream:
            text = stream.read()
        text = text.replace("<material ", "<!-- rubber --><material   ")
        self.file(text, "shot.xml")
        self.export()
        with open(path) as stream:
            self.assertEqual(stream.read(), text)

    def test_into_a_file_comments_and_order_stay(self):
        owner, poke = self.build()
        for name in ("Zeta", "Alpha"):
            force(name, magnitude=9, deformation_radius=0.8, force_radius=0.3)
        hand = bpy.data.objects.new("Hand", None)
        self.scene.collection.objects.link(hand)
        hand.pliant.role, hand.pliant.deformation_radius = "GROUP", 2
        poke.pliant.group = hand
        owner.pliant.damping = 25
        bpy.data.objects["Zeta"].pliant.targets.add().surface = owner
        key(bpy.data.objects["Alpha"], "location", (1, (0, 0, 0)), (9, (1, 0, 0)))
        update()
        path = self.file(OLD, "shot.xml")
        self.export()
        with open(path) as stream:
            text = stream.read()
        self.assertEqual(messages(), [])
        for each in ("A shot.", "the sheet", "of rubber", "the first", "empty"):
            self.assertIn(f"<!-- {each} -->", text)
        self.assertIn('density="40"   damping="25"', text)
        found, wanted = pliant.load(path), pliant.load(self.export("other.xml"))
        self.assertEqual([each.name for each in found.forces], ["Zeta", "Alpha", "Poke_1"])
        wanted.surfaces[0].shape = found.surfaces[0].shape
        for kind in ("surfaces", "forces", "groups"):
            for part in getattr(wanted, kind):
                self.assertEqual(part, found[part.name])
            self.assertEqual(len(getattr(found, kind)), len(getattr(wanted, kind)))
        other = pliant.load(os.path.join(self.folder, "other.xml"))
        a, b = (pliant.Simulation(each).at(9) for each in (found, other))
        np.testing.assert_allclose(a["Sheet"].positions(), b["Sheet"].positions(), atol=1e-12)

    def test_an_origin_must_stay(self):
        owner, poke = self.build()
        origin = bpy.data.objects.new("Origin", None)
        self.scene.collection.objects.link(origin)
        owner.parent = poke.parent = self.scene.pliant.origin = origin
        update()
        self.assertEqual(messages(), [])
        key(origin, "location", (1, (0, 0, 0)), (20, (1, 0, 0)))
        update()
        self.assertEqual([each[:2] for each in messages()], [("ERROR", "Origin")])
        with self.assertRaisesRegex(RuntimeError, "must not be animated"):
            bpy.ops.pliant.export_scene(filepath=os.path.join(self.folder, "shot.xml"))
        origin.animation_data_clear()
        update()
        self.export()
        self.assertEqual(messages(), [])

    def test_lines_end_as_they_did(self):
        self.build()
        for end in ("\n", "\r\n"):
            path = self.file(OLD.replace("\n", end), "shot.xml")
            self.export()
            with open(path, "rb") as stream:
                text = stream.read().decode()
            self.assertIn("Poke_1", text)
            self.assertEqual(len(re.findall("(?<!\r)\n", text)), text.count("\n") if end == "\n" else 0)

    def test_edits_of_any_scene(self):
        """Any scene into any other: nothing is written anew, and the comments of what stays are there."""
        rng = random.Random(5)
        for number in range(60):
            with self.subTest(number=number):
                before, wanted = ("shot.xml", self.any_scene(rng)), ("shot.xml", self.any_scene(rng))
                texts = []
                for name, scene in (before, wanted):
                    scene.save(os.path.join(self.folder, name))
                    with open(os.path.join(self.folder, name), "rb") as stream:
                        texts.append(stream.read())
                old = re.sub(rb"<(?!/|scene|\?)", lambda found: b"<!-- %d --><" % found.start(), texts[0])
                old = old.replace(b"\n", rng.choice([b"\n", b"\r\n"]))
                path = os.path.join(self.folder, "shot.xml")
                with open(path, "wb") as stream:
                    stream.write(old)
                self.assertEqual(exporting.write_scene(path, texts[1]), [])
                with open(path, "rb") as stream:
                    text = stream.read()
                self.assertTrue(exporting.is_same(pliant.load(path), pliant.parse(texts[1].decode(), folder=self.folder)))
                for part in before[1]._all():
                    if part.name in wanted[1]:
                        self.assertRegex(text.decode(), rf"-->\s*<\w+ name=\"{part.name}\"")

    def any_scene(self, rng):
        """Without references between parts that stay, all of which keep their kinds and groups."""
        key = pliant.Key
        made = pliant.Scene(fps=rng.choice([24, 25, 24000 / 1001]), start=1, end=rng.choice([10, 20]))
        for name in "ABC":
            if rng.random() < 0.6:
                part = pliant.Surface(name, density=rng.choice([1, 2, pliant.Curve([(1, 1), (rng.randint(2, 9), 2)])]))
                part.shape = pliant.Grid(5, rng.choice([5, 7]))
                if rng.random() < 0.5:
                    values = np.full((part.shape.rows, 5), rng.uniform(0.5, 1))
                    part.maps = [pliant.Map(rng.choice(["b", "density"]), values=values)]
                    part.poisson = 0
                made.surfaces.append(part)
        made.groups = [pliant.Group(name, center=(rng.random(), 0, 0)) for name in "GH" if rng.random() < 0.8]
        groups = {each.name for each in made.groups}
        for name, kind, group in (("p", pliant.Point, ""), ("q", pliant.Radial, "G"), ("r", pliant.Line, "G"),
                                  ("s", pliant.Noise, ""), ("t", pliant.Point, "H")):  # fmt: skip
            if rng.random() < 0.7 and (not group or group in groups):
                part = kind(name, group=group)
                part.magnitude = rng.choice([0, 1, pliant.Curve([(1, 1), (rng.randint(2, 9), 2)])])
                part.enabled = rng.choice([True, False, pliant.Curve([key(1, 1, interpolation="step"), key(5, 0)])])
                part.falloff = rng.choice(["constant", "smooth", pliant.Curve([(0, 1), (1, rng.choice([0, 0.5]))])])
                made.forces.append(part)
        rng.shuffle(made.forces)
        made.forces.sort(key=lambda each: each.group)
        return made

    def test_what_is_included_stays_there(self):
        self.build()
        for name, x in (("Rig", 1), ("Own", 2)):
            force(name, location=(x, 0, 0), magnitude=9, deformation_radius=0.8, force_radius=0.3)
        rig = 'name="Rig" center="1 0 0" direction="0 0 1" magnitude="9" deformationRadius="0.8" forceRadius="0.3"'
        self.file(f"<fragment><point {rig}/></fragment>", "rig.xml")
        text = OLD.replace("<group", '<include file="rig.xml"/><group')
        path = self.file(text, "shot.xml")
        self.export()
        self.assertEqual(messages(), [])
        with open(path) as stream:
            text = stream.read()
        self.assertIn('<include file="rig.xml"/>', text)
        self.assertNotIn('"Rig"', text)
        self.assertEqual(sorted(each.name for each in pliant.load(path).forces), ["Own", "Poke_1", "Rig"])
        bpy.data.objects["Rig"].pliant.magnitude = 8
        self.export()
        self.assertEqual(pliant.load(path)["Rig"].magnitude, 8)
        self.assertEqual([each[0] for each in messages()], ["WARNING"])

    def test_maps_come_and_go(self):
        owner, _ = self.build()
        path = self.export()
        group = owner.vertex_groups.new(name="soft")
        group.add(range(200), 0.5, "REPLACE")
        item = owner.pliant.maps.add()
        item.channel, item.source, item.low = "DENSITY", "soft", 0.5
        self.export()
        found = pliant.load(path)
        self.assertEqual([(each.channel, each.low) for each in found.surfaces[0].maps], [("density", 0.5)])
        owner.pliant.maps.clear()
        self.export()
        self.assertEqual(pliant.load(path).surfaces[0].maps, [])
        self.assertEqual(messages(), [])
