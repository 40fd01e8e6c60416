// Adds one sample of direct light to the mean of each surfel whose turn it is; each sample is at another of the
// surfel's points.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_rays.glsl"

// Adds a sample to the stored mean of `round` earlier samples.
void add_sample(uint at, vec3 found, uint round) {
  vec3 before = state_vector(at);
  set_state(at, before + (found - before) * (1.0 / float(round + 1u)));
}

// Adds a part of a sample, whose rays come in several dispatches, to the stored mean of `round` earlier samples.
void add_part(uint at, vec3 found, uint round) {
  float share = 1.0 / float(round + 1u);
  vec3 before = state_vector(at);
  if ((call.flags & OLX_CALL_BEGINS) != 0u) before *= 1.0 - share;
  set_state(at, before + found * share);
}

void main() {
  uint thread = thread_index();
  if (thread >= call.count) return;
  uint surfel = surfel_of(thread), round = call.round + (thread < call.before ? 0u : 1u);
  lit_place p = lit_place(surfel_point(surfel, round % OLX_RELIGHT_POINTS), surfel_normal(surfel),
                          olx_hash2(surfel, OLX_SALT_SURFEL), round);
  lit_sum found = light_place(p);
  vec3 irradiance = add_up(relight.values + 3u * surfel, found.irradiance); // values are recomputed before being read
  vec3 beam = add_up(relight.beam_sums + 3u * surfel, found.beam);
  add_part(relight.close + 3u * surfel, found.close, round);
  add_part(relight.near + 3u * surfel, found.near, round);
  if (!ends()) return;
  add_sample(relight.direct + 3u * surfel, irradiance, round);
  add_sample(relight.beams + 3u * surfel, beam, round);
}
