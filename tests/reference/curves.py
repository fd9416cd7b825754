"""Keyed channels, evaluated literally and slowly (docs/timeline.md; docs/scene-format.md, "Animation").

Covered: step, stepNext, linear and bezier segments; auto, spline, flat, linear, plateau and numeric
tangents with lengths; hold, linear, linearOuter, slope, repeat, repeatOffset and mirror outside the
keys, with counts; `overshoot="limit"`; periodic seams. Anything else fails an assertion.
"""

import math

import numpy as np

THIRD = 1.0 / 3.0


class Constant:
    """A channel that is given as an attribute: the same value at every frame."""

    def __init__(self, value):
        self.value = np.atleast_1d(np.asarray(value, dtype=float))

    def __call__(self, frame):
        return self.value


class Key:
    """One key: `value` has one number per component, a tangent is a kind or an array of slopes."""

    def __init__(self, time, value, interpolation="bezier", tangent_in="auto", tangent_out="auto",
                 length_in=None, length_out=None):
        self.time = float(time)
        self.value = np.atleast_1d(np.asarray(value, dtype=float))
        self.interpolation = interpolation
        self.tangent_in = tangent_in
        self.tangent_out = tangent_out
        self.length_in = length_in
        self.length_out = length_out


def time_is_monotone(a, b):
    """Whether a Bézier segment with handle fractions a (out) and b (in) is a function of time."""
    if a <= 1 and b <= 1:
        return True
    inside_ellipse = a * a + b * b + a * b - 2 * a - 2 * b + 1 <= 0
    return inside_ellipse and max(a, b) <= 4.0 / 3.0


def limit_lengths(a, b):
    """`overshoot="limit"`: the longest handles of the same ratio that do not turn time back."""
    if time_is_monotone(a, b):
        return a, b
    if b == 0:
        return 1.0, 0.0
    r = a / b
    b_limited = (math.sqrt(r) + r + 1) / (r * r + r + 1)
    return r * b_limited, b_limited


def auto_weight(f):
    """The weight g of the next secant in an `auto` tangent, f = (t_k - t_p)/(t_n - t_p)."""
    return 0.5 + (f - 0.5) * (1.5 - 2 * (f - 0.5) ** 2)


def cap(slope, s_p, s_n):
    """Limits a slope to three times the smaller secant."""
    limit = 3 * min(abs(s_p), abs(s_n))
    return max(-limit, min(limit, slope))


def de_casteljau(points, u):
    """A Bézier curve at u; `points` are numbers or arrays."""
    points = list(points)
    while len(points) > 1:
        points = [(1 - u) * p + u * q for p, q in zip(points, points[1:])]
    return points[0]


def parameter_at(x, target):
    """u in [0,1] with x(u) = target for control abscissae x that do not decrease: bisection."""
    low, high = 0.0, 1.0
    while True:
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            return middle
        if de_casteljau(x, middle) < target:
            low = middle
        else:
            high = middle


class Segment:
    """The curve between two keys (docs/timeline.md, "Segments")."""

    def __init__(self, left, right, slope_out, slope_in):
        self.left, self.right = left, right
        self.slope_out, self.slope_in = slope_out, slope_in
        self.span = right.time - left.time
        length_out = self.span / 3 if left.length_out is None else left.length_out
        length_in = self.span / 3 if right.length_in is None else right.length_in
        assert length_out >= 0 and length_in >= 0
        a = THIRD if left.length_out is None else length_out / self.span
        b = THIRD if right.length_in is None else length_in / self.span
        self.a, self.b = limit_lengths(a, b)
        self.sensitivity = 0.0  # largest change of a value so far, for a last-bit change of time

    def __call__(self, time):
        """The value at left.time < time < right.time."""
        kind = self.left.interpolation
        v0, v1 = self.left.value, self.right.value
        if kind == "step":
            return v0
        if kind == "stepNext":
            return v1
        s = (time - self.left.time) / self.span
        if kind == "linear":
            return v0 + (v1 - v0) * s
        assert kind == "bezier", kind
        y = (v0, v0 + self.slope_out * (self.a * self.span),
             v1 - self.slope_in * (self.b * self.span), v1)
        if abs(self.a - THIRD) <= 1e-15 and abs(self.b - THIRD) <= 1e-15:
            return de_casteljau(y, s)  # time is linear in u: a cubic in time
        x = (0.0, self.a, 1 - self.b, 1.0)
        nearby = [de_casteljau(y, parameter_at(x, s + ds)) for ds in (-4e-16, 4e-16)]
        self.sensitivity = max(self.sensitivity, float(np.abs(nearby[1] - nearby[0]).max()))
        return de_casteljau(y, parameter_at(x, s))

    def end_slope(self, at_right):
        """One-sided derivative at an end; only for handles of non-zero length."""
        kind = self.left.interpolation
        if kind in ("step", "stepNext"):
            return np.zeros_like(self.left.value)
        if kind == "linear":
            return (self.right.value - self.left.value) / self.span
        assert (self.b if at_right else self.a) > 0, "derivative at a handle of length 0"
        return self.slope_in if at_right else self.slope_out


