"""Meshes that are read as surfaces of triangles (SPEC 8)."""

import collections
import math

import numpy as np
from scipy.spatial import cKDTree

FLAT = 1e-8  # the shorter edges of a triangle exceed the longest by at least this part of it
BORDERS = ("clamped", "pinned", "free")


def read_obj_corners(path):
    """Positions, and for each face its corners (vertex, (u,v) or None), in file order."""
    positions, coordinates, faces = [], [], []
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            words = line.split("#")[0].split()
            if not words:
                continue
            if words[0] == "v":
                positions.append([float(word) for word in words[1:4]])
            elif words[0] == "vt":
                coordinates.append(np.array([float(words[1]), float(words[2])]))
            elif words[0] == "f":
                face = []
                for corner in words[1:]:
                    parts = corner.split("/")
                    vertex = int(parts[0])
                    vertex += len(positions) if vertex < 0 else -1
                    uv = None
                    if len(parts) > 1 and parts[1]:
                        texture = int(parts[1])
                        uv = coordinates[texture if texture < 0 else texture - 1]
                    face.append((vertex, uv))
                faces.append(face)
    return np.array(positions), faces


def joined(count, pairs):
    """The lowest member of each one's class, when the pairs are equal."""
    root = list(range(count))

    def find(k):
        while root[k] != k:
            root[k] = root[root[k]]
            k = root[k]
        return k

    for p, q in pairs:
        p, q = find(p), find(q)
        root[max(p, q)] = min(p, q)
    return [find(k) for k in range(count)]


def corners_left(face):
    """The face without corners that repeat the node before them, around."""
    return [corner for k, corner in enumerate(face) if corner[0] != face[k - 1][0]]


def edge(p, q):
    return (p, q) if p < q else (q, p)


class TriangleMesh:
    """Nodes, triangles and their layout in the plane.

    A *point* is a node, or the centre of a face: point len(rest) + k is that of `centre_corners[k]`.
    `triangles` holds three points each, `layout[t]` their places along u and v, in lengths.
    """

    def __init__(self, vertices, faces, unit=None, axis=None, border="clamped", weld=None):
        assert border in BORDERS
        self.vertices, self.border = vertices, border
        used = sorted({vertex for face in faces for vertex, _ in face})
        self.diagonal = float(np.linalg.norm(vertices[used].ptp(axis=0)))
        weld = 1e-6 * self.diagonal if weld is None else weld
        pairs = cKDTree(vertices[used]).query_pairs(weld)
        lowest = joined(len(used), pairs)
        number = {first: k for k, first in enumerate(sorted(set(lowest)))}
        self.node_of = np.full(len(vertices), -1)  # -1: a vertex in no face
        for vertex, first in zip(used, lowest):
            self.node_of[vertex] = number[first]
        self.lowest = [used[first] for first in number]
        self.rest = vertices[self.lowest]
        self.held = np.zeros(len(self.rest), dtype=bool)  # by a <hold>

        self.centre_corners, self.triangles, coordinates = [], [], []
        self.faces_of_node = collections.defaultdict(list)  # the centres' faces, by number
        self.faces = []  # nodes
        seen = set()
        for face in faces:
            face = corners_left([(int(self.node_of[vertex]), uv) for vertex, uv in face])
            nodes = [node for node, _ in face]
            takes_part = (len(nodes) >= 3 and len(set(nodes)) == len(nodes) and
                          frozenset(nodes) not in seen)
            if not takes_part:
                continue
            seen.add(frozenset(nodes))
            uvs = [uv for _, uv in face]
            has_uvs = all(uv is not None for uv in uvs)
            centre = None
            if len(nodes) > 3:
                centre = len(self.rest) + len(self.centre_corners)
                self.centre_corners.append(nodes)
            for node in nodes:
                self.faces_of_node[node].append(len(self.faces))
            self.faces.append((nodes, centre))
            if centre is None:
                self.triangles.append(tuple(nodes))
                coordinates.append(uvs if has_uvs else None)
                continue
            middle = sum(uvs) / len(uvs) if has_uvs else None
            for k, node in enumerate(nodes):
                following = (k + 1) % len(nodes)
                self.triangles.append((node, nodes[following], centre))
                coordinates.append([uvs[k], uvs[following], middle] if has_uvs else None)
        assert self.triangles
        self.face_nodes = [nodes for nodes, _ in self.faces]
        self.points = np.concatenate([self.rest] + [
            self.rest[nodes].mean(axis=0)[None] for nodes in self.centre_corners])

        self.triangles_at = collections.Counter()
        for corners in self.triangles:
            for k in range(3):
                self.triangles_at[edge(corners[k], corners[(k + 1) % 3])] += 1
        self.is_border = np.zeros(len(self.rest), dtype=bool)
        for (p, q), count in self.triangles_at.items():
            if count == 1:
                self.is_border[[p, q]] = True

        self.layout = [lay_out(self.points[list(corners)], uvs, axis)
                       for corners, uvs in zip(self.triangles, coordinates)]
        area = sum(area_of(places) for places in self.layout)
        self.unit = np.broadcast_to(math.sqrt(area) if unit is None else unit, 2)

    def at_points(self, node_values):
        """Values at nodes and centres, which have the mean of their corners'."""
        if not self.centre_corners:
            return np.array(node_values)
        means = [np.mean(node_values[nodes], axis=0) for nodes in self.centre_corners]
        return np.concatenate([node_values, means])

    def of_nodes(self, vertices):
        """Positions of vertices as those of nodes."""
        return vertices[self.lowest]

    def displaced(self, vertices, w):
        """The positions of all vertices, displaced; those of a node share its displacement."""
        result = vertices.copy()
        is_used = self.node_of >= 0
        result[is_used] += w[self.node_of[is_used]]
        return result


