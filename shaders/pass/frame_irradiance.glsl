// Computes irradiance at the surface that a pixel shows, and finds that surface's normals.
#ifndef OLX_FRAME_IRRADIANCE_GLSL
#define OLX_FRAME_IRRADIANCE_GLSL

#include "frame.glsl"

// The least cosine between a derived normal and the shading normal, and between successive steps from pixel to pixel,
// with which they are trusted.
const float LEAST_DERIVED_COSINE = 0.5, LEAST_STRAIGHTNESS = 0.98;

// Returns the step from a pixel's position to that of the next one along an axis, before or behind it. A step is valid
// when it continues straight to the pixel after the next, so that it stays on one surface; of two valid steps, the one
// nearer to perpendicular to the shading normal is on the pixel's own surface. 0 where neither is valid.
vec3 step_along(ivec2 pixel, ivec2 axis, frame_surface surface) {
  float least = 1.0;
  vec3 way = vec3(0.0);
  for (int side = -1; side <= 1; side += 2) {
    ivec2 near = pixel + axis * side, far = near + axis * side;
    if (any(lessThan(far, ivec2(0))) || any(greaterThanEqual(far, ivec2(frame.width, frame.height)))) continue;
    float near_depth = texelFetch(depth_image, near, 0).r, far_depth = texelFetch(depth_image, far, 0).r;
    if (near_depth == frame.eye.w || far_depth == frame.eye.w) continue;
    vec3 beside = position_at(near, near_depth), first = beside - surface.position;
    vec3 along = olx_normalize(first), after = olx_normalize(position_at(far, far_depth) - beside);
    float rise = abs(olx_dot(along, surface.normal));
    if (olx_dot(along, after) < LEAST_STRAIGHTNESS || rise >= least) continue;
    least = rise;
    way = first * float(side);
  }
  return way;
}

// Returns the geometric normal derived from the depths around a pixel, or the shading normal where they do not give
// one.
vec3 derived_normal(ivec2 pixel, frame_surface surface) {
  vec3 across = cross(step_along(pixel, ivec2(1, 0), surface), step_along(pixel, ivec2(0, 1), surface));
  float size = sqrt(olx_dot(across, across)), cosine = olx_dot(across, surface.normal);
  return abs(cosine) > LEAST_DERIVED_COSINE * size ? across * (sign(cosine) / size) : surface.normal;
}

// Returns the geometric normal of the pixel's surface, on the side towards the eye.
vec3 geometric_normal(ivec2 pixel, frame_surface surface) {
  if (!has_flag(OLX_FRAME_GEOMETRIC_NORMAL)) return derived_normal(pixel, surface);
  vec3 normal = read_normal(geometric_normal_image, pixel, OLX_FRAME_GEOMETRIC_UNORM);
  return olx_dot(normal, surface.view) < 0.0 ? -normal : normal;
}

// Returns the sources of the pixel's light: OLX_SOURCE_*.
uint sources_of(ivec2 pixel) {
  bool dynamic = has_flag(OLX_FRAME_DYNAMIC) && texelFetch(dynamic_image, pixel, 0).r > 0.5;
  uint sources = olx_volume_source() | (dynamic ? 0u : OLX_SOURCE_TEXELS);
  return has_flag(OLX_FRAME_IRRADIANCE_PROBES) ? OLX_SOURCE_PROBES : sources;
}

// What the first of a pixel's two rounds leaves to the second.
struct irradiance_state {
  vec3 geometric; // normal
  olx_surface_light light;
  bool stored;
};

irradiance_state begin_irradiance() {
  return irradiance_state(vec3(0.0), olx_surface_light(vec3(0.0), 0u), false);
}

// Computes irradiance at the surface of a pixel in two rounds of one loop of the pass, which reads the surface again
// for the second, so that its normals are not kept while probes are searched. The first round looks up stored light.
void look_up_irradiance(ivec2 pixel, frame_surface surface, inout irradiance_state state) {
  olx_sample_settings settings = frame_settings();
  settings.select = has_flag(OLX_FRAME_RANK_ALL) ? OLX_SELECT_EXHAUSTIVE : OLX_SELECT_BEST;
  uint sources = sources_of(pixel);
  state.geometric = surface.normal;
  if ((sources & OLX_SOURCE_TEXELS) != 0u) state.geometric = geometric_normal(pixel, surface);
  state.light = olx_stored_light(settings, sources, surface.position, state.geometric, state.stored);
}

// The second round completes the light.
void complete_irradiance(ivec2 pixel, frame_surface surface, inout irradiance_state state) {
  vec3 vertex = surface.normal;
  if (has_flag(OLX_FRAME_VERTEX_NORMAL)) vertex = read_normal(vertex_normal_image, pixel, OLX_FRAME_VERTEX_UNORM);
  state.light = olx_complete_light(frame_settings(), sources_of(pixel), state.light, state.stored, surface.position,
                                   state.geometric, vertex, surface.normal, surface.view);
}

#endif
