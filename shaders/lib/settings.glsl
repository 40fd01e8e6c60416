// Twin of src/shade/settings.c.
#ifndef OLX_SETTINGS_GLSL
#define OLX_SETTINGS_GLSL

#include "../octalux_shared.h"

// See olx_sample_settings in octalux/sample.h.
struct olx_sample_settings {
  uint tracer; // OLX_TRACER_*
  uint select; // OLX_SELECT_*
  bool visibility;
  uint max_probes; // at most OLX_MAX_ATTEMPTS
  bool keep_buried, emitters;
};

olx_sample_settings olx_sample_settings_default() {
  return olx_sample_settings(OLX_TRACER_HIZ, OLX_SELECT_BEST, true, OLX_MAX_ATTEMPTS, false, false);
}

#endif
