# Compares pictures from a Vulkan device with those from the CPU: the selectors, tracers, scenes and modes that
# test_cli_vulkan.sh has no time for.
source "$(dirname "$0")/cli/devices.sh"

compare_devices builtin:cornell-glossy cornell.olx --spp 1 --glossy-samples 4
compare_devices builtin:cornell-glossy cornell.olx --spp 3 --glossy-samples 2 --seed 5 --dim-lobe 0.2 --tracer texel \
  --select exhaustive --visibility none --keep-buried
# This field has neighbour maps and so many probes that the nearest one is found by the octree; the device uses
# neighbour maps since voxels work on the CPU alone.
"$OCTALUX" bake builtin:cornell-glossy -o neighbours.olx --grid 5x4x4 --radiance-size 32 --irradiance-size 8 --bounces 0 \
  --select voronoi,octree 2>stderr.txt
compare_devices builtin:cornell-glossy neighbours.olx --spp 1 --keep-buried
compare_devices builtin:cornell-glossy cornell.olx --mode denoised --frames 6
compare_devices builtin:cornell-glossy cornell.olx --mode prefiltered --frames 4 --dim-lobe 0.2 --denoise published
"$OCTALUX" bake builtin:two-rooms-gap -o two.olx --grid 2x2x2 --radiance-size 64 --irradiance-size 16 --bounces 1 2>stderr.txt
compare_devices builtin:two-rooms-gap two.olx --spp 1
compare_devices builtin:two-rooms-gap two.olx --mode denoised --frames 6 --camera dark --from-camera lit
"$OCTALUX" bake builtin:pillars -o pillars.olx --radiance-size 32 --irradiance-size 32 --bounces 1 --classic --classic-size 32 \
  --cube-size 32 2>stderr.txt
compare_devices builtin:pillars pillars.olx --spp 1 --method classic --keep-buried
expect_failure "'octree' does not run on the GPU" render builtin:cornell-glossy --field neighbours.olx -o none.exr --size 8x8 \
  --select octree --device vulkan

finish
