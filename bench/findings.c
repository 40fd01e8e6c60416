// Stores the results of an experiment as tables and plots, and writes them as text, as JSON, and into a report.
#include "findings.h"

#include "html_report.h"
#include "plot.h"
#include "report.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SERIES = 12, CELL_TEXT = 96 };

static const bench_column difference_columns[BENCH_DIFFERENCE_COLUMNS] = {
    {"mse", "MSE", BENCH_QUALITY, NULL, "mean squared error of light, free of noise on average"},
    {"noise", "\u00b1", BENCH_SPREAD, NULL, "what noise may be off in it: at least its standard error"},
    {"relative_mse", "relative MSE", BENCH_QUALITY, NULL, "over the reference's mean square"},
    {"bias", "bias", BENCH_QUALITY, "%", "light too much or missing, over the reference's mean"},
    {"ssim", "SSIM", BENCH_QUALITY, NULL, "structural similarity of the tone-mapped pictures: 1 is equal"},
    {"flip", "FLIP", BENCH_QUALITY, NULL, "mean LDR-FLIP of the tone-mapped pictures: 0 is equal"},
};

// Adds columns to a table, with those of a difference in place of BENCH_DIFFERENCE.
static void add_columns(bench_table *table, const bench_column *columns, uint32_t count) {
  for (uint32_t c = 0; c < count; ++c) {
    const bool several = columns[c].kind == BENCH_DIFFERENCE;
    const uint32_t own = several ? BENCH_DIFFERENCE_COLUMNS : 1;
    assert(table->column_count + own <= BENCH_COLUMNS);
    memcpy(table->columns + table->column_count, several ? difference_columns : &columns[c], sizeof *columns * own);
    table->column_count += own;
  }
}

// Writes cells, with those of a difference in its place. Returns their number.
static uint32_t expand_cells(const bench_cell *cells, uint32_t count, bench_cell expanded[BENCH_COLUMNS]) {
  uint32_t total = 0;
  for (uint32_t c = 0; c < count; ++c) {
    const uint32_t own = cells[c].group ? BENCH_DIFFERENCE_COLUMNS : 1;
    assert(total + own <= BENCH_COLUMNS);
    memcpy(expanded + total, cells[c].group ? cells[c].group : &cells[c], sizeof *expanded * own);
    total += own;
  }
  return total;
}

bench_table *findings_table(findings *f, const char *name, const char *caption, const bench_column *columns,
                            uint32_t column_count, const bench_plot *plots, uint32_t plot_count) {
  assert(f->table_count < FINDINGS_TABLES);
  bench_table *table = &f->tables[f->table_count++];
  *table = (bench_table){.name = name, .caption = caption, .plots = plots, .plot_count = plot_count};
  add_columns(table, columns, column_count);
  return table;
}

void findings_row(findings *f, bench_table *table, const bench_cell *given, uint32_t given_count) {
  bench_cell cells[BENCH_COLUMNS];
  const uint32_t count = expand_cells(given, given_count, cells);
  assert(count == table->column_count);
  if (table->row_count == table->capacity) {
    const uint32_t capacity = table->capacity ? 2 * table->capacity : 16;
    bench_cell *grown = realloc(table->cells, sizeof *grown * capacity * count);
    if (!grown) {
      f->exhausted = true;
      return;
    }
    table->cells = grown;
    table->capacity = capacity;
  }
  bench_cell *row = table->cells + (size_t)count * table->row_count++;
  for (uint32_t i = 0; i < count; ++i) {
    row[i] = cells[i];
    if (!cells[i].text) continue;
    row[i].text = strdup(cells[i].text);
    if (!row[i].text) f->exhausted = true;
  }
}

void findings_skip(findings *f, const char *what, const char *why) {
  assert(f->skipped_count < FINDINGS_SKIPPED);
  snprintf(f->skipped[f->skipped_count].what, sizeof f->skipped->what, "%s", what);
  snprintf(f->skipped[f->skipped_count++].why, sizeof f->skipped->why, "%s", why);
}

