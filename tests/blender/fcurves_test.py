"""Runs inside Blender: F-curves as curves of pliant, and back, against Blender's own evaluation.

usage: blender -b --factory-startup -noaudio --python-exit-code 1 -P fcurves_test.py

Uses the add-on if Blender has it, else the sources beside this file and the module in build/release/python.
"""

import itertools
import os
import random
import struct
import sys
import types
import unittest
from unittest import mock

import addon_utils
import bpy
import numpy as np

if __name__ == "__main__" and not addon_utils.enable("pliant_blender"):
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    package = types.ModuleType("pliant_blender")
    package.__path__ = [os.path.join(root, *each) for each in (
        ("blender", "pliant_blender"), ("script",), ("build", "release", "python"))]  # fmt: skip
    sys.modules["pliant_blender"] = package

from pliant_blender import fcurves, pliant  # noqa: E402

EASES = ("SINE", "QUAD", "CUBIC", "QUART", "QUINT", "EXPO", "CIRC", "BACK", "BOUNCE", "ELASTIC")
SIDES = ("AUTO", "EASE_IN", "EASE_OUT", "EASE_IN_OUT")
CYCLES = ("NONE", "REPEAT", "REPEAT_OFFSET", "MIRROR")
HANDLES = ("FREE", "ALIGNED", "VECTOR", "AUTO", "AUTO_CLAMPED")
WORDS = [ease + side for ease in map(str.lower, EASES) for side in ("In", "Out", "InOut")]
TANGENTS = ("auto", "spline", "linear", "flat", "clamped", "plateau", "smooth", "free", 0.5, -2.0)
BESIDE = ("hold", "hold", "linear", "linearOuter", "slope", "repeat", "repeatOffset", "mirror", "repeat 2", "mirror 2",
          "mirror 3", "repeatOffset 2")  # fmt: skip

FRAMES = np.arange(-40.0, 121.0)
BETWEEN = np.float32(np.concatenate([FRAMES + 0.37, FRAMES + 0.71])).astype(float)


def single(number):
    return struct.unpack("f", struct.pack("f", number))[0]


class Case(unittest.TestCase):
    def setUp(self):
        self.owner = bpy.data.objects.new("Owner", None)
        bpy.context.scene.collection.objects.link(self.owner)

    def tearDown(self):
        bpy.data.objects.remove(self.owner)

    def make(self, keys, path="empty_display_size", index=0, extrapolation="CONSTANT", cycles=None, handles=None):
        """An F-curve of (frame, value, interpolation, {name: value}) or less."""
        curve = fcurves.new(self.owner, path, index)
        curve.keyframe_points.add(len(keys))
        for point, (frame, value, *more) in zip(curve.keyframe_points, keys):
            point.co = frame, value
            point.interpolation = more[0] if more else "BEZIER"
            if not handles:
                point.handle_left_type = point.handle_right_type = "AUTO_CLAMPED"
            for name, each in (more[1] if len(more) > 1 else {}).items():
                setattr(point, name, each)
        curve.extrapolation = extrapolation
        if cycles:
            modifier = curve.modifiers.new("CYCLES")
            modifier.mode_before, modifier.cycles_before, modifier.mode_after, modifier.cycles_after = cycles
        curve.update()
        return curve

    def random_keys(self, chance, frames, values=None):
        keys = []
        for number, frame in enumerate(frames):
            kind = chance.choice(("BEZIER", "BEZIER", "BEZIER", "LINEAR", "CONSTANT", "EASE", "EASE"))
            value = chance.uniform(-10, 10) if values is None else values[number]
            more = {
                "easing": chance.choice(SIDES),
                "back": chance.uniform(0, 3),
                "amplitude": chance.choice((0, chance.uniform(0, 20))),
                "period": chance.choice((0, 4.1)),
                "handle_left_type": chance.choice(HANDLES),
                "handle_right_type": chance.choice(HANDLES),
                "handle_left": (frame - chance.uniform(0, 15), value + chance.uniform(-8, 8)),
                "handle_right": (frame + chance.uniform(0, 15), value + chance.uniform(-8, 8)),
            }
            keys.append((frame, value, chance.choice(EASES) if kind == "EASE" else kind, more))
        return keys

    def random_frames(self, chance):
        step = chance.choice((1, 1, 0.125))
        frames = [step * chance.randint(0, round(20 / step))]
        for _ in range(chance.randint(0, 5)):
            frames.append(frames[-1] + step * chance.randint(round(1 / step), round(14 / step)))
        return frames

    def random_cycles(self, chance, is_endless=False):
        if chance.random() < 0.5:
            return None
        counts = (0,) if is_endless else (0, 0, 2, 3)
        return chance.choice(CYCLES), chance.choice(counts), chance.choice(CYCLES), chance.choice(counts)

    def compare(self, curve, seen, frames, what, shift=0.0, digit=2.0**-23):
        """`seen`: what Blender has. `shift`: it is off by so many frames, times being in single precision there."""
        ours = np.array(curve(frames))
        low, high = curve.range(frames.min(), frames.max())
        slack = 2e-6 * (high - low) + digit * np.abs(ours).max()
        least, most = ours - slack, ours + slack
        if shift:
            near = np.array([curve(frames + shift * side) for side in (-1, -0.5, 0.5, 1)] + [ours])
            least, most = near.min(axis=0) - slack, near.max(axis=0) + slack
        wrong = np.flatnonzero(~((least <= seen) & (seen <= most)))
        if len(wrong):
            k = wrong[0]
            self.fail(f"{what}: frame {frames[k]}: Blender {seen[k]}, pliant {ours[k]}; {len(wrong)}, {curve.keys}")


