// Finds the space that matters of a viewer: by flooding free voxels from the cameras, or by depth and light where no
// camera can enter.
#include "place/space/space_find.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/space/outdoors.h"
#include "place/space/space.h"
#include "place/space/space_box.h"
#include "scene/bvh.h"
#include "scene/emitters.h"

#include <string.h>

#define LEAST_INDOORS 0.05f // least share of all reached space that may remain
enum {
  MAX_COMPONENTS = 64, // most connected components that are classified, the largest ones
  SAMPLES = 24,        // sample positions in each component, or in all of the space that matters
  LIGHT_DRAWS = 4,     // samples of each group of lights at such a position
  CUT_OFF_SAMPLES = 8, // sample positions in a space that is cut off
  CRUMBS = 64,         // share of the reached space, as a divisor: smaller spaces are ignored
  MOST_CRUMBS = 512,   // spaces of fewer voxels than this are ignored
  MOST_VOXELS_ALONG = 1 << 20
};

static bool is_free(const olx_world *w, const uint32_t voxel[3]) {
  const olx_voxel_state state = olx_world_state(w, voxel);
  return state == OLX_VOXEL_CUT_OFF || state == OLX_VOXEL_REACHED;
}

// Finds the free voxel nearest to the eye, among those around it that it sees.
static bool find_entry(const olx_world *w, olx_vec3 eye, uint32_t nearest[3]) {
  float nearest_distance = INFINITY;
  for (int32_t i = 0; i < 343; i++) {
    const olx_vec3 step = {(float)(i % 7 - 3), (float)(i / 7 % 7 - 3), (float)(i / 49 - 3)};
    uint32_t voxel[3];
    if (!olx_world_at(w, olx_madd(eye, step, w->lattice.size), voxel) || !is_free(w, voxel)) continue;
    const olx_vec3 centre = olx_world_centre(w, voxel);
    const float distance = olx_length(olx_sub(centre, eye));
    if (distance >= nearest_distance || !olx_bvh_is_clear(w->scene->bvh, eye, centre)) continue;
    memcpy(nearest, voxel, sizeof voxel);
    nearest_distance = distance;
  }
  return isfinite(nearest_distance);
}

static uint64_t enter_here(olx_world *w, olx_vec3 eye) {
  uint32_t voxel[3];
  return find_entry(w, eye, voxel) ? olx_world_flood(w, voxel) : 0;
}

// Warns of cameras within the voxels from which the flood cannot begin.
static void warn_of_cameras(const olx_world *w) {
  for (uint32_t i = 0; i < w->scene->camera_count; i++) {
    const olx_camera *camera = &w->scene->cameras[i];
    uint32_t voxel[3];
    if (!olx_world_at(w, camera->eye, voxel) || find_entry(w, camera->eye, voxel)) continue;
    olx_log(OLX_LOG_WARNING,
            "place: camera \"%s\" has no free voxel of %g m around it, so no probe is placed for what only it sees; a "
            "pinned probe, or a smaller --voxel-size, helps",
            camera->name, (double)w->lattice.size);
  }
}

// Clips [enter, leave], in lengths of the direction, to where the ray is within the voxels.
static bool clip(const olx_world *w, olx_vec3 origin, olx_vec3 direction, float *enter, float *leave) {
  const uint32_t *count = w->lattice.count;
  const olx_voxels all = {.low = w->lattice.low, .size = w->lattice.size, .count = {count[0], count[1], count[2]}};
  return olx_voxels_clip(&all, origin, direction, enter, leave);
}

