"""Surfaces of triangles: MESHES 3 to 5, evaluated literally and slowly.

Nothing is shared with the library under test. A region is cut triangle by triangle, and the energy
of its cells is assembled with the slopes and the centres as unknowns.
"""

import collections
import math

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
import scipy.sparse.linalg

from exact_motion import exact_motion
from engine import (GroupSphere, Transform, check_coefficients, damping_of, distances, falloff,
                    find_cycle, smallest_eigenvalue, steps_of_frame, unit_forces, with_integrator)
from maps import check_material
from triangle_mesh import edge, joined

SNAP = 0.1  # a cut nearer to the end of an edge than this part of it goes to that end
THIRD = np.full(3, 1 / 3)


# The region (MESHES 3)


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
        self.may_float = may_float  # whether a piece moves if nothing holds it
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
        self.sort_pieces()

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
        is_node = name < len(self.mesh.rest)
        return bool(is_node and self.mesh.border != "free" and self.mesh.is_border[name])

    def sort_pieces(self):
        """Rule 5: which cells move, and the numbers of each piece."""
        names = sorted({name for cell in self.cells for name in cell}, key=str)
        number = {name: k for k, name in enumerate(names)}
        piece_of = joined(len(names), ((number[cell[0]], number[name]) for cell in self.cells
                                       for name in cell[1:]))
        held = {piece_of[number[name]] for name in names if self.may_float or self.is_held(name)}
        self.moving_cells = np.array([piece_of[number[cell[0]]] in held for cell in self.cells],
                                     dtype=bool)
        self.unknown_names = [name for name in names
                              if not self.is_held(name) and piece_of[number[name]] in held]
        self.moving_nodes = [name for name in self.unknown_names
                             if not isinstance(name, tuple) and name < len(self.mesh.rest)]
        self.pieces = []  # numbers of inside nodes, held nodes and cells
        for piece in sorted(set(piece_of)):
            nodes = [name for name in names if piece_of[number[name]] == piece and
                     not isinstance(name, tuple) and name < len(self.mesh.rest)]
            self.pieces.append((
                sum(bool(self.is_inside[node]) for node in nodes),
                sum(self.is_held(node) for node in nodes),
                sum(piece_of[number[cell[0]]] == piece for cell in self.cells)))

    def held_displacement(self, name, w):
        """MESHES 4: the displacement of a held corner."""
        if isinstance(name, tuple):
            return self.held_displacement(name[1], w)
        if name < len(self.mesh.rest):
            return w[name]
        outside = [node for node in self.mesh.centre_corners[name - len(self.mesh.rest)]
                   if not self.is_inside[node]]
        return w[outside].mean(axis=0)

    def values_at(self, name, values):
        """A function on the mesh's points, carried on to the corners of cells (MESHES 5)."""
        if not isinstance(name, tuple):
            return values[name]
        if name[0] == "part":
            return sum(self.values_at(corner, values) for corner in self.part_corners[name]) / 4
        share = self.share(*name)
        return (1 - share) * values[name[0]] + share * values[name[1]]

    def shared_out(self, integrals):
        """Sums of the cells' integrals (of 3 hats each) at the nodes that move (MESHES 5)."""
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
        """mu of MESHES 5; `reach` is forceRadius - delta at the mesh's points."""
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


# The plate (MESHES 4)


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


def given_slope(normal, tangents, unit):
    x, y = normal
    along_u = tangents["su1"] / unit[0] if x > 0 else -tangents["su0"] / unit[0]
    along_v = tangents["sv1"] / unit[1] if y > 0 else -tangents["sv0"] / unit[1]
    return np.broadcast_to(x * x * along_u + y * y * along_v, 3)


def form_of(b, c, d, mesh, unit, material):
    """The quadratic form of H in one triangle."""
    if mesh.border == "free" or material["has map"]:
        poisson = material["poisson"]
    else:
        poisson = min(0.0, c / (4 * math.sqrt(b * d)) - 0.5)
    b, c, d = b * unit[0]**4, c * unit[0]**2 * unit[1]**2, d * unit[1]**4
    both = poisson * math.sqrt(b * d)
    return np.array([[b, both, 0], [both, d, 0], [0, 0, c - 2 * both]])


def triangle_material(surface, frame):
    """b, c and d of each triangle: the mean of its corners'; density and damping of each node."""
    mesh, material = surface.grid, surface.material(frame)
    for name in "bcd":
        at_points = mesh.at_points(np.broadcast_to(material[name], len(mesh.rest)))
        material[name] = np.array([at_points[list(corners)].mean() for corners in mesh.triangles])
        if name not in surface.maps:
            material[name][:] = surface.sample(name, frame)
    material["poisson"] = surface.sample("poisson", frame)
    material["has map"] = surface.has_stiffness_map
    if surface.has_stiffness_map:
        check_material(material["b"], material["c"], material["d"], material["poisson"])
        nodes = surface.material(frame)
        check_material(nodes["b"], nodes["c"], nodes["d"], material["poisson"])
    return material


