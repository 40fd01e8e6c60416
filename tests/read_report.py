#!/usr/bin/env python3
"""Check a report of `octalux compare` against what --json printed: read_report.py REPORT.html JSON COMMAND-LINE EXPOSURE.

One well-formed HTML file that asks for nothing outside itself, whose pictures are the images and whose numbers are those
of --json.
"""
import base64
import html.parser
import json
import math
import re
import struct
import sys
import xml.dom.minidom
import zlib

import perceptual_reference as images

VOID = {"meta", "input", "br", "img", "link", "hr"}


class Reader(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.texts, self.scripts = [], {}, {}

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            assert name not in ("src", "href", "srcset", "action"), f"<{tag}> refers to {value}"
            assert not name.startswith("on"), f"<{tag}> has a handler {name}"
        if tag not in VOID:
            self.open.append((tag, dict(attributes).get("id")))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1][0] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, text):
        if self.open:
            self.texts[self.open[-1]] = self.texts.get(self.open[-1], "") + text


def decode_png(text):
    data, position, header, packed = base64.b64decode(text, validate=True), 8, None, b""
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position:position + 8])
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", data[position + 8:position + 21])
        if kind == b"IDAT":
            packed += data[position + 8:position + 8 + length]
        position += 12 + length
    width, height, channels, raw = header[0], header[1], {0: 1, 2: 3}[header[3]], zlib.decompress(packed)
    stride, rows = width * channels, []
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        above = rows[-1] if rows else bytes(stride)
        for i in range(stride):
            left, up, corner = (line[i - channels], above[i], above[i - channels]) if i >= channels else (0, above[i], 0)
            p = left + up - corner
            nearest = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        rows.append(bytes(line))
    return width, height, channels, rows


def check_picture(picture, second, exposure):
    width, height, channels, rows = decode_png(picture["png"])
    assert (width, height, channels) == (images.WIDTH, 2 * images.HEIGHT, 3)
    for y in range(images.HEIGHT):
        for x in range(images.WIDTH):
            for k, light in enumerate(images.pixel(x, y, second)):
                half = bytes([rows[y + images.HEIGHT][3 * x + k], rows[y][3 * x + k]])
                value = struct.unpack("<e", half)[0]
                assert abs(value - exposure * light) <= abs(exposure * light) / 256, f"pixel {x}, {y}: {value} is not {light}"


def check_maps(maps, numbers):
    """FLIP's mean, and the squared error over the reference's mean square."""
    flip = decode_png(maps[0]["png"])[3]
    values = [v / 255 for row in flip for v in row]
    assert maps[0]["name"] == "FLIP" and abs(sum(values) / len(values) - numbers["flip"]) < 0.5 / 255
    scale, levels = maps[1], decode_png(maps[1]["png"])[3]
    assert scale["logarithmic"]
    pairs = [[(images.pixel(x, y, False), images.pixel(x, y, True)) for x in range(images.WIDTH)] for y in range(images.HEIGHT)]
    mean_square = sum(c * c for row in pairs for _, b in row for c in b) / (3 * images.WIDTH * images.HEIGHT)
    for row, stored in zip(pairs, levels):
        for (a, b), level in zip(row, stored):
            error = sum((p - q) ** 2 for p, q in zip(a, b)) / 3 / mean_square
            share = math.log(max(error, 1e-30) / scale["low"]) / math.log(scale["high"] / scale["low"])
            assert abs(255 * min(max(share, 0), 1) - level) < 0.51, f"{level} is not {255 * share}"


def main():
    page, printed, command = open(sys.argv[1], encoding="utf-8").read(), json.load(open(sys.argv[2])), sys.argv[3]
    exposure = float(sys.argv[4])
    assert not re.search(r"https?:|url\(|@import|\b(fetch|XMLHttpRequest|WebSocket|importScripts|eval)\b", page), "a way out"
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert not reader.open, f"never closed: {reader.open}"
    data = json.loads(reader.texts["script", "data"])
    assert reader.texts["title", None] == data["title"], reader.texts["title", None]
    assert data["command"] == command, data["command"]
    assert re.fullmatch(r"\d+\.\d+\.\d+", data["version"])
    assert len(base64.b64decode(data["palette"])) == 768

    frames = [frame for section in data["sections"] for frame in section.get("frames", [])]
    table = [table for section in data["sections"] for table in section.get("tables", [])][0]
    assert [f["name"] for f in frames] == [row[0] for row in table["rows"]] == [name.replace("_", " ") for name in printed["layers"]]
    keys = ["flip", "ssim", "mse", "relative_mse", "psnr", "bias", "max"]
    for row, numbers in zip(table["rows"], printed["layers"].values()):
        assert row[1:] == [numbers[key] for key in keys], f"{row} is not {numbers}"
        assert len(table["columns"]) == len(row)
    for frame, numbers in zip(frames, printed["layers"].values()):
        assert (frame["width"], frame["height"]) == (images.WIDTH, images.HEIGHT)
        for second, picture in enumerate(frame["pictures"]):
            check_picture(picture, bool(second), exposure)
        check_maps(frame["maps"], numbers)
        assert {f["name"]: f["value"] for f in frame["facts"]}["FLIP"] == numbers["flip"]
    plots = [plot for section in data["sections"] for plot in section.get("plots", [])]
    assert len(plots) == 3
    for plot in plots:
        svg = xml.dom.minidom.parseString(plot["svg"]).documentElement
        assert svg.tagName == "svg" and not svg.getElementsByTagName("script")
        for number in re.findall(r'[xydwh\d]="([^"]*)"', plot["svg"]):
            assert "nan" not in number and "inf" not in number, number


if __name__ == "__main__":
    main()
