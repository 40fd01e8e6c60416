// The results of an experiment: tables of named rows, and plots of their columns, written as text, as JSON, and into a
// report.
#ifndef OCTALUX_BENCH_FINDINGS_H
#define OCTALUX_BENCH_FINDINGS_H

#include <stdbool.h>
#include <stdint.h>

#include <cjson/cJSON.h>

typedef enum bench_kind {
  BENCH_NAME,      // text; all names of a row together identify it
  BENCH_COUNT,     // a setting, or a value derived from settings alone
  BENCH_QUALITY,   // measured, and the same in every run
  BENCH_SPREAD,    // uncertainty of a quality
  BENCH_TIME,      // measured, and specific to this machine and run
  BENCH_PUBLISHED, // from the paper
  BENCH_DIFFERENCE // replaced by the columns of an image's difference from its reference
} bench_kind;

enum { BENCH_COLUMNS = 32, BENCH_DIFFERENCE_COLUMNS = 6 }; // the most of a table; those of a difference

typedef struct bench_column {
  const char *key, *name;
  bench_kind kind;
  const char *unit; // such as "ms", or NULL; with "%" values are shares, shown in percent
  const char *note; // its meaning, or NULL
} bench_column;

typedef struct bench_cell bench_cell;
struct bench_cell {
  const char *text;        // for names; copied
  double number;           // NaN leaves the cell empty
  const bench_cell *group; // the cells of BENCH_DIFFERENCE instead, or NULL
};
#define TEXT_CELL(t) ((bench_cell){.text = (t)})
#define NUMBER_CELL(n) ((bench_cell){.number = (n)})
#define DIFFERENCE_CELLS(cells) ((bench_cell){.group = (cells)})
#define NO_CELL ((bench_cell){.number = NAN})

// A plot of a table's columns. Lines: one series for each value of the column `series`, or a single one. Bars, with `x`
// NULL: one for each row, labelled by the column `series`, or by all its names.
typedef struct bench_plot {
  const char *caption, *x, *y, *series; // keys of columns
  bool log_x, log_y;
} bench_plot;

typedef struct bench_table {
  const char *name, *caption;
  bench_column columns[BENCH_COLUMNS];
  uint32_t column_count, row_count, capacity;
  bench_cell *cells;
  const bench_plot *plots;
  uint32_t plot_count;
} bench_table;

enum { FINDINGS_TABLES = 12, FINDINGS_SKIPPED = 32 };

typedef struct findings {
  uint32_t table_count, skipped_count;
  bench_table tables[FINDINGS_TABLES];
  struct {
    char what[64], why[320];
  } skipped[FINDINGS_SKIPPED];
  bool exhausted;                    // out of memory
  double seconds, processor_seconds; // seconds: elapsed; processor_seconds: of all threads
} findings;

// Adds a table; columns and strings are static. It is valid until findings_free.
bench_table *findings_table(findings *f, const char *name, const char *caption, const bench_column *columns,
                            uint32_t column_count, const bench_plot *plots, uint32_t plot_count);
#define FINDINGS_TABLE(f, name, caption, columns, plots)                                                               \
  findings_table(f, name, caption, columns, sizeof(columns) / sizeof *(columns), plots, sizeof(plots) / sizeof *(plots))

void findings_row(findings *f, bench_table *table, const bench_cell *cells, uint32_t count);
#define FINDINGS_ROW(f, table, ...)                                                                                    \
  findings_row(f, table, (const bench_cell[]){__VA_ARGS__},                                                            \
               sizeof((const bench_cell[]){__VA_ARGS__}) / sizeof(bench_cell))

// Records something that was skipped, and the reason.
void findings_skip(findings *f, const char *what, const char *why);
void findings_free(findings *f);

void findings_print(const findings *f);
// Adds "tables", "skipped", "seconds" and "processor_seconds" to an object.
void findings_add_json(const findings *f, cJSON *object);
// Adds tables, plots and what was skipped to a section of a report.
void findings_add_report(const findings *f, cJSON *section);

#endif
