"""`--set` of the commands that read a scene."""

import json
import os

from command import Command, animated, main

# The magnitude is animated or given, by MAGNITUDE in the element and ANIMATION in it.
SCENE = """<scene version="1" start="1" end="8"{SCENE}>
  <surface name="sheet"><grid columns="{COLUMNS}" rows="9" width="10" depth="10"/>
    <transform translate="{TRANSLATE}"/><material{MATERIAL}/></surface>
  <point name="poke" deformationRadius="4" forceRadius="2.5"{POKE}>{KEYS}</point>
</scene>
"""
KEYS = animated("magnitude", (1, 0), (4, 900), (8, 100))
PLAIN = {"SCENE": "", "COLUMNS": 11, "TRANSLATE": "0 0 0", "MATERIAL": "", "POKE": "", "KEYS": KEYS}


class Changes(Command):
    def scene_with(self, name, **changed):
        return self.write(name, SCENE.format(**{**PLAIN, **changed}))

    def bake(self, scene, *changes):
        options = [word for change in changes for word in ("--set", change)]
        self.run_pliant("bake", scene, "-o", self.path("out.npy"), "--quiet", *options)
        return self.read("out.npy")

    def test_a_bake_has_the_bits_of_the_scene_edited_by_hand(self):
        plain = self.scene_with("plain.xml")
        doubled = animated("magnitude", (1, 0), (4, 1800), (8, 200))  # by a power of two: the same bits
        for changes, edited in [
                (["sheet.density=3", "sheet.columns=13"], {"MATERIAL": ' density="3"', "COLUMNS": 13}),
                (["poke.magnitude*=2"], {"KEYS": doubled}),
                (["poke.magnitude=250"], {"POKE": ' magnitude="250"', "KEYS": ""}),
                (["sheet.translate.x=1", "sheet.translate.z+=-0.5"], {"TRANSLATE": "1 0 -0.5"}),
                (["sheet.translate+=1 2 3"], {"TRANSLATE": "1 2 3"}),
                (["scene.end=10", "scene.fps=30"], {"SCENE": ' fps="30"'}),
                (["poke.center=1 0 0.5"], {"POKE": ' center="1 0 0.5"'})]:
            with self.subTest(changes=changes):
                wanted = self.scene_with("edited.xml", **edited)
                if "scene.end=10" in changes:
                    wanted = self.write("edited.xml", self.read("edited.xml").decode().replace('end="8"', 'end="10"'))
                baked = self.bake(plain, *changes)
                self.assertEqual(baked, self.bake(wanted))
                self.assertNotEqual(baked, self.bake(plain))

    def test_a_factor_acts_after_the_curve(self):
        scene = self.scene_with("plain.xml")

        def rows(*options):
            text = self.run_pliant("curves", scene, "--frames", "0:9", "--step", "0.25", "--sides", *options).stdout
            return [[float(number) for number in line.split(",")[1:]] for line in text.splitlines()[1:]]

        plain, changed = rows(), rows("--set", "poke.magnitude*=0.3")
        self.assertEqual(changed, [[row[0], *(0.3 * number for number in row[1:])] for row in plain])
        added = rows("--set", "poke.magnitude+=0.7")
        self.assertEqual(added, [[row[0], row[1] + 0.7, row[2] + 0.7, *row[3:]] for row in plain])

    def test_a_wrong_change_is_told_ahead_of_all_work(self):
        scene = self.scene_with("plain.xml")
        for change, parts in [
                ("poke.magnitud=2", ["--set poke.magnitud=2: ", 'did you mean "magnitude"']),
                ("poke.strength=2", ["--set poke.strength=2: ", 'did you mean "magnitude"?']),
                ("sheet.mass=2", ["--set sheet.mass=2: ", 'did you mean "density"?']),
                ("sheet.stiffness=2", ["--set sheet.stiffness=2: ", 'did you mean "b", "c" and "d"?']),
                ("pok.magnitude=2", ["--set pok.magnitude=2: ", 'did you mean "poke"']),
                ("sheet.density=-1", ["--set sheet.density=-1: ", "must be at least 0"]),
                ("sheet.columns=2", ["--set sheet.columns=2: ", "3"]),
                ("sheet.combine=bax", ["--set sheet.combine=bax: ", 'did you mean "box"']),
                ("sheet.combine*=2", ["--set sheet.combine*=2: ", "no numeric channel"]),
                ("sheet.c=-5", ["c", "-5"]),
                ("nothing", ["--set ", "PATH=TEXT"])]:
            with self.subTest(change=change):
                for command in (["bake", scene, "-o", self.path("out.npy")], ["info", scene], ["curves", scene],
                                ["view", scene, "-o", self.path("out.html")],
                                ["replay", "record", scene, "-o", self.path("out.replay")]):
                    before = self.files()
                    errors = self.run_pliant(*command, "--set", change, code=2).stderr
                    self.assertEqual(len(errors.splitlines()), 1, errors)
                    for part in parts:
                        self.assertIn(part, errors)
                    self.assertEqual(self.files(), before)

    def test_two_changes_of_one_value_are_an_error(self):
        scene = self.scene_with("plain.xml")
        errors = self.run_pliant("bake", scene, "-o", self.path("out.npy"), "--set", "sheet.b=2", "--set", "sheet.b*=2",
                                 code=2).stderr
        self.assertIn("sheet.b*=2: sheet.b=2 changes the same value", errors)

    def test_a_log_remembers_its_changes(self):
        scene = self.scene_with("plain.xml")
        log, plain = self.path("changed.replay"), self.path("plain.replay")
        self.run_pliant("replay", "record", scene, "-o", log, "--set", "poke.magnitude*=3", "--set", "sheet.d=2")
        self.run_pliant("replay", "record", scene, "-o", plain)
        self.assertEqual(json.loads(self.read("changed.replay").splitlines()[0])["changes"],
                         ["poke.magnitude*=3", "sheet.d=2"])
        self.assertNotIn("changes", json.loads(self.read("plain.replay").splitlines()[0]))
        self.run_pliant("replay", "verify", log)
        self.assertIn("the changes by --set differ: poke.magnitude*=3, sheet.d=2, and none",
                      self.run_pliant("replay", "diff", log, plain, code=1).stderr)

    def test_a_root_confines_the_files_of_changes(self):
        os.mkdir(self.path("shots"))
        for folder in ("", "shots/"):
            self.write(folder + "quad.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n")
        scene = self.write("shots/a.xml", """<scene version="1" start="1" end="2">
  <surface name="s"><mesh file="quad.obj"/></surface></scene>""")
        inside, outside = "s.file=./quad.obj", "s.file=../quad.obj"
        self.run_pliant("info", scene, "--set", outside)
        self.run_pliant("info", scene, "--set", inside, "--root", self.path("shots"))
        for command in (["info", scene], ["replay", "record", scene, "-o", self.path("a.replay")]):
            errors = self.run_pliant(*command, "--set", outside, "--root", self.path("shots"), code=2).stderr
            self.assertIn("--set s.file=../quad.obj: ", errors)
            self.assertIn("the folder of --root", errors)
        errors = self.run_pliant("info", scene, "--set", "s.file=no.obj", code=2).stderr
        self.assertEqual(errors, "pliant: error: --set s.file=no.obj: cannot read the file: No such file or directory\n")

    def test_info_knows_the_changes(self):
        scene = self.scene_with("plain.xml")
        told = json.loads(self.run_pliant("info", scene, "--json", "--set", "poke.magnitude*=-2").stdout)
        plain = json.loads(self.run_pliant("info", scene, "--json").stdout)
        self.assertEqual([key["value"] for key in told["channels"][0]["keys"]], [0, -1800, -200])
        peak = [facts["forces"][0]["previews"][0]["staticPeak"] for facts in (told, plain)]
        self.assertAlmostEqual(peak[0] / peak[1], 2, delta=0.05)


if __name__ == "__main__":
    main()
