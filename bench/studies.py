#!/usr/bin/env python3
"""Measure what docs/studies/ reports beyond the papers' experiments (octalux-bench), and print it as Markdown tables.

    bench/studies.py [EXPERIMENT ...] [--program build/release/octalux] [--work DIR] [--quick] [--device cpu|vulkan ...] [--view NAME ...]

Without an experiment all of them run. Scenes that are not to be found (OCTALUX_SCENES) are left out, visibly.
"""
import argparse
import json
import math
import os
import struct
import subprocess
import sys
import time

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


class Scene:
    def __init__(self, name, source, grid, radiance, size, camera=None, bounces=3, spp=512, same_grid=False):
        self.name, self.source, self.grid, self.radiance, self.size = name, source, grid, radiance, size
        self.camera, self.bounces, self.spp, self.same_grid = camera, bounces, spp, same_grid

    def present(self, bench):
        return self.source.startswith("builtin:") or bench.run("scene", self.source, fail=False) is not None


def described(name):
    return os.path.join(SOURCE, "scenes", name + ".json")


SCENES = {
    s.name: s
    for s in [
        Scene("cornell", "builtin:cornell", "2x2x2", 512, "192x192", spp=1024),
        Scene("cornell-glossy", "builtin:cornell-glossy", "2x2x2", 512, "192x192", spp=1024),
        Scene("cornell, irradiance on 2x2x2", "builtin:cornell", "2x2x2", 512, "192x192", spp=1024, same_grid=True),
        Scene("labyrinth", "builtin:labyrinth", None, 512, "200x150", spp=512),
        Scene("living-room", described("living-room"), "4x4x4", 1024, "200x150", spp=512),
        Scene("temple", "builtin:temple", None, 512, "192x108", spp=256),
        Scene("sponza", described("sponza"), "8x2x4", 512, "192x108", spp=256),
    ]
}


class Bench:
    def __init__(self, program, work, quick, only, devices=("cpu",), views=None):
        self.program, self.work, self.quick, self.only = program, work, quick, only
        self.devices, self.views = devices, views
        self.made = set()
        os.makedirs(work, exist_ok=True)

    def run(self, *arguments, fail=True):
        command = [self.program, *[str(a) for a in arguments], "--json"]
        print("$ octalux " + " ".join(command[1:]), file=sys.stderr)
        start = time.time()
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            if fail:
                sys.exit("octalux %s failed: %s" % (arguments[0], done.stderr.strip()))
            return None
        print("  %.1f s" % (time.time() - start), file=sys.stderr)
        return json.loads(done.stdout)

    def path(self, name):
        return os.path.join(self.work, name.replace(", ", "-").replace(" ", "-"))

    def bake(self, scene, *extra, tag=""):
        out = self.path(scene.name + tag + ".olx")
        grid = ["--grid", scene.grid] if scene.grid else []
        if scene.same_grid:
            grid += ["--irradiance-grid", scene.grid]
        self.run("bake", scene.source, "-o", out, *grid, "--probe-light", "--radiance-size", scene.radiance, "--bounces", scene.bounces, *extra)
        return out

    def view(self, scene):
        return ["--size", scene.size] + (["--camera", scene.camera] if scene.camera else [])

    def reference(self, scene):
        out = self.path("%s-path.exr" % os.path.basename(scene.source).replace("builtin:", ""))
        if os.path.exists(out) and out in self.made:
            return out
        self.made.add(out)
        spp = scene.spp // 8 if self.quick else scene.spp
        self.run("render", scene.source, "-o", out, "--method", "path", "--bounces", scene.bounces + 1, "--spp", spp, *self.view(scene))
        return out

    def render(self, scene, field, tag, *extra):
        out = self.path("%s-%s.exr" % (scene.name, tag))
        self.run("render", scene.source, "-o", out, "--method", "field", "--field", field, *self.view(scene), *extra)
        return out

    def compare(self, image, reference, layer):
        return self.run("compare", image, reference, "--layer", layer)["layers"][layer]


