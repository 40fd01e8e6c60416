// Judges whether the probes of a cell can light what is in it: lines through the cell find places on its surfaces, and
// rays from each place tell how much of its light would come from probes that it sees.
#include "bake/volume/volume_sight.h"

#include "scene/bvh.h"

enum {
  LINES = 4,          // along each side of the faces where lines enter
  MOST_SURFACES = 16, // that a line meets
  LEAST_BLIND = 2     // places; one alone may be an accident
};

// A place is blind when it sees less than this share of what it would be lit by, ...
static const float LEAST_SEEN = 0.15f;
// ... and a cell when more than this share of its places is.
static const float MOST_BLIND = 0.1f;
// Corners of a smaller weight are not looked at.
static const float LEAST_WEIGHT = 0.02f;

typedef struct cell_sight {
  const olx_volume_space *space;
  olx_vec3 low;
  float side, lift;
  const olx_volume_sides *sides;
  uint32_t places, blind;
} cell_sight;

static const olx_volume_side *side_at(const olx_volume_sides *sides, olx_vec3 place) {
  uint32_t entry = sides->root;
  while ((entry & OLX_VOLUME_KIND) == OLX_VOLUME_SPLIT) {
    const olx_volume_split *split = &sides->splits[entry & OLX_VOLUME_NUMBER];
    entry = olx_dot(olx_load3(split->normal), place) > split->offset ? split->front : split->behind;
  }
  return entry ? &sides->sides[entry & OLX_VOLUME_NUMBER] : NULL;
}

// Returns the weight, in the light of a place, of those probes that it sees.
static float weight_seen(const cell_sight *c, olx_vec3 place) {
  const olx_volume_side *side = side_at(c->sides, place);
  if (!side) return 0.0f;
  const olx_vec3 at = olx_scale(olx_sub(place, c->low), 1.0f / c->side);
  float seen = 0.0f;
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) {
    const float weight = (i & 1 ? at.x : 1.0f - at.x) * (i & 2 ? at.y : 1.0f - at.y) * (i & 4 ? at.z : 1.0f - at.z);
    const olx_vec3 probe = side->corners >> i & 1 ? olx_volume_corner(c->low, c->side, i) : side->stand_ins[i];
    if (weight > LEAST_WEIGHT && olx_bvh_is_clear(c->space->scene->bvh, place, probe)) seen += weight;
  }
  return seen;
}

static void judge_place(cell_sight *c, olx_vec3 place) {
  if (!olx_volume_space_holds(c->space, place)) return;
  c->places++;
  c->blind += weight_seen(c, place) < LEAST_SEEN;
}

// Judges the places just before and just behind each surface that a line through the cell meets.
static void judge_line(cell_sight *c, olx_vec3 from, olx_vec3 direction) {
  olx_ray ray = {from, direction, 0.0f, c->side};
  for (uint32_t i = 0; i < MOST_SURFACES; i++) {
    const olx_ray_hit hit = olx_bvh_intersect(c->space->scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) return;
    judge_place(c, olx_madd(from, direction, hit.t - c->lift));
    judge_place(c, olx_madd(from, direction, hit.t + c->lift));
    ray.t_min = hit.t + c->lift;
  }
}

bool olx_volume_is_blind(const olx_volume_space *space, olx_vec3 low, float side, float lift,
                         const olx_volume_sides *sides) {
  cell_sight c = {.space = space, .low = low, .side = side, .lift = lift, .sides = sides};
  for (uint32_t i = 0; i < LINES * LINES; i++) {
    const float u = ((float)(i % LINES) + 0.5f) / LINES, v = ((float)(i / LINES) + 0.5f) / LINES;
    judge_line(&c, olx_madd(low, olx_v3(0.0f, u, v), side), olx_v3(1.0f, 0.0f, 0.0f));
    judge_line(&c, olx_madd(low, olx_v3(v, 0.0f, u), side), olx_v3(0.0f, 1.0f, 0.0f));
    judge_line(&c, olx_madd(low, olx_v3(u, v, 0.0f), side), olx_v3(0.0f, 0.0f, 1.0f));
  }
  return c.blind >= LEAST_BLIND && (float)c.blind > MOST_BLIND * (float)c.places;
}
