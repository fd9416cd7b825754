"""`pliant new`: starter scenes, materials and the user's own mesh."""

import json
import os
import re
import subprocess
import sys

import numpy as np

from command import SOURCE, Command, main

STARTERS = ("sheet", "mesh", "trampoline", "ripple", "jiggle", "dent", "flag", "travelling")
MATERIALS = ("rubber", "jelly", "metal", "cloth", "paper", "skin")
WITH_MESH = ("mesh", "jiggle")


class Starters(Command):
    def starter(self, name):
        with open(os.path.join(SOURCE, "cli/new/starters", name), encoding="utf-8") as file:
            return file.read()

    def attribute(self, scene, name):
        return float(re.search(rf'<material [^>]*\b{name}="([^"]*)"', scene)[1])

    def together(self, scene):
        return json.loads(self.run_pliant("info", scene, "--json").stdout)["together"][0]

    def displacements(self, scene):
        """Largest displacement in each frame, from the surface at rest under its transform; and notes."""
        notes = self.run_pliant("bake", scene, "-o", "a.npy", "--space", "object").stderr
        frames = np.load(self.path("a.npy"))
        return np.linalg.norm(frames - frames[0], axis=2).max(axis=1), notes

    def own_mesh(self, name, scale):
        """A dome of another size and place, with its axis along z and a border."""
        vertices = [""]  # its top, below
        for ring in range(1, 13):
            for side in range(24):
                angle, height = 2 * np.pi * side / 24, ring / 12 * np.pi / 2
                vertices.append("v %.17g %.17g %.17g" % tuple(scale * (100 + np.array(
                    [np.sin(height) * np.cos(angle), np.sin(height) * np.sin(angle), np.cos(height)]))))
        vertices[0] = f"v {100 * scale!r} {100 * scale!r} {101 * scale!r}"
        faces = [f"f 1 {2 + k} {2 + (k + 1) % 24}" for k in range(24)]
        for ring in range(11):
            for k in range(24):
                a, b = 2 + 24 * ring + k, 2 + 24 * ring + (k + 1) % 24
                faces.append(f"f {a} {a + 24} {b + 24} {b}")
        return self.write(name, "\n".join(vertices + faces) + "\n")


