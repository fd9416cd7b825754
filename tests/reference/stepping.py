"""Steps, cycles and damping ratios, whatever moves."""

import math

import numpy as np
import scipy.sparse
import scipy.sparse.linalg


def slowest_vibration(matrix, masses):
    """omega of K w = omega^2 M w, K sparse, rigid motions left out; 0 if there are no others, or no mass. What
    has no mass follows."""
    heavy = masses > 0
    if not heavy.any():
        return 0.0
    matrix = scipy.sparse.csc_matrix(matrix)
    across, light = matrix[heavy][:, ~heavy], matrix[~heavy][:, ~heavy]
    matrix, masses = matrix[heavy][:, heavy].toarray(), masses[heavy]
    if light.shape[0]:
        matrix -= across @ scipy.sparse.linalg.splu(light).solve(across.T.toarray())
    root = np.sqrt(masses)
    values = np.linalg.eigvalsh(matrix / np.outer(root, root))
    values = values[values > 1e-11 * values[-1]]
    return math.sqrt(values[0]) if len(values) else 0.0


def damping_of(ratio, density, omega):
    """eta = 2 zeta omega rho (SPEC 9)."""
    return 2 * ratio * omega * density


MOST_FRAMES = 2400  # to a cycle


def find_cycle(run, frames):
    """The states of a run at these frames, which lead back to the first one: going round from rest.
    `run.parts` names what a state is made of."""
    def state():
        return [getattr(run, part).copy() for part in run.parts]

    run.reset()
    for _ in range(MOST_FRAMES // len(frames)):
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


def with_integrator(integrator, density, advance, parts=2):
    """`advance`, which begins with the parts of a state, ends in (count, dt) and makes backward
    Euler steps, for an integrator: a step of Newmark's is one of half its length, reflected."""
    def reflected(*arguments):
        state, (*rest, count, dt) = arguments[:parts], arguments[parts:]
        for _ in range(count):
            half = advance(*state, *rest, 1, dt / 2)
            state = tuple(2 * middle - before for middle, before in zip(half, state))
        return state

    return reflected if integrator == "newmark" and np.any(density > 0) else advance
