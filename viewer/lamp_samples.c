// Converts a scene's light to a list of lamps: emissive surfaces and the environment become points and directions
// sampled by power, each with views for its shadows.
#include "lamp_samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float PI = 3.14159265f;

static olx_vec3 add(olx_vec3 a, olx_vec3 b) { return (olx_vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static olx_vec3 sub(olx_vec3 a, olx_vec3 b) { return (olx_vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static olx_vec3 mul(olx_vec3 a, olx_vec3 b) { return (olx_vec3){a.x * b.x, a.y * b.y, a.z * b.z}; }
static olx_vec3 scale(olx_vec3 v, float s) { return (olx_vec3){v.x * s, v.y * s, v.z * s}; }
static float dot(olx_vec3 a, olx_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static float length(olx_vec3 v) { return sqrtf(dot(v, v)); }
static olx_vec3 normalize(olx_vec3 v) { return scale(v, 1.0f / length(v)); }
static float luminance(olx_vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

static olx_vec3 cross(olx_vec3 a, olx_vec3 b) {
  return (olx_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static void store(olx_vec3 v, float to[3]) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

lamp_settings lamp_settings_default(void) {
  return (lamp_settings){.map_size = 512, .sun_tiles = 4, .surface_samples = 8, .sky_samples = 12};
}

// Returns point i of a low-discrepancy sequence in the unit square (the additive recurrence of the plastic number).
static olx_vec2 even_pair(uint32_t i) {
  const float x = 0.5f + 0.7548776662f * (float)i, y = 0.5f + 0.5698402910f * (float)i;
  return (olx_vec2){x - floorf(x), y - floorf(y)};
}

// ---- Views

// Returns a view of the half space around `forward`: rows of x and y are in units of clip space per metre (at distance
// 1).
static lamp_view make_view(olx_vec3 x, olx_vec3 y, olx_vec3 forward, olx_vec3 eye, float near) {
  const float m[16] = {x.x, y.x, 0.0f, forward.x, x.y,          y.y,          0.0f, forward.y,
                       x.z, y.z, 0.0f, forward.z, -dot(x, eye), -dot(y, eye), near, -dot(forward, eye)};
  lamp_view view = {.texel = 0.0f};
  memcpy(view.world_to_clip, m, sizeof m);
  return view;
}

static lamp_view make_perspective(olx_vec3 eye, olx_vec3 forward, olx_vec3 up, float tangent, float near,
                                  uint32_t map_size) {
  const olx_vec3 right = normalize(cross(forward, up)), above = cross(right, forward);
  lamp_view view = make_view(scale(right, 1.0f / tangent), scale(above, -1.0f / tangent), forward, eye, near);
  view.texel = 2.0f * tangent / (float)map_size;
  return view;
}

static olx_vec3 any_up(olx_vec3 forward) {
  return fabsf(forward.y) < 0.9f ? (olx_vec3){0.0f, 1.0f, 0.0f} : (olx_vec3){0.0f, 0.0f, 1.0f};
}

static bool has_room(const lamp_list *list, uint32_t views) {
  return list->lamp_count < LAMP_MAX && list->view_count + views <= LAMP_MAX_VIEWS;
}

// Adds six views slightly wider than 90 degrees, so that filtering at a view's edge stays within it.
static void add_cube(const lamp_settings *settings, olx_vec3 eye, float near, lamp_list *list) {
  for (uint32_t face = 0; face < 6; face++) {
    const float sign = face & 1u ? -1.0f : 1.0f;
    const olx_vec3 forward = {face / 2 == 0 ? sign : 0.0f, face / 2 == 1 ? sign : 0.0f, face / 2 == 2 ? sign : 0.0f};
    const float margin = 1.0f + 4.0f / (float)settings->map_size;
    list->views[list->view_count++] = make_perspective(eye, forward, any_up(forward), margin, near, settings->map_size);
  }
}

typedef struct extent {
  float low[3], high[3];
} extent;

// Returns the extent of the scene's box along three directions.
static extent box_extent(const olx_scene_content *content, const olx_vec3 axes[3]) {
  extent e = {.low = {0}};
  for (uint32_t corner = 0; corner < 8; corner++) {
    const olx_vec3 low = content->bounds_min, high = content->bounds_max;
    const olx_vec3 p = {corner & 1u ? high.x : low.x, corner & 2u ? high.y : low.y, corner & 4u ? high.z : low.z};
    for (uint32_t k = 0; k < 3; k++) {
      const float along = dot(axes[k], p);
      if (corner == 0 || along < e.low[k]) e.low[k] = along;
      if (corner == 0 || along > e.high[k]) e.high[k] = along;
    }
  }
  return e;
}

// Adds parallel views along `direction` that together cover the scene's box.
static void add_parallel(const olx_scene_content *content, uint32_t map_size, olx_vec3 direction, uint32_t tiles,
                         lamp_list *list) {
  const olx_vec3 right = normalize(cross(direction, any_up(direction))), down = cross(direction, right);
  const olx_vec3 axes[3] = {right, down, direction};
  const extent e = box_extent(content, axes);
  // Leaves a margin of one and a half texels around the box, and as much overlap between tiles, for filtering.
  const float width = fmaxf(e.high[0] - e.low[0], e.high[1] - e.low[1]) / (float)tiles;
  const float half_width = 0.5f * width * (1.0f + 4.0f / (float)map_size), depth = e.high[2] - e.low[2];
  const float center_x = 0.5f * (e.low[0] + e.high[0]), center_y = 0.5f * (e.low[1] + e.high[1]);
  for (uint32_t tile = 0; tile < tiles * tiles; tile++) {
    const uint32_t column = tile % tiles, row = tile / tiles;
    const float x = center_x + width * ((float)column + 0.5f - 0.5f * (float)tiles);
    const float y = center_y + width * ((float)row + 0.5f - 0.5f * (float)tiles);
    const float s = 1.0f / half_width, t = -1.0f / (1.02f * depth);
    const float m[16] = {right.x * s,
                         down.x * s,
                         direction.x * t,
                         0.0f,
                         right.y * s,
                         down.y * s,
                         direction.y * t,
                         0.0f,
                         right.z * s,
                         down.z * s,
                         direction.z * t,
                         0.0f,
                         -x * s,
                         -y * s,
                         1.0f + (0.01f * depth - e.low[2]) * t,
                         1.0f};
    lamp_view view = {.texel = 2.0f * half_width / (float)map_size};
    memcpy(view.world_to_clip, m, sizeof m);
    list->views[list->view_count++] = view;
  }
}

// ---- Lights without area

static void add_light(const olx_scene_content *content, const lamp_settings *settings, const olx_light *light,
                      float near, lamp_list *list) {
  const bool sun = light->type == OLX_LIGHT_SUN, spot = light->type == OLX_LIGHT_SPOT && light->cosine_outer > 0.1f;
  const uint32_t views = sun ? settings->sun_tiles * settings->sun_tiles : spot ? 1 : 6;
  if (!has_room(list, views)) {
    list->left_out++;
    return;
  }
  lamp *l = &list->lamps[list->lamp_count++];
  *l = (lamp){.kind = sun                             ? LAMP_DISTANT
                      : light->type == OLX_LIGHT_SPOT ? LAMP_SPOT
                                                      : LAMP_POINT,
              .first_view = list->view_count,
              .cosine_inner = light->cosine_inner,
              .cosine_outer = light->cosine_outer,
              .tiles = sun    ? settings->sun_tiles
                       : spot ? 0
                              : 1};
  store(light->position, l->position);
  store(light->direction, l->direction);
  store(light->emission, l->emission);
  if (sun) {
    add_parallel(content, settings->map_size, light->direction, settings->sun_tiles, list);
  } else if (spot) {
    const float cosine = light->cosine_outer, tangent = 1.02f * sqrtf(1.0f - cosine * cosine) / cosine;
    list->views[list->view_count++] = make_perspective(light->position, light->direction, any_up(light->direction),
                                                       tangent, near, settings->map_size);
  } else {
    add_cube(settings, light->position, near, list);
  }
}

// ---- Emissive surfaces

static float decoded(uint8_t byte, bool srgb) {
  const float x = (float)byte / 255.0f;
  if (!srgb) return x;
  return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

static uint32_t texel_index(float coordinate, uint32_t size) {
  const float fraction = coordinate - floorf(coordinate);
  const uint32_t i = (uint32_t)(fraction * (float)size);
  return i < size ? i : size - 1;
}

// Returns the mean radiance of a triangle, over sixteen texels when it is textured.
static olx_vec3 mean_emission(const olx_scene_content *content, uint32_t triangle) {
  const olx_material *m = &content->materials[content->material_index[triangle]];
  if (m->emission_texture == OLX_NO_TEXTURE || !(luminance(m->emission) > 0.0f)) return m->emission;
  const olx_texture *texture = &content->textures[m->emission_texture];
  const uint32_t *corner = content->indices + 3 * (size_t)triangle;
  const olx_vec2 *uvs = m->second_uvs & OLX_SLOT_EMISSION ? content->second_uvs : content->uvs;
  const olx_vec2 a = uvs[corner[0]], b = uvs[corner[1]], c = uvs[corner[2]];
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < 16; i++) {
    olx_vec2 w = even_pair(i);
    if (w.x + w.y > 1.0f) w = (olx_vec2){1.0f - w.x, 1.0f - w.y};
    const uint32_t x = texel_index(a.x + w.x * (b.x - a.x) + w.y * (c.x - a.x), texture->width);
    const uint32_t y = texel_index(a.y + w.x * (b.y - a.y) + w.y * (c.y - a.y), texture->height);
    const uint8_t *t = texture->texels + 4 * ((size_t)y * texture->width + x);
    sum =
        add(sum, (olx_vec3){decoded(t[0], texture->srgb), decoded(t[1], texture->srgb), decoded(t[2], texture->srgb)});
  }
  return mul(m->emission, scale(sum, 1.0f / 16.0f));
}

static void add_surface(const olx_scene_content *content, const lamp_settings *settings, uint32_t triangle,
                        olx_vec2 random, olx_vec3 radiance, float area, float near, lamp_list *list) {
  if (!has_room(list, 6)) {
    list->left_out++;
    return;
  }
  const uint32_t *corner = content->indices + 3 * (size_t)triangle;
  const olx_vec3 a = content->positions[corner[0]];
  const olx_vec3 e1 = sub(content->positions[corner[1]], a), e2 = sub(content->positions[corner[2]], a);
  const olx_vec3 normal = normalize(cross(e1, e2));
  const olx_vec2 w = random.x + random.y > 1.0f ? (olx_vec2){1.0f - random.x, 1.0f - random.y} : random;
  const bool both = content->materials[content->material_index[triangle]].emits_both_sides;
  // The point is slightly in front of the surface, so that its own plane casts no shadow.
  const olx_vec3 position = add(add(a, add(scale(e1, w.x), scale(e2, w.y))), scale(normal, both ? 0.0f : near));
  lamp *l = &list->lamps[list->lamp_count++];
  *l = (lamp){
      .kind = LAMP_SURFACE, .extent = sqrtf(area / PI), .first_view = list->view_count, .tiles = 1, .both_sides = both};
  store(position, l->position);
  store(normal, l->direction);
  store(scale(radiance, area), l->emission);
  add_cube(settings, position, near, list);
}

// Adds points on surfaces, sampled by power, so that each represents an equal share of it.
static bool add_surfaces(const olx_scene_content *content, const lamp_settings *settings, float near, lamp_list *list) {
  float *sums = calloc((size_t)content->triangle_count + 1, sizeof *sums);
  if (!sums) return false;
  for (uint32_t t = 0; t < content->triangle_count; t++) {
    const uint32_t *corner = content->indices + 3 * (size_t)t;
    const olx_vec3 a = content->positions[corner[0]];
    const olx_vec3 n = cross(sub(content->positions[corner[1]], a), sub(content->positions[corner[2]], a));
    sums[t + 1] = sums[t] + 0.5f * length(n) * luminance(mean_emission(content, t));
  }
  const float total = sums[content->triangle_count];
  uint32_t t = 0;
  for (uint32_t i = 0; total > 0.0f && i < settings->surface_samples; i++) {
    const float wanted = total * ((float)i + 0.5f) / (float)settings->surface_samples;
    while (t + 1 < content->triangle_count && sums[t + 1] <= wanted) t++;
    const olx_vec3 radiance = mean_emission(content, t);
    const float area = total / ((float)settings->surface_samples * luminance(radiance));
    add_surface(content, settings, t, even_pair(i), radiance, area, near, list);
  }
  free(sums);
  return true;
}

// ---- The environment

// Adds a distant lamp of the given irradiance that fills `solid_angle`.
static void add_distant(const olx_scene_content *content, const lamp_settings *settings, olx_vec3 towards,
                        olx_vec3 irradiance, float solid_angle, lamp_list *list) {
  if (!has_room(list, 1)) {
    list->left_out++;
    return;
  }
  const float cosine = fmaxf(1.0f - solid_angle / (2.0f * PI), 0.0f);
  lamp *l = &list->lamps[list->lamp_count++];
  *l =
      (lamp){.kind = LAMP_DISTANT, .extent = sqrtf(1.0f - cosine * cosine), .first_view = list->view_count, .tiles = 1};
  const olx_vec3 direction = scale(towards, -1.0f);
  store(direction, l->direction);
  store(irradiance, l->emission);
  add_parallel(content, settings->map_size, direction, 1, list);
}

static void add_constant_sky(const olx_scene_content *content, const lamp_settings *settings, lamp_list *list) {
  const float solid_angle = 4.0f * PI / (float)settings->sky_samples;
  for (uint32_t i = 0; i < settings->sky_samples; i++) {
    const float y = 1.0f - (2.0f * (float)i + 1.0f) / (float)settings->sky_samples, r = sqrtf(1.0f - y * y);
    const float phi = 2.39996323f * (float)i;
    add_distant(content, settings, (olx_vec3){r * cosf(phi), y, r * sinf(phi)},
                scale(content->environment->radiance, solid_angle), solid_angle, list);
  }
}

// Returns the solid angle of a texel of a latitude-longitude image.
static float texel_solid_angle(const olx_environment *e, uint32_t row) {
  const float half_step = 0.5f * PI / (float)e->height;
  return 4.0f * PI / (float)e->width * sinf(half_step * (2.0f * (float)row + 1.0f)) * sinf(half_step);
}

static olx_vec3 sky_texel(const olx_environment *e, size_t i) {
  return mul(e->radiance, (olx_vec3){e->texels[3 * i], e->texels[3 * i + 1], e->texels[3 * i + 2]});
}

static olx_vec3 texel_direction(const olx_environment *e, size_t i) {
  const size_t column = i % e->width, row = i / e->width;
  const float theta = PI * ((float)row + 0.5f) / (float)e->height;
  const float phi = (((float)column + 0.5f) / (float)e->width - 0.5f) * 2.0f * PI - e->rotation_radians;
  return (olx_vec3){sinf(theta) * cosf(phi), cosf(theta), sinf(theta) * sinf(phi)};
}

// Adds texels of the sky, sampled by irradiance, so that each represents an equal share of it.
static void add_image_sky(const olx_scene_content *content, const lamp_settings *settings, lamp_list *list) {
  const olx_environment *e = content->environment;
  const size_t count = (size_t)e->width * e->height;
  double total = 0.0, passed = 0.0;
  for (size_t i = 0; i < count; i++) {
    total += (double)(luminance(sky_texel(e, i)) * texel_solid_angle(e, (uint32_t)(i / e->width)));
  }
  const double share = total / settings->sky_samples;
  uint32_t drawn = 0;
  for (size_t i = 0; total > 0.0 && i < count; i++) {
    const olx_vec3 radiance = sky_texel(e, i);
    passed += (double)(luminance(radiance) * texel_solid_angle(e, (uint32_t)(i / e->width)));
    for (; drawn < settings->sky_samples && passed > share * (drawn + 0.5); drawn++) {
      const float solid_angle = (float)share / luminance(radiance);
      add_distant(content, settings, texel_direction(e, i), scale(radiance, solid_angle), solid_angle, list);
    }
  }
}

bool lamp_list_make(const olx_scene_content *content, const lamp_settings *settings, lamp_list *list) {
  const float near = 1e-3f * length(sub(content->bounds_max, content->bounds_min));
  list->lamp_count = list->view_count = list->left_out = 0;
  for (uint32_t i = 0; i < content->light_count; i++) add_light(content, settings, &content->lights[i], near, list);
  if (settings->surface_samples && !add_surfaces(content, settings, near, list)) return false;
  if (settings->sky_samples && luminance(content->environment->radiance) > 0.0f) {
    if (content->environment->texels) add_image_sky(content, settings, list);
    else add_constant_sky(content, settings, list);
  }
  return true;
}
