// Evaluates light stored at surfaces with default settings: runs the parts of the experiment over its scenes, and
// provides what they share.
#include "surfaces.h"

#include "experiment_list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { QUICK_TEXELS = 64, TEXELS = 512 };

typedef struct surface_scene {
  const char *name;
  olx_result (*measure)(surface_run *r);
  const char *what;
  bool quick; // measured also with --quick
} surface_scene;

static const surface_scene scenes[] = {
    {"builtin:two-rooms-sealed", surface_leak, "whole", true},
    {"builtin:two-rooms-gap:0.1", surface_leak, "a gap of 0.1 m", false},
    {"builtin:two-rooms-gap:0.2", surface_leak, "a gap of 0.2 m", true},
    {"builtin:two-rooms-gap:0.4", surface_leak, "a gap of 0.4 m", false},
    {"builtin:two-rooms-gap:0.8", surface_leak, "a gap of 0.8 m", false},
    {"builtin:two-rooms-gap:1.6", surface_leak, "a gap of 1.6 m", false},
    {"builtin:two-rooms-sealed:0.02", surface_thin_wall, "0.02 m", false},
    {"builtin:two-rooms-sealed:0.03", surface_thin_wall, "0.03 m", true},
    {"builtin:two-rooms-sealed:0.04", surface_thin_wall, "0.04 m", false},
    {"builtin:parlour", surface_all_modes, NULL, true},
    {"builtin:furnace", surface_all_modes, NULL, false},
    {"cornell-faint", surface_all_modes, NULL, true},
    {"builtin:cornell", surface_pictures, NULL, true},
    {"builtin:labyrinth", surface_pictures, "chamber", true},
    {"builtin:cornell-glossy", surface_pictures, NULL, false},
    {"builtin:pillars", surface_pictures, NULL, false},
    {"living-room", surface_pictures, NULL, false},
    {"sponza", surface_pictures, NULL, false},
    {"kitchen", surface_pictures, NULL, false},
    {"white-room", surface_pictures, NULL, false},
    {"staircase", surface_pictures, NULL, false},
    {"small-house", surface_pictures, NULL, false},
    {"godot-rooms", surface_pictures, NULL, false},
    {"veach-ajar", surface_pictures, NULL, false},
};

enum { SCENES = sizeof scenes / sizeof *scenes };

const char *surfaces_scene(uint32_t index) { return index < SCENES ? bench_scene_title(scenes[index].name) : NULL; }

const char *surfaces_set(uint32_t index) { return index == 0 ? "placed" : index == 1 ? "grid" : NULL; }

bool surface_wants(const surface_run *r, bool placed) {
  const bench_options *o = r->b->options;
  return o->sets ? bench_listed(o->sets, surfaces_set(placed ? 0 : 1)) : placed || !o->quick;
}

// Returns the number of bounces: the default of bakes, or one with --quick.
static uint32_t bounces(const surface_run *r) {
  return r->b->options->quick ? bench_bounces(r->b) : olx_bake_settings_default(r->scene).bounces;
}

const char *surface_where(const surface_run *r) { return surfaces_set(r->placed ? 0 : 1); }

olx_result surface_bake(const surface_run *r, uint32_t seed, bool probe_light, bench_field *made) {
  const olx_bake_settings defaults = olx_bake_settings_default(r->scene);
  const bool quick = r->b->options->quick;
  const bench_probes probes = {
      .method = OLX_PLACE_COVER, .exact = r->placed ? NULL : &r->grid, .texels = quick ? QUICK_TEXELS : TEXELS};
  const bench_bake wanted = {.irradiance_grid = defaults.irradiance_grid,
                             .irradiance_size = quick ? 16 : defaults.irradiance_size,
                             .light_samples = defaults.light_samples,
                             .bounces = bounces(r),
                             .noise = defaults.noise,
                             .plain = true,
                             .no_probe_light = !probe_light,
                             .seed = seed};
  return bench_bake_field(r->b, r->scene, &probes, &wanted, made);
}

olx_result surface_reference(surface_run *r, uint32_t paths, bool centered) {
  olx_render_settings settings = bench_path_settings(r->b);
  settings.spp *= paths;
  settings.centered = centered;
  return bench_reference(r->b, r->scene, r->cameras, r->camera_count, &settings, bounces(r) + 1, &r->reference);
}

olx_result surface_keep_cameras(surface_run *r, uint32_t count, const char *const *names) {
  r->camera_count = count;
  for (uint32_t c = 0; c < count; ++c) {
    const olx_result result = olx_scene_find_camera(r->scene, names[c], &r->cameras[c]);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

double surface_camera_light(bench_images *images, uint32_t camera) {
  const olx_image *image = bench_images_mean(images, camera);
  return image ? surface_mean_light(image) : NAN;
}

static olx_result run_scene(surface_run *r, const surface_scene *scene) {
  r->name = scene->name;
  r->what = scene->what;
  r->placed = true;
  const olx_result result = bench_scene(r->b, r->name, &r->scene);
  if (result != OLX_OK || !r->scene) return result;
  r->camera_count = bench_scene_cameras(r->scene, r->cameras);
  r->grid = olx_bake_settings_default(r->scene).grid;
  return r->camera_count ? scene->measure(r) : OLX_OK;
}

olx_result run_surfaces(bench *b) {
  surface_run r = {.b = b};
  surface_light_tables(&r);
  surface_leak_tables(&r);
  surface_mode_table(&r);
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < SCENES && result == OLX_OK; ++i) {
    if (!bench_names(b->options, surfaces_scene(i))) continue;
    if (!b->options->quick || scenes[i].quick) {
      result = run_scene(&r, &scenes[i]);
    } else if (b->options->only) {
      findings_skip(&b->found, surfaces_scene(i), "--quick leaves it out");
    }
  }
  return result;
}
