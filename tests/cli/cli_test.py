"""Runs the command as a user does and checks exit codes, messages and files.

usage: cli_test.py PLIANT SOURCE_FOLDER [sanitized]
"""

import json
import os
import pty
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

import numpy as np

PLIANT = None
SOURCE = None
SANITIZED = False  # built with a sanitizer, which takes memory of its own

SCENE = """<?xml version="1.0"?>
<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="13" rows="11" width="12" depth="10"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"/>
</scene>
"""


class Command(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="pliant-cli-")
        self.addCleanup(self.scratch.cleanup)
        self.folder = self.scratch.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def scene(self, end=12):
        return self.write("scene.xml", SCENE.format(end=end))

    def run_pliant(self, *arguments, code=0):
        result = subprocess.run([PLIANT, *arguments], capture_output=True, text=True, timeout=120,
                                stdin=subprocess.DEVNULL, cwd=self.folder, check=False)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def files(self):
        return sorted(os.listdir(self.folder))

    def holds_hidden_files(self, process):
        """Whether it has a file of the folder open that has no name there any more."""
        folder = f"/proc/{process.pid}/fd"
        try:
            targets = [os.readlink(os.path.join(folder, name)) for name in os.listdir(folder)]
        except OSError:  # one of them is just being closed
            return False
        return any(target.startswith(self.folder) and "(deleted)" in target for target in targets)

    def interrupt(self, scene, out, number):
        """Sends a signal once the bake has begun to write; gives its exit code and stderr."""
        before = self.files()
        with subprocess.Popen([PLIANT, "bake", scene, "-o", self.path(out)],
                              stderr=subprocess.PIPE, text=True) as process:
            deadline = time.monotonic() + 60
            while (self.files() == before and not self.holds_hidden_files(process)
                   and time.monotonic() < deadline):
                time.sleep(0.01)
            process.send_signal(number)
            _, errors = process.communicate(timeout=60)
        return process.returncode, errors


class Usage(Command):
    def test_version_and_help_go_to_stdout(self):
        self.assertRegex(self.run_pliant("--version").stdout, r"^pliant \d+\.\d+\.\d+\n$")
        for arguments in (["--help"], ["bake", "--help"]):
            result = self.run_pliant(*arguments)
            self.assertIn("SCENE" if "bake" in arguments else "bake", result.stdout)
            self.assertEqual(result.stderr, "")

    def test_wrong_usage_is_exit_code_2(self):
        scene = self.scene()
        for arguments in ([], ["bak"], ["bake"], ["bake", scene], ["bake", scene, "-o"],
                          ["bake", scene, "-o", "a.npy", "--nonsense"],
                          ["bake", scene, "-o", "a.npy", "--space", "camera"],
                          ["bake", scene, "-o", "a.npy", "extra"]):
            result = self.run_pliant(*arguments, code=2)
            self.assertRegex(result.stderr, r"^pliant: error: [^\n]+\n$", arguments)
            self.assertEqual(result.stdout, "", arguments)
        for arguments, words in ((["--frames", "0:3"], "the scene has the frames 1 to 12"),
                                 (["--frames", "5:3"], "A:B with A <= B"),
                                 (["--frames", "x"], "A:B with A <= B"),
                                 (["--surface", "none"], "the scene has the surfaces sheet")):
            result = self.run_pliant("bake", scene, "-o", "a.npy", *arguments, code=2)
            self.assertIn(words, result.stderr)
        result = self.run_pliant("bake", scene, "-o", "a.xyz", code=2)
        self.assertIn('no format has the ending ".xyz"', result.stderr)
        self.assertEqual(self.files(), ["scene.xml"])


