// Octalux on a Vulkan device: a baked field in the GPU's memory, and passes that add its indirect light to the host's
// picture.
//
// The host owns instance, device, queue, command buffers and images. Octalux creates only what this header names, calls
// Vulkan through the host's vkGetInstanceProcAddr and links no Vulkan library. It needs Vulkan 1.2, one queue with
// compute, and no feature, extension or limit beyond what every device has. The selectors cage, bricks, voronoi and
// exhaustive are supported; octree is OLX_ERROR_UNSUPPORTED, and so is a field whose irradiance probes are spherical
// harmonics (olx_bake_settings.irradiance_form).
//
// Two ways to use a field:
//   1. Record the passes below into the host's command buffers.
//   2. Include shaders/lib/octalux.glsl in the host's own shaders, bind olx_vulkan_field_set, and call
//      olx_surface_irradiance, olx_irradiance, olx_trace and olx_glossy there. The GLSL is installed in
//      share/octalux/shaders.
//
// Threads: calls on one handle must not overlap, except for recording into different command buffers. Creating a field,
// classic maps or a relighter submits to the queue and waits; the host must keep other threads off the queue meanwhile.
// Nothing may be destroyed or resized while a command buffer that uses it is pending. Descriptor sets and pipelines do
// not change between frames, so any number of frames may be in flight. Denoised frames depend on the history of earlier
// ones: they must be submitted to one queue in the order of their numbers, and the passes' own barriers let each frame
// wait for the last.
//
// Errors: OLX_ERROR_MEMORY when host or device memory is short, OLX_ERROR_UNSUPPORTED when the device lacks something,
// OLX_ERROR_ARGUMENT for a wrong format, layout or size, OLX_ERROR_GPU when the device is lost or refuses a call.
// olx_last_error names the failed call and its purpose. A failed create leaves nothing behind.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_VULKAN_H
#define OCTALUX_VULKAN_H

#include <octalux/denoiser.h>
#include <octalux/field.h>
#include <octalux/relight.h>
#include <octalux/sample.h>

#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

// The host's Vulkan objects, which must outlive everything created with them. The device must have been created for
// Vulkan 1.2 or later, and the queue's family must support compute.
typedef struct olx_vulkan_host {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue;
  uint32_t queue_family;
  // The cache with which every pipeline is created; it must not have been created externally synchronized.
  // VK_NULL_HANDLE: none.
  VkPipelineCache pipeline_cache;
  // Whether the device was created with the feature textureCompressionBC. It then holds light and material in the
  // field's blocks, except of a field with data for relighting, which writes texels. There, and without the feature,
  // blocks are decoded: light to four times its bytes, base colour to eight times, roughness and reflectance to twice
  // (octalux/field.h, olx_field_info.maps.compressed).
  bool texture_compression_bc;
} olx_vulkan_host;

// A field in the GPU's memory.
typedef struct olx_vulkan_field olx_vulkan_field;

typedef struct olx_vulkan_sizes {
  uint64_t device_bytes;  // in device-local memory, alignment included
  uint64_t classic_bytes; // for olx_vulkan_classic_create, in addition; 0 without classic maps, and of a frame
  uint64_t staging_bytes; // in host-visible memory, during creation alone
  uint32_t allocations;   // number of allocations of device memory
} olx_vulkan_sizes;

// Computes what olx_vulkan_field_create would allocate, and olx_vulkan_classic_create after it (one more allocation,
// and as much staging memory again). Allocates no memory itself.
olx_result olx_vulkan_field_measure(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_sizes *sizes);

// Copies a field to the device through a small ring of staging memory. The data is that of the file, except for blocks
// that the device cannot read, which are decoded. Returns when the copy is complete; `field` may then be closed. On
// success the caller must destroy *uploaded, on failure it is NULL.
olx_result olx_vulkan_field_create(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_field **uploaded);

// Destroys a field. NULL is allowed. Frames created from it must be destroyed first.
void olx_vulkan_field_destroy(olx_vulkan_field *field);

// Returns the descriptor set that shaders/lib reads, or its layout, for the host's own pipelines that include the
// library. Both belong to the field and are visible to vertex, fragment and compute shaders.
VkDescriptorSetLayout olx_vulkan_field_set_layout(const olx_vulkan_field *field);
VkDescriptorSet olx_vulkan_field_set(const olx_vulkan_field *field);

