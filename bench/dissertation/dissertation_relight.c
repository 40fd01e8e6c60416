// Compares frames of relighting, each of which renews a part of a field's light after a light has moved, with a fresh
// bake of the changed scene.
#include "clock.h"
#include "experiment_list.h"

#include <octalux/relight.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FRAMES = 30, MOST_LIGHTS = 64, MOST_FILE = 1 << 20 };

static const double arrived = 0.05;

// The change to a description: its first light, added where the description is a built-in scene's.
typedef struct relit_case {
  const char *scene, *camera, *what;
  const char *light, *moved; // JSON of the first light
  uint32_t grid[3], irradiance_grid[3];
  uint32_t radiance_size, irradiance_size;
} relit_case;

#define COMPANION(position) "{\"type\": \"point\", \"position\": " position ", \"intensity\": [0.4, 0.3, 0.5]}"

static const relit_case cases[] = {
    {"builtin:cornell",
     "front",
     "a lamp beside the box's own moves across the box",
     COMPANION("[0.1, 0.12, 0.1]"),
     COMPANION("[0.44, 0.4, 0.3]"),
     {2, 2, 2},
     {3, 3, 3},
     128,
     32},
    {"living-room",
     "sofa",
     "the lamp moves across the room and down",
     NULL,
     "{\"type\": \"point\", \"position\": [-0.6, 1.6, 5.6], \"intensity\": [20, 20, 20]}",
     {4, 4, 4},
     {4, 4, 4},
     128,
     128},
    {"sponza",
     "atrium",
     "the sun moves by 35 degrees",
     NULL,
     "{\"type\": \"sun\", \"direction\": [-0.35, -1.0, -0.2], \"irradiance\": [20, 18.5, 16]}",
     {8, 2, 4},
     {8, 2, 4},
     128,
     128},
};

static const bench_column curve_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"frame", "frame", BENCH_NAME, NULL, "after the light moved"},
    {"number", "frames", BENCH_COUNT, NULL, NULL},
    {"mean_off", "mean", BENCH_QUALITY, "%", "irradiance too much or missing, of a fresh bake's mean"},
    {"rms", "RMS", BENCH_QUALITY, "%", "of the difference, of a fresh bake's mean"},
    {"shadow_rays", "shadow rays", BENCH_COUNT, NULL, "of the frame"},
    {"texels", "texels", BENCH_COUNT, NULL, "of light field maps, in the frame"},
    {"ms", "processor", BENCH_TIME, "ms", "of the frame, all threads together"},
};

static const bench_column work_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"change", "change", BENCH_NAME, NULL, NULL},
    {"before_rms", "RMS before", BENCH_QUALITY, "%", "of the light as it was baked against the fresh bake"},
    {"mean_off", "mean", BENCH_QUALITY, "%", "after 30 frames"},
    {"rms", "RMS", BENCH_QUALITY, "%", "after 30 frames"},
    {"bakes_rms", "RMS of two bakes", BENCH_QUALITY, "%",
     "between the fresh bake and another whose random numbers differ: what a bake repeats of itself"},
    {"frames", "frames to 5 %", BENCH_COUNT, NULL, "after which mean and RMS stay below"},
    {"rays", "rays", BENCH_COUNT, "%", "of all 30 frames, of those of a bake"},
    {"work", "processor time", BENCH_TIME, "%", "of all 30 frames, of that of a bake"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time"},
    {"even_texels", "texels, most / mean", BENCH_COUNT, NULL, "of a frame"},
    {"even_ms", "time, most / mean", BENCH_TIME, NULL, "of a frame"},
};

static const bench_plot curve_plots[] = {{"Irradiance after the light moved", "number", "rms", "scene", false, true}};

typedef struct seen_point {
  olx_vec3 position, normal, geometric, view, wanted;
} seen_point;

typedef struct relit_run {
  bench *b;
  const relit_case *c;
  bench_table *curve, *work;
  olx_scene *scene, *moved;
  olx_camera camera;
  olx_field *field, *fresh;
  uint64_t bake_rays;
  double bake_seconds;
  seen_point *points;
  uint32_t count;
} relit_run;

// The total work of all frames.
typedef struct relit_total {
  double seconds, most_seconds, texels, most_texels, rays;
  uint32_t frames, last_apart; // number of frames; the last one whose error was above 5 %
  double before_rms, bakes_rms, mean_off, rms;
} relit_total;

static cJSON *read_description(const relit_run *r) {
  cJSON *object = NULL;
  if (strncmp(r->c->scene, "builtin:", 8) == 0) {
    object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "model", r->c->scene);
    cJSON_AddArrayToObject(object, "lights");
    return object;
  }
  char path[4096];
  snprintf(path, sizeof path, "%s/%s.json", r->b->options->folder, r->c->scene);
  FILE *file = fopen(path, "rb");
  char *text = file ? calloc(1, MOST_FILE) : NULL;
  if (text && fread(text, 1, MOST_FILE - 1, file) > 0) object = cJSON_Parse(text);
  free(text);
  if (file) fclose(file);
  return object;
}

