"""Self-checks of exact motion: its formulas against each other and against many small steps."""

import unittest

import numpy as np
import scipy.sparse

from exact_motion import exact_motion, uneven_motion


class ExactMotion(unittest.TestCase):
    """A chain whose first springs are weak or missing."""

    def example(self, weak):
        rng = np.random.default_rng(4)
        springs = np.concatenate([[0.0, weak], rng.uniform(1, 3, 10)])
        steps = scipy.sparse.diags([1, -1], [0, -1], shape=(12, 12))
        stiffness = (steps.T @ scipy.sparse.diags(springs) @ steps).tocsc()
        self.masses = rng.uniform(0.5, 2, 12)
        self.forces = rng.standard_normal((2, 12, 3))
        self.state = rng.standard_normal((2, 12, 3))
        self.dampings = rng.uniform(0.1, 1, 12)
        return stiffness

    def test_formula_and_exponential_agree(self):
        for weak in (1.0, 1e-3, 1e-6, 1e-12, 0.0):
            stiffness = self.example(weak)
            for damping in (0.0, 0.3, 40.0):
                modes = exact_motion(stiffness, self.masses, {"density": 2.0, "damping": damping},
                                     self.forces, *self.state, 0.7)
                whole = uneven_motion(stiffness.toarray(), 2 * self.masses,
                                      np.full(12, damping / 2), *self.forces, *self.state, 0.7)
                np.testing.assert_allclose(modes, whole, atol=1e-12)

    def test_many_small_steps_come_near(self):
        count, time = 4000, 0.7
        for density, damping in ((2.0, None), (0.0, None), (0.0, 0.8)):
            stiffness = self.example(0.01)
            eta = self.dampings if damping is None else np.full(12, damping)
            exact, _ = exact_motion(stiffness, self.masses, {"density": density, "damping": eta},
                                    self.forces, *self.state, time)
            (w, v), h = self.state, time / count
            rho, eta = density * self.masses[:, None], (self.masses * eta)[:, None]
            shift = 2 * rho / h**2 + eta / h if density else eta / h
            inverse = np.linalg.inv(np.diag(shift[:, 0]) + stiffness.toarray() / 2)
            for k in range(count):  # the trapezoidal rule
                force = self.forces[0] + (k + 0.5) / count * (self.forces[1] - self.forces[0])
                middle = force - stiffness @ w / 2
                following = inverse @ (middle + shift * w + (2 * rho / h * v if density else 0))
                v = 2 * (following - w) / h - v
                w = following
            np.testing.assert_allclose(exact, w, atol=1e-5)


if __name__ == "__main__":
    unittest.main()
