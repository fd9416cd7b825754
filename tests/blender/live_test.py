"""What Blender shows of surfaces is what a simulation of the scene says, whatever was edited and how."""

import contextlib
import io
import os
import subprocess
import sys
import tempfile
import unittest

import addon_utils
import bpy
import numpy as np
from built import clear, force, key, messages, sheet, shown, solved, update
from mathutils import Matrix

from pliant_blender import live, pliant, properties, translate


class Case(unittest.TestCase):
    def setUp(self):
        clear()
        self.scene = bpy.context.scene
        self.scene.pliant.frame_end = 20

    def check(self, owner, frame=None):
        """That the evaluated mesh is the solved one, bit for bit."""
        frame = self.scene.frame_current if frame is None else frame
        found, wanted = shown(owner), solved(owner, frame, self.scene)
        np.testing.assert_array_equal(found, wanted, f"{owner.name} at {frame}: {messages()}")
        return wanted

    def has_moved(self, owner):
        self.assertGreater(abs(shown(owner) - self.rest(owner)).max(), 1e-4)

    def rest(self, owner):
        found = np.empty(3 * len(owner.data.vertices), np.float32)
        owner.data.vertices.foreach_get("co", found)
        return found.reshape(-1, 3)


class Frames(Case):
    def test_frames_in_any_order(self):
        owner = sheet()
        force()
        for frame in (1, 7, 20, 3, 4, 1, 13, 12):
            self.scene.frame_set(frame)
            self.check(owner)
        self.has_moved(owner)

    def test_between_frames_positions_are_mixed(self):
        owner = sheet()
        force()
        self.scene.frame_set(8, subframe=0.25)
        wanted = 0.75 * solved(owner, 8).astype(float) + 0.25 * solved(owner, 9)
        np.testing.assert_allclose(shown(owner), wanted, rtol=0, atol=1e-7)

    def test_ahead_at_rest_and_behind_as_at_the_end(self):
        owner = sheet()
        force()
        self.scene.pliant.frame_start = 5
        for frame in (4, 0, -30):
            self.scene.frame_set(frame)
            np.testing.assert_array_equal(shown(owner), self.rest(owner))
        for frame in (21, 300):
            self.scene.frame_set(frame)
            self.check(owner, 20)

    def test_what_is_shown_is_what_is_baked_of_the_exported_scene(self):
        owner = sheet(integrator="NEWMARK", region="ALL", border="FREE")
        force(magnitude=3)
        key(owner, "pliant.density", (1, 30), (12, 55))
        key(owner, "location", (1, (0, 0, 0)), (15, (0.4, 0.1, 0.2)))
        update()
        with tempfile.TemporaryDirectory() as folder:
            made = translate.translate(self.scene)
            made.scene.save(os.path.join(folder, "scene.xml"))
            pliant.bake(pliant.load(os.path.join(folder, "scene.xml")), os.path.join(folder, "out.npy"), space="object")
            baked = np.load(os.path.join(folder, "out.npy"))
        for frame in range(1, 21):
            self.scene.frame_set(frame)
            np.testing.assert_array_equal(shown(owner), baked[frame - 1].astype(np.float32))
        self.has_moved(owner)

    def test_handlers_of_frame_changes_write_no_data(self):
        owner = sheet()
        force()
        update()
        before = [(each.name, each.type, each.filepath) for each in owner.modifiers]
        counts = {name: len(getattr(bpy.data, name)) for name in ("objects", "scenes", "meshes", "actions")}
        seen = []

        def watch(scene, graph):
            seen.extend(each.id.name for each in graph.updates if isinstance(each.id, (bpy.types.Mesh, bpy.types.Action)))

        bpy.app.handlers.depsgraph_update_post.append(watch)
        for frame in range(1, 10):
            self.scene.frame_set(frame)
        bpy.app.handlers.depsgraph_update_post.remove(watch)
        self.assertEqual([(each.name, each.type, each.filepath) for each in owner.modifiers], before)
        self.assertEqual({name: len(getattr(bpy.data, name)) for name in counts}, counts)
        self.assertEqual(seen, [])


