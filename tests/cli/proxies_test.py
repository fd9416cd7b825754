"""Nets, subdivision cages and driven surfaces, from scene to files."""

import json
import os
import unittest

import numpy as np

from command import SANITIZED, SOURCE, Command, main

EXAMPLES = os.path.join(SOURCE, "examples")
CAGE = '<grid columns="13" rows="11" width="12" depth="10"/>'
SKIN = '<grid columns="40" rows="30" width="11" depth="9"/>'
POKE = '<point name="poke" center="1 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"/>'
NET = ('<nurbs columns="7" rows="6" degreeU="2" degreeV="2" samplesU="9" samplesV="7"><points>' +
       " ".join(f"{2 * i - 6} 0 {2 * j - 5}" for j in range(6) for i in range(7)) + "</points></nurbs>")


def scene_text(shape, skin='drivenBy="cage"', force=POKE, end=8):
    return (f'<scene version="1" start="1" end="{end}">\n<surface name="cage">{shape}</surface>\n'
            f'<surface name="skin" {skin}>{SKIN}<transform translate="0 0.3 0"/></surface>\n{force}</scene>\n')


class Proxies(Command):
    def bake(self, scene, out, *arguments):
        return self.run_pliant("bake", scene, "-o", self.path(out), *arguments, "--quiet")

    def test_threads_caches_orders_and_replays_keep_the_bits(self):
        for shape in (CAGE, NET):
            scene = self.write("s.xml", scene_text(shape))
            self.bake(scene, "a.npy", "--surface", "skin")
            skin = np.load(self.path("a.npy"))
            self.assertGreater(np.abs(skin[-1] - skin[0]).max(), 0.01)
            for arguments in (("--threads", "3"), ("--cache", self.path("states")), ("--cache", self.path("states"))):
                self.bake(scene, "b.npy", "--surface", "skin", *arguments)
                self.assertEqual(self.read("a.npy"), self.read("b.npy"))
            self.bake(scene, "c.npy", "--surface", "skin", "--frames", "7")
            self.assertTrue((np.load(self.path("c.npy"))[0] == skin[6]).all())
            log = self.path("log.replay")
            self.run_pliant("replay", "record", scene, "-o", log)
            self.assertIn("all as recorded", self.run_pliant("replay", "verify", log).stdout)

    def test_every_format_has_both_surfaces(self):
        scene = self.write("s.xml", scene_text(CAGE))
        self.bake(scene, "a.npy")
        for name in ("a.glb", "a.usda"):
            self.bake(scene, name)
            self.assertGreater(os.path.getsize(self.path(name)), 10_000)
        self.bake(scene, "a.pc2")
        self.assertEqual([name for name in self.files() if name.startswith("a-") and name.endswith(".npy")],
                         ["a-cage.npy", "a-skin.npy"])
        self.assertTrue({"a-cage.pc2", "a-skin.pc2"} <= set(self.files()))

    def test_regions_and_info_tell_of_the_driver(self):
        scene = self.write("s.xml", scene_text(CAGE))
        self.bake(scene, "a.npy", "--regions", self.path("regions.json"))
        with open(self.path("regions.json"), encoding="utf-8") as file:
            for frame in json.load(file)["frames"]:
                cage, skin = frame["surfaces"]
                self.assertTrue(cage["solved"])
                self.assertEqual(len(cage["forces"]), 1)
                self.assertFalse(skin["solved"])
                self.assertEqual(skin["forces"], [])
        told = json.loads(self.run_pliant("info", scene, "--json").stdout)
        self.assertEqual(told["surfaces"][1]["drivenBy"], "cage")
        self.assertEqual(told["surfaces"][1]["vertices"], 1200)
        self.assertEqual([preview["surface"] for preview in told["forces"][0]["previews"]], ["cage"])
        self.assertRegex(self.run_pliant("info", scene).stdout, r"skin  sheet, driven by cage, 1200 vertices")

    def test_errors_name_line_and_rule(self):
        def refused(text, line, words, code=2):
            scene = self.write("bad.xml", text)
            done = self.run_pliant("bake", scene, "-o", self.path("out.npy"), code=code)
            self.assertRegex(done.stderr, rf"^\S*bad\.xml:{line}: error: [^\n]*{words}[^\n]*\n$")
            self.assertNotIn("out.npy", self.files())

        refused(scene_text(CAGE, 'drivenBy="cgae"'), 3, 'no surface is named "cgae"; did you mean "cage"')
        refused(scene_text(CAGE, force=POKE.replace("<point", '<point targets="skin"')), 4, 'driven by "cage"')
        refused(scene_text(NET.replace('degreeU="2"', 'degreeU="7"')), 2, "degreeU is 7")
        refused(scene_text(NET.replace(" 0 -5", " x -5", 1)), 2, "<points> number 2")
        missing = '<subdivision file="none.obj"/>'
        refused(scene_text(missing), 2, "none.obj")
        self.write("square.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n")
        loop = '<subdivision file="square.obj" scheme="loop"/>'
        refused(scene_text(loop), 2, '(face 1 has 4 corners|this build has no OpenSubdiv)')
        refused(scene_text('<subdivision file="square.obj" levels="7"/>'), 2, "must be at most 6")

    @unittest.skipIf(SANITIZED, "a sanitizer fills what is taken")
    def test_memory_is_refused_before_it_is_taken(self):
        for shape in (NET.replace('samplesU="9" samplesV="7"', 'samplesU="9000" samplesV="9000"'),
                      '<grid columns="2000" rows="2000"/>'):
            text = scene_text(CAGE).replace(SKIN, shape)
            done = self.run_pliant("bake", self.write("s.xml", text), "-o", self.path("o.npy"), "--max-memory", "0.1",
                                   code=1)
            self.assertRegex(done.stderr, r'error: surface "skin" (takes|needs) [\d.]+ (GB|MB), more than')

    @unittest.skipIf(SANITIZED, "the golden replays have the same scene")
    def test_the_examples_follow_their_cages(self):
        self.bake(os.path.join(EXAMPLES, "skin.xml"), "face.npy", "--surface", "face")
        self.bake(os.path.join(EXAMPLES, "skin.xml"), "cage.npy", "--surface", "cage")
        face, cage = np.load(self.path("face.npy")), np.load(self.path("cage.npy"))
        peaks = [np.linalg.norm(frames - frames[0], axis=2).max() for frames in (face, cage)]
        self.assertLess(abs(peaks[0] / peaks[1] - 1), 0.05)
        still = (face == face[0]).all(axis=(0, 2))
        self.assertGreater(still.mean(), 0.4)
        self.assertLess(still.mean(), 0.9)


if __name__ == "__main__":
    main()
