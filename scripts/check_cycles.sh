#!/usr/bin/env bash
# Compares Octalux's path tracer with Blender's, layer by layer, on matte surfaces: built-in scenes, and a textured one
# where real scenes are found. Takes some minutes. Exit status 77: Blender is not installed, and nothing was compared.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OCTALUX_SCENES=${OCTALUX_SCENES:-$PWD/../shared/scenes}

compare() {
  echo "$*"
  bench/cycles.py "$@" --compare --matte --bounces 4
}

compare builtin:cornell --size 64x64 --spp 256 --within 0.1
compare builtin:temple --size 64x48 --spp 512 --emitters hit --within 0.3
if build/release/octalux scene scenes/sponza.json >/dev/null 2>&1; then
  compare scenes/sponza.json --size 96x54 --spp 128 --within 0.3
else
  echo "skipped: sponza is not in $OCTALUX_SCENES"
fi
