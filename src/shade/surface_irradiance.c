// Interpolates diffuse light of static surfaces from texels of probes that see a point's own surface, else of surfaces
// close to it, else from the irradiance volume. Its twin is shaders/lib/surface_irradiance.glsl.
#include "shade/surface_irradiance.h"

#include "field/texels.h"
#include "select/bricks.h"
#include "select/cage.h"
#include "select/sight.h"
#include "shade/irradiance.h"
#include "shade/volume_irradiance.h"

typedef struct ranked_probe {
  uint32_t probe;
  float weight; // cosine / r^2
} ranked_probe;

typedef struct ranking {
  uint32_t count, most;
  ranked_probe probes[OLX_MOST_RANKED];
} ranking;

// Returns how well a probe sees a point; 0 when it cannot.
static float rank_weight(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                         uint32_t probe) {
  if (field->probe_flags[probe] & OLX_PROBE_BURIED && !settings->keep_buried) return 0.0f;
  const olx_vec3 way = olx_sub(field->probe_positions[probe], point->position);
  const float squared = olx_dot(way, way), weight = olx_dot(way, point->geometric_normal) / (squared * sqrtf(squared));
  return weight > 0.0f && weight < INFINITY ? weight : 0.0f;
}

static void rank(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                 uint32_t probe, ranking *r) {
  const float weight = rank_weight(field, settings, point, probe);
  if (!(weight > 0.0f)) return;
  uint32_t at = r->count;
  while (at > 0 && r->probes[at - 1].weight < weight) at--;
  if (at == r->most) return;
  if (r->count < r->most) r->count++;
  for (uint32_t i = r->count - 1; i > at; i--) r->probes[i] = r->probes[i - 1];
  r->probes[at] = (ranked_probe){probe, weight};
}

static uint32_t most_ranked(const olx_sample_settings *settings) {
  return settings->max_probes < OLX_MOST_RANKED ? settings->max_probes : OLX_MOST_RANKED;
}

// Ranks the probes of the point's brick.
static void rank_listed(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                        ranking *r) {
  const uint32_t *list = olx_bricks_list(&field->bricks, point->position);
  for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) {
    const uint32_t probe = olx_bricks_probe(list, i);
    if (probe == OLX_BRICK_NO_PROBE) return;
    rank(field, settings, point, probe, r);
  }
}

// Ranks the probes of the point's cage.
static void rank_cage(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                      ranking *r) {
  const olx_grid *grid = &field->info.probes.grid;
  const olx_cage cage = olx_cage_at(grid, point->position);
  for (uint32_t corner = 0; corner < 8; corner++) {
    if (olx_cage_has(&cage, corner)) rank(field, settings, point, olx_cage_probe(grid, &cage, corner), r);
  }
}

// Ranks the best of all probes: a few, or as many as the settings allow for OLX_SELECT_EXHAUSTIVE, the reference.
static void rank_all(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                     ranking *r) {
  const uint32_t most = most_ranked(settings);
  r->count = 0;
  r->most = settings->select == OLX_SELECT_EXHAUSTIVE || most < OLX_MOST_FAR ? most : OLX_MOST_FAR;
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) rank(field, settings, point, probe, r);
}

// Ranks the probes of the point's brick, or of its cage in a field without bricks, best first.
static void rank_near(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                      ranking *r) {
  r->count = 0;
  r->most = most_ranked(settings);
  if (field->bricks.header) rank_listed(field, settings, point, r);
  else if (field->info.probes.has_grid) rank_cage(field, settings, point, r);
}

// A point relative to a probe.
typedef struct probe_view {
  uint32_t probe;
  olx_vec3 offset; // from the probe
  olx_vec3 normal; // geometric
  float angle;     // side of a texel there, in radians
  float miss;      // how far the point may miss a texel's surface, in footprints
} probe_view;

// One of the four texels around the direction in which a probe sees the point.
typedef struct seen_texel {
  float distance, facing; // facing: cosine at which the probe sees its surface
  olx_vec3 normal;
  olx_vec3 step; // from its surface to the point, along the ray through the texel's centre
  float away;    // length of the step
} seen_texel;

