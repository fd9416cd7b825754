"""`pliant bake --cache`: which frames are solved and read, and that results never differ."""

import os
import random
import re
import resource
import shutil
import signal
import subprocess
import threading
import time
import unittest

from command import Command, PLIANT, SANITIZED, main

SCENE = """<?xml version="1.0"?>
<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="{count}" rows="11" width="12" depth="10"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5">
    <animate attribute="magnitude" tangent="linear">
      <key frame="1" value="1000"/>
      <key frame="{middle}" value="4000"/>
      <key frame="{end}" value="{last}"/>
    </animate>
  </point>
</scene>
"""


class Cache(Command):
    def setUp(self):
        super().setUp()
        self.cache = self.path("cache")

    def scene(self, last=2000, end=41, count=13, middle=None):
        return self.write("scene.xml", SCENE.format(end=end, middle=middle or (end + 1) // 2,
                                                    last=last, count=count))

    def words(self, *arguments, out="out.npy", cache=True):
        cached = ["--cache", self.cache] if cache else []
        return ["bake", self.path("scene.xml"), "-o", self.path(out), *cached, *arguments]

    def bake(self, *arguments, out="out.npy", cache=True, **options):
        return self.run_pliant(*self.words(*arguments, out=out, cache=cache), **options)

    def counts(self, *arguments, **options):
        """Frames solved and read, from the summary; checks that nothing else is printed."""
        result = self.bake(*arguments, **options)
        self.assertEqual(result.stderr, "")
        found = re.search(r", (\d+) frames? solved, (\d+) read\n$", result.stdout)
        self.assertTrue(found, result.stdout)
        return tuple(map(int, found.groups()))

    def expected(self):
        """The output of a run without a cache."""
        result = self.bake(out="plain.npy", cache=False)
        self.assertNotIn("solved", result.stdout)
        return self.read("plain.npy")

    def check(self, solved, read, *arguments):
        self.assertEqual(self.counts(*arguments), (solved, read))
        self.assertEqual(self.read("out.npy"), self.expected())


class Reuse(Cache):
    def test_the_second_bake_reads(self):
        self.scene()
        self.check(40, 0)
        self.check(0, 40)
        self.check(0, 40, "--threads", "2")

    def test_an_edit_costs_the_frames_from_where_it_takes_effect(self):
        self.scene()
        self.check(40, 0)
        self.scene(last=3000)  # the last unchanged state is that of frame 21
        self.check(19, 21)     # frame 22 samples another magnitude, which changes frame 23
        self.scene()
        self.check(0, 40)  # states solved before are still stored

    def test_frames_beyond_the_end_are_all_that_a_longer_scene_solves(self):
        self.scene(last=4000, end=41, middle=21)
        self.check(40, 0)
        self.scene(last=4000, end=51, middle=21)
        self.check(10, 40)
        self.scene(last=4000, end=31, middle=21)
        self.check(0, 30)

    def test_outputs_of_every_kind_are_as_always(self):
        self.scene(end=11)
        self.bake()
        for out, more in (("a.obj", []), ("a.usda", []), ("a.glb", []), ("a.npy", ["--space", "object"]),
                          ("b.npy", ["--frames", "5:9"])):
            self.counts(*more, out="cached-" + out)
            self.bake(*more, out="plain-" + out, cache=False)
        names = [name for name in os.listdir(self.folder) if name.startswith("plain-")]
        self.assertEqual(len(names), 11 + 4)
        for name in names:
            self.assertEqual(self.read(name), self.read(name.replace("plain-", "cached-")), name)

    def test_what_is_told_of_regions_and_warnings_is_as_always(self):
        self.scene(end=11)
        with open(self.path("scene.xml"), "r+", encoding="utf-8") as file:
            text = file.read().replace("</scene>", '<point name="far" center="99 0 0" magnitude="1"/></scene>')
            file.seek(0)
            file.write(text)
        first = self.bake("--regions", self.path("first.json"))
        second = self.bake("--regions", self.path("second.json"))
        self.assertIn("0 frames solved, 10 read", second.stdout)
        self.assertIn('force "far" selects no node', first.stderr)
        self.assertEqual(first.stderr, second.stderr)
        regions = [re.sub(rb'"solver".*', b"", self.read(name), flags=re.DOTALL)
                   for name in ("first.json", "second.json")]
        self.assertEqual(*regions)

    def test_another_solver_has_states_of_its_own(self):
        self.scene(end=11)
        self.assertEqual(self.counts("--solver", "spectral"), (10, 0))
        self.assertEqual(self.counts("--solver", "auto"), (10, 0))
        self.assertEqual(self.counts("--solver", "spectral"), (0, 10))

    def test_a_resumed_sequence_reads_what_it_does_not_write(self):
        self.scene(end=11)
        self.counts(out="a.obj")
        os.remove(self.path("a.0011.obj"))
        self.assertEqual(self.counts("--resume", out="a.obj"), (0, 10))
        self.bake(out="b.obj", cache=False)
        for frame in range(1, 12):
            self.assertEqual(self.read(f"a.{frame:04}.obj"), self.read(f"b.{frame:04}.obj"))

    def test_two_bakes_at_a_time_share_a_folder(self):
        self.scene(end=61, count=31)
        expected = self.expected()
        runs = [subprocess.Popen([PLIANT, *self.words(out=f"{n}.npy")], stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True) for n in range(3)]
        for n, run in enumerate(runs):
            _, errors = run.communicate(timeout=120)
            self.assertEqual((run.returncode, errors), (0, ""))
            self.assertEqual(self.read(f"{n}.npy"), expected)
        self.assertEqual(self.counts(), (0, 60))


