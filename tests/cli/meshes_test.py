"""Meshes of other people: mirrored, with several objects, with small faults."""

import json
import re
import struct

import numpy as np

from command import Command, animated, main

SIDE = 6


def relief():
    """Triangles of a sheet in relief, of exact numbers: vertices and faces."""
    vertices = [(i / 4, ((i * 3 + j * 5) % 4) / 16, j / 4) for j in range(SIDE) for i in range(SIDE)]
    faces = []
    for j in range(SIDE - 1):
        for i in range(SIDE - 1):
            a = j * SIDE + i
            faces += [(a, a + SIDE, a + SIDE + 1), (a, a + SIDE + 1, a + 1)]
    return vertices, faces


def gltf_of(vertices, faces, **node):
    positions, indices = np.array(vertices, "<f4"), np.array(faces, "<u4")
    numbers = positions.tobytes() + indices.tobytes()
    content = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **node}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": indices.size, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": positions.nbytes},
                        {"buffer": 0, "byteOffset": positions.nbytes, "byteLength": indices.nbytes}],
        "buffers": [{"byteLength": len(numbers)}]}).encode()
    content += b" " * (-len(content) % 4)
    numbers += b"\0" * (-len(numbers) % 4)
    chunks = struct.pack("<I4s", len(content), b"JSON") + content + struct.pack("<I4s", len(numbers), b"BIN\0") + numbers
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def obj_of(vertices, faces):
    return "".join("v %r %r %r\n" % tuple(v) for v in vertices) + "".join(
        "f %d %d %d\n" % tuple(k + 1 for k in face) for face in faces)


def scene_of(mesh, more="", attributes="", end=3):
    return (f'<scene version="1" start="1" end="{end}"><surface name="pad"><mesh file="{mesh}" {attributes}/>{more}'
            '<solver region="all"/></surface>'
            '<uniform name="up" direction="1 2 3" magnitude="50" deformationRadius="9" forceRadius="9"/></scene>')