class Edits(Case):
    """Each edit acts at the next update, and also if none is announced, at the next frame."""

    def edits(self):
        owner, poke = bpy.data.objects["Sheet"], bpy.data.objects["Poke"]
        yield "a property", lambda: setattr(poke.pliant, "magnitude", 170)
        yield "a place", lambda: setattr(poke, "location", (-0.2, 0.1, 0.05))
        yield "a rotation", lambda: setattr(poke, "rotation_euler", (0.4, 0.2, 0))
        yield "a scale of the surface", lambda: setattr(owner, "scale", (1, 1.5, 1))
        yield "keys", lambda: key(poke, "pliant.magnitude", (1, 0), (6, 200), (12, 0))
        yield "a key that is moved", lambda: setattr(
            poke.animation_data.action.fcurves[0].keyframe_points[1], "co", (7, 260)
        )
        yield "a muted F-curve", lambda: setattr(poke.animation_data.action.fcurves[0], "mute", True)
        yield "no action", lambda: poke.animation_data_clear()
        yield "the rate", lambda: setattr(self.scene.render, "fps", 30)
        yield "the start", lambda: setattr(self.scene.pliant, "frame_start", 3)
        yield "the end", lambda: setattr(self.scene.pliant, "frame_end", 9)
        yield "a name", lambda: setattr(owner, "name", "Skin")
        yield "the mesh", lambda: owner.data.vertices.foreach_set("co", self.bent(owner))
        yield "a kind", lambda: setattr(poke.pliant, "kind", "RADIAL")
        yield "a force more", lambda: force("Second", location=(-0.3, -0.3, 0))
        yield "a target", lambda: setattr(poke.pliant.targets.add(), "surface", owner)
        yield "a parent", lambda: setattr(poke, "parent", bpy.data.objects["Second"])
        yield "a force less", lambda: bpy.data.objects.remove(bpy.data.objects["Second"])
        yield "no force", lambda: setattr(poke.pliant, "role", "NONE")

    def bent(self, owner):
        points = self.rest(owner)
        points[:, 2] = 0.1 * points[:, 0] ** 2
        return points.ravel()

    def test_with_an_update(self):
        owner = sheet()
        force()
        self.scene.frame_set(11)
        for name, edit in self.edits():
            with self.subTest(name):
                edit()
                owner.data.update()
                update()
                self.check(owner)

    def test_without_an_update(self):
        owner = sheet()
        force()
        for number, (name, edit) in enumerate(self.edits()):
            with self.subTest(name):
                edit()
                self.scene.frame_set(8 + number % 4)
                self.check(owner)

    def test_names_that_are_the_same_part(self):
        owner, other = sheet("A.1"), sheet("B.1", 11, 11)
        force("C.1")
        self.scene.frame_set(8)
        for number, name in enumerate(("A_1", "A 1", "A+1")):
            with self.subTest(name):
                owner.name = name
                if number:
                    update()
                self.scene.frame_set(9 + number)
                self.check(owner)
                self.check(other)
                self.assertEqual(messages(), [])

    def test_weights_and_attributes(self):
        owner = sheet()
        force()
        group = owner.vertex_groups.new(name="soft")
        group.add(list(range(0, 200)), 1.0, "REPLACE")
        for channel in ("B", "C", "D"):
            item = owner.pliant.maps.add()
            item.channel, item.source, item.low, item.high = channel, "soft", 1, 3
        self.scene.frame_set(10)
        before = self.check(owner)
        group.add(list(range(200, 300)), 0.5, "REPLACE")
        update()
        self.assertFalse(np.array_equal(self.check(owner), before))
        owner.vertex_groups.remove(group)
        self.scene.frame_set(11)  # Blender announces none of it
        self.assertEqual({level for level, _, _ in messages()}, {"ERROR"})
        colour = owner.data.attributes.new("soft", "FLOAT_COLOR", "POINT")
        colour.data.foreach_set("color", np.linspace(0, 1, 4 * len(owner.data.vertices)).astype(np.float32))
        owner.data.update()
        update()
        self.assertEqual(messages(), [])
        self.check(owner)

    def test_attributes_in_edit_mode(self):
        owner = sheet()
        poke = force()
        owner.data.attributes.new("soft", "FLOAT", "POINT").data.foreach_set("value", np.linspace(0, 1, 441))
        item = owner.pliant.maps.add()
        item.channel, item.source, item.low, item.high = "B", "soft", 1, 3
        self.scene.frame_set(8)
        bpy.context.view_layer.objects.active = owner
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.ed.undo_push(message="edit")
        for edit in (lambda: setattr(poke.pliant, "magnitude", 150), lambda: live._after_undo()):
            edit()
            update()
            self.assertEqual(messages(), [])
        bpy.ops.object.mode_set(mode="OBJECT")
        update()
        self.assertEqual(messages(), [])
        self.check(owner)

    def test_components_beside_a_keyed_one(self):
        owner = sheet()
        poke = force(aim="VECTOR", direction=(0, 0, 1))
        key(poke, "location", (1, 0), (9, 0.3), index=0)
        key(poke, "pliant.direction", (1, 0), (9, 0.3), index=0)
        poke.driver_add("rotation_euler", 0).driver.expression = "frame * 0.01"
        self.scene.frame_set(8)
        before = self.check(owner)
        edits = (
            lambda value: setattr(poke, "location", (0, value, 0)),
            lambda value: setattr(poke.pliant, "direction", (0, value, 1)),
        )
        for number, edit in enumerate(edits):
            with self.subTest(number):
                edit(-0.3)
                update()
                self.assertFalse(np.array_equal(self.check(owner), before))
                edit(0.4)
                self.scene.frame_set(9 + number)
                before = self.check(owner)

    def test_a_duplicate_is_a_surface_of_its_own(self):
        owner = sheet()
        force()
        self.scene.frame_set(6)
        other = owner.copy()
        other.data = owner.data.copy()
        other.location.x = 0.4
        self.scene.collection.objects.link(other)
        update()
        self.assertNotEqual(owner.modifiers["pliant"].filepath, other.modifiers["pliant"].filepath)
        self.check(owner)
        self.assertFalse(np.array_equal(self.check(other), shown(owner)))

    def test_live_and_solve_off(self):
        owner = sheet()
        force()
        self.scene.frame_set(9)
        owner.pliant.solve = False
        update()
        np.testing.assert_array_equal(shown(owner), self.rest(owner))
        owner.pliant.solve = True
        self.scene.pliant.live = False
        update()
        np.testing.assert_array_equal(shown(owner), self.rest(owner))
        self.scene.pliant.live = True
        update()
        self.check(owner)
        self.has_moved(owner)

    def test_an_edit_from_a_frame_on_keeps_the_frames_ahead_of_it(self):
        owner = sheet()
        poke = force()
        key(poke, "pliant.magnitude", (1, 10), (15, 10), (16, 10))
        self.scene.frame_set(20)
        solved_before = live.session_of(self.scene).simulation.frame_counts[0]
        poke.animation_data.action.fcurves[0].keyframe_points[2].co.y = 90
        update()
        self.check(owner)
        self.assertLess(live.session_of(self.scene).simulation.frame_counts[0], solved_before / 2)


