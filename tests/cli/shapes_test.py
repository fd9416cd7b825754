"""Animated shapes, from files of other programs to bakes and back: every command, every format."""

import json
import os
import struct

import numpy as np

from command import Command, main

COLUMNS, ROWS, FRAMES = 9, 7, 10


def sheet():
    i, j = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    x, z = (2.0 * k - (n - 1) for k, n in ((i, COLUMNS), (j, ROWS)))
    return np.stack([x / 2, 0 * x, z / 2], axis=-1).reshape(-1, 3)


def waves(count=FRAMES):
    """Numbers that single precision holds."""
    rest = sheet()
    return np.array([rest + np.stack([0 * rest[:, 0], np.sin(rest[:, 0] + 0.4 * k), 0.1 * k + 0 * rest[:, 0]], axis=1)
                     for k in range(count)]).astype("f4").astype(float)


class Shapes(Command):
    def cache(self, name, samples, first=1, rate=1.0, fps=24.0):
        path = self.path(name)
        count, vertices, _ = samples.shape
        if name.endswith(".npy"):
            np.save(path, samples)
        else:
            with open(path, "wb") as file:
                if name.endswith(".pc2"):
                    file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, vertices, first, rate, count))
                    file.write(samples.astype("<f4").tobytes())
                else:
                    file.write(struct.pack(">ii", count, vertices))
                    file.write((np.arange(count) / fps).astype(">f4").tobytes() + samples.astype(">f4").tobytes())
        return path

    def scene(self, cache, more="", solver='region="all"', name="scene.xml", end=12):
        self.write(name, f"""<scene version="1" start="1" end="{end}">
  <surface name="hide">
    <grid columns="{COLUMNS}" rows="{ROWS}" width="{COLUMNS - 1}" depth="{ROWS - 1}" cache="{cache}"{more}/>
    <material density="30" damping="20"/><solver {solver}/>
  </surface>
  <inertia name="sway" forceRadius="99" deformationRadius="99"/>
</scene>""")
        return name

    def bake(self, scene, out="out.npy", *arguments):
        self.run_pliant("bake", scene, "-o", out, "--quiet", *arguments)
        return np.load(self.path(out)) if out.endswith(".npy") else None

    def test_formats_give_the_same_bits(self):
        samples = waves()
        bakes = []
        for name in ("a.npy", "a.pc2", "a.mdd", "b.npy"):
            self.cache(name, samples.astype("f4") if name == "b.npy" else samples)
            bakes.append(self.bake(self.scene(name)))
        self.assertGreater(np.abs(bakes[0][1:FRAMES] - samples[1:]).max(), 0.01)
        for one in bakes[1:]:
            self.assertEqual(one.tobytes(), bakes[0].tobytes())

    def test_a_bake_is_a_cache_again(self):
        # There and back: what is at rest is the cache, in each format that is written.
        samples = waves()
        self.cache("a.npy", samples)
        still = self.scene("a.npy", solver='startFrame="99"')
        for name in ("b.npy", "b.pc2", "b.mdd"):
            self.bake(still, name)
            again = self.bake(self.scene(name, solver='startFrame="99"', name="again.xml"), "c.npy")
            shown = np.concatenate([samples, samples[-1:], samples[-1:]])
            self.assertEqual(again.tobytes(), shown.tobytes())

    def test_exports_have_the_displaced_shape(self):
        self.cache("a.npy", waves())
        scene = self.scene("a.npy")
        baked = self.bake(scene)
        for name in ("a.glb", "a.usda", "a.obj", "a.ply", "a.mdd", "a.pc2"):
            self.bake(scene, name)
        lines = self.read("a.0007.obj").decode().splitlines()
        found = np.array([[float(word) for word in line.split()[1:]] for line in lines if line.startswith("v ")])
        self.assertTrue((found == baked[6]).all())
        numbers = np.frombuffer(self.read("a.pc2"), "<f4", offset=32).reshape(baked.shape)
        self.assertTrue((numbers == baked.astype("f4")).all())

    def test_what_does_not_fit_is_refused_with_one_line(self):
        samples = waves()
        bad = samples.copy()
        bad[4, 11, 2] = np.inf
        self.cache("bad.npy", bad)
        self.cache("few.pc2", samples[:, :-1])
        self.cache("cut.mdd", samples)
        with open(self.path("cut.mdd"), "r+b") as file:
            file.truncate(300)
        self.write("text.npy", "1 2 3")
        refusals = [("bad.npy", ["sample 4, at frame 5", "vertex 11", "inf", "finite"]),
                    ("few.pc2", ["62 vertices", "63"]), ("cut.mdd", ["truncated"]), ("text.npy", [".npy"]),
                    ("none.npy", ["none.npy", "No such file"]), (".", ["folder"]), ("scene.xml", [".pc2, .mdd or .npy"])]
        for cache, parts in refusals:
            scene = self.scene(cache)
            for command in (("bake", scene, "-o", "x.npy"), ("validate", scene), ("info", scene)):
                with self.subTest(cache=cache, command=command[0]):
                    result = self.run_pliant(*command, code=2)
                    lines = result.stderr.strip().splitlines()
                    self.assertEqual(len(lines), 1, lines)
                    self.assertTrue(lines[0].startswith("scene.xml:3: error: "), lines)
                    for part in parts:
                        self.assertIn(part, lines[0])
        self.assertFalse(os.path.exists(self.path("x.npy")))

    def test_a_cache_larger_than_the_memory_is_read_in_parts(self):
        count = 3000  # 4.5 MB
        samples = np.tile(waves(1), (count, 1, 1))
        samples[:, :, 1] += 0.01 * np.arange(count)[:, None] ** 1.5
        self.cache("long.npy", samples)
        scene = self.scene("long.npy", end=40)
        small = self.bake(scene, "small.npy", "--max-memory", "0.002")
        self.assertEqual(small.tobytes(), self.bake(scene, "large.npy").tobytes())
        result = self.run_pliant("bake", scene, "-o", "x.npy", "--max-memory", "0.00008", code=1)
        self.assertIn("surface \"hide\"", result.stderr)
        self.assertIn("allowed", result.stderr)

    def test_no_output_overwrites_a_cache(self):
        cache = self.cache("a.npy", waves())
        before = self.read("a.npy")
        result = self.run_pliant("bake", self.scene("a.npy"), "-o", "a.npy", code=2)
        self.assertIn("would overwrite a.npy, an input of the scene", result.stderr)
        self.assertEqual(self.read("a.npy"), before)
        self.assertTrue(os.path.samefile(cache, self.path("a.npy")))

    def test_a_log_knows_when_the_cache_changes(self):
        samples = waves()
        self.cache("a.npy", samples)
        self.run_pliant("replay", "record", self.scene("a.npy"), "-o", "a.replay")
        self.run_pliant("replay", "verify", "a.replay")
        samples[5] += 0.25
        self.cache("a.npy", samples)
        result = self.run_pliant("replay", "verify", "a.replay", code=1)
        self.assertIn("a.npy", result.stdout + result.stderr)

    def test_states_are_kept_until_the_cache_changes_them(self):
        samples = waves()
        self.cache("a.npy", samples)
        scene = self.scene("a.npy")
        first = self.bake(scene, "a1.npy", "--cache", "states")
        self.assertEqual(self.bake(scene, "a2.npy", "--cache", "states").tobytes(), first.tobytes())
        samples[8, 30] += 0.5
        self.cache("a.npy", samples)
        changed = self.bake(scene, "a3.npy", "--cache", "states")
        self.assertEqual(changed.tobytes(), self.bake(scene, "a4.npy").tobytes())
        self.assertTrue((changed[:8] == first[:8]).all())
        self.assertFalse((changed[9] == first[9]).all())

    def test_info_tells_of_the_cache(self):
        self.cache("a.pc2", waves(), first=2, rate=0.5)
        scene = self.scene("a.pc2")
        self.assertIn("cache a.pc2: 10 samples, frames 2 to 6.5", self.run_pliant("info", scene).stdout)
        told = json.loads(self.run_pliant("info", scene, "--json").stdout)
        self.assertEqual(told["surfaces"][0]["cache"], {"file": "a.pc2", "samples": 10, "first": 2, "last": 6.5})
        self.run_pliant("validate", scene)


if __name__ == "__main__":
    main()
