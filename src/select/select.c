// Chooses the selector for a field: the requested one where the field has it, else the best that the field has.
// Its twin is shaders/lib/select.glsl.
#include "select/select.h"

bool olx_select_available(const olx_field *field, olx_select select) {
  if (select >= OLX_SELECT_STORED) return select <= OLX_SELECT_BEST;
  return (field->info.select_mask & 1u << select) != 0;
}

olx_select olx_select_resolve(const olx_field *field, olx_select asked) {
  if (asked != OLX_SELECT_BEST) return olx_select_available(field, asked) ? asked : OLX_SELECT_EXHAUSTIVE;
  static const olx_select best[] = {OLX_SELECT_BRICKS, OLX_SELECT_CAGE, OLX_SELECT_VORONOI, OLX_SELECT_OCTREE};
  for (uint32_t i = 0; i < sizeof best / sizeof best[0]; i++) {
    if (olx_select_available(field, best[i])) return best[i];
  }
  return OLX_SELECT_EXHAUSTIVE;
}
