// Tests the surface that a ray finds: position, normals, textures, side, and ray offsets that work at every scale.
#include "core/sampling.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/emitters.h"
#include "scene/scene_build.h"
#include "scene/surface.h"
#include "scene/texture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void assert_near(float value, float expected, float tolerance) {
  if (!(fabsf(value - expected) <= tolerance)) fail_msg("%.9g is not %.9g", (double)value, (double)expected);
}

static void assert_vector_near(olx_vec3 value, olx_vec3 expected, float tolerance) {
  assert_near(value.x, expected.x, tolerance);
  assert_near(value.y, expected.y, tolerance);
  assert_near(value.z, expected.z, tolerance);
}

static olx_surface find(const olx_scene *scene, olx_vec3 origin, olx_vec3 direction) {
  const olx_ray ray = {origin, direction, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  assert_true(hit.triangle != OLX_NO_HIT);
  return olx_surface_at(scene, &hit, direction);
}

static olx_surface from_above(const olx_scene *scene, float x, float z) {
  return find(scene, olx_v3(x, 5.0f, z), olx_v3(0.0f, -1.0f, 0.0f));
}

static olx_surface from_below(const olx_scene *scene, float x, float z) {
  return find(scene, olx_v3(x, -5.0f, z), olx_v3(0.0f, 1.0f, 0.0f));
}

// Makes the square [-1, 1]^2 of one material.
static olx_scene *square_scene(olx_scene *scene, const olx_material *material) {
  made_square(scene, 0.0f, made_material(scene, material));
  return made_finish(scene);
}

static void normals_face_the_ray_on_both_sides(void **state) {
  (void)state;
  const olx_material material = olx_material_default();
  olx_scene *scene = square_scene(made_scene(), &material);
  const olx_surface above = from_above(scene, 0.3f, 0.1f), below = from_below(scene, 0.3f, 0.1f);
  assert_false(above.back_face);
  assert_true(below.back_face);
  assert_vector_near(above.geometric_normal, olx_v3(0.0f, 1.0f, 0.0f), 0.0f);
  assert_vector_near(below.geometric_normal, olx_v3(0.0f, -1.0f, 0.0f), 0.0f);
  assert_vector_near(above.shading_normal, above.geometric_normal, 1e-6f);
  assert_vector_near(below.shading_normal, below.geometric_normal, 1e-6f);
  assert_vector_near(above.position, olx_v3(0.3f, 0.0f, 0.1f), 1e-6f);
  olx_scene_free(scene);
}

static void shading_normals_are_interpolated_and_stay_on_the_geometric_side(void **state) {
  (void)state;
  const olx_vec3 corners[3] = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}};
  const olx_vec3 tilted = olx_normalize(olx_v3(1.0f, 1.0f, 0.0f)), up = {0.0f, 1.0f, 0.0f};
  const olx_vec3 normals[2][3] = {{up, up, tilted}, {olx_negate(up), olx_negate(up), olx_negate(tilted)}};
  const uint32_t indices[3] = {0, 1, 2};
  const olx_vec3 expected = olx_normalize(olx_mix3(up, tilted, 0.5f));
  // Normals that contradict the winding describe the same surface.
  for (uint32_t i = 0; i < 2; i++) {
    olx_scene *scene = made_scene();
    const olx_material material = olx_material_default();
    const uint32_t index = made_material(scene, &material);
    assert_int_equal(olx_scene_add_mesh(scene, "triangle", corners, normals[i], NULL, 3, indices, 1, index), OLX_OK);
    made_finish(scene);
    assert_vector_near(from_above(scene, 0.5f, 0.25f).shading_normal, expected, 1e-5f);
    assert_vector_near(from_below(scene, 0.5f, 0.25f).shading_normal, olx_negate(expected), 1e-5f);
    olx_scene_free(scene);
  }
}

static olx_vec3 mapped(const uint8_t texel[4], float scale, olx_vec3 edge_u, olx_vec3 edge_v, bool above) {
  olx_scene *scene = made_scene();
  olx_material material = olx_material_default();
  material.normal_texture = made_texture(scene, 1, 1, texel, false);
  material.normal_scale = scale;
  made_quad(scene, olx_splat(0.0f), edge_u, edge_v, made_material(scene, &material));
  made_finish(scene);
  const olx_surface s = above ? from_above(scene, 0.1f, 0.2f) : from_below(scene, 0.1f, 0.2f);
  olx_scene_free(scene);
  return s.shading_normal;
}

