"""The sidebar of the 3D view, tab pliant, and the menu Add > pliant. Drawing makes nothing and changes nothing."""

from __future__ import annotations

import textwrap
from typing import Any, Dict, List, Tuple

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from . import edit, meshes, properties
from .edit import Edit
from .properties import TABLE, role

_icons = {"ERROR": "ERROR", "WARNING": "ERROR", "NOTE": "INFO"}
_role_icons = {"SURFACE": "MESH_GRID", "FORCE": "FORCE_FORCE", "GROUP": "GROUP"}
_most_messages = 8


def _messages(layout: Any, context: Any, found: List[Any], with_object: bool) -> None:
    """Messages in lines as wide as the panel."""
    width = max(int(context.region.width / 7 / context.preferences.system.ui_scale) - 4, 20) if context.region else 50
    for message in found[:_most_messages]:
        box = layout.box().column(align=True)
        box.alert = message.level == "ERROR"
        text = f"{message.object}: {message.text}" if with_object and message.object else message.text
        for number, line in enumerate(textwrap.wrap(text, width)):
            box.label(text=line, icon="BLANK1" if number else _icons[message.level])
    if len(found) > _most_messages:
        layout.label(text=f"and {len(found) - _most_messages} more")


class _Panel:
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "pliant"


class PLIANT_PT_scene(_Panel, bpy.types.Panel):
    """The elastic animation of the scene"""

    bl_label = "pliant"

    def draw(self, context: Any) -> None:
        layout, scene = self.layout, context.scene
        if not properties.has(scene):
            layout.label(text="There is no surface yet.")
            column = layout.column()
            column.operator("pliant.add_surface", text="Add Surface", icon="ADD")
            column.operator("pliant.make_surface", icon="MESH_GRID")
            column.menu("PLIANT_MT_setups")
            return
        own = scene.pliant
        _messages(layout, context, list(own.messages), True)
        layout.prop(own, "live", toggle=True, icon="PLAY")
        if own.status:
            layout.label(text=own.status)
        row = layout.row(align=True)
        row.prop(own, "frame_start")
        row.prop(own, "frame_end")
        row.operator("pliant.match_range", text="", icon="TIME")
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(own, "seed")
        column.prop(own, "origin")
        row = layout.row(align=True, heading="Show")
        row.prop(own, "show_overlay", toggle=True)
        row.prop(own, "show_region", toggle=True)
        row = layout.row(align=True)
        row.operator("pliant.validate")
        row.operator("pliant.reset")
        row.menu("PLIANT_MT_more", text="", icon="DOWNARROW_HLT")
        row = layout.row(align=True)
        row.operator_menu_enum("pliant.perform", "speed", text="Perform")
        row.operator("pliant.bake")


class PLIANT_PT_object(_Panel, bpy.types.Panel):
    """What the active object is in the elastic animation"""

    bl_label = "Object"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return edit.active(context) is not None

    def draw(self, context: Any) -> None:
        layout, owner = self.layout, edit.active(context)
        kind = role(owner)
        if kind == "NONE":
            layout.label(text=owner.name, icon="OBJECT_DATA")
            column = layout.column()
            if owner.type == "MESH":
                column.operator("pliant.make_surface", icon="MESH_GRID")
                column.operator("pliant.add_setup", text="Jiggle").kind = "JIGGLE"
            column.operator_menu_enum("pliant.make_force", "kind", text="Make Force", icon="FORCE_FORCE")
            return
        row = layout.row()
        row.label(text=owner.name, icon=_role_icons[kind])
        row.prop(owner.pliant, "role", text="")
        row.operator("pliant.remove", text="", icon="X")
        if properties.has(context.scene):
            found = [each for each in context.scene.pliant.messages if each.object == owner.name]
            _messages(layout, context, found, False)


# The settings of a role. A row is the name of a property, or a function that draws several.


def _switched(layout: Any, own: Any, name: str) -> None:
    """A property beside the switch that says whether it counts."""
    switch = properties.SWITCHED[name]
    row = layout.row(heading=own.bl_rna.properties[name].name)
    row.prop(own, switch, text="")
    row = row.row()
    row.active = getattr(own, switch)
    row.prop(own, name, text="")


def _prop(layout: Any, own: Any, name: str) -> None:
    if name in properties.SWITCHED:
        _switched(layout, own, name)
        return
    row = layout.row()
    row.use_property_decorate = name in properties.ANIMATABLE
    row.prop(own, name)


def _items(layout: Any, own: Any, name: str, label: str, props: Tuple[str, ...]) -> None:
    """A collection, with buttons that add and remove items."""
    row = layout.row()
    row.use_property_split = False
    row.label(text=label)
    row.operator("pliant.add_item", text="", icon="ADD").collection = name
    for number, item in enumerate(getattr(own, name)):
        row = layout.row(align=True)
        row.use_property_split = False
        for prop in props:
            row.prop(item, prop, text="")
        remove = row.operator("pliant.remove_item", text="", icon="REMOVE")
        remove.collection, remove.index = name, number