// Returns the selector that the device uses for `asked`: for OLX_SELECT_BEST the best of the field's selectors that the
// device supports, and OLX_SELECT_EXHAUSTIVE for one that the field does not have. The host's own pipelines that trace
// rays take it as the specialisation constant OLX_CONSTANT_SELECT of shaders/octalux_shared.h, unless it is
// OLX_SELECT_BRICKS, the constant's default.
olx_select olx_vulkan_field_select(const olx_vulkan_field *field, olx_select asked);

// An image that passes sample. `layout` is its layout while the passes run: VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
// GENERAL, or a read-only depth layout. The view shows one 2D layer and mip; its components may be swizzled.
typedef struct olx_vulkan_image {
  VkImageView view;
  VkFormat format;
  VkImageLayout layout;
} olx_vulkan_image;

// The two kinds of indirect light, as bits of a mask.
enum { OLX_VULKAN_LOBE_DIFFUSE = 1, OLX_VULKAN_LOBE_GLOSSY = 2 };

// The passes whose pipelines are created with a frame, as bits of a mask. The pipelines of olx_vulkan_record_denoise
// are created when targets.denoise names a lobe, and that of classic maps by olx_vulkan_classic_create.
enum {
  OLX_VULKAN_PASS_IRRADIANCE = 1,
  OLX_VULKAN_PASS_DIFFUSE = 2,
  OLX_VULKAN_PASS_GLOSSY = 4,
  OLX_VULKAN_PASS_COMPOSITE = 8
};

// The host's images, all of one size. Inputs need VK_IMAGE_USAGE_SAMPLED_BIT and one of these formats: 1, 2 or 4
// channels of 8 or 16 bits as UNORM, or of 16 or 32 bits as SFLOAT; 4 channels of 8 bits as SRGB, or of 8 or 16 bits in
// the order RGBA as SNORM; 10-bit UNORM; B10G11R11; or any with depth. Outputs need VK_IMAGE_USAGE_STORAGE_BIT, format
// VK_FORMAT_R16G16B16A16_SFLOAT, and layout GENERAL while passes run. All images but the optional ones are required,
// whatever `passes` names: OLX_ERROR_ARGUMENT without one of them.
typedef struct olx_vulkan_targets {
  uint32_t width, height;     // 1 to 16384
  olx_vulkan_image depth;     // as the host's projection gives it; .r
  olx_vulkan_image normal;    // world space, .xyz, flipped on back faces; UNORM formats hold n / 2 + 1 / 2. Those that
                              // face away from the eye by interpolation or a normal map are turned towards it
  olx_vulkan_image albedo;    // linear base colour, .rgb (sRGB formats decode themselves)
  olx_vulkan_image roughness; // .r perceptual roughness, .g metallic, .b specular weight (1: F0 = 0.04; 0: Lambertian).
      // A view with swizzles maps other packings; VK_COMPONENT_SWIZZLE_ONE fills a missing weight
  // Optional; a view of VK_NULL_HANDLE: none. From these three olx_vulkan_record_irradiance finds which stored surface
  // a pixel shows (octalux/sample.h, olx_surface_irradiance). Normals are in world space, .xyz, as in `normal`.
  // The normal of the triangle, of either side; olx_vulkan_record_diffuse and olx_vulkan_record_glossy trace no ray
  // behind it. None: it is derived from depth, which needs 24 bits or more, and rays are traced in all directions.
  olx_vulkan_image geometric_normal;
  // The normal interpolated between the triangle's corners, on the side towards the eye; `normal` is this one bent by
  // normal maps. None: `normal` replaces it, and normal maps do not show in stored light.
  olx_vulkan_image vertex_normal;
  // An image whose red channel is above 0.5 where a pixel shows an object that was not there when the field was baked,
  // or has moved since: such pixels take the irradiance volume. None: there is no such object.
  olx_vulkan_image dynamic;
  VkImageView irradiance; // out: W/m^2; alpha 1 where there is a surface
  VkImageView glossy;     // out: radiance towards the eye; alpha: the share of resolved rays
  VkImageView color;      // in and out: the host's picture in linear radiance
  uint32_t denoise;       // OLX_VULKAN_LOBE_*: lobes with a history; 0: none, and no memory
  uint32_t passes;        // OLX_VULKAN_PASS_*: the passes that will be recorded; 0: all
  // The tracers, selectors and kinds of light at the end of rays that settings will name, as bits 1 << olx_tracer, 1 <<
  // olx_select and 1 << olx_hits. Each combination has a pipeline of its own, created here, so that recording creates
  // none. 0: OLX_TRACER_HIZ; OLX_SELECT_BEST; OLX_HITS_SHADED. OLX_HITS_STORED needs a field with probe light, which
  // keeps the light of the bake when a relighter changes the field's lights.
  uint32_t tracers, selects, hits;
} olx_vulkan_targets;