// Floods from every free voxel that a camera outside the box sees.
static uint64_t enter_by_looking(olx_world *w, const olx_camera *camera) {
  const float step = 0.5f * w->lattice.size;
  uint64_t flooded = 0;
  for (uint32_t i = 0; i < OLX_LOOKS; i++) {
    const olx_vec3 direction = olx_look_direction(camera, i);
    float enter = 0.0f, leave = INFINITY;
    if (!clip(w, camera->eye, direction, &enter, &leave)) continue;
    const olx_ray ray = {camera->eye, direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(w->scene->bvh, &ray);
    if (hit.triangle != OLX_NO_HIT) leave = olx_min(leave, hit.t);
    for (float t = enter + 0.5f * step; t < leave && olx_march_goes_on(t, step); t += step) {
      uint32_t voxel[3];
      if (olx_world_at(w, olx_madd(camera->eye, direction, t), voxel)) flooded += olx_world_flood(w, voxel);
    }
  }
  return flooded;
}

static uint64_t flood_from_cameras(olx_world *w) {
  uint64_t flooded = 0;
  for (uint32_t i = 0; i < w->scene->camera_count; i++) {
    const olx_camera *camera = &w->scene->cameras[i];
    uint32_t voxel[3];
    flooded += olx_world_at(w, camera->eye, voxel) ? enter_here(w, camera->eye) : enter_by_looking(w, camera);
  }
  return flooded;
}

// A connected component of free space.
typedef struct component {
  uint32_t voxel[3], sampled; // voxel: one voxel of the component
  uint64_t size;
  bool inside, lit;
  olx_vec3 samples[SAMPLES];
} component;

static uint32_t add_component(component *list, uint32_t count, const uint32_t voxel[3], uint64_t size) {
  uint32_t at = count < MAX_COMPONENTS ? count++ : MAX_COMPONENTS - 1;
  if (at == MAX_COMPONENTS - 1 && list[at].size >= size) return count;
  for (; at > 0 && list[at - 1].size < size; at--) list[at] = list[at - 1];
  list[at] = (component){.voxel = {voxel[0], voxel[1], voxel[2]}, .size = size};
  return count;
}

// Lists the largest components.
static uint32_t list_components(olx_world *w, component *list) {
  uint32_t count = 0, brick = 0, voxel[3];
  while (olx_world_next_free(w, &brick, voxel)) {
    const uint64_t size = olx_world_flood(w, voxel);
    count = add_component(list, count, voxel, size);
    olx_world_put_aside(w);
  }
  return count;
}

// Samples voxels of each component evenly.
static void sample_components(olx_world *w, component *list, uint32_t count) {
  for (component *c = list; c < list + count; c++) {
    olx_world_flood(w, c->voxel);
    for (uint32_t i = 0; i < SAMPLES; i++) {
      const uint64_t nth = (2 * (uint64_t)i + 1) * c->size / (2 * SAMPLES);
      uint32_t voxel[3];
      if (i >= c->size || !olx_world_nth_reached(w, nth, voxel)) break;
      c->samples[c->sampled++] = olx_world_centre(w, voxel);
    }
    olx_world_put_aside(w);
  }
}

static bool light_reaches(const olx_scene *scene, olx_vec3 p, uint32_t seed) {
  for (uint32_t group = 0; group < olx_emitters_group_count(scene); group++) {
    for (uint32_t draw = 0; draw < LIGHT_DRAWS; draw++) {
      const uint32_t key = olx_hash3(seed, group, draw);
      const olx_vec2 random = {olx_unit_float(olx_hash(key)), olx_unit_float(olx_hash(key + 1u))};
      olx_light_sample light;
      if (!olx_emitters_sample(scene, group, p, random, olx_unit_float(olx_hash(key + 2u)), &light)) continue;
      const float length = olx_length(olx_sub(light.target, p)) - light.epsilon_end;
      const olx_ray ray = {p, light.direction, 0.0f, light.infinite ? INFINITY : length};
      if (olx_bvh_transmittance(scene->light_bvh, &ray) > 0.0f) return true; // panes let light pass
    }
  }
  return false;
}

static olx_result judge_components(const olx_world *w, component *list, uint32_t count, uint32_t threads) {
  const size_t most = (size_t)count * SAMPLES;
  olx_vec3 *places = olx_allocate(most, sizeof *places);
  olx_depth *depths = olx_allocate(most, sizeof *depths);
  uint32_t total = 0;
  olx_result result = OLX_ERROR_MEMORY;
  if (places && depths) {
    for (uint32_t i = 0; i < count; i++) {
      memcpy(places + total, list[i].samples, list[i].sampled * sizeof *places);
      total += list[i].sampled;
    }
    result = olx_measure_depth(w->scene, places, total, threads, depths);
  } else {
    olx_fail(result, "place: out of memory");
  }
  for (uint32_t i = 0, at = 0; result == OLX_OK && i < count; i++) {
    uint32_t buried = 0;
    for (uint32_t k = 0; k < list[i].sampled; k++, at++) {
      buried += olx_depth_is_inside(depths[at], w->outside);
      list[i].lit = list[i].lit || light_reaches(w->scene, list[i].samples[k], at);
    }
    list[i].inside = 2 * buried > list[i].sampled;
  }
  olx_release(places);
  olx_release(depths);
  return result;
}

// Returns the largest component that is not inside geometry, of those that light reaches if it reaches any.
static const component *find_largest(const component *list, uint32_t count) {
  const component *largest = NULL;
  for (const component *c = list; c < list + count; c++) {
    if (!c->inside && (!largest || (c->lit && !largest->lit))) largest = c;
  }
  return largest;
}

// Returns the number of voxels below which a space is ignored beside one of `size` voxels.
static uint64_t least_space(uint64_t size) {
  const uint64_t share = size / CRUMBS;
  return share > MOST_CRUMBS ? MOST_CRUMBS : share;
}

// Chooses the space that matters where no camera determines it: with a playable box, every component that is not inside
// geometry; otherwise those of them that light reaches, except for crumbs, or the largest when light reaches none.
static void choose_components(olx_world *w, const component *list, uint32_t count) {
  const component *largest = find_largest(list, count);
  if (!largest) return;
  const uint64_t least = least_space(largest->size);
  const bool all = w->scene->probe_rules.has_playable;
  for (const component *c = list; c < list + count; c++) {
    if (!c->inside && (all || c == largest || (c->lit && c->size >= least))) olx_world_flood(w, c->voxel);
  }
}

static olx_result flood_everything(olx_world *w, uint32_t threads) {
  component *list = olx_allocate_zero(MAX_COMPONENTS, sizeof *list);
  if (!list) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  const uint32_t count = list_components(w, list);
  sample_components(w, list, count);
  const olx_result result = judge_components(w, list, count, threads);
  olx_world_forget(w);
  if (result == OLX_OK) choose_components(w, list, count);
  olx_release(list);
  return result;
}

// Floods from the cameras, or everything without cameras, and always from the pinned probes.
static olx_result flood(olx_world *w, uint32_t threads) {
  const olx_probe_rules *rules = &w->scene->probe_rules;
  olx_world_forget(w);
  const bool by_camera = flood_from_cameras(w) > 0;
  OLX_TRY(olx_check_cancelled());
  if (!by_camera) OLX_TRY(flood_everything(w, threads));
  for (uint32_t i = 0; i < rules->pinned_count; i++) enter_here(w, rules->pinned[i]);
  w->reached_count = olx_world_count_reached(w);
  return olx_check_cancelled();
}

// Excludes a tile's voxels from the world, brick by brick.
static olx_result leave_out(const olx_space *space, const uint8_t *excluded) {
  const olx_tile *t = &space->tile;
  const uint32_t *count = space->voxels.count;
  for (uint32_t z = t->core_from[2]; z < t->core_to[2]; z += OLX_WORLD_SIDE) {
    for (uint32_t y = t->core_from[1]; y < t->core_to[1]; y += OLX_WORLD_SIDE) {
      for (uint32_t x = t->core_from[0]; x < t->core_to[0]; x += OLX_WORLD_SIDE) {
        olx_world_bits bits = {{0}};
        uint64_t any = 0;
        for (uint32_t i = 0; i < OLX_WORLD_SIDE * OLX_WORLD_SIDE * OLX_WORLD_SIDE; i++) {
          const uint32_t at[3] = {x + i % 8 - t->from[0], y + i / 8 % 8 - t->from[1], z + i / 64 - t->from[2]};
          if (at[0] >= count[0] || at[1] >= count[1] || at[2] >= count[2]) continue;
          const uint64_t bit = excluded[at[0] + count[0] * (at[1] + count[1] * (size_t)at[2])];
          bits.z[i / 64] |= bit << i % 64;
          any |= bit;
        }
        const uint32_t corner[3] = {x, y, z};
        if (any) OLX_TRY(olx_world_leave_out(space->world, corner, &bits));
      }
    }
  }
  return OLX_OK;
}

// Finds whether the viewer is indoors, by the space where there are no cameras.
static olx_result find_indoors(olx_world *w, uint32_t threads, bool *indoors) {
  uint64_t pieces = 0, indoor = 0;
  *indoors = olx_cameras_are_indoors(w);
  for (uint32_t i = 0; w->scene->camera_count == 0 && i < w->tile_total; i++) {
    olx_space space;
    OLX_TRY(olx_space_open(w, i, 0, threads, &space));
    const olx_result result = olx_count_indoors(&space, threads, &pieces, &indoor);
    olx_space_free(&space);
    OLX_TRY(result);
    *indoors = olx_pieces_are_indoors(pieces, indoor);
  }
  return OLX_OK;
}

static olx_result leave_tile(olx_world *w, uint32_t tile, bool indoors, uint32_t threads) {
  olx_space space;
  OLX_TRY(olx_space_open(w, tile, OLX_TILE_OVERLAP, threads, &space));
  uint8_t *excluded = olx_allocate(space.voxels.total, 1);
  olx_result result = OLX_ERROR_MEMORY;
  if (excluded) result = olx_find_outdoors(&space, indoors, threads, excluded);
  else olx_fail(result, "place: no memory for %zu voxels", space.voxels.total);
  if (result == OLX_OK) result = leave_out(&space, excluded);
  olx_release(excluded);
  olx_space_free(&space);
  return result;
}

// Excludes what is behind the scenery, without a playable box, unless hardly anything else is left.
static olx_result leave_outdoors(olx_world *w, bool indoors, uint32_t threads) {
  const uint64_t before = w->reached_count;
  for (uint32_t i = 0; i < w->tile_total; i++) {
    OLX_TRY(olx_check_cancelled());
    OLX_TRY(leave_tile(w, i, indoors, threads));
  }
  OLX_TRY(flood(w, threads));
  if ((float)w->reached_count >= LEAST_INDOORS * (float)before) return OLX_OK;
  olx_world_take_back(w);
  return flood(w, threads);
}

typedef struct sifter {
  bool indoors;
  uint32_t threads;
  uint64_t least; // least number of voxels that a space must have to be classified
  olx_result result;
} sifter;

// Returns whether space that is cut off would be relevant if it were reached: whether it is not too small, nor inside
// geometry, behind the scenery or outdoors. Only a few such spaces are sampled.
static bool would_matter(void *user, const olx_world *w, uint64_t size) {
  sifter *s = user;
  olx_vec3 places[CUT_OFF_SAMPLES];
  olx_depth depths[CUT_OFF_SAMPLES];
  uint32_t against = 0;
  if (size < s->least || s->result != OLX_OK) return false;
  for (uint64_t i = 0; i < CUT_OFF_SAMPLES; i++) {
    uint32_t voxel[3];
    if (!olx_world_nth_reached(w, (2 * i + 1) * size / (2 * CUT_OFF_SAMPLES), voxel)) return false;
    places[i] = olx_world_centre(w, voxel);
  }
  s->result = olx_measure_depth(w->scene, places, CUT_OFF_SAMPLES, s->threads, depths);
  for (uint32_t i = 0; s->result == OLX_OK && i < CUT_OFF_SAMPLES; i++) {
    against += olx_depth_is_behind(depths[i], w->outside) || (s->indoors && depths[i].sky_share >= OLX_OUTDOOR_SKY);
  }
  return 2 * against < CUT_OFF_SAMPLES;
}

static olx_result sift(olx_world *w, bool indoors, uint32_t threads) {
  sifter s = {.indoors = indoors, .threads = threads, .least = least_space(w->reached_count)};
  if (s.least < CUT_OFF_SAMPLES) s.least = CUT_OFF_SAMPLES;
  OLX_TRY(olx_world_sift(w, would_matter, &s));
  return s.result;
}

static olx_result flood_space(olx_world *w, uint32_t threads) {
  if (!olx_world_has_free(w)) {
    return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: surfaces touch every voxel of %g m; try more voxels",
                    (double)w->lattice.size);
  }
  OLX_TRY(olx_find_outside(w->scene, threads, &w->outside, NULL));
  OLX_TRY(flood(w, threads));
  bool indoors = false;
  if (!w->scene->probe_rules.has_playable) {
    OLX_TRY(find_indoors(w, threads, &indoors));
    OLX_TRY(leave_outdoors(w, indoors, threads));
  }
  warn_of_cameras(w);
  if (w->reached_count > 0) return sift(w, indoors, threads);
  return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: every free place in %s is inside geometry",
                  w->scene->probe_rules.has_playable ? "the playable box" : "the scene's bounds");
}

