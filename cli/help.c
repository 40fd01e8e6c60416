// Prints a command's help, its manual page, and the words for shell completion from its tables of options, and suggests
// corrections for misspelt words.
#include "help.h"

#include <octalux/base.h>

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { LEFT_COLUMN = 34, LONGEST_WORD = 40 };

bool help_form_of(const char *word, help_form *form) {
  static const char *const words[] = {[HELP_ALL] = "all", [HELP_MANUAL] = "man", [HELP_WORDS] = "words"};
  for (uint32_t i = HELP_ALL; i <= HELP_WORDS; ++i) {
    if (strcmp(word, words[i]) != 0) continue;
    *form = (help_form)i;
    return true;
  }
  return false;
}

// Formats an option and its value as typed, "--spp N".
static void write_left(const option *o, char *text, size_t size) {
  const bool word = o->kind == OPTION_FLAG_WORD;
  snprintf(text, size, "%s%s%s%s", o->name, word ? "[=" : o->form ? " " : "", o->form ? o->form : "", word ? "]" : "");
}

static void print_left_and_right(const char *left, const char *right) {
  if (strlen(left) > LEFT_COLUMN) printf("  %s\n  %-*s %s\n", left, LEFT_COLUMN, "", right);
  else printf("  %-*s %s\n", LEFT_COLUMN, left, right);
}

static void print_synopsis(const command_line *line) {
  printf("%s", line->name);
  for (int i = 0; i < MAX_ARGUMENTS && line->arguments[i]; ++i) printf(" %s", line->arguments[i]);
  for (option_place at = {line->tables, NULL}; next_option(&at);) {
    if (must_be_given(at.row)) printf(" %s %s", at.row->name, at.row->form);
  }
  printf(" [options]");
}

// Prints the options; returns how many options for research were left out.
static uint32_t print_options(const command_line *line, bool all) {
  bool shown = true;
  uint32_t left_out = 0;
  for (option_place at = {line->tables, NULL}; next_option(&at);) {
    const char *title = title_at(&at);
    if (title) shown = all || strcmp(title, RESEARCH) != 0;
    if (!shown) {
      left_out++;
      continue;
    }
    if (title) printf("\n%s:\n", title);
    char left[MOST_FORM];
    write_left(at.row, left, sizeof left);
    print_left_and_right(left, at.row->help);
  }
  return left_out;
}

static void print_terminal(const command_line *line, bool all) {
  printf("usage: %s", program_prefix(line->name));
  print_synopsis(line);
  printf("\n\n%s\n", line->summary);
  if (line->example) printf("\n  %s\n", line->example);
  printf("\n");
  const uint32_t left_out = print_options(line, all);
  printf("\n");
  print_left_and_right("--quiet", "no warnings and no progress; errors and results stay");
  print_left_and_right("--help [all]", "this text");
  if (left_out)
    printf("\n%s%s --help all shows %u more options, for research.\n", program_prefix(line->name), line->name,
           left_out);
}

// Escapes dashes and backslashes, which have meanings in troff, like a dot at the beginning of a line.
static void print_escaped(const char *text) {
  if (*text == '.' || *text == '\'') printf("\\&");
  for (; *text; ++text) {
    if (*text == '-') printf("\\-");
    else if (*text == '\\') printf("\\\\");
    else putchar(*text);
  }
}

// Prints the name of a manual page, which has dashes where the command has spaces.
static void print_page_name(const command_line *line) {
  const char *const parts[] = {program_prefix(line->name), line->name};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
    for (const char *at = parts[i]; *at; ++at) putchar(*at == ' ' ? '-' : *at);
  }
}

static void print_manual(const command_line *line) {
  const char *prefix = program_prefix(line->name);
  printf(".TH ");
  print_page_name(line);
  printf(" 1 \"\" \"octalux %s\" \"User Commands\"\n.SH NAME\n", olx_version());
  print_page_name(line);
  printf(" \\- ");
  print_escaped(line->summary);
  printf("\n.SH SYNOPSIS\n%s", prefix);
  print_synopsis(line);
  printf("\n.SH OPTIONS\n");
  for (option_place at = {line->tables, NULL}; next_option(&at);) {
    char left[MOST_FORM];
    write_left(at.row, left, sizeof left);
    if (title_at(&at)) printf(".SS %s\n", title_at(&at));
    printf(".TP\n");
    print_escaped(left);
    printf("\n");
    print_escaped(at.row->help);
    printf("\n");
  }
  printf(".TP\n\\-\\-quiet\nno warnings and no progress; errors and results stay\n");
  if (!line->example) return;
  printf(".SH EXAMPLE\n");
  print_escaped(line->example);
  printf("\n");
}

static void print_words(const command_line *line) {
  for (option_place at = {line->tables, NULL}; next_option(&at);) printf("%s\n", at.row->name);
  printf("--quiet\n--help\n");
}

void print_help(const command_line *line, help_form form) {
  if (form == HELP_MANUAL) print_manual(line);
  else if (form == HELP_WORDS) print_words(line);
  else print_terminal(line, form == HELP_ALL);
}

// Returns the edit distance between two words: the least number of insertions, deletions, replacements and swaps of
// neighbours.
static size_t distance_between(const char *a, size_t a_length, const char *b, size_t b_length) {
  size_t rows[3][LONGEST_WORD + 1];
  size_t *before = rows[0], *last = rows[1], *now = rows[2];
  for (size_t j = 0; j <= b_length; ++j) last[j] = j;
  for (size_t i = 1; i <= a_length; ++i) {
    now[0] = i;
    for (size_t j = 1; j <= b_length; ++j) {
      const size_t replaced = last[j - 1] + (a[i - 1] != b[j - 1]);
      size_t least = last[j] + 1 < now[j - 1] + 1 ? last[j] + 1 : now[j - 1] + 1;
      if (replaced < least) least = replaced;
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped && before[j - 2] + 1 < least) least = before[j - 2] + 1;
      now[j] = least;
    }
    size_t *oldest = before;
    before = last;
    last = now;
    now = oldest;
  }
  return last[b_length];
}

const char *nearest_word(const char *word, size_t length, const char *const *known, size_t count) {
  const char *nearest = NULL;
  size_t least = LONGEST_WORD;
  if (length > LONGEST_WORD) return NULL;
  for (size_t i = 0; i < count; ++i) {
    const size_t known_length = strlen(known[i]);
    if (known_length > LONGEST_WORD) continue;
    const size_t distance = distance_between(word, length, known[i], known_length);
    if (distance >= least || 3 * distance > known_length) continue;
    least = distance;
    nearest = known[i];
  }
  return nearest;
}
