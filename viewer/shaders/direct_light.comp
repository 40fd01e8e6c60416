#version 460
#extension GL_GOOGLE_include_directive : require
#include <shaders/lib/bsdf.glsl>
// Adds the lamps' light with shadows to the image, and the environment where no surface is.

layout(local_size_x = 8, local_size_y = 8) in;

struct lamp {
  vec3 position;
  uint kind;
  vec3 direction;
  float extent;
  vec3 emission;
  uint first_view;
  float cosine_inner, cosine_outer;
  uint tiles; // per side; 0: one perspective view
  uint both_sides;
};

struct lamp_view {
  mat4 world_to_clip;
  float texel, unused0, unused1, unused2;
};

const uint LAMP_DISTANT = 0u, LAMP_POINT = 1u, LAMP_SPOT = 2u, LAMP_SURFACE = 3u;
const uint DIRECT_LAMPS = 1u, DIRECT_SKY = 2u, DIRECT_WITHOUT_EXTENT = 4u;
const float PI = 3.14159265, LARGEST_HALF = 65504.0;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1) uniform sampler2D normals;
layout(set = 0, binding = 2) uniform sampler2D albedos;
layout(set = 0, binding = 3) uniform sampler2D surfaces;
layout(set = 0, binding = 4, rgba16f) uniform image2D color;
layout(set = 0, binding = 5, std430) readonly buffer lamp_buffer { lamp lamps[]; };
layout(set = 0, binding = 6, std430) readonly buffer view_buffer { lamp_view views[]; };
layout(set = 0, binding = 7) uniform sampler2DArrayShadow shadow_maps;
layout(set = 0, binding = 8) uniform sampler2D sky;
layout(set = 0, binding = 9, std430) readonly buffer environment_buffer {
  vec3 sky_radiance;
  float sky_rotation;
  uint sky_has_image, lamp_count;
};

layout(push_constant) uniform constants {
  mat4 clip_to_world;
  vec3 eye;
  uint add;
  uint width, height;
};

// ---- The sky

vec3 sky_texel(ivec2 p, ivec2 size) {
  return texelFetch(sky, ivec2((p.x + size.x) % size.x, clamp(p.y, 0, size.y - 1)), 0).rgb;
}

vec3 environment(vec3 direction) {
  if (sky_has_image == 0u) return sky_radiance;
  ivec2 size = textureSize(sky, 0);
  float u = fract((atan(direction.z, direction.x) + sky_rotation) * (0.5 / PI) + 0.5);
  vec2 p = vec2(u, atan(length(direction.xz), direction.y) / PI) * vec2(size) - 0.5;
  ivec2 low = ivec2(floor(p));
  vec2 t = p - vec2(low);
  vec3 upper = mix(sky_texel(low, size), sky_texel(low + ivec2(1, 0), size), t.x);
  vec3 lower = mix(sky_texel(low + ivec2(0, 1), size), sky_texel(low + ivec2(1, 1), size), t.x);
  return sky_radiance * mix(upper, lower, t.y);
}

// ---- Shadows

uint cube_face(vec3 v) {
  vec3 a = abs(v);
  if (a.x >= a.y && a.x >= a.z) return v.x > 0.0 ? 0u : 1u;
  if (a.y >= a.z) return v.y > 0.0 ? 2u : 3u;
  return v.z > 0.0 ? 4u : 5u;
}

// Returns the view of a distant lamp that covers a point: the nearest of its tiles.
uint tile_of(lamp l, vec3 point) {
  uint found = 0u;
  float nearest = 1e30;
  for (uint i = 0u; i < l.tiles * l.tiles; i++) {
    vec2 c = abs((views[l.first_view + i].world_to_clip * vec4(point, 1.0)).xy);
    float away = max(c.x, c.y);
    if (away < nearest) {
      nearest = away;
      found = i;
    }
  }
  return found;
}

uint view_of(lamp l, vec3 point) {
  if (l.kind == LAMP_DISTANT) return l.first_view + (l.tiles > 1u ? tile_of(l, point) : 0u);
  if (l.tiles == 0u) return l.first_view;
  return l.first_view + cube_face(point - l.position);
}

float read_map(uint view, vec2 uv, float depth) { return texture(shadow_maps, vec4(uv, float(view), depth)); }

// Returns the visible share of a lamp from a point. The point is offset from its surface by about a texel; lamps
// without width are filtered over 3 x 3 texels.
float visible(lamp l, vec3 point, vec3 normal, vec3 to_lamp, float distance) {
  uint view = view_of(l, point);
  float texel = views[view].texel * (l.kind == LAMP_DISTANT ? 1.0 : distance);
  float sine = sqrt(max(1.0 - pow(dot(normal, to_lamp), 2.0), 0.0));
  vec3 moved = point + normal * (texel * (0.5 + 1.5 * sine));
  vec4 clip = views[view].world_to_clip * vec4(moved, 1.0);
  if (clip.w <= 0.0) return 1.0;
  vec2 uv = clip.xy / clip.w * 0.5 + 0.5;
  float depth = clip.z / clip.w;
  if (l.kind != LAMP_DISTANT) depth *= 1.001;
  if (l.extent > 0.0) return read_map(view, uv, depth);
  vec2 step = 1.0 / vec2(textureSize(shadow_maps, 0).xy);
  float sum = 0.0;
  for (int y = -1; y <= 1; y++) {
    for (int x = -1; x <= 1; x++) sum += read_map(view, uv + vec2(x, y) * step, depth);
  }
  return sum / 9.0;
}

