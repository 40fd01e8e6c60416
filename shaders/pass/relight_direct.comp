// Direct light with shadows of surfaces and texels: a few rays of each place a dispatch, added to what the dispatches
// before have found (relight_begin.comp first).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_texel.glsl"
#include "../lib/trace.glsl"

const uint SALT_SURFACE = 0x53555246u, SALT_LIGHT = 0x524C4954u;

olx_gpu_light read_light(uint index) {
  uint at = relight.lights + 1u + OLX_LIGHT_WORDS * index;
  return olx_gpu_light(vec4(state_vector(at), 0.0), vec4(state_vector(at + 4u), 0.0), vec4(state_vector(at + 8u), 0.0),
                       vec4(state_vector(at + 12u), 0.0), state[at + 16u], state[at + 17u],
                       uintBitsToFloat(state[at + 18u]), uintBitsToFloat(state[at + 19u]));
}

// A place to be lit, and where its light is kept. Random numbers are stratified over sixteen neighbours.
struct lit_place {
  olx_surface_view view;
  uint seed, sequence;
  uint fixed_light, varying_light; // words of `places`
  uint flags;                      // OLX_JOB_*
  uint rounds;
};

lit_place surface_place(uint at) {
  relight_job job = read_job(relight.jobs, gl_WorkGroupID.y);
  uint i = olx_block_texel(at / 4u, at % 4u, 2u, relight.size), offset = 3u * (surfaces_a_probe() * job.probe + i);
  return lit_place(view_surface(job, i), olx_hash3(job.probe, at / 16u, SALT_SURFACE), at % 16u + 16u * job.rounds,
                   relight.fixed_light + offset, relight.varying_light + offset, job.flags, job.rounds);
}

lit_place texel_place(uint at) {
  uint slot = gl_WorkGroupID.y, side = relight.tile_side, texels = side * side;
  relight_job job = read_job(relight.tiles, slot);
  uint i = olx_block_texel(at / 16u, at % 16u, 4u, side), light = relight.tile_light + 3u * (texels * slot + i);
  return lit_place(view_texel(job, tile_texel(job, i)),
                   olx_hash3(job.probe, job.tile * texels + at / 16u, SALT_SURFACE + 1u), at % 16u, light, light,
                   OLX_JOB_FIXED | OLX_JOB_VARYING, 0u);
}

// Irradiance by one ray. A ray that no probe can follow to its end has gone behind something.
vec3 light_along(lit_place p, olx_gpu_light light, uint index, uint sample_index) {
  vec2 random = vec2(0.0);
  if (olx_light_varies(light)) {
    random = olx_stratified2(p.sequence * relight.light_samples + sample_index, olx_hash3(p.seed, index, SALT_LIGHT));
  }
  olx_light_ray ray;
  if (!olx_aim(light, p.view.place, p.view.normal, random, ray)) return vec3(0.0);
  olx_trace_hit hit = olx_trace(olx_sample_settings_default(), p.view.place, ray.direction, ray.length_metres);
  return hit.status == OLX_TRACE_MISS ? ray.irradiance : vec3(0.0);
}

// Lights without an area take one ray of theirs.
void light_place(lit_place p) {
  uint samples = relight.light_samples, end = min(call.end_ray, samples * state[relight.lights]);
  vec3 fixed_sum = vec3(0.0), varying_sum = vec3(0.0);
  for (uint i = call.first_ray; i < end; i++) {
    olx_gpu_light light = read_light(i / samples);
    bool varies = olx_light_varies(light);
    if ((p.flags & (varies ? OLX_JOB_VARYING : OLX_JOB_FIXED)) == 0u || (!varies && i % samples != 0u)) continue;
    vec3 found = light_along(p, light, i / samples, i % samples);
    if (varies) varying_sum += found;
    else fixed_sum += found;
  }
  set_places(p.fixed_light, places_vector(p.fixed_light) + fixed_sum);
  varying_sum *= 1.0 / float(samples * (p.rounds + 1u));
  set_places(p.varying_light, places_vector(p.varying_light) + varying_sum);
}

void main() {
  uint at = gl_GlobalInvocationID.x;
  bool texels = call.kind == OLX_RELIGHT_TEXELS;
  if (at >= (texels ? relight.tile_side * relight.tile_side : surfaces_a_probe())) return;
  lit_place p;
  if (texels) p = texel_place(at);
  else p = surface_place(at);
  if (p.view.distance_metres < OLX_INFINITY) light_place(p);
}
