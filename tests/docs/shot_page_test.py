"""Follows docs/shot.md: its commands are run, in order, and what they print has the form that the page
shows: the same words, with other numbers.

usage: shot_page_test.py PLIANT SOURCE_FOLDER
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile

PLIANT, SOURCE = (os.path.abspath(argument) for argument in sys.argv[1:3])


def blocks(page):
    """The indented blocks: commands, or the output of the last command."""
    return ["\n".join(line[4:] for line in block.splitlines())
            for block in re.findall(r"(?:^    .*\n)+", page, re.MULTILINE)]


def shape(text):
    """The words of a text without its numbers and blanks; a `…` of the page stands for anything."""
    return re.sub(r"\s+", " ", re.sub(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", "#", text)).strip()


def shows(shown, printed):
    pattern = ".*".join(re.escape(part) for part in shape(shown).split("…"))
    return re.fullmatch(pattern, shape(printed), re.DOTALL) is not None


def run(command, folder):
    """The result, or None of what this machine or build cannot do."""
    words = shlex.split(command, comments=True)
    if words[:2] == ["pliant", "view"] and ("--serve" in words or "--movie" in words):
        return None  # runs until it is stopped; takes minutes without a graphics card, see tests/viewer
    words[0] = PLIANT
    result = subprocess.run(words, cwd=folder, check=False, timeout=300, capture_output=True, text=True)
    lacks = re.search(r"this build has no viewer|needs Chromium", result.stderr)
    if result.returncode != 0 and words[1] == "view" and lacks:
        return None
    assert result.returncode == 0, f"{command}: {result.stderr}"
    return result


def main():
    with open(os.path.join(SOURCE, "docs/shot.md"), encoding="utf-8") as file:
        page = file.read()
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        result = None
        for block in blocks(page):
            if not block.startswith("pliant "):
                if result is not None:
                    assert shows(block, result.stdout), f"the page shows\n{block}\nbut it is\n{result.stdout}"
                    count += 1
                continue
            for command in block.splitlines():
                result = run(command, folder)
                print("left out" if result is None else "ok", command, flush=True)
    assert count >= 3, count
    for path in re.findall(r"\]\((?!https?:)([^)#]+)", page):
        assert os.path.exists(os.path.join(SOURCE, "docs", path)), f"the page links to {path}"


if __name__ == "__main__":
    main()
