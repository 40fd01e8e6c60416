# Irradiance as spherical harmonics from the command line: bake --irradiance, the report of info, render and audit.
source "$(dirname "$0")/cli/expect.sh"
small=(--grid 2x2x2 --radiance-size 8 --irradiance-size 16 --bounces 1)

for form in octahedral sh2 sh3; do
  expect 0 bake builtin:cornell -o $form.olx "${small[@]}" --irradiance $form
  expect 0 verify $form.olx
  expect 0 render builtin:cornell --field $form.olx -o $form.exr --size 32x24 --spp 1 --diffuse irradiance
done
expect_json 'o["irradiance"] == "sh2" and o["bytes"]["irradiance"] == 24 * o["irradiance_probes"]' info sh2.olx
expect_json 'o["irradiance"] == "sh3" and o["bytes"]["irradiance"] == 56 * o["irradiance_probes"]
  and o["bytes"]["moments"] == 4 * 18 ** 2 * o["irradiance_probes"]' info sh3.olx
expect_json 'o["irradiance"] == "octahedral" and o["bytes"]["irradiance"] == o["bytes"]["moments"]' info octahedral.olx
expect 0 info sh3.olx
grep -q "irradiance as  *sh3, maps of moments alone" stdout.txt || fail "info does not tell the form"
expect 0 bake builtin:cornell -o plain.olx "${small[@]}"
cmp -s plain.olx octahedral.olx || fail "maps are not the default"
expect 0 bake builtin:cornell -o one.olx "${small[@]}" --irradiance sh3 --threads 1
cmp -s one.olx sh3.olx || fail "the bytes depend on the threads"

# Pictures with harmonics differ from those with maps, with more bands by less; no other layer changes.
for form in sh2 sh3; do
  for layer in direct indirect_glossy albedo; do
    expect_json 'all(l["max"] == 0 for l in o["layers"].values())' compare $form.exr octahedral.exr --layer $layer
  done
  expect_json 'all(l["max"] > 0 and l["relative_mse"] < 0.05 for l in o["layers"].values())' \
    compare $form.exr octahedral.exr --layer indirect_diffuse
  cp stdout.txt $form.json
done
python3 - <<'PYTHON' || fail "nine coefficients are no better than four"
import json, sys
error = lambda form: json.load(open(form + ".json"))["layers"]["indirect_diffuse"]["mse"]
sys.exit(not error("sh3") < error("sh2"))
PYTHON

# Harmonics have a fit to surfaces of their own, which removes most of their error there, as the fit of maps does.
expect 0 bake builtin:cornell -o unfitted.olx "${small[@]}" --irradiance sh2 --no-fit
for field in unfitted sh2; do
  expect_json 'o["points"]["count"] == 200' audit builtin:cornell --field $field.olx --rays 2 --points 200
  cp stdout.txt $field.json
done
python3 - <<'PYTHON' || fail "the fit does not help"
import json, sys
error = lambda field: json.load(open(field + ".json"))["irradiance_points"]["relative_mse"]
sys.exit(not error("sh2") < 0.7 * error("unfitted"))
PYTHON

expect_usage "is not one of octahedral|sh2|sh3" bake builtin:cornell -o a.olx --irradiance sh4
[ -e a.olx ] && fail "a refused bake leaves a file"
finish
