"""The reference engine: SPEC 2-7, evaluated literally and slowly.

Nothing is shared with the library under test.
"""

import numpy as np

from carrier import unit_normals
from contact import FrameContact
from forces import GroupSphere, Transform, distances, falloff, pushes
from maps import check_material, check_yield
from region_motion import RegionMotion
from regions import bounding_box, combined, common_box, do_meet, interior_of, islands_of
from stepping import check_coefficients, find_cycle, steps_of_frame

# u0, u1, v0, v1.
EDGE_LINES = np.s_[0, :], np.s_[-1, :], np.s_[:, 0], np.s_[:, -1]


class SurfaceRun:
    """The state of one surface: the mesh, the velocities of the last solve and the curvatures that have
    flowed."""

    def __init__(self, scene, surface, diagnostics, noise=None):
        self.scene, self.surface, self.noise = scene, surface, noise
        self.diagnostics = diagnostics
        self.show(scene.start)
        self.reset()

    def show(self, frame):
        """Takes the shape at rest of a frame."""
        self.vertices = self.surface.shape.at(frame)
        self.rest = self.surface.grid.of_nodes(self.vertices)

    def ride(self, frame):
        """Goes on to the shape at rest of the next frame, on which everything rides."""
        before = self.rest
        self.show(frame + 1)
        is_moved = (self.rest != before).any(axis=-1)
        at_rest = (self.position == before).all(axis=-1)
        self.position[is_moved] += (self.rest - before)[is_moved]
        self.position[at_rest] = self.rest[at_rest]

    def reset(self):
        self.position = self.rest.copy()
        # Zero where the last solve did not reach: such nodes start from velocity 0 (SPEC 6).
        self.velocity = np.zeros_like(self.rest)
        self.plastic = np.zeros(self.rest.shape[:2] + (3, 3))  # uu, vv, uv by x, y, z
        self.unsettled = np.zeros(self.rest.shape[:2], dtype=bool)
        self.forget_push()

    def forget_push(self):
        """What `exact` starts from: loads, unknowns and tangents of the last solve."""
        self.last_load = np.zeros_like(self.rest)
        self.was_unknown = np.zeros(self.rest.shape[:2], dtype=bool)
        self.last_tangents = {}

    def enabled_forces(self, frame):
        """Lists of the forces and groups that act on this surface: (force, selects a region) and
        (group)."""
        def acts(item):
            is_target = item.targets is None or self.surface.name in item.targets
            return is_target and item.enabled(frame)[0] != 0

        groups = [group for group in self.scene.groups if acts(group)]
        forces = [force for force in self.scene.forces if acts(force)]
        forces += [force for group in groups for force in group.forces if acts(force)]
        return forces, groups

    def measured_points(self, transform):
        """World positions where distances are measured (SPEC 5, `measure`)."""
        is_rest = self.surface.choices["measure"] == "rest"
        return transform.to_world(self.rest if is_rest else self.position)

    def contact(self, frame):
        """The colliders that it meets in the solve at a frame; None: there are none."""
        colliders = [one for one in self.scene.colliders
                     if (one.targets is None or self.surface.name in one.targets)
                     and one.enabled(frame)[0] != 0]
        if not colliders:
            return None
        assert self.surface.choices["reference"] == "rest"
        length = self.surface.frame_length(frame, self.scene.fps)
        count, _ = steps_of_frame(length, self.surface.sample("dt", frame),
                                  self.surface.choices["stepping"])
        ends = [self.surface.grid.of_nodes(self.surface.shape.at(k)) for k in (frame, frame + 1)]
        return FrameContact(self.surface, colliders, frame, count,
                            lambda a: (1 - a) * ends[0] + a * ends[1], self.diagnostics)

    def select(self, frame, points, forces, groups, contact=None):
        """The deformation box of each force, None for none; of a group's forces, the group's."""
        own = {}
        if self.surface.is_whole:
            return own
        for force in forces:
            if not force.is_in_group:
                delta = distances(force, frame, points)
                own[force] = bounding_box(delta < force.sample("deformationRadius", frame))
        for group in groups:
            offset = points - group.place(frame)
            delta = np.sqrt((offset**2).sum(axis=-1))
            box = bounding_box(delta < float(group.deformation_radius(frame)[0]))
            own[group] = box
            own.update((force, box) for force in group.forces)
        for collider in contact.colliders if contact else []:
            own[collider] = bounding_box(contact.selects(collider, self.position - self.rest))
        return own

    def regions(self, own):
        """The regions that are solved, including nodes not yet back at rest (SPEC 5, 6)."""
        how = self.surface.choices["combine"]
        if self.surface.is_whole:
            columns, rows = self.rest.shape[:2]
            return [[(0, columns - 1, 0, rows - 1)]]
        boxes = [box for box in own.values() if box is not None]
        regions = combined(boxes, how)
        if self.surface.choices["release"] == "recover":
            held = np.zeros(self.rest.shape[:2], dtype=bool)
            for region in regions:
                held |= interior_of(region, held.shape)
            columns, rows = held.shape
            around = [(max(i - 1, 0), min(i + 1, columns - 1), max(j - 1, 0), min(j + 1, rows - 1))
                      for i, j in np.argwhere(self.unsettled & ~held)]
            self.diagnostics.recovering += len(around)
            if around:
                regions = combined(boxes + islands_of(around), how)
        return regions

    def interior(self, region):
        """The nodes that move."""
        interior = interior_of(region, self.rest.shape[:2])
        if set(self.surface.edges) != {"clamped"}:
            edges = self.surface.edges
            interior[:] = True
            for edge, line in zip(edges, EDGE_LINES):
                if edge != "free":
                    interior[line] = False
        return interior & ~self.surface.held

    def settle(self, regions):
        """Sets all nodes that are not interior to a region to rest."""
        moving = np.zeros(self.rest.shape[:2], dtype=bool)
        for region in regions:
            moving |= interior_of(region, moving.shape)
        self.position[~moving] = self.rest[~moving]
        self.velocity[~moving] = 0
        self.was_unknown[~moving] = False

    def note_settling(self, before, interior, region):
        """The solved nodes that are not yet at rest."""
        rest = np.concatenate([self.rest[i0:i1 + 1, j0:j1 + 1].reshape(-1, 3)
                               for i0, i1, j0, j1 in region])
        length = 1e-6 * float(np.linalg.norm(rest.ptp(axis=0)))
        moved = np.maximum(np.linalg.norm(self.position - self.rest, axis=-1),
                           np.linalg.norm(self.position - before, axis=-1))[interior]
        self.unsettled[interior] = moved >= length
        if moved.size:
            margin = float(np.abs(moved / length - 1).min())
            self.diagnostics.settle_margin = min(self.diagnostics.settle_margin, margin)

    def normals(self, points, transform):
        """The normals of the nodes at world positions (SPEC 7)."""
        return unit_normals(self.surface.grid.face_nodes, points.reshape(-1, 3),
                            transform).reshape(points.shape)

    def load(self, frame, points, forces, transform):
        """The load at every node of the surface, in object space (SPEC 5, step 3; SPEC 7)."""
        total = np.zeros_like(points)
        normals = self.normals(points, transform)  # of all nodes
        for force in forces:
            delta = distances(force, frame, points)
            radius = force.sample("forceRadius", frame)
            box = bounding_box(delta < radius)
            if box is None:
                continue
            i0, i1, j0, j1 = box
            inside = np.s_[i0:i1 + 1, j0:j1 + 1]
            strength = force.sample("magnitude", frame) * falloff(force, delta[inside] / radius)
            push = pushes(force, frame, points[inside], self, inside, normals[inside])
            if force.kind == "inertia" and "density" in self.surface.maps:
                push = push * self.surface.maps["density"][inside][..., None]
            total[inside] += strength[..., None] * push
        return transform.vector_to_object(total)

    parts = ("position", "velocity", "unsettled", "last_load", "was_unknown", "last_tangents")

    def displacement(self, position):
        return float(np.linalg.norm(position - self.rest, axis=-1).max())

    def solve(self, frame):
        """The solve at `frame`, which computes the mesh of frame + 1."""
        surface = self.surface
        forces, groups = self.enabled_forces(frame)
        transform = Transform(surface, frame)
        points = self.measured_points(transform)
        self.diagnose(frame, points, forces, groups, transform)
        contact = self.contact(frame)
        own = self.select(frame, points, forces, groups, contact)
        regions = self.regions(own)
        recovers = surface.choices["release"] == "recover"
        if recovers:
            self.settle(regions)
        interiors = [self.interior(region) for region in regions]
        if not any(interior.any() for interior in interiors):
            self.diagnostics.skips.append((frame, surface.name, "below 3x3" if regions or any(
                own.values()) else "no node"))
            return
        is_displacement = surface.choices["reference"] == "rest"
        origin = self.rest if is_displacement else np.zeros_like(self.rest)
        material = surface.material(frame)
        tangents = {name: surface.channels[name](frame) for name in ("su0", "su1", "sv0", "sv1")}
        length = surface.frame_length(frame, self.scene.fps)
        count, dt = steps_of_frame(length, surface.sample("dt", frame), surface.choices["stepping"])
        integrator = surface.choices["integrator"]
        before, velocities = self.position.copy(), np.zeros_like(self.rest)
        next_load, is_unknown = np.zeros_like(self.rest), np.zeros_like(self.was_unknown)
        first_tangents = self.last_tangents if self.was_unknown.any() else tangents
        self.unsettled[:] = False
        for region, interior in zip(regions, interiors):
            if not interior.any():
                self.diagnostics.skips.append((frame, surface.name, "below 3x3"))
                continue
            ends = common_box(region)
            self.diagnostics.solves.append((frame, surface.name, ends))
            acting = forces if surface.choices["combine"] != "islands" else [
                force for force in forces if own[force] is not None and do_meet(own[force], ends)]
            load = self.load(frame, points, acting, transform)
            start, speed = before - origin, self.velocity
            motion = RegionMotion(surface, frame, region, interior, material, tangents)
            self.diagnostics.unions += len(region) > 1
            next_load[interior] = load[interior]
            is_unknown |= interior
            if integrator == "exact":
                first = np.where(self.was_unknown[..., None], self.last_load, load)
                w, velocity = motion.move_exactly(start, speed, (first, load),
                                                  (first_tangents, tangents), length)
            else:
                w, velocity, plastic = motion.step(start, speed, self.plastic, load, integrator,
                                                   count, dt, contact)
                self.diagnostics.note_flow(surface.name, motion.flows,
                                           (plastic != self.plastic).any())
                self.plastic = plastic
            self.position[interior] = (origin + w)[interior]
            velocities[interior] = velocity[interior]
            if self.noise is not None:  # simulates another implementation's rounding
                shift = (self.position - self.rest)[interior]
                shift *= 1 + 1e-12 * self.noise.standard_normal(shift.shape)
                self.position[interior] = self.rest[interior] + shift
            if recovers:
                self.note_settling(before, interior, region)
        self.velocity = velocities
        self.last_load, self.was_unknown, self.last_tangents = next_load, is_unknown, tangents
        assert np.isfinite(self.position).all(), f"not finite after frame {frame}"

    def diagnose(self, frame, points, forces, groups, transform):
        is_rest = self.surface.choices["measure"] == "rest"
        at_rest = (self.position == self.rest).all(axis=-1) | is_rest
        is_untouched = at_rest & transform.is_identity
        for force in forces:
            radii = [force.sample("forceRadius", frame)]
            if not force.is_in_group and not self.surface.is_whole:
                radii.append(force.sample("deformationRadius", frame))
            self.diagnostics.note_distances(force, frame, points, is_untouched, radii)
        for group in [] if self.surface.is_whole else groups:
            sphere = GroupSphere(group)
            radius = float(group.deformation_radius(frame)[0])
            self.diagnostics.note_distances(sphere, frame, points, is_untouched, [radius])
        is_scaled = self.surface.sample("timeScale", frame) != 1
        if self.surface.choices["stepping"] == "overshoot" and (
                self.scene.fps.denominator != 1 or is_scaled):
            length = self.surface.frame_length(frame, self.scene.fps)
            self.diagnostics.note_steps(length, self.surface.sample("dt", frame))

    def check_channels(self, frames):
        """SPEC 2: channels are checked at every integer frame before the first solve."""
        for frame in frames:
            check_coefficients(*(self.surface.sample(name, frame)
                                 for name in ("density", "damping", "b", "c", "d", "dt")))
            if self.surface.channels["dampingRatio"]:
                assert self.surface.sample("dampingRatio", frame) >= 0
            goal = self.surface.sample("goal", frame)
            assert goal >= 0 and (goal == 0 or self.surface.choices["reference"] == "rest")
            material = self.surface.material(frame)
            if self.surface.yields:
                check_yield(material, self.surface.sample("timeScale", frame))
            if self.surface.has_stiffness_map or self.surface.yields:
                check_material(material["b"], material["c"], material["d"],
                               self.surface.sample("poisson", frame))
            length = self.surface.frame_length(frame, self.scene.fps)
            assert length / self.surface.sample("dt", frame) <= 1e5
        for force in self.scene.forces + [f for g in self.scene.groups for f in g.forces]:
            for name in ("deformationRadius", "forceRadius"):
                assert all(force.sample(name, frame) >= 0 for frame in frames), name
        for group in self.scene.groups:
            assert all(group.deformation_radius(frame)[0] >= 0 for frame in frames)

    def run(self):
        """Yields (object positions of the vertices, transform) of each frame."""
        first, loop = self.surface.start_frame, self.surface.loop
        frames = range(min(self.scene.start, first), self.scene.end + 1)
        self.check_channels(frames)
        if loop:
            self.check_channels(range(first, first + loop))
            states = find_cycle(self, range(first, first + loop))
            for frame in frames:
                position = self.rest if frame < first else states[(frame - first) % loop][0]
                yield self.surface.grid.to_vertices(position), Transform(self.surface, frame)
            return
        self.show(frames[0])
        for frame in frames:
            if frame <= self.surface.start_frame:
                self.reset()
            if frame >= self.scene.start:
                yield self.surface.grid.to_vertices(self.position), Transform(self.surface, frame)
            if self.surface.is_solved_at(frame):
                self.solve(frame)
            self.ride(frame)
