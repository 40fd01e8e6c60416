// Draws points on lights without area, on emissive triangles and on the environment for next-event estimation, with
// their densities: by the light that reaches the place, or by power where there are many triangles.
#include "scene/emitters.h"

#include "core/distribution.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/lights.h"
#include "scene/environment.h"
#include "scene/many_lamps.h"
#include "scene/spherical_triangle.h"

// Most emissive triangles that are weighted for each shaded point; more are drawn by power alone.
enum { MOST_WEIGHED = 32, MOST_TEXELS = 1 << 24 };

// The properties of an emissive triangle that determine its weight.
typedef struct panel {
  olx_vec3 corners[3], center, normal;
  float area, power_per_area;
  bool both_sides;
} panel;

struct olx_emitters {
  // Groups are ordered: single lights without area, shared suns, shared lamps, emissive triangles, environment.
  uint32_t single_count;
  uint32_t *singles; // lights without area that are groups of their own, as in the scene
  uint32_t sun_count;
  uint32_t *suns;        // that share a group
  float *sun_sums;       // their distribution; NULL: none share one
  olx_many_lamps *lamps; // point and spot lights that share a group; NULL: none do
  uint32_t triangle_count;
  uint32_t *triangles; // the emissive ones
  float *triangle_sums;
  float *area_pdf; // by power, one per triangle of the scene; NULL when none emits
  panel *panels;   // one per emissive triangle when they are few, otherwise NULL
  olx_environment_sampler environment;
  float reach; // a distance beyond everything in the scene
};

static float triangle_area(const olx_scene *scene, uint32_t triangle) {
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0), b = olx_scene_corner(scene, triangle, 1),
                 c = olx_scene_corner(scene, triangle, 2);
  return 0.5f * olx_length(olx_cross(olx_sub(b, a), olx_sub(c, a)));
}

// Returns the number of texels that the triangle covers in its emission texture.
static float covered_texels(const olx_scene *scene, uint32_t triangle, const olx_material *material) {
  const olx_texture *texture = &scene->textures[material->emission_texture];
  const olx_vec2 *uvs = material->second_uvs & OLX_SLOT_EMISSION ? scene->second_uvs : scene->uvs;
  const uint32_t *i = scene->indices + 3 * (size_t)triangle;
  const olx_vec2 a = uvs[i[0]], b = uvs[i[1]], c = uvs[i[2]];
  const float area = 0.5f * fabsf((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  return area * (float)texture->width * (float)texture->height;
}

// Returns the mean luminance over the texels of its emission texture that the triangle covers; 0 where they are too many
// to look at, as where a small picture repeats often.
static float mean_of_texels(const olx_scene *scene, uint32_t triangle, const olx_material *material) {
  const olx_texture *texture = &scene->textures[material->emission_texture];
  const olx_vec2 *uvs = material->second_uvs & OLX_SLOT_EMISSION ? scene->second_uvs : scene->uvs;
  const uint32_t *index = scene->indices + 3 * (size_t)triangle;
  const olx_vec2 size = {(float)texture->width, (float)texture->height};
  const olx_vec2 tile = {floorf(uvs[index[0]].x), floorf(uvs[index[0]].y)}; // textures repeat
  olx_vec2 p[3], low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
  for (int i = 0; i < 3; i++) {
    p[i] = (olx_vec2){(uvs[index[i]].x - tile.x) * size.x, (uvs[index[i]].y - tile.y) * size.y};
    low = (olx_vec2){fminf(low.x, floorf(p[i].x)), fminf(low.y, floorf(p[i].y))};
    high = (olx_vec2){fmaxf(high.x, ceilf(p[i].x)), fmaxf(high.y, ceilf(p[i].y))};
  }
  const float whole = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
  if (!((high.x - low.x) * (high.y - low.y) <= MOST_TEXELS) || whole == 0.0f) return 0.0f;
  const uint32_t columns = (uint32_t)(high.x - low.x), rows = (uint32_t)(high.y - low.y);
  double sum = 0.0, count = 0.0;
  for (uint32_t row = 0; row < rows; row++) {
    for (uint32_t column = 0; column < columns; column++) {
      const float x = low.x + (float)column + 0.5f, y = low.y + (float)row + 0.5f;
      const float v = ((x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (y - p[0].y)) / whole;
      const float w = ((p[1].x - p[0].x) * (y - p[0].y) - (x - p[0].x) * (p[1].y - p[0].y)) / whole;
      if (!(v >= 0.0f && w >= 0.0f && v + w <= 1.0f)) continue;
      sum += (double)olx_luminance(olx_surface_emission(scene, triangle, v, w));
      count++;
    }
  }
  return count > 0.0 ? (float)(sum / count) : 0.0f;
}

// Returns the mean luminance of the triangle's emission: a few samples per texel, between 16 and 1024 in all, when it
// is textured. Spots between the samples of a large texture may hold all of its light.
static float mean_luminance(const olx_scene *scene, uint32_t triangle) {
  const olx_material *material = &scene->materials[scene->material_index[triangle]];
  if (!(olx_max3(material->emission) > 0.0f)) return 0.0f;
  if (material->emission_texture == OLX_NO_TEXTURE) return olx_luminance(material->emission);
  const float texels = covered_texels(scene, triangle, material);
  const uint32_t count = (uint32_t)olx_clamp(2.0f * texels, 16.0f, 1024.0f);
  float sum = 0.0f;
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec2 uv = olx_sample_triangle(olx_hammersley(i, count));
    sum += olx_luminance(olx_surface_emission(scene, triangle, uv.x, uv.y));
  }
  return sum > 0.0f || texels <= 512.0f ? sum / (float)count : mean_of_texels(scene, triangle, material);
}

static panel make_panel(const olx_scene *scene, uint32_t triangle, float probability) {
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0), b = olx_scene_corner(scene, triangle, 1),
                 c = olx_scene_corner(scene, triangle, 2);
  const float area = triangle_area(scene, triangle);
  return (panel){
      .corners = {a, b, c},
      .center = olx_scale(olx_add(olx_add(a, b), c), 1.0f / 3.0f),
      .normal = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a))),
      .area = area,
      .power_per_area = probability / area,
      .both_sides = scene->materials[scene->material_index[triangle]].emits_both_sides,
  };
}

