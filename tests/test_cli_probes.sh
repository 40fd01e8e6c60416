# Light field probes at positions from `octalux place`, from placement to picture.
source "$(dirname "$0")/cli/expect.sh"
scene=builtin:cornell-glossy
small="--radiance-size 64 --irradiance-size 16 --bounces 1 --noise 0.2"

expect 0 place $scene -o probes.json --count 5 --voxels 64 --surfels 4000 --candidates 400 --resolution 64
expect_json 'o["probes"] == 5 and o["irradiance_probes"] == 27' bake $scene -o free.olx --probes probes.json $small
expect_json 'o["probes"] == 5 and "grid" not in o and o["irradiance_grid"]["count"] == [3, 3, 3]' info free.olx
expect 0 verify free.olx
python3 "$(dirname "$0")/read_field.py" free.olx >/dev/null || fail "the independent reader refuses the field"

# The few placed probes see nearly everything.
expect_json 'o["rays"]["unresolved_seen"] < 0.05 and o["rays"]["wrong_seen"] < 0.05 and o["rays"]["unseen"] < 0.1' \
  audit $scene --field free.olx --rays 5000 --points 0
expect 0 audit $scene --field free.olx --rays 100 --points 0 --select exhaustive
expect 0 render $scene -o free.png --field free.olx --size 48x36 --spp 1 --show-probes

# All selectors can be baked together and chosen by --select, and are no worse than the exhaustive search. Bricks are
# the default.
expect_json 'o["select"] == "bricks" and o["bytes"]["selector"] < 7500' info free.olx
both="--probes probes.json $small --irradiance-grid 2x2x2 --select octree,voronoi,bricks"
expect_json 'o["irradiance_probes"] == 8' bake $scene -o both.olx $both
expect 0 bake $scene -o again.olx $both --threads 1
cmp both.olx again.olx || fail "a field of free probes depends on the number of threads"
expect_json 'o["select"] == "voronoi,octree,bricks" and o["bytes"]["selector"] > 5000' info both.olx
expect 0 verify both.olx
python3 "$(dirname "$0")/read_field.py" both.olx >/dev/null || fail "the independent reader refuses the selectors"
for select in voronoi octree bricks; do
  expect_json 'o["rays"]["unresolved_seen"] < 0.05 and o["rays"]["wrong_seen"] < 0.05 and o["rays"]["probes_mean"] < 3' \
    audit $scene --field both.olx --rays 5000 --points 0 --select $select
done

# Probes of another scene are taken with a warning, which --quiet leaves out.
expect 0 bake builtin:cornell -o x.olx --probes probes.json --dry-run $small
grep -q "warning: probes.json: placed in another scene" stderr.txt || fail "no warning of another scene's probes"
expect 0 bake builtin:cornell -o x.olx --probes probes.json --dry-run $small --quiet
[ -s stderr.txt ] && fail "--quiet warns"

# A budget places probes and chooses maps; with the size of maps given it chooses how many probes, with probes given it
# chooses their maps, and with both it is a check. The file keeps to it.
rough="--noise 0.5 --samples 1 --bounces 0"
within() { expect_json "$1 and o['file_bytes'] <= 1.05 * $2 * 1e6" bake $scene -o budget.olx --budget $2 $rough "${@:3}"; }
within 'o["probes"] > 1 and o["radiance_size"] == 64' 0.15
within 'o["probes"] == 5 and o["radiance_size"] == 64' 0.2 --probes probes.json
within 'o["probes"] > 10 and o["radiance_size"] == 32' 0.1 --radiance-size 32
within 'o["probes"] > 1 and o["irradiance_probes"] > 0' 0.2 --radiance-size 32 --probe-light --irradiance-size 8
expect_json 'o["probes"] == 8 and o["radiance_size"] == 128 and o["expected_bytes"] < 7.5e5' \
  bake $scene -o x.olx --dry-run --budget 0.75 --grid 2x2x2 $rough
grep -q "^octalux bake: 8 probes of 128 x 128 texels, about 0.4[0-9]* MB of a budget of 0.75 MB$" stderr.txt ||
  fail "the choice is not announced"
