// Shades a probe's ball: in the colour of its index, or with its map in every direction. Behind a surface it is faint.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_frame.glsl"

layout(set = 1, binding = VIEW_BINDING_DEPTH) uniform sampler2D depth_image;

layout(location = 0) in vec3 world;
layout(location = 1) flat in vec4 ball;
layout(location = 2) flat in uint probe;
layout(location = 0) out vec4 color;

const float FAINT = 0.16;

vec3 look(vec3 normal, vec3 to_eye) {
  bool irradiance = view.overlay == VIEW_SHADE_BALL_IRRADIANCE;
  uint flags = irradiance ? olx_irradiance_probes[probe].flags : olx_probes[probe].flags;
  float shade = 0.45 + 0.55 * max(dot(normal, to_eye), 0.0);
  if ((flags & OLX_PROBE_BURIED) != 0u) return vec3(0.75, 0.1, 0.08) * shade;
  if (irradiance) return tone(olx_map_irradiance(probe, olx_octahedral_encode(normal)) / OLX_PI);
  if (view.overlay == VIEW_SHADE_BALL_RADIANCE) {
    return tone(seen_light(probe, olx_texel_towards(normal)));
  }
  return probe_color(probe) * shade;
}

void main() {
  vec3 direction = normalize(world - view.eye.xyz), from = view.eye.xyz - ball.xyz;
  float along = -dot(from, direction), off = length(from + direction * along), edge = fwidth(off);
  float cover = clamp((ball.w - off) / max(edge, 1e-9) + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  float t = along - sqrt(max(ball.w * ball.w - off * off, 0.0));
  vec3 normal = normalize(from + direction * t), at = view.eye.xyz + direction * t;
  vec4 clip = view.matrix[0] * at.x + view.matrix[1] * at.y + view.matrix[2] * at.z + view.matrix[3];
  float depth = clip.z / clip.w;
  ivec2 pixel = min(ivec2(gl_FragCoord.xy * view.scale), ivec2(view.width, view.height) - 1);
  bool hidden = texelFetch(depth_image, pixel, 0).r > depth;
  color = vec4(look(normal, -direction), cover * (hidden ? FAINT : 1.0));
  gl_FragDepth = hidden ? 0.5 * depth : depth; // faint balls must not cover opaque ones
}
