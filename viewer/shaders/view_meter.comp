#version 460
// Meters the image: the mean logarithm of its luminance over a regular lattice of pixels. Black pixels, such as those
// without a surface, do not count.

#define SIDE 8 // every device has workgroups of 128 threads
#define PLACES 8 // pixels of a thread along each axis

layout(local_size_x = SIDE, local_size_y = SIDE) in;

layout(set = 0, binding = 0, rgba16f) readonly uniform image2D light;
layout(set = 0, binding = 1, std430) writeonly buffer metered {
  float log_sum;
  float count;
};

const float BLACK = 1e-5;

shared vec2 sums[SIDE * SIDE];

// Returns the logarithm to base 2 of a pixel's luminance in x, and in y whether the pixel counts.
vec2 look(ivec2 place) {
  vec3 c = imageLoad(light, place).rgb;
  float luminance = dot(c, vec3(0.2126, 0.7152, 0.0722));
  return luminance > BLACK && !isinf(luminance) ? vec2(log2(luminance), 1.0) : vec2(0.0);
}

void main() {
  ivec2 size = imageSize(light);
  uint thread = gl_LocalInvocationIndex;
  vec2 sum = vec2(0.0);
  for (int y = 0; y < PLACES; y++) {
    for (int x = 0; x < PLACES; x++) {
      ivec2 cell = ivec2(gl_LocalInvocationID.xy) * PLACES + ivec2(x, y);
      sum += look((2 * cell + 1) * size / (2 * SIDE * PLACES));
    }
  }
  sums[thread] = sum;
  barrier();
  for (uint half_count = SIDE * SIDE / 2; half_count > 0u; half_count /= 2u) {
    if (thread < half_count) sums[thread] += sums[thread + half_count];
    barrier();
  }
  if (thread == 0u) {
    log_sum = sums[0].x;
    count = sums[0].y;
  }
}
