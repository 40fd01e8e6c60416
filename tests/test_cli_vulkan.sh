# Compares pictures whose indirect light comes from a Vulkan device (a CPU device will do) with those of the CPU, layer
# by layer, and tests what cannot work. full_cli_vulkan.sh does more of both.
source "$(dirname "$0")/cli/devices.sh"

compare_devices builtin:cornell-glossy cornell.olx --spp 1 --diffuse irradiance --hits stored
# Without probe light default pictures are lit as before, and options that need it are refused. A step of 1/255 in base
# colour is half a per cent of a hit's light.
"$OCTALUX" bake builtin:cornell-glossy -o plain.olx --radiance-size 128 --bounces 1 --noise 0.3 2>stderr.txt
most_error=1e-4
compare_devices builtin:cornell-glossy plain.olx --spp 1
most_error=1e-5
for options in "--hits stored" "--diffuse irradiance"; do
  expect_failure "bake --probe-light" render builtin:cornell-glossy --field plain.olx -o none.exr --size 8x8 --device vulkan $options
done
# Spherical harmonics work on the CPU alone, too.
"$OCTALUX" bake builtin:cornell-glossy -o harmonics.olx --radiance-size 8 --irradiance-size 8 --bounces 0 --noise 0.5 --volume-cells 0 --irradiance sh2 2>stderr.txt
expect_failure "harmonics.olx: irradiance as spherical harmonics .sh2. does not run on the GPU" render builtin:cornell-glossy \
  --field harmonics.olx -o none.exr --size 8x8 --device vulkan
expect_failure "voronoi" render builtin:cornell-glossy --field cornell.olx -o none.exr --size 8x8 --select voronoi --device vulkan
# With the same random numbers a device gathers the same light.
compare_devices builtin:cornell-glossy cornell.olx --mode gather --gather-samples 6 --spp 2 --emitters traced

expect_failure "bake --classic" render builtin:cornell-glossy --field cornell.olx -o none.exr --size 8x8 --method classic \
  --device vulkan

expect_usage "--device vulkan goes with" render builtin:cornell -o a.exr --device vulkan
expect_usage "--standard-error goes with" render builtin:cornell -o a.exr --field cornell.olx --device vulkan --standard-error
expect_failure "no camera named \"x\"" render builtin:cornell -o a.exr --field cornell.olx --frames 3 --from-camera x --device vulkan
expect_usage "--validate goes with" render builtin:cornell -o a.exr --field cornell.olx --validate
rm a.exr 2>/dev/null
VK_ICD_FILENAMES=/nonexistent.json expect_failure "no Vulkan driver is installed" render builtin:cornell-glossy --field cornell.olx -o none.exr --size 8x8 \
  --device vulkan
[ -e none.exr ] && fail "a failed render leaves a file"

finish
