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
most_error=5e-4

"$OCTALUX" bake builtin:cornell-glossy -o "$work/field.olx" --radiance-size 128 >/dev/null
"$OCTALUX" export web builtin:cornell-glossy --field "$work/field.olx" -o "$work/room"
"$OCTALUX" render builtin:cornell-glossy --field "$work/field.olx" --size 640x360 --spp 1 --glossy-samples 4 --centered -o "$work/render.exr" >/dev/null
python3 "$source_dir/tests/drive_web.py" "$work/room" "$work"

# within LAYER: checks that the page's pixels agree with those of octalux render for the same rays.
within() {
  "$OCTALUX" compare "$work/page.exr" "$work/render.exr" --layer "$1" --json >"$work/compare.json"
  python3 -c '
import json, sys
layer = json.load(open(sys.argv[1]))["layers"][sys.argv[2]]
print(sys.argv[2], "relative MSE", layer["relative_mse"])
sys.exit(not layer["relative_mse"] <= float(sys.argv[3]))' "$work/compare.json" "$1" "$most_error"
}
within indirect_diffuse
within indirect_glossy

# The decoder in WebAssembly gives the same light to devices without textures of blocks.
mkdir "$work/texels"
python3 "$source_dir/tests/drive_web.py" "$work/room" "$work/texels" --no-blocks --light-only
cp "$work/texels/page.exr" "$work/page.exr"
within indirect_diffuse
within indirect_glossy

# The page's own code is small beside three.js.
ours=$(cd "$work/room" && cat $(ls | grep -vE '^(three|GLTFLoader|BufferGeometryUtils|SkeletonUtils|scene|field\.olx)') | gzip -9 | wc -c)
echo "our code: $ours bytes compressed"
[ "$ours" -le 300000 ]
