# A building of ROOMS x ROOMS rooms of 10 m with doors of one metre, with default settings: placement_check finds at
# least 99 % of what is seen from anywhere covered, in bounded processor time and memory; and a bake with these probes
# reports its sizes.
set -euo pipefail
rooms=${ROOMS:-10} seconds=${SECONDS_ALLOWED:-60} megabytes=${MEGABYTES:-500}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"

python3 "$OCTALUX_SOURCE_DIR/tests/rooms.py" "$rooms" "$work"
python3 - "$OCTALUX" "$work" "$seconds" "$megabytes" <<'PYTHON'
import resource, subprocess, sys
octalux, work, seconds, megabytes = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
subprocess.run([octalux, "place", f"{work}/rooms.json", "-o", f"{work}/probes.json"], check=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"{used.ru_utime + used.ru_stime:.0f} s of processor time, {used.ru_maxrss / 1000:.0f} MB")
sys.exit(used.ru_utime + used.ru_stime > seconds or used.ru_maxrss / 1000 > megabytes)
PYTHON
python3 -c 'import json, sys; print(json.dumps(json.load(open(sys.argv[1]))["report"]))' "$work/probes.json" |
  holds 'coverage >= 0.995 and unreached_m2 < 0.001 * reached_m2'
"$OCTALUX_BENCH" placement-check --ball 0.25 "$work/rooms.json" 200000 "$work/probes.json" | tee "$work/checked"
holds 'covered >= 0.99 and reached == 1 and outside == 0' <"$work/checked"
"$OCTALUX" bake "$work/rooms.json" --probes "$work/probes.json" -o "$work/rooms.olx" --dry-run | tee "$work/sizes"
grep -q 'GiB\|MiB' "$work/sizes"
