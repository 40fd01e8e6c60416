# A disk that fails while a field is written, one that takes fewer bytes at a time than it is given, and two bakes into
# one output: there is the old field or a whole new one, and no other file.
. "$OCTALUX_SOURCE_DIR/tests/cli/expect.sh"
: "${OCTALUX_FULL_DISK:?the library that stands for a disk with faults}"
: "${OCTALUX_UNREADABLE_FILES:?the library that stands for files that cannot be opened}"
bake=(bake builtin:cornell --grid 2x1x2 --radiance-size 16 --noise 0.3)

# on_disk VARIABLE=VALUE... COMMAND...: runs a command on a disk with faults.
on_disk() { preloading "$OCTALUX_FULL_DISK" "$@"; }

expect 0 "${bake[@]}" -o whole.olx

# Errors of the device at several moments of the writing.
mkdir failing
printf 'the old field' >failing/a.olx
size=$(stat -c %s whole.olx)
for bytes in 0 $((size / 4)) $((size / 2)) $((size - 1)); do
  on_disk OCTALUX_DISK_BYTES="$bytes" OCTALUX_DISK_ERROR=5 "$OCTALUX" "${bake[@]}" -o failing/a.olx >stdout.txt 2>stderr.txt &&
    fail "a bake after an error of the device at byte $bytes"
  grep -q "failing/a.olx.*Input/output error" stderr.txt || fail "no word of the device's error at byte $bytes"
  [ "$(cat failing/a.olx)" = 'the old field' ] || fail "the old field changed after an error at byte $bytes"
  [ "$(ls -A failing)" = a.olx ] || fail "files left after an error at byte $bytes: $(ls -A failing)"
done

# A disk that fails to sync, at once or after some units, and one that fails to rename.
for fault in OCTALUX_SYNCS=0 OCTALUX_SYNCS=7 OCTALUX_NO_RENAMES=1; do
  code=0
  on_disk $fault "$OCTALUX" "${bake[@]}" -o failing/a.olx --work failing/kept >stdout.txt 2>stderr.txt || code=$?
  [ $code = 1 ] || fail "exit code $code with $fault"
  grep -q "failing/kept/.*cannot write: Input/output error" stderr.txt || fail "no word of the device's error with $fault: $(cat stderr.txt)"
  on_disk $fault "$OCTALUX" "${bake[@]}" -o failing/a.olx --no-work >stdout.txt 2>stderr.txt && [ $fault != OCTALUX_SYNCS=7 ] &&
    fail "a bake with $fault"
  [ $fault = OCTALUX_SYNCS=7 ] || grep -q "failing/a.olx.*Input/output error" stderr.txt || fail "no word of $fault: $(cat stderr.txt)"
  [ $fault = OCTALUX_SYNCS=7 ] || [ "$(cat failing/a.olx)" = 'the old field' ] || fail "the old field changed with $fault"
  printf 'the old field' >failing/a.olx
done
expect 0 "${bake[@]}" -o failing/a.olx --work failing/kept
cmp -s failing/a.olx whole.olx || fail "another field after errors of the device"
[ "$(ls -A failing)" = a.olx ] || fail "files left after errors of the device: $(ls -A failing)"

# Short writes: each is continued.
on_disk OCTALUX_SHORT_WRITES=1 "$OCTALUX" "${bake[@]}" -o short.olx --work short.work >stdout.txt 2>stderr.txt ||
  fail "a bake with short writes"
cmp -s short.olx whole.olx || fail "short writes make another field"

