# The viewer on Mesa's CPU device, with no window and under Xvfb: every mode and overlay, flying, resizing, screenshots, and all
# that may go wrong. A display of its own is used, never the user's.
source "$(dirname "$0")/cli/expect.sh"
unset DISPLAY WAYLAND_DISPLAY

# Without the program beside it, the command says what is missing.
cp "$OCTALUX" alone
"./alone" view builtin:cornell --field a.olx >stdout.txt 2>stderr.txt && fail "a viewer that is not there ran"
grep -q "octalux-view is not there" stderr.txt || fail "no word of the missing viewer"
[ -x "$(dirname "$OCTALUX")/octalux-view" ] || { echo "this build has no viewer"; exit 77; }

# Under the address sanitizer the drivers are kept loaded, so that a leak report can name what they keep (leaks.supp).
if ldd "$OCTALUX" | grep -q libasan; then
  printf '#!/bin/sh\nexec env LD_PRELOAD="%s" ASAN_OPTIONS="%s:verify_asan_link_order=0" "%s" "$@"\n' \
    "$OCTALUX_FAULT_LAYER/libkeep_drivers.so" "${ASAN_OPTIONS:-}" "$OCTALUX" >kept
  chmod +x kept
  OCTALUX=$folder/kept
fi

help="$OCTALUX_SOURCE_DIR/tests/cli/view_help.txt"
expect 0 view --help
if [ "${UPDATE_GOLDEN:-}" ]; then cp stdout.txt "$help"; fi
diff -u "$help" stdout.txt >difference.txt || { cat difference.txt; fail "view's help changed; see test_cli_usage.sh"; }
expect_usage "SCENE is missing" view
expect_usage "--field FILE.olx is missing" view builtin:cornell
expect_usage "is not one of prefiltered" view builtin:cornell --field a.olx --mode raster
expect_usage "is not one of none|probes" view builtin:cornell --field a.olx --overlay all
expect_usage "needs traced diffuse light" view builtin:cornell --field a.olx --emitters traced
expect_usage "--offscreen needs" view builtin:cornell --field a.olx --offscreen
expect_usage "is not a pixel" view builtin:cornell --field a.olx --pick 1280,0
expect_usage "is not a place" view builtin:cornell --field a.olx --object 1,2
expect_usage "does not end in .png" view builtin:cornell --field a.olx --screenshot a.jpg

"$OCTALUX" bake builtin:cornell-glossy -o cornell.olx --radiance-size 64 --irradiance-size 16 --bounces 1 --select cage,bricks \
  >stdout.txt 2>stderr.txt
view=(view builtin:cornell-glossy --field cornell.olx --size 96x80)

# check EXPRESSION FILE...: true of these pictures.
check() { python3 "$OCTALUX_SOURCE_DIR/tests/read_png.py" "$@" || fail "pictures: $*"; }

# With the validation layers, where they are installed.
validate=--validate code=0
"$OCTALUX" "${view[@]}" --offscreen --screenshot one.png --validate >stdout.txt 2>stderr.txt || code=$?
if grep -q "not installed" stderr.txt; then
  validate=
  expect 0 "${view[@]}" --offscreen --screenshot one.png
elif [ $code != 0 ]; then
  fail "a picture: exit code $code"
fi
grep -q "one.png" stderr.txt || fail "no word of the screenshot"
check 'p[0].width == 96 and p[0].height == 80 and not uniform(p[0]) and mean(p[0]) > 10' one.png
expect 0 render builtin:cornell-glossy --field cornell.olx --spp 1 --size 96x80 -o cpu.png
check 'differing(p[0], p[1]) < 0.3 and abs(mean(p[0]) / mean(p[1]) - 1) < 0.1' one.png cpu.png

