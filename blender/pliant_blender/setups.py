"""Set-ups that move at once, materials by their look, and numbers for a motion that is wanted."""

from __future__ import annotations

import copy
import os
from math import pi, sqrt
from typing import Any, Dict, NamedTuple, Optional, Tuple

import bpy
import numpy as np
from bl_operators.presets import AddPresetBase
from bpy.props import EnumProperty, FloatProperty

from . import edit, fcurves, pliant, properties
from .edit import Edit, Refused

# Materials. The numbers, and the rule that fits them to a surface, are those of `pliant new --material`:
# docs/materials.md, and cli/commands/materials.cpp of the project.


class Look(NamedTuple):
    """A material as it looks, whatever the size of the surface."""

    summary: str
    frequency: float  #: of the slowest vibration of what moves [Hz]
    damping_ratio: float  #: of that vibration
    softness: float = 1  #: the peak, over that with the material before
    c: float = 2  #: if b is 1
    d: float = 1
    poisson: float = 0.3
    give: float = 0  #: by how much the peak grows because it yields; 0: it is elastic
    hardening: float = 0


LOOKS: Dict[str, Look] = {
    "RUBBER": Look("springs back, and rings for a few swings", 3.5, 0.1, poisson=0.5),
    "JELLY": Look("soft and heavy: sags deep and wobbles for seconds", 2, 0.04, 1.6, poisson=0.5),
    "METAL": Look("stiff: gives little, trembles fast, and keeps a dent", 7, 0.03, 0.6, give=0.35, hardening=0.1),
    "CLOTH": Look("limp: gives way, swings back slowly, and does not ring", 1.2, 0.6, 1.4, c=0.4, poisson=0),
    "PAPER": Look(
        "light: flutters shortly, and keeps a crease", 5, 0.3, 0.8, 1.7, 0.7, poisson=0.2, give=0.12, hardening=0.5
    ),
    "SKIN": Look("gives way, and comes back slowly without ringing", 2.5, 0.7, 1.2, poisson=0.45),
}


def _rounded(number: float) -> float:
    """Three digits, as a person would write it."""
    return float(f"{number:.3g}")


def _wear(surface: Any, look: Look, density: float, stiffness: float, bend: float = 0) -> None:
    surface.density, surface.damping, surface.damping_ratio = _rounded(density), 1, look.damping_ratio
    surface.b, surface.c, surface.d = (_rounded(each * stiffness) for each in (1, look.c, look.d))
    surface.poisson = look.poisson
    surface.yield_ = _rounded(bend) if bend > 0 else None
    surface.hardening = look.hardening if bend > 0 else 0.1


def _is_worn(surface: Any, look: Look) -> bool:
    """Whether a surface looks like this, by the numbers that its size does not change."""
    numbers = [surface.damping_ratio, surface.b, surface.c, surface.d, surface.poisson]
    if any(each is None or isinstance(each, pliant.Curve) for each in numbers) or not surface.b:
        return False
    found = numbers[0], surface.c / surface.b, surface.d / surface.b, surface.poisson, float(surface.yield_ is not None)
    wanted = look.damping_ratio, look.c, look.d, look.poisson, float(look.give > 0)
    return bool(np.allclose(found, wanted, rtol=0.02, atol=1e-6))


class Facts(NamedTuple):
    """What a surface does under all its forces."""

    frequency: float  #: of the slowest vibration of what moves [Hz]; 0: nothing holds it
    reach: float  #: half the width of what moves [uv]
    is_held: bool
    rings: bool  #: False: it creeps


