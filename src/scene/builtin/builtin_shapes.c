// Adds the simple meshes of built-in scenes, such as blocks, surfaces of revolution, prisms and cloth, with their
// materials, lights and cameras.
#include "scene/builtin/builtin_shapes.h"

#include "core/hooks.h"
#include "core/result.h"

#include <stdio.h>

olx_result olx_add_glossy(olx_scene *scene, const char *name, olx_vec3 base_color, float metallic, float roughness,
                          uint32_t *material) {
  olx_material made = olx_material_default();
  snprintf(made.name, sizeof made.name, "%s", name);
  made.base_color = base_color;
  made.metallic = metallic;
  made.roughness = roughness;
  made.specular_weight = 1.0f;
  return olx_scene_add_material(scene, &made, material);
}

olx_result olx_add_matte(olx_scene *scene, const char *name, olx_vec3 base_color, uint32_t *material) {
  olx_material made = olx_material_default();
  snprintf(made.name, sizeof made.name, "%s", name);
  made.base_color = base_color;
  return olx_scene_add_material(scene, &made, material);
}

olx_result olx_add_view(olx_scene *scene, const char *name, olx_vec3 eye, olx_vec3 target, float fov_y_degrees) {
  olx_camera camera = {.eye = eye, .target = target, .up = {0.0f, 1.0f, 0.0f}, .fov_y_degrees = fov_y_degrees};
  snprintf(camera.name, sizeof camera.name, "%s", name);
  return olx_scene_add_camera(scene, &camera);
}

void olx_set_probes(olx_scene *scene, olx_vec3 first, olx_vec3 last, uint32_t nx, uint32_t ny, uint32_t nz) {
  scene->has_probe_volume = true;
  scene->has_probe_count = true;
  scene->probes_min = first;
  scene->probes_max = last;
  scene->probes_count[0] = nx;
  scene->probes_count[1] = ny;
  scene->probes_count[2] = nz;
}

olx_result olx_add_ceiling_light(olx_scene *scene, olx_vec3 center, float side, olx_vec3 radiance) {
  return olx_scene_add_rect_light(scene, center, olx_v3(side, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, side), radiance);
}

olx_result olx_add_quad(olx_scene *scene, const char *name, const olx_vec3 corners[4], uint32_t material) {
  static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  return olx_scene_add_mesh(scene, name, corners, NULL, NULL, 4, indices, 2, material);
}

// Bits 0, 1 and 2 of a corner's index are x, y and z. Faces are seen from inside.
static const uint8_t box_faces[6][4] = {{4, 0, 2, 6}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                        {2, 3, 7, 6}, {0, 1, 3, 2}, {5, 4, 6, 7}};

static olx_result add_faces(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, bool from_inside,
                            const uint32_t materials[6]) {
  for (uint32_t f = 0; f < 6; f++) {
    if (materials[f] == OLX_NO_FACE) continue;
    olx_vec3 corners[4];
    for (uint32_t k = 0; k < 4; k++) {
      const uint8_t corner = box_faces[f][from_inside ? k : 3 - k];
      corners[k] = olx_v3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    }
    OLX_TRY(olx_add_quad(scene, name, corners, materials[f]));
  }
  return OLX_OK;
}

olx_result olx_add_block(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, uint32_t open,
                         uint32_t material) {
  uint32_t materials[6];
  for (uint32_t f = 0; f < 6; f++) materials[f] = open >> f & 1 ? OLX_NO_FACE : material;
  return add_faces(scene, name, low, high, false, materials);
}

olx_result olx_add_box(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, uint32_t material) {
  return olx_add_block(scene, name, low, high, 0, material);
}

olx_result olx_add_room(olx_scene *scene, const char *name, olx_vec3 low, olx_vec3 high, const uint32_t materials[6]) {
  return add_faces(scene, name, low, high, true, materials);
}

// Returns the unit normal, in (radius, height), of segment i of the profile.
static olx_vec2 segment_normal(const olx_vec2 *profile, uint32_t i) {
  const float dr = profile[i + 1].x - profile[i].x, dy = profile[i + 1].y - profile[i].y;
  const float inverse = 1.0f / sqrtf(dr * dr + dy * dy);
  return (olx_vec2){dy * inverse, -dr * inverse};
}

