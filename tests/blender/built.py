"""Scenes that the tests of the add-on build in Blender, and what they must look like."""

import bpy
import numpy as np

from pliant_blender import pliant, translate


def clear() -> None:
    """An empty file; what the add-on knows goes too."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import addon_utils

    addon_utils.enable("pliant_blender")


def sheet(name="Sheet", columns=21, rows=21, width=2.0, depth=2.0, location=(0, 0, 0), **properties):
    """A surface of the density and damping that ring a little."""
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    u, v = i / (columns - 1), j / (rows - 1)
    points = np.stack([(u - 0.5) * width, (v - 0.5) * depth, 0 * u], -1).reshape(-1, 3)
    number = np.arange(columns * rows).reshape(rows, columns)
    faces = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], -1).reshape(-1, 4)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    layer = mesh.uv_layers.new(name="UVMap")
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    layer.data.foreach_set("uv", np.stack([u, v], -1).reshape(-1, 2)[corners].astype(np.float32).ravel())
    owner = bpy.data.objects.new(name, mesh)
    owner.location = location
    bpy.context.scene.collection.objects.link(owner)
    owner.pliant.role = "SURFACE"
    for key, value in {"density": 40, "damping": 20, "dt": 0.04, **properties}.items():
        setattr(owner.pliant, key, value)
    return owner


def force(name="Poke", kind="POINT", location=(0.1, 0.2, 0), **properties):
    owner = bpy.data.objects.new(name, None)
    owner.location = location
    bpy.context.scene.collection.objects.link(owner)
    owner.pliant.role = "FORCE"
    owner.pliant.kind = kind
    values = {"magnitude": 100, "deformation_radius": 0.8, "force_radius": 0.3, **properties}
    for key, value in values.items():
        setattr(owner.pliant, key, value)
    return owner


def key(owner, path, *pairs, index=-1, interpolation=None):
    """Keys of a property: (frame, value)."""
    holder, _, name = path.rpartition(".")
    holder = owner.path_resolve(holder) if holder else owner
    for frame, value in pairs:
        if index >= 0:
            getattr(holder, name)[index] = value
        else:
            setattr(holder, name, value)
        owner.keyframe_insert(path, index=index, frame=frame)
    if interpolation:
        for curve in owner.animation_data.action.fcurves:
            if curve.data_path == path:
                for point in curve.keyframe_points:
                    point.interpolation = interpolation


def update() -> None:
    bpy.context.view_layer.update()


def shown(owner) -> np.ndarray:
    """What Blender shows of a mesh: float32 (V, 3), object space."""
    mesh = owner.evaluated_get(bpy.context.view_layer.depsgraph).data
    found = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def solved(owner, frame, scene=None) -> np.ndarray:
    """What a new simulation of the scene says."""
    scene = scene or bpy.context.scene
    made = translate.translate(scene)
    assert made.scene is not None, made.problems
    frame = min(max(frame, made.scene.start), made.scene.end)
    part = pliant.Simulation(made.scene).at(frame)[made.part_of[owner.name]]
    return part.positions(space="object").astype(np.float32)


def messages(scene=None):
    return [(each.level, each.object, each.text) for each in (scene or bpy.context.scene).pliant.messages]
