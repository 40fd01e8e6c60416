// The options of `octalux compare`, and its results.
#ifndef OCTALUX_CLI_COMPARISON_H
#define OCTALUX_CLI_COMPARISON_H

#include <octalux/render.h>

#include <cjson/cJSON.h>

typedef struct layer_errors {
  bool compared;
  olx_metrics metrics;
  olx_perceptual perceptual; // NaN for layers without colour
  float *flip_map;           // NULL when it is not drawn
} layer_errors;

typedef struct comparison {
  const char *paths[2];
  olx_image images[2];
  uint32_t layer; // OLX_LAYER_COUNT means every layer of light that both images have
  olx_perceptual_settings perceptual;
  const char *heatmap, *flip_map, *report;
  bool json;
  layer_errors layers[OLX_LAYER_COUNT];
} comparison;

// Builds the object `layers` of --json: the metrics of each compared layer.
cJSON *comparison_layers(const comparison *c);

// Writes the HTML report; `command` is the command line of the comparison. Returns EXIT_DONE or EXIT_FAILED.
int write_comparison_report(const comparison *c, const char *command);

#endif
