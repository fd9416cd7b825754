"""A scene of Blender as a scene of pliant: what is shown, rendered, baked and exported is this one scene."""

from __future__ import annotations

import re
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

from . import fcurves, meshes, pliant, properties
from .blender_curves import shortest
from .properties import TABLE, plain_word

MODIFIER = "pliant"
# Modifiers that move vertices and keep their number: rest shapes come from behind them.
DEFORMING = {
    "ARMATURE", "CAST", "CLOTH", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM",
    "LAPLACIANSMOOTH", "LATTICE", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "SHRINKWRAP", "SIMPLE_DEFORM",
    "SMOOTH", "SOFT_BODY", "SURFACE_DEFORM", "VOLUME_DISPLACE", "WARP", "WAVE",
}  # fmt: skip


class Problem(NamedTuple):
    """What a user should know."""

    level: str  #: ERROR, WARNING or NOTE
    object: str  #: the name of an object; empty: the scene
    text: str


class Samples(NamedTuple):
    """What Blender's own evaluation gave."""

    frames: np.ndarray  #: (n,)
    matrices: Dict[str, np.ndarray]  #: of an object, to the origin: (n, 4, 4)
    values: Dict[Tuple[str, str], np.ndarray]  #: of a property of an object: (n,) or (n, 3)
    shapes: Dict[str, Any]  #: of a surface: (n, V, 3) float32, or a text that says why there is none


class Translation(NamedTuple):
    """A scene of pliant, and whose its parts are."""

    scene: Optional[Any]  #: a pliant.Scene; None: something is wrong
    part_of: Dict[str, str]  #: the names of parts by those of objects
    object_of: Dict[str, str]  #: and back
    problems: List[Problem]
    samples: Optional[Samples]


class Wrong(Exception):
    """An object cannot be translated."""


def three(numbers: Sequence[float]) -> Tuple[float, ...]:
    return tuple(map(shortest, numbers))


def part_name(name: str, taken: Set[str]) -> str:
    """The name of an object's part in a scene file."""
    plain = re.sub("[^A-Za-z0-9_-]", "_", name)[:990]
    if not plain or plain[0] in "0123456789-":
        plain = "_" + plain
    found, number = plain, 2
    while found in taken:
        found, number = f"{plain}_{number}", number + 1
    taken.add(found)
    return found


def members(scene: Any) -> List[Any]:
    """The objects of a scene that have a role, in the order of their names."""
    found = [each for each in scene.objects if properties.role(each) != "NONE"]
    return sorted(found, key=lambda each: (each.name, each.name_full))


def ours(owner: Any) -> int:
    """Where our modifier is in the stack; -1: nowhere. One of the artist may have its name."""
    for index, each in enumerate(owner.modifiers):
        if each.type == "MESH_CACHE" and re.fullmatch(rf"{MODIFIER}(\.\d+)?", each.name):
            return index
    return -1


def fps(scene: Any) -> float:
    render = scene.render
    if abs(render.fps_base - 1.001) < 1e-6:
        return render.fps * 1000 / 1001
    return shortest(render.fps / shortest(render.fps_base))


# What an object looks like, for those who ask whether anything changed.


def _frozen(value: Any) -> Any:
    if isinstance(value, dict):
        return tuple((key, _frozen(each)) for key, each in sorted(value.items()))
    if isinstance(value, (list, tuple)):
        return tuple(map(_frozen, value))
    if isinstance(value, bpy.types.ID):
        return value.name_full
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


class Animated(NamedTuple):
    """What moves the properties of an object."""

    curves: Dict[Tuple[str, int], Any]  #: F-curves by path and index
    driven: Set[Tuple[str, int]]
    blocked: str  #: why no F-curve counts key by key; empty: they do


def animated(owner: Any) -> Animated:
    animation = owner.animation_data
    if animation is None:
        return Animated({}, set(), "")
    return Animated(fcurves.table(animation), fcurves.drivers(owner), fcurves.blockers(owner))


_transforms = (
    "location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale", "delta_location",
    "delta_rotation_euler", "delta_rotation_quaternion", "delta_scale",
)  # fmt: skip


