#include "shade/relighter.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"

#include <assert.h>
#include <string.h>

enum {
  INITIAL_FIT_STEPS = 48,
  FIT_FRAMES = 8,
  BLOCK_SIDE = 2,
  LOOKUP_SIDE = 4,
  SALT_SURFACE = 0x53555246
};

// Surfaces are known to within half a unit in the last place of their distance's half float: rays start this share of it off them.
static const float OFF_SURFACE = 0x1p-10f;
// Texels of a block share a look-up of irradiance where they lie in one plane to this share of their distance.
static const float SHARED_PLANE = 0.01f;

olx_relight_settings olx_relight_settings_default(void) {
  return (olx_relight_settings){
      .surface_texels = 262144, .radiance_texels = 65536, .light_samples = 1, .fit_steps = 6, .sleep = 0.004f};
}

static olx_result check_settings(const olx_relight_settings *s) {
  if (s->surface_texels < 1) return olx_fail(OLX_ERROR_ARGUMENT, "relight: 0 texels a frame");
  if (s->light_samples < 1 || s->light_samples > 64) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: light samples %u: must be from 1 to 64", s->light_samples);
  }
  if (s->fit_steps > 64) return olx_fail(OLX_ERROR_ARGUMENT, "relight: fit steps %u: at most 64", s->fit_steps);
  if (!(s->history >= 0.0f && s->history <= 0.95f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: history %g is not in 0..0.95", (double)s->history);
  }
  if (!(s->sleep >= 0.0f && s->sleep <= 1.0f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: sleep %g is not in 0..1", (double)s->sleep);
  }
  if (!(s->near_metres >= 0.0f && isfinite(s->near_metres))) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: near distance %g metres", (double)s->near_metres);
  }
  return OLX_OK;
}

static bool known_distance(uint16_t distance) { return distance < 0x7C00u; }

// Light that left a surface at bake time: as the nearest light field probe that sees it has it, without an emitter's.
static bool baked_radiance(const olx_relight *r, olx_vec3 place, olx_vec3 *radiance) {
  const olx_field *f = r->source;
  float nearest = INFINITY;
  for (uint32_t probe = 0; probe < r->counts[1]; probe++) {
    if (r->probes[1][probe].buried) continue;
    const olx_vec3 offset = olx_sub(place, f->probe_positions[probe]);
    const float length = olx_length(offset);
    if (!(length < nearest)) continue;
    const size_t texel = olx_texel_towards(f, offset);
    if (fabsf(olx_texel_distance(f, probe, texel) - length) > 0.02f * length) continue;
    if (f->distance[f->texels * probe + texel] & 0x8000u) continue;
    nearest = length;
    *radiance = olx_r11g11b10f_unpack(f->radiance[f->texels * probe + texel]);
  }
  return nearest < INFINITY;
}

typedef struct surface_view {
  olx_vec3 place, normal, view, albedo;
  float distance; // metres; infinite for the sky
} surface_view;

// Seen by no probe: at no distance, so that it shares its look-up with no other, whose neighbour it hardly is.
static surface_view view_hidden(const olx_relight *r, uint32_t probe, size_t i) {
  const olx_hidden_surface *s = &r->source->relight.hidden_surfaces[(size_t)r->hidden * probe + i];
  if (s->normal == OLX_FIT_NO_POINT) return (surface_view){.distance = INFINITY};
  const olx_vec3 normal = olx_normal_unpack((uint16_t)s->normal);
  return (surface_view){s->position, normal, normal, olx_relit_albedo(s->albedo), 0.0f};
}

// Surface `i` of an irradiance probe, moved a little off.
static surface_view view_surface(const olx_relight *r, uint32_t probe, uint32_t i) {
  if (i >= r->surfaces) return view_hidden(r, probe, i - r->surfaces);
  const olx_field *f = r->source;
  const uint32_t n = f->relight.size;
  const olx_surface_sample *s = &f->relight.surfaces[r->surfaces * probe + i];
  if (!known_distance(s->distance)) return (surface_view){.distance = INFINITY};
  const olx_vec3 direction = olx_surface_direction(i % n, i / n, n), normal = olx_normal_unpack(s->normal);
  const float distance = olx_half_unpack(s->distance) * f->distance_scale;
  const olx_vec3 place = olx_madd(f->irradiance_positions[probe], direction, distance);
  return (surface_view){olx_madd(place, normal, OFF_SURFACE * distance), normal, olx_negate(direction),
                        olx_relit_albedo(s->albedo), distance};
}

