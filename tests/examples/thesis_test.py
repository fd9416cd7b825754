"""Bakes the scenes of one figure of the thesis and checks the statements of their comments.

usage: thesis_test.py PLIANT EXAMPLES_FOLDER NUMBER_OF_THE_FIGURE

Nothing is compared with stored numbers: each check is a symmetry, a sum, or a comparison between a
scene and the same text with one change.
"""

import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy as np

PLIANT, EXAMPLES = (os.path.abspath(argument) for argument in sys.argv[1:3])

# Rounding of the direct solver: cond(L) ~ 2e5 for a 39 x 39 plate; 2e5 * 2e-16 * 200 steps.
ROUNDING = 1e-8


def text_of(name):
    with open(os.path.join(EXAMPLES, "thesis", name + ".xml"), encoding="utf-8") as file:
        return file.read()


def bake(name, *changes, warns=""):
    """Positions, frames x vertices x 3, of the scene with each change (old, new) made once. `warns`: words of its one
    warning; without, there is none."""
    text = re.sub(r"<!--.*?-->", "", text_of(name), flags=re.DOTALL)
    text = text.replace("../head.obj", os.path.join(EXAMPLES, "head.obj"))
    for old, new in changes:
        assert text.count(old) == 1, f"{name} has {text.count(old)} of {old}"
        text = text.replace(old, new)
    with tempfile.TemporaryDirectory() as folder:
        scene, out = os.path.join(folder, "a.xml"), os.path.join(folder, "a.npy")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(text)
        run = subprocess.run([PLIANT, "bake", scene, "-o", out], check=True, stderr=subprocess.PIPE,
                             text=True)
        assert run.stderr.count("warning: ") == bool(warns) and warns in run.stderr, run.stderr
        frames = np.load(out)
    assert np.isfinite(frames).all(), "a position is not finite"
    return frames


def sheet(name, *changes, **options):
    """Displacements of a scene on a square <grid>: frames x rows (v) x columns (u) x 3."""
    frames = bake(name, *changes, **options)
    side = round(frames.shape[1] ** 0.5)
    frames = frames.reshape(len(frames), side, side, 3)
    moved = frames - frames[0]
    peak = np.abs(moved).max()
    rim = np.concatenate([moved[:, 0], moved[:, -1], moved[:, :, 0], moved[:, :, -1]], axis=1)
    assert (rim == 0).all(), f"{name}: the rim of the sheet has moved"
    assert changes or 0.05 < peak / 20 < 0.5, f"{name}: a peak of {peak} is no picture"
    return moved


def differences(name, other):
    """Attributes, as element.attribute, in which two scenes differ."""
    def attributes(scene):
        root = ElementTree.fromstring(text_of(scene))
        return {(k, element.tag, key): value for k, element in enumerate(root.iter())
                for key, value in element.attrib.items()}
    a, b = attributes(name), attributes(other)
    assert a.keys() == b.keys(), f"{name} and {other} are built differently"
    return {f"{tag}.{key}" for k, tag, key in a if a[k, tag, key] != b[k, tag, key]}


def same(a, b, what):
    scale = max(np.abs(a).max(), np.abs(b).max())
    error = np.abs(a - b).max()
    assert error <= ROUNDING * scale, f"{what}: off by {error:.3g} at a size of {scale:.3g}"


