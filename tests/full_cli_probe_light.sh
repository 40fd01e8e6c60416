# Probe light from the command line: options that store it, what commands report about a field without it, and options
# that need it.
source "$(dirname "$0")/cli/expect.sh"
small=(--grid 2x2x2 --radiance-size 16 --bounces 1 --noise 0.3)

expect_json 'o["probes"] == 8 and o["irradiance_probes"] == 0 and "irradiance_seconds" not in o' \
  bake builtin:cornell -o plain.olx "${small[@]}"
expect_json 'o["irradiance_probes"] == 27 and o["irradiance_seconds"] > 0' \
  bake builtin:cornell -o full.olx "${small[@]}" --probe-light
expect 0 verify plain.olx
expect_json 'o["probe_light"] is False and o["irradiance_probes"] == 0 and o["irradiance_size"] == 0
  and "irradiance" not in o and "irradiance_grid" not in o and o["bytes"]["radiance"] == 0
  and o["bytes"]["irradiance"] == 0 and o["bytes"]["moments"] == 0 and o["bytes"]["indirect"] > 0' info plain.olx
expect_json 'o["probe_light"] is True and o["irradiance_size"] == 128 and o["bytes"]["radiance"] == 4 * 8 * 18 ** 2' info full.olx
expect 0 info plain.olx
grep -q "bake --probe-light" stdout.txt || fail "info does not say how to get probe light"
expect 0 bake builtin:cornell -o told.olx "${small[@]}"
grep -q "irradiance probes" stdout.txt && fail "a bake tells of irradiance probes that it does not make"

# A dry run estimates sizes with and without probe light.
expect_json 'o["irradiance_probes"] == 0 and o["fits"] and o["file_bytes"] < 400000' \
  bake builtin:cornell -o dry.olx "${small[@]}" --dry-run
expect_json 'o["irradiance_probes"] == 27 and o["file_bytes"] > 3000000' \
  bake builtin:cornell -o dry.olx "${small[@]}" --probe-light --dry-run

# Options about how probe light is made imply --probe-light, and so do options that depend on probe light.
for options in "--irradiance-grid 2x2x2" "--irradiance-size 128" "--irradiance octahedral" "--bounce-gather solved" "--no-fit" \
  "--volume-cells 0" "--light reference --reference-paths 1" "--classic --classic-size 32 --cube-size 32" \
  "--relight --irradiance-size 16"; do
  expect_json 'o["irradiance_probes"] >= 8' bake builtin:cornell -o implied.olx "${small[@]}" $options
done
expect 0 bake builtin:cornell -o implied.olx "${small[@]}" --irradiance octahedral
cmp -s implied.olx full.olx || fail "--irradiance octahedral is not --probe-light"

# A default picture does not read probe light; options that do are refused without it.
for field in plain full; do
  expect 0 render builtin:cornell --field $field.olx -o $field.exr --size 32x24 --spp 1
done
cmp -s plain.exr full.exr || fail "probe light changes a default picture"
expect 0 render builtin:cornell --field plain.olx -o traced.exr --size 16x12 --spp 1 --mode denoised --frames 2
for options in "--hits stored" "--diffuse irradiance"; do
  expect_failure "plain.olx: baked without probe light.*bake --probe-light" \
    render builtin:cornell --field plain.olx -o refused.exr --size 16x12 --spp 1 $options
  expect 0 render builtin:cornell --field full.olx -o stored.exr --size 16x12 --spp 1 $options
done
expect_failure "bake --probe-light" audit builtin:cornell --field plain.olx --rays 2 --points 2 --spp 1 --hits stored
[ -e refused.exr ] && fail "a refused render leaves a file"

# The audit compares irradiance probes where the field has them.
expect_json '"irradiance_points" not in o and "space_irradiance_probes" not in o and o["points"]["count"] == 10
  and o["space_volume"]["count"] > 0' \
  audit builtin:cornell --field plain.olx --rays 2 --points 10 --spp 4 --space 4
expect_json 'o["irradiance_points"]["count"] == 10 and o["space_irradiance_probes"]["count"] > 0' \
  audit builtin:cornell --field full.olx --rays 2 --points 10 --spp 4 --space 4
expect 0 audit builtin:cornell --field plain.olx --rays 2 --points 4 --spp 4
grep -q "irradiance probes" stdout.txt && fail "the audit judges irradiance probes that are not there"
finish
