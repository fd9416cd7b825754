"""`pliant sweep view`: what it writes, what it refuses, and what an interrupt leaves.

tests/viewer opens the page in a browser. A build without npm has no page; then only its message is
tested.
"""

import glob
import html
import json
import os
import re
import resource
import signal
import subprocess
import time
import unittest

from command import PLIANT, SANITIZED, Command, main
from view_server import HAS_PAGE
from view_test import read_page

SCENE = """<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="{columns}" rows="9" width="10" depth="10"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2.5" magnitude="900"/>
</scene>
"""


class SweepViews(Command):
    def make(self, *vary, name="s", columns=11, end=8, options=(), code=0):
        scene = self.write("scene.xml", SCENE.format(columns=columns, end=end))
        varied = [word for each in vary for word in ("--vary", each)]
        self.run_pliant("sweep", "run", scene, "-o", self.path(name), *varied, "--quiet", *options, code=code)

    def view(self, *options, name="s", code=0, **more):
        return self.run_pliant("sweep", "view", self.path(name), *options, code=code, **more)

    def refused(self, *options, name="s"):
        # Bad input is told first, whatever programs are missing.
        result = self.view(*options, name=name, code=2, env={"PATH": self.folder})
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        return result.stderr


@unittest.skipIf(HAS_PAGE, "this build has a page")
class NoPages(SweepViews):
    def test_without_npm_there_is_no_page(self):
        self.make("sheet.density=1,2")
        self.assertIn("this build has no viewer", self.view("-o", self.path("s.html"), code=1).stderr)


