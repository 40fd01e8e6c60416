// Traces a ray against the whole field: probe after probe until one resolves it (McGuire et al. 2017, Listing 1).
// Its twin is shaders/lib/trace.glsl.
#include "select/bricks.h"
#include "select/cage.h"
#include "select/octree.h"
#include "select/select.h"
#include "select/sight.h"
#include "select/voronoi.h"
#include "trace/probe_trace.h"
#include "trace/texel_shade.h"

#include <string.h>

// The number of rays that olx_trace_rays follows side by side, and the least number for which that is faster than
// following one after the other: as many as march_wide.c has lanes.
enum { TOGETHER = 64, WORTHWHILE = 16 };

typedef struct search {
  const olx_field *field;
  const olx_sample_settings *settings;
  olx_vec3 origin, direction;
  float t, t_max; // the ray is known to be clear up to t
  float lost;     // where the probe that followed it farthest lost it
  uint32_t attempts, limit;
  uint32_t asked[(OLX_REMEMBERED + 31) / 32];
  uint32_t steps;
  // The best guess if no probe resolves the ray: the surface behind which it vanished by the smallest gap.
  olx_probe_answer fallback;
  uint32_t fallback_probe;
} search;

static bool usable(const search *s, uint32_t probe) {
  return s->settings->keep_buried || !(s->field->probe_flags[probe] & OLX_PROBE_BURIED);
}

// Returns whether a ray can be marched: its direction is a unit vector, and the squares of its numbers are finite.
static bool is_ray(olx_vec3 origin, olx_vec3 direction, float t_max) {
  const float length = olx_dot(direction, direction);
  return olx_dot(origin, origin) < INFINITY && length > 0.9f && length < 1.1f && t_max > 0.0f;
}

static bool was_asked(const search *s, uint32_t probe) {
  const uint32_t bit = probe % OLX_REMEMBERED;
  return s->asked[bit / 32] >> bit % 32 & 1u;
}

static void remember(search *s, uint32_t probe) {
  const uint32_t bit = probe % OLX_REMEMBERED;
  s->asked[bit / 32] |= 1u << bit % 32;
  s->attempts++;
}

static olx_vec3 ray_point(const search *s, float t) { return olx_madd(s->origin, s->direction, t); }

// Returns the squared distance of a probe from the ray's line.
static float line_distance_squared(const search *s, uint32_t probe) {
  const olx_vec3 offset = olx_sub(s->field->probe_positions[probe], s->origin);
  const olx_vec3 foot = olx_madd(offset, s->direction, -olx_dot(offset, s->direction));
  return olx_dot(foot, foot);
}

// Returns whether a probe sees the ray's origin or, once other probes have lost the ray, the place where they did.
static bool sees(const search *s, uint32_t probe) {
  if (s->attempts == 0) return olx_probe_sees(s->field, probe, s->origin, OLX_SIGHT_START, &s->direction);
  return olx_probe_sees(s->field, probe, ray_point(s, s->lost), OLX_SIGHT_STUCK, NULL);
}

// Makes the job for tracing the ray through a probe's map, and remembers the probe as tried.
static olx_probe_job question(search *s, uint32_t probe) {
  remember(s, probe);
  return (olx_probe_job){.probe = probe,
                         .ray = {.origin = olx_sub(s->origin, s->field->probe_positions[probe]),
                                 .direction = s->direction,
                                 .t_min = s->t,
                                 .t_max = s->t_max}};
}

