// Shows the smallest use of the runtime: opens a baked field and looks up the light at a point.
#include <octalux/octalux.h>

#include <math.h>
#include <stdio.h>

int main(int argc, char **argv) {
  olx_field *field;
  if (argc < 2 || olx_field_open(argv[1], &field) != OLX_OK) {
    fprintf(stderr, "minimal: %s\n", argc < 2 ? "name a field, as `octalux bake` writes it" : olx_last_error());
    return 1;
  }
  const olx_field_info info = olx_field_describe(field);
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_vec3 from = olx_field_probe_position(field, 0), up = {0, 1, 0}, down = {0, -1, 0};

  const olx_trace_hit hit = olx_trace(field, &settings, from, down, INFINITY);
  const olx_vec3 light = hit.status == OLX_TRACE_HIT
                             ? olx_surface_irradiance(field, &settings, hit.position, up, up, up)
                             : olx_volume_irradiance(field, from, up);
  printf("%u probes; %s after %.2f m; irradiance %.3f %.3f %.3f W/m^2\n", info.probes.count,
         hit.status == OLX_TRACE_HIT ? "floor" : "nothing", (double)hit.distance_metres, (double)light.x,
         (double)light.y, (double)light.z);
  olx_field_close(field);
  return 0;
}