class Size(Cache):
    def disk(self):
        return sum((os.stat(os.path.join(self.cache, name)).st_size + 4095) // 4096 * 4096
                   for name in os.listdir(self.cache))

    def test_the_folder_stays_within_its_size(self):
        self.scene()
        for size in ("0", "0.00001", "0.0001", "0.0003"):
            solved, read = self.counts("--cache-size", size)
            self.assertEqual(solved + read, 40)
            self.assertGreater(solved, 0)
            self.assertLessEqual(self.disk(), float(size) * 1e9)
            self.assertEqual(self.read("out.npy"), self.expected())
        self.assertLess(self.counts("--cache-size", "0.0003")[0], 40)

    def test_sizes_that_are_none_are_refused(self):
        self.scene()
        for size in ("-1", "nan", "1e99", "x", ""):
            self.bake("--cache-size", size, code=2)
        self.assertFalse(os.path.exists(self.cache))
        self.bake("--cache-size", "1", cache=False, code=2)


class Damage(Cache):
    def files(self):
        return [os.path.join(self.cache, name) for name in sorted(os.listdir(self.cache))]

    def test_damaged_files_are_told_of_in_one_line_and_solved_again(self):
        self.scene(end=11)
        self.check(10, 0)
        generator = random.Random(3)
        for number, file in enumerate(self.files()[:6]):
            with open(file, "r+b") as damaged:
                size = os.path.getsize(file)
                if number % 2:
                    damaged.truncate(generator.randrange(size))
                else:
                    place = generator.randrange(size)
                    damaged.seek(place)
                    byte = damaged.read(1)[0]
                    damaged.seek(place)
                    damaged.write(bytes([byte ^ 1 << generator.randrange(8)]))
        result = self.bake()
        self.assertEqual(result.stderr, f"{self.cache}: note: removed 6 damaged files; those frames "
                                        "were solved again\n")
        self.assertIn("6 frames solved, 4 read", result.stdout)
        self.assertEqual(self.read("out.npy"), self.expected())
        self.check(0, 10)

    def test_foreign_files_are_left_alone(self):
        self.scene(end=11)
        os.mkdir(self.cache)
        for name in ("notes.txt", "0" * 32, "0" * 32 + ".state.bak"):
            with open(os.path.join(self.cache, name), "w", encoding="utf-8") as file:
                file.write("mine")
        self.check(10, 0, "--cache-size", "0")
        self.check(10, 0)
        self.check(0, 10)
        for name in ("notes.txt", "0" * 32, "0" * 32 + ".state.bak"):
            self.assertTrue(os.path.exists(os.path.join(self.cache, name)))


