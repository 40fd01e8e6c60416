// The structures by which probes are found, built at bake time by one function for each selector.
#ifndef OLX_BAKE_SELECTORS_H
#define OLX_BAKE_SELECTORS_H

#include "bake/selectors/selector_input.h"

// Builds the data of a selector. On success the caller releases *data with olx_release. The file holds the same bytes,
// aligned to 64.
typedef olx_result (*olx_selector_builder)(const olx_selector_input *input, void **data, size_t *size_bytes);

// What was built, by olx_select.
typedef struct olx_selector_blobs {
  void *data[OLX_SELECT_STORED];
  size_t size_bytes[OLX_SELECT_STORED];
} olx_selector_blobs;

// Returns a bit (1 << olx_select) for each selector that can be baked.
uint32_t olx_selectors_known(void);

// Builds the selectors that `mask` names into `blobs`, which are zero at first. The caller frees the blobs, also after
// a failure.
olx_result olx_selectors_build(const olx_selector_input *input, uint32_t mask, olx_selector_blobs *blobs);
void olx_selectors_free(olx_selector_blobs *blobs);

#endif
