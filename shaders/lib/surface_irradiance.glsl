// Twin of src/shade/surface_irradiance.c: interpolates diffuse light of static surfaces from those probes near a point
// that see its own surface, else a surface close to it. The C code sorts all probes before it reads them; here they are
// found two at a time, because a list would lie in memory.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_SURFACE_IRRADIANCE_GLSL
#define OLX_SURFACE_IRRADIANCE_GLSL

#include "bilinear.glsl"
#include "bricks.glsl"
#include "components.glsl"
#include "irradiance.glsl"
#include "texels.glsl"
#include "volume_irradiance.glsl"

// Sources of light, as bits.
const uint OLX_SOURCE_TEXELS = 1u, OLX_SOURCE_VOLUME = 2u, OLX_SOURCE_PROBES = 4u;

const uint OLX_NO_PLACE = 0xFFFFFFFFu;

// Two probes among those near a point or among all.
struct olx_ranking {
  uint better, worse; // places; OLX_NO_PLACE: there are no more probes
  float least;        // weight of the second (olx_rank_weight)
};

// A point relative to a probe.
struct olx_probe_view {
  ivec3 map;
  vec3 offset; // from the probe
  vec3 normal; // geometric
  float angle; // side of a texel there, in radians
  float miss;  // how far the point may miss a texel's surface, in footprints
};

// One of the four texels around the direction in which a probe sees the point.
struct olx_seen_texel {
  bool seen; // false for the sky
  float distance, facing;
  vec3 normal, step;
  float away;
};

// The irradiance from those texels of one probe that see the point's surface, times their share.
struct olx_texel_light {
  vec3 sum;
  float share;
};

// The blended irradiance of some probes, and their weights.
struct olx_blend {
  uint count;
  float best;
  vec4 first, second, third, fourth;
};

struct olx_surface_light {
  vec3 irradiance; // W/m^2
  uint probes;     // number of probes that were blended; 0: nothing is stored for this surface, and the light is that
                   // of a surface close to it or of the volume
};

// Returns how well a probe sees a point; 0 when it cannot.
float olx_rank_weight(olx_sample_settings settings, vec3 position, vec3 normal, uint probe) {
  uint flags = olx_probe_flags(probe); // read in any case, so that one read brings it together with the position
  bool usable = settings.keep_buried || (flags & OLX_PROBE_BURIED) == 0u;
  precise vec3 way = olx_probe_position(probe) - position;
  float squared = olx_dot(way, way);
  precise float weight = olx_dot(way, normal) / (squared * sqrt(squared));
  return usable && weight > 0.0 && weight < OLX_INFINITY ? weight : 0.0;
}

bool olx_has_bricks() { return (olx_field.select_mask & 1u << OLX_SELECT_BRICKS) != 0u; }

// Returns the number of ranked probes: all, or those of the point's brick, or of its cage in a field without bricks.
uint olx_ranked_count(bool all) {
  if (all) return olx_field.probe_count;
  return olx_has_bricks() || olx_field.grid.count.w > 0u ? OLX_BRICK_PROBES : 0u;
}

// Returns the probe at a place among those that are ranked, or OLX_NO_PROBE; `list` and `cage` are those of the point.
uint olx_ranked_probe(bool all, uint list, olx_cage cage, uint place) {
  uint probe = place;
  if (!all && olx_has_bricks()) {
    probe = olx_bricks_probe(list, place);
    if (probe == OLX_BRICK_NO_PROBE) probe = OLX_NO_PROBE;
  } else if (!all) {
    probe = olx_cage_has(cage, place) ? olx_cage_probe(olx_field.grid, cage, place) : OLX_NO_PROBE;
  }
  return probe;
}