static olx_vec3 look_up(const olx_relight *r, const surface_view *v) {
  return olx_irradiance_terms(&r->irradiance, OLX_WEIGHT_ALL, false, v->place, v->normal, v->view);
}

static bool alike(const surface_view *a, const surface_view *b) {
  return olx_dot(a->normal, b->normal) > 0.995f &&
         fabsf(olx_dot(olx_sub(a->place, b->place), a->normal)) < SHARED_PLANE * a->distance;
}

// Texel k of a block of side x side that is number `block` in a map of n x n.
static uint32_t block_texel(uint32_t block, uint32_t k, uint32_t side, uint32_t n) {
  const uint32_t blocks = n / side;
  return (block / blocks * side + k / side) * n + block % blocks * side + k % side;
}

// The surface of a probe that is number `at` when maps go in blocks.
static uint32_t block_surface(const olx_relight *r, uint32_t at) {
  const uint32_t per_block = BLOCK_SIDE * BLOCK_SIDE;
  if (at >= r->surfaces) return at;
  return block_texel(at / per_block, at % per_block, BLOCK_SIDE, r->source->relight.size);
}

// The surfaces of a probe from number `first` to before `end`, in blocks: direct light.
static void light_surfaces(olx_relight *r, uint32_t probe, uint32_t first, uint32_t end) {
  olx_relit_probe *p = &r->probes[0][probe];
  const bool fixed = p->rounds == 0, varying = r->varying && p->rounds < OLX_RELIT_ROUNDS;
  if (!fixed && !varying) return;
  olx_relit_batch batch = {.count = 0};
  for (uint32_t at = first; at < end; at++) {
    const uint32_t i = block_surface(r, at);
    const surface_view v = view_surface(r, probe, i);
    const size_t index = olx_relit_surface_index(r, probe, i);
    if (fixed) r->direct[index] = r->varying_direct[index] = olx_splat(0.0f);
    if (!(v.distance < INFINITY)) continue;
    const uint32_t k = batch.count++;
    batch.position[k] = v.place;
    batch.normal[k] = v.normal;
    batch.seed[k] = olx_hash3(probe, at / 16, SALT_SURFACE);
    batch.sequence[k] = at % 16 + 16 * p->rounds;
    batch.slot[k] = i;
  }
  olx_relit_direct(r, &batch, fixed, varying);
  for (uint32_t k = 0; k < batch.count; k++) {
    const size_t index = olx_relit_surface_index(r, probe, batch.slot[k]);
    if (fixed) r->direct[index] = batch.fixed[k];
    if (varying) {
      r->varying_direct[index] = olx_mix3(r->varying_direct[index], batch.varying[k], 1.0f / (float)(p->rounds + 1));
    }
  }
}

// And what they reflect of it and of the irradiance that there is.
static void reflect_surfaces(olx_relight *r, uint32_t probe, uint32_t first, uint32_t end) {
  surface_view leader = {.distance = INFINITY};
  olx_vec3 irradiance = {0};
  uint64_t lookups = 0;
  for (uint32_t at = first; at < end; at++) {
    const uint32_t i = block_surface(r, at);
    const surface_view v = view_surface(r, probe, i);
    const size_t index = olx_relit_surface_index(r, probe, i);
    r->radiance[index] = olx_splat(0.0f);
    if (at % (BLOCK_SIDE * BLOCK_SIDE) == 0) leader.distance = INFINITY;
    if (!(v.distance < INFINITY)) continue;
    if (!(leader.distance < INFINITY) || !alike(&leader, &v)) {
      irradiance = look_up(r, &v);
      leader = v;
      lookups++;
    }
    const olx_vec3 light = olx_add(irradiance, olx_add(r->direct[index], r->varying_direct[index]));
    r->radiance[index] = olx_scale(olx_mul(v.albedo, light), 1.0f / OLX_PI);
  }
  atomic_fetch_add_explicit(&r->lookups, lookups, memory_order_relaxed);
}

