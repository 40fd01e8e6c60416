// Every function of shaders/lib on the inputs of test_parity.c: one row a dispatch, one thread an item.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity_rows.h"
#include "shaders/lib/denoise.glsl"
#include "shaders/lib/octalux.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint GROUP = 0; // of rows: compiling all of them at once takes long
layout(push_constant) uniform row_block { uint row; };

struct parity_item {
  float v[16];
  uint u[4];
};
layout(set = 1, binding = 0, std430) readonly buffer items_block { parity_item items[]; };
layout(set = 1, binding = 1, std430) writeonly buffer results_block { uint results[]; };

uint filled = 0u;
void put(uint x) { results[gl_GlobalInvocationID.x * PARITY_RESULTS + filled++] = x; }
void put(int x) { put(uint(x)); }
void put(bool x) { put(uint(x)); }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec2 v) { put(v.x), put(v.y); }
void put(vec3 v) { put(v.xy), put(v.z); }
void put(ivec2 v) { put(v.x), put(v.y); }
void put(uvec3 v) { put(v.x), put(v.y), put(v.z); }
void put(ivec3 v) { put(v.xy), put(v.z); }
// As C counts the texels of a bordered map.
void put_texel(ivec2 texel) { put((texel.y + 1) * int(olx_field.n + 2u) + texel.x + 1); }

// The item of this thread, and what test_parity.c derives from it in the same way.
parity_item item;
vec3 point, direction, view;
vec4 random;
uvec4 bits;
uint probe, irradiance_probe;
ivec2 texel;
olx_sample_settings settings;
olx_probe_ray ray;
olx_march march;
vec3 planes;
olx_piece piece;
olx_cell cell;
olx_surfel surfel;
olx_search search;
olx_surface_point surface;
olx_bsdf bsdf;

void derive() {
  point = vec3(item.v[0], item.v[1], item.v[2]);
  direction = vec3(item.v[3], item.v[4], item.v[5]);
  view = vec3(item.v[6], item.v[7], item.v[8]);
  random = vec4(item.v[9], item.v[10], item.v[11], item.v[12]);
  bits = uvec4(item.u[0], item.u[1], item.u[2], item.u[3]);
  probe = bits.x % olx_field.probe_count;
  irradiance_probe = bits.x % olx_field.irradiance_grid.count.w;
  texel = ivec2(bits.yz % olx_field.n);
  settings = olx_sample_settings_default();
  settings.tracer = (bits.w >> 8) % 3u;
  settings.visibility = (bits.w & 6u) != 0u;
  settings.keep_buried = (bits.w & 8u) != 0u;
  settings.emitters = (bits.w & 16u) != 0u;
  settings.select = uint[](OLX_SELECT_EXHAUSTIVE, OLX_SELECT_CAGE, OLX_SELECT_BRICKS, OLX_SELECT_VORONOI,
                           OLX_SELECT_BEST)[(bits.w >> 5) % 5u];
  surface = olx_surface_point(point, direction, view);
  bsdf = olx_bsdf_make(abs(direction), random.x, random.y, random.z);
}

void derive_march() {
  precise vec3 origin = point - olx_probe_position(probe);
  ray = olx_probe_ray(origin, direction, (bits.w & 1u) != 0u ? 0.0 : item.v[13],
                      (bits.w & 2u) != 0u ? OLX_INFINITY : item.v[14]);
  march = olx_begin_march(probe, ray);
  planes = vec3(olx_plane_at(origin.x, direction.x), olx_plane_at(origin.y, direction.y), olx_plane_at(origin.z, direction.z));
  piece = olx_make_piece(march, planes, ray.t_min, olx_next_cut(planes, ray.t_min, ray.t_max));
  cell = olx_cell(ivec2(piece.u.first, piece.v.first), piece.t_begin);
  surfel = olx_read_surfel(march, texel, item.v[15]);
}

void derive_search() {
  olx_probe_answer answer = olx_probe_answer(OLX_TRACE_UNKNOWN, 0.0, ivec2(0), 0.0, 0u);
  search = olx_search(settings, point, direction, 0.0, min(item.v[14], olx_leave_bounds(point, direction)), 0.0, 0u, 128u, 0u,
                      answer, OLX_NO_PROBE);
}

// Two pixels side by side, mostly of one surface, and what is known there.
const vec2 PICTURE = vec2(16.0, 12.0);
olx_camera_frame camera;
olx_shown here, there;
olx_incident light_here, light_there;
vec2 pixel;