void findings_free(findings *f) {
  for (uint32_t t = 0; t < f->table_count; ++t) {
    bench_table *table = &f->tables[t];
    for (size_t i = 0; i < (size_t)table->row_count * table->column_count; ++i)
      free((void *)(uintptr_t)table->cells[i].text);
    free(table->cells);
  }
  *f = (findings){.table_count = 0};
}

static bool is_share(const bench_column *column) { return column->unit && strcmp(column->unit, "%") == 0; }

typedef struct cell_text {
  char text[CELL_TEXT];
} cell_text;

static cell_text text_of_cell(const bench_column *column, const bench_cell *cell) {
  cell_text out = {""};
  const double shown = is_share(column) ? 100.0 * cell->number : cell->number;
  if (column->kind == BENCH_NAME) snprintf(out.text, sizeof out.text, "%s", cell->text ? cell->text : "");
  else if (isnan(shown)) return out;
  else if (fabs(shown) < 1e7 && shown == rint(shown)) snprintf(out.text, sizeof out.text, "%.0f", shown);
  else if (fabs(shown) >= 1000.0 && fabs(shown) < 1e7) snprintf(out.text, sizeof out.text, "%.0f", shown);
  else snprintf(out.text, sizeof out.text, "%.3g", shown);
  if (column->kind != BENCH_NAME && is_share(column)) strcat(out.text, " %");
  return out;
}

static cell_text heading_of(const bench_column *column) {
  cell_text out;
  const bool unit = column->unit && !is_share(column);
  snprintf(out.text, sizeof out.text, "%s%s%s", column->name, unit ? ", " : "", unit ? column->unit : "");
  return out;
}

static const bench_cell *cell_at(const bench_table *table, uint32_t row, uint32_t column) {
  return &table->cells[(size_t)table->column_count * row + column];
}

// Returns the width of UTF-8 text in characters, not bytes.
static int width_of(const char *text) {
  int width = 0;
  for (; *text; ++text) width += (*text & 0xc0) != 0x80;
  return width;
}

static void print_cell(const char *text, int width, bool left) {
  const int pad = width - width_of(text);
  if (left) printf("| %s%*s ", text, pad, "");
  else printf("| %*s%s ", pad, "", text);
}

static void print_table(const bench_table *table) {
  printf("\n%s\n\n", table->caption);
  int widths[64];
  assert(table->column_count <= 64);
  for (uint32_t c = 0; c < table->column_count; ++c) {
    widths[c] = width_of(heading_of(&table->columns[c]).text);
    if (widths[c] < 3) widths[c] = 3;
    for (uint32_t r = 0; r < table->row_count; ++r) {
      const int width = width_of(text_of_cell(&table->columns[c], cell_at(table, r, c)).text);
      if (width > widths[c]) widths[c] = width;
    }
  }
  for (uint32_t c = 0; c < table->column_count; ++c) {
    print_cell(heading_of(&table->columns[c]).text, widths[c], table->columns[c].kind == BENCH_NAME);
  }
  puts("|");
  for (uint32_t c = 0; c < table->column_count; ++c) {
    const bool left = table->columns[c].kind == BENCH_NAME;
    fputs(left ? "| " : "| ", stdout);
    for (int i = left ? 0 : 1; i < widths[c]; ++i) putchar('-');
    fputs(left ? " " : ": ", stdout);
  }
  puts("|");
  for (uint32_t r = 0; r < table->row_count; ++r) {
    for (uint32_t c = 0; c < table->column_count; ++c) {
      print_cell(text_of_cell(&table->columns[c], cell_at(table, r, c)).text, widths[c],
                 table->columns[c].kind == BENCH_NAME);
    }
    puts("|");
  }
}

