"""The reference engine: SPEC 2-7, evaluated literally and slowly.

Nothing is shared with the library under test; a sparse matrix is assembled from the 13-point
stencil for every solve and factored anew.
"""

import itertools
import math
from fractions import Fraction

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from bending import Bending, advance_bending
from curves import Curve
from exact_motion import exact_motion
from maps import check_material

# u0, u1, v0, v1.
EDGE_LINES = np.s_[0, :], np.s_[-1, :], np.s_[:, 0], np.s_[:, -1]

# The 13-point stencil (SPEC 4), as {(di, dj): weight} of each of the three derivatives.
FOURTH = {-2: 1, -1: -4, 0: 6, 1: -4, 2: 1}
SECOND = {-1: 1, 0: -2, 1: 1}


def stencil(hu, hv, b, c, d):
    """Weights of b w_uuuu + c w_uuvv + d w_vvvv at a node (SPEC 2 and 4)."""
    weights = {}
    for offset, weight in FOURTH.items():
        weights[offset, 0] = weights.get((offset, 0), 0.0) + b * weight / hu**4
        weights[0, offset] = weights.get((0, offset), 0.0) + d * weight / hv**4
    for di, weight_u in SECOND.items():
        for dj, weight_v in SECOND.items():
            mixed = c * weight_u * weight_v / (hu**2 * hv**2)
            weights[di, dj] = weights.get((di, dj), 0.0) + mixed
    return weights


def apply_operator(w, hu, hv, b, c, d, tangents):
    """L w at the interior nodes of `w` (M x N x 3), ghost nodes included (SPEC 4)."""
    m, n = w.shape[:2]
    extended = np.full((m + 2, n + 2, 3), np.nan)
    extended[1:-1, 1:-1] = w
    extended[0, 1:-1] = w[1] - 2 * hu * tangents["su0"]
    extended[-1, 1:-1] = w[m - 2] + 2 * hu * tangents["su1"]
    extended[1:-1, 0] = w[:, 1] - 2 * hv * tangents["sv0"]
    extended[1:-1, -1] = w[:, n - 2] + 2 * hv * tangents["sv1"]
    result = np.zeros((m - 2, n - 2, 3))
    for (di, dj), weight in stencil(hu, hv, b, c, d).items():
        result += weight * extended[2 + di:m + di, 2 + dj:n + dj]
    return result


def assemble(m, n, hu, hv, b, c, d):
    """The matrix of L on the interior nodes, row (i-1)*(n-2) + (j-1), ghosts eliminated (SPEC 4).

    The contribution of rim values and tangents is the operator applied to a field with a zero
    interior.
    """
    i, j = np.meshgrid(np.arange(1, m - 1), np.arange(1, n - 1), indexing="ij")
    rows, columns, values = [], [], []
    for (di, dj), weight in stencil(hu, hv, b, c, d).items():
        # A ghost is its mirror node plus a known tangent term.
        near_i, near_j = np.abs(i + di), np.abs(j + dj)
        near_i = np.where(near_i > m - 1, 2 * (m - 1) - near_i, near_i)
        near_j = np.where(near_j > n - 1, 2 * (n - 1) - near_j, near_j)
        is_unknown = (0 < near_i) & (near_i < m - 1) & (0 < near_j) & (near_j < n - 1)
        rows.append(((i - 1) * (n - 2) + j - 1)[is_unknown])
        columns.append(((near_i - 1) * (n - 2) + near_j - 1)[is_unknown])
        values.append(np.full(int(is_unknown.sum()), weight))
    size = (m - 2) * (n - 2)
    triplets = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return scipy.sparse.csc_matrix(triplets, shape=(size, size))


# Regions (SPEC 5, "combine")


def do_meet(a, b):
    """Whether two boxes share a node."""
    return max(a[0], b[0]) <= min(a[1], b[1]) and max(a[2], b[2]) <= min(a[3], b[3])


def common_box(boxes):
    i0, i1, j0, j1 = zip(*boxes)
    return min(i0), max(i1), min(j0), max(j1)


def islands_of(boxes):
    """Boxes that meet become their common box, until none do."""
    boxes = sorted(set(boxes))
    for box in boxes:
        meeting = [other for other in boxes if do_meet(box, other)]
        if len(meeting) > 1:
            return islands_of([b for b in boxes if b not in meeting] + [common_box(meeting)])
    return boxes


