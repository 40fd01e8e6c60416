// Measures light that leaks behind walls: past gaps of some widths, and through whole walls of a few centimetres, in
// every mode.
#include "surfaces.h"

#include <octalux/sample.h>

#include <math.h>

static const bench_column leak_columns[] = {
    {"wall", "wall", BENCH_NAME, NULL, "between a lit and a dark room"},
    {"probes", "probes", BENCH_NAME, NULL, "where they stand"},
    {"dark", "dark room", BENCH_QUALITY, NULL, "mean of indirect diffuse light over the lit room's, path traced"},
    {"leak", "leak", BENCH_QUALITY, NULL, "what the field has too much of it, over the lit room's"},
    {"bias", "bias", BENCH_QUALITY, "%", "what the field has too much of it, over the dark room's"},
};

static const bench_column thin_columns[] = {
    {"wall", "whole wall", BENCH_NAME, NULL, "its thickness; it stands off every plane of a grid"},
    {"mode", "mode", BENCH_NAME, NULL, "how diffuse light is had"},
    {"leak", "leak", BENCH_QUALITY, NULL, "mean of indirect diffuse light in the dark room over the lit room's"},
};

static const bench_plot leak_plots[] = {{"Light behind walls", NULL, "leak", NULL, false, false}};
static const bench_plot thin_plots[] = {{"Light through thin walls", NULL, "leak", NULL, false, false}};

void surface_leak_tables(surface_run *r) {
  r->leaks = FINDINGS_TABLE(&r->b->found, "leaks", "Light behind walls and through gaps", leak_columns, leak_plots);
  r->thin = FINDINGS_TABLE(&r->b->found, "thin", "Light through whole walls that are thin, placed probes", thin_columns,
                           thin_plots);
}

static const char *const rooms[2] = {"lit", "dark"};

static olx_result leak_of_way(surface_run *r) {
  bench_way way = {.name = surface_where(r), .settings = bench_field_settings(r->b)};
  way.settings.diffuse = OLX_DIFFUSE_SURFACE;
  bench_field made;
  bench_images images = {0};
  olx_result result = surface_bake(r, 0, false, &made);
  way.field = made.field;
  if (result == OLX_OK) result = bench_pictures(r->b, r->scene, r->cameras, 2, &way, &images);
  if (result == OLX_OK) {
    const double lit = surface_camera_light(r->reference, 0), truth = surface_camera_light(r->reference, 1);
    const double more = surface_camera_light(&images, 1) - truth;
    FINDINGS_ROW(&r->b->found, r->leaks, TEXT_CELL(r->what), TEXT_CELL(surface_where(r)), NUMBER_CELL(truth / lit),
                 NUMBER_CELL(more / lit), NUMBER_CELL(truth > 0.0 ? more / truth : NAN));
  }
  bench_images_free(&images);
  bench_field_close(&made);
  return result;
}

olx_result surface_leak(surface_run *r) {
  olx_result result = surface_keep_cameras(r, 2, rooms);
  if (result == OLX_OK) result = surface_reference(r, 4, false); // more paths, because little light comes through
  for (uint32_t way = 0; way < 2 && result == OLX_OK; ++way) {
    r->placed = way == 0;
    if (!surface_wants(r, r->placed)) continue;
    result = leak_of_way(r);
  }
  return result;
}

static olx_result add_thin(const surface_run *r, const olx_field *field, uint32_t mode) {
  const bench_way way = surface_mode(r, field, mode);
  bench_images images = {0};
  const olx_result result = bench_pictures(r->b, r->scene, r->cameras, 2, &way, &images);
  if (result == OLX_OK) {
    FINDINGS_ROW(&r->b->found, r->thin, TEXT_CELL(r->what), TEXT_CELL(way.name),
                 NUMBER_CELL(surface_camera_light(&images, 1) / surface_camera_light(&images, 0)));
  }
  bench_images_free(&images);
  return result;
}

// Returns the mean of the volume's light over a lattice of points in a box and six normals.
static double volume_light(const olx_field *field, olx_vec3 low, olx_vec3 high) {
  enum { SIDE = 12 };
  double sum = 0.0;
  for (uint32_t i = 0; i < 6 * SIDE * SIDE * SIDE; ++i) {
    const uint32_t at = i / 6;
    const float sign = i % 2 ? 1.0f : -1.0f, u = ((float)(at % SIDE) + 0.5f) / SIDE,
                v = ((float)(at / SIDE % SIDE) + 0.5f) / SIDE, w = ((float)(at / (SIDE * SIDE)) + 0.5f) / SIDE;
    const olx_vec3 place = {low.x + u * (high.x - low.x), low.y + v * (high.y - low.y), low.z + w * (high.z - low.z)};
    const olx_vec3 normal = {i % 6 / 2 == 0 ? sign : 0.0f, i % 6 / 2 == 1 ? sign : 0.0f, i % 6 / 2 == 2 ? sign : 0.0f};
    const olx_vec3 light = olx_volume_irradiance(field, place, normal);
    sum += (double)light.x + (double)light.y + (double)light.z;
  }
  return sum / (6 * SIDE * SIDE * SIDE);
}

// The dark room extends to the thickest wall that is measured, and the lit room to the thinnest.
static double volume_leak(const surface_run *r, const olx_field *field) {
  const olx_scene_info info = olx_scene_describe(r->scene);
  olx_vec3 lit_high = info.bounds_max, dark_low = info.bounds_min;
  lit_high.x = 0.13f;
  dark_low.x = 0.18f;
  return volume_light(field, dark_low, info.bounds_max) / volume_light(field, info.bounds_min, lit_high);
}

olx_result surface_thin_wall(surface_run *r) {
  olx_result result = surface_keep_cameras(r, 2, rooms);
  if (result != OLX_OK || !surface_wants(r, true)) return result;
  bench_field made;
  result = surface_bake(r, 0, true, &made);
  for (uint32_t mode = 0; mode < SURFACE_MODES && result == OLX_OK; ++mode) result = add_thin(r, made.field, mode);
  if (result == OLX_OK) {
    FINDINGS_ROW(&r->b->found, r->thin, TEXT_CELL(r->what), TEXT_CELL("irradiance volume"),
                 NUMBER_CELL(volume_leak(r, made.field)));
  }
  bench_field_close(&made);
  return result;
}
