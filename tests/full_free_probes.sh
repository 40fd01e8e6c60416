# Free probes, found by bricks, with maps of 512^2: rays that stay unresolved or end in the wrong place are as few as
# docs/studies/rays.md says, on Sponza and in the temple. Models are looked for in OCTALUX_SCENES, or in
# ../shared/scenes.
set -euo pipefail
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
sponza=$OCTALUX_SOURCE_DIR/scenes/sponza.json
"$OCTALUX" scene "$sponza" >/dev/null 2>&1 || { echo "no Sponza in $OCTALUX_SCENES"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

# Rays meet distances and normals alone: light is baked as cheaply as can be.
dark="--radiance-size 512 --samples 1 --bounces 0 --no-fit --irradiance-size 8 --irradiance-grid 1x1x1 --light reference --reference-paths 1"

# SCENE COUNT UNRESOLVED WRONG PROBES: shares of rays, and how many probes one asks.
hold_rays() {
  "$OCTALUX" place "$1" --method cover --count "$2" -o "$work/probes.json" >/dev/null 2>&1
  "$OCTALUX" bake "$1" -o "$work/field.olx" --probes "$work/probes.json" $dark >/dev/null 2>&1
  "$OCTALUX" info "$work/field.olx" --json |
    holds 'select == "bricks" and bytes["selector"] <= min(4e6, 0.04 * file_bytes)'
  "$OCTALUX" audit "$1" --field "$work/field.olx" --points 0 --json 2>/dev/null |
    holds "rays['count'] > 190000 and rays['unresolved'] <= $3 and rays['wrong'] <= $4 and rays['probes_mean'] < $5"
}
# More in the temple, 1.77: each of its sixteen probes sees a part only, and the list of where a ray begins cannot know
# who sees its end.
hold_rays builtin:temple 16 0.01 0.03 1.85
hold_rays "$sponza" 32 0.02 0.04 1.5
hold_rays "$sponza" 64 0.01 0.03 1.5
echo "fine"
