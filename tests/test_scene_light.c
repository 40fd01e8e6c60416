// Tests the solved light of scenes against path tracing, against the known light of sealed rooms, and against solutions
// with other threads and other random numbers.
#include "light/links/gathers.h"
#include "light/links/links.h"
#include "light/path.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"
#include "solved_rooms.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 128, MOST_PROBES = 128 };

// A scene with the probes of its grid, and surface points that these probes see.
typedef struct setting {
  olx_scene *scene;
  olx_vec3 probes[MOST_PROBES];
  uint8_t flags[MOST_PROBES];
  uint32_t probe_count;
  olx_surface points[POINTS];
} setting;

// Returns whether a probe sees most surfaces from behind, and so is inside a solid.
static bool is_buried(const olx_scene *scene, olx_vec3 probe) {
  enum { RAYS = 64 };
  uint32_t behind = 0;
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_vec3 direction = olx_sample_sphere(olx_hammersley(i, RAYS));
    const olx_ray ray = {probe, direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    behind += hit.triangle != OLX_NO_HIT && olx_surface_at(scene, &hit, direction).back_face;
  }
  return behind > RAYS / 2;
}

static void load(setting *s, const char *name) {
  memset(s, 0, sizeof *s);
  assert_int_equal(olx_scene_load(name, &s->scene), OLX_OK);
  olx_grid grid;
  assert_int_equal(olx_scene_probe_grid(s->scene, NULL, &grid), OLX_OK);
  s->probe_count = grid.count[0] * grid.count[1] * grid.count[2];
  assert_true(s->probe_count <= MOST_PROBES);
  for (uint32_t i = 0; i < s->probe_count; i++) {
    const uint32_t x = i % grid.count[0], y = i / grid.count[0] % grid.count[1], z = i / grid.count[0] / grid.count[1];
    s->probes[i] = olx_add(grid.origin, olx_mul(grid.spacing, olx_v3((float)x, (float)y, (float)z)));
    s->flags[i] = is_buried(s->scene, s->probes[i]);
  }
  for (uint32_t i = 0, tried = 0; i < POINTS; tried++) {
    assert_true(tried < 100 * POINTS);
    const olx_vec3 direction = olx_sample_sphere(olx_stratified2(tried, 3));
    const olx_ray ray = {s->probes[tried % s->probe_count], direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(s->scene->bvh, &ray);
    if (s->flags[tried % s->probe_count] || hit.triangle == OLX_NO_HIT) continue;
    s->points[i] = olx_surface_at(s->scene, &hit, direction);
    s->points[i].shading_normal = olx_surface_vertex_normal(s->scene, &hit, &s->points[i]);
    i++;
  }
}

static olx_scene_light_settings small_settings(void) {
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.map_size = 128;
  settings.threads = 2;
  return settings;
}

static olx_scene_light *solve(const setting *s, const olx_scene_light_settings *settings) {
  olx_scene_light *light;
  assert_int_equal(olx_scene_light_create(s->scene, settings, s->probes, s->flags, s->probe_count, &light), OLX_OK);
  return light;
}

static double squared(olx_vec3 a) { return (double)olx_dot(a, a); }

// Returns the squared error at the first `points` points relative to squared light, without the noise of the reference,
// which has two independent halves.
static double relative_error(const setting *s, const olx_scene_light *light, uint32_t points, uint32_t bounces,
                             double *bias) {
  double error = 0.0, squares = 0.0, sum = 0.0, off = 0.0;
  uint64_t rays = 0;
  for (uint32_t i = 0; i < points; i++) {
    const olx_vec3 found = olx_scene_light_irradiance(light, &s->points[i]);
    olx_vec3 half[2];
    for (uint32_t k = 0; k < 2; k++) {
      half[k] = olx_path_surface_irradiance(s->scene, &s->points[i], bounces, 256, 2 * i + k, &rays);
    }
    error += (double)olx_dot(olx_sub(found, half[0]), olx_sub(found, half[1]));
    squares += (double)olx_dot(half[0], half[1]);
    sum += (double)olx_luminance(half[0]) + (double)olx_luminance(half[1]);
    off += 2.0 * (double)olx_luminance(found) - (double)olx_luminance(half[0]) - (double)olx_luminance(half[1]);
  }
  *bias = off / sum;
  return error / squares;
}

// Two sets of 256 paths at each point determine the bias to half a per cent.
static void irradiance_is_that_of_path_tracing(void **state) {
  (void)state;
  static const char *const scenes[] = {"builtin:pillars", "builtin:cornell"};
  setting *s = malloc(sizeof *s);
  for (uint32_t i = 0; i < 2; i++) {
    load(s, scenes[i]);
    for (uint32_t bounces = 1; bounces <= 4; bounces += 3) {
      olx_scene_light_settings settings = small_settings();
      settings.bounces = bounces;
      settings.noise = 0.04f; // whose square is well below the error that is allowed
      olx_scene_light *light = solve(s, &settings);
      double bias;
      const double error = relative_error(s, light, POINTS, bounces, &bias);
      print_message("%s, %u bounces: relative MSE %g, bias %g\n", scenes[i], bounces, error, bias);
      if (error > 0.004 || fabs(bias) > 0.02) {
        fail_msg("%s, %u bounces: relative MSE %g, bias %g", scenes[i], bounces, error, bias);
      }
      olx_scene_light_free(light);
    }
    olx_scene_free(s->scene);
  }
  free(s);
}

// The lamp is in the left room; a wall 0.2 m thick reaches from floor to ceiling.
static void sealed_rooms_get_no_light_of_each_other(void **state) {
  (void)state;
  setting *s = malloc(sizeof *s);
  load(s, "builtin:two-rooms-sealed");
  const olx_scene_light_settings settings = small_settings();
  olx_scene_light *light = solve(s, &settings);
  uint32_t lit = 0;
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 found = olx_scene_light_irradiance(light, &s->points[i]);
    if (s->points[i].position.x > 0.0f) assert_float_equal(olx_max3(found), 0.0f, 1e-6f);
    lit += olx_max3(found) > 0.1f;
  }
  assert_true(lit > POINTS / 4);
  olx_scene_light_free(light);
  olx_scene_free(s->scene);
  free(s);
}

