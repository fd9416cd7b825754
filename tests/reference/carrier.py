"""Where a surface carries what follows it (SPEC 7), and the normals of surfaces (SPEC 7)."""

import numpy as np

from forces import Transform, rotation


def unit_normals(faces, places, transform):
    """Of nodes at world places, for faces as lists of nodes; a mirroring transform turns faces back."""
    sums, sizes = np.zeros_like(places), np.zeros(len(places))
    sign = np.sign(np.linalg.det(transform.linear))
    for size in {len(face) for face in faces}:
        alike = np.array([face for face in faces if len(face) == size])
        corners = places[alike] - places[alike[:, :1]]
        areas = sign * 0.5 * np.cross(corners, np.roll(corners, -1, axis=1)).sum(axis=1)
        for k in range(size):
            np.add.at(sums, alike[:, k], areas)
            np.add.at(sizes, alike[:, k], np.linalg.norm(areas, axis=-1))
    length = np.linalg.norm(sums, axis=-1)
    is_sound = (length >= 1e-12 * sizes) & (length > 0)
    return np.where(is_sound[:, None], sums / np.where(is_sound, length, 1)[:, None], 0.0)


def frame_of(a, b, c):
    first = (b - a) / np.linalg.norm(b - a)
    normal = np.cross(first, c - a)
    normal /= np.linalg.norm(normal)
    return np.stack([first, np.cross(normal, first), normal], axis=1)


def closest_weights(p, a, b, c):
    """Of the point of a triangle that is closest to p: the best of its inside and its edges."""
    corners = np.stack([a, b, c])
    found = []
    inside = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), p - a, rcond=None)[0]
    weights = np.array([1 - inside.sum(), *inside])
    if (weights >= 0).all():
        found.append(weights)
    for k in range(3):
        start, end = corners[k], corners[(k + 1) % 3]
        t = np.clip((p - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
        weights = np.zeros(3)
        weights[k], weights[(k + 1) % 3] = 1 - t, t
        found.append(weights)
    return min(found, key=lambda weights: np.linalg.norm(weights @ corners - p))


class Carrier:
    """The carrier of a surface: its transform, and with a cache the triangles of its rest shape."""

    def __init__(self, surface, start):
        self.surface, self.start = surface, start
        self.known = {}  # by place

    def triangles(self, frame):
        """Three corners of each triangle: faces with more corners have a centre."""
        grid = self.surface.grid
        places = grid.of_nodes(self.surface.shape.at(frame)).reshape(-1, 3)
        for face in grid.face_nodes:
            corners = places[face]
            if len(face) == 3:
                yield corners
                continue
            for k in range(len(face)):
                yield np.stack([corners[k], corners[(k + 1) % len(face)], corners.mean(axis=0)])

    def bound(self, place):
        """The number of the triangle that carries a place, and the weights of its point."""
        if tuple(place) in self.known:
            return self.known[tuple(place)]
        at_start = list(self.triangles(self.start))
        every = np.concatenate(at_start)
        near = 1e-9 * np.linalg.norm(every.max(axis=0) - every.min(axis=0))
        weights = [closest_weights(place, *corners) for corners in at_start]
        away = [np.linalg.norm(w @ corners - place) for w, corners in zip(weights, at_start)]
        first = next(k for k, one in enumerate(away) if one <= min(away) + near)
        self.known[tuple(place)] = first, weights[first]
        return first, weights[first]

    def moved(self, frame, place):
        """The place in object space, and the turn of its triangle since the start."""
        if not self.surface.is_animated:
            return place, np.eye(3)
        triangle, weights = self.bound(place)
        before = list(self.triangles(self.start))[triangle]
        now = list(self.triangles(frame))[triangle]
        turn = frame_of(*now) @ frame_of(*before).T
        return weights @ now + turn @ (place - weights @ before), turn

    def place(self, frame, place):
        return Transform(self.surface, frame).to_world(self.moved(frame, place)[0])

    def turn(self, frame, place):
        return Transform(self.surface, frame).linear @ self.moved(frame, place)[1]

    def rotation(self, frame, place):
        degrees = self.surface.channels["rotate"](frame)
        return rotation(self.surface.rotate_order, degrees) @ self.moved(frame, place)[1]
