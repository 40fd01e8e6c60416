// Twin of src/render/denoise.c: the parts of the separated denoiser of McGuire et al. 2017, section 5.1, that read no
// images. shaders/pass has the loops over pixels.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_DENOISE_GLSL
#define OLX_DENOISE_GLSL

#include "vec.glsl"

// The axes of a camera: right and up lead from the middle of the image plane at distance 1 to its edges.
struct olx_camera_frame {
  vec3 eye, forward, right, up;
};

// The light that arrives at a surface, and 1 / distance to its source; negative where the pixel has no light of this
// kind.
struct olx_incident {
  vec3 light;
  float inverse_distance;
};

// The accumulated light of a surface point: the mean of `count` frames.
struct olx_known {
  olx_incident incident;
  float count;
};

// The surface that a pixel shows.
struct olx_shown {
  vec3 position, normal;
  float depth, roughness;
  float pixel_angle; // width of a pixel at depth 1
};

// The quantities at a pixel from which the weights of its neighbours follow.
struct olx_scales {
  float inverse_distance; // 0 where the pixel has no light
  float narrowing;        // scales kernels like the noise, which falls with the square root of the number of frames
  bool known;             // whether the pixel has light
};

olx_known olx_nothing_known() { return olx_known(olx_incident(vec3(0.0), -1.0), 0.0); }

// ---- Positions of pixels

// Returns the surface point that a pixel shows at a depth along the viewing axis. `size` is the picture's, in pixels.
vec3 olx_guide_position(olx_camera_frame c, vec2 size, vec2 pixel, float depth) {
  float across = 2.0 * (pixel.x + 0.5) / size.x - 1.0, up = 1.0 - 2.0 * (pixel.y + 0.5) / size.y;
  return c.eye + (c.forward + c.right * across + c.up * up) * depth;
}

// Finds the pixel at which a point is seen, with pixel centres at whole numbers; false behind the camera.
bool olx_guide_project(olx_camera_frame c, vec2 size, vec3 position, out vec2 pixel) {
  vec3 offset = position - c.eye;
  float depth = olx_dot(offset, c.forward);
  pixel = vec2(0.0);
  if (!(depth > 0.0)) return false;
  float across = olx_dot(offset, c.right) / (olx_dot(c.right, c.right) * depth);
  float up = olx_dot(offset, c.up) / (olx_dot(c.up, c.up) * depth);
  pixel = 0.5 * vec2(across + 1.0, 1.0 - up) * size - 0.5;
  return true;
}

float olx_pixel_angle(olx_camera_frame c, vec2 size) { return 2.0 * sqrt(olx_dot(c.up, c.up)) / size.y; }

// Returns how well a point fits the plane through another: 1 on it, 0 where it belongs to another surface.
float olx_plane_fit(vec3 offset, vec3 normal, float pixel_metres) {
  float tolerance = OLX_PLANE_PIXELS * pixel_metres + OLX_PLANE_SLOPE * sqrt(olx_dot(offset, offset));
  return max(0.0, 1.0 - abs(olx_dot(offset, normal)) / tolerance);
}

bool olx_is_sample(olx_incident incident) {
  return incident.inverse_distance >= 0.0 && olx_finite(vec3(incident.inverse_distance)) && olx_finite(incident.light);
}

// ---- History

// Returns whether a pixel of the previous frame showed the surface that `now` shows.
bool olx_same_surface(olx_shown now, olx_shown before) {
  if (!(olx_dot(before.normal, now.normal) > OLX_SAME_NORMAL)) return false;
  return olx_plane_fit(before.position - now.position, now.normal, now.depth * now.pixel_angle) > 0.0;
}

// Moves a place in the previous frame to a pixel's centre when it is nearly there.
float olx_settle(float at) {
  float nearest = floor(at + 0.5);
  return abs(at - nearest) < OLX_STILL_PIXELS ? nearest : at;
}

