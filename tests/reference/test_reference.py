#!/usr/bin/env python3
"""Self-checks of the reference: figures, stencil, regions and curves by hand.

    python3 -m unittest discover -s tests/reference
"""

import math
import os
import sys
import tempfile
import unittest

import numpy as np
import scipy.sparse.linalg

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import forces  # noqa: E402
import stencil  # noqa: E402
import stepping  # noqa: E402
import triangle_plate  # noqa: E402
import triangle_region  # noqa: E402
from bakes import bake  # noqa: E402
from curves import Curve, Key, auto_weight, limit_lengths, time_is_monotone  # noqa: E402
from diagnostics import Diagnostics  # noqa: E402
from scene import Scene  # noqa: E402
from triangle_mesh import TriangleMesh  # noqa: E402
from triangle_region import bending, hat_integrals, snapped  # noqa: E402

FLAT = {name: np.zeros(1) for name in ("su0", "su1", "sv0", "sv1")}
ISOTROPIC = {"density": 0.0, "damping": 0.0, "b": 1.0, "c": 2.0, "d": 1.0, "goal": 0.0}


def scene_from(text):
    """A Scene from its XML body (without the root element)."""
    with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(text)
        file.flush()
        return Scene(file.name)


def observed_order(errors):
    """Convergence order from the errors of grids that are refined by 2."""
    return [math.log2(coarse / fine) for coarse, fine in zip(errors, errors[1:])]


