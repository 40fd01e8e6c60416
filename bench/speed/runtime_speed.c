// Measures what the runtime's calls cost on one thread: runtime-speed FIELD.olx [COUNT]. Prints a Markdown table with a
// row for each fast path and for the plain one it replaces, and how many answers of the fast paths differ from those of
// the plain one.
#include "options.h"
#include "studies.h"

#include <octalux/octalux.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char NAME[] = BENCH_PROGRAM " runtime-speed";

// Returns the time of this thread alone, to reduce the influence of other work on the machine.
static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Returns a pseudorandom number in [0, 1) for each i and salt (splitmix64).
static float unit(uint64_t i, uint64_t salt) {
  uint64_t x = (i * 16 + salt) * 0x9E3779B97F4A7C15u;
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
  x = (x ^ x >> 27) * 0x94D049BB133111EBu;
  return (float)((x ^ x >> 31) >> 40) * 0x1p-24f;
}

typedef struct query {
  olx_vec3 position, direction;
} query;

// Returns a query at a point in the middle nine tenths of the scene, in any direction.
static query query_at(const olx_field_info *info, uint64_t i) {
  const olx_vec3 low = info->scene.bounds_min, high = info->scene.bounds_max;
  const float z = 1.0f - 2.0f * unit(i, 3), r = sqrtf(fmaxf(0.0f, 1.0f - z * z)), phi = 6.2831853f * unit(i, 4);
  return (query){
      .position = {low.x + (high.x - low.x) * (0.05f + 0.9f * unit(i, 0)),
                   low.y + (high.y - low.y) * (0.05f + 0.9f * unit(i, 1)),
                   low.z + (high.z - low.z) * (0.05f + 0.9f * unit(i, 2))},
      .direction = {r * cosf(phi), z, r * sinf(phi)},
  };
}

typedef struct ray {
  olx_vec3 origin, direction;
} ray;

// Returns a unit vector, cosine-distributed around n, or uniform where n is zero: the normalized sum of n and a point
// on the sphere.
static olx_vec3 around(olx_vec3 n, uint64_t i) {
  const olx_vec3 s = query_at(&(olx_field_info){0}, i).direction;
  const olx_vec3 d = {n.x + s.x, n.y + s.y, n.z + s.z};
  const float length = sqrtf(d.x * d.x + d.y * d.y + d.z * d.z);
  return length > 1e-3f ? (olx_vec3){d.x / length, d.y / length, d.z / length} : s;
}

// Traces ray i of an endless sequence from a probe that is not buried; returns false where the probe is buried or the
// ray meets no surface.
static bool meet_surface(const olx_field *field, const olx_field_info *info, uint64_t i, olx_trace_hit *hit) {
  const olx_sample_settings settings = olx_sample_settings_default();
  const uint32_t probe = (uint32_t)(unit(i, 5) * (float)info->probes.count);
  if (olx_field_probe_buried(field, probe)) return false;
  const olx_vec3 eye = olx_field_probe_position(field, probe);
  *hit = olx_trace(field, &settings, eye, query_at(info, i).direction, INFINITY);
  return hit->status == OLX_TRACE_HIT;
}

// Generates cosine-distributed rays from surfaces that probes see, like those of gathering and of glossy light.
static uint32_t surface_rays(const olx_field *field, const olx_field_info *info, ray *rays, uint32_t count) {
  uint32_t made = 0;
  for (uint64_t i = 0; made < count && i < (uint64_t)count * 64; i++) {
    olx_trace_hit hit;
    if (!meet_surface(field, info, i, &hit)) continue;
    const olx_vec3 p = hit.position, n = hit.normal;
    const float off = 0.05f * hit.footprint_metres;
    rays[made++] = (ray){{p.x + off * n.x, p.y + off * n.y, p.z + off * n.z}, around(n, i + count)};
  }
  return made;
}

