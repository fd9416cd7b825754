"""What makes and takes away surfaces, forces and groups, and what one force alone does to its surface."""

from __future__ import annotations

import copy
import re
from typing import Any, Dict, List, Optional, Tuple

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty

from . import blender_curves, fcurves, live, meshes, pliant, properties, translate
from .properties import CLASS_OF, FORCE_KINDS, TABLE, role


class Refused(Exception):
    """Why an operator does nothing: the reason, and the object that it is about."""

    def __init__(self, text: str, owner: Any = None):
        super().__init__(text)
        self.object = owner.name if owner else ""


def text_of(error: Exception) -> str:
    """All that is wrong, in one line."""
    problems = [each.message for each in getattr(error, "problems", ())]
    return "; ".join(dict.fromkeys(problems)) or str(error)


class Edit:
    """What all operators have in common: `act` changes the scene, or raises before it has changed anything."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def missing(cls, _context: Any) -> str:
        """What the operator needs and does not find; empty: nothing."""
        return ""

    @classmethod
    def poll(cls, context: Any) -> bool:
        reason = cls.missing(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context: Any) -> set:
        scene, cause = context.scene, type(self).__name__
        # In other modes a mesh cannot be read, and an undo step has that mesh only.
        mode = set_mode(context, "OBJECT")
        context.view_layer.update()  # scripts may have moved what counts
        self.problems: List[Any] = []
        if live.session_of(scene):
            live.tell(scene, cause, [])
        if context.window:
            context.window.cursor_set("WAIT")
        try:
            self.act(context)
            done = {"FINISHED"}
        except (Refused, pliant.Error) as error:
            set_mode(context, mode)
            self.tell("ERROR", getattr(error, "object", ""), text_of(error))
            done = {"CANCELLED"}
        finally:
            if context.window:
                context.window.cursor_set("DEFAULT")
        if self.problems:
            live.tell(scene, cause, self.problems)
        if done == {"FINISHED"}:
            live.refresh(scene)
        return done

    def tell(self, level: str, owner: str, text: str) -> None:
        """Tells a user in a report, and in the list of messages until the operator is called again."""
        self.problems.append(translate.Problem(level, owner, text))
        self.report({"INFO" if level == "NOTE" else level}, text)

    def act(self, context: Any) -> None:
        raise NotImplementedError


# What an operator acts on. A script has no window, so the view layer is asked and not the area.


def active(context: Any) -> Any:
    return context.view_layer.objects.active


def selected(context: Any) -> List[Any]:
    return list(context.view_layer.objects.selected)


def surfaces(scene: Any) -> List[Any]:
    return [each for each in scene.objects if role(each) == "SURFACE"]


def surface_of(context: Any) -> Any:
    """The active surface, else the only one; None: there is none, or there are several."""
    owner = active(context)
    if owner and role(owner) == "SURFACE":
        return owner
    found = surfaces(context.scene)
    return found[0] if len(found) == 1 else None


def force_of(context: Any) -> Any:
    owner = active(context)
    return owner if owner and role(owner) == "FORCE" else None


def no_object(context: Any) -> str:
    return "" if active(context) else "select an object"


def no_surface(context: Any) -> str:
    return "" if surface_of(context) else "select a surface: none is active, nor is there a single one"


def no_force(context: Any) -> str:
    return "" if force_of(context) else "select a force: the active object is none"


def check_editable(owner: Any) -> None:
    if owner.library or (owner.override_library and owner.override_library.is_system_override):
        raise Refused(f"{owner.name}: it is linked; make a library override that can be edited", owner)


def check_keys(owner: Any) -> None:
    """Raises Refused if keys that an operator changes would be lost with the session."""
    animation = owner.animation_data
    if animation and animation.action and animation.action.library:
        raise Refused(f"{owner.name}: its action is linked, and cannot be changed; make it local", owner)


def check_mesh(owner: Any, uv_map: str) -> None:
    """Raises Refused for a mesh that cannot be a surface."""
    try:
        mesh = meshes.read(owner.data, uv_map, True)
        pliant.Simulation(pliant.Scene(start=1, end=1, surfaces=[pliant.Surface("mesh", shape=mesh)]))
    except pliant.Error as error:
        raise Refused(f"{owner.name}: {text_of(error)}", owner) from error


def size_of(owner: Any) -> float:
    """The largest dimension of a mesh as modelled, in the world."""
    points = meshes.positions(owner.data).astype(float)
    if not len(points):
        raise Refused(f"{owner.name}: the mesh has no vertices", owner)
    return float(np.max(np.ptp(points, axis=0) * np.abs(owner.matrix_world.to_scale())))


# Making.


def first_surface(scene: Any) -> bool:
    """To be called ahead of making a surface: the first one takes over the scene's frames. Whether it is the first."""
    is_first = not surfaces(scene)
    if is_first:
        match_range(scene)
    return is_first


