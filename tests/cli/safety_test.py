"""The files left, complete and on the disk, after a command is killed, the disk fails or the power
fails."""

import errno
import hashlib
import json
import os
import random
import re
import signal
import subprocess
import time

from command import Command, PLIANT, SANITIZED, SCENE, SHIM, main


class Flushes(Command):
    """The system calls that flush and rename, and their order."""

    def setUp(self):
        super().setUp()
        if not SHIM:
            self.skipTest("the shim does not go with a sanitizer")

    def events(self, *arguments, fail=None, code=0):
        """The run's flushes and renames, with names without the folder; and its stderr."""
        log = self.path("shim.log")
        environment = {**os.environ, "LD_PRELOAD": SHIM, "PLIANT_SHIM_LOG": log}
        if fail:
            environment["PLIANT_SHIM_FAIL"] = fail
        result = self.run_pliant(*arguments, code=code, env=environment)
        lines = []
        if os.path.exists(log):
            with open(log, encoding="utf-8") as file:
                lines = [line.rstrip("\n").replace(os.path.realpath(self.folder), "DIR") for line in file]
            os.remove(log)
        return lines, result.stderr

    def check_order(self, events, name):
        """Checks that the part is flushed, then renamed to that name, then the folder is
        flushed."""
        renames = [k for k, event in enumerate(events)
                   if re.fullmatch(rf"rename DIR/(\S+\.part) to DIR/{name}", event)]
        self.assertEqual(len(renames), 1, (name, events))
        part = re.search(r"rename (\S+)", events[renames[0]]).group(1)
        self.assertIn(f"flush file {part}", events[:renames[0]], name)
        self.assertIn("flush folder DIR", events[renames[0]:], name)

    def test_every_output_is_flushed_ahead_of_its_rename_and_the_folder_after(self):
        scene = self.scene(end=4)
        digits = r"\.[0-9a-f]{16}\.bin"
        outputs = ((".npy", [r"a\.npy"]), (".pc2", [r"a\.obj", r"a\.pc2"]), (".mdd", [r"a\.obj", r"a\.mdd"]),
                   (".glb", [r"a\.glb"]), (".gltf", ["a" + digits, r"a\.gltf"]), (".usda", [r"a\.usda"]),
                   (".obj", [rf"a\.000{k}\.obj" for k in range(1, 5)]),
                   (".ply", [rf"a\.000{k}\.ply" for k in range(1, 5)]))
        for ending, names in outputs:
            events, _ = self.events("bake", scene, "-o", "a" + ending)
            for name in names:
                self.check_order(events, name)
            self.assertEqual(sum(event.startswith("rename") for event in events), len(names), ending)
        for arguments, names in ((["replay", "record", scene, "-o", "a.replay"], [r"a\.replay"]),
                                 (["curves", scene, "-o", "a.csv"], [r"a\.csv"]),
                                 (["bake", scene, "-o", "b.npy", "--regions", "r.json"],
                                  [r"b\.npy", r"r\.json"])):
            events, _ = self.events(*arguments)
            for name in names:
                self.check_order(events, name)

    def test_the_numbers_of_a_gltf_are_on_the_disk_before_it_names_them(self):
        events, _ = self.events("bake", self.scene(end=3), "-o", "a.gltf")
        kinds = [re.sub(r"DIR/\.a\.gltf\.\S+\.part", "PART", re.sub(r"[0-9a-f]{16}", "HASH", event))
                 for event in events]
        self.assertEqual(kinds, ["flush file PART", "rename PART to DIR/a.HASH.bin", "flush folder DIR",
                                 "flush file PART", "rename PART to DIR/a.gltf", "flush folder DIR"])

    def test_frames_that_are_kept_are_flushed_too(self):
        scene = self.scene(end=4)
        self.run_pliant("bake", scene, "-o", "a.obj", "--frames", "1:2")
        events, _ = self.events("bake", scene, "-o", "a.obj", "--resume")
        self.assertEqual(events[:2], ["flush file DIR/a.0001.obj", "flush file DIR/a.0002.obj"])
        self.assertEqual(events[-1], "flush folder DIR")

    def test_a_cache_is_not_flushed(self):
        events, _ = self.events("bake", self.scene(end=6), "-o", "a.npy", "--cache", "kept")
        self.assertGreater(sum("kept" in event for event in events), 3)
        self.assertEqual([event for event in events if "kept" in event and event.startswith("flush")], [])

    def test_a_flush_that_fails_is_an_error_and_leaves_what_was_there(self):
        scene = self.scene(end=3)
        for number in (errno.EIO, errno.ENOSPC):
            for out in ("a.npy", "a.glb", "a.gltf", "a.usda", "a.pc2", "a.replay", "a.csv"):
                self.write(out, "old")
                before = self.files()
                command = {"a.replay": ["replay", "record"], "a.csv": ["curves"]}.get(out, ["bake"])
                _, errors = self.events(*command, scene, "-o", out, fail=f"file {number}", code=1)
                self.assertRegex(errors, rf"a\.\w+: error: cannot write the file: {os.strerror(number)}\n")
                self.assertEqual(self.files(), before)
                self.assertEqual(self.read(out), b"old")
        _, errors = self.events("bake", scene, "-o", "a.obj", fail=f"file {errno.EIO}", code=1)
        self.assertIn("a.0001.obj: error: cannot write the file: Input/output error", errors)

    def test_a_folder_that_cannot_be_flushed(self):
        scene = self.scene(end=3)
        for out in ("a.npy", "a.obj", "a.gltf"):
            for number in (errno.EINVAL, errno.EOPNOTSUPP):  # the file system does not support it
                self.events("bake", scene, "-o", out, fail=f"folder {number}")
                self.events("bake", scene, "-o", out, fail=f"file {number}")
            _, errors = self.events("bake", scene, "-o", out, fail=f"folder {errno.EIO}", code=1)
            self.assertIn("error: cannot write the file: Input/output error", errors)

    def test_a_flush_that_is_interrupted_is_done_again(self):
        scene = self.scene(end=3)
        for kind in ("file", "folder"):
            events, _ = self.events("bake", scene, "-o", "a.npy", fail=f"{kind} {errno.EINTR}")
            self.check_order(events, r"a\.npy")