static olx_result find_space(olx_world *world, uint32_t threads) {
  const olx_result result = flood_space(world, threads);
  if (result != OLX_OK) olx_world_free(world);
  return result;
}

olx_result olx_world_create_small(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_world *world) {
  olx_box box;
  olx_voxels all = {0};
  *world = (olx_world){0};
  OLX_TRY(olx_space_box(scene, &box));
  olx_voxels_fit(box, resolution, &all);
  const olx_lattice lattice = {all.low, all.size, 1e-3f, {all.count[0], all.count[1], all.count[2]}};
  OLX_TRY(olx_world_create(scene, box, &lattice, (const uint32_t[3]){0}, threads, world));
  return find_space(world, threads);
}

// Lays voxels at multiples of their size over the box, beginning at the corner of a brick, whose index is `first`.
static bool lay_lattice(olx_box box, float size, int32_t first[3], uint32_t begin[3], olx_lattice *lattice) {
  const float low[3] = {box.min.x, box.min.y, box.min.z}, high[3] = {box.max.x, box.max.y, box.max.z};
  *lattice = (olx_lattice){.size = size, .slack = 1e-3f};
  for (int axis = 0; axis < 3; axis++) {
    const double from = floor((double)low[axis] / (double)size), to = ceil((double)high[axis] / (double)size);
    const double corner = floor(from / OLX_WORLD_SIDE) * OLX_WORLD_SIDE;
    if (!(fabs(from) < MOST_VOXELS_ALONG && fabs(to) < MOST_VOXELS_ALONG)) return false;
    first[axis] = (int32_t)corner;
    begin[axis] = (uint32_t)(from - corner);
    lattice->count[axis] = (uint32_t)(to - corner);
  }
  lattice->low = olx_scale(olx_v3((float)first[0], (float)first[1], (float)first[2]), size);
  return olx_world_brick_count(lattice->count) <= OLX_WORLD_BRICKS;
}

olx_result olx_world_create_tiled(const olx_scene *scene, float size, uint32_t threads, olx_world *world) {
  olx_box box;
  *world = (olx_world){0};
  OLX_TRY(olx_space_box(scene, &box));
  for (;; size *= 2.0f) {
    olx_lattice lattice;
    int32_t first[3];
    uint32_t begin[3];
    if (!lay_lattice(box, size, first, begin, &lattice)) continue;
    const olx_result result = olx_world_create(scene, box, &lattice, begin, threads, world);
    if (result == OLX_ERROR_ARGUMENT) continue;
    OLX_TRY(result);
    olx_world_cut(world, OLX_TILE_EDGE, first);
    return find_space(world, threads);
  }
}

olx_result olx_space_create(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_space *space) {
  *space = (olx_space){.scene = scene};
  olx_world *world = olx_allocate(1, sizeof *world);
  if (!world) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  olx_result result = olx_world_create_small(scene, resolution, threads, world);
  if (result == OLX_OK) result = olx_space_open(world, 0, 0, threads, space);
  space->owns_world = result == OLX_OK;
  if (result == OLX_OK) return OLX_OK;
  olx_world_free(world);
  olx_release(world);
  space->world = NULL;
  return result;
}
