// Parses the arguments of a command by its tables of options, and reports errors by the same tables.
#include "options.h"

#include "help.h"

#include <octalux/base.h>

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const option json_option[] = {{"--json", OPTION_FLAG, 0, NULL, "print one JSON object"}, {0}};
const option progress_option[] = {{"--progress", OPTION_FLAG, 0, NULL, "tell progress even when nobody watches"}, {0}};
const option threads_option[] = {
    {"--threads", OPTION_COUNT, 0, "N", "default 0: every processor; the result is the same", 0, 4096}, {0}};

static bool quiet;

bool is_quiet(void) { return quiet; }

static void log_errors(void *user, olx_log_level level, const char *message) {
  (void)user;
  if (level >= OLX_LOG_ERROR) fprintf(stderr, "error: %s\n", message);
}

static void be_quiet(void) {
  quiet = true;
  olx_set_hooks(&(olx_hooks){.log = log_errors});
}

static void complain(const char *command, const char *format, va_list arguments) {
  char message[1536], printable[sizeof message];
  vsnprintf(message, sizeof message, format, arguments);
  olx_printable(message, printable, sizeof printable);
  fprintf(stderr, "%s%s: %s\n", command ? program_prefix(command) : "octalux", command ? command : "", printable);
}

void warn(const char *format, ...) {
  char message[1536], printable[sizeof message];
  if (quiet) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  olx_printable(message, printable, sizeof printable);
  fprintf(stderr, "warning: %s\n", printable);
}

int usage_error(const char *command, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  complain(command, format, arguments);
  va_end(arguments);
  return EXIT_USAGE;
}

int failure(const char *command, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  complain(command, format, arguments);
  va_end(arguments);
  return EXIT_FAILED;
}

int library_failure(const char *command) { return failure(command, "%s", olx_last_error()); }

bool ends_with(const char *text, const char *ending) {
  const size_t length = strlen(text), ending_length = strlen(ending);
  return length > ending_length && strcmp(text + length - ending_length, ending) == 0;
}

bool check_output(const char *command, const char *path, bool in_order) {
  return olx_output_check(path, in_order) == OLX_OK || library_failure(command) == EXIT_DONE;
}

// Parses digits up to the end of the text or `stop`; *next is where they ended.
static bool parse_digits(const char *text, char stop, uint32_t min, uint32_t max, uint32_t *value, const char **next) {
  uint64_t number = 0;
  const char *end = text;
  while (*end >= '0' && *end <= '9') {
    number = number * 10 + (uint64_t)(*end++ - '0');
    if (number > UINT32_MAX) return false;
  }
  if (end == text || *end != stop || number < min || number > max) return false;
  *value = (uint32_t)number;
  *next = end + (stop ? 1 : 0);
  return true;
}

static bool parse_counts(const char *text, const option *o, uint32_t count, uint32_t *values) {
  uint32_t numbers[3] = {0};
  for (uint32_t i = 0; i < count; ++i) {
    if (!parse_digits(text, i + 1 < count ? 'x' : 0, o->min, o->max, &numbers[i], &text)) return false;
  }
  memcpy(values, numbers, count * sizeof *values);
  return true;
}

static bool parse_choice(const char *text, size_t length, const char *words, uint32_t *value) {
  for (uint32_t index = 0;; ++index) {
    const size_t word_length = strcspn(words, "|");
    if (word_length == length && strncmp(words, text, length) == 0) {
      *value = index;
      return true;
    }
    if (!words[word_length]) return false;
    words += word_length + 1;
  }
}

static bool parse_choices(const char *text, const char *words, uint32_t *value) {
  uint32_t bits = 0, choice;
  for (;;) {
    const size_t length = strcspn(text, ",");
    if (!parse_choice(text, length, words, &choice)) return false;
    bits |= 1u << choice;
    if (!text[length]) break;
    text += length + 1;
  }
  *value = bits;
  return true;
}

static bool parse_real(const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && !*end && *value > 0.0 && isfinite((float)*value);
}

