#!/usr/bin/env python3
"""Writes bust.obj: a head with a neck, open below, such as a modelling program exports one: irregular
triangles and quads, finer in the face, and four charts of UVs with seams between them.

    python3 make_bust.py [-o bust.obj]
"""

import argparse
import math
import pathlib
import random

from make_head import relief

LEVELS = 4
EARS = [(-0.10, 0.47, 0.045, 0.075, 0.75), (1.10, 0.47, 0.045, 0.075, 0.75)]  # as in make_head.py


def unit(p):
    length = math.sqrt(sum(x * x for x in p))
    return tuple(x / length for x in p)


def icosphere(levels):
    """Directions, and triangles that turn outwards."""
    golden = (1 + math.sqrt(5)) / 2
    points = [unit(p) for a in (-1, 1) for b in (-golden, golden)
              for p in ((a, b, 0), (0, a, b), (b, 0, a))]
    near = lambda i, j: math.dist(points[i], points[j]) < 1.06  # an edge is 1.0515
    triangles = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if near(i, j) and near(j, k) and near(i, k):
                    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[i], points[j], points[k]
                    turn = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx))
                    triangles.append((i, j, k) if turn > 0 else (i, k, j))
    for _ in range(levels):
        middles = {}

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                middles[key] = len(points)
                points.append(unit(tuple(x + y for x, y in zip(points[i], points[j]))))
            return middles[key]

        triangles = [part for a, b, c in triangles for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
                     for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return points, triangles


def towards_front(p, chance):
    """Jittered, and denser around +z: a conformal map of the sphere."""
    x, y, z = unit(tuple(c + chance.uniform(-0.014, 0.014) for c in p))
    if z < -0.999999:
        return x, y, z
    x, y = 0.6 * x / (1 + z), 0.6 * y / (1 + z)
    square = x * x + y * y
    return 2 * x / (1 + square), 2 * y / (1 + square), (1 - square) / (1 + square)


def position(direction):
    """A point of the bust; it looks along +z, +y up. Where there is a face, it is that of head.obj."""
    x, y, z = direction
    u = (math.degrees(math.atan2(x, z)) + 80) / 160
    v = (math.degrees(math.asin(max(-1.0, min(1.0, y)))) + 62) / 124
    height = relief(u, v) + sum(h * math.exp(-((u - a) / s) ** 2 - ((v - b) / t) ** 2) for a, b, s, t, h in EARS)
    radii = (3.7 * (1 - 0.16 * (1 - min(1.0, max(0.0, v))) ** 2), 5.0, 4.3)
    head = [(radius + height) * n for radius, n in zip(radii, direction)]
    # Below the jaw the ellipsoid becomes a neck.
    share = min(1.0, max(0.0, (-0.72 - y) / 0.2))
    share = share * share * (3 - 2 * share)
    around = math.hypot(x, z) or 1.0
    neck = (2.1 * x / around, -4.2 - 12 * max(0.0, -0.8 - y), 2.1 * z / around - 0.7)
    return tuple(a + share * (b - a) for a, b in zip(head, neck))


def chart_of(direction):
    x, _, z = direction
    around = math.degrees(math.atan2(x, z))
    return "front" if abs(around) < 32 else "back" if abs(around) > 125 else "right" if around > 0 else "left"


def uv_of(chart, p):
    x, y, z = p
    across = {"front": x, "back": -x, "right": -z, "left": z}[chart]
    corner = {"front": (0, 0), "back": (0.5, 0), "right": (0, 0.5), "left": (0.5, 0.5)}[chart]
    return corner[0] + 0.25 + across / 30, corner[1] + 0.25 + y / 36


def joined(triangles, charts, chance):
    """Some pairs of triangles of one chart become quads."""
    sides = {}
    for k, (a, b, c) in enumerate(triangles):
        for i, j in ((a, b), (b, c), (c, a)):
            sides[i, j] = k
    faces, is_done = [], set()
    for k, (a, b, c) in enumerate(triangles):
        if k in is_done:
            continue
        face = (a, b, c)
        if chance.random() < 0.5:
            for i, j, other in ((a, b, c), (b, c, a), (c, a, b)):
                there = sides.get((j, i))
                if there is None or there in is_done or there <= k or charts[there] != charts[k]:
                    continue
                fourth = next(v for v in triangles[there] if v not in (i, j))
                face = (other, i, fourth, j)
                is_done.add(there)
                break
        faces.append((charts[k], face))
    return faces


def write_bust(path):
    chance = random.Random(2005)
    directions, triangles = icosphere(LEVELS)
    directions = [towards_front(p, chance) for p in directions]
    # The neck ends where the ellipsoid would close.
    triangles = [t for t in triangles if all(directions[v][1] > -0.965 for v in t)]
    used = sorted({v for t in triangles for v in t})
    number = {v: k + 1 for k, v in enumerate(used)}
    points = {v: position(directions[v]) for v in used}
    charts = [chart_of(unit(tuple(map(sum, zip(*(directions[v] for v in t)))))) for t in triangles]
    lines = ["# Made by make_bust.py."]
    lines += ["v {:.5f} {:.5f} {:.5f}".format(*points[v]) for v in used]
    uvs, corners = {}, []
    for chart, face in joined(triangles, charts, chance):
        for v in face:
            if (chart, v) not in uvs:
                uvs[chart, v] = len(uvs) + 1
                lines.append("vt {:.6f} {:.6f}".format(*uv_of(chart, points[v])))
        corners.append("f " + " ".join(f"{number[v]}/{uvs[chart, v]}" for v in face))
    path.write_text("\n".join(lines + corners) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="out", type=pathlib.Path,
                        default=pathlib.Path(__file__).with_name("bust.obj"))
    write_bust(parser.parse_args().out)
