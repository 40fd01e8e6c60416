#include "bake/hidden_surfaces.h"

#include "core/hooks.h"
#include "core/pack.h"

enum { MOST_TRIES = 24, NONE = -1 };

static const float GROWTH = 1.25f;
static const float LEAST_COSINE = 0.8f; // between normals of what is one surface

// Ends that are one surface: it lies at the first.
typedef struct group {
  olx_vec3 position, normal, albedo; // albedo: the sum
  float radius, count;
} group;

// The group nearest to an end of those that it belongs to, or NONE.
static int32_t nearest_group(const group *groups, uint32_t count, const olx_ray_end *end) {
  float least = INFINITY;
  int32_t found = NONE;
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec3 away = olx_sub(end->position, groups[i].position);
    const float length = olx_length(away);
    if (length >= least || length > groups[i].radius) continue;
    if (olx_dot(end->normal, groups[i].normal) < LEAST_COSINE) continue;
    if (fabsf(olx_dot(away, groups[i].normal)) > 0.5f * groups[i].radius) continue;
    least = length;
    found = (int32_t)i;
  }
  return found;
}

// Groups of ends, `scale` times as large as a surface of the probe's map; of[i] becomes the group of ray i, or NONE. False once
// places run out, when `all` ends have to find one.
static bool find_groups(const olx_hidden_input *in, float scale, bool all, group *groups, uint32_t *count,
                        int32_t *of) {
  *count = 0;
  for (uint32_t i = 0; i < in->count; i++) {
    of[i] = NONE;
    if (in->rays[i] != OLX_FIT_RAY_UNKNOWN) continue;
    const olx_ray_end *end = &in->ends[i];
    of[i] = nearest_group(groups, *count, end);
    if (of[i] == NONE && *count == in->most) {
      if (all) return false;
      continue;
    }
    if (of[i] == NONE) {
      const float size = olx_max(olx_length(olx_sub(end->position, in->probe)) * in->angle, in->least_length);
      of[i] = (int32_t)(*count)++;
      groups[of[i]] = (group){end->position, end->normal, {0.0f, 0.0f, 0.0f}, scale * size, 0.0f};
    }
    group *g = &groups[of[i]];
    g->albedo = olx_add(g->albedo, end->albedo);
    g->count += 1.0f;
  }
  return true;
}

static void store(const olx_hidden_input *in, const group *groups, uint32_t count, const int32_t *of,
                  olx_hidden_surface *surfaces) {
  for (uint32_t i = 0; i < in->count; i++) {
    if (of[i] != NONE) in->rays[i] = in->first + (uint32_t)of[i];
  }
  for (uint32_t i = 0; i < in->most; i++) {
    surfaces[i] = (olx_hidden_surface){.normal = OLX_FIT_NO_POINT};
    if (i >= count) continue;
    const group *g = &groups[i];
    surfaces[i] = (olx_hidden_surface){g->position, olx_normal_pack(g->normal),
                                       olx_r11g11b10f_pack(olx_scale(g->albedo, 1.0f / g->count))};
  }
}

bool olx_hidden_merge(const olx_hidden_input *in, olx_hidden_surface *surfaces) {
  group *groups = olx_allocate(in->most, sizeof *groups);
  int32_t *of = olx_allocate(in->count, sizeof *of);
  const bool allocated = groups && of;
  if (allocated) {
    uint32_t count = 0;
    float scale = 1.0f;
    for (uint32_t i = 1; !find_groups(in, scale, i < MOST_TRIES, groups, &count, of); i++) scale *= GROWTH;
    store(in, groups, count, of, surfaces);
  }
  olx_release(groups);
  olx_release(of);
  return allocated;
}
