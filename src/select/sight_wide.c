// Decides for eight probes at a time whether they see places, using AVX2, with the same result to the last bit as the
// test of a single probe. Machines without AVX2 test the probes one by one.
#include "core/wide.h"
#include "select/sight.h"

static void see_each(const olx_field *field, uint32_t count, const uint32_t *probes, const olx_vec3 *points,
                     float slack, const olx_vec3 *leaving, bool *sees) {
  for (uint32_t i = 0; i < count; i++) {
    sees[i] = olx_probe_sees(field, probes[i], points[i], slack, leaving ? &leaving[i] : NULL);
  }
}

#if OLX_WIDE

typedef struct wide_vec3 {
  reals x, y, z;
} wide_vec3;

typedef struct wide_uv {
  reals u, v;
} wide_uv;

WIDE reals dot(wide_vec3 a, wide_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
WIDE reals floor_of(reals a) { return __builtin_ia32_roundps256(a, 1); }
WIDE reals root(reals a) { return __builtin_ia32_sqrtps256(a); }
WIDE reals length(wide_vec3 a) { return root(dot(a, a)); }

// These are olx_octahedral_encode, olx_octahedral_point and olx_octahedral_decode, eight lanes wide.
WIDE wide_uv encode(wide_vec3 d) {
  const reals sum = magnitude(d.x) + magnitude(d.y) + magnitude(d.z), least = splat(OLX_LEAST_LENGTH);
  const reals inverse = 1.0f / pick(least > sum, least, sum), x = d.x * inverse, z = d.z * inverse;
  const words folded = d.y < 0.0f;
  return (wide_uv){pick(folded, (1.0f - magnitude(z)) * sign_not_zero(x), x) * 0.5f + 0.5f,
                   pick(folded, (1.0f - magnitude(x)) * sign_not_zero(z), z) * 0.5f + 0.5f};
}

WIDE wide_vec3 octahedron(wide_uv uv) {
  const reals x = uv.u * 2.0f - 1.0f, z = uv.v * 2.0f - 1.0f, y = 1.0f - magnitude(x) - magnitude(z);
  const words folded = y < 0.0f;
  return (wide_vec3){pick(folded, (1.0f - magnitude(z)) * sign_not_zero(x), x), y,
                     pick(folded, (1.0f - magnitude(x)) * sign_not_zero(z), z)};
}

WIDE wide_vec3 decode(wide_uv uv) {
  const wide_vec3 q = octahedron(uv);
  const reals size = length(q), inverse = pick(size > 0.0f, 1.0f / size, splat(1.0f));
  return (wide_vec3){q.x * inverse, q.y * inverse, q.z * inverse};
}

// This is olx_plane_sees, eight lanes wide.
WIDE uint32_t see_planes(const olx_field *field, const uint32_t *probes, wide_vec3 offset, wide_uv uv, reals x, reals y,
                         float slack, const olx_vec3 *leaving) {
  wide_vec3 plane;
  reals towards = splat(0.0f);
  for (uint32_t i = 0; i < OLX_WIDE_LANES; i++) {
    const olx_vec3 m = olx_block_plane(field, probes[i], (uint32_t)x[i], (uint32_t)y[i]);
    plane.x[i] = m.x, plane.y[i] = m.y, plane.z[i] = m.z;
    if (leaving) towards[i] = olx_dot(m, leaving[i]);
  }
  const float n = (float)field->n;
  const reals size = length(octahedron(uv)), behind = dot(plane, offset) - 1.0f;
  const reals footprint = length(offset) * root(4.0f / (n * n * size * size * size)) * length(plane);
  words sees = ~(behind > slack * footprint);
  if (leaving) sees &= (behind <= -OLX_SIGHT_ABOVE * footprint) | ~(towards > 0.0f);
  return bits(sees);
}

// This is olx_probe_sees, eight lanes wide.
WIDE uint32_t see(const olx_field *field, const uint32_t *probes, const olx_vec3 *points, float slack,
                  const olx_vec3 *leaving) {
  wide_vec3 offset;
  for (uint32_t i = 0; i < OLX_WIDE_LANES; i++) {
    const olx_vec3 o = olx_sub(points[i], field->probe_positions[probes[i]]);
    offset.x[i] = o.x, offset.y[i] = o.y, offset.z[i] = o.z;
  }
  const float n = (float)field->n;
  const wide_uv uv = encode(offset);
  const reals x = floor_of(least(uv.u * n, splat(n - 1.0f))), y = floor_of(least(uv.v * n, splat(n - 1.0f)));
  const words texel = (truncated(y) + 1) * (int32_t)field->stride + (truncated(x) + 1);
  if (field->geometry) return see_planes(field, probes, offset, uv, x, y, slack, leaving);
  words code, packed;
  for (uint32_t i = 0; i < OLX_WIDE_LANES; i++) {
    const size_t at = field->texels * probes[i] + (uint32_t)texel[i];
    code[i] = field->distance[at] & 0x7FFF;
    packed[i] = field->normal[at];
  }
  const reals distance = (reals)(code << 13) * 0x1p112f * field->distance_scale, radius = length(offset);
  const reals size = length(octahedron(uv));
  const reals footprint = distance * root(4.0f / (n * n * size * size * size));
  const wide_vec3 centre = decode((wide_uv){(x + 0.5f) / n, (y + 0.5f) / n});
  const wide_vec3 normal =
      decode((wide_uv){real(packed & 0xFF) * (1.0f / 254.0f), real(packed >> 8) * (1.0f / 254.0f)});
  const reals cosine = most(-dot(normal, centre), splat(OLX_SIGHT_LEAST_COSINE));
  const words in_front = (code == 0x7C00) | (radius < distance - 2.0f * footprint / OLX_SIGHT_LEAST_COSINE) |
                         (radius < distance - 2.0f * footprint / cosine);
  const reals height = dot(normal, (wide_vec3){offset.x + centre.x * -distance, offset.y + centre.y * -distance,
                                               offset.z + centre.z * -distance});
  words on = ~(height < -slack * footprint);
  if (leaving) {
    wide_vec3 along;
    for (uint32_t i = 0; i < OLX_WIDE_LANES; i++) {
      along.x[i] = leaving[i].x, along.y[i] = leaving[i].y, along.z[i] = leaving[i].z;
    }
    on &= (height >= OLX_SIGHT_ABOVE * footprint) | (dot(normal, along) >= 0.0f);
  }
  return bits(in_front | on);
}

WIDE_CODE static uint32_t see_eight(const olx_field *field, const uint32_t *probes, const olx_vec3 *points, float slack,
                                    const olx_vec3 *leaving) {
  return leaving ? see(field, probes, points, slack, leaving) : see(field, probes, points, slack, NULL);
}

void olx_probes_see(const olx_field *field, uint32_t count, const uint32_t *probes, const olx_vec3 *points, float slack,
                    const olx_vec3 *leaving, bool *sees) {
  uint32_t done = 0;
  if (olx_wide_available()) {
    for (; count - done >= OLX_WIDE_LANES; done += OLX_WIDE_LANES) {
      const uint32_t seen = see_eight(field, probes + done, points + done, slack, leaving ? leaving + done : NULL);
      for (uint32_t i = 0; i < OLX_WIDE_LANES; i++) sees[done + i] = seen >> i & 1;
    }
  }
  see_each(field, count - done, probes + done, points + done, slack, leaving ? leaving + done : NULL, sees + done);
}

#else

void olx_probes_see(const olx_field *field, uint32_t count, const uint32_t *probes, const olx_vec3 *points, float slack,
                    const olx_vec3 *leaving, bool *sees) {
  see_each(field, count, probes, points, slack, leaving, sees);
}

#endif
