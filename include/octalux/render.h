// Whole images on the CPU, and their measurement: the field renderer, the path tracer as reference, image files,
// metrics and the audit of a field. Part of liboctalux-bake.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_RENDER_H
#define OCTALUX_RENDER_H

#include <octalux/denoiser.h>
#include <octalux/sample.h>
#include <octalux/scene.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

// Layers of an image, in this order. Light layers are outgoing radiance towards the eye:
// beauty = emission seen directly + direct + indirect_diffuse + indirect_glossy.
typedef enum olx_layer {
  OLX_LAYER_BEAUTY = 0,
  OLX_LAYER_DIRECT,           // emitter to surface with nothing in between, through every lobe
  OLX_LAYER_INDIRECT_DIFFUSE, // at least one surface between emitter and shaded surface, through the diffuse lobe
  OLX_LAYER_INDIRECT_GLOSSY,  // at least one surface between emitter and shaded surface, through the specular lobe
  OLX_LAYER_ALBEDO,           // diffuse reflectance: base colour * (1 - metallic)
  OLX_LAYER_NORMAL,           // shading normal, world space; 0 where nothing is seen
  OLX_LAYER_DEPTH,            // distance along the viewing axis in metres, one channel (others 0); infinite for the sky
  OLX_LAYER_STANDARD_ERROR,   // of beauty's mean; only on request
  OLX_LAYER_COUNT
} olx_layer;

// Returns the layer's name in files and reports ("beauty", "indirect_diffuse", ...).
const char *olx_layer_name(olx_layer layer);

// An image of float layers. Pixel (x, y) of a layer, y down, is layers[layer][x + width * y]; absent layers are NULL.
typedef struct olx_image {
  uint32_t width, height;
  olx_vec3 *layers[OLX_LAYER_COUNT];
  // The most surfaces that reflected indirect light before it reached the visible one: OLX_BOUNCES_INFINITE
  // (octalux/scene.h) or a count, when known. For a field it is one more than the field's, because the picture adds a
  // reflection. EXR files store it ("octaluxBounces").
  bool bounces_known;
  uint32_t bounces;
} olx_image;

// Allocates an image of 1 to 16384 pixels a side with the layers whose bits (1 << olx_layer) are set, filled with zero.
// On success the caller must free it, on failure it has no layers. The same holds for every function that makes an
// image.
olx_result olx_image_create(uint32_t width, uint32_t height, uint32_t layer_mask, olx_image *image);
// Releases the layers; the caller owns the struct itself.
void olx_image_free(olx_image *image);

// Writes `path` by its extension, .exr (all layers, linear float) or .png (beauty, tone-mapped), through a temporary
// file that is synced and renamed. OLX_ERROR_ARGUMENT for another extension, and for a .png of an image without
// beauty.
olx_result olx_image_save(const olx_image *image, const char *path);
// Writes one layer as .png, tone-mapped with `exposure`, above 0 (1: unchanged). OLX_ERROR_ARGUMENT for a layer that
// the image lacks.
olx_result olx_image_save_layer_png(const olx_image *image, olx_layer layer, float exposure, const char *path);
// Reads an .exr of olx_image_save, or any scanline EXR with channels R G B. The caller must free *image.
olx_result olx_image_load(const char *path, olx_image *image);

// Compresses 8-bit pixels of 1 (gray), 3 (RGB) or 4 (RGBA) channels, rows from the top, to a PNG in memory.
// OLX_ERROR_ARGUMENT, with a message, for other channels and for a picture without pixels or of more than 2 * 10^9
// bytes, each row counted with one byte more. On success the caller must release *png with olx_png_free, on failure it
// is NULL.
olx_result olx_png_encode(uint32_t width, uint32_t height, uint32_t channels, const uint8_t *pixels, uint8_t **png,
                          size_t *size_bytes);
void olx_png_free(uint8_t *png);
// Compresses 8-bit pixels of 3 (RGB) or 4 (RGBA, whose alpha is left out) channels, rows from the top, to a JPEG in
// memory; quality: 1 to 100. OLX_ERROR_ARGUMENT, with a message, for other channels and qualities, and for a picture
// without pixels, of more than 2 * 10^9 bytes, or of more than 65535 pixels a side. On success the caller must release
// *jpeg with olx_png_free, on failure it is NULL.
olx_result olx_jpeg_encode(uint32_t width, uint32_t height, uint32_t channels, const uint8_t *pixels, uint32_t quality,
                           uint8_t **jpeg, size_t *size_bytes);

