"""The region on triangles: cut, not picked (SPEC 8, "Region"), and its shares of area (SPEC 8, "Mass and load")."""

import collections

import numpy as np

from triangle_mesh import edge, joined

SNAP = 0.1  # a cut nearer to the end of an edge than this part of it goes to that end
THIRD = np.full(3, 1 / 3)


def snapped(mesh, phi, diagnostics):
    """Rule 2: phi at the points, with 0 at those that a cut comes near to."""
    result = phi.copy()
    for p, q in mesh.triangles_at:
        if phi[p] * phi[q] < 0:
            a, b = (p, q) if phi[p] > 0 else (q, p)
            t = phi[a] / (phi[a] - phi[b])
            diagnostics.cut_margin = min(diagnostics.cut_margin, abs(t - SNAP), abs(1 - t - SNAP))
            if t < SNAP:
                result[a] = 0
            if 1 - t < SNAP:
                result[b] = 0
    return result


class Region:
    """The cells of one cut of a mesh, with the points that are their corners.

    A corner of a cell is a point of the mesh, p; a rim point between two, (p, q) with phi > 0 at p;
    or the centre of the part of triangle t, ("part", t). `cells` are three of them, `places` where
    they stand along u and v.
    """

    def __init__(self, mesh, phi, may_float=False):
        self.mesh, self.phi, self.is_inside = mesh, phi, phi > 0
        self.may_float = may_float  # whether a patch moves if nothing holds it
        self.cells, self.places = [], []
        self.triangles = []  # of the cells
        self.part_corners = {}  # of the centre of a part
        self.cells_at = collections.defaultdict(list)  # pair of corners -> (cell, edge of it)
        self.edge_of = {}  # pair of corners on an edge of the mesh's triangles -> that edge
        for t, corners in enumerate(mesh.triangles):
            if max(phi[p] for p in corners) > 0:
                self.cut(t, corners)
        self.places = np.array(self.places).reshape(-1, 3, 2)
        self.areas, self.normals, self.bending = bending(self.places)
        self.sort_patches()

    def cut(self, t, corners):
        """Adds the part of triangle t where phi >= 0."""
        layout = self.mesh.layout[t]
        names, places, sides = [], [], []  # sides: the edges of the triangle on which a corner is
        for k in range(3):
            p, q = corners[k], corners[(k + 1) % 3]
            if self.phi[p] >= 0:
                names.append(p)
                places.append(layout[k])
                sides.append({k, (k + 2) % 3})
            if self.phi[p] * self.phi[q] < 0:
                a, b = (p, q) if self.phi[p] > 0 else (q, p)
                names.append((a, b))
                share = self.share(a, b)
                if a == q:
                    share = 1 - share
                places.append((1 - share) * layout[k] + share * layout[(k + 1) % 3])
                sides.append({k})
        count = len(names)
        for k in range(count):
            following = (k + 1) % count
            for side in sides[k] & sides[following]:
                self.edge_of[pair(names[k], names[following])] = edge(
                    corners[side], corners[(side + 1) % 3])
        if count == 3:
            self.add_cell(names, places, t)
            return
        assert count == 4
        centre = ("part", t)
        self.part_corners[centre] = names
        for k in range(4):
            following = (k + 1) % 4
            self.add_cell([names[k], names[following], centre],
                          [places[k], places[following], sum(places) / 4], t)

    def share(self, a, b):
        """How far from a to b the rim point stands."""
        return self.phi[a] / (self.phi[a] - self.phi[b])

    def add_cell(self, names, places, triangle):
        for k in range(3):
            key = pair(names[k], names[(k + 1) % 3])
            self.cells_at[key].append((len(self.cells), k))
        self.cells.append(names)
        self.triangles.append(triangle)
        self.places.append(places)

    def is_held(self, name):
        """Rule 4, for the corner of a cell."""
        if isinstance(name, tuple):
            return name[0] != "part"
        if not self.is_inside[name]:
            return True
        if name >= len(self.mesh.rest):
            return False
        return bool(self.mesh.held[name] or (self.mesh.border != "free" and self.mesh.is_border[name]))

    def sort_patches(self):
        """Rule 5: which cells move, and the numbers of each patch."""
        names = sorted({name for cell in self.cells for name in cell}, key=str)
        number = {name: k for k, name in enumerate(names)}
        patch_of = joined(len(names), ((number[cell[0]], number[name]) for cell in self.cells
                                       for name in cell[1:]))
        held = {patch_of[number[name]] for name in names if self.is_held(name)}
        self.floats = self.may_float and held != set(patch_of)
        if self.may_float:
            held = set(patch_of)
        self.moving_cells = np.array([patch_of[number[cell[0]]] in held for cell in self.cells],
                                     dtype=bool)
        self.unknown_names = [name for name in names
                              if not self.is_held(name) and patch_of[number[name]] in held]
        self.moving_nodes = [name for name in self.unknown_names
                             if not isinstance(name, tuple) and name < len(self.mesh.rest)]
        self.patches = []  # numbers of inside nodes, held nodes and cells
        for patch in sorted(set(patch_of)):
            nodes = [name for name in names if patch_of[number[name]] == patch and
                     not isinstance(name, tuple) and name < len(self.mesh.rest)]
            self.patches.append((
                sum(bool(self.is_inside[node]) for node in nodes),
                sum(self.is_held(node) for node in nodes),
                sum(patch_of[number[cell[0]]] == patch for cell in self.cells)))

    def held_displacement(self, name, w):
        """SPEC 8, "Plate": the displacement of a held corner."""
        if isinstance(name, tuple):
            return self.held_displacement(name[1], w)
        if name < len(self.mesh.rest):
            return w[name]
        outside = [node for node in self.mesh.centre_corners[name - len(self.mesh.rest)]
                   if not self.is_inside[node]]
        return w[outside].mean(axis=0)

    def values_at(self, name, values):
        """A function on the mesh's points, carried on to the corners of cells (SPEC 8, "Mass and load")."""
        if not isinstance(name, tuple):
            return values[name]
        if name[0] == "part":
            return sum(self.values_at(corner, values) for corner in self.part_corners[name]) / 4
        share = self.share(*name)
        return (1 - share) * values[name[0]] + share * values[name[1]]

    def shared_out(self, integrals):
        """Sums of the cells' integrals (of 3 hats each) at the nodes that move (SPEC 8, "Mass and load")."""
        total = collections.defaultdict(float)
        for cell, parts in zip(self.cells, integrals):
            for name, part in zip(cell, parts):
                total[name] += part
        for name, corners in self.part_corners.items():
            for corner in corners:
                total[corner] += total[name] / 4
        first = len(self.mesh.rest)
        for k, corners in enumerate(self.mesh.centre_corners):
            for corner in corners:
                total[corner] += total[first + k] / len(corners)
        return np.array([total[node] for node in self.moving_nodes])

    def masses(self):
        return self.shared_out(self.areas[:, None] * THIRD)

    def load_areas(self, reach):
        """mu of SPEC 8, "Mass and load"; `reach` is forceRadius - delta at the mesh's points."""
        integrals = [area * hat_integrals([self.values_at(name, reach) for name in cell])
                     for area, cell in zip(self.areas, self.cells)]
        return self.shared_out(integrals)


