// Judges what the surface element in a texel says about a ray that reaches its distance: a hit, a pass in front of it,
// or unresolved because the probe cannot see behind it.
#include "trace/surfel.h"

// Half floats are off by up to 2^-11 of their value.
static const float DISTANCE_PRECISION = 0x1p-11f;
// How far from a texel's centre its surfel may be hit, in texels.
static const float NEIGHBOURHOOD_TEXELS = 1.5f;

// The surfel of a texel against the ray: f(t) = f0 + f1 t is the ray's height over its plane.
typedef struct surfel {
  float distance;  // stored, metres
  float footprint; // metres: distance times the root of the texel's solid angle
  float slack;     // metres by which its depth is uncertain
  float cosine;    // of the angle under which the probe sees it
  float f0, f1;
} surfel;

static size_t texel_index(const olx_march *m, int32_t x, int32_t y) { return olx_map_index(m->field->stride, x, y); }

static surfel read_surfel(const olx_march *m, int32_t x, int32_t y, float distance) {
  const float inverse_n = 1.0f / (float)m->field->n;
  const olx_vec3 q = olx_octahedral_point((olx_vec2){((float)x + 0.5f) * inverse_n, ((float)y + 0.5f) * inverse_n});
  const float inverse_length = 1.0f / olx_length(q);
  const float footprint = distance * 2.0f * inverse_n * inverse_length * sqrtf(inverse_length);
  const olx_vec3 normal = olx_texel_normal(m->field, m->probe, texel_index(m, x, y));
  const float cosine = -olx_dot(normal, q) * inverse_length;
  return (surfel){
      .distance = distance,
      .footprint = footprint,
      .slack = distance * DISTANCE_PRECISION + footprint,
      .cosine = cosine,
      .f0 = olx_dot(normal, m->ray->origin) + distance * cosine,
      .f1 = olx_dot(normal, m->ray->direction),
  };
}

// How far the ray may be below a surfel's plane and still count as on it.
static float plane_tolerance(const surfel *s) {
  return s->distance * DISTANCE_PRECISION * olx_max(s->cosine, 0.0f) + 0.005f * s->footprint;
}

// Whether a squared distance from the probe is deeper than the surface of a texel can reach inside it: its plane tilted
// away by a texel, but no farther than the neighbours, which are read only when the tilted plane leaves it open.
static bool beyond_reach(olx_march *m, olx_cell c, const surfel *s, float radius_squared) {
  if (radius_squared <= olx_square(s->distance + s->slack)) return false;
  const float sine = sqrtf(olx_max(0.0f, 1.0f - s->cosine * s->cosine));
  const float spread = s->cosine - sine * s->footprint / s->distance;
  const float tilted = spread > 0.0f ? s->distance * s->cosine / spread : INFINITY;
  if (radius_squared > olx_square(tilted + s->slack)) return true;
  uint16_t farthest = 0;
  for (int32_t dy = -1; dy <= 1; dy++) {
    const uint16_t *row = m->distance + texel_index(m, c.x - 1, c.y + dy);
    for (uint32_t i = 0; i < 3; i++) {
      const uint16_t code = row[i] & 0x7FFFu;
      farthest = code > farthest ? code : farthest;
    }
  }
  m->steps += 8;

  const float neighbours = olx_half_unpack(farthest) * m->field->distance_scale;
  return radius_squared > olx_square(neighbours + s->slack);
}

// Whether the ray's image at t lies within the neighbourhood of a texel, and the texel there sees a surface about there too.
// When it sees far past that point, the plane ends before it: an edge lies between the two texels.
static bool supported(olx_march *m, const olx_piece *p, olx_cell c, const surfel *s, float t) {
  olx_vec2 image;
  if (!olx_image_at(m, p, t, &image)) return false;
  if (fabsf(image.x - ((float)c.x + 0.5f)) > NEIGHBOURHOOD_TEXELS) return false;
  if (fabsf(image.y - ((float)c.y + 0.5f)) > NEIGHBOURHOOD_TEXELS) return false;
  const int32_t x = olx_clamp_texel(p->sign_x, image.x, m->field->n), y = olx_clamp_texel(p->sign_z, image.y, m->field->n);
  m->steps++;
  const float stored = olx_texel_distance(m->field, m->probe, texel_index(m, x, y));
  const float slope = 1.0f / olx_max(s->cosine, 0.1f);
  return stored <= sqrtf(olx_radius_squared(m, t)) + s->footprint * slope;
}

// What the surfel of texel c says about a ray that is above it, on it or below it there, up to t1.
static olx_verdict judge_height(olx_march *m, const olx_piece *p, olx_cell c, float t1, const surfel *s,
                                olx_probe_answer *answer) {
  const float tolerance = plane_tolerance(s), height0 = s->f0 + s->f1 * c.t;
  if (height0 >= -tolerance) {
    const float height1 = isfinite(t1) ? s->f0 + s->f1 * t1 : s->f1 < 0.0f ? -INFINITY : INFINITY;
    if (height1 >= -tolerance) return OLX_VERDICT_CLEAR; // above the plane all through the texel
    const float t = olx_clamp(-s->f0 / s->f1, c.t, t1);
    if (beyond_reach(m, c, s, olx_radius_squared(m, t))) return OLX_VERDICT_HIDDEN;
    answer->t = t;
    return OLX_VERDICT_HIT;
  }
  if (s->f1 >= 0.0f) {
    // Below, but rising: a ray that just left this surface is still within what rounding and curvature explain. One that began
    // farther below comes through the surface from behind.
    return -olx_min(height0, s->f0) <= 0.5f * s->footprint ? OLX_VERDICT_CLEAR : OLX_VERDICT_HIDDEN;
  }
  const float t = -s->f0 / s->f1;
  // A ray handed on by another probe may have slipped through this surface by that probe's tolerance, but no ray starts
  // behind what it is about to hit.
  const float slip = m->ray->t_min > 0.0f ? s->footprint : 0.0f;
  if (t < m->ray->t_min && s->f0 + s->f1 * m->ray->t_min < -slip) return OLX_VERDICT_HIDDEN;
  if (!supported(m, p, c, s, t)) return OLX_VERDICT_HIDDEN;
  answer->t = olx_max(t, m->ray->t_min);
  return OLX_VERDICT_HIT;
}

olx_verdict olx_judge_surfel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float stored,
                             olx_probe_answer *answer) {
  const surfel s = read_surfel(m, c.x, c.y, stored);
  const float nearest_squared = olx_nearest_squared(m, c.t, t1);
  answer->texel = texel_index(m, c.x, c.y);
  answer->t = c.t;
  const olx_verdict verdict =
      beyond_reach(m, c, &s, nearest_squared) ? OLX_VERDICT_HIDDEN : judge_height(m, p, c, t1, &s, answer);
  if (verdict == OLX_VERDICT_HIDDEN) answer->gap = (sqrtf(nearest_squared) - stored) / s.footprint;
  return verdict;
}
