// Rows of relighting: packed formats, maps without a field, rays to lights, shares of surfels in texels.
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

// Returns a point of a surface near a lamp, which faces away half of the time.
olx_gpu_lamp_point some_lamp_point() {
  return olx_gpu_lamp_point(vec4(point + view * item.v[15], 0.0), vec4(-direction, 0.01), vec4(abs(view), 1.0));
}

void put_ray(bool lit, olx_light_ray ray) {
  put(lit);
  if (lit) put(ray.direction), put(ray.length_metres), put(ray.irradiance);
}

void put_bilinear(olx_bilinear b) {
  for (uint k = 0u; k < 4u; k++) put(b.texel[k]), put(b.weight[k]);
}

// Returns a brightness for a surface that is seen from behind one time in eight.
float some_brightness() {
  vec3 normal = olx_normal_unpack(bits.z & 0xFEFEu), view = olx_from_basis(olx_sample_cosine(random.xy), normal);
  vec2 bytes = vec2(bits.x & 0xFFu, bits.x >> 8 & 0xFFu) * (1.0 / 255.0);
  return olx_specular_brightness(normal, bytes.x, bytes.y, bits.w % 8u != 0u ? view : -view,
                                 olx_from_basis(olx_sample_cosine(random.zw), normal));
}

vec4 some_corners() { return olx_site_corners(bits.yz % OLX_RELIGHT_BLOCK); }

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
  case ROW_olx_half_pack: put(olx_half_pack(uintBitsToFloat(bits.x))); break;
  case ROW_olx_rgb9e5_pack: put(olx_rgb9e5_pack(point * exp2(float(bits.x % 40u) - 20.0))); break;
  case ROW_olx_bilinear_at: put_bilinear(olx_bilinear_at(random.xy, n)); break;
  }
}

void relight_rows() {
  olx_light_ray ray;
  bool lit;
  vec3 normal = (bits.z & 1u) != 0u ? direction : -direction;
  switch (row) {
  case ROW_olx_light_varies: put(olx_light_varies(some_light(bits.x % 6u))); break;
  case ROW_olx_spot_falloff: put(olx_spot_falloff(some_light(OLX_LIGHT_SPOT), random.z)); break;
  case ROW_olx_point_light:
    lit = olx_point_light(some_light(1u + (bits.x & 1u)), point, normal, ray), put_ray(lit, ray);
    break;
  case ROW_olx_area_light:
    lit = olx_area_light(some_light(3u + (bits.x & 1u)), point, normal, random.zw, ray), put_ray(lit, ray);
    break;
  case ROW_olx_aim: lit = olx_aim(some_light(bits.x % 6u), point, normal, random.zw, ray), put_ray(lit, ray); break;
  case ROW_olx_aim_near: lit = olx_aim_near(some_lamp_point(), point, normal, ray), put_ray(lit, ray); break;
  case ROW_olx_tile_texel: put(uvec3(olx_tile_texel(bits.x % 1024u, 32u), 0u)); break;
  case ROW_olx_site_corners:
    for (uint k = 0u; k < 4u; k++) put(some_corners()[k]);
    break;
  case ROW_olx_site_weight: put(olx_site_weight(bits.x, some_corners())); break;
  case ROW_olx_irradiance_scale: put(olx_irradiance_scale(bits.x % 9u)); break;
  case ROW_olx_half_pack_finite: put(olx_half_pack_finite(uintBitsToFloat(bits.x & 0x7F7FFFFFu))); break;
  case ROW_olx_specular_brightness: put(some_brightness()); break;
  }
}

void main() {
  begin();
  number_rows();
  relight_rows();
}
