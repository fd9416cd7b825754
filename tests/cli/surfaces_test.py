"""Meshes that are no even grid, from scene to files: every command, every format."""

import base64
import json
import math
import os
import re

import numpy as np

from command import SOURCE, Command, main

RADIUS = 0.7


def ball(around=24, down=16):
    """A sphere of quads with a pole of triangles at each end: vertices and faces."""
    vertices = [(0, 1, 0)]
    for j in range(1, down):
        for i in range(around):
            t, p = math.pi * j / down, 2 * math.pi * i / around
            vertices.append((math.sin(t) * math.cos(p), math.cos(t), math.sin(t) * math.sin(p)))
    vertices.append((0, -1, 0))
    faces, last = [], 2 + (down - 2) * around
    for i in range(around):
        following = (i + 1) % around
        faces.append((1, 2 + following, 2 + i))
        for j in range(down - 2):
            a, b = 2 + j * around + i, 2 + j * around + following
            faces.append((a, b, b + around, a + around))
        faces.append((len(vertices), last + i, last + following))
    return vertices, faces


def ply_of(vertices, faces):
    header = f"""ply
format ascii 1.0
element vertex {len(vertices)}
property double x
property double y
property double z
element face {len(faces)}
property list uchar int vertex_indices
end_header
"""
    return header + "".join("%.17g %.17g %.17g\n" % tuple(v) for v in vertices) + "".join(
        "%d %s\n" % (len(face), " ".join(str(k - 1) for k in face)) for face in faces)


def gltf_of(vertices, faces):
    """Of triangles."""
    positions, indices = np.array(vertices, "<f4"), np.array(faces, "<u4") - 1
    numbers = positions.tobytes() + indices.tobytes()
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": indices.size, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": positions.nbytes},
                        {"buffer": 0, "byteOffset": positions.nbytes, "byteLength": indices.nbytes}],
        "buffers": [{"byteLength": len(numbers),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(numbers).decode()}]})


def collada_of(vertices, faces):
    numbers = " ".join("%.9g" % x for v in vertices for x in v)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_geometries><geometry id="g" name="ball"><mesh>
<source id="p"><float_array id="pa" count="{3 * len(vertices)}">{numbers}</float_array><technique_common>
<accessor source="#pa" count="{len(vertices)}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/>
<vcount>{" ".join(str(len(face)) for face in faces)}</vcount>
<p>{" ".join(str(k - 1) for face in faces for k in face)}</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def fbx_of(vertices, faces):
    # The last corner of a face is its complement.
    corners = [number for face in faces for number in [k - 1 for k in face[:-1]] + [-face[-1]]]
    return f"""; FBX 7.4.0 project file
FBXHeaderExtension:  {{
FBXHeaderVersion: 1003
FBXVersion: 7400
}}
Objects:  {{
Geometry: 10, "Geometry::", "Mesh" {{
Vertices: *{3 * len(vertices)} {{
a: {",".join("%.9g" % x for v in vertices for x in v)}
}}
PolygonVertexIndex: *{len(corners)} {{
a: {",".join(map(str, corners))}
}}
GeometryVersion: 124
}}
Model: 20, "Model::ball", "Mesh" {{
Version: 232
}}
}}
Connections:  {{
C: "OO", 20, 0
C: "OO", 10, 20
}}
"""


SCENE = """<scene version="1" start="1" end="{end}">
  <surface name="ball"><mesh file="{file}"{mesh}/>{parts}<material density="20" damping="40"/></surface>
  {force}
</scene>
"""
FORCE = ('<point name="poke" center="0 1 0" direction="0 -1 0" deformationRadius="0.7" forceRadius="0.4" '
         'magnitude="8000"/>')


