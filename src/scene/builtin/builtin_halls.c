// Builds two halls of McGuire et al. 2017: a star-shaped hall, all of which one probe sees, and a hall with an area
// light, a statue and a glossy floor.
#include "core/result.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/builtin_shapes.h"

// Builds a star-shaped hall, all of which one probe sees (McGuire et al. Fig. 17).
olx_result olx_build_holodeck(olx_scene *scene) {
  enum { POINTS = 16 };
  uint32_t floor, ceiling, panels[2], walls[POINTS];
  OLX_TRY(olx_add_glossy(scene, "floor", olx_v3(0.25f, 0.25f, 0.28f), 0.0f, 0.25f, &floor));
  OLX_TRY(olx_add_matte(scene, "ceiling", olx_splat(0.6f), &ceiling));
  OLX_TRY(olx_add_matte(scene, "yellow panel", olx_v3(0.7f, 0.55f, 0.15f), &panels[0]));
  OLX_TRY(olx_add_matte(scene, "grey panel", olx_v3(0.35f, 0.36f, 0.4f), &panels[1]));
  olx_vec2 outline[POINTS];
  for (uint32_t i = 0; i < POINTS; i++) {
    const float phi = 2.0f * OLX_PI * (float)i / POINTS, radius = i % 2 ? 3.0f : 3.6f;
    outline[i] = (olx_vec2){radius * cosf(phi), radius * sinf(phi)};
    walls[i] = panels[i / 2 % 2];
  }
  const olx_prism hall = {.outline = outline,
                          .points = POINTS,
                          .low = 0.0f,
                          .high = 3.5f,
                          .low_material = floor,
                          .high_material = ceiling,
                          .side_materials = walls};
  OLX_TRY(olx_add_prism(scene, "hall", &hall));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(0.0f, 3.48f, 0.0f), 1.5f, olx_splat(8.0f)));
  const olx_vec3 center = {0.0f, 1.7f, 0.0f};
  olx_set_probes(scene, center, center, 1, 1, 1);
  return olx_add_view(scene, "entrance", olx_v3(-2.4f, 1.7f, 1.2f), olx_v3(1.2f, 1.2f, -0.6f), 70.0f);
}

// Adds pedestal, robe, shoulders and head of a statue.
static olx_result add_statue(olx_scene *scene, olx_vec3 base, uint32_t material) {
  olx_vec2 profile[24] = {{0.42f, 0.0f}, {0.42f, 0.12f}, {0.34f, 0.12f}, {0.34f, 0.45f}, {0.4f, 0.45f},
                          {0.4f, 0.52f}, {0.3f, 0.52f},  {0.24f, 0.9f},  {0.2f, 1.15f},  {0.27f, 1.4f},
                          {0.22f, 1.5f}, {0.09f, 1.56f}, {0.09f, 1.62f}};
  uint32_t points = 13;
  const float radius = 0.16f, center = 1.75f;
  for (uint32_t i = 0; i <= 8; i++) {
    // The profile of the head, from where the neck meets its sphere up to its top.
    const float from = -0.97f, angle = from + (0.5f * OLX_PI - from) * (float)i / 8.0f;
    profile[points++] = (olx_vec2){i == 8 ? 0.0f : radius * cosf(angle), center + radius * sinf(angle)};
  }
  return olx_add_lathe(scene, "statue", base, profile, points, 40, material);
}

// Builds a hall whose only light is an emissive square, with a statue before it, banners beside it and a glossy floor
// (McGuire et al. Fig. 14).
olx_result olx_build_area_light(olx_scene *scene) {
  uint32_t floor, wall, statue, banners[2];
  OLX_TRY(olx_add_glossy(scene, "polished floor", olx_v3(0.35f, 0.33f, 0.3f), 0.0f, 0.2f, &floor));
  OLX_TRY(olx_add_matte(scene, "wall", olx_splat(0.5f), &wall));
  OLX_TRY(olx_add_matte(scene, "statue", olx_v3(0.7f, 0.68f, 0.63f), &statue));
  OLX_TRY(olx_add_matte(scene, "red banner", olx_v3(0.65f, 0.1f, 0.08f), &banners[0]));
  OLX_TRY(olx_add_matte(scene, "blue banner", olx_v3(0.1f, 0.2f, 0.6f), &banners[1]));
  const uint32_t materials[6] = {wall, wall, floor, wall, wall, wall};
  OLX_TRY(olx_add_room(scene, "hall", olx_v3(-4.0f, 0.0f, -4.0f), olx_v3(4.0f, 4.0f, 4.0f), materials));
  OLX_TRY(add_statue(scene, olx_v3(0.2f, 0.0f, -1.4f), statue));
  for (uint32_t i = 0; i < 4; i++) {
    const float x = i % 2 ? 2.1f : -2.1f, z = i / 2 ? -1.2f : -2.9f;
    OLX_TRY(olx_add_box(scene, "banner", olx_v3(x - 0.02f, 0.5f, z - 0.45f), olx_v3(x + 0.02f, 3.2f, z + 0.45f),
                        banners[(i + i / 2) % 2]));
  }
  OLX_TRY(olx_scene_add_rect_light(scene, olx_v3(0.0f, 1.5f, -3.6f), olx_v3(2.0f, 0.0f, 0.0f), olx_v3(0.0f, 2.0f, 0.0f),
                                   olx_v3(9.0f, 8.5f, 7.5f)));
  olx_set_probes(scene, olx_v3(-3.0f, 0.6f, -3.0f), olx_v3(3.0f, 3.2f, 3.0f), 4, 3, 4);
  return olx_add_view(scene, "front", olx_v3(-0.4f, 1.5f, 3.5f), olx_v3(0.0f, 1.0f, -2.0f), 50.0f);
}
