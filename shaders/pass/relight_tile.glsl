// The tiles of light field maps that a frame lights, and their words before they are copied to the field's images.
#ifndef RELIGHT_TILE_GLSL
#define RELIGHT_TILE_GLSL

#include "relight_set.glsl"
#include "../lib/maps.glsl"

struct relight_tile {
  uint probe;
  uvec2 first;
  uint rounds; // number of samples of its direct light
};

uint texels_a_tile() { return relight.tile_side * relight.tile_side; }

relight_tile read_tile(uint slot) {
  uint at = relight.tiles + OLX_TILE_WORDS * slot;
  return relight_tile(state[at], uvec2(state[at + 1u], state[at + 2u]), state[at + 3u]);
}

// Writes a texel into the words of a tile: its texels, then the texels of the map's border that repeat it, a strip for
// each of the top, bottom, left and right edges, and the corners. The border repeats an edge backwards.
void write_texel(uint maps, uint slot, uvec2 texel, uint code) {
  uint side = relight.tile_side, first = maps + relight.tile_words * slot, strips = first + side * side,
       last = olx_field.n - 1u;
  uvec2 within = texel % side;
  state[first + within.y * side + within.x] = code;
  if (texel.y == 0u) state[strips + side - 1u - within.x] = code;
  if (texel.y == last) state[strips + side + side - 1u - within.x] = code;
  if (texel.x == 0u) state[strips + 2u * side + side - 1u - within.y] = code;
  if (texel.x == last) state[strips + 3u * side + side - 1u - within.y] = code;
  if ((texel.x == 0u || texel.x == last) && (texel.y == 0u || texel.y == last)) {
    state[strips + 4u * side + uint(texel.y != 0u) * 2u + uint(texel.x != 0u)] = code;
  }
}

#endif
