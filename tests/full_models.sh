# Every model of the real scenes imports to the same numbers of triangles, materials, textures, lights and cameras as
# recorded in the table below. Models are searched for in OCTALUX_SCENES, or in ../shared/scenes beside the checkout.
set -euo pipefail
scenes=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
scenes=${scenes%%:*}
[ -d "$scenes" ] || { echo "no scenes in $scenes"; exit 77; }
found=$(mktemp)
trap 'rm -f "$found"' EXIT

count=0
failed=0
while read -r model expected; do
  [ -r "$scenes/$model" ] || { echo "$model: skipped: not in $scenes"; continue; }
  "$OCTALUX" scene "$scenes/$model" --json >"$found" 2>/dev/null || { echo "$model: FAILED: refused"; failed=1; continue; }
  counts=$(python3 -c 'import json, sys
scene = json.load(sys.stdin)
print(*(scene[k] for k in ("triangles", "materials", "textures", "lights", "cameras")))' <"$found")
  [ "$counts" = "$expected" ] || { echo "$model: FAILED: $counts, expected $expected"; failed=1; }
  count=$((count + 1))
done <<'TABLE'
bathroom/bathroom.gltf 303345 27 7 1 1
bevy-examples/cornell-box-556.glb 36 5 0 1 0
bevy-examples/irradiance-volume-example.glb 32 4 0 0 0
bevy-examples/shed.gltf 360 1 0 1 0
breakfast-room/breakfast-room.gltf 158766 15 3 0 1
cornell-box/CornellBox-Original.obj 36 8 0 1 0
cornell-box/CornellBox-Glossy.obj 1112 8 0 1 0
cornell-box/CornellBox-Sphere.obj 2188 8 0 1 0
fireplace-room/fireplace-room.gltf 97713 17 4 0 1
godot-rooms/room.gltf 63720 2 0 0 0
godot-rooms/rooms-3x1.gltf 6072 3 0 0 0
kitchen/kitchen.gltf 301466 62 11 0 1
living-room/living_room.obj 28656 41 16 1 0
lumen-cornell/occluded.obj 3948 6 0 1 0
pandora/pandora.gltf 60694 11 0 1 0
small-house/small-house.gltf 94823 35 31 0 0
sponza/sponza.gltf 262266 25 24 0 0
staircase/staircase.gltf 213804 23 9 1 1
test-room/test_room.obj 152 2 0 0 0
veach-ajar/veach-ajar.gltf 4484 10 4 1 1
white-room/white-room.gltf 237299 43 13 3 1
TABLE
echo "$count models"
[ "$count" -gt 0 ] || exit 77
exit "$failed"
