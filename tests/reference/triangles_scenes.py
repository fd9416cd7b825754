#!/usr/bin/env python3
"""Generates random, well-posed scenes of surfaces of triangles that exercise SPEC 8.

    python3 triangles_scenes.py --seed N --count K -o DIR

writes DIR/triangles-N-000.xml ... with their meshes. The kinds of mesh and of UVs, the borders, the
axes and the units take turns; all else is drawn.
"""

import math
import os
import sys

import numpy as np

import scene_search
from random_mesh import text_of
from random_materials import MIXED_SHARE, PEAK
from random_scenes import SceneMaker
from scene_text import Channel, Writer
from random_triangle_mesh import KINDS, UVS, RandomSurface

ODDITIES = ((), ("seams", "order"), ("flat",), ("faces", "order"), ("weld",), ("turns",))
BORDERS = ("clamped", "free", "pinned")
AXES = (None, None, "drawn", "1 1 1")
UNITS = (None, "two", "one")


class TriangleSceneMaker(SceneMaker):
    """Draws one random scene; `name` ends with its number, by which the kinds take turns."""

    has_edges = False

    def __init__(self, rng, folder, name):
        super().__init__(rng, folder, name)
        self.number = int(name[-3:])
        self.is_lattice = False
        self.end = self.start + int(rng.integers(5, 10))

    def place(self, world, is_inside=True):
        rng = self.rng
        point = world[int(rng.integers(len(world)))]
        if not is_inside:
            self.tags.add("off the surface")
            middle = world.mean(axis=0)
            return middle + 2.5 * (point - middle)
        return point + 0.02 * self.size_of(world) * rng.uniform(-1, 1, 3)

    def spacing_of(self, world):
        return self.size_of(world) / 8

    def surface_head(self, index):
        rng, out, turn = self.rng, Writer(), self.number + 3 * index
        slow = turn + turn // len(KINDS)  # goes through all with each kind
        out.add(1, f'<surface name="mesh{index}">')
        border = BORDERS[slow % len(BORDERS)]
        axis = AXES[turn % len(AXES)]
        unit = UNITS[(slow // 2) % len(UNITS)]
        kind = KINDS[turn % len(KINDS)]
        mesh = RandomSurface(rng, kind, UVS[(slow // 3) % len(UVS)],
                             ODDITIES[slow % len(ODDITIES)], self.tags)
        file = f"{self.name}-mesh{index}.obj"
        self.meshes[file] = mesh.text
        with open(os.path.join(self.folder, file), "w", encoding="utf-8") as stream:
            stream.write(mesh.text)
        attributes = [("file", file), ("uv", "surface"), ("border", border)]
        self.tags.add(f"border {border}")
        if axis is not None:
            attributes.append(("axis", axis if axis != "drawn" else text_of(rng.uniform(-2, 2, 3))))
            self.tags.add(f"axis {axis}")
        if unit is not None:
            size = mesh.size * rng.uniform(0.5, 1.5, 2 if unit == "two" else 1)
            attributes.append(("unit", text_of(size)))
            self.tags.add(f"unit {unit}")
        if mesh.weld is not None:
            attributes.append(("weld", text_of(mesh.weld)))
        out.add(2, "<mesh " + " ".join(f'{name}="{value}"' for name, value in attributes) + "/>")
        if self.chance(0.5):
            self.transform(out)
        solver = []
        for choice, values, probability in (
                ("stepping", ("overshoot",), 0.2), ("integrator", ("newmark", "exact", "exact"), 0.6), ("measure", ("rest", "current"), 0.7),
                ("release", ("recover",), 0.35), ("combine", ("islands", "union"), 0.2)):
            if self.chance(probability):
                value = self.pick(*values)
                solver.append((choice, value))
                self.tags.add(f"{choice} {value}")
        if self.chance(0.25):
            solver = [choice for choice in solver if choice[0] in ("stepping", "integrator", "measure")]
            solver.append(("region", "all"))
            self.tags.add("region all")
        if self.chance(0.2):
            solver.append(("startFrame", self.start + 2))
        return out.lines, solver

    def stiffness_of(self, surface):
        """Material channels, and the stiffness against a load in a region of typical size."""
        rng, is_free = self.rng, surface.grid.border == "free"
        extent = self.size_of(surface.grid.rest) * rng.uniform(0.5, 0.9)
        length_u, length_v = extent / surface.grid.unit
        b, c, d = 1.0, 2.0, 1.0
        channels = []
        if self.chance(0.7):
            b, d = np.exp(rng.uniform(-1, 1, 2))
            c = math.sqrt(b * d) * rng.uniform(-1.6, 3.0)
            if is_free:
                poisson = rng.uniform(-0.8, 0.8)
                c = math.sqrt(b * d) * (2 * poisson + rng.uniform(0.3, 2))
                channels.append(Channel("poisson", text_of(poisson)))
                self.tags.add("poisson")
            if c < 0:
                self.tags.add("negative c")
            is_animated = 0.0 if is_free else 0.2
            channels += [self.channel("b", lambda: b * rng.uniform(0.95, 1.2), is_animated),
                         self.channel("d", lambda: d * rng.uniform(0.95, 1.2), is_animated),
                         self.channel("c", lambda: c * rng.uniform(0.95, 1.05), is_animated)]
            if is_free:
                channels[-3:] = [Channel("b", text_of(b)), Channel("d", text_of(d)),
                                 Channel("c", text_of(c))]
        # Of c to 2 sqrt(b d), whatever the factors above are.
        self.least_ratio = c * (0.95 / 1.2 if c > 0 else 1.05 / 0.95) / (2 * math.sqrt(b * d))
        stiffness = (b / length_u**4 + MIXED_SHARE * max(c, 0) / (length_u * length_v)**2 +
                     d / length_v**4) / (PEAK * (2 + 2 * MIXED_SHARE))
        return channels, stiffness, length_u, length_v


def main():
    scene_search.main(TriangleSceneMaker, "triangles")


if __name__ == "__main__":
    sys.exit(main())
