# A bake that is interrupted or killed leaves the old file or the new one, never half of one, and no other files:
# neither with unnamed temporary files nor, after the next output, with named ones. test_kill.sh [ROUNDS].
set -euo pipefail
set -m # without job control bash makes children ignore SIGINT
rounds=${1:-2}
: "${OCTALUX_NAMED_FILES:?the library that stands for a file system without unnamed files}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bake=("$OCTALUX" bake builtin:cornell -o "$work/field.olx" --grid 2x2x2 --radiance-size 64 --irradiance-size 16
  --bounces 1 --noise 0.5)

fail() {
  echo "$1" >&2
  exit 1
}

start=$(date +%s%N)
"${bake[@]}" >/dev/null
bake_ms=$((($(date +%s%N) - start) / 1000000))
sum=$(sha256sum <"$work/field.olx")

# kill_bake SIGNAL MILLISECONDS PRELOADED: sends the signal to a bake; its exit status is in $status. With a preloaded
# library, the time counts from the moment when the bake's own temporary file has a name. LD_PRELOAD takes no paths with
# spaces, so the library's folder is searched.
kill_bake() {
  local before
  before=$(ls -A "$work")
  LD_LIBRARY_PATH=${3:+${3%/*}:}${LD_LIBRARY_PATH:-} LD_PRELOAD=${3##*/} "${bake[@]}" >/dev/null 2>&1 &
  local child=$!
  # Waits until the process has become octalux: an earlier signal would reach a copy of this shell, which would run the
  # clean-up of this one.
  while [ "$(cat "/proc/$child/comm" 2>/dev/null)" = bash ]; do :; done
  if [ -n "$3" ]; then
    while [ "$(ls -A "$work")" = "$before" ] && kill -0 "$child" 2>/dev/null; do sleep 0.01; done
    [ "$(ls -A "$work")" = field.olx ] || named=1
  fi
  sleep "$(printf '%d.%03d' $(($2 / 1000)) $(($2 % 1000)))"
  kill -"$1" "$child" 2>/dev/null || true
  status=0
  wait "$child" 2>/dev/null || status=$?
}

# check_left WORDS: checks that the field is unchanged, valid, and the only file.
check_left() {
  [ "$(sha256sum <"$work/field.olx")" = "$sum" ] || fail "$1: the file changed"
  "$OCTALUX" verify "$work/field.olx" >/dev/null || fail "$1: the file is broken"
  [ "$(ls -A "$work")" = field.olx ] || fail "$1: left behind: $(ls -A "$work")"
}

for ((round = 0; round < rounds; round++)); do
  # Signals are spread over the whole bake, including its start and its end.
  delay_ms=$((bake_ms * (2 * round + 1) / (2 * rounds)))
  for signal in KILL HUP INT TERM XFSZ; do
    kill_bake $signal $delay_ms ""
    check_left "SIG$signal after $delay_ms ms"
    # The first signal comes well before the bake's end; a late one may come after it. SIGXFSZ leads to an error of
    # writing.
    [ "$signal" = XFSZ ] || [ "$status" -ne 0 ] || [ "$round" -gt 0 ] ||
      fail "SIG$signal after $delay_ms ms: exit status 0"
  done
done

# A limit on the size of files acts like a full disk: it causes an error, wherever it is noticed.
status=0
(ulimit -f 64 && "${bake[@]}") >/dev/null 2>"$work.txt" || status=$?
[ "$status" = 1 ] && grep -q "field.olx: cannot" "$work.txt" ||
  fail "a limit of sizes: exit status $status: $(cat "$work.txt")"
rm -f "$work.txt"
check_left "a limit of sizes"

# Named temporary files are removed by the program when it can do so, and by the next output when it was killed.
named=0
for signal in KILL HUP TERM; do
  kill_bake $signal $((bake_ms / 8)) "$OCTALUX_NAMED_FILES"
  [ "$signal" = KILL ] || check_left "SIG$signal with named files"
done
kill_bake KILL $((bake_ms / 8)) "$OCTALUX_NAMED_FILES"
[ "$named" = 1 ] || fail "no temporary file had a name: nothing was tested"
"$OCTALUX" place builtin:cornell -o "$work/probes.json" --method grid --voxels 16 >/dev/null
rm "$work/probes.json"
check_left "the next output after SIGKILL with named files"
echo "$rounds rounds over $bake_ms ms"