def combined(boxes, how):
    """The regions: each a list of the boxes whose cells it is made of."""
    if not boxes:
        return []
    if how == "box":
        return [[common_box(boxes)]]
    if how == "islands":
        return [[box] for box in islands_of(boxes)]
    with_cells = [box for box in boxes if box[1] > box[0] and box[3] > box[2]]
    return [with_cells] if with_cells else []


def interior_of(region, shape):
    """Nodes all of whose four cells are inside, on the whole grid."""
    cells = np.zeros((shape[0] + 1, shape[1] + 1), dtype=bool)  # cell k ends at node k
    for i0, i1, j0, j1 in region:
        cells[i0 + 1:i1 + 1, j0 + 1:j1 + 1] = True
    return cells[:-1, :-1] & cells[1:, :-1] & cells[:-1, 1:] & cells[1:, 1:]


def union_operator(interior, hu, hv, material):
    """The matrix of L on the interior nodes of a region of any outline, and for each of them what
    it leaves out: (row, name of the tangent and its end, weight times length), (row, node, weight).

    A neighbour two away across a rim node is the node itself, plus a tangent where that rim node
    is at one of the ends of the whole region.
    """
    number = {tuple(node): k for k, node in enumerate(np.argwhere(interior))}
    matrix = scipy.sparse.lil_matrix((len(number), len(number)))
    ghosts, rim = [], []
    edges = {(-1, 0): ("su0", 0, -2 * hu), (1, 0): ("su1", 1, 2 * hu),
             (0, -1): ("sv0", 2, -2 * hv), (0, 1): ("sv1", 3, 2 * hv)}
    weights = stencil(hu, hv, material["b"], material["c"], material["d"])
    for (i, j), row in number.items():
        for (di, dj), weight in weights.items():
            node = i + di, j + dj
            step = di // 2, dj // 2
            if max(abs(di), abs(dj)) == 2 and (i + step[0], j + step[1]) not in number:
                node = i, j
                name, end, length = edges[step]
                ghosts.append((row, name, end, i + di // 2 if di else j + dj // 2,
                               weight * length))
            if node in number:
                matrix[row, number[node]] += weight
            else:
                rim.append((row, node, weight))
    return matrix.tocsc(), ghosts, rim


def union_system(w, load, interior, ends, hu, hv, material, tangents):
    """L and the force of a region of any outline; the arrays are those of the whole grid, and (i0,
    i1, j0, j1) are the ends of the whole region."""
    matrix, ghosts, rim = union_operator(interior, hu, hv, material)
    known = np.zeros((matrix.shape[0], 3))
    for row, name, end, place, weight in ghosts:
        if place == ends[end]:
            known[row] += weight * tangents[name]
    for row, node, weight in rim:
        known[row] += weight * w[node]
    return matrix, load[interior] - known


def advance_union(w, velocity, load, interior, ends, hu, hv, material, tangents, count, dt):
    """`advance` for a region of any outline."""
    density, damping = (np.broadcast_to(material[name], interior.shape)[interior][:, None]
                        for name in ("density", "damping"))
    mass = density / dt**2 + damping / dt
    matrix, force = union_system(w, load, interior, ends, hu, hv, material, tangents)
    matrix = (matrix + scipy.sparse.diags(mass[:, 0])).tocsc()
    factor = scipy.sparse.linalg.splu(matrix)
    unknown, speed = w[interior], velocity[interior]
    for _ in range(count):
        right = force + mass * unknown + density / dt * speed
        solution = factor.solve(right)
        solution += factor.solve(right - matrix @ solution)
        speed = (solution - unknown) / dt
        unknown = solution
    w, velocity = w.copy(), np.zeros_like(w)
    w[interior], velocity[interior] = unknown, speed
    return w, velocity


def smallest_eigenvalue(matrix, masses):
    """Of K w = lambda M w, rigid motions left out; 0 if there are no others."""
    root = np.sqrt(masses)
    values = np.linalg.eigvalsh(matrix / np.outer(root, root))
    values = values[values > 1e-11 * values[-1]]
    return float(values[0]) if len(values) else 0.0


