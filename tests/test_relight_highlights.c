// Tests specular reflections of direct light on its way from surfel to surfel: with two surfels alone, and with a floor
// under a low sun between two walls.
#include "core/bsdf.h"
#include "core/pack.h"
#include "core/sampling.h"
#include "relight/relighter.h"
#include "scene_files.h"
#include "tiny_scenes.h"

#include <octalux/bake.h>
#include <octalux/octalux.h>

#include <unistd.h>

// ---- Two surfels: light of one reaches the other over a link

enum { FLOOR, PLACE };

typedef struct two_surfels {
  olx_relight_surfel surfels[2];
  uint32_t link_starts[3];
  olx_relight_link link;
  olx_relight_header header;
  olx_relight_data data;
  olx_vec3 direct[2], beams[2];
  olx_relit_surfels lit;
} two_surfels;

static const olx_vec3 LIGHT = {2.0f, 1.0f, 4.0f};

// Makes a floor at the origin that faces up, whose link has a straight share of three quarters, a place that it lights,
// and a beam that comes from `from`.
static void make(two_surfels *t, olx_vec3 place, olx_vec3 from) {
  *t = (two_surfels){.link_starts = {0, 0, 1},
                     .link = {FLOOR | 191u << 24, olx_rgb9e5_pack(olx_splat(0.125f))},
                     .header = {.surfels = 2, .links = 1},
                     .direct = {LIGHT},
                     .beams = {olx_scale(from, olx_luminance(LIGHT))}};
  t->surfels[FLOOR] = (olx_relight_surfel){
      .normal = olx_normal_pack(olx_v3(0.0f, 1.0f, 0.0f)), .diffuse = 102, .specular = 51, .f0 = 10, .alpha = 23};
  olx_store3(t->surfels[PLACE].points[0], place);
  t->data =
      (olx_relight_data){.header = &t->header, .surfels = t->surfels, .link_starts = t->link_starts, .links = &t->link};
  t->lit = (olx_relit_surfels){.data = &t->data, .direct = t->direct, .beams = t->beams};
}

static olx_vec3 found(const two_surfels *t) { return olx_relit_highlights(&t->lit, PLACE); }

// Returns a direction in the plane of x and y, `degrees` above the floor.
static olx_vec3 at_angle(float degrees) {
  const float radians = degrees * (OLX_PI / 180.0f);
  return olx_v3(cosf(radians), sinf(radians), 0.0f);
}

static float highlight(float to_place, float to_light) {
  two_surfels t;
  make(&t, olx_scale(at_angle(to_place), 2.0f), at_angle(to_light));
  return olx_luminance(found(&t));
}

static void test_light_goes_where_it_is_mirrored(void **state) {
  (void)state;
  assert_true(highlight(150.0f, 30.0f) > 10.0f * highlight(30.0f, 30.0f)); // light is not reflected back to its source
  assert_true(highlight(150.0f, 30.0f) > 2.0f * highlight(90.0f, 30.0f));
  // Surfaces that reflect little at normal incidence reflect more light the lower it comes.
  assert_true(highlight(150.0f, 30.0f) > highlight(120.0f, 60.0f));
  assert_true(highlight(120.0f, 60.0f) > highlight(90.0f, 90.0f));
  // Reflection is the same in both directions of a path.
  const float there = highlight(140.0f, 50.0f), back = highlight(50.0f, 140.0f);
  assert_true(fabsf(there - back) <= 1e-3f * there);
}

static void test_none_behind_a_surface(void **state) {
  (void)state;
  const float behind[] = {-1.0f, -30.0f, -90.0f, -150.0f, 181.0f};
  for (uint32_t i = 0; i < 5; i++) {
    assert_true(highlight(behind[i], 30.0f) == 0.0f);
    // A beam from below, as when a surfel's points are not in one plane.
    assert_true(highlight(150.0f, behind[i]) == 0.0f);
  }
}

static void test_none_without_direct_light_or_a_straight_way(void **state) {
  (void)state;
  two_surfels t;
  const olx_vec3 place = at_angle(150.0f), from = at_angle(30.0f);
#define DARK(change)                                                                                                   \
  do {                                                                                                                 \
    make(&t, place, from);                                                                                             \
    assert_true(olx_luminance(found(&t)) > 0.0f);                                                                      \
    change;                                                                                                            \
    assert_true(olx_max3(found(&t)) == 0.0f);                                                                          \
  } while (0)
  DARK(t.direct[FLOOR] = t.beams[FLOOR] = olx_splat(0.0f));
  DARK(t.link.from_straight = FLOOR);  // no straight share, since a mirror passed on all of the light
  DARK(t.surfels[FLOOR].specular = 0); // a matte floor
  DARK(t.link.weight = 0);             // a link without weight
  DARK(t.surfels[FLOOR].diffuse = 0);  // without diffuse reflection, the link's weight gives no share
  DARK(t.link_starts[PLACE + 1] = 0);  // the place has no link
#undef DARK
}

