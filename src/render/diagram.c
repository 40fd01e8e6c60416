// Draws a scene as a diagram: with flat shading, cut open towards the viewer, with marks such as probes and skeletons
// as shaded balls.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "render/camera.h"
#include "render/image_io.h"
#include "scene/bvh.h"

#include <octalux/render.h>

#include <stdlib.h>

#define HIDDEN_OPACITY 0.3f
#define FLAT 0.5f  // a scene lower than this share of its longer side is cut along the floor, others across the view
enum { SIDE = 2 }; // rays per pixel along each axis

typedef struct drawing {
  const olx_scene *scene;
  olx_camera_frame frame;
  bool cut; // the half space in front of `facing` from the plane through `middle` is cut away
  olx_vec3 middle, facing;
  uint32_t width, height;
  olx_vec3 *colors; // one per pixel, linear
  float *depths;    // depth of the nearest surface along the viewing axis
} drawing;

// Returns a camera above a corner of the scene, with the whole scene in view.
static olx_camera three_quarter_view(const olx_scene *scene) {
  const olx_vec3 centre = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  const float diagonal = olx_length(olx_sub(scene->bounds_max, scene->bounds_min));
  const olx_vec3 away = olx_normalize(olx_v3(0.55f, 0.75f, 0.8f));
  return (olx_camera){.name = "overview",
                      .eye = olx_madd(centre, away, 1.2f * diagonal),
                      .target = centre,
                      .up = {0.0f, 1.0f, 0.0f},
                      .fov_y_degrees = 40.0f};
}

static void choose_cut(drawing *d) {
  const olx_vec3 extent = olx_sub(d->scene->bounds_max, d->scene->bounds_min);
  const bool flat = extent.y < FLAT * olx_max(extent.x, extent.z);
  d->cut = true;
  d->middle = olx_scale(olx_add(d->scene->bounds_min, d->scene->bounds_max), 0.5f);
  d->facing = flat ? olx_v3(0.0f, 1.0f, 0.0f) : olx_negate(d->frame.forward);
}

// Returns the distance at which a view ray leaves the part that is cut away.
static float find_start(const drawing *d, olx_vec3 direction) {
  const float above = olx_dot(olx_sub(d->frame.eye, d->middle), d->facing), down = -olx_dot(direction, d->facing);
  if (!d->cut || above <= 0.0f) return 0.0f;
  return down > 0.0f ? above / down : INFINITY;
}

// Shades flat: grey with a little of the surface's own colour, lit from the viewer and from above, dark enough for
// marks to be distinct.
static olx_vec3 flat_shade(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)hit->triangle;
  const olx_vec3 a = scene->positions[corner[0]];
  const olx_vec3 cross = olx_cross(olx_sub(scene->positions[corner[1]], a), olx_sub(scene->positions[corner[2]], a));
  const olx_vec3 normal = olx_normalize(cross);
  const olx_vec3 base = scene->materials[scene->material_index[hit->triangle]].base_color;
  const float light = 0.25f + 0.55f * fabsf(olx_dot(normal, direction)) + 0.2f * fabsf(normal.y);
  return olx_scale(olx_mix3(olx_splat(0.5f), base, 0.35f), 0.24f * light);
}

