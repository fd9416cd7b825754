"""Colliders (docs/model.md, "Contact"): literally and slowly.

First contacts are found by looking for the least of a convex function and halving intervals, those with meshes by
going no farther than is sure, forces by non-negative least squares.
"""

import numpy as np
import scipy.linalg
import scipy.optimize

from contact_mesh import ClosedMesh
from forces import Transform, rotation

GOLDEN = (np.sqrt(5) - 1) / 2


def mixed(channel, frame, a):
    """A channel at part `a` of the way from a frame to the next."""
    return (1 - a) * channel(frame) + a * channel(frame + 1)


class Mixed(Transform):
    """A surface's transform on the way from a frame to the next."""

    def __init__(self, surface, frame, a):
        self.translate = mixed(surface.channels["translate"], frame, a)
        degrees, scale = (mixed(surface.channels[name], frame, a) for name in ("rotate", "scale"))
        self.is_identity = False
        self.linear = rotation(surface.rotate_order, degrees) @ np.diag(scale)


class Pose:
    """A collider in the world: where it is, and its lengths."""

    def __init__(self, collider, frame, a):
        self.kind = collider.kind
        at = {name: mixed(channel, frame, a) for name, channel in collider.channels.items()}
        self.translate = at["translate"]
        self.rotation = rotation(collider.rotate_order, at["rotate"])
        scale = np.abs(at["scale"])
        self.lengths = np.zeros(5)  # size or radius and length, round, offset; the points of a mesh
        if isinstance(self.kind, ClosedMesh):
            ends = [self.kind.points_at(k) for k in (frame, frame + 1)]
            points = ((1 - a) * ends[0] + a * ends[1]) * at["scale"]
            self.lengths = np.concatenate([self.lengths, points.ravel()])
        elif self.kind == "box":
            self.lengths[:3] = at["size"] * scale
            self.lengths[3] = at["round"][0]
        elif self.kind != "plane":
            self.lengths[0] = at["radius"][0] * scale[0]
            if self.kind == "capsule":
                self.lengths[1] = at["length"][0] * scale[0]
        self.lengths[4] = at["offset"][0]
        self.friction = collider.sample("friction", frame)
        self.sticks = collider.stick(frame)[0] != 0

    def to_frame(self, point):
        return self.rotation.T @ (point - self.translate)


def gap_and_normal(kind, lengths, x):
    """gamma and n (8q)."""
    offset = lengths[4]
    if isinstance(kind, ClosedMesh):
        near = kind.near(points_of(lengths), x)
        return near.distance - offset, near.normal
    if kind == "plane":
        return x[1] - offset, np.array([0.0, 1.0, 0.0])
    if kind in ("sphere", "capsule"):
        half = lengths[1] / 2
        way = x - np.array([0.0, np.clip(x[1], -half, half), 0.0])
        length = np.linalg.norm(way)
        fallback = np.eye(3)[1 if kind == "sphere" else 0]
        return length - lengths[0] - offset, way / length if length > 0 else fallback
    beyond = np.abs(x) - (lengths[:3] / 2 - lengths[3])
    signs = np.where(x < 0, -1.0, 1.0)
    if (beyond <= 0).all():
        k = int(np.argmax(beyond))
        return beyond[k] - lengths[3] - offset, signs[k] * np.eye(3)[k]
    way = np.maximum(beyond, 0) * signs
    length = np.linalg.norm(way)
    return length - lengths[3] - offset, way / length


def points_of(lengths):
    return lengths[5:].reshape(-1, 3)


def least_gap(kind, lengths, x):
    """gamma is not less: what is outside the box of a mesh is as far from it as from that."""
    if not isinstance(kind, ClosedMesh):
        return -np.inf
    points = points_of(lengths)
    way = np.maximum(np.maximum(points.min(axis=0) - x, x - points.max(axis=0)), 0)
    return np.linalg.norm(way) - lengths[4] if way.any() else -np.inf


