# A bake that is interrupted or killed leaves the old file or the new one, never half of one: test_kill.sh [ROUNDS].
set -euo pipefail
set -m # without job control bash makes children ignore SIGINT
rounds=${1:-4}
work=$(mktemp -d) log=$(mktemp)
trap 'rm -rf "$work" "$log"' EXIT
bake=("$OCTALUX" bake builtin:cornell -o "$work/field.olx" --grid 3x3x3 --radiance-size 128 --irradiance-size 16 --bounces 1)

fail() {
  echo "$1" >&2
  exit 1
}

start=$(date +%s%N)
"${bake[@]}" >/dev/null
bake_ms=$((($(date +%s%N) - start) / 1000000))
sum=$(sha256sum <"$work/field.olx")

for ((round = 0; round < rounds; round++)); do
  # Moments spread over the whole bake, its start and its end included.
  delay_ms=$((bake_ms * (2 * round + 1) / (2 * rounds)))
  for signal in KILL INT TERM; do
    "${bake[@]}" --progress >/dev/null 2>"$log" &
    child=$!
    # Until it is the program: a signal before that would meet a copy of this shell, which tidies up as this one does.
    while [ "$(cat "/proc/$child/comm" 2>/dev/null)" = bash ]; do :; done
    if [ "$round" -eq 0 ]; then # in the midst of the bake, however fast the machine is by now
      until [ -s "$log" ] || ! kill -0 "$child" 2>/dev/null; do sleep 0.01; done
    else
      sleep "$(printf '%d.%03d' $((delay_ms / 1000)) $((delay_ms % 1000)))"
    fi
    kill -"$signal" "$child" 2>/dev/null || true
    status=0
    wait "$child" 2>/dev/null || status=$?
    [ "$(sha256sum <"$work/field.olx")" = "$sum" ] || fail "SIG$signal after $delay_ms ms: the file changed"
    "$OCTALUX" verify "$work/field.olx" >/dev/null || fail "SIG$signal after $delay_ms ms: the file is broken"
    if [ "$signal" = KILL ]; then
      find "$work" -name '*.tmp-*' -delete
    else
      [ "$(ls "$work")" = field.olx ] || fail "SIG$signal after $delay_ms ms: left behind: $(ls "$work")"
      # A late moment may come after the end of the bake.
      [ "$status" -ne 0 ] || [ "$round" -gt 0 ] || fail "SIG$signal after $delay_ms ms: exit status 0"
    fi
  done
done
echo "$rounds rounds over $bake_ms ms"
