"""Other programs open files that pliant writes, and must find our vertices at every frame; and
pliant opens files that Blender writes.

usage: interop_test.py PLIANT [PICTURE_FOLDER]

The programs are Khronos's glTF validator, three.js and tinyusdz in headless Chromium, and Blender.
Their results are compared with the float64 of .npy. Pictures by three.js and Blender go to
PICTURE_FOLDER. Needs the packages of `script/bootstrap --interop`. Ends with the line "N passed, N
failed".
"""

import json
import math
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import textwrap
import unittest

import numpy as np

import keys

HERE = os.path.dirname(os.path.abspath(__file__))
PLIANT = None
PICTURES = None

FRAMES = 12
COLUMNS, ROWS = 9, 7

# Two surfaces whose names clash in USD; one moves, turns and is mirrored, and its region crosses a
# mesh with a shading seam and two materials.
SCENE = """<scene version="1" fps="{fps}" start="1" end="{frames}">
  <surface name="relief-a"><mesh file="relief.obj"/>
    <transform rotate="20 30 -50" scale="1 1.5 -0.7"><animate attribute="translate">
      <key frame="1" value="0 0 0"/><key frame="{frames}" value="3 1 2"/></animate></transform></surface>
  <surface name="relief_a"><grid columns="13" rows="11" width="12" depth="10"/>
    <transform translate="0 -5 0"><animate attribute="rotate">
      <key frame="1" value="0 0 0"/><key frame="{frames}" value="300 45 90"/></animate></transform></surface>
  <point name="poke" center="0 0 0" direction="1 2 0.5" deformationRadius="6" forceRadius="2.5"
         magnitude="1500" targets="relief-a"/>
  <point name="press" center="0 -5 0" direction="1 2 0.5" deformationRadius="4.5" forceRadius="2.5"
         magnitude="3000" targets="relief_a"/>
</scene>
"""
SURFACES = ("relief-a", "relief_a")

# A sheet and colliders: one grows by its scale, one by its points, one is switched off, one is a mesh
# that a cache moves and its scale mirrors.
MET = """<scene version="1" fps="25" start="1" end="{frames}">
  <surface name="mat"><grid columns="31" rows="31" width="10" depth="10"/><material density="0.002" damping="0.001"/>
    <solver region="all"/></surface>
  <collider name="ball-1"><sphere>
      <animate attribute="radius"><key frame="1" value="0.8"/><key frame="{frames}" value="1.2"/></animate></sphere>
    <transform scale="-1 1 1"><animate attribute="translate">
      <key frame="1" value="0 3 0"/><key frame="{frames}" value="1 0.2 -1"/></animate></transform></collider>
  <collider name="arm"><capsule radius="0.4">
      <animate attribute="length"><key frame="1" value="1"/><key frame="{frames}" value="3"/></animate></capsule>
    <transform translate="-3 2 -2"><animate attribute="rotate">
      <key frame="1" value="0 0 20"/><key frame="{frames}" value="0 40 110"/></animate></transform></collider>
  <collider name="crate"><animate attribute="enabled"><key frame="1" value="true"/><key frame="6" value="false"/></animate>
    <box size="1 2 1.5"/><transform translate="-3 2 3" rotate="20 30 40" scale="1 1 2"/></collider>
  <collider name="pad"><box size="2 1 3" round="0.2"/><transform translate="3 1 2" scale="1 1.5 1"/></collider>
  <collider name="rock"><mesh file="rock.obj" cache="rock.npy"/>
    <transform scale="-1 1.5 0.5" rotate="0 30 0"><animate attribute="translate">
      <key frame="1" value="0 2 3"/><key frame="{frames}" value="1 2.5 3"/></animate></transform></collider>
  <collider name="floor"><plane/><transform translate="0 -1 0"/></collider>
</scene>
"""
SOLIDS = ("ball-1", "arm", "crate", "pad", "rock")
# A wedge, of triangles.
ROCK = np.array([[-1, 0, -0.5], [1, 0, -0.5], [1, 0, 0.75], [-1, 0, 0.75], [-1, 1.25, 0], [1, 1.5, 0]])
ROCK_FACES = ((0, 1, 2), (0, 2, 3), (0, 4, 5), (0, 5, 1), (3, 2, 5), (3, 5, 4), (0, 3, 4), (1, 5, 2))

# Converts from Blender's axes, +z up: rows times this matrix.
TO_Y_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])


