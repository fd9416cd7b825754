"""Runs inside Blender: F-curves of a file, evaluated by Blender; and random F-curves, evaluated and written.

usage: blender -b --factory-startup -noaudio -P blender_keys.py -- SCRIPT IN.json SEEN.json OUT.json MADE.json

SCRIPT is script/blender_curves.py. SEEN.json gets, for each curve of IN.json in its order, [frame, value] at
many frames. OUT.json gets random F-curves by the script's export, and MADE.json what they are at many frames.
"""

import importlib.util
import json
import random
import sys

import bpy

EASES = ("SINE", "QUAD", "CUBIC", "QUART", "QUINT", "EXPO", "CIRC", "BACK", "BOUNCE", "ELASTIC")
SIDES = ("AUTO", "EASE_IN", "EASE_OUT", "EASE_IN_OUT")
CYCLES = ("NONE", "REPEAT", "REPEAT_OFFSET", "MIRROR")
HANDLES = ("FREE", "ALIGNED", "VECTOR", "AUTO", "AUTO_CLAMPED")


def frames_of(fcurve):
    points = fcurve.keyframe_points
    first, last = points[0].co[0], points[-1].co[0]
    span = max(last - first, 1)
    frames = [first - 1.7 * span + 4.4 * span * k / 240 for k in range(241)]
    # Beside the keys: Blender takes a frame within 0.0001 of a key for the key.
    frames += [point.co[0] + shift for point in points for shift in (-0.4, -0.01, 0, 0.01, 0.4)]
    return frames


def seen_in(fcurve):
    return [[frame, fcurve.evaluate(frame)] for frame in frames_of(fcurve)]


def make_random(target, number, chance):
    """A custom property with an F-curve."""
    name = f"p{number}"
    target[name] = 0.0
    action = target.animation_data.action
    fcurve = action.fcurves.new(f'["{name}"]')
    frame = chance.uniform(-10, 10)
    count = chance.randint(1, 6)
    fcurve.keyframe_points.add(count)
    for point in fcurve.keyframe_points:
        point.co = frame, chance.uniform(-10, 10)
        kind = chance.choice(("BEZIER", "BEZIER", "LINEAR", "CONSTANT", "EASE"))
        point.interpolation = chance.choice(EASES) if kind == "EASE" else kind
        point.easing = chance.choice(SIDES)
        point.back = chance.uniform(0, 3)
        point.amplitude, point.period = chance.choice((0, chance.uniform(0, 20))), chance.choice((0, 4.1))
        point.handle_left_type, point.handle_right_type = chance.choice(HANDLES), chance.choice(HANDLES)
        point.handle_left = point.co[0] - chance.uniform(0, 15), point.co[1] + chance.uniform(-8, 8)
        point.handle_right = point.co[0] + chance.uniform(0, 15), point.co[1] + chance.uniform(-8, 8)
        frame += chance.uniform(1, 14)
    fcurve.extrapolation = chance.choice(("CONSTANT", "CONSTANT", "LINEAR"))
    if chance.random() < 0.5 and count > 1:
        cycles = fcurve.modifiers.new("CYCLES")
        cycles.mode_before, cycles.mode_after = chance.choice(CYCLES), chance.choice(CYCLES)
        if fcurve.extrapolation == "CONSTANT":
            cycles.cycles_before, cycles.cycles_after = chance.choice((0, 0, 2, 3)), chance.choice((0, 0, 2, 3))
    fcurve.update()
    return fcurve


def main():
    script, given, seen, out, made = sys.argv[sys.argv.index("--") + 1:]
    spec = importlib.util.spec_from_file_location("blender_curves", script)
    curves = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(curves)

    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    count = curves.import_curves(given, cube)
    with open(given, encoding="utf-8") as file:
        document = json.load(file)
    assert count == len(document["curves"])
    found = {(fcurve.data_path, fcurve.array_index): fcurve for fcurve in cube.animation_data.action.fcurves}
    results = []
    for curve in document["curves"]:
        path = f'["{curve["owner"]}.{curve["data_path"]}"]'
        results.append(seen_in(found[path, curve["index"] or 0]))
    with open(seen, "w", encoding="utf-8") as file:
        json.dump(results, file)

    bpy.ops.mesh.primitive_cube_add()
    ball = bpy.context.object
    ball.name = "Ball"
    ball.animation_data_create().action = bpy.data.actions.new("Random")
    chance = random.Random(11)
    results = [seen_in(make_random(ball, number, chance)) for number in range(200)]
    curves.export_curves(out, ["Ball"])
    with open(made, "w", encoding="utf-8") as file:
        json.dump(results, file)


main()
