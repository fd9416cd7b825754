"""The plate of even material on boxes and unions of boxes, by the 13-point stencil (SPEC 4).

A sparse matrix is assembled for every solve and factored anew.
"""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from exact_motion import exact_motion


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
    goal = material["goal"] if np.ndim(material["goal"]) < 2 else material["goal"][interior]
    matrix += scipy.sparse.diags(np.broadcast_to(goal, len(number)))
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


def advance_exactly(w, velocity, loads, interior, ends, hu, hv, material, tangents, time):
    """The exact solution in a region of any outline; `loads` and `tangents` are those at both ends
    of the frame."""
    (matrix, first), (_, last) = (union_system(w, load, interior, ends, hu, hv, material, slopes)
                                  for load, slopes in zip(loads, tangents))
    w, velocity, start, speed = w.copy(), np.zeros_like(w), w[interior], velocity[interior]
    w[interior], velocity[interior] = exact_motion(
        matrix, np.ones(len(start)), material, (first, last), start, speed, time)
    return w, velocity


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
    matrix = (operator + (mass + material["goal"]) * scipy.sparse.identity(operator.shape[0])).tocsc()
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
