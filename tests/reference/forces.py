"""Transforms and forces (SPEC 7)."""

import itertools
import math

import numpy as np

from curves import Curve


def rotation(order, degrees):
    """R; the first letter of `order` is applied first."""
    result = np.eye(3)
    for letter in order:
        axis = "xyz".index(letter)
        angle = math.radians(degrees[axis])
        turn = np.eye(3)
        p, q = (axis + 1) % 3, (axis + 2) % 3
        turn[p, p] = turn[q, q] = math.cos(angle)
        turn[q, p], turn[p, q] = math.sin(angle), -math.sin(angle)
        result = turn @ result
    return result


class Transform:
    """p_world = T + R S p."""

    def __init__(self, surface, frame):
        self.translate = surface.channels["translate"](frame)
        degrees, scale = surface.channels["rotate"](frame), surface.channels["scale"](frame)
        assert (scale != 0).all()
        self.is_identity = not (self.translate.any() or degrees.any() or (scale != 1).any())
        self.linear = rotation(surface.rotate_order, degrees) @ np.diag(scale)

    def to_world(self, points):
        if self.is_identity:
            return points.copy()
        return self.translate + points @ self.linear.T

    def vector_to_object(self, vectors):
        """Vectors enter object space through the inverse linear part."""
        if self.is_identity:
            return vectors.copy()
        return np.linalg.solve(self.linear, vectors.reshape(-1, 3).T).T.reshape(vectors.shape)


def closest_point(force, frame, points):
    """The point of the force's centre or segment that is closest to each of `points`."""
    if force.kind in ("point", "radial", "noise", "pressure"):
        return np.broadcast_to(force.sample("center", frame), points.shape)
    if force.kind in ("uniform", "inertia"):
        return points
    if force.kind == "vortex":
        center, axis = force.sample("center", frame), force.sample("axis", frame)
        squared_length = axis @ axis
        t = (points - center) @ axis / squared_length if squared_length else np.zeros(())
        return center + t[..., None] * axis
    start, end = force.sample("from", frame), force.sample("to", frame)
    along = end - start
    squared_length = along @ along
    if squared_length == 0:
        return np.broadcast_to(start, points.shape)
    t = np.clip((points - start) @ along / squared_length, 0.0, 1.0)
    return start + t[..., None] * along


def distances(force, frame, points):
    """delta at each point."""
    offset = points - closest_point(force, frame, points)
    return np.sqrt((offset**2).sum(axis=-1))


def falloff(force, s):
    """falloff(s), s = delta/forceRadius."""
    if isinstance(force.falloff, Curve):
        return np.array([force.falloff(at)[0] for at in s.ravel()]).reshape(s.shape)
    if force.falloff == "constant":
        return np.ones_like(s)
    if force.falloff == "linear":
        return np.maximum(0.0, 1 - s)
    if force.falloff == "smooth":
        x = np.clip(1 - s, 0.0, 1.0)
        return x * x * (3 - 2 * x)
    return np.exp(-4.5 * s * s)


def has_direction(force):
    """Whether the force's direction does not depend on the direction from a node to the force."""
    return (force.kind in ("point", "uniform", "noise", "inertia", "pressure") or
            (force.kind == "line" and force.channels["direction"]))


def mixed(bits):
    """Eq. (18) of docs/model.md, for an array of unsigned 64-bit integers."""
    bits = bits + np.uint64(0x9e3779b97f4a7c15)
    bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xbf58476d1ce4e5b9)
    bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94d049bb133111eb)
    return bits ^ (bits >> np.uint64(31))


def noise(seed, places):
    """Eq. (19) and (20) of docs/model.md; `places` are ... x 4, in cells of x, y, z and time."""
    cell = np.floor(places)
    f = places - cell
    weight = f**3 * (6 * f**2 - 15 * f + 10)
    total = np.zeros(places.shape[:-1] + (3,))
    with np.errstate(over="ignore"):
        for corner in itertools.product((0, 1), repeat=4):
            bits = mixed(np.full(places.shape[:-1], seed, dtype=np.uint64))
            share = np.ones(places.shape[:-1])
            for axis, step in enumerate(corner):
                index = (cell[..., axis] + step).astype(np.int64).astype(np.uint64)
                bits = mixed(bits ^ index)
                share = share * (weight[..., axis] if step else 1 - weight[..., axis])
            for k in range(3):
                part = (bits >> np.uint64(21 * k)) & np.uint64(2**21 - 1)
                total[..., k] += share * (2 * part.astype(float) / (2**21 - 1) - 1)
    return total


def unit_forces(force, frame, points, run, nodes):
    """The force per magnitude and falloff at each point, in world space; `run` is the surface's, of
    which the points are these `nodes`."""
    if force.kind == "noise":
        turn = force.carrier.rotation(frame, force.first_place(frame)) if force.carrier else np.eye(3)
        place = force.sample("frequency", frame) * ((points - force.sample("center", frame)) @ turn)
        # Each frame since the start at its own rate.
        start = run.scene.start
        rates = [force.sample("rate", before) for before in range(start, frame)]
        rates += [-force.sample("rate", before) for before in range(frame, start)]  # in a preroll
        time = (force.sample("rate", start) * start + sum(rates)) / float(run.scene.fps)
        time = np.broadcast_to(time, points.shape[:-1] + (1,))
        return noise(force.seed, np.concatenate([place, time], axis=-1)) @ turn.T
    if force.kind == "inertia":
        before, now, after = (Transform(run.surface, frame + step) for step in (-1, 0, 1))
        p = np.linalg.solve(now.linear, (points - now.translate).reshape(-1, 3).T).T
        # The places of the point with this displacement (SPEC 9): 0 with measure="rest".
        shapes = [run.surface.grid.of_nodes(shape)[nodes] for shape in run.surface.shape.around(frame)]
        w = p.reshape(points.shape) - shapes[1]
        acceleration = sum(weight * (transform.translate + (shape + w) @ transform.linear.T)
                           for weight, transform, shape in zip((1, -2, 1), (before, now, after), shapes))
        length = run.surface.frame_length(frame, run.scene.fps)
        return -run.surface.sample("density", frame) * acceleration / length**2
    if force.kind == "vortex":
        axis = force.sample("axis", frame)
        length = math.sqrt(axis @ axis)
        if length == 0:
            return np.zeros_like(points)
        outward = unit_directions(force, frame, points)
        return np.cross(axis / length, outward) - force.sample("pull", frame) * outward
    return unit_directions(force, frame, points)


def pushes(force, frame, points, run, nodes, normals):
    """The force per magnitude and falloff on nodes with these normals."""
    if force.kind == "pressure":
        return normals
    free = unit_forces(force, frame, points, run, nodes)
    if force.along == "free":
        return free
    return (free * normals).sum(axis=-1)[..., None] * normals


def unit_directions(force, frame, points):
    """n at each point, in world space; a direction of length 0 gives no force."""
    if has_direction(force):
        direction = force.sample("direction", frame)
        length = math.sqrt(direction @ direction)
        unit = direction / length if length > 0 else np.zeros(3)
        return np.broadcast_to(unit, points.shape)
    outward = points - closest_point(force, frame, points)
    distance = distances(force, frame, points)
    safe = np.where(distance > 0, distance, 1.0)
    return np.where((distance > 0)[..., None], outward / safe[..., None], 0.0)


class GroupSphere:
    """A group's region, as a point force for the diagnostics."""

    kind = "point"

    def __init__(self, group):
        self.channels = {"direction": True}
        self.center = group.place

    def sample(self, name, frame):
        assert name == "center"
        return self.center(frame)
