# octalux export as a user types it: exported maps agree with the field in every projection, and the exported model is
# valid and is where the probes are.
source "$(dirname "$0")/cli/expect.sh"
read_export=$OCTALUX_SOURCE_DIR/tests/read_export.py
check() { python3 "$read_export" "$@" >stdout.txt 2>stderr.txt || fail "read_export.py $*"; }

"$OCTALUX" bake builtin:cornell-glossy -o all.olx --uncompressed --radiance-size 32 --irradiance-size 16 --noise 0.2 --relight --classic --classic-size 32 --cube-size 32 \
  --select cage,bricks >stdout.txt 2>stderr.txt
"$OCTALUX" bake builtin:cornell -o plain.olx --radiance-size 16 --noise 0.5 --grid 2x1x2 >stdout.txt 2>stderr.txt

# Every map is exported as it is stored, under the library's names.
light="distance emitter normal base_color roughness metallic specular_weight direct indirect radiance"
for map in $light irradiance mean_distance mean_square_distance classic_irradiance; do
  expect_json "o['map'] == '$map' and o['probe'] == 1 and o['width'] == o['height'] and o['projection'] == 'octahedral'" \
    export exr all.olx --map $map --probe 1 -o $map.exr
  check exr all.olx $map 1 octahedral 0 $map.exr
done
for map in emission classic_radiance_0 classic_radiance_1 classic_radiance_2 classic_radiance_3 classic_radiance_4 volume_irradiance; do
  expect_json "o['map'] == '$map'" export exr all.olx --map $map -o other.exr
done
expect 0 compare radiance.exr radiance.exr # exported maps are valid EXR files

# Other projections are exported at their default sizes and at another size.
for projection in latlong cube; do
  expect 0 export exr all.olx --map direct --projection $projection -o a.exr
  check exr all.olx direct 0 $projection 0 a.exr
  expect 0 export exr all.olx --map distance --probe 7 --projection $projection --size 25 -o a.exr
  check exr all.olx distance 7 $projection 25 a.exr
done
expect 0 export exr all.olx --map normal --projection cube -o a.exr
check exr all.olx normal 0 cube 0 a.exr

# Exports that are impossible are refused with a message.
expect_failure "plain.olx: no map radiance: baked without probe light (bake --probe-light)" export exr plain.olx --map radiance -o b.exr
expect_failure "no map classic_irradiance: baked without classic maps" export exr plain.olx --map classic_irradiance -o b.exr
expect_failure "no probe 4: map distance is of 4 light field probes" export exr plain.olx --map distance --probe 4 -o b.exr
expect_failure "an octahedral picture has that of its map, 16" export exr plain.olx --map distance --size 8 -o b.exr
expect_failure "no/b.exr: cannot write" export exr plain.olx --map distance -o no/b.exr
expect_failure "none.olx" export gltf none.olx -o b.gltf
"$OCTALUX" pack plain.olx --level 1 >stdout.txt 2>stderr.txt
expect_failure "a packed field" export gltf plain.olxz -o b.gltf
expect_usage "FORMAT is missing" export
expect_usage "'obj' is not one of exr, gltf, ktx2, web" export obj all.olx -o b.obj
expect_usage "FIELD is missing" export exr
expect_usage "-o FILE.exr is missing" export exr all.olx --map direct
expect_usage "--map NAME is missing" export exr all.olx -o b.exr
expect_usage "'light' is not one of distance|" export exr all.olx --map light -o b.exr
expect_usage "'b.png' does not end in .exr" export exr all.olx --map direct -o b.png
expect_usage "'b.glb' does not end in .gltf" export gltf all.olx -o b.glb
expect_usage "whole number from 1 to 2048" export exr all.olx --map direct --projection cube --size 4096 -o b.exr
expect_usage "'b.ktx' does not end in .ktx2" export ktx2 all.olx -o b.ktx
expect_usage "unknown option '--spacng'; did you mean --spacing?" export ktx2 all.olx -o b.ktx2 --spacng 1
expect_usage "--size and --spacing exclude each other" export ktx2 all.olx -o b.ktx2 --size 4x4x4 --spacing 1
expect_usage "'4x0x4' is not a grid like 4x4x4" export ktx2 all.olx -o b.ktx2 --size 4x0x4
expect_failure "4x4x700 voxels: each at least 1, at most 2048x1024x682" export ktx2 all.olx -o b.ktx2 --size 4x4x700
expect_failure "none.olx" export ktx2 none.olx -o b.ktx2
"$OCTALUX" bake builtin:cornell -o dark.olx --radiance-size 16 --noise 0.5 --grid 2x1x2 --volume-cells 0 >stdout.txt 2>stderr.txt
expect_failure "dark.olx: baked without an irradiance volume (bake --volume-cells)" export ktx2 dark.olx -o b.ktx2
head -c 3000 plain.olx >cut.olx
expect_failure "cut.olx" export ktx2 cut.olx -o b.ktx2
expect_usage "SCENE is missing" export web
expect_usage "--field FILE.olx is missing" export web builtin:cornell -o b.web
expect_usage "-o DIR is missing" export web builtin:cornell --field plain.olx
ls b.* 2>/dev/null && fail "a refused export left a file"

