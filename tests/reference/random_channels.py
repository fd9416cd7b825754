"""Random channels of scenes: constants and curves."""

import numpy as np

from random_mesh import text_of
from scene_text import Channel


class ChannelMaker:
    """Draws channels over the frames from `start` to `end` with the numbers of `rng`; `tags` are the
    features they use."""

    def chance(self, probability):
        return self.rng.random() < probability

    def pick(self, *options):
        return options[int(self.rng.integers(len(options)))]

    def animate(self, name, values, is_safe=False, is_exact=False):
        """Lines of an <animate> through `values`; `is_safe` keeps the curve between them as far as
        possible.

        `is_exact` keeps every sample representable: steps, or lines over power-of-two spans.
        """
        rng = self.rng
        values = [np.atleast_1d(np.asarray(value, dtype=float)) for value in values]
        self.tags.add(f"animated {name}")
        length = self.end - self.start
        spans = rng.uniform(0.4, 1.6, max(len(values) - 1, 0))
        total = length * rng.uniform(0.3, 1.3)
        times = [self.start + rng.uniform(-3, 0.3 * length)]
        for span in spans:
            times.append(times[-1] + max(1.0, total * span / spans.sum()))
        if is_exact:
            step = self.pick(4, 8)
            times = [round(times[0]) + step * k for k in range(len(values))]
        elif self.chance(0.75):
            times = [round(time) for time in times]
            for k in range(1, len(times)):
                times[k] = max(times[k], times[k - 1] + 1)
        else:
            self.tags.add("fractional keys")
        outside = {}
        for side in ("before", "after"):
            kind = self.pick("hold", "hold", "hold", "repeat", "mirror", "repeatOffset")
            if kind == "repeatOffset" and (is_safe or is_exact):
                kind = "mirror"
            if kind != "hold":
                if self.chance(0.3):
                    kind += f" {rng.integers(1, 4)}"
                    self.tags.add("loop count")
                outside[side] = kind
                self.tags.add(kind.split()[0])
        if any(kind.startswith("repeat") for kind in outside.values()) and len(values) > 2:
            is_closed = self.chance(0.5)
            if is_closed:
                values[-1] = values[0]
                self.tags.add("periodic seam")
        attributes = "".join(f' {side}="{kind}"' for side, kind in outside.items())
        default_tangent = self.pick(None, None, "flat", "linear")
        if default_tangent:
            attributes += f' tangent="{default_tangent}"'
        lines = [f'<animate attribute="{name}"{attributes}>']
        typical = max(1.0, (times[-1] - times[0]) / max(len(times) - 1, 1))
        swing = np.abs(np.array(values)).max(axis=0) / typical
        for time, value in zip(times, values):
            words = [f'frame="{time!r}"' if isinstance(time, int) else f'frame="{float(time)!r}"',
                     f'value="{text_of(value)}"']
            interpolation = self.pick("step", "linear") if is_exact else self.pick(
                None, None, None, "bezier", "linear", "step")
            if interpolation:
                words.append(f'interpolation="{interpolation}"')
                self.tags.add(f"interpolation {interpolation}")
            if not is_exact:
                words += self.tangent_words(swing, typical, is_safe)
            lines.append(f"  <key {' '.join(words)}/>")
        lines.append("</animate>")
        return lines

    def tangent_words(self, swing, typical, is_safe):
        words = []
        kinds = ["auto", "flat", "linear"] + ([] if is_safe else ["number", "number"])
        sides = self.pick((), (), ("tangent",), ("in",), ("out",), ("in", "out"))
        for side in sides:
            kind = self.pick(*kinds)
            self.tags.add(f"tangent {kind}")
            if kind == "number":
                kind = text_of(swing * self.rng.uniform(-1, 1, swing.shape))
            words.append(f'{side}="{kind}"')
        for side in ("inLength", "outLength"):
            if self.chance(0.15):
                length = typical * self.pick(0.1, 0.5, 1.2, 2.5) * self.rng.uniform(0.8, 1.2)
                words.append(f'{side}="{length!r}"')
                self.tags.add("lengths")
        return words

    def switch(self):
        """An animated `enabled`, with both values."""
        self.tags.add("switched force")
        first = self.pick(True, False)
        times = sorted(set(int(t) for t in self.rng.integers(self.start - 1, self.end,
                                                              self.pick(2, 3, 5))))
        after = ' after="repeat"' if self.chance(0.3) and len(times) > 1 else ""
        lines = [f'<animate attribute="enabled"{after}>']
        for k, time in enumerate(times):
            value = "true" if (k % 2 == 0) == first else "false"
            lines.append(f'  <key frame="{time}" value="{value}"/>')
        return lines + ["</animate>"]

    def channel(self, name, draw, probability, is_safe=True):
        """A channel drawn by `draw()`, animated with some probability."""
        if not self.chance(probability):
            return Channel(name, text_of(draw()))
        return Channel(name, animate=self.animate(
            name, [draw() for _ in range(self.pick(1, 2, 3, 4))], is_safe))
