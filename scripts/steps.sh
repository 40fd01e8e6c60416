# Sourced by check.sh and check-full.sh: counted steps, and the closing line.
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# A version manager's python3 is a script that takes half a second to start the interpreter, which tests do hundreds of
# times, so the interpreter's own folder comes first.
python_folder=$(python3 -c 'import os, sys; print(os.path.dirname(sys.executable))' 2>/dev/null || true)
if [ "$python_folder" ] && [ "$python_folder" != "$(dirname "$(command -v python3)")" ]; then PATH=$python_folder:$PATH; fi

passed=0 failed=0 skipped=0 failures=()
jobs=${JOBS:-$(nproc)}
reports=build/check
mkdir -p "$reports"

# An interrupted check ends its jobs, which would keep the machine busy.
trap 'jobs -p | xargs -r kill 2>/dev/null; failed=$((failed + 1)); failures+=(interrupted); closing_line; exit 1' INT TERM

# step NAME COMMAND...: runs a command that succeeds or fails; its output is shown only when it fails.
step() {
  local name=$1 log="$reports/${1//[^A-Za-z0-9]/-}.log" start=$SECONDS
  shift
  if "$@" >"$log" 2>&1; then
    passed=$((passed + 1))
    printf '%-44s ok      %4d s\n' "$name" $((SECONDS - start))
  else
    failed=$((failed + 1))
    failures+=("$name")
    printf '%-44s FAILED  %4d s\n' "$name" $((SECONDS - start))
    tail -n 60 "$log"
    return 1
  fi
}

# configure_and_build PRESET [TARGET]: builds everything, or one target with its dependencies.
configure_and_build() {
  cmake --preset "$1" && cmake --build "build/$1" --parallel "$jobs" --target "${2:-all}"
}

# tests PRESET NAME CTEST-ARGUMENTS...: runs CTest in build/PRESET and counts every test case.
tests() {
  local preset=$1 name=$2 start=$SECONDS
  shift 2
  local report="$PWD/$reports/${name//[^A-Za-z0-9]/-}.xml" log="$reports/${name//[^A-Za-z0-9]/-}.log" status=0 counts
  rm -f "$report"
  ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$jobs" \
    --test-output-size-passed 1000000 --test-output-size-failed 1000000 --output-junit "$report" "$@" >"$log" 2>&1 || status=$?
  if ! counts=$(python3 scripts/count_tests.py "$report" 2>"$log.summary"); then counts="0 1 0"; fi
  local p f s
  read -r p f s <<<"$counts"
  if [ "$status" -ne 0 ] && [ "$f" -eq 0 ]; then f=1; fi
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  printf '%-44s %d passed, %d failed, %d skipped  %d s\n' "$name" "$p" "$f" "$s" $((SECONDS - start))
  cat "$log.summary"
  [ "$f" -eq 0 ] && return 0
  failures+=("$name")
  [ -s "$log.summary" ] || tail -n 60 "$log"
  return 1
}

# Returns whether clang can link targets of coverage-guided fuzzing.
has_libfuzzer() {
  echo 'int LLVMFuzzerTestOneInput(const char *d, unsigned long n); int LLVMFuzzerTestOneInput(const char *d, unsigned long n) { return !d && n; }' |
    clang -x c - -fsanitize=fuzzer,address -o /dev/null 2>/dev/null
}

# guided_fuzzing NAME LABEL: runs coverage-guided fuzzing of every target, where libFuzzer is available.
guided_fuzzing() {
  if has_libfuzzer; then
    step "build: coverage-guided fuzzing" configure_and_build fuzz fuzzers && tests fuzz "$1" -L "$2"
  else
    skipped=$((skipped + 1))
    printf '%-44s skipped: no libFuzzer (Debian: clang, libclang-rt-14-dev)\n' "$1"
  fi
}

# Shows the processor time of this check and its child processes. `times` is called here because a subshell has used
# none.
show_processor_time() {
  times >"$reports/times.txt"
  awk '{ for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); sum += 60 * t[1] + t[2] } }
    END { printf "%-44s         %4.0f s\n", "processor time", sum }' "$reports/times.txt"
}

closing_line() {
  show_processor_time
  [ ${#failures[@]} -eq 0 ] || printf 'failed step: %s\n' "${failures[@]}"
  if [ "$skipped" -gt 0 ]; then
    echo "$passed passed, $failed failed, $skipped skipped"
  else
    echo "$passed passed, $failed failed"
  fi
}

finish() {
  closing_line
  [ "$failed" -eq 0 ]
  exit
}
