"""Plates that yield (SPEC 9), slowly: a step is a minimum, found by Newton's method with the whole
sparse tangent of x, y and z together."""

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg


class Plasticity:
    """The curvatures of a `Bending` at its nodes, as rows uu, vv, uv of each node, and how they
    flow."""

    def __init__(self, bending, yield_stress, hardening):
        self.bending = bending
        m, n = bending.shape
        around = [sparse.diags([0.5, 0.5], [0, -1], shape=(k, k - 1)).tolil() for k in (m, n)]
        for mean in around:
            mean[0, 0] = mean[-1, -1] = 1
        mean = sparse.kron(around[0].tocsr(), around[1].tocsr())
        self.rows = [bending.of_u, bending.of_v, (mean @ bending.of_cells).tocsr()]
        self.constants = [bending.slope_u, bending.slope_v, np.zeros_like(bending.slope_u)]
        size = m * n
        uu, vv, uv = (x.ravel() for x in (bending.uu, bending.vv, bending.uv))
        self.form = np.zeros((size, 3, 3))
        self.form[:, 0, 0], self.form[:, 1, 1] = uu, vv
        self.form[:, 0, 1] = self.form[:, 1, 0] = uv
        self.form[:, 2, 2] = bending.tau.ravel()
        self.area = bending.area.ravel()
        self.flows = np.stack([uu > 0, vv > 0, np.ones(size, dtype=bool)], axis=1)
        self.yield_stress = np.broadcast_to(yield_stress, bending.shape).ravel()
        self.hardening = np.broadcast_to(hardening, bending.shape).ravel()

    def curvatures(self, w):
        """Nodes x 3 x (x, y, z)."""
        return np.stack([rows @ w + constant
                         for rows, constant in zip(self.rows, self.constants)], axis=1)

    def stress(self, w, before):
        xi = self.curvatures(w) - (1 + self.hardening)[:, None, None] * before
        xi[~self.flows] = 0
        q = np.sqrt(np.einsum("nak,nab,nbk->n", xi, self.form, xi))
        return xi, q

    def flowed(self, w, before):
        """The plastic curvatures that w makes (return mapping)."""
        xi, q = self.stress(w, before)
        over = q > self.yield_stress
        share = np.zeros_like(q)
        share[over] = (1 - self.yield_stress[over] / q[over]) / (1 + self.hardening[over])
        return before + share[:, None, None] * xi

    def forces(self, plastic):
        moments = self.area[:, None, None] * np.einsum("nab,nbk->nak", self.form, plastic)
        return sum(rows.T @ moments[:, a] for a, rows in enumerate(self.rows))

    def tangent(self, w, before, free):
        """What flows takes from the elastic matrix of (x, y, z) together."""
        xi, q = self.stress(w, before)
        size = len(q)
        over = np.nonzero(q > self.yield_stress)[0]
        blocks = np.zeros((size, 9, 9))
        for n in over:
            share = 1 / (1 + self.hardening[n])
            form = np.kron(np.eye(3), self.form[n])
            x = xi[n].T.ravel()  # by component, then uu, vv, uv
            y = self.yield_stress[n]
            flow = share * ((1 - y / q[n]) * np.eye(9) + y / q[n]**3 * np.outer(x, form @ x))
            keep = np.tile(self.flows[n], 3)
            flow[~keep] = 0
            blocks[n] = self.area[n] * form @ flow
        b = sparse.vstack([rows[:, free] for rows in self.rows]).tocsr()
        order = np.arange(3 * size).reshape(3, size).T.ravel()
        b = b[order]  # node by node
        b = sparse.block_diag([b] * 3).tocsr()
        whole = sparse.lil_matrix((9 * size, 9 * size))
        for n in over:
            places = np.concatenate([k * 3 * size + 3 * n + np.arange(3) for k in range(3)])
            whole[np.ix_(places, places)] = blocks[n]
        return (b.T @ whole.tocsr() @ b).tocsc()


def advance_plastic(bending, plasticity, w, velocity, plastic, load, density, damping, count, dt):
    """`count` backward Euler steps of w and its velocity, M x N x 3, and of the plastic curvatures,
    nodes x 3 x 3."""
    shape = bending.shape
    free = bending.is_free.ravel()
    matrix = bending.matrix()
    rho = (np.broadcast_to(density, shape) * bending.area).ravel()
    eta = (np.broadcast_to(damping, shape) * bending.area).ravel()
    shift = rho / dt**2 + eta / dt
    elastic = (matrix + sparse.diags(shift)).tocsc()
    w, v, plastic = w.reshape(-1, 3).copy(), velocity.reshape(-1, 3).copy(), plastic.copy()
    v[~free] = 0
    known = (bending.area[..., None] * load).reshape(-1, 3) + bending.slope_forces()
    inner = elastic[free][:, free]
    for _ in range(count):
        right = known + shift[:, None] * w + (rho / dt)[:, None] * v
        x = w.copy()
        factor = linalg.splu(inner)

        def rest(x):
            flowed = plasticity.flowed(x, plastic)
            return (right + plasticity.forces(flowed) - elastic @ x)[free]

        x[free] += factor.solve(rest(x))
        size = np.inf
        for _ in range(200):
            left = rest(x)
            change = factor.solve(left)
            last, size = size, np.abs(change).max()
            if not size > 1e-14 * np.abs(x).max() or (size < 1e-11 * np.abs(x).max() and size >= last):
                break
            tangent = (sparse.block_diag([inner] * 3) -
                       plasticity.tangent(x, plastic, free)).tocsc()
            way = np.zeros_like(x)
            way[free] = linalg.splu(tangent).solve(left.T.ravel()).reshape(3, -1).T
            # The energy's slope along the way is monotone.
            part, start = 1.0, float((left * way[free]).sum())
            while part > 1e-6 and float((rest(x + part * way) * way[free]).sum()) < -0.5 * start:
                part /= 2
            x += part * way
        plastic = plasticity.flowed(x, plastic)
        v = np.where(free[:, None], (x - w) / dt, 0)
        w = x
    return w.reshape(*shape, 3), v.reshape(*shape, 3), plastic
