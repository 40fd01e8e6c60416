// Traces a ray through one probe's map: divides it into pieces whose images in the octahedral square are straight, and
// marches along each in turn. Its twin is shaders/lib/probe_trace.glsl.
#include "trace/probe_trace.h"

#include "trace/march.h"
#include "trace/march_wide.h"

// One end of a piece.
typedef struct piece_end {
  float u, v;    // its image
  float inverse; // 1 / |P|_1; 0 at infinity
  bool centre;   // too close to the probe's centre to have an image
} piece_end;

static piece_end end_at(const olx_march *m, const olx_piece *p, float t) {
  const olx_vec3 o = m->ray->origin, d = m->ray->direction;
  const bool infinite = t == INFINITY;
  const olx_vec3 at = infinite ? d : olx_madd(o, d, t);
  const float x = p->sign_x * at.x, z = p->sign_z * at.z, sum = x + p->sign_y * at.y + z;
  const float least = OLX_CENTRE_SHARE * (fabsf(o.x) + fabsf(o.y) + fabsf(o.z));
  const bool centre = !infinite && sum <= least;
  const float inverse = 1.0f / (centre ? olx_max(least, 0x1p-100f) : sum), half = 0.5f * (float)m->field->n;
  const bool upper = p->sign_y > 0.0f;
  const float u = upper ? x * inverse : 1.0f - z * inverse, v = upper ? z * inverse : 1.0f - x * inverse;
  return (piece_end){.u = half + half * p->sign_x * olx_clamp(u, 0.0f, 1.0f),
                     .v = half + half * p->sign_z * olx_clamp(v, 0.0f, 1.0f),
                     .inverse = infinite ? 0.0f : inverse,
                     .centre = centre};
}

static olx_image_axis make_axis(float begin, float end, float sign, uint32_t n) {
  const float travel = end - begin;
  const int32_t first = olx_clamp_texel(sign, begin, n);
  if (!(fabsf(travel) > OLX_STILL_TEXELS)) { // lines ahead are never crossed; those behind always have been
    return (olx_image_axis){.begin = (float)first + 0.5f, .inverse = OLX_NEVER, .ahead = 1, .first = first};
  }
  return (olx_image_axis){
      .begin = begin,
      .travel = travel,
      .inverse = (1.0f + 0x1p-21f) / travel, // so that rounding never puts a line from `end` on before the end
      .step = travel > 0.0f ? 1 : -1,
      .ahead = travel > 0.0f ? 1 : 0,
      .first = first,
  };
}

// Returns the sign of a coordinate o + d t just after t; `plane` is where it is zero.
static float sign_after(float o, float d, float plane, float t) {
  if (d == 0.0f) return olx_sign_not_zero(o);
  return t >= plane ? olx_sign_not_zero(d) : -olx_sign_not_zero(d);
}

static olx_piece make_piece(const olx_march *m, olx_vec3 planes, float t_begin, float t_end) {
  const olx_vec3 o = m->ray->origin, d = m->ray->direction;
  olx_piece p = {
      .t_begin = t_begin,
      .t_end = t_end,
      .sign_x = sign_after(o.x, d.x, planes.x, t_begin),
      .sign_y = sign_after(o.y, d.y, planes.y, t_begin),
      .sign_z = sign_after(o.z, d.z, planes.z, t_begin),
  };
  piece_end begin = end_at(m, &p, t_begin), end = end_at(m, &p, t_end);
  if (begin.centre || end.centre) { // the image of the other end represents the whole piece
    if (begin.centre) begin.u = end.u, begin.v = end.v;
    end.u = begin.u, end.v = begin.v;
  }
  p.u = make_axis(begin.u, end.u, p.sign_x, m->field->n);
  p.v = make_axis(begin.v, end.v, p.sign_z, m->field->n);
  p.near = begin.inverse;
  p.slope = end.inverse - begin.inverse;
  p.rise =
      t_end < INFINITY ? (t_end - t_begin) * end.inverse : 1.0f / (p.sign_x * d.x + p.sign_y * d.y + p.sign_z * d.z);
  p.slack = OLX_PARAMETER_ROUNDING * (t_end < INFINITY ? t_end : 0.0f);
  return p;
}

// Returns where the ray crosses the plane through the probe across one axis; -infinity when it is parallel to it.
static float plane_at(float o, float d) { return d == 0.0f ? -INFINITY : -o / d; }

static olx_verdict march_piece(olx_march *m, const olx_piece *p, olx_tracer tracer, olx_probe_answer *answer) {
  switch (tracer) {
  case OLX_TRACER_TEXEL: return olx_march_texels(m, p, answer);
  case OLX_TRACER_TWO_LEVEL: return olx_march_two_level(m, p, answer);
  default: return olx_march_hiz(m, p, answer);
  }
}

// Returns the next parameter after t at which the ray crosses one of these planes, or t_max.
static float next_cut(olx_vec3 planes, float t, float t_max) {
  float next = t_max;
  if (planes.x > t) next = olx_min(next, planes.x);
  if (planes.y > t) next = olx_min(next, planes.y);
  if (planes.z > t) next = olx_min(next, planes.z);
  return next;
}

olx_probe_answer olx_trace_probe(const olx_field *field, uint32_t probe, const olx_probe_ray *ray, olx_tracer tracer) {
  const olx_vec3 o = ray->origin, d = ray->direction;
  olx_march m = olx_begin_march(field, probe, ray);
  const olx_vec3 planes = {plane_at(o.x, d.x), plane_at(o.y, d.y), plane_at(o.z, d.z)};
  olx_probe_answer answer = {.status = OLX_TRACE_MISS};
  for (float t = ray->t_min; t < ray->t_max;) {
    const float t_end = next_cut(planes, t, ray->t_max);
    const olx_piece p = make_piece(&m, planes, t, t_end);
    const olx_verdict verdict = march_piece(&m, &p, tracer, &answer);
    if (verdict != OLX_VERDICT_CLEAR) {
      answer.status = verdict == OLX_VERDICT_HIT ? OLX_TRACE_HIT : OLX_TRACE_UNKNOWN;
      answer.steps = m.steps;
      return answer;
    }
    t = t_end;
  }
  return olx_probe_clear(field, ray, m.steps);
}

void olx_trace_probes(const olx_field *field, const olx_probe_job *jobs, uint32_t count, olx_tracer tracer,
                      olx_probe_answer *answers) {
#if OLX_WIDE
  if (tracer == OLX_TRACER_HIZ && olx_march_wide_available(field)) {
    olx_march_wide(field, jobs, count, answers);
    return;
  }
#endif
  for (uint32_t i = 0; i < count; i++) answers[i] = olx_trace_probe(field, jobs[i].probe, &jobs[i].ray, tracer);
}
