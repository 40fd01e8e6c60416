// Small scenes whose light is known in closed form, for tests of renderers.
#ifndef OLX_TESTS_TINY_SCENES_H
#define OLX_TESTS_TINY_SCENES_H

#include "core/hooks.h"
#include "core/vec.h"
#include "scene/scene_build.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define ASSERT_OK(call)                                                                                                \
  do {                                                                                                                 \
    if ((call) != OLX_OK) fail_msg("%s: %s", #call, olx_last_error());                                                 \
  } while (0)

static inline olx_scene *tiny_scene(void) {
  olx_scene *scene = olx_allocate_zero(1, sizeof *scene);
  assert_non_null(scene);
  return scene;
}

static inline olx_material tiny_lambert(float albedo, float emission) {
  olx_material material = olx_material_default();
  material.base_color = olx_splat(albedo);
  material.emission = olx_splat(emission);
  return material;
}

static inline olx_material tiny_metal(float base_color, float roughness) {
  olx_material material = olx_material_default();
  material.base_color = olx_splat(base_color);
  material.metallic = 1.0f;
  material.roughness = roughness;
  material.specular_weight = 1.0f;
  return material;
}

static inline olx_material tiny_plastic(float base_color, float roughness) {
  olx_material material = tiny_metal(base_color, roughness);
  material.metallic = 0.0f;
  return material;
}

// Adds a parallelogram that faces along cross(edge_u, edge_v).
static inline void tiny_quad(olx_scene *scene, const olx_material *material, olx_vec3 center, olx_vec3 edge_u,
                             olx_vec3 edge_v) {
  uint32_t index = 0;
  ASSERT_OK(olx_scene_add_material(scene, material, &index));
  const olx_vec3 corner = olx_madd(olx_madd(center, edge_u, -0.5f), edge_v, -0.5f);
  const olx_vec3 positions[4] = {corner, olx_add(corner, edge_u), olx_add(olx_add(corner, edge_u), edge_v),
                                 olx_add(corner, edge_v)};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  ASSERT_OK(olx_scene_add_mesh(scene, "quad", positions, NULL, NULL, 4, indices, 2, index));
}

// Adds a closed cube from (-1,-1,-1) to (1,1,1), seen from inside.
static inline void tiny_box(olx_scene *scene, const olx_material *material) {
  const olx_vec3 x = {2, 0, 0}, y = {0, 2, 0}, z = {0, 0, 2};
  tiny_quad(scene, material, olx_v3(0, -1, 0), z, x);
  tiny_quad(scene, material, olx_v3(0, 1, 0), x, z);
  tiny_quad(scene, material, olx_v3(-1, 0, 0), y, z);
  tiny_quad(scene, material, olx_v3(1, 0, 0), z, y);
  tiny_quad(scene, material, olx_v3(0, 0, -1), x, y);
  tiny_quad(scene, material, olx_v3(0, 0, 1), y, x);
}

// Adds a floor of 2 x 2 m around the origin, facing up.
static inline void tiny_floor(olx_scene *scene, const olx_material *material) {
  tiny_quad(scene, material, olx_v3(0, 0, 0), olx_v3(0, 0, 2), olx_v3(2, 0, 0));
}

static inline olx_scene *tiny_finish(olx_scene *scene) {
  ASSERT_OK(olx_scene_finish(scene));
  return scene;
}

// Makes a closed box whose walls all emit `emission` and reflect `albedo`: radiance is emission / (1 - albedo)
// everywhere.
static inline olx_scene *tiny_furnace(float albedo, float emission) {
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_lambert(albedo, emission);
  tiny_box(scene, &walls);
  return tiny_finish(scene);
}

static inline olx_camera tiny_camera(olx_vec3 eye, olx_vec3 target, float fov_y_degrees) {
  return (olx_camera){
      .name = "test", .eye = eye, .target = target, .up = {0.1f, 1, 0.2f}, .fov_y_degrees = fov_y_degrees};
}

static inline olx_image tiny_render(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                                    const olx_render_settings *settings) {
  olx_image image;
  ASSERT_OK(olx_render(scene, field, camera, settings, NULL, &image, NULL));
  return image;
}

// Returns the mean over pixels and channels of a layer.
static inline double tiny_mean(const olx_image *image, olx_layer layer) {
  const size_t count = (size_t)image->width * image->height;
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    const olx_vec3 v = image->layers[layer][i];
    sum += (double)v.x + (double)v.y + (double)v.z;
  }
  return sum / (3.0 * (double)count);
}

static inline void assert_close(double value, double expected, double relative_tolerance, const char *what) {
  const double error = fabs(value - expected) / fabs(expected);
  if (!(error <= relative_tolerance)) {
    fail_msg("%s: %.6g instead of %.6g, off by %.4f %%", what, value, expected, 100 * error);
  }
}

// Returns the directional albedo of the specular lobe, by the midpoint rule over half vectors distributed as D cos. All
// computations are in double and independent of the library, from the definitions of GGX, height-correlated Smith and
// Schlick.
static inline double tiny_directional_albedo(double f0, double roughness, double cosine_view) {
  enum { STEPS = 1024 };
  const double a2 = pow(roughness, 4), vz = cosine_view, vx = sqrt(1 - vz * vz);
  double sum = 0;
  for (int i = 0; i < STEPS; i++) {
    const double u = (i + 0.5) / STEPS, tangent2 = a2 * u / (1 - u), hz = 1 / sqrt(1 + tangent2),
                 hr = sqrt(1 - hz * hz);
    for (int j = 0; j < STEPS; j++) {
      const double hx = hr * cos(2 * (double)OLX_PI * (j + 0.5) / STEPS), vh = vx * hx + vz * hz, lz = 2 * vh * hz - vz;
      if (vh <= 0 || lz <= 0) continue;
      const double root_v = sqrt(a2 + (1 - a2) * vz * vz), root_l = sqrt(a2 + (1 - a2) * lz * lz);
      const double g2 = 2 * lz * vz / (lz * root_v + vz * root_l);
      sum += (f0 + (1 - f0) * pow(1 - vh, 5)) * g2 * vh / (vz * hz);
    }
  }
  return sum / ((double)STEPS * STEPS);
}

#endif
