// Draws a probe's map: the light of its texels, the faces of its octahedron, the blocks of texels that a march skips,
// and the image of the picked ray: orange where whole blocks were skipped, green where texels were read (McGuire et al.
// 2017, Figure 4).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_frame.glsl"

layout(set = 1, binding = VIEW_BINDING_PICK, std430) readonly buffer pick_block { view_gpu_pick pick; };

layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;

const vec3 SKIPPED = vec3(1.0, 0.55, 0.05), READ = vec3(0.2, 0.95, 0.3), BEGIN = vec3(1.0), END = vec3(1.0, 0.15, 0.1);

float line(float pixels, float width) { return clamp(width - abs(pixels) + 0.5, 0.0, 1.0); }

// Returns the distance in pixels from the nearest grid line; lines are at integers of x, and one unit of x is `a_line`
// pixels.
float from_grid(float x, float a_line) { return abs(fract(x + 0.5) - 0.5) * a_line; }

// Returns whether the march skips a block, because the ray is nearer than everything in it.
bool skips(inout olx_march m, olx_piece p, float s) {
  int level = olx_field.pyramid_levels > 1u ? 1 : 0, shift = olx_pyramid_shift(level);
  ivec2 block = ivec2(olx_texel_at(p.u, s, true), olx_texel_at(p.v, s, true)) >> shift;
  block = clamp(block, ivec2(0), ivec2((int(olx_field.n) >> shift) - 1));
  vec2 ahead = olx_crossings_ahead(p, block, shift);
  vec2 behind = vec2(olx_crossing(p.u, (block.x + 1 - olx_axis_ahead(p.u)) << shift),
                     olx_crossing(p.v, (block.y + 1 - olx_axis_ahead(p.v)) << shift));
  float enter = max(0.0, max(olx_axis_step(p.u) == 0 ? 0.0 : behind.x, olx_axis_step(p.v) == 0 ? 0.0 : behind.y));
  float t0 = enter <= 0.0 ? p.t_begin : olx_parameter_at(p, enter), t1 = olx_parameter_at(p, min(ahead.x, ahead.y));
  return olx_reach_squared(m, p, t0, t1) < olx_least_squared(m, level, block);
}

vec3 draw_ray(uint probe, vec3 under) {
  vec3 direction = pick.direction.xyz, origin = pick.position.xyz - olx_probe_position(probe);
  olx_probe_ray ray = olx_probe_ray(origin, direction, 0.0, pick.direction.w);
  olx_march m = olx_begin_march(probe, ray);
  vec3 planes = olx_planes_of(ray);
  float a_texel = view.radius / float(olx_field.n);
  vec2 here = uv * float(olx_field.n), first = vec2(0.0), last = vec2(0.0);
  for (float t = 0.0; t < ray.t_max;) {
    float t_end = olx_next_cut(planes, t, ray.t_max);
    olx_piece p = olx_make_piece(m, planes, t, t_end);
    vec2 begin = vec2(p.u.begin, p.v.begin), travel = vec2(p.u.travel, p.v.travel);
    float s = clamp(dot(here - begin, travel) / max(dot(travel, travel), 1e-12), 0.0, 1.0);
    float off = length(here - begin - travel * s) * a_texel;
    under = mix(under, vec3(0.0), 0.6 * line(off, 3.0));
    under = mix(under, skips(m, p, s) ? SKIPPED : READ, line(off, 1.5));
    if (t <= 0.0) first = begin;
    last = begin + travel;
    t = t_end;
  }
  float at_first = length(here - first) * a_texel, at_last = length(here - last) * a_texel;
  under = mix(mix(under, vec3(0.0), line(at_first, 5.5)), BEGIN, line(at_first, 4.0));
  return mix(mix(under, vec3(0.0), line(at_last, 5.5)), END, line(at_last, 4.0));
}

void main() {
  uint probe = view.probe != OLX_NO_PROBE ? view.probe : pick.probe;
  if (probe >= olx_field.probe_count) probe = 0u;
  ivec2 texel = min(ivec2(uv * float(olx_field.n)), ivec2(olx_field.n) - 1);
  vec3 c = tone(seen_light(probe, texel));
  float blocks = max(float(olx_field.n >> 4), 1.0);
  vec2 grid = vec2(from_grid(uv.x * blocks, view.radius / blocks), from_grid(uv.y * blocks, view.radius / blocks));
  c = mix(c, vec3(1.0), 0.12 * line(min(grid.x, grid.y), 0.5));
  vec2 q = uv * 2.0 - 1.0;
  float fold = (abs(q.x) + abs(q.y) - 1.0) * view.radius * 0.35355;
  c = mix(c, vec3(1.0), 0.45 * line(min(min(abs(q.x), abs(q.y)) * view.radius * 0.5, abs(fold)), 0.75));
  if (pick.position.w > 0.0) c = draw_ray(probe, c);
  vec2 from_edge = min(uv, 1.0 - uv) * view.radius;
  c = mix(c, vec3(0.85), line(min(from_edge.x, from_edge.y), 1.5));
  color = vec4(c, 1.0);
}
