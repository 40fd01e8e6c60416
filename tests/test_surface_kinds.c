// Tests the default diffuse light from placed probes against the path tracer on each kind of surface: with a normal
// map, smooth, with holes, without thickness, curved. Seen by a moving camera, it changes as the path tracer's light
// does.
#include "baked_field.h"
#include "core/sampling.h"
#include "field/field_data.h"
#include "light/path.h"
#include "made_scenes.h"
#include "render/camera.h"
#include "scene/builtin/builtin_shapes.h"
#include "scene/bvh.h"
#include "scene/surface.h"
#include "tiny_scenes.h"

#include <octalux/place.h>

enum { POINTS = 200, PATHS = 256, BOUNCES = 8 };

// One room contains all kinds of surfaces. Its lamp hangs in a corner, so that light differs from side to side.
typedef struct room_of_kinds {
  olx_scene *scene;
  olx_field *field;
  uint32_t bumpy, ball, leaf, sheet, cloth; // numbers of the materials
} room_of_kinds;

static uint32_t matte(olx_scene *scene, const char *name, olx_vec3 color) {
  uint32_t material;
  ASSERT_OK(olx_add_matte(scene, name, color, &material));
  return material;
}

// Adds a wall with bumps that tilt the normal by up to 34 degrees.
static void add_bumpy_wall(olx_scene *scene, uint32_t *material) {
  enum { SIDE = 16 };
  uint8_t texels[SIDE * SIDE][4];
  for (uint32_t i = 0; i < SIDE * SIDE; i++) {
    const float x = 0.4f * sinf(2.0f * OLX_PI * ((float)(i % SIDE) + 0.5f) / SIDE),
                y = 0.4f * sinf(2.0f * OLX_PI * ((float)(i / SIDE) + 0.5f) / SIDE);
    const float numbers[3] = {x, y, sqrtf(1.0f - x * x - y * y)};
    for (uint32_t k = 0; k < 3; k++) texels[i][k] = (uint8_t)lrintf(127.5f + 127.5f * numbers[k]);
    texels[i][3] = 255;
  }
  *material = matte(scene, "bumpy", olx_v3(0.6f, 0.6f, 0.7f));
  scene->materials[*material].normal_texture = made_texture(scene, SIDE, SIDE, texels[0], false);
  made_quad(scene, olx_v3(-1.97f, 1.4f, 0.3f), olx_v3(0.0f, 0.0f, -1.2f), olx_v3(0.0f, 1.2f, 0.0f), *material);
}

static void add_ball(olx_scene *scene, uint32_t *material) {
  enum { STEPS = 16, SEGMENTS = 32 };
  olx_vec2 profile[STEPS + 1];
  for (uint32_t i = 0; i <= STEPS; i++) {
    const float angle = OLX_PI * (float)i / STEPS;
    profile[i] = (olx_vec2){i % STEPS ? 0.4f * sinf(angle) : 0.0f, 0.4f - 0.4f * cosf(angle)};
  }
  *material = matte(scene, "ball", olx_splat(0.6f));
  ASSERT_OK(olx_add_lathe(scene, "ball", olx_v3(0.9f, 0.5f, 0.6f), profile, STEPS + 1, SEGMENTS, *material));
}

// Adds a card of which only a disk is opaque and the corners are cut away.
static void add_leaf(olx_scene *scene, uint32_t *material) {
  enum { SIDE = 32 };
  uint8_t texels[SIDE * SIDE][4];
  for (uint32_t i = 0; i < SIDE * SIDE; i++) {
    const float x = (float)(i % SIDE) + 0.5f - 0.5f * SIDE, y = (float)(i / SIDE) + 0.5f - 0.5f * SIDE;
    const bool there = x * x + y * y < 0.2f * SIDE * SIDE;
    memcpy(texels[i], (const uint8_t[4]){255, 255, 255, there ? 255 : 0}, 4);
  }
  *material = matte(scene, "leaf", olx_v3(0.3f, 0.6f, 0.2f));
  scene->materials[*material].base_color_texture = made_texture(scene, SIDE, SIDE, texels[0], true);
  scene->materials[*material].alpha_cutoff = 0.5f;
  made_quad(scene, olx_v3(0.6f, 2.0f, -0.9f), olx_v3(0.9f, 0.3f, 0.0f), olx_v3(-0.2f, 0.6f, 0.6f), *material);
}

