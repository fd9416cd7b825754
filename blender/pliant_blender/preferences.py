"""The settings of the add-on that belong to a user, not to a file."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import FloatProperty


class PliantPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    patience: FloatProperty(
        name="Patience", default=0.1, min=0.01, max=10, subtype="TIME", unit="TIME_ABSOLUTE",
        description="How long an update may hold the interface; the rest is solved behind it",
    )  # fmt: skip
    memory: FloatProperty(
        name="Memory (GB)", default=1.0, min=0.0, soft_max=64.0,
        description="What solved frames may take, so that edits and undo come back to them at once",
    )  # fmt: skip

    def draw(self, _context: Any) -> None:
        column = self.layout.column()
        column.prop(self, "patience")
        column.prop(self, "memory")


def preferences() -> Any:
    """The user's; the defaults where the add-on is not among those enabled, such as in a test."""
    addon = bpy.context.preferences.addons.get(__package__)
    return addon.preferences if addon and addon.preferences else Defaults


class Defaults:
    patience = 0.1
    memory = 1.0


def register() -> None:
    bpy.utils.register_class(PliantPreferences)


def unregister() -> None:
    bpy.utils.unregister_class(PliantPreferences)