def first_contact_with_mesh(mesh, before, after, x0, x1, slack, note):
    """The same for a mesh, whose distance is not convex."""
    def gap(t):
        return gap_and_normal(mesh, (1 - t) * before + t * after, (1 - t) * x0 + t * x1)[0]

    change = after - before
    fastest = (np.linalg.norm(x1 - x0) + abs(change[4])
               + np.linalg.norm(points_of(change), axis=1).max())
    if least_gap(mesh, before, x0) > fastest or gap(0.0) > fastest:
        return None

    def entry(outside, inside):
        for _ in range(60):
            middle = (outside + inside) / 2
            outside, inside = (middle, inside) if gap(middle) > 0 else (outside, middle)
        return inside

    first, t, lowest = None, 0.0, np.inf
    trail = []  # the last two moments and their gaps
    while True:
        now = gap(t)
        lowest = min(lowest, now)
        if len(trail) == 2 and min(trail[0][1], now) - trail[1][1] > 1e-3 * slack:
            # Between such moments it may be lower still.
            deepest = least(gap, trail[0][0], t)
            lowest = min(lowest, gap(deepest))
            if gap(deepest) < -slack:
                note(lowest + slack)
                return first if first is not None else entry(trail[deepest > trail[1][0]][0], deepest)
        if now <= 0 and first is None:
            first = entry(trail[-1][0], t) if trail else 0.0
        if now < -slack or t >= 1:
            note(lowest + slack)
            return first if now < -slack else None
        if now > 0:
            first = None
        trail = trail[-1:] + [(t, now)]
        t = min(1.0, t + max(abs(now) / fastest if fastest > 0 else 1.0, 1 / 4000))


def support(kind, lengths, n):
    if kind == "plane":
        return 0.0
    if kind == "box":
        return float(np.abs(n) @ (lengths[:3] / 2 - lengths[3]) + lengths[3])
    return abs(n[1]) * lengths[1] / 2 + lengths[0]


def first_contact(kind, before, after, x0, x1, slack, note):
    """t of the first contact on a straight way; None: there is none. `note` is told by what length there is one."""
    if isinstance(kind, ClosedMesh):
        return first_contact_with_mesh(kind, before, after, x0, x1, slack, note)

    def gap(t):
        return gap_and_normal(kind, (1 - t) * before + t * after, (1 - t) * x0 + t * x1)[0]

    most = np.linalg.norm(x1 - x0) + 2 * np.abs(after - before).sum()
    if gap(0.0) > most:  # a distance changes no faster
        return None
    lowest = 0.0 if gap(0.0) < -slack else least(gap)
    note(gap(lowest) + slack)
    if not gap(lowest) < -slack:
        return None
    if gap(0.0) <= 0:
        return 0.0
    low, high = 0.0, lowest
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if gap(middle) > 0 else (low, middle)
    return high


def least(gap, begin=0.0, end=1.0):
    """Where a convex function is least between two places."""
    low, high = begin, end
    for _ in range(45):
        one, other = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, other) if gap(one) < gap(other) else (one, high)
    return min((begin, low, high, end), key=gap)


class Row:
    """A half-space of a node (8r); `place` is where it touched, as the collider carried it."""

    def __init__(self, index, collider, normal, height, place):
        self.index, self.collider = index, collider
        self.normal, self.height, self.place = normal, height, place
        self.friction, self.sticks = collider.friction, collider.sticks

    def lack(self, point):
        return self.height - self.normal @ point


class Rows:
    """Rows so chosen that all can be satisfied; `diagonal` is the length of which lengths are a part."""

    def __init__(self, diagonal, diagnostics):
        self.of_nodes, self.diagonal, self.diagnostics = {}, diagonal, diagnostics

    def note_angles(self, row, own):
        for other in own:
            cosine = row.normal @ other.normal
            self.diagnostics.note_rows(min(abs(cosine + 0.8), abs(cosine - 0.999)))
        if len(own) == 2:
            self.diagnostics.note_rows(abs(abs(np.linalg.det([own[0].normal, own[1].normal, row.normal])) - 0.1))

    def add(self, row, point):
        own = self.of_nodes.setdefault(row.index, [])
        if own and own[0].sticks:
            return
        if row.sticks:
            own[:] = [row]
            return
        self.note_angles(row, own)
        if any(row.normal @ other.normal < -0.8 for other in own):
            return
        for k, other in enumerate(own):
            if row.normal @ other.normal > 0.999:
                if np.abs(row.normal - other.normal).max() > 1e-9:
                    self.diagnostics.note_touch((row.lack(point) - other.lack(point)) / self.diagonal)
                if row.lack(point) > other.lack(point):
                    own[k] = row
                return
        if len(own) > 2 or len(own) == 2 and abs(np.linalg.det(
                [own[0].normal, own[1].normal, row.normal])) < 0.1:
            return
        own.append(row)

    def all(self):
        return [row for _, own in sorted(self.of_nodes.items()) for row in own]


