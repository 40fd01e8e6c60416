#!/usr/bin/env python3
"""Render any scene of Octalux with Cycles, Blender's path tracer, which shares no code with it.

    bench/cycles.py SCENE -o OUT.exr [--camera NAME] [--size 160x90] [--spp N] [--bounces N] [--matte] [--seed N]
    bench/cycles.py SCENE --compare [--within PERCENT] [the same options]

SCENE is what `octalux render` takes. The picture has the layers direct, indirect_diffuse, indirect_glossy, albedo and
beauty, so that `octalux compare` finds them. --matte makes every surface Lambertian, in which case both programs
compute the same integral; as they are, specular lobes agree to some percent only (bench/cycles_scene.py says why).

--compare also renders the scene with `octalux render --method path` and prints, for each layer, how much brighter
Octalux is, with the standard error that the noise of both leaves; with --within PERCENT the exit status is 1 when a
layer differs by more than that and three standard errors.

Needs Debian's packages blender and python3-numpy; without them the exit status is 77.
"""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(HERE)
SKIPPED = 77
SEEDS = 4


class Missing(Exception):
    pass


def find_blender():
    blender = shutil.which("blender")
    if not blender:
        raise Missing("blender is not installed")
    # Blender's module paths follow the first python3 on PATH, which has to be the distribution's own.
    look = [blender, "-b", "--factory-startup", "--python-expr", "import numpy; print('numpy', 'found')"]
    found = subprocess.run(look, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                           env={**os.environ, "PATH": os.defpath})
    if "numpy found" not in found.stdout:
        raise Missing("blender has no numpy (python3-numpy)")
    return blender


def run(command, **environment):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, **environment})
    if done.returncode != 0:
        raise SystemExit("%s failed:\n%s%s" % (os.path.basename(command[0]), done.stdout[-4000:], done.stderr[-4000:]))
    return done.stdout


def matte_description(scene, folder):
    """A description of the same scene in which every surface is Lambertian."""
    described = {"model": scene}
    if scene.endswith(".json"):
        beside = os.path.dirname(os.path.abspath(scene))
        with open(scene) as file:
            described = json.load(file)
        os.environ["OCTALUX_SCENES"] = ":".join(filter(None, [beside, os.environ.get("OCTALUX_SCENES")]))
    elif not scene.startswith("builtin:"):
        described["model"] = os.path.abspath(scene)
    materials = described.setdefault("materials", {})
    for entry in [*materials.values(), materials.setdefault("*", {})]:
        entry.update({"specular": 0, "metallic": 0})
    path = os.path.join(folder, "matte.json")
    with open(path, "w") as file:
        json.dump(described, file)
    return path


class Cycles:
    """Renders one scene; the arrays are written once."""

    def __init__(self, program, scene, camera, work):
        self.blender, self.work = find_blender(), work
        self.arrays = os.path.join(work, "arrays")
        os.makedirs(self.arrays, exist_ok=True)
        tool = os.path.join(os.path.dirname(program), "octalux-bench")
        run([tool, "scene-arrays", scene, self.arrays] + ([camera] if camera else []))

    def render(self, output, size, spp, bounces, seed=0, threads=2, textures="float", normals="smooth",
               shadow_terminator=0.0, clamp_indirect=0.0, light_threshold=0.0, emitters="sampled", model=None):
        settings = {
            "folder": self.arrays, "output": os.path.abspath(output), "passes": os.path.join(self.work, "passes.exr"),
            "size": size, "spp": spp, "bounces": bounces, "seed": seed, "threads": threads, "textures": textures,
            "normals": normals, "shadow_terminator": shadow_terminator, "clamp_indirect": clamp_indirect,
            "light_threshold": light_threshold, "emitters": emitters, "import": model,
        }
        path = os.path.join(self.work, "settings.json")
        with open(path, "w") as file:
            json.dump(settings, file)
        script = os.path.join(HERE, "cycles_scene.py")
        log = run([self.blender, "-b", "--factory-startup", "-noaudio", "-P", script, "--", path], PATH=os.defpath)
        if "cycles: done" not in log:
            raise SystemExit("blender failed:\n" + log[-6000:])
        return log


