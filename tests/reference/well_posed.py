"""Decides whether two good implementations must agree on a scene.

No selection distance within rounding of a radius (exact ties on representable lattices excepted),
no node that touches within rounding, no direction from a point that almost equals the node, no curve
sampled at a vertical tangent, and a run that does not amplify noise of 1e-12 to near the tolerance of
the comparison.
"""

import numpy as np

from bakes import bake
from curves import Curve
from diagnostics import Diagnostics
from scene import Scene


def curves_of(scene):
    """Every animated channel of a scene."""
    owners = [surface.channels for surface in scene.surfaces]
    forces = scene.forces + [force for group in scene.groups for force in group.forces]
    owners += [item.channels for item in forces + scene.colliders]
    channels = [channel for owner in owners for channel in owner.values()]
    channels += [group.center for group in scene.groups]
    channels += [force.falloff for force in forces]
    return [channel for channel in channels if isinstance(channel, Curve)]


def trouble_of(path):
    """Why a scene is rejected (None when it is kept, unless it amplifies noise), its relative peak, its
    diagnostics and its bakes."""
    scene, diagnostics = Scene(path), Diagnostics()
    results = bake(scene, diagnostics)
    relative = 0.0
    for result in results.values():
        size = float(result.world_rest[0].ptp(axis=0).max())
        relative = max(relative, result.peak() / size)
    if min(diagnostics.tie_margin, diagnostics.cut_margin) < 1e-8:
        return "a radius within rounding of a distance", relative, diagnostics, results
    if diagnostics.direction_margin < 1e-6:
        return "a direction from a point at the node itself", relative, diagnostics, results
    if diagnostics.settle_margin < 1e-5:
        return "a node that settles within rounding", relative, diagnostics, results
    if diagnostics.time_margin < 1e-9:
        return "a step that ends with the frame", relative, diagnostics, results
    if diagnostics.touch_margin < 1e-11 or diagnostics.row_margin < 1e-8:
        return "a touch within rounding", relative, diagnostics, results
    for curve in curves_of(scene):
        scale = max(np.abs(key.value).max() for key in curve.keys)
        if any(segment.sensitivity > 1e-12 * scale for segment in curve.segments):
            return "a curve sampled where it is vertical", relative, diagnostics, results
    return None, relative, diagnostics, results


def amplifies_noise(path, results):
    """Whether noise changes the bakes of a scene, given without it, to near the tolerance."""
    shaken = bake(Scene(path), noise=np.random.default_rng(1))
    return any(not np.abs(shaken[name].world - result.world).max() <= 1e-9 * result.peak()
               for name, result in results.items())
