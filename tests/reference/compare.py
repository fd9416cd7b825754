#!/usr/bin/env python3
"""Compares an engine's bakes with the reference implementation, scene by scene.

    python3 compare.py PLIANT_BINARY SCENE... [--well-posed] [--noise] [--keep DIR]

Each scene is baked with the reference, and with `PLIANT_BINARY bake SCENE -o OUT.npy`; the largest
difference must stay within 1e-8 of the surface's peak displacement over the run, 1e-7 with exact motion. A surface that never moves must be exactly at rest. On a surface of triangles,
so must every vertex that does not move, and the patches' numbers of nodes and cells must agree. With
--well-posed, no scene may leave a decision to rounding (well_posed.py), nor hardly move unless its
text has "nothing moves"; with --noise neither may it amplify noise. Exit 1 when a scene fails.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

from bakes import bake
from reference import output_path
from scene import Scene
from well_posed import amplifies_noise, trouble_of

# The condition number of the 13-point operator grows like nodes^2 (about 1e5 at 25x25), so two
# good solvers differ by about 1e-11 of the peak; 1e-8 leaves room for a hundred frames of it.
TOLERANCE = 1e-8
# Exact motion is right to 1e-6 of the peak in runs of 250 frames (SPEC 9); here loads jump, and runs
# are short.
EXACT_TOLERANCE = 1e-7


def tolerance_of(reference):
    """Absolute tolerance of a surface. For a surface at rest: 0, apart from the rounding of its
    transform.

    A transform may follow a weighted curve, whose time is solved to a few ulps: the error in value is
    that times the slope, which grows without bound near a vertical tangent.
    """
    peak = reference.peak()
    if not is_at_rest(reference):
        is_exact = reference.run.surface.choices["integrator"] == "exact"
        return (EXACT_TOLERANCE if is_exact else TOLERANCE) * peak
    if reference.is_always_identity:
        return 0.0
    return 1e-10 * float(np.abs(reference.world).max() + 1.0)


def first_difference(scene, name, reference, positions, tolerance):
    """A message that names the first frame and the vertex that differ; None when all agree."""
    expected = reference.world
    if positions.dtype != np.float64 or positions.shape != expected.shape:
        return (f"surface {name}: {positions.dtype} {positions.shape}, "
                f"expected float64 {expected.shape}")
    difference = np.abs(positions - expected)
    wrong = ~(difference <= tolerance)
    if not wrong.any():
        return None
    frame, vertex = np.argwhere(wrong.any(axis=-1))[0]
    node = next(s for s in scene.surfaces if s.name == name).grid.node_of[vertex]
    worst = np.nanmax(difference)
    return (f"surface {name}: first difference at frame {scene.start + frame}, vertex {vertex} "
            f"(node {node}): {positions[frame, vertex]} instead of {expected[frame, vertex]} "
            f"(rest {reference.world_rest[frame, vertex]}); "
            f"{int(wrong.any(axis=-1)[frame].sum())} vertices differ there, "
            f"tolerance {tolerance:.3g}, worst of the run {worst:.3g}")


def is_at_rest(reference):
    """Whether the surface never leaves its shape."""
    return bool((reference.object == reference.object_rest).all())


def rest_difference(binary, path, name, reference, folder):
    """A message unless a surface at rest is so to the bit; object space knows no rounded transform."""
    out = os.path.join(folder, "object.npy")
    subprocess.run([binary, "bake", path, "-o", out, "--quiet", "--surface", name,
                    "--space", "object"], capture_output=True, check=True)
    if (np.load(out) == reference.object).all():
        return None
    return f"surface {name}: at rest, but not bit for bit in object space"


def still_difference(binary, path, name, reference, folder):
    """A message unless what never moves on a surface of triangles is at rest to the bit."""
    out = os.path.join(folder, "object.npy")
    subprocess.run([binary, "bake", path, "-o", out, "--quiet", "--surface", name,
                    "--space", "object"], capture_output=True, check=True)
    is_still = (reference.object == reference.object_rest).all(axis=-1)
    moved = (np.load(out) != reference.object_rest).any(axis=-1) & is_still
    if not moved.any():
        return None
    frame, vertex = np.argwhere(moved)[0]
    return (f"surface {name}: vertex {vertex} is not at rest at row {frame}; {int(moved.sum())} "
            f"such positions in all")


def patches_difference(told, name, reference):
    """A message unless --regions tells the numbers of the patches (docs/regions.md) of each frame."""
    for frame in told["frames"]:
        surface = next(s for s in frame["surfaces"] if s["name"] == name)
        patches = sorted((patch["insideNodes"], patch["heldNodes"], patch["cells"])
                         for patch in surface.get("pieces", []))
        region = reference.run.regions_at.get(frame["frame"])
        expected = sorted(region.patches) if region else []
        if patches != expected:
            return (f"surface {name}: patches of {patches} inside nodes, held nodes and cells at "
                    f"frame {frame['frame']} instead of {expected}")
    return None


def compare_scene(binary, path, folder, asks_whether_well_posed, asks_for_noise):
    """Bakes and compares one scene; returns whether the two agree."""
    scene = Scene(path)
    began = time.monotonic()
    trouble = None
    if asks_whether_well_posed:
        trouble, peak, _, references = trouble_of(path)
        if asks_for_noise and amplifies_noise(path, references):
            trouble = trouble or "the reference amplifies noise"
        with open(path, encoding="utf-8") as text:
            if peak <= 0.02 and "nothing moves" not in text.read():
                trouble = trouble or "it hardly moves"
    else:
        references = bake(scene)
    print(f"     {path}: reference {time.monotonic() - began:.1f} s")
    if trouble:
        print(f"FAIL {path}: not well posed: {trouble}")
    return trouble is None and compare_binary(binary, scene, path, references, folder)


def compare_binary(binary, scene, path, references, folder):
    """Bakes a scene with one binary; returns whether it agrees."""
    folder = os.path.join(folder, "baked")
    os.makedirs(folder, exist_ok=True)
    out = os.path.join(folder, os.path.splitext(os.path.basename(path))[0] + ".npy")
    regions = os.path.join(folder, "regions.json")
    run = subprocess.run([binary, "bake", path, "-o", out, "--quiet", "--regions", regions],
                         capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(f"FAIL {path}: {os.path.basename(binary)}: exit {run.returncode} from bake: {run.stderr.strip()}")
        return False
    with open(regions, encoding="utf-8") as file:
        told = json.load(file)
    agrees = True
    for name, reference in references.items():
        file = output_path(out, scene, name)
        if not os.path.exists(file):
            print(f"FAIL {path}: {os.path.basename(binary)}: {os.path.basename(file)} was not written")
            agrees = False
            continue
        positions = np.load(file)
        tolerance, peak = tolerance_of(reference), reference.peak()
        message = first_difference(scene, name, reference, positions, tolerance)
        if message is None and is_at_rest(reference):
            message = rest_difference(binary, path, name, reference, folder)
        if message is None and reference.is_triangles:
            message = (patches_difference(told, name, reference) or
                       still_difference(binary, path, name, reference, folder))
        if message is None:
            worst = float(np.abs(positions - reference.world).max())
            relative = worst / peak if tolerance > 0 and peak > 0 else worst
            print(f"ok   {path}: {name}: difference {relative:.2e} of peak {peak:.6g}, "
                  f"{len(positions)} frames")
        else:
            print(f"FAIL {path}: {os.path.basename(binary)}: {message}")
            agrees = False
    return agrees


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", help="the pliant executable")
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--well-posed", action="store_true", help="also check that the scenes are well posed")
    parser.add_argument("--noise", action="store_true",
                        help="with --well-posed, also that they do not amplify noise, in twice the time")
    parser.add_argument("--keep", metavar="DIR", help="keep the bakes here, in a folder of each executable's name")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or temporary
        failed = [path for path in arguments.scenes
                  if not compare_scene(arguments.binary, path, folder, arguments.well_posed, arguments.noise)]
    count = len(arguments.scenes)
    print(f"{count - len(failed)} of {count} scenes agree")
    for path in failed:
        print(f"  failed: {path}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