def _look_at(scene: Any, name: str) -> Optional[Facts]:
    """None: nothing is selected. Raises Refused where nothing moves, or too much does."""
    scene = _until(scene, 0)
    found = next((each for each in pliant.preview(scene) if each.surface == name and each.of == "all"), None)
    if found is None or found.frame is None:
        return None
    if not found.is_solvable:
        raise Refused(f"{name}: no vertex that forces select can move: all are on the border")
    frequencies = [each.first_frequency for each in found.regions if each.has_vibration and each.first_frequency > 0]
    if not frequencies and found.is_held:
        raise Refused(f"{name}: too many vertices would move for its frequency to be found")
    part, shape = scene[name], pliant.Simulation(scene).shape(name)
    if found.selected is not None and shape.grid is not None:
        i0, i1, j0, j1 = found.selected
        reach = min((i1 - i0) * shape.grid.hu, (j1 - j0) * shape.grid.hv) / 2
    elif part.region == "all":
        reach = 0.5
    else:
        radii = [each.deformation_radius for each in scene.forces]
        reach = max(each(found.frame) if isinstance(each, pliant.Curve) else each for each in radii) / shape.unit[0]
    rings = all(each.damping_ratio < 1 for each in found.regions)
    return Facts(min(frequencies, default=0), reach, found.is_held, rings)


def _until(scene: Any, frames: float) -> Any:
    """The scene until so many frames after its last key, if it has a last one."""
    last = scene.start + 1
    for part in (*scene.surfaces, *scene.forces, *scene.groups):
        if isinstance(getattr(part, "cache", ""), np.ndarray) or isinstance(part, pliant.Noise):
            return scene
        for value in part.__dict__.values():
            if isinstance(value, pliant.Path):
                return scene
            if isinstance(value, pliant.Curve):
                if (value.before, value.after) != ("hold", "hold") or value.loop:
                    return scene
                last = max(last, value.keys[-1].frame)
    short = copy.copy(scene)
    short.end = int(min(scene.end, np.ceil(last + frames)))
    return short


def _peak(scene: Any, name: str, facts: Facts, most: float = np.inf) -> float:
    """How far the surface moves in the animation, or further than `most` as soon as it does."""
    if facts.rings:  # within its first swings it is farthest
        scene = _until(scene, 2 * scene.fps / facts.frequency)
    peak = 0.0
    simulation = pliant.Simulation(scene, threads=os.cpu_count() or 1)
    for frame in simulation.frames:
        peak = max(peak, simulation.at(frame)[name].peak_displacement)
        if peak > most:
            break
    return peak


def _pushed(scene: Any, name: str) -> Any:
    """The surface under a push in its middle, in place of forces that do not move it."""
    pushed = copy.copy(scene)
    points = pliant.Simulation(scene).at(scene.start)[name].positions()
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high - low).max())
    middle = points[np.argmin(((points - (low + high) / 2) ** 2).sum(axis=1))]
    pushed.end = pushed.start + 1
    pushed.surfaces, pushed.groups = [copy.copy(scene[name])], []
    pushed.forces = [pliant.Point("push", center=tuple(middle), direction=(0, 0, 1), magnitude=1,
                                  deformation_radius=0.45 * size, force_radius=0.22 * size)]  # fmt: skip
    return pushed


def _tried(scene: Any, name: str) -> Tuple[Any, Facts, float]:
    """The scene or, where nothing moves the surface, one that does; what it does, and its peak."""
    for tried in (scene, None):
        tried = tried or _pushed(scene, name)
        facts = _look_at(tried, name)
        peak = _peak(tried, name, facts) if facts and facts.is_held else 0
        if peak > 0:
            return tried, facts, peak
        if facts and not facts.is_held and tried is not scene:
            raise Refused(f"{name}: nothing holds it, since it has no border: give it a goal in its material")
    raise Refused(f"{name}: no vertex of it can move")


def _round(scene: Any, surface: Any) -> None:
    """Reads a grid as a surface, so that what stays bent is round, with a unit with which all numbers carry over."""
    shape = pliant.Simulation(scene).shape(surface.name)
    if shape.grid is not None and isinstance(surface.shape, pliant.Mesh) and surface.unit is None:
        columns, rows = shape.grid.columns, shape.grid.rows
        nodes = np.empty((rows * columns, 3))
        nodes[np.array(shape.vertex_nodes)] = surface.shape.positions
        nodes = nodes.reshape(rows, columns, 3)
        steps = (np.linalg.norm(np.diff(nodes, axis=axis), axis=2).mean() for axis in (1, 0))
        surface.unit = tuple(float(step) / h for step, h in zip(steps, (shape.grid.hu, shape.grid.hv)))
    surface.uv = "surface"


