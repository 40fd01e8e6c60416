// Solves the light of a scene by its steps (light_steps.c), and evaluates the irradiance of a surface.
#include "light/scene_light.h"

#include "core/hooks.h"
#include "core/result.h"
#include "light/solution/light_lookup.h"
#include "light/solution/light_steps.h"
#include "light/solution/light_units.h"

enum { LEAST_MAP_SIZE = 64 }; // smaller maps still get surfels this dense: light sampled more coarsely is biased

uint64_t olx_scene_light_most_link_bytes(void) {
  return olx_scene_light_settings_default().most_links * sizeof(olx_link);
}

olx_scene_light_settings olx_scene_light_settings_default(void) {
  return (olx_scene_light_settings){.bounces = OLX_BOUNCES_INFINITE,
                                    .noise = 0.02f,
                                    .spacing = 0.2f,
                                    .map_size = 512,
                                    .most_links = 1u << 27,
                                    .most_final_rays = 1u << 28};
}

static olx_result build(olx_scene_light *l) {
  const double start = olx_seconds();
  OLX_TRY(olx_light_units_run(l));
  OLX_TRY(olx_light_units_look_up(l));
  l->report.surfels = l->surfels.count;
  l->report.rays += l->surfels.rays;
  l->report.bytes = l->report.links * sizeof(olx_link) +
                    l->surfels.count * (sizeof(olx_light_surfel) + 4 * sizeof(olx_vec3)) +
                    l->surfels.point_count * sizeof(olx_surfel_point);
  l->report.seconds = olx_seconds() - start;
  return OLX_OK;
}

olx_result olx_scene_light_make(const olx_scene *scene, const olx_scene_light_settings *settings,
                                const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                olx_scene_light **light) {
  olx_scene_light *l = *light = olx_allocate_zero(1, sizeof *l);
  if (!l) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory");
  l->scene = scene;
  l->settings = *settings;
  if (l->settings.map_size < LEAST_MAP_SIZE) l->settings.map_size = LEAST_MAP_SIZE;
  l->links.batches = l->batches;
  l->positions = positions;
  l->flags = flags;
  l->probe_count = count;
  return OLX_OK;
}

olx_result olx_scene_light_create(const olx_scene *scene, const olx_scene_light_settings *settings,
                                  const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                  olx_scene_light **light) {
  olx_scene_light *l;
  *light = NULL;
  OLX_TRY(olx_scene_light_make(scene, settings, positions, flags, count, &l));
  const olx_result result = build(l);
  l->positions = NULL;
  l->flags = NULL;
  if (result == OLX_OK) {
    *light = l;
  } else {
    olx_scene_light_free(l);
  }
  return result;
}

void olx_scene_light_free(olx_scene_light *l) {
  if (!l) return;
  olx_scene_light_clear(l);
  olx_release(l);
}

olx_result olx_scene_light_load_links(olx_scene_light *l) { return olx_light_units_load_links(l); }

uint32_t olx_scene_light_bounces(const olx_scene_light *l) { return l->settings.bounces; }

olx_scene_light_report olx_scene_light_describe(const olx_scene_light *light) {
  olx_scene_light_report report = light->report;
  report.reused_rays = atomic_load(&light->reused_rays);
  return report;
}

bool olx_scene_light_sky(const olx_scene_light *l, const olx_surface *surface, olx_vec3 *irradiance) {
  if (!l->sky) return false;
  const uint64_t key = olx_cell_key(&l->surfels.grid, surface->position, surface->geometric_normal);
  const uint32_t found = olx_light_surfels_find(&l->surfels, key, surface, INFINITY).surfel;
  if (found != OLX_CELL_NONE) *irradiance = l->sky[found];
  return found != OLX_CELL_NONE;
}

olx_scene_light_parts olx_scene_light_open(const olx_scene_light *l) {
  return (olx_scene_light_parts){&l->surfels, &l->links, l->visible, olx_light_direct(l), l->irradiance};
}

bool olx_scene_light_interpolate(const olx_scene_light *l, const olx_surface *surface, olx_vec3 *irradiance) {
  return olx_light_interpolate(l, surface, irradiance);
}

olx_gathered_light olx_scene_light_gather(const olx_scene_light *l, const olx_surface *surface, olx_gather_row *row) {
  const olx_gather_plan plan = olx_light_plan_gather(l, surface);
  return (olx_gathered_light){olx_light_gather(l, surface, plan.batches, row), plan.error};
}

olx_vec3 olx_scene_light_irradiance(const olx_scene_light *l, const olx_surface *surface) {
  olx_vec3 irradiance;
  return olx_light_interpolate(l, surface, &irradiance) ? irradiance
                                                        : olx_scene_light_gather(l, surface, NULL).irradiance;
}

olx_vec3 olx_scene_light_irradiance_before(const olx_scene_light *l, const olx_surface *surface) {
  return olx_light_interpolate_before(l, surface);
}
