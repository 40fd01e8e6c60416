// Merges links from the same surfel, and keeps a random sample of the light ones where there are too many.
#include "bake/relight/few_links.h"

#include "core/hooks.h"
#include "core/result.h"

#include <stdlib.h>

olx_result olx_link_list_create(olx_link_list *l, uint32_t surfels) {
  *l = (olx_link_list){.surfels = surfels,
                       .links = olx_allocate((size_t)surfels + 1, sizeof *l->links),
                       .places = olx_allocate((size_t)surfels + 1, sizeof *l->places),
                       .order = olx_allocate((size_t)surfels + 1, sizeof *l->order)};
  if (!l->links || !l->places || !l->order) {
    olx_link_list_free(l);
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for a list of links to %u surfels", surfels);
  }
  for (uint32_t i = 0; i < surfels; i++) l->places[i] = OLX_NO_LINK;
  return OLX_OK;
}

void olx_link_list_free(olx_link_list *l) {
  olx_release(l->links);
  olx_release(l->places);
  olx_release(l->order);
  *l = (olx_link_list){0};
}

void olx_link_list_add(olx_link_list *l, const olx_few_link *link) {
  uint32_t *place = &l->places[link->from];
  if (*place == OLX_NO_LINK) {
    *place = l->count;
    l->links[l->count++] = (olx_few_link){.from = link->from};
  }
  olx_few_link *sum = &l->links[*place];
  sum->weight = olx_add(sum->weight, link->weight);
  sum->direction = olx_madd(sum->direction, link->direction, olx_luminance(link->weight));
  sum->straight += link->straight;
}

static int heavier_first(const void *a, const void *b) {
  const float p = *(const float *)a, q = *(const float *)b;
  return p < q ? 1 : p > q ? -1 : 0;
}

// Returns the threshold of sampling, such that `most` links remain when each lighter link is drawn with the probability
// weight / threshold.
static float threshold(olx_link_list *l, uint32_t most) {
  double rest = 0.0;
  for (uint32_t i = 0; i < l->count; i++) rest += (double)(l->order[i] = olx_luminance(l->links[i].weight));
  qsort(l->order, l->count, sizeof *l->order, heavier_first);
  uint32_t kept = 0;
  while (kept + 1 < most && (double)l->order[kept] * (most - kept) > rest) rest -= (double)l->order[kept++];
  return (float)(rest / (most - kept));
}

static olx_few_link scaled(const olx_few_link *link, float scale) {
  return (olx_few_link){link->from, olx_scale(link->weight, scale), olx_scale(link->direction, scale),
                        link->straight * scale};
}

// Draws the links lighter than `limit` at random and keeps the others unchanged.
static uint32_t draw(const olx_link_list *l, float limit, uint32_t most, float random, olx_few_link *links) {
  uint32_t count = 0;
  double passed = 0.0, next = (double)random * (double)limit;
  for (uint32_t i = 0; i < l->count && count < most; i++) {
    const float weight = olx_luminance(l->links[i].weight);
    if (weight >= limit) {
      links[count++] = l->links[i];
      continue;
    }
    passed += (double)weight;
    if (passed <= next) continue;
    next += (double)limit;
    links[count++] = scaled(&l->links[i], limit / weight);
  }
  return count;
}

uint32_t olx_link_list_take(olx_link_list *l, uint32_t most, float random, olx_few_link *links) {
  const uint32_t count = draw(l, l->count > most ? threshold(l, most) : 0.0f, most, random, links);
  for (uint32_t i = 0; i < l->count; i++) l->places[l->links[i].from] = OLX_NO_LINK;
  l->count = 0;
  return count;
}
