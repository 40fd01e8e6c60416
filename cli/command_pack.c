// octalux pack and octalux unpack: compress a field for distribution, and restore the same field.
#include "commands.h"
#include "files.h"
#include "options.h"
#include "report.h"

#include <octalux/export.h>

#include <limits.h>
#include <stdio.h>
#include <string.h>

#define MILLION 1000000u

// The part that both commands share: a file is converted to another, whose name is derived from the first unless it is
// given.
typedef struct packing {
  const char *name, *from, *to; // name of the command, and the endings of its files
  const char *input, *output;
  char named[PATH_MAX]; // buffer for the derived name
  olx_pack_settings pack;
  olx_unpack_settings unpack;
  uint32_t most_mb; // 0: the default
  bool json;
} packing;

// Derives the output's name: "scene.olx" packs to "scene.olxz", and back.
static int name_output(packing *p) {
  if (p->output) {
    return ends_with(p->output, p->to) ? EXIT_DONE
                                       : usage_error(p->name, "-o: '%s' does not end in %s", p->output, p->to);
  }
  if (!ends_with(p->input, p->from)) {
    return usage_error(p->name, "'%s' does not end in %s: say with -o what to write", p->input, p->from);
  }
  const int stem = (int)(strlen(p->input) - strlen(p->from));
  if (snprintf(p->named, sizeof p->named, "%.*s%s", stem, p->input, p->to) >= (int)sizeof p->named) {
    return usage_error(p->name, "'%s' is too long a name", p->input);
  }
  p->output = p->named;
  return EXIT_DONE;
}

static int check_packing(packing *p) {
  const int code = name_output(p);
  if (code != EXIT_DONE) return code;
  const command_files files = {.inputs = {p->input}, .outputs = {{p->output, false}}};
  return check_files(p->name, &files, p->json);
}

static int report_packing(const packing *p, const olx_packed_info *info) {
  if (!p->json) {
    printf("%s: a field of %s, packed %s (%.1f %%)\n", p->output, text_of_bytes(info->field_bytes).text,
           text_of_bytes(info->packed_bytes).text, 100.0 * (double)info->packed_bytes / (double)info->field_bytes);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_text(object, "output", p->output);
  add_number(object, "field_bytes", (double)info->field_bytes);
  add_number(object, "packed_bytes", (double)info->packed_bytes);
  return print_json(p->name, object);
}

static int end_packing(const packing *p, progress_line *line, olx_result result, const olx_packed_info *info) {
  progress_end(line);
  if (result == OLX_ERROR_CANCELLED) return failure(p->name, "%s: interrupted, nothing written", p->output);
  return result == OLX_OK ? report_packing(p, info) : library_failure(p->name);
}

static const option pack_options[] = {
    {"-o", OPTION_TEXT, offsetof(packing, output), "FILE.olxz", "the packed field; default: beside the field"},
    {"--level", OPTION_COUNT, offsetof(packing, pack.level), "N", "of zstd: 1 is fast, 22 small; default 19", 1, 22},
    {"--threads", OPTION_COUNT, offsetof(packing, pack.threads), "N",
     "default 0: every processor; the result is the same", 0, 1024},
    {0}};

int command_pack(int argc, char **argv) {
  packing p = {.name = "pack", .from = ".olx", .to = ".olxz", .pack = olx_pack_settings_default()};
  command_line line = {.name = "pack",
                       .summary =
                           "Store a field smaller, for shipping. `octalux unpack` makes the same bytes of it again.",
                       .example = "octalux pack room.olx",
                       .arguments = {"FIELD"},
                       .tables = {{pack_options, &p}, {json_option, &p.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  p.input = line.given[0];
  code = check_packing(&p);
  if (code != EXIT_DONE) return code;
  olx_packed_info info;
  progress_line shown;
  progress_begin(&shown, p.name, false);
  const olx_progress progress = progress_of(&shown);
  return end_packing(&p, &shown, olx_field_pack(p.input, &p.pack, p.output, &progress, &info), &info);
}

static const option unpack_options[] = {
    {"-o", OPTION_TEXT, offsetof(packing, output), "FILE.olx", "the field; default: beside the packed one"},
    {"--most", OPTION_COUNT, offsetof(packing, most_mb), "MB",
     "refuse a field larger than this, in 10^6 bytes; default 34359", 1, UINT32_MAX},
    {"--threads", OPTION_COUNT, offsetof(packing, unpack.threads), "N", "default 0: every processor", 0, 1024},
    {0}};

int command_unpack(int argc, char **argv) {
  packing p = {.name = "unpack", .from = ".olxz", .to = ".olx", .unpack = olx_unpack_settings_default()};
  command_line line = {.name = "unpack",
                       .summary = "Make a field of a packed one again, to the last byte.",
                       .example = "octalux unpack room.olxz",
                       .arguments = {"PACKED"},
                       .tables = {{unpack_options, &p}, {json_option, &p.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  p.input = line.given[0];
  code = check_packing(&p);
  if (code != EXIT_DONE) return code;
  if (p.most_mb) p.unpack.most_bytes = (uint64_t)p.most_mb * MILLION;
  olx_packed_info info;
  progress_line shown;
  progress_begin(&shown, p.name, false);
  const olx_progress progress = progress_of(&shown);
  return end_packing(&p, &shown, olx_field_unpack(p.input, &p.unpack, p.output, &progress, &info), &info);
}
