// Compares shaders/lib/classic.glsl with its specification, src/shade/classic.c, on random fields (tests/parity.h).
#include "shade/classic.c"

#include "parity.h"

static const uint32_t CODE[] = {
#include "parity_classic.spv.inc"
};

static void put_weights(const parity_state *s, parity_result *r) {
  const olx_irradiance_weights w = weigh(s->field, &s->settings, s->point, s->direction);
  put_u(r, w.count);
  for (uint32_t i = 0; i < w.count; i++) {
    put_u(r, w.probe[i]);
    put_f(r, w.weight[i]);
  }
}

static void put_color(const parity_state *s, parity_result *r) {
  const olx_classic_maps *maps = &s->field->classic;
  const olx_bilinear b = olx_bilinear_at(random_2(s), maps->size);
  put_3(r, map_color(maps->irradiance + maps->irradiance_texels * s->irradiance_probe, &b));
}

// clang-format off
ROW(classic_color, put_color(s, r);)
ROW(classic_vector, put_3(r, s->field->classic.boxes[s->irradiance_probe].low);)
ROW(classic_parallax, put_3(r, olx_classic_parallax(&s->field->classic.boxes[s->irradiance_probe],
        s->field->irradiance_positions[s->irradiance_probe], s->point, s->direction));)
ROW(classic_reflectance, put_2(r, olx_classic_reflectance(s->field->classic.table, 1.2f * s->random[0] - 0.1f,
        1.2f * s->random[1] - 0.1f));)
ROW(classic_side, put_u(r, olx_classic_side(s->field->classic.size, s->bits[1] % OLX_CLASSIC_LEVELS));)
ROW(classic_radiance, put_3(r, olx_classic_radiance(&s->field->classic, s->irradiance_probe, s->direction,
        1.2f * s->random[2] - 0.1f));)
ROW(classic_weigh, put_weights(s, r);)
ROW(classic_irradiance, put_3(r, olx_classic_irradiance(s->field, &s->settings, s->point, s->direction));)
ROW(classic_glossy, put_3(r, olx_classic_glossy(s->field, &s->settings, s->point, s->direction, s->view, s->random[0],
        olx_v3(fabsf(s->view.x), fabsf(s->view.y), fabsf(s->view.z)), s->random[1]));)
// clang-format on

// clang-format off
static const parity_row ROWS[] = {
    PARITY(classic_color, 1e-5f, 0),
    PARITY(classic_vector, 0.0f, 0),
    PARITY(classic_parallax, 1e-4f, 1e-3),
    PARITY(classic_reflectance, 1e-5f, 0),
    PARITY(classic_side, 0.0f, 0),
    PARITY(classic_radiance, 1e-4f, 1e-3),
    PARITY(classic_weigh, 1e-5f, 1e-3),
    PARITY(classic_irradiance, 1e-4f, 1e-3),
    PARITY(classic_glossy, 1e-4f, 1e-3),
};
// clang-format on
static const parity_code CODES[] = {{ROWS_OF_CLASSIC, {CODE, sizeof CODE}}};
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_CLASSIC_ROOM] = {ROWS_OF_RELIGHT, ROWS_OF_CLASSIC},
    [PARITY_CLASSIC_WALL] = {ROWS_OF_RELIGHT, ROWS_OF_CLASSIC},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
