"""Surfaces that forces deform, live in Blender: docs/blender.md of the project."""

from __future__ import annotations

import contextlib
import importlib
import sys

import bpy

bl_info = {
    "name": "pliant",
    "author": "The pliant authors",
    "version": (0, 0, 0),  # that of the build, in the package
    "blender": (3, 4, 0),
    "category": "Animation",
    "location": "View3D > Sidebar > pliant",
    "description": "Surfaces that forces deform, live in the viewport",
}

_ROOMS = ("preferences", "properties", "live", "edit", "files", "panels", "view")


class _Unfit:
    """What is registered where the module is not made for this Python: a panel that says so."""

    def __init__(self, reason: str) -> None:
        class PLIANT_PT_unfit(bpy.types.Panel):
            bl_label = "pliant"
            bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "pliant"

            def draw(self, _context: bpy.types.Context) -> None:
                for line in reason.split("\n"):
                    self.layout.label(text=line)

        self._panel = PLIANT_PT_unfit

    def register(self) -> None:
        bpy.utils.register_class(self._panel)

    def unregister(self) -> None:
        bpy.utils.unregister_class(self._panel)


def _rooms() -> list:
    try:
        importlib.import_module(".pliant", __package__)
    except Exception as error:  # a module of another Python fails in several ways
        version = ".".join(map(str, sys.version_info[:2]))
        try:
            from ._built_for import PYTHON
        except ImportError:
            PYTHON = "another one"
        return [_Unfit(f"pliant needs Python {PYTHON};\nthis Blender has {version}.\n{error}")]
    return [importlib.import_module(f".{name}", __package__) for name in _ROOMS]


_leave = contextlib.ExitStack()  # what unregister does: all of it, though a part fails


def register() -> None:
    try:
        for room in _rooms():
            room.register()
            _leave.callback(room.unregister)
    except Exception:
        _leave.close()  # all or nothing
        raise


def unregister() -> None:
    _leave.close()
