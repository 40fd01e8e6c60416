// Builds solids with a constant section, such as arches and walls with arched openings, by cutting ears off their
// outlines.
#include "core/result.h"
#include "scene/builtin/builtin_shapes.h"

enum { MOST_POINTS = 64 };

static float turn(olx_vec2 a, olx_vec2 b, olx_vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

static float distance(olx_vec2 a, olx_vec2 b) { return sqrtf((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y)); }

static float signed_area(const olx_vec2 *outline, uint32_t points) {
  float twice = 0.0f;
  for (uint32_t i = 1; i + 1 < points; i++) twice += turn(outline[0], outline[i], outline[i + 1]);
  return 0.5f * twice;
}

// Returns the quality of cutting off the corner at left[i] of the rest of an outline that turns left: the least height
// of the triangle, or 0 when the triangle is not an ear.
static float ear_height(const olx_vec2 *outline, const uint32_t *left, uint32_t count, uint32_t i) {
  const olx_vec2 a = outline[left[(i + count - 1) % count]], b = outline[left[i]], c = outline[left[(i + 1) % count]];
  const float twice = turn(a, b, c);
  if (twice <= 0.0f) return 0.0f;
  for (uint32_t k = 2; k + 1 < count; k++) {
    const olx_vec2 p = outline[left[(i + k) % count]];
    if (turn(a, b, p) >= 0.0f && turn(b, c, p) >= 0.0f && turn(c, a, p) >= 0.0f) return 0.0f;
  }
  return twice / olx_max(distance(a, b), olx_max(distance(b, c), distance(c, a)));
}

// Triangulates an outline that turns left, three indices per triangle. Cuts off the thickest ear first, to avoid
// slivers.
static olx_result triangulate(const char *name, const olx_vec2 *outline, uint32_t points, uint32_t *indices) {
  uint32_t left[MOST_POINTS], count = points;
  for (uint32_t i = 0; i < points; i++) left[i] = i;
  while (count > 2) {
    uint32_t best = 0;
    float height = 0.0f;
    for (uint32_t i = 0; i < count; i++) {
      const float own = ear_height(outline, left, count, i);
      if (own <= height) continue;
      height = own;
      best = i;
    }
    if (height <= 0.0f) return olx_fail(OLX_ERROR_ARGUMENT, "%s: the outline is not simple", name);
    *indices++ = left[(best + count - 1) % count];
    *indices++ = left[best];
    *indices++ = left[(best + 1) % count];
    count--;
    for (uint32_t i = best; i < count; i++) left[i] = left[i + 1];
  }
  return OLX_OK;
}

static olx_vec3 place(const olx_extrusion *e, olx_vec2 p, float along) {
  return e->axis == OLX_ALONG_X ? olx_v3(along, p.y, p.x) : olx_v3(p.x, p.y, along);
}

static olx_result add_end(olx_scene *scene, const char *name, const olx_extrusion *e, const olx_vec2 *outline,
                          float along, bool flipped, uint32_t material) {
  olx_vec3 corners[MOST_POINTS];
  uint32_t indices[3 * MOST_POINTS];
  const uint32_t triangles = e->points - 2;
  for (uint32_t i = 0; i < e->points; i++) corners[i] = place(e, outline[i], along);
  OLX_TRY(triangulate(name, outline, e->points, indices));
  for (uint32_t t = 0; flipped && t < triangles; t++) {
    const uint32_t first = indices[3 * t];
    indices[3 * t] = indices[3 * t + 2];
    indices[3 * t + 2] = first;
  }
  return olx_scene_add_mesh(scene, name, corners, NULL, NULL, e->points, indices, triangles, material);
}

olx_result olx_add_extrusion(olx_scene *scene, const char *name, const olx_extrusion *e, uint32_t material) {
  olx_vec2 outline[MOST_POINTS];
  const uint32_t n = e->points;
  if (n < 3 || n > MOST_POINTS) return olx_fail(OLX_ERROR_ARGUMENT, "%s: an outline of %u points", name, n);
  const bool clockwise = signed_area(e->outline, n) < 0.0f, along_x = e->axis == OLX_ALONG_X;
  for (uint32_t i = 0; i < n; i++) outline[i] = e->outline[clockwise ? n - 1 - i : i];
  for (uint32_t i = 0; i < n; i++) {
    // In a reversed outline, the side from point i to the next is the given side from point n - 2 - i.
    const uint32_t given = clockwise ? (2 * n - 2 - i) % n : i, next = (i + 1) % n;
    if (e->open_sides >> given & 1) continue;
    const olx_vec2 a = outline[along_x ? next : i], b = outline[along_x ? i : next];
    const olx_vec3 side[4] = {place(e, a, e->low), place(e, b, e->low), place(e, b, e->high), place(e, a, e->high)};
    OLX_TRY(olx_add_quad(scene, name, side, material));
  }
  if (!e->low_open) OLX_TRY(add_end(scene, name, e, outline, e->low, !along_x, material));
  if (!e->high_open) OLX_TRY(add_end(scene, name, e, outline, e->high, along_x, material));
  return OLX_OK;
}

// Returns point i of the arch, widened by `breadth`, from its left spring to its right spring.
static olx_vec2 arch_point(const olx_arch *arch, float breadth, uint32_t i) {
  const float half = 0.5f * arch->width + breadth, angle = OLX_PI * (1.0f - (float)i / OLX_ARCH_STEPS);
  if (i == 0) return (olx_vec2){arch->center - half, arch->spring};
  if (i == OLX_ARCH_STEPS) return (olx_vec2){arch->center + half, arch->spring};
  return (olx_vec2){arch->center + half * cosf(angle), arch->spring + (arch->rise + breadth) * sinf(angle)};
}

void olx_arched_wall(const olx_arch *arch, float left, float right, float top,
                     olx_vec2 outline[OLX_ARCHED_WALL_POINTS]) {
  uint32_t n = 0;
  outline[n++] = (olx_vec2){left, arch->base};
  outline[n++] = (olx_vec2){arch_point(arch, 0.0f, 0).x, arch->base};
  for (uint32_t i = 0; i <= OLX_ARCH_STEPS; i++) outline[n++] = arch_point(arch, 0.0f, i);
  outline[n++] = (olx_vec2){arch_point(arch, 0.0f, OLX_ARCH_STEPS).x, arch->base};
  outline[n++] = (olx_vec2){right, arch->base};
  outline[n++] = (olx_vec2){right, top};
  outline[n++] = (olx_vec2){left, top};
}

void olx_arch_band(const olx_arch *arch, float breadth, olx_vec2 outline[OLX_ARCH_BAND_POINTS]) {
  uint32_t n = 0;
  outline[n++] = (olx_vec2){arch_point(arch, breadth, 0).x, arch->base};
  for (uint32_t i = 0; i <= OLX_ARCH_STEPS; i++) outline[n++] = arch_point(arch, breadth, i);
  outline[n++] = (olx_vec2){arch_point(arch, breadth, OLX_ARCH_STEPS).x, arch->base};
  outline[n++] = (olx_vec2){arch_point(arch, 0.0f, OLX_ARCH_STEPS).x, arch->base};
  for (uint32_t i = 0; i <= OLX_ARCH_STEPS; i++) outline[n++] = arch_point(arch, 0.0f, OLX_ARCH_STEPS - i);
  outline[n++] = (olx_vec2){arch_point(arch, 0.0f, 0).x, arch->base};
}
