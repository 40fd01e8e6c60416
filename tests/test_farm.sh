# The templates of docs/farm.md make the same field as a bake on one machine: the Slurm script as an array of tasks, one
# of which is killed and requeued, the shell function that GNU parallel calls, and the templates for OpenJD and OpenCue.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
page=$OCTALUX_SOURCE_DIR/docs/farm.md
PATH=$(dirname "$OCTALUX"):$PATH
cd "$work"
scene="builtin:cornell --grid 2x1x2 --radiance-size 32 --noise 0.2"
# quick: replaces the template's scene by a quick one, and long sleeps by short ones.
quick() { sed "s/builtin:temple --grid 8x8x8/$scene/; s/sleep [0-9]*/sleep 0.1/"; }

octalux bake $scene --isa avx2 -o whole.olx >/dev/null
sed -n '/^#!\/bin\/bash$/,/^```$/{/^```/!p}' "$page" | quick >part.sh
grep -q -- '--part "\$part/\$SLURM_ARRAY_TASK_MAX"' part.sh
export DIR=$work/slurm SLURM_CPUS_PER_TASK=1 SLURM_ARRAY_TASK_MAX=4
task() { SLURM_ARRAY_TASK_ID=$1 timeout -s KILL "$2" bash part.sh >/dev/null 2>&1; }
task 3 0.3 || true
tasks=()
for id in 1 2 3 4; do
  task $id 120 &
  tasks+=($!)
done
for process in "${tasks[@]}"; do wait "$process"; done
eval "$(sed -n "s/.*--wrap '\(octalux join .*\)'/\1/p" "$page")" >/dev/null
cmp temple.olx whole.olx
rm temple.olx

export DIR=$work/parallel N=3
eval "$(sed -n '/^part() {$/,/^}$/p' "$page" | quick)"
tasks=()
for id in 1 3; do # the second has no processor, and never begins
  part $id >/dev/null 2>&1 &
  tasks+=($!)
done
for process in "${tasks[@]}"; do wait "$process"; done
octalux join "$DIR" -o temple.olx >/dev/null
cmp temple.olx whole.olx
python3 "$OCTALUX_SOURCE_DIR/tests/farm_templates.py" "$page" "$work" "$scene" whole.olx
[ "$(ls -A)" = whole.olx ] # no work folder and no unfinished field is left