// Returns the normal of segment i at one of its ends, averaged with the neighbour's unless the corner is sharp.
static olx_vec2 end_normal(const olx_vec2 *profile, uint32_t points, uint32_t i, bool upper) {
  const olx_vec2 own = segment_normal(profile, i);
  if (upper ? i + 2 >= points : i == 0) return own;
  const olx_vec2 other = segment_normal(profile, upper ? i + 1 : i - 1);
  if (own.x * other.x + own.y * other.y < 0.7f) return own;
  return (olx_vec2){own.x + other.x, own.y + other.y};
}

// Adds the band of one segment, with two vertices (lower, upper) per spoke.
static olx_result add_band(olx_scene *scene, const char *name, olx_vec3 base, const olx_vec2 *profile, uint32_t points,
                           uint32_t i, uint32_t segments, uint32_t material) {
  olx_vec3 *positions = olx_allocate(2 * (size_t)segments, sizeof *positions);
  olx_vec3 *normals = olx_allocate(2 * (size_t)segments, sizeof *normals);
  uint32_t *indices = olx_allocate(6 * (size_t)segments, sizeof *indices), count = 0;
  olx_result result = OLX_OK;
  if (!positions || !normals || !indices) {
    result = olx_fail(OLX_ERROR_MEMORY, "out of memory for the scene");
    goto done;
  }
  for (uint32_t s = 0; s < segments; s++) {
    const float phi = 2.0f * OLX_PI * (float)s / (float)segments, c = cosf(phi), w = sinf(phi);
    const uint32_t low = 2 * s, high = low + 1, next_low = 2 * ((s + 1) % segments), next_high = next_low + 1;
    for (uint32_t end = 0; end < 2; end++) {
      const olx_vec2 p = profile[i + end], n = end_normal(profile, points, i, end == 1);
      positions[low + end] = olx_add(base, olx_v3(p.x * c, p.y, p.x * w));
      normals[low + end] = olx_normalize(olx_v3(n.x * c, n.y, n.x * w));
    }
    // A ring of radius 0 is a point, where one of the two triangles vanishes.
    if (profile[i].x > 0.0f) {
      indices[count++] = low;
      indices[count++] = high;
      indices[count++] = next_low;
    }
    if (profile[i + 1].x > 0.0f) {
      indices[count++] = next_low;
      indices[count++] = high;
      indices[count++] = next_high;
    }
  }
  result = olx_scene_add_mesh(scene, name, positions, normals, NULL, 2 * segments, indices, count / 3, material);
done:
  olx_release(positions);
  olx_release(normals);
  olx_release(indices);
  return result;
}

olx_result olx_add_lathe(olx_scene *scene, const char *name, olx_vec3 base, const olx_vec2 *profile, uint32_t points,
                         uint32_t segments, uint32_t material) {
  for (uint32_t i = 0; i + 1 < points; i++) {
    OLX_TRY(add_band(scene, name, base, profile, points, i, segments, material));
  }
  return OLX_OK;
}

olx_result olx_add_cylinder(olx_scene *scene, const char *name, olx_vec3 base, float radius, float height,
                            uint32_t material) {
  const olx_vec2 profile[3] = {{radius, 0.0f}, {radius, height}, {0.0f, height}};
  return olx_add_lathe(scene, name, base, profile, 3, 48, material);
}

olx_result olx_add_prism(olx_scene *scene, const char *name, const olx_prism *prism) {
  const float low = prism->low, high = prism->high;
  for (uint32_t i = 0; i < prism->points; i++) {
    const olx_vec2 here = prism->outline[i], next = prism->outline[(i + 1) % prism->points];
    const olx_vec3 side[4] = {olx_v3(here.x, low, here.y), olx_v3(next.x, low, next.y), olx_v3(next.x, high, next.y),
                              olx_v3(here.x, high, here.y)};
    const olx_vec3 caps[6] = {olx_v3(prism->center.x, low, prism->center.y),  side[1], side[0],
                              olx_v3(prism->center.x, high, prism->center.y), side[3], side[2]};
    static const uint32_t indices[3] = {0, 1, 2};
    OLX_TRY(olx_add_quad(scene, name, side, prism->side_materials[i]));
    OLX_TRY(olx_scene_add_mesh(scene, name, caps, NULL, NULL, 3, indices, 1, prism->low_material));
    OLX_TRY(olx_scene_add_mesh(scene, name, caps + 3, NULL, NULL, 3, indices, 1, prism->high_material));
  }
  return OLX_OK;
}

enum { CLOTH_COLUMNS = 28, CLOTH_ROWS = 10, CLOTH_POINTS = (CLOTH_COLUMNS + 1) * (CLOTH_ROWS + 1) };

