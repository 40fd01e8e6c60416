// Rows that read a field and select probes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

// Returns a list of nearest probes that holds one probe.
olx_nearest nearest_of(uint one) {
  olx_nearest n = olx_nearest(point, settings.keep_buried, OLX_NO_PROBE, OLX_INFINITY);
  olx_consider(n, one);
  return n;
}

void put_nearest(olx_nearest n) { put(n.probe), put(n.distance); }

void voronoi_rows() {
  uint code_bytes = olx_probe_code_bytes(olx_field.probe_count), codes = has_voronoi() ? olx_voronoi_tree() : 0u;
  olx_nearest n = nearest_of(bits.y % olx_field.probe_count);
  uvec4 choices;
  switch (row) {
  case ROW_olx_probe_code_bytes: put(olx_probe_code_bytes(bits.x % 512u)); break;
  case ROW_olx_probe_code:
    put(has_voronoi() ? olx_probe_code(code_bytes, bits.x % (codes + olx_field.probe_count)) : 0u);
    break;
  case ROW_olx_voronoi_tree: put(codes); break;
  case ROW_olx_middle: put(olx_middle(bits.x & 0xFFu, (bits.x & 0xFFu) + (bits.y & 0xFFFFu))); break;
  case ROW_olx_consider: olx_consider(n, probe), put_nearest(n); break;
  case ROW_olx_search_tree: if (has_voronoi()) olx_search_tree(n), put_nearest(n); break;
  case ROW_olx_voronoi_nearest: put(has_voronoi() ? olx_voronoi_nearest(point, settings.keep_buried) : 0u); break;
  case ROW_olx_choice_texel: put(olx_choice_texel(1.2 * random.x - 0.1, 4u << (bits.x & 3u))); break;
  case ROW_olx_voronoi_neighbours:
    choices = has_voronoi() ? olx_voronoi_neighbours(probe, direction * item.v[15]) : uvec4(0u);
    put(choices.xyz), put(choices.w);
    break;
  }
}

// Returns a block of each form, whose indices may name any plane.
uvec4 some_block() { return uvec4(bits.x % 64u, bits.yz, bits.w & 0x3FFFFFFFu | bits.x % 3u << 30); }

void put(uvec4 v) { put(v.xyz), put(v.w); }

void put_geometry(olx_texel_geometry g) { put(g.distance), put(g.distance < OLX_INFINITY ? g.normal : vec3(0.0)); }

void field_rows() {
  ivec3 map = olx_map_origin(probe);
  bool blocks = olx_geometry_in_blocks();
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, point);
  switch (row) {
  case ROW_olx_probe_position: put(olx_probe_position(probe)); break;
  case ROW_olx_irradiance_probe_position: put(olx_irradiance_probe_position(irradiance_probe)); break;
  case ROW_olx_map_corner: put(olx_map_corner(probe, olx_field.n, 3u)); break;
  case ROW_olx_map_origin: put(map); break;
  case ROW_olx_texel_towards: put_texel(olx_texel_towards(direction)); break;
  case ROW_olx_texel_distance_bits: put(blocks ? 0u : olx_texel_distance_bits(map, texel)); break;
  case ROW_olx_texel_distance: put(olx_texel_distance(map, texel)); break;
  case ROW_olx_texel_emits: put(olx_texel_emits(probe, texel)); break;
  case ROW_olx_texel_normal: put(olx_texel_normal(map, texel)); break;
  case ROW_olx_geometry_in_blocks: put(blocks); break;
  case ROW_olx_geometry_block: put(blocks ? olx_geometry_block(map, texel / 4) : uvec4(0u)); break;
  case ROW_olx_plane_in_block: put(olx_plane_in_block(some_block(), texel)); break;
  case ROW_olx_block_plane: put(blocks ? olx_block_plane(map, texel) : vec3(0.0)); break;
  case ROW_olx_block_geometry: if (blocks) put_geometry(olx_block_geometry(map, texel)); break;
  case ROW_olx_texel_geometry_of: put_geometry(olx_texel_geometry_of(map, texel)); break;
  case ROW_olx_texel_is_sky: put(olx_texel_is_sky(map, texel)); break;
  case ROW_olx_texel_emission_code: put(olx_texel_emission_code(probe, texel)); break;
  case ROW_olx_texel_radiance: put(olx_texel_radiance(map, texel)); break;
  case ROW_olx_irradiance_coordinate: put(olx_irradiance_coordinate(irradiance_probe, random.xy)); break;
  case ROW_olx_cage_at: put(cage.base), put(cage.corner_mask), put(cage.alpha); break;
  case ROW_olx_cage_has: put(olx_cage_has(cage, bits.x & 7u)); break;
  case ROW_olx_cage_probe: put(olx_cage_probe(olx_field.irradiance_grid, cage, bits.x & cage.corner_mask)); break;
  case ROW_olx_cage_weight: put(olx_cage_weight(cage, bits.x & 7u)); break;
  case ROW_olx_select_available: put(olx_select_available(bits.x % 5u)); break;
  case ROW_olx_select_resolve: put(olx_select_resolve(bits.x % 6u)); break;
  case ROW_olx_sample_settings_default:
    settings = olx_sample_settings_default();
    put(settings.tracer), put(settings.select), put(settings.visibility), put(settings.max_probes);
    put(settings.keep_buried), put(settings.emitters), put(settings.hits), put(settings.surface_tolerance);
    break;
  }
}

void main() {
  begin();
  field_rows(), voronoi_rows();
}
