// Twin of src/select/select.c: chooses the selector for a field.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_SELECT_GLSL
#define OLX_SELECT_GLSL

#include "maps.glsl"

// Returns whether the field has the data that a selector needs.
bool olx_select_available(uint select) {
  return select >= OLX_SELECT_EXHAUSTIVE || (olx_field.select_mask & 1u << select) != 0u;
}

// Resolves OLX_SELECT_BEST to the best selector of the field, and a selector that the field does not have to
// OLX_SELECT_EXHAUSTIVE.
uint olx_select_resolve(uint asked) {
  if (asked != OLX_SELECT_BEST) return olx_select_available(asked) ? asked : OLX_SELECT_EXHAUSTIVE;
  if (olx_select_available(OLX_SELECT_BRICKS)) return OLX_SELECT_BRICKS;
  if (olx_select_available(OLX_SELECT_CAGE)) return OLX_SELECT_CAGE;
  return olx_select_available(OLX_SELECT_VORONOI) ? OLX_SELECT_VORONOI : OLX_SELECT_EXHAUSTIVE;
}

#endif
