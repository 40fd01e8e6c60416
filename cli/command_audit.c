// octalux audit: prints how often and by how much a field's results differ from real rays and from path tracing.
#include "commands.h"
#include "options.h"
#include "report.h"
#include "sample_options.h"
#include "scene_options.h"

#include <octalux/limits.h>
#include <octalux/render.h>

#include <inttypes.h>
#include <stdio.h>

typedef struct audit_options {
  const char *scene, *field;
  olx_audit_settings settings;
  scene_options loading;
  bool progress, json;
} audit_options;

static void add_rays(cJSON *object, const char *key, const olx_audit_rays *rays) {
  cJSON *entry = cJSON_AddObjectToObject(object, key);
  add_number(entry, "count", (double)rays->count);
  add_number(entry, "unresolved", rays->unresolved);
  add_number(entry, "wrong", rays->wrong);
  add_number(entry, "unseen", rays->unseen);
  add_number(entry, "unresolved_seen", rays->unresolved_seen);
  add_number(entry, "wrong_seen", rays->wrong_seen);
  add_number(entry, "distance_error_median", rays->distance_error_median);
  add_number(entry, "distance_error_p99", rays->distance_error_p99);
  add_number(entry, "steps_mean", rays->steps_mean);
  add_number(entry, "probes_mean", rays->probes_mean);
}

static void add_points(cJSON *object, const char *key, const olx_audit_points *points) {
  cJSON *entry = cJSON_AddObjectToObject(object, key);
  add_number(entry, "count", (double)points->count);
  add_number(entry, "relative_mse", points->relative_mse);
  add_number(entry, "bias", points->bias);
  add_number(entry, "leak", points->leak);
}

static int print_audit_json(const olx_audit *audit) {
  cJSON *object = cJSON_CreateObject();
  add_rays(object, "rays", &audit->rays);
  add_rays(object, "cosine_rays", &audit->cosine);
  add_rays(object, "mirror_rays", &audit->mirror);
  add_points(object, "points", &audit->points);
  add_points(object, "stored_points", &audit->stored);
  add_points(object, "fallen_back_points", &audit->fallen_back);
  if (audit->irradiance.count) add_points(object, "irradiance_points", &audit->irradiance);
  if (audit->space_volume.count) {
    add_points(object, "space_volume", &audit->space_volume);
    if (audit->space_probes.count) add_points(object, "space_irradiance_probes", &audit->space_probes);
    add_number(object, "space_served", audit->space_served);
  }
  return print_json("audit", object);
}

static void print_rays(const char *kind, const olx_audit_rays *rays) {
  printf("%-8s %10" PRIu64 " %9.3f%% %9.3f%% %9.3f%% %9.3f%% %9.3f%% %9.3f%% %9.3f%% %8.1f %8.2f\n", kind, rays->count,
         100.0 * rays->unresolved, 100.0 * rays->wrong, 100.0 * rays->unseen, 100.0 * rays->unresolved_seen,
         100.0 * rays->wrong_seen, 100.0 * rays->distance_error_median, 100.0 * rays->distance_error_p99,
         rays->steps_mean, rays->probes_mean);
}

static void print_points(const char *kind, const olx_audit_points *points, uint64_t all) {
  printf("%-18s %10" PRIu64 " %9.3f%% %12.5f %+10.5f %10.5f\n", kind, points->count,
         all > 0 ? 100.0 * (double)points->count / (double)all : 0.0, points->relative_mse, points->bias, points->leak);
}