// Adds a sheet in front of the lamp, so that one side is bright and the other dim.
static void add_sheet(olx_scene *scene, uint32_t *material) {
  *material = matte(scene, "sheet", olx_v3(0.7f, 0.6f, 0.4f));
  made_quad(scene, olx_v3(-0.5f, 1.1f, -0.9f), olx_v3(1.4f, 0.0f, 0.3f), olx_v3(0.0f, 1.9f, 0.0f), *material);
}

static void add_cloth(olx_scene *scene, uint32_t *material) {
  const olx_cloth cloth = {.top = {-0.4f, 2.2f, 1.5f},
                           .across = {1.6f, 0.0f, -0.2f},
                           .down = {0.0f, -1.5f, 0.0f},
                           .waves = 2.0f,
                           .depth = 0.15f};
  *material = matte(scene, "cloth", olx_v3(0.6f, 0.3f, 0.3f));
  ASSERT_OK(olx_add_cloth(scene, "cloth", &cloth, *material));
}

static olx_scene *make_scene(room_of_kinds *room) {
  olx_scene *scene = made_scene();
  const uint32_t white = matte(scene, "white", olx_splat(0.7f)), red = matte(scene, "red", olx_v3(0.6f, 0.2f, 0.15f)),
                 floor = matte(scene, "floor", olx_v3(0.5f, 0.45f, 0.4f));
  const uint32_t walls[6] = {white, red, floor, white, white, white};
  ASSERT_OK(olx_add_room(scene, "room", olx_v3(-2.0f, 0.0f, -2.0f), olx_v3(2.0f, 2.8f, 2.0f), walls));
  add_bumpy_wall(scene, &room->bumpy);
  add_ball(scene, &room->ball);
  add_leaf(scene, &room->leaf);
  add_sheet(scene, &room->sheet);
  add_cloth(scene, &room->cloth);
  ASSERT_OK(olx_add_ceiling_light(scene, olx_v3(1.2f, 2.799f, -1.3f), 0.6f, olx_splat(15.0f)));
  ASSERT_OK(olx_add_view(scene, "room", olx_v3(-1.6f, 1.6f, 1.7f), olx_v3(0.6f, 1.2f, -0.6f), 70.0f));
  return made_finish(scene);
}

static int make_room(void **state) {
  static room_of_kinds room;
  room.scene = make_scene(&room);
  olx_place_settings placing = olx_place_settings_default(room.scene);
  placing.voxels = 64;
  placing.surfels = 4096;
  placing.candidates = 256;
  placing.resolution = 256;
  olx_probe_set set;
  ASSERT_OK(olx_place(room.scene, &placing, NULL, &set));
  olx_vec3 *probes = olx_allocate(set.count, sizeof *probes);
  assert_non_null(probes);
  for (uint32_t i = 0; i < set.count; i++) probes[i] = set.probes[i].position;
  olx_bake_settings baking = olx_bake_settings_default(room.scene);
  baking.probes = probes;
  baking.probe_count = set.count;
  baking.radiance_size = 256;
  baking.irradiance_size = 16;
  baking.volume_cells = 16;
  baking.bounces = BOUNCES;
  room.field = baked_field(room.scene, &baking, NULL);
  olx_release(probes);
  olx_probe_set_free(&set);
  *state = &room;
  return 0;
}

static int free_room(void **state) {
  room_of_kinds *room = *state;
  olx_field_close(room->field);
  olx_scene_free(room->scene);
  return 0;
}

// Returns the public function's irradiance of a surface, with the normals that octalux/sample.h requires.
static olx_vec3 stored_light(const room_of_kinds *room, const olx_surface *s, bool mapped, olx_vec3 view) {
  const olx_sample_settings settings = olx_sample_settings_default();
  return olx_surface_irradiance(room->field, &settings, olx_madd(s->position, s->geometric_normal, s->epsilon),
                                s->geometric_normal, mapped ? s->shading_normal : s->geometric_normal, view);
}

static olx_vec3 true_light(const room_of_kinds *room, const olx_surface *s, uint32_t paths, uint32_t seed) {
  uint64_t rays = 0;
  return olx_path_surface_irradiance(room->scene, s, room->field->info.bounces.count + 1, paths, seed, &rays);
}

