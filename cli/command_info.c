// octalux info and octalux verify: print the content of a field file, packed or not, and verify every byte of it.
#include "commands.h"
#include "options.h"
#include "report.h"

#include <octalux/export.h>
#include <octalux/field.h>

#include <inttypes.h>
#include <stdio.h>

typedef struct block {
  const char *name;
  uint64_t bytes;
} block;

#define BLOCK_COUNT 15
#define CURRENT_VERSION 2 // of field files

static void list_blocks(const olx_field_info *info, block blocks[BLOCK_COUNT]) {
  const block list[BLOCK_COUNT] = {
      {"radiance", info->bytes.radiance}, {"normal", info->bytes.normal},      {"distance", info->bytes.distance},
      {"pyramid", info->bytes.pyramid},   {"material", info->bytes.material},  {"direct", info->bytes.direct},
      {"indirect", info->bytes.indirect}, {"emission", info->bytes.emission},  {"irradiance", info->bytes.irradiance},
      {"moments", info->bytes.moments},   {"selector", info->bytes.selectors}, {"classic", info->bytes.classic},
      {"relight", info->bytes.relight},   {"volume", info->bytes.volume},      {"geometry", info->bytes.geometry}};
  for (int i = 0; i < BLOCK_COUNT; ++i) blocks[i] = list[i];
}

static void add_grid(cJSON *object, const char *key, const olx_grid *grid) {
  cJSON *entry = cJSON_AddObjectToObject(object, key);
  add_vec3(entry, "origin", grid->origin);
  add_vec3(entry, "spacing", grid->spacing);
  add_counts(entry, "count", grid->count);
}

typedef struct select_list {
  char text[64];
} select_list;

static select_list select_names(uint32_t mask) {
  select_list list = {.text = "none"};
  size_t length = 0;
  for (olx_select select = OLX_SELECT_CAGE; select < OLX_SELECT_EXHAUSTIVE; ++select) {
    if (!(mask & 1u << select)) continue;
    length += (size_t)snprintf(list.text + length, sizeof list.text - length, "%s%s", length ? "," : "",
                               olx_select_name(select));
  }
  return list;
}

// The description stored in a file.
typedef struct description {
  olx_field_info info;
  double origin[3]; // metres: positions in `info` are relative to it
  uint32_t version; // version of the format
} description;

static int print_info_json(const description *d) {
  const olx_field_info *info = &d->info;
  cJSON *object = cJSON_CreateObject();
  add_number(object, "version", d->version);
  add_number(object, "probes", info->probes.count);
  cJSON_AddBoolToObject(object, "probe_light", info->irradiance.probe_count > 0);
  add_number(object, "irradiance_probes", info->irradiance.probe_count);
  add_number(object, "buried", info->probes.buried);
  add_number(object, "irradiance_buried", info->irradiance.buried);
  add_number(object, "radiance_size", info->maps.size);
  add_number(object, "irradiance_size", info->irradiance.size);
  cJSON_AddBoolToObject(object, "compressed", info->maps.compressed);
  cJSON_AddBoolToObject(object, "geometry_blocks", info->maps.geometry_blocks);
  add_number(object, "volume_probes", info->volume.probe_count);
  if (info->irradiance.probe_count) add_text(object, "irradiance", olx_irradiance_form_name(info->irradiance.form));
  if (info->classic.size) {
    cJSON *classic = cJSON_AddObjectToObject(object, "classic");
    add_number(classic, "size", info->classic.size);
    add_number(classic, "cube_size", info->classic.cube_size);
    add_float(classic, "sharpness", info->classic.sharpness);
  }
  if (info->relight.surfels) {
    cJSON *relight = cJSON_AddObjectToObject(object, "relight");
    add_number(relight, "surfels", info->relight.surfels);
    add_number(relight, "links", info->relight.links);
  }
  add_text(object, "select", select_names(info->select_mask).text);
  add_number(object, "file_bytes", (double)info->bytes.file);
  block blocks[BLOCK_COUNT];
  list_blocks(info, blocks);
  cJSON *bytes = cJSON_AddObjectToObject(object, "bytes");
  for (int i = 0; i < BLOCK_COUNT; ++i) add_number(bytes, blocks[i].name, (double)blocks[i].bytes);
  cJSON_AddItemToObject(object, "origin", cJSON_CreateDoubleArray(d->origin, 3));
  if (info->probes.has_grid) add_grid(object, "grid", &info->probes.grid);
  if (info->irradiance.probe_count) add_grid(object, "irradiance_grid", &info->irradiance.grid);
  add_number(object, "lights", info->scene.light_count);
  add_number(object, "bounces", info->bounces.count);
  add_float(object, "last_bounce", info->bounces.last);
  add_number(object, "samples", info->maps.samples);
  add_float(object, "distance_scale_metres", info->maps.distance_scale_metres);
  add_vec3(object, "scene_min", info->scene.bounds_min);
  add_vec3(object, "scene_max", info->scene.bounds_max);
  add_hash(object, "scene_hash", info->scene.hash);
  return print_json("info", object);
}

