"""Files that belong to others: those that a command changes, and those that it must not touch."""

import os
import shutil
import subprocess
import unittest

from command import Command, PLIANT, SCENE, SHIM, animated, main

KEYED = SCENE.format(end=12).replace('magnitude="3000"/>', ">" + animated("magnitude", (1, 0), (5, 3000)) + "</point>")


class Rewrites(Command):
    """Commands that change the scene that they read."""

    def setUp(self):
        super().setUp()
        self.write("keyed.xml", KEYED)
        self.run_pliant("export", "curves", "keyed.xml", "-o", "keys.json")
        self.write("scene.xml", SCENE.format(end=12))
        self.text = self.read("scene.xml")
        self.commands = (["format", "scene.xml", "--in-place"], ["suggest", "scene.xml", "--peak", "1", "--write"],
                         ["import", "curves", "keys.json", "-o", "scene.xml"])

    def restore(self):
        with open(self.path("scene.xml"), "wb") as file:
            file.write(self.text)

    @unittest.skipIf(os.geteuid() != 0, "only root can give files away")
    def test_the_owner_and_the_group_stay(self):
        for command in self.commands:
            self.restore()
            os.chown(self.path("scene.xml"), 1234, 2345)
            os.chmod(self.path("scene.xml"), 0o640)
            self.run_pliant(*command)
            status = os.stat(self.path("scene.xml"))
            self.assertEqual((status.st_uid, status.st_gid, status.st_mode & 0o7777), (1234, 2345, 0o640), command)
            self.assertNotEqual(self.read("scene.xml"), self.text)

    @unittest.skipIf(os.geteuid() != 0 or not shutil.which("setpriv"), "only root can be another user")
    def test_who_cannot_keep_them_changes_nothing(self):
        os.chmod(self.folder, 0o777)
        program = shutil.copy(PLIANT, self.path("pliant"))
        os.chmod(program, 0o755)
        for owner, group in ((1234, 2345), (1235, 2346)):
            for command in self.commands:
                self.restore()
                os.chown(self.path("scene.xml"), owner, group)
                os.chmod(self.path("scene.xml"), 0o666)
                before = self.files()
                result = subprocess.run(["setpriv", "--reuid=1235", "--regid=2345", "--clear-groups", program, *command],
                                        cwd=self.folder, capture_output=True, text=True, check=False)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("scene.xml: error: cannot write the file: it belongs to another user or group", result.stderr)
                self.assertEqual((self.read("scene.xml"), self.files()), (self.text, before))
                status = os.stat(self.path("scene.xml"))
                self.assertEqual((status.st_uid, status.st_gid), (owner, group))

    def test_what_an_editor_saves_meanwhile_stays(self):
        if not SHIM:
            self.skipTest("the shim does not go with a sanitizer")
        for moment in ("flush", "exchange"):
            for command in self.commands:
                self.restore()
                before = self.files()
                result = self.run_pliant(*command, code=1, env={
                    **os.environ, "LD_PRELOAD": SHIM, "PLIANT_SHIM_SAVE": f"{moment} {self.path('scene.xml')}"})
                self.assertIn("scene.xml: error: cannot write the file: it has changed since it was read", result.stderr)
                self.assertEqual((self.read("scene.xml"), self.files()), (b"saved", before), (moment, command))

    def test_the_scene_is_the_one_that_was_read_ahead_of_the_curves(self):
        os.mkfifo(self.path("pipe.json"))
        with subprocess.Popen([PLIANT, "import", "curves", "pipe.json", "-o", "scene.xml"], cwd=self.folder, text=True,
                              stderr=subprocess.PIPE) as process:
            with open(self.path("pipe.json"), "wb") as pipe:  # opens when the scene is read
                self.write("scene.xml", KEYED)
                pipe.write(self.read("keys.json"))
            _, errors = process.communicate()
        self.assertEqual(process.returncode, 1, errors)
        self.assertIn("scene.xml: error: cannot write the file: it has changed since it was read", errors)
        self.assertEqual(self.read("scene.xml").decode(), KEYED)

    def test_a_file_system_that_exchanges_no_names(self):
        if not SHIM:
            self.skipTest("the shim does not go with a sanitizer")
        for command in self.commands:
            self.restore()
            before = self.files()
            self.run_pliant(*command, env={**os.environ, "LD_PRELOAD": SHIM, "PLIANT_SHIM_FAIL": "exchange 22"})
            self.assertNotEqual(self.read("scene.xml"), self.text)
            self.assertEqual(self.files(), before)

    def test_killed_at_any_moment_the_scene_is_whole(self):
        if not SHIM:
            self.skipTest("the shim does not go with a sanitizer")
        new = None
        for event in range(10, 0, -1):
            self.restore()
            result = subprocess.run([PLIANT, *self.commands[0]], cwd=self.folder, check=False, capture_output=True,
                                    env={**os.environ, "LD_PRELOAD": SHIM, "PLIANT_SHIM_KILL": str(event)})
            new = new or self.read("scene.xml")
            self.assertIn(self.read("scene.xml"), (self.text, new))
        self.assertEqual(result.returncode, -9)
        self.assertNotEqual(new, self.text)


class Others(Command):
    def test_an_input_is_known_under_its_other_names(self):
        self.run_pliant("bake", self.scene(end=3), "-o", "mesh.obj", "--frames", "1")
        os.rename(self.path("mesh.0001.obj"), self.path("mesh.obj"))
        self.write("own.xml", SCENE.format(end=3).replace(
            '<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="mesh.obj"/>'))
        for out, link, command in (("a.npy", "a.npy", ["bake"]), ("s.obj", "s.0002.obj", ["bake"]),
                                   ("c.pc2", "c.obj", ["bake"]), ("a.glb", "a.glb", ["bake"]),
                                   ("a.csv", "a.csv", ["curves"]), ("a.replay", "a.replay", ["replay", "record"])):
            for input_file in ("mesh.obj", "own.xml"):
                os.link(self.path(input_file), self.path(link))
                text = self.read(link)
                self.assertRegex(self.run_pliant(*command, "own.xml", "-o", out, code=2).stderr,
                                 r"would overwrite|it is the scene|it is a mesh of the scene")
                self.assertEqual(self.read(link), text)
                self.assertTrue(os.path.samefile(self.path(link), self.path(input_file)))
                os.remove(self.path(link))
        os.link(self.path("mesh.obj"), self.path("new.xml"))
        self.assertIn("it is the mesh", self.run_pliant("new", "mesh", "--mesh", "mesh.obj", "-o", "new.xml", "--force",
                                                        code=2).stderr)

    def test_no_file_of_another_name_is_removed(self):
        self.scene(end=2)
        self.run_pliant("sweep", "run", "scene.xml", "--vary", "poke.magnitude=1,2", "-o", "sweep")
        old = 1_000_000_000
        for name in ("sweep/.mine.part", "sweep/.takes.csv.1-0.part", ".mine.part"):
            os.utime(self.write(name, "mine"), (old, old))
        for command in (["sweep", "run", "sweep"], ["sweep", "status", "sweep"],
                        ["bake", "scene.xml", "-o", "a.gltf"], ["bake", "scene.xml", "-o", "a.gltf", "--frames", "1"]):
            self.run_pliant(*command)
        for name in ("sweep/.mine.part", "sweep/.takes.csv.1-0.part", ".mine.part"):
            self.assertEqual(self.read(name), b"mine")


if __name__ == "__main__":
    main()