void derive_denoise() {
  vec3 tangent, bitangent;
  olx_basis(direction, tangent, bitangent);
  camera = olx_camera_frame(view * 2.0, direction, tangent * (0.5 + random.x), bitangent * (0.4 + random.y));
  pixel = vec2(bits.yz % uvec2(16u, 12u));
  here = olx_shown(point, direction, item.v[15], random.x, 0.01);
  precise vec3 offset = tangent * (0.2 * random.z) + view * ((bits.w & 1u) != 0u ? 0.02 * random.w : 0.0);
  precise vec3 beside = point + offset;
  vec3 normal = olx_normalize(direction + view * (0.5 * random.y));
  there = olx_shown(beside, normal, item.v[15], random.x + 0.2 * random.y - 0.1, 0.01);
  light_here = olx_incident(abs(view), random.x - 0.1);
  light_there = olx_incident(abs(direction) * 3.0, random.y - 0.1);
  if (bits.x % 32u == 0u) light_here.light.y = uintBitsToFloat(0x7FC00000u);
  if (bits.x % 32u == 1u) light_there.light.z = OLX_INFINITY;
  if (bits.x % 32u == 2u) light_there.inverse_distance = OLX_INFINITY;
}

void put_incident(olx_incident i) { put(i.light), put(i.inverse_distance); }

void put_axis(olx_image_axis a) { put(a.begin), put(a.travel), put(a.step), put(a.ahead), put(a.first); }

void put_hit(olx_trace_hit hit) {
  put(hit.status), put(hit.probe), put(hit.emitter), put(hit.texel_steps), put(hit.probes_tried);
  put(hit.distance_metres), put(hit.position), put(hit.normal), put(hit.radiance), put(hit.footprint_metres);
}

void put_answer(olx_probe_answer a) { put(a.status), put_texel(a.texel), put(a.steps), put(a.t), put(a.gap); }

// Start from an answer that nothing has written yet.
olx_probe_answer blank() { return olx_probe_answer(OLX_TRACE_MISS, 0.0, ivec2(-1), 0.0, 0u); }

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
  case ROW_olx_sample_cosine: put(olx_sample_cosine(random.xy)); break;
  case ROW_olx_bsdf_make: put(bsdf.albedo), put(bsdf.f0), put(bsdf.f90), put(bsdf.dielectric_weight), put(bsdf.alpha); break;
  case ROW_olx_pow5: put(olx_pow5(random.x)); break;
  case ROW_olx_fresnel: put(olx_fresnel(bsdf, random.w)); break;
  case ROW_olx_bsdf_diffuse: put(olx_bsdf_diffuse(bsdf, random.w)); break;
  case ROW_olx_bsdf_has_specular: put(olx_bsdf_has_specular(olx_bsdf_make(point, 0.0, 0.5, float(bits.x & 1u)))); break;
  case ROW_olx_ggx_lambda: put(olx_ggx_lambda(random.x, random.y)); break;
  case ROW_olx_ggx_sample_half: put(olx_ggx_sample_half(random.z, local_view, random.xy)); break;
  case ROW_olx_ggx_sample:
    put(olx_ggx_sample(bsdf.alpha, local_view, random.zw, weight, half_cosine)), put(weight), put(half_cosine);
    break;
  }
}

bool has_voronoi() { return olx_select_available(OLX_SELECT_VORONOI); }

// The nearest of one probe.
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
  case ROW_olx_probe_code: put(has_voronoi() ? olx_probe_code(code_bytes, bits.x % (codes + olx_field.probe_count)) : 0u); break;
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

void field_rows() {
  ivec3 map = olx_map_origin(probe);
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, point);
  switch (row) {
  case ROW_olx_probe_position: put(olx_probe_position(probe)); break;
  case ROW_olx_irradiance_probe_position: put(olx_irradiance_probe_position(irradiance_probe)); break;
  case ROW_olx_map_corner: put(olx_map_corner(probe, olx_field.n, 3u)); break;
  case ROW_olx_map_origin: put(map); break;
  case ROW_olx_texel_towards: put_texel(olx_texel_towards(direction)); break;
  case ROW_olx_texel_distance_bits: put(olx_texel_distance_bits(map, texel)); break;
  case ROW_olx_texel_distance: put(olx_texel_distance(map, texel)); break;
  case ROW_olx_texel_emits: put(olx_texel_emits(map, texel)); break;
  case ROW_olx_texel_normal: put(olx_texel_normal(map, texel)); break;
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
    put(settings.keep_buried), put(settings.emitters);
    break;
  }
}