class Surfaces(Command):
    def setUp(self):
        super().setUp()
        self.vertices, self.faces = ball()
        self.write("ball.obj", "".join("v %.17g %.17g %.17g\n" % v for v in self.vertices) +
                   "".join("f " + " ".join(map(str, f)) + "\n" for f in self.faces))

    def scene_of(self, file="ball.obj", mesh="", parts="", force=FORCE, end=6, name="s.xml"):
        return self.write(name, SCENE.format(file=file, mesh=mesh, parts=parts, force=force, end=end))

    def bake(self, scene, out, *arguments):
        return self.run_pliant("bake", scene, "-o", self.path(out), *arguments)

    def test_a_mesh_without_uvs_works_and_info_and_validate_tell_how_it_is_read(self):
        for command in ("info", "validate"):
            self.assertRegex(self.run_pliant(command, self.scene_of()).stderr,
                             r"^\S*s\.xml:2: note: ball: the mesh \S*ball\.obj is read as a surface, as most models "
                             r"are: .* \(it has no \(u,v\) \(UVs\)\); nothing is wrong, and .*\n$")
            asked = self.scene_of(mesh=' uv="surface"', name="asked.xml")
            self.assertEqual(self.run_pliant(command, asked).stderr, "")
        # Whoever works on the motion is not told again.
        scene = self.scene_of()
        for command in (("suggest", scene, "--peak", "0.2"), ("view", scene, "-o", self.path("a.html")),
                        ("replay", "record", scene, "-o", self.path("a.replay")),
                        ("bake", scene, "-o", self.path("a.npy"))):
            self.assertEqual(self.run_pliant(*command).stderr, "", command)
        frames = np.load(self.path("a.npy"))
        rest = np.array(self.vertices)
        self.assertTrue((frames[0] == rest).all())
        moved = (frames[5] != rest).any(axis=1)
        far = np.linalg.norm(rest - [0, 1, 0], axis=1) >= RADIUS
        self.assertFalse((moved & far).any())
        self.assertGreater(moved.sum(), 50)
        self.assertGreater(np.abs(frames - rest).max(), 0.01)
        self.bake(self.scene_of(mesh=' uv="surface"'), "b.npy")
        self.assertTrue((np.load(self.path("b.npy")) == frames).all())

    def test_every_format_has_the_same_motion(self):
        scene = self.scene_of(mesh=' uv="surface"')
        self.bake(scene, "a.npy")
        for out in ("a.glb", "a.gltf", "a.usda", "a.pc2", "a.mdd", "a.ply"):
            self.bake(scene, out)
        self.bake(scene, "a.obj")
        with open(self.path("a.0006.obj"), encoding="utf-8") as file:
            written = [list(map(float, line.split()[1:])) for line in file if line.startswith("v ")]
        self.assertTrue((np.array(written) == np.load(self.path("a.npy"))[5]).all())
        # Its own exports are meshes that it reads, also those with vertices split by normals.
        for again in ("a.0001.ply", "a.0001.obj"):
            self.bake(self.scene_of(file=again, mesh=' uv="surface"', name="again.xml"), "again.npy")
            self.assertTrue((np.load(self.path("again.npy")) == np.load(self.path("a.npy"))).all())
        self.bake(self.scene_of(file="a.glb", name="again.xml"), "again.npy")
        again = np.load(self.path("again.npy"))
        peak = np.abs(np.load(self.path("a.npy"))[5] - np.array(self.vertices)).max()
        # glTF has two triangles for a quad, which are stiffer.
        self.assertLess(abs(np.abs(again[5] - again[0]).max() - peak), 0.15 * peak)

    def test_every_mesh_format_without_uvs_has_the_same_motion(self):
        vertices, faces = ball(12, 8)
        vertices = np.round(64 * np.array(vertices)) / 64  # which every format keeps
        # glTF has triangles only.
        faces = [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]
        self.write("m.obj", "".join("v %.17g %.17g %.17g\n" % tuple(v) for v in vertices) +
                   "".join("f %d %d %d\n" % face for face in faces))
        for ending, made in (("ply", ply_of), ("gltf", gltf_of), ("dae", collada_of), ("fbx", fbx_of)):
            self.write(f"m.{ending}", made(vertices, faces))
        frames = {}
        for ending in ("obj", "ply", "gltf", "dae", "fbx"):
            self.assertEqual(self.bake(self.scene_of(file=f"m.{ending}"), "a.npy").stderr, "")
            frames[ending] = np.load(self.path("a.npy"))
        moves = frames["obj"] - frames["obj"][0]
        self.assertGreater(np.abs(moves).max(), 0.01)
        for ending in ("ply", "gltf"):
            self.assertTrue((frames[ending] == frames["obj"]).all(), ending)
        # These have a vertex for each corner, which one node moves; nodes in another order round differently.
        corners = np.array(faces).ravel() - 1
        far = np.linalg.norm(vertices - [0, 1, 0], axis=1) >= RADIUS
        for ending in ("dae", "fbx"):
            own = frames[ending] - frames[ending][0]
            self.assertTrue((frames[ending][0] == vertices[corners]).all(), ending)
            self.assertLess(np.abs(own - moves[:, corners]).max(), 1e-8 * np.abs(moves).max(), ending)
            self.assertTrue((own[:, far[corners]] == 0).all(), ending)

    def test_threads_caches_and_replays_keep_its_bits(self):
        scene = self.scene_of(end=10)
        self.bake(scene, "a.npy")
        self.bake(scene, "b.npy", "--threads", "4")
        self.bake(scene, "c.npy", "--cache", self.path("states"))
        self.bake(scene, "d.npy", "--cache", self.path("states"))
        for name in ("b.npy", "c.npy", "d.npy"):
            self.assertEqual(self.read(name), self.read("a.npy"))
        self.run_pliant("replay", "record", scene, "-o", self.path("a.replay"), "--states", "1")
        self.assertIn("all as recorded", self.run_pliant("replay", "verify", self.path("a.replay")).stdout)
        with open(self.path("a.replay"), encoding="utf-8") as file:
            surface = json.loads(file.readline())["surfaces"][0]
        self.assertEqual(surface, {"name": "ball", "grid": None, "nodes": len(self.vertices)})
        # A log that a node differs from names it.
        other = self.scene_of(end=10, force=FORCE.replace("8000", "8001"))
        self.run_pliant("replay", "record", other, "-o", self.path("b.replay"), "--states", "1")
        told = self.run_pliant("replay", "diff", self.path("a.replay"), self.path("b.replay"), code=1)
        self.assertRegex(told.stdout, r"positions differ, most at node \d+, by ")

    def test_regions_and_info_count_nodes_and_cells(self):
        scene = self.scene_of(end=3)
        self.bake(scene, "a.npy", "--regions", self.path("r.json"))
        surface = json.loads(self.read("r.json"))["frames"][1]["surfaces"][0]
        self.assertIsNone(surface["grid"])
        self.assertNotIn("regions", surface)
        piece, = surface["pieces"]
        self.assertEqual(piece["insideNodes"], surface["unknowns"])
        self.assertGreater(piece["cells"], 2 * piece["insideNodes"])
        force, = surface["forces"]
        self.assertEqual(force["insideNodes"] - force["heldNodes"], piece["insideNodes"])
        self.assertEqual(len(surface["cut"]), 32)
        with open(os.path.join(SOURCE, "docs", "regions.md"), encoding="utf-8") as file:
            page = file.read().partition("## Surfaces of triangles")[2]
        shown = json.loads(re.search(r"```json\n(.*?)```", page, re.DOTALL).group(1))
        self.assertEqual((shown.keys(), shown["pieces"][0].keys(), shown["forces"][0].keys()),
                         (surface.keys(), piece.keys(), force.keys()))
        late = self.scene_of(end=3, parts='<solver startFrame="2"/>')
        self.bake(late, "a.npy", "--regions", self.path("r.json"))
        idle, = json.loads(self.read("r.json"))["frames"][0]["surfaces"]
        self.assertEqual(idle.keys(), surface.keys())
        self.assertEqual((idle["grid"], idle["cut"], idle["pieces"], idle["solved"]), (None, None, [], False))

        told = self.run_pliant("info", scene).stdout
        self.assertRegex(told, r"surface of \d+ nodes in \d+ faces, 1 piece, 0 border edges, unit 3\.5")
        self.assertRegex(told, r"it selects \d+ nodes inside, \d+ cells")
        self.assertIn("first natural frequency", told)
        told = json.loads(self.run_pliant("info", scene, "--json").stdout)
        self.assertEqual((told["surfaces"][0]["nodes"], told["surfaces"][0]["pieces"]), (len(self.vertices), 1))

    def test_a_force_that_moves_on_leaves_it_as_it_was(self):
        force = FORCE.replace("/>", '><animate attribute="center"><key frame="1" value="0 1 0"/>'
                                    '<key frame="6" value="0 3 0"/></animate></point>').replace(
                                        ' center="0 1 0"', "")
        scene = self.scene_of(end=400, force=force, parts='<solver release="recover"/>')
        self.bake(scene, "a.npy")
        frames = np.load(self.path("a.npy"))
        self.assertGreater(np.abs(frames[3] - frames[0]).max(), 1e-3)
        self.assertTrue((frames[-1] == frames[0]).all())

    def test_warnings_name_what_is_odd(self):
        with open(self.path("ball.obj"), "a", encoding="utf-8") as file:
            file.write("f 1 2 2\nf 2 1 3\n")
        told = self.bake(self.scene_of(), "a.npy").stderr
        self.assertIn("s.xml:2: warning: 2 faces of \"ball\" take no part: ", told)
        told = self.bake(self.scene_of(force=FORCE.replace('"0.7"', '"9"').replace('"0.4"', '"9"')), "a.npy").stderr
        self.assertIn("a piece of \"ball\" lies wholly in the forces' spheres", told)
        told = self.bake(self.scene_of(force=FORCE.replace("0 1 0", "0.05 1 0.05").replace('"0.7"', '"0.02"')),
                         "a.npy").stderr
        self.assertNotIn("selects no node", told)
        self.assertIn('force "poke" reaches "ball" at frames 1-5, but no node is nearer', told)

    def test_a_force_that_is_zero_in_the_region_is_not_outside_it(self):
        # Inertia, while nothing accelerates.
        rig = ('<group name="rig" follow="ball" center="0 1 0" deformationRadius="0.7"><inertia name="lag" magnitude="1"/></group>')
        shift = """<transform><animate attribute="translate"><key frame="1" value="0 0 0"/><key frame="6" value="0 0 0"/>
<key frame="8" value="0 1 0"/></animate></transform>"""
        self.assertNotIn("warning", self.bake(self.scene_of(force=rig, parts=shift, end=12), "a.npy").stderr)

    def test_errors_name_line_and_rule(self):
        def refused(words, **changes):
            lines = self.run_pliant("bake", self.scene_of(**changes), "-o", self.path("no.npy"), code=2).stderr
            line, = [line for line in lines.splitlines() if "error" in line]
            self.assertRegex(line, r"^\S*s\.xml:2: error: ")
            for word in words:
                self.assertIn(word, line)
            self.assertNotIn("no.npy", self.files())

        refused(["ball.unit", "uv=\"grid\""], mesh=' uv="grid" unit="2"')
        refused(["the mesh is no even grid: it has no (u,v)", 'uv="surface"'], mesh=' uv="grid"')
        refused(["virtual", "uv=\"surface\""], mesh=' uv="virtual"')
        refused(["resolution", "uv=\"surface\""], mesh=' resolution="9"')
        refused(["unit", "0"], mesh=' unit="0"')
        refused(["unit", "one or two numbers"], mesh=' unit="1 2 3"')
        refused(["unit"], mesh=' unit="1 -2"')
        refused(["axis"], mesh=' axis="0 0 0"')
        refused(["weld"], mesh=' weld="-1"')
        refused(["border", "clamped"], mesh=' border="clampd"')
        refused(['reference="none" needs a grid'], parts='<solver reference="none"/>')
        text = SCENE.format(file="ball.obj", mesh=' border="free"', parts="", force=FORCE, end=3).replace(
            '<material ', '<material poisson="0.9" c="0.5" ')
        lines = self.run_pliant("validate", self.write("p.xml", text), code=2).stderr
        self.assertIn("ball.poisson is 0.9, but with a free border", lines)


if __name__ == "__main__":
    main()
