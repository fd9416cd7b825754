"""The plate on triangles (SPEC 8, "Plate"), with the slopes and the centres as unknowns, and its steps."""

import math

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
import scipy.sparse.linalg

from exact_motion import exact_motion
from maps import check_material, check_yield
from plasticity import Flow, plastic_step
from stepping import damping_of, slowest_vibration


def given_slope(normal, tangents, unit):
    x, y = normal
    along_u = tangents["su1"] / unit[0] if x > 0 else -tangents["su0"] / unit[0]
    along_v = tangents["sv1"] / unit[1] if y > 0 else -tangents["sv0"] / unit[1]
    return np.broadcast_to(x * x * along_u + y * y * along_v, 3)


def form_of(b, c, d, mesh, unit, material):
    """The quadratic form of H in one triangle."""
    poisson = material["poisson"] if mesh.border == "free" else min(0.0, c / (4 * math.sqrt(b * d)) - 0.5)
    b, c, d = b * unit[0]**4, c * unit[0]**2 * unit[1]**2, d * unit[1]**4
    both = poisson * math.sqrt(b * d)
    return np.array([[b, both, 0], [both, d, 0], [0, 0, c - 2 * both]])


def triangle_material(surface, frame):
    """b, c, d, yield and hardening of each triangle: the mean of its corners'; density, damping and goal
    of each node."""
    mesh, material = surface.grid, surface.material(frame)
    for name in {"b", "c", "d", "yield", "hardening"} & set(material):
        at_points = mesh.at_points(np.broadcast_to(material[name], len(mesh.rest)))
        material[name] = np.array([at_points[list(corners)].mean() for corners in mesh.triangles])
        if name not in surface.maps:
            material[name][:] = surface.sample(name, frame)
    material["poisson"] = surface.sample("poisson", frame)
    if surface.yields:
        check_yield(surface.material(frame), surface.sample("timeScale", frame))
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
        self.forms = [form_of(*stiffness, mesh, unit, material)
                      for stiffness in zip(*(material[name] for name in "bcd"))]
        self.strains = {}  # of cells that move: unknowns, 3 rows of their weights, what is known

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
            form = self.forms[region.triangles[cell]]
            matrix = region.areas[cell] * strain.T @ form @ strain
            of_six, unknowns, signs = (np.array(column) for column in zip(*place))
            self.strains[cell] = unknowns, strain[:, of_six] * signs, strain @ known
            np.add.at(right, unknowns, -signs[:, None] * (matrix @ known)[of_six])
            rows.append(np.repeat(unknowns, len(place)))
            columns.append(np.tile(unknowns, len(place)))
            values.append((np.outer(signs, signs) * matrix[np.ix_(of_six, of_six)]).ravel())
        triplets = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        self.stiffness = scipy.sparse.csc_matrix(triplets, shape=(count, count))
        goals = np.zeros(count)
        nodes = region.moving_nodes
        goals[:len(nodes)] = region.masses() * np.broadcast_to(material["goal"], len(mesh.rest))[nodes]
        self.stiffness = (self.stiffness + scipy.sparse.diags(goals)).tocsc()
        self.right = right

    def dampings(self, masses, density, ratio):
        """Of each node that moves, by the slowest vibration of its patch; `masses` are areas."""
        nodes = len(masses)
        damping = np.zeros(nodes)
        density = np.broadcast_to(density, nodes)
        weights = np.zeros(len(self.right))
        weights[:nodes] = masses * density
        count, patch_of = scipy.sparse.csgraph.connected_components(self.stiffness, directed=False)
        for patch in range(count):
            own = np.nonzero(patch_of == patch)[0]
            omega = slowest_vibration(self.stiffness[own][:, own].tocsc(), weights[own])
            own = own[own < nodes]
            damping[own] = damping_of(ratio, density[own], omega)
        return damping


def with_damping(plate, region, material):
    """Density and damping: numbers, or those of the nodes that move where they differ."""
    nodes, masses = region.moving_nodes, region.masses()
    density, damping = (value if np.ndim(value) == 0 else value[nodes]
                        for value in (material["density"], material["damping"]))
    if material["dampingRatio"] is not None:
        damping = plate.dampings(masses, density, material["dampingRatio"])
    return np.broadcast_to(density, len(nodes)), np.broadcast_to(damping, len(nodes)), masses