def dress(scene: Any, name: str, look: Look) -> Any:
    """Finds the numbers with which a surface looks so, at its size and with its forces: a part that has them."""
    scene = copy.copy(scene)
    scene.surfaces = [copy.copy(each) for each in scene.surfaces]
    surface = scene[name]
    if surface.damping_ratio is not None:
        surface.damping = 1
    if surface.density == 0:  # or there is no frequency to begin with
        surface.density = 1
    scene, _, own = _tried(scene, name)
    surface = scene[name]
    before = next((each for each in LOOKS.values() if _is_worn(surface, each)), None)
    if before:  # so that one look after another comes out as if it were the first
        own /= before.softness * (1 + before.give)
    if look.give and surface.region == "forces":
        _round(scene, surface)
    # A density and a stiffness of 1 show what others make: the squared frequency and the peak are
    # proportional to 1 / density and 1 / stiffness, as long as nothing yields.
    _wear(surface, look, 1, 1)
    facts = _look_at(scene, name)
    density, stiffness = (facts.frequency / look.frequency) ** 2, 1.0
    _wear(surface, look, density, stiffness)
    facts = facts._replace(frequency=look.frequency, rings=True)
    peak = _peak(scene, name, facts)
    if not any(isinstance(each, pliant.Inertia) for each in scene.forces):  # whose load is the density's
        stiffness = peak / (look.softness * own)
        density *= stiffness
        peak = look.softness * own
    bend = 0.0
    if look.give:
        bend = peak / facts.reach**2 * sqrt(stiffness)
        low, high = 0.5 * bend, 16 * bend
        for _ in range(6):
            bend = sqrt(low * high)
            _wear(surface, look, density, stiffness, bend)
            most = (1 + look.give) * peak
            try:
                is_too_low = _peak(scene, name, facts, most) > most
            except (pliant.SolverFailed, pliant.NotFinite):
                is_too_low = True
            low, high = (bend, high) if is_too_low else (low, bend)
        bend = high
    _wear(surface, look, density, stiffness, bend)
    return surface


MATERIAL = ("density", "damping_ratio", "b", "c", "d", "poisson", "yield_", "hardening")


def _set_plain(owner: Any, name: str, value: Any) -> None:
    """Sets a property in place of what moved it."""
    fcurves.remove(owner, f"pliant.{name}")
    switch = properties.SWITCHED.get(name)
    if switch:
        setattr(owner.pliant, switch, value is not None)
    if value is not None:
        setattr(owner.pliant, name, value)


class PLIANT_OT_material(Edit, bpy.types.Operator):
    """Gives the active surface a material by its look, with numbers that suit its size and its forces"""

    bl_idname, bl_label = "pliant.material", "Material"

    preset: EnumProperty(
        name="Material", description="What the surface should look like",
        items=[(name, name.title(), look.summary) for name, look in LOOKS.items()],
    )  # fmt: skip

    @classmethod
    def missing(cls, context: Any) -> str:
        return edit.no_surface(context)

    def act(self, context: Any) -> None:
        owner = edit.surface_of(context)
        edit.check_editable(owner)
        if any((f"pliant.{name}", 0) in fcurves.table(owner.animation_data) for name in MATERIAL):
            edit.check_keys(owner)
        found = edit.translated(context.scene)
        part = found.scene[found.part_of[owner.name]]
        if part.integrator == "backwardEuler":
            # Whose steps damp more than most looks do.
            part.integrator = "newmark"
        worn = dress(found.scene, part.name, LOOKS[self.preset])
        for name in MATERIAL:
            _set_plain(owner, name, getattr(worn, name))
        owner.pliant.integrator = properties.word(worn.integrator)
        if worn.uv != part.uv:
            owner.pliant.uv = properties.word(worn.uv)
            owner.pliant.unit = worn.unit or (0, 0)