def damping_of(ratio, density, eigenvalue):
    """eta = 2 zeta omega rho (SPEC 9)."""
    return 2 * ratio * math.sqrt(eigenvalue * density)


def find_cycle(run, frames):
    """The states of a run at these frames, which lead back to the first one: going round from rest.
    `run.parts` names what a state is made of."""
    def state():
        return [getattr(run, part).copy() for part in run.parts]

    run.reset()
    for _ in range(5000):
        states = []
        for frame in frames:
            states.append(state())
            if run.surface.is_solved_at(frame):
                run.solve(frame)
        peak = max(run.displacement(parts[0]) for parts in states)
        now = state()
        gap = max(np.abs(now[0] - states[0][0]).max(),
                  np.abs(now[1] - states[0][1]).max() / float(run.scene.fps))
        if gap <= (1e-12 if run.noise is None else 1e-10) * peak:
            return states
    raise AssertionError("the motion does not close to a cycle")


def advance_exactly(w, velocity, loads, interior, ends, hu, hv, material, tangents, time):
    """The exact solution in a region of any outline; `loads` and `tangents` are those at both ends
    of the frame."""
    (matrix, first), (_, last) = (union_system(w, load, interior, ends, hu, hv, material, slopes)
                                  for load, slopes in zip(loads, tangents))
    w, velocity, start, speed = w.copy(), np.zeros_like(w), w[interior], velocity[interior]
    w[interior], velocity[interior] = exact_motion(
        matrix, np.ones(len(start)), material, (first, last), start, speed, time)
    return w, velocity


def check_coefficients(density, damping, b, c, d, dt):
    """Well-posedness (SPEC 2)."""
    assert b > 0 and d > 0 and c > -2 * math.sqrt(b * d), f"b={b} c={c} d={d}"
    assert density >= 0 and damping >= 0, f"density={density} damping={damping}"
    assert dt > 0, f"dt={dt}"


def steps_of_frame(frame_length, dt, stepping):
    """Number and length of the steps in a frame (SPEC 4, "Steps per frame")."""
    if stepping == "exact":
        count = max(1, math.ceil(frame_length / dt - 1e-9))
        return count, frame_length / count
    count, time = 0, 0.0
    while True:
        time += dt
        count += 1
        if time >= frame_length:
            return count, dt


def with_integrator(integrator, density, advance):
    """`advance`, which ends in (count, dt) and makes backward Euler steps, for an integrator: a
    step of Newmark's is one of half its length, reflected."""
    def reflected(w, velocity, *rest):
        *rest, count, dt = rest
        for _ in range(count):
            half_w, half_velocity = advance(w, velocity, *rest, 1, dt / 2)
            w, velocity = 2 * half_w - w, 2 * half_velocity - velocity
        return w, velocity

    return reflected if integrator == "newmark" and np.any(density > 0) else advance


def advance(w, velocity, load, hu, hv, material, tangents, count, dt):
    """`count` backward Euler steps of the region `w` (M x N x 3); returns w and velocity.

    SPEC 3: the rim is fixed; SPEC 4: everything except w and its velocity is constant over the
    steps.
    """
    m, n = w.shape[:2]
    density, damping = material["density"], material["damping"]
    coefficients = material["b"], material["c"], material["d"]
    operator = assemble(m, n, hu, hv, *coefficients)
    rim_only = w.copy()
    rim_only[1:-1, 1:-1] = 0.0
    known = apply_operator(rim_only, hu, hv, *coefficients, tangents).reshape(-1, 3)
    mass = density / dt**2 + damping / dt
    matrix = (operator + mass * scipy.sparse.identity(operator.shape[0])).tocsc()
    factor = scipy.sparse.linalg.splu(matrix)
    unknown = w[1:-1, 1:-1].reshape(-1, 3)
    speed = velocity[1:-1, 1:-1].reshape(-1, 3)
    force = load[1:-1, 1:-1].reshape(-1, 3)
    for _ in range(count):
        right = force - known + mass * unknown + density / dt * speed
        solution = factor.solve(right)
        solution += factor.solve(right - matrix @ solution)  # iterative refinement
        speed = (solution - unknown) / dt
        unknown = solution
    w, velocity = w.copy(), np.zeros_like(w)
    w[1:-1, 1:-1] = unknown.reshape(m - 2, n - 2, 3)
    velocity[1:-1, 1:-1] = speed.reshape(m - 2, n - 2, 3)
    return w, velocity


