"""Random meshes of every kind that SPEC 8 names, as the text of an OBJ file."""

import collections
import math

import numpy as np
from scipy.spatial import ConvexHull, Delaunay

from random_mesh import text_of

KINDS = ("delaunay", "quads", "sphere", "polygons", "fins", "box", "two", "tube", "stars")
UVS = ("none", "plane", "charts", "some")


def jittered(rng, columns, rows, amount):
    """Places of a lattice over the unit square, moved by a part of its spacing."""
    places = [((i + amount * rng.uniform(-1, 1)) / (columns - 1),
               (j + amount * rng.uniform(-1, 1)) / (rows - 1))
              for j in range(rows) for i in range(columns)]
    return np.array(places)


def lattice_quads(columns, rows, first=0):
    return [[first + k for k in (j * columns + i, (j + 1) * columns + i,
                                 (j + 1) * columns + i + 1, j * columns + i + 1)]
            for j in range(rows - 1) for i in range(columns - 1)]


def relief(rng, places):
    """Points over places of the unit square, y up."""
    a, b, c, d = rng.uniform(1, 4, 4)
    height = rng.choice([0.0, 0.05, 0.15])
    y = height * np.sin(a + b * places[:, 0]) * np.cos(c + d * places[:, 1])
    return np.stack([places[:, 0], y, places[:, 1]], axis=1)


def delaunay(rng):
    count = int(rng.integers(70, 160))
    places = np.concatenate([rng.uniform(0, 1, (count, 2)), [(0, 0), (0, 1), (1, 0), (1, 1)]])
    faces = []
    for a, b, c in Delaunay(places).simplices.tolist():
        (p, q), (r, s) = places[b] - places[a], places[c] - places[a]
        faces.append([a, b, c] if p * s - q * r < 0 else [a, c, b])
    return relief(rng, places), faces


def quads(rng):
    columns, rows = (int(n) for n in rng.integers(7, 13, 2))
    return relief(rng, jittered(rng, columns, rows, 0.3)), lattice_quads(columns, rows)


