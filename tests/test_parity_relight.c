// Compares relighting in shaders/lib with its C twin (tests/parity.h).
#include "field/harmonic_data.c"
#include "relight/relit_direct.c"
#include "relight/relit_highlights.c"
#include "relight/relit_maps.c"
#include "relight/relit_volume.c"

#include "parity.h"

static const uint32_t RELIGHT_CODE[] = {
#include "parity_relight.spv.inc"
};

static olx_light some_light(const parity_state *s, uint32_t type) {
  const bool area = type == OLX_LIGHT_RECT || type == OLX_LIGHT_TRIANGLE;
  const olx_vec3 v = s->view;
  return (olx_light){.type = (olx_light_type)type,
                     .emission = olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z)),
                     .position = olx_madd(s->point, v, s->item->v[15]),
                     .direction = s->direction,
                     .edge_u = area ? olx_scale(s->direction, 0.5f) : s->direction,
                     .edge_v = olx_scale(olx_v3(v.y, v.z, v.x), 0.4f),
                     .both_sides = (s->bits[1] & 1u) != 0,
                     .cosine_inner = s->random[0],
                     .cosine_outer = s->random[0] - 0.5f * s->random[1]};
}

// Aims at a point of a surface near a lamp, which faces away half of the time.
static bool aim_at_some_point(const parity_state *s, olx_vec3 normal, olx_shadow_ray *ray, olx_vec3 *irradiance) {
  const olx_vec3 v = s->view;
  olx_lamp_point point = {.position = olx_madd(s->point, v, s->item->v[15]),
                          .normal = olx_negate(s->direction),
                          .intensity = olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z)),
                          .soft_squared = 0.01f};
  float sums[2] = {0.0f, 1.0f};
  const olx_near_lamps lamps = {.points = &point, .sums = sums, .count = 1};
  return aim_near(&lamps, s->point, normal, 0.5f, ray, irradiance);
}

static olx_vec3 some_normal(const parity_state *s) { return s->bits[2] & 1u ? s->direction : olx_negate(s->direction); }
static olx_vec2 later_random(const parity_state *s) { return (olx_vec2){s->random[2], s->random[3]}; }
static uint32_t size_of(const parity_state *s) { return 8u << (s->bits[3] & 3u); }

static void put_ray(parity_result *r, bool lit, const olx_shadow_ray *ray, olx_vec3 irradiance) {
  put_u(r, lit);
  if (!lit) return;
  put_3(r, ray->direction);
  put_f(r, ray->length_metres);
  put_3(r, irradiance);
}

static void put_bilinear(parity_result *r, const olx_bilinear *b) {
  for (uint32_t k = 0; k < 4; k++) {
    put_u(r, (uint32_t)b->index[k]);
    put_f(r, b->weight[k]);
  }
}

static void put_tile_texel(parity_result *r, uint32_t i) {
  const olx_relit_tile tile = {.probe = 0};
  uint32_t x, y;
  tile_texel(OLX_RELIT_TILE_SIDE, &tile, i, &x, &y);
  put_u(r, x);
  put_u(r, y);
  put_u(r, 0);
}

static void some_corners(const parity_state *s, float corner[4]) {
  site_corners(s->bits[1] % OLX_RELIGHT_BLOCK, s->bits[2] % OLX_RELIGHT_BLOCK, corner);
}

// Returns the weight of an entry, as the light of a site whose one surfel has light 1.
static float told_weight(const parity_state *s) {
  const uint32_t starts[2] = {0, 1}, word = s->bits[0];
  const olx_relight_entry entry = {0,
                                   {(uint8_t)word, (uint8_t)(word >> 8), (uint8_t)(word >> 16), (uint8_t)(word >> 24)}};
  const olx_relight_data data = {.entry_starts = starts, .entries = &entry};
  const olx_vec3 light = {1.0f, 1.0f, 1.0f};
  return told_by(&data, 0, s->bits[1] % OLX_RELIGHT_BLOCK, s->bits[2] % OLX_RELIGHT_BLOCK, &light).x;
}

static olx_vec3 hemisphere_direction(const parity_state *s, uint32_t first, olx_vec3 normal) {
  const olx_vec2 random = {s->random[first], s->random[first + 1]};
  return olx_from_basis(olx_sample_cosine(random), normal);
}

// Returns a brightness for a surface that is seen from behind one time in eight.
static float some_brightness(const parity_state *s) {
  const olx_relight_surfel surfel = {
      .normal = s->bits[2] & 0xFEFEu, .f0 = (uint8_t)s->bits[0], .alpha = (uint8_t)(s->bits[0] >> 8)};
  const olx_vec3 normal = olx_normal_unpack((uint16_t)surfel.normal), view = hemisphere_direction(s, 0, normal);
  return brightness(&surfel, s->bits[3] % 8u ? view : olx_negate(view), hemisphere_direction(s, 2, normal));
}

// clang-format off
ROW(hash3, put_u(r, olx_hash3(s->bits[0], s->bits[1], s->bits[2]));)
ROW(sample_triangle, put_2(r, olx_sample_triangle(random_2(s)));)
ROW(luminance, put_f(r, olx_luminance(s->point));)
ROW(texel_direction, const uint32_t n = size_of(s); put_3(r, olx_texel_direction(s->bits[1] % n, s->bits[2] % n, n));)
ROW(border_source, const uint32_t n = size_of(s); int32_t x; int32_t y;
    olx_border_source((int32_t)(s->bits[1] % (n + 2)) - 1, (int32_t)(s->bits[2] % (n + 2)) - 1, (int32_t)n, &x, &y);
    put_i(r, x); put_i(r, y);)
