# Bakes that are killed go on where they were, and their fields are those of bakes that were not. test_resume.sh
# [KILLS].
set -euo pipefail
kills=${1:-4}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
resume=$OCTALUX_SOURCE_DIR/tests/resume.py

mkdir "$work/plain" "$work/whole"
python3 "$resume" "$work/plain" "$kills" 1 "$OCTALUX" builtin:cornell --radiance-size 64 --noise 0.1
# Everything that a field can hold, at another number of threads.
python3 "$resume" "$work/whole" $(((kills + 1) / 2)) 2 "$OCTALUX" builtin:cornell --grid 2x2x1 --radiance-size 32 \
  --irradiance-size 16 --noise 0.03 --relight --classic --classic-size 32 --cube-size 32 --threads 3
