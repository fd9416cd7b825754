"""Shared by the tests of the command: a temporary folder, a scene, and runs of the command in it.

Each of these tests is a separate program, called with PLIANT SOURCE_FOLDER [sanitized], followed by
arguments for unittest, such as the names of tests.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

PLIANT, SOURCE = (os.path.abspath(argument) for argument in sys.argv[1:3])
SANITIZED = "sanitized" in sys.argv[3:4]  # built with a sanitizer, which is slow and takes memory
# What makes system calls fail (disk_shim.cpp); "" with a sanitizer, which it does not go with.
SHIM = "" if SANITIZED else os.environ.get("PLIANT_DISK_SHIM", "")

SCENE = """<?xml version="1.0"?>
<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="13" rows="11" width="12" depth="10"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"/>
</scene>
"""
GRID = '<grid columns="13" rows="11" width="12" depth="10"/>'
POINT = '<point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="3000"/>'
PATH = ('<path attribute="center"><waypoint at="0 0 0"/><waypoint at="1 0 0"/>'
        '<waypoint at="1 1 0"/></path>')


def animated(attribute, *keys):
    return f'<animate attribute="{attribute}">' + "".join(
        f'<key frame="{frame}" value="{value}"/>' for frame, value in keys) + "</animate>"


class Command(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="pliant-cli-")
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def scene(self, end=12):
        return self.write("scene.xml", SCENE.format(end=end))

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run_pliant(self, *arguments, code=0, **options):
        """Runs the command, which must end with that code, unless it is None; `options` are those
        of subprocess.run."""
        options = {"cwd": self.folder, **options}
        result = subprocess.run([PLIANT, *arguments], capture_output=True, text=True, timeout=600 if SANITIZED else 120,
                                stdin=subprocess.DEVNULL, check=False, **options)
        if code is not None:
            self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def files(self):
        return sorted(os.listdir(self.folder))

    def holds_hidden_files(self, process):
        """Whether the process has an open file of the folder that has no name there."""
        folder = f"/proc/{process.pid}/fd"
        try:
            targets = [os.readlink(os.path.join(folder, name)) for name in os.listdir(folder)]
        except OSError:  # a descriptor was just closed
            return False
        return any(target.startswith(self.folder) and "(deleted)" in target for target in targets)

    def interrupt(self, scene, out, number, there=None):
        """Sends a signal once the bake has begun to write, or once the file `there` exists; returns
        its exit code and stderr."""
        before = self.files()
        with subprocess.Popen([PLIANT, "bake", scene, "-o", self.path(out)],
                              stderr=subprocess.PIPE, text=True) as process:
            deadline = time.monotonic() + 60
            def has_begun():
                if there is not None:
                    return there in self.files()
                return self.files() != before or self.holds_hidden_files(process)
            while not has_begun() and time.monotonic() < deadline:
                time.sleep(0.01)
            process.send_signal(number)
            _, errors = process.communicate(timeout=60)
        return process.returncode, errors


class Share(unittest.TestLoader):
    """Every n-th test of a file, from the k-th: the n shares of a file can run at the same time."""

    def __init__(self, k, n):
        super().__init__()
        self.chosen = slice(k - 1, None, n)

    def loadTestsFromModule(self, module, **options):
        classes = super().loadTestsFromModule(module, **options)
        return self.suiteClass([test for tests in classes for test in tests][self.chosen])


def main():
    """Runs the tests of a file; the share k/n of them, if that is the first word after the arguments of all files."""
    words = sys.argv[4 if SANITIZED else 3:]
    loader = unittest.defaultTestLoader
    if words and re.fullmatch(r"\d+/\d+", words[0]):
        loader = Share(*map(int, words.pop(0).split("/")))
    unittest.main(argv=sys.argv[:1] + words, testLoader=loader)