static void draw_pixel(const drawing *d, uint32_t x, uint32_t y) {
  const olx_vec3 empty = {0.012f, 0.014f, 0.018f};
  olx_vec3 sum = {0};
  float nearest = INFINITY;
  for (uint32_t i = 0; i < SIDE * SIDE; i++) {
    const float u = ((float)x + ((float)(i % SIDE) + 0.5f) / SIDE) / (float)d->width;
    const float v = ((float)y + ((float)(i / SIDE) + 0.5f) / SIDE) / (float)d->height;
    const olx_vec3 direction = olx_camera_direction(&d->frame, u, v);
    const float along = olx_dot(direction, d->frame.forward);
    const olx_ray ray = {d->frame.eye, direction, find_start(d, direction), INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(d->scene->bvh, &ray);
    const bool met = hit.triangle != OLX_NO_HIT;
    sum = olx_add(sum, met ? flat_shade(d->scene, &hit, direction) : empty);
    if (met) nearest = olx_min(nearest, hit.t * along);
  }
  const size_t pixel = x + (size_t)d->width * y;
  d->colors[pixel] = olx_scale(sum, 1.0f / (SIDE * SIDE));
  d->depths[pixel] = nearest;
}

static void row_job(void *user, uint32_t y) {
  const drawing *d = user;
  for (uint32_t x = 0; x < d->width; x++) draw_pixel(d, x, y);
}

// A mark projected to the image.
typedef struct disc {
  const olx_diagram_mark *mark;
  float x, y, radius, depth; // position and radius in pixels; depth in metres
} disc;

static bool project(const drawing *d, const olx_diagram_mark *mark, disc *out) {
  const olx_vec3 way = olx_sub(mark->position, d->frame.eye);
  const float depth = olx_dot(way, d->frame.forward);
  if (!(depth > 1e-6f)) return false;
  const float half_width = olx_length(d->frame.right), half_height = olx_length(d->frame.up);
  const float x = olx_dot(way, d->frame.right) / (half_width * half_width * depth);
  const float y = olx_dot(way, d->frame.up) / (half_height * half_height * depth);
  const float radius = 0.5f * (float)d->height * mark->radius / (half_height * depth);
  *out = (disc){.mark = mark,
                .x = 0.5f * (float)d->width * (1.0f + x),
                .y = 0.5f * (float)d->height * (1.0f - y),
                .radius = olx_clamp(radius, mark->least_pixels, mark->most_pixels),
                .depth = depth};
  return out->x + out->radius > 0.0f && out->x - out->radius < (float)d->width && out->y + out->radius > 0.0f &&
         out->y - out->radius < (float)d->height;
}

static int compare_discs(const void *a, const void *b) {
  const disc *x = a, *y = b;
  if (x->mark->order != y->mark->order) return x->mark->order < y->mark->order ? -1 : 1;
  if (x->depth != y->depth) return x->depth > y->depth ? -1 : 1;
  return x->mark < y->mark ? -1 : x->mark > y->mark;
}

// Draws a shaded ball with a soft edge; fainter where a surface occludes it.
static void draw_disc(const drawing *d, const disc *c) {
  const float reach = c->radius + 1.0f;
  const uint32_t left = (uint32_t)olx_max(c->x - reach, 0.0f), top = (uint32_t)olx_max(c->y - reach, 0.0f);
  for (uint32_t y = top; y < d->height && (float)y < c->y + reach; y++) {
    for (uint32_t x = left; x < d->width && (float)x < c->x + reach; x++) {
      const float dx = (float)x + 0.5f - c->x, dy = (float)y + 0.5f - c->y, away = sqrtf(dx * dx + dy * dy);
      const float inside = olx_clamp(c->radius - away + 0.5f, 0.0f, 1.0f);
      if (inside <= 0.0f) continue;
      const size_t pixel = x + (size_t)d->width * y;
      const bool hidden = d->depths[pixel] < c->depth - c->mark->radius;
      const float rise = olx_min(away / c->radius, 1.0f), shade = 0.3f + 0.7f * sqrtf(1.0f - rise * rise);
      const olx_vec3 color = c->radius < 3.0f ? c->mark->color : olx_scale(c->mark->color, shade);
      d->colors[pixel] = olx_mix3(d->colors[pixel], color, inside * (hidden ? HIDDEN_OPACITY : 1.0f));
    }
  }
}

static olx_result draw_marks(const drawing *d, const olx_diagram_mark *marks, uint32_t count, uint32_t *drawn) {
  disc *discs = olx_allocate(count, sizeof *discs);
  if (!discs) return olx_fail(OLX_ERROR_MEMORY, "no memory to draw %u marks", count);
  *drawn = 0;
  for (uint32_t i = 0; i < count; i++) *drawn += project(d, &marks[i], &discs[*drawn]);
  qsort(discs, *drawn, sizeof *discs, compare_discs);
  for (uint32_t i = 0; i < *drawn; i++) draw_disc(d, &discs[i]);
  olx_release(discs);
  return OLX_OK;
}

static uint8_t encode(float linear) {
  const float c = olx_clamp(linear, 0.0f, 1.0f);
  return (uint8_t)(255.0f * (c <= 0.0031308f ? 12.92f * c : 1.055f * powf(c, 1.0f / 2.4f) - 0.055f) + 0.5f);
}

static olx_result draw(drawing *d, const olx_diagram_settings *settings, const char *path, uint32_t *drawn) {
  const size_t pixels = (size_t)d->width * d->height;
  OLX_TRY(olx_parallel_for(d->height, settings->threads, row_job, d, NULL, 0));
  OLX_TRY(draw_marks(d, settings->marks, settings->mark_count, drawn));
  uint8_t *rgb = olx_allocate(3 * pixels, 1);
  if (!rgb) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for %ux%u pixels", path, d->width, d->height);
  for (size_t i = 0; i < pixels; i++) {
    rgb[3 * i] = encode(d->colors[i].x);
    rgb[3 * i + 1] = encode(d->colors[i].y);
    rgb[3 * i + 2] = encode(d->colors[i].z);
  }
  const olx_result result = olx_png_write(path, d->width, d->height, rgb);
  olx_release(rgb);
  return result;
}

olx_result olx_diagram_save(const olx_scene *scene, const olx_diagram_settings *settings, const char *path,
                            uint32_t *drawn) {
  const uint32_t width = settings->width, height = settings->height;
  if (width < 1 || height < 1 || width > OLX_PICTURE_SIZE_MOST || height > OLX_PICTURE_SIZE_MOST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u x %u pixels: each must be 1 to %d", path, width, height,
                    OLX_PICTURE_SIZE_MOST);
  }
  const olx_camera overview = three_quarter_view(scene);
  drawing d = {.scene = scene, .width = width, .height = height};
  OLX_TRY(olx_camera_frame_make(settings->camera ? settings->camera : &overview, width, height, &d.frame));
  if (!settings->camera) choose_cut(&d);
  d.colors = olx_allocate((size_t)width * height, sizeof *d.colors);
  d.depths = olx_allocate((size_t)width * height, sizeof *d.depths);
  olx_result result = OLX_ERROR_MEMORY;
  if (d.colors && d.depths) result = draw(&d, settings, path, drawn);
  else olx_fail(result, "%s: no memory for %ux%u pixels", path, width, height);
  olx_release(d.colors);
  olx_release(d.depths);
  return result;
}