def _shape(layout: Any, owner: Any, own: Any) -> None:
    _prop(layout, own, "solve")
    layout.row().prop_search(own, "uv_map", owner.data, "uv_layers")
    for name in ("rest", "driven_by", "uv", "wrap", "border", "weld", "unit", "axis"):
        _prop(layout, own, name)


def _material(layout: Any, owner: Any, own: Any) -> None:
    row = layout.row(align=True)
    row.use_property_split = False
    row.operator_menu_enum("pliant.material", "preset", text="Material")
    row.menu("PLIANT_MT_material_presets", text="", icon="PRESET")
    row.operator("pliant.add_material_preset", text="", icon="ADD")
    row.operator("pliant.add_material_preset", text="", icon="REMOVE").remove_active = True
    _prop(layout, own, "density")
    row = layout.row()
    row.active = not own.use_damping_ratio
    row.prop(own, "damping")
    for name in ("damping_ratio", "b", "c", "d", "poisson", "goal", "yield_"):
        _prop(layout, own, name)
    row = layout.row()
    row.active = own.use_yield
    row.prop(own, "hardening")
    _items(layout, own, "maps", "Maps: channel, source, low, high", ("channel", "source", "low", "high"))


def _solver(layout: Any, owner: Any, own: Any) -> None:
    for name in ("integrator", "dt", "time_scale", "region", "measure", "combine", "release", "reference", "stepping",
                 "start_frame", "preroll", "loop"):  # fmt: skip
        _prop(layout, own, name)


def _edges(layout: Any, owner: Any, own: Any) -> None:
    for name in (*properties.EDGES, *properties.TANGENTS):
        _prop(layout, own, name)


def _force(layout: Any, owner: Any, own: Any) -> None:
    rows = TABLE[own.kind.capitalize()]
    for name in ("kind", "enabled", "magnitude"):
        _prop(layout, own, name)
    layout.operator("pliant.set_height")
    if not own.group:  # which has the radius then
        _prop(layout, own, "deformation_radius")
    for name in ("force_radius", "falloff"):
        _prop(layout, own, name)
    if own.falloff == "DRAWN":
        _prop(layout, own, "falloff_text")
    for name in ("along", "pull", "frequency", "rate", "seed"):
        if name in rows:
            _prop(layout, own, name)
    if "to" in rows:
        _prop(layout, own, "end")
    if "axis" in rows or "direction" in rows:
        _direction(layout, own, "direction" in rows and rows["direction"].is_optional)


def _direction(layout: Any, own: Any, is_optional: bool) -> None:
    if is_optional:
        _prop(layout, own, "use_direction")
    column = layout.column()
    column.active = own.use_direction or not is_optional
    _prop(column, own, "aim")
    if own.aim == "VECTOR":
        column.prop(own, "direction")


def _acts_on(layout: Any, owner: Any, own: Any) -> None:
    if own.role == "FORCE":
        _prop(layout, own, "group")
        if "follow" in TABLE[own.kind.capitalize()]:
            _prop(layout, own, "follow")
    _items(layout, own, "targets", "Surfaces" if own.targets else "Surfaces: all", ("surface",))


def _group(layout: Any, owner: Any, own: Any) -> None:
    for name in properties.KEYABLE["GROUP"]:
        _prop(layout, own, name)


def _motion(layout: Any, owner: Any, own: Any) -> None:
    manager = bpy.context.window_manager
    for name in _goals:
        row = layout.row()
        row.use_property_decorate = False
        row.prop(manager, f"pliant_{name}", slider=True)
    suggest = layout.operator("pliant.suggest")
    for name, value in _goals.items():
        setattr(suggest, name, value)


_sections: Tuple[Tuple[str, str, Tuple[str, ...], Any], ...] = (
    ("force", "Force", ("FORCE",), _force),
    ("group", "Group", ("GROUP",), _group),
    ("acts_on", "Acts On", ("FORCE", "GROUP"), _acts_on),
    ("material", "Material", ("SURFACE",), _material),
    ("motion", "Motion", ("SURFACE", "FORCE"), _motion),
    ("shape", "Shape", ("SURFACE",), _shape),
    ("solver", "Solver", ("SURFACE",), _solver),
    ("edges", "Edges of a Grid", ("SURFACE",), _edges),
)


def _panel(name: str, label: str, roles: Tuple[str, ...], rows: Any) -> type:
    def poll(cls: Any, context: Any) -> bool:
        owner = edit.active(context)
        return owner is not None and role(owner) in roles

    def draw(self: Any, context: Any) -> None:
        owner = edit.active(context)
        self.layout.use_property_split = True
        rows(self.layout.column(), owner, owner.pliant)

    options = {"DEFAULT_CLOSED"} if name in ("shape", "solver", "edges") else set()
    return type(
        f"PLIANT_PT_{name}", (_Panel, bpy.types.Panel),
        {"__doc__": f"{label} of the active object", "bl_label": label, "bl_parent_id": "PLIANT_PT_object",
         "bl_options": options, "poll": classmethod(poll), "draw": draw},
    )  # fmt: skip


