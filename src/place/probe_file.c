// Saves sets of probes with their settings and their report as JSON, and loads them with messages that name the error
// in a file.
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/import/json_value.h"

#include <octalux/place.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FORMAT_NAME "octalux probes"
enum { FORMAT_VERSION = 1, LAST_METHOD = OLX_PLACE_COVER, LAST_ORIGIN = OLX_ORIGIN_MOVED };

// Returns the double that prints with no more digits than the float has.
static double shortest(float value) {
  char text[40];
  for (int digits = 6; digits < 10; digits++) {
    snprintf(text, sizeof text, "%.*g", digits, (double)value);
    if (strtof(text, NULL) == value) break;
  }
  return strtod(text, NULL);
}

// Numeric settings that are stored under their own names.
typedef struct stored_number {
  const char *key;
  uint32_t *whole;
  float *real;
} stored_number;

enum { STORED_NUMBERS = 13 };

static void list_numbers(olx_place_settings *s, stored_number numbers[STORED_NUMBERS]) {
  const stored_number all[STORED_NUMBERS] = {
      {.key = "count", .whole = &s->count},
      {.key = "coverage", .real = &s->coverage},
      {.key = "views", .whole = &s->views},
      {.key = "resolution", .whole = &s->resolution},
      {.key = "min_cosine", .real = &s->min_cosine},
      {.key = "max_footprint", .real = &s->max_footprint},
      {.key = "rounds", .whole = &s->rounds},
      {.key = "surfels", .whole = &s->surfels},
      {.key = "candidates", .whole = &s->candidates},
      {.key = "voxel_size", .real = &s->voxel_size},
      {.key = "voxels", .whole = &s->voxels},
      {.key = "refinements", .whole = &s->refinements},
      {.key = "seed", .whole = &s->seed},
  };
  memcpy(numbers, all, sizeof all);
}

static void add_vec3(cJSON *object, const char *key, olx_vec3 v) {
  const double numbers[3] = {shortest(v.x), shortest(v.y), shortest(v.z)};
  cJSON_AddItemToObject(object, key, cJSON_CreateDoubleArray(numbers, 3));
}

// Adds a position in scene coordinates.
static void add_position(cJSON *object, const char *key, const double origin[3], olx_vec3 p) {
  const double numbers[3] = {origin[0] + shortest(p.x), origin[1] + shortest(p.y), origin[2] + shortest(p.z)};
  cJSON_AddItemToObject(object, key, cJSON_CreateDoubleArray(numbers, 3));
}

static void write_settings(cJSON *root, const double origin[3], const olx_place_settings *settings) {
  cJSON *object = cJSON_AddObjectToObject(root, "settings");
  olx_place_settings copy = *settings;
  stored_number numbers[STORED_NUMBERS];
  list_numbers(&copy, numbers);
  for (int i = 0; i < STORED_NUMBERS; i++) {
    cJSON_AddNumberToObject(object, numbers[i].key,
                            numbers[i].whole ? (double)*numbers[i].whole : shortest(*numbers[i].real));
  }
  cJSON_AddNumberToObject(object, "budget_mb", settings->budget_mb);
  cJSON_AddStringToObject(object, "optimize", olx_place_optimizer_name(settings->optimize));
  cJSON_AddStringToObject(object, "reward", olx_place_reward_name(settings->reward));
  if (settings->method != OLX_PLACE_GRID) return;
  cJSON *grid = cJSON_AddObjectToObject(object, "grid");
  const double counts[3] = {settings->grid.count[0], settings->grid.count[1], settings->grid.count[2]};
  add_position(grid, "origin", origin, settings->grid.origin);
  add_vec3(grid, "spacing", settings->grid.spacing);
  cJSON_AddItemToObject(grid, "count", cJSON_CreateDoubleArray(counts, 3));
}

// Adds a share rounded to six digits, because it is an estimate.
static void add_share(cJSON *object, const char *key, double share) {
  cJSON_AddNumberToObject(object, key, trunc(share * 1e6 + 0.5) * 1e-6);
}

