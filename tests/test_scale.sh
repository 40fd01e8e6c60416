#!/bin/bash
# A room that is 128 times smaller or larger gives the same picture, since nothing depends on absolute lengths. Powers
# of two do not change rounding, so the pictures are the same to the last bit. full_scale.sh runs this test at scales
# that do round: SCALES, MAP and IRRADIANCE (texels), IRRADIANCE_GRID, SIZE, SPP and BOUND (relative MSE) set it up.
set -eu
scales=${SCALES:-0.0078125 128} map=${MAP:-64} size=${SIZE:-96x72} spp=${SPP:-4} bound=${BOUND:-0}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat > "$work/room.mtl" <<'END'
newmtl white
Kd 0.7 0.7 0.7
Ks 0 0 0
newmtl red
Kd 0.6 0.1 0.1
Ks 0 0 0
newmtl shiny
Kd 0.3 0.3 0.4
Ks 0.5 0.5 0.5
Ns 200
END

# box writes a box of six quads between two corners; the quads' winding does not matter.
box() { # X0 Y0 Z0 X1 Y1 Z1
  echo "v $1 $2 $3
v $4 $2 $3
v $4 $5 $3
v $1 $5 $3
v $1 $2 $6
v $4 $2 $6
v $4 $5 $6
v $1 $5 $6"
}
faces() { echo "f -8 -7 -6 -5
f -4 -3 -2 -1
f -8 -7 -3 -4
f -5 -6 -2 -1
f -8 -5 -1 -4
f -7 -6 -2 -3"; }
{
  echo "mtllib room.mtl"
  echo "usemtl white"; box 0 0 0 4 3 5; faces
  echo "usemtl red"; box 0.7 0 1.3 1.6 1.4 2.2; faces
  echo "usemtl shiny"; box 2.4 0 2.6 3.3 0.8 3.5; faces
} > "$work/room.obj"

describe() { # SCALE
  awk -v s="$1" 'function v(x, y, z) { return sprintf("[%.9g, %.9g, %.9g]", x * s, y * s, z * s) }
    BEGIN {
      printf "{\"model\": \"room.obj\", \"scale\": %.9g,\n", s
      printf "\"cameras\": [{\"name\": \"eye\", \"eye\": %s, \"target\": %s, \"up\": [0, 1, 0], \"fov_y_degrees\": 70}],\n", v(3.6, 2.2, 0.4), v(1, 0.8, 3.5)
      printf "\"lights\": [{\"type\": \"point\", \"position\": %s, \"intensity\": [%.9g, %.9g, %.9g]},\n", v(2.9, 2.5, 4.2), 9 * s * s, 8 * s * s, 7 * s * s
      printf "{\"type\": \"rect\", \"center\": %s, \"edge_u\": %s, \"edge_v\": %s, \"radiance\": [6, 6, 7]}],\n", v(1.1, 2.99, 1.5), v(0.6, 0, 0), v(0, 0, 0.5)
      printf "\"probes\": {\"min\": %s, \"max\": %s, \"grid\": [2, 2, 3]}}\n", v(0.35, 0.45, 0.5), v(3.65, 2.5, 4.5)
    }' > "$work/room$1.json"
}

for scale in 1 $scales; do
  describe $scale
  "$OCTALUX" bake "$work/room$scale.json" -o "$work/$scale.olx" --radiance-size $map --irradiance-size ${IRRADIANCE:-16} \
    --irradiance-grid ${IRRADIANCE_GRID:-2x2x3} --bounces 2 2> "$work/log"
  "$OCTALUX" render "$work/room$scale.json" -o "$work/$scale.exr" --method field --field "$work/$scale.olx" --size $size --spp $spp 2> "$work/log"
done

failed=0
for scale in $scales; do
  for layer in beauty indirect_diffuse indirect_glossy; do
    error=$("$OCTALUX" compare "$work/$scale.exr" "$work/1.exr" --layer $layer --json | tr ',{}' '\n\n\n' | sed -n 's/.*"relative_mse": *//p')
    echo "scale $scale $layer: relative MSE $error"
    awk -v e="$error" -v b="$bound" 'BEGIN { exit !(e != "" && e + 0 <= b + 0) }' || failed=1
  done
done
exit $failed
