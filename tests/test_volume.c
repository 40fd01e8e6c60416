// Tests the irradiance volume: correct light in free space, no light through walls however thin, the same bytes at any
// number of threads, and refusals of invalid structures.
#include "baked_field.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "field/field_chunks.h"
#include "made_scenes.h"
#include "scene/builtin/builtin_shapes.h"
#include "scene/bvh.h"
#include "shade/surface_irradiance.h"

#include <octalux/render.h>
#include <octalux/sample.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { PLACES = 4000 };

static const float ALBEDO = 0.5f;

static olx_bake_settings small_settings(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 128; // smallest cells are an eighth of the scene
  settings.irradiance_size = 32;
  settings.samples = 1;
  settings.bounces = 1;
  settings.fit = false;
  settings.threads = 2;
  return settings;
}

static uint32_t grey(olx_scene *scene, float emission) {
  olx_material material = olx_material_default();
  material.base_color = olx_splat(ALBEDO);
  material.roughness = 1.0f;
  material.specular_weight = 0.0f;
  material.emission = olx_splat(emission);
  return made_material(scene, &material);
}

static void add_room(olx_scene *scene, olx_vec3 low, olx_vec3 high, uint32_t material) {
  const uint32_t materials[6] = {material, material, material, material, material, material};
  assert_int_equal(olx_add_room(scene, "room", low, high, materials), OLX_OK);
}

static olx_vec3 random_place(olx_vec3 low, olx_vec3 high, uint32_t i) {
  const olx_vec3 share = {olx_unit_float(olx_hash3(i, 1, 2)), olx_unit_float(olx_hash3(i, 3, 4)),
                          olx_unit_float(olx_hash3(i, 5, 6))};
  return olx_add(low, olx_mul(share, olx_sub(high, low)));
}

static olx_vec3 random_normal(uint32_t i) { return olx_sample_sphere(olx_stratified2(i, 77)); }

static bool is_within(olx_vec3 p, olx_vec3 low, olx_vec3 high) {
  return p.x > low.x && p.y > low.y && p.z > low.z && p.x < high.x && p.y < high.y && p.z < high.z;
}