def _still(values: Sequence[float], path: str, keyed: Set[Tuple[str, int]]) -> Tuple[float, ...]:
    """The components that nothing moves."""
    return tuple(each for index, each in enumerate(values) if (path, index) not in keyed)


def _look_at_place(owner: Any, moved: Animated) -> List[Any]:
    found: List[Any] = [owner.name, owner.rotation_mode]
    if not moved.blocked:
        keyed = {*moved.curves, *moved.driven}
        paths = {path for path, _ in keyed}
        for name in _transforms:
            values = getattr(owner, name)
            found.append(_still(values, name, keyed) if name in paths else tuple(values))
    parent = owner.parent
    if parent:
        inverse = tuple(map(tuple, owner.matrix_parent_inverse))
        found += [parent.name_full, owner.parent_type, owner.parent_bone, inverse]
    found.append(tuple(each.name for each in owner.constraints if not each.mute))
    return found


def look(owner: Any, origin: str) -> Tuple[Any, ...]:
    """A fingerprint of all that counts of an object but for what Blender's evaluation must tell."""
    moved = animated(owner)
    own = dict(properties.raw(owner))
    own.pop("place", None)
    keyed = {*moved.curves, *moved.driven}
    for path in {path for path, _ in keyed}:
        if path.startswith("pliant."):
            value = getattr(owner.pliant, path[7:], None)
            own.pop(path[7:], None)
            if hasattr(value, "__len__"):
                own[path[7:]] = _still(value, path, keyed)
    if moved.blocked:
        for name in properties.ANIMATABLE:
            own.pop(name, None)
    plain = [origin, moved.blocked, *_look_at_place(owner, moved)]
    plain += [(key, fcurves.state(curve)) for key, curve in moved.curves.items()]
    plain += sorted(moved.driven)
    end = own.get("end")
    if end:
        moved = animated(end)
        plain += [moved.blocked, *_look_at_place(end, moved)]
        plain += [(key, fcurves.state(curve)) for key, curve in moved.curves.items()]
    if own.get("role") == 1 and owner.type == "MESH":
        plain.append((owner.data.name_full, meshes.look(owner.data, own.get("uv_map", ""))))
        if own.get("maps"):
            plain.append(tuple(meshes.names_of(owner)))
        if own.get("rest"):
            plain += [(each.name, each.type) for each in owner.modifiers]
    return (*plain, _frozen(own))


def look_all(scene: Any) -> Tuple[Any, ...]:
    """The fingerprint of a whole scene."""
    own = properties.raw(scene)
    origin = own.get("origin")
    plain = [own.get(name) for name in ("live", "frame_start", "frame_end", "seed")]
    plain += [fps(scene), scene.render.frame_map_old == scene.render.frame_map_new]
    if origin:
        plain += [origin.name, tuple(map(tuple, origin.matrix_world))]
        plain.append(moves(origin))
    name = origin.name if origin else ""
    return (*plain, *(look(owner, name) for owner in members(scene)))


def moves(owner: Any) -> bool:
    """Whether keys or drivers of its own move an object."""
    moved = animated(owner)
    return any(path in _transforms for path, _ in (*moved.curves, *moved.driven))


# The translation itself.


def inverse_of(origin: Any) -> Optional[np.ndarray]:
    """From the world to the origin's space; None: there is no such matrix."""
    try:
        return np.linalg.inv(np.array(origin.matrix_world, float)) if origin else np.eye(4)
    except np.linalg.LinAlgError:
        return None


