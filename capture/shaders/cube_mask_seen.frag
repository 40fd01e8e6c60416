#version 460
#extension GL_GOOGLE_include_directive : require
#include "cube_shared.glsl"

layout(location = 0) flat in uint triangle;
layout(location = 1) in vec4 both_uvs;
layout(location = 2) in float vertex_alpha;
layout(location = 0) out uint seen;

// Looks a texture up as the ray caster does: its finest level, repeated, filtered bilinearly with weights in full
// precision.
vec4 look_up(sampler2D map, vec2 uv) {
  ivec2 size = textureSize(map, 0);
  vec2 at = fract(uv) * vec2(size) - 0.5, low = floor(at), weight = at - low;
  ivec2 a = (ivec2(low) + size) % size, b = (ivec2(low) + 1) % size;
  vec4 upper = mix(texelFetch(map, a, 0), texelFetch(map, ivec2(b.x, a.y), 0), weight.x);
  vec4 lower = mix(texelFetch(map, ivec2(a.x, b.y), 0), texelFetch(map, b, 0), weight.x);
  return mix(upper, lower, weight.y);
}

void main() {
  float present = alpha * vertex_alpha;
  present *= look_up(base_color_texture, (flags & SECOND_BASE_COLOR) != 0u ? both_uvs.zw : both_uvs.xy).a;
  present *= look_up(alpha_texture, (flags & SECOND_ALPHA) != 0u ? both_uvs.zw : both_uvs.xy).r;
  if (!(present >= alpha_cutoff)) discard;
  seen = triangle;
}
