#!/usr/bin/env bash
# The exported page of the living room on probes of 256^2 in headless Chromium: what it loads, with reflections and
# without, that its light agrees with that of `octalux render`, with the extensions for textures of blocks and without,
# and that rays find what they look for. Then the examples of the npm package.
set -euo pipefail
source_dir=${OCTALUX_SOURCE_DIR:?}
command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null ||
  { echo "skipped: no Chromium (scripts/install-packages.sh full)"; exit 77; }
[ -e "$(dirname "$OCTALUX")/web/index.html" ] || { echo "skipped: this build has no page of export web"; exit 77; }
export OCTALUX_SCENES=${OCTALUX_SCENES:-$source_dir/../shared/scenes}
room=$source_dir/scenes/living-room.json
"$OCTALUX" scene "$room" >/dev/null 2>&1 || { echo "skipped: no living room in $OCTALUX_SCENES"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
drive() { python3 "$source_dir/tests/drive_web.py" "$@"; }

"$OCTALUX" bake "$room" -o "$work/field.olx" --radiance-size 256 --noise 0.1 --quiet
"$OCTALUX" render "$room" --field "$work/field.olx" --size 640x360 --spp 1 --glossy-samples 4 --centered -o "$work/render.exr" --quiet
"$OCTALUX" export web "$room" --field "$work/field.olx" -o "$work/room" --quiet
[ "$(stat -c %s "$work/room/scene.glb.gz")" -le 5000000 ] || { echo "FAILED: photographs are not JPEG" >&2; exit 1; }
drive "$work/room" "$work" --megabytes 25 --processor 60
python3 "$source_dir/tests/compare_web.py" "$work/page.exr" "$work/render.exr" --most-error 2e-3

# The decoder in WebAssembly gives the same light to devices without textures of blocks.
mkdir "$work/texels"
drive "$work/room" "$work/texels" --no-blocks --light-only --megabytes 25 --processor 60
python3 "$source_dir/tests/compare_web.py" "$work/texels/page.exr" "$work/render.exr" --most-error 2e-3

# Without reflections the same field is small enough.
"$OCTALUX" export web "$room" --field "$work/field.olx" --no-glossy -o "$work/diffuse" --quiet
drive "$work/diffuse" "$work" --no-glossy --tools-only --megabytes 10 --processor 60

# The examples of the package light a room, without a message on the console.
mkdir "$work/app" "$work/app/node_modules"
cp "$source_dir"/web/examples/*.html "$work/app"
packages=$(dirname "$OCTALUX")/web-packages/node_modules
ln -s "$packages/three" "$work/app/node_modules/three"
mkdir "$work/app/node_modules/octalux"
node "$source_dir/web/build.mjs" "$work/app/node_modules/octalux/dist"
"$OCTALUX" bake builtin:cornell-glossy -o "$work/app/room.olx" --radiance-size 64 --noise 0.2 --quiet
"$OCTALUX" export web builtin:cornell-glossy --field "$work/app/room.olx" -o "$work/box" --quiet
gzip -dc "$work/box/scene.glb.gz" >"$work/app/room.glb"
python3 "$source_dir/tests/drive_examples.py" "$work/app" "$work"