def areas_of(places):
    first, second = (places[:, k] - places[:, 0] for k in (1, 2))
    return np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2


def pair(a, b):
    return (a, b) if str(a) < str(b) else (b, a)


def hat_integrals(values):
    """Integrals of a triangle's hats over the part where the linear function is > 0; area 1."""
    if max(values) <= 0:
        return np.zeros(3)
    if min(values) >= 0:
        return THIRD
    kept = []
    for k in range(3):
        following = (k + 1) % 3
        if values[k] >= 0:
            kept.append(np.eye(3)[k])
        if values[k] * values[following] < 0:
            t = values[k] / (values[k] - values[following])
            kept.append((1 - t) * np.eye(3)[k] + t * np.eye(3)[following])
    total = np.zeros(3)
    for p, q in zip(kept[1:], kept[2:]):
        corners = np.array([kept[0], p, q])
        total += abs(np.linalg.det(corners)) * corners.mean(axis=0)
    return total


def bending(places):
    """Of each cell: its area, its outward normals (edge k from corner k), and H as 3 rows (uu, vv,
    uv) by 6 columns (w of the corners, slopes of the edges)."""
    along = np.roll(places, -1, axis=1) - places
    lengths = np.linalg.norm(along, axis=-1)
    normals = np.stack([along[..., 1], -along[..., 0]], axis=-1) / lengths[..., None]
    opposite = np.roll(places, -2, axis=1) - places
    heights = (normals * opposite).sum(axis=-1)  # of the opposite corner; negative if outward
    normals = np.where(heights[..., None] > 0, -normals, normals)
    areas = areas_of(places)
    # The hat of corner k falls to 0 at the edge after it.
    gradients = -np.roll(normals * lengths[..., None], -1, axis=1) / (2 * areas[:, None, None])
    x, y = normals[..., 0], normals[..., 1]
    by_slope = np.stack([x * x, y * y, x * y], axis=1) * (lengths / areas[:, None])[:, None, :]
    by_corner = -by_slope @ normals @ gradients.transpose(0, 2, 1)
    return areas, normals, np.concatenate([by_corner, by_slope], axis=2)
