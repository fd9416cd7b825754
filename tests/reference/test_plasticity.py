"""Self-checks of plates that yield (SPEC 9): each step is a minimum, and its figures by hand."""

import unittest

import numpy as np
import scipy.sparse

import triangle_plate
from bending import Bending
from plasticity import flow_of_nodes, held, plastic_step
from stepping import with_integrator
from test_reference import square_mesh
from triangle_region import Region

NO_SLOPES = {name: np.zeros(3) for name in ("su0", "su1", "sv0", "sv1")}


class Example:
    """A random plate in the middle of a motion, with its steps."""

    def __init__(self, seed, edges, hardening=0.3, density=0.4):
        self.rng = rng = np.random.default_rng(seed)
        self.shape = shape = 6, 5
        b, d = rng.uniform(0.5, 2, (2,) + shape)
        c = np.sqrt(b * d) * rng.uniform(0.8, 2, shape)
        slopes = {name: rng.uniform(-1, 1, 3) for name in NO_SLOPES}
        bending = Bending(shape, 0.2, 0.3, edges, b, c, d, 0.3, slopes)
        whole = flow_of_nodes(bending, rng.uniform(1, 4, shape), hardening)
        free = bending.is_free.ravel()
        start, self.matrix = rng.standard_normal(shape + (3,)).reshape(-1, 3), bending.matrix()
        self.flow = held(whole, free, start)
        self.known = 300 * rng.standard_normal((int(free.sum()), 3))
        self.known -= self.matrix[free][:, ~free] @ start[~free]
        self.stiffness = self.matrix[free][:, free]
        self.masses = bending.area.ravel()[free]
        self.density, self.damping = density * self.masses, 0.7 * self.masses
        self.w, self.velocity = 0.1 * start[free], rng.standard_normal((int(free.sum()), 3))
        self.plastic = rng.standard_normal((len(self.flow.area), 3, 3)) * self.flow.flows[..., None]

    def step(self, w, velocity, plastic, dt):
        return plastic_step(self.flow, self.stiffness, self.known, self.density, self.damping, w,
                            velocity, plastic, dt)

    def elastic(self, w):
        return float((w * (self.stiffness @ w)).sum() / 2 - (self.known * w).sum())