class Random(Case):
    def test_any_order_of_edits(self):
        """No drift: after each of many edits, undone or not, at any frame, what is shown is solved anew."""
        for seed in range(2):
            with self.subTest(seed=seed):
                self.setUp()
                self.walk(np.random.default_rng(seed))

    def walk(self, chance):
        owner_of = lambda: next(each for each in self.scene.objects if each.type == "MESH")  # noqa: E731
        forces = lambda: [each for each in self.scene.objects if properties.role(each) == "FORCE"]  # noqa: E731
        pick = lambda: forces()[chance.integers(len(forces()))]  # noqa: E731

        def clear_keys():
            for each in forces():
                each.animation_data_clear()

        def parent():
            hand = bpy.data.objects.new("Hand", None)
            self.scene.collection.objects.link(hand)
            key(hand, "location", (1, chance.normal(size=3) * 0.2), (14, chance.normal(size=3) * 0.2))
            pick().parent = hand

        sheet()
        force()
        number = iter(range(1000))
        moves = {
            "magnitude": lambda: setattr(pick().pliant, "magnitude", float(chance.uniform(20, 200))),
            "location": lambda: setattr(pick(), "location", chance.uniform(-0.4, 0.4, 3) * (1, 1, 0.2)),
            "rotation": lambda: setattr(pick(), "rotation_euler", chance.uniform(-0.5, 0.5, 3)),
            "keys": lambda: key(pick(), "pliant.magnitude", *((int(f), float(chance.uniform(0, 150)))
                                                              for f in chance.choice(20, 3, replace=False) + 1)),
            "keyed location": lambda: key(pick(), "location", (2, chance.uniform(-0.3, 0.3, 3)),
                                          (11, chance.uniform(-0.3, 0.3, 3))),
            "no keys": clear_keys,
            "add": lambda: force(f"Force {next(number)}", ("POINT", "RADIAL", "NOISE")[chance.integers(3)],
                                 chance.uniform(-0.4, 0.4, 3) * (1, 1, 0.2)),
            "remove": lambda: len(forces()) > 1 and bpy.data.objects.remove(pick()),
            "rename": lambda: setattr(owner_of(), "name", f"Skin {next(number)}"),
            "enable": lambda: setattr(pick().pliant, "enabled", bool(chance.integers(2))),
            "density": lambda: setattr(owner_of().pliant, "density", float(chance.uniform(20, 60))),
            "mesh": lambda: setattr(owner_of().data.vertices[int(chance.integers(400))].co, "z", chance.normal() * 0.02),
            "range": lambda: setattr(self.scene.pliant, "frame_end", int(chance.integers(12, 24))),
            "live": lambda: (setattr(self.scene.pliant, "live", False), update(), setattr(self.scene.pliant, "live", True)),
            "parent": parent,
            "modifier": lambda: owner_of().modifiers.new("Bend", "SIMPLE_DEFORM"),
            "no modifier": lambda: owner_of().modifiers.clear(),
        }  # fmt: skip
        bpy.ops.ed.undo_push(message="begin")
        done = []
        for _ in range(25):
            name = list(moves)[chance.integers(len(moves))]
            moves[name]()
            done.append(name)
            for each in owner_of().modifiers:  # what ours shows is compared, ahead of the others
                each.show_viewport = each.name == "pliant"
            if chance.random() < 0.5:
                update()
            if chance.random() < 0.6:
                self.scene.frame_set(int(chance.integers(-2, 26)))
            else:
                update()
            if chance.random() < 0.4:
                bpy.ops.ed.undo_push(message=name)
                if chance.random() < 0.5:
                    bpy.ops.ed.undo()
                    done.append("undo")
                    self.scene = bpy.context.scene
            owner = owner_of()
            with self.subTest(done=done[-4:], frame=self.scene.frame_current):
                if self.scene.frame_current < self.scene.pliant.frame_start:
                    np.testing.assert_array_equal(shown(owner), self.rest(owner))
                else:
                    self.check(owner)