def evaluated(curve, frames):
    return np.array([curve.evaluate(frame) for frame in frames.tolist()])


class Reading(Case):
    def test_random_curves_have_blenders_values_on_frames_and_between(self):
        chance, reasons, counted = random.Random(1), set(), 0
        for number in range(700):
            cycles = self.random_cycles(chance)
            keys = self.random_keys(chance, self.random_frames(chance))
            extrapolation = chance.choice(("CONSTANT", "LINEAR"))
            curve = self.make(keys, extrapolation=extrapolation, cycles=cycles, handles=True)
            try:
                value = fcurves.read([curve], [0.0])
            except fcurves.Sampled as reason:
                reasons.add(str(reason))
                continue
            counted += 1
            self.assertEqual(len(value.keys), len(keys))
            # Copies are found in single precision.
            shift = 3e-5 if cycles else 4e-6
            # Over a long line the last digits of keys count.
            digit = 2.0**-18 if extrapolation == "LINEAR" else 2.0**-23
            self.compare(value, evaluated(curve, FRAMES), FRAMES, number, shift, digit)
            self.compare(value, evaluated(curve, BETWEEN), BETWEEN, number, shift, digit)
        self.assertGreater(counted, 500)
        self.assertEqual(
            reasons, {"counted CYCLES that end elsewhere", "an ELASTIC that falls by less than its amplitude"}
        )

    def test_every_easing(self):
        for ease, side, (start, end), more in itertools.product(
            EASES, SIDES, ((-1, 3), (3, -1), (2, 2)), ({}, {"amplitude": 0.5}, {"amplitude": 7, "period": 3})
        ):
            curve = self.make([(3, start, ease, {"easing": side, "back": 1.1, **more}), (24, end)])
            what = ease, side, start, end, more
            if ease == "ELASTIC" and more.get("amplitude", 0) > end - start >= -more.get("amplitude", 0):
                if start >= end:
                    with self.assertRaisesRegex(fcurves.Sampled, "ELASTIC", msg=what):
                        fcurves.read([curve], [0.0])
                    continue
            value = fcurves.read([curve], [0.0])
            for frames in (FRAMES, BETWEEN):
                self.compare(value, evaluated(curve, frames), frames, what, shift=4e-6)

    def test_steps_beside_a_frame_come_on_it(self):
        for kind, shift in itertools.product(("number", "switch"), (-5e-5, -1e-6, 1e-6, 5e-5, 0.01, -0.01)):
            keys = [(1, 0, "CONSTANT"), (9 + shift, 1, "CONSTANT"), (16 + shift, 0, "CONSTANT"), (20, 1, "CONSTANT")]
            for cycles in (None, ("REPEAT", 0, "REPEAT", 0), ("MIRROR", 0, "MIRROR", 0)):
                curve = self.make(keys, cycles=cycles)
                value = fcurves.read([curve], [0.0], kind=kind)
                self.assertEqual(value(FRAMES).tolist(), evaluated(curve, FRAMES).tolist(), (kind, shift, cycles))

    def test_numbers_have_the_fewest_digits(self):
        curve = self.make([(1, 0.1, "LINEAR"), (12.3, 1e-3)])
        value = fcurves.read([curve], [0.0])
        self.assertEqual([(key.frame, key.value) for key in value.keys], [(1, 0.1), (12.3, 0.001)])
        self.assertEqual(fcurves.read([None], [single(0.7)]), 0.7)
        self.assertEqual(fcurves.read([None] * 3, [single(0.7), 2, 3]), (0.7, 2, 3))
        self.assertIs(fcurves.read([None], [1.0], kind="switch"), True)

    def test_scale_and_degrees(self):
        curve = self.make([(1, 0.1, "ELASTIC", {"amplitude": 2}), (9, 1.0)])
        seen = evaluated(curve, FRAMES)
        self.compare(fcurves.read([curve], [0.0], scale=100.0), 100 * seen, FRAMES, "scaled", shift=4e-6)
        turns = [self.make([(1, 0.1), (9, 1.0)], "rotation_euler", index) for index in range(2)]
        value = fcurves.read([*turns, None], [0, 0, single(0.5)], kind="rotation")
        self.assertEqual(value.keys[0].value, tuple(np.degrees([0.1, 0.1, 0.5])))
        self.assertEqual(fcurves.read([None] * 3, [0, 0, single(0.5)], kind="rotation"), (0, 0, np.degrees(0.5)))
        self.compare(
            pliant.Curve([(key.frame, key.value[1]) for key in value.keys]), np.degrees(evaluated(turns[1], FRAMES)),
            FRAMES, "degrees", shift=4e-6,
        )  # fmt: skip

    def test_a_scene_keeps_the_bits(self):
        chance, scene = random.Random(2), pliant.Scene(start=1, end=60)
        scene.surfaces.append(pliant.Surface("s"))
        while len(scene.forces) < 60:
            frames = self.random_frames(chance)
            path = ["location", "rotation_euler", "empty_display_size"][len(scene.forces) % 3]
            kind = {"location": "vector", "rotation_euler": "rotation"}.get(path, "number")
            size = 1 if kind == "number" else 3
            model = self.random_keys(chance, frames)
            curves = [
                self.make([(key[0], chance.uniform(-3, 3), *key[2:]) for key in model], path, index,
                          cycles=self.random_cycles(random.Random(len(frames)), True))
                for index in range(size)
            ]  # fmt: skip
            try:
                value = fcurves.read(curves, [0] * size, kind=kind)
            except fcurves.Sampled:
                value = fcurves.sampled(range(1, 61), np.array([evaluated(each, FRAMES[41:101]) for each in curves]).T)
            force = pliant.Point(f"p{len(scene.forces)}", targets=("s",))
            setattr(force, "magnitude" if size == 1 else "center", value)
            scene.forces.append(force)
        again = pliant.parse(scene.to_xml())
        for force, other in zip(scene.forces, again.forces):
            for name in ("magnitude", "center"):
                self.assertEqual(getattr(force, name), getattr(other, name))

    def test_unchanged_curves_are_not_read_again(self):
        curves = [self.make([(1, 0.1), (9, each)], "location", each) for each in range(3)]
        value = fcurves.read(curves, [0, 0, 0], kind="vector")
        with mock.patch.object(pliant, "read_curves", side_effect=AssertionError):
            self.assertIs(fcurves.read(curves, [0, 0, 0], kind="vector"), value)
            curves[1].keyframe_points[0].co[1] += 1
            with self.assertRaises(AssertionError):
                fcurves.read(curves, [0, 0, 0], kind="vector")
        self.assertNotEqual(fcurves.read(curves, [0, 0, 0], kind="vector"), value)

    def test_many_are_read_in_one_file(self):
        curves = [self.make([(1, each), (9, 7)], "location", each) for each in range(3)]
        noise = self.make([(1, 0)], "scale")
        noise.modifiers.new("NOISE")
        broken = self.make([(1, float("inf")), (9, 1)], "scale", 1)
        requests = [fcurves.Request([each], [0]) for each in (*curves, None, noise)]
        with mock.patch.object(pliant, "read_curves", wraps=pliant.read_curves) as reader:
            results = fcurves.read_many(requests)
            self.assertEqual(reader.call_count, 1)
        self.assertEqual([each.keys[0].value for each in results[:3]], [0, 1, 2])
        self.assertEqual(results[3], 0)
        self.assertIsInstance(results[4], fcurves.Sampled)
        results = fcurves.read_many([fcurves.Request([each], [0]) for each in (noise, curves[2], broken)])
        self.assertEqual([type(each) for each in results], [fcurves.Sampled, pliant.Curve, fcurves.Sampled])


