"""Plates that yield (SPEC 9), slowly: a step is a minimum, found by Newton's method with the whole
sparse tangent of x, y and z together."""

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg


class Flow:
    """How the curvatures uu, vv, uv flow at some points, such as nodes or triangles.

    They are `rows[a] @ w + constants[:, a]` of the unknowns w (#unknowns x 3); `form` (#points x 3 x
    3) is their quadratic form at each point, `area` its weight, `flows` (#points x 3) which of them
    are there at all. Plastic curvatures are #points x 3 x (x, y, z).
    """

    def __init__(self, rows, constants, form, area, flows, yield_stress, hardening):
        self.rows, self.constants, self.form, self.area, self.flows = (
            rows, constants, form, area, flows)
        self.yield_stress, self.hardening = (
            np.broadcast_to(x, area.shape) for x in (yield_stress, hardening))
        assert (self.yield_stress > 0).all() and (self.hardening >= 0).all()
        self.largest = 0.0  # stress seen

    def curvatures(self, w):
        return np.stack([rows @ w for rows in self.rows], axis=1) + self.constants

    def norm(self, curvatures):
        return np.sqrt(np.einsum("nak,nab,nbk->n", curvatures, self.form, curvatures))

    def stress(self, w, before):
        xi = self.curvatures(w) - (1 + self.hardening)[:, None, None] * before
        xi[~self.flows] = 0
        return xi, self.norm(xi)

    def flowed(self, w, before):
        """The plastic curvatures that w makes (return mapping)."""
        xi, q = self.stress(w, before)
        self.largest = max(self.largest, float(q.max()))
        over = q > self.yield_stress
        share = np.zeros_like(q)
        share[over] = (1 - self.yield_stress[over] / q[over]) / (1 + self.hardening[over])
        return before + share[:, None, None] * xi

    def forces(self, plastic):
        """What plastic curvatures add on the right, #unknowns x 3."""
        moments = self.area[:, None, None] * np.einsum("nab,nbk->nak", self.form, plastic)
        return sum(rows.T @ moments[:, a] for a, rows in enumerate(self.rows))

    def tangent(self, w, before):
        """What flowing takes from the elastic matrix of (x, y, z) together."""
        xi, q = self.stress(w, before)
        over = np.nonzero(q > self.yield_stress)[0]
        blocks = np.zeros((len(over), 9, 9))  # by component, then uu, vv, uv
        for block, n in zip(blocks, over):
            form, x, y = np.kron(np.eye(3), self.form[n]), xi[n].T.ravel(), self.yield_stress[n]
            flow = (1 - y / q[n]) * np.eye(9) + y / q[n]**3 * np.outer(x, form @ x)
            flow[~np.tile(self.flows[n], 3)] = 0
            block[:] = self.area[n] / (1 + self.hardening[n]) * form @ flow
        count = self.rows[0].shape[1]
        at, unknown, value = [], [], []
        for a, rows in enumerate(self.rows):
            part = rows[over].tocoo()
            for k in range(3):
                at.append(9 * part.row + 3 * k + a)
                unknown.append(count * k + part.col)
                value.append(part.data)
        strain = sparse.csr_matrix(
            tuple([np.concatenate(value), tuple(map(np.concatenate, (at, unknown)))]),
            shape=(9 * len(over), 3 * count))
        middle = sparse.bsr_matrix((blocks, np.arange(len(over)), np.arange(len(over) + 1)),
                                   shape=(9 * len(over),) * 2)
        return (strain.T @ middle @ strain).tocsc()

    def energy(self, w, plastic):
        """What E_p has beyond E."""
        elastic = self.curvatures(w)
        parts = (self.norm(elastic - plastic)**2 - self.norm(elastic)**2 +
                 self.hardening * self.norm(plastic)**2)
        return float((self.area * parts).sum()) / 2

    def dissipation(self, plastic, before):
        return float((self.area * self.yield_stress * self.norm(plastic - before)).sum())


def flow_of_nodes(bending, yield_stress, hardening):
    """Of a `Bending`, on all its nodes."""
    m, n = bending.shape
    around = [sparse.diags([0.5, 0.5], [0, -1], shape=(k, k - 1)).tolil() for k in (m, n)]
    for mean in around:
        mean[0, 0] = mean[-1, -1] = 1
    mean = sparse.kron(around[0].tocsr(), around[1].tocsr())
    rows = [bending.of_u, bending.of_v, (mean @ bending.of_cells).tocsr()]
    constants = np.stack([bending.slope_u, bending.slope_v, np.zeros_like(bending.slope_u)], axis=1)
    uu, vv, uv = (x.ravel() for x in (bending.uu, bending.vv, bending.uv))
    form = np.zeros((m * n, 3, 3))
    form[:, 0, 0], form[:, 1, 1], form[:, 2, 2] = uu, vv, bending.tau.ravel()
    form[:, 0, 1] = form[:, 1, 0] = uv
    flows = np.stack([uu > 0, vv > 0, np.ones(m * n, dtype=bool)], axis=1)
    yield_stress, hardening = (np.broadcast_to(x, (m, n)).ravel()
                               for x in (yield_stress, hardening))
    return Flow(rows, constants, form, bending.area.ravel(), flows, yield_stress, hardening)


