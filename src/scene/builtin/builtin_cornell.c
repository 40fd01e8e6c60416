// Builds the Cornell box with matte and with glossy blocks, and a furnace whose radiance is known in closed form.
#include "core/result.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/builtin_shapes.h"

#include <stdio.h>

// The Cornell box as measured (Cornell University Program of Computer Graphics, 1998), in millimetres.
typedef enum box_part {
  FLOOR,
  CEILING,
  BACK_WALL,
  RIGHT_WALL,
  LEFT_WALL,
  SHORT_BLOCK,
  TALL_BLOCK,
  PART_COUNT
} box_part;

typedef struct box_quad {
  box_part part;
  olx_vec3 corners[4];
} box_quad;

static const box_quad quads[] = {
    {FLOOR, {{552.8f, 0, 0}, {0, 0, 0}, {0, 0, 559.2f}, {549.6f, 0, 559.2f}}},
    {CEILING, {{556, 548.8f, 0}, {556, 548.8f, 559.2f}, {0, 548.8f, 559.2f}, {0, 548.8f, 0}}},
    {BACK_WALL, {{549.6f, 0, 559.2f}, {0, 0, 559.2f}, {0, 548.8f, 559.2f}, {556, 548.8f, 559.2f}}},
    {RIGHT_WALL, {{0, 0, 559.2f}, {0, 0, 0}, {0, 548.8f, 0}, {0, 548.8f, 559.2f}}},
    {LEFT_WALL, {{552.8f, 0, 0}, {549.6f, 0, 559.2f}, {556, 548.8f, 559.2f}, {556, 548.8f, 0}}},
    {SHORT_BLOCK, {{130, 165, 65}, {82, 165, 225}, {240, 165, 272}, {290, 165, 114}}},
    {SHORT_BLOCK, {{290, 0, 114}, {290, 165, 114}, {240, 165, 272}, {240, 0, 272}}},
    {SHORT_BLOCK, {{130, 0, 65}, {130, 165, 65}, {290, 165, 114}, {290, 0, 114}}},
    {SHORT_BLOCK, {{82, 0, 225}, {82, 165, 225}, {130, 165, 65}, {130, 0, 65}}},
    {SHORT_BLOCK, {{240, 0, 272}, {240, 165, 272}, {82, 165, 225}, {82, 0, 225}}},
    {TALL_BLOCK, {{423, 330, 247}, {265, 330, 296}, {314, 330, 456}, {472, 330, 406}}},
    {TALL_BLOCK, {{423, 0, 247}, {423, 330, 247}, {472, 330, 406}, {472, 0, 406}}},
    {TALL_BLOCK, {{472, 0, 406}, {472, 330, 406}, {314, 330, 456}, {314, 0, 456}}},
    {TALL_BLOCK, {{314, 0, 456}, {314, 330, 456}, {265, 330, 296}, {265, 0, 296}}},
    {TALL_BLOCK, {{265, 0, 296}, {265, 330, 296}, {423, 330, 247}, {423, 0, 247}}},
};

static olx_result build_box(olx_scene *scene, const uint32_t materials[PART_COUNT]) {
  for (size_t i = 0; i < sizeof quads / sizeof *quads; i++) {
    olx_vec3 corners[4];
    for (uint32_t k = 0; k < 4; k++) {
      const olx_vec3 p = quads[i].corners[k];
      corners[k] = olx_v3(p.x / 1000.0f, p.y / 1000.0f, p.z / 1000.0f);
    }
    OLX_TRY(olx_add_quad(scene, "Cornell box", corners, materials[quads[i].part]));
  }
  // As measured, except that it is 0.8 mm below the ceiling instead of in its plane.
  const olx_vec3 center = {0.278f, 0.548f, 0.2795f};
  OLX_TRY(olx_scene_add_rect_light(scene, center, olx_v3(0.130f, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, 0.105f),
                                   olx_v3(17.0f, 12.0f, 4.0f)));
  olx_set_probes(scene, olx_v3(0.08f, 0.08f, 0.08f), olx_v3(0.47f, 0.47f, 0.48f), 2, 2, 2);
  return olx_add_view(scene, "front", olx_v3(0.278f, 0.273f, -0.8f), olx_v3(0.278f, 0.273f, 0.0f), 39.3077f);
}

static olx_result add_walls(olx_scene *scene, uint32_t materials[PART_COUNT]) {
  OLX_TRY(olx_add_matte(scene, "white", olx_v3(0.725f, 0.71f, 0.68f), &materials[CEILING]));
  OLX_TRY(olx_add_matte(scene, "green", olx_v3(0.14f, 0.45f, 0.091f), &materials[RIGHT_WALL]));
  OLX_TRY(olx_add_matte(scene, "red", olx_v3(0.63f, 0.065f, 0.05f), &materials[LEFT_WALL]));
  materials[FLOOR] = materials[BACK_WALL] = materials[SHORT_BLOCK] = materials[TALL_BLOCK] = materials[CEILING];
  return OLX_OK;
}

olx_result olx_build_cornell(olx_scene *scene) {
  uint32_t materials[PART_COUNT];
  OLX_TRY(add_walls(scene, materials));
  return build_box(scene, materials);
}

olx_result olx_build_cornell_glossy(olx_scene *scene) {
  uint32_t materials[PART_COUNT];
  OLX_TRY(add_walls(scene, materials));
  const olx_vec3 white = {0.725f, 0.71f, 0.68f};
  OLX_TRY(olx_add_glossy(scene, "polished floor", white, 0.0f, 0.2f, &materials[FLOOR]));
  OLX_TRY(olx_add_glossy(scene, "glazed block", white, 0.0f, 0.3f, &materials[SHORT_BLOCK]));
  OLX_TRY(olx_add_glossy(scene, "metal block", olx_v3(0.91f, 0.86f, 0.78f), 1.0f, 0.2f, &materials[TALL_BLOCK]));
  return build_box(scene, materials);
}

// Every surface emits 1 and reflects one half, so that the radiance is 1 / (1 - 1/2) = 2 everywhere.
olx_result olx_build_furnace(olx_scene *scene) {
  olx_material glowing = olx_material_default();
  snprintf(glowing.name, sizeof glowing.name, "glowing");
  glowing.base_color = olx_splat(0.5f);
  glowing.emission = olx_splat(1.0f);
  uint32_t material = 0;
  OLX_TRY(olx_scene_add_material(scene, &glowing, &material));
  const uint32_t materials[6] = {material, material, material, material, material, material};
  OLX_TRY(olx_add_room(scene, "room", olx_splat(-1.0f), olx_splat(1.0f), materials));
  OLX_TRY(olx_add_box(scene, "block", olx_v3(-0.3f, -0.4f, -0.2f), olx_v3(0.3f, 0.4f, 0.2f), material));
  olx_set_probes(scene, olx_splat(-0.6f), olx_splat(0.6f), 2, 2, 2);
  return olx_add_view(scene, "corner", olx_v3(0.8f, 0.5f, 0.9f), olx_splat(0.0f), 60.0f);
}