// Finds a random point of a material, on its front or its back; returns false where the material is cut away.
static bool point_of(const olx_scene *scene, uint32_t material, uint32_t index, bool back, olx_surface *s) {
  uint32_t first = 0, count = 0;
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    if (scene->material_index[t] != material) continue;
    if (count++ == 0) first = t;
  }
  const olx_vec2 random = made_random(material, index), in = olx_stratified2(index, material);
  const float root = sqrtf(in.x);
  const uint32_t *corner = scene->indices + 3 * (size_t)(first + (uint32_t)(random.x * (float)count));
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], c = scene->positions[corner[2]];
  const olx_ray_hit hit = {
      .triangle = (uint32_t)((corner - scene->indices) / 3), .u = root * (1.0f - in.y), .v = root * in.y};
  if (!olx_surface_present(scene, hit.triangle, hit.u, hit.v)) return false;
  const olx_vec3 front = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  *s = olx_surface_at(scene, &hit, back ? front : olx_negate(front));
  return true;
}

// The error of stored light against the path tracer: relative mean square and bias. The reference has two halves with
// independent noise, whose product has none on average.
typedef struct difference {
  double square, power, more, light;
} difference;

static void add_channel(difference *d, double x, double a, double b) {
  d->square += (x - a) * (x - b);
  d->power += a * b;
  d->more += x - 0.5 * (a + b);
  d->light += 0.5 * (a + b);
}

static void add_difference(difference *d, olx_vec3 x, olx_vec3 a, olx_vec3 b) {
  add_channel(d, (double)x.x, (double)a.x, (double)b.x);
  add_channel(d, (double)x.y, (double)a.y, (double)b.y);
  add_channel(d, (double)x.z, (double)a.z, (double)b.z);
}

static difference compare_side(const room_of_kinds *room, uint32_t material, bool mapped, bool back) {
  difference d = {0};
  for (uint32_t i = 0; i < POINTS; i++) {
    olx_surface s;
    if (!point_of(room->scene, material, i, back, &s)) continue;
    const olx_vec3 a = true_light(room, &s, PATHS, 2 * i), b = true_light(room, &s, PATHS, 2 * i + 1);
    add_difference(&d, stored_light(room, &s, mapped, s.geometric_normal), a, b);
  }
  assert_true(d.light > 0.0);
  return d;
}

static void assert_alike(const difference *d, const char *what, double relative_mse, double bias) {
  print_message("%s: relative mse %.5f, bias %+.4f\n", what, d->square / d->power, d->more / d->light);
  assert_true(d->square / d->power <= relative_mse);
  assert_true(fabs(d->more / d->light) <= bias);
}

// ---- kinds of surfaces

static void a_wall_with_a_normal_map(void **state) {
  const room_of_kinds *room = *state;
  const difference d = compare_side(room, room->bumpy, true, false);
  assert_alike(&d, "bumpy wall", 0.01, 0.02);
}

static void a_ball_with_normals_at_its_corners(void **state) {
  const room_of_kinds *room = *state;
  const difference d = compare_side(room, room->ball, false, false);
  assert_alike(&d, "ball", 0.01, 0.02);
}

static void a_card_with_holes(void **state) {
  const room_of_kinds *room = *state;
  const difference front = compare_side(room, room->leaf, false, false),
                   back = compare_side(room, room->leaf, false, true);
  assert_alike(&front, "leaf, front", 0.01, 0.02);
  assert_alike(&back, "leaf, back", 0.01, 0.02);
}

// If light of the bright side leaked through, the dim side would have more light than the path tracer finds.
static void each_side_of_a_sheet(void **state) {
  const room_of_kinds *room = *state;
  const difference front = compare_side(room, room->sheet, false, false),
                   back = compare_side(room, room->sheet, false, true);
  assert_true(back.light > 2.0 * front.light);
  assert_alike(&front, "sheet, front", 0.01, 0.02);
  assert_alike(&back, "sheet, back", 0.01, 0.02);
}

static void both_sides_of_a_curved_cloth(void **state) {
  const room_of_kinds *room = *state;
  const difference front = compare_side(room, room->cloth, false, false),
                   back = compare_side(room, room->cloth, false, true);
  assert_alike(&front, "cloth, front", 0.01, 0.02);
  assert_alike(&back, "cloth, back", 0.01, 0.02);
}

