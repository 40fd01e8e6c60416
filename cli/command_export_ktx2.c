// octalux export ktx2: writes a field's irradiance volume as a texture for engines that read ambient cubes, such as
// Bevy (docs/exporting.md).
#include "commands.h"
#include "files.h"
#include "options.h"
#include "report.h"

#include <octalux/export.h>

#include <stdio.h>

static const char COMMAND[] = "export ktx2";

typedef struct cubes_export {
  const char *field, *output;
  olx_cubes_settings settings;
  bool plain, json;
} cubes_export;

static int check_export(const cubes_export *e) {
  const command_files files = {.inputs = {e->field}, .outputs = {{e->output, true}}};
  if (!is_output_named(e->output, ".ktx2")) return usage_error(COMMAND, "-o: '%s' does not end in .ktx2", e->output);
  if (e->settings.size[0] && e->settings.spacing_metres > 0.0f) {
    return usage_error(COMMAND, "--size and --spacing exclude each other");
  }
  return check_files(COMMAND, &files, e->json);
}

static void print_volume(const cubes_export *e, const olx_cubes_info *info) {
  const command_files files = {.outputs = {{e->output, true}}};
  print_beside_outputs(&files);
  printf("%s: %ux%ux%u voxels, %u of them inside geometry, %s\n", e->output, info->size[0], info->size[1],
         info->size[2], info->inside, text_of_bytes(info->file_bytes).text);
  printf("  transform  translation %.9g %.9g %.9g, scale %.9g %.9g %.9g (metres, y up)\n", info->translation[0],
         info->translation[1], info->translation[2], info->scale[0], info->scale[1], info->scale[2]);
  printf("  surfaces   relative MSE %.4f at %u points", info->written_error, info->points);
  if (!e->plain) printf(", %.4f before the fit", info->captured_error);
  puts("");
}

static int report_volume(const cubes_export *e, const olx_cubes_info *info) {
  if (!e->json) {
    print_volume(e, info);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_text(object, "output", e->output);
  add_counts(object, "size", info->size);
  cJSON_AddItemToObject(object, "translation", cJSON_CreateDoubleArray(info->translation, 3));
  cJSON_AddItemToObject(object, "scale", cJSON_CreateDoubleArray(info->scale, 3));
  add_number(object, "inside", info->inside);
  add_number(object, "points", info->points);
  add_number(object, "captured_error", info->captured_error);
  add_number(object, "written_error", info->written_error);
  add_number(object, "file_bytes", (double)info->file_bytes);
  return print_json(COMMAND, object);
}

static int write_volume(const cubes_export *e) {
  olx_field *field = NULL;
  olx_cubes_info info;
  progress_line shown;
  if (olx_field_open(e->field, &field) != OLX_OK) return library_failure(COMMAND);
  progress_begin(&shown, COMMAND, false);
  const olx_progress progress = progress_of(&shown);
  const olx_result result = olx_export_ktx2(field, &e->settings, e->output, &progress, &info);
  progress_end(&shown);
  olx_field_close(field);
  if (result == OLX_ERROR_CANCELLED) return failure(COMMAND, "%s: interrupted, nothing written", e->output);
  return result == OLX_OK ? report_volume(e, &info) : library_failure(COMMAND);
}

static const option ktx2_options[] = {
    {"-o", OPTION_TEXT, offsetof(cubes_export, output), "FILE.ktx2", "the texture to write", 1},
    {"--size", OPTION_GRID, offsetof(cubes_export, settings.size), "32x12x24", "voxels along x, y, z", 1,
     OLX_CUBES_MOST_TEXELS},
    {"--spacing", OPTION_REAL, offsetof(cubes_export, settings.spacing_metres), "METRES",
     "side of a voxel instead; default: 1/32 of the scene's longest side"},
    {"--plain", OPTION_FLAG, offsetof(cubes_export, plain), NULL, "do not fit voxels to surfaces; leaks through walls"},
    {"--zstd", OPTION_FLAG, offsetof(cubes_export, settings.zstd), NULL,
     "compress the texels; the loader must know Zstandard"},
    {"--threads", OPTION_COUNT, offsetof(cubes_export, settings.threads), "N",
     "default 0: every processor; the result is the same", 0, 1024},
    {0}};

int command_export_ktx2(int argc, char **argv) {
  cubes_export e = {.settings = olx_cubes_settings_default()};
  command_line line = {.name = COMMAND,
                       .summary = "Write the irradiance volume as a texture that Bevy reads, fitted to surfaces.",
                       .example = "octalux export ktx2 room.olx -o volume.ktx2 --spacing 0.25",
                       .arguments = {"FIELD"},
                       .tables = {{ktx2_options, &e}, {json_option, &e.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  e.field = line.given[0];
  e.settings.fit = !e.plain;
  code = check_export(&e);
  return code == EXIT_DONE ? write_volume(&e) : code;
}
