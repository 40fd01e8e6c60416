# octalux-bench: names, options, and findings as text, JSON, pictures and a report.
source "$(dirname "$0")/cli/expect.sh"
OCTALUX=$OCTALUX_BENCH
export TMPDIR=$PWD/temporary
mkdir temporary
small=(--quick --size 24x16 --spp 2)

expect_usage "unknown experiment 'table9': there are all, .*mcguire-leaks, .*wang-probes, speed" table9
expect_usage "unknown experiment 'table9': there are all" wang-table2,table9
expect_usage "unknown experiment '': there are all" wang-table2,
expect_usage "unknown option '--grid'" mcguire-resolution --grid 2x2x2
expect_usage "unknown scene 'atlantis': surfaces has two-rooms-sealed, .*sponza" surfaces --only furnace,atlantis
expect_usage "unknown scene '': surfaces has" surfaces --only furnace,
expect_usage "unknown scene 'fur': surfaces has" surfaces --only fur
expect_usage "--only goes with .*surfaces" mcguire-resolution --only furnace
expect_usage "--only goes with .*surfaces" all --only furnace
expect_usage "--only goes with .*surfaces" surfaces,relight --only furnace
expect_usage "is not a size" mcguire-resolution --size 8
expect_failure "nowhere/of/index.html: cannot write" mcguire-resolution --report nowhere/of
expect_failure "nowhere/of/image.png: cannot write" mcguire-resolution --images nowhere/of
TMPDIR=$PWD/nowhere expect_failure "cannot create a temporary folder" mcguire-resolution --quick

expect_json 'o["experiment"] == "mcguire-resolution" and o["source"].startswith("McGuire")
  and o["command"] == "octalux-bench mcguire-resolution --quick --size 24x16 --spp 2" and o["seconds"] > 0
  and [s["what"] for s in o["skipped"]] == ["living-room"] and len(o["tables"]) == 1
  and [r["texels"] for r in o["tables"][0]["rows"]] == ["16\u00b2", "64\u00b2", "256\u00b2"]
  and all({c["key"] for c in o["tables"][0]["columns"]} == set(r) and r["diffuse_relative_mse"] is not None
    and r["bake_s"] > 0 and 0 <= r["unresolved"] <= 1 for r in o["tables"][0]["rows"])
  and {c["key"]: c["kind"] for c in o["tables"][0]["columns"]}["bake_s"] == "time"' \
  mcguire-resolution "${small[@]}" --report report --images images
grep -q 'octalux-bench mcguire-resolution --quick --size 24x16 --spp 2' report/index.html || fail "no command in the report"
for way in 2x2x2__256__ path 2x2x2__16__; do
  [ -s "images/mcguire-resolution-cornell-glossy__front-$way-indirect_glossy.png" ] || fail "no picture of $way"
done
[ -z "$(ls -A temporary)" ] || fail "temporary fields are left"

# Several experiments run in the order of their list, into one object and one report. Numbers are the same from any
# number of threads, and beside other experiments.
expect 0 mcguire-single-probe "${small[@]}" --threads 1 --json
cp stdout.txt one.json
expect 0 mcguire-single-probe,mcguire-area-light "${small[@]}" --threads 3 --json --report several
python3 - one.json stdout.txt <<'PYTHON' || fail "numbers depend on the threads, or on other experiments"
import json, sys
one, several = (json.load(open(path)) for path in sys.argv[1:])
assert [e["experiment"] for e in several["experiments"]] == ["mcguire-area-light", "mcguire-single-probe"]
assert all(e["tables"][0]["rows"] for e in several["experiments"])
def qualities(experiment):
    table = experiment["tables"][0]
    keys = [c["key"] for c in table["columns"] if c["kind"] != "time"]
    return [[row[key] for key in keys] for row in table["rows"]]
sys.exit(qualities(one) != qualities(several["experiments"][1]))
PYTHON
for name in mcguire-area-light mcguire-single-probe; do
  grep -q "octalux-bench $name --quick" several/index.html || fail "$name is not in the report"
done
expect 0 surfaces "${small[@]}" --only parlour,sponza --progress
grep -q "^| parlour " stdout.txt || fail "no row of the parlour"
grep -q "^Left out: sponza: --quick" stdout.txt || fail "no word of what is left out"
grep -q "surfaces: path tracing" stderr.txt || fail "no progress"

# --only takes one scene, and reports a scene that a quick run leaves out.
expect_json 'o["command"].endswith("--spp 2 --only parlour,sponza") and [s["what"] for s in o["skipped"]] == ["sponza"]
  and {t["name"]: sorted({r["scene"] for r in t["rows"]}) for t in o["tables"] if t["rows"]} == {"modes": ["parlour"]}' \
  surfaces "${small[@]}" --only parlour,sponza

# --probes takes one set of a scene's probes.
expect_json '{t["name"]: [r["probes"] for r in t["rows"]] for t in o["tables"] if t["rows"]} == {"leaks": ["grid"]}' \
  surfaces "${small[@]}" --only two-rooms-sealed --probes grid
expect_usage "unknown probes 'lattice': surfaces has placed, grid" surfaces --probes lattice

# A run that is stopped leaves no files behind.
expect_experiment_stops mcguire-leaks --quick --spp 100000

finish