// ---- a camera that moves

enum { WIDTH = 640, HEIGHT = 360, FRAMES = 2, MANY_PATHS = 1 << 10 };

// STEADY is the relative change of a pixel's light between two frames that is allowed beyond the path tracer's change.
// Beside edges and on curved surfaces at grazing angles stored light has steps from texel to texel, so a share
// STEPS_SHARE of pixels may change by more, up to MOST_STEP.
static const double STEADY = 0.02, STEPS_SHARE = 0.001, MOST_STEP = 0.2;

// Returns the camera of a frame, which moves by two centimetres a frame and turns a little.
static olx_camera camera_of(const olx_scene *scene, uint32_t frame) {
  olx_camera camera = olx_scene_camera(scene, 0);
  const float way = 0.02f * (float)frame;
  camera.eye = olx_add(camera.eye, olx_v3(way, 0.3f * way, -0.5f * way));
  camera.target = olx_add(camera.target, olx_v3(-0.5f * way, 0.0f, way));
  return camera;
}

// A frame: its picture, and the surface at each pixel's centre.
typedef struct frame_seen {
  olx_camera_frame camera;
  olx_image image;
  bool any[WIDTH * HEIGHT];
  olx_surface surfaces[WIDTH * HEIGHT];
} frame_seen;

static frame_seen *see_frame(const room_of_kinds *room, uint32_t frame) {
  frame_seen *seen = olx_allocate_zero(1, sizeof *seen);
  assert_non_null(seen);
  const olx_camera camera = camera_of(room->scene, frame);
  ASSERT_OK(olx_camera_frame_make(&camera, WIDTH, HEIGHT, &seen->camera));
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    const float x = ((float)(i % WIDTH) + 0.5f) / WIDTH, y = ((float)(i / WIDTH) + 0.5f) / HEIGHT;
    const olx_ray ray = {seen->camera.eye, olx_camera_direction(&seen->camera, x, y), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(room->scene->bvh, &ray);
    seen->any[i] = hit.triangle != OLX_NO_HIT;
    if (seen->any[i]) seen->surfaces[i] = olx_surface_at(room->scene, &hit, ray.direction);
  }
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = 1;
  settings.centered = true;
  seen->image = tiny_render(room->scene, room->field, &camera, &settings);
  return seen;
}

static void free_frame(frame_seen *seen) {
  olx_image_free(&seen->image);
  olx_release(seen);
}

// Returns the irradiance that a pixel of a picture shows, averaged over channels.
static double shown(const olx_image *image, uint32_t i) {
  const olx_vec3 light = image->layers[OLX_LAYER_INDIRECT_DIFFUSE][i], albedo = image->layers[OLX_LAYER_ALBEDO][i];
  return (double)(OLX_PI * (light.x + light.y + light.z) / (albedo.x + albedo.y + albedo.z));
}

static double mean3(olx_vec3 v) { return ((double)v.x + (double)v.y + (double)v.z) / 3.0; }

// The four pixels of a frame around a point, and their weights; not found where one of them shows another surface.
typedef struct four_pixels {
  uint32_t at[4];
  float weight[4];
} four_pixels;

static bool same_surface(const frame_seen *seen, uint32_t i, const olx_surface *s) {
  const olx_surface *there = &seen->surfaces[i];
  return seen->any[i] && there->material == s->material &&
         olx_dot(there->geometric_normal, s->geometric_normal) > 0.95f &&
         olx_length(olx_sub(there->position, s->position)) < 0.1f;
}

static bool pixels_around(const frame_seen *seen, const olx_surface *s, four_pixels *around) {
  const olx_camera_frame *c = &seen->camera;
  const olx_vec3 way = olx_sub(s->position, c->eye);
  const float depth = olx_dot(way, c->forward), u = olx_dot(way, c->right) / (olx_dot(c->right, c->right) * depth),
              v = olx_dot(way, c->up) / (olx_dot(c->up, c->up) * depth), x = (0.5f + 0.5f * u) * WIDTH - 0.5f,
              y = (0.5f - 0.5f * v) * HEIGHT - 0.5f;
  if (!(depth > 0.0f && x >= 0.0f && y >= 0.0f && x < WIDTH - 1 && y < HEIGHT - 1)) return false;
  const float fx = x - floorf(x), fy = y - floorf(y);
  for (uint32_t k = 0; k < 4; k++) {
    around->at[k] = (uint32_t)x + k % 2 + WIDTH * ((uint32_t)y + k / 2);
    around->weight[k] = (k % 2 ? fx : 1.0f - fx) * (k / 2 ? fy : 1.0f - fy);
    if (!same_surface(seen, around->at[k], s)) return false;
  }
  return true;
}

