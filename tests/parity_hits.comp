// Rows of light at the end of a ray: values of texels, lights, texel shading and the further ray.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

// Returns a surface whose light is computed, not stored.
olx_texel_surface some_surface() {
  return olx_texel_surface(olx_texel_material(olx_map_origin(probe), texel), point, direction, view,
                           max(abs(olx_dot(direction, view)), 1e-3), abs(view));
}

// Returns one of the field's lights, or a random one in a field without lights.
olx_field_light some_light() {
  olx_field_light light =
      olx_field_light(bits.x % 3u, view, direction, abs(view), 0.5 + 0.4 * random.x, 0.4 * random.y);
  if (olx_field.light_count > 0u) light = olx_field_light_at(bits.y % olx_field.light_count);
  return light;
}

// Returns a hit that a ray, or its reflection, might have found in the texel.
olx_trace_hit some_hit(uint status) {
  olx_trace_hit hit = olx_unknown_hit(status, item.v[15]);
  hit.position = point;
  hit.normal = direction;
  hit.lobe = (bits.w & 0x70000u) != 0u ? abs(view) : vec3(0.0);
  hit.radiance = abs(direction) + hit.lobe;
  hit.emission = abs(direction.yzx);
  hit.probe = (bits.w & 0x80000u) != 0u || status == OLX_TRACE_HIT ? probe : OLX_NO_PROBE;
  hit.texel = texel;
  hit.footprint_metres = 0.1 * random.w;
  return hit;
}

void hits_rows() {
  switch (row) {
  case ROW_olx_rgb9e5_unpack: put(olx_rgb9e5_unpack(bits.w)); break;
  case ROW_olx_texel_material: {
    olx_bsdf b = olx_texel_material(olx_map_origin(probe), texel);
    put(b.albedo), put(b.f0), put(b.f90), put(b.dielectric_weight), put(b.alpha);
  } break;
  case ROW_olx_surface_at: {
    ivec3 at = olx_surface_at(olx_map_origin(probe), texel, olx_field.tile_words.w, olx_field.tile_blocks.w);
    put(at.z < 0 ? ivec3(-1) : at);
    } break;
  case ROW_olx_texel_direct: put(olx_texel_direct(olx_map_origin(probe), texel)); break;
  case ROW_olx_texel_emission: put(olx_texel_emission(probe, texel)); break;
  case ROW_olx_word_vector:
    put(olx_field.light_count > 0u ? olx_word_vector(olx_field.lights_first + 7u) : vec3(0.0));
    break;
  case ROW_olx_field_light_at: {
    olx_field_light l = some_light();
    put(l.type), put(l.position), put(l.direction), put(l.emission), put(l.cosine_inner), put(l.cosine_outer);
  } break;
  case ROW_olx_field_light_cone: put(olx_field_light_cone(some_light(), 2.0 * random.z - 1.0)); break;
  case ROW_olx_field_light_arrival: {
    olx_light_arrival a = olx_field_light_arrival(some_light(), point);
    put(a.direction), put(a.irradiance);
  } break;
  case ROW_olx_highlight: put(olx_highlight(some_surface(), view, random.x)); break;
  case ROW_olx_light_of_lamps: {
    olx_possible_light lamps = olx_light_of_lamps(some_surface());
    put(lamps.irradiance), put(lamps.specular);
  } break;
  case ROW_olx_share_within: put(olx_share_within(abs(direction), vec3(random.x, 0.0, random.y))); break;
  case ROW_olx_likely_share: put(olx_likely_share(random.x)); break;
  case ROW_olx_texel_shade: {
    olx_reflection light = olx_texel_shade(olx_map_origin(probe), texel, point, direction, bits.x % 3u == 0u);
    put(light.reflected), put(light.lobe);
  } break;
  case ROW_olx_further_draw: {
    olx_further_ray ray;
    bool drawn = olx_further_draw(some_hit(OLX_TRACE_HIT), -view, random.xy, ray);
    put(drawn);
    if (drawn) put(ray.origin), put(ray.direction), put(ray.weight);
  } break;
  case ROW_olx_further_light: {
    olx_trace_hit first = some_hit(OLX_TRACE_HIT);
    olx_further_ray ray = olx_further_ray(point - direction * (random.x - 0.5), view, random.xyz);
    put(first.radiance - first.lobe + olx_further_light(first.lobe, ray, some_hit(bits.z % 3u)));
  } break;
  }
}

void main() {
  begin();
  hits_rows();
}
