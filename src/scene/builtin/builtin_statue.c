// Builds a figure with a staff before a square lamp, which Wang (2018) adds to Sponza, because probes in one line do
// not see its far sides.
#include "core/result.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/builtin_shapes.h"

// Adds a round limb that tapers from `a` to `b`, open at both ends, which lie inside other parts or are rounded by a
// hand.
static olx_result add_limb(olx_scene *scene, olx_vec3 a, olx_vec3 b, float radius_a, float radius_b,
                           uint32_t material) {
  enum { SIDES = 16 };
  olx_vec3 positions[2 * SIDES], normals[2 * SIDES], u, v;
  uint32_t indices[6 * SIDES];
  const olx_vec3 along = olx_sub(b, a), axis = olx_normalize(along);
  const float slope = (radius_a - radius_b) / olx_length(along);
  olx_basis(axis, &u, &v);
  for (uint32_t i = 0; i < SIDES; i++) {
    const float phi = 2.0f * OLX_PI * (float)i / SIDES;
    const olx_vec3 out = olx_add(olx_scale(u, cosf(phi)), olx_scale(v, sinf(phi)));
    positions[2 * i] = olx_madd(a, out, radius_a);
    positions[2 * i + 1] = olx_madd(b, out, radius_b);
    normals[2 * i] = normals[2 * i + 1] = olx_normalize(olx_madd(out, axis, slope));
    const uint32_t low = 2 * i, next = 2 * ((i + 1) % SIDES);
    const uint32_t faces[6] = {low, next, next + 1, low, next + 1, low + 1};
    for (uint32_t k = 0; k < 6; k++) indices[6 * i + k] = faces[k];
  }
  return olx_scene_add_mesh(scene, "statue", positions, normals, NULL, 2 * SIDES, indices, 2 * SIDES, material);
}

static olx_result add_ball(olx_scene *scene, olx_vec3 center, float radius, uint32_t material) {
  enum { RINGS = 12 };
  olx_vec2 profile[RINGS + 1];
  for (uint32_t i = 0; i <= RINGS; i++) {
    const float angle = OLX_PI * ((float)i / RINGS - 0.5f);
    profile[i] = (olx_vec2){i == 0 || i == RINGS ? 0.0f : radius * cosf(angle), radius * sinf(angle)};
  }
  return olx_add_lathe(scene, "statue", center, profile, RINGS + 1, 24, material);
}

static olx_result add_figure(olx_scene *scene, uint32_t material) {
  const olx_vec2 robe[] = {{0.36f, 0.6f},  {0.33f, 0.8f},  {0.26f, 1.1f},  {0.2f, 1.4f},   {0.19f, 1.5f},
                           {0.24f, 1.75f}, {0.25f, 1.88f}, {0.18f, 1.98f}, {0.08f, 2.03f}, {0.075f, 2.12f}};
  const olx_vec3 shoulder[2] = {{-0.22f, 1.88f, 0.0f}, {0.22f, 1.88f, 0.0f}};
  const olx_vec3 elbow[2] = {{-0.47f, 1.72f, 0.1f}, {0.44f, 1.6f, 0.05f}};
  const olx_vec3 hand[2] = {{-0.56f, 2.05f, 0.22f}, {0.3f, 1.42f, 0.34f}};
  OLX_TRY(olx_add_lathe(scene, "statue", olx_splat(0.0f), robe, 10, 40, material));
  OLX_TRY(add_ball(scene, olx_v3(0.0f, 2.25f, 0.01f), 0.15f, material));
  for (uint32_t side = 0; side < 2; side++) {
    OLX_TRY(add_limb(scene, shoulder[side], elbow[side], 0.09f, 0.07f, material));
    OLX_TRY(add_limb(scene, elbow[side], hand[side], 0.07f, 0.05f, material));
    OLX_TRY(add_ball(scene, shoulder[side], 0.09f, material));
    OLX_TRY(add_ball(scene, elbow[side], 0.07f, material));
    OLX_TRY(add_ball(scene, hand[side], 0.07f, material));
  }
  return OLX_OK;
}

// Builds a figure on a pedestal with a staff in its raised hand, and a square lamp behind it that faces it, as Wang
// adds to Sponza (section 5.1.1).
olx_result olx_build_statue(olx_scene *scene) {
  uint32_t marble, bronze;
  OLX_TRY(olx_add_glossy(scene, "statue", olx_v3(0.7f, 0.68f, 0.63f), 0.0f, 0.3f, &marble));
  OLX_TRY(olx_add_glossy(scene, "staff", olx_v3(0.6f, 0.42f, 0.22f), 0.0f, 0.3f, &bronze));
  OLX_TRY(olx_add_box(scene, "pedestal", olx_v3(-0.45f, 0.0f, -0.45f), olx_v3(0.45f, 0.6f, 0.45f), marble));
  OLX_TRY(add_figure(scene, marble));
  OLX_TRY(olx_add_lathe(scene, "staff", olx_v3(-0.56f, 0.0f, 0.22f),
                        (const olx_vec2[]){{0.0f, 0.62f}, {0.025f, 0.62f}, {0.025f, 2.5f}, {0.0f, 2.56f}}, 4, 12,
                        bronze));
  OLX_TRY(olx_scene_add_rect_light(scene, olx_v3(0.0f, 1.4f, -1.3f), olx_v3(1.6f, 0.0f, 0.0f), olx_v3(0.0f, 1.6f, 0.0f),
                                   olx_v3(9.0f, 8.5f, 7.5f)));
  olx_set_probes(scene, olx_v3(-1.5f, 0.5f, -1.0f), olx_v3(1.5f, 2.2f, 1.5f), 2, 2, 2);
  return olx_add_view(scene, "statue", olx_v3(0.9f, 1.7f, 3.6f), olx_v3(0.0f, 1.4f, 0.0f), 50.0f);
}
