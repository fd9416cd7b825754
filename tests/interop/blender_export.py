"""Runs inside Blender: makes a mesh with (u,v) and saves it in every format that pliant reads, with
the settings of docs/meshes.md.

usage: blender -b --factory-startup -noaudio -P blender_export.py -- FOLDER

Writes to FOLDER: sheet.obj, .ply, .glb, .gltf with its .bin, .fbx and .dae, default.fbx with the
exporter's default settings, and world.npy: the vertices in Blender's world space.
"""

import math
import os
import sys

import bpy
import numpy as np

if not hasattr(np, "bool"):  # Blender 3.4's glTF add-on uses names that NumPy 1.24 removed
    np.bool = bool


def make_sheet():
    """A relief of 9 x 7 vertices, moved, turned and scaled."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=6, size=2, calc_uvs=True)
    sheet = bpy.context.object
    sheet.name = "sheet"
    for vertex in sheet.data.vertices:
        vertex.co.z = 0.3 * math.sin(2 * vertex.co.x) + 0.1 * vertex.co.y
    sheet.location, sheet.rotation_euler, sheet.scale = (1, 2, 3), (0.1, 0.2, 0.3), (1, 1.5, 0.5)
    bpy.context.view_layer.update()
    return sheet


def main():
    folder = sys.argv[sys.argv.index("--") + 1]
    sheet = make_sheet()
    world = np.array(sheet.matrix_world)
    np.save(os.path.join(folder, "world.npy"),
            np.array([vertex.co for vertex in sheet.data.vertices]) @ world[:3, :3].T + world[:3, 3])
    path = os.path.join(folder, "sheet")
    bpy.ops.wm.obj_export(filepath=path + ".obj")
    bpy.ops.export_mesh.ply(filepath=path + ".ply")
    bpy.ops.export_scene.gltf(filepath=path + ".glb", export_format="GLB")
    bpy.ops.export_scene.gltf(filepath=path + ".gltf", export_format="GLTF_SEPARATE")
    bpy.ops.export_scene.fbx(filepath=path + ".fbx", apply_scale_options="FBX_SCALE_UNITS")
    bpy.ops.export_scene.fbx(filepath=os.path.join(folder, "default.fbx"))
    bpy.ops.wm.collada_export(filepath=path + ".dae")


main()
