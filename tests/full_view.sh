# The viewer on Mesa's CPU device: moving lights, and failures, which are reported and leave no files behind.
source "$(dirname "$0")/cli/viewer.sh"
validate=
"$OCTALUX" "${view[@]}" --offscreen --frames 1 --validate >stdout.txt 2>stderr.txt && validate=--validate

# Without octalux-view beside it, the command says that the viewer is missing.
cp "$program" alone
"./alone" view builtin:cornell --field a.olx >stdout.txt 2>stderr.txt && fail "a viewer that is not there ran"
grep -q "octalux-view is not there" stderr.txt || fail "no word of the missing viewer"

expect 0 "${view[@]}" --offscreen --screenshot one.png $validate

# Automatic exposure brightens a picture that a twentieth of the light would leave dark.
expect 0 "${view[@]}" --offscreen --frames 2 --exposure 0.05 --auto-exposure --screenshot followed.png
check 'mean(p[0]) > 1.2 * mean(p[1])' followed.png one.png

# In a field without probe light, the key skips the overlays that need it.
"$OCTALUX" bake builtin:cornell-glossy -o plain.olx --radiance-size 64 --bounces 1 --noise 0.3 >stdout.txt 2>stderr.txt
plain=(view builtin:cornell-glossy --field plain.olx --size 96x80 --offscreen)
printf 'press %s\n' O O O >skip.txt
echo "screenshot skipped.png" >>skip.txt
printf 'press %s\n' Y Y Y >told.txt # keys that do nothing, for as many frames
echo "screenshot told.png" >>told.txt
expect 0 "${plain[@]}" --script skip.txt $validate
expect 0 "${plain[@]}" --overlay answer --script told.txt
check 'differing(p[0], p[1]) == 0' skipped.png told.png

# When lights move, indirect light follows them or stays as baked, and the same script gives the same pictures.
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

# Errors are reported with their reasons and leave no picture behind.
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

fault version:1:0 expect_failure "no Vulkan 1.2 device" "${view[@]}" --offscreen --frames 1
fault submit:1:$lost expect_failure "lost" "${view[@]}" --offscreen --frames 3
fault submit:14:$lost expect_failure "lost" "${view[@]}" --offscreen --frames 20
# These numbers of allocations fall on the field, the lamps and the panel's letters.
for number in 3 21 35; do
  fault memory:$number:$out_of_memory expect_failure "memory\|letters" "${view[@]}" --offscreen --frames 1
done

start_display
# Relighting runs on a thread of its own while pictures are drawn.
expect 0 view lit.json --field lit.olx --size 64x48 --relight --frames 12 --screenshot beside.png $validate
check 'not uniform(p[0]) and mean(p[0]) > 10' beside.png
fault acquire:2:$out_of_date expect 0 "${view[@]}" --frames 4 --screenshot again.png
check 'not uniform(p[0]) and mean(p[0]) > 10' again.png
fault acquire:2:$surface_lost expect_failure "window" "${view[@]}" --frames 4
finish
