// Octalux for shaders: a host includes this file, binds the descriptor set of a field as set OLX_FIELD_SET (0 unless
// defined before), and calls these functions:
//
//   olx_surface_irradiance(settings, position, geometric_normal, shading_normal, view)   irradiance on a static surface
//   olx_volume_irradiance(position, normal)                    irradiance in free space
//   olx_irradiance(settings, position, normal, view)           irradiance at a point, of irradiance probes
//   olx_trace(settings, origin, direction, t_max)              what a ray sees
//   olx_glossy(settings, position, normal, view, roughness, random, weight, half_cosine, hit)   light along a lobe
//
// The settings come from olx_sample_settings_default(). The scalar C code in src is the specification of all of them.
// This file has no twin in C.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_OCTALUX_GLSL
#define OLX_OCTALUX_GLSL

#include "emission.glsl"
#include "glossy.glsl"
#include "irradiance.glsl"
#include "sampling.glsl"
#include "surface_irradiance.glsl"

#endif
