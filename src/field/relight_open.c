// Checks the data for relighting when a field is opened, so that relighting itself needs no checks: every number is in
// range.
#include "field/relight_data.h"

#include "core/octahedral.h"
#include "core/result.h"
#include "field/field_chunks.h"

// The arrays after the header, in order.
typedef enum relight_array {
  ARRAY_SURFELS = 0,
  ARRAY_LINK_STARTS,
  ARRAY_LINKS,
  ARRAY_BLOCKS,
  ARRAY_ENTRY_STARTS,
  ARRAY_ENTRIES,
  ARRAY_VOLUME_STARTS,
  ARRAY_VOLUME_LINKS,
  ARRAYS
} relight_array;

static void measure(const olx_relight_header *h, uint64_t bytes[ARRAYS]) {
  bytes[ARRAY_SURFELS] = h->surfels * (uint64_t)sizeof(olx_relight_surfel);
  bytes[ARRAY_LINK_STARTS] = (h->surfels + 1) * (uint64_t)sizeof(uint32_t);
  bytes[ARRAY_LINKS] = h->links * (uint64_t)sizeof(olx_relight_link);
  bytes[ARRAY_BLOCKS] = h->blocks * (uint64_t)sizeof(olx_relight_block);
  bytes[ARRAY_ENTRY_STARTS] = (h->sites + 1) * (uint64_t)sizeof(uint32_t);
  bytes[ARRAY_ENTRIES] = h->entries * (uint64_t)sizeof(olx_relight_entry);
  bytes[ARRAY_VOLUME_STARTS] = (h->volume_probes + 1) * (uint64_t)sizeof(uint32_t);
  bytes[ARRAY_VOLUME_LINKS] = h->volume_links * (uint64_t)sizeof(olx_relight_volume_link);
}

uint64_t olx_relight_structure_bytes(const olx_relight_header *header) {
  uint64_t bytes[ARRAYS], sum = sizeof *header;
  measure(header, bytes);
  for (uint32_t i = 0; i < ARRAYS; i++) sum += bytes[i];
  return sum;
}

static olx_result check_header(const olx_relight_header *h, const char *name) {
  const uint32_t counts[] = {h->surfels, h->links, h->sites, h->entries, h->volume_links, h->blocks, h->volume_probes};
  for (uint32_t i = 0; i < sizeof counts / sizeof *counts; i++) {
    if (counts[i] <= (i == 0 ? OLX_RELIGHT_MOST_SURFELS : OLX_RELIGHT_MOST)) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: a count of %u", name, counts[i]);
  }
  for (uint32_t i = 0; i < sizeof h->zero / sizeof h->zero[0]; i++) {
    if (h->zero[i]) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: reserved bytes are not 0", name);
  }
  return OLX_OK;
}

// Checks that `count` ranges follow each other without gaps from 0 to `end`.
static olx_result check_starts(const uint32_t *starts, uint32_t count, uint32_t end, const char *what,
                               const char *name) {
  bool sound = starts[0] == 0 && starts[count] == end;
  for (uint32_t i = 0; i < count; i++) sound &= starts[i] <= starts[i + 1];
  return sound ? OLX_OK : olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: %s do not follow each other", name, what);
}

static bool is_place(const float place[3]) {
  return fabsf(place[0]) <= OLX_FIELD_MAX_LENGTH && fabsf(place[1]) <= OLX_FIELD_MAX_LENGTH &&
         fabsf(place[2]) <= OLX_FIELD_MAX_LENGTH;
}

static olx_result check_surfels(const olx_relight_data *d, const char *name) {
  for (uint32_t i = 0; i < d->header->surfels; i++) {
    const olx_relight_surfel *s = &d->surfels[i];
    bool sound = (s->normal & 0xFFu) <= 254 && s->normal >> 8 <= 254;
    for (uint32_t k = 0; k < OLX_RELIGHT_POINTS; k++) sound &= is_place(s->points[k]);
    if (!sound) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: surfel %u is impossible", name, i);
  }
  return OLX_OK;
}

static olx_result fail_number(const char *name, const char *what, uint32_t index, uint32_t number) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: %s %u names %u, which it cannot", name, what, index, number);
}

