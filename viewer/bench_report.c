#include "bench_report.h"

#include <math.h>
#include <stdio.h>

static const char PAPER[] = "McGuire et al. 2017, Table 1: GeForce GTX 1080, 1920x1080";

static double over(double a, double b) { return b > 0.0 ? a / b : 0.0; }

// Milliseconds that a pass would take if it only streamed its images at the bandwidth.
static double stream_floor(const bench_report *r, bench_part part) {
  const double bytes = (double)r->settings->width * r->settings->height * bench_part_bytes(part);
  return over(1e-6 * bytes, r->settings->gigabytes);
}

static double mebibytes(uint64_t bytes) { return (double)bytes / 1048576.0; }

static bool unlike_paper(const bench_row *row, const bench_result *result) {
  return row->probes && (row->probes != result->probes || row->radiance_size != result->radiance_size);
}

// ---- for people

static void print_pass(const bench_report *r, const bench_result *result, bench_part part, double paper) {
  const double ms = result->milliseconds[part], stream = stream_floor(r, part);
  printf("  %-12s %9.4f ms", bench_part_name(part), ms);
  if (paper >= 0.0) printf("   paper %.3f", paper);
  if (bench_part_bytes(part)) {
    printf("   %u bytes a pixel: %.4f ms at least, %.1f times that", bench_part_bytes(part), stream, over(ms, stream));
  }
  printf("\n");
}

static void print_floors(const bench_result *result) {
  const double *ms = result->milliseconds;
  const bench_counts *c = &result->counts;
  printf("  diffuse light: %.2f filtered reads a pixel, %.0f at most; a pass with nothing but 16 such reads takes %.4f "
         "ms: "
         "%.2f times that\n",
         c->filtered, c->most_filtered, ms[BENCH_FLOOR_DIFFUSE], over(ms[BENCH_IRRADIANCE], ms[BENCH_FLOOR_DIFFUSE]));
  if (!(c->rays > 0.0)) {
    printf("  glossy light: no ray\n");
    return;
  }
  printf("  glossy light: rays from %.1f %% of the pixels, %.1f steps, %.2f probes, %.1f texel fetches a ray, %.2f %% "
         "unresolved; a pass with one texel a ray takes %.4f ms: %.1f times that\n",
         100.0 * c->rays, c->steps, c->probes, c->fetched, 100.0 * c->unresolved, ms[BENCH_FLOOR_GLOSSY],
         over(ms[BENCH_GLOSSY], ms[BENCH_FLOOR_GLOSSY]));
}

static void print_pair(const bench_result *result) {
  const double *ms = result->pair_milliseconds;
  const bench_counts *old = &result->pair_counts[BENCH_OLD], *new = &result->pair_counts[BENCH_NEW];
  printf("  two-level + cage %.4f ms, %.1f steps, %.2f probes, %.2f %% unresolved\n", ms[BENCH_OLD], old->steps,
         old->probes, 100.0 * old->unresolved);
  printf("  hi-Z + bricks    %.4f ms, %.1f steps, %.2f probes, %.2f %% unresolved: %.2f times faster\n", ms[BENCH_NEW],
         new->steps, new->probes, 100.0 * new->unresolved, over(ms[BENCH_OLD], ms[BENCH_NEW]));
}

static void print_row(const bench_report *r, const bench_row *row, const bench_result *result) {
  printf("\n%s: %s\n", row->name, row->title);
  if (result->state != BENCH_DONE) {
    printf("  %s: %s\n", result->state == BENCH_SKIPPED ? "SKIPPED" : "FAILED", result->problem);
    return;
  }
  printf("  %u probes of %u^2, %.1f MiB; %llu triangles, %.1f MiB; %u lamps, %u shadow maps\n", result->probes,
         result->radiance_size, mebibytes(result->field_bytes), (unsigned long long)result->triangles,
         mebibytes(result->scene_bytes), result->lamps, result->shadow_maps);
  if (unlike_paper(row, result)) {
    printf("  WARNING: not the paper's %u probes of %u^2\n", row->probes, row->radiance_size);
  }
  if (result->other_scene) printf("  WARNING: the field was baked from another scene\n");
  if (r->settings->compare) {
    print_pair(result);
    return;
  }
  for (uint32_t p = 0; p < BENCH_PARTS; p++) {
    if (p == BENCH_FLOOR_DIFFUSE || p == BENCH_FLOOR_GLOSSY) continue;
    if (p == BENCH_FRAME_PARTS) printf("  with a Lambertian ray a pixel in place of irradiance probes:\n");
    const double paper = p == BENCH_IRRADIANCE ? row->paper_diffuse : p == BENCH_GLOSSY ? row->paper_glossy : -1.0;
    print_pass(r, result, (bench_part)p, paper);
  }
  print_floors(result);
}

