"""Random colliders of scenes."""

import os

import numpy as np

from random_channels import ChannelMaker
from random_mesh import text_of
from scene_text import Channel, Writer, write_element

# Closed, some of them with hollows and with faces of several corners, within 1 of the origin.
SOLIDS = {
    "tetrahedron": ([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)],
                    [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)]),
    "octahedron": ([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
                   [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]),
    "step": ([(x, y, z) for z in (-0.7, 0.7) for x, y in (
        (-0.9, -0.5), (0.9, -0.5), (0.9, 0.05), (0.1, 0.05), (0.1, 0.6), (-0.9, 0.6))],
             [(0, 3, 2, 1), (0, 5, 4, 3), (6, 7, 8, 9), (6, 9, 10, 11)] +
             [(k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k) for k in range(6)]),
}


class ColliderMaker(ChannelMaker):
    """Draws colliders that come to the surfaces."""

    def solid(self, kind, index, size):
        """The lines of a shape about as large as `size`, how far it reaches, and the scale that it needs, if any."""
        rng, out = self.rng, Writer()
        radius = size * rng.uniform(0.12, 0.4)
        keyed = 0.25
        stretch, attributes, channels = None, [], []
        if kind == "sphere":
            channels = [self.channel("radius", lambda: radius * rng.uniform(0.8, 1.2), keyed)]
        elif kind == "capsule":
            channels = [self.channel("radius", lambda: 0.6 * radius * rng.uniform(0.8, 1.2), keyed),
                        self.channel("length", lambda: radius * rng.uniform(0, 2), keyed)]
        elif kind == "box":
            channels = [self.channel("size", lambda: 2 * radius * rng.uniform(0.5, 1, 3), keyed)]
            if self.chance(0.6):
                channels.append(self.channel("round", lambda: radius * rng.uniform(0, 0.25), keyed))
                self.tags.add("round")
        elif kind == "mesh":
            attributes, stretch = [("file", self.solid_mesh(index))], radius
        write_element(out, 0, kind, attributes, channels)
        return out.lines, radius, stretch

    def solid_mesh(self, index):
        """The file of a closed mesh, turned outwards or inwards."""
        rng = self.rng
        kind = self.pick(*SOLIDS)
        self.tags.add(f"closed {kind}")
        vertices, faces = SOLIDS[kind]
        vertices = np.array(vertices) + 0.08 * rng.uniform(-1, 1, (len(vertices), 3)) * (kind != "step")
        order = self.pick(1, -1)
        lines = ["v " + text_of(vertex) for vertex in vertices]
        lines += ["f " + " ".join(str(k + 1) for k in face[::order]) for face in faces]
        file = f"{self.name}-solid{index}.obj"
        self.meshes[file] = "\n".join(lines) + "\n"
        with open(os.path.join(self.folder, file), "w", encoding="utf-8") as stream:
            stream.write(self.meshes[file])
        return file

    def scale(self, kind, stretch):
        """The channel of scale, with lengths that are equal where they must be."""
        rng = self.rng
        if kind == "plane" or (stretch is None and self.chance(0.6)):
            return []
        signs = np.array([self.pick(1.0, 1.0, -1.0) for _ in range(3)])
        low = 0.9 if kind == "box" else 0.7
        draw = {"sphere": lambda: signs * rng.uniform(low, 1.3), "capsule": lambda: signs * rng.uniform(low, 1.3)}.get(
            kind, lambda: signs * rng.uniform(low, 1.3, 3) * (stretch or 1))
        return [self.channel("scale", draw, 0.3)]

    def way(self, world, reach):
        """Places of a solid that reaches so far: from off the surface into it, over it and away, or through it."""
        rng, size = self.rng, self.size_of(world)
        across = rng.standard_normal(3) * (0.3, 1, 0.3)
        across /= np.linalg.norm(across)
        start = self.place(world)
        kind = self.pick("lands", "lands", "strokes", "waits", "jumps", "stands inside")
        self.tags.add(f"collider {kind}")
        near = start + across * (reach + size * rng.uniform(-0.12, -0.02))
        away = start + across * (reach + size * rng.uniform(0.05, 0.3))
        if kind == "waits":
            return [start + across * (reach + size * rng.uniform(0.005, 0.06))]
        if kind == "stands inside":
            return [near]
        if kind == "jumps":
            return [away, start - across * (reach + size * rng.uniform(0.0, 0.1))]
        stops = [away, near]
        if kind == "strokes":
            stops.append(near + size * rng.uniform(-0.3, 0.3, 3) * (1, 0.1, 1))
        return stops + [away] * self.chance(0.6)

    def collider(self, index, world, targets):
        """One collider that comes to `world`."""
        rng, out = self.rng, Writer()
        kind = self.pick("sphere", "sphere", "capsule", "box", "box", "plane", "mesh")
        self.tags.add(f"collider {kind}")
        size = self.size_of(world)
        shape, radius, stretch = self.solid(kind, index, size)
        attributes, channels = [("name", f"solid{index}")], []
        if targets is not None:
            attributes.append(("targets", " ".join(targets)))
            self.tags.add("collider's targets")
        if self.chance(0.2):
            channels.append(Channel("enabled", animate=self.switch()))
        elif self.chance(0.05):
            channels.append(Channel("enabled", "false"))
            self.tags.add("disabled collider")
        channels.append(self.channel("deformationRadius", lambda: size * self.pick(0, 0.2, 0.4) * rng.uniform(
            0.7, 1.3), 0.2))
        offset = 0.0
        if self.chance(0.4):
            offset = 0.03 * size
            channels.append(self.channel("offset", lambda: offset * rng.uniform(0, 1), 0.4))
            self.tags.add("offset")
        if self.chance(0.35):
            channels.append(self.channel("friction", lambda: rng.uniform(0, 1), 0.3))
            self.tags.add("friction")
        elif self.chance(0.25):
            always, switch = self.pick(True, False), self.switch_of("stick")
            channels.append(Channel("stick", "true") if always else Channel("stick", animate=switch))
            self.tags.add("stick")
        reach = 0.0 if kind == "plane" else radius
        stops = self.way(world, reach + offset / 2)
        place = Channel("translate", text_of(stops[0]))
        if len(stops) > 1:
            place = Channel("translate", animate=self.travel(stops))
        turn = [self.channel("rotate", lambda: rng.uniform(-180, 180, 3) * self.pick(0.2, 1), 0.3, False)]
        if kind == "plane":
            turn = [self.channel("rotate", lambda: rng.uniform(-25, 25, 3), 0.3)]
        order = self.pick("xyz", "xyz", "zyx", "yxz")
        transform = Writer()
        write_element(transform, 0, "transform", [("rotateOrder", order)], [place] + turn + self.scale(kind, stretch))
        write_element(out, 1, "collider", attributes, channels, shape + transform.lines)
        return out.lines

    def switch_of(self, name):
        return [line.replace('attribute="enabled"', f'attribute="{name}"') for line in self.switch()]

    def travel(self, stops):
        """Lines of an <animate> of a place within the run."""
        rng = self.rng
        if self.chance(0.3):
            return self.animate("translate", stops, is_safe=True)
        times = np.sort(rng.choice(np.arange(self.start, self.end + 1), len(stops), replace=False))
        way = self.pick("", ' interpolation="linear"', ' interpolation="step"' if self.chance(0.3) else "")
        lines = [f'  <key frame="{time}" value="{text_of(stop)}"/>' for time, stop in zip(times, stops)]
        return [f'<animate attribute="translate"{way}>'] + lines + ["</animate>"]