static uint32_t batches_of(const olx_relight *r) {
  return (uint32_t)((olx_relit_surfaces(r) + OLX_RELIT_BATCH - 1) / OLX_RELIT_BATCH);
}

static void surfaces_job(void *user, uint32_t index) {
  olx_relight *r = user;
  const uint32_t probe = r->scheduled[index / batches_of(r)], first = index % batches_of(r) * OLX_RELIT_BATCH;
  const uint32_t all = (uint32_t)olx_relit_surfaces(r), left = all - first;
  const uint32_t end = left < OLX_RELIT_BATCH ? all : first + OLX_RELIT_BATCH;
  light_surfaces(r, probe, first, end);
  reflect_surfaces(r, probe, first, end);
}

// Texel (x, y) of a light field map; what shines or is sky is left as it is.
static surface_view view_texel(const olx_relight *r, uint32_t probe, uint32_t x, uint32_t y) {
  const olx_field *f = r->source;
  const size_t texel = f->texels * probe + olx_map_index(f->stride, (int32_t)x, (int32_t)y);
  if (!known_distance(f->distance[texel])) return (surface_view){.distance = INFINITY};
  const olx_vec3 direction = olx_texel_direction(x, y, f->n), normal = olx_normal_unpack(f->normal[texel]);
  const float distance = olx_half_unpack(f->distance[texel]) * f->distance_scale;
  const olx_vec3 place = olx_madd(f->probe_positions[probe], direction, distance);
  return (surface_view){olx_madd(place, normal, OFF_SURFACE * distance), normal, olx_negate(direction),
                        olx_relit_albedo(f->relight.albedo[texel]), distance};
}

// One batch of texels of a tile, in blocks that share look-ups.
static void light_texels(olx_relight *r, uint32_t probe, uint32_t tile, uint32_t first, uint32_t count) {
  const uint32_t n = r->field.n, side = r->tile_side, tiles = n / side, per_block = LOOKUP_SIDE * LOOKUP_SIDE;
  const uint32_t x0 = tile % tiles * side, y0 = tile / tiles * side;
  olx_relit_batch batch = {.count = 0};
  surface_view views[OLX_RELIT_BATCH];
  for (uint32_t at = first; at < first + count; at++) {
    const uint32_t i = block_texel(at / per_block, at % per_block, LOOKUP_SIDE, side), x = x0 + i % side,
                   y = y0 + i / side;
    const surface_view v = view_texel(r, probe, x, y);
    if (!(v.distance < INFINITY)) continue;
    const uint32_t k = batch.count++;
    views[k] = v;
    batch.position[k] = v.place;
    batch.normal[k] = v.normal;
    batch.seed[k] = olx_hash3(probe, tile * side * side + at / 16, SALT_SURFACE + 1);
    batch.sequence[k] = at % 16;
    batch.slot[k] = at;
  }
  olx_relit_direct(r, &batch, true, true);
  uint32_t leader = 0, lookups = 0;
  olx_vec3 irradiance = {0};
  for (uint32_t k = 0; k < batch.count; k++) {
    if (k == 0 || batch.slot[k] / per_block != batch.slot[leader] / per_block || !alike(&views[leader], &views[k])) {
      irradiance = look_up(r, &views[k]);
      leader = k;
      lookups++;
    }
    const olx_vec3 light = olx_add(irradiance, olx_add(batch.fixed[k], batch.varying[k]));
    const uint32_t i = block_texel(batch.slot[k] / per_block, batch.slot[k] % per_block, LOOKUP_SIDE, side);
    const size_t texel = olx_map_index(r->field.stride, (int32_t)(x0 + i % side), (int32_t)(y0 + i / side));
    r->packed_radiance[r->field.texels * probe + texel] =
        olx_r11g11b10f_pack(olx_scale(olx_mul(views[k].albedo, light), 1.0f / OLX_PI));
  }
  atomic_fetch_add_explicit(&r->lookups, lookups, memory_order_relaxed);
}

static void texels_job(void *user, uint32_t index) {
  olx_relight *r = user;
  const uint32_t texels = r->tile_side * r->tile_side;
  const olx_relit_tile tile = r->tiles[index];
  for (uint32_t first = 0; first < texels; first += OLX_RELIT_BATCH) {
    const uint32_t left = texels - first;
    light_texels(r, tile.probe, tile.tile, first, left < OLX_RELIT_BATCH ? left : OLX_RELIT_BATCH);
  }
  r->tile_frames[(size_t)tile.probe * (r->tiles_a_probe + 1) + tile.tile] = r->frame;
}

