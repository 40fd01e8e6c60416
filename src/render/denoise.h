// The separated denoiser of McGuire et al. 2017, section 5.1, on incident light: one ray per pixel is blended into the
// history of the surface that the pixel shows, and a cross-bilateral filter reads that history around each pixel.
//
// Every pass is a function of its buffers, pixel by pixel; two histories, used alternately, are the only state.
#ifndef OLX_RENDER_DENOISE_H
#define OLX_RENDER_DENOISE_H

#include "render/camera.h"
#include "shade/ray_turn.h"

#include <octalux/denoiser.h>

// The surfaces of a frame that guide the filters. Pixel (x, y) is at x + width * y.
typedef struct olx_guide {
  uint32_t width, height;
  olx_camera_frame camera;
  const float *depth;     // along the viewing axis; infinite where the ray leaves the scene
  const olx_vec3 *normal; // shading normal, unit
  const float *roughness;
} olx_guide;

// Light that arrives at a surface, before albedo and Fresnel, and the inverse of its distance.
typedef struct olx_incident {
  olx_vec3 light;
  // 1/metres, 0 for the sky, averaged like the light; negative: the pixel has no light of this kind
  float inverse_distance;
} olx_incident;

typedef struct olx_history {
  olx_incident *incident;
  float *count; // number of frames in the mean, up to where the weight of history stops growing; 0: none
} olx_history;

olx_result olx_history_create(uint32_t width, uint32_t height, olx_history *history);
void olx_history_free(olx_history *history);
// Clears the history.
void olx_history_clear(uint32_t width, uint32_t height, olx_history *history);

// Blends a frame's samples into the history: `to` becomes the mean of `sample` and the history in `from` of the same
// surface, found through the previous frame's camera. Surfaces that were not visible then, by depth or normal, start a
// new history; samples that are not finite are left out. Pixels that did not trace in this turn keep their history;
// where they have none, they borrow the sample of the pixel that traced for their square, if it shows the same surface.
// `from` and `to` must differ.
olx_result olx_denoise_accumulate(const olx_lobe_filter *filter, const olx_ray_turn *turn, const olx_guide *now,
                                  const olx_incident *sample, const olx_guide *before, const olx_history *from,
                                  const olx_history *to, uint32_t threads);

typedef enum olx_lobe { OLX_LOBE_DIFFUSE, OLX_LOBE_GLOSSY } olx_lobe;

// Filters a history over pixels into `light`, which is black where no surface is visible: along rows, then along
// columns. `rows` is another history, which is overwritten.
olx_result olx_denoise_filter(const olx_lobe_filter *filter, olx_lobe lobe, const olx_guide *guide,
                              const olx_history *history, const olx_history *rows, olx_vec3 *light, uint32_t threads);

// Returns the position of the surface that a pixel shows, and the pixel position at which a point appears in a frame
// (pixel centres at whole numbers; false behind the camera).
olx_vec3 olx_guide_position(const olx_guide *guide, uint32_t x, uint32_t y);
bool olx_guide_project(const olx_guide *guide, olx_vec3 position, olx_vec2 *pixel);

#endif
