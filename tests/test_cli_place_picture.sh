# `octalux place --picture`: a picture is written and shows the coverage, and impossible requests are refused with a
# message.
source "$(dirname "$0")/cli/expect.sh"
scene=builtin:temple
quick="--method sdf --voxels 60 --surfels 2000 --size 160x90"

# pixels FILE EXPRESSION: counts the pixels of a PNG of 8-bit RGB for which a Python expression of r, g and b is true.
pixels() {
  python3 - "$1" "$2" <<'PYTHON'
import struct, sys, zlib
data, at, packed = open(sys.argv[1], "rb").read(), 8, b""
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    body = data[at + 8:at + 8 + size]
    if kind == b"IHDR": width, height = struct.unpack(">II", body[:8])
    if kind == b"IDAT": packed += body
    at += 12 + size
raw, stride, rows, last = zlib.decompress(packed), 3 * width, [], bytes(3 * width)
for y in range(height):
    kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
    for x in range(stride):
        a, b, c = row[x - 3] if x > 2 else 0, last[x], last[x - 3] if x > 2 else 0
        p = a + b - c
        near = min((abs(p - v), i, v) for i, v in enumerate((a, b, c)))[2]
        row[x] = (row[x] + (0, a, b, (a + b) // 2, near)[kind]) & 255
    rows.append(row)
    last = row
test = compile(sys.argv[2], "test", "eval")
print(sum(bool(eval(test, {"r": row[i], "g": row[i + 1], "b": row[i + 2]})) for row in rows for i in range(0, stride, 3)))
PYTHON
}

expect 0 place $scene -o probes.json $quick --count 6 --picture view.png
[ "$(pixels view.png 'g > 180 and b > 180 and r < 120')" -gt 20 ] || fail "no probe of the skeleton is in the picture"
[ "$(pixels view.png 'r > 150 and g > 150 and b < 170')" -gt 20 ] || fail "no skeleton is in the picture"
[ "$(pixels view.png 'abs(r - g) < 25 and abs(g - b) < 25 and 20 < r < 130')" -gt 5000 ] || fail "no surfaces are in the picture"
# One probe misses many surfaces, which are drawn in red.
expect 0 place $scene -o one.json $quick --count 1 --picture missed.png --camera gallery
[ "$(pixels missed.png 'r > 180 and g < 90 and b < 90')" -gt 50 ] || fail "nothing that is missed is in the picture"
# Drawing a picture does not change the probes, and the picture does not depend on the number of threads.
expect 0 place $scene -o plain.json --method sdf --voxels 60 --surfels 2000 --count 6
cmp probes.json plain.json || fail "a picture changes the probes"
expect 0 place $scene -o probes.json $quick --count 6 --picture again.png --threads 1
cmp view.png again.png || fail "the picture depends on the number of threads"
# Every method can be drawn, and so can a scene without cameras, which is seen from above.
printf 'v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 0 1 0\nv 2 1 0\nv 2 1 2\nv 0 1 2\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n' >box.obj
for method in grid sdf medial cover; do
  expect 0 place box.obj -o box.json --method $method --voxels 40 --surfels 1000 --count 2 --picture box-$method.png --size 120x90
  [ "$(pixels box-$method.png 'max(r, g, b) > 150')" -gt 20 ] || fail "$method: no probe is in the overview"
done

expect_failure "no camera named" place $scene -o x.json $quick --count 2 --picture x.png --camera nowhere
expect_usage "does not end in .png" place $scene -o x.json --picture x.jpg
expect_usage "go with --picture" place $scene -o x.json --camera corridor
expect_usage "go with --picture" place $scene -o x.json --size 32x32
expect_failure "nowhere" place $scene -o x.json --picture nowhere/x.png
[ ! -e x.json ] && [ ! -e x.png ] || fail "a failed command left a file"
finish
