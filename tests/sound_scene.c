// Checks what must hold for every scene that loads: valid numbers, indices in range, and rays that hit its triangles.
#include "sound_scene.h"

#include "core/sampling.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void sound_scene_demand(bool holds, const char *what) {
  if (holds) return;
  fprintf(stderr, "a scene: broken promise: %s: %s\n", what, olx_last_error());
  abort();
}

static bool texture_fits(const olx_scene *scene, uint32_t texture) {
  return texture == OLX_NO_TEXTURE || texture < scene->texture_count;
}

static void check_materials(const olx_scene *scene) {
  for (uint32_t i = 0; i < scene->material_count; ++i) {
    const olx_material *m = &scene->materials[i];
    sound_scene_demand(m->metallic >= 0.0f && m->metallic <= 1.0f && m->roughness >= 0.0f && m->roughness <= 1.0f,
                       "material factors");
    sound_scene_demand(m->specular_weight >= 0.0f && m->specular_weight <= 1.0f, "specular weight");
    sound_scene_demand(olx_finite(m->base_color) && olx_max3(m->base_color) <= 1.0f, "base colour");
    sound_scene_demand(
        olx_finite(m->emission) && m->emission.x >= 0.0f && m->emission.y >= 0.0f && m->emission.z >= 0.0f, "emission");
    sound_scene_demand(texture_fits(scene, m->base_color_texture) && texture_fits(scene, m->alpha_texture) &&
                           texture_fits(scene, m->metallic_roughness_texture) &&
                           texture_fits(scene, m->emission_texture) && texture_fits(scene, m->normal_texture),
                       "texture indices");
  }
}

static void check_geometry(const olx_scene *scene) {
  sound_scene_demand(scene->triangle_count > 0, "triangles");
  sound_scene_demand(olx_finite(scene->bounds_min) && olx_finite(scene->bounds_max), "bounds");
  for (uint32_t t = 0; t < scene->triangle_count; ++t) {
    sound_scene_demand(scene->material_index[t] < scene->material_count, "material index");
    const uint32_t *i = scene->indices + (size_t)t * 3;
    for (uint32_t k = 0; k < 3; ++k) {
      sound_scene_demand(i[k] < scene->vertex_count, "vertex index");
      sound_scene_demand(olx_finite(scene->positions[i[k]]), "position");
      sound_scene_demand(fabsf(olx_length(scene->normals[i[k]]) - 1.0f) < 1e-2f, "normal");
      sound_scene_demand(isfinite(scene->uvs[i[k]].x) && isfinite(scene->uvs[i[k]].y), "uv");
    }
  }
}

static void cast_some_rays(const olx_scene *scene) {
  const olx_vec3 center = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  for (uint32_t i = 0; i < 32; ++i) {
    const olx_ray ray = {
        .origin = center, .direction = olx_sample_sphere(olx_hammersley(i, 32)), .t_min = 0.0f, .t_max = INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    sound_scene_demand(hit.triangle < scene->triangle_count, "hit");
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    sound_scene_demand(olx_finite(surface.bsdf.albedo) && olx_max3(surface.bsdf.albedo) <= 0.95f,
                       "albedo of a surface");
  }
}

void sound_scene_check(const olx_scene *scene) {
  check_geometry(scene);
  check_materials(scene);
  cast_some_rays(scene);
}