class _Translator:
    def __init__(self, scene: Any, sampled: bool, stale: Set[str]):
        self.blender = scene
        self.settings = scene.pliant
        self.origin = self.settings.origin
        self.sampled = sampled
        self.stale = stale
        self.problems: List[Problem] = []
        self.parts: Dict[str, Any] = {}
        self.matrices: Set[str] = set()  # whose transform must be sampled
        self.values: Dict[Tuple[str, str], int] = {}  # and which properties, with their size
        self.shapes: Set[str] = set()
        self.later: List[Tuple[Any, str, Callable[[Samples], None]]] = []  # what is done for an object's channel
        taken: Set[str] = set()
        self.objects = members(scene)
        # One of a library can have the name of another one: `name_full` tells them apart.
        self.part_of = {owner.name_full: part_name(owner.name, taken) for owner in self.objects}

    def note(self, owner: Any, channel: str, reason: str) -> None:
        self.problems.append(Problem("NOTE", owner.name, f"{channel} is sampled at each frame: {reason}"))

    def wrong(self, owner: Any, text: str) -> None:
        self.problems.append(Problem("ERROR", owner.name if owner else "", text))

    # Channels that are properties.

    def channel(self, part: Any, owner: Any, moved: Animated, name: str, row: Any, target: str = "") -> None:
        """Sets an attribute of a part from a property, its F-curves, or what Blender's evaluation gives."""
        value = getattr(owner.pliant, name)
        size = len(value) if hasattr(value, "__len__") else 1
        path, kind = f"pliant.{name}", "switch" if row.kind == "switch" else "vector" if size == 3 else "number"
        target = target or name
        indices = range(size)
        curves = [moved.curves.get((path, index)) for index in indices]
        reason = moved.blocked
        if any((path, index) in moved.driven for index in indices):
            reason = "a driver moves it"
        if not reason and self.sampled and any(curves):
            reason = "all channels are"
        if not reason:
            try:
                statics = three(value) if size > 1 else (float(value),) if kind == "switch" else (shortest(value),)
                if not any(curves):
                    setattr(part, target, bool(value) if kind == "switch" else statics if size > 1 else statics[0])
                else:
                    setattr(part, target, fcurves.read(curves, statics, kind=kind))
                return
            except fcurves.Sampled as error:
                reason = str(error)
        self.note(owner, name, reason)
        key = owner.name_full, name
        self.values[key] = size

        def fill(samples: Samples) -> None:
            setattr(part, target, fcurves.sampled(samples.frames, samples.values[key], kind=kind))

        self.later.append((owner, name, fill))

    # Places.

    def _blocked_transform(self, owner: Any, moved: Animated) -> str:
        """Why no channel of an object's transform can be read key by key."""
        if owner.parent and owner.parent == self.origin:
            if owner.parent_type != "OBJECT" or owner.matrix_parent_inverse != Matrix():
                return "its parent inverse is none"
        elif owner.parent:
            return "it has a parent"
        elif self.origin:
            return "it is no child of the origin"
        moving = {path for path, _ in (*moved.curves, *moved.driven)}
        if any(not each.mute and each.influence for each in owner.constraints) or any(
            path.startswith("constraints[") for path in moving
        ):
            return "it has constraints"
        if "rotation_mode" in moving:
            return "its rotation mode changes"
        if any(owner.delta_location) or any(owner.delta_rotation_euler) or tuple(owner.delta_scale) != (1, 1, 1) \
                or tuple(owner.delta_rotation_quaternion) != (1, 0, 0, 0):  # fmt: skip
            return "it has delta transforms"
        if any(path.startswith("delta_") for path in moving):
            return "it has delta transforms"
        return moved.blocked

    def _transform(
        self, part: Any, owner: Any, moved: Animated, target: str, path: str,
        derive: Callable[[np.ndarray], np.ndarray],
        kind: str = "vector",
    ) -> None:  # fmt: skip
        """Sets a channel from location, rotation or scale."""
        reason = self._blocked_transform(owner, moved)
        curves = [moved.curves.get((path, index)) for index in range(3)]
        if not reason and any(each == path for each, _ in moved.driven):
            reason = "a driver moves it"
        if not reason and path == "rotation_euler" and owner.rotation_mode in ("QUATERNION", "AXIS_ANGLE"):
            reason = "rotations that are no Euler angles have no keys here"
        if not reason and self.sampled and any(curves):
            reason = "all channels are"
        if not reason:
            numbers = getattr(owner, path)
            if not any(curves):
                if kind == "rotation":
                    numbers = [np.degrees(np.float64(shortest(each))) for each in numbers]
                    setattr(part, target, tuple(map(float, numbers)))
                else:
                    setattr(part, target, three(numbers))
                return
            try:
                setattr(part, target, fcurves.read(curves, three(numbers), kind=kind))
                return
            except fcurves.Sampled as error:
                reason = str(error)
        self.sample_transform(part, owner, target, derive, reason)

    def sample_transform(
        self, part: Any, owner: Any, target: str, derive: Callable[[np.ndarray], np.ndarray], reason: str
    ) -> None:
        name = owner.name_full
        self.matrices.add(name)

        def fill(samples: Samples) -> None:
            numbers = derive(samples.matrices[name])
            value = fcurves.sampled(samples.frames, numbers, kind="vector")
            if isinstance(value, pliant.Curve):
                self.note(owner, target.strip("_"), reason)
            setattr(part, target, value)

        self.later.append((owner, target.strip("_"), fill))

    def position(self, part: Any, owner: Any, target: str) -> None:
        self._transform(part, owner, animated(owner), target, "location", lambda matrices: matrices[:, :3, 3])

    def direction(self, part: Any, owner: Any, moved: Animated, target: str) -> None:
        own = owner.pliant
        if own.aim == "VECTOR":
            if owner.parent != self.origin:
                if any(path == "pliant.direction" for path, _ in (*moved.curves, *moved.driven)) or moved.blocked:
                    self.values[owner.name_full, "direction"] = 3
                self._parent_direction(part, owner, target)
                return
            self.channel(part, owner, moved, "direction", TABLE["Point"]["direction"], target)
            return
        blocked = self._blocked_transform(owner, moved)
        turning = any(path.startswith("rotation") for path, _ in (*moved.curves, *moved.driven))
        if not blocked and not turning:
            mode = owner.rotation_mode
            if mode == "QUATERNION":
                turn = owner.rotation_quaternion.to_matrix()
            elif mode == "AXIS_ANGLE":
                angle, *axis = owner.rotation_axis_angle
                turn = Matrix.Rotation(angle, 3, Vector(axis))
            else:
                turn = owner.rotation_euler.to_matrix()
            # The axis of a turn in float64, so that a quarter is a quarter but for its last bits.
            setattr(part, target, three(turn.col[2]))
            return
        self.sample_transform(part, owner, target, _third_axis, blocked or "an aim that turns has no keys here")

    def _parent_direction(self, part: Any, owner: Any, target: str) -> None:
        name, static = owner.name_full, np.array(three(owner.pliant.direction))
        parent = owner.parent.name_full if owner.parent else ""
        self.matrices.add(parent or name)

        def fill(samples: Samples) -> None:
            vectors = samples.values.get((name, "direction"))
            vectors = np.broadcast_to(static, (len(samples.frames), 3)) if vectors is None else vectors
            if parent:
                turns = _rotations(samples.matrices[parent])
            else:  # the world, as the origin sees it
                turns = _rotations(np.array([inverse_of(self.origin)] * len(vectors)))
            numbers = np.einsum("nij,nj->ni", turns, vectors)
            value = fcurves.sampled(samples.frames, numbers, kind="vector")
            if isinstance(value, pliant.Curve):
                self.note(owner, target, "its parent turns it, or it moves in its parent")
            setattr(part, target, value)

        self.later.append((owner, target, fill))

    # Parts.

    def surface(self, owner: Any) -> Any:
        own, moved = owner.pliant, animated(owner)
        if owner.type != "MESH":
            raise Wrong(f"a surface must be a mesh, and this is {owner.type}")
        if owner.library and not owner.override_library:
            raise Wrong("it is linked without a library override: make one, so that it can move")
        mesh = meshes.read(owner.data, own.uv_map, owner.data.name_full in self.stale)
        part = pliant.Surface(self.part_of[owner.name_full], shape=mesh)
        self._place(part, owner, moved)
        for name in ("uv", "wrap"):
            setattr(part, name, plain_word(getattr(own, name)))
        if any(own.unit):
            part.unit = three(own.unit)
        if any(own.axis):
            part.axis = three(own.axis)
        if own.weld >= 0:
            part.weld = shortest(own.weld)
        if own.border != "AUTO":
            part.border = plain_word(own.border)
        part.enabled = own.solve
        if own.rest == "MODIFIERS":
            self._cache(part, owner)
        if own.driven_by:
            part.driven_by = self.reference(owner, own.driven_by, "SURFACE", "driven by")
            return part
        for name in properties.KEYABLE["SURFACE"]:
            switch = properties.SWITCHED.get(name)
            if switch is None or getattr(own, switch):
                if not (name == "damping" and own.use_damping_ratio):
                    self.channel(part, owner, moved, name, TABLE["Surface"][name])
        for name in properties.TANGENTS:
            path = f"pliant.{name}"
            if any(getattr(own, name)) or any(each == path for each, _ in (*moved.curves, *moved.driven)):
                self.channel(part, owner, moved, name, TABLE["Surface"][name])
        for name in ("stepping", "reference", "combine", "release", "integrator", "region"):
            setattr(part, name, plain_word(getattr(own, name)))
        if own.measure != "AUTO":
            part.measure = plain_word(own.measure)
        if own.use_start_frame:
            part.start_frame = own.start_frame
        part.edges = tuple(plain_word(getattr(own, name)) for name in properties.EDGES)
        part.preroll = own.preroll
        if own.loop:
            part.loop = own.loop
        for number, each in enumerate(own.maps, 1):
            found = meshes.values(owner, each.source, owner.data.name_full in self.stale)
            if found is None:
                self.wrong(owner, f"map {number}: there is no vertex group and no attribute of numbers or colours "
                                  f"at the points that is named {each.source!r}")  # fmt: skip
                continue
            part.maps.append(
                pliant.Map(plain_word(each.channel), values=found, low=shortest(each.low), high=shortest(each.high))
            )
        return part

    def _place(self, part: Any, owner: Any, moved: Animated) -> None:
        mode = owner.rotation_mode
        order = "xyz" if mode in ("QUATERNION", "AXIS_ANGLE") or self._blocked_transform(owner, moved) else mode.lower()
        part.rotate_order = order
        derive = _Decomposed(owner, order, self)
        self._transform(part, owner, moved, "translate", "location", lambda matrices: matrices[:, :3, 3])
        self._transform(part, owner, moved, "rotate", "rotation_euler", derive.rotate, kind="rotation")
        self._transform(part, owner, moved, "scale", "scale", derive.scale)

    def _cache(self, part: Any, owner: Any) -> None:
        for each in list(owner.modifiers)[: place_of(owner) if ours(owner) < 0 else ours(owner)]:
            for row in each.bl_rna.properties:
                other = getattr(each, row.identifier) if row.type == "POINTER" and each.show_viewport else None
                if isinstance(other, bpy.types.Object) and properties.role(other) == "SURFACE":
                    raise Wrong(f"the modifier {each.name!r} ahead of pliant's reads {other.name!r}, which is not "
                                "solved when shapes at rest are sampled: move it behind, or use driven_by")  # fmt: skip
        self.shapes.add(owner.name)
        name = owner.name

        def fill(samples: Samples) -> None:
            found = samples.shapes[name]
            if isinstance(found, str):
                self.wrong(owner, found)
                return
            part.cache, part.cache_start = found.astype(float), float(samples.frames[0])

        self.later.append((owner, "rest", fill))

    def reference(self, owner: Any, other: Any, wanted: str, what: str) -> str:
        if other is None or properties.role(other) != wanted or other.name_full not in self.part_of:
            named = other.name if other else "nothing"
            raise Wrong(f"{what}: {named!r} is no {wanted.lower()} of this scene")
        return self.part_of[other.name_full]

    def targets(self, part: Any, owner: Any) -> None:
        names = [self.reference(owner, each.surface, "SURFACE", "targets") for each in owner.pliant.targets]
        part.targets = tuple(names)

    def force(self, owner: Any) -> Any:
        own, moved = owner.pliant, animated(owner)
        if own.kind not in properties.CLASS_OF:
            raise Wrong("this version does not know its kind")
        kind = properties.CLASS_OF[own.kind]
        rows = TABLE[kind.__name__]
        part = kind(self.part_of[owner.name_full])
        if own.group:
            part.group = self.reference(owner, own.group, "GROUP", "group")
        self.targets(part, owner)
        for name in ("enabled", "magnitude", "deformation_radius", "force_radius", "pull", "frequency", "rate"):
            if name in rows:
                self.channel(part, owner, moved, name, rows[name])
        if own.falloff == "DRAWN":
            part.falloff = self._drawn(own.falloff_text)
        else:
            part.falloff = plain_word(own.falloff)
        if "along" in rows:
            part.along = plain_word(own.along)
        if "follow" in rows and own.follow:
            part.follow = self.reference(owner, own.follow, "SURFACE", "follow")
        if own.use_seed and "seed" in rows:
            part.seed = own.seed
        if "center" in rows:
            self.position(part, owner, "center")
        if "from_" in rows:
            self.position(part, owner, "from_")
            if own.end is None:
                raise Wrong("a line needs its end, another object")
            self.position(part, own.end, "to")
        if "axis" in rows:
            self.direction(part, owner, moved, "axis")
        elif "direction" in rows and (not rows["direction"].is_optional or own.use_direction):
            self.direction(part, owner, moved, "direction")
        return part

    def _drawn(self, text: str) -> Any:
        scene = f'<scene version="1" start="1" end="1"><point name="p">{text}</point></scene>'
        try:
            return pliant.parse(scene, name="falloff").forces[0].falloff
        except pliant.Error as error:
            raise Wrong(f"its falloff: {error.message}") from error

    def group(self, owner: Any) -> Any:
        part = pliant.Group(self.part_of[owner.name_full])
        moved = animated(owner)
        self.targets(part, owner)
        for name in properties.KEYABLE["GROUP"]:
            self.channel(part, owner, moved, name, TABLE["Group"][name])
        if owner.pliant.follow:
            part.follow = self.reference(owner, owner.pliant.follow, "SURFACE", "follow")
        self.position(part, owner, "center")
        return part

    # All of it.

    def frames(self) -> Tuple[int, int]:
        prerolls = [owner.pliant.preroll for owner in self.objects if owner.pliant.role == "SURFACE"]
        return self.settings.frame_start - 1 - max(prerolls, default=0), self.settings.frame_end + 1

    def attempt(self, owner: Any, where: str, work: Callable[[], Any]) -> Any:
        """What is made for an object; None: it is told why there is nothing."""
        try:
            return work()
        except pliant.Error as error:
            for problem in error.problems:
                self.wrong(owner, where + problem.message)
        except (Wrong, TypeError, ValueError) as error:  # a part says so of what it cannot hold at all
            self.wrong(owner, where + str(error))
        return None

    def run(self, samples: Optional[Samples], is_checked: bool) -> Translation:
        first, last = self.frames()
        made = pliant.Scene(fps=fps(self.blender), start=self.settings.frame_start, end=self.settings.frame_end)
        if self.settings.seed < 0:
            self.wrong(None, f"the seed is {self.settings.seed}, but must be at least 0")
        else:
            made.seed = self.settings.seed
        if inverse_of(self.origin) is None:
            self.wrong(self.origin, "it is the origin, whose scale must not be 0")
        if self.blender.render.frame_map_old != self.blender.render.frame_map_new:
            self.wrong(None, "time remapping must be 1 to 1")
        if self.origin and moves(self.origin):
            self.wrong(self.origin, "it is the origin of coordinates, which must not be animated")
        if self.settings.frame_end < self.settings.frame_start:
            self.wrong(None, f"the end, {self.settings.frame_end}, is ahead of the start, {self.settings.frame_start}")
        elif last - first > 1_000_002:
            self.wrong(None, "there are more than a million frames")
        lists = {"SURFACE": made.surfaces, "FORCE": made.forces, "GROUP": made.groups}
        for owner in self.objects:
            kind = owner.pliant.role
            part = self.attempt(owner, "", lambda owner=owner, kind=kind: getattr(self, kind.lower())(owner))
            if part is not None:
                lists[kind].append(part)
        groups = ["", *(each.name for each in made.groups)]
        made.forces.sort(key=lambda each: groups.index(each.group) if each.group in groups else 0)  # as in a file
        wanted = self.matrices or self.values or self.shapes
        if wanted and not any(problem.level == "ERROR" for problem in self.problems):
            if samples is None:
                samples = sample(self.blender, self.origin, first, last, self.matrices, self.values, self.shapes)
            for owner, channel, fill in self.later:
                self.attempt(owner, f"{channel}: ", lambda fill=fill: fill(samples))
        else:
            samples = None
        object_of = {self.part_of[owner.name_full]: owner.name for owner in self.objects}
        failed = any(problem.level == "ERROR" for problem in self.problems)
        if not failed and is_checked:
            try:
                made.check()
            except pliant.Error as error:
                failed = True
                self.problems += [problem_of(each.message, "ERROR", object_of) for each in error.problems]
        part_of = {**{owner: part for part, owner in object_of.items()}, **self.part_of}
        return Translation(None if failed else made, part_of, object_of, self.problems, samples)


