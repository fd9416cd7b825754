"""Scenes and meshes that are refused: each with a one-line message that gives the place, within
limits of time and memory."""

import os
import resource
import subprocess

from command import Command, GRID, PATH, PLIANT, POINT, SANITIZED, SCENE, animated, main


# name: (text to replace in the scene, replacement, line of the error, words of its message)
BAD_SCENES = {
    "a misspelt element": ("<grid", "<gird", 3, 'did you mean "grid"'),
    "a misspelt attribute": ("magnitude", "magnitud", 4, 'did you mean "magnitude"'),
    "a missing mesh file": (GRID, '<mesh file="none.obj"/>', 3, "No such file"),
    "a folder as a mesh file": (GRID, '<mesh file="folder.obj"/>', 3, "it is a folder"),
    "nan": ("3000", "nan", 4, "not a finite number"),
    "a decimal comma": ("3000", "1,5", 4, 'write the decimal point as "."'),
    "a hexadecimal number": ("3000", "0x10", 4, "follows 0"),
    "a number beyond all": ("3000", "1e999", 4, "outside the range"),
    "text after a number": ("3000", "3000N", 4, '"N" follows 3000'),
    "a vector of two numbers": ("0 0 0", "0 0", 4, "three numbers are required, not 2"),
    "two surfaces of one name": ("<point", f'<surface name="sheet">{GRID}</surface><point', 4,
                                 "the name is already used at line 3"),
    "two keys at one frame": (POINT, '<point name="p">' + animated("magnitude", (1, 0), (1, 2)) +
                              "</point>", 4, "repeats the key"),
    "an attribute given and animated": (POINT, '<point name="p" magnitude="3">' +
                                        animated("magnitude", (1, 0)) + "</point>", 4, "remove one of them"),
    "two columns": ('columns="13"', 'columns="2"', 3, "at least 3"),
    "end before start": ('end="9"', 'end="0"', 2, "must not be before"),
    "dt of 0": (GRID, GRID + '<solver dt="0"/>', 3, "must be greater than 0"),
    "a million steps": (GRID, GRID + '<solver dt="4e-8"/>', 3, "at most 100000 are allowed"),
    "c too small at a frame in the middle": (
        GRID, GRID + "<material>" + animated("c", (1, 0), (5, -3), (9, 0)) + "</material>", 3,
        "sheet.c at frame 4 is -2."),
    "a preroll below 0": (GRID, GRID + '<solver preroll="-1"/>', 3, "must be at least 0"),
    "a preroll beyond all": (GRID, GRID + '<solver preroll="100001"/>', 3, "at most 100000"),
    "a loop of 0 frames": (GRID, GRID + '<solver loop="0"/>', 3, "must be at least 1"),
    "a preroll and a loop": (GRID, GRID + '<solver preroll="3" loop="8"/>', 3,
                             "sheet.preroll is 3 and sheet.loop is 8"),
    "a channel below 0 in a preroll": (
        GRID, GRID + '<solver preroll="9"/><material><animate attribute="density" before="linear">'
        '<key frame="1" value="4" interpolation="linear"/><key frame="5" value="8"/></animate>'
        "</material>", 3, "sheet.density at frame -8 is -"),
    "a channel below 0 in a loop": (
        GRID, GRID + '<solver loop="12"/><material>' + animated("damping", (1, 4), (9, 0), (12, -1)) +
        "</material>", 3, "sheet.damping at frame 10 is -"),
    "a goal without a shape at rest": (
        GRID, GRID + '<material goal="2"/><solver reference="none"/>', 3,
        'sheet.goal is 2, but must be 0 with reference="none"'),
    "a collider without a shape": (
        "<point", '<collider name="b"/><point', 4, '<collider> "b" has no shape: one <sphere>, <capsule>, <box>, <plane> or'),
    "a collider of two shapes": (
        "<point", '<collider name="b"><sphere/><plane/></collider><point', 4, '<collider> "b" has two shapes'),
    "a ball that is an ellipsoid": (
        "<point", '<collider name="b"><sphere/><transform scale="1 2 1"/></collider><point', 4,
        "b.scale is 1 2 1, but must be equal along x, y and z: use equal scales, or a mesh"),
    "a box that is rounder than thick": (
        "<point", '<collider name="b"><box size="1 0.5 1" round="0.3"/></collider><point', 4,
        "b.round is 0.3, but must be at most 0.25"),
    "a collider that is no ball behind the last frame": (
        "<point", '<collider name="b"><sphere>' + animated("radius", (9, 1), (10, -1)) + "</sphere></collider><point",
        4, "b.radius at frame 10 is -1, but must be greater than 0"),
    "a collider in a group": (
        "<point", '<group name="g"><collider name="b"><sphere/></collider></group><point', 4,
        '<group> has no element "collider"; it belongs in <scene>'),
    "contact and exact steps": (
        GRID, GRID + '<solver integrator="exact"/></surface><collider name="b"><sphere/></collider>'
        f'<surface name="other">{GRID}', 3, 'sheet.integrator is "exact", but the collider "b" acts on it'),
    "contact without a shape at rest": (
        GRID, GRID + '<solver reference="none"/></surface><collider name="b"><sphere/></collider>'
        f'<surface name="other">{GRID}', 3, 'sheet.reference is "none", but the collider "b" acts on it'),
    "a hold of nothing": (GRID, GRID + "<hold/>", 3, "sheet.hold.0: a hold needs a file, an attribute or vertices"),
    "a hold of vertices and a threshold": (
        GRID, GRID + '<hold vertices="1" above="0.5"/>', 3, 'sheet.hold.0: a hold of vertices has no "above"'),
    "a hold of vertices and a file": (
        GRID, GRID + '<hold vertices="1" file="a.png"/>', 3, "sheet.hold.0: a hold of vertices has no file"),
    "a hold of two sources": (
        GRID, GRID + '<hold attribute="_pin" file="a.png"/>', 3,
        "sheet.hold.0: a hold has a file or an attribute, but this one has both"),
    "a hold in a sheet by an attribute": (
        GRID, GRID + '<hold attribute="_pin"/>', 3,
        'the attribute "_pin" is one of a mesh\'s vertices, but the surface is no <mesh>'),
    "a hold of a vertex that is not there": (
        GRID, GRID + '<hold vertices="1"/><hold vertices="999999"/>', 3,
        "sheet.hold.1: there is no vertex 999999: the surface has "),
    "a hold of a vertex below 0": (GRID, GRID + '<hold vertices="1 -2"/>', 3, '"-2"'),
    "a hold of no numbers": (GRID, GRID + '<hold vertices="1 x"/>', 3, '"x"'),
    "a hold in a union": (
        GRID, GRID + '<hold vertices="1"/><solver combine="union"/>', 3,
        'sheet.hold.0: a <hold> needs rectangles, but sheet.combine is "union"'),
    "a hold without a shape at rest": (
        GRID, GRID + '<hold vertices="1"/><solver reference="none"/>', 3, 'but sheet.reference is "none"'),
    "a hold of another kind of file": (
        GRID, GRID + '<hold file="a.jpg"/>', 3, "its name must end in .png or .npy"),
    "a damping and its ratio": (GRID, GRID + '<material damping="1" dampingRatio="0.1"/>', 3,
                                "sheet.damping and sheet.dampingRatio are both given"),
    "a yield with exact steps": (
        GRID, GRID + '<material yield="1"/><solver integrator="exact"/>', 3,
        'sheet.yield: sheet.integrator is "exact"'),
    "a yield that falls to 0": (
        GRID, GRID + "<material>" + animated("yield", (1, 1), (9, -1)) + "</material>", 3,
        "sheet.yield at frame 5 is 0, but must be greater than 0"),
    "no hardening where nothing else resists": (
        GRID, GRID + '<material yield="1" density="0" damping="0" hardening="0"/>', 3,
        "sheet.hardening is 0, but must be greater than 0 where density and damping are 0"),
    "a ratio below 0 at a frame": (
        GRID, GRID + "<material>" + animated("dampingRatio", (1, 1), (9, -1)) + "</material>", 3,
        "sheet.dampingRatio at frame 6 is -"),
    "a deformationRadius in a group": (POINT, f'<group name="g">{POINT}</group>', 4,
                                       "a force in a <group> must not have one"),
    "a group in a group": (POINT, '<group name="g"><group name="h"/></group>', 4,
                           'it belongs in <scene>'),
    "a group for a target": (POINT, '<group name="g"/><uniform name="u" targets="g"/>', 4,
                             '"g" is a <group>, not a surface'),
    "a name twice, once in a group": (POINT, '<group name="g"><noise name="sheet"/></group>', 4,
                                      "the name is already used at line 3"),
    "a group's radius below 0 at a frame": (
        POINT, '<group name="g">' + animated("deformationRadius", (1, 1), (9, -1)) + "</group>", 4,
        "g.deformationRadius at frame 6 is -"),
    "two falloffs": (POINT, '<point name="p" falloff="linear"><falloff><key at="0" value="1"/>'
                            "</falloff></point>", 4, "remove one of them"),
    "a falloff's key beyond 1": (POINT, '<point name="p"><falloff><key at="2" value="1"/></falloff>'
                                        "</point>", 4, 'at="2": must be from 0 to 1'),
    "a misspelt kind of force": (POINT, '<vortx name="v"/>', 4, 'did you mean "vortex"'),
    "another kind's attribute": (POINT, '<vortex name="v" direction="0 1 0"/>', 4,
                                 'no attribute "direction"'),
    "a seed below 0": (POINT, '<noise name="n" seed="-1"/>', 4, "must be at least 0"),
    "a position given and on a path": (
        POINT, f'<point name="p" center="0 0 0">{PATH}</point>', 4, "remove one of them"),
    "a path of two waypoints": (
        POINT, '<point name="p">' + PATH.replace('<waypoint at="1 1 0"/>', "") + "</point>", 4,
        "at least three waypoints"),
    "a path for a direction": (
        POINT, '<point name="p">' + PATH.replace('"center"', '"direction"') + "</point>", 4,
        "is not a position; the positions of <point> are: center"),
    "progress beyond the end at a frame": (
        POINT, '<point name="p">' + PATH.replace("</path>", animated("progress", (1, 0), (5, 2)) +
                                                 "</path>") + "</point>", 4,
        "p.center.progress at frame 4 is 1."),
    "a NUL byte": ("poke", "po\0ke", 4, "a NUL byte"),
    "a grid of 200000 x 200000": (GRID, '<grid columns="200000" rows="200000"/>', 3, "at most 100000000"),
    "10^5 nested elements": (GRID, "<a>" * 100000 + "</a>" * 100000, 3, "nested deeper"),
}

