"""Surfaces of triangles: SPEC 8, evaluated literally and slowly.

Nothing is shared with the library under test.
"""

import numpy as np

from carrier import unit_normals
from forces import GroupSphere, Transform, distances, falloff, pushes
from stepping import check_coefficients, find_cycle, steps_of_frame, with_integrator
from triangle_plate import Steps, advance_exactly, triangle_material
from triangle_region import Region, snapped


class TriangleRun:
    """The state of one surface: displacements, the velocities of the last solve and the curvatures
    that have flowed."""

    def __init__(self, scene, surface, diagnostics, noise=None):
        self.scene, self.surface, self.diagnostics, self.noise = scene, surface, diagnostics, noise
        self.mesh = surface.grid
        self.regions = {}  # by the bytes of phi
        self.regions_at = {}  # by the frame
        self.reset()

    def reset(self):
        self.w = np.zeros_like(self.mesh.rest)
        self.velocity = np.zeros_like(self.w)
        self.plastic = np.zeros((len(self.mesh.triangles), 3, 3))  # uu, vv, uv by x, y, z
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
        """SPEC 8, "Region", and "Release" for `recover`."""
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
        # A goal holds what nothing else does.
        has_goal = bool(np.any(self.surface.material(frame)["goal"]))
        key = phi.tobytes(), has_goal
        if key not in self.regions:
            self.regions[key] = Region(mesh, phi, may_float=has_goal)
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
        normals = unit_normals(mesh.face_nodes, points, transform)
        for force in pushing:
            delta = distances(force, frame, points)
            radius = force.sample("forceRadius", frame)
            share = region.load_areas(mesh.at_points(radius - delta))
            is_pushed = share != 0
            if not is_pushed.any():
                continue
            at = np.array(nodes)[is_pushed]
            strength = force.sample("magnitude", frame) * falloff(force, delta[at] / radius)
            push = pushes(force, frame, points[at], self, at, normals[at])
            if force.kind == "inertia" and "density" in surface.maps:
                push = push * surface.maps["density"][at][:, None]
            load[is_pushed] += (share[is_pushed] * strength)[:, None] * push
        load = transform.vector_to_object(load)
        material = triangle_material(surface, frame)
        is_static = not np.any(material["density"]) and not np.any(material["damping"])
        assert not (region.floats and is_static and not np.any(material["goal"])), \
            "a static patch that nothing holds"
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
            steps = Steps(self.w, region, load, material, tangents)
            w, velocity, plastic = with_integrator(
                surface.choices["integrator"], material["density"], steps, 3)(
                self.w, self.velocity, self.plastic, count, dt)
            self.diagnostics.note_flow(surface.name, [steps.flow] * surface.yields,
                                       (plastic != self.plastic).any())
            self.plastic = plastic
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
            # Those of a patch that nothing holds stay where they are.
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
