// Builds the structures by which the runtime finds probes, as a bake's settings name them, one builder for each
// selector.
#include "bake/selectors/selectors.h"

#include "bake/selectors/bricks_build.h"
#include "bake/selectors/octree_build.h"
#include "bake/selectors/voronoi_build.h"
#include "core/hooks.h"
#include "core/result.h"

// Returns the builder of a selector; NULL where there is nothing to build, because the cage is the grid itself.
static olx_selector_builder builder_of(olx_select select) {
  switch (select) {
  case OLX_SELECT_VORONOI: return olx_voronoi_build;
  case OLX_SELECT_OCTREE: return olx_octree_build;
  case OLX_SELECT_BRICKS: return olx_bricks_build;
  default: return NULL;
  }
}

uint32_t olx_selectors_known(void) {
  uint32_t mask = 1u << OLX_SELECT_CAGE;
  for (olx_select select = OLX_SELECT_VORONOI; select < OLX_SELECT_STORED; select++) {
    if (builder_of(select)) mask |= 1u << select;
  }
  return mask;
}

olx_result olx_selectors_build(const olx_selector_input *input, uint32_t mask, olx_selector_blobs *blobs) {
  for (olx_select select = OLX_SELECT_VORONOI; select < OLX_SELECT_STORED; select++) {
    if (!(mask & 1u << select)) continue;
    OLX_TRY(builder_of(select)(input, &blobs->data[select], &blobs->size_bytes[select]));
  }
  return OLX_OK;
}

void olx_selectors_free(olx_selector_blobs *blobs) {
  for (uint32_t select = 0; select < OLX_SELECT_STORED; select++) olx_release(blobs->data[select]);
  *blobs = (olx_selector_blobs){0};
}
