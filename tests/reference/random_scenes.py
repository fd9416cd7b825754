#!/usr/bin/env python3
"""Generates random, well-posed scenes that exercise every rule of SPEC 1-7.

    python3 random_scenes.py --seed N --count K -o DIR

writes DIR/random-N-000.xml ... with their meshes. Scene k of a seed does not depend on the count.
A scene is kept when it is well posed (well_posed.py) and its peak displacement is 0.03 to 1 of the
sheet's size.
"""

import argparse
import collections
import math
import os
import sys
import tempfile
import zlib

import numpy as np

from forces import Transform
from random_mesh import Mesh, text_of
from random_maps import grey_png
from scene import Scene
from well_posed import trouble_of

# Static peak of a clamped isotropic square plate of side L under the load q: 0.00126532 q L^4
# (SPEC 11); spread over the three terms by their share in the energy of (1-x^2)^2 (1-y^2)^2.
PEAK = 0.00126532
MIXED_SHARE = 2.0 / 7.0
FREQUENCY_SHARE = 35.985**2 * PEAK  # omega^2 rho, as a multiple of load/peak


class Writer:
    """XML text with indentation."""

    def __init__(self):
        self.lines = []

    def add(self, depth, text):
        self.lines.append("  " * depth + text)


class Channel:
    """One attribute: `constant`, or the lines of its <animate>."""

    def __init__(self, name, constant=None, animate=None):
        self.name, self.constant, self.animate = name, constant, animate


def write_element(out, depth, tag, attributes, channels, closing_lines=()):
    """An element with its constant attributes, then its animated channels."""
    words = [f'{name}="{value}"' for name, value in attributes]
    words += [f'{c.name}="{c.constant}"' for c in channels if c.animate is None]
    inner = [line for c in channels if c.animate for line in c.animate] + list(closing_lines)
    start = " ".join([f"<{tag}"] + words)
    if not inner:
        out.add(depth, start + "/>")
        return
    out.add(depth, start + ">")
    for line in inner:
        out.add(depth + 1, line)
    out.add(depth, f"</{tag}>")


