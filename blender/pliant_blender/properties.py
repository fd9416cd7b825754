"""Scene.pliant and Object.pliant: what a user sets, and what is shown of a run.

Names, words, defaults, units and tooltips come from the rows that the format's description has.
"""

import re
from typing import Any, Dict, Iterable, Iterator, List, Tuple

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import pliant

VERSION = 1  # of the properties, in files
OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}
TABLE = {kind: rows for kind, (_, rows) in pliant._core.table().items()}
FORCE_KINDS = ("POINT", "RADIAL", "LINE", "UNIFORM", "VORTEX", "NOISE", "INERTIA", "PRESSURE")
CLASS_OF = {kind: getattr(pliant, kind.capitalize()) for kind in FORCE_KINDS}

# The channels of each role: properties that F-curves move.
KEYABLE = {
    "SURFACE": ("density", "damping", "damping_ratio", "b", "c", "d", "yield_", "hardening", "poisson", "goal",
                "dt", "time_scale"),
    "FORCE": ("enabled", "magnitude", "deformation_radius", "force_radius", "pull", "frequency", "rate", "direction"),
    "GROUP": ("enabled", "deformation_radius"),
}  # fmt: skip
TANGENTS = ("su0", "su1", "sv0", "sv1")
EDGES = ("edge_u0", "edge_u1", "edge_v0", "edge_v1")
# Properties that count only if the switch beside them is on.
SWITCHED = {name: f"use_{name}" for name in ("damping_ratio", "start_frame", "seed", "direction")} | {
    "yield_": "use_yield"
}


def has(block: Any) -> bool:
    """Whether an object or a scene has properties of ours. Reads nothing, so that nothing is made."""
    return block.is_property_set("pliant")


def role(block: Any) -> str:
    """The role of an object; of one without properties, or with a role that this version does not know, NONE."""
    return block.pliant.role or "NONE" if has(block) else "NONE"


def raw(block: Any) -> Dict[str, Any]:
    """The properties that are not at their defaults, as plain values but for objects."""
    if not has(block):
        return {}
    holder = block.bl_system_properties_get() if hasattr(block, "bl_system_properties_get") else block
    return holder["pliant"].to_dict()


def word(text: str) -> str:
    """A word of the format as Blender writes it: backwardEuler is BACKWARD_EULER."""
    return re.sub("([A-Z])", r"_\1", text).upper()


def plain_word(text: str) -> str:
    """The word of the format: BACKWARD_EULER is backwardEuler."""
    return re.sub("_(.)", lambda found: found[1].upper(), text.lower())


# Who is told that something was set: live.py.
listeners: List[Any] = []


def _changed(group: Any, _context: Any) -> None:
    # A value that Python sets tags nothing in 3.4.
    block = group.id_data
    if isinstance(block, bpy.types.Object) and not block.library:
        block.update_tag(refresh={"OBJECT"})  # which no mesh is read again for
    for listener in listeners:
        listener(block)


def _label(name: str) -> str:
    return name if " " in name else name.strip("_").replace("_", " ").title()


def _sentence(row: Any) -> str:
    text = re.sub(r"^\S+: |, see below", "", row.meaning.replace("`", ""))  # without the letter of an equation
    text = text[:1].upper() + text[1:]
    more = f" [{row.unit}]" if row.unit and row.unit != "1" else ""
    return text + more


_kinds = {kind.upper(): text for kind, (text, _) in pliant._core.table().items()}
_meanings = {
    "ERROR": "Nothing moves until it is mended", "WARNING": "It moves, but perhaps not as meant",
    "NOTE": "Worth to know", "NONE": "Nothing of the kind", "SURFACE": "Lengths along the surface of any mesh",
    "FORCE": "It presses on surfaces", "AUTO": "As is best here: the manual tells how it is chosen",
    "GRID": "The UVs, which form an even grid", "U": "Along u", "V": "Along v", "UV": "Along both",
    "CONSTANT": "The same up to the radius", "LINEAR": "Less in a straight line", "SMOOTH": "Less in a smooth step",
    "GAUSSIAN": "Less as a bell curve", "DRAWN": "As the <falloff> below", "FREE": "Nothing is held",
    "NORMAL": "Only the part along the normals pushes", "CLAMPED": "Place and slope are held",
    "PINNED": "The place is held, the slope is free", "EXACT": "Exact in time", "OVERSHOOT": "Whole steps of dt",
    "REST": "The shape at rest", "BOX": "One box around all", "ISLANDS": "Apart where they do not meet",
    "UNION": "Exactly the boxes", "FREEZE": "It stays as the force leaves it", "RECOVER": "It returns to rest",
    "CURRENT": "The shape as it is deformed", "BACKWARD_EULER": "Calms what is fast",
    "NEWMARK": "Keeps energy: it rings longer", "FORCES": "What the deformation radii select", "ALL": "All of it",
}  # fmt: skip


