// A triangle as it is seen from a point: its solid angle, and directions drawn evenly from it.
#ifndef OLX_SCENE_SPHERICAL_TRIANGLE_H
#define OLX_SCENE_SPHERICAL_TRIANGLE_H

#include "core/vec.h"

// Solid angle of the triangle of three unit vectors, 0 to 2 pi (Van Oosterom and Strackee 1983).
float olx_spherical_triangle_area(const olx_vec3 corners[3]);

// A unit vector within the triangle, evenly distributed over its solid angle for even random numbers (Arvo 1995,
// Stratified Sampling of Spherical Triangles). The triangle must have an area.
olx_vec3 olx_spherical_triangle_sample(const olx_vec3 corners[3], olx_vec2 random);

#endif