// Takes a probe's answer. Returns true when it resolves the ray.
static bool settles(search *s, const olx_probe_job *job, olx_probe_answer *answer) {
  s->steps += answer->steps;
  // A ray lost in front of the stored surface has gone behind nothing, so it ends there.
  if (answer->status == OLX_TRACE_UNKNOWN && answer->gap < 0.0f) answer->status = OLX_TRACE_HIT;
  if (answer->status != OLX_TRACE_UNKNOWN) return true;
  if (s->fallback_probe == UINT32_MAX || answer->gap < s->fallback.gap) {
    s->fallback = *answer;
    s->fallback_probe = job->probe;
  }
  const float footprint =
      olx_mean_texel_angle(s->field->n) * olx_length(olx_madd(job->ray.origin, job->ray.direction, answer->t));
  s->t = olx_max(s->t, answer->t - OLX_HAND_OVER_FOOTPRINTS * footprint);
  s->lost = olx_max(s->lost, answer->t);
  return false;
}

// Traces the ray through one probe's map. Returns true when that resolves it.
static bool ask(search *s, uint32_t probe, olx_probe_answer *answer) {
  const olx_probe_job job = question(s, probe);
  *answer = olx_trace_probe(s->field, probe, &job.ray, s->settings->tracer);
  return settles(s, &job, answer);
}

// Returns the corner to begin with: the probe nearest to the ray's line.
static uint32_t first_corner(const search *s, const olx_grid *grid, const olx_cage *cage) {
  uint32_t best = 0;
  float best_distance = INFINITY;
  for (uint32_t corner = 0; corner < 8; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    const float distance = line_distance_squared(s, olx_cage_probe(grid, cage, corner));
    if (distance < best_distance) {
      best_distance = distance;
      best = corner;
    }
  }
  return best;
}

// Returns the next probe of the cage around the place to which the ray is followed. Corners are taken in steps of
// three, so that each is far from the last.
static uint32_t next_corner(const search *s) {
  const olx_grid *grid = &s->field->info.probes.grid;
  const olx_cage cage = olx_cage_at(grid, ray_point(s, s->lost));
  uint32_t corner = first_corner(s, grid, &cage);
  for (uint32_t i = 0; i < 8; i++, corner = (corner + 3) & 7u) {
    if (!olx_cage_has(&cage, corner)) continue;
    const uint32_t probe = olx_cage_probe(grid, &cage, corner);
    if (usable(s, probe) && !was_asked(s, probe)) return probe;
  }
  return OLX_NO_PROBE;
}

// Returns the first of these choices that is usable and not yet tried.
static uint32_t first_choice(const search *s, const uint32_t choices[OLX_CHOICES]) {
  for (uint32_t i = 0; i < OLX_CHOICES; i++) {
    if (choices[i] != OLX_NO_PROBE && usable(s, choices[i]) && !was_asked(s, choices[i])) return choices[i];
  }
  return OLX_NO_PROBE;
}

// Returns the nearest probe at first; later, the neighbour of the last tried probe in the direction in which the ray
// was lost.
static uint32_t next_neighbour(const search *s, uint32_t last) {
  if (s->attempts == 0) return olx_voronoi_nearest(s->field, s->origin, s->settings->keep_buried);
  uint32_t choices[OLX_CHOICES];
  olx_voronoi_neighbours(s->field, last, olx_sub(ray_point(s, s->t), s->field->probe_positions[last]), choices);
  return first_choice(s, choices);
}

// Returns the next probe of the octree's leaf around the place to which the ray is followed.
static uint32_t next_in_leaf(const search *s) {
  uint32_t choices[OLX_CHOICES];
  olx_octree_choices(s->field, olx_octree_leaf(s->field, ray_point(s, s->lost)), choices);
  return first_choice(s, choices);
}

// Returns the ray's origin or, once probes have lost the ray, the place where they did.
static olx_vec3 sought(const search *s) { return s->attempts == 0 ? s->origin : ray_point(s, s->lost); }

// The probes that the bricks list for the sought place, and the cost of each: at first its squared distance from the
// origin and from the ray's line, later its squared distance from the place.
typedef struct listed {
  const uint32_t *list;
  float cost[OLX_BRICK_PROBES];
} listed;

