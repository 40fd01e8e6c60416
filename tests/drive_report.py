#!/usr/bin/env python3
"""Use a report as a person would, in headless Chromium: drive_report.py KNOWN.html LAYERS.html NORMAL.html DEPTH.html
[SCREENSHOT-FOLDER].

KNOWN.html compares the pictures of perceptual_reference.py, LAYERS.html has several layers,
the others one that has no FLIP. Says every fault and exits with 1.
"""
import os
import sys

import browser
import perceptual_reference as images

faults = []


def check(good, what):
    if not good:
        faults.append(what)
        print("FAILED:", what)


STAGE = "document.querySelector('.pane.stage')"
DIVIDER = "document.querySelector('.divider')"


def rectangle(page, expression):
    return page.value("(() => { const r = %s.getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; })()" % expression)


def middle(page, expression):
    x, y, width, height = rectangle(page, expression)
    return x + width / 2, y + height / 2


def pixel_under(page, expression):
    """Which pixel of the picture the middle of a pane shows, by what the page says of it."""
    page.mouse("mouseMoved", *middle(page, expression))
    page.settle()
    return page.value("document.querySelector('.readout b')?.textContent")


def color_at(page, expression, x, y):
    """What the canvas of a pane shows of pixel (x, y) when all of the picture is fitted into it."""
    return page.value("""(() => {
      const canvas = %s.querySelector('canvas'), w = canvas.width, h = canvas.height;
      const scale = Math.min(w / %d, h / %d);
      const at = (i, n, length) => Math.floor(length / 2 + (i + 0.5 - n / 2) * scale);
      const one = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
      one.drawImage(canvas, -at(%d, %d, w), -at(%d, %d, h));
      return [...one.getImageData(0, 0, 1, 1).data.slice(0, 3)];
    })()""" % (expression, images.WIDTH, images.HEIGHT, x, images.WIDTH, y, images.HEIGHT))


def expected_color(x, y, second, stops=0):
    return [round(255 * images.tone_map(light * 2**stops)) for light in images.pixel(x, y, second)]


def near(a, b):
    return all(abs(p - q) <= 2 for p, q in zip(a, b))


def check_pictures(page, stops):
    """Left of the divider the image, right of it the reference."""
    for x, y in ((3, 3), (10, 12), (15, 30), (20, 9)):
        shown, wanted = color_at(page, STAGE, x, y), expected_color(x, y, False, stops)
        check(near(shown, wanted), f"the image at {x}, {y}, {stops} stops: {shown} is not {wanted}")
    for x, y in ((26, 4), (30, 20), (40, 30), (44, 12)):
        shown, wanted = color_at(page, STAGE, x, y), expected_color(x, y, True, stops)
        check(near(shown, wanted), f"the reference at {x}, {y}, {stops} stops: {shown} is not {wanted}")


def check_divider(page):
    value = lambda: int(page.value(DIVIDER + ".getAttribute('aria-valuenow')"))
    x, y, width, height = rectangle(page, STAGE)
    check(value() == 50, "the divider begins in the middle")
    page.drag(x + width / 2, y + height / 2, x + 0.8 * width, y + height / 2)
    check(abs(value() - 80) <= 1, f"dragged to 80 %, the divider is at {value()}")
    check(near(color_at(page, STAGE, 30, 20), expected_color(30, 20, False)), "left of the divider is the image")
    page.key("ArrowLeft")
    check(abs(value() - 78) <= 1, f"an arrow moves the divider: {value()}")
    page.key(" ")
    check(value() == 0, "the space bar shows the other picture")
    check(near(color_at(page, STAGE, 3, 3), expected_color(3, 3, True)), "right of the divider is the reference")
    page.key(" ")
    check(value() == 100, "the space bar flips back")
    page.drag(x + width / 3, y + height / 2, x + width / 2, y + height / 2)


