// Lights, as scenes list them (octalux/scene.h), as relighting takes them (octalux/relight.h), and as renderers that
// draw a scene in their own way read them. Their definitions are in docs/maths.md, "Lights".
//
// A light is plain data without an owner, and copies are independent of each other.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_LIGHT_H
#define OCTALUX_LIGHT_H

#include <octalux/base.h>

// The shape of a light. The first three have no area.
typedef enum olx_light_type {
  OLX_LIGHT_SUN = 0,  // parallel light from infinitely far away
  OLX_LIGHT_POINT,    // equally in all directions
  OLX_LIGHT_SPOT,     // a point that shines into a cone
  OLX_LIGHT_RECT,     // a parallelogram
  OLX_LIGHT_TRIANGLE, // half of a parallelogram
  OLX_LIGHT_SKY       // the same radiance from wherever a ray meets nothing
} olx_light_type;

// The greatest emission of a light or of a surface, in any of the units below. Sums and squares of light beyond it
// could overflow.
#define OLX_MOST_EMISSION 1e20f

// A light. There are no defaults: all members that its type uses must be set. The others have no meaning but must be
// finite, and positions within OLX_POSITION_LIMIT_METRES; 0 will do.
typedef struct olx_light {
  olx_light_type type;
  olx_vec3 position;  // metres; of point and spot; a corner of rect and triangle
  olx_vec3 direction; // of travel, unit; of sun and spot
  // Linear Rec.709, 0 to OLX_MOST_EMISSION. Sun: irradiance on a surface that faces it, W/m^2; point and spot: radiant
  // intensity, W/sr; rect, triangle and sky: radiance, W/(sr m^2).
  olx_vec3 emission;
  // Of a spot, -1 <= outer <= inner <= 1: all its light inside the inner cone, none outside the outer, and between them
  // the square of the share of the way from the outer cosine to the inner (glTF, KHR_lights_punctual).
  float cosine_inner, cosine_outer;
  olx_vec3 edge_u, edge_v; // metres; of rect and triangle: from the corner. They emit on the side of edge_u x edge_v
  bool both_sides;         // of rect and triangle: they emit on the other side too
} olx_light;

#endif
