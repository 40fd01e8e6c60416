// Compares vectors, maps, sampling, the reflection model, and the choice of probes in shaders/lib with their C twins
// (tests/parity.h).
#include "field/texels.h"
#include "select/voronoi.c"

#include "core/sampling.h"
#include "field/pyramid.h"
#include "parity.h"

static const uint32_t CORE_CODE[] = {
#include "parity_core.spv.inc"
};
static const uint32_t FIELD_CODE[] = {
#include "parity_field.spv.inc"
};

static olx_vec3 local_view(const parity_state *s) { return olx_v3(s->view.x, s->view.y, fabsf(s->view.z)); }

static uint32_t tree_of(const parity_state *s) { return has_voronoi(s) ? (uint32_t)olx_voronoi_tree(s->field) : 0; }
static nearest nearest_of(const parity_state *s, uint32_t one) {
  nearest n = {.field = s->field,
               .point = s->point,
               .buried = s->settings.keep_buried,
               .probe = OLX_NO_PROBE,
               .distance = INFINITY};
  consider(&n, one % s->field->info.probes.count);
  return n;
}
static void put_nearest(parity_result *r, const nearest *n) {
  put_u(r, n->probe);
  put_f(r, n->distance);
}

// clang-format off

ROW(square, put_f(r, olx_square(s->point.x));)
ROW(sign_not_zero, put_f(r, olx_sign_not_zero(s->direction.x));)
ROW(dot, put_f(r, olx_dot(s->point, s->direction));)
ROW(normalize, put_3(r, olx_normalize(s->bits[3] % 64 == 0 ? olx_splat(0.0f) : s->point));)
ROW(basis, olx_vec3 t, b; olx_basis(s->direction, &t, &b); put_3(r, t); put_3(r, b);)
ROW(from_basis, put_3(r, olx_from_basis(s->view, s->direction));)
ROW(octahedral_encode, put_2(r, olx_octahedral_encode(s->direction));)
ROW(octahedral_point, put_3(r, olx_octahedral_point(random_2(s)));)
ROW(octahedral_decode, put_3(r, olx_octahedral_decode(random_2(s)));)
ROW(texel_solid_angle_near, put_f(r, olx_texel_solid_angle_near(random_2(s), 64));)
ROW(half_unpack, put_f(r, olx_half_unpack((uint16_t)(s->index * 8 + (s->bits[0] & 7u))));)
ROW(normal_unpack, put_3(r, olx_normal_unpack((uint16_t)(s->bits[0] % 255u | s->bits[1] % 255u << 8)));)
ROW(hash, put_u(r, olx_hash(s->bits[0]));)
ROW(hash2, put_u(r, olx_hash2(s->bits[0], s->bits[1]));)
ROW(unit_float, put_f(r, olx_unit_float(s->bits[0]));)
ROW(owen_scramble,
    put_u(r, olx_reverse_bits(olx_owen_scramble_reversed(olx_reverse_bits(s->bits[0]), s->bits[1])));)
ROW(sobol2, put_u(r, olx_reverse_bits(olx_sobol2_reversed(s->bits[0])));)
ROW(stratified2, put_2(r, olx_stratified2(s->bits[0], s->bits[1]));)
ROW(turn, const float angle = 2.0f * OLX_PI * s->random[0]; put_f(r, cosf(angle)); put_f(r, sinf(angle));)
ROW(sample_cosine, put_3(r, olx_sample_cosine(random_2(s)));)
ROW(bsdf_make, put_3(r, s->bsdf.albedo); put_3(r, s->bsdf.f0); put_f(r, s->bsdf.f90);
    put_f(r, s->bsdf.dielectric_weight);
    put_f(r, s->bsdf.alpha);)
ROW(pow5, put_f(r, olx_pow5(s->random[0]));)
ROW(fresnel, put_3(r, olx_fresnel(&s->bsdf, s->random[3]));)
ROW(bsdf_diffuse, put_3(r, olx_bsdf_diffuse(&s->bsdf, s->random[3]));)
ROW(bsdf_has_specular, const olx_bsdf b = olx_bsdf_make(s->point, 0.0f, 0.5f, (float)(s->bits[0] & 1u));
    put_u(r, olx_bsdf_has_specular(&b));)
