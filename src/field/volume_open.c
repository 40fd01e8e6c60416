// Checks an irradiance volume when a field is opened, so that lookups need no checks: every number is in range, and no
// entry leads back to an earlier one.
#include "core/result.h"
#include "field/field_chunks.h"

static olx_result check_header(const olx_volume_header *h, const char *name) {
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (!(fabsf(h->origin[axis]) <= OLX_FIELD_MAX_LENGTH)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: origin out of range", name);
    }
    if (h->size[axis] < 1 || h->size[axis] > 1u << 16) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: %u cubes along %c are not in 1..65536", name, h->size[axis],
                      "xyz"[axis]);
    }
  }
  int exponent;
  if (!(h->cube_metres >= OLX_FIELD_MIN_SCALE && h->cube_metres <= OLX_FIELD_MAX_LENGTH) ||
      frexpf(h->cube_metres, &exponent) != 0.5f) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: cubes of %g metres", name, (double)h->cube_metres);
  }
  if (h->probes < 1 || h->cells < 1 || (h->probes | h->cells | h->blocks | h->splits) > OLX_VOLUME_NUMBER) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: %u probes, %u cells, %u blocks, %u splits", name, h->probes,
                    h->cells, h->blocks, h->splits);
  }
  for (uint32_t i = 0; i < sizeof h->zero / sizeof h->zero[0]; i++) {
    if (h->zero[i]) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: reserved bytes are not 0", name);
  }
  return OLX_OK;
}

// The blocks and splits to which an entry at some place may refer: only those with higher numbers than its own.
typedef struct entry_place {
  uint32_t first_block, first_split; // the lowest to which it may refer
  bool blocks;
} entry_place;

static bool is_entry(const olx_volume_header *h, uint32_t entry, entry_place place) {
  const uint32_t number = entry & OLX_VOLUME_NUMBER, level = entry >> OLX_VOLUME_LEVEL_SHIFT & 7u;
  switch (entry & OLX_VOLUME_KIND) {
  case OLX_VOLUME_CELL: return number < h->cells && level <= OLX_VOLUME_LEVELS;
  case OLX_VOLUME_BLOCK: return place.blocks && level == 0 && number >= place.first_block && number < h->blocks;
  case OLX_VOLUME_SPLIT: return level == 0 && number >= place.first_split && number < h->splits;
  default: return entry == 0;
  }
}

static olx_result fail_entry(const char *name, const char *where, uint64_t index, uint32_t entry) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: %s %llu: entry %#x names what it cannot", name, where,
                  (unsigned long long)index, entry);
}

static olx_result check_entries(const olx_volume *v, uint64_t cubes, const char *name) {
  const olx_volume_header *h = v->header;
  for (uint64_t i = 0; i < cubes; i++) {
    if (!is_entry(h, v->index[i], (entry_place){.blocks = true})) return fail_entry(name, "cube", i, v->index[i]);
  }
  for (uint64_t i = 0; i < (uint64_t)h->blocks * OLX_VOLUME_BLOCK_ENTRIES; i++) {
    const uint32_t block = (uint32_t)(i / OLX_VOLUME_BLOCK_ENTRIES);
    if (!is_entry(h, v->blocks[i], (entry_place){.blocks = true, .first_block = block + 1})) {
      return fail_entry(name, "block", block, v->blocks[i]);
    }
  }
  for (uint32_t i = 0; i < h->splits; i++) {
    const olx_volume_split *s = &v->splits[i];
    const entry_place place = {.first_split = i + 1};
    if (!is_entry(h, s->behind, place)) return fail_entry(name, "split", i, s->behind);
    if (!is_entry(h, s->front, place)) return fail_entry(name, "split", i, s->front);
    const olx_vec3 n = olx_load3(s->normal);
    if (!(fabsf(olx_dot(n, n) - 1.0f) <= 1e-3f) || !(fabsf(s->offset) <= OLX_FIELD_MAX_LENGTH) || s->zero[0] ||
        s->zero[1]) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: split %u is no plane", name, i);
    }
  }
  return OLX_OK;
}

