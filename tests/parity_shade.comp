// Rows of irradiance and glossy light.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

void shade_rows() {
  vec3 from_probe = point - olx_irradiance_probe_position(irradiance_probe);
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, point);
  vec2 uv = olx_octahedral_encode(direction);
  uint nearest;
  vec3 drawn;
  float weight, half_cosine;
  olx_trace_hit hit;
  bool seen;
  olx_surface_point surface = olx_surface_point(point, direction, view);
  switch (row) {
  case ROW_olx_map_irradiance: put(olx_map_irradiance(irradiance_probe, random.xy)); break;
  case ROW_olx_map_moments: put(olx_map_moments(irradiance_probe, direction)); break;
  case ROW_olx_chebyshev: put(olx_chebyshev(irradiance_probe, from_probe)); break;
  case ROW_olx_visibility: put(olx_visibility(settings.visibility, irradiance_probe, from_probe, surface)); break;
  case ROW_olx_probe_weight: put(olx_probe_weight(settings.visibility, irradiance_probe, from_probe, surface)); break;
  case ROW_olx_irradiance_usable: put(olx_irradiance_usable(settings, irradiance_probe)); break;
  case ROW_olx_nearest_visible:
    seen = olx_nearest_visible(settings, surface, cage, nearest), put(seen), put(seen ? nearest : 0u);
    break;
  case ROW_olx_add_from_afar: put(olx_add_from_afar(settings, surface, cage, uv.xyxy)[0]); break;
  case ROW_olx_irradiance: put(olx_irradiance(settings, point, direction, view)); break;
  case ROW_olx_glossy_draw:
    put(olx_glossy_draw(direction, view, random.z, random.xy, drawn, weight, half_cosine));
    put(weight), put(half_cosine);
    if (weight > 0.0) put(drawn);
    break;
  case ROW_olx_glossy:
    put(olx_glossy(settings, point, direction, view, random.z, random.xy, weight, half_cosine, hit));
    put(weight), put(half_cosine), put(hit.status), put(hit.probe), put(hit.distance_metres);
    break;
  }
}

void main() {
  begin();
  shade_rows();
}
