"""What a user sees and drags: real events of pointer and keys, in a window.

The tests run in a thread beside Blender's, which goes on; all that asks Blender is done in its thread, by `do`.
"""

import contextlib
import os
import queue
import subprocess
import threading
import time
import unittest

import addon_utils
import bpy
import numpy as np
from bpy_extras import view3d_utils
from built import force, key, sheet, shown, solved
from mathutils import Euler

from pliant_blender import live, meshes, perform, properties, view
from pliant_blender.preferences import preferences

PICTURES = os.environ.get("PLIANT_PICTURES", "")
_work = queue.Queue()


def _serve():
    while not _work.empty():
        call, answer = _work.get()
        try:
            answer.put((True, call()))
        except BaseException as error:
            answer.put((False, error))
    return 0.01


if not bpy.app.background:
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.system.viewport_aa = "OFF"  # pixels are drawn by the processor here
    bpy.app.timers.register(_serve, persistent=True)


def do(call):
    """What a function gives in Blender's thread."""
    if threading.current_thread() is threading.main_thread():
        return call()
    answer = queue.Queue()
    _work.put((call, answer))
    is_well, found = answer.get(timeout=60)
    if not is_well:
        raise found
    return found


def until(call, what, seconds=60):
    """Waits for something to become true."""
    end = time.monotonic() + seconds
    while not do(call):
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not after {seconds} s")
        time.sleep(0.02)


def x(*words):
    """Real events."""
    subprocess.run(["xdotool", *map(str, words)], check=True)
    time.sleep(0.05)


def settle():
    """Waits until Blender has taken all events and drawn."""
    for _ in range(6):
        do(lambda: None)
        time.sleep(0.04)


def move(place):
    x("mousemove", *(round(each) for each in place))


def drag(*places, steps=3):
    """With the left button down, through places of the screen."""
    move(np.subtract(places[0], 3))
    move(places[0])
    settle()
    x("mousedown", 1)
    for start, end in zip(places, places[1:]):
        for share in np.linspace(0, 1, steps + 1)[1:]:
            move(np.add(start, share * np.subtract(end, start)))
    settle()
    x("mouseup", 1)
    settle()


def window():
    return bpy.context.window_manager.windows[0]


def area(kind="VIEW_3D"):
    return next(each for each in window().screen.areas if each.type == kind)


def region(kind="VIEW_3D"):
    return next(each for each in area(kind).regions if each.type == "WINDOW")


@contextlib.contextmanager
def here():
    """The context of the view, for operators.

    Blender 3.4 reads the dictionary of an override without Python's lock while an operator runs, so no other thread
    may run Python then.
    """
    while any(each.worker and each.worker.is_busy for each in live._sessions.values()):
        time.sleep(0.01)
    time.sleep(0.02)
    with bpy.context.temp_override(window=window(), area=area(), region=region()):
        yield


def on_screen(at, of):
    """A place in a region, in pixels of the screen."""
    return of.x + at[0], window().height - 1 - (of.y + at[1])


def seen(point):
    """Where a point of the world is on the screen."""
    of = region()
    return on_screen(view3d_utils.location_3d_to_region_2d(of, area().spaces[0].region_3d, point), of)


def camera():
    return view.Camera(region(), area().spaces[0].region_3d)


def picture(name):
    """What the window shows: (height, width, 3), from above; kept as a file if someone wants pictures."""
    path = os.path.join(PICTURES or bpy.app.tempdir, f"{name}.png")

    def read():
        with here():
            bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
            bpy.ops.screen.screenshot(filepath=path)
        image = bpy.data.images.load(path)
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        found = pixels.reshape(image.size[1], image.size[0], -1)[::-1, :, :3]
        bpy.data.images.remove(image)
        return found

    return do(read)


