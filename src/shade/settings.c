#include <octalux/sample.h>

olx_sample_settings olx_sample_settings_default(void) {
  return (olx_sample_settings){
      .tracer = OLX_TRACER_TWO_LEVEL,
      .select = OLX_SELECT_CAGE,
      .visibility = OLX_VISIBILITY_CHEBYSHEV,
      .max_probes = 128,
  };
}
