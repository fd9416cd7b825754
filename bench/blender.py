"""What the Blender add-on costs beside the solver, as medians in milliseconds.

usage: BLENDER_USER_SCRIPTS=FOLDER blender -b --factory-startup -P bench/blender.py

In FOLDER/addons is the unpacked build/release/pliant_blender.zip. A live frame is a surface of 10⁴ vertices under
a force: `Scene.frame_set` with the handlers of the add-on, less the same without them and less the solve. An
unchanged scene has 20 forces more, of 20 keys each.
"""

import os
import statistics
import sys
import time

import addon_utils
import bpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "blender"))
addon_utils.enable("pliant_blender")

from built import force, key, sheet, update  # noqa: E402
from pliant_blender import live, translate  # noqa: E402

FRAMES = range(2, 102)


def frames():
    """The times of frames that are solved, each visited once."""
    scene, found = bpy.context.scene, []
    for frame in FRAMES:
        begin = time.perf_counter()
        scene.frame_set(frame)
        found.append(time.perf_counter() - begin)
    return found


def median(call, count=200):
    found = []
    for _ in range(count):
        begin = time.perf_counter()
        call()
        found.append(time.perf_counter() - begin)
    return 1000 * statistics.median(found)


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable("pliant_blender")
    scene = bpy.context.scene
    scene.pliant.frame_end = FRAMES[-1]
    sheet(columns=100, rows=100)
    force()
    update()
    session = live.session_of(scene)
    solving = []
    solve = session.solve

    def timed(number):
        begin = time.perf_counter()
        session.simulation.at(number)  # what is left for the add-on is to read it again
        solving.append(time.perf_counter() - begin)
        return solve(number)

    session.solve = timed
    whole = frames()
    names = ("frame_change_pre", "frame_change_post")
    kept = {name: list(getattr(bpy.app.handlers, name)) for name in names}
    for name in names:
        getattr(bpy.app.handlers, name).clear()
    bare = frames()
    for name, handlers in kept.items():
        getattr(bpy.app.handlers, name).extend(handlers)
    more = [a - b - c for a, b, c in zip(whole, bare, solving)]
    print(f"a live frame beside its solve  {1000 * statistics.median(more):6.3f} ms, of a solve of "
          f"{1000 * statistics.median(solving):.3f} ms")  # fmt: skip
    for number in range(20):
        key(force(f"F{number}", location=(0.05 * number - 0.5, 0, 0), magnitude=5), "pliant.magnitude",
            *((3 * each + 1, float(each * 7 % 5)) for each in range(20)))  # fmt: skip
    update()
    print(f"an unchanged scene             {median(lambda: translate.look_all(scene)):6.3f} ms")


main()
