"""Follows the README: its scene is written to a file and its commands are run, in order.

usage: readme_test.py PLIANT SOURCE_FOLDER
"""

import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile

PLIANT, SOURCE = (os.path.abspath(argument) for argument in sys.argv[1:3])


def edit(words, folder):
    """Runs a command that serves a page until Ctrl-C."""
    environment = {**os.environ, "XDG_STATE_HOME": folder}
    with subprocess.Popen([*words, "--no-open"], cwd=folder, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True) as process:
        if process.stdout.readline():
            process.send_signal(signal.SIGINT)
        return subprocess.CompletedProcess(words, process.wait(timeout=120), stderr=process.stderr.read())


def main():
    with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as file:
        readme = file.read()
    scene = re.search(r"`(\w+\.xml)`.*?```xml\n(.*?)```", readme, re.DOTALL)
    commands = re.findall(r"^    ((?:build/release/pliant|script/render) .*?)(?:\s+#.*)?$", readme,
                          re.MULTILINE)
    assert scene and len(commands) >= 3, "the README shows no scene or no commands"
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, scene.group(1)), "w", encoding="utf-8") as file:
            file.write(scene.group(2))
        for command in commands:
            words = shlex.split(command)
            words[0] = PLIANT if words[0].endswith("pliant") else os.path.join(SOURCE, words[0])
            result = (edit(words, folder) if words[1:2] == ["edit"] else
                      subprocess.run(words, cwd=folder, check=False, timeout=120, capture_output=True, text=True))
            # A build without npm reports that it has no viewer.
            is_left_out = words[1] in ("view", "edit") and "this build has no viewer" in result.stderr
            assert result.returncode == 0 or is_left_out, f"{command}: {result.stderr}"
            print("left out" if is_left_out else "ok", command)
    for path in re.findall(r"\]\((?!https?:)([^)#]+)\)", readme):
        assert os.path.exists(os.path.join(SOURCE, path)), f"the README links to {path}"


if __name__ == "__main__":
    main()
