// Twin of src/shade/volume_irradiance.c and olx_volume_find: looks up irradiance in free space in the irradiance volume
// (docs/maths.md). A look-up reads at most three entries, some splits, eight numbers of probes and fourteen words of
// each. The C code sums coefficients of harmonics and evaluates the sum; here each probe is evaluated for the wanted
// normals and light is summed, so that no array lies in memory.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_VOLUME_IRRADIANCE_GLSL
#define OLX_VOLUME_IRRADIANCE_GLSL

#include "harmonics.glsl"
#include "pack.glsl"

#ifndef OLX_OWN_VOLUME // a host with words of its own defines a function of this name before this file
#include "maps.glsl"

// Returns a word of chunk VOLU, followed by VIRR, as it lies in the file (docs/format.md).
uint olx_volume_word(uint index) { return olx_word(olx_field.volume_first + index); }

// Returns whether the field has a volume; its first word is not 0, because pyramids lie before it.
bool olx_has_volume() { return olx_field.volume_first != 0u; }
#endif


// Finds the list of the probes of a place's cell, and the place's position in the cell; false where there is no cell.
bool olx_volume_find(vec3 position, out uint cell, out vec3 fraction) {
  vec3 origin = vec3(uintBitsToFloat(olx_volume_word(0u)), uintBitsToFloat(olx_volume_word(1u)),
                     uintBitsToFloat(olx_volume_word(2u)));
  uvec3 size = uvec3(olx_volume_word(4u), olx_volume_word(5u), olx_volume_word(6u));
  uint splits = OLX_VOLUME_HEADER_WORDS, cells = splits + olx_volume_word(8u) * OLX_VOLUME_SPLIT_WORDS;
  uint blocks = cells + olx_volume_word(9u) * OLX_VOLUME_CELL_WORDS;
  uint index = blocks + olx_volume_word(7u) * OLX_VOLUME_BLOCK_ENTRIES;
  precise float scale = 1.0 / uintBitsToFloat(olx_volume_word(3u));
  precise vec3 place = (position - origin) * scale;
  cell = 0u;
  fraction = vec3(0.0);
  if (!(all(greaterThanEqual(place, vec3(0.0))) && all(lessThan(place, vec3(size))))) return false;
  uvec3 cube = uvec3(place);
  uint entry = olx_volume_word(index + cube.x + size.x * (cube.y + size.y * cube.z));
  for (float parts = 4.0; parts <= 16.0 && (entry & OLX_VOLUME_KIND) == OLX_VOLUME_BLOCK; parts *= 4.0) {
    uvec3 part = uvec3(place * parts) & 3u;
    uint first = blocks + (entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_BLOCK_ENTRIES;
    entry = olx_volume_word(first + (part.x | part.y << 2 | part.z << 4));
  }
  while ((entry & OLX_VOLUME_KIND) == OLX_VOLUME_SPLIT) {
    uint split = splits + (entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_SPLIT_WORDS;
    vec3 normal = vec3(uintBitsToFloat(olx_volume_word(split)), uintBitsToFloat(olx_volume_word(split + 1u)),
                       uintBitsToFloat(olx_volume_word(split + 2u)));
    bool front = olx_dot(normal, position) > uintBitsToFloat(olx_volume_word(split + 3u));
    entry = olx_volume_word(split + (front ? 5u : 4u));
  }
  if ((entry & OLX_VOLUME_KIND) != OLX_VOLUME_CELL) return false;
  cell = cells + (entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_CELL_WORDS;
  fraction = fract(place * float(1u << (entry >> OLX_VOLUME_LEVEL_SHIFT & 7u)));
  return true;
}

// Returns the weight of corner i of a cell, i from 0 to 7.
float olx_volume_weight(vec3 f, uint i) {
  return ((i & 1u) != 0u ? f.x : 1.0 - f.x) * ((i & 2u) != 0u ? f.y : 1.0 - f.y) *
         ((i & 4u) != 0u ? f.z : 1.0 - f.z);
}

// Returns where the coefficients of a probe begin.
uint olx_volume_light(uint probe) {
  uint splits = olx_volume_word(8u), cells = olx_volume_word(9u), blocks = olx_volume_word(7u);
  uint cubes = olx_volume_word(4u) * olx_volume_word(5u) * olx_volume_word(6u);
  return OLX_VOLUME_HEADER_WORDS + splits * OLX_VOLUME_SPLIT_WORDS + cells * OLX_VOLUME_CELL_WORDS +
         blocks * OLX_VOLUME_BLOCK_ENTRIES + cubes + probe * (OLX_VOLUME_HALVES / 2u);
}

// Returns the k-th of the coefficients that begin at a word, k from 0 to 8.
vec3 olx_volume_coefficient(uint light, uint k) {
  uint low = olx_volume_word(light + 3u * k / 2u), high = olx_volume_word(light + 3u * k / 2u + 1u);
  bool odd = k % 2u != 0u;
  return vec3(olx_half_unpack(odd ? low >> 16 : low & 0xFFFFu), olx_half_unpack(odd ? high & 0xFFFFu : low >> 16),
              olx_half_unpack(odd ? high >> 16 : high & 0xFFFFu));
}

// Returns a probe's irradiance for two unit normals; for the second, without the share from below a surface with the
// first normal (twin of olx_volume_bent). Ringing may make it negative.
mat2x3 olx_volume_probe(uint probe, vec3 from, vec3 to) {
  float values_from[9], values_to[9], below = 0.5 - 0.5 * olx_dot(from, to);
  olx_harmonics_at(from, values_from);
  olx_harmonics_at(to, values_to);
  for (uint k = 0u; k < 9u; k++) { // odd harmonics change their sign for the opposite direction
    values_to[k] -= (k >= 1u && k <= 3u ? -below : below) * values_from[k];
  }
  uint light = olx_volume_light(probe);
  mat2x3 sum = mat2x3(0.0);
  for (uint k = 0u; k < 9u; k++) {
    vec3 coefficient = olx_volume_coefficient(light, k);
    sum += mat2x3(coefficient * values_from[k], coefficient * values_to[k]);
  }
  return sum;
}

// Returns irradiance at a place for the two unit normals of olx_volume_probe, at least 0; false where the volume has no
// cell. `normal` is that of the surface there.
bool olx_volume_both(vec3 position, vec3 normal, vec3 from, vec3 to, out mat2x3 irradiance) {
  uint cell;
  vec3 fraction;
  precise vec3 lifted = position + normal * (uintBitsToFloat(olx_volume_word(3u)) * OLX_VOLUME_LIFT);
  bool found = olx_volume_find(lifted, cell, fraction);
  mat2x3 sum = mat2x3(0.0);
  if (found) {
    for (uint i = 0u; i < 8u; i++) {
      sum += olx_volume_probe(olx_volume_word(cell + i), from, to) * olx_volume_weight(fraction, i);
    }
  }
  irradiance = mat2x3(max(sum[0], vec3(0.0)), max(sum[1], vec3(0.0)));
  return found;
}

#endif
