# Every scene description whose model is present passes through every stage at a small size: import, bake, verify,
# render, compare, audit. Models are searched for in OCTALUX_SCENES, or in ../shared/scenes beside the checkout.
set -euo pipefail
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
[ -d "${OCTALUX_SCENES%%:*}" ] || { echo "no scenes in $OCTALUX_SCENES"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

count=0
for description in "$OCTALUX_SOURCE_DIR"/scenes/*.json; do
  name=$(basename "$description" .json)
  # A scene whose model is missing is skipped with a message; any other error fails the test.
  if ! "$OCTALUX" scene "$description" --json >"$work/scene.json" 2>"$work/scene.log"; then
    grep -q 'not found\|cannot open\|No such file' "$work/scene.log" || { cat "$work/scene.log"; exit 1; }
    echo "$name: skipped: $(tail -n 1 "$work/scene.log")"
    continue
  fi
  holds 'triangles > 0 and cameras > 0 and all(a < b for a, b in zip(bounds_min, bounds_max))' <"$work/scene.json"
  "$OCTALUX" bake "$description" -o "$work/field.olx" --grid 3x2x3 --radiance-size 64 --irradiance-size 16 --bounces 1 --noise 0.5 --json 2>/dev/null |
    holds 'probes == 18 and file_bytes > 18 * 66 * 66 * 4' # radiance of probes alone takes as much
  "$OCTALUX" verify "$work/field.olx" >/dev/null
  "$OCTALUX" render "$description" -o "$work/field.exr" --method field --field "$work/field.olx" --size 96x54 --spp 4 2>/dev/null
  "$OCTALUX" render "$description" -o "$work/path.exr" --method path --size 96x54 --spp 16 --bounces 2 2>/dev/null
  "$OCTALUX" compare "$work/field.exr" "$work/path.exr" --json |
    holds 'all(math.isfinite(m["mse"]) and math.isfinite(m["bias"]) for m in layers.values()) and abs(layers["direct"]["bias"]) < 0.5'
  "$OCTALUX" audit "$description" --field "$work/field.olx" --rays 2000 --points 50 --json 2>/dev/null |
    holds 'rays["count"] == 2000 and 0 <= rays["unresolved"] < 1 and math.isfinite(points["relative_mse"])'
  echo "$name: fine"
  count=$((count + 1))
done
[ "$count" -gt 0 ] || exit 77
