# Compares SSIM and FLIP of `octalux compare` with an independent implementation, written from the papers, to 4 digits.
source "$(dirname "$0")/cli/expect.sh"
reference="$OCTALUX_SOURCE_DIR/tests/perceptual_reference.py"
python3 "$reference" make . || fail "no pictures"

for settings in "1 67" "0.5 30" "3 19.5"; do
  read -r exposure ppd <<<"$settings"
  python3 "$reference" "$exposure" "$ppd" >expected.json || fail "no reference"
  expect_json 'all(abs(o["layers"]["beauty"][k] / e[k] - 1) < 1e-4 for e in [__import__("json").load(open("expected.json"))]
    for k in ("ssim", "flip"))' compare a.exr b.exr --exposure "$exposure" --pixels-per-degree "$ppd"
done

# Results are the same in either order of the pictures, and at any number of threads.
expect 0 compare a.exr b.exr --json --threads 1
cp stdout.txt one.txt
expect 0 compare a.exr b.exr --json --threads 7
cmp one.txt stdout.txt || fail "numbers depend on the number of threads"
expect_json 'o["layers"]["beauty"]["flip"] == '"$(python3 -c 'import json; print(json.load(open("one.txt"))["layers"]["beauty"]["flip"])')" \
  compare b.exr a.exr
expect 0 compare a.exr b.exr --flip-map map.png
[ "$(head -c 8 map.png | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] || fail "map.png is no PNG"
expect_usage "is more than 1000" compare a.exr b.exr --pixels-per-degree 1001
expect_usage "does not end in .png" compare a.exr b.exr --flip-map map.jpg
expect_failure "cannot write" compare a.exr b.exr --flip-map no/map.png

finish
