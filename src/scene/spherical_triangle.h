// A triangle projected to the unit sphere: its solid angle, and uniform sampling of its directions.
#ifndef OLX_SCENE_SPHERICAL_TRIANGLE_H
#define OLX_SCENE_SPHERICAL_TRIANGLE_H

#include "core/vec.h"

// Returns the solid angle of the triangle of three unit vectors, 0 to 2 pi (Van Oosterom and Strackee 1983).
float olx_spherical_triangle_area(const olx_vec3 corners[3]);

// Returns a unit vector within the triangle, uniform over its solid angle for uniform random numbers (Arvo 1995,
// Stratified Sampling of Spherical Triangles). The triangle must have an area.
olx_vec3 olx_spherical_triangle_sample(const olx_vec3 corners[3], olx_vec2 random);

#endif
