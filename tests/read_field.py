#!/usr/bin/env python3
"""A reader of field files that shares nothing with Octalux but docs/format.md and the section Blocks of docs/maths.md.

Usage: read_field.py FIELD.olx            print what is in it as JSON, keys as `octalux info --json` has them
       read_field.py FIELD.olx INFO.json  compare with what `octalux info --json` printed
       read_field.py FIELD.olx --like TEXELS.olx
                                          compare light and material with those of a field of the same scene that was baked with
                                          --uncompressed, and print relative errors

Checks everything the page specifies but the hashes: XXH3 is not in Python's standard library. In the maps it looks at
a sample of the probes. Beyond the page it asks that decoded surfaces lie within the scene and face their probe, as they do
in a baked field when directions, distances, normals and the scale are decoded as they were meant.
"""

import array
import itertools
import json
import math
import struct
import sys

MAGIC = bytes([0x89, 0x4F, 0x4C, 0x58, 0x0D, 0x0A, 0x1A, 0x0A])
PROBES_LOOKED_AT = 8


class Malformed(Exception):
    pass


def need(condition, message):
    if not condition:
        raise Malformed(message)


def aligned(offset):
    return (offset + 63) // 64 * 64


def read_chunks(data):
    need(len(data) >= 64, "no header")
    magic, version, count, file_bytes, _, *reserved, _ = struct.unpack_from("<8sIIQQ3QQ", data, 0)
    need(magic == MAGIC, "magic")
    need(version == 2, f"version {version}")
    need(file_bytes == len(data), f"{len(data)} bytes, but the header says {file_bytes}")
    need(1 <= count <= 256 and not any(reserved), "header")
    chunks, end = {}, 64 + 64 * count
    for i in range(count):
        kind, flags, offset, size, record, element, zero, _, *zeros = struct.unpack_from("<4sIQQQIIQ2Q", data, 64 + 64 * i)
        name = kind.decode("latin-1")
        need(flags in (0, 1) and zero == 0 and not any(zeros), f"{name}: flags or reserved bytes")
        need(offset == end, f"{name}: at {offset}, not at {end}")
        end = aligned(offset + size)
        need(end <= len(data), f"{name}: beyond the end")
        need(not any(data[offset + size:end]), f"{name}: padding")
        if name in SHAPES or name in ("IRSH", "ORIG"):
            need(name not in chunks and flags == 0, f"{name}: twice, or optional")
            chunks[name] = (data[offset:offset + size], record, element)
        else:
            need(flags & 1, f"{name}: required and unknown")
            if name in SELECTORS + CLASSIC + VOLUME + RELIGHT:
                need(name not in chunks, f"{name}: twice")
                chunks[name] = (data[offset:offset + size], record, element)
    need(end == len(data), "bytes after the last chunk")
    needed = set(SHAPES) - PROBE_LIGHT - set(TEXELS) - set(BLOCKS) - set(DISTANCES) - set(PLANES)
    need(needed <= set(chunks), f"missing: {sorted(needed - set(chunks))}")
    return chunks


# Chunks of probe light: a field has all of them, some with IRSH in place of IRRA, or none.
PROBE_LIGHT = {"RADI", "IPOS", "IFLG", "IRRA", "MOME"}
# Chunks of surfaces as texels; fields with tiles have other chunks in their place: words of tiles, and pools of blocks.
TEXELS = ("BASE", "SPEC", "DIRE", "INDI")
TILED = ("TBAS", "TREF", "TDIR", "TIND")
POOLS = ("PBAS", "PREF", "PDIR", "PIND")
BLOCKS = TILED + POOLS
# Chunks of geometry as texels; fields with geometry blocks have other chunks in their place.
DISTANCES = ("NORM", "DIST")
PLANES = ("GEOM", "PLAN")
SELECTORS = ("VORO", "OCTR", "BRIK")
CLASSIC = ("CLAS", "CIRR", "CRAD", "CBOX")
VOLUME = ("VOLU", "VPOS", "VIRR")
RELIGHT = ("RLIT",)


def node_sides(n):
    """Texels along a side of the nodes of each level, coarsest first."""
    return [side for side in (256, 64, 16, 4) if side == 4 or n >= 4 * side]


def greatest_sides(n):
    return [side for side in node_sides(n) if side > 4] or [4]


def least_sides(d):
    return greatest_sides(d["n"]) if d["planes"] else node_sides(d["n"])


