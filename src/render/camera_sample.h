// The result that a renderer returns for each camera sample: the light and the surface that it found.
#ifndef OLX_RENDER_CAMERA_SAMPLE_H
#define OLX_RENDER_CAMERA_SAMPLE_H

#include "field/near_lamps.h"
#include "render/camera.h"
#include "scene/emitters.h"
#include "scene/sampler.h"
#include "scene/sky_guide.h"

#include <octalux/render.h>

enum { OLX_TILE_SIZE = 8, OLX_TILE_PIXELS = OLX_TILE_SIZE * OLX_TILE_SIZE };

typedef struct olx_camera_sample {
  olx_vec3 emission; // emission of the visible surface or the sky
  olx_vec3 direct, indirect_diffuse, indirect_glossy;
  olx_vec3 albedo, normal;
  float depth; // along the viewing axis; infinite when nothing was hit
} olx_camera_sample;

// Everything that the samples of an image share.
typedef struct olx_render_context {
  const olx_scene *scene;
  const olx_field *field;
  const olx_render_settings *settings;
  olx_camera_frame camera;
  olx_near_lamps lamps; // surfaces near lamps, with a field
} olx_render_context;

// The pixels of a tile, row by row.
typedef struct olx_tile {
  uint32_t x0, y0, width, height;
} olx_tile;

static inline uint32_t olx_tile_count(uint32_t width, uint32_t height) {
  return (width + OLX_TILE_SIZE - 1) / OLX_TILE_SIZE * ((height + OLX_TILE_SIZE - 1) / OLX_TILE_SIZE);
}
olx_tile olx_tile_at(uint32_t width, uint32_t height, uint32_t index);

// One camera ray for each pixel of a tile, and what they hit.
typedef struct olx_tile_rays {
  uint32_t count;
  olx_vec3 directions[OLX_TILE_PIXELS];
  olx_sampler samplers[OLX_TILE_PIXELS];
  olx_ray_hit hits[OLX_TILE_PIXELS];
  olx_sky_guide *sky; // guides direct light of the sky; NULL: nothing does
} olx_tile_rays;

// Fills samples[0..count) of a tile. They are zero on entry, except depth, and emission where the ray left the scene.
typedef void (*olx_tile_renderer)(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                                  olx_render_stats *stats);

// Casts the camera rays of sample `index` through the tile (rays->count of them), stores what they hit, and fills the
// samples as far as rays alone determine them.
void olx_tile_cast(const olx_render_context *context, const olx_tile *tile, uint32_t index, bool through_centers,
                   olx_tile_rays *rays, olx_camera_sample *samples);

// Checks that the positions of a field and a scene are relative to the same origin, and warns of a field that was baked
// from another scene.
olx_result olx_render_check_scene(const olx_scene *scene, const olx_field *field);
// Checks that the settings shared by all renderers are in range, and that the field exists and fits the scene.
olx_result olx_render_check(const olx_scene *scene, const olx_field *field, const olx_render_settings *settings);

// Records in the image how many bounces its light has.
void olx_render_note_bounces(const olx_field *field, const olx_render_settings *settings, olx_image *image);

void olx_render_stats_add(olx_render_stats *sum, const olx_render_stats *more);

#endif