// Generates mirror rays in image order: the eye is the first free probe of the middle, looking all around, row by row.
static uint32_t mirrored_rays(const olx_field *field, const olx_field_info *info, ray *rays, uint32_t count) {
  const olx_sample_settings settings = olx_sample_settings_default();
  uint32_t probe = info->probes.count / 2;
  while (probe + 1 < info->probes.count && olx_field_probe_buried(field, probe)) probe++;
  const olx_vec3 eye = olx_field_probe_position(field, probe);
  const uint32_t side = (uint32_t)ceilf(sqrtf((float)count));
  uint32_t made = 0;
  for (uint32_t i = 0; made < count && i < side * side; i++) {
    const float z = 1.0f - 2.0f * ((float)(i / side) + 0.5f) / (float)side, r = sqrtf(fmaxf(0.0f, 1.0f - z * z));
    const float phi = 6.2831853f * ((float)(i % side) + 0.5f) / (float)side;
    const olx_vec3 d = {r * cosf(phi), z, r * sinf(phi)};
    const olx_trace_hit hit = olx_trace(field, &settings, eye, d, INFINITY);
    if (hit.status != OLX_TRACE_HIT) continue;
    const olx_vec3 p = hit.position, n = hit.normal;
    const float off = 0.05f * hit.footprint_metres, twice = 2.0f * (d.x * n.x + d.y * n.y + d.z * n.z);
    rays[made++] = (ray){{p.x + off * n.x, p.y + off * n.y, p.z + off * n.z},
                         {d.x - twice * n.x, d.y - twice * n.y, d.z - twice * n.z}};
  }
  return made;
}

static uint32_t space_rays(const olx_field_info *info, ray *rays, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    const query q = query_at(info, i);
    rays[i] = (ray){q.position, q.direction};
  }
  return count;
}

typedef struct tracer_row {
  olx_tracer tracer;
  const char *name;
  double seconds;
  uint64_t steps, probes, unknown, different;
} tracer_row;

enum { BATCH = 1000 };

static void trace_batch(const olx_field *field, tracer_row *row, const ray *rays, uint32_t count, olx_trace_hit *hits) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.tracer = row->tracer;
  const double start = seconds();
  for (uint32_t i = 0; i < count; i++) {
    hits[i] = olx_trace(field, &settings, rays[i].origin, rays[i].direction, INFINITY);
    row->steps += hits[i].texel_steps;
    row->probes += hits[i].probes_tried;
    row->unknown += hits[i].status == OLX_TRACE_UNKNOWN;
  }
  row->seconds += seconds() - start;
}

// Tracers take turns on batches of rays, so that other work on the machine affects all alike.
static void measure_rays(const olx_field *field, const char *kind, const ray *rays, uint32_t count) {
  tracer_row rows[] = {{.tracer = OLX_TRACER_TEXEL, .name = "every texel"},
                       {.tracer = OLX_TRACER_TWO_LEVEL, .name = "two-level"},
                       {.tracer = OLX_TRACER_HIZ, .name = "hi-Z"}};
  enum { ROWS = sizeof rows / sizeof rows[0] };
  static olx_trace_hit hits[ROWS][BATCH];
  for (uint32_t first = 0; first < count; first += BATCH) {
    const uint32_t size = count - first < BATCH ? count - first : BATCH;
    for (uint32_t k = 0; k < ROWS; k++) {
      const uint32_t r = (k + first / BATCH) % ROWS;
      trace_batch(field, &rows[r], rays + first, size, hits[r]);
    }
    for (uint32_t r = 1; r < ROWS; r++) {
      for (uint32_t i = 0; i < size; i++) {
        const olx_trace_hit *a = &hits[0][i], *b = &hits[r][i];
        const bool same = a->status == b->status && a->probe == b->probe && a->distance_metres == b->distance_metres &&
                          memcmp(&a->radiance, &b->radiance, sizeof a->radiance) == 0;
        rows[r].different += !same;
      }
    }
  }
  const double n = count;
  for (uint32_t r = 0; r < ROWS; r++) {
    printf("| ray %s, %s | %.0f | %.1f | %.2f | %.2f %% | %llu |\n", kind, rows[r].name, 1e9 * rows[r].seconds / n,
           (double)rows[r].steps / n, (double)rows[r].probes / n, 100.0 * (double)rows[r].unknown / n,
           (unsigned long long)rows[r].different);
  }
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
  // Using the sum prevents the calls from being optimized away.
  printf("| irradiance, %s | %.0f | | | %s | |\n", name, nanoseconds, isfinite(sum) ? "" : "not finite");
}

