# The viewer on Mesa's CPU device, without a window and under Xvfb: every mode and overlay, flying, resizing,
# screenshots. full_view.sh tests failures and moving lights.
source "$(dirname "$0")/cli/viewer.sh"

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
expect_usage "has no numbers to print" view builtin:cornell --field a.olx --json
expect_usage "does not end in .png" view builtin:cornell --field a.olx --screenshot a.jpg

# The first picture agrees with the CPU's. A run of the viewer compiles every shader, which takes most of this test's
# time, so few runs show many things; full_view.sh shows the rest, under the validation layers.
expect 0 render builtin:cornell-glossy --field cornell.olx --spp 1 --size 96x80 -o cpu.png

# A field without probe light can be viewed, and so can a map of its texels; other views of probe light are refused, and
# the key skips them.
"$OCTALUX" bake builtin:cornell-glossy -o plain.olx --radiance-size 64 --bounces 1 --noise 0.3 >stdout.txt 2>stderr.txt
plain=(view builtin:cornell-glossy --field plain.olx --size 96x80 --offscreen)
cat >plain.txt <<'SCRIPT'
screenshot without.png
press O
press O
screenshot radiance-without.png
press O
screenshot answer-without.png
press O
press O
press O
pick 40 60
screenshot map-without.png
quit
SCRIPT
expect 0 "${plain[@]}" --script plain.txt
for wrong in "--overlay irradiance" "--overlay weights" "--hits stored"; do
  expect_failure "bake --probe-light" "${plain[@]}" --screenshot refused.png $wrong
done

# The script shows all modes and overlays one after the other, the layers, and moving objects.
cat >all.txt <<'SCRIPT'
screenshot one.png
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
screenshot chrome-left.png
press X
screenshot no-ball.png
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
expect 0 "${view[@]}" --offscreen --script all.txt --gather-samples 2
check 'p[0].width == 96 and p[0].height == 80 and not uniform(p[0]) and mean(p[0]) > 10' one.png
for other in cpu without; do
  check 'differing(p[0], p[1]) < 0.3 and abs(mean(p[0]) / mean(p[1]) - 1) < 0.1' one.png $other.png
done
for overlay in radiance answer map; do
  check 'abs(mean(p[0]) / mean(p[1]) - 1) < 0.15' $overlay-without.png $overlay.png
done
shots=(probes radiance irradiance weights answer unresolved steps map met primary no-direct no-diffuse no-light ball chrome-left no-ball bright coarse moved)
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
check 'differing(p[0], p[1]) > 0.001' ball-left.png chrome-left.png # the ball has another finish
check 'differing(p[0], p[1]) > 0.004' chrome-left.png no-ball.png
check 'mean(p[0]) > 1.2 * mean(p[1])' bright.png plain.png
check 'p[0].width == 48 and p[0].height == 60 and not uniform(p[0])' small.png
check 'differing(p[0], p[1]) < 0.2 and abs(mean(p[0]) / mean(p[1]) - 1) < 0.1' back.png plain.png
rm -f *.png

expect_failure "there is no display" "${view[@]}" --frames 1
start_display
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
expect 0 "${view[@]}" --script window.txt
check 'not uniform(p[0]) and mean(p[0]) > 10 and p[0].width == 96' flown.png
check 'not uniform(p[0]) and mean(p[0]) > 10 and p[0].width == 200 and p[0].height == 150' larger.png
check 'not uniform(p[0]) and p[0].width == 120' octalux-001.png
[ -e after.png ] && fail "escape did not leave"
# Shaders are compiled for the first picture, and for the first overlay.
[ "$(grep -c "^compiling shaders ...$" stderr.txt)" = 2 ] || fail "not told twice that shaders are compiled"
finish
