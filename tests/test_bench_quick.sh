# Compares numbers of experiments at their quick sizes with the table in bench_quick.json; full_bench.sh compares all of
# them.
source "$(dirname "$0")/cli/expect.sh"
tests="$OCTALUX_SOURCE_DIR/tests"
"$OCTALUX_BENCH" mcguire-resolution --quick --json >found.json 2>stderr.txt || fail "the experiment failed"
PYTHONDONTWRITEBYTECODE=1 python3 "$tests/check_bench.py" "$tests/bench_quick.json" found.json >stdout.txt || fail "numbers differ"

# The comparison reports numbers that are missing from the table, and numbers that differ.
python3 - "$tests/bench_quick.json" <<'PYTHON'
import json, sys
table = json.load(open(sys.argv[1]))
own = [row for row in table["rows"] if row[0] == "mcguire-resolution"]
json.dump({"rows": own[1:]}, open("short.json", "w"))
json.dump({"rows": own + [own[0][:3] + ["other", 1, 1]]}, open("long.json", "w"))
own[0][4] += 2.1 * own[0][5]
json.dump({"rows": own}, open("off.json", "w"))
PYTHON
for table in short:"is not in the table" long:"was not found" off:"is not "; do
  python3 "$tests/check_bench.py" "${table%%:*}.json" found.json >stdout.txt && fail "$table goes unnoticed"
  grep -q "^mcguire-resolution, fields, .*${table#*:}" stdout.txt || fail "no word of $table"
done
finish
