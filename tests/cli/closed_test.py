"""Closed grids: `<mesh wrap="u|v|uv">`."""

import json
import math

import numpy as np

from command import Command, main

COLUMNS, ROWS = 24, 15


def tube(columns=COLUMNS, rows=ROWS, is_split=True, along="u"):
    """A tube about y as an OBJ. The vertices of its seam are there twice, or once with two UVs."""
    count = columns + 1 if is_split else columns
    lines = []
    for j in range(rows):
        for i in range(count):
            angle = 2 * math.pi * (i % columns) / columns
            lines.append(f"v {math.cos(angle)!r} {4 * j / (rows - 1)!r} {math.sin(angle)!r}")
    for j in range(rows):
        for i in range(columns + 1):
            u, v = i / columns, j / (rows - 1)
            lines.append(f"vt {u!r} {v!r}" if along == "u" else f"vt {v!r} {u!r}")
    for j in range(rows - 1):
        for i in range(columns):
            corners = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            lines.append("f " + " ".join(f"{q * count + p % count + 1}/{q * (columns + 1) + p + 1}" for p, q in corners))
    return "\n".join(lines) + "\n"


class Closed(Command):
    FORCE = '<point name="poke" center="{} 2 {}" direction="{} 0 {}" magnitude="30000" deformationRadius="0.9" forceRadius="0.6"/>'
    SWELL = '<radial name="swell" center="0 2 0" magnitude="-10000" deformationRadius="1.4" forceRadius="1.2"/>'

    def scene(self, forces, wrap="u", solver="", end=12):
        return self.write("scene.xml", f"""<scene version="1" start="1" end="{end}">
  <surface name="tube">
    <mesh file="tube.obj" wrap="{wrap}"/>
    {solver}
  </surface>
  {forces}
</scene>
""")

    def baked(self, *arguments):
        self.run_pliant("bake", "scene.xml", "-o", "o.npy", *arguments)
        return np.load(self.path("o.npy"))

    def poke(self, column):
        x, z = math.cos(2 * math.pi * column / COLUMNS), math.sin(2 * math.pi * column / COLUMNS)
        return self.FORCE.format(x, z, -x, -z)

    def test_a_force_on_the_seam_acts_as_elsewhere(self):
        self.write("tube.obj", tube())
        self.scene(self.poke(0.2))
        seam = self.baked("--regions", "r.json").reshape(12, ROWS, COLUMNS + 1, 3)
        with open(self.path("r.json"), encoding="utf-8") as file:
            told = json.load(file)["frames"][0]["surfaces"][0]
        first, last = told["selected"]["columns"]
        self.assertTrue(0 < first < COLUMNS <= last, told["selected"])
        self.assertEqual(told["regions"][0]["box"], told["selected"])
        self.assertEqual(told["forces"][0]["deformationBox"], told["selected"])
        # The twins of the seam are one.
        np.testing.assert_array_equal(seam[:, :, 0], seam[:, :, -1])
        self.scene(self.poke(10.2))
        elsewhere = self.baked().reshape(12, ROWS, COLUMNS + 1, 3)
        angle = 2 * math.pi * 10 / COLUMNS
        turn = np.array([[math.cos(angle), 0, -math.sin(angle)], [0, 1, 0], [math.sin(angle), 0, math.cos(angle)]])
        expected = np.roll((seam[:, :, :-1] @ turn.T), 10, axis=2)
        self.assertGreater(np.abs(seam[-1] - seam[0]).max(), 0.05)
        np.testing.assert_allclose(elsewhere[:, :, :-1], expected, atol=1e-11)

    def test_a_ring_goes_all_round(self):
        self.write("tube.obj", tube())
        self.scene(self.SWELL)
        ring = self.baked("--regions", "r.json").reshape(12, ROWS, COLUMNS + 1, 3)
        with open(self.path("r.json"), encoding="utf-8") as file:
            told = json.load(file)["frames"][0]["surfaces"][0]
        self.assertEqual(told["selected"]["columns"], [0, COLUMNS - 1])
        self.assertEqual(told["unknowns"], COLUMNS * (told["selected"]["rows"][1] - told["selected"]["rows"][0] - 1))
        radii = np.hypot(ring[..., 0], ring[..., 2])
        self.assertLess(radii[-1].min(), 0.9)
        np.testing.assert_allclose(radii, radii[:, :, :1].repeat(COLUMNS + 1, axis=2), atol=1e-12)

    def test_how_a_file_stores_the_seam_makes_no_difference(self):
        forces = self.poke(23.1) + self.SWELL
        self.write("tube.obj", tube())
        self.scene(forces)
        split = self.baked().reshape(12, ROWS, COLUMNS + 1, 3)
        self.write("tube.obj", tube(is_split=False))
        shared = self.baked().reshape(12, ROWS, COLUMNS, 3)
        np.testing.assert_array_equal(split[:, :, :-1], shared)

    def test_along_v_it_is_the_same_with_the_parameters_exchanged(self):
        self.write("tube.obj", tube())
        forces = self.poke(23.1) + self.SWELL
        solver = '<material b="2" d="3" density="40" damping="20"/>'
        self.scene(forces, solver=solver)
        along_u = self.baked()
        self.write("tube.obj", tube(along="v"))
        self.scene(forces, wrap="v", solver=solver.replace('b="2" d="3"', 'b="3" d="2"'))
        np.testing.assert_allclose(self.baked(), along_u, atol=1e-11)

    def test_the_same_bits_whatever_the_threads_and_in_any_order(self):
        self.write("tube.obj", tube())
        self.scene(self.poke(0.2) + self.SWELL, solver='<solver combine="union" release="recover"/>')
        whole = self.baked()
        np.testing.assert_array_equal(self.baked("--threads", "2", "--cache", "states"), whole)
        np.testing.assert_array_equal(self.baked("--frames", "5:12", "--cache", "states"), whole[4:])

    def test_a_cache_knows_whether_the_grid_is_closed(self):
        # Without wrap the mesh would have other columns; the states differ too.
        self.write("tube.obj", tube())
        self.scene(self.poke(0.2))
        self.baked("--cache", "states")
        self.write("tube.obj", tube(along="v"))
        self.scene(self.poke(0.2), wrap="v")
        alone = self.baked()
        np.testing.assert_array_equal(self.baked("--cache", "states"), alone)

    def test_info_tells_of_seam_and_ring(self):
        self.write("tube.obj", tube())
        self.scene(self.poke(0.2) + self.SWELL)
        text = self.run_pliant("info", "scene.xml").stdout
        self.assertIn(f"grid {COLUMNS} x {ROWS}, closed along u, {(COLUMNS + 1) * ROWS} vertices", text)
        self.assertRegex(text, r"it selects 7 x 7 nodes, columns 21 to 3 \(across the seam\), rows 4 to 10")
        self.assertRegex(text, r"it selects 24 x \d+ nodes, all columns \(a ring\), rows")
        facts = json.loads(self.run_pliant("info", "scene.xml", "--json").stdout)
        self.assertEqual((facts["surfaces"][0]["wrap"], facts["surfaces"][0]["columns"]), ("u", COLUMNS))
        self.assertGreater(facts["together"][0]["staticPeak"], 0)

    def test_a_log_of_it_verifies(self):
        self.write("tube.obj", tube())
        self.scene(self.poke(0.2) + self.SWELL)
        self.run_pliant("replay", "record", "scene.xml", "-o", "log.jsonl")
        self.run_pliant("replay", "verify", "log.jsonl", "scene.xml")

    def test_errors_name_line_and_rule(self):
        for wrap, is_split, rule in (
                ("v", True, "are 4 apart, but wrap makes them one node"),
                ('none" uv="grid', False, 'a seam; wrap="u" or "v" closes a grid there, and uv="surface"')):
            self.write("tube.obj", tube(is_split=is_split))
            self.scene(self.poke(0), wrap=wrap)
            result = self.run_pliant("validate", "scene.xml", code=2)
            self.assertIn('scene.xml:3: error: surface "tube", mesh tube.obj: the mesh is no even grid: vert',
                          result.stderr)
            self.assertIn(rule, result.stderr)
        self.write("tube.obj", tube())
        self.scene(self.poke(0), wrap='none" uv="grid')  # cut: both sides are there
        self.run_pliant("validate", "scene.xml")
        self.scene(self.poke(0), wrap="uw")
        result = self.run_pliant("validate", "scene.xml", code=2)
        self.assertRegex(result.stderr, r'scene.xml:3: error: .*wrap="uw": unknown word.*none, u, v, uv')