def match_range(scene: Any) -> None:
    scene.pliant.frame_start, scene.pliant.frame_end = scene.frame_start, scene.frame_end


def set_mode(context: Any, mode: str) -> str:
    """Sets the mode of the active object; returns what it was."""
    owner = active(context)
    before = owner.mode if owner else "OBJECT"
    if before != mode:
        with live.overriding(owner):
            bpy.ops.object.mode_set(mode=mode)
    return before


def place(context: Any, name: str, data: Any, location: Any) -> Any:
    """A new object in the active collection, active and alone selected."""
    layer = context.view_layer
    made = bpy.data.objects.new(name, data)
    made.location = location
    at = layer.active_layer_collection
    hidden = at.exclude or at.collection.library
    (context.scene.collection if hidden else at.collection).objects.link(made)
    for each in selected(context):
        each.select_set(False)
    made.select_set(True)
    layer.objects.active = made
    return made


# What an empty is shown as, by the kind of its force.
_shapes = {"RADIAL": "SPHERE", "NOISE": "CUBE", "INERTIA": "PLAIN_AXES", "PRESSURE": "CIRCLE", "GROUP": "SPHERE"}


def empty(context: Any, name: str, location: Any, kind: str) -> Any:
    made = place(context, name, None, location)
    made.empty_display_type = _shapes.get(kind, "SINGLE_ARROW")
    return made


def sheet(name: str, columns: int, rows: int, width: float, depth: float) -> Any:
    """A mesh of quads that faces +z: u along x, v along y, vertex j * columns + i is node (i, j)."""
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    uvs = np.column_stack([u.ravel(), v.ravel()])
    points = np.column_stack([(uvs - 0.5) * (width, depth), np.zeros(len(uvs))])
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    faces = np.column_stack([first, first + 1, first + columns + 1, first + columns])
    made = bpy.data.meshes.new(name)
    meshes.fill(made, pliant.Mesh(points, faces, uvs))
    made.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    return made


def make_surface(scene: Any, owner: Any) -> None:
    first_surface(scene)
    owner.pliant.role = "SURFACE"


def make_force(owner: Any, kind: str) -> None:
    """Gives an object the role, with the defaults that this kind has in the format."""
    own = owner.pliant
    own.role, own.kind = "FORCE", kind
    own.magnitude = TABLE[kind.capitalize()]["magnitude"].standard


def make_end(context: Any, owner: Any, length: float) -> None:
    """The other end of a line, which must not take its selection."""
    end = bpy.data.objects.new(f"{owner.name}.end", None)
    end.empty_display_type, end.empty_display_size = "PLAIN_AXES", 0.25
    end.location = owner.matrix_world.translation if owner.parent else owner.location
    end.location.x += length
    for collection in owner.users_collection:
        collection.objects.link(end)
    owner.pliant.end = end


# What a force alone does, once the surface has come to rest.

_most_frames = 240
_tries = 10


def _frozen(part: Any, frame: float) -> Any:
    """A copy of a part with the values that its channels have at a frame."""
    part = copy.copy(part)
    for name, value in part.__dict__.items():
        if isinstance(value, pliant.Curve) and name != "falloff":
            value = value(frame)
            setattr(part, name, tuple(value) if np.ndim(value) else bool(value) if name == "enabled" else float(value))
    return part