class Sides(Case):
    """Vectors and switches."""

    def vector(self, rows, **more):
        return [each and self.make(each, "location", index, **more) for index, each in enumerate(rows)]

    def check(self, curves, statics, what):
        value = fcurves.read(curves, statics, kind="vector")
        for frames in (FRAMES, BETWEEN):
            ours = value(frames)
            for index, curve in enumerate(curves):
                if curve is None:
                    self.assertTrue((ours[:, index] == statics[index]).all())
                    continue
                seen = evaluated(curve, frames)
                # Over a long line the last digit of a handle's tip counts.
                digit = 2.0**-18 if curve.extrapolation == "LINEAR" else 2.0**-22
                slack = 3e-6 * np.ptp(ours[:, index]) + digit * np.abs(ours[:, index]).max()
                near = [value(frames + shift)[:, index] for shift in (-3e-5, 3e-5)] + [ours[:, index]]
                is_near = (np.min(near, axis=0) - slack <= seen) & (seen <= np.max(near, axis=0) + slack)
                self.assertTrue(is_near.all(), (what, index, frames[~is_near], value.keys))
        return value

    def test_random_vectors(self):
        chance, counted = random.Random(3), 0
        for number in range(150):
            model = self.random_keys(chance, self.random_frames(chance))
            for key in model:
                for name in ("handle_left", "handle_right", "handle_left_type", "handle_right_type"):
                    del key[3][name]
            more = {"extrapolation": chance.choice(("CONSTANT", "LINEAR")), "cycles": self.random_cycles(chance, True)}
            rows = [[(key[0], chance.uniform(-9, 9), *key[2:]) for key in model] for _ in range(3)]
            if chance.random() < 0.3:
                rows[chance.randint(0, 2)] = None
            curves = self.vector(rows, **more)
            try:
                value = self.check(curves, [0.5, 1, 2], number)
            except fcurves.Sampled as reason:
                self.assertIn("ELASTIC", str(reason))
                continue
            counted += 1
            self.assertEqual(len(value.keys), len(model))
        self.assertGreater(counted, 100)

    def test_what_keyframe_insert_makes(self):
        for frame, place in ((1, (0, 1, 2)), (9, (3, -1, 2)), (12, (3, 5, 2))):
            self.owner.location = place
            self.owner.keyframe_insert("location", frame=frame)
        table = fcurves.table(self.owner.animation_data)
        value = self.check([table["location", index] for index in range(3)], (0, 0, 0), "inserted")
        self.assertEqual([key.frame for key in value.keys], [1, 9, 12])

    def test_what_differs_is_sampled(self):
        model = [(1, 0.0, "BEZIER"), (5, 1.0, "BACK", {"back": 1.0}), (9, 3.0)]
        self.check(self.vector([model, model, model]), (0, 0, 0), "model")
        others = {
            "frame": [(1, 0.0), (6, 1.0, "BACK", {"back": 1.0}), (9, 3.0)],
            "count": model[:2],
            "word": [(1, 0.0, "LINEAR"), *model[1:]],
            "easing": [model[0], (5, 1.0, "BACK", {"back": 1.0, "easing": "EASE_IN"}), model[2]],
            "number": [model[0], (5, 1.0, "BACK", {"back": 2.0}), model[2]],
            "handle": [(1, 0.0, "BEZIER", {"handle_right_type": "FREE", "handle_right": (3, 0)}), *model[1:]],
        }
        for what, other in others.items():
            with self.assertRaisesRegex(fcurves.Sampled, "^keys of its components differ$", msg=what):
                fcurves.read(self.vector([model, model, other]), (0, 0, 0), kind="vector")
        curves = self.vector([model, model, model], cycles=("REPEAT", 0, "REPEAT", 0))
        curves[1].modifiers[0].mode_after = "MIRROR"
        with self.assertRaisesRegex(fcurves.Sampled, "differ"):
            fcurves.read(curves, (0, 0, 0), kind="vector")

    def test_lines_beyond_the_keys_may_differ(self):
        for words in itertools.product(("LINEAR", "BEZIER", "CONSTANT"), repeat=2):
            rows = [[(1, value, words[0]), (5, 1, "LINEAR"), (9, -value, words[1])] for value in (1.0, 4.0, 7.0)]
            curves = self.vector(rows, extrapolation="LINEAR")
            curves[1].extrapolation = "CONSTANT"
            curves[2].keyframe_points[0].handle_left_type = "FREE"
            curves[2].keyframe_points[0].handle_left = (-2, 3)
            self.check(curves, (0, 0, 0), words)

    def test_numbers_of_an_elastic_without_a_change_mean_nothing(self):
        rows = [[(1, 0, "ELASTIC", {"amplitude": amplitude}), (9, end)] for amplitude, end in ((2, 3), (0, 0), (2, 1))]
        self.check(self.vector(rows), (0, 0, 0), "elastic")

    def test_random_switches(self):
        chance = random.Random(4)
        for number in range(200):
            frames = [round(each) for each in self.random_frames(chance)]
            frames = [each + 2 * index for index, each in enumerate(frames)]
            keys = [(frame, chance.choice((0, 1)), "CONSTANT") for frame in frames]
            cycles = self.random_cycles(chance, True)
            curve = self.make(keys, "show_in_front", extrapolation=chance.choice(("CONSTANT", "LINEAR")), cycles=cycles)
            try:
                value = fcurves.read([curve], [0], kind="switch")
            except fcurves.Sampled as reason:
                self.assertEqual(str(reason), "copies of a switch with an offset")
                continue
            self.assertEqual({key.interpolation for key in value.keys}, {"step"})
            self.assertEqual(len(value.keys), len(keys))
            seen = (evaluated(curve, FRAMES) > 1 - 1e-7).astype(float)
            self.assertTrue((value(FRAMES) == seen).all(), (number, keys, cycles))

    def test_switches_are_true_where_blender_has_it_so(self):
        self.owner.show_in_front = False
        self.owner.keyframe_insert("show_in_front", frame=1)
        self.owner.keyframe_insert("show_in_front", frame=5)
        inserted = fcurves.table(self.owner.animation_data)["show_in_front", 0]
        self.assertEqual(fcurves.read([inserted], [0], kind="switch").keys[1].value, 0)
        inserted.keyframe_points[1].co[1] = 0.6
        made = self.make([(1, -3, "CONSTANT"), (3, 0.6, "CONSTANT"), (5, 1, "CONSTANT"), (7, 9)], "hide_render")
        for curve, path in ((inserted, "show_in_front"), (made, "hide_render")):
            value = fcurves.read([curve], [0], kind="switch")
            for frame in range(0, 9):
                bpy.context.scene.frame_set(frame)
                self.assertEqual(getattr(self.owner, path), bool(value(frame)), (path, frame))

    def test_a_switch_that_does_not_step_is_sampled(self):
        for word in ("LINEAR", "BEZIER", "SINE"):
            with self.assertRaisesRegex(fcurves.Sampled, "not CONSTANT"):
                fcurves.read([self.make([(1, 0, word), (5, 1)], "show_in_front")], [0], kind="switch")