// Pipelines, descriptor sets for one set of the host's images, and the denoiser's history, which belongs to the frame:
// 32 bytes a pixel and 16 for each lobe in device-local memory.
typedef struct olx_vulkan_frame olx_vulkan_frame;

// Computes what olx_vulkan_frame_create would allocate; staging_bytes is 0. Allocates no memory itself. Until it
// returns, olx_vulkan_frame_resize needs as much in addition to what the frame holds.
olx_result olx_vulkan_frame_measure(const olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                    olx_vulkan_sizes *sizes);

// Creates a frame. On success the caller must destroy *frame, on failure it is NULL.
olx_result olx_vulkan_frame_create(olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                   olx_vulkan_frame **frame);

// Replaces the images by others, of this or another size, with or without a history. The history starts again: the next
// denoised frame has the number 0. Passes, tracers, selectors and kinds of light that targets name and the frame lacks
// are added to those that it has. On failure the frame keeps its images and its history.
olx_result olx_vulkan_frame_resize(olx_vulkan_frame *frame, const olx_vulkan_targets *targets);

// Destroys a frame. NULL is allowed. The host's images are not touched.
void olx_vulkan_frame_destroy(olx_vulkan_frame *frame);

// The view of the eye. A pixel's surface is at clip_to_world * (x, y, depth, 1), divided by w, with x and y from -1 at
// the left and top edge of the image to 1: the matrix is the inverse of the host's projection times view, in Vulkan's
// clip space.
typedef struct olx_vulkan_view {
  float clip_to_world[16]; // columns
  olx_vec3 eye;            // metres, world space
  float empty_depth;       // the depth image's value where there is no surface: 1, or 0 with a reversed depth range
} olx_vulkan_view;

// The separated denoiser of McGuire et al. 2017, section 5.1 (docs/denoising.md).
typedef struct olx_vulkan_denoise {
  uint32_t lobes;               // OLX_VULKAN_LOBE_*, of those in targets.denoise: lobes to denoise; default 0
  olx_denoise_settings filters; // default olx_denoise_settings_default()
  // The number of the denoised frame. 0 discards the history and prepares its images: the first frame after creation or
  // resizing is 0, and so is a frame that denoises other lobes than the last one. All passes of a frame have the same
  // number; the next frame has one more.
  uint32_t frame;
  olx_vulkan_view previous; // the view of the previous frame; not read in frame 0
} olx_vulkan_denoise;

typedef struct olx_vulkan_settings {
  olx_sample_settings sample; // default olx_sample_settings_default()
  uint32_t diffuse_samples;   // rays a pixel of olx_vulkan_record_diffuse, 1 to 4096; default 1
  uint32_t glossy_samples;    // rays a pixel on glossy surfaces, 1 to 4096; default 1. Mirrors take 1
  uint32_t sample_index;      // the part of a pixel's sequence of random numbers: count frames here; default 0
  uint32_t seed;              // selects the sequence of every pixel; default 0
  bool irradiance_probes;     // irradiance from irradiance probes alone, in a field with probe light; default false
  float dim_lobe; // rough specular lobes that reflect less than this share, 0 to 1, towards the eye are not traced but
                  // take irradiance; default 0 (section 6). With sample.emitters no lobe is dim
  olx_vulkan_denoise denoise;
} olx_vulkan_settings;

olx_vulkan_settings olx_vulkan_settings_default(void);

// Recording. Call these outside a render pass, in a command buffer of the field's queue family. Each call binds a
// compute pipeline, descriptor sets 0 to 2, and push constants. OLX_ERROR_ARGUMENT for a pass, a tracer, a selector or
// a kind of hit light for which the frame has no pipeline, and for settings out of range; OLX_ERROR_UNSUPPORTED for a
// selector that does not run on devices.
//
// The host records the barriers at both ends, and Octalux those between passes. Before the first pass, the inputs'
// writes and earlier uses of the outputs must be ordered before VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT with shader read
// and write. olx_vulkan_record_composite and olx_vulkan_record_denoise begin with a barrier that waits for the passes
// recorded before them. After the last pass, outputs have been written by VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
// VK_ACCESS_SHADER_WRITE_BIT.
//
// The paper's three ways to light a picture (section 5):
//   gathered     olx_vulkan_record_diffuse, _glossy, _composite, with many samples: the reference
//   denoised     olx_vulkan_record_diffuse, _glossy, _denoise, _composite, one sample each, denoise.lobes both
//   prefiltered  olx_vulkan_record_irradiance, _glossy, _denoise, _composite, denoise.lobes OLX_VULKAN_LOBE_GLOSSY