def alone(scene: Any, name: str, frame: float, surface: str = "") -> Any:
    """The surfaces, or one of them, under the force of that name only, as it is at a frame."""
    force = _frozen(scene[name], frame)
    if isinstance(force, pliant.Noise):
        force.rate = 0
    groups = [_frozen(each, frame) for each in scene.groups if each.name == force.group]
    acting = [force, *groups]
    wanted = [set(each.targets) for each in acting if each.targets] + [{surface}] * bool(surface)
    still = pliant.Scene(fps=scene.fps, start=1, end=_most_frames, seed=scene.seed)
    for part in scene.surfaces:
        if not part.enabled or part.driven_by or not all(part.name in names for names in wanted):
            continue
        part = _frozen(part, frame)
        if isinstance(part.cache, np.ndarray):
            at = int(np.clip(frame - (part.cache_start or 0), 0, len(part.cache) - 1))
            part.cache, part.cache_start = part.cache[at : at + 1], 1
        part.su0 = part.su1 = part.sv0 = part.sv1 = part.preroll = 0
        part.loop = part.start_frame = None
        # Where it settles does not depend on how fast it swings: as fast as the default material.
        if part.density > 0:
            if part.damping_ratio is None:
                part.damping *= np.sqrt(part.b / part.density)
            part.density = part.b
        part.integrator, part.stepping, part.dt, part.time_scale = "backwardEuler", "exact", 0.01, 1
        still.surfaces.append(part)
    for each in acting:
        each.enabled, each.targets = True, ()
    still.forces, still.groups = [force], groups
    if not still.surfaces:
        raise Refused(f"{name} acts on no surface that is solved")
    simulation = pliant.Simulation(still)
    for part in still.surfaces:
        if part.measure is None:
            part.measure = "current" if simulation.shape(part.name).grid is not None else "rest"
    return still


def settled(still: Any, magnitude: float) -> float:
    """How far the force of `alone` moves a vertex, at rest; infinite: it does not come to rest."""
    still.forces[0].magnitude = magnitude
    simulation = pliant.Simulation(still)
    heights: List[float] = []
    # At rest nothing moves for a second; what has no inertia is at rest at once.
    quiet = 2 if all(each.density == 0 == each.damping for each in still.surfaces) else int(np.ceil(still.fps))
    for frame in range(still.start + 1, still.end + 1):
        heights.append(max(each.peak_displacement for each in simulation.at(frame).values()))
        last = heights[-quiet:]
        if len(last) == quiet and np.ptp(last) <= 1e-4 * last[-1]:
            return last[-1]
    return float(np.mean(last)) if np.ptp(last) <= 0.02 * np.mean(last) else np.inf


def at_rest(still: Any) -> Any:
    """The same, for forces that keep pushing the same vertices and without inertia: at rest at once."""
    found = copy.copy(still)
    found.surfaces = [copy.copy(each) for each in still.surfaces]
    for part in found.surfaces:
        part.density, part.damping, part.damping_ratio, part.dt = 0, 0, None, 1
        part.measure, part.yield_ = "rest", None
        part.maps = [each for each in part.maps if each.channel in ("b", "c", "d", "goal")]
    return found


def magnitude_for(still: Any, height: float) -> float:
    """The magnitude with which the force of `alone` moves a vertex by `height`. Raises Refused if none does."""
    force = still.forces[0]
    found = settled(at_rest(still), 1.0)
    if not found > 0:
        has_place = hasattr(force, "center") or hasattr(force, "from_")
        near = "no vertex that can move is nearer than its radii"
        whole = "a surface that it moves as a whole needs a border or a goal to hold it"
        raise Unreached(f"{force.name} moves nothing: {near if has_place else whole}")
    magnitude = height / found
    if all(each.measure == "rest" and each.yield_ is None for each in still.surfaces):
        return magnitude  # it is proportional
    # As the surface moves, vertices leave the reach of the force, or come into it.
    tried: List[Tuple[float, float]] = []
    low, high = 0.0, np.inf
    for _ in range(_tries):
        found = settled(still, magnitude)
        tried.append((found, magnitude))
        if abs(found - height) <= 2e-3 * height:
            break
        low, high = (magnitude, high) if found < height else (low, magnitude)
        magnitude *= min(max(height / found, 0.25), 4) if found > 0 else 2
        if not low < magnitude < high:
            magnitude = (low + high) / 2 if np.isfinite(high) else 2 * low
    found, magnitude = min(tried, key=lambda each: abs(each[0] - height))
    if abs(found - height) > 0.015 * height:
        raise Unheld(force.name, height, magnitude)
    return magnitude


