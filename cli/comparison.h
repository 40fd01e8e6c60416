// The options of `octalux compare`, and its results.
#ifndef OCTALUX_CLI_COMPARISON_H
#define OCTALUX_CLI_COMPARISON_H

#include <octalux/render.h>

#include <cjson/cJSON.h>

typedef struct layer_errors {
  bool compared;
  olx_metrics metrics;
  olx_perceptual perceptual; // not numbers for layers that are no colours
  float *flip_map;           // NULL when nothing draws it
} layer_errors;

typedef struct comparison {
  const char *paths[2];
  olx_image images[2];
  uint32_t layer; // or OLX_LAYER_COUNT for every layer of light that both have
  olx_perceptual_settings perceptual;
  const char *heatmap, *flip_map, *report;
  bool json;
  layer_errors layers[OLX_LAYER_COUNT];
} comparison;

// The object `layers` of --json: for each layer that was compared, its metrics.
cJSON *comparison_layers(const comparison *c);

// Write the HTML report; `command` is the command line that asked for it. EXIT_DONE or EXIT_FAILED.
int write_comparison_report(const comparison *c, const char *command);

#endif
