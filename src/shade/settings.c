// Holds the defaults of the settings for sampling a field, and refuses settings that a field does not support.
// Its twin is shaders/lib/settings.glsl.
#include "core/result.h"
#include "select/select.h"

#include <octalux/sample.h>

olx_sample_settings olx_sample_settings_default(void) {
  return (olx_sample_settings){
      .tracer = OLX_TRACER_HIZ,
      .select = OLX_SELECT_BEST,
      .visibility = OLX_VISIBILITY_CHEBYSHEV,
      .max_probes = 16,
  };
}

olx_result olx_probe_light_check(const olx_field *field) {
  if (field->info.irradiance.probe_count) return OLX_OK;
  return olx_fail(
      OLX_ERROR_ARGUMENT,
      "%s: baked without probe light, that is radiance as probes saw it and irradiance probes: `octalux bake "
      "--probe-light` stores it",
      field->name);
}

olx_result olx_sample_settings_check(const olx_field *field, const olx_sample_settings *settings) {
  if (settings->tracer > OLX_TRACER_HIZ || settings->select > OLX_SELECT_BEST ||
      settings->visibility > OLX_VISIBILITY_CHEBYSHEV || settings->hits > OLX_HITS_STORED) {
    return olx_fail(OLX_ERROR_ARGUMENT,
                    "%s: settings name no tracer, selector, visibility or light of hits that there is (%u, %u, %u, %u)",
                    field->name, (unsigned)settings->tracer, (unsigned)settings->select, (unsigned)settings->visibility,
                    (unsigned)settings->hits);
  }
  if (!(settings->surface_tolerance >= 0.0f && settings->surface_tolerance <= OLX_MOST_SURFACE_TOLERANCE)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a surface tolerance of %g footprints is not within 0 to %g",
                    (double)settings->surface_tolerance, (double)OLX_MOST_SURFACE_TOLERANCE);
  }
  if (settings->hits == OLX_HITS_STORED) OLX_TRY(olx_probe_light_check(field));
  if (olx_select_available(field, settings->select)) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: baked without the selector '%s'", field->name,
                  olx_select_name(settings->select));
}