// In a normal map 51 / 255 = 0.2 encodes -0.6, 204 / 255 = 0.8 encodes 0.6, and 229.5 would encode 0.8.
static void normal_maps_tilt_along_u_and_against_v(void **state) {
  (void)state;
  const olx_vec3 x = {2.0f, 0.0f, 0.0f}, z = {0.0f, 0.0f, 2.0f}, minus_z = {0.0f, 0.0f, -2.0f};
  const uint8_t red[4] = {204, 128, 230, 255}, green[4] = {128, 204, 230, 255};
  const float tolerance = 0.006f;
  // With u along +x and v along -z, seen from above, texture rows go down the page as z falls.
  assert_vector_near(mapped(red, 1.0f, x, minus_z, true), olx_v3(0.6f, 0.8f, 0.0f), tolerance);
  assert_vector_near(mapped(green, 1.0f, x, minus_z, true), olx_v3(0.0f, 0.8f, 0.6f), tolerance);
  // With u along z and v along x, both maps turn by a quarter about the normal.
  assert_vector_near(mapped(red, 1.0f, z, x, true), olx_v3(0.0f, 0.8f, 0.6f), tolerance);
  assert_vector_near(mapped(green, 1.0f, z, x, true), olx_v3(-0.6f, 0.8f, 0.0f), tolerance);
  // Seen from behind, bumps are dents.
  assert_vector_near(mapped(red, 1.0f, x, minus_z, false), olx_v3(-0.6f, -0.8f, 0.0f), tolerance);
  // A scale of 2 steepens the normal: (2 * 0.6, 0.8) = (3, 2) / sqrt(13).
  assert_vector_near(mapped(red, 2.0f, x, minus_z, true), olx_v3(0.832f, 0.555f, 0.0f), tolerance);
}

static void mirrored_texture_coordinates_mirror_the_normal_map(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  olx_material material = olx_material_default();
  const uint8_t texel[4] = {204, 128, 230, 255};
  material.normal_texture = made_texture(scene, 1, 1, texel, false);
  const uint32_t index = made_material(scene, &material);
  const olx_vec3 corners[3] = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}};
  const olx_vec2 uvs[3] = {{0.0f, 0.0f}, {0.0f, -1.0f}, {-1.0f, 0.0f}};
  const uint32_t indices[3] = {0, 1, 2};
  assert_int_equal(olx_scene_add_mesh(scene, "mirrored", corners, NULL, uvs, 3, indices, 1, index), OLX_OK);
  made_finish(scene);
  assert_vector_near(from_above(scene, 0.2f, 0.2f).shading_normal, olx_v3(-0.6f, 0.8f, 0.0f), 0.006f);
  olx_scene_free(scene);
}

static void height_maps_lean_away_from_the_slope_at_any_size(void **state) {
  (void)state;
  const uint8_t ramp[16] = {0, 0, 0, 255, 51, 51, 51, 255, 102, 102, 102, 255, 153, 153, 153, 255};
  const float sizes[3] = {0.01f, 1.0f, 100.0f};
  for (uint32_t i = 0; i < 3; i++) {
    olx_scene *scene = made_scene();
    olx_material material = olx_material_default();
    material.normal_texture = made_texture(scene, 4, 1, ramp, false);
    material.normal_is_height = true;
    const olx_vec3 u = {2.0f * sizes[i], 0.0f, 0.0f}, v = {0.0f, 0.0f, -2.0f * sizes[i]};
    made_quad(scene, olx_splat(0.0f), u, v, made_material(scene, &material));
    made_finish(scene);
    // The height rises by one step of 51 / 255 for each texel along u.
    const olx_surface s = find(scene, olx_v3(0.0f, sizes[i], 0.0f), olx_v3(0.0f, -1.0f, 0.0f));
    assert_vector_near(s.shading_normal, olx_normalize(olx_v3(-0.2f, 1.0f, 0.0f)), 1e-4f);
    olx_scene_free(scene);
  }
}