static void map_job(void *user, uint32_t index) {
  olx_relight *r = user;
  const uint32_t probe = r->scheduled[index];
  olx_relit_gather(r, probe, r->probes[0][probe].updates > 0 ? r->settings.history : 0.0f);
  if (r->fit.count) olx_relit_fit_measure(r, probe);
}

static void finish_job(void *user, uint32_t probe) { olx_relit_finish_map(user, probe); }

static void fill_tile_borders(olx_relight *r) {
  for (uint32_t i = 0; i < r->tile_count; i++) {
    if (i > 0 && r->tiles[i].probe == r->tiles[i - 1].probe) continue;
    const uint32_t probe = r->tiles[i].probe;
    olx_relit_fill_border(r->packed_radiance + r->field.texels * probe, r->field.n);
    r->tile_frames[(size_t)(probe + 1) * (r->tiles_a_probe + 1) - 1] = r->frame;
  }
}

uint32_t olx_relit_count_awake(const olx_relight *r) {
  uint32_t awake = r->current != UINT32_MAX;
  for (uint32_t kind = 0; kind < 2; kind++) {
    for (uint32_t i = 0; i < r->counts[kind]; i++) {
      const bool counted = kind == 1 && i == r->current;
      awake += !counted && olx_relit_awake(r, &r->probes[kind][i]) && (kind == 0 || r->tile_most > 0);
    }
  }
  return awake;
}

bool olx_relit_fits(olx_relight *r) {
  if (r->scheduled_count) r->fit_frames = FIT_FRAMES;
  if (r->fit_frames == 0) return false;
  r->fit_frames--;
  return true;
}

void olx_relit_count_updates(olx_relight *r) {
  for (uint32_t i = 0; i < r->scheduled_count; i++) {
    olx_relit_probe *probe = &r->probes[0][r->scheduled[i]];
    probe->rounds++;
    probe->updates++;
    probe->last_frame = r->frame;
  }
}

// Irradiance maps, fitted, of what the surfaces now send.
static olx_result update_maps(olx_relight *r) {
  const uint32_t threads = r->settings.threads;
  if (!olx_relit_fits(r)) return OLX_OK;
  OLX_TRY(olx_parallel_for(r->scheduled_count, threads, map_job, r, NULL, 0));
  OLX_TRY(olx_relit_fit_solve(r, r->settings.fit_steps));
  OLX_TRY(olx_parallel_for(r->counts[0], threads, finish_job, r, NULL, 0));
  olx_relit_count_updates(r);
  olx_relit_pass_on(r);
  return OLX_OK;
}

void olx_relit_begin_frame(olx_relight *r, olx_vec3 eye) {
  r->frame++;
  if (!olx_finite(eye)) eye = olx_scale(olx_add(r->field.info.scene_min, r->field.info.scene_max), 0.5f);
  olx_relit_schedule(r, eye);
}

olx_result olx_relight_frame(olx_relight *r, olx_vec3 eye, olx_relight_stats *stats) {
  assert(r);
  if (r->on_device) return olx_fail(OLX_ERROR_ARGUMENT, "relight: its frames are made on a device");
  const double start = olx_seconds();
  atomic_store(&r->shadow_rays, 0);
  atomic_store(&r->lookups, 0);
  olx_relit_begin_frame(r, eye);
  const uint32_t threads = r->settings.threads;
  OLX_TRY(olx_parallel_for(r->scheduled_count * batches_of(r), threads, surfaces_job, r, NULL, 0));
  OLX_TRY(olx_parallel_for(r->tile_count, threads, texels_job, r, NULL, 0));
  fill_tile_borders(r);
  OLX_TRY(update_maps(r));
  if (stats) {
    *stats = (olx_relight_stats){.irradiance_probes = r->scheduled_count,
                                 .surface_texels = r->scheduled_count * olx_relit_surfaces(r),
                                 .radiance_texels = (uint64_t)r->tile_count * r->tile_side * r->tile_side,
                                 .shadow_rays = atomic_load(&r->shadow_rays),
                                 .lookups = atomic_load(&r->lookups),
                                 .awake = olx_relit_count_awake(r),
                                 .seconds = olx_seconds() - start};
  }
  return OLX_OK;
}

