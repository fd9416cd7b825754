"""Operators that make and take away, materials, set-ups and suggestions, and what panels draw."""

import os
import subprocess
import tempfile
import types
import unittest

import bpy
import numpy as np
from built import clear

from pliant_blender import edit, fcurves, panels, pliant, properties, setups, translate

LEVELS = ("ERROR", "WARNING", "NOTE")


class Case(unittest.TestCase):
    def setUp(self):
        clear()
        self.scene = bpy.context.scene

    def refuse(self, operator, message, **arguments):
        """That an operator raises, tells the same in the list of messages, and changes nothing else."""
        before = self.look()
        with self.assertRaisesRegex(RuntimeError, message) as caught:
            operator(**arguments)
        self.assertEqual(self.look(), before)
        told = [each.text for each in self.scene.pliant.messages if each.level == "ERROR"]
        self.assertIn(str(caught.exception).removeprefix("Error: ").strip(), told)

    def look(self):
        return [
            (each.name, properties.raw(each), tuple(each.location), each.select_get(), fcurves_of(each), each.mode)
            for each in self.scene.objects
        ], edit.active(bpy.context)

    def alone(self, force, surface, frames=250):
        """How far a force alone moves a surface in the end, as it is played."""
        found = translate.translate(self.scene)
        self.assertIsNotNone(found.scene, found.problems)
        scene, name = found.scene, found.part_of[force.name]
        scene.forces = [each for each in scene.forces if each.name == name]
        scene.end = scene.start + frames
        return pliant.Simulation(scene).at(scene.end)[found.part_of[surface.name]].peak_displacement

    def messages(self, *levels):
        return [(each.object, each.text) for each in self.scene.pliant.messages if each.level in (levels or LEVELS)]


def fcurves_of(owner):
    return {
        key: [tuple(point.co) for point in curve.keyframe_points]
        for key, curve in fcurves.table(owner.animation_data).items()
    }


def select(*owners):
    for each in bpy.context.view_layer.objects:
        each.select_set(each in owners)
    bpy.context.view_layer.objects.active = owners[-1] if owners else None


def add(kind="POINT", **arguments):
    bpy.ops.pliant.add_force(kind=kind, **arguments)
    return bpy.context.view_layer.objects.active


def sheet(**arguments):
    bpy.ops.pliant.add_surface(**arguments)
    return bpy.context.view_layer.objects.active