void findings_print(const findings *f) {
  for (uint32_t t = 0; t < f->table_count; ++t) {
    if (f->tables[t].row_count > 0) print_table(&f->tables[t]);
  }
  if (f->skipped_count > 0) putchar('\n');
  for (uint32_t i = 0; i < f->skipped_count; ++i) printf("Left out: %s: %s\n", f->skipped[i].what, f->skipped[i].why);
  fflush(stdout);
}

static const char *const kind_names[] = {"name", "count", "quality", "spread", "time", "published"};

static void add_table(const bench_table *table, cJSON *list) {
  cJSON *object = cJSON_CreateObject();
  cJSON_AddItemToArray(list, object);
  add_text(object, "name", table->name);
  add_text(object, "caption", table->caption);
  cJSON *columns = cJSON_AddArrayToObject(object, "columns"), *rows = cJSON_AddArrayToObject(object, "rows");
  for (uint32_t c = 0; c < table->column_count; ++c) {
    cJSON *column = cJSON_CreateObject();
    cJSON_AddItemToArray(columns, column);
    add_text(column, "key", table->columns[c].key);
    add_text(column, "name", table->columns[c].name);
    add_text(column, "kind", kind_names[table->columns[c].kind]);
    if (table->columns[c].unit)
      add_text(column, "unit", is_share(&table->columns[c]) ? "share" : table->columns[c].unit);
  }
  for (uint32_t r = 0; r < table->row_count; ++r) {
    cJSON *row = cJSON_CreateObject();
    cJSON_AddItemToArray(rows, row);
    for (uint32_t c = 0; c < table->column_count; ++c) {
      const bench_cell *cell = cell_at(table, r, c);
      if (table->columns[c].kind == BENCH_NAME) add_text(row, table->columns[c].key, cell->text ? cell->text : "");
      else add_number(row, table->columns[c].key, cell->number);
    }
  }
}

static void add_skipped(const findings *f, cJSON *object) {
  cJSON *list = cJSON_AddArrayToObject(object, "skipped");
  for (uint32_t i = 0; i < f->skipped_count; ++i) {
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(list, entry);
    add_text(entry, "what", f->skipped[i].what);
    add_text(entry, "why", f->skipped[i].why);
  }
}

void findings_add_json(const findings *f, cJSON *object) {
  add_number(object, "seconds", f->seconds);
  add_number(object, "processor_seconds", f->processor_seconds);
  cJSON *list = cJSON_AddArrayToObject(object, "tables");
  for (uint32_t t = 0; t < f->table_count; ++t) add_table(&f->tables[t], list);
  add_skipped(f, object);
}

static uint32_t column_of(const bench_table *table, const char *key) {
  uint32_t c = 0;
  while (strcmp(table->columns[c].key, key) != 0) ++c; // plots refer only to existing columns
  return c;
}

static double plotted(const bench_table *table, uint32_t row, uint32_t column) {
  const double value = cell_at(table, row, column)->number;
  return is_share(&table->columns[column]) ? 100.0 * value : value;
}

static cell_text axis_of(const bench_column *column) {
  cell_text out;
  snprintf(out.text, sizeof out.text, "%s%s%s", column->name, column->unit ? ", " : "",
           column->unit ? column->unit : "");
  return out;
}

// Draws rows in their order; each new name in the column begins a series.
static char *draw_lines(const bench_table *table, const bench_plot *plot) {
  plot_series series[MOST_SERIES];
  uint32_t count = 0;
  double *values = calloc(2 * (size_t)MOST_SERIES * table->row_count, sizeof *values);
  if (!values) return NULL;
  const uint32_t x = column_of(table, plot->x), y = column_of(table, plot->y);
  for (uint32_t r = 0; r < table->row_count; ++r) {
    const char *name = plot->series ? cell_at(table, r, column_of(table, plot->series))->text : "";
    uint32_t s = 0;
    while (s < count && strcmp(series[s].name, name) != 0) ++s;
    if (s == MOST_SERIES) continue;
    double *own = values + 2 * (size_t)s * table->row_count;
    if (s == count) series[count++] = (plot_series){.name = name, .x = own, .y = own + table->row_count};
    own[series[s].count] = plotted(table, r, x);
    own[table->row_count + series[s].count++] = plotted(table, r, y);
  }
  const cell_text x_label = axis_of(&table->columns[x]), y_label = axis_of(&table->columns[y]);
  const line_plot lines = {.x_label = x_label.text,
                           .y_label = y_label.text,
                           .log_x = plot->log_x,
                           .log_y = plot->log_y,
                           .markers = true,
                           .series = series,
                           .series_count = count};
  char *svg = plot_lines(&lines);
  free(values);
  return svg;
}