class Shapes(Case):
    """The shape at rest, and modifiers around ours."""

    def armature(self, owner):
        armature = bpy.data.armatures.new("Bones")
        bones = bpy.data.objects.new("Bones", armature)
        self.scene.collection.objects.link(bones)
        bpy.context.view_layer.objects.active = bones
        bpy.ops.object.mode_set(mode="EDIT")
        bone = armature.edit_bones.new("Bone")
        bone.tail = (0, 0, 1)
        bpy.ops.object.mode_set(mode="OBJECT")
        owner.vertex_groups.new(name="Bone").add(list(range(len(owner.data.vertices))), 1.0, "REPLACE")
        modifier = owner.modifiers.new("Armature", "ARMATURE")
        modifier.object = bones
        pose = bones.pose.bones["Bone"]
        for frame, x in ((1, 0.0), (8, 0.5), (20, 0.0)):
            pose.location.x = x
            pose.keyframe_insert("location", frame=frame)
        return bones

    def test_an_armature_deforms_once(self):
        """Of BASE it does not deform what ours overwrites; it must be behind ours to do so."""
        owner = sheet()
        force()
        self.armature(owner)
        self.scene.frame_set(8)
        self.assertEqual([each.name for each in owner.modifiers], ["pliant", "Armature"])
        wanted = solved(owner, 8)
        np.testing.assert_allclose(shown(owner), wanted + np.float32([0.5, 0, 0]), rtol=0, atol=1e-6)

    def test_modifiers_ahead_are_the_rest_shape(self):
        owner = sheet(region="ALL")
        self.armature(owner)
        owner.pliant.rest = "MODIFIERS"
        swing = force("Swing", "INERTIA", magnitude=1, deformation_radius=100, force_radius=100)
        update()
        self.assertEqual([each.name for each in owner.modifiers], ["Armature", "pliant"])
        far = 0.0
        for frame in (1, 4, 8, 9, 12, 20):
            self.scene.frame_set(frame)
            found = self.check(owner)
            far = max(far, np.ptp(found[:, 0] - self.rest(owner)[:, 0]))
        self.assertGreater(far, 1e-3)  # it lags, where it is not held
        swing.pliant.enabled = False
        self.scene.frame_set(8)
        np.testing.assert_allclose(shown(owner), self.rest(owner) + np.float32([0.5, 0, 0]), rtol=0, atol=1e-6)

    def test_rest_ahead_of_the_start_follows_the_modifiers(self):
        owner = sheet()
        self.armature(owner)
        owner.pliant.rest = "MODIFIERS"
        self.scene.pliant.frame_start = 12
        for frame in (8, 1, 5):
            self.scene.frame_set(frame)
            x = bpy.data.objects["Bones"].pose.bones["Bone"].location.x
            np.testing.assert_allclose(shown(owner), self.rest(owner) + np.float32([x, 0, 0]), rtol=0, atol=1e-6)

    def test_modifiers_ahead_must_keep_the_vertices(self):
        owner = sheet(rest="MODIFIERS")
        owner.modifiers.new("Finer", "SUBSURF")
        update()
        bpy.context.view_layer.objects.active = owner
        bpy.ops.object.modifier_move_to_index(modifier="pliant", index=1)
        update()
        ((level, name, text),) = messages()
        self.assertEqual((level, name), ("ERROR", "Sheet"))
        self.assertIn("number", text)

    def test_ours_is_first_and_subdivision_is_behind(self):
        owner = sheet()
        force()
        owner.modifiers.new("Finer", "SUBSURF")
        self.scene.frame_set(7)
        self.assertEqual([each.name for each in owner.modifiers], ["pliant", "Finer"])
        bpy.context.view_layer.objects.active = owner
        bpy.ops.object.modifier_move_to_index(modifier="pliant", index=1)
        update()
        self.assertEqual([each.name for each in owner.modifiers], ["pliant", "Finer"])
        self.assertGreater(len(shown(owner)), len(owner.data.vertices))

    def test_edits_of_the_rest_shape_that_nothing_announces(self):
        owner = sheet(rest="MODIFIERS")
        force()
        owner.shape_key_add(name="Basis")
        raised = owner.shape_key_add(name="Up")
        for point in raised.data:
            point.co.z += 0.3
        wave = owner.modifiers.new("Wave", "WAVE")
        self.scene.frame_set(6)
        before = self.check(owner)
        edits = (
            lambda: setattr(raised, "value", 0.5),
            lambda: setattr(wave, "height", 1),
            lambda: raised.keyframe_insert("value", frame=1),
            lambda: setattr(wave, "show_viewport", False),
            lambda: setattr(raised, "value", 0.1),
            lambda: owner.data.shape_keys.animation_data_clear() or setattr(raised, "mute", True),
        )
        for number, edit in enumerate(edits):
            with self.subTest(number):
                edit()
                self.scene.frame_set(7 + number)
                self.check(owner)
        self.assertFalse(np.array_equal(before, shown(owner)))

    def test_where_the_rest_shape_comes_from_changes(self):
        owner = sheet()
        force()
        owner.modifiers.new("Wave", "WAVE")
        self.scene.frame_set(6)
        for step in (update, lambda: self.scene.frame_set(9)):
            for rest, place in (("MODIFIERS", 1), ("BASE", 0)):
                owner.pliant.rest = rest
                step()
                self.assertEqual(owner.modifiers.find("pliant"), place)
                if place:
                    self.check(owner)

    def test_a_modifier_of_the_artist_with_the_name_of_ours(self):
        owner = sheet()
        force()
        owner.modifiers.new("pliant", "SUBSURF").levels = 0
        for frame in (7, 8, 9):
            self.scene.frame_set(frame)
            self.assertEqual([each.type for each in owner.modifiers], ["MESH_CACHE", "SUBSURF"])
            self.check(owner)
        self.scene.pliant.live = False
        update()
        self.assertEqual([each.type for each in owner.modifiers], ["SUBSURF"])

    def test_its_place_comes_back(self):
        owner = sheet(rest="MODIFIERS")
        force()
        for name in "ab":
            owner.modifiers.new(name, "SMOOTH")
        update()
        bpy.context.view_layer.objects.active = owner
        bpy.ops.object.modifier_move_to_index(modifier="pliant", index=1)
        update()

        def toggle(of, name):
            for value in (False, True):
                setattr(of.pliant, name, value)
                update()

        def disable():
            addon_utils.disable("pliant_blender")
            addon_utils.enable("pliant_blender")
            live.refresh(self.scene)

        def save():
            with tempfile.TemporaryDirectory() as folder:
                bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "a.blend"), copy=True)

        for leave in (lambda: toggle(self.scene, "live"), lambda: toggle(owner, "solve"), disable, save):
            leave()
            self.assertEqual([each.name for each in owner.modifiers], ["a", "pliant", "b"])
        owner.pliant.rest = "BASE"
        update()
        save()
        owner.pliant.rest = "MODIFIERS"
        update()
        self.assertEqual([each.name for each in owner.modifiers], ["a", "b", "pliant"])

    def test_shape_keys(self):
        owner = sheet()
        force()
        owner.shape_key_add(name="Basis")
        raised = owner.shape_key_add(name="Up")
        for point in raised.data:
            point.co.z += 1
        raised.value = 1
        self.scene.frame_set(5)
        self.check(owner)
        self.assertLess(abs(shown(owner)[:, 2]).max(), 0.5)

    def test_any_mesh_without_uvs(self):
        bpy.ops.mesh.primitive_monkey_add()
        owner = bpy.context.object
        owner.data.uv_layers.remove(owner.data.uv_layers[0])
        owner.pliant.role = "SURFACE"
        owner.pliant.density, owner.pliant.dt = 20, 0.04
        force(location=(0, -0.5, 0.5), magnitude=2000, deformation_radius=0.7)
        self.scene.frame_set(6)
        self.check(owner)
        self.has_moved(owner)

    def test_a_driven_surface_follows(self):
        cage = sheet()
        force()
        skin = sheet("Skin", 41, 41)
        skin.pliant.driven_by = cage
        self.scene.frame_set(9)
        self.check(skin)
        self.has_moved(skin)
        self.assertEqual(skin.modifiers[0].name, "pliant")


