"""Random forces of scenes."""

import numpy as np

from random_channels import ChannelMaker
from random_mesh import text_of
from scene_text import Channel, Writer, write_element


class ForceMaker(ChannelMaker):
    """Draws forces near the surfaces; `is_lattice` keeps all places and radii whole,
    `magnitude_factor` scales all magnitudes."""

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
