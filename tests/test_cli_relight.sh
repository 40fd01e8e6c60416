# render --relight: a field follows the lights of a changed scene, on the CPU and on a Vulkan device (a CPU device will
# do).
source "$(dirname "$0")/cli/expect.sh"
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0" # leaks of drivers cannot be named, as in test_cli_vulkan.sh

lamp() {
  printf '{"model": "builtin:cornell", "lights": [{"type": "point", "position": %s, "intensity": [0.4, 0.3, 0.5]}]}' "$1" >"$2"
}
lamp "[0.1, 0.12, 0.1]" before.json
lamp "[0.44, 0.4, 0.3]" after.json
bake=(--grid 2x2x2 --radiance-size 64 --noise 0.03)
"$OCTALUX" bake before.json -o before.olx "${bake[@]}" --relight 2>stderr.txt
"$OCTALUX" bake after.json -o after.olx "${bake[@]}" 2>stderr.txt
picture=(--size 64x48 --spp 1 --centered)

expect 0 render after.json --field after.olx -o fresh.exr "${picture[@]}"
expect 0 render after.json --field before.olx -o stale.exr "${picture[@]}"
grep -q "another scene" stderr.txt || fail "no warning of a stale field"
expect_json 'o["relight"]["awake"] == 0 and 4 < o["relight"]["frames"] < 200 and o["passes"]["relight"] > 0' \
  render after.json --field before.olx -o relit.exr "${picture[@]}" --relight 200
grep -q "another scene" stderr.txt && fail "a field that was relit is called stale"
expect_json 'o["relight"]["frames"] == 1' render after.json --field before.olx -o once.exr "${picture[@]}" --relight 1

# apart A B CONDITION: checks the condition on the relative mean squared error between their indirect diffuse light.
apart() {
  expect_json "all(l['relative_mse'] $3 for l in o['layers'].values())" compare "$1" "$2" --layer indirect_diffuse
}
apart relit.exr fresh.exr "< 0.02"
apart stale.exr fresh.exr "> 0.3"
apart once.exr relit.exr "> 0.001"

expect_usage "--relight goes with --method field" render after.json -o none.exr --relight 3
expect_usage "irradiance probes are not lit anew" render after.json --field before.olx -o none.exr --relight 3 --diffuse irradiance
expect_failure "bake --relight" render after.json --field after.olx -o none.exr --size 8x8 --relight 3
[ -e none.exr ] && fail "a picture was left"

"$OCTALUX" render after.json --field before.olx -o vulkan.exr --size 64x48 --spp 1 --relight 200 --device vulkan --validate --json \
  >stdout.txt 2>stderr.txt
if grep -qE "no Vulkan|without the Vulkan runtime" stderr.txt; then
  cat stderr.txt
  finish
fi
python3 -c 'import json; o = json.load(open("stdout.txt")); assert o["relight"]["copied_bytes"] > 1e4, o' || fail "nothing was copied"
apart vulkan.exr relit.exr "< 1e-5"
finish
