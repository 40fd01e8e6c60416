# The Cornell box at a tiny size through every command: what each command prints, and that the next command reads its
# files.
source "$(dirname "$0")/cli/expect.sh"
scene=builtin:cornell

expect_json 'o["triangles"] >= 32 and o["vertices"] >= o["triangles"] / 3 and o["materials"] >= 3 and o["lights"] >= 1
  and o["cameras"] >= 1 and len(o["bounds_min"]) == 3 and all(a < b for a, b in zip(o["bounds_min"], o["bounds_max"]))
  and o["textures"] == 0 and o["warnings"] == len(o["warning_messages"])' scene $scene
expect 0 scene $scene

expect_json 'o["probes"] == 8 and o["rays"] > 8 * 64 * 64 * 4 and o["seconds"] > 0 and o["embree_seconds"] > 0
  and o["peak_memory_bytes"] > 1 << 20 and o["file_bytes"] > 8 * 64 * 64 * 8' \
  bake $scene -o a.olx --grid 2x2x2 --radiance-size 64 --irradiance-size 16 --bounces 1 --noise 0.1 --measure-embree
expect 0 bake $scene -o b.olx --grid=2x2x2 --radiance-size=64 --irradiance-size=16 --bounces=1 --noise=0.1 --threads 1
cmp a.olx b.olx || fail "a field depends on the number of threads"
expect_files a.olx b.olx

bytes=$(wc -c <a.olx)
expect_json 'o["probes"] == 8 and o["irradiance_probes"] == 27 and o["radiance_size"] == 64 and o["irradiance_size"] == 16
  and o["select"] == "cage,bricks" and o["version"] == 2 and o["lights"] == 0 and o["file_bytes"] == '"$bytes"' and o["bounces"] == 1 and o["grid"]["count"] == [2, 2, 2]
  and set("radiance normal distance pyramid material direct indirect emission irradiance moments selector".split()) <= set(o["bytes"])
  and sum(o["bytes"].values()) <= o["file_bytes"]' info a.olx
expect 0 info a.olx
expect_json 'o["file_bytes"] == '"$bytes" verify a.olx
expect 0 verify a.olx
head -c $((bytes - 100)) a.olx >cut.olx
expect_failure "cut.olx" info cut.olx
printf 'x' | dd of=b.olx bs=1 seek=$((bytes / 2)) conv=notrunc 2>/dev/null
cmp -s a.olx b.olx || expect_failure "b.olx" verify b.olx
rm cut.olx b.olx

expect_json 'o["seconds"] > 0 and o["passes"] and all(v >= 0 for v in o["passes"].values())' \
  render $scene -o path.exr --method path --size 64x48 --spp 16 --bounces 2
expect 0 render $scene -o field.exr --field a.olx --size 64x48 --spp 1 --glossy-samples 1
expect 0 render $scene -o traced.exr --method field --field a.olx --size 64x48 --spp 1 --diffuse traced \
  --diffuse-samples 8 --tracer texel --select cage --visibility none --keep-buried --standard-error --device cpu
expect 0 render $scene -o probes.png --field a.olx --size 64x48 --spp 1 --show-probes --exposure 2
[ "$(head -c 8 probes.png | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] || fail "probes.png is no PNG"
expect 0 render $scene -o plain.exr --png plain.png --field a.olx --size 64x48 --spp 1 --exposure 2
expect 0 render $scene -o alone.png --field a.olx --size 64x48 --spp 1 --exposure 2
cmp plain.png alone.png || fail "--png writes another picture than -o"
# A picture that is all white or all black is reported, with an exposure at which it is not.
for case in "1000 white" "0.00001 black"; do
  read -r exposure color <<<"$case"
  "$OCTALUX" render $scene -o alone.png --field a.olx --size 64x48 --spp 1 --exposure "$exposure" 2>stderr.txt >stdout.txt
  shows=$(sed -n "s/^warning: alone.png: most of the picture is $color: --exposure \\([0-9.e-]*\\) shows it$/\\1/p" stderr.txt)
  [ -n "$shows" ] || fail "exposure $exposure is not reported: $(cat stderr.txt)"
  "$OCTALUX" render $scene -o alone.png --field a.olx --size 64x48 --spp 1 --exposure "$shows" 2>stderr.txt >stdout.txt
  if grep -q "most of the picture" stderr.txt; then fail "exposure $shows, as recommended: $(cat stderr.txt)"; fi
done
cmp -s probes.png plain.png && fail "--show-probes shows nothing"
expect 0 render $scene -o path2.exr --method path --size 64x48 --spp 16 --bounces 2 --threads 1
cmp path.exr path2.exr || fail "a path-traced image depends on the number of threads"

layers='{"beauty", "direct", "indirect_diffuse", "indirect_glossy"}'
expect_json 'set(o["layers"]) == '"$layers"' and all(set(m) >= {"mse", "relative_mse", "psnr", "bias", "max"}
  for m in o["layers"].values()) and o["layers"]["beauty"]["relative_mse"] < 0.5' compare field.exr path.exr