static void write_report(cJSON *root, const olx_place_settings *settings, const olx_place_report *report) {
  cJSON *object = cJSON_AddObjectToObject(root, "report");
  add_share(object, "coverage", report->coverage);
  add_share(object, "visible", report->visible);
  add_share(object, "coverage_by_area", report->coverage_by_area);
  add_share(object, "coverable", report->coverable);
  add_share(object, "grazing", report->grazing);
  add_share(object, "restricted", report->restricted);
  add_share(object, "missed", report->missed);
  add_share(object, "unreachable", report->unreachable);
  add_share(object, "reached_m2", report->reached_m2);
  add_share(object, "unreached_m2", report->unreached_m2);
  add_share(object, "voxel_metres", (double)report->voxel_metres);
  cJSON_AddNumberToObject(object, "tiles", report->tiles);
  cJSON_AddNumberToObject(object, "buried", report->buried);
  cJSON_AddNumberToObject(object, "rejected", report->rejected);
  if (settings->optimize == OLX_OPTIMIZE_NONE) return;
  add_share(object, "coverage_before", report->coverage_before);
  add_share(object, "reward_before", report->reward_before);
  add_share(object, "reward_after", report->reward_after);
  cJSON_AddNumberToObject(object, "rounds", report->rounds);
}

static cJSON *describe(const olx_probe_set *set) {
  char hash[24];
  snprintf(hash, sizeof hash, "%016" PRIx64, set->scene_hash);
  cJSON *root = cJSON_CreateObject();
  cJSON_AddStringToObject(root, "format", FORMAT_NAME);
  cJSON_AddNumberToObject(root, "version", FORMAT_VERSION);
  cJSON_AddStringToObject(root, "scene_hash", hash);
  cJSON_AddStringToObject(root, "method", olx_place_method_name(set->settings.method));
  write_settings(root, set->origin, &set->settings);
  write_report(root, &set->settings, &set->report);
  cJSON *probes = cJSON_AddArrayToObject(root, "probes");
  for (uint32_t i = 0; i < set->count; i++) {
    const olx_placed_probe *probe = &set->probes[i];
    cJSON *object = cJSON_CreateObject();
    add_position(object, "position", set->origin, probe->position);
    cJSON_AddStringToObject(object, "origin", olx_probe_origin_name(probe->origin));
    add_share(object, "gain", (double)probe->gain);
    if (probe->buried) cJSON_AddBoolToObject(object, "buried", true);
    cJSON_AddItemToArray(probes, object);
  }
  return root;
}

olx_result olx_probe_set_save(const olx_probe_set *set, const char *path) {
  cJSON *root = describe(set);
  char *text = root ? cJSON_Print(root) : NULL;
  cJSON_Delete(root);
  if (!text) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  const size_t length = strlen(text);
  text[length] = '\n'; // replaces the terminator
  const olx_result result = olx_write_file(path, text, length + 1);
  cJSON_free(text);
  return result;
}

// Finds which of the names the text equals; returns false when it equals none.
static bool find_name(const cJSON *item, const char *(*name)(uint32_t), uint32_t last, uint32_t *value) {
  if (!cJSON_IsString(item)) return false;
  for (uint32_t i = 0; i <= last; i++) {
    if (strcmp(item->valuestring, name(i)) != 0) continue;
    *value = i;
    return true;
  }
  return false;
}

static const char *method_name(uint32_t i) { return olx_place_method_name((olx_place_method)i); }
static const char *optimizer_name(uint32_t i) { return olx_place_optimizer_name((olx_place_optimizer)i); }
static const char *reward_name(uint32_t i) { return olx_place_reward_name((olx_place_reward)i); }
static const char *origin_name(uint32_t i) { return olx_probe_origin_name((olx_probe_origin)i); }