static void threads_and_runs_do_not_matter(void **state) {
  (void)state;
  setting *s = malloc(sizeof *s);
  load(s, "builtin:cornell-glossy");
  olx_scene_light_settings settings = small_settings();
  settings.noise = 0.1f;
  olx_scene_light *with_two = solve(s, &settings);
  settings.threads = 1;
  olx_scene_light *with_one = solve(s, &settings);
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 a = olx_scene_light_irradiance(with_two, &s->points[i]);
    const olx_vec3 b = olx_scene_light_irradiance(with_one, &s->points[i]);
    assert_memory_equal(&a, &b, sizeof a);
  }
  olx_scene_light_free(with_one);
  olx_scene_light_free(with_two);
  olx_scene_free(s->scene);
  free(s);
}

// Returns the noise of a solution by the difference to one with other random numbers, which is the root of two times
// their noise.
static double noise_by_two_seeds(const setting *s, const olx_scene_light_settings *settings,
                                 olx_scene_light_report *report) {
  olx_scene_light *light[2];
  for (uint32_t k = 0; k < 2; k++) {
    olx_scene_light_settings seeded = *settings;
    seeded.seed = k;
    light[k] = solve(s, &seeded);
  }
  double difference = 0.0, squares = 0.0;
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 a = olx_scene_light_irradiance(light[0], &s->points[i]);
    difference += squared(olx_sub(a, olx_scene_light_irradiance(light[1], &s->points[i])));
    squares += squared(a);
  }
  *report = olx_scene_light_describe(light[0]);
  olx_scene_light_free(light[0]);
  olx_scene_light_free(light[1]);
  return sqrt(0.5 * difference / squares);
}

static void noise_stays_below_its_bound_and_costs_rays(void **state) {
  (void)state;
  setting *s = malloc(sizeof *s);
  load(s, "builtin:cornell");
  olx_scene_light_settings settings = small_settings();
  uint64_t links[2];
  for (uint32_t n = 0; n < 2; n++) {
    settings.noise = n == 0 ? 0.08f : 0.02f;
    olx_scene_light_report report;
    assert_true(noise_by_two_seeds(s, &settings, &report) < 1.2 * (double)settings.noise);
    links[n] = report.links;
  }
  assert_true(links[1] > 2 * links[0]);
  olx_scene_free(s->scene);
  free(s);
}

// With room for few links, noise is met by rays that leave none, without bias.
static void noise_stays_below_its_bound_with_room_for_few_links(void **state) {
  (void)state;
  setting *s = malloc(sizeof *s);
  load(s, "builtin:cornell");
  olx_scene_light_settings settings = small_settings();
  settings.bounces = 4;
  settings.most_links = 1 << 17;
  olx_scene_light_report report;
  assert_true(noise_by_two_seeds(s, &settings, &report) < 1.2 * (double)settings.noise);
  assert_true(report.links <= settings.most_links && report.noise <= (double)settings.noise);
  olx_scene_light *light = solve(s, &settings);
  double bias;
  const double error = relative_error(s, light, POINTS, 4, &bias);
  if (error > 0.004 || fabs(bias) > 0.02) fail_msg("relative MSE %g, bias %g", error, bias);
  settings.threads = 1;
  olx_scene_light *with_one = solve(s, &settings);
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 a = olx_scene_light_irradiance(light, &s->points[i]);
    const olx_vec3 b = olx_scene_light_irradiance(with_one, &s->points[i]);
    assert_memory_equal(&a, &b, sizeof a);
  }
  olx_scene_light_free(with_one);
  olx_scene_light_free(light);
  olx_scene_free(s->scene);
  free(s);
}

// Surfels on surfaces that no probe sees keep their few rays, whose noise must not count in the noise of surfels that
// probes see.
static void the_bound_is_met_beside_surfaces_that_no_probe_sees(void **state) {
  (void)state;
  setting *s = malloc(sizeof *s);
  load(s, "builtin:cornell-glossy");
  olx_scene_light_settings settings = small_settings();
  settings.noise = 0.05f;
  olx_scene_light *light = solve(s, &settings);
  const olx_scene_light_report report = olx_scene_light_describe(light);
  assert_true(report.hidden_surfels > 0);
  assert_true(report.noise > 0.0 && report.noise <= (double)settings.noise);
  olx_scene_light_free(light);
  olx_scene_free(s->scene);
  free(s);
}

