"""How the starter scenes and materials of `pliant new` move: whole bakes, for minutes."""

import json
import os
import re

import numpy as np

from command import main
from new_test import MATERIALS, STARTERS, WITH_MESH, Starters


class Materials(Starters):
    def test_starters_move_within_their_size_and_calm_down_without_a_note(self):
        for name in STARTERS:
            self.run_pliant("new", name, "-o", f"{name}.xml")
            self.assertEqual(self.run_pliant("validate", f"{name}.xml").stderr, "")
            moved, notes = self.displacements(f"{name}.xml")
            self.assertEqual(notes, "")
            box = json.loads(self.run_pliant("info", f"{name}.xml", "--json").stdout)["surfaces"][0]["ownBoundingBox"]
            size = np.linalg.norm(np.subtract(box["high"], box["low"]))
            self.assertTrue(np.isfinite(moved).all() and moved[0] == 0, name)
            self.assertTrue(0.03 * size < moved.max() < 0.45 * size, (name, moved.max(), size))
            self.assertLess(moved[-5:].max(), 0.75 * moved.max(), name)

    def test_a_material_swings_as_its_comment_says(self):
        for starter, materials in (("sheet", MATERIALS), ("jiggle", ("rubber", "metal"))):
            for material in materials:
                out = f"{starter}-{material}.xml"
                self.run_pliant("new", starter, "-o", out, "--material", material)
                with open(self.path(out), encoding="utf-8") as file:
                    text = file.read()
                wanted = float(re.search(r"swings\s+([\d.]+)\s+times", text)[1])
                vibration = self.together(out)["regions"][0]["vibration"]
                self.assertAlmostEqual(vibration["naturalFrequency"] / wanted, 1, delta=0.01)
                self.assertAlmostEqual(vibration["naturalDampingRatio"], self.attribute(text, "dampingRatio"), delta=0.002)
                self.assertLessEqual(max(map(len, text.splitlines())), 110)
                self.assertEqual(self.run_pliant("validate", out).stderr, "")

    def test_materials_look_like_their_names(self):
        peak, after = {}, {}
        for material in (None,) + MATERIALS:
            out = f"{material}.xml"
            self.run_pliant("new", "sheet", "-o", out, *(["--material", material] if material else []))
            moved = self.displacements(out)[0]
            peak[material] = moved.max()
            after[material] = moved[44:64].max() / moved.max()  # half a second after it is let go
            if material in ("metal", "paper"):
                # What stays: the mean of some periods at the end.
                stays = moved[-10:].mean() / moved.max()
                self.assertGreater(stays, {"metal": 0.15, "paper": 0.05}[material], material)
            elif material not in ("jelly", None):
                self.assertLess(moved[-10:].mean() / moved.max(), 0.04, material)
        # Soft and stiff.
        self.assertLess(peak["metal"], peak["paper"])
        self.assertLess(peak["paper"], peak["rubber"])
        self.assertLess(peak["rubber"], peak["cloth"])
        self.assertLess(peak["cloth"], peak["jelly"])
        for material, share in (("rubber", 1), ("jelly", 1.6), ("metal", 0.6 * 1.35), ("cloth", 1.4),
                                ("paper", 0.8 * 1.12), ("skin", 1.2)):
            self.assertAlmostEqual(peak[material] / peak[None], share, delta=0.06 * share)
        # Jelly wobbles long, rubber rings, cloth and skin do not.
        self.assertGreater(after["jelly"], 0.5)
        self.assertTrue(0.05 < after["rubber"] < after["jelly"])
        self.assertLess(max(after["cloth"], after["skin"]), 0.1)

    def test_equal_blows_leave_equal_dents(self):
        self.run_pliant("new", "dent", "-o", "dent.xml")
        self.run_pliant("bake", "dent.xml", "-o", "a.npy")
        depths = -np.load(self.path("a.npy"))[:, :, 1].reshape(72, 61, 3, 27).min(axis=(1, 3))
        peaks = depths.max(axis=0)
        self.assertTrue((depths[-1] > 0.3 * peaks).all() and (depths[-1] < 0.7 * peaks).all(), depths[-1])
        # Alike but for the rounding of where they are, and at rest: no blow freezes the dent before.
        self.assertLess(np.ptp(depths[-1]), 1e-9 * peaks[0])
        self.assertLess(np.ptp(peaks), 1e-9 * peaks[0])
        for blow, frame in enumerate((6, 24, 42)):
            settled = depths[frame + 17:, blow]
            self.assertLess(np.ptp(settled), 0.01 * peaks[0])

    def test_what_yields_has_round_dents(self):
        for starter, material, is_round in (("sheet", "metal", True), ("sheet", "rubber", False),
                                            ("dent", None, True), ("trampoline", "paper", False)):
            self.run_pliant("new", starter, "-o", "a.xml", "--force",
                            *(["--material", material] if material else []))
            self.assertEqual('uv="surface"/>' in self.read("a.xml").decode(), is_round, (starter, material))
        self.run_pliant("new", "sheet", "-o", "a.xml", "--force", "--material", "metal")
        moved = self.displacements("a.xml")[0]
        self.assertGreater(moved[-1], 0.15 * moved.max())  # a dent stays
        self.run_pliant("bake", "a.xml", "-o", "a.npy")
        last = np.abs(np.load(self.path("a.npy"))[-1, :, 1]).reshape(49, 49)
        self.assertLess(np.abs(last - last.T).max(), 1e-6 * last.max())
        self.assertLess(max(last[0, 0], last[-1, -1]), 1e-12)

    def test_a_flag_keeps_its_length(self):
        for material in (None, "cloth", "jelly"):  # jelly is the softest
            out = f"{material}.xml"
            self.run_pliant("new", "flag", "-o", out, *(["--material", material] if material else []))
            self.run_pliant("bake", out, "-o", "a.npy")
            flag = np.load(self.path("a.npy")).reshape(120, 41, 61, 3)
            for axis, length in ((2, 9), (1, 6)):
                lengths = np.linalg.norm(np.diff(flag, axis=axis), axis=3).sum(axis=axis)
                self.assertTrue((lengths > 0.9 * length).all() and (lengths < 1.2 * length).all(),
                                (material, axis, lengths.min(), lengths.max()))

    def test_every_starter_takes_every_material(self):
        for starter, materials in (("trampoline", MATERIALS), ("dent", MATERIALS), ("mesh", ("jelly", "metal"))):
            for material in materials:
                out = f"{starter}-{material}.xml"
                self.run_pliant("new", starter, "-o", out, "--material", material)
                size = 2 if starter == "mesh" else 8
                moved = self.displacements(out)[0]
                self.assertTrue(np.isfinite(moved).all())
                self.assertTrue(0.01 * size < moved.max() < 0.4 * size, (out, moved.max()))

    def test_a_mesh_of_ones_own_at_any_size(self):
        os.mkdir(self.path("shots"))
        peaks = {}
        for scale in (0.02, 1.0, 300.0):
            self.own_mesh("dome.obj", scale)
            for starter in WITH_MESH:
                self.run_pliant("new", starter, "-o", "shots/a.xml", "--mesh", "dome.obj", "--force")
                text = self.read("shots/a.xml").decode()
                self.assertIn('file="../dome.obj"', text)
                peak = self.displacements("shots/a.xml")[0].max() / scale
                peaks.setdefault(starter, []).append(peak)
                vibration = self.together("shots/a.xml")["regions"][0]["vibration"]
                self.assertAlmostEqual(vibration["naturalFrequency"], {"mesh": 3, "jiggle": 2.2}[starter], delta=0.05)
        for starter in WITH_MESH:  # the same motion at each size
            self.assertTrue(0.05 < min(peaks[starter]) and max(peaks[starter]) < 1, peaks)
            self.assertLess(max(peaks[starter]) / min(peaks[starter]), 1.05, peaks)
        self.assertEqual(sorted(os.listdir(self.path("shots"))), ["a.xml"])


if __name__ == "__main__":
    main()