class Reasons(Case):
    """What is sampled, and what does not count."""

    def refused(self, curve, pattern):
        with self.assertRaisesRegex(fcurves.Sampled, pattern):
            fcurves.read([curve], [0.0])
        with self.assertRaisesRegex(fcurves.Sampled, pattern):  # from what is known
            fcurves.read([curve], [0.0])

    def test_modifiers(self):
        curve = self.make([(1, 0), (9, 3)])
        plain = fcurves.read([curve], [0.0])
        noise = curve.modifiers.new("NOISE")
        self.refused(curve, "^the F-modifier NOISE$")
        noise.mute = True
        self.assertEqual(fcurves.read([curve], [0.0]), plain)
        curve.modifiers.remove(noise)
        cycles = curve.modifiers.new("CYCLES")
        self.assertEqual(fcurves.read([curve], [0.0]).after, "repeat")
        cycles.use_restricted_range = True
        self.refused(curve, "restricted range")
        cycles.use_restricted_range, cycles.use_influence = False, True
        self.assertEqual(fcurves.read([curve], [0.0]).after, "repeat")
        cycles.influence = 0.5
        self.refused(curve, "influence")
        cycles.use_influence = False
        cycles.mode_after, cycles.cycles_after = "MIRROR", 3
        self.refused(curve, "^counted CYCLES that end elsewhere$")
        cycles.cycles_after = 2
        self.assertEqual(fcurves.read([curve], [0.0]).after, "mirror 2")
        curve.modifiers.new("LIMITS")
        self.refused(curve, "^several F-modifiers$")
        cycles.mute = True
        self.refused(curve, "LIMITS")

    def test_keys(self):
        self.refused(self.make([(1, 0), (9, 3), (9, 5)]), "^several keys on one frame$")
        self.refused(self.make([(1, 3, "ELASTIC", {"amplitude": 5}), (9, 0)]), "^an ELASTIC that falls by less")
        curve = self.make([(1, 3), (9, 0)])
        curve.convert_to_samples(0, 10)
        self.refused(curve, "^an F-curve of samples$")

    def test_table(self):
        for index in range(3):
            self.make([(1, index), (9, 5)], "location", index)
        self.assertEqual(fcurves.table(None), {})
        animation = self.owner.animation_data
        table = fcurves.table(animation)
        self.assertEqual(set(table), {("location", index) for index in range(3)})
        table["location", 1].mute = True
        self.assertEqual(set(fcurves.table(animation)), {("location", 0), ("location", 2)})
        fcurves.new(self.owner, "scale", 0)
        table["location", 0].group = animation.action.groups.new("g")
        self.assertIn(("location", 0), fcurves.table(animation))
        table["location", 0].group.mute = True
        self.assertEqual(set(fcurves.table(animation)), {("location", 2)})
        animation.action = None
        self.assertEqual(fcurves.table(animation), {})

    def test_blockers_and_drivers(self):
        self.assertEqual(fcurves.blockers(self.owner), "")
        self.assertEqual(fcurves.drivers(self.owner), set())
        self.make([(1, 0), (9, 5)], "location", 2)
        animation = self.owner.animation_data
        self.assertEqual(fcurves.blockers(self.owner), "")
        animation.action_influence = 0.5
        self.assertIn("influence of 0.5", fcurves.blockers(self.owner))
        animation.action_influence, animation.action_blend_type = 1, "ADD"
        self.assertIn("ADD", fcurves.blockers(self.owner))
        animation.action_blend_type = "REPLACE"
        track = animation.nla_tracks.new()
        self.assertEqual(fcurves.blockers(self.owner), "")
        track.strips.new("s", 1, animation.action)
        self.assertIn("NLA", fcurves.blockers(self.owner))
        track.mute = True
        self.assertEqual(fcurves.blockers(self.owner), "")
        track.is_solo = True
        self.assertIn("NLA", fcurves.blockers(self.owner))
        animation.use_nla = False
        self.assertEqual(fcurves.blockers(self.owner), "")
        driver = self.owner.driver_add("scale", 1)
        self.assertEqual(fcurves.drivers(self.owner), {("scale", 1)})
        driver.mute = True
        self.assertEqual(fcurves.drivers(self.owner), set())

    def test_state_changes_with_everything(self):
        curve = self.make([(1, 0), (9, 5), (12, 3)])
        cycles, envelope = curve.modifiers.new("CYCLES"), curve.modifiers.new("ENVELOPE")
        limit = envelope.control_points.add(3)
        point = curve.keyframe_points[1]
        point.handle_left_type = point.handle_right_type = "FREE"
        seen = [fcurves.state(curve)]
        for owner, name, value in (
            (point, "co", (8, 5)), (point, "co", (8, 4)), (point, "handle_left", (6, 1)),
            (point, "handle_right", (9, 1)), (point, "interpolation", "ELASTIC"), (point, "easing", "EASE_IN"),
            (point, "back", 0.25), (point, "amplitude", 0.35), (point, "period", 0.5),
            (curve, "extrapolation", "LINEAR"), (cycles, "mode_before", "MIRROR"), (cycles, "cycles_after", 3),
            (cycles, "mute", True), (cycles, "use_influence", True), (cycles, "influence", 0.5),
            (limit, "max", 7), (envelope, "default_min", -3),
        ):  # fmt: skip
            self.assertEqual(fcurves.state(curve), seen[-1])
            setattr(owner, name, value)
            self.assertNotIn(fcurves.state(curve), seen, name)
            hash(fcurves.state(curve))
            seen.append(fcurves.state(curve))
        curve.keyframe_points.add(1)
        self.assertNotIn(fcurves.state(curve), seen)
        samples = self.make([(1, 3), (9, 0)], "location")
        samples.convert_to_samples(0, 10)
        before = fcurves.state(samples)
        samples.sampled_points[3].co[1] += 1
        self.assertNotEqual(fcurves.state(samples), before)