class PLIANT_OT_add_material_preset(AddPresetBase, bpy.types.Operator):
    """Keeps the material of the active surface as a preset of one's own, or removes one"""

    bl_idname, bl_label = "pliant.add_material_preset", "Material Preset"
    preset_menu = "PLIANT_MT_material_presets"
    preset_subdir = "pliant/material"
    preset_defines = ["own = bpy.context.view_layer.objects.active.pliant"]
    preset_values = [f"own.{name}" for name in (*MATERIAL, "damping", "goal", "use_damping_ratio", "use_yield")]

    @classmethod
    def poll(cls, context: Any) -> bool:
        owner = edit.active(context)
        if owner and properties.role(owner) == "SURFACE":
            return True
        cls.poll_message_set("select a surface")
        return False


class PLIANT_MT_material_presets(bpy.types.Menu):
    """Materials that were kept"""

    bl_label = "Own Materials"
    preset_subdir = "pliant/material"
    preset_operator = "script.execute_preset"
    draw = bpy.types.Menu.draw_preset


# Numbers for a motion.


class PLIANT_OT_suggest(Edit, bpy.types.Operator):
    """Finds magnitudes, density and damping with which the surface moves as wanted"""

    bl_idname, bl_label = "pliant.suggest", "Suggest"

    peak: FloatProperty(
        name="Peak", unit="LENGTH", soft_min=0.0, soft_max=10.0,
        description="The largest displacement in the animation; 0: magnitudes stay",
    )  # fmt: skip
    settling: FloatProperty(
        name="Settling", unit="TIME_ABSOLUTE", soft_min=0.0, soft_max=10.0,
        description="When it has come to rest, in seconds; 0: damping stays",
    )  # fmt: skip
    frequency: FloatProperty(
        name="Frequency", soft_min=0.0, soft_max=12.0,
        description="How many times a second it swings; 0: density stays",
    )  # fmt: skip

    @classmethod
    def missing(cls, context: Any) -> str:
        return "" if edit.force_of(context) else edit.no_surface(context)

    def act(self, context: Any) -> None:
        force = edit.force_of(context)
        owner = force or edit.surface_of(context)
        found = edit.translated(context.scene)
        goals = {name: getattr(self, name) for name in ("peak", "settling", "frequency") if getattr(self, name)}
        if not goals:
            raise Refused("give a goal: a peak, when it settles, or a frequency", owner)
        kind = "force" if force else "surface"
        told = pliant.suggest(found.scene, **goals, **{kind: found.part_of[owner.name]})
        changes, known = [], set()
        for each in told.values:
            if each.after != each.before:
                part, name = each.path.rsplit(".", 1)
                name = {"dampingRatio": "damping_ratio"}.get(name, name)
                target = bpy.data.objects[found.object_of[part]]
                edit.check_editable(target)
                curve = edit.scalable(target, name, each.keys > 0)
                place = curve.as_pointer() if curve else (target.name, name)
                if place not in known:  # or two forces share an action
                    changes.append((target, name, curve, each.before, each.after))
                known.add(place)
        for change in changes:
            edit.rescale(*change)
        for goal in (told.peak, told.settling, told.frequency):
            if goal and goal.obstacle:
                self.tell("WARNING", owner.name, goal.reason)
        for text in told.notes:
            self.tell("NOTE", owner.name, text)


# Set-ups: those of `pliant new`, two units wide, with z up.


class Push(NamedTuple):
    """A force of a set-up."""

    name: str
    kind: str
    values: Dict[str, Any]
    magnitude: Tuple[Any, ...]  #: keys: frame, value, and whether it is a rest on the way
    location: Any = (0.0, 0.0, 0.0)  #: or keys: frame, place
    turn: float = 0.0  #: about x
    between: str = "linear"  #: keys of the location
    around: str = "hold"  #: and ahead of them and behind


class Setup(NamedTuple):
    """A sheet and its forces."""

    summary: str
    size: Tuple[int, int, float, float]  #: columns, rows, width, depth
    values: Dict[str, Any]  #: of the surface
    forces: Tuple[Push, ...]
    turn: float = 0.0


