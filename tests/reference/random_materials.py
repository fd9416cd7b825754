"""Random materials, edges and steps of surfaces."""

import math
import os

import numpy as np

from random_maps import grey_png
from random_mesh import text_of
from random_yield import YieldMaker
from scene_text import Channel, Writer, write_element

# Static peak of a clamped isotropic square plate of side L under the load q: 0.00126532 q L^4
# (SPEC 11); spread over the three terms by their share in the energy of (1-x^2)^2 (1-y^2)^2.
PEAK = 0.00126532
MIXED_SHARE = 2.0 / 7.0
FREQUENCY_SHARE = 35.985**2 * PEAK  # omega^2 rho, as a multiple of load/peak


class MaterialMaker(YieldMaker):
    """Draws what is inside a surface but for its shape."""

    has_edges = True  # of grids

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

    def maps(self, solver, surface, yields):
        """Lines of the maps of a surface: pictures, one for all of b, c and d, so that c keeps its
        ratio to sqrt(b d)."""
        rng = self.map_rng
        if rng.random() < 0.6:
            return []
        groups = [("density",), ("damping",), ("b", "c", "d")]
        # Exact motion with uneven damping takes the reference the cube of their number.
        if ("integrator", "exact") in solver and surface.grid.rest.size > 3 * 160:
            groups = groups[2:]
        if yields:
            groups = [("yield",), ("hardening",)] + groups
        if ("combine", "union") in solver:
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

    def goal(self, solver, surface, stiffness):
        """The channel of a goal about as strong as the plate, and the line of its map."""
        rng = self.goal_rng
        if rng.random() < 0.7 or ("reference", "none") in solver:
            return [], []
        self.tags.add("goal")
        channel = Channel("goal", text_of(stiffness * rng.uniform(0.05, 2)))
        if rng.random() < 0.5 or any(uv is None or np.isnan(uv).any() for uv in surface.grid.uvs):
            return [channel], []
        self.tags.add("map goal")
        file = f"{self.name}-{surface.name}-goal.png"
        self.pictures[file] = grey_png(rng.integers(0, 256, rng.integers(1, 12, 2)))
        with open(os.path.join(self.folder, file), "wb") as stream:
            stream.write(self.pictures[file])
        low, high = rng.uniform(0.2, 1.8, 2)
        return [channel], [f'<map channel="goal" file="{file}" low="{text_of(low)}" '
                           f'high="{text_of(high)}"/>']

    def surface_tail(self, lines, solver, surface, world):
        """Material, tangents and solver of a surface; returns its lines and the load's scale."""
        rng, out = self.rng, Writer()
        channels, stiffness, length_u, length_v = self.stiffness_of(surface)
        kind = self.pick("both", "both", "both", "both", "static", "massless", "undamped")
        has_cache = any("cache=" in line for line in lines)
        if self.chance(0.06) and not has_cache and ("release", "recover") not in solver and (
                "integrator", "exact") not in solver:
            self.tags.add("loop")
            solver.append(("loop", int(rng.integers(2, 9))))
            kind = self.pick("both", "static", "massless")
        elif self.chance(0.15):
            self.tags.add("preroll")
            solver.append(("preroll", int(rng.integers(1, 6))))
        yields = self.yields(solver, surface, kind == "static")
        maps = self.maps(solver, surface, yields)
        channels += yields
        is_grid = hasattr(surface.grid, "columns")
        is_whole_grid = self.has_edges and ("region", "all") in solver
        if is_whole_grid:
            bound = self.least_ratio - 0.02
            least = min(-0.9, bound - 0.03)
            channels.append(
                self.channel("poisson", lambda: rng.uniform(least, min(0.9, bound)), 0.2))
        elif (yields or any(f'channel="{name}"' in line for line in maps for name in "bcd")) and (
                is_grid or surface.grid.border != "free"):
            channels.append(Channel("poisson", text_of(min(rng.uniform(-0.3, 0.5),
                                                           self.least_ratio - 0.05))))
        # A cycle closes after some frames only where motion fades soon.
        omega = 2 * math.pi * self.fps / rng.uniform(4, 12 if "loop" in dict(solver) else 40)
        density = FREQUENCY_SHARE * stiffness / omega**2
        ratio = 1.0 if "loop" in dict(solver) else rng.choice([0.02, 0.2, 1.0])
        damping = 2 * ratio * omega * density
        self.tags.add(f"material {kind}")
        if kind in ("static", "massless"):
            density = 0.0
        if kind in ("static", "undamped"):
            damping = 0.0
        channels.append(self.channel("density", lambda: density * rng.uniform(0.7, 1.4),
                                     0.15 if density else 0))
        # The slowest mode of a mesh that floats may be 1e-8 of the fastest: rounding decides it.
        may_float = not is_grid and ("region", "all") in solver
        if density and "loop" not in dict(solver) and not may_float and self.chance(0.15):
            self.tags.add("dampingRatio")
            maps = [line for line in maps if 'channel="damping"' not in line]
            channels.append(self.channel("dampingRatio", lambda: 10 ** rng.uniform(-1.7, 0), 0.25))
        else:
            channels.append(self.channel("damping", lambda: damping * rng.uniform(0.7, 1.4),
                                         0.15 if damping else 0))
        goal, map_of_goal = self.goal(solver, surface, stiffness)
        write_element(out, 2, "material", [], channels + goal, maps + map_of_goal)
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