def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def head(*cells):
    print()
    row(*cells)
    row(*["---"] * len(cells))


def number(x):
    return "%.3g" % x


def scenes(bench, *names):
    for name in names:
        if bench.only and name not in bench.only:
            continue
        if SCENES[name].present(bench):
            yield SCENES[name]
        else:
            print("skipped: %s is not here (set OCTALUX_SCENES)" % name, file=sys.stderr)


def layers(bench):
    """Indirect layers against the path tracer at matching bounces."""
    head("scene", "layer", "way", "MSE", "relative MSE", "bias")
    for scene in scenes(bench, "cornell", "cornell, irradiance on 2x2x2", "cornell-glossy", "labyrinth", "living-room", "sponza"):
        reference = bench.reference(scene)
        field = bench.bake(scene)
        spp = 4 if bench.quick else 8
        ways = [
            ("irradiance probes", "irradiance", ["--spp", spp]),
            ("irradiance probes, no visibility", "plain", ["--spp", spp, "--visibility", "none"]),
            ("traced", "traced", ["--spp", spp, "--diffuse", "traced", "--diffuse-samples", 64]),
        ]
        for label, tag, options in ways:
            image = bench.render(scene, field, tag, *options)
            m = bench.compare(image, reference, "indirect_diffuse")
            row(scene.name, "indirect_diffuse", label, number(m["mse"]), number(m["relative_mse"]), number(m["bias"]))
            if tag == "traced":
                m = bench.compare(image, reference, "indirect_glossy")
                row(scene.name, "indirect_glossy", "traced", number(m["mse"]), number(m["relative_mse"]), number(m["bias"]))


def audit(bench):
    """Rays and points against ray casting and path tracing."""
    head("scene", "rays", "unresolved", "wrong", "unseen", "unresolved, seen", "wrong, seen", "median error", "p99 error", "steps", "probes",
         "points: relative MSE", "bias", "leak")
    for scene in scenes(bench, "cornell", "labyrinth", "living-room", "sponza"):
        field = bench.bake(scene)
        a = bench.run("audit", scene.source, "--field", field, "--rays", 20000 if bench.quick else 200000, "--points", 200 if bench.quick else 2000)
        r, p = a["rays"], a["irradiance_points"]
        row(scene.name, r["count"], *[number(100 * r[k]) + " %" for k in ("unresolved", "wrong", "unseen", "unresolved_seen", "wrong_seen")],
            number(r["distance_error_median"]), number(r["distance_error_p99"]), number(r["steps_mean"]), number(r["probes_mean"]),
            number(p["relative_mse"]), number(p["bias"]), number(p["leak"]))


def speed(bench):
    """Bake time against Embree alone, which casts the same four primary rays a texel in the same run."""
    head("scene", "probes", "bake, s", "Embree, s", "ratio", "rays", "peak memory, MiB", "file, MiB")
    for scene in scenes(bench, "living-room"):
        size = 256 if bench.quick else scene.radiance
        b = bench.run("bake", scene.source, "-o", bench.path("speed.olx"), "--grid", scene.grid, "--probe-light", "--radiance-size", size, "--bounces", 3, "--measure-embree")
        row(scene.name, b["probes"], number(b["seconds"]), number(b["embree_seconds"]), number(b["seconds"] / b["embree_seconds"]),
            "%.0f million" % (b["rays"] / 1e6), round(b["peak_memory_bytes"] / 2**20), round(b["file_bytes"] / 2**20))


def selector_bytes(field):
    """Of each selector's chunk."""
    with open(field, "rb") as file:
        data = file.read(64 * 64)
    count, = struct.unpack_from("<I", data, 12)
    chunks = {data[64 + 64 * i:68 + 64 * i]: struct.unpack_from("<Q", data, 80 + 64 * i)[0] for i in range(count)}
    return {name: chunks.get(kind, 0) for name, kind in (("voronoi", b"VORO"), ("octree", b"OCTR"), ("bricks", b"BRIK"))}


