// Judges a ray that reaches the distance stored in a texel by the texel's surface element: the ray hits it, passes in
// front of it, or is unresolved because the probe cannot see behind it.
#include "trace/surfel.h"

// The surfel of a texel in relation to the ray: f(t) = f0 + f1 t is the ray's height above its plane.
typedef struct surfel {
  float distance;  // stored, metres
  float footprint; // metres: distance times the square root of the texel's solid angle
  float slack;     // uncertainty of its depth, metres
  float cosine;    // of the angle at which the probe sees it
  float f0, f1;
} surfel;

static size_t texel_index(const olx_march *m, int32_t x, int32_t y) { return olx_map_index(m->field->stride, x, y); }

static surfel read_surfel(const olx_march *m, int32_t x, int32_t y, float distance) {
  const float inverse_n = 1.0f / (float)m->field->n;
  const olx_vec3 q = olx_octahedral_point((olx_vec2){((float)x + 0.5f) * inverse_n, ((float)y + 0.5f) * inverse_n});
  const float inverse_length = 1.0f / olx_length(q);
  const float footprint = distance * 2.0f * inverse_n * inverse_length * sqrtf(inverse_length);
  const olx_vec3 normal = m->geometry ? olx_plane_normal(olx_block_plane(m->field, m->probe, (uint32_t)x, (uint32_t)y))
                                      : olx_texel_normal(m->field, m->probe, texel_index(m, x, y));
  const float cosine = -olx_dot(normal, q) * inverse_length;
  return (surfel){
      .distance = distance,
      .footprint = footprint,
      .slack = distance * OLX_DISTANCE_PRECISION + footprint,
      .cosine = cosine,
      .f0 = olx_dot(normal, m->ray->origin) + distance * cosine,
      .f1 = olx_dot(normal, m->ray->direction),
  };
}

// Returns how far below a surfel's plane the ray may be and still count as on it, in metres.
static float plane_tolerance(const surfel *s) {
  return s->distance * OLX_DISTANCE_PRECISION * olx_max(s->cosine, 0.0f) + 0.005f * s->footprint;
}

// Returns the largest distance of a texel and its neighbours.
static float farthest_around(const olx_march *m, olx_cell c) {
  float farthest = 0.0f;
  for (int32_t dy = -1; dy <= 1; dy++) {
    for (int32_t dx = -1; dx <= 1; dx++) {
      farthest = olx_max(farthest, olx_texel_distance(m->field, m->probe, texel_index(m, c.x + dx, c.y + dy)));
    }
  }
  return farthest;
}

// Returns whether a squared distance from the probe is beyond the surface inside a texel. The surface reaches as far as
// its plane tilted away by a texel, but no farther than its neighbours, which are read only when the tilted plane does
// not decide.
static bool beyond_reach(olx_march *m, olx_cell c, const surfel *s, float radius_squared) {
  if (radius_squared <= olx_square(s->distance + s->slack)) return false;
  const float sine = sqrtf(olx_max(0.0f, 1.0f - s->cosine * s->cosine));
  const float spread = s->cosine - sine * s->footprint / s->distance;
  const float tilted = spread > 0.0f ? s->distance * s->cosine / spread : INFINITY;
  if (radius_squared > olx_square(tilted + s->slack)) return true;
  m->steps += 8;
  return radius_squared > olx_square(farthest_around(m, c) + s->slack);
}

// Returns whether the ray's image at t lies within the neighbourhood of a texel, and the texel at that image sees a
// surface about as far away. If that texel sees far beyond the point, the plane ends at an edge between the two texels.
static bool supported(olx_march *m, const olx_piece *p, olx_cell c, const surfel *s, float t) {
  olx_vec2 image;
  if (!olx_image_at(m, p, t, &image)) return false;
  if (fabsf(image.x - ((float)c.x + 0.5f)) > OLX_NEIGHBOURHOOD_TEXELS) return false;
  if (fabsf(image.y - ((float)c.y + 0.5f)) > OLX_NEIGHBOURHOOD_TEXELS) return false;
  const int32_t x = olx_clamp_texel(p->sign_x, image.x, m->field->n),
                y = olx_clamp_texel(p->sign_z, image.y, m->field->n);
  m->steps++;
  const float stored = olx_texel_distance(m->field, m->probe, texel_index(m, x, y));
  const float slope = 1.0f / olx_max(s->cosine, 0.1f);
  return stored <= sqrtf(olx_radius_squared(m, t)) + s->footprint * slope;
}

