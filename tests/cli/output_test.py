"""Outputs of commands: which files may be replaced, unusual names, a closed stdout."""

import json
import os
import socket
import stat
import subprocess

from command import GRID, PLIANT, SANITIZED, SCENE, Command, main

MESH = """v 0 0 0
v 1 0 0
v 2 0 0
v 0 0 1
v 1 0 1
v 2 0 1
v 0 0 2
v 1 0 2
v 2 0 2
vt 0 0
vt 0.5 0
vt 1 0
vt 0 0.5
vt 0.5 0.5
vt 1 0.5
vt 0 1
vt 0.5 1
vt 1 1
f 1/1 2/2 5/5 4/4
f 2/2 3/3 6/6 5/5
f 4/4 5/5 8/8 7/7
f 5/5 6/6 9/9 8/8
"""
CONTROLS = bytes(range(0x20)).replace(b"\n", b"") + b"\x7f"


class Places(Command):
    def outputs(self):
        """The arguments of every command with an output, with OUT for the file."""
        scene = self.scene(end=3)
        for ending in (".npy", ".glb", ".gltf", ".usda", ".pc2", ".mdd"):
            yield ["bake", scene, "-o", "OUT"], "a" + ending
        yield ["bake", scene, "-o", "a.pc2"], "a.obj"  # beside
        yield ["bake", scene, "-o", "a.obj"], "a.0002.obj"
        yield ["bake", scene, "-o", "a.ply", "--resume"], "a.0002.ply"
        yield ["bake", scene, "-o", "b.npy", "--regions", "OUT"], "r.json"
        yield ["curves", scene, "-o", "OUT"], "a.csv"
        yield ["curves", scene, "-o", "OUT"], "a.svg"
        yield ["replay", "record", scene, "-o", "OUT"], "a.replay"
        yield ["view", scene, "-o", "OUT"], "a.html"
        yield ["view", scene, "--png", "OUT"], "a.png"

    def make(self, kind, path):
        if kind == "a pipe":
            os.mkfifo(path)
        elif kind == "a folder":
            os.mkdir(path)
        elif kind == "a socket":
            with socket.socket(socket.AF_UNIX) as one:
                one.bind(path)
        else:
            os.symlink("there" if kind == "link" else "nowhere", path)

    def test_only_a_regular_file_is_replaced(self):
        self.write("there", "old")
        for command, name in self.outputs():
            if command[0] == "view" and "no viewer" in subprocess.run(
                    [PLIANT, *[name if word == "OUT" else word for word in command]], cwd=self.folder,
                    capture_output=True, text=True, check=False, env={"PATH": ""}).stderr:
                continue
            if os.path.exists(self.path(name)):
                os.remove(self.path(name))
            for kind, words in (("a pipe", "a pipe"), ("a folder", "a folder"), ("a socket", "a socket"),
                                ("link", "a symbolic link"), ("dangling", "a symbolic link")):
                with self.subTest(name=name, command=command[0], kind=kind):
                    self.make(kind, self.path(name))
                    before = self.files()
                    arguments = [name if word == "OUT" else word for word in command]
                    errors = self.run_pliant(*arguments, code=2).stderr
                    self.assertEqual(errors.splitlines()[0].split(";")[0],
                                     f"{name}: error: cannot write the file: it is {words}")
                    self.assertEqual(self.files(), before)
                    self.assertEqual(self.read("there"), b"old")
                    (os.rmdir if kind == "a folder" else os.remove)(self.path(name))

    def test_devices_and_the_standard_output_are_no_files(self):
        scene = self.scene(end=2)
        try:
            os.mknod(self.path("device.npy"), 0o600 | stat.S_IFCHR, os.makedev(1, 3))
        except PermissionError:
            pass  # only root can make one; the system's own must not be put at risk
        else:
            self.assertIn("it is a device", self.run_pliant("bake", scene, "-o", "device.npy", code=2).stderr)
            os.remove(self.path("device.npy"))
        self.run_pliant("bake", scene, "-o", "a.npy", "--regions", "-", code=2)
        for command in (["curves"], ["replay", "record"], ["view"], ["bake"]):
            errors = self.run_pliant(*command, scene, "-o", "-", code=2).stderr
            self.assertEqual(errors.count("\n"), 1, errors)
        self.assertEqual(self.files(), ["scene.xml"])

    def test_names_as_long_as_the_system_allows(self):
        scene = self.scene(end=2)
        for command, ending, beside in (
                (["bake"], ".npy", 0), (["bake"], ".glb", 0), (["bake"], ".usda", 0), (["bake"], ".pc2", 0),
                (["bake"], ".gltf", 16), (["bake"], ".obj", 5), (["curves"], ".csv", 0),
                (["replay", "record"], ".replay", 0)):
            longest = "n" * (255 - len(ending) - beside) + ending
            self.run_pliant(*command, scene, "-o", longest)
            before = self.files()
            self.assertGreater(len(before), 1)
            errors = self.run_pliant(*command, scene, "-o", "n" + longest, code=2).stderr
            self.assertIn("its name has 256 bytes; the folder allows 255", errors)
            self.assertEqual(errors.count("\n"), 1)
            self.assertEqual(self.files(), before)
            for name in before:
                if name.startswith("n"):
                    os.remove(self.path(name))


