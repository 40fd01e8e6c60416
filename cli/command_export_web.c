// octalux export web: writes a folder for any static web server, with a room to walk through in a browser
// (docs/web.md).
#include "commands.h"
#include "files.h"
#include "options.h"
#include "report.h"
#include "scene_options.h"

#include <octalux/export.h>

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char COMMAND[] = "export web";

// The content of the page's folder.
typedef struct web_export {
  const char *scene, *field, *folder;
  char page[PATH_MAX]; // folder of the page's own files
  scene_options loading;
  bool json, no_glossy;
  uint64_t scene_bytes, field_bytes, page_bytes;
} web_export;

typedef struct web_path {
  char text[PATH_MAX + NAME_MAX + 2];
} web_path;

static web_path path_of(const char *folder, const char *name) {
  web_path path;
  snprintf(path.text, sizeof path.text, "%s/%s", folder, name);
  return path;
}

static bool is_file(const char *path) {
  struct stat status;
  return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

// Finds the page: beside the program in a build, in share/octalux/web when installed.
static int find_page(web_export *e) {
  static const char *const places[] = {"web", "../share/octalux/web"};
  char program[PATH_MAX] = "";
  const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
  if (length > 0) program[length] = 0;
  char *end = strrchr(program, '/');
  if (end) *end = 0;
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    if (snprintf(e->page, sizeof e->page, "%s/%s", program, places[i]) >= (int)sizeof e->page) continue;
    if (is_file(path_of(e->page, "index.html").text)) return EXIT_DONE;
  }
  return failure(
      COMMAND,
      "the page is missing beside this program (%s/web, %s/../share/octalux/web): building it needs "
      "node, npm, clang and lld, and a way to npm's registry for three.js; configure and build again with them",
      program, program);
}

// Checks that the field belongs to the scene, like render.
static int check_field(const web_export *e, const olx_field *field, const olx_scene *scene) {
  if (olx_field_describe(field).scene.hash == olx_scene_describe(scene).hash) return EXIT_DONE;
  return failure(COMMAND, "%s was baked from another scene than %s", e->field, e->scene);
}

static int make_folder(const char *folder) {
  if (mkdir(folder, 0777) == 0 || errno == EEXIST) return EXIT_DONE;
  return failure(COMMAND, "%s: cannot make the folder: %s", folder, strerror(errno));
}

// Copies a file of the page, which is small, unchanged.
static olx_result copy_file(const char *from, const char *to, uint64_t *bytes) {
  FILE *file = fopen(from, "rb");
  struct stat status;
  olx_result result = OLX_ERROR_FILE;
  char *data = NULL;
  if (file && fstat(fileno(file), &status) == 0) data = malloc((size_t)status.st_size + 1);
  if (data && fread(data, 1, (size_t)status.st_size, file) == (size_t)status.st_size) {
    result = olx_write_file(to, data, (size_t)status.st_size);
    *bytes += (uint64_t)status.st_size;
  }
  free(data);
  if (file) fclose(file);
  return result;
}

static int copy_page(web_export *e) {
  DIR *folder = opendir(e->page);
  if (!folder) return failure(COMMAND, "%s: %s", e->page, strerror(errno));
  int code = EXIT_DONE;
  for (const struct dirent *entry; code == EXIT_DONE && (entry = readdir(folder));) {
    const web_path from = path_of(e->page, entry->d_name), to = path_of(e->folder, entry->d_name);
    if (!is_file(from.text)) continue;
    if (copy_file(from.text, to.text, &e->page_bytes) != OLX_OK)
      code = failure(COMMAND, "%s: cannot copy it", from.text);
  }
  closedir(folder);
  return code;
}

static int write_folder(web_export *e, const olx_field *baked, const olx_scene *scene) {
  const web_path model = path_of(e->folder, "scene.glb.gz"), field = path_of(e->folder, "field.olx.gz");
  const command_files files = {.inputs = {e->field}, .outputs = {{model.text, false}, {field.text, false}}};
  int code = check_field(e, baked, scene);
  if (code == EXIT_DONE) code = make_folder(e->folder);
  if (code == EXIT_DONE) code = check_files(COMMAND, &files, e->json);
  if (code == EXIT_DONE) code = check_scene_files(COMMAND, &files, scene);
  if (code != EXIT_DONE) return code;
  if (olx_export_scene(scene, model.text, &e->scene_bytes) != OLX_OK) return library_failure(COMMAND);
  const olx_result result = e->no_glossy ? olx_export_diffuse_gzip(baked, field.text, &e->field_bytes)
                                         : olx_export_gzip(e->field, field.text, &e->field_bytes);
  return result == OLX_OK ? copy_page(e) : library_failure(COMMAND);
}

static int export_folder(web_export *e, const olx_scene *scene) {
  olx_field *field = NULL;
  if (olx_field_open(e->field, &field) != OLX_OK) return library_failure(COMMAND);
  const int code = write_folder(e, field, scene);
  olx_field_close(field);
  return code;
}

static int report_folder(const web_export *e) {
  if (!e->json) {
    printf("%s: scene %s, field %s, page %s; any static server shows it\n", e->folder,
           text_of_bytes(e->scene_bytes).text, text_of_bytes(e->field_bytes).text, text_of_bytes(e->page_bytes).text);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_text(object, "output", e->folder);
  add_number(object, "scene_bytes", (double)e->scene_bytes);
  add_number(object, "field_bytes", (double)e->field_bytes);
  add_number(object, "page_bytes", (double)e->page_bytes);
  return print_json(COMMAND, object);
}

static const option web_options[] = {
    {"--field", OPTION_TEXT, offsetof(web_export, field), "FILE.olx", "the field that gives indirect light", 1},
    {"-o", OPTION_TEXT, offsetof(web_export, folder), "DIR", "the folder to write, made where it is missing", 1},
    {"--no-glossy", OPTION_FLAG, offsetof(web_export, no_glossy), NULL,
     "diffuse light alone, with about a quarter less to load"},
    {0}};

int command_export_web(int argc, char **argv) {
  web_export e = {0};
  command_line line = {.name = COMMAND,
                       .summary = "Write a page to walk through a baked scene in a browser, for any static server.",
                       .example = "octalux export web room.gltf --field room.olx -o page",
                       .arguments = {"SCENE"},
                       .tables = {{web_options, &e}, {scene_loading_options, &e.loading}, {json_option, &e.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  e.scene = line.given[0];
  if (strcmp(e.folder, "-") == 0) return usage_error(COMMAND, "-o: a page is a folder, which '-' cannot be");
  code = find_page(&e);
  if (code != EXIT_DONE) return code;
  olx_scene *scene = NULL;
  code = load_scene(COMMAND, e.scene, &e.loading, &scene);
  if (code == EXIT_DONE) code = export_folder(&e, scene);
  olx_scene_free(scene);
  return code == EXIT_DONE ? report_folder(&e) : code;
}
