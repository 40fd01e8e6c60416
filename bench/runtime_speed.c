// What the runtime's calls cost on one thread: runtime_speed FIELD.olx [COUNT]. Prints a Markdown table with a row for each
// fast path and for the plain one it replaces.
#include <octalux/octalux.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// A number in [0, 1) for each i and salt (splitmix64).
static float unit(uint64_t i, uint64_t salt) {
  uint64_t x = (i * 16 + salt) * 0x9E3779B97F4A7C15u;
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return (float)((x ^ x >> 31) >> 40) * 0x1p-24f;
}

typedef struct query {
  olx_vec3 position, direction;
} query;

// Points in the middle nine tenths of the scene, directions all around.
static query query_at(const olx_field_info *info, uint64_t i) {
  const olx_vec3 low = info->scene_min, high = info->scene_max;
  const float z = 1.0f - 2.0f * unit(i, 3), r = sqrtf(fmaxf(0.0f, 1.0f - z * z)), phi = 6.2831853f * unit(i, 4);
  return (query){
      .position = {low.x + (high.x - low.x) * (0.05f + 0.9f * unit(i, 0)),
                   low.y + (high.y - low.y) * (0.05f + 0.9f * unit(i, 1)),
                   low.z + (high.z - low.z) * (0.05f + 0.9f * unit(i, 2))},
      .direction = {r * cosf(phi), z, r * sinf(phi)},
  };
}

static void measure_rays(const olx_field *field, const olx_field_info *info, olx_tracer tracer, const char *name,
                         uint32_t count) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.tracer = tracer;
  uint64_t steps = 0, probes = 0, unknown = 0;
  const double start = seconds();
  for (uint32_t i = 0; i < count; i++) {
    const query q = query_at(info, i);
    const olx_trace_hit hit = olx_trace(field, &settings, q.position, q.direction, INFINITY);
    steps += hit.texel_steps;
    probes += hit.probes_tried;
    unknown += hit.status == OLX_TRACE_UNKNOWN;
  }
  const double n = count;
  printf("| ray, %s | %.0f | %.1f | %.2f | %.2f %% |\n", name, 1e9 * (seconds() - start) / n, (double)steps / n,
         (double)probes / n, 100.0 * (double)unknown / n);
}

static void measure_irradiance(const olx_field *field, const olx_field_info *info, olx_visibility visibility,
                               const char *name, uint32_t count) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.visibility = visibility;
  float sum = 0.0f;
  const double start = seconds();
  for (uint32_t i = 0; i < count; i++) {
    const query q = query_at(info, i);
    sum += olx_irradiance(field, &settings, q.position, q.direction, q.direction).y;
  }
  const double nanoseconds = 1e9 * (seconds() - start) / count;
  // Using the sum keeps the calls from being optimised away.
  printf("| irradiance, %s | %.0f | | | %s |\n", name, nanoseconds, isfinite(sum) ? "" : "not finite");
}

int main(int argc, char **argv) {
  const long count = argc > 2 ? strtol(argv[2], NULL, 10) : 100000;
  if (argc < 2 || count < 1 || count > INT32_MAX) {
    fprintf(stderr, "usage: runtime_speed FIELD.olx [COUNT]\n");
    return 2;
  }
  olx_field *field;
  if (olx_field_open(argv[1], &field) != OLX_OK) {
    fprintf(stderr, "runtime_speed: %s\n", olx_last_error());
    return 1;
  }
  const olx_field_info info = olx_field_describe(field);
  printf("%u probes of %u^2, irradiance %u^2, %ld calls each\n\n", info.probe_count, info.radiance_size,
         info.irradiance_size, count);
  printf("| call | ns | texel steps | probes | unresolved |\n|---|---|---|---|---|\n");
  measure_rays(field, &info, OLX_TRACER_TEXEL, "every texel", (uint32_t)count);
  measure_rays(field, &info, OLX_TRACER_TWO_LEVEL, "two-level", (uint32_t)count);
  measure_irradiance(field, &info, OLX_VISIBILITY_NONE, "no visibility", (uint32_t)count);
  measure_irradiance(field, &info, OLX_VISIBILITY_CHEBYSHEV, "Chebyshev", (uint32_t)count);
  olx_field_close(field);
  return 0;
}