static listed look_up(const search *s) {
  const olx_vec3 place = sought(s);
  listed l = {.list = olx_bricks_list(&s->field->bricks, place)};
  for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) l.cost[i] = INFINITY;
  for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) {
    const uint32_t probe = olx_bricks_probe(l.list, i);
    if (probe == OLX_BRICK_NO_PROBE) break;
    if (!usable(s, probe) || was_asked(s, probe)) continue;
    const olx_vec3 offset = olx_sub(s->field->probe_positions[probe], place);
    l.cost[i] = olx_dot(offset, offset);
    if (s->attempts == 0) l.cost[i] += OLX_OFF_LINE * line_distance_squared(s, probe);
  }
  return l;
}

// Takes the cheapest probe not taken before; OLX_BRICK_NO_PROBE when there is none.
static uint32_t take_best(listed *l) {
  uint32_t best = 0;
  for (uint32_t i = 1; i < OLX_BRICK_PROBES; i++) best = l->cost[i] < l->cost[best] ? i : best;
  if (l->cost[best] == INFINITY) return OLX_BRICK_NO_PROBE;
  l->cost[best] = INFINITY;
  return olx_bricks_probe(l->list, best);
}

// Returns the cheapest probe that the bricks list and that sees the sought place, or OLX_NO_PROBE.
static uint32_t next_listed(const search *s) {
  listed l = look_up(s);
  for (;;) {
    const uint32_t best = take_best(&l);
    if (best == OLX_BRICK_NO_PROBE) return OLX_NO_PROBE;
    if (sees(s, best)) return best;
  }
}

// Returns the nearest probe, of all those not yet tried, that sees the sought place.
static uint32_t nearest_that_sees(const search *s) {
  enum { SOME = 16 };
  const olx_vec3 place = sought(s);
  float best_distance = INFINITY;
  uint32_t best = OLX_NO_PROBE;
  for (uint32_t next = 0; next < s->field->info.probes.count;) {
    uint32_t probes[SOME], count = 0;
    float distances[SOME];
    olx_vec3 places[SOME], directions[SOME];
    bool seen[SOME];
    for (; next < s->field->info.probes.count && count < SOME; next++) {
      if (!usable(s, next) || was_asked(s, next)) continue;
      const olx_vec3 offset = olx_sub(s->field->probe_positions[next], place);
      distances[count] = olx_dot(offset, offset);
      if (distances[count] >= best_distance) continue;
      places[count] = place;
      directions[count] = s->direction;
      probes[count++] = next;
    }
    olx_probes_see(s->field, count, probes, places, s->attempts == 0 ? OLX_SIGHT_START : OLX_SIGHT_STUCK,
                   s->attempts == 0 ? directions : NULL, seen);
    for (uint32_t i = 0; i < count; i++) {
      if (!seen[i] || distances[i] >= best_distance) continue;
      best_distance = distances[i];
      best = probes[i];
    }
  }
  return best;
}

// Returns the selector's next probe after `last`, the one tried before. This function and those that it calls return
// OLX_NO_PROBE when there is none.
static uint32_t next_selected(const search *s, uint32_t last) {
  switch (olx_select_resolve(s->field, s->settings->select)) {
  case OLX_SELECT_CAGE: return next_corner(s);
  case OLX_SELECT_BRICKS: return next_listed(s);
  case OLX_SELECT_VORONOI: return next_neighbour(s, last);
  case OLX_SELECT_OCTREE: return next_in_leaf(s);
  default: return OLX_NO_PROBE;
  }
}

// Returns how many probes may have been tried after the search of all probes: a few more than before it. Where the
// selector named none, and with OLX_SELECT_EXHAUSTIVE, that is the only search.
static uint32_t far_limit(const search *s) {
  const bool only = s->attempts == 0 || olx_select_resolve(s->field, s->settings->select) == OLX_SELECT_EXHAUSTIVE;
  return only || s->limit < s->attempts + OLX_MOST_FAR ? s->limit : s->attempts + OLX_MOST_FAR;
}

