# Wang's experiments, small: what they print, and that nothing of them is left. Tables as text are full_cli_bench.sh.
source "$(dirname "$0")/cli/expect.sh"
octalux=$OCTALUX
OCTALUX=$OCTALUX_BENCH
export TMPDIR=$PWD/temporary
mkdir temporary pictures
scenes=(--scenes "$OCTALUX_SOURCE_DIR/scenes")
small=(--quick --size 32x24 --spp 4 --field-spp 1 --texels 32)

expect_json 'o["experiment"] == "wang" and [s["scene"] for s in o["scenes"]] == ["cornell-glossy"]
  and o["scenes"][0]["cameras"] == ["between", "front"]
  and all(r["ms"] > 0 and r["steps_mean"] > 1 and r["probes_mean"] >= 1 and 0 <= r["unresolved"] < 1
    and r["glossy"]["relative_mse"] < 2 and {"mse", "noise", "bias"} <= set(r["final"]) for r in o["scenes"][0]["rows"])
  and o["scenes"][0]["rows"][0]["speedup"] == 1 and o["scenes"][0]["rows"][0]["select"] == "cage"
  and {r["probes"] for r in o["scenes"][0]["rows"]} == {7, 8}
  and all(m["probes"] * 32 * 32 <= m["geometry"] and m["distance"] == 0 and m["maps"] > m["radiance"] + m["irradiance"]
    and (m["probes"] == 8) == (m["octree"] == 0) and m["bricks"] > 0
    for m in o["scenes"][0]["memory"])' wang "${scenes[@]}" "${small[@]}" -o pictures
[ -s pictures/cornell-glossy-front-path-beauty.png ] || fail "no picture of the reference"
[ -s pictures/cornell-glossy-between-2x2x2_grid,_32_2_cage-indirect_glossy.png ] || fail "no picture from the grid"
for n in 3 5; do "$octalux" place builtin:cornell-glossy -o $n.json --count $n --candidates 100 --surfels 500 --voxels 48 >stdout.txt; done
expect_json '[s["name"] for s in o["scenes"][0]["sets"]] == ["2x1x2 grid, 32^2", "3.json, 32^2", "5.json, 64^2"]
  and [s["probes"] for s in o["scenes"][0]["sets"]] == [4, 3, 5] and o["scenes"][0]["sets"][0]["against_best_grid"] == 1' \
  wang-probes "${scenes[@]}" "${small[@]}" --probes 2x1x2,3.json,5.json@1024
expect 1 wang-probes "${scenes[@]}" "${small[@]}" --probes nowhere.json
grep -q "nowhere.json: cannot open" stderr.txt || fail "no word of the missing set"
[ -z "$(ls -A temporary)" ] || fail "temporary fields are left"

expect_usage "is not one of cornell-glossy|temple|sponza" wang --scene atlantis

expect_usage "unknown option '--grid'" wang --grid 2x2x2
expect_failure "nowhere/cornell-wang.json" wang --scene cornell-glossy --scenes nowhere
TMPDIR=$PWD/nowhere expect_failure "cannot create a temporary folder" wang --quick

# A stop on the way leaves nothing either.
"$OCTALUX" wang "${scenes[@]}" --scene cornell-glossy --progress >stdout.txt 2>stderr.txt &
await $! "cornell-glossy: "
kill -TERM $!
wait $!
[ $? = 143 ] || fail "a stopped experiment does not say by its exit code what stopped it"
grep -q "interrupted" stderr.txt || fail "a stopped experiment does not say so"
[ -z "$(ls -A temporary)" ] || fail "a stopped experiment leaves fields"

finish
