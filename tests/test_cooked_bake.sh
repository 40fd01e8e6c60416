# A cooked scene bakes to the same bytes as its source, by the command line and by a program that links Embree alone.
source "$(dirname "$0")/cli/expect.sh"
bake_cooked=$(dirname "$OCTALUX")/bench/bake_cooked

expect 0 scene builtin:cornell-glossy --cook scene.olxs
grep -q "cooked  *scene.olxs, $(stat -c %s scene.olxs) bytes" stdout.txt || fail "the size is not told"
expect_json "o['cooked_bytes'] > 0 and o['triangles'] > 10" scene builtin:cornell-glossy --cook scene.olxs
expect_usage "does not end in .olxs" scene builtin:cornell --cook scene.olx
expect_failure "no/scene.olxs: cannot write" scene builtin:cornell --cook no/scene.olxs

# The reports of `scene` for both differ only in the scene's name.
"$OCTALUX" scene builtin:cornell-glossy --json >source.json
"$OCTALUX" scene scene.olxs --json >cooked.json
cmp -s source.json cooked.json || fail "the cooked scene is told differently"

expect 0 bake builtin:cornell-glossy -o source.olx --radiance-size 32 --irradiance-size 8
expect 0 bake scene.olxs -o cooked.olx --radiance-size 32 --irradiance-size 8
cmp -s source.olx cooked.olx || fail "the cooked scene bakes differently"
"$bake_cooked" scene.olxs alone.olx 32 8 || fail "bake_cooked"
cmp -s source.olx alone.olx || fail "a program of its own bakes differently"

# Both scenes render to the same picture.
expect 0 render builtin:cornell-glossy --method path --spp 2 --size 32x24 -o source.exr
expect 0 render scene.olxs --method path --spp 2 --size 32x24 -o cooked.exr
cmp -s source.exr cooked.exr || fail "the cooked scene renders differently"

if command -v readelf >/dev/null; then
  readelf -d "$bake_cooked" | grep NEEDED >needed.txt
  grep -q embree needed.txt || fail "bake_cooked does without Embree"
  grep -i -E 'assimp|cjson|exr' needed.txt && fail "bake_cooked needs an importer's library"
fi

printf 'no scene' >text.olxs
expect_failure "text.olxs: 8 bytes are too short for a cooked scene" scene text.olxs
finish