static void textures_without_a_tangent_frame_leave_the_normal(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  olx_material material = olx_material_default();
  const uint8_t texel[4] = {255, 128, 128, 255};
  material.normal_texture = made_texture(scene, 1, 1, texel, false);
  const uint32_t index = made_material(scene, &material);
  const olx_vec3 corners[3] = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}};
  const uint32_t indices[3] = {0, 1, 2};
  assert_int_equal(olx_scene_add_mesh(scene, "no uv", corners, NULL, NULL, 3, indices, 1, index), OLX_OK);
  made_finish(scene);
  assert_vector_near(from_above(scene, 0.2f, 0.2f).shading_normal, olx_v3(0.0f, 1.0f, 0.0f), 1e-6f);
  olx_scene_free(scene);
}

static void srgb_is_decoded_as_the_standard_says(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 256; i++) {
    uint8_t rgba[4] = {(uint8_t)i, (uint8_t)i, (uint8_t)i, (uint8_t)i};
    const olx_texture encoded = {.width = 1, .height = 1, .texels = rgba, .srgb = true};
    const olx_texture plain = {.width = 1, .height = 1, .texels = rgba, .srgb = false};
    const float c = (float)i / 255.0f, linear = c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
    assert_near(olx_texture_texel(&encoded, 0, 0).color.y, linear, 1e-6f);
    assert_near(olx_texture_texel(&encoded, 0, 0).alpha, c, 1e-6f);
    assert_near(olx_texture_texel(&plain, 0, 0).color.z, c, 1e-6f);
  }
}

static void textures_are_bilinear_and_wrap_around(void **state) {
  (void)state;
  uint8_t rgba[2 * 3 * 4] = {0};
  for (uint32_t y = 0; y < 3; y++) {
    rgba[8 * y + 4] = 255;                                  // column 1 is red everywhere
    rgba[8 * y + 1] = rgba[8 * y + 5] = (uint8_t)(100 * y); // green rises with the row
  }
  const olx_texture texture = {.width = 2, .height = 3, .texels = rgba};
  const struct {
    float u, red;
  } columns[] = {{0.25f, 0.0f},  {0.75f, 1.0f}, {0.5f, 0.5f},   {0.0f, 0.5f},   {1.0f, 0.5f},
                 {-0.25f, 1.0f}, {1.25f, 0.0f}, {-7.75f, 0.0f}, {0.375f, 0.25f}};
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
    const olx_vec3 c = olx_texture_sample(&texture, (olx_vec2){columns[i].u, 0.5f}).color;
    assert_near(c.x, columns[i].red, 1e-5f);
    assert_near(c.y, 100.0f / 255.0f, 1e-5f);
  }
  // The first row is at the smallest v.
  assert_near(olx_texture_sample(&texture, (olx_vec2){0.5f, 1.0f / 6.0f}).color.y, 0.0f, 1e-5f);
  assert_near(olx_texture_sample(&texture, (olx_vec2){0.5f, 5.0f / 6.0f}).color.y, 200.0f / 255.0f, 1e-5f);
  assert_near(olx_texture_sample(&texture, (olx_vec2){0.5f, 0.0f}).color.y, 100.0f / 255.0f, 1e-5f);
  assert_true(olx_finite(olx_texture_sample(&texture, (olx_vec2){NAN, INFINITY}).color));
  assert_true(olx_finite(olx_texture_sample(&texture, (olx_vec2){3e38f, -1e-30f}).color));
}

static void alpha_alone_is_what_the_whole_texel_has(void **state) {
  (void)state;
  uint8_t rgba[5 * 3 * 4];
  for (uint32_t i = 0; i < sizeof rgba; i++) rgba[i] = (uint8_t)(made_random(1, i).x * 255.0f);
  const olx_texture texture = {.width = 5, .height = 3, .texels = rgba, .srgb = true};
  for (uint32_t i = 0; i < 1000; i++) {
    const olx_vec2 random = made_random(2, i), uv = {8.0f * random.x - 4.0f, 8.0f * random.y - 4.0f};
    assert_true(olx_texture_alpha(&texture, uv) == olx_texture_sample(&texture, uv).alpha);
  }
  assert_true(isfinite(olx_texture_alpha(&texture, (olx_vec2){NAN, INFINITY})));
}