// Loads the scene of the case with its first light replaced, or unchanged where `light` is NULL.
static olx_result load_with(const relit_run *r, const char *light, olx_scene **scene) {
  char path[4096];
  cJSON *object = read_description(r), *lights = cJSON_GetObjectItem(object, "lights");
  if (light && lights) {
    cJSON_DeleteItemFromArray(lights, 0);
    cJSON_InsertItemInArray(lights, 0, cJSON_Parse(light));
  }
  char *text = object ? cJSON_Print(object) : NULL;
  cJSON_Delete(object);
  snprintf(path, sizeof path, "%s/scene.json", r->b->folder.path);
  if (!text) return OLX_ERROR_MEMORY;
  olx_result result = olx_write_file(path, text, strlen(text));
  free(text);
  if (result == OLX_OK) result = olx_scene_load(path, scene);
  unlink(path);
  return result;
}

static olx_result bake(relit_run *r, const olx_scene *scene, bool relight, uint32_t seed, olx_field **field) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%u.olx", r->b->folder.path, r->b->fields++);
  olx_bake_settings settings = olx_bake_settings_default(r->scene);
  olx_result result = olx_scene_probe_grid(r->scene, r->c->grid, &settings.grid);
  if (result == OLX_OK) result = olx_scene_probe_grid(r->scene, r->c->irradiance_grid, &settings.irradiance_grid);
  settings.radiance_size = r->c->radiance_size;
  settings.irradiance_size = r->c->irradiance_size;
  settings.noise = r->b->options->quick ? BENCH_ROUGH_NOISE : settings.noise;
  settings.relight = relight;
  settings.seed = seed;
  settings.threads = r->b->options->threads;
  olx_bake_stats stats = {0};
  const double start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  bench_progress(r->b, "baking %s%s", bench_scene_title(r->c->scene), relight ? "" : " with the light moved");
  if (result == OLX_OK) result = olx_bake(scene, &settings, path, &r->b->progress, &stats);
  r->bake_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
  r->bake_rays = stats.rays;
  if (result == OLX_OK) result = olx_field_open(path, field);
  unlink(path); // the file stays mapped
  return result;
}

static olx_vec3 irradiance_at(const olx_field *field, const seen_point *p) {
  const olx_sample_settings sample = olx_sample_settings_default();
  return olx_surface_irradiance(field, &sample, p->position, p->geometric, p->normal, p->view);
}

static double luminance(olx_vec3 c) { return 0.2126 * (double)c.x + 0.7152 * (double)c.y + 0.0722 * (double)c.z; }

static seen_point point_of_pixel(const olx_gbuffer *g, uint32_t x, uint32_t y) {
  const float *m = g->clip_to_world, depth = g->inverse_depth[x + g->width * y];
  const float cx = 2.0f * ((float)x + 0.5f) / (float)g->width - 1.0f,
              cy = 2.0f * ((float)y + 0.5f) / (float)g->height - 1.0f;
  float at[4];
  for (uint32_t i = 0; i < 4; ++i) at[i] = m[i] * cx + m[4 + i] * cy + m[8 + i] * depth + m[12 + i];
  seen_point p = {.position = {at[0] / at[3], at[1] / at[3], at[2] / at[3]},
                  .normal = g->vertex_normal[x + g->width * y],
                  .geometric = g->geometric_normal[x + g->width * y]};
  const olx_vec3 away = {g->eye.x - p.position.x, g->eye.y - p.position.y, g->eye.z - p.position.z};
  const float length = sqrtf(away.x * away.x + away.y * away.y + away.z * away.z);
  p.view = (olx_vec3){away.x / length, away.y / length, away.z / length};
  return p;
}

// Finds points that the camera sees, and their irradiance in the fresh bake.
static olx_result find_points(relit_run *r) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = r->b->options->quick ? 48 : 96;
  settings.height = settings.width * 3 / 4;
  settings.spp = 1;
  settings.threads = r->b->options->threads;
  olx_image image;
  olx_gbuffer g;
  const olx_result result =
      olx_render_surfaces(r->moved, r->fresh, &r->camera, &settings, &r->b->progress, &image, &g, NULL);
  if (result != OLX_OK) return result;
  r->points = calloc((size_t)g.width * g.height, sizeof *r->points);
  for (uint32_t i = 0; r->points && i < g.width * g.height; ++i) {
    if (g.inverse_depth[i] <= 0.0f) continue;
    seen_point *p = &r->points[r->count++];
    *p = point_of_pixel(&g, i % g.width, i / g.width);
    p->wanted = irradiance_at(r->fresh, p);
  }
  olx_image_free(&image);
  olx_gbuffer_free(&g);
  return r->points ? OLX_OK : OLX_ERROR_MEMORY;
}

static void measure(const relit_run *r, const olx_field *field, double *mean_off, double *rms) {
  double sum = 0.0, off = 0.0, squares = 0.0;
  for (uint32_t i = 0; i < r->count; ++i) {
    const double wanted = luminance(r->points[i].wanted), got = luminance(irradiance_at(field, &r->points[i]));
    sum += wanted;
    off += got - wanted;
    squares += (got - wanted) * (got - wanted);
  }
  *mean_off = off / sum;
  *rms = sqrt(squares * r->count) / sum;
}