class Case(unittest.TestCase):
    def setUp(self):
        do(self.build)
        settle()

    def build(self):
        bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.actions])
        space = area().spaces[0]
        space.show_gizmo = space.overlay.show_floor = space.overlay.show_axis_y = space.overlay.show_overlays = True
        scene = self.scene
        scene.frame_set(1)
        scene.pliant.frame_start, scene.pliant.frame_end = 1, 40
        scene.frame_start, scene.frame_end = 1, 40
        scene.tool_settings.use_keyframe_insert_auto = False
        view_3d = area().spaces[0].region_3d
        view_3d.view_perspective = "PERSP"
        view_3d.view_location, view_3d.view_distance = (0, 0, 0), 6
        view_3d.view_rotation = Euler((1.0, 0, 0.5)).to_quaternion()
        self.fill()
        with here():
            bpy.ops.ed.undo_push(message="Built")

    def fill(self):
        sheet()
        made = force(magnitude=1000, location=(0, 0, 0), deformation_radius=0.9)
        made.empty_display_type = "SINGLE_ARROW"
        self.choose(made)

    @staticmethod
    def choose(owner):
        layer = bpy.context.view_layer
        layer.update()
        for each in layer.objects:
            each.select_set(each == owner)
        layer.objects.active = owner
        layer.update()

    @property
    def scene(self):
        return bpy.data.scenes[0]

    @property
    def poke(self):
        return bpy.data.objects["Poke"]

    def own(self, name):
        return do(lambda: getattr(self.poke.pliant, name))

    def rim(self, name, share=1.0):
        """A place on the circle of a radius, to the right."""
        return do(lambda: seen(self.poke.location + camera().right * getattr(self.poke.pliant, name) * share))

    def tip(self):
        return do(lambda: seen(view._tip(view.placed(self.poke, bpy.context.view_layer.depsgraph), camera())))

    def check_shown(self):
        """That the surface is what a simulation says, once that is there."""
        session = live.session_of(self.scene)
        until(lambda: session.worker is None or not session.worker.is_busy, "solving")
        settle()

        def compare():
            owner = bpy.data.objects["Sheet"]
            np.testing.assert_array_equal(shown(owner), solved(owner, self.scene.frame_current, self.scene))

        do(compare)


class Gizmo(Case):
    def test_a_radius_is_dragged_and_undo_takes_it_back(self):
        for name in ("deformation_radius", "force_radius"):
            with self.subTest(name):
                before = self.own(name)
                drag(self.rim(name), self.rim(name, 1.3))
                self.assertAlmostEqual(self.own(name), 1.3 * before, delta=0.04 * before)
                self.check_shown()
                after = self.own(name)
                x("key", "ctrl+z")
                until(lambda: getattr(self.poke.pliant, name) == before, "undo")
                self.check_shown()
                x("key", "ctrl+shift+z")
                until(lambda: getattr(self.poke.pliant, name) == after, "redo")
                self.check_shown()

    def test_the_magnitude_is_dragged_by_the_tip_of_the_arrow(self):
        before = self.own("magnitude")
        x1, y1 = self.tip()
        drag((x1, y1), (x1, y1 - 40))
        self.assertGreater(self.own("magnitude"), 1.5 * before)
        self.check_shown()
        x("key", "ctrl+z")
        until(lambda: self.poke.pliant.magnitude == before, "undo")

    def test_from_above_where_the_arrow_points_at_us(self):
        def look():
            view_3d = area().spaces[0].region_3d
            view_3d.view_perspective, view_3d.view_rotation = "ORTHO", (1, 0, 0, 0)

        do(look)
        settle()
        before, strength = self.own("force_radius"), self.own("magnitude")
        drag(self.rim("force_radius"), self.rim("force_radius", 2))
        self.assertAlmostEqual(self.own("force_radius"), 2 * before, delta=0.05 * before)
        x1, y1 = self.tip()
        drag((x1, y1), (x1, y1 + 40))
        self.assertLess(self.own("magnitude"), 0.8 * strength)
        self.check_shown()

    def test_a_drag_that_is_cancelled_leaves_nothing(self):
        before = self.own("deformation_radius")
        move(self.rim("deformation_radius"))
        settle()
        x("mousedown", 1)
        move(self.rim("deformation_radius", 1.4))
        settle()
        self.assertGreater(self.own("deformation_radius"), 1.2 * before)
        x("key", "Escape")
        settle()
        x("mouseup", 1)
        settle()
        self.assertEqual(self.own("deformation_radius"), before)

    def test_with_auto_keying_a_drag_makes_a_key(self):
        do(lambda: setattr(self.scene.tool_settings, "use_keyframe_insert_auto", True))
        drag(self.rim("deformation_radius"), self.rim("deformation_radius", 1.3))
        keys = do(lambda: [(each.data_path, [point.co[:] for point in each.keyframe_points])
                           for each in self.poke.animation_data.action.fcurves])  # fmt: skip
        self.assertEqual(keys, [("pliant.deformation_radius", [(1, self.own("deformation_radius"))])])



