#!/usr/bin/python3
"""Counts the turns of Newton's method in a plastic step.

The plate, push and frames are those of bench/plastic, with a tenth of the nodes flowing. Each turn
takes the consistent tangent and factors it anew, so that no method that goes from turn to turn by
linear solves needs fewer of them. Prints, for each frame in which nodes flow, their part and the
mean number of turns of its steps.

usage: bench/newton.py [SIDE [HARDENING]]   (61 and 0.1 by default; needs SciPy)
"""

import sys

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

SIDE = int(sys.argv[1]) if len(sys.argv) > 1 else 61
HARDENING = float(sys.argv[2]) if len(sys.argv) > 2 else 0.1
STEPS, FRAME, DENSITY = 5, 1 / 24, 1.0
FORM = np.array([[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]])  # b, gamma, d and the twist; nu = 1/2
TOLERANCE = 1e-9


def curvatures_along():
    """Second differences of a line of nodes whose ends are clamped, without the ends' own columns."""
    rows = sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], (SIDE, SIDE)).tolil()
    rows[0, 1] = rows[-1, -2] = 2
    return rows.tocsc()[:, 1:-1] * (SIDE - 1) ** 2


def slopes_along():
    """Central differences of a line of nodes, one-sided at the ends."""
    rows = sparse.diags([-0.5, 0.5], [-1, 1], (SIDE, SIDE)).tolil()
    rows[0, 0], rows[0, 1], rows[-1, -2], rows[-1, -1] = -1, 1, -1, 1
    return rows.tocsc()[:, 1:-1] * (SIDE - 1)


inner = sparse.eye(SIDE).tocsc()[:, 1:-1]
CURVATURES = [
    sparse.kron(inner, curvatures_along()).tocsr(),
    sparse.kron(curvatures_along(), inner).tocsr(),
    sparse.kron(slopes_along(), slopes_along()).tocsr(),
]
half = np.ones(SIDE)
half[[0, -1]] = 0.5
AREA = np.kron(half, half)
cells = sparse.diags([-1.0, 1.0], [0, 1], (SIDE - 1, SIDE)).tocsc()[:, 1:-1] * (SIDE - 1)
TWIST = sparse.kron(cells, cells).tocsr()  # the energy's is that of the cells
MASS = DENSITY / (FRAME / STEPS) ** 2


def stiffness(form):
    """Sum of area B^T form B; form: 3 x 3 numbers, or one for each node."""
    parts = [
        CURVATURES[k].T @ sparse.diags(AREA * form[k][l]) @ CURVATURES[l]
        for k in range(3)
        for l in range(3)
    ]
    return sum(parts).tocsc()


def forces(curvatures):
    moments = FORM @ curvatures * AREA
    return sum(CURVATURES[k].T @ moments[k] for k in range(3))


elastic_form = [[FORM[k, l] if (k, l) != (2, 2) else 0.0 for l in range(3)] for k in range(3)]
ELASTIC = (
    stiffness(elastic_form) + FORM[2, 2] * TWIST.T @ TWIST + MASS * sparse.eye((SIDE - 2) ** 2)
).tocsc()
ELASTIC_FACTOR = splu(ELASTIC)


def flow(w, plastic, yield_stress):
    """Where nodes flow, how the plastic curvatures grow (8j), and the tangent of its forces."""
    xi = np.stack([rows @ w for rows in CURVATURES]) - (1 + HARDENING) * plastic
    moments = FORM @ xi
    q = np.sqrt((xi * moments).sum(0))
    flows = q > yield_stress
    safe = np.where(flows, q, 1)
    whole = np.where(flows, (1 - yield_stress / safe) / (1 + HARDENING), 0)
    along = np.where(flows, yield_stress / safe**3 / (1 + HARDENING), 0)
    form = [[whole * FORM[k, l] + along * moments[k] * moments[l] for l in range(3)] for k in range(3)]
    return flows, whole * xi, form


def push():
    u, v = np.meshgrid(np.linspace(0, 1, SIDE), np.linspace(0, 1, SIDE))
    part = np.clip(1 - np.hypot(u - 0.42, v - 0.55) / 0.25, 0, 1)
    return (part**2 * (3 - 2 * part))[1:-1, 1:-1].ravel()


def run(yield_stress, frames):
    """The part of the nodes that flows in each frame, and the mean number of turns of its steps."""
    load, w = push(), np.zeros((SIDE - 2) ** 2)
    v, plastic = np.zeros_like(w), np.zeros((3, SIDE**2))
    dt = FRAME / STEPS
    parts, turns = [], []
    growth = np.zeros_like(plastic)
    for frame in range(1, frames + 1):
        flowed, taken = np.zeros(SIDE**2, bool), 0
        for _ in range(STEPS):
            known = frame / 24 * load + MASS * (w + dt * v) + forces(plastic)
            x = ELASTIC_FACTOR.solve(known + forces(growth))
            for _ in range(100):
                flows, growth, form = flow(x, plastic, yield_stress)
                if not flows.any():
                    break
                way = splu((ELASTIC - stiffness(form)).tocsc()).solve(
                    ELASTIC @ x - known - forces(growth)
                )
                x -= way
                taken += 1
                if np.abs(way).max() < TOLERANCE * np.abs(x).max():
                    break
            flows, growth, _ = flow(x, plastic, yield_stress)
            flowed |= flows
            plastic = plastic + growth
            v, w = (x - w) / dt, x
        parts.append(flowed.mean())
        turns.append(taken / STEPS)
    return parts, turns


low, high = 1e-4, 1.0
for _ in range(10):
    middle = np.sqrt(low * high)
    parts, turns = run(middle, 8)
    low, high = (middle, high) if np.mean(parts[4:]) > 0.1 else (low, middle)
parts, turns = run(np.sqrt(low * high), 8)
print(f"{SIDE} x {SIDE} nodes, H = {HARDENING:g}")
for part, count in zip(parts, turns):
    if part > 0:
        print(f"flow {part:6.1%}  turns {count:.1f}")