class Torus(Command):
    def test_nothing_holds_a_static_one(self):
        def vertex(i, j):
            a, b = 2 * math.pi * (i % 12) / 12, 2 * math.pi * (j % 9) / 9
            return f"v {(3 + math.cos(b)) * math.cos(a)!r} {math.sin(b)!r} {(3 + math.cos(b)) * math.sin(a)!r}"
        lines = [vertex(i, j) for j in range(10) for i in range(13)]
        lines += [f"vt {i / 12!r} {j / 9!r}" for j in range(10) for i in range(13)]
        lines += ["f " + " ".join(f"{k}/{k}" for k in (13 * j + i + 1, 13 * j + i + 2, 13 * j + i + 15, 13 * j + i + 14))
                  for j in range(9) for i in range(12)]
        self.write("torus.obj", "\n".join(lines) + "\n")
        scene = """<scene version="1" start="1" end="4">
  <surface name="ring"><mesh file="torus.obj" wrap="uv"/>{}</surface>
  <radial name="swell" magnitude="100" deformationRadius="{}" forceRadius="9"/>
</scene>
"""
        static = '<material density="0" damping="0"/>'
        self.write("scene.xml", scene.format(static, 9))
        result = self.run_pliant("bake", "scene.xml", "-o", "o.npy", code=1)
        self.assertRegex(result.stderr, r'error: .*"ring".*frame 1.*nothing holds a static surface')
        # What is left out holds it; so do inertia and drag.
        self.write("scene.xml", scene.format(static, 3.2))
        self.run_pliant("bake", "scene.xml", "-o", "o.npy")
        self.write("scene.xml", scene.format("", 9))
        self.run_pliant("bake", "scene.xml", "-o", "o.npy")
        text = self.run_pliant("info", "scene.xml").stdout
        self.assertIn("nothing holds the surface: it has no static peak", text)
        self.assertRegex(text, r"in the animation [0-9.e-]+ at frame \d")
        facts = json.loads(self.run_pliant("info", "scene.xml", "--json").stdout)
        self.assertIsNone(facts["together"][0]["staticPeak"])


if __name__ == "__main__":
    main()