ROW(bsdf_specular_albedo, put_3(r, olx_bsdf_specular_albedo(&s->bsdf, s->random[3]));)
ROW(ggx_lambda, put_f(r, olx_ggx_lambda(s->random[0], s->random[1]));)
ROW(ggx_sample_half, put_3(r, olx_ggx_sample_half(s->random[2], local_view(s), random_2(s)));)
ROW(ggx_sample, float weight; float half_cosine; const olx_vec2 random = {s->random[2], s->random[3]};
    put_3(r, olx_ggx_sample(s->bsdf.alpha, local_view(s), random, &weight, &half_cosine)); put_f(r, weight);
    put_f(r, half_cosine);)

static olx_texel_block block_of(const parity_state *s) { return olx_block_at(s->field, s->probe, s->x, s->y); }
static olx_block_place place_of(const parity_state *s) {
  return (olx_block_place){s->field->n, s->x / OLX_BLOCK_SIDE, s->y / OLX_BLOCK_SIDE};
}
// Returns a block of each form, whose indices may name any plane.
static olx_geometry_block some_block(const parity_state *s) {
  return (olx_geometry_block){
      {s->bits[0] % 64u, s->bits[1], s->bits[2], (s->bits[3] & 0x3FFFFFFFu) | s->bits[0] % 3u << 30}};
}
static void put_geometry(parity_result *r, olx_texel_geometry g) {
  put_f(r, g.distance);
  put_3(r, g.distance < INFINITY ? g.normal : olx_v3(0.0f, 0.0f, 0.0f));
}

ROW(probe_position, put_3(r, s->field->probe_positions[s->probe]);)
ROW(irradiance_probe_position, put_3(r, olx_grid_position(&s->source.grid, s->irradiance_probe));)
ROW(map_corner, put_u(r, s->probe % 9 % 3 * s->field->n); put_u(r, s->probe % 9 / 3 * s->field->n);
    put_u(r, s->probe / 9);)
ROW(map_origin, const uint32_t side = s->constants->maps_a_side;
    put_u(r, s->probe % side * s->field->stride + 1); put_u(r, s->probe / side % side * s->field->stride + 1);
    put_u(r, s->probe / side / side);)
ROW(texel_towards, put_u(r, (uint32_t)olx_texel_towards(s->field, s->direction));)
ROW(texel_distance_bits,
    put_u(r, s->field->distance ? s->field->distance[s->field->texels * s->probe + texel_of(s)] : 0);)
ROW(texel_distance, put_f(r, olx_texel_distance(s->field, s->probe, texel_of(s)));)
ROW(texel_emits, put_u(r, olx_texel_emits(s->field, s->probe, texel_of(s)));)
ROW(texel_normal, put_3(r, olx_texel_normal(s->field, s->probe, texel_of(s)));)
ROW(geometry_in_blocks, put_u(r, s->field->geometry != NULL);)
ROW(geometry_block, const olx_geometry_block none = {{0}};
    const olx_geometry_block *b = s->field->geometry ? &s->field->geometry[block_of(s).block] : &none;
    for (uint32_t k = 0; k < 4; k++) put_u(r, b->words[k]);)
ROW(plane_in_block, const olx_geometry_block b = some_block(s);
    put_3(r, olx_geometry_plane(&b, &s->field->planes, place_of(s), block_of(s).texel));)
ROW(block_plane,
    put_3(r, s->field->geometry ? olx_block_plane(s->field, s->probe, s->x, s->y) : olx_v3(0.0f, 0.0f, 0.0f));)
