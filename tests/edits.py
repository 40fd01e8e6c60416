"""Bakes a row of rooms into a kept work folder, edits the scene again and again, and compares every field with that of a
fresh bake: edits.py FOLDER EDITS SEED OCTALUX. What each kind of edit reuses is checked, too."""
import json
import pathlib
import random
import subprocess
import sys

ROOMS = 2
# What the stages of each edit reuse: "all", "none" or "some" units.
FIRST = {"plan": "none", "light": "none", "cast": "none", "probe": "none"}
SAME = {"plan": "all", "scene": "all", "light": "all", "facts": "all", "volume": "all", "probe": "all"}
SHADE = {"plan": "none", "light": "some", "cast": "none", "direct": "none", "probe": "none"}
SHAPE = {"plan": "none", "light": "none", "cast": "none", "direct": "none", "probe": "none"}
VIEW = {"plan": "none", "light": "none", "probe": "none"}
# The least share of all rays that is reused after each kind of edit, just below the least of random edits. Noise
# is low enough that surfels and gathers cast guided rays, which are the ones that an edit can easily lose.
NOISE = "0.02"
LEAST_REUSED = {"colour": 0.495, "lamp": 0.11, "chair": 0.405, "gloss": 0.007}


def box(low, high, material, inwards=False):
    """Returns the corners and the faces of a box."""
    corners = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [(face[::-1] if inwards else face, material) for face in faces]


class Rooms:
    """Rooms in a row with doors between them, a chair in each, and a lamp in each."""

    def __init__(self):
        self.chairs = [[4 * room + 1.5, 2.0] for room in range(ROOMS)]
        self.colours = [[0.6, 0.2, 0.1] for _ in range(ROOMS)]
        self.lamps = [[4 * room + 1.0, 2.0, 1.0] for room in range(ROOMS)]
        self.shiny = False

    def boxes(self):
        yield box((0, 0, 0), (4 * ROOMS, 2.5, 3), "wall", True)
        for x in range(4, 4 * ROOMS, 4):
            yield box((x - 0.05, 0, 0), (x + 0.05, 2.5, 1), "wall")
            yield box((x - 0.05, 0, 2), (x + 0.05, 2.5, 3), "wall")
            yield box((x - 0.05, 2, 1), (x + 0.05, 2.5, 2), "wall")
        for room, (x, z) in enumerate(self.chairs):
            yield box((x, 0, z), (x + 0.5, 0.8, z + 0.5), f"chair{room}")

    def write(self, folder):
        lines, first = [], 1
        for corners, faces in self.boxes():
            lines += ["v %g %g %g" % corner for corner in corners]
            for face, material in faces:
                lines += [f"usemtl {material}", "f " + " ".join(str(first + corner) for corner in face)]
            first += len(corners)
        (folder / "rooms.obj").write_text("\n".join(lines) + "\n")
        materials = {"wall": {"base_color": [0.7, 0.7, 0.7], "roughness": 0.2 if self.shiny else 1.0}}
        materials.update({f"chair{room}": {"base_color": colour} for room, colour in enumerate(self.colours)})
        lamps = [{"type": "point", "position": lamp, "intensity": [10, 9, 8]} for lamp in self.lamps]
        (folder / "rooms.json").write_text(
            json.dumps({"model": "rooms.obj", "materials": materials, "lights": lamps}))


def edit(rooms, kind, random_numbers):
    """Changes one thing, and returns what the edit may reuse."""
    room = random_numbers.randrange(ROOMS)
    if kind == "colour":
        rooms.colours[room] = [random_numbers.uniform(0.1, 0.8) for _ in range(3)]
    elif kind == "gloss":
        rooms.shiny = not rooms.shiny
    elif kind == "lamp":
        rooms.lamps[room][0] += random_numbers.choice([-0.2, 0.2])
    else:
        rooms.chairs[room][0] += random_numbers.choice([-0.2, 0.2])
        return SHAPE
    return SHADE


