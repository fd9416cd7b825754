"""`pliant bake`: its output files, resuming, and the output of --regions."""

import contextlib
import json
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import unittest

import numpy as np

from command import Command, GRID, PLIANT, POINT, SANITIZED, SCENE, main
from view_server import HAS_PAGE

ONE_FILE = (".npy", ".pc2", ".mdd", ".glb", ".gltf", ".usda")


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

    def test_colliders_are_nodes_beside_the_surfaces_they_meet(self):
        def nodes(file):
            with open(self.path(file), "rb") as data:
                head = data.read(20)
                return json.loads(data.read(struct.unpack("<I", head[12:16])[0]))["nodes"]

        def content(file):
            with open(self.path(file), "rb") as data:
                return data.read()

        colliders = ('<collider name="ball" targets="sheet"><sphere/><transform translate="0 9 0"/></collider>'
                     '<collider name="floor"><plane/><transform translate="0 -9 0"/></collider>')
        other = '<surface name="other"><grid columns="3" rows="3"/><transform translate="0 7 0"/></surface>'
        plain = self.write("plain.xml", SCENE.format(end=3).replace("<point", other + "<point"))
        scene = self.write("met.xml", SCENE.format(end=3).replace("<point", other + colliders + "<point"))
        for out in ("a.glb", "a.gltf", "a.usda", "a.npy"):
            self.bake(plain, "-o", self.path("plain" + out))
            self.bake(scene, "-o", self.path(out))
            self.bake(scene, "-o", self.path("again" + out))
            self.bake(scene, "-o", self.path("none" + out), "--no-colliders")
            files = [out] if out != "a.npy" else ["a-sheet.npy", "a-other.npy"]
            for file in files:
                if out == "a.gltf":  # the numbers' name has that of the file
                    continue
                self.assertEqual(content(file), content("again" + file))
                self.assertEqual(content("none" + file), content("plain" + file))
                self.assertEqual(content(file) == content("none" + file), out == "a.npy")
        self.assertEqual([node["name"] for node in nodes("a.glb")], ["sheet", "other", "ball"])
        self.assertEqual(nodes("a.glb")[2]["translation"], [0, 9, 0])
        self.assertEqual(len(nodes("nonea.glb")), 2)
        for surface, count in (("sheet", 2), ("other", 1)):
            self.bake(scene, "-o", self.path("one.glb"), "--surface", surface)
            self.assertEqual(len(nodes("one.glb")), count)

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

    def test_a_peak_of_some_frames_says_of_which(self):
        scene = self.scene()
        self.bake(scene, "-o", self.path("a.npy"), "--quiet")
        displaced = np.linalg.norm(np.load(self.path("a.npy")) - np.load(self.path("a.npy"))[0], axis=2).max(axis=1)
        for frames, words in (("3:7", " in frames 3 to 7"), ("2", " at frame 2"), ("1:12", ""), ("1", " at frame 1")):
            for command in (["bake", scene, "-o", "b.npy"], *([["view", scene, "-o", "b.html"]] if HAS_PAGE else [])):
                told = self.run_pliant(*command, "--frames", frames).stdout
                found = re.search(r"peak displacement ([\d.e+-]+)(.*)\n", told)
                first, _, last = frames.partition(":")
                peak = displaced[int(first) - 1:int(last or first)].max()
                self.assertEqual((found[1], found[2]), (f"{peak:.6g}", words), command)

    def test_a_peak_that_is_rounding_is_told_as_0(self):
        scene = self.write("s.xml", '<scene start="1" end="9"><surface name="s">' + GRID + '</surface>' +
                           POINT.replace("3000", "1e-13") + "</scene>")
        self.bake(scene, "-o", self.path("a.npy"), "--quiet")
        self.assertNotEqual(np.ptp(np.load(self.path("a.npy")), axis=0).max(), 0)
        self.assertRegex(self.run_pliant("bake", scene, "-o", "a.npy").stdout, r"peak displacement 0\n$")

    def test_check_dt_tells_what_half_the_step_changes(self):
        def difference(scene, *flags):
            result = self.run_pliant("bake", scene, "-o", "a.npy", "--quiet", "--check-dt", *flags)
            self.assertEqual(result.stderr, "")
            found = re.fullmatch(r"a\.npy: at half the time step positions differ by (\S+) of the peak "
                                 r"displacement at most, (\S+) at frame (\d+)\n", result.stdout)
            return [float(number) for number in found.groups()] if found else result.stdout

        def scene_with(solver):
            text = ('<scene start="1" end="12"><surface name="s"><grid columns="13" rows="11" width="12" '
                    'depth="10"/><material density="40" damping="20"/>' + solver + '</surface>'
                    '<point name="p" magnitude="3000" deformationRadius="4.5" forceRadius="2.5"/></scene>')
            with open(self.path("dt.xml"), "w", encoding="utf-8") as file:
                file.write(text)
            return self.path("dt.xml")

        baked = {}
        for dt in (0.005, 1 / 24 / 18):  # 9 steps, and 18
            self.bake(scene_with(f'<solver dt="{dt!r}"/>'), "-o", self.path("b.npy"), "--quiet")
            baked[dt] = np.load(self.path("b.npy"))
        usual, half = baked.values()
        apart = np.linalg.norm(usual - half, axis=-1)
        moved = np.linalg.norm(usual - usual[0], axis=-1)
        whole = scene_with('<solver dt="0.005"/>')
        share, distance, frame = difference(whole)
        self.assertAlmostEqual(share, apart.max() / moved.max(), delta=5e-3 * share)
        self.assertAlmostEqual(distance, apart.max(), delta=1e-5 * distance)
        self.assertEqual(frame, 1 + apart.max(axis=1).argmax())
        # Of the frames that are written.
        self.assertLess(difference(whole, "--frames", "1:4")[1], distance)
        # What is halved is the step that divides a frame.
        self.assertEqual(difference(scene_with('<solver dt="0.03"/>')),
                         difference(scene_with('<solver dt="0.0208333333333333333"/>')))
        many = self.run_pliant("bake", scene_with('<solver dt="5e-7"/>'), "-o", "a.npy", "--check-dt",
                               code=2)
        self.assertIn("error: --check-dt, at half the time step: s.dt is", many.stderr)
        # A step may be longer than a frame, and keyed.
        self.assertGreater(difference(scene_with('<solver dt="1"/>'))[0], share)
        keyed = difference(scene_with(
            '<solver><animate attribute="dt"><key frame="1" value="0.005"/></animate></solver>'))
        self.assertEqual(keyed, [share, distance, frame])
        newmark = difference(scene_with('<solver dt="0.005" integrator="newmark"/>'))
        self.assertLess(newmark[0], share / 4)
        still = scene_with('<solver dt="0.005"/>').replace("dt.xml", "still.xml")
        with open(self.path("dt.xml"), encoding="utf-8") as file:
            text = file.read().replace('magnitude="3000"', 'magnitude="0"')
        with open(still, "w", encoding="utf-8") as file:
            file.write(text)
        result = self.run_pliant("bake", still, "-o", "a.npy", "--quiet", "--check-dt")
        self.assertEqual(result.stdout, "a.npy: at half the time step all positions are the same\n")

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
        shown = b""
        with contextlib.suppress(OSError):  # a terminal ends its output with this error
            while piece := os.read(main, 100000):
                shown += piece
        os.close(main)
        shown = shown.decode()
        self.assertRegex(shown, r"12/12 frames, [\d.]+ frames/s, 0:00 left")
        self.assertTrue(shown.endswith("\r\x1b[K"))  # wiped

    def test_warnings_name_the_force_and_its_frames(self):
        scene = self.write("w.xml", SCENE.format(end=5).replace('"4.5"', '"0.5"').replace('"2.5"', '"0.5"'))
        result = self.run_pliant("bake", scene, "-o", "a.npy")
        self.assertRegex(result.stderr, r'^\S*w\.xml:4: warning: force "poke" selects fewer than 3 x 3 '
                                        r'nodes of "sheet" at frames 1-4: too few to solve; nothing moved\n$')


    def test_what_was_not_played_is_no_excuse_for_silence(self):
        far = self.write("far.xml", SCENE.format(end=12).replace('center="0 0 0"', 'center="0 50 0"'))
        for frames, told in ((None, "at frames 1-11: no node"), ("1:11", "at frames 1-10, of those that were played: no node"),
                             ("4", "at frames 1-3, of those that were played: no node")):
            done = self.run_pliant("bake", far, "-o", "a.npy", *(["--frames", frames] if frames else []))
            self.assertEqual(done.stderr.count("warning"), 1, done.stderr)
            self.assertIn(told, done.stderr)
        np.save(self.path("late.npy"), np.zeros((3, 143, 3)))
        late = self.write("late.xml", SCENE.format(end=12).replace("<grid", '<grid cache="late.npy" cacheStart="20"'))
        done = self.run_pliant("bake", late, "-o", "a.npy")
        self.assertEqual(done.stderr.count("no sample within the scene"), 1, done.stderr)
        self.assertIn("after its frames, at frames 20 to 22", done.stderr)

    def test_a_place_far_from_the_origin_is_told_in_digits_and_what_single_precision_does_to_it(self):
        def scene(at, more=""):
            return self.write("far.xml", f"""<scene version="1" start="1" end="4"><surface name="pad">
              <mesh file="pad.obj" uv="surface"/>{more}</surface>
              <point name="p" center="{at}" deformationRadius="{0.6 * size}" forceRadius="{0.3 * size}" magnitude="9"/></scene>""")

        for size in (1e-3, 1.0, 1e4):
            offset = np.array([3e6, -4e6, 5e6]) * size
            corners = np.array([[i, 0, j] for j in range(9) for i in range(9)]) / 8 * size + offset
            faces = [[9 * j + i + 1, 9 * j + i + 10, 9 * j + i + 11, 9 * j + i + 2] for j in range(8) for i in range(8)]
            self.write("pad.obj", "".join("v %r %r %r\n" % tuple(map(float, corner)) for corner in corners) +
                       "".join("f %d %d %d %d\n" % tuple(face) for face in faces))
            middle = corners.mean(axis=0)
            place = " ".join(map(repr, map(float, middle)))
            low, high = re.search(r"bounding box (.*) to (.*)\n", self.run_pliant("info", scene(place)).stdout).groups()
            self.assertLess(np.abs(np.array([low.split(), high.split()], float) - corners[[0, -1]]).max(), 2e-3 * size)
            for ending in ONE_FILE:
                told = self.run_pliant("bake", scene(place), "-o", "a" + ending).stderr
                self.assertEqual(told.count("single precision of " + ending), ending != ".npy", told)
            translate = re.search(r'translate="([^"]*)"', told)[1]
            moved = middle + np.array(translate.split(), float)
            self.assertLess(np.abs(moved).max(), size)
            near = scene(" ".join(map(repr, map(float, moved))), f'<transform translate="{translate}"/>')
            for ending in ONE_FILE:
                self.assertEqual(self.run_pliant("bake", near, "-o", "a" + ending).stderr, "")
            self.assertIn("with --space world", self.run_pliant("bake", near, "-o", "a.glb", "--space", "object").stderr)

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
        for solver in ("auto", "spectral", "supernodal", "cholmod"):
            out = self.path(f"{solver}.npy")
            result = subprocess.run([PLIANT, "bake", scene, "-o", out, "--solver", solver],
                                    capture_output=True, text=True, timeout=120, check=False)
            if solver == "cholmod" and result.returncode == 2:  # a build without it says so
                self.assertRegex(result.stderr, r"^pliant: error: --solver cholmod: this build does "
                                                r"not have it [^\n]+\n$")
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
        self.assertRegex(result.stderr, r'^\S*large\.xml:3: error: surface "sheet" needs \S+ GB, more '
                                        r'than the 2 GB left of the 2 GB allowed\n$')
        for wrong in ("0", "-1", "nan", "all", "1,5"):
            self.run_pliant("bake", scene, "-o", "a.npy", "--max-memory", wrong, code=2)
        self.assertEqual(self.files(), ["large.xml"])

    @unittest.skipIf(SANITIZED, "the shadow memory of sanitizers counts too")
    def test_the_memory_told_ahead_is_the_memory_taken(self):
        # A bake with a region as large as the surface; the sum that info prints is an upper bound,
        # but not a loose one.
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
            self.assertLess(taken - 20e6, told)  # the base memory of any program
            self.assertGreater(taken, 0.5 * told)