# type: (bytes of an element, elements of a record, records), as functions of the description
SHAPES = {
    "INFO": lambda d: (160, 1, 1),
    "PPOS": lambda d: (4, 3, d["P"]),
    "PFLG": lambda d: (1, 1, d["P"]),
    "RADI": lambda d: (4, (d["n"] + 2) ** 2, d["P"]),
    "NORM": lambda d: (2, (d["n"] + 2) ** 2, d["P"]),
    "DIST": lambda d: (2, (d["n"] + 2) ** 2, d["P"]),
    "GEOM": lambda d: (16, d["n"] ** 2 // 16, d["P"]),
    "PLAN": lambda d: (8, 1, None),
    "DMIN": lambda d: (2, sum((d["n"] // side) ** 2 for side in least_sides(d)), d["P"]),
    "DMAX": lambda d: (2, sum((d["n"] // side) ** 2 for side in greatest_sides(d["n"])), d["P"]),
    "IPOS": lambda d: (4, 3, d["Q"]),
    "IFLG": lambda d: (1, 1, d["Q"]),
    "IRRA": lambda d: (4, (d["m"] + 2) ** 2, d["Q"]),
    "MOME": lambda d: (4, (d["m"] + 2) ** 2, d["Q"]),
    "BASE": lambda d: (4, (d["n"] + 2) ** 2, d["P"]),
    "SPEC": lambda d: (2, (d["n"] + 2) ** 2, d["P"]),
    "DIRE": lambda d: (4, (d["n"] + 2) ** 2, d["P"]),
    "INDI": lambda d: (4, (d["n"] + 2) ** 2, d["P"]),
    "TBAS": lambda d: (4, (d["n"] // 8) ** 2, d["P"]),
    "TREF": lambda d: (4, (d["n"] // 8) ** 2, d["P"]),
    "TDIR": lambda d: (4, (d["n"] // 8) ** 2, d["P"]),
    "TIND": lambda d: (4, (d["n"] // 8) ** 2, d["P"]),
    "PBAS": lambda d: (8, 1, None),
    "PREF": lambda d: (16, 1, None),
    "PDIR": lambda d: (16, 1, None),
    "PIND": lambda d: (16, 1, None),
    "EMIS": lambda d: (4, (d["n"] // 8) ** 2, d["P"]),
    "LITE": lambda d: (64, 1, None),  # any number of records
    "ETIL": lambda d: (4, 64, None),
}


FORMS = ("octahedral", "sh2", "sh3")


def irradiance_chunk(d):
    """The name and the shape of what holds irradiance."""
    if d["form"] == 0:
        return "IRRA", SHAPES["IRRA"](d)
    return "IRSH", (2, (12, 28)[d["form"] - 1], d["Q"])


def read_origin(chunks):
    """What positions are relative to."""
    if "ORIG" not in chunks:
        return [0.0, 0.0, 0.0]
    blob, record, element = chunks["ORIG"]
    need((len(blob), record, element) == (24, 24, 8), "ORIG: size")
    origin = list(struct.unpack("<3d", blob))
    need(any(origin) and all(abs(value) <= 2e7 for value in origin), "ORIG: 0, or not within 2e7 m")
    return origin


def is_coordinate(metres):
    return abs(metres) <= 1e18


def read_grid(blob, offset):
    numbers = struct.unpack_from("<6f3I", blob, offset)
    return {"origin": list(numbers[0:3]), "spacing": list(numbers[3:6]), "count": list(numbers[6:9])}


def read_info(blob):
    need(len(blob) == 160, "INFO: size")
    keys = ("P", "Q", "buried", "irradiance_buried", "has_grid", "n", "m", "form", "selectors", "bounces", "samples")
    d = dict(zip(keys, struct.unpack_from("<11I", blob, 0)))
    need(d["form"] < len(FORMS), "INFO: form of irradiance")
    d["scale"], = struct.unpack_from("<f", blob, 44)
    d["scene_min"], d["scene_max"] = (list(struct.unpack_from("<3f", blob, at)) for at in (48, 60))
    d["grid"], d["irradiance_grid"] = read_grid(blob, 72), read_grid(blob, 108)
    d["scene_hash"], d["last_bounce"], form = struct.unpack_from("<QfI", blob, 144)
    need(form in (0, 2, 4, 6), "INFO: form")
    d["blocks"], d["planes"] = form >> 2, form >> 1 & 1
    need(0 <= d["last_bounce"] <= 1, "INFO: last bounce")
    need(d["n"] in [2 ** i for i in range(3, 12)] and d["m"] in [2 ** i for i in range(3, 9)] + [0] * (not d["Q"]), "sizes")
    need(d["Q"] or (d["form"], d["m"], blob[108:144]) == (0, 0, bytes(36)), "INFO: speaks of irradiance probes")
    need(d["P"] >= 1 and d["has_grid"] in (0, 1) and d["samples"] >= 1, "INFO")
    need(d["has_grid"] or not d["selectors"] & 1, "selectors")
    need(1e-18 <= d["scale"] <= 1e18, "distance scale")
    need(all(a <= b for a, b in zip(d["scene_min"], d["scene_max"])), "bounds")
    return d


def check_grid(name, grid, count, positions):
    nx, ny, nz = grid["count"]
    need(nx * ny * nz == count, f"{name}: the grid has {nx * ny * nz} probes, not {count}")
    for spacing, n in zip(grid["spacing"], grid["count"]):
        need(spacing > 0 if n > 1 else spacing == 0, f"{name}: spacing")
    for index in range(count):
        place = (index % nx, index // nx % ny, index // nx // ny)
        for axis in range(3):
            expected = grid["origin"][axis] + place[axis] * grid["spacing"][axis]
            error = abs(positions[3 * index + axis] - expected)
            need(error <= 1e-4 * grid["spacing"][axis] + 1e-6 * abs(expected), f"{name}: position of probe {index}")


def border_source(x, y, n):
    if x < 0 or x >= n:
        x, y = (-1 - x if x < 0 else 2 * n - 1 - x), n - 1 - y
    if y < 0 or y >= n:
        y, x = (-1 - y if y < 0 else 2 * n - 1 - y), n - 1 - x
    return x, y


def check_border(name, codes, n):
    at = lambda x, y: codes[(y + 1) * (n + 2) + x + 1]
    for i in range(-1, n + 1):
        for x, y in ((i, -1), (i, n), (-1, i), (n, i)):
            need(at(x, y) == at(*border_source(x, y, n)), f"{name}: border texel ({x}, {y})")


def decode_half(code):
    return struct.unpack("<e", struct.pack("<H", code))[0]


def decode_small(code, bits):
    exponent, mantissa = code >> bits, code & (1 << bits) - 1
    need(exponent < 31, "exponent 31")
    if exponent == 0:
        return 2.0 ** -14 * mantissa / 2 ** bits
    return 2.0 ** (exponent - 15) * (1 + mantissa / 2 ** bits)


def decode_color(code):
    return [decode_small(code & 0x7FF, 6), decode_small(code >> 11 & 0x7FF, 6), decode_small(code >> 22, 5)]


def decode_shared(code):
    scale = 2.0 ** ((code >> 27) - 24)
    return [(code & 0x1FF) * scale, (code >> 9 & 0x1FF) * scale, (code >> 18 & 0x1FF) * scale]


def octahedral(u, v):
    x, z = 2 * u - 1, 2 * v - 1
    y = 1 - abs(x) - abs(z)
    if y < 0:
        x, z = math.copysign(1 - abs(z), x if x else 1.0), math.copysign(1 - abs(x), z if z else 1.0)
    return [x, y, z]


def direction(u, v):
    q = octahedral(u, v)
    length = math.sqrt(sum(a * a for a in q))
    return [a / length for a in q]


def signed(number, bits):
    return number - (1 << bits) if number >> (bits - 1) else number


def decode_plane(low, high, n, block_x, block_y):
    """The plane m . p = 1 of a code, as a vector m."""
    a, b, c, exponent = signed(low & 0x1FFFF, 17), signed(low >> 17, 15), signed(high & 0x7FFF, 15), high >> 15 & 127
    x, z = 8 * block_x + 4 - n, 8 * block_y + 4 - n
    sx, sz = -1 if x < 0 else 1, -1 if z < 0 else 1
    k, u, v = 4 * a - b * x - c * z, sx * b * n, sz * c * n
    scale = 2.0 ** (exponent - 82)
    return [sx * (k + u) * scale, (k if sx * x + sz * z <= n else -(k + u + v)) * scale, sz * (k + v) * scale]


def block_planes(chunks, d, words, block_x, block_y):
    """The planes of the 16 texels of a block."""
    decode = lambda low, high: decode_plane(low, high, d["n"], block_x, block_y)
    form = words[3] >> 30
    need(form < 3, "GEOM: form")
    if form == 0:
        need(words[3] == 0, "GEOM: reserved bits")
        return [list(struct.unpack("<3f", struct.pack("<3I", *words[:3])))] * 16
    if form == 1:
        need(words[2] >> 30 == 0, "GEOM: reserved bits")
        pair = [decode(words[i], words[2 + i]) for i in (0, 1)]
        return [pair[words[2 + i // 8] >> 22 + i % 8 & 1] for i in range(16)]
    numbers = [words[0] + (words[1 + i // 8] >> 4 * (i % 8) & 15) for i in range(16)]
    need(8 * max(numbers) < len(chunks["PLAN"][0]), "GEOM: a plane that PLAN does not have")
    planes = [decode(*struct.unpack_from("<2I", chunks["PLAN"][0], 8 * number)) for number in numbers]
    nearest, = struct.unpack("<f", struct.pack("<I", words[3] << 1 & 0x7FFFFFFF))
    n = d["n"]
    for i, m in enumerate(planes):
        q = octahedral((4 * block_x + i % 4 + 0.5) / n, (4 * block_y + i // 4 + 0.5) / n)
        need(sum(a * b for a, b in zip(m, q)) <= nearest, "GEOM: a plane that is nearer than its block says")
    return planes


def geometry_of(chunks, d, probe):
    """Rows of (distance over the scale, normal); the distance is infinite for the sky."""
    n = d["n"]
    rows = [[None] * n for _ in range(n)]
    if d["planes"]:
        codes = record(chunks, "GEOM", probe, "I")
        for block in range(n * n // 16):
            x, y = block % (n // 4), block // (n // 4)
            for i, m in enumerate(block_planes(chunks, d, codes[4 * block:4 * block + 4], x, y)):
                out = direction((4 * x + i % 4 + 0.5) / n, (4 * y + i // 4 + 0.5) / n)
                inverse, length = sum(a * b for a, b in zip(m, out)), math.sqrt(sum(a * a for a in m))
                seen = (1 / inverse / d["scale"], [-a / length for a in m]) if inverse > 0 else (math.inf, None)
                rows[4 * y + i // 4][4 * x + i % 4] = seen
        return rows
    normal, distance = record(chunks, "NORM", probe), record(chunks, "DIST", probe)
    for name, codes in (("NORM", normal), ("DIST", distance)):
        check_border(f"{name} of probe {probe}", codes, n)
    for y in range(n):
        for x in range(n):
            at = (y + 1) * (n + 2) + x + 1
            need(distance[at] != 0xFC00, "marked sky")
            r = decode_half(distance[at] & 0x7FFF)
            need(r >= 0, "distance is NaN")
            u, v = normal[at] & 0xFF, normal[at] >> 8
            need(u <= 254 and v <= 254, "normal")
            rows[y][x] = (r, direction(u / 254, v / 254))
    return rows


def record(chunks, name, probe, kind=None):
    blob, record_bytes, element = chunks[name]
    codes = array.array(kind or {1: "B", 2: "H", 4: "I"}[element])
    codes.frombytes(blob[probe * record_bytes:(probe + 1) * record_bytes])
    if sys.byteorder == "big":
        codes.byteswap()
    return codes


PLANE_MISS = 1.2  # bounds a quarter of a footprint, which is up to 4.6 / n of the distance


def inside_scene(d, position, out, metres, off):
    reach = 1e-3 * metres + 1e-5 * d["scale"] + off  # the rounding of the distance, and of the scene's bounds
    return all(low - reach <= p + o * metres <= high + reach
               for p, o, low, high in zip(position, out, d["scene_min"], d["scene_max"]))


def pyramid(texels, n, sides, choose):
    nodes = []
    for side in sides:
        count = n // side
        level = [0.0] * count ** 2
        for y in range(count):
            for x in range(count):
                tile = (y // 4 * (count // 4) + x // 4) * 16 + y % 4 * 4 + x % 4
                rows = (row[x * side:(x + 1) * side] for row in texels[y * side:(y + 1) * side])
                level[tile if count >= 4 else y * count + x] = choose(map(choose, rows))
        nodes += level
    return nodes


def check_light_field_probe(chunks, d, probe):
    """Returns the share of surfaces that lie within the scene and face the probe."""
    n = d["n"]
    geometry = geometry_of(chunks, d, probe)
    radiance = record(chunks, "RADI", probe) if d["Q"] else []
    if radiance:
        check_border(f"RADI of probe {probe}", radiance, n)
    for code in radiance:
        decode_color(code)
    stored_map = [[seen[0] for seen in row] for row in geometry]
    position = struct.unpack_from("<3f", chunks["PPOS"][0], 12 * probe)
    plausible = surfaces = 0
    for y in range(n):
        for x in range(n):
            r, surface = geometry[y][x]
            if r < math.inf:
                surfaces += 1
                out = direction((x + 0.5) / n, (y + 0.5) / n)
                facing = sum(p * q for p, q in zip(out, surface)) <= 0.02  # normals are off by up to 0.64 degrees
                off = PLANE_MISS * r * d["scale"] / n / max(-sum(p * q for p, q in zip(out, surface)), 0.05) if d["planes"] else 0
                plausible += facing and inside_scene(d, position, out, r * d["scale"], off)
    for name, sides, choose in (("DMIN", least_sides(d), min), ("DMAX", greatest_sides(n), max)):
        nodes, exact = [decode_half(code) for code in record(chunks, name, probe)], pyramid(stored_map, n, sides, choose)
        # Bounds hold over the whole of each texel, not only at its middle.
        outside = all(choose(a, b) == a for a, b in zip(nodes, exact))
        need(outside if d["planes"] else nodes == exact, f"{name} of probe {probe}")
    return plausible / surfaces if surfaces else 1.0


# BC6H. Modes with one region: precision, bits of difference. Modes with two regions: bits of the mode, precision, bits
# of difference of each channel, and the runs of bits of their ends.
ONE_REGION = {3: (10, 10), 7: (11, 9), 11: (12, 8), 15: (16, 4)}
TWO_REGIONS = {
    0: (2, 10, (5, 5, 5),
        "g2.4 b2.4 b3.4 r0.0-9 g0.0-9 b0.0-9 r1.0-4 g3.4 g2.0-3 "
        "g1.0-4 b3.0 g3.0-3 b1.0-4 b3.1 b2.0-3 r2.0-4 b3.2 r3.0-4 b3.3"),
    1: (2, 7, (6, 6, 6),
        "g2.5 g3.4-5 r0.0-6 b3.0-1 b2.4 g0.0-6 b2.5 b3.2 g2.4 b0.0-6 b3.3 "
        "b3.5 b3.4 r1.0-5 g2.0-3 g1.0-5 g3.0-3 b1.0-5 b2.0-3 r2.0-5 r3.0-5"),
    2: (5, 11, (5, 4, 4),
        "r0.0-9 g0.0-9 b0.0-9 r1.0-4 r0.10 g2.0-3 g1.0-3 g0.10 "
        "b3.0 g3.0-3 b1.0-3 b0.10 b3.1 b2.0-3 r2.0-4 b3.2 r3.0-4 b3.3"),
    6: (5, 11, (4, 5, 4),
        "r0.0-9 g0.0-9 b0.0-9 r1.0-3 r0.10 g3.4 g2.0-3 g1.0-4 g0.10 "
        "g3.0-3 b1.0-3 b0.10 b3.1 b2.0-3 r2.0-3 b3.0 b3.2 r3.0-3 g2.4 b3.3"),
    10: (5, 11, (4, 4, 5),
        "r0.0-9 g0.0-9 b0.0-9 r1.0-3 r0.10 b2.4 g2.0-3 g1.0-3 g0.10 "
        "b3.0 g3.0-3 b1.0-4 b0.10 b2.0-3 r2.0-3 b3.1-2 r3.0-3 b3.4 b3.3"),
    14: (5, 9, (5, 5, 5),
        "r0.0-8 b2.4 g0.0-8 g2.4 b0.0-8 b3.4 r1.0-4 g3.4 g2.0-3 "
        "g1.0-4 b3.0 g3.0-3 b1.0-4 b3.1 b2.0-3 r2.0-4 b3.2 r3.0-4 b3.3"),
    18: (5, 8, (6, 5, 5),
        "r0.0-7 g3.4 b2.4 g0.0-7 b3.2 g2.4 b0.0-7 b3.3-4 r1.0-5 "
        "g2.0-3 g1.0-4 b3.0 g3.0-3 b1.0-4 b3.1 b2.0-3 r2.0-5 r3.0-5"),
    22: (5, 8, (5, 6, 5),
        "r0.0-7 b3.0 b2.4 g0.0-7 g2.5 g2.4 b0.0-7 g3.5 b3.4 r1.0-4 g3.4 "
        "g2.0-3 g1.0-5 g3.0-3 b1.0-4 b3.1 b2.0-3 r2.0-4 b3.2 r3.0-4 b3.3"),
    26: (5, 8, (5, 5, 6),
        "r0.0-7 b3.1 b2.4 g0.0-7 b2.5 g2.4 b0.0-7 b3.5 b3.4 r1.0-4 g3.4 "
        "g2.0-3 g1.0-4 b3.0 g3.0-3 b1.0-5 b2.0-3 r2.0-4 b3.2 r3.0-4 b3.3"),
    30: (5, 6, (0, 0, 0),
        "r0.0-5 g3.4 b3.0-1 b2.4 g0.0-5 g2.5 b2.5 b3.2 g2.4 b0.0-5 g3.5 "
        "b3.3 b3.5 b3.4 r1.0-5 g2.0-3 g1.0-5 g3.0-3 b1.0-5 b2.0-3 r2.0-5 r3.0-5"),
}
TWO_REGION_SHAPES = [int(word, 16) for word in """
    CCCC 8888 EEEE ECC8 C880 FEEC FEC8 EC80 C800 FFEC FE80 E800 FFE8 FF00 FFF0 F000
    F710 008E 7100 08CE 008C 7310 3100 8CCE 088C 3110 6666 366C 17E8 0FF0 718E 399C""".split()]
ANCHORS = [15] * 17 + [2, 8, 2, 2, 8, 8, 15, 2, 8, 2, 2, 8, 8, 2, 2]


def bits_of(block, first, count):
    return block >> first & (1 << count) - 1


def add_difference(end, difference, bits, precision):
    if difference >> (bits - 1):
        difference -= 1 << bits
    return (end + difference) % (1 << precision)


def read_one_region(block, precision, difference_bits):
    """The two ends of the line, three channels each."""
    first, second = [], []
    for channel in range(3):
        rest = bits_of(block, 35 + 10 * channel, 10)
        low, difference, more = bits_of(block, 5 + 10 * channel, 10), rest % (1 << difference_bits), rest >> difference_bits
        for i in range(precision - 10):
            low |= (more >> i & 1) << (precision - 1 - i)
        first.append(low)
        second.append(difference if precision == 10 else add_difference(low, difference, difference_bits, precision))
    return first, second


def read_two_regions(block, code_bits, precision, difference_bits, runs):
    """The ends of both lines."""
    ends, at = [[0] * 3 for _ in range(4)], code_bits
    for run in runs.split():
        name, place = run.split(".")
        first, last = (place + "-" + place).split("-")[:2]
        count = int(last) - int(first) + 1
        ends[int(name[1])]["rgb".index(name[0])] |= bits_of(block, at, count) << int(first)
        at += count
    need(at == 77, "BC6H: runs")
    for end in ends[1:]:
        for channel, bits in enumerate(difference_bits):
            if bits:
                end[channel] = add_difference(ends[0][channel], end[channel], bits, precision)
    return ends


def unquantize(number, precision):
    if precision == 16 or number == 0:
        return number
    return 0xFFFF if number == (1 << precision) - 1 else ((number << 16) + 0x8000) >> precision


def mix_light(ends, precision, share):
    pairs = zip(*[[unquantize(number, precision) for number in end] for end in ends])
    return [decode_half((a * (64 - share) + b * share + 32 >> 6) * 31 >> 6) for a, b in pairs]


def decode_bc6h(data):
    block = int.from_bytes(data, "little")
    mode = block & 31
    if mode in ONE_REGION:
        precision, difference_bits = ONE_REGION[mode]
        ends = read_one_region(block, precision, difference_bits)
        indices = [bits_of(block, 65, 3)] + [bits_of(block, 64 + 4 * i, 4) for i in range(1, 16)]
        return [mix_light(ends, precision, (64 * index + 7) // 15) for index in indices]
    mode = mode & 3 if mode & 3 < 2 else mode
    need(mode in TWO_REGIONS, f"BC6H: mode {mode}")
    code_bits, precision, difference_bits, runs = TWO_REGIONS[mode]
    ends = read_two_regions(block, code_bits, precision, difference_bits, runs)
    shape, at, texels = TWO_REGION_SHAPES[bits_of(block, 77, 5)], 82, []
    for i in range(16):
        count = 2 if i in (0, ANCHORS[bits_of(block, 77, 5)]) else 3
        index, region = bits_of(block, at, count), shape >> i & 1
        texels.append(mix_light(ends[2 * region:2 * region + 2], precision, (64 * index + 3) // 7))
        at += count
    return texels


def decode_bc1(data):
    first, second, indices = struct.unpack("<HHI", data)
    widen = lambda code: [(code >> 11) * 33 >> 2, (code >> 5 & 63) * 65 >> 4, (code & 31) * 33 >> 2]
    a, b = widen(first), widen(second)
    if first > second:
        line = [a, b, [(2 * x + y + 1) // 3 for x, y in zip(a, b)], [(x + 2 * y + 1) // 3 for x, y in zip(a, b)]]
    else:
        line = [a, b, [(x + y + 1) // 2 for x, y in zip(a, b)], [0, 0, 0]]
    return [line[indices >> 2 * i & 3] for i in range(16)]


def decode_bc4(data):
    block = int.from_bytes(data, "little")
    first, second = block & 255, block >> 8 & 255
    parts = 7 if first > second else 5
    line = [first, second] + [(2 * ((parts - i) * first + i * second) + parts) // (2 * parts) for i in range(1, parts)]
    line += [0, 255] if parts == 5 else []
    return [line[bits_of(block, 16 + 3 * i, 3)] for i in range(16)]


def untile(chunks, name, d, probe, decode, size, offset=0, bytes_used=None):
    """A map of tiles as rows of texels; None for tiles of sky."""
    words, pool = record(chunks, "T" + name, probe), chunks["P" + name][0]
    n, used, decoded = d["n"], bytes_used or size, {}
    rows = [[None] * n for _ in range(n)]
    for tile, word in enumerate(words):
        form, first = word >> 30, word & (1 << 30) - 1
        if not word:
            continue
        need(form in (1, 2) and size * (first + (1, 4)[form - 1]) <= len(pool), f"T{name} of probe {probe}: tile {tile}")
        for i in range(64):
            x, y = i % 8, i // 8
            block, texel = (first, y // 2 * 4 + x // 2) if form == 1 else (first + y // 4 * 2 + x // 4, y % 4 * 4 + x % 4)
            if block not in decoded:
                decoded[block] = decode(pool[size * block + offset:size * block + offset + used])
            rows[tile // (n // 8) * 8 + y][tile % (n // 8) * 8 + x] = decoded[block][texel]
    return rows


def check_sky_tiles(chunks, d, probe, sky):
    """Tiles of nothing but sky are 0, and no others."""
    for name in TILED:
        for tile, word in enumerate(record(chunks, name, probe)):
            x, y = tile % (d["n"] // 8) * 8, tile // (d["n"] // 8) * 8
            alone = all(sky[y + i // 8][x + i % 8] for i in range(64))
            need(alone == (word == 0), f"{name} of probe {probe}: tile at ({x}, {y})")


def read_surfaces(chunks, d, probe, sky):
    """Rows of (base colour, roughness, metallic, specular weight, direct light, indirect light); None for the sky."""
    n, rows = d["n"], []
    if d["blocks"]:
        check_sky_tiles(chunks, d, probe, sky)
        base = untile(chunks, "BAS", d, probe, decode_bc1, 8)
        roughness = untile(chunks, "REF", d, probe, decode_bc4, 16, 0, 8)
        reflectance = untile(chunks, "REF", d, probe, decode_bc4, 16, 8, 8)
        direct, indirect = (untile(chunks, name, d, probe, decode_bc6h, 16) for name in ("DIR", "IND"))
    else:
        maps = {name: record(chunks, name, probe) for name in TEXELS}
        for name, codes in maps.items():
            check_border(f"{name} of probe {probe}", codes, n)
    for y in range(n):
        rows.append([])
        for x in range(n):
            if d["blocks"]:
                r = reflectance[y][x]
                surface = None if r is None else ([(b / 255) ** 2 for b in base[y][x]], roughness[y][x] / 255, max(r - 128, 0) / 127,
                           min(r / 128, 1), direct[y][x], indirect[y][x])
            else:
                codes = [maps[name][(y + 1) * (n + 2) + x + 1] for name in TEXELS]
                need(not (sky[y][x] and any(codes)), f"surface of probe {probe}: sky at ({x}, {y})")
                surface = ([((codes[0] >> shift & 0xFF) / 255) ** 2 for shift in (0, 8, 16)], (codes[0] >> 24) / 255,
                           (codes[1] & 0xFF) / 255, (codes[1] >> 8) / 255, decode_shared(codes[2]), decode_shared(codes[3]))
            rows[y].append(None if sky[y][x] else surface)
    return rows


def sky_of(chunks, d, probe):
    return [[seen[0] == math.inf for seen in row] for row in geometry_of(chunks, d, probe)]


def check_surfaces(chunks, d, probe):
    n, side = d["n"], d["n"] // 8
    surfaces = read_surfaces(chunks, d, probe, sky_of(chunks, d, probe))
    distance, tiles = None if d["planes"] else record(chunks, "DIST", probe), record(chunks, "EMIS", probe)
    count = len(chunks["ETIL"][0]) // 256
    need(max(tiles) <= count, f"EMIS of probe {probe}: tile {max(tiles) - 1}")
    for y in range(n):
        for x in range(n):
            at, entry = (y + 1) * (n + 2) + x + 1, tiles[y // 8 * side + x // 8]
            emission = [0.0, 0.0, 0.0]
            if entry:
                code, = struct.unpack_from("<I", chunks["ETIL"][0], 256 * (entry - 1) + 4 * (y % 8 * 8 + x % 8))
                emission = decode_shared(code)
            need(d["planes"] or distance[at] >= 0x7C00 or not any(emission), f"ETIL of probe {probe}: emission at ({x}, {y})")
            if surfaces[y][x] is None:
                continue
            color, roughness, metallic, weight, direct, indirect = surfaces[y][x]
            # The baker clamps base colours to 0.95; the root that a code stores is off by half a step, a block's by
            # half of 1/31.
            need(max(color) <= (1.0 if d["blocks"] else 0.96), f"base colour of probe {probe}: {color}")
            need(max(roughness, metallic, weight) <= 1, f"material of probe {probe}")
            need(all(map(math.isfinite, direct + indirect)), f"light of probe {probe}")


def errors_against(path, reference):
    """Relative MSE of base colour, direct and indirect light over the probes looked at, and mean errors of the other numbers."""
    fields = []
    for name in (path, reference):
        with open(name, "rb") as file:
            chunks = read_chunks(file.read())
        fields.append((chunks, read_info(chunks["INFO"][0])))
    (chunks, d), (plain, e) = fields
    need((d["P"], d["n"], d["blocks"], e["blocks"]) == (e["P"], e["n"], 1, 0), "not a field of blocks and one of texels")
    names = ("base_color", "roughness", "metallic", "weight", "direct", "indirect")
    off, of, count = [0.0] * 6, [0.0] * 6, 0
    for probe in sample(d["P"]):
        sky = sky_of(chunks, d, probe)
        need(sky == sky_of(plain, e, probe), f"other surfaces at probe {probe}")
        for found, wanted in zip(read_surfaces(chunks, d, probe, sky), read_surfaces(plain, e, probe, sky)):
            for a, b in zip(found, wanted):
                if a is None:
                    continue
                count += 1
                for i, (x, y) in enumerate(zip(a, b)):
                    pairs = list(zip(x, y)) if isinstance(x, list) else [(x, y)]
                    off[i] += sum((p - q) ** 2 for p, q in pairs)
                    of[i] += sum(q * q for p, q in pairs)
    relative = {name: off[i] / of[i] if of[i] else off[i] for i, name in enumerate(names) if i in (0, 4, 5)}
    return relative | {name: math.sqrt(off[i] / max(count, 1)) for i, name in enumerate(names) if i in (1, 2, 3)}


def check_lights(blob):
    for i in range(len(blob) // 64):
        kind, *numbers = struct.unpack_from("<I11f4I", blob, 64 * i)
        position, way, emission, cone, zeros = numbers[0:3], numbers[3:6], numbers[6:9], numbers[9:11], numbers[11:]
        need(kind <= 2 and not any(zeros), f"LITE: light {i}")
        need(all(map(math.isfinite, position + emission)) and (kind or not any(position)), f"LITE: light {i}: place")
        need(kind == 1 and not any(way) or abs(sum(a * a for a in way) - 1) <= 1e-3, f"LITE: light {i}: direction")
        need(-1 <= cone[1] <= cone[0] <= 1 if kind == 2 else not any(cone), f"LITE: light {i}: cone")
    return len(blob) // 64


ROUNDING = 2.0 ** -9  # of moments


def check_irradiance_probe(chunks, d, probe):
    m = d["m"]
    irradiance, moments = record(chunks, irradiance_chunk(d)[0], probe), record(chunks, "MOME", probe)
    if d["form"]:
        values = [decode_half(code) for code in irradiance]
        need(all(map(math.isfinite, values)) and min(values[:3]) >= 0, f"IRSH of probe {probe}")
        need(d["form"] == 1 or irradiance[27] == 0, f"IRSH of probe {probe}: filling")
    else:
        check_border(f"IRRA of probe {probe}", irradiance, m)
        for code in irradiance:
            decode_color(code)
    check_border(f"MOME of probe {probe}", moments, m)
    for code in moments:
        mean, square = decode_half(code & 0xFFFF), decode_half(code >> 16)
        need(0 <= mean <= 1.01 and 0 <= square <= 1.01 ** 2 * (1 + ROUNDING), f"MOME of probe {probe}")
        need(mean * mean <= square * (1 + ROUNDING) + 2.0 ** -24, f"MOME of probe {probe}: variance")


def bytes_of(chunks, name):
    """What a chunk of one record of any number of u8 holds."""
    blob, record_bytes, element_bytes = chunks[name]
    need((element_bytes, record_bytes) == (1, len(blob)), f"{name}: not one record of bytes")
    return blob


def read_codes(blob, offset, count, probes):
    """Names of probes, None where there is none."""
    kind, none = ("B", 0xFF) if probes <= 255 else ("H", 0xFFFF)
    codes = array.array(kind)
    need(len(blob) == offset + count * codes.itemsize, "size of a selector")
    codes.frombytes(blob[offset:])
    if sys.byteorder == "big":
        codes.byteswap()
    return [None if code == none else code for code in codes]


def check_choices(name, choices, probes):
    known = [probe for probe in choices if probe is not None]
    need(choices[:len(known)] == known and len(set(known)) == len(known), f"{name}: {choices}")
    need(all(probe < probes for probe in known), f"{name}: no such probe in {choices}")


def check_split(tree, positions, axis=0):
    """A k-d tree: the probes before the middle one do not lie beyond it, and those after it do not lie before it."""
    if len(tree) < 2:
        return
    middle, at = len(tree) // 2, [positions[3 * probe + axis] for probe in tree]
    need(max(at[:middle]) <= at[middle] <= min(at[middle:]), "VORO: order of the tree")
    check_split(tree[:middle], positions, (axis + 1) % 3)
    check_split(tree[middle + 1:], positions, (axis + 1) % 3)


def check_voronoi(chunks, probes):
    blob = bytes_of(chunks, "VORO")
    need(len(blob) >= 16, "VORO: size")
    size, *zeros = struct.unpack_from("<4I", blob, 0)
    need(size in (4, 8, 16, 32, 64) and not any(zeros), "VORO: header")
    codes = read_codes(blob, 16, probes * size * size * 4 + probes, probes)
    maps, tree = codes[:-probes], codes[-probes:]
    need(None not in tree and sorted(tree) == list(range(probes)), "VORO: tree")
    for i in range(0, len(maps), 4):
        check_choices("VORO", codes[i:i + 4], probes)
        need(i // 4 // (size * size) not in codes[i:i + 4], "VORO: its own neighbour")
    check_split(tree, struct.unpack(f"<{3 * probes}f", chunks["PPOS"][0]))


def check_octree(blob, probes):
    need(len(blob) >= 16, "OCTR: size")
    levels, inner, *zeros = struct.unpack_from("<4I", blob, 0)
    need(1 <= levels <= 10 and inner < 2 ** 28 and not any(zeros), "OCTR: header")
    nodes, leaves = 1 + 8 * inner, 1 + 7 * inner
    need(len(blob) >= 16 + 4 * nodes, "OCTR: size")
    codes = read_codes(blob, 16 + 4 * nodes, 4 * leaves, probes)
    for i in range(0, len(codes), 4):
        check_choices("OCTR", codes[i:i + 4], probes)
    reached, level, seen = 0, [0], 0
    for depth in range(levels + 1):
        deeper = []
        for node in level:
            value, = struct.unpack_from("<I", blob, 16 + 4 * node)
            if value >> 31:
                need(value & 0x7FFFFFFF == seen, f"OCTR: node {node}: leaf {value & 0x7FFFFFFF}, not {seen}")
                seen += 1
            else:
                need(depth < levels and value == 1 + 8 * reached and reached < inner, f"OCTR: node {node}")
                reached += 1
                deeper += range(value, value + 8)
        level = deeper
    need(reached == inner and seen == leaves, "OCTR: nodes that nobody reaches")


def check_bricks(blob, probes, map_bytes):
    need(len(blob) >= 64, "BRIK: size")
    x, y, z, cell = struct.unpack_from("<4f", blob, 0)
    nx, ny, nz, divided, lists, *zeros = struct.unpack_from("<12I", blob, 16)
    need(all(map(math.isfinite, (x, y, z, cell))) and cell > 0 and not any(zeros), "BRIK: header")
    need(all(1 <= n <= 65536 for n in (nx, ny, nz)) and 1 <= lists <= 65536, "BRIK: counts")
    bricks = nx * ny * nz
    need(len(blob) == 64 + 4 * (bricks + 32 * divided + 4 * lists), "BRIK: size")
    need(len(blob) <= max(4096, min(4000000, map_bytes // 25)), "BRIK: more than its share")
    index = struct.unpack_from(f"<{bricks}I", blob, 64)
    need(all(i & 0x7FFFFFFF < divided if i >> 31 else i < lists for i in index), "BRIK: index")
    cells = struct.unpack_from(f"<{64 * divided}H", blob, 64 + 4 * bricks)
    need(all(i < lists for i in cells), "BRIK: cells")
    named = struct.unpack_from(f"<{8 * lists}H", blob, 64 + 4 * (bricks + 32 * divided))
    for i in range(0, len(named), 8):
        check_choices("BRIK", [None if probe == 0xFFFF else probe for probe in named[i:i + 8]], probes)


def check_volume_entry(entry, counts, lowest):
    """An entry of a cube, block or split; what it names lies behind where it stands."""
    kind, level, number = entry >> 30, entry >> 27 & 7, entry & 0x7FFFFFF
    if kind == 1:
        need(level <= 4 and number < counts["cells"], f"VOLU: cell {entry:#x}")
    elif kind in (2, 3):
        need(kind in lowest and level == 0, f"VOLU: {entry:#x}")
        need(lowest[kind] <= number < counts["blocks" if kind == 2 else "splits"], f"VOLU: {entry:#x}")
    else:
        need(entry == 0, f"VOLU: {entry:#x}")


def check_volume(chunks):
    """Returns how many probes the volume has."""
    need(all(name in chunks for name in VOLUME), "volume: not all of it")
    blob = bytes_of(chunks, "VOLU")
    need(len(blob) >= 64, "VOLU: size")
    x, y, z, cube = struct.unpack_from("<4f", blob, 0)
    nx, ny, nz, blocks, splits, cells, probes, *zeros = struct.unpack_from("<12I", blob, 16)
    need(all(map(math.isfinite, (x, y, z))) and math.frexp(cube)[0] == 0.5 and not any(zeros), "VOLU: header")
    need(all(1 <= n <= 65536 for n in (nx, ny, nz)) and cells >= 1 and probes >= 1, "VOLU: counts")
    need(len(blob) == 64 + 32 * splits + 32 * cells + 256 * blocks + 4 * nx * ny * nz, "VOLU: size")
    counts, at = {"blocks": blocks, "splits": splits, "cells": cells}, 64
    for i in range(splits):
        a, b, c, offset, behind, front, *zeros = struct.unpack_from("<4f4I", blob, at + 32 * i)
        need(abs(a * a + b * b + c * c - 1) <= 1e-3 and math.isfinite(offset) and not any(zeros), f"VOLU: split {i}")
        check_volume_entry(behind, counts, {3: i + 1})
        check_volume_entry(front, counts, {3: i + 1})
    at += 32 * splits
    need(all(probe < probes for probe in struct.unpack_from(f"<{8 * cells}I", blob, at)), "VOLU: cells")
    at += 32 * cells
    for i, entry in enumerate(struct.unpack_from(f"<{64 * blocks}I", blob, at)):
        check_volume_entry(entry, counts, {2: i // 64 + 1, 3: 0})
    for entry in struct.unpack_from(f"<{nx * ny * nz}I", blob, at + 256 * blocks):
        check_volume_entry(entry, counts, {2: 0, 3: 0})
    for name, element, elements in (("VPOS", 4, 3), ("VIRR", 2, 28)):
        blob, record, size = chunks[name]
        need((size, record, len(blob)) == (element, element * elements, element * elements * probes), name)
    need(all(map(is_coordinate, struct.unpack(f"<{3 * probes}f", chunks["VPOS"][0]))), "VPOS")
    for probe in sample(probes):
        values = [decode_half(code) for code in record_of_halves(chunks["VIRR"][0], probe)]
        need(all(map(math.isfinite, values)) and min(values[:3]) >= 0 and values[27] == 0, f"VIRR of probe {probe}")
    return probes


def record_of_halves(blob, probe):
    return struct.unpack_from("<28H", blob, 56 * probe)


def check_classic(chunks, d):
    """Returns the sizes that `octalux info` tells."""
    need(all(name in chunks for name in CLASSIC), "classic maps: not all of them")
    blob = chunks["CLAS"][0]
    need(len(blob) == chunks["CLAS"][2] == 64 + 4 * 64 * 64, "CLAS: size")
    k, cube, levels, side, sharpness, *zeros = struct.unpack_from("<4If11I", blob, 0)
    need(k in (32, 64, 128, 256) and cube in [2 ** i for i in range(5, 11)] and levels == 5 and side == 64, "CLAS: sizes")
    need(64 <= sharpness <= 65536 and not any(zeros), "CLAS: header")
    for code in struct.unpack_from(f"<{64 * 64}I", blob, 64):
        scale, bias = decode_half(code & 0xFFFF), decode_half(code >> 16)
        need(0 <= scale and 0 <= bias and scale + bias <= 2, "CLAS: table")
    sides = [max(k >> level, 8) for level in range(levels)]
    texels = {"CIRR": (k + 2) ** 2, "CRAD": sum((n + 2) ** 2 for n in sides), "CBOX": 6}
    for name, elements in texels.items():
        blob, record_bytes, element_bytes = chunks[name]
        need((element_bytes, record_bytes, len(blob)) == (4, 4 * elements, 4 * elements * d["Q"]), name)
    for probe in sample(d["Q"]):
        codes = record(chunks, "CRAD", probe)
        for n in sides:
            check_border(f"CRAD of probe {probe}", codes[:(n + 2) ** 2], n)
            codes = codes[(n + 2) ** 2:]
        codes = record(chunks, "CIRR", probe)
        check_border(f"CIRR of probe {probe}", codes, k)
        need(all(map(math.isfinite, decode_color(codes[k * k // 2]))), f"CIRR of probe {probe}")
        box = struct.unpack_from("<6f", chunks["CBOX"][0], 24 * probe)
        position = struct.unpack_from("<3f", chunks["IPOS"][0], 12 * probe)
        need(all(low <= p <= high for low, p, high in zip(box, position, box[3:])), f"CBOX of probe {probe}")
    return {"size": k, "cube_size": cube, "sharpness": sharpness}


def check_rows(name, blob, elements):
    """Where the rows of an array start: they follow each other, from its first element to its last."""
    starts = [start for start, in struct.iter_unpack("<I", blob)]
    need(starts[0] == 0 and starts[-1] == elements and starts == sorted(starts), f"RLIT: {name}")


def check_surfels(blob):
    for i, (*places, normal, _, _) in enumerate(struct.iter_unpack("<24f3I", blob)):
        need(all(map(is_coordinate, places)), f"RLIT: places of surfel {i}")
        need(normal & 0xFF <= 254 and normal >> 8 <= 254, f"RLIT: normal of surfel {i}")


def check_sources(name, blob, layout, bits, surfels):
    """The surfels from which light comes, in some bits of each element's first word."""
    for i, (word,) in enumerate(struct.iter_unpack(layout, blob)):
        need(word & bits < surfels, f"RLIT: surfel of {name} {i}")


def check_sites(blob, sites):
    for i, (first, which) in enumerate(struct.iter_unpack("<2I", blob)):
        last = first + max(which >> 2 * texel & 3 for texel in range(16))
        need(first == 0xFFFFFFFF or last < sites, f"RLIT: sites of block {i}")


def check_relight(chunks, d, volume_probes):
    """Returns the counts that `octalux info` tells."""
    blob = bytes_of(chunks, "RLIT")
    need(len(blob) >= 64, "RLIT: size")
    surfels, links, sites, entries, volume_links, blocks, probes, *zeros = struct.unpack_from("<16I", blob, 0)
    others = (links, sites, entries, volume_links, blocks, probes)
    need(surfels <= 2 ** 24 and max(others) <= 2 ** 28 and not any(zeros), "RLIT: header")
    need((blocks, probes) == (d["P"] * (d["n"] // 4) ** 2, volume_probes), "RLIT: of another field")
    sizes = (108 * surfels, 4 * (surfels + 1), 8 * links, 8 * blocks, 4 * (sites + 1), 8 * entries,
             4 * (probes + 1), 12 * volume_links)
    need(len(blob) == 64 + sum(sizes), "RLIT: size")
    ends = list(itertools.accumulate(sizes, initial=64))
    (surfel_array, link_starts, link_array, block_array, entry_starts, entry_array, volume_starts,
     volume_array) = (blob[start:end] for start, end in zip(ends, ends[1:]))
    check_surfels(surfel_array)
    check_rows("links", link_starts, links)
    check_rows("entries", entry_starts, entries)
    check_rows("volume links", volume_starts, volume_links)
    check_sites(block_array, sites)
    check_sources("link", link_array, "<I4x", 0xFFFFFF, surfels)
    check_sources("entry", entry_array, "<I4x", 0xFFFFFFFF, surfels)
    check_sources("volume link", volume_array, "<I8x", 0xFFFFFFFF, surfels)
    return {"surfels": surfels, "links": links}


def sample(count):
    step = max(1, count // PROBES_LOOKED_AT)
    return range(0, count, step)


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    chunks = read_chunks(data)
    d = read_info(chunks["INFO"][0])
    shapes = {name: shape(d) for name, shape in SHAPES.items() if name != "IRRA"} | dict([irradiance_chunk(d)])
    probe_light = PROBE_LIGHT - {"IRRA"} | {irradiance_chunk(d)[0]}
    need((PROBE_LIGHT | {"IRSH"}) & set(chunks) == (probe_light if d["Q"] else set()), "probe light in part, or in another form")
    need(set(TEXELS + BLOCKS) & set(chunks) == set(BLOCKS if d["blocks"] else TEXELS), "surfaces in part, or in another form")
    need(set(DISTANCES + PLANES) & set(chunks) == set(PLANES if d["planes"] else DISTANCES), "geometry in part, or in another form")
    shapes = {name: shape for name, shape in shapes.items() if name in chunks}
    for name, (element, elements, records) in shapes.items():
        blob, record_bytes, element_bytes = chunks[name]
        records = len(blob) // (element * elements) if records is None else records
        need((element_bytes, record_bytes, len(blob)) == (element, element * elements, element * elements * records), name)
    for kind, count, buried, grid in (("P", d["P"], d["buried"], "grid"),
                                      ("I", d["Q"], d["irradiance_buried"], "irradiance_grid")):
        if not count:
            need(buried == 0, "buried, but not there")
            continue
        positions = struct.unpack(f"<{3 * count}f", chunks[kind + "POS"][0])
        need(all(map(is_coordinate, positions)), f"{kind}POS")
        if kind == "I" or d["has_grid"]:
            check_grid(kind + "POS", d[grid], count, positions)
        flags = chunks[kind + "FLG"][0]
        need(set(flags) <= {0, 1} and sum(flags) == buried, f"{kind}FLG")
    plausible = [check_light_field_probe(chunks, d, i) for i in sample(d["P"]) if not chunks["PFLG"][0][i]]
    need(min(plausible, default=1) == 1, f"surfaces outside the scene or turned away ({1 - min(plausible, default=1):.3f})")
    for i in sample(d["P"]):
        check_surfaces(chunks, d, i)
    for i in sample(d["Q"]):
        check_irradiance_probe(chunks, d, i)
    size = lambda name: len(chunks[name][0]) if name in chunks else 0
    stored = [name for bit, name in enumerate(SELECTORS, 1) if d["selectors"] >> bit & 1]
    need(stored == [name for name in SELECTORS if name in chunks], "selectors without their chunks")
    if "VORO" in chunks:
        check_voronoi(chunks, d["P"])
    if "OCTR" in chunks:
        check_octree(bytes_of(chunks, "OCTR"), d["P"])
    if "BRIK" in chunks:
        check_bricks(bytes_of(chunks, "BRIK"), d["P"], 8 * d["P"] * (d["n"] + 2) ** 2)
    names = [name for bit, name in enumerate(("cage", "voronoi", "octree", "bricks")) if d["selectors"] >> bit & 1]
    told = {
        "version": 2, "compressed": d["blocks"] == 1, "geometry_blocks": d["planes"] == 1, "probe_light": d["Q"] > 0, "lights": check_lights(chunks["LITE"][0]),
        "probes": d["P"], "irradiance_probes": d["Q"], "buried": d["buried"], "irradiance_buried": d["irradiance_buried"],
        "volume_probes": check_volume(chunks) if "VOLU" in chunks else 0,
        "origin": read_origin(chunks), "radiance_size": d["n"], "irradiance_size": d["m"], "select": ",".join(names) or "none", "file_bytes": len(data),
        "bytes": {"radiance": size("RADI"), "normal": size("NORM"), "distance": size("DIST"), "pyramid": size("DMIN") + size("DMAX"), "geometry": size("GEOM") + size("PLAN"),
                  "material": sum(map(size, ("BASE", "SPEC", "TBAS", "TREF", "PBAS", "PREF"))),
                  "direct": sum(map(size, ("DIRE", "TDIR", "PDIR"))), "indirect": sum(map(size, ("INDI", "TIND", "PIND"))),
                  "emission": size("EMIS") + size("ETIL"), "irradiance": size(irradiance_chunk(d)[0]), "moments": size("MOME"), "selector": sum(map(size, stored)),
                  "classic": sum(size(name) for name in CLASSIC if name in chunks),
                  "volume": sum(size(name) for name in VOLUME if name in chunks)},
        "bounces": d["bounces"], "last_bounce": d["last_bounce"], "samples": d["samples"],
        "distance_scale_metres": d["scale"], "scene_min": d["scene_min"], "scene_max": d["scene_max"],
        "scene_hash": f"{d['scene_hash']:016x}",
    }
    if d["Q"]:
        told |= {"irradiance": FORMS[d["form"]], "irradiance_grid": d["irradiance_grid"]}
    if any(name in chunks for name in CLASSIC):
        told["classic"] = check_classic(chunks, d)
    if "RLIT" in chunks:
        told["relight"] = check_relight(chunks, d, told["volume_probes"])
        told["bytes"]["relight"] = size("RLIT")
    return {**told, "grid": d["grid"]} if d["has_grid"] else told


def differences(mine, theirs, where=""):
    if isinstance(mine, dict):
        for key, value in mine.items():
            if not isinstance(theirs, dict) or key not in theirs:
                yield f"{where}{key}: missing"
            else:
                yield from differences(value, theirs[key], f"{where}{key}.")
    elif isinstance(mine, list):
        if len(mine) != len(theirs):
            yield f"{where[:-1]}: {mine} and {theirs}"
        else:
            for i, pair in enumerate(zip(mine, theirs)):
                yield from differences(*pair, f"{where}{i}.")
    elif isinstance(mine, float):
        if not math.isclose(mine, theirs, rel_tol=1e-6):
            yield f"{where[:-1]}: {mine} and {theirs}"
    elif mine != theirs:
        yield f"{where[:-1]}: {mine!r} and {theirs!r}"


def main():
    like = len(sys.argv) == 4 and sys.argv[2] == "--like"
    if len(sys.argv) not in (2, 3) and not like:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        if like:
            print(json.dumps(errors_against(sys.argv[1], sys.argv[3])))
            return 0
        mine = read(sys.argv[1])
    except (Malformed, OSError, struct.error) as error:
        print(f"{sys.argv[1]}: {error}", file=sys.stderr)
        return 1
    if len(sys.argv) == 2:
        print(json.dumps(mine, indent=2))
        return 0
    with open(sys.argv[2], encoding="utf-8") as file:
        found = list(differences(mine, json.load(file)))
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
