"""`pliant new`: starter scenes, materials and the user's own mesh."""

import json
import os
import re
import subprocess
import unittest

import numpy as np

from command import SANITIZED, SOURCE, Command, main

STARTERS = ("sheet", "mesh", "trampoline", "ripple", "jiggle", "dent", "flag", "travelling")
MATERIALS = ("rubber", "jelly", "metal", "cloth", "paper", "skin")
WITH_MESH = ("mesh", "jiggle")
# Whole bakes, by code that other tests run under sanitizers.
long = unittest.skipIf(SANITIZED, "bakes for many minutes")


class New(Command):
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
        subprocess.run(["python3", os.path.join(SOURCE, "cli/new/starters/make_pudding.py"), self.path("p.obj")], check=True)
        self.assertEqual(self.read("p.obj").decode(), self.starter("pudding.obj"))

    @long
    def test_starters_move_within_their_size_and_calm_down_without_a_note(self):
        for name in STARTERS:
            self.run_pliant("new", name, "-o", f"{name}.xml")
            self.assertEqual(self.run_pliant("validate", f"{name}.xml").stderr, "")
            moved, notes = self.displacements(f"{name}.xml")
            self.assertEqual(notes, "")
            box = json.loads(self.run_pliant("info", f"{name}.xml", "--json").stdout)["surfaces"][0]["ownBoundingBox"]
            size = np.linalg.norm(np.subtract(box["high"], box["low"]))
            self.assertTrue(np.isfinite(moved).all() and moved[0] == 0, name)
            self.assertTrue(0.03 * size < moved.max() < 0.45 * size, (name, moved.max(), size))
            self.assertLess(moved[-5:].max(), 0.75 * moved.max(), name)

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

    @long
    def test_a_material_swings_as_its_comment_says(self):
        for starter, materials in (("sheet", MATERIALS), ("jiggle", ("rubber", "metal"))):
            for material in materials:
                out = f"{starter}-{material}.xml"
                self.run_pliant("new", starter, "-o", out, "--material", material)
                with open(self.path(out), encoding="utf-8") as file:
                    text = file.read()
                wanted = float(re.search(r"swings\s+([\d.]+)\s+times", text)[1])
                vibration = self.together(out)["regions"][0]["vibration"]
                self.assertAlmostEqual(vibration["naturalFrequency"] / wanted, 1, delta=0.01)
                self.assertAlmostEqual(vibration["naturalDampingRatio"], self.attribute(text, "dampingRatio"), delta=0.002)
                self.assertLessEqual(max(map(len, text.splitlines())), 110)
                self.assertEqual(self.run_pliant("validate", out).stderr, "")

    @long
    def test_materials_look_like_their_names(self):
        peak, after = {}, {}
        for material in (None,) + MATERIALS:
            out = f"{material}.xml"
            self.run_pliant("new", "sheet", "-o", out, *(["--material", material] if material else []))
            moved = self.displacements(out)[0]
            peak[material] = moved.max()
            after[material] = moved[44:64].max() / moved.max()  # half a second after it is let go
            if material in ("metal", "paper"):
                # What stays: the mean of some periods at the end.
                stays = moved[-10:].mean() / moved.max()
                self.assertGreater(stays, {"metal": 0.15, "paper": 0.05}[material], material)
            elif material not in ("jelly", None):
                self.assertLess(moved[-10:].mean() / moved.max(), 0.04, material)
        # Soft and stiff.
        self.assertLess(peak["metal"], peak["paper"])
        self.assertLess(peak["paper"], peak["rubber"])
        self.assertLess(peak["rubber"], peak["cloth"])
        self.assertLess(peak["cloth"], peak["jelly"])
        for material, share in (("rubber", 1), ("jelly", 1.6), ("metal", 0.6 * 1.35), ("cloth", 1.4),
                                ("paper", 0.8 * 1.12), ("skin", 1.2)):
            self.assertAlmostEqual(peak[material] / peak[None], share, delta=0.06 * share)
        # Jelly wobbles long, rubber rings, cloth and skin do not.
        self.assertGreater(after["jelly"], 0.5)
        self.assertTrue(0.05 < after["rubber"] < after["jelly"])
        self.assertLess(max(after["cloth"], after["skin"]), 0.1)

    @long
    def test_equal_blows_leave_equal_dents(self):
        self.run_pliant("new", "dent", "-o", "dent.xml")
        self.run_pliant("bake", "dent.xml", "-o", "a.npy")
        depths = -np.load(self.path("a.npy"))[:, :, 1].reshape(72, 61, 3, 27).min(axis=(1, 3))
        peaks = depths.max(axis=0)
        self.assertTrue((depths[-1] > 0.3 * peaks).all() and (depths[-1] < 0.7 * peaks).all(), depths[-1])
        # Alike but for the rounding of where they are, and at rest: no blow freezes the dent before.
        self.assertLess(np.ptp(depths[-1]), 1e-9 * peaks[0])
        self.assertLess(np.ptp(peaks), 1e-9 * peaks[0])
        for blow, frame in enumerate((6, 24, 42)):
            settled = depths[frame + 17:, blow]
            self.assertLess(np.ptp(settled), 0.01 * peaks[0])

    @long
    def test_what_yields_has_round_dents(self):
        for starter, material, is_round in (("sheet", "metal", True), ("sheet", "rubber", False),
                                            ("dent", None, True), ("trampoline", "paper", False)):
            self.run_pliant("new", starter, "-o", "a.xml", "--force",
                            *(["--material", material] if material else []))
            self.assertEqual('uv="surface"/>' in self.read("a.xml").decode(), is_round, (starter, material))
        self.run_pliant("new", "sheet", "-o", "a.xml", "--force", "--material", "metal")
        moved = self.displacements("a.xml")[0]
        self.assertGreater(moved[-1], 0.15 * moved.max())  # a dent stays
        self.run_pliant("bake", "a.xml", "-o", "a.npy")
        last = np.abs(np.load(self.path("a.npy"))[-1, :, 1]).reshape(49, 49)
        self.assertLess(np.abs(last - last.T).max(), 1e-6 * last.max())
        self.assertLess(max(last[0, 0], last[-1, -1]), 1e-12)

    @long
    def test_a_flag_keeps_its_length(self):
        for material in (None, "cloth", "jelly"):  # jelly is the softest
            out = f"{material}.xml"
            self.run_pliant("new", "flag", "-o", out, *(["--material", material] if material else []))
            self.run_pliant("bake", out, "-o", "a.npy")
            flag = np.load(self.path("a.npy")).reshape(120, 41, 61, 3)
            for axis, length in ((2, 9), (1, 6)):
                lengths = np.linalg.norm(np.diff(flag, axis=axis), axis=3).sum(axis=axis)
                self.assertTrue((lengths > 0.9 * length).all() and (lengths < 1.2 * length).all(),
                                (material, axis, lengths.min(), lengths.max()))

    @long
    def test_every_starter_takes_every_material(self):
        for starter, materials in (("trampoline", MATERIALS), ("dent", MATERIALS), ("mesh", ("jelly", "metal"))):
            for material in materials:
                out = f"{starter}-{material}.xml"
                self.run_pliant("new", starter, "-o", out, "--material", material)
                size = 2 if starter == "mesh" else 8
                moved = self.displacements(out)[0]
                self.assertTrue(np.isfinite(moved).all())
                self.assertTrue(0.01 * size < moved.max() < 0.4 * size, (out, moved.max()))

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

    @long
    def test_a_mesh_of_ones_own_at_any_size(self):
        os.mkdir(self.path("shots"))
        peaks = {}
        for scale in (0.02, 1.0, 300.0):
            self.own_mesh("dome.obj", scale)
            for starter in WITH_MESH:
                self.run_pliant("new", starter, "-o", "shots/a.xml", "--mesh", "dome.obj", "--force")
                text = self.read("shots/a.xml").decode()
                self.assertIn('file="../dome.obj"', text)
                peak = self.displacements("shots/a.xml")[0].max() / scale
                peaks.setdefault(starter, []).append(peak)
                vibration = self.together("shots/a.xml")["regions"][0]["vibration"]
                self.assertAlmostEqual(vibration["naturalFrequency"], {"mesh": 3, "jiggle": 2.2}[starter], delta=0.05)
        for starter in WITH_MESH:  # the same motion at each size
            self.assertTrue(0.05 < min(peaks[starter]) and max(peaks[starter]) < 1, peaks)
            self.assertLess(max(peaks[starter]) / min(peaks[starter]), 1.05, peaks)
        self.assertEqual(sorted(os.listdir(self.path("shots"))), ["a.xml"])

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
