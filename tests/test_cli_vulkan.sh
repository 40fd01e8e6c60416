# Pictures whose indirect light comes from a Vulkan device (a CPU one will do) against the same from the CPU, layer by layer.
source "$(dirname "$0")/cli/expect.sh"

# What drivers keep cannot be told by name once the loader has unloaded them; test_vulkan looks for leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"

"$OCTALUX" bake builtin:cornell-glossy -o cornell.olx --radiance-size 128 --irradiance-size 32 --bounces 1 --select cage,bricks \
  2>stderr.txt

# compare_devices SCENE FIELD OPTIONS...: every layer agrees, under the validation layers. A run compiles every shader, which takes
# most of this test's time: so each shows several options at once.
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
  expect_json 'len(o["layers"]) == 4 and all(l["relative_mse"] < 1e-5 for l in o["layers"].values())' compare vulkan.exr cpu.exr
  for layer in albedo normal depth; do
    expect_json 'all(l["relative_mse"] < 1e-5 for l in o["layers"].values())' compare vulkan.exr cpu.exr --layer $layer
  done
}

compare_devices builtin:cornell-glossy cornell.olx --spp 1 --glossy-samples 4
compare_devices builtin:cornell-glossy cornell.olx --spp 1 --glossy-samples 4 --select cage --tracer two-level
compare_devices builtin:cornell-glossy cornell.olx --spp 3 --glossy-samples 2 --seed 5 --dim-lobe 0.2 --tracer texel \
  --select exhaustive --visibility none --keep-buried
# Neighbour maps, with so many probes that the nearest is found by the tree; they are the best of what this field has for the
# device. Voxels run on the CPU alone.
"$OCTALUX" bake builtin:cornell-glossy -o neighbours.olx --grid 5x4x4 --radiance-size 32 --irradiance-size 8 --bounces 0 \
  --select voronoi,octree 2>stderr.txt
compare_devices builtin:cornell-glossy neighbours.olx --spp 1 --keep-buried
# Spherical harmonics run on the CPU alone, too.
"$OCTALUX" bake builtin:cornell-glossy -o harmonics.olx --radiance-size 8 --irradiance-size 8 --bounces 0 --irradiance sh2 2>stderr.txt
expect_failure "harmonics.olx: irradiance as spherical harmonics .sh2. does not run on the GPU" render builtin:cornell-glossy \
  --field harmonics.olx -o none.exr --size 8x8 --device vulkan
expect_failure "'octree' does not run on the GPU" render builtin:cornell-glossy --field neighbours.olx -o none.exr --size 8x8 \
  --select octree --device vulkan
expect_failure "voronoi" render builtin:cornell-glossy --field cornell.olx -o none.exr --size 8x8 --select voronoi --device vulkan
# The three modes, with the same random numbers. Histories of half floats, and kernels that follow from them, leave a little more
# than half floats alone do.
compare_devices builtin:cornell-glossy cornell.olx --mode gather --gather-samples 6 --spp 2 --emitters traced
compare_devices builtin:cornell-glossy cornell.olx --mode denoised --frames 6
compare_devices builtin:cornell-glossy cornell.olx --mode prefiltered --frames 4 --dim-lobe 0.2 --denoise published
"$OCTALUX" bake builtin:two-rooms-gap -o two.olx --grid 2x2x2 --radiance-size 64 --irradiance-size 16 --bounces 1 2>stderr.txt
compare_devices builtin:two-rooms-gap two.olx --spp 1
compare_devices builtin:two-rooms-gap two.olx --mode denoised --frames 6 --camera dark --from-camera lit
compare_devices builtin:two-rooms-gap two.olx --mode denoised --frames 8 --camera dark --from-camera lit --cut 3

# The baseline.
"$OCTALUX" bake builtin:cornell-glossy -o classic.olx --radiance-size 32 --irradiance-size 32 --bounces 1 --classic \
  --classic-size 64 --cube-size 64 2>stderr.txt
"$OCTALUX" bake builtin:pillars -o pillars.olx --radiance-size 32 --irradiance-size 32 --bounces 1 --classic --classic-size 32 \
  --cube-size 32 2>stderr.txt
compare_devices builtin:cornell-glossy classic.olx --spp 1 --method classic
compare_devices builtin:pillars pillars.olx --spp 1 --method classic --keep-buried
expect_failure "bake --classic" render builtin:cornell-glossy --field cornell.olx -o none.exr --size 8x8 --method classic \
  --device vulkan

expect_usage "--device vulkan goes with" render builtin:cornell -o a.exr --device vulkan
expect_usage "--standard-error goes with" render builtin:cornell -o a.exr --field cornell.olx --device vulkan --standard-error
expect_failure "no camera named \"x\"" render builtin:cornell -o a.exr --field cornell.olx --frames 3 --from-camera x --device vulkan
expect_usage "--validate goes with" render builtin:cornell -o a.exr --field cornell.olx --validate
rm a.exr 2>/dev/null
VK_ICD_FILENAMES=/nonexistent.json expect_failure "Vulkan" render builtin:cornell-glossy --field cornell.olx -o none.exr --size 8x8 \
  --device vulkan
[ -e none.exr ] && fail "a failed render leaves a file"

finish
