"""Scene files into Blender: objects of all parts, or the reasons why not."""

from __future__ import annotations

import itertools
import os
import re
import struct
from typing import Any, Callable, Dict, List, Optional, Tuple

import bpy
import numpy as np
from mathutils import Matrix

from . import fcurves, meshes, pliant, properties, translate
from .point_cache import HEADER as PC2
from .problems import Refused, error_of, refused_by
from .properties import TABLE, role, word
from .shape_keys import absolute_keys
from .translate import Problem

_most = 2**31 - 1  # what an integer of Blender holds
_last_frame = 1048574  # of Blender
_most_letters = 63  # of the name of an object


def _single(where: str, value: Any) -> None:
    """Refuses a number that single precision loses."""
    numbers = np.atleast_1d(np.asarray(value, float))
    with np.errstate(over="ignore", under="ignore"):
        singles = numbers.astype(np.float32)
    for number, single in zip(numbers, singles):
        if not np.isfinite(single) or (number and not single):
            text = f"{where}={number:g}: Blender keeps numbers in single precision, which has no such one"
            raise Refused(error_of(text))


def _three(value: Any) -> Any:
    return value if value is None or isinstance(value, str) else (value,) * 3


def _vector_curve(curve: Any) -> Any:
    """A curve of one number as one of three that are the same."""
    keys = []
    for key in curve.keys:
        given = {name: getattr(key, name) for name in ("amplitude", "period", "back", "control")}
        for name in ("in_tangent", "out_tangent", "left"):
            given[name] = _three(getattr(key, name))
        for name in ("in_handle", "out_handle"):
            handle = getattr(key, name)
            given[name] = handle and (handle[0], *(handle[1],) * 3)
        for name in ("in_length", "out_length"):
            given[name] = getattr(key, name)
        given = {name: value for name, value in given.items() if value is not None}
        keys.append(pliant.Key(key.frame, _three(key.value), interpolation=key.interpolation, **given))
    before, after = (re.sub("^slope (.*)", r"slope \1 \1 \1", each) for each in (curve.before, curve.after))
    loop = curve.loop
    if loop:
        loop = pliant.Loop(loop.from_, loop.to, before=loop.before, after=loop.after, offset=_three(loop.offset))
    return pliant.Curve(keys, before=before, after=after, overshoot=curve.overshoot, loop=loop)


def _falloff_text(curve: Any) -> str:
    """The <falloff> that a curve over the distance is."""
    text = pliant.Scene(forces=[pliant.Point("p", falloff=curve)]).to_xml()
    return re.search(r"<falloff.*</falloff>", text, re.DOTALL)[0]


