"""Maps of the material: factors of its channels at nodes (SPEC 9). Reads PNG and .npy by itself."""

import struct
import zlib

import numpy as np

CHANNELS = ("density", "damping", "b", "c", "d", "yield", "hardening", "goal")


def read_png(path):
    """The first channel of a PNG over its white, rows from the top."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, head, packed = 8, None, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            packed += chunk
        at += 12 + length
    width, height, bits, colours, _, _, interlace = head
    assert bits in (8, 16) and colours in (0, 2, 4, 6) and interlace == 0
    pixel = {0: 1, 2: 3, 4: 2, 6: 4}[colours] * bits // 8
    raw, size = zlib.decompress(packed), pixel * width
    before, rows = [0] * size, []
    for y in range(height):
        kind, line = raw[y * (size + 1)], list(raw[y * (size + 1) + 1:(y + 1) * (size + 1)])
        for k in range(size):
            left = line[k - pixel] if k >= pixel else 0
            up, corner = before[k], before[k - pixel] if k >= pixel else 0
            estimate = left + up - corner
            nearest = min((left, up, corner), key=lambda value: abs(estimate - value))
            line[k] = (line[k] + (0, left, up, (left + up) // 2, nearest)[kind]) % 256
        before = line
        bytes_ = np.array(line).reshape(width, pixel)
        rows.append(bytes_[:, 0] if bits == 8 else 256 * bytes_[:, 0] + bytes_[:, 1])
    return np.array(rows) / (255 if bits == 8 else 65535)


def sampled(picture, uv):
    """The picture at each (u,v): bilinear between the centres of pixels, v upwards."""
    height, width = picture.shape
    uv = np.clip(uv, 0, 1)
    x = np.clip(uv[..., 0] * width - 0.5, 0, width - 1)
    y = np.clip((1 - uv[..., 1]) * height - 0.5, 0, height - 1)
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    x1, y1 = np.minimum(x0 + 1, width - 1), np.minimum(y0 + 1, height - 1)
    s, t = x - x0, y - y0
    return ((1 - s) * (1 - t) * picture[y0, x0] + s * (1 - t) * picture[y0, x1] +
            (1 - s) * t * picture[y1, x0] + s * t * picture[y1, x1])


def node_uvs(node_of, faces, shape):
    """The (u,v) of each node's lowest vertex, at its first corner."""
    first = {}
    for vertex, uv in (corner for face in faces for corner in face):
        first.setdefault(vertex, uv)
    uvs = np.full(shape + (2,), np.nan)
    for vertex in sorted(first, reverse=True):
        node = node_of[vertex]
        if first[vertex] is not None:
            uvs[tuple(np.atleast_1d(node))] = first[vertex]
    return uvs


def read_values(element, path_of, uvs):
    """The values of a <map> or a <hold> at the nodes: of a grid, M x N with `uvs` M x N x 2, or of a list."""
    path = path_of(element.get("file"))
    if path.endswith(".npy"):
        values = np.load(path).T
        if uvs.ndim == 2:  # a sheet of triangles: along u first
            values = values.T.ravel()
        assert values.shape == uvs.shape[:-1]
    else:
        values = sampled(read_png(path), uvs)
    assert np.isfinite(values).all()
    return values


def read_map(element, path_of, uvs):
    """The factors of one <map>."""
    low, high = float(element.get("low", 0)), float(element.get("high", 1))
    return low + (high - low) * read_values(element, path_of, uvs)


def read_holds(surface, path_of, uvs, node_of):
    """Whether each node is held by a <hold>; `node_of`: the node of each vertex, below 0: none."""
    held = np.zeros(uvs.shape[:-1], dtype=bool)
    for element in surface.findall("hold"):
        if "vertices" in element.keys():
            for vertex in map(int, element.get("vertices").split()):
                if np.all(node_of[vertex] >= 0):
                    held[tuple(np.atleast_1d(node_of[vertex]))] = True
        else:
            held |= read_values(element, path_of, uvs) > float(element.get("above", 0.5))
    return held


def read_maps(material, path_of, uvs):
    """The factors by channel."""
    found = {}
    for element in material.findall("map"):
        channel = element.get("channel")
        assert channel in CHANNELS and channel not in found, channel
        found[channel] = read_map(element, path_of, uvs)
    return found


def check_material(b, c, d, poisson):
    assert (np.asarray(b) > 0).all() and (np.asarray(d) > 0).all()
    assert abs(poisson) < 1 and (c > 2 * poisson * np.sqrt(b * d)).all(), "poisson with maps"


def check_yield(material, time_scale):
    """Of numbers, or of nodes."""
    assert (np.asarray(material["yield"]) > 0).all() and (np.asarray(material["hardening"]) >= 0).all()
    is_static = not np.any(material["density"]) and not np.any(material["damping"])
    assert not is_static or time_scale == 0 or np.all(material["hardening"]), "static, no hardening"
