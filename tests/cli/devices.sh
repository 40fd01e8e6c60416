# Sourced by tests of pictures whose indirect light comes from a Vulkan device (a CPU one will do): the same from the
# CPU.
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"

# What drivers keep cannot be told by name once the loader has unloaded them; test_vulkan looks for leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"

# As texels, which devices read to the last bit. What lies between the colours of a block they round as they like.
"$OCTALUX" bake builtin:cornell-glossy -o cornell.olx --radiance-size 128 --irradiance-size 16 --bounces 1 --select cage,bricks \
  --uncompressed 2>stderr.txt
most_error=1e-5

# compare_devices SCENE FIELD OPTIONS...: every layer agrees, under the validation layers. A run compiles every shader,
# which takes most of this test's time: so each shows several options at once.
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
