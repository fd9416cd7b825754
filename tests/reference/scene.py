"""Reads scene files and meshes, trusting them (docs/scene-format.md; SPEC 1).

Supports only features of the reference engine; anything else fails an assertion.
"""

import os
import xml.etree.ElementTree as ElementTree
from fractions import Fraction

import numpy as np

from caches import Cache, NoCache
from carrier import Carrier
from contact_mesh import ClosedMesh
from curves import Constant, Curve, Key
from maps import node_uvs, read_holds, read_maps
from triangle_mesh import TriangleMesh, read_obj_corners

TRANSFORM_CHANNELS = {"translate": (0, 0, 0), "rotate": (0, 0, 0), "scale": (1, 1, 1)}
MATERIAL_CHANNELS = {"density": 1, "damping": 1, "b": 1, "c": 2, "d": 1, "poisson": 0.3,
                     "dampingRatio": None, "yield": None, "hardening": 0.1, "goal": 0}
TANGENT_CHANNELS = {"su0": 0, "su1": 0, "sv0": 0, "sv1": 0}
SOLVER_CHANNELS = {"dt": 0.01, "timeScale": 1}
SOLVER_CHOICES = {
    "stepping": ("exact", "overshoot"), "reference": ("rest", "none"),
    "combine": ("box", "islands", "union"), "release": ("freeze", "recover"), "measure": ("current", "rest"),
    "integrator": ("backwardEuler", "newmark", "exact"),
    "region": ("forces", "all")}
FORCE_CHANNELS = {"magnitude": 0, "deformationRadius": 1, "forceRadius": 1}
KIND_CHANNELS = {
    "point": {"center": (0, 0, 0), "direction": (0, 1, 0)},
    "radial": {"center": (0, 0, 0)},
    "line": {"from": (0, 0, 0), "to": (1, 0, 0), "direction": None},
    "uniform": {"direction": (0, 1, 0)},
    "vortex": {"center": (0, 0, 0), "axis": (0, 1, 0), "pull": 0},
    "noise": {"center": (0, 0, 0), "frequency": 1, "rate": 1},
    "inertia": {"magnitude": 1},
    "pressure": {"center": (0, 0, 0)}}
SOLID_CHANNELS = {
    "sphere": {"radius": 1},
    "capsule": {"radius": 0.5, "length": 1},
    "box": {"size": (1, 1, 1), "round": 0},
    "plane": {},
    "mesh": {}}
PLACES, DIRECTIONS = ("center", "from", "to"), ("direction", "axis")
FALLOFFS = ("constant", "linear", "smooth", "gaussian")
TANGENT_KINDS = ("auto", "spline", "flat", "linear", "plateau")
LOOPS = ("repeat", "repeatOffset", "mirror")


def numbers(text):
    """The numbers of an attribute; `true` and `false` count as 1 and 0."""
    return np.array([{"true": 1.0, "false": 0.0}.get(word) if word in ("true", "false")
                     else float(word) for word in text.split()])


# Channels


def read_tangent(text):
    return text if text in TANGENT_KINDS else numbers(text)


def read_outside(text):
    """`before` or `after`: the mode with its slope or its number of copies."""
    kind, *rest = text.split()
    if kind == "slope":
        return kind, np.array([float(word) for word in rest])
    if kind in LOOPS:
        return kind, int(rest[0]) if rest else None
    assert kind in ("hold", "linear", "linearOuter") and not rest, text
    return kind, None


def read_keys(element, time_attribute, is_boolean=False):
    """The keys of an <animate> or a <falloff>, with the element's defaults applied."""
    assert element.get("overshoot", "limit") == "limit" and element.find("loop") is None
    default_tangent = element.get("tangent", "auto")
    default_interpolation = element.get("interpolation", "bezier")
    known = {time_attribute, "value", "interpolation", "tangent", "in", "out", "inLength",
             "outLength"}
    keys = []
    for child in element.findall("key"):
        assert set(child.keys()) <= known, child.attrib
        both = child.get("tangent", default_tangent)
        lengths = [float(child.get(name)) if name in child.keys() else None
                   for name in ("inLength", "outLength")]
        interpolation = child.get("interpolation", default_interpolation)
        keys.append(Key(float(child.get(time_attribute)), numbers(child.get("value")),
                        "step" if is_boolean else interpolation,
                        read_tangent(child.get("in", both)), read_tangent(child.get("out", both)),
                        *lengths))
    return keys