// Returns the best two of the probes that come after those of `before`. Of equal probes the first comes first.
olx_ranking olx_rank_next(olx_sample_settings settings, vec3 position, vec3 normal, bool all, uint list,
                          olx_ranking before) {
  olx_cage cage = olx_cage_at(olx_field.grid, position);
  olx_ranking next = olx_ranking(OLX_NO_PLACE, OLX_NO_PLACE, 0.0);
  float most = 0.0;
  uint count = olx_ranked_count(all);
  for (uint i = 0u; i < count; i++) {
    uint probe = olx_ranked_probe(all, list, cage, i);
    float weight = probe != OLX_NO_PROBE ? olx_rank_weight(settings, position, normal, probe) : 0.0;
    bool after = weight < before.least || (weight == before.least && i > before.worse);
    if (after && weight > most) {
      next = olx_ranking(i, next.better, most);
      most = weight;
    } else if (after && weight > next.least) {
      next.worse = i;
      next.least = weight;
    }
  }
  return next;
}

olx_probe_view olx_view_from(olx_sample_settings settings, uint probe, vec3 position, vec3 normal) {
  precise vec3 offset = position - olx_probe_position(probe);
  float angle = sqrt(olx_texel_solid_angle_near(olx_octahedral_encode(offset), olx_field.n));
  return olx_probe_view(olx_map_origin(probe), offset, normal, angle, OLX_SURFACE_MISS + settings.surface_tolerance);
}

// Returns the way to the point from the place `distance` metres along the ray through the middle of a texel, which may
// be of the border.
vec3 olx_texel_step(olx_probe_view v, ivec2 texel, float distance) {
  vec3 centre = olx_texel_direction(uvec2(olx_border_source(texel, int(olx_field.n))), olx_field.n);
  precise vec3 way = v.offset - centre * distance;
  return way;
}

// Reads a texel, which may be of the border.
olx_seen_texel olx_see_texel(olx_probe_view v, ivec2 texel) {
  olx_seen_texel t;
  olx_texel_geometry seen = olx_texel_geometry_of(v.map, texel);
  float distance = seen.distance;
  t.seen = distance < OLX_INFINITY;
  t.distance = t.seen ? distance : 0.0;
  vec3 centre = olx_texel_direction(uvec2(olx_border_source(texel, int(olx_field.n))), olx_field.n);
  t.normal = seen.normal;
  t.facing = -olx_dot(t.normal, centre);
  t.step = olx_texel_step(v, texel, t.distance);
  t.away = sqrt(olx_dot(t.step, t.step));
  return t;
}

// Returns how far packing may move the point off the texel's surface, in metres.
float olx_packing_error(olx_seen_texel t) {
  return OLX_DISTANCE_ERROR * t.distance * abs(t.facing) + OLX_STORED_NORMAL_ERROR * t.away;
}

// Returns 1 where the texel sees the surface on which the point lies, 0 where it does not, and values between where
// that is uncertain, so that light changes smoothly as the point moves.
float olx_texel_agrees(olx_probe_view v, olx_seen_texel t) {
  float agreement = olx_dot(t.normal, v.normal), footprint = t.distance * v.angle;
  float height = abs(olx_dot(t.normal + v.normal, t.step)) * (1.0 / (1.5 + 0.5 * agreement));
  float along = t.away * t.away - height * height;
  float alike = min((agreement - OLX_LEAST_AGREEMENT) / (OLX_FULL_AGREEMENT - OLX_LEAST_AGREEMENT), 1.0);
  float flat_error = v.miss * footprint + olx_packing_error(t);
  float half_turn = sqrt(0.5 * max(1.0 - agreement, 0.0));
  float allowed = flat_error + half_turn * t.away;
  float fits = 2.0 * height <= flat_error ? 1.0 : clamp(2.0 - 2.0 * height / allowed, 0.0, 1.0);
  bool near = along * olx_square(t.facing) <= olx_square(OLX_SURFACE_REACH * footprint);
  return t.seen && near && t.facing > OLX_LEAST_FACING && agreement > OLX_LEAST_AGREEMENT ? fits * alike : 0.0;
}

// Returns how much light of a texel, whose surface is `way` from the point, reaches the point past a neighbouring texel
// that sees a different surface with this normal: the point is `height` above it, which packing moves by `allowed`.
float olx_passes(vec3 way, vec3 normal, float height, float allowed) {
  bool before = !(height < -allowed) || height - olx_dot(normal, way) <= allowed;
  return before ? 1.0 : max(2.0 + height / allowed, 0.0);
}

