# A bake that is interrupted or killed leaves the old file or the new one, never half of one: test_kill.sh [ROUNDS].
set -euo pipefail
set -m # without job control bash makes children ignore SIGINT
rounds=${1:-4}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
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
    "${bake[@]}" >/dev/null 2>&1 &
    child=$!
    sleep "$(printf '%d.%03d' $((delay_ms / 1000)) $((delay_ms % 1000)))"
    kill -"$signal" "$child" 2>/dev/null || true
    status=0
    wait "$child" 2>/dev/null || status=$?
    [ "$(sha256sum <"$work/field.olx")" = "$sum" ] || fail "SIG$signal after $delay_ms ms: the file changed"
    "$OCTALUX" verify "$work/field.olx" >/dev/null || fail "SIG$signal after $delay_ms ms: the file is broken"
    if [ "$signal" = KILL ]; then
      find "$work" -name '*.tmp-*' -delete
    else
      [ "$(ls "$work")" = field.olx ] || fail "SIG$signal after $delay_ms ms: left behind: $(ls "$work")"
      # The first moment lies well inside the bake; a late one may come after its end.
      [ "$status" -ne 0 ] || [ "$round" -gt 0 ] || fail "SIG$signal after $delay_ms ms: exit status 0"
    fi
  done
done
echo "$rounds rounds over $bake_ms ms"
