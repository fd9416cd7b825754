"""Compares the output of `pliant info` with bakes: for all examples, and for scenes made for this
test.

The peak of the animation is compared with a bake. If forces do not move, the scene is made constant
at the frame of greatest effect, baked until it has settled, and measured: the position of rest, the
time after which it stays near it, the frequency and the damping of its ringing. Whether a scene
rings or settles in time follows from its numbers; the number of measurements is checked at the end.

usage: info_test.py PLIANT SOURCE_FOLDER
"""

import glob
import json
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

import numpy as np

from shapes import without_cache

PLIANT, SOURCE = (os.path.abspath(argument) for argument in sys.argv[1:3])
FORCES = ("point", "radial", "line", "uniform", "vortex", "noise", "inertia", "pressure")
TOLERANCE = 0.1
LONGEST = 3000  # frames of a scene with constant forces

MADE = """<scene version="1" fps="{fps}" start="1" end="60">
  <surface name="sheet"><grid columns="{columns}" rows="{rows}" width="20" depth="{depth}"/>
    <material density="{density}" damping="{damping}" b="1" c="{c}" d="{d}"/>
    <solver {solver}/></surface>
  {forces}</scene>"""
ONE = '<point name="f" center="1 0 0.4" deformationRadius="7" forceRadius="2.2" magnitude="5000" falloff="smooth"/>'
LEFT = '<point name="l" center="-5.2 0 0" deformationRadius="4" forceRadius="1.6" magnitude="9000"/>'
RIGHT = '<point name="r" center="5.2 0 0.6" deformationRadius="4" forceRadius="3" magnitude="-4000"/>'
NEAR = '<point name="n" center="-1 0 2" deformationRadius="4" forceRadius="3" magnitude="4000"/>'
GROUP = f'<group name="g" deformationRadius="9">{re.sub("deformationRadius=.4. ", "", LEFT + NEAR)}</group>'
KEYED = ONE.replace(' magnitude="5000"', "").replace(
    "/>", '><animate attribute="magnitude"><key frame="1" value="0"/><key frame="9" value="6000"/>'
          '<key frame="14" value="-1000"/><key frame="30" value="0"/></animate></point>')


def made_scenes():
    usual = dict(fps=24, columns=41, rows=41, depth=20, density=40, damping=20, c=2, d=1, forces=ONE,
                 solver='measure="rest"')
    variants = [{}, {"density": 400}, {"density": 4}, {"damping": 0}, {"damping": 900},
                {"damping": 20000}, {"density": 0, "damping": 600}, {"density": 0, "damping": 0},
                {"density": 400, "solver": 'measure="rest" dt="0.002"'},
                {"density": 400, "solver": 'measure="rest" dt="0.04"'},
                {"density": 400, "solver": 'measure="rest" dt="0.03" stepping="overshoot"'},
                {"fps": 60, "density": 100}, {"rows": 21, "depth": 10}, {"d": 5, "c": -1},
                {"density": 900, "damping": 60, "forces": GROUP},
                {"density": 300, "forces": LEFT + RIGHT, "solver": 'measure="rest" combine="islands"'},
                {"density": 300, "forces": LEFT + NEAR, "solver": 'measure="rest" combine="union"'},
                {"density": 300, "forces": LEFT + RIGHT, "solver": 'measure="rest" combine="box"'},
                {"density": 200, "forces": KEYED}, {"density": 2000, "forces": KEYED}]
    for number, variant in enumerate(variants):
        yield f"made-{number}", MADE.format(**{**usual, **variant})


def run(*arguments):
    return subprocess.run([PLIANT, *arguments], check=True, capture_output=True, text=True,
                          timeout=600).stdout


def info(scene):
    return json.loads(run("info", scene, "--json"))


