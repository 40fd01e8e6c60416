# `bake` and `join` with work folders that are damaged, full, in use, or of another bake: one message, the right exit
# code, and the old field unchanged.
. "$OCTALUX_SOURCE_DIR/tests/cli/expect.sh"
: "${OCTALUX_FULL_DISK:?the library that stands for a full disk}"
scene=(builtin:cornell --grid 2x1x2 --radiance-size 16 --noise 0.3)
printf 'the old field' >old.olx

# complains CODE PATTERN ARGUMENTS...: checks for that exit code, one line that matches, and an unchanged old field.
complains() {
  local code=$1 pattern=$2
  shift 2
  expect "$code" "$@"
  [ "$(wc -l <stderr.txt)" = 1 ] || fail "octalux $*: not one line on standard error"
  grep -q -- "$pattern" stderr.txt || fail "octalux $*: does not say '$pattern'"
  [ "$(cat old.olx)" = 'the old field' ] || fail "octalux $*: the old field changed"
}

expect 0 bake "${scene[@]}" -o whole.olx --no-work
[ "$(ls -A | grep -c work)" = 0 ] || fail "a short bake made a work folder"

# A dry run reports the largest size of the work folder, and makes none.
expect 0 bake "${scene[@]}" -o old.olx --dry-run --work w --json
python3 -c 'import json; work = json.load(open("stdout.txt"))["work_bytes"]; assert 2 ** 31 < work < 2 ** 31 + 10 ** 6, work' ||
  fail "not the size of a work folder"
[ -e w ] && fail "reckoning made a folder"

# Wrong usage is refused.
expect_usage "-o FILE.olx is missing" bake "${scene[@]}"
expect_usage "--part needs --work DIR" bake "${scene[@]}" --part 1/2
for part in 0/2 3/2 1 1/0 /2 1/2x -1/2; do
  expect_usage "'$part' is not I/N" bake "${scene[@]}" --work w --part $part
done
expect_usage "--fresh and --part exclude each other" bake "${scene[@]}" --work w --part 1/2 --fresh
expect_usage "--no-work excludes" bake "${scene[@]}" -o old.olx --no-work --keep-work
expect_usage "--progress: 'yaml' is not json" bake "${scene[@]}" -o old.olx --progress=yaml
[ -e w ] && fail "wrong usage made a folder"

# Parts that have to wait for others say so, and so does `join`.
complains 75 "units of the stage .* are not there yet" bake "${scene[@]}" --work parts --part 2/2
complains 75 "units of the stage .* are not there yet" join parts -o old.olx
for round in $(seq 9); do
  for part in 1/2 2/2; do "$OCTALUX" bake "${scene[@]}" --work parts --part $part >/dev/null 2>&1; done
done
expect 0 bake "${scene[@]}" --work parts --part 1/2 --json
grep -q '"part":1,"parts":2,"units_made":0' stdout.txt || fail "a part that is done does not say so"