// Reads texel (x, y), which may be of the border; false for the sky.
static bool see_texel(const olx_field *field, const probe_view *v, size_t texel, int32_t x, int32_t y, seen_texel *t) {
  const olx_texel_geometry seen = olx_texel_geometry_of(field, v->probe, texel);
  t->distance = seen.distance;
  if (!(t->distance < INFINITY)) return false;
  int32_t source_x, source_y;
  olx_border_source(x, y, (int32_t)field->n, &source_x, &source_y);
  const olx_vec3 centre = olx_texel_direction((uint32_t)source_x, (uint32_t)source_y, field->n);
  t->normal = seen.normal;
  t->facing = -olx_dot(t->normal, centre);
  t->step = olx_madd(v->offset, centre, -t->distance);
  t->away = olx_length(t->step);
  return true;
}

// Returns how far packing may move the point off the texel's surface, in metres.
static float packing_error(const seen_texel *t) {
  return OLX_DISTANCE_ERROR * t->distance * fabsf(t->facing) + OLX_STORED_NORMAL_ERROR * t->away;
}

// Returns 1 where the texel sees the surface on which the point lies, 0 where it does not, and values between where
// that is uncertain, so that light changes smoothly as the point moves.
//
// On an arc, the chord between two points is perpendicular to the mean of their normals. The height of the point over
// that mean is therefore 0 on planes and curved surfaces alike. Where normals differ, the surface may turn from one to
// the other anywhere between the points, as facets do, so the chord may be perpendicular to either normal.
static float texel_agrees(const probe_view *v, const seen_texel *t) {
  const float agreement = olx_dot(t->normal, v->normal), footprint = t->distance * v->angle;
  if (!(t->facing > OLX_LEAST_FACING && agreement > OLX_LEAST_AGREEMENT)) return 0.0f;
  // The sum of the normals has the length 2 cos(angle / 2), which is 1.5 + 0.5 cos(angle) to within 0.4 % here.
  const float height = fabsf(olx_dot(olx_add(t->normal, v->normal), t->step)) * (1.0f / (1.5f + 0.5f * agreement));
  const float along = t->away * t->away - height * height;
  if (along * olx_square(t->facing) > olx_square(OLX_SURFACE_REACH * footprint)) return 0.0f;
  const float alike = olx_min((agreement - OLX_LEAST_AGREEMENT) / (OLX_FULL_AGREEMENT - OLX_LEAST_AGREEMENT), 1.0f);
  const float flat = v->miss * footprint + packing_error(t);
  if (2.0f * height <= flat) return alike;
  const float half_turn = sqrtf(0.5f * olx_max(1.0f - agreement, 0.0f)); // sine of half the angle between the normals
  const float allowed = flat + half_turn * t->away;
  return olx_clamp(2.0f - 2.0f * height / allowed, 0.0f, 1.0f) * alike;
}

// Returns how much light of a texel, whose surface is `step` from the point, reaches the point past a neighbouring
// texel that sees `other`, a different surface. It is 0 when texel and point lie on opposite sides of that surface,
// like floors on both sides of a wall.
static float passes(olx_vec3 step, const seen_texel *other) {
  const float height = olx_dot(other->normal, other->step), allowed = packing_error(other);
  if (!(height < -allowed) || height - olx_dot(other->normal, step) <= allowed) return 1.0f;
  return olx_max(2.0f + height / allowed, 0.0f);
}

// Irradiance from those texels of one probe that see the point's surface, times their share.
typedef struct texel_light {
  olx_vec3 sum;
  float share; // 0..1
} texel_light;

static probe_view view_from(const olx_field *field, float tolerance, uint32_t probe, const olx_surface_point *point) {
  const olx_vec3 offset = olx_sub(point->position, field->probe_positions[probe]);
  return (probe_view){.probe = probe,
                      .offset = offset,
                      .normal = point->geometric_normal,
                      .angle = sqrtf(olx_texel_solid_angle_near(olx_octahedral_encode(offset), field->n)),
                      .miss = OLX_SURFACE_MISS + tolerance};
}