def cross(a, b):
    """np.cross of two vectors takes ten times as long."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]])


def area_of(places):
    (a, b), (c, d) = places[1] - places[0], places[2] - places[0]
    return abs(a * d - b * c) / 2


def lay_out(corners, uvs, axis):
    """Places of a triangle's corners along u and v (SPEC 8, "Units and directions"), 3 x 2."""
    lengths = [float(np.linalg.norm(corners[(k + 1) % 3] - corners[k])) for k in range(3)]
    longest = max(lengths)
    missing = FLAT * longest - (sum(lengths) - 2 * longest)
    if missing > 0:
        return lay_out_flat([length + missing for length in lengths], FLAT * longest)
    normal = cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)
    u, v = directions(corners, normal, uvs, axis)
    return np.stack([(corners - corners[0]) @ u, (corners - corners[0]) @ v], axis=1)


def lay_out_flat(lengths, excess):
    """By edge lengths alone, the longest edge along u; the two others exceed it by `excess`."""
    first = int(np.argmax(lengths))
    base, next_edge, last = (lengths[(first + k) % 3] for k in range(3))
    along = (base**2 + last**2 - next_edge**2) / (2 * base)
    # Heron, without the differences of lengths that cancel.
    half = base + excess / 2
    area = math.sqrt(half * excess / 2 * (half - next_edge) * (half - last))
    places = np.zeros((3, 2))
    places[(first + 1) % 3] = base, 0
    places[(first + 2) % 3] = along, 2 * area / base
    return places


def directions(corners, normal, uvs, axis):
    """The unit vectors u and v of a triangle that is not flat."""
    if axis is None and uvs is not None:
        (a, b), (c, d) = uvs[1] - uvs[0], uvs[2] - uvs[0]
        determinant = a * d - b * c
        if abs(determinant) > 1e-12 * max(a * a + b * b, c * c + d * d):
            first, second = corners[1] - corners[0], corners[2] - corners[0]
            along_u = (d * first - b * second) / determinant
            along_v = (a * second - c * first) / determinant
            u = along_u / np.linalg.norm(along_u)
            v = cross(normal, u)
            return u, (v if v @ along_v > 0 else -v)
    axis = np.array([1.0, 0.0, 0.0]) if axis is None else np.asarray(axis, dtype=float)
    for candidate in (axis, np.roll(axis, 1)):  # (x,y,z), then (z,x,y)
        projected = candidate - (candidate @ normal) * normal
        if np.linalg.norm(projected) >= 0.1 * np.linalg.norm(candidate):
            break
    else:
        projected = corners[1] - corners[0]
    u = projected / np.linalg.norm(projected)
    return u, cross(normal, u)