ROW(block_geometry, if (s->field->geometry) put_geometry(r, olx_block_geometry(s->field, s->probe, texel_of(s)));)
ROW(texel_geometry_of, put_geometry(r, olx_texel_geometry_of(s->field, s->probe, texel_of(s)));)
ROW(texel_is_sky, put_u(r, olx_texel_is_sky(s->field, s->probe, texel_of(s)));)
ROW(texel_emission_code, put_u(r, olx_texel_emission_code(s->field, s->probe, texel_of(s)));)
ROW(texel_radiance, put_3(r, olx_texel_radiance(s->field, s->probe, texel_of(s)));)
ROW(irradiance_coordinate, const uint32_t side = s->constants->irradiance_maps_a_side;
    const float n = (float)s->field->irradiance_n; const float stride = n + 2.0f;
    const uint32_t p = s->irradiance_probe;
    put_f(r, ((float)(p % side) * stride + 1.0f + s->random[0] * n) / ((float)side * stride));
    put_f(r, ((float)(p / side % side) * stride + 1.0f + s->random[1] * n) / ((float)side * stride));
    put_f(r, (float)(p / side / side));)
ROW(cage_at, const olx_cage cage = olx_cage_at(&s->source.grid, s->point); put_u(r, cage.base[0]);
    put_u(r, cage.base[1]);
    put_u(r, cage.base[2]); put_u(r, cage.corner_mask); put_f(r, cage.alpha[0]); put_f(r, cage.alpha[1]);
    put_f(r, cage.alpha[2]);)
ROW(cage_has, const olx_cage cage = olx_cage_at(&s->source.grid, s->point);
    put_u(r, olx_cage_has(&cage, s->bits[0] & 7u));)
ROW(cage_probe, const olx_cage cage = olx_cage_at(&s->source.grid, s->point);
    put_u(r, olx_cage_probe(&s->source.grid, &cage, s->bits[0] & cage.corner_mask));)
ROW(cage_weight, const olx_cage cage = olx_cage_at(&s->source.grid, s->point);
    put_f(r, olx_cage_weight(&cage, s->bits[0] & 7u));)
ROW(select_available, put_u(r, olx_select_available(s->field, (olx_select)(s->bits[0] % 5u)));)
ROW(select_resolve, put_u(r, olx_select_resolve(s->field, (olx_select)(s->bits[0] % 6u)));)
ROW(sample_settings_default, const olx_sample_settings d = olx_sample_settings_default(); put_u(r, d.tracer);
    put_u(r, OLX_SELECT_BRICKS); put_u(r, d.visibility); put_u(r, d.max_probes); put_u(r, d.keep_buried);
    put_u(r, d.emitters); put_u(r, d.hits); put_f(r, d.surface_tolerance);)
ROW(probe_code_bytes, put_u(r, olx_probe_code_bytes(s->bits[0] % 512u));)
ROW(probe_code, const uint32_t count = s->field->info.probes.count;
    put_u(r, has_voronoi(s) ? olx_probe_code(olx_voronoi_codes(s->field), olx_probe_code_bytes(count),
                                             s->bits[0] % (tree_of(s) + count)) : 0);)
ROW(voronoi_tree, put_u(r, tree_of(s));)
ROW(middle, const uint32_t begin = s->bits[0] & 0xFFu; put_u(r, olx_middle(begin, begin + (s->bits[1] & 0xFFFFu)));)
ROW(consider, nearest n = nearest_of(s, s->bits[1]); consider(&n, s->probe); put_nearest(r, &n);)
ROW(search_tree, nearest n = nearest_of(s, s->bits[1]); if (has_voronoi(s)) { search_tree(&n); put_nearest(r, &n); })
ROW(voronoi_nearest, put_u(r, has_voronoi(s) ? olx_voronoi_nearest(s->field, s->point, s->settings.keep_buried) : 0);)
ROW(choice_texel, put_u(r, choice_texel(1.2f * s->random[0] - 0.1f, 4u << (s->bits[0] & 3u)));)
ROW(voronoi_neighbours, uint32_t choices[OLX_CHOICES] = {0};
    if (has_voronoi(s)) olx_voronoi_neighbours(s->field, s->probe, olx_scale(s->direction, s->item->v[15]), choices);
    for (uint32_t i = 0; i < OLX_CHOICES; i++) put_u(r, choices[i]);)
// clang-format on