class Performing(Case):
    """Drags while it plays."""

    def begin(self, **more):
        move(do(lambda: seen((0, 0, 0))))
        settle()

        def call():
            with here():
                return bpy.ops.pliant.perform("INVOKE_DEFAULT", **more)

        self.assertEqual(do(call), {"RUNNING_MODAL"})

    def grab(self):
        """Moves the force about for some frames with G, and confirms."""
        start = do(lambda: self.scene.frame_current)
        place = do(lambda: seen((0, 0, 0)))
        x("key", "g")
        for number in range(200):
            if do(lambda: self.scene.frame_current) >= start + 6:
                break
            move((place[0] + 60 * np.sin(number / 3), place[1] + 3 * number % 50))
        x("click", 1)

    def curves(self):
        def read():
            animation = self.poke.animation_data
            found = animation.action.fcurves if animation and animation.action else ()
            return {(each.data_path, each.array_index): [point.co[:] for point in each.keyframe_points] for each in found}

        return do(read)

    def is_over(self):
        return not perform.is_running()

    def test_what_is_dragged_becomes_keys_in_one_step_of_undo(self):
        do(lambda: self.scene.frame_set(3))
        self.begin()
        self.grab()
        x("key", "Return")
        until(self.is_over, "performing")
        curves = self.curves()
        last = do(lambda: self.scene.frame_current)
        self.assertIn(("location", 0), curves)
        self.assertTrue(all(path == "location" for path, _ in curves), curves)
        keys = curves["location", 0]
        self.assertEqual((keys[0][0], keys[-1][0]), (3, last))
        self.assertEqual(keys[0][1], 0)
        self.assertGreater(np.ptp([value for _, value in keys]), 0.1)
        self.assertEqual(do(lambda: len(bpy.data.actions)), 1)
        self.check_shown()
        x("key", "ctrl+z")
        until(lambda: self.poke.animation_data is None, "undo")
        self.assertEqual(do(lambda: self.poke.location[:]), (0, 0, 0))
        self.check_shown()

    def test_escape_leaves_nothing(self):
        do(lambda: key(self.poke, "location", (1, 0), (30, 0.5), index=1))
        before = self.curves()
        self.begin()
        self.grab()
        self.assertNotEqual(self.curves(), before)
        x("key", "Escape")
        until(self.is_over, "performing")
        self.assertEqual(self.curves(), before)
        self.assertEqual(do(lambda: (self.poke.location[:], self.scene.frame_current)), ((0, 0, 0), 1))
        self.assertEqual(do(lambda: len(bpy.data.actions)), 1)
        self.assertTrue(do(lambda: bpy.context.preferences.edit.use_global_undo))
        self.check_shown()

    def test_a_gizmo_performs_to_the_end_and_keys_outside_stay(self):
        def prepare():
            self.scene.pliant.frame_end = 20
            key(self.poke, "pliant.deformation_radius", (1, 0.9), (20, 0.9), (30, 0.5))
            self.scene.frame_set(6)

        do(prepare)
        self.begin(speed="QUARTER")  # time enough to press, on a slow machine too
        place = self.rim("deformation_radius")
        move(place)
        settle()
        x("mousedown", 1)
        number = 0
        while not do(lambda: self.scene.frame_current == 20 and perform._running.has_ended):
            number += 1
            move((place[0] + 5 * (number % 6), place[1]))
        x("mouseup", 1)
        move((place[0] + 40, place[1]))
        until(self.is_over, "performing")
        keys = self.curves()["pliant.deformation_radius", 0]
        frames = [frame for frame, _ in keys]
        self.assertEqual([frames[0], frames[-1]], [1, 30])
        self.assertTrue({6, 20} <= set(frames), frames)
        self.assertGreater(np.ptp([value for frame, value in keys if 6 <= frame <= 20]), 0.02)
        self.check_shown()

    def test_opening_a_file_ends_it(self):
        path = os.path.join(bpy.app.tempdir, "performed.blend")
        do(lambda: bpy.ops.wm.save_as_mainfile(filepath=path))
        self.begin()
        self.grab()

        def load():
            with here():
                bpy.ops.wm.open_mainfile(filepath=path)

        do(load)
        settle()
        self.assertTrue(do(self.is_over))
        self.assertEqual(self.curves(), {})
        self.assertTrue(do(lambda: bpy.context.preferences.edit.use_global_undo))
        self.check_shown()


