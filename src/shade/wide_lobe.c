// Looks up the light of a wide specular lobe: finds what lies in many of its directions by intersecting the planes that
// the maps of nearby probes store there, and shades it.
#include "shade/wide_lobe.h"

#include "core/sampling.h"
#include "select/bricks.h"
#include "shade/emission.h"
#include "shade/further.h"
#include "shade/glossy.h"
#include "trace/texel_shade.h"

enum {
  MOST_STEPS = 4, // texels that are read to find one surface in one map
  CHECKS = 2      // points on the way to the surface that the probe must see
};

static const float WIDE_ROUGHNESS = 0.25f;
static const float MISS = 0.5f;      // how far a point may lie off a plane, in footprints
static const float SKY_REACH = 4.0f; // how far the way to the sky is checked, in distances of its start from the probe
static const uint32_t SALT = 0x57494445u;

// What a probe's map stores towards a point.
typedef struct seen_plane {
  olx_vec3 plane; // the plane m . p = 1 of points p relative to the probe; 0 for the sky
  uint32_t x, y;  // texel
  float depth;    // m . p of the point: 1 on the plane, more behind it
  float allowed;  // difference in depth that a footprint makes, times MISS
} seen_plane;

static olx_vec3 texel_plane(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  if (field->geometry) return olx_block_plane(field, probe, x, y);
  const size_t texel = olx_map_index(field->stride, (int32_t)x, (int32_t)y);
  const olx_texel_geometry seen = olx_texel_geometry_of(field, probe, texel);
  if (!(seen.distance < INFINITY)) return olx_splat(0.0f);
  const float height = -seen.distance * olx_dot(seen.normal, olx_texel_direction(x, y, field->n));
  return height > 0.0f ? olx_scale(seen.normal, -1.0f / height) : olx_splat(0.0f);
}

// Looks towards a point relative to the probe.
static seen_plane look_at(const olx_field *field, uint32_t probe, olx_vec3 point) {
  const float n = (float)field->n;
  const olx_vec2 uv = olx_octahedral_encode(point);
  seen_plane s = {.x = (uint32_t)olx_min(uv.x * n, n - 1.0f), .y = (uint32_t)olx_min(uv.y * n, n - 1.0f)};
  s.plane = texel_plane(field, probe, s.x, s.y);
  s.depth = olx_plane_depth(s.plane, point);
  s.allowed = MISS * OLX_TEXEL_ANGLE / n * olx_length(point) * olx_length(s.plane);
  return s;
}

static bool is_sky(const seen_plane *s) { return s->plane.x == 0.0f && s->plane.y == 0.0f && s->plane.z == 0.0f; }

// Returns whether the probe sees some points on the way, `metres` long, from `start` (relative to the probe).
static bool way_is_clear(const olx_field *field, uint32_t probe, olx_vec3 start, olx_vec3 direction, float metres) {
  const float length = metres < INFINITY ? metres : SKY_REACH * olx_length(start);
  for (uint32_t i = 1; i <= CHECKS; i++) {
    const olx_vec3 point = olx_madd(start, direction, length * (float)i / (float)(CHECKS + 1));
    const seen_plane s = look_at(field, probe, point);
    if (s.depth > 1.0f + 2.0f * s.allowed) return false;
  }
  return true;
}

bool olx_lobe_find(const olx_field *field, uint32_t probe, olx_vec3 origin, olx_vec3 direction, float guess,
                   olx_trace_hit *hit) {
  const olx_vec3 start = olx_sub(origin, field->probe_positions[probe]);
  float t = guess;
  for (uint32_t step = 0; step < MOST_STEPS; step++) {
    const olx_vec3 at = t < INFINITY ? olx_madd(start, direction, t) : direction;
    const seen_plane s = look_at(field, probe, at);
    const float ahead = olx_dot(s.plane, direction), height = 1.0f - olx_dot(s.plane, start);
    const float next = ahead > 0.0f && height > 0.0f ? height / ahead : INFINITY;
    const bool on_plane = t < INFINITY && next < INFINITY && fabsf(s.depth - 1.0f) <= s.allowed;
    if (on_plane || (t == INFINITY && is_sky(&s))) {
      *hit = (olx_trace_hit){.status = on_plane ? OLX_TRACE_HIT : OLX_TRACE_MISS,
                             .distance_metres = next,
                             .position = on_plane ? olx_madd(origin, direction, next) : olx_splat(0.0f),
                             .normal = on_plane ? olx_plane_normal(s.plane) : olx_splat(0.0f),
                             .emitter = !on_plane,
                             .probe = probe,
                             .texel = (uint32_t)olx_map_index(field->stride, (int32_t)s.x, (int32_t)s.y),
                             .footprint_metres = on_plane ? olx_length(at) * OLX_TEXEL_ANGLE / (float)field->n : 0.0f};
      return way_is_clear(field, probe, start, direction, next);
    }
    t = next;
  }
  return false;
}