// Records diffuse light: targets.irradiance from the light that the field stores for surfaces (octalux/sample.h,
// olx_surface_irradiance), and from the irradiance volume (olx_volume_irradiance) where none is stored and on dynamic
// objects; from irradiance probes in a field without a volume. With settings->irradiance_probes, from irradiance probes
// (McGuire et al. 2017, section 5.2).
olx_result olx_vulkan_record_irradiance(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                        const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Records diffuse light: targets.irradiance by cosine-distributed rays traced through the light field probes (section
// 5).
olx_result olx_vulkan_record_diffuse(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                     const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Records glossy light: targets.glossy by rays traced through the light field probes (section 4).
olx_result olx_vulkan_record_glossy(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                    const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Records the denoiser for the lobes of settings->denoise.lobes, whose rays olx_vulkan_record_diffuse and
// olx_vulkan_record_glossy have traced with the same view and settings: targets.irradiance and targets.glossy are
// replaced, and alpha stays; a pixel that did not trace in this frame (olx_denoise_settings.ray_spacing) has the alpha
// of the pixel that did. View and previous view must be perspective projections from their eye; they may be jittered.
// Light on moving surfaces loses its history, because history is found at a surface's former place in the world.
olx_result olx_vulkan_record_denoise(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                     const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Bits for what the composite pass adds to targets.color.
enum { OLX_VULKAN_ADD_DIFFUSE = 1, OLX_VULKAN_ADD_GLOSSY = 2 };
// Records the sum: adds the indirect light that `add` names to targets.color. OLX_ERROR_ARGUMENT for other bits.
olx_result olx_vulkan_record_composite(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                       const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t add);

// A field's classic maps on the device: irradiance probes without visibility, the method that light field probes
// replace (octalux/sample.h, olx_classic_irradiance).
typedef struct olx_vulkan_classic olx_vulkan_classic;

// Copies the classic maps of `field` to the device of `uploaded`, which was created from it, and creates the pass.
// OLX_ERROR_ARGUMENT when the field was baked without them. On success the caller must destroy *classic, before
// `uploaded`; on failure it is NULL.
olx_result olx_vulkan_classic_create(olx_vulkan_field *uploaded, const olx_field *field, olx_vulkan_classic **classic);
// Destroys classic maps. NULL is allowed.
void olx_vulkan_classic_destroy(olx_vulkan_classic *classic);

// Returns the descriptor set that shaders/lib/classic.glsl reads in addition to the field's, or its layout. Both belong
// to `classic` and are visible to vertex, fragment and compute shaders.
VkDescriptorSetLayout olx_vulkan_classic_set_layout(const olx_vulkan_classic *classic);
VkDescriptorSet olx_vulkan_classic_set(const olx_vulkan_classic *classic);

// Records diffuse and glossy light: targets.irradiance and targets.glossy from classic maps, instead of the passes
// above. Also binds descriptor set 3. The frame must belong to the same uploaded field.
olx_result olx_vulkan_record_classic(const olx_vulkan_frame *frame, const olx_vulkan_classic *classic,
                                     VkCommandBuffer commands, const olx_vulkan_view *view,
                                     const olx_vulkan_settings *settings);

// ---- Lights that change: updates copy the maps that a relighter (octalux/relight.h) has changed to a field on the
// device.
typedef struct olx_vulkan_update olx_vulkan_update;

typedef struct olx_vulkan_update_settings {
  // The most bytes that one call copies, 1 to 2^28; default 8 MiB. A call can always copy one part. The rest waits for
  // later calls, and nothing waits forever.
  uint32_t bytes;
  uint32_t in_flight; // calls whose commands may be pending together, 1 to 8; default 2
} olx_vulkan_update_settings;

olx_vulkan_update_settings olx_vulkan_update_settings_default(void);

// The work of a call.
typedef struct olx_vulkan_update_stats {
  uint64_t bytes, waiting_bytes; // copied; changed but not copied yet
  uint32_t tiles;                // of light field maps, up to 32 x 32 texels each
  uint32_t volume_probes;        // of the irradiance volume
} olx_vulkan_update_stats;

// Creates an update, with host-visible memory for in_flight times the bytes of a call. `uploaded` was created from the
// relighter's field or from that field's source; both must outlive the update. OLX_ERROR_ARGUMENT for settings out of
// range and for any other field. On success the caller must destroy *update, on failure it is NULL.
olx_result olx_vulkan_update_create(olx_vulkan_field *uploaded, const olx_relight *relight,
                                    const olx_vulkan_update_settings *settings, olx_vulkan_update **update);
// Destroys an update. NULL is allowed. No command recorded with it may be pending.
void olx_vulkan_update_destroy(olx_vulkan_update *update);

// Records copies of what olx_relight_frame has changed since the last call. Call it outside a render pass and not
// during olx_relight_frame or olx_relight_set_lights, in a command buffer for the queue on which the field is used; the
// command buffer recorded in_flight calls ago must have finished. The copies wait for all earlier commands, and all
// later commands wait for them. They are not recorded again, so the commands must be submitted. Records nothing when
// nothing has changed. stats may be NULL.
olx_result olx_vulkan_record_update(olx_vulkan_update *update, VkCommandBuffer commands,
                                    olx_vulkan_update_stats *stats);

// ---- Lights that change: frames of a relighter (octalux/relight.h) as compute passes on the device. The host calls
// olx_vulkan_record_relight instead of olx_relight_frame and olx_vulkan_record_update; all else stays the same.
typedef struct olx_vulkan_relight olx_vulkan_relight;

typedef struct olx_vulkan_relight_settings {
  uint32_t in_flight; // calls whose commands may be pending together, 1 to 8; default 2
} olx_vulkan_relight_settings;

olx_vulkan_relight_settings olx_vulkan_relight_settings_default(void);

// Computes what olx_vulkan_relight_create would allocate; staging_bytes includes 8 permanent bytes for each 64 surfels
// and each frame in flight. Allocates no memory itself. Fails like olx_vulkan_relight_create.
olx_result olx_vulkan_relight_measure(olx_vulkan_field *uploaded, olx_relight *relight,
                                      const olx_vulkan_relight_settings *settings, olx_vulkan_sizes *sizes);

// Takes over the frames of a relighter that has not run any: its light is copied to the device, olx_relight_frame fails
// from then on, and the maps and the volume of olx_relight_field keep the light that they have then. The relighter
// still owns lights and settings: budgets, samples, sleep. `uploaded` was created from the relighter's field or from
// that field's source; both must outlive this object. OLX_ERROR_ARGUMENT, with a message, for settings out of range,
// another field, a relighter that has run frames or has an occlusion function (shadow rays are traced through the
// field). OLX_ERROR_UNSUPPORTED where surfels and their links, or sites, or 20 bytes for each texel that a frame lights
// would exceed a storage buffer of the device. Submits to the queue and waits, like the creation of a field. On success
// the caller must destroy *created; on failure it is NULL and the relighter is unchanged.
olx_result olx_vulkan_relight_create(olx_vulkan_field *uploaded, olx_relight *relight,
                                     const olx_vulkan_relight_settings *settings, olx_vulkan_relight **created);
// Destroys it. NULL is allowed. No command recorded with it may be pending. The relighter can run no more frames.
void olx_vulkan_relight_destroy(olx_vulkan_relight *relight);

// The work of a frame.
typedef struct olx_vulkan_relight_stats {
  uint32_t surfels_lit, surfels_gathered; // get a sample of direct light; gather light from others
  uint64_t texels;                        // of the maps of light field probes
  uint32_t volume_probes;
  uint32_t awake; // tiles, surfels and volume probes that wait, as far as is known; 0: all light has settled
} olx_vulkan_relight_stats;

// Records one frame, seen from `eye` (metres). The CPU schedules and the device lights; all later commands see the
// field with this frame's light. Call it outside a render pass, in a command buffer for the queue on which the field is
// used; the command buffer recorded in_flight calls ago must have finished, because this call reads how much light that
// frame changed. It does not wait. The frame waits for all earlier commands, and must be submitted in the order of the
// calls. Binds compute pipelines, sets 0 and 1, and push constants. Records nothing when nothing is awake. stats may be
// NULL. It counts as a call on the relighter, so it must not overlap another one. Unlike with olx_relight_frame, a
// round of bounces wakes tiles and volume probes in_flight frames later, and the budget also counts shadow rays that
// are not needed because the light is behind its surface.
olx_result olx_vulkan_record_relight(olx_vulkan_relight *relight, VkCommandBuffer commands, olx_vec3 eye,
                                     olx_vulkan_relight_stats *stats);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
