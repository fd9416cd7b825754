#!/usr/bin/env python3
"""Tests the package of the Blender add-on in Blender.

usage: blender_test.py PACKAGE PICTURES [NAME…]

PACKAGE is pliant_blender.zip, beside the command with which some compare; PICTURES is the folder for
screenshots. NAME is a file's, without _test.py, or FILE:CLASS[.TEST]; without one all are run. Files that need
a window run under Xvfb. Each runs in a Blender of its own, with a user's folders of its own, in which Blender
installed the package. Ends with "N passed, N failed".
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
WINDOWED = {"window"}


def run(command, environment, seconds=600):
    """Runs a program; its status and what it printed."""
    done = subprocess.run(
        command, env={**os.environ, **environment}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        errors="replace", timeout=seconds,
    )  # fmt: skip
    return done.returncode, done.stdout


def folders(root):
    """A user's folders for Blender, in `root`."""
    found = {f"BLENDER_USER_{name}": os.path.join(root, name.lower()) for name in ("CONFIG", "SCRIPTS", "DATAFILES")}
    for folder in found.values():
        os.makedirs(folder, exist_ok=True)
    return {**found, "PYTHONDONTWRITEBYTECODE": "1", "HOME": root}


def blender(*more, window=False):
    command = ["blender", "--factory-startup", "-noaudio", "--python-exit-code", "1"]
    if window:
        screen = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24"]
        return [*screen, *command, "--window-geometry", "0", "0", "1280", "800", *more]
    return [*command, "-b", *more]


def main():
    package, pictures, *names = sys.argv[1:]
    os.makedirs(pictures, exist_ok=True)
    chosen = {}
    for name in names or sorted(path.name[: -len("_test.py")] for path in HERE.glob("*_test.py")):
        file, _, test = name.partition(":")
        if file != "blender":
            chosen.setdefault(file, []).extend([test] if test else [])
    passed = failed = 0
    with tempfile.TemporaryDirectory(prefix="pliant-blender-") as root:
        environment = {
            **folders(root), "PLIANT_PICTURES": os.path.abspath(pictures), "LIBGL_ALWAYS_SOFTWARE": "1",
            "PLIANT_COMMAND": os.path.join(os.path.dirname(os.path.abspath(package)), "pliant"),
        }  # fmt: skip
        status, text = run(
            blender("--python-expr", f"import bpy; bpy.ops.preferences.addon_install(filepath={package!r})"),
            environment,
        )
        if status:
            print(text)
            sys.exit("blender_test.py: the package cannot be installed")
        for file, tests in chosen.items():
            script = [str(HERE / "inside.py"), "--", str(HERE / f"{file}_test.py"), *tests]
            try:
                status, text = run(blender("-P", *script, window=file in WINDOWED), environment)
            except subprocess.TimeoutExpired as error:
                status, text = 1, f"{error}\n{(error.stdout or b'').decode(errors='replace')}"
            print(f"== {file}\n{text}", flush=True)
            ran = sum(map(int, re.findall(r"^Ran (\d+) tests?", text, re.MULTILINE)))
            bad = sum(map(int, re.findall(r"(?:failures|errors)=(\d+)", text)))
            if status and not bad:
                bad, ran = 1, max(ran, 1)
                print(f"FAIL: {file}: it stopped early")
            passed, failed = passed + ran - bad, failed + bad
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed > 0 or passed == 0)


main()
