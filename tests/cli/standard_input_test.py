"""A scene from a pipe."""

import os
import signal
import subprocess
import time

from command import Command, PLIANT, SCENE, GRID, main


class StandardInput(Command):
    def pipe(self, text, *arguments, code=0):
        result = subprocess.run([PLIANT, *arguments], input=text, capture_output=True, text=True, timeout=120,
                                check=False, cwd=self.folder)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def test_it_is_the_same_scene(self):
        scene = self.scene()
        text = SCENE.format(end=12)
        self.run_pliant("bake", scene, "-o", "file.npy")
        self.pipe(text, "bake", "-", "-o", "pipe.npy")
        self.assertEqual(self.read("file.npy"), self.read("pipe.npy"))
        self.assertEqual(self.pipe(text, "curves", "-", "--channel", "poke.magnitude").stdout,
                         self.run_pliant("curves", scene, "--channel", "poke.magnitude").stdout)
        self.assertIn("valid: 1 surface", self.pipe(text, "validate", "-").stdout)
        self.assertIn("poke (point)", self.pipe(text, "info", "-").stdout)
        for command in (["info", "-"], ["suggest", "-", "--peak", "1"]):
            self.assertTrue(self.pipe(text, *command).stdout.startswith("standard input"), command)

    def test_meshes_are_relative_to_the_current_folder(self):
        self.write("m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 0\n"
                   + "".join(f"vt {i / 2} {j / 2}\n" for j in range(3) for i in range(3))
                   + "".join("f " + " ".join(f"{n}/{n}" for n in (a, a + 1, a + 4, a + 3)) + "\n"
                             for a in (1, 2, 4, 5)))
        text = SCENE.format(end=3).replace(GRID, '<mesh file="m.obj"/>')
        self.pipe(text, "bake", "-", "-o", "a.npy")
        self.assertIn("a.npy", self.files())

    def test_messages_name_it(self):
        bad = SCENE.format(end=12).replace("magnitude", "magnitud")
        self.assertRegex(self.pipe(bad, "bake", "-", "-o", "a.npy", code=2).stderr,
                         r"^standard input:4: error: ")
        self.assertRegex(self.pipe("", "validate", "-", code=2).stderr, r"^standard input[^\n]*: error: ")

    def test_it_is_bounded(self):
        with subprocess.Popen([PLIANT, "validate", "-"], stdin=open("/dev/zero", "rb"),
                              stderr=subprocess.PIPE, text=True) as process:
            _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 2)
        self.assertIn("larger than 256 MiB", errors)

    def test_where_a_scene_is_read_again_it_is_refused(self):
        for arguments in (["replay", "record", "-", "-o", "a.replay"], ["replay", "verify", "a.replay", "-"]):
            self.assertRegex(self.pipe(SCENE.format(end=2), *arguments, code=2).stderr,
                             r"^pliant: error: SCENE -: the standard input is not allowed here: [^\n]+\n$")

    def test_a_terminal_is_not_waited_for(self):
        leader, follower = os.openpty()
        result = subprocess.run([PLIANT, "validate", "-"], stdin=follower, capture_output=True, text=True,
                                timeout=60, check=False)
        os.close(leader)
        os.close(follower)
        self.assertEqual(result.returncode, 2)
        self.assertIn("the standard input is a terminal", result.stderr)

    def test_ctrl_c_ends_the_wait(self):
        with subprocess.Popen([PLIANT, "bake", "-", "-o", self.path("a.npy")], stdin=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            time.sleep(1)
            process.send_signal(signal.SIGINT)
            process.wait(timeout=60)
            errors = process.stderr.read()
        self.assertEqual(process.returncode, 1, errors)
        self.assertIn("interrupted before the first frame", errors)


if __name__ == "__main__":
    main()