# Models are exported from a field with every kind of data, from one without irradiance probes, and from a scene far
# away.
printf '{"model": "far.obj", "cameras": [{"name": "a", "eye": [5000001, 1, 1], "target": [5000001, 0, 0]}]}' >far.json
python3 - <<'PYTHON'
x = 5e6
corners = [(x + i, j, k) for i in (0, 2) for j in (0, 2) for k in (0, 2)]
faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
open("far.obj", "w").write("".join(f"v {a} {b} {c}\n" for a, b, c in corners) + "".join(f"f {' '.join(map(str, f))}\n" for f in faces))
PYTHON
"$OCTALUX" bake far.json -o far.olx --radiance-size 16 --noise 0.5 --grid 2x2x1 >stdout.txt 2>stderr.txt || fail "a bake far away"
for name in all plain far; do
  expect_json "o['output'] == '$name.gltf' and o['probes'] > 0" export gltf $name.olx -o $name.gltf
  cp stdout.txt $name.json.txt
  check gltf $name.olx $name.gltf $name.json.txt
done
grep -q '"translation":\[[0-9]*[1-9]' far.gltf || fail "a model of a scene far away has no origin"
expect 0 export gltf all.olx -o all.gltf
grep -q "^all.gltf: 8 light field probes, 27 irradiance probes, .* bricks whole and .* divided$" stdout.txt || fail "export says what it wrote"
"$OCTALUX" export gltf all.olx -o - 2>stderr.txt | cmp - all.gltf || fail "standard output is another model"
expect_json 'o["triangles"] >= 8 * (8 + 27)' scene all.gltf # our own importer reads the model, including its octahedra

# Irradiance volumes: the sizes that are requested, the transform in scene coordinates, the same bytes in every way.
expect_json "o['size'] == [32, 32, 32] and o['written_error'] <= 0.5 * o['captured_error']" export ktx2 all.olx -o all.ktx2
expect_json "o['size'] == [3, 4, 5] and o['file_bytes'] > 4 * 6 * 60" export ktx2 all.olx -o b.ktx2 --size 3x4x5
expect_json "o['size'] == [6, 6, 6] and abs(o['scale'][1] - 0.6) < 1e-6" export ktx2 all.olx -o b.ktx2 --spacing 0.1
expect_json "o['written_error'] == o['captured_error']" export ktx2 all.olx -o b.ktx2 --plain --size 6x6x6
expect_json "abs(o['translation'][0] - 5000001) < 0.01" export ktx2 far.olx -o b.ktx2 --size 2x2x2
expect 0 export ktx2 all.olx -o small.ktx2 --size 8x8x8
expect 0 export ktx2 all.olx -o b.ktx2 --size 8x8x8 --threads 1
grep -q "^b.ktx2: 8x8x8 voxels, [0-9]* of them inside geometry, 1[0-9].[0-9] KiB$" stdout.txt || fail "export ktx2 says what it wrote"
grep -q "^  transform  translation 0.27[0-9]* 0.27[0-9]* 0.27[0-9]*, scale 0.[56][0-9]* 0.[56][0-9]* 0.[56][0-9]* (metres, y up)$" stdout.txt ||
  fail "export ktx2 does not print the transform"
