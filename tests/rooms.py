# Writes a building of N x N rooms as OBJ, MTL and a description: rooms.py N FOLDER [SEALED]. Rooms are 10 m wide and 3
# m high, with walls 0.2 m thick, a screen, a cupboard and a lamp; doors are 1 m wide and 2 m high, somewhere along each
# wall. The last SEALED rooms of the last row have no doors. The camera is in the first room.
import json
import os
import random
import sys

PITCH, HEIGHT, HALF, DOOR, LINTEL = 10.0, 3.0, 0.1, 1.0, 2.0


# A model whose faces are grouped by material, so that the file has few groups.
class Model:
    def __init__(self):
        self.faces = {}

    def quad(self, material, *corners):
        self.faces.setdefault(material, []).append(corners)

    def write(self, path):
        count = 0
        with open(path, "w") as file:
            file.write("mtllib rooms.mtl\n")
            for material, faces in self.faces.items():
                file.write(f"usemtl {material}\n")
                for corners in faces:
                    file.writelines("v %.4f %.4f %.4f\n" % corner for corner in corners)
                    file.write("f %d %d %d %d\n" % (count + 1, count + 2, count + 3, count + 4))
                    count += 4

    # Adds a box whose faces are seen from outside, without the faces that `without` names.
    def box(self, material, low, high, without=""):
        (a, b, c), (x, y, z) = low, high
        faces = {"-x": ((a, b, c), (a, b, z), (a, y, z), (a, y, c)), "+x": ((x, b, z), (x, b, c), (x, y, c), (x, y, z)),
                 "-y": ((a, b, c), (x, b, c), (x, b, z), (a, b, z)), "+y": ((a, y, z), (x, y, z), (x, y, c), (a, y, c)),
                 "-z": ((x, b, c), (a, b, c), (a, y, c), (x, y, c)), "+z": ((a, b, z), (x, b, z), (x, y, z), (a, y, z))}
        for name, corners in faces.items():
            if name not in without.split():
                self.quad(material, *corners)


# Adds a wall along one axis from `start`, one pitch long, with a door at `door` or none.
def wall(model, axis, start, door):
    def part(low, high, bottom, top, without):
        ends = {0: ((low, bottom, start[2] - HALF), (high, top, start[2] + HALF)),
                2: ((start[0] - HALF, bottom, low), (start[0] + HALF, top, high))}
        model.box("wall", *ends[axis], without)

    first, last = start[axis], start[axis] + PITCH
    if door is None:
        part(first, last, 0.0, HEIGHT, "-y +y")
        return
    part(first, door, 0.0, HEIGHT, "-y +y")
    part(door + DOOR, last, 0.0, HEIGHT, "-y +y")
    part(door, door + DOOR, LINTEL, HEIGHT, "+y")


def furnish(model, x, z, chance):
    along, across = x + chance.uniform(3.0, 6.0), z + chance.uniform(3.0, 5.0)
    model.box("screen", (along, 0.0, across), (along + 0.1, 1.8, across + 2.0), "-y")
    model.box("cupboard", (x + 7.0, 0.0, z + 1.0), (x + 8.0, 1.0, z + 1.6), "-y")
    middle = (x + 5.0, HEIGHT - 0.01, z + 5.0)
    model.quad("lamp", *[(middle[0] + dx, middle[1], middle[2] + dz)
                         for dx, dz in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))])


def build(model, side, sealed):
    chance = random.Random(side)

    def is_sealed(i, k):
        return k == side - 1 and side - sealed <= i < side

    for k in range(side + 1):
        for i in range(side + 1):
            x, z = PITCH * i, PITCH * k
            door_x, door_z = chance.uniform(1.0, PITCH - 2.0), chance.uniform(1.0, PITCH - 2.0)
            inner_x = 0 < k < side and not is_sealed(i, k) and not is_sealed(i, k - 1)
            inner_z = 0 < i < side and not is_sealed(i, k) and not is_sealed(i - 1, k)
            if i < side:
                wall(model, 0, (x, 0.0, z), x + door_x if inner_x else None)
            if k < side:
                wall(model, 2, (x, 0.0, z), z + door_z if inner_z else None)
            if i < side and k < side:
                x2, z2 = x + PITCH, z + PITCH
                model.quad("floor", (x, 0.0, z), (x, 0.0, z2), (x2, 0.0, z2), (x2, 0.0, z))
                model.quad("wall", (x, HEIGHT, z), (x2, HEIGHT, z), (x2, HEIGHT, z2), (x, HEIGHT, z2))
                furnish(model, x, z, chance)


def main(side, folder, sealed=0):
    with open(os.path.join(folder, "rooms.mtl"), "w") as file:
        for name, color in (("wall", "0.7 0.7 0.7"), ("floor", "0.5 0.4 0.3"), ("screen", "0.3 0.5 0.6"),
                            ("cupboard", "0.6 0.4 0.2"), ("lamp", "0.1 0.1 0.1")):
            file.write(f"newmtl {name}\nKd {color}\n")
            if name == "lamp":
                file.write("Ke 8 8 8\n")
    model = Model()
    build(model, side, sealed)
    model.write(os.path.join(folder, "rooms.obj"))
    camera = {"name": "first", "eye": [1.5, 1.6, 1.5], "target": [8.0, 1.2, 8.0], "fov_y_degrees": 60}
    with open(os.path.join(folder, "rooms.json"), "w") as file:
        json.dump({"model": "rooms.obj", "cameras": [camera]}, file)


main(int(sys.argv[1]), sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 0)
