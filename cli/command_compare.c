#include "commands.h"
#include "options.h"
#include "report.h"

#include <octalux/render.h>

#include <stdio.h>
#include <string.h>

#define LAYERS "beauty|direct|indirect_diffuse|indirect_glossy|albedo|normal|depth|standard_error"

typedef struct comparison {
  const char *paths[2];
  olx_image images[2];
  uint32_t layer; // or OLX_LAYER_COUNT for every layer of light that both have
  const char *heatmap;
  bool json;
} comparison;

static void add_metrics(cJSON *layers, olx_layer layer, const olx_metrics *metrics) {
  cJSON *entry = cJSON_AddObjectToObject(layers, olx_layer_name(layer));
  add_number(entry, "mse", metrics->mse);
  add_number(entry, "relative_mse", metrics->relative_mse);
  add_number(entry, "psnr", metrics->psnr);
  add_number(entry, "bias", metrics->bias);
  add_number(entry, "max", metrics->max);
}

static bool wanted(const comparison *c, uint32_t layer) {
  if (c->layer != OLX_LAYER_COUNT) return layer == c->layer;
  return layer <= OLX_LAYER_INDIRECT_GLOSSY && c->images[0].layers[layer] && c->images[1].layers[layer];
}

static int compare_failure(const comparison *c) {
  return failure("compare", "%s and %s: %s", c->paths[0], c->paths[1], olx_last_error());
}

static int print_compare_json(const bool compared[OLX_LAYER_COUNT], const olx_metrics metrics[OLX_LAYER_COUNT]) {
  cJSON *object = cJSON_CreateObject();
  cJSON *layers = cJSON_AddObjectToObject(object, "layers");
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (compared[layer]) add_metrics(layers, (olx_layer)layer, &metrics[layer]);
  }
  return print_json("compare", object);
}

static void print_compare(const bool compared[OLX_LAYER_COUNT], const olx_metrics metrics[OLX_LAYER_COUNT]) {
  printf("%-18s %12s %12s %10s %12s %12s\n", "layer", "mse", "relative mse", "psnr", "bias", "max");
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    const olx_metrics *m = &metrics[layer];
    if (!compared[layer]) continue;
    printf("%-18s %12.6g %12.6g %10.2f %+12.6g %12.6g\n", olx_layer_name((olx_layer)layer), m->mse, m->relative_mse,
           m->psnr, m->bias, m->max);
  }
}

static int compare_layers(const comparison *c) {
  olx_metrics metrics[OLX_LAYER_COUNT];
  bool compared[OLX_LAYER_COUNT] = {false}, any = false;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!wanted(c, layer)) continue;
    if (olx_compare(&c->images[0], &c->images[1], (olx_layer)layer, &metrics[layer]) != OLX_OK) {
      return compare_failure(c);
    }
    compared[layer] = any = true;
  }
  if (!any) return failure("compare", "%s and %s have no layer of light in common", c->paths[0], c->paths[1]);
  if (c->json) return print_compare_json(compared, metrics);
  print_compare(compared, metrics);
  return EXIT_DONE;
}

static int compare_images(comparison *c) {
  for (int i = 0; i < 2; ++i) {
    if (olx_image_load(c->paths[i], &c->images[i]) != OLX_OK) return library_failure("compare");
  }
  if (c->heatmap) {
    const olx_layer layer = c->layer == OLX_LAYER_COUNT ? OLX_LAYER_BEAUTY : (olx_layer)c->layer;
    if (olx_compare_heatmap(&c->images[0], &c->images[1], layer, c->heatmap) != OLX_OK) return compare_failure(c);
  }
  return compare_layers(c);
}

int command_compare(int argc, char **argv) {
  comparison c = {.layer = OLX_LAYER_COUNT};
  const option options[] = {
      {"--layer", OPTION_CHOICE, &c.layer, LAYERS, "this layer alone; default: every layer of light both have", 0, 0},
      {"--heatmap", OPTION_TEXT, &c.heatmap, "FILE.png", "draw where the layer (default beauty) differs", 0, 0},
      {"--json", OPTION_FLAG, &c.json, NULL, "print one JSON object", 0, 0},
  };
  command_line line = {.name = "compare",
                       .summary =
                           "Errors of a picture against a reference: relative MSE is sum (a-b)^2 / sum b^2, bias\n"
                           "sum (a-b) / sum b, PSNR over the reference's maximum.",
                       .arguments = {"IMAGE.exr", "REFERENCE.exr"},
                       .options = options,
                       .option_count = sizeof options / sizeof options[0]};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (c.heatmap && !ends_with(c.heatmap, ".png")) {
    return usage_error("compare", "--heatmap: '%s' does not end in .png", c.heatmap);
  }
  if (c.heatmap && !check_output("compare", c.heatmap)) return EXIT_FAILED;
  c.paths[0] = line.given[0];
  c.paths[1] = line.given[1];
  code = compare_images(&c);
  for (int i = 0; i < 2; ++i) olx_image_free(&c.images[i]);
  return code;
}