// Tries the probes of the selector or, with `everywhere`, a few of all probes that see the place where the ray was
// lost, nearest first. Returns true when one resolves the ray.
static bool search_probes(search *s, bool everywhere, uint32_t *probe, olx_probe_answer *answer) {
  const uint32_t limit = everywhere ? far_limit(s) : s->limit;
  while (s->attempts < limit) {
    const uint32_t next = everywhere ? nearest_that_sees(s) : next_selected(s, *probe);
    if (next == OLX_NO_PROBE) return false;
    *probe = next;
    if (ask(s, next, answer)) return true;
  }
  return false;
}

// Returns the sky's radiance in the ray's direction, from the first probe that sees it there; 0 when none does.
static olx_vec3 sky_radiance(const search *s) {
  for (uint32_t probe = 0; probe < s->field->info.probes.count; probe++) {
    const size_t texel = olx_texel_towards(s->field, s->direction);
    if (olx_texel_distance(s->field, probe, texel) == INFINITY) return olx_texel_emission(s->field, probe, texel);
  }
  return olx_splat(0.0f);
}

// Reads the light stored in the hit's texel. After lights have changed, a field's stored radiance is out of date. A ray
// that vanished behind an emitter does not meet it.
static void read_light(const search *s, uint32_t probe, size_t texel, bool vanished, olx_trace_hit *hit) {
  const olx_field *field = s->field;
  if (s->settings->visibility_only) return;
  hit->emitter = !vanished && olx_texel_emits(field, probe, texel);
  if (hit->emitter) hit->emission = olx_texel_emission(field, probe, texel);
  const bool stored = field->radiance && s->settings->hits == OLX_HITS_STORED && !field->relit;
  if (stored && !hit->emitter) hit->radiance = olx_texel_radiance(field, probe, texel);
  if (stored && !hit->emitter) return;
  // For a texel that emits, stored radiance is the sum of emitted and reflected light.
  const olx_texel_light light = olx_texel_shade(field, probe, texel, hit->position, s->direction, vanished);
  hit->radiance = olx_add(light.reflected, light.lobe);
  if (!stored) hit->lobe = light.lobe;
}

// Describes an answer to the ray; `vanished`: no probe resolved it, and the answer is the best guess.
static olx_trace_hit describe(const search *s, uint32_t probe, const olx_probe_answer *answer, float t_max,
                              bool vanished) {
  const olx_field *field = s->field;
  olx_trace_hit hit = {
      .status = answer->status,
      .distance_metres = answer->t,
      .position = ray_point(s, answer->t),
      .probe = probe,
      .texel_steps = s->steps,
      .probes_tried = s->attempts,
  };
  if (answer->status == OLX_TRACE_MISS) {
    if (s->t_max >= t_max) return hit; // it ends in free space
    hit.distance_metres = INFINITY;
    hit.emitter = true;
    if (!s->settings->visibility_only) hit.emission = sky_radiance(s);
    return hit;
  }
  hit.texel = (uint32_t)answer->texel;
  read_light(s, probe, answer->texel, vanished, &hit);
  hit.normal = olx_texel_normal(field, probe, answer->texel);
  const olx_vec2 uv = olx_octahedral_encode(olx_sub(hit.position, field->probe_positions[probe]));
  const float distance = olx_texel_distance(field, probe, answer->texel);
  hit.footprint_metres = distance * sqrtf(olx_texel_solid_angle_near(uv, field->n));
  return hit;
}

