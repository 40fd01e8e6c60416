// Builds the furniture of the built-in flat: pieces assembled from boxes, cushions and turned shapes, each placed and
// rotated as a whole.
#include "scene/builtin/builtin_furniture.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/builtin/builtin_shapes.h"

static olx_vec3 turned(const olx_stand *stand, olx_vec3 v) {
  const float c = cosf(stand->turn), s = sinf(stand->turn);
  return olx_v3(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
}

static olx_vec3 placed(const olx_stand *stand, olx_vec3 p) { return olx_add(stand->at, turned(stand, p)); }

olx_result olx_add_solid(const olx_stand *stand, const char *name, olx_vec3 low, olx_vec3 high, uint32_t material) {
  // Bits 0, 1 and 2 of a corner's index are x, y and z. Faces are seen from outside.
  static const uint8_t faces[6][4] = {{6, 2, 0, 4}, {3, 7, 5, 1}, {1, 5, 4, 0},
                                      {6, 7, 3, 2}, {2, 3, 1, 0}, {7, 6, 4, 5}};
  for (uint32_t f = 0; f < 6; f++) {
    olx_vec3 corners[4];
    for (uint32_t k = 0; k < 4; k++) {
      const uint8_t c = faces[f][k];
      corners[k] = placed(stand, olx_v3(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z));
    }
    OLX_TRY(olx_add_quad(stand->scene, name, corners, material));
  }
  return OLX_OK;
}

// A cushion's mesh is that of a ball, divided into eight parts that are moved to the corners of the box.
enum { AROUND = 16, RINGS = 8, CUSHION_POINTS = AROUND * RINGS + 2, CUSHION_TRIANGLES = 2 * AROUND * RINGS };

typedef struct cushion_mesh {
  olx_vec3 positions[CUSHION_POINTS], normals[CUSHION_POINTS];
  uint32_t indices[3 * CUSHION_TRIANGLES], count;
} cushion_mesh;

static void add_triangle(cushion_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
  mesh->indices[mesh->count++] = a;
  mesh->indices[mesh->count++] = b;
  mesh->indices[mesh->count++] = c;
}

// No point of the ball lies on a plane between two of its parts.
static olx_vec3 ball_normal(uint32_t ring, uint32_t i) {
  const float phi = 2.0f * OLX_PI * ((float)i + 0.5f) / AROUND, theta = OLX_PI * (((float)ring + 0.5f) / RINGS - 0.5f);
  return olx_v3(cosf(phi) * cosf(theta), sinf(theta), sinf(phi) * cosf(theta));
}

static void connect_cushion(cushion_mesh *mesh) {
  const uint32_t bottom = AROUND * RINGS, top = bottom + 1, last = AROUND * (RINGS - 1);
  for (uint32_t i = 0; i < AROUND; i++) {
    const uint32_t next = (i + 1) % AROUND;
    add_triangle(mesh, bottom, i, next);
    add_triangle(mesh, top, last + next, last + i);
    for (uint32_t ring = 0; ring + 1 < RINGS; ring++) {
      const uint32_t a = ring * AROUND + i, b = ring * AROUND + next;
      add_triangle(mesh, a, a + AROUND, b);
      add_triangle(mesh, b, a + AROUND, b + AROUND);
    }
  }
}

static void shape_cushion(const olx_stand *stand, olx_vec3 low, olx_vec3 high, float radius, cushion_mesh *mesh) {
  const olx_vec3 middle = olx_scale(olx_add(low, high), 0.5f), half = olx_scale(olx_sub(high, low), 0.5f);
  const olx_vec3 core = olx_sub(half, olx_splat(radius));
  for (uint32_t k = 0; k < AROUND * RINGS; k++) {
    const olx_vec3 n = ball_normal(k / AROUND, k % AROUND);
    const olx_vec3 part = olx_v3(copysignf(core.x, n.x), copysignf(core.y, n.y), copysignf(core.z, n.z));
    mesh->positions[k] = placed(stand, olx_add(middle, olx_madd(part, n, radius)));
    mesh->normals[k] = turned(stand, n);
  }
  for (uint32_t end = 0; end < 2; end++) {
    const olx_vec3 n = olx_v3(0.0f, end ? 1.0f : -1.0f, 0.0f);
    mesh->positions[AROUND * RINGS + end] = placed(stand, olx_madd(middle, n, half.y));
    mesh->normals[AROUND * RINGS + end] = n;
  }
}

olx_result olx_add_cushion(const olx_stand *stand, const char *name, olx_vec3 low, olx_vec3 high, float radius,
                           uint32_t material) {
  cushion_mesh mesh = {.count = 0};
  shape_cushion(stand, low, high, radius, &mesh);
  connect_cushion(&mesh);
  return olx_scene_add_mesh(stand->scene, name, mesh.positions, mesh.normals, NULL, CUSHION_POINTS, mesh.indices,
                            mesh.count / 3, material);
}

olx_result olx_add_sofa(const olx_stand *stand, float width, uint32_t places, uint32_t cloth, uint32_t wood) {
  const float half = 0.5f * width, arm = 0.2f, depth = 0.86f, back = -0.5f * depth, front = 0.5f * depth;
  const float inner = half - arm, place = 2.0f * inner / (float)places;
  OLX_TRY(olx_add_cushion(stand, "sofa", olx_v3(-half, 0.1f, back), olx_v3(half, 0.32f, front), 0.03f, cloth));
  OLX_TRY(olx_add_cushion(stand, "sofa", olx_v3(-half, 0.3f, back), olx_v3(half, 0.8f, back + 0.18f), 0.07f, cloth));
  for (uint32_t side = 0; side < 2; side++) {
    const float x = side ? inner : -half;
    OLX_TRY(olx_add_cushion(stand, "sofa", olx_v3(x, 0.28f, back + 0.04f), olx_v3(x + arm, 0.6f, front), 0.07f, cloth));
    for (uint32_t end = 0; end < 2; end++) {
      const olx_vec3 foot = {side ? half - 0.1f : -half + 0.05f, 0.0f, end ? front - 0.1f : back + 0.05f};
      OLX_TRY(olx_add_solid(stand, "sofa foot", foot, olx_add(foot, olx_v3(0.05f, 0.12f, 0.05f)), wood));
    }
  }
  for (uint32_t i = 0; i < places; i++) {
    const float x = -inner + place * (float)i, gap = 0.006f;
    OLX_TRY(olx_add_cushion(stand, "sofa cushion", olx_v3(x + gap, 0.3f, back + 0.15f),
                            olx_v3(x + place - gap, 0.46f, front - 0.01f), 0.06f, cloth));
    OLX_TRY(olx_add_cushion(stand, "sofa cushion", olx_v3(x + gap, 0.44f, back + 0.14f),
                            olx_v3(x + place - gap, 0.86f, back + 0.34f), 0.08f, cloth));
  }
  return OLX_OK;
}

// Adds four legs under the corners of a rectangle.
static olx_result add_legs(const olx_stand *stand, const char *name, olx_vec2 half, float height, float thick,
                           uint32_t material) {
  for (uint32_t i = 0; i < 4; i++) {
    const olx_vec3 low = {i & 1 ? half.x - thick : -half.x, 0.0f, i & 2 ? half.y - thick : -half.y};
    OLX_TRY(olx_add_solid(stand, name, low, olx_add(low, olx_v3(thick, height, thick)), material));
  }
  return OLX_OK;
}

olx_result olx_add_table(const olx_stand *stand, olx_vec3 size, uint32_t top, uint32_t legs) {
  const olx_vec2 half = {0.5f * size.x, 0.5f * size.z};
  const float thick = 0.035f;
  OLX_TRY(olx_add_cushion(stand, "table", olx_v3(-half.x, size.y - thick, -half.y), olx_v3(half.x, size.y, half.y),
                          0.008f, top));
  return add_legs(stand, "table leg", (olx_vec2){half.x - 0.05f, half.y - 0.05f}, size.y - thick, 0.045f, legs);
}

olx_result olx_add_chair(const olx_stand *stand, uint32_t wood) {
  const float half = 0.21f, seat = 0.45f;
  OLX_TRY(olx_add_cushion(stand, "chair", olx_v3(-half, seat - 0.03f, -half), olx_v3(half, seat, half), 0.01f, wood));
  OLX_TRY(add_legs(stand, "chair leg", (olx_vec2){half - 0.01f, half - 0.01f}, seat - 0.03f, 0.035f, wood));
  for (uint32_t side = 0; side < 2; side++) {
    const float x = side ? half - 0.045f : -half + 0.01f;
    OLX_TRY(olx_add_solid(stand, "chair back", olx_v3(x, seat, -half + 0.01f), olx_v3(x + 0.035f, 0.9f, -half + 0.035f),
                          wood));
  }
  for (uint32_t bar = 0; bar < 3; bar++) {
    const float y = 0.58f + 0.12f * (float)bar;
    OLX_TRY(olx_add_solid(stand, "chair back", olx_v3(-half + 0.045f, y, -half + 0.015f),
                          olx_v3(half - 0.045f, y + 0.06f, -half + 0.03f), wood));
  }
  return OLX_OK;
}

// Adds a row of books from x = left to x = right on y = floor, none higher than `most`.
static olx_result add_books(const olx_stand *stand, float left, float right, float floor, float most, float depth,
                            const uint32_t *covers, uint32_t cover_count, uint32_t seed) {
  float x = left;
  for (uint32_t i = 0;; i++) {
    const uint32_t bits = olx_hash2(seed, i);
    const float thick = 0.018f + 0.03f * olx_unit_float(bits),
                high = most * (0.68f + 0.3f * olx_unit_float(olx_hash(bits)));
    if (x + thick > right) return OLX_OK;
    // Gaps are left at random.
    if (bits % 9 != 0) {
      OLX_TRY(olx_add_solid(stand, "book", olx_v3(x, floor, -0.5f * depth + 0.02f),
                            olx_v3(x + thick - 0.002f, floor + high, -0.5f * depth + 0.02f + 0.75f * depth),
                            covers[olx_hash(bits + 1) % cover_count]));
    }
    x += thick;
  }
}

olx_result olx_add_bookcase(const olx_stand *stand, olx_vec3 size, uint32_t shelves, uint32_t wood,
                            const uint32_t *covers, uint32_t cover_count, uint32_t seed) {
  const float board = 0.025f, half = 0.5f * size.x, back = -0.5f * size.z, front = 0.5f * size.z;
  const float step = (size.y - board) / (float)shelves;
  OLX_TRY(olx_add_solid(stand, "bookcase", olx_v3(-half, 0.0f, back), olx_v3(half, size.y, back + 0.012f), wood));
  for (uint32_t side = 0; side < 2; side++) {
    const float x = side ? half - board : -half;
    OLX_TRY(olx_add_solid(stand, "bookcase", olx_v3(x, 0.0f, back + 0.012f), olx_v3(x + board, size.y, front), wood));
  }
  for (uint32_t i = 0; i <= shelves; i++) {
    const float y = step * (float)i;
    OLX_TRY(olx_add_solid(stand, "bookcase", olx_v3(-half + board, y, back + 0.012f),
                          olx_v3(half - board, y + board, front), wood));
    if (i == shelves) break;
    OLX_TRY(add_books(stand, -half + board, half - board, y + board, step - board - 0.03f, size.z, covers, cover_count,
                      olx_hash2(seed, i)));
  }
  return OLX_OK;
}

olx_result olx_add_picture(const olx_stand *stand, olx_vec2 size, uint32_t frame, const uint32_t fields[3]) {
  const float half = 0.5f * size.x, high = 0.5f * size.y, bar = 0.03f, deep = 0.025f, split = 0.3f * size.x;
  for (uint32_t side = 0; side < 2; side++) {
    const float x = side ? half - bar : -half, y = side ? high - bar : -high;
    OLX_TRY(olx_add_solid(stand, "frame", olx_v3(x, -high, 0.0f), olx_v3(x + bar, high, deep), frame));
    OLX_TRY(olx_add_solid(stand, "frame", olx_v3(-half + bar, y, 0.0f), olx_v3(half - bar, y + bar, deep), frame));
  }
  const float left = -half + bar, right = half - bar, low = -high + bar, top = high - bar, canvas = 0.012f;
  OLX_TRY(olx_add_solid(stand, "picture", olx_v3(left, low, 0.0f), olx_v3(left + split, top, canvas), fields[0]));
  OLX_TRY(
      olx_add_solid(stand, "picture", olx_v3(left + split, low, 0.0f), olx_v3(right, 0.1f * high, canvas), fields[1]));
  return olx_add_solid(stand, "picture", olx_v3(left + split, 0.1f * high, 0.0f), olx_v3(right, top, canvas),
                       fields[2]);
}

olx_result olx_add_floor_lamp(const olx_stand *stand, uint32_t metal, uint32_t shade, olx_vec3 intensity) {
  const olx_vec2 pole[] = {{0.15f, 0.0f}, {0.15f, 0.02f}, {0.012f, 0.035f}, {0.012f, 1.4f}, {0.0f, 1.4f}};
  // The shade is a sheet that is visible from both sides.
  const olx_vec2 cone[] = {{0.2f, 1.3f}, {0.13f, 1.6f}};
  OLX_TRY(olx_add_lathe(stand->scene, "floor lamp", stand->at, pole, 5, 24, metal));
  OLX_TRY(olx_add_lathe(stand->scene, "lamp shade", stand->at, cone, 2, 32, shade));
  const olx_light light = {
      .type = OLX_LIGHT_POINT, .position = placed(stand, olx_v3(0.0f, 1.46f, 0.0f)), .emission = intensity};
  return olx_scene_add_light(stand->scene, &light);
}

// Adds a leaf, a strip that bends outwards and down and is broad in the middle.
static olx_result add_leaf(const olx_stand *stand, float base, float height, float reach, float angle,
                           uint32_t material) {
  enum { STEPS = 8 };
  olx_vec3 positions[2 * STEPS + 2];
  uint32_t indices[6 * STEPS];
  const olx_vec3 out = {cosf(angle), 0.0f, sinf(angle)}, across = {-sinf(angle), 0.0f, cosf(angle)};
  for (uint32_t i = 0; i <= STEPS; i++) {
    const float t = (float)i / STEPS, broad = 0.045f * sinf(OLX_PI * (0.1f + 0.9f * t)) + 0.002f;
    const olx_vec3 middle =
        olx_madd(olx_v3(0.0f, base + height * (1.6f * t - 0.75f * t * t), 0.0f), out, reach * t * t);
    positions[2 * i] = placed(stand, olx_madd(middle, across, -broad));
    positions[2 * i + 1] = placed(stand, olx_madd(middle, across, broad));
    if (i == STEPS) break;
    const uint32_t faces[6] = {2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 1, 2 * i + 2, 2 * i + 3};
    for (uint32_t k = 0; k < 6; k++) indices[6 * i + k] = faces[k];
  }
  return olx_scene_add_mesh(stand->scene, "leaf", positions, NULL, NULL, 2 * STEPS + 2, indices, 2 * STEPS, material);
}

olx_result olx_add_plant(const olx_stand *stand, float height, uint32_t pot, uint32_t leaf) {
  enum { LEAVES = 17 };
  const olx_vec2 profile[] = {{0.11f, 0.0f}, {0.17f, 0.32f}, {0.15f, 0.32f}, {0.14f, 0.27f}, {0.0f, 0.27f}};
  OLX_TRY(olx_add_lathe(stand->scene, "pot", stand->at, profile, 5, 32, pot));
  for (uint32_t i = 0; i < LEAVES; i++) {
    // Leaves are a golden angle apart, and outer leaves are lower.
    const float angle = 2.4f * (float)i, share = (float)(i + 1) / LEAVES;
    OLX_TRY(add_leaf(stand, 0.27f, (height - 0.27f) * (1.1f - 0.55f * share), 0.08f + 0.45f * share, angle, leaf));
  }
  return OLX_OK;
}