# When a file of the folder is damaged, `join` names it; a bake makes the file again, unless it is the manifest.
cp -r parts whole
for file in whole/*; do
  name=$(basename "$file")
  rm -rf damaged
  cp -rp whole damaged
  printf 'X' | dd of="damaged/$name" bs=1 seek=66 conv=notrunc 2>/dev/null
  case $name in
  manifest*) complains 1 "$name: is damaged; nothing says" bake "${scene[@]}" -o old.olx --work damaged ;;
  *) expect 0 bake "${scene[@]}" -o again.olx --work damaged --keep-work
     cmp -s again.olx whole.olx || fail "$name: another field after damage" ;;
  esac
  case $name in # the files that `join` reads
  manifest* | plan* | facts* | volume* | probe*)
    rm -rf damaged
    cp -rp whole damaged
    printf 'X' | dd of="damaged/$name" bs=1 seek=66 conv=notrunc 2>/dev/null
    complains 1 "$name: is damaged" join damaged -o old.olx ;;
  esac
done
rm -f whole/probe-0-2.unit whole/probe-0-3.unit
complains 75 "2 of 4 units of the stage 'probe' are not there yet" join whole -o old.olx

# A field is refused a place among the results, where it would replace one, or go with them.
complains 1 "parts/a.olx: lies in the work folder parts" join parts -o parts/a.olx
complains 1 "parts/plan-0-0.unit: lies in the work folder ./parts" bake "${scene[@]}" -o parts/plan-0-0.unit --work ./parts
expect 0 join parts -o joined.olx
cmp -s joined.olx whole.olx || fail "parts made another field"
[ -e parts ] && fail "joining left the folder"

# Folders of other bakes or other machines, and folders that are not work folders, are refused.
expect 0 bake "${scene[@]}" -o kept.olx --work kept --keep-work
complains 1 "another bake, with 'settings " bake "${scene[@]}" --seed 1 -o old.olx --work kept
complains 1 "another bake, with 'geometry " bake builtin:pillars --grid 2x1x2 --radiance-size 16 --noise 0.3 -o old.olx --work kept
complains 1 "another bake, with 'instructions " bake "${scene[@]}" --isa sse2 -o old.olx --work kept
complains 1 "another bake, with 'settings .*'; name another folder$" bake "${scene[@]}" --seed 1 --work kept --part 1/2
mkdir -m 700 foreign
echo mine >foreign/notes.txt
complains 1 "foreign: not a work folder" bake "${scene[@]}" -o old.olx --work foreign
complains 1 "foreign: not a work folder" join foreign -o old.olx
ln -s kept link
complains 1 "link: cannot be a work folder: it is a file or a link" bake "${scene[@]}" -o old.olx --work link
complains 1 "absent: cannot be a work folder" join absent -o old.olx
expect 0 bake "${scene[@]}" --seed 1 -o other.olx --work kept --fresh
[ -e kept ] && fail "the folder stayed"
cmp -s other.olx whole.olx && fail "--seed changed nothing"

# Of two bakes that use one folder, the second is refused while the first works.
expect 0 bake "${scene[@]}" -o kept.olx --work kept --keep-work
exec 9<kept
flock -n 9 || fail "cannot lock"
complains 1 "kept: another bake works in this folder" bake "${scene[@]}" -o old.olx --work kept
complains 1 "kept: another bake works in this folder" join kept -o old.olx
exec 9<&-

# `join` looks beside parts at work, and leaves them the folder.
"$OCTALUX" bake "${scene[@]}" --work beside --part 1/2 >/dev/null 2>&1
exec 9<beside
flock -s -n 9 || fail "cannot lock"
complains 75 "units of the stage .* are not there yet" join beside -o old.olx
expect 0 bake "${scene[@]}" --work beside --part 1/1
expect 0 join beside -o joined.olx
grep -q "beside: the work folder stays: another part works in it" stderr.txt || fail "no word of the part at work"
cmp -s joined.olx whole.olx || fail "another field beside a part at work"
exec 9<&-
expect 0 join beside -o joined.olx
[ -e beside ] && fail "joining left the folder"

# interrupted FOLDER ARGUMENTS...: interrupts a bake once it has begun to keep results.
interrupted() {
  local kept=$1 code=0
  shift
  "$OCTALUX" bake "$@" >stdout.txt 2>stderr.txt &
  local child=$!
  until [ -n "$(ls "$kept" 2>/dev/null | grep light-0-0)" ] || ! kill -0 $child 2>/dev/null; do sleep 0.01; done
  kill -INT $child 2>/dev/null
  wait $child || code=$?
  [ "$code" = 130 ] || fail "interrupted: exit code $code"
  local again='the same command'
  [[ " $* " = *" --fresh "* ]] && again='the same command without --fresh'
  grep -q "old.olx: interrupted, nothing written; $kept holds what is done, and $again goes on from it" stderr.txt ||
    fail "no word of what is kept"
  [ -e "$kept/plan-0-0.unit" ] || fail "nothing is kept"
}

# Long bakes have a work folder beside their output by default. Short bakes resume from it, or refuse it when it is of
# other settings.
long=(builtin:cornell --grid 4x4x4 --radiance-size 512 --noise 0.3)
interrupted old.olx.work "${long[@]}" -o old.olx
[ "$(cat old.olx)" = 'the old field' ] || fail "an interrupted bake changed the old field"
complains 1 "old.olx.work: the work folder is of another bake" bake "${scene[@]}" -o old.olx
expect 0 bake "${scene[@]}" -o new.olx --work old.olx.work --fresh
[ -e old.olx.work ] && fail "the folder stayed"
cmp -s new.olx whole.olx || fail "another field after another bake"

interrupted fresh.work "${long[@]}" -o old.olx --work fresh.work --fresh

# Lines for units need a work folder, which even a short bake then has while it runs.
expect 0 bake "${scene[@]}" -o told.olx --progress=json
grep -q '^{"stage":"probe"' stderr.txt || fail "no lines for units"
[ -e told.olx.work ] && fail "the folder stayed"
cmp -s told.olx whole.olx || fail "another field with lines for units"
expect_usage "--progress=json tells of units" bake "${scene[@]}" -o old.olx --no-work --progress=json

# An edit may change the bounds of the scene. With probes that are given no setting follows the bounds.
printf 'v %s\n' '0 0 0' '2 0 0' '0 0 2' '2 0 2' >floor.obj
printf 'f 1 3 2\nf 2 3 4\n' >>floor.obj
printf '{"model": "floor.obj", "lights": [{"type": "sun", "direction": [0, -1, 0], "irradiance": [1, 1, 1]}]}' >floor.json
printf '{"probes": [{"position": [1, 1, 1]}]}' >above.json
edit=(floor.json --probes above.json --radiance-size 16 --noise 0.3 --work edited --keep-work)
expect 0 bake "${edit[@]}" -o edited.olx
printf 'v 3 0 3\nf 2 4 5\n' >>floor.obj
expect 0 bake "${edit[@]}" -o edited.olx
expect 0 bake "${edit[@]:0:7}" -o fresh.olx --no-work
cmp -s edited.olx fresh.olx || fail "another field after an edit that changes the bounds"

# A long bake whose results cannot be kept has no folder, unless one is named.
classic=(builtin:cornell --grid 8x8x8 --classic --light reference --threads 1)
timeout 2 "$OCTALUX" bake "${classic[@]}" -o old.olx >stdout.txt 2>stderr.txt
[ $? = 124 ] || fail "a long classic bake does not begin: $(cat stderr.txt)"
[ -e old.olx.work ] && fail "a folder for results that cannot be kept"
complains 1 "a work folder cannot keep classic maps" bake "${classic[@]}" -o old.olx --work classic.work

# A disk that becomes full at ever later moments causes an error, wherever it is noticed, and the next bake resumes.
full=0
for bytes in 100 1000 10000 100000 200000 300000 400000 500000; do
  code=0
  preloading "$OCTALUX_FULL_DISK" OCTALUX_DISK_BYTES=$bytes "$OCTALUX" bake "${scene[@]}" -o old.olx --work full \
    >stdout.txt 2>stderr.txt || code=$?
  [ "$code" = 0 ] && break
  full=$((full + 1))
  { [ "$code" = 1 ] && grep -q "No space left on device" stderr.txt; } || fail "$bytes bytes: exit code $code"
  [ "$(cat old.olx)" = 'the old field' ] || fail "a full disk changed the old field"
done
[ "$full" -ge 4 ] || fail "the disk was full $full times alone"
expect 0 bake "${scene[@]}" -o old.olx --work full
cmp -s old.olx whole.olx || fail "another field after full disks"
[ -e full ] && fail "the folder stayed"

# When the work folder reaches its limit, a whole bake continues without it, while a part fails.
expect 0 bake "${scene[@]}" -o limited.olx --work limited --work-limit 0.0001
grep -q "limited: holds the 107374 bytes that it may" stderr.txt || fail "no word of the bound"
cmp -s limited.olx whole.olx || fail "another field with a bound"
printf 'the old field' >old.olx
complains 1 "more than the 107374 bytes that the work folder may take" bake "${scene[@]}" --work limited --part 1/1 --work-limit 0.0001

# A part writes no field, so that the folder in which it runs needs no room for one.
(cd /proc && "$OCTALUX" bake "${scene[@]}" --work "$folder/elsewhere" --part 1/1) >stdout.txt 2>stderr.txt ||
  fail "a part needs room where it runs"

# A whole bake makes a damaged link of the light again, even if only relighting reads it.
expect 0 bake "${scene[@]}" -o relight.olx --relight --work lit --keep-work
rm -f lit/relight-* lit/probe-*
printf 'X' | dd of=lit/cast-0-0.unit bs=1 seek=66 conv=notrunc 2>/dev/null
expect 0 bake "${scene[@]}" -o again.olx --relight --work lit
cmp -s again.olx relight.olx || fail "another field after damage to links"

# Where every probe is buried, there is no light to keep, and bakes resume all the same.
python3 - <<'END'
corners = [(x, y, z) for z in (0, 2) for y in (0, 2) for x in (0, 2)]
faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
open("cube.obj", "w").write("".join("v %d %d %d\n" % c for c in corners) +
                            "".join("f %d %d %d %d\n" % tuple(1 + i for i in face) for face in faces))
open("cube.json", "w").write('{"model": "cube.obj", "cameras": [{"name": "out", "eye": [5, 1, 1], "target": [1, 1, 1]}],'
                             '"lights": [{"type": "sun", "direction": [0, -1, 0], "irradiance": [1, 1, 1]}]}')
open("buried.json", "w").write('{"probes": [{"position": [1, 1, 1]}]}')
END
buried=(cube.json --probes buried.json --radiance-size 16 --noise 0.3 --relight)
expect 0 bake "${buried[@]}" -o buried.olx --work dark --keep-work
expect 0 bake "${buried[@]}" -o again.olx --work dark --keep-work
cmp -s again.olx buried.olx || fail "another field where all probes are buried"
expect 0 join dark -o again.olx
cmp -s again.olx buried.olx || fail "joining makes another field where all probes are buried"

exit "$((failures > 0))"