// Filtering is linear in light: on average, a textured wall reflects what its texels reflect, however near the camera
// is. Filtering the encoded texels would make it darker.
static void filtering_keeps_what_srgb_texels_reflect(void **state) {
  (void)state;
  enum { TEXELS = 16, LOOK_UPS = 8 * TEXELS };
  uint8_t rgba[TEXELS * 4];
  double of_texels = 0.0, of_look_ups = 0.0;
  for (uint32_t i = 0; i < TEXELS; i++) {
    const float c = floorf(made_random(7, i).x * 255.0f) / 255.0f;
    for (uint32_t k = 0; k < 4; k++) rgba[4 * i + k] = (uint8_t)(c * 255.0f + 0.5f);
    of_texels += (double)(c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f)) / TEXELS;
  }
  const olx_texture texture = {.width = TEXELS, .height = 1, .texels = rgba, .srgb = true};
  for (uint32_t i = 0; i < LOOK_UPS; i++) {
    const olx_vec2 uv = {((float)i + 0.5f) / LOOK_UPS, 0.5f};
    of_look_ups += (double)olx_texture_sample(&texture, uv).color.y / LOOK_UPS;
  }
  assert_near((float)of_look_ups, (float)of_texels, 1e-5f);
}

static void textures_scale_the_factors_and_albedo_stays_below_one(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  olx_material material = olx_material_default();
  const uint8_t white[4] = {255, 255, 255, 255}, metal[4] = {255, 51, 102, 255}, half[4] = {255, 128, 0, 255};
  material.base_color = olx_v3(1.0f, 0.5f, 2.0f);
  material.base_color_texture = made_texture(scene, 1, 1, white, true);
  material.metallic = 0.5f;
  material.roughness = 0.9f;
  material.specular_weight = 1.0f;
  material.metallic_roughness_texture = made_texture(scene, 1, 1, metal, false);
  material.emission = olx_v3(2.0f, 3.0f, 4.0f);
  material.emission_texture = made_texture(scene, 1, 1, half, false);
  square_scene(scene, &material);
  const olx_surface s = from_above(scene, 0.1f, 0.1f);
  // The material has metallic 0.5 * 0.4 and roughness 0.9 * 0.2.
  assert_near(s.roughness, 0.18f, 1e-6f);
  const olx_bsdf expected = olx_bsdf_make(olx_v3(0.95f, 0.5f, 0.95f), 0.2f, 0.18f, 1.0f);
  assert_vector_near(s.bsdf.albedo, expected.albedo, 1e-5f);
  assert_vector_near(s.bsdf.f0, expected.f0, 1e-5f);
  assert_near(s.bsdf.alpha, expected.alpha, 1e-6f);
  assert_vector_near(s.emission, olx_v3(2.0f, 3.0f * 128.0f / 255.0f, 0.0f), 1e-5f);
  olx_scene_free(scene);
}

static void one_sided_emitters_are_dark_from_behind(void **state) {
  (void)state;
  for (uint32_t both = 0; both < 2; both++) {
    olx_material material = olx_material_default();
    material.emission = olx_v3(1.0f, 2.0f, 3.0f);
    material.emits_both_sides = both;
    olx_scene *scene = square_scene(made_scene(), &material);
    const olx_surface lit = from_above(scene, 0.2f, 0.2f), behind = from_below(scene, 0.2f, 0.2f);
    assert_vector_near(lit.emission, material.emission, 0.0f);
    assert_near(olx_emitters_area_pdf(scene, lit.triangle), 0.25f, 1e-6f);
    assert_vector_near(behind.emission, both ? material.emission : olx_splat(0.0f), 0.0f);
    const float from_behind =
        olx_emitters_surface_pdf(scene, &behind, olx_v3(0.2f, -5.0f, 0.2f), olx_v3(0.0f, 1.0f, 0.0f));
    assert_int_equal(from_behind > 0.0f, both);
    olx_scene_free(scene);
  }
}

