"""Random meshes for random scenes (SPEC 1)."""

import collections
import math

import numpy as np


def text_of(value):
    """The text of an attribute's numbers: the shortest that reads back to the same numbers."""
    return " ".join(repr(float(x)) for x in np.atleast_1d(value))


class Mesh:
    """Text of an OBJ patch over an even (u,v) lattice, in any vertex order."""

    def __init__(self, rng, tags):
        self.columns, self.rows = (int(n) for n in rng.integers(4, 17, 2))
        size = 10 ** rng.uniform(-0.3, 1.0)
        self.extent = size * rng.uniform(0.7, 1.4, 2)
        u_range, v_range = rng.uniform(0.3, 3, 2)
        u = rng.uniform(-2, 1) + u_range * np.arange(self.columns) / (self.columns - 1)
        v = rng.uniform(-2, 1) + v_range * np.arange(self.rows) / (self.rows - 1)
        tags.update(["obj", "uv range"])
        if u[0] < 0 or v[0] < 0:
            tags.add("negative uv")
        shape = rng.choice(["flat", "relief", "arc"], p=[0.25, 0.5, 0.25])
        tags.add(f"obj {shape}")
        position = {}
        waves = rng.uniform(0.5, 3, 4)
        height = size * rng.uniform(0.02, 0.15)
        for i in range(self.columns):
            for j in range(self.rows):
                a, b = i / (self.columns - 1), j / (self.rows - 1)
                x, z = (a - 0.5) * self.extent[0], (b - 0.5) * self.extent[1]
                y = 0.0
                if shape == "relief":
                    y = height * math.sin(waves[0] + 3 * waves[1] * a) * math.cos(
                        waves[2] + 3 * waves[3] * b)
                elif shape == "arc":
                    angle, radius = 2.0 * (a - 0.5), self.extent[0] / 2
                    x, y = radius * math.sin(angle), radius * (math.cos(angle) - 0.8)
                position[i, j] = (x, y, z)
        jitter = 0.0
        if rng.random() < 0.3:
            jitter = 0.003
            tags.add("uv jitter")
        vertices = list(position)
        if rng.random() < 0.5:
            # Not at the patch's corners, where one face could leave a vertex without a use.
            split = [(i, j) for i, j in vertices if rng.random() < 0.15 and
                     (0 < i < self.columns - 1 or 0 < j < self.rows - 1)]
            vertices += split
            tags.add("split vertices")
        if rng.random() < 0.7:
            order = rng.permutation(len(vertices))
            vertices = [vertices[k] for k in order]
            tags.add("shuffled vertices")
        hu, hv = u_range / (self.columns - 1), v_range / (self.rows - 1)
        lines, of_node = [], collections.defaultdict(list)
        for k, node in enumerate(vertices):
            of_node[node].append(k + 1)
            lines.append("v " + text_of(position[node]))
        for i, j in vertices:
            shift = jitter * rng.uniform(-1, 1, 2)
            lines.append("vt " + text_of((u[i] + shift[0] * hu, v[j] + shift[1] * hv)))
        use = collections.Counter()
        is_triangles = rng.random() < 0.5
        tags.add("obj triangles" if is_triangles else "obj quads")

        def corner(i, j):
            use[i, j] += 1
            k = of_node[i, j][use[i, j] % len(of_node[i, j])]
            return f"{k}/{k}"

        for j in range(self.rows - 1):
            for i in range(self.columns - 1):
                ring = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
                faces = [ring[:3], [ring[0]] + ring[2:]] if is_triangles else [ring]
                for face in faces:
                    lines.append("f " + " ".join(corner(*node) for node in face))
        self.text = "\n".join(lines) + "\n"
