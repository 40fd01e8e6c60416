#include "commands.h"
#include "options.h"
#include "report.h"

#include <octalux/render.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LAYERS "beauty|direct|indirect_diffuse|indirect_glossy|albedo|normal|depth|standard_error"

typedef struct layer_errors {
  bool compared;
  olx_metrics metrics;
  olx_perceptual perceptual; // not numbers for layers that are no colours
} layer_errors;

typedef struct comparison {
  const char *paths[2];
  olx_image images[2];
  uint32_t layer; // or OLX_LAYER_COUNT for every layer of light that both have
  olx_perceptual_settings perceptual;
  const char *heatmap, *flip_map;
  bool json;
  layer_errors layers[OLX_LAYER_COUNT];
} comparison;

static int compare_failure(const comparison *c) {
  return failure("compare", "%s and %s: %s", c->paths[0], c->paths[1], olx_last_error());
}

static bool wanted(const comparison *c, uint32_t layer) {
  if (c->layer != OLX_LAYER_COUNT) return layer == c->layer;
  return layer <= OLX_LAYER_INDIRECT_GLOSSY && c->images[0].layers[layer] && c->images[1].layers[layer];
}

// The layer whose pictures are drawn.
static olx_layer drawn_layer(const comparison *c) {
  return c->layer == OLX_LAYER_COUNT ? OLX_LAYER_BEAUTY : (olx_layer)c->layer;
}

static olx_result compare_layer(comparison *c, olx_layer layer) {
  layer_errors *errors = &c->layers[layer];
  const olx_image *image = &c->images[0], *reference = &c->images[1];
  errors->perceptual = (olx_perceptual){NAN, NAN};
  const olx_result result = olx_compare(image, reference, layer, &errors->metrics);
  if (result != OLX_OK || !olx_layer_is_color(layer)) return result;
  return olx_compare_perceptual(image, reference, layer, &c->perceptual, NULL, &errors->perceptual);
}

static int compare_layers(comparison *c) {
  bool any = false;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!wanted(c, layer)) continue;
    if (compare_layer(c, (olx_layer)layer) != OLX_OK) return compare_failure(c);
    c->layers[layer].compared = any = true;
  }
  if (any) return EXIT_DONE;
  return failure("compare", "%s and %s have no layer of light in common", c->paths[0], c->paths[1]);
}

static int draw_flip_map(const comparison *c) {
  const olx_image *image = &c->images[0];
  olx_perceptual perceptual;
  float *map = malloc((size_t)image->width * image->height * sizeof *map);
  if (!map) return failure("compare", "%s: out of memory", c->flip_map);
  olx_result result = olx_compare_perceptual(image, &c->images[1], drawn_layer(c), &c->perceptual, map, &perceptual);
  if (result == OLX_OK) result = olx_flip_map_save(map, image->width, image->height, c->flip_map);
  free(map);
  return result == OLX_OK ? EXIT_DONE : compare_failure(c);
}

static int print_compare_json(const comparison *c) {
  cJSON *object = cJSON_CreateObject();
  cJSON *layers = cJSON_AddObjectToObject(object, "layers");
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    const layer_errors *errors = &c->layers[layer];
    if (!errors->compared) continue;
    cJSON *entry = cJSON_AddObjectToObject(layers, olx_layer_name((olx_layer)layer));
    add_number(entry, "mse", errors->metrics.mse);
    add_number(entry, "relative_mse", errors->metrics.relative_mse);
    add_number(entry, "psnr", errors->metrics.psnr);
    add_number(entry, "bias", errors->metrics.bias);
    add_number(entry, "max", errors->metrics.max);
    add_number(entry, "ssim", errors->perceptual.ssim);
    add_number(entry, "flip", errors->perceptual.flip);
  }
  return print_json("compare", object);
}

