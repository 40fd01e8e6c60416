# Bakes whose probes are rasterised on a Vulkan device (a CPU device will do): the field is nearly that of cast rays, a
# work folder belongs to one way of capture, and without a device an error says so.
source "$(dirname "$0")/cli/expect.sh"

# Allocations that drivers keep cannot be named once the loader has unloaded them; test_capture_vulkan looks for leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"

small=(builtin:cornell --grid 2x2x2 --radiance-size 32 --bounces 0 --noise 1 --volume-cells 8)

expect_usage "--validate goes with --device vulkan" bake "${small[@]}" -o a.olx --validate
expect_usage "gpu" bake "${small[@]}" -o a.olx --device gpu
# The loader finds no driver.
VK_DRIVER_FILES=nowhere.json VK_ICD_FILENAMES=nowhere.json \
  expect_failure "bake: --device vulkan: " bake "${small[@]}" -o none.olx --device vulkan
[ ! -e none.olx ] || fail "a bake without a device left a file"
grep -q "without the Vulkan runtime" stderr.txt && { cat stderr.txt; exit 77; }

if ! "$OCTALUX" bake "${small[@]}" -o first.olx --device vulkan --validate --threads 1 --json >first.json 2>stderr.txt; then
  grep -qE "no Vulkan" stderr.txt || fail "bake --device vulkan: $(cat stderr.txt)"
  cat stderr.txt
  exit 77
fi
python3 - <<'END' || fail "the report of a rasterised bake"
import json
o = json.load(open("first.json"))
assert o["device"] and o["raster_seconds"] > 0 and 0 <= o["raster_rays"] < 0.1 * o["primary_rays"]
END
expect 0 bake "${small[@]}" -o second.olx --device vulkan --threads 2
cmp first.olx second.olx || fail "the bytes depend on the number of threads"
expect 0 verify first.olx

# A folder of results, kept by one way of capture, is refused by the other.
expect 0 bake "${small[@]}" -o kept.olx --device vulkan --work kept --keep-work
cmp first.olx kept.olx || fail "a work folder changes bytes"
expect_failure "with 'capture .*' in place of 'capture rays'" bake "${small[@]}" -o other.olx --work kept
expect 0 bake "${small[@]}" -o again.olx --device vulkan --work kept
cmp first.olx again.olx || fail "resuming changes bytes"
# Parts rasterise their own probes.
for round in $(seq 20); do
  missing=0
  for part in 1/2 2/2; do
    code=0
    "$OCTALUX" bake "${small[@]}" --device vulkan --work parts --part $part >/dev/null 2>stderr.txt || code=$?
    [ $code = 0 ] || [ $code = 75 ] || fail "part $part: exit code $code"
    missing=$((missing + (code == 75)))
  done
  [ $missing = 0 ] && break
done
expect 0 join parts -o joined.olx
cmp first.olx joined.olx || fail "parts change bytes"
finish
