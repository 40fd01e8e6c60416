// Fills the texels of a light field probe with the surfaces that they see: material and emission by rays, direct light
// by shadow rays, indirect light by the solution or by paths from every texel, and radiance that these send to the
// probe.
#include "bake/capture/surface_capture.h"

#include "bake/capture/sky_tiles.h"
#include "bake/capture/texel_light.h"
#include "bake/capture/texel_radiance.h"
#include "core/hooks.h"
#include "core/result.h"
#include "field/lights.h"
#include "field/texels.h"
#include "light/path.h"
#include "scene/texel_samples.h"

#include <string.h>

enum { SALT_PATHS = 0x50415448, SALT_LOBE = 0x4C4F4245 };

// A texel, and what rays through the parts of it met.
typedef struct texel_samples {
  uint32_t x, y;
  olx_sky_guide *sky; // of its tile; NULL: none
  const olx_ray *rays;
  const olx_ray_hit *hits;
} texel_samples;

// The material's numbers, summed over the samples that lie on the texel's surface, direct light, and what narrow
// specular lobes reflect to the probe.
typedef struct surface_sums {
  olx_vec3 base_color, direct, mirrored;
  double direct_squares; // of the luminance of direct light
  float roughness, metallic, count;
} surface_sums;

static const olx_scene *scene_of(const olx_surface_capture *c) { return c->capture->context->scene; }

static const olx_bake_settings *settings_of(const olx_surface_capture *c) { return c->capture->context->settings; }

static size_t sky_guides(const olx_surface_capture *c) {
  return olx_environment_lit(scene_of(c)) ? (size_t)OLX_SKY_TILES * OLX_SKY_TILES : 0;
}

static bool has_radiance(const olx_surface_capture *c) { return c->capture->context->probes.irradiance.count > 0; }

static uint32_t texel_index(const olx_surface_capture *c, const texel_samples *t) {
  return t->y * c->capture->size + t->x;
}

// Returns the direct irradiance at sample `k` of a texel.
static olx_vec3 direct_light(const olx_surface_capture *c, const texel_samples *t, uint32_t k,
                             const olx_surface *surface, uint64_t *rays) {
  const olx_capture *capture = c->capture;
  const uint32_t lights = settings_of(c)->light_samples;
  const olx_sampler first = olx_texel_light_sampler(capture->probe, settings_of(c)->seed, t->x, t->y, capture->size,
                                                    settings_of(c)->samples, k, lights);
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < lights; i++) {
    olx_sampler sampler = {.seed = first.seed, .index = first.index + i};
    sum = olx_add(sum, olx_direct_irradiance(scene_of(c), surface, t->sky, &sampler, rays));
  }
  return olx_scale(sum, 1.0f / (float)lights);
}

static void add_sample(const olx_surface_capture *c, const texel_samples *t, uint32_t k, const olx_ray_hit *hit,
                       const olx_surface *surface, surface_sums *sums, uint64_t *rays) {
  const olx_surface s = olx_texel_smooth_surface(scene_of(c), hit, surface);
  sums->base_color = olx_add(sums->base_color, s.base_color);
  sums->roughness += s.roughness;
  sums->metallic += s.metallic;
  const olx_vec3 direct = direct_light(c, t, k, &s, rays);
  sums->direct = olx_add(sums->direct, direct);
  sums->direct_squares += (double)olx_square(olx_luminance(direct));
  sums->count += 1.0f;
  if (!c->radiance || !olx_texel_is_mirror(&surface->bsdf)) return;
  const uint32_t seed = olx_hash3(c->capture->probe, texel_index(c, t), SALT_LOBE) ^ settings_of(c)->seed;
  const olx_lobe_source source = {scene_of(c), c->light, settings_of(c)->bounces};
  olx_sampler sampler = {.seed = seed, .index = k};
  sums->mirrored = olx_add(sums->mirrored, olx_texel_mirrored(&source, surface, t->rays[k].direction, &sampler, rays));
}