class Unreached(Refused):
    """A force is too far away, or has no effect."""


class Unheld(Refused):
    """No magnitude holds a surface at a height."""

    def __init__(self, name: str, height: float, magnitude: float):
        super().__init__(f"{name} cannot hold the surface at {height:g}: it moves out of the reach of the force")
        self.magnitude = magnitude  #: the nearest


def translated(scene: Any) -> Any:
    """The whole scene, or Refused with what is wrong with it."""
    found = translate.translate(scene)
    if found.scene is None:
        wrong = next(each for each in found.problems if each.level == "ERROR")
        error = Refused(f"{wrong.object}: {wrong.text}" if wrong.object else wrong.text)
        error.object = wrong.object
        raise error
    return found


def fit(context: Any, owner: Any, surface: Any) -> None:
    """Radii from the size of a surface, and the magnitude that moves it by a tenth of that."""
    scene, own, size = context.scene, owner.pliant, size_of(surface)
    # Beyond its radii a force lets go, of what overshoots too; what it moves along the surface must stay within.
    own.deformation_radius = 0.45 * size
    own.force_radius = (0.45 if own.kind in ("RADIAL", "VORTEX") else 0.39) * size
    if own.kind == "INERTIA":  # which acts as the surface moves
        return
    found = translated(scene)
    still = alone(found.scene, found.part_of[owner.name], scene.frame_current, found.part_of[surface.name])
    try:
        own.magnitude = magnitude_for(still, size / 10)
    except Unheld as error:
        own.magnitude = error.magnitude
        raise
    except Unreached:
        bring(still)
        own.magnitude = magnitude_for(still, size / 10)
        raise Refused(f"{owner.name} is too far away; it fits the nearest place of {surface.name}") from None


def bring(still: Any) -> None:
    """Moves the force of `alone` to the nearest vertex."""
    force = still.forces[0]
    places = [name for name in ("center", "from_", "to") if hasattr(force, name)]
    if not places:
        return
    points = pliant.Simulation(still).at(still.start)[still.surfaces[0].name].positions()
    way = points - np.array(getattr(force, places[0]))
    way = way[np.argmin((way**2).sum(axis=1))]
    for name in places:
        setattr(force, name, tuple(way + getattr(force, name)))


def scalable(owner: Any, name: str, is_moved: bool) -> Optional[Any]:
    """The F-curve of a property, or None where nothing moves it. Raises Refused where something else does."""
    path = f"pliant.{name}"
    curve = fcurves.table(owner.animation_data).get((path, 0))
    reason = ""
    if (path, 0) in fcurves.drivers(owner):
        reason = "a driver moves it"
    elif is_moved:
        reason = fcurves.blockers(owner) or (fcurves.unscalable(curve) if curve else "something else moves it")
    if reason:
        raise Refused(f"{owner.name}: its {name} cannot be scaled: {reason}", owner)
    if is_moved:
        check_keys(owner)
    return curve if is_moved else None


def rescale(owner: Any, name: str, curve: Any, before: float, after: float) -> None:
    """Sets a property; all values of its keys are multiplied, so that `before` becomes `after`."""
    if curve is None:
        setattr(owner.pliant, name, after)
        return
    factor = after / before
    for key in curve.keyframe_points:
        left, right = key.handle_left[1], key.handle_right[1]
        key.co[1] *= factor
        key.amplitude *= abs(factor)
        key.handle_left[1], key.handle_right[1] = left * factor, right * factor
    curve.update()


# Taking away.


