"""`pliant validate` and `pliant info`."""

import json
import os
import re
import signal
import subprocess
import time
import unittest

from command import Command, GRID, PATH, PLIANT, POINT, SANITIZED, SCENE, animated, main


class Validate(Command):
    def test_every_scene_is_told_of(self):
        good = self.scene()
        bad = self.write("bad.xml", SCENE.format(end=0))
        missing = self.write("m.xml", SCENE.format(end=9).replace(
            '<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="none.obj"/>'))
        result = self.run_pliant("validate", good, bad, missing, code=2)
        self.assertRegex(result.stdout, r"^\S*scene\.xml: valid: 1 surface, 1 force, "
                                        r"frames 1 to 12\n$")
        self.assertRegex(result.stderr, r"bad\.xml:2: error: .*\n\S*m\.xml:3: error: .*none\.obj")
        self.assertEqual(self.run_pliant("validate", good, "--quiet").stdout, "")

    def test_json_lists_every_problem(self):
        good = self.scene()
        bad = self.write("bad.xml", SCENE.format(end=9).replace("magnitude", "magnitud").replace(
            'columns="13"', 'columns="2"'))
        noted = self.write("n.xml", SCENE.format(end=9).replace(' magnitude="3000"/>', """>
    <animate attribute="magnitude">
      <key frame="1" value="0" out="1" outLength="-2"/><key frame="9" value="5"/></animate></point>"""))
        result = self.run_pliant("validate", good, bad, noted, "none.xml", "--json", code=2)
        told = json.loads(result.stdout)
        self.assertEqual(result.stderr, "")
        self.assertEqual(told["scenes"], [{"file": good, "valid": True}, {"file": bad, "valid": False},
                                          {"file": noted, "valid": True}, {"file": "none.xml", "valid": False}])
        self.assertEqual([(p["file"], p["line"], p["kind"]) for p in told["problems"]],
                         [(bad, 3, "invalid"), (bad, 4, "invalid"), (noted, 6, "note"),
                          ("none.xml", None, "unreadable")])
        self.assertEqual(json.loads(self.run_pliant("validate", good, "--json").stdout)["problems"], [])

    def test_json_tells_where_for_editors(self):
        text = """<scene version="1" start="1" end="9">
  <surface name="sheet"><grid columns="2" rows="11"/></surface>
\t<!-- \u00fc \U0001f44b --><point nam="poke" forceRadius="1,5"/>
  <surface name="s"/><wrong/>
  <point name="q"><animate attribute="magnitude"><key frame="1"
    value="0"/><key frame="1" value="3"/></animate></point>
  <point name="r" magnitude="1" targets="shet"/>
</scene>
"""
        def told(name, text):
            result = self.run_pliant("validate", self.write(name, text), "--json", code=2)
            return json.loads(result.stdout)["problems"]
        def named(problem, lines):
            self.assertEqual((problem["endLine"], problem["severity"]), (problem["line"], "error"))
            line = lines[problem["line"] - 1].encode("utf-16-le")
            return line[2 * (problem["column"] - 1):2 * (problem["endColumn"] - 1)].decode("utf-16-le")
        problems = told("a.xml", text)
        self.assertEqual([(problem["line"], named(problem, text.split("\n"))) for problem in problems],
                         [(2, "2"), (3, "nam"), (3, "1,5"), (4, "surface"), (4, "wrong"), (6, 'frame="1"'), (7, "shet")])
        problems = told("b.xml", "\ufeff<scene start='1' end='9'>\r\n  <point name='p'>\r\n</scene>\r\n")
        self.assertEqual([(problem["line"], problem["column"], problem["endColumn"]) for problem in problems], [(3, 1, 9)])
        # Several things on one line.
        one = ('<scene version="1" start="1" end="9"><surface name="s"><grid columns="5" rows="5"/></surface>'
               '<point name="a" forceRadius="1"/><point name="b" forceRadius="-1"/><line name="1"/><line name="s"/>'
               '<point name="c"><animate attribute="magnitude"><key frame="1" value="1"/><key frame="3" value="x"/>'
               '</animate></point> stray </scene>')
        self.assertEqual([named(problem, one.split("\n")) for problem in told("one.xml", one)],
                         ["-1", "1", "x", "stray", "s"])
        second = [problem for problem in told("one.xml", one) if "already" in problem["message"]][0]
        self.assertGreater(second["column"], one.index("<line name=\"s\""))
        # The same element and attribute twice on one line: the one that the message is about.
        two = ('<scene version="1" start="1" end="9"><surface name="a"><grid columns="5" rows="5"/>{0}</surface>'
               '<surface name="b"><grid columns="5" rows="5"/>{1}</surface></scene>')
        whole = '<solver region="all" edges="free"/>'
        moving = '<material><animate attribute="{}"><key frame="1" value="1"/><key frame="9" value="-1"/></animate></material>'
        for good, bad, word in (
                ('<material density="1"/>', '<material density="-1"/>', "-1"),
                ('<material density="0" damping="1"/>' + whole, '<material density="0" damping="0"/>' + whole, "0"),
                (moving.format("c"), moving.format("density"), "density"),
                (moving.format("c"), moving.format("b"), "b"),
                ('<transform scale="1 1 1"/>', '<transform scale="1 0 1"/>', "1 0 1"),
                ('<material b="1" c="-1"/>', '<material b="1" c="-2"/>', "-2")):
            for parts, is_second in (((good, bad), True), ((bad, good), False)):
                line = two.format(*parts)
                with self.subTest(line):
                    problem, = told("two.xml", line)
                    self.assertEqual(named(problem, [line]), word, problem["message"])
                    self.assertEqual(problem["column"] > line.index('name="b"'), is_second, problem["message"])
        line = two.replace("{1}", "").replace("{0}", "").replace('rows="5"/></surface></scene>', "/></surface></scene>")
        problem, = told("two.xml", line)
        self.assertEqual(named(problem, [line]), "grid")
        self.assertGreater(problem["column"], line.index('name="b"'))
        long = text.replace("<!-- ", "<!-- " + "\u00fc\U0001f44b " * 3000)
        self.assertEqual([named(problem, long.split("\n")) for problem in told("long.xml", long)],
                         [named(problem, text.split("\n")) for problem in told("a.xml", text)])
        # A line of a file that is no XML, and no file at all.
        scene = SCENE.format(end=9)
        self.write("m.obj", "v 0 0 0\nf 1 2 x\n")
        for problem in told("c.xml", scene.replace(
                '<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="m.obj"/>')):
            if problem["file"].endswith(".obj"):
                self.assertEqual([problem[name] for name in ("column", "endLine", "endColumn")], [None] * 3)
        noted = scene.replace(' magnitude="3000"/>', """><animate attribute="magnitude">
      <key frame="1" value="0" out="1" outLength="-2"/><key frame="9" value="5"/></animate></point>""")
        notes = json.loads(self.run_pliant("validate", self.write("n.xml", noted), "--json").stdout)["problems"]
        self.assertEqual({note["severity"] for note in notes}, {"information"})

    def test_a_mesh_in_the_place_of_a_scene_is_told(self):
        self.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n")
        for words in (("bake", "m.obj", "-o", "a.npy"), ("validate", "m.obj"), ("view", "m.obj", "-o", "a.html"),
                      ("suggest", "m.obj", "--peak", "1"), ("curves", "m.obj")):
            told = self.run_pliant(*words, code=2).stderr
            self.assertRegex(told, r"^m\.obj: error: it is a mesh, not a scene; [^\n]*\n$")

    def test_a_scene_without_a_surface_is_legal(self):
        scene = self.write("curves.xml", '<scene version="1" start="1" end="9"><point name="p"/></scene>')
        self.run_pliant("validate", scene)
        self.assertIn("no surface", self.run_pliant("info", scene).stdout)
        self.assertIn("no surface", self.run_pliant("bake", scene, "-o", "a.npy", code=2).stderr)

    def test_nothing_is_run_or_allocated(self):
        scene = self.write("large.xml", SCENE.format(end=1000000).replace('"13"', '"10000"').replace(
            '"11"', '"10000"'))
        self.run_pliant("validate", scene, "--max-memory", "1000000")
        self.assertIn("needs 85", self.run_pliant("validate", scene, "--max-memory", "2", code=1).stderr)

    def test_interrupted_it_does_not_say_all_right(self):
        os.mkfifo(self.path("pipe.xml"))
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([PLIANT, "validate", self.path("pipe.xml"), self.scene()],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                time.sleep(0.5)  # it waits for a writer of the pipe
                process.send_signal(number)
                out, _ = process.communicate(timeout=30)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(out, "")

    def test_a_mesh_that_is_no_file_is_not_waited_for(self):
        os.mkfifo(self.path("m.obj"))
        os.symlink("/dev/zero", self.path("z.obj"))
        for name in ("m.obj", "z.obj"):
            scene = self.write("p.xml", SCENE.format(end=9).replace(GRID, f'<mesh file="{name}"/>'))
            self.assertIn("it is not a regular file", self.run_pliant("validate", scene, code=2).stderr)

    def test_notes_are_told(self):
        scene = self.write("n.xml", SCENE.format(end=9).replace(' magnitude="3000"/>', """>
    <animate attribute="magnitude">
      <key frame="1" value="0" out="1" outLength="-2"/><key frame="9" value="5"/></animate></point>"""))
        result = self.run_pliant("validate", scene)
        self.assertRegex(result.stderr, r"^\S*n\.xml:6: note: poke\.magnitude: key 1: [^\n]+\n$")


class Info(Command):
    def test_warnings_are_told_by_each_command(self):
        scene = self.write("s.xml", """<scene version="1" start="1" end="20">
<surface name="sheet"><grid columns="9" rows="9"/></surface>
<point name="poke" deformationRadius="0.2"
       forceRadius="0.4"><animate attribute="magnitude"><key frame="1" value="100"/><key frame="9" value="0"/></animate></point>
<point name="late"><animate attribute="magnitude">
<key frame="30" value="0"/><key frame="40" value="5"/></animate></point>
</scene>""")
        lines = [":4: warning: the forceRadius of \"poke\" exceeds deformationRadius",
                 ":5: warning: the keys of late.magnitude are outside the frames 1 to 20"]
        for command in (["validate", scene], ["info", scene], ["bake", scene, "-o", self.path("a.npy")]):
            told = self.run_pliant(*command).stderr
            for line in lines:
                self.assertEqual(told.count(line), 1, (command, told))
        problems = json.loads(self.run_pliant("validate", scene, "--json").stdout)["problems"]
        self.assertEqual(sorted((p["line"], p["kind"], p["severity"]) for p in problems),
                         [(4, "warning", "warning"), (5, "warning", "warning")])
        warnings = json.loads(self.run_pliant("info", scene, "--json").stdout)["warnings"]
        self.assertEqual(sorted(w["line"] for w in warnings), [4, 5])
        self.assertTrue(all(w["message"] for w in warnings))

    def test_what_an_author_chooses_numbers_by(self):
        scene = self.write("i.xml", SCENE.format(end=48).replace(' magnitude="3000"/>', """>
    <animate attribute="magnitude">
      <key frame="1" value="0"/><key frame="9" value="-4000"/></animate></point>"""))
        told = self.run_pliant("info", scene).stdout
        for words in ("frames 1 to 48 at 24 frames/s",
                      "sheet  sheet, grid 13 x 11, 143 vertices\n    bounding box -6 0 -5 to 6 0 5\n",
                      "poke (point) on sheet: at frame 9, at magnitude -4000, it selects 9 x 9 nodes, "
                      "columns 2 to 10, rows 1 to 9",
                      "static peak displacement", "; in the animation", " Hz, damping ratio",
                      "with the damping of its steps", "settles to 5 % in",
                      "poke.magnitude  2 keys: 1 = 0, 9 = -4000", "memory"):
            self.assertIn(words, told)

    def test_forces_that_do_nothing_are_listed_with_the_reason(self):
        text = SCENE.format(end=9)
        for old, new, words in (
                ("<point", '<point enabled="false"', "poke (point): never enabled"),
                ('name="sheet"', 'name="sheet" enabled="false"', "poke (point): no surface is solved"),
                ("</surface>", '<solver startFrame="50"/></surface>', "poke (point): no surface is solved")):
            self.assertIn(words, self.run_pliant("info", self.write("n.xml", text.replace(old, new))).stdout)

    def test_json_is_json_whatever_the_names(self):
        for name in ("\u202ea.xml", "a\u009b\x7f.xml", "ä.xml"):
            for command in ("info", "validate"):
                told = json.loads(self.run_pliant(command, self.write(name, SCENE.format(end=3)), "--json").stdout)
                self.assertIn(name, json.dumps(told, ensure_ascii=False))

    def test_forces_far_apart_in_one_box_are_told(self):
        scene = SCENE.format(end=5).replace(POINT, "".join(
            f'<point name="{name}" center="{x} 0 {z}" deformationRadius="1.9" forceRadius="1.5" magnitude="1000"/>'
            for name, x, z in (("a", -4, -3), ("b", 4, 3))))
        self.assertIn("boxes do not all meet", self.run_pliant("info", self.write("f.xml", scene)).stdout)
        for combine in ("box", "islands", "union"):
            written = scene.replace("</surface>", f'<solver combine="{combine}"/></surface>')
            self.assertNotIn("do not all meet", self.run_pliant("info", self.write("f.xml", written)).stdout)

    @unittest.skipIf(SANITIZED, "a million frames are looked at")
    def test_what_would_take_too_long_is_left_out(self):
        scene = self.write("l.xml", SCENE.format(end=1000000).replace('"13"', '"601"').replace(
            '"11"', '"601"').replace('"4.5"', '"100"'))
        self.assertIn("too many nodes to preview", self.run_pliant("info", scene).stdout)
        scene = self.write("f.xml", SCENE.format(end=1000000).replace('"13"', '"201"').replace(
            '"11"', '"201"').replace('center="0 0 0"', "").replace('magnitude="3000"/>', """>
    <animate attribute="center"><key frame="1" value="0 60 0"/><key frame="1000000" value="0 5 0"/></animate></point>"""))
        told = self.run_pliant("info", scene).stdout
        self.assertIn("it selects nothing", told)
        scene = self.write("p.xml", SCENE.format(end=1000000))
        self.assertIn("too many frames and nodes to play", self.run_pliant("info", scene).stdout)

    def test_groups_and_paths(self):
        scene = self.write("g.xml", SCENE.format(end=9).replace(
            POINT, '<group name="hand" deformationRadius="4.5">' +
            PATH.replace("</path>", animated("progress", (1, 0), (9, 0.25)) + "</path>") +
            '<point name="palm" magnitude="3000"/><uniform name="weight"/></group>' +
            '<group name="empty"/><inertia name="jiggle"/>'))
        told = self.run_pliant("info", scene).stdout
        for words in ("palm (point in hand) on sheet: at frame 1, at magnitude 3000, it selects 9 x 9 nodes",
                      "weight (uniform in hand) on sheet: at frame 1, at magnitude 0, it selects 9 x 9 nodes",
                      "jiggle (inertia) on sheet: at frame 1, at magnitude 1, it selects 13 x 11 nodes",
                      "  hand on sheet: at frame 1 it selects 9 x 9 nodes", "    of the static peak: palm 100 %, weight 0 %",
                      "together on sheet: at frame 1 they select 13 x 11 nodes",
                      "empty (group): it has no forces",
                      "hand.center.progress  2 keys: 1 = 0, 9 = 0.25"):
            self.assertIn(words, told)
        rows = self.run_pliant("curves", scene, "--channel", "hand.center.progress", "palm.magnitude",
                               "weight.direction", "--frames", "9").stdout.splitlines()
        self.assertEqual(rows[1:], ["hand.center.progress,9,0.25", "palm.magnitude,9,3000",
                                    "weight.direction,9,0,1,0"])
        self.assertIn("its channel is hand.center.progress", self.run_pliant(
            "curves", scene, "--channel", "hand.center", code=2).stderr)

    def test_a_force_out_of_reach(self):
        scene = self.write("far.xml", SCENE.format(end=9).replace('"0 0 0"', '"3 90 4"'))
        told = self.run_pliant("info", scene).stdout
        self.assertIn("poke (point) on sheet: it selects nothing\n    nearest at frame 1: 90 to the nearest "
                      "vertex, 90.14 to the middle of the bounding box, deformationRadius 4.5\n", told)
        self.assertIn("its largest magnitude is 3000 (frame 1)", told)

    def test_a_box_that_is_placed_is_told_both_ways(self):
        scene = self.write("t.xml", SCENE.format(end=9).replace(
            "</surface>", '<transform translate="100 0 0" scale="2 1 1"/></surface>'))
        self.assertIn("bounding box 88 0 -5 to 112 0 5\n    -6 0 -5 to 6 0 5 before its transform\n",
                      self.run_pliant("info", scene).stdout)

    def test_numbers_at_the_edge_are_told(self):
        plain = SCENE.format(end=6)
        self.assertIn("magnitude=", plain)
        for name, text in (("magnitude", re.sub(r'magnitude="[^"]*"', 'magnitude="1e200"', plain)),
                           ("c", plain.replace("</surface>", '<material c="1e160"/></surface>'))):
            with self.subTest(name):
                scene = self.write("edge.xml", text)
                told = json.loads(self.run_pliant("info", scene, "--json").stdout)
                peak = told["together"][0]["staticPeak"]
                self.assertTrue(0 < peak < 1e300, peak)
                self.run_pliant("suggest", scene, "--settle", "1s", code=None)
                self.assertNotRegex(self.run_pliant("bake", scene, "-o", "a.npy").stdout, "inf|nan")

    def test_what_is_beyond_a_number_is_said(self):
        light = self.write("light.xml", SCENE.format(end=6).replace("</surface>", '<material density="5e-324"/></surface>'))
        far = self.write("far.xml", SCENE.format(end=6).replace(
            "</scene>", '<line name="far" from="-1e308 1 0" to="1e308 1 0" deformationRadius="0.5" magnitude="1"/></scene>'))
        for scene in (light, far):
            self.assertNotRegex(self.run_pliant("info", scene).stdout, r"\b(inf|nan)\b")
            self.assertRegex(self.run_pliant("info", scene).stdout, "too (high|far) for a number")

    def test_a_loop_that_does_not_close_is_told_with_all_else(self):
        scene = self.write("loop.xml", '<scene version="1" start="1" end="24"><surface name="s"><grid columns="21" '
                                       'rows="21" width="4" depth="3"/><material density="40" damping="0"/><solver '
                                       'region="all" loop="24" integrator="newmark"/></surface><uniform name="f" '
                                       'magnitude="5" forceRadius="3"/></scene>')
        told = self.run_pliant("info", scene, code=1)
        self.assertIn("more damping makes it forget how it began", told.stderr)
        self.assertIn("first natural frequency", told.stdout)
        self.assertIn("bounding box -2 0 -1.5 to 2 0 1.5", told.stdout)

    def test_one_is_no_plural(self):
        told = self.run_pliant("info", self.scene()).stdout
        self.assertNotRegex(told, r"\b1 (frames|vertices|keys|surfaces|forces)\b")
        one = self.write("one.xml", SCENE.format(end=1))
        for command in (("info", one), ("validate", one), ("bake", one, "-o", "a.npy"),
                        ("replay", "record", one, "-o", "a.replay"), ("replay", "verify", "a.replay"),
                        ("bake", one, "-o", "b.npy", "--cache", "kept")):
            told = self.run_pliant(*command)
            self.assertNotRegex(told.stdout + told.stderr, r"\b1 (frames|vertices|keys|surfaces|forces)\b")

    def test_json_has_what_the_text_has(self):
        scene = self.write("i.xml", SCENE.format(end=48).replace(' magnitude="3000"/>', """>
    <animate attribute="magnitude">
      <key frame="1" value="0"/><key frame="9" value="-4000"/></animate></point>
  <group name="hand" deformationRadius="4.5"><point name="palm" magnitude="0.1"/></group>
  <point name="off" enabled="false"/><point name="far" center="0 50 0"/>"""))
        told = json.loads(self.run_pliant("info", scene, "--json").stdout)
        self.assertEqual((told["format"], told["start"], told["end"], told["fps"]),
                         ("pliant-info-1", 1, 48, 24))
        self.assertEqual(told["surfaces"][0]["boundingBox"], {"low": [-6, 0, -5], "high": [6, 0, 5]})
        poke, palm, off, far = told["forces"]
        self.assertEqual(poke["previews"][0]["frame"], 9)
        self.assertEqual(poke["previews"][0]["selected"], {"columns": [2, 10], "rows": [1, 9]})
        self.assertEqual(palm["previews"][0]["magnitude"], 0.1)  # the same float64
        self.assertEqual((palm["group"], off["idle"], off["previews"]), ("hand", "never enabled", []))
        self.assertEqual(far["previews"][0]["gap"],
                         {"frame": 1, "toVertex": 50, "toCentre": 50, "deformationRadius": 1})
        self.assertEqual([one["force"] for one in told["groups"][0]["previews"][0]["shares"]], ["palm"])
        self.assertEqual(told["channels"], [{"path": "poke.magnitude", "keys": [
            {"frame": 1, "value": 0}, {"frame": 9, "value": -4000}]}])
        vibration = told["together"][0]["regions"][0]["vibration"]
        self.assertGreater(vibration["dampingRatio"], vibration["naturalDampingRatio"])
        text = self.run_pliant("info", scene).stdout
        self.assertIn(f"{told['together'][0]['animation']['peak']:.4g} at frame", text)
        self.assertEqual(self.run_pliant("info", "none.xml", "--json", code=2).stdout, "")

    def test_json_of_a_name_that_is_no_text(self):
        scene = os.path.join(os.fsencode(self.folder), b'a"\n\xff.xml')
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE.format(end=3))
        for command in ("info", "validate"):
            told = subprocess.run([os.fsencode(PLIANT), command.encode(), scene, b"--json"], check=True,
                                  capture_output=True, timeout=60).stdout
            self.assertEqual(json.loads(told)["format"], f"pliant-{command}-1")


if __name__ == "__main__":
    main()
