// Makes the seeds of coverage-guided fuzzing: make_seeds FOLDER fills FOLDER/TARGET with small valid files of all
// kinds.
#include "cooked_scenes.h"
#include "counted_memory.h"
#include "kept_work.h"
#include "scene_seeds.h"
#include "synthetic_field.h"

#include <octalux/export.h>
#include <octalux/place.h>
#include <octalux/render.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <webp/encode.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

static const char *root;

static void demand(bool holds, const char *what) {
  if (holds) return;
  fprintf(stderr, "make_seeds: %s: %s\n", what, olx_last_error());
  exit(1);
}

// Returns the path of a file in a target's folder, valid until the next call.
static const char *path_of(const char *target, const char *name) {
  static char path[600];
  snprintf(path, sizeof path, "%s/%s", root, target);
  mkdir(path, 0777);
  snprintf(path, sizeof path, "%s/%s/%s", root, target, name);
  return path;
}

static void write_seed(const char *target, const char *name, const void *data, size_t size_bytes) {
  demand(olx_write_file(path_of(target, name), data, size_bytes) == OLX_OK, name);
}

static void make_fields(void) {
  static const synthetic_shape shapes[] = {
      {.grid = {1, 1, 1}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8},
      {.grid = {2, 1, 1},
       .n = 8,
       .select_mask = 1u << OLX_SELECT_VORONOI | 1u << OLX_SELECT_OCTREE | 1u << OLX_SELECT_BRICKS},
      {.grid = {1, 1, 1}, .irradiance_grid = {2, 1, 1}, .n = 8, .irradiance_n = 8, .classic_size = 32},
      {.grid = {1, 1, 2}, .n = 8, .relight_surfels = 20},
      {.grid = {1, 1, 1},
       .irradiance_grid = {2, 1, 1},
       .n = 8,
       .irradiance_n = 8,
       .irradiance_form = OLX_IRRADIANCE_SH3},
      {.grid = {2, 1, 1}, .n = 16, .compressed = true, .origin = {1000.0, 0.0, 5.0}}};
  for (uint32_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
    char name[32], field[600];
    snprintf(name, sizeof name, "%u.olx", i);
    snprintf(field, sizeof field, "%s", path_of("field", name));
    demand(synthetic_write(field, &shapes[i], NULL) == OLX_OK, name);
    snprintf(name, sizeof name, "%u.olxz", i);
    demand(olx_field_pack(field, &(olx_pack_settings){.level = 3}, path_of("packed", name), NULL, NULL) == OLX_OK,
           name);
  }
}

// Writes each file of a work folder behind a byte with its number.
static void make_work(void) {
  scene_folder folder;
  kept_work work;
  demand(scene_folder_create(&folder), "a folder");
  demand(kept_work_bake(&folder) == OLX_OK && kept_work_read(&folder, &work), "a work folder");
  for (uint32_t i = 0; i < work.count; i++) {
    const kept_work_file *file = &work.files[i];
    uint8_t *seed = malloc(file->size_bytes + 1);
    demand(seed != NULL, "memory");
    seed[0] = (uint8_t)i;
    memcpy(seed + 1, file->bytes, file->size_bytes);
    write_seed("work", file->name, seed, file->size_bytes + 1);
    free(seed);
  }
  kept_work_free(&work);
  kept_work_remove(&folder);
  scene_folder_remove(&folder);
}

static void cook(const char *name, const char *source) {
  olx_scene *scene;
  demand(olx_scene_load(source, &scene) == OLX_OK, source);
  demand(olx_scene_cook(scene, path_of("cooked", name), NULL) == OLX_OK, name);
  olx_scene_free(scene);
}

static void make_cooked(void) {
  scene_folder folder;
  demand(scene_folder_create(&folder), "a folder");
  const char *everything = cooked_scenes_everything(&folder);
  cook("everything.olxs", everything);
  cook("square.olxs", scene_folder_write_text(&folder, "square.obj", scene_files_obj));
  FILE *file = fopen(everything, "rb");
  char text[8192];
  const size_t size_bytes = file ? fread(text, 1, sizeof text, file) : 0;
  demand(file && size_bytes > 0, "a description");
  fclose(file);
  write_seed("description", "everything.json", text, size_bytes);
  scene_folder_remove(&folder);
}

static const seed_file *find(const seed_file seeds[SEED_COUNT], const char *name) {
  while (strcmp(seeds->name, name) != 0) seeds++;
  return seeds;
}

