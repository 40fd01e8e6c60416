// The tables of a command's options, from which parsing, checking, --help, manual pages and completion are derived.
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
  OPTION_REAL,         // float above 0, and in least..most where most is not 0
  OPTION_DOUBLE,       // double above 0
  OPTION_SIZE,         // uint32_t[2], "1280x720", each in min..max
  OPTION_GRID,         // uint32_t[3], "4x4x4", each in min..max
  OPTION_CHOICE,       // uint32_t: which of the words in `form`, "field|path"
  OPTION_CHOICES       // uint32_t: a bit for each of the words in `form`; given as "field,path"
} option_kind;

// Rows may leave out their last values, which are 0 then.
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

typedef struct option {
  const char *name; // "--spp", or "-o"
  option_kind kind;
  size_t at;        // offset of its value, of the kind's type, in the settings; unchanged unless the option is given
  const char *form; // how its value is shown in the help
  const char *help;
  uint32_t min, max;
  float least, most;
} option;

// A part of a command's options, and the settings that it changes. A command begins, without a title, with its most
// common options.
typedef struct option_table {
  const option *options; // ended by a row of zeros
  void *settings;        // the struct that the rows' offsets are for
  const char *title;     // over the rows in the help; NULL: they continue the table before
} option_table;

// The title of options that are only shown by --help all.
#define RESEARCH "Research"

enum { MAX_ARGUMENTS = 2, MOST_TABLES = 11, MOST_OPTIONS = 96, MOST_FORM = 512 }; // MOST_FORM: of a value in words

typedef struct command_line {
  const char *name, *summary, *example; // example: a typical command line; may be NULL
  const char *arguments[MAX_ARGUMENTS]; // names of positional arguments; NULL: none. Brackets mark optional ones
  const char *given[MAX_ARGUMENTS];     // filled by parsing; NULL when omitted
  option_table tables[MOST_TABLES + 1]; // ended by a table of zeros; MOST_OPTIONS rows at most in all
  const option *named[MOST_OPTIONS];    // filled by parsing: the options that were given, each once
  size_t named_count;
} command_line;

// Returns whether a command fails without the option.
static inline bool must_be_given(const option *o) { return o->kind == OPTION_TEXT && o->min == 1; }

// A place in the tables of a command: for (option_place at = {line->tables, NULL}; next_option(&at);) ...
typedef struct option_place {
  const option_table *table;
  const option *row; // NULL before the first
} option_place;

static inline bool next_option(option_place *at) {
  at->row = at->row ? at->row + 1 : at->table->options;
  while (at->row && !at->row->name) at->row = (++at->table)->options;
  return at->row != NULL;
}

// Returns the title that begins at the row, or NULL.
static inline const char *title_at(const option_place *at) {
  return at->row == at->table->options ? at->table->title : NULL;
}

// Returns the prefix of a command's name in messages: "octalux ", or nothing for a separate program, such as
// octalux-view, whose name begins with "octalux" itself.
static inline const char *program_prefix(const char *command) {
  return strncmp(command, "octalux", 7) == 0 ? "" : "octalux ";
}

#endif
