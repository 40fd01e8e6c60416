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
agree cornell --grid 2x1x1 --radiance-size 16 --bounces 1 --samples 1 --noise 0.5 --relight
LC_ALL=C grep -qa RLIT a.olx || fail "a field that can be relit has no chunk RLIT"
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