def relief():
    """OBJ text of a relief with vertices and (u,v) in shuffled order, and its faces."""
    shuffle = random.Random(3)
    nodes = [(i, j) for j in range(ROWS) for i in range(COLUMNS)]
    vertices, uvs = nodes[:], nodes[:]
    shuffle.shuffle(vertices)
    shuffle.shuffle(uvs)
    vertex = {node: k + 1 for k, node in enumerate(vertices)}
    uv = {node: k + 1 for k, node in enumerate(uvs)}
    lines = ["o Head"]
    lines += [f"v {i - 4 + 0.03 * j} {0.3 * math.sin(i) + 0.2 * j} {j - 3}" for i, j in vertices]
    lines += [f"vt {i / (COLUMNS - 1)} {j / (ROWS - 1)}" for i, j in uvs]
    lines += ["g left part", "usemtl Skin red", "s 1"]
    faces = []
    for j in range(ROWS - 1):
        for i in range(COLUMNS - 1):
            if (i, j) == (0, 3):
                lines += ["usemtl Steel-2", "s off", "g right"]
            quad = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
            for corners in ([quad[:3], [quad[0], quad[2], quad[3]]] if i % 4 == 2 else [quad]):
                faces.append([vertex[node] - 1 for node in corners])
                lines.append("f " + " ".join(f"{vertex[node]}/{uv[node]}" for node in corners))
    return "\n".join(lines) + "\n", faces


def run(*command, **options):
    result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=240, **options)
    if result.returncode != 0:
        raise RuntimeError(f"{command[:3]}: {result.stdout[-3000:]}\n{result.stderr[-3000:]}")
    return result.stdout


def fps_of(rate):
    return {"film": 24000 / 1001, "whole": 25}[rate]


