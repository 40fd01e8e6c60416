#!/usr/bin/env python3
"""Open the examples of the npm package in headless Chromium: drive_examples.py FOLDER OUTPUT-FOLDER.

FOLDER holds the examples, room.glb, room.olx and node_modules. Each example must draw a picture that is lit, without a message on the
console. Writes pictures into OUTPUT-FOLDER; says every fault and exits with 1.
"""
import os
import sys

import browser
import drive_web

EXAMPLES = ("minimal", "moving", "before-and-after")
# The mean of the canvas, which is drawn once more because its content lasts until the frame ends only.
MEAN = """new Promise((done) => requestAnimationFrame(() => {
  const from = document.querySelector('canvas'), small = new OffscreenCanvas(16, 9), context = small.getContext('2d');
  context.drawImage(from, 0, 0, 16, 9);
  const pixels = context.getImageData(0, 0, 16, 9).data;
  done(pixels.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / (3 * 16 * 9));
}))"""


def show(page, address, name, output):
    page.visit(address + name + ".html")
    page.wait("document.querySelector('canvas') !== null")
    page.wait("(async () => (await %s) > 8)()" % MEAN)
    page.screenshot(os.path.join(output, name + ".png"), full=False)
    print("%s: mean %.1f of 255" % (name, page.value(MEAN)))


def main(folder, output):
    address = drive_web.serve(folder)
    page = browser.Page(320, 180, gpu=drive_web.SWIFTSHADER, server=address)
    try:
        for name in EXAMPLES:
            show(page, address, name, output)
        lit = page.value(MEAN)
        page.value("(() => { const s = document.getElementById('strength'); s.value = 0; s.dispatchEvent(new Event('input')); })()")
        page.settle()
        dark = page.value(MEAN)
        print("before-and-after: mean %.1f with indirect light, %.1f without" % (lit, dark))
        if not dark < 0.97 * lit:
            page.problems.append("the slider changes nothing")
    finally:
        page.close()
        for problem in page.problems:
            print("FAILED:", problem)
    return 1 if page.problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