// Rays that look for lamps ask olx_hit_emits before they evaluate a surface, so that it must agree with the surface's
// own emission: a panel whose emission texture is black in half of its texels glows at the others, from either side.
static void a_hit_glows_where_the_surface_emits_on_either_side(void **state) {
  (void)state;
  const uint8_t row[4 * 4] = {0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 255, 255, 0, 0, 255, 255};
  for (uint32_t glows = 0; glows < 2; glows++) {
    olx_scene *scene = made_scene();
    olx_material material = olx_material_default();
    material.emission = olx_splat(glows ? 2.0f : 0.0f);
    material.emission_texture = made_texture(scene, 4, 1, row, true);
    made_quad(scene, olx_splat(0.0f), olx_v3(0.0f, 0.0f, 2.0f), olx_v3(2.0f, 0.0f, 0.0f),
              made_material(scene, &material));
    made_finish(scene);
    uint32_t lit = 0;
    for (uint32_t i = 0; i < 100; i++) {
      const float z = -0.99f + 0.02f * (float)i, side = i % 2 ? 1.0f : -1.0f;
      const olx_ray ray = {olx_v3(0.3f, 5.0f * side, z), olx_v3(0.0f, -side, 0.0f), 0.0f, INFINITY};
      const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
      const bool emits = olx_max3(from_above(scene, 0.3f, z).emission) > 0.0f;
      assert_int_equal(olx_hit_emits(scene, &hit), emits);
      lit += emits;
    }
    assert_in_range(lit, glows ? 40 : 0, glows ? 80 : 0);
    olx_scene_free(scene);
  }
}

static void alpha_below_the_cutoff_is_absent(void **state) {
  (void)state;
  const uint8_t base[4] = {255, 255, 255, 204}, mask[4] = {128, 0, 0, 0};
  const struct {
    bool use_base, use_mask;
    float factor, cutoff;
    bool present;
  } cases[] = {{false, false, 0.3f, 0.0f, true},  {false, false, 0.3f, 0.5f, false}, {true, false, 1.0f, 0.79f, true},
               {true, false, 1.0f, 0.81f, false}, {true, true, 1.0f, 0.39f, true},   {true, true, 1.0f, 0.41f, false},
               {true, true, 0.5f, 0.19f, true},   {false, true, 1.0f, 0.51f, false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    olx_scene *scene = made_scene();
    olx_material material = olx_material_default();
    material.alpha = cases[i].factor;
    material.alpha_cutoff = cases[i].cutoff;
    if (cases[i].use_base) material.base_color_texture = made_texture(scene, 1, 1, base, true);
    if (cases[i].use_mask) material.alpha_texture = made_texture(scene, 1, 1, mask, false);
    square_scene(scene, &material);
    assert_int_equal(olx_surface_present(scene, 0, 0.3f, 0.3f), cases[i].present);
    olx_scene_free(scene);
  }
}

// Makes a room that contains a block, for walks of light from wall to wall.
static olx_scene *walkable_room(olx_vec3 center, float side) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t index = made_material(scene, &material);
  made_room(scene, center, side, index);
  made_quad(scene, olx_madd(center, olx_v3(0.1f, -0.2f, 0.05f), side), olx_v3(0.3f * side, 0.1f * side, 0.0f),
            olx_v3(0.0f, 0.1f * side, 0.25f * side), index);
  return made_finish(scene);
}

// Follows diffuse reflections and records the triangles; fails when the walk leaves the room.
static void walk(const olx_scene *scene, olx_vec3 start, uint32_t seed, uint32_t steps, uint32_t *triangles) {
  olx_ray ray = {start, olx_sample_sphere(made_random(seed, 0)), 0.0f, INFINITY};
  for (uint32_t i = 0; i < steps; i++) {
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    assert_true(hit.triangle != OLX_NO_HIT);
    triangles[i] = hit.triangle;
    const olx_surface s = olx_surface_at(scene, &hit, ray.direction);
    ray =
        olx_surface_ray(&s, olx_from_basis(olx_sample_cosine(made_random(seed, i + 1)), s.geometric_normal), INFINITY);
  }
}