// Finds the position of the sheet at (u, v), and its normal.
static void cloth_point(const olx_cloth *cloth, float u, float v, olx_vec3 *position, olx_vec3 *normal) {
  const float turns = 2.0f * OLX_PI * cloth->waves, lag = 1.5f, least = 0.4f;
  const float phase = turns * u + lag * v, depth = cloth->depth * (least + (1.0f - least) * v);
  const olx_vec3 out = olx_normalize(olx_cross(cloth->down, cloth->across));
  const float slope_u = depth * turns * cosf(phase);
  const float slope_v = depth * lag * cosf(phase) + cloth->depth * (1.0f - least) * sinf(phase);
  const olx_vec3 flat = olx_madd(olx_madd(cloth->top, cloth->across, u), cloth->down, v);
  *position = olx_madd(flat, out, depth * sinf(phase));
  *normal = olx_normalize(olx_cross(olx_madd(cloth->down, out, slope_v), olx_madd(cloth->across, out, slope_u)));
}

olx_result olx_add_cloth(olx_scene *scene, const char *name, const olx_cloth *cloth, uint32_t material) {
  olx_vec3 positions[CLOTH_POINTS], normals[CLOTH_POINTS];
  uint32_t indices[6 * CLOTH_COLUMNS * CLOTH_ROWS], count = 0;
  for (uint32_t row = 0; row <= CLOTH_ROWS; row++) {
    for (uint32_t column = 0; column <= CLOTH_COLUMNS; column++) {
      const uint32_t i = row * (CLOTH_COLUMNS + 1) + column, below = i + CLOTH_COLUMNS + 1;
      cloth_point(cloth, (float)column / CLOTH_COLUMNS, (float)row / CLOTH_ROWS, &positions[i], &normals[i]);
      if (row == CLOTH_ROWS || column == CLOTH_COLUMNS) continue;
      const uint32_t faces[6] = {i, below, below + 1, i, below + 1, i + 1};
      for (uint32_t k = 0; k < 6; k++) indices[count++] = faces[k];
    }
  }
  return olx_scene_add_mesh(scene, name, positions, normals, NULL, CLOTH_POINTS, indices, count / 3, material);
}

static bool is_open(const olx_plan *plan, int64_t column, int64_t row) {
  if (column < 0 || row < 0 || column >= plan->columns || row >= plan->rows) return false;
  return plan->cells[row][column] == '.';
}

static olx_result add_cell(olx_scene *scene, const char *name, const olx_plan *p, uint32_t column, uint32_t row) {
  const float x0 = p->x[column], x1 = p->x[column + 1], z0 = p->z[row], z1 = p->z[row + 1];
  const float low = p->floor, high = p->ceiling;
  const olx_vec3 floor[4] = {{x0, low, z0}, {x0, low, z1}, {x1, low, z1}, {x1, low, z0}};
  const olx_vec3 ceiling[4] = {{x0, high, z0}, {x1, high, z0}, {x1, high, z1}, {x0, high, z1}};
  const olx_vec3 walls[4][4] = {
      {{x0, low, z1}, {x0, low, z0}, {x0, high, z0}, {x0, high, z1}},
      {{x1, low, z0}, {x1, low, z1}, {x1, high, z1}, {x1, high, z0}},
      {{x0, low, z0}, {x1, low, z0}, {x1, high, z0}, {x0, high, z0}},
      {{x1, low, z1}, {x0, low, z1}, {x0, high, z1}, {x1, high, z1}},
  };
  static const int8_t neighbours[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  OLX_TRY(olx_add_quad(scene, name, floor, p->floor_material));
  OLX_TRY(olx_add_quad(scene, name, ceiling, p->ceiling_material));
  for (uint32_t k = 0; k < 4; k++) {
    if (is_open(p, (int64_t)column + neighbours[k][0], (int64_t)row + neighbours[k][1])) continue;
    OLX_TRY(olx_add_quad(scene, name, walls[k], p->wall_material));
  }
  return OLX_OK;
}

olx_result olx_add_plan(olx_scene *scene, const char *name, const olx_plan *plan) {
  for (uint32_t row = 0; row < plan->rows; row++) {
    for (uint32_t column = 0; column < plan->columns; column++) {
      if (is_open(plan, column, row)) OLX_TRY(add_cell(scene, name, plan, column, row));
    }
  }
  return OLX_OK;
}
