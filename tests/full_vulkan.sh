# Compares the living room's picture from a Vulkan device with the CPU's: relative MSE below 1e-3 in each layer. Models
# are searched for in OCTALUX_SCENES, or in ../shared/scenes.
set -euo pipefail
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
description=$OCTALUX_SOURCE_DIR/scenes/living-room.json
"$OCTALUX" scene "$description" >/dev/null 2>&1 || { echo "no living room in $OCTALUX_SCENES"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

# With 16 rays a pixel, the few rays that read another texel at an edge, because positions are reconstructed from a
# depth image, average out.
view=(--field "$work/field.olx" --size 160x90)
"$OCTALUX" bake "$description" -o "$work/field.olx" --grid 4x4x4 --radiance-size 256 --irradiance-size 64 --bounces 1 --noise 0.3 \
  --select cage,bricks 2>/dev/null
compare_devices() {
  "$OCTALUX" render "$description" -o "$work/cpu.exr" "${view[@]}" "$@" --centered 2>/dev/null
  "$OCTALUX" render "$description" -o "$work/vulkan.exr" "${view[@]}" "$@" --device vulkan 2>"$work/messages.txt" || {
    cat "$work/messages.txt"
    grep -qE "no Vulkan|without the Vulkan runtime" "$work/messages.txt" && exit 77
    exit 1
  }
  for layer in beauty indirect_diffuse indirect_glossy; do
    "$OCTALUX" compare "$work/vulkan.exr" "$work/cpu.exr" --layer $layer --json | holds "layers['$layer']['relative_mse'] < 1e-3"
  done
}
compare_devices --spp 4 --glossy-samples 4 --select cage
compare_devices --spp 4 --glossy-samples 4 --select bricks
compare_devices --mode gather --gather-samples 16
compare_devices --mode denoised --frames 24
compare_devices --mode denoised --frames 25 --from-camera window --cut 24
echo "fine"