// Returns where the ray leaves the scene's bounds for good; 0 when they lie behind it. The bounds are widened by the
// width of two texels on the far side of the scene, so that walls that coincide with the bounds are hit first.
static float leave_bounds(const olx_field *field, olx_vec3 origin, olx_vec3 direction) {
  const olx_vec3 room = olx_splat(field->distance_scale * 2.0f * olx_mean_texel_angle(field->n));
  const olx_vec3 low = olx_sub(field->info.scene.bounds_min, room), high = olx_add(field->info.scene.bounds_max, room);
  float t = INFINITY;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const float d = olx_component(direction, axis), o = olx_component(origin, axis);
    if (d == 0.0f) continue;
    t = olx_min(t, ((d > 0.0f ? olx_component(high, axis) : olx_component(low, axis)) - o) / d);
  }
  return olx_max(t, 0.0f);
}

static const olx_trace_hit NOTHING_KNOWN = {.status = OLX_TRACE_UNKNOWN, .probe = UINT32_MAX};

// Prepares a search; false when the ray is not a valid one.
static bool begin_search(search *s, const olx_field *field, const olx_sample_settings *settings, olx_vec3 origin,
                         olx_vec3 direction, float t_max) {
  if (!is_ray(origin, direction, t_max)) return false;
  s->field = field;
  s->settings = settings;
  s->origin = origin;
  s->direction = direction;
  s->t = s->lost = 0.0f;
  s->t_max = olx_min(t_max, leave_bounds(field, origin, direction));
  s->limit = settings->max_probes;
  memset(s->asked, 0, sizeof s->asked);
  s->attempts = s->steps = 0;
  s->fallback_probe = UINT32_MAX;
  return true;
}

// Resolves a ray that no probe of the selector resolved.
static olx_trace_hit search_rest(search *s, float t_max) {
  uint32_t probe = OLX_NO_PROBE;
  olx_probe_answer answer;
  if (search_probes(s, true, &probe, &answer)) return describe(s, probe, &answer, t_max, false);
  if (s->fallback_probe == UINT32_MAX) {
    olx_trace_hit hit = NOTHING_KNOWN;
    hit.probes_tried = s->attempts;
    return hit;
  }
  if (s->fallback.gap < OLX_VANISHED_FOOTPRINTS) s->fallback.status = OLX_TRACE_HIT;
  return describe(s, s->fallback_probe, &s->fallback, t_max, true);
}

// Follows a ray by the selector's probes, from where it was lost, until it is resolved.
static olx_trace_hit follow(search *s, float t_max) {
  uint32_t probe = OLX_NO_PROBE;
  olx_probe_answer answer;
  if (search_probes(s, false, &probe, &answer)) return describe(s, probe, &answer, t_max, false);
  return search_rest(s, t_max);
}

olx_trace_hit olx_trace(const olx_field *field, const olx_sample_settings *settings, olx_vec3 origin,
                        olx_vec3 direction, float t_max_metres) {
  search s;
  const bool begun = begin_search(&s, field, settings, origin, direction, t_max_metres);
  return begun ? follow(&s, t_max_metres) : NOTHING_KNOWN;
}

// Rays that are traced together.
typedef struct bundle {
  uint32_t open[TOGETHER], open_count; // rays without an answer
  uint32_t asking;                     // the first so many of them have a job
  search searches[TOGETHER];
  listed lists[TOGETHER];
  olx_probe_job jobs[TOGETHER];
  olx_probe_answer answers[TOGETHER];
} bundle;