_whole = {"integrator": "NEWMARK", "measure": "REST", "region": "ALL", "use_damping_ratio": True}
_blow = {"deformation_radius": 0.3125, "force_radius": 0.1625, "falloff": "SMOOTH"}


def _bump(start: int, half: int, height: float) -> Tuple[Any, ...]:
    return (start, 0.0, True), (start + half, height, True), (start + 2 * half, 0.0, True)


def _wind(strength: float) -> Tuple[Any, ...]:
    return (1, 0.0, False), (15, strength, True), (70, strength, False), (85, 0.0, False)


def _gust(name: str, start: int, side: int) -> Push:
    """It runs from the pole to the free end, again and again."""
    way = (start, (-1.333, 0.0, 0.222 * side)), (start + 24, (1.556, 0.0, -0.222 * side))
    values = {"force_radius": 0.71, "falloff": "SMOOTH"}
    return Push(name, "POINT", values, _wind(26.7), way, turn=side * pi / 2, around="repeat")


SETUPS: Dict[str, Setup] = {
    "POKE": Setup(
        "A finger presses a sheet, holds it, and lets go",
        (49, 49, 2.0, 2.0),
        {"density": 12, "damping_ratio": 0.1, **_whole, "region": "FORCES"},
        (Push("Finger", "POINT", {"deformation_radius": 0.83, "force_radius": 0.25, "falloff": "SMOOTH"},
              ((1, 0.0, False), (12, 4200.0, True), (33, 4200.0, False), (36, 0.0, False))),),
    ),
    "TRAMPOLINE": Setup(
        "A ball that nobody sees jumps on a mat, five times, each time lower",
        (49, 49, 2.0, 2.0),
        {"density": 4, "damping_ratio": 0.12, **_whole},
        (Push("Ball", "POINT", {"force_radius": 0.4, "falloff": "SMOOTH"},
              (*_bump(6, 4, 1600.0), *_bump(36, 4, 1450.0), *_bump(60, 4, 1250.0), *_bump(79, 4, 900.0),
               *_bump(94, 4, 550.0)),
              ((1, (0.0, 0.0, 0.0)), (33, (0.225, -0.125, 0.0)), (55, (-0.15, 0.1, 0.0))), turn=pi, between="step"),),
    ),
    "FLAG": Setup(
        "A breeze bows a flag, gusts run through it, and it calms down",
        (61, 41, 2.0, 1.333),
        {"density": 3, "damping_ratio": 0.3, "c": 1, **_whole, "edge_u1": "FREE", "edge_v0": "FREE", "edge_v1": "FREE"},
        (
            Push("Breeze", "UNIFORM", {}, _wind(0.444), turn=pi / 2),
            _gust("Gust", 1, 1),
            _gust("Lull", 13, -1),
            Push("Flutter", "NOISE", {"frequency": 1.0, "rate": 1.6, "force_radius": 8.9, "use_seed": True, "seed": 3},
                 _wind(3.33), ((1, (0.0, 0.0, 0.0)), (120, (8.9, 0.0, 0.0)))),
        ),
        turn=pi / 2,
    ),
    "DENT": Setup(
        "Three blows leave three dents in a panel of sheet metal",
        (81, 61, 2.0, 1.5),
        {"damping": 3, "use_yield": True, "yield_": 10, "uv": "SURFACE", "unit": (2.0, 1.5)},
        tuple(
            Push(name, "POINT", _blow,
                 ((start, 0.0, False), (start + 6, 20500.0, True), (start + 12, 0.0, False)), place, pi)
            for name, start, place in (
                ("First", 6, (-0.65, 0.125, 0.0)), ("Second", 24, (0.0, -0.15, 0.0)), ("Third", 42, (0.65, 0.125, 0.0))
            )
        ),
    ),
}  # fmt: skip


def _animate(owner: Any, path: str, curve: Any, size: int) -> None:
    first, last = int(curve.keys[0].frame), int(curve.keys[-1].frame)
    fcurves.write(owner, path, curve, size=size, first=first, last=last, name=path)


