"""Inputs of any size whose reading once cost far more than their bytes, by kind: each function writes its files into a
folder and gives the arguments of the command that reads them."""

import base64
import ctypes
import json
import math
import os
import struct
import subprocess

from command import PLIANT

# By name: the function, and the size from which the command takes more instructions than its start.
KINDS = {}

GRID = '<grid columns="4" rows="4"/>'
POINT = '<point name="f{}" {}/>\n'


def kind(size):
    def register(make):
        KINDS[make.__name__] = (make, size)
        return make
    return register


def write(folder, name, content):
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(content)
    return path


def run(*arguments):
    subprocess.run([PLIANT, *arguments], check=True, capture_output=True, timeout=600, stdin=subprocess.DEVNULL)


def scene(folder, content, surface=GRID):
    """One surface, unless `surface` is empty."""
    if surface:
        surface = f'<surface name="s">{surface}</surface>\n'
    return write(folder, "scene.xml", f'<scene version="1" start="1" end="2">\n{surface}{content}\n</scene>\n')


def defines(count, name, value="1"):
    return "".join(f'<define name="{name}{k}" value="{value}"/>\n' for k in range(count))


def surfaces(count, name="t", more=""):
    return "".join(f'<surface name="{name}{k}"{more.format(k)}>{GRID}</surface>\n' for k in range(count))


# The text of scenes