class Bake(Command):
    def bake(self, *arguments):
        self.run_pliant("bake", *arguments)

    def test_npy_holds_every_frame_and_obj_agrees(self):
        scene = self.scene()
        self.bake(scene, "-o", self.path("a.npy"))
        frames = np.load(self.path("a.npy"))
        self.assertEqual((frames.shape, frames.dtype), ((12, 143, 3), np.float64))
        self.assertTrue((frames[0] == frames[0] * [1, 0, 1]).all())  # at rest, flat
        self.assertGreater(np.abs(frames[5, :, 1]).max(), 0.01)

        self.bake(scene, "-o", self.path("a.obj"))
        for number in range(1, 13):
            with open(self.path(f"a.{number:04}.obj"), encoding="utf-8") as file:
                lines = file.read().splitlines()
            vertices = [list(map(float, line.split()[1:])) for line in lines if line[:2] == "v "]
            self.assertTrue((np.array(vertices) == frames[number - 1]).all())
            faces = [line for line in lines if line[:2] == "f "]
            self.assertEqual(len(faces), 120)
            self.assertTrue(all(len(face.split()) == 5 for face in faces))  # quads
        self.assertEqual(len(self.files()), 14)

    def test_frames_are_a_slice_of_the_whole_run(self):
        scene = self.scene()
        self.bake(scene, "-o", self.path("all.npy"))
        self.bake(scene, "-o", self.path("some.npy"), "--frames", "5:8")
        self.assertTrue((np.load(self.path("some.npy")) == np.load(self.path("all.npy"))[4:8]).all())
        self.bake(scene, "-o", self.path("one.##.obj"), "--frames", "5")
        self.assertIn("one.05.obj", self.files())

    def test_several_surfaces_go_to_files_of_their_own(self):
        scene = self.write("two.xml", SCENE.format(end=3).replace(
            "<point", '<surface name="other"><grid columns="3" rows="3"/>'
            '<transform translate="0 7 0"/></surface><point'))
        self.bake(scene, "-o", self.path("a.npy"))
        self.bake(scene, "-o", self.path("one.npy"), "--surface", "other")
        self.bake(scene, "-o", self.path("object.npy"), "--surface", "other", "--space", "object")
        self.assertEqual(self.files(), ["a-other.npy", "a-sheet.npy", "object.npy", "one.npy", "two.xml"])
        world = np.load(self.path("one.npy"))
        self.assertTrue((world == np.load(self.path("a-other.npy"))).all())
        self.assertTrue((world - np.load(self.path("object.npy")) == [0, 7, 0]).all())

    def test_the_same_bits_twice(self):
        scene = self.scene()
        for name in ("a.npy", "b.npy"):
            self.bake(scene, "-o", self.path(name), "--quiet")
        with open(self.path("a.npy"), "rb") as a, open(self.path("b.npy"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_summary_and_quiet(self):
        scene = self.scene()
        result = self.run_pliant("bake", scene, "-o", "a.npy")
        self.assertRegex(result.stdout, r"^a\.npy: 12 frames, 143 vertices, \d+\.\d+ s, "
                                        r"peak displacement \d\.\d+\n$")
        self.assertEqual(result.stderr, "")  # no progress: stderr is no terminal
        result = self.run_pliant("bake", scene, "-o", "a.npy", "--quiet")
        self.assertEqual(result.stdout + result.stderr, "")

    def test_profile_tells_where_the_time_went(self):
        scene = self.scene()
        for flags in ([], ["--quiet"], ["--threads", "2"]):
            result = self.run_pliant("bake", scene, "-o", "a.npy", "--profile", *flags)
            self.assertEqual(result.stdout == "", "--quiet" in flags)
            lines = result.stderr.splitlines()
            self.assertRegex(lines[0], r"^stage +seconds +share, %$")
            rows = {line[:12].strip(): [float(number) for number in line[12:].split()]
                    for line in lines[1:]}
            self.assertEqual(list(rows), ["sampling", "selection", "load", "state in", "set-up",
                                          "solve", "state out", "checkpoints", "output", "writing",
                                          "the rest", "run"])
            seconds, share = (sum(row[k] for row in list(rows.values())[:-1]) for k in (0, 1))
            self.assertAlmostEqual(seconds, rows["run"][0], delta=0.0006 * len(rows))
            self.assertAlmostEqual(share, 100, delta=0.06 * len(rows))
            self.assertEqual(rows["run"][1], 100)

    def test_progress_on_a_terminal(self):
        scene = self.scene()
        try:
            main, terminal = pty.openpty()
        except OSError as error:  # a container without /dev/pts
            self.skipTest(f"no pseudo-terminal: {error}")
        subprocess.run([PLIANT, "bake", scene, "-o", self.path("a.npy")], stderr=terminal,
                       stdout=subprocess.DEVNULL, check=True, timeout=120)
        os.close(terminal)
        shown = os.read(main, 100000).decode()
        os.close(main)
        self.assertRegex(shown, r"12/12 frames, [\d.]+ frames/s, 0:00 left")
        self.assertTrue(shown.endswith("\r\x1b[K"))  # wiped

    def test_warnings_name_the_force_and_its_frames(self):
        scene = self.write("w.xml", SCENE.format(end=5).replace('"4.5"', '"0.5"'))
        result = self.run_pliant("bake", scene, "-o", "a.npy")
        self.assertRegex(result.stderr, r'^\S*w\.xml:4: warning: force "poke" selects fewer than 3 x 3 '
                                        r'nodes of "sheet", too few to solve, at frames 1-4\n$')


    def test_threads_change_no_bit(self):
        scene = self.write("two.xml", SCENE.format(end=6).replace(
            "<point", '<surface name="other"><grid columns="17" rows="9" width="8" depth="8"/>'
            '</surface><point'))
        for threads in ("1", "2", "8"):
            self.bake(scene, "-o", self.path(f"t{threads}.npy"), "--threads", threads)
        for name in ("sheet", "other"):
            files = []
            for threads in ("1", "2", "8"):
                with open(self.path(f"t{threads}-{name}.npy"), "rb") as file:
                    files.append(file.read())
            self.assertEqual(files[0], files[1])
            self.assertEqual(files[0], files[2])

    def test_solvers_agree_but_for_the_last_digits(self):
        scene = self.write("s.xml", SCENE.format(end=12).replace('"13"', '"41"').replace(
            '"11"', '"33"'))
        frames = {}
        for solver in ("auto", "spectral", "cholmod"):
            out = self.path(f"{solver}.npy")
            result = subprocess.run([PLIANT, "bake", scene, "-o", out, "--solver", solver],
                                    capture_output=True, text=True, timeout=120, check=False)
            if solver == "cholmod" and result.returncode == 2:  # a build without it says so
                self.assertRegex(result.stderr, r"^pliant: error: --solver cholmod: this build has "
                                                r"none; [^\n]+\n$")
                continue
            self.assertEqual(result.returncode, 0, result.stderr)
            frames[solver] = np.load(out)
        for other in frames.values():
            self.assertLess(np.abs(other - frames["spectral"]).max(), 1e-10)
        self.assertTrue((frames["auto"] == frames["spectral"]).all())
        self.run_pliant("bake", scene, "-o", "a.npy", "--solver", "fftw", code=2)

    def test_memory_is_refused_ahead(self):
        scene = self.write("large.xml", SCENE.format(end=3).replace('"13"', '"9000"').replace(
            '"11"', '"9000"'))
        result = self.run_pliant("bake", scene, "-o", "a.npy", "--max-memory", "2", code=1)
        self.assertRegex(result.stderr, r'^\S*large\.xml:3: error: surface "sheet" takes \S+ GB, more '
                                        r'than the 2 GB left of the 2 GB allowed\n$')
        for wrong in ("0", "-1", "nan", "all", "1,5"):
            self.run_pliant("bake", scene, "-o", "a.npy", "--max-memory", wrong, code=2)
        self.assertEqual(self.files(), ["large.xml"])

    def test_the_memory_told_ahead_is_the_memory_taken(self):
        # One bake with a region as large as the surface; info's sum bounds it, but not by far.
        scene = self.write("all.xml", SCENE.format(end=2).replace('"13"', '"301"').replace(
            '"11"', '"301"').replace('"4.5"', '"100"'))
        told = self.run_pliant("info", scene).stdout
        surfaces, solver = re.search(r"memory\n  (\S+) MB for the surfaces, (\S+) MB for the solver",
                                     told).groups()
        told = (float(surfaces) + float(solver)) * 1e6
        for out in ("a.npy", "a.obj"):
            code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True);"
                    "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
            taken = 1000 * int(subprocess.run(
                [sys.executable, "-c", code, PLIANT, "bake", scene, "-o", self.path(out), "--quiet"],
                capture_output=True, text=True, check=True, timeout=120).stdout)
            if not SANITIZED:  # their shadow memory counts too
                self.assertLess(taken - 20e6, told)  # what any program takes
                self.assertGreater(taken, 0.5 * told)


class Regions(Command):
    SCENE = """<?xml version="1.0"?>
<scene version="1" fps="25" start="3" end="9">
  <surface name="sheet"><grid columns="25" rows="13" width="24" depth="12"/>
    <solver combine="islands" measure="rest"/></surface>
  <surface name="late"><grid columns="13" rows="13" width="12" depth="12"/><solver startFrame="6"/></surface>
  <surface name="off" enabled="false"><grid columns="13" rows="13"/></surface>
  <point name="a" center="-6 0 0" direction="0 3 4" deformationRadius="4.5" forceRadius="2.5" magnitude="300"/>
  <radial name="b" center="7 0 1" deformationRadius="2.5" forceRadius="99" magnitude="-70" targets="sheet"/>
  <line name="c" from="0 0 -5" to="1 0 -5" deformationRadius="0.5" magnitude="5" targets="sheet">
    <animate attribute="enabled"><key frame="3" value="true"/><key frame="5" value="false"/></animate></line>
</scene>
"""

    def told(self, *arguments, scene=SCENE):
        self.run_pliant("bake", self.write("r.xml", scene), "-o", "o.npy", "--regions", "r.json", *arguments)
        with open(self.path("r.json"), encoding="utf-8") as file:
            return json.load(file)

    @staticmethod
    def box(selected):
        """A box by another way: from the nodes selected, rows x columns."""
        if not selected.any():
            return None
        rows, columns = np.nonzero(selected)
        return {"columns": [columns.min(), columns.max()], "rows": [rows.min(), rows.max()]}

    def test_it_is_the_selection_of_each_frame(self):
        told = self.told()
        self.assertEqual((told["version"], told["fps"]), (1, 25))
        self.assertEqual([frame["frame"] for frame in told["frames"]], list(range(3, 10)))
        frames = np.load(self.path("o-sheet.npy"))
        x, z = frames[0][:, 0].reshape(13, 25), frames[0][:, 2].reshape(13, 25)  # measured at rest
        to_a, to_b = np.hypot(x + 6, z), np.hypot(x - 7, z - 1)
        for k, frame in enumerate(told["frames"]):
            sheet, late, off = frame["surfaces"]
            self.assertEqual([sheet["name"], late["name"], off["name"]], ["sheet", "late", "off"])
            names = [force["name"] for force in sheet["forces"]]
            self.assertEqual(names, ["a", "b", "c"] if frame["frame"] < 5 else ["a", "b"])
            a, b = sheet["forces"][:2]
            self.assertEqual(a["deformationBox"], self.box(to_a < 4.5))
            self.assertEqual(a["forceBox"], self.box(to_a < 2.5))
            self.assertEqual(b["deformationBox"], self.box(to_b < 2.5))
            self.assertEqual(b["forceBox"], self.box(to_b < 99))
            # Islands by themselves; b's force box is the whole sheet, but it acts in its own.
            regions = [region for region in sheet["regions"] if region["solved"]]
            self.assertEqual([regions[0]["box"], regions[1]["box"]], [a["deformationBox"], b["deformationBox"]])
            self.assertEqual(sheet["regions"][a["region"]]["box"], a["deformationBox"])
            self.assertEqual(sheet["regions"][b["region"]]["box"], b["deformationBox"])
            self.assertEqual((sheet["steps"], sheet["unknowns"]), (4, 49 + 9))
            self.assertAlmostEqual(sheet["dt"], 0.01)
            self.assertEqual((a["center"], a["direction"], a["magnitude"]), ([-6, 0, 0], [0, 3, 4], 300))
            self.assertNotIn("direction", b)
            # a pushes 25 nodes along (0, 3, 4)/5.
            self.assertEqual(a["pushedNodes"], 25)
            np.testing.assert_allclose(a["load"], [0, 25 * 180, 25 * 240], rtol=1e-12, atol=1e-9)
            self.assertEqual(b["pushedNodes"], 8)  # of nine nodes, but not at its own centre
            if frame["frame"] < 5:
                c = sheet["forces"][2]
                self.assertFalse(sheet["regions"][c["region"]]["solved"])
                self.assertEqual((c["from"], c["pushedNodes"], c["load"]), ([0, 0, -5], 0, [0, 0, 0]))
            # What is told at a frame is what moves until the next.
            if k + 1 < len(frames):
                moves = (frames[k] != frames[k + 1]).any(axis=1)
                self.assertLessEqual(moves.sum(), sheet["unknowns"])
            self.assertEqual((off["solved"], off["forces"], off["selected"]), (False, [], None))
            self.assertEqual(bool(late["forces"]), frame["frame"] >= 6)
        self.assertGreater(told["solver"]["factorizations"], 0)

    def test_the_page_shows_what_is_written(self):
        def keys(value):
            """Keys in their order, of all that is inside; of a list, those of its first element."""
            if isinstance(value, list):
                return [keys(value[0])] if value and isinstance(value[0], dict) else []
            return {key: keys(inner) for key, inner in value.items()} if isinstance(value, dict) else None
        with open(os.path.join(SOURCE, "docs", "regions.md"), encoding="utf-8") as file:
            page = file.read()
        shown = json.loads(re.search(r"```json\n(.*?)```", page, re.DOTALL).group(1))
        self.assertEqual(json.dumps(keys(shown)), json.dumps(keys(self.told())))
        described = set(re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", page, re.MULTILINE))))
        others = """<uniform name="u" targets="sheet"/> <inertia name="i" targets="sheet"/>
          <vortex name="v" targets="sheet"/> <noise name="n" targets="sheet"/>
          <group name="g" targets="sheet"><point name="m"/></group></scene>"""
        told = self.told(scene=self.SCENE.replace("</scene>", others))
        kinds = [force["kind"] for force in told["frames"][0]["surfaces"][0]["forces"]]
        self.assertEqual(kinds[-6:], ["uniform", "inertia", "vortex", "noise", "point", "group"])
        surface = told["frames"][0]["surfaces"][0]
        force_keys = set().union(*(force.keys() for force in surface["forces"]))
        self.assertEqual(described, surface.keys() | force_keys | surface["regions"][0].keys())

    def test_it_tells_of_the_frames_that_are_written(self):
        whole, part = self.told(), self.told("--frames", "5:7")
        self.assertEqual(part["frames"], whole["frames"][2:5])

    def test_unions_list_their_parts_and_recovering_nodes_are_counted(self):
        switch = ('><animate attribute="enabled"><key frame="3" value="true"/><key frame="6" value="false"/>'
                  '</animate></radial>')
        scene = self.SCENE.replace('combine="islands"', 'combine="union" release="recover"').replace(
            'center="7 0 1"', 'center="-3 0 3"').replace(' targets="sheet"/>', switch)
        frames = self.told(scene=scene)["frames"]
        self.assertEqual(len(frames[0]["surfaces"][0]["regions"][0]["parts"]), 2)  # the line selects a row: no cell
        self.assertEqual(frames[0]["surfaces"][0]["recovering"], 0)
        self.assertGreater(frames[-1]["surfaces"][0]["recovering"], 0)

    def test_it_replaces_nothing_else(self):
        scene = self.write("r.xml", self.SCENE)
        os.mkfifo(self.path("pipe"))
        for out, regions in (("o.npy", "r.xml"), ("o.npy", "./o-sheet.npy"), ("o.obj", "o-late.0004.obj"),
                             ("o.npy", "pipe"), ("o.npy", "."), ("o.npy", "")):
            result = self.run_pliant("bake", scene, "-o", out, "--regions", regions, code=2)
            self.assertRegex(result.stderr, r"error: --regions \S*: ")
            self.assertEqual(self.files(), ["pipe", "r.xml"])

    def test_it_is_there_whole_or_not_at_all(self):
        scene = self.write("r.xml", self.SCENE)
        self.run_pliant("bake", scene, "-o", "o.npy", "--regions", "none/r.json", code=1)
        failing = self.write("f.xml", self.SCENE.replace('magnitude="300"', 'magnitude="1e150"').replace(
            "<solver combine", '<material density="0" damping="0" b="1e-300" c="0" d="1e-300"/><solver combine'))
        self.run_pliant("bake", failing, "-o", "o.npy", "--regions", "r.json", code=1)
        self.assertEqual(self.files(), ["f.xml", "r.xml"])

    def test_recovery_and_tangents_exclude_each_other(self):
        scene = self.write("t.xml", self.SCENE.replace('combine="islands"', 'release="recover"').replace(
            "\n    <solver", '\n    <tangents su0="0" sv1="0.5"/><solver'))
        for command in (["validate", scene], ["bake", scene, "-o", "o.npy"]):
            result = self.run_pliant(*command, code=2)
            self.assertRegex(result.stderr, r'^\S*t\.xml:4: error: sheet\.sv1 at frame 3 is 0\.5, but '
                                            r'release="recover" asks for tangents of 0\n$')


ONE_FILE = (".npy", ".pc2", ".mdd", ".glb", ".gltf", ".usda")


class Outputs(Command):
    def slow_scene(self):
        """Many seconds of work, in frames that glTF can hold."""
        return self.write("slow.xml", SCENE.format(end=4000).replace('"13"', '"161"').replace(
            '"11"', '"161"').replace('"4.5"', '"9"'))

    def test_every_ending_writes_its_files(self):
        scene = self.write("two.xml", SCENE.format(end=3).replace(
            "<point", '<surface name="other"><grid columns="3" rows="3"/></surface><point'))
        for out, files in ((".pc2", ["a-other.obj", "a-other.pc2", "a-sheet.obj", "a-sheet.pc2"]),
                           (".mdd", ["a-other.mdd", "a-other.obj", "a-sheet.mdd", "a-sheet.obj"]),
                           (".glb", ["a.glb"]), (".gltf", ["a.bin", "a.gltf"]), (".usda", ["a.usda"])):
            self.run_pliant("bake", scene, "-o", "a" + out)
            self.assertEqual(self.files(), files + ["two.xml"])
            for name in files:
                os.remove(self.path(name))

    def test_the_same_bytes_twice(self):
        scene = self.scene()
        for ending in ONE_FILE:
            contents = []
            for _ in range(2):
                self.run_pliant("bake", scene, "-o", "a" + ending)
                with open(self.path("a" + ending), "rb") as file:
                    contents.append(file.read())
            self.assertEqual(contents[0], contents[1], ending)

    def test_a_file_of_the_scene_is_not_overwritten(self):
        self.run_pliant("bake", self.scene(end=1), "-o", "head.obj")
        os.rename(self.path("head.0001.obj"), self.path("head.obj"))
        scene = self.write("m.xml", SCENE.format(end=2).replace(GRID, '<mesh file="head.obj"/>'))
        before = self.files()
        for out in ("head.pc2", "head.mdd", os.path.join("..", os.path.basename(self.folder), "head.pc2")):
            result = self.run_pliant("bake", scene, "-o", out, code=2)
            self.assertRegex(result.stderr, r"would overwrite \S*head\.obj, which the scene is made from")
            self.assertEqual(self.files(), before)
        os.rename(self.path("head.obj"), self.path("head.02.obj"))
        scene = self.write("m.xml", SCENE.format(end=2).replace(GRID, '<mesh file="head.02.obj"/>'))
        self.run_pliant("bake", scene, "-o", "head.##.obj", code=2)
        self.run_pliant("bake", scene, "-o", "head.##.obj", "--frames", "1")

    def test_an_interrupt_leaves_nothing(self):
        scene = self.slow_scene()
        for ending in ONE_FILE:
            code, errors = self.interrupt(scene, "a" + ending, signal.SIGINT)
            self.assertEqual(code, 1, ending + errors)
            self.assertEqual(self.files(), ["slow.xml"], ending)

    def test_killed_it_leaves_nothing_under_the_name(self):
        scene = self.slow_scene()
        for ending in ONE_FILE:
            self.write("a" + ending, "old")
            self.interrupt(scene, "a" + ending, signal.SIGKILL)
            with open(self.path("a" + ending), encoding="utf-8") as file:
                self.assertEqual(file.read(), "old")
            for name in self.files():
                self.assertRegex(name, r"^(slow\.xml|a\.\w+|\..*\.part)$")
                if name.startswith("."):
                    os.remove(self.path(name))
            os.remove(self.path("a" + ending))
            self.assertEqual(self.files(), ["slow.xml"], ending)

    def test_a_full_disk_leaves_nothing(self):
        scene = self.scene(end=1000)
        for ending in ONE_FILE:
            result = subprocess.run(["sh", "-c", 'ulimit -f 64; exec "$0" bake "$1" -o "$2"', PLIANT, scene,
                                     self.path("a" + ending)], capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, 1, ending + result.stderr)
            self.assertRegex(result.stderr, r"^\S+: error: cannot write the file: File too large\n$")
            self.assertEqual(self.files(), ["scene.xml"], ending)

    def test_what_gltf_cannot_hold_is_told_ahead(self):
        result = self.run_pliant("bake", self.scene(end=10000), "-o", "a.glb", code=2)
        self.assertIn(".usda, .pc2, .mdd and .npy hold more", result.stderr)
        self.run_pliant("bake", self.scene(end=10000), "-o", "a.glb", "--frames", "9990:10000")

    def test_an_interrupted_sequence_is_resumed(self):
        scene = self.scene(end=40)
        os.mkdir(self.path("whole"))
        for ending in (".obj", ".ply"):
            self.run_pliant("bake", scene, "-o", "whole/a" + ending)
            self.run_pliant("bake", scene, "-o", "a" + ending, "--frames", "1:15")
            os.utime(self.path("a.0007" + ending), (0, 0))
            self.run_pliant("bake", scene, "-o", "a" + ending, "--resume")
            self.assertEqual(os.stat(self.path("a.0007" + ending)).st_mtime, 0)
            for frame in range(1, 41):
                name = f"a.{frame:04}{ending}"
                with open(self.path(name), "rb") as a, open(self.path("whole/" + name), "rb") as b:
                    self.assertEqual(a.read(), b.read(), name)
        other = self.write("other.xml", SCENE.format(end=40).replace("3000", "3001"))
        os.remove(self.path("a.0040.obj"))
        result = self.run_pliant("bake", other, "-o", "a.obj", "--resume", code=1)
        self.assertRegex(result.stderr, r"^a\.0039\.obj: error: cannot be resumed")
        self.assertNotIn("a.0040.obj", self.files())
        for ending in ONE_FILE:
            result = self.run_pliant("bake", scene, "-o", "b" + ending, "--resume", code=2)
            self.assertIn("whole at its end only", result.stderr)


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
        self.assertEqual(last[4], 3.5)  # from 3 to 10 in two frames

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
        for arguments, words in ((["--channel", "poke.magnitud"], "it has poke.enabled, poke.magnitude"),
                                 (["--channel", "none.b"], "no such channel"),
                                 (["--frames", "3:1"], "A:B with A <= B"),
                                 (["--frames", "nan:1"], "A:B with A <= B"),
                                 (["--frames", "0:1e300"], "more than"),
                                 (["--step", "0"], "not a number from"),
                                 (["--step", "nan"], "not a number from"),
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


GRID = '<grid columns="13" rows="11" width="12" depth="10"/>'
POINT = '<point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"/>'


def animated(attribute, *keys):
    return f'<animate attribute="{attribute}">' + "".join(
        f'<key frame="{frame}" value="{value}"/>' for frame, value in keys) + "</animate>"


PATH = ('<path attribute="center"><waypoint at="0 0 0"/><waypoint at="1 0 0"/>'
        '<waypoint at="1 1 0"/></path>')

# name: what is replaced in the scene, by what, the line of the error, words of its message
BAD_SCENES = {
    "a misspelt element": ("<grid", "<gird", 3, 'did you mean "grid"'),
    "a misspelt attribute": ("magnitude", "magnitud", 4, 'did you mean "magnitude"'),
    "a missing mesh file": (GRID, '<mesh file="none.obj"/>', 3, "No such file"),
    "a folder as a mesh file": (GRID, '<mesh file="folder.obj"/>', 3, "it is a folder"),
    "nan": ("3000", "nan", 4, "not a finite number"),
    "a decimal comma": ("3000", "1,5", 4, 'a decimal point is written "."'),
    "a hexadecimal number": ("3000", "0x10", 4, "stands after 0"),
    "a number beyond all": ("3000", "1e999", 4, "outside the range"),
    "text after a number": ("3000", "3000N", 4, '"N" stands after 3000'),
    "a vector of two numbers": ("0 0 0", "0 0", 4, "three numbers are required, not 2"),
    "two surfaces of one name": ("<point", f'<surface name="sheet">{GRID}</surface><point', 4,
                                 "the name is taken at line 3"),
    "two keys at one frame": (POINT, '<point name="p">' + animated("magnitude", (1, 0), (1, 2)) +
                              "</point>", 4, "repeats the key"),
    "an attribute given and animated": (POINT, '<point name="p" magnitude="3">' +
                                        animated("magnitude", (1, 0)) + "</point>", 4, "one of both"),
    "two columns": ('columns="13"', 'columns="2"', 3, "at least 3"),
    "end before start": ('end="9"', 'end="0"', 2, "must not be before"),
    "dt of 0": (GRID, GRID + '<solver dt="0"/>', 3, "must be greater than 0"),
    "a million steps": (GRID, GRID + '<solver dt="4e-8"/>', 3, "at most 100000 are allowed"),
    "c too small at a frame in the middle": (
        GRID, GRID + "<material>" + animated("c", (1, 0), (5, -3), (9, 0)) + "</material>", 3,
        "sheet.c at frame 4 is -2."),
    "a deformationRadius in a group": (POINT, f'<group name="g">{POINT}</group>', 4,
                                       "a force in a <group> selects no region"),
    "a group in a group": (POINT, '<group name="g"><group name="h"/></group>', 4,
                           'it belongs in <scene>'),
    "a group for a target": (POINT, '<group name="g"/><uniform name="u" targets="g"/>', 4,
                             '"g" is a <group>, not a surface'),
    "a name twice, once in a group": (POINT, '<group name="g"><noise name="sheet"/></group>', 4,
                                      "the name is taken at line 3"),
    "a group's radius below 0 at a frame": (
        POINT, '<group name="g">' + animated("deformationRadius", (1, 1), (9, -1)) + "</group>", 4,
        "g.deformationRadius at frame 6 is -"),
    "two falloffs": (POINT, '<point name="p" falloff="linear"><falloff><key at="0" value="1"/>'
                            "</falloff></point>", 4, "one of both must go"),
    "a falloff's key beyond 1": (POINT, '<point name="p"><falloff><key at="2" value="1"/></falloff>'
                                        "</point>", 4, 'at="2": must be at most 1'),
    "a misspelt kind of force": (POINT, '<vortx name="v"/>', 4, 'did you mean "vortex"'),
    "another kind's attribute": (POINT, '<vortex name="v" direction="0 1 0"/>', 4,
                                 'no attribute "direction"'),
    "a seed below 0": (POINT, '<noise name="n" seed="-1"/>', 4, "must be at least 0"),
    "a position given and on a path": (
        POINT, f'<point name="p" center="0 0 0">{PATH}</point>', 4, "one of both must go"),
    "a path of two waypoints": (
        POINT, '<point name="p">' + PATH.replace('<waypoint at="1 1 0"/>', "") + "</point>", 4,
        "three waypoints or more"),
    "a path for a direction": (
        POINT, '<point name="p">' + PATH.replace('"center"', '"direction"') + "</point>", 4,
        "is no position; the positions of <point> are: center"),
    "progress beyond the end at a frame": (
        POINT, '<point name="p">' + PATH.replace("</path>", animated("progress", (1, 0), (5, 2)) +
                                                 "</path>") + "</point>", 4,
        "p.center.progress at frame 4 is 1."),
    "a NUL byte": ("poke", "po\0ke", 4, "a NUL byte"),
    "a grid of 200000 x 200000": (GRID, '<grid columns="200000" rows="200000"/>', 3, "at most 100000000"),
    "10^5 nested elements": (GRID, "<a>" * 100000 + "</a>" * 100000, 3, "nested deeper"),
}

# name: text of the mesh file, line of the error in it, words of its message
BAD_MESHES = {
    "an index out of range": ("v 0 0 0\nv 1 0 0\nv 1 0 1\nvt 0 0\nf 1/1 2/1 9/1\n", 5, "9"),
    "coordinates that are not finite": ("v 0 0 nan\nv 1 0 0\nv 1 0 1\nvt 0 0\nf 1/1 2/1 3/1\n", 1, "nan"),
    "no faces": ("v 0 0 0\n", None, "no faces"),
}


class BadInput(Command):
    def refused(self, scene):
        """The lines that a bake prints of a scene that it refuses; within bounds, leaving nothing."""
        before = self.files()
        limit = (2 << 30, 2 << 30)

        def bounded():
            if not SANITIZED:  # they reserve more than any machine has
                resource.setrlimit(resource.RLIMIT_AS, limit)

        result = subprocess.run([PLIANT, "bake", scene, "-o", self.path("out.npy")], timeout=30,
                                capture_output=True, text=True, check=False, preexec_fn=bounded)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(self.files(), before)
        self.assertEqual(result.stdout, "")
        return result.stderr.splitlines()

    def test_bad_scenes(self):
        os.mkdir(self.path("folder.obj"))
        for name, (old, new, line, words) in BAD_SCENES.items():
            with self.subTest(name):
                text = SCENE.format(end=9)
                self.assertIn(old, text)
                lines = self.refused(self.write("s.xml", text.replace(old, new, 1)))
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], rf"^\S*s\.xml:{line}: error: ")
                self.assertIn(words, lines[0])

    def test_all_at_once(self):
        text = SCENE.format(end=9)
        for old, new in ((POINT, '<point name="poke" magnitud="3" center="0 0"/>'),
                         (GRID, '<mesh file="none.obj"/><material>' +
                          animated("c", (1, 0), (5, -3), (9, 0)) + "</material><nonsense/>")):
            text = text.replace(old, new)
        lines = self.refused(self.write("s.xml", text))
        self.assertEqual(len(lines), 5, lines)

    def test_bad_meshes(self):
        scene = self.write("s.xml", SCENE.format(end=9).replace(GRID, '<mesh file="m.obj"/>'))
        for name, (text, line, words) in BAD_MESHES.items():
            with self.subTest(name):
                self.write("m.obj", text)
                lines = self.refused(scene)
                self.assertEqual(len(lines), 1, lines)
                place = f":{line}" if line else ""
                self.assertRegex(lines[0], rf"^\S*m\.obj{place}: error: ")
                self.assertIn(words, lines[0])
        self.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\n")  # no (u,v): no grid
        self.assertRegex(self.refused(scene)[0], r"s\.xml:3: error: surface \"sheet\", mesh .*no \(u,v\)")

    def test_files_that_are_no_scene(self):
        for name, text in (("empty", ""), ("blank", "\n\n"), ("text", "hello"), ("root", "<a/>")):
            with self.subTest(name):
                lines = self.refused(self.write("s.xml", text))
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], r"^\S*s\.xml:\d+: error: ")
        self.assertIn("it is a folder", self.refused(self.folder)[0])

    def test_every_prefix_of_a_scene(self):
        text = SCENE.format(end=2).replace("magnitude=", 'falloff="smooth" magnitude=')
        text = text.replace(POINT.replace("magnitude=", 'falloff="smooth" magnitude='), "")
        whole = text.rstrip()
        for length in range(len(whole)):
            lines = self.refused(self.write("s.xml", whole[:length]))
            self.assertEqual(len(lines), 1, (length, lines))
            self.assertRegex(lines[0], r"^\S*s\.xml:\d+: error: ")


