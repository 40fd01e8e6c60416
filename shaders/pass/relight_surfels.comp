// One more sample of direct light for surfels whose turn it is, each at another of its points, into a running mean.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_rays.glsl"

const uint SALT_SURFEL = 0x53464C52u, SURFEL_WORDS = 26u;

vec3 structure_vector(uint at) { return uintBitsToFloat(uvec3(structure[at], structure[at + 1u], structure[at + 2u])); }

void main() {
  uint thread = thread_index();
  if (thread >= call.count) return;
  uint surfel = surfel_of(thread), round = call.round + (thread < call.before ? 0u : 1u), at = SURFEL_WORDS * surfel;
  lit_place p = lit_place(structure_vector(at + 3u * (round % OLX_RELIGHT_POINTS)),
                          olx_normal_unpack(structure[at + 3u * OLX_RELIGHT_POINTS] & 0xFFFFu),
                          olx_hash2(surfel, SALT_SURFEL), round);
  vec3 found = add_up(relight.values + 3u * surfel, light_place(p)); // values are found again before they are read
  if (!ends()) return;
  uint direct = relight.direct + 3u * surfel;
  vec3 before = state_vector(direct);
  set_state(direct, before + (found - before) * (1.0 / float(round + 1u)));
}
