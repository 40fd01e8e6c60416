// Builds a report as a tree of JSON, and writes it into one HTML file together with the page's script and style.
#include "html_report.h"

#include "options.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The page with its style and script, made by cmake/EmbedReport.cmake; {{title}} and {{data}} are left to fill in.
extern const char html_report_page[];

char *command_text(int argc, char **argv) {
  char *text = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&text, &size_bytes);
  if (!out) return NULL;
  fputs(program_prefix(argv[0]), out);
  for (int i = 0; i < argc; ++i) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
    const bool quoted = !argv[i][0] || argv[i][strspn(argv[i], plain)];
    if (i > 0) fputc(' ', out);
    if (quoted) fputc('\'', out);
    for (const char *c = argv[i]; *c; ++c) *c == '\'' ? fputs("'\\''", out) : fputc(*c, out);
    if (quoted) fputc('\'', out);
  }
  return fclose(out) == 0 ? text : NULL;
}

static const char base64_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

cJSON *html_report_bytes(const uint8_t *bytes, size_t size_bytes) {
  char *text = malloc((size_bytes + 2) / 3 * 4 + 1), *end = text;
  if (!text) return NULL;
  for (size_t i = 0; i < size_bytes; i += 3) {
    const uint32_t left = size_bytes - i < 3 ? (uint32_t)(size_bytes - i) : 3;
    const uint32_t group =
        (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
    for (uint32_t k = 0; k < 4; ++k) *end++ = k <= left ? base64_digits[group >> (18 - 6 * k) & 63] : '=';
  }
  *end = 0;
  cJSON *item = cJSON_CreateString(text);
  free(text);
  return item;
}

static cJSON *magma_palette(void) {
  uint8_t palette[3 * 256];
  for (int i = 0; i < 256; ++i) olx_magma((float)i / 255.0f, palette + 3 * i);
  return html_report_bytes(palette, sizeof palette);
}

// A new object at the end of the array `key` of `parent`.
cJSON *html_report_append(cJSON *parent, const char *key) {
  cJSON *array = cJSON_GetObjectItem(parent, key), *object = cJSON_CreateObject();
  if (!array) array = cJSON_AddArrayToObject(parent, key);
  cJSON_AddItemToArray(array, object);
  return object;
}

cJSON *html_report_begin(const char *title, const char *command) {
  cJSON *report = cJSON_CreateObject();
  add_text(report, "title", title);
  add_text(report, "version", olx_version());
  add_text(report, "command", command);
  cJSON_AddItemToObject(report, "palette", magma_palette());
  cJSON_AddArrayToObject(report, "sections");
  return report;
}

cJSON *html_report_section(cJSON *report, const char *heading, const char *note, const char *command) {
  cJSON *section = html_report_append(report, "sections");
  add_text(section, "heading", heading);
  if (note) add_text(section, "note", note);
  if (command) add_text(section, "command", command);
  return section;
}

cJSON *html_report_table(cJSON *section, const char *caption) {
  cJSON *table = html_report_append(section, "tables");
  add_text(table, "caption", caption);
  cJSON_AddArrayToObject(table, "columns");
  cJSON_AddArrayToObject(table, "rows");
  return table;
}

void html_report_column(cJSON *table, const char *name, const char *note) {
  cJSON *column = html_report_append(table, "columns");
  add_text(column, "name", name);
  if (note) add_text(column, "note", note);
}

cJSON *html_report_row(cJSON *table) {
  cJSON *row = cJSON_CreateArray();
  cJSON_AddItemToArray(cJSON_GetObjectItem(table, "rows"), row);
  return row;
}

void html_report_plot(cJSON *section, const char *caption, char *svg) {
  cJSON *plot = html_report_append(section, "plots");
  add_text(plot, "caption", caption);
  add_text(plot, "svg", svg ? svg : "");
  free(svg);
}

static void put_escaped(FILE *out, const char *text) {
  for (; *text; ++text) {
    switch (*text) {
    case '<': fputs("&lt;", out); break;
    case '&': fputs("&amp;", out); break;
    default: fputc(*text, out);
    }
  }
}

// JSON inside a <script>: only "<" could end it or begin a comment.
static void put_script_data(FILE *out, const char *json) {
  while (*json) {
    const size_t length = strcspn(json, "<");
    fwrite(json, 1, length, out);
    json += length;
    if (*json != '<') break;
    fputs("\\u003c", out);
    ++json;
  }
}

static void put_page(FILE *out, const char *title, const char *json) {
  const char *title_mark = strstr(html_report_page, "{{title}}"), *data_mark = strstr(title_mark, "{{data}}");
  fwrite(html_report_page, 1, (size_t)(title_mark - html_report_page), out);
  put_escaped(out, title);
  title_mark += strlen("{{title}}");
  fwrite(title_mark, 1, (size_t)(data_mark - title_mark), out);
  put_script_data(out, json);
  fputs(data_mark + strlen("{{data}}"), out);
}

int html_report_write(const char *command, cJSON *report, const char *path) {
  char *json = cJSON_PrintUnformatted(report), *page = NULL;
  size_t size_bytes = 0;
  FILE *out = json ? open_memstream(&page, &size_bytes) : NULL;
  bool whole = false;
  if (out) {
    put_page(out, cJSON_GetObjectItem(report, "title")->valuestring, json);
    whole = !ferror(out);
    whole = fclose(out) == 0 && whole;
  }
  cJSON_free(json);
  cJSON_Delete(report);
  int code = EXIT_DONE;
  if (!whole) code = failure(command, "%s: out of memory", path);
  else if (olx_write_file(path, page, size_bytes) != OLX_OK) code = library_failure(command);
  free(page);
  return code;
}