static olx_result gather_triangles(const olx_scene *scene, olx_emitters *emitters) {
  uint32_t count = 0;
  float *luminance = olx_allocate(scene->triangle_count, sizeof(float));
  if (!luminance) goto no_memory;
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    luminance[t] = mean_luminance(scene, t);
    count += luminance[t] > 0.0f;
  }
  if (count > 0) {
    emitters->triangles = olx_allocate(count, sizeof *emitters->triangles);
    emitters->triangle_sums = olx_allocate((size_t)count + 1, sizeof(float));
    emitters->area_pdf = olx_allocate_zero(scene->triangle_count, sizeof(float));
    if (!emitters->triangles || !emitters->triangle_sums || !emitters->area_pdf) goto no_memory;
    uint32_t next = 0;
    for (uint32_t t = 0; t < scene->triangle_count; t++) {
      if (luminance[t] <= 0.0f) continue;
      emitters->triangle_sums[next] = luminance[t] * triangle_area(scene, t);
      emitters->triangles[next++] = t;
    }
    if (olx_distribution_build(emitters->triangle_sums, count, emitters->triangle_sums))
      emitters->triangle_count = count;
    for (uint32_t i = 0; i < emitters->triangle_count; i++) {
      const uint32_t t = emitters->triangles[i];
      emitters->area_pdf[t] = olx_distribution_probability(emitters->triangle_sums, i) / triangle_area(scene, t);
    }
    if (emitters->triangle_count <= MOST_WEIGHED) {
      emitters->panels = olx_allocate(count, sizeof *emitters->panels);
      if (!emitters->panels) goto no_memory;
      for (uint32_t i = 0; i < emitters->triangle_count; i++) {
        const float probability = olx_distribution_probability(emitters->triangle_sums, i);
        emitters->panels[i] = make_panel(scene, emitters->triangles[i], probability);
      }
    }
  }
  olx_release(luminance);
  return OLX_OK;
no_memory:
  olx_release(luminance);
  return olx_fail(OLX_ERROR_MEMORY, "lights: no memory for the emission of %u triangles", scene->triangle_count);
}

// The share of draws that takes any of the suns that share a group: each can be drawn beside a far stronger one.
static const float ANY_SUN_SHARE = 0.125f;

