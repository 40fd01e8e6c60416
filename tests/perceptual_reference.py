#!/usr/bin/env python3
"""SSIM and LDR-FLIP straight from their papers, as slow as that is: two-dimensional sums, double precision, no library.

    perceptual_reference.py make FOLDER            write a.exr and b.exr, which differ in every way the metrics look for
    perceptual_reference.py EXPOSURE PPD           print {"ssim": ..., "flip": ...} of that pair, tone mapped
"""
import json
import math
import os
import struct
import sys

WIDTH, HEIGHT = 45, 34


def pixel(x, y, b):
    """A ramp of light, hues across it, a bright square, lines; b is darker in one corner, shifted, tinted and noisy."""
    shift = 2 if b else 0
    light = 0.02 + 1.4 * (y / HEIGHT) ** 2
    hue = [0.5 + 0.5 * math.cos(6.0 * x / WIDTH + k) for k in (0.0, 2.1, 4.2)]
    color = [light * (0.2 + h) for h in hue]
    if 8 <= x - shift < 18 and 6 <= y < 16:
        color = [3.0, 2.5, 1.0]
    if (x + shift) % 9 == 4 and y > 18:
        color = [0.01, 0.02, 0.3]
    if b:
        noise = (x * 7919 + y * 104729 + x * y * 31) % 101 / 101.0 - 0.5
        color = [c * (1.0 + 0.3 * noise) for c in color]
        color[0] *= 1.1
        if x > 34 and y > 24:
            color = [0.6 * c for c in color]
    return color


def write_exr(path, b):
    rows = [[pixel(x, y, b) for x in range(WIDTH)] for y in range(HEIGHT)]

    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data

    channels = b"".join(n + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for n in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<iiii", 0, 0, WIDTH - 1, HEIGHT - 1)
    header = struct.pack("<ii", 20000630, 2) + attribute("channels", "chlist", channels)
    header += attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", window)
    header += attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)) + b"\0"
    line = 8 + 12 * WIDTH
    first = len(header) + 8 * HEIGHT
    with open(path, "wb") as file:
        file.write(header + b"".join(struct.pack("<q", first + y * line) for y in range(HEIGHT)))
        for y, row in enumerate(rows):
            planes = b"".join(struct.pack("<%df" % WIDTH, *[p[k] for p in row]) for k in (2, 1, 0))
            file.write(struct.pack("<ii", y, len(planes)) + planes)


def tone_map(light):
    """The picture's sRGB value, 0..1 in steps of 1/255 (docs/comparing.md)."""
    light = struct.unpack("<f", struct.pack("<f", light))[0]
    mapped = light if light <= 0.6 else 0.6 + 0.4 * (1.0 - math.exp((0.6 - light) / 0.4))
    encoded = 12.92 * mapped if mapped <= 0.0031308 else 1.055 * mapped ** (1 / 2.4) - 0.055
    return math.floor(255.0 * encoded + 0.5) / 255.0


def grid(function):
    return [[function(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


def ssim(a, b):
    """Wang, Bovik, Sheikh, Simoncelli 2004, section III.B."""
    weights = {(i, j): math.exp(-(i * i + j * j) / 4.5) for i in range(-5, 6) for j in range(-5, 6)}
    total = sum(weights.values())
    luma = lambda picture: grid(lambda x, y: sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), picture[y][x])))
    a, b = luma(a), luma(b)
    c1, c2, result = 0.01**2, 0.03**2, []
    for y in range(5, HEIGHT - 5):
        for x in range(5, WIDTH - 5):
            window = [(w / total, a[y + j][x + i], b[y + j][x + i]) for (i, j), w in weights.items()]
            ma, mb = sum(w * p for w, p, q in window), sum(w * q for w, p, q in window)
            va = sum(w * (p - ma) ** 2 for w, p, q in window)
            vb = sum(w * (q - mb) ** 2 for w, p, q in window)
            vab = sum(w * (p - ma) * (q - mb) for w, p, q in window)
            result.append((2 * ma * mb + c1) * (2 * vab + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2)))
    return sum(result) / len(result)


def solve(matrix, right):
    """Cramer's rule."""
    det = lambda m: sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))
    replaced = lambda k: [[right[r] if c == k else matrix[r][c] for c in range(3)] for r in range(3)]
    return [det(replaced(k)) / det(matrix) for k in range(3)]


def chromaticity(x, y):
    return [x / y, 1.0, (1 - x - y) / y]


PRIMARIES = [chromaticity(0.64, 0.33), chromaticity(0.30, 0.60), chromaticity(0.15, 0.06)]  # Rec.709
WHITE = chromaticity(0.3127, 0.3290)  # D65
SCALES = solve([[PRIMARIES[c][r] for c in range(3)] for r in range(3)], WHITE)
TO_XYZ = [[PRIMARIES[c][r] * SCALES[c] for c in range(3)] for r in range(3)]


def linear_to_xyz(color):
    return [sum(TO_XYZ[r][c] * color[c] for c in range(3)) for r in range(3)]


