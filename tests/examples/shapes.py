"""Bakes of surfaces whose shape at rest a cache animates."""

import os
import sys
import xml.etree.ElementTree as tree

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference"))

from caches import Cache  # noqa: E402


def cache_of(scene, surface):
    """The cache of a surface, by its name or its number in the scene's file; None if it has none."""
    root = tree.parse(scene).getroot()
    elements = root.findall("surface")
    element = elements[surface] if isinstance(surface, int) else root.find(f"surface[@name='{surface}']")
    shape = next((shape for shape in element if "cache" in shape.keys()), None)
    if shape is None:
        return None
    first = float(shape.get("cacheStart")) if "cacheStart" in shape.keys() else None
    path = os.path.join(os.path.dirname(scene), shape.get("cache"))
    return Cache(path, float(root.get("fps")), int(root.get("start")), first)


def without_cache(scene, surface, frames):
    """All frames of a bake as if the shape at rest had stayed where it is in the first."""
    cache = cache_of(scene, surface)
    if cache is None:
        return frames
    start = int(tree.parse(scene).getroot().get("start"))
    shapes = np.array([cache.at(start + k) for k in range(len(frames))])
    return frames - shapes + shapes[0]