class Surfaces(Case):
    def test_a_sheet_is_a_grid_node_by_node(self):
        owner = sheet(name="Mat", columns=5, rows=4, width=8, depth=3, location=(1, 2, 3))
        mesh = owner.data
        self.assertEqual((owner.name, tuple(owner.location), len(mesh.vertices), len(mesh.polygons)),
                         ("Mat", (1, 2, 3), 20, 12))  # fmt: skip
        for j in range(4):
            for i in range(5):
                wanted = np.float32([(i / 4 - 0.5) * 8, (j / 3 - 0.5) * 3, 0])
                np.testing.assert_array_equal(np.float32(mesh.vertices[j * 5 + i].co), wanted)
        for polygon in mesh.polygons:
            self.assertEqual(tuple(polygon.normal), (0, 0, 1))
        for loop, uv in zip(mesh.loops, mesh.uv_layers.active.data):
            wanted = np.float32([loop.vertex_index % 5 / 4, loop.vertex_index // 5 / 3])
            np.testing.assert_array_equal(np.float32(uv.uv), wanted)
        self.assertEqual(properties.role(owner), "SURFACE")
        found = translate.translate(self.scene)
        self.assertIsNotNone(pliant.Simulation(found.scene).shape("Mat").grid)
        self.assertTrue(owner.select_get() and edit.active(bpy.context) == owner)

    def test_the_first_surface_takes_over_the_frames(self):
        self.scene.frame_start, self.scene.frame_end = 5, 77
        sheet()
        self.assertEqual((self.scene.pliant.frame_start, self.scene.pliant.frame_end), (5, 77))
        self.scene.frame_start, self.scene.frame_end = 1, 10
        sheet()
        self.assertEqual((self.scene.pliant.frame_start, self.scene.pliant.frame_end), (5, 77))
        bpy.ops.pliant.match_range()
        self.assertEqual((self.scene.pliant.frame_start, self.scene.pliant.frame_end), (1, 10))

    def test_wrong_sizes(self):
        for wrong in ({"columns": 2}, {"rows": -5}, {"width": 0}, {"depth": -1}, {"columns": 10**5, "rows": 10**5}):
            self.refuse(bpy.ops.pliant.add_surface, next(iter(wrong)), **wrong)
        self.assertFalse(bpy.data.meshes)

    def test_in_any_mode_and_collection(self):
        first = sheet()
        for mode in ("EDIT", "SCULPT", "WEIGHT_PAINT"):
            select(first)
            bpy.ops.object.mode_set(mode=mode)
            made = sheet()
            self.assertEqual((first.mode, made.mode), ("OBJECT", "OBJECT"))
        collection = bpy.data.collections.new("Away")
        self.scene.collection.children.link(collection)
        layer = bpy.context.view_layer
        layer.active_layer_collection = layer.layer_collection.children["Away"]
        self.assertEqual([each.name for each in sheet(name="In").users_collection], ["Away"])
        layer.layer_collection.children["Away"].exclude = True
        self.assertIn(sheet(name="Out").name, layer.objects)

    def test_meshes_become_surfaces_all_or_none(self):
        bpy.ops.mesh.primitive_grid_add()
        grid = bpy.context.object
        bpy.ops.mesh.primitive_monkey_add()
        monkey = bpy.context.object
        light = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        self.scene.collection.objects.link(light)
        hollow = bpy.data.objects.new("Hollow", bpy.data.meshes.new("Hollow"))
        self.scene.collection.objects.link(hollow)
        select(grid, monkey, light, hollow)
        self.refuse(bpy.ops.pliant.make_surface, "Hollow")
        select(grid, monkey)
        monkey.data.uv_layers[0].name = "Other"
        self.refuse(bpy.ops.pliant.make_surface, "Suzanne.*UVMap", uv_map="UVMap")
        self.assertFalse(any(map(properties.has, self.scene.objects)))
        select(grid, monkey, light)
        bpy.ops.pliant.make_surface()
        self.assertEqual([properties.role(each) for each in (grid, monkey)], ["SURFACE"] * 2)
        self.assertFalse(properties.has(light))
        select(grid)
        bpy.ops.pliant.make_surface(uv_map="UVMap")
        self.assertEqual(grid.pliant.uv_map, "UVMap")
        select(light)
        self.assertFalse(bpy.ops.pliant.make_surface.poll())

    def test_edits_of_edit_mode_count(self):
        bpy.ops.mesh.primitive_plane_add()
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.subdivide(number_cuts=5)
        bpy.ops.pliant.make_surface()
        self.assertEqual(properties.role(bpy.context.object), "SURFACE")


class Forces(Case):
    def test_a_fitted_force_moves_by_a_tenth(self):
        for size, where in ((2.0, (0, 0, 0)), (0.03, (5, 0, 1)), (700.0, (-100, 20, 0))):
            clear()
            self.scene = bpy.context.scene
            surface = sheet(width=size, depth=size / 2, location=where)
            self.scene.cursor.location = where
            for kind in ("POINT", "LINE", "UNIFORM", "PRESSURE"):
                with self.subTest(kind=kind, size=size):
                    force = add(kind)
                    self.assertEqual(self.messages(), [])
                    self.assertAlmostEqual(self.alone(force, surface) / size, 0.1, delta=0.002)

    def test_a_default_force_on_a_default_sheet(self):
        surface = sheet()
        force = add(kind="POINT")
        self.assertAlmostEqual(self.alone(force, surface), 0.2, delta=0.004)
        self.assertEqual((force.name, force.type, force.pliant.kind), ("Point", "EMPTY", "POINT"))
        self.assertTrue(force.select_get() and not surface.select_get() and edit.active(bpy.context) == force)

    def test_scale_and_rotation_of_the_surface_count(self):
        surface = sheet()
        surface.scale, surface.rotation_euler = (3, 3, 3), (0.4, 0.2, 0)
        select(surface)
        force = add()
        self.assertAlmostEqual(self.alone(force, surface), 0.6, delta=0.012)

    def test_the_active_surface_is_fitted(self):
        small, large = sheet(width=1, depth=1), sheet(width=10, depth=10)
        for surface, radius in ((small, 0.45), (large, 4.5)):
            select(surface)
            self.assertAlmostEqual(add().pliant.deformation_radius, radius, places=6)
        select()
        force = add()
        self.assertEqual((force.pliant.deformation_radius, force.pliant.magnitude), (1, 0), "two could be meant")

    def test_what_nothing_holds_is_told(self):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
        bpy.ops.pliant.make_surface()
        bpy.ops.pliant.add_force(kind="UNIFORM")
        self.assertIn("goal", " ".join(each.text for each in bpy.context.scene.pliant.messages))

    def test_far_away_it_fits_the_nearest_place(self):
        surface = sheet()
        force = add(location=(0, 0, 50))
        self.assertIn("too far away", self.messages("WARNING")[0][1])
        self.assertGreater(force.pliant.magnitude, 0)
        force.location = 0, 0, 0
        self.assertAlmostEqual(self.alone(force, surface), 0.2, delta=0.004)

    def test_without_fit_all_is_as_the_format_has_it(self):
        sheet()
        for kind in properties.FORCE_KINDS:
            force = add(kind, fit=False, name="f")
            plain = properties.CLASS_OF[kind]("f")
            own = force.pliant
            for name in ("magnitude", "deformation_radius", "force_radius", "pull", "frequency", "rate"):
                if hasattr(plain, name):
                    self.assertEqual(getattr(own, name), getattr(plain, name), (kind, name))
            self.assertEqual(own.end is not None, kind == "LINE")
            self.assertFalse(own.use_direction)

    def test_it_is_at_the_cursor_unless_told(self):
        self.scene.cursor.location = 1, 2, 3
        self.assertEqual(tuple(add().location), (1, 2, 3))
        self.assertEqual(tuple(add(location=(0, 0, 0)).location), (0, 0, 0))
        bpy.ops.pliant.add_group(name="Region")
        group = edit.active(bpy.context)
        self.assertEqual((group.name, tuple(group.location), properties.role(group)), ("Region", (1, 2, 3), "GROUP"))

    def test_a_line_has_its_end_in_the_scene(self):
        line = add("LINE", location=(1, 1, 0))
        self.assertEqual(tuple(line.pliant.end.location), (2, 1, 0))
        self.assertIn(line.pliant.end.name, self.scene.objects)
        self.assertEqual(edit.selected(bpy.context), [line])
        self.assertFalse(properties.has(line.pliant.end))

    def test_any_object_becomes_a_force(self):
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        self.scene.collection.objects.link(camera)
        select()
        self.assertFalse(bpy.ops.pliant.make_force.poll())
        select(camera)
        for kind in properties.FORCE_KINDS:
            bpy.ops.pliant.make_force(kind=kind)
            self.assertEqual((camera.pliant.role, camera.pliant.kind), ("FORCE", kind))
        self.assertIsNotNone(camera.pliant.end)

    def test_in_edit_mode_of_a_surface(self):
        surface = sheet()
        bpy.ops.object.mode_set(mode="EDIT")
        force = add()
        self.assertEqual((surface.mode, force.mode), ("OBJECT", "OBJECT"))
        self.assertGreater(force.pliant.magnitude, 0)


class Heights(Case):
    def test_the_settled_height(self):
        surface = sheet()
        force = add()
        for height in (0.05, 0.3, 0.001, 0.5):
            bpy.ops.pliant.set_height(height=height)
            self.assertAlmostEqual(self.alone(force, surface) / height, 1, delta=0.01)
        bpy.ops.pliant.set_height(height=-0.1)
        self.assertLess(force.pliant.magnitude, 0)
        self.assertAlmostEqual(self.alone(force, surface), 0.1, delta=0.001)
        bpy.ops.pliant.set_height(height=0)
        self.assertEqual(force.pliant.magnitude, 0)

    def test_other_forces_density_and_tangents_do_not_count(self):
        surface = sheet()
        add(location=(0.5, 0, 0))
        force = add()
        bpy.ops.pliant.set_height(height=0.1)
        alone = force.pliant.magnitude
        surface.pliant.density, surface.pliant.damping, surface.pliant.su0 = 400, 70, (0, 0, 2)
        bpy.ops.pliant.set_height(height=0.1)
        self.assertAlmostEqual(force.pliant.magnitude / alone, 1, delta=0.01)

    def test_keys_are_scaled_as_a_whole(self):
        surface = sheet()
        force = add()
        for frame, value in ((1, 0), (20, 50), (40, 20)):
            force.pliant.magnitude = value
            force.keyframe_insert("pliant.magnitude", frame=frame)
        handles = [tuple(point.handle_right) for point in self.curve(force).keyframe_points]
        bpy.ops.pliant.set_height(height=0.2)
        points = self.curve(force).keyframe_points
        values = np.array([point.co[1] for point in points])
        np.testing.assert_allclose(values / values[1], (0, 1, 0.4), rtol=1e-6)
        factor = values[1] / 50
        for before, point in zip(handles, points):
            np.testing.assert_allclose(point.handle_right, (before[0], before[1] * factor), rtol=1e-5, atol=1e-4)
        force.animation_data_clear()
        force.pliant.magnitude = values[1]
        self.assertAlmostEqual(self.alone(force, surface), 0.2, delta=0.002)

    def curve(self, owner, path="pliant.magnitude"):
        return fcurves.table(owner.animation_data)[path, 0]

    def test_what_cannot_be(self):
        surface = sheet()
        force = add(location=(0, 0, 30))
        self.refuse(bpy.ops.pliant.set_height, "moves nothing", height=0.1)
        force.location = 0, 0, 0
        surface.pliant.release = "RECOVER"  # or what has left stays where it is
        self.refuse(bpy.ops.pliant.set_height, "out of the reach", height=50)
        force.driver_add("pliant.magnitude").driver.expression = "3"
        bpy.context.view_layer.update()
        self.refuse(bpy.ops.pliant.set_height, "a driver moves it", height=0.1)
        select()
        self.assertFalse(bpy.ops.pliant.set_height.poll())

    def test_what_the_nla_moves_is_not_scaled(self):
        sheet()
        force = add()
        force.keyframe_insert("pliant.magnitude", frame=1)
        force.pliant.magnitude *= 2
        force.keyframe_insert("pliant.magnitude", frame=20)
        animation = force.animation_data
        animation.nla_tracks.new().strips.new("strip", 1, animation.action)
        animation.action = None
        bpy.context.view_layer.update()
        self.refuse(bpy.ops.pliant.set_height, "cannot be scaled", height=0.1)
        self.refuse(bpy.ops.pliant.suggest, "cannot be scaled", peak=0.1)

    def test_what_other_than_keys_moves_is_not_scaled(self):
        sheet()
        force = add()
        force.keyframe_insert("pliant.magnitude", frame=1)
        force.pliant.magnitude *= 2
        force.keyframe_insert("pliant.magnitude", frame=20)
        curve = self.curve(force)
        noise = curve.modifiers.new("NOISE")
        force.animation_data.action.update_tag()
        self.refuse(bpy.ops.pliant.set_height, "the F-modifier NOISE", height=0.1)
        self.refuse(bpy.ops.pliant.suggest, "the F-modifier NOISE", peak=0.1)
        curve.modifiers.remove(noise)
        curve.modifiers.new("CYCLES")
        bpy.ops.pliant.set_height(height=0.1)
        curve.convert_to_samples(1, 20)
        force.animation_data.action.update_tag()
        self.refuse(bpy.ops.pliant.set_height, "samples", height=0.1)

    def test_an_inertia_has_no_height(self):
        sheet()
        add("INERTIA")
        self.refuse(bpy.ops.pliant.set_height, "while the surface moves", height=0.1)

    def test_an_error_elsewhere_is_told(self):
        sheet()
        line = add("LINE", fit=False)
        line.pliant.end = None
        add(fit=False)
        self.refuse(bpy.ops.pliant.set_height, "Line.*end", height=0.1)


class Setups(Case):
    def test_each_moves_at_once(self):
        for kind in setups.SETUPS:
            with self.subTest(kind=kind):
                clear()
                self.scene = bpy.context.scene
                self.scene.frame_start = self.scene.frame_current = 31
                bpy.ops.pliant.add_setup(kind=kind)
                self.assertEqual(self.messages(), [])
                found = translate.translate(self.scene)
                self.assertEqual([each for each in found.problems if each.level != "NOTE"], [])
                simulation = pliant.Simulation(found.scene)
                moved = [simulation.at(frame)[kind.title()].peak_displacement for frame in (31, 31 + 23)]
                self.assertEqual(moved[0], 0)
                self.assertGreater(moved[1], 0.02)

    def test_they_are_those_of_the_command(self):
        """The same motion but for the size, to the digits that lengths were rounded to."""
        for kind, starter, size in (("POKE", "sheet", 6), ("TRAMPOLINE", "trampoline", 4), ("DENT", "dent", 4)):
            with self.subTest(kind=kind):
                clear()
                bpy.ops.pliant.add_setup(kind=kind)
                own = pliant.Simulation(translate.translate(bpy.context.scene).scene)
                wanted = pliant.Simulation(command_scene(starter))
                name = wanted.scene.surfaces[0].name
                for frame in (5, 11, 30):
                    found = own.at(frame)[kind.title()].peak_displacement
                    self.assertAlmostEqual(found, wanted.at(frame)[name].peak_displacement / size, delta=0.01)

    def test_jiggle_follows_what_the_mesh_does(self):
        bpy.ops.mesh.primitive_uv_sphere_add()
        owner = bpy.context.object
        for frame, x in ((1, 0), (10, 0), (14, 2)):
            owner.location.x = x
            owner.keyframe_insert("location", frame=frame)
        keys = fcurves_of(owner)
        bpy.ops.pliant.add_setup(kind="JIGGLE")
        self.assertEqual(fcurves_of(owner), keys)
        own = owner.pliant
        self.assertEqual((own.role, own.rest, own.region), ("SURFACE", "MODIFIERS", "ALL"))
        self.assertGreater(own.goal, 0, "a closed mesh needs what holds it")
        force = edit.active(bpy.context)
        self.assertEqual((force.pliant.kind, force.pliant.targets[0].surface), ("INERTIA", owner))
        found = translate.translate(self.scene)
        simulation = pliant.Simulation(found.scene)
        self.assertGreater(simulation.at(14)["Sphere"].peak_displacement, 0.01)
        self.assertLess(simulation.at(9)["Sphere"].peak_displacement, 1e-9)
        region = next(each for each in pliant.preview(found.scene) if each.of == "all").regions[0]
        self.assertAlmostEqual(region.first_frequency, 2.2, delta=0.25)

    def test_jiggle_beside_an_error(self):
        line = add("LINE", fit=False)
        line.pliant.end = None
        bpy.ops.mesh.primitive_grid_add()
        self.assertEqual(bpy.ops.pliant.add_setup(kind="JIGGLE"), {"FINISHED"})
        self.assertIn("its density is the default", self.messages("WARNING")[0][1])

    def test_jiggle_needs_a_mesh(self):
        select()
        self.refuse(bpy.ops.pliant.add_setup, "Jiggle", kind="JIGGLE")


def command_scene(starter, *more):
    """The scene that `pliant new` writes."""
    command = os.environ.get("PLIANT_COMMAND", "pliant")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, f"{starter}.xml")
        subprocess.run([command, "new", starter, "-o", path, "--quiet", *more], check=True, stdout=subprocess.DEVNULL)
        return pliant.load(path)


class Materials(Case):
    def test_numbers_are_those_of_the_command(self):
        for starter, names in (("sheet", setups.LOOKS), ("trampoline", ("JELLY", "PAPER")), ("flag", ("CLOTH",))):
            plain = command_scene(starter)
            part = plain.surfaces[0].name
            for name in names:
                with self.subTest(starter=starter, material=name):
                    wanted = command_scene(starter, "--material", name.lower())[part]
                    found = setups.dress(plain, part, setups.LOOKS[name])
                    for each in setups.MATERIAL:
                        before, after = getattr(wanted, each), getattr(found, each)
                        if before is None or after is None:
                            self.assertIs(before, after, each)
                        else:  # the last of three digits may differ, as the frames of the peak may
                            self.assertAlmostEqual(after, before, delta=0.011 * abs(before), msg=each)
                    self.assertEqual(found.uv, wanted.uv)

    def test_a_surface_gets_the_look(self):
        surface = sheet(columns=21, rows=21)
        force = add()
        select(surface)
        for name, look in setups.LOOKS.items():
            bpy.ops.pliant.material(preset=name)
            own = surface.pliant
            found = translate.translate(self.scene)
            self.assertIsNotNone(found.scene, found.problems)
            region = next(each for each in pliant.preview(found.scene) if each.of == "all").regions[0]
            self.assertAlmostEqual(region.first_frequency / look.frequency, 1, delta=0.02, msg=name)
            self.assertAlmostEqual(region.damping_ratio, look.damping_ratio, places=5)
            self.assertEqual((own.integrator, own.use_yield), ("NEWMARK", look.give > 0))
        self.assertGreater(force.pliant.magnitude, 0)

    def test_a_dent_of_a_grid_is_round_with_the_same_numbers(self):
        surface = sheet(columns=31, rows=21, width=3, depth=2)
        add()
        select(surface)
        bpy.ops.pliant.material(preset="METAL")
        self.assertEqual(surface.pliant.uv, "SURFACE")
        np.testing.assert_allclose(surface.pliant.unit, (3, 2), rtol=1e-6)
        unit = pliant.Simulation(translate.translate(self.scene).scene).shape("Sheet").unit
        np.testing.assert_allclose(unit, (3, 2), rtol=1e-6)

    def test_one_after_another_is_as_if_it_were_the_first(self):
        surface = sheet(columns=21, rows=21)
        add()
        select(surface)
        numbers = []
        for name in ("JELLY", "SKIN", "CLOTH", "JELLY"):
            bpy.ops.pliant.material(preset=name)
            numbers.append([getattr(surface.pliant, each) for each in ("density", "b", "c", "d")])
        np.testing.assert_allclose(numbers[0], numbers[-1], rtol=0.02)

    def test_without_a_force_it_is_pushed_in_its_middle(self):
        surface = sheet(columns=21, rows=21)
        bpy.ops.pliant.material(preset="SKIN")
        self.assertAlmostEqual(surface.pliant.damping_ratio, 0.7)
        self.assertNotEqual(surface.pliant.density, 1)

    def test_it_takes_the_place_of_keys(self):
        surface = sheet(columns=21, rows=21)
        add()
        select(surface)
        surface.pliant.keyframe_insert("density", frame=1)
        bpy.ops.pliant.material(preset="RUBBER")
        self.assertEqual(fcurves_of(surface), {})

    def test_refusals(self):
        self.assertFalse(bpy.ops.pliant.material.poll())
        bpy.ops.mesh.primitive_uv_sphere_add()
        bpy.ops.pliant.make_surface()
        bpy.context.object.pliant.region = "ALL"
        self.refuse(bpy.ops.pliant.material, "nothing holds it", preset="RUBBER")

    def test_own_presets(self):
        self.assertFalse(bpy.ops.pliant.add_material_preset.poll())
        surface = sheet()
        surface.pliant.density, surface.pliant.use_yield = 17, True
        bpy.ops.pliant.add_material_preset(name="Pliant test")
        surface.pliant.density, surface.pliant.use_yield = 1, False
        menu = bpy.types.PLIANT_MT_material_presets
        path = bpy.utils.preset_find("Pliant_test", menu.preset_subdir, ext=".py") or bpy.utils.preset_find(
            "pliant_test", menu.preset_subdir, ext=".py")  # fmt: skip
        bpy.ops.script.execute_preset(filepath=path, menu_idname=menu.__name__)
        self.assertEqual((surface.pliant.density, surface.pliant.use_yield), (17, True))
        os.unlink(path)


class Suggestions(Case):
    def setUp(self):
        super().setUp()
        self.scene.frame_end = 60
        self.surface = sheet(columns=21, rows=21)
        self.surface.pliant.damping = 20
        self.force = add()

    def peak(self):
        found = translate.translate(self.scene).scene
        return max(frame["Sheet"].peak_displacement for frame in pliant.Simulation(found))

    def test_a_peak(self):
        bpy.ops.pliant.suggest(peak=0.33)
        self.assertAlmostEqual(self.peak(), 0.33, delta=0.007)
        self.assertEqual(self.surface.pliant.density, 1)

    def test_keys_are_scaled_as_a_whole(self):
        self.force.pliant.magnitude = 0
        self.force.keyframe_insert("pliant.magnitude", frame=1)
        self.force.pliant.magnitude = 300
        self.force.keyframe_insert("pliant.magnitude", frame=12)
        bpy.ops.pliant.suggest(peak=0.3)
        self.assertAlmostEqual(self.peak(), 0.3, delta=0.006)
        keys = fcurves_of(self.force)["pliant.magnitude", 0]
        self.assertEqual(keys[0], (1, 0))
        self.assertNotEqual(keys[1][1], 300)

    def test_keys_that_forces_share_are_scaled_once(self):
        other = add(location=(0.3, 0, 0))
        for frame, value in ((1, 0), (12, 300)):
            self.force.pliant.magnitude = value
            self.force.keyframe_insert("pliant.magnitude", frame=frame)
        other.animation_data_create().action = self.force.animation_data.action
        select(self.surface)
        bpy.ops.pliant.suggest(peak=0.25)
        self.assertAlmostEqual(self.peak(), 0.25, delta=0.005)

    def test_all_forces_of_the_active_surface(self):
        other = add(location=(0.3, 0, 0))
        before = self.force.pliant.magnitude / other.pliant.magnitude
        select(self.surface)
        bpy.ops.pliant.suggest(peak=0.25)
        self.assertAlmostEqual(self.peak(), 0.25, delta=0.005)
        self.assertAlmostEqual(self.force.pliant.magnitude / other.pliant.magnitude, before, delta=0.002 * before)

    def test_frequency_and_settling(self):
        bpy.ops.pliant.suggest(frequency=3, settling=1.5)
        found = pliant.preview(translate.translate(self.scene).scene)[0].regions[0]
        self.assertAlmostEqual(found.animated.frequency, 3, delta=0.06)
        self.assertAlmostEqual(found.settling.time, 1.5, delta=0.1)

    def test_what_cannot_be_reached_is_a_warning(self):
        self.assertEqual(bpy.ops.pliant.suggest(frequency=500), {"FINISHED"})
        self.assertEqual(len(self.messages("WARNING")), 1)
        bpy.ops.pliant.suggest(frequency=3)
        self.assertEqual(self.messages("WARNING"), [], "it went with its cause")

    def test_refusals(self):
        self.refuse(bpy.ops.pliant.suggest, "give a goal")
        self.force.pliant.driver_add("magnitude").driver.expression = "50"
        bpy.context.view_layer.update()
        self.refuse(bpy.ops.pliant.suggest, "a driver moves it", peak=0.1)
        select()
        self.surface.pliant.role = "NONE"
        self.assertFalse(bpy.ops.pliant.suggest.poll())


class Records(Case):
    def setUp(self):
        super().setUp()
        self.owner = add(fit=False)

    def evaluated(self, path, index, frames):
        curve = fcurves.table(self.owner.animation_data)[path, index]
        return [curve.evaluate(frame) for frame in frames]

    def record(self, values, **arguments):
        bpy.ops.pliant.record(values=" ".join(map(repr, values)), **arguments)

    def test_values_become_few_keys(self):
        frames = np.arange(1, 61)
        values = [float(np.sin(frame / 8)) for frame in frames]
        self.record(values, data_path="pliant.magnitude")
        found = self.evaluated("pliant.magnitude", 0, frames)
        np.testing.assert_allclose(found, values, atol=0.0101 * np.ptp(values))
        self.assertLess(len(fcurves_of(self.owner)["pliant.magnitude", 0]), 20)

    def test_without_tolerance_every_value_stays(self):
        values = [0.5, 3, -2, 7, 7, 7, 1, 4]
        self.record(values, data_path="location", index=2, first=10, tolerance=0)
        np.testing.assert_allclose(self.evaluated("location", 2, range(10, 18)), values, atol=1e-5)
        self.assertEqual(list(fcurves_of(self.owner)), [("location", 2)])

    def test_keys_outside_are_kept_and_those_inside_replaced(self):
        for frame in (1, 5, 12, 20, 30):
            self.owner.location.x = frame
            self.owner.keyframe_insert("location", index=0, frame=frame)
        self.record([8.0] * 10, data_path="location", index=0, first=10)
        keys = dict(fcurves_of(self.owner)["location", 0])
        for frame in (1, 5, 20, 30):
            self.assertEqual(keys[frame], frame)
        self.assertNotIn(12, keys)
        np.testing.assert_allclose(self.evaluated("location", 0, range(10, 20)), 8, atol=1e-6)

    def test_keys_of_a_muted_curve_are_kept(self):
        for frame in (1, 30):
            self.owner.location.x = frame
            self.owner.keyframe_insert("location", index=0, frame=frame)
        fcurves.table(self.owner.animation_data)["location", 0].mute = True
        self.record([8.0, 9.0], data_path="location", index=0, first=10)
        self.assertEqual(fcurves_of(self.owner)["location", 0], [(1, 1), (10, 8), (11, 9), (30, 30)])

    def test_switches_step(self):
        values = [1, 1, 0, 0, 1, 0, 1, 1]
        for tolerance in (0, 0.1):
            self.record(values, data_path="pliant.enabled", tolerance=tolerance)
            found = translate.translate(self.scene)
            self.assertEqual(found.problems, [])
            self.assertEqual([found.scene["Point"].enabled(frame) for frame in range(1, 9)], values)
            self.assertEqual(len(fcurves_of(self.owner)["pliant.enabled", 0]), 5)

    def test_one_value(self):
        self.record([4.5], data_path="pliant.magnitude", first=7)
        self.assertEqual(fcurves_of(self.owner)["pliant.magnitude", 0], [(7, 4.5)])

    def test_refusals(self):
        for message, arguments in (
            ("numbers", {"data_path": "location", "index": 0, "values": ""}),
            ("numbers", {"data_path": "location", "index": 0, "values": "1 nan"}),
            ("numbers", {"data_path": "location", "index": 0, "values": "1 1e39"}),
            ("could not convert", {"data_path": "location", "index": 0, "values": "1 x"}),
            ("is the index", {"data_path": "location[2]", "values": "1"}),
            ("cannot have keys", {"data_path": "pliant.preroll", "values": "1"}),
            ("has no", {"data_path": "pliant.foo", "values": "1"}),
            ("3 components", {"data_path": "location", "values": "1"}),
            ("3 components", {"data_path": "location", "index": 3, "values": "1"}),
            ("no components", {"data_path": "pliant.magnitude", "index": 1, "values": "1"}),
            ("no number", {"data_path": "name", "values": "1"}),
        ):
            self.refuse(bpy.ops.pliant.record, message, **arguments)
        select()
        self.assertFalse(bpy.ops.pliant.record.poll())


class TakingAway(Case):
    def build(self):
        surface = sheet(columns=9, rows=9)
        surface.modifiers.new("Mine", "SUBSURF")
        force = add()
        force.keyframe_insert("pliant.magnitude", frame=1)
        force.keyframe_insert("location", frame=1)
        force.pliant.driver_add("force_radius")
        bpy.ops.pliant.add_group()
        return surface, force, edit.active(bpy.context)

    def test_remove_takes_the_role_of_what_is_selected(self):
        surface, force, group = self.build()
        select(force, group)
        bpy.ops.pliant.remove()
        self.assertEqual([properties.has(each) for each in (surface, force, group)], [True, False, False])
        self.assertEqual({path for path, _ in fcurves_of(force)}, {"location"})
        self.assertFalse(force.animation_data.drivers)
        self.scene.frame_set(3)
        self.assertFalse(properties.has(force), "what is evaluated made it again")
        select(force)
        self.assertFalse(bpy.ops.pliant.remove.poll())

    def test_clear_leaves_nothing(self):
        surface, force, group = self.build()
        self.scene.frame_set(5)
        other = bpy.data.scenes.new("Other")
        other.pliant.seed = 4
        apart = bpy.data.objects.new("Apart", None)
        apart.pliant.role = "GROUP"
        self.assertIn("pliant", surface.modifiers)
        bpy.ops.pliant.clear()
        self.scene.frame_set(6)
        for owner in (surface, force, group, apart, self.scene, other):
            self.assertFalse(properties.has(owner), owner.name)
            self.assertNotIn("pliant", owner.keys())
        self.assertEqual([each.name for each in surface.modifiers], ["Mine"])
        self.assertEqual({path for path, _ in fcurves_of(force)}, {"location"})
        self.assertIn(force.name, self.scene.objects)

    def test_what_moves_our_properties_goes_too(self):
        first, second = add(fit=False), add(fit=False)
        for frame, value in ((1, 0), (9, 5)):
            first.pliant.magnitude = value
            first.keyframe_insert("pliant.magnitude", frame=frame)
        second.animation_data_create().action = first.animation_data.action
        fcurves.table(first.animation_data)["pliant.magnitude", 0].mute = True
        track = second.animation_data.nla_tracks.new()
        track.strips.new("strip", 1, second.animation_data.action)
        select(first)
        bpy.ops.pliant.remove()
        self.scene.frame_set(5)
        self.assertFalse(properties.has(first) or first.animation_data)
        self.assertEqual(len(second.animation_data.action.fcurves), 1, "it was shared")
        action, second.animation_data.action = second.animation_data.action, None
        kept = action.copy()
        kept.use_fake_user = True
        bpy.ops.pliant.clear()
        self.scene.frame_set(7)
        self.assertFalse(properties.has(second))
        self.assertEqual([len(each.fcurves) for each in (action, kept)], [0, 0])

    def test_linked_data_is_left_alone(self):
        surface = sheet(columns=9, rows=9)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "library.blend")
            bpy.data.libraries.write(path, {surface})
            clear()
            self.scene = bpy.context.scene
            with bpy.data.libraries.load(path, link=True) as (_, wanted):
                wanted.objects = ["Sheet"]
            linked = wanted.objects[0]
            self.scene.collection.objects.link(linked)
            select(linked)
            for operator, arguments in (
                ("make_surface", {}), ("make_force", {}), ("remove", {}), ("material", {"preset": "METAL"}),
                ("add_setup", {"kind": "JIGGLE"}), ("record", {"data_path": "location", "index": 0, "values": "1"}),
            ):  # fmt: skip
                self.refuse(getattr(bpy.ops.pliant, operator), "library override", **arguments)
            bpy.ops.pliant.clear()
            own = linked.override_create()
            own.override_library.is_system_override = False
            self.scene.collection.objects.unlink(linked)
            self.scene.collection.objects.link(own)
            select(own)
            add()
            select(own)
            bpy.ops.pliant.material(preset="JELLY")
            self.assertAlmostEqual(own.pliant.damping_ratio, 0.04)

    def test_a_linked_action_is_left_alone(self):
        surface, force = sheet(columns=9, rows=9), add()
        for owner, path in ((surface, "pliant.density"), (force, "pliant.magnitude")):
            owner.keyframe_insert(path, frame=1)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "library.blend")
            bpy.data.libraries.write(path, {surface.animation_data.action, force.animation_data.action})
            with bpy.data.libraries.load(path, link=True) as (there, wanted):
                wanted.actions = there.actions
            linked = {each.name: each for each in wanted.actions}
            for owner in (surface, force):
                owner.animation_data.action = linked[owner.animation_data.action.name]
            bpy.context.view_layer.update()
            self.refuse(bpy.ops.pliant.set_height, "is linked", height=0.1)
            self.refuse(bpy.ops.pliant.suggest, "is linked", peak=0.1)
            self.refuse(bpy.ops.pliant.record, "is linked", data_path="location", index=0, values="1")
            select(surface)
            self.refuse(bpy.ops.pliant.material, "is linked", preset="JELLY")
            bpy.ops.pliant.remove()
            bpy.ops.pliant.clear()
            self.scene.frame_set(5)
            self.assertFalse(properties.has(surface) or properties.has(force))
            self.assertEqual([len(each.fcurves) for each in linked.values()], [1, 1])

    def test_reset_and_validate(self):
        self.build()
        bpy.ops.pliant.reset()
        bpy.ops.pliant.validate()
        self.assertEqual(self.messages("ERROR"), [])
        line = add("LINE", fit=False)
        line.pliant.end = None
        for live in (False, True):
            self.scene.pliant.live = live
            self.assertEqual(bpy.ops.pliant.validate(), {"FINISHED"})
            self.assertEqual([each[0] for each in self.messages("ERROR")], ["Line"])
        bpy.data.objects.remove(line)
        bpy.ops.pliant.validate()
        self.assertEqual(self.messages("ERROR"), [])