class Placed(Case):
    """Places, parents and what else moves."""

    def test_everything_that_must_be_sampled(self):
        owner = sheet()
        poke = force()
        hand = bpy.data.objects.new("Hand", None)
        self.scene.collection.objects.link(hand)
        key(hand, "location", (1, (0, 0, 0)), (15, (0.3, -0.2, 0)))
        poke.constraints.new("COPY_LOCATION").target = hand
        poke.driver_add("pliant.magnitude").driver.expression = "frame * 10"
        self.scene.frame_set(10)
        self.check(owner)
        self.has_moved(owner)
        scene = translate.translate(self.scene).scene
        self.assertEqual([scene.sample("Poke.magnitude", frame) for frame in (1, 10)], [10, 100])
        np.testing.assert_allclose(scene.sample("Poke.center", 15), (0.3, -0.2, 0), atol=1e-6)
        notes = [text for level, name, text in messages() if level == "NOTE" and name == "Poke"]
        self.assertEqual(len(notes), 2)
        # A driver that changes without an update.
        poke.animation_data.drivers[0].driver.expression = "frame * 20"
        self.scene.frame_set(11)
        self.check(owner)
        self.assertEqual(translate.translate(self.scene).scene.sample("Poke.magnitude", 10), 200)

    def test_a_surface_that_a_parent_carries(self):
        owner = sheet()
        force(kind="INERTIA", magnitude=1, deformation_radius=50, force_radius=50)
        cart = bpy.data.objects.new("Cart", None)
        self.scene.collection.objects.link(cart)
        owner.parent = cart
        key(cart, "location", (1, (0, 0, 0)), (4, (0, 0, 0.8)), (9, (0, 0, 0)))
        key(cart, "rotation_euler", (1, (0, 0, 0)), (20, (0, 0, 7)))
        self.scene.frame_set(7)
        self.check(owner)
        self.has_moved(owner)
        turned = translate.translate(self.scene).scene.sample("Sheet.rotate", range(1, 21))
        self.assertLess(abs(np.diff(turned[:, 2])).max(), 60)  # no jump of 360
        np.testing.assert_allclose(turned[-1], np.degrees([0, 0, 7]), atol=1e-3)

    def test_drivers_that_read_the_frame_of_the_scene(self):
        owner = sheet()
        poke = force()
        driver = poke.driver_add("pliant.magnitude").driver
        target = driver.variables.new().targets[0]
        target.id_type, target.id, target.data_path = "SCENE", self.scene, "frame_current"
        driver.expression = "10 * var"
        self.scene.frame_set(8)
        made = translate.translate(self.scene).scene
        self.assertEqual([made.sample("Poke.magnitude", frame) for frame in (1, 8, 20)], [10, 80, 200])
        self.assertEqual((self.scene.frame_current, poke.pliant.magnitude), (8, 80))
        self.check(owner)

    def test_what_no_view_layer_evaluates_is_sampled_once(self):
        owner = sheet()
        poke = force()
        hidden = bpy.data.collections.new("Hidden")
        self.scene.collection.children.link(hidden)
        hidden.objects.link(poke)
        self.scene.collection.objects.unlink(poke)
        bpy.context.view_layer.layer_collection.children["Hidden"].exclude = True
        poke.driver_add("pliant.magnitude").driver.expression = "frame * 11"
        for frame in (9, 10):
            self.scene.frame_set(frame)
        samples = live.session_of(self.scene).translation.samples
        for frame in (11, 12):
            self.scene.frame_set(frame)
            self.assertIs(live.session_of(self.scene).translation.samples, samples)
        self.check(owner)

    def test_sampling_leaves_the_objects_as_they_are(self):
        sheet()
        poke = force()
        poke.driver_add("pliant.magnitude").driver.expression = "50 + frame"
        key(poke, "location", (1, (0, 0, 0)), (20, (0.5, 0, 0)))
        poke.constraints.new("LIMIT_LOCATION")
        self.scene.frame_set(7)
        place = tuple(poke.location)
        self.assertEqual(poke.pliant.magnitude, 57)
        poke.location.y = 0.25  # not keyed yet, such as while one drags
        update()
        self.assertEqual((poke.location.x, poke.location.y, poke.pliant.magnitude), (place[0], 0.25, 57))
        with tempfile.TemporaryDirectory() as folder:
            bpy.ops.pliant.export_scene(filepath=os.path.join(folder, "scene.xml"))
        self.assertEqual((poke.location.x, poke.location.y, poke.pliant.magnitude), (place[0], 0.25, 57))
        self.assertEqual([each.name for each in bpy.data.scenes], ["Scene"])
        self.assertEqual([name for name in live._sessions], ["Scene"])

    def test_edit_mode(self):
        owner = sheet()
        force()
        self.scene.frame_set(9)
        bpy.context.view_layer.objects.active = owner
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.translate(value=(0, 0, 0.1))
        update()
        self.assertEqual(messages(), [])
        self.scene.frame_set(10)
        bpy.ops.object.mode_set(mode="OBJECT")
        update()
        self.assertEqual(messages(), [])
        self.check(owner)
        self.assertGreater(shown(owner)[:, 2].max(), 0.1)

    def test_shear_and_a_scale_of_zero_are_refused_with_the_frame(self):
        owner = sheet()
        cart = bpy.data.objects.new("Cart", None)
        self.scene.collection.objects.link(cart)
        owner.parent, owner.rotation_euler = cart, (0, 0, 0.7)
        key(cart, "scale", (1, (1, 1, 1)), (10, (1, 1, 1)), (11, (2, 1, 1)), interpolation="CONSTANT")
        self.scene.frame_set(3)
        self.assertIn(("ERROR", "Sheet", "it is sheared at frame 11"), messages())

    def test_directions(self):
        sheet()
        poke = force()
        for turn, wanted in (((0, 0, 0), (0, 0, 1)), ((np.pi / 2, 0, 0), (0, -1, 0)), ((0, np.pi / 2, 0), (1, 0, 0))):
            poke.rotation_euler = turn
            update()
            part = translate.translate(self.scene).scene["Poke"]
            np.testing.assert_allclose(part.direction, wanted, atol=1e-6)
        cart = bpy.data.objects.new("Cart", None)
        self.scene.collection.objects.link(cart)
        cart.rotation_euler = (0, 0, np.pi / 2)
        poke.parent, poke.pliant.aim, poke.pliant.direction = cart, "VECTOR", (1, 0, 0)
        update()
        np.testing.assert_allclose(translate.translate(self.scene).scene["Poke"].direction, (0, 1, 0), atol=1e-6)

    def test_a_line_and_its_end(self):
        owner = sheet()
        line = force("Rod", "LINE", use_direction=True)
        self.scene.frame_set(6)
        self.assertIn("end", messages()[0][2])
        end = bpy.data.objects.new("Tip", None)
        end.location = (0.6, 0.2, 0)
        self.scene.collection.objects.link(end)
        line.pliant.end = end
        update()
        self.check(owner)
        self.has_moved(owner)
        part = translate.translate(self.scene).scene["Rod"]
        self.assertEqual((part.to, part.direction), ((0.6, 0.2, 0), (0, 0, 1)))
        end.location = (0.3, 0.6, 0)
        self.scene.frame_set(7)
        self.check(owner)
        key(end, "location", (1, (0.3, 0.6, 0)), (9, (0.5, 0, 0)))
        self.scene.frame_set(8)
        self.check(owner)
        end.animation_data.action.fcurves[0].keyframe_points[1].co.y = 0.7
        self.scene.frame_set(9)
        self.check(owner)

    def test_an_origin(self):
        owner = sheet()
        poke = force()
        self.scene.frame_set(8)
        before = self.check(owner)
        origin = bpy.data.objects.new("Origin", None)
        self.scene.collection.objects.link(origin)
        origin.matrix_world = Matrix.Translation((3, 1, 0)) @ Matrix.Rotation(np.pi / 2, 4, "X")
        owner.parent = poke.parent = origin
        self.scene.pliant.origin = origin
        update()
        made = translate.translate(self.scene).scene
        self.assertEqual((made["Poke"].center, made["Poke"].direction), ((0.1, 0.2, 0), (0, 0, 1)))
        np.testing.assert_array_equal(self.check(owner), before)

    def test_the_first_surface_takes_the_range_over(self):
        clear()
        scene = bpy.context.scene
        scene.frame_start, scene.frame_end = 101, 130
        sheet()
        update()
        self.assertEqual((scene.pliant.frame_start, scene.pliant.frame_end), (101, 130))
        scene.frame_start, scene.frame_end = 110, 115
        sheet("Second")
        update()
        self.assertEqual((scene.pliant.frame_start, scene.pliant.frame_end), (101, 130))

    def test_rates(self):
        sheet()
        for rate, base, wanted in ((24, 1, 24), (24, 1.001, 24000 / 1001), (30, 1.001, 30000 / 1001), (50, 2, 25)):
            self.scene.render.fps, self.scene.render.fps_base = rate, base
            self.assertEqual(translate.translate(self.scene).scene.fps, wanted)
        self.scene.render.frame_map_new = 200
        update()
        self.assertIn("time remapping", messages()[0][2])


