# The limit on a bake's memory: a bake stays within it and writes the bytes that it writes without one, and a limit that
# is too low is refused with the least that is not. `test_memory.sh long` takes larger scenes: the living room and the
# built-in scenes that LIMITED names.
. "$OCTALUX_SOURCE_DIR/tests/cli/expect.sh"

# number KEY: of the JSON object in stdout.txt, in 10^6 bytes.
number() { python3 -c 'import json, sys; print(json.load(open("stdout.txt"))[sys.argv[1]] / 1e6)' "$1"; }
# times NUMBER FACTOR
times() { python3 -c 'import sys; print(float(sys.argv[1]) * float(sys.argv[2]))' "$1" "$2"; }
# is_below ONE OTHER
is_below() { python3 -c 'import sys; sys.exit(float(sys.argv[1]) > float(sys.argv[2]))' "$1" "$2"; }

# A bake within a limit takes no more than that, and writes the same field.
stays_within() {
  local limit=$1
  shift
  expect 0 bake "$@" -o limited.olx --memory "$limit" --json
  is_below "$(number peak_memory_bytes)" "$limit" || fail "octalux bake $*: not within $limit MB"
  cmp -s limited.olx free.olx || fail "octalux bake $*: another field within $limit MB"
}

# A limit of half of what is needed is refused before anything is written, and the message names one that is accepted.
refuses_half() {
  local least=$1 named
  shift
  rm -f limited.olx
  expect_failure 'MB of memory is too low: this bake needs [0-9]* MB at least' \
    bake "$@" -o limited.olx --memory "$(times "$least" 0.5)" --work half.work
  named=$(sed -n 's/.* needs \([0-9]*\) MB at least.*/\1/p' stderr.txt)
  expect 1 bake "$@" -o limited.olx --memory "$(times "$least" 0.5)" --dry-run --json
  grep -q 'MB of memory is too low: this bake needs [0-9]* MB at least' stderr.txt || fail "octalux bake $* --dry-run: why?"
  python3 -c 'import json, sys; sys.exit(json.load(open("stdout.txt"))["fits"])' || fail "octalux bake $* --dry-run: fits"
  [ -e limited.olx ] || [ -e half.work ] && fail "octalux bake $*: a refused bake left something"
  stays_within "$named" "$@"
}

obeys() {
  expect 0 bake "$@" -o dry.olx --dry-run --json
  local least most
  least=$(number least_memory_bytes) most=$(number most_memory_bytes)
  [ -e dry.olx ] && fail "octalux bake $* --dry-run: a field"
  is_below "$least" "$most" || fail "octalux bake $*: $least MB at least, and $most MB at most"
  expect 0 bake "$@" -o free.olx --json
  is_below "$(number peak_memory_bytes)" "$most" || fail "octalux bake $*: more than $most MB without a limit"
  stays_within "$(times "$least" 1.1)" "$@"
  stays_within "$most" "$@"
  refuses_half "$least" "$@"
}

if [ "${1:-}" = long ]; then
  small=(--radiance-size 128 --noise 0.3)
  for scene in ${LIMITED:-labyrinth}; do obeys "builtin:$scene" "${small[@]}"; done
  scenes=${OCTALUX_SCENES:-$OCTALUX_SOURCE_DIR/../shared/scenes}
  if [ -d "$scenes/living-room" ]; then
    export OCTALUX_SCENES=$scenes
    obeys "$OCTALUX_SOURCE_DIR/scenes/living-room.json" "${small[@]}"
  else
    echo "skipped: the living room, without $scenes"
  fi
  obeys builtin:cornell --radiance-size 128 --noise 0.2 --relight --probe-light
else
  tiny=(builtin:cornell --grid 2x1x2 --radiance-size 32 --noise 0.1 --threads 2)
  obeys "${tiny[@]}"
  # Links in files are the same for relighting, in a work folder, and when the bake goes on from one.
  expect 0 bake "${tiny[@]}" --relight -o dry.olx --dry-run --json
  least=$(number least_memory_bytes)
  expect 0 bake "${tiny[@]}" --relight -o free.olx
  stays_within "$(times "$least" 1.4)" "${tiny[@]}" --relight --work kept.work --keep-work
  rm -f kept.work/light-[4-9]* kept.work/relight* kept.work/probe*
  stays_within "$(times "$least" 1.4)" "${tiny[@]}" --relight --work kept.work
fi
expect_usage "--memory: '0' is not a number above 0" bake builtin:cornell -o none.olx --memory 0

exit "$((failures > 0))"