class SceneMaker:
    """Draws one random scene; `tags` are the features it uses."""

    has_edges = True  # of grids

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
        # Its own numbers, so that maps change no other choice.
        self.map_rng = np.random.default_rng(zlib.crc32(name.encode()))
        self.surfaces = []  # (header line list before the material, choices)
        self.magnitude_factor = 1.0

    def chance(self, probability):
        return self.rng.random() < probability

    def pick(self, *options):
        return options[int(self.rng.integers(len(options)))]

    # Curves

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

    # Surfaces

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
                ("integrator", ("newmark", "exact"), 0.4),
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

    # Forces

    def place(self, world, is_inside=True):
        """A point at a node (lattice) or near the sheet, or beyond its edge."""
        rng = self.rng
        m, n = world.shape[:2]
        if not is_inside:
            self.tags.add("off the surface")
            middle = world.mean(axis=(0, 1))
            far = world[self.pick(0, m - 1), self.pick(0, n - 1)]
            return np.rint(middle + 4 * (far - middle)) if self.is_lattice else (
                middle + 2.5 * (far - middle))
        node = world[int(rng.integers(1, m - 1)), int(rng.integers(1, n - 1))]
        if self.is_lattice:
            return node
        return node + 0.02 * self.size_of(world) * rng.uniform(-1, 1, 3)

    @staticmethod
    def size_of(world):
        return float(world.reshape(-1, 3).ptp(axis=0).max())

    @staticmethod
    def spacing_of(world):
        return float(np.linalg.norm(np.diff(world, axis=0), axis=-1).max())

    def path(self, name, world):
        """A channel for a centre: constant, or moving, perhaps off the sheet and back."""
        if self.chance(0.5):
            return Channel(name, text_of(self.place(world)))
        stops = [self.place(world, not self.chance(0.2)) for _ in range(self.pick(2, 3, 4))]
        self.tags.add("moving force")
        return Channel(name, animate=self.animate(name, stops, is_safe=True,
                                                  is_exact=self.is_lattice))

    def radius(self, typical):
        if self.is_lattice:
            return float(max(1, round(typical)))
        return typical

    def direction(self):
        if self.chance(0.4):
            axis = np.zeros(3)
            axis[int(self.rng.integers(3))] = self.pick(1.0, -1.0, 3.0)
            self.tags.add("axis direction")
            return axis
        if self.chance(0.06):
            self.tags.add("zero direction")
            return np.zeros(3)
        return self.rng.uniform(-2, 2, 3)

    def force(self, index, world, spacing, load_scale, targets, in_group=None):
        """One force near `world`; `in_group` is the group's radius for a child."""
        rng, out = self.rng, Writer()
        kind = self.pick("point", "point", "radial", "line", "point", "radial", "line", "uniform",
                         "vortex", "noise", "inertia")
        self.tags.add(kind)
        size = self.size_of(world)
        attributes = [("name", f"{kind}{index}")]
        if targets is not None and in_group is None:
            attributes.append(("targets", " ".join(targets)))
            self.tags.add("targets")
        channels = []
        if self.chance(0.2):
            channels.append(Channel("enabled", animate=self.switch()))
        elif self.chance(0.05):
            channels.append(Channel("enabled", "false"))
            self.tags.add("disabled force")
        if kind == "line":
            channels += [self.path("from", world), self.path("to", world)]
        elif kind in ("point", "radial", "vortex", "noise"):
            channels.append(self.path("center", world))
        if kind == "vortex":
            channels += [self.channel("axis", self.direction, 0.15, False),
                         self.channel("pull", lambda: rng.uniform(-1, 1), 0.2, False)]
        elif kind == "noise":
            channels += [self.channel("frequency", lambda: rng.uniform(0.5, 4) / size, 0.15),
                         self.channel("rate", lambda: rng.uniform(0, 5), 0.15)]
            if self.chance(0.5):
                attributes.append(("seed", int(rng.integers(2**62))))
        elif kind == "uniform":
            channels.append(self.channel("direction", self.direction, 0.15, False))
        if kind == "point" or (kind == "line" and self.chance(0.5)):
            if kind == "line":
                self.tags.add("line with direction")
            channels.append(self.channel("direction", self.direction, 0.15, False))
        elif kind == "line":
            self.tags.add("line without direction")
        if self.chance(0.15):
            deformation = spacing * rng.uniform(0.4, 0.95)
            self.tags.add("radius below spacing")
        else:
            deformation = max(size * rng.uniform(0.15, 0.6), 1.3 * spacing)
        if in_group is None:
            channels.append(self.channel("deformationRadius", lambda: self.radius(
                deformation * rng.uniform(0.7, 1.3)), 0.0 if self.is_lattice else 0.2))
            force_radius = deformation * rng.uniform(0.3, 1.3)
        else:
            force_radius = in_group * rng.uniform(0.3, 1.0)
        force_radius = max(force_radius, spacing * self.pick(0.3, 0.8, 1.2))
        channels.append(self.channel("forceRadius", lambda: self.radius(
            force_radius * rng.uniform(0.7, 1.3)), 0.0 if self.is_lattice else 0.2))
        if self.chance(0.08):
            channels.append(Channel("magnitude", "0.0"))
            self.tags.add("magnitude 0")
        else:
            sign = 1.0 if kind in ("point", "uniform") else self.pick(-1.0, 1.0)
            channels.append(self.channel(
                "magnitude", lambda: self.magnitude_factor * load_scale * sign *
                rng.uniform(-0.2, 1.0), 0.5, False))
        closing = []
        if self.chance(0.1):
            self.tags.add("authored falloff")
            keys = sorted(rng.uniform(0, 1, 2))
            closing = ["<falloff>", f'  <key at="0" value="{rng.uniform(0.5, 1)!r}"/>',
                       f'  <key at="{keys[0]!r}" value="{rng.uniform(-0.5, 1.5)!r}"/>',
                       f'  <key at="{keys[1]!r}" value="{rng.uniform(0, 1)!r}" tangent="flat"/>',
                       "</falloff>"]
        elif self.chance(0.7):
            falloff = self.pick("constant", "linear", "smooth", "gaussian")
            attributes.append(("falloff", falloff))
            self.tags.add(f"falloff {falloff}")
        write_element(out, 1 if in_group is None else 2, kind, attributes, channels, closing)
        return out.lines

    def group(self, index, world, spacing, load_scale, targets):
        out = Writer()
        size = self.size_of(world)
        radius = self.radius(max(size * self.rng.uniform(0.2, 0.6), 2 * spacing))
        attributes = [("name", f"group{index}")]
        if targets is not None:
            attributes.append(("targets", " ".join(targets)))
        channels = [self.path("center", world), Channel("deformationRadius", text_of(radius))]
        if self.chance(0.2):
            channels.insert(0, Channel("enabled", animate=self.switch()))
        self.tags.add("group")
        children = []
        for child in range(self.pick(1, 2, 3)):
            lines = self.force(f"{index}in{child}", world, spacing, load_scale, None, radius)
            children += [line[2:] for line in lines]
        write_element(out, 1, "group", attributes, channels, [line[2:] for line in children])
        return out.lines

    # The whole

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
            return "\n".join(lines + ["</scene>"]) + "\n"

        return text

    def stiffness_of(self, surface):
        """Channels of b, c and d, the stiffness against a load in a region of typical size, and the
        lengths of that."""
        rng = self.rng
        grid = surface.grid
        length_u = grid.hu * (grid.columns - 1) * rng.uniform(0.5, 0.9)
        length_v = grid.hv * (grid.rows - 1) * rng.uniform(0.5, 0.9)
        b, c, d = 1.0, 2.0, 1.0
        self.least_ratio = 0.9
        channels = []
        if self.chance(0.6):
            b, d = np.exp(rng.uniform(-1, 1, 2))
            c = math.sqrt(b * d) * rng.uniform(-1.6, 3.0)
            if c < 0:
                self.tags.add("negative c")
            # c > 2 poisson sqrt(b d), whatever the factors below are.
            self.least_ratio = c * (0.8 if c > 0 else 1.05 / 0.9 * 1.4) / (2.8 * math.sqrt(b * d))
            animated = 0.25
            channels += [self.channel("b", lambda: b * rng.uniform(0.9, 1.4), animated),
                         self.channel("d", lambda: d * rng.uniform(0.9, 1.4), animated),
                         self.channel("c", lambda: c * rng.uniform(0.8, 1.05), animated)]
        stiffness = (b / length_u**4 + MIXED_SHARE * max(c, 0) / (length_u * length_v)**2 +
                     d / length_v**4) / (PEAK * (2 + 2 * MIXED_SHARE))
        return channels, stiffness, length_u, length_v

    def edges(self, solver, is_static):
        """Edges of a whole surface; one that is static must be held."""
        while True:
            edges = [self.pick("clamped", "pinned", "free") for _ in range(self.pick(1, 4, 4))] * 4
            edges = edges[:4]
            if not is_static or "clamped" in edges or edges.count("pinned") >= 2:
                break
        is_one = len(set(edges)) == 1 and self.chance(0.5)
        solver.append(("edges", edges[0] if is_one else " ".join(edges)))
        self.tags.update(f"edge {edge}" for edge in edges)
        return edges

    def maps(self, solver, surface):
        """Lines of the maps of a surface: pictures, one for all of b, c and d, so that c keeps its
        ratio to sqrt(b d)."""
        rng = self.map_rng
        if rng.random() < 0.6 or ("integrator", "exact") in solver:
            return []
        groups = [("density",), ("damping",), ("b", "c", "d")]
        is_grid = hasattr(surface.grid, "columns")
        if is_grid and ("combine", "union") in solver:
            groups.pop()
        lines = []
        for group in groups:
            if rng.random() < 0.4:
                continue
            file = f"{self.name}-{surface.name}-{group[0]}.png"
            height, width = rng.integers(1, 12, 2)
            self.pictures[file] = grey_png(rng.integers(0, 256, (height, width)))
            with open(os.path.join(self.folder, file), "wb") as stream:
                stream.write(self.pictures[file])
            low, high = rng.uniform(0.6, 1.4, 2)
            for channel in group:
                lines.append(f'<map channel="{channel}" file="{file}" low="{text_of(low)}" '
                             f'high="{text_of(high)}"/>')
                self.tags.add(f"map {channel}")
        if any(uv is None or np.isnan(uv).any() for uv in surface.grid.uvs):
            return []
        return lines

    def surface_tail(self, lines, solver, surface, world):
        """Material, tangents and solver of a surface; returns its lines and the load's scale."""
        rng, out = self.rng, Writer()
        channels, stiffness, length_u, length_v = self.stiffness_of(surface)
        maps = self.maps(solver, surface)
        is_grid = hasattr(surface.grid, "columns")
        is_whole_grid = self.has_edges and ("region", "all") in solver
        if is_whole_grid:
            bound = self.least_ratio - 0.02
            least = min(-0.9, bound - 0.03)
            channels.append(
                self.channel("poisson", lambda: rng.uniform(least, min(0.9, bound)), 0.2))
        elif any(f'channel="{name}"' in line for line in maps for name in "bcd") and (
                is_grid or surface.grid.border != "free"):
            channels.append(Channel("poisson", text_of(min(0.3, self.least_ratio - 0.05))))
        omega = 2 * math.pi * self.fps / rng.uniform(4, 40)
        density = FREQUENCY_SHARE * stiffness / omega**2
        damping = 2 * rng.choice([0.02, 0.2, 1.0]) * omega * density
        kind = self.pick("both", "both", "both", "both", "static", "massless", "undamped")
        self.tags.add(f"material {kind}")
        if kind in ("static", "massless"):
            density = 0.0
        if kind in ("static", "undamped"):
            damping = 0.0
        channels += [self.channel("density", lambda: density * rng.uniform(0.7, 1.4),
                                  0.15 if density else 0),
                     self.channel("damping", lambda: damping * rng.uniform(0.7, 1.4),
                                  0.15 if damping else 0)]
        write_element(out, 2, "material", [], channels, maps)
        edges = ["clamped"] * 4
        if is_whole_grid and self.chance(0.6):
            edges = self.edges(solver, kind == "static")
        size = self.size_of(surface.grid.rest)
        if self.chance(0.3) and ("release", "recover") not in solver:
            self.tags.add("tangents")
            channels = []
            for edge, length in (("su0", length_u), ("su1", length_u), ("sv0", length_v),
                                 ("sv1", length_v)):
                components = self.pick(0, 1, 3)
                if edges[("su0", "su1", "sv0", "sv1").index(edge)] != "clamped":
                    components = 0
                if components:
                    self.tags.add(f"tangent of {components} numbers")
                    channels.append(self.channel(
                        edge, lambda n=components, s=size / length: 0.6 * s * rng.uniform(-1, 1, n),
                        0.2, False))
            write_element(out, 2, "tangents", [], channels)
        dt_text = self.pick("0.01", "0.01", "0.004166666666666667", "1", "0.02", None)
        dt = [] if dt_text is None else [Channel("dt", dt_text)]
        if self.chance(0.05):
            dt = [Channel("dt", animate=self.animate("dt", [0.01, 0.03], is_safe=True))]
        if self.chance(0.2):
            self.tags.add("timeScale")
            dt.append(self.channel("timeScale", lambda: rng.choice([0.3, 0.5, 1.7]), 0.5))
        write_element(out, 2, "solver", solver, dt)
        # World-space force for an object-space load of `amplitude`.
        stretch = self.size_of(world) / size
        amplitude = size * rng.uniform(0.1, 0.5)
        return lines + out.lines + ["  </surface>"], amplitude * stiffness * stretch