class Killed(Command):
    def whole(self, name):
        """The contents of a .gltf, or None if its files do not belong together."""
        with open(self.path(name), encoding="utf-8") as file:
            text = file.read()
        buffer = json.loads(text)["buffers"][0]
        numbers = self.read(buffer["uri"])
        self.assertEqual(len(numbers), buffer["byteLength"])
        return hashlib.sha256(text.encode() + numbers).hexdigest()

    def numbers(self):
        return [name for name in self.files() if re.fullmatch(r"a\.[0-9a-f]{16}\.bin", name)]

    def test_a_gltf_and_its_numbers_belong_together_whenever_it_is_killed(self):
        scenes = [self.write(f"{k}.xml", SCENE.format(end=12).replace("3000", str(3000 + k)))
                  for k in range(2)]
        known = set()
        for scene in scenes:
            self.run_pliant("bake", scene, "-o", "a.gltf")
            known.add(self.whole("a.gltf"))
        self.assertEqual(len(known), 2)
        self.assertEqual(len(self.numbers()), 1)
        begin = time.monotonic()
        self.run_pliant("bake", scenes[0], "-o", "a.gltf")
        length = time.monotonic() - begin
        chance = random.Random(1)
        seen, ended = set(), 0
        for k in range(30 if SANITIZED else 150):
            with subprocess.Popen([PLIANT, "bake", scenes[k % 2], "-o", "a.gltf", "--quiet"],
                                  cwd=self.folder, stderr=subprocess.DEVNULL) as process:
                time.sleep(chance.uniform(0.3, 1.1) * length)
                process.kill()
                ended += process.wait() == 0
            seen.add(self.whole("a.gltf"))
            self.assertIn(self.whole("a.gltf"), known)
        self.assertLess(ended, k + 1)
        self.run_pliant("bake", scenes[0], "-o", "a.gltf")
        self.assertLessEqual(len(self.numbers()), 2)  # those of a killed bake may stay, old ones do not

    def test_killed_ahead_of_each_flush_and_rename_a_gltf_is_whole(self):
        if not SHIM:
            self.skipTest("the shim does not go with a sanitizer")
        scenes = [self.write(f"{k}.xml", SCENE.format(end=4).replace("3000", str(3000 + k)))
                  for k in range(2)]
        self.run_pliant("bake", scenes[1], "-o", "a.gltf")
        new = self.whole("a.gltf")
        for event in range(1, 20):
            self.run_pliant("bake", scenes[0], "-o", "a.gltf")
            old = self.whole("a.gltf")
            self.assertLessEqual(len(self.numbers()), 2)
            result = subprocess.run([PLIANT, "bake", scenes[1], "-o", "a.gltf"], cwd=self.folder, check=False,
                                    capture_output=True, env={**os.environ, "LD_PRELOAD": SHIM,
                                                              "PLIANT_SHIM_KILL": str(event)})
            self.assertIn(self.whole("a.gltf"), (old, new))
            if result.returncode == 0:
                break
            self.assertEqual(result.returncode, -signal.SIGKILL)
        self.assertEqual(event, 7)  # a flush, a rename and a flush of the folder for each of two files

    def test_two_bakes_to_one_gltf_do_not_take_each_others_numbers(self):
        scenes = [self.write(f"{k}.xml", SCENE.format(end=8).replace("3000", str(3000 + k)))
                  for k in range(4)]
        for _ in range(3 if SANITIZED else 12):
            processes = [subprocess.Popen([PLIANT, "bake", scene, "-o", "a.gltf", "--quiet"],
                                          cwd=self.folder) for scene in scenes]
            for process in processes:
                self.assertEqual(process.wait(timeout=120), 0)
            self.whole("a.gltf")
            self.assertEqual(len(self.numbers()), 1)


