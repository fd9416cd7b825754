"""Keys of Blender as JSON for `pliant import curves`, and those of `pliant export curves` back.

usage: blender SCENE.blend --background --python blender_curves.py -- export OUT.json [NAME…]
       blender SCENE.blend --background --python blender_curves.py -- import IN.json [--to NAME] [--save]

`export` writes the F-curves of the data-blocks with these names, or of all that are animated. `import` puts
curves where their owner and data path say; what Blender does not have becomes a custom property of the
object --to, or of the active one: `["poke.magnitude"]`, ready to drive anything. --save saves the .blend.

In the Scripting workspace: load this file, run it, and call export_curves("/tmp/curves.json") or
import_curves("/tmp/curves.json"). For Blender 3.4 and later. docs/interchange.md, "Keys", describes the JSON.
"""

import json
import struct
import sys

import bpy

CYCLES = ("NONE", "REPEAT", "REPEAT_OFFSET", "MIRROR")
COLLECTIONS = ("objects", "shape_keys", "materials", "cameras", "lights", "armatures", "meshes", "curves",
               "node_groups", "scenes", "worlds")


def shortest(number):
    """The number with the fewest digits that is this one in single precision, as Blender keeps it."""
    for digits in range(6, 9):
        text = f"{number:.{digits}g}"
        if struct.pack("f", float(text)) == struct.pack("f", number):
            return float(text)
    return float(f"{number:.9g}")


def animated():
    """The data-blocks that have an action, each once."""
    for collection in COLLECTIONS:
        for block in getattr(bpy.data, collection):
            if block.animation_data and block.animation_data.action:
                yield block


def collections_of(animation):
    """Where the F-curves of an action are, in the slot that the data-block uses where actions have slots."""
    action, slot = animation.action, getattr(animation, "action_slot", None)
    if slot is None:
        return [action.fcurves]
    bags = [strip.channelbag(slot) for layer in action.layers for strip in layer.strips]
    return [bag.fcurves for bag in bags if bag]


def fcurves_of(animation):
    return [fcurve for collection in collections_of(animation) for fcurve in collection]


def property_of(block, path):
    """What Blender knows of a property; None: nothing, as of custom ones."""
    parent, _, name = path.rpartition(".")
    try:
        owner = block.path_resolve(parent) if parent else block
        return owner.bl_rna.properties[name]
    except (ValueError, KeyError, AttributeError):
        return None


def is_vector(block, path):
    try:
        value = block.path_resolve(path)
    except ValueError:
        return True
    return hasattr(value, "__len__") and not isinstance(value, str)


def key_of(point):
    key = {"co": [shortest(x) for x in point.co], "left": [shortest(x) for x in point.handle_left],
           "right": [shortest(x) for x in point.handle_right], "left_type": point.handle_left_type,
           "right_type": point.handle_right_type, "interpolation": point.interpolation, "easing": point.easing}
    if point.interpolation == "BACK":
        key["back"] = shortest(point.back)
    if point.interpolation == "ELASTIC":
        key.update(amplitude=shortest(point.amplitude), period=shortest(point.period))
    return key


def curve_of(block, fcurve):
    known = property_of(block, fcurve.data_path)
    unit = known.unit if known else "NONE"
    curve = {"owner": block.name, "data_path": fcurve.data_path,
             "index": fcurve.array_index if is_vector(block, fcurve.data_path) else None,
             "unit": unit if unit in ("LENGTH", "ROTATION") else "NONE", "extrapolation": fcurve.extrapolation}
    if known and known.type in ("BOOLEAN", "ENUM"):
        curve["discrete"] = True
    curve.update(shape_of(fcurve))
    return curve


def shape_of(fcurve):
    """All that the curve is but its name and unit."""
    shape, others = {"extrapolation": fcurve.extrapolation}, []
    for number, modifier in enumerate(fcurve.modifiers):
        if modifier.mute:
            continue
        if modifier.type == "CYCLES" and number == 0:
            shape["cycles"] = {"before": modifier.mode_before, "before_count": modifier.cycles_before,
                               "after": modifier.mode_after, "after_count": modifier.cycles_after}
        else:
            others.append(modifier.type)
    if others:
        shape["modifiers"] = others
    shape["keys"] = [key_of(point) for point in fcurve.keyframe_points]
    return shape


