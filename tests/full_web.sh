#!/usr/bin/env bash
# The exported page in headless Chromium, on its software renderer: it loads, its tools work, and its light agrees with
# that of `octalux render`.
set -euo pipefail
source_dir=${OCTALUX_SOURCE_DIR:?}
command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null ||
  { echo "skipped: no Chromium (scripts/install-packages.sh full)"; exit 77; }
[ -e "$(dirname "$OCTALUX")/web/index.html" ] || { echo "skipped: this build has no page of export web"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A ball of few triangles with smooth normals, about which many reflections would lead into it.
python3 - "$work" <<'BALL'
import math, sys
rings, sides, lines = 6, 10, ["mtllib ball.mtl", "usemtl ball"]
for i in range(rings + 1):
    for k in range(sides):
        a, b = math.pi * i / rings, 2 * math.pi * k / sides
        n = math.sin(a) * math.cos(b), math.cos(a), math.sin(a) * math.sin(b)
        lines += ["v %.6f %.6f %.6f" % tuple(0.12 * x for x in n), "vn %.6f %.6f %.6f" % n]
for i in range(rings):
    for k in range(sides):
        p, q = i * sides + k + 1, i * sides + (k + 1) % sides + 1
        lines.append("f " + " ".join("%d//%d" % (v, v) for v in (p, q, q + sides, p + sides)))
open(sys.argv[1] + "/ball.obj", "w").write("\n".join(lines) + "\n")
open(sys.argv[1] + "/ball.mtl", "w").write("newmtl ball\nKd 0.8 0.7 0.4\nPm 1\nPr 0.3\n")
open(sys.argv[1] + "/room.json", "w").write(
    '{"model": "builtin:cornell-glossy", "models": [{"path": "ball.obj", "scale": 0.6, "translate": [0.3, 0.4, 0.2]}]}')
BALL
# The limit on the page's time is for the probes of this grid; the few that a bake would place make reflections slower.
"$OCTALUX" bake "$work/room.json" -o "$work/field.olx" --grid 4x4x4 --radiance-size 128 --noise 0.2 >/dev/null
"$OCTALUX" export web "$work/room.json" --field "$work/field.olx" -o "$work/room"
"$OCTALUX" render "$work/room.json" --field "$work/field.olx" --size 640x360 --spp 1 --glossy-samples 4 --centered -o "$work/render.exr" >/dev/null

# yardstick: prints the processor seconds of a picture of the room by octalux render.
yardstick() {
  local TIMEFORMAT='%U %S'
  { time "$OCTALUX" render "$work/room.json" --field "$work/field.olx" --size 640x360 --spp 8 --glossy-samples 4 --centered \
      --quiet -o "$work/yardstick.exr" >/dev/null 2>&1; } 2>&1 | awk '{ print $1 + $2 }'
}

# show FOLDER [OPTIONS]: shows the page, and compares its processor time with that of the same room rendered before and
# after it, because both grow where the processors are slow or shared.
show() {
  local before after
  before=$(yardstick)
  python3 "$source_dir/tests/drive_web.py" "$work/room" "$@" --processor 120
  after=$(yardstick)
  python3 - "$1/times.json" "$before" "$after" <<'TIME'
import json, sys
seconds, yardstick = json.load(open(sys.argv[1]))["processor_seconds"], (float(sys.argv[2]) + float(sys.argv[3])) / 2
print("all light is there after %.2f times a picture's %.2f seconds of processor time" % (seconds / yardstick, yardstick))
sys.exit(seconds > 9 * yardstick)
TIME
}

show "$work"

# agree PAGE.exr: checks that the page's pixels agree with those of octalux render for the same rays.
agree() {
  python3 "$source_dir/tests/compare_web.py" "$1" "$work/render.exr" --most-error 5e-4
}
agree "$work/page.exr"

# The decoder in WebAssembly gives the same light to devices without textures of blocks.
mkdir "$work/texels"
show "$work/texels" --no-blocks --light-only
agree "$work/texels/page.exr"

# The page's own code is small beside three.js.
ours=$(cd "$work/room" && cat $(ls | grep -vE '^(three|GLTFLoader|BufferGeometryUtils|SkeletonUtils|scene|field\.olx)') | gzip -9 | wc -c)
echo "our code: $ours bytes compressed"
[ "$ours" -le 300000 ]
