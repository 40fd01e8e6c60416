// Writes the report of a comparison: images in a slider, metrics as tables and bars, and curves of FLIP.
#include "comparison.h"
#include "html_report.h"
#include "options.h"
#include "plot.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS 100 // points of the curve of FLIP

static const char *file_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash && slash[1] ? slash + 1 : path;
}

typedef struct layer_title {
  char text[32];
} layer_title;

// Returns the title of a layer, such as "indirect diffuse".
static layer_title title_of(uint32_t layer) {
  layer_title title;
  snprintf(title.text, sizeof title.text, "%s", olx_layer_name((olx_layer)layer));
  for (char *c = title.text; *c; ++c) {
    if (*c == '_') *c = ' ';
  }
  return title;
}

static olx_result add_frame(cJSON *section, const comparison *c, uint32_t layer) {
  const olx_image *image = &c->images[0], *reference = &c->images[1];
  const layer_errors *errors = &c->layers[layer];
  cJSON *frame = html_report_frame(section, title_of(layer).text, image);
  html_report_fact(frame, "FLIP", errors->perceptual.flip);
  html_report_fact(frame, "SSIM", errors->perceptual.ssim);
  html_report_fact(frame, "relative MSE", errors->metrics.relative_mse);
  html_report_fact(frame, "bias", errors->metrics.bias);
  for (int i = 0; i < 2; ++i) {
    const olx_result result =
        html_report_picture(frame, file_name(c->paths[i]), &c->images[i], (olx_layer)layer, c->perceptual.exposure);
    if (result != OLX_OK) return result;
  }
  if (errors->flip_map) {
    const olx_result result = html_report_flip(frame, "FLIP", errors->flip_map);
    if (result != OLX_OK) return result;
  }
  return html_report_squares(frame, "squared error", image, reference, (olx_layer)layer);
}

static void add_metrics_table(cJSON *section, const comparison *c) {
  cJSON *table = html_report_table(section, "Every layer");
  html_report_column(table, "layer", NULL);
  html_report_column(table, "FLIP", "mean LDR-FLIP of the tone-mapped pictures: 0 is equal, 1 as different as can be");
  html_report_column(table, "SSIM", "mean structural similarity of tone-mapped luma: 1 is equal");
  html_report_column(table, "MSE", "mean squared error of light");
  html_report_column(table, "relative MSE", "sum (a-b)\u00b2 / sum b\u00b2");
  html_report_column(table, "PSNR, dB", "over the reference's maximum");
  html_report_column(table, "bias", "sum (a-b) / sum b");
  html_report_column(table, "max", "largest absolute difference");
  static const char *const keys[] = {"flip", "ssim", "mse", "relative_mse", "psnr", "bias", "max"};
  cJSON *layers = comparison_layers(c), *entry = layers->child;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!c->layers[layer].compared) continue;
    cJSON *row = html_report_row(table);
    cJSON_AddItemToArray(row, cJSON_CreateString(title_of(layer).text));
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
      cJSON_AddItemToArray(row, cJSON_DetachItemFromObject(entry, keys[i]));
    }
    entry = entry->next;
  }
  cJSON_Delete(layers);
}

static void add_bars(cJSON *section, const comparison *c) {
  layer_title titles[OLX_LAYER_COUNT];
  const char *names[OLX_LAYER_COUNT];
  double flip[OLX_LAYER_COUNT], bias[OLX_LAYER_COUNT];
  uint32_t count = 0;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!c->layers[layer].compared) continue;
    titles[count] = title_of(layer);
    names[count] = titles[count].text;
    flip[count] = c->layers[layer].perceptual.flip;
    bias[count++] = 100.0 * c->layers[layer].metrics.bias;
  }
  const plot_series of_flip = {.name = "FLIP", .y = flip, .count = count},
                    of_bias = {.name = "bias", .y = bias, .count = count};
  bar_plot plot = {.label = "mean FLIP", .names = names, .name_count = count, .series = &of_flip, .series_count = 1};
  html_report_plot(section, "How different it looks", plot_bars(&plot));
  plot.label = "bias, %";
  plot.series = &of_bias;
  html_report_plot(section, "Light too much or missing", plot_bars(&plot));
}

// Adds curves of the percentage of pixels whose FLIP is at least x.
static void add_flip_curves(cJSON *section, const comparison *c) {
  const size_t pixels = (size_t)c->images[0].width * c->images[0].height;
  double x[STEPS + 1], y[OLX_LAYER_COUNT][STEPS + 1];
  plot_series series[OLX_LAYER_COUNT];
  layer_title titles[OLX_LAYER_COUNT];
  uint32_t count = 0;
  for (int i = 0; i <= STEPS; ++i) x[i] = (double)i / STEPS;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    const float *map = c->layers[layer].flip_map;
    if (!map) continue;
    uint64_t histogram[STEPS + 1] = {0}, above = 0;
    for (size_t i = 0; i < pixels; ++i) histogram[(int)(map[i] * (float)STEPS)] += 1;
    for (int i = STEPS; i >= 0; --i) {
      above += histogram[i];
      y[count][i] = 100.0 * (double)above / (double)pixels;
    }
    titles[count] = title_of(layer);
    series[count] = (plot_series){titles[count].text, x, y[count], STEPS + 1};
    ++count;
  }
  if (count == 0) return;
  const line_plot plot = {
      .x_label = "FLIP", .y_label = "pixels at or above, %", .log_y = true, .series = series, .series_count = count};
  html_report_plot(section, "How much of the picture differs", plot_lines(&plot));
}

int write_comparison_report(const comparison *c, const char *command) {
  char title[512], note[256];
  snprintf(title, sizeof title, "%s against %s", file_name(c->paths[0]), file_name(c->paths[1]));
  snprintf(note, sizeof note, "%u \u00d7 %u pixels, tone mapped at exposure %g, %g pixels per degree.",
           c->images[0].width, c->images[0].height, (double)c->perceptual.exposure,
           (double)c->perceptual.pixels_per_degree);
  cJSON *report = html_report_begin(title, command);
  cJSON *section = html_report_section(report, "Pictures", note, NULL);
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!c->layers[layer].compared || add_frame(section, c, layer) == OLX_OK) continue;
    cJSON_Delete(report);
    return failure("compare", "%s: no memory for the layer %s", c->report, olx_layer_name((olx_layer)layer));
  }
  section = html_report_section(report, "Numbers", NULL, NULL);
  add_metrics_table(section, c);
  add_bars(section, c);
  add_flip_curves(section, c);
  return html_report_write("compare", report, c->report);
}
