# Every experiment at its quick size: checks every number against bench_quick.json, and shows the report of all of them
# in headless Chromium. OCTALUX_SCREENSHOTS names a folder for screenshots of it.
source "$(dirname "$0")/cli/expect.sh"
OCTALUX=$OCTALUX_BENCH
tests="$OCTALUX_SOURCE_DIR/tests"
export PYTHONDONTWRITEBYTECODE=1
expect 0 all --quick --scenes "$OCTALUX_SOURCE_DIR/scenes" --report site --json
cp stdout.txt found.json
python3 "$tests/check_bench.py" "$tests/bench_quick.json" found.json >stdout.txt || fail "numbers differ"

if python3 -c "import sys; sys.path.insert(0, '$tests'); import browser; sys.exit(not browser.find())"; then
  timeout 6000 python3 "$tests/drive_site.py" site/index.html found.json ${OCTALUX_SCREENSHOTS:+"$OCTALUX_SCREENSHOTS"} \
    >stdout.txt 2>stderr.txt || fail "the report in a browser"
else
  echo "skipped: no Chromium here to look at the report"
fi

# Scenes that are missing are left out, and the output says so.
expect 0 mcguire-resolution --size 24x16 --spp 2 --scenes nowhere
grep -q "mcguire-resolution: living-room is left out: nowhere/living-room.json" stderr.txt || fail "no word on standard error"
grep -q "^Left out: living-room: nowhere/living-room.json" stdout.txt || fail "no word of the missing scene"

# When a run of all experiments is stopped, the results of finished experiments remain, and no fields.
export TMPDIR=$PWD/temporary
mkdir temporary
mkdir ended
"$OCTALUX" all --quick --size 16x16 --spp 1 --json --progress --report ended >ended.json 2>stderr.txt &
await $! "mcguire-leaks: path tracing"
kill -TERM $!
wait $!
[ $? = 143 ] || fail "all experiments, stopped, do not say by the exit code what stopped them"
python3 -c 'import json; o = json.load(open("ended.json")); assert [e["experiment"] for e in o["experiments"]] == ["mcguire-table1"]' ||
  fail "the JSON of what has ended"
grep -q "mcguire-table1" ended/index.html || fail "the report of what has ended"
grep -q "bench mcguire-leaks" ended/index.html && fail "the report shows what has not ended"
[ -z "$(ls -A temporary)" ] || fail "experiments that are stopped leave fields"
finish
