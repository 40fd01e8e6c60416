// Rows of a ray against one probe's map.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity.glsl"

olx_probe_ray ray;
olx_march march;
vec3 planes;
olx_piece piece;
olx_cell cell;
olx_surfel surfel;

void derive_march() {
  precise vec3 origin = point - olx_probe_position(probe);
  ray = olx_probe_ray(origin, direction, (bits.w & 1u) != 0u ? 0.0 : item.v[13],
                      (bits.w & 2u) != 0u ? OLX_INFINITY : item.v[14]);
  march = olx_begin_march(probe, ray);
  planes = olx_planes_of(ray);
  piece = olx_make_piece(march, planes, ray.t_min, olx_next_cut(planes, ray.t_min, ray.t_max));
  cell = olx_cell(ivec2(piece.u.first, piece.v.first), piece.t_begin);
  surfel = olx_read_surfel(march, texel, item.v[15]);
}

void put_axis(olx_image_axis a) {
  put(a.begin), put(a.travel), put(olx_axis_step(a)), put(olx_axis_ahead(a)), put(a.first);
 }

void put_answer(olx_probe_answer a) { put(a.status), put_texel(a.texel), put(a.steps), put(a.t), put(a.gap); }

void put_stand(olx_stand at) { put(at.at), put(at.level); }

// Writes the result of a march over a whole ray.
void put_verdict(int verdict, olx_probe_answer answer) {
  answer.status = verdict == OLX_VERDICT_CLEAR ? OLX_TRACE_MISS
                  : verdict == OLX_VERDICT_HIT ? OLX_TRACE_HIT
                                               : OLX_TRACE_UNKNOWN;
  answer.steps = march.steps;
  put(answer.status), put(answer.steps);
  if (verdict != OLX_VERDICT_CLEAR) put_answer(answer);
}

// Returns an answer that no march has written yet.
olx_probe_answer blank() { return olx_probe_answer(OLX_TRACE_MISS, 0.0, ivec2(-1), 0.0, 0u); }

void march_rows() {
  derive_march();
  int n = int(olx_field.n);
  vec2 ahead = olx_crossings_ahead(piece, cell.at, 0), image = vec2(0.0);
  float t1 = olx_parameter_at(piece, min(ahead.x, ahead.y));
  olx_stand at;
  float stored;
  olx_piece_end end = olx_end_at(march, piece.sign, ray.t_min + 0.3 * random.x);
  olx_probe_answer answer = blank();
  bool b, blocks = olx_geometry_in_blocks();
  switch (row) {
  case ROW_olx_axis_step: put(olx_axis_step(piece.u)), put(olx_axis_step(piece.v)); break;
  case ROW_olx_axis_ahead: put(olx_axis_ahead(piece.u)), put(olx_axis_ahead(piece.v)); break;
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
  case ROW_olx_supported:
    put(olx_supported(march, piece, cell.at, surfel, ray.t_min + 0.1 * random.x)), put(march.steps);
    break;
  case ROW_olx_judge_height: put(olx_judge_height(march, piece, cell, t1, surfel, answer)), put(answer.t); break;
  case ROW_olx_judge_surfel:
    put(olx_judge_surfel(march, piece, cell, t1, item.v[15], answer)), put_answer(answer);
    break;
  case ROW_olx_read_block:
    if (!blocks) break;
    olx_read_block(march, texel / 4), olx_read_block(march, texel / 4), put(march.block.xyz), put(march.block.w);
    put(march.steps);
    break;
  case ROW_olx_octahedral_depth: put(olx_octahedral_depth(march, piece, random.x)); break;
  case ROW_olx_plane_clears:
    put(olx_plane_clears(march, direction * random.z, random.x, random.x + random.y));
    put(olx_plane_clears(march, direction.zxy * random.z, random.x, OLX_INFINITY));
    break;
  case ROW_olx_block_clears:
    if (!blocks) break;
    olx_read_block(march, texel / 4), put(olx_block_clears(march, piece, random.x, random.x + random.y));
    break;
  case ROW_olx_reaches_plane:
    if (!blocks) break;
    put(b = olx_reaches_plane(march, cell.at, cell.t, t1, stored)), put(march.steps);
    if (b) put(stored);
    break;
  case ROW_olx_reaches_texel:
    put(b = olx_reaches_texel(march, cell.at, cell.t, t1, stored)), put(march.steps);
    if (b) put(stored);
    break;
  case ROW_olx_next_cell: cell = olx_next_cell(piece, cell, random.xy, t1), put(cell.at), put(cell.t); break;
  case ROW_olx_crossings_ahead: put(olx_crossings_ahead(piece, cell.at >> 2, 2)); break;
  case ROW_olx_march_texels: put(olx_march_texels(march, piece, answer)), put_answer(answer); break;
  case ROW_olx_march_two_level:
    put(olx_march_two_level(march, piece, answer)), put_answer(answer), put(march.steps);
    break;
  case ROW_olx_march_piece: put(olx_march_piece(march, piece, settings.tracer, answer)), put_answer(answer); break;
  case ROW_olx_end_at: put(end.image), put(end.inverse), put(end.centre); break;
  case ROW_olx_make_axis: put_axis(olx_make_axis(point.x * 8.0, point.y * 8.0, view.x, n)); break;
  case ROW_olx_plane_at: put(olx_plane_at(point.x, direction.x)); break;
  case ROW_olx_planes_of: put(olx_planes_of(ray)); break;
  case ROW_olx_sign_after: put(olx_sign_after(ray.origin.x, ray.direction.x, planes.x, random.x)); break;
  case ROW_olx_make_piece:
    put_axis(piece.u), put_axis(piece.v), put(piece.near), put(piece.slope), put(piece.rise);
    break;
  case ROW_olx_next_cut: put(olx_next_cut(planes, ray.t_min, ray.t_max)); break;
  case ROW_olx_begin_stand: at = olx_begin_stand(march, piece), put(at.at), put(at.t); break;
  case ROW_olx_enter:
    at = olx_stand(ivec2(0), int(bits.x % 3u), random.x, 0.0, (bits.y & 1u) != 0u, 0.0, false, false);
    olx_enter(piece, at), put(at.at);
    break;
  case ROW_olx_leave:
    at = olx_stand(cell.at, -1, 0.0, 0.0, true, 0.0, false, false);
    olx_leave(at, at.at + ivec2(bits.xy % 33u) - 16, 0.0, 0.0, true), put_stand(at);
    at.level = int(bits.z % olx_field.pyramid_levels), at.at = texel >> olx_pyramid_shift(at.level);
    olx_leave(at, at.at + ivec2(bits.xy % 5u) - 2, 0.0, 0.0, true), put_stand(at);
    break;
  case ROW_olx_find_texel:
    at = olx_begin_stand(march, piece), put(b = olx_find_texel(march, piece, at, stored));
    if (b) put(at.at), put(at.t), put(stored);
    break;
  case ROW_olx_march_hiz: put_verdict(olx_march_hiz(march, answer), answer); break;
  case ROW_olx_march_pieces: put_verdict(olx_march_pieces(march, settings.tracer, answer), answer); break;
  case ROW_olx_begin_march: put(march.closest), put(march.miss_squared), put(march.least); break;
  case ROW_olx_trace_probe: put_answer(olx_trace_probe(probe, ray, settings.tracer)); break;
  }
}

void main() {
  begin();
  march_rows();
}
