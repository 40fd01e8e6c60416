// Tests what is found in cube maps around probes, without a device: hits are those of cast rays, also at the edges of
// cubes, of surfaces and of masks, and what cubes do not hold is cast.
#include "bake/capture/cube_views.h"
#include "baked_field.h"
#include "cast_cubes.h"
#include "made_scenes.h"

#include "core/octahedral.h"
#include "field/field_data.h"
#include "scene/bvh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 4096, SIZE = 64 };

// Cube maps around one probe.
typedef struct probe_cube {
  olx_bake_settings settings;
  olx_bake_context context;
  olx_vec3 position;
  olx_cube_views views;
} probe_cube;

static void look_around(probe_cube *p, const olx_scene *scene, const olx_bake_raster *raster, olx_vec3 position) {
  *p = (probe_cube){.settings = olx_bake_settings_default(scene), .position = position};
  p->settings.raster = raster;
  p->context = (olx_bake_context){.scene = scene, .settings = &p->settings};
  p->context.probes.light_field = (olx_probe_list){.count = 1, .positions = &p->position};
  assert_int_equal(olx_cube_views_create(&p->settings, SIZE, &p->views), OLX_OK);
  assert_int_equal(olx_cube_views_look(&p->views, &p->context, 0), OLX_OK);
}

// Compares hits with those of cast rays. None may be nearer than the true one; *farther counts those beyond it.
static uint32_t compare(const probe_cube *p, const olx_ray *rays, uint32_t count, uint32_t *farther) {
  const olx_scene *scene = p->context.scene;
  olx_ray_hit *hits = calloc(count, sizeof *hits);
  assert_non_null(hits);
  const uint32_t cast = olx_cube_views_intersect(&p->views, scene, 0, rays, count, hits);
  *farther = 0;
  for (uint32_t i = 0; i < count; i++) {
    const olx_ray_hit truth = olx_bvh_intersect(scene->bvh, &rays[i]);
    if (hits[i].triangle == OLX_NO_HIT || (truth.triangle != OLX_NO_HIT && hits[i].t > truth.t * 1.0001f)) {
      if (truth.triangle != OLX_NO_HIT) ++*farther;
      continue;
    }
    assert_int_not_equal(truth.triangle, OLX_NO_HIT);
    assert_true(hits[i].t >= truth.t * 0.9999f);
    if (hits[i].triangle != truth.triangle) continue;
    assert_true(fabsf(hits[i].u - truth.u) < 1e-3f && fabsf(hits[i].v - truth.v) < 1e-3f);
  }
  free(hits);
  return cast;
}

static void draw_rays(olx_vec3 from, olx_ray rays[RAYS]) {
  for (uint32_t i = 0; i < RAYS; i++) {
    rays[i] = (olx_ray){from, olx_octahedral_decode(made_random(1, i)), 0.0f, INFINITY};
  }
}

// Nothing in the room is narrower than a texel, so every hit is the true one, and only slits beside edges are cast.
static void finds_what_rays_hit(void **unused) {
  (void)unused;
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:cornell-glossy", &scene), OLX_OK);
  const olx_bake_raster raster = cast_cube_raster(scene);
  static olx_ray rays[RAYS];
  const olx_vec3 middle = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  probe_cube p;
  look_around(&p, scene, &raster, olx_add(middle, olx_v3(0.05f, 0.3f, 0.02f)));
  draw_rays(p.position, rays);
  uint32_t farther;
  assert_true(compare(&p, rays, RAYS, &farther) < RAYS / 50);
  assert_true(farther <= RAYS / 1000);
  olx_cube_views_free(&p.views);
  olx_scene_free(scene);
}

// Directions on edges and corners of the cube, exactly and beside.
static void edges_of_the_cube_are_no_seams(void **unused) {
  (void)unused;
  olx_scene *scene = made_scene();
  made_room(scene, olx_v3(0, 0, 0), 4.0f, made_material(scene, &(olx_material){.base_color = olx_splat(0.5f)}));
  made_finish(scene);
  const olx_bake_raster raster = cast_cube_raster(scene);
  static olx_ray rays[RAYS];
  probe_cube p;
  look_around(&p, scene, &raster, olx_v3(0.3f, -0.2f, 0.4f));
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_vec2 random = made_random(2, i);
    float d[3] = {1.0f, i & 1 ? -1.0f : 1.0f, i % 7 ? 2.0f * random.x - 1.0f : 1.0f};
    if (i & 2) d[0] = -d[0];
    if (i & 4) d[1] *= 1.0f + 1e-4f * (random.y - 0.5f);
    rays[i] = (olx_ray){p.position, olx_v3(d[i % 3], d[(i + 1) % 3], d[(i + 2) % 3]), 0.0f, INFINITY};
  }
  uint32_t farther;
  assert_true(compare(&p, rays, RAYS, &farther) < RAYS / 50);
  assert_int_equal(farther, 0);
  olx_cube_views_free(&p.views);
  olx_scene_free(scene);
}

