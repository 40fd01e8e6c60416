// Measures what finding probes costs on one thread, by selector: selector-speed FIELD.olx [COUNT]. Rays leave surfaces
// that probes see, cosine-distributed. All selectors that the field has take turns with each block of rays, each of
// them first in its turn, so that the state of caches is alike for all of them. Prints a Markdown table.
#include "options.h"
#include "studies.h"

#include <octalux/octalux.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const char NAME[] = BENCH_PROGRAM " selector-speed";

enum { BLOCK = 5000 };

// Returns the processor time of this process alone.
static double seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

// Returns a pseudorandom number in [0, 1) for each i and salt (splitmix64).
static float unit(uint64_t i, uint64_t salt) {
  uint64_t x = (i * 16 + salt) * 0x9E3779B97F4A7C15u;
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return (float)((x ^ x >> 31) >> 40) * 0x1p-24f;
}

static olx_vec3 unit_vector(uint64_t i, uint64_t salt) {
  const float z = 1.0f - 2.0f * unit(i, salt), r = sqrtf(fmaxf(0.0f, 1.0f - z * z));
  const float phi = 6.2831853f * unit(i, salt + 1);
  return (olx_vec3){r * cosf(phi), z, r * sinf(phi)};
}

typedef struct query {
  olx_vec3 position, direction;
} query;

// Makes a query slightly off a surface point that some probe sees, in a direction away from the surface. Returns false
// when the probe sees the sky.
static bool query_at(const olx_field *field, const olx_field_info *info, uint64_t i, query *q) {
  const uint32_t probe = (uint32_t)(unit(i, 0) * (float)info->probes.count);
  if (olx_field_probe_buried(field, probe)) return false;
  olx_sample_settings settings = olx_sample_settings_default();
  settings.select = OLX_SELECT_EXHAUSTIVE;
  const olx_trace_hit hit =
      olx_trace(field, &settings, olx_field_probe_position(field, probe), unit_vector(i, 1), INFINITY);
  if (hit.status != OLX_TRACE_HIT) return false;
  const float off = 1e-5f * info->maps.distance_scale_metres;
  const olx_vec3 n = hit.normal, p = hit.position, s = unit_vector(i, 3);
  q->position = (olx_vec3){p.x + off * n.x, p.y + off * n.y, p.z + off * n.z};
  const olx_vec3 d = {n.x + s.x, n.y + s.y, n.z + s.z}; // cosine-distributed
  const float length = sqrtf(d.x * d.x + d.y * d.y + d.z * d.z);
  if (!(length > 1e-3f)) return false;
  q->direction = (olx_vec3){d.x / length, d.y / length, d.z / length};
  return true;
}

typedef struct sums {
  double seconds;
  uint64_t steps, probes, unknown;
} sums;

static void trace_block(const olx_field *field, olx_select select, const query *queries, uint32_t count, sums *sum) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.select = select;
  const double start = seconds();
  for (uint32_t i = 0; i < count; i++) {
    const olx_trace_hit hit = olx_trace(field, &settings, queries[i].position, queries[i].direction, INFINITY);
    sum->steps += hit.texel_steps;
    sum->probes += hit.probes_tried;
    sum->unknown += hit.status == OLX_TRACE_UNKNOWN;
  }
  sum->seconds += seconds() - start;
}

static void measure(const olx_field *field, const olx_field_info *info, uint32_t count, query *queries) {
  const uint32_t mask = info->select_mask | 1u << OLX_SELECT_EXHAUSTIVE;
  sums sum[OLX_SELECT_BEST] = {{0}};
  uint32_t rays = 0, blocks = 0;
  for (uint64_t i = 0; rays < count && i < 100u * (uint64_t)count;) {
    uint32_t block = 0;
    for (; block < BLOCK && i < 100u * (uint64_t)count; i++) block += query_at(field, info, i, &queries[block]);
    for (uint32_t turn = 0; turn < OLX_SELECT_BEST; turn++) {
      const olx_select select = (olx_select)((turn + blocks) % OLX_SELECT_BEST);
      if (mask & 1u << select) trace_block(field, select, queries, block, &sum[select]);
    }
    rays += block;
    blocks++;
  }
  if (rays == 0) return;
  printf("%u probes of %u^2, %u rays\n\n| selector | ns a ray | texel steps | probes tried | unresolved |\n",
         info->probes.count, info->maps.size, rays);
  printf("|---|---|---|---|---|\n");
  for (olx_select select = OLX_SELECT_CAGE; select < OLX_SELECT_BEST; select++) {
    if (!(mask & 1u << select)) continue;
    const sums *s = &sum[select];
    const double n = rays;
    printf("| %s | %.0f | %.1f | %.2f | %.2f %% |\n", olx_select_name(select), 1e9 * s->seconds / n,
           (double)s->steps / n, (double)s->probes / n, 100.0 * (double)s->unknown / n);
  }
}

int study_selector_speed(int argc, char **argv) {
  const long count = argc > 2 ? strtol(argv[2], NULL, 10) : 100000;
  if (count < 1 || count > INT32_MAX) return usage_error(NAME, "'%s' is not a number of rays", argv[2]);
  olx_field *field;
  if (olx_field_open(argv[1], &field) != OLX_OK) {
    return library_failure(NAME);
  }
  const olx_field_info info = olx_field_describe(field);
  query *queries = malloc(BLOCK * sizeof *queries);
  if (queries) measure(field, &info, (uint32_t)count, queries);
  free(queries);
  olx_field_close(field);
  return 0;
}
