"""Runs of whole scenes: of grids and of surfaces of triangles."""

import numpy as np

from diagnostics import Diagnostics
from engine import SurfaceRun
from forces import Transform
from triangle_engine import TriangleRun
from triangle_mesh import TriangleMesh


class Bake:
    """Positions of one surface, frames x vertices x 3, in either space, and the rest in world."""

    def __init__(self, scene, surface, diagnostics, noise=None):
        self.is_triangles = isinstance(surface.grid, TriangleMesh)
        kind = TriangleRun if self.is_triangles else SurfaceRun
        self.run = kind(scene, surface, diagnostics, noise)
        frames = list(self.run.run())
        self.frames = range(scene.start, scene.end + 1)
        self.object = np.array([positions for positions, _ in frames])
        self.world = np.array([transform.to_world(positions) for positions, transform in frames])
        self.object_rest = np.array([surface.shape.at(frame) for frame in self.frames])
        self.world_rest = np.array([transform.to_world(surface.shape.at(scene.start + k))
                                    for k, (_, transform) in enumerate(frames)])
        self.is_always_identity = all(
            Transform(surface, frame).is_identity for frame in range(scene.start, scene.end + 1))

    def peak(self):
        """The largest |position - rest| of the run, in world space."""
        return float(np.sqrt(((self.world - self.world_rest)**2).sum(axis=-1)).max())


def bake(scene, diagnostics=None, noise=None):
    """{surface name: Bake} of a whole scene."""
    diagnostics = diagnostics or Diagnostics()
    return {surface.name: Bake(scene, surface, diagnostics, noise) for surface in scene.surfaces}