def export_curves(path, names=()):
    """Writes the F-curves of these data-blocks, or of all. Returns how many."""
    render = bpy.context.scene.render
    blocks = [block for block in animated() if not names or block.name in names]
    curves = [curve_of(block, fcurve) for block in blocks for fcurve in fcurves_of(block.animation_data)]
    document = {"format": "blender-curves", "version": 1, "blender": bpy.app.version_string,
                "fps": render.fps / render.fps_base, "curves": curves}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document, file, indent=1)
    return len(curves)


def new_fcurve(block, path, index):
    """An empty F-curve in place of one that may be there."""
    animation = block.animation_data or block.animation_data_create()
    if not animation.action:
        animation.action = bpy.data.actions.new(block.name + "Action")
    action = animation.action
    if hasattr(action, "fcurve_ensure_for_datablock"):
        fcurve = action.fcurve_ensure_for_datablock(block, path, index=index)
        while fcurve.keyframe_points:
            fcurve.keyframe_points.remove(fcurve.keyframe_points[0], fast=True)
        while fcurve.modifiers:
            fcurve.modifiers.remove(fcurve.modifiers[0])
        return fcurve
    old = action.fcurves.find(path, index=index)
    if old:
        action.fcurves.remove(old)
    return action.fcurves.new(path, index=index)


def place_of(curve, to):
    """The data-block and the data path of a curve, a custom property if need be."""
    owner, path, index = curve.get("owner", ""), curve["data_path"], curve.get("index")
    block = bpy.data.objects.get(owner)
    if block:
        try:
            block.path_resolve(path)
            return block, path
        except ValueError:
            pass
    if to is None:
        raise ValueError(f"{owner}.{path}: there is no such property, and no object to keep it: use --to NAME")
    name = f"{owner}.{path}" if owner else path
    if index is None:
        to[name] = float(to.get(name, 0.0))
    elif name not in to:
        to[name] = [0.0, 0.0, 0.0]
    return to, f'["{bpy.utils.escape_identifier(name)}"]'


def fill(fcurve, curve):
    keys = curve["keys"]
    points = fcurve.keyframe_points
    points.add(len(keys))
    for point, key in zip(points, keys):
        point.handle_left_type = point.handle_right_type = "FREE"
        point.co = key["co"]
        point.handle_left, point.handle_right = key["left"], key["right"]
        point.interpolation, point.easing = key["interpolation"], key.get("easing", "AUTO")
        for name in ("back", "amplitude", "period"):
            if name in key:
                setattr(point, name, key[name])
    fcurve.extrapolation = curve.get("extrapolation", "CONSTANT")
    cycles = curve.get("cycles")
    if cycles:
        modifier = fcurve.modifiers.new("CYCLES")
        modifier.mode_before, modifier.cycles_before = cycles["before"], int(cycles["before_count"])
        modifier.mode_after, modifier.cycles_after = cycles["after"], int(cycles["after_count"])
    fcurve.update()


def import_curves(path, to=None):
    """Makes F-curves of a file. `to`: the object for custom properties, or its name. Returns how many."""
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    if document.get("format") != "blender-curves" or document.get("version") != 1:
        raise ValueError(f"{path}: is not a file of curves for Blender, version 1")
    if isinstance(to, str):
        to = bpy.data.objects[to]
    to = to or bpy.context.view_layer.objects.active
    for curve in document["curves"]:
        block, data_path = place_of(curve, to)
        fill(new_fcurve(block, data_path, curve.get("index") or 0), curve)
    return len(document["curves"])


def main(arguments):
    if len(arguments) < 2 or arguments[0] not in ("export", "import"):
        sys.exit(__doc__)
    command, path, rest = arguments[0], arguments[1], arguments[2:]
    if command == "export":
        print(f"{path}: {export_curves(path, rest)} curves")
        return
    to = rest[rest.index("--to") + 1] if "--to" in rest else None
    print(f"{path}: {import_curves(path, to)} curves")
    if "--save" in rest:
        bpy.ops.wm.save_mainfile()


if __name__ == "__main__" and "--" in sys.argv:
    main(sys.argv[sys.argv.index("--") + 1:])
