// Tests scenes far from the origin: they have the same light as at the origin, positions in double precision in files,
// and one limit for all positions.
#include "baked_field.h"
#include "field/field_data.h"
#include "scene_files.h"
#include "tiny_scenes.h"

#include <octalux/bake.h>
#include <octalux/place.h>

#define FAR 1e7

// Makes the Cornell box with every kind of light, a camera and rules for probes, moved by a vector.
static olx_scene *moved_room(const scene_folder *folder, double x, double y, double z) {
  char text[2048];
  snprintf(text, sizeof text,
           "{\"model\": \"builtin:cornell\", \"translate\": [%.17g, %.17g, %.17g],"
           "\"cameras\": [{\"name\": \"c\", \"eye\": [%.17g, %.17g, %.17g], \"target\": [%.17g, %.17g, %.17g]}],"
           "\"lights\": [{\"type\": \"point\", \"position\": [%.17g, %.17g, %.17g], \"intensity\": [0.1, 0.1, 0.1]},"
           "{\"type\": \"rect\", \"center\": [%.17g, %.17g, %.17g], \"edge_u\": [0.1, 0, 0], \"edge_v\": [0, 0, 0.1],"
           "\"radiance\": [5, 5, 5]}],"
           "\"probes\": {\"min\": [%.17g, %.17g, %.17g], \"max\": [%.17g, %.17g, %.17g], \"grid\": [2, 2, 2],"
           "\"pinned\": [[%.17g, %.17g, %.17g]]}}",
           x, y, z, x + 0.25, y + 0.25, z + 0.125, x + 0.25, y + 0.25, z + 0.5, x + 0.125, y + 0.25, z + 0.25,
           x + 0.375, y + 0.25, z + 0.25, x + 0.125, y + 0.125, z + 0.125, x + 0.4375, y + 0.4375, z + 0.4375, x + 0.25,
           y + 0.3125, z + 0.25);
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(scene_folder_write_text(folder, "room.json", text), &scene));
  return scene;
}

static void assert_origin(const olx_scene *scene, double x, double y, double z) {
  const olx_scene_info info = olx_scene_describe(scene);
  assert_true(info.origin[0] == x && info.origin[1] == y && info.origin[2] == z);
}

static olx_bake_settings small_bake(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.probe_light = true;
  settings.radiance_size = 32;
  settings.irradiance_size = 16;
  settings.bounces = 1;
  settings.noise = 0.1f;
  return settings;
}

static olx_image picture(const olx_scene *scene, const olx_field *field) {
  olx_render_settings settings = olx_render_settings_default(field ? OLX_METHOD_FIELD : OLX_METHOD_PATH);
  settings.width = settings.height = 24;
  settings.spp = 4;
  settings.bounces = 1;
  const olx_camera camera = olx_scene_camera(scene, 0);
  olx_image image;
  ASSERT_OK(olx_render(scene, field, &camera, &settings, NULL, &image, NULL));
  return image;
}

static double relative_error(const olx_image *a, const olx_image *b) {
  olx_metrics metrics;
  ASSERT_OK(olx_compare(a, b, OLX_LAYER_INDIRECT_DIFFUSE, &metrics));
  return metrics.relative_mse;
}

// A room has the same light everywhere, to the last bit, at the origin and far from it.
static void a_room_far_away_is_lit_as_at_the_origin(void **state) {
  olx_scene *here = moved_room(*state, 0, 0, 0), *there = moved_room(*state, FAR, -FAR, FAR);
  assert_origin(here, 0, 0, 0);
  assert_origin(there, FAR, -FAR, FAR);
  assert_int_equal(here->vertex_count, there->vertex_count);
  assert_memory_equal(here->positions, there->positions, here->vertex_count * sizeof *here->positions);
  assert_memory_equal(here->cameras, there->cameras, here->camera_count * sizeof *here->cameras);
  assert_int_equal(here->light_count, there->light_count);
  for (uint32_t i = 0; i < here->light_count; i++) {
    // The bytes after the last member are padding.
    assert_memory_equal(&here->lights[i], &there->lights[i], offsetof(olx_light, both_sides));
    assert_int_equal(here->lights[i].both_sides, there->lights[i].both_sides);
  }
  assert_memory_equal(&here->probes_min, &there->probes_min, sizeof here->probes_min);
  assert_memory_equal(here->probe_rules.pinned, there->probe_rules.pinned, sizeof(olx_vec3));
  assert_true(here->hash != there->hash);
  const olx_bake_settings settings[2] = {small_bake(here), small_bake(there)};
  olx_field *fields[2] = {baked_field(here, &settings[0], NULL), baked_field(there, &settings[1], NULL)};
  assert_memory_equal(fields[0]->radiance, fields[1]->radiance, 4 * fields[0]->texels * fields[0]->info.probes.count);
  double origin[3];
  olx_field_origin(fields[1], origin);
  assert_true(origin[0] == FAR && origin[1] == -FAR && origin[2] == FAR);
  olx_image field_here = picture(here, fields[0]), field_there = picture(there, fields[1]);
  olx_image path_here = picture(here, NULL), path_there = picture(there, NULL);
  assert_true(relative_error(&field_here, &path_here) > 0.0);
  assert_true(relative_error(&field_here, &path_here) == relative_error(&field_there, &path_there));
  // A field baked at one position is refused for the scene at the other.
  const olx_camera camera = olx_scene_camera(here, 0);
  const olx_render_settings render = olx_render_settings_default(OLX_METHOD_FIELD);
  olx_image wrong;
  assert_int_equal(olx_render(here, fields[1], &camera, &render, NULL, &wrong, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "bake it again"));
  olx_image_free(&field_here);
  olx_image_free(&field_there);
  olx_image_free(&path_here);
  olx_image_free(&path_there);
  for (int i = 0; i < 2; i++) olx_field_close(fields[i]);
  olx_scene_free(here);
  olx_scene_free(there);
}