static olx_result check_cells(const olx_volume *v, const char *name) {
  for (uint32_t i = 0; i < v->header->cells; i++) {
    for (uint32_t corner = 0; corner < OLX_VOLUME_CORNERS; corner++) {
      if (v->cells[i].probes[corner] < v->header->probes) continue;
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: cell %u names probe %u of %u", name, i,
                      v->cells[i].probes[corner], v->header->probes);
    }
  }
  return OLX_OK;
}

olx_result olx_volume_open(const void *data, size_t size_bytes, const char *name, olx_volume *volume) {
  const olx_volume_header *h = data;
  if (size_bytes < sizeof *h) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: %zu bytes", name, size_bytes);
  OLX_TRY(check_header(h, name));
  const uint64_t cubes = (uint64_t)h->size[0] * h->size[1] * h->size[2]; // below 2^49
  const uint64_t expected = sizeof *h + (uint64_t)h->splits * sizeof(olx_volume_split) +
                            (uint64_t)h->cells * sizeof(olx_volume_cell) +
                            4 * (cubes + (uint64_t)h->blocks * OLX_VOLUME_BLOCK_ENTRIES);
  if (size_bytes != expected) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VOLU: %zu bytes where its contents take %llu", name, size_bytes,
                    (unsigned long long)expected);
  }
  olx_volume v = {.header = h, .splits = (const olx_volume_split *)(h + 1)};
  v.cells = (const olx_volume_cell *)(v.splits + h->splits);
  v.blocks = (const uint32_t *)(v.cells + h->cells);
  v.index = v.blocks + (size_t)h->blocks * OLX_VOLUME_BLOCK_ENTRIES;
  OLX_TRY(check_entries(&v, cubes, name));
  OLX_TRY(check_cells(&v, name));
  *volume = v;
  return OLX_OK;
}

// Opens the irradiance volume. A field has all three of its chunks or none.
olx_result olx_field_volume_open(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  olx_chunk_shapes(&field->info, shapes);
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_bytes(&file, shapes[OLX_CHUNK_VOLUME].type, &chunk));
  if (chunk) {
    OLX_TRY(olx_volume_open((const char *)field->data + chunk->offset, chunk->size_bytes, field->name, &field->volume));
    field->info.volume.probe_count = field->volume.header->probes;
    olx_chunk_shapes(&field->info, shapes);
  }
  const void *positions, *irradiance;
  const uint32_t header = shapes[OLX_CHUNK_VOLUME].type;
  OLX_TRY(olx_chunk_find_wanted(&file, &shapes[OLX_CHUNK_VOLUME_POSITIONS], header, chunk != NULL, &positions));
  OLX_TRY(olx_chunk_find_wanted(&file, &shapes[OLX_CHUNK_VOLUME_IRRADIANCE], header, chunk != NULL, &irradiance));
  if (!chunk) return OLX_OK;
  field->volume.positions = positions;
  field->volume.irradiance = irradiance;
  field->info.bytes.volume = chunk->size_bytes + shapes[OLX_CHUNK_VOLUME_POSITIONS].size_bytes +
                             shapes[OLX_CHUNK_VOLUME_IRRADIANCE].size_bytes;
  return olx_positions_check(positions, field->info.volume.probe_count, NULL, "volume", field->name, OLX_ERROR_FORMAT);
}

olx_result olx_volume_verify(const olx_field *field, uint32_t probe) {
  const uint16_t *halves = field->volume.irradiance + (size_t)OLX_VOLUME_HALVES * probe;
  const uint32_t bad = olx_harmonics_first_bad(halves, OLX_VOLUME_BANDS);
  if (bad == OLX_VOLUME_HALVES) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: irradiance of volume probe %u: coefficient %u: impossible (code %#x)",
                  field->name, probe, bad / 3, halves[bad]);
}
