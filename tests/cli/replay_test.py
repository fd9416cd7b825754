"""`pliant replay`: exit codes, messages and files."""

import json
import os
import signal
import subprocess
import time

from command import Command, PLIANT, main

SCENE = """<?xml version="1.0"?>
<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="13" rows="11" width="12" depth="10"/></surface>
  <surface name="quiet"><grid columns="5" rows="5" width="1" depth="1"/>
    <transform translate="90 0 0"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"
         targets="sheet"/>
</scene>
"""


class Replay(Command):
    def setUp(self):
        super().setUp()
        self.write("scene.xml", SCENE.format(end=8))

    def replay(self, *arguments, code=0, folder=None, **settings):
        return self.run_pliant("replay", *arguments, code=code, cwd=folder or self.folder,
                               env={**os.environ, **settings})

    def lines_of_log(self, name):
        return [json.loads(line) for line in self.read(name).decode("utf-8").splitlines()]

    def test_a_log_is_recorded_and_verified(self):
        told = self.replay("record", "scene.xml", "-o", "run.replay")
        self.assertEqual((told.stdout, told.stderr),
                         ("run.replay: 8 frames, 2 surfaces recorded\n", ""))
        told = self.replay("verify", "run.replay")
        self.assertEqual((told.stdout, told.stderr),
                         ("run.replay: 8 frames, all as recorded\n", ""))
        self.assertEqual(self.replay("verify", "run.replay", "scene.xml", "--quiet").stdout, "")
        self.assertEqual(self.replay("diff", "run.replay", "run.replay").stdout,
                         "run.replay: 8 frames, all equal\n")

    def test_a_log_is_json_that_a_small_script_reads(self):
        self.replay("record", "scene.xml", "-o", "run.replay", "--states", "3")
        head, *frames, end = self.lines_of_log("run.replay")
        self.assertEqual((head["pliant_replay"], head["start"], head["end"]), (1, 1, 8))
        self.assertEqual(head["text"], SCENE.format(end=8))
        self.assertEqual(head["surfaces"][0], {"name": "sheet", "columns": 13, "rows": 11})
        self.assertEqual([frame["frame"] for frame in frames], list(range(1, 9)))
        self.assertEqual(end["frames"], 8)
        self.assertEqual(frames[0]["surfaces"][0]["peak"], 0)
        self.assertGreater(frames[7]["surfaces"][0]["peak"], 0)
        self.assertEqual(frames[7]["surfaces"][1], frames[1]["surfaces"][1])  # nothing acts on it
        with_states = [frame["frame"] for frame in frames if "state" in frame["surfaces"][0]]
        self.assertEqual(with_states, [1, 4, 7])
        state = frames[6]["surfaces"][0]["state"]
        self.assertEqual(len(state["positions"]), 3 * 13 * 11)
        self.assertEqual(len(state["velocities"]), 3 * 13 * 11)

    def test_a_log_has_the_same_bytes_however_it_is_recorded(self):
        self.replay("record", "scene.xml", "-o", "run.replay", "--states", "2")
        for threads in ("1", "2", "3", "8"):
            self.replay("record", "scene.xml", "-o", "again.replay", "--states", "2",
                        "--threads", threads)
            self.assertEqual(self.read("again.replay"), self.read("run.replay"))
        self.replay("record", "scene.xml", "-o", "again.replay", "--states", "2",
                    LC_ALL="de_DE.UTF-8", TZ="Asia/Kolkata")
        self.assertEqual(self.read("again.replay"), self.read("run.replay"))
        self.replay("record", self.path("scene.xml"), "-o", self.path("again.replay"),
                    "--states", "2", folder="/")
        self.assertEqual(self.read("again.replay"), self.read("run.replay"))
        self.replay("verify", self.path("run.replay"), folder="/")

    def test_differences_are_named_and_exit_code_1(self):
        self.replay("record", "scene.xml", "-o", "run.replay", "--states", "1")
        self.write("scene.xml", SCENE.format(end=8).replace('"3000"', '"3000.0000001"'))
        told = self.replay("verify", "run.replay", code=1)
        self.assertRegex(told.stdout, r'\Arun.replay: frame 2: surface "sheet": positions differ, '
                                      r"most at node \(6,5\), by [0-9.e-]+\n\Z")
        self.assertEqual(told.stderr, "run.replay: note: the scene scene.xml was edited; the first "
                                      "change is in line 6\n")
        many = self.replay("verify", "run.replay", "--keep-going", code=1)
        self.assertEqual(many.stdout.splitlines()[0], told.stdout.strip())
        self.assertEqual(many.stdout.count("positions differ"), 7)
        self.replay("record", "scene.xml", "-o", "other.replay", "--states", "1")
        self.assertEqual(self.replay("diff", "run.replay", "other.replay", code=1).stdout,
                         told.stdout)

    def test_logs_that_are_none_are_exit_code_2(self):
        self.replay("record", "scene.xml", "-o", "run.replay")
        sound = self.read("run.replay")
        lines = sound.splitlines(keepends=True)
        flipped = bytearray(sound)
        flipped[len(lines[0]) + len(lines[1]) + 20] ^= 4
        cases = {
            "cut.replay": (b"".join(lines[:5]), r"cut.replay:6: error: .*is truncated.* 4 of 8"),
            "half.replay": (sound[:-40], r"half.replay:10: error: .*is truncated"),
            "flipped.replay": (bytes(flipped), r"flipped.replay:3: error: .*changed after"),
            "later.replay": (b'{"pliant_replay":7,"x":0}\n', r"later.replay:1: error: .*format 7"),
            "empty.replay": (b"", r"empty.replay: error: this is not a replay log"),
            "scene.replay": (SCENE.encode(), r"scene.replay: error: this is not a replay log"),
        }
        for name, (content, message) in cases.items():
            with self.subTest(name):
                with open(self.path(name), "wb") as file:
                    file.write(content)
                for told in (self.replay("verify", name, code=2),
                             self.replay("diff", name, "run.replay", code=2),
                             self.replay("diff", "run.replay", name, code=2)):
                    self.assertRegex(told.stderr, message)
                    self.assertEqual(told.stdout, "")
                    self.assertEqual(told.stderr.count("\n"), 1)
        self.assertIn("missing.replay", self.replay("verify", "missing.replay", code=2).stderr)

    def test_the_scene_of_a_log_is_within_the_root(self):
        for folder in ("in", "secret"):
            os.mkdir(self.path(folder))
        scene = self.read("scene.xml").decode()
        self.write("secret/s.xml", scene)
        self.replay("record", "secret/s.xml", "-o", "in/x.replay")
        self.replay("verify", "in/x.replay")
        self.write("secret/s.xml", scene.replace("<point", "<point password='hunter2'"))
        told = self.replay("verify", "in/x.replay", "--root", "in", code=2)
        self.assertIn("outside", told.stderr)
        self.assertNotIn("password", told.stderr)
        # Nor does it tell whether such a file is there.
        os.remove(self.path("secret/s.xml"))
        self.assertEqual(self.replay("verify", "in/x.replay", "--root", "in", code=2).stderr, told.stderr)
        self.replay("verify", "in/x.replay", "--root", ".")

    def test_wrong_usage_is_exit_code_2(self):
        for arguments in (["record"], ["record", "scene.xml"], ["verify"], ["diff", "a"],
                          ["record", "scene.xml", "-o", "a.replay", "--states", "0"],
                          ["record", "scene.xml", "-o", "a.replay", "--states", "1.5"],
                          ["record", "scene.xml", "-o", "a.replay", "--last", "x"],
                          ["record", "scene.xml", "-o", "a.replay", "--last", "9"],
                          ["record", "missing.xml", "-o", "a.replay"],
                          ["record", "scene.xml", "-o", "scene.xml"],
                          ["record", "scene.xml", "-o", "/dev/null"],
                          ["verify", "a.replay", "--threads", "0"]):
            with self.subTest(arguments):
                told = self.replay(*arguments, code=2)
                self.assertEqual(told.stderr.count("\n"), 1)
                self.assertIn("error: ", told.stderr)
        self.assertIn("record", self.replay(code=2).stderr)  # bare: its help
        self.assertEqual(os.listdir(self.folder), ["scene.xml"])

    def test_a_disk_that_refuses_is_exit_code_1(self):
        told = self.replay("record", "scene.xml", "-o", "no/such/folder.replay", code=1)
        self.assertEqual(told.stderr, "pliant: error: -o no/such/folder.replay: the folder no/such does not exist\n")

    def test_ctrl_c_leaves_nothing(self):
        self.write("long.xml", SCENE.format(end=10**6))
        process = subprocess.Popen([PLIANT, "replay", "record", "long.xml", "-o", "long.replay"],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        for _ in range(600):
            if any("long.replay" in name for name in os.listdir(self.folder)):
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, output), (1, ""), errors)
        self.assertIn("interrupted", errors)
        self.assertEqual(sorted(os.listdir(self.folder)), ["long.xml", "scene.xml"])


if __name__ == "__main__":
    main()