def strip(owner: Any, is_all: bool = False) -> None:
    """Takes all that is ours from an object or a scene. `is_all`: from all others too."""
    while hasattr(owner, "modifiers") and (place := translate.ours(owner)) >= 0:
        owner.modifiers.remove(owner.modifiers[place])
    if owner.animation_data:
        _strip_animation(owner, is_all)
    owner.property_unset("pliant")


def _strip_animation(owner: Any, is_all: bool) -> None:
    """Takes what moves our properties, since it would make them again."""
    animation = owner.animation_data
    for curve in list(animation.drivers):
        if curve.data_path.startswith("pliant."):
            animation.drivers.remove(curve)
    for holder in (animation, *(each for track in animation.nla_tracks for each in track.strips)):
        if not holder.action or getattr(holder, "action_slot", True) is None:
            continue
        found = any(each.data_path.startswith("pliant.") for each in blender_curves.fcurves_of(holder))
        is_shared = not is_all and holder.action.users > 1 + holder.action.use_fake_user
        if found and (is_shared or holder.action.library):
            holder.action = holder.action.copy()  # of the others nothing is taken
        for collection in blender_curves.collections_of(holder) if found else ():
            for curve in [each for each in collection if each.data_path.startswith("pliant.")]:
                collection.remove(curve)
    action = animation.action
    if action and not blender_curves.fcurves_of(animation) and action.users == 1 and not action.use_fake_user:
        animation.action = None
        bpy.data.actions.remove(action)
    if not (animation.action or animation.drivers or animation.nla_tracks):
        owner.animation_data_clear()


# Operators.


class PLIANT_OT_add_surface(Edit, bpy.types.Operator):
    """Adds a sheet that forces can move"""

    bl_idname, bl_label = "pliant.add_surface", "Surface"

    name: StringProperty(name="Name", default="Sheet", description="Name of the object")
    columns: IntProperty(
        name="Columns", default=41, soft_min=3, soft_max=501, description="Vertices along x; more: smoother, slower"
    )  # fmt: skip
    rows: IntProperty(
        name="Rows", default=41, soft_min=3, soft_max=501, description="Vertices along y; more: smoother, slower"
    )  # fmt: skip
    width: FloatProperty(name="Width", default=2.0, soft_min=0.0, unit="LENGTH", description="Size along x")
    depth: FloatProperty(name="Depth", default=2.0, soft_min=0.0, unit="LENGTH", description="Size along y")
    location: FloatVectorProperty(name="Location", subtype="TRANSLATION", unit="LENGTH", description="Its middle")

    def act(self, context: Any) -> None:
        for name in ("columns", "rows"):
            if getattr(self, name) < 3:
                raise Refused(f"{name}: {getattr(self, name)} is too few; a surface has at least 3")
        if self.columns * self.rows > 10**8:
            raise Refused(f"{self.columns} columns times {self.rows} rows are more than 10⁸ vertices")
        for name in ("width", "depth"):
            if not getattr(self, name) > 0:
                raise Refused(f"{name}: {getattr(self, name):g} must be above 0")
        mesh = sheet(self.name, self.columns, self.rows, self.width, self.depth)
        make_surface(context.scene, place(context, self.name, mesh, self.location))


class PLIANT_OT_make_surface(Edit, bpy.types.Operator):
    """Makes surfaces of the selected meshes: all of them, or none if one cannot be"""

    bl_idname, bl_label = "pliant.make_surface", "Make Surface"

    uv_map: StringProperty(name="UV Map", description="The UV map that is read; empty: the active one")

    @classmethod
    def missing(cls, context: Any) -> str:
        return "" if any(each.type == "MESH" for each in selected(context)) else "select a mesh"

    def act(self, context: Any) -> None:
        owners = [each for each in selected(context) if each.type == "MESH"]
        for owner in owners:
            check_editable(owner)
            check_mesh(owner, self.uv_map)
        for owner in owners:
            make_surface(context.scene, owner)
            if self.uv_map:
                owner.pliant.uv_map = self.uv_map


