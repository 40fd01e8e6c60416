// Names each kind of map, and finds where it is stored and how its texels are decoded.
#include "export/map_texels.h"

#include "core/result.h"
#include "field/texels.h"

enum { VOLUME_SIDE = 32 };

typedef enum probe_kind { LIGHT_FIELD, IRRADIANCE, VOLUME } probe_kind;
typedef enum map_need { NOTHING, PROBE_LIGHT, CLASSIC_MAPS, A_VOLUME } map_need;

// A position in a field's maps: texel (x, y), and its index in light field maps with border.
typedef struct texel_place {
  olx_map map;
  uint32_t probe, x, y;
  size_t index;
} texel_place;

static olx_vec3 single(float value) { return olx_v3(value, 0.0f, 0.0f); }

static olx_vec3 read_distance(const olx_field *f, const texel_place *p) {
  return single(olx_texel_distance(f, p->probe, p->index));
}
static olx_vec3 read_emitter(const olx_field *f, const texel_place *p) {
  const bool shines = olx_texel_emits(f, p->probe, p->index) || olx_texel_is_sky(f, p->probe, p->index);
  return single(shines ? 1.0f : 0.0f);
}
static olx_vec3 read_normal(const olx_field *f, const texel_place *p) {
  return olx_texel_normal(f, p->probe, p->index);
}
static olx_vec3 read_base_color(const olx_field *f, const texel_place *p) {
  return olx_texel_parameters_of(f, p->probe, p->index).base_color;
}
static olx_vec3 read_roughness(const olx_field *f, const texel_place *p) {
  return single(olx_texel_parameters_of(f, p->probe, p->index).roughness);
}
static olx_vec3 read_metallic(const olx_field *f, const texel_place *p) {
  return single(olx_texel_parameters_of(f, p->probe, p->index).metallic);
}
static olx_vec3 read_specular_weight(const olx_field *f, const texel_place *p) {
  return single(olx_texel_parameters_of(f, p->probe, p->index).specular_weight);
}
static olx_vec3 read_direct(const olx_field *f, const texel_place *p) {
  return olx_texel_direct(f, p->probe, p->index);
}
static olx_vec3 read_indirect(const olx_field *f, const texel_place *p) {
  return olx_texel_indirect(f, p->probe, p->index);
}
static olx_vec3 read_emission(const olx_field *f, const texel_place *p) {
  return olx_texel_emission(f, p->probe, p->index);
}
static olx_vec3 read_radiance(const olx_field *f, const texel_place *p) {
  return olx_texel_radiance(f, p->probe, p->index);
}

// Evaluates spherical harmonics in the direction of a texel's centre.
static olx_vec3 read_harmonics(const uint16_t *halves, uint32_t bands, const texel_place *p, uint32_t side) {
  float values[OLX_HARMONICS_MOST];
  olx_harmonics_at(olx_texel_direction(p->x, p->y, side), values);
  return olx_harmonics_irradiance(halves, bands, values);
}
static olx_vec3 read_irradiance(const olx_field *f, const texel_place *p) {
  if (f->bands) {
    return read_harmonics(f->harmonics + (size_t)f->harmonic_halves * p->probe, f->bands, p, f->irradiance_n);
  }
  return olx_r11g11b10f_unpack(f->irradiance[f->irradiance_texels * p->probe + p->index]);
}
static olx_vec3 read_mean_distance(const olx_field *f, const texel_place *p) {
  const uint32_t moments = f->moments[f->irradiance_texels * p->probe + p->index];
  return single(olx_half_unpack((uint16_t)(moments & 0xFFFFu)) * f->distance_scale);
}
static olx_vec3 read_mean_square(const olx_field *f, const texel_place *p) {
  const uint32_t moments = f->moments[f->irradiance_texels * p->probe + p->index];
  return single(olx_half_unpack((uint16_t)(moments >> 16)) * f->distance_scale * f->distance_scale);
}

static olx_vec3 read_classic_irradiance(const olx_field *f, const texel_place *p) {
  return olx_r11g11b10f_unpack(f->classic.irradiance[f->classic.irradiance_texels * p->probe + p->index]);
}
static uint32_t classic_level(olx_map map) { return (uint32_t)map - OLX_MAP_CLASSIC_RADIANCE_0; }
static olx_vec3 read_classic_radiance(const olx_field *f, const texel_place *p) {
  const olx_classic_maps *c = &f->classic;
  return olx_r11g11b10f_unpack(
      c->radiance[c->radiance_texels * p->probe + c->level_first[classic_level(p->map)] + p->index]);
}

static olx_vec3 read_volume(const olx_field *f, const texel_place *p) {
  return read_harmonics(f->volume.irradiance + (size_t)OLX_VOLUME_HALVES * p->probe, OLX_VOLUME_BANDS, p, VOLUME_SIDE);
}

typedef struct map_row {
  const char *name;
  probe_kind kind;
  map_need need;
  uint32_t channels;
  olx_vec3 (*read)(const olx_field *field, const texel_place *place);
} map_row;

