// Collects the textures that a model refers to, decodes each once and all in parallel, and first checks their texels
// against the scene's limit.
#include "scene/import/texture_table.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "scene/import/import_limits.h"
#include "scene/scene_build.h"
#include "scene/sources.h"

#include <stdio.h>
#include <string.h>

static olx_result make_room(olx_texture_table *table) {
  if (table->count < table->capacity) return OLX_OK;
  const uint32_t capacity = table->capacity ? table->capacity * 2 : 32;
  olx_texture_request *grown = olx_allocate(capacity, sizeof *grown);
  if (!grown) return olx_fail(OLX_ERROR_MEMORY, "out of memory for textures");
  if (table->count) memcpy(grown, table->requests, table->count * sizeof *grown);
  olx_release(table->requests);
  table->requests = grown;
  table->capacity = capacity;
  return OLX_OK;
}

olx_result olx_texture_table_request(olx_texture_table *table, const char *path, const void *data, size_t size_bytes,
                                     olx_texture_use use, uint32_t *number) {
  for (uint32_t i = olx_name_index_find(&table->paths, path, OLX_NO_ELEMENT); i != OLX_NO_ELEMENT;
       i = olx_name_index_find(&table->paths, path, i)) {
    const olx_texture_request *known = &table->requests[i];
    if (known->use == use && known->data == data && strcmp(known->path, path) == 0) {
      *number = i;
      return OLX_OK;
    }
  }
  OLX_TRY(make_room(table));
  olx_texture_request request = {
      .data = data, .size_bytes = size_bytes, .use = use, .scene_index = OLX_NO_TEXTURE, .path = olx_copy_string(path)};
  if (!request.path) return olx_fail(OLX_ERROR_MEMORY, "out of memory for textures");
  const olx_result result = olx_name_index_add(&table->paths, path);
  if (result != OLX_OK) {
    olx_release(request.path);
    return result;
  }
  *number = table->count;
  table->requests[table->count++] = request;
  return OLX_OK;
}

olx_result olx_texture_table_leave_out(olx_texture_table *table, const char *label, const char *why) {
  static const char nothing[] = "";
  uint32_t number;
  OLX_TRY(olx_texture_table_request(table, label, nothing, 0, OLX_TEXTURE_COLOR, &number));
  olx_texture_request *request = &table->requests[number];
  snprintf(request->error, sizeof request->error, "%.200s: %s", label, why);
  return OLX_OK;
}

static void load_one(void *user, uint32_t index) {
  olx_texture_request *request = &((olx_texture_table *)user)->requests[index];
  if (request->error[0]) return;
  if (olx_texture_load(request->path, request->data, request->size_bytes, request->use, &request->texture) != OLX_OK) {
    // The last error is local to the thread that runs this job.
    snprintf(request->error, sizeof request->error, "%s", olx_last_error());
  }
}

// Checks the total of texels. Images whose header cannot be read are reported when they are decoded.
static olx_result check_texels(const olx_texture_table *table, const olx_scene *scene) {
  uint64_t texels = olx_scene_texels(scene);
  for (uint32_t i = 0; i < table->count; ++i) {
    const olx_texture_request *request = &table->requests[i];
    uint64_t own = 0;
    if (olx_texture_measure(request->path, request->data, request->size_bytes, &own) != OLX_OK) continue;
    texels += own;
    char element[64];
    snprintf(element, sizeof element, "image of %llu texels", (unsigned long long)own);
    OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TEXELS, texels, request->path, element));
  }
  return OLX_OK;
}

olx_result olx_texture_table_decode(olx_texture_table *table, const char *model_path, olx_scene *scene) {
  OLX_TRY(check_texels(table, scene));
  OLX_TRY(olx_parallel_for(table->count, 0, load_one, table, NULL, 0));
  uint32_t missing = 0;
  for (uint32_t i = 0; i < table->count; ++i) {
    const olx_texture_request *request = &table->requests[i];
    if (!request->data) OLX_TRY(olx_scene_note_source(scene, request->path));
    if (request->error[0] && ++missing <= OLX_MOST_WARNINGS_OF_A_KIND) {
      olx_scene_warn(scene, "%s: texture left out: %s", model_path, request->error);
    }
  }
  if (missing > OLX_MOST_WARNINGS_OF_A_KIND) {
    olx_scene_warn(scene, "%s: %u more textures left out", model_path, missing - OLX_MOST_WARNINGS_OF_A_KIND);
  }
  return OLX_OK;
}

olx_result olx_texture_table_load(olx_texture_table *table, const char *model_path, olx_scene *scene) {
  OLX_TRY(olx_texture_table_decode(table, model_path, scene));
  for (uint32_t i = 0; i < table->count; ++i) {
    olx_texture_request *request = &table->requests[i];
    const olx_texture texture = request->texture;
    if (request->error[0]) continue;
    request->texture.texels = NULL;
    OLX_TRY(olx_scene_add_texture(scene, &texture, &request->scene_index));
  }
  return OLX_OK;
}

uint32_t olx_texture_table_resolve(const olx_texture_table *table, uint32_t number) {
  return number == OLX_NO_TEXTURE ? OLX_NO_TEXTURE : table->requests[number].scene_index;
}

void olx_texture_table_free(olx_texture_table *table) {
  for (uint32_t i = 0; i < table->count; ++i) {
    olx_release(table->requests[i].path);
    olx_release(table->requests[i].texture.texels);
  }
  olx_release(table->requests);
  olx_name_index_free(&table->paths);
  *table = (olx_texture_table){0};
}
