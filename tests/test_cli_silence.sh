# Commands warn of results that are black, too bright for a field, or not to be compared: a scene without light, a sun in
# lux, and pictures with different numbers of bounces.
source "$(dirname "$0")/cli/expect.sh"

echo '{"model": "square.obj", "cameras": [{"eye": [0, 0, 3], "target": [0, 0, 0]}]}' >dark.json
printf 'v -1 -1 0\nv 1 -1 0\nv 1 1 0.5\nv -1 1 0\nf 1 2 3 4\n' >square.obj
small="--radiance-size 8 --irradiance-size 8 --samples 1"
expect 0 bake dark.json -o dark.olx --grid 1x1x1 $small --bounces 0
grep -q 'warning: the scene has no light' stderr.txt || fail "bake says nothing of a dark scene"
expect 0 render dark.json -o dark.exr --size 8x8 --spp 1
grep -q 'warning: the scene has no light' stderr.txt || fail "render says nothing of a dark scene"

sun='"lights": [{"type": "sun", "direction": [0, 0, -1], "irradiance": [1e5, 1e5, 1e5]}]'
echo '{"model": "square.obj", '"$sun"', "cameras": [{"eye": [0, 0, 3], "target": [0, 0, 0]}]}' >lux.json
expect 0 bake lux.json -o lux.olx --grid 1x1x1 $small --bounces 0
grep -q 'warning: .*brings 100000 W/m2, and a field holds at most 65408' stderr.txt ||
  fail "bake says nothing of light that is too bright for a field"

expect 0 bake builtin:cornell -o a.olx --grid 2x2x2 $small --bounces 1
grep -q 'no light\|bright light' stderr.txt && fail "bake warns of a lit scene"
expect 0 render builtin:cornell --field a.olx -o field.exr --size 16x16 --spp 1
expect 0 render builtin:cornell --method path --field a.olx -o like.exr --size 16x16 --spp 1
expect 0 render builtin:cornell --method path --bounces 2 -o two.exr --size 16x16 --spp 1
expect 0 render builtin:cornell --method path -o all.exr --size 16x16 --spp 1
expect 0 render builtin:cornell --method path --field a.olx --bounces 0 -o none.exr --size 16x16 --spp 1

# The path tracer takes two bounces: the field's one, and the one at the visible surface.
cmp -s like.exr two.exr || fail "--method path --field does not take the field's bounces"
cmp -s like.exr none.exr && fail "--bounces does not win over --field"
expect 0 compare field.exr like.exr
grep -q bounces stderr.txt && fail "compare warns of pictures with as many bounces"
expect 0 compare field.exr all.exr
grep -q 'field.exr has 2 bounces of indirect light and all.exr has all' stderr.txt || fail "compare is silent"
expect 0 compare field.exr none.exr
grep -q 'none.exr has 0' stderr.txt || fail "compare is silent about no bounces"

finish
