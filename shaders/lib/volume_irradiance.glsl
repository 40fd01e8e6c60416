// Twin of src/shade/volume_irradiance.c and olx_volume_find: irradiance in free space from the irradiance volume
// (docs/maths.md). Whoever includes this has declared `uint olx_volume_word(uint index)` before: the words of chunk
// VOLU, and behind them those of VIRR, as they lie in the file (docs/format.md). A look-up reads at most three entries,
// some splits, eight numbers of probes and fourteen words of each.
#ifndef OLX_VOLUME_IRRADIANCE_GLSL
#define OLX_VOLUME_IRRADIANCE_GLSL

#include "pack.glsl"

const uint OLX_VOLUME_HEADER_WORDS = 16u;
const uint OLX_VOLUME_SPLIT_WORDS = 8u;
const uint OLX_VOLUME_CELL_WORDS = 8u;
const uint OLX_VOLUME_BLOCK_ENTRIES = 64u;
const uint OLX_VOLUME_PROBE_WORDS = 14u; // halves, two a word
const uint OLX_VOLUME_CELL = 1u, OLX_VOLUME_BLOCK = 2u, OLX_VOLUME_SPLIT = 3u; // what an entry's two high bits say
const uint OLX_VOLUME_NUMBER = 0x07FFFFFFu;
const float OLX_VOLUME_LIFT = 1.0 / 65536.0; // before a surface, in sides of a cube

// Where the probes of a place's cell are listed, and how much each counts; false where there is no cell.
bool olx_volume_find(vec3 position, out uint cell, out float weights[8]) {
  vec3 origin = vec3(uintBitsToFloat(olx_volume_word(0u)), uintBitsToFloat(olx_volume_word(1u)),
                     uintBitsToFloat(olx_volume_word(2u)));
  uvec3 size = uvec3(olx_volume_word(4u), olx_volume_word(5u), olx_volume_word(6u));
  uint splits = OLX_VOLUME_HEADER_WORDS, cells = splits + olx_volume_word(8u) * OLX_VOLUME_SPLIT_WORDS;
  uint blocks = cells + olx_volume_word(9u) * OLX_VOLUME_CELL_WORDS;
  uint index = blocks + olx_volume_word(7u) * OLX_VOLUME_BLOCK_ENTRIES;
  precise float scale = 1.0 / uintBitsToFloat(olx_volume_word(3u));
  precise vec3 place = (position - origin) * scale;
  cell = 0u;
  weights = float[](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  if (!(all(greaterThanEqual(place, vec3(0.0))) && all(lessThan(place, vec3(size))))) return false;
  uvec3 cube = uvec3(place);
  uint entry = olx_volume_word(index + cube.x + size.x * (cube.y + size.y * cube.z));
  for (float parts = 4.0; parts <= 16.0 && entry >> 30 == OLX_VOLUME_BLOCK; parts *= 4.0) {
    uvec3 part = uvec3(place * parts) & 3u;
    uint first = blocks + (entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_BLOCK_ENTRIES;
    entry = olx_volume_word(first + (part.x | part.y << 2 | part.z << 4));
  }
  while (entry >> 30 == OLX_VOLUME_SPLIT) {
    uint split = splits + (entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_SPLIT_WORDS;
    vec3 normal = vec3(uintBitsToFloat(olx_volume_word(split)), uintBitsToFloat(olx_volume_word(split + 1u)),
                       uintBitsToFloat(olx_volume_word(split + 2u)));
    bool front = olx_dot(normal, position) > uintBitsToFloat(olx_volume_word(split + 3u));
    entry = olx_volume_word(split + (front ? 5u : 4u));
  }
  if (entry >> 30 != OLX_VOLUME_CELL) return false;
  cell = cells + (entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_CELL_WORDS;
  vec3 f = fract(place * float(1u << (entry >> 27 & 7u)));
  for (uint i = 0u; i < 8u; i++) {
    weights[i] = ((i & 1u) != 0u ? f.x : 1.0 - f.x) * ((i & 2u) != 0u ? f.y : 1.0 - f.y) *
                 ((i & 4u) != 0u ? f.z : 1.0 - f.z);
  }
  return true;
}

// The k-th coefficient of a probe, k from 0 to 8.
vec3 olx_volume_coefficient(uint probe, uint k) {
  uint splits = olx_volume_word(8u), cells = olx_volume_word(9u), blocks = olx_volume_word(7u);
  uint cubes = olx_volume_word(4u) * olx_volume_word(5u) * olx_volume_word(6u);
  uint first = OLX_VOLUME_HEADER_WORDS + splits * OLX_VOLUME_SPLIT_WORDS + cells * OLX_VOLUME_CELL_WORDS +
               blocks * OLX_VOLUME_BLOCK_ENTRIES + cubes + probe * OLX_VOLUME_PROBE_WORDS + 3u * k / 2u;
  uint low = olx_volume_word(first), high = olx_volume_word(first + 1u);
  if (k % 2u == 0u) return vec3(olx_half_unpack(low & 0xFFFFu), olx_half_unpack(low >> 16), olx_half_unpack(high & 0xFFFFu));
  return vec3(olx_half_unpack(low >> 16), olx_half_unpack(high & 0xFFFFu), olx_half_unpack(high >> 16));
}

// Twin of olx_harmonics_at.
void olx_harmonics_at(vec3 d, out float values[9]) {
  values = float[](1.0, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3.0 * d.z * d.z - 1.0, d.x * d.z, d.x * d.x - d.y * d.y);
}

// Irradiance at a place for every normal, as coefficients of harmonics. `normal` is that of the surface there.
bool olx_volume_gather(vec3 position, vec3 normal, out vec3 coefficients[9]) {
  uint cell;
  float weights[8];
  for (uint k = 0u; k < 9u; k++) coefficients[k] = vec3(0.0);
  precise vec3 lifted = position + normal * (uintBitsToFloat(olx_volume_word(3u)) * OLX_VOLUME_LIFT);
  if (!olx_volume_find(lifted, cell, weights)) return false;
  for (uint i = 0u; i < 8u; i++) {
    uint probe = olx_volume_word(cell + i);
    for (uint k = 0u; k < 9u; k++) coefficients[k] += olx_volume_coefficient(probe, k) * weights[i];
  }
  return true;
}

// Irradiance for one unit normal, not below 0.
vec3 olx_volume_towards(vec3 coefficients[9], vec3 normal) {
  float values[9];
  olx_harmonics_at(normal, values);
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < 9u; k++) sum += coefficients[k] * values[k];
  return max(sum, vec3(0.0));
}

#endif