static double shown_around(const olx_image *image, const four_pixels *around) {
  double sum = 0.0;
  for (uint32_t k = 0; k < 4; k++) sum += (double)around->weight[k] * shown(image, around->at[k]);
  return sum;
}

static double traced_around(const room_of_kinds *room, const frame_seen *seen, const four_pixels *around,
                            uint32_t seed) {
  double sum = 0.0;
  for (uint32_t k = 0; k < 4; k++)
    sum += (double)around->weight[k] * mean3(true_light(room, &seen->surfaces[around->at[k]], MANY_PATHS, seed));
  return sum;
}

// Returns the change of a point's light from one picture to the next, beyond that of the path tracer's light, which is
// traced only when the change exceeds the bound without it.
static double change_beyond(const room_of_kinds *room, const frame_seen *before, uint32_t i, const frame_seen *after,
                            const four_pixels *around) {
  const double one = shown(&before->image, i), two = shown_around(&after->image, around),
               change = fabs(two - one) / one;
  if (!(change > STEADY)) return 0.0;
  const double a = mean3(true_light(room, &before->surfaces[i], MANY_PATHS, i)),
               b = traced_around(room, after, around, i);
  return change - fabs(b - a) / a;
}

static void frames_of_a_moving_camera_are_steady(void **state) {
  const room_of_kinds *room = *state;
  frame_seen *before = see_frame(room, 0);
  uint32_t followed = 0, steps = 0;
  double worst = 0.0;
  for (uint32_t frame = 1; frame < FRAMES; frame++) {
    frame_seen *after = see_frame(room, frame);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
      four_pixels around;
      if (!before->any[i] || !pixels_around(after, &before->surfaces[i], &around)) continue;
      if (!(shown(&before->image, i) > 0.0)) continue;
      const double beyond = change_beyond(room, before, i, after, &around);
      steps += beyond > STEADY;
      worst = fmax(worst, beyond);
      followed++;
    }
    free_frame(before);
    before = after;
  }
  free_frame(before);
  print_message("%u pixels followed, %u with steps, the greatest %.4f\n", followed, steps, worst);
  assert_true(followed > (FRAMES - 1) * WIDTH * HEIGHT * 3 / 4);
  assert_true((double)steps <= STEPS_SHARE * (double)followed);
  assert_true(worst <= MOST_STEP);
}

// Light at fixed points does not depend on the camera's position.
static void light_at_a_point_is_the_same_from_everywhere(void **state) {
  const room_of_kinds *room = *state;
  const uint32_t materials[] = {0, 1, 2, room->bumpy, room->ball, room->leaf, room->sheet, room->cloth};
  for (uint32_t i = 0; i < 2000; i++) {
    olx_surface s;
    const uint32_t material = materials[i % (sizeof materials / sizeof *materials)];
    if (!point_of(room->scene, material, i, i / 8 % 2, &s)) continue;
    const bool mapped = material == room->bumpy;
    const olx_vec3 first = stored_light(room, &s, mapped, s.geometric_normal);
    for (uint32_t k = 0; k < 4; k++) {
      const olx_vec3 view = olx_from_basis(olx_sample_cosine(olx_stratified2(k, i)), s.geometric_normal);
      const olx_vec3 light = stored_light(room, &s, mapped, view);
      assert_memory_equal(&light, &first, sizeof first);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_wall_with_a_normal_map),
      cmocka_unit_test(a_ball_with_normals_at_its_corners),
      cmocka_unit_test(a_card_with_holes),
      cmocka_unit_test(each_side_of_a_sheet),
      cmocka_unit_test(both_sides_of_a_curved_cloth),
      cmocka_unit_test(light_at_a_point_is_the_same_from_everywhere),
      cmocka_unit_test(frames_of_a_moving_camera_are_steady),
  };
  return cmocka_run_group_tests(tests, make_room, free_room);
}