class Wrong(Case):
    def test_an_error_keeps_the_last_sound_frame_and_goes_with_its_cause(self):
        owner = sheet()
        poke = force()
        self.scene.frame_set(8)
        before = self.check(owner)
        poke.pliant.deformation_radius = -2
        update()
        ((level, name, text),) = messages()
        self.assertEqual((level, name), ("ERROR", "Poke"))
        self.assertIn("-2", text)
        np.testing.assert_array_equal(shown(owner), before)
        poke.pliant.deformation_radius = 0.8
        update()
        self.assertEqual(messages(), [])
        self.check(owner)

    def test_references_to_what_is_no_part(self):
        sheet()
        poke = force()
        poke.pliant.targets.add()
        update()
        self.assertIn("targets", messages()[0][2])
        poke.pliant.targets.clear()
        update()
        poke.pliant.group = poke
        update()
        self.assertIn("group", messages()[0][2])

    def test_a_mesh_that_cannot_be_solved(self):
        mesh = bpy.data.meshes.new("Points")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
        owner = bpy.data.objects.new("Points", mesh)
        self.scene.collection.objects.link(owner)
        owner.pliant.role = "SURFACE"
        update()
        self.assertEqual([(level, name) for level, name, _ in messages()], [("ERROR", "Points")])

    def test_a_frame_that_fails_shows_the_last_sound_one(self):
        class Failing:
            """A simulation that has no frame from 12 on."""

            def __init__(self, real):
                self.real = real

            def __getattr__(self, name):
                return getattr(self.real, name)

            def at(self, frame):
                if frame >= 12:
                    raise pliant.SolverFailed(f"Sheet at frame {frame}")
                return self.real.at(frame)

        owner = sheet()
        force()
        update()
        session = live.session_of(self.scene)
        session.simulation = Failing(session.simulation)
        for frame in (19, 20, 12, 15):
            self.scene.frame_set(frame)
            self.check(owner, 11)
            self.assertEqual(messages(), [("ERROR", "Sheet", "Sheet at frame 12")])
        self.scene.frame_set(4)
        self.check(owner)

    def test_values_that_no_scene_takes(self):
        owner = sheet()
        poke = force(kind="NOISE", use_seed=True)
        origin = bpy.data.objects.new("Origin", None)
        self.scene.collection.objects.link(origin)
        self.scene.pliant.origin = poke.parent = origin
        poke.constraints.new("LIMIT_LOCATION")
        self.scene.frame_set(8)
        before = self.check(owner)
        nan = float("nan")
        for block, name, value, named in (
            (poke.pliant, "seed", -3, "Poke"),
            (poke.pliant, "magnitude", nan, "Poke"),
            (poke, "location", (nan, 0, 0), "Poke"),
            (origin, "scale", (0, 0, 0), "Origin"),
            (owner, "scale", (0, 1, 1), "Sheet"),
            (self.scene.pliant, "seed", -1, ""),
            (owner.pliant, "preroll", -1, "Sheet"),
            (owner.pliant, "loop", -1, "Sheet"),
            (owner.pliant, "dt", 0, "Sheet"),
            (owner.pliant, "density", -1, "Sheet"),
            (self.scene.pliant, "frame_end", -9, ""),
        ):
            with self.subTest(name=name, of=named):
                kept = getattr(block, name)
                kept = tuple(kept) if hasattr(kept, "__len__") else kept
                setattr(block, name, value)
                update()
                errors = [each for each in messages() if each[0] == "ERROR"]
                self.assertEqual({each[1] for each in errors}, {named}, errors)
                self.assertNotIn("Error:", errors[0][2])  # no exception that nobody expected
                np.testing.assert_array_equal(shown(owner), before)
                setattr(block, name, kept)
                update()
                self.assertEqual([each for each in messages() if each[0] == "ERROR"], [])
                np.testing.assert_array_equal(self.check(owner), before)

    def test_an_exception_is_a_message_that_goes(self):
        owner = sheet()
        force()
        self.scene.frame_set(5)
        real, live.translate.look_all = live.translate.look_all, None
        try:
            with contextlib.redirect_stderr(io.StringIO()):
                self.scene.frame_set(6)
        finally:
            live.translate.look_all = real
        self.assertEqual([each.level for each in live.session_of(self.scene).messages()], ["ERROR"])
        self.scene.frame_set(7)
        self.assertEqual(messages(), [])
        self.check(owner)

    def test_files_that_are_gone_hurt_nobody(self):
        owner = sheet()
        force()
        self.scene.frame_set(5)
        os.unlink(owner.modifiers["pliant"].filepath)
        bpy.ops.pliant.reset()
        self.scene.frame_set(7)
        self.check(owner)

    def test_what_is_no_mesh_stops_no_other(self):
        owner = sheet()
        force()
        self.scene.frame_set(8)
        for data in (None, bpy.data.curves.new("Curve", "CURVE")):
            other = bpy.data.objects.new("Other", data)
            self.scene.collection.objects.link(other)
            other.pliant.role = "SURFACE"
            update()
            ((level, name, text),) = messages()
            self.assertEqual((level, name), ("ERROR", "Other"))
            self.assertIn("mesh", text)
            bpy.data.objects.remove(other)
            update()
            self.check(owner)

    def test_words_of_later_versions(self):
        owner = sheet()
        poke = force()
        other = force("Other")
        self.scene.frame_set(8)
        for block, name, told in ((poke, "kind", "Poke"), (owner, "integrator", "Sheet"), (other, "role", None)):
            with self.subTest(name):
                kept = getattr(block.pliant, name)
                block.pliant[name] = 99
                block.update_tag()
                update()
                self.assertEqual([(level, named) for level, named, _ in messages()], [("ERROR", told)] if told else [])
                setattr(block.pliant, name, kept)
                update()
                self.assertEqual(messages(), [])
                self.check(owner)

    def test_a_rest_shape_that_another_surface_makes_is_refused(self):
        body = sheet()
        force()
        cloth = sheet("Cloth", 11, 11, rest="MODIFIERS", location=(0, 0, 0.2))
        wrap = cloth.modifiers.new("Wrap", "SHRINKWRAP")
        wrap.target = body
        self.scene.frame_set(8)
        ((level, name, text),) = messages()
        self.assertEqual((level, name), ("ERROR", "Cloth"))
        self.assertIn("'Wrap'", text)
        cloth.pliant.rest = "BASE"
        update()
        self.assertEqual(messages(), [])
        self.check(body)

    def test_warnings_name_the_object_and_frames(self):
        sheet()
        force(location=(50, 0, 0))
        self.scene.frame_set(5)
        self.assertEqual([(level, name) for level, name, _ in messages()], [("WARNING", "Poke")])