static bool parse_value(const option *o, const char *text, void *value) {
  uint32_t number;
  double real;
  switch (o->kind) {
  case OPTION_FLAG:
  case OPTION_FLAG_OFF:
  case OPTION_FLAG_WORD: return false;
  case OPTION_TEXT: *(const char **)value = text; return *text != 0;
  case OPTION_COUNT: return parse_counts(text, o, 1, value);
  case OPTION_POWER_OF_TWO:
    if (!parse_counts(text, o, 1, &number) || (number & (number - 1)) != 0) return false;
    *(uint32_t *)value = number;
    return true;
  case OPTION_BOUNCES:
    if (strcmp(text, "inf") != 0) return parse_counts(text, o, 1, value);
    *(uint32_t *)value = UINT32_MAX;
    return true;
  case OPTION_REAL:
    if (!parse_real(text, &real)) return false;
    if (o->most > 0.0f && !((float)real >= o->least && (float)real <= o->most)) return false;
    *(float *)value = (float)real;
    return true;
  case OPTION_DOUBLE: return parse_real(text, value);
  case OPTION_SIZE: return parse_counts(text, o, 2, value);
  case OPTION_GRID: return parse_counts(text, o, 3, value);
  case OPTION_CHOICE: return parse_choice(text, strlen(text), o->form, value);
  case OPTION_CHOICES: return parse_choices(text, o->form, value);
  }
  return false;
}

static void describe_value(const option *o, char *text, size_t size) {
  switch (o->kind) {
  case OPTION_COUNT: snprintf(text, size, "a whole number from %u to %u", o->min, o->max); break;
  case OPTION_POWER_OF_TWO: snprintf(text, size, "a power of two from %u to %u", o->min, o->max); break;
  case OPTION_BOUNCES: snprintf(text, size, "a whole number from %u to %u, or inf", o->min, o->max); break;
  case OPTION_REAL:
    if (o->least > 0.0f) snprintf(text, size, "a number from %g to %g", (double)o->least, (double)o->most);
    else if (o->most > 0.0f) snprintf(text, size, "a number above 0 and at most %g", (double)o->most);
    else snprintf(text, size, "a number above 0");
    break;
  case OPTION_DOUBLE: snprintf(text, size, "a number above 0"); break;
  case OPTION_SIZE: snprintf(text, size, "a size like 1280x720, each from %u to %u", o->min, o->max); break;
  case OPTION_GRID: snprintf(text, size, "a grid like 4x4x4, each from %u to %u", o->min, o->max); break;
  case OPTION_CHOICE: snprintf(text, size, "one of %s", o->form); break;
  case OPTION_CHOICES: snprintf(text, size, "one or several of %s, separated by commas", o->form); break;
  case OPTION_FLAG:
  case OPTION_FLAG_OFF:
  case OPTION_FLAG_WORD:
  case OPTION_TEXT: snprintf(text, size, "a name"); break;
  }
}

// Takes a positional argument.
static bool take_argument(command_line *line, const char *text) {
  for (int i = 0; i < MAX_ARGUMENTS; ++i) {
    if (!line->arguments[i] || line->given[i]) continue;
    line->given[i] = text;
    return true;
  }
  usage_error(line->name, "'%s' is one argument too many (see %s%s --help)", text, program_prefix(line->name),
              line->name);
  return false;
}

// Reports an unknown option, with a suggestion where it is similar to a known one.
static void refuse_option(const command_line *line, const char *text, size_t length) {
  const char *names[MOST_OPTIONS];
  size_t count = 0;
  for (option_place at = {line->tables, NULL}; next_option(&at) && count < MOST_OPTIONS;) names[count++] = at.row->name;
  const char *meant = nearest_word(text, length, names, count);
  usage_error(line->name, "unknown option '%.*s'%s%s%s (see %s%s --help)", (int)length, text,
              meant ? "; did you mean " : "", meant ? meant : "", meant ? "?" : "", program_prefix(line->name),
              line->name);
}