// Returns the names of a row, separated by commas.
static cell_text row_name(const bench_table *table, uint32_t row, const char *key) {
  cell_text out = {""};
  size_t used = 0;
  for (uint32_t c = 0; c < table->column_count; ++c) {
    if (table->columns[c].kind != BENCH_NAME || (key && strcmp(table->columns[c].key, key) != 0)) continue;
    const char *text = cell_at(table, row, c)->text;
    if (used < sizeof out.text)
      used += (size_t)snprintf(out.text + used, sizeof out.text - used, "%s%s", used ? ", " : "", text);
  }
  return out;
}

static char *draw_bars(const bench_table *table, const bench_plot *plot) {
  const char **names = calloc(table->row_count, sizeof *names);
  cell_text *texts = calloc(table->row_count, sizeof *texts);
  double *values = calloc(table->row_count, sizeof *values);
  const uint32_t y = column_of(table, plot->y);
  uint32_t count = 0;
  char *svg = NULL;
  if (names && values && texts) {
    for (uint32_t r = 0; r < table->row_count; ++r) {
      if (isnan(plotted(table, r, y))) continue;
      texts[count] = row_name(table, r, plot->series);
      names[count] = texts[count].text;
      values[count++] = plotted(table, r, y);
    }
    const plot_series series = {.name = table->columns[y].name, .y = values, .count = count};
    const cell_text label = axis_of(&table->columns[y]);
    const bar_plot bars = {
        .label = label.text, .names = names, .name_count = count, .series = &series, .series_count = 1};
    svg = plot_bars(&bars);
  }
  free(names);
  free(texts);
  free(values);
  return svg;
}

static void report_table(const bench_table *table, cJSON *section) {
  cJSON *shown = html_report_table(section, table->caption);
  cJSON *columns = cJSON_GetObjectItem(shown, "columns");
  for (uint32_t c = 0; c < table->column_count; ++c) {
    html_report_column(shown, heading_of(&table->columns[c]).text, table->columns[c].note);
    cJSON *column = cJSON_GetArrayItem(columns, (int)c);
    add_text(column, "kind", kind_names[table->columns[c].kind]);
    if (is_share(&table->columns[c])) add_text(column, "unit", "%");
  }
  for (uint32_t r = 0; r < table->row_count; ++r) {
    cJSON *row = html_report_row(shown);
    for (uint32_t c = 0; c < table->column_count; ++c) {
      const bench_cell *cell = cell_at(table, r, c);
      cJSON *item = table->columns[c].kind == BENCH_NAME ? cJSON_CreateString(cell->text ? cell->text : "")
                    : isfinite(cell->number)             ? cJSON_CreateNumber(cell->number)
                                                         : cJSON_CreateNull();
      cJSON_AddItemToArray(row, item);
    }
  }
  for (uint32_t p = 0; p < table->plot_count; ++p) {
    const bench_plot *plot = &table->plots[p];
    html_report_plot(section, plot->caption, plot->x ? draw_lines(table, plot) : draw_bars(table, plot));
  }
}

void findings_add_report(const findings *f, cJSON *section) {
  for (uint32_t t = 0; t < f->table_count; ++t) {
    if (f->tables[t].row_count > 0) report_table(&f->tables[t], section);
  }
  if (f->skipped_count > 0) add_skipped(f, section);
  add_number(section, "seconds", f->seconds);
  add_number(section, "processor_seconds", f->processor_seconds);
}