static bool is_light(const olx_relight_light *l) {
  const bool finite = olx_finite(l->emission) && olx_is_position(l->position) && olx_finite(l->direction) &&
                      olx_finite(l->edge_u) && olx_finite(l->edge_v);
  if (!finite || l->emission.x < 0.0f || l->emission.y < 0.0f || l->emission.z < 0.0f) return false;
  if (l->type == OLX_RELIGHT_SUN || l->type == OLX_RELIGHT_SPOT) {
    if (fabsf(olx_length(l->direction) - 1.0f) > 1e-3f) return false;
  }
  return l->type != OLX_RELIGHT_SPOT || (l->cosine_outer >= -1.0f && l->cosine_outer <= l->cosine_inner);
}

olx_result olx_relight_set_lights(olx_relight *r, const olx_relight_light *lights, uint32_t count) {
  assert(r && (lights || count == 0));
  if (count > OLX_RELIT_MOST_LIGHTS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: %u lights: at most %d", count, OLX_RELIT_MOST_LIGHTS);
  }
  for (uint32_t i = 0; i < count; i++) {
    if ((uint32_t)lights[i].type > OLX_RELIGHT_SKY || !is_light(&lights[i])) {
      return olx_fail(OLX_ERROR_ARGUMENT, "relight: light %u: its type, a number or a direction is out of range", i);
    }
  }
  if (count) memcpy(r->lights, lights, count * sizeof *lights);
  r->light_count = count;
  r->light_changes++;
  r->field.info.scene_hash = 0;
  r->varying = false;
  for (uint32_t i = 0; i < count; i++) r->varying |= lights[i].type >= OLX_RELIGHT_RECT;
  olx_relit_wake_all(r);
  return OLX_OK;
}

const olx_field *olx_relight_field(const olx_relight *r) { return &r->field; }

static olx_relight_state state_of(const olx_relight *r, uint32_t set, uint32_t probe) {
  if (probe >= r->counts[set]) return (olx_relight_state){.updates = 0};
  const olx_relit_probe *p = &r->probes[set][probe];
  const uint32_t since = p->last_frame > p->woke_frame ? p->last_frame : p->woke_frame;
  return (olx_relight_state){p->updates, p->last_frame, r->frame - since, olx_relit_awake(r, p)};
}

olx_relight_state olx_relight_irradiance_state(const olx_relight *r, uint32_t probe) {
  return state_of(r, 0, probe);
}

olx_relight_state olx_relight_radiance_state(const olx_relight *r, uint32_t probe) {
  return state_of(r, 1, probe);
}

void olx_relight_free(olx_relight *r) {
  if (!r) return;
  olx_relit_fit_free(&r->fit);
  void *const blocks[] = {r->lights,       r->probes[0],       r->probes[1],        r->scheduled,
                          r->in_frame,     r->tiles,           r->shares.starts,    r->shares.probes,
                          r->shares.share, r->direct,          r->radiance,         r->varying_direct,
                          r->moment[0],    r->moment[1],       r->moment[2],        r->exact,
                          r->maps,         r->surface_share,   r->changed,          r->mean,
                          r->unpacked,     r->packed_radiance, r->packed_irradiance,
                          r->map_frames,   r->tile_frames};
  for (uint32_t i = 0; i < sizeof blocks / sizeof *blocks; i++) olx_release(blocks[i]);
  olx_release(r);
}

static olx_result make_probes(olx_relight *r) {
  const olx_field *f = r->source;
  for (uint32_t kind = 0; kind < 2; kind++) {
    r->counts[kind] = kind ? f->info.probe_count : f->info.irradiance_probe_count;
    r->probes[kind] = olx_allocate_zero(r->counts[kind], sizeof **r->probes);
    if (!r->probes[kind]) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
    for (uint32_t i = 0; i < r->counts[kind]; i++) {
      r->probes[kind][i].position = kind ? f->probe_positions[i] : f->irradiance_positions[i];
      r->probes[kind][i].buried = (kind ? f->probe_flags[i] : f->irradiance_flags[i]) & OLX_PROBE_BURIED;
      r->probes[kind][i].rounds = OLX_RELIT_ROUNDS;
    }
  }
  return OLX_OK;
}