// Builds the distribution of suns by their irradiance; does nothing when all are dark.
static olx_result gather_shared_suns(const olx_scene *scene, uint32_t count, olx_emitters *emitters) {
  emitters->suns = olx_allocate(count, sizeof *emitters->suns);
  float *sums = olx_allocate((size_t)count + 1, sizeof *sums);
  if (!emitters->suns || !sums) {
    olx_release(sums);
    return olx_fail(OLX_ERROR_MEMORY, "lights: no memory for %u suns", count);
  }
  double total = 0.0;
  for (uint32_t i = 0; i < scene->light_count; i++) {
    if (scene->lights[i].type != OLX_LIGHT_SUN) continue;
    sums[emitters->sun_count] = olx_luminance(scene->lights[i].emission);
    total += (double)sums[emitters->sun_count];
    emitters->suns[emitters->sun_count++] = i;
  }
  const float any = (float)(total * (double)(ANY_SUN_SHARE / (1.0f - ANY_SUN_SHARE)) / (double)count);
  for (uint32_t i = 0; i < count; i++) sums[i] += any;
  if (olx_distribution_build(sums, count, sums)) emitters->sun_sums = sums;
  else olx_release(sums);
  return OLX_OK;
}

static uint32_t count_suns(const olx_scene *scene) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < scene->light_count; i++) count += scene->lights[i].type == OLX_LIGHT_SUN;
  return count;
}

static olx_result gather_lights(const olx_scene *scene, olx_emitters *emitters) {
  const uint32_t suns = count_suns(scene), lamps = scene->light_count - suns;
  const bool share_suns = suns > OLX_MAX_LIGHT_GROUPS, share_lamps = lamps > OLX_MAX_LIGHT_GROUPS;
  const uint32_t singles = (share_suns ? 0 : suns) + (share_lamps ? 0 : lamps);
  if (singles > 0) {
    emitters->singles = olx_allocate(singles, sizeof *emitters->singles);
    if (!emitters->singles) return olx_fail(OLX_ERROR_MEMORY, "lights: no memory for %u lights", singles);
  }
  for (uint32_t i = 0; i < scene->light_count; i++) {
    const bool shares = scene->lights[i].type == OLX_LIGHT_SUN ? share_suns : share_lamps;
    if (!shares) emitters->singles[emitters->single_count++] = i;
  }
  if (share_suns) OLX_TRY(gather_shared_suns(scene, suns, emitters));
  return share_lamps ? olx_many_lamps_create(scene, &emitters->lamps) : OLX_OK;
}

olx_result olx_emitters_create(const olx_scene *scene, olx_emitters **result_emitters) {
  *result_emitters = NULL;
  olx_emitters *emitters = olx_allocate_zero(1, sizeof *emitters);
  if (!emitters) return olx_fail(OLX_ERROR_MEMORY, "lights: no memory");
  emitters->reach = 2.0f * olx_length(olx_sub(scene->bounds_max, scene->bounds_min));
  olx_result result;
  OLX_TRY_GOTO(gather_lights(scene, emitters), failed);
  OLX_TRY_GOTO(gather_triangles(scene, emitters), failed);
  OLX_TRY_GOTO(olx_environment_sampler_create(&scene->environment, &emitters->environment), failed);
  *result_emitters = emitters;
  return OLX_OK;
failed:
  olx_emitters_free(emitters);
  return result;
}

void olx_emitters_free(olx_emitters *emitters) {
  if (!emitters) return;
  olx_release(emitters->singles);
  olx_release(emitters->suns);
  olx_release(emitters->sun_sums);
  olx_many_lamps_free(emitters->lamps);
  olx_release(emitters->triangles);
  olx_release(emitters->triangle_sums);
  olx_release(emitters->area_pdf);
  olx_release(emitters->panels);
  olx_environment_sampler_free(&emitters->environment);
  olx_release(emitters);
}

// Returns the number of groups of lights without area.
static uint32_t light_groups(const olx_emitters *e) {
  return e->single_count + (e->sun_sums != NULL) + (e->lamps != NULL);
}

uint32_t olx_emitters_group_count(const olx_scene *scene) {
  const olx_emitters *emitters = scene->emitters;
  return light_groups(emitters) + (emitters->triangle_count > 0) + emitters->environment.lit;
}

