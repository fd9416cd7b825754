"""Scenes that include files and define names: messages, arithmetic, logs, and what they are confined to."""

import csv
import io
import json
import math
import os
import random
import re
import subprocess
import unittest

from command import Command, PLIANT, main
from view_server import HAS_PAGE, Server

RIG = """<fragment>
  <define name="strength" value="3000"/>
  <point name="poke" center="0 0 0" deformationRadius="4.5" forceRadius="2.5" magnitude="$strength"/>
</fragment>
"""
SHARED = """<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="13" rows="11" width="12" depth="10"/></surface>
  <include file="rigs/poke.xml">{given}</include>
</scene>
"""


class Sharing(Command):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("rigs"))
        self.write("rigs/poke.xml", RIG)

    def shared(self, end=4, given="", name="shared.xml"):
        return self.write(name, SHARED.format(end=end, given=given))

    def test_it_bakes_to_the_bits_of_the_scene_without_includes(self):
        self.shared()
        self.scene(end=4)
        self.run_pliant("bake", "scene.xml", "-o", "a.npy")
        self.run_pliant("bake", "shared.xml", "-o", "b.npy")
        self.assertEqual(self.read("a.npy"), self.read("b.npy"))
        self.shared(given='<define name="strength" value="2 * 3e3"/>')
        self.run_pliant("bake", "shared.xml", "-o", "b.npy")
        self.assertNotEqual(self.read("a.npy"), self.read("b.npy"))

    def test_messages_name_the_file_and_the_chain(self):
        self.write("rigs/poke.xml", RIG.replace("magnitude", "strength"))
        self.shared()
        result = self.run_pliant("validate", "shared.xml", code=2)
        self.assertRegex(result.stderr, r'^rigs/poke\.xml:3: error: <point> has no attribute "strength"; did you mean '
                                        r'"magnitude"\? allowed: .*; included by shared\.xml:3\n$')
        found = json.loads(self.run_pliant("validate", "shared.xml", "--json", code=2).stdout)
        self.assertEqual([(one["file"], one["line"], one["kind"]) for one in found["problems"]],
                         [("rigs/poke.xml", 3, "invalid")])
        # What only a run finds: a channel at a frame, a warning, a note.
        self.write("rigs/poke.xml", RIG.replace('magnitude="$strength"/>', '><animate attribute="forceRadius">\n'
                   '<key frame="1" value="1"/><key frame="3" value="-1"/></animate></point>').replace(' forceRadius="2.5"', ""))
        result = self.run_pliant("bake", "shared.xml", "-o", "a.npy", code=2)
        self.assertRegex(result.stderr, r"^rigs/poke\.xml:3: error: poke\.forceRadius at frame \d is .*; included by shared\.xml:3\n$")
        self.write("rigs/poke.xml", RIG.replace('center="0 0 0"', 'center="99 0 0"'))
        result = self.run_pliant("bake", "shared.xml", "-o", "a.npy")
        self.assertRegex(result.stderr, r"(?m)^rigs/poke\.xml:3: warning: .*; included by shared\.xml:3$")
        self.write("rigs/poke.xml", RIG.replace('magnitude="$strength"/>', '><animate attribute="magnitude"><key frame="1" value="0"/>\n'
                   '<key frame="3" value="1" inLength="-1"/></animate></point>'))
        result = self.run_pliant("validate", "shared.xml")
        self.assertRegex(result.stderr, r"^rigs/poke\.xml:4: note: poke\.magnitude: .*; included by shared\.xml:3\n$")
        found = json.loads(self.run_pliant("validate", "shared.xml", "--json").stdout)
        self.assertEqual([(one["file"], one["line"], one["kind"]) for one in found["problems"]],
                         [("rigs/poke.xml", 4, "note")])

    def test_a_fragment_alone_is_no_scene(self):
        result = self.run_pliant("validate", "rigs/poke.xml", code=2)
        self.assertIn("the root element is <fragment>, which is not a scene, but what a scene may include", result.stderr)

    def test_no_command_writes_over_an_included_file(self):
        self.shared()
        before = self.read("rigs/poke.xml")
        os.rename(self.path("rigs/poke.xml"), self.path("rigs/poke.npy"))
        self.write("shared.xml", SHARED.format(end=3, given="").replace("poke.xml", "poke.npy"))
        for arguments, says in (
                (["bake", "shared.xml", "-o", "rigs/poke.npy"], "would overwrite rigs/poke.npy, an input of the scene"),
                (["bake", "shared.xml", "-o", "a.npy", "--regions", "rigs/poke.npy"], "it is a file that the scene includes"),
                (["replay", "record", "shared.xml", "-o", "rigs/poke.npy"], "the log would overwrite a file that the scene includes")):
            result = self.run_pliant(*arguments, code=2)
            self.assertIn(says, result.stderr)
            self.assertEqual(self.read("rigs/poke.npy"), before)

    def test_a_log_knows_the_included_files(self):
        self.shared()
        self.run_pliant("replay", "record", "shared.xml", "-o", "run.replay")
        self.run_pliant("replay", "verify", "run.replay")
        self.write("rigs/poke.xml", RIG.replace("3000", "3001"))
        result = self.run_pliant("replay", "verify", "run.replay", code=1)
        self.assertIn("rigs/poke.xml", result.stderr)
        self.assertIn("frame", result.stdout)

    def test_a_cache_is_for_what_the_scene_says_now(self):
        self.shared(end=6)
        self.run_pliant("bake", "shared.xml", "-o", "a.npy", "--cache", "kept")
        self.run_pliant("bake", "shared.xml", "-o", "b.npy", "--cache", "kept")
        self.assertEqual(self.read("a.npy"), self.read("b.npy"))
        self.write("rigs/poke.xml", RIG.replace("3000", "1000"))
        self.run_pliant("bake", "shared.xml", "-o", "b.npy", "--cache", "kept")
        self.run_pliant("bake", "shared.xml", "-o", "c.npy")
        self.assertEqual(self.read("b.npy"), self.read("c.npy"))
        self.assertNotEqual(self.read("a.npy"), self.read("b.npy"))

    @unittest.skipUnless(HAS_PAGE, "this build has no page")
    def test_a_save_of_an_included_file_is_baked_also_after_a_mistake(self):
        server = Server(self.shared())
        try:
            server.wait_for("baked")
            self.write("rigs/poke.xml", RIG.replace("magnitude", "magnitde"))
            failure = server.wait_for("failed")
            self.assertIn("poke.xml", str(failure))
            self.write("rigs/poke.xml", RIG)
            server.wait_for("baked")
            os.remove(self.path("rigs/poke.xml"))
            server.wait_for("failed")
            self.write("rigs/poke.xml", RIG)
            server.wait_for("baked")
        finally:
            server.close()

    def test_a_root_confines_everything(self):
        os.makedirs(self.path("shots/below"))
        os.makedirs(self.path("secret"))
        self.write("secret/part.xml", "<fragment/>")
        self.write("secret/mesh.obj", "secret")
        os.symlink("../secret", self.path("shots/link"))
        ways = ['<include file="{}part.xml"/>', '<define name="d" value="{}"/><include file="${{d}}part.xml"/>',
                '<surface name="s"><mesh file="{}mesh.obj"/></surface>',
                '<surface name="s"><subdivision file="{}mesh.obj"/></surface>',
                '<surface name="s"><grid columns="3" rows="3" cache="{}a.pc2"/></surface>',
                '<surface name="s"><grid columns="3" rows="3"/><material><map channel="b" file="{}b.png"/></material></surface>']
        for way in ways:
            for folder in ("../secret/", "link/", self.path("secret/"), "below/../link/"):
                self.write("shots/a.xml", '<scene start="1" end="2">\n' + way.format(folder) + "</scene>")
                for command in (["validate"], ["bake", "-o", "a.npy"], ["info"], ["curves"],
                                ["replay", "record", "-o", "a.replay"]):
                    result = self.run_pliant(*command, "shots/a.xml", "--root", "shots", code=2)
                    self.assertRegex(result.stderr, r"^shots/a\.xml:2: error: .*it is outside \S+, the folder of --root\n$")
                    self.assertNotIn("secret\n", result.stderr)
        # From the standard input too.
        with open(self.path("shots/a.xml"), encoding="utf-8") as scene:
            result = subprocess.run([PLIANT, "validate", "-", "--root", "shots"], stdin=scene, cwd=self.folder,
                                    capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn("it is outside", result.stderr)


class Arithmetic(Command):
    def test_it_is_that_of_python(self):
        numbers = {"a": "3", "b": "0.1", "c": "-7.25", "d": "1e-3"}
        chance = random.Random(4)

        def expression(depth):
            if depth == 0 or chance.random() < 0.2:
                return chance.choice(["$" + name for name in numbers] + ["2", "0.3", "1e2", "17"])
            if chance.random() < 0.2:
                return f"({expression(depth - 1)})"
            if chance.random() < 0.15:
                return f"-({expression(depth - 1)})"
            sign = chance.choice("+-*/")
            blank = chance.choice(["", " "])
            return expression(depth - 1) + blank + sign + blank + expression(depth - 1)

        expected, forces = [], []
        while len(expected) < 400:
            text = expression(5)
            if "$" not in text:
                continue
            # Alone a name is its own text.
            python = re.sub(r"\$(\w)", lambda match: f"({numbers[match.group(1)]})", text)
            try:
                value = eval(python)  # pylint: disable=eval-used
            except ZeroDivisionError:
                continue
            if not math.isfinite(value):
                continue
            forces.append(f'<uniform name="f{len(expected)}" magnitude="{text}"/>')
            expected.append(float(value))
        defines = "".join(f'<define name="{name}" value="{value}"/>' for name, value in numbers.items())
        self.write("a.xml", f'<scene start="1" end="1">{defines}{"".join(forces)}</scene>')
        channels = [part for k in range(len(expected)) for part in ("--channel", f"f{k}.magnitude")]
        rows = list(csv.DictReader(io.StringIO(self.run_pliant("curves", "a.xml", *channels).stdout)))
        self.assertEqual([float(row["value"]) for row in rows], expected)


if __name__ == "__main__":
    main()