# All modes and overlays, one after the other; the layers; what moves.
cat >all.txt <<'SCRIPT'
frames 3
screenshot plain.png
press O            # the overlays in their order
screenshot probes.png
press O
screenshot radiance.png
press O
screenshot irradiance.png
press O
screenshot weights.png
press O
screenshot answer.png
press O
screenshot unresolved.png
press O
screenshot steps.png
press O
pick 40 60
screenshot map.png
press N
screenshot map-of-first.png
press O            # none again
press 2
frames 3
screenshot denoised.png
press L
screenshot met.png
press L
press 3
screenshot gathered.png
press 4
screenshot primary.png
press O
press O
press O
press O
press O
screenshot primary-answer.png
press O
press O
press O
press O
press 1
press R
screenshot no-direct.png
press F
screenshot no-diffuse.png
press G
screenshot no-light.png
press R
press F
press G
press T
press B
press L
press L
press V
press V
press C
press X
screenshot ball.png
hold LEFT 6
screenshot ball-left.png
press X
press =
press =
press =
screenshot bright.png
press -
press -
press -
press [
press [
screenshot coarse.png
press ]
press ]
hold W 8
look 30 -10
screenshot moved.png
resize 48x60
screenshot small.png
resize 0x0
frames 3
resize 96x80
wheel 2
press C
screenshot back.png
quit
SCRIPT
expect 0 "${view[@]}" --offscreen --script all.txt --gather-samples 2 $validate
shots=(probes radiance irradiance weights answer unresolved steps map met primary no-direct no-diffuse no-light ball bright coarse moved)
check 'not uniform(p[0]) and mean(p[0]) > 10' plain.png
for shot in "${shots[@]}"; do
  [ $shot = no-light ] || check 'not uniform(p[0]) and mean(p[0]) > 1' $shot.png
  check 'differing(p[0], p[1]) > 0.004' $shot.png plain.png
done
check 'differing(p[0], p[1]) > 0.01' map.png map-of-first.png
check 'differing(p[0], p[1]) > 0.3' primary-answer.png primary.png
for shot in denoised gathered; do
  check 'differing(p[0], p[1]) < 0.5 and abs(mean(p[0]) / mean(p[1]) - 1) < 0.15' $shot.png plain.png
done
check 'mean(p[0]) < 0.5 * mean(p[1])' no-light.png plain.png
check 'differing(p[0], p[1]) > 0.004' ball.png ball-left.png
check 'mean(p[0]) > 1.2 * mean(p[1])' bright.png plain.png
check 'p[0].width == 48 and p[0].height == 60 and not uniform(p[0])' small.png
check 'differing(p[0], p[1]) < 0.2 and abs(mean(p[0]) / mean(p[1]) - 1) < 0.1' back.png plain.png
rm -f *.png

# Lights that move, and indirect light that follows them or stays as it was. The same script gives the same pictures.
printf '{"model": "builtin:cornell", "lights": [{"type": "point", "position": [0.1, 0.12, 0.1], "intensity": [0.4, 0.3, 0.5]}]}' >lit.json
"$OCTALUX" bake lit.json -o lit.olx --grid 2x2x2 --radiance-size 16 --irradiance-size 16 --bounces 4 --relight >stdout.txt 2>stderr.txt
cat >lights.txt <<'SCRIPT'
frames 2
screenshot before.png
light 0 0.44 0.4 0.3
screenshot moved.png
frames 12
screenshot settled.png
dim 0 0
frames 12
screenshot dark.png
press M
press K
hold LEFT 3
frames 2
screenshot left.png
SCRIPT
lights=(view lit.json --field lit.olx --size 64x48 --offscreen --script lights.txt)
expect 0 "${lights[@]}" $validate
check 'differing(p[0], p[1]) > 0.1' before.png moved.png
check 'differing(p[0], p[1]) > 0.1 and mean(p[0]) < mean(p[1])' dark.png before.png
check 'differing(p[0], p[1]) > 0.1 and mean(p[0]) > mean(p[1])' left.png dark.png
mv settled.png stale.png
expect 0 "${lights[@]}" --relight $validate
check 'differing(p[0], p[1]) > 0.05' settled.png stale.png
check 'differing(p[0], p[1]) > 0.05' settled.png moved.png
check 'mean(p[0]) < 0.7 * mean(p[1])' dark.png before.png
expect 0 render lit.json --field lit.olx --relight 1 --spp 1 --size 64x48 -o rendered.png
check 'abs(mean(p[0]) / mean(p[1]) - 1) < 0.05' before.png rendered.png
sed 's/"position": [^]]*]/"position": [0.44, 0.4, 0.3]/' lit.json >there.json
expect 0 render there.json --field lit.olx --relight 15 --spp 1 --size 64x48 -o rendered.png
check 'abs(mean(p[0]) / mean(p[1]) - 1) < 0.05' settled.png rendered.png
mv settled.png first.png
expect 0 "${lights[@]}" --relight
cmp -s settled.png first.png || fail "the same script gives another picture"
expect_failure "bake --relight" "${view[@]}" --relight --offscreen --frames 1