# A disk that has no more space for the work folder, at once or later, while the output's has: the field is written, and
# one warning says what is not kept.
mkdir roomy
for bytes in 20000 200000; do
  on_disk OCTALUX_DISK_FOLDER=/crowded/ OCTALUX_DISK_BYTES=$bytes "$OCTALUX" "${bake[@]}" -o roomy/a.olx \
    --work crowded --keep-work >stdout.txt 2>stderr.txt || fail "a bake whose work folder has no more space than $bytes bytes"
  [ "$(grep -c "crowded/.*No space left on device; what is made from now on is not kept" stderr.txt)" = 1 ] ||
    fail "not one word of a work folder that is full at $bytes bytes"
  cmp -s roomy/a.olx whole.olx || fail "another field with a work folder that is full at $bytes bytes"
done
code=0
on_disk OCTALUX_DISK_FOLDER=/crowded/ OCTALUX_DISK_BYTES=0 "$OCTALUX" "${bake[@]}" --work crowded --part 1/1 \
  >stdout.txt 2>stderr.txt || code=$?
{ [ $code = 1 ] && grep -q "No space left on device" stderr.txt; } || fail "exit code $code of a part on a full disk"
expect 0 "${bake[@]}" -o roomy/a.olx --work crowded
cmp -s roomy/a.olx whole.olx || fail "another field after a work folder without space"

# A unit of each stage that cannot be opened for now: none is lost, and the field is the same, at once or with the next
# bake.
with_unreadable() {
  preloading "$OCTALUX_UNREADABLE_FILES" OCTALUX_UNREADABLE="$1" \
    "$OCTALUX" "${bake[@]}" -o once.olx --work again --keep-work
}
expect 0 "${bake[@]}" -o once.olx --work sound --keep-work
units=$(ls sound | grep -v '^manifest' | sort -t - -k 1,1 -k 2,2nr | sort -t - -k 1,1 -u -s)
[ "$(wc -l <<<"$units")" -ge 8 ] || fail "few stages: $units"
for unit in $units; do
  cp -a sound again
  rm -f once.olx
  code=0
  with_unreadable "$unit" >stdout.txt 2>stderr.txt || code=$?
  [ $code = 0 ] || [ $code = 1 ] || fail "exit code $code where $unit cannot be opened"
  [ $code = 0 ] || grep -q "again/$unit: cannot open: Too many open files" stderr.txt ||
    fail "no word of $unit, which cannot be opened"
  [ "$(ls sound)" = "$(ls again)" ] || fail "units were lost where $unit could not be opened"
  expect 0 "${bake[@]}" -o once.olx --work again
  cmp -s once.olx whole.olx || fail "another field after $unit could not be opened"
done

# Two bakes of different fields into one output: both end well, and the output is whole, that of one of them.
mkdir both
expect 0 "${bake[@]}" --seed 1 -o other.olx
"$OCTALUX" "${bake[@]}" -o both/a.olx >/dev/null 2>first.txt &
first=$!
"$OCTALUX" "${bake[@]}" --seed 1 -o both/a.olx >/dev/null 2>second.txt || fail "the second of two bakes: $(cat second.txt)"
wait "$first" || fail "the first of two bakes: $(cat first.txt)"
cmp -s both/a.olx whole.olx || cmp -s both/a.olx other.olx || fail "two bakes into one output mixed their fields"
[ "$(ls -A both)" = a.olx ] || fail "two bakes into one output left files: $(ls -A both)"

# Two bakes that keep results in the same folder: the second is refused, or begins when the first has ended.
code=0
"$OCTALUX" "${bake[@]}" -o both/b.olx --work one.work >/dev/null 2>first.txt &
first=$!
"$OCTALUX" "${bake[@]}" -o both/b.olx --work one.work >/dev/null 2>second.txt || code=$?
wait "$first" || code=$((10 * code + 1))
case $code in
0) ;;
1) grep -q "one.work: another bake works in this folder" first.txt second.txt || fail "no word of a work folder in use: $(cat first.txt second.txt)" ;;
*) fail "both of two bakes in one work folder failed: $(cat first.txt second.txt)" ;;
esac
cmp -s both/b.olx whole.olx || fail "two bakes in one work folder: another field"

exit "$((failures > 0))"
