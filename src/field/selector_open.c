// Finds the structures of the selectors that a field's description names, and of no others, and checks them.
#include "core/result.h"
#include "field/field_chunks.h"
#include "field/selector_data.h"

olx_result olx_coded_probes_check(uint32_t probe_count, const char *chunk, const char *name) {
  if (probe_count <= OLX_MAX_CODED_PROBES) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: for at most %d probes, not %u", name, chunk, OLX_MAX_CODED_PROBES,
                  probe_count);
}

static olx_result find_selector(olx_field *field, olx_select select) {
  const olx_chunk_file file = olx_field_file(field);
  const uint32_t type = olx_chunk_form_of(&field->info, olx_select_chunk(select))->type;
  const bool named = (field->info.select_mask & 1u << select) != 0;
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_bytes(&file, type, &chunk));
  if (named != (chunk != NULL)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %s chunk %s, but the description %s", field->name, chunk ? "a" : "no",
                    olx_chunk_type_name(type).text, named ? "names its selector" : "does not name its selector");
  }
  if (!chunk) return OLX_OK;
  field->select_data[select] = (const char *)field->data + chunk->offset;
  field->select_bytes[select] = chunk->size_bytes;
  field->info.bytes.selectors += chunk->size_bytes;
  field->info.bytes.select[select] = chunk->size_bytes;
  return OLX_OK;
}

olx_result olx_voronoi_open(olx_field *field) {
  OLX_TRY(find_selector(field, OLX_SELECT_VORONOI));
  return field->select_data[OLX_SELECT_VORONOI] ? olx_voronoi_check(field) : OLX_OK;
}

olx_result olx_octree_open(olx_field *field) {
  OLX_TRY(find_selector(field, OLX_SELECT_OCTREE));
  return field->select_data[OLX_SELECT_OCTREE] ? olx_octree_check(field) : OLX_OK;
}

olx_result olx_brick_chunk_open(olx_field *field) {
  OLX_TRY(find_selector(field, OLX_SELECT_BRICKS));
  const void *data = field->select_data[OLX_SELECT_BRICKS];
  const size_t size_bytes = field->select_bytes[OLX_SELECT_BRICKS];
  if (!data) return OLX_OK;
  return olx_bricks_open(data, size_bytes, field->info.probes.count, field->name, &field->bricks);
}

olx_result olx_voronoi_chunk_verify(const olx_field *field, uint32_t record) {
  return (void)record, olx_voronoi_verify(field);
}

olx_result olx_octree_chunk_verify(const olx_field *field, uint32_t record) {
  return (void)record, olx_octree_verify(field);
}
