# octalux pack and unpack as a user types them: default names, identical bytes after both, damage, limits, and messages
# of other commands.
source "$(dirname "$0")/cli/expect.sh"

"$OCTALUX" bake builtin:cornell -o a.olx --radiance-size 128 --irradiance-size 32 --probe-light --select cage,voronoi,bricks \
  >stdout.txt 2>stderr.txt
cp a.olx original.olx

# Packing and unpacking with default names restores the same bytes.
expect 0 pack a.olx
grep -q "^a.olxz: a field of .*, packed .* (.* %)$" stdout.txt || fail "pack says what it did"
rm a.olx
expect 0 unpack a.olxz
grep -q "^a.olx: a field of " stdout.txt || fail "unpack says what it did"
cmp a.olx original.olx || fail "unpack made another field"
expect_files a.olx a.olxz original.olx
[ $((10 * $(stat -c %s a.olxz))) -lt $((6 * $(stat -c %s a.olx))) ] || fail "a packed field of $(stat -c %s a.olxz) bytes"

# Explicit names, other levels and numbers of threads are accepted.
expect_json 'o["output"] == "b.olxz" and o["packed_bytes"] < o["field_bytes"] == '"$(stat -c %s a.olx)" pack a.olx -o b.olxz --threads 3
cmp a.olxz b.olxz || fail "the bytes depend on threads"
expect 0 pack a.olx -o fast.olxz --level 1
[ "$(stat -c %s fast.olxz)" -gt "$(stat -c %s a.olxz)" ] || fail "level 1 packs as small as level 19"
expect 0 pack a.olx -o b.olxz # replaces an existing file
expect_json 'o["output"] == "b.olx" and o["field_bytes"] == '"$(stat -c %s a.olx)" unpack fast.olxz -o b.olx
cmp b.olx original.olx || fail "level 1 lost something"
cp a.olx plain
expect 0 pack plain -o plain.olxz
rm -f plain plain.olxz fast.olxz b.olx b.olxz

# Other commands recognise a packed field: info and verify describe it, others say how to unpack it.
expect 0 info a.olxz
grep -q '^a.olxz: a packed field, .*; `octalux unpack a.olxz` makes the field of ' stdout.txt || fail "info says what it is"
grep -q "^  RADI " stdout.txt || fail "info lists chunks"
expect_json 'o["packed"] and o["file_bytes"] < o["field_bytes"] and sum(c["field_bytes"] for c in o["chunks"]) < o["field_bytes"] and o["chunks"][0]["type"] == "INFO"' info a.olxz
expect_json 'o["sound"] and o["file_bytes"] == '"$(stat -c %s a.olxz)" verify a.olxz
expect 0 verify a.olxz
grep -q '^a.olxz: packed soundly, ' stdout.txt || fail "verify says what was checked"
unpack_it='a.olxz: a packed field; `octalux unpack` makes a field of it again'
expect_failure "$unpack_it" render builtin:cornell --field a.olxz -o a.png
expect_failure "$unpack_it" audit builtin:cornell --field a.olxz
expect_failure "$unpack_it" pack a.olxz -o b.olxz
expect_failure "a.olx: a field that is not packed" unpack a.olx -o b.olx

# Wrong usage and impossible outputs are refused.
expect_usage "FIELD is missing" pack
expect_usage "PACKED is missing" unpack
expect_usage "'b.zip' does not end in .olxz" pack a.olx -o b.zip
expect_usage "'b.zip' does not end in .olx" unpack a.olxz -o b.zip
cp a.olx plain
expect_usage "'plain' does not end in .olx: say with -o what to write" pack plain
rm plain
for level in 0 23 -1 best ''; do expect_usage "is not a whole number from 1 to 22" pack a.olx --level "$level"; done
expect_failure "none.olx" pack none.olx
expect_failure "none.olxz" unpack none.olxz
expect_failure "no/such/b.olxz: cannot write" pack a.olx -o no/such/b.olxz
ln -s a.olx same.olxz
expect_failure "it is the input a.olx" pack a.olx -o same.olxz
rm same.olxz
expect_failure "more than the limit of 1000000" unpack a.olxz -o b.olx --most 1
expect_files a.olx a.olxz original.olx

# A damaged file is named in the error, nothing is written, and existing files stay.
size=$(stat -c %s a.olxz)
printf 'old' >b.olx
for keep in 0 7 63 64 500 $((size / 2)) $((size - 1)); do
  head -c "$keep" a.olxz >cut.olxz
  expect_failure "cut.olxz" unpack cut.olxz -o b.olx
done
for at in 3 9 30 70 300 2000 $((size / 3)) $((size / 2)) $((size - 100)); do
  python3 - a.olxz "$at" <<'PYTHON' >cut.olxz
import sys
data = bytearray(open(sys.argv[1], "rb").read())
data[int(sys.argv[2])] ^= 4
sys.stdout.buffer.write(data)
PYTHON
  expect_failure "cut.olxz" unpack cut.olxz -o b.olx
  expect 1 verify cut.olxz
done
[ "$(cat b.olx)" = old ] || fail "a damaged file changed the output"
python3 - a.olx <<'PYTHON' >damaged.olx
import sys
data = bytearray(open(sys.argv[1], "rb").read())
data[len(data) // 2] ^= 4
sys.stdout.buffer.write(data)
PYTHON
expect_failure "damaged.olx: chunk .*: wrong checksum" pack damaged.olx
expect_files a.olx a.olxz original.olx b.olx cut.olxz damaged.olx
finish
