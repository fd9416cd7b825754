"""Shapes over time as shape keys."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from . import fcurves


def absolute_keys(owner: Any, first: int, shapes: Sequence[np.ndarray]) -> None:
    """Gives a mesh without shape keys one for each frame from `first` on, and one linear F-curve that plays them."""
    owner.shape_key_add(name="Basis", from_mix=False)  # the mesh itself, which is never shown
    keys = owner.data.shape_keys
    keys.use_relative = False
    for number, shape in enumerate(shapes, 1):
        keys.eval_time = number  # where the new key stands, so that it is met to the bit
        block = owner.shape_key_add(name=str(first + number - 1), from_mix=False)
        block.data.foreach_set("co", shape.ravel())
        block.interpolation = "KEY_LINEAR"
    # Blender computes lines in single precision; up to so many frames that is exact.
    at = np.array(sorted({*range(1, len(shapes), 4096), len(shapes)}), np.float32)
    curve = fcurves.new(keys, "eval_time")
    curve.keyframe_points.add(len(at))
    curve.keyframe_points.foreach_set("co", np.column_stack([at + (first - 1), at]).ravel())
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"
        point.handle_left_type = point.handle_right_type = "VECTOR"
    curve.update()