// The probes whose maps are read for a lobe.
typedef struct lobe_probes {
  uint32_t count, probes[OLX_BRICK_PROBES];
} lobe_probes;

static lobe_probes probes_near(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position) {
  lobe_probes near = {.count = 0};
  const uint32_t *list = olx_bricks_list(&field->bricks, position);
  for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) {
    const uint32_t probe = olx_bricks_probe(list, i);
    if (probe == OLX_BRICK_NO_PROBE) break;
    if (settings->keep_buried || !(field->probe_flags[probe] & OLX_PROBE_BURIED)) near.probes[near.count++] = probe;
  }
  return near;
}

// Finds a surface or the sky in the first map that tells.
static bool find(const olx_field *field, const lobe_probes *probes, olx_vec3 origin, olx_vec3 direction, float guess,
                 olx_trace_hit *hit) {
  for (uint32_t i = 0; i < probes->count; i++) {
    if (olx_lobe_find(field, probes->probes[i], origin, direction, guess, hit)) return true;
  }
  return false;
}

// Adds its light to what was found along `direction`.
static void shade(const olx_field *field, olx_vec3 direction, olx_trace_hit *hit) {
  hit->emission = olx_texel_emission(field, hit->probe, hit->texel);
  if (hit->status == OLX_TRACE_MISS) return;
  const olx_texel_light light = olx_texel_shade(field, hit->probe, hit->texel, hit->position, direction);
  hit->radiance = olx_add(light.reflected, light.lobe);
  hit->lobe = light.lobe;
}

// Looks up the further ray of a smooth surface that was found along `direction`.
static void look_further(const olx_field *field, const lobe_probes *probes, olx_vec3 direction, olx_vec2 random,
                         olx_trace_hit *hit) {
  olx_further_ray further;
  olx_trace_hit second;
  if (!olx_further_draw(field, hit, direction, random, &further)) return;
  if (!find(field, probes, further.origin, further.direction, hit->distance_metres, &second)) return;
  shade(field, further.direction, &second);
  hit->radiance = olx_further_light(hit, &further, &second);
}

bool olx_lobe_is_wide(const olx_field *field, const olx_sample_settings *settings, float roughness) {
  return roughness >= WIDE_ROUGHNESS && field->bricks.header && settings->hits == OLX_HITS_SHADED;
}

static float wrap(float x) { return x < 1.0f ? x : x - 1.0f; }

// Returns point i of Hammersley's set, moved by `random` around the unit square.
static olx_vec2 point_of(uint32_t i, uint32_t count, olx_vec2 random) {
  return (olx_vec2){wrap(random.x + (float)i / (float)count), wrap(random.y + olx_unit_float(olx_reverse_bits(i)))};
}

olx_lobe_light olx_lobe_look_up(const olx_field *field, const olx_sample_settings *settings,
                                const olx_lobe_surface *surface, uint32_t count, olx_vec2 random) {
  const lobe_probes probes = probes_near(field, settings, surface->position);
  const uint32_t seed = olx_hash3(olx_float_bits(random.x), olx_float_bits(random.y), SALT);
  const olx_vec3 from = surface->position, first = probes.count ? field->probe_positions[probes.probes[0]] : from;
  olx_lobe_light sum = {.light = olx_splat(0.0f)};
  float guess = olx_length(olx_sub(first, from));
  uint32_t unknown = 0;
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec2 drawn = point_of(i, count, random);
    olx_vec3 direction;
    float weight, half_cosine;
    olx_trace_hit hit;
    if (!olx_glossy_draw(surface->normal, surface->view, surface->roughness, drawn, &direction, &weight,
                         &half_cosine)) {
      continue;
    }
    const olx_vec3 reflectance = olx_scale(olx_fresnel(&surface->bsdf, half_cosine), weight / (float)count);
    if (find(field, &probes, from, direction, guess, &hit)) {
      shade(field, direction, &hit);
      look_further(field, &probes, direction, drawn, &hit);
      sum.light = olx_add(sum.light, olx_mul(reflectance, olx_light_found(settings, &hit, from)));
      if (hit.status == OLX_TRACE_HIT) guess = hit.distance_metres;
      continue;
    }
    // Each of the directions that no map resolves is the one to be traced with the same probability.
    unknown++;
    if (olx_unit_float(olx_hash2(seed, i)) * (float)unknown >= 1.0f) continue;
    sum.traces = true;
    sum.direction = direction;
    sum.reflectance = reflectance;
    sum.random = drawn;
  }
  sum.reflectance = olx_scale(sum.reflectance, (float)unknown);
  return sum;
}
