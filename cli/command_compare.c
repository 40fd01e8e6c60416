// octalux compare: prints metrics of two images layer by layer, draws maps of FLIP, and writes a report.
#include "commands.h"
#include "comparison.h"
#include "files.h"
#include "html_report.h"
#include "options.h"
#include "report.h"

#include <octalux/render.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LAYERS "beauty|direct|indirect_diffuse|indirect_glossy|albedo|normal|depth|standard_error"

static int compare_failure(const comparison *c) {
  return failure("compare", "%s and %s: %s", c->paths[0], c->paths[1], olx_last_error());
}

static bool wanted(const comparison *c, uint32_t layer) {
  if (c->layer != OLX_LAYER_COUNT) return layer == c->layer;
  return layer <= OLX_LAYER_INDIRECT_GLOSSY && c->images[0].layers[layer] && c->images[1].layers[layer];
}

// Returns the layer whose images are drawn.
static olx_layer drawn_layer(const comparison *c) {
  return c->layer == OLX_LAYER_COUNT ? OLX_LAYER_BEAUTY : (olx_layer)c->layer;
}

static int compare_layer(comparison *c, olx_layer layer) {
  layer_errors *errors = &c->layers[layer];
  const olx_image *image = &c->images[0], *reference = &c->images[1];
  errors->compared = true;
  errors->perceptual = (olx_perceptual){NAN, NAN};
  if (olx_compare(image, reference, layer, &errors->metrics) != OLX_OK) return compare_failure(c);
  if (!olx_layer_is_color(layer)) return EXIT_DONE;
  if (c->report || (c->flip_map && layer == drawn_layer(c))) {
    errors->flip_map = malloc((size_t)image->width * image->height * sizeof *errors->flip_map);
    if (!errors->flip_map)
      return failure("compare", "no memory for a map of %ux%u pixels", image->width, image->height);
  }
  const olx_result result =
      olx_compare_perceptual(image, reference, layer, &c->perceptual, errors->flip_map, &errors->perceptual);
  return result == OLX_OK ? EXIT_DONE : compare_failure(c);
}

static int compare_layers(comparison *c) {
  bool any = false;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!wanted(c, layer)) continue;
    const int code = compare_layer(c, (olx_layer)layer);
    if (code != EXIT_DONE) return code;
    any = true;
  }
  if (any) return EXIT_DONE;
  return failure("compare", "%s and %s have no layer of light in common", c->paths[0], c->paths[1]);
}

static int draw_flip_map(const comparison *c) {
  const layer_errors *errors = &c->layers[drawn_layer(c)];
  if (!errors->flip_map) {
    return failure("compare", "%s: there is no layer %s of colours to look at in both", c->flip_map,
                   olx_layer_name(drawn_layer(c)));
  }
  const olx_result result = olx_flip_map_save(errors->flip_map, c->images[0].width, c->images[0].height, c->flip_map);
  return result == OLX_OK ? EXIT_DONE : library_failure("compare");
}

cJSON *comparison_layers(const comparison *c) {
  cJSON *layers = cJSON_CreateObject();
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
  return layers;
}

static int print_compare_json(const comparison *c) {
  cJSON *object = cJSON_CreateObject();
  cJSON_AddItemToObject(object, "layers", comparison_layers(c));
  return print_json("compare", object);
}

// Prints a perceptual metric; layers without colour have none.
static void print_perceptual(double value) {
  if (isnan(value)) printf(" %8s", "-");
  else printf(" %8.5f", value);
}

static void print_compare(const comparison *c) {
  printf("%-18s %12s %12s %10s %12s %12s %8s %8s\n", "layer", "mse", "relative mse", "psnr", "bias", "max", "ssim",
         "flip");
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    const olx_metrics *m = &c->layers[layer].metrics;
    if (!c->layers[layer].compared) continue;
    printf("%-18s %12.6g %12.6g %10.2f %+12.6g %12.6g", olx_layer_name((olx_layer)layer), m->mse, m->relative_mse,
           m->psnr, m->bias, m->max);
    print_perceptual(c->layers[layer].perceptual.ssim);
    print_perceptual(c->layers[layer].perceptual.flip);
    putchar('\n');
  }
}

static const char *bounces_text(const olx_image *image, char text[16]) {
  if (image->bounces == OLX_BOUNCES_INFINITE) return "all";
  snprintf(text, 16, "%u", image->bounces);
  return text;
}

