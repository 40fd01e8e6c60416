#version 460
// Converts linear radiance to sRGB, like the .png files of `octalux render`: a shoulder above 0.6; NaN is magenta.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, rgba16f) readonly uniform image2D light;
layout(set = 0, binding = 1, rgba8) writeonly uniform image2D display;

layout(push_constant) uniform constants {
  float exposure;
  uint width, height;
};

const float KNEE = 0.6;

float shoulder(float x) {
  if (x <= KNEE) return max(x, 0.0);
  return KNEE + (1.0 - KNEE) * (1.0 - exp((KNEE - x) / (1.0 - KNEE)));
}

float encode(float x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055; }

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= int(width) || pixel.y >= int(height)) return;
  vec3 c = imageLoad(light, pixel).rgb * exposure;
  vec3 shown = vec3(encode(shoulder(c.r)), encode(shoulder(c.g)), encode(shoulder(c.b)));
  if (any(isnan(c))) shown = vec3(1.0, 0.0, 1.0);
  imageStore(display, pixel, vec4(shown, 1.0));
}
