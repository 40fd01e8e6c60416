// The output of a command, one JSON object or lines of text, and its progress while it works.
#ifndef OCTALUX_CLI_REPORT_H
#define OCTALUX_CLI_REPORT_H

#include <octalux/base.h>

#include <cjson/cJSON.h>

// Prints the object on one line and releases it. Returns EXIT_DONE, or EXIT_FAILED when memory ran out while it was
// built.
int print_json(const char *command, cJSON *object);

void add_number(cJSON *object, const char *key, double value); // null when it is not finite
void add_float(cJSON *object, const char *key, float value);   // with only the digits of a float
void add_text(cJSON *object, const char *key, const char *value);
void add_vec3(cJSON *object, const char *key, olx_vec3 value);
// Adds a position relative to `origin`, converted to scene coordinates.
void add_position(cJSON *object, const char *key, const double origin[3], olx_vec3 value);
void add_counts(cJSON *object, const char *key, const uint32_t counts[3]);
void add_hash(cJSON *object, const char *key, uint64_t hash);

// A formatted size, such as "12.3 MiB".
typedef struct size_text {
  char text[32];
} size_text;
size_text text_of_bytes(uint64_t bytes);

// A line on standard error with stage, percentage and remaining time, for work that a signal cancels (stop.h).
typedef struct progress_line {
  const char *command;
  bool shown, terminal, drawn;
  double start;
  int last_percent;
} progress_line;

// Shows the line when standard error is a terminal, or always with `force`. The caller calls this when the work begins.
void progress_begin(progress_line *line, const char *command, bool force);
olx_progress progress_of(progress_line *line);
// Removes the line. The caller calls this when the work has ended.
void progress_end(progress_line *line);

#endif
