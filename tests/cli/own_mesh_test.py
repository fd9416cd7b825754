"""`pliant new --mesh`: meshes of every kind move, and stay within their frame, or it is told why not."""

import itertools
import os
import pty
import subprocess
import unittest

import numpy as np

from command import PLIANT, SANITIZED, Command, main

MATERIALS = ("rubber", "jelly", "metal", "cloth", "paper", "skin")


def ball(rings=8, sides=12, cut=0):
    """A sphere; `cut` rings are left out at the bottom, so that it is a bowl turned over."""
    vertices = [(0, 1, 0)]
    for ring in range(1, rings - cut):
        height = np.pi * ring / rings
        vertices += [(np.sin(height) * np.cos(a), np.cos(height), np.sin(height) * np.sin(a))
                     for a in 2 * np.pi * np.arange(sides) / sides]
    faces = [(0, 1 + (k + 1) % sides, 1 + k) for k in range(sides)]
    for ring in range(rings - cut - 2):
        for k in range(sides):
            a, b = 1 + sides * ring + k, 1 + sides * ring + (k + 1) % sides
            faces.append((a, b, b + sides, a + sides))
    if cut == 0:
        last = len(vertices)
        vertices.append((0, -1, 0))
        faces += [(last, last - sides + k, last - sides + (k + 1) % sides) for k in range(sides)]
    return np.array(vertices, float), faces


def sheet(columns=14, rows=14):
    """A flat sheet of triangles whose diagonals are mixed, so that it is no grid."""
    vertices = np.array([(x, 0, z) for z in range(rows) for x in range(columns)], float)
    faces = []
    for j, i in itertools.product(range(rows - 1), range(columns - 1)):
        a, b, c, d = (columns * (j + y) + i + x for x, y in ((0, 0), (0, 1), (1, 1), (1, 0)))
        faces += [(a, b, c), (a, c, d)] if (i * 7 + j * 3) % 5 < 2 else [(a, b, d), (b, c, d)]
    return vertices, faces


def tube(length=60, sides=9):
    vertices = np.array([(x / 4, np.cos(a), np.sin(a)) for x in range(length)
                         for a in 2 * np.pi * np.arange(sides) / sides])
    faces = [(sides * x + k, sides * x + (k + 1) % sides, sides * (x + 1) + (k + 1) % sides, sides * (x + 1) + k)
             for x in range(length - 1) for k in range(sides)]
    return vertices, faces


def together(*parts):
    vertices, faces, start = [], [], 0
    for points, polygons in parts:
        vertices.append(points)
        faces += [tuple(k + start for k in face) for face in polygons]
        start += len(points)
    return np.vstack(vertices), faces


def moved(mesh, by=(0, 0, 0), times=1):
    return mesh[0] * times + np.array(by, float), mesh[1]


FIN = (np.array([(6, 0, 6), (7, 0, 6), (6, 3, 6), (7, 3, 6)], float), [(0, 1, 3), (0, 3, 2)])  # on an edge of the sheet
BALLS = together(*(moved(ball(6, 8), (9 * k, 0, 0)) for k in range(5)))
BOWLS = together(*(moved(ball(8, 12, 3), (7 * k, 0, 0), 1 + k) for k in range(3)))
STRAY = (np.vstack([sheet()[0], [(1000, 5, 0), (6.5, 200, 6.5)]]), sheet()[1])
OCTAHEDRON = (np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float),
              [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])
TENT = (np.array([(0, 1, 0), (1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 0, -1)], float),
        [(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 1, 4)])
# Meshes, and whether something holds each piece.
SHAPES = {
    "closed": (ball(), False), "bowl": (ball(cut=3), True), "flat": (sheet(), True),
    "thin": (moved(ball(12, 20), times=np.array([1, 0.01, 1])), False), "long": (tube(), True),
    "balls": (BALLS, False), "bowls": (BOWLS, True), "stray": (STRAY, True),
    "fin": (together(sheet(), FIN), True), "octahedron": (OCTAHEDRON, False), "tent": (TENT, True),
    "tiny": (moved(ball(cut=3), times=1e-3), True), "huge": (moved(ball(cut=3), times=1e5), True),
    "far": (moved(ball(cut=3), (500000, 5400000, 300)), True), "far tiny": (moved(ball(), (3000, 0, 0), 1e-3), False),
}


