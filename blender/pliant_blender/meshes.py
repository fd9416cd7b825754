"""Meshes of objects as meshes of scenes, and weights and attributes as the values of maps."""

from __future__ import annotations

import itertools
from typing import Any, Dict, List, Optional, Tuple

import bpy
import numpy as np

from . import pliant

_read: Dict[str, Tuple[Any, Any]] = {}  # by the mesh's name: what it looked like, and what was made of it
_editions: Dict[str, Tuple[np.ndarray, int]] = {}
_numbers = itertools.count()
_values: Dict[Tuple[str, str], np.ndarray] = {}  # of attributes, for edit mode in which they cannot be read
_weights: Dict[Tuple[str, Tuple[str, ...]], np.ndarray] = {}  # of vertex groups, which take long to read


def positions(mesh: Any) -> np.ndarray:
    """The positions as modelled, those of the Basis if there is one: float32 (V, 3)."""
    keys = mesh.shape_keys
    points = keys.reference_key.data if keys else mesh.vertices
    found = np.empty(3 * len(mesh.vertices), np.float32)
    points.foreach_get("co", found)
    return found.reshape(-1, 3)


def look(mesh: Any, uv_map: str) -> Tuple[Any, ...]:
    """A cheap fingerprint: what an edit that nobody announced could have changed without adding or removing."""
    layer = mesh.uv_layers.get(uv_map) if uv_map else mesh.uv_layers.active
    counts = len(mesh.vertices), len(mesh.polygons), len(mesh.loops)
    return counts, layer.name if layer else None, _edition(mesh)


def _edition(mesh: Any) -> int:
    """A number that is another one once a position is."""
    found = positions(mesh)
    known = _editions.get(mesh.name_full)
    if known and known[0].shape == found.shape and (known[0].view(np.int32) == found.view(np.int32)).all():
        return known[1]
    _editions[mesh.name_full] = found, next(_numbers)
    return _editions[mesh.name_full][1]


def _faces(mesh: Any) -> Any:
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    starts, sizes = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.polygons.foreach_get("loop_total", sizes)
    even = len(sizes) and (sizes == sizes[0]).all() and (starts == np.arange(len(sizes)) * sizes[0]).all()
    order = None
    if not even:
        order = np.concatenate([np.arange(a, a + n) for a, n in zip(starts, sizes)]) if len(sizes) else corners
    flat = corners if order is None else corners[order]
    if even:
        return flat.reshape(-1, sizes[0]), order
    return np.split(flat, np.cumsum(sizes)[:-1]), order


def read(mesh: Any, uv_map: str, is_stale: bool) -> Any:
    """The mesh of a scene: exact, in Blender's order. Raises pliant.Error for what no mesh may be.

    `is_stale`: an update told that more than what `look` sees may have changed.
    """
    seen = look(mesh, uv_map)
    known = _read.get(mesh.name_full)
    if mesh.is_editmode:  # in which it has no UVs; what is edited acts when edit mode is left
        if known:
            return known[1]
        raise pliant.InvalidInput("it is in edit mode; it moves when that is left")
    if known and known[0] == seen and not is_stale:
        return known[1]
    if uv_map and uv_map not in mesh.uv_layers:
        raise pliant.InvalidInput(f"there is no UV map {uv_map!r}")
    layer = mesh.uv_layers.get(uv_map) if uv_map else mesh.uv_layers.active
    faces, order = _faces(mesh)
    more: Dict[str, Any] = {}
    if layer and len(mesh.loops):
        uvs = np.empty(2 * len(mesh.loops), np.float32)
        layer.data.foreach_get("uv", uvs)
        uvs = uvs.reshape(-1, 2)
        if order is not None:
            uvs = uvs[order]
        # Pairs as one number each, which sorts many times faster; a zero has one sign.
        pairs, more["corner_uvs"] = np.unique((uvs + np.float32(0)).view(np.uint64).ravel(), return_inverse=True)
        more["uvs"] = pairs.view(np.float32).reshape(-1, 2)
    made = pliant.Mesh(positions(mesh), faces, **more)
    if known and known[1] == made:
        made = known[1]
    _read[mesh.name_full] = seen, made
    return made


def values(owner: Any, source: str, is_stale: bool = True) -> Optional[np.ndarray]:
    """The numbers at the vertices: of a vertex group, else of an attribute of the points; None: neither."""
    mesh, key = owner.data, (owner.data.name_full, source)
    group = owner.vertex_groups.get(source)
    count = len(mesh.vertices)
    if group is not None:
        index, found = group.index, np.zeros(count)
        among = mesh.name_full, (source, *(each.name for each in owner.vertex_groups))
        known = _weights.get(among)
        if not is_stale and known is not None and len(known) == count:
            return known
        for number, vertex in enumerate(mesh.vertices):
            for each in vertex.groups:
                if each.group == index:
                    found[number] = each.weight
        _weights[among] = found
        return found
    attribute = mesh.attributes.get(source)
    if attribute is None or attribute.domain != "POINT":
        return None
    if mesh.is_editmode:
        return _values.get(key)
    if attribute.data_type == "FLOAT":
        found = np.empty(count, np.float32)
        attribute.data.foreach_get("value", found)
    elif attribute.data_type in ("FLOAT_COLOR", "BYTE_COLOR"):
        found = np.empty(4 * count, np.float32)
        attribute.data.foreach_get("color", found)
        found = found[::4]
    else:
        return None
    _values[key] = found.astype(float)
    return _values[key]


def fill(mesh: Any, source: Any, uv_name: str = "UVMap") -> None:
    """Makes the geometry of an empty mesh of Blender from a mesh of a scene, in its order."""
    corners = np.asarray(source.corner_vertices, np.int32)
    sizes = np.asarray(source.face_sizes, np.int32)
    mesh.vertices.add(len(source.positions))
    mesh.vertices.foreach_set("co", np.asarray(source.positions, np.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(sizes))
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int32) if len(sizes) else sizes
    mesh.polygons.foreach_set("loop_start", starts)
    mesh.polygons.foreach_set("loop_total", sizes)
    mesh.update(calc_edges=True)
    indices = np.asarray(source.corner_uvs)
    if len(indices) and (indices >= 0).any():
        layer = mesh.uv_layers.new(name=uv_name, do_init=False)
        uvs = np.where(indices[:, None] >= 0, source.uvs[indices], 0).astype(np.float32)
        layer.data.foreach_set("uv", uvs.ravel())
    for name, numbers in source.attributes.items():
        mesh.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", np.asarray(numbers, np.float32))
    mesh.validate()


def forget() -> None:
    """Forgets what was read, but for meshes in edit mode, which cannot be read again until that is left."""
    edited = {each.name_full for each in bpy.data.meshes if each.is_editmode}
    for name in set(_read) - edited:
        del _read[name]
    for kept in (_values, _weights):
        for key in [key for key in kept if key[0] not in edited]:
            del kept[key]
    _editions.clear()


def names_of(owner: Any) -> List[str]:
    """What can be the source of a map."""
    points = [each.name for each in owner.data.attributes if each.domain == "POINT"]
    return [group.name for group in owner.vertex_groups] + points