// Judges a ray above, on or below the surfel's plane in texel c, which it leaves at t1. A ray that is lost behind the
// end of the plane is lost where it crosses it.
static olx_verdict judge_height(olx_march *m, const olx_piece *p, olx_cell c, float t1, const surfel *s,
                                olx_probe_answer *answer) {
  const float tolerance = plane_tolerance(s), height0 = s->f0 + s->f1 * c.t;
  if (height0 >= -tolerance) {
    const float height1 = isfinite(t1) ? s->f0 + s->f1 * t1 : s->f1 < 0.0f ? -INFINITY : INFINITY;
    if (height1 >= -tolerance) return OLX_VERDICT_CLEAR; // above the plane throughout the texel
    answer->t = olx_clamp(-s->f0 / s->f1, c.t, t1);
    return beyond_reach(m, c, s, olx_radius_squared(m, answer->t)) ? OLX_VERDICT_HIDDEN : OLX_VERDICT_HIT;
  }
  if (s->f1 >= 0.0f) {
    // Below, but rising: a ray that has just left this surface is still within the error of rounding and curvature. One
    // that began farther below passes through the surface from behind.
    return -olx_min(height0, s->f0) <= 0.5f * s->footprint ? OLX_VERDICT_CLEAR : OLX_VERDICT_HIDDEN;
  }
  const float t = -s->f0 / s->f1;
  // A ray taken over from another probe may have slipped through this surface by that probe's tolerance, but no ray
  // starts behind the surface that it is about to hit.
  const float slip = m->ray->t_min > 0.0f ? s->footprint : 0.0f;
  if (t < m->ray->t_min && s->f0 + s->f1 * m->ray->t_min < -slip) return OLX_VERDICT_HIDDEN;
  if (!supported(m, p, c, s, t)) return OLX_VERDICT_HIDDEN;
  answer->t = olx_max(t, m->ray->t_min);
  return OLX_VERDICT_HIT;
}

void olx_read_block(olx_march *m, int32_t x, int32_t y) {
  const uint32_t n = m->field->n;
  const olx_block_place place = {n, (uint32_t)x, (uint32_t)y};
  const olx_geometry_block *block = m->geometry + (size_t)place.y * (n / OLX_BLOCK_SIDE) + place.x;
  if (block == m->block) return;
  m->block = block;
  m->steps++;
  const uint32_t *w = block->words, form = w[3] >> 30;
  if (form == OLX_GEOMETRY_ONE) {
    const olx_vec3 plane = {olx_bits_float(w[0]), olx_bits_float(w[1]), olx_bits_float(w[2])};
    m->planes[0] = olx_plane_along(m->ray, plane);
  }
  for (uint32_t i = 0; form == OLX_GEOMETRY_TWO && i < 2; i++) {
    m->planes[i] = olx_plane_along(m->ray, olx_plane_decode((olx_plane_code){{w[i], w[2 + i]}}, place));
  }
}

// Returns the plane of a texel of the block read last.
static olx_ray_plane texel_plane(olx_march *m, int32_t x, int32_t y) {
  const uint32_t texel = (uint32_t)y % OLX_BLOCK_SIDE * OLX_BLOCK_SIDE + (uint32_t)x % OLX_BLOCK_SIDE;
  const uint32_t *w = m->block->words, form = w[3] >> 30;
  if (form == OLX_GEOMETRY_ONE) return m->planes[0];
  if (form == OLX_GEOMETRY_TWO) return m->planes[w[2 + texel / 8] >> (22 + texel % 8) & 1u];
  m->steps++;
  return olx_plane_along(m->ray, olx_block_plane(m->field, m->probe, (uint32_t)x, (uint32_t)y));
}

// A plane that comes nearer in a part of the texel than in its middle may end before that part, at an object's edge;
// the next texel then decides.
bool olx_reaches_plane(olx_march *m, olx_cell c, float t1, float *stored) {
  olx_read_block(m, c.x >> OLX_PYRAMID_FINEST, c.y >> OLX_PYRAMID_FINEST);
  if (olx_plane_clears(texel_plane(m, c.x, c.y), c.t, t1)) return false;
  *stored = olx_texel_distance(m->field, m->probe, texel_index(m, c.x, c.y));
  return !(olx_farthest_squared(m, c.t, t1) < *stored * *stored || *stored == INFINITY);
}

olx_verdict olx_visit_block(olx_march *m, const olx_piece *p, int32_t x, int32_t y, float s, float t, bool by_v,
                            float t1, olx_probe_answer *answer) {
  olx_read_block(m, x, y);
  if (olx_block_clears(m, p, t, t1)) return OLX_VERDICT_CLEAR;
  olx_cell c = {olx_texel_at(&p->u, s, true), olx_texel_at(&p->v, s, by_v), t};
  do {
    const olx_vec2 ahead = olx_crossings_ahead(p, c.x, c.y, 0);
    const float s1 = olx_min(ahead.x, ahead.y), end = olx_parameter_at(p, s1);
    float stored;
    const olx_verdict verdict =
        olx_reaches_plane(m, c, end, &stored) ? olx_judge_surfel(m, p, c, end, stored, answer) : OLX_VERDICT_CLEAR;
    if (verdict != OLX_VERDICT_CLEAR || s1 >= 1.0f) return verdict;
    c = olx_next_cell(p, c, ahead, end);
  } while (c.x >> OLX_PYRAMID_FINEST == x && c.y >> OLX_PYRAMID_FINEST == y);
  return OLX_VERDICT_CLEAR;
}

olx_verdict olx_judge_surfel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float stored,
                             olx_probe_answer *answer) {
  const surfel s = read_surfel(m, c.x, c.y, stored);
  const float nearest_squared = olx_nearest_squared(m, c.t, t1);
  answer->texel = texel_index(m, c.x, c.y);
  answer->t = c.t;
  const olx_verdict verdict =
      beyond_reach(m, c, &s, nearest_squared) ? OLX_VERDICT_HIDDEN : judge_height(m, p, c, t1, &s, answer);
  const float lost_squared = answer->t > c.t ? olx_radius_squared(m, answer->t) : nearest_squared;
  if (verdict == OLX_VERDICT_HIDDEN) answer->gap = (sqrtf(lost_squared) - stored) / s.footprint;
  return verdict;
}
