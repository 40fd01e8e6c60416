// Moves and dims the lights of a scene, and applies such changes to the rasteriser's lamps and to a relighter.
#include "view_lights.h"

#include <math.h>
#include <stdlib.h>

static olx_vec3 times(olx_vec3 v, float s) { return (olx_vec3){v.x * s, v.y * s, v.z * s}; }

view_lights view_lights_of(const olx_scene_content *content) {
  view_lights lights = {.surfaces = 1.0f, .sky = 1.0f};
  lights.count = content->light_count < VIEW_LIGHTS_MAX ? content->light_count : VIEW_LIGHTS_MAX;
  for (uint32_t i = 0; i < lights.count; i++) {
    lights.light[i] = content->lights[i];
    lights.strength[i] = 1.0f;
  }
  return lights;
}

static bool same_vector(olx_vec3 a, olx_vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static bool same_light(const olx_light *a, const olx_light *b) {
  return a->type == b->type && same_vector(a->position, b->position) && same_vector(a->direction, b->direction) &&
         same_vector(a->emission, b->emission) && a->cosine_inner == b->cosine_inner &&
         a->cosine_outer == b->cosine_outer;
}

bool view_lights_same(const view_lights *a, const view_lights *b) {
  bool same = a->count == b->count && a->surfaces == b->surfaces && a->sky == b->sky;
  for (uint32_t i = 0; i < a->count && same; i++) {
    same = a->strength[i] == b->strength[i] && same_light(&a->light[i], &b->light[i]);
  }
  return same;
}

void view_lights_place(view_lights *lights, uint32_t light, olx_vec3 to) {
  if (light >= lights->count) return;
  olx_light *l = &lights->light[light];
  const float length = sqrtf(to.x * to.x + to.y * to.y + to.z * to.z);
  if (l->type != OLX_LIGHT_SUN) l->position = to;
  else if (length > 1e-6f) l->direction = times(to, 1.0f / length);
}

void view_lights_move(view_lights *lights, uint32_t light, float right, float up, float away, float yaw) {
  if (light >= lights->count) return;
  olx_light *l = &lights->light[light];
  if (l->type != OLX_LIGHT_SUN) {
    l->position.x += cosf(yaw) * right + sinf(yaw) * away;
    l->position.y += up;
    l->position.z += sinf(yaw) * right - cosf(yaw) * away;
    return;
  }
  if (right == 0.0f && up == 0.0f) return;
  static const float highest = 1.55f;
  const olx_vec3 d = l->direction;
  const float around = atan2f(-d.x, -d.z) - right;
  const float height = fminf(fmaxf(asinf(fminf(fmaxf(-d.y, -1.0f), 1.0f)) + up, -highest), highest);
  l->direction = (olx_vec3){-cosf(height) * sinf(around), -sinf(height), -cosf(height) * cosf(around)};
}

// Returns a light with its strength.
static olx_light light_of(const view_lights *lights, uint32_t i) {
  olx_light light = lights->light[i];
  light.emission = times(light.emission, lights->strength[i]);
  return light;
}

static void scale_lamp(const view_lights *lights, lamp *l) {
  const bool sky = l->kind == LAMP_DISTANT && l->extent > 0.0f;
  const float factor = l->kind == LAMP_SURFACE ? lights->surfaces : sky ? lights->sky : 1.0f;
  for (int i = 0; i < 3; i++) l->emission[i] *= factor;
}

bool view_lights_lamps(const olx_scene_content *content, const view_lights *lights, const lamp_settings *settings,
                       lamp_list *list) {
  olx_light *moved = calloc((size_t)content->light_count + 1, sizeof *moved);
  if (!moved) return false;
  for (uint32_t i = 0; i < content->light_count; i++) {
    moved[i] = i < lights->count ? light_of(lights, i) : content->lights[i];
  }
  olx_scene_content changed = *content;
  changed.lights = moved;
  const bool made = lamp_list_make(&changed, settings, list);
  free(moved);
  for (uint32_t i = 0; made && i < list->lamp_count; i++) scale_lamp(lights, &list->lamps[i]);
  return made;
}

void view_lights_relit(const view_lights *lights, olx_light *relit, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    olx_light *light = &relit[i];
    if (i < lights->count) *light = light_of(lights, i);
    else if (light->type == OLX_LIGHT_TRIANGLE) light->emission = times(light->emission, lights->surfaces);
    else if (light->type == OLX_LIGHT_SKY) light->emission = times(light->emission, lights->sky);
  }
}