def held(flow, free, w):
    """The flow as one of the unknowns that are free, the others held as they are in w."""
    constants = flow.constants + np.stack([rows[:, ~free] @ w[~free] for rows in flow.rows], axis=1)
    return Flow([rows[:, free] for rows in flow.rows], constants, flow.form, flow.area, flow.flows,
                flow.yield_stress, flow.hardening)


def plastic_step(flow, stiffness, known, density, damping, w, velocity, plastic, dt):
    """One backward Euler step of the unknowns w and velocity (#unknowns x 3) and of the plastic
    curvatures; density and damping are each unknown's whole."""
    shift = density / dt**2 + damping / dt
    assert shift.any() or (flow.hardening > 0).all(), "a static frame needs hardening"
    elastic = (stiffness + sparse.diags(shift)).tocsc()
    right = known + shift[:, None] * w + (density / dt)[:, None] * velocity
    factor = linalg.splu(elastic)

    def rest(x):
        return right + flow.forces(flow.flowed(x, plastic)) - elastic @ x

    x = factor.solve(right + flow.forces(plastic))
    size = np.inf
    for _ in range(200):
        left = rest(x)
        last, size = size, np.abs(factor.solve(left)).max()
        scale = np.abs(x).max()
        if not size > 1e-14 * scale or (size < 1e-11 * scale and size >= last):
            break
        tangent = (sparse.block_diag([elastic] * 3) - flow.tangent(x, plastic)).tocsc()
        way = linalg.splu(tangent).solve(left.T.ravel()).reshape(3, -1).T
        # The energy's slope along the way is monotone.
        part, start = 1.0, float((left * way).sum())
        while part > 1e-6 and float((rest(x + part * way) * way).sum()) < -0.5 * start:
            part /= 2
        x = x + part * way
    else:
        raise AssertionError("a plastic step does not converge")
    return x, (x - w) / dt, flow.flowed(x, plastic)


class PlasticRegion:
    """A region whose nodes are those of a `Bending`, under a load. Arrays are M x N x 3, and plastic curvatures
    those of all nodes, with any numbers of dimensions."""

    def __init__(self, bending, flow, w, load, density, damping):
        self.shape, self.flow = bending.shape, flow
        self.free, matrix = bending.is_free.ravel(), bending.matrix()
        free = self.free
        self.density, self.damping = ((np.broadcast_to(x, self.shape) * bending.area).ravel()[free]
                                      for x in (density, damping))
        w = w.reshape(-1, 3)
        known = (bending.area[..., None] * load).reshape(-1, 3) + bending.slope_forces()
        self.known = known[free] - matrix[free][:, ~free] @ w[~free]
        self.part, self.inner = held(flow, free, w), matrix[free][:, free]

    def advance(self, w, velocity, plastic, count, dt):
        """`count` backward Euler steps."""
        form_of_plastic, free = plastic.shape, self.free
        w, velocity = w.reshape(-1, 3).copy(), velocity.reshape(-1, 3).copy()
        velocity[~free] = 0
        plastic = plastic.reshape(-1, 3, 3)
        for _ in range(count):
            w[free], velocity[free], plastic = plastic_step(
                self.part, self.inner, self.known, self.density, self.damping, w[free], velocity[free], plastic, dt)
        self.flow.largest = max(self.flow.largest, self.part.largest)
        return w.reshape(*self.shape, 3), velocity.reshape(*self.shape, 3), plastic.reshape(form_of_plastic)

    def with_flow_of(self, w, velocity, plastic, dt):
        """Functions of where a step ends: where it would end under the load alone if that flows which flows there,
        and the plastic curvatures."""
        free, before = self.free, plastic.reshape(-1, 3, 3)
        shift = self.density / dt**2 + self.damping / dt
        factor = linalg.splu((self.inner + sparse.diags(shift)).tocsc())
        start = w.reshape(-1, 3)
        right = self.known + shift[:, None] * start[free] + (
            self.density / dt)[:, None] * velocity.reshape(-1, 3)[free]

        def flowed(end):
            return self.part.flowed(end.reshape(-1, 3)[free], before)

        def flowing(end):
            x = start.copy()
            x[free] = factor.solve(right + self.part.forces(flowed(end)))
            return x.reshape(w.shape)

        return flowing, lambda end: flowed(end).reshape(plastic.shape)