class Frames(Case):
    def timeline(self, frame):
        def find():
            of = region("DOPESHEET_EDITOR")
            return on_screen((of.view2d.view_to_region(frame, 0, clip=False)[0], of.height - 8), of)

        return do(find)

    def test_scrubbing_shows_frames(self):
        drag(*(self.timeline(frame) for frame in (2, 25, 9)), steps=5)
        self.assertEqual(do(lambda: self.scene.frame_current), 9)
        self.check_shown()
        drag(self.timeline(9), self.timeline(31))
        self.assertEqual(do(lambda: self.scene.frame_current), 31)
        self.check_shown()

    def test_playing_goes_on(self):
        move(do(lambda: seen((0, 0, 0))))
        x("key", "space")
        until(lambda: self.scene.frame_current > 12, "playing")
        x("key", "space")
        until(lambda: not window().screen.is_animation_playing, "stopping")
        self.check_shown()


class Heavy(Case):
    """What takes longer to solve than a user would wait."""

    def fill(self):
        owner = sheet(columns=181, rows=181)
        self.choose(force(magnitude=1000, location=(0, 0, 0), deformation_radius=0.9))
        self.scene.pliant.frame_end = 60
        owner.pliant.solve = False

    def test_the_nearest_frame_is_shown_until_the_right_one_is_there(self):
        def jump():
            chosen = preferences()
            before, chosen.patience = chosen.patience, 0.01
            owner = bpy.data.objects["Sheet"]
            owner.pliant.solve = True
            self.scene.frame_set(60)
            ready = live.session_of(self.scene).ready.copy()
            chosen.patience = before
            return self.scene.pliant.status, ready, shown(owner)

        status, ready, mesh = do(jump)
        self.assertRegex(status, r"^\d+ of 60 frames$")
        self.assertNotIn(60, ready)
        until(lambda: self.scene.pliant.status == "60 of 60 frames", "solving")
        settle()

        def compare():
            owner = bpy.data.objects["Sheet"]
            np.testing.assert_array_equal(shown(owner), solved(owner, 60, self.scene))
            # A frame may have come between what was shown and our look at what is there.
            frames = [self.scene.pliant.frame_start - 1, *sorted(ready)]
            known = [live.frame(self.scene, each)["Sheet"] for each in frames[1:]]
            there = [meshes.positions(owner.data), *(each.positions(space="object").astype(np.float32) for each in known)]
            self.assertTrue(any(np.array_equal(mesh, each) for each in there), f"none of {frames} is shown")

        do(compare)