// Of the four texels only weights and distances are kept, and each is decoded at one place in a loop, so that few
// registers are live. Those that see another surface are decoded again, each once.
olx_texel_light olx_read_texels(olx_sample_settings settings, uint probe, vec3 position, vec3 normal) {
  olx_probe_view v = olx_view_from(settings, probe, position, normal);
  olx_bilinear around = olx_bilinear_at(olx_octahedral_encode(v.offset), olx_field.n);
  uint stride = olx_field.n + 2u;
  ivec2 at = ivec2(around.texel.x % stride, around.texel.x / stride) - 1;
  vec4 weight = around.weight, distance = vec4(0.0);
  uint others = 0u; // a bit for each texel that sees another surface
  for (int i = 0; i < 4; i++) {
    olx_seen_texel t = olx_see_texel(v, at + ivec2(i & 1, i >> 1));
    float agrees = olx_texel_agrees(v, t);
    weight *= olx_replace(vec4(1.0), i, agrees);
    distance = olx_replace(distance, i, t.distance);
    if (t.seen && !(agrees > 0.0)) others |= 1u << i;
  }
  uint own = olx_positive(weight);
  if (own == 0u) others = 0u;
  for (int k = 0; others >> k != 0u; k++) {
    if ((others >> k & 1u) == 0u) continue;
    olx_seen_texel other = olx_see_texel(v, at + ivec2(k & 1, k >> 1));
    float height = olx_dot(other.normal, other.step), allowed = olx_packing_error(other);
    for (int i = 0; own >> i != 0u; i++) {
      vec3 way = olx_texel_step(v, at + ivec2(i & 1, i >> 1), olx_component(distance, i));
      weight *= olx_replace(vec4(1.0), i, olx_passes(way, other.normal, height, allowed));
    }
  }
  own = olx_positive(weight);
  vec3 sum = vec3(0.0);
  for (int i = 0; own >> i != 0u; i++) {
    ivec2 texel = olx_border_source(at + ivec2(i & 1, i >> 1), int(olx_field.n));
    float share = olx_component(weight, i);
    if (share > 0.0) sum += olx_texel_indirect(v.map, texel) * share;
  }
  return olx_texel_light(sum, weight.x + weight.y + weight.z + weight.w);
}

// Adds the light of a probe, unless its share is no more than rounding.
void olx_blend_add(inout olx_blend b, olx_texel_light light, float rank_weight) {
  if (light.share >= OLX_LEAST_TEXEL_SHARE) {
    vec4 added = vec4(light.sum / light.share, rank_weight * light.share);
    b.first = b.count == 0u ? added : b.first;
    b.second = b.count == 1u ? added : b.second;
    b.third = b.count == 2u ? added : b.third;
    b.fourth = b.count == 3u ? added : b.fourth;
    b.best = max(b.best, added.w);
    b.count++;
  }
}