// A probe over a floor and under a plate whose holes are read from a texture; beside both is the sky.
static olx_scene *masked_scene(void) {
  static const uint8_t texels[4 * 4] = {9, 9, 9, 255, 9, 9, 9, 0, 9, 9, 9, 0, 9, 9, 9, 255};
  olx_scene *scene = made_scene();
  olx_material plate = {.base_color = olx_splat(0.5f), .alpha = 1.0f, .alpha_cutoff = 0.5f};
  plate.alpha_texture = plate.metallic_roughness_texture = plate.emission_texture = plate.normal_texture =
      OLX_NO_TEXTURE;
  plate.base_color_texture = made_texture(scene, 2, 2, texels, true);
  made_square(scene, 0.4f, made_material(scene, &plate));
  made_square(scene, 0.9f, made_material(scene, &(olx_material){.base_color = olx_splat(0.5f)}));
  made_square(scene, -0.5f, made_material(scene, &(olx_material){.base_color = olx_splat(0.5f)}));
  return made_finish(scene);
}

static void masks_have_holes(void **unused) {
  (void)unused;
  olx_scene *scene = masked_scene();
  const olx_bake_raster raster = cast_cube_raster(scene);
  static olx_ray rays[RAYS];
  probe_cube p;
  look_around(&p, scene, &raster, olx_v3(0.1f, 0.0f, 0.2f));
  draw_rays(p.position, rays);
  uint32_t farther;
  assert_true(compare(&p, rays, RAYS, &farther) < RAYS / 20);
  assert_int_equal(farther, 0);
  olx_cube_views_free(&p.views);
  olx_scene_free(scene);
}

static const char *see_sky(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side, uint32_t *triangles) {
  (void)user;
  (void)positions;
  memset(triangles, 0xFF, (size_t)count * 6 * side * side * sizeof *triangles);
  return NULL;
}

// Every texel holds a triangle that few rays meet.
static const char *see_one(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side, uint32_t *triangles) {
  (void)user;
  (void)positions;
  memset(triangles, 0, (size_t)count * 6 * side * side * sizeof *triangles);
  return NULL;
}

static void what_cubes_do_not_hold_is_cast(void **unused) {
  (void)unused;
  olx_scene *scene = masked_scene();
  static olx_ray rays[RAYS];
  static olx_ray_hit hits[RAYS];
  probe_cube p;
  look_around(&p, scene, &(olx_bake_raster){.name = "sky", .look = see_sky}, olx_v3(0, 0, 0));
  draw_rays(p.position, rays);
  assert_int_equal(olx_cube_views_intersect(&p.views, scene, 0, rays, RAYS, hits), 0);
  for (uint32_t i = 0; i < RAYS; i++) assert_int_equal(hits[i].triangle, OLX_NO_HIT);
  olx_cube_views_free(&p.views);
  look_around(&p, scene, &(olx_bake_raster){.name = "one", .look = see_one}, olx_v3(0, 0, 0));
  const uint32_t cast = olx_cube_views_intersect(&p.views, scene, 0, rays, RAYS, hits);
  uint32_t other = 0;
  for (uint32_t i = 0; i < RAYS; i++) {
    if (hits[i].triangle == 0) continue;
    const olx_ray_hit truth = olx_bvh_intersect(scene->bvh, &rays[i]);
    assert_int_equal(hits[i].triangle, truth.triangle);
    other++;
  }
  assert_true(other > RAYS / 2 && cast >= other);
  olx_cube_views_free(&p.views);
  olx_scene_free(scene);
}

// ---- Baking with a raster

static olx_bake_settings small_bake(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid.count[0] = settings.grid.count[1] = settings.grid.count[2] = 1;
  settings.irradiance_grid = settings.grid;
  settings.radiance_size = 16;
  settings.noise = 1.0f;
  settings.bounces = 0;
  settings.volume_cells = 8;
  return settings;
}

static const char *lose_device(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side,
                               uint32_t *triangles) {
  (void)positions;
  (void)count;
  (void)side;
  (void)triangles;
  ++*(uint32_t *)user;
  return "the device was lost";
}

