"""What the guides tell their readers to type, as one script: the blocks of docs/guide/*.md that are named on the command line, in order.

Blocks of `sh` become commands; a block of `json FILE` becomes that file. A room of its own takes the place of the reader's model.
"""
import json
import re
import struct
import sys

# Smaller pictures, fewer probes and more noise than the guides' commands ask for, so that these take less time.
QUICKER = {"--size 320x180": "--size 160x90", "--budget 10": "--budget 2",
           "bake room.json --probes probes.json -o room.olx": "bake room.json --probes probes.json -o room.olx --noise 0.05"}
BLOCK = re.compile(r"^```(sh|json (\S+))\n(.*?)^```$", re.S | re.M)


def write_room(path):
    """A room of 4 m by 4 m, 2.5 m high, with a box in it; the faces of the room are turned inwards."""
    positions, normals, indices = [], [], []

    def add_box(low, high, inwards):
        for axis in range(3):
            for side in (0, 1):
                normal = [0.0, 0.0, 0.0]
                normal[axis] = (1.0 if side else -1.0) * (-1.0 if inwards else 1.0)
                u, v = (axis + 1) % 3, (axis + 2) % 3
                first = len(positions)
                for corner in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    place = [0.0, 0.0, 0.0]
                    place[axis] = (low, high)[side][axis]
                    place[u], place[v] = (low, high)[corner[0]][u], (low, high)[corner[1]][v]
                    positions.append(place)
                    normals.append(normal)
                turned = (side == 1) == inwards
                for triangle in ((0, 2, 1), (0, 3, 2)) if turned else ((0, 1, 2), (0, 2, 3)):
                    indices.extend(first + i for i in triangle)

    add_box([-2, 0, -2], [2, 2.5, 2], True)
    add_box([-1.2, 0, -1.2], [-0.4, 0.9, -0.4], False)
    data = b"".join(struct.pack("<3f", *p) for p in positions + normals) + struct.pack("<%dH" % len(indices), *indices)
    size = 12 * len(positions)
    with open(path.replace(".gltf", ".bin"), "wb") as out:
        out.write(data)
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
            "materials": [{"name": "plaster", "pbrMetallicRoughness": {
                "baseColorFactor": [0.7, 0.65, 0.6, 1], "metallicFactor": 0, "roughnessFactor": 0.6}}],
            "buffers": [{"uri": path.replace(".gltf", ".bin"), "byteLength": len(data)}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": size},
                            {"buffer": 0, "byteOffset": size, "byteLength": size},
                            {"buffer": 0, "byteOffset": 2 * size, "byteLength": len(data) - 2 * size}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
                           "min": [-2, 0, -2], "max": [2, 2.5, 2]},
                          {"bufferView": 1, "componentType": 5126, "count": len(normals), "type": "VEC3"},
                          {"bufferView": 2, "componentType": 5123, "count": len(indices), "type": "SCALAR"}]}
    with open(path, "w") as out:
        json.dump(gltf, out)


def main():
    write_room("room.gltf")
    print("set -euxo pipefail")
    slow = set(QUICKER)
    for page in sys.argv[1:]:
        with open(page, encoding="utf-8") as text:
            blocks = BLOCK.findall(text.read())
        for kind, name, body in blocks:
            if kind == "sh":
                slow -= {words for words in slow if words in body}
                for words, quicker in QUICKER.items():
                    body = body.replace(words, quicker)
                print(body)
                continue
            with open(name, "w") as out:
                out.write(body)
    if slow:
        sys.exit("the guides no longer say: " + ", ".join(sorted(slow)))


main()
