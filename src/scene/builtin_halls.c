#include "core/result.h"
#include "scene/builtin_scenes.h"
#include "scene/builtin_shapes.h"

// One probe sees all of a star-shaped hall (McGuire et al. Fig. 17).
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
                          .plane = OLX_PLANE_XZ,
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

// Pedestal, robe, shoulders and head.
static olx_result add_statue(olx_scene *scene, olx_vec3 base, uint32_t material) {
  olx_vec2 profile[24] = {{0.42f, 0.0f}, {0.42f, 0.12f}, {0.34f, 0.12f}, {0.34f, 0.45f}, {0.4f, 0.45f},
                          {0.4f, 0.52f}, {0.3f, 0.52f},  {0.24f, 0.9f},  {0.2f, 1.15f},  {0.27f, 1.4f},
                          {0.22f, 1.5f}, {0.09f, 1.56f}, {0.09f, 1.62f}};
  uint32_t points = 13;
  const float radius = 0.16f, center = 1.75f;
  for (uint32_t i = 0; i <= 8; i++) {
    // From where the neck meets the sphere of the head up to its top.
    const float from = -0.97f, angle = from + (0.5f * OLX_PI - from) * (float)i / 8.0f;
    profile[points++] = (olx_vec2){i == 8 ? 0.0f : radius * cosf(angle), center + radius * sinf(angle)};
  }
  return olx_add_lathe(scene, "statue", base, profile, points, 40, material);
}

// The only light is an emissive square; a statue before it, banners beside it, a glossy floor (McGuire et al. Fig. 14).
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

// A polygon given for the right half (x > 0), or its mirror image; the winding follows.
static olx_result add_half(olx_scene *scene, bool mirrored, const olx_vec3 *corners, uint32_t count,
                           uint32_t material) {
  static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  olx_vec3 placed[4];
  for (uint32_t k = 0; k < count; k++) {
    const olx_vec3 p = corners[mirrored ? count - 1 - k : k];
    placed[k] = olx_v3(mirrored ? -p.x : p.x, p.y, p.z);
  }
  return olx_scene_add_mesh(scene, "foundation", placed, NULL, NULL, count, indices, count - 2, material);
}

// What closes the solid under a rising profile from below, behind and at its ends, so that its inside is one.
static olx_result add_foundation(olx_scene *scene, bool mirrored, const olx_vec2 *profile, uint32_t points,
                                 float half_length, uint32_t material) {
  const float near = profile[0].x, far = profile[points - 1].x, top = profile[points - 1].y, h = half_length;
  const olx_vec3 below[4] = {{near, 0.0f, -h}, {far, 0.0f, -h}, {far, 0.0f, h}, {near, 0.0f, h}};
  const olx_vec3 behind[4] = {{far, 0.0f, -h}, {far, top, -h}, {far, top, h}, {far, 0.0f, h}};
  OLX_TRY(add_half(scene, mirrored, below, 4, material));
  OLX_TRY(add_half(scene, mirrored, behind, 4, material));
  for (uint32_t i = 0; i + 1 < points; i++) {
    const olx_vec2 a = profile[i], b = profile[i + 1];
    const olx_vec3 front[3] = {{far, 0.0f, h}, {b.x, b.y, h}, {a.x, a.y, h}};
    const olx_vec3 back[3] = {{far, 0.0f, -h}, {a.x, a.y, -h}, {b.x, b.y, -h}};
    OLX_TRY(add_half(scene, mirrored, front, 3, material));
    OLX_TRY(add_half(scene, mirrored, back, 3, material));
  }
  return OLX_OK;
}

// A corridor between two rows of round pillars; stairs on both sides lead to terraces (Wang's temple, Fig. 1.1). The
// lowest outer probes of a regular grid are inside the terraces.
olx_result olx_build_temple(olx_scene *scene) {
  enum { STEPS = 8, SIDE_POINTS = 2 * STEPS + 3, POINTS = 2 * SIDE_POINTS };
  uint32_t stone, floor, plaster, pillar, walls[POINTS];
  OLX_TRY(olx_add_matte(scene, "stone", olx_v3(0.6f, 0.55f, 0.47f), &stone));
  OLX_TRY(olx_add_glossy(scene, "marble floor", olx_v3(0.5f, 0.48f, 0.45f), 0.0f, 0.25f, &floor));
  OLX_TRY(olx_add_matte(scene, "plaster", olx_v3(0.7f, 0.66f, 0.6f), &plaster));
  OLX_TRY(olx_add_matte(scene, "painted pillar", olx_v3(0.6f, 0.22f, 0.16f), &pillar));
  const float near = 2.0f, tread = 0.3f, rise = 0.18f, wall = 7.0f, height = 5.0f, half_length = 9.0f;
  // The right half of the section from the corridor's floor over steps and terrace up to the ceiling; the left one
  // mirrored.
  olx_vec2 outline[POINTS], half[SIDE_POINTS];
  for (uint32_t i = 0; i < SIDE_POINTS; i++) {
    const uint32_t step = i / 2;
    olx_vec2 p = {near + tread * (float)step, rise * (float)(step + i % 2)};
    if (i >= 2 * STEPS) p = (olx_vec2){i == 2 * STEPS ? p.x : wall, i == 2 * STEPS + 2 ? height : rise * STEPS};
    half[i] = outline[SIDE_POINTS - 1 - i] = p;
    outline[SIDE_POINTS + i] = (olx_vec2){-p.x, p.y};
  }
  for (uint32_t i = 0; i < POINTS; i++) walls[i] = stone;
  walls[SIDE_POINTS - 1] = floor;
  walls[0] = walls[POINTS - 2] = walls[POINTS - 1] = plaster;
  const olx_prism hall = {.outline = outline,
                          .points = POINTS,
                          .center = {0.0f, 4.0f},
                          .plane = OLX_PLANE_XY,
                          .low = -half_length,
                          .high = half_length,
                          .low_material = plaster,
                          .high_material = plaster,
                          .side_materials = walls};
  OLX_TRY(olx_add_prism(scene, "temple", &hall));
  OLX_TRY(add_foundation(scene, false, half, SIDE_POINTS - 1, half_length, stone));
  OLX_TRY(add_foundation(scene, true, half, SIDE_POINTS - 1, half_length, stone));
  for (uint32_t i = 0; i < 10; i++) {
    const olx_vec3 base = {i % 2 ? 1.5f : -1.5f, 0.0f, -6.4f + 3.2f * (float)(i / 2)};
    const olx_vec2 profile[] = {{0.45f, 0.0f}, {0.45f, 0.3f}, {0.32f, 0.3f},
                                {0.28f, 4.6f}, {0.45f, 4.6f}, {0.45f, height}};
    OLX_TRY(olx_add_lathe(scene, "pillar", base, profile, 6, 32, pillar));
  }
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(5.4f, 4.98f, -4.0f), 1.4f, olx_v3(30.0f, 27.0f, 22.0f)));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(-5.4f, 4.98f, 5.0f), 1.4f, olx_v3(18.0f, 20.0f, 24.0f)));
  olx_set_probes(scene, olx_v3(-5.6f, 0.9f, -8.0f), olx_v3(5.6f, 4.3f, 8.0f), 5, 3, 5);
  OLX_TRY(olx_add_view(scene, "corridor", olx_v3(0.2f, 1.7f, 8.6f), olx_v3(0.0f, 1.5f, 0.0f), 65.0f));
  return olx_add_view(scene, "terrace", olx_v3(-6.2f, 3.2f, 7.0f), olx_v3(1.5f, 1.0f, -2.5f), 65.0f);
}
