// Computes the denoiser's mean over frames: mixes each pixel's samples into the history of the surface that it shows,
// which is found through the camera of the previous frame.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "guide.glsl"

layout(push_constant, std430) uniform olx_accumulate_block { olx_accumulate_constants job; };
layout(set = 0, binding = OLX_BINDING_DENOISE_DEPTH) uniform sampler2D depth_image;
layout(set = 0, binding = OLX_BINDING_DENOISE_NORMAL) uniform sampler2D normal_image;
layout(set = 0, binding = OLX_BINDING_DENOISE_ROUGHNESS) uniform sampler2D roughness_image;
layout(set = 0, binding = OLX_BINDING_GUIDE_BEFORE) uniform usampler2D guide_before;
layout(set = 0, binding = OLX_BINDING_DIFFUSE_BEFORE) uniform sampler2D diffuse_before;
layout(set = 0, binding = OLX_BINDING_GLOSSY_BEFORE) uniform sampler2D glossy_before;
layout(set = 0, binding = OLX_BINDING_GUIDE_NOW, rgba32ui) uniform writeonly uimage2D guide_now;
layout(set = 0, binding = OLX_BINDING_DIFFUSE_NOW, rgba16f) uniform image2D diffuse_now;
layout(set = 0, binding = OLX_BINDING_GLOSSY_NOW, rgba16f) uniform image2D glossy_now;

bool has_flag(uint flag) { return (job.flags & flag) != 0u; }
vec2 frame_size() { return vec2(size_of(job.size)); }

// The accumulated light of both lobes, and the data by which the next frame finds it.
struct memory {
  olx_known diffuse, glossy;
  bool still;
};

void add_tap(inout olx_known sum, inout float weight_sum, olx_incident incident, float count, float weight) {
  if (!(count > 0.0) || !olx_is_sample(incident)) return;
  sum.incident.light += incident.light * weight;
  sum.incident.inverse_distance += incident.inverse_distance * weight;
  sum.count += count * weight;
  weight_sum += weight;
}

olx_known mean_of(olx_known sum, float weight_sum) {
  if (weight_sum < OLX_LEAST_SHARE) return olx_nothing_known();
  return olx_known(olx_incident(sum.incident.light / weight_sum, sum.incident.inverse_distance / weight_sum),
                   sum.count / weight_sum);
}

// Gathers what the four pixels around a place in the previous frame knew of the surface that `now` shows.
memory look_back(olx_shown now, olx_camera_frame camera, vec2 at) {
  olx_known none = olx_known(olx_incident(vec3(0.0), 0.0), 0.0), sums[2] = olx_known[2](none, none);
  vec2 weight_sums = vec2(0.0);
  for (uint corner = 0u; corner < 4u; corner++) {
    float weight = olx_bilinear_weight(at, corner);
    ivec2 tap = ivec2(floor(at)) + ivec2(corner & 1u, corner >> 1);
    if (weight <= 0.0 || any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, ivec2(size_of(job.size))))) continue;
    uvec4 guide = texelFetch(guide_before, tap, 0);
    if (guide_is_empty(guide)) continue;
    if (!olx_same_surface(now, guide_shows(guide, camera, frame_size(), vec2(tap) + shift_of(job.before)))) continue;
    vec2 counts = guide_counts(guide);
    if (has_flag(OLX_DENOISE_DIFFUSE)) {
      add_tap(sums[0], weight_sums.x, incident_of(texelFetch(diffuse_before, tap, 0)), counts.x, weight);
    }
    if (has_flag(OLX_DENOISE_GLOSSY)) {
      add_tap(sums[1], weight_sums.y, incident_of(texelFetch(glossy_before, tap, 0)), counts.y, weight);
    }
  }
  return memory(mean_of(sums[0], weight_sums.x), mean_of(sums[1], weight_sums.y), false);
}

memory remember(ivec2 pixel, olx_shown now) {
  memory past = memory(olx_nothing_known(), olx_nothing_known(), false);
  if (has_flag(OLX_DENOISE_RESTART)) return past;
  olx_camera_frame camera = camera_of(job.before, has_flag(OLX_DENOISE_MIRRORED_BEFORE));
  vec2 seen;
  if (!olx_guide_project(camera, frame_size(), now.position, seen)) return past;
  vec2 at = seen - shift_of(job.before);
  if (any(lessThanEqual(at, vec2(-1.0))) || any(greaterThanEqual(at, frame_size()))) return past;
  past = look_back(now, camera, vec2(olx_settle(at.x), olx_settle(at.y)));
  past.still = olx_stands_still(seen, vec2(pixel) + shift_of(job.now));
  return past;
}

