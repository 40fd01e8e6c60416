// Measures the rows of Wang's tables: bakes a field for each set of probes, renders the scene's cameras, and compares
// them with references.
#include "wang.h"

#include "options.h"
#include "studies.h"

#include <stdio.h>
#include <string.h>

void wang_tell(const wang_run *run, const char *what, const char *name) {
  if (run->told) fprintf(stderr, BENCH_PROGRAM ": %s: %s%s%s\n", run->experiment->name, what, name[0] ? " " : "", name);
}

bench_probes wang_probes(const wang_run *run, const bench_probes *probes) {
  bench_probes own = *probes;
  own.texels = own.texels * run->options->texels / 512;
  return own;
}

static olx_render_settings picture(const wang_run *run, olx_method method) {
  olx_render_settings settings = olx_render_settings_default(method);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE; // as the papers have it
  settings.width = run->options->size[0];
  settings.height = run->options->size[1];
  settings.threads = run->options->threads;
  return settings;
}

static olx_result save_layers(const wang_run *run, bench_images *images, const char *name) {
  static const olx_layer layers[] = {OLX_LAYER_BEAUTY, OLX_LAYER_INDIRECT_GLOSSY};
  for (uint32_t c = 0; c < images->cameras; ++c) {
    const olx_image *mean = bench_images_mean(images, c);
    if (!mean) return OLX_ERROR_MEMORY;
    for (uint32_t i = 0; i < 2; ++i) {
      char path[4096];
      snprintf(path, sizeof path, "%s/%s-%s-%s-%s.png", run->options->images, run->experiment->name,
               images->camera[c].name, name, olx_layer_name(layers[i]));
      for (char *p = path + strlen(run->options->images); *p; ++p) {
        if (*p == ' ' || *p == '^') *p = '_';
      }
      const olx_result result = olx_image_save_layer_png(mean, layers[i], 1.0f, path);
      if (result != OLX_OK) return result;
    }
  }
  return OLX_OK;
}

olx_result wang_measure(wang_run *run, const olx_field *field, olx_tracer tracer, olx_select select,
                        const char *image_name, wang_quality *quality, bench_images *kept) {
  olx_render_settings settings = picture(run, OLX_METHOD_FIELD);
  settings.spp = run->options->field_spp;
  settings.sample.tracer = tracer;
  settings.sample.select = select;
  const bench_way way = {.field = field, .settings = settings};
  bench_images images;
  olx_result result = bench_images_render(run->scene, run->references.camera, run->references.cameras, &way, 1,
                                          &run->progress, &images);
  if (result == OLX_OK) {
    *quality = (wang_quality){.glossy = bench_error_of(&images, &run->references, BENCH_GLOSSY, BENCH_CAMERAS),
                              .beauty = bench_error_of(&images, &run->references, BENCH_INDIRECT, BENCH_CAMERAS),
                              .stats = images.stats};
    for (uint32_t c = 0; c < images.cameras; ++c) {
      quality->glossy_camera[c] = bench_error_of(&images, &run->references, BENCH_GLOSSY, c);
    }
    if (run->options->images) result = save_layers(run, &images, image_name);
  }
  if (kept) *kept = images;
  else bench_images_free(&images);
  return result;
}

void wang_add_error(cJSON *object, const char *key, const bench_error *error) {
  cJSON *entry = cJSON_AddObjectToObject(object, key);
  add_number(entry, "mse", error->mse);
  add_number(entry, "noise", error->noise);
  add_number(entry, "relative_mse", error->relative_mse);
  add_number(entry, "bias", error->bias);
}

// Renders references of one bounce, as Wang does: light that was reflected once before it reaches what the camera sees.
static olx_result render_references(wang_run *run) {
  bench_way way = {.settings = picture(run, OLX_METHOD_PATH)};
  way.settings.spp = run->options->spp;
  way.settings.bounces = 1;
  wang_tell(run, "path tracing", "");
  olx_camera cameras[BENCH_CAMERAS];
  const uint32_t count = bench_scene_cameras(run->scene, cameras);
  return bench_images_render(run->scene, cameras, count, &way, 0, &run->progress, &run->references);
}

typedef olx_result (*wang_experiment)(wang_run *run, cJSON *object);

enum { COARSE_IRRADIANCE = 16 }; // diffuse light is the same for all sets and is not compared here

olx_result wang_prepare(wang_run *run) {
  const wang_options *o = run->options;
  run->bake = (bench_bake){.irradiance_size = COARSE_IRRADIANCE, .light_samples = o->quick ? 1 : 4};
  run->bake.threads = o->threads;
  run->bake.rough = o->quick;
  if (o->quick) run->bake.noise = BENCH_ROUGH_NOISE;
  const olx_result result = olx_scene_probe_grid(run->scene, NULL, &run->bake.irradiance_grid);
  run->bake.irradiance_grid = olx_bake_irradiance_grid(&run->bake.irradiance_grid);
  return result == OLX_OK ? render_references(run) : result;
}

static olx_result run_scene(wang_run *run, wang_experiment experiment, cJSON *list) {
  const wang_options *o = run->options;
  cJSON *object = cJSON_CreateObject();
  cJSON_AddItemToArray(list, object);
  add_text(object, "scene", run->experiment->name);
  add_text(object, "description", run->experiment->description);
  olx_result result = wang_prepare(run);
  cJSON *cameras = cJSON_AddArrayToObject(object, "cameras");
  for (uint32_t c = 0; c < run->references.cameras; ++c) {
    cJSON_AddItemToArray(cameras, cJSON_CreateString(run->references.camera[c].name));
  }
  if (result == OLX_OK) result = experiment(run, object);
  if (result == OLX_OK && o->images) result = save_layers(run, &run->references, "path");
  bench_images_free(&run->references);
  return result;
}

