# The baseline from the command line: bake --classic, the report of info, render --method classic.
source "$(dirname "$0")/cli/expect.sh"

# Maps have the dissertation's sizes: 149.25 kB a probe without borders, the table and the box.
expect_json 'o["classic_seconds"] > 0' bake builtin:cornell -o classic.olx --grid 1x1x1 --radiance-size 8 --irradiance-size 8 \
  --bounces 1 --classic
expect 0 verify classic.olx
sides='[128, 128, 64, 32, 16, 8]'
expect_json "o['classic'] == {'size': 128, 'cube_size': 256, 'sharpness': 8192} and \
  o['bytes']['classic'] == 64 + 4 * 64 * 64 + 24 + sum(4 * (n + 2) ** 2 for n in $sides)" info classic.olx
python3 -c "exit(sum(4 * n * n for n in $sides) != 149.25 * 1024)" || fail "not the memory of the dissertation"
expect 0 info classic.olx
grep -q "classic maps .* 128x128 texels from cube maps of 256" stdout.txt || fail "info does not tell of classic maps"

expect 0 render builtin:cornell --field classic.olx -o classic.exr --size 32x24 --spp 1 --method classic
expect 0 render builtin:cornell --field classic.olx -o field.exr --size 32x24 --spp 1
for layer in direct albedo normal depth; do
  expect_json 'all(l["max"] == 0 for l in o["layers"].values())' compare classic.exr field.exr --layer $layer
done
expect_json 'all(l["mse"] > 0 for l in o["layers"].values())' compare classic.exr field.exr --layer indirect_diffuse

# A field baked without --classic has no classic maps, and commands that need them name the missing option.
expect_json '"classic_seconds" not in o' bake builtin:cornell -o plain.olx --grid 1x1x1 --radiance-size 8 --irradiance-size 8 --bounces 1
expect_json '"classic" not in o and o["bytes"]["classic"] == 0' info plain.olx
expect_failure "plain.olx: .*bake --classic" render builtin:cornell --field plain.olx -o none.exr --size 8x8 --method classic
[ -e none.exr ] && fail "a failed render leaves a file"

# --bounce-gather traced gathers bounces by rays.
expect_json '0 <= o["unseen"] < 0.02' bake builtin:cornell -o traced.olx --radiance-size 8 --irradiance-size 32 --bounces 2 \
  --bounce-gather traced
expect_usage "is not one of solved|irradiance|traced" bake builtin:cornell -o a.olx --bounce-gather magic

finish
