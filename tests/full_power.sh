# Power that goes while a bake works: writes that were not synced are lost in part, and a rename whose folder was not
# synced is undone (faults/full_disk.c). The old field stays whole until the new one is, and the same command resumes to
# the same bytes. Takes the step between the moments, counted in calls of fsync.
. "$OCTALUX_SOURCE_DIR/tests/cli/expect.sh"
: "${OCTALUX_FULL_DISK:?the library that stands for a disk with faults}" "${OCTALUX_NAMED_FILES:?one without unnamed files}"
bake=(bake builtin:cornell --grid 2x1x2 --radiance-size 16 --noise 0.3)
expect 0 "${bake[@]}" -o whole.olx
mkdir one
losses=0
for disk in "$OCTALUX_FULL_DISK" "$OCTALUX_FULL_DISK:${OCTALUX_NAMED_FILES##*/}"; do
  for ((syncs = 0; syncs < 1000; syncs += ${1:-7})); do
    printf 'the old field' >one/a.olx
    code=0
    preloading "$disk" OCTALUX_SYNCS=$syncs OCTALUX_POWER_LOSS=1 "$OCTALUX" "${bake[@]}" -o one/a.olx --work one/work \
      >stdout.txt 2>stderr.txt || code=$?
    if [ $code = 0 ]; then
      cmp -s one/a.olx whole.olx || fail "another field although the power stayed"
      break
    fi
    [ $code = 99 ] || fail "exit code $code at sync $syncs: $(cat stderr.txt)"
    losses=$((losses + 1))
    [ "$(cat one/a.olx 2>/dev/null | tr -d '\0')" = 'the old field' ] || cmp -s one/a.olx whole.olx || fail "neither the old field nor the new one at sync $syncs"
    "$OCTALUX" "${bake[@]}" -o one/a.olx --work one/work >stdout.txt 2>stderr.txt || fail "resuming after a loss at sync $syncs: $(cat stderr.txt)"
    cmp -s one/a.olx whole.olx || fail "another field after a loss at sync $syncs"
    [ "$(ls -A one)" = a.olx ] || fail "left after a loss at sync $syncs: $(ls -A one)"
  done
done
[ $losses -gt 4 ] || fail "the power went $losses times only"
echo "the power went $losses times: each time the old field or the new one, and the same bytes after resuming"
exit "$((failures > 0))"