class FrameContact:
    """The colliders that a surface meets in the solve at a frame; `rest(a)` are its nodes at rest."""

    def __init__(self, surface, colliders, frame, count, rest, diagnostics):
        self.surface, self.frame, self.count, self.rest = surface, frame, count, rest
        self.colliders, self.diagnostics = colliders, diagnostics
        world = Mixed(surface, frame, 0.0).to_world(rest(0.0)).reshape(-1, 3)
        self.diagonal = float(np.linalg.norm(world.ptp(axis=0)))
        self.slack = 1e-9 * self.diagonal

    def note(self, length):
        self.diagnostics.note_touch(length / self.diagonal)

    def poses(self, step):
        return [Pose(one, self.frame, step / self.count) for one in self.colliders]

    def transform(self, step):
        return Mixed(self.surface, self.frame, step / self.count)

    def world(self, step, w):
        return self.transform(step).to_world(self.rest(step / self.count) + w)

    def selects(self, collider, w):
        """The nodes nearer to a collider than its deformation radius."""
        radius = collider.sample("deformationRadius", self.frame)
        chosen = np.zeros(w.shape[:-1], dtype=bool)
        for step in range(self.count + 1):
            pose = Pose(collider, self.frame, step / self.count)
            for index, point in self.places(self.world(step, w)):
                if least_gap(pose.kind, pose.lengths, pose.to_frame(point)) >= radius:
                    continue
                gap, _ = gap_and_normal(pose.kind, pose.lengths, pose.to_frame(point))
                chosen[index] |= max(gap, 0.0) < radius
                if gap > 0:
                    self.note(gap - radius)
        return chosen

    @staticmethod
    def places(points):
        for index in np.ndindex(points.shape[:-1]):
            yield index, points[index]

    def touching(self, step, before, after, interior, joined, is_first):
        """The rows of pairs of nodes and colliders that touch now."""
        begin, end = self.poses(step), self.poses(step + 1)
        found = []
        for index in map(tuple, np.argwhere(interior)):
            for k, (one, other) in enumerate(zip(begin, end)):
                if (index, k) in joined:
                    continue
                x0, x1 = one.to_frame(before[index]), other.to_frame(after[index])
                place, t = None, 0.0
                if is_first and one.sticks:
                    gap, n = gap_and_normal(one.kind, one.lengths, x0)
                    self.note(abs(gap) - 1e3 * self.slack)
                    if abs(gap) <= 1e3 * self.slack:
                        place = x0 - gap * n
                if place is None:
                    t = first_contact(one.kind, one.lengths, other.lengths, x0, x1, self.slack, self.note)
                    if t is None:
                        continue
                    place = (1 - t) * x0 + t * x1
                    _, n = gap_and_normal(one.kind, (1 - t) * one.lengths + t * other.lengths, place)
                joined.add((index, k))
                normal = other.rotation @ n
                if isinstance(other.kind, ClosedMesh):
                    # The point of the mesh that is touched carries it.
                    points = points_of((1 - t) * one.lengths + t * other.lengths)
                    touched = other.kind.near(points, place)
                    carried = touched.at(points_of(other.lengths))
                    place = place + carried - touched.at(points)
                    height = n @ carried + other.lengths[4]
                else:
                    height = support(other.kind, other.lengths, n) + other.lengths[4]
                found.append(Row(index, one, normal, height + normal @ other.translate,
                                 other.rotation @ place + other.translate))
        return found

    def meets(self, number, w, end, interior):
        """Whether anything touches in a step that ends there."""
        return bool(self.touching(number, self.world(number, w), self.world(number + 1, end), interior, set(), True))

    def step(self, number, w, free, interior, response, weights, flowing=None):
        """The end of a step that ends in `free` without contact; None: nothing touches.
        `response(node)`: what a force on a node moves, of A. `flowing(end)`: where a step of a plate
        that yields ends without contact, if that flows which flows at `end`."""
        before, after = self.world(number, w), self.world(number + 1, free)
        joined, rows = set(), Rows(self.diagonal, self.diagnostics)
        found = self.touching(number, before, after, interior, joined, True)
        if not found:
            return None
        forces, end = {}, free
        for turn in range(4):
            pressures = {row: max(row.normal @ force, 0.0) for row, force in forces.items()}
            has_friction = any(row.friction > 0 for row in rows.all() + found)
            if turn > 0 and not has_friction:
                break
            while True:
                for row in found:
                    rows.add(row, after[row.index])
                end, free, forces = self.pushed_and_flowed(number, rows.all(), free, response, weights, pressures,
                                                           flowing)
                after = self.world(number + 1, end)
                found = self.touching(number, before, after, interior, joined, False)
                if not found:
                    break
        self.diagnostics.touches += 1
        return end

    def pushed_and_flowed(self, number, rows, free, response, weights, pressures, flowing):
        """The end of a step with these rows, its end without their forces but with all that flows, and the
        forces. What flows answers to a change by at most 1/(1 + H) of it."""
        for _ in range(5000):
            moved, forces = self.pushed(rows, self.world(number + 1, free), response, weights, pressures)
            end = free + self.transform(number + 1).vector_to_object(moved)
            if flowing is None:
                return end, free, forces
            last, free = free, flowing(end)
            if np.abs(free - last).max() <= 1e-13 * np.abs(end).max():
                return end, last, forces
        raise AssertionError("a plastic step with contact does not converge")

    @staticmethod
    def pushed(rows, free, response, weights, pressures):
        """d of (8s) and (8t), in the world, and the forces of the rows."""
        columns = {}
        for row in rows:
            if row.index not in columns:
                columns[row.index] = response(row.index) / weights[row.index]
        inverse = np.array([[columns[one.index][other.index] for one in rows] for other in rows])
        inverse = (inverse + inverse.T) / 2
        normals = np.array([row.normal for row in rows])
        bounds = np.array([row.friction * pressures.get(row, 0.0) for row in rows])
        sticks = np.array([row.sticks for row in rows])
        lacks = np.array([row.lack(free[row.index]) for row in rows])
        if not sticks.any() and not bounds.any():
            factor = np.linalg.cholesky(inverse * (normals @ normals.T))
            right = scipy.linalg.solve_triangular(factor, lacks, lower=True)
            sizes, _ = scipy.optimize.nnls(factor.T, right, maxiter=100 * len(rows))
            forces = sizes[:, None] * normals
        else:
            forces = projected(inverse, normals, lacks, np.array(
                [free[row.index] - row.place for row in rows]), bounds, sticks)
        moved = np.zeros_like(free)
        for force, row in zip(forces, rows):
            moved += columns[row.index][..., None] * force
        return moved, dict(zip(rows, forces))