def bake(octalux, folder, output, *options):
    command = [octalux, "bake", "rooms.json", "--probes", "probes.json", "--radiance-size", "16", "--noise", NOISE,
               "-o", output, "--json", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


def check_reuse(report, expected, what):
    stages = {stage["stage"]: stage for stage in report["stages"]}
    for name, amount in expected.items():
        reused, computed = stages[name]["reused"], stages[name]["computed"]
        is_amount = {"all": reused and not computed, "none": computed and not reused, "some": reused and computed}
        if not is_amount[amount]:
            sys.exit(f"{what}: {name}: {reused} reused, {computed} computed, and not {amount} reused")


def compare(octalux, folder, expected, what):
    """Bakes into the kept folder and afresh, and returns the report of the former."""
    report = bake(octalux, folder, "edited.olx", "--work", "kept", "--keep-work", "--explain")
    bake(octalux, folder, "fresh.olx", "--no-work")
    if (folder / "edited.olx").read_bytes() != (folder / "fresh.olx").read_bytes():
        sys.exit(f"{what}: not the field of a fresh bake")
    check_reuse(report, expected, what)
    return report


def write_hut(folder, eye):
    """Writes a room whose walls face outwards, so that only a camera in it says that it is free."""
    corners, faces = box((0, 0, 0), (4, 2.5, 3), "wall")
    lines = ["v %g %g %g" % corner for corner in corners]
    lines += ["f " + " ".join(str(1 + corner) for corner in face) for face, _ in faces]
    (folder / "hut.obj").write_text("\n".join(lines) + "\n")
    camera = {"name": "view", "eye": eye, "target": [2, 1.2, 1.5], "up": [0, 1, 0], "fov_y_degrees": 60}
    lamp = {"type": "point", "position": [1, 2, 1], "intensity": [10, 9, 8]}
    (folder / "rooms.json").write_text(json.dumps({"model": "hut.obj", "cameras": [camera], "lights": [lamp]}))


def move_camera(folder, octalux):
    """Moves the camera into a room whose probes it thereby frees, about in it, and out again."""
    folder.mkdir()
    (folder / "probes.json").write_text(json.dumps({"probes": [{"position": [2, 1.3, 1.4]}]}))
    views = [("outside", [2, 1.2, 9]), ("inside", [1, 1.2, 1]), ("inside, elsewhere", [3, 1.2, 1]),
             ("outside again", [2, 1.2, 9])]
    for where, eye in views:
        write_hut(folder, eye)
        report = compare(octalux, folder, VIEW, f"camera {where}")
        if (report["surfels"] > 0) != where.startswith("inside"):
            sys.exit(f"camera {where}: {report['surfels']} surfels")


def write_closed_rooms(folder, lamp, camera, pinned):
    """Writes two rooms without a door: one has a lamp, one may have a camera, and a probe may be pinned."""
    lines, first = [], 1
    for low in (0, 9):
        corners, faces = box((low, 0, 0), (low + 4 + low / 9, 2.5, 3), "wall", True)
        lines += ["v %g %g %g" % corner for corner in corners]
        lines += ["f " + " ".join(str(first + corner) for corner in face) for face, _ in faces]
        first += len(corners)
    (folder / "closed.obj").write_text("\n".join(lines) + "\n")
    scene = {"model": "closed.obj", "lights": [{"type": "point", "position": lamp, "intensity": [10, 9, 8]}]}
    if camera:
        scene["cameras"] = [{"name": "view", "eye": [1, 1.2, 1], "target": [2, 1.2, 1.5]}]
    if pinned:
        scene["probes"] = {"pinned": [pinned]}
    (folder / "rooms.json").write_text(json.dumps(scene))


def reach_other_rooms(folder, octalux):
    """Pins a probe in a room that the camera does not see, and moves the lamp where no camera says what is reached: the
    first time it is near no surface, and then near one."""
    folder.mkdir()
    (folder / "probes.json").write_text(json.dumps({"probes": [{"position": [2, 1.3, 1.4]}]}))
    steps = [("a camera alone", [1, 2, 1], True, None, VIEW), ("a pinned probe", [1, 2, 1], True, [11, 1.2, 1], VIEW),
             ("no camera", [1, 2, 1], False, None, VIEW), ("the lamp elsewhere", [10, 2, 1], False, None, SHADE),
             ("the lamp at a wall", [2, 1.2, 0.1], False, None, SHADE)]
    for what, lamp, camera, pinned, expected in steps:
        write_closed_rooms(folder, lamp, camera, pinned)
        compare(octalux, folder, expected, what)


def main():
    folder, edits, seed, octalux = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    numbers, rooms = random.Random(seed), Rooms()
    places = [{"position": [4 * room + 2, 1.3, 1.4]} for room in range(ROOMS)]
    (folder / "probes.json").write_text(json.dumps({"probes": places}))
    rooms.write(folder)
    compare(octalux, folder, FIRST, "first bake")
    compare(octalux, folder, SAME, "no edit")
    kinds = ["colour", "lamp", "chair", "gloss"]
    for number in range(edits):
        kind = kinds[number] if number < len(kinds) else numbers.choice(kinds)
        expected = edit(rooms, kind, numbers)
        rooms.write(folder)
        what = f"seed {seed}, edit {number + 1}, {kind}"
        report = compare(octalux, folder, expected, what)
        rays, reused = report["rays"], report["reused_rays"]
        if reused < LEAST_REUSED[kind] * rays:
            sys.exit(f"{what}: {reused} of {rays} rays reused")
        print(f"{what}: {reused} of {rays} rays reused")
    move_camera(folder / "hut", octalux)
    reach_other_rooms(folder / "closed", octalux)


main()