// ---- Light

struct arrival {
  vec3 direction; // towards the lamp
  vec3 irradiance; // on a surface that faces the lamp
  float distance;
  float sine; // sine of the half angle that the lamp subtends
};

float cone(lamp l, vec3 to_lamp) {
  float t = clamp((-dot(to_lamp, l.direction) - l.cosine_outer) / max(l.cosine_inner - l.cosine_outer, 1e-6), 0.0, 1.0);
  return t * t;
}

arrival arrive(lamp l, vec3 point) {
  if (l.kind == LAMP_DISTANT) return arrival(-l.direction, l.emission, 1e30, l.extent);
  vec3 way = l.position - point;
  float square = dot(way, way), distance = sqrt(square);
  arrival a = arrival(way / distance, l.emission / square, distance, 0.0);
  if (l.kind == LAMP_SPOT) a.irradiance *= cone(l, a.direction);
  if (l.kind == LAMP_SURFACE) {
    // The falloff of a disc's light along its axis, which stays finite at the disc.
    float cosine = -dot(a.direction, l.direction), spread = square + l.extent * l.extent;
    a.irradiance = l.emission * (l.both_sides != 0u ? abs(cosine) : max(cosine, 0.0)) / spread;
    a.sine = l.extent * inversesqrt(spread);
  }
  return a;
}

// Returns GGX times the cosine at the light, like src/core/bsdf.h; view and light in the shading frame.
vec3 specular(olx_bsdf b, float alpha, vec3 view, vec3 light) {
  if (view.z <= 0.0 || light.z <= 0.0) return vec3(0.0);
  vec3 half_way = normalize(view + light);
  float a2 = alpha * alpha, d = dot(half_way.xy, half_way.xy) + half_way.z * half_way.z * a2;
  float g = 1.0 / (1.0 + olx_ggx_lambda(alpha, view.z) + olx_ggx_lambda(alpha, light.z));
  return olx_fresnel(b, dot(view, half_way)) * (a2 / (PI * d * d) * g / (4.0 * view.z));
}

vec3 reflect_light(olx_bsdf bsdf, vec3 normal, vec3 view, arrival a) {
  // A highlight has the combined width of the lobe and the lamp.
  float alpha = min(bsdf.alpha + 0.5 * a.sine, 1.0);
  vec3 tangent = normalize(abs(normal.z) < 0.9 ? cross(normal, vec3(0, 0, 1)) : cross(normal, vec3(1, 0, 0)));
  mat3 frame = mat3(tangent, cross(normal, tangent), normal);
  vec3 v = view * frame, light = a.direction * frame;
  vec3 reflected = olx_bsdf_diffuse(bsdf, v.z) * (light.z / PI);
  if (bsdf.f90 > 0.0 && alpha > 0.0) reflected += specular(bsdf, alpha, v, light);
  return reflected * a.irradiance;
}

vec3 direct_light(ivec2 pixel, vec3 position) {
  vec3 normal = normalize(texelFetch(normals, pixel, 0).xyz), view = normalize(eye - position);
  vec3 surface = texelFetch(surfaces, pixel, 0).rgb;
  olx_bsdf bsdf = olx_bsdf_make(texelFetch(albedos, pixel, 0).rgb, surface.g, surface.r, surface.b);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < lamp_count; i++) {
    lamp l = lamps[i];
    if ((add & DIRECT_LAMPS) == 0u && l.extent > 0.0) continue;
    arrival a = arrive(l, position);
    if (dot(normal, a.direction) <= 0.0 || max(a.irradiance.r, max(a.irradiance.g, a.irradiance.b)) <= 0.0) continue;
    sum += reflect_light(bsdf, normal, view, a) * visible(l, position, normal, a.direction, a.distance);
  }
  return sum;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= int(width) || pixel.y >= int(height)) return;
  float depth = texelFetch(depths, pixel, 0).r;
  vec2 clip = (vec2(pixel) + 0.5) / vec2(width, height) * 2.0 - 1.0;
  vec4 place = clip_to_world * vec4(clip, depth, 1.0);
  vec3 light = imageLoad(color, pixel).rgb;
  if (depth == 0.0) {
    if ((add & DIRECT_SKY) != 0u) light = environment(normalize(place.xyz));
  } else if ((add & (DIRECT_LAMPS | DIRECT_WITHOUT_EXTENT)) != 0u) {
    light += direct_light(pixel, place.xyz / place.w);
  }
  imageStore(color, pixel, vec4(min(light, vec3(LARGEST_HALF)), 1.0));
}