class OwnMesh(Command):
    def obj(self, mesh):
        vertices, faces = mesh
        text = "".join("v %.17g %.17g %.17g\n" % tuple(v) for v in vertices)
        return self.write("m.obj", text + "".join("f " + " ".join(str(k + 1) for k in f) + "\n" for f in faces))

    def displacements(self, scene):
        self.run_pliant("bake", scene, "-o", "a.npy", "--space", "object", "--quiet")
        frames = np.load(self.path("a.npy"))
        return np.linalg.norm(frames - frames[0], axis=2).max(axis=0)

    def pieces_of(self, mesh):
        """The vertices of each piece."""
        vertices, faces = mesh
        places = {}
        of = [places.setdefault(tuple(v), k) for k, v in enumerate(vertices)]
        sets = {}
        for face in faces:
            joined = set().union(*(sets.get(of[k], {of[k]}) for k in face))
            for k in joined:
                sets[k] = joined
        return [sorted(s) for s in {id(s): s for s in sets.values()}.values()]

    def check(self, mesh, *arguments):
        self.run_pliant("new", *arguments, "--mesh", self.obj(mesh), "-o", "a.xml", "--force")
        size = max(np.linalg.norm(np.ptp(mesh[0][piece], axis=0)) for piece in self.pieces_of(mesh))
        self.assertEqual(self.run_pliant("validate", "a.xml").stderr, "")  # it says how the mesh is read
        peaks = self.displacements("a.xml")
        self.assertTrue(np.isfinite(peaks).all())
        self.assertTrue(0.005 * size < peaks.max() < size, (peaks.max() / size, arguments))
        return peaks

    def test_every_shape_moves_within_its_size(self):
        for name, (mesh, is_held) in list(SHAPES.items())[::4 if SANITIZED else 1]:
            with self.subTest(shape=name, starter="mesh"):
                peaks = self.check(mesh, "mesh")
                used = np.unique([k for face in mesh[1] for k in face])
                self.assertLess(peaks[used].min(), 1e-6 * peaks.max())  # something is left alone
                if name in ("balls", "bowls"):
                    pushed = [p for p in self.pieces_of(mesh) if peaks[p].max() > 0]
                    self.assertEqual(len(pushed), 1)
            with self.subTest(shape=name, starter="jiggle"):
                self.check(mesh, "jiggle")
                self.assertEqual("goal=" in self.read("a.xml").decode(), not is_held)

    @unittest.skipIf(SANITIZED, "bakes for many minutes")
    def test_every_material_moves_within_the_size(self):
        mesh = ball(cut=3)
        for starter, material in itertools.product(("mesh", "jiggle"), MATERIALS):
            with self.subTest(starter=starter, material=material):
                self.check(mesh, starter, "--material", material)

    def test_a_mesh_that_cannot_move_is_refused(self):
        cases = {"one face": (np.eye(3), [(0, 1, 2)]), "a strip": sheet(2, 9),
                 "one place": (np.ones((3, 3)), [(0, 1, 2)]), "a line": (np.outer(range(4), (1, 0, 0)), [(0, 1, 2), (1, 2, 3)])}
        for (name, mesh), starter in itertools.product(cases.items(), ("mesh", "jiggle")):
            with self.subTest(shape=name, starter=starter):
                told = self.run_pliant("new", starter, "--mesh", self.obj(mesh), "-o", "b.xml", code=2).stderr
                self.assertEqual(told.count("\n"), 1, told)
                self.assertIn("m.obj", told)
                self.assertNotIn("b.xml", self.files())

    def test_places_are_told_apart(self):
        for scale, offset in ((1, (500000, 5400000, 300)), (1e-3, (3000, 0, 0)), (1e5, (0, 0, 0))):
            mesh = moved(ball(cut=3), offset, scale)
            told = self.run_pliant("new", "mesh", "--mesh", self.obj(mesh), "-o", "a.xml", "--force").stderr
            self.assertEqual("single precision" in told, any(offset), told)
            if any(offset):
                moved_back = np.array(told.split('translate="')[1].split('"')[0].split(), float)
                self.assertLess(np.abs(mesh[0].mean(axis=0) + moved_back).max(), 2 * scale)
            text = self.read("a.xml").decode()
            center = np.array([float(x) for x in text.split(' center="')[1].split('"')[0].split()])
            self.assertLess(np.linalg.norm(mesh[0] - center, axis=1).min(), 2e-3 * scale)

    def test_stray_vertices_change_nothing(self):
        texts = []
        for mesh in (sheet(), STRAY):
            self.run_pliant("new", "mesh", "--mesh", self.obj(mesh), "-o", "a.xml", "--force")
            texts.append(self.read("a.xml"))
        self.assertEqual(*texts)

    def on_terminal(self, *arguments):
        """What the command writes to a stderr that is a terminal."""
        ours, theirs = pty.openpty()
        with subprocess.Popen([PLIANT, *arguments], stdout=subprocess.DEVNULL, stderr=theirs, cwd=self.folder) as process:
            os.close(theirs)
            text = b""
            try:
                while part := os.read(ours, 4096):
                    text += part
            except OSError:  # the end of a terminal
                pass
            os.close(ours)
            self.assertEqual(process.wait(), 0, text)
        return text

    def test_long_work_shows_itself_on_a_terminal_only(self):
        self.obj(sheet())
        commands = (["new", "mesh", "--mesh", "m.obj", "-o", "a.xml", "--force"], ["info", "a.xml"],
                    ["suggest", "a.xml", "--peak", "0.5"])
        for command in commands:
            with self.subTest(command=command[0]):
                shown = self.on_terminal(*command)
                self.assertRegex(shown, rb'\r\x1b\[K\[[#.]{30}\] \d+/\d+ [a-z ]+"body"')
                left = shown.rsplit(b"\r\x1b[K", 1)[1]  # once the line is erased
                self.assertRegex(left, rb"^$|^[^\r\n]*: note: [^\r\n]*\r\n$")
                for quiet in (self.on_terminal(*command, "--quiet"), self.run_pliant(*command).stderr.encode()):
                    self.assertNotIn(b"\x1b", quiet)


if __name__ == "__main__":
    main()