# name: (text of the mesh file, line of the error in it, words of its message)
BAD_MESHES = {
    "an index out of range": ("v 0 0 0\nv 1 0 0\nv 1 0 1\nvt 0 0\nf 1/1 2/1 9/1\n", 5, "9"),
    "coordinates that are not finite": ("v 0 0 nan\nv 1 0 0\nv 1 0 1\nvt 0 0\nf 1/1 2/1 3/1\n", 1, "nan"),
    "no faces": ("v 0 0 0\n", None, "no faces"),
}


class BadInput(Command):
    def refused(self, scene):
        """The lines that a bake prints for a scene that it refuses. Checks limits of time and
        memory, and that no files are left."""
        before = self.files()
        limit = (2 << 30, 2 << 30)

        def bounded():
            if not SANITIZED:  # sanitizers reserve more address space than any limit
                resource.setrlimit(resource.RLIMIT_AS, limit)

        result = subprocess.run([PLIANT, "bake", scene, "-o", self.path("out.npy")], timeout=30,
                                capture_output=True, text=True, check=False, preexec_fn=bounded)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(self.files(), before)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        # What needs no solve is told by validate too, in the same words.
        validated = self.run_pliant("validate", scene, code=2).stderr.splitlines()
        self.assertEqual([line for line in validated if ": note: " not in line], lines)
        return lines

    def test_bad_scenes(self):
        os.mkdir(self.path("folder.obj"))
        for name, (old, new, line, words) in BAD_SCENES.items():
            with self.subTest(name):
                text = SCENE.format(end=9)
                self.assertIn(old, text)
                lines = self.refused(self.write("s.xml", text.replace(old, new, 1)))
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], rf"^\S*s\.xml:{line}: error: ")
                self.assertIn(words, lines[0])

    def test_meshes_of_colliders(self):
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        sides = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
        vertices = "".join("v %d %d %d\n" % corner for corner in corners)

        def write(name, faces):
            self.write(name, vertices + "".join("f %s\n" % " ".join(map(str, face)) for face in faces))

        write("cube.obj", sides)
        write("open.obj", sides[:5])
        write("turned.obj", sides[:5] + [sides[5][::-1]])
        write("fin.obj", sides + [(1, 2, 8)])
        write("bare.obj", [])
        mesh = '<mesh file="cube.obj"/>'
        for shape, words in (
                ('<mesh file="open.obj"/>', 'collider "b", mesh *open.obj: the edge between vertices 2 and 4 has one face, '
                 "but a collider is closed"),
                ('<mesh file="turned.obj"/>', "the edge between vertices 2 and 4 has two faces that run through it in "
                 "the same direction"),
                ('<mesh file="fin.obj"/>', "the edge between vertices 1 and 2 has 3 faces"),
                ('<mesh file="bare.obj"/>', "face"),
                ('<mesh file="none.obj"/>', 'collider "b": '),
                ('<mesh file="cube.obj" cache="none.npy"/>', 'collider "b": '),
                ('<mesh file="cube.obj" object="lid"/>', "lid"),
                ("<mesh/>", '<mesh> needs the attribute "file"'),
                ('<mesh file="cube.obj" cacheStart="3"/>', "b.cacheStart is given, but no cache"),
                ('<mesh file="cube.obj" weld="0.1"/>', "<mesh> weld: that is of a surface's mesh"),
                ('<mesh file="cube.obj" uv="surface"/>', "<mesh> uv: that is of a surface's mesh"),
                ('<mesh file="cube.obj" uvSet="1"/>', "<mesh> uvSet: that is of a surface's mesh"),
                ('<mesh file="cube.obj" radius="1"/>', '<mesh> has no attribute "radius"'),
                (mesh + "<sphere/>", '<collider> "b" has two shapes')):
            with self.subTest(shape=shape):
                line, = self.refused(self.write("s.xml", SCENE.format(end=9).replace(
                    "<point", f'<collider name="b">{shape}</collider><point')))
                self.assertRegex(line, r"^\S*(s\.xml:4|(bare|cube)\.obj\S*): error: ")
                for part in words.split("*"):
                    self.assertIn(part, line)
        self.run_pliant("bake", self.write("s.xml", SCENE.format(end=3).replace(
            "<point", f'<collider name="b">{mesh}</collider><point')), "-o", self.path("good.npy"))

    def test_static_surfaces_that_nothing_holds(self):
        static = '<material density="0" damping="0"/><solver region="all"/>'
        fading = ('<material damping="0"><animate attribute="density"><key frame="1" value="9"/>'
                  '<key frame="5" value="0"/></animate></material><solver region="all"/>')
        lattice = [(x, y, z) for x in range(4) for z in range(4) for y in (0, 5) if (x, y, z) != (3, 5, 3)]
        numbers = {place: k + 1 for k, place in enumerate(lattice)}
        cells = [[numbers[x + i, y, z + j] for i, j in ((0, 0), (0, 1), (1, 1), (1, 0))]
                 for y in (0, 5) for x in range(3) for z in range(3) if (x + 1, y, z + 1) in numbers]
        self.write("sheets.obj", "".join("v %d %d %d\n" % place for place in lattice) +
                   "".join("f %d %d %d %d\n" % tuple(cell) for cell in cells))
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        sides = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
        self.write("cube.obj", "".join("v %d %d %d\n" % corner for corner in corners) +
                   "".join("f %d %d %d %d\n" % side for side in sides))
        torus = " ".join(f"{x} {y} {x * y % 3}" for y in range(4) for x in range(4))
        net = '<nurbs columns="4" rows="4" degreeU="2" degreeV="2" wrap="{}"><points>' + torus + "</points></nurbs>"
        open_ring = static.replace("<solver", '<solver edges="clamped clamped free free"')
        free = '<mesh file="sheets.obj" uv="surface" border="free"/>'
        for parts, words in (
                (free + static, "s.density is 0, and so is damping, but nothing holds the piece with vertex 1: give it a "
                                "density or a damping"),
                (free + fading, "s.density at frame 5 is 0, and so is damping"),
                ('<mesh file="cube.obj"/>' + static, "nothing holds the piece with vertex 1"),
                (net.format("uv") + static, "nothing holds a surface that is closed along u and v"),
                (net.format("u") + open_ring, "or a clamped edge or two pinned ones"),
                (GRID + static.replace("<solver", '<solver edges="free"'), "or a clamped edge or two pinned ones")):
            with self.subTest(words=words, parts=parts[:60]):
                line, = self.refused(self.write("s.xml", f'<scene version="1" start="1" end="9"><surface name="s">{parts}'
                                                '</surface><uniform name="u" magnitude="1"/></scene>'))
                self.assertIn(words, line)
        # A border that holds, what is not static, and what is not solved.
        for parts in (free.replace("free", "pinned") + static, free + static.replace('density="0"', ""),
                      free + static.replace(' region="all"', ""), net.format("u") + static):
            self.run_pliant("bake", self.write("s.xml", f'<scene version="1" start="1" end="3"><surface name="s">{parts}'
                                               '</surface><uniform name="u" magnitude="1"/></scene>'),
                            "-o", self.path("good.npy"))

    def test_a_loop_that_does_not_close(self):
        """Is found while it runs: exit code 1."""
        with open(self.path("quad.obj"), "w", encoding="utf-8") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 4 3 2\n")
        scene = self.write("s.xml", """<scene version="1" start="1" end="9">
          <surface name="quad"><mesh file="quad.obj" uv="surface" border="free"/>
            <material damping="0"/><solver region="all" loop="4"/></surface>
          <uniform name="wind" magnitude="2" forceRadius="9"/></scene>""")
        result = subprocess.run([PLIANT, "bake", scene, "-o", self.path("out.npy")], timeout=60,
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, r's\.xml:2: error: surface "quad", frame \d: its motion does '
                         r"not close to a cycle of 4 frames: after \d+ rounds .* damping")

    def test_all_at_once(self):
        text = SCENE.format(end=9)
        for old, new in ((POINT, '<point name="poke" magnitud="3" center="0 0"/>'),
                         (GRID, '<mesh file="none.obj"/><material>' +
                          animated("c", (1, 0), (5, -3), (9, 0)) + "</material><nonsense/>")):
            text = text.replace(old, new)
        lines = self.refused(self.write("s.xml", text))
        self.assertEqual(len(lines), 5, lines)

    def test_bad_meshes(self):
        scene = self.write("s.xml", SCENE.format(end=9).replace(GRID, '<mesh file="m.obj"/>'))
        for name, (text, line, words) in BAD_MESHES.items():
            with self.subTest(name):
                self.write("m.obj", text)
                lines = self.refused(scene)
                self.assertEqual(len(lines), 1, lines)
                place = f":{line}" if line else ""
                self.assertRegex(lines[0], rf"^\S*m\.obj{place}: error: ")
                self.assertIn(words, lines[0])
        # no (u,v): no grid
        self.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\n")
        scene = self.write("s.xml", SCENE.format(end=9).replace(GRID, '<mesh file="m.obj" uv="grid"/>'))
        self.assertRegex(self.refused(scene)[0],
                         r"s\.xml:3: error: surface \"sheet\", mesh .*: the mesh is no even grid: it has no \(u,v\)")

    def test_files_that_are_no_scene(self):
        for name, text in (("empty", ""), ("blank", "\n\n"), ("text", "hello"), ("root", "<a/>")):
            with self.subTest(name):
                lines = self.refused(self.write("s.xml", text))
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], r"^\S*s\.xml:\d+: error: ")
        self.assertIn("it is a folder", self.refused(self.folder)[0])

    def test_every_prefix_of_a_scene(self):
        text = SCENE.format(end=2).replace("magnitude=", 'falloff="smooth" magnitude=')
        text = text.replace(POINT.replace("magnitude=", 'falloff="smooth" magnitude='), "")
        whole = text.rstrip()
        # With a sanitizer, tests/scene has every prefix, without a process for each.
        for length in range(0, len(whole), 17 if SANITIZED else 1):
            lines = self.refused(self.write("s.xml", whole[:length]))
            self.assertEqual(len(lines), 1, (length, lines))
            self.assertRegex(lines[0], r"^\S*s\.xml:\d+: error: ")


if __name__ == "__main__":
    main()
