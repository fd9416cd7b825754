"""`pliant curves`."""

import subprocess
import xml.etree.ElementTree

from command import PLIANT, Command, main

CURVES = """<scene version="1" start="1" end="9">
  <surface name="sheet"><grid columns="5" rows="5"/>
    <transform><animate attribute="translate"><key frame="1" value="0 1 2"/><key frame="5" value="4 5 7"/>
    </animate></transform></surface>
  <point name="poke">
    <animate attribute="magnitude" interpolation="linear" after="linear"><key frame="1" value="0.1"/>
      <key frame="4" value="3"/><key frame="6" value="-1" left="10"/></animate>
    <animate attribute="enabled"><key frame="2" value="true"/><key frame="4" value="false"/></animate>
  </point>
</scene>
"""


class Curves(Command):
    def rows(self, *arguments):
        """The rows of a table without its header, as a path and numbers each."""
        lines = self.run_pliant("curves", *arguments).stdout.splitlines()
        self.assertTrue(lines[0].startswith("channel,frame,value"), lines[0])
        return [(line.split(",")[0], *map(float, line.split(",")[1:])) for line in lines[1:]]

    def test_all_animated_channels_over_the_scene_s_frames(self):
        rows = self.rows(self.write("c.xml", CURVES))
        self.assertEqual([row[0] for row in rows[::9]], ["sheet.translate", "poke.enabled", "poke.magnitude"])
        self.assertEqual(len(rows), 27)
        self.assertEqual([row[1] for row in rows[:9]], list(range(1, 10)))
        self.assertEqual(rows[0][2:], (0, 1, 2))  # a vector appends its components
        self.assertEqual([row[2] for row in rows[9:18]], [1, 1, 1, 0, 0, 0, 0, 0, 0])

    def test_named_channels_in_their_order_and_constant_ones(self):
        rows = self.rows(self.write("c.xml", CURVES), "--channel", "poke.magnitude", "sheet.density",
                         "--frames", "-2:2", "--step", "2")
        self.assertEqual([(row[0], row[1]) for row in rows],
                         [("poke.magnitude", frame) for frame in (-2, 0, 2)] +
                         [("sheet.density", frame) for frame in (-2, 0, 2)])
        self.assertEqual([row[2] for row in rows[3:]], [1, 1, 1])

    def test_full_precision_and_sides(self):
        scene = self.write("c.xml", CURVES)
        text = self.run_pliant("curves", scene, "--channel", "poke.magnitude", "--frames", "1:6",
                               "--sides").stdout.splitlines()
        self.assertEqual(text[0], "channel,frame,value,value_left,velocity,velocity_left")
        self.assertEqual(text[1].split(",")[2], "0.1")  # the shortest text of the double
        for line in text[1:]:
            for number in line.split(",")[1:]:
                self.assertLessEqual(len(number), len(repr(float(number))))
        last = [float(number) for number in text[6].split(",")[1:]]
        self.assertEqual(last[:3], [6, -1, 10])
        self.assertEqual(last[4], 3.5)  # the slope: from 3 to 10 in two frames

    def test_frames_from_a_file(self):
        scene = self.write("c.xml", CURVES)
        at = self.write("at.txt", "3.25\n1e9\n\n3.25\r\n-7\n0.1")
        rows = self.rows(scene, "--channel", "poke.magnitude", "--at", at)
        self.assertEqual([row[1] for row in rows], [3.25, 1e9, 3.25, -7, 0.1])  # duplicates are kept
        self.assertEqual(rows[0], rows[2])
        for text, line in (("1\nx\n", 2), ("nan", 1), ("1,5", 1), ("1 2", 1)):
            result = self.run_pliant("curves", scene, "--at", self.write("bad.txt", text), code=2)
            self.assertRegex(result.stderr, rf"^\S*bad\.txt:{line}: error: [^\n]+\n$")
        self.run_pliant("curves", scene, "--at", "none.txt", code=2)

    def test_a_step_ends_on_the_last_frame(self):
        scene = self.write("c.xml", CURVES)
        for step, count in (("0.1", 11), ("0.3", 4), ("1e-3", 1001), ("7", 1)):
            self.assertEqual(len(self.rows(scene, "--channel", "sheet.b", "--frames", "1:2", "--step",
                                           step)), count)

    def test_files(self):
        scene = self.write("c.xml", CURVES)
        self.run_pliant("curves", scene, "-o", self.path("c.csv"))
        with open(self.path("c.csv"), encoding="utf-8") as file:
            self.assertEqual(file.read(), self.run_pliant("curves", scene).stdout)
        self.run_pliant("curves", scene, "-o", self.path("c.svg"))
        root = xml.etree.ElementTree.parse(self.path("c.svg")).getroot()
        text = "".join(root.itertext())
        for words in ("sheet.translate", "poke.enabled", "poke.magnitude", "key", "handle", "frames 1 to 9",
                      "prefers-color-scheme: dark", "false", "true"):
            self.assertIn(words, text)
        kinds = [element.get("class", "").split()[0] for element in root.iter() if element.get("class")]
        self.assertEqual(kinds.count("key"), 3 * 2 + 2 + 3 + 3)  # and one in each legend
        self.assertEqual(self.files(), ["c.csv", "c.svg", "c.xml"])

    def test_a_scene_without_a_surface(self):
        scene = self.write("p.xml", CURVES[:CURVES.index("  <surface")] + CURVES[CURVES.index("  <point"):])
        self.assertEqual(len(self.rows(scene)), 18)

    def test_values_that_a_run_would_refuse_can_be_looked_at(self):
        scene = self.write("n.xml", CURVES.replace('attribute="magnitude"', 'attribute="forceRadius"'))
        self.assertEqual(len(self.rows(scene, "--channel", "poke.forceRadius")), 9)
        self.run_pliant("validate", scene, code=2)

    def test_wrong_usage(self):
        scene = self.write("c.xml", CURVES)
        self.write("at.txt", "1\n")
        for arguments, words in ((["--channel", "poke.magnitud"], 'did you mean "magnitude"? allowed: '),
                                 (["--channel", "none.b"], "nothing is named"),
                                 (["--channel", "sheet.stiffness"], 'did you mean "b", "c" and "d"?'),
                                 (["--frames", "3:1"], "A:B with A <= B"),
                                 (["--frames", "nan:1"], "A:B with A <= B"),
                                 (["--frames", "0:1e300"], "too many; at most"),
                                 (["--step", "0"], "must be a number from"),
                                 (["--step", "nan"], "must be a number from"),
                                 (["--at", "at.txt", "--step", "2"], "excludes"),
                                 (["-o", "c.png"], "allowed: .csv, .svg"),
                                 (["-o", "c.svg", "--frames", "3"], "two frames")):
            result = self.run_pliant("curves", scene, *arguments, code=2)
            self.assertIn(words, result.stderr)
            self.assertEqual(result.stdout, "")
        self.assertEqual(self.files(), ["at.txt", "c.xml"])
        with open("/dev/full", "w", encoding="utf-8") as full:
            code = subprocess.run([PLIANT, "curves", scene], stdout=full, stderr=subprocess.DEVNULL,
                                  check=False, timeout=60).returncode
        self.assertEqual(code, 1)


if __name__ == "__main__":
    main()
