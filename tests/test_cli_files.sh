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

# Output that nobody can take is a failure too.
if [ -w /dev/full ]; then
  code=0
  "$OCTALUX" scene builtin:cornell >/dev/full 2>stderr.txt || code=$?
  [ "$code" = 1 ] || fail "a full standard output: exit code $code, not 1"
fi

finish
