"""Tests of `pliant suggest`: what it promises is what a bake shows, which is measured here without
the library: the peak, when the curve stays near its end, and the ring by a fit of decaying
vibrations."""

import json
import os
import random
import re
import stat
import unittest

import numpy as np

from command import SANITIZED, Command, main

SCENE = """<scene version="1" fps="{fps}" start="1" end="{end}">
  <surface name="sheet">
    <grid columns="{columns}" rows="{rows}" width="{width}" depth="{depth}"/>
    <material density="{density}" {damping} b="{b}" c="2" d="1"/>
    <solver {solver}/>
  </surface>
  {forces}
</scene>
"""
KEYED = """<?xml version="1.0"?>
<!-- A comment with density="7" and <key frame="1" value="3"/>. -->
<scene version='1' start="1"   end="40">\r
  <surface name="sheet"><!-- the material: density="9" -->
    <grid columns="17" rows="17"
          width="16" depth="16"/>
  </surface>
  <group name="hand" deformationRadius="6">
    <point name='poke' center="0 0 0"
           forceRadius="2.5"
           falloff="smooth">
      <animate attribute = "magnitude" tangent="40" before="slope 3">
        <key frame="1" value="0"/>  <!-- at rest -->
        <key  value="16000" frame="6" out="-12.5" in="flat"/>
        <key frame="12" value="-8e3" inHandle="-2 150" left="100"/>
        <key frame="18" value="0" interpolation="elasticOut" amplitude="900"/>
        <key frame="36" value="500"/>
        <loop from="12" to="20" after="1" offset="70"/>
      </animate>
    </point>
    <radial name="push" center="1 0 1" forceRadius="1.5" magnitude=" 250 "/>
  </group>
</scene>
"""