class Undo(Case):
    def test_each_is_one_step(self):
        sheet(columns=9, rows=9)
        add()
        bpy.ops.pliant.add_group()
        bpy.ops.mesh.primitive_grid_add()
        steps = (
            ("", "add_surface", {}), ("Grid", "make_surface", {}), ("", "add_force", {}), ("Grid", "make_force", {}),
            ("", "add_group", {}), ("Point", "set_height", {"height": 0.05}), ("Point", "remove", {}),
            ("", "clear", {}),
            ("Grid", "add_setup", {"kind": "JIGGLE"}), ("", "add_setup", {"kind": "POKE"}),
            ("Sheet", "material", {"preset": "SKIN"}), ("Point", "suggest", {"peak": 0.1}),
            ("Point", "record", {"data_path": "location", "index": 0, "values": "1 2 3 9"}),
        )  # fmt: skip
        for name, operator, arguments in steps:
            with self.subTest(operator=operator, **arguments):
                select(*[bpy.data.objects[each] for each in [name] if each])
                bpy.context.view_layer.update()
                bpy.ops.ed.undo_push(message="before")
                before = self.names()
                getattr(bpy.ops.pliant, operator)(**arguments)
                bpy.ops.ed.undo_push(message="after")
                after = self.names()
                self.assertNotEqual(before, after)
                bpy.ops.ed.undo()
                self.assertEqual(self.names(), before)
                bpy.ops.ed.redo()
                self.assertEqual(self.names(), after)
                bpy.ops.ed.undo()

    def names(self):
        """All that there is, without objects of Python's, which undo replaces."""
        plain = {}
        for each in bpy.context.scene.objects:
            own = {key: getattr(value, "name", value) for key, value in properties.raw(each).items()}
            own["targets"] = [target.surface.name for target in each.pliant.targets] if properties.has(each) else []
            plain[each.name] = own, fcurves_of(each), tuple(each.location)
        return plain