_kinds = [(kind, kind.title(), CLASS_OF[kind].__doc__.split("\n")[0]) for kind in FORCE_KINDS]
_kind = EnumProperty(name="Kind", items=_kinds, default="POINT", description="What the force does")
_location = FloatVectorProperty(
    name="Location", subtype="TRANSLATION", unit="LENGTH", description="Its place; by default that of the cursor"
)


def _place_of(operator: Any, context: Any) -> Any:
    if not operator.properties.is_property_set("location"):
        operator.location = context.scene.cursor.location
    return operator.location


class PLIANT_OT_add_force(Edit, bpy.types.Operator):
    """Adds a force, as strong as suits the active or only surface"""

    bl_idname, bl_label = "pliant.add_force", "Force"

    kind: _kind
    name: StringProperty(name="Name", description="Name of the object; empty: that of its kind")
    location: _location
    fit: BoolProperty(
        name="Fit", default=True,
        description="Radii from the size of the active or only surface, and a magnitude that moves it by a tenth of "
        "that; off: the defaults of the format",
    )  # fmt: skip

    def act(self, context: Any) -> None:
        surface = surface_of(context) if self.fit else None
        if surface and not surface.data.vertices:
            surface = None
        owner = empty(context, self.name or self.kind.title(), _place_of(self, context), self.kind)
        make_force(owner, self.kind)
        if self.kind == "LINE":
            make_end(context, owner, size_of(surface) / 4 if surface else 1.0)
            # Away from the line would be along the surface that it lies in.
            owner.pliant.use_direction = bool(surface)
        if surface:
            owner.empty_display_size = size_of(surface) / 4
            try:
                fit(context, owner, surface)
            except (Refused, pliant.Error) as error:
                self.tell("WARNING", owner.name, f"its magnitude is a guess: {text_of(error)}")


class PLIANT_OT_make_force(Edit, bpy.types.Operator):
    """Makes a force of the active object, at its origin"""

    bl_idname, bl_label = "pliant.make_force", "Make Force"

    kind: _kind

    @classmethod
    def missing(cls, context: Any) -> str:
        return no_object(context)

    def act(self, context: Any) -> None:
        owner = active(context)
        check_editable(owner)
        make_force(owner, self.kind)
        if self.kind == "LINE" and not owner.pliant.end:
            make_end(context, owner, 1.0)


class PLIANT_OT_add_group(Edit, bpy.types.Operator):
    """Adds a group: the region that several forces share"""

    bl_idname, bl_label = "pliant.add_group", "Group"

    name: StringProperty(name="Name", description="Name of the object; empty: Group")
    location: _location

    def act(self, context: Any) -> None:
        empty(context, self.name or "Group", _place_of(self, context), "GROUP").pliant.role = "GROUP"


class PLIANT_OT_set_height(Edit, bpy.types.Operator):
    """Sets the magnitude with which the active force alone moves the surface by this much, once it is at rest"""

    bl_idname, bl_label = "pliant.set_height", "Set Height"

    height: FloatProperty(
        name="Height", default=0.2, unit="LENGTH", description="How far the surface is to move; negative: the other way"
    )

    @classmethod
    def missing(cls, context: Any) -> str:
        return no_force(context)

    def act(self, context: Any) -> None:
        scene, owner = context.scene, force_of(context)
        check_editable(owner)
        if owner.pliant.kind == "INERTIA":
            raise Refused(f"{owner.name} acts only while the surface moves, and holds it nowhere", owner)
        found = translated(scene)
        part = found.scene[found.part_of[owner.name]]
        curve = scalable(owner, "magnitude", isinstance(part.magnitude, pliant.Curve))
        frame, before = greatest(found.scene, part.magnitude, scene.frame_current)
        if curve and before == 0:
            raise Refused(f"{owner.name}: all keys of its magnitude are 0", owner)
        if self.height == 0:
            after = 0.0
        else:
            still = alone(found.scene, part.name, frame)
            sign = np.sign(self.height) * (np.sign(before) or 1)
            after = float(sign) * magnitude_for(still, abs(self.height))
        rescale(owner, "magnitude", curve, before, after)


