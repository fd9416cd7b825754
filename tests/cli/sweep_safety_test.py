"""`pliant sweep` on a full disk, in the folder of a stranger, and with names of any bytes."""

import os
import pty
import shutil
import subprocess

from command import PLIANT, SANITIZED, main
from sweeps import VARY, SweepCommand, edited

FULL = """
set -e
mount -t tmpfs -o size=1m tmpfs "$2"
code=0
"$1" sweep run "$2/../scene.xml" -o "$2/s" --vary sheet.density=1..24 --write npy --quiet 2> "$2/../errors" || code=$?
find "$2/s" -name '.*' > "$2/../hidden"
ls "$2/s/takes" > "$2/../done"
mount -o remount,size=64m "$2"
"$1" sweep run "$2/s" --quiet
cp "$2/s/takes.csv" "$2/s/takes/00023.npy" "$2/.."
exit $code
"""


class SweepSafety(SweepCommand):
    def run_bytes(self, *arguments, **options):
        return subprocess.run([PLIANT, *arguments], capture_output=True, check=False, timeout=300, cwd=self.folder,
                              stdin=subprocess.DEVNULL, **options)

    def test_a_full_disk_ends_the_run_and_more_room_ends_the_sweep(self):
        probe = ["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", self.folder]
        if not shutil.which("unshare") or subprocess.run(probe, capture_output=True, check=False).returncode != 0:
            self.skipTest("no file system can be mounted here")
        scene = self.write("scene.xml", edited(columns=61))
        self.sweep("run", scene, "-o", self.path("wanted"), "--vary", "sheet.density=1..24", "--write", "npy")
        os.mkdir(self.path("disk"))
        done = subprocess.run(["unshare", "-rm", "sh", "-c", FULL, "sh", PLIANT, self.path("disk")],
                              capture_output=True, text=True, check=False, timeout=300)
        errors = self.read("errors").decode()
        self.assertEqual(done.returncode, 1, done.stderr + errors)
        self.assertEqual(errors.count("\n"), 1, errors)
        self.assertIn("No space left on device", errors)
        self.assertEqual(self.read("hidden"), b"")
        self.assertGreater(self.read("done").count(b"\n"), 0)
        self.assertEqual(self.read("takes.csv"), self.table("wanted"))
        self.assertEqual(self.read("00023.npy"), self.read("wanted/takes/00023.npy"))

    def test_a_folder_that_leads_elsewhere_is_not_written_to(self):
        os.mkdir(self.path("elsewhere"))
        for name, target in (("takes", "../elsewhere"), ("log", "../elsewhere"), ("log", "../nowhere")):
            with self.subTest(name=name, target=target):
                self.make("s", "--make-only", "--write", "npy")
                os.symlink(target, self.path(f"s/{name}"))
                errors = self.sweep("run", self.path("s"), "--quiet", code=2).stderr
                self.assertEqual(errors.count("\n"), 1)
                self.assertIn(f"s/{name}: error: is a symbolic link", errors)
                self.assertEqual(os.listdir(self.path("elsewhere")), [])
                self.assertFalse(os.path.lexists(self.path("nowhere")))
                shutil.rmtree(self.path("s"))

    def test_a_file_that_is_too_large_is_refused_unread(self):
        self.make("s", "--make-only")
        os.truncate(self.path("s/sweep.json"), (2 << 30) + 1)  # needs no disk
        for command in ("status", "run", "verify"):
            errors = self.sweep(command, self.path("s"), code=2).stderr
            self.assertEqual(errors.count("\n"), 1)
            self.assertIn("is larger than 2048 MiB", errors)

    def test_what_no_sweep_has_is_refused_in_little_memory(self):
        self.make("s", "--make-only")
        text = self.read("s/sweep.json").decode()
        for old, new, part in (('"version"', '"more": ' + "[" * 1_000_000, "nested more than 200 deep"),
                               ('"axes": [', '"axes": [1,', "is not the file of a sweep"),
                               ('"texts": [', '"texts": [1,', "a member is missing, or has a value of another kind"),
                               ('"engine"', '"motor"', "a member is missing, or has a value of another kind"),
                               ('"texts": [', '"texts": ["1",', "do not belong together"),
                               ('"texts": [', '"texts": [{"texts": ["1"]},', "is not the file of a sweep"),
                               ('"texts": [', '"more": [', "do not belong together")):
            with self.subTest(new=new[:40]):
                self.assertIn(old, text)
                self.write("s/sweep.json", text.replace(old, new, 1))
                errors = self.sweep("status", self.path("s"), code=2).stderr
                self.assertEqual(errors.count("\n"), 1)
                self.assertIn(part, errors)

    def test_a_table_that_is_another_file_is_not_quoted(self):
        scene = self.write("scene.xml", edited())
        for text in ("secret\n1\n", "secret.txt\nsecret\n", "# secret.conf\nsecret=secret.x\n",
                     "secret.a,secret.b\n1,secret\n", "a.secret*,\"secret\n", "sheet.secret\n1\n",
                     "secret.x,secret.x\nsecret,2\n", "\x1b[31msecret.a\n1\n"):
            with self.subTest(text=text):
                table = self.write("table.csv", text)
                errors = self.sweep("run", scene, "-o", self.path("s"), "--takes", table, code=2).stderr
                self.assertEqual(errors.count("\n"), 1, errors)
                self.assertIn(f"--takes {table}", errors)
                self.assertNotIn("secret", errors)
        # One that has a path of the scene is a table, whose mistakes are told.
        for text, part in (("sheet.density,sheet.dampng\n1,2\n", 'did you mean "damping"'),
                           ("sheet.density\n1\nmany\n", 'line 3: sheet.density=many: "many"'),
                           ("sheet.density\n" + "9" * 1_000_000 + "\n", "line 2: sheet.density=999")):
            with self.subTest(text=text[:40]):
                table = self.write("table.csv", text)
                errors = self.sweep("run", scene, "-o", self.path("s"), "--takes", table, code=2).stderr
                self.assertEqual(errors.count("\n"), 1, errors[:1000])
                self.assertIn(part, errors)
                self.assertLess(len(errors), 2000)

    def test_a_log_of_any_size_ends_soon_in_little_memory(self):
        self.make("s")
        limit = "" if SANITIZED else "ulimit -v 4000000; "  # the shadow memory of sanitizers counts too
        for name, head in (("s/log/a.jsonl", b""), ("s/log/b.jsonl", b"{}\n{}\n")):
            with self.subTest(name=name):
                with open(self.path(name), "wb") as file:
                    file.write(head)
                os.truncate(self.path(name), 1 << 40)  # needs no disk
                for command in ("status", "run", "verify"):
                    done = subprocess.run(["sh", "-c", limit + 'exec "$@"', "sh", PLIANT, "sweep", command,
                                           self.path("s")], capture_output=True, text=True, check=False, timeout=100)
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                    self.assertIn(f"{name}:{head.count(10) + 1}: error: this line has NUL bytes", done.stderr)
                os.remove(self.path(name))

    def test_names_that_are_not_utf8_are_refused_ahead_of_all_work(self):
        scene = self.write("scene.xml", edited()).encode()
        folder = self.folder.encode()
        odd = os.path.join(folder, b"od\xe9.xml")
        shutil.copy(scene, odd)
        os.mkdir(os.path.join(folder, b"f\xe9"))
        shutil.copy(scene, os.path.join(folder, b"f\xe9", b"scene.xml"))
        with open(self.path("table.csv"), "wb") as table:
            table.write(b"poke.targets\n\xe9\n")
        vary = [option.encode() for option in VARY]
        before = sorted(os.listdir(folder))
        for arguments, where, part in (
                ([odd, *vary], folder, r"od\xe9.xml: is not UTF-8"),
                ([scene, b"--vary", b"poke.targets=\xe9"], folder, r"--vary poke.targets=\xe9: is not UTF-8"),
                ([scene, *vary, b"--set", b"poke.targets=\xe9"], folder, r"--set poke.targets=\xe9: is not UTF-8"),
                ([scene, *vary, b"--root", b"f\xe9"], folder, r"f\xe9: is not UTF-8"),
                ([scene, b"--takes", self.path("table.csv").encode()], folder, ": the table is not UTF-8"),
                ([b"scene.xml", *vary], os.path.join(folder, b"f\xe9"), "is not UTF-8")):
            with self.subTest(part=part):
                done = subprocess.run([PLIANT.encode(), b"sweep", b"run", *arguments, b"-o",
                                       os.path.join(folder, b"deep", b"s")], capture_output=True, check=False,
                                      cwd=where, timeout=100)
                errors = done.stderr.decode()
                self.assertEqual(done.returncode, 2, errors)
                self.assertEqual(errors.count("\n"), 1)
                self.assertIn(part, errors)
                self.assertEqual(sorted(os.listdir(folder)), before)
        # The folder itself may have any name.
        self.assertEqual(self.run_bytes("sweep", "run", scene, "-o", os.path.join(folder, b"s\xe9"), *VARY).returncode, 0)

    def test_a_dry_run_has_the_bytes_of_the_table(self):
        names = ["one\x1b[31m.xml", 'two\n"2".xml', "drei\u202e.xml"]
        scenes = [self.write(name, edited(end=2)) for name in names]
        plan = self.run_bytes("sweep", "run", *scenes, "-o", self.path("s"), *VARY, "--dry-run")
        self.assertEqual((plan.returncode, plan.stderr), (0, b""))
        self.sweep("run", *scenes, "-o", self.path("s"), *VARY, "--make-only")
        self.sweep("status", self.path("s"), code=1)
        self.assertEqual(plan.stdout, self.table())
        self.assertIn(b"\x1b[31m", plan.stdout)
        # A terminal must not act on them.
        ours, theirs = pty.openpty()
        with subprocess.Popen([PLIANT, "sweep", "run", *scenes, "-o", self.path("t"), *VARY, "--dry-run"],
                              stdout=theirs) as process:
            os.close(theirs)
            shown = b""
            try:
                while piece := os.read(ours, 1 << 16):
                    shown += piece
            except OSError:  # its end
                pass
        os.close(ours)
        self.assertEqual(process.returncode, 0)
        self.assertIn(rb"one\x1b[31m.xml", shown)
        self.assertNotIn(b"\x1b", shown)

    def test_a_failed_take_tells_file_and_line(self):
        self.make("s", vary=("--vary", "sheet.c=-5,2"), code=1)
        errors = self.sweep("status", self.path("s"), code=1).stderr
        error = self.rows()[0]["error"]
        self.assertRegex(error, r"^scene\.xml:\d+: ")
        self.assertEqual(errors, f"take 0 (sheet.c=-5): {self.folder}/{error}\n")
        # Elsewhere the table has the same bytes.
        os.mkdir(self.path("elsewhere"))
        scene = self.write("elsewhere/scene.xml", edited())
        self.sweep("run", scene, "-o", self.path("elsewhere/s"), "--vary", "sheet.c=-5,2", code=1)
        self.assertEqual(self.table("elsewhere/s"), self.table())

    def test_the_memory_of_a_take_is_told(self):
        limits = ("--threads", "2", "--max-memory", "0.8")
        self.assertEqual(self.make("s", *limits).stderr, "2 takes at once, up to 350 MB each\n")
        self.assertEqual(self.make("s", *limits).stderr, "")  # nothing is missing
        self.assertEqual(self.make("quiet", *limits, "--quiet").stderr, "")


if __name__ == "__main__":
    main()