// Gathers the light that is stored for the point's surface or, where none is, for surfaces close before or behind it,
// as probes near the point see them; `stored` tells whether it is of the point's own surface.
olx_blend olx_gather(olx_sample_settings settings, vec3 position, vec3 normal, out bool stored) {
  olx_blend b = olx_blend(0u, 0.0, vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  stored = true;
  bool exhaustive = settings.select == OLX_SELECT_EXHAUSTIVE, all = exhaustive;
  uint most = min(settings.max_probes, OLX_MOST_RANKED), tried = 0u;
  olx_ranking ranking = olx_ranking(0u, 0u, OLX_INFINITY);
  bool searching = most > 0u;
  while (searching) {
    uint list = olx_has_bricks() && !all ? olx_bricks_list(position) : 0u;
    uint place = ranking.worse, probe = OLX_NO_PROBE;
    if (tried % 2u == 0u) {
      ranking = olx_rank_next(settings, position, normal, all, list, ranking);
      place = ranking.better;
      ranking.better = 0u; // so that compilers do not keep it
    }
    if (place != OLX_NO_PLACE) {
      probe = olx_ranked_probe(all, list, olx_cage_at(olx_field.grid, position), place);
    }
    float weight = probe != OLX_NO_PROBE ? olx_rank_weight(settings, position, normal, probe) : 0.0;
    bool more = weight > OLX_BLEND_ABOVE * b.best;
    if (more) {
      olx_sample_settings allowed = settings;
      allowed.surface_tolerance += stored ? 0.0 : OLX_NEAR_SURFACE;
      olx_blend_add(b, olx_read_texels(allowed, probe, position, normal), weight);
      tried++;
      more = tried < most && (tried < OLX_MOST_FAR || exhaustive || !all) && b.count < OLX_MOST_BLENDED;
    }
    if (!more) { // search all probes where none nearby sees the surface, then those nearby for surfaces close to it
      searching = stored && b.count == 0u;
      if (searching && all) stored = false;
      all = !all;
      tried = 0u;
      ranking = olx_ranking(0u, 0u, OLX_INFINITY);
    }
  }
  return b;
}

olx_surface_light olx_mix(olx_blend b) {
  vec4 weight = vec4(b.first.w, b.second.w, b.third.w, b.fourth.w) / b.best - OLX_BLEND_ABOVE;
  weight = max(weight, vec4(0.0));
  vec3 sum = b.first.xyz * weight.x + b.second.xyz * weight.y + b.third.xyz * weight.z + b.fourth.xyz * weight.w;
  uvec4 counts = uvec4(greaterThan(weight, vec4(0.0)));
  return olx_surface_light(sum / (weight.x + weight.y + weight.z + weight.w),
                           counts.x + counts.y + counts.z + counts.w);
}

// Returns irradiance for two normals where nothing is stored, from the given sources: the irradiance volume, and
// irradiance probes where the volume has no cell. For the second normal, the volume's light omits the share from below
// a surface with the first normal.
mat2x3 olx_fallen_back(olx_sample_settings settings, uint sources, vec3 position, vec3 geometric_normal, vec3 from,
                       vec3 to, vec3 view) {
  mat2x3 irradiance = mat2x3(0.0);
  bool found = false;
  if ((sources & OLX_SOURCE_VOLUME) != 0u && olx_has_volume()) {
    found = olx_volume_both(position, geometric_normal, from, to, irradiance);
  }
  if (!found && (sources & OLX_SOURCE_PROBES) != 0u) {
    irradiance = olx_irradiance_both(settings, position, from, to, view);
  }
  return irradiance;
}

// Returns the light that texels store for a point of a surface, where the given OLX_SOURCE_* include them; `stored`
// tells whether there is any.
olx_surface_light olx_stored_light(olx_sample_settings settings, uint sources, vec3 position, vec3 geometric_normal,
                                   out bool stored) {
  olx_surface_light light = olx_surface_light(vec3(0.0), 0u);
  bool finite = olx_finite(position) && olx_finite(geometric_normal);
  if (!finite || (sources & OLX_SOURCE_TEXELS) == 0u) settings.max_probes = 0u;
  bool own;
  olx_blend b = olx_gather(settings, position, geometric_normal, own);
  stored = b.count > 0u;
  if (stored) light = olx_mix(b);
  if (!own) light.probes = 0u;
  return light;
}

float olx_change(float from, float to) {
  return from > 0.0 ? min(to / from, OLX_MOST_CHANGE) : to > 0.0 ? OLX_MOST_CHANGE : 1.0;
}

// Returns a surface's light after a normal map has bent its normal by an angle with this cosine, where `around` is the
// light of other sources for both normals: it changes as theirs does, as far as that is as bright as the surface's own,
// and else as light does that is even over the hemisphere.
vec3 olx_bend(vec3 light, mat2x3 around, float cosine) {
  float own = olx_luminance(light), other = olx_luminance(around[0]), brighter = max(own, other);
  float alike = brighter > 0.0 ? min(own, other) / brighter : 0.0, even = 0.5 + 0.5 * clamp(cosine, -1.0, 1.0);
  vec3 change = vec3(olx_change(around[0].x, around[1].x), olx_change(around[0].y, around[1].y),
                     olx_change(around[0].z, around[1].z));
  return light * (even + (change - even) * alike);
}

// Completes the result of olx_stored_light: where nothing is stored, light comes from the other sources; where a normal
// map bends the normal, stored light changes with it.
olx_surface_light olx_complete_light(olx_sample_settings settings, uint sources, olx_surface_light light, bool stored,
                                     vec3 position, vec3 geometric_normal, vec3 vertex_normal, vec3 shading_normal,
                                     vec3 view) {
  bool finite = olx_finite(position) && olx_finite(geometric_normal) && olx_finite(vertex_normal) &&
                olx_finite(shading_normal) && olx_finite(view);
  vec3 bent = shading_normal - vertex_normal;
  if (finite && (!stored || olx_dot(bent, bent) > 1e-6)) {
    vec3 from = stored ? vertex_normal : shading_normal;
    float cosine = olx_dot(vertex_normal, shading_normal);
    mat2x3 e = olx_fallen_back(settings, sources, position, geometric_normal, from, shading_normal, view);
    light.irradiance = stored ? olx_bend(light.irradiance, e, cosine) : e[1];
  }
  if (!finite) light = olx_surface_light(vec3(0.0), 0u); // WebGL has no ?: of structures
  return light;
}

// Returns irradiance in W/m^2 at a point of a surface, from the given OLX_SOURCE_*. Directions are unit vectors;
// normals are on the side towards the eye: that of the triangle, that interpolated over it, and that bent by a normal
// map.
olx_surface_light olx_surface_light_from(olx_sample_settings settings, uint sources, vec3 position,
                                         vec3 geometric_normal, vec3 vertex_normal, vec3 shading_normal, vec3 view) {
  bool stored;
  olx_surface_light light = olx_stored_light(settings, sources, position, geometric_normal, stored);
  return olx_complete_light(settings, sources, light, stored, position, geometric_normal, vertex_normal,
                            shading_normal, view);
}

// Returns the source for places without stored light: the irradiance volume, or irradiance probes where the field has
// none.
uint olx_volume_source() { return olx_has_volume() ? OLX_SOURCE_VOLUME : OLX_SOURCE_PROBES; }

// Returns the irradiance of texels, or of the volume where no texel sees the surface.
olx_surface_light olx_surface_light_at(olx_sample_settings settings, vec3 position, vec3 geometric_normal,
                                       vec3 vertex_normal, vec3 shading_normal, vec3 view) {
  return olx_surface_light_from(settings, OLX_SOURCE_TEXELS | olx_volume_source(), position, geometric_normal,
                                vertex_normal, shading_normal, view);
}

// Returns the indirect irradiance in W/m^2 anywhere in free space, for moving objects, as olx_volume_irradiance in
// octalux/sample.h describes.
vec3 olx_volume_irradiance(vec3 position, vec3 normal) {
  bool finite = olx_finite(position) && olx_finite(normal);
  vec3 irradiance = vec3(0.0);
  if (finite) {
    irradiance = olx_fallen_back(olx_sample_settings_default(), olx_volume_source(), position, normal, normal, normal,
                                 normal)[0];
  }
  return irradiance;
}

// Returns the indirect irradiance in W/m^2 on a static surface, from the light that the field stores for surfaces, as
// olx_surface_irradiance in octalux/sample.h describes. For moving objects use olx_volume_irradiance. Relighting renews
// what both read, and not the irradiance probes of olx_irradiance.
vec3 olx_surface_irradiance(olx_sample_settings settings, vec3 position, vec3 geometric_normal, vec3 shading_normal,
                            vec3 view) {
  return olx_surface_light_at(settings, position, geometric_normal, geometric_normal, shading_normal, view).irradiance;
}

#endif
