// Prints what the runtime answers for queries of a field, as lines of numbers: answers FIELD OUTPUT. It links nothing
// but the runtime, so that full_ports.sh can run it on other machines and C libraries, and compare.
#include <octalux/octalux.h>
#include <octalux/relight.h>

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RAYS = 2048, FRAMES = 3, LINE_BYTES = 200 };

// The output, which grows line by line.
typedef struct text {
  char bytes[(4 * RAYS + 8) * LINE_BYTES];
  size_t length;
} text;

static void say(text *t, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int written = vsnprintf(t->bytes + t->length, LINE_BYTES, format, arguments);
  va_end(arguments);
  if (written > 0) t->length += written < LINE_BYTES ? (size_t)written : LINE_BYTES - 1;
}

static void say_light(text *t, const char *what, olx_vec3 light) {
  say(t, "%s %.6g %.6g %.6g\n", what, (double)light.x, (double)light.y, (double)light.z);
}

static bool failed(const char *what) {
  fprintf(stderr, "answers: %s: %s\n", what, olx_last_error());
  return false;
}

// Returns directions that spiral from pole to pole.
static olx_vec3 direction_of(uint32_t i) {
  const float z = 1.0f - (2.0f * (float)i + 1.0f) / RAYS, r = sqrtf(1.0f - z * z), angle = 2.3999632f * (float)i;
  return (olx_vec3){r * cosf(angle), z, r * sinf(angle)};
}

static void say_rays(text *t, const olx_field *field, const olx_trace_hit *hits, const olx_vec3 *directions) {
  const olx_sample_settings settings = olx_sample_settings_default();
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_trace_hit *h = &hits[i];
    const olx_vec3 view = {-directions[i].x, -directions[i].y, -directions[i].z};
    say(t, "ray %d %.6g\n", (int)h->status, isfinite(h->distance_metres) ? (double)h->distance_metres : -1.0);
    say_light(t, "radiance", h->radiance);
    if (h->status != OLX_TRACE_HIT) continue;
    float weight, half_cosine;
    say_light(t, "surface", olx_surface_irradiance(field, &settings, h->position, h->normal, h->normal, view));
    const olx_vec3 glossy = olx_glossy(field, &settings, h->position, h->normal, view, 0.3f, (olx_vec2){0.3f, 0.6f},
                                       &weight, &half_cosine, NULL);
    say_light(t, "glossy", glossy);
  }
}

static bool say_sampling(text *t, const olx_field *field) {
  static olx_vec3 origins[RAYS], directions[RAYS];
  static olx_trace_hit hits[RAYS];
  const olx_sample_settings settings = olx_sample_settings_default();
  const uint32_t probes = olx_field_describe(field).probes.count;
  for (uint32_t i = 0; i < RAYS; i++) {
    origins[i] = olx_field_probe_position(field, i % probes);
    directions[i] = direction_of(i);
  }
  olx_trace_rays(field, &settings, RAYS, origins, directions, INFINITY, hits);
  say_rays(t, field, hits, directions);
  return true;
}

// Relights the field with a lamp in the middle of the probes in place of all lights, and prints the result.
static bool say_relighting(text *t, const olx_field *field) {
  const olx_relight_settings settings = olx_relight_settings_default();
  const olx_vec3 eye = olx_field_probe_position(field, 0);
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .emission = {5, 4, 3}, .position = eye};
  olx_relight *relight;
  if (olx_relight_create(field, &settings, &relight) != OLX_OK) return failed("a relighter");
  bool fine = olx_relight_set_lights(relight, &lamp, 1) == OLX_OK;
  olx_relight_stats stats = {0};
  for (uint32_t i = 0; i < FRAMES && fine; i++) fine = olx_relight_frame(relight, eye, &stats) == OLX_OK;
  const olx_vec3 up = {0, 1, 0};
  say(t, "relit %u %u %u\n", stats.surfels_lit, stats.surfels_gathered, stats.volume_probes);
  say_light(t, "volume", olx_volume_irradiance(olx_relight_field(relight), eye, up));
  olx_relight_free(relight);
  return fine || failed("a frame of relighting");
}

static bool say_all(text *t, const olx_field *field) {
  if (olx_field_verify(field) != OLX_OK) return failed("verifying");
  return say_sampling(t, field) && say_relighting(t, field);
}

// Writes the text by the library's file functions where it has them, else by those of C.
static bool write_text(const char *path, const text *t) {
  const olx_result result = olx_write_file(path, t->bytes, t->length);
  if (result == OLX_OK) return true;
  if (result != OLX_ERROR_UNSUPPORTED) return failed("writing");
  printf("%s\n", olx_last_error());
  FILE *file = fopen(path, "wb");
  const bool written = file && fwrite(t->bytes, 1, t->length, file) == t->length;
  return file && fclose(file) == 0 && written;
}

int main(int argc, char **argv) {
  static text t;
  olx_field *field;
  if (argc != 3) return fprintf(stderr, "usage: answers FIELD OUTPUT\n"), 2;
  if (olx_field_open(argv[1], &field) != OLX_OK) return failed("opening"), 1;
  const bool fine = say_all(&t, field) && write_text(argv[2], &t);
  olx_field_close(field);
  return fine ? 0 : 1;
}
