#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) in vec4 uvs;
layout(location = 1) in float vertex_alpha;

void main() {
  if (!mask_present(materials[material], uvs, vertex_alpha)) discard;
}
