#!/usr/bin/env bash
# Coverage-guided fuzzing: fuzz.sh BUILD-FOLDER SECONDS [TARGET...] runs each target (all of them) for so many seconds.
# It begins with the seeds that the build makes, inputs that once failed (tests/fuzz/found), and those that earlier runs
# kept (BUILD-FOLDER/corpus). Prints a row for each target, with the number of edges of the code that were covered;
# inputs that break a promise, take 5 seconds or gigabytes are kept in BUILD-FOLDER/broken.
set -uo pipefail
build=$(realpath "$1") seconds=$2
source=$(realpath "$(dirname "$0")/..")
shift 2
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for file in "$source"/tests/fuzz/target_*.c; do
    name=${file##*/target_}
    targets+=("${name%.c}")
  done
fi
[ -x "$build/tests/target_${targets[0]}" ] || { echo "skipped: no libFuzzer (Debian: clang libclang-rt-14-dev), or it is not built"; exit 77; }

TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
asan=${ASAN_OPTIONS:+$ASAN_OPTIONS:}quarantine_size_mb=16:allocator_may_return_null=1
export LSAN_OPTIONS="suppressions=$source/tests/leaks.supp:print_suppressions=0"
"$build/tests/make_seeds" "$TMPDIR/seeds" || exit 1
failed=0

# number LOG NAME: prints a number of libFuzzer's final statistics.
number() { sed -nE "s/^stat::$2: *([0-9]+).*/\1/p" "$1" | tail -n 1; }

for target in "${targets[@]}"; do
  corpus=$build/corpus/$target found=$source/tests/fuzz/found/$target log=$build/corpus/$target.log
  mkdir -p "$corpus" "$build/broken"
  folders=("$corpus" "$TMPDIR/seeds/$target")
  [ -d "$found" ] && folders+=("$found")
  leaks=1 strict=1
  most=16384
  [ "$target" = work ] && most=32768 # the units of the smallest bake have up to 28 KB
  # Assimp leaks memory when it refuses a model (the target counts our own memory), and reads numbers from lines that end
  # with a line feed, where strict checks of strings want a 0.
  [ "$target" = obj ] && leaks=0 strict=0
  ASAN_OPTIONS=$asan:detect_leaks=$leaks:strict_string_checks=$strict "$build/tests/target_$target" -detect_leaks=$leaks -max_total_time="$seconds" -timeout=5 -rss_limit_mb=3000 -malloc_limit_mb=1500 -max_len=$most -print_final_stats=1 \
    -dict="$source/tests/fuzz/words.dict" -artifact_prefix="$build/broken/$target-" "${folders[@]}" >"$log" 2>&1
  status=$?
  edges=$(sed -nE 's/.* cov: ([0-9]+).*/\1/p' "$log" | tail -n 1)
  all=$(sed -nE 's/.*\(([0-9]+) inline 8-bit counters\).*/\1/p' "$log" | head -n 1)
  printf '%-12s %9s runs, %6s of %s edges, %5s inputs kept, %s MiB at most: %s\n' "$target" "$(number "$log" number_of_executed_units)" "${edges:-0}" \
    "${all:-0}" "$(find "$corpus" -type f | wc -l)" "$(number "$log" peak_rss_mb)" "$([ $status -eq 0 ] && echo fine || echo BROKEN)"
  [ $status -eq 0 ] && continue
  failed=1
  grep -vE '^#[0-9]+|^\s*NEW|REDUCE' "$log" | tail -n 60
done
exit $failed
