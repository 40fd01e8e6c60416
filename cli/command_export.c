// octalux export: writes maps of probes as images, parts of a field as models for other tools, and web pages.
#include "commands.h"
#include "files.h"
#include "options.h"
#include "report.h"

#include <octalux/export.h>

#include <stdio.h>
#include <string.h>

#define MAPS                                                                                                           \
  "distance|emitter|normal|base_color|roughness|metallic|specular_weight|direct|indirect|emission|radiance|"           \
  "irradiance|mean_distance|mean_square_distance|classic_irradiance|classic_radiance_0|classic_radiance_1|"            \
  "classic_radiance_2|classic_radiance_3|classic_radiance_4|volume_irradiance"

// Checks the output and opens the field, which the caller closes.
static int open_export(const char *command, const char *input, const char *output, const char *ending, bool in_order,
                       bool json, olx_field **field) {
  const command_files files = {.inputs = {input}, .outputs = {{output, in_order}}};
  if (in_order ? !is_output_named(output, ending) : !ends_with(output, ending)) {
    return usage_error(command, "-o: '%s' does not end in %s", output, ending);
  }
  const int code = check_files(command, &files, json);
  if (code != EXIT_DONE) return code;
  return olx_field_open(input, field) == OLX_OK ? EXIT_DONE : library_failure(command);
}

typedef struct map_export {
  const char *output;
  olx_map_picture picture;
  bool json;
} map_export;

static int report_map(const map_export *e, uint32_t width, uint32_t height) {
  const olx_map_picture *picture = &e->picture;
  const char *map = olx_map_name(picture->map), *projection = olx_map_projection_name(picture->projection);
  if (!e->json) {
    printf("%s: %s of probe %u, %ux%u pixels, %s\n", e->output, map, picture->probe, width, height, projection);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_text(object, "output", e->output);
  add_text(object, "map", map);
  add_text(object, "projection", projection);
  add_number(object, "probe", picture->probe);
  add_number(object, "width", width);
  add_number(object, "height", height);
  return print_json("export exr", object);
}

static const option map_options[] = {
    {"-o", OPTION_TEXT, offsetof(map_export, output), "FILE.exr", "the picture to write", 1},
    {"--map", OPTION_CHOICE, offsetof(map_export, picture.map), MAPS,
     "what to show; from irradiance on of irradiance probes, the last of the volume's"},
    {"--probe", OPTION_COUNT, offsetof(map_export, picture.probe), "N",
     "counted from 0, of the map's kind of probes; default 0", 0, UINT32_MAX - 1},
    {"--projection", OPTION_CHOICE, offsetof(map_export, picture.projection), "octahedral|latlong|cube",
     "default octahedral: as it is stored"},
    {"--size", OPTION_COUNT, offsetof(map_export, picture.size), "N",
     "height of latlong, side of a cube's face; default: the map's, half of it", 1, 2048},
    {0}};

static int export_exr(int argc, char **argv) {
  map_export e = {.picture = {.projection = OLX_PROJECTION_OCTAHEDRAL}};
  command_line line = {.name = "export exr",
                       .summary = "Write a map of a probe as a picture of 32-bit floats.",
                       .example = "octalux export exr room.olx --map distance --probe 3 -o distance.exr",
                       .arguments = {"FIELD"},
                       .tables = {{map_options, &e}, {json_option, &e.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (!was_given(&line, "--map"))
    return usage_error(line.name, "--map NAME is missing (see octalux export exr --help)");
  olx_field *field = NULL;
  code = open_export(line.name, line.given[0], e.output, ".exr", false, e.json, &field);
  if (code != EXIT_DONE) return code;
  uint32_t width, height;
  const olx_result result = olx_export_map(field, &e.picture, e.output, &width, &height);
  olx_field_close(field);
  return result == OLX_OK ? report_map(&e, width, height) : library_failure(line.name);
}

static int report_gltf(const command_files *files, const olx_gltf_counts *counts, bool json) {
  const char *output = files->outputs[0].path;
  if (!json) {
    print_beside_outputs(files);
    printf(
        "%s: %u light field probes, %u irradiance probes, %u probes and %u cells of the volume, %u bricks whole and %u "
        "divided\n",
        output, counts->probes, counts->irradiance_probes, counts->volume_probes, counts->volume_cells, counts->bricks,
        counts->divided_bricks);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_text(object, "output", output);
  add_number(object, "probes", counts->probes);
  add_number(object, "irradiance_probes", counts->irradiance_probes);
  add_number(object, "volume_probes", counts->volume_probes);
  add_number(object, "volume_cells", counts->volume_cells);
  add_number(object, "bricks", counts->bricks);
  add_number(object, "divided_bricks", counts->divided_bricks);
  return print_json("export gltf", object);
}

static const option model_option[] = {{"-o", OPTION_TEXT, 0, "FILE.gltf", "the model to write", 1}, {0}};

static int export_gltf(int argc, char **argv) {
  bool json = false;
  const char *output = NULL;
  command_line line = {.name = "export gltf",
                       .summary = "Write probes, irradiance volume and bricks as a model to look at, over the scene.",
                       .example = "octalux export gltf room.olx -o probes.gltf",
                       .arguments = {"FIELD"},
                       .tables = {{model_option, &output}, {json_option, &json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  olx_field *field = NULL;
  code = open_export(line.name, line.given[0], output, ".gltf", true, json, &field);
  if (code != EXIT_DONE) return code;
  olx_gltf_counts counts;
  const olx_result result = olx_export_gltf(field, output, &counts);
  olx_field_close(field);
  const command_files files = {.outputs = {{output, true}}};
  return result == OLX_OK ? report_gltf(&files, &counts, json) : library_failure(line.name);
}

static int print_formats(FILE *stream) {
  fputs("usage: octalux export FORMAT INPUT -o OUTPUT [options] (octalux export FORMAT --help says more)\n\n"
        "  octalux export exr FIELD --map NAME -o FILE.exr     a map of a probe as a picture\n"
        "  octalux export gltf FIELD -o FILE.gltf              probes, irradiance volume and bricks as a model\n"
        "  octalux export ktx2 FIELD -o FILE.ktx2              the irradiance volume as a texture that Bevy reads\n"
        "  octalux export web SCENE --field FIELD -o DIR       a page to walk through the scene in a browser\n",
        stream);
  return EXIT_DONE;
}

int command_export(int argc, char **argv) {
  if (argc < 2) return usage_error("export", "FORMAT is missing: exr, gltf, ktx2 or web (see octalux export --help)");
  if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) return print_formats(stdout);
  if (strcmp(argv[1], "exr") == 0) return export_exr(argc - 1, argv + 1);
  if (strcmp(argv[1], "gltf") == 0) return export_gltf(argc - 1, argv + 1);
  if (strcmp(argv[1], "ktx2") == 0) return command_export_ktx2(argc - 1, argv + 1);
  if (strcmp(argv[1], "web") == 0) return command_export_web(argc - 1, argv + 1);
  return usage_error("export", "'%s' is not one of exr, gltf, ktx2, web", argv[1]);
}