def projected(inverse, normals, lacks, slips, bounds, sticks):
    """The forces of rows by projected gradients, accelerated and begun anew where they rise."""
    def along(vectors):
        return (vectors * normals).sum(axis=1)

    target = -lacks[:, None] * normals + slips - along(slips)[:, None] * normals

    def project(forces):
        push = along(forces)
        across = forces - push[:, None] * normals
        size = np.linalg.norm(across, axis=1)
        push = np.where(sticks, push, np.maximum(push, 0))
        kept = np.where(sticks | (size <= bounds), 1.0, bounds / np.where(size > 0, size, 1.0))
        return push[:, None] * normals + kept[:, None] * across

    step = 1 / np.linalg.eigvalsh(inverse)[-1]
    forces = np.zeros_like(normals)
    ahead, momentum = forces, 1.0
    for _ in range(200000):
        following = project(ahead - step * (inverse @ ahead + target))
        change = following - forces
        if ((ahead - following) * change).sum() > 0:
            momentum = 1.0
        faster = (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        ahead = following + (momentum - 1) / faster * change
        forces, momentum = following, faster
        if np.abs(change).max() <= 1e-15 * np.abs(forces).max():
            break
    else:
        raise AssertionError("contact does not converge")
    return forces


def with_contact(contact, euler, rigid, interior, weights, is_newmark, plastic=None):
    """Steps that meet colliders. `euler(*state, load, dt)` is one step of backward Euler of w, velocity
    and, if it yields, plastic curvatures, and `rigid(load, dt)` what a load moves from rest where nothing
    is prescribed. `plastic(*state, load, dt)` gives two functions of where a step ends: `flowing` of
    `FrameContact.step`, and the plastic curvatures."""
    def advance(state, load, count, dt):
        responses = {}

        def response(node):
            if node not in responses:
                unit = np.zeros_like(load)
                unit[node] = 1, 0, 0
                responses[node] = rigid(unit, dt)[..., 0]
            return responses[node]

        for number in range(count):
            w = state[0]
            if is_newmark:
                half = euler(*state, load, dt / 2)
                tried = [2 * middle - before for middle, before in zip(half, state)]
                if not contact.meets(number, w, tried[0], interior):
                    state = tried
                    continue
            free = euler(*state, load, dt)
            flowing, flowed = plastic(*state, load, dt) if plastic else (None, None)
            end = contact.step(number, w, free[0], interior, response, weights, flowing)
            if end is None:
                state = free
                continue
            velocity = (end - w) / dt
            velocity[~interior] = 0
            state = [end, velocity] + ([flowed(end)] if plastic else [])
        return state

    return advance
