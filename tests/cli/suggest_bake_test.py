"""What `pliant suggest` calls found is what a bake shows: for every starter and example that moves, and for every
choice of a scene that changes what a bake does."""

import glob
import json
import os
import re
import shutil
import unittest

from command import SANITIZED, SOURCE, Command, main

GOOD = 0.1  # of what is told; what is found is far nearer
SCENE = """<scene version="1" fps="24" start="1" end="{end}">
  <surface name="sheet" {surface}>
    <grid columns="15" rows="15" width="14" depth="14"/>
    <material density="40" damping="20" {material}/>
    <solver {solver}/>
  </surface>
  {forces}
</scene>
"""
POKE = ('<point name="poke" center="0.4 0 0.3" deformationRadius="5" forceRadius="3" falloff="smooth"><animate '
        'attribute="magnitude"><key frame="1" value="0"/><key frame="6" value="900"/><key frame="13" value="-300"/>'
        '<key frame="25" value="0"/></animate></point>')
STEADY = '<point name="poke" center="0.4 0 0.3" deformationRadius="5" forceRadius="3" magnitude="700"/>'
FAR = STEADY.replace("poke", "other").replace("0.4 0 0.3", "-5 0 -5").replace('Radius="5"', 'Radius="2.5"')
MEMBERS = re.sub(r' deformationRadius="[^"]*"', "", POKE + FAR)
GROUP = f'<group name="hand" center="0 0 0" deformationRadius="6">{MEMBERS}</group>'
CASES = {
    "loop": dict(solver='loop="24"'), "loop rest": dict(solver='loop="24" measure="rest" integrator="newmark"'),
    "loop exact": dict(solver='loop="24" integrator="exact"'), "part of a loop": dict(solver='loop="24"', end=9),
    "loop twice": dict(solver='loop="24"', end=60), "loop steady": dict(solver='loop="5"', forces=STEADY),
    "loop whole": dict(solver='loop="24" region="all" measure="rest"'),
    "loop without a cycle": dict(solver='loop="24" region="all" edges="free" integrator="newmark" measure="rest"',
                                 material='', forces=STEADY),
    "newmark": dict(solver='integrator="newmark"'), "exact": dict(solver='integrator="exact" measure="rest"'),
    "steady": dict(solver='measure="rest"', forces=STEADY), "preroll": dict(solver='preroll="8"'),
    "time": dict(solver='timeScale="0.4"'), "ratio": dict(material='dampingRatio="0.1"', solver='measure="rest"'),
    "large dt": dict(solver='dt="0.05"'), "whole": dict(solver='region="all"'),
    "pinned": dict(solver='region="all" edges="pinned free clamped free"'),
    "plastic": dict(material='yield="2" hardening="0.2"', solver='measure="rest"'), "group": dict(forces=GROUP),
    "islands": dict(solver='combine="islands"', forces=POKE + FAR), "union": dict(solver='combine="union"', forces=POKE + FAR),
    "none": dict(solver='reference="none"'), "recover": dict(solver='release="recover"'),
    "inertia": dict(solver='region="all"', forces='<inertia name="lag" magnitude="1"/>',
                    surface='>\n<transform><animate attribute="translate"><key frame="1" value="0 0 0"/><key frame="9" '
                            'value="3 1 0"/></animate></transform><!-- --'),
}


class SuggestBake(Command):
    def baked_peak(self, scene, told):
        """The largest displacement that the bake's summary tells."""
        text = self.run_pliant("bake", scene, "-o", "b.npy", "--surface", told["surface"]).stdout
        return float(re.search(r"peak displacement ([-+.e\d]+)", text)[1])

    def check(self, scene, *goals, **options):
        done = self.run_pliant("suggest", scene, *goals, "--json", "--write", code=None, **options)
        if done.returncode == 2:
            return None
        told = json.loads(done.stdout)
        self.assertEqual(done.returncode, 0 if told["met"] else 1)
        peak = told["peak"]
        if peak["found"] is not None:
            self.assertAlmostEqual(self.baked_peak(scene, told) / peak["found"], 1, delta=GOOD)
        else:
            self.assertTrue(peak["reason"])
            self.assertFalse(told["met"])
        return told

    def test_every_choice_of_a_scene(self):
        for name, case in list(CASES.items())[::4 if SANITIZED else 1]:
            values = {"end": 30, "surface": "", "material": "", "solver": "", "forces": POKE, **case}
            text = SCENE.format(**values)
            if "dampingRatio" in text:
                text = text.replace('damping="20"', "")
            if name == "loop without a cycle":
                text = text.replace('damping="20"', 'damping="0"')
            for goals in (["--peak", "0.4"], ["--peak", "3", "--ring", "2Hz"]):
                with self.subTest(case=name, goals=goals):
                    told = self.check(self.write("scene.xml", text), *goals)
                    self.assertIsNotNone(told, "the scene is wrong")
                    if name == "loop without a cycle":
                        self.assertEqual(told["peak"]["obstacle"], "noCycle")
                    elif name not in ("none",):
                        self.assertIsNotNone(told["peak"]["found"])

    @unittest.skipIf(SANITIZED, "bakes for many minutes")
    def test_every_starter(self):
        for name in sorted(os.path.basename(f)[:-4] for f in glob.glob(os.path.join(SOURCE, "cli/new/starters/*.xml"))):
            with self.subTest(starter=name):
                self.run_pliant("new", name, "-o", f"{name}.xml")
                told = self.check(self.path(f"{name}.xml"), "--peak", "0.3")
                self.assertTrue(told["met"], told["peak"])

    @unittest.skipIf(SANITIZED, "bakes for many minutes")
    def test_every_example(self):
        folder = self.path("examples")
        shutil.copytree(os.path.join(SOURCE, "examples"), folder)
        asked = 0
        for scene in sorted(glob.glob(os.path.join(folder, "*.xml"))):
            with self.subTest(example=os.path.basename(scene)):
                told = self.check(scene, "--peak", "0.3")
                asked += told is not None
        self.assertGreater(asked, 10)


if __name__ == "__main__":
    main()
