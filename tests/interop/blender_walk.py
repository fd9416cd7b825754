"""Runs inside Blender: the walk of docs/interchange.md.

usage: blender -b --factory-startup -noaudio -P blender_walk.py -- export SCRIPT FOLDER START
       blender -b --factory-startup -noaudio -P blender_walk.py -- home FOLDER START CACHE…

`export` makes a tube that two bones bend, in frames START to START + 11, and saves walk.blend, and
character.obj with the settings of the page; then it runs SCRIPT, the page's own. It also saves what
the bones make of the tube, posed.npy. `home` opens walk.blend, puts each cache onto the character as
the page says, and saves what is seen as CACHE.npy.
"""

import os
import sys

import bpy
import numpy as np

FRAMES = 12


def make_character(start):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = start, start + FRAMES - 1
    scene.render.fps = 24
    bpy.ops.mesh.primitive_cylinder_add(vertices=10, radius=0.4, depth=3, location=(0, 0, 1.5), end_fill_type="NOTHING")
    tube = bpy.context.object
    tube.name = "tube"
    bpy.ops.object.transform_apply()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=3)
    bpy.ops.object.mode_set(mode="OBJECT")

    bpy.ops.object.armature_add(enter_editmode=True)
    rig = bpy.context.object
    bones = rig.data.edit_bones
    hip = bones[0]
    hip.name, hip.head, hip.tail = "hip", (0, 0, 0), (0, 0, 1.5)
    knee = bones.new("knee")
    knee.head, knee.tail, knee.parent = (0, 0, 1.5), (0, 0, 3), hip
    bpy.ops.object.mode_set(mode="POSE")
    for name, angle in (("hip", 0.4), ("knee", -0.9)):
        bone = rig.pose.bones[name]
        bone.rotation_mode = "XYZ"
        for frame, part in ((start, 0), (start + 4, 1), (start + 11, -0.5)):
            bone.rotation_euler = (part * angle, 0.3 * part * angle, 0)
            bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.ops.object.mode_set(mode="OBJECT")

    tube.parent = rig
    modifier = tube.modifiers.new("rig", "ARMATURE")
    modifier.object = rig
    for name in ("hip", "knee"):
        group = tube.vertex_groups.new(name=name)
        for vertex in tube.data.vertices:
            of_knee = min(max((vertex.co.z - 1.0) / 1.0, 0.0), 1.0)
            group.add([vertex.index], of_knee if name == "knee" else 1 - of_knee, "REPLACE")
    bpy.ops.object.select_all(action="DESELECT")
    tube.select_set(True)
    bpy.context.view_layer.objects.active = tube
    return tube, rig


def seen(character):
    """The vertices of each frame, in the object's own space."""
    scene, frames = bpy.context.scene, []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        mesh = character.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        frames.append([list(vertex.co) for vertex in mesh.vertices])
    return np.array(frames)


def export(script, folder, start):
    tube, rig = make_character(int(start))
    np.save(os.path.join(folder, "posed.npy"), seen(tube))
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "walk.blend"))
    rig.data.pose_position = "REST"
    bpy.ops.wm.obj_export(filepath=os.path.join(folder, "character.obj"), export_selected_objects=True,
                          forward_axis="Y", up_axis="Z")
    rig.data.pose_position = "POSE"
    with open(script, encoding="utf-8") as file:
        exec(compile(file.read(), script, "exec"), {})


def home(folder, start, *caches):
    for cache in caches:
        bpy.ops.wm.open_mainfile(filepath=os.path.join(folder, "walk.blend"))
        tube = bpy.data.objects["tube"]
        tube.modifiers["rig"].show_viewport = False
        modifier = tube.modifiers.new("cache", "MESH_CACHE")
        modifier.cache_format = "PC2"
        modifier.filepath = os.path.join(folder, cache)
        modifier.frame_start = int(start)
        np.save(os.path.join(folder, cache + ".npy"), seen(tube))


def main():
    what, *rest = sys.argv[sys.argv.index("--") + 1:]
    {"export": export, "home": home}[what](*rest)


main()
