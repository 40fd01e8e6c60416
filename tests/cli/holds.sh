# Checks that a Python expression over the keys of the JSON object on standard input is true.
holds() {
  python3 -c '
import json, math, os, sys
report = json.load(sys.stdin)
if not eval(sys.argv[1], {"math": math, "os": os, **report}):
    sys.exit("does not hold: %s\nin %s" % (sys.argv[1], report))
' "$1"
}