void march_rows() {
  derive_march();
  int n = int(olx_field.n);
  vec2 ahead = olx_crossings_ahead(piece, cell.at, 0), image = vec2(0.0);
  float t1 = olx_parameter_at(piece, min(ahead.x, ahead.y));
  float far_squared = olx_farthest_squared(march, cell.t, t1);
  olx_stand at = olx_stand(cell.at >> OLX_PYRAMID_FINEST, 0, -1.0, cell.t, false);
  olx_piece_end end = olx_end_at(march, piece.sign, ray.t_min + 0.3 * random.x);
  olx_probe_answer answer = blank();
  bool b;
  switch (row) {
  case ROW_olx_radius_squared: put(olx_radius_squared(march, random.x)); break;
  case ROW_olx_farthest_squared: put(olx_farthest_squared(march, random.x, random.x + random.y)); break;
  case ROW_olx_reach_squared: put(olx_reach_squared(march, piece, random.x, random.x + random.y)); break;
  case ROW_olx_nearest_squared: put(olx_nearest_squared(march, random.x, random.x + random.y)); break;
  case ROW_olx_clamp_texel: put(olx_clamp_texel(view.x, point.x * 8.0, n)); break;
  case ROW_olx_image_at: b = olx_image_at(march, piece, ray.t_min, image), put(b), put(image); break;
  case ROW_olx_parameter_at: put(olx_parameter_at(piece, random.x)); break;
  case ROW_olx_crossing: put(olx_crossing(piece.u, texel.x)); break;
  case ROW_olx_texel_at: put(olx_texel_at(piece.u, random.x, (bits.w & 4u) != 0u)); break;
  case ROW_olx_pyramid_shift: put(olx_pyramid_shift(int(bits.x & 3u))); break;
  case ROW_olx_pyramid_index: put(olx_pyramid_index(2u << (bits.x & 7u), bits.yz % (2u << (bits.x & 7u)))); break;
  case ROW_olx_least_squared: put(olx_least_squared(march, 0, texel >> OLX_PYRAMID_FINEST)), put(march.steps); break;
  case ROW_olx_read_surfel:
    put(surfel.distance), put(surfel.footprint), put(surfel.slack), put(surfel.cosine), put(surfel.f0), put(surfel.f1);
    break;
  case ROW_olx_plane_tolerance: put(olx_plane_tolerance(surfel)); break;
  case ROW_olx_beyond_reach: put(olx_beyond_reach(march, texel, surfel, 4.0 * random.x)), put(march.steps); break;
  case ROW_olx_supported: put(olx_supported(march, piece, cell.at, surfel, ray.t_min + 0.1 * random.x)), put(march.steps); break;
  case ROW_olx_judge_height: put(olx_judge_height(march, piece, cell, t1, surfel, answer)), put(answer.t); break;
  case ROW_olx_judge_surfel: put(olx_judge_surfel(march, piece, cell, t1, item.v[15], answer)), put_answer(answer); break;
  case ROW_olx_visit_texel:
    put(olx_visit_texel(march, piece, cell, t1, far_squared, answer)), put_answer(answer), put(march.steps);
    break;
  case ROW_olx_next_cell: cell = olx_next_cell(piece, cell, random.xy, t1), put(cell.at), put(cell.t); break;
  case ROW_olx_crossings_ahead: put(olx_crossings_ahead(piece, cell.at >> 2, 2)); break;
  case ROW_olx_march_texels: put(olx_march_texels(march, piece, answer)), put_answer(answer); break;
  case ROW_olx_march_two_level: put(olx_march_two_level(march, piece, answer)), put_answer(answer), put(march.steps); break;
  case ROW_olx_leave: olx_leave(at, at.at + ivec2(bits.xy % 5u) - 2, random.x, t1, b = true), put(at.at), put(at.level); break;
  case ROW_olx_march_node: put(olx_march_node(march, piece, at, 0.04, answer)), put_answer(answer), put(at.at); break;
  case ROW_olx_visit_first: put(olx_visit_first(march, piece, answer)), put_answer(answer); break;
  case ROW_olx_march_hiz: put(olx_march_hiz(march, piece, answer)), put_answer(answer), put(march.steps); break;
  case ROW_olx_march_piece: put(olx_march_piece(march, piece, settings.tracer, answer)), put_answer(answer); break;
  case ROW_olx_end_at: put(end.image), put(end.inverse), put(end.centre); break;
  case ROW_olx_make_axis: put_axis(olx_make_axis(point.x * 8.0, point.y * 8.0, view.x, n)); break;
  case ROW_olx_plane_at: put(olx_plane_at(point.x, direction.x)); break;
  case ROW_olx_sign_after: put(olx_sign_after(ray.origin.x, ray.direction.x, planes.x, random.x)); break;
  case ROW_olx_make_piece: put_axis(piece.u), put_axis(piece.v), put(piece.near), put(piece.slope), put(piece.rise); break;
  case ROW_olx_next_cut: put(olx_next_cut(planes, ray.t_min, ray.t_max)); break;
  case ROW_olx_begin_march: put(march.closest), put(march.miss_squared), put(march.least); break;
  case ROW_olx_trace_probe: put_answer(olx_trace_probe(probe, ray, settings.tracer)); break;
  }
}

