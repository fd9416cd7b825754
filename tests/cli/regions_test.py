"""`pliant bake --regions`."""

import json
import os
import re

import numpy as np

from command import SCENE, SOURCE, Command, main


class Regions(Command):
    SCENE = """<?xml version="1.0"?>
<scene version="1" fps="25" start="3" end="9">
  <surface name="sheet"><grid columns="25" rows="13" width="24" depth="12"/>
    <solver combine="islands" measure="rest"/></surface>
  <surface name="late"><grid columns="13" rows="13" width="12" depth="12"/><solver startFrame="6"/></surface>
  <surface name="off" enabled="false"><grid columns="13" rows="13"/></surface>
  <point name="a" center="-6 0 0" direction="0 3 4" deformationRadius="4.5" forceRadius="2.5" magnitude="300"/>
  <radial name="b" center="7 0 1" deformationRadius="2.5" forceRadius="99" magnitude="-70" targets="sheet"/>
  <line name="c" from="0 0 -5" to="1 0 -5" deformationRadius="0.5" magnitude="5" targets="sheet">
    <animate attribute="enabled"><key frame="3" value="true"/><key frame="5" value="false"/></animate></line>
</scene>
"""

    def told(self, *arguments, scene=SCENE):
        self.run_pliant("bake", self.write("r.xml", scene), "-o", "o.npy", "--regions", "r.json", *arguments)
        with open(self.path("r.json"), encoding="utf-8") as file:
            return json.load(file)

    @staticmethod
    def box(selected):
        """A box computed independently from the selected nodes, rows x columns."""
        if not selected.any():
            return None
        rows, columns = np.nonzero(selected)
        return {"columns": [columns.min(), columns.max()], "rows": [rows.min(), rows.max()]}

    def test_it_is_the_selection_of_each_frame(self):
        told = self.told()
        self.assertEqual((told["version"], told["fps"]), (1, 25))
        self.assertEqual([frame["frame"] for frame in told["frames"]], list(range(3, 10)))
        frames = np.load(self.path("o-sheet.npy"))
        x, z = frames[0][:, 0].reshape(13, 25), frames[0][:, 2].reshape(13, 25)  # at rest
        to_a, to_b = np.hypot(x + 6, z), np.hypot(x - 7, z - 1)
        for k, frame in enumerate(told["frames"]):
            sheet, late, off = frame["surfaces"]
            self.assertEqual([sheet["name"], late["name"], off["name"]], ["sheet", "late", "off"])
            names = [force["name"] for force in sheet["forces"]]
            self.assertEqual(names, ["a", "b", "c"] if frame["frame"] < 5 else ["a", "b"])
            a, b = sheet["forces"][:2]
            self.assertEqual(a["deformationBox"], self.box(to_a < 4.5))
            self.assertEqual(a["forceBox"], self.box(to_a < 2.5))
            self.assertEqual(b["deformationBox"], self.box(to_b < 2.5))
            self.assertEqual(b["forceBox"], self.box(to_b < 99))
            # Each island alone; b's force box is the whole sheet, but it acts only in its own
            # island.
            regions = [region for region in sheet["regions"] if region["solved"]]
            self.assertEqual([regions[0]["box"], regions[1]["box"]], [a["deformationBox"], b["deformationBox"]])
            self.assertEqual(sheet["regions"][a["region"]]["box"], a["deformationBox"])
            self.assertEqual(sheet["regions"][b["region"]]["box"], b["deformationBox"])
            self.assertEqual((sheet["steps"], sheet["unknowns"]), (4, 49 + 9))
            self.assertAlmostEqual(sheet["dt"], 0.01)
            self.assertEqual((a["center"], a["direction"], a["magnitude"]), ([-6, 0, 0], [0, 3, 4], 300))
            self.assertNotIn("direction", b)
            # a pushes 25 nodes along (0, 3, 4)/5.
            self.assertEqual(a["pushedNodes"], 25)
            np.testing.assert_allclose(a["load"], [0, 25 * 180, 25 * 240], rtol=1e-12, atol=1e-9)
            self.assertEqual(b["pushedNodes"], 8)  # of nine nodes, but not at its own centre
            if frame["frame"] < 5:
                c = sheet["forces"][2]
                self.assertFalse(sheet["regions"][c["region"]]["solved"])
                self.assertEqual((c["from"], c["pushedNodes"], c["load"]), ([0, 0, -5], 0, [0, 0, 0]))
            # The report at a frame gives the nodes that move until the next frame.
            if k + 1 < len(frames):
                moves = (frames[k] != frames[k + 1]).any(axis=1)
                self.assertLessEqual(moves.sum(), sheet["unknowns"])
            self.assertEqual((off["solved"], off["forces"], off["selected"]), (False, [], None))
            self.assertEqual(bool(late["forces"]), frame["frame"] >= 6)
        self.assertGreater(told["solver"]["factorizations"], 0)

    def test_the_page_shows_what_is_written(self):
        def keys(value):
            """The keys of nested objects in their order; for a list, those of its first element."""
            if isinstance(value, list):
                return [keys(value[0])] if value and isinstance(value[0], dict) else []
            return {key: keys(inner) for key, inner in value.items()} if isinstance(value, dict) else None
        with open(os.path.join(SOURCE, "docs", "regions.md"), encoding="utf-8") as file:
            page = file.read().partition("## Surfaces of triangles")[0]
        shown = json.loads(re.search(r"```json\n(.*?)```", page, re.DOTALL).group(1))
        self.assertEqual(json.dumps(keys(shown)), json.dumps(keys(self.told())))
        described = set(re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", page, re.MULTILINE))))
        others = """<uniform name="u" targets="sheet"/> <inertia name="i" targets="sheet"/>
          <vortex name="v" targets="sheet"/> <noise name="n" targets="sheet"/>
          <group name="g" targets="sheet"><point name="m"/></group></scene>"""
        told = self.told(scene=self.SCENE.replace("</scene>", others))
        kinds = [force["kind"] for force in told["frames"][0]["surfaces"][0]["forces"]]
        self.assertEqual(kinds[-6:], ["uniform", "inertia", "vortex", "noise", "point", "group"])
        surface = told["frames"][0]["surfaces"][0]
        force_keys = set().union(*(force.keys() for force in surface["forces"]))
        self.assertEqual(described, surface.keys() | force_keys | surface["regions"][0].keys())

    def test_it_tells_of_the_frames_that_are_written(self):
        whole, part = self.told(), self.told("--frames", "5:7")
        self.assertEqual(part["frames"], whole["frames"][2:5])

    def test_unions_list_their_parts_and_recovering_nodes_are_counted(self):
        switch = ('><animate attribute="enabled"><key frame="3" value="true"/><key frame="6" value="false"/>'
                  '</animate></radial>')
        scene = self.SCENE.replace('combine="islands"', 'combine="union" release="recover"').replace(
            'center="7 0 1"', 'center="-3 0 3"').replace(' targets="sheet"/>', switch)
        frames = self.told(scene=scene)["frames"]
        self.assertEqual(len(frames[0]["surfaces"][0]["regions"][0]["parts"]), 2)  # the line selects a row: no cell
        self.assertEqual(frames[0]["surfaces"][0]["recovering"], 0)
        self.assertGreater(frames[-1]["surfaces"][0]["recovering"], 0)

    def test_it_replaces_nothing_else(self):
        scene = self.write("r.xml", self.SCENE)
        os.mkfifo(self.path("pipe"))
        for out, regions in (("o.npy", "r.xml"), ("o.npy", "./o-sheet.npy"), ("o.obj", "o-late.0004.obj"),
                             ("o.npy", "pipe"), ("o.npy", "."), ("o.npy", "")):
            result = self.run_pliant("bake", scene, "-o", out, "--regions", regions, code=2)
            self.assertRegex(result.stderr, r"error: (--regions \S*: it is |cannot write the file: )")
            self.assertEqual(self.files(), ["pipe", "r.xml"])

    def test_it_is_there_whole_or_not_at_all(self):
        scene = self.write("r.xml", self.SCENE)
        self.run_pliant("bake", scene, "-o", "o.npy", "--regions", "none/r.json", code=1)
        failing = self.write("f.xml", self.SCENE.replace('magnitude="300"', 'magnitude="1e150"').replace(
            "<solver combine", '<material density="0" damping="0" b="1e-300" c="0" d="1e-300"/><solver combine'))
        self.run_pliant("bake", failing, "-o", "o.npy", "--regions", "r.json", code=1)
        self.assertEqual(self.files(), ["f.xml", "r.xml"])

    def test_recovery_and_tangents_exclude_each_other(self):
        scene = self.write("t.xml", self.SCENE.replace('combine="islands"', 'release="recover"').replace(
            "\n    <solver", '\n    <tangents su0="0" sv1="0.5"/><solver'))
        for command in (["validate", scene], ["bake", scene, "-o", "o.npy"]):
            result = self.run_pliant(*command, code=2)
            self.assertRegex(result.stderr, r'^\S*t\.xml:4: error: sheet\.sv1 is 0\.5, but '
                                            r'must be 0 with release="recover"\n$')


if __name__ == "__main__":
    main()