def read_channel(element, owner, name, default, is_boolean=False):
    """A channel of `element`, constant or animated; `owner` holds the <animate> children.

    A transform, material, tangents or solver element is its own owner. None without a default.
    """
    for animate in owner.findall("animate"):
        if animate.get("attribute") == name:
            assert name not in element.keys(), f"{name} is both given and animated"
            return Curve(read_keys(animate, "frame", is_boolean),
                         read_outside(animate.get("before", "hold")),
                         read_outside(animate.get("after", "hold")))
    if name in element.keys():
        return Constant(numbers(element.get(name)))
    return None if default is None else Constant(default)


# Meshes (SPEC 1)


class Grid:
    """Vertices with their lattice: `node_of[k]` is the (i, j) of vertex k, `rest` is M x N x 3."""

    def __init__(self, vertices, u, v, faces):
        self.vertices = vertices
        column, self.hu, self.columns = lattice_index(u)
        row, self.hv, self.rows = lattice_index(v)
        self.node_of = np.stack([column, row], axis=1)
        self.rest = np.full((self.columns, self.rows, 3), np.nan)
        for (i, j), position in zip(self.node_of, vertices):
            is_new = np.isnan(self.rest[i, j, 0])
            assert is_new or (self.rest[i, j] == position).all(), f"node {i},{j} has two positions"
            self.rest[i, j] = position
        assert not np.isnan(self.rest).any(), "a node without a vertex"
        self.uvs = np.full((self.columns, self.rows, 2), np.nan)
        for k in range(len(vertices) - 1, -1, -1):  # the lowest vertex last
            self.uvs[tuple(self.node_of[k])] = u[k], v[k]
        # As numbers of nodes, row by row of an array of nodes.
        self.face_nodes = [[int(i) * self.rows + int(j) for i, j in self.node_of[face]] for face in faces]

    def to_vertices(self, node_values):
        """Values per vertex, in the order of the source mesh."""
        return node_values[self.node_of[:, 0], self.node_of[:, 1]]

    def of_nodes(self, vertices):
        """Positions of vertices as those of nodes: of the lowest vertex of each."""
        result = np.empty_like(self.rest)
        for (i, j), position in zip(self.node_of[::-1], vertices[::-1]):
            result[i, j] = position
        return result


def lattice_index(values):
    """Lattice index of each u (or v), the spacing and the number of columns (SPEC 1)."""
    values = np.asarray(values, dtype=float)
    ordered = np.sort(values)
    gaps = np.diff(ordered)
    count = 1 + int(np.sum(gaps > 0.5 * gaps.max()))
    spacing = (ordered[-1] - ordered[0]) / (count - 1)
    index = np.rint((values - ordered[0]) / spacing).astype(int)
    uneven = np.abs(values - (ordered[0] + index * spacing))
    assert count >= 3 and (uneven <= 1e-2 * spacing).all(), "spacing is not even"
    return index, spacing, count


def flat_grid(element):
    """A <grid>: vertex j*columns + i at node (i, j), in the xz-plane, u with x and v with z. With
    uv="surface" its faces are read as those of a mesh."""
    columns, rows = int(element.get("columns")), int(element.get("rows"))
    width, depth = float(element.get("width", "1")), float(element.get("depth", "1"))
    vertices, u, v = [], [], []
    for j in range(rows):
        for i in range(columns):
            x = width * (2 * i - (columns - 1)) / (2 * (columns - 1))
            z = depth * (2 * j - (rows - 1)) / (2 * (rows - 1))
            vertices.append((x, 0.0, z))
            u.append(i / (columns - 1))
            v.append(j / (rows - 1))
    faces = []
    for first in (j * columns + i for j in range(rows - 1) for i in range(columns - 1)):
        quad = [first, first + columns, first + columns + 1, first + 1]
        is_split = element.get("faces", "quads") == "triangles"
        faces += [quad[:3], [quad[0], quad[2], quad[3]]] if is_split else [quad]
    if element.get("uv", "grid") != "surface":
        assert not {"unit", "axis", "border"} & set(element.keys())
        return Grid(np.array(vertices), u, v, faces)
    corners = [[(k, np.array([u[k], v[k]])) for k in face] for face in faces]
    return triangle_mesh(element, np.array(vertices), corners, [width, depth])


