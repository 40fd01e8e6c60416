# Wang's experiments at a small size: tables as text, and the probe sets that are compared by default.
source "$(dirname "$0")/cli/expect.sh"
OCTALUX=$OCTALUX_BENCH
scenes=(--scenes "$OCTALUX_SOURCE_DIR/scenes")
small=(--quick --size 32x24 --spp 4 --field-spp 1 --texels 32)

expect 0 wang "${scenes[@]}" "${small[@]}" --progress
grep -q "^| cornell-glossy | 2x2x2 grid  *| two-level | cage  *|" stdout.txt || fail "no row of the grid"
grep -q "wang: timing" stderr.txt || fail "no progress"

expect_json '(lambda sets, cameras: o["experiment"] == "wang-probes" and min(s["over_grid"] for s in sets[:2]) == 1
  and len(sets) == 8 and len(cameras) == 16 and all(0 <= s["unseen"] <= 1 for s in sets))(*[t["rows"] for t in o["tables"]])' \
  wang-probes "${scenes[@]}" "${small[@]}"
finish