def middle(moved):
    return moved[:, moved.shape[1] // 2, moved.shape[2] // 2]


def flip_u(field):
    return field[:, ::-1]


def flip_v(field):
    return field[::-1]


def edge_slopes(field):
    """The slope in uv half-way along each edge, from its three outermost nodes: second order."""
    side, half = len(field), len(field) // 2
    slope = lambda w: (-3 * w[0] + 4 * w[1] - w[2]) / 2 * (side - 1)
    return {"su0": slope(field[half, :3]), "su1": -slope(field[half, :-4:-1]),
            "sv0": slope(field[:3, half]), "sv1": -slope(field[:-4:-1, half])}


def check_slopes(field, prescribed, what):
    # hu^2/3 of the third derivative, which is some 20 times the slope: 0.4 % of it; 5 % is ample.
    for edge, found in edge_slopes(field).items():
        expected = prescribed.get(edge, 0)
        assert np.abs(found - expected).max() < 0.05 * 30, f"{what}: {edge} is {found}"


def figure8():
    assert differences("fig08-force", "fig08-density") == {"material.density"}
    assert differences("fig08-force", "fig08-tangent-u") == {"tangents.su0"}
    assert differences("fig08-force", "fig08-tangent-v") == {"tangents.sv0"}
    force, heavy = sheet("fig08-force"), sheet("fig08-density")
    along_u, along_v = sheet("fig08-tangent-u"), sheet("fig08-tangent-v")
    rest = middle(sheet("fig08-force", ('density="0.3"', 'density="0"'),
                        ('damping="4"', 'damping="0"')))[-1, 1]

    # One force along y moves only y; the dome is the same from four sides, highest in the middle,
    # level at the rim.
    assert (force[..., [0, 2]] == 0).all(), "a force along y has moved x or z"
    dome = force[10, :, :, 1]
    for turned, how in ((flip_u(dome), "u"), (flip_v(dome), "v"), (dome.T, "exchange")):
        same(dome, turned, f"the dome under {how}")
    assert dome.max() == dome[20, 20]
    check_slopes(force[10], {}, "the dome")
    light = middle(force)[:, 1]
    assert abs(light[10] - rest) < 0.1 * rest and abs(light[-1] - rest) < 1e-3 * rest

    # Higher density: slower, swings past the position of rest, and still moves long after the light
    # sheet has stopped.
    dense = middle(heavy)[:, 1]
    assert 0 < dense[10] < 0.5 * light[10], "more density is not slower"
    turn = dense.argmax()
    assert 20 < turn < 38 and dense[turn] > 1.2 * rest, "more density does not overshoot"
    assert dense[-1] < dense[turn]
    assert np.ptp(dense[30:]) > 10 * np.ptp(light[30:]), "more density does not ring on"

    # A tangent at u = 0 acts on x, y and z equally, is met at its edge, and adds to the load.
    check_slopes(along_u[10], {"su0": 30}, "tangent at u = 0")
    same(along_u[..., 0], along_u[..., 2], "x and z under one tangent")
    same(along_u[..., 1] - force[..., 1], along_u[..., 0], "force and tangent add up")
    ridge = along_u[10, :, :, 1]
    same(ridge, flip_v(ridge), "the mirror image along v")
    assert np.abs(ridge - flip_u(ridge)).max() > 0.1 * ridge.max(), "u is as symmetric as before"
    assert np.unravel_index(ridge.argmax(), ridge.shape)[1] < 20, "the ridge leans away from u = 0"
    # At v = 0 the same with u and v, x and z exchanged.
    same(along_v, along_u.transpose(0, 2, 1, 3)[..., [2, 1, 0]], "the two tangents")


def figure9():
    edges = ("su0", "su1", "sv0", "sv1")
    all_zero = " ".join(f'{edge}="0"' for edge in edges)
    of_su0 = 'su0="30" su1="0" sv0="0" sv1="0"'
    scenes = {"fig09-su0": edges[:1], "fig09-su0-su1": edges[:2],
              "fig09-su0-su1-sv0": edges[:3], "fig09-all": edges}
    shapes = {name: sheet(name)[1] for name in scenes}
    for name in scenes:
        assert differences("fig09-su0", name) <= {f"tangents.{edge}" for edge in edges}

    # Without tangents there is no height. In the plane the literal equation still crowds the nodes
    # at the rim, where r_u = 0; solved for the displacement, nothing moves.
    flat = sheet("fig09-su0", (of_su0, all_zero))[1]
    assert (flat[..., 1] == 0).all() and np.abs(flat).max() > 0.2
    assert (sheet("fig09-su0", (of_su0, all_zero), ('"none"', '"rest"'), warns="nothing moved") == 0).all()

    rest = bake("fig09-su0")[0].reshape(41, 41, 3)
    single = {edge: sheet("fig09-su0", (of_su0, all_zero.replace(f'{edge}="0"', f'{edge}="30"')))[1]
              - flat for edge in edges}
    for name, prescribed in scenes.items():
        added = shapes[name] - flat
        same(added, sum(single[edge] for edge in prescribed), f"{name}: the tangents add up")
        same(added[..., 0], added[..., 1], f"{name}: x and y")
        same(added[..., 2], added[..., 1], f"{name}: z and y")
        # The tangents are those of the position, although the slope of the sheet itself in x is 20.
        check_slopes(rest + shapes[name], dict.fromkeys(prescribed, 30), name)
        # On a sheet that is flat in y, the reference affects only x and z.
        relative = sheet(name, ('"none"', '"rest"'))[1]
        same(relative[..., 1], shapes[name][..., 1], f"{name}: the height under either reference")
        stiffer = sheet(name, ('b="0.1" c="0.2" d="0.1"', 'b="1" c="2" d="1"'))[1]
        same(stiffer, shapes[name], f"{name}: ten times as stiff")

    one, two, four = (shapes[name][..., 1] for name in ("fig09-su0", "fig09-su0-su1", "fig09-all"))
    same(one, flip_v(one), "su0: mirror image along v")
    assert one.max() > 2 and one[20].argmax() < 20 and one.min() > -0.1 * one.max()
    same(two, flip_v(two), "su0, su1: mirror image along v")
    same(two, -flip_u(two), "su0, su1: the valley is as deep as the hill is high")
    assert two[20].argmax() < 20 < two[20].argmin()
    same(four, four.T, "all: u and v exchanged")
    same(four, -flip_u(flip_v(four)), "all: half a turn")
    assert np.abs(np.diagonal(flip_u(four))).max() <= ROUNDING * four.max(), "all: the diagonal"
    assert four[10, 10] > 1


def figure10():
    assert differences("fig10-fine", "fig10-coarse") == {"solver.dt"}
    fine, coarse = sheet("fig10-fine"), sheet("fig10-coarse")
    off = '<key frame="26" value="0"/>'
    for name, moved in (("fig10-fine", fine), ("fig10-coarse", coarse)):
        held = sheet(name, (off, ""))
        assert np.array_equal(held[:27], moved[:27]), f"{name}: the key acts before its frame"
        assert not np.array_equal(held[27], moved[27]), f"{name}: the key does not act"
        # Without a region there is no solve: the sheet neither rings nor returns.
        switched = ('</animate><animate attribute="enabled"><key frame="0" value="true"/>'
                    '<key frame="26" value="false"/></animate>')
        disabled = sheet(name, ("</animate>", switched), warns="frozen while it moves" if name == "fig10-fine" else "")
        assert (disabled[27:] == disabled[26]).all(), f"{name}: a disabled force is solved"
        outside = np.abs(bake(name)[0].reshape(41, 41, 3)).max(axis=2) > 8.1
        assert (moved[:, outside] == 0).all(), f"{name}: nodes outside the region move"

    a, b = middle(fine)[:, 1], middle(coarse)[:, 1]
    at_rest = middle(sheet("fig10-fine", ('density="0.4" damping="0.1"',
                                          'density="0" damping="0"')))[25, 1]
    # Under the load the fine one swings about the position of rest, the coarse one is at it.
    signs = np.sign(a[1:27] - at_rest)
    assert (np.diff(signs) != 0).sum() >= 4, "dt = 0.01 does not swing"
    assert a[25] > 1.2 * at_rest and np.abs(b[2:27] - at_rest).max() < 0.01 * at_rest
    # Released, the fine one swings through the plane with decreasing height; the coarse one is
    # flat.
    assert a[30] < -0.5 * at_rest and abs(b[30]) < 1e-3 * at_rest
    low, high = a[27:].min(), a[32:].max()
    assert 0 < high < -low < a[26], "dt = 0.01 does not ring down"
    assert np.abs(b[28:]).max() < 0.02 * at_rest, "dt = 1 rings"

    # Which one is right? For frames of equal length, the smaller step is nearer, at first order:
    # each halving of dt halves the change, up to second-order terms (omega dt = 0.05).
    exact = ('stepping="overshoot"', 'stepping="exact"')
    runs = [middle(sheet("fig10-fine", exact, ('dt="0.01"', f'dt="{1 / 24 / steps!r}"')))[:, 1]
            for steps in (1, 5, 10, 20, 40)]
    changes = [np.abs(a - b).max() for a, b in zip(runs, runs[1:])]
    assert changes[0] > changes[1] > changes[2] > changes[3], changes
    assert 1.6 < changes[2] / changes[3] < 2.4, changes
    best = 2 * runs[4] - runs[3]
    assert np.abs(runs[1] - best).max() < 0.7 * np.abs(runs[0] - best).max()
    print("halving dt from a tenth of a frame:", changes[2] / changes[3])


def figure11():
    assert differences("fig11-narrow", "fig11-wide") == {
        "point.deformationRadius", "point.forceRadius", "key.value"}
    uv = np.array([[float(word) for word in line.split()[1:3]]
                   for line in open(os.path.join(EXAMPLES, "head.obj"), encoding="utf-8")
                   if line.startswith("vt ")])
    force = ElementTree.fromstring(text_of("fig11-narrow")).find("point")
    direction = np.array([float(word) for word in force.get("direction").split()])
    direction /= np.linalg.norm(direction)
    centers = [np.array([float(word) for word in key.get("value").split()])
               for key in force.findall("animate[@attribute='center']/key")]

    def box(positions, center, radius):
        """Whether each vertex lies strictly inside the (u,v) box of those nearer than radius."""
        near = uv[np.linalg.norm(positions - center, axis=1) < radius]
        low, high = near.min(axis=0) + 1e-6, near.max(axis=0) - 1e-6
        return ((uv > low) & (uv < high)).all(axis=1)

    reached, remains = {}, {}
    for name, deformation, pushed in (("fig11-narrow", 5, 10), ("fig11-wide", 10, 5)):
        warns = "exceeds deformationRadius" if pushed > deformation else ""
        frames = bake(name, warns=warns)
        moved = frames - frames[0]
        length = np.linalg.norm(moved, axis=2)
        peak = length.max()
        assert 0.04 < peak / 35 < 0.25, f"{name}: a peak of {peak} is no picture"
        assert np.linalg.norm(np.diff(frames, axis=0), axis=2).max() < 0.3 * peak, f"{name}: jumps"
        # Only the region moves, although the force of the narrow one reaches further; all of it
        # moves.
        inside = box(frames[0], centers[0], deformation)
        assert (length[:10, ~inside] == 0).all(), f"{name}: vertices outside the region move"
        assert (length[9, inside] > 0).all(), f"{name}: vertices of the region stand still"
        reached[name] = inside.sum()
        # All loads are along one line, so all displacements are too.
        same(np.abs(moved @ direction), length, f"{name}: along the force")
        # The force has moved, and the region with it. Nodes that it has left do not move.
        last = box(frames[40], centers[-1], deformation)
        assert length[40].argmax() in np.flatnonzero(last), f"{name}: the peak stays behind"
        trail = ~last & (length[40] > 0)
        remains[name] = length[40, trail].max() / peak
        assert (inside & trail).sum() > 0.3 * inside.sum(), f"{name}: no trail"
        assert (frames[39, trail] == frames[40, trail]).all(), f"{name}: the trail moves"
        # Beyond the region, a larger force radius changes nothing; within it, it does.
        radius = f'forceRadius="{pushed}"'
        larger = bake(name, (radius, f'forceRadius="{pushed + 3}"'), warns=warns)
        assert np.array_equal(larger, frames) == (pushed > deformation), f"{name}: the force radius"
    assert remains["fig11-narrow"] > 2 * remains["fig11-wide"], "the wide region trails as much"
    assert reached["fig11-wide"] > 3 * reached["fig11-narrow"]


def figure12():
    turning = sheet("fig12-turning")
    point = ElementTree.fromstring(text_of("fig12-turning")).find("point")
    keys = [(int(key.get("frame")), np.array([float(word) for word in key.get("value").split()]))
            for key in point.iter("key")]
    peak = np.abs(turning).max()
    assert (turning[..., 2] == 0).all(), "x and y pushed, z moves"
    # The sheet moves where the force points: exactly while the direction is constant from the
    # start, slightly late afterwards.
    same(np.linalg.norm(turning[:9], axis=3), np.abs(turning[:9, :, :, 1]), "up")
    for frame, direction in {16: (1, 1), 24: (1, 0), 40: (0, -1)}.items():
        found = middle(turning)[frame, :2]
        cosine = found @ direction / np.linalg.norm(found) / np.linalg.norm(direction)
        assert cosine > 0.97, f"frame {frame}: {found} is not along {direction}"
    last = middle(turning)[-1]
    assert last[1] < 0 and abs(last[0]) < 1e-2 * peak, "it does not settle along the last direction"
    same_height = abs(turning[8, 20, 20, 1] + turning[-1, 20, 20, 1])
    assert same_height < 0.02 * peak, "down is not as far as up"

    # The region is a square: its corners, outside the sphere, move; nodes around it do not.
    rest = bake("fig12-turning")[0].reshape(41, 41, 3)
    reach = np.abs(rest).max(axis=2)
    assert (turning[:, reach > 6.9] == 0).all() and (turning[8, reach < 6.9] != 0).any(axis=1).all()
    assert (np.linalg.norm(rest[reach < 6.9], axis=1) > 7.1).any()

    # The length of the direction does not matter.
    longer = [(f'frame="{frame}" value="{" ".join(f"{c:g}" for c in value)}"',
               f'frame="{frame}" value="{" ".join(f"{7 * c:g}" for c in value)}"')
              for frame, value in keys]
    same(sheet("fig12-turning", *longer), turning, "a direction seven times as long")


if __name__ == "__main__":
    {"8": figure8, "9": figure9, "10": figure10, "11": figure11, "12": figure12}[sys.argv[3]]()
    print(f"ok figure {sys.argv[3]}")