def greatest(scene: Any, magnitude: Any, frame: int) -> Tuple[int, float]:
    """The frame of the largest magnitude, and that: `frame` if it is constant."""
    if not isinstance(magnitude, pliant.Curve):
        return frame, magnitude
    frames = np.arange(scene.start, scene.end + 1)
    values = magnitude(frames.astype(float))
    at = int(np.argmax(np.abs(values)))
    return int(frames[at]), float(values[at])


class PLIANT_OT_match_range(Edit, bpy.types.Operator):
    """Takes over the first and last frame of the scene"""

    bl_idname, bl_label = "pliant.match_range", "Match Range"

    def act(self, context: Any) -> None:
        match_range(context.scene)


class PLIANT_OT_remove(Edit, bpy.types.Operator):
    """Takes the role from the selected objects, which stay as they are otherwise"""

    bl_idname, bl_label = "pliant.remove", "Remove"

    @classmethod
    def missing(cls, context: Any) -> str:
        return "" if any(map(properties.has, selected(context))) else "select a surface, a force or a group"

    def act(self, context: Any) -> None:
        owners = [each for each in selected(context) if properties.has(each)]
        for owner in owners:
            check_editable(owner)
        for owner in owners:
            strip(owner)


class PLIANT_OT_clear(Edit, bpy.types.Operator):
    """Takes all that pliant has made from all objects and scenes of the file: roles, settings, keys of them, caches"""

    bl_idname, bl_label = "pliant.clear", "Clear All"

    def act(self, _context: Any) -> None:
        for scene in bpy.data.scenes:
            if not scene.library:
                live.forget(scene)
        for owner in (*bpy.data.objects, *bpy.data.scenes):
            if properties.has(owner) and not owner.library:
                strip(owner, is_all=True)
        for action in bpy.data.actions:  # also what nothing uses now would make them again
            for collection in fcurves.collections_of(action) if not action.library else ():
                for curve in [each for each in collection if each.data_path.startswith("pliant.")]:
                    collection.remove(curve)


class PLIANT_OT_reset(Edit, bpy.types.Operator):
    """Forgets what was solved, and solves it again"""

    bl_idname, bl_label = "pliant.reset", "Reset"

    def act(self, context: Any) -> None:
        live.forget(context.scene)


class PLIANT_OT_validate(Edit, bpy.types.Operator):
    """Looks for all that is wrong, or may not be intended, and lists it"""

    bl_idname, bl_label = "pliant.validate", "Validate"

    def act(self, context: Any) -> None:
        scene = context.scene
        if not properties.has(scene) or scene.pliant.live:
            live.refresh(scene)
        else:  # nobody looks at it otherwise
            known = [(each.level, each.object, each.text) for each in scene.pliant.messages]
            self.problems += [each for each in translate.translate(scene).problems if tuple(each) not in known]
        found = [*self.problems, *(scene.pliant.messages if properties.has(scene) else ())]
        counts = {level: sum(each.level == level for each in found) for level in ("ERROR", "WARNING", "NOTE")}
        told = [f"{count} {level.lower()}{'s' * (count != 1)}" for level, count in counts.items() if count]
        self.report({"INFO"}, ", ".join(told) or "all is well")


keys_tolerance = FloatProperty(
    name="Tolerance", default=0.01, soft_min=0.0, soft_max=0.1,
    description="How far the keys may be off, as a share of the range of the values",
)  # fmt: skip


class PLIANT_OT_record(Edit, bpy.types.Operator):
    """Makes keys of the active object of values, one a frame"""

    bl_idname, bl_label = "pliant.record", "Record"

    data_path: StringProperty(name="Data Path", description="The property, such as location or pliant.magnitude")
    index: IntProperty(name="Index", default=-1, description="Its component, 0 for x; -1: it is a single number")
    values: StringProperty(name="Values", description="Numbers between blanks, one a frame")
    first: IntProperty(name="First", default=1, description="The frame of the first value")
    tolerance: keys_tolerance

    @classmethod
    def missing(cls, context: Any) -> str:
        return no_object(context)

    def act(self, context: Any) -> None:
        owner = active(context)
        check_editable(owner)
        check_keys(owner)
        try:
            values = [float(each) for each in self.values.split()]
        except ValueError as error:
            raise Refused(f"values: {error}", owner) from error
        if not values or not (np.abs(values) <= np.finfo(np.float32).max).all():
            raise Refused("values must be numbers of single precision, one a frame", owner)
        record(owner, self.data_path, self.index, values, self.first, self.tolerance)