def vibrations(curve):
    """The poles of a sum of decaying vibrations, and their amplitudes: a matrix pencil (Y. Hua,
    T. K. Sarkar, 1990)."""
    half = len(curve) // 2
    hankel = np.array([curve[k:k + half + 1] for k in range(len(curve) - half)])
    _, sizes, rows = np.linalg.svd(hankel, full_matrices=False)
    count = max(1, min(int((sizes > 1e-7 * sizes[0]).sum()), half // 2, 16))
    basis = rows[:count].T
    poles = np.linalg.eigvals(np.linalg.pinv(basis[:-1]) @ basis[1:])
    powers = poles[None, :] ** np.arange(len(curve))[:, None]
    amplitudes, *_ = np.linalg.lstsq(powers, curve.astype(complex), rcond=None)
    return poles, amplitudes


def ring_of(curve, fps):
    """The frequency of the vibration that is most visible, by amplitude times period [Hz]."""
    poles, amplitudes = vibrations(curve)
    rates = np.abs(np.angle(poles)) * fps / (2 * np.pi)
    weights = np.where((rates > 1e-3) & (np.abs(poles) > 1e-3), np.abs(amplitudes) / np.maximum(rates, 1e-3), 0)
    return rates[weights.argmax()]


def settled_at(curve):
    """The frame, a fraction, from which on the curve stays within 5 % of 0."""
    last = np.nonzero(np.abs(curve) > 0.05)[0][-1]
    if last + 1 == len(curve):
        return np.inf
    before, after = abs(curve[last]), abs(curve[last + 1])
    return last + (before - 0.05) / (before - after if curve[last] * curve[last + 1] > 0 else before + after)


def random_scene(rng):
    fps = rng.choice([24, 25, 60])
    forces = "".join(
        f'<{kind} name="f{k}" center="{rng.uniform(-1, 1):.3f} 0 {rng.uniform(-1, 1):.3f}" '
        f'deformationRadius="{rng.uniform(3.5, 6):.3f}" forceRadius="{rng.uniform(1.5, 3):.3f}" '
        f'magnitude="{rng.choice([-1, 1]) * rng.uniform(100, 5000):.4g}" falloff="{falloff}"/>'
        for k, (kind, falloff) in enumerate(zip(rng.sample(["point", "radial", "point"], rng.choice([1, 1, 2])),
                                                ["smooth", "constant"])))
    integrator = rng.choice(["backwardEuler", "backwardEuler", "newmark", "exact"])
    dt = rng.choice([0.001, 0.003, 0.01, 0.03])
    solver = f'measure="rest" integrator="{integrator}" dt="{dt}"'
    if rng.random() < 0.2:
        solver += ' region="all"'
        forces = re.sub(r' deformationRadius="[^"]*"', "", forces)
    elif rng.random() < 0.3:
        solver += ' timeScale="0.7"'
    damping = rng.choice(['damping="{:.3g}"', 'damping="{:.3g}"', 'dampingRatio="{:.3g}"'])
    damping = damping.format(rng.uniform(0.05, 0.5) if "Ratio" in damping else rng.uniform(1, 100))
    return dict(fps=fps, columns=rng.randint(11, 23), rows=rng.randint(11, 23), width=rng.uniform(11, 15),
                depth=rng.uniform(11, 15), density=f"{10 ** rng.uniform(0, 3):.4g}", damping=damping,
                b=rng.choice([1, 1, 3]), solver=solver, forces=forces, end=2)


class Suggest(Command):
    def suggest(self, *arguments, code=0):
        return json.loads(self.run_pliant("suggest", *arguments, "--json", code=code).stdout)

    def bake(self, text):
        scene = self.write("bake.xml", text)
        self.run_pliant("bake", scene, "-o", self.path("a.npy"), "--quiet")
        frames = np.load(self.path("a.npy"))
        os.remove(self.path("a.npy"))
        return frames - frames[0]

    def test_what_is_found_is_what_a_bake_shows(self):
        met = asked = 0
        for seed in range(6 if SANITIZED else 40):
            rng = random.Random(seed)
            values = random_scene(rng)
            fps = values["fps"]
            ring = rng.uniform(0.8, fps / 8)
            settle = rng.uniform(0.5, 3) / ring
            peak = 10 ** rng.uniform(-2, 1)
            values["end"] = 2 + int(8 * settle * fps) + 2 * fps
            goals = ["--peak", f"{peak:.6g}"]
            wants = rng.choice(["both", "both", "settle", "ring"])
            if wants != "ring":
                goals += ["--settle", f"{1000 * settle:.6f}ms"]
            if wants != "settle":
                goals += ["--ring", f"{ring:.6f}Hz"]
            scene = self.write("scene.xml", SCENE.format(**values))
            with self.subTest(seed=seed, wants=wants, solver=values["solver"]):
                done = self.run_pliant("suggest", scene, *goals, "--json", "--write", code=None)
                told = json.loads(done.stdout)
                parts = [told[name] for name in ("peak", "settlingTime", "frequency") if told[name]]
                misses = [part["miss"] for part in parts]
                self.assertEqual(done.returncode, 0 if max(misses) <= 0.02 else 1)
                self.assertEqual(told["met"], max(misses) <= 0.02)
                for part in parts:
                    self.assertTrue(part["miss"] <= 0.02 or part["reason"], part)
                asked += 1
                met += told["met"]
                self.assertLess(told["peak"]["miss"], 0.02)
                self.check_bake(told, self.read("scene.xml").decode(), values)
        print(f"{met} of {asked} met", flush=True)
        self.assertGreaterEqual(met, 0.5 * asked)

    def check_bake(self, told, text, values):
        fps = values["fps"]
        moved = self.bake(text)
        sizes = np.linalg.norm(moved, axis=2)
        self.assertLess(abs(sizes.max() / told["peak"]["found"] - 1), 1e-6)
        still = re.sub(r'density="[^"]*" (damping|dampingRatio)="[^"]*"', 'density="0" damping="0"', text)
        rest = self.bake(re.sub(r'integrator="newmark"', "", still))[-1]
        node = np.linalg.norm(rest, axis=1).argmax()
        size = np.linalg.norm(rest[node])
        curve = moved[:, node] @ rest[node] / size / size - 1
        settled = settled_at(curve)
        if told["settlingTime"] and settled < len(curve):
            found = told["settlingTime"]["found"] * fps
            self.assertLess(abs(found - settled), max(1, 0.05 * settled), (found, settled))
        vibration = told["after"]["regions"][told["region"]]["vibration"]
        if told["frequency"] and vibration["dampingRatio"] < 0.3:  # more hides it among others
            measured = ring_of(curve[:400], fps)
            found = told["frequency"]["found"]
            self.assertLess(abs(measured / found - 1), 0.02, (measured, found))

    def test_what_a_collider_stops_has_the_peak_of_a_bake(self):
        text = """<scene version="1" start="1" end="16">
  <surface name="sheet"><grid columns="13" rows="11" width="10" depth="10"/>
    <material density="1" damping="15"/><solver region="all"/></surface>
  <point name="poke" center="{at}" direction="0 -1 0" forceRadius="2.5" magnitude="{magnitude}"/>
  <collider name="floor"><plane/><transform translate="0 -0.5 0"/></collider>
  <collider name="ball"><sphere/><transform>
    <animate attribute="translate"><key frame="1" value="0 1.5 0"/><key frame="9" value="0 0.7 0"/></animate>
  </transform></collider>
</scene>
"""
        for at, direction, peak, is_met in (("0 0 0", 1, 0.4, True), ("0 0 0", 1, 0.8, False),
                                            ("3 0 1", -1, 0.9, True), ("3 0 1", 1, 0.2, False)):
            with self.subTest(at=at, peak=peak):
                scene = self.write("scene.xml", text.format(at=at, magnitude=900 * direction))
                told = self.suggest(scene, "--peak", str(peak), "--write", code=0 if is_met else 1)
                away = self.bake(self.read("scene.xml").decode())
                shown = np.sqrt((away ** 2).sum(axis=2)).max()
                self.assertAlmostEqual(told["peak"]["found"] / shown, 1, places=9)
                self.assertEqual(told["met"], is_met)
                if not is_met:
                    self.assertRegex(told["peak"]["reason"], "colliders hold it back|moves so far without these forces")

    def test_what_was_found_is_printed_though_it_cannot_be_written(self):
        self.write("rig.xml", '<fragment><point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2"'
                              ' magnitude="900"/></fragment>')
        scene = self.write("scene.xml", '<scene version="1" start="1" end="12"><surface name="sheet"><grid columns="21" '
                                        'rows="21" width="10" depth="10"/></surface><include file="rig.xml"/></scene>')
        result = self.run_pliant("suggest", scene, "--peak", "1", "--write", code=2)
        self.assertIn("poke.magnitude", result.stdout)
        self.assertRegex(result.stderr, r'"poke" does not stand in this file, but in .*rig\.xml:1; edit that file')

    def test_a_material_of_an_included_file_is_left_there(self):
        self.write("m.xml", '<fragment><material damping="2"/></fragment>')
        text = ('<scene version="1" start="1" end="12"><surface name="sheet"><grid columns="21" rows="21" width="10" '
                'depth="10"/><include file="m.xml"/></surface><point name="poke" deformationRadius="4" '
                'forceRadius="2" magnitude="900"/></scene>')
        scene = self.write("scene.xml", text)
        result = self.run_pliant("suggest", scene, "--ring", "2Hz", "--write", code=2)
        self.assertRegex(result.stderr, r'the <material> of "sheet" does not stand in this file, but in .*m\.xml:1; edit')
        self.assertEqual(self.read("scene.xml").decode(), text)

    def test_a_number_takes_the_place_of_a_definition(self):
        scene = self.write("scene.xml", '<scene version="1" start="1" end="12"><define name="m" value="450"/><surface '
                                        'name="sheet"><grid columns="21" rows="21" width="10" depth="10"/></surface>'
                                        '<point name="poke" deformationRadius="4" forceRadius="2" magnitude="$m * 2"/>'
                                        '</scene>')
        told = self.suggest(scene, "--peak", "1", "--write")
        number = f'{told["values"][0]["after"]:g}'
        self.assertIn(f'magnitude="{number}"', self.read("scene.xml").decode())
        self.assertIn(f"{number} takes the place of $m * 2; what else uses the definition keeps its value",
                      told["notes"])

    def test_only_numbers_change(self):
        scene = self.write("scene.xml", "")
        with open(scene, "wb") as file:
            file.write(KEYED.encode())
        os.chmod(scene, 0o640)
        told = self.suggest(scene, "--peak", "0.5", "--write")
        self.assertTrue(told["written"])
        after = self.read("scene.xml").decode()
        self.assertEqual(stat.S_IMODE(os.stat(scene).st_mode), 0o640)
        self.assertEqual(self.files(), ["scene.xml"])
        # Without its numbers, the text is the same; and only those of the magnitudes changed.
        number = r"-?\d+(\.\d+)?(e-?\d+)?"
        self.assertEqual(re.sub(number, "#", after), re.sub(number, "#", KEYED))
        before = [match[0] for match in re.finditer(number, KEYED)]
        now = [match[0] for match in re.finditer(number, after)]
        changed = {(a, b) for a, b in zip(before, now) if a != b}
        scaled = {"16000", "-12.5", "-8e3", "150", "100", "900", "500", "70", "40", "3", "250"}
        self.assertEqual({a for a, _ in changed}, scaled)
        factors = [float(b) / float(a) for a, b in changed]
        self.assertLess(max(factors) / min(factors), 1.002)
        # The comments stay, and so do keys that are 0.
        self.assertIn('density="7" and <key frame="1" value="3"/>', after)
        self.assertIn('<key frame="1" value="0"/>  <!-- at rest -->', after)
        # Nothing changes if it is done again.
        self.assertFalse(self.suggest(scene, "--peak", "0.5", "--write")["written"])
        self.assertEqual(self.read("scene.xml").decode(), after)

    def test_numbers_that_are_not_there_are_added(self):
        scene = self.write("scene.xml", KEYED)
        told = self.suggest(scene, "--settle", "1s", "--ring", "2Hz", "--write")
        values = {value["channel"]: value["after"] for value in told["values"]}
        after = self.read("scene.xml").decode()
        line = (f'    <material damping="{values["sheet.damping"]:g}" '
                f'density="{values["sheet.density"]:g}"/>\n')
        self.assertIn('depth="16"/>\n' + line, after)
        self.assertEqual(after.replace(line, ""), KEYED)

    def test_without_write_the_scene_stays(self):
        scene = self.write("scene.xml", KEYED)
        before = self.read("scene.xml")
        text = self.run_pliant("suggest", scene, "--peak", "0.5").stdout
        self.assertEqual(self.read("scene.xml"), before)
        self.assertIn("poke.magnitude", text)
        self.assertRegex(text, r"peak +0\.5 +0\.[45]\d* +[+-]?0\.\d+ % +at frame \d+")
        piped = self.run_pliant("suggest", "-", "--peak", "0.5", code=2)  # no input
        self.assertIn("error", piped.stderr)

    def test_units(self):
        scene = self.write("scene.xml", KEYED)
        found = {self.suggest(scene, "--settle", time, code=None)["settlingTime"]["wanted"]
                 for time in ("1s", "1000ms", "24f", "24 frames", " 1 s ")}
        self.assertEqual(found, {1.0})
        for ring in ("2Hz", "2 Hz", "2"):
            self.assertEqual(self.suggest(scene, "--ring", ring, code=None)["frequency"]["wanted"], 2)

    def test_wrong_usage(self):
        scene = self.write("scene.xml", KEYED)
        for arguments, words in (
                ([], "--peak, --settle and --ring"),
                (["--peak", "0"], "--peak"),
                (["--peak", "1m"], "--peak"),
                (["--peak", "1e300"], "greater than 0 and less than 1e100"),
                (["--settle", "1"], "s, ms or f"),
                (["--settle", "-1s"], "s, ms or f"),
                (["--ring", "2s"], "such as 2Hz"),
                (["--peak", "1", "--force", "pike"], 'no force "pike"'),
                (["--peak", "1", "--surface", "shet"], 'no surface "shet"')):
            with self.subTest(arguments=arguments):
                errors = self.run_pliant("suggest", scene, *arguments, code=2).stderr
                self.assertIn(words, errors)
                self.assertEqual(errors.count("\n"), 1)
        errors = self.run_pliant("suggest", "-", "--peak", "1", "--write", code=2).stderr
        self.assertIn("--write", errors)
        os.symlink(scene, self.path("link.xml"))
        self.run_pliant("suggest", self.path("link.xml"), "--peak", "1", "--write", code=2)

    def test_a_missed_goal_is_explained_and_the_nearest_written(self):
        coarse = KEYED.replace("</surface>", '<solver dt="0.05"/></surface>')
        scene = self.write("scene.xml", coarse)
        told = self.suggest(scene, "--settle", "3s", "--ring", "2Hz", "--write", code=1)
        self.assertEqual(told["settlingTime"]["obstacle"], "stepsDamp")
        self.assertTrue(told["written"])
        finer = re.search(r'dt="([^"]*)"', told["settlingTime"]["reason"])[1]
        self.write("scene.xml", coarse.replace("0.05", finer))
        self.assertTrue(self.suggest(scene, "--settle", "3s", "--ring", "2Hz")["met"])
        far = self.write("far.xml", KEYED.replace('name="hand"', 'name="hand" center="0 90 0"'))
        before = self.read("far.xml")
        told = self.suggest(far, "--peak", "1", "--write", code=1)
        self.assertEqual(told["peak"]["obstacle"], "nothingMoves")
        self.assertRegex(self.run_pliant("suggest", scene, "--settle", "1e-9s", code=1).stdout, r"\+\d\.\d+e\+\d+ %")
        self.assertFalse(told["written"])
        self.assertEqual(self.read("far.xml"), before)


if __name__ == "__main__":
    main()