bool has_bricks() { return olx_select_available(OLX_SELECT_BRICKS); }

void search_rows() {
  derive_search();
  olx_probe_answer answer = blank();
  uint found = 0u;
  float t_max = item.v[14];
  switch (row) {
  case ROW_olx_usable: put(olx_usable(search, probe)); break;
  case ROW_olx_is_ray: put(olx_is_ray(point, direction * (0.85 + 0.3 * random.x), random.y - 0.1)); break;
  case ROW_olx_was_asked:
    for (uint i = 0u; i < 4u; i++) olx_asked[search.attempts++] = bits[i] & 7u;
    put(olx_was_asked(search, bits.x >> 8 & 7u));
    break;
  case ROW_olx_ray_point: put(olx_ray_point(search, random.x)); break;
  case ROW_olx_line_distance_squared: put(olx_line_distance_squared(search, probe)); break;
  case ROW_olx_sees: put(olx_sees(search, probe)); break;
  case ROW_olx_probe_sees:
    put(olx_probe_sees(probe, point, random.x, (bits.x & 1u) != 0u ? direction : vec3(0.0)));
    break;
  case ROW_olx_ask: put(olx_ask(search, probe, answer)), put(search.attempts), put(search.t), put(search.lost), put_answer(answer); break;
  case ROW_olx_first_corner: put(olx_first_corner(search, olx_cage_at(olx_field.grid, point))); break;
  case ROW_olx_search_cages: put(olx_search_cages(search, found, answer)), put(search.attempts), put(search.t); break;
  case ROW_olx_bricks_list: put(has_bricks() ? olx_bricks_list(point) : 0u); break;
  case ROW_olx_bricks_probe: put(has_bricks() ? olx_bricks_probe(olx_bricks_list(point), bits.x & 7u) : 0u); break;
  case ROW_olx_next_listed: put(has_bricks() && olx_next_listed(search, found)), put(found & 0xFFFFu); break;
  case ROW_olx_search_bricks:
    put(has_bricks() && olx_search_bricks(search, found, answer)), put(search.attempts), put(search.t);
    break;
  case ROW_olx_search_voronoi:
    put(has_voronoi() && olx_search_voronoi(search, found, answer)), put(search.attempts), put(search.t);
    break;
  case ROW_olx_search_everywhere: put(olx_search_everywhere(search, found, answer)), put(search.attempts), put(search.t); break;
  case ROW_olx_search_selected: put(olx_search_selected(search, found, answer)), put(search.attempts), put(search.t); break;
  case ROW_olx_sky_radiance: put(olx_sky_radiance(direction)); break;
  case ROW_olx_describe:
    answer = olx_probe_answer(bits.y % 3u, random.x, texel, 0.0, 0u);
    put_hit(olx_describe(search, probe, answer, t_max));
    break;
  case ROW_olx_leave_bounds: put(olx_leave_bounds(point, direction)); break;
  case ROW_olx_trace: put_hit(olx_trace(settings, point, direction, t_max)); break;
  }
}

