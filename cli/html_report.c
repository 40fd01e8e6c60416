#include "html_report.h"

#include "options.h"
#include "report.h"

#include <math.h>
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
  fputs("octalux", out);
  for (int i = 0; i < argc; ++i) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
    const bool quoted = !argv[i][0] || argv[i][strspn(argv[i], plain)];
    fputs(quoted ? " '" : " ", out);
    for (const char *c = argv[i]; *c; ++c) *c == '\'' ? fputs("'\\''", out) : fputc(*c, out);
    if (quoted) fputc('\'', out);
  }
  return fclose(out) == 0 ? text : NULL;
}

static const char base64_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

static cJSON *base64_text(const uint8_t *bytes, size_t size_bytes) {
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
  return base64_text(palette, sizeof palette);
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

// A new object at the end of the array `key` of `parent`.
static cJSON *append_object(cJSON *parent, const char *key) {
  cJSON *array = cJSON_GetObjectItem(parent, key), *object = cJSON_CreateObject();
  if (!array) array = cJSON_AddArrayToObject(parent, key);
  cJSON_AddItemToArray(array, object);
  return object;
}

cJSON *html_report_section(cJSON *report, const char *heading, const char *note, const char *command) {
  cJSON *section = append_object(report, "sections");
  add_text(section, "heading", heading);
  if (note) add_text(section, "note", note);
  if (command) add_text(section, "command", command);
  return section;
}

cJSON *html_report_table(cJSON *section, const char *caption) {
  cJSON *table = append_object(section, "tables");
  add_text(table, "caption", caption);
  cJSON_AddArrayToObject(table, "columns");
  cJSON_AddArrayToObject(table, "rows");
  return table;
}

void html_report_column(cJSON *table, const char *name, const char *note) {
  cJSON *column = append_object(table, "columns");
  add_text(column, "name", name);
  if (note) add_text(column, "note", note);
}

cJSON *html_report_row(cJSON *table) {
  cJSON *row = cJSON_CreateArray();
  cJSON_AddItemToArray(cJSON_GetObjectItem(table, "rows"), row);
  return row;
}

void html_report_plot(cJSON *section, const char *caption, char *svg) {
  cJSON *plot = append_object(section, "plots");
  add_text(plot, "caption", caption);
  add_text(plot, "svg", svg ? svg : "");
  free(svg);
}

cJSON *html_report_frame(cJSON *section, const char *name, const olx_image *image) {
  cJSON *frame = append_object(section, "frames");
  add_text(frame, "name", name);
  add_number(frame, "width", image->width);
  add_number(frame, "height", image->height);
  return frame;
}

void html_report_fact(cJSON *frame, const char *name, double value) {
  cJSON *fact = append_object(frame, "facts");
  add_text(fact, "name", name);
  add_number(fact, "value", value);
}

// A half float with the last three bits of its mantissa zero: a step is below 1 %, and the file is two thirds as large.
static uint16_t short_half(float value) {
  const uint16_t sign = value < 0.0f ? 0x8000 : 0;
  const float magnitude = fabsf(value);
  if (isnan(value)) return 0x7e00;
  if (magnitude >= 65024.0f) return sign | 0x7bf8;
  if (magnitude < 0x1p-14f) return sign | (uint16_t)lroundf(magnitude * 0x1p24f);
  int exponent;
  const float mantissa = frexpf(magnitude, &exponent); // 0.5 to 1; rounding up carries into the exponent
  return sign | (uint16_t)(((exponent + 14) << 10) + ((int)lroundf(mantissa * 256.0f) - 128) * 8);
}

static olx_result add_png(cJSON *frame, cJSON *item, uint32_t channels, uint32_t height, const uint8_t *pixels) {
  const uint32_t width = (uint32_t)cJSON_GetObjectItem(frame, "width")->valuedouble;
  uint8_t *png;
  size_t size_bytes;
  const olx_result result = olx_png_encode(width, height, channels, pixels, &png, &size_bytes);
  if (result != OLX_OK) return result;
  cJSON_AddItemToObject(item, "png", base64_text(png, size_bytes));
  olx_png_free(png);
  return OLX_OK;
}

static void put_half(uint8_t *high, uint8_t *low, float value) {
  const uint16_t half = short_half(value);
  *high = (uint8_t)(half >> 8);
  *low = (uint8_t)half;
}

// A PNG of twice the height: the high bytes above, the low bytes below.
olx_result html_report_picture(cJSON *frame, const char *name, const olx_image *image, olx_layer layer,
                               float exposure) {
  cJSON *picture = append_object(frame, "pictures");
  add_text(picture, "name", name);
  add_number(picture, "exposure", (double)exposure);
  const size_t pixels = (size_t)image->width * image->height;
  uint8_t *bytes = malloc(6 * pixels);
  if (!bytes) return OLX_ERROR_MEMORY;
  for (size_t i = 0; i < pixels; ++i) {
    const olx_vec3 light = image->layers[layer][i];
    const bool gray = layer == OLX_LAYER_DEPTH;
    const float channels[3] = {light.x, gray ? light.x : light.y, gray ? light.x : light.z};
    for (size_t k = 0; k < 3; ++k) put_half(bytes + 3 * i + k, bytes + 3 * (pixels + i) + k, channels[k] * exposure);
  }
  const olx_result result = add_png(frame, picture, 3, 2 * image->height, bytes);
  free(bytes);
  return result;
}

olx_result html_report_map(cJSON *frame, const char *name, const float *values, map_scale scale) {
  cJSON *map = append_object(frame, "maps");
  add_text(map, "name", name);
  add_number(map, "low", scale.low);
  add_number(map, "high", scale.high);
  cJSON_AddBoolToObject(map, "logarithmic", scale.logarithmic);
  const uint32_t height = (uint32_t)cJSON_GetObjectItem(frame, "height")->valuedouble;
  const size_t pixels = (size_t)cJSON_GetObjectItem(frame, "width")->valuedouble * height;
  uint8_t *bytes = malloc(pixels);
  if (!bytes) return OLX_ERROR_MEMORY;
  for (size_t i = 0; i < pixels; ++i) bytes[i] = (uint8_t)(255.0f * fminf(fmaxf(values[i], 0.0f), 1.0f) + 0.5f);
  const olx_result result = add_png(frame, map, 1, height, bytes);
  free(bytes);
  return result;
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
    if (*json == '<') fputs("\\u003c", out), ++json;
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