class Plate:
    """K and the right-hand side of what is held, for the region's unknowns.

    The first unknowns are the region's `moving_nodes`, then centres, then slopes.
    """

    def __init__(self, region, w, material, tangents):
        mesh, unit = region.mesh, region.mesh.unit
        forms = [form_of(*stiffness, mesh, unit, material)
                 for stiffness in zip(*(material[name] for name in "bcd"))]

        others = [name for name in region.unknown_names if name not in set(region.moving_nodes)]
        number = {name: k for k, name in enumerate(list(region.moving_nodes) + others)}
        count = len(number)
        slopes = {}  # (cell, edge) -> ([(unknown, sign)], given)
        for key, places in region.cells_at.items():
            if not region.moving_cells[places[0][0]]:
                continue
            on = region.edge_of.get(key)
            total = 2 if on is None else mesh.triangles_at[on]
            is_border = total == 1
            is_given = len(places) != total or (is_border and mesh.border == "clamped")
            if is_given:
                for cell, k in places:
                    slopes[cell, k] = [], given_slope(region.normals[cell, k], tangents, unit)
                continue
            if is_border:
                slopes[places[0]] = [(count, 1.0)], np.zeros(3)
                count += 1
                continue
            first = count
            count += total - 1
            for k, place in enumerate(places[:-1]):
                slopes[place] = [(first + k, 1.0)], np.zeros(3)
            slopes[places[-1]] = [(first + k, -1.0) for k in range(total - 1)], np.zeros(3)

        rows, columns, values = [], [], []
        right = np.zeros((count, 3))
        for cell, names in enumerate(region.cells):
            if not region.moving_cells[cell]:
                continue
            known = np.zeros((6, 3))
            place = []  # (row of the cell's six, unknown, sign)
            for k, name in enumerate(names):
                if name in number:
                    place.append((k, number[name], 1.0))
                else:
                    known[k] = region.held_displacement(name, w)
                terms, known[3 + k] = slopes[cell, k]
                place += [(3 + k, unknown, sign) for unknown, sign in terms]
            strain = region.bending[cell]
            form = forms[region.triangles[cell]]
            matrix = region.areas[cell] * strain.T @ form @ strain
            of_six, unknowns, signs = (np.array(column) for column in zip(*place))
            np.add.at(right, unknowns, -signs[:, None] * (matrix @ known)[of_six])
            rows.append(np.repeat(unknowns, len(place)))
            columns.append(np.tile(unknowns, len(place)))
            values.append((np.outer(signs, signs) * matrix[np.ix_(of_six, of_six)]).ravel())
        triplets = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        self.stiffness = scipy.sparse.csc_matrix(triplets, shape=(count, count))
        self.right = right

    def dampings(self, masses, density, ratio):
        """Of each node that moves, by the slowest vibration of its piece."""
        nodes = int((masses > 0).sum())
        damping = np.zeros(nodes)
        count, piece_of = scipy.sparse.csgraph.connected_components(self.stiffness, directed=False)
        for piece in range(count):
            own = np.nonzero(piece_of == piece)[0]
            heavy, light = own[own < nodes], own[own >= nodes]
            if density == 0 or not len(heavy):
                continue
            stiffness = self.stiffness[heavy][:, heavy].toarray()
            if len(light):
                across = self.stiffness[heavy][:, light].toarray()
                stiffness -= across @ np.linalg.solve(self.stiffness[light][:, light].toarray(),
                                                      across.T)
            damping[heavy] = damping_of(ratio, density,
                                        smallest_eigenvalue(stiffness, masses[heavy]))
        return damping


def advance(w, velocity, region, load, material, tangents, count, dt):
    """`count` backward Euler steps of the nodes that move; returns w and velocity."""
    plate = Plate(region, w, material, tangents)
    nodes = region.moving_nodes
    # Numbers, or a column of the nodes where there is a map.
    density, damping = (value if np.ndim(value) == 0 else value[nodes][:, None]
                        for value in (material["density"], material["damping"]))
    masses = np.zeros(len(plate.right))
    masses[:len(nodes)] = region.masses()
    if material["dampingRatio"] is not None:
        damping = plate.dampings(masses, density, material["dampingRatio"])[:, None]
    inertia = np.broadcast_to(density / dt**2 + damping / dt, (len(nodes), 1))
    shifts = np.zeros(len(masses))
    shifts[:len(nodes)] = inertia[:, 0] * masses[:len(nodes)]
    matrix = (plate.stiffness + scipy.sparse.diags(shifts)).tocsc()
    factor = scipy.sparse.linalg.splu(matrix)
    unknown, speed = w[nodes], velocity[nodes]
    weight = masses[:len(nodes), None]
    for _ in range(count):
        right = plate.right.copy()
        right[:len(nodes)] += load + weight * (
            inertia * unknown + density / dt * speed)
        solution = factor.solve(right)
        solution += factor.solve(right - matrix @ solution)  # iterative refinement
        solution = solution[:len(nodes)]
        speed = (solution - unknown) / dt
        unknown = solution
    w, velocity = w.copy(), np.zeros_like(velocity)
    w[nodes], velocity[nodes] = unknown, speed
    return w, velocity


