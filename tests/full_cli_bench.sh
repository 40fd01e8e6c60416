# Wang's experiments, small: tables as text, and the probe sets that are compared unless some are named.
source "$(dirname "$0")/cli/expect.sh"
OCTALUX=$OCTALUX_BENCH
scenes=(--scenes "$OCTALUX_SOURCE_DIR/scenes")
small=(--quick --size 32x24 --spp 4 --field-spp 1 --texels 32)

expect 0 wang "${scenes[@]}" "${small[@]}" --progress
grep -q "^| 2x2x2 grid, 32^2 | two-level | cage |" stdout.txt || fail "no row of the grid"
grep -q "cornell-glossy: timing" stderr.txt || fail "no progress"

expect_json 'o["experiment"] == "wang-probes" and min(s["against_best_grid"] for s in o["scenes"][0]["sets"][:2]) == 1
  and len(o["scenes"][0]["sets"]) == 8 and all(0 <= s["unseen"] <= 1 and len(s["cameras"]) == 2
    for s in o["scenes"][0]["sets"])' wang-probes "${scenes[@]}" "${small[@]}"
finish