bool olx_stands_still(vec2 at, vec2 pixel) {
  return abs(at.x - pixel.x) < OLX_STILL_PIXELS && abs(at.y - pixel.y) < OLX_STILL_PIXELS;
}

// Returns the bilinear weight of one of the four pixels around a place, `corner` 0 to 3 from the top left.
float olx_bilinear_weight(vec2 at, uint corner) {
  float right = at.x - floor(at.x), bottom = at.y - floor(at.y);
  return ((corner & 1u) != 0u ? right : 1.0 - right) * ((corner >> 1) != 0u ? bottom : 1.0 - bottom);
}

// Mixes a frame's sample into the accumulated light, which it replaces where that is borrowed. History has the weight
// 1 - 1/n, and n stops growing where that reaches `largest`.
olx_known olx_mix_sample(olx_known past, olx_incident incident, float largest) {
  if (!olx_is_sample(incident)) return past;
  if (past.count < OLX_OWN_COUNT) past = olx_nothing_known();
  float n = min(past.count + 1.0, 1.0 / (1.0 - largest)), share = 1.0 / n;
  olx_known result = olx_known(incident, n);
  if (share >= 1.0) return result;
  result.incident.light = past.incident.light + (incident.light - past.incident.light) * share;
  result.incident.inverse_distance =
      past.incident.inverse_distance + (incident.inverse_distance - past.incident.inverse_distance) * share;
  return result;
}

// ---- Spatial filter

olx_scales olx_scales_of(olx_incident incident, float count) {
  if (!olx_is_sample(incident) || !(count > 0.0)) return olx_scales(0.0, 1.0, false);
  return olx_scales(incident.inverse_distance, 1.0 / sqrt(count), true);
}

float olx_gaussian(float squared_over_variance) { return exp(-0.5 * squared_over_variance); }

// Returns the weight of a neighbouring pixel by distance. Diffuse light varies over the distance to its source, glossy
// light over the width of the lobe there. `nearness` is the mean inverse distance of the two pixels, and `metres` and
// `pixels` are the distances between them.
float olx_reach_weight(bool glossy, float reach, olx_shown middle, float nearness, float metres, float pixels) {
  if (!glossy) return olx_gaussian(olx_square(metres * nearness / reach));
  float alpha = olx_square(middle.roughness);
  float sigma_pixels = reach * alpha / (middle.pixel_angle * (1.0 + middle.depth * nearness));
  return pixels > 0.0 ? olx_gaussian(olx_square(pixels / max(sigma_pixels, 1e-3))) : 1.0;
}

// Returns the weight that the middle pixel gives to the light at `tap`. With `reach` 0, the radius alone limits the
// filter.
float olx_tap_weight(bool glossy, float radius_pixels, float reach, olx_shown middle, olx_scales here, olx_shown tap,
                     float tap_inverse_distance, float pixels) {
  float cosine = max(0.0, olx_dot(tap.normal, middle.normal));
  vec3 offset = tap.position - middle.position;
  float sigma = 0.5 * max(radius_pixels, 1.0);
  float weight = olx_gaussian(olx_square(pixels / sigma)) *
                 olx_plane_fit(offset, middle.normal, middle.depth * middle.pixel_angle) *
                 olx_square(olx_square(olx_square(cosine)));
  if (weight <= 0.0) return 0.0;
  if (glossy) weight *= max(0.0, 1.0 - abs(tap.roughness - middle.roughness) / OLX_ROUGHNESS_RANGE);
  if (reach > 0.0) {
    float nearness = 0.5 * (here.inverse_distance + max(tap_inverse_distance, 0.0));
    float reached =
        olx_reach_weight(glossy, reach * here.narrowing, middle, nearness, sqrt(olx_dot(offset, offset)), pixels);
    // However sharp its light is, a pixel without light takes that of the next pixels of its surface, not none.
    weight *= here.known ? reached : max(reached, olx_gaussian(olx_square(pixels)));
  }
  return weight;
}

#endif
