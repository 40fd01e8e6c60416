#!/usr/bin/env python3
"""Compare what a page draws with `octalux render --centered`: compare_web.py PAGE.exr RENDER.exr --most-error E [--most-elsewhere S].

Says the relative mean squared error of each layer of indirect light over the pixels in which both met the same surface,
by its depth and its normal, and the share of pixels in which they did not. Exits with 1 where either is too large.
"""
import argparse
import math
import os
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import exr_picture  # noqa: E402

DEPTH = 1e-4  # largest difference of depths, relative
COSINE = 0.999  # least cosine between the normals
LAYERS = ["indirect_diffuse", "indirect_glossy"]


def layer(picture, name, channels="RGB"):
    return list(zip(*(picture["%s.%s" % (name, channel)] for channel in channels)))


def same_surfaces(page, render):
    """For each pixel, whether both met the same surface, or none."""
    def same(page_depth, page_normal, depth, normal):
        if math.isinf(depth):
            return page_normal == (0, 0, 0)
        return abs(page_depth - depth) <= DEPTH * depth and sum(a * b for a, b in zip(page_normal, normal)) >= COSINE

    return list(map(same, page["depth.Z"], layer(page, "normal", "XYZ"), render["depth.Z"], layer(render, "normal", "XYZ")))


def relative_error(page, render, counted):
    difference = square = 0.0
    for p, r, here in zip(page, render, counted):
        if here:
            difference += sum((a - b) ** 2 for a, b in zip(p, r))
            square += sum(b * b for b in r)
    return difference / square


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page")
    parser.add_argument("render")
    parser.add_argument("--most-error", type=float, required=True, help="of each layer")
    parser.add_argument("--most-elsewhere", type=float, default=0.005, help="share of pixels with different surfaces")
    options = parser.parse_args()
    (width, height, page), (*size, render) = exr_picture.read(options.page), exr_picture.read(options.render)
    assert [width, height] == size, "sizes differ"
    same = same_surfaces(page, render)
    elsewhere = same.count(False) / len(same)
    good = elsewhere <= options.most_elsewhere
    print("other surfaces: %d of %d pixels" % (same.count(False), len(same)))
    for name in LAYERS:
        if name + ".R" not in page:
            continue
        error, everywhere = (relative_error(layer(page, name), layer(render, name), where) for where in (same, [True] * len(same)))
        print("%s: relative MSE %.2g on the same surfaces, %.2g everywhere" % (name, error, everywhere))
        good = good and error <= options.most_error and math.isfinite(everywhere)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