class Resumed(Command):
    KEYS = ('<animate attribute="magnitude"><key frame="1" value="0"/><key frame="20" value="{}"/>'
            '<key frame="40" value="0"/></animate></point>')

    def resume(self, scene, out):
        text = self.run_pliant("bake", scene, "-o", out, "--resume").stdout
        return tuple(map(int, re.search(r", (\d+) files? kept, (\d+) written\n$", text).groups()))

    def test_nothing_stale_empty_or_damaged_is_kept(self):
        scene_text = SCENE.format(end=40).replace(' magnitude="3000"/>', ">" + self.KEYS)
        scene = self.write("s.xml", scene_text.format(3000))
        for ending in (".obj", ".ply"):
            name = lambda frame: f"a.{frame:04}{ending}"
            self.run_pliant("bake", scene, "-o", "a" + ending)
            whole = {frame: self.read(name(frame)) for frame in range(1, 41)}
            self.assertEqual(self.resume(scene, "a" + ending), (40, 0))
            with open(self.path(name(7)), "wb"):  # cut to nothing
                pass
            with open(self.path(name(9)), "ab") as file:
                file.write(b"\n")
            damaged = bytearray(whole[11])
            damaged[len(damaged) // 2] ^= 1
            with open(self.path(name(11)), "wb") as file:
                file.write(damaged)
            os.remove(self.path(name(13)))
            os.remove(self.path(name(40)))
            self.assertEqual(self.resume(scene, "a" + ending), (35, 5))
            for frame, data in whole.items():
                self.assertEqual(self.read(name(frame)), data, frame)

    def test_a_key_in_the_middle_counts(self):
        # At rest at both ends, so that both scenes have the same first and last frame.
        text = SCENE.format(end=12).replace(' magnitude="3000"/>', (
            '><animate attribute="magnitude"><key frame="1" value="0"/><key frame="5" value="{}"/>'
            '<key frame="9" value="0"/></animate></point>')).replace(
            "</surface>", '<material density="0" damping="1e-6"/></surface>')
        scene = self.write("s.xml", text.format(3000))
        self.run_pliant("bake", scene, "-o", "a.obj")
        before = [self.read(f"a.{k:04}.obj") for k in range(1, 13)]
        self.write("s.xml", text.format(4000))
        kept, written = self.resume(scene, "a.obj")
        self.run_pliant("bake", scene, "-o", "b.obj")
        after = [self.read(f"b.{k:04}.obj") for k in range(1, 13)]
        self.assertEqual([self.read(f"a.{k:04}.obj") for k in range(1, 13)], after)
        self.assertEqual(written, sum(a != b for a, b in zip(before, after)))
        self.assertEqual(kept + written, 12)
        self.assertGreater(written, 0)
        self.assertEqual(before[0], after[0])

    def test_with_a_cache_too(self):
        scene = self.scene(end=10)
        self.run_pliant("bake", scene, "-o", "a.obj", "--cache", "kept")
        os.truncate(self.path("a.0004.obj"), 0)
        text = self.run_pliant("bake", scene, "-o", "a.obj", "--cache", "kept", "--resume").stdout
        self.assertRegex(text, r", 9 files kept, 1 written, 0 frames solved, 9 read\n$")


if __name__ == "__main__":
    main()