class Kept(Case):
    """Undo, files, scenes, leaving."""

    def test_undo_and_redo(self):
        owner = sheet()
        force()
        self.scene.frame_set(9)
        bpy.ops.ed.undo_push(message="made")
        states = [shown(owner)]
        for number, edit in enumerate((
            lambda: setattr(bpy.data.objects["Poke"].pliant, "magnitude", 300),
            lambda: setattr(bpy.data.objects["Poke"], "location", (0, 0, 0.1)),
            lambda: key(bpy.data.objects["Poke"], "pliant.magnitude", (1, 0), (9, 200)),
            lambda: bpy.data.objects.remove(bpy.data.objects["Poke"]),
        )):  # fmt: skip
            edit()
            update()
            bpy.ops.ed.undo_push(message=str(number))
            states.append(shown(bpy.data.objects["Sheet"]))
        for wanted in states[-2::-1]:
            bpy.ops.ed.undo()
            self.scene = bpy.context.scene
            np.testing.assert_array_equal(shown(bpy.data.objects["Sheet"]), wanted)
            self.check(bpy.data.objects["Sheet"])
        for wanted in states[1:]:
            bpy.ops.ed.redo()
            self.scene = bpy.context.scene
            np.testing.assert_array_equal(shown(bpy.data.objects["Sheet"]), wanted)

    def test_undo_of_the_name_of_a_scene(self):
        sheet()
        force()
        self.scene.frame_set(9)
        bpy.ops.ed.undo_push(message="made")
        wanted = shown(bpy.data.objects["Sheet"])
        self.scene.name = "Other"
        update()
        bpy.ops.ed.undo_push(message="named")
        for step, name in ((bpy.ops.ed.undo, "Scene"), (bpy.ops.ed.redo, "Other")):
            step()
            self.assertEqual(bpy.context.scene.name, name)
            np.testing.assert_array_equal(shown(bpy.data.objects["Sheet"]), wanted)

    def library(self):
        """Links what a file has that is saved now."""
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "asset.blend")
            bpy.ops.wm.save_as_mainfile(filepath=file)
            clear()
            self.scene = bpy.context.scene
            self.scene.pliant.frame_end = 20
            with bpy.data.libraries.load(file, link=True) as (there, into):
                into.objects, into.collections = there.objects, there.collections
        return into

    def test_a_modifier_that_an_override_cannot_move_is_told(self):
        owner = sheet()
        force()
        owner.modifiers.new("Bend", "SIMPLE_DEFORM")
        rig = bpy.data.collections.new("Rig")
        self.scene.collection.children.link(rig)
        rig.objects.link(owner)
        made = self.library().collections[0]
        self.scene.collection.children.link(made)
        made.override_hierarchy_create(self.scene, bpy.context.view_layer)
        self.scene.collection.children.unlink(made)
        self.scene.frame_set(9)
        self.assertEqual([(level, name) for level, name, _ in messages()], [("ERROR", "Sheet")])
        self.assertIn("'Bend'", messages()[0][2])
        next(each for each in self.scene.objects if each.type == "MESH").pliant.rest = "MODIFIERS"
        update()
        self.assertEqual([each for each in messages() if each[0] == "ERROR"], [])

    def test_linked_forces_with_the_names_of_others(self):
        sheet()
        poke = force(location=(-0.4, -0.3, 0))
        poke.driver_add("pliant.magnitude").driver.expression = "frame * 10"
        linked = next(each for each in self.library().objects if each.type == "EMPTY")
        self.scene.collection.objects.link(linked)
        owner = sheet()
        force(magnitude=33)
        self.scene.frame_set(8)
        self.assertEqual({level for level, _, _ in messages()}, {"NOTE"})
        self.check(owner)
        made = translate.translate(self.scene).scene
        self.assertEqual(sorted(made.sample(f"{each.name}.magnitude", 8) for each in made.forces), [33, 80])

    def test_a_file_has_no_live_modifier_and_is_live_when_opened(self):
        owner = sheet()
        force()
        owner.modifiers.new("Finer", "SUBSURF").levels = 0
        self.scene.frame_set(9)
        before = shown(owner)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "a.blend")
            bpy.ops.wm.save_as_mainfile(filepath=file)
            self.assertEqual([each.name for each in owner.modifiers], ["pliant", "Finer"])
            np.testing.assert_array_equal(shown(owner), before)
            script = (
                "import bpy; o = bpy.data.objects['Sheet']; print('STACK', [m.name for m in o.modifiers]);"
                "d = bpy.context.evaluated_depsgraph_get(); print('TOP', max(v.co.z for v in o.evaluated_get(d).data.vertices))"
            )
            plain = subprocess.run(
                [bpy.app.binary_path, "-b", "--factory-startup", file, "--python-expr", script],
                capture_output=True, text=True,
            )  # fmt: skip
            self.assertIn("STACK ['Finer']\nTOP 0.0", plain.stdout)
            self.assertNotIn("rror", plain.stdout + plain.stderr)
            bpy.ops.wm.open_mainfile(filepath=file)
        self.scene = bpy.context.scene
        owner = bpy.data.objects["Sheet"]
        self.assertEqual([each.name for each in owner.modifiers], ["pliant", "Finer"])
        np.testing.assert_array_equal(shown(owner), before)

    def test_linked_appended_and_overridden_surfaces(self):
        owner = sheet()
        poke = force()
        rig = bpy.data.collections.new("Rig")
        self.scene.collection.children.link(rig)
        for each in (owner, poke):
            rig.objects.link(each)
            self.scene.collection.objects.unlink(each)
        self.scene.frame_set(9)
        before = shown(owner)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "asset.blend")
            bpy.ops.wm.save_as_mainfile(filepath=file)
            for is_linked in (False, True):
                with self.subTest(is_linked=is_linked):
                    clear()
                    self.scene = bpy.context.scene
                    with bpy.data.libraries.load(file, link=is_linked) as (_, into):
                        into.collections = ["Rig"]
                    made = into.collections[0]
                    self.scene.collection.children.link(made)
                    if is_linked:
                        update()
                        self.assertIn("override", " ".join(text for _, _, text in messages()))
                        made.override_hierarchy_create(self.scene, bpy.context.view_layer)
                        self.scene.collection.children.unlink(made)
                    self.scene.frame_set(9)
                    self.scene.pliant.frame_end = 20
                    update()
                    found = next(each for each in self.scene.objects if each.type == "MESH" and not each.library)
                    np.testing.assert_array_equal(shown(found), before)
                    if is_linked:
                        next(each for each in self.scene.objects if each.type == "EMPTY" and not each.library).pliant.magnitude = 200
                        update()
                        self.check(found)
                        self.assertFalse(np.array_equal(shown(found), before))

    def test_scenes_are_apart(self):
        owner = sheet()
        force()
        self.scene.frame_set(6)
        first = self.scene
        other = bpy.data.scenes.new("Other")
        other.collection.objects.link(owner)
        bpy.context.window.scene = other
        other.frame_set(6)
        self.assertIn("Scene", " ".join(text for _, _, text in messages(other)))
        other.pliant.live = False
        update()
        self.assertEqual(messages(other), [])
        self.assertEqual([each.name for each in owner.modifiers], ["pliant"])
        bpy.context.window.scene = first
        first.frame_set(7)
        self.assertEqual(messages(first), [])
        self.check(owner)

    def test_only_channels_have_keys(self):
        rows = properties.PliantObject.bl_rna.properties
        keyable = {name for names in properties.KEYABLE.values() for name in names} | set(properties.TANGENTS)
        self.assertEqual({each.identifier for each in rows if each.is_animatable} - {"rna_type", "name"}, keyable)
        hidden = {"rna_type", "name", "place"}
        self.assertEqual({each.identifier for each in rows if not each.is_overridable} - hidden, set())
        self.assertEqual({each.identifier for each in rows if not each.description} - hidden, set())

    def test_what_has_no_role_carries_nothing(self):
        owner = sheet()
        other = bpy.data.objects.new("Other", None)
        self.scene.collection.objects.link(other)
        self.scene.frame_set(5)
        self.assertFalse(properties.has(other))
        self.assertNotIn("pliant", other.keys())
        clear()
        bpy.context.scene.frame_set(3)
        self.assertNotIn("pliant", bpy.context.scene.keys())
        del owner

    def test_disabling_leaves_the_properties_only(self):
        owner = sheet()
        force()
        self.scene.frame_set(5)
        before = shown(owner)
        for _ in range(3):
            addon_utils.disable("pliant_blender")
            self.assertEqual(list(owner.modifiers), [])
            left = [each for handlers in (getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers))
                    if isinstance(handlers, list) for each in handlers if "pliant" in each.__module__]  # fmt: skip
            self.assertEqual(left, [])
            self.assertEqual([name for name in dir(bpy.types) if "pliant" in name.lower()], [])
            addon_utils.enable("pliant_blender")
            live.refresh(self.scene)
            np.testing.assert_array_equal(shown(owner), before)

    def test_all_is_left_though_a_part_fails(self):
        from pliant_blender import files

        owner = sheet()
        self.scene.frame_set(5)
        real, seen = files.unregister, []

        def failing():
            real()
            raise ValueError("a part that fails")

        addon_utils.disable("pliant_blender")
        files.unregister = failing
        try:
            addon_utils.enable("pliant_blender")
            live.refresh(self.scene)
            self.assertEqual([each.name for each in owner.modifiers], ["pliant"])
            addon_utils.disable("pliant_blender", handle_error=seen.append)
        finally:
            files.unregister = real
        self.assertEqual([str(each) for each in seen], ["a part that fails"])
        self.assertEqual(list(owner.modifiers), [])
        self.assertFalse(hasattr(bpy.types.Scene, "pliant"))
        addon_utils.enable("pliant_blender")

    def test_other_modules_stay_as_they_are(self):
        self.assertNotIn("pliant", sys.modules)
        self.assertEqual([each for each in sys.path if "pliant_blender" in each], [])