def make_scene(kind, prefix, seed, index, folder, rejections):
    """Writes one accepted scene, made by a `kind` of SceneMaker; returns its tags, its relative peak
    and its diagnostics."""
    name = f"{prefix}-{seed}-{index:03d}"
    path = os.path.join(folder, name + ".xml")
    for attempt in range(1000):
        rng = np.random.default_rng([seed, index, attempt])
        with tempfile.TemporaryDirectory() as scratch:
            maker = kind(rng, scratch, name)
            text_of_factor = maker.make()
            factor = 1.0
            trial = os.path.join(scratch, name + ".xml")
            for _ in range(5):
                text = text_of_factor(factor)
                with open(trial, "w", encoding="utf-8") as stream:
                    stream.write(text)
                try:
                    trouble, peak, diagnostics = trouble_of(trial)
                except AssertionError as error:
                    trouble, peak = f"not legal ({str(error).split('=')[0]})", 0.0
                    break
                if 0.03 <= peak <= 1.0 or peak == 0:
                    break
                factor *= 0.3 / peak
            if trouble is None and not 0.03 <= peak <= 1.0:
                # A few scenes without motion are wanted: they must stay exactly at rest.
                if peak > 0 or rng.random() > 0.05:
                    trouble = "too little or too much motion"
                else:
                    maker.tags.add("nothing moves")
            if trouble is not None:
                rejections[trouble] += 1
                continue
            note_run(maker.tags, diagnostics)
            head, body = text.split("\n", 1)
            comment = f"<!-- {', '.join(sorted(maker.tags))} -->"
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(f"{head}\n{comment}\n{body}")
            for file, samples in maker.caches.items():
                np.save(os.path.join(folder, file), samples)
            for file, mesh_text in maker.meshes.items():
                with open(os.path.join(folder, file), "w", encoding="utf-8") as stream:
                    stream.write(mesh_text)
            for file, picture in maker.pictures.items():
                with open(os.path.join(folder, file), "wb") as stream:
                    stream.write(picture)
            return maker.tags, peak, diagnostics
    raise AssertionError(f"no well-posed scene for {name}")