# What cannot work says so, and leaves nothing.
expect_failure "there is no display" "${view[@]}" --frames 1
head -c 8 cornell.olx >newer.olx
printf '\x07' >>newer.olx
tail -c +10 cornell.olx >>newer.olx
expect_failure "version 7" view builtin:cornell-glossy --field newer.olx --offscreen --frames 1
expect_failure "no camera" "${view[@]}" --camera behind --offscreen --frames 1
expect_failure "voronoi" "${view[@]}" --select voronoi --offscreen --frames 1
"$OCTALUX" bake builtin:cornell-glossy -o wang.olx --radiance-size 16 --irradiance-size 8 --bounces 1 --select voronoi,octree \
  2>stderr.txt
expect 0 view builtin:cornell-glossy --field wang.olx --size 32x24 --select voronoi --offscreen --frames 1
expect_failure "octree does not run" view builtin:cornell-glossy --field wang.olx --select octree --offscreen --frames 1
expect_failure "nosuch.txt: cannot be read" "${view[@]}" --offscreen --script nosuch.txt
printf 'frames 2\npress ENTER\n' >wrong.txt
expect_failure "wrong.txt:2: 'press'" "${view[@]}" --offscreen --script wrong.txt
for line in "light 0 1 2" "light 16 1 2 3" "light -1 1 2 3" "light 0 1 2 x" "dim 0" "dim 0 -1"; do
  echo "$line" >wrong.txt
  expect_failure "wrong.txt:1: '${line%% *}'" "${view[@]}" --offscreen --script wrong.txt
done
VK_ICD_FILENAMES=/nonexistent.json expect_failure "Vulkan" "${view[@]}" --offscreen --frames 1

# fault CALL:NUMBER:RESULT ...: run with that call of Vulkan failing.
fault() {
  local wish=$1
  shift
  FAULT=$wish VK_LAYER_PATH=$OCTALUX_FAULT_LAYER VK_INSTANCE_LAYERS=VK_LAYER_OCTALUX_fault "$@"
}
lost=-4 out_of_memory=-2 out_of_date=-1000001004 surface_lost=-1000000000
fault version:1:0 expect_failure "no Vulkan 1.2 device" "${view[@]}" --offscreen --frames 1
fault submit:1:$lost expect_failure "lost" "${view[@]}" --offscreen --frames 3
fault submit:14:$lost expect_failure "lost" "${view[@]}" --offscreen --frames 20
# Allocations for the field, the lamps, the panel's letters.
for number in 3 21 35; do
  fault memory:$number:$out_of_memory expect_failure "memory\|letters" "${view[@]}" --offscreen --frames 1
done

command -v Xvfb >/dev/null || { echo "no Xvfb here: windows are not tested"; finish; }
Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp 3>display.txt 2>xvfb.txt &
server=$!
trap 'kill $server 2>/dev/null; wait $server 2>/dev/null; rm -rf "$folder"' EXIT
for _ in $(seq 100); do [ -s display.txt ] && break; sleep 0.1; done
[ -s display.txt ] || { fail "Xvfb does not start"; cat xvfb.txt; finish; }
DISPLAY=:$(cat display.txt)
export DISPLAY

cat >window.txt <<'SCRIPT'
frames 2
hold W 4
look 20 5
screenshot flown.png
resize 200x150
frames 3
screenshot larger.png
resize 0x0
frames 2
resize 120x90
frames 3
press O
press TAB
press P
frames 2
press ESCAPE
frames 5
screenshot after.png
SCRIPT
expect 0 "${view[@]}" --script window.txt $validate
check 'not uniform(p[0]) and mean(p[0]) > 10 and p[0].width == 96' flown.png
check 'not uniform(p[0]) and mean(p[0]) > 10 and p[0].width == 200 and p[0].height == 150' larger.png
check 'not uniform(p[0]) and p[0].width == 120' octalux-001.png
[ -e after.png ] && fail "escape did not leave"
# Relighting beside the pictures, on a thread of its own.
expect 0 view lit.json --field lit.olx --size 64x48 --relight --frames 12 --screenshot beside.png $validate
check 'not uniform(p[0]) and mean(p[0]) > 10' beside.png
fault acquire:2:$out_of_date expect 0 "${view[@]}" --frames 4 --screenshot again.png
check 'not uniform(p[0]) and mean(p[0]) > 10' again.png
fault acquire:2:$surface_lost expect_failure "window" "${view[@]}" --frames 4
finish