// A ball in a diagram.
typedef struct olx_diagram_mark {
  olx_vec3 position, color;         // color: linear, 0 to 1
  float radius;                     // metres; limited in the picture by
  float least_pixels, most_pixels;  // these sizes
  uint32_t order;                   // marks of higher order are drawn over those of lower order
} olx_diagram_mark;

typedef struct olx_diagram_settings {
  const olx_camera *camera; // NULL: from above a corner, without the upper or the nearer half of the scene
  uint32_t width, height;   // 1 to 16384
  const olx_diagram_mark *marks;
  uint32_t mark_count;
  uint32_t threads; // 0: as many as the machine has; the picture does not depend on it
} olx_diagram_settings;

// Writes a .png of the scene's triangles, dim and flat, with the marks over them; marks behind a surface are fainter.
// *drawn, not NULL, receives the number of marks within the picture. Written through a temporary file that is synced
// and renamed.
olx_result olx_diagram_save(const olx_scene *scene, const olx_diagram_settings *settings, const char *path,
                            uint32_t *drawn);

typedef enum olx_method {
  OLX_METHOD_FIELD = 0, // indirect light from a field
  OLX_METHOD_PATH = 1,  // path tracing, the reference
  OLX_METHOD_CLASSIC = 2 // indirect light from a field's classic maps, irradiance probes without visibility
} olx_method;

typedef enum olx_diffuse {
  OLX_DIFFUSE_SURFACE = 0,    // from the light stored at surfaces (olx_surface_irradiance)
  OLX_DIFFUSE_IRRADIANCE = 1, // from irradiance probes (McGuire et al. section 5.2); needs a field with probe light
  OLX_DIFFUSE_TRACED = 2      // by cosine rays traced through the field (section 5, naive renderer)
} olx_diffuse;

typedef struct olx_render_settings {
  uint32_t width, height;    // 1 to 16384; default 1280 x 720
  uint32_t spp;              // camera samples a pixel, 1 to 2^20; 1 shoots through pixel centres; default 64 for path,
                             // 4 for field
  uint32_t bounces;          // path: indirect bounces (0: direct light only), or OLX_BOUNCES_INFINITE (the default)
  olx_method method;
  olx_diffuse diffuse;       // field; default OLX_DIFFUSE_SURFACE
  uint32_t diffuse_samples;  // field, traced: rays a camera sample, 1 to 4096; default 64
  uint32_t glossy_samples;   // field: rays a camera sample on glossy surfaces, 1 to 4096; default 4 (1 when smooth)
  uint32_t seed;             // a second seed gives other samples, so that two images have independent noise; default 0
  float dim_lobe;            // field: rough specular lobes that reflect less than this share, 0 to 1, towards the eye
                             // are not traced but take irradiance: that of surfaces with OLX_DIFFUSE_SURFACE and in
                             // fields without probe light, else that of irradiance probes; default 0 (section 6).
                             // With sample.emitters no lobe is dim: its rays find emitters, which irradiance leaves out
  bool centered;             // all camera samples of a pixel go through its centre; default false
  olx_denoise_settings denoise; // for olx_render_frames; default olx_denoise_settings_default()
  bool standard_error;       // also fill OLX_LAYER_STANDARD_ERROR, with 0 where spp is 1; default false
  uint32_t threads;          // 0: as many as the machine has; the image does not depend on it
  olx_sample_settings sample; // field: tracer, selector, visibility; default olx_sample_settings_default()
} olx_render_settings;

olx_render_settings olx_render_settings_default(olx_method method);

typedef struct olx_render_stats {
  double seconds;
  // Processor time of the workers, summed over threads; a path tracer sets only the first.
  double primary_seconds, direct_seconds, diffuse_seconds, glossy_seconds;
  double denoise_seconds; // elapsed time of denoising
  uint64_t rays;            // cast with Embree
  uint64_t field_rays;      // traced through the field
  uint64_t field_unresolved;
  uint64_t field_steps, field_probes; // texels whose distance those rays read, and probes they were traced through
} olx_render_stats;

