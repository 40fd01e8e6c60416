// The irradiance pass, writing how many filtered texture reads it took instead of light.
#version 460
#extension GL_GOOGLE_include_directive : require

uint reads = 0u;

vec4 counted_read(sampler2DArray maps, vec3 at, float lod) {
  reads++;
  return textureLod(maps, at, lod);
}

#define textureLod counted_read
#include "shaders/pass/frame.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  frame_surface surface;
  bool found = read_surface(pixel, surface);
  // The light is kept, or compilers would drop the reads.
  vec3 light = vec3(0.0);
  if (found) light = olx_irradiance(frame_settings(), surface.position, surface.normal, surface.view);
  imageStore(irradiance_image, pixel, vec4(float(reads), light.rg, found ? 1.0 : 0.0));
}
