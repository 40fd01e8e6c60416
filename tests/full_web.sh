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

"$OCTALUX" bake builtin:cornell-glossy -o "$work/field.olx" --radiance-size 128 >/dev/null
"$OCTALUX" export web builtin:cornell-glossy --field "$work/field.olx" -o "$work/room"
"$OCTALUX" render builtin:cornell-glossy --field "$work/field.olx" --size 640x360 --spp 1 --glossy-samples 4 --centered -o "$work/render.exr" >/dev/null
python3 "$source_dir/tests/drive_web.py" "$work/room" "$work"

# agree PAGE.exr: checks that the page's pixels agree with those of octalux render for the same rays.
agree() {
  python3 "$source_dir/tests/compare_web.py" "$1" "$work/render.exr" --most-error 5e-4
}
agree "$work/page.exr"

# The decoder in WebAssembly gives the same light to devices without textures of blocks.
mkdir "$work/texels"
python3 "$source_dir/tests/drive_web.py" "$work/room" "$work/texels" --no-blocks --light-only
agree "$work/texels/page.exr"

# The page's own code is small beside three.js.
ours=$(cd "$work/room" && cat $(ls | grep -vE '^(three|GLTFLoader|BufferGeometryUtils|SkeletonUtils|scene|field\.olx)') | gzip -9 | wc -c)
echo "our code: $ours bytes compressed"
[ "$ours" -le 300000 ]