expect_json 'all(m["mse"] == 0 and m["relative_mse"] == 0 and m["bias"] == 0 and m["psnr"] is None
  for m in o["layers"].values())' compare path.exr path.exr
expect_json 'set(o["layers"]) == {"normal"} and o["layers"]["normal"]["relative_mse"] < 0.15' \
  compare field.exr path.exr --layer normal --heatmap heat.png
expect 0 compare field.exr path.exr
[ -s heat.png ] || fail "no heat map"
expect_failure "no layer standard_error" compare path.exr field.exr --layer standard_error
expect 0 render $scene -o small.exr --method path --size 32x48 --spp 1
expect_failure "sizes differ" compare small.exr path.exr

share='0 <= r["unresolved"] <= 1 and 0 <= r["wrong"] <= 1 and 0 <= r["unseen"] <= 1'
expect_json 'all('"$share"' for r in [o["rays"]]) and o["rays"]["count"] == 2000 and o["points"]["count"] == 20
  and set("unresolved_seen wrong_seen distance_error_median distance_error_p99 steps_mean probes_mean".split())
  <= set(o["rays"]) and o["points"]["relative_mse"] >= 0 and "bias" in o["points"] and "leak" in o["points"]' \
  audit $scene --field a.olx --rays 2000 --points 20 --spp 16
# Points with stored light and points without add up to all points, and irradiance probes are compared at the same
# points.
expect_json 'all(set(o[k]) == {"count", "relative_mse", "bias", "leak"} for k in
    ("points", "stored_points", "fallen_back_points", "irradiance_points"))
  and o["stored_points"]["count"] + o["fallen_back_points"]["count"] == o["points"]["count"] == 40
  and o["stored_points"]["count"] >= 39 and o["irradiance_points"]["count"] == 40
  and o["irradiance_points"]["relative_mse"] != o["points"]["relative_mse"]' \
  audit $scene --field a.olx --rays 2 --points 40 --spp 64
expect 0 audit $scene --field a.olx --rays 2 --points 5 --spp 4
grep -q "stored at surfaces" stdout.txt || fail "the audit does not tell stored points apart"
expect 0 audit $scene --field a.olx --rays 500 --points 5 --spp 4 --seed 7 --tracer texel --visibility none --threads 1

OCTALUX=$OCTALUX_BENCH expect_json 'o["experiment"] == "speed" and o["ratio"] > 0 and abs(o["ratio"] - o["seconds"] / o["embree_seconds"]) < 1e-6' \
  speed $scene --grid 1x1x1 --radiance-size 32 --irradiance-size 8 --bounces 0

# A cancelled bake reports it, exits with 130, and touches neither the old field nor the folder.
cp a.olx old.olx
ls -A >before.txt
"$OCTALUX" bake $scene -o old.olx --no-work --grid 8x8x8 --irradiance-grid 2x2x2 --radiance-size 128 --irradiance-size 8 --bounces 0 --noise 0.5 \
  --progress >stdout.txt 2>stderr.txt &
bake=$!
await $bake '%'
kill -INT $bake
code=0
wait $bake || code=$?
[ "$code" = 130 ] || fail "an interrupted bake: exit code $code, not 130"
tail -n 1 stderr.txt | grep -q "interrupted" || fail "an interrupted bake does not say so"
cmp a.olx old.olx || fail "an interrupted bake touched the old field"
ls -A | diff before.txt - || fail "an interrupted bake left files"

finish
