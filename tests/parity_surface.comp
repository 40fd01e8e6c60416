// Rows of light on surfaces.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

void put(mat2x3 m) { put(m[0]), put(m[1]); }

// A point on a surface that a probe sees, away from the texel's middle, or in one item of eight an arbitrary point.
vec3 place, geometric, bent;

void derive_place() {
  ivec3 map = olx_map_origin(probe);
  float distance = olx_texel_distance(map, texel);
  place = point, geometric = direction;
  if ((bits.w & 7u) != 0u && distance < OLX_INFINITY) {
    geometric = olx_texel_normal(map, texel);
    precise vec3 aside = (random.xyz - 0.5) * (0.2 * distance / float(olx_field.n));
    precise vec3 at = olx_probe_position(probe) + olx_texel_direction(uvec2(texel), olx_field.n) * distance + aside;
    place = at;
  }
  bent = (bits.w & 0x10000u) != 0u ? olx_normalize(geometric + view * 0.5) : geometric;
  settings.surface_tolerance = (bits.w & 0x20000u) != 0u ? random.w : 0.0;
}

void put_ranked() {
  bool all = (bits.w & 1u) != 0u;
  uint list = olx_has_bricks() ? olx_bricks_list(place) : 0u;
  olx_cage cage = olx_cage_at(olx_field.grid, place);
  olx_ranking ranking = olx_ranking(0u, 0u, OLX_INFINITY);
  for (uint i = 0u; i < 6u; i++) {
    if (i % 2u == 0u) ranking = olx_rank_next(settings, place, geometric, all, list, ranking);
    uint at = i % 2u == 0u ? ranking.better : ranking.worse, ranked = OLX_NO_PROBE;
    if (at != OLX_NO_PLACE) ranked = olx_ranked_probe(all, list, cage, at);
    put(ranked), put(ranked != OLX_NO_PROBE ? olx_rank_weight(settings, place, geometric, ranked) : 0.0);
  }
}

void put(olx_seen_texel t) {
  put(t.seen);
  if (t.seen) put(t.distance), put(t.facing), put(t.normal), put(t.step), put(t.away);
}

void put(olx_surface_light light) { put(light.probes), put(light.irradiance); }

olx_blend some_blend() {
  olx_blend b = olx_blend(0u, 0.0, vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  for (uint i = 0u; i <= bits.z % 4u; i++) {
    olx_blend_add(b, olx_texel_light(abs(direction) + float(i), i == 1u ? 1e-6 : random[i]), random[(i + 1u) % 4u]);
  }
  return b;
}

void surface_rows() {
  uint corner = bits.x >> 16;
  ivec2 first = texel - ivec2(corner & 1u, corner >> 1 & 1u);
  olx_probe_view v = olx_view_from(settings, probe, place, geometric);
  switch (row) {
  case ROW_olx_texel_indirect: put(olx_texel_indirect(olx_map_origin(probe), texel)); break;
  case ROW_olx_rank_weight: put(olx_rank_weight(settings, place, geometric, probe)); break;
  case ROW_olx_has_bricks: put(olx_has_bricks()); break;
  case ROW_olx_ranked_count: put(olx_ranked_count(false)), put(olx_ranked_count(true)); break;
  case ROW_olx_ranked_probe: {
    uint in_list = bits.z % olx_ranked_count(false), any = bits.z % olx_field.probe_count;
    olx_cage cage = olx_cage_at(olx_field.grid, place);
    uint list = olx_has_bricks() ? olx_bricks_list(place) : 0u;
    put(olx_ranked_probe(false, list, cage, in_list)), put(olx_ranked_probe(true, list, cage, any));
  } break;
  case ROW_olx_rank_next: put_ranked(); break;
  case ROW_olx_view_from: put(v.offset), put(v.normal), put(v.angle), put(v.miss), put(v.map); break;
  case ROW_olx_see_texel: put(olx_see_texel(v, first)); break;
  case ROW_olx_packing_error: put(olx_packing_error(olx_see_texel(v, texel))); break;
  case ROW_olx_texel_agrees: put(olx_texel_agrees(v, olx_see_texel(v, first))); break;
  case ROW_olx_texel_step: put(olx_texel_step(v, first, 1.0 + random.x)); break;
  case ROW_olx_passes: {
    olx_seen_texel other = olx_see_texel(v, first);
    put(olx_passes(olx_see_texel(v, texel).step, other.normal, olx_dot(other.normal, other.step),
                   olx_packing_error(other)));
  } break;
  case ROW_olx_read_texels: {
    olx_texel_light light = olx_read_texels(settings, probe, place, geometric);
    put(light.sum), put(light.share);
  } break;
  case ROW_olx_blend_add: {
    olx_blend b = some_blend();
    put(b.count), put(b.best), put(b.first.xyz), put(b.first.w), put(b.second.xyz), put(b.second.w), put(b.third.w),
        put(b.fourth.w);
  } break;
  case ROW_olx_mix: put(olx_mix(some_blend())); break;
  case ROW_olx_gather: {
    bool own;
    olx_blend b = olx_gather(settings, place, geometric, own);
    put(b.count), put(b.best), put(b.count > 0u && own);
    if (b.count > 0u) put(olx_mix(b));
  } break;
  case ROW_olx_map_irradiance_both: put(olx_map_irradiance_both(irradiance_probe, random)); break;
  case ROW_olx_irradiance_both: put(olx_irradiance_both(settings, point, direction, view, view)); break;
  case ROW_olx_change:
    put(olx_change(random.x, random.y)), put(olx_change(0.0, random.x)), put(olx_change(0.0, 0.0));
    break;
  case ROW_olx_bend: put(olx_bend(abs(direction), mat2x3(random.xyz, random.yzw), random.w)); break;
  case ROW_olx_has_volume: put(olx_has_volume()); break;
  case ROW_olx_volume_word: put(olx_has_volume() ? olx_volume_word(bits.x % 400u) : 0u); break;
  case ROW_olx_fallen_back: {
    mat2x3 e = olx_fallen_back(settings, 6u, point, direction, direction, view, view);
    put(e[0]), put(e[1]);
  } break;
  case ROW_olx_stored_light: {
    bool stored;
    olx_surface_light light = olx_stored_light(settings, bits.z & 1u, place, geometric, stored);
    put(stored), put(light);
  } break;
  case ROW_olx_complete_light:
    put(olx_complete_light(settings, olx_volume_source(), olx_surface_light(abs(direction), 2u), (bits.z & 2u) != 0u,
                           place, geometric, geometric, bent, view));
    break;
  case ROW_olx_surface_light_from:
    put(olx_surface_light_from(settings, bits.z & 1u, place, geometric, geometric, bent, view));
    break;
  case ROW_olx_volume_source: put(olx_volume_source()); break;
  case ROW_olx_volume_irradiance: put(olx_volume_irradiance(point, direction)); break;
  case ROW_olx_surface_light_at: {
    if ((bits.w & 0x40000u) != 0u) settings.max_probes = 0u;
    put(olx_surface_light_at(settings, place, geometric, geometric, bent, view));
  } break;
  case ROW_olx_replace: {
    vec4 replaced = olx_replace(random, int(bits.x & 3u), 2.0);
    put(replaced.xyz), put(replaced.w);
  } break;
  case ROW_olx_component: put(olx_component(random, int(bits.x & 3u))); break;
  case ROW_olx_positive: put(olx_positive(random - 0.5)); break;
  case ROW_olx_surface_irradiance: put(olx_surface_irradiance(settings, place, geometric, bent, view)); break;
  }
}

void main() {
  begin();
  derive_place();
  surface_rows();
}
