# replay.sh PROGRAMS-FOLDER TARGET: the seeds of a target of coverage-guided fuzzing, and what it found before, run
# once.
set -euo pipefail
shopt -s nullglob
TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
"$1/make_seeds" "$TMPDIR/seeds"
"$1/target_$2" "$TMPDIR/seeds/$2"/* "$(dirname "$0")/found/$2"/*