def bake(scene, surface):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "a.npy")
        # Where a transform takes the surface is no part of the peak.
        is_carried = tree.parse(scene).find(f"surface[@name='{surface}']/transform/animate") is not None
        space = "object" if is_carried else "world"
        run("bake", scene, "-o", out, "--surface", surface, "--space", space, "--quiet")
        return without_cache(scene, surface, np.load(out))


def is_close(told, measured):
    return abs(told - measured) <= TOLERANCE * abs(measured) + 1e-12


def stands_still(told, root):
    moving = [channel["path"] for channel in told["channels"]
              if channel["path"].rpartition(".")[2] not in ("magnitude", "enabled")]
    wavers = any(root.iter("noise")) or any(root.iter("path")) or any(
        "cache" in shape.keys() for shape in root.iter())
    return not moving and not wavers


def held(scene, text, told, preview):
    """The scene with every force constant as at the preview's frame, long enough to settle."""
    root = tree.fromstring(text)
    for force in [element for kind in FORCES + ("group",) for element in root.iter(kind)]:
        for animate in force.findall("animate"):
            path = f"{force.get('name')}.{animate.get('attribute')}"
            value = run("curves", scene, "--channel", path, "--frames",
                        str(preview["frame"])).splitlines()[1].split(",")[2]
            if animate.get("attribute") == "enabled":
                value = "true" if float(value) else "false"
            force.set(animate.get("attribute"), value)
            force.remove(animate)
    # Info describes the surface at rest. Only the peak of the animation includes nodes that a force
    # loses as the surface moves away.
    for surface in root.iter("surface"):
        for shape in [*surface.iter("mesh"), *surface.iter("map")]:
            if shape.get("file"):
                shape.set("file", os.path.join(os.path.dirname(scene), shape.get("file")))
        if surface.get("drivenBy"):
            continue
        solver = surface.find("solver")
        if solver is None:
            solver = tree.SubElement(surface, "solver")
        solver.set("measure", "rest")
    main_region = max(preview["regions"], key=lambda region: region["staticPeak"])
    frames = min(LONGEST, 6 * main_region["vibration"]["settlingFrames"] + 60)
    root.set("end", str(told["start"] + frames))
    return tree.tostring(root, encoding="unicode"), main_region["vibration"], frames


def crossings(way):
    """The times, between frames, at which a curve crosses 0."""
    at = np.nonzero(way[:-1] * way[1:] < 0)[0]
    return at + way[at] / (way[at] - way[at + 1])


def check_held(frames, told, preview, vibration, yields, count):
    displacement = frames - frames[0]
    sizes = np.linalg.norm(displacement[-1], axis=1)
    node = sizes.argmax()
    static = preview["staticPeak"]
    is_settled = len(frames) > 6 * vibration["settlingFrames"] + 30
    if not is_settled or static == 0:
        return
    assert is_close(static, sizes[node]), ("static peak", static, sizes[node])
    count["static peak"] += 1
    if yields:
        return  # its vibration is that of small motions
    away = displacement[:, node] @ (displacement[-1, node] / sizes[node]) / sizes[node] - 1
    far = np.nonzero(np.abs(away) > 0.05)[0]
    settled = far[-1] + 1
    told_frames = vibration["settlingFrames"]
    assert abs(told_frames - settled) <= max(1, TOLERANCE * settled), ("settles", told_frames, settled)
    count["settling"] += 1
    ratio, frequency = vibration["dampingRatio"], vibration["frequency"]
    if ratio is None or ratio > 0.3 or frequency > told["fps"] / 3:
        return
    # The slowest vibration lasts longest. The last frame represents the position of rest only
    # approximately, so the end of the curve is not used.
    period = told["fps"] / frequency
    first = int(0.5 * settled)
    way = away[first:4 * settled]
    at = crossings(way)
    if len(at) < 4:
        return
    measured = (len(at) - 1) / 2 / (at[-1] - at[0]) * told["fps"]
    assert is_close(frequency, measured), ("rings", frequency, measured)
    count["ring frequency"] += 1
    # Three consecutive frames of a decaying vibration: way[k+2] = p way[k+1] - q way[k].
    way = away[2 * settled:4 * settled]
    if period < 6 or len(way) < period:
        return
    size = np.abs(way[:-2])
    (p, q), *_ = np.linalg.lstsq(np.stack([way[1:-1], -way[:-2]], axis=1) / size[:, None],
                                 way[2:] / size, rcond=None)
    root = np.log(complex(p, np.sqrt(max(0.0, 4 * q - p * p))) / 2)
    measured = -root.real / abs(root)
    error = np.abs(p * way[1:-1] - q * way[:-2] - way[2:]) / np.abs(way).max()
    is_alone = error.max() < 0.02  # the others have decayed
    if is_alone and abs(abs(root.imag) * told["fps"] / (2 * np.pi) / frequency - 1) < 0.05:
        assert is_close(ratio, measured), ("damping ratio", ratio, measured)
        count["damping ratio"] += 1