// Writes a model, a byte of 0, and its materials into one seed.
static void make_obj(const seed_file seeds[SEED_COUNT]) {
  const seed_file *model = find(seeds, "square.obj"), *materials = find(seeds, "square.mtl");
  char both[8192];
  demand(model->size_bytes + materials->size_bytes < sizeof both, "a model");
  memcpy(both, model->bytes, model->size_bytes);
  both[model->size_bytes] = 0;
  memcpy(both + model->size_bytes + 1, materials->bytes, materials->size_bytes);
  write_seed("obj", "square.obj", both, model->size_bytes + 1 + materials->size_bytes);
  write_seed("obj", "alone.obj", model->bytes, model->size_bytes);
}

static void make_models(void) {
  seed_file seeds[SEED_COUNT];
  scene_seeds_make(seeds);
  for (uint32_t i = 0; i < SEED_COUNT; i++) {
    if (strstr(seeds[i].name, ".gl")) write_seed("gltf", seeds[i].name, seeds[i].bytes, seeds[i].size_bytes);
  }
  make_obj(seeds);
  const seed_file *description = find(seeds, "scene.json"), *sky = find(seeds, "sky.hdr"),
                  *four = find(seeds, "four.tga");
  write_seed("description", "scene.json", description->bytes, description->size_bytes);
  write_seed("description", "builtin.json", "{\"model\": \"builtin:cornell\"}", 28);
  write_seed("image", "sky.hdr", sky->bytes, sky->size_bytes);
  write_seed("image", "four.tga", four->bytes, four->size_bytes);
  scene_seeds_free(seeds);
}

static void make_pictures(void) {
  uint8_t texels[9 * 7 * 4];
  float light[9 * 7 * 3];
  for (uint32_t i = 0; i < sizeof texels; i++) texels[i] = (uint8_t)(i * 37 + i / 5);
  for (uint32_t i = 0; i < 9 * 7 * 3; i++) light[i] = (float)(i % 11) * 0.25f;
  stbi_write_png(path_of("image", "rgba.png"), 9, 7, 4, texels, 36);
  stbi_write_png(path_of("image", "grey.png"), 9, 7, 1, texels, 9);
  stbi_write_bmp(path_of("image", "rgb.bmp"), 9, 7, 3, texels);
  stbi_write_jpg(path_of("image", "rgb.jpg"), 9, 7, 3, texels, 90);
  stbi_write_jpg(path_of("image", "coarse.jpg"), 9, 7, 3, texels, 20);
  uint8_t *webp[2];
  const size_t webp_bytes[2] = {WebPEncodeLosslessRGBA(texels, 9, 7, 36, &webp[0]),
                                WebPEncodeRGBA(texels, 9, 7, 36, 60.0f, &webp[1])};
  for (int i = 0; i < 2; i++) {
    write_seed("image", i ? "lossy.webp" : "exact.webp", webp[i], webp_bytes[i]);
    WebPFree(webp[i]);
  }
  stbi_write_hdr(path_of("image", "light.hdr"), 9, 7, 3, light);
  olx_image image;
  demand(olx_image_create(9, 7, 3, &image) == OLX_OK, "an image");
  for (uint32_t i = 0; i < 9 * 7; i++)
    image.layers[0][i] = image.layers[1][i] = (olx_vec3){light[i], light[i + 1], 1.0f};
  demand(olx_image_save(&image, path_of("image", "layers.exr")) == OLX_OK, "an image");
  olx_image_free(&image);
}

static void make_probes(void) {
  static const char text[] = "{\"probes\": [{\"position\": [0, 1.5, -2e1]}, {\"position\": [1, 2, 3]}]}";
  olx_probe_set set;
  write_seed("probes", "short.json", text, sizeof text - 1);
  demand(olx_probe_set_load(path_of("probes", "short.json"), NULL, &set) == OLX_OK, "probes");
  demand(olx_probe_set_save(&set, path_of("probes", "saved.json")) == OLX_OK, "probes");
  olx_probe_set_free(&set);
}

int main(int argc, char **argv) {
  if (argc != 2) return fprintf(stderr, "usage: make_seeds FOLDER\n"), 2;
  counted_memory_begin(); // also discards warnings
  root = argv[1];
  mkdir(root, 0777);
  make_fields();
  make_cooked();
  make_work();
  make_models();
  make_pictures();
  make_probes();
  return 0;
}
