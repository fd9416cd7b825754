"""The completions that shells offer after `pliant`, compared with the command's own help."""

import os
import re
import shutil
import subprocess
import unittest

from command import Command, PLIANT, SOURCE, main

SCRIPTS = os.path.join(SOURCE, "cli/terminal/completion")


class Complete(Command):
    def offered(self, *words):
        kind, *lines = self.run_pliant("__complete", *words).stdout.splitlines()
        return kind, [line.partition("\t")[0] for line in lines]

    def help_of(self, *command):
        return self.run_pliant(*command, "--help").stdout

    def commands_in(self, text):
        return re.findall(r"^  ([a-z]+) ", text.partition("Subcommands:")[2], re.MULTILINE)

    def check(self, *command):
        text = self.help_of(*command)
        options = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text.partition("Subcommands:")[0]))
        kind, words = self.offered(*command, "--")
        self.assertEqual((kind, {word for word in words if word.startswith("--")}), ("words", options), command)
        commands = self.commands_in(text)
        if commands:
            self.assertEqual(self.offered(*command, ""), ("words", commands))
        for name in commands:
            self.check(*command, name)

    def test_all_commands_and_options_of_the_help(self):
        self.check()

    def test_words_that_an_option_takes(self):
        self.assertEqual(self.offered("bake", "a.xml", "--space", ""), ("words", ["world", "object"]))
        self.assertEqual(set(self.offered("bake", "--solver=")[1]), {"auto", "spectral", "supernodal", "cholmod"})
        self.assertEqual(set(self.offered("bake", "--solver", "=", "a")[1]), {"auto", "spectral", "supernodal", "cholmod"})
        self.assertEqual(self.offered("bake", "a.xml", "--threads", ""), ("words", []))
        self.assertIn("record", self.offered("help", "")[1][0:] + self.offered("replay", "")[1])
        self.assertIn("bake", self.offered("help", "")[1])

    def test_files_by_their_ending(self):
        self.assertEqual(self.offered("bake", "")[0], "files .xml")
        self.assertEqual(self.offered("validate", "a.xml", "b.xml", "")[0], "files .xml")
        kind = self.offered("bake", "a.xml", "-o", "")[0]
        for ending in (".npy", ".obj", ".glb", ".usda"):
            self.assertIn(f" {ending}", kind)
        self.assertEqual(self.offered("curves", "a.xml", "--out", "")[0], "files .csv .svg")
        self.assertEqual(self.offered("format", "a.xml", "-o", "")[0], "files .xml")
        self.assertEqual(self.offered("replay", "diff", "a.replay", "")[0], "files .replay")
        self.assertEqual(self.offered("bake", "a.xml", "--cache", "")[0], "folders")
        self.assertEqual(self.offered("curves", "a.xml", "--at", "")[0], "files")
        self.assertEqual(self.offered("import", "curves", "")[0], "files .json .gltf .glb .anim")
        self.assertEqual(self.offered("import", "curves", "a.anim", "-o", "")[0], "files .xml")
        self.assertEqual(self.offered("export", "curves", "a.xml", "-o", "")[0], "files .json .gltf .glb .anim")

    def bash(self, line):
        """The completions that Bash offers for the last word of a line."""
        words = line.split(" ")
        text = f"""source "{SCRIPTS}/pliant.bash"
COMP_WORDS=("{PLIANT}" {" ".join(f"'{word}'" for word in words)}); COMP_CWORD={len(words)}
compopt() {{ :; }}
_pliant; printf '%s\\n' "${{COMPREPLY[@]}}"
complete -p pliant >&2"""
        result = subprocess.run(["bash", "--norc", "-c", text], cwd=self.folder, capture_output=True, text=True,
                                timeout=60, check=True)
        self.assertEqual(result.stderr, "complete -F _pliant pliant\n")
        return set(result.stdout.split("\n")) - {""}

    def test_bash(self):
        self.scene()
        self.write("two words.xml", "")
        self.write("other.txt", "")
        os.mkdir(self.path("folder"))
        self.assertEqual(self.bash("va"), {"validate"})
        self.assertEqual(self.bash("bake --re"), {"--resume", "--regions"} | {
            word for word in self.bash("bake --re") if word.startswith("--re")})
        self.assertEqual(self.bash("bake "), {"scene.xml", "two words.xml", "folder"})
        self.assertEqual(self.bash("bake scene.xml --cache "), {"folder"})
        self.assertEqual(self.bash("bake scene.xml --space o"), {"object"})
        self.assertEqual(self.bash("bake scene.xml --space = w"), {"world"})

    @unittest.skipUnless(shutil.which("zsh"), "no zsh here")
    def test_zsh_takes_its_script(self):
        subprocess.run(["zsh", "-n", f"{SCRIPTS}/_pliant"], check=True, timeout=60)

    @unittest.skipUnless(shutil.which("fish"), "no fish here")
    def test_fish(self):
        self.scene()
        bin_folder = os.path.dirname(PLIANT)
        text = f"""set -x PATH "{bin_folder}" $PATH
source "{SCRIPTS}/pliant.fish"
complete -C '{{}}'"""
        def offered(line):
            result = subprocess.run(["fish", "--no-config", "-c", text.format(line)], cwd=self.folder, check=True,
                                    capture_output=True, text=True, timeout=60)
            return {each.partition("\t")[0] for each in result.stdout.splitlines()}
        self.assertEqual(offered("pliant va"), {"validate"})
        self.assertIn("scene.xml", offered("pliant bake sc"))
        self.assertEqual(offered("pliant bake scene.xml --space o"), {"object"})


if __name__ == "__main__":
    main()