// Makes a job for each open ray: the next probe that the lists of the bricks name for it. Rays for which no probe is
// left are moved to the end.
static void choose_by_bricks(bundle *b, const olx_field *field) {
  uint32_t trying[TOGETHER], candidates[TOGETHER], rest[TOGETHER], try_count = b->open_count, rest_count = 0;
  const bool first = b->open_count && b->searches[b->open[0]].attempts == 0; // all rays have tried equally many
  for (uint32_t k = 0; k < try_count; k++) {
    trying[k] = b->open[k];
    b->lists[trying[k]] = look_up(&b->searches[trying[k]]);
  }
  for (b->asking = 0; try_count;) {
    olx_vec3 places[TOGETHER], directions[TOGETHER];
    bool seen[TOGETHER];
    uint32_t count = 0;
    for (uint32_t k = 0; k < try_count; k++) {
      const search *s = &b->searches[trying[k]];
      const uint32_t candidate = s->attempts < s->limit ? take_best(&b->lists[trying[k]]) : OLX_BRICK_NO_PROBE;
      if (candidate == OLX_BRICK_NO_PROBE) {
        rest[rest_count++] = trying[k];
        continue;
      }
      candidates[count] = candidate;
      places[count] = sought(s);
      directions[count] = s->direction;
      trying[count++] = trying[k];
    }
    olx_probes_see(field, count, candidates, places, first ? OLX_SIGHT_START : OLX_SIGHT_STUCK,
                   first ? directions : NULL, seen);
    try_count = 0;
    for (uint32_t k = 0; k < count; k++) {
      if (!seen[k]) {
        trying[try_count++] = trying[k];
        continue;
      }
      b->jobs[b->asking] = question(&b->searches[trying[k]], candidates[k]);
      b->open[b->asking++] = trying[k];
    }
  }
  for (uint32_t k = 0; k < rest_count; k++) b->open[b->asking + k] = rest[k];
}

static void prefetch_light(const olx_field *field, const olx_sample_settings *settings, uint32_t probe, size_t texel) {
  const bool stored = field->radiance && settings->hits == OLX_HITS_STORED;
  if (stored) __builtin_prefetch(&field->radiance[field->texels * probe + texel]);
  else olx_texel_prefetch(field, probe, texel);
}

// Traces all rays together: first each through its first probe's map, then the unresolved ones through their second,
// and so on, until few are left, which are followed one after the other.
static void trace_by_bricks(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                            const olx_vec3 *origins, const olx_vec3 *directions, float t_max, olx_trace_hit *hits) {
  bundle b;
  b.open_count = 0;
  for (uint32_t i = 0; i < count; i++) {
    hits[i] = NOTHING_KNOWN;
    if (begin_search(&b.searches[i], field, settings, origins[i], directions[i], t_max)) b.open[b.open_count++] = i;
  }
  while (b.open_count >= WORTHWHILE) {
    choose_by_bricks(&b, field);
    for (uint32_t k = b.asking; k < b.open_count; k++) hits[b.open[k]] = search_rest(&b.searches[b.open[k]], t_max);
    olx_trace_probes(field, b.jobs, b.asking, settings->tracer, b.answers);
    for (uint32_t k = 0; k < b.asking && !settings->visibility_only; k++) {
      prefetch_light(field, settings, b.jobs[k].probe, b.answers[k].texel);
    }
    b.open_count = 0;
    for (uint32_t k = 0; k < b.asking; k++) {
      const uint32_t i = b.open[k];
      if (settles(&b.searches[i], &b.jobs[k], &b.answers[k])) {
        hits[i] = describe(&b.searches[i], b.jobs[k].probe, &b.answers[k], t_max, false);
      } else {
        b.open[b.open_count++] = i;
      }
    }
  }
  for (uint32_t k = 0; k < b.open_count; k++) hits[b.open[k]] = follow(&b.searches[b.open[k]], t_max);
}

void olx_trace_rays(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                    const olx_vec3 *origins, const olx_vec3 *directions, float t_max_metres, olx_trace_hit *hits) {
  const bool by_bricks = olx_select_resolve(field, settings->select) == OLX_SELECT_BRICKS;
  for (uint32_t i = 0; i < count; i += TOGETHER) {
    const uint32_t some = count - i < TOGETHER ? count - i : TOGETHER;
    if (by_bricks && some >= WORTHWHILE) {
      trace_by_bricks(field, settings, some, origins + i, directions + i, t_max_metres, hits + i);
      continue;
    }
    for (uint32_t k = i; k < i + some; k++)
      hits[k] = olx_trace(field, settings, origins[k], directions[k], t_max_metres);
  }
}
