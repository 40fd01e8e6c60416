// Traverses the volume's entries and the bricks' index, and collects the cubes that hold something.
#include "export/gltf_boxes.h"

#include "core/hooks.h"
#include "select/bricks.h"

#include <string.h>

static bool add_box(olx_export_boxes *list, olx_vec3 low, float side) {
  if (list->count == list->most) {
    const uint32_t most = list->most ? 2 * list->most : 1024;
    olx_export_box *boxes = olx_allocate(most, sizeof *boxes);
    if (!boxes) return false;
    if (list->count) memcpy(boxes, list->boxes, list->count * sizeof *boxes);
    olx_release(list->boxes);
    list->boxes = boxes;
    list->most = most;
  }
  list->boxes[list->count++] = (olx_export_box){low, side};
  return true;
}

// A part of the volume: its position along each axis, in parts of which there are `parts` for each cube.
typedef struct volume_part {
  uint32_t place[3], parts;
} volume_part;

// Returns the number of halvings of the cube that led to the cell behind an entry; OLX_VOLUME_LEVELS + 1 where both
// sides of all splits are empty.
static uint32_t cell_level(const olx_volume *v, uint32_t entry, uint32_t depth) {
  if ((entry & OLX_VOLUME_KIND) == OLX_VOLUME_CELL) return entry >> OLX_VOLUME_LEVEL_SHIFT & 7u;
  if ((entry & OLX_VOLUME_KIND) != OLX_VOLUME_SPLIT || depth == OLX_VOLUME_MOST_SPLITS) return OLX_VOLUME_LEVELS + 1;
  const olx_volume_split *split = &v->splits[entry & OLX_VOLUME_NUMBER];
  const uint32_t front = cell_level(v, split->front, depth + 1);
  return front <= OLX_VOLUME_LEVELS ? front : cell_level(v, split->behind, depth + 1);
}

// Adds a cell. One that fills several parts is added at the first of them.
static bool add_cell(const olx_volume *v, const volume_part *part, uint32_t level, olx_export_boxes *boxes) {
  const olx_volume_header *h = v->header;
  const uint32_t cells = 1u << level, span = part->parts > cells ? part->parts / cells : 1;
  const float step = h->cube_metres / (float)part->parts;
  if (part->place[0] % span || part->place[1] % span || part->place[2] % span) return true;
  const olx_vec3 low = {h->origin[0] + (float)part->place[0] * step, h->origin[1] + (float)part->place[1] * step,
                        h->origin[2] + (float)part->place[2] * step};
  return add_box(boxes, low, h->cube_metres / (float)cells);
}

static bool walk(const olx_volume *v, const volume_part *part, uint32_t entry, olx_export_boxes *boxes) {
  const uint32_t kind = entry & OLX_VOLUME_KIND;
  if (kind != OLX_VOLUME_BLOCK) {
    const uint32_t level = cell_level(v, entry, 0);
    return level > OLX_VOLUME_LEVELS || add_cell(v, part, level, boxes);
  }
  if (part->parts == 16) return true; // not read at this depth
  for (uint32_t i = 0; i < OLX_VOLUME_BLOCK_ENTRIES; i++) {
    const volume_part inner = {
        .place = {4 * part->place[0] + (i & 3u), 4 * part->place[1] + (i >> 2 & 3u), 4 * part->place[2] + (i >> 4)},
        .parts = 4 * part->parts};
    if (!walk(v, &inner, v->blocks[(size_t)(entry & OLX_VOLUME_NUMBER) * OLX_VOLUME_BLOCK_ENTRIES + i], boxes)) {
      return false;
    }
  }
  return true;
}

bool olx_export_volume_cells(const olx_field *field, olx_export_boxes *boxes) {
  const olx_volume *v = &field->volume;
  if (!v->header) return true;
  const uint32_t *size = v->header->size;
  const uint64_t cubes = (uint64_t)size[0] * size[1] * size[2];
  for (uint64_t i = 0; i < cubes; i++) {
    const volume_part cube = {
        .place = {(uint32_t)(i % size[0]), (uint32_t)(i / size[0] % size[1]), (uint32_t)(i / size[0] / size[1])},
        .parts = 1};
    if (!walk(v, &cube, v->index[i], boxes)) return false;
  }
  return true;
}

static bool names_a_probe(const olx_bricks *b, uint32_t list) {
  return olx_bricks_probe(b->lists + (size_t)list * OLX_BRICK_LIST_WORDS, 0) != OLX_BRICK_NO_PROBE;
}

static bool holds_a_probe(const olx_bricks *b, uint32_t entry) {
  if (!(entry & OLX_BRICK_DIVIDED)) return names_a_probe(b, entry);
  const uint32_t *cells = b->cells + (size_t)(entry & ~OLX_BRICK_DIVIDED) * OLX_BRICK_CELL_WORDS;
  for (uint32_t i = 0; i < OLX_BRICK_CELL_WORDS; i++) {
    if (names_a_probe(b, cells[i] & 0xFFFFu) || names_a_probe(b, cells[i] >> 16)) return true;
  }
  return false;
}

bool olx_export_bricks(const olx_field *field, bool divided, olx_export_boxes *boxes) {
  const olx_bricks *b = &field->bricks;
  if (!b->header) return true;
  const uint32_t *size = b->header->size;
  const float side = b->header->cell_metres * OLX_BRICK_SIDE;
  const uint64_t bricks = (uint64_t)size[0] * size[1] * size[2];
  for (uint64_t i = 0; i < bricks; i++) {
    const uint32_t entry = b->index[i];
    if (((entry & OLX_BRICK_DIVIDED) != 0) != divided || !holds_a_probe(b, entry)) continue;
    const olx_vec3 low = {b->header->origin[0] + (float)(i % size[0]) * side,
                          b->header->origin[1] + (float)(i / size[0] % size[1]) * side,
                          b->header->origin[2] + (float)(i / size[0] / size[1]) * side};
    if (!add_box(boxes, low, side)) return false;
  }
  return true;
}
