#!/usr/bin/env python3
"""Generates random, well-posed scenes of grids that meet colliders (docs/model.md, "Contact").

    python3 contact_scenes.py --seed N --count K -o DIR

writes DIR/contact-N-000.xml ... with their meshes.
"""

import sys

import scene_search
from random_colliders import ColliderMaker
from random_scenes import SceneMaker
from scene_text import Writer


class ContactSceneMaker(ColliderMaker, SceneMaker):
    """Draws one random scene with colliders, whose surfaces are small."""

    yield_share = 0.4
    least_hardening = 0.1  # the reference ends soon

    def __init__(self, rng, folder, name):
        super().__init__(rng, folder, name)
        self.is_lattice = False
        self.end = self.start + int(rng.integers(4, 9))

    def surface_head(self, index):
        rng, out = self.rng, Writer()
        out.add(1, f'<surface name="sheet{index}">')
        columns, rows = (int(n) for n in rng.integers(4, 11, 2))
        size = 10 ** rng.uniform(-0.3, 1.3)
        width, depth = size * rng.uniform(0.7, 1.4, 2)
        out.add(2, f'<grid columns="{columns}" rows="{rows}" width="{width!r}" depth="{depth!r}"/>')
        if self.chance(0.5):
            self.transform(out)
        solver = []
        for choice, values, probability in (
                ("stepping", ("overshoot",), 0.2), ("integrator", ("newmark",), 0.4),
                ("combine", ("islands", "union"), 0.3), ("release", ("recover",), 0.15)):
            if self.chance(probability):
                value = self.pick(*values)
                solver.append((choice, value))
                self.tags.add(f"{choice} {value}")
        if self.chance(0.6):
            solver = [choice for choice in solver if choice[0] in ("stepping", "integrator")]
            solver.append(("region", "all"))
            self.tags.add("region all")
        return out.lines, solver

    def colliders(self, worlds, names):
        lines = []
        for k in range(self.pick(1, 1, 2, 2, 3)):
            aim = int(self.rng.integers(len(worlds)))
            targets = None
            if len(names) > 1 and self.chance(0.5):
                targets = [name for j, name in enumerate(names) if j == aim or self.chance(0.3)]
            lines += self.collider(k, worlds[aim], targets)
        return lines


def main():
    return scene_search.main(ContactSceneMaker, "contact")


if __name__ == "__main__":
    sys.exit(main())