static const parity_row ROWS[] = {
    PARITY(square, 2e-6f, 0),
    PARITY(sign_not_zero, 2e-6f, 0),
    PARITY(dot, 2e-6f, 0),
    PARITY(normalize, 2e-6f, 0),
    PARITY(basis, 2e-6f, 0),
    PARITY(from_basis, 2e-6f, 0),
    PARITY(octahedral_encode, 2e-6f, 0),
    PARITY(octahedral_point, 2e-6f, 0),
    PARITY(octahedral_decode, 2e-6f, 0),
    PARITY(texel_solid_angle_near, 2e-6f, 0),
    PARITY(half_unpack, 2e-6f, 0),
    PARITY(normal_unpack, 2e-6f, 0),
    PARITY(hash, 2e-6f, 0),
    PARITY(hash2, 2e-6f, 0),
    PARITY(unit_float, 2e-6f, 0),
    PARITY(owen_scramble, 2e-6f, 0),
    PARITY(sobol2, 2e-6f, 0),
    PARITY(stratified2, 2e-6f, 0),
    PARITY(turn, 2e-6f, 0),
    PARITY(sample_cosine, 2e-6f, 0),
    PARITY(bsdf_make, 2e-6f, 0),
    PARITY(pow5, 2e-6f, 0),
    PARITY(fresnel, 2e-6f, 0),
    PARITY(bsdf_diffuse, 2e-6f, 0),
    PARITY(bsdf_has_specular, 2e-6f, 0),
    PARITY(bsdf_specular_albedo, 2e-6f, 0),
    PARITY(ggx_lambda, 2e-6f, 0),
    PARITY(ggx_sample_half, 1e-4f, 0),
    PARITY(ggx_sample, 1e-4f, 0),
    PARITY(probe_position, 1e-6f, 0),
    PARITY(irradiance_probe_position, 1e-6f, 0),
    PARITY(map_corner, 1e-6f, 0),
    PARITY(map_origin, 1e-6f, 0),
    PARITY(texel_towards, 1e-6f, 1e-3),
    PARITY(texel_distance_bits, 1e-6f, 0),
    PARITY(texel_distance, 1e-6f, 0),
    PARITY(texel_emits, 1e-6f, 0),
    PARITY(texel_normal, 1e-6f, 0),
    PARITY(geometry_in_blocks, 0, 0),
    PARITY(geometry_block, 0, 0),
    PARITY(plane_in_block, 0, 0),
    PARITY(block_plane, 0, 0),
    PARITY(block_geometry, 1e-6f, 0),
    PARITY(texel_geometry_of, 1e-6f, 0),
    PARITY(texel_is_sky, 0, 0),
    PARITY(texel_emission_code, 0, 0),
    PARITY(texel_radiance, 1e-6f, 0),
    PARITY(irradiance_coordinate, 1e-6f, 0),
    PARITY(cage_at, 1e-6f, 0),
    PARITY(cage_has, 1e-6f, 0),
    PARITY(cage_probe, 1e-6f, 0),
    PARITY(cage_weight, 1e-6f, 0),
    PARITY(select_available, 1e-6f, 0),
    PARITY(select_resolve, 1e-6f, 0),
    PARITY(sample_settings_default, 1e-6f, 0),
    PARITY(probe_code_bytes, 1e-6f, 0),
    PARITY(probe_code, 1e-6f, 0),
    PARITY(voronoi_tree, 1e-6f, 0),
    PARITY(middle, 1e-6f, 0),
    PARITY(consider, 1e-6f, 0),
    PARITY(search_tree, 1e-6f, 0),
    PARITY(voronoi_nearest, 1e-6f, 0),
    PARITY(choice_texel, 1e-6f, 0),
    PARITY(voronoi_neighbours, 1e-6f, 1e-3),
};
static const parity_code CODES[] = {
    {ROWS_OF_CORE, {CORE_CODE, sizeof CORE_CODE}},
    {ROWS_OF_FIELD, {FIELD_CODE, sizeof FIELD_CODE}},
};
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {0, ROWS_OF_FIELD},
    [PARITY_OPEN_COURT] = {ROWS_OF_CORE, ROWS_OF_FIELD},
    [PARITY_MANY_PROBES] = {ROWS_OF_CORE, ROWS_OF_FIELD},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
