"""Reads what `octalux export` writes, and the field that it came from, by the formats' specifications alone.

read_export.py exr FIELD.olx MAP PROBE PROJECTION SIZE PICTURE.exr: every pixel is the texel in its direction
read_export.py gltf FIELD.olx MODEL.gltf REPORT.json: a sound glTF whose nodes stand where the field's probes do
"""

import base64
import json
import math
import os
import struct
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import exr_picture  # noqa: E402


def chunks(path):
    data = open(path, "rb").read()
    count = struct.unpack_from("<I", data, 12)[0]
    found = {}
    for i in range(count):
        kind, _, offset, size = struct.unpack_from("<4sIQQ", data, 64 + 64 * i)
        found[kind.decode()] = data[offset:offset + size]
    return found


# ---- Maps


def half(code):
    return struct.unpack("<e", struct.pack("<H", code))[0]


def rgb9e5(code):
    return [(code >> 9 * i & 511) * 2.0 ** ((code >> 27) - 24) for i in range(3)]


def small_float(code, mantissa):
    exponent, rest = code >> mantissa, code & (1 << mantissa) - 1
    return 2.0 ** (exponent - 15) * (1 + rest / (1 << mantissa)) if exponent else 2.0**-14 * rest / (1 << mantissa)


def r11g11b10f(code):
    return [small_float(code & 2047, 6), small_float(code >> 11 & 2047, 6), small_float(code >> 22, 5)]


def octahedral(u, v):
    x, z = 2 * u - 1, 2 * v - 1
    y = 1 - abs(x) - abs(z)
    if y < 0:
        x, z = (1 - abs(z)) * (1 if x >= 0 else -1), (1 - abs(x)) * (1 if z >= 0 else -1)
    length = math.sqrt(x * x + y * y + z * z)
    return [x / length, y / length, z / length]


def place_of(direction):
    """Where on the map a direction lies: u, v."""
    x, y, z = (c / sum(abs(c) for c in direction) for c in direction)
    if y < 0:
        x, z = (1 - abs(z)) * (1 if x >= 0 else -1), (1 - abs(x)) * (1 if z >= 0 else -1)
    return (x + 1) / 2, (z + 1) / 2


# For each map: its chunk, the bytes of a texel, and what a texel's code means; `s` is the distance scale.
MAPS = {
    "distance": ("DIST", 2, lambda c, s: [half(c & 0x7FFF) * s]),
    "emitter": ("DIST", 2, lambda c, s: [float(c >= 0x7C00)]),
    "normal": ("NORM", 2, lambda c, s: octahedral((c & 255) / 254, (c >> 8) / 254)),
    "base_color": ("BASE", 4, lambda c, s: [((c >> 8 * i & 255) / 255) ** 2 for i in range(3)]),
    "roughness": ("BASE", 4, lambda c, s: [(c >> 24) / 255]),
    "metallic": ("SPEC", 2, lambda c, s: [(c & 255) / 255]),
    "specular_weight": ("SPEC", 2, lambda c, s: [(c >> 8) / 255]),
    "direct": ("DIRE", 4, lambda c, s: rgb9e5(c)),
    "indirect": ("INDI", 4, lambda c, s: rgb9e5(c)),
    "radiance": ("RADI", 4, lambda c, s: r11g11b10f(c)),
    "irradiance": ("IRRA", 4, lambda c, s: r11g11b10f(c)),
    "mean_distance": ("MOME", 4, lambda c, s: [half(c & 0xFFFF) * s]),
    "mean_square_distance": ("MOME", 4, lambda c, s: [half(c >> 16) * s * s]),
    "classic_irradiance": ("CIRR", 4, lambda c, s: r11g11b10f(c)),
}


def stored_map(field, name, probe):
    """The texels of a map, row by row without border, and how many there are along a side."""
    info = field["INFO"]
    scale = struct.unpack_from("<f", info, 44)[0]
    kind, size, meaning = MAPS[name]
    side = struct.unpack_from("<I", field["CLAS"])[0] if kind == "CIRR" else struct.unpack_from(
        "<I", info, 24 if kind in ("IRRA", "MOME") else 20)[0]
    record = (side + 2) ** 2
    codes = struct.unpack_from("<%d%s" % (record, "H" if size == 2 else "I"), field[kind], record * size * probe)
    return side, [[meaning(codes[(y + 1) * (side + 2) + x + 1], scale) for x in range(side)] for y in range(side)]


