"""The command's arguments, and its error messages."""

import os
import re
import signal
import subprocess
import time

from command import Command, PLIANT, SCENE, main


class Usage(Command):
    def test_version_and_help_go_to_stdout(self):
        self.assertRegex(self.run_pliant("--version").stdout, r"^pliant \d+\.\d+\.\d+\n$")
        for arguments in (["--help"], ["bake", "--help"]):
            result = self.run_pliant(*arguments)
            self.assertIn("SCENE" if "bake" in arguments else "bake", result.stdout)
            self.assertEqual(result.stderr, "")

    def test_alone_it_tells_what_there_is(self):
        told = self.run_pliant("--help").stdout
        result = self.run_pliant(code=2)
        self.assertEqual((result.stdout, result.stderr), ("", told))
        self.assertEqual(self.run_pliant("help").stdout, told)
        for command in (["bake"], ["replay"], ["replay", "record"], ["help"]):
            self.assertEqual(self.run_pliant("help", *command).stdout,
                             self.run_pliant(*command, "--help").stdout)
        self.assertEqual(self.run_pliant("replay", code=2).stderr,
                         self.run_pliant("replay", "--help").stdout)

    def test_a_misspelt_word_is_answered_with_the_nearest(self):
        scene = self.scene()
        for arguments, words in (
                (["bak", scene, "-o", "a.npy"], 'pliant has no command "bak"; did you mean "bake"? the '),
                (["help", "vew"], 'pliant has no command "vew"; did you mean "view"? the commands are '),
                (["replay", "recrd", scene], 'pliant replay has no command "recrd"; did you mean "record"?'),
                (["bake", scene, "-o", "a.obj", "--reume"],
                 'pliant bake has no option "--reume"; did you mean "--resume"? see pliant bake --help'),
                (["bake", scene, "--frame=1:3"], 'no option "--frame"; did you mean "--frames"?'),
                (["bake", scene, "-resume"], "pliant bake has no option"),
                (["curves", "--nothing-like-it", scene], 'has no option "--nothing-like-it"; see pliant curves')):
            result = self.run_pliant(*arguments, code=2)
            self.assertRegex(result.stderr, r"^pliant: error: [^\n]+\n$", arguments)
            self.assertIn(words, result.stderr)

    def test_wrong_usage_is_exit_code_2(self):
        scene = self.scene()
        for arguments in (["bak"], ["bake"], ["bake", scene], ["bake", scene, "-o"], ["format", scene, "-o", ""],
                          ["curves", scene, "-o", ""], ["import", "curves", scene, "-o", ""],
                          ["bake", scene, "-o", "a.npy", "--nonsense"],
                          ["bake", scene, "-o", "a.npy", "--space", "camera"],
                          ["bake", scene, "-o", "a.npy", "extra"]):
            result = self.run_pliant(*arguments, code=2)
            self.assertRegex(result.stderr, r"^pliant: error: [^\n]+\n$", arguments)
            self.assertEqual(result.stdout, "", arguments)
        for arguments, words in ((["--frames", "0:3"], "the scene has frames 1 to 12"),
                                 (["--frames", "5:3"], "A:B with A <= B"),
                                 (["--frames", "x"], "A:B with A <= B"),
                                 (["--surface", "none"], "the scene has no such surface; it has sheet")):
            result = self.run_pliant("bake", scene, "-o", "a.npy", *arguments, code=2)
            self.assertIn(words, result.stderr)
        result = self.run_pliant("bake", scene, "-o", "a.xyz", code=2)
        self.assertIn('no format has the ending ".xyz"', result.stderr)
        self.assertEqual(self.files(), ["scene.xml"])