class Drawn:
    """A layout that notes what is drawn, and refuses what is not there."""

    def __init__(self, test, notes):
        self.__dict__.update(test=test, notes=notes)

    def __setattr__(self, name, value):
        self.test.assertIn(name, bpy.types.UILayout.bl_rna.properties.keys())

    def _part(self, **_options):
        return Drawn(self.test, self.notes)

    row = column = box = _part

    def label(self, text="", icon="NONE"):
        self._icon(icon)
        self.notes.append(text)

    def separator(self):
        pass

    def _icon(self, icon):
        self.test.assertIn(icon, bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys())

    def prop(self, owner, name, icon="NONE", **_options):
        self._icon(icon)
        self.test.assertIn(name, owner.bl_rna.properties.keys())
        self.test.assertTrue(owner.bl_rna.properties[name].description, name)
        self.notes.append(name)

    def prop_search(self, owner, name, _where, _list):
        self.prop(owner, name)

    def operator(self, name, icon="NONE", **_options):
        self._icon(icon)
        self.notes.append(name)
        group, _, rest = name.partition(".")
        rna = getattr(getattr(bpy.ops, group), rest).get_rna_type()  # KeyError if there is none
        return types.SimpleNamespace(rna=rna)

    def operator_enum(self, name, prop):
        self.test.assertIn(prop, self.operator(name).rna.properties.keys())

    def operator_menu_enum(self, name, prop, icon="NONE", **_options):
        self._icon(icon)
        self.operator_enum(name, prop)

    def menu(self, name, icon="NONE", **_options):
        self._icon(icon)
        self.test.assertTrue(hasattr(bpy.types, name))
        self.notes.append(name)


