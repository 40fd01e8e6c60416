"""The report of `octalux-bench all` in headless Chromium: contents, pictures of every experiment, tables, looks. Prints what is wrong.

    drive_site.py index.html found.json [FOLDER for screenshots]
"""
import json
import os
import sys

import browser

faults = []


def check(holds, text):
    if not holds:
        faults.append(text)
        print("FAILED: " + text)


def section(name):
    return "document.getElementById(%s)" % json.dumps(name)


def show(page, name):
    page.value(section(name) + ".scrollIntoView()")
    page.settle()
    viewers = page.value(section(name) + ".querySelectorAll('.viewer').length")
    if viewers:
        page.wait(section(name) + ".querySelector('.viewer').dataset.ready")
    page.settle()
    return viewers


def check_contents(page, found):
    names = [e["experiment"] for e in found["experiments"]]
    check(page.value("[...document.querySelectorAll('#contents a b')].map((b) => b.textContent)") == names, "the contents name every experiment")
    page.click("#contents a:nth-child(%d)" % len(names))
    page.wait("location.hash === %s" % json.dumps("#" + names[-1]))
    for e in found["experiments"]:
        own = section(e["experiment"])
        check(page.value(own + ".querySelector('code').textContent") == e["command"], f"{e['experiment']}: its command")
        tables = [t for t in e["tables"] if t["rows"]]
        rows = page.value(f"[...{own}.querySelectorAll('table')].map((t) => t.tBodies[0].rows.length)")
        check(rows == [len(t["rows"]) for t in tables], f"{e['experiment']}: rows {rows}")
        left_out = page.value(own + ".querySelectorAll('.skipped li').length")
        check(left_out == len(e["skipped"]), f"{e['experiment']}: {left_out} left out")


def check_numbers(page, found):
    """What cells hold is what --json prints; they sort."""
    for e in found["experiments"]:
        for i, table in enumerate(t for t in e["tables"] if t["rows"]):
            keys = [c["key"] for c in table["columns"]]
            cells = page.value(f"[...{section(e['experiment'])}.querySelectorAll('table')[{i}].tBodies[0].rows].map((r) => "
                               "[...r.cells].map((c) => c.classList.contains('text') ? c.textContent : c.title))")
            for row, shown in zip(table["rows"], cells):
                for key, text in zip(keys, shown):
                    value = row[key]
                    same = text == value if isinstance(value, str) else text == "not a finite number" if value is None else float(text) == value
                    check(same, f"{e['experiment']}, {key}: {text} is not {value}")
    name = found["experiments"][0]["experiment"]
    page.value(section(name) + ".querySelector('th:nth-child(4) button').click()")
    column = page.value(f"[...{section(name)}.querySelectorAll('tbody tr')].map((r) => Number(r.cells[3].title))")
    check(column == sorted(column), f"{name}: sorted by a column, {column}")


def check_pictures(page, name):
    """A small picture brings itself and its maps to the stage; all panes zoom together."""
    own = section(name)
    show(page, name)
    thumbs = page.value(own + ".querySelectorAll('.strip .pane').length")
    check(thumbs > 2, f"{name}: {thumbs} small pictures")
    chips = lambda: page.value(f"[...{own}.querySelectorAll('.panes .pane:not(.stage) .chip')].map((c) => c.textContent)")
    before = chips()
    page.value(own + ".querySelector('.strip').scrollIntoView({block: 'center'})")
    page.settle()
    x, y = page.value(f"(() => {{ const r = {own}.querySelector('.strip .pane:nth-child(3)').getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; }})()")
    page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    page.mouse("mouseReleased", x, y, button="left", clickCount=1)
    page.settle()
    third = page.value(own + ".querySelector('.strip .pane:nth-child(3) .chip').textContent")
    check(page.value(own + ".querySelector('select').selectedOptions[0].textContent") == third, f"{name}: a click shows {third}")
    check(chips() != before and all(third in chip for chip in chips()), f"{name}: maps are {chips()}")
    shown = "[...document.querySelectorAll('.pane canvas')].filter((c) => c.width > 1).map((c) => c.toDataURL().length)"
    unzoomed = page.value(shown)
    page.click("#larger")
    page.click("#larger")
    check(sum(a != b for a, b in zip(unzoomed, page.value(shown))) > len(unzoomed) / 2, "pictures of all sections zoom together")
    page.click("#fit")


def check_looks(page, path, folder, names):
    for width, height, scheme in ((1280, 800, "light"), (1920, 1080, "dark")):
        page.resize(width, height)
        page.prefer(scheme)
        page.open(path)
        light = page.value("getComputedStyle(document.documentElement).backgroundColor.match(/\\d+/g).map(Number)[0] > 127")
        check(light == (scheme == "light"), f"{scheme} where that is preferred")
        check(page.value("document.documentElement.scrollWidth <= innerWidth"), f"wider than {width} pixels")
        check(page.value("document.getElementById('contents').getBoundingClientRect().right <= document.getElementById('sections').getBoundingClientRect().left"),
              "contents beside the sections")
        for name in names if folder else []:
            show(page, name)
            page.screenshot(os.path.join(folder, f"site-{width}-{scheme}-{name}.png"), full=False)
    page.resize(700, 900)
    page.settle()
    check(page.value("document.documentElement.scrollWidth <= innerWidth"), "wider than a small window")


def main():
    path, found = sys.argv[1], json.load(open(sys.argv[2]))
    page = browser.Page()
    try:
        page.open(path)
        page.wait("document.querySelector('.viewer').dataset.ready")
        check_contents(page, found)
        check_numbers(page, found)
        with_pictures = [e["experiment"] for e in found["experiments"] if show(page, e["experiment"])]
        check(len(with_pictures) >= 5, f"pictures of {with_pictures}")
        check_pictures(page, "mcguire-leaks")
        check_looks(page, path, sys.argv[3] if len(sys.argv) > 3 else None, [e["experiment"] for e in found["experiments"]])
        for problem in page.problems:
            check(False, problem)
    finally:
        page.close()
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
