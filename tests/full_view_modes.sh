# The viewer without a window on Mesa's CPU device, under the validation layers: every mode and overlay, the layers, and
# moving objects.
source "$(dirname "$0")/cli/viewer.sh"
validate=
"$OCTALUX" "${view[@]}" --offscreen --frames 1 --validate >stdout.txt 2>stderr.txt && validate=--validate

# The script shows all modes and overlays one after the other, the layers, and moving objects.
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
expect 0 "${view[@]}" --offscreen --script all.txt --gather-samples 2 $validate
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

finish