class Panels(Case):
    def draw(self):
        """What all panels and menus draw for the active object."""
        notes = []
        for cls in panels.CLASSES:
            is_drawn = issubclass(cls, (bpy.types.Panel, bpy.types.Menu))
            if is_drawn and (not hasattr(cls, "poll") or cls.poll(bpy.context)):
                cls.draw(types.SimpleNamespace(layout=Drawn(self, notes)), bpy.context)
        return notes

    def test_drawing_leaves_no_trace(self):
        bpy.ops.mesh.primitive_cube_add()
        notes = self.draw()
        self.assertIn("pliant.make_surface", notes)
        self.assertFalse(properties.has(self.scene) or properties.has(bpy.context.object))
        self.assertEqual(list(bpy.context.object.keys()), [])
        select()
        self.draw()

    def test_every_setting_is_somewhere(self):
        surface, drawn = sheet(), set()
        surface.vertex_groups.new(name="Group")
        select(surface)
        bpy.ops.pliant.add_item(collection="maps")
        drawn.update(self.draw())
        for kind in properties.FORCE_KINDS:
            force = add(kind)
            force.pliant.falloff, force.pliant.aim = "DRAWN", "VECTOR"
            bpy.ops.pliant.add_item(collection="targets")
            drawn.update(self.draw())
        bpy.ops.pliant.add_group()
        drawn.update(self.draw())
        for cls, others in (
            (properties.PliantObject, {"maps", "targets"}),
            (properties.PliantScene, {"messages", "status", "frames_ready"}),
        ):  # fmt: skip
            shown = {name for name in cls.__annotations__ if not cls.bl_rna.properties[name].is_hidden}
            self.assertEqual(shown - drawn - others, set())
        self.assertLessEqual({"channel", "source", "low", "high", "surface"}, drawn)

    def test_messages_are_at_the_object_and_at_the_top(self):
        sheet()
        line = add("LINE", fit=False)
        line.pliant.end = None
        bpy.ops.pliant.validate()
        text = self.messages("ERROR")[0][1]
        notes = " ".join(self.draw())
        self.assertEqual(notes.count(" ".join(text.split()[:3])), 2)

    def test_items_come_and_go(self):
        surface = sheet()
        self.refuse(bpy.ops.pliant.add_item, "no vertex group", collection="maps")
        group = surface.vertex_groups.new(name="Soft")
        group.add([3], 0.5, "REPLACE")
        bpy.ops.pliant.add_item(collection="maps")
        self.assertEqual(surface.pliant.maps[0].source, "Soft")
        self.refuse(bpy.ops.pliant.remove_item, "no number", collection="maps", index=1)
        bpy.ops.pliant.remove_item(collection="maps", index=0)
        self.assertEqual(len(surface.pliant.maps), 0)
        force = add()
        bpy.ops.pliant.add_item(collection="targets")
        self.assertEqual(force.pliant.targets[0].surface, surface)
        self.refuse(bpy.ops.pliant.add_item, "no other surface", collection="targets")
        select()
        self.assertFalse(bpy.ops.pliant.add_item.poll())

    def test_all_has_tooltips(self):
        names = [each for each in dir(bpy.ops.pliant)]
        self.assertGreater(len(names), 15)
        for name in names:
            rna = getattr(bpy.ops.pliant, name).get_rna_type()
            self.assertTrue(rna.description, name)
            self.assertFalse(rna.description.endswith("."), name)
            for each in rna.properties:
                if each.identifier != "rna_type" and not each.is_hidden:
                    self.assertTrue(each.description, (name, each.identifier))

    def test_goals_are_in_no_file(self):
        manager = bpy.context.window_manager
        manager.pliant_peak = 0.5
        self.assertEqual(manager.pliant_peak, 0.5)
        self.assertEqual(list(manager.keys()), [])
        manager.pliant_peak = 0


if __name__ == "__main__":
    unittest.main()