static olx_result read_settings(const char *path, const cJSON *root, olx_place_settings *settings) {
  const cJSON *method = cJSON_GetObjectItemCaseSensitive(root, "method");
  const cJSON *object = cJSON_GetObjectItemCaseSensitive(root, "settings");
  uint32_t which = (uint32_t)settings->method;
  if (method && !find_name(method, method_name, LAST_METHOD, &which)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: method: not one that is known", path);
  }
  settings->method = (olx_place_method)which;
  const cJSON *optimize = cJSON_GetObjectItemCaseSensitive(object, "optimize");
  const cJSON *reward = cJSON_GetObjectItemCaseSensitive(object, "reward");
  uint32_t optimizer = (uint32_t)settings->optimize, rewarded = (uint32_t)settings->reward;
  if (optimize && !find_name(optimize, optimizer_name, OLX_OPTIMIZE_GIBBS, &optimizer)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: settings.optimize: not one that is known", path);
  }
  if (reward && !find_name(reward, reward_name, OLX_REWARD_SUM, &rewarded)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: settings.reward: not one that is known", path);
  }
  settings->optimize = (olx_place_optimizer)optimizer;
  settings->reward = (olx_place_reward)rewarded;
  stored_number numbers[STORED_NUMBERS];
  list_numbers(settings, numbers);
  for (int i = 0; i < STORED_NUMBERS; i++) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, numbers[i].key);
    if (!item) continue;
    bool valid;
    if (numbers[i].whole) (void)olx_json_index(item, UINT32_MAX, numbers[i].whole, &valid);
    else valid = olx_json_float(item, numbers[i].real);
    if (!valid) return olx_fail(OLX_ERROR_FORMAT, "%s: settings.%s: not a number in range", path, numbers[i].key);
  }
  return OLX_OK;
}

static olx_result read_probe(const char *path, const cJSON *item, uint32_t index, const double from[3],
                             olx_placed_probe *probe) {
  double position[3];
  if (!olx_json_doubles(cJSON_GetObjectItemCaseSensitive(item, "position"), position, 3)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: probes[%u].position: expected three finite numbers [x, y, z]", path, index);
  }
  for (int axis = 0; axis < 3; axis++) {
    if (fabs(position[axis]) <= OLX_POSITION_LIMIT_METRES) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: probes[%u].position: %g is not within 2e7 m", path, index, position[axis]);
  }
  const cJSON *origin = cJSON_GetObjectItemCaseSensitive(item, "origin");
  const cJSON *gain = cJSON_GetObjectItemCaseSensitive(item, "gain");
  uint32_t which = OLX_ORIGIN_PINNED;
  if (origin && !find_name(origin, origin_name, LAST_ORIGIN, &which)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: probes[%u].origin: not one that is known", path, index);
  }
  *probe = (olx_placed_probe){
      .position = {(float)(position[0] - from[0]), (float)(position[1] - from[1]), (float)(position[2] - from[2])},
      .origin = (olx_probe_origin)which};
  if (gain && !olx_json_float(gain, &probe->gain)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: probes[%u].gain: expected a finite number", path, index);
  }
  probe->buried = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(item, "buried"));
  return OLX_OK;
}

static olx_result read_set(const char *path, const cJSON *root, olx_probe_set *set) {
  const cJSON *version = cJSON_GetObjectItemCaseSensitive(root, "version");
  const cJSON *hash = cJSON_GetObjectItemCaseSensitive(root, "scene_hash");
  const cJSON *probes = cJSON_GetObjectItemCaseSensitive(root, "probes"), *item = NULL;
  if (version && !(cJSON_IsNumber(version) && version->valuedouble == FORMAT_VERSION)) {
    return olx_fail(OLX_ERROR_VERSION, "%s: version: only %d is known", path, FORMAT_VERSION);
  }
  if (!cJSON_IsArray(probes) || !probes->child) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: probes: expected a list [ ... ] with at least one probe", path);
  }
  if (cJSON_IsString(hash)) set->scene_hash = strtoull(hash->valuestring, NULL, 16);
  OLX_TRY(read_settings(path, root, &set->settings));
  set->probes = olx_allocate((size_t)cJSON_GetArraySize(probes), sizeof *set->probes);
  if (!set->probes) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  cJSON_ArrayForEach(item, probes) {
    OLX_TRY(read_probe(path, item, set->count, set->origin, &set->probes[set->count]));
    set->count++;
  }
  return OLX_OK;
}

olx_result olx_probe_set_load(const char *path, const double origin[3], olx_probe_set *set) {
  *set = (olx_probe_set){.settings = {.method = OLX_PLACE_COVER, .views = 1}};
  if (origin) memcpy(set->origin, origin, sizeof set->origin);
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  cJSON *root = NULL;
  olx_result result = olx_json_parse(path, file.data, file.size_bytes, &root);
  olx_unmap_file(&file);
  if (result != OLX_OK) return result;
  result = read_set(path, root, set);
  cJSON_Delete(root);
  if (result != OLX_OK) olx_probe_set_free(set);
  return result;
}
