# Checks that compilers of real GPUs can handle every pipeline: registers, spills, scratch memory and code size on an
# AMD chip that RADV compiles for without its presence stay within tests/shader_bounds.tsv. The bounds are those of
# Debian 12's Mesa 22.3. The pipelines are those of default frames and relighting on navi21, since all take a tenth of
# the time that `make check` has; full_shader_stats.sh checks all pipelines, for the chips in OLX_CHIPS.
source "$(dirname "$0")/cli/expect.sh"
bench=$(dirname "$OCTALUX")/octalux-bench-gpu
read -ra chips <<<"${OLX_CHIPS:-navi21}"
quick=(--quick)
[ -z "${OLX_CHIPS:-}" ] || quick=()
tests=$OCTALUX_SOURCE_DIR/tests
[ -x "$bench" ] || { echo "skipped: built without Vulkan"; exit 77; }
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0" # allocations that drivers keep cannot be named

"$OCTALUX" bake builtin:cornell-glossy -o tiny.olx --grid 2x2x2 --irradiance-grid 2x2x2 --radiance-size 16 --irradiance-size 16 \
  --select cage,bricks,voronoi --relight --classic --classic-size 32 --samples 1 --bounces 0 --noise 0.3 >/dev/null || fail "bake"
OCTALUX=$bench
expect_usage "--compile goes with --field" --compile
expect_usage "--compile goes with --field" --compile --field tiny.olx --data .

status=0
"$OCTALUX_SOURCE_DIR/scripts/shader_stats.sh" "${quick[@]}" "$bench" tiny.olx "${chips[@]}" >statistics.json 2>stderr.txt || status=$?
if [ $status = 77 ]; then cat stderr.txt; echo "skipped"; exit 77; fi
[ $status = 0 ] || { cat stderr.txt; fail "shader_stats.sh exits with $status"; }
python3 "$tests/check_shader_stats.py" "$tests/shader_bounds.tsv" statistics.json >found.txt || status=1
if ! grep -q '"radv Mesa 22\.3\.' statistics.json; then echo "skipped: the bounds are of Mesa 22.3"; exit 77; fi
cat found.txt
[ $status = 0 ] || fail "a pipeline takes more than it may"

# The check reports exceeded bounds and missing pipelines.
sed 's/^glossy\t[0-9]*\t\([0-9]*\)\t[0-9]*/glossy\t8\t\1\t8/; /^dim\t/d' "$tests/shader_bounds.tsv" >narrow.tsv
python3 "$tests/check_shader_stats.py" narrow.tsv statistics.json >found.txt && fail "a bound of 8 registers holds"
grep -qi "${chips[0]}.*: glossy: VGPRs is [0-9]*, at most 8 allowed" found.txt || fail "the register bound is not named"
grep -q "dim is in the table or among the pipelines, but not in both" found.txt || fail "a pipeline without bounds is not named"

finish
