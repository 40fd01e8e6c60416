// Judges whether a picture shows the borders of probes' cages: seams SCENE FIELD.olx IMAGE.exr [CAMERA]. IMAGE is a
// picture of the scene from that camera (the first, unless named), its camera rays through pixel centres.
//
// Four pixels in a row or column, on one surface, whose middle lies on a border between two cages and whose ends lie in
// one each, give the gradient across the border and, as the mean of the outer two, the gradient beside it. Four pixels
// in one cage give the same for comparison. Diffuse light is taken before albedo, and in the irradiance probes' cages,
// glossy light in those of the light field probes. Prints one JSON object, with the number of values in the picture
// that are not finite.
#include "options.h"
#include "studies.h"

#include <octalux/render.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

static const char NAME[] = BENCH_PROGRAM " seams";

typedef struct picture {
  olx_image image;
  olx_vec3 eye, forward, right, up; // right and up: to the edges of the image plane at distance 1
} picture;

typedef struct gradients {
  double across, beside;
  uint64_t count;
} gradients;

static olx_vec3 along(olx_vec3 a, olx_vec3 b, float t) {
  return (olx_vec3){a.x + t * b.x, a.y + t * b.y, a.z + t * b.z};
}
static olx_vec3 minus(olx_vec3 a, olx_vec3 b) { return along(a, b, -1.0f); }
static float dot(olx_vec3 a, olx_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static olx_vec3 scaled(olx_vec3 a, float s) { return (olx_vec3){s * a.x, s * a.y, s * a.z}; }
static olx_vec3 unit(olx_vec3 a) { return scaled(a, 1.0f / sqrtf(dot(a, a))); }
static olx_vec3 cross(olx_vec3 a, olx_vec3 b) {
  return (olx_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static float luminance(olx_vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

static void look(picture *p, const olx_camera *camera) {
  const float half = tanf(camera->fov_y_degrees * 0.5f * 3.14159265f / 180.0f);
  p->eye = camera->eye;
  p->forward = unit(minus(camera->target, camera->eye));
  const olx_vec3 right = unit(cross(p->forward, camera->up));
  p->right = scaled(right, half * (float)p->image.width / (float)p->image.height);
  p->up = scaled(cross(right, p->forward), half);
}

static olx_vec3 position(const picture *p, uint32_t pixel) {
  const float x = (float)(pixel % p->image.width) + 0.5f, y = (float)(pixel / p->image.width) + 0.5f;
  olx_vec3 way = along(p->forward, p->right, 2.0f * x / (float)p->image.width - 1.0f);
  way = along(way, p->up, 1.0f - 2.0f * y / (float)p->image.height);
  return along(p->eye, way, p->image.layers[OLX_LAYER_DEPTH][pixel].x);
}

// Returns the number of the cage that a point lies in; points beyond the grid belong to its outermost cages.
static uint32_t cage_of(const olx_grid *grid, olx_vec3 at) {
  const float offset[3] = {at.x - grid->origin.x, at.y - grid->origin.y, at.z - grid->origin.z};
  const float spacing[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  uint32_t number = 0;
  for (int i = 2; i >= 0; i--) {
    const uint32_t cages = grid->count[i] > 1 ? grid->count[i] - 1 : 1;
    const float cell = grid->count[i] > 1 ? floorf(offset[i] / spacing[i]) : 0.0f;
    number = number * cages + (cell <= 0.0f ? 0 : cell >= (float)cages ? cages - 1 : (uint32_t)cell);
  }
  return number;
}

// Returns the light that varies over a surface; negative where there is none.
static float value(const picture *p, olx_layer layer, uint32_t pixel) {
  const olx_vec3 light = p->image.layers[layer][pixel];
  if (layer == OLX_LAYER_INDIRECT_GLOSSY) return light.x + light.y + light.z > 0.0f ? luminance(light) : -1.0f;
  const olx_vec3 albedo = p->image.layers[OLX_LAYER_ALBEDO][pixel];
  if (!(albedo.x > 0.01f && albedo.y > 0.01f && albedo.z > 0.01f)) return -1.0f;
  return luminance((olx_vec3){light.x / albedo.x, light.y / albedo.y, light.z / albedo.z});
}

static bool alike(float a, float b) { return fabsf(a - b) <= 0.1f * fmaxf(a, b); }

// Returns whether four pixels show one flat piece of surface, of one material.
static bool one_surface(const picture *p, const uint32_t pixels[4], const olx_vec3 at[4]) {
  const olx_vec3 normal = p->image.layers[OLX_LAYER_NORMAL][pixels[1]];
  const olx_vec3 color = p->image.layers[OLX_LAYER_ALBEDO][pixels[1]];
  for (int i = 0; i < 4; i++) {
    const float depth = p->image.layers[OLX_LAYER_DEPTH][pixels[i]].x;
    if (!(depth < INFINITY) || !(dot(p->image.layers[OLX_LAYER_NORMAL][pixels[i]], normal) > 0.99f)) return false;
    if (!(fabsf(dot(normal, minus(at[i], at[1]))) < 2e-3f * depth)) return false;
    const olx_vec3 other = p->image.layers[OLX_LAYER_ALBEDO][pixels[i]];
    if (!alike(color.x, other.x) || !alike(color.y, other.y) || !alike(color.z, other.z)) return false;
  }
  return true;
}

static void add_four(const picture *p, olx_layer layer, const olx_grid *grid, uint32_t first, uint32_t step,
                     gradients *border, gradients *elsewhere) {
  const uint32_t pixels[4] = {first, first + step, first + 2 * step, first + 3 * step};
  olx_vec3 at[4];
  float light[4];
  uint32_t cage[4];
  for (int i = 0; i < 4; i++) {
    at[i] = position(p, pixels[i]);
    light[i] = value(p, layer, pixels[i]);
    if (light[i] < 0.0f) return;
  }
  if (!one_surface(p, pixels, at)) return;
  for (int i = 0; i < 4; i++) cage[i] = cage_of(grid, at[i]);
  if (cage[0] != cage[1] || cage[2] != cage[3]) return;
  gradients *g = cage[1] == cage[2] ? elsewhere : border;
  g->across += (double)fabsf(light[2] - light[1]);
  g->beside += 0.5 * (double)(fabsf(light[1] - light[0]) + fabsf(light[3] - light[2]));
  g->count++;
}

static void print_layer(const picture *p, olx_layer layer, const olx_grid *grid) {
  gradients border = {.count = 0}, elsewhere = {.count = 0};
  const uint32_t width = p->image.width, height = p->image.height;
  for (uint32_t i = 0; i < width * height; i++) {
    if (i % width + 3 < width) add_four(p, layer, grid, i, 1, &border, &elsewhere);
    if (i / width + 3 < height) add_four(p, layer, grid, i, width, &border, &elsewhere);
  }
  printf("\"%s\":{\"borders\":%llu,\"across\":%.6g,\"beside\":%.6g,\"ratio\":%.4f,\"elsewhere\":%.4f},",
         olx_layer_name(layer), (unsigned long long)border.count, border.across / (double)border.count,
         border.beside / (double)border.count, border.across / border.beside, elsewhere.across / elsewhere.beside);
}

static uint64_t count_broken(const olx_image *image) {
  uint64_t broken = 0;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; layer++) {
    for (size_t i = 0; image->layers[layer] && i < (size_t)image->width * image->height; i++) {
      const olx_vec3 v = image->layers[layer][i];
      if (layer == OLX_LAYER_DEPTH) broken += !(v.x > 0.0f); // infinite for the sky
      else broken += !(isfinite(v.x) && isfinite(v.y) && isfinite(v.z));
    }
  }
  return broken;
}

int study_seams(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  olx_camera camera;
  picture p;
  if (olx_scene_load(argv[1], &scene) != OLX_OK || olx_field_open(argv[2], &field) != OLX_OK ||
      olx_image_load(argv[3], &p.image) != OLX_OK ||
      olx_scene_find_camera(scene, argc > 4 ? argv[4] : NULL, &camera) != OLX_OK) {
    return library_failure(NAME);
  }
  const olx_field_info info = olx_field_describe(field);
  look(&p, &camera);
  printf("{");
  if (info.irradiance.probe_count) print_layer(&p, OLX_LAYER_INDIRECT_DIFFUSE, &info.irradiance.grid);
  if (info.probes.has_grid) print_layer(&p, OLX_LAYER_INDIRECT_GLOSSY, &info.probes.grid);
  printf("\"not_finite\":%llu}\n", (unsigned long long)count_broken(&p.image));
  olx_image_free(&p.image);
  olx_field_close(field);
  olx_scene_free(scene);
  return 0;
}
