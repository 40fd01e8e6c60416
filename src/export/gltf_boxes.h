// The boxes into which a field divides space: cells of the irradiance volume, and bricks.
#ifndef OLX_EXPORT_GLTF_BOXES_H
#define OLX_EXPORT_GLTF_BOXES_H

#include "field/field_data.h"

// A cube: its low corner and its side, metres.
typedef struct olx_export_box {
  olx_vec3 low;
  float side;
} olx_export_box;

typedef struct olx_export_boxes {
  olx_export_box *boxes; // release with olx_release
  uint32_t count, most;
} olx_export_boxes;

// Every function appends to the list; false when memory runs out.

// Appends each cell of the irradiance volume once, whatever sides it has. A field without a volume has none.
bool olx_export_volume_cells(const olx_field *field, olx_export_boxes *boxes);
// Appends the bricks in which some cell lists a probe: those that are divided into cells, or those that are not.
bool olx_export_bricks(const olx_field *field, bool divided, olx_export_boxes *boxes);

#endif