class Overlay(Case):
    """What is drawn, by the colours of pixels."""

    def colored(self, name):
        """How many pixels of a picture have the colours of circles and regions: more blue, orange, green than all else."""
        pixels = picture(name)

        def crop():
            of = region()
            (left, bottom), (right, top) = on_screen((60, 40), of), on_screen((of.width - 100, of.height - 120), of)
            return pixels[int(top) : int(bottom), int(left) : int(right)]

        red, green, blue = np.moveaxis(do(crop), -1, 0)
        return {
            "deformation": int(((blue > red + 0.3) & (blue > 0.7)).sum()),
            "force": int(((red > blue + 0.35) & (red > 0.7) & (green > 0.3)).sum()),
            "region": int(((green > red + 0.25) & (green > blue + 0.2) & (green > 0.7)).sum()),
        }

    def fill(self):
        super().fill()
        self.poke.empty_display_size = 0.01
        area().spaces[0].overlay.show_floor = area().spaces[0].overlay.show_axis_y = False
        area().spaces[0].show_gizmo = False

    def set(self, **values):
        def change():
            for name, value in values.items():
                setattr(self.scene.pliant, name, value)

        do(change)
        settle()

    def tearDown(self):
        self.set(show_overlay=True, show_region=True)

    def test_switches_and_selection(self):
        self.check_shown()
        both = self.colored("overlay")
        self.assertTrue(all(count > 100 for count in both.values()), both)
        self.set(show_region=False)
        forces = self.colored("forces")
        self.assertLess(forces["region"], 40)
        self.assertGreater(forces["deformation"], 100)
        do(lambda: self.choose(None))
        dim = self.colored("dim")
        self.assertLess(dim["deformation"], forces["deformation"] / 4)
        self.set(show_overlay=False, show_region=True)
        region_only = self.colored("region")
        self.assertGreater(region_only["region"], 100)
        self.set(show_region=False)
        nothing = self.colored("nothing")
        self.assertLess(max(nothing.values()), 40)  # the cursor has some

    def test_nothing_is_drawn_in_a_render(self):
        def render(name):
            scene = self.scene
            scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
            scene.camera.location = (0, 0, 5)
            scene.collection.objects.link(scene.camera)
            scene.render.engine = "BLENDER_WORKBENCH"
            scene.render.resolution_x = scene.render.resolution_y = 64
            scene.render.filepath = os.path.join(bpy.app.tempdir, name)
            with here():
                bpy.ops.render.render(write_still=True)
            image = bpy.data.images.load(scene.render.filepath)
            pixels = np.array(image.pixels)
            bpy.data.images.remove(image)
            return pixels

        self.check_shown()
        drawn = do(lambda: render("drawn.png"))
        self.set(show_overlay=False, show_region=False)
        np.testing.assert_array_equal(drawn, do(lambda: render("bare.png")))
        self.assertGreater(np.ptp(drawn), 0)

    def test_all_kinds_and_groups_are_drawn(self):
        def more():
            places = {"RADIAL": (-2, 0, 0), "LINE": (2, 0, 0), "UNIFORM": (0, 2, 0), "VORTEX": (-2, 2, 0),
                      "NOISE": (2, 2, 0), "INERTIA": (0, -2, 0), "PRESSURE": (-2, -2, 0)}  # fmt: skip
            for kind, place in places.items():
                made = force(kind.title(), kind, place, magnitude=200)
                made.select_set(True)
            line = bpy.data.objects["Line"]
            end = bpy.data.objects.new("End", None)
            end.location = (3, 0.5, 0)
            self.scene.collection.objects.link(end)
            line.pliant.end = end
            group = bpy.data.objects.new("Group", None)
            group.location = (2, -2, 0)
            self.scene.collection.objects.link(group)
            group.pliant.role = "GROUP"
            bpy.context.view_layer.update()
            for each in self.scene.objects:
                each.select_set(each.type == "EMPTY")
            area().spaces[0].region_3d.view_distance = 10
            graph = bpy.context.view_layer.depsgraph
            return {each.name: [len(lines) for _, lines in view._force_lines(view.placed(each, graph), camera())]
                    for each in self.scene.objects if properties.role(each) in ("FORCE", "GROUP")}  # fmt: skip

        counts = do(more)
        circle, arrow, both = 64, 3, 6
        self.assertEqual(
            counts,
            {"Poke": [circle, circle, arrow], "Radial": [circle, circle, both], "Line": [66, 66, both],
             "Uniform": [arrow], "Vortex": [circle, circle, arrow], "Noise": [circle, circle, both],
             "Inertia": [both], "Pressure": [circle, circle, both], "Group": [circle]},
        )  # fmt: skip
        self.assertGreater(self.colored("kinds")["deformation"], 400)

    def test_the_region_on_triangles_lies_around_the_force(self):
        def build():
            bpy.data.batch_remove([bpy.data.objects["Sheet"]])
            with here():
                bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
            ball = bpy.context.view_layer.objects.active
            ball.name, ball.pliant.role, ball.pliant.uv = "Sheet", "SURFACE", "SURFACE"
            self.poke.location, self.poke.pliant.magnitude = (0, 0, 1), 0
            self.choose(self.poke)

        do(build)
        self.check_shown()

        def lines():
            graph = bpy.context.view_layer.depsgraph
            return list(view._region_lines(self.scene, graph, lambda owner: True))

        (found,) = do(lines)
        away = np.linalg.norm(found - np.array([0, 0, 1]), axis=-1)
        np.testing.assert_allclose(away, self.own("deformation_radius"), atol=0.01)
        self.assertGreater(len(found), 40)
        self.assertGreater(self.colored("ball")["region"], 60)

    def test_a_disabled_add_on_draws_nothing(self):
        self.check_shown()
        before = self.colored("enabled")
        do(lambda: addon_utils.disable("pliant_blender"))
        settle()
        self.assertLess(max(self.colored("disabled").values()), 40)
        do(lambda: addon_utils.enable("pliant_blender"))
        settle()
        self.check_shown()
        after = self.colored("enabled again")
        for name, count in before.items():
            self.assertAlmostEqual(after[name], count, delta=count / 5, msg=name)
