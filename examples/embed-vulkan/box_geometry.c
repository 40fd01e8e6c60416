// Makes the Cornell box of builtin:cornell-glossy as a host would store it in its own vertex buffer: triangles with
// normals, colours and materials.
#include "box_geometry.h"

#include <math.h>

typedef struct box_material {
  olx_vec3 base_color, material, emission;
} box_material;

enum { WHITE, GREEN, RED, FLOOR, GLAZED, METAL, LIGHT };

static const box_material materials[] = {
    [WHITE] = {.base_color = {0.725f, 0.71f, 0.68f}, .material = {1.0f, 0.0f, 0.0f}},
    [GREEN] = {.base_color = {0.14f, 0.45f, 0.091f}, .material = {1.0f, 0.0f, 0.0f}},
    [RED] = {.base_color = {0.63f, 0.065f, 0.05f}, .material = {1.0f, 0.0f, 0.0f}},
    [FLOOR] = {.base_color = {0.725f, 0.71f, 0.68f}, .material = {0.2f, 0.0f, 1.0f}},
    [GLAZED] = {.base_color = {0.725f, 0.71f, 0.68f}, .material = {0.3f, 0.0f, 1.0f}},
    [METAL] = {.base_color = {0.91f, 0.86f, 0.78f}, .material = {0.2f, 1.0f, 1.0f}},
    [LIGHT] = {.material = {1.0f, 0.0f, 0.0f}, .emission = {17.0f, 12.0f, 4.0f}},
};

// Quads counter-clockwise as seen from the front, in millimetres. The light is the last one; surface.frag contains its
// position.
static const struct {
  int material;
  float corners[4][3];
} quads[BOX_QUADS] = {
    {FLOOR, {{552.8f, 0, 0}, {0, 0, 0}, {0, 0, 559.2f}, {549.6f, 0, 559.2f}}},
    {WHITE, {{556, 548.8f, 0}, {556, 548.8f, 559.2f}, {0, 548.8f, 559.2f}, {0, 548.8f, 0}}},
    {WHITE, {{549.6f, 0, 559.2f}, {0, 0, 559.2f}, {0, 548.8f, 559.2f}, {556, 548.8f, 559.2f}}},
    {GREEN, {{0, 0, 559.2f}, {0, 0, 0}, {0, 548.8f, 0}, {0, 548.8f, 559.2f}}},
    {RED, {{552.8f, 0, 0}, {549.6f, 0, 559.2f}, {556, 548.8f, 559.2f}, {556, 548.8f, 0}}},
    {GLAZED, {{130, 165, 65}, {82, 165, 225}, {240, 165, 272}, {290, 165, 114}}},
    {GLAZED, {{290, 0, 114}, {290, 165, 114}, {240, 165, 272}, {240, 0, 272}}},
    {GLAZED, {{130, 0, 65}, {130, 165, 65}, {290, 165, 114}, {290, 0, 114}}},
    {GLAZED, {{82, 0, 225}, {82, 165, 225}, {130, 165, 65}, {130, 0, 65}}},
    {GLAZED, {{240, 0, 272}, {240, 165, 272}, {82, 165, 225}, {82, 0, 225}}},
    {METAL, {{423, 330, 247}, {265, 330, 296}, {314, 330, 456}, {472, 330, 406}}},
    {METAL, {{423, 0, 247}, {423, 330, 247}, {472, 330, 406}, {472, 0, 406}}},
    {METAL, {{472, 0, 406}, {472, 330, 406}, {314, 330, 456}, {314, 0, 456}}},
    {METAL, {{314, 0, 456}, {314, 330, 456}, {265, 330, 296}, {265, 0, 296}}},
    {METAL, {{265, 0, 296}, {265, 330, 296}, {423, 330, 247}, {423, 0, 247}}},
    {LIGHT, {{213, 548, 227}, {343, 548, 227}, {343, 548, 332}, {213, 548, 332}}},
};

static olx_vec3 metres(const float corner[3]) {
  return (olx_vec3){corner[0] / 1000.0f, corner[1] / 1000.0f, corner[2] / 1000.0f};
}

static olx_vec3 triangle_normal(olx_vec3 a, olx_vec3 b, olx_vec3 c) {
  const olx_vec3 u = {b.x - a.x, b.y - a.y, b.z - a.z}, v = {c.x - a.x, c.y - a.y, c.z - a.z};
  const olx_vec3 n = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  const float length = sqrtf(n.x * n.x + n.y * n.y + n.z * n.z);
  return (olx_vec3){n.x / length, n.y / length, n.z / length};
}

void box_geometry(box_vertex vertices[BOX_VERTICES], uint32_t indices[BOX_INDICES]) {
  static const uint32_t corners_of_quad[6] = {0, 1, 2, 0, 2, 3};
  for (uint32_t q = 0; q < BOX_QUADS; q++) {
    const box_material *m = &materials[quads[q].material];
    const olx_vec3 normal =
        triangle_normal(metres(quads[q].corners[0]), metres(quads[q].corners[1]), metres(quads[q].corners[2]));
    for (uint32_t k = 0; k < 4; k++) {
      vertices[4 * q + k] = (box_vertex){metres(quads[q].corners[k]), normal, m->base_color, m->material, m->emission};
    }
    for (uint32_t k = 0; k < 6; k++) indices[6 * q + k] = 4 * q + corners_of_quad[k];
  }
}
