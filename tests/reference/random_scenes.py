#!/usr/bin/env python3
"""Generates random, well-posed scenes that exercise every rule of SPEC 1-7.

    python3 random_scenes.py --seed N --count K -o DIR

writes DIR/random-N-000.xml ... with their meshes. Scene k of a seed does not depend on the count.
A scene is kept when it is well posed (well_posed.py) and its peak displacement is 0.03 to 1 of the
sheet's size.
"""

import os
import sys
import zlib

import numpy as np

import scene_search
from forces import Transform
from random_forces import ForceMaker
from random_materials import MaterialMaker
from random_mesh import Mesh
from scene import Scene
from scene_text import Writer, write_element


class SceneMaker(ForceMaker, MaterialMaker):
    """Draws one random scene; `tags` are the features it uses."""

    def __init__(self, rng, folder, name):
        self.rng, self.folder, self.name = rng, folder, name
        self.tags = set()
        self.is_lattice = rng.random() < 0.25
        self.fps_text = str(rng.choice(["24", "24", "25", "30", "12.5", "24000/1001",
                                        "30000/1001"]))
        if "/" in self.fps_text or "." in self.fps_text:
            self.tags.add("fractional fps")
        numerator, _, denominator = self.fps_text.partition("/")
        self.fps = float(numerator) / float(denominator or 1)
        self.start = int(rng.integers(-5, 11))
        self.end = self.start + int(rng.integers(10, 31))
        self.caches = {}  # samples, by file
        self.meshes = {}
        self.pictures = {}  # of maps, as bytes
        # Their own numbers, so that maps and goals change no other choice.
        self.map_rng = np.random.default_rng(zlib.crc32(name.encode()))
        self.goal_rng = np.random.default_rng(zlib.crc32(name.encode()) + 1)
        self.surfaces = []  # (header line list before the material, choices)
        self.magnitude_factor = 1.0

    def surface_head(self, index):
        """Writes the geometry and the transform of a surface, and its solver choices."""
        rng, out = self.rng, Writer()
        name = f"sheet{index}"
        is_disabled = index > 0 and self.chance(0.15)
        if is_disabled:
            self.tags.add("disabled surface")
        enabled = ' enabled="false"' if is_disabled else ""
        out.add(1, f'<surface name="{name}"{enabled}>')
        if self.is_lattice:
            width, depth = (int(n) for n in rng.integers(8, 25, 2))
            faces = self.pick("", ' faces="triangles"', ' faces="quads"')
            out.add(2, f'<grid columns="{width + 1}" rows="{depth + 1}" width="{width}" '
                       f'depth="{depth}"{faces}/>')
            self.tags.add("integer lattice")
        elif self.chance(0.55):
            columns, rows = (int(n) for n in rng.integers(4, 26, 2))
            size = 10 ** rng.uniform(-0.3, 1.3)
            width, depth = size * rng.uniform(0.7, 1.4, 2)
            faces = self.pick("", ' faces="triangles"', ' faces="quads"')
            if self.chance(0.1):
                self.tags.add("default grid size")
                size, spare = 1.0, ""
            else:
                spare = f' width="{width!r}" depth="{depth!r}"'
            out.add(2, f'<grid columns="{columns}" rows="{rows}"{spare}{faces}/>')
            self.tags.update(["grid", "hu != hv"] if columns != rows else ["grid"])
        else:
            mesh = Mesh(rng, self.tags)
            file = f"{self.name}-{name}.obj"
            self.meshes[file] = mesh.text
            with open(os.path.join(self.folder, file), "w", encoding="utf-8") as stream:
                stream.write(mesh.text)
            out.add(2, f'<mesh file="{file}"/>')
        if not self.is_lattice and self.chance(0.55):
            self.transform(out)
        solver = []
        if self.chance(0.4):
            frame = self.start + self.pick(-3, 0, 2, 5)
            solver.append(("startFrame", frame))
            self.tags.add("startFrame before" if frame < self.start else "startFrame after")
        for choice, values, probability in (
                ("stepping", ("overshoot", "overshoot", "exact"), 0.4),
                ("integrator", ("newmark", "exact", "exact"), 0.6),
                ("reference", ("none", "none", "rest"), 0.3),
                ("measure", ("rest", "rest", "current"), 0.4), ("combine", ("box", "islands", "union"), 0.4),
                ("release", ("freeze", "recover", "recover"), 0.2)):
            if self.chance(probability):
                value = self.pick(*values)
                solver.append((choice, value))
                self.tags.add(f"{choice} {value}")
        if self.chance(0.25):
            solver = [choice for choice in solver if choice[0] in ("startFrame", "stepping", "integrator", "measure")]
            solver.append(("region", "all"))
            self.tags.add("region all")
        return out.lines, solver

    def transform(self, out):
        """Writes a transform, constant or moving."""
        rng = self.rng
        order = self.pick("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
        self.tags.update(["transform", f"rotateOrder {order}"])
        moves = 0.35
        travel = 10 ** rng.uniform(-1, 0.5)
        spin = self.pick(20.0, 90.0, 180.0)
        channels = [
            self.channel("translate", lambda: travel * rng.uniform(-1, 1, 3), moves, False),
            self.channel("rotate", lambda: spin * rng.uniform(-1, 1, 3), moves, False),
            self.channel("scale", lambda: rng.uniform(0.5, 1.8, 3), moves)]
        write_element(out, 2, "transform", [("rotateOrder", order)], channels)

    def probe(self, heads):
        """The surfaces as the reference reads them, before materials and forces are chosen."""
        text = "\n".join([f'<scene version="1" fps="{self.fps_text}" start="{self.start}" '
                          f'end="{self.end}">'] +
                         [line for lines, _ in heads for line in lines + ["  </surface>"]] +
                         ["</scene>"])
        path = os.path.join(self.folder, f"{self.name}-probe.xml")
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)
        scene = Scene(path)
        os.remove(path)
        return scene

    def add_cache(self, surface, lines, solver):
        """Animates the shape of some surfaces: a wave that drifts. Draws nothing from the scene's numbers."""
        rng = np.random.default_rng(zlib.crc32(f"{self.name} {surface.name}".encode()))
        if self.is_lattice or ("reference", "none") in solver or rng.random() > 0.25:
            return
        self.tags.add("cache")
        vertices = surface.grid.vertices
        size = float(np.ptp(vertices, axis=0).max())
        times = np.arange(int(rng.integers(1, self.end - self.start + 4)), dtype=float)
        along, wave = rng.uniform(-3, 3, 3) / size, 0.05 * size * rng.uniform(-1, 1, 3)
        drift = 0.02 * size * rng.uniform(-1, 1, 3)
        phases = (vertices @ along)[None, :] + rng.uniform(0.1, 0.8) * times[:, None]
        samples = (vertices + np.sin(phases)[:, :, None] * wave + times[:, None, None] * drift)
        file = f"{self.name}-{surface.name}.npy"
        self.caches[file] = samples
        np.save(os.path.join(self.folder, file), samples)
        first = float(self.start + rng.integers(-4, 6) + rng.choice([0, 0, 0.5]))
        for k, line in enumerate(lines):
            for shape in ("<grid", "<mesh"):
                if shape in line:
                    lines[k] = line.replace("/>", f' cache="{file}" cacheStart="{first!r}"/>')

    def colliders(self, worlds, names):
        """Lines of colliders near the surfaces."""
        del worlds, names
        return []

    def make(self):
        """Returns a function of a magnitude factor that gives the scene's text."""
        rng = self.rng
        count = 1 if self.chance(0.75) else self.pick(2, 2, 3)
        if count > 1:
            self.tags.add("several surfaces")
        heads = [self.surface_head(k) for k in range(count)]
        scene = self.probe(heads)
        for surface, (lines, solver) in zip(scene.surfaces, heads):
            self.add_cache(surface, lines, solver)
        middle = (self.start + self.end) // 2
        worlds, blocks = [], []
        for surface, (lines, solver) in zip(scene.surfaces, heads):
            world = Transform(surface, middle).to_world(surface.grid.rest)
            worlds.append(world)
            blocks.append(self.surface_tail(lines, solver, surface, world))
        names = [surface.name for surface in scene.surfaces]
        # Everything random is drawn once: a retry with another factor must only scale magnitudes.
        force_seed = int(rng.integers(2**62))

        def text(factor):
            self.rng, self.magnitude_factor = np.random.default_rng(force_seed), factor
            lines = ['<?xml version="1.0" encoding="UTF-8"?>',
                     f'<scene version="1" fps="{self.fps_text}" start="{self.start}" '
                     f'end="{self.end}">']
            for block, _ in blocks:
                lines += block
            for k in range(self.pick(1, 1, 2, 2, 3, 4)):
                aim = int(self.rng.integers(len(worlds)))
                world, load_scale = worlds[aim], blocks[aim][1]
                spacing = self.spacing_of(world)
                targets = None
                if len(names) > 1 and self.chance(0.5):
                    targets = [name for j, name in enumerate(names) if j == aim or
                               self.chance(0.3)]
                maker = self.group if self.chance(0.1) else self.force
                lines += maker(k, world, spacing, load_scale, targets)
            lines += self.colliders(worlds, names)
            return "\n".join(lines + ["</scene>"]) + "\n"

        return text


if __name__ == "__main__":
    sys.exit(scene_search.main(SceneMaker, "random"))