static void note_given(command_line *line, const option *o) {
  if (was_given(line, o->name)) return;
  assert(line->named_count < MOST_OPTIONS);
  line->named[line->named_count++] = o;
}

static bool take_value(command_line *line, const option *o, const char *text, void *value) {
  char wanted[MOST_FORM];
  if (!text) return usage_error(line->name, "%s needs a value: %s", o->name, o->form) == EXIT_DONE;
  if (parse_value(o, text, value)) return true;
  describe_value(o, wanted, sizeof wanted);
  return usage_error(line->name, "%s: '%s' is not %s", o->name, text, wanted) == EXIT_DONE;
}

static void *value_at(const option_place *at) { return (char *)at->table->settings + at->row->at; }

// Takes "--name value", "--name=value" or a flag; *index moves past what was used.
static bool take_option(command_line *line, int argc, char **argv, int *index) {
  const char *text = argv[*index];
  const char *equals = strncmp(text, "--", 2) == 0 ? strchr(text, '=') : NULL;
  const size_t length = equals ? (size_t)(equals - text) : strlen(text);
  for (option_place at = {line->tables, NULL}; next_option(&at);) {
    const option *o = at.row;
    if (strlen(o->name) != length || strncmp(o->name, text, length) != 0) continue;
    note_given(line, o);
    if (o->kind == OPTION_FLAG || o->kind == OPTION_FLAG_OFF) {
      if (equals) return usage_error(line->name, "%s takes no value", o->name) == EXIT_DONE;
      *(bool *)value_at(&at) = o->kind == OPTION_FLAG;
      return true;
    }
    if (o->kind == OPTION_FLAG_WORD) {
      *(uint32_t *)value_at(&at) = equals ? 2 : 1;
      if (!equals || strcmp(equals + 1, o->form) == 0) return true;
      return usage_error(line->name, "%s: '%s' is not %s", o->name, equals + 1, o->form) == EXIT_DONE;
    }
    const char *value = equals ? equals + 1 : *index + 1 < argc ? argv[++*index] : NULL;
    return take_value(line, o, value, value_at(&at));
  }
  refuse_option(line, text, length);
  return false;
}

// Handles "--help", with an optional word such as "all".
static void answer_help(const command_line *line, const char *word) {
  help_form form = HELP_SHORT;
  if (word) help_form_of(word, &form);
  print_help(line, form);
}

bool was_given(const command_line *line, const char *name) {
  for (size_t i = 0; i < line->named_count; ++i) {
    if (strcmp(line->named[i]->name, name) == 0) return true;
  }
  return false;
}

bool parse_options(command_line *line, int argc, char **argv, int *exit_code) {
  bool only_arguments = false;
  *exit_code = EXIT_USAGE;
  for (int i = 1; i < argc; ++i) {
    if (only_arguments || argv[i][0] != '-' || !argv[i][1]) {
      if (!take_argument(line, argv[i])) return false;
    } else if (strcmp(argv[i], "--") == 0) {
      only_arguments = true;
    } else if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
      answer_help(line, i + 1 < argc ? argv[i + 1] : NULL);
      *exit_code = EXIT_DONE;
      return false;
    } else if (strcmp(argv[i], "--quiet") == 0) {
      be_quiet();
    } else if (!take_option(line, argc, argv, &i)) {
      return false;
    }
  }
  for (int i = 0; i < MAX_ARGUMENTS; ++i) {
    if (!line->arguments[i] || line->arguments[i][0] == '[' || line->given[i]) continue;
    usage_error(line->name, "%s is missing (see %s%s --help)", line->arguments[i], program_prefix(line->name),
                line->name);
    return false;
  }
  for (option_place at = {line->tables, NULL}; next_option(&at);) {
    const option *o = at.row;
    if (!must_be_given(o) || *(const char **)value_at(&at)) continue;
    usage_error(line->name, "%s %s is missing (see %s%s --help)", o->name, o->form, program_prefix(line->name),
                line->name);
    return false;
  }
  *exit_code = EXIT_DONE;
  return true;
}
