// Relighting: packed formats, maps without a field, rays to lights, corrections.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"
#include "shaders/lib/relight.glsl"

olx_gpu_light some_light(uint type) {
  bool area = type == OLX_LIGHT_RECT || type == OLX_LIGHT_TRIANGLE;
  return olx_gpu_light(vec4(abs(view), 0.0), vec4(point + view * item.v[15], 0.0),
                       vec4(area ? direction * 0.5 : direction, 0.0), vec4(view.yzx * 0.4, 0.0), type, bits.y & 1u,
                       random.x, random.x - 0.5 * random.y);
}

olx_surface_view some_view(vec3 place, vec3 normal) {
  return olx_surface_view(place, normal, vec3(0.0), vec3(0.0), 2.0 * random.z);
}

void put_ray(bool lit, olx_light_ray ray) {
  put(lit);
  if (lit) put(ray.direction), put(ray.length_metres), put(ray.irradiance);
}

void put_bilinear(olx_bilinear b) {
  for (uint k = 0u; k < 4u; k++) put(b.texel[k]), put(b.weight[k]);
}

float other_cell(uint cell) { return olx_unit_float(olx_hash2(cell, bits.y)); }

float penalty(uint cell) {
  uint neighbours[6], count = olx_correction_neighbours(cell, neighbours);
  float sum = other_cell(cell) * OLX_SIZE_PENALTY;
  for (uint k = 0u; k < count; k++) sum += (other_cell(cell) - other_cell(neighbours[k])) * OLX_SMOOTHNESS_PENALTY;
  return sum;
}

void number_rows() {
  uint n = 8u << (bits.w & 3u);
  ivec2 at = ivec2(bits.yz % (n + 2u)) - 1;
  switch (row) {
  case ROW_olx_hash3: put(olx_hash3(bits.x, bits.y, bits.z)); break;
  case ROW_olx_sample_triangle: put(olx_sample_triangle(random.xy)); break;
  case ROW_olx_luminance: put(olx_luminance(point)); break;
  case ROW_olx_texel_direction: put(olx_texel_direction(bits.yz % n, n)); break;
  case ROW_olx_border_source: put(olx_border_source(at, int(n))); break;
  case ROW_olx_small_float_unpack: put(olx_small_float_unpack(bits.w & 0x7BFu, 6u)); break;
  case ROW_olx_r11g11b10f_unpack: put(olx_r11g11b10f_unpack(bits.w & 0x7BDEF7BFu)); break;
  case ROW_olx_small_float_pack: put(olx_small_float_pack(uintBitsToFloat(bits.x), 5u + (bits.y & 1u))); break;
  case ROW_olx_r11g11b10f_pack: put(olx_r11g11b10f_pack(point * exp2(float(bits.x % 40u) - 20.0))); break;
  case ROW_olx_bilinear_at: put_bilinear(olx_bilinear_at(random.xy, n)); break;
  case ROW_olx_without_border: put_bilinear(olx_without_border(olx_bilinear_at(random.xy, n), n)); break;
  }
}

void relight_rows() {
  uint n = 8u << (bits.w & 3u);
  olx_light_ray ray;
  bool lit;
  vec3 normal = (bits.z & 1u) != 0u ? direction : -direction;
  switch (row) {
  case ROW_olx_surface_direction: put(olx_surface_direction(bits.yz % n, n)); break;
  case ROW_olx_relit_albedo: put(olx_relit_albedo(bits.w & 0x7BDEF7BFu)); break;
  case ROW_olx_known_distance: put(olx_known_distance(bits.x & 0xFFFFu)); break;
  case ROW_olx_alike:
    put(olx_alike(some_view(point, direction), some_view(point + view * 0.05, normalize(direction + view * 0.1))));
    break;
  case ROW_olx_block_texel: put(olx_block_texel(bits.x % (n * n / 16u), bits.y % 16u, 4u, n)); break;
  case ROW_olx_light_varies: put(olx_light_varies(some_light(bits.x % 6u))); break;
  case ROW_olx_spot_falloff: put(olx_spot_falloff(some_light(OLX_LIGHT_SPOT), random.z)); break;
  case ROW_olx_point_light:
    lit = olx_point_light(some_light(1u + (bits.x & 1u)), point, normal, ray), put_ray(lit, ray);
    break;
  case ROW_olx_area_light:
    lit = olx_area_light(some_light(3u + (bits.x & 1u)), point, normal, random.zw, ray), put_ray(lit, ray);
    break;
  case ROW_olx_aim: lit = olx_aim(some_light(bits.x % 6u), point, normal, random.zw, ray), put_ray(lit, ray); break;
  case ROW_olx_correction_cells_at: put_bilinear(olx_correction_cells_at(random.xy)); break;
  case ROW_olx_correction_neighbours: put(1000.0 * penalty(bits.x % OLX_CORRECTION_CELLS)); break;
  }
}

void main() {
  begin();
  number_rows();
  relight_rows();
}
