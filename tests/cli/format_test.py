"""`pliant format`."""

import os
import subprocess

from command import Command, PLIANT, SOURCE, main

TEXT = """<scene  version='1' start="1" end="2"><!-- the shot -->
<surface name='sheet'><grid rows="5" columns='5'/></surface>
    <point name="poke" magnitude="1.50" />


</scene>"""
FORMATTED = """<scene version="1" start="1" end="2"> <!-- the shot -->
  <surface name="sheet">
    <grid rows="5" columns="5"/>
  </surface>
  <point name="poke" magnitude="1.50"/>
</scene>
"""


class Format(Command):
    def test_it_is_written_where_it_is_wanted(self):
        scene = self.write("a.xml", TEXT)
        result = self.run_pliant("format", scene)
        self.assertEqual((result.stdout, result.stderr), (FORMATTED, ""))
        self.run_pliant("format", scene, "-o", "b.xml")
        self.assertEqual(self.read("b.xml"), FORMATTED.encode())
        self.assertEqual(self.read("a.xml"), TEXT.encode())
        self.run_pliant("format", scene, "--in-place")
        self.assertEqual(self.read("a.xml"), FORMATTED.encode())
        self.assertEqual(self.files(), ["a.xml", "b.xml"])

    def test_a_layout_that_could_not_be_read_again_is_not_written(self):
        lines = "\n " * (25 << 20)  # each gets the indentation of the deepest level
        scene = self.write("a.xml", TEXT.replace("</scene>", f"""<group name="g"><point name="f"><path attribute="center">
 <waypoint at="0 0 0"/><waypoint at="1 0 0"/><waypoint at="2 1 0"/><animate attribute="progress"><key frame="1" value="0"/>
 <!--{lines} --></animate></path></point></group></scene>"""))
        before = self.read("a.xml")
        for options in (["--in-place"], ["-o", "b.xml"]):
            result = self.run_pliant("format", scene, *options, code=2)
            self.assertIn("the scene would be larger than 256 MiB", result.stderr)
        self.assertEqual(self.read("a.xml"), before)
        self.assertEqual(self.files(), ["a.xml"])

    def test_a_replaced_file_keeps_its_permissions(self):
        scene = self.write("a.xml", TEXT)
        os.chmod(scene, 0o600)
        self.run_pliant("format", scene, "--in-place")
        self.assertEqual(os.stat(scene).st_mode & 0o777, 0o600)

    def test_a_scene_that_names_files_stays_in_its_folder(self):
        self.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n")
        scene = self.write("a.xml", TEXT.replace("<grid rows=\"5\" columns='5'/>", '<mesh file="a.obj"/>'))
        os.mkdir(self.path("b"))
        result = self.run_pliant("format", scene, "-o", "b/a.xml", code=2)
        self.assertIn("relative to its own folder", result.stderr)
        self.assertEqual(os.listdir(self.path("b")), [])
        self.run_pliant("format", scene, "-o", "b.xml")
        self.run_pliant("validate", "b.xml")

    def test_a_scene_in_this_layout_is_not_touched(self):
        scene = self.write("a.xml", FORMATTED)
        os.utime(scene, (1000, 1000))
        before = os.stat(scene)
        self.run_pliant("format", scene, "--in-place")
        self.assertEqual((os.stat(scene).st_ino, os.stat(scene).st_mtime), (before.st_ino, before.st_mtime))

    def test_bytes_pass_through_pipes(self):
        text = "\ufeff" + TEXT.replace("\n", "\r\n").replace("shot", "ä€😀\u009b")
        result = subprocess.run([PLIANT, "format", "-"], input=text.encode(), capture_output=True, timeout=120,
                                check=True, cwd=self.folder)
        expected = "\ufeff" + FORMATTED.replace("\n", "\r\n").replace("shot", "ä€😀\u009b")
        self.assertEqual(result.stdout, expected.encode())

    def test_errors_write_nothing(self):
        bad = TEXT.replace("magnitude", "magnitud")
        scene = self.write("a.xml", bad)
        for where in ([], ["-o", "b.xml"], ["--in-place"]):
            result = self.run_pliant("format", scene, *where, code=2)
            self.assertRegex(result.stderr, r"a\.xml:3: error: <point> has no attribute \"magnitud\"")
            self.assertEqual(result.stdout, "")
        self.assertEqual(self.read("a.xml"), bad.encode())
        good = self.write("good.xml", TEXT)
        for arguments, words in ((["--in-place", "-o", "b.xml"], "excludes"),
                                 (["-o", "good.xml"], "--in-place replaces it"),
                                 (["-o", "none/b.xml"], "the folder none does not exist"),
                                 (["-o", "-"], "standard output")):
            result = self.run_pliant("format", good, *arguments, code=None)
            self.assertNotEqual(result.returncode, 0)
            self.assertRegex(result.stderr, r"^pliant: error: [^\n]+\n$|^[^\n]+: error: [^\n]+\n$")
            self.assertIn(words, result.stderr)
        self.assertIn("--in-place replaces the file", self.run_pliant("format", "-", "--in-place", code=2).stderr)
        self.assertEqual(self.read("good.xml"), TEXT.encode())
        self.assertEqual(self.files(), ["a.xml", "good.xml"])

    def test_it_replaces_no_mesh(self):
        with open(os.path.join(SOURCE, "examples", "sheet.xml"), encoding="utf-8") as file:
            self.write("sheet.xml", file.read())
        self.run_pliant("bake", "sheet.xml", "-o", "m.obj", "--frames", "1")
        mesh = [name for name in self.files() if name.endswith(".obj")][0]
        scene = self.write("a.xml", TEXT.replace("<grid rows=\"5\" columns='5'/>", f'<mesh file="{mesh}"/>'))
        before = self.read(mesh)
        self.assertIn("it is a mesh of the scene", self.run_pliant("format", scene, "-o", mesh, code=2).stderr)
        self.assertEqual(self.read(mesh), before)


if __name__ == "__main__":
    main()
