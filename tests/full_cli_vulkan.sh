# Compares pictures from a Vulkan device with those from the CPU: the selectors, tracers, scenes and modes that
# test_cli_vulkan.sh has no time for.
source "$(dirname "$0")/cli/devices.sh"

compare_devices builtin:cornell-glossy cornell.olx --spp 1 --glossy-samples 4
compare_devices builtin:cornell-glossy cornell.olx --spp 3 --glossy-samples 2 --seed 5 --dim-lobe 0.2 --tracer texel \
  --select exhaustive --visibility none --keep-buried
# Diffuse light is read from stored texels of surfaces; where all probes are ranked, device and CPU read the same texels
# except for rounding.
compare_devices builtin:cornell-glossy cornell.olx --spp 1 --glossy-samples 4 --select cage --tracer two-level --dim-lobe 0.06
compare_devices builtin:cornell-glossy cornell.olx --spp 1 --select exhaustive
# This field has neighbour maps and so many probes that the nearest one is found by the octree; the device uses
# neighbour maps since voxels work on the CPU alone.
"$OCTALUX" bake builtin:cornell-glossy -o neighbours.olx --grid 5x4x4 --radiance-size 32 --irradiance-size 8 --bounces 0 \
  --select voronoi,octree 2>stderr.txt
compare_devices builtin:cornell-glossy neighbours.olx --spp 1 --keep-buried
compare_devices builtin:cornell-glossy cornell.olx --mode denoised --frames 6
compare_devices builtin:cornell-glossy cornell.olx --mode prefiltered --frames 4 --dim-lobe 0.2 --denoise published
# Histories of half floats, and kernels that depend on them, lead to slightly larger errors than half floats alone.
"$OCTALUX" bake builtin:two-rooms-gap -o two.olx --grid 2x2x2 --radiance-size 64 --irradiance-size 16 --bounces 1 --noise 0.3 --uncompressed 2>stderr.txt
compare_devices builtin:two-rooms-gap two.olx --mode denoised --frames 5 --camera dark --from-camera lit --cut 2
compare_devices builtin:two-rooms-gap two.olx --spp 1
compare_devices builtin:two-rooms-gap two.olx --mode denoised --frames 6 --camera dark --from-camera lit
# The baseline works on the device, too.
"$OCTALUX" bake builtin:cornell-glossy -o classic.olx --radiance-size 32 --irradiance-size 16 --bounces 1 --noise 0.3 --classic \
  --classic-size 64 --cube-size 64 2>stderr.txt
compare_devices builtin:cornell-glossy classic.olx --spp 1 --method classic
"$OCTALUX" bake builtin:pillars -o pillars.olx --radiance-size 32 --irradiance-size 32 --bounces 1 --classic --classic-size 32 \
  --cube-size 32 2>stderr.txt
compare_devices builtin:pillars pillars.olx --spp 1 --method classic --keep-buried
expect_failure "'octree' does not run on the GPU" render builtin:cornell-glossy --field neighbours.olx -o none.exr --size 8x8 \
  --select octree --device vulkan

finish