def sphere(rng):
    points = rng.standard_normal((int(rng.integers(80, 150)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = []
    for a, b, c in ConvexHull(points).simplices.tolist():
        outward = np.cross(points[b] - points[a], points[c] - points[a]) @ points[a]
        faces.append([a, b, c] if outward > 0 else [a, c, b])
    return points * rng.uniform(0.9, 1.1, (len(points), 1)), faces


def polygons(rng):
    """The dual of a triangulation: faces of 4 to 8 corners, and some triangles."""
    columns, rows = (int(n) for n in rng.integers(7, 11, 2))
    points = relief(rng, jittered(rng, columns, rows, 0.25))
    triangles = Delaunay(points[:, [0, 2]]).simplices.tolist()
    middles = np.array([points[list(t)].mean(axis=0) for t in triangles])
    middles[:, 1] += 0.01 * rng.uniform(-1, 1, len(middles))
    around = collections.defaultdict(list)
    for k, triangle in enumerate(triangles):
        for vertex in triangle:
            around[vertex].append(k)
    faces = []
    for vertex, ring in around.items():
        i, j = vertex % columns, vertex // columns
        if 0 < i < columns - 1 and 0 < j < rows - 1:
            x, z = points[vertex, 0], points[vertex, 2]
            faces.append(sorted(ring, key=lambda k: math.atan2(middles[k, 0] - x,
                                                               middles[k, 2] - z)))
    return middles, faces


def stars(rng):
    """A sheet of squares and of faces with 8 corners, some of which turn inwards."""
    blocks = int(rng.integers(4, 7))
    columns = 2 * blocks + 1
    points, faces = relief(rng, jittered(rng, columns, columns, 0.3)), []

    def face(i, j, *steps):
        return [(j + dj) * columns + i + di for di, dj in steps]

    def square(i, j):
        return face(i, j, (0, 0), (0, 1), (1, 1), (1, 0))

    for i in range(0, columns - 1, 2):
        for j in range(0, columns - 1, 2):
            kind = rng.integers(3)
            if kind == 0:
                faces += [square(i + di, j + dj) for di in (0, 1) for dj in (0, 1)]
                continue
            corner = (1, 1) if kind == 1 else (2, 2)
            faces.append(face(i, j, (0, 0), (0, 1), (0, 2), (1, 2), corner, (2, 1), (2, 0),
                              (1, 0)))
            if kind == 1:
                faces.append(square(i + 1, j + 1))
    return points, faces


def fins(rng):
    """A sheet with fins on a line across it: edges of three or four faces."""
    columns, rows = 9, int(rng.integers(7, 10))
    points, faces = relief(rng, jittered(rng, columns, rows, 0.2)), lattice_quads(columns, rows)
    foot = list(range((rows // 2) * columns, (rows // 2 + 1) * columns))
    for side in (1, -1)[:int(rng.integers(1, 3))]:
        below = foot
        for level in (1, 2, 3):
            lift = [0.02, side * 0.1 * level, 0.05 * level]
            first = len(points)
            points = np.concatenate([points, points[foot] + lift +
                                     0.02 * rng.uniform(-1, 1, (columns, 3))])
            above = list(range(first, first + columns))
            faces += [[below[i], below[i + 1], above[i + 1], above[i]]
                      for i in range(columns - 1)]
            below = above
    return points, faces


def box(rng):
    """A cube of quads, its corners sharp."""
    count, number, points, faces = 5, {}, [], []
    for axis in range(3):
        for end in (0, 1):
            for i in range(count - 1):
                for j in range(count - 1):
                    face = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        place = [0, 0, 0]
                        place[axis] = end * (count - 1)
                        place[(axis + 1) % 3], place[(axis + 2) % 3] = i + di, j + dj
                        face.append(number.setdefault(tuple(place), len(number)))
                    faces.append(face if end else face[::-1])
    points = np.array(list(number), dtype=float) / (count - 1)
    return points + 0.04 * rng.uniform(-1, 1, points.shape), faces


def two(rng):
    """Two sheets, one above the other, not joined."""
    points, faces = quads(rng)
    others, more = delaunay(rng)
    return (np.concatenate([points, 0.8 * others + [0.1, 0.2, 0.15]]),
            faces + [[len(points) + k for k in face] for face in more])


def tube(rng):
    """Quads around, open at both ends, a triangle fan over some of them."""
    around, down = int(rng.integers(7, 12)), int(rng.integers(6, 10))
    angle = 2 * math.pi * np.arange(around) / around
    points = np.concatenate([
        np.stack([0.5 * np.cos(angle), np.full(around, level / (down - 1)), 0.5 * np.sin(angle)],
                 axis=1) for level in range(down)])
    points += 0.03 * rng.uniform(-1, 1, points.shape)
    faces = []
    for level in range(down - 1):
        for i in range(around):
            a, b = level * around + i, level * around + (i + 1) % around
            quad = [a, a + around, b + around, b]
            faces += [quad] if rng.random() < 0.7 else [quad[:3], [quad[0]] + quad[2:]]
    return points, faces


class RandomSurface:
    """Text of an OBJ file, and the length by which it may be welded (None: the default)."""

    def __init__(self, rng, kind, uvs, oddities, tags):
        self.rng = rng
        points, faces = {"delaunay": delaunay, "quads": quads, "sphere": sphere,
                         "polygons": polygons, "fins": fins, "box": box, "two": two,
                         "tube": tube, "stars": stars}[kind](rng)
        size = 10 ** rng.uniform(-0.5, 1)
        self.points, self.faces = list(points * size * rng.uniform(0.8, 1.2, 3)), faces
        self.size = size
        self.weld = None
        tags.update([f"mesh {kind}", f"uvs {uvs}"] + [f"odd: {word}" for word in oddities])
        if "flat" in oddities:
            self.add_flat_triangles()
        if "seams" in oddities:
            self.split(0.0)
        if "weld" in oddities:
            self.weld = 2e-3 * size
            self.split(1e-3 * size / math.sqrt(3))
        if "faces" in oddities:
            self.add_odd_faces()
        if "order" in oddities:
            self.shuffle()
        if "turns" in oddities:
            self.faces = [face[::-1] if rng.random() < 0.3 else face for face in self.faces]
        self.write(uvs)

    def add_flat_triangles(self):
        """Vertices on edges: the face on one side has them, a triangle without area the rest."""
        at = collections.defaultdict(list)
        for k, face in enumerate(self.faces):
            for a, b in zip(face, face[1:] + face[:1]):
                at[min(a, b), max(a, b)].append(k)
        inner = [key for key, faces in at.items() if len(faces) == 2]
        done = set()
        for pick in self.rng.permutation(len(inner)):
            a, b = inner[pick]
            first, second = at[a, b]
            if len(done) >= 12 or first in done or second in done:
                continue
            done.update((first, second))
            middle = len(self.points)
            share = self.rng.uniform(0.3, 0.7)
            self.points.append((1 - share) * self.points[a] + share * self.points[b])
            face = self.faces[first]
            place = next(k for k, (p, q) in enumerate(zip(face, face[1:] + face[:1]))
                         if {p, q} == {a, b})
            p, q = face[place], face[(place + 1) % len(face)]
            self.faces[first] = face[:place + 1] + [middle] + face[place + 1:]
            self.faces.append([q, middle, p])

    def split(self, shift):
        """Twins of some vertices, used by some of their faces."""
        twins = {}
        for k in range(len(self.points)):
            if self.rng.random() < 0.3:
                twins[k] = len(self.points)
                self.points.append(self.points[k] + shift * self.rng.uniform(-1, 1, 3))
        self.faces = [[twins[k] if k in twins and self.rng.random() < 0.5 else k for k in face]
                      for face in self.faces]

    def add_odd_faces(self):
        """Faces that take no part, corners that repeat, and vertices in no face."""
        rng, faces = self.rng, self.faces
        picked = rng.permutation(len(faces)).tolist()
        for k in picked[:6]:
            faces.append(faces[k][1:] + faces[k][:1])
            faces.append([faces[k][0], faces[k][0], faces[k][1]])
        for k in picked[6:18]:
            place = int(rng.integers(3))
            faces[k] = faces[k][:place] + [faces[k][place - 1]] + faces[k][place:]
        a, b, c = faces[0][:3]
        faces.append([a, b, a, c])
        self.points += list(rng.uniform(-3, 3, (3, 3)) * self.size)

    def shuffle(self):
        order = self.rng.permutation(len(self.points))
        place = np.argsort(order)
        self.points = [self.points[k] for k in order]
        faces = [[int(place[k]) for k in face] for face in self.faces]
        self.faces = [faces[k] for k in self.rng.permutation(len(faces))]

    def write(self, uvs):
        rng = self.rng
        lines = ["v " + text_of(point) for point in self.points]
        flat = rng.standard_normal((3, 2))
        if uvs == "plane":
            lines += ["vt " + text_of(point @ flat) for point in self.points]
        written = len(self.points) if uvs == "plane" else 0
        for face in self.faces:
            if uvs == "none" or (uvs == "some" and rng.random() < 0.3):
                lines.append("f " + " ".join(str(k + 1) for k in face))
                continue
            if uvs == "plane":
                lines.append("f " + " ".join(f"{k + 1}/{k + 1}" for k in face))
                continue
            own = rng.standard_normal((3, 2))
            if uvs == "some" and rng.random() < 0.2:
                own[:, 1] = own[:, 0]  # a chart without area
            for k in face:
                lines.append("vt " + text_of(self.points[k] @ own +
                                             0.05 * self.size * rng.uniform(-1, 1, 2)))
            lines.append("f " + " ".join(f"{k + 1}/{written + j + 1}" for j, k in enumerate(face)))
            written += len(face)
        self.text = "\n".join(lines) + "\n"
