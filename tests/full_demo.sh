# The demo: it names its first picture long before its end, takes at most 30 times the processor time of one path traced
# picture, has references without visible noise, and its page holds every picture and refers to nothing outside its folder.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
TIMEFORMAT='%U %S'

# path_trace SCENE FILE: the picture that times are compared with. It is made before and after the demo, because a busy
# machine takes more processor time for the same work. The demo took 26 times as much on an overloaded machine, 27 on an
# idle one.
path_trace() {
  { time "$OCTALUX" render "$1" -o "$2" --method path --camera front --size 176x176 --spp 100 --bounces 3 --seed 7 >/dev/null; } \
    2>>"$work/picture.txt"
}

path_trace builtin:cornell-glossy "$work/before.exr"
{ time bash "$OCTALUX_SOURCE_DIR/scripts/demo.sh" "$OCTALUX" "$work/demo" >"$work/said.txt"; } 2>"$work/demo.txt"
path_trace "$work/demo/cornell.json" "$work/other.exr"
cat "$work/said.txt"
awk 'FNR == NR { demo = $1 + $2; next } { picture += ($1 + $2) / 2 }
  END { printf "%.1f s of processor time, %.1f times that of a picture\n", demo, demo / picture; exit !(demo <= 30 * picture) }' \
  "$work/demo.txt" "$work/picture.txt" || { echo "the demo takes too long"; exit 1; }

first=$(sed -n 's/.*the first picture: //p' "$work/said.txt")
[ -s "$first" ] || { echo "no first picture: $first"; exit 1; }
sed '/first picture/q' "$work/said.txt" | grep "path trace" && { echo "the first picture waits for the path tracer"; exit 1; }
[ "$(grep -o '<img' "$work/demo/index.html" | wc -l)" -eq 11 ]
grep -qE '(src|href)="?(https?:|//|/)' "$work/demo/index.html" && { echo "the page refers to something outside its folder"; exit 1; }

# Where this build has the web page for walking through a room, the demo writes the room's page and links to it.
if [ -e "$(dirname "$OCTALUX")/web/index.html" ]; then
  [ -s "$work/demo/walk/field.olx.gz" ] && grep -q 'href="walk/index.html"' "$work/demo/index.html" || { echo "no way to walk through"; exit 1; }
else
  grep -q "there is none: .*npm" "$work/said.txt" || { echo "nothing says why there is no way to walk through"; exit 1; }
fi

# Bounds the reference's noise: a picture with another seed and a quarter of the samples differs from it by five times
# the reference's own mean squared error, which must be less than 0.005 of the indirect light's square.
source "$OCTALUX_SOURCE_DIR/tests/cli/holds.sh"
"$OCTALUX" compare "$work/other.exr" "$work/demo/cornell-path.exr" --json |
  holds 'layers["indirect_diffuse"]["relative_mse"] < 5 * 0.005'
