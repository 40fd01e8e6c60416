#!/usr/bin/env bash
# Builds examples/embed-vulkan as a host would, against an installed package: check_embed_vulkan.sh BUILD-FOLDER
# SOURCE-FOLDER. Compares its light, layer by layer, with `octalux render` of the same view, and its two methods with
# each other; the validation layers must report nothing. Exits with 77 without a Vulkan device, or without the tools
# that the example needs to be built.
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$source/examples" -B "$work/examples" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_C_FLAGS="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror" >"$work/configure.txt"
if grep "Without the example" "$work/configure.txt"; then exit 77; fi
cmake --build "$work/examples" --target embed_vulkan

octalux="$work/prefix/bin/octalux" embed="$work/examples/embed-vulkan/embed_vulkan"
cd "$work"
"$octalux" bake builtin:cornell-glossy -o field.olx --radiance-size 128 --bounces 1 \
  --select cage,bricks >/dev/null 2>bake.txt || { cat bake.txt; exit 1; }

code=0
"$embed" field.olx recorded.exr --size 120x90 --validate || code=$?
if [ "$code" = 77 ]; then exit 77; fi # the example has printed the reason
[ "$code" = 0 ] || { echo "embed_vulkan: exit code $code" >&2; exit 1; }
"$embed" field.olx own.exr --size 120x90 --validate --own-shader
"$embed" field.olx picture.png --size 120x90
head -c 4 picture.png | grep -q PNG

# close_to A B LAYER LIMIT: checks that the relative mean squared error is below the limit.
close_to() {
  "$octalux" compare "$1" "$2" --layer "$3" --json >compared.json
  python3 - "$3" "$4" <<'PYTHON'
import json, sys
name, limit = sys.argv[1], float(sys.argv[2])
error = json.load(open("compared.json"))["layers"][name]["relative_mse"]
print(f"{name}: relative MSE {error:.3g}, limit {limit:g}")
sys.exit(0 if error < limit else 1)
PYTHON
}

# The tolerance allows for albedo and roughness in 8 bits in the host's G-buffer, and for its own samples of direct
# light.
"$octalux" render builtin:cornell-glossy --field field.olx -o render.exr --size 120x90 --centered --spp 1 --glossy-samples 16 \
  >/dev/null 2>&1
close_to recorded.exr render.exr indirect_diffuse 1e-3
close_to recorded.exr render.exr indirect_glossy 1e-3
close_to recorded.exr render.exr beauty 1e-3
# Irradiance computed in the host's shader equals that of the recorded pass, except for half floats in that pass's
# image, and for positions, which one interpolates and the other reconstructs from depth.
close_to own.exr recorded.exr beauty 1e-7
close_to own.exr recorded.exr indirect_glossy 1e-12

"$embed" picture.png none.png --size 8x8 2>refused.txt && { echo "a picture passed for a field" >&2; exit 1; }
grep "embed_vulkan: .*picture.png" refused.txt