class Errors(Command):
    def test_every_problem_of_a_scene_with_its_line(self):
        scene = self.write("bad.xml", "\n".join((
            '<scene version="1" start="1" end="4">',
            '  <surface name="sheet"><grid columns="2" rows="11"/></surface>',
            '  <point name="poke" magnitud="3"',
            '         forceRadius="1,5"/>',
            '  <pont name="other"/>',
            '</scene>')))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=2)
        lines = result.stderr.splitlines()
        self.assertEqual([re.match(r".*bad\.xml:(\d+): error: ", line).group(1) for line in lines],
                         ["2", "3", "4", "5"], result.stderr)
        self.assertIn('"magnitude"', lines[1])
        self.assertEqual(self.files(), ["bad.xml"])

    def test_a_rule_broken_in_the_middle_of_a_curve(self):
        scene = self.write("c.xml", SCENE.format(end=9).replace("</surface>", """
    <material>
      <animate attribute="c"><key frame="1" value="0"/><key frame="5" value="-3"/>
        <key frame="9" value="0"/></animate></material></surface>"""))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=2)
        self.assertRegex(result.stderr, r"c\.xml:5: error: sheet\.c at frame 4 is -2\.\d+, but must be "
                                        r"greater than -2 sqrt\(b d\) = -2")

    def test_missing_files(self):
        result = self.run_pliant("bake", "none.xml", "-o", "a.npy", code=2)
        self.assertIn("none.xml: error: cannot read the file: No such file", result.stderr)
        result = self.run_pliant("bake", self.folder, "-o", "a.npy", code=2)
        self.assertIn("it is a folder", result.stderr)
        scene = self.write("m.xml", SCENE.format(end=9).replace(
            '<grid columns="13" rows="11" width="12" depth="10"/>', '<mesh file="none.obj"/>'))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=2)
        self.assertRegex(result.stderr, r"m\.xml:3: error: .*none\.obj.*No such file")

    def test_a_missing_folder_is_named_ahead_of_any_work(self):
        # The output is checked first: the scene is not even read.
        for arguments, option in ((["bake", "none.xml", "-o", "no/such/a.npy"], "-o no/such/a.npy"),
                                  (["bake", "none.xml", "-o", "a.npy", "--regions", "no/such/r.json"],
                                   "--regions no/such/r.json"),
                                  (["curves", "none.xml", "-o", "no/such/a.csv"], "-o no/such/a.csv"),
                                  (["replay", "record", "none.xml", "-o", "no/such/a.replay"],
                                   "-o no/such/a.replay")):
            result = self.run_pliant(*arguments, code=1)
            self.assertEqual(result.stderr,
                             f"pliant: error: {option}: the folder no/such does not exist\n")
        scene = self.scene()
        result = self.run_pliant("bake", scene, "-o", "scene.xml/a.npy", code=1)
        self.assertIn("scene.xml is not a folder", result.stderr)
        self.assertEqual(self.files(), ["scene.xml"])

    def test_a_run_that_fails_leaves_nothing(self):
        text = SCENE.format(end=9).replace("</surface>", '<material density="0" damping="0" b="1e-10" '
                                                         'c="2e-10" d="1e-10"/></surface>')
        scene = self.write("s.xml", text.replace('"3000"', '"1e308"'))
        result = self.run_pliant("bake", scene, "-o", "a.npy", code=1)
        self.assertIn('surface "sheet", frame 1: the state stopped being finite', result.stderr)
        self.assertEqual(self.files(), ["s.xml"])

    def test_interrupt_leaves_nothing(self):
        scene = self.scene(end=900000)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            code, errors = self.interrupt(scene, "a.npy", number)
            self.assertEqual(code, 1, errors)
            self.assertRegex(errors, r"^pliant: error: interrupted at frame \d+; no file was written; "
                                     r"--cache DIR would keep the solved frames for the next run\n$")
            self.assertEqual(self.files(), ["scene.xml"])

    def test_a_run_under_nohup_outlives_its_terminal(self):
        scene = self.scene(end=900000)
        with subprocess.Popen(["nohup", PLIANT, "bake", scene, "-o", self.path("a.npy")], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT) as process:
            deadline = time.monotonic() + 60
            while not self.holds_hidden_files(process) and self.files() == ["scene.xml"] and time.monotonic() < deadline:
                time.sleep(0.01)
            process.send_signal(signal.SIGHUP)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(timeout=1)
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(timeout=60), 1)
        self.assertEqual(self.files(), ["scene.xml"])

    def test_interrupt_within_a_frame_of_many_steps(self):
        scene = self.write("slow.xml", SCENE.format(end=9).replace('"13"', '"301"').replace(
            '"11"', '"301"').replace("</surface>", '<solver dt="5e-7"/></surface>'))
        begin = time.monotonic()
        code, errors = self.interrupt(scene, "a.npy", signal.SIGINT)
        self.assertEqual(code, 1, errors)
        self.assertLess(time.monotonic() - begin, 30)  # one frame needs minutes
        self.assertEqual(self.files(), ["slow.xml"])

    def test_whole_frames_of_an_interrupted_sequence_stay(self):
        scene = self.scene(end=900000)
        _, errors = self.interrupt(scene, "a.obj", signal.SIGINT, there="a.0002.obj")
        self.assertRegex(errors, r"interrupted at frame \d+; the files written so far are kept, and --resume continues with them")
        files = self.files()
        self.assertEqual([name for name in files if name.endswith(".part")], [])
        line_counts = set()
        for name in files:
            if name.endswith(".obj"):
                with open(self.path(name), encoding="utf-8") as file:
                    line_counts.add(len(file.readlines()))
        self.assertEqual(len(line_counts), 1, "a frame is not whole")

    def test_a_full_disk_is_exit_code_1(self):
        scene = self.scene(end=300)
        result = subprocess.run(["sh", "-c", 'ulimit -f 64; exec "$0" bake "$1" -o "$2"', PLIANT, scene,
                                 self.path("a.npy")], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("error: cannot write the file: File too large", result.stderr)
        self.assertEqual(self.files(), ["scene.xml"])

    def test_a_stderr_that_cannot_be_written_is_no_harm(self):
        scene = self.scene()
        for redirection in ("2>/dev/full", "2>&-"):
            for name, code in ((scene, 0), ("none.xml", 2)):
                result = subprocess.run(
                    ["sh", "-c", f'exec "$0" bake "$1" -o a.npy {redirection}', PLIANT, name],
                    cwd=self.folder, capture_output=True, check=False)
                self.assertEqual(result.returncode, code, redirection)

    def test_warnings_come_before_the_error_that_they_explain(self):
        text = SCENE.format(end=9).replace("</surface>", '<material density="0" damping="0" b="1e-10" '
                                                         'c="2e-10" d="1e-10"/></surface>')
        text = text.replace('deformationRadius="4.5" forceRadius="2.5" ', 'forceRadius="0.4" ')
        text = text.replace('magnitude="3000"/>', """magnitude="1e149">
    <animate attribute="deformationRadius" interpolation="step">
      <key frame="1" value="0.5"/><key frame="4" value="4.5"/></animate></point>""").replace("e-10", "e-170")
        scene = self.write("s.xml", text)
        lines = self.run_pliant("bake", scene, "-o", "a.npy", code=1).stderr.splitlines()
        self.assertEqual(len(lines), 2)
        self.assertIn("selects fewer than 3 x 3 nodes", lines[0])
        self.assertIn("frame 4: the state stopped being finite", lines[1])


if __name__ == "__main__":
    main()
