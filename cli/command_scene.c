// octalux scene: loads a scene, prints its content, and writes it as a cooked file.
#include "commands.h"
#include "files.h"
#include "options.h"
#include "report.h"
#include "scene_options.h"

#include <octalux/scene.h>

#include <inttypes.h>
#include <stdio.h>

static int print_scene_json(const olx_scene *scene, uint64_t cooked_bytes) {
  const olx_scene_info info = olx_scene_describe(scene);
  cJSON *object = cJSON_CreateObject();
  add_number(object, "triangles", (double)info.triangles);
  add_number(object, "vertices", (double)info.vertices);
  add_number(object, "materials", info.materials);
  add_number(object, "textures", info.textures);
  add_number(object, "lights", info.lights);
  add_number(object, "cameras", info.cameras);
  cJSON_AddItemToObject(object, "origin", cJSON_CreateDoubleArray(info.origin, 3));
  add_position(object, "bounds_min", info.origin, info.bounds_min);
  add_position(object, "bounds_max", info.origin, info.bounds_max);
  add_number(object, "warnings", info.warnings);
  cJSON *messages = cJSON_AddArrayToObject(object, "warning_messages");
  for (uint32_t i = 0; i < info.warnings; ++i) {
    cJSON_AddItemToArray(messages, cJSON_CreateString(olx_scene_warning(scene, i)));
  }
  cJSON *cameras = cJSON_AddArrayToObject(object, "camera_list");
  for (uint32_t i = 0; i < info.cameras; ++i) {
    const olx_camera camera = olx_scene_camera(scene, i);
    cJSON *entry = cJSON_CreateObject();
    add_text(entry, "name", camera.name);
    add_position(entry, "eye", info.origin, camera.eye);
    add_position(entry, "target", info.origin, camera.target);
    add_vec3(entry, "up", camera.up);
    add_float(entry, "fov_y_degrees", camera.fov_y_degrees);
    cJSON_AddItemToArray(cameras, entry);
  }
  cJSON_AddBoolToObject(object, "probe_volume", info.has_probe_volume);
  add_hash(object, "hash", info.hash);
  if (cooked_bytes) add_number(object, "cooked_bytes", (double)cooked_bytes);
  return print_json("scene", object);
}

static bool has_light(const olx_scene *scene) {
  const olx_vec3 sky = olx_scene_get_content(scene).environment->radiance;
  return olx_scene_describe(scene).lights > 0 || sky.x > 0.0f || sky.y > 0.0f || sky.z > 0.0f;
}

static void print_scene(const char *name, const olx_scene *scene) {
  const olx_scene_info info = olx_scene_describe(scene);
  const olx_vec3 low = info.bounds_min, high = info.bounds_max;
  const double *o = info.origin;
  const int digits = o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0 ? 12 : 6;
  printf("%s\n", name);
  printf("  triangles  %" PRIu64 "\n  vertices   %" PRIu64 "\n", info.triangles, info.vertices);
  printf("  materials  %u\n  textures   %u\n  lights     %u\n", info.materials, info.textures, info.lights);
  printf("  bounds     (%.*g, %.*g, %.*g) to (%.*g, %.*g, %.*g) m\n", digits, o[0] + (double)low.x, digits,
         o[1] + (double)low.y, digits, o[2] + (double)low.z, digits, o[0] + (double)high.x, digits,
         o[1] + (double)high.y, digits, o[2] + (double)high.z);
  printf("  hash       %016" PRIx64 "\n", info.hash);
  for (uint32_t i = 0; i < info.cameras; ++i) {
    const olx_camera camera = olx_scene_camera(scene, i);
    char printable[4 * sizeof camera.name];
    olx_printable(camera.name, printable, sizeof printable);
    printf("  camera     %s: at (%.*g, %.*g, %.*g), %g degrees high\n", printable, digits, o[0] + (double)camera.eye.x,
           digits, o[1] + (double)camera.eye.y, digits, o[2] + (double)camera.eye.z, (double)camera.fov_y_degrees);
  }
  for (uint32_t i = 0; i < info.warnings; ++i) printf("  warning    %s\n", olx_scene_warning(scene, i));
  if (!has_light(scene)) {
    printf(
        "  warning    there is no light, so every picture is black: add lights or an environment in a description\n");
  }
}

typedef struct cooking {
  const olx_scene *scene;
  const char *path;
  uint64_t file_bytes;
} cooking;

static olx_result cook(void *user) {
  cooking *c = user;
  return olx_scene_cook(c->scene, c->path, &c->file_bytes);
}

static int cook_scene(const olx_scene *scene, const command_files *files, uint64_t *file_bytes) {
  cooking c = {.scene = scene, .path = files->outputs[0].path};
  if (!c.path) return EXIT_DONE;
  const int code = check_scene_files("scene", files, scene);
  if (code != EXIT_DONE) return code;
  progress_line line;
  progress_begin(&line, "scene", false);
  const olx_progress progress = progress_of(&line);
  const olx_result result = olx_watch(&progress, "cooking", cook, &c);
  progress_end(&line);
  *file_bytes = c.file_bytes;
  if (result == OLX_ERROR_CANCELLED) return failure("scene", "%s: interrupted, nothing written", c.path);
  return result == OLX_OK ? EXIT_DONE : library_failure("scene");
}

static const option cook_option[] = {
    {"--cook", OPTION_TEXT, 0, "FILE.olxs", "write all of it into one file that loads by itself"}, {0}};

int command_scene(int argc, char **argv) {
  bool json = false;
  const char *cooked = NULL;
  scene_options loading = {0};
  command_line line = {.name = "scene",
                       .summary = "What is in a scene: triangles, materials, lights, cameras, bounds, import warnings.",
                       .example = "octalux scene room.gltf",
                       .arguments = {"SCENE"},
                       .tables = {{cook_option, &cooked}, {scene_loading_options, &loading}, {json_option, &json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  olx_scene *scene = NULL;
  if (cooked && !is_output_named(cooked, ".olxs"))
    return usage_error("scene", "--cook: '%s' does not end in .olxs", cooked);
  const command_files files = {.inputs = {line.given[0]}, .outputs = {{cooked, true}}};
  code = check_files("scene", &files, json);
  if (code != EXIT_DONE) return code;
  code = load_scene("scene", line.given[0], &loading, &scene);
  if (code != EXIT_DONE) return code;
  uint64_t file_bytes = 0;
  code = cook_scene(scene, &files, &file_bytes);
  if (code == EXIT_DONE && json) {
    code = print_scene_json(scene, file_bytes);
  } else if (code == EXIT_DONE) {
    print_beside_outputs(&files);
    print_scene(line.given[0], scene);
    if (cooked) printf("  cooked     %s, %" PRIu64 " bytes\n", cooked, file_bytes);
  }
  olx_scene_free(scene);
  return code;
}
