# Sourced by tests that compare pictures whose indirect light comes from a Vulkan device (a CPU device will do) with
# those of the CPU.
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"

# Allocations that drivers keep cannot be named once the loader has unloaded them, so leaks are not detected here;
# test_vulkan looks for leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"

# The field is stored as texels, which every device reads exactly; devices may round the colours between the ends of a
# block as they like.
"$OCTALUX" bake builtin:cornell-glossy -o cornell.olx --radiance-size 128 --irradiance-size 16 --bounces 1 --select cage,bricks \
  --noise 0.2 --uncompressed 2>stderr.txt
most_error=1e-5

# compare_devices SCENE FIELD OPTIONS...: checks that every layer agrees, under the validation layers. A run compiles
# every shader, which takes most of this test's time, so each run shows several options at once.
compared=0
compare_devices() {
  local scene=$1 field=$2
  shift 2
  expect 0 render "$scene" --field "$field" -o cpu.exr --size 120x90 --centered "$@"
  expect_json 'o["device"] and o["passes"]["indirect_diffuse"] > 0 and o["passes"]["upload"] > 0' \
    render "$scene" --field "$field" -o vulkan.exr --size 120x90 --device vulkan --validate "$@"
  if [ $compared = 0 ] && grep -qE "no Vulkan|without the Vulkan runtime" stderr.txt; then
    cat stderr.txt
    exit 77
  fi
  compared=$((compared + 1))
  expect_json 'len(o["layers"]) == 4 and all(l["relative_mse"] < '$most_error' for l in o["layers"].values())' compare vulkan.exr cpu.exr
  for layer in albedo normal depth; do
    expect_json 'all(l["relative_mse"] < 1e-5 for l in o["layers"].values())' compare vulkan.exr cpu.exr --layer $layer
  done
}