static void print_audit(const olx_audit *audit) {
  printf("%-8s %10s %10s %10s %10s %10s %10s %10s %10s %8s %8s\n", "rays", "count", "unresolved", "wrong", "unseen",
         "unres.seen", "wrong.seen", "dist. 50%", "dist. 99%", "steps", "probes");
  print_rays("all", &audit->rays);
  print_rays("cosine", &audit->cosine);
  print_rays("mirror", &audit->mirror);
  const uint64_t all = audit->points.count;
  printf("\n%-18s %10s %10s %12s %10s %10s\n", "points", "count", "share", "relative mse", "bias", "leak");
  print_points("all", &audit->points, all);
  print_points("stored at surfaces", &audit->stored, all);
  print_points("fallen back", &audit->fallen_back, all);
  if (audit->irradiance.count) print_points("irradiance probes", &audit->irradiance, all);
  if (!audit->space_volume.count) return;
  printf("\n%-18s %10s %10s %12s %10s %10s\n", "free space", "count", "share", "relative mse", "bias", "leak");
  print_points("irradiance volume", &audit->space_volume, audit->space_volume.count);
  if (audit->space_probes.count) print_points("irradiance probes", &audit->space_probes, audit->space_probes.count);
  printf("the volume has cells at %.3f %% of these places\n", 100.0 * audit->space_served);
}

static int audit_field(const audit_options *o, const olx_scene *scene, const olx_field *field) {
  progress_line line;
  progress_begin(&line, "audit", o->progress);
  const olx_progress progress = progress_of(&line);
  olx_audit audit;
  const olx_result result = olx_audit_field(scene, field, &o->settings, &progress, &audit);
  progress_end(&line);
  if (result == OLX_ERROR_CANCELLED) return failure("audit", "interrupted");
  if (result != OLX_OK) return library_failure("audit");
  if (o->json) return print_audit_json(&audit);
  print_audit(&audit);
  return EXIT_DONE;
}

static int audit_scene(const audit_options *o) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  int code = load_scene("audit", o->scene, &o->loading, &scene);
  if (code != EXIT_DONE) return code;
  if (olx_field_open(o->field, &field) != OLX_OK) code = library_failure("audit");
  else code = audit_field(o, scene, field);
  olx_field_close(field);
  olx_scene_free(scene);
  return code;
}

static const option audit_basic_options[] = {
    {"--field", OPTION_TEXT, offsetof(audit_options, field), "FILE.olx", "the field to judge", 1},
    {"--rays", OPTION_COUNT, offsetof(audit_options, settings.rays), "N", "rays to trace and cast; default 200000", 0,
     UINT32_MAX},
    {"--points", OPTION_COUNT, offsetof(audit_options, settings.points), "N", "points to light; default 2000", 0,
     UINT32_MAX},
    {"--space", OPTION_COUNT, offsetof(audit_options, settings.space_points), "N",
     "places of free space to light, six normals each: the volume and irradiance probes; default 0", 0, 1u << 26},
    {"--spp", OPTION_COUNT, offsetof(audit_options, settings.spp), "N",
     "paths a point for its true light; default 1024", 1, OLX_PICTURE_SPP_MOST},
    {"--camera", OPTION_TEXT, offsetof(audit_options, settings.camera), "NAME",
     "judge what this camera sees; default: all of them"},
    {"--seed", OPTION_COUNT, offsetof(audit_options, settings.seed), "N",
     "another choice of rays and points; default 0", 0, UINT32_MAX},
    {0}};

static const option audit_research_options[] = {
    {"--max-probes", OPTION_COUNT, offsetof(audit_options, settings.sample.max_probes), "N",
     "probes a ray may ask; default 16", 1, 65536},
    {0},
};

int command_audit(int argc, char **argv) {
  audit_options o = {.settings = olx_audit_settings_default()};
  command_line line = {.name = "audit",
                       .summary = "Judge a field without a picture: rays through it against ray casting, its diffuse\n"
                                  "light against path tracing: all of it, where light is stored, where it is not, and\n"
                                  "what irradiance probes alone would give; and light in free space.",
                       .example = "octalux audit room.gltf --field room.olx --space 500",
                       .arguments = {"SCENE"},
                       .tables = {{audit_basic_options, &o},
                                  {threads_option, &o.settings.threads},
                                  {progress_option, &o.progress},
                                  {json_option, &o.json},
                                  {scene_loading_options, &o.loading, "Models"},
                                  {sample_options, &o.settings.sample, RESEARCH},
                                  {audit_research_options, &o}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  o.scene = line.given[0];
  return audit_scene(&o);
}
