# Every command stops within a second of a signal, says that it was interrupted, exits with 128 + the signal's number,
# and leaves nothing behind; signals are sent on built-in scenes, by full_cli_stop.sh
# to more commands and at more moments.
set -euo pipefail
cd "$(dirname "$0")"
stop=$PWD/stop.py
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/run"

# stopped SIGNAL SECONDS ARGUMENTS...: runs octalux and checks that it stops when the signal comes after so many
# seconds.
stopped() {
  python3 "$stop" "$work/run" "$1" "$2" "$OCTALUX" "${@:3}"
}

# A large picture is traced quickly when most of its rays meet nothing.
printf '%s' '{"model": "builtin:cornell", "cameras": [{"name": "far", "eye": [0.3, 0.3, 12], "target": [0.3, 0.3, 0], "fov_y_degrees": 30}]}' \
  >"$work/far.json"
"$OCTALUX" render "$work/far.json" --method path --spp 1 --size 2048x2048 -o "$work/picture.exr" >/dev/null

stopped INT 0.7 bake builtin:temple -o f.olx --grid 8x8x8 --threads 2 --no-work
large=(--surfels 1048576 --candidates 16384 --voxels 300)
stopped INT 0.5 place builtin:temple -o p.json --method cover "${large[@]}" --threads 2
stopped INT 0.5 render builtin:temple --method path -o p.exr --spp 10000 --threads 2
stopped INT 0.5 compare "$work/picture.exr" "$work/picture.exr" --report r.html --threads 2
OCTALUX=$OCTALUX_BENCH stopped TERM 0.5 mcguire-table1 --threads 2

# A command that waits for a reader of a pipe is stopped, too.
mkfifo "$work/run/pipe.json"
stopped TERM 0.5 place builtin:cornell -o pipe.json --method grid --voxels 16
[ "${OLX_ALL_STOPS:-}" ] || exit 0

"$OCTALUX" bake builtin:cornell-glossy -o "$work/field.olx" --radiance-size 64 --irradiance-size 16 --bounces 1 --noise 0.3 \
  >/dev/null
stopped TERM 0.5 render builtin:cornell-glossy --field "$work/field.olx" -o p.png --spp 4096 --threads 2
stopped TERM 0.5 audit builtin:cornell-glossy --field "$work/field.olx" --rays 100000000 --threads 2
stopped TERM 0.05 bake builtin:temple -o f.olx --grid 8x8x8 --threads 2 --no-work
stopped HUP 0.5 bake builtin:temple -o f.olx --grid 8x8x8 --threads 2 --classic --relight --no-work
for seconds in 0.3 1.5; do
  stopped INT "$seconds" place builtin:temple -o p.json --method grid --grid 40x40x40 "${large[@]}" --threads 2
done
stopped TERM 1.5 place builtin:temple -o p.json --method sdf "${large[@]}" --threads 2
stopped TERM 1.5 place builtin:temple -o p.json --method medial "${large[@]}" --threads 2
stopped INT 3 place builtin:temple -o p.json --method cover "${large[@]}" --threads 2
for optimizer in gradient gibbs; do
  stopped TERM 1.2 place builtin:temple -o p.json --method grid --grid 20x20x20 --threads 2 \
    --optimize $optimizer --rounds 10000
done
stopped INT 0.5 render builtin:cornell-glossy --field "$work/field.olx" -o p.png --frames 10000 --threads 2
"$OCTALUX" bake builtin:cornell -o "$work/large.olx" --grid 4x4x4 --radiance-size 256 --samples 1 --noise 1 --bounces 0 >/dev/null
stopped TERM 0.5 pack "$work/large.olx" -o packed.olxz --level 22 --threads 2
OCTALUX=$OCTALUX_BENCH stopped INT 1 all --quick --threads 2
OCTALUX=$OCTALUX_BENCH stopped INT 1 speed builtin:temple --threads 2
