# The viewer on Mesa's CPU device, without a window and under Xvfb: a picture, fields without probe light, flying,
# resizing, screenshots. full_view_modes.sh shows every mode and overlay; full_view.sh tests failures and moving lights.
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
# time, so few runs show many things.
cat >one.txt <<'SCRIPT'
screenshot one.png
press O
press O
screenshot radiance.png
press O
press O
press O
screenshot answer.png
press O
press O
press O
pick 40 60
screenshot map.png
quit
SCRIPT
expect 0 "${view[@]}" --offscreen --script one.txt
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
SCRIPT
expect 0 "${plain[@]}" --script plain.txt --screenshot last.png # one more frame after the script
check 'p[0].width == 96 and p[0].height == 80 and not uniform(p[0]) and mean(p[0]) > 10' one.png
for other in cpu without; do
  check 'differing(p[0], p[1]) < 0.3 and abs(mean(p[0]) / mean(p[1]) - 1) < 0.1' one.png $other.png
done
for overlay in radiance answer map; do
  check 'abs(mean(p[0]) / mean(p[1]) - 1) < 0.15' $overlay-without.png $overlay.png
done
check 'p[0].width == 96 and differing(p[0], p[1]) < 0.01' last.png map-without.png
for wrong in "--overlay irradiance" "--overlay weights" "--hits stored"; do
  expect_failure "bake --probe-light" "${plain[@]}" --screenshot refused.png $wrong
done

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
expect 0 "${view[@]}" --script window.txt --frames 100 --screenshot left.png
check 'not uniform(p[0]) and mean(p[0]) > 10 and p[0].width == 96' flown.png
check 'not uniform(p[0]) and mean(p[0]) > 10 and p[0].width == 200 and p[0].height == 150' larger.png
check 'not uniform(p[0]) and p[0].width == 120' octalux-001.png
[ -e after.png ] && fail "escape did not leave"
check 'not uniform(p[0]) and p[0].width == 120' left.png # the last frame, though not the hundredth
# Shaders are compiled for the first picture, and for the first overlay.
[ "$(grep -c "^compiling shaders ...$" stderr.txt)" = 2 ] || fail "not told twice that shaders are compiled"
printf 'resize 0x0\nscreenshot nothing.png\n' >hidden.txt
expect_failure "nothing.png: the frame has no pixels" "${view[@]}" --script hidden.txt --frames 3
[ -e nothing.png ] && fail "a picture of no pixels"
finish
