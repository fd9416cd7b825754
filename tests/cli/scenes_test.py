"""`pliant validate` and `pliant info`."""

import os
import signal
import subprocess
import time

from command import Command, GRID, PATH, PLIANT, POINT, SCENE, animated, main


class Validate(Command):
    def test_every_scene_is_told_of(self):
        good = self.scene()
        bad = self.write("bad.xml", SCENE.format(end=0))
        missing = self.write("m.xml", SCENE.format(end=9).replace(
            '<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="none.obj"/>'))
        result = self.run_pliant("validate", good, bad, missing, code=2)
        self.assertRegex(result.stdout, r"^\S*scene\.xml: all right: 1 surface, 1 force, "
                                        r"frames 1 to 12\n$")
        self.assertRegex(result.stderr, r"bad\.xml:2: error: .*\n\S*m\.xml:3: error: .*none\.obj")
        self.assertEqual(self.run_pliant("validate", good, "--quiet").stdout, "")

    def test_a_scene_without_a_surface_is_legal(self):
        scene = self.write("curves.xml", '<scene version="1" start="1" end="9"><point name="p"/></scene>')
        self.run_pliant("validate", scene)
        self.assertIn("no surface", self.run_pliant("info", scene).stdout)
        self.assertIn("no surface", self.run_pliant("bake", scene, "-o", "a.npy", code=2).stderr)

    def test_nothing_is_run_or_allocated(self):
        scene = self.write("large.xml", SCENE.format(end=1000000).replace('"13"', '"10000"').replace(
            '"11"', '"10000"'))
        self.run_pliant("validate", scene, "--max-memory", "1000000")
        self.assertIn("takes 85", self.run_pliant("validate", scene, "--max-memory", "2", code=1).stderr)

    def test_interrupted_it_does_not_say_all_right(self):
        os.mkfifo(self.path("pipe.xml"))
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([PLIANT, "validate", self.path("pipe.xml"), self.scene()],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                time.sleep(0.5)  # it waits for someone to write to the pipe
                process.send_signal(number)
                out, _ = process.communicate(timeout=30)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(out, "")

    def test_a_mesh_that_is_no_file_is_not_waited_for(self):
        os.mkfifo(self.path("m.obj"))
        os.symlink("/dev/zero", self.path("z.obj"))
        for name in ("m.obj", "z.obj"):
            scene = self.write("p.xml", SCENE.format(end=9).replace(GRID, f'<mesh file="{name}"/>'))
            self.assertIn("it is no regular file", self.run_pliant("validate", scene, code=2).stderr)

    def test_notes_are_told(self):
        scene = self.write("n.xml", SCENE.format(end=9).replace(' magnitude="3000"/>', """>
    <animate attribute="magnitude">
      <key frame="1" value="0" out="1" outLength="-2"/><key frame="9" value="5"/></animate></point>"""))
        result = self.run_pliant("validate", scene)
        self.assertRegex(result.stderr, r"^\S*n\.xml:6: note: poke\.magnitude: key 1: [^\n]+\n$")


class Info(Command):
    def test_what_an_author_chooses_numbers_by(self):
        scene = self.write("i.xml", SCENE.format(end=48).replace(' magnitude="3000"/>', """>
    <animate attribute="magnitude">
      <key frame="1" value="0"/><key frame="9" value="-4000"/></animate></point>"""))
        told = self.run_pliant("info", scene).stdout
        for words in ("frames 1 to 48 at 24 frames/s",
                      "sheet  sheet, grid 13 x 11, 143 vertices",
                      "poke (point) on sheet: from frame 1 it selects 9 x 9 nodes, columns 2 to 10, "
                      "rows 1 to 9",
                      "at magnitude -4000 (frame 9)", " Hz, damping ratio",
                      "poke.magnitude  2 keys: 1 = 0, 9 = -4000", "memory"):
            self.assertIn(words, told)

    def test_forces_that_do_nothing_are_listed_with_the_reason(self):
        text = SCENE.format(end=9)
        for old, new, words in (
                ("<point", '<point enabled="false"', "poke (point): never enabled"),
                ('name="sheet"', 'name="sheet" enabled="false"', "poke (point): no surface that is solved"),
                ("</surface>", '<solver startFrame="50"/></surface>', "poke (point): no surface that is solved")):
            self.assertIn(words, self.run_pliant("info", self.write("n.xml", text.replace(old, new))).stdout)

    def test_what_would_take_too_long_is_left_out(self):
        scene = self.write("l.xml", SCENE.format(end=1000000).replace('"13"', '"601"').replace(
            '"11"', '"601"').replace('"4.5"', '"100"'))
        self.assertIn("too many to preview", self.run_pliant("info", scene).stdout)
        scene = self.write("f.xml", SCENE.format(end=1000000).replace('"0 0 0"', '"0 4.6 0"').replace(
            '"13"', '"201"').replace('"11"', '"201"').replace('magnitude="3000"/>', """>
    <animate attribute="magnitude"><key frame="1" value="0"/><key frame="9" value="9"/></animate></point>"""))
        self.assertIn("selects nothing at rest", self.run_pliant("info", scene).stdout)

    def test_groups_and_paths(self):
        scene = self.write("g.xml", SCENE.format(end=9).replace(
            POINT, '<group name="hand" deformationRadius="4.5">' +
            PATH.replace("</path>", animated("progress", (1, 0), (9, 0.25)) + "</path>") +
            '<point name="palm" magnitude="3000"/><uniform name="weight"/></group>' +
            '<group name="empty"/><inertia name="jiggle"/>'))
        told = self.run_pliant("info", scene).stdout
        for words in ("palm (point in hand) on sheet: from frame 1 it selects 9 x 9 nodes",
                      "weight (uniform in hand) on sheet: from frame 1 it selects 9 x 9 nodes",
                      "jiggle (inertia) on sheet: from frame 1 it selects 13 x 11 nodes",
                      "empty (group): no force in it",
                      "hand.center.progress  2 keys: 1 = 0, 9 = 0.25"):
            self.assertIn(words, told)
        rows = self.run_pliant("curves", scene, "--channel", "hand.center.progress", "palm.magnitude",
                               "weight.direction", "--frames", "9").stdout.splitlines()
        self.assertEqual(rows[1:], ["hand.center.progress,9,0.25", "palm.magnitude,9,3000",
                                    "weight.direction,9,0,1,0"])
        self.assertIn("it has hand.enabled, hand.center.progress, hand.deformationRadius", self.run_pliant(
            "curves", scene, "--channel", "hand.center", code=2).stderr)

    def test_a_force_out_of_reach(self):
        scene = self.write("far.xml", SCENE.format(end=9).replace('"0 0 0"', '"0 90 0"'))
        self.assertIn("poke (point) on sheet: selects nothing at rest", self.run_pliant("info", scene).stdout)


if __name__ == "__main__":
    main()
