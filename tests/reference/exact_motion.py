"""The exact integrator of the reference engine (SPEC 9): every mode of vibration by its formula."""

import numpy as np
import scipy.linalg
import scipy.sparse.linalg


def without_massless(stiffness, force, count):
    """K and f (#rows x 6) of the first `count` unknowns, which have the mass; the others follow."""
    moving, other = np.s_[:count], np.s_[count:]
    if stiffness.shape[0] == count:
        return stiffness.toarray(), force
    factor = scipy.sparse.linalg.splu(stiffness[other, other].tocsc())
    across = stiffness[moving, other]
    reduced = stiffness[moving, moving].toarray() - across @ factor.solve(
        stiffness[other, moving].toarray())
    return (reduced + reduced.T) / 2, force[moving] - across @ factor.solve(force[other])


def pulses(decay, square, time):
    """c and s of q'' + 2 a q' + k q = 0 with q = c q0 + s (v0 + a q0), where a^2 - k = `square`."""
    root = np.sqrt(np.abs(square))
    swings = square < 0
    # With exponents in one sum none overflows.
    slow = np.exp(-decay * time + root * time * ~swings)
    fast = np.exp(-decay * time - root * time * ~swings)
    fade = np.exp(-decay * time)
    even = np.where(swings, fade * np.cos(root * time), (slow + fast) / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        odd = np.where(swings, fade * np.sin(root * time) / root, (slow - fast) / (2 * root))
    return even, np.where(root * time < 1e-9, fade * time, odd)


def uneven_motion(stiffness, masses, damping, first, last, w, velocity, time):
    """M (w'' + damping w') + K w = f with a damping for each row, by the exponential of the whole
    system and its load, in modes."""
    values, modes = scipy.linalg.eigh(stiffness, np.diag(masses))
    count = len(masses)
    omega = np.sqrt(np.maximum(values, 0))
    omega[omega < 1e-7 * omega[-1]] = 0
    scale = np.maximum(omega, 1 / time)  # makes the system nearly skew
    forces = modes.T @ np.hstack([first, last - first])
    size = np.abs(forces).max() * time + 1e-300
    system = np.zeros((2 * count + 6, 2 * count + 6))
    system[:count, count:2 * count] = np.diag(scale)
    system[count:2 * count, :count] = -np.diag(omega**2 / scale)
    system[count:2 * count, count:2 * count] = -modes.T @ ((damping * masses)[:, None] * modes)
    system[count:2 * count, 2 * count:] = forces / size
    system[2 * count + 3:, 2 * count:2 * count + 3] = np.eye(3) / time
    start = np.concatenate([scale[:, None] * (modes.T @ (masses[:, None] * w)),
                            modes.T @ (masses[:, None] * velocity), size * np.eye(3),
                            np.zeros((3, 3))])
    end = scipy.linalg.expm(system * time) @ start
    return modes @ (end[:count] / scale[:, None]), modes @ end[count:2 * count]


def exact_motion(stiffness, masses, material, forces, w, velocity, time):
    """Advances w and velocity (#masses x 3) of M (rho w'' + eta w') + K w = f by `time`; f goes
    evenly from the first of `forces` (#rows x 3) to the second. Density and damping are numbers, or
    those of each mass."""
    count = len(masses)
    density, damping = (np.broadcast_to(material[name], count).astype(float)
                        for name in ("density", "damping"))
    matrix, both = without_massless(stiffness, np.hstack(forces), count)
    if not density.any() and not damping.any():
        end = np.linalg.solve(matrix, both[:, 3:])
        return end, (end - w) / time
    if density.any():
        assert (density > 0).all()
        masses, damping, density = masses * density, damping / density, 1.0
        if np.ptp(damping) > 1e-13 * damping.max():
            return uneven_motion(matrix, masses, damping, both[:, :3], both[:, 3:], w, velocity,
                                 time)
        damping = damping[0]
    else:
        assert (damping > 0).all()
        masses, density, damping = masses * damping, 0.0, 1.0
    values, modes = scipy.linalg.eigh(matrix, np.diag(masses))
    values = np.maximum(values, 0)[:, None]
    q, speed = (modes.T @ (masses[:, None] * x) for x in (w, velocity))
    first, growth = modes.T @ both[:, :3], modes.T @ (both[:, 3:] - both[:, :3]) / time
    # The quasi-static motion q = (f - eta f'/k)/k is a solution, but of a singular K, or one that
    # almost is, it is none to start from.
    is_slow = values[:, 0] * time**(2 if density else 1) < 1e-3
    stiff = np.where(is_slow[:, None], 1, values)
    at, drift = (first - damping * growth / stiff) / stiff, growth / stiff
    if density == 0:
        fade = np.exp(-values / damping * time)
        end = at + drift * time + fade * (q - at)
        end_speed = drift - values / damping * fade * (q - at)
    else:
        decay, square = damping / (2 * density), (damping / (2 * density))**2 - values / density
        even, odd = pulses(decay, square, time)
        u, rate = q - at, speed - drift
        end = at + drift * time + even * u + odd * (rate + decay * u)
        end_speed = drift + even * rate - odd * (decay * rate + values / density * u)
    # Slow ones by a small exponential: of (q, q', f, f'), or of (q, f, f').
    for k in np.nonzero(is_slow)[0]:
        if density > 0:
            system = np.array([[0, 1, 0, 0], [-values[k, 0], -damping, 1, 0], [0, 0, 0, 1],
                               [0, 0, 0, 0]])
            moved = scipy.linalg.expm(system * time) @ [q[k], speed[k], first[k], growth[k]]
            end[k], end_speed[k] = moved[0], moved[1]
        else:
            system = np.array([[-values[k, 0], 1, 0], [0, 0, 1], [0, 0, 0]])
            moved = scipy.linalg.expm(system * time) @ [q[k], first[k], growth[k]]
            end[k], end_speed[k] = moved[0], moved[1] - values[k, 0] * moved[0]
    return modes @ end, modes @ end_speed
