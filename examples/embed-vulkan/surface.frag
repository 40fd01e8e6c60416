// The host's one pass: the G-buffer, and a picture with emitted and direct light. The light is a rectangle under the
// ceiling, sampled, with shadow rays against every triangle of the scene: an engine has shadow maps, but 30 triangles
// take little time.
//
// Compiled a second time with OWN_DIFFUSE, it also queries the field for irradiance: the second way to use Octalux, for
// forward renderers, without the recorded diffuse pass and its image.
#version 460
#ifdef OWN_DIFFUSE
#extension GL_GOOGLE_include_directive : require
#define OLX_FIELD_SET 1
#include "lib/octalux.glsl"
#endif

layout(push_constant) uniform camera {
  mat4 world_to_clip;
  vec4 eye;
};
layout(set = 0, binding = 0, std430) readonly buffer vertex_block { float vertices[]; };
layout(set = 0, binding = 1, std430) readonly buffer index_block { uint indices[]; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 surface_normal;
layout(location = 2) in vec3 base_color;
layout(location = 3) in vec3 material; // roughness, metallic, specular weight, as olx_vulkan_targets wants it
layout(location = 4) in vec3 emission;
layout(location = 0) out vec4 normal_image;
layout(location = 1) out vec4 albedo_image;
layout(location = 2) out vec4 material_image;
layout(location = 3) out vec4 color_image;

const float PI = 3.14159265;
const uint VERTEX_FLOATS = 15; // of a box_vertex
const uint LIGHT_INDICES = 6;  // the light's own triangles are the last
const int LIGHT_SIDE = 5;      // samples: its square
const vec3 LIGHT_CENTER = vec3(0.278, 0.548, 0.2795), LIGHT_U = vec3(0.130, 0.0, 0.0), LIGHT_V = vec3(0.0, 0.0, 0.105);
const vec3 LIGHT_RADIANCE = vec3(17.0, 12.0, 4.0);

vec3 vertex_position(uint i) {
  uint at = indices[i] * VERTEX_FLOATS;
  return vec3(vertices[at], vertices[at + 1], vertices[at + 2]);
}

// Returns whether a triangle crosses the segment from `origin` to `origin + along` (Moeller and Trumbore).
bool crosses(uint first, vec3 origin, vec3 along) {
  vec3 a = vertex_position(first), u = vertex_position(first + 1) - a, v = vertex_position(first + 2) - a;
  vec3 p = cross(along, v), s = origin - a, q = cross(s, u);
  float determinant = dot(u, p);
  if (abs(determinant) < 1e-12) return false;
  vec3 r = vec3(dot(s, p), dot(along, q), dot(v, q)) / determinant;
  return r.x >= 0.0 && r.y >= 0.0 && r.x + r.y <= 1.0 && r.z > 0.0 && r.z < 0.999;
}

bool in_shadow(vec3 origin, vec3 along) {
  for (uint i = 0; i + LIGHT_INDICES < indices.length(); i += 3) {
    if (crosses(i, origin, along)) return true;
  }
  return false;
}

float schlick(float cosine) { return pow(clamp(1.0 - cosine, 0.0, 1.0), 5.0); }

// Returns the share of irradiance / pi that is reflected towards the eye; metals and the coat take the rest.
vec3 diffuse_reflectance(vec3 n, vec3 view) {
  float coat = material.z * mix(0.04, 1.0, schlick(dot(n, view)));
  return base_color * (1.0 - material.y) * (1.0 - coat);
}

// Returns GGX with height-correlated Smith shadowing and Schlick's Fresnel.
vec3 specular(vec3 n, vec3 view, vec3 l) {
  vec3 h = normalize(l + view);
  float nl = dot(n, l), nv = max(dot(n, view), 1e-4), nh = dot(n, h);
  float a2 = pow(material.x, 4.0), d = nh * nh * (a2 - 1.0) + 1.0;
  float smith = nl * sqrt(a2 + nv * nv * (1.0 - a2)) + nv * sqrt(a2 + nl * nl * (1.0 - a2));
  vec3 f0 = mix(vec3(0.04 * material.z), base_color, material.y);
  vec3 fresnel = mix(f0, vec3(mix(material.z, 1.0, material.y)), schlick(dot(view, h)));
  return fresnel * (a2 / (PI * d * d) * 0.5 / smith);
}

vec2 jitter(uvec2 pixel, uint i) {
  uint h = (pixel.x * 1973u + pixel.y * 9277u + i * 26699u) | 1u;
  for (int k = 0; k < 3; k++) h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  return vec2(h & 0xffffu, h >> 16) / 65536.0;
}

vec3 direct_light(vec3 n, vec3 view) {
  vec3 light_normal = normalize(cross(LIGHT_U, LIGHT_V)), diffuse = diffuse_reflectance(n, view) / PI, sum = vec3(0.0);
  for (int i = 0; i < LIGHT_SIDE * LIGHT_SIDE; i++) {
    vec2 at = (vec2(i % LIGHT_SIDE, i / LIGHT_SIDE) + jitter(uvec2(gl_FragCoord.xy), uint(i))) / LIGHT_SIDE - 0.5;
    vec3 from = position + 1e-4 * n, along = LIGHT_CENTER + at.x * LIGHT_U + at.y * LIGHT_V - from;
    vec3 l = normalize(along);
    float cosines = max(dot(n, l), 0.0) * max(-dot(light_normal, l), 0.0);
    if (cosines == 0.0 || in_shadow(from, along)) continue;
    sum += (diffuse + specular(n, view, l)) * LIGHT_RADIANCE * (cosines / dot(along, along));
  }
  return sum * length(cross(LIGHT_U, LIGHT_V)) / (LIGHT_SIDE * LIGHT_SIDE);
}

void main() {
  vec3 n = normalize(surface_normal), view = normalize(eye.xyz - position);
  vec3 light = emission + direct_light(n, view);
#ifdef OWN_DIFFUSE
  // Boxes are flat and have no normal maps, so the triangle's normal serves as both normals.
  light += diffuse_reflectance(n, view) / PI *
           olx_surface_irradiance(olx_sample_settings_default(), position, n, n, view);
#endif
  normal_image = vec4(n, 0.0);
  albedo_image = vec4(base_color, 1.0);
  material_image = vec4(material, 0.0);
  color_image = vec4(light, 1.0);
}
