"""Closed meshes as colliders (docs/model.md, "Contact"): every triangle, at every place.

What is inside is told by the solid angle under which the triangles are seen, not by their normals.
"""

import numpy as np

from triangle_mesh import TriangleMesh


class Near:
    """The place of a mesh that is closest to another one."""

    def __init__(self, distance, normal, corners, weights):
        self.distance, self.normal, self.corners, self.weights = distance, normal, corners, weights

    def at(self, points):
        """Where it is if the points of the mesh are there."""
        return self.weights @ points[self.corners]


class ClosedMesh:
    """The triangles of a mesh, and its shape over time."""

    def __init__(self, vertices, faces, shape):
        self.mesh, self.shape = TriangleMesh(vertices, faces), shape
        self.triangles = np.array(self.mesh.triangles)
        for p, q in self.mesh.triangles_at:
            assert self.mesh.triangles_at[p, q] == 2, "it is not closed"

    def points_of(self, vertices):
        nodes = vertices[self.mesh.lowest]
        return np.concatenate([nodes] + [nodes[corners].mean(axis=0)[None]
                                         for corners in self.mesh.centre_corners])

    def points_at(self, frame):
        return self.points_of(self.shape.at(frame))

    def near(self, points, x):
        corners = points[self.triangles]
        weights = closest_weights(corners, x)
        feet = np.einsum("tk,tkj->tj", weights, corners)
        distances = np.linalg.norm(x - feet, axis=1)
        # Of equally close ones the first: rounding must not choose.
        chosen = int(np.flatnonzero(distances <= distances.min() * (1 + 1e-12))[0])
        distance = distances[chosen]
        diagonal = np.linalg.norm(points.ptp(axis=0))
        sign = -1.0 if abs(solid_angle(corners, x)) > 2 * np.pi else 1.0
        if distance > 1e-9 * diagonal:
            normal = sign * (x - feet[chosen]) / distance
        else:
            normal = outwards(corners) * normal_at(corners, feet[chosen], 1e-9 * diagonal)
            if distance > 0 and normal @ (x - feet[chosen]) < 0:
                sign = -1.0
            else:
                sign = 1.0
        return Near(sign * distance, normal, self.triangles[chosen], weights[chosen])


def outwards(corners):
    """1 if the triangles look outwards, -1 if they look inwards."""
    return np.sign(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum())


def closest_weights(corners, x):
    """For each triangle the weights of its corners at the place that is closest."""
    best = np.full(len(corners), np.inf)
    weights = np.zeros((len(corners), 3))

    def take(candidate, where):
        feet = np.einsum("tk,tkj->tj", candidate, corners)
        squared = ((x - feet) ** 2).sum(axis=1)
        is_better = where & (squared < best)
        best[is_better] = squared[is_better]
        weights[is_better] = candidate[is_better]

    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = np.cross(b - a, c - a)
    size = (area**2).sum(axis=1)
    share_b = (np.cross(x - a, c - a) * area).sum(axis=1) / size
    share_c = (np.cross(b - a, x - a) * area).sum(axis=1) / size
    inside = np.stack([1 - share_b - share_c, share_b, share_c], axis=1)
    take(inside, (inside >= 0).all(axis=1))
    for k in range(3):
        following = (k + 1) % 3
        side = corners[:, following] - corners[:, k]
        share = ((x - corners[:, k]) * side).sum(axis=1) / (side**2).sum(axis=1)
        candidate = np.zeros((len(corners), 3))
        candidate[:, following] = np.clip(share, 0, 1)
        candidate[:, k] = 1 - candidate[:, following]
        take(candidate, np.ones(len(corners), dtype=bool))
    return weights


def solid_angle(corners, x):
    """Under which the triangles are seen: 4 pi from within, 0 from outside (van Oosterom, Strackee 1983)."""
    a, b, c = (corners[:, k] - x for k in range(3))
    lengths = [np.linalg.norm(p, axis=1) for p in (a, b, c)]
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = (lengths[0] * lengths[1] * lengths[2] + (a * b).sum(axis=1) * lengths[2]
             + (a * c).sum(axis=1) * lengths[1] + (b * c).sum(axis=1) * lengths[0])
    return 2 * np.arctan2(above, below).sum()


def normal_at(corners, place, near):
    """The normals of the triangles there, each weighted by its angle."""
    total = np.zeros(3)
    weights = closest_weights(corners, place)
    feet = np.einsum("tk,tkj->tj", weights, corners)
    for triangle, foot in zip(corners, feet):
        if np.linalg.norm(foot - place) > near:
            continue
        normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        angle = 2 * np.pi
        for k in range(3):
            side = triangle[(k + 1) % 3] - triangle[k]
            across = np.linalg.norm(np.cross(side, place - triangle[k])) / np.linalg.norm(side)
            if across <= near:
                angle = np.pi
        for k in range(3):
            if np.linalg.norm(triangle[k] - place) <= near:
                one, other = (triangle[(k + j) % 3] - triangle[k] for j in (1, 2))
                angle = np.arccos(one @ other / np.linalg.norm(one) / np.linalg.norm(other))
        total += angle * normal / np.linalg.norm(normal)
    return total / np.linalg.norm(total)