class Samples(Case):
    def test_all_frames_keep_their_values(self):
        chance = random.Random(5)
        for size, kind in ((1, "number"), (3, "vector"), (3, "rotation"), (1, "switch")):
            for is_single in (True, False):
                values = np.array([[chance.choice((1.0, 0.3, 0.3, 1 / 3)) for _ in range(size)] for _ in range(50)])
                values[10:30] = values[10]
                if is_single:
                    values = values.astype(np.float32)
                given = values if size == 3 else values[:, 0]
                curve = fcurves.sampled(range(-3, 47), given, kind=kind)
                frames = np.arange(-3.0, 47)
                if kind == "switch":
                    wanted = (given == 1).astype(float)
                else:
                    digits = np.vectorize(lambda x: float(str(np.float32(x))))(given) if is_single else given
                    wanted = np.degrees(digits) if kind == "rotation" else digits
                self.assertTrue((np.array(curve(frames)) == wanted).all(), kind)
                self.assertLess(len(curve.keys), 35)
                self.assertEqual({key.interpolation for key in curve.keys}, {"step" if kind == "switch" else "linear"})

    def test_what_does_not_move_is_constant(self):
        self.assertEqual(fcurves.sampled(range(5), np.full(5, np.float32(0.7))), 0.7)
        self.assertEqual(fcurves.sampled(range(5), np.ones((5, 3)), kind="vector"), (1, 1, 1))
        self.assertIs(fcurves.sampled(range(5), np.ones(5), kind="switch"), True)
        self.assertEqual(fcurves.sampled([4], np.array([0.1])), 0.1)