def problem_of(message: str, level: str, object_of: Dict[str, str]) -> Problem:
    """A message of the library with the object that it begins with."""
    found = re.match(r"(?:\w+ )?[\"']?([A-Za-z_][\w-]*)", message)
    for name in (found[1] if found else "",):
        if name in object_of:
            return Problem(level, object_of[name], message)
    for name in sorted(object_of, key=len, reverse=True):
        if re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", message):
            return Problem(level, object_of[name], message)
    return Problem(level, "", message)


def _third_axis(matrices: np.ndarray) -> np.ndarray:
    axes = matrices[:, :3, 2]
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    return axes / np.where(length > 0, length, 1)


def _rotations(matrices: np.ndarray) -> np.ndarray:
    return np.array([np.array(Matrix(each).to_3x3().normalized()) for each in matrices])


class _Decomposed:
    """Rotation and scale of matrices, which shear refuses."""

    def __init__(self, owner: Any, order: str, translator: _Translator):
        self.owner, self.order, self.translator = owner, order, translator
        self.known: Optional[Tuple[np.ndarray, np.ndarray]] = None

    def _numbers(self, matrices: np.ndarray, frames: Optional[np.ndarray] = None) -> Tuple[np.ndarray, np.ndarray]:
        if self.known is None:
            first = self.translator.frames()[0]
            turns, scales, before = [], [], None
            for number, each in enumerate(matrices):
                part = Matrix(each).to_3x3()
                lengths = np.linalg.norm(each[:3, :3], axis=0)
                if lengths.min() == 0 or not np.isfinite(lengths).all():
                    self.translator.wrong(self.owner, f"its scale is 0 at frame {first + number}")
                    turns, scales = [[0, 0, 0]], [[1, 1, 1]]
                    break
                unit = each[:3, :3] / lengths
                if abs(unit.T @ unit - np.eye(3)).max() > 1e-5:
                    self.translator.wrong(self.owner, f"it is sheared at frame {first + number}")
                    turns, scales = [[0, 0, 0]], [[1, 1, 1]]
                    break
                _, turn, scale = Matrix(each).decompose()
                angles = turn.to_euler(self.order.upper(), before) if before else turn.to_euler(self.order.upper())
                before = angles
                turns.append(angles[:])
                scales.append(scale[:])
                del part
            count = len(matrices)
            turned = np.degrees(np.array(turns, float))
            scaled = np.array(scales, float)
            if len(turned) != count:
                turned, scaled = np.repeat(turned[:1], count, 0), np.repeat(scaled[:1], count, 0)
            self.known = turned, scaled
        return self.known

    def rotate(self, matrices: np.ndarray) -> np.ndarray:
        return self._numbers(matrices)[0]

    def scale(self, matrices: np.ndarray) -> np.ndarray:
        return self._numbers(matrices)[1]


