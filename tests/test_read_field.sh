# An independent reader, written from docs/format.md, reads what the baker wrote and agrees with octalux info.
source "$(dirname "$0")/cli/expect.sh"
reader=$OCTALUX_SOURCE_DIR/tests/read_field.py

# agree SCENE OPTIONS...: bakes a field and checks that the independent reader agrees with octalux info.
agree() {
  local scene=$1
  shift
  [[ $scene == *.json ]] || scene=builtin:$scene
  expect 0 bake "$scene" -o a.olx "$@"
  expect 0 verify a.olx
  expect 0 info a.olx --json
  python3 "$reader" a.olx stdout.txt 2>stderr.txt || fail "$scene: the reader disagrees"
}

agree pillars --radiance-size 32 --irradiance-size 8 --bounces 0 --samples 1 --noise 0.5
agree holodeck --radiance-size 64 --irradiance-size 16 --bounces 0 --samples 1 --noise 0.5
agree holodeck --radiance-size 32 --bounces 0 --samples 1 --noise 0.5
grep -q '"probe_light": *false' stdout.txt || fail "probe light is the default"
LC_ALL=C grep -qa -e RADI -e IPOS -e IFLG -e IRRA -e MOME a.olx && fail "a field without probe light has a chunk of it"
agree two-rooms-gap --radiance-size 8 --irradiance-size 8 --bounces 0 --samples 1 --noise 0.5 --classic --classic-size 64 --cube-size 32
agree cornell --radiance-size 8 --irradiance-size 16 --bounces 0 --samples 1 --noise 0.5 --irradiance sh2
agree cornell --radiance-size 8 --irradiance-size 8 --bounces 0 --samples 1 --noise 0.5 --irradiance sh3
agree cornell --grid 1x1x1 --radiance-size 8 --irradiance-size 32 --bounces 1 --samples 1 --noise 0.5
agree cornell --grid 2x1x1 --radiance-size 16 --irradiance-size 8 --bounces 1 --samples 1 --noise 0.5 --relight \
  --select cage,voronoi,octree
LC_ALL=C grep -qa RLIT a.olx || fail "a field that can be relit has no chunk RLIT"
sed 's/"links":[^0-9]*[0-9]*/"links": 0/' stdout.txt >other.json
python3 "$reader" a.olx other.json 2>stderr.txt && fail "the reader does not compare the data for relighting"
grep -q '^relight.links: [0-9]* and 0$' stderr.txt || fail "the reader does not name the number of links"

# refuse CHUNK OFFSET BYTES WORDS: the reader refuses a.olx with other bytes in a chunk, which are given in hexadecimal
# and lie at an offset, counted from the chunk's end where it is negative. The message has these words.
refuse() {
  python3 - "$@" <<'PYTHON'
import struct, sys
name, offset, new = sys.argv[1].encode(), int(sys.argv[2]), bytes.fromhex(sys.argv[3])
data = bytearray(open("a.olx", "rb").read())
places = {chunk: (first, size) for chunk, _, first, size in struct.iter_unpack("<4sIQQ40x", data[64:64 + 64 * data[12]])}
first, size = places[name]
at = first + offset % size
data[at:at + len(new)] = new
open("damaged.olx", "wb").write(data)
PYTHON
  python3 "$reader" damaged.olx >/dev/null 2>stderr.txt && fail "the reader reads a damaged chunk $1"
  grep -q "$4" stderr.txt || fail "chunk $1: $(cat stderr.txt)"
}

links=$((64 + 108 * $(sed -n 's/.*"surfels": *\([0-9]*\).*/\1/p' stdout.txt)))
refuse RLIT 0 01000001 'RLIT: header'
refuse RLIT 28 00000001 'RLIT: header'
refuse RLIT 4 00000000 'RLIT: size'
refuse RLIT 20 00000000 'RLIT: of another field'
refuse RLIT 64 0000c07f 'RLIT: places of surfel 0'
refuse RLIT 160 ff 'RLIT: normal of surfel 0'
refuse RLIT $links 01 'RLIT: links'
refuse RLIT -12 ffffffff 'RLIT: surfel of volume link'
refuse VORO -2 0100 'VORO: order of the tree'
refuse VPOS 4 0000807f 'VPOS'
refuse MOME 88 003c0040 'MOME of probe 0'
agree two-rooms-gap --grid 2x1x1 --radiance-size 8 --bounces 0 --samples 1 --noise 0.5 --relight

# Blocks decode to nearly the same values as texels, and the reader checks texels as thoroughly.
agree cornell-glossy --grid 2x1x1 --radiance-size 32 --bounces 1 --noise 0.1 --uncompressed
mv a.olx texels.olx
agree cornell-glossy --grid 2x1x1 --radiance-size 32 --bounces 1 --noise 0.1
python3 "$reader" a.olx --like texels.olx >like.json 2>stderr.txt || fail "the reader does not compare"
python3 - <<'PYTHON' || fail "blocks hold something else: $(cat like.json)"
import json
e = json.load(open("like.json"))
assert max(e["direct"], e["indirect"]) < 3e-3 and e["base_color"] < 2e-3, e
assert max(e["roughness"], e["weight"], e["metallic"]) < 0.02, e
PYTHON

# Far from the origin, positions are relative to an origin that the field states.
echo '{"model": "builtin:cornell", "translate": [1e7, 0, -1e6]}' >far.json
agree far.json --grid 1x1x1 --radiance-size 8 --irradiance-size 8 --bounces 0 --samples 1 --noise 0.5
grep -q '"origin":\s*\[10000000, *0, *-1000000\]' stdout.txt || fail "a field far away has no origin"
LC_ALL=C grep -qa ORIG a.olx || fail "a field far away has no chunk ORIG"
agree cornell --grid 1x1x1 --radiance-size 8 --irradiance-size 32 --bounces 1 --samples 1 --noise 0.5
LC_ALL=C grep -qa ORIG a.olx && fail "a field at the origin has a chunk ORIG"

# The reader reports a difference.
sed 's/"probes": *1,/"probes":2,/' stdout.txt >other.json
cmp -s stdout.txt other.json && fail "the number of probes is not in the information"
python3 "$reader" a.olx other.json 2>stderr.txt && fail "the reader sees no difference"
grep -q '^probes: 1 and 2$' stderr.txt || fail "the reader does not name the difference"
head -c $(($(wc -c <a.olx) - 64)) a.olx >cut.olx
python3 "$reader" cut.olx stdout.txt 2>stderr.txt && fail "the reader reads a truncated file"

finish
