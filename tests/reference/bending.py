"""A plate on a rectangle from its bending energy, with any edges and uneven material (SPEC 9).

Slow: the energy is written as sums of squares over nodes and cells with sparse matrices, and the
unknowns are solved for by a general factor."""

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg


def second_difference(count, h, first, last, slopes):
    """Rows of the second difference along one line, what the slopes add, and which rows there
    are."""
    matrix = sparse.lil_matrix((count, count))
    constant = np.zeros((count, 3))
    present = np.ones(count, dtype=bool)
    for i in range(1, count - 1):
        matrix[i, i - 1], matrix[i, i], matrix[i, i + 1] = 1, -2, 1
    for end, inside, edge, slope in ((0, 1, first, -slopes[0]),
                                     (count - 1, count - 2, last, slopes[1])):
        if edge == "clamped":
            matrix[end, inside], matrix[end, end] = 2, -2
            constant[end] = 2 * h * slope
        else:
            present[end] = False
    return matrix.tocsr() / h**2, constant / h**2, present


class Bending:
    """The energy of a plate on M x N nodes, numbered i * N + j."""

    def __init__(self, shape, hu, hv, edges, b, c, d, poisson, tangents, goal=0,
                 held=False):
        m, n = shape
        self.shape, self.goal = shape, np.broadcast_to(goal, shape)
        b, c, d = (np.broadcast_to(x, shape).astype(float) for x in (b, c, d))
        along_u, slope_u, has_u = second_difference(
            m, hu, edges[0], edges[1], (tangents["su0"], tangents["su1"]))
        along_v, slope_v, has_v = second_difference(
            n, hv, edges[2], edges[3], (tangents["sv0"], tangents["sv1"]))
        self.of_u = sparse.kron(along_u, sparse.identity(n)).tocsr()
        self.of_v = sparse.kron(sparse.identity(m), along_v).tocsr()
        self.slope_u = np.repeat(slope_u[:, None, :], n, axis=1).reshape(-1, 3)
        self.slope_v = np.repeat(slope_v[None, :, :], m, axis=0).reshape(-1, 3)
        steps = [sparse.diags([-1, 1], [0, 1], shape=(k - 1, k)) for k in shape]
        self.of_cells = sparse.kron(steps[0], steps[1]).tocsr() / (hu * hv)

        self.area = np.ones(shape)
        self.area[[0, -1], :] *= 0.5
        self.area[:, [0, -1]] *= 0.5
        gamma = poisson * np.sqrt(b * d)
        tau = c - 2 * gamma
        u, v = np.meshgrid(has_u, has_v, indexing="ij")
        left = 1 - poisson**2
        self.uu = np.where(u, np.where(v, b, left * b), 0)
        self.vv = np.where(v, np.where(u, d, left * d), 0)
        self.uv = np.where(u & v, gamma, 0)
        self.tau = tau
        self.cells = (tau[:-1, :-1] + tau[1:, :-1] + tau[:-1, 1:] + tau[1:, 1:]) / 4

        self.is_free = np.ones(shape, dtype=bool)
        for edge, line in zip(edges, (np.s_[0, :], np.s_[-1, :], np.s_[:, 0], np.s_[:, -1])):
            if edge != "free":
                self.is_free[line] = False
        self.is_free &= ~np.broadcast_to(held, shape)

    def weighted(self, modulus):
        return sparse.diags((self.area * modulus).ravel())

    def matrix(self):
        uu, vv, uv = (self.weighted(x) for x in (self.uu, self.vv, self.uv))
        twist = sparse.diags(self.cells.ravel())
        return (self.of_u.T @ uu @ self.of_u + self.of_v.T @ vv @ self.of_v +
                self.of_u.T @ uv @ self.of_v + self.of_v.T @ uv @ self.of_u +
                self.of_cells.T @ twist @ self.of_cells + self.weighted(self.goal)).tocsc()

    def slope_forces(self):
        """Minus the gradient that the tangents make."""
        uu, vv, uv = (self.weighted(x) for x in (self.uu, self.vv, self.uv))
        return -(self.of_u.T @ (uu @ self.slope_u + uv @ self.slope_v) +
                 self.of_v.T @ (uv @ self.slope_u + vv @ self.slope_v))


def advance_bending(bending, w, velocity, load, density, damping, count, dt):
    """Backward Euler steps of w and its velocity, both M x N x 3; density and damping may differ
    from node to node."""
    shape = bending.shape
    density = np.broadcast_to(density, shape) * bending.area
    damping = np.broadcast_to(damping, shape) * bending.area
    free = bending.is_free.ravel()
    matrix = bending.matrix()
    rho, eta = density.ravel()[free], damping.ravel()[free]
    w = w.reshape(-1, 3).copy()
    v = velocity.reshape(-1, 3).copy()
    v[~free] = 0
    known = (bending.area[..., None] * load).reshape(-1, 3) + bending.slope_forces()
    known = known[free] - matrix[free][:, ~free] @ w[~free]
    shift = rho / dt**2 + eta / dt
    factor = linalg.splu((matrix[free][:, free] + sparse.diags(shift)).tocsc())
    for _ in range(count):
        following = factor.solve(known + shift[:, None] * w[free] + (rho / dt)[:, None] * v[free])
        v[free] = (following - w[free]) / dt
        w[free] = following
    return w.reshape(*shape, 3), v.reshape(*shape, 3)