def areas_of(positions, faces):
    a, b, c = (np.asarray(positions, float)[np.asarray(faces)[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


class Meshes(Command):
    def write_bytes(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)

    def obj(self, name):
        """Vertices, normals, and of each face its vertices and its normals, of an OBJ."""
        vertices, normals, faces, of_faces = [], [], [], []
        for line in self.read(name).decode().splitlines():
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append([float(word) for word in words[1:4]])
            elif words[:1] == ["vn"]:
                normals.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
                of_faces.append([int((word + "//").split("/")[2] or 0) - 1 for word in words[1:]])
        return vertices, normals, faces, of_faces

    def glb(self, name):
        """Positions, normals and faces of the first primitive of a .glb, at rest."""
        data = self.read(name)
        length = struct.unpack_from("<I", data, 12)[0]
        content, numbers = json.loads(data[20:20 + length]), data[28 + length:]
        primitive = content["meshes"][0]["primitives"][0]

        def array(accessor, kind, width):
            entry = content["accessors"][accessor]
            view = content["bufferViews"][entry["bufferView"]]
            start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
            kind = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[entry["componentType"]]
            return np.frombuffer(numbers, kind, entry["count"] * width, start).reshape(-1, width)
        return (array(primitive["attributes"]["POSITION"], "<f4", 3), array(primitive["attributes"]["NORMAL"], "<f4", 3),
                array(primitive["indices"], "<u4", 1).reshape(-1, 3))

    def test_a_mirrored_file_is_as_its_geometry_written_out(self):
        vertices, faces = relief()
        mirrored = [(-x, y, z) for x, y, z in vertices]
        turned = [(a, c, b) for a, b, c in faces]
        self.write_bytes("node.glb", gltf_of(vertices, faces, scale=[-1, 1, 1]))
        self.write_bytes("twin.glb", gltf_of(mirrored, turned))
        # Along an axis v depends on the turn of the faces, and the slopes of the rim on v.
        tangents = '<tangents su0="0.3" su1="0.1" sv0="0.7" sv1="-0.4"/>'
        for name in "node", "twin":
            self.write(name + ".xml", scene_of(name + ".glb", tangents, 'uv="surface" axis="1 0 0"'))
            for ending in "npy", "obj", "usda", "glb":
                self.run_pliant("bake", name + ".xml", "-o", f"{name}-out.{ending}", "--quiet")
        for file in ".npy", ".0001.obj", ".0003.obj", ".usda":
            self.assertEqual(self.read("node-out" + file), self.read("twin-out" + file), file)
        for one, other in zip(self.glb("node-out.glb"), self.glb("twin-out.glb")):
            self.assertTrue((one == other).all())

    def test_faces_and_normals_look_the_same_way_in_every_world(self):
        vertices, faces = relief()
        self.write_bytes("pad.glb", gltf_of(vertices, faces))
        for scale in (1, 1, 1), (-1, 1, 1), (2, -1, 1), (-1, -1, 1), (-1, -2, -1):
            text = " ".join(map(str, scale))
            self.write("pad.xml", scene_of("pad.glb", f'<transform scale="{text}" rotate="10 20 30"/>'))
            for ending in "obj", "glb", "usda", "ply":
                self.run_pliant("bake", "pad.xml", "-o", "pad-out." + ending, "--quiet")
            # Rotations keep directions, so only the scale decides: cofactors of the reflection.
            positions, normals, written, of_faces = self.obj("pad-out.0001.obj")
            areas = areas_of(positions, written)
            plain = self.outward(scale, vertices, faces)
            np.testing.assert_allclose(np.linalg.norm(areas, axis=1), np.linalg.norm(plain, axis=1), rtol=1e-9)
            sign = np.sign(np.prod(scale))
            self.assertEqual(written[0][0], faces[0][0])  # the first corner stays
            expected = faces if sign > 0 else [(a, c, b) for a, b, c in faces]
            self.assertEqual([tuple(face) for face in written], expected)
            for face, corner_normals in zip(areas, of_faces):
                for normal in corner_normals:
                    self.assertGreater(np.dot(normals[normal], face), 0)
            points, directions, triangles = self.glb("pad-out.glb")
            self.assertTrue((points[triangles] == points[np.array(expected)]).all())  # a flat file splits vertices
            for face, area in zip(triangles, areas_of(points, triangles)):
                self.assertTrue((directions[face] @ area > 0).all())
            indices = re.search(r"faceVertexIndices = \[([^\]]*)\]", self.read("pad-out.usda").decode()).group(1)
            self.assertEqual([int(k) for k in indices.split(",")], [k for face in expected for k in face])
            # In its own space nothing turns.
            self.run_pliant("bake", "pad.xml", "-o", "own.obj", "--space", "object", "--quiet")
            self.assertEqual([tuple(face) for face in self.obj("own.0001.obj")[2]], faces)
            self.run_pliant("bake", "pad.xml", "-o", "own.glb", "--space", "object", "--quiet")
            points, _, triangles = self.glb("own.glb")
            self.assertTrue((points[triangles] == points[np.array(faces)]).all())

    @staticmethod
    def outward(scale, vertices, faces):
        return areas_of(np.array(vertices) * np.array(scale), faces)

    def test_driven_surfaces_cages_and_nets_turn_as_well(self):
        vertices, faces = relief()
        self.write("pad.obj", obj_of(vertices, faces))
        points = "\n".join("%d 0 %d" % (i, j) for j in range(4) for i in range(4))
        shapes = {
            "net": f'<nurbs columns="4" rows="4" degreeU="2" degreeV="2"><points>{points}</points></nurbs>',
            "cage": '<subdivision file="pad.obj" levels="1" scheme="loop"/>',
            "sheet": '<grid columns="4" rows="5"/>',
        }
        for name, shape in shapes.items():
            written = {}
            for scale in "1 1 1", "1 1 -1":
                self.write("a.xml", f'<scene version="1" start="1" end="1"><surface name="s">{shape}'
                           f'<transform scale="{scale}"/></surface></scene>')
                self.run_pliant("bake", "a.xml", "-o", "a.obj", "--quiet")
                written[scale] = self.obj("a.0001.obj")[2]
            turned = [face[:1] + face[:0:-1] for face in written["1 1 1"]]
            self.assertEqual(written["1 1 -1"], turned, name)
        self.write("a.xml", '<scene version="1" start="1" end="1"><surface name="c"><grid columns="4" rows="4"/></surface>'
                   '<surface name="s" drivenBy="c"><mesh file="pad.obj"/><transform scale="-1 1 1"/></surface></scene>')
        self.run_pliant("bake", "a.xml", "-o", "a.obj", "--surface", "s", "--quiet")
        self.assertEqual([tuple(face) for face in self.obj("a.0001.obj")[2]], [(a, c, b) for a, b, c in faces])

    def test_a_scale_that_changes_its_sign(self):
        vertices, faces = relief()
        turned = [(a, c, b) for a, b, c in faces]
        self.write_bytes("pad.glb", gltf_of(vertices, faces))
        flip = animated("scale", (1, "1 1 1"), (2, "-1 1 1"), (3, "1 1 1")).replace(
            "<animate ", '<animate interpolation="step" ')
        self.write("pad.xml", scene_of("pad.glb", f"<transform>{flip}</transform>"))
        self.run_pliant("bake", "pad.xml", "-o", "a.obj", "--quiet")
        self.assertEqual([[tuple(face) for face in self.obj(f"a.000{k}.obj")[2]] for k in (1, 2, 3)],
                         [faces, turned, faces])
        for frames, expected in (("1:3", faces), ("2:3", turned)):
            self.run_pliant("bake", "pad.xml", "-o", "a.glb", "--quiet", "--frames", frames)
            points, _, triangles = self.glb("a.glb")
            self.assertTrue((points[triangles] == points[np.array(expected)]).all())

    def test_every_object_is_listed_and_chosen(self):
        vertices, faces = relief()
        sheet = obj_of(vertices, faces)
        names = ["", "a / b", "a / b", 'q "x" <y>&', "n" * 300, "Üñ", "x 2"]
        self.write("set.obj", sheet + "".join(
            f"o {name}\n" + obj_of([], faces[:20 + k]) for k, name in enumerate(names[1:])))
        listed = json.loads(self.run_pliant("info", "set.obj", "--json").stdout)
        self.assertEqual(listed["format"], "pliant-mesh-1")
        self.assertEqual([each["name"] for each in listed["objects"]], names)
        self.assertEqual([each["number"] for each in listed["objects"]], list(range(1, 8)))
        choices = [each["object"] for each in listed["objects"]]
        self.assertEqual(choices, ["#1", "a / b#1", "a / b#2", 'q "x" <y>&', "n" * 300, "Üñ", "x 2"])
        text = self.run_pliant("info", "set.obj").stdout
        for each in listed["objects"]:
            self.assertRegex(text, f'(?m)^ +{each["number"]} +{each["vertices"]} +{each["faces"]}  '
                             + re.escape(each["object"]) + "$")
            choice = each["object"].replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
            for chosen in choice, f'#{each["number"]}':
                self.write("a.xml", f'<scene version="1" start="1" end="1"><surface name="s"><mesh file="set.obj" '
                           f'object="{chosen}"/></surface></scene>')
                self.run_pliant("bake", "a.xml", "-o", "a.obj", "--quiet")
                self.assertEqual(len(self.obj("a.0001.obj")[2]), each["faces"])
                self.assertEqual(len(self.obj("a.0001.obj")[0]), each["vertices"])
        self.write("a.xml", '<scene version="1" start="1" end="1"><surface name="s"><mesh file="set.obj"/></surface></scene>')
        self.assertIn("`pliant info FILE` lists all", self.run_pliant("bake", "a.xml", "-o", "a.obj", code=2).stderr)
        self.assertIn("--set", self.run_pliant("info", "set.obj", "--set", "a.b=1", code=2).stderr)
        self.write("none.obj", "v 0 0 0\n")
        self.assertIn("no faces", self.run_pliant("info", "none.obj", code=2).stderr)

    def test_new_takes_an_object_and_a_root(self):
        vertices, faces = relief()
        self.write("set.obj", obj_of(vertices, faces) + "o other\n" + obj_of([], faces[:30]))
        self.assertIn("2 objects", self.run_pliant("new", "mesh", "--mesh", "set.obj", code=2).stderr)
        text = self.run_pliant("new", "mesh", "--mesh", "set.obj", "--object", "#1", "--root", ".").stdout
        self.assertRegex(text, r'<mesh [^>]*object="#1"')
        self.assertIn("--object needs --mesh", self.run_pliant("new", "mesh", "--object", "a", code=2).stderr)
        self.assertIn("--root needs --mesh", self.run_pliant("new", "mesh", "--root", ".", code=2).stderr)
        self.assertIn("not a folder", self.run_pliant(
            "new", "mesh", "--mesh", "set.obj", "--object", "#1", "--root", "none", code=2).stderr)

    def test_what_is_left_out_is_counted_in_one_warning(self):
        vertices, faces = relief()
        sheet = obj_of(vertices, faces)
        for fault, told in (("f 1 2\nf 3\n", "2 faces of fewer than three corners"),
                            ("l 1 2\np 1 2\n", "1 line and 2 points"),
                            ("f 1/ 2/ 3/\n", "3 texture or normal numbers of face corners")):
            self.write("a.obj", sheet + fault)
            self.write("a.xml", scene_of("a.obj", attributes='uv="surface"'))
            for command in ["bake", "a.xml", "-o", "a.npy"], ["validate", "a.xml"]:
                lines = [line for line in self.run_pliant(*command).stderr.splitlines() if told in line]
                self.assertEqual(len(lines), 1, command)
                self.assertTrue(lines[0].startswith("a.xml:1: " + ("warning" if command[0] == "bake" else "note")))
        self.write("a.obj", sheet)
        self.assertNotIn("all of its file", self.run_pliant("bake", "a.xml", "-o", "a.npy").stderr)

    def test_a_tube_that_is_cut(self):
        around, rows = 12, 6
        text = "".join("v %.17g %d %.17g\nvt %.17g %.17g\n" % (
            np.cos(2 * np.pi * (i % around) / around), j, np.sin(2 * np.pi * (i % around) / around), i / around, j / (rows - 1))
            for j in range(rows) for i in range(around + 1))
        for j in range(rows - 1):
            for i in range(around):
                a = j * (around + 1) + i + 1
                text += "f " + " ".join(f"{k}/{k}" for k in (a, a + 1, a + around + 2, a + around + 1)) + "\n"
        self.write("tube.obj", text)
        self.write("a.xml", '<scene version="1" start="1" end="2"><surface name="s"><mesh file="tube.obj" uv="grid"/>'
                   '</surface><point name="p" center="-1 2.5 0" deformationRadius="1.2" forceRadius="1.2" '
                   'magnitude="900" direction="-1 0 0"/></scene>')
        facts = json.loads(self.run_pliant("info", "a.xml", "--json").stdout)["surfaces"][0]
        self.assertEqual((facts["columns"], facts["rows"], facts.get("wrap")), (around + 1, rows, None))
        self.run_pliant("bake", "a.xml", "-o", "a.npy", "--quiet")
        # By default it is a surface, where they move as one.
        self.write("b.xml", self.read("a.xml").decode().replace(' uv="grid"', ""))
        self.assertIn("a seam", self.run_pliant("validate", "b.xml").stderr)


if __name__ == "__main__":
    main()
