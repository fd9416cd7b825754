"""What is drawn of forces and solved regions in the view, and the gizmo of the active force: overlays only."""

from __future__ import annotations

import os
from functools import lru_cache
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

import bpy
import numpy as np
from bpy_extras import view3d_utils
from mathutils import Matrix, Vector, geometry

from . import live, perform, properties

Color = Tuple[float, float, float]

_deformation: Color = (0.35, 0.75, 1.0)
_force: Color = (1.0, 0.6, 0.2)
_arrow: Color = (1.0, 0.85, 0.3)
_region: Color = (0.45, 1.0, 0.55)
_everywhere = ("UNIFORM", "INERTIA")  # kinds that have no place, so that their radii are none
_angles = np.linspace(0, 2 * np.pi, 65)


# Forces, as they are in the world.


class Placed(NamedTuple):
    """A force or a group as Blender evaluates it, in the world."""

    kind: str
    start: Vector
    end: Vector  #: of a line; else the same as `start`
    direction: Optional[Vector]
    radii: Dict[str, float]
    magnitude: float
    is_enabled: bool

    @property
    def middle(self) -> Vector:
        return (self.start + self.end) / 2


def placed(owner: Any, graph: Any) -> Placed:
    found = owner.evaluated_get(graph)
    own = found.pliant
    kind = own.kind if own.role == "FORCE" else "GROUP"
    # What follows a surface has its place in that one's object space.
    space = own.follow.evaluated_get(graph).matrix_world if own.follow else Matrix()
    start = space @ found.matrix_world.translation
    end = space @ own.end.evaluated_get(graph).matrix_world.translation if kind == "LINE" and own.end else start
    names = ("deformation_radius",) if kind == "GROUP" else ("deformation_radius", "force_radius")
    radii = {} if kind in _everywhere else {name: getattr(own, name) for name in names}
    turn = space.to_3x3() @ _turn_of(found, own)
    direction = (turn @ (Vector(own.direction) if own.aim == "VECTOR" else Vector((0, 0, 1)))).normalized()
    is_aimed = kind in ("POINT", "UNIFORM", "VORTEX") or (kind == "LINE" and own.use_direction)
    magnitude = 0.0 if kind == "GROUP" else own.magnitude
    return Placed(kind, start, end, direction if is_aimed else None, radii, magnitude, own.enabled)


def _turn_of(found: Any, own: Any) -> Matrix:
    if own.aim == "VECTOR":
        return found.parent.matrix_world.to_3x3().normalized() if found.parent else Matrix.Identity(3)
    return found.matrix_world.to_3x3()


class Camera:
    """From where the view is seen, and what a pixel is."""

    def __init__(self, region: Any, view: Any):
        self.region, self.view = region, view
        rows = view.view_matrix.to_3x3()
        self.right, self.up, self.toward = (rows[index].normalized() for index in range(3))

    def pixel(self, point: Vector) -> float:
        """The size of a pixel at a point of the world."""
        depth = (self.view.perspective_matrix @ point.to_4d()).w
        return abs(2 * depth / (self.view.window_matrix[0][0] * self.region.width))

    def ray(self, x: float, y: float) -> Tuple[Vector, Vector]:
        place = (x, y)
        direction = view3d_utils.region_2d_to_vector_3d(self.region, self.view, place)
        return view3d_utils.region_2d_to_origin_3d(self.region, self.view, place), direction


def axes(force: Placed, camera: Camera) -> Tuple[Vector, Vector]:
    """Of the plane in which the circles are: that of the view, and around the axis of a vortex."""
    if force.kind == "VORTEX" and force.direction.length:
        right = force.direction.orthogonal().normalized()
        return right, force.direction.cross(right)
    return camera.right, camera.up


def aim(force: Placed, camera: Camera) -> Vector:
    """Where the arrow points; what has no direction points up in the view."""
    return force.direction if force.direction and force.direction.length else camera.up


def _unit(force: Placed) -> float:
    return force.radii.get("deformation_radius", 1.0) / 4


def length(force: Placed) -> float:
    """Of the arrow: magnitudes are anything from 1 to 100 000, so ten times as much is as much longer."""
    return _unit(force) * float(np.arcsinh(force.magnitude / 10))


