# The living room on 4x4x4 probes of 512^2: rays, irradiance and traced light stay within bounds. Models are searched for
# in OCTALUX_SCENES, or in ../shared/scenes.
set -euo pipefail
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
description=$OCTALUX_SOURCE_DIR/scenes/living-room.json
"$OCTALUX" scene "$description" >/dev/null 2>&1 || { echo "no living room in $OCTALUX_SCENES"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

view=(--camera sofa --size 160x120)
"$OCTALUX" bake "$description" -o "$work/field.olx" --grid 4x4x4 --probe-light --json 2>/dev/null |
  holds 'probes == 64'
"$OCTALUX" audit "$description" --field "$work/field.olx" --camera sofa --points 500 --json 2>/dev/null |
  holds 'rays["count"] == 200000 and rays["unresolved_seen"] <= 0.007 and rays["wrong_seen"] <= 0.02 and rays["unresolved"] <= rays["unseen"] + 0.008'
"$OCTALUX" render "$description" -o "$work/path.exr" --method path --field "$work/field.olx" --spp 256 "${view[@]}" 2>/dev/null
"$OCTALUX" render "$description" -o "$work/irradiance.exr" --field "$work/field.olx" --spp 8 --diffuse irradiance "${view[@]}" 2>/dev/null
"$OCTALUX" compare "$work/irradiance.exr" "$work/path.exr" --layer indirect_diffuse --json |
  holds 'layers["indirect_diffuse"]["relative_mse"] <= 0.10 and abs(layers["indirect_diffuse"]["bias"]) <= 0.10'
"$OCTALUX" render "$description" -o "$work/traced.exr" --field "$work/field.olx" --spp 8 --diffuse traced "${view[@]}" 2>/dev/null
"$OCTALUX" compare "$work/traced.exr" "$work/path.exr" --layer indirect_diffuse --json |
  holds 'layers["indirect_diffuse"]["relative_mse"] <= 0.02'
echo "fine"