bool olx_emitters_group_varies(const olx_scene *scene, uint32_t group) {
  return group >= scene->emitters->single_count;
}

bool olx_emitters_group_is_a_sun(const olx_scene *scene, uint32_t group) {
  const olx_emitters *emitters = scene->emitters;
  return group < emitters->single_count && scene->lights[emitters->singles[group]].type == OLX_LIGHT_SUN;
}

bool olx_emitters_group_is_sky(const olx_scene *scene, uint32_t group) {
  return scene->emitters->environment.lit && group + 1 == olx_emitters_group_count(scene);
}

olx_vec2 olx_environment_random(const olx_scene *scene, olx_vec3 direction) {
  return olx_environment_point(&scene->environment, &scene->emitters->environment, direction);
}

static bool sample_light(const olx_scene *scene, uint32_t index, olx_vec3 position, float probability,
                         olx_light_sample *sample) {
  const olx_light *light = &scene->lights[index];
  *sample = (olx_light_sample){.delta = true, .light = index, .pdf = 1.0f};
  float strength = 1.0f;
  if (light->type == OLX_LIGHT_SUN) {
    sample->direction = olx_negate(light->direction);
    sample->target = olx_madd(position, sample->direction, scene->emitters->reach);
    sample->infinite = true;
  } else {
    const olx_vec3 way = olx_sub(light->position, position);
    const float distance = olx_length(way);
    if (!(distance > 0.0f)) return false;
    sample->direction = olx_scale(way, 1.0f / distance);
    sample->target = light->position;
    // A surface that the lamp lies on, as a ceiling with a recessed spot, does not shadow it.
    sample->epsilon_end = olx_place_epsilon(scene, light->position);
    strength = 1.0f / olx_square(distance);
    if (light->type == OLX_LIGHT_SPOT) {
      strength *=
          olx_spot_falloff(light->cosine_inner, light->cosine_outer, -olx_dot(sample->direction, light->direction));
    }
  }
  sample->emission = olx_scale(light->emission, strength / probability);
  return olx_max3(sample->emission) > 0.0f;
}

// Triangles with a larger solid angle than this are sampled evenly over it. Smaller ones are sampled evenly over their
// area, which is nearly equivalent, faster, and less sensitive to rounding.
static const float large_solid_angle = 0.03f;

// Returns an approximate solid angle of a triangle seen from a position; 0 from its dark side. The value is clamped
// between those at the triangle's rim and straight in front of it.
static float rough_solid_angle(const panel *p, olx_vec3 position) {
  const olx_vec3 way = olx_sub(position, p->center);
  const float height = olx_dot(way, p->normal);
  if (height == 0.0f || (height < 0.0f && !p->both_sides)) return 0.0f;
  const float distance_squared = olx_max(olx_dot(way, way), p->area), distance = sqrtf(distance_squared);
  return p->area * olx_min(fabsf(height) + sqrtf(p->area), distance) / (distance_squared * distance);
}

// Returns the solid angle of a triangle seen under a large one, with unit vectors to its corners; 0 when the angle is
// small.
static float view_large(const panel *p, olx_vec3 position, olx_vec3 corners[3]) {
  if (rough_solid_angle(p, position) < large_solid_angle) return 0.0f;
  for (uint32_t i = 0; i < 3; i++) corners[i] = olx_normalize(olx_sub(p->corners[i], position));
  const float angle = olx_spherical_triangle_area(corners);
  return angle < large_solid_angle ? 0.0f : angle;
}

// Weighs triangles by the approximate light that they send to a position without occlusion; returns the sum.
static float weigh_panels(const olx_emitters *emitters, olx_vec3 position, float weights[MOST_WEIGHED]) {
  float sum = 0.0f;
  for (uint32_t i = 0; i < emitters->triangle_count; i++) {
    const panel *p = &emitters->panels[i];
    sum += weights[i] = p->power_per_area * rough_solid_angle(p, position);
  }
  return sum;
}