@kind(100_000)
def sums_of_many_terms(folder, n):
    total = "+".join(["$a"] * 20_000)
    return ["validate", scene(folder, f'<define name="a" value="{"1 " * 16}"/>\n' + "".join(
        POINT.format(k, f'magnitude="{total}"') for k in range(n // 20_000)))]


@kind(3000)
def chain_of_definitions(folder, n):
    return ["validate", scene(folder, '<define name="a0" value="1"/>\n' + "".join(
        f'<define name="a{k + 1}" value="$a{k} + 1"/>\n' for k in range(n)))]


@kind(2000)
def chain_of_long_vectors(folder, n):
    return ["validate", scene(folder, f'<define name="a0" value="{"1 " * 15_000}"/>\n' + "".join(
        f'<define name="a{k + 1}" value="$a{k}"/>\n' for k in range(n // 20)))]


@kind(1000)
def values_of_an_include(folder, n):
    uses = "".join(POINT.format(k, f'magnitude="$a{k}"') for k in range(n))
    write(folder, "part.xml", f'<fragment>{defines(n, "a")}{uses}</fragment>')
    return ["validate", scene(folder, f'<include file="part.xml">{defines(n, "a")}</include>')]


@kind(1000)
def undefined_names(folder, n):
    long = "abcdefghij"
    return ["validate", scene(folder, defines(n, long) + "".join(
        POINT.format(k, f'magnitude="${long[:9]}x{long[10:]}{k}"') for k in range(n)))]


@kind(200)
def targets_of_forces(folder, n):
    names = " ".join(f"t{k}" for k in range(n))
    forces = "".join(POINT.format(k, f'targets="{names}"') for k in range(10))
    return ["validate", scene(folder, f'{surfaces(n)}<group name="g" targets="{names}">{forces}</group>', surface="")]


@kind(200)
def driven_surfaces(folder, n):
    return ["validate", scene(folder, surfaces(n) + surfaces(n, "d", ' drivenBy="t{}"'), surface="")]


@kind(400)
def forces_in_info(folder, n):
    return ["info", "--quiet", scene(folder, "".join(POINT.format(k, f'center="{1000 + k} 0 0"') for k in range(n)))]


NEAR = 'center="0 0 0" forceRadius="2" magnitude="1"'
SELECTING = NEAR + ' deformationRadius="2"'
# Few nodes, so that what grows with the forces is seen beside what is solved for each.
SMALL = '<grid columns="7" rows="7" width="6" depth="6"/><material density="1" damping="1"/>'


@kind(80)
def acting_forces_in_info(folder, n):
    return ["info", "--quiet", scene(folder, "".join(POINT.format(k, SELECTING) for k in range(n)), SMALL)]


@kind(80)
def acting_forces_of_a_group_in_info(folder, n):
    forces = "".join(POINT.format(k, NEAR) for k in range(n))
    return ["info", "--quiet", scene(folder, f'<group name="g" center="0 0 0" deformationRadius="2">{forces}</group>',
                                     SMALL)]


@kind(80)
def groups_of_an_acting_force_in_info(folder, n):
    return ["info", "--quiet", scene(folder, "".join(
        f'<group name="g{k}" center="0 0 0" deformationRadius="2">{POINT.format(k, NEAR)}</group>\n'
        for k in range(n)), SMALL)]


@kind(120)
def groups_in_info(folder, n):
    return ["info", "--quiet", scene(folder, "".join(
        f'<group name="g{k}" center="{1000 + k} 0 0">{POINT.format(k, "")}</group>\n' for k in range(n)))]


@kind(1000)
def problems_on_one_line(folder, n):
    points = "".join(f'<point name="f{k}" magnitude="x"/>' for k in range(n))
    return ["validate", "--json", scene(folder, points)]


def keyed(count, keys):
    return "".join(f'<point name="f{k}"><animate attribute="magnitude">' + "".join(
        f'<key frame="{key + 1}" value="{key % 3}"/>\n' for key in range(keys)) + "</animate></point>\n"
                   for k in range(count))


@kind(200)
def format_of_many_curves(folder, n):
    return ["format", scene(folder, keyed(n, 2))]


def keys_of(folder, n, tangent, more=""):
    keys = "".join(f'<key frame="{0.01 * k}" value="{k % 7}"{more}/>' for k in range(n))
    return ["validate", scene(folder, f'<point name="f"><animate attribute="magnitude" tangent="{tangent}">{keys}'
                                      "</animate></point>")]


@kind(2000)
def automatic_keys(folder, n):
    return keys_of(folder, n, "auto")


@kind(2000)
def keys_of_a_spline(folder, n):
    return keys_of(folder, n, "spline")


@kind(2000)
def keys_with_tangents(folder, n):
    return keys_of(folder, n, "auto", ' in="flat" out="1.5" inLength="0.002" outLength="0.002"')


# Mesh files

def mesh(folder, name, content, *, info=False, out=None, more=""):
    file = write(folder, name, content)
    if info:
        return ["info", "--quiet", file]
    made = scene(folder, POINT.format("", 'center="0.3 0 -0.2" magnitude="0.001" deformationRadius="0.01"'),
                 f'<mesh file="{name}" uv="surface"{more}/>')
    return ["bake", made, "-o", os.path.join(folder, out), "--quiet"] if out else ["validate", made]


def obj(points, faces):
    return "".join("v %r %r %r\n" % point for point in points) + "".join(
        "f " + " ".join(map(str, face)) + "\n" for face in faces)


@kind(2000)
def polygon_like_a_comb(folder, n):
    teeth = n // 3
    points = [(2 * k, 0) for k in range(teeth)]
    for k in reversed(range(teeth)):
        points += [(2 * k + 0.5, 10), (2 * k - 0.5, 1)]
    return mesh(folder, "a.obj", obj([(x / teeth, 0, -y / teeth) for x, y in points], [range(1, len(points) + 1)]),
                out="a.gltf")


def fan(n):
    return "v 0 0 0\n" + "".join(f"v 1 0 {k}\nv 1 0 {k + 0.5}\n" for k in range(n))


@kind(1500)
def normals_and_uvs_of_one_vertex(folder, n):
    values = "".join(f"vn 0 1 {k}\nvt 0 {k / n}\n" for k in range(n))
    faces = "".join(f"f 1/{k}/{k} {2 * k}/{k}/{k} {2 * k + 1}/{k}/{k}\n" for k in range(1, n + 1))
    return mesh(folder, "a.obj", fan(n) + values + faces, out="a.gltf")


@kind(1500)
def smoothing_groups(folder, n):
    return mesh(folder, "a.obj", fan(n) + "".join(f"s {k}\nf 1 {2 * k} {2 * k + 1}\n" for k in range(1, n + 1)),
                out="a.gltf")


@kind(600)
def materials_of_an_obj(folder, n):
    return mesh(folder, "a.obj", "".join(f"v {k} 0 0\nv {k} 0 1\nv {k} 1 0\nusemtl m{k}\nf -3 -2 -1\n" for k in range(n)),
                out="a.usda")


@kind(2000)
def points_nearly_in_one_place(folder, n):
    half = n // 2
    u, v = (2 ** -0.5, -2 ** -0.5, 0), (6 ** -0.5, 6 ** -0.5, -2 * 6 ** -0.5)
    circle = [tuple(1.000000000001 * (u[i] * math.cos(2 * math.pi * k / half) + v[i] * math.sin(2 * math.pi * k / half))
                    for i in range(3)) for k in range(half)]
    axis = [(1e-6 * (k / half - 0.5) * 3 ** -0.5,) * 3 for k in range(half)]
    return mesh(folder, "a.obj", obj(circle + axis, [(k + 1, k + 2, k + 3) for k in range(2 * half - 2)]),
                more=' weld="1"')


def ply(properties, elements, rest):
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    lines = "".join(f"{corner}{rest}\n" for corner in ("0 0 0", "1 0 0", "0 0 -1"))
    return (f"ply\nformat ascii 1.0\nelement vertex 3\n{axes}{properties}element face 1\n"
            f"property list uchar int vertex_indices\n{elements}end_header\n{lines}3 0 1 2\n")


@kind(4000)
def ply_properties(folder, n):
    return mesh(folder, "a.ply", ply("".join(f"property char p{k}\n" for k in range(n)), "", " 1" * n), info=True)


@kind(4000)
def ply_elements(folder, n):
    return mesh(folder, "a.ply", ply("", "".join(f"element e{k} 0\nproperty int a\n" for k in range(n)), ""), info=True)


TRIANGLE = {"attributes": {"POSITION": 0}}


def gltf(**more):
    numbers = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 0, -1)
    uri = "data:;base64," + base64.b64encode(numbers).decode()
    return json.dumps({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": uri}],
                       "bufferViews": [{"buffer": 0, "byteLength": 36}],
                       "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                       "meshes": [{"primitives": [TRIANGLE]}], "nodes": [{"mesh": 0}], **more})


@kind(1000)
def gltf_nodes_by_primitives(folder, n):
    return mesh(folder, "a.gltf", gltf(meshes=[{"primitives": [TRIANGLE] * n}], nodes=[{"mesh": 0}] * n), info=True)


@kind(1000)
def gltf_materials(folder, n):
    return mesh(folder, "a.gltf", gltf(
        materials=[{"name": f"m{k}"} for k in range(n)],
        meshes=[{"primitives": [{**TRIANGLE, "material": k} for k in range(n)]}]))


# Output, sweeps, logs and curves

@kind(30)
def surfaces_in_one_usda(folder, n):
    return ["bake", scene(folder, surfaces(n), surface=""), "-o", os.path.join(folder, "a.usda"), "--quiet"]


@kind(200)
def forces_apart(folder, n):
    half, row = n // 2, int((n / 2) ** 0.5) + 1
    side = 8 * row
    forces = "".join(POINT.format(k, f'center="{8 * (k % half % row) + 4 + k // half} 0 {8 * (k % half // row) + 4}" '
                                  'deformationRadius="2" forceRadius="1" magnitude="5"') for k in range(n))
    return ["bake", scene(folder, forces, f'<grid columns="{side + 1}" rows="{side + 1}" width="{side}" depth="{side}"/>'
                          f'<transform translate="{side / 2} 0 {side / 2}"/>'),
            "-o", os.path.join(folder, "a.npy"), "--quiet", "--threads", "1"]


@kind(500)
def samples_in_32_dimensions(folder, n):
    made = scene(folder, "".join(POINT.format(k, "") for k in range(32)))
    vary = [word for k in range(32) for word in ("--vary", f"f{k}.magnitude=1:2")]
    return ["sweep", "run", made, "-o", os.path.join(folder, "out"), *vary, "--sample", str(n), "--make-only"]


def sweep_of(folder):
    """A sweep that is made, as JSON: its parts are edited, and written to another."""
    made = scene(folder, POINT.format("", ""))
    run("sweep", "run", made, "-o", os.path.join(folder, "made"), "--vary", "f.magnitude=1,2", "--make-only")
    with open(os.path.join(folder, "made", "sweep.json"), encoding="utf-8") as file:
        return json.load(file)


def sweep(folder, edited):
    os.mkdir(os.path.join(folder, "out"))
    write(folder, "out/sweep.json", json.dumps(edited))
    return ["sweep", "status", os.path.join(folder, "out")]


@kind(10_000)
def members_of_a_sweep(folder, n):
    return sweep(folder, {**sweep_of(folder), **{f"member{k}": k for k in range(n)}})


@kind(4000)
def axes_of_a_sweep(folder, n):
    return sweep(folder, {**sweep_of(folder), "axes": [{"paths": [k], "count": 1, "texts": ["1"]} for k in range(n)],
                          "paths": [{"path": f"f.v{k}", "kind": "="} for k in range(n)]})


@kind(1000)
def columns_of_a_table(folder, n):
    table = ",".join(f"f.v{k}" for k in range(n)) + "\n" + ",".join(["1"] * n) + "\n"
    return ["sweep", "run", scene(folder, POINT.format("", "")), "-o", os.path.join(folder, "out"), "--dry-run", "--takes",
            write(folder, "takes.csv", table)]


def sweep_of_forces(folder, n, *options):
    made = scene(folder, "".join(POINT.format(k, 'magnitude="1"') for k in range(n)))
    return ["sweep", "run", made, "-o", os.path.join(folder, "out"), "--make-only", *options]


@kind(500)
def columns_for_as_many_forces(folder, n):
    table = ",".join(f"f{k}.magnitude" for k in range(n)) + "\n" + ",".join(["1"] * n) + "\n"
    return sweep_of_forces(folder, n, "--takes", write(folder, "takes.csv", table))


@kind(500)
def axes_for_as_many_forces(folder, n):
    return sweep_of_forces(folder, n, *(word for k in range(n) for word in ("--vary", f"f{k}.magnitude=1")))


class Hash(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


def hash_of(text):
    library = ctypes.CDLL("libxxhash.so.0")
    library.XXH3_128bits.restype = Hash
    library.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
    made = library.XXH3_128bits(text.encode(), len(text.encode()))
    return f"{made.high:016x}{made.low:016x}"


def log_of(folder):
    """The lines of a recorded log, without their seals."""
    file = os.path.join(folder, "made.replay")
    run("replay", "record", scene(folder, POINT.format("", "")), "-o", file)
    with open(file, encoding="utf-8") as lines:
        return [line[:line.rindex(',"seal":"')] for line in lines]


def log(folder, lines):
    """Compares a log of these lines, sealed, with itself."""
    text, seal = "", ""
    for line in lines:
        seal = hash_of(seal + line)
        text += f'{line},"seal":"{seal}"}}\n'
    file = write(folder, "a.replay", text)
    return ["replay", "diff", file, file]


@kind(5000)
def members_of_a_log(folder, n):
    first, *others = log_of(folder)
    return log(folder, [first + "".join(f',"k{k}":1' for k in range(n)), *others])


@kind(2000)
def files_of_a_log(folder, n):
    first, *others = log_of(folder)
    header = {**json.loads(first + "}"), "files": [{"name": f"f{k}", "hash": "0" * 32} for k in range(n)]}
    return log(folder, [json.dumps(header, separators=(",", ":"))[:-1], *others])


@kind(1500)
def curves_of_maya(folder, n):
    curves = "".join(f"anim a a n{k} 0 0 0;\nanimData {{\n input time; output linear; weighted 0; "
                     f"keys {{ {k} 1 flat flat 0 0 0; }} }}\n" for k in range(n))
    return ["import", "curves", write(folder, "a.anim", "animVersion 1.1;\ntimeUnit film;\n" + curves)]


@kind(150)
def import_of_many_curves(folder, n):
    made = scene(folder, "".join(POINT.format(k, "") for k in range(n)))
    curves = {"format": "blender-curves", "version": 1, "fps": 24, "curves": [
        {"owner": f"f{k}", "data_path": "magnitude", "keys": [{"co": [1, 1]}, {"co": [2, 3]}]} for k in range(n)]}
    return ["import", "curves", write(folder, "a.json", json.dumps(curves)), "-o", made]