olx_result wang_load_scene(wang_run *run) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", run->options->folder, run->experiment->description);
  return olx_scene_load(path, &run->scene);
}

static int run_all(const wang_options *o, const char *name, wang_experiment experiment) {
  progress_line line;
  progress_begin(&line, BENCH_PROGRAM, false);
  wang_run run = {.options = o, .progress = progress_of(&line), .told = o->progress || line.shown};
  if (!bench_folder_make(&run.folder))
    return failure(BENCH_PROGRAM, "%s: cannot create a temporary folder", run.folder.path);
  cJSON *object = cJSON_CreateObject();
  add_text(object, "experiment", name);
  cJSON *list = cJSON_AddArrayToObject(object, "scenes");
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < WANG_SCENES && result == OLX_OK; ++i) {
    if (o->scene != WANG_SCENES ? o->scene != i : o->quick && i > 0) continue;
    run.experiment = &wang_scenes[i];
    result = wang_load_scene(&run);
    // A scene whose model is not there is left out, unless it was asked for by name.
    if (result == OLX_ERROR_FILE && o->scene == WANG_SCENES) {
      fprintf(stderr, BENCH_PROGRAM ": %s is left out: %s\n", run.experiment->name, olx_last_error());
      result = OLX_OK;
      continue;
    }
    if (result == OLX_OK) result = run_scene(&run, experiment, list);
    olx_scene_free(run.scene);
    run.scene = NULL;
  }
  progress_end(&line);
  bench_folder_remove(&run.folder);
  if (result == OLX_OK && o->json) return print_json(BENCH_PROGRAM, object);
  cJSON_Delete(object);
  if (result == OLX_ERROR_CANCELLED) return failure(BENCH_PROGRAM, "interrupted");
  return result == OLX_OK ? EXIT_DONE : library_failure(BENCH_PROGRAM);
}

void wang_resolve(wang_options *o) {
  if (!o->size[0]) memcpy(o->size, o->quick ? (uint32_t[]){64, 36} : (uint32_t[]){320, 180}, sizeof o->size);
  if (!o->spp) o->spp = o->quick ? 16 : 128;
  if (!o->field_spp) o->field_spp = o->quick ? 2 : 8;
  if (!o->rounds) o->rounds = o->quick ? 2 : 5;
  if (!o->texels) o->texels = o->quick ? 64 : 512;
}

int study_wang(int argc, char **argv) {
  const bool counts = strcmp(argv[0], "wang-probes") == 0;
  wang_options o = {.scene = WANG_SCENES, .folder = "scenes"};
  const option options[] = {
      {"--scene", OPTION_CHOICE, &o.scene, "cornell-glossy|temple|sponza", "this scene alone; default: all", 0, 0},
      {"--scenes", OPTION_TEXT, &o.folder, "FOLDER", "where their descriptions are; default scenes", 0, 0},
      {"--texels", OPTION_POWER_OF_TWO, &o.texels, "N", "along a map of light; default 512", 16, 1024},
      {"--size", OPTION_SIZE, o.size, "320x180", "of the pictures; default 320x180", 8, 4096},
      {"--spp", OPTION_COUNT, &o.spp, "N", "of each of two references, path traced; default 128", 1, 1u << 20},
      {"--field-spp", OPTION_COUNT, &o.field_spp, "N", "of each of two pictures from a field; default 8", 1, 4096},
      {"--rounds", OPTION_COUNT, &o.rounds, "N", "in which each row is timed once; default 5", 1, 1000},
      {"--quick", OPTION_FLAG, &o.quick, NULL, "the Cornell box alone, small and rough, in seconds", 0, 0},
      {"--probes", OPTION_TEXT, &o.sets, "4x2x4,A.json,B.json@1024", "wang-probes: only these sets, against the first",
       0, 0},
      {"--short", OPTION_FLAG, &o.brief, NULL, "wang: without the series of sets in appendix A", 0, 0},
      {"-o", OPTION_TEXT, &o.images, "FOLDER", "write pictures of every set of probes there", 0, 0},
      {"--threads", OPTION_COUNT, &o.threads, "N", "to bake and to measure errors; default 0: every processor", 0,
       4096},
      {"--progress", OPTION_FLAG, &o.progress, NULL, "tell progress even when nobody watches", 0, 0},
      {"--json", OPTION_FLAG, &o.json, NULL, "print one JSON object", 0, 0},
  };
  command_line line = {
      .name = counts ? BENCH_PROGRAM " wang-probes" : BENCH_PROGRAM " wang",
      .summary = counts ? "How few probes, placed by themselves, do as well as the best of several grids: error of\n"
                          "the glossy layer against one bounce path traced."
                        : "Tables 5.1 and 5.2 of Wang's thesis, and what its sections 5.1 and 5.2 compare: times in\n"
                          "one interleaved run, errors against one bounce path traced, memory.",
      .options = options,
      .option_count = sizeof options / sizeof options[0]};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  wang_resolve(&o);
  return run_all(&o, argv[0], counts ? wang_run_counts : wang_run_tables);
}
