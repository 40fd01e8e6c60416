// Lays out the buffers of a relighter on a device, and fills them when it is created.
#include "core/hooks.h"
#include "relight/relighter.h"
#include "vulkan/uploader.h"
#include "vulkan/vulkan_relight.h"

enum { VECTOR = 3, STRIPS = 4, CORNERS = 4 };

// ---- Layout

// Returns the most tiles that a frame has.
static uint64_t most_tiles(const olx_relight *r, uint64_t texels) {
  const uint64_t most = (r->settings.texels + texels - 1) / texels,
                 all = (uint64_t)olx_relit_tiles_a_map(r->source->n) * r->source->info.probes.count;
  return most < all ? most : all;
}

// Takes the next `words` of a buffer of which `used` are taken, and returns the first.
static uint32_t take(uint64_t *used, uint64_t words) {
  const uint64_t first = *used;
  *used += words;
  return (uint32_t)first; // exact as long as the buffer can be bound
}

static void lay_out_state(olx_gpu_relight *c, const olx_relight *r, olx_vulkan_relight *v) {
  const olx_relight_header *h = r->source->relight.header;
  const uint64_t texels = (uint64_t)c->tile_side * c->tile_side, tiles = most_tiles(r, texels);
  const uint32_t swept = r->settings.surfels < h->surfels ? r->settings.surfels : h->surfels;
  uint64_t used = 0;
  v->result_words = 2 * (swept / OLX_RELIGHT_GROUP + 1);
  c->lights = take(&used, OLX_RELIT_MOST_LIGHTS * OLX_LIGHT_WORDS);
  c->tiles = take(&used, OLX_TILE_WORDS * tiles);
  c->direct = take(&used, VECTOR * (uint64_t)h->surfels);
  c->irradiance = take(&used, VECTOR * (uint64_t)h->surfels);
  c->values = take(&used, VECTOR * (uint64_t)h->surfels);
  c->beams = take(&used, VECTOR * (uint64_t)h->surfels);
  c->beam_sums = take(&used, VECTOR * (uint64_t)h->surfels);
  c->highlights = take(&used, VECTOR * (uint64_t)h->surfels);
  c->close = take(&used, VECTOR * (uint64_t)h->surfels);
  c->near = take(&used, VECTOR * (uint64_t)h->surfels);
  c->lamp_points = take(&used, OLX_RELIT_MOST_LAMP_POINTS * OLX_LAMP_POINT_WORDS);
  c->sums = take(&used, v->result_words);
  c->tile_light = take(&used, VECTOR * texels * tiles);
  c->tile_direct = take(&used, c->tile_words * tiles);
  c->tile_indirect = take(&used, c->tile_words * tiles);
  v->buffers[OLX_BUFFER_STATE].words = OLX_RELIGHT_HEADER_WORDS + used;
}

static uint32_t words_between(const void *first, const void *later) {
  return (uint32_t)((size_t)((const char *)later - (const char *)first) / sizeof(uint32_t));
}

// Lays out the structure's arrays in the order of the file.
static void lay_out_structure(olx_gpu_relight *c, const olx_relight_data *d, olx_vulkan_relight *v) {
  c->link_starts = words_between(d->surfels, d->link_starts);
  c->links = words_between(d->surfels, d->links);
  v->buffers[OLX_BUFFER_SURFELS].words = words_between(d->surfels, d->blocks);
  c->entry_starts = words_between(d->blocks, d->entry_starts);
  c->entries = words_between(d->blocks, d->entries);
  c->volume_starts = words_between(d->blocks, d->volume_starts);
  c->volume_links = words_between(d->blocks, d->volume_links);
  const char *end = (const char *)(d->volume_links + d->header->volume_links);
  v->buffers[OLX_BUFFER_SITES].words = (uint64_t)(end - (const char *)d->blocks) / sizeof(uint32_t);
}

void olx_gpu_relight_lay_out(olx_vulkan_relight *v, const olx_relight *r) {
  const olx_relight_header *h = r->source->relight.header;
  const olx_gpu_words *words = v->gpu->words;
  const uint32_t side = olx_relit_tile_side(r->source->n);
  v->constants = (olx_gpu_relight){
      .surfels = h->surfels,
      .volume_probes = h->volume_probes,
      .light_samples = r->settings.light_samples,
      .tile_side = side,
      .tile_words = side * side + STRIPS * side + CORNERS,
      .volume_light = (uint32_t)((words[OLX_WORDS_VOLUME_LIGHT].offset - words[0].offset) / sizeof(uint32_t))};
  lay_out_state(&v->constants, r, v);
  lay_out_structure(&v->constants, &r->source->relight, v);
  v->buffers[OLX_BUFFER_RESULTS].words = (uint64_t)v->result_words * v->settings.in_flight;
}

// ---- Filling

static olx_result copy_words(olx_vulkan_relight *v, olx_uploader *uploader, olx_relight_buffer to, uint32_t at,
                             const void *words, uint64_t count) {
  return olx_uploader_copy(uploader, words, count * sizeof(uint32_t), v->buffers[to].buffer,
                           (VkDeviceSize)at * sizeof(uint32_t));
}

// Copies the state. Values of surfels are not uploaded, because they are computed before they are read.
static olx_result copy_state(olx_vulkan_relight *v, const olx_relit_surfels *s, olx_uploader *uploader) {
  const olx_gpu_relight *c = &v->constants;
  OLX_TRY(copy_words(v, uploader, OLX_BUFFER_STATE, 0, c, OLX_RELIGHT_HEADER_WORDS));
  const struct {
    uint32_t at;
    const olx_vec3 *values;
  } vectors[] = {{c->direct, s->direct}, {c->irradiance, s->irradiance}, {c->beams, s->beams}, {c->close, s->close},
                 {c->near, s->near},     {c->highlights, s->highlights}};
  for (uint32_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
    OLX_TRY(copy_words(v, uploader, OLX_BUFFER_STATE, OLX_RELIGHT_HEADER_WORDS + vectors[i].at, vectors[i].values,
                       VECTOR * (uint64_t)c->surfels));
  }
  return OLX_OK;
}

static olx_result copy_structure(olx_vulkan_relight *v, const olx_relight_data *d, olx_uploader *uploader) {
  OLX_TRY(copy_words(v, uploader, OLX_BUFFER_SURFELS, 0, d->surfels, v->buffers[OLX_BUFFER_SURFELS].words));
  return copy_words(v, uploader, OLX_BUFFER_SITES, 0, d->blocks, v->buffers[OLX_BUFFER_SITES].words);
}

olx_result olx_gpu_relight_fill(olx_vulkan_relight *v, const olx_relight *relight) {
  olx_uploader uploader;
  olx_result result = olx_uploader_begin(&v->gpu->context, &uploader);
  if (result == OLX_OK) result = copy_state(v, &relight->surfels, &uploader);
  if (result == OLX_OK) result = copy_structure(v, &relight->source->relight, &uploader);
  if (result == OLX_OK) result = olx_uploader_finish(&uploader);
  olx_uploader_end(&uploader);
  return result;
}
