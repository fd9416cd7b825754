"""Compares docs/command.md with the command's own help: the same commands, options and extensions.

usage: command_page_test.py PLIANT SOURCE_FOLDER
"""

import os
import re
import subprocess
import sys

PLIANT, SOURCE = (os.path.abspath(argument) for argument in sys.argv[1:3])


def help_of(*command):
    return subprocess.run([PLIANT, *command, "--help"], check=True, capture_output=True, text=True,
                          timeout=60).stdout


def commands_in(text):
    return set(re.findall(r"^  ([a-z]+) ", text.partition("Subcommands:")[2], re.MULTILINE))


def options_of(*command):
    text = help_of(*command)
    return options_in(text).union(*(options_of(*command, part) for part in commands_in(text)))


def options_in(text):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text)) - {"--help", "--version"}


def check_texts(*command):
    """The text beside each option has two lines at most, of a terminal with 100 columns, and names no batch engine
    but in the command that submits to one."""
    text = help_of(*command)
    for line in re.findall(r"^  .*", text, re.MULTILINE):
        assert len(line[30:]) <= 2 * (100 - 30), (command, line)
    assert command == ("sweep", "run") or not re.search("slurm|sbatch", text, re.IGNORECASE), command
    for part in commands_in(text):
        check_texts(*command, part)


def main():
    with open(os.path.join(SOURCE, "docs/command.md"), encoding="utf-8") as file:
        page = file.read()
    commands = commands_in(help_of())
    assert commands == set(re.findall(r"^\| `pliant ([a-z]+)", page, re.MULTILINE)), commands
    offered = options_of()
    assert offered == options_in(page), offered ^ options_in(page)
    check_texts()
    listed = re.search(r"selects the format: (.*?);", " ".join(help_of("bake").split())).group(1)
    endings = re.findall(r"^\| `(\.\w+)`", page, re.MULTILINE)
    assert sorted(endings) == sorted(listed.split(", ")), (endings, listed)
    print("ok", sorted(commands), sorted(offered), endings)


if __name__ == "__main__":
    main()