void bench_report_text(const bench_report *r) {
  const gpu_device *d = r->device;
  printf("%s, %s %s\n", d->properties.deviceName, d->driver.driverName, d->driver.driverInfo);
  printf("%ux%u, medians of %u frames in milliseconds; paper: %s\n", r->settings->width, r->settings->height,
         r->settings->frames, PAPER);
  printf("copies between buffers: %.1f GB/s; floors are reckoned with %.1f GB/s%s\n", r->copy_gigabytes,
         r->settings->gigabytes, r->stated ? ", as stated" : "");
  for (uint32_t i = 0; i < r->count; i++) print_row(r, r->rows[i], &r->results[i]);
}

// ---- JSON

static void json_text(const char *key, const char *text) {
  printf("\"%s\":\"", key);
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (*c == '"' || *c == '\\') printf("\\%c", *c);
    else if (*c < 0x20) printf("\\u%04x", *c);
    else putchar(*c);
  }
  putchar('"');
}

static void json_number(const char *key, double value) {
  if (isfinite(value)) printf("\"%s\":%.6g", key, value);
  else printf("\"%s\":null", key);
}

static void json_counts(const char *key, const bench_counts *c) {
  printf("\"%s\":{", key);
  json_number("filtered_reads", c->filtered);
  putchar(',');
  json_number("most_filtered_reads", c->most_filtered);
  putchar(',');
  json_number("fetches", c->fetched);
  putchar(',');
  json_number("steps", c->steps);
  putchar(',');
  json_number("probes", c->probes);
  putchar(',');
  json_number("surface_share", c->surfaces);
  putchar(',');
  json_number("ray_share", c->rays);
  putchar(',');
  json_number("unresolved", c->unresolved);
  putchar('}');
}

static void json_passes(const bench_report *r, const bench_result *result) {
  printf("\"passes\":{");
  for (uint32_t p = 0; p < BENCH_PARTS; p++) {
    printf("%s\"%s\":{", p ? "," : "", bench_part_name((bench_part)p));
    json_number("ms", result->milliseconds[p]);
    putchar(',');
    json_number("least_ms", result->least[p]);
    printf(",\"bytes_a_pixel\":%u,", bench_part_bytes((bench_part)p));
    json_number("stream_floor_ms", stream_floor(r, (bench_part)p));
    putchar('}');
  }
  putchar('}');
}

static void json_pair(const bench_result *result) {
  static const char *const names[BENCH_PAIR] = {"two-level+cage", "hiz+bricks"};
  printf("\"compare\":{");
  for (uint32_t k = 0; k < BENCH_PAIR; k++) {
    printf("\"%s\":{", names[k]);
    json_number("ms", result->pair_milliseconds[k]);
    putchar(',');
    json_counts("counts", &result->pair_counts[k]);
    printf("},");
  }
  json_number("ratio", over(result->pair_milliseconds[BENCH_OLD], result->pair_milliseconds[BENCH_NEW]));
  putchar('}');
}

static void json_row(const bench_report *r, const bench_row *row, const bench_result *result) {
  static const char *const states[] = {"skipped", "done", "failed"};
  putchar('{');
  json_text("name", row->name);
  putchar(',');
  json_text("title", row->title);
  putchar(',');
  json_text("state", states[result->state]);
  if (result->state != BENCH_DONE) {
    putchar(',');
    json_text("problem", result->problem);
    putchar('}');
    return;
  }
  printf(",\"probes\":%u,\"radiance_size\":%u,\"field_bytes\":%llu,\"scene_bytes\":%llu,\"triangles\":%llu,"
         "\"lamps\":%u,\"shadow_maps\":%u,\"other_scene\":%s,\"as_published\":%s,",
         result->probes, result->radiance_size, (unsigned long long)result->field_bytes,
         (unsigned long long)result->scene_bytes, (unsigned long long)result->triangles, result->lamps,
         result->shadow_maps, result->other_scene ? "true" : "false",
         row->probes && !unlike_paper(row, result) ? "true" : "false");
  if (row->probes) {
    printf("\"paper\":{");
    json_number("irradiance_ms", row->paper_diffuse);
    putchar(',');
    json_number("glossy_ms", row->paper_glossy);
    printf("},");
  }
  if (r->settings->compare) {
    json_pair(result);
  } else {
    json_passes(r, result);
    putchar(',');
    json_counts("counts", &result->counts);
  }
  putchar('}');
}

void bench_report_json(const bench_report *r) {
  const gpu_device *d = r->device;
  putchar('{');
  json_text("device", d->properties.deviceName);
  putchar(',');
  json_text("driver", d->driver.driverName);
  putchar(',');
  json_text("driver_info", d->driver.driverInfo);
  printf(",\"width\":%u,\"height\":%u,\"frames\":%u,", r->settings->width, r->settings->height, r->settings->frames);
  json_number("copy_gigabytes_a_second", r->copy_gigabytes);
  putchar(',');
  json_number("floor_gigabytes_a_second", r->settings->gigabytes);
  putchar(',');
  json_text("paper", PAPER);
  printf(",\"rows\":[");
  for (uint32_t i = 0; i < r->count; i++) {
    if (i) putchar(',');
    json_row(r, r->rows[i], &r->results[i]);
  }
  printf("]}\n");
}