# Items of collections.


class _Items(Edit):
    collection: EnumProperty(
        name="Collection", description="What is changed of the active object",
        items=[
            ("targets", "Targets", "The surfaces that it acts on"),
            ("maps", "Maps", "Channels of the material that differ over the surface"),
        ],
    )  # fmt: skip

    @classmethod
    def missing(cls, context: Any) -> str:
        owner = edit.active(context)
        return "" if owner and role(owner) != "NONE" else "select a surface, a force or a group"


class PLIANT_OT_add_item(_Items, bpy.types.Operator):
    """Adds a target or a map to the active object"""

    bl_idname, bl_label = "pliant.add_item", "Add"

    def act(self, context: Any) -> None:
        owner = edit.active(context)
        edit.check_editable(owner)
        if self.collection == "maps":
            if role(owner) != "SURFACE":
                raise edit.Refused(f"{owner.name} is no surface, which maps are for", owner)
            sources = (name for name in meshes.names_of(owner) if meshes.values(owner, name) is not None)
            source = next(sources, "")
            if not source:
                raise edit.Refused(f"{owner.name} has no vertex group and no attribute for a map", owner)
            owner.pliant.maps.add().source = source
            return
        taken = [each.surface for each in owner.pliant.targets]
        free = [each for each in edit.surfaces(context.scene) if each not in taken]
        if not free:
            raise edit.Refused("there is no other surface", owner)
        owner.pliant.targets.add().surface = free[0]


class PLIANT_OT_remove_item(_Items, bpy.types.Operator):
    """Takes a target or a map from the active object"""

    bl_idname, bl_label = "pliant.remove_item", "Remove"

    index: IntProperty(name="Index", description="Its number, from 0 on")

    def act(self, context: Any) -> None:
        owner = edit.active(context)
        edit.check_editable(owner)
        items = getattr(owner.pliant, self.collection)
        if not 0 <= self.index < len(items):
            raise edit.Refused(f"there is no number {self.index} among {len(items)}", owner)
        items.remove(self.index)


# Menus.


class PLIANT_MT_setups(bpy.types.Menu):
    """Surfaces with forces that move at once"""

    bl_label = "Set-ups"

    def draw(self, _context: Any) -> None:
        self.layout.operator_enum("pliant.add_setup", "kind")


class PLIANT_MT_forces(bpy.types.Menu):
    """Forces that move surfaces"""

    bl_label = "Force"

    def draw(self, _context: Any) -> None:
        self.layout.operator_enum("pliant.add_force", "kind")


class PLIANT_MT_add(bpy.types.Menu):
    """Surfaces that forces deform, and the forces"""

    bl_label = "pliant"

    def draw(self, _context: Any) -> None:
        layout = self.layout
        layout.operator("pliant.add_surface", icon="MESH_GRID")
        layout.menu("PLIANT_MT_forces", icon="FORCE_FORCE")
        layout.operator("pliant.add_group", icon="GROUP")
        layout.separator()
        layout.menu("PLIANT_MT_setups")


def _add(self: Any, _context: Any) -> None:
    self.layout.menu("PLIANT_MT_add", icon="MOD_WAVE")


class PLIANT_MT_more(bpy.types.Menu):
    """What is seldom needed"""

    bl_label = "More"

    def draw(self, _context: Any) -> None:
        self.layout.operator("pliant.clear", icon="TRASH")


CLASSES: Tuple[type, ...] = (
    PLIANT_OT_add_item, PLIANT_OT_remove_item, PLIANT_MT_setups, PLIANT_MT_forces, PLIANT_MT_add, PLIANT_MT_more,
    PLIANT_PT_scene, PLIANT_PT_object, *(_panel(*section) for section in _sections),
)  # fmt: skip


_goal_rows: Dict[str, Dict[str, Any]] = {
    "peak": {"unit": "LENGTH", "soft_max": 5.0, "description": "The largest displacement that is wanted; 0: any"},
    "settling": {"unit": "TIME_ABSOLUTE", "soft_max": 5.0, "description": "When it is to rest [s]; 0: whenever"},
    "frequency": {"soft_max": 8.0, "description": "How often it is to swing in a second [Hz]; 0: however often"},
}
_goals = dict.fromkeys(_goal_rows, 0.0)


def _slider(name: str) -> Any:
    """A slider for what is wanted, whose value is in no file."""
    return FloatProperty(
        name=name.title(), min=0.0, options={"SKIP_SAVE"}, get=lambda _: _goals[name],
        set=lambda _, value: _goals.__setitem__(name, value), **_goal_rows[name],
    )  # fmt: skip


def register() -> None:
    for name in _goals:
        setattr(bpy.types.WindowManager, f"pliant_{name}", _slider(name))
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_add.append(_add)


def unregister() -> None:
    bpy.types.VIEW3D_MT_add.remove(_add)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    for name in _goals:
        delattr(bpy.types.WindowManager, f"pliant_{name}")