def note_run(tags, diagnostics):
    """Tags known only after a run."""
    if diagnostics.recovering:
        tags.add("ran: recovering nodes")
    if diagnostics.unions:
        tags.add("ran: a union that is no box")
    if diagnostics.exact_ties:
        tags.add("ran: exact ties")
    for _, _, reason in diagnostics.skips:
        tags.add(f"ran: {reason}")
    by_surface = collections.defaultdict(list)
    for frame, surface, box in diagnostics.solves:
        by_surface[surface].append((frame, box))
    for solves in by_surface.values():
        frames = [frame for frame, _ in solves]
        if any(q - p > 1 for p, q in zip(frames, frames[1:])):
            tags.add("ran: frames without a solve between solves")
        if len({box for _, box in solves}) > 1:
            tags.add("ran: region changes")


def main(kind=SceneMaker, prefix="random"):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("-o", "--output", required=True, metavar="DIR")
    arguments = parser.parse_args()
    os.makedirs(arguments.output, exist_ok=True)
    coverage, rejections = collections.Counter(), collections.Counter()
    for index in range(arguments.count):
        tags, peak, diagnostics = make_scene(kind, prefix, arguments.seed, index,
                                             arguments.output, rejections)
        coverage.update(tags)
        print(f"{prefix}-{arguments.seed}-{index:03d}: peak {peak:.3g} of the size, "
              f"{len(diagnostics.solves)} solves, {len(diagnostics.skips)} without, "
              f"margin {diagnostics.tie_margin:.1e}", flush=True)
    print("covered:")
    for tag, number in sorted(coverage.items()):
        print(f"  {number:4d}  {tag}")
    print("rejected:")
    for reason, number in rejections.most_common():
        print(f"  {number:4d}  {reason}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