def mean_bias(program, pairs, layer):
    """The mean of Octalux over Cycles less 1, in pictures of independent seeds, and its standard error."""
    found = []
    for a, b in pairs:
        compared = run([program, "compare", a, b, "--layer", layer, "--json"])
        found.append(json.loads(compared)["layers"][layer]["bias"])
    mean = sum(found) / len(found)
    variance = sum((b - mean) ** 2 for b in found) / (len(found) - 1)
    return mean, math.sqrt(variance / len(found))


def compare(program, scene, a, cycles, work, **toggles):
    """Rows of layer, bias and its standard error."""
    width, height = a.size
    pairs = []
    for i in range(SEEDS):
        ours, theirs = (os.path.join(work, "%s%d.exr" % (name, i)) for name in ("octalux", "cycles"))
        camera = ["--camera", a.camera] if a.camera else []
        run([program, "render", scene, "-o", ours, "--method", "path", "--size", "%dx%d" % (width, height),
             "--spp", a.spp, "--bounces", a.bounces, "--seed", a.seed + i, "--threads", a.threads, *camera])
        cycles.render(theirs, a.size, a.spp, a.bounces, a.seed + i, a.threads, **toggles)
        pairs.append((ours, theirs))
    layers = ["direct", "indirect_diffuse"] + ([] if a.matte else ["indirect_glossy"])
    return [(layer, *mean_bias(program, pairs, layer)) for layer in layers]


def size(text):
    width, height = text.split("x")
    return int(width), int(height)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", metavar="OUT.exr")
    parser.add_argument("--compare", action="store_true")
    parser.add_argument("--within", type=float, metavar="PERCENT")
    parser.add_argument("--camera")
    parser.add_argument("--size", type=size, default=(160, 90))
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--bounces", type=int, default=8, help="indirect bounces; default 8")
    parser.add_argument("--matte", action="store_true", help="every surface is Lambertian")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--textures", choices=("float", "bytes", "closest"), default="float",
                        help="bytes: Cycles filters textures of 8 bits before it decodes sRGB; closest: it does not "
                             "filter; float: they are decoded first, as in Octalux; default float")
    parser.add_argument("--normals", choices=("smooth", "flat"), default="smooth")
    parser.add_argument("--shadow-terminator", type=float, default=0.0, help="Blender's default is 0.1")
    parser.add_argument("--clamp-indirect", type=float, default=0.0, help="Blender's default is 10")
    parser.add_argument("--light-threshold", type=float, default=0.0, help="Blender's default is 0.01")
    parser.add_argument("--emitters", choices=("sampled", "hit"), default="sampled",
                        help="hit: Cycles finds lamps with an area by chance alone, which is noisier; default sampled")
    parser.add_argument("--import", dest="model", metavar="MODEL.gltf",
                        help="with --matte: geometry and textures by Blender's own importer, from the scene's one "
                             "model, which is not moved")
    parser.add_argument("--program", default=os.path.join(SOURCE, "build", "release", "octalux"))
    arguments = parser.parse_args()
    if not arguments.compare and not arguments.output:
        parser.error("either -o or --compare is needed")
    if arguments.model and not (arguments.matte and arguments.model.endswith((".gltf", ".glb"))):
        parser.error("--import takes a glTF model and needs --matte")
    if arguments.within is not None and not arguments.compare:
        parser.error("--within needs --compare")
    return arguments


def main():
    a = parse()
    toggles = {"textures": a.textures, "normals": a.normals, "shadow_terminator": a.shadow_terminator,
               "clamp_indirect": a.clamp_indirect, "light_threshold": a.light_threshold, "emitters": a.emitters,
               "model": a.model and os.path.abspath(a.model)}
    with tempfile.TemporaryDirectory(prefix="octalux-cycles-") as work:
        scene = matte_description(a.scene, work) if a.matte else a.scene
        try:
            cycles = Cycles(os.path.abspath(a.program), scene, a.camera, work)
        except Missing as missing:
            print("skipped: %s" % missing, file=sys.stderr)
            return SKIPPED
        if a.output:
            cycles.render(a.output, a.size, a.spp, a.bounces, a.seed, a.threads, **toggles)
        if a.compare:
            rows = compare(a.program, scene, a, cycles, work, **toggles)
            for layer, bias, error in rows:
                print("%-18s %+.3f %%  +- %.3f %%" % (layer, 100 * bias, 100 * error))
            if a.within is not None and any(100 * (abs(bias) - 3 * error) > a.within for _, bias, error in rows):
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