class Names(Command):
    def test_a_name_reaches_no_terminal_from_any_command(self):
        folder = os.fsencode(self.folder)
        everything = ""
        for wild in (b"\x1b]0;title\x07", b"\nfake.xml: error: no", b"\xff\xfe", b"\xc2\x9b31m",
                     "\u202egnp".encode(), CONTROLS.replace(b"\0", b""))[::3 if SANITIZED else 1]:
            base = b"n" + wild.replace(b"/", b"")
            scene, mesh, out = (base + ending for ending in (b".xml", b".obj", b".npy"))
            with open(os.path.join(folder, mesh), "wb") as file:
                file.write(MESH.encode())
            text = SCENE.format(end=3).replace(GRID, '<mesh file="MESH"/>').replace("4.5", "0.1")
            is_xml = all(byte >= 0x20 for byte in wild) and b"\xff" not in wild  # what XML can name
            data = text.encode().replace(b"MESH", mesh if is_xml else b"plain.obj")
            self.write("plain.obj", MESH)
            # A scene with a warning, one with a note, one with errors.
            note = data.replace(b' magnitude="3000"/>', (
                b'><animate attribute="magnitude"><key frame="1" value="0" out="1" outLength="-2"/>'
                b'<key frame="3" value="5"/></animate></point>'))
            bad = data.replace(b"magnitude=", b"magnitud=")
            for content, name in ((data, scene), (note, b"note" + scene), (bad, b"bad" + scene)):
                with open(os.path.join(folder, name), "wb") as file:
                    file.write(content)
                for command in ([b"validate", name], [b"info", name], [b"bake", name, b"-o", out],
                                [b"bake", name, b"-o", b"a" + out, b"--resume"],
                                [b"bake", name, b"-o", base + b".obj", b"--resume"],
                                [b"bake", name, b"-o", out, b"--cache", base + b"cache"],
                                [b"bake", name, b"-o", out, b"--regions", base + b".json"],
                                [b"bake", name, b"-o", out, b"--surface", wild],
                                [b"bake", name, b"-o", out, b"--frames", wild],
                                [b"bake", name, b"-o", base + b"none/" + out], [b"bake", name, b"-o", base],
                                [b"curves", name, b"-o", base + b".csv"], [b"curves", name, b"--channel", wild],
                                [b"curves", name, b"--at", base + b".none"], [b"curves", name, b"--frames", wild],
                                [b"replay", b"record", name, b"-o", base + b".replay"],
                                [b"replay", b"verify", base + b".replay"],
                                [b"replay", b"verify", base + b".replay", b"bad" + scene],
                                [b"replay", b"diff", base + b".replay", base + b".none"],
                                [b"view", name, b"-o", base + b".html"], [b"view", name, b"-o", out],
                                [b"none" + base], [b"bake", base, wild, wild],
                                [b"validate", base + b"missing.xml"]):
                    result = subprocess.run([os.fsencode(PLIANT), *(word.replace(b"\0", b"") for word in command)],
                                            cwd=folder, capture_output=True, check=False, timeout=120,
                                            stdin=subprocess.DEVNULL)
                    told = result.stdout + result.stderr
                    self.assertIn(result.returncode, (0, 1, 2), (command, told))
                    text = told.decode("utf-8")  # nothing else
                    everything += text
                    for line in text.split("\n"):
                        self.assertFalse(line.startswith("fake"), (command, text))
                        self.assertTrue(all(ord(c) >= 0x20 and not 0x7f <= ord(c) < 0xa0 and c != "\u202e"
                                            for c in line), (command, line))
        if SANITIZED:  # a sanitizer needs fewer names
            return
        for words in (r"\\x1b\]0;title\\x07\S*: warning: ", r"\\x1b\]0;title\\x07\S*: note: ",
                      r"\\x1b\]0;title\\x07\S*: error: ", r"n\\x0afake\.xml: error: no\.xml: valid",
                      r"mesh \S*\\x0afake\.xml|mesh \S*n\\xc2\\x9b31m\.obj", r"\\xff\\xfe\.xml\nframes 1 to 3"):
            self.assertRegex(everything, words)  # each kind of message occurred