class Outputs(Command):
    def slow_scene(self):
        """A scene with many seconds of work, whose frames fit in a glTF."""
        return self.write("slow.xml", SCENE.format(end=4000).replace('"13"', '"161"').replace(
            '"11"', '"161"').replace('"4.5"', '"9"'))

    def test_every_ending_writes_its_files(self):
        scene = self.write("two.xml", SCENE.format(end=3).replace(
            "<point", '<surface name="other"><grid columns="3" rows="3"/></surface><point'))
        for out, files in ((".pc2", ["a-other.obj", "a-other.pc2", "a-sheet.obj", "a-sheet.pc2"]),
                           (".mdd", ["a-other.mdd", "a-other.obj", "a-sheet.mdd", "a-sheet.obj"]),
                           (".glb", ["a.glb"]), (".gltf", ["a.HASH.bin", "a.gltf"]), (".usda", ["a.usda"])):
            self.run_pliant("bake", scene, "-o", "a" + out)
            names = self.files()
            self.assertEqual([re.sub(r"\.[0-9a-f]{16}\.", ".HASH.", name) for name in names], files + ["two.xml"])
            for name in names[:-1]:
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
            self.assertRegex(result.stderr, r"would overwrite \S*head\.obj, an input of the scene")
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
        self.assertIn("use .usda, .pc2, .mdd or .npy", result.stderr)
        self.run_pliant("bake", self.scene(end=10000), "-o", "a.glb", "--frames", "9990:10000")

    def test_an_interrupted_sequence_is_resumed(self):
        scene = self.scene(end=40)
        os.mkdir(self.path("whole"))
        for ending in (".obj", ".ply"):
            self.run_pliant("bake", scene, "-o", "whole/a" + ending)
            self.run_pliant("bake", scene, "-o", "a" + ending, "--frames", "1:15")
            os.utime(self.path("a.0007" + ending), (0, 0))
            result = self.run_pliant("bake", scene, "-o", "a" + ending, "--resume")
            self.assertRegex(result.stdout, r", 15 files kept, 25 written\n$")
            self.assertEqual(os.stat(self.path("a.0007" + ending)).st_mtime, 0)
            for frame in range(1, 41):
                name = f"a.{frame:04}{ending}"
                with open(self.path(name), "rb") as a, open(self.path("whole/" + name), "rb") as b:
                    self.assertEqual(a.read(), b.read(), name)
        other = self.write("other.xml", SCENE.format(end=40).replace("3000", "3001"))
        os.remove(self.path("a.0040.obj"))
        result = self.run_pliant("bake", other, "-o", "a.obj", "--resume")
        self.assertRegex(result.stdout, r", 1 file kept, 39 written\n$")  # at rest they are the same
        self.run_pliant("bake", other, "-o", "other.obj")
        for frame in range(1, 41):
            self.assertEqual(self.read(f"a.{frame:04}.obj"), self.read(f"other.{frame:04}.obj"))
        for ending in ONE_FILE:
            result = self.run_pliant("bake", scene, "-o", "b" + ending, "--resume", code=2)
            self.assertIn("one file, which cannot be resumed", result.stderr)


if __name__ == "__main__":
    main()
