# Helpers of the command line's tests: they run the program as a user would and check its exit code, output and files.
# To be sourced; the test then works in a folder of its own, which is removed at the end.
set -u
: "${OCTALUX:?the program to test}"
: "${OCTALUX_SOURCE_DIR:?the project}"
failures=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

fail() {
  failures=$((failures + 1))
  echo "FAILED: $*"
  sed 's/^/    /' stdout.txt stderr.txt 2>/dev/null
}

# preloading LIBRARY[:NAME] [VARIABLE=VALUE...] COMMAND...: runs the command with the library loaded before its own, and
# with another one of the same folder. LD_PRELOAD takes no paths with spaces, so the folder is searched. A sanitizer
# would rather come first.
preloading() {
  env LD_LIBRARY_PATH="${1%/*}${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" LD_PRELOAD="${1##*/}" \
    ASAN_OPTIONS="${ASAN_OPTIONS:-}:verify_asan_link_order=0" "${@:2}"
}

# expect CODE ARGUMENTS...: runs octalux and checks its exit code; its output is in stdout.txt and stderr.txt.
expect() {
  local wanted=$1 code=0
  shift
  "$OCTALUX" "$@" >stdout.txt 2>stderr.txt </dev/null || code=$?
  [ "$code" = "$wanted" ] || fail "octalux $*: exit code $code, not $wanted"
}

# expect_usage PATTERN ARGUMENTS...: checks that the arguments are refused as wrong usage, in one line that matches.
expect_usage() {
  local pattern=$1
  shift
  expect 2 "$@"
  [ "$(wc -l <stderr.txt)" = 1 ] || fail "octalux $*: not one line on standard error"
  [ -s stdout.txt ] && fail "octalux $*: something on standard output"
  grep -q -- "$pattern" stderr.txt || fail "octalux $*: no '$pattern' on standard error"
}

# expect_failure PATTERN ARGUMENTS...: checks that the command fails and that its last line matches.
expect_failure() {
  local pattern=$1
  shift
  expect 1 "$@"
  [ -s stdout.txt ] && fail "octalux $*: something on standard output"
  tail -n 1 stderr.txt | grep -q -- "$pattern" || fail "octalux $*: no '$pattern' in the last line on standard error"
}

# expect_json EXPRESSION ARGUMENTS...: checks that the command prints one JSON object `o` for which the Python
# expression is true. It runs without Python's site module, which takes longer to load than all the rest.
expect_json() {
  local expression=$1
  shift
  expect 0 "$@" --json
  python3 -S - "$expression" <<'PYTHON' || fail "octalux $* --json: not $expression"
import json, math, sys
o = json.load(open("stdout.txt"), parse_constant=lambda name: sys.exit("not JSON: " + name))
if not isinstance(o, dict): sys.exit("not an object")
sys.exit(0 if eval("(" + sys.argv[1] + ")", {"o": o, "math": math}) else 1)
PYTHON
}

# expect_files NAMES...: checks that the folder holds these files and no others.
expect_files() {
  local found
  found=$(ls -A | grep -v -e '^stdout.txt$' -e '^stderr.txt$' | sort | tr '\n' ' ')
  [ "$found" = "$(printf '%s\n' "$@" | sed '/^$/d' | sort | tr '\n' ' ')" ] || fail "files: $found, not $*"
}

# await PROCESS PATTERN: waits until stderr.txt matches the pattern or the process has ended.
await() {
  until grep -q -- "$2" stderr.txt || ! kill -0 "$1" 2>/dev/null; do sleep 0.05; done
}

# expect_experiment_stops ARGUMENTS...: stops an experiment of octalux-bench once it has begun; it says so, and leaves
# no files in TMPDIR.
expect_experiment_stops() {
  "$OCTALUX_BENCH" "$@" --progress >stdout.txt 2>stderr.txt &
  local code=0 process=$!
  await $process "$1: "
  kill -TERM $process
  wait $process || code=$?
  [ $code = 143 ] || fail "a stopped experiment does not say by its exit code what stopped it"
  grep -q "interrupted" stderr.txt || fail "a stopped experiment does not say so"
  [ -z "$(ls -A "$TMPDIR")" ] || fail "a stopped experiment leaves files"
}

finish() {
  if [ "$failures" -gt 0 ]; then
    echo "$failures failed"
    exit 1
  fi
  exit 0
}