def read_obj(path):
    """A <mesh>: positions in file order, and the single (u,v) of each, from the faces."""
    positions, faces = read_obj_corners(path)
    uv_of = {}
    for vertex, uv in (corner for face in faces for corner in face):
        assert tuple(uv_of.setdefault(vertex, uv)) == tuple(uv), "a vertex with several UVs"
    u, v = zip(*(uv_of[k] for k in range(len(positions))))
    return Grid(positions, u, v, [[vertex for vertex, _ in face] for face in faces])


def read_surface(element, folder):
    """A <mesh> that is read as a surface of triangles (SPEC 1)."""
    assert set(element.keys()) <= {"file", "uv", "unit", "axis", "border", "weld"}
    vertices, faces = read_obj_corners(os.path.join(folder, element.get("file")))
    return triangle_mesh(element, vertices, faces)


def read_closed_mesh(element, folder, scene_start, fps):
    """The <mesh> of a collider."""
    assert set(element.keys()) <= {"file", "cache", "cacheStart"}
    vertices, faces = read_obj_corners(os.path.join(folder, element.get("file")))
    shape = NoCache(vertices)
    if "cache" in element.keys():
        first = float(element.get("cacheStart")) if "cacheStart" in element.keys() else None
        shape = Cache(os.path.join(folder, element.get("cache")), fps, scene_start, first)
    return ClosedMesh(vertices, faces, shape)


def triangle_mesh(element, vertices, faces, unit=None):
    """A surface of triangles as the attributes of its element say; without a unit this one."""
    read = {name: numbers(element.get(name)) for name in ("unit", "axis", "weld")
            if name in element.keys()}
    if "weld" in read:
        read["weld"] = float(read["weld"][0])
    read.setdefault("unit", unit)
    mesh = TriangleMesh(vertices, faces, border=element.get("border", "clamped"), **read)
    mesh.uvs = node_uvs(mesh.node_of, faces, (len(mesh.rest),))
    return mesh


# Elements


def child_or_empty(element, tag):
    child = element.find(tag)
    return child if child is not None else ElementTree.Element(tag)