// Finds points on surfaces that probes see, and their normals.
static uint32_t surface_points(const olx_field *field, const olx_field_info *info, ray *points, uint32_t count) {
  uint32_t made = 0;
  for (uint64_t i = 0; made < count && i < (uint64_t)count * 64; i++) {
    olx_trace_hit hit;
    if (meet_surface(field, info, i, &hit)) points[made++] = (ray){hit.position, hit.normal};
  }
  return made;
}

typedef olx_vec3 (*irradiance_call)(const olx_field *field, const olx_sample_settings *settings, const ray *point);

static olx_vec3 from_probes(const olx_field *field, const olx_sample_settings *settings, const ray *p) {
  return olx_irradiance(field, settings, p->origin, p->direction, p->direction);
}

static olx_vec3 from_surfaces(const olx_field *field, const olx_sample_settings *settings, const ray *p) {
  return olx_surface_irradiance(field, settings, p->origin, p->direction, p->direction, p->direction);
}

// Measures both methods for diffuse light in turns on batches of the same points.
static void measure_diffuse(const olx_field *field, const ray *points, uint32_t count) {
  static const struct {
    irradiance_call call;
    const char *name;
  } ways[] = {{from_probes, "irradiance probes"}, {from_surfaces, "stored there"}};
  const olx_sample_settings settings = olx_sample_settings_default();
  double taken[2] = {0};
  float sum = 0.0f;
  for (uint32_t first = 0; first < count; first += BATCH) {
    const uint32_t end = count - first < BATCH ? count : first + BATCH;
    for (uint32_t k = 0; k < 2; k++) {
      const uint32_t way = (k + first / BATCH) % 2;
      const double start = seconds();
      for (uint32_t i = first; i < end; i++) sum += ways[way].call(field, &settings, &points[i]).y;
      taken[way] += seconds() - start;
    }
  }
  for (uint32_t way = 0; way < 2; way++) {
    printf("| diffuse light on surfaces, %s | %.0f | | | %s | |\n", ways[way].name, 1e9 * taken[way] / (double)count,
           isfinite(sum) ? "" : "not finite");
  }
}

int study_runtime_speed(int argc, char **argv) {
  const long count = argc > 2 ? strtol(argv[2], NULL, 10) : 100000;
  if (count < 1 || count > INT32_MAX) return usage_error(NAME, "'%s' is not a number of rays", argv[2]);
  olx_field *field;
  if (olx_field_open(argv[1], &field) != OLX_OK || olx_probe_light_check(field) != OLX_OK) {
    return library_failure(NAME);
  }
  const olx_field_info info = olx_field_describe(field);
  printf("%u probes of %u^2, irradiance %u^2, %ld calls each\n\n", info.probes.count, info.maps.size,
         info.irradiance.size, count);
  printf("| call | ns | texel steps | probes | unresolved | unlike the first |\n|---|---|---|---|---|---|\n");
  ray *rays = malloc((size_t)count * sizeof *rays);
  if (!rays) return 1;
  measure_rays(field, "from surfaces", rays, surface_rays(field, &info, rays, (uint32_t)count));
  measure_rays(field, "mirrored", rays, mirrored_rays(field, &info, rays, (uint32_t)count));
  measure_rays(field, "in space", rays, space_rays(&info, rays, (uint32_t)count));
  measure_diffuse(field, rays, surface_points(field, &info, rays, (uint32_t)count));
  free(rays);
  measure_irradiance(field, &info, OLX_VISIBILITY_NONE, "no visibility", (uint32_t)count);
  measure_irradiance(field, &info, OLX_VISIBILITY_CHEBYSHEV, "Chebyshev", (uint32_t)count);
  olx_field_close(field);
  return 0;
}