expect_failure "a budget of 0.005 MB does not hold a field of 5 probes: .* it takes 0.00[0-9]* MB" \
  bake $scene -o x.olx --budget 0.005 --probes probes.json
expect_failure "5 probes of 512 x 512 texels take about 3.7[0-9]* MB, more than the budget of 1 MB" \
  bake $scene -o x.olx --budget 1 --radiance-size 512 --probes probes.json
expect_usage "budget" bake $scene -o x.olx --budget 0

# Where neither the command line nor the scene says where probes are, they are placed, and the bake says how many; where
# there is no place for any, they are on a grid, with a warning.
python3 - <<'END'
corners = [(x, y, z) for x in (0, 4) for y in (0, 3) for z in (0, 5)]
faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
with open("room.obj", "w") as out:
    out.writelines("v {} {} {}\n".format(*corner) for corner in corners)
    out.writelines("f {} {} {} {}\n".format(*face[::-1]) for face in faces)
END
printf '{"model": "room.obj", "lights": [{"type": "point", "position": [2, 2, 2], "intensity": [1, 1, 1]}]}' >room.json
rooms="--radiance-size 32 --noise 0.5"
expect 0 place room.json -o room-probes.json --resolution 32
expect 0 bake room.json -o placed.olx $rooms
grep -q "^octalux bake: placed [1-9][0-9]* probes; " stderr.txt || fail "a bake does not say that it places probes: $(cat stderr.txt)"
expect 0 bake room.json -o given.olx $rooms --probes room-probes.json
cmp placed.olx given.olx || fail "a bake places other probes than octalux place"
expect_json 'o["probes"] == 8' bake room.json -o grid.olx $rooms --grid 2x2x2
sed 's/"model"/"probes": {"grid": [3, 1, 2]}, "model"/' room.json >gridded.json
expect_usage "a bake in shares needs --probes" bake room.json --work room.work --part 1/2 $rooms
expect_usage "a bake in shares needs --probes" bake gridded.json --work room.work --part 1/2 --budget 1
expect_json 'o["probes"] == 64' bake room.json -o cages.olx $rooms --select cage
expect_json 'o["probes"] == 6' bake gridded.json -o gridded.olx $rooms

printf 'v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nf 4 3 2 1\n' >plane.obj
expect_failure "probe grid: 4 probes at the same y: a flat scene needs one probe along that axis" bake plane.obj -o x.olx
grep -q "^warning: nowhere to place probes: .*; probes are on a grid of 4x4x4 over the bounds instead$" stderr.txt ||
  fail "no warning of a scene without a place for probes: $(cat stderr.txt)"
expect 0 place $scene --method grid --grid 2x2x2 --voxels 32 --budget 0.001 -o grid.json # which ignores the budget
expect_usage "--coverage: '2' is not a number above 0 and at most 1" place $scene -o x.json --coverage 2
expect_usage "--noise: '2' is not a number from 0.001 to 1" bake $scene -o x.olx --noise 2

# Impossible requests are refused: a selector that was not baked, a cage without a grid, contradictory options, broken
# files.
expect_failure "baked without the selector 'cage'" audit $scene --field free.olx --rays 100 --points 0 --select cage
expect_failure "baked without the selector 'cage'" render $scene -o x.exr --field free.olx --select cage
expect_failure "needs probes on a grid" bake $scene -o x.olx --probes probes.json --select cage
expect_usage "exclude each other" bake $scene -o x.olx --probes probes.json --grid 2x2x2
expect_failure "nowhere.json" bake $scene -o x.olx --probes nowhere.json
echo '{"probes": [{"position": [0, 0]}]}' >broken.json
expect_failure "probes\[0\].position" bake $scene -o x.olx --probes broken.json
echo '{"probes": []}' >empty.json
expect_failure "at least one probe" bake $scene -o x.olx --probes empty.json
[ ! -e x.olx ] && [ ! -e x.exr ] || fail "a failed command left a file"

# A field may have one probe, and probes may come from a file made by hand.
echo '{"probes": [{"position": [0.278, 0.3, 0.1]}]}' >one.json
expect_json 'o["probes"] == 1' bake $scene -o one.olx --probes one.json $small --irradiance-grid 2x2x2
expect 0 render $scene -o one.exr --field one.olx --size 32x24 --spp 1

finish