class Errors(Command):
    def test_every_problem_of_a_scene_with_its_line(self):
        scene = self.write("bad.xml", "\n".join((
            '<scene version="1" start="1" end="4">',
            '  <surface name="sheet"><grid columns="2" rows="11"/></surface>',
            '  <point name="poke" magnitud="3"',
            '         forceRadius="1,5"/>',
            '  <pont name="other"/>',
            '</scene>')))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=2)
        lines = result.stderr.splitlines()
        self.assertEqual([re.match(r".*bad\.xml:(\d+): error: ", line).group(1) for line in lines],
                         ["2", "3", "4", "5"], result.stderr)
        self.assertIn('"magnitude"', lines[1])
        self.assertEqual(self.files(), ["bad.xml"])

    def test_a_rule_broken_in_the_middle_of_a_curve(self):
        scene = self.write("c.xml", SCENE.format(end=9).replace("</surface>", """
    <material>
      <animate attribute="c"><key frame="1" value="0"/><key frame="5" value="-3"/>
        <key frame="9" value="0"/></animate></material></surface>"""))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=2)
        self.assertRegex(result.stderr, r"c\.xml:5: error: sheet\.c at frame 4 is -2\.\d+, but must be "
                                        r"greater than -2 sqrt\(b d\) = -2")

    def test_missing_files(self):
        result = self.run_pliant("bake", "none.xml", "-o", "a.npy", code=2)
        self.assertIn("none.xml: error: cannot read the file: No such file", result.stderr)
        result = self.run_pliant("bake", self.folder, "-o", "a.npy", code=2)
        self.assertIn("it is a folder", result.stderr)
        scene = self.write("m.xml", SCENE.format(end=9).replace(
            '<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="none.obj"/>'))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=2)
        self.assertRegex(result.stderr, r"m\.xml:3: error: .*none\.obj.*No such file")

    def test_what_cannot_be_written_is_exit_code_1(self):
        scene = self.scene()
        os.mkdir(self.path("folder.npy"))
        for out in ("no/such/a.npy", "folder.npy", "no/such/a.obj"):
            result = self.run_pliant("bake", scene, "-o", out, code=1)
            self.assertIn("error: cannot write the file", result.stderr)
        self.assertEqual(self.files(), ["folder.npy", "scene.xml"])

    def test_a_run_that_fails_leaves_nothing(self):
        text = SCENE.format(end=9).replace("</surface>", '<material density="0" damping="0" b="1e-10" '
                                                         'c="2e-10" d="1e-10"/></surface>')
        scene = self.write("s.xml", text.replace('"3000"', '"1e308"'))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=1)
        self.assertIn('surface "sheet", frame 1: the state stopped being finite', result.stderr)
        self.assertEqual(self.files(), ["s.xml"])

    def test_interrupt_leaves_nothing(self):
        scene = self.scene(end=900000)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            code, errors = self.interrupt(scene, "a.npy", number)
            self.assertEqual(code, 1, errors)
            self.assertRegex(errors, r"error: .*interrupted")
            self.assertEqual(self.files(), ["scene.xml"])

    def test_interrupt_within_a_frame_of_many_steps(self):
        scene = self.write("slow.xml", SCENE.format(end=9).replace('"13"', '"301"').replace(
            '"11"', '"301"').replace("</surface>", '<solver dt="5e-7"/></surface>'))
        begin = time.monotonic()
        code, errors = self.interrupt(scene, "a.npy", signal.SIGINT)
        self.assertEqual(code, 1, errors)
        self.assertLess(time.monotonic() - begin, 30)  # one frame takes minutes
        self.assertEqual(self.files(), ["slow.xml"])

    def test_whole_frames_of_an_interrupted_sequence_stay(self):
        scene = self.scene(end=900000)
        self.interrupt(scene, "a.obj", signal.SIGINT)
        files = self.files()
        self.assertEqual([name for name in files if name.endswith(".part")], [])
        line_counts = set()
        for name in files:
            if name.endswith(".obj"):
                with open(self.path(name), encoding="utf-8") as file:
                    line_counts.add(len(file.readlines()))
        self.assertEqual(len(line_counts), 1, "a frame is not whole")

    def test_a_full_disk_is_exit_code_1(self):
        scene = self.scene(end=300)
        result = subprocess.run(["sh", "-c", 'ulimit -f 64; exec "$0" bake "$1" -o "$2"', PLIANT, scene,
                                 self.path("a.npy")], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("error: cannot write the file: File too large", result.stderr)
        self.assertEqual(self.files(), ["scene.xml"])

    def test_streams_that_cannot_be_written_are_no_harm(self):
        scene = self.scene()
        for redirection in ("2>/dev/full", "2>&-", ">/dev/full", ">&-"):
            for name, code in ((scene, 0), ("none.xml", 2)):
                result = subprocess.run(
                    ["sh", "-c", f'exec "$0" bake "$1" -o a.npy {redirection}', PLIANT, name],
                    cwd=self.folder, capture_output=True, check=False)
                self.assertEqual(result.returncode, code, redirection)

    def test_warnings_come_before_the_error_that_they_explain(self):
        text = SCENE.format(end=9).replace("</surface>", '<material density="0" damping="0" b="1e-10" '
                                                         'c="2e-10" d="1e-10"/></surface>')
        text = text.replace('deformationRadius="4.5" ', "").replace('magnitude="3000"/>', """magnitude="1e149">
    <animate attribute="deformationRadius" interpolation="step">
      <key frame="1" value="0.5"/><key frame="4" value="4.5"/></animate></point>""").replace("e-10", "e-170")
        scene = self.write("s.xml", text)
        lines = self.run_pliant("bake", scene, "-o", "a.npy", code=1).stderr.splitlines()
        self.assertEqual(len(lines), 2)
        self.assertIn("selects fewer than 3 x 3 nodes", lines[0])
        self.assertIn("frame 4: the state stopped being finite", lines[1])


if __name__ == "__main__":
    PLIANT, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    SANITIZED = sys.argv[3:] == ["sanitized"]
    unittest.main(argv=sys.argv[:1])