class Placements(Command):
    def test_a_placement_beyond_the_format_is_an_error(self):
        for place, single in (('translate="1e300 0 0"', "translate of 1e+300"), ('scale="1 1 1e39"', "scale of 1e+39"),
                              ('translate="0 -3.5e38 0"', "translate of -3.5e+38")):
            scene = self.write("p.xml", SCENE.format(end=3).replace(
                "</surface>", f"<transform {place}/></surface>").replace("<point", '<point enabled="false"'))
            for ending in (".gltf", ".glb"):
                errors = self.run_pliant("bake", scene, "-o", "a" + ending, "--space", "object", code=1).stderr
                self.assertIn(f'surface "sheet" at frame 1 has a {single}, which is too large for the single precision',
                              errors)
                self.assertEqual(self.files(), ["p.xml"])
            self.run_pliant("bake", scene, "-o", "a.usda", "--space", "object")
            os.remove(self.path("a.usda"))
        scene = self.write("p.xml", SCENE.format(end=2).replace(
            "</surface>", '<transform translate="3e38 1 2" rotate="0 1e300 0"/></surface>').replace(
            "<point", '<point enabled="false"'))
        self.run_pliant("bake", scene, "-o", "a.gltf", "--space", "object")
        text = self.read("a.gltf").decode()
        self.assertNotIn("null", text)
        self.assertEqual(json.loads(text)["nodes"][0]["translation"][1:], [1, 2])


class Stdout(Command):
    def commands(self):
        scene = self.write("s.xml", SCENE.format(end=3).replace(' magnitude="3000"/>', (
            '><animate attribute="magnitude"><key frame="1" value="0"/><key frame="3" value="1"/>'
            '</animate></point>')))
        self.run_pliant("replay", "record", scene, "-o", "a.replay")
        yield from (["--help"], ["--version"], ["bake", "--help"], ["info", scene], ["validate", scene],
                    ["curves", scene], ["bake", scene, "-o", "a.npy"], ["replay", "record", scene, "-o", "b.replay"],
                    ["replay", "verify", "a.replay"], ["replay", "diff", "a.replay", "a.replay"],
                    ["view", scene, "-o", "a.html"], ["view", scene, "--serve"])

    def run_with(self, redirection, arguments):
        return subprocess.run(["sh", "-c", f'exec "$0" "$@" {redirection}', PLIANT, *arguments], timeout=120,
                              cwd=self.folder, capture_output=True, text=True, check=False)

    def test_what_cannot_be_said_is_exit_code_1_in_every_command(self):
        for arguments in self.commands():
            for redirection in (">/dev/full", ">&-"):
                with self.subTest(arguments=arguments, redirection=redirection):
                    result = self.run_with(redirection, arguments)
                    if "no viewer" in result.stderr:
                        continue
                    self.assertEqual(result.returncode, 1, result.stderr)
                    self.assertEqual(result.stderr, "pliant: error: cannot write to the standard output\n")
        self.assertIn("a.npy", self.files())  # the work is done all the same

    def test_a_reader_that_is_gone_is_exit_code_1(self):
        for arguments in self.commands():
            with self.subTest(arguments=arguments):
                end, start = os.pipe()
                os.close(end)
                result = subprocess.run([PLIANT, *arguments], cwd=self.folder, stdout=start, timeout=120,
                                        stderr=subprocess.PIPE, text=True, check=False)
                os.close(start)
                if "no viewer" in result.stderr:
                    continue
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertEqual(result.stderr, "pliant: error: cannot write to the standard output\n")

    def test_silence_needs_no_stdout(self):
        scene = self.scene(end=3)
        for arguments in (["bake", scene, "-o", "a.npy", "--quiet"], ["validate", scene, "--quiet"],
                          ["curves", scene, "-o", "a.csv"]):
            for redirection in (">/dev/full", ">&-"):
                self.assertEqual(self.run_with(redirection, arguments).returncode, 0)

    def test_streams_that_are_closed_do_not_end_up_in_a_file(self):
        scene = self.write("w.xml", SCENE.format(end=5).replace('"4.5"', '"0.5"'))  # with a warning
        self.run_pliant("bake", scene, "-o", "whole.npy", "--quiet")
        for closed in (">&-", "2>&-", "<&-", "<&- >&- 2>&-", ">&- 2>&-"):
            for name in ("a.npy", "a.obj", "a.glb"):
                self.run_with(closed, ["bake", scene, "-o", name, "--profile"])
            self.assertEqual(self.read("a.npy"), self.read("whole.npy"), closed)
            self.assertFalse(b"warning" in self.read("a.glb") or b"stage" in self.read("a.0001.obj"))

    def test_a_scene_that_is_wrong_stays_exit_code_2(self):
        result = self.run_with(">/dev/full", ["validate", self.scene(), "none.xml"])
        self.assertEqual(result.returncode, 2)


if __name__ == "__main__":
    main()