class Steps:
    """Backward Euler steps of the nodes that move, and of the plastic curvatures of all triangles;
    w gives what is held."""

    def __init__(self, w, region, load, material, tangents):
        plate = Plate(region, w, material, tangents)
        self.nodes, self.stiffness, self.known = region.moving_nodes, plate.stiffness, plate.right
        self.known[:len(self.nodes)] += load
        self.whole = []  # density and damping of the unknowns
        *values, masses = with_damping(plate, region, material)
        for value in values:
            self.whole.append(np.zeros(len(self.known)))
            self.whole[-1][:len(self.nodes)] = masses * value
        self.flow = None
        if "yield" in material:
            self.flow, self.triangles = flow_of_triangles(plate, region, material)

    def __call__(self, w, velocity, plastic, count, dt):
        nodes = self.nodes
        unknown, speed = np.zeros_like(self.known), np.zeros_like(self.known)
        unknown[:len(nodes)], speed[:len(nodes)] = w[nodes], velocity[nodes]
        if self.flow is None:
            unknown, speed = self.elastic(unknown, speed, count, dt)
        else:
            plastic, flowing = plastic.copy(), plastic[self.triangles]
            for _ in range(count):
                unknown, speed, flowing = plastic_step(self.flow, self.stiffness, self.known,
                                                       *self.whole, unknown, speed, flowing, dt)
            plastic[self.triangles] = flowing
        w, velocity = w.copy(), np.zeros_like(velocity)
        w[nodes], velocity[nodes] = unknown[:len(nodes)], speed[:len(nodes)]
        return w, velocity, plastic

    def elastic(self, unknown, speed, count, dt):
        density, damping = self.whole
        shift = density / dt**2 + damping / dt
        matrix = (self.stiffness + scipy.sparse.diags(shift)).tocsc()
        factor = scipy.sparse.linalg.splu(matrix)
        for _ in range(count):
            right = self.known + shift[:, None] * unknown + (density / dt)[:, None] * speed
            solution = factor.solve(right)
            solution += factor.solve(right - matrix @ solution)  # iterative refinement
            speed = (solution - unknown) / dt
            unknown = solution
        return unknown, speed


def flow_of_triangles(plate, region, material):
    """How the triangles that have cells which move flow, and their numbers (SPEC 9): their curvatures
    are the mean over these cells."""
    triangles = sorted({region.triangles[cell] for cell in plate.strains})
    place = {t: k for k, t in enumerate(triangles)}
    area = np.zeros(len(triangles))
    for cell in plate.strains:
        area[place[region.triangles[cell]]] += region.areas[cell]
    at, unknown, value = [], [], [[], [], []]
    constants = np.zeros((len(triangles), 3, 3))
    for cell, (unknowns, strain, constant) in plate.strains.items():
        number = place[region.triangles[cell]]
        share = region.areas[cell] / area[number]
        constants[number] += share * constant
        at.append(np.full(len(unknowns), number))
        unknown.append(unknowns)
        for a in range(3):
            value[a].append(share * strain[a])
    at, unknown = np.concatenate(at), np.concatenate(unknown)
    rows = [scipy.sparse.csr_matrix((np.concatenate(x), (at, unknown)),
                                    shape=(len(triangles), len(plate.right))) for x in value]
    flow = Flow(rows, constants,
                np.array([plate.forms[t] for t in triangles]), area,
                np.ones((len(triangles), 3), dtype=bool), material["yield"][triangles],
                material["hardening"][triangles])
    return flow, triangles


def advance_exactly(w, velocity, region, loads, material, tangents, time):
    """The exact solution; `loads` and `tangents` are those at both ends of the frame."""
    nodes = region.moving_nodes
    forces = []
    for load, slopes in zip(loads, tangents):
        plate = Plate(region, w, material, slopes)
        force = plate.right.copy()
        force[:len(nodes)] += load
        forces.append(force)
    density, damping, masses = with_damping(plate, region, material)
    w, velocity, start, speed = w.copy(), np.zeros_like(velocity), w[nodes], velocity[nodes]
    w[nodes], velocity[nodes] = exact_motion(
        plate.stiffness.tocsc(), masses, {"density": density, "damping": damping}, forces, start,
        speed, time)
    return w, velocity
