"""OpenEXR pictures of one part, in scanlines of 32-bit floats: read plain or ZIP, written plain. No package is needed."""
import itertools
import struct
import zlib

MAGIC, VERSION, LONG_NAMES = 20000630, 2, 0x400
COMPRESSIONS = {b"\0": 1, b"\3": 16}  # none and ZIP: scanlines in a block


def unzip(data, size):
    if len(data) == size:
        return data
    plain = bytes(itertools.accumulate(zlib.decompress(data), lambda before, step: before + step - 128 & 255))
    middle = (size + 1) // 2
    woven = bytearray(size)
    woven[0::2], woven[1::2] = plain[:middle], plain[middle:]
    return bytes(woven)


def read_attributes(data):
    """The attributes by name, and where the table of blocks begins."""
    at, attributes = 8, {}
    while data[at]:
        name_end = data.index(0, at)
        kind_end = data.index(0, name_end + 1)
        size = struct.unpack_from("<I", data, kind_end + 1)[0]
        attributes[data[at:name_end].decode()] = data[kind_end + 5:kind_end + 5 + size]
        at = kind_end + 5 + size
    return attributes, at + 1


def channel_names(channels):
    names, at = [], 0
    while channels[at]:
        end = channels.index(0, at)
        assert struct.unpack_from("<I", channels, end + 1)[0] == 2, "not a 32-bit float"
        names.append(channels[at:end].decode())
        at = end + 17
    return names


def read(path):
    """Width, height, and the values of each channel by its name, rows from the top down."""
    with open(path, "rb") as file:
        data = file.read()
    magic, version = struct.unpack_from("<II", data)
    assert (magic, version & ~LONG_NAMES) == (MAGIC, VERSION), "not a plain EXR"
    attributes, table = read_attributes(data)
    low_x, low_y, high_x, high_y = struct.unpack("<4i", attributes["dataWindow"])
    assert (low_x, low_y) == (0, 0)
    width, height, block_lines = high_x + 1, high_y + 1, COMPRESSIONS[attributes["compression"]]
    names = channel_names(attributes["channels"])
    picture = {name: [] for name in names}
    for offset in struct.unpack_from("<%dQ" % -(-height // block_lines), data, table):
        first, size = struct.unpack_from("<ii", data, offset)
        lines = min(block_lines, height - first)
        block = unzip(data[offset + 8:offset + 8 + size], lines * width * 4 * len(names))
        values = struct.unpack("<%df" % (len(block) // 4), block)
        for i in range(lines * len(names)):
            picture[names[i % len(names)]] += values[i * width:(i + 1) * width]
    return width, height, picture


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def write(path, width, height, picture):
    """Writes the values of each channel by its name, rows from the top down."""
    names = sorted(picture)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", MAGIC, VERSION) + attribute("channels", "chlist", channels)
    header += attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", window)
    header += attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    line_bytes = 4 * width * len(names)
    first = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header + struct.pack("<%dQ" % height, *(first + y * (8 + line_bytes) for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<ii", y, line_bytes))
            for name in names:
                file.write(struct.pack("<%df" % width, *picture[name][y * width:(y + 1) * width]))
