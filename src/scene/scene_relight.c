// Lists the lights and the emitting triangles of a scene in the form that a relighter takes, and casts the relighter's
// shadow rays against the scene's triangles.
#include "core/result.h"
#include "scene/bvh.h"
#include "scene/emitters.h"

enum { PACKET = 256 };

static bool emitting_triangle(const olx_scene *scene, uint32_t triangle, olx_light *light) {
  if (olx_emitters_area_pdf(scene, triangle) <= 0.0f) return false;
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]];
  *light = (olx_light){.type = OLX_LIGHT_TRIANGLE,
                       .emission = olx_surface_emission(scene, triangle, 1.0f / 3.0f, 1.0f / 3.0f),
                       .position = a,
                       .edge_u = olx_sub(scene->positions[corner[1]], a),
                       .edge_v = olx_sub(scene->positions[corner[2]], a),
                       .both_sides = scene->materials[scene->material_index[triangle]].emits_both_sides};
  return true;
}

static void put(const olx_light *light, olx_light *lights, uint32_t most, uint32_t *count) {
  if (*count < most) lights[*count] = *light;
  ++*count;
}

olx_result olx_scene_relight_lights(const olx_scene *scene, olx_light *lights, uint32_t most, uint32_t *count) {
  *count = 0;
  olx_light light;
  for (uint32_t i = 0; i < scene->light_count; i++) put(&scene->lights[i], lights, most, count);
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    if (emitting_triangle(scene, t, &light)) put(&light, lights, most, count);
  }
  if (olx_environment_lit(scene)) {
    light = (olx_light){.type = OLX_LIGHT_SKY, .emission = scene->environment.radiance};
    put(&light, lights, most, count);
    if (scene->environment.texels) return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: the environment is an image");
  }
  if (*count <= most) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: %u lights and shining triangles: at most %u", *count, most);
}

void olx_scene_occlusion(void *user, const olx_shadow_ray *rays, uint32_t count, uint8_t *occluded) {
  const olx_scene *scene = user;
  olx_ray cast[PACKET];
  for (uint32_t first = 0; first < count; first += PACKET) {
    const uint32_t size = count - first < PACKET ? count - first : PACKET;
    for (uint32_t i = 0; i < size; i++) {
      const olx_shadow_ray *ray = &rays[first + i];
      cast[i] = (olx_ray){ray->origin, ray->direction, 0.0f, ray->length_metres};
    }
    olx_bvh_occluded_many(scene->light_bvh, cast, size, true, occluded + first);
  }
}
