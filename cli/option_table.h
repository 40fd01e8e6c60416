// The table of a command's options, from which parsing, checking, --help, manual pages and completion are derived.
#ifndef OCTALUX_CLI_OPTION_TABLE_H
#define OCTALUX_CLI_OPTION_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef enum option_kind {
  OPTION_FLAG,         // bool: set when named
  OPTION_FLAG_OFF,     // bool: cleared when named
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
  OPTION_GROUP         // not an option, but the title of those that follow in the table (GROUP_ROW)
} option_kind;

typedef struct option {
  const char *name; // "--spp", or "-o"
  option_kind kind;
  void *value;      // of the kind's type; unchanged unless the option is given
  const char *form; // how its value is shown in the help
  const char *help;
  uint32_t min, max;
} option;

// A title over the rows that follow it. Options for research are only shown by --help all. Tables begin, without a
// title, with the most common options.
#define GROUP_ROW(title)                                                                                               \
  { NULL, OPTION_GROUP, NULL, NULL, (title), 0, 0 }
#define RESEARCH_ROW                                                                                                   \
  { NULL, OPTION_GROUP, NULL, NULL, "Research", 1, 0 }

enum { MAX_ARGUMENTS = 2, MOST_OPTIONS = 96 };

typedef struct command_line {
  const char *name, *summary, *example; // example: a typical command line; may be NULL
  const char *arguments[MAX_ARGUMENTS]; // names of positional arguments; NULL: none. Brackets mark optional ones
  const char *given[MAX_ARGUMENTS];     // filled by parsing; NULL when omitted
  const option *options;
  size_t option_count;          // at most MOST_OPTIONS
  bool was_given[MOST_OPTIONS]; // filled by parsing: whether each option was given
} command_line;

// The prefix of a command's name in messages: "octalux ", or nothing for a separate program, such as octalux-view,
// whose name begins with "octalux" itself.
static inline const char *program_prefix(const char *command) {
  return strncmp(command, "octalux", 7) == 0 ? "" : "octalux ";
}

#endif
