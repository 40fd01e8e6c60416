// The documentation of a command, generated from its tables of options: help for a terminal, a manual page, and words
// for shell completion.
#ifndef OCTALUX_CLI_HELP_H
#define OCTALUX_CLI_HELP_H

#include "option_table.h"

typedef enum help_form {
  HELP_SHORT,  // the most common options
  HELP_ALL,    // options for research as well
  HELP_MANUAL, // a manual page in troff
  HELP_WORDS   // the names of options, one per line
} help_form;

// Finds the form that the word after --help names: "all", "man" or "words". Returns false for any other word.
bool help_form_of(const char *word, help_form *form);
// Prints the help in a form to standard output.
void print_help(const command_line *line, help_form form);

// Returns the known word most similar to `word`, or NULL when none is similar: at most a third of its letters differ,
// where swapped neighbours count as one.
const char *nearest_word(const char *word, size_t length, const char *const *known, size_t count);

#endif