class New(Starters):
    def test_the_list_has_every_file_of_the_folder(self):
        files = {name[:-4] for name in os.listdir(os.path.join(SOURCE, "cli/new/starters")) if name.endswith(".xml")}
        self.assertEqual(files, set(STARTERS))
        listed = re.findall(r"^  (\w+) +(\S.*)$", self.run_pliant("new").stdout, re.MULTILINE)
        self.assertEqual({name for name, _ in listed}, set(STARTERS) | set(MATERIALS))
        for name, summary in listed:
            self.assertGreater(len(summary.split()), 4, name)

    def test_a_starter_is_its_file(self):
        for name in STARTERS:
            if name not in WITH_MESH:
                self.assertEqual(self.run_pliant("new", name).stdout, self.starter(f"{name}.xml"))
            self.run_pliant("new", name, "-o", f"{name}-1.xml")
            with open(self.path(f"{name}-1.xml"), encoding="utf-8") as file:
                self.assertEqual(file.read().replace(f"{name}-1.obj", "pudding.obj"), self.starter(f"{name}.xml"))
        with open(self.path("mesh-1.obj"), encoding="utf-8") as file:
            self.assertEqual(file.read(), self.starter("pudding.obj"))
        self.assertEqual(len(self.files()), len(STARTERS) + len(WITH_MESH))

    def test_the_pudding_is_made_by_its_script(self):
        subprocess.run([sys.executable, os.path.join(SOURCE, "cli/new/starters/make_pudding.py"), self.path("p.obj")], check=True)
        self.assertEqual(self.read("p.obj").decode(), self.starter("pudding.obj"))

    def test_a_starter_takes_two_to_five_seconds_and_explains_itself(self):
        for name in STARTERS:
            text = self.starter(f"{name}.xml")
            start, end = (int(re.search(rf'{word}="(\d+)"', text)[1]) for word in ("start", "end"))
            self.assertTrue(2 <= (end - start) / 24 <= 5, name)
            comments = "".join(re.findall(r"<!--.*?-->", text, re.DOTALL))
            self.assertGreater(len(comments), 400, name)
            for word in ("Look at:", "To try:"):
                self.assertIn(word, comments, name)
            self.assertNotIn("--", re.sub(r"<!--|-->", "", comments))

    def test_existing_files_stay(self):
        self.run_pliant("new", "mesh", "-o", "a.xml")
        for there, missing in (("a.xml", "a.obj"), ("a.obj", "a.xml")):
            os.remove(self.path(missing))
            self.write(there, "mine")
            result = self.run_pliant("new", "mesh", "-o", "a.xml", code=2)
            self.assertEqual(result.stderr, f"pliant: error: {there}: the file exists; --force replaces it\n")
            self.assertEqual(self.files(), [there])
            self.assertEqual(self.read(there), b"mine")
            self.run_pliant("new", "mesh", "-o", "a.xml", "--force")
            self.assertNotEqual(self.read(there), b"mine")
        self.assertEqual(self.files(), ["a.obj", "a.xml"])

    def test_wrong_usage(self):
        for arguments, message in (
                (["trampolin"], '"trampolin": did you mean "trampoline"? allowed: sheet, mesh,'),
                (["nonsense"], '"nonsense": allowed: sheet, mesh,'),
                (["sheet", "--material", "butter"], '"butter": allowed: rubber,'),
                (["mesh"], "mesh needs -o SCENE"),
                (["sheet", "--schema"], "--schema needs -o SCENE"),
                (["sheet", "--mesh", "a.obj"], "the starters with a mesh are mesh, jiggle"),
                (["sheet", "-o", "a.obj"], "must end in .xml"),
                (["sheet", "-o", "-"], "cannot write this to the standard output"),
                (["--material", "jelly"], "needs the NAME"),
                (["mesh", "--mesh", "none.obj"], "error: --mesh none.obj: cannot read the file: No such file")):
            result = self.run_pliant("new", *arguments, code=2)
            self.assertIn(message, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertEqual(result.stdout, "")
        self.run_pliant("new", "sheet", "-o", "no/a.xml", code=1)
        self.assertEqual(self.files(), [])
        self.write("b.obj", "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n")
        told = self.run_pliant("new", "mesh", "--mesh", "b.obj", "-o", "a.xml", code=2).stderr
        self.assertRegex(told, r"^b.obj: error: [^\n]*the area of the mesh's triangles is too large for a number\n$")

    def test_the_schema_is_written_beside_the_scene(self):
        self.run_pliant("new", "sheet", "-o", "a.xml", "--schema")
        self.assertEqual(self.files(), ["a.xml", "pliant-scene.xsd"])
        with open(os.path.join(SOURCE, "docs/pliant-scene.xsd"), "rb") as file:
            self.assertEqual(self.read("pliant-scene.xsd"), file.read())
        lines = self.read("a.xml").decode().splitlines()
        self.assertEqual(lines[:2], ['<?xml version="1.0" encoding="UTF-8"?>', '<?xml-model href="pliant-scene.xsd"?>'])
        self.run_pliant("validate", "a.xml")
        self.run_pliant("new", "dent", "-o", "b.xml", "--schema")  # the same schema again is no harm
        self.write("pliant-scene.xsd", "mine")
        self.assertIn("--force replaces it", self.run_pliant("new", "dent", "-o", "c.xml", "--schema", code=2).stderr)
        self.assertEqual(self.read("pliant-scene.xsd"), b"mine")
        self.assertNotIn("c.xml", self.files())
        self.run_pliant("new", "dent", "-o", "c.xml", "--schema", "--force")
        self.assertNotEqual(self.read("pliant-scene.xsd"), b"mine")

    def test_a_mesh_that_nothing_holds(self):
        cube = ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
        self.write("cube.obj", cube)
        self.run_pliant("new", "jiggle", "-o", "a.xml", "--mesh", "cube.obj")
        self.assertIn('goal="', self.read("a.xml").decode())
        region, = self.together("a.xml")["regions"]
        self.assertAlmostEqual(region["vibration"]["naturalFrequency"], 2.2, delta=0.05)
        # It lags by a part of its size, and comes back.
        peaks, _ = self.displacements("a.xml")
        self.assertTrue(0.02 < peaks.max() < 1, peaks)

    def test_names_that_xml_must_escape(self):
        self.own_mesh('a "b" & <c>.obj', 1)
        self.write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertIn("no node of the mesh can move",
                      self.run_pliant("new", "mesh", "-o", "b.xml", "--mesh", "tri.obj", code=2).stderr)
        self.run_pliant("new", "mesh", "-o", "a.xml", "--mesh", 'a "b" & <c>.obj')
        self.run_pliant("validate", "a.xml")


if __name__ == "__main__":
    main()