# ---- OpenEXR


def pixel_directions(projection, size, x, y):
    if projection == "latlong":
        around, down = ((x + 0.5) / (2 * size) - 0.5) * 2 * math.pi, (y + 0.5) / size * math.pi
        return [math.sin(down) * math.cos(around), math.cos(down), math.sin(down) * math.sin(around)]
    a, b = 2 * (x + 0.5) / size - 1, 2 * (y % size + 0.5) / size - 1
    return [[1, -b, -a], [-1, -b, a], [a, 1, b], [a, -1, -b], [a, -b, 1], [-a, -b, -1]][y // size]


def close(a, b):
    return a == b or math.isclose(a, b, rel_tol=2e-6, abs_tol=1e-6)


def check_exr(field_path, name, probe, projection, size, picture):
    side, texels = stored_map(chunks(field_path), name, int(probe))
    size = int(size) or (side // 2 if projection == "cube" else side)
    width, height, channels = exr_picture.read(picture)
    pixels = list(zip(*(channels[n] for n in ("RGB" if len(channels) == 3 else "Y"))))
    assert (width, height) == {"octahedral": (side, side), "latlong": (2 * size, size), "cube": (size, 6 * size)}[projection]
    compared, doubtful = 0, 0
    for y in range(height):
        for x in range(width):
            if projection == "octahedral":
                column, row = x, y
            else:
                u, v = (c * side for c in place_of(pixel_directions(projection, size, x, y)))
                if min(abs(u - round(u)), abs(v - round(v))) < 1e-4:  # the direction is between two texels
                    doubtful += 1
                    continue
                column, row = min(int(u), side - 1), min(int(v), side - 1)
            pixel, texel = pixels[y * width + x], texels[row][column]
            assert len(pixel) == len(texel)
            assert all(close(a, b) for a, b in zip(pixel, texel)), (x, y, pixel, texel)
            compared += 1
    assert compared > 3 * doubtful, "most pixels lie between texels"
    print(f"{name} of probe {probe}, {projection}: {compared} pixels")


# ---- glTF


def accessor(model, buffer, index):
    a = model["accessors"][index]
    view = model["bufferViews"][a["bufferView"]]
    kind, parts = {5126: "f", 5125: "I"}[a["componentType"]], {"VEC3": 3, "SCALAR": 1}[a["type"]]
    assert a["count"] * parts * 4 <= view["byteLength"] and view["byteOffset"] + view["byteLength"] <= len(buffer)
    assert view["byteOffset"] % 4 == 0
    numbers = struct.unpack_from("<%d%s" % (a["count"] * parts, kind), buffer, view["byteOffset"])
    found = [numbers[i:i + parts] for i in range(0, len(numbers), parts)]
    for key, choose in (("min", min), ("max", max)):
        if key in a:
            assert all(close(choose(f[i] for f in found), a[key][i]) for i in range(parts)), "bounds"
    return found


def check_meshes(model, buffer):
    for mesh in model["meshes"]:
        for primitive in mesh["primitives"]:
            positions = accessor(model, buffer, primitive["attributes"]["POSITION"])
            indices = [i for i, in accessor(model, buffer, primitive["indices"])]
            assert "min" in model["accessors"][primitive["attributes"]["POSITION"]]
            assert max(indices) < len(positions) and len(indices) % {1: 2, 4: 3}[primitive["mode"]] == 0
            assert primitive["material"] < len(model["materials"])
            if "COLOR_0" in primitive["attributes"]:
                colors = accessor(model, buffer, primitive["attributes"]["COLOR_0"])
                assert len(colors) == len(positions) and all(0 <= c <= 1 for color in colors for c in color)


def check_nodes(model):
    """Every node is below the root, once."""
    nodes, seen, waiting = model["nodes"], set(), list(model["scenes"][model["scene"]]["nodes"])
    while waiting:
        index = waiting.pop()
        assert index not in seen
        seen.add(index)
        assert "mesh" not in nodes[index] or nodes[index]["mesh"] < len(model["meshes"])
        waiting += nodes[index].get("children", [])
    assert len(seen) == len(nodes)


def group(model, name):
    found = [n for n in model["nodes"] if n["name"] == name and "children" in n]
    return [model["nodes"][i] for i in found[0]["children"]] if found else []


def check_probes(model, field, name, positions, flags):
    nodes = group(model, name)
    assert len(nodes) == len(field.get(flags, b""))
    for i, node in enumerate(nodes):
        place = struct.unpack_from("<3f", field[positions], 12 * i)
        assert all(close(a, b) for a, b in zip(node["translation"], place)), node
        assert node["extras"] == {"probe": i, "buried": bool(field[flags][i] & 1)}, node
        assert ("inside" in model["meshes"][node["mesh"]]["name"]) == node["extras"]["buried"]
    return len(nodes)


def check_boxes(model, buffer, name):
    """The cubes whose edges a node shows: low corners and sides."""
    nodes = [n for n in model["nodes"] if n["name"] == name]
    if not nodes:
        return []
    primitive = model["meshes"][nodes[0]["mesh"]]["primitives"][0]
    positions = accessor(model, buffer, primitive["attributes"]["POSITION"])
    indices = [i for i, in accessor(model, buffer, primitive["indices"])]
    assert len(indices) == 3 * len(positions) and primitive["mode"] == 1
    for a, b in zip(indices[0::2], indices[1::2]):  # edges of boxes run along one axis
        assert a // 8 == b // 8 and sum(not close(p, q) for p, q in zip(positions[a], positions[b])) == 1
    return [(positions[i], positions[i + 7][0] - positions[i][0]) for i in range(0, len(positions), 8)]


def overlap(a, b):
    return all(a[0][i] + a[1] > b[0][i] + 1e-4 * b[1] and b[0][i] + b[1] > a[0][i] + 1e-4 * a[1] for i in range(3))


def check_gltf(field_path, path, report_path):
    field, report = chunks(field_path), json.load(open(report_path))
    model = json.load(open(path), parse_constant=lambda name: sys.exit("not JSON: " + name))
    assert model["asset"]["version"] == "2.0" and len(model["buffers"]) == 1
    head, text = model["buffers"][0]["uri"].split(",", 1)
    buffer = base64.b64decode(text, validate=True)
    assert head == "data:application/octet-stream;base64" and len(buffer) == model["buffers"][0]["byteLength"]
    check_meshes(model, buffer)
    check_nodes(model)
    root = model["nodes"][model["scenes"][0]["nodes"][0]]
    origin = struct.unpack("<3d", field["ORIG"]) if "ORIG" in field else (0, 0, 0)
    assert tuple(root["translation"]) == origin and root["extras"]["scene_hash"] == "%016x" % struct.unpack_from("<Q", field["INFO"], 144)
    assert check_probes(model, field, "light field probes", "PPOS", "PFLG") == report["probes"]
    assert check_probes(model, field, "irradiance probes", "IPOS", "IFLG") == report["irradiance_probes"]
    cells = check_boxes(model, buffer, "cells of the volume")
    whole, divided = (check_boxes(model, buffer, name) for name in ("whole bricks", "divided bricks"))
    assert (len(cells), len(whole), len(divided)) == (report["volume_cells"], report["bricks"], report["divided_bricks"])
    for boxes in (cells[:400], (whole + divided)[:400]):
        assert not any(overlap(a, b) for i, a in enumerate(boxes) for b in boxes[:i]), "boxes overlap"
    if "VOLU" in field:
        number = len(field["VPOS"]) // 12
        assert report["volume_probes"] == number and cells
        mesh = model["meshes"][next(n for n in model["nodes"] if n["name"] == "probes of the volume")["mesh"]]
        corners = accessor(model, buffer, mesh["primitives"][0]["attributes"]["POSITION"])
        assert len(corners) == 6 * number
        for i in range(number):
            middle = [sum(c[k] for c in corners[6 * i:6 * i + 6]) / 6 for k in range(3)]
            assert all(math.isclose(a, b, abs_tol=1e-4 * max(1, abs(b))) for a, b in zip(middle, struct.unpack_from("<3f", field["VPOS"], 12 * i)))
        sides = struct.unpack_from("<f", field["VOLU"], 12)[0]
        assert all(close(sides / side, 2 ** round(math.log2(sides / side))) for _, side in cells)
    print(f"{len(model['nodes'])} nodes, {len(model['meshes'])} meshes, {len(cells)} cells, {len(whole)} and {len(divided)} bricks")


if __name__ == "__main__":
    {"exr": check_exr, "gltf": check_gltf}[sys.argv[1]](*sys.argv[2:])
