// Prints the results of the benchmark, as text beside the paper's times or as one JSON object.
#include "bench_report.h"

#include <math.h>
#include <stdio.h>

static const char PAPER[] = "McGuire et al. 2017, Table 1: GeForce GTX 1080, 1920x1080";

static double over(double a, double b) { return b > 0.0 ? a / b : 0.0; }

// Returns the milliseconds in which a pass could stream its images at the bandwidth.
static double stream_floor(const bench_report *r, bench_part part) {
  const double bytes = (double)r->settings->width * r->settings->height * bench_part_bytes(part);
  return over(1e-6 * bytes, r->settings->gigabytes);
}

static double mebibytes(uint64_t bytes) { return (double)bytes / 1048576.0; }

static bool unlike_paper(const bench_row *row, const bench_result *result) {
  return row->probes && (row->probes != result->probes || row->radiance_size != result->radiance_size);
}

// ---- Text

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
  printf("  diffuse light: %.2f texels a pixel, and %.2f filtered reads, %.0f at most; a pass with nothing but the 12 "
         "texels "
         "of one probe takes %.4f ms: %.2f times that\n",
         c->texels, c->filtered, c->most_filtered, ms[BENCH_FLOOR_DIFFUSE],
         over(ms[BENCH_IRRADIANCE], ms[BENCH_FLOOR_DIFFUSE]));
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

// A JSON line under construction, with commas between members and elements.
typedef struct json_line {
  bool more; // the open object or array is not empty
} json_line;

// Writes a key; NULL for an element of an array, or for the root.
static void json_key(json_line *j, const char *key) {
  if (j->more) putchar(',');
  if (key) printf("\"%s\":", key);
  j->more = true;
}

static void json_open(json_line *j, const char *key, char bracket) {
  json_key(j, key);
  putchar(bracket);
  j->more = false;
}

static void json_close(json_line *j, char bracket) {
  putchar(bracket);
  j->more = true;
}

static void json_text(json_line *j, const char *key, const char *text) {
  json_key(j, key);
  putchar('"');
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (*c == '"' || *c == '\\') printf("\\%c", *c);
    else if (*c < 0x20) printf("\\u%04x", *c);
    else putchar(*c);
  }
  putchar('"');
}

static void json_number(json_line *j, const char *key, double value) {
  json_key(j, key);
  if (isfinite(value)) printf("%.6g", value);
  else printf("null");
}

static void json_whole(json_line *j, const char *key, uint64_t value) {
  json_key(j, key);
  printf("%llu", (unsigned long long)value);
}

static void json_bool(json_line *j, const char *key, bool value) {
  json_key(j, key);
  printf("%s", value ? "true" : "false");
}

static void json_counts(json_line *j, const bench_counts *c) {
  json_open(j, "counts", '{');
  json_number(j, "surface_texels", c->texels);
  json_number(j, "filtered_reads", c->filtered);
  json_number(j, "most_filtered_reads", c->most_filtered);
  json_number(j, "fetches", c->fetched);
  json_number(j, "steps", c->steps);
  json_number(j, "probes", c->probes);
  json_number(j, "surface_share", c->surfaces);
  json_number(j, "ray_share", c->rays);
  json_number(j, "unresolved", c->unresolved);
  json_close(j, '}');
}

static void json_passes(json_line *j, const bench_report *r, const bench_result *result) {
  json_open(j, "passes", '{');
  for (bench_part part = 0; part < BENCH_PARTS; part++) {
    json_open(j, bench_part_name(part), '{');
    json_number(j, "ms", result->milliseconds[part]);
    json_number(j, "least_ms", result->least[part]);
    json_whole(j, "bytes_a_pixel", bench_part_bytes(part));
    json_number(j, "stream_floor_ms", stream_floor(r, part));
    json_close(j, '}');
  }
  json_close(j, '}');
}

static void json_pair(json_line *j, const bench_result *result) {
  static const char *const names[BENCH_PAIR] = {"two-level+cage", "hiz+bricks"};
  json_open(j, "compare", '{');
  for (uint32_t k = 0; k < BENCH_PAIR; k++) {
    json_open(j, names[k], '{');
    json_number(j, "ms", result->pair_milliseconds[k]);
    json_counts(j, &result->pair_counts[k]);
    json_close(j, '}');
  }
  json_number(j, "ratio", over(result->pair_milliseconds[BENCH_OLD], result->pair_milliseconds[BENCH_NEW]));
  json_close(j, '}');
}

static void json_paper(json_line *j, const bench_row *row) {
  json_open(j, "paper", '{');
  json_number(j, "irradiance_ms", row->paper_diffuse);
  json_number(j, "glossy_ms", row->paper_glossy);
  json_close(j, '}');
}

static void json_done(json_line *j, const bench_report *r, const bench_row *row, const bench_result *result) {
  json_whole(j, "probes", result->probes);
  json_whole(j, "radiance_size", result->radiance_size);
  json_whole(j, "field_bytes", result->field_bytes);
  json_whole(j, "scene_bytes", result->scene_bytes);
  json_whole(j, "triangles", result->triangles);
  json_whole(j, "lamps", result->lamps);
  json_whole(j, "shadow_maps", result->shadow_maps);
  json_bool(j, "other_scene", result->other_scene);
  json_bool(j, "as_published", row->probes && !unlike_paper(row, result));
  if (row->probes) json_paper(j, row);
  if (r->settings->compare) {
    json_pair(j, result);
  } else {
    json_passes(j, r, result);
    json_counts(j, &result->counts);
  }
}

static void json_row(json_line *j, const bench_report *r, const bench_row *row, const bench_result *result) {
  static const char *const states[] = {"skipped", "done", "failed"};
  json_open(j, NULL, '{');
  json_text(j, "name", row->name);
  json_text(j, "title", row->title);
  json_text(j, "state", states[result->state]);
  if (result->state == BENCH_DONE) json_done(j, r, row, result);
  else json_text(j, "problem", result->problem);
  json_close(j, '}');
}

void bench_report_json(const bench_report *r) {
  const gpu_device *d = r->device;
  json_line j = {.more = false};
  json_open(&j, NULL, '{');
  json_text(&j, "device", d->properties.deviceName);
  json_text(&j, "driver", d->driver.driverName);
  json_text(&j, "driver_info", d->driver.driverInfo);
  json_whole(&j, "width", r->settings->width);
  json_whole(&j, "height", r->settings->height);
  json_whole(&j, "frames", r->settings->frames);
  json_whole(&j, "ray_spacing", r->settings->ray_spacing);
  json_number(&j, "copy_gigabytes_a_second", r->copy_gigabytes);
  json_number(&j, "floor_gigabytes_a_second", r->settings->gigabytes);
  json_text(&j, "paper", PAPER);
  json_open(&j, "rows", '[');
  for (uint32_t i = 0; i < r->count; i++) json_row(&j, r, r->rows[i], &r->results[i]);
  json_close(&j, ']');
  json_close(&j, '}');
  putchar('\n');
}
