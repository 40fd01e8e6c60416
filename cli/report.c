// Prints the results of a command, as JSON or as text, and shows progress on standard error while it works.
#include "report.h"

#include "clock.h"
#include "options.h"
#include "stop.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

// Prints JSON, and escapes the control characters that cJSON leaves: DEL, and those that UTF-8 encodes as C2 and 80 to
// 9F.
static void put_json(const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (*c == 0x7F || (*c == 0xC2 && c[1] >= 0x80 && c[1] < 0xA0)) printf("\\u00%02x", *c == 0x7F ? *c : *++c);
    else putchar(*c);
  }
  putchar('\n');
}

int print_json(const char *command, cJSON *object) {
  char *text = cJSON_PrintUnformatted(object);
  cJSON_Delete(object);
  if (!text) return failure(command, "out of memory");
  put_json(text);
  cJSON_free(text);
  return EXIT_DONE;
}

void add_number(cJSON *object, const char *key, double value) {
  if (isfinite(value)) cJSON_AddNumberToObject(object, key, value);
  else cJSON_AddNullToObject(object, key);
}

void add_text(cJSON *object, const char *key, const char *value) { cJSON_AddStringToObject(object, key, value); }

// Returns the shortest decimal number that reads back as this float: 0.1, not 0.100000001490116.
static double shortest(float value) {
  char text[32];
  for (int digits = 6; digits <= 9; ++digits) {
    snprintf(text, sizeof text, "%.*g", digits, (double)value);
    if (strtof(text, NULL) == value) break;
  }
  return strtod(text, NULL);
}

void add_float(cJSON *object, const char *key, float value) { add_number(object, key, shortest(value)); }

void add_vec3(cJSON *object, const char *key, olx_vec3 value) {
  const double numbers[3] = {shortest(value.x), shortest(value.y), shortest(value.z)};
  cJSON_AddItemToObject(object, key, cJSON_CreateDoubleArray(numbers, 3));
}

void add_position(cJSON *object, const char *key, const double origin[3], olx_vec3 value) {
  const double numbers[3] = {origin[0] + shortest(value.x), origin[1] + shortest(value.y),
                             origin[2] + shortest(value.z)};
  cJSON_AddItemToObject(object, key, cJSON_CreateDoubleArray(numbers, 3));
}

void add_counts(cJSON *object, const char *key, const uint32_t counts[3]) {
  cJSON *array = cJSON_AddArrayToObject(object, key);
  for (int i = 0; i < 3; ++i) cJSON_AddItemToArray(array, cJSON_CreateNumber(counts[i]));
}

void add_hash(cJSON *object, const char *key, uint64_t hash) {
  char text[24];
  snprintf(text, sizeof text, "%016" PRIx64, hash);
  add_text(object, key, text);
}

size_text text_of_bytes(uint64_t bytes) {
  static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  size_text result;
  double value = (double)bytes;
  size_t unit = 0;
  for (; value >= 1024.0 && unit < 4; ++unit) value /= 1024.0;
  snprintf(result.text, sizeof result.text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return result;
}

void progress_begin(progress_line *line, const char *command, bool force) {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  *line = (progress_line){.command = command,
                          .shown = (force || terminal) && !is_quiet(),
                          .terminal = terminal,
                          .start = clock_seconds(CLOCK_MONOTONIC),
                          .last_percent = -1};
  stop_work_begin();
}

static bool report(void *user, const char *stage, float done) {
  progress_line *line = user;
  if (stop_requested()) return false;
  const int percent = (int)(100.0f * (done < 0.0f ? 0.0f : done > 1.0f ? 1.0f : done));
  const bool due = line->terminal || percent >= line->last_percent + 5 || percent < line->last_percent;
  if (!line->shown || !due) return true;
  line->last_percent = percent;
  const double elapsed = clock_seconds(CLOCK_MONOTONIC) - line->start;
  char left[32] = "";
  if (done > 0.01f) {
    const long seconds = lround(elapsed * (1.0 - (double)done) / (double)done);
    snprintf(left, sizeof left, ", %ld:%02ld left", seconds / 60, seconds % 60);
  }
  fprintf(stderr, line->terminal ? "\r\033[K%s: %s %d %%%s" : "%s: %s %d %%%s\n", line->command, stage, percent, left);
  fflush(stderr);
  line->drawn = true;
  return true;
}

olx_progress progress_of(progress_line *line) { return (olx_progress){.report = report, .user = line}; }

void progress_end(progress_line *line) {
  if (line->drawn && line->terminal) fputs("\r\033[K", stderr);
  line->drawn = false;
  stop_work_end();
}
