# Every experiment at its quick size: within its time, and every number as in bench_quick.json.
source "$(dirname "$0")/cli/expect.sh"
tests="$OCTALUX_SOURCE_DIR/tests"
expect 0 bench all --quick --json
cp stdout.txt found.json
PYTHONDONTWRITEBYTECODE=1 python3 "$tests/check_bench.py" "$tests/bench_quick.json" found.json >stdout.txt || fail "numbers differ"
# Scenes that are not here are left out, visibly.
expect 0 bench mcguire-resolution --size 24x16 --spp 2 --scenes nowhere
grep -q "mcguire-resolution: living-room is left out: nowhere/living-room.json" stderr.txt || fail "no word on standard error"
grep -q "^Left out: living-room: nowhere/living-room.json" stdout.txt || fail "no word of the missing scene"
finish
