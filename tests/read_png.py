#!/usr/bin/env python3
"""Look at 8-bit RGB .png files.

read_png.py EXPRESSION FILE...: 0 when the Python expression is true, 1 when not. In it, `p` is a list of the pictures;
of each, p[i].width, p[i].height, p[i].rgb (bytes); uniform(a), mean(a) of all bytes, 0 to 255, and differing(a, b), the
share of bytes that are more than 8 apart.
"""

import struct
import sys
import types
import zlib


def unfilter(data, width, height):
    stride, rows, last = 3 * width, [], bytearray(3 * width)
    for y in range(height):
        kind, line = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - 3] if i >= 3 else 0
            up, corner = last[i], last[i - 3] if i >= 3 else 0
            if kind == 1:
                line[i] = (line[i] + left) & 255
            elif kind == 2:
                line[i] = (line[i] + up) & 255
            elif kind == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif kind == 4:
                guess = left + up - corner
                a, b, c = abs(guess - left), abs(guess - up), abs(guess - corner)
                line[i] = (line[i] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
        rows.append(bytes(line))
        last = line
    return b"".join(rows)


def read(path):
    data = open(path, "rb").read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        sys.exit(f"{path}: not a .png")
    at, packed, header = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if zlib.crc32(kind + body) != struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0]:
            sys.exit(f"{path}: a chunk's checksum is wrong")
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    width, height = header[:2]
    if header[2:] != (8, 2, 0, 0, 0):
        sys.exit(f"{path}: not 8-bit RGB")
    return types.SimpleNamespace(width=width, height=height, rgb=unfilter(zlib.decompress(packed), width, height))


def uniform(a):
    return a.rgb == a.rgb[:3] * (a.width * a.height)


def mean(a):
    return sum(a.rgb) / len(a.rgb)


def differing(a, b):
    return sum(abs(x - y) > 8 for x, y in zip(a.rgb, b.rgb)) / len(a.rgb)


def main():
    names = {"p": [read(path) for path in sys.argv[2:]], "uniform": uniform, "mean": mean, "differing": differing}
    return 0 if eval(sys.argv[1], names) else 1


if __name__ == "__main__":
    sys.exit(main())
