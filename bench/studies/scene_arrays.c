// Writes a scene as plain arrays and one JSON file, so that another renderer can be given exactly what Octalux renders.
// bench/cycles.py hands them to Blender.
#include "options.h"
#include "studies.h"

#include <octalux/scene.h>

#include <float.h>
#include <stdbool.h>
#include <stdio.h>

static const char NAME[] = BENCH_PROGRAM " scene-arrays";

static FILE *open_in(const char *folder, const char *name) {
  char path[4096];
  if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return NULL;
  FILE *file = fopen(path, "wb");
  if (!file) failure(NAME, "%s: cannot be written", path);
  return file;
}

static bool write_array(const char *folder, const char *name, const void *data, size_t element_bytes, size_t count) {
  FILE *file = open_in(folder, name);
  if (!file) return false;
  const bool written = count == 0 || fwrite(data, element_bytes, count, file) == count;
  const bool closed = fclose(file) == 0;
  if (!written || !closed) failure(NAME, "%s/%s: cannot be written", folder, name);
  return written && closed;
}

static bool write_arrays(const char *folder, const olx_scene_content *c) {
  if (c->colors || c->second_uvs || c->tangents) {
    fputs("octalux-bench scene-arrays: colours, second texture coordinates and tangents of vertices are left out\n",
          stderr);
  }
  bool good = write_array(folder, "positions.f32", c->positions, sizeof *c->positions, c->vertex_count) &&
              write_array(folder, "normals.f32", c->normals, sizeof *c->normals, c->vertex_count) &&
              write_array(folder, "uvs.f32", c->uvs, sizeof *c->uvs, c->vertex_count) &&
              write_array(folder, "indices.u32", c->indices, 3 * sizeof(uint32_t), c->triangle_count) &&
              write_array(folder, "material_index.u32", c->material_index, sizeof(uint32_t), c->triangle_count);
  for (uint32_t i = 0; good && i < c->texture_count; i++) {
    char name[32];
    snprintf(name, sizeof name, "texture%u.u8", i);
    const olx_texture *t = &c->textures[i];
    good = write_array(folder, name, t->texels, 4, (size_t)t->width * t->height);
  }
  const olx_environment *e = c->environment;
  const size_t texels = e->texels ? (size_t)e->width * e->height : 0;
  return good && write_array(folder, "environment.f32", e->texels, 3 * sizeof(float), texels);
}

static void put_string(FILE *file, const char *key, const char *text) {
  fprintf(file, "\"%s\": \"", key);
  for (const char *at = text; *at; at++) {
    const unsigned char byte = (unsigned char)*at;
    if (byte < 0x20) fprintf(file, "\\u%04x", byte);
    else fprintf(file, byte == '"' || byte == '\\' ? "\\%c" : "%c", byte);
  }
  fputc('"', file);
}

static void put_float(FILE *file, const char *key, float value) {
  fprintf(file, ", \"%s\": %.*g", key, FLT_DECIMAL_DIG, (double)value);
}

static void put_vec3(FILE *file, const char *key, olx_vec3 v) {
  fprintf(file, ", \"%s\": [%.*g, %.*g, %.*g]", key, FLT_DECIMAL_DIG, (double)v.x, FLT_DECIMAL_DIG, (double)v.y,
          FLT_DECIMAL_DIG, (double)v.z);
}

static void put_texture(FILE *file, const char *key, uint32_t texture) {
  if (texture != OLX_NO_TEXTURE) fprintf(file, ", \"%s\": %u", key, texture);
}

static void put_bool(FILE *file, const char *key, bool value) {
  fprintf(file, ", \"%s\": %s", key, value ? "true" : "false");
}

static void put_material(FILE *file, const olx_material *m) {
  put_string(file, "name", m->name);
  put_vec3(file, "base_color", m->base_color);
  put_float(file, "metallic", m->metallic);
  put_float(file, "roughness", m->roughness);
  put_float(file, "specular_weight", m->specular_weight);
  put_vec3(file, "emission", m->emission);
  put_float(file, "alpha", m->alpha);
  put_float(file, "alpha_cutoff", m->alpha_cutoff);
  put_float(file, "normal_scale", m->normal_scale);
  put_texture(file, "base_color_texture", m->base_color_texture);
  put_texture(file, "alpha_texture", m->alpha_texture);
  put_texture(file, "metallic_roughness_texture", m->metallic_roughness_texture);
  put_texture(file, "emission_texture", m->emission_texture);
  put_texture(file, "normal_texture", m->normal_texture);
  put_bool(file, "blended", m->blended);
  put_bool(file, "emits_both_sides", m->emits_both_sides);
  put_bool(file, "normal_is_height", m->normal_is_height);
  put_bool(file, "rectangle_light", m->rectangle_light);
}

static void put_light(FILE *file, const olx_light *light) {
  static const char *const types[] = {"sun", "point", "spot"};
  put_string(file, "type", types[light->type]);
  put_vec3(file, "position", light->position);
  put_vec3(file, "direction", light->direction);
  put_vec3(file, "emission", light->emission);
  put_float(file, "cosine_inner", light->cosine_inner);
  put_float(file, "cosine_outer", light->cosine_outer);
}

static bool write_description(const char *folder, const olx_scene_content *c, const olx_camera *camera) {
  FILE *file = open_in(folder, "scene.json");
  if (!file) return false;
  fputs("{\"camera\": {", file);
  put_string(file, "name", camera->name);
  put_vec3(file, "eye", camera->eye);
  put_vec3(file, "target", camera->target);
  put_vec3(file, "up", camera->up);
  put_float(file, "fov_y_degrees", camera->fov_y_degrees);
  fputs("},\n\"materials\": [", file);
  for (uint32_t i = 0; i < c->material_count; i++) {
    fputs(i ? ",\n{" : "\n{", file);
    put_material(file, &c->materials[i]);
    fputc('}', file);
  }
  fputs("],\n\"textures\": [", file);
  for (uint32_t i = 0; i < c->texture_count; i++) {
    const olx_texture *t = &c->textures[i];
    fprintf(file, "%s\n{\"width\": %u, \"height\": %u, \"srgb\": %s}", i ? "," : "", t->width, t->height,
            t->srgb ? "true" : "false");
  }
  fputs("],\n\"lights\": [", file);
  for (uint32_t i = 0; i < c->light_count; i++) {
    fputs(i ? ",\n{" : "\n{", file);
    put_light(file, &c->lights[i]);
    fputc('}', file);
  }
  const olx_environment *e = c->environment;
  fprintf(file, "],\n\"environment\": {\"width\": %u, \"height\": %u", e->texels ? e->width : 0,
          e->texels ? e->height : 0);
  put_vec3(file, "radiance", e->radiance);
  put_float(file, "rotation_radians", e->rotation_radians);
  fputs("}}\n", file);
  const bool written = !ferror(file), closed = fclose(file) == 0;
  if (!written || !closed) failure(NAME, "%s/scene.json: cannot be written", folder);
  return written && closed;
}

int study_scene_arrays(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_camera camera;
  if (olx_scene_load(argv[1], &scene) != OLX_OK ||
      olx_scene_find_camera(scene, argc > 3 ? argv[3] : NULL, &camera) != OLX_OK) {
    olx_scene_free(scene);
    return library_failure(NAME);
  }
  const olx_scene_content content = olx_scene_get_content(scene);
  const bool good = write_arrays(argv[2], &content) && write_description(argv[2], &content, &camera);
  olx_scene_free(scene);
  return good ? 0 : 1;
}
