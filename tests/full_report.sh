# The report in headless Chromium: it opens from disk without an error, and its controls work, at two widths, in light
# and dark colours. OCTALUX_SCREENSHOTS names a folder for screenshots of it.
source "$(dirname "$0")/cli/expect.sh"
tests="$OCTALUX_SOURCE_DIR/tests"
if ! PYTHONDONTWRITEBYTECODE=1 python3 -c "import sys; sys.path.insert(0, '$tests'); import browser; sys.exit(not browser.find())"; then
  echo "skipped: no Chromium here"
  exit 77
fi

python3 "$tests/perceptual_reference.py" make . || fail "no pictures"
expect 0 compare a.exr b.exr --report known.html
expect 0 bake builtin:cornell -o f.olx --grid 2x2x2 --radiance-size 64 --irradiance-size 16 --bounces 1
expect 0 render builtin:cornell -o field.exr --field f.olx --size 320x240 --spp 2
expect 0 render builtin:cornell -o path.exr --method path --size 320x240 --spp 16 --bounces 2
expect 0 compare field.exr path.exr --report layers.html
expect 0 compare field.exr path.exr --layer normal --report normal.html
expect 0 compare field.exr field.exr --layer depth --report depth.html
PYTHONDONTWRITEBYTECODE=1 timeout 3000 python3 "$tests/drive_report.py" known.html layers.html normal.html depth.html ${OCTALUX_SCREENSHOTS:+"$OCTALUX_SCREENSHOTS"} >stdout.txt 2>stderr.txt ||
  fail "the report in a browser"
finish