static texel_light read_texels(const olx_field *field, float tolerance, uint32_t probe,
                               const olx_surface_point *point) {
  const probe_view v = view_from(field, tolerance, probe, point);
  const olx_bilinear around = olx_bilinear_at(olx_octahedral_encode(v.offset), field->n);
  const uint32_t first = (uint32_t)around.index[0];
  const int32_t x = (int32_t)(first % field->stride) - 1, y = (int32_t)(first / field->stride) - 1;
  seen_texel texels[4];
  float agrees[4];
  bool seen[4];
  for (int32_t i = 0; i < 4; i++) {
    seen[i] = see_texel(field, &v, around.index[i], x + (i & 1), y + (i >> 1), &texels[i]);
    agrees[i] = seen[i] ? texel_agrees(&v, &texels[i]) : 0.0f;
  }
  texel_light light = {.share = 0.0f};
  for (uint32_t i = 0; i < 4; i++) {
    float weight = around.weight[i] * agrees[i];
    for (uint32_t k = 0; k < 4 && weight > 0.0f; k++) {
      if (seen[k] && !(agrees[k] > 0.0f)) weight *= passes(texels[i].step, &texels[k]);
    }
    if (!(weight > 0.0f)) continue;
    light.sum = olx_madd(light.sum, olx_texel_indirect(field, probe, around.index[i]), weight);
    light.share += weight;
  }
  return light;
}

// The blended irradiance of some probes, in the order of their greatest possible weights.
typedef struct blend {
  uint32_t count;
  float weight[OLX_MOST_BLENDED], best;
  olx_vec3 irradiance[OLX_MOST_BLENDED];
} blend;

// Adds the light of a probe, unless its share is no more than rounding.
static void add_light(blend *b, const texel_light *light, float weight_of_rank) {
  if (light->share < OLX_LEAST_TEXEL_SHARE) return;
  const float weight = weight_of_rank * light->share;
  b->weight[b->count] = weight;
  b->irradiance[b->count++] = olx_scale(light->sum, 1.0f / light->share);
  b->best = olx_max(b->best, weight);
}

// Blends the ranked probes. A probe's weight is cosine / r^2 times the share of its texels that see the surface, minus
// the threshold that a weight must exceed. It therefore appears and disappears at weight 0, and where another probe
// becomes the best, both weights are equal.
static void read_ranked(const olx_field *field, float tolerance, const olx_surface_point *point, const ranking *r,
                        blend *b) {
  for (uint32_t i = 0; i < r->count && b->count < OLX_MOST_BLENDED; i++) {
    if (r->probes[i].weight <= OLX_BLEND_ABOVE * b->best) break;
    const texel_light light = read_texels(field, tolerance, r->probes[i].probe, point);
    add_light(b, &light, r->probes[i].weight);
  }
}

// Returns the surface tolerance in footprints; the default in place of one out of range.
static float tolerance_of(const olx_sample_settings *settings) {
  const float tolerance = settings->surface_tolerance;
  return tolerance >= 0.0f && tolerance <= OLX_MOST_SURFACE_TOLERANCE ? tolerance : 0.0f;
}

// Gathers the light that is stored for the point's surface or, where none is, for surfaces close before or behind it,
// as probes near the point see them; returns whether it is of the point's own surface.
static bool gather(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                   blend *b) {
  const float tolerance = tolerance_of(settings);
  ranking r;
  if (settings->select != OLX_SELECT_EXHAUSTIVE) {
    rank_near(field, settings, point, &r);
    read_ranked(field, tolerance, point, &r, b);
  }
  if (b->count > 0) return true;
  rank_all(field, settings, point, &r);
  read_ranked(field, tolerance, point, &r, b);
  if (b->count > 0) return true;
  rank_near(field, settings, point, &r);
  read_ranked(field, tolerance + OLX_NEAR_SURFACE, point, &r, b);
  return false;
}

static olx_vec3 mix(const blend *b, uint32_t *probes) {
  olx_vec3 sum = {0};
  float weights = 0.0f;
  for (uint32_t i = 0; i < b->count; i++) {
    const float weight = b->weight[i] / b->best - OLX_BLEND_ABOVE;
    if (weight <= 0.0f) continue;
    sum = olx_madd(sum, b->irradiance[i], weight);
    weights += weight;
    ++*probes;
  }
  return olx_scale(sum, 1.0f / weights);
}

static bool is_finite(const olx_surface_point *p) {
  return olx_finite(p->position) && olx_finite(p->geometric_normal) && olx_finite(p->vertex_normal) &&
         olx_finite(p->shading_normal) && olx_finite(p->view);
}

