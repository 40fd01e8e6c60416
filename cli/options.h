// The arguments of a command: one table says what it takes, and parsing, checking and --help follow from it.
#ifndef OCTALUX_CLI_OPTIONS_H
#define OCTALUX_CLI_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
  EXIT_DONE = 0,
  EXIT_FAILED = 1,
  EXIT_USAGE = 2,
  EXIT_AGAIN = 75 // what others are to make is not there yet
};

typedef enum option_kind {
  OPTION_FLAG,         // bool: set when named
  OPTION_FLAG_WORD,    // uint32_t: 1 when named alone, 2 when named as "--name=WORD", WORD being `form`
  OPTION_TEXT,         // const char *; must be given when min is 1
  OPTION_COUNT,        // uint32_t in min..max
  OPTION_POWER_OF_TWO, // uint32_t in min..max
  OPTION_BOUNCES,      // uint32_t in min..max, or UINT32_MAX for "inf"
  OPTION_REAL,         // float above 0
  OPTION_SIZE,         // uint32_t[2], "1280x720", each in min..max
  OPTION_GRID,         // uint32_t[3], "4x4x4", each in min..max
  OPTION_CHOICE,       // uint32_t: which of the words in `form`, "field|path"
  OPTION_CHOICES,      // uint32_t: a bit for each of the words in `form`; given as "field,path"
  OPTION_GROUP         // no option, but the title of those that follow it in the table (GROUP_ROW)
} option_kind;

typedef struct option {
  const char *name; // "--spp", or "-o"
  option_kind kind;
  void *value;      // of the kind's type; left alone unless the option is given
  const char *form; // how its value looks in the help
  const char *help;
  uint32_t min, max;
} option;

// A title over the rows that follow it. Those of research are shown by --help all alone. Tables begin, without a title, with
// what most people need.
#define GROUP_ROW(title)                                                                                               \
  { NULL, OPTION_GROUP, NULL, NULL, (title), 0, 0 }
#define RESEARCH_ROW                                                                                                   \
  { NULL, OPTION_GROUP, NULL, NULL, "Research", 1, 0 }

#define MAX_ARGUMENTS 2

typedef struct command_line {
  const char *name, *summary, *example; // example: a command as it is typed; may be NULL
  const char *arguments[MAX_ARGUMENTS]; // names of arguments without a dash; NULL: none. In brackets: may be left out
  const char *given[MAX_ARGUMENTS];     // filled by parsing; NULL when left out
  const option *options;
  size_t option_count;
} command_line;

// Read argv[1..]. True when the command should go on; else *exit_code is what to leave with (help was printed, or one line
// said what is wrong). Every command also takes --help, with "all", "man" or "words" behind it, and --quiet.
bool parse_options(command_line *line, int argc, char **argv, int *exit_code);

// What stands before a command's name in messages: "octalux ", or nothing when the name is that of a program of its own,
// such as octalux-view, and what follows it.
const char *program_prefix(const char *command);

// Whether --quiet was given: warnings are dropped then, and nobody is told of progress.
bool is_quiet(void);

// Prints "warning: message", unless warnings are dropped.
void warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
// Print "octalux NAME: message" and return EXIT_USAGE or EXIT_FAILED.
int usage_error(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
int failure(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Prints "octalux NAME: " with the library's last message and returns EXIT_FAILED.
int library_failure(const char *command);

bool ends_with(const char *text, const char *ending);

// Whether an output could be written at `path`, for a look before long work; when not, a line says why. in_order: the
// format is written from its begin to its end. Commands that read files, too, check both by files.h.
bool check_output(const char *command, const char *path, bool in_order);

#endif