def record(owner: Any, data_path: str, index: int, values: List[float], first: int, tolerance: float) -> None:
    """Keys for values at frames in a row, in place of those that were there; keys outside stay."""
    try:
        value = owner.path_resolve(data_path)
    except ValueError as error:
        raise Refused(f"{owner.name} has no {data_path!r}", owner) from error
    if re.search(r"\[\d+\]$", data_path):
        raise Refused(f"{data_path}: the component is the index, and no part of the path", owner)
    size = len(value) if hasattr(value, "__len__") and not isinstance(value, str) else 0
    if isinstance(value, str) or not isinstance(value[0] if size else value, (bool, int, float)):
        raise Refused(f"{data_path} is no number", owner)
    row = blender_curves.property_of(owner, data_path)
    if row and not row.is_animatable:
        raise Refused(f"{data_path} cannot have keys", owner)
    if index not in (range(size) if size else (-1, 0)):
        raise Refused(f"{data_path} has {size or 'no'} components; {index} is none of them", owner)
    index, last = max(index, 0), first + len(values) - 1
    if row and row.type == "BOOLEAN":
        keys = [
            pliant.Key(frame, value, interpolation="step")
            for frame, value, before in zip(range(first, last + 1), values, [None, *values])
            if value != before
        ]
        curve = pliant.Curve(keys)
    else:
        keys = [pliant.Key(frame, value, interpolation="linear") for frame, value in enumerate(values, first)]
        most = max(tolerance, 0) * (float(np.ptp(values)) or 1e-6 * abs(values[0]) or 1e-6)
        curve = pliant.Curve(keys) if len(keys) == 1 else pliant.Curve(keys).simplified(first, last, most)[0]
    made = key_shapes(curve, first, last)
    target = fcurves.ensure(owner, data_path, index)
    target.mute = False
    points = target.keyframe_points
    for point in reversed([each for each in points if first <= each.co[0] <= last]):
        points.remove(point, fast=True)
    for shape in made:
        points.insert(*shape["co"], options={"FAST"})
    target.update()
    by_frame = {shape["co"][0]: shape for shape in made}
    for point in points:
        for name, number in by_frame.get(point.co[0], {}).items():
            setattr(point, name, number)
    target.update()


def key_shapes(curve: Any, first: int, last: int) -> List[Dict[str, Any]]:
    """The properties of the keys that Blender has for a curve."""
    path, plain = "pliant.magnitude", ("handle_left_type", "handle_right_type", "interpolation", "easing")
    scratch = bpy.data.objects.new(".pliant", None)
    try:
        fcurves.write(scratch, path, curve, size=1, first=first, last=last, name="record")
        points = fcurves.table(scratch.animation_data)[path, 0].keyframe_points
        # Types go first, since a new one moves a handle.
        return [
            {name: getattr(each, name) for name in plain}
            | {name: getattr(each, name)[:] for name in ("co", "handle_left", "handle_right")}
            for each in points
        ]
    finally:
        fcurves.remove(scratch, path)
        bpy.data.objects.remove(scratch)


CLASSES: Tuple[type, ...] = (
    PLIANT_OT_add_surface, PLIANT_OT_make_surface, PLIANT_OT_add_force, PLIANT_OT_make_force, PLIANT_OT_add_group,
    PLIANT_OT_set_height, PLIANT_OT_match_range, PLIANT_OT_remove, PLIANT_OT_clear, PLIANT_OT_reset,
    PLIANT_OT_validate, PLIANT_OT_record,
)  # fmt: skip


def register() -> None:
    from . import setups  # which uses what is here

    for cls in CLASSES:
        bpy.utils.register_class(cls)
    setups.register()


def unregister() -> None:
    from . import setups

    setups.unregister()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