cmp -s small.ktx2 b.ktx2 || fail "one thread writes another volume"
"$OCTALUX" export ktx2 all.olx -o - --size 8x8x8 2>stderr.txt | cmp - small.ktx2 || fail "standard output is another volume"
[ "$(head -c 7 all.ktx2 | tail -c 6)" = "KTX 20" ] && grep -aq '"translation":\[0.27' all.ktx2 || fail "the file does not name its transform"
"$OCTALUX" export ktx2 all.olx -o b.ktx2 --size 8x8x8 --zstd >stdout.txt 2>stderr.txt
[ "$(stat -c %s b.ktx2)" -lt "$(stat -c %s small.ktx2)" ] || fail "--zstd makes no smaller file"

# Pages: with the program's own page beside it the scene, the field and the page are written; a program without the page
# beside it says what is missing.
mkdir alone
cp "$OCTALUX" alone/octalux
if alone/octalux export web builtin:cornell --field plain.olx -o room >stdout.txt 2>stderr.txt; then fail "a page without a page"; fi
grep -q "the page is missing beside this program.*node, npm, clang and lld" stderr.txt || fail "export web does not say what is missing"
[ ! -e room ] || fail "a refused export made a folder"
mkdir alone/web
echo "<!doctype html>" >alone/web/index.html
if alone/octalux export web builtin:cornell-glossy --field plain.olx -o room >stdout.txt 2>stderr.txt; then fail "a field of another scene"; fi
alone/octalux export web builtin:cornell --field plain.olx -o room --json >stdout.txt 2>stderr.txt || fail "export web"
[ "$(ls room | tr '\n' ' ')" = "field.olx.gz index.html scene.glb.gz " ] || fail "export web wrote $(ls room)"
gzip -dc room/field.olx.gz | cmp - plain.olx || fail "the field is another one after gzip"
gzip -dc room/scene.glb.gz >room.glb
expect_json "o['triangles'] == 32 and o['materials'] == 4" scene room.glb
"$OCTALUX" scene builtin:cornell --json >a.json
"$OCTALUX" scene room.glb --json >b.json
python3 - <<'PYTHON' || fail "the exported model is another scene"
import json
a, b = json.load(open("a.json")), json.load(open("b.json"))
near = lambda x, y: all(abs(p - q) < 1e-6 for p, q in zip(x, y))
assert all(a[key] == b[key] for key in ("triangles", "lights", "materials", "textures"))
assert near(a["bounds_min"], b["bounds_min"]) and near(a["bounds_max"], b["bounds_max"])
assert near(a["camera_list"][0]["eye"], b["camera_list"][0]["eye"])
assert abs(a["camera_list"][0]["fov_y_degrees"] - b["camera_list"][0]["fov_y_degrees"]) < 1e-3
PYTHON

# Without reflections the page gets a smaller field, whose chunks are filtered, so that no other reader takes it.
alone/octalux export web builtin:cornell --field plain.olx --no-glossy -o dull --json >stdout.txt 2>stderr.txt || fail "export web --no-glossy"
gzip -dc dull/field.olx.gz >dull.olx
[ "$(stat -c %s dull.olx)" -lt "$(stat -c %s plain.olx)" ] || fail "a field without reflections is no smaller"
expect_failure "dull.olx: chunk .*unknown flags" info dull.olx
cmp -s room/scene.glb.gz dull/scene.glb.gz || fail "--no-glossy writes another model"

finish