static const map_row rows[OLX_MAP_COUNT] = {
    [OLX_MAP_DISTANCE] = {"distance", LIGHT_FIELD, NOTHING, 1, read_distance},
    [OLX_MAP_EMITTER] = {"emitter", LIGHT_FIELD, NOTHING, 1, read_emitter},
    [OLX_MAP_NORMAL] = {"normal", LIGHT_FIELD, NOTHING, 3, read_normal},
    [OLX_MAP_BASE_COLOR] = {"base_color", LIGHT_FIELD, NOTHING, 3, read_base_color},
    [OLX_MAP_ROUGHNESS] = {"roughness", LIGHT_FIELD, NOTHING, 1, read_roughness},
    [OLX_MAP_METALLIC] = {"metallic", LIGHT_FIELD, NOTHING, 1, read_metallic},
    [OLX_MAP_SPECULAR_WEIGHT] = {"specular_weight", LIGHT_FIELD, NOTHING, 1, read_specular_weight},
    [OLX_MAP_DIRECT] = {"direct", LIGHT_FIELD, NOTHING, 3, read_direct},
    [OLX_MAP_INDIRECT] = {"indirect", LIGHT_FIELD, NOTHING, 3, read_indirect},
    [OLX_MAP_EMISSION] = {"emission", LIGHT_FIELD, NOTHING, 3, read_emission},
    [OLX_MAP_RADIANCE] = {"radiance", LIGHT_FIELD, PROBE_LIGHT, 3, read_radiance},
    [OLX_MAP_IRRADIANCE] = {"irradiance", IRRADIANCE, PROBE_LIGHT, 3, read_irradiance},
    [OLX_MAP_MEAN_DISTANCE] = {"mean_distance", IRRADIANCE, PROBE_LIGHT, 1, read_mean_distance},
    [OLX_MAP_MEAN_SQUARE_DISTANCE] = {"mean_square_distance", IRRADIANCE, PROBE_LIGHT, 1, read_mean_square},
    [OLX_MAP_CLASSIC_IRRADIANCE] = {"classic_irradiance", IRRADIANCE, CLASSIC_MAPS, 3, read_classic_irradiance},
    [OLX_MAP_CLASSIC_RADIANCE_0] = {"classic_radiance_0", IRRADIANCE, CLASSIC_MAPS, 3, read_classic_radiance},
    [OLX_MAP_CLASSIC_RADIANCE_1] = {"classic_radiance_1", IRRADIANCE, CLASSIC_MAPS, 3, read_classic_radiance},
    [OLX_MAP_CLASSIC_RADIANCE_2] = {"classic_radiance_2", IRRADIANCE, CLASSIC_MAPS, 3, read_classic_radiance},
    [OLX_MAP_CLASSIC_RADIANCE_3] = {"classic_radiance_3", IRRADIANCE, CLASSIC_MAPS, 3, read_classic_radiance},
    [OLX_MAP_CLASSIC_RADIANCE_4] = {"classic_radiance_4", IRRADIANCE, CLASSIC_MAPS, 3, read_classic_radiance},
    [OLX_MAP_VOLUME_IRRADIANCE] = {"volume_irradiance", VOLUME, A_VOLUME, 3, read_volume},
};

const char *olx_map_name(olx_map map) { return (uint32_t)map < OLX_MAP_COUNT ? rows[map].name : "unknown"; }

uint32_t olx_map_channels(olx_map map) { return rows[map].channels; }

uint32_t olx_map_side(const olx_field *field, olx_map map) {
  const map_row *row = &rows[map];
  if (row->kind == LIGHT_FIELD) return field->n;
  if (row->kind == VOLUME) return VOLUME_SIDE;
  if (row->need == PROBE_LIGHT) return field->irradiance_n;
  return map == OLX_MAP_CLASSIC_IRRADIANCE ? field->classic.size
                                           : olx_classic_side(field->classic.size, classic_level(map));
}

static bool has(const olx_field *field, map_need need) {
  switch (need) {
  case NOTHING: return true;
  case PROBE_LIGHT: return field->info.irradiance.probe_count > 0;
  case CLASSIC_MAPS: return field->classic.size > 0;
  case A_VOLUME: return field->info.volume.probe_count > 0;
  }
  return false;
}

static uint32_t probe_count(const olx_field *field, probe_kind kind) {
  return kind == LIGHT_FIELD  ? field->info.probes.count
         : kind == IRRADIANCE ? field->info.irradiance.probe_count
                              : field->info.volume.probe_count;
}

olx_result olx_map_check(const olx_field *field, olx_map map, uint32_t probe) {
  static const char *const needs[] = {[PROBE_LIGHT] = "probe light (bake --probe-light)",
                                      [CLASSIC_MAPS] = "classic maps (bake --classic)",
                                      [A_VOLUME] = "an irradiance volume"};
  static const char *const kinds[] = {"light field probes", "irradiance probes", "probes of the irradiance volume"};
  if ((uint32_t)map >= OLX_MAP_COUNT) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: no kind of map has the number %u", field->name, (uint32_t)map);
  }
  const map_row *row = &rows[map];
  if (!has(field, row->need)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: no map %s: baked without %s", field->name, row->name, needs[row->need]);
  }
  const uint32_t count = probe_count(field, row->kind);
  if (probe < count) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: no probe %u: map %s is of %u %s, counted from 0", field->name, probe,
                  row->name, count, kinds[row->kind]);
}

olx_vec3 olx_map_texel(const olx_field *field, olx_map map, uint32_t probe, uint32_t x, uint32_t y) {
  const uint32_t stride = olx_map_side(field, map) + 2;
  const texel_place place = {
      .map = map, .probe = probe, .x = x, .y = y, .index = olx_map_index(stride, (int32_t)x, (int32_t)y)};
  return rows[map].read(field, &place);
}
