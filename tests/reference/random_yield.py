"""Random surfaces that yield.

Their yield stresses are shares of the largest one of the same scene without yield, which is known
after a run: until then the text holds `@SURFACE:SHARE@`.
"""

import re
import zlib

import numpy as np

from random_channels import ChannelMaker
from scene_text import Channel

MARK = re.compile(r"@(\w+):([^@]+)@")


def with_yields(text, stresses):
    """The text with shares of the largest stress of each surface; one that is not among `stresses`
    does not yield."""
    return MARK.sub(lambda found: repr(stresses.get(found[1], 1e30) * float(found[2])), text)


def has_yields(text):
    return MARK.search(text) is not None


def may_yield(solver):
    return (solver.get("integrator") != "exact" and solver.get("reference") != "none" and
            solver.get("combine") != "union" and solver.get("release") != "recover" and
            "loop" not in solver)


class YieldMaker(ChannelMaker):
    """Draws `yield` and `hardening`."""

    yield_share = 0.3  # of the surfaces that may
    least_hardening = 0.0

    def yields(self, solver, surface, is_static):
        """Channels for a part of the surfaces that may yield; draws nothing from the scene's
        numbers for the others."""
        rng = np.random.default_rng(zlib.crc32(f"{self.name} {surface.name} yield".encode()))
        if rng.random() > self.yield_share or not may_yield(dict(solver)):
            return []
        self.tags.add("yield")
        share = 10 ** rng.uniform(-1.0, -0.1)
        channel = self.channel("yield", lambda: share * self.rng.uniform(0.6, 1.4), 0.25)
        mark = f"@{surface.name}:{{}}@".format
        if channel.animate is None:
            channel.constant = mark(channel.constant)
        else:
            channel.animate = [re.sub('value="([^"]*)"', lambda found: f'value="{mark(found[1])}"',
                                      line) for line in channel.animate]
        hardening = self.channel("hardening", lambda: 10 ** self.rng.uniform(
            np.log10(max(0.01, self.least_hardening)), 0.3), 0.25)
        if rng.random() < 0.15 and not is_static and self.least_hardening == 0:
            hardening = Channel("hardening", "0")
            self.tags.add("no hardening")
        return [channel] + ([hardening] if rng.random() < 0.7 else [])
