// Rows of a ray against one probe after another.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

olx_search search;

void derive_search() {
  olx_probe_answer answer = olx_probe_answer(OLX_TRACE_UNKNOWN, 0.0, ivec2(0), 0.0, 0u);
  float t_max = min(item.v[14], olx_leave_bounds(point, direction));
  search = olx_search(settings, point, direction, 0.0, t_max, 0.0, 0u, uvec4(0u), 0u, answer, OLX_NO_PROBE);
}

void put_light(olx_trace_hit hit) { put(hit.radiance), put(hit.lobe), put(hit.emission); }

void put_hit(olx_trace_hit hit) {
  put(hit.status), put(hit.probe), put(hit.emitter), put(hit.texel_steps), put(hit.probes_tried);
  put(hit.distance_metres), put(hit.position), put(hit.normal), put_light(hit), put(hit.footprint_metres);
}

void put_answer(olx_probe_answer a) { put(a.status), put_texel(a.texel), put(a.steps), put(a.t), put(a.gap); }

// Makes a search that has just begun, or one that has tried some probes and lost the ray somewhere.
void ask_some() {
  if ((bits.y & 1u) == 0u) return;
  for (uint i = 0u; i < 3u; i++) olx_remember(search, bits[i] >> 12 & 15u);
  search.t = search.lost = 0.5 * random.y;
}

bool has_bricks() { return olx_select_available(OLX_SELECT_BRICKS); }

olx_trace_hit lit_hit(uint hits) {
  olx_trace_hit hit = olx_unknown_hit(OLX_TRACE_HIT, 0.0);
  hit.position = point;
  hit.probe = probe;
  hit.texel = texel;
  search.settings.hits = hits;
  olx_read_light(search, bits.z % 2u == 0u, hit);
  return hit;
}

void search_rows() {
  derive_search();
  uint last = bits.z % olx_field.probe_count;
  float t_max = item.v[14];
  switch (row) {
  case ROW_olx_usable: put(olx_usable(search, probe)); break;
  case ROW_olx_is_ray: put(olx_is_ray(point, direction * (0.85 + 0.3 * random.x), random.y - 0.1)); break;
  case ROW_olx_was_asked:
    for (uint i = 0u; i < 4u; i++) olx_remember(search, bits[i] & 127u);
    put(olx_was_asked(search, bits.x >> 8 & 127u)), put(olx_was_asked(search, bits.x & 127u));
    break;
  case ROW_olx_remember:
    olx_remember(search, bits.x), put(search.attempts), put(search.asked.xyz), put(search.asked.w);
    break;
  case ROW_olx_ray_point: put(olx_ray_point(search, random.x)); break;
  case ROW_olx_line_distance_squared: put(olx_line_distance_squared(search, probe)); break;
  case ROW_olx_sees: put(olx_sees(search, probe)); break;
  case ROW_olx_probe_sees:
    put(olx_probe_sees(probe, point, random.x, (bits.x & 1u) != 0u ? direction : vec3(0.0)));
    break;
  case ROW_olx_ask:
    put(olx_ask(search, probe)), put(search.attempts), put(search.t), put(search.lost), put_answer(search.answer);
    break;
  case ROW_olx_first_corner: put(olx_first_corner(search, olx_cage_at(olx_field.grid, point))); break;
  case ROW_olx_next_corner: ask_some(), put(olx_next_corner(search)); break;
  case ROW_olx_next_neighbour: ask_some(), put(has_voronoi() ? olx_next_neighbour(search, last) : 0u); break;
  case ROW_olx_best_that_sees: ask_some(), put(olx_best_that_sees(search, (bits.x & 1u) != 0u || !has_bricks())); break;
  case ROW_olx_next_probe: ask_some(), put(olx_next_probe(search, (bits.x & 1u) != 0u, last)); break;
  case ROW_olx_search_probes:
    put(olx_search_probes(search)), put(search.attempts), put(search.t), put(search.answered);
    break;
  case ROW_olx_bricks_list: put(has_bricks() ? olx_bricks_list(point) : 0u); break;
  case ROW_olx_bricks_probe: put(has_bricks() ? olx_bricks_probe(olx_bricks_list(point), bits.x & 7u) : 0u); break;
  case ROW_olx_sky_radiance: put(olx_sky_radiance(direction)); break;
  case ROW_olx_describe:
    search.answer = olx_probe_answer(bits.y % 3u, random.x, texel, 0.0, 0u);
    search.answered = probe;
    put_hit(olx_describe(search, t_max, bits.z % 2u == 0u));
    break;
  case ROW_olx_read_light: {
    olx_trace_hit hit = lit_hit(settings.hits);
    put(hit.emitter), put_light(hit);
  } break;
  case ROW_olx_unknown_hit: {
    olx_trace_hit hit = olx_unknown_hit(OLX_TRACE_UNKNOWN, 0.0);
    put(hit.status), put(hit.probe), put(hit.emitter), put(hit.distance_metres), put_light(hit);
  } break;
  case ROW_olx_leave_bounds: put(olx_leave_bounds(point, direction)); break;
  case ROW_olx_trace: put_hit(olx_trace(settings, point, direction, t_max)); break;
  }
}

void main() {
  begin();
  search_rows();
}