class Plate(unittest.TestCase):
    """SPEC 11, and the stencil of SPEC 4."""

    def centre_deflection(self, nodes):
        h = 1 / (nodes - 1)
        load = np.ones((nodes, nodes, 3))
        w, _ = stencil.advance(np.zeros_like(load), np.zeros_like(load), load, h, h, ISOTROPIC,
                              FLAT, 1, 0.01)
        return w[nodes // 2, nodes // 2, 1]

    def test_uniform_load_converges_with_order_two(self):
        values = [self.centre_deflection(nodes) for nodes in (17, 33, 65)]
        errors = [abs(value - 0.00126532) for value in values]
        # The figure has six digits: its own error is 4e-6 of it, against 2e-3 on the finest grid.
        self.assertLess(errors[-1], 4e-3 * 0.00126532)
        for order in observed_order(errors):
            self.assertAlmostEqual(order, 2.0, delta=0.1)
        extrapolated = values[-1] + (values[-1] - values[-2]) / 3
        # What the extrapolation leaves is O(h^4), 1e-5 of the figure on these grids.
        self.assertAlmostEqual(extrapolated, 0.00126532, delta=2e-8)

    def test_first_frequency(self):
        frequencies = []
        for nodes in (17, 33):
            operator = stencil.assemble(nodes, nodes, 1 / (nodes - 1), 1 / (nodes - 1), 1, 2, 1)
            smallest = scipy.sparse.linalg.eigsh(operator, 1, sigma=0, which="LM")[0][0]
            frequencies.append(math.sqrt(smallest))
        extrapolated = frequencies[1] + (frequencies[1] - frequencies[0]) / 3
        self.assertAlmostEqual(frequencies[1], 35.985, delta=0.4)
        self.assertAlmostEqual(extrapolated, 35.985, delta=0.01)

    def test_smallest_region(self):
        h, b, c, d = 0.25, 1.5, -0.5, 0.75
        operator = stencil.assemble(3, 3, h, h, b, c, d).toarray()
        self.assertEqual(operator.shape, (1, 1))
        self.assertAlmostEqual(operator[0, 0] * h**4, 8 * b + 4 * c + 8 * d, places=12)

    def test_matrix_and_ghost_nodes_agree(self):
        rng = np.random.default_rng(1)
        w = rng.standard_normal((6, 5, 3))
        tangents = {name: rng.standard_normal(3) for name in FLAT}
        arguments = 0.3, 0.2, 1.2, -0.7, 0.4
        literal = stencil.apply_operator(w, *arguments, tangents)
        rim = w.copy()
        rim[1:-1, 1:-1] = 0
        product = stencil.assemble(6, 5, *arguments) @ w[1:-1, 1:-1].reshape(-1, 3)
        sum_of_parts = product.reshape(4, 3, 3) + stencil.apply_operator(rim, *arguments, tangents)
        np.testing.assert_allclose(sum_of_parts, literal, rtol=1e-10)

    def test_matrix_is_symmetric(self):
        operator = stencil.assemble(7, 6, 0.3, 0.2, 1.2, -0.7, 0.4)
        np.testing.assert_allclose((operator - operator.T).toarray(), 0, atol=1e-10)

    def test_stencil_is_exact_on_quartics(self):
        # w = u^4/24 + v^4/12 + u^2 v^2/4 has L w = b + 2d + c with its own slopes as tangents
        # where those are constant along the edge; check an inner node, far from ghosts.
        u, v = np.meshgrid(np.arange(7) * 0.5, np.arange(7) * 0.25, indexing="ij")
        w = (u**4 / 24 + v**4 / 12 + u**2 * v**2 / 4)[..., None] * np.ones(3)
        result = stencil.apply_operator(w, 0.5, 0.25, 1.5, 0.5, 2.0, FLAT)
        self.assertAlmostEqual(result[2, 2, 0], 1.5 + 2 * 2.0 + 0.5, places=9)

    def test_cubic_is_reproduced_by_its_rim_and_tangents(self):
        # w = u^2 (3 - 2u) has zero tangents in u at 0 and 1; L w = 0 and it is constant in v.
        u = np.linspace(0, 1, 9)
        exact = np.repeat((u * u * (3 - 2 * u))[:, None], 6, axis=1)[..., None] * np.ones(3)
        h = 1 / 8
        # The central difference at the edge is not the derivative: prescribe what it is there.
        slope = ((h * h * (3 - 2 * h)) - (h * h * (3 + 2 * h))) / (2 * h)
        tangents = {**FLAT, "su0": np.full(1, slope), "su1": np.full(1, slope)}
        start = exact.copy()
        start[1:-1, 1:-1] = 0
        w, _ = stencil.advance(start, np.zeros_like(start), np.zeros_like(start), h, 0.2,
                              ISOTROPIC, tangents, 1, 1.0)
        np.testing.assert_allclose(w, exact, atol=1e-12)

    def test_one_step_of_one_unknown(self):
        # 3x3: (rho/dt^2 + eta/dt + k) w1 = F + (rho/dt^2 + eta/dt) w0 + rho/dt v0.
        w, v = np.zeros((3, 3, 3)), np.zeros((3, 3, 3))
        load = np.full((3, 3, 3), 7.0)
        w[1, 1], v[1, 1] = 0.25, -3.0
        material = {"density": 2.0, "damping": 5.0, "b": 1.0, "c": 2.0, "d": 1.0, "goal": 0.0}
        k, dt = 24 / 0.5**4, 0.125
        mass = 2.0 / dt**2 + 5.0 / dt
        expected = (7.0 + mass * 0.25 + 2.0 / dt * -3.0) / (mass + k)
        w1, v1 = stencil.advance(w, v, load, 0.5, 0.5, material, FLAT, 1, dt)
        np.testing.assert_allclose(w1[1, 1], expected, rtol=1e-14)
        np.testing.assert_allclose(v1[1, 1], (expected - 0.25) / dt, rtol=1e-13)

    def test_steps_of_frame(self):
        self.assertEqual(stepping.steps_of_frame(1 / 24, 0.01, "exact"), (5, 1 / 24 / 5))
        self.assertEqual(stepping.steps_of_frame(1 / 24, 0.01, "overshoot"), (5, 0.01))
        self.assertEqual(stepping.steps_of_frame(1 / 24, 1.0, "exact"), (1, 1 / 24))
        self.assertEqual(stepping.steps_of_frame(1 / 24, 1.0, "overshoot"), (1, 1.0))
        self.assertEqual(stepping.steps_of_frame(1 / 24, 1 / 240, "exact")[0], 10)


SQUARE = """<scene version="1" start="1" end="3">
  <surface name="sheet"><grid columns="13" rows="13" width="12" depth="12"/>
    {surface}</surface>
  {forces}
</scene>"""


class Region(unittest.TestCase):
    """SPEC 5 and 6 on an integer lattice: node (i, j) stands at (i - 6, 0, j - 6)."""

    def bake(self, forces, surface=""):
        diagnostics = Diagnostics()
        scene = scene_from(SQUARE.format(forces=forces, surface=surface))
        return bake(scene, diagnostics)["sheet"], diagnostics

    def test_ties_are_outside(self):
        # Radius 5 about node (6, 6): (3,4), (4,3), (5,0) and (0,5) are at 5 exactly, so outside;
        # the farthest columns inside are 4 away: the box is columns and rows 2..10.
        _, diagnostics = self.bake('<point name="a" deformationRadius="5" forceRadius="1"/>')
        self.assertEqual([solve[2] for solve in diagnostics.solves], [(2, 10, 2, 10)] * 3)
        # 12 nodes at distance 5, and the 4 neighbours of the centre at forceRadius, per frame.
        self.assertEqual(diagnostics.exact_ties, 3 * (12 + 4))

    def test_union_of_boxes(self):
        _, diagnostics = self.bake(
            '<point name="a" center="-4 0 -4" deformationRadius="1.5"/>'
            '<point name="b" center="4 0 2" deformationRadius="2"/>')
        self.assertEqual(diagnostics.solves[0][2], (1, 11, 1, 9))

    def test_region_below_three_nodes(self):
        baked, diagnostics = self.bake(
            '<point name="a" deformationRadius="1" forceRadius="3" magnitude="9"/>')
        self.assertEqual([skip[2] for skip in diagnostics.skips], ["below 3x3"] * 3)
        self.assertEqual(baked.peak(), 0)

    def test_smallest_region_by_hand(self):
        # 3x3 about the centre, the force box is its one interior node: k w = F.
        baked, diagnostics = self.bake(
            '<point name="a" direction="0 2 0" deformationRadius="1.5" forceRadius="0.5" '
            'magnitude="100000"/>', '<material density="0" damping="0"/>')
        self.assertEqual(diagnostics.solves[0][2], (5, 7, 5, 7))
        np.testing.assert_allclose(baked.world[1, 6 * 13 + 6], [0, 100000 / (24 * 12**4), 0],
                                   rtol=1e-12)
        np.testing.assert_array_equal(baked.world[0], baked.world_rest[0])
        self.assertEqual(np.count_nonzero((baked.world - baked.world_rest)[1]), 1)

    def test_rotation_orders(self):
        turned = forces.rotation("xyz", (90, 0, 90)) @ np.array([0, 1, 0])
        np.testing.assert_allclose(turned, [0, 0, 1], atol=1e-15)  # x first: y to z, z stays
        turned = forces.rotation("zyx", (90, 0, 90)) @ np.array([0, 1, 0])
        np.testing.assert_allclose(turned, [-1, 0, 0], atol=1e-15)  # z first: y to -x, -x stays


def curve(*keys, before=("hold", None), after=("hold", None)):
    return Curve([Key(*key) if isinstance(key, tuple) else key for key in keys], before, after)


class Curves(unittest.TestCase):
    """Identities of docs/timeline.md."""

    def test_numeric_slopes_reproduce_a_cubic(self):
        def f(t):
            return 1 - 2 * t + 0.5 * t**2 - 0.25 * t**3

        def slope(t):
            return np.array([-2 + t - 0.75 * t**2])

        c = curve(*[Key(t, f(t), "bezier", slope(t), slope(t)) for t in (0, 0.5, 2, 3)])
        for t in np.linspace(0, 3, 50):
            self.assertAlmostEqual(c(t)[0], f(t), places=13)

    def test_lengths_of_a_third_are_the_default(self):
        m = np.array([2.0])
        default = curve(Key(0, 0, "bezier", m, m), Key(3, 5, "bezier", m, m))
        # Handles a hair off a third go through the solve; the curve must be the same.
        solved = curve(Key(0, 0, "bezier", m, m, None, 1 + 1e-12), Key(3, 5, "bezier", m, m))
        for t in np.linspace(0, 3, 31):
            self.assertAlmostEqual(default(t)[0], solved(t)[0], places=10)

    def test_straight_bezier_is_linear_whatever_its_lengths(self):
        m = np.array([1.5])
        c = curve(Key(0, 0, "bezier", m, m, None, 3.5), Key(4, 6, "bezier", m, m, 0.25, None))
        for t in np.linspace(0, 4, 33):
            self.assertAlmostEqual(c(t)[0], 1.5 * t, places=13)

    def test_auto_is_flat_at_extrema_and_does_not_overshoot(self):
        c = curve((0, 0), (1, 4), (2, 4.5), (3, 1), (7, 1))
        self.assertEqual(c._tangent(2, "in")[0], 0)
        self.assertEqual(c._tangent(3, "in")[0], 0)
        self.assertLessEqual(c._tangent(1, "in")[0], 1.5)
        values = [c(t)[0] for t in np.linspace(0, 7, 200)]
        self.assertLessEqual(max(values), 4.5)
        self.assertGreaterEqual(min(values), 0)

    def test_auto_weight(self):
        self.assertEqual([auto_weight(f) for f in (0, 0.5, 1)], [0, 0.5, 1])

    def test_limit_reaches_the_ellipse_and_keeps_the_ratio(self):
        for a, b in ((2, 1), (1, 3), (1.1, 1.1), (5, 0.2)):
            new_a, new_b = limit_lengths(a, b)
            self.assertAlmostEqual(new_a / new_b, a / b)
            on_ellipse = new_a**2 + new_b**2 + new_a * new_b - 2 * new_a - 2 * new_b + 1
            self.assertAlmostEqual(on_ellipse, 0)
        self.assertEqual(limit_lengths(2, 0), (1, 0))
        self.assertEqual(limit_lengths(0, 2), (0, 1))
        self.assertEqual(limit_lengths(1, 1), (1, 1))
        self.assertTrue(time_is_monotone(4 / 3 - 1e-9, 1 / 3))

    def test_loops(self):
        keys = ((2, 1, "linear"), (4, 5, "linear"), (6, 3))
        repeat = curve(*keys, after=("repeat", None), before=("repeat", None))
        self.assertEqual([repeat(t)[0] for t in (6, 7, 8, 9, 10, 11)], [3, 3, 5, 4, 3, 3])
        self.assertEqual([repeat(t)[0] for t in (1, 0, -1, -2, -3)], [4, 5, 3, 1, 4])
        offset = curve(*keys, after=("repeatOffset", None), before=("repeatOffset", 1))
        self.assertEqual([offset(t)[0] for t in (7, 8, 10, 12)], [5, 7, 5, 9])
        self.assertEqual([offset(t)[0] for t in (1, 0, -2, -3, -9)], [2, 3, -1, -1, -1])
        mirror = curve(*keys, after=("mirror", 3), before=("mirror", None))
        self.assertEqual([mirror(t)[0] for t in (7, 8, 10, 11, 14, 18, 19)], [4, 5, 1, 3, 3, 1, 1])
        self.assertEqual([mirror(t)[0] for t in (1, 0, -2, -3)], [3, 5, 3, 4])

    def test_periodic_seam_is_smooth(self):
        c = curve((0, 0), (2, 3), (5, 7), after=("repeatOffset", None))
        self.assertEqual(c._tangent(0, "out"), c._tangent(2, "in"))
        self.assertGreater(c._tangent(0, "out")[0], 0)
        self.assertEqual(curve((0, 0), (2, 3), (5, 7))._tangent(0, "out")[0], 0)
        self.assertEqual(curve((0, 0), (2, 3), (5, 7), after=("repeat", None))._tangent(0, "out"),
                         0)

    def test_step_takes_the_value_of_its_key(self):
        c = curve((0, 1, "step"), (2, 5, "stepNext"), (4, 7))
        self.assertEqual([c(t)[0] for t in (0, 1, 2, 3, 4)], [1, 1, 5, 7, 7])


def square_mesh(count, rng, **attributes):
    """Quads over the unit square, half of them cut into triangles, vertices within moved."""
    places = np.array([(i, 0, j) for j in range(count + 1) for i in range(count + 1)]) / count
    within = ((places[:, [0, 2]] > 0) & (places[:, [0, 2]] < 1)).all(axis=1)
    places[np.ix_(within, [0, 2])] += 0.2 / count * rng.uniform(-1, 1, (int(within.sum()), 2))
    faces = []
    for j in range(count):
        for i in range(count):
            a = j * (count + 1) + i
            quad = [(k, None) for k in (a, a + count + 1, a + count + 2, a + 1)]
            faces += [quad] if rng.random() < 0.5 else [quad[:3], [quad[0]] + quad[2:]]
    return TriangleMesh(places, faces, **attributes)


class Triangles(unittest.TestCase):
    """SPEC 8."""

    def test_bending_is_exact_for_quadratics(self):
        rng = np.random.default_rng(3)
        places = rng.uniform(-1, 1, (50, 3, 2))
        areas, normals, columns = bending(places)
        hessian = np.array([[0.7, -0.4], [-0.4, 1.3]])
        w = np.einsum("cki,ij,ckj->ck", places, hessian, places) / 2 + places[..., 0] - 2
        middles = (places + np.roll(places, -1, axis=1)) / 2
        slopes = ((middles @ hessian + [1, 0]) * normals).sum(axis=-1)
        result = np.einsum("chk,ck->ch", columns, np.concatenate([w, slopes], axis=1))
        size = (np.abs(columns).max(axis=(1, 2)) * 10)[:, None]
        np.testing.assert_array_less(np.abs(result - [0.7, 1.3, -0.4]) / size, 1e-14)
        turned = bending(places[:, ::-1])[0]
        np.testing.assert_allclose(turned, areas, rtol=1e-12)

    def test_hat_integrals(self):
        third = [1 / 3] * 3
        for values, expected in (((1, 2, 3), third), ((0, 0, 1), third), ((-1, 0, -2), [0] * 3),
                                 ((0, 0, 0), [0] * 3), ((1, -1, 0), [1 / 4, 1 / 12, 1 / 6]),
                                 ((1, -1, -1), [1 / 6, 1 / 24, 1 / 24]),
                                 ((-1, 1, 1), [1 / 3 - 1 / 6, 1 / 3 - 1 / 24, 1 / 3 - 1 / 24])):
            np.testing.assert_allclose(hat_integrals([float(x) for x in values]), expected,
                                       atol=1e-15, err_msg=str(values))

    def test_cuts_near_a_node_go_through_it(self):
        mesh = TriangleMesh(np.array([(0.0, 0, 0), (0, 0, 1), (1, 0, 0)]),
                            [[(0, None), (1, None), (2, None)]])
        for phi, expected in (((1, -1, 2), (1, -1, 2)), ((0.1, -1, 2), (0, -1, 2)),
                              ((9, -0.9, 9), (9, 0, 9)), ((9, -1.1, 9), (9, -1.1, 9)),
                              ((0.1, -1, -0.005), (0, -1, 0))):
            np.testing.assert_array_equal(
                snapped(mesh, np.array(phi, dtype=float), Diagnostics()), expected)

    def test_flat_triangles_get_an_area(self):
        mesh = TriangleMesh(np.array([(0.0, 0, 0), (0.4, 0, 0), (1, 0, 0), (0.5, 1, 0)]),
                            [[(k, None) for k in face] for face in ((0, 1, 2), (0, 2, 3))])
        places = mesh.layout[0]
        lengths = np.linalg.norm(places - np.roll(places, -1, axis=0), axis=1)
        np.testing.assert_allclose(lengths, [0.4 + 1e-8, 0.6 + 1e-8, 1 + 1e-8], rtol=1e-15)
        self.assertEqual(places[0, 1], places[2, 1])  # u along the longest edge

    def test_clamped_square(self):
        errors = []
        for count in (8, 16):
            mesh = square_mesh(count, np.random.default_rng(4))
            self.assertAlmostEqual(mesh.unit[0], 1, places=12)
            region = triangle_region.Region(mesh, mesh.at_points(np.ones(len(mesh.rest))))
            nodes = region.moving_nodes
            self.assertEqual(len(nodes), (count - 1)**2)
            load = region.masses()[:, None] * np.ones(3)
            # Area of the border's nodes is dropped.
            self.assertLess(load[:, 0].sum(), 1)
            even = {name: np.full(len(mesh.triangles), ISOTROPIC[name]) for name in "bcd"}
            nowhere = np.zeros_like(mesh.rest)
            steps = triangle_plate.Steps(nowhere, region, load, {
                **ISOTROPIC, **even, "poisson": 0.3, "dampingRatio": None}, FLAT)
            w, _, _ = steps(nowhere, nowhere, None, 1, 0.01)
            middle = nodes[nodes.index((count // 2) * (count + 2))]
            near = mesh.rest[middle, [0, 2]] - 0.5
            self.assertLess(np.abs(near).max(), 0.25 / count)
            errors.append(abs(w[middle, 1] / 0.00126532 - 1))
        self.assertLess(errors[1], 0.05)
        self.assertLess(errors[1], errors[0] / 2)


if __name__ == "__main__":
    unittest.main()