// Draws one of the emissive triangles for a position; returns its probability, 0 when none sends light there.
static float draw_triangle(const olx_emitters *emitters, olx_vec3 position, float random, uint32_t *drawn) {
  if (!emitters->panels) {
    *drawn = olx_distribution_draw(emitters->triangle_sums, emitters->triangle_count, random, NULL);
    return olx_distribution_probability(emitters->triangle_sums, *drawn);
  }
  float weights[MOST_WEIGHED];
  const float sum = weigh_panels(emitters, position, weights);
  if (!(sum > 0.0f)) return 0.0f;
  float left = random * sum;
  for (uint32_t i = 0; i < emitters->triangle_count; i++) {
    if (weights[i] <= 0.0f) continue;
    *drawn = i;
    if (left < weights[i]) break;
    left -= weights[i];
  }
  return weights[*drawn] / sum;
}

// Returns the density over solid angle with which a point on an emissive triangle is sampled for a position; `per_area`
// converts a density over area to one over solid angle there.
static float triangle_density(const olx_scene *scene, uint32_t triangle, olx_vec3 position, float per_area) {
  const olx_emitters *emitters = scene->emitters;
  if (!emitters->panels) return emitters->area_pdf[triangle] * per_area;
  float weights[MOST_WEIGHED];
  const float sum = weigh_panels(emitters, position, weights);
  uint32_t i = 0;
  while (emitters->triangles[i] != triangle) i++;
  olx_vec3 corners[3];
  const float angle = view_large(&emitters->panels[i], position, corners);
  return sum > 0.0f ? weights[i] / sum * (angle > 0.0f ? 1.0f / angle : per_area / emitters->panels[i].area) : 0.0f;
}

// Returns the barycentric coordinates of the intersection of a direction from `position` with the triangle's plane,
// clamped to the triangle.
static olx_vec2 barycentric(const panel *p, olx_vec3 position, olx_vec3 direction) {
  const olx_vec3 ab = olx_sub(p->corners[1], p->corners[0]), ac = olx_sub(p->corners[2], p->corners[0]);
  const olx_vec3 h = olx_cross(direction, ac), from = olx_sub(position, p->corners[0]);
  const float inverse = 1.0f / olx_dot(ab, h);
  const float u = olx_clamp(olx_dot(from, h) * inverse, 0.0f, 1.0f);
  const float v = olx_clamp(olx_dot(direction, olx_cross(from, ab)) * inverse, 0.0f, 1.0f - u);
  return (olx_vec2){u, v};
}

static bool sample_triangle(const olx_scene *scene, olx_vec3 position, olx_vec2 random, float random_pick,
                            olx_light_sample *sample) {
  const olx_emitters *emitters = scene->emitters;
  uint32_t drawn = 0;
  const float probability = draw_triangle(emitters, position, random_pick, &drawn);
  if (probability <= 0.0f) return false;
  const uint32_t triangle = emitters->triangles[drawn];
  const panel *near = emitters->panels ? &emitters->panels[drawn] : NULL;
  olx_vec3 seen[3];
  const float angle = near ? view_large(near, position, seen) : 0.0f;
  const olx_vec2 uv = angle > 0.0f ? barycentric(near, position, olx_spherical_triangle_sample(seen, random))
                                   : olx_sample_triangle(random);
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0), b = olx_scene_corner(scene, triangle, 1),
                 c = olx_scene_corner(scene, triangle, 2);
  const olx_vec3 point = olx_add(olx_add(olx_scale(a, 1.0f - uv.x - uv.y), olx_scale(b, uv.x)), olx_scale(c, uv.y));
  const olx_vec3 normal = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  const olx_vec3 way = olx_sub(point, position);
  const float distance = olx_length(way);
  if (!(distance > 0.0f)) return false;
  const olx_vec3 direction = olx_scale(way, 1.0f / distance);
  const float cosine = -olx_dot(direction, normal);
  const bool both_sides = scene->materials[scene->material_index[triangle]].emits_both_sides;
  if (cosine == 0.0f || (cosine < 0.0f && !both_sides)) return false;
  if (!olx_surface_stops_light(scene, triangle, uv.x, uv.y)) return false;
  const olx_vec3 radiance = olx_surface_emission(scene, triangle, uv.x, uv.y);
  const float area = 0.5f * olx_length(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  const float pdf = angle > 0.0f ? probability / angle : probability / area * olx_square(distance) / fabsf(cosine);
  if (!(olx_max3(radiance) > 0.0f) || !(pdf > 0.0f) || !isfinite(pdf)) return false;
  const float epsilon = olx_surface_epsilon(scene, triangle);
  *sample = (olx_light_sample){
      .direction = direction,
      // Offset from the emitter towards the surface, so that a shadow ray at a grazing angle does not hit the emitter.
      .target = olx_madd(point, normal, cosine > 0.0f ? epsilon : -epsilon),
      .epsilon_end = epsilon,
      .emission = olx_scale(radiance, 1.0f / pdf),
      .pdf = pdf,
  };
  return true;
}

