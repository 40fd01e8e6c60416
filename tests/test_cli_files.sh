# Files that are missing, malformed or cannot be written: exit code 1, a last line that names the file, no leftovers.
source "$(dirname "$0")/cli/expect.sh"

expect_failure "none.obj" scene none.obj
expect_failure "nosuchscene" scene builtin:nosuchscene
expect_failure "none.obj" bake none.obj -o a.olx
expect_failure "none.olx" info none.olx
expect_failure "none.olx" verify none.olx
expect_failure "none.olx" render builtin:cornell -o a.exr --field none.olx
expect_failure "none.olx" audit builtin:cornell --field none.olx
expect_failure "none.exr" compare none.exr none.exr

printf 'this is no field, no picture and no scene' >text.olx
cp text.olx text.exr
cp text.olx text.json
cp text.olx text.gltf
: >empty.olx
: >empty.exr
mkdir folder.olx folder.exr
for name in text empty folder; do
  expect_failure "$name.olx" info $name.olx
  expect_failure "$name.olx" verify $name.olx --json
  expect_failure "$name.exr" compare $name.exr $name.exr
done
expect_failure "text.json" scene text.json
expect_failure "text.gltf" scene text.gltf

expect_failure "no/such/folder/a.olx: cannot write" bake builtin:cornell -o no/such/folder/a.olx
expect_failure "no/such/folder/a.png: cannot write" render builtin:cornell -o no/such/folder/a.png
expect_failure "folder.olx: cannot write" bake builtin:cornell -o folder.olx
expect_failure "folder.exr: cannot write" render builtin:cornell -o folder.exr
expect_failure "no/d.png: cannot write" compare text.exr text.exr --heatmap no/d.png
expect_failure "nosuchcamera" render builtin:cornell -o a.exr --method path --size 8x8 --spp 1 --camera nosuchcamera
expect_files text.olx text.exr text.json text.gltf empty.olx empty.exr folder.olx folder.exr

# An output that cannot be written, because its device is full, is a failure too.
if [ -w /dev/full ]; then
  code=0
  "$OCTALUX" scene builtin:cornell >/dev/full 2>stderr.txt || code=$?
  [ "$code" = 1 ] || fail "a full standard output: exit code $code, not 1"
fi

# A model reads no files outside its parent folder, and stays within limits, unless options allow more.
mkdir -p scenes/models
printf 'newmtl square\nKd 1 0 0\n' >outside.mtl
printf 'mtllib ../../outside.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl square\nf 1 2 4 3\n' >scenes/models/square.obj
expect_failure "outside.mtl, which lies outside" scene scenes/models/square.obj
"$OCTALUX" scene scenes/models/square.obj --allow-outside >/dev/null 2>stderr.txt || fail "--allow-outside: $(cat stderr.txt)"

# A scene without light is reported before it is baked; one with a lamp, or with a sky alone, is not.
"$OCTALUX" scene scenes/models/square.obj --allow-outside --quiet >stdout.txt || fail "a square without light"
grep -q "warning    there is no light" stdout.txt || fail "scene says nothing of missing light: $(cat stdout.txt)"
printf '{"model": "scenes/models/square.obj", "environment": {"radiance": [0, 0, 1]}}' >sky.json
for lit in builtin:cornell sky.json; do
  "$OCTALUX" scene $lit --allow-outside --quiet >stdout.txt || fail "scene $lit"
  if grep -q "no light" stdout.txt; then fail "scene $lit misses a light: $(cat stdout.txt)"; fi
done
expect_failure "line 7: 4 corners in a polygon, more than the limit of 3" scene scenes/models/square.obj --import-limits polygon_corners=3
for command in bake render place; do
  case $command in bake) output=a.olx ;; render) output=a.exr ;; place) output=a.json ;; esac
  expect_failure "outside.mtl, which lies outside" $command scenes/models/square.obj -o $output
done
code=0
"$OCTALUX" scene builtin:cornell --import-limits corners=3 >/dev/null 2>stderr.txt || code=$?
[ "$code" = 2 ] || fail "--import-limits corners=3: exit code $code, not 2"

# A dry run reports a bake's needs, and a bake that does not fit is refused before it begins.
small="builtin:cornell -o a.olx --radiance-size 16 --irradiance-size 8 --samples 1"
expect_json 'o["probes"] == 8 and o["fits"] and o["estimated_seconds"] > 0 and 0 < o["device_bytes"] < o["expected_bytes"]' bake $small --dry-run
planned=$(python3 -c 'import json; print(json.load(open("stdout.txt"))["file_bytes"])')
[ -e a.olx ] && fail "--dry-run baked"
expect_json "$planned <= o['file_bytes'] <= $planned + 7.5 * 8 * 16**2 + 256" bake $small # at most 4 bytes a texel of emission, 3.5 of tiles
expect_json 'o["compressed"] is True and 8 * 4 * 8 < o["bytes"]["material"] <= 8 * 4 * (8 + 4 * 24) and 8 * 4 * (4 + 16) <= o["bytes"]["direct"] <= 8 * 4 * (4 + 4 * 16)' info a.olx
expect 0 info a.olx
grep -q "light, material *in tiles of 8x8 texels" stdout.txt || fail "info does not tell of tiles"
expect 0 bake $small --uncompressed
expect_json 'o["compressed"] is False and (o["bytes"]["material"], o["bytes"]["direct"]) == (8 * 18**2 * 6, 8 * 18**2 * 4)' info a.olx
expect 0 verify a.olx
rm -f a.olx
expect_failure "1000000 light field probes make a file of" bake builtin:cornell --grid 100x100x100 -o a.olx
expect_failure "1000000 light field and 1000000 irradiance probes make a file of" bake builtin:cornell --grid 100x100x100 --probe-light -o a.olx
[ -e a.olx ] && fail "an impossible bake left a file"
expect 1 bake builtin:cornell --grid 100x100x100 --radiance-size 2048 --samples 1 -o a.olx --dry-run
grep -q "make a file of" stderr.txt && grep -q "1000000 of light" stdout.txt || fail "--dry-run of an impossible bake"

# Text from files reaches no terminal unescaped: a camera's name, and JSON.
printf '{"model": "builtin:cornell", "cameras": [{"name": "\\u001b[2J\\u009b1m", "eye": [0,1,3], "target": [0,1,0]}], "\\u001bkey": 1}' >evil.json
for arguments in "scene evil.json" "scene evil.json --json" "render evil.json --method path --camera none -o a.exr"; do
  "$OCTALUX" $arguments >stdout.txt 2>stderr.txt
  LC_ALL=C grep -q -e "$(printf '\033')" -e "$(printf '\302\233')" stdout.txt stderr.txt && fail "octalux $arguments: control characters"
done
expect_json 'o["camera_list"][0]["name"] == "\x1b[2J\x9b1m"' scene evil.json
printf '\211PNG\r\n\032\nand more' >b.png
expect_failure "b.png: not an OpenEXR image but a PNG" compare b.png b.png

finish