static void print_grid(const char *label, const olx_grid *grid) {
  printf("  %-18s %ux%ux%u from (%g, %g, %g) every (%g, %g, %g) m\n", label, grid->count[0], grid->count[1],
         grid->count[2], (double)grid->origin.x, (double)grid->origin.y, (double)grid->origin.z,
         (double)grid->spacing.x, (double)grid->spacing.y, (double)grid->spacing.z);
}

static void print_info(const char *path, const description *d) {
  const olx_field_info *info = &d->info;
  const double *origin = d->origin;
  printf("%s: %s\n", path, text_of_bytes(info->bytes.file).text);
  printf("  format version     %u%s\n", d->version,
         d->version == CURRENT_VERSION ? "" : ", of another version of this program: bake the scene again to use it");
  printf("  light field probes %u, %u of them inside geometry, %ux%u texels\n", info->probes.count, info->probes.buried,
         info->maps.size, info->maps.size);
  if (info->irradiance.probe_count) {
    printf("  irradiance probes  %u, %u of them inside geometry, %ux%u texels\n", info->irradiance.probe_count,
           info->irradiance.buried, info->irradiance.size, info->irradiance.size);
  } else {
    printf("  probe light        none: no --hits stored and no --diffuse irradiance (bake --probe-light stores it)\n");
  }
  if (info->irradiance.form != OLX_IRRADIANCE_OCTAHEDRAL) {
    printf("  irradiance as      %s, maps of moments alone\n", olx_irradiance_form_name(info->irradiance.form));
  }
  if (info->volume.probe_count) printf("  irradiance volume  %u probes\n", info->volume.probe_count);
  if (info->classic.size) {
    printf("  classic maps       at irradiance probes, %ux%u texels from cube maps of %u, sharpness %g\n",
           info->classic.size, info->classic.size, info->classic.cube_size, (double)info->classic.sharpness);
  }
  if (info->relight.surfels) {
    printf("  relighting         %u surfels, %u links\n", info->relight.surfels, info->relight.links);
  }
  if (origin[0] != 0.0 || origin[1] != 0.0 || origin[2] != 0.0) {
    printf("  relative to        (%.10g, %.10g, %.10g) m, as are all positions below\n", origin[0], origin[1],
           origin[2]);
  }
  if (info->probes.has_grid) print_grid("grid", &info->probes.grid);
  if (info->irradiance.probe_count) print_grid("irradiance grid", &info->irradiance.grid);
  printf("  selector           %s\n", select_names(info->select_mask).text);
  printf("  light              direct and %u further bounces, %ux%u samples a texel\n", info->bounces.count,
         info->maps.samples, info->maps.samples);
  if (d->version == CURRENT_VERSION) {
    printf("  lights             %u without area\n", info->scene.light_count);
    printf("  geometry           %s\n", info->maps.geometry_blocks ? "in blocks of 4x4 texels" : "as texels");
    printf("  light, material    %s\n", info->maps.compressed ? "in tiles of 8x8 texels" : "as texels, uncompressed");
  }
  printf("  scene              %016" PRIx64 "\n", info->scene.hash);
  if (d->version != CURRENT_VERSION) return; // chunks of other versions are not read
  block blocks[BLOCK_COUNT];
  const double texels = (double)info->probes.count * info->maps.size * info->maps.size;
  list_blocks(info, blocks);
  printf("\n  its bytes, and bytes a texel\n");
  for (int i = 0; i < BLOCK_COUNT; ++i) {
    if (blocks[i].bytes == 0) continue;
    printf("  %-18s %10s  %5.2f\n", blocks[i].name, text_of_bytes(blocks[i].bytes).text,
           (double)blocks[i].bytes / texels);
  }
  printf("  %-18s %10s  %5.2f\n", "all", text_of_bytes(info->bytes.file).text, (double)info->bytes.file / texels);
}