// Returns the light that has 1 to bounces + 1 surfaces between emitter and texel.
static olx_vec3 indirect_light(const olx_surface_capture *c, const texel_samples *t, const olx_surface *surface,
                               uint64_t *rays) {
  const olx_capture *capture = c->capture;
  const uint32_t texel = texel_index(c, t);
  if (c->light) return c->irradiance[texel];
  const uint32_t seed = olx_hash3(capture->probe, texel, SALT_PATHS) ^ settings_of(c)->seed;
  return olx_path_surface_irradiance(scene_of(c), surface, settings_of(c)->bounces + 1, settings_of(c)->reference_paths,
                                     seed, rays);
}

// Returns the emission of the samples that emit, as the texel's middle does: a surface beside a lamp gets none of the
// lamp's emission.
static olx_vec3 mean_emission(const olx_surface_capture *c, const texel_samples *t, olx_vec3 middle, bool sky) {
  const olx_scene *scene = scene_of(c);
  const uint32_t per_texel = settings_of(c)->samples * settings_of(c)->samples;
  olx_vec3 sum = {0};
  float count = 0.0f;
  for (uint32_t k = 0; k < per_texel; k++) {
    if (sky != (t->hits[k].triangle == OLX_NO_HIT)) continue;
    const olx_vec3 emission = sky ? olx_environment_radiance(scene, t->rays[k].direction)
                                  : olx_surface_at(scene, &t->hits[k], t->rays[k].direction).emission;
    if (!sky && olx_max3(emission) <= 0.0f) continue;
    sum = olx_add(sum, emission);
    count += 1.0f;
  }
  return count > 0.0f ? olx_scale(sum, 1.0f / count) : middle;
}

static void store_surface(const olx_surface_capture *c, uint32_t at, const olx_surface *middle,
                          const surface_sums *sums, olx_vec3 indirect) {
  const float share = 1.0f / sums->count;
  const olx_texel_material_codes codes = olx_material_pack(olx_scale(sums->base_color, share), sums->roughness * share,
                                                           sums->metallic * share, middle->bsdf.dielectric_weight);
  c->base[at] = codes.base;
  c->specular[at] = codes.specular;
  c->indirect[at] = olx_rgb9e5_pack(indirect);
}

static olx_direct_estimate estimate_of(const surface_sums *sums) {
  const olx_vec3 mean = olx_scale(sums->direct, 1.0f / sums->count);
  const double squares = sums->direct_squares - (double)sums->count * (double)olx_square(olx_luminance(mean));
  return (olx_direct_estimate){mean, olx_max((float)squares, 0.0f), (uint32_t)sums->count};
}

// Stores what the surface reflects to the probe, computed from the material and the light that are stored for it.
static void store_radiance(const olx_surface_capture *c, uint32_t at, const olx_surface *middle, olx_vec3 direction,
                           const surface_sums *sums, olx_vec3 indirect) {
  if (!c->radiance) return;
  const float share = 1.0f / sums->count;
  const olx_bsdf bsdf = olx_material_unpack((olx_texel_material_codes){c->base[at], c->specular[at]});
  const olx_vec3 irradiance = olx_madd(olx_scale(sums->direct, share), indirect, 1.0f - c->last_bounce);
  const olx_vec3 reflected = olx_texel_reflected(&bsdf, -olx_dot(middle->shading_normal, direction), irradiance);
  c->radiance[at] = olx_r11g11b10f_pack(olx_madd(reflected, sums->mirrored, share));
}

// Stores the emission of the texel, which radiance includes as well.
static void store_emission(const olx_surface_capture *c, uint32_t at, olx_vec3 emission) {
  c->emission[at] = olx_rgb9e5_pack(emission);
  if (c->radiance) c->radiance[at] = olx_r11g11b10f_pack(olx_add(olx_r11g11b10f_unpack(c->radiance[at]), emission));
}