static uint32_t rounded_up(uint32_t texels, size_t unit, uint64_t most) {
  const uint64_t units = (texels + unit - 1) / unit;
  return (uint32_t)(units < most ? units : most);
}

// Sizes that follow from field and settings.
static void choose_sizes(olx_relight *r) {
  const olx_field *f = r->source;
  const uint32_t size = f->relight.size, irradiance_n = f->irradiance_n;
  r->surfaces = (size_t)size * size;
  r->cells = size < OLX_RELIT_CELLS_MOST ? size : OLX_RELIT_CELLS_MOST;
  r->map_size = irradiance_n < OLX_RELIT_MAP_MOST ? irradiance_n : OLX_RELIT_MAP_MOST;
  r->map_texels = (size_t)(r->map_size + 2) * (r->map_size + 2);
  r->tile_side = f->n < OLX_RELIT_TILE_SIDE ? f->n : OLX_RELIT_TILE_SIDE;
  r->tiles_a_probe = f->n / r->tile_side * (f->n / r->tile_side);
  r->scheduled_most = rounded_up(r->settings.surface_texels, olx_relit_surfaces(r), r->counts[0]);
  r->tile_most = rounded_up(r->settings.radiance_texels, (size_t)r->tile_side * r->tile_side,
                            (uint64_t)r->counts[1] * r->tiles_a_probe);
  r->near_metres = r->settings.near_metres;
  const float diagonal = olx_length(olx_sub(f->info.scene_max, f->info.scene_min));
  if (r->near_metres <= 0.0f) r->near_metres = olx_max(0.125f * diagonal, 1e-18f);
}

static olx_result allocate_maps(olx_relight *r) {
  const size_t probes = r->counts[0], surfaces = olx_relit_surface_count(r);
  r->lights = olx_allocate(OLX_RELIT_MOST_LIGHTS, sizeof *r->lights);
  r->scheduled = olx_allocate(r->scheduled_most, sizeof *r->scheduled);
  r->in_frame = olx_allocate_zero(probes, sizeof *r->in_frame);
  r->tiles = olx_allocate(r->tile_most, sizeof *r->tiles);
  r->direct = olx_allocate_zero(surfaces, sizeof *r->direct);
  r->varying_direct = olx_allocate_zero(surfaces, sizeof *r->varying_direct);
  r->radiance = olx_allocate_zero(surfaces, sizeof *r->radiance);
  r->exact = olx_allocate(probes * r->map_size * r->map_size, sizeof *r->exact);
  r->maps = olx_allocate(probes * r->map_texels, sizeof *r->maps);
  r->changed = olx_allocate_zero(probes, sizeof *r->changed);
  r->mean = olx_allocate_zero(probes, sizeof *r->mean);
  r->unpacked = olx_allocate_zero(probes, sizeof *r->unpacked);
  r->packed_irradiance = olx_allocate(probes * r->field.irradiance_texels, sizeof *r->packed_irradiance);
  r->map_frames = olx_allocate_zero(probes, sizeof *r->map_frames);
  r->tile_frames = olx_allocate_zero((size_t)r->counts[1] * (r->tiles_a_probe + 1), sizeof *r->tile_frames);
  const bool radiance = r->tile_most > 0;
  if (radiance) r->packed_radiance = olx_allocate((size_t)r->counts[1] * r->field.texels, sizeof *r->packed_radiance);
  if (!r->lights || !r->scheduled || !r->in_frame || !r->tiles || !r->direct || !r->varying_direct || !r->radiance ||
      !r->exact || !r->maps || !r->changed || !r->mean || !r->unpacked || !r->packed_irradiance ||
      !r->map_frames || !r->tile_frames || (radiance && !r->packed_radiance)) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for the maps of %u and %u probes", r->counts[0],
                    r->counts[1]);
  }
  return OLX_OK;
}

