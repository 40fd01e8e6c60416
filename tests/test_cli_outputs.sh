# Outputs of the command line: devices and pipes are written to and not replaced, "-" is standard output, no output
# destroys an input, and a replaced file keeps its owner, its rights and the links to it.
source "$(dirname "$0")/cli/expect.sh"

place=(place builtin:cornell --method grid --grid 2x2x2 --voxels 16)
bake=(bake builtin:cornell --grid 2x2x2 --radiance-size 8 --irradiance-size 8 --bounces 0)
render=(render builtin:cornell --method path --size 8x8 --spp 1)

# Device nodes of this test's own, which only root may make; any user may make a pipe.
if mknod null c 1 3 2>/dev/null && : >null; then
  expect 0 "${place[@]}" -o null
  [ -c null ] || fail "place replaced a device"
  expect_failure "null: cannot write: it is a character device" "${bake[@]}" -o null
  [ -c null ] || fail "bake replaced a device"
  ln -s null null.png
  expect 0 "${render[@]}" -o null.png
  ln -s null null.exr
  expect_failure "null.exr: cannot write: it is a character device" "${render[@]}" -o null.exr
  [ -c null ] && [ -L null.png ] && [ -L null.exr ] || fail "render replaced a device or a link"
  mknod disk b 7 200
  expect_failure "disk: cannot write: it is a block device" "${place[@]}" -o disk
  expect_failure "disk: cannot write: it is a block device" "${bake[@]}" -o disk
  [ -b disk ] || fail "a block device was replaced"
  rm -f null null.png null.exr disk
fi
mkfifo pipe.png
cat pipe.png >piped.png &
reader=$!
expect 0 "${render[@]}" -o pipe.png
wait "$reader"
[ -p pipe.png ] || fail "render replaced a pipe"
expect 0 "${render[@]}" -o plain.png
cmp -s piped.png plain.png || fail "a picture through a pipe is another one"
expect_failure "it is a pipe" "${bake[@]}" -o pipe.png
rm -f pipe.png piped.png

# "-" writes to standard output.
expect 0 "${place[@]}" -o plain.json
expect 0 "${place[@]}" -o -
python3 -c 'import json; json.load(open("stdout.txt"))' || fail "place -o - is no JSON"
cmp -s stdout.txt plain.json || fail "place -o - is not what place -o FILE writes"
grep -q "8 probes by grid" stderr.txt || fail "place -o - does not report on standard error"
expect 0 "${render[@]}" -o -
cmp -s stdout.txt plain.png || fail "render -o - is not what render -o FILE.png writes"
expect 0 scene builtin:cornell --cook plain.olxs
expect 0 scene builtin:cornell --cook -
cmp -s stdout.txt plain.olxs || fail "scene --cook - is not what --cook FILE writes"
expect_failure "standard output: cannot write: this format is not written in order" "${bake[@]}" -o -
expect_usage "exclude each other: both are standard output" "${place[@]}" -o - --json
expect_failure "another output goes there" "${place[@]}" -o - --picture -
expect_files plain.json plain.png plain.olxs

# No output may replace an input, even by another name for it.
mkdir model
cat >model/square.obj <<'OBJ'
mtllib square.mtl
v 0 0 0
v 1 0 0
v 1 0 1
v 0 0 1
vt 0 0
usemtl grey
f 1/1 2/1 3/1 4/1
OBJ
printf 'newmtl grey\nKd 0.5 0.5 0.5\nmap_Kd grey.png\n' >model/square.mtl
cp plain.png model/grey.png
python3 - <<'GLTF' || fail "no model to test with"
import json, struct
open("model/a.bin", "wb").write(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 0, 1))
json.dump({"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 36}],
           "bufferViews": [{"buffer": 0, "byteLength": 36}],
           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                          "min": [0, 0, 0], "max": [1, 0, 1]}],
           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
           "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0}, open("model/triangle.gltf", "w"))
GLTF
echo '{"models": [{"path": "model/square.obj"}, {"path": "model/triangle.gltf"}],
       "probes": {"playable": {"min": [0, 0, 0], "max": [1, 1, 1]}}}' >scene.json
ln -s scene.json link.json
ln scene.json other.json
find . -type f ! -name '*.txt' -exec sha256sum {} + | sort >sums.txt
for output in scene.json link.json other.json ./scene.json; do
  expect_failure "$output: cannot write: it is the input scene.json" place scene.json -o "$output" --method grid
  expect_failure "$output: cannot write: it is the input scene.json" bake scene.json -o "$output"
done
for output in model/square.obj model/square.mtl model/grey.png model/triangle.gltf model/a.bin; do
  expect_failure "cannot write: the scene was read from it" place scene.json -o "$output" --method grid
  expect_failure "cannot write: the scene was read from it" bake scene.json -o "$output"
done
expect_failure "cannot write: the scene was read from it" render scene.json --method path -o model/grey.png
expect_failure "plain.olxs: cannot write: it is the input" bake plain.olxs -o plain.olxs
expect_failure "plain.olxs: cannot write: it is the input" scene plain.olxs --cook plain.olxs
cp plain.olxs field.png
expect_failure "field.png: cannot write: it is the input" render builtin:cornell --field field.png -o field.png
rm field.png
expect_failure "plain.json: cannot write: it is the input" bake builtin:cornell --probes plain.json -o plain.json
ln -s plain.png page.html
for output in --heatmap --flip-map; do
  expect_failure "plain.png: cannot write: it is the input" compare plain.png other.exr $output plain.png
done
expect_failure "page.html: cannot write: it is the input plain.png" compare plain.png plain.png --report page.html
expect_failure "a.png: cannot write: another output" compare plain.png plain.png --heatmap a.png --flip-map a.png
rm page.html
find . -type f ! -name '*.txt' -exec sha256sum {} + | sort | diff sums.txt - || fail "an input changed"
rm -f sums.txt

# A replaced file keeps its links and rights.
echo old >private.json
chmod 640 private.json
ln -s private.json alias.json
expect 0 "${place[@]}" -o alias.json
[ -L alias.json ] && [ "$(stat -c %a private.json)" = 640 ] && cmp -s private.json plain.json ||
  fail "a link, or the rights of what it leads to, was not kept"
finish