static void failures_end_the_bake(void **unused) {
  (void)unused;
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:cornell", &scene), OLX_OK);
  olx_bake_settings settings = small_bake(scene);
  uint32_t calls = 0;
  settings.raster = &(olx_bake_raster){.name = "broken", .look = lose_device, .user = &calls};
  assert_int_equal(olx_bake(scene, &settings, "unwritten.olx", NULL, NULL), OLX_ERROR_GPU);
  assert_non_null(strstr(olx_last_error(), "broken: the device was lost"));
  assert_int_equal(calls, 1);
  const olx_bake_raster wrong[] = {{.look = lose_device}, {.name = "a"}, {.name = "a\nb", .look = lose_device}};
  for (uint32_t i = 0; i < 3; i++) {
    settings.raster = &wrong[i];
    assert_int_equal(olx_bake(scene, &settings, "unwritten.olx", NULL, NULL), OLX_ERROR_ARGUMENT);
  }
  olx_scene_free(scene);
}

// A bake with cubes that hold what rays find has the geometry of the bake with rays, at any number of threads.
static void bakes_are_those_of_rays(void **unused) {
  (void)unused;
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:cornell", &scene), OLX_OK);
  olx_bake_settings settings = small_bake(scene);
  settings.uncompressed = true;
  olx_field *cast = baked_field(scene, &settings, NULL);
  const olx_bake_raster raster = cast_cube_raster(scene);
  settings.raster = &raster;
  baked_field_at_any_threads(scene, &settings);
  olx_bake_stats stats;
  olx_field *drawn = baked_field(scene, &settings, &stats);
  assert_int_equal(drawn->size_bytes, cast->size_bytes);
  assert_true(stats.raster_seconds > 0.0 && stats.raster_rays < stats.primary_rays / 50);
  uint32_t different = 0;
  const olx_field_info info = olx_field_describe(drawn);
  assert_int_equal(info.maps.size, 16);
  for (uint32_t i = 0; i < 18 * 18; i++) different += drawn->distance[i] != cast->distance[i];
  assert_true(different <= 2);
  olx_field_close(drawn);
  olx_field_close(cast);
  olx_scene_free(scene);
}

// ---- Which probes are rasterised together

typedef struct asked_probes {
  uint32_t calls, counts[8];
  float first[8];
} asked_probes;

static const char *note(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side, uint32_t *triangles) {
  asked_probes *asked = user;
  asked->counts[asked->calls] = count;
  asked->first[asked->calls++] = positions[0].x;
  for (uint32_t p = 0; p < count; p++) triangles[(size_t)p * 6 * side * side] = (uint32_t)positions[p].x;
  return NULL;
}

static void parts_rasterise_their_own_probes(void **unused) {
  (void)unused;
  enum { PROBES = 40, PARTS = 3 };
  olx_vec3 positions[PROBES];
  for (uint32_t i = 0; i < PROBES; i++) positions[i] = olx_v3((float)i, 0.0f, 0.0f);
  asked_probes asked = {0};
  const olx_bake_raster raster = {.name = "notes", .look = note, .user = &asked};
  olx_bake_settings settings = olx_bake_settings_default(NULL);
  settings.raster = &raster;
  settings.work.part = 2;
  settings.work.parts = PARTS;
  olx_bake_context context = {.settings = &settings};
  context.probes.light_field = (olx_probe_list){.count = PROBES, .positions = positions};
  olx_cube_views views;
  assert_int_equal(olx_cube_views_create(&settings, 32, &views), OLX_OK);
  for (uint32_t probe = 1; probe < PROBES; probe += PARTS) {
    assert_int_equal(olx_cube_views_look(&views, &context, probe), OLX_OK);
    const size_t texels = (size_t)6 * views.side * views.side;
    assert_int_equal(views.triangles[(probe - views.first) / PARTS * texels], probe);
  }
  assert_int_equal(asked.calls, 1); // 13 probes fit into one call of at most 16
  assert_int_equal(asked.counts[0], 13);
  assert_true(asked.first[0] == 1.0f);
  olx_cube_views_free(&views);
  // Maps that are larger than the memory of one call are rasterised one by one.
  settings.work.parts = 0;
  assert_int_equal(olx_cube_views_create(&settings, 2048, &views), OLX_OK);
  assert_int_equal(views.capacity, 1);
  assert_true(olx_cube_views_bytes(&settings, 2048) >= (uint64_t)6 * views.side * views.side * 4);
  olx_cube_views_free(&views);
  settings.raster = NULL;
  assert_int_equal(olx_cube_views_bytes(&settings, 2048), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(finds_what_rays_hit),
      cmocka_unit_test(edges_of_the_cube_are_no_seams),
      cmocka_unit_test(masks_have_holes),
      cmocka_unit_test(what_cubes_do_not_hold_is_cast),
      cmocka_unit_test(failures_end_the_bake),
      cmocka_unit_test(bakes_are_those_of_rays),
      cmocka_unit_test(parts_rasterise_their_own_probes),
  };
  return cmocka_run_group_tests_name("cube_views", tests, NULL, NULL);
}
