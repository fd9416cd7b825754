"""Ctrl-C while a command is at its slowest: what it still does is counted in its own processor time, as a share of what
the whole run takes."""

import os
import re
import shutil
import signal
import subprocess
import time
import unittest

from command import Command, PLIANT, main
from hostile import scene, write

# Of the whole run, which takes some seconds: what lies between two questions, and giving back the memory. It is the
# least of some runs, since what others do with the machine's memory only adds to it.
MOST_AFTER = 0.25
RUNS = 3
# Processor time of the whole run, so that the shares can be told.
LEAST = 0.2
MOMENTS = (0.1, 0.4, 0.8)
TICKS = os.sysconf("SC_CLK_TCK")


def processor_time(process):
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def has_ended(process):
    return os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


class Interrupted(Command):
    def run_until(self, arguments, moment):
        """Runs the command, and interrupts it at a time of its processor, if there is one; returns its exit code, its
        stderr, and the processor time of the whole and after the signal."""
        errors = self.path("errors.txt")
        with open(errors, "wb") as stderr:
            with subprocess.Popen([PLIANT, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=stderr) as process:
                at = None
                while moment is not None and not has_ended(process):
                    at = processor_time(process)
                    if at >= moment:
                        os.kill(process.pid, signal.SIGINT)  # it is not reaped yet
                        break
                    time.sleep(0.002)
                _, status, usage = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
        whole = usage.ru_utime + usage.ru_stime
        return process.returncode, self.read("errors.txt").decode(errors="replace"), whole, whole - (at or 0)


GRID = '<grid columns="{0}" rows="{0}" width="1" depth="1"/>'
POKE = '<point name="poke{}" center="0 0 0" deformationRadius="0.3" forceRadius="0.2"{}</point>\n'


def poke(magnitude="1", name=""):
    return POKE.format(name, f' magnitude="{magnitude}">')


def keyed(count):
    return POKE.format("", '><animate attribute="magnitude">' + "".join(
        f'<key frame="{k}" value="{k % 7}"/>\n' for k in range(count)) + "</animate>")


def frames(made, end):
    with open(made, "r+", encoding="utf-8") as file:
        text = file.read().replace('end="2"', f'end="{end}"')
        file.seek(0)
        file.write(text)
    return made


def relief(folder, n):
    """An .obj of n x n vertices."""
    return write(folder, "relief.obj", "".join(
        f"v {i} {(i * j) % 3 * 0.1} {j}\n" for i in range(n) for j in range(n)) + "".join(
            f"f {i * n + j} {i * n + j + 1} {i * n + n + j + 1} {i * n + n + j}\n"
            for i in range(n - 1) for j in range(1, n)))


def surface(folder, n, solver=""):
    relief(folder, n)
    return scene(folder, poke(), f'<mesh file="relief.obj" uv="surface"/>{solver}')


def bake(folder, made, name="out.npy"):
    return ["bake", made, "-o", os.path.join(folder, name), "--threads", "1"]


def net(n, samples):
    points = " ".join(f"{i} 0 {j}" for j in range(n) for i in range(n))
    return (f'<nurbs columns="{n}" rows="{n}" degreeU="3" degreeV="3" samplesU="{samples}" samplesV="{samples}">'
            f"<points>{points}</points></nurbs>")


# By name: what gives the arguments of a command at its slowest, for a folder.
SLOW = {
    "validate of a long text": lambda f: ["validate", scene(f, keyed(900_000))],
    "format": lambda f: ["format", scene(f, keyed(500_000))],
    "validate of many frames": lambda f: ["validate", frames(scene(f, "".join(
        f'<surface name="s{k}">{GRID.format(4)}<transform><animate attribute="scale"><key frame="1" value="1 1 1"/>'
        '<key frame="1000000" value="2 2 2"/></animate></transform></surface>\n' for k in range(8)), surface=""), 1_000_000)],
    "validate with hints": lambda f: ["validate", scene(f, "".join(
        f'<define name="value{k}x" value="1"/>\n' for k in range(400_000)) + "".join(
            f'<define name="b{k}" value="$valeu{k}"/>\n' for k in range(9000)))],
    "curves": lambda f: ["curves", scene(f, keyed(50)), "--frames", "1:3000000"],
    "info of a mesh": lambda f: ["info", relief(f, 1200)],
    "info of many forces": lambda f: ["info", scene(f, "".join(poke(name=k) for k in range(30_000)))],
    "new": lambda f: ["new", "mesh", "--mesh", relief(f, 150), "-o", os.path.join(f, "n.xml"), "--force"],
    "suggest": lambda f: ["suggest", frames(scene(f, poke(), GRID.format(601)), 48), "--peak", "0.1"],
    "bake of a surface": lambda f: bake(f, surface(f, 220, '<solver region="all"/>')),
    "bake of a grid": lambda f: bake(f, scene(f, poke(), GRID.format(1501))),
    "bake of plastic motion": lambda f: bake(f, frames(scene(f, poke("1e4"), GRID.format(61) +
                                             '<material yield="1"/><solver region="all" dt="0.0005"/>'), 24)),
    "bake of exact motion": lambda f: bake(f, frames(scene(
        f, poke(), GRID.format(401) + '<solver region="all" integrator="exact"/>'), 24)),
    "bake of a net": lambda f: bake(f, scene(f, "", net(9, 1500))),
    "bake to .obj": lambda f: bake(f, frames(scene(f, "", GRID.format(700)), 6), "out.obj"),
    "bake to .usda": lambda f: bake(f, frames(scene(f, "", GRID.format(700)), 6), "out.usda"),
    "bake to .glb": lambda f: bake(f, frames(scene(f, "", GRID.format(900)), 6), "out.glb"),
    "sweep of many takes": lambda f: ["sweep", "run", scene(f, poke()), "-o", os.path.join(f, "out"), "--vary",
                                      "poke.magnitude=1:2", "--vary", "s.density=1:2", "--sample", "600000", "--make-only"],
}


def add_test(name, make):
    def test(self):
        arguments = make(self.folder)
        made = self.files()
        own_code, errors, whole, _ = self.run_until(arguments, None)
        self.assertIn(own_code, (0, 2), errors[:2000])
        self.assertGreater(whole, LEAST, "too fast to be interrupted")
        heard = 0
        for moment in MOMENTS:
            for _ in range(RUNS):
                for file in set(self.files()) - set(made):
                    path = self.path(file)
                    shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)
                code, errors, _, after = self.run_until(arguments, moment * whole)
                if after < MOST_AFTER * whole:
                    break
            if code == own_code:  # it was about to end
                self.assertLess(after, MOST_AFTER * whole)
                continue
            heard += 1
            self.assertEqual(code, 1, errors[:2000])
            self.assertRegex(errors.splitlines()[-1], "interrupted")
            self.assertLess(after, MOST_AFTER * whole, f"interrupted after {moment} of {whole:.2f} s")
            # Of a sequence those frames stay that are complete.
            self.assertTrue(all(re.fullmatch(r"errors\.txt|out\.[0-9]{4}\.obj", file) for file in set(self.files()) - set(made)),
                            self.files())
        self.assertGreater(heard, 0)

    setattr(Interrupted, "test_" + name.replace(" ", "_").replace(".", ""), test)


for each, function in SLOW.items():
    add_test(each, function)

if __name__ == "__main__":
    main()