static bool sample_environment(const olx_scene *scene, olx_vec3 position, olx_vec2 random, olx_light_sample *sample) {
  float pdf;
  const olx_vec3 direction = olx_environment_draw(&scene->environment, &scene->emitters->environment, random, &pdf);
  const olx_vec3 radiance = olx_environment_lookup(&scene->environment, direction);
  if (!(pdf > 0.0f) || !(olx_max3(radiance) > 0.0f)) return false;
  *sample = (olx_light_sample){
      .direction = direction,
      .target = olx_madd(position, direction, scene->emitters->reach),
      .infinite = true,
      .emission = olx_scale(radiance, 1.0f / pdf),
      .pdf = pdf,
  };
  return true;
}

// Samples a group of lights without area.
static bool sample_light_group(const olx_scene *scene, uint32_t group, olx_vec3 position, float random_pick,
                               olx_light_sample *sample) {
  const olx_emitters *emitters = scene->emitters;
  if (group < emitters->single_count) return sample_light(scene, emitters->singles[group], position, 1.0f, sample);
  if (emitters->sun_sums && group == emitters->single_count) {
    const uint32_t drawn = olx_distribution_draw(emitters->sun_sums, emitters->sun_count, random_pick, NULL);
    const float probability = olx_distribution_probability(emitters->sun_sums, drawn);
    return sample_light(scene, emitters->suns[drawn], position, probability, sample);
  }
  uint32_t lamp;
  const float probability = olx_many_lamps_draw(emitters->lamps, position, random_pick, &lamp);
  return probability > 0.0f && sample_light(scene, lamp, position, probability, sample);
}

bool olx_emitters_sample(const olx_scene *scene, uint32_t group, olx_vec3 position, olx_vec2 random, float random_pick,
                         olx_light_sample *sample) {
  const olx_emitters *emitters = scene->emitters;
  const uint32_t lights = light_groups(emitters);
  if (group < lights) return sample_light_group(scene, group, position, random_pick, sample);
  if (group == lights && emitters->triangle_count > 0) {
    return sample_triangle(scene, position, random, random_pick, sample);
  }
  return sample_environment(scene, position, random, sample);
}

float olx_emitters_surface_pdf(const olx_scene *scene, const olx_surface *surface, olx_vec3 position,
                               olx_vec3 direction) {
  if (!(olx_max3(surface->emission) > 0.0f)) return 0.0f;
  if (!(olx_emitters_area_pdf(scene, surface->triangle) > 0.0f)) return 0.0f;
  const olx_vec3 way = olx_sub(surface->position, position);
  const float cosine = fabsf(olx_dot(direction, surface->geometric_normal));
  return cosine > 0.0f ? triangle_density(scene, surface->triangle, position, olx_dot(way, way) / cosine) : 0.0f;
}

float olx_emitters_area_pdf(const olx_scene *scene, uint32_t triangle) {
  return scene->emitters && scene->emitters->area_pdf ? scene->emitters->area_pdf[triangle] : 0.0f;
}

bool olx_environment_lit(const olx_scene *scene) { return scene->emitters->environment.lit; }

bool olx_environment_is_even(const olx_scene *scene) {
  return scene->emitters->environment.lit && scene->emitters->environment.even;
}

float olx_environment_mean(const olx_scene *scene) { return scene->emitters->environment.mean; }

olx_vec3 olx_environment_radiance(const olx_scene *scene, olx_vec3 direction) {
  return olx_environment_lookup(&scene->environment, direction);
}

float olx_environment_pdf(const olx_scene *scene, olx_vec3 direction) {
  return olx_environment_density(&scene->environment, &scene->emitters->environment, direction);
}
