"""A face out of Blender and back into it. Blender runs this script:

    blender -b --factory-startup -P blender_cheek.py -- paint [cheek.glb]
    pliant bake cheek.xml -o ring.glb
    blender -b --factory-startup -P blender_cheek.py -- home ring.glb FRAME PICTURE.png

`paint` makes the face of make_head.py with fuller cheeks, paints two attributes on its vertices, as a brush
would, and exports it: _FLESH and _BONE. `home` imports what was baked, and renders a frame of the scene.
"""

import math
import pathlib
import sys

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import make_head  # noqa: E402

if not hasattr(np, "bool"):  # Blender 3.4's glTF add-on uses names that NumPy 1.24 removed
    np.bool = bool

COLUMNS, ROWS = 53, 61
CHEEKS = [(0.33, 0.335, 0.085, 0.10, 0.75)]  # as make_head.FEATURES, of the left half
# Dabs of the brush, which paints both halves: (u, v, radius), from full in its inner half to nothing.
FLESH = [(0.30, 0.36, 2.1), (0.33, 0.28, 1.9), (0.22, 0.33, 1.8)]
BONE = [(0.22, 0.47, 1.1), (0.31, 0.485, 0.9), (0.39, 0.47, 0.8),  # the cheekbone, out to in
        (0.50, 0.45, 1.1), (0.50, 0.38, 0.9),  # the nose
        (0.50, 0.15, 1.4), (0.39, 0.11, 1.0), (0.29, 0.12, 0.9), (0.20, 0.17, 0.9), (0.13, 0.25, 0.9),  # the jaw
        *((u / 100, v / 100, 1.6) for u in range(5, 51, 9) for v in (56, 66, 76, 86, 96))]  # the skull


def place(u, v):
    """In Blender's axes: z is up, and the face looks along -y."""
    height = make_head.relief(u, v) + sum(h * math.exp(-((min(u, 1 - u) - a) / s) ** 2 - ((v - b) / t) ** 2)
                                          for a, b, s, t, h in CHEEKS)
    x, y, z = make_head.position(u, v, height)
    return x, -z, y


def painted(places, dabs):
    """What strokes of a brush leave on each vertex, from 0 to 1."""
    value = np.zeros(len(places))
    for u, v, radius in dabs:
        for centre in (place(u, v), place(1 - u, v)):
            far = np.linalg.norm(places - centre, axis=1) / radius
            share = np.clip(2 - 2 * far, 0, 1)
            value = np.maximum(value, share * share * (3 - 2 * share))
    return value


def paint(out=HERE / "cheek.glb"):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    places = np.array([place(i / (COLUMNS - 1), j / (ROWS - 1)) for j in range(ROWS) for i in range(COLUMNS)])
    corners = [j * COLUMNS + i for j in range(ROWS - 1) for i in range(COLUMNS - 1)]
    mesh = bpy.data.meshes.new("face")
    mesh.from_pydata(places.tolist(), [], [(a, a + 1, a + COLUMNS + 1, a + COLUMNS) for a in corners])
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    for name, dabs in (("FLESH", FLESH), ("BONE", BONE)):
        # The exporter of Blender 3.4 puts a _ ahead of every name, later ones only keep it.
        name = name if bpy.app.version < (3, 5) else "_" + name
        mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", painted(places, dabs))
    face = bpy.data.objects.new("face", mesh)
    bpy.context.scene.collection.objects.link(face)
    bpy.ops.export_scene.gltf(filepath=str(out), export_format="GLB", export_attributes=True)


def home(bake, frame, picture):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 24  # before the import, which turns seconds into frames
    bpy.ops.import_scene.gltf(filepath=bake, import_shading="SMOOTH")
    scene.frame_set(int(frame) - 1)  # a glTF begins at Blender's frame 0
    skin = bpy.data.materials.new("skin")
    skin.use_nodes = True
    skin.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.7, 0.36, 0.26, 1)
    for each in bpy.data.objects:
        if each.type == "MESH":
            each.data.materials.clear()
            each.data.materials.append(skin)
    render(scene, picture)


def render(scene, picture):
    """From the front, a little from the side of the slap, with a lamp at either side."""
    def add(name, data, location):
        thing = bpy.data.objects.new(name, data)
        thing.location = location
        scene.collection.objects.link(thing)
        look = thing.constraints.new("TRACK_TO")
        look.target, look.track_axis, look.up_axis = middle, "TRACK_NEGATIVE_Z", "UP_Y"
        return thing

    middle = bpy.data.objects.new("middle", None)
    middle.location = 0, -2, 0.4
    scene.collection.objects.link(middle)
    scene.camera = add("camera", bpy.data.cameras.new("camera"), (7, -21, 2))
    scene.camera.data.lens = 70
    for name, power, location in (("key", 4500, (-9, -14, 12)), ("rim", 1500, (16, 0, 4))):
        lamp = bpy.data.lights.new(name, "AREA")
        lamp.energy, lamp.size = power, 4
        add(name, lamp, location)
    scene.world = bpy.data.worlds.new("world")
    scene.world.color = 0.06, 0.065, 0.075
    scene.render.engine = "CYCLES"  # on the CPU; the other engines need a graphics card
    scene.view_settings.view_transform = "Standard"
    scene.cycles.samples = 64
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 420, 480
    scene.render.filepath = str(pathlib.Path(picture).resolve())
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    command, *words = sys.argv[sys.argv.index("--") + 1:]
    {"paint": paint, "home": home}[command](*words)
