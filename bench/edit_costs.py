#!/usr/bin/env python3
"""Edit a scene and measure what a bake of it costs where the work folder of the bake before is kept.

    bench/edit_costs.py SCENE.json PROBES.json [--material NAME] [--chair X,Y,Z] [--octalux PROGRAM] [-- BAKE OPTIONS]

SCENE.json is a description with a light of type sun or point. A chair is added, at the position of its seat's corner
(default 0,0,0). The scene is baked into a kept folder; then each edit is made to the scene as it was at first, and
baked once afresh and once in a copy of that folder: nothing, the colour of the chair (with --material, of that
material), a chair moved by half a metre, and the first light moved. Every field has to be that of the fresh bake, byte
for byte; otherwise the exit status is 1. The table gives processor times, with loading, and the share of rays that were
cast again.
"""
import argparse
import copy
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
BOXES = [((0, 0.42, 0), (0.45, 0.47, 0.45)), ((0, 0.47, 0), (0.45, 0.95, 0.04)), ((0, 0, 0), (0.04, 0.42, 0.04)),
         ((0.41, 0, 0), (0.45, 0.42, 0.04)), ((0, 0, 0.41), (0.04, 0.42, 0.45)), ((0.41, 0, 0.41), (0.45, 0.42, 0.45))]


def write_chair(path):
    lines = ["usemtl chair"]
    for number, (low, high) in enumerate(BOXES):
        lines += [f"v {x} {y} {z}" for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
        for face in [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]:
            lines.append("f " + " ".join(str(8 * number + 1 + corner) for corner in face))
    path.write_text("\n".join(lines) + "\n")


def move_light(scene):
    light = scene["lights"][0]
    if light["type"] == "sun":
        light["direction"][0] += 0.05
    else:
        light["position"][0] += 0.1


def move_chair(scene):
    scene["models"][-1]["translate"][0] += 0.5


def colour(name):
    def edit(scene):
        scene.setdefault("materials", {}).setdefault(name, {})["base_color"] = [0.3, 0.5, 0.6]
    return edit


def bake(octalux, folder, output, options):
    """Bakes, and returns the processor time in seconds and the report."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([octalux, "bake", "scene.json", "--probes", "probes.json", "-o", output, "--json", *options],
                          cwd=folder, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"octalux bake: exit code {done.returncode}: {done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, json.loads(done.stdout)


def read_scene(path, chair):
    scene = json.loads(path.read_text())
    if "model" in scene and not scene["model"].startswith("builtin:"):
        beside = path.parent / scene["model"]
        scene["model"] = str(beside.resolve()) if beside.exists() else scene["model"]
    scene.setdefault("models", []).append({"path": "chair.obj", "translate": chair})
    scene.setdefault("materials", {})["chair"] = {"base_color": [0.6, 0.3, 0.2]}
    return scene


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].strip())
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("probes", type=pathlib.Path)
    parser.add_argument("--material", default="chair")
    parser.add_argument("--chair", default="0,0,0")
    parser.add_argument("--octalux", default=os.environ.get("OCTALUX", "octalux"))
    end = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    given = parser.parse_args(sys.argv[1:end])
    given.options = sys.argv[end + 1:]
    given.octalux = shutil.which(given.octalux) and str(pathlib.Path(shutil.which(given.octalux)).resolve()) or sys.exit(f"{given.octalux}: not found")
    first = read_scene(given.scene, [float(x) for x in given.chair.split(",")])
    edits = [("nothing", lambda scene: None), ("a colour", colour(given.material)), ("a chair", move_chair),
             ("a light", move_light)]
    with tempfile.TemporaryDirectory(prefix="octalux-edits-") as name:
        folder = pathlib.Path(name)
        write_chair(folder / "chair.obj")
        shutil.copy(given.probes, folder / "probes.json")
        (folder / "scene.json").write_text(json.dumps(first))
        kept = ["--keep-work", "--explain", *given.options]
        seconds, _ = bake(given.octalux, folder, "first.olx", ["--work", "kept", *kept])
        size = sum(file.stat().st_size for file in (folder / "kept").iterdir())
        print(f"first bake {seconds:.2f} s, kept folder {size / 1e6:.1f} MB", flush=True)
        print("| edit | fresh, s | edited, s | share | rays cast again |\n| --- | --- | --- | --- | --- |", flush=True)
        for what, edit in edits:
            scene = copy.deepcopy(first)
            edit(scene)
            (folder / "scene.json").write_text(json.dumps(scene))
            shutil.copytree(folder / "kept", folder / "work")
            (folder / "work").chmod(0o700)
            edited, report = bake(given.octalux, folder, "edited.olx", ["--work", "work", *kept])
            fresh, whole = bake(given.octalux, folder, "fresh.olx", ["--no-work", *given.options])
            shutil.rmtree(folder / "work", ignore_errors=True)
            again = 1 - report["reused_rays"] / whole["rays"] if what != "nothing" else 0
            print(f"| {what} | {fresh:.2f} | {edited:.2f} | {edited / fresh:.0%} | {again:.0%} |", flush=True)
            if (folder / "edited.olx").read_bytes() != (folder / "fresh.olx").read_bytes():
                sys.exit(f"{what}: not the field of a fresh bake")


main()
