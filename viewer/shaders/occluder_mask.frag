#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) in vec2 uv;

void main() {
  if (!mask_present(materials[material], uv)) discard;
}