def place_of(owner: Any) -> int:
    """Where our modifier belongs in a stack that has none yet."""
    kept = owner.pliant.place
    if owner.pliant.rest == "BASE":
        return 0
    if kept >= 0:
        return min(kept, len(owner.modifiers))
    mine = ours(owner)
    others = [each for index, each in enumerate(owner.modifiers) if index != mine]
    return next((index for index, each in enumerate(others) if each.type not in DEFORMING), len(others))


stages = 0  # how many scenes of ours Blender evaluates in now, of which handlers need not know


class _Stage:
    """A scene of its own for as long as Blender evaluates in it: no other data is written, nor is a frame changed."""

    def __init__(self, scene: Any):
        global stages
        stages += 1
        self.real = scene
        self.scene = bpy.data.scenes.new(".pliant")
        for name in ("fps", "fps_base"):
            setattr(self.scene.render, name, getattr(scene.render, name))
        self.copies: List[Any] = []

    def __enter__(self) -> "_Stage":
        return self

    def __exit__(self, *_: Any) -> None:
        global stages
        bpy.data.scenes.remove(self.scene)
        for each in self.copies:
            bpy.data.objects.remove(each)
        stages -= 1

    def add(self, owner: Any) -> None:
        if owner not in self.scene.collection.objects[:]:
            self.scene.collection.objects.link(owner)

    def copy_ahead_of_ours(self, owner: Any) -> Any:
        """A copy of a surface with the modifiers ahead of ours only."""
        made = owner.copy()
        self.copies.append(made)
        place = ours(made)
        for each in list(made.modifiers)[place if place >= 0 else place_of(owner) :]:
            made.modifiers.remove(each)
        self.scene.collection.objects.link(made)
        return made

    def at(self, frames: Sequence[int]) -> Iterator[Any]:
        # A graph that ViewLayer.update has updated writes what is animated back to the objects; this one does not.
        self.scene.frame_set(int(frames[0]))
        graph = self.scene.view_layers[0].depsgraph
        for frame in frames:
            self.scene.frame_current = int(frame)
            real = self.real.evaluated_get(graph)
            if real.is_evaluated:  # drivers that read its frame bring it in
                real.frame_current = int(frame)
            graph.update()
            yield graph


