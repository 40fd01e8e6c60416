# The Python example reproduces its figure: errors fall as maps grow, and a picture of them is drawn. Arrays of rays are
# traced nearly as fast as from C. Skipped without NumPy.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for python in "${PYTHON:-python3}" /usr/bin/python3 none; do
  [ "$python" != none ] || { echo "skipped: no Python with NumPy here (Debian: python3-numpy)"; exit 77; }
  if "$python" -c 'import numpy' 2>/dev/null; then break; fi
done
cd "$work"
PYTHONPATH=$OCTALUX_SOURCE_DIR/python OCTALUX_LIBRARIES=$(dirname "$OCTALUX")/src PYTHONDONTWRITEBYTECODE=1 \
  "$python" "$OCTALUX_SOURCE_DIR/python/examples/resolution.py" | tee found.txt
head -c 4 resolution.png | grep -q PNG
# The last number of a line is the error of glossy light; it must be smaller at the largest maps than at the smallest.
awk '{ gsub(",", ""); value[NR] = $NF } END { exit !(NR == 5 && value[5] < 0.3 * value[1]) }' found.txt

# A million rays take at most 1.3 times as long through Python as from C.
"$OCTALUX" bake builtin:cornell -o a.olx --radiance-size 128 --noise 0.2 >/dev/null
PYTHONPATH=$OCTALUX_SOURCE_DIR/python OCTALUX_LIBRARIES=$(dirname "$OCTALUX")/src PYTHONDONTWRITEBYTECODE=1 \
  "$python" "$OCTALUX_SOURCE_DIR/tests/python_speed.py" a.olx 200000 5