// Returns irradiance where nothing is stored for the surface: from the irradiance volume, which is dark where it has no
// cell, or, in a field without a volume, from irradiance probes.
static olx_vec3 fallen_back(const olx_field *field, const olx_sample_settings *settings,
                            const olx_surface_point *point) {
  olx_volume_light_at volume;
  if (olx_volume_gather(field, point->position, point->geometric_normal, &volume)) {
    return olx_volume_towards(&volume, point->shading_normal);
  }
  if (olx_volume_answers(field)) return olx_splat(0.0f);
  return olx_irradiance(field, settings, point->position, point->shading_normal, point->view);
}

// Finds the irradiance around a point for its vertex normal and its shading normal, where texels are not asked: from
// the volume, which has none where it has no cell, or, in a field without a volume, from irradiance probes. For the
// shading normal, the volume's light omits the share from below the surface.
static void light_around(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                         olx_vec3 around[2]) {
  olx_volume_light_at volume;
  around[0] = around[1] = olx_splat(0.0f);
  if (olx_volume_gather(field, point->position, point->geometric_normal, &volume)) {
    around[0] = olx_volume_towards(&volume, point->vertex_normal);
    around[1] = olx_volume_bent(&volume, point->vertex_normal, point->shading_normal);
  } else if (!olx_volume_answers(field)) {
    const olx_irradiance_source source = olx_irradiance_source_of(field);
    const olx_vec3 normals[2] = {point->vertex_normal, point->shading_normal};
    olx_irradiance_both(&source, settings, point->position, normals, point->view, around);
  }
}

static float change(float from, float to) {
  return from > 0.0f ? olx_min(to / from, OLX_MOST_CHANGE) : to > 0.0f ? OLX_MOST_CHANGE : 1.0f;
}

// Returns a surface's light after a normal map has bent its normal by an angle with this cosine: changed as the light
// around it changes, as far as that is as bright as the surface's own. Where it is not, it misses what lights the
// surface, or sees what does not, and cannot tell where light comes from. Light then counts as even over the surface's
// hemisphere, of which the bent normal's cosine lobe keeps (1 + cosine) / 2.
static olx_vec3 bend(olx_vec3 light, const olx_vec3 around[2], float cosine) {
  const float own = olx_luminance(light), other = olx_luminance(around[0]), brighter = olx_max(own, other);
  const float alike = brighter > 0.0f ? olx_min(own, other) / brighter : 0.0f,
              even = 0.5f + 0.5f * olx_clamp(cosine, -1.0f, 1.0f);
  return olx_v3(light.x * olx_mix(even, change(around[0].x, around[1].x), alike),
                light.y * olx_mix(even, change(around[0].y, around[1].y), alike),
                light.z * olx_mix(even, change(around[0].z, around[1].z), alike));
}

// Interpolates the light that texels store for the point; returns whether there is any.
static bool stored_light(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                         olx_surface_light *light) {
  blend b = {.count = 0};
  const bool own = gather(field, settings, point, &b);
  if (b.count == 0) return false;
  light->irradiance = mix(&b, &light->probes);
  if (!own) light->probes = 0;
  return true;
}

// Completes the result of stored_light: where nothing is stored, light comes from the volume; where a normal map bends
// the normal, stored light changes with it.
static void complete_light(const olx_field *field, const olx_sample_settings *settings, const olx_surface_point *point,
                           bool stored, olx_surface_light *light) {
  const olx_vec3 bent = olx_sub(point->shading_normal, point->vertex_normal);
  if (!stored) {
    light->irradiance = fallen_back(field, settings, point);
  } else if (olx_dot(bent, bent) > 1e-6f) {
    olx_vec3 around[2];
    light_around(field, settings, point, around);
    light->irradiance = bend(light->irradiance, around, olx_dot(point->vertex_normal, point->shading_normal));
  }
}

olx_surface_light olx_surface_light_at(const olx_field *field, const olx_sample_settings *settings,
                                       const olx_surface_point *point) {
  olx_surface_light light = {.probes = 0};
  if (!is_finite(point)) return light;
  const bool stored = stored_light(field, settings, point, &light);
  complete_light(field, settings, point, stored, &light);
  return light;
}

olx_vec3 olx_surface_irradiance(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                                olx_vec3 geometric_normal, olx_vec3 shading_normal, olx_vec3 view) {
  const olx_surface_point point = {.position = position,
                                   .geometric_normal = geometric_normal,
                                   .vertex_normal = geometric_normal,
                                   .shading_normal = shading_normal,
                                   .view = view};
  return olx_surface_light_at(field, settings, &point).irradiance;
}
