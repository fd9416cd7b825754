"""Operators and menus: scene files in and out, and bakes."""

from __future__ import annotations

import contextlib
from typing import Any, Iterator, List, Set

import bpy
from bpy.props import BoolProperty, EnumProperty, IntVectorProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import baking, edit, exporting, importing, live, pliant
from .problems import Refused, error_of, refused_by
from .properties import role
from .translate import Problem


class _Operator:
    """What the three have in common: `act` gives notes, or raises Refused before it has changed anything."""

    bl_options = {"REGISTER", "UNDO"}
    cause = ""

    def execute(self, context: Any) -> Set[str]:
        scene = context.scene
        # In other modes a mesh cannot be read, and an undo step has that mesh only.
        mode = edit.set_mode(context, "OBJECT")
        context.view_layer.update()
        try:
            notes = self.act(context)
        except Refused as error:
            edit.set_mode(context, mode)
            live.tell(scene, self.cause, error.problems)
            self.report({"ERROR"}, "\n".join(_line(each) for each in error.problems))
            return {"CANCELLED"}
        if "UNDO" not in self.bl_options:
            edit.set_mode(context, mode)
        live.refresh(scene)
        session = live.session_of(scene)
        known = session.translation.problems if session and session.translation else []
        notes = [each for each in notes if each not in known]
        if notes or (session and session.told.get(self.cause)):
            live.tell(scene, self.cause, notes)
        return {"FINISHED"}

    def act(self, context: Any) -> List[Problem]:
        raise NotImplementedError


@contextlib.contextmanager
def _all_or_nothing() -> Iterator[None]:
    """Removes what was made, if not all was."""
    lists = [getattr(bpy.data, name) for name in ("objects", "meshes", "actions", "images")]
    before = [set(each) for each in lists]
    try:
        yield
    except BaseException as error:
        for each, there in zip(lists, before):
            bpy.data.batch_remove(set(each) - there)
        if isinstance(error, OSError):
            raise Refused(error_of(str(error))) from error
        raise


def _line(problem: Problem) -> str:
    return f"{problem.object}: {problem.text}" if problem.object else problem.text


class PLIANT_OT_import_scene(_Operator, bpy.types.Operator, ImportHelper):
    """Adds the surfaces, forces and groups of a scene file"""

    bl_idname = "pliant.import_scene"
    bl_label = "Import pliant Scene"
    cause = "import"
    filename_ext = ".xml"

    filter_glob: StringProperty(default="*.xml", options={"HIDDEN"})
    up: EnumProperty(
        name="Up", default="Y", description="The axis of the file that points up",
        items=[
            ("Y", "Y", "All is under an empty turned by 90 degrees about x, which becomes the origin"),
            ("Z", "Z", "Coordinates as they are"),
        ],
    )  # fmt: skip

    def act(self, context: Any) -> List[Problem]:
        try:
            scene = pliant.load(bpy.path.abspath(self.filepath))
        except pliant.Error as error:
            raise refused_by(error) from error
        work = importing.Import(context, scene, self.up)
        with _all_or_nothing():
            work.run()
        context.view_layer.update()
        return work.notes


class PLIANT_OT_bake(_Operator, bpy.types.Operator):
    """Makes an object of each surface that moves as it does now, also without the add-on"""

    bl_idname = "pliant.bake"
    bl_label = "Bake"
    cause = "bake"

    target: EnumProperty(
        name="Target", description="What plays the motion",
        items=[
            ("MESH_CACHE", "Mesh Cache", "A file of its own, played by a Mesh Cache modifier"),
            ("SHAPE_KEYS", "Shape Keys", "Absolute shape keys, one a frame, and one F-curve"),
        ],
    )  # fmt: skip
    directory: StringProperty(
        name="Folder", default="//pliant_cache", subtype="DIR_PATH", description="Where the files of Mesh Cache are"
    )
    frames: IntVectorProperty(
        name="Frames", size=2, default=(0, 0), description="First and last frame; both 0: all"
    )
    hide_original: BoolProperty(name="Hide Original", default=True, description="Hide the surfaces that were baked")

    @classmethod
    def poll(cls, context: Any) -> bool:
        if any(role(each) == "SURFACE" for each in context.scene.objects):
            return True
        cls.poll_message_set("there is no surface")
        return False

    def act(self, context: Any) -> List[Problem]:
        work = baking.Bake(self, context)
        with _all_or_nothing():
            work.run()
        context.view_layer.update()
        return work.notes


class PLIANT_OT_export_scene(_Operator, bpy.types.Operator, ExportHelper):
    """Writes the surfaces, forces and groups as a scene file, and beside it the meshes"""

    bl_idname = "pliant.export_scene"
    bl_label = "Export pliant Scene"
    bl_options = {"REGISTER"}
    cause = "export"
    filename_ext = ".xml"

    filter_glob: StringProperty(default="*.xml", options={"HIDDEN"})
    sampled: BoolProperty(
        name="Sampled", default=False, description="All that is animated has a key at each frame"
    )

    def act(self, context: Any) -> List[Problem]:
        if self.filepath.startswith("//") and not bpy.data.filepath:
            raise Refused(error_of(f"{self.filepath} is beside the file, which is not saved yet"))
        return exporting.export(context.scene, bpy.path.abspath(self.filepath), self.sampled)


def _import_entry(menu: Any, _context: Any) -> None:
    menu.layout.operator(PLIANT_OT_import_scene.bl_idname, text="pliant Scene (.xml)")


def _export_entry(menu: Any, _context: Any) -> None:
    menu.layout.operator(PLIANT_OT_export_scene.bl_idname, text="pliant Scene (.xml)")


CLASSES = (PLIANT_OT_import_scene, PLIANT_OT_export_scene, PLIANT_OT_bake)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_file_import.append(_import_entry)
    bpy.types.TOPBAR_MT_file_export.append(_export_entry)


def unregister() -> None:
    bpy.types.TOPBAR_MT_file_export.remove(_export_entry)
    bpy.types.TOPBAR_MT_file_import.remove(_import_entry)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