class Surface:
    """A <surface> with its channels."""

    def __init__(self, element, folder, scene_start, fps):
        self.name = element.get("name")
        self.is_enabled = element.get("enabled", "true") == "true"
        grid, mesh = element.find("grid"), element.find("mesh")
        shape = mesh if grid is None else grid
        cache, first = shape.get("cache"), shape.get("cacheStart")
        # Not among what the readers of meshes know.
        for name in ("cache", "cacheStart"):
            shape.attrib.pop(name, None)
        if grid is not None:
            self.grid = flat_grid(grid)
        elif mesh.get("uv") == "surface":
            self.grid = read_surface(mesh, folder)
        else:
            assert set(mesh.keys()) <= {"file", "uv", "wrap"} and mesh.get("uv", "grid") == "grid"
            assert mesh.get("wrap", "none") == "none"
            self.grid = read_obj(os.path.join(folder, mesh.get("file")))
        self.shape = NoCache(self.grid.vertices)
        self.is_animated = cache is not None
        if cache is not None:
            first = None if first is None else float(first)
            self.shape = Cache(os.path.join(folder, cache), fps, scene_start, first)
            assert self.shape.samples.shape[1] == len(self.grid.vertices)
        self.channels = {}
        solver = child_or_empty(element, "solver")
        for tag, defaults in (("transform", TRANSFORM_CHANNELS), ("material", MATERIAL_CHANNELS),
                              ("tangents", TANGENT_CHANNELS), ("solver", SOLVER_CHANNELS)):
            part = child_or_empty(element, tag)
            for name, default in defaults.items():
                self.channels[name] = read_channel(part, part, name, default)
        self.rotate_order = child_or_empty(element, "transform").get("rotateOrder", "xyz")
        self.choices = {}
        for name, allowed in SOLVER_CHOICES.items():
            self.choices[name] = solver.get(name, allowed[0])
            assert self.choices[name] in allowed, f"{name}={self.choices[name]}"
        assert cache is None or self.choices["reference"] == "rest"
        if isinstance(self.grid, TriangleMesh):
            assert self.choices["reference"] == "rest"
            self.choices["measure"] = solver.get("measure", "rest")
        self.is_whole = self.choices["region"] == "all"
        if self.is_whole:
            assert self.choices["reference"] == "rest" and self.choices["combine"] == "box"
            assert self.choices["release"] == "freeze"
        def path_of(file):
            return os.path.join(folder, file)

        self.maps = read_maps(child_or_empty(element, "material"), path_of, self.grid.uvs)
        self.held = self.grid.held = read_holds(element, path_of, self.grid.uvs, self.grid.node_of)
        assert not self.held.any() or self.choices["combine"] != "union"
        self.has_stiffness_map = any(channel in self.maps for channel in "bcd")
        assert not (self.has_stiffness_map and self.choices["combine"] == "union")
        edges = solver.get("edges", "clamped").split()
        self.edges = tuple(edges * 4 if len(edges) == 1 else edges)
        assert len(self.edges) == 4 and set(self.edges) <= {"clamped", "pinned", "free"}
        assert self.is_whole or set(self.edges) == {"clamped"}
        self.yields = self.channels["yield"] is not None
        self.has_energy = set(self.edges) != {"clamped"} or bool(self.maps) or self.yields or self.held.any()
        # An earlier start acts as the scene's start.
        self.start_frame = max(int(solver.get("startFrame", scene_start)), scene_start)
        self.start_frame -= int(solver.get("preroll", 0))
        self.loop = int(solver.get("loop")) if "loop" in solver.keys() else None
        assert self.loop is None or "preroll" not in solver.keys()
        material = child_or_empty(element, "material")
        assert self.channels["dampingRatio"] is None or "damping" not in material.keys()
        if self.yields:
            assert self.choices["integrator"] != "exact" and self.choices["reference"] == "rest"
            assert self.choices["combine"] != "union" and self.choices["release"] == "freeze"
            assert self.loop is None
        assert self.yields or not {"yield", "hardening"} & set(self.maps)

    def sample(self, name, frame):
        """A scalar channel at a frame."""
        value = self.channels[name](frame)
        assert len(value) == 1
        return float(value[0])

    def material(self, frame):
        """The material at a frame: numbers, and arrays of the nodes where there is a map."""
        names = ["density", "damping", "b", "c", "d", "goal"] + ["yield", "hardening"] * self.yields
        return {name: self.sample(name, frame) * self.maps.get(name, 1.0) for name in names}

    def frame_length(self, frame, fps):
        """Seconds of a frame in the surface's own time."""
        return self.sample("timeScale", frame) / float(fps)

    def is_solved_at(self, frame):
        return self.is_enabled and frame >= self.start_frame and self.sample("timeScale", frame) > 0


class Follower:
    """What may follow a surface: its places and directions are in the object space of that one."""

    carrier = None  # of the surface that it follows

    def carried(self, name, frame, value):
        if self.carrier is None or value is None or name not in PLACES + DIRECTIONS:
            return value
        if name in PLACES:
            return self.carrier.place(frame, value)
        return self.carrier.turn(frame, self.first_place(frame)) @ value

    def first_place(self, frame):
        channel = self.center if hasattr(self, "center") else self.channels[
            "from" if self.kind == "line" else "center"]
        return channel(frame)


