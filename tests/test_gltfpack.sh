# Models packed by gltfpack render to the same picture as the originals: quantised (KHR_mesh_quantization,
# KHR_texture_transform), and compressed (-c: EXT_meshopt_compression), also beside a fallback for readers that cannot
# decompress (-cf). Albedo, normals and depth are compared, since they have no noise: gltfpack keeps positions to 14
# bits, texture coordinates to 12 and normals to 8, that is to 0.008, and contours move by a part of a pixel. Skipped
# without gltfpack (Debian: gltfpack) or the models (OCTALUX_SCENES).
set -euo pipefail
command -v gltfpack >/dev/null || { echo "skipped: gltfpack is not here"; exit 77; }
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
scenes=${OCTALUX_SCENES%%:*}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

# draw MODEL PICTURE: renders the model into the picture.
draw() { "$OCTALUX" render "$1" -o "$2" --method path --bounces 0 --size 160x90 --spp 16 >/dev/null 2>&1; }

# check MODEL OPTIONS...: packs the model with these options, and compares its picture with plain.exr.
check() {
  local packed=$1
  shift
  gltfpack -i "$model" -o "$packed" "$@" >/dev/null
  rm -f "${packed%.*}.fallback.bin" # readers that can decompress need no fallback
  draw "$packed" "$work/packed.exr"
  for limit in albedo:1e-3 normal:2e-4 depth:1e-5; do
    "$OCTALUX" compare "$work/packed.exr" "$work/plain.exr" --layer "${limit%:*}" --json |
      holds "layers['${limit%:*}']['relative_mse'] < ${limit#*:}" || { echo "$(basename "$packed"): ${limit%:*} differs"; exit 1; }
  done
}

count=0
for name in veach-ajar/veach-ajar godot-rooms/rooms-3x1; do
  [ -r "$scenes/$name.gltf" ] || { echo "$name: skipped: not in $scenes"; continue; }
  cp -rL "$scenes/$(dirname "$name")" "$work/model"
  chmod -R u+w "$work/model"
  model=$work/model/$(basename "$name").gltf
  draw "$model" "$work/plain.exr"
  check "$work/model/quantised.gltf"
  check "$work/model/compressed.glb" -c
  check "$work/model/fallback.gltf" -cf
  rm -r "$work/model"
  echo "$name: fine"
  count=$((count + 1))
done
[ "$count" -gt 0 ] || exit 77