// A point without surfels nearby casts rays of its own. Where their ends have no surfels either, the rays find direct
// light and continue.
static void without_surfels_rays_go_on_from_surface_to_surface(void **state) {
  (void)state;
  setting *s = malloc(sizeof *s);
  load(s, "builtin:cornell");
  memset(s->flags, 1, sizeof s->flags);
  const olx_scene_light_settings settings = small_settings();
  olx_scene_light *light = solve(s, &settings);
  assert_int_equal(olx_scene_light_describe(light).surfels, 0);
  double bias;
  assert_true(relative_error(s, light, POINTS / 2, OLX_CHAIN_MOST, &bias) < 0.01);
  assert_true(fabs(bias) < 0.01);
  olx_scene_light_free(light);
  olx_scene_free(s->scene);
  free(s);
}

// Makes a room of side 2 with a small lamp below its ceiling, and a mirror in one wall.
static olx_scene *mirror_room(void) {
  olx_scene *scene = made_scene();
  olx_material wall = olx_material_default(), mirror = wall, lamp = wall;
  wall.base_color = olx_splat(0.5f);
  mirror.base_color = olx_splat(0.9f);
  mirror.metallic = mirror.specular_weight = 1.0f;
  mirror.roughness = 0.0f;
  lamp.base_color = olx_splat(0.0f);
  lamp.emission = olx_splat(10.0f);
  made_room(scene, olx_splat(0.0f), 2.0f, made_material(scene, &wall));
  made_quad(scene, olx_v3(-0.99f, 0.0f, 0.0f), olx_v3(0.0f, 1.5f, 0.0f), olx_v3(0.0f, 0.0f, 1.5f),
            made_material(scene, &mirror));
  made_quad(scene, olx_v3(-0.6f, 0.9f, 0.0f), olx_v3(0.3f, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, 0.3f),
            made_material(scene, &lamp));
  return made_finish(scene);
}

// Few rays find the lamp in the mirror, and these cause most of the noise; later rays are guided to where it was found.
static void rays_learn_where_a_mirror_shows_a_lamp(void **state) {
  (void)state;
  const float noise = 0.02f;
  olx_scene *scene = mirror_room();
  olx_scene_light *light = solve_room(scene, noise);
  const olx_scene_light_report report = olx_scene_light_describe(light);
  print_message("noise %.4f with %.2f million rays\n", report.noise, (double)report.rays * 1e-6);
  assert_true(report.noise <= (double)noise);
  // When guiding ignores light from mirrors, the same noise takes 6.65 million rays.
  assert_true(report.rays < 6000000);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// Adds a floor and a wall of albedo 0.3 in the open, lit a million times as brightly as the room.
static void add_bright_corner(olx_scene *scene) {
  olx_material dark = olx_material_default();
  dark.base_color = olx_splat(0.3f);
  const uint32_t material = made_material(scene, &dark);
  made_quad(scene, olx_v3(50.0f, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, 4.0f), olx_v3(4.0f, 0.0f, 0.0f), material);
  made_quad(scene, olx_v3(48.0f, 2.0f, 0.0f), olx_v3(0.0f, 4.0f, 0.0f), olx_v3(0.0f, 0.0f, 4.0f), material);
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .position = olx_v3(51.0f, 3.0f, 0.0f), .emission = olx_splat(1e6f)};
  assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
}

// Returns the indirect irradiance, as a mean over its walls, of a white room with a lamp of intensity 1, alone or beside
// the bright corner.
static double light_of_a_white_room(bool alone) {
  enum { WALL_POINTS = 4096 };
  olx_scene *scene = made_scene();
  olx_material white = olx_material_default();
  white.base_color = olx_splat(0.8f);
  made_room(scene, olx_splat(0.0f), 2.0f, made_material(scene, &white));
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .position = olx_v3(0.2f, 0.3f, 0.1f), .emission = olx_splat(1.0f)};
  assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
  if (!alone) add_bright_corner(scene);
  scene = made_finish(scene);
  const olx_vec3 probes[2] = {{0.3f, 0.1f, 0.2f}, {51.0f, 2.0f, 0.5f}};
  const uint8_t flags[2] = {0};
  olx_scene_light_settings settings = small_settings();
  settings.map_size = 256; // light sampled more coarsely is biased
  olx_scene_light *light;
  assert_int_equal(olx_scene_light_create(scene, &settings, probes, flags, alone ? 1 : 2, &light), OLX_OK);
  double sum = 0.0, area = 0.0;
  for (uint32_t i = 0; i < WALL_POINTS; i++) {
    const olx_vec3 direction = olx_sample_sphere(olx_stratified2(i, 3));
    const olx_ray ray = {probes[0], direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface surface = olx_surface_at(scene, &hit, direction);
    const double part = (double)(hit.t * hit.t / -olx_dot(direction, surface.geometric_normal));
    sum += part * (double)olx_luminance(olx_scene_light_irradiance(light, &surface));
    area += part;
  }
  olx_scene_light_free(light);
  olx_scene_free(scene);
  return sum / area;
}

