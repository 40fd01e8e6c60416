# octalux-bench-gpu: it needs nothing but a Vulkan loader, reports every pass of a tiny run, and says what is wrong with
# its input.
source "$(dirname "$0")/cli/expect.sh"
bench=$(dirname "$OCTALUX")/octalux-bench-gpu
bake_cooked=$(dirname "$OCTALUX")/bench/bake_cooked
[ -x "$bench" ] || { echo "skipped: built without Vulkan"; exit 77; }
octalux=$OCTALUX
# Allocations that drivers keep cannot be named once the loader has unloaded them, so leaks are not detected here;
# test_raster_vulkan looks for leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"

# From here on `expect` and the other helpers run the benchmark instead of octalux.
OCTALUX=$bench
expect_usage "either --data DIR, or --scene" --quick
expect_usage "either --data DIR, or --scene" --data . --scene a.olxs --field a.olx
expect_usage "go together" --scene a.olxs
expect_usage "there is no row 'sibenik'" --data . --rows sponza,sibenik
expect_usage "chooses among those of --data" --scene a.olxs --field a.olx --rows sponza
expect_usage "is not a size" --data . --size 1920
expect_usage "from 1 to 100000" --data . --frames 0
expect_usage "is not a number above 0" --data . --bandwidth -3
expect_usage "octalux-bench-gpu: unknown option '--speed'" --data . --speed
expect_usage "is one argument too many (see octalux-bench-gpu --help)" --data . fast
expect 0 --help
grep -q "^usage: octalux-bench-gpu \[options\]" stdout.txt || fail "the help's first line"

if command -v readelf >/dev/null; then
  readelf -d "$bench" | grep NEEDED | grep -v -E 'lib(c|m|dl|pthread|asan|ubsan|tsan|gcc_s)\.so|ld-linux' && fail "it needs more than libc and libm"
fi

if ! "$bench" --list >stdout.txt 2>stderr.txt; then
  cat stderr.txt
  echo "skipped: no Vulkan"
  exit 77
fi
grep -q "^0  " stdout.txt || fail "no device in the list"
expect_failure "there is no Vulkan device 15; there are" --data . --device 15

# A run compiles every shader, which takes most of this test's time, so there are only three runs. In this one the data
# of one row exist and the other rows are reported as missing; the validation layers are used where they are installed.
"$octalux" scene builtin:cornell-glossy --cook glossy.olxs >/dev/null || fail "cook"
"$bake_cooked" glossy.olxs glossy.olx 16 8 2x2x2 cage,bricks || fail "bake_cooked"
mkdir data
cp glossy.olxs data/cornell.olxs
cp glossy.olx data/cornell-256.olx
tiny=(--quick --size 64x36 --frames 3)
validate=--validate
"$bench" --data . --device 15 --validate 2>&1 | grep -q "layers are not installed" && validate=
# Stored light takes at least four texels of a probe, each with one read of its geometry block and one of its light.
expect_json "o['width'] == 64 and o['height'] == 36 and o['frames'] == 3 and o['copy_gigabytes_a_second'] > 0 and
  [r['state'] for r in o['rows']] == ['skipped', 'done', 'skipped', 'skipped', 'skipped', 'skipped'] and
  'cornell-2048.olx is not there' in o['rows'][0]['problem'] and
  set(o['rows'][1]['passes']) == {'shadow', 'gbuffer', 'direct', 'irradiance', 'glossy', 'denoise', 'composite', 'tone',
    'floor_irradiance', 'floor_glossy', 'diffuse_rays', 'glossy_rays', 'denoise_both'} and
  all(0 < p['least_ms'] <= p['ms'] < 60000 for p in o['rows'][1]['passes'].values()) and
  o['rows'][1]['paper'] == {'irradiance_ms': 0.302, 'glossy_ms': 0} and not o['rows'][1]['as_published'] and
  o['rows'][1]['probes'] == 8 and o['rows'][1]['radiance_size'] == 16 and not o['rows'][1]['other_scene'] and
  8 <= o['rows'][1]['counts']['surface_texels'] <= 48 and 0 <= o['rows'][1]['counts']['filtered_reads'] <= 16 and o['rows'][1]['counts']['ray_share'] > 0.1 and
  o['rows'][1]['counts']['fetches'] > 3" --data data "${tiny[@]}" $validate