@unittest.skipUnless(HAS_PAGE, "this build has no page")
class SweepPages(SweepViews):
    def test_the_page_has_the_takes_that_are_done(self):
        self.make("sheet.c=-5,0,2", "poke.magnitude*=1,-1", code=1)
        summary = self.view("-o", self.path("s.html")).stdout
        self.assertRegex(summary, r"/s\.html: 4 of 6 takes shown, \d+ kB, \d+\.\d\d s\n$")
        title, head, _ = read_page(self.path("s.html"))
        self.assertEqual(title, "s – pliant")
        self.assertEqual((head["takes"], head["done"], head["failed"]), (6, 4, 2))
        self.assertEqual(head["paths"], ["sheet.c", "poke.magnitude*"])
        self.assertEqual(head["axes"], [{"count": 3, "paths": [0]}, {"count": 2, "paths": [1]}])
        self.assertEqual([shape["take"] for shape in head["shapes"]["takes"]], [2, 3, 4, 5])
        rows = self.run_pliant("sweep", "status", self.path("s"), code=1) and self.read("s/takes.csv").decode()
        for shape, row in zip(head["shapes"]["takes"], rows.splitlines()[3:]):
            peak, frame = row.split(",")[4:6]
            self.assertEqual((shape["displaced"], shape["frame"]), (float(peak), int(frame)))

    def test_a_page_is_the_same_whatever_made_it(self):
        self.make("sheet.density=1:3:5", "sheet.columns=9,11")
        pages = []
        for threads in ("1", "3"):
            self.view("-o", self.path("s.html"), "--threads", threads, "--quiet")
            pages.append(self.read("s.html"))
        self.assertEqual(pages[0], pages[1])

    def test_all_pictures_are_at_one_frame(self):
        self.make("sheet.density=1:3:5", options=("--frames", "2:7"))
        self.view("-o", self.path("s.html"), "--frame", "7")
        _, head, _ = read_page(self.path("s.html"))
        self.assertEqual({shape["frame"] for shape in head["shapes"]["takes"]}, {7})
        for frame in ("1", "8"):
            message = self.refused("-o", self.path("none.html"), "--frame", frame)
            self.assertIn(f"--frame {frame}: must be from 2 to 7", message)
        self.assertIn("--frame", self.view("-o", self.path("none.html"), "--frame", "x", code=2).stderr)
        self.assertFalse(os.path.exists(self.path("none.html")))

    def test_takes_are_evenly_spread(self):
        self.make("sheet.density=1..250", columns=5, end=2)
        self.assertIn("100 of 250 takes", self.view("-o", self.path("s.html")).stdout)
        _, head, _ = read_page(self.path("s.html"))
        shown = [shape["take"] for shape in head["shapes"]["takes"]]
        self.assertEqual((len(shown), shown[0], shown[-1]), (100, 0, 249))
        self.assertLessEqual({after - before for before, after in zip(shown, shown[1:])}, {2, 3})

    def test_a_sweep_without_a_take_that_is_done(self):
        self.make("sheet.density=1,2", options=("--make-only",))
        self.assertIn("0 of 2 takes", self.view("-o", self.path("s.html")).stdout)
        self.assertIn("--frame 9: must be from 1 to 8", self.refused("-o", self.path("s.html"), "--frame", "9"))

    def test_what_is_no_sweep_is_refused(self):
        os.mkdir(self.path("empty"))
        for name in ("empty", "missing"):
            self.assertIn("sweep.json", self.refused("-o", self.path("s.html"), name=name))
        self.assertFalse(os.path.exists(self.path("s.html")))

    def test_a_picture_without_chromium_fails_ahead_of_the_run(self):
        self.make("sheet.density=1,2")
        result = self.view("-o", self.path("s.html"), "--png", self.path("s.png"), code=1, env={"PATH": self.folder})
        self.assertRegex(result.stderr, r"\Apliant: error: --png needs Chromium.*\n\Z")
        self.assertEqual(self.files(), ["s", "scene.xml"])

    def test_outputs_that_are_refused(self):
        self.make("sheet.density=1,2")
        kept = {name: self.read(name) for name in ("s/sweep.json", "s/takes.csv", "scene.xml")}
        self.assertIn("-o F.html or --png F is missing", self.refused())
        for option in ("-o", "--png"):
            ending = {"-o": ".html", "--png": ".png"}[option]
            for name in ("s/sweep.json", "s/takes.csv", "scene.xml", "a", "a.jpg"):
                self.assertIn(f"allowed: {ending}", self.refused(option, self.path(name)))
            self.assertIn("its folder is the sweep's", self.refused(option, self.path(f"s/log/a{ending}")))
        self.write("a.html", "")
        os.symlink("a.html", self.path("a.png"))
        self.assertIn("it is that of -o", self.refused("-o", self.path("a.html"), "--png", self.path("a.png")))
        os.remove(self.path("a.png"))
        self.assertIn("does not exist", self.view("-o", self.path("no/s.html"), code=1).stderr)
        self.assertIn("--size", self.refused("--png", self.path("a.png"), "--size", "8x8"))
        self.assertIn("the most is", self.refused("--png", self.path("a.png"), "--size", "8000x8000"))
        self.view("-o", self.path("a.html"), "--size", "100x100", code=2)
        for look, reason in (("tunr=3", 'did you mean "turn"'), ("turn=3&theme=drak", 'did you mean "dark"'), ("turn=x", "a number"),
                             ("peak=0", "above 0"), ("turn", "a number"), ("legend=yes", "allowed: on, off"), ("legend", "allowed: on, off"),
                             ("clean=yes", "allowed: on, off"), ("up=w", "allowed: x, y, z"), ("colour=singed", 'did you mean "signed"')):
            message = self.refused("--png", self.path("a.png"), "--look", look)
            self.assertIn(f"--look {look.split('&')[-1]}: ", message)
            self.assertIn(reason, message)
            for option in ("--png", "--movie"):
                name = self.path({"--png": "a.png", "--movie": "a.mp4"}[option])
                self.assertIn(reason, self.run_pliant("view", self.path("scene.xml"), option, name, "--look", look, code=2).stderr)
        self.assertEqual(kept, {name: self.read(name) for name in kept})

    def test_a_mesh_that_was_changed_since_costs_its_pictures_only(self):
        self.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 0 1\nv 1 0 1\nv 2 0 1\nv 0 0 2\nv 1 0 2\nv 2 0 2\n"
                               "vt 0 0\nvt .5 0\nvt 1 0\nvt 0 .5\nvt .5 .5\nvt 1 .5\nvt 0 1\nvt .5 1\nvt 1 1\n"
                               "f 1/1 2/2 5/5 4/4\nf 2/2 3/3 6/6 5/5\nf 4/4 5/5 8/8 7/7\nf 5/5 6/6 9/9 8/8\n")
        scene = self.write("mesh.xml", SCENE.format(columns=5, end=3).replace(
            '<grid columns="5" rows="9" width="10" depth="10"/>', '<mesh file="flat.obj"/>'))
        self.run_pliant("sweep", "run", scene, "-o", self.path("s"), "--vary", "sheet.density=1,2", "--quiet")
        with open(self.path("flat.obj"), "a", encoding="utf-8") as file:
            file.write("# changed\n")
        result = self.view("-o", self.path("s.html"), code=1)
        self.assertIn("take 0 (sheet.density=1): ", result.stderr)
        self.assertIn("flat.obj", result.stderr)
        self.assertIn("0 of 2 takes", result.stdout)
        _, head, _ = read_page(self.path("s.html"))
        self.assertEqual([failure["take"] for failure in head["failures"]], [0, 1])
        os.mkdir(self.path("bin"))
        self.write("bin/chromium", "#!/bin/sh\n")  # never started
        os.chmod(self.path("bin/chromium"), 0o755)
        self.assertIn("s.png: not written, since no take has a picture",
                      self.view("--png", self.path("s.png"), code=1, env={"PATH": self.path("bin")}).stderr)
        self.assertFalse(os.path.exists(self.path("s.png")))
        self.assertEqual(head["done"], 2)
        os.link(self.path("flat.obj"), self.path("flat.html"))
        self.assertIn("it is a mesh of the scene", self.refused("-o", self.path("flat.html")))

    def test_an_interrupt_ends_within_a_second_and_leaves_nothing(self):
        self.make("sheet.density=1..100", columns=5, end=2)
        # Far longer than the takes of the log: as if they had been run on a farm.
        with open(self.path("s/sweep.json"), encoding="utf-8") as file:
            plan = file.read()
        small = 'columns=\\"5\\" rows=\\"9\\"'
        self.assertIn(small, plan)
        with open(self.path("s/sweep.json"), "w", encoding="utf-8") as file:
            side = 301 if SANITIZED else 801
            file.write(plan.replace(small, f'columns=\\"{side}\\" rows=\\"{side}\\"'))
        before = set(glob.glob(self.path("**"), recursive=True))
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([PLIANT, "sweep", "view", self.path("s"), "-o", self.path("s.html"), "--frame", "2"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                time.sleep(3 if SANITIZED else 0.7)
                process.send_signal(number)
                begin = time.monotonic()
                _, errors = process.communicate(timeout=300)
            self.assertEqual(process.returncode, 1, errors)
            self.assertIn("interrupted; nothing was written", errors)
            if not SANITIZED:
                self.assertLess(time.monotonic() - begin, 20)  # a second, on a machine of its own
            self.assertEqual(set(glob.glob(self.path("**"), recursive=True)), before)

    def test_a_full_disk_leaves_the_last_page(self):
        self.make("sheet.density=1,2")
        self.write("s.html", "the last page")
        result = self.view("-o", self.path("s.html"), code=1,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)))
        self.assertIn("cannot write", result.stderr)
        self.assertEqual(self.read("s.html"), b"the last page")
        self.assertFalse(glob.glob(self.path(".*")))

    def test_names_are_data(self):
        folder = "<img src=x onerror=alert(1)>"
        self.make("sheet.density=1,2", name=folder)
        self.view("-o", self.path("s.html"), name=folder)
        page = self.read("s.html").decode()
        self.assertNotIn("<img", page)
        self.assertEqual(re.search("<title>(.*?)</title>", page).group(1), "&lt;img src=x onerror=alert(1)&gt; – pliant")
        _, head, _ = read_page(self.path("s.html"))
        self.assertEqual(head["name"], folder)
        self.assertEqual(head["paths"], ["sheet.density"])

    def test_a_shell_runs_the_command_of_the_page(self):
        self.make("sheet.density=1,2", end=2)
        names = [b"plain", b"two words", b"it's $HOME `x` \"y\"", b"-o", b"=ls", b"~", b"a\nb\x1b[31mc\x7f", b"caf\xe9 'x\\'", "a\u202eb".encode(),
                 "caf\u00e9 \u540d".encode(), b"!!", b"#x", b"a;b&c|d", b"{a,b}", b"*"]
        for name in names:
            os.rename(self.path("s"), os.path.join(os.fsencode(self.folder), name))
            word = os.fsdecode(name)
            typed = "./" + word if word.startswith("-") else word
            self.run_pliant("sweep", "view", typed, "-o", "s.html", "--quiet")
            title, head, _ = read_page(self.path("s.html"))
            command = head["command"]
            self.assertTrue(all(letter.isprintable() and letter != "\N{REPLACEMENT CHARACTER}" for letter in command), command)
            subprocess.run(["bash", "-c", command + " 1 -o take1.npy --quiet"], cwd=self.folder, check=True, timeout=120,
                           env={**os.environ, "PATH": f"{os.path.dirname(PLIANT)}:{os.environ['PATH']}"})
            os.remove(self.path("take1.npy"))
            self.assertEqual(html.unescape(title), f"{head['name']} – pliant")
            os.rename(os.path.join(os.fsencode(self.folder), name), self.path("s"))
        for typed in (".", "./", "../s", "../s/."):
            self.run_pliant("sweep", "view", typed, "-o", "../s.html", "--quiet", cwd=self.path("s"))
            self.assertEqual(read_page(self.path("s.html"))[0], "s – pliant")

    def test_a_broken_machine_is_told(self):
        self.make("sheet.density=1,2")
        [log] = glob.glob(self.path("s/log/*.jsonl"))
        with open(log, encoding="utf-8") as file:
            line = file.readline()
        other = re.sub(r'"hash":"(.)', lambda hash: f'"hash":"{"1" if hash[1] == "0" else "0"}', line)
        self.write("s/log/z.jsonl", re.sub(r'"host":"[^"]*"', '"host":"<b>other"', other))
        take = json.loads(line)["take"]
        result = self.view("-o", self.path("s.html"), code=1)
        self.assertRegex(result.stderr, rf"^take {take}: hash differs between .*<b>other")
        self.assertIn("2 of 2 takes", result.stdout)
        [conflict] = read_page(self.path("s.html"))[1]["conflicts"]
        self.assertEqual(conflict["take"], take)
        self.assertIn("<b>other", conflict["text"])


if __name__ == "__main__":
    main()