def advance_exactly(w, velocity, region, loads, material, tangents, time):
    """The exact solution; `loads` and `tangents` are those at both ends of the frame."""
    nodes = region.moving_nodes
    forces = []
    for load, slopes in zip(loads, tangents):
        plate = Plate(region, w, material, slopes)
        force = plate.right.copy()
        force[:len(nodes)] += load
        forces.append(force)
    w, velocity, start, speed = w.copy(), np.zeros_like(velocity), w[nodes], velocity[nodes]
    w[nodes], velocity[nodes] = exact_motion(
        plate.stiffness.tocsc(), region.masses(), material, forces, start, speed, time)
    return w, velocity


# The run (MESHES 5, SPEC 6)


class TriangleRun:
    """The state of one surface: displacements, and the velocities of the last solve."""

    def __init__(self, scene, surface, diagnostics, noise=None):
        self.scene, self.surface, self.diagnostics, self.noise = scene, surface, diagnostics, noise
        self.mesh = surface.grid
        self.regions = {}  # by the bytes of phi
        self.regions_at = {}  # by the frame
        self.reset()

    def reset(self):
        self.w = np.zeros_like(self.mesh.rest)
        self.velocity = np.zeros_like(self.w)
        self.unsettled = np.zeros(len(self.w), dtype=bool)
        self.last_load, self.last_tangents = np.zeros_like(self.w), {}
        self.was_unknown = np.zeros(len(self.w), dtype=bool)

    def rest_at(self, frame):
        """R of the nodes."""
        return self.mesh.of_nodes(self.surface.shape.at(frame))

    parts = ("w", "velocity", "unsettled", "last_load", "was_unknown", "last_tangents")

    def displacement(self, w):
        return float(np.linalg.norm(w, axis=-1).max())

    def enabled_forces(self, frame):
        """The forces that push, groups' included, and what selects: (force, radius)."""
        def acts(item):
            is_target = item.targets is None or self.surface.name in item.targets
            return is_target and item.enabled(frame)[0] != 0

        pushing = [force for force in self.scene.forces if acts(force)]
        selecting = [(force, force.sample("deformationRadius", frame)) for force in pushing]
        for group in self.scene.groups:
            if acts(group):
                pushing += [force for force in group.forces if acts(force)]
                selecting.append((GroupSphere(group), float(group.deformation_radius(frame)[0])))
        return pushing, selecting

    def region(self, frame, selecting, transform):
        """MESHES 3, and 5 for `recover`."""
        mesh = self.mesh
        if self.surface.is_whole:
            if "all" not in self.regions:
                phi = mesh.at_points(np.ones(len(mesh.rest)))
                self.regions["all"] = Region(mesh, phi, may_float=True)
            return self.regions["all"]
        points = transform.to_world(self.rest_at(frame))
        is_untouched = np.full((len(points), 1), transform.is_identity)
        node_phi = np.full(len(points), -1.0)
        for k, (force, radius) in enumerate(selecting):
            depth = radius - distances(force, frame, points)
            node_phi = depth if k == 0 else np.maximum(node_phi, depth)
            self.diagnostics.note_distances(force, frame, points[:, None], is_untouched, [radius])
        phi = snapped(mesh, mesh.at_points(node_phi), self.diagnostics)
        if self.surface.choices["release"] == "recover":
            still = np.nonzero(self.unsettled & ~(phi[:len(points)] > 0))[0]
            self.diagnostics.recovering += len(still)
            # Nothing but the sign matters: no edge of these faces is cut.
            phi[still] = 1
            for k in {k for node in still for k in mesh.faces_of_node[node]}:
                nodes, centre = mesh.faces[k]
                phi[nodes] = np.maximum(phi[nodes], 0)
                if centre is not None:
                    phi[centre] = 1
        key = phi.tobytes()
        if key not in self.regions:
            self.regions[key] = Region(mesh, phi)
        return self.regions[key]

    def solve(self, frame):
        """The solve at `frame`, which computes the mesh of frame + 1."""
        mesh, surface = self.mesh, self.surface
        pushing, selecting = self.enabled_forces(frame)
        transform = Transform(surface, frame)
        is_current = surface.choices["measure"] == "current"
        rest = self.rest_at(frame)
        points = transform.to_world(rest + self.w if is_current else rest)
        region = self.region(frame, selecting, transform)
        nodes = region.moving_nodes
        self.regions_at[frame] = region
        recovers = surface.choices["release"] == "recover"
        if recovers:
            is_back = np.array([region.is_held(node) for node in range(len(self.w))])
            self.w[is_back] = 0
            self.velocity[is_back] = 0
            self.was_unknown[is_back] = False
        if not nodes:
            self.diagnostics.skips.append((frame, surface.name, "no node"))
            return
        self.diagnostics.solves.append((frame, surface.name, len(nodes)))
        load = np.zeros((len(nodes), 3))
        for force in pushing:
            delta = distances(force, frame, points)
            radius = force.sample("forceRadius", frame)
            share = region.load_areas(mesh.at_points(radius - delta))
            is_pushed = share != 0
            if not is_pushed.any():
                continue
            at = np.array(nodes)[is_pushed]
            strength = force.sample("magnitude", frame) * falloff(force, delta[at] / radius)
            push = unit_forces(force, frame, points[at], self, at)
            if force.kind == "inertia" and "density" in surface.maps:
                push = push * surface.maps["density"][at][:, None]
            load[is_pushed] += (share[is_pushed] * strength)[:, None] * push
        load = transform.vector_to_object(load)
        material = triangle_material(surface, frame)
        ratio = surface.channels["dampingRatio"]
        material["dampingRatio"] = None if ratio is None else surface.sample("dampingRatio", frame)
        tangents = {name: surface.channels[name](frame) for name in ("su0", "su1", "sv0", "sv1")}
        length = surface.frame_length(frame, self.scene.fps)
        count, dt = steps_of_frame(length, surface.sample("dt", frame), surface.choices["stepping"])
        if surface.choices["integrator"] == "exact":
            first = np.where(self.was_unknown[nodes][:, None], self.last_load[nodes], load)
            first_tangents = self.last_tangents if self.was_unknown.any() else tangents
            w, velocity = advance_exactly(self.w, self.velocity, region, (first, load), material,
                                          (first_tangents, tangents), length)
        else:
            w, velocity = with_integrator(
                surface.choices["integrator"], material["density"], advance)(
                self.w, self.velocity, region, load, material, tangents, count, dt)
        self.last_load, self.was_unknown = np.zeros_like(self.w), np.zeros_like(self.was_unknown)
        self.last_load[nodes], self.was_unknown[nodes] = load, True
        self.last_tangents = tangents
        w, speed = w[nodes], velocity[nodes]
        before = self.w[nodes]
        if self.noise is not None:  # simulates another implementation's rounding
            w = w * (1 + 1e-12 * self.noise.standard_normal(w.shape))
        self.w[nodes] = w
        self.velocity[:] = 0
        self.velocity[nodes] = speed
        if recovers:
            moved = np.maximum(np.linalg.norm(w, axis=-1), np.linalg.norm(w - before, axis=-1))
            length = 1e-6 * mesh.diagonal
            # Those of a piece that nothing holds stay where they are.
            self.unsettled = np.linalg.norm(self.w, axis=-1) >= length
            self.unsettled[nodes] = moved >= length
            self.diagnostics.settle_margin = min(self.diagnostics.settle_margin,
                                                 float(np.abs(moved / length - 1).min()))
        assert np.isfinite(self.w).all(), f"not finite after frame {frame}"

    def run(self):
        """Yields (object positions of the vertices, transform) of each frame."""
        frames = range(min(self.scene.start, self.surface.start_frame), self.scene.end + 1)
        for frame in frames:
            check_coefficients(*(self.surface.sample(name, frame)
                                 for name in ("density", "damping", "b", "c", "d", "dt")))
        first, loop = self.surface.start_frame, self.surface.loop
        if loop:
            states = find_cycle(self, range(first, first + loop))
            for frame in frames:
                w = np.zeros_like(self.w)
                solved = first + (frame - first) % loop
                if frame >= first:
                    w = states[solved - first][0]
                    if solved in self.regions_at:
                        self.regions_at[frame] = self.regions_at[solved]
                shape = self.surface.shape.at(solved)
                yield self.mesh.displaced(shape, w), Transform(self.surface, frame)
            return
        for frame in frames:
            if frame <= self.surface.start_frame:
                self.reset()
            if frame >= self.scene.start:
                shape = self.surface.shape.at(frame)
                yield self.mesh.displaced(shape, self.w), Transform(self.surface, frame)
            if self.surface.is_solved_at(frame):
                self.solve(frame)
