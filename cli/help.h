// What a command says of itself: its help for a terminal, its manual page, and the words that a shell completes, all
// from its table of options.
#ifndef OCTALUX_CLI_HELP_H
#define OCTALUX_CLI_HELP_H

#include "option_table.h"

typedef enum help_form {
  HELP_SHORT,  // what most people need
  HELP_ALL,    // research as well
  HELP_MANUAL, // a manual page, as troff reads it
  HELP_WORDS   // the names of options, a line each
} help_form;

// The form that the word after --help names: "all", "man" or "words". False for any other word.
bool help_form_of(const char *word, help_form *form);
// Prints to standard output.
void print_help(const command_line *line, help_form form);

// The known word that was most likely meant, or NULL when none is near: at most a third of its letters differ, swapped
// neighbours counting as one.
const char *nearest_word(const char *word, size_t length, const char *const *known, size_t count);

#endif
