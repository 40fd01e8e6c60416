#!/usr/bin/env bash
# A picture from a baked field beside the path-traced one, of a built-in scene: demo.sh PROGRAM FOLDER.
set -euo pipefail
program=$1 out=$2 scene=builtin:cornell-glossy
mkdir -p "$out"

"$program" bake "$scene" -o "$out/demo.olx" --radiance-size 256 --irradiance-size 32
"$program" render "$scene" -o "$out/field.exr" --method field --field "$out/demo.olx" --size 512x512 --spp 16
"$program" render "$scene" -o "$out/demo.png" --method field --field "$out/demo.olx" --size 512x512 --spp 16
"$program" render "$scene" -o "$out/path.exr" --method path --size 512x512 --spp 64 --bounces 4
"$program" compare "$out/field.exr" "$out/path.exr" --heatmap "$out/difference.png"

echo
echo "The field's picture:        $out/demo.png"
echo "Field against path tracing: $out/difference.png"
