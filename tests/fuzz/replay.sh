# replay.sh PROGRAMS-FOLDER TARGET: runs the seeds of a fuzzing target, and the inputs that failed before, once each.
set -euo pipefail
shopt -s nullglob
TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
"$1/make_seeds" "$TMPDIR/seeds"
# Assimp reads numbers from lines that end with a line feed, where strict checks of strings want a 0.
[ "$2" = obj ] && export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}strict_string_checks=0
"$1/target_$2" "$TMPDIR/seeds/$2"/* "$(dirname "$0")/found/$2"/*
