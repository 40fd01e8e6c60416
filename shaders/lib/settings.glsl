// Twin of src/shade/settings.c: the settings for sampling a field, and their defaults.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_SETTINGS_GLSL
#define OLX_SETTINGS_GLSL

#include "../octalux_shared.h"

// ESSL has no specialisation constants; a host defines what differs before this file.
#ifndef GL_ES
layout(constant_id = OLX_CONSTANT_TRACER) const uint olx_constant_tracer = 2u; // OLX_TRACER_HIZ
layout(constant_id = OLX_CONSTANT_SELECT) const uint olx_constant_select = 3u; // OLX_SELECT_BRICKS
layout(constant_id = OLX_CONSTANT_HITS) const uint olx_constant_hits = 0u;     // OLX_HITS_SHADED
#else
#ifndef OLX_WEB_SELECT
#define OLX_WEB_SELECT OLX_SELECT_BRICKS
#endif
const uint olx_constant_tracer = OLX_TRACER_HIZ;
const uint olx_constant_select = OLX_WEB_SELECT;
const uint olx_constant_hits = OLX_HITS_SHADED;
#endif

// The settings for sampling a field (olx_sample_settings in octalux/sample.h). If tracer, selector or kind of hit light
// is not a constant, the shader contains all of them: several times the code, which drivers compile for several times
// as long.
struct olx_sample_settings {
  uint tracer; // OLX_TRACER_*
  uint select; // OLX_SELECT_*
  bool visibility;
  uint max_probes;
  bool keep_buried, emitters;
  uint hits;               // OLX_HITS_*
  float surface_tolerance; // footprints
};

olx_sample_settings olx_sample_settings_default() {
  return olx_sample_settings(olx_constant_tracer, olx_constant_select, true, 16u, false, false, olx_constant_hits,
                             0.0);
}

#endif