class Rendered(Case):
    def test_renders_see_what_is_live(self):
        owner = sheet()
        force()
        self.scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        self.scene.collection.objects.link(self.scene.camera)
        self.scene.render.engine = "CYCLES"
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 1, False
        self.scene.render.resolution_x = self.scene.render.resolution_y = 8
        self.scene.render.use_motion_blur = True
        self.scene.frame_start, self.scene.frame_end = 6, 9
        seen = {}

        def watch(scene, graph):
            mesh = owner.evaluated_get(graph).data
            found = np.empty(3 * len(mesh.vertices), np.float32)
            mesh.vertices.foreach_get("co", found)
            seen[scene.frame_current + scene.frame_subframe] = found.reshape(-1, 3)

        bpy.app.handlers.frame_change_post.append(watch)
        with tempfile.TemporaryDirectory() as folder:
            self.scene.render.filepath = os.path.join(folder, "#")
            # An edit that nothing has seen yet.
            bpy.data.objects["Poke"].pliant.magnitude = 130
            bpy.ops.render.render(animation=True)
            self.assertEqual(len(os.listdir(folder)), 4)
        bpy.app.handlers.frame_change_post.remove(watch)
        self.assertTrue({6, 7, 8, 9} <= set(seen), sorted(seen))
        self.assertTrue(any(frame % 1 for frame in seen), sorted(seen))
        for frame, found in seen.items():
            low, part = int(np.floor(frame)), frame % 1
            wanted = (1 - part) * solved(owner, low).astype(float) + part * solved(owner, low + 1)
            np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-6, err_msg=str(frame))


if __name__ == "__main__":
    unittest.main()