class Bakes:
    """All bakes, made once, and the results of each program."""

    def __init__(self, folder):
        self.folder = folder
        text, faces = relief()
        # Its scale mirrors the relief in world space, so that the order of corners turns too.
        self.faces = [face[:1] + face[:0:-1] for face in faces]
        self.write("relief.obj", text)
        self.expected = {}
        for rate, fps in (("film", "24000/1001"), ("whole", "25")):
            self.write(f"{rate}.xml", SCENE.format(fps=fps, frames=FRAMES))
        for kind, rate, space in (("world", "film", "world"), ("object", "film", "object"), ("whole", "whole", "world")):
            self.bake(rate, f"{kind}.npy", space)
            for name in SURFACES:
                self.expected[kind, name] = np.load(self.path(f"{kind}-{name}.npy"))
        for ending in ("obj", "ply", "pc2", "mdd", "glb", "gltf", "usda"):
            self.bake("film", f"world.{ending}", "world")
        for ending in ("glb", "usda"):
            self.bake("film", f"object.{ending}", "object")
        self.bake("whole", "whole.glb", "object")
        self.write("rock.obj", "".join(f"v {x} {y} {z}\n" for x, y, z in ROCK) +
                   "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in ROCK_FACES))
        self.rock = np.array([ROCK * (1 + 0.125 * frame) for frame in range(FRAMES)])
        np.save(self.path("rock.npy"), self.rock)
        self.write("met.xml", MET.format(frames=FRAMES))
        for ending in ("glb", "usda"):
            self.bake("met", f"met.{ending}", "world")
        self.bake("film", "part.glb", "world", "--frames", "4:9")
        self.bake("film", "part.pc2", "world", "--frames", "4:9")
        self.validated = json.loads(run("node", os.path.join(HERE, "validate_gltf.mjs"), *map(
            self.path, ("world.glb", "world.gltf", "object.glb", "part.glb", "met.glb"))))
        self.seen = {}
        self.ask_blender()
        self.ask_browser()

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def bake(self, rate, out, space, *more):
        run(PLIANT, "bake", self.path(f"{rate}.xml"), "-o", self.path(out), "--space", space, "--quiet", *more)

    def times(self, rate="film"):
        """Times of the frames and half-way between them, in single precision."""
        return [float(np.float32(k / 2 / fps_of(rate))) for k in range(2 * FRAMES - 1)]

    def ask_browser(self):
        jobs = [{"kind": "gltf", "file": "world.glb", "times": self.times(), "picture_at": 10},
                {"kind": "gltf", "file": "world.gltf", "times": self.times()},
                {"kind": "gltf", "file": "object.glb", "times": self.times()},
                {"kind": "gltf", "file": "part.glb", "times": self.times()[:11]},
                {"kind": "usd", "file": "world.usda"}, {"kind": "usd", "file": "object.usda"},
                {"kind": "gltf", "file": "met.glb", "times": self.times("whole")[::2]},
                {"kind": "usd", "file": "met.usda"}, {"kind": "tinyusdz", "file": "met.usda"},
                {"kind": "tinyusdz", "file": "world.usda"}, {"kind": "tinyusdz", "file": "object.usda"}]
        jobs[0]["picture"] = os.path.join(PICTURES, "three.png")
        for name in SURFACES:
            jobs.append({"kind": "mdd", "file": f"world-{name}.mdd"})
            for frame in range(1, FRAMES + 1):
                jobs += [{"kind": kind, "file": f"world-{name}.{frame:04}.{kind}"} for kind in ("obj", "ply")]
        chromium = shutil.which("chromium") or shutil.which("chromium-browser")
        results = json.loads(run("node", os.path.join(HERE, "browser.mjs"), self.folder, chromium,
                                 input=json.dumps(jobs)))
        for job, result in zip(jobs, results):
            self.seen["browser", job["kind"], job["file"]] = result

    def ask_blender(self):
        frames = list(range(1, FRAMES + 1))
        jobs = [{"kind": "gltf", "file": "whole.glb", "fps": [25, 1], "times": [k / 2 for k in range(2 * FRAMES - 1)],
                 "picture": os.path.join(PICTURES, "blender.png"), "picture_at": 5},
                {"kind": "gltf", "file": "met.glb", "fps": [25, 1], "times": list(range(FRAMES)),
                 "picture": os.path.join(PICTURES, "colliders.png"), "picture_at": 3},
                # Blender's glTF import knows only whole frame rates; our frames are 24 * 1001/24000
                # apart.
                {"kind": "gltf", "file": "world.glb", "fps": [24, 1],
                 "times": [1.001 * k / 2 for k in range(2 * FRAMES - 1)]}]
        for name in SURFACES:
            for ending in ("pc2", "mdd"):
                jobs.append({"kind": "cache", "file": f"world-{name}.{ending}", "mesh": f"world-{name}.obj",
                             "times": [1 + k / 2 for k in range(2 * FRAMES - 1)]})
            jobs.append({"kind": "mdd_keys", "file": f"world-{name}.mdd", "mesh": f"world-{name}.obj",
                         "times": frames})
            for frame in frames:
                jobs += [{"kind": kind, "file": f"world-{name}.{frame:04}.{kind}"} for kind in ("obj", "ply")]
        keys = [(job["kind"], job["file"]) for job in jobs]
        for job in jobs:
            for part in ("file", "mesh"):
                if part in job:
                    job[part] = self.path(job[part])
        self.write("jobs.json", json.dumps(jobs))
        run("blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
            os.path.join(HERE, "blender_look.py"), "--", self.path("jobs.json"), self.path("seen.json"))
        with open(self.path("seen.json"), encoding="utf-8") as file:
            for key, result in zip(keys, json.load(file)):
                self.seen["blender", *key] = result


def rows(numbers):
    return np.array(numbers, dtype=np.float64).reshape(-1, 3)


class Interop(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="pliant-interop-")
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.bakes = Bakes(cls.scratch.name)

    def expected(self, name, kind="world"):
        return self.bakes.expected[kind, name]

    def check(self, found, expected, size_of, roundings=2):
        """Compares positions in single precision; the tolerance is `roundings` half units in the
        last place of the largest."""
        self.assertEqual(found.shape, expected.shape)
        size = np.abs(size_of).max()
        self.assertLessEqual(np.abs(found - expected).max(), roundings * 2.0**-24 * size)

    def halves(self, frames):
        """The frames and the means between them, as from linear interpolation."""
        result = [frames[0]]
        for before, after in zip(frames, frames[1:]):
            result += [(before + after) / 2, after]
        return result

    def check_split(self, samples, expected, roundings):
        """Checks the vertices of a mesh that a program has split or reordered: each must move like
        our vertex at its first position."""
        first = rows(samples[0])
        distance = np.linalg.norm(first[:, None] - expected[0][None], axis=2)
        source = distance.argmin(axis=1)
        self.assertEqual(set(source), set(range(len(expected[0]))))
        for sample, frame in zip(samples, expected):
            self.check(rows(sample), frame[source], expected, roundings)

    # glTF

    def test_the_khronos_validator_finds_no_error_or_warning(self):
        self.assertEqual(len(self.bakes.validated), 5)
        for report in self.bakes.validated:
            self.assertEqual((report["errors"], report["warnings"], report["messages"]), (0, 0, []), report["file"])
            self.assertEqual((report["animations"], report["morphs"]), (1, True))

    def test_three_js_plays_gltf_at_frames_and_between(self):
        for file in ("world.glb", "world.gltf"):
            seen = self.bakes.seen["browser", "gltf", file]
            self.assertEqual(seen["complaints"], [])
            self.assertAlmostEqual(seen["duration"], (FRAMES - 1) / fps_of("film"), places=6)
            self.assertEqual(sorted(name for name in seen["materials"] if name), ["Skin red", "Steel-2"])
            for name in SURFACES:
                expected = self.expected(name)
                samples = seen["surfaces"][name]
                self.assertEqual(len(samples), 2 * FRAMES - 1)
                for sample, frame in zip(samples, self.halves(expected)):
                    # The weights half-way are computed from times in single precision.
                    self.check(rows(sample)[:len(frame)], frame, expected, 40)
                for sample, frame in zip(samples[::2], expected):
                    self.check(rows(sample)[:len(frame)], frame, expected, 4)
                self.check_split(samples[::2], expected, 4)

    def test_three_js_plays_gltf_nodes(self):
        seen = self.bakes.seen["browser", "gltf", "object.glb"]
        for name in SURFACES:
            samples = seen["surfaces"][name][::2]
            for sample, frame in zip(samples, self.expected(name)):
                self.check(rows(sample)[:len(frame)], frame, self.expected(name), 16)  # quaternions

    def test_three_js_plays_a_part_from_its_first_frame(self):
        seen = self.bakes.seen["browser", "gltf", "part.glb"]
        for name in SURFACES:
            for sample, frame in zip(seen["surfaces"][name][::2], self.expected(name)[3:9]):
                self.check(rows(sample)[:len(frame)], frame, self.expected(name), 4)

    def test_blender_plays_gltf_at_frames_and_between(self):
        for file, kind in (("whole.glb", "whole"), ("world.glb", "world")):
            seen = self.bakes.seen["blender", "gltf", file]
            for name in SURFACES:
                samples = [rows(sample) @ TO_Y_UP for sample in seen["positions"][name]]
                if kind == "world":  # placed surfaces turn on a circle between frames
                    self.check_split(samples, self.halves(self.expected(name)), 40)
                else:
                    self.check_split(samples[::2], self.expected(name, kind), 16)
            self.assertEqual(seen["objects"]["relief-a"]["materials"], ["Skin red", "Steel-2"])

    # Colliders

    def value(self, channel, frame):
        rows_ = run(PLIANT, "curves", self.bakes.path("met.xml"), "--channel", channel).splitlines()[1:]
        return np.array([float(number) for number in rows_[frame - 1].split(",")[2:]])

    def check_solids(self, points_of):
        """`points_of` a name and a frame: points in the world, whose chords lie inside."""
        for frame in range(1, FRAMES + 1):
            ball = np.linalg.norm(points_of("ball-1", frame) - self.value("ball-1.translate", frame), axis=1)
            self.assertLess(np.abs(ball - self.value("ball-1.radius", frame)).max(), 1e-5)
            tilt = np.radians(self.value("arm.rotate", frame)[2])  # the last turn, about z
            along = np.array([-np.sin(tilt), np.cos(tilt), 0])
            way = points_of("arm", frame) - [-3, 2, -2]
            half = self.value("arm.length", frame) / 2
            nearest = np.clip(way @ along, -half, half)[:, None] * along
            self.assertLess(np.abs(np.linalg.norm(way - nearest, axis=1) - 0.4).max(), 1e-5)
            crate = points_of("crate", frame)
            if frame < 6:
                corners = np.linalg.norm(crate - [-3, 2, 3], axis=1)
                self.assertLess(np.abs(corners - np.linalg.norm([0.5, 1, 1.5])).max(), 1e-5)
            else:  # hidden
                self.assertLess(len(crate) and np.abs(crate - [-3, 2, 3]).max(), 1e-5)
            pad = points_of("pad", frame)
            low, high = pad.min(axis=0), pad.max(axis=0)
            self.assertLess(np.abs(np.concatenate([low, high]) - [2, 0.25, 0.5, 4, 1.75, 3.5]).max(), 1e-5)
            # A point with several normals may come as often.
            rock = self.bakes.rock[frame - 1] * [-1, 1.5, 0.5]
            turn = np.radians(30)
            rock = rock @ np.array([[np.cos(turn), 0, -np.sin(turn)], [0, 1, 0], [np.sin(turn), 0, np.cos(turn)]])
            way = np.linalg.norm(points_of("rock", frame)[:, None] - rock - self.value("rock.translate", frame), axis=2)
            self.assertLess(max(way.min(axis=0).max(), way.min(axis=1).max()), 1e-5)

    def test_three_js_and_blender_move_the_colliders_of_gltf(self):
        seen = self.bakes.seen["browser", "gltf", "met.glb"]["surfaces"]
        self.assertEqual(sorted(seen), sorted(("mat", *SOLIDS)))
        self.check_solids(lambda name, frame: rows(seen[name][frame - 1]))
        blender = self.bakes.seen["blender", "gltf", "met.glb"]
        self.check_solids(lambda name, frame: rows(blender["positions"][name][frame - 1]) @ TO_Y_UP)
        for name in SOLIDS:
            self.assertEqual(blender["objects"][name]["materials"], ["collider"])
            self.assertEqual(blender["objects"][name]["keys"] > 0, name in ("arm", "rock"))

    def test_three_js_reads_the_colliders_of_usd(self):
        seen = self.bakes.seen["browser", "usd", "met.usda"]
        self.assertEqual(seen["complaints"], [])
        self.assertEqual(len(seen["meshes"]), 1 + len(SOLIDS))
        with open(self.bakes.path("met.usda"), encoding="utf-8") as file:
            text = file.read()

        def at(path, frame):
            """Linear between samples, held outside."""
            samples = seen["samples"][path]
            times, values = samples["times"], np.array(samples["values"], dtype=float)
            values = values.reshape(len(times), -1)
            return np.array([np.interp(frame, times, column) for column in values.T])

        def placement(name, operation, frame):
            if f"/scene/{name}.xformOp:{operation}" in seen["samples"]:
                return at(f"/scene/{name}.xformOp:{operation}", frame)[:3]  # the parser adds a NaN
            own = text[text.index(f'def Mesh "{name}"'):]
            found = re.search(rf"xformOp:{operation} = \((.*)\)", own)
            return np.array([float(number) for number in found[1].split(",")])

        def points_of(name, frame):
            name = name.replace("-", "_")
            shown = seen["samples"].get(f"/scene/{name}.visibility")
            if shown and "invisible" in shown["values"][frame - 1]:
                return np.empty((0, 3))
            points = at(f"/scene/{name}.points", frame).reshape(-1, 3) * placement(name, "scale", frame)
            for axis, angle in enumerate(np.radians(placement(name, "rotateXYZ", frame))):
                one, other = (axis + 1) % 3, (axis + 2) % 3
                turned = points.copy()
                turned[:, one] = np.cos(angle) * points[:, one] - np.sin(angle) * points[:, other]
                turned[:, other] = np.sin(angle) * points[:, one] + np.cos(angle) * points[:, other]
                points = turned
            return points + placement(name, "translate", frame)

        self.check_solids(points_of)
        self.assertTrue(self.bakes.seen["browser", "tinyusdz", "met.usda"]["is_loaded"])
        self.assertEqual(len(self.bakes.seen["browser", "tinyusdz", "met.usda"]["meshes"]), 1 + len(SOLIDS))

    # Point caches

    def test_headers_and_sizes_of_point_caches(self):
        for name in SURFACES:
            frames, vertices, _ = self.expected(name).shape
            with open(self.bakes.path(f"world-{name}.pc2"), "rb") as file:
                data = file.read()
            self.assertEqual(struct.unpack("<12siiffi", data[:32]),
                             (b"POINTCACHE2\0", 1, vertices, 1.0, 1.0, frames))
            self.assertEqual(len(data), 32 + 12 * vertices * frames)
            self.check(np.frombuffer(data, "<f4", offset=32).reshape(frames, vertices, 3).astype(float),
                       self.expected(name), self.expected(name), 1)
            with open(self.bakes.path(f"world-{name}.mdd"), "rb") as file:
                data = file.read()
            self.assertEqual(struct.unpack(">ii", data[:8]), (frames, vertices))
            self.assertEqual(len(data), 8 + 4 * frames + 12 * vertices * frames)
            self.assertTrue((np.frombuffer(data, ">f4", frames, 8) ==
                             (np.arange(frames) / fps_of("film")).astype(np.float32)).all())
        with open(self.bakes.path(f"part-{SURFACES[0]}.pc2"), "rb") as file:
            self.assertEqual(struct.unpack("<12siiffi", file.read(32))[3:], (4.0, 1.0, 6))

    def test_blender_s_mesh_cache_moves_the_mesh_beside_it(self):
        for name in SURFACES:
            for ending in ("pc2", "mdd"):
                seen = self.bakes.seen["blender", "cache", f"world-{name}.{ending}"]
                (samples,) = seen["positions"].values()
                for sample, frame in zip(samples, self.halves(self.expected(name))):
                    # Half-way, Blender computes the place in the file from the scene's rate.
                    self.check(rows(sample) @ TO_Y_UP, frame, self.expected(name), 40)

    def test_blender_s_mdd_import_makes_the_same_shapes(self):
        for name in SURFACES:
            seen = self.bakes.seen["blender", "mdd_keys", f"world-{name}.mdd"]
            (samples,) = seen["positions"].values()
            for sample, frame in zip(samples, self.expected(name)):
                self.check(rows(sample) @ TO_Y_UP, frame, self.expected(name), 4)

    def test_three_js_reads_mdd(self):
        for name in SURFACES:
            seen = self.bakes.seen["browser", "mdd", f"world-{name}.mdd"]
            self.check(np.array(seen["frames"]).reshape(self.expected(name).shape), self.expected(name),
                       self.expected(name), 1)

    # Sequences

    def test_blender_reads_obj_and_ply(self):
        for name in SURFACES:
            for frame, expected in enumerate(self.expected(name), 1):
                for kind in ("obj", "ply"):
                    seen = self.bakes.seen["blender", kind, f"world-{name}.{frame:04}.{kind}"]
                    ((sample,),) = seen["positions"].values()
                    self.check(rows(sample), expected, self.expected(name))

    def test_what_blender_finds_besides_positions(self):
        (found,) = self.bakes.seen["blender", "obj", "world-relief-a.0003.obj"]["objects"].values()
        self.assertEqual(found["faces"], self.bakes.faces)
        self.assertEqual(found["materials"], ["Skin red", "Steel-2"])
        half = found["material_of_face"].index(1)
        self.assertEqual(found["material_of_face"], [0] * half + [1] * (len(found["faces"]) - half))
        self.assertEqual(found["smooth"], [True] * half + [False] * (len(found["faces"]) - half))
        self.assertEqual(len(found["uvs"]), sum(map(len, self.bakes.faces)))

    def test_three_js_reads_obj_and_ply(self):
        columns, grid_rows = 13, 11
        sheet = [[j * columns + i, (j + 1) * columns + i, (j + 1) * columns + i + 1, j * columns + i + 1]
                 for j in range(grid_rows - 1) for i in range(columns - 1)]
        for name, faces in zip(SURFACES, (self.bakes.faces, sheet)):
            corners = [face[k] for face in faces for n in range(1, len(face) - 1) for k in (0, n, n + 1)]
            for frame, expected in enumerate(self.expected(name), 1):
                obj = self.bakes.seen["browser", "obj", f"world-{name}.{frame:04}.obj"]
                found = rows([number for mesh in obj["meshes"] for number in mesh["positions"]])
                self.check(found, expected[corners], self.expected(name))
                ply = self.bakes.seen["browser", "ply", f"world-{name}.{frame:04}.ply"]
                self.check(rows(ply["positions"]), expected, self.expected(name))

    # USD

    def test_three_js_reads_every_sample_of_usd(self):
        for file, space in (("world.usda", "world"), ("object.usda", "object")):
            seen = self.bakes.seen["browser", "usd", file]
            self.assertEqual(seen["complaints"], [])
            self.assertEqual(len(seen["meshes"]), 2)
            layer = seen["layer"]
            self.assertEqual((layer["upAxis"], layer["defaultPrim"]), ("Y", "scene"))
            for name, prim in zip(SURFACES, ("relief_a", "relief_a_2")):
                samples = seen["samples"]
                points = samples[f"/scene/{prim}.points"]
                self.assertEqual(points["times"], list(range(1, FRAMES + 1)))
                found = np.array(points["values"]).reshape(FRAMES, -1, 3)
                expected = self.expected(name, space)
                self.check(found, expected, expected)  # shortest text, so rounded too
                extent = np.array(samples[f"/scene/{prim}.extent"]["values"]).reshape(FRAMES, 2, 3)
                self.check(extent, np.stack([expected.min(axis=1), expected.max(axis=1)], axis=1), expected)
                velocities = np.array(samples[f"/scene/{prim}.velocities"]["values"]).reshape(FRAMES, -1, 3)
                way = np.diff(expected, axis=0) * fps_of("film")
                self.check(velocities, np.concatenate([way, way[-1:]]), way)

    def test_tinyusdz_reads_usd(self):
        for file, space in (("world.usda", "world"), ("object.usda", "object")):
            seen = self.bakes.seen["browser", "tinyusdz", file]
            self.assertTrue(seen["is_loaded"], seen["message"])
            self.assertEqual(len(seen["meshes"]), 2)
            for name, mesh in zip(SURFACES, seen["meshes"]):
                first = self.expected(name, space)[0]
                found = rows(mesh["points"])
                distance = np.linalg.norm(found[:, None] - first[None], axis=2)
                size = np.abs(first).max()
                self.assertLessEqual(distance.min(axis=1).max(), 4 * 2.0**-24 * size)
                self.assertEqual(set(distance.argmin(axis=1)), set(range(len(first))))


# Blender's exporters in docs/meshes.md: the factor of lengths, and whether +y is up.
EXPORTS = {"sheet.obj": (1, True), "sheet.ply": (1, False), "sheet.glb": (1, True), "sheet.gltf": (1, True),
           "sheet.fbx": (1, True), "default.fbx": (100, True), "sheet.dae": (1, True)}

# A force at a point from Blender, in the axes and unit of the file. Its radius is about a third of
# the sheet.
POKE = """<scene version="1" fps="24" start="1" end="6"><surface name="s"><mesh file="{file}"/></surface>
<point name="poke" center="{center}" direction="0 1 0" deformationRadius="{reach}" forceRadius="{half}"
 magnitude="{magnitude}"/></scene>
"""


class FromBlender(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="pliant-blender-")
        cls.addClassCleanup(cls.scratch.cleanup)
        run("blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
            os.path.join(HERE, "blender_export.py"), "--", cls.scratch.name)
        cls.world = np.load(os.path.join(cls.scratch.name, "world.npy"))

    def bake(self, file, points, size):
        """The frames of the mesh under a force at the first of the points."""
        scene = os.path.join(self.scratch.name, "scene.xml")
        with open(scene, "w", encoding="utf-8") as out:
            out.write(POKE.format(file=file, center=" ".join(map(str, points[31])), reach=0.8 * size,
                                  half=0.4 * size, magnitude=2000 * size))
        frames = os.path.join(self.scratch.name, "frames.npy")
        run(PLIANT, "bake", scene, "-o", frames, "--quiet")
        return np.load(frames)

    def test_axes_and_units_are_those_of_the_page(self):
        for file, (size, is_y_up) in EXPORTS.items():
            with self.subTest(file):
                points = size * (self.world @ TO_Y_UP if is_y_up else self.world)
                frames = self.bake(file, points, size)
                distance = np.linalg.norm(frames[0][:, None] - points[None], axis=2)
                source = distance.argmin(axis=1)
                # Six decimals in the text of an OBJ.
                self.assertLess(distance.min(axis=1).max(), 1e-6 * np.abs(points).max())
                self.assertEqual(set(source), set(range(len(points))))
                # The force lifts the vertex where it was placed, along the file's +y.
                way = frames[-1] - frames[0]
                self.assertEqual(points[source[way[:, 1].argmax()]].tolist(), points[31].tolist())
                self.assertGreater(way[:, 1].max(), 1e-3 * size)
                self.assertLess(np.abs(way[:, [0, 2]]).max(), 1e-9 * size)


# The walk of docs/interchange.md, from a frame that is not 1.
WALK = """<scene version="1" fps="24" start="{start}" end="{end}">
  <surface name="tube">
    <mesh file="character.obj" cache="walk.npy" cacheStart="{start}"/>
    <material density="1" damping="4"/>
    <solver region="all" integrator="newmark"/>
  </surface>{force}
</scene>
"""


class Walk(unittest.TestCase):
    START = 5

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="pliant-walk-")
        cls.addClassCleanup(cls.scratch.cleanup)
        with open(os.path.join(HERE, "../../docs/interchange.md"), encoding="utf-8") as page:
            (script,) = re.findall(r"```python\n(.*?walk\.npy.*?)```", page.read(), re.DOTALL)
        script = textwrap.dedent(script)
        assert script.count('"/tmp/walk.npy"') == 1
        with open(cls.path("page.py"), "w", encoding="utf-8") as file:
            file.write(script.replace("/tmp/walk.npy", cls.path("walk.npy")))
        cls.blender("export", cls.path("page.py"), cls.scratch.name, str(cls.START))
        for name, force in (("still", ""), ("jiggle", '\n  <inertia name="sway" forceRadius="1000"/>')):
            with open(cls.path(f"{name}.xml"), "w", encoding="utf-8") as file:
                file.write(WALK.format(start=cls.START, end=cls.START + 11, force=force))
            for ending in ("pc2", "npy"):
                run(PLIANT, "bake", cls.path(f"{name}.xml"), "-o", cls.path(f"{name}.{ending}"), "--space", "object",
                    "--quiet")
        cls.blender("home", cls.scratch.name, str(cls.START), "still.pc2", "jiggle.pc2")

    @classmethod
    def path(cls, name):
        return os.path.join(cls.scratch.name, name)

    @classmethod
    def blender(cls, *words):
        run("blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
            os.path.join(HERE, "blender_walk.py"), "--", *words)

    def load(self, name):
        return np.load(self.path(name)).astype(np.float64)

    def test_a_walk_without_forces_comes_home_as_the_bones_made_it(self):
        posed = self.load("posed.npy")
        self.assertGreater(np.abs(posed - posed[0]).max(), 0.5)
        self.assertLess(np.abs(self.load("walk.npy") - posed).max(), 1e-6)
        self.assertLess(np.abs(self.load("still.pc2.npy") - posed).max(), 1e-6)

    def test_a_jiggle_comes_home_as_it_was_baked(self):
        baked = self.load("jiggle.npy")
        self.assertGreater(np.abs(baked - self.load("posed.npy")).max(), 0.02)
        self.assertLess(np.abs(self.load("jiggle.pc2.npy") - baked).max(), 1e-6)