// Returns the depth along the viewing axis; infinite where the pixel shows nothing.
float read_depth(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).r;
  return depth == job.empty_depth ? OLX_INFINITY : job.now.up.w / (depth - job.before.up.w);
}

// Reads what a pixel shows; false where it shows nothing.
bool read_guide(ivec2 pixel, out uvec4 guide) {
  float depth = read_depth(pixel);
  guide = uvec4(floatBitsToUint(OLX_INFINITY), 0u, 0u, 0u);
  if (!olx_finite(vec3(depth))) return false;
  vec3 normal = texelFetch(normal_image, pixel, 0).xyz;
  normal = olx_normalize(has_flag(OLX_DENOISE_NORMAL_UNORM) ? normal * 2.0 - 1.0 : normal);
  guide = pack_guide(depth, normal, vec2(0.0), texelFetch(roughness_image, pixel, 0).r);
  return true;
}

// Returns as how many frames the sample of another pixel counts. If that shows another surface, it counts as nothing:
// the pixel shows it where it finds no light of its own surface. Negative where there is no sample.
float count_of_lender(ivec2 lender, olx_shown now, olx_camera_frame camera) {
  uvec4 guide;
  if (any(greaterThanEqual(uvec2(lender), size_of(job.size))) || !read_guide(lender, guide)) return -1.0;
  olx_shown there = guide_shows(guide, camera, frame_size(), vec2(lender) + shift_of(job.now));
  bool same = olx_same_surface(now, there) && abs(there.roughness - now.roughness) < OLX_ROUGHNESS_RANGE;
  return same ? OLX_BORROWED_COUNT : 0.0;
}

// Mixes the sample of a frame in which the pixel traced into what is known; in other frames, a pixel of which nothing
// is known borrows the sample.
olx_known take_sample(olx_known past, bool traced, float count, olx_incident incident, float largest) {
  if (traced) return olx_mix_sample(past, incident, largest);
  if (past.count > 0.0 || count < 0.0 || !olx_is_sample(incident)) return past;
  return olx_known(incident, count);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), tracer = traced_pixel(job.flags, pixel);
  bool inside = all(lessThan(uvec2(pixel), size_of(job.size))), traced = tracer == pixel;
  float lent = -1.0;
  memory now = memory(olx_nothing_known(), olx_nothing_known(), false);
  uvec4 guide;
  bool seen = inside && read_guide(pixel, guide);
  if (seen) {
    olx_camera_frame camera = camera_of(job.now, has_flag(OLX_DENOISE_MIRRORED));
    olx_shown shown = guide_shows(guide, camera, frame_size(), vec2(pixel) + shift_of(job.now));
    now = remember(pixel, shown);
    if (!traced) lent = count_of_lender(tracer, shown, camera);
  }
  // All pixels of a workgroup, which has whole squares, read samples before any of them writes its mean in their place.
  ivec2 sampled = min(tracer, ivec2(size_of(job.size)) - 1);
  vec4 diffuse_sample = has_flag(OLX_DENOISE_DIFFUSE) ? imageLoad(diffuse_now, sampled) : vec4(vec3(0.0), -1.0);
  vec4 glossy_sample = has_flag(OLX_DENOISE_GLOSSY) ? imageLoad(glossy_now, sampled) : vec4(vec3(0.0), -1.0);
  memoryBarrierImage();
  barrier();
  if (!inside) return;
  if (seen) {
    float largest = now.still ? job.diffuse_still_history : job.diffuse_history;
    now.diffuse = take_sample(now.diffuse, traced, lent, incident_of(diffuse_sample), largest);
    largest = now.still ? job.glossy_still_history : job.glossy_history;
    now.glossy = take_sample(now.glossy, traced, lent, incident_of(glossy_sample), largest);
    guide.z = packHalf2x16(vec2(now.diffuse.count, now.glossy.count));
  }
  imageStore(guide_now, pixel, guide);
  if (has_flag(OLX_DENOISE_DIFFUSE)) imageStore(diffuse_now, pixel, storable(now.diffuse.incident));
  if (has_flag(OLX_DENOISE_GLOSSY)) imageStore(glossy_now, pixel, storable(now.glossy.incident));
}