// Surfaces and maps as they were baked.
static void start_job(void *user, uint32_t probe) {
  olx_relight *r = user;
  for (uint32_t i = 0; i < olx_relit_surfaces(r); i++) { // rays to places that are empty have no light
    const surface_view v = view_surface(r, probe, i);
    olx_vec3 *radiance = &r->radiance[olx_relit_surface_index(r, probe, i)];
    if (!(v.distance < INFINITY) || baked_radiance(r, v.place, radiance)) continue;
    *radiance = olx_scale(olx_mul(v.albedo, look_up(r, &v)), 1.0f / OLX_PI);
  }
}

static void read_job(void *user, uint32_t probe) { olx_relit_read_map(user, probe); }

static void start_map_job(void *user, uint32_t probe) {
  olx_relit_gather(user, probe, 0.0f);
  olx_relit_fit_measure(user, probe);
}

static void copy_maps(olx_relight *r) {
  const olx_field *f = r->source;
  memcpy(r->packed_irradiance, f->irradiance, r->counts[0] * f->irradiance_texels * sizeof *f->irradiance);
  r->field.irradiance = r->packed_irradiance;
  if (!r->packed_radiance) return;
  memcpy(r->packed_radiance, f->radiance, r->counts[1] * f->texels * sizeof *f->radiance);
  r->field.radiance = r->packed_radiance;
}

// Hidden surfaces: that they can be, which opening a file does not make sure of, and how many of each probe are to be lit.
static olx_result read_hidden(olx_relight *r) {
  const olx_relight_maps *maps = &r->source->relight;
  uint32_t most = 0;
  for (size_t i = 0; i < (size_t)maps->hidden * r->counts[0]; i++) {
    const olx_hidden_surface *s = &maps->hidden_surfaces[i];
    const uint32_t place = (uint32_t)(i % maps->hidden);
    if (s->normal == OLX_FIT_NO_POINT) continue;
    if (s->normal > UINT16_MAX || !olx_finite(s->position)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk HIDN: surface %u of probe %u is impossible", r->source->name, place,
                      (uint32_t)(i / maps->hidden));
    }
    most = place >= most ? place + 1 : most;
  }
  const bool lit = r->settings.occlusion != NULL;
  r->hidden = lit ? maps->hidden : 0;
  r->hidden_most = lit ? most : 0;
  return OLX_OK;
}

static olx_result build(olx_relight *r) {
  const olx_field *f = r->source;
  const uint32_t threads = r->settings.threads;
  OLX_TRY(make_probes(r));
  OLX_TRY(read_hidden(r));
  choose_sizes(r);
  OLX_TRY(allocate_maps(r));
  copy_maps(r);
  r->irradiance = (olx_irradiance_source){.grid = f->info.irradiance_grid,
                                          .flags = f->irradiance_flags,
                                          .distance_scale = f->distance_scale,
                                          .irradiance_n = r->map_size,
                                          .moments_n = f->irradiance_n,
                                          .irradiance = r->maps,
                                          .packed_moments = f->moments};
  OLX_TRY(olx_relit_make_quadrature(r));
  OLX_TRY(olx_parallel_for(r->counts[0], threads, read_job, r, NULL, 0));
  OLX_TRY(olx_parallel_for(r->counts[0], threads, start_job, r, NULL, 0));
  OLX_TRY(olx_relit_find_shares(r));
  OLX_TRY(olx_relit_fit_create(r));
  if (!r->fit.count) return OLX_OK;
  // The corrections that these surfaces' light asks for, so that the first updates find theirs almost right.
  OLX_TRY(olx_parallel_for(r->counts[0], threads, start_map_job, r, NULL, 0));
  return olx_relit_fit_solve(r, INITIAL_FIT_STEPS);
}

olx_result olx_relight_create(const olx_field *field, const olx_relight_settings *settings, olx_relight **relight) {
  assert(field && settings && relight);
  *relight = NULL;
  OLX_TRY(check_settings(settings));
  if (!field->relight.size) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: baked without what relighting needs (bake --relight)", field->name);
  }
  olx_relight *r = olx_allocate_zero(1, sizeof *r);
  if (!r) return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
  r->source = field;
  r->field = *field;
  r->field.relit = true;
  r->settings = *settings;
  r->sample = olx_sample_settings_default();
  r->current = UINT32_MAX;
  const olx_result result = build(r);
  if (result != OLX_OK) {
    olx_relight_free(r);
    return result;
  }
  *relight = r;
  return OLX_OK;
}