// A position that is not a multiple of the step is kept to the precision of doubles, some 2e-9 m here, not of floats.
static void any_place_is_kept_in_double_precision(void **state) {
  const double x = 9876543.21, y = -1234567.89, z = 55555.5;
  olx_scene *here = moved_room(*state, 0, 0, 0), *there = moved_room(*state, x, y, z);
  for (uint32_t v = 0; v < here->vertex_count; v++) {
    const olx_vec3 p = here->positions[v], q = there->positions[v];
    assert_true(fabs(there->origin[0] + (double)q.x - (x + (double)p.x)) < 1e-7);
    assert_true(fabs(there->origin[1] + (double)q.y - (y + (double)p.y)) < 1e-7);
    assert_true(fabs(there->origin[2] + (double)q.z - (z + (double)p.z)) < 1e-7);
  }
  olx_scene_free(here);
  olx_scene_free(there);
}

static void scenes_near_the_origin_keep_it(void **state) {
  const char *name;
  for (uint32_t i = 0; (name = olx_builtin_name(i)) != NULL; i++) {
    char path[64];
    snprintf(path, sizeof path, "builtin:%s", name);
    olx_scene *scene = NULL;
    ASSERT_OK(olx_scene_load(path, &scene));
    assert_origin(scene, 0, 0, 0);
    olx_scene_free(scene);
  }
  // The box is one metre across its corners: a position of 10 m counts as near the origin, one of 20 m as far.
  olx_scene *scene = moved_room(*state, 10, 0, 0);
  assert_origin(scene, 0, 0, 0);
  olx_scene_free(scene);
  scene = moved_room(*state, 20, 0, 0);
  assert_origin(scene, 20, 0, 0);
  olx_scene_free(scene);
}

// Floats are a metre apart at this distance, and the translations of nodes must be finer. The three squares have one
// root, or three.
static void load_far_squares(const scene_folder *folder, const char *roots, const char *first_node) {
  char nodes[1024];
  snprintf(nodes, sizeof nodes,
           "[%s, {\"mesh\": 0, \"translation\": [10000000.25, 3, 0]},"
           "{\"mesh\": 0, \"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10000000.5, 3, 0, 1]},"
           "{\"translation\": [1e7, 0, 0], \"children\": [4]},"
           "{\"mesh\": 0, \"translation\": [0.75, 3, 0]}]",
           first_node);
  char *gltf =
      scene_files_gltf("[{\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.5, 0.5, 1]}}]", 0, nodes, "", false);
  static const char one_root[] = "\"nodes\": [0]}]";
  char *const at = strstr(gltf, one_root);
  assert_non_null(at);
  char text[8192];
  snprintf(text, sizeof text, "%.*s\"nodes\": %s}]%s", (int)(at - gltf), gltf, roots, at + sizeof one_root - 1);
  free(gltf);
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(scene_folder_write_text(folder, "far.gltf", text), &scene));
  assert_origin(scene, FAR + 2, 4, 0); // multiples of 2 m that are nearest to the middle
  assert_int_equal(scene->vertex_count, 12);
  for (uint32_t v = 0; v < 4; v++) {
    const float x = scene->positions[v].x;
    assert_true(fabsf(scene->positions[v + 4].x - x - 0.25f) < 1e-6f);
    assert_true(fabsf(scene->positions[v + 8].x - x - 0.5f) < 1e-6f);
  }
  if (scene->warning_count) fail_msg("%s", olx_scene_warning(scene, 0));
  olx_scene_free(scene);
}

static void nodes_are_moved_in_double_precision(void **state) {
  load_far_squares(*state, "[0]", "{\"children\": [1, 2, 3]}");
  load_far_squares(*state, "[1, 2, 3]", "{}");
}

static void coarse_vertices_are_warned_about(void **state) {
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(
      scene_folder_write_text(*state, "far.obj", "v 1000000 0 0\nv 1000001 0 0\nv 1000001 1 0\nf 1 2 3\n"), &scene));
  assert_int_equal(olx_scene_describe(scene).warnings, 1);
  assert_non_null(strstr(olx_scene_warning(scene, 0), "far.obj: vertices are up to 1e+06 from the model's own zero"));
  olx_scene_free(scene);
}

