# Bakes that are killed resume where they were, and give the same fields as bakes that were not killed. test_resume.sh
# [KILLS].
set -euo pipefail
kills=${1:-4}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
resume=$OCTALUX_SOURCE_DIR/tests/resume.py

mkdir "$work/plain" "$work/whole"
python3 "$resume" "$work/plain" "$kills" 1 "$OCTALUX" builtin:cornell --radiance-size 64 --noise 0.1
# This bake has everything that a field can contain, and another number of threads.
python3 "$resume" "$work/whole" $(((kills + 1) / 2)) 2 "$OCTALUX" builtin:cornell --grid 2x2x1 --radiance-size 32 \
  --irradiance-size 16 --noise 0.03 --relight --classic --classic-size 32 --cube-size 32 --threads 3
