# Wang's experiments at a small size: their findings, and that no files are left behind. full_cli_bench.sh tests tables
# as text.
source "$(dirname "$0")/cli/expect.sh"
octalux=$OCTALUX
OCTALUX=$OCTALUX_BENCH
export TMPDIR=$PWD/temporary
mkdir temporary
scenes=(--scenes "$OCTALUX_SOURCE_DIR/scenes")
small=(--quick --size 32x24 --spp 4 --field-spp 1 --texels 32)

expect_json '(lambda rows, memory: o["experiment"] == "wang" and {r["scene"] for r in rows} == {"cornell-glossy"}
  and [s["what"] for s in o["skipped"]] == ["temple", "sponza"]
  and all(r["ms"] > 0 and r["steps"] > 1 and r["tried"] >= 1 and 0 <= r["unresolved"] < 1
    and r["glossy_relative_mse"] < 2 and r["noise"] > 0 and r["final_mse"] is not None for r in rows)
  and rows[0]["speedup"] == 1 and rows[0]["select"] == "cage"
  and {m["count"] for m in memory} == {7, 8}
  and all(abs(2 ** 20 * (m["geometry"] + m["light"]) / (m["count"] * 32 * 32) - m["texel_bytes"]) < 0.001
    and 1 < m["texel_bytes"] < 14 and m["irradiance"] > 0 and m["maps"] > m["geometry"] + m["light"] + m["irradiance"]
    and (m["count"] == 8) == (m["octree"] == 0) and m["bricks"] > 0 for m in memory))(
  *[next(t["rows"] for t in o["tables"] if t["name"] == name) for name in ("rows", "memory")])' \
  wang "${scenes[@]}" "${small[@]}" --images pictures
[ -s pictures/wang-cornell-glossy__front-path-beauty.png ] || fail "no picture of the reference"
[ -s pictures/wang-cornell-glossy__between-2x2x2_grid__cage-indirect_glossy.png ] || fail "no picture from the grid"
for n in 3 5; do "$octalux" place builtin:cornell-glossy -o $n.json --count $n --candidates 100 --surfels 500 --voxels 48 >stdout.txt; done
expect_json '(lambda sets, cameras: [s["set"] for s in sets] == ["2x1x2 grid, 32^2", "3.json, 32^2", "5.json, 64^2"]
  and [s["probes"] for s in sets] == [4, 3, 5] and sets[0]["over_grid"] == 1
  and [c["camera"] for c in cameras] == 3 * ["between", "front"])(*[t["rows"] for t in o["tables"]])' \
  wang-probes "${scenes[@]}" "${small[@]}" --probes 2x1x2,3.json,5.json@1024
expect 1 wang-probes "${scenes[@]}" "${small[@]}" --probes nowhere.json
grep -q "nowhere.json: cannot open" stderr.txt || fail "no word of the missing set"
[ -z "$(ls -A temporary)" ] || fail "temporary fields are left"

expect_usage "unknown scene 'atlantis': wang has cornell-glossy, temple, sponza" wang --only atlantis
expect_usage "--probes goes with surfaces, wang-probes" wang --probes 2x2x2
expect_usage "--short goes with wang" wang-probes --short
expect_usage "--texels goes with wang-table1, wang-table2, wang-quality, wang, wang-probes" all --texels 64
expect_usage "unknown option '--grid'" wang --grid 2x2x2
expect 0 wang --only cornell-glossy --scenes nowhere
grep -q "wang: cornell-wang is left out: nowhere/cornell-wang.json" stderr.txt || fail "no word of the missing scene"
TMPDIR=$PWD/nowhere expect_failure "cannot create a temporary folder" wang --quick

# A run that is stopped leaves no files behind either.
expect_experiment_stops wang "${scenes[@]}" --only cornell-glossy

finish
