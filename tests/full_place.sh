# Every method places probes where they may be in the scenes that PLACED names, according to a check that shares no code
# with placement; the probes of the method cover see as much as docs/studies/placement.md says. Models are searched for
# in OCTALUX_SCENES, or in ../shared/scenes beside the checkout. Both optimizers move probes in the scenes that
# OPTIMIZED names; soak_place.sh takes all scenes for both.
set -euo pipefail
export OCTALUX_SCENES=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
scenes=${PLACED:-cornell sponza kitchen pandora}
optimized=${OPTIMIZED:-cornell}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

for name in $scenes; do
  scene=$OCTALUX_SOURCE_DIR/scenes/$name.json
  [ -e "$scene" ] || scene=builtin:$name
  if ! "$OCTALUX" scene "$scene" >/dev/null 2>"$work/scene.log"; then
    grep -q 'not found\|cannot open\|No such file' "$work/scene.log" || { cat "$work/scene.log"; exit 1; }
    echo "$name: skipped"
    continue
  fi
  sets=() shares=() clearances=()
  for method in sdf medial cover; do
    # `told` is the least coverage that the report may state, and `covered` the least that the check may find. The
    # method cover reaches 99.9 % (docs/studies/placement.md). The skeletons' methods place one probe for each cluster,
    # whatever these probes see: nine by sdf in Sponza 78 %, fourteen in pandora 91 %; in other scenes they see 98.6 %
    # and more. The check's ball finds the way out of pandora, to regions that no probe has to see.
    told=0.98
    [ $name = pandora ] && told=0.9
    [ $name = sponza ] && told=0.76
    [ $method = cover ] && told=0.995
    covered=$told
    [ $name = pandora ] && covered=0.38
    [ $name = pandora ] && [ $method = cover ] && covered=0.42
    # The clearance is half a voxel: half of 1/160 of the longest side, and in pandora, whose diagonal is 219 m, half of
    # 0.25 m in the tiles of cover.
    clearance=0.0009
    [ $name = pandora ] && [ $method = cover ] && clearance=0.0005
    ways=none
    [[ " $optimized " != *" $name "* ]] || ways="none gradient gibbs"
    for optimize in $ways; do
      what="count > 0 and buried == 0 and coverage > $told"
      [ $optimize = none ] || what="$what and reward_after >= reward_before"
      "$OCTALUX" place "$scene" -o "$work/$method-$optimize.json" --method $method --optimize $optimize --json 2>/dev/null |
        holds "$what" || { echo "$name $method $optimize"; exit 1; }
      sets+=("$work/$method-$optimize.json") shares+=($covered) clearances+=($clearance)
    done
  done
  "$OCTALUX_BENCH" placement-check "$scene" 20000 "${sets[@]}" 2>/dev/null >"$work/checked"
  [ "$(wc -l <"$work/checked")" -eq ${#sets[@]} ]
  for i in "${!sets[@]}"; do
    sed -n $((i + 1))p "$work/checked" | holds "reached == 1 and outside == 0 and nearest > ${clearances[i]} and covered > ${shares[i]}" ||
      { echo "$name ${sets[i]##*/}"; exit 1; }
  done
  echo "$name: fine"
done

# Compares held-out rays of the program with those of the check. The limit of twenty seconds on two processors is
# measured in processor time, which other tests running beside this one do not lengthen.
scene=$OCTALUX_SOURCE_DIR/scenes/sponza.json
"$OCTALUX" scene "$scene" >/dev/null 2>&1 || { echo "no sponza in $OCTALUX_SCENES"; exit 77; }
while read -r share options; do
  TIMEFORMAT=%U
  { time "$OCTALUX" place "$scene" -o "$work/probes.json" $options --json >"$work/report.json" 2>/dev/null; } 2>"$work/processor"
  holds "coverage >= $share and count <= 96 and $(cat "$work/processor") / 2 <= 20" <"$work/report.json"
  "$OCTALUX_BENCH" placement-check "$scene" 400000 "$work/probes.json" 2>/dev/null | holds "covered >= $share - 0.0003"
  echo "sponza: $options covers $share"
done <<COUNTS
${SPONZA_COUNTS:-0.996 --count 32}
0.999 --coverage 0.999
COUNTS