static int print_packed_json(const olx_packed_info *info) {
  cJSON *object = cJSON_CreateObject();
  cJSON_AddBoolToObject(object, "packed", true);
  add_number(object, "file_bytes", (double)info->packed_bytes);
  add_number(object, "field_bytes", (double)info->field_bytes);
  cJSON *chunks = cJSON_AddArrayToObject(object, "chunks");
  for (uint32_t i = 0; i < info->chunk_count; ++i) {
    cJSON *chunk = cJSON_CreateObject();
    add_text(chunk, "type", info->chunks[i].type);
    add_number(chunk, "field_bytes", (double)info->chunks[i].field_bytes);
    add_number(chunk, "packed_bytes", (double)info->chunks[i].packed_bytes);
    cJSON_AddItemToArray(chunks, chunk);
  }
  return print_json("info", object);
}

static int print_packed(const char *path, bool json) {
  olx_packed_info info;
  if (olx_packed_describe(path, &info) != OLX_OK) return library_failure("info");
  if (json) return print_packed_json(&info);
  printf("%s: a packed field, %s; `octalux unpack %s` makes the field of %s that can be used\n", path,
         text_of_bytes(info.packed_bytes).text, path, text_of_bytes(info.field_bytes).text);
  for (uint32_t i = 0; i < info.chunk_count; ++i) {
    const olx_packed_chunk *chunk = &info.chunks[i];
    printf("  %-4s  %12s of %12s\n", chunk->type, text_of_bytes(chunk->packed_bytes).text,
           text_of_bytes(chunk->field_bytes).text);
  }
  return EXIT_DONE;
}

static olx_result describe(const char *path, description *d) {
  olx_field *field = NULL;
  olx_result result = olx_field_open(path, &field);
  if (result == OLX_ERROR_VERSION && olx_field_describe_version_1(path, &d->info) != OLX_ERROR_VERSION) {
    d->version = 1;
    return olx_field_describe_version_1(path, &d->info);
  }
  if (result == OLX_ERROR_VERSION) result = olx_field_open(path, &field); // to get its message
  if (result == OLX_OK) {
    d->info = olx_field_describe(field);
    olx_field_origin(field, d->origin);
  }
  olx_field_close(field);
  return result;
}

int command_info(int argc, char **argv) {
  bool json = false;
  command_line line = {.name = "info",
                       .summary = "What is in a field: probes, sizes, where its bytes go, how it was baked.",
                       .example = "octalux info room.olx",
                       .arguments = {"FIELD"},
                       .tables = {{json_option, &json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (olx_is_packed_field(line.given[0])) return print_packed(line.given[0], json);
  description d = {.version = CURRENT_VERSION};
  if (describe(line.given[0], &d) != OLX_OK) return library_failure("info");
  if (json) return print_info_json(&d);
  print_info(line.given[0], &d);
  return EXIT_DONE;
}

// Verifies a packed field by unpacking it without writing anything.
static olx_result verify_packed(const char *path, uint64_t *bytes) {
  const olx_unpack_settings settings = {.most_bytes = UINT64_MAX};
  olx_packed_info info;
  const olx_result result = olx_field_unpack(path, &settings, NULL, NULL, &info);
  if (result == OLX_OK) *bytes = info.packed_bytes;
  return result;
}

static olx_result verify(const char *path, uint64_t *bytes) {
  if (olx_is_packed_field(path)) return verify_packed(path, bytes);
  olx_field *field = NULL;
  olx_result result = olx_field_open(path, &field);
  if (result != OLX_OK) return result;
  *bytes = olx_field_describe(field).bytes.file;
  result = olx_field_verify(field);
  olx_field_close(field);
  return result;
}

int command_verify(int argc, char **argv) {
  bool json = false;
  command_line line = {.name = "verify",
                       .summary = "Read every byte of a field: structure, checksums, and, unless it is packed, values "
                                  "that cannot be.",
                       .example = "octalux verify room.olx",
                       .arguments = {"FIELD"},
                       .tables = {{json_option, &json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  uint64_t bytes = 0;
  if (verify(line.given[0], &bytes) != OLX_OK) return library_failure("verify");
  if (!json) {
    const char *found = olx_is_packed_field(line.given[0]) ? "packed soundly, " : "sound, ";
    printf("%s: %s%s\n", line.given[0], found, text_of_bytes(bytes).text);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  cJSON_AddBoolToObject(object, "sound", true);
  add_number(object, "file_bytes", (double)bytes);
  return print_json("verify", object);
}
