# Light field probes at positions from `octalux place`, from placement to picture.
source "$(dirname "$0")/cli/expect.sh"
scene=builtin:cornell-glossy
small="--radiance-size 64 --irradiance-size 16 --bounces 1"

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
