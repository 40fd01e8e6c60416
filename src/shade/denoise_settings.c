// Holds the presets of the denoiser's settings (as published, as tuned here, and off), and refuses settings out of
// range.
#include "core/result.h"

#include <octalux/denoiser.h>

#include <math.h>
#include <stdbool.h>

olx_denoise_settings olx_denoise_settings_published(void) {
  return (olx_denoise_settings){
      .diffuse = {.radius_pixels = 12, .stride_pixels = 2, .history = 0.98f, .still_history = 0.98f},
      .glossy = {.radius_pixels = 3, .stride_pixels = 1, .history = 0.75f, .still_history = 0.75f},
      .ray_spacing = 1,
  };
}

olx_denoise_settings olx_denoise_settings_default(void) {
  olx_denoise_settings settings = olx_denoise_settings_published();
  settings.diffuse.reach = 2.5f;
  settings.glossy.reach = 0.6f;
  settings.glossy.still_history = 0.98f;
  return settings;
}

olx_denoise_settings olx_denoise_settings_none(void) {
  return (olx_denoise_settings){.diffuse = {.stride_pixels = 1}, .glossy = {.stride_pixels = 1}, .ray_spacing = 1};
}

static olx_result check_filter(const olx_lobe_filter *f, const char *name) {
  const bool sane = f->radius_pixels <= 64 && f->stride_pixels >= 1 && f->stride_pixels <= 64 && f->history >= 0.0f &&
                    f->history <= 0.999f && f->still_history >= 0.0f && f->still_history <= 0.999f &&
                    f->reach >= 0.0f && isfinite(f->reach);
  return sane ? OLX_OK : olx_fail(OLX_ERROR_ARGUMENT, "denoise: the %s filter has a setting out of range", name);
}

olx_result olx_denoise_settings_check(const olx_denoise_settings *settings) {
  OLX_TRY(check_filter(&settings->diffuse, "diffuse"));
  OLX_TRY(check_filter(&settings->glossy, "glossy"));
  if (settings->ray_spacing == 1 || settings->ray_spacing == 2) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "denoise: rays are 1 or 2 pixels apart, not %u", settings->ray_spacing);
}
