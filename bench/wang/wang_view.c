// Opens a scene of Wang's thesis with its references, and compares images from fields with them.
#include "wang_view.h"

enum { COARSE_IRRADIANCE = 16 }; // diffuse light is the same for all sets and is not compared here

// Default sizes of images and times, where the command line gives none.
typedef struct wang_sizes {
  uint32_t size[2], spp, field_spp, rounds, texels;
} wang_sizes;

// Sizes for tables are small, because there are about fifty sets of up to 128 probes; experiments outside `all` use the
// thesis's.
static const wang_sizes quick_sizes = {{64, 36}, 16, 2, 2, 64};
static const wang_sizes table_sizes = {{96, 54}, 32, 2, 3, 128};
static const wang_sizes thesis_sizes = {{320, 180}, 128, 8, 5, 512};

static uint32_t given(uint32_t option, uint32_t usual) { return option ? option : usual; }

static wang_sizes sizes_of(const bench *b) {
  const bench_options *o = b->options;
  const wang_sizes *usual = o->quick ? &quick_sizes : b->experiment->alone ? &thesis_sizes : &table_sizes;
  return (wang_sizes){.size = {given(o->size[0], usual->size[0]), given(o->size[1], usual->size[1])},
                      .spp = given(o->spp, usual->spp),
                      .field_spp = given(o->field_spp, usual->field_spp),
                      .rounds = given(o->rounds, usual->rounds),
                      .texels = given(o->texels, usual->texels)};
}

uint32_t wang_rounds(const bench *b) { return sizes_of(b).rounds; }

bench_probes wang_probes(const bench *b, const bench_probes *probes) {
  bench_probes own = *probes;
  own.texels = own.texels * sizes_of(b).texels / 512;
  return own;
}

olx_render_settings wang_picture(const bench *b, olx_method method) {
  const wang_sizes sizes = sizes_of(b);
  olx_render_settings settings = olx_render_settings_default(method);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE; // as in the papers
  settings.width = sizes.size[0];
  settings.height = sizes.size[1];
  settings.spp = method == OLX_METHOD_PATH ? sizes.spp : sizes.field_spp;
  settings.threads = b->options->threads;
  return settings;
}

bool wang_leaves_out(bench *b, uint32_t scene) {
  const char *name = wang_scenes[scene].name;
  if (b->options->only) return !bench_names(b->options, name);
  if (!b->options->quick || scene == 0) return false;
  findings_skip(&b->found, name, "--quick keeps to the Cornell box");
  return true;
}

olx_result wang_open(bench *b, uint32_t scene, wang_view *view) {
  *view = (wang_view){.b = b, .plan = &wang_scenes[scene]};
  olx_result result = bench_scene(b, view->plan->description, &view->scene);
  if (result != OLX_OK || !view->scene) return result;
  view->bake = (bench_bake){.irradiance_size = COARSE_IRRADIANCE, .light_samples = b->options->quick ? 1 : 4};
  if (b->options->quick) view->bake.noise = BENCH_ROUGH_NOISE;
  result = olx_scene_probe_grid(view->scene, NULL, &view->bake.irradiance_grid);
  if (result != OLX_OK) return result;
  view->bake.irradiance_grid = olx_bake_irradiance_grid(&view->bake.irradiance_grid);
  olx_camera cameras[BENCH_CAMERAS];
  const uint32_t count = bench_scene_cameras(view->scene, cameras);
  const olx_render_settings settings = wang_picture(b, OLX_METHOD_PATH);
  return bench_reference(b, view->scene, cameras, count, &settings, 1, &view->references);
}

olx_result wang_compare(const wang_view *view, const olx_field *field, olx_tracer tracer, olx_select select,
                        const char *name, wang_quality *quality, bench_images *pictures) {
  const bench_images *references = view->references;
  bench_way way = {.name = name, .field = field, .settings = wang_picture(view->b, OLX_METHOD_FIELD)};
  way.settings.sample.tracer = tracer;
  way.settings.sample.select = select;
  const olx_result result =
      bench_pictures(view->b, view->scene, references->camera, references->cameras, &way, pictures);
  if (result != OLX_OK) return result;
  *quality = (wang_quality){.glossy = bench_error_of(pictures, references, BENCH_GLOSSY, BENCH_CAMERAS),
                            .beauty = bench_error_of(pictures, references, BENCH_INDIRECT, BENCH_CAMERAS)};
  for (uint32_t c = 0; c < pictures->cameras; ++c) {
    quality->glossy_camera[c] = bench_error_of(pictures, references, BENCH_GLOSSY, c);
  }
  return OLX_OK;
}
