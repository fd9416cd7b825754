"""How near a run came to decisions that rounding could change: whether another implementation may be
expected to agree."""

import math
from fractions import Fraction

import numpy as np

from forces import distances, has_direction


def is_exact_distance(force, frame, point, radius):
    """Whether delta - radius is decided in exact arithmetic: every intermediate is a double."""
    def is_double(value):
        return Fraction(float(value)) == value

    def exact(vector):
        return [Fraction(float(x)) for x in vector]

    if force.kind in ("uniform", "inertia"):
        return True  # the distance is 0
    if force.kind == "vortex":
        return False
    p, used = exact(point), []
    if force.kind in ("point", "radial", "noise", "pressure"):
        nearest = exact(force.sample("center", frame))
    else:
        start, end = exact(force.sample("from", frame)), exact(force.sample("to", frame))
        along = [q - r for q, r in zip(end, start)]
        to_point = [q - r for q, r in zip(p, start)]
        products = [q * r for q, r in zip(to_point, along)] + [q * q for q in along]
        numerator, squared_length = sum(products[:3]), sum(products[3:])
        used += along + to_point + products + [numerator, squared_length]
        t = min(Fraction(1), max(Fraction(0), numerator / squared_length)) if squared_length else 0
        moved = [t * q for q in along]
        nearest = [q + r for q, r in zip(start, moved)]
        used += [t] + moved + nearest
    offset = [q - r for q, r in zip(p, nearest)]
    squares = [q * q for q in offset]
    used += offset + squares + [sum(squares[:2]), sum(squares[1:]), squares[0] + squares[2],
                                sum(squares)]
    root = Fraction(math.sqrt(float(sum(squares))))
    return all(is_double(x) for x in used) and (root * root == sum(squares) or root != radius)


class Diagnostics:
    """The features that a scene used, and how near it came to decisions that rounding could
    change."""

    def __init__(self):
        self.solves = []  # (frame, surface, (i0, i1, j0, j1))
        self.skips = []  # (frame, surface, reason)
        self.exact_ties = 0
        self.tie_margin = math.inf  # smallest |delta - radius| / radius that is not an exact tie
        self.direction_margin = math.inf  # smallest non-exact delta where delta gives a direction
        self.time_margin = math.inf  # smallest |t - T| / T of an overshoot step
        self.settle_margin = math.inf  # smallest |motion - 1e-6 D| / (1e-6 D) of `recover`
        self.cut_margin = math.inf  # smallest distance of a cut of triangles from where it snaps
        self.touch_margin = math.inf  # smallest length, of the diagonal, by which a node does or does not touch
        self.row_margin = math.inf  # smallest distance of normals from where rows are left out
        self.touches = 0  # steps in which something touches
        self.recovering = 0  # nodes counted as selected, over all frames
        self.stresses = {}  # the largest of each surface that may yield
        self.flows = 0  # solves in which something flows
        self.unions = 0  # solves of regions that are not a box

    def note_distances(self, force, frame, points, is_untouched, radii):
        """`is_untouched`: nodes at their rest position under an identity transform."""
        delta = distances(force, frame, points)
        for radius in radii:
            close = np.abs(delta - radius) <= 1e-7 * max(radius, 1e-12)
            for i, j in zip(*np.nonzero(close)):
                if is_untouched[i, j] and is_exact_distance(force, frame, points[i, j], radius):
                    self.exact_ties += delta[i, j] == radius
                    close[i, j] = False
                    delta[i, j] = math.nan
            margin = np.abs(delta - radius) / max(radius, 1e-12)
            if not np.isnan(margin).all():
                self.tie_margin = min(self.tie_margin, np.nanmin(margin))
            delta = distances(force, frame, points)
        if not has_direction(force):
            near = delta < 1e-3
            for i, j in zip(*np.nonzero(near)):
                is_exact = is_untouched[i, j] and is_exact_distance(force, frame, points[i, j], 0.0)
                if not (is_exact and delta[i, j] == 0):
                    self.direction_margin = min(self.direction_margin, delta[i, j])

    def note_flow(self, surface, flows, has_flowed):
        """`flows`: those of a solve."""
        for flow in flows:
            self.stresses[surface] = max(self.stresses.get(surface, 0.0), flow.largest)
        self.flows += bool(has_flowed)

    def note_touch(self, margin):
        self.touch_margin = min(self.touch_margin, abs(margin))

    def note_rows(self, margin):
        self.row_margin = min(self.row_margin, margin)

    def note_steps(self, frame_length, dt):
        ratio = frame_length / dt
        self.time_margin = min(self.time_margin, abs(ratio - round(ratio)) / ratio)