static olx_result run_frame(relit_run *r, olx_relight *relight, relit_total *t) {
  olx_relight_stats stats;
  const double start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const olx_result result = olx_relight_frame(relight, r->camera.eye, &stats);
  const double seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
  if (result != OLX_OK) return result;
  const double texels = (double)stats.texels;
  t->frames++;
  t->seconds += seconds;
  t->texels += texels;
  t->rays += (double)stats.shadow_rays;
  if (seconds > t->most_seconds) t->most_seconds = seconds;
  if (texels > t->most_texels) t->most_texels = texels;
  measure(r, olx_relight_field(relight), &t->mean_off, &t->rms);
  if (fabs(t->mean_off) > arrived || t->rms > arrived) t->last_apart = t->frames;
  char frame[16];
  snprintf(frame, sizeof frame, "%u", t->frames);
  FINDINGS_ROW(&r->b->found, r->curve, TEXT_CELL(bench_scene_title(r->c->scene)), TEXT_CELL(frame),
               NUMBER_CELL(t->frames), NUMBER_CELL(t->mean_off), NUMBER_CELL(t->rms),
               NUMBER_CELL((double)stats.shadow_rays), NUMBER_CELL(texels), NUMBER_CELL(1e3 * seconds));
  return OLX_OK;
}

static void add_work(relit_run *r, const relit_total *t) {
  const double frames = t->last_apart < t->frames ? (double)t->last_apart + 1.0 : (double)NAN;
  FINDINGS_ROW(&r->b->found, r->work, TEXT_CELL(bench_scene_title(r->c->scene)), TEXT_CELL(r->c->what),
               NUMBER_CELL(t->before_rms), NUMBER_CELL(t->mean_off), NUMBER_CELL(t->rms), NUMBER_CELL(t->bakes_rms),
               NUMBER_CELL(frames), NUMBER_CELL(t->rays / (double)r->bake_rays),
               NUMBER_CELL(t->seconds / r->bake_seconds), NUMBER_CELL(r->bake_seconds),
               NUMBER_CELL(t->most_texels * t->frames / t->texels),
               NUMBER_CELL(t->most_seconds * t->frames / t->seconds));
}

// Computes the difference of two fresh bakes.
static olx_result compare_bakes(relit_run *r, double *rms) {
  olx_field *other = NULL;
  double mean_off;
  const olx_result result = bake(r, r->moved, false, 1, &other);
  if (result == OLX_OK) measure(r, other, &mean_off, rms);
  olx_field_close(other);
  return result;
}

static olx_result run_frames(relit_run *r) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = r->scene;
  settings.threads = r->b->options->threads;
  olx_light lights[MOST_LIGHTS];
  uint32_t count;
  relit_total total = {.frames = 0};
  measure(r, r->field, &total.mean_off, &total.before_rms);
  olx_relight *relight = NULL;
  olx_result result = compare_bakes(r, &total.bakes_rms);
  if (result == OLX_OK) result = olx_scene_relight_lights(r->moved, lights, MOST_LIGHTS, &count);
  if (result == OLX_OK) result = olx_relight_create(r->field, &settings, &relight);
  if (result == OLX_OK) result = olx_relight_set_lights(relight, lights, count);
  for (uint32_t frame = 0; frame < FRAMES && result == OLX_OK; ++frame) result = run_frame(r, relight, &total);
  if (result == OLX_OK) add_work(r, &total);
  olx_relight_free(relight);
  return result;
}

static olx_result run_case(relit_run *r) {
  olx_result result = load_with(r, r->c->light, &r->scene);
  if (result == OLX_OK) result = load_with(r, r->c->moved, &r->moved);
  if (result == OLX_OK) result = olx_scene_find_camera(r->scene, r->c->camera, &r->camera);
  if (result == OLX_OK) result = bake(r, r->scene, true, 0, &r->field);
  if (result == OLX_OK) result = bake(r, r->moved, false, 0, &r->fresh);
  if (result == OLX_OK) result = find_points(r);
  if (result == OLX_OK) result = run_frames(r);
  free(r->points);
  olx_field_close(r->field);
  olx_field_close(r->fresh);
  olx_scene_free(r->scene);
  olx_scene_free(r->moved);
  return result;
}

olx_result run_relight(bench *b) {
  bench_table *work = FINDINGS_TABLE(&b->found, "relight", "Thirty frames after a light moved, against a fresh bake",
                                     work_columns, ((const bench_plot[]){{0}}));
  work->plot_count = 0;
  bench_table *curve = FINDINGS_TABLE(&b->found, "frames", "Frame by frame", curve_columns, curve_plots);
  for (uint32_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const relit_case *c = &cases[i];
    olx_scene *there;
    if (bench_leaves_out(b, c->scene)) continue;
    olx_result result = bench_scene(b, c->scene, &there);
    if (result == OLX_OK && !there) continue;
    relit_run r = {.b = b, .c = c, .curve = curve, .work = work};
    if (result == OLX_OK) result = run_case(&r);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
