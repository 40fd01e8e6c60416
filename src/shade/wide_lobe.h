// Light of a wide specular lobe from many directions that are looked up in probes' maps, and from at most one traced
// ray (docs/maths.md, "Wide lobes").
#ifndef OLX_SHADE_WIDE_LOBE_H
#define OLX_SHADE_WIDE_LOBE_H

#include "core/bsdf.h"

#include <octalux/sample.h>

// The specular lobe of a surface; normal and view are unit vectors.
typedef struct olx_lobe_surface {
  olx_vec3 position; // where rays start, metres
  olx_vec3 normal, view;
  float roughness;
  olx_bsdf bsdf;
} olx_lobe_surface;

// What was found in the directions of a lobe.
typedef struct olx_lobe_light {
  olx_vec3 light;       // W/(sr m^2) that the surface reflects towards the eye, without what the ray below finds
  bool traces;          // whether one ray is to be traced, for all directions that no map resolves
  olx_vec3 direction;   // of that ray, unit
  olx_vec3 reflectance; // factor for the light that it finds
  olx_vec2 random;      // pair of numbers from which it was drawn
} olx_lobe_light;

// Returns whether the light of a lobe of this roughness can be looked up in the field.
bool olx_lobe_is_wide(const olx_field *field, const olx_sample_settings *settings, float roughness);

// Finds where a ray from `origin` (metres) along the unit vector `direction` meets the surfaces that a probe's map
// stores. The search begins `guess` metres along the ray. Returns false where the map does not tell; else *hit has the
// status HIT, or MISS for the sky, and no light yet.
bool olx_lobe_find(const olx_field *field, uint32_t probe, olx_vec3 origin, olx_vec3 direction, float guess,
                   olx_trace_hit *hit);

// Looks up `count` directions of the lobe, drawn by `random`.
olx_lobe_light olx_lobe_look_up(const olx_field *field, const olx_sample_settings *settings,
                                const olx_lobe_surface *surface, uint32_t count, olx_vec2 random);

#endif
