# The modes of `render`: gathered, denoised and prefiltered light, frames, motion and cuts.
source "$(dirname "$0")/cli/expect.sh"
scene=builtin:two-rooms-gap
field=(--method field --field a.olx --size 48x36)
expect 0 bake $scene -o a.olx --grid 2x2x2 --radiance-size 64 --irradiance-size 16 --bounces 0 --noise 0.1

for mode in gather denoised prefiltered; do expect 0 render $scene -o $mode.exr "${field[@]}" --mode $mode; done
expect 0 render $scene -o plain.exr "${field[@]}"
cmp plain.exr prefiltered.exr || fail "prefiltered light is not the default"
expect 0 render $scene -o gather2.exr "${field[@]}" --spp 1 --diffuse traced --diffuse-samples 64 --glossy-samples 64
cmp gather.exr gather2.exr || fail "--mode gather is more than its rays"
expect_json 'o["layers"]["indirect_diffuse"]["relative_mse"] < 0.05' compare denoised.exr gather.exr

expect_json 'o["passes"]["denoise"] > 0' render $scene -o f.exr "${field[@]}" --mode prefiltered --frames 4
expect 0 render $scene -o f1.exr "${field[@]}" --mode denoised --frames 4 --threads 1
expect 0 render $scene -o f2.exr "${field[@]}" --mode denoised --frames 4 --threads 3
cmp f1.exr f2.exr || fail "frames depend on the number of threads"
for filter in none published adaptive; do
  expect 0 render $scene -o $filter.exr "${field[@]}" --mode denoised --frames 4 --denoise $filter
done
cmp adaptive.exr f1.exr || fail "adaptive filters are not the default"
cmp -s adaptive.exr published.exr && fail "published filters do what adaptive ones do"
cmp -s none.exr published.exr && fail "published filters do nothing"

expect_json 'o["passes"]["indirect_glossy"] > 0' render $scene -o turns.exr "${field[@]}" --mode denoised --frames 64 --ray-spacing 2
expect_json 'o["layers"]["indirect_diffuse"]["relative_mse"] < 0.05' compare turns.exr gather.exr
expect 0 render $scene -o turn.exr "${field[@]}" --mode denoised --frames 4 --ray-spacing 1
cmp turn.exr f1.exr || fail "--ray-spacing 1 is not the default"

expect 0 render $scene -o glide.exr "${field[@]}" --mode denoised --frames 6 --camera dark --from-camera lit
expect 0 render $scene -o cut.exr "${field[@]}" --mode denoised --frames 6 --camera dark --from-camera lit --cut 2
expect 0 render $scene -o stay.exr "${field[@]}" --mode denoised --frames 6 --camera dark
for other in glide cut; do
  expect_json 'o["layers"]["depth"]["mse"] == 0' compare $other.exr stay.exr --layer depth
  cmp -s $other.exr stay.exr && fail "a $other is no different from staying"
done

expect 0 render $scene -o emitters.exr "${field[@]}" --mode gather --emitters traced
expect_json 'o["layers"]["direct"]["bias"] < -0.5' compare emitters.exr gather.exr --layer direct
expect 0 render $scene -o dim.exr "${field[@]}" --mode prefiltered --dim-lobe 0.5
expect 0 render $scene -o centered.exr --method path --size 48x36 --spp 2 --centered

expect_usage "is not one of gather|denoised|prefiltered" render $scene -o a.exr "${field[@]}" --mode best
expect_usage "\-\-frames goes with" render $scene -o a.exr "${field[@]}" --mode gather --frames 3
expect_usage "\-\-frames goes with" render $scene -o a.exr --method path --frames 3
expect_usage "\-\-gather-samples goes with" render $scene -o a.exr "${field[@]}" --gather-samples 3
expect_usage "\-\-ray-spacing goes with" render $scene -o a.exr "${field[@]}" --ray-spacing 2
expect_usage "\-\-ray-spacing" render $scene -o a.exr "${field[@]}" --frames 3 --ray-spacing 3
expect_usage "\-\-from-camera goes with" render $scene -o a.exr "${field[@]}" --from-camera lit
expect_usage "\-\-cut goes with" render $scene -o a.exr "${field[@]}" --mode denoised --frames 3 --cut 1
expect_usage "less than --frames" render $scene -o a.exr "${field[@]}" --frames 3 --from-camera lit --cut 3
expect_usage "needs traced diffuse light" render $scene -o a.exr "${field[@]}" --mode prefiltered --emitters traced
expect_usage "needs traced diffuse light" render $scene -o a.exr "${field[@]}" --diffuse surface --emitters traced
expect_usage "go with --method field" render $scene -o a.exr --method path --mode denoised
expect_usage "go with --method field" render $scene -o a.exr --mode gather
expect_failure "no camera named \"x\"" render $scene -o a.exr "${field[@]}" --frames 3 --from-camera x
finish