// In a closed room of albedo 0.8 light is 5 times the direct light, 4 of them indirect.
static void a_bright_place_does_not_end_the_bounces_of_a_dark_one(void **state) {
  (void)state;
  const double alone = light_of_a_white_room(true), beside = light_of_a_white_room(false);
  const double expected = 4.0 * 4.0 * 3.141592653589793 / (6.0 * 2.0 * 2.0); // by the lamp's power over the walls' area
  if (fabs(alone / expected - 1.0) > 0.01) fail_msg("%g W/m^2 of %g", alone, expected);
  if (fabs(beside / alone - 1.0) > 0.005) fail_msg("%g W/m^2 beside a bright place, %g alone", beside, alone);
}

// Makes a room of side 3 with a lamp, a table, and above it a small screen in a frame. On the screen surfels are as
// sparse as its distance to the walls allows, although light changes along the frame and towards the table.
static olx_scene *screen_room(float height, float width) {
  const float depth = 0.06f, back = -0.3f;
  olx_scene *scene = made_scene();
  olx_material white = olx_material_default();
  white.base_color = olx_splat(0.5f);
  white.specular_weight = 0.0f;
  const uint32_t paint = made_material(scene, &white);
  const olx_vec3 out = {depth, 0.0f, 0.0f}, up = {0.0f, height, 0.0f}, along = {0.0f, 0.0f, width};
  made_room(scene, olx_splat(0.0f), 3.0f, paint);
  made_quad(scene, olx_v3(-0.2f, -0.1f - 0.5f * height, 0.0f), olx_v3(0.6f, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, 1.2f),
            paint);
  made_quad(scene, olx_v3(back, 0.0f, 0.0f), up, along, paint);
  for (float side = -0.5f; side < 1.0f; side += 1.0f) {
    const olx_vec3 middle = {back + 0.5f * depth, 0.0f, 0.0f};
    made_quad(scene, olx_madd(middle, up, side), out, along, paint);
    made_quad(scene, olx_madd(middle, along, side), out, up, paint);
  }
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .position = olx_v3(0.5f, 0.6f, 0.3f), .emission = olx_splat(1.0f)};
  assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
  return made_finish(scene);
}

static void few_surfels_are_not_trusted_where_their_light_differs(void **state) {
  (void)state;
  enum { SCREEN_POINTS = 128, PATHS = 1024 };
  const float height = 0.3f, width = 0.7f;
  olx_scene *scene = screen_room(height, width);
  olx_scene_light *light = solve_room(scene, 0.03f);
  uint32_t wrong = 0;
  for (uint32_t i = 0; i < SCREEN_POINTS; i++) {
    const olx_vec2 uv = olx_hammersley(i, SCREEN_POINTS);
    const olx_ray ray = {olx_v3(-0.2f, 0.95f * height * (uv.x - 0.5f), 0.95f * width * (uv.y - 0.5f)),
                         olx_v3(-1.0f, 0.0f, 0.0f), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface screen = olx_surface_at(scene, &hit, ray.direction);
    uint64_t rays = 0;
    const float wanted = olx_luminance(olx_path_surface_irradiance(scene, &screen, 32, PATHS, i, &rays));
    wrong += fabsf(olx_luminance(olx_scene_light_irradiance(light, &screen)) / wanted - 1.0f) > 0.1f;
  }
  print_message("light of the screen: off by more than 10 %% at %u of %u points\n", wrong, SCREEN_POINTS);
  assert_true(wrong < SCREEN_POINTS / 16);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// A room of grey matte surfaces in which a spot light makes a bright patch on the floor, half hidden from the ceiling
// by a board at two thirds of the height: the ceiling's light has an edge along x = 0, two decimetres wide.
static olx_scene *room_with_a_board(void) {
  olx_scene *scene = made_scene();
  olx_material grey = olx_material_default();
  grey.base_color = olx_splat(0.5f);
  grey.specular_weight = 0.0f;
  const uint32_t paint = made_material(scene, &grey);
  made_box(scene, olx_v3(-2, 0, -2), olx_v3(2, 3, 2), false, paint);
  made_box(scene, olx_v3(-1.5f, 2, -1.5f), olx_v3(0, 2.02f, 1.5f), true, paint);
  const olx_light lamp = {.type = OLX_LIGHT_SPOT,
                          .position = olx_v3(0, 0.6f, 0),
                          .direction = olx_v3(0, -1, 0),
                          .emission = olx_splat(9.0f),
                          .cosine_inner = 0.97f,
                          .cosine_outer = 0.95f};
  assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
  return made_finish(scene);
}

// Returns how many of these points of the ceiling around its edge gather light of their own, which is noise beside the
// interpolated light around them.
static uint32_t gathering_points(const olx_scene *scene, const olx_scene_light *light, uint32_t points) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < points; i++) {
    const olx_vec2 uv = olx_hammersley(i, points);
    const olx_ray ray = {olx_v3(uv.x - 0.5f, 2.9f, uv.y - 0.5f), olx_v3(0, 1, 0), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface ceiling = olx_surface_at(scene, &hit, ray.direction);
    olx_vec3 irradiance;
    count += !olx_scene_light_interpolate(light, &ceiling, &irradiance);
  }
  return count;
}

// Without rays for records cells stay whole.
static void records_follow_an_edge_of_light(void **state) {
  (void)state;
  enum { CEILING_POINTS = 1000 };
  olx_scene *scene = room_with_a_board();
  const olx_vec3 probes[] = {{0.5f, 1, 0.1f}, {0.5f, 2.5f, 0.1f}};
  const uint8_t flags[2] = {0};
  uint32_t gathering[2];
  for (uint32_t with = 0; with < 2; with++) {
    olx_scene_light_settings settings = small_settings();
    settings.noise = 0.03f;
    if (!with) settings.most_final_rays = 0;
    olx_scene_light *light;
    assert_int_equal(olx_scene_light_create(scene, &settings, probes, flags, 2, &light), OLX_OK);
    const olx_scene_light_report report = olx_scene_light_describe(light);
    assert_int_equal(report.records > report.surfels - report.hidden_surfels, with);
    gathering[with] = gathering_points(scene, light, CEILING_POINTS);
    olx_scene_light_free(light);
  }
  print_message("of %d points of the ceiling %u gather light without records of parts of cells, %u with them\n",
                CEILING_POINTS, gathering[0], gathering[1]);
  assert_true(gathering[0] > CEILING_POINTS / 10 && gathering[1] < gathering[0] / 2);
  olx_scene_free(scene);
}

// A floor and two walls without a ceiling, with a lamp in their middle, and a sheet so far away that the bounds are
// many times as large as the room.
static olx_scene *room_below_the_sky(void) {
  olx_scene *scene = made_scene();
  olx_material white = olx_material_default();
  white.base_color = olx_splat(0.5f);
  white.specular_weight = 0.0f;
  const uint32_t paint = made_material(scene, &white);
  made_quad(scene, olx_v3(0, -1, 0), olx_v3(0, 0, 4), olx_v3(4, 0, 0), paint);
  made_quad(scene, olx_v3(-2, 0, 0), olx_v3(0, 2, 0), olx_v3(0, 0, 4), paint);
  made_quad(scene, olx_v3(0, 0, -2), olx_v3(4, 0, 0), olx_v3(0, 2, 0), paint);
  made_quad(scene, olx_v3(0, 0, 100), olx_v3(0, 1, 0), olx_v3(1, 0, 0), paint);
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .emission = olx_splat(1.0f)};
  assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
  return made_finish(scene);
}