static void capture_texel(olx_surface_capture *c, const texel_samples *t, uint64_t *rays) {
  const olx_capture *capture = c->capture;
  const olx_scene *scene = scene_of(c);
  const uint32_t at = texel_index(c, t), per_texel = settings_of(c)->samples * settings_of(c)->samples;
  const olx_vec3 direction = olx_texel_direction(t->x, t->y, capture->size);
  const olx_ray_hit *hit = &capture->hits[at];
  c->base[at] = c->direct[at] = c->indirect[at] = c->emission[at] = 0;
  c->specular[at] = 0;
  c->estimates[at] = (olx_direct_estimate){.count = 0};
  if (hit->triangle == OLX_NO_HIT) {
    if (c->radiance) c->radiance[at] = 0;
    store_emission(c, at, mean_emission(c, t, olx_environment_radiance(scene, direction), true));
    return;
  }
  const olx_surface middle = olx_surface_at(scene, hit, direction);
  const float tolerance = olx_texel_tolerance(&middle, hit->t, capture->size);
  surface_sums sums = {0};
  for (uint32_t k = 0; k < per_texel; k++) {
    if (t->hits[k].triangle == OLX_NO_HIT) continue;
    const olx_surface sample = olx_surface_near(scene, &t->hits[k], t->rays[k].direction, &middle);
    if (olx_texel_is_on_surface(&middle, &sample, tolerance)) add_sample(c, t, k, &t->hits[k], &sample, &sums, rays);
  }
  if (sums.count == 0.0f) add_sample(c, t, 0, hit, &middle, &sums, rays);
  const olx_surface lit = olx_texel_smooth_surface(scene, hit, &middle);
  const olx_vec3 indirect = indirect_light(c, t, &lit, rays);
  store_surface(c, at, &middle, &sums, indirect);
  c->estimates[at] = estimate_of(&sums);
  store_radiance(c, at, &middle, direction, &sums, indirect);
  if (olx_max3(middle.emission) > 0.0f) store_emission(c, at, mean_emission(c, t, middle.emission, false));
}

static void capture_row(void *user, uint32_t y) {
  olx_surface_capture *c = user;
  const uint32_t per_texel = settings_of(c)->samples * settings_of(c)->samples;
  olx_ray rays[OLX_CAPTURE_MOST_RAYS];
  olx_ray_hit hits[OLX_CAPTURE_MOST_RAYS];
  uint64_t cast = 0;
  olx_sky_guide own; // the tile's, which other rows use as well
  for (uint32_t x = 0; x < c->capture->size; x += OLX_CAPTURE_CHUNK) {
    if (c->skies) own = c->skies[olx_sky_tile_of(c->capture->size, x, y)];
    cast += olx_capture_cast_samples(c->capture, x, y, rays, hits);
    for (uint32_t i = 0; i < OLX_CAPTURE_CHUNK; i++) {
      const texel_samples t = {x + i, y, c->skies ? &own : NULL, rays + (size_t)i * per_texel,
                               hits + (size_t)i * per_texel};
      capture_texel(c, &t, &cast);
    }
  }
  atomic_fetch_add_explicit(&c->rays, cast, memory_order_relaxed);
}

static void store_direct_row(void *user, uint32_t y) {
  olx_surface_capture *c = user;
  for (uint32_t at = y * c->capture->size; at < (y + 1) * c->capture->size; at++) {
    if (c->estimates[at].count) c->direct[at] = olx_rgb9e5_pack(c->estimates[at].mean);
  }
}

// Stores the direct light of all texels, without noise where samples of lights vary.
static olx_result store_direct(olx_surface_capture *c) {
  if (olx_emitters_can_be_hit(scene_of(c))) OLX_TRY(olx_direct_merge(c->capture, c->estimates));
  return olx_bake_for(c->capture->context, c->capture->size, store_direct_row, c, 0);
}

uint64_t olx_surface_capture_units(const olx_surface_capture *c) { return olx_capture_units(c->capture); }

// Finds the indirect irradiance of the probe's texels, where it is read from the solved light.
static olx_result find_irradiance(const olx_surface_capture *c, bool buried) {
  const size_t texels = (size_t)c->capture->size * c->capture->size;
  if (!c->light) return OLX_OK;
  if (!buried) return olx_light_texels(c->capture, c->light, c->rows, c->irradiance);
  memset(c->irradiance, 0, texels * sizeof *c->irradiance);
  return OLX_OK;
}

