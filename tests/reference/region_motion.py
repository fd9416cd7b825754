"""How one region of a grid moves over one frame, by the integrator that its surface asks for."""

import numpy as np

from bending import Bending, advance_bending
from contact import with_contact
from exact_motion import exact_motion
from plasticity import PlasticRegion, flow_of_nodes
from regions import common_box
from stencil import advance, advance_exactly, advance_union, union_operator
from stepping import damping_of, slowest_vibration, with_integrator


class RegionMotion:
    """A region of the whole grid, whose arrays all are; `material` holds numbers, and arrays of the
    nodes where there is a map."""

    def __init__(self, surface, frame, region, interior, material, tangents):
        self.surface, self.frame, self.interior, self.tangents = surface, frame, interior, tangents
        self.ends = common_box(region)
        self.is_box = len(region) == 1
        self.box = np.s_[self.ends[0]:self.ends[1] + 1, self.ends[2]:self.ends[3] + 1]
        self.spacing = surface.grid.hu, surface.grid.hv
        self.material = dict(material)
        self.flows = []  # of the steps
        if surface.channels["dampingRatio"]:
            self.material["damping"] = damping_of(
                surface.sample("dampingRatio", frame), material["density"],
                self.slowest_vibration())

    def in_box(self, name):
        value = self.material[name]
        return value if np.ndim(value) == 0 else value[self.box]

    def in_interior(self, name):
        return np.broadcast_to(self.material[name], self.interior.shape)[self.interior]

    def bending(self, tangents):
        """The energy of a region that is a box."""
        shape = self.interior[self.box].shape
        return Bending(shape, *self.spacing, self.surface.edges,
                       *(self.in_box(name) for name in ("b", "c", "d")),
                       self.surface.sample("poisson", self.frame), tangents, self.in_box("goal"),
                       self.surface.held[self.box])

    def slowest_vibration(self):
        """Of the whole region."""
        if self.is_box and self.surface.has_energy:
            bending = self.bending({name: np.zeros(3) for name in self.tangents})
            free = bending.is_free.ravel()
            masses = (bending.area * self.in_box("density")).ravel()[free]
            return slowest_vibration(bending.matrix()[free][:, free], masses)
        matrix, _, _ = union_operator(self.interior, *self.spacing, self.material)
        return slowest_vibration(matrix, self.in_interior("density"))

    def whole(self, *parts):
        """What the box has, on the whole grid."""
        results = []
        for part in parts:
            results.append(np.zeros(self.interior.shape + part.shape[2:]))
            results[-1][self.box] = part
        return results

    def plastic_region(self, w, load):
        bending = self.bending(self.tangents)
        self.flows.append(flow_of_nodes(bending, self.in_box("yield"), self.in_box("hardening")))
        return PlasticRegion(bending, self.flows[-1], w[self.box], load[self.box], self.in_box("density"),
                             self.in_box("damping"))

    def step_with_contact(self, w, velocity, plastic, load, integrator, count, dt, contact):
        """Returns the state after `count` steps that meet colliders."""
        still = {name: np.zeros(3) for name in self.tangents}
        weights = np.ones(w.shape[:2])
        if not self.is_box:
            def euler(w, velocity, load, dt, tangents=None):
                return advance_union(w, velocity, load, self.interior, self.ends, *self.spacing,
                                     self.material, tangents or self.tangents, 1, dt)
        else:
            def euler(w, velocity, load, dt, tangents=None):
                parts = [part[self.box] for part in (w, velocity, load)]
                if self.surface.has_energy:
                    return self.whole(*advance_bending(
                        self.bending(tangents or self.tangents), *parts, self.in_box("density"),
                        self.in_box("damping"), 1, dt))
                return self.whole(*advance(*parts, *self.spacing, self.material, tangents or self.tangents, 1, dt))
            if self.surface.has_energy:
                weights[self.box] = self.bending(still).area
        still_plate = np.zeros_like(w)
        is_newmark = integrator == "newmark" and np.any(self.material["density"] > 0)

        def rigid(load, dt):
            return euler(still_plate, still_plate, load, dt, still)[0]

        if not self.surface.yields:
            steps = with_contact(contact, euler, rigid, self.interior, weights, is_newmark)
            return *steps([w, velocity], load, count, dt), plastic
        region = self.plastic_region(w, load)

        def plastic_euler(w, velocity, plastic, _, dt):
            return self.whole(*region.advance(w[self.box], velocity[self.box], plastic[self.box], 1, dt))

        def flow_of(w, velocity, plastic, _, dt):
            flowing, flowed = region.with_flow_of(w[self.box], velocity[self.box], plastic[self.box], dt)
            return (lambda end: self.whole(flowing(end[self.box]))[0],
                    lambda end: self.whole(flowed(end[self.box]))[0])

        steps = with_contact(contact, plastic_euler, rigid, self.interior, weights, is_newmark, flow_of)
        start = self.whole(plastic[self.box])[0]
        w, velocity, now = steps([w, velocity, start], load, count, dt)
        after = plastic.copy()
        after[self.box] = now[self.box]
        return w, velocity, after

    def step(self, w, velocity, plastic, load, integrator, count, dt, contact=None):
        """Returns w, velocity and the plastic curvatures after `count` steps."""
        if contact:
            return self.step_with_contact(w, velocity, plastic, load, integrator, count, dt, contact)
        if not self.is_box:
            steps = with_integrator(integrator, self.material["density"], advance_union)
            w, velocity = steps(w, velocity, load, self.interior, self.ends, *self.spacing,
                                self.material, self.tangents, count, dt)
            return w, velocity, plastic
        state, others = [w[self.box], velocity[self.box]], [load[self.box]]
        if self.surface.yields:
            state.append(plastic[self.box])
            region = self.plastic_region(w, load)

            def euler(w, velocity, plastic, _, count, dt):
                return region.advance(w, velocity, plastic, count, dt)
        elif self.surface.has_energy:
            bending = self.bending(self.tangents)

            def euler(*rest):
                return advance_bending(bending, *rest)
            others += [self.in_box("density"), self.in_box("damping")]
        else:
            euler = advance
            others += [*self.spacing, self.material, self.tangents]
        after = with_integrator(integrator, self.material["density"], euler, len(state))(
            *state, *others, count, dt)
        results = [np.zeros_like(w), np.zeros_like(w), plastic.copy()]
        for result, part in zip(results, after):
            result[self.box] = part
        return tuple(results)

    def move_exactly(self, w, velocity, loads, tangents, time):
        """The exact solution; `loads` and `tangents` are those at both ends of the frame."""
        if not (self.is_box and self.surface.has_energy):
            material = {name: self.in_interior(name) if np.ndim(value) else value
                        for name, value in self.material.items()}
            return advance_exactly(w, velocity, loads, self.interior, self.ends, *self.spacing,
                                   material, tangents, time)
        start, speed, forces = w[self.box].reshape(-1, 3), velocity[self.box].reshape(-1, 3), []
        for load, slopes in zip(loads, tangents):
            bending = self.bending(slopes)
            free, matrix = bending.is_free.ravel(), bending.matrix()
            known = (bending.area[..., None] * load[self.box]).reshape(-1, 3)
            known += bending.slope_forces()
            forces.append(known[free] - matrix[free][:, ~free] @ start[~free])
        material = {name: np.broadcast_to(self.in_box(name), bending.shape).ravel()[free]
                    for name in ("density", "damping")}
        end, end_speed = start.copy(), np.zeros_like(start)
        end[free], end_speed[free] = exact_motion(
            matrix[free][:, free].tocsc(), bending.area.ravel()[free], material, forces,
            start[free], speed[free], time)
        w, velocity = w.copy(), np.zeros_like(velocity)
        shape = bending.shape + (3,)
        w[self.box], velocity[self.box] = end.reshape(shape), end_speed.reshape(shape)
        return w, velocity