def srgb_to_linear(v):
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def ycxcz(color):
    x, y, z = [v / w for v, w in zip(linear_to_xyz([srgb_to_linear(v) for v in color]), WHITE)]
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def hunt_lab(linear):
    f = lambda t: t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    x, y, z = [f(v / w) for v, w in zip(linear_to_xyz(linear), WHITE)]
    lightness = 116 * y - 16
    return lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)


def hyab(a, b):
    return abs(a[0] - b[0]) + math.hypot(a[1] - b[1], a[2] - b[2])


def convolve(plane, kernel, radius):
    """Beyond the border pixels repeat."""
    rows = [[row[min(max(x, 0), WIDTH - 1)] for x in range(-radius, WIDTH + radius)] for row in plane]
    rows = [rows[min(max(y, 0), HEIGHT - 1)] for y in range(-radius, HEIGHT + radius)]
    size = 2 * radius + 1
    return grid(lambda x, y: sum(k * v for j in range(size) for k, v in zip(kernel[j], rows[y + j][x:x + size])))


def kernel(radius, function):
    """function(i, j) with positive weights scaled to the sum 1 and negative ones to -1."""
    values = [[function(i, j) for i in range(-radius, radius + 1)] for j in range(-radius, radius + 1)]
    positive = sum(v for row in values for v in row if v > 0)
    negative = -sum(v for row in values for v in row if v < 0) or 1.0
    return [[v / (positive if v > 0 else negative) for v in row] for row in values]


CSF = [((1.0, 0.0047), (0.0, 1e-5)), ((1.0, 0.0053), (0.0, 1e-5)), ((34.1, 0.04), (13.5, 0.025))]


def seen_color(picture, ppd):
    """Section 4.1.1 and 4.1.2: what is left of the colours at this distance, in Hunt-adjusted L*a*b*."""
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi**2)) * ppd)
    opponent = grid(lambda x, y: ycxcz(picture[y][x]))
    planes = []
    for channel, terms in enumerate(CSF):
        def contrast(i, j):
            z = (i * i + j * j) / ppd**2
            return sum(a * math.sqrt(math.pi / b) * math.exp(-math.pi**2 * z / b) for a, b in terms)
        planes.append(convolve(grid(lambda x, y: opponent[y][x][channel]), kernel(radius, contrast), radius))

    def color(x, y):
        luminance = (planes[0][y][x] + 16) / 116
        xyz = [planes[1][y][x] / 500 + luminance, luminance, luminance - planes[2][y][x] / 200]
        linear = solve(TO_XYZ, [v * w for v, w in zip(xyz, WHITE)])
        return hunt_lab([min(max(v, 0.0), 1.0) for v in linear])
    return grid(color)


def features(picture, ppd):
    """Section 4.2: strengths of edges and of points."""
    sigma = 0.5 * 0.082 * ppd
    radius = math.ceil(3 * sigma)
    lightness = grid(lambda x, y: (ycxcz(picture[y][x])[0] + 16) / 116)
    bell = lambda i, j: math.exp(-(i * i + j * j) / (2 * sigma**2))
    strengths = []
    for slope in (lambda i, j: -i * bell(i, j), lambda i, j: (i * i / sigma**2 - 1) * bell(i, j)):
        across = convolve(lightness, kernel(radius, slope), radius)
        down = convolve(lightness, kernel(radius, lambda i, j: slope(j, i)), radius)
        strengths.append(grid(lambda x, y: math.hypot(across[y][x], down[y][x])))
    return strengths


def flip(a, b, ppd):
    largest = hyab(hunt_lab([0, 1, 0]), hunt_lab([0, 0, 1])) ** 0.7
    ca, cb = seen_color(a, ppd), seen_color(b, ppd)
    (ea, pa), (eb, pb) = features(a, ppd), features(b, ppd)
    sum_ = 0.0
    for y in range(HEIGHT):
        for x in range(WIDTH):
            d, knee = hyab(ca[y][x], cb[y][x]) ** 0.7, 0.4 * largest
            color = d * 0.95 / knee if d < knee else 0.95 + (d - knee) / (largest - knee) * 0.05
            feature = max(abs(ea[y][x] - eb[y][x]), abs(pa[y][x] - pb[y][x]))
            sum_ += color ** (1 - (feature / math.sqrt(2)) ** 0.5)
    return sum_ / (WIDTH * HEIGHT)


def main():
    if sys.argv[1] == "make":
        write_exr(os.path.join(sys.argv[2], "a.exr"), False)
        write_exr(os.path.join(sys.argv[2], "b.exr"), True)
        return
    exposure, ppd = float(sys.argv[1]), float(sys.argv[2])
    a, b = [grid(lambda x, y: [tone_map(exposure * v) for v in pixel(x, y, second)]) for second in (False, True)]
    print(json.dumps({"ssim": ssim(a, b), "flip": flip(a, b, ppd)}))


if __name__ == "__main__":
    main()