def _picture(file: str) -> np.ndarray:
    """The first channel of a picture, (rows, columns), from below."""
    image = bpy.data.images.load(file)
    try:
        image.alpha_mode = "CHANNEL_PACKED"  # so that nothing is multiplied
        image.colorspace_settings.name = "Non-Color"
        columns, rows = image.size
        pixels = np.empty(columns * rows * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(rows, columns, image.channels)[:, :, 0]
    finally:
        bpy.data.images.remove(image)


def _at(picture: np.ndarray, uvs: np.ndarray) -> np.ndarray:
    """Values of a picture as a map reads them."""
    rows, columns = picture.shape
    found = []
    for share, count in zip(np.clip(uvs, 0, 1).T, (columns, rows)):
        place = np.clip(share * count - 0.5, 0, count - 1)
        low = np.minimum(place.astype(int), max(count - 2, 0))
        found.append((low, np.minimum(low + 1, count - 1), place - low))
    (left, right, x), (below, above, y) = found
    numbers = picture.astype(float)
    lower = numbers[below, left] * (1 - x) + numbers[below, right] * x
    upper = numbers[above, left] * (1 - x) + numbers[above, right] * x
    return lower * (1 - y) + upper * y


def _uvs_of_nodes(mesh: Any, nodes: np.ndarray) -> np.ndarray:
    """(u,v) at each vertex: that of the lowest vertex of its node, at the first corner that uses it."""
    vertices, corners = np.unique(mesh.corner_vertices, return_index=True)
    uvs = np.zeros((len(nodes), 2))
    indices = np.asarray(mesh.corner_uvs)[corners]
    uvs[vertices] = np.where(indices[:, None] >= 0, mesh.uvs[indices], 0)
    _, lowest, which = np.unique(nodes, return_index=True, return_inverse=True)
    return uvs[lowest[which]]


def _samples(file: str, start: float, fps: float) -> Tuple[np.ndarray, np.ndarray]:
    """The frames of a cache's samples, and the samples: (n, V, 3)."""
    ending = os.path.splitext(file)[1].lower()
    if ending == ".npy":
        shapes = np.load(file, mmap_mode="r")
        return start + np.arange(len(shapes)), shapes
    if ending == ".pc2":
        _, vertices, _, rate, count = _pc2(file)
        shapes = np.memmap(file, "<f4", "r", PC2.size, (count, vertices, 3))
        return start + np.arange(count) * rate, shapes
    with open(file, "rb") as stream:
        count, vertices = struct.unpack(">ii", stream.read(8))
        times = np.frombuffer(stream.read(4 * count), ">f4").astype(float)
    frames = start + (times - times[0]) * fps
    whole = np.round(frames)
    near = abs(frames - whole) <= 4 * 2.0**-23 * np.maximum(abs(times), 1) * fps
    return np.where(near, whole, frames), np.memmap(file, ">f4", "r", 8 + 4 * count, (count, vertices, 3))


def _pc2(file: str) -> Tuple[int, int, float, float, int]:
    with open(file, "rb") as stream:
        _, version, vertices, start, rate, count = PC2.unpack(stream.read(PC2.size))
    return version, vertices, start, rate, count


def _shape_at(frames: np.ndarray, shapes: np.ndarray, frame: float) -> np.ndarray:
    """What a cache has at a frame, float32."""
    after = int(np.clip(np.searchsorted(frames, frame), 0, len(frames) - 1))
    before = max(after - 1, 0)
    width = frames[after] - frames[before]
    share = np.clip((frame - frames[before]) / width, 0, 1) if width > 0 else 1.0
    mixed = shapes[after] if share == 1 else shapes[before] * (1 - share) + shapes[after] * share
    return np.ascontiguousarray(mixed, np.float32)


class Import:
    """Makes objects of the parts of a scene."""

    def __init__(self, context: Any, scene: Any, up: str):
        self.context, self.blender, self.scene, self.up = context, context.scene, scene, up
        self.notes: List[Problem] = []
        self.object_of: Dict[str, Any] = {}
        self.parent: Any = None
        self.collection = self._collection()
        self.is_first = not any(role(each) == "SURFACE" for each in self.blender.objects)
        prerolls = [each.preroll for each in scene.surfaces]
        loops = [scene.start + (each.loop or 0) for each in scene.surfaces]
        self.first = scene.start - max(prerolls, default=0)
        self.last = max([scene.end, *loops])
        if not self.is_first:
            self.first = min(self.first, self.blender.pliant.frame_start)
            self.last = max(self.last, self.blender.pliant.frame_end)

    def _collection(self) -> Any:
        active = self.context.view_layer.active_layer_collection
        is_there = active and not active.exclude and not active.collection.library
        return active.collection if is_there else self.blender.collection

    # What Blender cannot hold.

    def check(self) -> None:
        problems: List[Problem] = []
        for part in self.scene.colliders:
            problems.append(error_of(f"the collider {part.name}: there are no colliders in Blender yet"))
        for part in self.scene.surfaces:
            if not isinstance(part.shape, (pliant.Grid, pliant.MeshFile, pliant.Mesh)):
                problems.append(error_of(f"{part.name}: a surface in Blender is a mesh, and this is a net (<nurbs>)"))
            if part.subdivision:
                problems.append(error_of(f"{part.name}: a surface in Blender is a mesh, and this is a <subdivision>"))
            problems += [error_of(f"{part.name}: a <hold> has no property in Blender")] * bool(part.holds)
        kinds = tuple(properties.CLASS_OF.values())
        for part in self.scene.forces:
            if not isinstance(part, kinds):
                problems.append(error_of(f"{part.name}: there is no force {type(part).__name__} in Blender"))
        for part in self._parts():
            if len(part.name) > _most_letters:
                problems.append(error_of(f"{part.name}: Blender has no names of more than {_most_letters} letters"))
            for name, row in part._rows.items():
                if name not in _special and name not in _held and not _is_standard(row, getattr(part, name)):
                    problems.append(error_of(f"{part.name}: {row.attribute} has no property in Blender"))
        if self.scene.seed > _most:
            problems.append(error_of(f"<scene> seed={self.scene.seed}: Blender has none above {_most}"))
        if self.first < -_last_frame or self.last > _last_frame:
            problems.append(error_of(f"<scene>: Blender has no frames beyond {_last_frame}"))
        if self.is_first and self._rate() is None:
            problems.append(error_of(f"<scene> fps={self.scene.fps:g}: Blender has no such rate"))
        if problems:
            raise Refused(*problems)

    def _parts(self) -> List[Any]:
        return [*self.scene.surfaces, *self.scene.groups, *self.scene.forces]

    def _rate(self) -> Optional[Tuple[int, float]]:
        """fps and fps_base of a rate."""
        fps = self.scene.fps
        plain = [(round(fps * base), base) for base in (1, 2, 4, 5, 8, 10, 1.001)]
        wholes = [(whole, base) for whole, base in plain if abs(whole - fps * base) < 1e-9]
        others = ((whole, whole / fps) for whole in range(max(int(np.ceil(fps)), 1), 32768))
        for whole, base in itertools.chain(wholes, others):
            base = translate.shortest(np.float32(base))
            found = whole * 1000 / 1001 if base == 1.001 else translate.shortest(whole / base)
            if whole < 32768 and np.float32(found) == np.float32(fps):
                return whole, base
        return None

    # All of it.

    def run(self) -> None:
        self.check()
        try:
            simulation = pliant.Simulation(self.scene) if self.scene.surfaces else None
            if self.up == "Y":
                self.parent = self._turned()
            for part in self._parts():
                self.object_of[part.name] = self._object(part, simulation)
            for part in self._parts():
                for name, row in part._rows.items():
                    self._set(part, self.object_of[part.name], name, row)
        except pliant.Error as error:
            raise refused_by(error) from error
        self._settings()

    def _settings(self) -> None:
        settings, render = self.blender.pliant, self.blender.render
        if self.parent:
            settings.origin = self.parent
        if self.is_first:
            settings.frame_start, settings.frame_end = self.scene.start, self.scene.end
            settings.seed = self.scene.seed
            self.blender.frame_end = self.scene.end
            self.blender.frame_start = self.scene.start
            self.blender.frame_end = self.scene.end
            render.fps, render.fps_base = self._rate()
            render.frame_map_old = render.frame_map_new = 100
        else:
            for name, here, there in (
                ("start", settings.frame_start, self.scene.start),
                ("end", settings.frame_end, self.scene.end),
                ("fps", translate.fps(self.blender), self.scene.fps),
            ):
                if abs(here - there) > 1e-6 * abs(there):
                    self.notes.append(Problem("NOTE", "", f"{name} is {here:g} still, and {there:g} in the file"))

    def _turned(self) -> Any:
        """The empty whose y is up."""
        found = self.blender.pliant.origin if properties.has(self.blender) else None
        wanted = Matrix.Rotation(np.pi / 2, 4, "X")
        if found and np.allclose(np.array(found.matrix_world), np.array(wanted), atol=1e-6):
            return found
        made = bpy.data.objects.new("pliant.up", None)
        made.rotation_euler = np.pi / 2, 0, 0
        self.collection.objects.link(made)
        return made

    def _object(self, part: Any, simulation: Any) -> Any:
        is_surface = isinstance(part, pliant.Surface)
        owner = bpy.data.objects.new(part.name, self._mesh(part, simulation) if is_surface else None)
        self._link(owner)
        own = owner.pliant
        own.role = "SURFACE" if is_surface else "GROUP" if isinstance(part, pliant.Group) else "FORCE"
        if is_surface:
            self._grid(part, own)
            self._maps(part, owner, simulation.shape(part.name))
            self._cache(part, owner)
            return owner
        owner.empty_display_type = "SPHERE" if own.role == "GROUP" else "SINGLE_ARROW"
        if own.role == "FORCE":
            own.kind = type(part).__name__.upper()
        return owner

    def _link(self, owner: Any) -> None:
        self.collection.objects.link(owner)
        if self.parent:
            owner.parent = self.parent

    def _mesh(self, part: Any, simulation: Any) -> Any:
        source = simulation.shape(part.name).mesh
        _single(f"{part.name}: a coordinate", (source.positions.min(), source.positions.max()))
        made = bpy.data.meshes.new(part.name)
        meshes.fill(made, source)
        if len(made.polygons) != len(source.face_sizes):
            raise Refused(error_of(f"{part.name}: Blender refuses some of its faces"))
        made.polygons.foreach_set("use_smooth", np.ones(len(made.polygons), bool))
        return made

    def _grid(self, part: Any, own: Any) -> None:
        """What a <grid> means that a mesh must be told."""
        if not isinstance(part.shape, pliant.Grid):
            return
        if part.uv == "surface":
            own.unit = part.unit or (part.shape.width, part.shape.depth)
        else:
            own.uv = "GRID"

    def _maps(self, part: Any, owner: Any, shape: Any) -> None:
        for each in part.maps:
            numbers = self._numbers(part, each, shape)
            _single(f"{part.name}: a map of {each.channel}", numbers)
            item = owner.pliant.maps.add()
            item.channel, item.low, item.high = word(each.channel), each.low, each.high
            _single(f"{part.name}: a map of {each.channel}", (each.low, each.high))
            name = each.attribute or os.path.splitext(os.path.basename(each.file))[0] or each.channel
            there = owner.data.attributes.get(name)
            if there is None or not np.array_equal(meshes.values(owner, name), numbers.astype(np.float32)):
                there = owner.data.attributes.new(name, "FLOAT", "POINT")
                there.data.foreach_set("value", numbers.astype(np.float32))
            item.source = there.name

    def _numbers(self, part: Any, each: Any, shape: Any) -> np.ndarray:
        """What a map has at each vertex."""
        nodes = np.asarray(shape.vertex_nodes)
        if each.attribute:
            return np.asarray(shape.mesh.attributes[each.attribute])
        if each.values is not None or each.file.lower().endswith(".npy"):
            found = each.values if each.values is not None else np.load(each.file)
            is_sheet = isinstance(part.shape, pliant.Grid)
            return found.ravel() if found.ndim == 1 or is_sheet else found.ravel()[nodes]
        return _at(_picture(each.file), _uvs_of_nodes(shape.mesh, nodes))

    def _cache(self, part: Any, owner: Any) -> None:
        if not isinstance(part.cache, str):
            raise Refused(error_of(f"{part.name}: its cache is no file"))
        if not part.cache:
            return
        is_pc2 = part.cache.lower().endswith(".pc2")
        start = part.cache_start
        if start is None:
            start = _pc2(part.cache)[2] if is_pc2 else self.scene.start
        owner.pliant.rest = "MODIFIERS"
        frames, samples = _samples(part.cache, start, self.scene.fps)
        mirrored = self._mirrored(part, frames, samples)
        if is_pc2 and _pc2(part.cache)[3] == 1 and not mirrored:
            modifier = owner.modifiers.new("Cache", "MESH_CACHE")
            modifier.cache_format, modifier.filepath = "PC2", os.path.abspath(part.cache)
            modifier.deform_mode, modifier.interpolation = "OVERWRITE", "LINEAR"
            modifier.frame_start = start
            return
        wanted = range(self.first - 1, self.last + 2)
        shapes = [mirrored[each] if each in mirrored else _shape_at(frames, samples, each) for each in wanted]
        absolute_keys(owner, wanted[0], shapes)

    def _mirrored(self, part: Any, frames: np.ndarray, samples: np.ndarray) -> Dict[int, np.ndarray]:
        """Shapes ahead of and behind a cache that go on evenly, as inertia has it there, where Blender's stay."""
        if part.loop or not any(isinstance(each, pliant.Inertia) for each in self.scene.forces):
            return {}
        first = max(part.start_frame or self.scene.start, self.scene.start) - part.preroll
        found = {}
        for edge, inside, of_scene in (
            (int(np.ceil(frames[0])), 1, first),
            (int(np.floor(frames[-1])), -1, self.scene.end),
        ):
            here, there = (_shape_at(frames, samples, each).astype(float) for each in (edge, edge + inside))
            if (edge - of_scene) * inside < 0 or (here == there).all():
                continue
            if edge != of_scene:
                raise Refused(error_of(
                    f"{part.name}: its cache moves at frame {edge}, beyond which it has no samples; Blender stops "
                    "it there at once, which would be a blow"
                ))  # fmt: skip
            found[edge - inside] = (2 * here - there).astype(np.float32)
        return found

    # Attributes.

    def _set(self, part: Any, owner: Any, name: str, row: Any) -> None:
        value = getattr(part, name)
        if name == "seed" and value is None and not self.is_first and self.scene.seed != self.blender.pliant.seed:
            value = self.scene.seed  # which the scene that is there has not
        if name in _special and not (name == "axis" and isinstance(part, pliant.Surface)):
            _special[name](self, part, owner, value)
        elif name in _held and value is not None:
            own = owner.pliant
            if name in properties.SWITCHED:
                setattr(own, properties.SWITCHED[name], True)
            if row.kind in ("channel", "switch", "vector channel", "tangent"):
                self._write(part, owner, f"pliant.{name}", row, value)
            elif row.kind == "word":
                if not (name == "uv" and isinstance(part.shape, pliant.Grid) and value != "surface"):
                    setattr(own, name, word(value))
            else:
                if row.kind.endswith("integer") and not -_most <= value <= _most:
                    raise Refused(error_of(f"{part.name}: {row.attribute}={value}: Blender has none above {_most}"))
                if row.kind in ("number", "pair", "vector"):
                    _single(f"{part.name}: {row.attribute}", value)
                setattr(own, name, value)

    def _write(self, part: Any, owner: Any, path: str, row: Any, value: Any, kind: str = "") -> None:
        size = 3 if row.kind in ("vector channel", "tangent", "position") else 1
        if row.kind == "tangent" and not isinstance(value, tuple):
            is_curve = isinstance(value, pliant.Curve)
            value = value if is_curve and value.dimension == 3 else _vector_curve(value) if is_curve else (value,) * 3
        kind = kind or ("switch" if row.kind == "switch" else "vector" if size == 3 else "number")
        if isinstance(value, pliant.Curve):
            for key in value.keys:
                _single(f"{part.name}: {row.attribute}", key.value)
        elif not isinstance(value, pliant.Path):
            _single(f"{part.name}: {row.attribute}", value)
        notes = fcurves.write(
            owner, path, value, size=size, kind=kind, first=self.first, last=self.last, name=row.attribute
        )
        self.notes += [Problem("NOTE", owner.name, each) for each in notes]

    def _other(self, name: str) -> Any:
        return self.object_of[name] if name else None

    def _solve(self, part: Any, owner: Any, value: Any) -> None:
        if isinstance(part, pliant.Surface):
            owner.pliant.solve = value
        else:
            self._write(part, owner, "pliant.enabled", part._rows["enabled"], value)

    def _targets(self, _part: Any, owner: Any, value: Any) -> None:
        for name in value:
            owner.pliant.targets.add().surface = self.object_of[name]

    def _edges(self, _part: Any, owner: Any, value: Any) -> None:
        for name, each in zip(properties.EDGES, value):
            setattr(owner.pliant, name, word(each))

    def _falloff(self, _part: Any, owner: Any, value: Any) -> None:
        if isinstance(value, pliant.Curve):
            owner.pliant.falloff, owner.pliant.falloff_text = "DRAWN", _falloff_text(value)
        else:
            owner.pliant.falloff = word(value)

    def _to(self, part: Any, owner: Any, value: Any) -> None:
        end = bpy.data.objects.new(f"{owner.name}.end", None)
        end.empty_display_size = 0.25
        self._link(end)
        owner.pliant.end = end
        self._write(part, end, "location", part._rows["to"], value)

    def _direction(self, part: Any, owner: Any, value: Any) -> None:
        own = owner.pliant
        own.aim = "VECTOR"
        if value is not None:
            own.use_direction = part._rows.get("direction", part._rows.get("axis")).is_optional
            self._write(part, owner, "pliant.direction", TABLE["Point"]["direction"], value)


def _transform(name: str, path: str, kind: str = "vector") -> Callable[..., None]:
    def write(self: Import, part: Any, owner: Any, value: Any) -> None:
        self._write(part, owner, path, part._rows[name], value, kind)

    return write


def _reference(name: str) -> Callable[..., None]:
    def refer(self: Import, _part: Any, owner: Any, value: Any) -> None:
        if value:
            setattr(owner.pliant, name, self.object_of[value])

    return refer


def _nothing(*_: Any) -> None:
    pass


def _rotation_mode(_self: Import, _part: Any, owner: Any, value: str) -> None:
    owner.rotation_mode = value.upper()


def _is_standard(row: Any, value: Any) -> bool:
    standard = list(row.standard) if row.kind == "parts" else row.standard
    return type(value) is type(standard) and value == standard


# What is set otherwise than as a property of its name.
_special: Dict[str, Callable[..., None]] = {
    **{name: _nothing for name in ("name", "shape", "maps", "holds", "subdivision", "cache", "cache_start")},
    **{name: _reference(name) for name in ("driven_by", "group", "follow")},
    "enabled": Import._solve,
    "rotate_order": _rotation_mode,
    "translate": _transform("translate", "location"),
    "rotate": _transform("rotate", "rotation_euler", "rotation"),
    "scale": _transform("scale", "scale"),
    "center": _transform("center", "location"),
    "from_": _transform("from_", "location"),
    "to": Import._to,
    "direction": Import._direction,
    "axis": Import._direction,
    "edges": Import._edges,
    "targets": Import._targets,
    "falloff": Import._falloff,
}  # fmt: skip
_held = set(properties.PliantObject.__annotations__)