grep -q "sponza: skipped: data/sponza.olxs is not there" stderr.txt || fail "a row is skipped silently"
grep -q "^validation" stderr.txt && fail "the validation layers found fault"
expect_failure "no row could be run" --data data --rows kitchen,sponza "${tiny[@]}" --json
"$bake_cooked" glossy.olxs voronoi.olx 16 8 2x2x2 voronoi || fail "bake_cooked without cage"
expect_failure "needs cage and bricks" --scene glossy.olxs --field voronoi.olx --compare "${tiny[@]}"

# This run compares both methods of tracing, two-level with cage and hiz with bricks.
expect_json "(lambda c: c['two-level+cage']['counts']['steps'] > c['hiz+bricks']['counts']['steps'] > 1 and c['ratio'] > 0)(
  o['rows'][0]['compare'])" --scene glossy.olxs --field glossy.olx "${tiny[@]}" --compare $validate
grep -q "^validation" stderr.txt && fail "the validation layers found fault"

# The table for people, in a scene without glossy surfaces, shows the paper's number, the stated bandwidth, and how the
# run differs from the paper's.
"$octalux" scene builtin:cornell --cook data/cornell.olxs >/dev/null || fail "cook"
expect 0 --data data --rows cornell-256 "${tiny[@]}" --bandwidth 100
grep -q "glossy light: no ray" stdout.txt || fail "rays where nothing is glossy"
grep -q "WARNING: the field was baked from another scene" stdout.txt || fail "another scene's field passes for this one's"
grep -q "paper 0.302" stdout.txt || fail "no number of the paper"
grep -q "reckoned with 100.0 GB/s, as stated" stdout.txt || fail "the stated bandwidth is not used"
grep -q "not the paper's 8 probes of 256" stdout.txt || fail "a smaller field passes for the paper's"

# Broken or missing input is refused with a message that says why.
expect_failure "missing.olxs is not there" --scene missing.olxs --field glossy.olx "${tiny[@]}"
expect_failure "missing.olx is not there" --scene glossy.olxs --field missing.olx "${tiny[@]}"
expect_failure 'no camera named "back"' --scene glossy.olxs --field glossy.olx "${tiny[@]}" --camera back
head -c 4000 glossy.olxs >cut.olxs
expect_failure "cut.olxs: " --scene cut.olxs --field glossy.olx "${tiny[@]}"
cp glossy.olxs flipped.olxs
printf '\x55' | dd of=flipped.olxs bs=1 seek=3000 conv=notrunc status=none
expect_failure "flipped.olxs: .*checksum" --scene flipped.olxs --field glossy.olx "${tiny[@]}"
head -c 1000 glossy.olx >cut.olx
expect_failure "cut.olx: " --scene glossy.olxs --field cut.olx "${tiny[@]}"
"$octalux" bake builtin:cornell-glossy -o plain.olx --radiance-size 16 --irradiance-size 8 --bounces 0 --no-fit --select cage \
  2>stderr.txt || fail "bake"
expect_usage "'voronoi' is not one of" --scene glossy.olxs --field plain.olx "${tiny[@]}" --select voronoi
"$bake_cooked" glossy.olxs plain.olx 16 8 2x2 2>/dev/null && fail "bake_cooked takes a grid of two numbers"
"$bake_cooked" glossy.olxs plain.olx 16 8 2x2x2 cage,kd-tree 2>/dev/null && fail "bake_cooked takes an unknown selector"
finish
