#!/usr/bin/env python3
"""Use an exported page as a person would, in headless Chromium: drive_web.py FOLDER [OUTPUT-FOLDER] [options].

Serves FOLDER on this machine, waits for diffuse and glossy light, uses every tool, and writes into OUTPUT-FOLDER what it looked like,
page.exr with surfaces and their indirect light at 640x360, and times.json. Says every fault and exits with 1.
"""
import argparse
import base64
import functools
import http.server
import json
import os
import struct
import sys
import threading

import browser
import read_png
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import exr_picture  # noqa: E402

SWIFTSHADER = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
WIDTH, HEIGHT = 640, 360
SAMPLES = 4  # glossy rays a pixel, the default of `octalux render`
MOST_UNRESOLVED = 0.01  # share of reflected rays
BLOCKS = ["WEBGL_compressed_texture_s3tc", "EXT_texture_compression_rgtc", "EXT_texture_compression_bptc"]
faults = []


def check(good, what):
    if not good:
        faults.append(what)
        print("FAILED:", what)


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def serve(folder):
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return "http://127.0.0.1:%d/" % server.server_port


# ---- Pictures


def read_layer(page, layer, samples):
    data = base64.b64decode(page.value("octalux.readLayer('%s', %d, %d, %d)" % (layer, WIDTH, HEIGHT, samples)))
    return struct.unpack("<%df" % (len(data) // 4), data)


def channels_of(name, values, channels="RGB"):
    """Channels by name, rows from the top down, of RGBA from the bottom up."""
    def upright(plane):
        return [value for y in reversed(range(HEIGHT)) for value in plane[y * WIDTH:(y + 1) * WIDTH]]

    return {"%s.%s" % (name, channel): upright(values[i::4]) for i, channel in enumerate(channels)}


def brightness(path):
    """Of a picture, 0 to 255."""
    return read_png.mean(read_png.read(path))


# ---- The page


def processor_seconds(root):
    """Of a process and all below it."""
    parents, ticks = {}, {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open("/proc/%s/stat" % name, encoding="utf-8", errors="replace") as file:
                words = file.read().rsplit(")", 1)[1].split()
        except OSError:  # the process has ended
            continue
        parents[int(name)], ticks[int(name)] = int(words[1]), int(words[11]) + int(words[12])

    def below(process):
        while process in parents and process != root:
            process = parents[process]
        return process == root

    return sum(ticks[process] for process in ticks if below(process)) / os.sysconf("SC_CLK_TCK")


def wait_for(page, stage):
    """Seconds from navigation on, by the page's own clock."""
    page.wait("window.octalux && (octalux.state.%sSeconds !== null || octalux.state.stage === 'failed')" % stage, 600)
    check(page.value("octalux.state.stage") != "failed", "the room loads: " + str(page.value("document.getElementById('stage').textContent")))
    return page.value("octalux.state.%sSeconds" % stage)


def position(page, what="camera"):
    return page.value("octalux.%s.position.toArray()" % what)


def key(page, code):
    for kind in ("keyDown", "keyUp"):
        page.call("Input.dispatchKeyEvent", type=kind, code=code, key=code)
    page.settle()


def touch(page, kind, *points):
    page.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])


def wait_for_frame(page):
    """Waits until a frame that began after now is on the screen."""
    page.wait("octalux.state.frames >= %d" % (page.value("octalux.state.frames") + 2), 120)


def use_tools(page, shot):
    pressed = lambda tool: page.value("document.getElementById('%s').getAttribute('aria-pressed') === 'true'" % tool)
    page.click("#indirect")
    check(page.value("octalux.field.uniforms.olx_strength.value.x") == 0 and not pressed("indirect"), "indirect light goes off")
    wait_for_frame(page)
    shot("without")
    key(page, "KeyI")
    check(page.value("octalux.field.uniforms.olx_strength.value.x") == 1 and pressed("indirect"), "and on again by its key")
    page.click("#compare")
    page.wait("octalux.field.uniforms.olx_left.value > 0", 60)
    wait_for_frame(page)
    shot("before-and-after")
    page.click("#compare")
    page.click("#probes")
    wait_for_frame(page)
    shot("probes")
    page.click("#probes")
    before = position(page)
    key(page, "KeyW")
    check(position(page) != before, "a key walks")
    before = position(page, "ball")
    page.click("#carry")
    page.wait("JSON.stringify(octalux.ball.position.toArray()) !== '%s'" % json.dumps(before, separators=(",", ":")), 60)
    page.click("#carry")
    page.click("#reset")
    turned = page.value("octalux.camera.quaternion.toArray()")
    page.drag(300, 60, 380, 80)
    check(page.value("octalux.camera.quaternion.toArray()") != turned, "dragging looks around")
    page.click("#reset")
    before = position(page)
    touch(page, "touchStart", (200, 60), (240, 60))
    touch(page, "touchMove", (180, 60), (300, 60))
    touch(page, "touchEnd")
    check(position(page) != before, "two fingers walk")
    page.click("#reset")


def lose_context(page, shot):
    """Takes the device away in the middle of a frame, and gives it back: the page draws on, what it drew before."""
    page.value("void (window.gl = document.getElementById('view').getContext('webgl2'))")
    page.value("void (window.device = gl.getExtension('WEBGL_lose_context'))")
    wait_for_frame(page)
    before, shown = read_layer(page, "picture", 1), brightness(shot("before-loss"))
    page.value("new Promise((done) => requestAnimationFrame(() => { device.loseContext(); done(); }))")
    page.settle()
    page.value("device.restoreContext()")
    for _ in range(3):  # the first picture is small
        wait_for_frame(page)
    after, shown_again = read_layer(page, "picture", 1), brightness(shot("after-loss"))
    difference = sum(abs(a - b) for a, b in zip(after, before)) / sum(before)
    check(difference < 1e-3, "a restored device draws the same picture: %.2g of its light differs" % difference)
    check(abs(shown_again / shown - 1) < 0.1, "a restored device shows it: mean %.1f, %.1f before" % (shown_again, shown))


def watch_light(page, address, options):
    """Waits for both kinds of light; returns when they came, and what it took."""
    begun = processor_seconds(page.process.pid)
    spent = lambda: processor_seconds(page.process.pid) - begun
    page.visit(address)
    times = {"diffuse_seconds": wait_for(page, "diffuse"), "diffuse_processor_seconds": spent()}
    if not options.no_glossy:
        times["glossy_seconds"] = wait_for(page, "glossy")
    times.update(processor_seconds=spent(), megabytes=page.received_bytes / 1e6)
    check(times["processor_seconds"] <= options.processor, "%(processor_seconds).1f seconds of processor time until all light is there" % times)
    check(times["megabytes"] <= options.megabytes, "%(megabytes).1f MB are loaded" % times)
    return times


def read_light(page, output, options):
    picture = channels_of("depth", read_layer(page, "depth", 1), "Z")
    picture.update(channels_of("normal", read_layer(page, "normal", 1), "XYZ"))
    picture.update(channels_of("indirect_diffuse", read_layer(page, "diffuse", 1)))
    if not options.no_glossy:
        picture.update(channels_of("indirect_glossy", read_layer(page, "glossy", SAMPLES)))
        rays = read_layer(page, "rays", 1)
        traced, unresolved = sum(rays[0::4]), sum(rays[1::4])
        print("unresolved: %d of %d reflected rays" % (unresolved, traced))
        check(0 <= unresolved <= MOST_UNRESOLVED * traced > 0, "%d of %d reflected rays are unresolved" % (unresolved, traced))
    exr_picture.write(os.path.join(output, "page.exr"), WIDTH, HEIGHT, picture)


def show_at_sizes(page, shot):
    for name, width, height in (("phone", 390, 844), ("wide", 1280, 800)):
        page.resize(width, height)
        page.settle()
        check(page.value("document.documentElement.scrollWidth") <= width, "%s: nothing sticks out" % name)
        boxes = page.value("[...document.querySelectorAll('#tools button')].map((e) => e.getBoundingClientRect().toJSON())")
        check(all(b["left"] >= 0 and b["right"] <= width and b["bottom"] <= height for b in boxes), "%s: all buttons are seen" % name)
        shot(name)


def show_without_webgl(page, address):
    """A browser without WebGL 2 says so."""
    known = len(page.problems)
    page.call("Page.addScriptToEvaluateOnNewDocument", source="HTMLCanvasElement.prototype.getContext = () => null")
    page.visit(address)
    page.wait("window.octalux && octalux.state.stage === 'failed'", 60)
    said = page.value("document.getElementById('loading').innerText")
    wanted = "This room cannot be shown: this browser has no WebGL 2, or it is turned off"
    check(said == wanted, "without WebGL it says " + said)
    check(page.value("document.getElementById('progress').hidden"), "without WebGL nothing seems to load")
    del page.problems[known:]  # the console names the cause as well


def read_options():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder")
    parser.add_argument("output", nargs="?", default=".")
    parser.add_argument("--no-blocks", action="store_true", help="hide the extensions for textures of blocks")
    parser.add_argument("--no-glossy", action="store_true", help="the page has no reflections")
    parser.add_argument("--light-only", action="store_true", help="do not use the tools")
    parser.add_argument("--tools-only", action="store_true", help="do not read the light back")
    parser.add_argument("--megabytes", type=float, default=25, help="the most that is loaded")
    parser.add_argument("--processor", type=float, default=15,
                        help="the most seconds of processor time, of all the browser's processes, until all light is there")
    return parser.parse_args()


def main(options):
    address = serve(options.folder)
    page = browser.Page(WIDTH, HEIGHT, gpu=SWIFTSHADER, server=address)

    def shot(name):
        path = os.path.join(options.output, name + ".png")
        page.screenshot(path, full=False)
        return path

    try:
        if options.no_blocks:
            page.hide_extensions(BLOCKS)
        times = watch_light(page, address, options)
        shot("whole")
        print(json.dumps(times), flush=True)
        if not options.tools_only:
            read_light(page, options.output, options)
        if not options.light_only:
            use_tools(page, shot)
            lose_context(page, shot)
            show_at_sizes(page, shot)
            show_without_webgl(page, address)
        with open(os.path.join(options.output, "times.json"), "w", encoding="utf-8") as file:
            json.dump(times, file)
        for problem in page.problems:
            check(False, problem)
    finally:
        page.close()
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(read_options()))