static void light_takes_the_same_way_at_every_scale(void **state) {
  (void)state;
  enum { STEPS = 4000 };
  static uint32_t expected[STEPS], triangles[STEPS];
  const float scales[5] = {1.0f, 0x1p-7f, 0x1p7f, 0x1p-14f, 0x1p14f};
  for (uint32_t i = 0; i < 5; i++) {
    olx_scene *scene = walkable_room(olx_splat(0.0f), scales[i]);
    walk(scene, olx_scale(olx_v3(0.2f, 0.3f, -0.1f), scales[i]), 5, STEPS, i == 0 ? expected : triangles);
    if (i > 0) assert_memory_equal(triangles, expected, sizeof expected);
    olx_scene_free(scene);
  }
}

static void no_light_leaves_a_closed_room_far_from_the_origin(void **state) {
  (void)state;
  static uint32_t triangles[20000];
  const olx_vec3 centers[3] = {{0.0f, 0.0f, 0.0f}, {1000.0f, -50.0f, 3.0f}, {-3e4f, 1e4f, 7e3f}};
  for (uint32_t i = 0; i < 3; i++) {
    olx_scene *scene = walkable_room(centers[i], 4.0f);
    walk(scene, olx_add(centers[i], olx_v3(0.3f, 0.6f, 0.2f)), i, 20000, triangles);
    olx_scene_free(scene);
  }
}

// In a convex room any two points of the walls that are not on the same wall see each other, at any scale and position.
static void rays_between_two_walls_meet_neither(void **state) {
  (void)state;
  const float sides[3] = {0.01f, 2.0f, 100.0f};
  const olx_vec3 offsets[2] = {{0.0f, 0.0f, 0.0f}, {300.0f, 20.0f, -70.0f}};
  for (uint32_t round = 0; round < 6; round++) {
    const float side = sides[round % 3];
    const olx_vec3 center = olx_scale(offsets[round / 3], side);
    olx_scene *scene = made_scene();
    const olx_material material = olx_material_default();
    made_room(scene, center, side, made_material(scene, &material));
    made_finish(scene);
    for (uint32_t i = 0; i < 5000; i++) {
      const olx_vec3 a = olx_sample_sphere(made_random(1, i)), b = olx_sample_sphere(made_random(2, i));
      const olx_surface from = find(scene, center, a), to = find(scene, center, b);
      if (olx_dot(from.geometric_normal, to.geometric_normal) > 0.5f) continue;
      const olx_vec3 target = olx_madd(to.position, to.geometric_normal, to.epsilon);
      const olx_ray ray = olx_surface_ray_to(&from, target, to.epsilon);
      assert_false(olx_bvh_occluded(scene->bvh, &ray));
      // A ray without an end meets the target.
      const olx_ray beyond = {ray.origin, ray.direction, 0.0f, INFINITY};
      const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &beyond);
      assert_true(hit.triangle != OLX_NO_HIT && hit.t >= ray.t_max);
    }
    olx_scene_free(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(normals_face_the_ray_on_both_sides),
      cmocka_unit_test(shading_normals_are_interpolated_and_stay_on_the_geometric_side),
      cmocka_unit_test(normal_maps_tilt_along_u_and_against_v),
      cmocka_unit_test(mirrored_texture_coordinates_mirror_the_normal_map),
      cmocka_unit_test(height_maps_lean_away_from_the_slope_at_any_size),
      cmocka_unit_test(textures_without_a_tangent_frame_leave_the_normal),
      cmocka_unit_test(srgb_is_decoded_as_the_standard_says),
      cmocka_unit_test(textures_are_bilinear_and_wrap_around),
      cmocka_unit_test(alpha_alone_is_what_the_whole_texel_has),
      cmocka_unit_test(filtering_keeps_what_srgb_texels_reflect),
      cmocka_unit_test(textures_scale_the_factors_and_albedo_stays_below_one),
      cmocka_unit_test(one_sided_emitters_are_dark_from_behind),
      cmocka_unit_test(a_hit_glows_where_the_surface_emits_on_either_side),
      cmocka_unit_test(alpha_below_the_cutoff_is_absent),
      cmocka_unit_test(light_takes_the_same_way_at_every_scale),
      cmocka_unit_test(no_light_leaves_a_closed_room_far_from_the_origin),
      cmocka_unit_test(rays_between_two_walls_meet_neither),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
