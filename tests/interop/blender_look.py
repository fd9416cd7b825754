"""Runs inside Blender: opens files with its own importers and reports the positions of their
vertices.

usage: blender -b --factory-startup -noaudio -P blender_look.py -- JOBS RESULTS

JOBS is a JSON array of {kind, file, times?, fps?, mesh?, picture?}: kind is gltf, obj, ply, cache
(a .pc2 or .mdd in a Mesh Cache modifier on `mesh`) or mdd_keys (the MDD add-on on `mesh`); times
are frames of Blender. Writes to RESULTS an array of {name: [positions of each time]} and other data
of the objects.
"""

import json
import sys

import addon_utils
import bpy
import numpy as np

if not hasattr(np, "bool"):  # Blender 3.4's glTF add-on uses names that NumPy 1.24 removed
    np.bool = bool


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def evaluated(object_):
    """World positions as Blender draws them, modifiers and shape keys applied."""
    graph = bpy.context.evaluated_depsgraph_get()
    final = object_.evaluated_get(graph)
    mesh = final.to_mesh()
    rows = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", rows)
    final.to_mesh_clear()
    world = np.array(final.matrix_world, dtype=np.float64)
    return (rows.reshape(-1, 3).astype(np.float64) @ world[:3, :3].T + world[:3, 3]).tolist()


def meshes():
    return sorted((each for each in bpy.data.objects if each.type == "MESH"), key=lambda each: each.name)


def at(time):
    bpy.context.scene.frame_set(int(time // 1), subframe=time % 1)


def describe():
    """The other imported data, by object."""
    return {each.name: {
        "faces": [list(face.vertices) for face in each.data.polygons],
        "smooth": [face.use_smooth for face in each.data.polygons],
        "materials": [slot.name for slot in each.data.materials if slot],
        "material_of_face": [face.material_index for face in each.data.polygons],
        "uvs": [list(layer.uv) for layer in each.data.uv_layers[0].data] if each.data.uv_layers else [],
        "keys": len(each.data.shape_keys.key_blocks) if each.data.shape_keys else 0,
    } for each in meshes()}


def sampled(times):
    result = {each.name: [] for each in meshes()}
    for time in times:
        at(time)
        for each in meshes():
            result[each.name].append(evaluated(each))
    return result


def look_at_gltf(job):
    bpy.context.scene.render.fps = job["fps"][0]
    bpy.context.scene.render.fps_base = job["fps"][1]
    bpy.ops.import_scene.gltf(filepath=job["file"])
    return sampled(job["times"])


def import_obj(file):
    bpy.ops.wm.obj_import(filepath=file)  # +y up becomes +z up by the object's rotation


def look_at_obj(job):
    # Without conversion of axes: the numbers of the file.
    bpy.ops.wm.obj_import(filepath=job["file"], forward_axis="Y", up_axis="Z")
    return sampled([1])


def look_at_ply(job):
    bpy.ops.import_mesh.ply(filepath=job["file"])
    return sampled([1])


def look_at_cache(job):
    import_obj(job["mesh"])
    modifier = meshes()[0].modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = "MDD" if job["file"].endswith(".mdd") else "PC2"
    modifier.filepath = job["file"]
    modifier.frame_start = job["times"][0]
    return sampled(job["times"])


def look_at_mdd_keys(job):
    addon_utils.enable("io_shape_mdd")
    import_obj(job["mesh"])
    bpy.context.view_layer.objects.active = meshes()[0]
    bpy.ops.import_shape.mdd(filepath=job["file"], frame_start=int(job["times"][0]), frame_step=1)
    return sampled(job["times"])


def picture(file):
    """Renders the loaded objects with Cycles on the CPU, since the workbench renderer needs a
    GPU."""
    scene = bpy.context.scene
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for each in meshes():
        rows = np.array(evaluated(each))
        low, high = np.minimum(low, rows.min(axis=0)), np.maximum(high, rows.max(axis=0))
    size = float(np.linalg.norm(high - low))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    target = bpy.data.objects.new("target", None)
    target.location = (low + high) / 2
    scene.collection.objects.link(target)
    camera.location = np.array(target.location) + np.array([0.5, -1.1, 0.7]) * size
    track = camera.constraints.new("TRACK_TO")
    track.target = target
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3
    sun.rotation_euler = (0.7, 0.3, 0.4)
    scene.collection.objects.link(sun)
    world = bpy.data.worlds.new("world")
    world.color = (0.5, 0.5, 0.5)
    scene.world = world
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 640, 400
    scene.render.filepath = file
    bpy.ops.render.render(write_still=True)


LOOKS = {"gltf": look_at_gltf, "obj": look_at_obj, "ply": look_at_ply, "cache": look_at_cache,
         "mdd_keys": look_at_mdd_keys}


def main():
    jobs_file, results_file = sys.argv[sys.argv.index("--") + 1:]
    with open(jobs_file, encoding="utf-8") as file:
        jobs = json.load(file)
    results = []
    for job in jobs:
        clear()
        positions = LOOKS[job["kind"]](job)
        results.append({"positions": positions, "objects": describe(),
                        "markers": [bpy.context.scene.frame_start, bpy.context.scene.frame_end]})
        if job.get("picture"):
            at(job["picture_at"])
            picture(job["picture"])
    with open(results_file, "w", encoding="utf-8") as file:
        json.dump(results, file)


main()
