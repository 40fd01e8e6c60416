// Reads texels of compressed textures as the device's texture units decode them, one thread a texel.
#version 460
#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform size_block { uint width; };
layout(set = 0, binding = 0) uniform texture2D blocks;
layout(set = 0, binding = 1, std430) writeonly buffer texels_block { vec4 texels[]; };

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  texels[at.y * width + at.x] = texelFetch(blocks, ivec2(at), 0);
}