def check_zoom(page):
    panes = ["document.querySelectorAll('.pane')[%d]" % i for i in range(page.value("document.querySelectorAll('.pane').length"))]
    check(len(panes) == 3, f"{len(panes)} panes")
    x, y, width, height = rectangle(page, STAGE)
    for _ in range(4):
        page.wheel(x + 0.7 * width, y + 0.3 * height, -200)
    check(page.value("document.getElementById('zoom').textContent") != "fit", "the wheel zooms a picture with the focus")
    under = [pixel_under(page, pane) for pane in panes]
    check(len(set(under)) == 1 and under[0] != "22, 17", f"zoomed, the panes show {under}")
    for _ in range(3):
        page.key("ArrowDown", shift=True)
    below = [pixel_under(page, pane) for pane in panes]
    check(len(set(below)) == 1 and below[0] != under[0], f"panned, the panes show {below}")
    mx, my = middle(page, panes[1])
    page.drag(mx, my, mx + 60, my)
    beside = [pixel_under(page, pane) for pane in panes]
    check(len(set(beside)) == 1 and beside[0] != below[0], f"dragged, the panes show {beside}")
    page.click("#exact")
    check(page.value("document.getElementById('zoom').textContent").startswith("\u00d7"), "one to one")
    page.click("#fit")
    check(page.value("document.getElementById('zoom').textContent") == "fit", "fit fits")
    fitted = {pixel_under(page, pane) for pane in panes}
    check(fitted <= {"22, 16", "22, 17"}, f"fitted, the middle is {fitted}")  # 34 rows: between two
    page.wheel(640, 20, 300)
    page.value("window.scrollTo(0, 0)")
    check(page.value("document.getElementById('zoom').textContent") == "fit", "the wheel elsewhere scrolls")


def check_exposure(page):
    page.value(DIVIDER + ".focus()")
    for _ in range(3):
        page.key("]")
    check("1.5" in page.value("document.getElementById('stops').textContent"), "the exposure is told")
    check_pictures(page, 1.5)
    page.click("#unexpose")
    check_pictures(page, 0)


def check_known(page, path):
    page.open(path)
    page.wait("document.querySelector('.viewer').dataset.ready")
    page.settle()
    check_pictures(page, 0)
    check_divider(page)
    check_zoom(page)
    check_exposure(page)


def column(page, index):
    return page.value("[...document.querySelectorAll('tbody tr')].map((row) => Number(row.cells[%d].title))" % index)


def check_layers(page, path):
    page.open(path)
    page.wait("document.querySelector('.viewer').dataset.ready === 'beauty'")
    before = page.value(STAGE + ".querySelector('canvas').toDataURL()")
    page.value("document.querySelector('[role=tab]').focus()")
    page.key("ArrowRight")
    page.wait("document.querySelector('.viewer').dataset.ready === 'direct'")
    page.settle()
    check(page.value("document.activeElement.textContent") == "direct", "an arrow moves to the next tab")
    check(page.value(STAGE + ".querySelector('canvas').toDataURL()") != before, "another tab shows another picture")
    page.click("th:nth-child(2) button")
    check(column(page, 1) == sorted(column(page, 1)), "a table sorts")
    page.click("th:nth-child(2) button")
    check(column(page, 1) == sorted(column(page, 1), reverse=True), "and the other way round")
    check(page.value("document.querySelectorAll('th[aria-sort=descending]').length") == 1, "and says so")
    check(page.value("document.querySelectorAll('svg').length") == 3, "three plots")


def check_looks(page, path, folder):
    light = lambda: page.value("getComputedStyle(document.documentElement).backgroundColor.match(/\\d+/g).map(Number)[0] > 127")
    for width, height in ((1280, 800), (1920, 1080)):
        for scheme in ("light", "dark"):
            page.resize(width, height)
            page.prefer(scheme)
            page.open(path)
            page.wait("document.querySelector('.viewer').dataset.ready")
            page.settle()
            check(light() == (scheme == "light"), f"{scheme} where that is preferred")
            check(page.value("document.documentElement.scrollWidth <= innerWidth"), f"wider than {width} pixels")
            x, y, w, h = rectangle(page, STAGE)
            check(w > 0.55 * width and h > 0.4 * height, f"the stage is {w} x {h} at {width}")
            if folder:
                page.resize(width, page.value("document.documentElement.scrollHeight"))
                page.screenshot(os.path.join(folder, f"report-{width}-{scheme}.png"), full=False)
    page.click("#theme")
    check(light(), "the button makes it light")
    page.click("#theme")
    check(not light(), "and dark")
    page.resize(600, 900)
    page.settle()
    check(page.value("document.documentElement.scrollWidth <= innerWidth"), "wider than a small window")


def main():
    page = browser.Page()
    try:
        check_known(page, sys.argv[1])
        check_layers(page, sys.argv[2])
        for path in sys.argv[3:5]:
            page.open(path)
            page.wait("document.querySelector('.viewer').dataset.ready")
            page.settle()
            check(page.value("document.querySelectorAll('.pane').length") == 2, f"{path}: a stage and one map")
            check(page.value("document.querySelector('td:nth-child(2)').textContent") == "\u2013", f"{path}: no FLIP")
        check_looks(page, sys.argv[2], sys.argv[5] if len(sys.argv) > 5 else None)
        for problem in page.problems:
            check(False, problem)
    finally:
        page.close()
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
