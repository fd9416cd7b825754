"""`pliant sweep`: its tables and bits, and what a kill, a full disk and a broken machine do to it.

PLIANT_SWEEP_KILLS is the number of runs that are killed at random moments, 20 by default.
"""

import glob
import json
import math
import os
import random
import resource
import signal
import subprocess
import time

from command import PLIANT, SANITIZED, main
from sweeps import VARY, SweepCommand, edited

KILLS = int(os.environ.get("PLIANT_SWEEP_KILLS", "4" if SANITIZED else "20"))


class Sweeps(SweepCommand):
    # Values and bits.

    def test_each_take_has_the_bits_of_the_scene_edited_by_hand(self):
        self.make("s", "--write", "npy", vary=("--vary", "sheet.density=1,3", "--vary", "poke.magnitude=450,900",
                                               "--vary", "sheet.columns=9,11"))
        rows = self.rows()
        self.assertEqual(len(rows), 8)
        for number, row in enumerate(rows):
            scene = self.write("edited.xml", edited(density=row["sheet.density"], columns=row["sheet.columns"],
                                                    magnitude=row["poke.magnitude"]))
            summary = self.run_pliant("bake", scene, "-o", self.path("edited.npy")).stdout
            self.assertEqual(self.read("edited.npy"), self.read(f"s/takes/{number:05}.npy"))
            self.assertIn(f"peak displacement {float(row['peak']):.6g}", summary)
            self.sweep("bake", self.path("s"), str(number), "-o", self.path("one.npy"))
            self.assertEqual(self.read("edited.npy"), self.read("one.npy"))
        self.assertEqual(len({row["hash"] for row in rows}), 8)

    def test_the_channels_of_colliders_are_swept_as_any(self):
        text = """<scene version="1" start="1" end="6">
  <surface name="sheet"><grid columns="9" rows="8" width="4" depth="4"/>
    <material density="0.02" damping="0.02"/><solver region="all" dt="0.02"/></surface>
  <uniform name="weight" direction="0 -1 0" magnitude="400" forceRadius="100"/>
  <collider name="ball" offset="{offset}"><sphere radius="{radius}"/><transform translate="{translate}"/></collider>
  <collider name="floor" friction="{friction}"><plane/><transform translate="0 -0.2 0" rotate="0 0 5"/></collider>
</scene>
"""
        plain = {"offset": "0", "radius": "0.8", "translate": "0 0.75 0", "friction": "0"}
        for name, values in (("ball.translate", ("0 0.75 0", "0.3 0.5 0")), ("ball.radius", ("0.8", "1.1")),
                             ("ball.offset", ("0", "0.2")), ("floor.friction", ("0", "0.7"))):
            with self.subTest(name):
                folder = name.replace(".", "-")
                takes = self.write(folder + ".csv", f'{name}\n' + "".join(f'"{value}"\n' for value in values))
                self.make(folder, "--write", "npy", scene=self.write("scene.xml", text.format(**plain)),
                          vary=("--takes", takes))
                bits = []
                for number, value in enumerate(values):
                    edited_scene = self.write("edited.xml", text.format(**{**plain, name.split(".")[1]: value}))
                    self.run_pliant("bake", edited_scene, "-o", self.path("edited.npy"))
                    bits.append(self.read("edited.npy"))
                    self.assertTrue(bits[-1] == self.read(f"{folder}/takes/{number:05}.npy"))
                self.assertTrue(bits[0] != bits[1])

    def test_measures_and_hash_are_those_of_the_animation(self):
        import numpy
        self.make("s", "--write", ".npy", "--frames", "2:7", vary=("--vary", "sheet.density=0.5,20"))
        for number, row in enumerate(self.rows()):
            x = numpy.load(self.path(f"s/takes/{number:05}.npy"))
            self.run_pliant("bake", self.path("scene.xml"), "-o", self.path("rest.npy"), "--frames", "1")
            rest = numpy.load(self.path("rest.npy"))[0]
            away = numpy.sqrt(((x - rest) ** 2).sum(axis=2))
            steps = numpy.sqrt(((x[1:] - x[:-1]) ** 2).sum(axis=2))
            length = 1 / 24
            close = lambda name, value: self.assertTrue(math.isclose(float(row[name]), value, rel_tol=1e-12), name)
            close("peak", away.max())
            self.assertEqual(int(row["peakFrame"]), 2 + int(away.max(axis=1).argmax()))
            close("final", away[-1].max())
            close("rms", math.sqrt((away ** 2).mean()))
            close("speed", steps.max() / length)
            close("energy", (steps ** 2).sum(axis=1).max() / (2 * x.shape[1] * length ** 2))
            late = [frame for frame in range(len(steps)) if steps[frame].max() > away.max() / 1000]
            self.assertEqual(int(row["settle"]), 2 + (late[-1] + 1 if late else 0))

    def test_a_root_confines_a_sweep_of_a_stranger(self):
        os.makedirs(self.path("in"))
        self.write("sheet.obj", "v 0 0 0\nv 9 0 0\nv 9 0 9\nv 0 0 9\nf 1 2 3 4\n")
        scene = self.write("in/scene.xml", edited().replace('<grid columns="11" rows="9" width="10" depth="10"/>',
                                                            '<mesh file="../sheet.obj" border="pinned"/>'))
        self.make("s", scene=scene, vary=("--vary", "sheet.density=1,3"))
        commands = (("run", "s"), ("run", "s", "--part", "0/2"), ("status", "s"), ("verify", "s"),
                    ("bake", "s", "0", "-o", "a.npy"), ("view", "s", "-o", "a.html"))
        for command in commands:
            with self.subTest(command):
                told = self.sweep(*command, "--root", "in", code=2)
                self.assertRegex(told.stderr, r'^\S+scene\.xml:2: error: <mesh> file="\.\./sheet\.obj": '
                                              r"it is outside \S+, the folder of --root\n$")
                self.assertRegex(self.sweep(*command, "--root", "none", code=2).stderr, "--root none: is not a folder")
        self.assertFalse(os.path.exists(self.path("a.npy")) or os.path.exists(self.path("a.html")))
        for command in commands:
            self.sweep(*command, "--root", ".")

    def test_a_file_that_is_not_there_is_told_ahead_of_all_work(self):
        self.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n")
        scene = self.write("a.xml", """<scene version="1" start="1" end="2">
  <surface name="s"><mesh file="quad.obj"/></surface></scene>""")
        for option in ("--set", "--vary"):
            values = (["--set", "s.file=no.obj", "--vary", "s.density=1,2"] if option == "--set" else
                      ["--vary", "s.file=quad.obj,no.obj"])
            told = self.sweep("run", scene, "-o", self.path("s"), *values, code=2).stderr
            self.assertIn(f"{option} s.file=", told)
            self.assertIn("no.obj: cannot read the file: No such file or directory", told)
            self.assertFalse(os.path.exists(self.path("s")))

    def test_a_table_from_elsewhere(self):
        takes = self.write("design.csv", 'sheet.density,poke.magnitude*,"poke.center"\n1,2,0 0 0\n7,0.5,"1 0 0"\n')
        self.make("s", vary=("--takes", takes))
        text = self.table().decode()
        self.assertTrue(text.startswith("take,status,sheet.density,poke.magnitude*,poke.center,peak,"), text)
        self.assertIn("\n1,done,7,0.5,1 0 0,", text)

    def test_the_table_of_a_sweep_and_those_of_spreadsheets_are_taken(self):
        self.make("s")
        self.assertIn(f"{self.path('s/takes.csv')}: note: 11 columns left out, whose heads are not of the form "
                      "NAME.ATTRIBUTE: take, status, peak, peakFrame, final, rms, speed, energy, settle, hash, error\n",
                      self.make("again", vary=("--takes", self.path("s/takes.csv"))).stderr)
        self.assertEqual(self.table("again"), self.table("s"))
        text = self.table("s").decode()
        for name, separator in (("semicolons", ";"), ("tabulators", "\t")):
            other = self.write(name + ".csv", text.replace(",", separator))
            self.make(name, vary=("--takes", other))
            self.assertEqual(self.table(name), self.table("s"))

    def test_several_scenes_are_the_first_axis(self):
        one, two = self.write("one.xml", edited()), self.write("two.xml", edited(density=9))
        self.sweep("run", one, two, "-o", self.path("s"), "--set", "poke.magnitude=500", "--vary", "sheet.c=1,2")
        self.assertEqual([(row["scene"], row["sheet.c"]) for row in self.rows()],
                         [(one, "1"), (one, "2"), (two, "1"), (two, "2")])
        hashes = [row["hash"] for row in self.rows()]
        self.assertEqual(len(set(hashes)), 4)

    def test_samples_begin_with_the_same_takes(self):
        vary = ("--vary", "sheet.density=1:3", "--vary", "poke.magnitude=100:900")
        self.make("few", "--sample", "2", vary=vary)
        self.make("many", "--sample", "5", vary=vary)
        few, many = self.table("few").splitlines(), self.table("many").splitlines()
        self.assertEqual(few, many[:3])
        self.assertTrue(few[1].startswith(b"0,done,2,500,"), few[1])

    def test_a_dry_run_prints_the_table_as_it_begins_and_writes_nothing(self):
        scene = self.write("scene.xml", edited())
        before = self.tree()
        text = self.make("s", "--dry-run", scene=scene).stdout
        self.assertEqual(self.tree(), before)
        self.assertEqual(text.splitlines()[0], "take,status,sheet.density,poke.magnitude*,peak,peakFrame,final,rms,"
                                               "speed,energy,settle,hash,error")
        self.assertEqual(text.splitlines()[5], "4,missing,3,0.5,,,,,,,,,")
        self.make("s", "--make-only", scene=scene)
        self.sweep("status", self.path("s"), code=1)
        self.assertEqual(self.table().decode(), text)

    # What is wrong.

    def test_wrong_usage_is_told_ahead_of_all_work(self):
        scene = self.write("scene.xml", edited())
        for options, parts in [
                (["--vary", "sheet.densty=1,2"], ["--vary sheet.densty=1,2: ", 'did you mean "density"']),
                (["--vary", "sheet.density=1,-2"], ["--vary sheet.density=1,-2: ", "at least 0"]),
                (["--vary", "sheet.density=1:2"], ["--vary sheet.density=1:2: ", "--sample"]),
                (["--vary", "sheet.density=1:2:0"], ["not a count"]),
                (["--vary", "sheet.density=1..2", "--set", "sheet.density=2"], ["--set sheet.density=2"]),
                (["--vary", "sheet.density=1..2000", "--vary", "poke.magnitude=1..2000"], ["4000000 takes"]),
                (["--vary", "sheet.density=1", "--part", "3/3"], ["--part 3/3"]),
                (["--vary", "sheet.density=1", "--frames", "1:99"], ["--frames 1:99", "1 to 8"]),
                (["--vary", "sheet.density=1", "--write", "abc"], ["--write abc"]),
                (["--vary", "sheet.density=1", "--sample", "0"], ["--sample 0"]),
                (["--vary", "sheet.density=1", "--make-only", "--part", "0/2"], ["--part", "--make-only"]),
                (["--vary", "sheet.density=1", "--engine", "pbs"], ["--engine"]),
                ([], ["nothing varies"])]:
            with self.subTest(options=options):
                before = self.tree()
                errors = self.sweep("run", scene, "-o", self.path("s"), *options, code=2).stderr
                for part in parts:
                    self.assertIn(part, errors)
                self.assertEqual(self.tree(), before)
        self.assertIn("-o DIR is missing", self.sweep("run", scene, "--vary", "sheet.density=1", code=2).stderr)
        self.assertIn("sweep.json", self.sweep("status", self.folder, code=2).stderr)

    def test_another_sweep_in_the_folder_is_refused(self):
        self.make()
        before = self.tree()
        errors = self.make("s", vary=("--vary", "sheet.density=1,4"), code=2).stderr
        self.assertIn("it has --vary sheet.density=1,3", errors)
        self.assertIn("not --vary sheet.density=1,4", errors)
        self.assertIn("is a sweep already", self.sweep("run", self.path("s"), "--vary", "a.b=1", code=2).stderr)
        self.assertEqual({name: stamp for name, stamp in self.tree().items() if "/s/" in name},
                         {name: stamp for name, stamp in before.items() if "/s/" in name})
        self.write("scene.xml", edited(density=2))
        self.assertIn("scene.xml", self.sweep("run", self.path("scene.xml"), "-o", self.path("s"), *VARY, code=2).stderr)
        self.sweep("run", self.path("s"))  # takes run the text that they were made of

    def test_a_wrong_value_of_a_table_is_told_with_its_line(self):
        table = self.write("t.csv", "sheet.density,sheet.b\n" + "1,2\n" * 50 + '"3",-1\n' + "1,-1\n")
        scene = self.write("scene.xml", edited())
        errors = self.sweep("run", scene, "-o", self.path("s"), "--takes", table, code=2).stderr
        self.assertIn(f"--takes {table}, line 52: sheet.b=-1: \"-1\": must be greater than 0", errors)
        self.assertEqual(self.files(), ["scene.xml", "t.csv"])

    def test_a_gltf_without_its_numbers_is_run_again(self):
        self.make("s", "--write", "gltf")
        self.assertIn("8 done", self.sweep("status", self.path("s")).stdout)
        numbers, = glob.glob(self.path("s/takes/00003.*.bin"))
        os.remove(numbers)
        self.assertIn("7 done, 0 failed, 1 missing", self.sweep("status", self.path("s"), code=1).stdout)
        self.sweep("run", self.path("s"))
        self.assertTrue(os.path.exists(numbers))

    def test_several_makers_at_once_make_one_sweep(self):
        scene = self.write("scene.xml", edited(end=2))
        for attempt in range(4):
            name = f"s{attempt}"
            axes = [f"sheet.density={1 + k % 2}..{2 + k % 2}" for k in range(6)]
            makers = [subprocess.Popen([PLIANT, "sweep", "run", scene, "-o", self.path(name), "--vary", axis],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for axis in axes]
            errors = [maker.communicate(timeout=300)[1] for maker in makers]
            with open(self.path(f"{name}/sweep.json"), encoding="utf-8") as file:
                made, = json.load(file)["arguments"]["vary"]
            for axis, maker, error in zip(axes, makers, errors):
                if axis == made:
                    self.assertEqual(maker.returncode, 0, error)
                else:
                    self.assertEqual(maker.returncode, 2)
                    self.assertIn("is another sweep", error)
            self.sweep("verify", self.path(name))
            self.assertFalse(glob.glob(self.path(f"{name}/.*")))

    def test_the_file_of_a_stranger_leads_nowhere_else(self):
        self.make("s", "--write", "npy", "--make-only")
        file = self.path("s/sweep.json")
        with open(file, encoding="utf-8") as opened:
            text = opened.read()
        os.makedirs(self.path("s/takes/00000"))
        wrong = [('"write":".npy"', f'"write":"{write}"') for write in ("/../../../escaped.npy", ".foo", "npy", ".NPY")]
        wrong += [('"frames":null', f'"frames":[{frame},2]') for frame in ("1e300", "4294967297", "1.5", '"1"')]
        for old, new in wrong:
            self.assertIn(old, text)
            with open(file, "w", encoding="utf-8") as opened:
                opened.write(text.replace(old, new))
            for command in ("run", "status", "verify"):
                done = self.sweep(command, self.path("s"), code=2)
                self.assertIn("is not the file of a sweep", done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1)
        self.assertEqual(self.files(), ["s", "scene.xml"])
        os.remove(file)
        os.mkfifo(file)
        self.assertIn("is no regular file", self.sweep("status", self.path("s"), code=2).stderr)

    def test_what_is_no_log_is_left_alone(self):
        self.make("s")
        os.mkfifo(self.path("s/log/a.jsonl"))
        os.mkdir(self.path("s/log/b.jsonl"))
        with open(glob.glob(self.path("s/log/*-*.jsonl"))[0], "a", encoding="utf-8") as log:
            log.write("[" * 3_000_000 + "\n" + '{"take":0,"status":"done","peak":1,"peakFrame":1e300}\n')
        wanted = self.table()
        self.sweep("run", self.path("s"))
        self.assertEqual(self.table(), wanted)

    def test_failed_takes_are_named(self):
        result = self.make("s", vary=("--vary", "sheet.c=-5,2", "--vary", "sheet.d=1,9"), code=1)
        self.assertIn("take 0 (sheet.c=-5, sheet.d=1): ", result.stderr)
        self.assertIn("4 takes, 3 done, 1 failed, 0 missing", result.stdout)
        row = self.rows()[0]
        self.assertEqual((row["status"], row["peak"], row["hash"]), ("failed", "", ""))
        self.assertIn(row["error"], result.stderr)
        again = self.sweep("run", self.path("s"), code=1)
        self.assertEqual(len(glob.glob(self.path("s/log/*"))), 1)
        self.assertEqual(again.stderr.splitlines(), result.stderr.splitlines()[1:])  # but for the memory of a take
        self.sweep("run", self.path("s"), "--retry", code=1)
        self.assertEqual(len(glob.glob(self.path("s/log/*"))), 2)
        many = self.make("many", "--quiet", vary=("--vary", "sheet.c=-5", "--vary", "sheet.density=1..13"), code=1)
        self.assertEqual(len(many.stderr.splitlines()), 11)
        self.assertIn("3 other takes failed too", many.stderr)

    def test_a_changed_mesh_fails_the_take_by_name(self):
        mesh = "".join(f"v {i} 0 {j}\n" for j in range(5) for i in range(5))
        mesh += "".join(f"vt {i / 4} {j / 4}\n" for j in range(5) for i in range(5))
        for j in range(4):
            for i in range(4):
                corners = [5 * j + i + 1, 5 * j + i + 2, 5 * j + i + 7, 5 * j + i + 6]
                mesh += "f " + " ".join(f"{corner}/{corner}" for corner in corners) + "\n"
        self.write("a.obj", mesh)
        self.write("b.obj", mesh.replace("v 2 0 2\n", "v 2 0.25 2\n"))
        scene = self.write("mesh.xml", '<scene version="1" start="1" end="4"><surface name="m"><mesh file="a.obj"/>'
                           '</surface><point name="p" center="2 0 2" deformationRadius="2" magnitude="9"/></scene>')
        vary = ("--vary", "m.file=a.obj,b.obj", "--vary", "m.density=1,2")
        self.make("wanted", scene=scene, vary=vary)
        self.assertEqual(len({row["hash"] for row in self.rows("wanted")}), 4)
        self.make("s", "--make-only", scene=scene, vary=vary)
        kept = self.read("b.obj").decode()
        self.write("b.obj", kept + "# edited\n")
        result = self.sweep("run", self.path("s"), code=1)
        self.assertIn("take 2 (m.file=b.obj, m.density=1): ", result.stderr)
        self.assertIn("b.obj has changed", result.stderr)
        self.assertEqual([row["status"] for row in self.rows()], ["done", "done", "failed", "failed"])
        self.write("b.obj", kept)
        self.sweep("run", self.path("s"), "--retry")
        self.assertEqual(self.table(), self.table("wanted"))

    # Parts, kills, machines.

    def test_parts_in_any_order_give_the_same_table(self):
        wanted = self.undisturbed("--write", "obj")
        self.make("s", "--make-only", "--write", "obj")
        for part in (2, 0, 1):
            out = self.sweep("run", self.path("s"), "--part", f"{part}/3").stdout
            self.assertIn(f"part {part}/3: ", out)
        self.assertFalse(os.path.exists(self.path("s/takes.csv")))
        self.sweep("status", self.path("s"))
        self.assertEqual(self.table(), wanted)
        self.sweep("run", self.path("s"), "--part", "9/10")  # has no take

    def test_two_workers_on_one_part(self):
        wanted = self.undisturbed("--write", "npy")
        self.make("s", "--make-only", "--write", "npy")
        command = [PLIANT, "sweep", "run", self.path("s"), "--threads", "1", "--quiet"]
        workers = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        for worker in workers:
            self.assertEqual(worker.communicate(timeout=120)[1], "")
            self.assertEqual(worker.returncode, 0)
        self.sweep("status", self.path("s"))
        self.assertEqual(self.table(), wanted)
        self.assertEqual(self.read("s/takes/00003.npy"), self.read("undisturbed/takes/00003.npy"))

    def test_a_kill_at_any_moment_loses_only_takes_under_way(self):
        vary = ("--vary", "sheet.density=1..12", "--vary", "sheet.columns=11,41")
        begin = time.monotonic()
        wanted = self.undisturbed("--write", "npy", vary=vary)
        whole = time.monotonic() - begin
        source = random.Random(1)
        runs = 0
        while runs < KILLS:
            name = f"s{runs}"
            scene = self.path("scene.xml")
            first = [PLIANT, "sweep", "run", scene, "-o", self.path(name), *vary, "--write", "npy", "--threads", "2"]
            done = 0
            while runs < KILLS:
                part = source.choice([[], ["--part", "0/2"], ["--part", "1/2"]])
                with subprocess.Popen([*first, *part], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                    time.sleep(source.uniform(0, whole))
                    process.send_signal(signal.SIGKILL)
                runs += 1
                if process.returncode == 0 and not part:
                    break
                lines = self.whole_lines(name)
                self.assertGreaterEqual(lines, done)  # nothing is lost
                done = lines
            self.run_pliant(*first[1:])
            self.assertEqual(self.table(name), wanted)
            for take in (0, 23):
                self.assertEqual(self.read(f"{name}/takes/{take:05}.npy"), self.read(f"undisturbed/takes/{take:05}.npy"))

    def test_an_interrupt_ends_within_a_second_and_keeps_what_ended(self):
        vary = ("--vary", "sheet.density=1..400")
        for number in (signal.SIGINT, signal.SIGTERM):
            name = f"s{number}"
            scene = self.write("scene.xml", edited(end=60, columns=61))
            with subprocess.Popen([PLIANT, "sweep", "run", scene, "-o", self.path(name), *vary, "--write", "npy"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                deadline = time.monotonic() + 60
                while not self.log_size(name) and time.monotonic() < deadline:
                    time.sleep(0.01)
                process.send_signal(number)
                begin = time.monotonic()
                _, errors = process.communicate(timeout=60)
                took = time.monotonic() - begin
            self.assertEqual(process.returncode, 1, errors)
            self.assertIn("takes that ended are kept", errors)
            if not SANITIZED:
                self.assertLess(took, 3)  # a second, on a machine that others use too
            self.assertFalse(glob.glob(self.path(f"{name}/**/.*"), recursive=True))
            self.assertGreater(self.whole_lines(name), 0)

    def test_an_interrupt_ends_the_reading_of_meshes(self):
        os.truncate(self.write("big.obj", ""), 64 << 30)  # needs no disk
        scene = self.write("scene.xml", edited().replace('<grid columns="11" rows="9" width="10" depth="10"/>',
                                                         '<mesh file="big.obj"/>'))
        with subprocess.Popen([PLIANT, "sweep", "run", scene, "-o", self.path("s"), "--vary", "sheet.density=1,2",
                               "--make-only"], stderr=subprocess.PIPE, text=True) as process:
            time.sleep(2)  # it reads by then, and for long
            process.send_signal(signal.SIGINT)
            begin = time.monotonic()
            _, errors = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 1, errors)
        self.assertLess(time.monotonic() - begin, 30 if SANITIZED else 3)
        self.assertFalse(os.path.exists(self.path("s")))

    def test_half_lines_count_for_nothing(self):
        wanted = self.undisturbed()
        self.make("s")
        file = glob.glob(self.path("s/log/*.jsonl"))[0]
        with open(file, "rb") as log:
            text = log.read()
        for cut in random.Random(2).sample(range(len(text)), 5):
            with open(file, "wb") as log:
                log.write(text[:cut])
            os.remove(self.path("s/takes.csv"))
            self.sweep("run", self.path("s"))
            self.assertEqual(self.table(), wanted)
            for other in glob.glob(self.path("s/log/*.jsonl")):
                if other != file:
                    os.remove(other)

    def test_status_counts_though_it_cannot_write_the_table(self):
        self.make("s")
        os.remove(self.path("s/takes.csv"))
        os.mkdir(self.path("s/takes.csv"))
        result = self.sweep("status", self.path("s"), code=2)
        self.assertIn("8 takes, 8 done, 0 failed, 0 missing", result.stdout)
        self.assertIn("takes.csv: error: ", result.stderr)

    def test_a_take_without_its_files_is_run_again(self):
        self.make("s", "--write", "obj")
        kept = self.read("s/takes/00002.0003.obj")
        os.remove(self.path("s/takes/00002.0003.obj"))
        self.assertIn("7 done, 0 failed, 1 missing", self.sweep("status", self.path("s"), code=1).stdout)
        self.sweep("run", self.path("s"))
        self.assertEqual(self.read("s/takes/00002.0003.obj"), kept)

    def test_a_full_disk_ends_the_run_and_loses_nothing(self):
        wanted = self.undisturbed("--write", "npy")
        self.make("s", "--make-only", "--write", "npy")
        size = os.path.getsize(self.path("undisturbed/takes/00000.npy"))
        for limit in (100, 700, size - 1):  # in the log's first line, in its third, in an animation
            with self.subTest(limit=limit):
                limited = self.sweep("run", self.path("s"), code=1, preexec_fn=lambda: resource.setrlimit(
                    resource.RLIMIT_FSIZE, (limit, limit)))
                self.assertIn("cannot write", limited.stderr)
                self.assertFalse(glob.glob(self.path("s/**/.*"), recursive=True))
        self.sweep("run", self.path("s"))
        self.assertEqual(self.table(), wanted)

    def test_a_broken_machine_shows_itself(self):
        self.make("s")
        wanted = self.table()
        with open(glob.glob(self.path("s/log/*.jsonl"))[0], encoding="utf-8") as log:
            line = json.loads(log.readlines()[-1])
        # As a worker with a changed bit writes it.
        changed = {**line, "host": "badnode", "hash": f"{int(line['hash'], 16) ^ 1:032x}"}
        self.write("s/log/badnode.jsonl", json.dumps(changed) + "\n")
        for command in ("status", "run"):
            errors = self.sweep(command, self.path("s"), code=1).stderr
            self.assertIn(f"take {line['take']}: hash differs between ", errors)
            self.assertIn("badnode", errors)
            self.assertIn(line["host"], errors)
        # Alone, it is found by running the take again.
        os.remove(self.path("s/log/badnode.jsonl"))
        self.assertIn("verified", self.sweep("verify", self.path("s")).stdout)
        for file in glob.glob(self.path("s/log/*.jsonl")):
            with open(file, encoding="utf-8") as log:
                text = log.read()
            with open(file, "w", encoding="utf-8") as log:
                log.write(text.replace(line["hash"], changed["hash"]))
        out = self.sweep("verify", self.path("s"), code=1).stdout
        self.assertEqual(out, f"take {line['take']}: hash differs\n")
        baked = self.sweep("bake", self.path("s"), str(line["take"]), "-o", self.path("x.npy"), code=1)
        self.assertIn(f"take {line['take']}: hash differs", baked.stderr)
        self.assertFalse(os.path.exists(self.path("x.npy")))
        self.assertNotEqual(wanted, b"")

    def test_every_kth_take_is_verified(self):
        self.make("s")
        self.assertIn("3 takes verified", self.sweep("verify", self.path("s"), "--every", "3").stdout)
        self.make("none", "--make-only")
        self.assertIn("no take to verify", self.sweep("verify", self.path("none"), code=1).stderr)

    def test_take_numbers_of_bake(self):
        self.make("s", "--frames", "2:5")
        for take in ("8", "-1", "x"):
            self.assertIn("0 to 7", self.sweep("bake", self.path("s"), "--out", self.path("x.npy"), "--", take,
                                               code=2).stderr)
        self.assertIn("4 frames", self.sweep("bake", self.path("s"), "3", "-o", self.path("x.npy")).stdout)
        self.assertIn("2 frames", self.sweep("bake", self.path("s"), "3", "-o", self.path("x.npy"),
                                             "--frames", "1:2").stdout)

    def test_bake_writes_into_no_folder_of_the_sweep(self):
        self.make("s", "--write", "npy")
        kept = self.read("s/takes/00003.npy")
        for name in ("s/takes/00003.npy", "s/takes/other.obj", "s/log/x.npy", "s/../s/takes/00003.npy"):
            message = self.sweep("bake", self.path("s"), "3", "-o", self.path(name), "--frames", "2", code=2).stderr
            self.assertIn("its folder is the sweep's", message)
        self.assertIn("its folder is the sweep's", self.sweep("bake", "..", "3", "-o", "00003.npy", code=2,
                                                              cwd=self.path("s/takes")).stderr)
        self.assertEqual(self.read("s/takes/00003.npy"), kept)
        self.sweep("bake", self.path("s"), "3", "-o", self.path("s/take3.npy"))
        self.assertEqual(self.read("s/take3.npy"), kept)

    def test_threads_and_memory_change_nothing(self):
        wanted = self.undisturbed()
        for options in (["--threads", "7"], ["--threads", "2", "--max-memory", "0.002"]):
            name = "s" + options[1]
            self.make(name, *options)
            self.assertEqual(self.table(name), wanted)


if __name__ == "__main__":
    main()
