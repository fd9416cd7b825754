"""`pliant sweep run --engine slurm` against programs that stand for Slurm's; tests/sweep/slurm_test.py has the real ones."""

import contextlib
import csv
import glob
import io
import json
import os
import pty
import re
import shlex
import shutil
import signal
import subprocess
import time

from command import PLIANT, SANITIZED, Command, main

SCENE = """<scene version="1" start="1" end="4">
  <surface name="sheet"><grid columns="{columns}" rows="9" width="10" depth="10"/><material c="{c}"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2.5" magnitude="900"/>
</scene>
"""

# Notes its arguments; prints the file of its name and ends with the number in NAME.code. Each run of
# squeue takes the next of squeue.1, squeue.2, … as long as there are some.
PROGRAM = """#!/bin/bash
here=$(dirname "$0"); name=$(basename "$0")
printf '%s\\0' "$@" >>"$here/$name.arguments"; printf '\\n' >>"$here/$name.arguments"
turn=$(($(cat "$here/$name.turn" 2>/dev/null || echo 0) + 1)); echo $turn >"$here/$name.turn"
[ -e "$here/$name.$turn" ] && exec bash "$here/$name.$turn"
[ -e "$here/$name.text" ] && cat "$here/$name.text"
[ -e "$here/$name.errors" ] && cat "$here/$name.errors" >&2
exit "$(cat "$here/$name.code" 2>/dev/null || echo 0)"
"""