def magnitude_of(force: Placed, arrow: float) -> float:
    return 10 * float(np.sinh(np.clip(arrow / _unit(force), -20, 20))) if _unit(force) else force.magnitude


# Lines: arrays (n, 2, 3) of their ends.


def _line(points: np.ndarray) -> np.ndarray:
    return np.stack([points[:-1], points[1:]], 1)


def _around(center: Vector, right: Vector, up: Vector, radius: float, angles: np.ndarray) -> np.ndarray:
    return np.array(center) + radius * (np.outer(np.cos(angles), right) + np.outer(np.sin(angles), up))


def _outline(force: Placed, camera: Camera, radius: float) -> np.ndarray:
    """A circle; round a line, a capsule as it is seen."""
    right, up = axes(force, camera)
    along = force.end - force.start
    flat = along.dot(right), along.dot(up)
    if not any(flat):
        return _line(_around(force.start, right, up, radius, _angles))
    turn = np.arctan2(flat[1], flat[0])
    half = _angles[:33] - np.pi / 2
    places = (force.end, half + turn), (force.start, half + turn + np.pi)
    ends = [_around(place, right, up, radius, angles) for place, angles in places]
    points = np.concatenate(ends)
    return _line(np.concatenate([points, points[:1]]))


def _arrow_lines(start: Vector, along: Vector, camera: Camera) -> np.ndarray:
    tip = start + along
    side = along.cross(camera.toward).normalized()
    head = min(along.length / 3, 12 * camera.pixel(tip))
    back = tip - head * along.normalized()
    ends = [(start, tip), (tip, back + head / 2 * side), (tip, back - head / 2 * side)]
    return np.array([[tuple(a), tuple(b)] for a, b in ends])


def _force_lines(force: Placed, camera: Camera) -> Iterator[Tuple[Color, np.ndarray]]:
    for name, radius in force.radii.items():
        yield (_force if name == "force_radius" else _deformation), _outline(force, camera, radius)
    if force.magnitude:
        along = length(force) * aim(force, camera)
        ways = [along] if force.direction else [along, -along]  # what has no direction acts in several
        yield _arrow, np.concatenate([_arrow_lines(force.middle, each, camera) for each in ways])


# The region that is solved.


class Region:
    """What is known of the regions of a simulation; a session keeps it."""

    def __init__(self, simulation: Any) -> None:
        self.simulation = simulation
        self.last: Dict[str, Any] = {}
        self.edges: Dict[Tuple[str, str], np.ndarray] = {}

    def report(self, session: Any, frame: int) -> Dict[str, Any]:
        """The report of a frame, by surface; of one that is not there yet the last one that was shown."""
        self.last = session.reports.get(frame, self.last)
        return self.last

    def rim(self, name: str, regions: List[Dict[str, Any]]) -> np.ndarray:
        """Of a grid: the vertices at both ends of each edge around its regions, (n, 2)."""
        parts = [part for each in regions if each["solved"] for part in each["parts"]]
        key = name, repr(parts)
        if key not in self.edges:
            self.edges[key] = self._rim(self.simulation.shape(name), parts)
        return self.edges[key]

    @staticmethod
    def _rim(shape: Any, parts: List[Dict[str, Any]]) -> np.ndarray:
        columns, rows = shape.grid.columns, shape.grid.rows
        cells = np.zeros((rows, columns), bool)  # those that begin at a node; on closed grids the last ones too
        for part in parts:
            (i, i_end), (j, j_end) = part["columns"], part["rows"]
            cells[np.ix_(np.arange(j, j_end) % rows, np.arange(i, i_end) % columns)] = True
        vertex = np.zeros(rows * columns, int)
        vertex[shape.vertex_nodes] = np.arange(len(shape.vertex_nodes))
        nodes = vertex.reshape(rows, columns)
        across = cells != np.roll(cells, 1, 0), cells != np.roll(cells, 1, 1)
        ends = np.roll(nodes, -1, 1), np.roll(nodes, -1, 0)
        return np.concatenate([np.stack([nodes[is_rim], end[is_rim]], 1) for is_rim, end in zip(across, ends)])


