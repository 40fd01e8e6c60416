// Loads COUNT mutated cooked scenes: fuzz_cooked COUNT [SEED]. Each must become a scene whose numbers are valid, or be
// refused with a message, and leave no memory behind. Most files have right checksums, so that the checks behind them
// are reached. Files depend on (seed, round) alone.
#include "cooked_scenes.h"
#include "core/sampling.h"
#include "counted_memory.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct random_stream {
  uint32_t seed, round, drawn;
} random_stream;

static uint32_t draw(random_stream *r, uint32_t below) {
  const uint32_t bits = olx_hash3(r->seed, r->round, r->drawn++);
  return below ? (uint32_t)(((uint64_t)bits * below) >> 32) : 0;
}

static uint32_t extreme_number(random_stream *r) {
  static const uint32_t numbers[] = {0,          1,          2,          3,          0x7F800000, 0x7FC00000, 0xFF800000,
                                     0x80000000, 0x7FFFFFFF, 0xFFFFFFFF, 0x3F800000, 0xBF800000, 0x4E6E6B28, 0x00000001,
                                     16384,      16385,      65535,      0x7F7FFFFF, 1024,       0x55555555};
  return draw(r, 4) ? numbers[draw(r, sizeof numbers / sizeof *numbers)] : draw(r, 0) ^ olx_hash(r->drawn);
}

// Damages one place of a chunk, most often a 32-bit number, since nearly all of the format consists of them.
static void spoil_chunk(random_stream *r, cooked_bytes file) {
  const cooked_bytes chunk = cooked_bytes_chunk(file, draw(r, OLX_COOKED_CHUNKS));
  if (chunk.size_bytes < 4) return;
  if (draw(r, 4) == 0) {
    chunk.bytes[draw(r, (uint32_t)chunk.size_bytes)] ^= (uint8_t)(1u << draw(r, 8));
    return;
  }
  const uint32_t number = extreme_number(r);
  memcpy(chunk.bytes + 4 * (size_t)draw(r, (uint32_t)chunk.size_bytes / 4), &number, 4);
}

static void spoil_frame(random_stream *r, cooked_bytes *file) {
  const uint32_t kind = draw(r, 3), number = extreme_number(r);
  const uint32_t frame_bytes = sizeof(olx_file_header) + OLX_COOKED_CHUNKS * sizeof(olx_file_chunk);
  if (kind == 0) file->size_bytes = draw(r, (uint32_t)file->size_bytes);
  else if (kind == 1) memcpy(file->bytes + 8 + 4 * draw(r, frame_bytes / 4 - 3), &number, 4);
  else file->bytes[draw(r, frame_bytes)] ^= (uint8_t)(1u << draw(r, 8));
}

static void make_mutant(uint32_t seed, uint32_t round, const cooked_bytes *original, cooked_bytes *mutant) {
  random_stream r = {.seed = seed, .round = round};
  memcpy(mutant->bytes, original->bytes, original->size_bytes);
  mutant->size_bytes = original->size_bytes;
  for (uint32_t count = 1 + draw(&r, 3); count > 0; --count) {
    if (draw(&r, 6) == 0) spoil_frame(&r, mutant);
    else spoil_chunk(&r, *mutant);
  }
  if (draw(&r, 16)) cooked_bytes_seal(*mutant);
}

static void demand(bool holds, const char *what, uint32_t round) {
  if (holds) return;
  fprintf(stderr, "round %u: broken promise: %s\n", round, what);
  abort();
}

// Casts rays over the whole scene, which read every part of it: corners, materials, texels, lights.
static void use_scene(const olx_scene *scene, uint32_t round) {
  const olx_vec3 center = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  demand(olx_finite(scene->bounds_min) && olx_finite(scene->bounds_max), "bounds", round);
  for (uint32_t t = 0; t < scene->triangle_count; ++t) {
    const olx_ray_hit hit = {.triangle = t, .t = 1.0f, .u = 0.3f, .v = 0.3f};
    const olx_surface surface = olx_surface_at(scene, &hit, olx_v3(0.0f, -1.0f, 0.0f));
    demand(olx_finite(surface.bsdf.albedo) && olx_max3(surface.bsdf.albedo) <= 0.95f, "albedo", round);
    demand(olx_finite(surface.shading_normal) && olx_finite(surface.geometric_normal), "normals", round);
  }
  for (uint32_t i = 0; i < 16; ++i) {
    const olx_ray ray = {.origin = center, .direction = olx_sample_sphere(olx_hammersley(i, 16)), .t_max = INFINITY};
    (void)olx_bvh_intersect(scene->bvh, &ray);
  }
  for (uint32_t i = 0; i < scene->camera_count; ++i) (void)olx_scene_camera(scene, i);
}

int main(int argc, char **argv) {
  const uint32_t count = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 2000;
  const uint32_t seed = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
  scene_folder folder;
  olx_scene *scene;
  char path[400];
  counted_memory_begin();
  if (!scene_folder_create(&folder)) return 1;
  snprintf(path, sizeof path, "%s/scene.olxs", folder.path);
  if (olx_scene_load(cooked_scenes_everything(&folder), &scene) != OLX_OK) return 1;
  if (olx_scene_cook(scene, path, NULL) != OLX_OK) return 1;
  olx_scene_free(scene);
  cooked_bytes original = cooked_bytes_read(path), mutant = cooked_bytes_read(path);
  uint32_t loaded = 0;
  for (uint32_t round = 0; round < count; ++round) {
    make_mutant(seed, round, &original, &mutant);
    const char *file = scene_folder_write(&folder, "mutant.olxs", mutant.bytes, mutant.size_bytes);
    const olx_result result = olx_scene_load(file, &scene);
    if (result == OLX_OK) {
      use_scene(scene, round);
      ++loaded;
    } else {
      demand(scene == NULL && strstr(olx_last_error(), "mutant.olxs"), "a refusal without a message", round);
    }
    olx_scene_free(scene);
    demand(counted_memory_held() == 0, "memory that was not released", round);
  }
  cooked_bytes_free(&original);
  cooked_bytes_free(&mutant);
  scene_folder_remove(&folder);
  printf("fuzz_cooked: %u files, seed %u: %u loaded, %u refused, 0 failures\n", count, seed, loaded, count - loaded);
  return 0;
}