class Curve:
    """An animated channel: keys, tangents and what happens outside the keys."""

    def __init__(self, keys, before=("hold", None), after=("hold", None)):
        assert keys and all(p.time < q.time for p, q in zip(keys, keys[1:]))
        self.keys = keys
        self.before, self.after = before, after
        self.first, self.last = keys[0], keys[-1]
        self.span = self.last.time - self.first.time
        self.segments = [
            Segment(left, right, self._tangent(k, "out"), self._tangent(k + 1, "in"))
            for k, (left, right) in enumerate(zip(keys, keys[1:]))]

    # Tangents

    def _secant(self, k):
        left, right = self.keys[k], self.keys[k + 1]
        return (right.value - left.value) / (right.time - left.time)

    def _is_periodic(self, component):
        """Whether both ends take their secants across the seam (docs/timeline.md)."""
        kinds = (self.before[0], self.after[0])
        closes = self.first.value[component] == self.last.value[component]
        return "repeatOffset" in kinds or ("repeat" in kinds and closes)

    def _tangent(self, k, side):
        """The slope on one side of key k, per component."""
        key = self.keys[k]
        kind = key.tangent_in if side == "in" else key.tangent_out
        if not isinstance(kind, str):
            return kind
        count = len(self.keys)
        if count == 1:
            return np.zeros_like(key.value)
        slopes = np.zeros_like(key.value)
        for c in range(len(slopes)):
            s_p = self._secant(k - 1)[c] if k > 0 else None
            s_n = self._secant(k)[c] if k < count - 1 else None
            before = key.time - self.keys[k - 1].time if k > 0 else None
            after = self.keys[k + 1].time - key.time if k < count - 1 else None
            if self._is_periodic(c) and k in (0, count - 1):
                s_p, s_n = self._secant(count - 2)[c], self._secant(0)[c]
                before = self.keys[-1].time - self.keys[-2].time
                after = self.keys[1].time - self.keys[0].time
            slopes[c] = self._kind_slope(kind, side, k, s_p, s_n, before, after)
        return slopes

    def _kind_slope(self, kind, side, k, s_p, s_n, before, after):
        """docs/timeline.md, "Tangents", for one component; a missing neighbour is None."""
        if kind == "flat":
            return 0.0
        if kind == "linear":
            if side == "in":
                return s_p if s_p is not None else s_n
            return s_n if s_n is not None else s_p
        is_open_end = s_p is None or s_n is None
        if kind == "spline":
            if is_open_end:
                return s_n if s_p is None else s_p
            return (s_p * before + s_n * after) / (before + after)
        assert kind in ("auto", "plateau"), kind
        if is_open_end:
            outside = self.before[0] if k == 0 else self.after[0]
            if outside in ("linear", "linearOuter"):
                return s_n if s_p is None else s_p
            return 0.0
        if s_p * s_n <= 0:
            return 0.0  # a local extremum or a plateau
        if kind == "plateau":
            return cap((s_p * before + s_n * after) / (before + after), s_p, s_n)
        g = auto_weight(before / (before + after))
        return cap((1 - g) * s_p + g * s_n, s_p, s_n)

    # Evaluation

    def __call__(self, frame):
        time = float(frame)
        if time > self.last.time:
            return self._outside(time, *self.after, True)
        if time < self.first.time:
            return self._outside(time, *self.before, False)
        return self._inside(time)

    def _inside(self, time):
        for key in self.keys:
            if time == key.time:
                return key.value
        for segment in self.segments:
            if segment.left.time < time < segment.right.time:
                return segment(time)
        raise AssertionError("time outside the keys")

    def _outside(self, time, kind, argument, is_after):
        """docs/timeline.md, "Outside the keys"; `argument` is a slope, or the number of copies or None."""
        end = self.last if is_after else self.first
        distance = time - self.last.time if is_after else self.first.time - time
        direction = 1 if is_after else -1
        is_loop = kind in ("repeat", "repeatOffset", "mirror")
        if kind == "hold" or (len(self.keys) == 1 and (is_loop or kind == "linear")):
            return end.value
        if kind == "slope":
            return end.value + argument * (time - end.time)
        if kind == "linearOuter":
            last = len(self.keys) - 1
            slope = self._tangent(last, "out") if is_after else self._tangent(0, "in")
            return end.value + slope * (time - end.time)
        if kind == "linear":
            slope = self.segments[-1 if is_after else 0].end_slope(is_after)
            return end.value + slope * (time - end.time)
        assert is_loop, kind
        remainder = math.fmod(distance, self.span)
        copy = round((distance - remainder) / self.span)  # copies that lie wholly between
        if remainder == 0:
            remainder = self.span  # a joint belongs to the copy nearer to the keys
        else:
            copy += 1
        if argument is not None and copy > argument:
            copy, remainder = argument, self.span
        is_reversed = kind == "mirror" and copy % 2 == 1
        # `remainder` runs away from the keys; after them an unreversed copy starts at the first.
        from_first = is_after != is_reversed
        inner = self.first.time + remainder if from_first else self.last.time - remainder
        if remainder == self.span:
            value = self.last.value if from_first else self.first.value
        else:
            value = self._inside(inner)
        if kind == "repeatOffset":
            value = value + direction * copy * (self.last.value - self.first.value)
        return value