// Warns about images with different numbers of bounces, which differ by light that one of them cannot have.
static void warn_of_other_bounces(const comparison *c) {
  const olx_image *a = &c->images[0], *b = &c->images[1];
  char texts[2][16];
  if (!a->bounces_known || !b->bounces_known || a->bounces == b->bounces) return;
  warn("%s has %s bounces of indirect light and %s has %s: render the reference with --field, which takes those of the "
       "field",
       c->paths[0], bounces_text(a, texts[0]), c->paths[1], bounces_text(b, texts[1]));
}

static int compare_images(comparison *c, const command_files *files, const char *command) {
  for (int i = 0; i < 2; ++i) {
    if (olx_image_load(c->paths[i], &c->images[i]) != OLX_OK) return library_failure("compare");
  }
  warn_of_other_bounces(c);
  int code = compare_layers(c);
  if (code == EXIT_DONE && c->heatmap &&
      olx_compare_heatmap(&c->images[0], &c->images[1], drawn_layer(c), c->heatmap) != OLX_OK) {
    code = compare_failure(c);
  }
  if (code == EXIT_DONE && c->flip_map) code = draw_flip_map(c);
  if (code == EXIT_DONE && c->report) code = write_comparison_report(c, command);
  if (code != EXIT_DONE) return code;
  if (c->json) return print_compare_json(c);
  print_beside_outputs(files);
  print_compare(c);
  return EXIT_DONE;
}

static int check_name(const char *name, const char *path, const char *ending) {
  if (!path || is_output_named(path, ending)) return EXIT_DONE;
  return usage_error("compare", "%s: '%s' does not end in %s", name, path, ending);
}

static const option compare_options[] = {
    {"--layer", OPTION_CHOICE, offsetof(comparison, layer), LAYERS,
     "this layer alone; default: every layer of light both have"},
    {"--exposure", OPTION_REAL, offsetof(comparison, perceptual.exposure), "X",
     "multiply light before the tone map, for SSIM and FLIP; default 1"},
    {"--pixels-per-degree", OPTION_REAL, offsetof(comparison, perceptual.pixels_per_degree), "X",
     "of the eye that FLIP stands for, at most 1000; default 67"},
    {"--heatmap", OPTION_TEXT, offsetof(comparison, heatmap), "FILE.png",
     "draw where the layer (default beauty) differs"},
    {"--flip-map", OPTION_TEXT, offsetof(comparison, flip_map), "FILE.png", "draw FLIP of the layer (default beauty)"},
    {"--report", OPTION_TEXT, offsetof(comparison, report), "FILE.html",
     "a page to look at: slider, maps, plots, numbers"},
    {"--threads", OPTION_COUNT, offsetof(comparison, perceptual.threads), "N",
     "default 0: every processor; the numbers are the same", 0, 4096},
    {0},
};

int command_compare(int argc, char **argv) {
  comparison c = {.layer = OLX_LAYER_COUNT, .perceptual = olx_perceptual_settings_default()};
  command_line line = {.name = "compare",
                       .summary =
                           "Errors of a picture against a reference: relative MSE is sum (a-b)^2 / sum b^2, bias\n"
                           "sum (a-b) / sum b, PSNR over the reference's maximum. SSIM and FLIP compare the pictures\n"
                           "as `render` writes them to .png.",
                       .example = "octalux compare room.exr reference.exr --report differences.html",
                       .arguments = {"IMAGE.exr", "REFERENCE.exr"},
                       .tables = {{compare_options, &c}, {json_option, &c.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (c.perceptual.pixels_per_degree > 1000.0f) {
    return usage_error("compare", "--pixels-per-degree: %g is more than 1000", (double)c.perceptual.pixels_per_degree);
  }
  code = check_name("--heatmap", c.heatmap, ".png");
  if (code == EXIT_DONE) code = check_name("--flip-map", c.flip_map, ".png");
  if (code == EXIT_DONE) code = check_name("--report", c.report, ".html");
  const command_files files = {.inputs = {line.given[0], line.given[1]},
                               .outputs = {{c.heatmap, true}, {c.flip_map, true}, {c.report, true}}};
  if (code == EXIT_DONE) code = check_files("compare", &files, c.json);
  if (code != EXIT_DONE) return code;
  c.paths[0] = line.given[0];
  c.paths[1] = line.given[1];
  char *command = command_text(argc, argv);
  code = command ? compare_images(&c, &files, command) : failure("compare", "out of memory");
  free(command);
  for (int layer = 0; layer < OLX_LAYER_COUNT; ++layer) free(c.layers[layer].flip_map);
  for (int i = 0; i < 2; ++i) olx_image_free(&c.images[i]);
  return code;
}