# Transforms (SPEC 7, "Transforms")


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


# Forces (SPEC 7)


def closest_point(force, frame, points):
    """The point of the force's centre or segment that is closest to each of `points`."""
    if force.kind in ("point", "radial", "noise"):
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
    return (force.kind in ("point", "uniform", "noise", "inertia") or
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
        place = force.sample("frequency", frame) * (points - force.sample("center", frame))
        # Each frame since the start at its own rate.
        start = run.scene.start
        rates = [force.sample("rate", before) for before in range(start, frame)]
        rates += [-force.sample("rate", before) for before in range(frame, start)]  # in a preroll
        time = (force.sample("rate", start) * start + sum(rates)) / float(run.scene.fps)
        time = np.broadcast_to(time, points.shape[:-1] + (1,))
        return noise(force.seed, np.concatenate([place, time], axis=-1))
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


def bounding_box(selected):
    """(i0, i1, j0, j1), ends included, of the selected nodes; None when there are none (SPEC 5)."""
    if not selected.any():
        return None
    i, j = np.nonzero(selected)
    return i.min(), i.max(), j.min(), j.max()


# Diagnostics: whether another implementation may be expected to agree


def is_exact_distance(force, frame, point, radius):
    """Whether delta - radius is decided in exact arithmetic: every intermediate is a double."""
    def is_double(value):
        return Fraction(float(value)) == value

    def exact(vector):
        return [Fraction(float(x)) for x in vector]

    if force.kind in ("uniform", "inertia"):
        return True  # the distance is 0
    if force.kind == "vortex":
        return False
    p, used = exact(point), []
    if force.kind in ("point", "radial", "noise"):
        nearest = exact(force.sample("center", frame))
    else:
        start, end = exact(force.sample("from", frame)), exact(force.sample("to", frame))
        along = [q - r for q, r in zip(end, start)]
        to_point = [q - r for q, r in zip(p, start)]
        products = [q * r for q, r in zip(to_point, along)] + [q * q for q in along]
        numerator, squared_length = sum(products[:3]), sum(products[3:])
        used += along + to_point + products + [numerator, squared_length]
        t = min(Fraction(1), max(Fraction(0), numerator / squared_length)) if squared_length else 0
        moved = [t * q for q in along]
        nearest = [q + r for q, r in zip(start, moved)]
        used += [t] + moved + nearest
    offset = [q - r for q, r in zip(p, nearest)]
    squares = [q * q for q in offset]
    used += offset + squares + [sum(squares[:2]), sum(squares[1:]), squares[0] + squares[2],
                                sum(squares)]
    root = Fraction(math.sqrt(float(sum(squares))))
    return all(is_double(x) for x in used) and (root * root == sum(squares) or root != radius)


class Diagnostics:
    """The features that a scene used, and how near it came to decisions that rounding could
    change."""

    def __init__(self):
        self.solves = []  # (frame, surface, (i0, i1, j0, j1))
        self.skips = []  # (frame, surface, reason)
        self.exact_ties = 0
        self.tie_margin = math.inf  # smallest |delta - radius| / radius that is not an exact tie
        self.direction_margin = math.inf  # smallest non-exact delta where delta gives a direction
        self.time_margin = math.inf  # smallest |t - T| / T of an overshoot step
        self.settle_margin = math.inf  # smallest |motion - 1e-6 D| / (1e-6 D) of `recover`
        self.cut_margin = math.inf  # smallest distance of a cut of triangles from where it snaps
        self.recovering = 0  # nodes counted as selected, over all frames
        self.unions = 0  # solves of regions that are not a box

    def note_distances(self, force, frame, points, is_untouched, radii):
        """`is_untouched`: nodes at their rest position under an identity transform."""
        delta = distances(force, frame, points)
        for radius in radii:
            close = np.abs(delta - radius) <= 1e-7 * max(radius, 1e-12)
            for i, j in zip(*np.nonzero(close)):
                if is_untouched[i, j] and is_exact_distance(force, frame, points[i, j], radius):
                    self.exact_ties += delta[i, j] == radius
                    close[i, j] = False
                    delta[i, j] = math.nan
            margin = np.abs(delta - radius) / max(radius, 1e-12)
            if not np.isnan(margin).all():
                self.tie_margin = min(self.tie_margin, np.nanmin(margin))
            delta = distances(force, frame, points)
        if not has_direction(force):
            near = delta < 1e-3
            for i, j in zip(*np.nonzero(near)):
                is_exact = is_untouched[i, j] and is_exact_distance(force, frame, points[i, j], 0.0)
                if not (is_exact and delta[i, j] == 0):
                    self.direction_margin = min(self.direction_margin, delta[i, j])

    def note_steps(self, frame_length, dt):
        ratio = frame_length / dt
        self.time_margin = min(self.time_margin, abs(ratio - round(ratio)) / ratio)


# The run (SPEC 5 and 6)


class SurfaceRun:
    """The state of one surface: the mesh, and the velocities of the last solve."""

    def __init__(self, scene, surface, diagnostics, noise=None):
        self.scene, self.surface, self.noise = scene, surface, noise
        self.diagnostics = diagnostics
        self.show(scene.start)
        self.reset()

    def show(self, frame):
        """Takes the shape at rest of a frame."""
        self.vertices = self.surface.shape.at(frame)
        self.rest = self.surface.grid.of_nodes(self.vertices)

    def ride(self, frame):
        """Goes on to the shape at rest of the next frame, on which everything rides."""
        before = self.rest
        self.show(frame + 1)
        is_moved = (self.rest != before).any(axis=-1)
        at_rest = (self.position == before).all(axis=-1)
        self.position[is_moved] += (self.rest - before)[is_moved]
        self.position[at_rest] = self.rest[at_rest]

    def reset(self):
        self.position = self.rest.copy()
        # Zero where the last solve did not reach: such nodes start from velocity 0 (SPEC 6).
        self.velocity = np.zeros_like(self.rest)
        self.unsettled = np.zeros(self.rest.shape[:2], dtype=bool)
        self.forget_push()

    def forget_push(self):
        """What `exact` starts from: loads, unknowns and tangents of the last solve."""
        self.last_load = np.zeros_like(self.rest)
        self.was_unknown = np.zeros(self.rest.shape[:2], dtype=bool)
        self.last_tangents = {}

    def enabled_forces(self, frame):
        """Lists of the forces and groups that act on this surface: (force, selects a region) and
        (group)."""
        def acts(item):
            is_target = item.targets is None or self.surface.name in item.targets
            return is_target and item.enabled(frame)[0] != 0

        groups = [group for group in self.scene.groups if acts(group)]
        forces = [force for force in self.scene.forces if acts(force)]
        forces += [force for group in groups for force in group.forces if acts(force)]
        return forces, groups

    def measured_points(self, transform):
        """World positions where distances are measured (SPEC 5, `measure`)."""
        is_rest = self.surface.choices["measure"] == "rest"
        return transform.to_world(self.rest if is_rest else self.position)

    def select(self, frame, points, forces, groups):
        """The deformation box of each force, None for none; of a group's forces, the group's."""
        own = {}
        if self.surface.is_whole:
            return own
        for force in forces:
            if not force.is_in_group:
                delta = distances(force, frame, points)
                own[force] = bounding_box(delta < force.sample("deformationRadius", frame))
        for group in groups:
            offset = points - group.center(frame)
            delta = np.sqrt((offset**2).sum(axis=-1))
            box = bounding_box(delta < float(group.deformation_radius(frame)[0]))
            own[group] = box
            own.update((force, box) for force in group.forces)
        return own

    def regions(self, own):
        """The regions that are solved, including nodes not yet back at rest (SPEC 5, 6)."""
        how = self.surface.choices["combine"]
        if self.surface.is_whole:
            columns, rows = self.rest.shape[:2]
            return [[(0, columns - 1, 0, rows - 1)]]
        boxes = [box for box in own.values() if box is not None]
        regions = combined(boxes, how)
        if self.surface.choices["release"] == "recover":
            held = np.zeros(self.rest.shape[:2], dtype=bool)
            for region in regions:
                held |= interior_of(region, held.shape)
            columns, rows = held.shape
            around = [(max(i - 1, 0), min(i + 1, columns - 1), max(j - 1, 0), min(j + 1, rows - 1))
                      for i, j in np.argwhere(self.unsettled & ~held)]
            self.diagnostics.recovering += len(around)
            if around:
                regions = combined(boxes + islands_of(around), how)
        return regions

    def interior(self, region):
        """The nodes that move."""
        interior = interior_of(region, self.rest.shape[:2])
        if set(self.surface.edges) != {"clamped"}:
            edges = self.surface.edges
            interior[:] = True
            for edge, line in zip(edges, EDGE_LINES):
                if edge != "free":
                    interior[line] = False
        return interior

    def advance_energy(self, frame):
        """`advance` with the surface's edges."""
        def advance_edges(w, velocity, load, hu, hv, material, tangents, count, dt):
            bending = Bending(w.shape[:2], hu, hv, self.surface.edges, material["b"],
                              material["c"], material["d"], self.surface.sample("poisson", frame),
                              tangents)
            return advance_bending(bending, w, velocity, load, material["density"],
                                   material["damping"], count, dt)

        return advance_edges

    def advance_edges_exactly(self, frame, w, velocity, loads, material, tangents, time):
        """The exact solution of the whole surface with its edges."""
        forces = []
        for load, slopes in zip(loads, tangents):
            bending = Bending(w.shape[:2], self.surface.grid.hu, self.surface.grid.hv,
                              self.surface.edges, material["b"], material["c"], material["d"],
                              self.surface.sample("poisson", frame), slopes)
            free, matrix = bending.is_free.ravel(), bending.matrix()
            known = (bending.area[..., None] * load).reshape(-1, 3) + bending.slope_forces()
            forces.append(known[free] - matrix[free][:, ~free] @ w.reshape(-1, 3)[~free])
        w, velocity, start, speed = (w.copy(), np.zeros_like(w), w.reshape(-1, 3)[free],
                                     velocity.reshape(-1, 3)[free])
        end, end_speed = exact_motion(matrix[free][:, free].tocsc(), bending.area.ravel()[free],
                                      material, forces, start, speed, time)
        w.reshape(-1, 3)[free], velocity.reshape(-1, 3)[free] = end, end_speed
        return w, velocity

    def settle(self, regions):
        """Sets all nodes that are not interior to a region to rest."""
        moving = np.zeros(self.rest.shape[:2], dtype=bool)
        for region in regions:
            moving |= interior_of(region, moving.shape)
        self.position[~moving] = self.rest[~moving]
        self.velocity[~moving] = 0
        self.was_unknown[~moving] = False

    def note_settling(self, before, interior, region):
        """The solved nodes that are not yet at rest."""
        rest = np.concatenate([self.rest[i0:i1 + 1, j0:j1 + 1].reshape(-1, 3)
                               for i0, i1, j0, j1 in region])
        length = 1e-6 * float(np.linalg.norm(rest.ptp(axis=0)))
        moved = np.maximum(np.linalg.norm(self.position - self.rest, axis=-1),
                           np.linalg.norm(self.position - before, axis=-1))[interior]
        self.unsettled[interior] = moved >= length
        if moved.size:
            margin = float(np.abs(moved / length - 1).min())
            self.diagnostics.settle_margin = min(self.diagnostics.settle_margin, margin)

    def load(self, frame, points, forces, transform):
        """The load at every node of the surface, in object space (SPEC 5, step 3; SPEC 7)."""
        total = np.zeros_like(points)
        for force in forces:
            delta = distances(force, frame, points)
            radius = force.sample("forceRadius", frame)
            box = bounding_box(delta < radius)
            if box is None:
                continue
            i0, i1, j0, j1 = box
            inside = np.s_[i0:i1 + 1, j0:j1 + 1]
            strength = force.sample("magnitude", frame) * falloff(force, delta[inside] / radius)
            push = unit_forces(force, frame, points[inside], self, inside)
            if force.kind == "inertia" and "density" in self.surface.maps:
                push = push * self.surface.maps["density"][inside][..., None]
            total[inside] += strength[..., None] * push
        return transform.vector_to_object(total)

    def smallest_eigenvalue(self, region, interior, material, frame):
        """Of the whole region."""
        hu, hv = self.surface.grid.hu, self.surface.grid.hv
        if self.surface.has_energy:
            tangents = {name: np.zeros(3) for name in ("su0", "su1", "sv0", "sv1")}
            bending = Bending(interior.shape, hu, hv, self.surface.edges, material["b"],
                              material["c"], material["d"], self.surface.sample("poisson", frame),
                              tangents)
            free = bending.is_free.ravel()
            return smallest_eigenvalue(bending.matrix()[free][:, free].toarray(),
                                       bending.area.ravel()[free])
        matrix, _, _ = union_operator(interior, hu, hv, material)
        return smallest_eigenvalue(matrix.toarray(), np.ones(matrix.shape[0]))

    parts = ("position", "velocity", "unsettled", "last_load", "was_unknown", "last_tangents")

    def displacement(self, position):
        return float(np.linalg.norm(position - self.rest, axis=-1).max())

    def solve(self, frame):
        """The solve at `frame`, which computes the mesh of frame + 1."""
        surface = self.surface
        forces, groups = self.enabled_forces(frame)
        transform = Transform(surface, frame)
        points = self.measured_points(transform)
        self.diagnose(frame, points, forces, groups, transform)
        own = self.select(frame, points, forces, groups)
        regions = self.regions(own)
        recovers = surface.choices["release"] == "recover"
        if recovers:
            self.settle(regions)
        interiors = [self.interior(region) for region in regions]
        if not any(interior.any() for interior in interiors):
            self.diagnostics.skips.append((frame, surface.name, "below 3x3" if regions or any(
                own.values()) else "no node"))
            return
        is_displacement = surface.choices["reference"] == "rest"
        origin = self.rest if is_displacement else np.zeros_like(self.rest)
        material = surface.material(frame)
        if surface.channels["dampingRatio"]:
            material["damping"] = 0.0
        tangents = {name: surface.channels[name](frame) for name in ("su0", "su1", "sv0", "sv1")}
        length = surface.frame_length(frame, self.scene.fps)
        count, dt = steps_of_frame(length, surface.sample("dt", frame), surface.choices["stepping"])
        integrator, density = surface.choices["integrator"], material["density"]
        before, velocities = self.position.copy(), np.zeros_like(self.rest)
        next_load, is_unknown = np.zeros_like(self.rest), np.zeros_like(self.was_unknown)
        first_tangents = self.last_tangents if self.was_unknown.any() else tangents
        self.unsettled[:] = False
        for region, interior in zip(regions, interiors):
            if not interior.any():
                self.diagnostics.skips.append((frame, surface.name, "below 3x3"))
                continue
            ends = common_box(region)
            self.diagnostics.solves.append((frame, surface.name, ends))
            acting = forces if surface.choices["combine"] != "islands" else [
                force for force in forces if own[force] is not None and do_meet(own[force], ends)]
            load = self.load(frame, points, acting, transform)
            start, speed = before - origin, self.velocity
            if surface.channels["dampingRatio"] and density > 0:
                material["damping"] = damping_of(
                    surface.sample("dampingRatio", frame), density,
                    self.smallest_eigenvalue(region, interior, material, frame))
            next_load[interior] = load[interior]
            is_unknown |= interior
            if integrator == "exact":
                first = np.where(self.was_unknown[..., None], self.last_load, load)
                self.diagnostics.unions += len(region) > 1
                both = (first, load), (first_tangents, tangents)
                if surface.has_energy:
                    w, velocity = self.advance_edges_exactly(frame, start, speed, both[0],
                                                             material, both[1], length)
                else:
                    w, velocity = advance_exactly(
                        start, speed, both[0], interior, ends, surface.grid.hu, surface.grid.hv,
                        material, both[1], length)
            elif len(region) == 1:
                box = np.s_[ends[0]:ends[1] + 1, ends[2]:ends[3] + 1]
                w, velocity = np.zeros_like(start), np.zeros_like(start)
                has_energy = surface.has_energy
                steps = self.advance_energy(frame) if has_energy else advance
                in_box = {name: value[box] if name in surface.maps else value
                          for name, value in material.items()}
                w[box], velocity[box] = with_integrator(integrator, density, steps)(
                    start[box], speed[box], load[box], surface.grid.hu, surface.grid.hv, in_box,
                    tangents, count, dt)
            else:
                self.diagnostics.unions += 1
                w, velocity = with_integrator(integrator, density, advance_union)(
                    start, speed, load, interior, ends, surface.grid.hu, surface.grid.hv, material,
                    tangents, count, dt)
            self.position[interior] = (origin + w)[interior]
            velocities[interior] = velocity[interior]
            if self.noise is not None:  # simulates another implementation's rounding
                shift = (self.position - self.rest)[interior]
                shift *= 1 + 1e-12 * self.noise.standard_normal(shift.shape)
                self.position[interior] = self.rest[interior] + shift
            if recovers:
                self.note_settling(before, interior, region)
        self.velocity = velocities
        self.last_load, self.was_unknown, self.last_tangents = next_load, is_unknown, tangents
        assert np.isfinite(self.position).all(), f"not finite after frame {frame}"

    def diagnose(self, frame, points, forces, groups, transform):
        is_rest = self.surface.choices["measure"] == "rest"
        at_rest = (self.position == self.rest).all(axis=-1) | is_rest
        is_untouched = at_rest & transform.is_identity
        for force in forces:
            radii = [force.sample("forceRadius", frame)]
            if not force.is_in_group and not self.surface.is_whole:
                radii.append(force.sample("deformationRadius", frame))
            self.diagnostics.note_distances(force, frame, points, is_untouched, radii)
        for group in [] if self.surface.is_whole else groups:
            sphere = GroupSphere(group)
            radius = float(group.deformation_radius(frame)[0])
            self.diagnostics.note_distances(sphere, frame, points, is_untouched, [radius])
        is_scaled = self.surface.sample("timeScale", frame) != 1
        if self.surface.choices["stepping"] == "overshoot" and (
                self.scene.fps.denominator != 1 or is_scaled):
            length = self.surface.frame_length(frame, self.scene.fps)
            self.diagnostics.note_steps(length, self.surface.sample("dt", frame))

    def check_channels(self, frames):
        """SPEC 2: channels are checked at every integer frame before the first solve."""
        for frame in frames:
            check_coefficients(*(self.surface.sample(name, frame)
                                 for name in ("density", "damping", "b", "c", "d", "dt")))
            if self.surface.channels["dampingRatio"]:
                assert self.surface.sample("dampingRatio", frame) >= 0
            if self.surface.has_stiffness_map:
                material = self.surface.material(frame)
                check_material(material["b"], material["c"], material["d"],
                               self.surface.sample("poisson", frame))
            length = self.surface.frame_length(frame, self.scene.fps)
            assert length / self.surface.sample("dt", frame) <= 1e5
        for force in self.scene.forces + [f for g in self.scene.groups for f in g.forces]:
            for name in ("deformationRadius", "forceRadius"):
                assert all(force.sample(name, frame) >= 0 for frame in frames), name
        for group in self.scene.groups:
            assert all(group.deformation_radius(frame)[0] >= 0 for frame in frames)

    def run(self):
        """Yields (object positions of the vertices, transform) of each frame."""
        first, loop = self.surface.start_frame, self.surface.loop
        frames = range(min(self.scene.start, first), self.scene.end + 1)
        self.check_channels(frames)
        if loop:
            self.check_channels(range(first, first + loop))
            states = find_cycle(self, range(first, first + loop))
            for frame in frames:
                position = self.rest if frame < first else states[(frame - first) % loop][0]
                yield self.surface.grid.to_vertices(position), Transform(self.surface, frame)
            return
        for frame in frames:
            if frame <= self.surface.start_frame:
                self.reset()
            if frame >= self.scene.start:
                yield self.surface.grid.to_vertices(self.position), Transform(self.surface, frame)
            if self.surface.is_solved_at(frame):
                self.solve(frame)
            self.ride(frame)


class GroupSphere:
    """A group's region, as a point force for the diagnostics."""

    kind = "point"

    def __init__(self, group):
        self.channels = {"direction": True}
        self.center = group.center

    def sample(self, name, frame):
        assert name == "center"
        return self.center(frame)