def sample(
    scene: Any, origin: Any, first: int, last: int, matrices: Set[str], values: Dict[Tuple[str, str], int],
    shapes: Set[str],
) -> Samples:  # fmt: skip
    """What Blender's evaluation makes of objects at each frame."""
    frames = np.arange(first, last + 1)
    wanted = matrices | {name for name, _ in values}
    owners = {each.name_full: each for each in bpy.data.objects if each.name_full in wanted}
    placed: Dict[str, List[Any]] = {name: [] for name in matrices}
    found: Dict[Tuple[str, str], List[Any]] = {key: [] for key in values}
    moved: Dict[str, Any] = {name: [] for name in shapes}
    to_origin = inverse_of(origin) if origin else None
    with _Stage(scene) as stage:
        for owner in owners.values():
            stage.add(owner)
        copies = {name: stage.copy_ahead_of_ours(bpy.data.objects[name]) for name in sorted(shapes)}
        for graph in stage.at(frames):
            for name in placed:
                matrix = np.array(owners[name].evaluated_get(graph).matrix_world, float)
                placed[name].append(matrix if to_origin is None else to_origin @ matrix)
            for (name, attribute), size in values.items():
                value = getattr(owners[name].evaluated_get(graph).pliant, attribute)
                found[name, attribute].append(tuple(value) if size > 1 else float(value))
            for name, copy in copies.items():
                if isinstance(moved[name], str):
                    continue
                shape = copy.evaluated_get(graph).data
                count = len(bpy.data.objects[name].data.vertices)
                if len(shape.vertices) != count:
                    moved[name] = (
                        f"the modifiers ahead of pliant's make {len(shape.vertices)} vertices of {count} at frame "
                        f"{stage.scene.frame_current}; they must keep their number"
                    )
                    continue
                positions = np.empty(3 * count, np.float32)
                shape.vertices.foreach_get("co", positions)
                moved[name].append(positions.reshape(-1, 3))
    return Samples(
        frames,
        {name: np.array(each) for name, each in placed.items()},
        {key: np.array(each, float) for key, each in found.items()},
        {name: each if isinstance(each, str) else np.array(each) for name, each in moved.items()},
    )


def translate(
    scene: Any, *, sampled: bool = False, stale: Set[str] = frozenset(), samples: Optional[Samples] = None,
    is_checked: bool = True,
) -> Translation:  # fmt: skip
    """The scene of pliant that a scene of Blender is, or what is wrong with it.

    `stale`: the names of meshes that changed; `samples`: what Blender's evaluation gave, if that is known to be so
    still; without `is_checked` a Simulation must tell what is wrong with values. Must not be called while Blender
    evaluates or renders in another thread.
    """
    return _Translator(scene, sampled, stale).run(samples, is_checked)