class Trouble(Cache):
    def test_a_file_is_no_folder(self):
        self.scene()
        with open(self.cache, "w", encoding="utf-8") as file:
            file.write("text")
        result = self.bake(code=2)
        self.assertEqual(result.stderr, f"pliant: error: --cache {self.cache}: is not a folder\n")
        self.assertEqual(self.bake("--cache", "", cache=False, code=2).stderr.count("\n"), 1)
        self.assertFalse(os.path.exists(self.path("out.npy")))

    def test_a_folder_that_cannot_be_made_does_not_cost_the_bake(self):
        self.scene()
        with open(self.path("file"), "w", encoding="utf-8") as file:
            file.write("text")
        self.cache = self.path("file/cache")
        result = self.bake()
        self.assertRegex(result.stderr, r"^[^\n]*file/cache: note: cannot create the folder: [^\n]+; "
                                        r"no frame is stored\n$")
        self.assertEqual(self.read("out.npy"), self.expected())

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_a_folder_that_is_read_only_is_read(self):
        self.scene()
        self.check(40, 0)
        os.chmod(self.cache, 0o500)
        self.addCleanup(os.chmod, self.cache, 0o700)
        self.check(0, 40)
        self.scene(last=3000)
        result = self.bake()
        self.assertIn("Permission denied; not all frames are stored", result.stderr)
        self.assertIn("19 frames solved, 21 read", result.stdout)

    def test_a_full_disk_does_not_cost_the_bake(self):
        # A limit on file sizes: a state of the small surface fits, one of the large surface does
        # not.
        self.scene(end=11, count=1001)
        with open(self.path("scene.xml"), "r+", encoding="utf-8") as file:
            text = file.read().replace("</surface>", "</surface>"
                                       '<surface name="tiny"><grid columns="5" rows="5"/></surface>')
            file.seek(0)
            file.write(text.replace('"4.5"', '"40"'))
        self.bake("--surface", "tiny", out="plain.npy", cache=False)
        result = self.bake("--surface", "tiny", preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (100_000, 100_000)))
        self.assertRegex(result.stderr, r"^[^\n]*cache: note: cannot write the file: [^\n]+; not all "
                                        r"frames are stored\n$")
        self.assertIn("10 frames solved, 0 read", result.stdout)
        self.assertEqual(self.read("out.npy"), self.read("plain.npy"))
        self.assertTrue(all(name.endswith(".state") for name in os.listdir(self.cache)))


class Kill(Cache):
    def test_a_bake_that_is_killed_goes_on_where_it_was(self):
        kills, checks = (6, 2) if SANITIZED else (200, 10)
        self.scene(end=1201, count=13)
        expected = self.expected()
        generator = random.Random(11)
        begin = time.monotonic()
        self.bake(out="timed.npy", cache=False)
        longest = 0.5 * (time.monotonic() - begin)  # so that no run completes at the first attempt
        read_before = 0
        for kill in range(kills):
            run = subprocess.Popen([PLIANT, *self.words("--quiet")], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
            timer = threading.Timer(generator.uniform(0, longest), run.kill)
            timer.start()
            _, errors = run.communicate(timeout=120)
            timer.cancel()
            self.assertIn(run.returncode, (0, -signal.SIGKILL))
            self.assertEqual(errors, "")
            if kill % (kills // checks) == 0:
                # The stored files are complete, and none is lost: read them in a copy.
                copy = self.path("copy")
                shutil.copytree(self.cache, copy) if os.path.exists(self.cache) else os.mkdir(copy)
                kept = sum(name.endswith(".state") for name in os.listdir(copy))
                cache, self.cache = self.cache, copy
                solved, read = self.counts(out="copy.npy")
                self.cache = cache
                self.assertEqual(read, kept)
                self.assertGreaterEqual(read, read_before)
                self.assertEqual(solved + read, 1200)
                self.assertEqual(self.read("copy.npy"), expected)
                read_before = read
                shutil.rmtree(copy)
        self.assertGreater(read_before, 0)
        solved, read = self.counts()
        self.assertEqual(solved + read, 1200)
        self.assertGreaterEqual(read, read_before)
        self.assertEqual(self.read("out.npy"), expected)
        self.assertEqual(self.counts(), (0, 1200))


if __name__ == "__main__":
    main()
