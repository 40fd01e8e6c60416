# Bakes in parts: any number of parts, in any order, killed, repeated and at the same time, make the same field as a
# whole bake. full_parts.sh runs with other numbers of parts.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
parts=$OCTALUX_SOURCE_DIR/tests/parts.py
tiny=(builtin:cornell --grid 3x2x3 --radiance-size 16 --noise 0.2 --bounces 2 --volume-cells 4)

for count in ${OLX_PARTS:-7}; do
  mkdir "$work/$count"
  python3 "$parts" "$work/$count" "$count" 1 "$OCTALUX" "${tiny[@]}"
done
mkdir "$work/whole"
python3 "$parts" "$work/whole" 3 2 "$OCTALUX" builtin:cornell --grid 2x2x1 --radiance-size 32 --irradiance-size 16 --noise 0.1 \
  --relight --classic --classic-size 32 --cube-size 32 --uncompressed --select cage,voronoi