// Light without a beam, as of lamps with an area, comes from many sides and is reflected to all sides: by the specular
// share, where links count the diffuse share.
static void test_light_without_a_beam_is_reflected_to_all_sides(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 2; i++) {
    two_surfels t;
    make(&t, at_angle(i ? 150.0f : 20.0f), at_angle(30.0f));
    t.beams[FLOOR] = olx_splat(0.0f);
    const olx_vec3 light = found(&t), wanted = olx_scale(LIGHT, 0.125f * (191.0f / 255.0f) * (51.0f / 102.0f));
    assert_true(olx_length(olx_sub(light, wanted)) <= 1e-5f * olx_length(wanted));
    // When a beam carries half of the luminance, the other half is still reflected to all sides.
    t.beams[FLOOR] = olx_scale(at_angle(-30.0f), 0.5f * olx_luminance(LIGHT));
    assert_true(olx_length(olx_sub(found(&t), olx_scale(wanted, 0.5f))) <= 1e-5f * olx_length(wanted));
  }
}

static void test_highlights_have_the_color_and_weight_of_light(void **state) {
  (void)state;
  two_surfels t;
  make(&t, at_angle(150.0f), at_angle(30.0f));
  const olx_vec3 once = found(&t);
  assert_true(fabsf(once.x / LIGHT.x - once.y / LIGHT.y) < 1e-5f && fabsf(once.z / LIGHT.z - once.y / LIGHT.y) < 1e-5f);
  t.direct[FLOOR] = olx_scale(LIGHT, 3.0f);
  t.beams[FLOOR] = olx_scale(t.beams[FLOOR], 3.0f);
  assert_true(olx_length(olx_sub(found(&t), olx_scale(once, 3.0f))) < 1e-5f * olx_length(once));
  t.link.weight = olx_rgb9e5_pack(olx_splat(0.25f));
  assert_true(olx_length(olx_sub(found(&t), olx_scale(once, 6.0f))) < 1e-5f * olx_length(once));
}

// Over all directions, a surface reflects no more light than it receives, for any surface and direction of light.
static void test_no_surface_reflects_more_than_it_gets(void **state) {
  (void)state;
  enum { DIRECTIONS = 4096 };
  const float straight = 0.125f * (191.0f / 255.0f) / (102.0f / 255.0f);
  for (uint32_t alpha = 0; alpha < 256; alpha += 51) {
    for (float angle = 5.0f; angle <= 90.0f; angle += 17.0f) {
      double sum = 0.0;
      for (uint32_t i = 0; i < DIRECTIONS; i++) {
        two_surfels t;
        const olx_vec3 up = {0.0f, 1.0f, 0.0f};
        make(&t, olx_from_basis(olx_sample_cosine(olx_stratified2(i, 7)), up), at_angle(angle));
        t.surfels[FLOOR].f0 = 255;
        t.surfels[FLOOR].alpha = (uint8_t)alpha;
        sum += (double)(olx_luminance(found(&t)) / (olx_luminance(LIGHT) * straight)) / DIRECTIONS;
      }
      if (sum > 1.02) fail_msg("alpha %u, light at %g degrees: %g times what arrives", alpha, (double)angle, sum);
    }
  }
}

// ---- A floor in a low sun, between two walls

static const olx_light SUN = {
    .type = OLX_LIGHT_SUN, .emission = {5.0f, 5.0f, 5.0f}, .direction = {0.94f, -0.3411744f, 0.0f}};

// Makes two walls: x = -1, over which the sun is, and x = 1, onto which it shines.
static olx_scene *two_walls(const olx_material *floor) {
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_lambert(0.2f, 0.0f);
  const olx_vec3 x = {2, 0, 0}, y = {0, 2, 0}, z = {0, 0, 2};
  tiny_quad(scene, floor, olx_v3(0, -1, 0), z, x);
  tiny_quad(scene, &walls, olx_v3(-1, 0, 0), y, z);
  tiny_quad(scene, &walls, olx_v3(1, 0, 0), z, y);
  scene->has_probe_volume = true;
  scene->probes_min = olx_splat(-0.7f);
  scene->probes_max = olx_splat(0.7f);
  return tiny_finish(scene);
}