class Slurm(Command):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("bin"))
        for name in ("sbatch", "squeue", "scontrol", "scancel"):
            self.write(f"bin/{name}", PROGRAM)
            os.chmod(self.path(f"bin/{name}"), 0o755)
        self.write("bin/sbatch.text", "123\n")
        self.write("bin/scontrol.text", "SlurmctldPort           = 6817\nMaxArraySize            = 1001\n")
        self.environment = {**os.environ, "PATH": f"{self.path('bin')}:/usr/bin:/bin"}

    def sweep(self, *arguments, code=0, **options):
        return self.run_pliant("sweep", *arguments, code=code, env=self.environment, **options)

    def submit(self, *options, name="s", vary=("--vary", "sheet.density=1..12"), code=0, c=2):
        scene = self.write("scene.xml", SCENE.format(columns=11, c=c))
        return self.sweep("run", scene, "-o", self.path(name), *vary, "--engine", "slurm", *options, code=code)

    def runs(self, program):
        """The arguments of each run of a program."""
        try:
            lines = self.read(f"bin/{program}.arguments").decode().split("\0\n")[:-1]
        except FileNotFoundError:
            return []
        return [line.split("\0") for line in lines]

    def job(self, name="s"):
        return self.read(f"{name}/slurm/job.sh").decode()

    def log(self, name, takes, seconds=0.01, status="done"):
        """Lines of the log as a worker writes them."""
        os.makedirs(self.path(f"{name}/log"), exist_ok=True)
        measures = {"peak": 1, "peakFrame": 1, "final": 1, "rms": 1, "speed": 1, "energy": 1, "settle": 1,
                    "hash": "0" * 32}
        what = measures if status == "done" else {"error": "it failed"}
        with open(self.path(f"{name}/log/worker.jsonl"), "a", encoding="utf-8") as log:
            for take in takes:
                log.write(json.dumps({"take": take, "status": status, **what, "seconds": seconds, "host": "n1",
                                      "time": "2026-11-24T10:45:00.123Z"}) + "\n")

    def array(self):
        return next(word.removeprefix("--array=") for word in self.runs("sbatch")[-1] if word.startswith("--array="))

    # What is submitted.

    def test_take_0_runs_here_and_the_rest_is_submitted(self):
        out = self.submit("--sbatch", "--partition=short", "--sbatch=--nice").stdout
        script = self.path("s/slurm/job.sh")
        line = ["--parsable", "--array=0", "--partition=short", "--nice", script]
        self.assertEqual(out, f"submitted 123: 1 parts, 11 takes\nsbatch {shlex.join(line)}\n")
        self.assertEqual(self.runs("sbatch"), [line])
        out = self.sweep("status", self.path("s"), code=1).stdout
        self.assertIn("1 done, 0 failed, 11 missing", out)
        pattern = "\n".join([
            "#!/bin/bash", "#SBATCH --job-name=pliant-s", "#SBATCH --requeue", "#SBATCH --open-mode=append",
            f"#SBATCH --output={self.path('s')}/slurm/%A_%a.log", "#SBATCH --cpus-per-task=1", r"#SBATCH --mem=(\d+)M",
            "#SBATCH --time=30",
            f"exec {PLIANT} sweep run {self.path('s')} --part $SLURM_ARRAY_TASK_ID/1 "
            "--threads $SLURM_CPUS_PER_TASK --quiet", ""])
        pattern = re.escape(pattern).replace(re.escape(r"(\d+)"), r"(\d+)")
        self.assertRegex(self.job(), f"^{pattern}$")

    def test_a_part_takes_ten_minutes_by_the_time_of_take_0(self):
        for seconds, threads, parts, minutes in [(49, 1, 1, 40), (600, 1, 12, 40), (150, 1, 3, 40), (151, 1, 4, 31),
                                                 (150, 3, 1, 40), (1e6, 1, 12, 66667), (1e-6, 1, 1, 30)]:
            with self.subTest(seconds=seconds, threads=threads):
                name = f"s{seconds}-{threads}"
                self.submit("--no-submit", "--parts", "1", name=name)  # makes it without running take 0
                self.log(name, [0], seconds)
                self.sweep("run", self.path(name), "--engine", "slurm", "--no-submit", "--threads", str(threads))
                self.assertIn(f"--part $SLURM_ARRAY_TASK_ID/{parts} ", self.job(name))
                self.assertIn(f"\n#SBATCH --time={minutes}\n", self.job(name))
                self.assertIn(f"\n#SBATCH --cpus-per-task={threads}\n", self.job(name))

    def test_a_time_that_cannot_be(self):
        for seconds, time_limit in [(-5, None), (-1e300, None), (1e300, 525600)]:
            name = f"s{seconds}"
            self.submit("--no-submit", "--parts", "1", name=name)
            self.log(name, [0], seconds)  # by a clock that was set back, or by nobody's
            self.sweep("run", self.path(name), "--engine", "slurm", "--no-submit")
            self.assertEqual(re.findall(r"--time=(\d+)", self.job(name)), [str(time_limit)] if time_limit else [])

    def test_arrays_end_where_slurm_ends_them(self):
        self.write("bin/scontrol.text", "MaxArraySize            = 5\n")
        errors = self.submit("--parts", "6", code=2).stderr
        self.assertIn("--parts 6: must be at most 5, Slurm's MaxArraySize", errors)
        self.assertFalse(os.path.exists(self.path("s")))
        self.submit("--parts", "5")
        self.assertEqual(self.array(), "0-4")
        self.log("s", [0], 1e5)
        self.sweep("run", self.path("s"), "--engine", "slurm")
        self.assertEqual(self.array(), "0-4")
        self.write("bin/scontrol.text", "MaxArraySize            = 0\n")
        self.assertIn("no job arrays", self.sweep("run", self.path("s"), "--engine", "slurm", code=1).stderr)

    def test_parts_set_their_number_and_no_take_runs_here(self):
        for parts, rule in [("13", "at most 12, the number of takes"), ("0", ">= 1"), ("-1", ">= 1"), ("2.5", ">= 1"),
                            ("x", ">= 1")]:
            self.assertIn(f"--parts {parts}: ", self.submit(f"--parts={parts}", code=2).stderr)
            self.assertFalse(os.path.exists(self.path("s")))
        self.assertIn("submitted 123: 12 parts, 12 takes\n", self.submit("--parts", "12").stdout)
        self.assertFalse(os.path.exists(self.path("s/log")))
        self.assertNotIn("--time", self.job())
        self.assertIn("--parts 13", self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "13", code=2).stderr)
        self.log("s", [0], 7 * 60)  # was timed elsewhere
        self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "4")
        self.assertIn("#SBATCH --time=84\n", self.job())

    def test_only_parts_that_lack_a_take_are_listed(self):
        self.submit("--parts", "6", "--no-submit")
        self.log("s", [0, 6, 1, 2, 8, 5, 11])
        out = self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "6").stdout
        self.assertEqual(self.array(), "1,3-4")
        self.assertIn("submitted 123: 3 parts, 5 takes\n", out)
        # Parts of another number are other takes.
        out = self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "5").stdout
        self.assertEqual(self.array(), "0,2-4")
        self.assertIn("submitted 123: 4 parts, 5 takes\n", out)

    def test_failed_takes_are_submitted_with_retry(self):
        self.submit("--parts", "6", "--no-submit")
        self.log("s", [0, 6, 2, 8, 4, 10, 5, 11, 3, 9])
        self.log("s", [1], status="failed")
        out = self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "12").stdout
        self.assertEqual((self.array(), out.splitlines()[0]), ("7", "submitted 123: 1 parts, 1 takes"))
        self.assertNotIn("--retry", self.job())
        out = self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "12", "--retry").stdout
        self.assertEqual((self.array(), out.splitlines()[0]), ("1,7", "submitted 123: 2 parts, 2 takes"))
        self.assertTrue(self.job().endswith(" --quiet --retry\n"))
        self.log("s", [7])
        failed = self.sweep("run", self.path("s"), "--engine", "slurm", code=1)
        self.assertIn("11 done, 1 failed, 0 missing", failed.stdout)
        self.assertIn("it failed", failed.stderr)

    def test_a_list_of_parts_is_no_longer_than_slurm_takes(self):
        self.write("bin/scontrol.text", "MaxArraySize            = 4000001\n")
        vary = ("--vary", "sheet.density=1..50000")
        self.submit("--parts", "50000", "--no-submit", vary=vary)
        missing = {*range(0, 20000, 2), *range(20000, 50000, 500)}
        self.log("s", [take for take in range(50000) if take not in missing])
        out = self.sweep("run", self.path("s"), "--engine", "slurm", "--parts", "50000").stdout
        # What is near each other is joined, what is not stands alone.
        listed = "0-20000," + ",".join(map(str, range(20500, 50000, 500)))
        self.assertEqual(self.array(), listed)
        self.assertIn("submitted 123: 20060 parts, 10060 takes\n", out)

    def test_options_of_the_user_win(self):
        self.submit("--parts", "6", "--sbatch=--mem-per-cpu=2G")  # which sbatch takes only without --mem
        self.assertNotIn("--mem", self.job())
        self.submit("--parts", "6", "--sbatch", "-p", "--sbatch", "short", "--sbatch", "--qos", "--sbatch", "low")
        self.assertEqual(self.runs("sbatch")[-1][2:6], ["-p", "short", "--qos", "low"])
        out = self.submit("--parts", "6", "--sbatch=--array=0-1,5%2", "--quiet").stdout
        self.assertIn("submitted 123: 3 parts, 6 takes\n", out)
        line = self.runs("sbatch")[-1]
        self.assertLess(line.index("--array=0-5"), line.index("--array=0-1,5%2"))

    def test_a_list_of_the_user_names_parts_that_are_there(self):
        for listed, part in [("1-3", 3), ("0,7", 7), ("0-9:4%2", 8)]:
            for words in ([f"--sbatch=--array={listed}"], ["--sbatch=--array", f"--sbatch={listed}"], [f"--sbatch=-a{listed}"]):
                errors = self.submit("--parts", "3", *words, code=2).stderr
                self.assertIn(f"--array={listed}: there is no part {part}; the parts are 0 to 2", errors)
        self.submit("--parts", "3", "--sbatch=--array=0-2:2%1")
        self.assertEqual(len(self.runs("sbatch")), 1)

    def test_a_limit_of_memory_is_that_of_the_parts_too(self):
        self.submit("--parts", "3", "--no-submit", "--max-memory", "0.75")
        self.assertTrue(self.job().endswith(" --quiet --max-memory 0.75\n"), self.job())

    def test_a_part_stays_within_the_memory_of_its_job(self):
        self.submit("--parts", "12", "--no-submit")
        megabytes = {}
        for variables in [{}, {"SLURM_MEM_PER_NODE": "400"}, {"SLURM_MEM_PER_CPU": "200", "SLURM_CPUS_ON_NODE": "2"},
                          {"SLURM_MEM_PER_NODE": "82"}]:
            told = self.run_pliant("sweep", "run", self.path("s"), "--part", f"{len(megabytes)}/12", "--threads", "1",
                                   env={**self.environment, "SLURM_JOB_ID": "1", **variables}).stderr
            amount, unit = re.match(r"1 take at once, up to ([\d.]+) (MB|GB) each\n", told).groups()
            megabytes[tuple(variables.values())] = float(amount) * {"MB": 1, "GB": 1000}[unit]
        of_job = 0.875 * (0.8 * 400 - 64) * 1.048576
        self.assertAlmostEqual(megabytes["400",], of_job, delta=2)
        self.assertAlmostEqual(megabytes["200", "2"], of_job, delta=2)
        self.assertLess(megabytes["82",], 40)
        if not SANITIZED:
            self.assertGreater(megabytes[()], of_job)

    def test_settings_of_the_shell_do_not_disturb(self):
        # Of a shell within another job, too.
        self.environment.update({"SBATCH_WAIT": "1", "SLURM_MEM_PER_NODE": "7", "SLURM_MEM_PER_CPU": "7",
                                 "SBATCH_PARTITION": "mine", "SCANCEL_INTERACTIVE": "1"})
        for program in ("sbatch", "scancel"):
            self.write(f"bin/{program}", PROGRAM.replace("here=", f"env >{self.path(program + '.env')}; here=", 1))
        self.write("bin/squeue.2", f"echo '122|PENDING|{self.path('s/slurm/job.sh')}'")  # so that it is cancelled
        self.submit("--parts", "3", code=1)
        names = {line.split("=")[0] for line in self.read("sbatch.env").decode().splitlines()}
        self.assertIn("SBATCH_PARTITION", names)
        self.assertFalse(names & {"SBATCH_WAIT", "SLURM_MEM_PER_NODE", "SLURM_MEM_PER_CPU"})
        self.assertNotIn(b"SCANCEL_", self.read("scancel.env"))

    def test_memory_grows_with_takes_and_threads(self):
        def memory(*options, vary):
            self.submit("--parts", "1", "--no-submit", *options, name="m", vary=vary)
            megabytes = int(re.search(r"--mem=(\d+)M", self.job("m"))[1])
            subprocess.run(["rm", "-r", self.path("m")], check=True)
            return megabytes
        small = memory(vary=("--vary", "sheet.columns=11"))
        large = memory(vary=("--vary", "sheet.columns=11,11001"))
        self.assertGreater(large, small + 20)
        more = memory("--threads", "4", vary=("--vary", "sheet.columns=11,11001"))
        self.assertGreater(more, large + 3 * (large - small) - 4)
        self.assertLess(more, large + 3 * (large - small) + 4)
        limited = memory("--threads", "4", "--max-memory", "0.01", vary=("--vary", "sheet.columns=11,11001"))
        self.assertLess(limited, small + 15)

    def test_the_script_runs_its_part_whatever_its_name(self):
        name = "it's 50% \"x\" $HOME;#&"
        self.submit("--parts", "5", name=name)
        script = self.runs("sbatch")[-1][-1]
        self.assertEqual(script, self.path(f"{name}/slurm/job.sh"))
        for part in range(5):
            subprocess.run(["bash", script], check=True, env={"SLURM_ARRAY_TASK_ID": str(part), "SLURM_CPUS_PER_TASK": "1"})
        self.assertIn("12 done", self.sweep("status", self.path(name)).stdout)
        subprocess.run(["bash", "-n", script], check=True)
        for wrong in ("a\nb", "a\tb", "a\\b"):
            errors = self.submit("--parts", "5", name=wrong, code=2).stderr
            self.assertIn("for --engine slurm", errors)
            self.assertEqual(errors.count("\n"), 1)
            self.assertFalse(os.path.exists(self.path(wrong)))

    def test_a_folder_is_named_by_its_absolute_path(self):
        os.mkdir(self.path("real"))
        os.symlink(self.path("real"), self.path("link"))
        self.submit("--parts", "5", name="real/../link/./s/")
        self.assertEqual(self.runs("sbatch")[-1][-1], self.path("real/s/slurm/job.sh"))
        self.sweep("run", "link/./s/", "--engine", "slurm", "--parts", "5")
        self.assertEqual(self.runs("sbatch")[-1][-1], self.path("link/s/slurm/job.sh"))
        self.assertIn(f"{self.path('link/s')} --part", self.job("link/s"))
        self.assertIn("--job-name=pliant-s\n", self.job("link/s"))

    def test_a_link_leads_nowhere_else(self):
        self.submit("--parts", "3", "--no-submit")
        os.rename(self.path("s/slurm"), self.path("elsewhere"))
        os.remove(self.path("elsewhere/job.sh"))
        os.symlink(self.path("elsewhere"), self.path("s/slurm"))
        self.submit("--parts", "3", code=2)
        self.assertEqual((os.listdir(self.path("elsewhere")), self.runs("sbatch")), ([], []))

    def test_what_is_written_only_needs_no_slurm(self):
        self.environment["PATH"] = "/nowhere"
        out = self.submit("--no-submit").stdout
        self.assertEqual(out, f"sbatch --parsable --array=0 {self.path('s/slurm/job.sh')}\n")
        self.assertIn("at most 12", self.submit("--no-submit", "--parts", "13", code=2).stderr)

    # What is not submitted.

    def test_wrong_usage(self):
        for options, parts in [
                (["--engine", "pbs"], ["--engine"]),
                (["--engine", "slurm", "--part", "0/2"], ["--part: ", "--engine slurm"]),
                (["--engine", "slurm", "--make-only"], ["--engine: ", "--make-only"]),
                (["--engine", "slurm", "--dry-run"], ["--engine: ", "--dry-run"]),
                (["--engine", "slurm", "--no-submit", "--wait"], ["--wait: ", "--no-submit"]),
                (["--parts", "3"], ["--parts: needs --engine slurm"]),
                (["--sbatch=--nice"], ["--sbatch: needs --engine slurm"]),
                (["--no-submit"], ["--no-submit: needs --engine slurm"]),
                (["--wait"], ["--wait: needs --engine slurm"]),
                (["--engine", "slurm", "--sbatch=--wait"], ["--sbatch --wait: "]),
                (["--engine", "slurm", "--sbatch=-W"], ["--sbatch --wait: "]),
                # sbatch would submit that file.
                (["--engine", "slurm", "--sbatch", "short"], ["--sbatch short: is not an option of sbatch"]),
                (["--engine", "slurm", "--sbatch=-pshort", "--sbatch", "x"], ["--sbatch x: is not an option"]),
                (["--engine", "slurm", "--sbatch=--", "--sbatch", "x"], ["--sbatch --: is not an option"])]:
            with self.subTest(options=options):
                scene = self.write("scene.xml", SCENE.format(columns=11, c=2))
                errors = self.sweep("run", scene, "-o", self.path("s"), "--vary", "sheet.c=1,2", *options, code=2).stderr
                self.assertEqual(errors.count("\n"), 1, errors)
                for part in parts:
                    self.assertIn(part, errors)
                self.assertFalse(os.path.exists(self.path("s")))
        self.assertEqual(self.runs("sbatch"), [])

    def test_without_sbatch(self):
        self.submit("--parts", "1", "--no-submit")
        os.remove(self.path("bin/sbatch"))
        self.environment["PATH"] = self.path("bin")  # Slurm may be installed here
        self.assertIn("no sbatch", self.submit(name="other", code=2).stderr)
        self.assertFalse(os.path.exists(self.path("other")))
        self.log("s", range(12))
        self.assertIn("no sbatch", self.sweep("run", self.path("s"), "--engine", "slurm", code=2).stderr)

    def test_nothing_is_submitted_if_no_take_is_missing(self):
        self.submit("--parts", "1", "--no-submit")
        self.log("s", range(12))
        self.write("bin/squeue.text", f"7|COMPLETING|{self.path('s/slurm/job.sh')}\n")  # its last task is about to end
        out = self.sweep("run", self.path("s"), "--engine", "slurm", "--wait").stdout
        self.assertIn("12 takes, 12 done", out)
        self.assertEqual(self.read("s/takes.csv").count(b",done,"), 12)
        self.assertEqual(self.runs("sbatch"), [])

    def test_nothing_is_submitted_if_take_0_fails(self):
        vary = ("--vary", "sheet.c=-5,2,3")
        for _ in range(2):  # it is not run again
            failed = self.submit(vary=vary, code=1)
            self.assertIn("take 0 (sheet.c=-5): ", failed.stderr)
            self.assertIn("nothing is submitted; --parts P", failed.stderr)
            self.assertEqual(len(glob.glob(self.path("s/log/*"))), 1)
        self.assertEqual((failed.stdout, self.runs("sbatch")), ("", []))
        self.assertIn("2 parts, 2 takes", self.submit("--parts", "3", vary=vary).stdout)
        self.submit("--retry", vary=vary, code=1)
        self.assertEqual(len(glob.glob(self.path("s/log/*"))), 2)

    def test_take_0_alone_is_the_whole_sweep(self):
        out = self.submit(vary=("--vary", "sheet.c=2")).stdout
        self.assertIn("1 take, 1 done", out)
        self.assertEqual(self.runs("sbatch"), [])

    def test_a_program_that_never_ends_is_ended(self):
        self.write("bin/squeue", "#!/bin/bash\nsleep 1000 & sleep 1000\n")
        failed = self.submit("--parts", "3", code=1)
        self.assertIn("squeue gives no answer within 30 s", failed.stderr)
        self.assertEqual(failed.stderr.count("\n"), 1, failed.stderr)
        self.assertEqual(self.runs("sbatch"), [])
        # What it leaves running, with our pipe, is not waited for.
        self.write("bin/squeue", "#!/bin/bash\nsleep 1000 &\nexit 0\n")
        self.write("bin/sbatch", "#!/bin/bash\nsleep 1000 &\necho 123\n")
        self.assertIn("submitted 123: 3 parts", self.submit("--parts", "3").stdout)

    def test_a_program_that_says_too_much_is_ended_and_cut_short(self):
        self.write("bin/squeue", f"#!/bin/bash\nexec yes {'y' * 4000}\n")
        failed = self.submit("--parts", "3", code=1)
        self.assertIn("squeue writes more than 256 MiB", failed.stderr)
        self.assertEqual(failed.stderr.count("\n"), 1, failed.stderr)
        self.write("bin/squeue", PROGRAM)
        self.write("bin/sbatch", "#!/bin/bash\nfor k in {1..300}; do printf '\\e]0;%s\\a\\n' $k >&2; done\n"
                                 "head -c 100000 /dev/zero | tr '\\0' x >&2; exit 1\n")
        failed = self.submit("--parts", "3", code=1).stderr
        self.assertNotIn("\x1b", failed)
        self.assertTrue(failed.startswith("\\x1b]0;1\\x07\n"), failed[:100])
        self.assertLess(len(failed), 10_000)
        self.assertLess(failed.count("\n"), 220)
        self.assertIn("sbatch ended with code 1", failed)

    def test_what_sbatch_refuses_is_passed_on(self):
        self.write("bin/sbatch.text", "")
        self.write("bin/sbatch.errors", "sbatch: error: no\x1b[1m thanks\n")
        self.write("bin/sbatch.code", "3")
        failed = self.submit("--parts", "3", code=1)
        self.assertTrue(failed.stderr.startswith("sbatch: error: no\\x1b[1m thanks\n"), failed.stderr)
        self.assertEqual(failed.stdout, "")
        self.assertFalse(os.path.exists(self.path("s/slurm/job")))
        self.write("bin/sbatch.code", "0")
        self.assertIn("sbatch printed no number", self.submit("--parts", "3", code=1).stderr)
        self.write("bin/sbatch.text", "hello\n")
        self.assertIn('printed "hello"', self.submit("--parts", "3", code=1).stderr)
        # It submits, and prints no number: with --quiet, or as a program of the site.
        os.remove(self.path("bin/squeue.turn"))
        self.write("bin/squeue.2", f"echo '12|PENDING|{self.path('s/slurm/job.sh')}'")
        self.assertIn("submitted 12: 3 parts, 12 takes\n", self.submit("--parts", "3").stdout)
        self.assertEqual(self.read("s/slurm/job"), b"12\n")
        self.write("bin/sbatch.text", "5;other\n")
        self.assertIn("submitted 5: 3 parts, 12 takes\n", self.submit("--parts", "3").stdout)
        self.assertEqual(self.read("s/slurm/job"), b"5;other\n")

    def test_a_job_that_is_queued_or_running_refuses_another(self):
        self.submit("--parts", "3")
        script = self.path("s/slurm/job.sh")
        listed = f"5|RUNNING|/elsewhere/slurm/job.sh\nnonsense\n3|COMPLETING|{script}\n7|CONFIGURING|{script}\n6|PENDING|/x\n" \
                 f"41|RUNNING|{script}\n9|RUNNING\n"
        for known in (b"123\n", b"", b"12", b"99;no such\x1b\n", None):
            if known is None:
                os.remove(self.path("s/slurm/job"))
            else:
                with open(self.path("s/slurm/job"), "wb") as file:
                    file.write(known)
            self.write("bin/squeue.text", listed)
            errors = self.submit("--parts", "3", code=1).stderr
            self.assertIn("job 7 of this sweep is queued or running", errors)
        os.mkfifo(self.path("s/slurm/job"))
        self.assertIn("job 7 ", self.submit("--parts", "3", code=1).stderr)
        # By another name of the folder.
        os.symlink(self.path("s"), self.path("t"))
        self.write("bin/squeue.text", f"8|REQUEUE_HOLD|{self.path('t/slurm/job.sh')}\n")
        self.assertIn("job 8 ", self.submit("--parts", "3", code=1).stderr)
        # Settings of the user do not hide it.
        self.environment["SQUEUE_USERS"] = "nobody"
        self.write("bin/squeue", "#!/bin/bash\nenv | grep -q SQUEUE_ || echo '9|PENDING|" + script + "'\n")
        self.assertIn("job 9 ", self.submit("--parts", "3", code=1).stderr)
        self.assertEqual(len(self.runs("sbatch")), 1)

    def test_a_job_that_the_list_does_not_show_is_asked_for(self):
        self.submit("--parts", "3")
        self.write("s/slurm/job", "77;far\n")
        os.remove(self.path("bin/squeue.turn"))
        self.write("bin/squeue.2", "echo 'CLUSTER: far'; echo '77|SUSPENDED|/mounted/there/s/slurm/job.sh'")
        self.assertIn("job 77 ", self.submit("--parts", "3", code=1).stderr)
        self.assertTrue({"--jobs=77", "--clusters=far"} <= set(self.runs("squeue")[-1]))
        # That number is by now of another job, or of none.
        for text in ("echo '77|RUNNING|/home/x/run.sh'", "echo '77|COMPLETING|/mounted/there/s/slurm/job.sh'",
                     "echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1"):
            os.remove(self.path("bin/squeue.turn"))
            self.write("bin/squeue.2", text)
            self.submit("--parts", "3")

    def test_the_copy_of_a_folder_is_another_sweep(self):
        self.submit("--parts", "3")
        subprocess.run(["cp", "-r", self.path("s"), self.path("t")], check=True)
        self.write("bin/squeue.text", f"123|RUNNING|{self.path('s/slurm/job.sh')}\n")
        self.assertIn("submitted 123", self.submit("--parts", "3", name="t").stdout)
        # One that was moved is the same.
        os.rename(self.path("s"), self.path("u"))
        self.assertIn("job 123 ", self.submit("--parts", "3", name="u", code=1).stderr)

    def test_slurm_is_asked_little(self):
        for options in ([], ["--parts", "3"]):
            self.submit(*options)  # a new one, then one that is there, with a job that has ended
            self.submit(*options)
            self.sweep("run", self.path("s"), "--engine", "slurm", *options)
            self.assertLessEqual(len(self.runs("scontrol")), 3 * 2)
            self.assertLessEqual(len(self.runs("squeue")), 3 * 3)
            for program in ("scontrol", "squeue"):
                os.remove(self.path(f"bin/{program}.arguments"))

    def test_a_job_that_ends_may_be_queued_again(self):
        # squeue calls a job COMPLETING while its processes end, cancelled or preempted.
        script = self.path("s/slurm/job.sh")
        self.submit("--parts", "3")
        os.remove(self.path("s/slurm/job"))
        for turn, state in enumerate(["COMPLETING", "COMPLETING", "PENDING"], 1):
            self.write(f"bin/squeue.{turn}", f"echo '7|{state}|{script}'")
        os.remove(self.path("bin/squeue.turn"))
        self.assertIn("job 7 of this sweep is queued or running", self.submit("--parts", "3", code=1).stderr)
        # Known by its number only.
        self.write("s/slurm/job", "77;far\n")
        for turn, text in enumerate(["", "77|COMPLETING|/far/s/slurm/job.sh", "", "77|PENDING|/far/s/slurm/job.sh"], 1):
            self.write(f"bin/squeue.{turn}", f"echo '{text}'")
        os.remove(self.path("bin/squeue.turn"))
        self.assertIn("job 77 of this sweep is queued or running", self.submit("--parts", "3", code=1).stderr)
        # It was cancelled.
        os.remove(self.path("s/slurm/job"))
        for turn, text in enumerate([f"7|COMPLETING|{script}", "", ""], 1):
            self.write(f"bin/squeue.{turn}", f"echo '{text}'")
        os.remove(self.path("bin/squeue.turn"))
        self.assertIn("submitted 123", self.submit("--parts", "3").stdout)
        # A node that hangs ends it for hours.
        self.write("bin/squeue.text", f"7|COMPLETING|{script}\n")
        begin = time.monotonic()
        self.assertIn("submitted 123", self.submit("--parts", "3").stdout)
        self.assertTrue(4 < time.monotonic() - begin < 30)

    def test_a_list_that_is_not_known_submits_nothing(self):
        self.write("bin/squeue.errors", "slurm_load_jobs error: Unable to contact slurm controller (connect failure)\n")
        self.write("bin/squeue.code", "1")
        errors = self.submit(code=1).stderr
        self.assertIn("Unable to contact slurm controller", errors)
        self.assertEqual(self.runs("sbatch"), [])
        self.write("bin/scontrol.code", "1")
        self.write("bin/squeue.code", "0")
        self.write("bin/scontrol.errors", "scontrol: error: down\n")
        self.assertIn("scontrol: error: down", self.submit(code=1).stderr)
        self.assertEqual(self.runs("sbatch"), [])

    def test_of_two_submissions_at_once_one_stays(self):
        script = self.path("s/slurm/job.sh")
        self.write("bin/squeue.2", f"echo '122|PENDING|{script}'; echo '123|PENDING|{script}'")
        failed = self.submit("--parts", "3", code=1)
        self.assertIn("job 122 ", failed.stderr)
        self.assertEqual((failed.stdout, self.runs("scancel")), ("", [["123"]]))
        self.write("bin/squeue.4", f"echo '124|PENDING|{script}'; echo '123|PENDING|{script}'")
        self.assertIn("submitted 123", self.submit("--parts", "3").stdout)
        self.assertEqual(len(self.runs("scancel")), 1)
        self.write("bin/sbatch.3", f"sed -i s,/3,/5, {script}; echo 125")  # which sbatch may have read
        self.assertIn("job 125 is cancelled", self.submit("--parts", "3", code=1).stderr)
        self.assertEqual(self.runs("scancel")[1:], [["125"]])

    # Waiting.

    def test_waiting_goes_on_through_requeues_and_silence(self):
        silent = "echo 'slurm_load_jobs error: Socket timed out on send/recv operation' >&2; exit 1"
        script = self.path("s/slurm/job.sh")
        answers = [":", ":", "echo RUNNING", silent, ":", "echo PENDING", "echo COMPLETING",
                   f"SLURM_ARRAY_TASK_ID=0 SLURM_CPUS_PER_TASK=1 bash {script}; "
                   "echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1", ":"]
        for turn, text in enumerate(answers, 1):
            self.write(f"bin/squeue.{turn}", text)
        out = self.submit("--parts", "1", "--wait").stdout
        self.assertIn("12 takes, 12 done, 0 failed, 0 missing", out)
        self.assertEqual(len(self.runs("squeue")), len(answers))
        self.assertEqual(len(list(csv.DictReader(io.StringIO(self.read("s/takes.csv").decode())))), 12)

    def test_a_job_goes_on_if_it_cannot_be_waited_for(self):
        self.write("bin/squeue.3", f"rm {self.path('bin/squeue')}; echo RUNNING")
        self.environment["PATH"] = f"{self.path('bin')}:{self.path('tools')}"
        os.mkdir(self.path("tools"))
        for tool in ("basename", "bash", "cat", "dirname", "rm"):  # but for a squeue that may be installed
            os.symlink(shutil.which(tool), self.path(f"tools/{tool}"))
        errors = self.submit("--parts", "3", "--wait", code=1).stderr
        self.assertIn("cannot start squeue: ", errors)
        self.assertIn("; job 123 goes on", errors)

    def test_a_terminal_shows_how_far_the_takes_are(self):
        try:
            main_end, terminal = pty.openpty()
        except OSError as error:  # a container without /dev/pts
            self.skipTest(f"no pseudo-terminal: {error}")
        self.submit("--parts", "2", "--no-submit")
        self.log("s", [4])  # is not submitted
        self.log("s", [5], status="failed")
        answers = [":", ":", "echo PENDING", "echo RUNNING", "echo RUNNING", "echo RUNNING", ":", ":"]
        for turn, text in enumerate(answers, 1):
            self.write(f"bin/squeue.{turn}", text)
        command = [PLIANT, "sweep", "run", self.path("s"), "--engine", "slurm", "--parts", "2", "--retry", "--wait"]
        shown = b""
        with subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL, stderr=terminal) as process:
            os.close(terminal)
            with contextlib.suppress(OSError):  # a terminal ends its output with this error
                while piece := os.read(main_end, 100000):
                    shown += piece
                    if b"queued" in shown and not os.path.exists(self.path("told")):
                        self.write("told", "")
                        self.log("s", [0, 1, 2])
                        self.log("s", [5], status="failed")
        os.close(main_end)
        self.assertEqual(process.returncode, 1)
        lines = shown.decode().split("\r\x1b[K")
        self.assertIn("[..............................] 0/11 takes, queued", lines)
        self.assertRegex(shown.decode(), r"\[#{10}\.{20}\] 4/11 takes, [\d.]+ takes/s, 0:\d\d left, 1 failed\r")

    def test_an_array_that_ended_early_is_told(self):
        ended = self.submit("--wait", "--parts", "3", code=1)
        self.assertIn("12 takes, 0 done, 0 failed, 12 missing", ended.stdout)
        self.assertEqual(ended.stderr, f"job 123 has ended; what its parts said is in {self.path('s')}/slurm/123_*.log\n")

    def test_an_interrupt_ends_the_waiting_only(self):
        self.write("bin/squeue.1", ":")
        self.write("bin/squeue.2", ":")
        self.write("bin/squeue.3", "sleep 60")  # a controller that does not answer
        scene = self.write("scene.xml", SCENE.format(columns=11, c=2))
        with subprocess.Popen([PLIANT, "sweep", "run", scene, "-o", self.path("s"), "--vary", "sheet.c=1..4", "--engine",
                               "slurm", "--wait"], env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            self.assertIn("submitted 123", process.stdout.readline())
            time.sleep(0.5)
            process.send_signal(signal.SIGINT)
            begin = time.monotonic()
            _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertIn("job 123 goes on", errors)
        self.assertLess(time.monotonic() - begin, 10)
        self.assertEqual(self.runs("scancel"), [])

    def test_an_interrupt_ends_what_does_not_answer(self):
        # sbatch waits for a controller that is away; squeue closes its output, and stays.
        for program, text in [("sbatch", "sleep 60"), ("squeue", "exec >&- 2>&-; sleep 60")]:
            with self.subTest(program=program):
                self.write(f"bin/{program}", f"#!/bin/bash\ntouch {self.path(program + '.runs')}; {text}")
                scene = self.write("scene.xml", SCENE.format(columns=11, c=2))
                with subprocess.Popen([PLIANT, "sweep", "run", scene, "-o", self.path(program), "--vary", "sheet.c=1..4", "--engine",
                                       "slurm", "--parts", "2"], env=self.environment, stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, text=True) as process:
                    while process.poll() is None and not os.path.exists(self.path(program + ".runs")):
                        time.sleep(0.05)
                    time.sleep(0.2)
                    process.send_signal(signal.SIGINT)
                    begin = time.monotonic()
                    out, errors = process.communicate(timeout=60)
                self.assertEqual((process.returncode, out), (1, ""))
                self.assertIn("squeue tells whether there is a job" if program == "sbatch" else "nothing is submitted", errors)
                self.assertLess(time.monotonic() - begin, 10)

    def test_output_without_end_is_bounded(self):
        self.write("bin/squeue.1", "head -c 300000000 /dev/zero | tr '\\0' x; head -c 300000000 /dev/zero >&2; exit 1")
        with subprocess.Popen([PLIANT, "sweep", "run", self.write("scene.xml", SCENE.format(columns=11, c=2)), "-o",
                               self.path("s"), "--vary", "sheet.c=1..4", "--engine", "slurm"], env=self.environment,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
            errors = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            peak = usage.ru_maxrss
        self.assertEqual(process.returncode, 1)
        self.assertLess(len(errors), 1_000_000)
        if not SANITIZED:
            self.assertLess(peak, 200_000)  # [KB]


if __name__ == "__main__":
    main()
