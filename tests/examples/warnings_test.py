"""The examples and the starters of `pliant new` give no warning that is not meant.

usage: warnings_test.py PLIANT SOURCE_FOLDER
"""

import glob
import os
import re
import subprocess
import sys
import tempfile

PLIANT, SOURCE = sys.argv[1], sys.argv[2]

# Warnings that belong to what a scene shows: its name, words of the warning, and why.
MEANT = {
    # Clay keeps the trail of the finger, beside rubber, which does not.
    "finger": ["\"clay\" is frozen while it moves"],
    # The figure of the thesis, which shows what is cut off by a narrow region.
    "thesis/fig11-narrow": ["the forceRadius of \"force\" exceeds deformationRadius"],
}


def warnings_of(command):
    result = subprocess.run([PLIANT, *command], capture_output=True, text=True, check=False)
    if result.returncode != 0 and "OpenSubdiv" in result.stderr:  # a build without it
        return []
    assert result.returncode == 0, (command, result.stderr)
    return re.findall(r": warning: (.*)", result.stderr)


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        examples = os.path.join(SOURCE, "examples")
        scenes = {os.path.relpath(path, examples)[:-4]: path
                  for path in glob.glob(os.path.join(examples, "**", "*.xml"), recursive=True)
                  if os.sep + "parts" + os.sep not in path}
        listed = subprocess.run([PLIANT, "new"], capture_output=True, text=True, check=True).stdout
        for starter in re.findall(r"^  (\w+) ", listed.split("materials:")[0], re.MULTILINE):
            path = os.path.join(folder, starter + ".xml")
            subprocess.run([PLIANT, "new", starter, "-o", path], capture_output=True, check=True)
            scenes["new " + starter] = path
        assert len(scenes) > 30 and "new dent" in scenes, sorted(scenes)
        for name, path in sorted(scenes.items()):
            baked = warnings_of(["bake", path, "-o", os.path.join(folder, "out.npy"), "--quiet"])
            told = baked + warnings_of(["validate", path]) + warnings_of(["info", path, "--quiet"])
            meant = MEANT.get(name, [])
            for words in meant:
                if not any(words in warning for warning in baked):
                    print(f"{name}: is meant to warn, but does not: {words}")
                    failed += 1
            for warning in told:
                if not any(words in warning for words in meant):
                    print(f"{name}: {warning}")
                    failed += 1
    return 1 if failed else 0


sys.exit(main())
