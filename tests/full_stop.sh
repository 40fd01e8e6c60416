# Every command stops within a second on a real scene, while it imports or cooks the scene, places probes or bakes, and
# leaves nothing behind. (Bakes with a work folder leave that: test_cli_work.sh.)
set -euo pipefail
cd "$(dirname "$0")"
: "${OCTALUX_SCENES:=$OCTALUX_SOURCE_DIR/../shared/scenes}"
export OCTALUX_SCENES
if [ ! -f "$OCTALUX_SCENES/sponza/sponza.gltf" ]; then
  echo "skipped: there is no sponza/sponza.gltf in $OCTALUX_SCENES"
  exit 77
fi
stop=$PWD/stop.py scene=$OCTALUX_SOURCE_DIR/scenes/sponza.json
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

stopped() {
  python3 "$stop" "$work" "$1" "$2" "$OCTALUX" "${@:3}"
}

for seconds in 0.1 0.7; do
  stopped INT "$seconds" scene "$scene" --cook a.olxs
done
for seconds in 0.5 3; do
  stopped TERM "$seconds" bake "$scene" -o f.olx --no-work --grid 8x2x4 --radiance-size 512 --threads 2
  for method in grid sdf medial cover; do
    stopped INT "$seconds" place "$scene" -o p.json --method $method --grid 16x16x16 --threads 2 \
      --surfels 200000 --voxels 300
  done
  for optimizer in gradient gibbs; do
    stopped TERM "$seconds" place "$scene" -o p.json --method grid --grid 8x4x8 --threads 2 \
      --optimize $optimizer --rounds 10000
  done
done
stopped INT 4 render "$scene" --method path --spp 10000 -o p.exr --threads 2
OCTALUX=$OCTALUX_BENCH stopped TERM 4 wang --only sponza --scenes "$OCTALUX_SOURCE_DIR/scenes" --threads 2