static void a_cooked_scene_keeps_its_place(void **state) {
  const scene_folder *folder = *state;
  olx_scene *scene = moved_room(folder, FAR, 0, -FAR), *cooked = NULL;
  char path[300];
  snprintf(path, sizeof path, "%s/room.olxs", folder->path);
  ASSERT_OK(olx_scene_cook(scene, path, NULL));
  ASSERT_OK(olx_scene_load(path, &cooked));
  assert_origin(cooked, FAR, 0, -FAR);
  assert_true(cooked->hash == scene->hash);
  assert_memory_equal(cooked->positions, scene->positions, scene->vertex_count * sizeof *scene->positions);
  olx_scene_free(cooked);
  olx_scene_free(scene);
}

static void probes_are_written_in_scene_coordinates(void **state) {
  const scene_folder *folder = *state;
  const double origin[3] = {FAR, 0.0, -FAR};
  olx_placed_probe probes[2] = {{.position = {0.1f, 2.0f, -0.3f}}, {.position = {-7.25f, 0.0f, 1e-3f}}};
  olx_probe_set set = {.count = 2, .probes = probes, .origin = {FAR, 0.0, -FAR}}, back;
  set.settings = (olx_place_settings){.method = OLX_PLACE_COVER};
  char path[300];
  snprintf(path, sizeof path, "%s/probes.json", folder->path);
  ASSERT_OK(olx_probe_set_save(&set, path));
  ASSERT_OK(olx_probe_set_load(path, origin, &back));
  for (int i = 0; i < 2; i++) {
    assert_true(fabsf(back.probes[i].position.x - probes[i].position.x) < 1e-7f);
    assert_true(fabsf(back.probes[i].position.z - probes[i].position.z) < 1e-7f);
  }
  olx_probe_set_free(&back);
  ASSERT_OK(olx_probe_set_load(path, NULL, &back));
  assert_true(back.probes[1].position.x == (float)(FAR - 7.25));
  olx_probe_set_free(&back);
}

static void positions_have_one_limit(void **state) {
  const char *path = scene_folder_write_text(
      *state, "p.json", "{\"probes\": [{\"position\": [0, 0, 0]}, {\"position\": [0, 2.1e7, 0]}]}");
  olx_probe_set set;
  assert_int_equal(olx_probe_set_load(path, NULL, &set), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "p.json: probes[1].position: 2.1e+07 is not within 2e7 m"));
  olx_scene *scene = moved_room(*state, 0, 0, 0);
  const olx_vec3 wild[] = {{0.0f, 0.0f, 0.0f}, {1e25f, 0.0f, 0.0f}};
  olx_bake_settings settings = small_bake(scene);
  settings.probes = wild;
  settings.probe_count = 2;
  assert_int_equal(olx_bake(scene, &settings, "/nowhere/a.olx", NULL, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "probe 1 is not within 2e7 m"));
  settings = small_bake(scene);
  settings.grid.origin.y = 1e25f;
  assert_int_equal(olx_bake(scene, &settings, "/nowhere/a.olx", NULL, NULL), OLX_ERROR_ARGUMENT);
  olx_scene_free(scene);
  static const char *const descriptions[][2] = {
      {"{\"model\": \"builtin:cornell\", \"translate\": [3e7, 0, 0]}", "translate"},
      {"{\"model\": \"builtin:cornell\", \"probes\": {\"pinned\": [[0, 0, 0], [0, -1e20, 0]]}}", "probes.pinned[1]"},
      {"{\"model\": \"builtin:cornell\", \"probes\": {\"min\": [0, 0, 0], \"max\": [0, 1e20, 0]}}", "probes.max"},
      {"{\"model\": \"builtin:cornell\", \"cameras\": [{\"eye\": [0, 0, 0], \"target\": [0, 1e8, 0]}]}",
       "cameras[0].target"},
  };
  for (size_t i = 0; i < sizeof descriptions / sizeof *descriptions; i++) {
    assert_int_equal(olx_scene_load(scene_folder_write_text(*state, "wild.json", descriptions[i][0]), &scene),
                     OLX_ERROR_FORMAT);
    assert_non_null(strstr(olx_last_error(), descriptions[i][1]));
  }
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(a_room_far_away_is_lit_as_at_the_origin), WITH_FOLDER(any_place_is_kept_in_double_precision),
      WITH_FOLDER(scenes_near_the_origin_keep_it),          WITH_FOLDER(nodes_are_moved_in_double_precision),
      WITH_FOLDER(coarse_vertices_are_warned_about),        WITH_FOLDER(a_cooked_scene_keeps_its_place),
      WITH_FOLDER(probes_are_written_in_scene_coordinates), WITH_FOLDER(positions_have_one_limit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