def study(bench, name):
    """The command of a study, which lies in the folder of the program that is measured."""
    return [os.path.join(os.path.dirname(bench.program), "octalux-bench"), name]


def selectors(bench):
    """How probes are found: rays against ray casting, bytes, and time on one thread with all selectors taking turns."""
    program = study(bench, "selector-speed")
    head("scene", "probes", "selector", "unresolved", "wrong", "probes tried", "texel steps", "bytes", "ns a ray")
    for name, count, grid in (("cornell-glossy", 7, "2x2x2"), ("temple", 16, "2x2x4"), ("temple", 32, "4x2x4"), ("sponza", 54, "6x3x3")):
        for scene in scenes(bench, name):
            placed = bench.path("%s-%d.json" % (name, count))
            bench.run("place", scene.source, "-o", placed, "--method", "cover", "--count", count)
            ways = ["voronoi", "octree", "bricks", "exhaustive"]
            for label, where, names in (("%d, cover" % count, ["--probes", placed], ways), (grid, ["--grid", grid], ["cage", *ways])):
                field = bench.path("%s-%s.olx" % (name, label))
                bench.run("bake", scene.source, "-o", field, *where, "--radiance-size", scene.radiance, "--bounces", 0, "--irradiance-size", 32,
                          "--select", ",".join(n for n in names if n != "exhaustive"))
                rays = 10000 if bench.quick else 100000
                table = subprocess.run([*program, field, str(rays)], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
                nanoseconds = {cells[1]: cells[2] for cells in ([c.strip() for c in line.split("|")] for line in table) if len(cells) > 5}
                stored = selector_bytes(field)
                for way in names:
                    r = bench.run("audit", scene.source, "--field", field, "--points", 0, "--rays", 2 * rays, "--select", way)["rays"]
                    row(name, label, way, number(100 * r["unresolved"]) + " %", number(100 * r["wrong"]) + " %",
                        number(r["probes_mean"]), number(r["steps_mean"]), stored.get(way, 0), nanoseconds[way])


# Parts of the living room in a picture of 960x540 from the camera "sofa": 64x48 pixels around a point, given as shares
# of the picture's width and height.
PARTS = {"shelf": (0.783, 0.489), "cushion": (0.479, 0.589), "grate": (0.958, 0.672)}


def close_ups(bench):
    """The living room with a camera for each part; returns the description's path."""
    scene = json.load(open(described("living-room")))
    sofa = scene["cameras"][0]
    sub = lambda a, b: [x - y for x, y in zip(a, b)]
    unit = lambda v: [x / math.sqrt(sum(y * y for y in v)) for x in v]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    forward = unit(sub(sofa["target"], sofa["eye"]))
    right = unit(cross(forward, [0, 1, 0]))
    up = cross(right, forward)
    half = math.tan(math.radians(sofa["fov_y_degrees"] / 2))
    for name, (x, y) in PARTS.items():
        across, above = half * 16 / 9 * (2 * x - 1), half * (1 - 2 * y)
        target = [e + f + across * r + above * u for e, f, r, u in zip(sofa["eye"], forward, right, up)]
        fov = 2 * math.degrees(math.atan(half * 48 / 540))
        scene["cameras"].append({"name": name, "eye": sofa["eye"], "target": target, "fov_y_degrees": fov})
    path = bench.path("living-room-close.json")
    json.dump(scene, open(path, "w"))
    return path


def denoise(bench):
    """Two rays a pixel and frame, denoised, against gathering in the same field (relative MSE)."""
    head("view", "device", "layer", "one ray", "gather", "published, 64 frames", "is as good as", "adaptive, 64 frames", "is as good as",
         "published, 10 after a cut", "over 64", "adaptive, 10 after a cut", "over 64")
    for scene in scenes(bench, "living-room"):
        field, source = bench.bake(scene), close_ups(bench)
        for part in PARTS:
            if bench.views and part not in bench.views:
                continue

            def render(tag, *options):
                out = bench.path("denoise-%s-%s.exr" % (part, tag))
                bench.run("render", source, "-o", out, "--method", "field", "--field", field, "--size", "64x48", "--camera", part, *options)
                return out

            # The seed differs from that of the frames and gathers that are compared with it.
            truth = render("truth", "--mode", "gather", "--gather-samples", 256 if bench.quick else 2048, "--seed", 7)
            gathered = {samples: render("gather%d" % samples, "--mode", "gather", "--gather-samples", samples) for samples in (1, 32, 128)}
            for device in bench.devices:
                images = dict(gathered)
                frames = ["--device", device, "--mode", "denoised", "--frames"]
                cut = ["--from-camera", "window", "--cut", 10]
                for way in ("published", "adaptive"):
                    images[way] = render(way, *frames, 64, "--denoise", way)
                    images[way + " cut"] = render(way + "-cut", *frames, 74, "--denoise", way, *cut)
                for layer, samples in (("indirect_diffuse", 128), ("indirect_glossy", 32)):
                    error = {name: bench.compare(image, truth, layer)["relative_mse"] for name, image in images.items()}
                    cells = []
                    for way in ("published", "adaptive"):
                        cells += [number(error[way]), "%.0f rays" % (error[1] / error[way])]
                    for way in ("published", "adaptive"):
                        cells += [number(error[way + " cut"]), "%.1f" % math.sqrt(error[way + " cut"] / error[way])]
                    row(part, device, layer, number(error[1]), "%s with %d" % (number(error[samples]), samples), *cells)


def modes(bench):
    """The paper's three modes against the path tracer, camera rays through pixel centres (relative MSE)."""
    head("scene", "mode", "indirect_diffuse", "over prefiltered", "indirect_glossy", "10 frames after a cut: diffuse", "glossy")
    for scene in scenes(bench, "living-room"):
        field = bench.bake(scene)
        references = [bench.path("modes-path%d.exr" % seed) for seed in (0, 1)]
        spp = 64 if bench.quick else 512
        for seed, reference in enumerate(references):
            bench.run("render", scene.source, "-o", reference, "--method", "path", "--bounces", scene.bounces + 1, "--spp", spp, "--centered", "--seed", seed,
                      *bench.view(scene))

        def error(image, layer):
            """The mean to both references, less their own noise: half of what they differ by."""
            a, b = (bench.compare(image, reference, layer)["relative_mse"] for reference in references)
            return (a + b - bench.compare(*references, layer)["relative_mse"]) / 2

        cut = ["--from-camera", "window", "--cut", 10, "--frames", 74]
        ways = {
            "prefiltered": (["--mode", "prefiltered", "--frames", 64], ["--mode", "prefiltered", *cut]),
            "denoised": (["--mode", "denoised", "--frames", 64], ["--mode", "denoised", *cut]),
            "denoised, published": (["--mode", "denoised", "--frames", 64, "--denoise", "published"], ["--mode", "denoised", "--denoise", "published", *cut]),
            "gather, 128 rays": (["--mode", "gather", "--gather-samples", 128], None),
        }
        best = None
        for name, (options, after_cut) in ways.items():
            image = bench.render(scene, field, "mode", *options)
            diffuse, glossy = (error(image, layer) for layer in ("indirect_diffuse", "indirect_glossy"))
            best = best or diffuse
            cells = ["-", "-"]
            if after_cut:
                image = bench.render(scene, field, "mode-cut", *after_cut)
                cells = [number(error(image, layer)) for layer in ("indirect_diffuse", "indirect_glossy")]
            row(scene.name, name, number(diffuse), number(diffuse / best), number(glossy), *cells)


def dim_lobes(bench):
    """Rough lobes left to irradiance when they reflect less than a share (prefiltered mode, 16 frames; glossy against 512 rays)."""
    head("scene", "--dim-lobe", "rays through the field", "glossy pass, s", "relative MSE of glossy", "bias", "relative MSE of beauty")
    for scene in scenes(bench, "living-room", "sponza"):
        field = bench.bake(scene)
        truth = bench.render(scene, field, "dim-truth", "--spp", 1, "--glossy-samples", 64 if bench.quick else 512)
        for share in (0, 0.05, 0.1, 0.2):
            out = bench.path("dim.exr")
            options = ["--dim-lobe", share] if share else []
            r = bench.run("render", scene.source, "-o", out, "--method", "field", "--field", field, *bench.view(scene), "--frames", 16, "--spp", 1, *options)
            m, b = bench.compare(out, truth, "indirect_glossy"), bench.compare(out, truth, "beauty")
            row(scene.name, share, "%.2f million" % (r["field_rays"] / 1e6), number(r["passes"]["indirect_glossy"]), number(m["relative_mse"]),
                number(m["bias"]), number(b["relative_mse"]))


def seams(bench):
    """Borders of cages in pictures, values that are not finite, and glossy rays without an answer."""
    program = study(bench, "seams")
    picture = ["--size", "320x180" if bench.quick else "640x360", "--spp", 1, "--method", "field"]
    out = bench.path("seams.exr")
    for scene in scenes(bench, "living-room"):
        field = bench.bake(scene)
        head("view", "device", "mode", "layer", "places at borders", "gradient across over beside", "the same elsewhere", "values not finite")
        for camera in ("sofa", "window"):
            for device in bench.devices:
                for mode, options in (("prefiltered", ["--glossy-samples", 16]), ("denoised", ["--frames", 8])):
                    bench.run("render", scene.source, "-o", out, "--field", field, *picture, "--camera", camera, "--device", device, "--mode", mode, *options)
                    done = subprocess.run([*program, scene.source, field, out, camera], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
                    found = json.loads(done.stdout)
                    for layer in ("indirect_diffuse", "indirect_glossy"):
                        m = found[layer]
                        row(camera, device, mode, layer, m["borders"], "%.2f" % m["ratio"], "%.2f" % m["elsewhere"], found["not_finite"])
        head("view", "glossy rays of the picture", "unresolved", "mirror rays of the audit", "unresolved", "no probe sees what they meet", "beyond that")
        for camera in ("sofa", "window"):
            r = bench.run("render", scene.source, "-o", out, "--field", field, *picture, "--camera", camera, "--glossy-samples", 4)
            a = bench.run("audit", scene.source, "--field", field, "--camera", camera, "--points", 0, "--rays", 40000 if bench.quick else 200000)["mirror_rays"]
            row(camera, r["field_rays"], "%.2f %%" % (100 * r["field_unresolved"] / r["field_rays"]), a["count"],
                *["%.2f %%" % (100 * x) for x in (a["unresolved"], a["unseen"], a["unresolved"] - a["unseen"])])


PLACED = ["cornell", "temple", "sponza", "white-room", "kitchen", "small-house", "pandora"]


def place(bench):
    """Placement: every method in every scene, and what placement-check finds. Seconds: processor time over two."""
    check = study(bench, "placement-check")
    head("scene", "method", "probes", "s", "covered", "covered, checked", "reached", "inside or outside", "nearest surface", "backs seen")
    for name in PLACED:
        source = "builtin:" + name if name in ("cornell", "temple") else described(name)
        if bench.only and name not in bench.only:
            continue
        if not source.startswith("builtin:") and bench.run("scene", source, fail=False) is None:
            print("skipped: %s is not here (set OCTALUX_SCENES)" % name, file=sys.stderr)
            continue
        for method in ("sdf", "medial", "cover"):
            for optimize in ("none", "gradient", "gibbs"):
                probes = bench.path("place-%s-%s-%s.json" % (name, method, optimize))
                before = os.times()
                p = bench.run("place", source, "-o", probes, "--method", method, "--optimize", optimize)
                after = os.times()
                seconds = (after.children_user + after.children_system - before.children_user - before.children_system) / 2
                done = subprocess.run([*check, source, "20000" if bench.quick else "100000", probes], stdout=subprocess.PIPE, check=True, text=True)
                c = json.loads(done.stdout)
                row(name, method + ("" if optimize == "none" else " + " + optimize), p["count"], "%.1f" % seconds, "%.2f %%" % (100 * p["coverage"]),
                    "%.2f %%" % (100 * c["covered"]), "%d of %d" % (round(c["reached"] * p["count"]), p["count"]), p["buried"] + c["outside"],
                    "%.2f %%" % (100 * c["nearest"]), "%.2f" % c["back"])


# Scene, grids of about as many probes, and what is set against them.
PROBE_SETS = {
    "temple": (32, ["4x2x4", "2x2x8", "4x1x8", "2x4x4", "4x4x2", "3x2x5"]),
    "sponza": (128, ["8x4x4", "16x2x4", "8x2x8", "10x3x4"]),
}


def sets(bench):
    """How few placed probes do as well as the best of several grids."""
    compare = study(bench, "probe-sets")
    texels = 128 if bench.quick else 256
    for name, (count, grids) in PROBE_SETS.items():
        source = described(name + "-wang")
        if (bench.only and name not in bench.only) or bench.run("scene", source, fail=False) is None:
            continue
        fields = []

        def bake(tag, size, *extra):
            out = bench.path("%s %s %d.olx" % (name, tag, size))
            bench.run("bake", source, "-o", out, *extra, "--radiance-size", size, "--irradiance-size", 16, "--bounces", 0,
                      "--light-samples", 4)
            fields.append(os.path.basename(out))

        for grid in grids:
            bake("grid " + grid, texels, "--grid", grid)
        for method, optimize, divisor, size in (("sdf", "gibbs", 2, texels), ("medial", "gibbs", 2, texels), ("cover", "none", 2, texels),
                                                ("cover", "none", 3, texels), ("cover", "none", 4, texels), ("cover", "none", 4, 2 * texels)):
            probes = bench.path("%s %s %d.json" % (name, method, count // divisor))
            bench.run("place", source, "-o", probes, "--method", method, "--optimize", optimize, "--count", count // divisor)
            bake("%s %d" % (method, count // divisor), size, "--probes", probes)
        print(name + "\n", flush=True)
        subprocess.run([*compare, source, "200" if bench.quick else "4000", *fields], check=True, cwd=bench.work)
        for field in fields:
            os.remove(os.path.join(bench.work, field))


EXPERIMENTS = {"sets": sets, "place": place, "layers": layers, "audit": audit, "speed": speed, "selectors": selectors, "denoise": denoise, "modes": modes, "dim-lobes": dim_lobes,
               "seams": seams}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="*", metavar="EXPERIMENT", help=", ".join(EXPERIMENTS))
    parser.add_argument("--program", default=os.path.join(SOURCE, "build", "release", "octalux"))
    parser.add_argument("--work", default=os.path.join(SOURCE, "build", "bench"))
    parser.add_argument("--scene", action="append", help="only this scene; may be given again")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--device", action="append", choices=("cpu", "vulkan"), help="denoise, seams: where indirect light is made; may be given again; default: cpu")
    parser.add_argument("--view", action="append", choices=sorted(PARTS), help="denoise: only this view; may be given again")
    arguments = parser.parse_args()
    bench = Bench(os.path.abspath(arguments.program), os.path.abspath(arguments.work), arguments.quick, arguments.scene, arguments.device or ["cpu"],
                  arguments.view)
    for name in arguments.experiments:
        if name not in EXPERIMENTS:
            parser.error("no experiment %s; there are: %s" % (name, ", ".join(EXPERIMENTS)))
    for name in arguments.experiments or EXPERIMENTS:
        print("\n### %s" % EXPERIMENTS[name].__doc__.rstrip("."))
        EXPERIMENTS[name](bench)


if __name__ == "__main__":
    main()