// Renders `scene` from `camera`. `field` is needed for all methods except OLX_METHOD_PATH, where it may be NULL; a
// field baked from another scene causes a warning, and one relative to another origin OLX_ERROR_ARGUMENT, as does a
// camera whose target is its eye. On success the caller must free the image. stats may be NULL.
olx_result olx_render(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                      const olx_render_settings *settings, const olx_progress *progress, olx_image *image,
                      olx_render_stats *stats);

// Renders as a real-time renderer does: `count` frames, seen from cameras[0..count), each with one camera ray a pixel
// (through its centre) and one ray a lobe through the field, denoised over pixels and over frames; the image is the
// last frame. settings->diffuse chooses between a Lambertian ray (the paper's denoised mode) and light stored at
// surfaces or at irradiance probes; settings->spp is the number of samples of direct light in the last frame. Other
// numbers of samples, `bounces`, `centered` and `standard_error` have no effect; the method must be OLX_METHOD_FIELD.
// All else is as in olx_render.
olx_result olx_render_frames(const olx_scene *scene, const olx_field *field, const olx_camera *cameras, uint32_t count,
                             const olx_render_settings *settings, const olx_progress *progress, olx_image *image,
                             olx_render_stats *stats);

// The surfaces in a picture, for another renderer (octalux/vulkan.h) to light: pixel (x, y) at x + width * y. The
// surface of a pixel is at clip_to_world * (cx, cy, inverse_depth, 1), divided by w, where cx and cy run from -1 at the
// left and top edge of the picture to 1.
typedef struct olx_gbuffer {
  uint32_t width, height;
  float *inverse_depth; // 1 / distance along the viewing axis in metres; 0 where nothing is seen
  olx_vec3 *normal;     // shading normal, bent towards the eye where it faces away
  olx_vec3 *geometric_normal; // of the triangle, on the side of the eye
  olx_vec3 *vertex_normal;    // interpolated over the triangle, without a normal map, on the side of the eye
  olx_vec3 *base_color;
  olx_vec3 *material; // roughness, metallic, specular weight
  olx_vec3 eye;
  float clip_to_world[16]; // columns
} olx_gbuffer;

// Renders what needs no field: the surfaces, and every layer except the indirect ones, which are 0 here and in beauty.
// Camera rays go through pixel centres; settings->spp is the number of samples of direct light. The field is only
// checked to fit the scene. On success the caller must free the image and *gbuffer. stats may be NULL.
olx_result olx_render_surfaces(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                               const olx_render_settings *settings, const olx_progress *progress, olx_image *image,
                               olx_gbuffer *gbuffer, olx_render_stats *stats);
// Releases the planes; the caller owns the struct itself.
void olx_gbuffer_free(olx_gbuffer *gbuffer);

// The error of `a` against the reference `b` over one layer. Relative MSE is sum (a-b)^2 / sum b^2 and bias is sum
// (a-b) / sum b, over pixels and channels. PSNR is in dB over the reference's maximum, infinite for equal images; the
// shares are infinite when only the reference is black. `max` is the largest absolute difference.
typedef struct olx_metrics {
  double mse, relative_mse, psnr, bias, max;
} olx_metrics;

// Compares a layer of `a` with the reference `b`. OLX_ERROR_ARGUMENT when sizes differ or an image lacks the layer, as
// every image does for one that does not exist; OLX_ERROR_FORMAT, naming the pixel, when a value is not finite. Depth
// that is infinite in both images is left out.
olx_result olx_compare(const olx_image *a, const olx_image *b, olx_layer layer, olx_metrics *metrics);
// Writes a .png of |a - b| over the reference's mean (both averaged over channels), from black to yellow by its square
// root, with the scale from 0 to 100 % at the right, which makes it 60 pixels wider than the images. Fails as
// olx_compare does.
olx_result olx_compare_heatmap(const olx_image *a, const olx_image *b, olx_layer layer, const char *path);

// Returns whether a layer shows colours: every existing layer except normal and depth.
bool olx_layer_is_color(olx_layer layer);