class Painted(unittest.TestCase):
    """The face of examples/cheek.xml, whose masks Blender paints."""

    def test_masks_that_blender_paints_move_a_face_that_blender_shows(self):
        examples = os.path.join(HERE, "../../examples")
        with tempfile.TemporaryDirectory(prefix="pliant-cheek-") as scratch:
            def blender(*words):
                run("blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
                    os.path.join(examples, "blender_cheek.py"), "--", *words)

            blender("paint", os.path.join(scratch, "cheek.glb"))
            shutil.copy(os.path.join(examples, "cheek.xml"), scratch)
            frames = []
            for name, folder in (("here.npy", scratch), ("there.npy", examples)):
                run(PLIANT, "bake", os.path.join(folder, "cheek.xml"), "-o", os.path.join(scratch, name),
                    "--space", "object", "--quiet")
                frames.append(np.load(os.path.join(scratch, name)))
            self.assertLess(np.abs(frames[0] - frames[1]).max(), 1e-4)

            moved = np.linalg.norm(frames[0] - frames[0][0], axis=2).max(axis=0)
            x, y, z = frames[0][0].T
            self.assertGreater(moved.max(), 0.5)
            self.assertLess(moved[y > 1].max(), 0.05 * moved.max(), "the skull moves")
            self.assertLess(moved[(np.abs(x) < 0.3) & (y > -1) & (z > 4)].max(), 0.07 * moved.max(), "the nose moves")

            run(PLIANT, "bake", os.path.join(scratch, "cheek.xml"), "-o", os.path.join(scratch, "ring.glb"), "--quiet")
            picture = os.path.join(PICTURES, "cheek.png")
            blender("home", os.path.join(scratch, "ring.glb"), "12", picture)
            self.assertGreater(os.path.getsize(picture), 10000)