// Returns one of `count` places of the wall at x < 0, within a height and a width around its middle.
static olx_surface wall_at(const olx_scene *scene, float height, float width, uint32_t i, uint32_t count) {
  const olx_vec2 uv = olx_hammersley(i, count);
  const olx_ray ray = {olx_v3(0, height * (uv.x - 0.5f), width * (uv.y - 0.5f)), olx_v3(-1, 0, 0), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  return olx_surface_at(scene, &hit, ray.direction);
}

// Surfaces a metre or two from a lamp are not near it, however far its rays into the sky may go.
static void a_lamp_below_the_sky_loses_no_light(void **state) {
  (void)state;
  enum { WALL_POINTS = 64, PATHS = 1024 };
  olx_scene *scene = room_below_the_sky();
  olx_scene_light *light = solve_room(scene, 0.02f);
  double found = 0.0, wanted = 0.0;
  for (uint32_t i = 0; i < WALL_POINTS; i++) {
    const olx_surface wall = wall_at(scene, 1.9f, 3.8f, i, WALL_POINTS);
    uint64_t rays = 0;
    wanted += (double)olx_luminance(olx_path_surface_irradiance(scene, &wall, 32, PATHS, i, &rays));
    found += (double)olx_luminance(olx_scene_light_irradiance(light, &wall));
  }
  print_message("light below the sky: %.4f of the truth\n", found / wanted);
  assert_true(fabs(found / wanted - 1.0) < 0.03);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// The floor and the walls of a room of two metres, below the sun. *paint receives its material, for a ceiling.
static olx_scene *room_in_the_sun(olx_vec3 direction, uint32_t *paint) {
  olx_scene *scene = made_scene();
  olx_material white = olx_material_default();
  white.base_color = olx_splat(0.5f);
  white.specular_weight = 0.0f;
  *paint = made_material(scene, &white);
  made_quad(scene, olx_v3(0, -1, 0), olx_v3(0, 0, 2), olx_v3(2, 0, 0), *paint);
  for (float side = -1.0f; side < 2.0f; side += 2.0f) {
    made_quad(scene, olx_v3(0, 0, side), olx_v3(2, 0, 0), olx_v3(0, 2, 0), *paint);
    made_quad(scene, olx_v3(side, 0, 0), olx_v3(0, 0, 2), olx_v3(0, 2, 0), *paint);
  }
  const olx_light sun = {.type = OLX_LIGHT_SUN, .direction = olx_normalize(direction), .emission = olx_splat(10.0f)};
  assert_int_equal(olx_scene_add_light(scene, &sun), OLX_OK);
  return scene;
}

// A room with a hole of half a metre in its ceiling.
static olx_scene *room_with_a_hole(void) {
  uint32_t paint;
  olx_scene *scene = room_in_the_sun(olx_v3(0.1f, -1, 0.2f), &paint);
  for (float side = -1.0f; side < 2.0f; side += 2.0f) {
    made_quad(scene, olx_v3(0.625f * side, 1, 0), olx_v3(0, 0, 2), olx_v3(0.75f, 0, 0), paint);
    made_quad(scene, olx_v3(0, 1, 0.625f * side), olx_v3(0, 0, 0.75f), olx_v3(0.5f, 0, 0), paint);
  }
  return made_finish(scene);
}

// Counts the guided rays that end in cells that are uneven, or not, as `uneven` says, and those of them that found the
// direct light of their end themselves.
static void count_links(const olx_scene_light_parts *parts, bool uneven, uint32_t *all, uint32_t *lit) {
  for (uint32_t k = 0; k < parts->links->batch_count; k++) {
    const olx_link_batch *batch = &parts->links->batches[k];
    for (size_t i = 0; batch->guide && i < (size_t)batch->count * batch->rays; i++) {
      const olx_link *link = &batch->links[i];
      if (!olx_link_brings_light(link)) continue;
      if (olx_surfel_is_uneven(parts->surfels, olx_link_end(link)) != uneven) continue;
      ++*all;
      *lit += (link->end & OLX_LINK_LIT) != 0;
    }
  }
}

// The sun's patch on the floor has an edge, and cells along it are lit in part.
static void no_ray_takes_the_mean_of_a_cell_that_the_sun_reaches_in_part(void **state) {
  (void)state;
  olx_scene *scene = room_with_a_hole();
  olx_scene_light *light = solve_room(scene, 0.02f);
  const olx_scene_light_parts parts = olx_scene_light_open(light);
  uint32_t edge = 0, cells[2] = {0}, all[2] = {0}, lit[2] = {0};
  for (uint32_t i = 0; i < parts.surfels->count; i++) {
    const olx_light_surfel *surfel = &parts.surfels->surfels[i];
    const bool uneven = olx_surfel_is_uneven(parts.surfels, i);
    cells[uneven]++;
    edge += uneven && surfel->position.y < -0.99f;
  }
  for (uint32_t uneven = 0; uneven < 2; uneven++) count_links(&parts, uneven, &all[uneven], &lit[uneven]);
  print_message(
      "%u of %u cells are uneven, %u of them on the floor; rays find light themselves at %u of %u ends there, "
      "and at %u of %u others\n",
      cells[1], cells[0] + cells[1], edge, lit[1], all[1], lit[0], all[0]);
  assert_true(edge > 0 && 8 * cells[1] < cells[0]);
  assert_true(all[1] > 0 && lit[1] == all[1]);
  assert_true(2 * lit[0] < all[0]);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// A room below slats, between which the sun draws lines on the floor that are finer than cells.
static olx_scene *room_below_slats(olx_vec3 direction) {
  enum { SLATS = 20 };
  const float pitch = 2.0f / SLATS;
  uint32_t paint;
  olx_scene *scene = room_in_the_sun(direction, &paint);
  for (uint32_t i = 0; i < SLATS; i++) {
    const float x = ((float)i + 0.5f) * pitch - 1.0f;
    made_quad(scene, olx_v3(x, 1, 0), olx_v3(0, 0, 2), olx_v3(0.8f * pitch, 0, 0), paint);
  }
  return made_finish(scene);
}

// Returns the direct light that long rays take at a surface: that of the point in uneven cells, else that of the cell.
static olx_vec3 light_taken(const olx_scene_light_parts *parts, const olx_surface *surface, const olx_ray_hit *hit,
                            olx_vec3 exact) {
  const olx_surfel_point point = olx_surfel_point_make(&parts->surfels->grid, surface, hit, 0.01f);
  const olx_surfel_found found = olx_light_surfels_find(parts->surfels, point.key, surface, INFINITY);
  if (found.surfel == OLX_CELL_NONE || olx_surfel_is_uneven(parts->surfels, found.surfel)) return exact;
  return parts->direct.all[found.surfel];
}

typedef struct sunlight {
  double taken, wanted;
} sunlight;

// Adds what rays take of the sunlight at points of the floor, and what there is.
static void add_sunlight(const olx_scene *scene, const olx_scene_light *light, sunlight *sum) {
  enum { FLOOR_POINTS = 4096 };
  const olx_scene_light_parts parts = olx_scene_light_open(light);
  for (uint32_t i = 0; i < FLOOR_POINTS; i++) {
    const olx_vec2 uv = olx_hammersley(i, FLOOR_POINTS);
    const olx_ray ray = {olx_v3(2.0f * uv.x - 1.0f, 0, 2.0f * uv.y - 1.0f), olx_v3(0, -1, 0), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface floor = olx_surface_at(scene, &hit, ray.direction);
    uint64_t rays = 0;
    const olx_vec3 exact = olx_direct_irradiance_of_suns(scene, &floor, &rays);
    sum->taken += (double)olx_luminance(light_taken(&parts, &floor, &hit, exact));
    sum->wanted += (double)olx_luminance(exact);
  }
}

// If a cell's own few points decided whether rays take its mean, means that are too small would be kept, and those that
// are too large replaced by the truth.
static void lines_of_sunlight_are_neither_lost_nor_doubled(void **state) {
  (void)state;
  sunlight sum = {0};
  for (float tilt = -0.6f; tilt < 0.7f; tilt += 0.2f) {
    olx_scene *scene = room_below_slats(olx_v3(0.1f, -1, tilt));
    olx_scene_light *light = solve_room(scene, 0.5f);
    add_sunlight(scene, light, &sum);
    olx_scene_light_free(light);
    olx_scene_free(scene);
  }
  print_message("rays take %.4f of the sunlight on the floor\n", sum.taken / sum.wanted);
  assert_true(fabs(sum.taken / sum.wanted - 1.0) < 0.03);
}

// What is known near a point may be in the dark, as the inside of a chair below its seat. The bound on a gathered ray
// then follows the other rays; where it followed what is known alone, nothing was left of their light.
static void gathers_beside_a_dark_surfel_keep_their_light(void **state) {
  (void)state;
  enum { PLACES = 16, PATHS = 1024, SEEDS = 16 };
  olx_scene *scene = room_below_the_sky();
  olx_scene_light *light = solve_room(scene, 0.02f);
  const olx_scene_light_parts parts = olx_scene_light_open(light);
  olx_vec3 *all = calloc(parts.surfels->count, sizeof *all);
  for (uint32_t i = 0; i < parts.surfels->count; i++) all[i] = olx_add(parts.direct.all[i], parts.irradiance[i]);
  const olx_passed_light passed = {parts.direct, all, 32};
  double found = 0.0, wanted = 0.0;
  for (uint32_t i = 0; i < PLACES; i++) {
    const olx_surface wall = wall_at(scene, 1.9f, 3.8f, i, PLACES);
    uint64_t rays = 0;
    wanted += (double)olx_luminance(olx_path_surface_irradiance(scene, &wall, 32, PATHS, i, &rays));
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
      const uint32_t own = olx_hash2(i, seed);
      const olx_vec3 light_here = olx_gather_at(parts.surfels, &wall, NULL, own, &passed, 0.25f, 0.0f, NULL);
      found += (double)olx_luminance(light_here) / SEEDS;
    }
  }
  print_message("gathers in the dark bring %.4f of the truth\n", found / wanted);
  assert_true(fabs(found / wanted - 1.0) < 0.03);
  free(all);
  olx_scene_light_free(light);
  olx_scene_free(scene);
}

// Two closed rooms of two metres, side by side, each with a lamp close to a corner. That of the first is `ratio` times as
// bright as that of the second.
static olx_scene *two_lit_rooms(float ratio) {
  olx_scene *scene = made_scene();
  olx_material paint = olx_material_default();
  paint.base_color = olx_splat(0.3f);
  paint.specular_weight = 0.0f;
  const uint32_t white = made_material(scene, &paint);
  for (uint32_t room = 0; room < 2; room++) {
    const olx_vec3 middle = {4.0f * (float)room, 0, 0};
    made_room(scene, middle, 2.0f, white);
    const olx_light lamp = {.type = OLX_LIGHT_POINT,
                            .position = olx_add(middle, olx_v3(0.7f, 0.7f, 0.7f)),
                            .emission = olx_splat(room ? 1.0f : ratio)};
    assert_int_equal(olx_scene_add_light(scene, &lamp), OLX_OK);
  }
  return made_finish(scene);
}

// Returns the relative difference, RMS, of two solutions with other random numbers at the walls of each room.
static void compare_rooms(float ratio, double difference[2]) {
  enum { WALL_POINTS = 256 };
  olx_scene *scene = two_lit_rooms(ratio);
  const olx_vec3 probes[2] = {{0.1f, 0.1f, 0.1f}, {4.1f, 0.1f, 0.1f}};
  const uint8_t flags[2] = {0};
  olx_scene_light *light[2];
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.map_size = 64;
  settings.threads = 2;
  for (uint32_t seed = 0; seed < 2; seed++) {
    settings.seed = seed;
    assert_int_equal(olx_scene_light_create(scene, &settings, probes, flags, 2, &light[seed]), OLX_OK);
  }
  for (uint32_t room = 0; room < 2; room++) {
    double squares = 0.0;
    for (uint32_t i = 0; i < WALL_POINTS; i++) {
      const olx_ray ray = {probes[room], olx_sample_sphere(olx_hammersley(i, WALL_POINTS)), 0.0f, INFINITY};
      const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
      const olx_surface wall = olx_surface_at(scene, &hit, ray.direction);
      const double a = (double)olx_luminance(olx_scene_light_irradiance(light[0], &wall)),
                   b = (double)olx_luminance(olx_scene_light_irradiance(light[1], &wall));
      squares += 4.0 * (a - b) * (a - b) / ((a + b) * (a + b));
    }
    difference[room] = sqrt(squares / WALL_POINTS);
  }
  olx_scene_light_free(light[0]);
  olx_scene_light_free(light[1]);
  olx_scene_free(scene);
}

// Noise is a share of the light of a place: a room with a two-hundredth of its neighbour's light has as little of it.
static void a_dim_room_has_no_more_noise_than_its_bright_neighbour(void **state) {
  (void)state;
  double difference[2];
  compare_rooms(200.0f, difference);
  print_message("two solutions differ by %.4f in the bright room and by %.4f in the dim one\n", difference[0],
                difference[1]);
  assert_true(difference[1] < 1.25 * difference[0]);
}

// A room whose ceiling is a black pane of this opacity.
static olx_scene *room_below_a_pane(float alpha) {
  uint32_t paint;
  olx_scene *scene = room_in_the_sun(olx_v3(0.1f, -1, 0.2f), &paint);
  olx_material pane = olx_material_default();
  pane.base_color = olx_splat(0.0f);
  pane.specular_weight = 0.0f;
  pane.alpha = alpha;
  pane.alpha_cutoff = 0.5f;
  pane.blended = true;
  made_quad(scene, olx_v3(0, 1, 0), olx_v3(0, 0, 2), olx_v3(2, 0, 0), made_material(scene, &pane));
  return made_finish(scene);
}

typedef struct room_light {
  double solved, traced, direct;
} room_light;

static room_light light_below_a_pane(float alpha) {
  enum { ROOM_POINTS = 64, PATHS = 256, FLOOR_POINTS = 4096 };
  room_light sum = {0};
  olx_scene *scene = room_below_a_pane(alpha);
  olx_scene_light *light = solve_room(scene, 0.02f);
  uint64_t rays = 0;
  for (uint32_t i = 0; i < ROOM_POINTS; i++) {
    const olx_surface wall = wall_at(scene, 1.8f, 1.8f, i, ROOM_POINTS);
    sum.solved += (double)olx_luminance(olx_scene_light_irradiance(light, &wall));
    sum.traced += (double)olx_luminance(olx_path_surface_irradiance(scene, &wall, 32, PATHS, i, &rays));
  }
  for (uint32_t i = 0; i < FLOOR_POINTS; i++) {
    const olx_vec2 uv = olx_hammersley(i, FLOOR_POINTS);
    const olx_ray ray = {olx_v3(uv.x - 0.5f, 0, uv.y - 0.5f), olx_v3(0, -1, 0), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface floor = olx_surface_at(scene, &hit, ray.direction);
    sum.direct += (double)olx_luminance(olx_direct_irradiance_of_suns(scene, &floor, &rays));
  }
  olx_scene_light_free(light);
  olx_scene_free(scene);
  return sum;
}

// A black pane takes its opacity from the light that comes in, and keeps in none of what goes out: the room has
// 1 - alpha of what it has without the pane, direct and indirect.
static void a_pane_takes_its_opacity_from_the_light(void **state) {
  (void)state;
  const room_light open = light_below_a_pane(0.0f);
  for (float alpha = 0.3f; alpha < 1.0f; alpha += 0.4f) {
    const room_light glazed = light_below_a_pane(alpha);
    const double passes = 1.0 - (double)alpha;
    print_message("opacity %.1f: %.3f direct, %.3f solved, %.3f traced\n", (double)alpha, glazed.direct / open.direct,
                  glazed.solved / open.solved, glazed.traced / open.traced);
    assert_true(fabs(glazed.direct / open.direct / passes - 1.0) < 0.05);
    assert_true(fabs(glazed.solved / open.solved / passes - 1.0) < 0.05);
    assert_true(fabs(glazed.traced / open.traced / passes - 1.0) < 0.05);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(irradiance_is_that_of_path_tracing),
      cmocka_unit_test(sealed_rooms_get_no_light_of_each_other),
      cmocka_unit_test(threads_and_runs_do_not_matter),
      cmocka_unit_test(noise_stays_below_its_bound_and_costs_rays),
      cmocka_unit_test(noise_stays_below_its_bound_with_room_for_few_links),
      cmocka_unit_test(the_bound_is_met_beside_surfaces_that_no_probe_sees),
      cmocka_unit_test(rays_learn_where_a_mirror_shows_a_lamp),
      cmocka_unit_test(a_bright_place_does_not_end_the_bounces_of_a_dark_one),
      cmocka_unit_test(few_surfels_are_not_trusted_where_their_light_differs),
      cmocka_unit_test(records_follow_an_edge_of_light),
      cmocka_unit_test(a_lamp_below_the_sky_loses_no_light),
      cmocka_unit_test(no_ray_takes_the_mean_of_a_cell_that_the_sun_reaches_in_part),
      cmocka_unit_test(lines_of_sunlight_are_neither_lost_nor_doubled),
      cmocka_unit_test(a_dim_room_has_no_more_noise_than_its_bright_neighbour),
      cmocka_unit_test(gathers_beside_a_dark_surfel_keep_their_light),
      cmocka_unit_test(a_pane_takes_its_opacity_from_the_light),
      cmocka_unit_test(without_surfels_rays_go_on_from_surface_to_surface),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