olx_result olx_surface_capture_probe(olx_surface_capture *c, bool buried, olx_surface_maps *maps) {
  const olx_capture *capture = c->capture;
  const uint32_t rows = capture->size;
  c->last_bounce = c->light ? (float)olx_scene_light_describe(c->light).last_bounce : 0.0f;
  OLX_TRY(find_irradiance(c, buried));
  if (c->skies) OLX_TRY(olx_sky_tiles_learn(capture, c->skies, &c->rays));
  OLX_TRY(olx_bake_for(capture->context, rows, capture_row, c, olx_surface_capture_units(c) / rows));
  OLX_TRY(store_direct(c));
  *maps = (olx_surface_maps){c->base, c->specular, c->direct, c->indirect, .emission = c->emission};
  if (settings_of(c)->uncompressed) return OLX_OK;
  const olx_surface_texels texels = {c->base, c->specular, c->direct, c->indirect, capture->distance};
  *maps = (olx_surface_maps){.tiled = c->tiles.maps, .emission = c->emission};
  OLX_TRY(olx_surface_maker_encode(&c->tiles, &texels, rows, settings_of(c)->threads));
  return olx_geometry_maker_encode(&c->geometry, rows, settings_of(c)->threads, olx_capture_geometry, capture);
}

uint64_t olx_surface_capture_bytes(const olx_surface_capture *c, bool solved) {
  const uint32_t size = c->capture->size;
  const uint64_t texel = sizeof *c->base + sizeof *c->direct + sizeof *c->indirect + sizeof *c->emission +
                         sizeof *c->specular + sizeof *c->estimates + (has_radiance(c) ? sizeof *c->radiance : 0) +
                         (solved ? sizeof *c->irradiance : 0);
  return (uint64_t)size * size * texel + sky_guides(c) * sizeof *c->skies +
         (settings_of(c)->uncompressed ? 0 : olx_surface_maker_bytes(size) + olx_geometry_maker_bytes(size));
}

olx_result olx_surface_capture_create(olx_surface_capture *c) {
  const size_t texels = (size_t)c->capture->size * c->capture->size;
  c->base = olx_allocate(texels, sizeof *c->base);
  c->direct = olx_allocate(texels, sizeof *c->direct);
  c->indirect = olx_allocate(texels, sizeof *c->indirect);
  c->emission = olx_allocate(texels, sizeof *c->emission);
  if (has_radiance(c)) c->radiance = olx_allocate(texels, sizeof *c->radiance);
  c->irradiance = olx_allocate(c->light ? texels : 0, sizeof *c->irradiance);
  c->specular = olx_allocate(texels, sizeof *c->specular);
  c->estimates = olx_allocate(texels, sizeof *c->estimates);
  if (sky_guides(c)) c->skies = olx_allocate(sky_guides(c), sizeof *c->skies);
  const bool complete = c->estimates && c->base && c->direct && c->indirect && c->emission && c->specular &&
                        c->irradiance && (c->skies || !sky_guides(c));
  if (complete && (c->radiance || !has_radiance(c))) {
    if (settings_of(c)->uncompressed) return OLX_OK;
    OLX_TRY(olx_surface_maker_create(c->capture->size, &c->tiles));
    return olx_geometry_maker_create(c->capture->size, &c->geometry);
  }
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for surfaces of %u x %u texels", c->capture->size,
                  c->capture->size);
}

void olx_surface_capture_free(olx_surface_capture *c) {
  olx_release(c->base);
  olx_release(c->direct);
  olx_release(c->indirect);
  olx_release(c->emission);
  olx_release(c->radiance);
  olx_release(c->irradiance);
  olx_release(c->specular);
  olx_release(c->estimates);
  olx_release(c->skies);
  olx_surface_maker_free(&c->tiles);
  olx_geometry_maker_free(&c->geometry);
  c->base = c->direct = c->indirect = c->emission = c->radiance = NULL;
  c->specular = NULL;
  c->irradiance = NULL;
  c->estimates = NULL;
  c->skies = NULL;
}

olx_result olx_surface_lights(const olx_scene *scene, olx_field_light **lights) {
  *lights = olx_allocate(scene->light_count ? scene->light_count : 1, sizeof **lights);
  if (!*lights) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u lights", scene->light_count);
  for (uint32_t i = 0; i < scene->light_count; i++) (*lights)[i] = olx_field_light_pack(&scene->lights[i]);
  return OLX_OK;
}
