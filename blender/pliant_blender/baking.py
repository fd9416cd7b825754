"""Surfaces as they are shown, as objects that need no add-on."""

from __future__ import annotations

import os
import shutil
import tempfile
from typing import Any, Callable, List, Sequence, Tuple

import bpy
import numpy as np

from . import fcurves, live, meshes, pliant, translate
from .point_cache import HEADER as PC2, Cache
from .problems import Refused, error_of, refused_by
from .shape_keys import absolute_keys
from .translate import Problem, Translation


class Bake:
    """What is shown of the surfaces of a scene, as objects that need no add-on."""

    def __init__(self, operator: Any, context: Any):
        self.target, self.directory = operator.target, operator.directory
        self.hide, self.context, self.blender = operator.hide_original, context, context.scene
        self.notes: List[Problem] = []
        self.translation, self.at = self._solver()
        scene = self.translation.scene
        first, last = operator.frames if any(operator.frames) else (scene.start, scene.end)
        if not scene.start <= first <= last <= scene.end:
            raise Refused(error_of(f"frames {first} to {last} are not within {scene.start} to {scene.end}"))
        self.first, self.last = first, last
        self.owners = [bpy.data.objects[self.translation.object_of[each.name]] for each in scene.surfaces]
        if not self.owners:
            raise Refused(error_of("there is no surface"))

    def _solver(self) -> Tuple[Translation, Callable[[int], Any]]:
        translation = live.translation(self.blender)
        if translation.scene is None:
            raise Refused(*(each for each in translation.problems if each.level == "ERROR"))
        if self.blender.pliant.live:
            live.refresh(self.blender)
            session = live.session_of(self.blender)
            if session and session.refused:
                raise Refused(*session.refused)
            if session and session.simulation is not None:
                return session.translation, lambda frame: live.frame(self.blender, frame)
        try:
            simulation = pliant.Simulation(translation.scene, threads=os.cpu_count() or 1)
        except pliant.Error as error:
            raise refused_by(error) from error
        return translation, simulation.at

    def run(self) -> None:
        with tempfile.TemporaryDirectory(prefix="pliant-", dir=bpy.app.tempdir or None) as folder:
            caches = self._solve(folder)
            if self.target == "SHAPE_KEYS":
                for owner, cache in zip(self.owners, caches):
                    made = self._copy(owner, cache)
                    shapes = np.memmap(cache.path, "<f4", "r", PC2.size, (cache.count, cache.vertices, 3))
                    absolute_keys(made, cache.first, shapes)
            else:
                self._cached(caches)
        for owner in self.owners if self.hide else ():
            moved = translate.animated(owner)
            if ("hide_render", 0) in {*moved.curves, *moved.driven}:
                text = "it is rendered beside what was baked where its animated visibility says so"
                self.notes.append(Problem("WARNING", owner.name, text))
            owner.hide_render = True
            for layer in self.blender.view_layers:
                if owner.name in layer.objects:
                    owner.hide_set(True, view_layer=layer)

    def _solve(self, folder: str) -> List[Any]:
        caches = []
        try:
            for number, owner in enumerate(self.owners):
                ahead = self._ahead(owner)
                cache = Cache(os.path.join(folder, f"{number}.pc2"))
                caches.append(cache)
                count, vertices = len(ahead) + self.last - self.first + 1, len(owner.data.vertices)
                cache.shape(self.first - len(ahead), count, vertices)
                for index, shape in enumerate(ahead):
                    cache.write(cache.first + index, shape)
            buffers = [np.empty((each.vertices, 3), np.float32) for each in caches]
            for number in range(self.first, self.last + 1):
                frame = self.at(number)
                for owner, cache, buffer in zip(self.owners, caches, buffers):
                    part = self.translation.part_of[owner.name]
                    cache.write(number, frame[part].positions(space="object", out=buffer))
        except pliant.Error as error:
            raise refused_by(error) from error
        except OSError as error:
            raise Refused(error_of(str(error))) from error
        finally:
            for each in caches:
                os.close(each._file)
        return caches

    def _ahead(self, owner: Any) -> List[np.ndarray]:
        """The shapes at rest that are shown ahead of the first frame."""
        start = self.translation.scene.start
        if self.first > start:
            return []
        if owner.pliant.rest == "BASE" or owner.pliant.driven_by:
            return [np.ascontiguousarray(meshes.positions(owner.data))]
        from_ = min(self.blender.frame_start, start, 1) - 1
        shapes = translate.sample(self.blender, None, from_, start - 1, set(), {}, {owner.name}).shapes[owner.name]
        return [np.ascontiguousarray(each) for each in shapes]

    def _cached(self, caches: Sequence[Any]) -> None:
        if self.directory.startswith("//") and not bpy.data.filepath:
            raise Refused(error_of(f"{self.directory} is beside the file, which is not saved yet"))
        if not self.directory:
            raise Refused(error_of("give a folder for the files"))
        folder = bpy.path.abspath(self.directory)
        files: List[str] = []
        try:
            os.makedirs(folder, exist_ok=True)
            for owner, cache in zip(self.owners, caches):
                files.append(_free_name(folder, bpy.path.clean_name(owner.name)))
                shutil.copyfile(cache.path, files[-1])
        except OSError as error:
            for each in files:
                if os.path.exists(each):
                    os.unlink(each)
            raise Refused(error_of(str(error))) from error
        for owner, cache, file in zip(self.owners, caches, files):
            made = self._copy(owner, cache)
            modifier = made.modifiers.new("Mesh Cache", "MESH_CACHE")
            modifier.show_viewport = False  # at its place it fits
            _move_first(made, modifier)
            modifier.cache_format, modifier.deform_mode, modifier.interpolation = "PC2", "OVERWRITE", "LINEAR"
            is_beside = self.directory.startswith("//")
            modifier.filepath = bpy.path.relpath(file) if is_beside else os.path.abspath(file)
            modifier.frame_start = cache.first
            modifier.show_viewport = True

    def _copy(self, owner: Any, cache: Any) -> Any:
        """A copy of a surface, at rest, with the modifiers behind ours."""
        made = owner.copy()
        if made.override_library and "clear_liboverride" in bpy.types.ID.bl_rna.functions["make_local"].parameters:
            made.make_local(clear_liboverride=True)  # not in 3.4
        made.name = f"{owner.name}.baked"
        made.data = owner.data.copy()
        made.data.name = made.name
        made.property_unset("pliant")
        if owner.hide_get():
            made.hide_render = False  # an earlier bake has hidden the surface, not the artist
        _drop_curves(made)
        place = translate.ours(owner)
        ahead = place + 1 if place >= 0 else 0 if owner.pliant.rest == "BASE" else translate.place_of(owner)
        for each in list(made.modifiers)[:ahead]:
            try:
                made.modifiers.remove(each)
            except RuntimeError:  # it is the library's
                each.show_viewport = each.show_render = False
        keys = made.data.shape_keys
        if keys:
            name = keys.name
            made.shape_key_clear()
            if name in bpy.data.shape_keys:  # those of a copied mesh stay
                bpy.data.batch_remove([bpy.data.shape_keys[name]])
        rest = np.fromfile(cache.path, "<f4", 3 * cache.vertices, offset=PC2.size)
        made.data.vertices.foreach_set("co", rest)
        made.data.update()
        for collection in owner.users_collection:
            collection.objects.link(made)
        return made


def _free_name(folder: str, stem: str) -> str:
    number, found = 2, os.path.join(folder, f"{stem}.pc2")
    while os.path.exists(found):
        found, number = os.path.join(folder, f"{stem}_{number}.pc2"), number + 1
    open(found, "xb").close()
    return found


def _move_first(owner: Any, modifier: Any) -> None:
    place = len(owner.modifiers) - 1
    if hasattr(owner.modifiers, "move"):
        owner.modifiers.move(place, 0)
    elif place:
        with live.overriding(owner):
            bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=0)


def _drop_curves(owner: Any) -> None:
    """Takes away what moves properties of ours, from a copy of the action."""
    animation = owner.animation_data
    if not animation:
        return
    paths = {path for path, _ in fcurves.table(animation) if path.startswith("pliant.")}
    if paths:
        animation.action = animation.action.copy()
        for path in paths:
            fcurves.remove(owner, path)
    animation = owner.animation_data
    for each in list(animation.drivers) if animation else ():
        if each.data_path.startswith("pliant."):
            animation.drivers.remove(each)
