"""`pliant sweep run --engine slurm` on a real Slurm of three nodes: tests/sweep/slurm_loopback.sh, as script/test --slurm
starts it with --max-array 10000 and its PrologSlurmctld. usage: slurm_test.py PLIANT SHIM [arguments of unittest]

The shim (node_shim.cpp) gives each process of a job the name of its node, makes takes last, and computes wrongly on one
node.
"""

import glob
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PLIANT, SHIM = (os.path.abspath(argument) for argument in sys.argv[1:3])
LOOPBACK = os.path.join(os.path.dirname(os.path.abspath(__file__)), "slurm_loopback.sh")

SCENE = """<scene version="1" start="1" end="6">
  <surface name="sheet"><grid columns="12" rows="10" width="10" depth="10"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2.5" magnitude="900"/>
</scene>
"""
TAKES = 12
VARY = ("--vary", f"sheet.density=1..{TAKES}", "--solver", "cholmod")


def run(*words, code=0):
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL, check=False)
    if code is not None and done.returncode != code:
        raise AssertionError(f"{words} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done


def loopback(*words):
    return run(LOOPBACK, *words, "--dir", os.path.dirname(os.environ["SLURM_CONF"]))


def wait_until(what, seconds=60):
    deadline = time.monotonic() + seconds
    while not what():
        if time.monotonic() > deadline:
            raise AssertionError("not within {} s:\n{}".format(seconds, run("squeue", "-o", "%i %T %r %N").stdout))
        time.sleep(0.1)


def shim(pause=0, broken=""):
    return f"--sbatch=--export=ALL,LD_PRELOAD={SHIM},PLIANT_SHIM_PAUSE={pause},PLIANT_SHIM_BROKEN={broken}"


class Slurm(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="pliant-slurm-")
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.addCleanup(run, "scancel", "--user", str(os.getuid()), code=None)
        with open(self.path("scene.xml"), "w", encoding="utf-8") as file:
            file.write(SCENE)

    def path(self, name):
        return os.path.join(self.folder, name)

    def command(self, *options, name="s", vary=VARY):
        return [PLIANT, "sweep", "run", self.path("scene.xml"), "-o", self.path(name), *vary, *options]

    def submit(self, *options, name="s", code=0):
        return run(*self.command("--engine", "slurm", *options, name=name), code=code)

    def status(self, name="s", code=0):
        return run(PLIANT, "sweep", "status", self.path(name), code=code)

    def table(self, name="s"):
        with open(self.path(f"{name}/takes.csv"), "rb") as file:
            return file.read()

    def wanted(self):
        run(*self.command("--quiet", name="wanted"))
        return self.table("wanted")

    def lines(self, name="s"):
        found = []
        for file in glob.glob(self.path(f"{name}/log/*.jsonl")):
            with open(file, encoding="utf-8") as log:
                found += [json.loads(line) for line in log if line.endswith("\n")]
        return found

    def number(self, done):
        return re.search(r"^submitted (\d+): ", done.stdout, re.MULTILINE)[1]

    def active(self, number):
        return run("squeue", "-h", "-r", "-j", number, "-o", "%K %T", code=None).stdout.splitlines()

    # Tests in the order of their names: the one that loses a node is last.

    def test_an_array_over_three_nodes(self):
        name = "it's 50% \"x\" $HOME;#&"
        wanted = self.wanted()
        done = self.submit("--parts", "6", "--wait", shim(300), name=name)
        number = self.number(done)
        self.assertIn(f"submitted {number}: 6 parts, {TAKES} takes\nsbatch --parsable --array=0-5 ", done.stdout)
        self.assertIn(f"{TAKES} takes, {TAKES} done, 0 failed, 0 missing\n", done.stdout)
        self.assertEqual(self.table(name), wanted)
        self.assertEqual({line["host"] for line in self.lines(name)}, {"n1", "n2", "n3"})
        self.assertEqual(len(self.lines(name)), TAKES)
        logs = sorted(os.listdir(self.path(f"{name}/slurm")))
        self.assertEqual(logs, sorted([f"{number}_{part}.log" for part in range(6)] + ["job", "job.sh"]))
        for log in logs[:6]:
            self.assertEqual(os.path.getsize(self.path(f"{name}/slurm/{log}")), 0)
        self.assertNotIn("submitted", self.submit(name=name).stdout)  # none is missing

    def test_take_0_tells_the_number_of_parts(self):
        done = self.submit("--wait")
        self.assertIn(f": 1 parts, {TAKES - 1} takes\n", done.stdout)
        self.assertIn(f"{TAKES} done", done.stdout)

    def test_cancelled_parts_are_submitted_again(self):
        wanted = self.wanted()
        number = self.number(self.submit("--parts", "6", shim(400)))
        wait_until(lambda: len(self.lines()) >= 3)
        for _ in range(2):
            errors = self.submit("--parts", "6", code=1).stderr
            self.assertIn(f"job {number} of this sweep is queued or running", errors)
            with open(self.path("s/slurm/job"), "w", encoding="utf-8") as file:  # half written
                file.write(number[:-1])
        run("scancel", number)
        wait_until(lambda: not self.active(number))
        done = {line["take"] for line in self.lines()}
        missing = [take for take in range(TAKES) if take not in done]
        self.assertTrue(missing)
        parts = {take % 5 for take in missing}
        again = self.submit("--parts", "5", shim(300))
        self.assertIn(f": {len(parts)} parts, {len(missing)} takes\n", again.stdout)
        listed = {int(line.split()[0]) for line in self.active(self.number(again))}
        self.assertLessEqual(listed, parts)
        wait_until(lambda: not self.active(self.number(again)))
        self.status()
        self.assertEqual(self.table(), wanted)
        takes = [line["take"] for line in self.lines()]
        self.assertEqual(sorted(takes), list(range(TAKES)))  # none was run twice

    def test_of_submissions_at_once_one_stays(self):
        run(*self.command("--make-only"))
        command = [PLIANT, "sweep", "run", self.path("s"), "--engine", "slurm", "--parts", "3", shim(1000)]
        racers = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(4)]
        ends = [(racer, *racer.communicate(timeout=60)) for racer in racers]
        winners = [out for racer, out, _ in ends if racer.returncode == 0]
        self.assertEqual(len(winners), 1, ends)
        number = re.match(r"submitted (\d+): 3 parts, 12 takes\n", winners[0])[1]
        for racer, out, errors in ends:
            if racer.returncode != 0:
                self.assertEqual((racer.returncode, out), (1, ""))
                self.assertIn(f"job {number} ", errors)
        wait_until(lambda: len(set(run("squeue", "-h", "-t", "PD,R", "-o", "%F").stdout.split())) <= 1)
        self.assertEqual(set(run("squeue", "-h", "-t", "PD,R", "-o", "%F").stdout.split()), {number})
        # What is cancelled refuses nothing, though its processes are ending.
        run("scancel", number)
        self.assertIn("submitted ", run(*command).stdout)

    def test_a_job_whose_node_is_made_ready_refuses_another(self):
        number = self.number(self.submit("--parts", "3", "--sbatch=--job-name=slow-prolog"))
        wait_until(lambda: "CONFIGURING" in run("squeue", "-h", "-j", number, "-o", "%T").stdout)
        self.assertIn(f"job {number} of this sweep is queued or running", self.submit("--parts", "3", code=1).stderr)

    def test_an_interrupt_ends_the_waiting_only(self):
        with subprocess.Popen(self.command("--engine", "slurm", "--parts", "3", "--wait", shim(700)), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            number = re.match(r"submitted (\d+): ", process.stdout.readline())[1]
            time.sleep(1.5)
            process.send_signal(signal.SIGINT)
            begin = time.monotonic()
            _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertIn(f"job {number} goes on", errors)
        self.assertLess(time.monotonic() - begin, 10)
        self.assertTrue(self.active(number))
        wait_until(lambda: not self.active(number))
        self.status()

    def test_what_sbatch_refuses_is_passed_on(self):
        failed = self.submit("--parts", "3", "--sbatch=--partition=nonsense", code=1)
        self.assertIn("sbatch: error: invalid partition specified: nonsense\n", failed.stderr)
        self.assertEqual(failed.stdout, "")
        self.assertIn(f"{TAKES} missing", self.status(code=1).stdout)
        self.assertIn(f"{TAKES} done", self.submit("--parts", "3", "--wait").stdout)

    def test_an_array_is_no_larger_than_slurm_allows(self):
        vary = ("--vary", "sheet.density=1..20000")
        refused = run(*self.command("--engine", "slurm", "--parts", "10001", vary=vary), code=2)
        self.assertIn("at most 10000, Slurm's MaxArraySize", refused.stderr)
        self.assertFalse(os.path.exists(self.path("s")))
        done = run(*self.command("--engine", "slurm", "--parts", "10000", "--sbatch=--hold", vary=vary)).stdout
        self.assertIn(": 10000 parts, 20000 takes\n", done)

    def test_a_list_is_no_longer_than_slurm_accepts(self):
        run(*self.command("--make-only", vary=("--vary", "sheet.density=1..10000")))
        os.mkdir(self.path("s/log"))
        line = {"status": "failed", "error": "no", "seconds": 1, "host": "n1", "time": "2026-11-24T10:45:00.123Z"}
        with open(self.path("s/log/n1.jsonl"), "w", encoding="utf-8") as log:
            log.writelines(json.dumps({"take": take, **line}) + "\n" for take in range(0, 10000, 2))
        done = run(PLIANT, "sweep", "run", self.path("s"), "--engine", "slurm", "--parts", "10000", "--sbatch=--hold")
        self.assertIn(": 9999 parts, 5000 takes\n", done.stdout)
        told = run("squeue", "-h", "-j", self.number(done), "-o", "%F %T").stdout
        self.assertEqual(told, f"{self.number(done)} PENDING\n")

    def test_a_job_that_is_queued_again_refuses_another(self):
        number = self.number(self.submit("--parts", "1", shim(1500)))
        wait_until(lambda: self.active(number) == ["0 RUNNING"])
        run("scontrol", "requeue", number)  # COMPLETING at first
        self.assertIn(f"job {number} of this sweep is queued or running", self.submit("--parts", "1", code=1).stderr)

    def test_options_of_the_user_win(self):
        done = self.submit("--parts", "2", "--threads", "1", "--sbatch", "--time=5", "--sbatch=--cpus-per-task=2",
                           "--sbatch=--job-name=mine", "--sbatch=--mem-per-cpu=150", shim(1500))
        told = run("scontrol", "show", "job", self.number(done)).stdout
        for fact in ("JobName=mine\n", "TimeLimit=00:05:00", "CPUs/Task=2", "MinMemoryCPU=150M", "Requeue=1"):
            self.assertIn(fact, told)
        self.assertIn(f"job {self.number(done)} ", self.submit("--parts", "2", code=1).stderr)  # by whatever name
        # What is printed for a shell is what was run.
        line = self.submit("--parts", "2", "--no-submit", shim()).stdout
        self.assertEqual(line.replace(shim(), "").split()[:2], ["sbatch", "--parsable"])

    def test_memory_and_time_are_asked_for(self):
        done = self.submit(shim(1500))
        with open(self.path("s/slurm/job.sh"), encoding="utf-8") as script:
            asked = int(re.search(r"#SBATCH --mem=(\d+)M\n", script.read())[1])
        told = run("scontrol", "show", "job", self.number(done)).stdout
        for fact in (f"MinMemoryNode={asked}M", "TimeLimit=00:30:00", "CPUs/Task=1", "Requeue=1", "JobName=pliant-s\n"):
            self.assertIn(fact, told)

    def test_a_run_keeps_to_the_memory_of_its_job(self):
        run(*self.command("--make-only"))
        for part, option in enumerate(("--mem=400", "--mem-per-cpu=200")):
            told = self.path(f"told{part}")
            run("sbatch", option, "--cpus-per-task=2", f"--output={told}", "--wrap",
                f"{PLIANT} sweep run {self.path('s')} --part {part}/6 --threads 1")
            wait_until(lambda file=told: os.path.exists(file) and "done" in pathlib.Path(file).read_text(encoding="utf-8"))
            self.assertIn("1 take at once, up to 235 MB each\n", pathlib.Path(told).read_text(encoding="utf-8"))

    def test_a_wrong_node_is_found(self):
        line = self.submit("--parts", "1", "--no-submit", shim(300, broken="n2")).stdout
        for node in ("n1", "n2"):  # the same takes twice, as on a node that was thought dead
            run("bash", "-c", line.replace(" --export", f" --nodelist={node} --export"))
        wait_until(lambda: not run("squeue", "-h").stdout)
        hosts = {line["host"] for line in self.lines()}
        self.assertEqual(hosts, {"n1", "n2"})
        for errors in (self.status(code=1).stderr, run(PLIANT, "sweep", "run", self.path("s"), code=1).stderr):
            self.assertRegex(errors, r"(?m)^take \d+: hash differs between n1 and n2$")
        # Alone, it is found by running its takes again.
        for file in glob.glob(self.path("s/log/n1-*.jsonl")):
            os.remove(file)
        verified = run(PLIANT, "sweep", "verify", self.path("s"), code=1)
        self.assertRegex(verified.stdout, r"(?m)^take \d+: hash differs$")

    def test_z_a_node_lost_in_the_middle(self):
        wanted = self.wanted()
        with subprocess.Popen(self.command("--engine", "slurm", "--parts", "6", "--wait", shim(3000)), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            number = re.match(r"submitted (\d+): ", process.stdout.readline())[1]
            wait_until(lambda: "n2" in {line["host"] for line in self.lines()})
            loopback("kill", "n2")  # its second takes are under way
            wait_until(lambda: "BeginTime" in run("squeue", "-h", "-t", "PD", "-j", number, "-o", "%r", code=None).stdout, 90)
            self.assertIsNone(process.poll())
            done = {line["take"] for line in self.lines()}
            self.assertLess(len(done), TAKES)
            deadline = time.monotonic() + 90
            while process.poll() is None and time.monotonic() < deadline:
                loopback("hurry")
                time.sleep(1)
            out, errors = process.communicate(timeout=1)
        loopback("revive", "n2")
        self.assertEqual((process.returncode, errors), (0, ""))
        self.assertIn(f"{TAKES} done", out)
        self.assertEqual(self.table(), wanted)
        takes = [line["take"] for line in self.lines()]
        self.assertEqual(sorted(takes), list(range(TAKES)))  # those of before the kill were kept
        self.assertIn("Restarts=1", run("scontrol", "show", "job", number).stdout)


if __name__ == "__main__":
    # The last line is for script/test.
    program = unittest.main(argv=sys.argv[:1] + sys.argv[3:], exit=False)
    failed = len(program.result.failures) + len(program.result.errors)
    print(f"{program.result.testsRun - failed} passed, {failed} failed")
    sys.exit(failed > 0)
