"""Plain OpenEXR files of one part: scanlines of 32-bit floats, not compressed. Octalux and Blender know them."""
import struct

import numpy

MAGIC, FLOAT = 20000630, 2


def text_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def read_header(data, path):
    magic, version = struct.unpack_from("<II", data, 0)
    if magic != MAGIC or version & 0x1a00:
        raise ValueError("%s: not an OpenEXR file of one part with scanlines" % path)
    at, attributes = 8, {}
    while data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        (size,) = struct.unpack_from("<I", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channel_names(listed, path):
    names, at = [], 0
    while listed[at]:
        name, at = text_at(listed, at)
        (kind,) = struct.unpack_from("<I", listed, at)
        if kind != FLOAT:
            raise ValueError("%s: channel %s is not of 32-bit floats" % (path, name))
        names.append(name)
        at += 16
    return names


def read(path):
    """Every channel of a picture by name, as an array of rows."""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = read_header(data, path)
    if attributes["compression"] != b"\0":
        raise ValueError("%s: compressed" % path)
    names = channel_names(attributes["channels"], path)
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    picture = numpy.empty((height, len(names), width), dtype=numpy.float32)
    for offset in struct.unpack_from("<%dQ" % height, data, at):
        (y,) = struct.unpack_from("<i", data, offset)
        row = numpy.frombuffer(data, dtype="<f4", count=len(names) * width, offset=offset + 8)
        picture[y - y0] = row.reshape(len(names), width)
    return {name: picture[:, i] for i, name in enumerate(names)}


def write(path, channels):
    """`channels`: arrays of rows by name, all of one shape."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(name.encode() + b"\0" + struct.pack("<IIii", FLOAT, 0, 1, 1) for name in names) + b"\0"
    header = struct.pack("<II", MAGIC, 2)
    for name, kind, value in (
            ("channels", "chlist", listed), ("compression", "compression", b"\0"), ("dataWindow", "box2i", window),
            ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"),
            ("pixelAspectRatio", "float", struct.pack("<f", 1)),
            ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
            ("screenWindowWidth", "float", struct.pack("<f", 1))):
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value
    header += b"\0"
    row_bytes = 4 * width * len(names)
    first = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header)
        file.write(struct.pack("<%dQ" % height, *(first + y * (8 + row_bytes) for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<ii", y, row_bytes))
            file.write(b"".join(channels[name][y].astype("<f4").tobytes() for name in names))