ROW(small_float_unpack, put_f(r, olx_small_float_unpack(s->bits[3] & 0x7BFu, 6));)
ROW(r11g11b10f_unpack, put_3(r, olx_r11g11b10f_unpack(s->bits[3] & 0x7BDEF7BFu));)
ROW(small_float_pack, put_u(r, olx_small_float_pack(olx_bits_float(s->bits[0]), 5 + (s->bits[1] & 1u)));)
ROW(r11g11b10f_pack, put_u(r, olx_r11g11b10f_pack(olx_scale(s->point, exp2f((float)(s->bits[0] % 40u) - 20.0f))));)
ROW(half_pack, put_u(r, olx_half_pack(olx_bits_float(s->bits[0])));)
ROW(rgb9e5_pack, put_u(r, olx_rgb9e5_pack(olx_scale(s->point, exp2f((float)(s->bits[0] % 40u) - 20.0f))));)
ROW(bilinear_at, const olx_bilinear b = olx_bilinear_at(random_2(s), size_of(s)); put_bilinear(r, &b);)
ROW(light_varies, const olx_light l = some_light(s, s->bits[0] % 6u); put_u(r, olx_light_varies(&l));)
ROW(spot_falloff, const olx_light l = some_light(s, OLX_LIGHT_SPOT);
    put_f(r, olx_spot_falloff(l.cosine_inner, l.cosine_outer, s->random[2]));)
ROW(point_light, const olx_light l = some_light(s, 1u + (s->bits[0] & 1u)); olx_shadow_ray ray; olx_vec3 e;
    const bool lit = point_light(&l, s->point, some_normal(s), &ray, &e); put_ray(r, lit, &ray, e);)
ROW(area_light, const olx_light l = some_light(s, 3u + (s->bits[0] & 1u)); olx_shadow_ray ray; olx_vec3 e;
    const bool lit = area_light(&l, s->point, some_normal(s), later_random(s), &ray, &e); put_ray(r, lit, &ray, e);)
ROW(aim, const olx_light l = some_light(s, s->bits[0] % 6u); olx_shadow_ray ray; olx_vec3 e;
    const bool lit = aim(&l, s->point, some_normal(s), later_random(s), &ray, &e); put_ray(r, lit, &ray, e);)
ROW(aim_near, olx_shadow_ray ray; olx_vec3 e; const bool lit = aim_at_some_point(s, some_normal(s), &ray, &e);
    put_ray(r, lit, &ray, e);)
ROW(tile_texel, put_tile_texel(r, s->bits[0] % 1024u);)
ROW(site_corners, float c[4]; some_corners(s, c); for (uint32_t k = 0; k < 4; k++) put_f(r, c[k]);)
ROW(site_weight, put_f(r, told_weight(s));)
ROW(irradiance_scale, const uint32_t k = s->bits[0] % 9u;
    put_f(r, olx_harmonics_cosine(k == 0 ? 0 : k < 4 ? 1 : 2) / olx_harmonics_mean_square(k));)
ROW(half_pack_finite, put_u(r, pack_finite(olx_bits_float(s->bits[0] & 0x7F7FFFFFu)));)
ROW(specular_brightness, put_f(r, some_brightness(s));)
// clang-format on

static const parity_row ROWS[] = {
    PARITY(hash3, 2e-6f, 0),
    PARITY(sample_triangle, 2e-6f, 0),
    PARITY(luminance, 2e-6f, 0),
    PARITY(texel_direction, 2e-6f, 0),
    PARITY(border_source, 2e-6f, 0),
    PARITY(small_float_unpack, 2e-6f, 0),
    PARITY(r11g11b10f_unpack, 2e-6f, 0),
    PARITY(small_float_pack, 2e-6f, 0),
    PARITY(r11g11b10f_pack, 2e-6f, 0),
    PARITY(half_pack, 0.0f, 0),
    PARITY(rgb9e5_pack, 0.0f, 0),
    PARITY(bilinear_at, 1e-5f, 0),
    PARITY(light_varies, 2e-6f, 0),
    PARITY(spot_falloff, 1e-4f, 0),
    PARITY(point_light, 1e-4f, 1e-3),
    PARITY(area_light, 1e-4f, 1e-3),
    PARITY(aim, 1e-4f, 1e-3),
    PARITY(aim_near, 1e-4f, 1e-3),
    PARITY(tile_texel, 0.0f, 0),
    PARITY(site_corners, 2e-6f, 0),
    PARITY(site_weight, 2e-6f, 0),
    PARITY(irradiance_scale, 2e-6f, 0),
    PARITY(half_pack_finite, 0.0f, 0),
    PARITY(specular_brightness, 1e-4f, 0),
};
static const parity_code CODES[] = {{ROWS_OF_RELIGHT, {RELIGHT_CODE, sizeof RELIGHT_CODE}}};
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {ROWS_OF_DENOISE, ROWS_OF_RELIGHT},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