def _items(words: Iterable[str]) -> List[Tuple[str, str, str]]:
    """The choices of a word, each with what it means."""
    return [(each, _label(each), _meanings.get(each) or _kinds.get(each) or _label(each)) for each in words]


def _from_row(name: str, row: Any) -> Any:
    """The property of a row. Ranges are told by the check of a scene, so that nothing is clamped in silence."""
    common = {**common_of(name, name in ANIMATABLE), "description": _sentence(row)}
    if row.kind in ("channel", "number"):
        low = re.match(r"[≥>] 0", row.range) or re.match(r"0 to", row.range)
        more = {"soft_min": 0.0} if low else {}
        if row.unit == "length":
            more["unit"] = "LENGTH"
        standard = row.standard
        if standard is None:
            standard = {"weld": -1.0, "damping_ratio": 0.1}.get(name, 1.0)
        return FloatProperty(default=standard, precision=4, step=10, **more, **common)
    if row.kind in ("boolean", "switch"):
        return BoolProperty(default=row.standard, **common)
    if row.kind in ("integer", "unsigned integer"):
        default = row.standard if row.standard is not None else {"start_frame": 1}.get(name, 0)
        return IntProperty(default=default, **common)
    if row.kind in ("word", "falloff"):
        words = [word(each) for each in row.words]
        if row.standard is None:
            words.insert(0, "AUTO")
        if row.kind == "falloff":
            words.append("DRAWN")
        default = words[0] if row.standard is None else word(row.standard)
        return EnumProperty(items=_items(words), default=default, **common)
    if row.kind in ("vector", "vector channel", "tangent", "pair"):
        size = 2 if row.kind == "pair" else 3
        standard = row.standard if isinstance(row.standard, tuple) else (row.standard or 0.0,) * size
        return FloatVectorProperty(size=size, default=standard, precision=4, **common)
    raise TypeError(f"{name}: no property for {row.kind}")


ANIMATABLE = {name for names in KEYABLE.values() for name in names} | set(TANGENTS)


def common_of(name: str, is_keyable: bool = False) -> Dict[str, Any]:
    """What all properties have in common."""
    options = {"ANIMATABLE"} if is_keyable else set()
    return {"name": _label(name), "update": _changed, "override": OVERRIDABLE, "options": options}


def _annotate(cls: type, properties: Dict[str, Any]) -> None:
    cls.__annotations__ = {**getattr(cls, "__annotations__", {}), **properties}


def _enum(name: str, words: Iterator[str], description: str, **more: Any) -> Any:
    return EnumProperty(items=_items(words), description=description, **common_of(name), **more)


def _is_surface(_self: Any, other: Any) -> bool:
    return other.type == "MESH"


def _is_group(_self: Any, other: Any) -> bool:
    return role(other) == "GROUP"


def _switched(name: str, standard: bool, text: str) -> Any:
    return BoolProperty(default=standard, description=text, **common_of(name))


def _whole(name: str, standard: int, text: str) -> Any:
    return IntProperty(default=standard, description=text, **common_of(name))


def _text(name: str, text: str) -> Any:
    return StringProperty(description=text, **common_of(name))


def _object(name: str, text: str, **more: Any) -> Any:
    return PointerProperty(type=bpy.types.Object, description=text, **common_of(name), **more)


def _several(name: str, cls: type, text: str) -> Any:
    return CollectionProperty(type=cls, name=name, description=text, override=OVERRIDABLE | {"USE_INSERTION"})


class PliantTarget(bpy.types.PropertyGroup):
    """A surface that a force or a group acts on."""

    surface: _object("Surface", "A surface that it acts on", poll=_is_surface)


class PliantMap(bpy.types.PropertyGroup):
    """A channel of the material that differs over the surface."""

    channel: _enum(
        "Channel", map(word, TABLE["Map"]["channel"].words), "The channel that it multiplies", default="DENSITY"
    )
    source: _text(
        "Source", "A vertex group, else an attribute of the points: a number, or the first channel of a colour"
    )
    low: _from_row("low", TABLE["Map"]["low"])
    high: _from_row("high", TABLE["Map"]["high"])


class PliantMessage(bpy.types.PropertyGroup):
    """What a user should know of the scene."""

    level: EnumProperty(items=_items(("ERROR", "WARNING", "NOTE")), name="Level", description="How grave it is")
    object: StringProperty(name="Object", description="The object that it is about; empty: the scene")
    text: StringProperty(name="Text", description="What is wrong, and the rule")