typedef struct olx_perceptual_settings {
  float exposure;          // multiplies light before the tone map, above 0; default 1
  float pixels_per_degree; // in the viewer's eye, above 0, at most 1000; default 67: 3840 pixels on 0.7 m, seen from
                           // 0.7 m
  uint32_t threads;        // 0: as many as the machine has; the numbers do not depend on it
} olx_perceptual_settings;

olx_perceptual_settings olx_perceptual_settings_default(void);

// How similar two layers look as pictures, after tone mapping to the 8-bit sRGB of olx_image_save_layer_png.
typedef struct olx_perceptual {
  double ssim; // mean structural similarity of luma (Wang et al. 2004); 1: equal pictures; NaN below 11 pixels a side
  double flip; // mean LDR-FLIP (Andersson et al. 2020), 0 for equal pictures to 1
} olx_perceptual;

// Compares a colour layer of `a` with the reference `b`. flip_map may be NULL; else its width * height numbers receive
// the FLIP of every pixel. Fails as olx_compare does, and with OLX_ERROR_ARGUMENT for settings out of range.
olx_result olx_compare_perceptual(const olx_image *a, const olx_image *b, olx_layer layer,
                                  const olx_perceptual_settings *settings, float *flip_map, olx_perceptual *perceptual);
// Returns a colour of the palette of error maps: "magma" of matplotlib, from black (0) to a pale yellow (1).
void olx_magma(float value, uint8_t rgb[3]);
// Writes a FLIP map as .png, coloured by olx_magma, through a temporary file that is synced and renamed.
olx_result olx_flip_map_save(const float *flip_map, uint32_t width, uint32_t height, const char *path);

typedef struct olx_audit_settings {
  uint32_t rays;   // at most 2^30; default 200,000
  uint32_t points; // on surfaces, at most 2^30; default 2,000
  uint32_t space_points; // in free space, at most 2^26, six normals each, with spp / 16 + 1 paths in each of two
                         // halves; default 0
  uint32_t spp;     // paths a point for the reference irradiance, at least 1; default 1024
  uint32_t seed;    // of the random numbers; default 0
  uint32_t threads; // 0: as many as the machine has; the numbers do not depend on it
  const char *camera; // name of the camera whose surfaces are judged; NULL: all cameras
  olx_sample_settings sample;
} olx_audit_settings;

olx_audit_settings olx_audit_settings_default(void);

// The field compared with ray casting and path tracing; docs/studies/rays.md explains each number.
typedef struct olx_audit_rays {
  uint64_t count;
  double unresolved, wrong, unseen;           // shares of all rays
  double unresolved_seen, wrong_seen;         // shares of the rays whose true hit at least one probe sees
  double distance_error_median, distance_error_p99; // relative to the ray's length, over resolved rays
  double steps_mean, probes_mean;
} olx_audit_rays;

// Errors of indirect irradiance at random surface points; 0 where there are none.
typedef struct olx_audit_points {
  uint64_t count;
  double relative_mse, bias, leak;
} olx_audit_points;

typedef struct olx_audit {
  olx_audit_rays rays;        // both kinds
  olx_audit_rays cosine, mirror; // each kind alone
  olx_audit_points points;       // of olx_surface_irradiance, at all points
  olx_audit_points stored;       // where light is stored for the surface: a share of stored.count / points.count
  olx_audit_points fallen_back;  // where none is stored and the irradiance volume is used
  olx_audit_points irradiance;   // of olx_irradiance, at all points; 0 without probe light
  // At settings->space_points places of the space that the viewer reaches, with the noise of the reference removed;
  // count is the number of places times normals.
  olx_audit_points space_volume; // of olx_volume_irradiance
  olx_audit_points space_probes; // of olx_irradiance; 0 without probe light
  double space_served;           // share of the places at which the irradiance volume has a cell
} olx_audit;

// OLX_ERROR_ARGUMENT for settings out of range, for a camera that the scene lacks, and for a field relative to another
// origin. *audit is complete on success alone.
olx_result olx_audit_field(const olx_scene *scene, const olx_field *field, const olx_audit_settings *settings,
                           const olx_progress *progress, olx_audit *audit);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