// Asserts that points of a room, up to its walls and on them as surfaces, have probes of that room alone.
static void assert_served_from_within(const olx_field *field, olx_vec3 low, olx_vec3 high) {
  static const olx_vec3 inwards[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (uint32_t i = 0; i < PLACES; i++) {
    olx_vec3 p = random_place(olx_add(low, olx_splat(0.001f)), olx_sub(high, olx_splat(0.001f)), i),
             normal = random_normal(i);
    const uint32_t wall = i % 12;
    if (wall < 6) normal = inwards[wall];
    if (wall < 2) p.x = wall ? high.x : low.x;
    else if (wall < 4) p.y = wall & 1 ? high.y : low.y;
    else if (wall < 6) p.z = wall & 1 ? high.z : low.z;
    olx_volume_place place = {.probes = NULL};
    if (!olx_volume_find_at(&field->volume, p, normal, &place)) {
      fail_msg("no cell at (%g %g %g)", (double)p.x, (double)p.y, (double)p.z);
    }
    for (uint32_t k = 0; k < OLX_VOLUME_CORNERS; k++) {
      const olx_vec3 q = field->volume.positions[place.probes[k]];
      if (is_within(q, low, high)) continue;
      fail_msg("(%g %g %g) has a probe at (%g %g %g)", (double)p.x, (double)p.y, (double)p.z, (double)q.x, (double)q.y,
               (double)q.z);
    }
  }
}

// Sets two probes, one on either side of x = 0.
static void set_two_probes(olx_bake_settings *settings) {
  settings->grid = (olx_grid){.origin = {-1.0f, 0.1f, 0.2f}, .spacing = {2.2f, 0.0f, 0.0f}, .count = {2, 1, 1}};
  settings->irradiance_grid = settings->grid;
}

// In a room whose walls all emit 1 W/(sr m^2), surfaces receive pi of it, and their reflections with an albedo a add pi
// (a + a^2 + ...) at any point, whatever the normal: a term for each surface of a path.
static void a_glowing_room_follows_the_series(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  add_room(scene, olx_v3(-2, -1, -1), olx_v3(1.9f, 1.3f, 1.4f), grey(scene, 1.0f));
  made_finish(scene);
  olx_bake_settings settings = small_settings(scene);
  set_two_probes(&settings);
  for (uint32_t bounces = 0; bounces < 3; bounces++) {
    settings.bounces = bounces;
    olx_bake_stats stats;
    olx_field *field = baked_field(scene, &settings, &stats);
    float expected = 0.0f;
    for (uint32_t k = 0; k <= bounces; k++) expected += OLX_PI * powf(ALBEDO, (float)k + 1.0f);
    assert_true(stats.volume_probes > 100 && stats.volume_unserved == 0.0);
    double sum = 0.0, squares = 0.0;
    for (uint32_t i = 0; i < PLACES; i++) {
      const olx_vec3 place = random_place(olx_v3(-2, -1, -1), olx_v3(1.9f, 1.3f, 1.4f), i);
      const float error = olx_volume_irradiance(field, place, random_normal(i)).y / expected - 1.0f;
      sum += (double)error;
      squares += (double)(error * error);
    }
    // Each of 256 rays samples the light on the wall that it meets, with a deviation of about a third.
    const double mean = sum / PLACES, deviation = sqrt(squares / PLACES);
    if (fabs(mean) > 0.01 || deviation > 0.03) fail_msg("%u bounces: %g off, deviation %g", bounces, mean, deviation);
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// The faces and ends of the wall are on no plane between cells.
static void rooms_behind_a_thin_wall_have_probes_of_their_own(void **state) {
  (void)state;
  static const float thickness[] = {0.02f, 0.03f, 0.04f};
  for (uint32_t i = 0; i < 3; i++) {
    olx_scene *scene = made_scene();
    const olx_vec3 low = {-2, -1.07f, -1.03f}, high = {2.3f, 1.31f, 1.43f};
    const float face = 0.137f, back = face + thickness[i];
    add_room(scene, low, olx_v3(face, high.y, high.z), grey(scene, 1.0f));
    add_room(scene, olx_v3(back, low.y, low.z), high, grey(scene, 0.0f));
    made_finish(scene);
    olx_bake_settings settings = small_settings(scene);
    settings.noise = 0.5f; // light does not matter here
    set_two_probes(&settings);
    olx_field *field = baked_field(scene, &settings, NULL);
    assert_served_from_within(field, low, olx_v3(face, high.y, high.z));
    assert_served_from_within(field, olx_v3(back, low.y, low.z), high);
    olx_field_close(field);
    olx_scene_free(scene);
  }
}

// The smallest cells are a metre wide here, and a border of theirs is at y = -1. Floors are rarely exactly where they
// seem to be.
static void a_floor_just_behind_a_border_of_cells_is_served(void **state) {
  (void)state;
  static const float millimetres[] = {0.05f, 0.1f, 0.2f, 0.43f, 0.48f, 0.5f, 0.7f, 0.95f, 1.0f, 1.5f, 3.0f};
  for (uint32_t i = 0; i < sizeof millimetres / sizeof *millimetres; i++) {
    const olx_vec3 low = {-2, -1 - 1e-3f * millimetres[i], -1.03f}, high = {2.3f, 1.31f, 1.43f};
    olx_scene *scene = made_scene();
    add_room(scene, low, high, grey(scene, 1.0f));
    made_finish(scene);
    olx_bake_settings settings = small_settings(scene);
    settings.noise = 0.5f; // light does not matter here
    set_two_probes(&settings);
    olx_bake_stats stats;
    olx_field *field = baked_field(scene, &settings, &stats);
    assert_served_from_within(field, low, high);
    assert_true(stats.volume_unserved == 0.0);
    olx_field_close(field);
    olx_scene_free(scene);
  }
}

// A screen divides a room but for a gap above it, and one of its faces lies 1 cm behind a border of cells. The cells at
// the gap are one space on both sides of the screen, so a coarse cell has probes behind the screen alone.
static void places_beside_an_opening_see_their_probes(void **state) {
  (void)state;
  const olx_vec3 low = {-2, -1, -1}, high = {2, 1.5f, 1.5f};
  const float face = 0.01f, top = 0.7f;
  olx_scene *scene = made_scene();
  const uint32_t wall = grey(scene, 1.0f);
  add_room(scene, low, high, wall);
  assert_int_equal(olx_add_box(scene, "screen", olx_v3(face, low.y, low.z), olx_v3(face + 0.1f, high.y, top), wall),
                   OLX_OK);
  made_finish(scene);
  olx_bake_settings settings = small_settings(scene);
  settings.noise = 0.5f; // light does not matter here
  set_two_probes(&settings);
  olx_field *field = baked_field(scene, &settings, NULL);
  uint32_t blind = 0;
  for (uint32_t i = 0; i < PLACES; i++) {
    olx_vec3 p = random_place(olx_v3(face, low.y, top - 0.2f), olx_v3(face, high.y, top), i);
    olx_volume_place place;
    assert_true(olx_volume_find_at(&field->volume, p, olx_v3(-1, 0, 0), &place));
    p.x -= 1e-4f;
    float seen = 0.0f;
    for (uint32_t k = 0; k < OLX_VOLUME_CORNERS; k++) {
      if (olx_bvh_is_clear(scene->bvh, p, field->volume.positions[place.probes[k]])) seen += place.weights[k];
    }
    blind += seen < 0.1f;
  }
  print_message("%u of %u places see less than a tenth of what lights them\n", blind, (unsigned)PLACES);
  assert_true(blind < PLACES / 50);
  olx_field_close(field);
  olx_scene_free(scene);
}

static void the_sides_of_a_sheet_have_probes_of_their_own(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_vec3 low = {-2, -1.07f, -1.03f}, high = {2.3f, 1.31f, 1.43f};
  add_room(scene, low, high, grey(scene, 0.0f));
  made_quad(scene, olx_v3(0.137f, 0.12f, 0.2f), olx_v3(0, 0, 2.46f), olx_v3(0, 2.38f, 0), grey(scene, 0.0f));
  made_finish(scene);
  olx_bake_settings settings = small_settings(scene);
  settings.noise = 0.5f; // how much light there is does not matter here
  set_two_probes(&settings);
  olx_field *field = baked_field(scene, &settings, NULL);
  assert_served_from_within(field, low, olx_v3(0.137f, high.y, high.z));
  assert_served_from_within(field, olx_v3(0.137f, low.y, low.z), high);
  olx_field_close(field);
  olx_scene_free(scene);
}

// Irradiance probes of the same bake, for comparison, have several times the error.
static void light_in_free_space_is_that_of_path_tracing(void **state) {
  (void)state;
  static const char *const names[] = {"builtin:cornell", "builtin:labyrinth"};
  for (uint32_t i = 0; i < 2; i++) {
    olx_scene *scene;
    assert_int_equal(olx_scene_load(names[i], &scene), OLX_OK);
    olx_bake_settings settings = small_settings(scene);
    settings.radiance_size = 256;
    settings.noise = 0.1f;
    settings.probe_light = true; // irradiance probes to compare with
    olx_bake_stats stats;
    olx_field *field = baked_field(scene, &settings, &stats);
    assert_true(stats.volume_bytes <= 1300ull * stats.volume_probes);
    olx_audit_settings audit = olx_audit_settings_default();
    audit.rays = audit.points = 0;
    audit.space_points = 150;
    audit.spp = 64;
    audit.threads = 2;
    olx_audit found;
    assert_int_equal(olx_audit_field(scene, field, &audit, NULL, &found), OLX_OK);
    print_message("%s: volume %g, bias %g, probes %g\n", names[i], found.space_volume.relative_mse,
                  found.space_volume.bias, found.space_probes.relative_mse);
    assert_true(found.space_volume.count == 6 * audit.space_points && found.space_served > 0.99);
    assert_true(found.space_volume.relative_mse <= 0.5 * found.space_probes.relative_mse);
    olx_field_close(field);
    olx_scene_free(scene);
  }
}

static void bytes_do_not_depend_on_threads(void **state) {
  (void)state;
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:two-rooms-sealed", &scene), OLX_OK);
  olx_bake_settings settings = small_settings(scene);
  settings.radiance_size = 64;
  settings.noise = 0.1f;
  baked_field_at_any_threads(scene, &settings);
  olx_scene_free(scene);
}

// No light reaches the other room, and no light of the first room is taken for it.
static void space_that_nothing_reaches_is_dark(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  add_room(scene, olx_v3(-2, -1, -1), olx_v3(1.9f, 1.3f, 1.4f), grey(scene, 1.0f));
  add_room(scene, olx_v3(3, -1, -1), olx_v3(6, 1.3f, 1.4f), grey(scene, 0.0f));
  made_finish(scene);
  olx_bake_settings settings = small_settings(scene);
  settings.noise = 0.5f; // how much light there is does not matter here
  set_two_probes(&settings);
  olx_field *field = baked_field(scene, &settings, NULL);
  for (uint32_t i = 0; i < PLACES; i++) {
    const olx_vec3 place = random_place(olx_v3(3, -1, -1), olx_v3(6, 1.3f, 1.4f), i);
    assert_true(olx_max3(olx_volume_irradiance(field, place, random_normal(i))) == 0.0f);
  }
  olx_field_close(field);
  olx_scene_free(scene);
}

// Seen from outside, a lit room has dark walls: texels store no light there, and points without stored light get none.
// The room is bounded by a sheet, or by a wall with two faces.
static void a_room_does_not_glow_outside(void **state) {
  (void)state;
  static const olx_vec3 outwards[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (uint32_t faces = 1; faces <= 2; faces++) {
    const olx_vec3 low = {-2, -1, -1}, high = {1.9f, 1.3f, 1.4f}, wall = olx_splat(faces == 2 ? 0.05f : 0.0f);
    const olx_vec3 outer_low = olx_sub(low, wall), outer_high = olx_add(high, wall);
    olx_scene *scene = made_scene();
    add_room(scene, low, high, grey(scene, 1.0f));
    if (faces == 2) add_room(scene, outer_low, outer_high, grey(scene, 0.0f));
    made_finish(scene);
    olx_bake_settings settings = small_settings(scene);
    settings.noise = 0.5f; // how much light there is does not matter here
    set_two_probes(&settings);
    olx_field *field = baked_field(scene, &settings, NULL);
    const olx_sample_settings sample = olx_sample_settings_default();
    for (uint32_t i = 0; i < PLACES; i++) {
      olx_vec3 p = random_place(outer_low, outer_high, i);
      const uint32_t side = i % 6;
      const float away = i % 12 < 6 ? 0.0f : 0.1f * olx_unit_float(olx_hash(i));
      if (side < 2) p.x = side ? outer_low.x - away : outer_high.x + away;
      else if (side < 4) p.y = side & 1 ? outer_low.y - away : outer_high.y + away;
      else p.z = side & 1 ? outer_low.z - away : outer_high.z + away;
      const olx_vec3 normal = outwards[side];
      const olx_vec3 light = olx_surface_irradiance(field, &sample, p, normal, normal, normal);
      if (olx_max3(light) > 0.0f || olx_max3(olx_volume_irradiance(field, p, normal)) > 0.0f) {
        fail_msg("%u faces: light of %g at (%g %g %g)", faces, (double)light.y, (double)p.x, (double)p.y, (double)p.z);
      }
    }
    olx_field_close(field);
    olx_scene_free(scene);
  }
}

// A field without a volume uses irradiance probes.
static void without_a_volume_irradiance_probes_answer(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  made_square(scene, 0.0f, grey(scene, 1.0f)); // a flat scene, which encloses no space
  made_finish(scene);
  olx_bake_settings settings = small_settings(scene);
  settings.radiance_size = 32;
  settings.grid = (olx_grid){.origin = {0, 1, 0}, .count = {1, 1, 1}};
  settings.irradiance_grid = settings.grid;
  settings.probe_light = true;
  olx_bake_stats stats;
  olx_field *field = baked_field(scene, &settings, &stats);
  assert_int_equal(stats.volume_probes, 0);
  assert_true(stats.volume_unserved == 1.0);
  assert_int_equal(olx_field_describe(field).volume.probe_count, 0);
  const olx_sample_settings sample = olx_sample_settings_default();
  const olx_vec3 p = {0.1f, 0.9f, 0.2f}, down = {0, -1, 0};
  const olx_vec3 light = olx_volume_irradiance(field, p, down), probes = olx_irradiance(field, &sample, p, down, down);
  assert_memory_equal(&light, &probes, sizeof light);
  assert_true(olx_max3(olx_volume_irradiance(field, olx_v3(NAN, 0, 0), down)) == 0.0f);
  assert_true(olx_max3(olx_volume_irradiance(field, p, olx_v3(0, INFINITY, 0))) == 0.0f);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- structures

// Two cubes side by side: the first is divided into 64 parts, one of which is split by a plane; the second is one cell.
typedef struct made_volume {
  olx_volume_header header;
  olx_volume_split splits[1];
  olx_volume_cell cells[2];
  uint32_t blocks[OLX_VOLUME_BLOCK_ENTRIES], index[2];
} made_volume;

static made_volume made(void) {
  made_volume v = {.header = {.origin = {-2, 0, 0},
                              .cube_metres = 2,
                              .size = {2, 1, 1},
                              .blocks = 1,
                              .splits = 1,
                              .cells = 2,
                              .probes = 3},
                   .splits = {{.normal = {1, 0, 0},
                               .offset = -1.9f,
                               .behind = OLX_VOLUME_CELL | 2u << OLX_VOLUME_LEVEL_SHIFT,
                               .front = OLX_VOLUME_CELL | 2u << OLX_VOLUME_LEVEL_SHIFT | 1u}},
                   .cells = {{{0, 1, 0, 1, 0, 1, 0, 1}}, {{2, 2, 2, 2, 2, 2, 2, 2}}},
                   .index = {OLX_VOLUME_BLOCK, OLX_VOLUME_CELL}};
  v.blocks[0] = OLX_VOLUME_SPLIT;
  return v;
}

static void a_place_finds_its_cell(void **state) {
  (void)state;
  const made_volume m = made();
  olx_volume v;
  olx_volume_place place;
  assert_int_equal(olx_volume_open(&m, sizeof m, "made", &v), OLX_OK);
  assert_true(olx_volume_find(&v, olx_v3(0.5f, 1, 1), &place)); // in the second cube
  assert_ptr_equal(place.probes, v.cells[0].probes);
  assert_true(fabsf(place.weights[0] - 0.75f * 0.25f) < 1e-6f && fabsf(place.weights[7] - 0.25f * 0.25f) < 1e-6f);
  assert_true(olx_volume_find(&v, olx_v3(-1.95f, 0.1f, 0.1f), &place)); // behind the splitting plane
  assert_ptr_equal(place.probes, v.cells[0].probes);
  assert_true(fabsf(place.weights[1] - 0.1f * 0.8f * 0.8f) < 1e-5f);    // weights in a cell of 0.5 m
  assert_true(olx_volume_find(&v, olx_v3(-1.85f, 0.1f, 0.1f), &place)); // in front of the splitting plane
  assert_ptr_equal(place.probes, v.cells[1].probes);
  assert_false(olx_volume_find(&v, olx_v3(-1.0f, 1, 1), &place)); // in a part without a cell
  static const olx_vec3 outside[] = {{-2.1f, 1, 1}, {2.0f, 1, 1}, {0, -0.1f, 0},
                                     {0, 0, 2.5f},  {NAN, 0, 0},  {0, INFINITY, 0}};
  for (uint32_t i = 0; i < sizeof outside / sizeof outside[0]; i++)
    assert_false(olx_volume_find(&v, outside[i], &place));
}

static void assert_refused(const made_volume *m, const char *what) {
  olx_volume v;
  assert_int_equal(olx_volume_open(m, sizeof *m, "made", &v), OLX_ERROR_FORMAT);
  if (!strstr(olx_last_error(), what)) fail_msg("'%s' does not say '%s'", olx_last_error(), what);
}

static void structures_that_lead_nowhere_are_refused(void **state) {
  (void)state;
  made_volume m = made();
  m.index[1] = OLX_VOLUME_CELL | 2u;
  assert_refused(&m, "cube 1: entry");
  m = made(), m.index[1] = OLX_VOLUME_BLOCK | 1u;
  assert_refused(&m, "cube 1: entry");
  m = made(), m.index[1] = 5u;
  assert_refused(&m, "cube 1: entry");
  m = made(), m.blocks[3] = OLX_VOLUME_BLOCK; // an entry that refers to its own block
  assert_refused(&m, "block 0: entry");
  m = made(), m.blocks[3] = OLX_VOLUME_CELL | 5u << OLX_VOLUME_LEVEL_SHIFT;
  assert_refused(&m, "block 0: entry");
  m = made(), m.splits[0].front = OLX_VOLUME_SPLIT; // a side that refers to its own split
  assert_refused(&m, "split 0: entry");
  m = made(), m.splits[0].behind = OLX_VOLUME_BLOCK;
  assert_refused(&m, "split 0: entry");
  m = made(), m.splits[0].normal[1] = NAN;
  assert_refused(&m, "split 0 is no plane");
  m = made(), m.cells[1].probes[7] = 3;
  assert_refused(&m, "cell 1 names probe 3 of 3");
  m = made(), m.header.cube_metres = 3.0f;
  assert_refused(&m, "cubes of 3 metres");
  m = made(), m.header.size[1] = 0;
  assert_refused(&m, "0 cubes along y");
  m = made(), m.header.cells = 3;
  assert_refused(&m, "bytes where its contents take");
  m = made(), m.header.zero[2] = 1;
  assert_refused(&m, "reserved bytes");
  m = made(), m.header.probes = 0;
  assert_refused(&m, "0 probes");
  m = made(), m.header.origin[0] = NAN;
  assert_refused(&m, "origin");
}

static void impossible_irradiance_is_found(void **state) {
  (void)state;
  uint16_t halves[2 * OLX_VOLUME_HALVES] = {0};
  char name[] = "made";
  const olx_field field = {.name = name, .volume = {.irradiance = halves}};
  assert_int_equal(olx_volume_verify(&field, 1), OLX_OK);
  halves[OLX_VOLUME_HALVES + 4] = 0x7C00u;
  assert_int_equal(olx_volume_verify(&field, 1), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "volume probe 1: coefficient 1"));
  assert_int_equal(olx_volume_verify(&field, 0), OLX_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_glowing_room_follows_the_series),
      cmocka_unit_test(rooms_behind_a_thin_wall_have_probes_of_their_own),
      cmocka_unit_test(a_floor_just_behind_a_border_of_cells_is_served),
      cmocka_unit_test(places_beside_an_opening_see_their_probes),
      cmocka_unit_test(the_sides_of_a_sheet_have_probes_of_their_own),
      cmocka_unit_test(light_in_free_space_is_that_of_path_tracing),
      cmocka_unit_test(bytes_do_not_depend_on_threads),
      cmocka_unit_test(space_that_nothing_reaches_is_dark),
      cmocka_unit_test(a_room_does_not_glow_outside),
      cmocka_unit_test(without_a_volume_irradiance_probes_answer),
      cmocka_unit_test(a_place_finds_its_cell),
      cmocka_unit_test(structures_that_lead_nowhere_are_refused),
      cmocka_unit_test(impossible_irradiance_is_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