class Force(Follower):
    """A force of any kind; a child of a group has no region of its own."""

    def __init__(self, element, is_in_group, scene_seed):
        self.follow, self.along = element.get("follow"), element.get("along", "free")
        self.kind = element.tag
        self.name = element.get("name")
        self.targets = element.get("targets", "").split() if "targets" in element.keys() else None
        self.is_in_group = is_in_group
        self.seed = int(element.get("seed", scene_seed))
        self.enabled = read_channel(element, element, "enabled", 1, is_boolean=True)
        self.channels = {
            name: read_channel(element, element, name, default)
            for name, default in {**FORCE_CHANNELS, **KIND_CHANNELS[self.kind]}.items()}
        self.falloff = element.get("falloff", "constant")
        authored = element.find("falloff")
        if authored is not None:
            self.falloff = Curve(read_keys(authored, "at"))
        else:
            assert self.falloff in FALLOFFS, self.falloff

    def sample(self, name, frame):
        """A channel at a frame: a number, a vector, or None for a missing direction."""
        channel = self.channels[name]
        if channel is None:
            return None
        value = channel(frame)
        return float(value[0]) if len(value) == 1 else self.carried(name, frame, value)


class Group(Follower):
    """A <group>: one deformation region, and forces that only add force (SPEC 7)."""

    def __init__(self, element, scene_seed):
        self.follow = element.get("follow")
        self.name = element.get("name")
        self.targets = element.get("targets", "").split() if "targets" in element.keys() else None
        self.enabled = read_channel(element, element, "enabled", 1, is_boolean=True)
        self.center = read_channel(element, element, "center", (0, 0, 0))
        self.deformation_radius = read_channel(element, element, "deformationRadius", 1)
        self.forces = [Force(child, True, scene_seed) for child in element
                       if child.tag in KIND_CHANNELS]

    def place(self, frame):
        return self.carried("center", frame, self.center(frame))


class Collider:
    """A <collider>."""

    def __init__(self, element, folder, scene_start, fps):
        self.name = element.get("name")
        self.targets = element.get("targets", "").split() if "targets" in element.keys() else None
        self.stick = read_channel(element, element, "stick", 0, is_boolean=True)
        self.enabled = read_channel(element, element, "enabled", 1, is_boolean=True)
        shape, = (child for child in element if child.tag in SOLID_CHANNELS)
        transform = child_or_empty(element, "transform")
        self.kind, self.rotate_order = shape.tag, transform.get("rotateOrder", "xyz")
        if shape.tag == "mesh":
            self.kind = read_closed_mesh(shape, folder, scene_start, fps)
        self.channels = {name: read_channel(element, element, name, default)
                         for name, default in (("deformationRadius", 1), ("offset", 0), ("friction", 0))}
        for part, defaults in ((shape, SOLID_CHANNELS[shape.tag]), (transform, TRANSFORM_CHANNELS)):
            for name, default in defaults.items():
                self.channels[name] = read_channel(part, part, name, default)

    def sample(self, name, frame):
        return float(self.channels[name](frame)[0])


class Scene:
    """A whole scene."""

    def __init__(self, path):
        root = ElementTree.parse(path).getroot()
        assert root.tag == "scene" and root.get("version") == "1"
        self.fps = Fraction(root.get("fps", "24"))
        self.start, self.end = int(root.get("start")), int(root.get("end"))
        seed = int(root.get("seed", 0))
        folder = os.path.dirname(os.path.abspath(path))
        self.surfaces, self.forces, self.groups, self.colliders = [], [], [], []
        for element in root:
            if element.tag == "surface":
                self.surfaces.append(Surface(element, folder, self.start, self.fps))
            elif element.tag in KIND_CHANNELS:
                self.forces.append(Force(element, False, seed))
            elif element.tag == "collider":
                self.colliders.append(Collider(element, folder, self.start, self.fps))
            else:
                assert element.tag == "group", element.tag
                self.groups.append(Group(element, seed))
        surfaces = {surface.name: surface for surface in self.surfaces}
        followers = self.forces + self.groups + [f for g in self.groups for f in g.forces]
        for one in followers:
            if one.follow:
                one.carrier = Carrier(surfaces[one.follow], self.start)