static olx_field *bake(const scene_folder *folder, const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  const uint32_t counts[3] = {2, 2, 2};
  ASSERT_OK(olx_scene_probe_grid(scene, counts, &settings.grid));
  settings.radiance_size = 32;
  settings.volume_cells = 4;
  settings.relight = true;
  char path[400];
  snprintf(path, sizeof path, "%s/floor.olx", folder->path);
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_field *field;
  ASSERT_OK(olx_field_open(path, &field));
  return field;
}

// A shadow test in which the sun passes through walls and lights the sides that face it.
static void through_walls(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded) {
  (void)user;
  (void)rays;
  memset(occluded, 0, count);
}

typedef struct wall_light {
  double toward, away;  // indirect irradiance of the wall onto which the sun shines, and of the other wall
  double highlights[2]; // highlights in the irradiance of all surfels: with the sun, and after it has set
} wall_light;

static double mean_of_wall(const olx_relight *r, float side) {
  double sum = 0.0, count = 0.0;
  for (uint32_t i = 0; i < r->source->relight.header->surfels; i++) {
    const olx_relight_surfel *s = &r->source->relight.surfels[i];
    if (olx_normal_unpack((uint16_t)s->normal).x * side > -0.9f) continue;
    sum += (double)olx_luminance(r->surfels.irradiance[i]);
    count += 1.0;
  }
  assert_true(count > 20.0);
  return sum / count;
}

static double sum_of_highlights(const olx_relight *r) {
  double sum = 0.0;
  for (uint32_t i = 0; i < r->source->relight.header->surfels; i++) {
    assert_true(olx_finite(r->surfels.highlights[i]));
    sum += (double)olx_luminance(r->surfels.highlights[i]);
  }
  return sum;
}

static void come_to_rest(olx_relight *relight) {
  olx_relight_stats stats = {.awake = 1};
  for (uint32_t i = 0; i < 200 && stats.awake > 0; i++) ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), &stats));
  assert_int_equal(stats.awake, 0);
}

static wall_light light_walls(const scene_folder *folder, const olx_material *floor) {
  olx_scene *scene = two_walls(floor);
  olx_field *field = bake(folder, scene);
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = through_walls;
  olx_relight *relight;
  ASSERT_OK(olx_relight_create(field, &settings, &relight));
  ASSERT_OK(olx_relight_set_lights(relight, &SUN, 1));
  come_to_rest(relight);
  wall_light light = {.toward = mean_of_wall(relight, 1.0f),
                      .away = mean_of_wall(relight, -1.0f),
                      .highlights = {sum_of_highlights(relight)}};
  ASSERT_OK(olx_relight_set_lights(relight, NULL, 0));
  come_to_rest(relight);
  light.highlights[1] = sum_of_highlights(relight);
  olx_relight_free(relight);
  olx_field_close(field);
  olx_scene_free(scene);
  return light;
}

// Returns a matte floor that reflects as much of uniform light as the glossy one.
static olx_material matte_like(const olx_material *glossy) {
  const olx_bsdf bsdf = olx_bsdf_make(glossy->base_color, glossy->metallic, glossy->roughness, glossy->specular_weight);
  return tiny_lambert(olx_bsdf_matte(&bsdf).albedo.x, 0.0f);
}

static void test_a_glossy_floor_lights_the_wall_behind_it(void **state) {
  const scene_folder *folder = *state;
  const olx_material glossy = tiny_plastic(0.2f, 0.3f), matte = matte_like(&glossy);
  const wall_light a = light_walls(folder, &glossy), b = light_walls(folder, &matte);
  print_message("the wall that the sun shines to: %.3f, matte %.3f; the other: %.3f, matte %.3f\n", a.toward, b.toward,
                a.away, b.away);
  assert_true(a.toward > 1.2 * b.toward);
  assert_true(a.away < b.away);
  assert_true(a.highlights[0] > 0.0 && a.highlights[1] == 0.0);
  assert_true(b.highlights[0] == 0.0 && b.highlights[1] == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_light_goes_where_it_is_mirrored),
      cmocka_unit_test(test_none_behind_a_surface),
      cmocka_unit_test(test_none_without_direct_light_or_a_straight_way),
      cmocka_unit_test(test_light_without_a_beam_is_reflected_to_all_sides),
      cmocka_unit_test(test_highlights_have_the_color_and_weight_of_light),
      cmocka_unit_test(test_no_surface_reflects_more_than_it_gets),
      cmocka_unit_test_setup_teardown(test_a_glossy_floor_lights_the_wall_behind_it, scene_folder_set_up,
                                      scene_folder_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