static void print_compare(const comparison *c) {
  printf("%-18s %12s %12s %10s %12s %12s %8s %8s\n", "layer", "mse", "relative mse", "psnr", "bias", "max", "ssim",
         "flip");
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    const olx_metrics *m = &c->layers[layer].metrics;
    const olx_perceptual *p = &c->layers[layer].perceptual;
    if (!c->layers[layer].compared) continue;
    printf("%-18s %12.6g %12.6g %10.2f %+12.6g %12.6g %8.5f %8.5f\n", olx_layer_name((olx_layer)layer), m->mse,
           m->relative_mse, m->psnr, m->bias, m->max, p->ssim, p->flip);
  }
}

static int compare_images(comparison *c) {
  for (int i = 0; i < 2; ++i) {
    if (olx_image_load(c->paths[i], &c->images[i]) != OLX_OK) return library_failure("compare");
  }
  int code = compare_layers(c);
  if (code == EXIT_DONE && c->heatmap &&
      olx_compare_heatmap(&c->images[0], &c->images[1], drawn_layer(c), c->heatmap) != OLX_OK) {
    code = compare_failure(c);
  }
  if (code == EXIT_DONE && c->flip_map) code = draw_flip_map(c);
  if (code != EXIT_DONE) return code;
  if (c->json) return print_compare_json(c);
  print_compare(c);
  return EXIT_DONE;
}

// Whether a picture that was asked for can be written.
static int check_picture(const char *name, const char *path) {
  if (!path) return EXIT_DONE;
  if (!ends_with(path, ".png")) return usage_error("compare", "%s: '%s' does not end in .png", name, path);
  return check_output("compare", path) ? EXIT_DONE : EXIT_FAILED;
}

int command_compare(int argc, char **argv) {
  comparison c = {.layer = OLX_LAYER_COUNT, .perceptual = olx_perceptual_settings_default()};
  const option options[] = {
      {"--layer", OPTION_CHOICE, &c.layer, LAYERS, "this layer alone; default: every layer of light both have", 0, 0},
      {"--exposure", OPTION_REAL, &c.perceptual.exposure, "X",
       "multiply light before the tone map, for SSIM and FLIP; default 1", 0, 0},
      {"--pixels-per-degree", OPTION_REAL, &c.perceptual.pixels_per_degree, "X",
       "of the eye that FLIP stands for, at most 1000; default 67", 0, 0},
      {"--heatmap", OPTION_TEXT, &c.heatmap, "FILE.png", "draw where the layer (default beauty) differs", 0, 0},
      {"--flip-map", OPTION_TEXT, &c.flip_map, "FILE.png", "draw FLIP of the layer (default beauty)", 0, 0},
      {"--threads", OPTION_COUNT, &c.perceptual.threads, "N", "default 0: every processor; the numbers are the same", 0,
       4096},
      {"--json", OPTION_FLAG, &c.json, NULL, "print one JSON object", 0, 0},
  };
  command_line line = {.name = "compare",
                       .summary =
                           "Errors of a picture against a reference: relative MSE is sum (a-b)^2 / sum b^2, bias\n"
                           "sum (a-b) / sum b, PSNR over the reference's maximum. SSIM and FLIP compare the pictures\n"
                           "as `render` writes them to .png.",
                       .arguments = {"IMAGE.exr", "REFERENCE.exr"},
                       .options = options,
                       .option_count = sizeof options / sizeof options[0]};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (c.perceptual.pixels_per_degree > 1000.0f) {
    return usage_error("compare", "--pixels-per-degree: %g is more than 1000", (double)c.perceptual.pixels_per_degree);
  }
  code = check_picture("--heatmap", c.heatmap);
  if (code == EXIT_DONE) code = check_picture("--flip-map", c.flip_map);
  if (code != EXIT_DONE) return code;
  c.paths[0] = line.given[0];
  c.paths[1] = line.given[1];
  code = compare_images(&c);
  for (int i = 0; i < 2; ++i) olx_image_free(&c.images[i]);
  return code;
}