static olx_result check_links(const olx_relight_data *d, const char *name) {
  const uint32_t most = d->header->surfels;
  for (uint32_t i = 0; i < d->header->links; i++) {
    const uint32_t from = olx_relight_link_from(&d->links[i]);
    if (from >= most) return fail_number(name, "link", i, from);
  }
  for (uint32_t i = 0; i < d->header->volume_links; i++) {
    if (d->volume_links[i].from >= most) return fail_number(name, "link of a volume probe", i, d->volume_links[i].from);
  }
  for (uint32_t i = 0; i < d->header->entries; i++) {
    if (d->entries[i].surfel >= most) return fail_number(name, "entry", i, d->entries[i].surfel);
  }
  return OLX_OK;
}

static olx_result check_blocks(const olx_relight_data *d, const char *name) {
  for (uint32_t i = 0; i < d->header->blocks; i++) {
    const olx_relight_block *b = &d->blocks[i];
    if (b->first_site == OLX_RELIGHT_NO_SITE) continue;
    uint32_t most = 0;
    for (uint32_t texel = 0; texel < OLX_RELIGHT_BLOCK * OLX_RELIGHT_BLOCK; texel++) {
      const uint32_t which = b->which >> 2 * texel & 3u;
      if (most < which) most = which;
    }
    if ((uint64_t)b->first_site + most >= d->header->sites) return fail_number(name, "block", i, b->first_site);
  }
  return OLX_OK;
}

olx_result olx_relight_structure_open(const void *data, size_t size_bytes, const char *name,
                                      olx_relight_data *relight) {
  const olx_relight_header *h = data;
  if (size_bytes < sizeof *h) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: %zu bytes", name, size_bytes);
  OLX_TRY(check_header(h, name));
  const uint64_t expected = olx_relight_structure_bytes(h);
  if (size_bytes != expected) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: %zu bytes where its contents take %llu", name, size_bytes,
                    (unsigned long long)expected);
  }
  uint64_t bytes[ARRAYS];
  const char *arrays[ARRAYS], *next = (const char *)(h + 1);
  measure(h, bytes);
  for (uint32_t i = 0; i < ARRAYS; i++) {
    arrays[i] = next;
    next += bytes[i];
  }
  const olx_relight_data d = {.header = h,
                              .surfels = (const void *)arrays[ARRAY_SURFELS],
                              .link_starts = (const void *)arrays[ARRAY_LINK_STARTS],
                              .links = (const void *)arrays[ARRAY_LINKS],
                              .blocks = (const void *)arrays[ARRAY_BLOCKS],
                              .entry_starts = (const void *)arrays[ARRAY_ENTRY_STARTS],
                              .entries = (const void *)arrays[ARRAY_ENTRIES],
                              .volume_starts = (const void *)arrays[ARRAY_VOLUME_STARTS],
                              .volume_links = (const void *)arrays[ARRAY_VOLUME_LINKS]};
  OLX_TRY(check_starts(d.link_starts, h->surfels, h->links, "links", name));
  OLX_TRY(check_starts(d.entry_starts, h->sites, h->entries, "entries", name));
  OLX_TRY(check_starts(d.volume_starts, h->volume_probes, h->volume_links, "links of volume probes", name));
  OLX_TRY(check_surfels(&d, name));
  OLX_TRY(check_links(&d, name));
  OLX_TRY(check_blocks(&d, name));
  *relight = d;
  return OLX_OK;
}

// Checks that light field maps and the volume are those for which the structure was built.
static olx_result check_fit(const olx_field *field) {
  const olx_relight_header *h = field->relight.header;
  const uint64_t side = field->n / OLX_RELIGHT_BLOCK, blocks = side * side * field->info.probes.count;
  if (h->blocks != blocks || h->volume_probes != field->info.volume.probe_count) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: %u blocks of texels and %u volume probes, not %llu and %u",
                    field->name, h->blocks, h->volume_probes, (unsigned long long)blocks,
                    field->info.volume.probe_count);
  }
  return OLX_OK;
}

olx_result olx_relight_open(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  const olx_file_chunk *chunk;
  const uint32_t type = olx_chunk_form_of(&field->info, OLX_CHUNK_RELIGHT)->type;
  OLX_TRY(olx_chunk_find_bytes(&file, type, &chunk));
  if (!chunk) return OLX_OK;
  const void *data = (const char *)field->data + chunk->offset;
  OLX_TRY(olx_relight_structure_open(data, chunk->size_bytes, field->name, &field->relight));
  OLX_TRY(check_fit(field));
  field->info.relight.surfels = field->relight.header->surfels;
  field->info.relight.links = field->relight.header->links;
  field->info.bytes.relight = chunk->size_bytes;
  return OLX_OK;
}
