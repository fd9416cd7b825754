"""The input files of a scene: which are read, and that no command overwrites one."""

import json
import os
import selectors
import shutil
import struct
import subprocess

from command import Command, GRID, PLIANT, SCENE, main

# A build without the viewer's page fails with 1, before it looks for the scene (2).
HAS_PAGE = subprocess.run([PLIANT, "view", "no-such-scene.xml"], capture_output=True, check=False,
                          timeout=60).returncode == 2


# A possible name for the buffer file of a buffers.gltf.
BUFFERS = "buffers.0123456789abcdef.bin"


class Inputs(Command):
    def setUp(self):
        """Makes head.gltf with its numbers in BUFFERS, and mesh.xml, which uses them."""
        super().setUp()
        self.run_pliant("bake", self.scene(end=1), "-o", "head.gltf")
        with open(self.path("head.gltf"), encoding="utf-8") as file:
            self.gltf = json.load(file)
        os.rename(self.path(self.gltf["buffers"][0]["uri"]), self.path(BUFFERS))
        self.refer_to(BUFFERS)
        os.remove(self.path("scene.xml"))
        self.write("mesh.xml", SCENE.format(end=3).replace(GRID, '<mesh file="head.gltf"/>'))

    def refer_to(self, uri, name="head.gltf"):
        self.gltf["buffers"][0]["uri"] = uri
        self.write(name, json.dumps(self.gltf))

    def refused(self, *arguments, says):
        """Checks that the run fails as wrong usage, for that reason, and changes no file."""
        before = {name: self.read(name) for name in self.files()
                  if os.path.isfile(self.path(name))}
        result = self.run_pliant(*arguments, code=2)
        self.assertRegex(result.stderr, says)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertEqual({name: self.read(name) for name in before}, before)

    def test_no_output_takes_the_place_of_what_a_mesh_refers_to(self):
        made_from = r"would overwrite \S*buffers\.\w+\.bin, an input of the scene"
        refers = "it is a file that a mesh of the scene refers to; choose another name"
        self.refused("bake", "mesh.xml", "-o", "buffers.gltf", says=made_from)
        self.refused("bake", "mesh.xml", "-o", "a.npy", "--regions", BUFFERS,
                     says=f"--regions {BUFFERS}: it is a file that a mesh of the scene refers to")
        self.refused("replay", "record", "mesh.xml", "-o", BUFFERS,
                     says="would overwrite a file that a mesh of the scene refers to")
        if HAS_PAGE:
            for option, name in (("-o", "link.html"), ("--png", "link.png")):
                os.link(self.path(BUFFERS), self.path(name))
                self.refused("view", "mesh.xml", option, name, says=refers)
        for ending in ("npy", "pc2", "mdd", "glb", "usda", "csv", "svg"):
            os.rename(self.path(BUFFERS), self.path("n." + ending))
            self.refer_to("n." + ending)
            if ending in ("csv", "svg"):
                self.refused("curves", "mesh.xml", "-o", "n." + ending,
                             says=f"-o n.{ending}: {refers}")
            else:
                self.refused("bake", "mesh.xml", "-o", "n." + ending,
                             says=rf"would overwrite \S*n\.{ending}, an input of the scene")
            os.rename(self.path("n." + ending), self.path(BUFFERS))
        os.rename(self.path(BUFFERS), self.path("s.0002.obj"))
        self.refer_to("s.0002.obj")
        self.refused("bake", "mesh.xml", "-o", "s.obj", says=r"would overwrite \S*s\.0002\.obj")

    def test_an_input_is_known_under_the_name_that_a_link_hides(self):
        os.rename(self.path(BUFFERS), self.path("real.0123456789abcdef.bin"))
        os.symlink("real.0123456789abcdef.bin", self.path(BUFFERS))
        self.refused("bake", "mesh.xml", "-o", "real.gltf", says=r"would overwrite \S*real\.\w+\.bin")
        os.rename(self.path("head.gltf"), self.path("a.gltf"))
        os.symlink("a.gltf", self.path("head.gltf"))
        self.refused("bake", "mesh.xml", "-o", "a.gltf", says=r"would overwrite \S*head\.gltf")

    def test_curves_overwrite_neither_the_scene_nor_the_frames(self):
        os.rename(self.path("mesh.xml"), self.path("mesh.csv"))
        self.refused("curves", "mesh.csv", "-o", "mesh.csv", says="it is the scene")
        self.write("frames.csv", "1\n2\n")
        self.refused("curves", "mesh.csv", "--at", "frames.csv", "-o", "frames.csv",
                     says="it is the file of --at")

    def test_what_a_mesh_refers_to_lies_in_the_scenes_folder(self):
        self.run_pliant("validate", "mesh.xml")
        outside = r"head\.gltf: error: the file refers to \"%s\", which is outside \S*"
        os.mkdir(self.path("shot"))
        shutil.copy(self.path("mesh.xml"), self.path("shot/mesh.xml"))
        shutil.copy(self.path("head.gltf"), self.path("shot/head.gltf"))
        self.assertIn("No such file", self.run_pliant("validate", "shot/mesh.xml", code=2).stderr)
        self.refer_to(f"../{BUFFERS}", "shot/head.gltf")
        commands = [["validate"], ["info"], ["bake", "-o", "a.npy"],
                    ["replay", "record", "-o", "a.replay"]]
        if HAS_PAGE:
            commands.append(["view", "-o", "a.html"])
        for command in commands:
            self.refused(*command, "shot/mesh.xml", says=outside % r"\.\./buffers\.\w+\.bin")
            self.run_pliant(*command, "shot/mesh.xml", "--root", ".")
        self.run_pliant("replay", "verify", "a.replay", "--root", ".")
        self.assertIn("is outside", self.run_pliant("replay", "verify", "a.replay", code=2).stderr)
        self.run_pliant("curves", "shot/mesh.xml", "--root", ".")
        os.symlink(f"../{BUFFERS}", self.path("shot/near.bin"))
        self.refer_to("near.bin", "shot/head.gltf")
        self.refused("validate", "shot/mesh.xml", says=outside % r"near\.bin")
        self.run_pliant("validate", "shot/mesh.xml", "--root", self.folder)
        for uri, says in (("/etc/passwd", "which is an absolute path"),
                          ("file:///etc/passwd", 'the scheme "file"'),
                          ("http://localhost/a.bin", 'the scheme "http"'),
                          ("%2Fetc%2Fpasswd", "which is an absolute path"),
                          ("../../../../../../etc/passwd", "which is outside")):
            self.refer_to(uri)
            self.refused("bake", "mesh.xml", "-o", "a.npy", says=says)

    def test_a_mesh_itself_may_lie_anywhere(self):
        os.mkdir(self.path("shot"))
        text = self.read("mesh.xml").decode("utf-8")
        self.write("shot/mesh.xml", text.replace("head.gltf", "../head.gltf"))
        self.refused("validate", "shot/mesh.xml", says="which is outside")
        self.run_pliant("validate", "shot/mesh.xml", "--root", ".")
        self.run_pliant("bake", "mesh.xml", "-o", "a.obj", "--frames", "1")
        self.write("shot/obj.xml", text.replace("head.gltf", "../a.0001.obj"))
        self.run_pliant("validate", "shot/obj.xml")

    def test_a_root_is_a_folder(self):
        commands = [["validate"], ["info"], ["bake", "-o", "a.npy"], ["curves"],
                    ["replay", "record", "-o", "a.replay"]]
        if HAS_PAGE:
            commands.append(["view"])
        for command in commands:
            for root in ("none", "mesh.xml"):
                self.refused(*command, "mesh.xml", "--root", root, says=f"--root {root}: is not a folder")

    def test_a_replay_knows_what_a_mesh_refers_to(self):
        self.run_pliant("replay", "record", "mesh.xml", "-o", "run.replay")
        head = json.loads(self.read("run.replay").splitlines()[0])
        self.assertEqual([file["name"] for file in head["files"]], ["head.gltf", BUFFERS])
        with open(self.path(BUFFERS), "ab") as file:
            file.write(b"more")  # behind what is read
        told = self.run_pliant("replay", "verify", "run.replay")
        self.assertEqual(told.stderr, f"run.replay: note: the file {BUFFERS} was changed\n")
        with open(self.path(BUFFERS), "wb") as file:
            file.write(b"cut")
        told = self.run_pliant("replay", "verify", "run.replay", code=2)
        self.assertRegex(told.stderr, r"buffers\[0\] is truncated: it has 3 of \d+ bytes")
        self.assertIn(f"the file {BUFFERS} was changed", told.stderr)

    def test_a_save_of_what_a_mesh_refers_to_is_seen(self):
        if not HAS_PAGE:
            self.skipTest("this build has no page")
        server = subprocess.Popen([PLIANT, "view", "mesh.xml", "--serve"], cwd=self.folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.addCleanup(server.stdout.close)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        told = b""
        with selectors.DefaultSelector() as ready:
            ready.register(server.stdout, selectors.EVENT_READ)
            for bakes in (1, 2):
                while told.count(b" frames, ") < bakes:
                    self.assertTrue(ready.select(timeout=60), told)
                    told += os.read(server.stdout.fileno(), 4096)
                with open(self.path(BUFFERS), "ab") as file:
                    file.write(b"more")

    def write_mapped(self, file):
        """mapped.xml, with a map of b from a file."""
        surface = GRID + f'<material><map channel="b" file="{file}" low="1" high="2"/></material>'
        self.write("mapped.xml", SCENE.format(end=3).replace(GRID, surface))

    def write_numbers(self, name, number=0.5):
        head = "{'descr': '<f8', 'fortran_order': False, 'shape': (11, 13), }\n".encode()
        with open(self.path(name), "wb") as file:
            file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head +
                       struct.pack("<143d", *[number] * 143))

    def test_a_map_is_an_input(self):
        self.write_numbers("soft.npy")
        self.write_mapped("soft.npy")
        self.run_pliant("bake", "mapped.xml", "-o", "a.npy")
        self.refused("bake", "mapped.xml", "-o", "soft.npy", says=r"would overwrite \S*soft\.npy")
        self.refused("bake", "mapped.xml", "-o", "a.npy", "--regions", "soft.npy",
                     says="--regions soft.npy: it is a map of the scene")
        self.run_pliant("replay", "record", "mapped.xml", "-o", "run.replay")
        head = json.loads(self.read("run.replay").splitlines()[0])
        self.assertEqual([file["name"] for file in head["files"]], ["soft.npy"])
        self.run_pliant("replay", "verify", "run.replay")
        self.write_numbers("soft.npy", 0.25)
        told = self.run_pliant("replay", "verify", "run.replay", code=1)
        self.assertIn("soft.npy was changed", told.stderr + told.stdout)

    def test_a_map_that_is_not_there_or_is_bad_is_told_once(self):
        self.write_mapped("none.png")
        for command in (["validate"], ["info"], ["bake", "-o", "a.npy"]):
            self.refused(*command, "mapped.xml",
                         says=r"mapped\.xml:3: error: sheet\.map\.b: \S*none\.png: cannot read")
        self.write_numbers("zero.npy", -1)
        self.write_mapped("zero.npy")
        self.refused("validate", "mapped.xml",
                     says=r"mapped\.xml:3: error: sheet\.b is 0 at node \(0, 0\) by its map")

    def test_a_file_that_is_something_else_is_not_quoted(self):
        secret = "root:secret:0:0:the secret:/root\n"
        for map_file in ("m.png", "m.npy"):
            self.write(map_file, secret)
            self.write_mapped(map_file)
            self.assertNotIn("secret", self.run_pliant("validate", "mapped.xml", code=2).stderr)
        for name in ("scene.xml", "a.obj", "a.ply", "a.gltf", "a.glb", "a.replay", "frames"):
            self.write(name, secret)
        text = self.read("mesh.xml").decode("utf-8")
        commands = [["validate", "scene.xml"], ["replay", "verify", "a.replay"],
                    ["curves", "mesh.xml", "--at", "frames"]]
        for mesh in ("a.obj", "a.ply", "a.gltf", "a.glb"):
            self.write(mesh + ".xml", text.replace("head.gltf", mesh))
            commands.append(["validate", mesh + ".xml"])
        self.write("page.xml", "<html><p class=secret>secret</html>")
        commands.append(["validate", "page.xml"])
        for command in commands:
            told = self.run_pliant(*command, code=2)
            self.assertNotIn("secret", told.stdout + told.stderr, command)
            self.assertEqual(len(told.stderr.splitlines()), 1, told.stderr)


if __name__ == "__main__":
    main()