class PliantObject(bpy.types.PropertyGroup):
    """What an object is in the elastic animation, and all its settings."""

    role: _enum("Role", ("NONE", "SURFACE", "FORCE", "GROUP"), "What the object is in the elastic animation")
    # Of surfaces.
    solve: _switched("Solve", True, "Off: the surface stays at rest")
    uv_map: _text("UV Map", "The UV map that is read; empty: the active one")
    driven_by: _object(
        "Driven By", "The surface that this one follows; it is not solved itself then", poll=_is_surface
    )
    rest: EnumProperty(
        **common_of("Rest"),
        description="What the surface is when nothing pushes it",
        items=[
            ("BASE", "Base", "The mesh as modelled, ahead of all modifiers"),
            ("MODIFIERS", "Modifiers", "What the modifiers ahead of pliant's make of it at each frame"),
        ],
    )
    maps: _several("Maps", PliantMap, "Channels of the material that differ over the surface")
    place: IntProperty(default=-1, options={"HIDDEN"})  # of our modifier, in a file that has none
    # Of forces.
    kind: _enum("Kind", FORCE_KINDS, "What the force does")
    falloff_text: _text("Falloff", "A <falloff> of the scene format, for DRAWN")
    aim: EnumProperty(
        **common_of("Aim"),
        description="Where the direction of the force comes from",
        items=[
            ("ROTATION", "Rotation", "The object's local +Z in the world"),
            ("VECTOR", "Vector", "The vector below, in the space of the parent"),
        ],
    )
    end: _object("End", "The other end of a line")
    group: _object("Group", "The group whose region it shares", poll=_is_group)
    follow: _object(
        "Follow", "The surface in whose object space its place and direction are; empty: the world", poll=_is_surface
    )
    targets: _several("Targets", PliantTarget, "The surfaces that it acts on; none: all of the scene")


def _rows_of_objects() -> Iterator[Tuple[str, Any]]:
    surface = TABLE["Surface"]
    for name in (*KEYABLE["SURFACE"], *TANGENTS, "start_frame", "stepping", "reference", "combine", "release",
                 "measure", "integrator", "region", "preroll", "loop", "uv", "wrap", "unit", "axis", "border",
                 "weld"):  # fmt: skip
        yield name, surface[name]
    for name in ("enabled", "magnitude", "deformation_radius", "force_radius", "falloff", "direction", "along"):
        yield name, TABLE["Point"][name]
    yield "pull", TABLE["Vortex"]["pull"]
    for name in ("frequency", "rate", "seed"):
        yield name, TABLE["Noise"][name]


def _switch(name: str) -> Any:
    text = f"Whether {_label(name).lower()} is given"
    return BoolProperty(**{**common_of(f"use_{name}"), "name": f"Use {_label(name)}"}, description=text)


_annotate(
    PliantObject,
    {name: _from_row(name, row) for name, row in _rows_of_objects()}
    | {switch: _switch(name) for name, switch in SWITCHED.items()}
    | {
        name: _enum(_label(name), map(word, TABLE["Surface"]["edges"].words), "What holds this edge of a grid")
        for name in EDGES
    },
)


class Shown:
    """What a run tells of a scene; live.py sets it."""

    frames_ready = 0
    status = ""


shown_of: Dict[str, Shown] = {}


def _frames_ready(group: Any) -> int:
    return shown_of.get(group.id_data.name, Shown).frames_ready


def _status(group: Any) -> str:
    return shown_of.get(group.id_data.name, Shown).status


class PliantScene(bpy.types.PropertyGroup):
    """The elastic animation of a scene."""

    live: _switched("Live", True, "Surfaces show what forces do to them; off: they are at rest")
    frame_start: _whole("Start", 1, "First frame of the animation")
    frame_end: _whole("End", 250, "Last frame of the animation")
    seed: _whole("Seed", 0, "Seed of the noise forces")
    origin: _object("Origin", "The object in whose space coordinates are; empty: the world")
    show_overlay: BoolProperty(
        name="Forces", default=True, description="Draw radii and arrows of forces in the view", override=OVERRIDABLE
    )
    show_region: BoolProperty(
        name="Region", default=True, description="Draw the part of a surface that is solved", override=OVERRIDABLE
    )
    version: IntProperty(default=VERSION, options={"HIDDEN"})
    frames_ready: IntProperty(
        name="Frames Ready", options={"SKIP_SAVE"}, get=_frames_ready, description="How many frames are there"
    )
    status: StringProperty(name="Status", options={"SKIP_SAVE"}, get=_status, description="What is being done")
    messages: CollectionProperty(
        type=PliantMessage, name="Messages", options={"SKIP_SAVE"}, description="What is wrong, and what to know"
    )


CLASSES = (PliantTarget, PliantMap, PliantMessage, PliantObject, PliantScene)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.pliant = PointerProperty(type=PliantObject, name="pliant", override=OVERRIDABLE)
    bpy.types.Scene.pliant = PointerProperty(type=PliantScene, name="pliant", override=OVERRIDABLE)


def unregister() -> None:
    del bpy.types.Object.pliant
    del bpy.types.Scene.pliant
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
