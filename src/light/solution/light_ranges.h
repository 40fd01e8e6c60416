// The units of steps that fill an array of a solution: direct light of surfels, what final rays bring, and the light of
// records. Each unit fills a range of the array and casts rays for it.
#ifndef OLX_LIGHT_LIGHT_RANGES_H
#define OLX_LIGHT_LIGHT_RANGES_H

#include "light/solution/light_solution.h"

typedef struct olx_light_ranges {
  const char *name; // name of the stage
  size_t element_bytes;
  uint32_t (*round)(const olx_scene_light *light);
  uint32_t (*units)(const olx_scene_light *light);
  // Returns the first element of a unit, and for the unit after the last the end of the array.
  uint32_t (*first)(const olx_scene_light *light, uint32_t unit);
  void *(*array)(olx_scene_light *light); // allocates the array where there is none; returns NULL when memory runs out
  // Fills elements first to end - 1, and adds the rays that it casts to *rays.
  olx_result (*fill)(olx_scene_light *light, uint32_t first, uint32_t end, uint64_t *rays);
} olx_light_ranges;

// Fills an array. With a store its ranges are units, and OLX_ERROR_INCOMPLETE means that other parts compute some.
olx_result olx_light_ranges_fill(olx_scene_light *light, const olx_light_ranges *ranges);
// Loads the ranges that all parts of a bake have filled. Has no effect in a whole bake, which has them in memory.
olx_result olx_light_ranges_load(olx_scene_light *light, const olx_light_ranges *ranges);

#endif
