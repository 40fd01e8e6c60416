// Rows of vectors, maps, sampling and the reflection model.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

void core_rows() {
  vec3 t, b, local_view = vec3(view.xy, abs(view.z));
  float weight, half_cosine;
  switch (row) {
  case ROW_olx_square: put(olx_square(point.x)); break;
  case ROW_olx_sign_not_zero: put(olx_sign_not_zero(direction.x)); break;
  case ROW_olx_dot: put(olx_dot(point, direction)); break;
  case ROW_olx_normalize: put(olx_normalize(bits.w % 64u == 0u ? vec3(0.0) : point)); break;
  case ROW_olx_basis: olx_basis(direction, t, b), put(t), put(b); break;
  case ROW_olx_from_basis: put(olx_from_basis(view, direction)); break;
  case ROW_olx_octahedral_encode: put(olx_octahedral_encode(direction)); break;
  case ROW_olx_octahedral_point: put(olx_octahedral_point(random.xy)); break;
  case ROW_olx_octahedral_decode: put(olx_octahedral_decode(random.xy)); break;
  case ROW_olx_texel_solid_angle_near: put(olx_texel_solid_angle_near(random.xy, 64u)); break;
  case ROW_olx_half_unpack: put(olx_half_unpack(gl_GlobalInvocationID.x * 8u + (bits.x & 7u) & 0xFFFFu)); break;
  case ROW_olx_normal_unpack: put(olx_normal_unpack(bits.x % 255u | bits.y % 255u << 8)); break;
  case ROW_olx_hash: put(olx_hash(bits.x)); break;
  case ROW_olx_hash2: put(olx_hash2(bits.x, bits.y)); break;
  case ROW_olx_unit_float: put(olx_unit_float(bits.x)); break;
  case ROW_olx_owen_scramble: put(olx_owen_scramble(bits.x, bits.y)); break;
  case ROW_olx_sobol2: put(olx_sobol2(bits.x)); break;
  case ROW_olx_stratified2: put(olx_stratified2(bits.x, bits.y)); break;
  case ROW_olx_turn: put(olx_turn(random.x)); break;
  case ROW_olx_sample_cosine: put(olx_sample_cosine(random.xy)); break;
  case ROW_olx_bsdf_make:
    put(bsdf.albedo), put(bsdf.f0), put(bsdf.f90), put(bsdf.dielectric_weight), put(bsdf.alpha);
    break;
  case ROW_olx_pow5: put(olx_pow5(random.x)); break;
  case ROW_olx_fresnel: put(olx_fresnel(bsdf, random.w)); break;
  case ROW_olx_bsdf_diffuse: put(olx_bsdf_diffuse(bsdf, random.w)); break;
  case ROW_olx_bsdf_has_specular: put(olx_bsdf_has_specular(olx_bsdf_make(point, 0.0, 0.5, float(bits.x & 1u)))); break;
  case ROW_olx_bsdf_specular_albedo: put(olx_bsdf_specular_albedo(bsdf, random.w)); break;
  case ROW_olx_ggx_lambda: put(olx_ggx_lambda(random.x, random.y)); break;
  case ROW_olx_ggx_sample_half: put(olx_ggx_sample_half(random.z, local_view, random.xy)); break;
  case ROW_olx_ggx_sample:
    put(olx_ggx_sample(bsdf.alpha, local_view, random.zw, weight, half_cosine)), put(weight), put(half_cosine);
    break;
  }
}

void main() {
  begin();
  core_rows();
}