class Keys(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="pliant-interop-")
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.keys = keys.Keys(PLIANT, cls.scratch.name)

    def test_blender_shows_the_keys_of_a_scene(self):
        told = self.keys.told
        seen = self.keys.load("seen.json")
        self.assertEqual(len(seen), keys.COUNT)
        wrong = self.keys.disagreements("ours.xml", seen, lambda number: f"note: f{number}.magnitude:" in told,
                                        1.1 / 1024, (1, 60))
        self.assertEqual(wrong, [], told)

    def test_a_scene_shows_the_keys_of_blender(self):
        told = self.keys.read_told
        seen = self.keys.load("made.json")
        self.assertEqual(len(seen), keys.COUNT)
        # Copies that are counted on one side and endless on the other end otherwise.
        wrong = self.keys.disagreements(
            "theirs.xml", seen, lambda number: f'note: Ball.["p{number}"]:' in told, 0)
        wrong = [each for each in wrong if f'Ball.["p{each[0]}"]: its copies end otherwise' not in told]
        self.assertEqual(wrong, [], told)


def main():
    global PLIANT, PICTURES
    PLIANT = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as pictures:
        PICTURES = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else pictures
        os.makedirs(PICTURES, exist_ok=True)
        cases = (Interop, FromBlender, Walk, Painted, Keys)
        suite = unittest.TestSuite(map(unittest.defaultTestLoader.loadTestsFromTestCase, cases))
        result = unittest.TextTestRunner(verbosity=2).run(suite)
    failed = len(result.failures) + len(result.errors)
    # A failure in the shared setup counts once; then no test has run.
    print(f"{result.testsRun - failed if result.testsRun else 0} passed, {failed} failed")
    sys.exit(0 if failed == 0 and result.testsRun > 0 else 1)


if __name__ == "__main__":
    main()
