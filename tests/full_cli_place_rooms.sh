# `octalux place` in a building of 4 x 4 rooms with doors of one metre, one of them sealed: a check that shares no code
# with placement finds all other rooms covered, and the report names the sealed one.
source "$(dirname "$0")/cli/expect.sh"
source "$(dirname "$0")/cli/holds.sh"
mkdir -p rooms
python3 "$OCTALUX_SOURCE_DIR/tests/rooms.py" 4 rooms 1
expect 0 place rooms/rooms.json -o probes.json
grep -q '^  unreached  .* m2  of surface.*no opening of 0.5 m' stdout.txt || fail "what is not reached is not told"
"$OCTALUX_BENCH" placement-check --ball 0.25 rooms/rooms.json 20000 probes.json |
  holds 'covered >= 0.995 and reached == 1 and outside == 0' || fail "rooms are not covered"
# The unreached area is that of one room of sixteen: its floor, ceiling and walls, and both sides of the furniture in
# it.
python3 -c 'import json; report = json.load(open("probes.json"))["report"]; print(json.dumps(report))' |
  holds '250 < unreached_m2 < 350 and coverage >= 0.997' || fail "the report does not fit the sealed room"
# Voxels follow the scene's unit: a scene a hundred times as large is one tile, too.
echo '{"model": "builtin:pillars", "scale": 100}' >centimetres.json
expect 0 place centimetres.json -o large.json
python3 -c 'import json; report = json.load(open("large.json"))["report"]; print(json.dumps(report))' |
  holds 'coverage >= 0.998' || fail "a room in centimetres is not covered"
expect 0 place centimetres.json -o large.json --json
holds 'tiles == 1 and voxel_metres > 2' <stdout.txt || fail "a room in centimetres is cut into tiles"
finish