class Plasticity(unittest.TestCase):
    EDGES = (("clamped",) * 4, ("pinned", "free", "free", "clamped"), ("free",) * 4)

    def test_a_step_is_the_minimum(self):
        dt = 0.1
        for seed, edges in enumerate(self.EDGES):
            one = Example(seed, edges)

            def energy(w, plastic):
                moved = w - one.w - dt * one.velocity
                return (float((one.density[:, None] / dt**2 * moved**2 +
                               one.damping[:, None] / dt * (w - one.w)**2).sum()) / 2 +
                        one.elastic(w) + one.flow.energy(w, plastic) +
                        one.flow.dissipation(plastic, one.plastic))

            w, velocity, plastic = one.step(one.w, one.velocity, one.plastic, dt)
            np.testing.assert_allclose(velocity, (w - one.w) / dt)
            flowing = (plastic != one.plastic).any(axis=(1, 2))
            self.assertTrue(0.2 < flowing.mean())
            least = energy(w, plastic)
            for _ in range(200):
                size = 10.0**one.rng.uniform(-4, 0)
                other = plastic + size * one.rng.standard_normal(plastic.shape) * (
                    one.flow.flows[..., None])
                if one.rng.random() < 0.5:
                    other[one.rng.random(len(other)) < 0.8] = plastic[0]
                other[~one.flow.flows] = 0
                near = w + size * one.rng.standard_normal(w.shape)
                for trial in ((near, plastic), (w, other), (near, other)):
                    self.assertGreater(energy(*trial), least - 1e-12 * abs(least))
            # What is elastic is at most at the yield stress, what flows lies on it.
            q = one.flow.norm(one.flow.curvatures(w) * one.flow.flows[..., None] -
                              (1 + one.flow.hardening)[:, None, None] * plastic)
            self.assertLess((q / one.flow.yield_stress).max(), 1 + 1e-12)
            np.testing.assert_allclose(q[flowing], one.flow.yield_stress[flowing], rtol=1e-12)

    def test_the_tangent_is_the_derivative(self):
        for seed, edges in enumerate(self.EDGES):
            one = Example(seed, edges)
            way = one.rng.standard_normal(one.w.shape)

            def force(w):
                return one.flow.forces(one.flow.flowed(w, one.plastic))

            h = 1e-6
            expected = (force(one.w + h * way) - force(one.w - h * way)) / (2 * h)
            product = (one.flow.tangent(one.w, one.plastic) @ way.T.ravel()).reshape(3, -1).T
            np.testing.assert_allclose(product, expected, atol=1e-7 * np.abs(expected).max())

    def test_what_does_not_reach_the_yield_stress_is_elastic(self):
        one = Example(3, ("clamped",) * 4)
        one.flow.yield_stress = np.full(len(one.flow.area), 1e9)
        w, _, plastic = one.step(one.w, one.velocity, one.plastic, 0.1)
        np.testing.assert_array_equal(plastic, one.plastic)
        shift = one.density / 0.01 + one.damping / 0.1
        left = (one.stiffness + scipy.sparse.diags(shift)) @ w
        right = (one.known + shift[:, None] * one.w + one.density[:, None] / 0.1 * one.velocity +
                 one.flow.forces(plastic))
        np.testing.assert_allclose(left, right, atol=1e-10 * np.abs(right).max())

    def test_energy_never_grows_without_work(self):
        for integrator in ("backwardEuler", "newmark"):
            one = Example(5, ("pinned", "free", "clamped", "free"))
            one.damping[:] = 0
            one.known[:] = 0
            one.flow.constants[:] = 0
            state = one.w, one.velocity, np.zeros_like(one.plastic)
            step = with_integrator(integrator, 1.0, lambda *rest: one.step(*rest[:3], rest[4]), 3)
            energies = []
            for _ in range(40):
                w, velocity, plastic = state
                energies.append(float((one.density[:, None] * velocity**2).sum()) / 2 +
                                one.elastic(w) + one.flow.energy(w, plastic))
                state = step(*state, 1, 0.05)
            self.assertLess(np.diff(energies).max(), 1e-10 * energies[0])
            self.assertLess(energies[-1], 0.9 * energies[0])

    def test_cyclic_bending_closes_a_loop(self):
        one = Example(6, ("clamped",) * 4, hardening=0.2, density=0.0)
        one.damping[:] = 0
        load = one.known
        state, ends = (0 * one.w, 0 * one.velocity, np.zeros_like(one.plastic)), []
        for k in range(1, 121):
            one.known = np.sin(2 * np.pi * k / 20) * load
            state = one.step(*state, 1.0)
            if k % 20 == 0:
                ends.append((state[0], state[2]))
        for last, before in zip(ends[-1], ends[-2]):
            self.assertGreater(np.abs(last).max(), 0.1)
            np.testing.assert_allclose(last, before, atol=1e-9 * np.abs(last).max())

    def test_pure_bending_by_hand(self):
        # Uniform curvature of a free static strip: kappa_p = (kappa - Y/sqrt(b)) / (1 + H).
        bending = Bending((5, 4), 0.5, 0.5, ("clamped",) * 4, 2.0, 1.0, 1.0, 0.0, {
            **NO_SLOPES, "su0": np.array([0, 0.0, 0]), "su1": np.array([0, 6.0, 0])})
        flow = flow_of_nodes(bending, 3.0, 0.5)
        u = 0.5 * np.arange(5)
        w = np.zeros((5, 4, 3))
        w[..., 1] = 1.5 * u[:, None]**2  # curvature 3
        plastic = flow.flowed(w.reshape(-1, 3), np.zeros((20, 3, 3)))
        expected = np.zeros((20, 3, 3))
        expected[:, 0, 1] = (3 - 3 / np.sqrt(2)) / 1.5
        np.testing.assert_allclose(plastic, expected, atol=1e-14)
        again = flow.flowed(w.reshape(-1, 3), plastic)
        np.testing.assert_allclose(again, plastic, atol=1e-14)

    def test_curvatures_of_triangles_are_those_of_the_energy(self):
        # Where a triangle is one cell, exactly; where it is cut, their mean has less energy.
        mesh = square_mesh(5, np.random.default_rng(2), border="free")
        material = {"density": 1.0, "damping": 0.0, "poisson": 0.3, "goal": 0.0}
        for name, value in (("b", 1.0), ("c", 2.0), ("d", 1.5), ("yield", 1.0), ("hardening", 0.1)):
            material[name] = np.full(len(mesh.triangles), value)
        rng = np.random.default_rng(8)
        for phi in (np.ones(len(mesh.rest)), mesh.rest[:, 0] - 0.43):
            region = Region(mesh, mesh.at_points(phi), may_float=True)
            plate = triangle_plate.Plate(region, np.zeros((len(mesh.rest), 3)), material, NO_SLOPES)
            flow, triangles = triangle_plate.flow_of_triangles(plate, region, material)
            self.assertAlmostEqual(flow.area.sum(), region.areas.sum())
            x = rng.standard_normal((len(plate.right), 3))
            whole = float((x * (plate.stiffness @ x)).sum())
            of_means = float((flow.area * flow.norm(flow.curvatures(x))**2).sum())
            if len(region.cells) == len(triangles):
                self.assertAlmostEqual(of_means / whole, 1, places=12)
            else:
                self.assertTrue(0.1 < of_means / whole < 0.99)


if __name__ == "__main__":
    unittest.main()