void shade_rows() {
  vec3 from_probe = point - olx_irradiance_probe_position(irradiance_probe);
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, point);
  vec2 uv = olx_octahedral_encode(direction);
  uint nearest;
  float weight, half_cosine;
  olx_trace_hit hit;
  bool seen;
  switch (row) {
  case ROW_olx_map_irradiance: put(olx_map_irradiance(irradiance_probe, random.xy)); break;
  case ROW_olx_map_moments: put(olx_map_moments(irradiance_probe, direction)); break;
  case ROW_olx_chebyshev: put(olx_chebyshev(irradiance_probe, from_probe)); break;
  case ROW_olx_visibility: put(olx_visibility(settings.visibility, irradiance_probe, from_probe, surface)); break;
  case ROW_olx_probe_weight: put(olx_probe_weight(settings.visibility, irradiance_probe, from_probe, surface)); break;
  case ROW_olx_irradiance_usable: put(olx_irradiance_usable(settings, irradiance_probe)); break;
  case ROW_olx_nearest_visible: seen = olx_nearest_visible(settings, surface, cage, nearest), put(seen), put(seen ? nearest : 0u); break;
  case ROW_olx_add_from_afar: put(olx_add_from_afar(settings, surface, cage, uv)); break;
  case ROW_olx_irradiance: put(olx_irradiance(settings, point, direction, view)); break;
  case ROW_olx_glossy:
    put(olx_glossy(settings, point, direction, view, random.z, random.xy, weight, half_cosine, hit));
    put(weight), put(half_cosine), put(hit.status), put(hit.probe), put(hit.distance_metres);
    break;
  }
}

// A hit that may be an emitter's, from before or behind, and may be the sky's.
olx_trace_hit some_hit() {
  float distance = (bits.x & 4u) != 0u ? OLX_INFINITY : item.v[15];
  return olx_trace_hit(bits.x % 3u, distance, point + direction * item.v[15], view, vec3(1.0), true, 0u, 2.0 * random.x, 1u, 1u);
}

void denoise_rows() {
  derive_denoise();
  vec2 at;
  bool seen, glossy = (bits.w & 2u) != 0u;
  float reach = (bits.w & 4u) != 0u ? 0.0 : 2.5 * random.z, pixels = float(bits.y % 12u);
  olx_known known;
  olx_scales scales = olx_scales_of(light_here, 50.0 * random.z);
  switch (row) {
  case ROW_olx_finite: put(olx_finite(light_here.light)), put(olx_finite(light_there.light)); break;
  case ROW_olx_lobe_is_dim: put(olx_lobe_is_dim(bsdf, random.w, random.z)); break;
  case ROW_olx_dim_light: put(olx_dim_light(bsdf, random.w, abs(view))); break;
  case ROW_olx_emission_counts: put(olx_emission_counts(settings, some_hit(), point)); break;
  case ROW_olx_nearness: put(olx_nearness(some_hit())); break;
  case ROW_olx_nothing_known: known = olx_nothing_known(), put_incident(known.incident), put(known.count); break;
  case ROW_olx_guide_position: put(olx_guide_position(camera, PICTURE, pixel, item.v[15])); break;
  case ROW_olx_guide_project: seen = olx_guide_project(camera, PICTURE, point, at), put(seen), put(seen ? at : vec2(0.0)); break;
  case ROW_olx_pixel_angle: put(olx_pixel_angle(camera, PICTURE)); break;
  case ROW_olx_plane_fit: put(olx_plane_fit(there.position - here.position, here.normal, 0.01 * here.depth)); break;
  case ROW_olx_is_sample: put(olx_is_sample(light_here)), put(olx_is_sample(light_there)); break;
  case ROW_olx_same_surface: put(olx_same_surface(here, there)); break;
  case ROW_olx_settle: put(olx_settle(pixel.x + 0.04 * random.x - 0.02)); break;
  case ROW_olx_stands_still: put(olx_stands_still(pixel + 0.02 * random.xy, pixel)); break;
  case ROW_olx_bilinear_weight: put(olx_bilinear_weight(pixel + random.xy, bits.x & 3u)); break;
  case ROW_olx_mix_sample:
    known = olx_mix_sample(olx_known(light_here, 60.0 * random.z), light_there, (bits.w & 1u) != 0u ? 0.98 : 0.0);
    put_incident(known.incident), put(known.count);
    break;
  case ROW_olx_scales_of: put(scales.inverse_distance), put(scales.narrowing); break;
  case ROW_olx_gaussian: put(olx_gaussian(9.0 * random.x)); break;
  case ROW_olx_reach_weight: put(olx_reach_weight(glossy, 0.1 + random.y, here, random.z, random.w, pixels)); break;
  case ROW_olx_tap_weight: put(olx_tap_weight(glossy, 12.0, reach, here, scales, there, light_there.inverse_distance, pixels)); break;
  }
}

void main() {
  item = items[gl_GlobalInvocationID.x];
  derive();
  if (GROUP == 0u) core_rows();
  else if (GROUP == 1u) field_rows(), voronoi_rows();
  else if (GROUP == 2u) march_rows();
  else if (GROUP == 3u) search_rows();
  else if (GROUP == 4u) shade_rows();
  else denoise_rows();
}
