// Counts in one pass over an OBJ file what Assimp would create from it. Assimp triangulates a polygon in time quadratic
// in its corners, and creates a mesh or a node for every object, group and change of material.
#include "scene/obj/obj_check.h"

#include "core/file.h"
#include "core/result.h"
#include "scene/import/import_limits.h"
#include "scene/name_index.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct obj_checker {
  const char *path;
  olx_scene *scene;
  uint32_t missing; // number of missing material files
  uint64_t triangles, nodes;
  olx_name_index materials; // materials that faces use: Assimp creates one for every name that it does not know
  bool polygon;             // whether the line belongs to a polygon
  uint64_t corners;         // corners of that polygon so far
} obj_checker;

static void check_material_library(obj_checker *c, const char *name, size_t length) {
  char library[4096];
  const char *slash = strrchr(c->path, '/');
  const int folder = name[0] == '/' || !slash ? 0 : (int)(slash - c->path) + 1;
  snprintf(library, sizeof library, "%.*s%.*s", folder, c->path, (int)length, name);
  if (access(library, R_OK) == 0) return;
  if (++c->missing > OLX_MOST_WARNINGS_OF_A_KIND) return;
  olx_scene_warn(c->scene, "%s: material file %.*s not found", c->path, (int)length, name);
}

static void check_mtllib(obj_checker *c, const char *line, const char *stop) {
  if (stop - line <= 7 || memcmp(line, "mtllib", 6) != 0 || !isspace((unsigned char)line[6])) return;
  const char *name = line + 7;
  size_t length = (size_t)(stop - name);
  while (length && isspace((unsigned char)*name)) ++name, --length;
  while (length && isspace((unsigned char)name[length - 1])) --length;
  if (length > 0 && length < 1024) check_material_library(c, name, length);
}

static olx_result check_usemtl(obj_checker *c, const char *line, const char *stop, const char *element) {
  char name[1024];
  if (stop - line <= 7 || memcmp(line, "usemtl", 6) != 0) return OLX_OK;
  snprintf(name, sizeof name, "%.*s", (int)(stop - line - 7 < 1000 ? stop - line - 7 : 1000), line + 7);
  // Two names with the same hash are counted once, which no benign file will notice.
  if (olx_name_index_find(&c->materials, name, OLX_NO_ELEMENT) != OLX_NO_ELEMENT) return OLX_OK;
  OLX_TRY(olx_name_index_add(&c->materials, name));
  return olx_import_check_limit(c->scene, OLX_LIMIT_MATERIALS, c->scene->material_count + c->materials.count, c->path,
                                element);
}

// Counts runs of digits as corners, except those after a slash, which continue one.
static uint64_t count_corners(const char *text, const char *stop) {
  uint64_t corners = 0;
  char before = ' ', last = ' ';
  for (; text < stop; ++text) {
    const bool digit = *text >= '0' && *text <= '9', inside = last >= '0' && last <= '9';
    const bool continues = last == '/' || (last == '-' && before == '/');
    corners += digit && !inside && !continues;
    before = last;
    last = *text;
  }
  return corners;
}

static olx_result check_limits(const obj_checker *c, const char *element) {
  OLX_TRY(olx_import_check_limit(c->scene, OLX_LIMIT_POLYGON_CORNERS, c->corners, c->path, element));
  OLX_TRY(olx_import_check_limit(c->scene, OLX_LIMIT_NODES, c->nodes, c->path, element));
  return olx_import_check_limit(c->scene, OLX_LIMIT_TRIANGLES, c->scene->triangle_count + c->triangles, c->path,
                                element);
}

// Checks a line. `continued` says whether the previous line ends with a backslash or, as Assimp reads it, contains one.
static olx_result check_line(obj_checker *c, const char *line, const char *stop, bool continued, unsigned number) {
  if (!continued) c->polygon = false;
  if (line == stop) return OLX_OK;
  if (!c->polygon) c->corners = 0;
  c->polygon |= *line == 'f';
  if (c->polygon) {
    const uint64_t before = c->corners > 2 ? c->corners - 2 : 0;
    c->corners += count_corners(line, stop);
    c->triangles += (c->corners > 2 ? c->corners - 2 : 0) - before;
  }
  c->nodes += *line == 'o' || *line == 'g' || *line == 'u';
  check_mtllib(c, line, stop);
  if (!c->polygon && *line != 'o' && *line != 'g' && *line != 'u') return OLX_OK;
  char element[32];
  snprintf(element, sizeof element, "line %u", number);
  OLX_TRY(check_usemtl(c, line, stop, element));
  return check_limits(c, element);
}

static olx_result check_text(obj_checker *c, const char *text, size_t size_bytes) {
  const char *line = text, *const end = text + size_bytes;
  bool continued = false;
  for (unsigned number = 1; line < end; ++number) {
    const char *stop = memchr(line, '\n', (size_t)(end - line));
    if (!stop) stop = end;
    OLX_TRY(check_line(c, line, stop, continued, number));
    continued = memchr(line, '\\', (size_t)(stop - line)) != NULL;
    line = stop + 1;
  }
  return OLX_OK;
}

olx_result olx_obj_check(const char *path, olx_scene *scene) {
  olx_mapped_file file;
  obj_checker checker = {.path = path, .scene = scene};
  OLX_TRY(olx_map_file(path, &file));
  const olx_result result = check_text(&checker, file.data, file.size_bytes);
  olx_name_index_free(&checker.materials);
  olx_unmap_file(&file);
  return result;
}