def check(name, scene, folder, count):
    told = info(scene)
    with open(scene, encoding="utf-8") as file:
        text = file.read()
    # Info tells of nodes; those of nets and cages are not written.
    shapes = {surface.get("name"): surface for surface in tree.fromstring(text).iter("surface")}
    unwritten = [name for name, surface in shapes.items()
                 if surface.find("nurbs") is not None or surface.find("subdivision") is not None]
    for preview in told["together"]:
        if preview["surface"] in unwritten:
            continue
        frames = bake(scene, preview["surface"])
        sizes = np.linalg.norm(frames - frames[0], axis=2).max(axis=1)
        if preview["animation"]:
            assert is_close(preview["animation"]["peak"], sizes.max()), (
                name, "peak", preview["animation"], sizes.max())
            assert preview["animation"]["frame"] == told["start"] + sizes.argmax(), (name, preview)
            count["peak"] += 1
        if preview["frame"] is None or not stands_still(told, tree.fromstring(text)):
            continue
        if 'reference="none"' in text:
            continue  # its rest state is not the surface's rest shape
        if "<include" in text:
            continue  # what is changed to hold it stands in another file
        vibrations = [region["vibration"] for region in preview["regions"]]
        if any(vibration and "settlingFrames" not in vibration for vibration in vibrations):
            continue  # nothing holds it
        try:
            still, vibration, length = held(scene, text, told, preview)
            at_rest = os.path.join(folder, "held.xml")
            with open(at_rest, "w", encoding="utf-8") as file:
                file.write(still)
            check_held(bake(at_rest, preview["surface"]), told, preview, vibration, "yield=" in still, count)
            os.remove(at_rest)
        except AssertionError as error:
            raise AssertionError(f"{name}, {preview['surface']}: {error}") from error
    print("ok", name, dict(count), flush=True)


def main():
    count = dict.fromkeys(["peak", "static peak", "settling", "ring frequency", "damping ratio"], 0)
    examples = sorted(name for name in glob.glob(os.path.join(SOURCE, "examples/**/*.xml"), recursive=True)
                      if "parts" not in name.split(os.sep))  # those are included
    assert len(examples) >= 18, examples
    with tempfile.TemporaryDirectory() as folder:
        for scene in examples:
            # Next to the example, so that relative mesh paths work.
            with tempfile.TemporaryDirectory(dir=folder) as beside:
                check(os.path.basename(scene)[:-4], scene, beside, count)
        examples_alone = dict(count)
        for name, text in made_scenes():
            scene = os.path.join(folder, name + ".xml")
            with open(scene, "w", encoding="utf-8") as file:
                file.write(text)
            check(name, scene, folder, count)
    print("examples", examples_alone, "with those made for it", count)
    least = {"peak": 38, "static peak": 20, "settling": 20, "ring frequency": 12, "damping ratio": 8}
    for quantity, number in least.items():
        assert count[quantity] >= number, (quantity, count)


if __name__ == "__main__":
    main()