def _push(context: Any, push: Push, at: Any, offset: int) -> None:
    is_moved = isinstance(push.location[0], tuple)
    owner = edit.empty(context, push.name, at + np.array((0, 0, 0) if is_moved else push.location), push.kind)
    owner.rotation_euler = push.turn, 0, 0
    edit.make_force(owner, push.kind)
    for name, value in push.values.items():
        setattr(owner.pliant, name, value)
    owner.empty_display_size = min(push.values.get("force_radius", 0.5), 0.5)
    keys = [pliant.Key(frame + offset, value, tangent="flat") if is_flat else (frame + offset, value)
            for frame, value, is_flat in push.magnitude]  # fmt: skip
    _animate(owner, "pliant.magnitude", pliant.Curve(keys), 1)
    if is_moved:
        keys = [pliant.Key(frame + offset, tuple(at + np.array(place)), interpolation=push.between)
                for frame, place in push.location]  # fmt: skip
        _animate(owner, "location", pliant.Curve(keys, before=push.around, after=push.around), 3)


def _jiggle(context: Any, owner: Any) -> None:
    """The active mesh lags behind its bones and its own motion."""
    own = owner.pliant
    for name, value in {**_whole, "rest": "MODIFIERS", "damping_ratio": 0.07, "density": 1.0}.items():
        setattr(own, name, value)
    at, size = owner.matrix_world.translation, edit.size_of(owner)
    force = edit.empty(context, "Inertia", at, "INERTIA")
    edit.make_force(force, "INERTIA")
    force.pliant.targets.add().surface = owner
    force.empty_display_size = size / 4


def _ring(context: Any, owner: Any, frequency: float) -> None:
    """The density with which a surface rings so often in a second, and a goal if nothing else holds it."""
    found = edit.translated(context.scene)
    name = found.part_of[owner.name]
    scene = _pushed(found.scene, name)
    facts = _look_at(scene, name)
    if not facts.is_held:
        # About as strong as a border.
        owner.pliant.goal = scene[name].goal = 400
        facts = _look_at(scene, name)
    owner.pliant.density = _rounded((facts.frequency / frequency) ** 2)


class PLIANT_OT_add_setup(Edit, bpy.types.Operator):
    """Adds a surface and forces that move at once, to begin with"""

    bl_idname, bl_label = "pliant.add_setup", "Set-up"

    kind: EnumProperty(
        name="Set-up", description="What to begin with",
        items=[
            *((name, name.title(), setup.summary) for name, setup in list(SETUPS.items())[:2]),
            ("JIGGLE", "Jiggle", "The active mesh lags behind its own motion and that of its modifiers, and wobbles"),
            *((name, name.title(), setup.summary) for name, setup in list(SETUPS.items())[2:]),
        ],
    )  # fmt: skip

    def act(self, context: Any) -> None:
        if self.kind == "JIGGLE":
            owner = edit.active(context)
            if owner is None or owner.type != "MESH":
                raise Refused("Jiggle is for the active mesh, and the active object is none", owner)
            edit.check_editable(owner)
            edit.check_mesh(owner, "")
            edit.make_surface(context.scene, owner)
            _jiggle(context, owner)
            try:
                _ring(context, owner, 2.2)
            except (Refused, pliant.Error) as error:
                self.tell("WARNING", owner.name, f"its density is the default: {edit.text_of(error)}")
            return
        setup, at = SETUPS[self.kind], np.array(context.scene.cursor.location)
        mesh = edit.sheet(self.kind.title(), *setup.size)
        sheet = edit.place(context, self.kind.title(), mesh, at)
        sheet.rotation_euler = setup.turn, 0, 0
        edit.make_surface(context.scene, sheet)
        for name, value in setup.values.items():
            setattr(sheet.pliant, name, value)
        for push in setup.forces:
            _push(context, push, at, context.scene.pliant.frame_start - 1)
            # The set-up is alone, also beside another.
            edit.active(context).pliant.targets.add().surface = sheet


CLASSES = (
    PLIANT_OT_material, PLIANT_OT_add_material_preset, PLIANT_MT_material_presets, PLIANT_OT_suggest,
    PLIANT_OT_add_setup,
)  # fmt: skip


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
