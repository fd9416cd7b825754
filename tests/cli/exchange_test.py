"""`pliant import curves` and `pliant export curves`."""

import json
import os

import numpy as np

from command import Command, animated, main

SCENE = """<?xml version="1.0"?>
<scene version="1" start="1" end="48">
  <surface name="sheet"><grid columns="5" rows="5"/></surface>
  <!-- stays -->
  <point name="poke" center="0 0 0" deformationRadius="2" magnitude="3">{poke}</point>
  <radial name="bulge" deformationRadius="2">{bulge}</radial>
</scene>
"""
BULGE = """<animate attribute="magnitude"><key frame="1" value="0"/><key frame="12" value="8" interpolation="elasticOut"/>
    <key frame="30" value="2" left="5"/></animate>"""
ANIM = """animVersion 1.1;
mayaVersion 2022;
timeUnit film;
linearUnit cm;
angularUnit deg;
startTime 1;
endTime 24;
anim translate.translateX translateX ball 0 0 0;
animData {
  input time;
  output linear;
  weighted 0;
  preInfinity constant;
  postInfinity cycle;
  keys {
    1 0 auto auto 1 0 0;
    24 5 auto auto 1 0 0;
  }
}
"""


class Exchange(Command):
    def scene(self, poke="", bulge=""):
        return self.write("shot.xml", SCENE.format(poke=poke, bulge=bulge))

    def values(self, scene, channel, frames="1:48"):
        text = self.run_pliant("curves", scene, "--channel", channel, "--frames", frames).stdout
        return [tuple(map(float, line.split(",")[2:])) for line in text.splitlines()[1:]]

    def test_a_file_is_listed(self):
        text = self.run_pliant("import", "curves", self.write("ball.anim", ANIM)).stdout
        self.assertEqual(text, "ball.translate.x: 2 keys, frames 1 to 24, values 0 to 5, a length\n")

    def test_a_curve_goes_to_a_channel(self):
        scene, anim = self.scene(), self.write("ball.anim", ANIM)
        done = self.run_pliant("import", "curves", anim, "-o", scene, "--map", "ball.translate.x=bulge.magnitude*100",
                               "--offset", "10")
        self.assertIn("shot.xml: 1 channel: bulge.magnitude\n", done.stdout)
        self.assertIn("note: ball.translate.x: where its copies meet, Maya has the first value", done.stderr)
        self.assertEqual(self.values(scene, "bulge.magnitude", "34"), [(500,)])
        self.assertEqual(self.values(scene, "bulge.magnitude", "11"), [(0,)])
        text = self.read("shot.xml").decode()
        self.assertIn('<animate attribute="magnitude" after="repeat">', text)
        self.assertIn("  <!-- stays -->\n", text)
        self.assertIn('<point name="poke" center="0 0 0" deformationRadius="2" magnitude="3"></point>', text)

    def test_without_a_mapping_curves_go_where_their_names_say(self):
        moves = animated("center", (1, "0 1 2"), (20, "3 1 0"), (48, "0 0 0"))
        scene = self.scene(moves, BULGE)
        self.write("shot.xml", self.read("shot.xml").decode().replace('center="0 0 0" ', ""))
        for name in ("keys.json", "keys.gltf", "keys.glb", "keys.anim"):
            self.run_pliant("export", "curves", scene, "-o", name)
            other = self.write("other.xml", SCENE.format(poke="", bulge=""))
            done = self.run_pliant("import", "curves", name, "-o", other)
            self.assertIn("2 channels: ", done.stdout)
            for channel in ("poke.center", "bulge.magnitude"):
                for before, after in zip(self.values(scene, channel), self.values(other, channel)):
                    for one, two in zip(before, after):
                        self.assertAlmostEqual(one, two, delta=2e-3, msg=f"{name} {channel}")

    def test_curves_that_go_nowhere_are_told(self):
        scene, other = self.scene(), self.write("other.xml", SCENE.format(poke="", bulge=BULGE))
        self.run_pliant("export", "curves", other, "-o", "keys.json")
        keys = json.loads(self.read("keys.json"))
        keys["curves"] += [{**keys["curves"][0]}, {**keys["curves"][0], "data_path": "wobble"}]
        self.write("keys.json", json.dumps(keys))
        told = self.run_pliant("import", "curves", "keys.json", "-o", scene)
        self.assertIn("1 channel: bulge.magnitude", told.stdout)
        self.assertRegex(told.stderr, "no channel has the name of [^\n]*magnitude#2, [^\n]*wobble; --map gives one")

    def test_an_error_of_curves_is_on_no_line_of_the_scene(self):
        scene = self.scene()
        self.run_pliant("export", "curves", self.write("other.xml", SCENE.format(poke="", bulge=BULGE)), "-o", "keys.json")
        self.write("keys.json", self.read("keys.json").decode().replace('"co": [1, 0]', '"co": [1, 0.5]'))
        told = self.run_pliant("import", "curves", "keys.json", "-o", scene, "--map", "bulge.magnitude=poke.forceRadius*-1",
                               code=2).stderr
        self.assertRegex(told, r"^[^\n]*shot.xml: error: the scene cannot have the curves: [^\n]*forceRadius")

    def test_what_a_format_cannot_hold_is_told_or_refused(self):
        scene = self.scene(bulge=BULGE)
        done = self.run_pliant("export", "curves", scene, "-o", "keys.anim")
        self.assertRegex(done.stderr, r"keys.anim: note: bulge.magnitude: the elastic easing of key 12 became \d+ keys, "
                                      r"within 0\.000\d+\n")
        self.assertIn("the jump of key 30 became a step of 0.0078125 frames\n", done.stderr)
        os.remove(self.path("keys.anim"))
        self.assert_fails(["export", "curves", scene, "-o", "keys.anim", "--strict"],
                          "bulge.magnitude: the elastic easing of key 12 became")
        self.assertFalse(os.path.exists(self.path("keys.anim")))
        self.assertEqual(self.run_pliant("export", "curves", scene, "-o", "keys.json", "--channel", "bulge.magnitude",
                                         "--quiet").stdout, "")

    def test_elements_for_a_new_scene(self):
        text = self.run_pliant("import", "curves", self.write("ball.anim", ANIM), "-o", "-", "--map",
                               "ball.translate.x=poke.center.z").stdout
        self.assertTrue(text.startswith('<!-- poke -->\n<animate attribute="center" after="repeat">\n'), text)
        self.assertIn('<key frame="24" value="0 0 5" tangent="flat"/>', text)

    def test_vectors_of_a_world_with_z_up_are_turned(self):
        def curve(path, index, unit, first, last):
            tips = [{"co": [frame, value], "left": [frame - 1, value], "right": [frame + 1, value],
                     "interpolation": "LINEAR", "easing": "AUTO"} for frame, value in ((1, first), (11, last))]
            return {"owner": "Cube", "data_path": path, "index": index, "unit": unit, "keys": tips}

        vectors = {"location": ("LENGTH", (1, 2, 3), (4, 6, 8)), "rotation_euler": ("ROTATION", (0.1, 0.2, 0.3), (0, 0, 0)),
                   "scale": ("NONE", (1, 2, 3), (4, 5, 6))}
        curves = [curve(path, index, unit, first[index], last[index])
                  for path, (unit, first, last) in vectors.items() for index in range(3)]
        keys = self.write("keys.json", json.dumps(
            {"format": "blender-curves", "version": 1, "fps": 24, "curves": curves}))
        targets = {"location": "poke.center", "rotation_euler": "sheet.rotate", "scale": "sheet.scale"}
        maps = [word for path, channel in targets.items() for word in ("--map", f"Cube.{path}={channel}")]

        def taken(*options):
            scene = self.write("turned.xml", SCENE.format(poke="", bulge="").replace(' center="0 0 0"', ""))
            done = self.run_pliant("import", "curves", keys, "-o", scene, *maps, *options)
            return done.stderr, {path: self.values(scene, channel, "1") + self.values(scene, channel, "11")
                                 for path, channel in targets.items()}

        told, plain = taken()
        self.assertEqual(told.count("--up z turns"), 3, told)
        self.assertEqual(taken("--up", "y"), ("", plain))
        self.assertEqual(plain["location"], [(1, 2, 3), (4, 6, 8)])
        told, turned = taken("--up", "z")
        self.assertIn('give <transform> of sheet rotateOrder="xzy"', told)
        for path, values in plain.items():
            sign = 1 if path == "scale" else -1
            self.assertEqual(turned[path], [(x, z, sign * y) for x, y, z in values])
        # The turned angles turn the turned axes: C R = R' C with C (x, y, z) = (x, z, -y).
        def about(axis, degrees):
            c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
            matrix, (i, j) = np.eye(3), ((1, 2), (2, 0), (0, 1))[axis]
            matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
            return matrix

        (x, y, z), (u, v, w) = plain["rotation_euler"][0], turned["rotation_euler"][0]
        of_blender = about(2, z) @ about(1, y) @ about(0, x)
        of_pliant = about(1, v) @ about(2, w) @ about(0, u)  # xzy: x first
        axes = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        self.assertLess(np.abs(axes @ of_blender - of_pliant @ axes).max(), 1e-12)
        # A component goes where it is sent.
        scene = self.scene()
        self.run_pliant("import", "curves", keys, "-o", scene, "--map", "Cube.location.y=bulge.magnitude", "--up", "z")
        self.assertEqual(self.values(scene, "bulge.magnitude", "11"), [(6,)])
        self.assertIn("allowed: y, z", self.run_pliant("import", "curves", keys, "--up", "x", code=2).stderr)

    def test_problems_change_nothing(self):
        scene, anim = self.scene(), self.write("ball.anim", ANIM)
        before = self.read("shot.xml")
        for arguments, message in (
                ([anim, "-o", scene, "--map", "ball=poke.magnitude"], "the file has no such curve"),
                ([anim, "-o", scene, "--map", "ball.translate.x=pike.magnitude"], "nothing is named"),
                ([anim, "-o", scene, "--map", "ball.translate.x"], "must be SOURCE=CHANNEL"),
                ([anim, "-o", scene], "no curve of the file has the name of a channel"),
                ([anim, "-o", "none.xml", "--map", "a=b.c"], "the scene does not exist"),
                ([anim, "-o", scene, "--map", "ball.translate.x=poke.forceRadius*-1"], "forceRadius"),
                ([anim, "--map", "a=b.c"], "--map: needs -o"),
                ([anim, "-o", "-"], "--map: is needed with -o -"),
                (["none.anim"], "none.anim"),
                ([scene], "no format of curves has the ending \".xml\""),
                ([self.write("bad.anim", ANIM.replace("cycle", "round")), "-o", scene],
                 "bad.anim:14: error: postInfinity \"round\" is not known"),
                ([self.write("bad.json", "{\"format\": 1}"), "-o", scene], "bad.json: error: the file does not have")):
            self.assert_fails(["import", "curves", *arguments], message)
            self.assertEqual(self.read("shot.xml"), before)
        for arguments, message in (
                ([scene, "-o", "keys.fbx"], "no format of curves has the ending \".fbx\""),
                ([scene, "-o", "keys.anim"], "the scene has no animated channel"),
                ([scene, "-o", "keys.anim", "--channel", "poke.magnitude"], "is constant"),
                ([scene], "--out is required")):
            self.assert_fails(["export", "curves", *arguments], message)

        self.assert_fails(["export", "curves", scene, "-o", "no/keys.anim"], "the folder no does not exist", code=1)

    def assert_fails(self, arguments, message, code=2):
        lines = self.run_pliant(*arguments, code=code).stderr
        self.assertIn(message, lines, arguments)

    def test_buffers_of_a_gltf_stay_in_its_folder(self):
        scene = self.scene()
        document = {"asset": {"version": "2.0"}, "nodes": [{"name": "poke"}], "buffers": [
            {"byteLength": 8, "uri": "../secret.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 8}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR"}],
            "animations": [{"samplers": [{"input": 0, "output": 0}],
                            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]}
        os.mkdir(self.path("sub"))
        self.write("secret.bin", "12345678")
        self.write("sub/keys.gltf", json.dumps(document))
        self.assert_fails(["import", "curves", "sub/keys.gltf", "-o", scene], "../secret.bin")


if __name__ == "__main__":
    main()
