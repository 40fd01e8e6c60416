// Measures the time of the diffuse pass with light stored at surfaces and with irradiance probes, in turns.
#include "surfaces.h"

#include <math.h>

enum { TURNS = 5, QUICK_TURNS = 1, POINTS_A_PIXEL = 4 };

static double count_points(const olx_image *image) {
  double count = 0.0;
  for (uint32_t i = 0; i < image->width * image->height; ++i)
    count += isfinite(image->layers[OLX_LAYER_DEPTH][i].x) ? POINTS_A_PIXEL : 0.0;
  return count;
}

// Sums the processor time of the diffuse pass and its points, over all cameras.
static olx_result time_turn(const surface_run *r, const olx_field *field, olx_diffuse diffuse, double *ns) {
  olx_render_settings settings = bench_field_settings(r->b);
  settings.diffuse = diffuse;
  settings.spp = POINTS_A_PIXEL;
  settings.centered = true;
  settings.glossy_samples = 1;
  double seconds = 0.0, points = 0.0;
  for (uint32_t c = 0; c < r->camera_count; ++c) {
    olx_image image;
    olx_render_stats stats;
    const olx_result result = olx_render(r->scene, field, &r->cameras[c], &settings, &r->b->progress, &image, &stats);
    if (result != OLX_OK) return result;
    seconds += stats.diffuse_seconds;
    points += count_points(&image);
    olx_image_free(&image);
  }
  *ns = points > 0.0 ? 1e9 * seconds / points : NAN;
  return OLX_OK;
}

olx_result surface_times(const surface_run *r, const olx_field *field, double *surface_ns, double *irradiance_ns) {
  const uint32_t turns = r->b->options->quick ? QUICK_TURNS : TURNS;
  double surface[TURNS], irradiance[TURNS];
  bench_progress(r->b, "timing %s", r->name);
  for (uint32_t t = 0; t < turns; ++t) {
    olx_result result = time_turn(r, field, OLX_DIFFUSE_SURFACE, &surface[t]);
    if (result == OLX_OK) result = time_turn(r, field, OLX_DIFFUSE_IRRADIANCE, &irradiance[t]);
    if (result != OLX_OK) return result;
  }
  *surface_ns = bench_median(surface, turns);
  *irradiance_ns = bench_median(irradiance, turns);
  return OLX_OK;
}