def _cut(points: np.ndarray, triangles: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Where a number at points is 0 on the triangles between them."""
    signs = depth[triangles] > 0
    crossed = signs.any(axis=1) & ~signs.all(axis=1)
    triangles, signs = triangles[crossed], signs[crossed]
    # The corner that is alone on its side, and the other two.
    alone = np.argmax(signs == (signs.sum(axis=1) == 1)[:, None], axis=1)
    rows = np.arange(len(triangles))
    corner = triangles[rows, alone]
    ends = []
    for step in (1, 2):
        other = triangles[rows, (alone + step) % 3]
        share = depth[corner] / (depth[corner] - depth[other])
        ends.append(points[corner] + share[:, None] * (points[other] - points[corner]))
    return np.stack(ends, 1)


def _depth(points: np.ndarray, forces: List[Dict[str, Any]]) -> np.ndarray:
    """How far points are within the radius of the force that reaches deepest."""
    found = np.full(len(points), -np.inf)
    for each in forces:
        away: Any = np.zeros(len(points))  # what is everywhere
        if "from" in each:
            start, along = np.array(each["from"]), np.subtract(each["to"], each["from"])
            share = np.clip((points - start) @ along / max(along @ along, 1e-30), 0, 1)
            away = np.linalg.norm(points - start - share[:, None] * along, axis=1)
        elif "axis" in each:
            away = np.linalg.norm(np.cross(points - each["center"], each["axis"]), axis=1)
        elif "center" in each:
            away = np.linalg.norm(points - each["center"], axis=1)
        found = np.maximum(found, each["deformationRadius"] - away)
    return found


def _coordinates(mesh: Any) -> np.ndarray:
    found = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def _triangles(mesh: Any) -> np.ndarray:
    mesh.calc_loop_triangles()
    found = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", found)
    return found.reshape(-1, 3)


def _region_lines(scene: Any, graph: Any, is_shown: Any) -> Iterator[np.ndarray]:
    session = live.session_of(scene)
    if session is None or session.simulation is None:
        return
    known = getattr(session, "region", None)
    if known is None or known.simulation is not session.simulation:
        known = session.region = Region(session.simulation)
    report = known.report(session, min(scene.frame_current, session.simulation.frames[-1]))
    origin = np.array(scene.pliant.origin.evaluated_get(graph).matrix_world) if scene.pliant.origin else np.eye(4)
    for name, owner_name in session.translation.object_of.items():
        part, owner = report.get(name), scene.objects.get(owner_name)
        if not part or not part["solved"] or not owner or owner.mode == "EDIT" or not is_shown(owner):
            continue
        found = owner.evaluated_get(graph)
        points, world = _coordinates(found.data), np.array(found.matrix_world)
        if len(points) < len(owner.data.vertices):
            continue
        points = points @ world[:3, :3].T + world[:3, 3]
        if part.get("regions"):
            yield points[known.rim(name, part["regions"])]
        elif "pieces" in part:
            there = np.linalg.inv(origin)
            yield _cut(points, _triangles(found.data), _depth(points @ there[:3, :3].T + there[:3, 3], part["forces"]))


# Drawing.


@lru_cache(maxsize=None)
def _shader() -> Any:
    import gpu  # not without a window

    try:
        return gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    except ValueError:  # until 3.6
        return gpu.shader.from_builtin("3D_POLYLINE_UNIFORM_COLOR")


def _draw_lines(lines: np.ndarray, color: Color, alpha: float, width: float, region: Any) -> None:
    from gpu_extras.batch import batch_for_shader

    shader = _shader()
    shader.bind()
    shader.uniform_float("viewportSize", (region.width, region.height))
    shader.uniform_float("lineWidth", width * bpy.context.preferences.system.pixel_size)
    shader.uniform_float("color", (*color, alpha))
    points = np.ascontiguousarray(lines.reshape(-1, 3), np.float32)
    batch_for_shader(shader, "LINES", {"pos": points}).draw(shader)


def _draw(context: Any) -> None:
    import gpu

    scene, space = context.scene, context.space_data
    if not any(properties.role(each) != "NONE" for each in scene.objects):
        return
    settings = scene.pliant
    if not space.overlay.show_overlays or not (settings.show_overlay or settings.show_region):
        return
    graph, camera = context.view_layer.depsgraph, Camera(context.region, context.region_data)

    def is_shown(owner: Any) -> bool:
        return owner.visible_get(view_layer=context.view_layer, viewport=space)

    if settings.show_region:
        found = [each for each in _region_lines(scene, graph, is_shown) if len(each)]
        if found:
            lines = np.concatenate(found)
            # A little toward the viewer, or the surface hides half of it.
            eye = np.array(camera.view.view_matrix.inverted().translation)
            toward = eye - lines if camera.view.is_perspective else np.array(camera.toward) * camera.view.view_distance
            gpu.state.blend_set("ALPHA")
            gpu.state.depth_test_set("LESS_EQUAL")
            _draw_lines(lines + 0.004 * toward, _region, 0.9, 2.0, context.region)
    if settings.show_overlay:
        found = {}
        for owner in scene.objects:
            if properties.role(owner) in ("FORCE", "GROUP") and is_shown(owner):
                force = placed(owner, graph)
                alpha = 0.9 if force.is_enabled and owner.select_get(view_layer=context.view_layer) else 0.25
                for color, lines in _force_lines(force, camera):
                    found.setdefault((color, alpha), []).append(lines)
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("NONE")
        for (color, alpha), each in sorted(found.items(), key=lambda item: item[0][1]):
            _draw_lines(np.concatenate(each), color, alpha, 1.5, context.region)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _draw_guarded() -> None:
    """What is called at each redraw must not fill the console."""
    try:
        _draw(bpy.context)
    except Exception:
        if os.environ.get("PLIANT_TEST"):
            raise


# The gizmo.


def _triangle_fan() -> List[Tuple[float, float, float]]:
    rim = [(np.cos(each), np.sin(each), 0.0) for each in _angles[::4]]
    return [point for a, b in zip(rim, rim[1:]) for point in ((0.0, 0.0, 0.0), a, b)]


class PLIANT_GT_handle(bpy.types.Gizmo):
    """Drags one property of the active force: a radius by its circle, or the magnitude by the tip of the arrow"""

    bl_idname = "PLIANT_GT_handle"
    __slots__ = ("name", "shape", "before", "grip", "at")

    def setup(self) -> None:
        self.use_draw_modal = True
        self.use_draw_scale = False
        self.shape = None

    def place(self, force: Placed, camera: Camera) -> None:
        """Puts the shape where it is drawn and found. Not while Blender looks for it, which has matrices of its own."""
        if self.name == "magnitude":
            place = _tip(force, camera)
            size = 6 * bpy.context.preferences.system.pixel_size * camera.pixel(place)
            columns = [camera.right * size, camera.up * size, camera.toward * size]
        else:
            right, up = axes(force, camera)
            columns = [each * force.radii[self.name] for each in (right, up, right.cross(up))]
            place = force.start
        made = Matrix(columns).transposed().to_4x4()
        made.translation = place
        self.matrix_basis = made

    def draw(self, _context: Any) -> None:
        self.draw_custom_shape(self._shape())

    def draw_select(self, _context: Any, select_id: int) -> None:
        self.draw_custom_shape(self._shape(), select_id=select_id)

    def _shape(self) -> Any:
        if self.shape is None:
            if self.name == "magnitude":
                self.shape = self.new_custom_shape("TRIS", _triangle_fan())
            else:
                points = np.column_stack([np.cos(_angles), np.sin(_angles), 0 * _angles])
                self.shape = self.new_custom_shape("LINES", _line(points).reshape(-1, 3).tolist())
        return self.shape

    def _grip_at(self, context: Any, event: Any) -> float:
        """Where the pointer is: how far from the centre, or along the arrow."""
        force, camera = placed(context.object, context.view_layer.depsgraph), Camera(context.region, context.region_data)
        start, along = camera.ray(event.mouse_region_x, event.mouse_region_y)
        if self.name == "magnitude":
            axis = aim(force, camera)
            if axis.cross(camera.toward).length < 0.1:  # it points at us
                return event.mouse_region_y * camera.pixel(force.middle)
            nearest = geometry.intersect_line_line(force.middle, force.middle + axis, start, start + along)
            return (nearest[0] - force.middle).dot(axis)
        right, up = axes(force, camera)
        normal = right.cross(up)
        if abs(normal.dot(camera.toward)) < 0.1:  # seen from its edge
            normal = camera.toward
        found = geometry.intersect_line_plane(start, start + along, force.start, normal)
        return (found - force.start).length if found else self.grip

    def _value(self, context: Any) -> float:
        return getattr(context.object.pliant, self.name)

    def invoke(self, context: Any, event: Any) -> set:
        perform.is_gripped = True
        self.before = self._value(context)
        self.grip = 0.0
        self.grip = self.at = self._grip_at(context, event)
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any, tweak: set) -> set:
        if event.type == "MOUSEMOVE":
            own = context.object.pliant
            now = self._grip_at(context, event)
            step, self.at = (now - self.at) * (0.1 if "PRECISE" in tweak else 1), now
            force = placed(context.object, context.view_layer.depsgraph)
            if self.name == "magnitude":
                own.magnitude = magnitude_of(force, length(force) + step)
            else:
                least = Camera(context.region, context.region_data).pixel(force.start)
                setattr(own, self.name, max(self._value(context) + step, least))
            context.area.header_text_set(f"{own.bl_rna.properties[self.name].name}: {self._value(context):.4g}")
        return {"RUNNING_MODAL"}

    def exit(self, context: Any, cancel: bool) -> None:
        perform.is_gripped = False
        context.area.header_text_set(None)
        owner = context.object
        if cancel:
            setattr(owner.pliant, self.name, self.before)
            return
        if self._value(context) == self.before:
            return
        if context.scene.tool_settings.use_keyframe_insert_auto and not perform.is_running():
            only = {"INSERTKEY_AVAILABLE"} if context.preferences.edit.use_keyframe_insert_available else set()
            owner.keyframe_insert(f"pliant.{self.name}", options=only)
        bpy.ops.ed.undo_push(message=owner.pliant.bl_rna.properties[self.name].name)


def _tip(force: Placed, camera: Camera) -> Vector:
    """A little beyond the arrow, so that it does not hide the origin of the object."""
    gap = 12 * bpy.context.preferences.system.pixel_size * camera.pixel(force.middle)
    arrow = length(force)
    return force.middle + aim(force, camera) * (arrow + (gap if arrow >= 0 else -gap))


class PLIANT_GGT_force(bpy.types.GizmoGroup):
    """Both radii and the magnitude of the active force"""

    bl_idname, bl_label = "PLIANT_GGT_force", "pliant Force"
    bl_space_type, bl_region_type = "VIEW_3D", "WINDOW"
    bl_options = {"3D", "PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        owner = context.object
        if owner is None or properties.role(owner) != "FORCE" or owner.mode != "OBJECT":
            return False
        is_override = owner.override_library and not owner.override_library.is_system_override
        return (not owner.library or is_override) and owner.visible_get()

    def setup(self, _context: Any) -> None:
        for name, color in (("deformation_radius", _deformation), ("force_radius", _force), ("magnitude", _arrow)):
            made = self.gizmos.new(PLIANT_GT_handle.bl_idname)
            made.name = name
            made.color, made.alpha = color, 0.6
            made.color_highlight, made.alpha_highlight = (1.0, 1.0, 1.0), 1.0

    def draw_prepare(self, context: Any) -> None:
        force, camera = placed(context.object, context.view_layer.depsgraph), Camera(context.region, context.region_data)
        for each in self.gizmos:
            each.hide = each.name != "magnitude" and each.name not in force.radii
            if not each.hide:
                each.place(force, camera)


CLASSES = (PLIANT_GT_handle, PLIANT_GGT_force)
_handler: Any = None


def register() -> None:
    global _handler
    perform.register()
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    if not bpy.app.background:
        _handler = bpy.types.SpaceView3D.draw_handler_add(_draw_guarded, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    global _handler
    if _handler is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handler, "WINDOW")
        _handler = None
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    perform.unregister()