class Writing(Case):
    def curves(self, path):
        table = fcurves.table(self.owner.animation_data)
        return [table[key] for key in sorted(table) if key[0] == path]

    def write(self, value, path="location", kind="vector", size=3, **more):
        return fcurves.write(
            self.owner, path, value, size=size, kind=kind, name="p.x", **{"first": 1, "last": 60, **more}
        )

    def test_constants(self):
        self.make([(1, 0), (9, 5)], "location", 2)
        self.assertEqual(self.write((1.0, 2.0, 3.0)), [])
        self.assertEqual(tuple(self.owner.location), (1, 2, 3))
        self.assertIsNone(self.owner.animation_data)
        self.write((0, 90.0, 0), "rotation_euler", "rotation")
        self.assertAlmostEqual(self.owner.rotation_euler[1], np.pi / 2, 6)
        self.write(True, "show_in_front", "switch", 1)
        self.assertTrue(self.owner.show_in_front)
        self.write(0.25, "empty_display_size", "number", 1)
        self.assertEqual(self.owner.empty_display_size, 0.25)
        self.write(pliant.Path([(0, 0, 0), (1, 0, 0), (2, 0, 0)], progress=0.5))
        self.assertAlmostEqual(self.owner.location[0], 1, 6)

    def random_value(self, chance, size):
        def value(low=-10, high=10):
            numbers = [chance.uniform(low, high) for _ in range(size)]
            return numbers[0] if size == 1 else tuple(numbers)

        frame, keys = chance.randint(-5, 20), []
        for _ in range(chance.randint(1, 6)):
            plain = ["bezier"] * 8 + ["step", "stepNext", "cubicBezier", "linear"]
            word = chance.choice(plain + [chance.choice(WORDS)] * 6)
            more = {"interpolation": word}
            if word.startswith("elastic") and chance.random() < 0.5:
                more.update(amplitude=chance.uniform(0, 20), period=chance.uniform(2, 8))
            if word.startswith("back") and chance.random() < 0.5:
                more["back"] = chance.uniform(0, 3)
            if word == "cubicBezier":
                more["control"] = (chance.random(), chance.uniform(-1, 2), chance.random(), chance.uniform(-1, 2))
            for side, sign in (("in", -1), ("out", 1)):
                if chance.random() < 0.3:
                    rise = value(-5, 5)
                    handle = (sign * chance.uniform(0, 10), *(rise if size == 3 else (rise,)))
                    more[f"{side}_handle"] = handle
                else:
                    tangent = chance.choice(TANGENTS)
                    more[f"{side}_tangent"] = tangent if isinstance(tangent, str) or size == 1 else (tangent, 1, -3)
                    if chance.random() < 0.3:
                        more[f"{side}_length"] = chance.uniform(0, 8)
            if chance.random() < 0.03:
                more["left"] = value()
            keys.append(pliant.Key(frame, value(), **more))
            frame += chance.randint(1, 14)
        slope = "slope 0.3" if size == 1 else "slope 0.3 -1 2"
        beside = [slope if each == "slope" else each for each in (chance.choice(BESIDE), chance.choice(BESIDE))]
        loop = pliant.Loop(keys[0].frame, keys[-1].frame, after=1) if len(keys) > 1 and chance.random() < 0.03 else None
        overshoot = chance.choice(("limit", "keepStart", "contain"))
        return pliant.Curve(keys, before=beside[0], after=beside[1], overshoot=overshoot, loop=loop)

    def test_random_curves_have_their_values_on_every_frame_and_between(self):
        chance, exact, sampled = random.Random(6), 0, 0
        frames = np.arange(0.0, 62.0)
        between = np.float32(np.concatenate([frames[:-1] + 0.37, frames[:-1] + 0.71])).astype(float)
        for number in range(500):
            size, kind, path = chance.choice(
                ((1, "number", "empty_display_size"), (3, "vector", "location"), (3, "rotation", "rotation_euler"))
            )
            value = self.random_value(chance, size)
            notes = self.write(value, path, kind, size)
            curves = self.curves(path)
            self.assertEqual(len(curves), size)
            factor = 180 / np.pi if kind == "rotation" else 1
            for index, curve in enumerate(curves):
                wanted = np.array(value(frames)).reshape(len(frames), size)[:, index]
                seen = factor * evaluated(curve, frames)
                slack = 2e-6 * np.ptp(wanted) + 2.0**-22 * np.abs(wanted).max()
                self.assertLessEqual(np.abs(seen - wanted).max(), slack, (number, notes, value.keys))
                if notes:
                    continue
                near = np.array([value(between + shift) for shift in (-4e-6, 0, 4e-6)]).reshape(3, len(between), size)
                near, seen = near[:, :, index], factor * evaluated(curve, between)
                is_near = (near.min(axis=0) - 2 * slack <= seen) & (seen <= near.max(axis=0) + 2 * slack)
                self.assertTrue(is_near.all(), (number, index, between[~is_near], seen[~is_near], value.keys))
            for note in notes:
                self.assertRegex(note, "^p.x: sampled: .")
                self.assertEqual([len(each.keyframe_points) for each in curves], [62] * size)
            exact, sampled = exact + (not notes), sampled + bool(notes)
            self.owner.animation_data_clear()
        self.assertGreater(exact, 250)
        self.assertGreater(sampled, 50)

    def test_what_is_sampled(self):
        keys = [(1, 0), (10, 5), (20, -3)]
        falling = [pliant.Key(1, 5, interpolation="elasticIn", amplitude=9), (9, 1)]
        long = [pliant.Key(1, 0, out_tangent=0.5, out_length=11), pliant.Key(10, 5, in_tangent=0.0, in_length=3)]
        for reason, value in (
            ("a value from the left", pliant.Curve([(1, 0), pliant.Key(10, 5, left=2.0), (20, 1)])),
            ("a value from the left", pliant.Curve([pliant.Key(1, 0, left=2.0), (20, 1)])),
            ("an inner loop", pliant.Curve(keys, loop=pliant.Loop(1, 10, after=2))),
            ("the overlong Bézier segment of key 1", pliant.Curve(long)),
            ("the elastic easing of key 1", pliant.Curve(falling)),
        ):
            self.assertEqual(self.write(value, "empty_display_size", "number", 1), [f"p.x: sampled: {reason}"])
        path = pliant.Path([(0, 0, 0), (2, 0, 1), (3, 1, 0)], progress=pliant.Curve([(1, 0), (20, 1)]))
        self.assertEqual(self.write(path), ["p.x: sampled: a path"])
        for index, curve in enumerate(self.curves("location")):
            wanted = [path.at(path.progress(frame))[index] for frame in range(0, 62)]
            self.assertTrue(np.allclose(evaluated(curve, np.arange(0.0, 62)), wanted, 0, 1e-6))

    def test_what_never_shows_is_not_sampled(self):
        step = [pliant.Key(1, 0, interpolation="step"), pliant.Key(10, 5, left=2.0), (20, 1)]
        same = [(1, 0), pliant.Key(10, 5, left=5.0), (20, 1)]
        self.assertEqual(self.write(pliant.Curve(step), "empty_display_size", "number", 1), [])
        self.assertEqual(self.write(pliant.Curve(same), "empty_display_size", "number", 1), [])

    def test_step_next_and_levels_are_keys(self):
        keys = [pliant.Key(1, 0, interpolation="stepNext"), (10, 5), (20, -3)]
        self.assertEqual(self.write(pliant.Curve(keys), "empty_display_size", "number", 1), [])
        curve = self.curves("empty_display_size")[0]
        self.assertEqual([curve.evaluate(frame) for frame in (0, 1, 1.25, 2, 9, 10)], [0, 0, 5, 5, 5, 5])
        keys = [pliant.Key(1, (0, 2, 5), interpolation="elasticOut", amplitude=9.0), (20, (4, 2, 7))]
        self.assertEqual(self.write(pliant.Curve(keys)), [])
        self.assertEqual(set(evaluated(self.curves("location")[1], BETWEEN)), {2})

    def test_switches(self):
        chance = random.Random(7)
        for number in range(60):
            frame, keys = chance.randint(-3, 9), []
            for _ in range(chance.randint(1, 6)):
                keys.append(pliant.Key(frame, chance.choice((0, 1)), interpolation="step"))
                frame += chance.randint(1, 9)
            loop = pliant.Loop(keys[0].frame, frame, after=2) if chance.random() < 0.2 else None
            value = pliant.Curve(keys, before=chance.choice(("hold", "repeat", "mirror")), after="repeat", loop=loop)
            self.write(value, "show_in_front", "switch", 1)
            for frame in range(0, 62, 7):
                bpy.context.scene.frame_set(frame)
                self.assertEqual(self.owner.show_in_front, bool(value(frame)), (number, frame, keys))

    def test_there_and_back(self):
        chance, counted = random.Random(8), 0
        for number in range(300):
            size, kind, path = chance.choice(
                ((1, "number", "empty_display_size"), (3, "vector", "location"), (3, "rotation", "rotation_euler"))
            )
            model = self.random_keys(chance, self.random_frames(chance))
            rows = [[(key[0], chance.uniform(-9, 9), *key[2:]) for key in model] for _ in range(size)]
            extrapolation, cycles = chance.choice(("CONSTANT", "LINEAR")), self.random_cycles(chance, True)
            more = {"extrapolation": extrapolation, "cycles": cycles}
            curves = [self.make(row, path, index, **more) for index, row in enumerate(rows)]
            try:
                value = fcurves.read(curves, [0] * size, kind=kind)
            except fcurves.Sampled:
                continue
            old = [self.look(each, kind) for each in curves]
            before = [evaluated(each, FRAMES) for each in curves]
            notes = self.write(value, path, kind, size, first=-39, last=119)
            if notes:  # too steep for Blender's own precision
                self.assertRegex(notes[0], "sampled: Blender's single precision")
                continue
            counted += 1
            curves = self.curves(path)
            for index, curve in enumerate(curves):
                self.assertEqual(self.look(curve, kind), old[index], (number, index, value.before, value.after))
                self.assertEqual({point.handle_left_type for point in curve.keyframe_points}, {"FREE"})
                # Over a long line the last digit of the old handle's tip counts.
                share = 2e-5 if extrapolation == "LINEAR" else 4e-6
                slack = share * np.ptp(before[index]) + 2.0**-22 * np.abs(before[index]).max()
                self.assertLessEqual(np.abs(evaluated(curve, FRAMES) - before[index]).max(), slack, number)
            again = fcurves.read(curves, [0] * size, kind=kind)
            self.assertEqual([key.value for key in again.keys], [key.value for key in value.keys])
        self.assertGreater(counted, 200)

    def look(self, curve, kind):
        rows = []
        for point in curve.keyframe_points:
            word, side = point.interpolation, point.easing
            row = [tuple(point.co), word]
            if word in EASES:
                is_springy = word in ("BACK", "BOUNCE", "ELASTIC")
                row.append(side if side != "AUTO" else "EASE_OUT" if is_springy else "EASE_IN")
            if word == "BACK":
                row.append(point.back)
            if word == "ELASTIC":
                row += [point.amplitude, point.period]
            rows.append(row)
        return rows

    def test_old_curves_give_way(self):
        curve = self.make([(1, 0), (9, 5)], "location", 1, cycles=("REPEAT", 0, "REPEAT", 0))
        curve.modifiers.new("NOISE")
        self.write(pliant.Curve([(1, (0, 0, 0)), (5, (1, 2, 3))]))
        self.assertEqual([len(each.keyframe_points) for each in self.curves("location")], [2] * 3)
        self.assertEqual([len(each.modifiers) for each in self.curves("location")], [0] * 3)
        self.write(pliant.Curve([pliant.Key(1, (0, 0, 0), left=(1, 1, 1)), (5, (1, 2, 3))]))
        self.assertEqual([len(each.keyframe_points) for each in self.curves("location")], [62] * 3)
        self.write((0, 0, 0))
        self.assertIsNone(self.owner.animation_data)

    def test_remove(self):
        self.make([(1, 0)], "location", 1)
        self.make([(1, 0)], "scale", 1)
        actions = len(bpy.data.actions)
        fcurves.remove(self.owner, "location")
        self.assertEqual(set(fcurves.table(self.owner.animation_data)), {("scale", 1)})
        action = self.owner.animation_data.action
        action.use_fake_user = True
        fcurves.remove(self.owner, "scale")
        self.assertEqual(self.owner.animation_data.action, action)
        action.use_fake_user = False
        fcurves.remove(self.owner, "scale")  # nothing is there, so the empty action is the artist's
        self.assertEqual(self.owner.animation_data.action, action)
        self.make([(1, 0)], "scale", 1)
        self.owner.driver_add("scale", 2)
        fcurves.remove(self.owner, "scale")
        self.assertEqual(len(bpy.data.actions), actions - 1)
        self.assertEqual(len(self.owner.animation_data.drivers), 1)


if __name__ == "__main__":
    sys.exit(not unittest.main(argv=["fcurves_test"], exit=False).result.wasSuccessful())
