// Octalux on a Vulkan device: a baked field in the GPU's memory, and passes that add its indirect light to the host's
// picture.
//
// The host owns instance, device, queue, command buffers and images; Octalux creates only what it names here, reaches
// Vulkan through the host's vkGetInstanceProcAddr and links no Vulkan library. It needs Vulkan 1.2, one queue with
// compute, and no feature, extension or limit beyond what every device has. The selectors cage, bricks, voronoi and
// exhaustive run there; naming octree is OLX_ERROR_UNSUPPORTED.
//
// Two ways to use a field:
//   1. Record the passes below into the host's command buffers.
//   2. Include shaders/lib/octalux.glsl in the host's own shaders, bind olx_vulkan_field_set, and call
//      olx_surface_irradiance, olx_irradiance, olx_trace and olx_glossy there. The GLSL is installed in share/octalux/shaders.
//
// Threads: calls on one handle must not overlap, but for recording into different command buffers. Creating a field
// submits to the queue and waits: the host keeps other threads off the queue meanwhile. Nothing may be destroyed or
// resized while a command buffer that uses it is pending. Descriptor sets and pipelines do not change between frames,
// so any number of frames may be in flight. Those that are denoised hand their history on: they are submitted to one
// queue, in the order of their numbers, and the passes' own barriers let each wait for the one before.
//
// Errors: OLX_ERROR_MEMORY when host or device memory is short, OLX_ERROR_UNSUPPORTED when the device cannot do it,
// OLX_ERROR_ARGUMENT for a wrong format, layout or size, OLX_ERROR_GPU when the device is lost or refuses.
// olx_last_error says which call failed and on what. A failed create leaves nothing behind.
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

// The host's Vulkan. Everything must outlive what is created with it. The device must have been created for Vulkan 1.2
// or later, the queue's family must do compute.
typedef struct olx_vulkan_host {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue;
  uint32_t queue_family;
  // Every pipeline is created with it; it must not have been created externally synchronized. VK_NULL_HANDLE: none.
  VkPipelineCache pipeline_cache;
  // The device was created with the feature textureCompressionBC: it holds light and material as a field has them, 3.5
  // bytes a texel, which else are decoded to 14 (octalux/field.h, olx_field_info.compressed).
  bool texture_compression_bc;
} olx_vulkan_host;

// A field in the GPU's memory.
typedef struct olx_vulkan_field olx_vulkan_field;

typedef struct olx_vulkan_sizes {
  uint64_t device_bytes;  // that will be held in device-local memory, alignment included
  uint64_t classic_bytes; // olx_vulkan_classic_create would hold beside them; 0 without classic maps, and of a frame
  uint64_t staging_bytes; // of host-visible memory, while it is created
  uint32_t allocations;   // of device memory
} olx_vulkan_sizes;

// What olx_vulkan_field_create would allocate, and olx_vulkan_classic_create after it (one more allocation, and as much
// staging memory again). Allocates no memory itself.
olx_result olx_vulkan_field_measure(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_sizes *sizes);

// Copy a field to the device, as it lies in its file but for blocks that the device cannot read, through a small ring
// of staging memory. Returns when the copy is complete; `field` may then be closed. On success *uploaded is the
// caller's to destroy, on failure it is NULL.
olx_result olx_vulkan_field_create(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_field **uploaded);

// NULL is allowed. Frames made from it must be destroyed before.
void olx_vulkan_field_destroy(olx_vulkan_field *field);

// The descriptor set that shaders/lib reads, and its layout: for pipelines of the host that include the library. Both
// belong to the field. Visible to vertex, fragment and compute shaders.
VkDescriptorSetLayout olx_vulkan_field_set_layout(const olx_vulkan_field *field);
VkDescriptorSet olx_vulkan_field_set(const olx_vulkan_field *field);

// The selector that answers for `asked` on the device: of OLX_SELECT_BEST the best of those that the field has and that
// run there, of one that it has not OLX_SELECT_EXHAUSTIVE. Pipelines of the host that trace rays take it as the
// specialisation constant OLX_CONSTANT_SELECT of shaders/octalux_shared.h, unless it is OLX_SELECT_BRICKS, the
// constant's default.
olx_select olx_vulkan_field_select(const olx_vulkan_field *field, olx_select asked);

// An image that passes sample. `layout` is the one it will have while the passes run:
// VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, GENERAL, or a read-only depth layout. The view shows one 2D layer and mip;
// its components may be swizzled.
typedef struct olx_vulkan_image {
  VkImageView view;
  VkFormat format;
  VkImageLayout layout;
} olx_vulkan_image;

// The two kinds of indirect light, as bits of a mask.
enum { OLX_VULKAN_LOBE_DIFFUSE = 1, OLX_VULKAN_LOBE_GLOSSY = 2 };

// The passes whose pipelines are made with a frame, as bits of a mask. Those of olx_vulkan_record_denoise are made when
// targets.denoise names a lobe, the baseline's by olx_vulkan_classic_create.
enum {
  OLX_VULKAN_PASS_IRRADIANCE = 1,
  OLX_VULKAN_PASS_DIFFUSE = 2,
  OLX_VULKAN_PASS_GLOSSY = 4,
  OLX_VULKAN_PASS_COMPOSITE = 8
};

// The host's images, all of one size. Inputs need VK_IMAGE_USAGE_SAMPLED_BIT and a format that shaders read as floats.
// Outputs need VK_IMAGE_USAGE_STORAGE_BIT, format VK_FORMAT_R16G16B16A16_SFLOAT, and layout GENERAL while passes run.
typedef struct olx_vulkan_targets {
  uint32_t width, height;     // 1 to 16384
  olx_vulkan_image depth;     // as the host's projection gives it; .r
  olx_vulkan_image normal;    // world space, .xyz; UNORM formats hold n / 2 + 1 / 2
  olx_vulkan_image albedo;    // linear base colour, .rgb (sRGB formats decode themselves)
  olx_vulkan_image roughness; // .r perceptual roughness, .g metallic, .b specular weight (1: F0 = 0.04; 0: Lambertian).
      // A view with swizzles maps other packings; VK_COMPONENT_SWIZZLE_ONE fills a missing weight
  // Optional; a view of VK_NULL_HANDLE: none. From these three olx_vulkan_record_irradiance finds which stored surface
  // a pixel shows (octalux/sample.h, olx_surface_irradiance). Normals are in world space, .xyz, as in `normal`.
  olx_vulkan_image geometric_normal; // of the triangle, of either side. None: it is derived from depth, which wants 24 bits or more
  olx_vulkan_image vertex_normal; // between the triangle's corners, on the side that is looked at, and `normal` is this one bent by
      // normal maps. None: `normal` stands for it, and normal maps do not show in light that is stored
  olx_vulkan_image dynamic; // .r above 0.5 where a pixel shows what was not there when the field was baked, or has moved since: it
      // takes the irradiance volume. None: nothing has
  VkImageView irradiance; // out: W/m^2; alpha 1 where there is a surface
  VkImageView glossy;     // out: radiance towards the eye; alpha: the share of rays that were answered
  VkImageView color;      // in and out: the host's picture in linear radiance
  uint32_t denoise;       // OLX_VULKAN_LOBE_*: lobes to keep a history for; 0: none, and no memory
  uint32_t passes;        // OLX_VULKAN_PASS_*: those that will be recorded; 0: all
  // Tracers, selectors and kinds of light at the end of rays that settings will name, as bits 1 << olx_tracer, 1 <<
  // olx_select and 1 << olx_hits. Each three have a pipeline of their own, made here, so that recording makes none. 0:
  // OLX_TRACER_HIZ; OLX_SELECT_BEST; OLX_HITS_SHADED. Naming OLX_HITS_STORED needs a field with probe light; once a
  // relighter changes the field's lights, that is still the light of the bake.
  uint32_t tracers, selects, hits;
} olx_vulkan_targets;

// Pipelines, descriptor sets for one set of the host's images, and the denoiser's history, which is ours: 32 bytes a
// pixel and 16 for each lobe in device-local memory.
typedef struct olx_vulkan_frame olx_vulkan_frame;

// What olx_vulkan_frame_create would allocate; staging_bytes is 0. Allocates no memory itself. olx_vulkan_frame_resize
// needs as much beside what the frame holds, until it returns.
olx_result olx_vulkan_frame_measure(const olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                    olx_vulkan_sizes *sizes);

// On success *frame is the caller's to destroy, on failure it is NULL.
olx_result olx_vulkan_frame_create(olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                   olx_vulkan_frame **frame);

// Take other images, of this or another size, with a history or without. The history begins anew: the next denoised
// frame has the number 0. Passes, tracers, selectors and kinds of light that targets name and the frame lacks are added
// to those that it has. On failure the frame keeps what it had.
olx_result olx_vulkan_frame_resize(olx_vulkan_frame *frame, const olx_vulkan_targets *targets);

// NULL is allowed. The host's images are not touched.
void olx_vulkan_frame_destroy(olx_vulkan_frame *frame);

// Where the eye is. A pixel's surface is clip_to_world * (x, y, depth, 1), divided by w, with x and y from -1 at the
// left and top edge of the image to 1: the inverse of the host's projection times view, as Vulkan's clip space has it.
typedef struct olx_vulkan_view {
  float clip_to_world[16]; // columns
  olx_vec3 eye;            // metres, world space
  float empty_depth;       // what the depth image holds where no surface is: 1, or 0 with a reversed depth range
} olx_vulkan_view;

// The separated denoiser of McGuire et al. 2017, section 5.1 (docs/denoising.md).
typedef struct olx_vulkan_denoise {
  uint32_t lobes;               // OLX_VULKAN_LOBE_*, of those in targets.denoise: what this frame denoises; default 0
  olx_denoise_settings filters; // default olx_denoise_settings_default()
  // Counts frames that are denoised. 0 forgets everything and makes the images of the history ready: the first frame
  // after creation or resizing is 0, and so is one that denoises other lobes than the frame before. The number is the
  // same for all passes of a frame, and then one more.
  uint32_t frame;
  olx_vulkan_view previous; // the view of the frame before; not read in frame 0
} olx_vulkan_denoise;

typedef struct olx_vulkan_settings {
  olx_sample_settings sample; // default olx_sample_settings_default()
  uint32_t diffuse_samples;   // rays a pixel of olx_vulkan_record_diffuse, 1 to 4096; default 1
  uint32_t glossy_samples;    // rays a pixel on glossy surfaces, 1 to 4096; default 1. Mirrors take 1
  uint32_t sample_index;      // which part of a pixel's sequence of random numbers: count frames here; default 0
  uint32_t seed;              // another sequence for every pixel; default 0
  bool irradiance_probes; // irradiance comes from irradiance probes alone, of a field with probe light; default false
  float dim_lobe; // rough specular lobes that reflect less than this share towards the eye are not traced but
                  // take irradiance; default 0 (section 6)
  olx_vulkan_denoise denoise;
} olx_vulkan_settings;

olx_vulkan_settings olx_vulkan_settings_default(void);

// Recording. Call outside a render pass, in a command buffer of the field's queue family. Each call binds a compute
// pipeline, descriptor sets 0 and 1, and push constants. A pass, a tracer, a selector or light of hits that the frame
// was made without is OLX_ERROR_ARGUMENT.
//
// Barriers are the host's at both ends and ours between: before the first pass, the inputs' writes and earlier uses of
// the outputs must be ordered before VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT with shader read and write;
// olx_vulkan_record_composite and olx_vulkan_record_denoise begin with a barrier that waits for the passes recorded
// before them; after the last pass, outputs have been written by VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
// VK_ACCESS_SHADER_WRITE_BIT.
//
// The paper's three ways to light a picture (section 5):
//   gathered     olx_vulkan_record_diffuse, _glossy, _composite, with many samples: the reference
//   denoised     olx_vulkan_record_diffuse, _glossy, _denoise, _composite, one sample each, denoise.lobes both
//   prefiltered  olx_vulkan_record_irradiance, _glossy, _denoise, _composite, denoise.lobes OLX_VULKAN_LOBE_GLOSSY

// Diffuse: targets.irradiance from the light that the field stores where surfaces are (octalux/sample.h,
// olx_surface_irradiance), and where nothing is stored and on dynamic objects from the irradiance volume
// (olx_volume_irradiance). With settings->irradiance_probes, from irradiance probes (McGuire et al. 2017, section 5.2).
olx_result olx_vulkan_record_irradiance(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                        const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Diffuse: targets.irradiance by cosine-distributed rays traced through the light field probes (section 5).
olx_result olx_vulkan_record_diffuse(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                     const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Glossy: targets.glossy by rays traced through the light field probes (section 4).
olx_result olx_vulkan_record_glossy(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                    const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// Denoise the lobes of settings->denoise.lobes, whose rays olx_vulkan_record_diffuse and olx_vulkan_record_glossy have
// traced before with the same view and settings: targets.irradiance and targets.glossy are replaced, alpha stays. View
// and previous view are perspective projections from their eye; they may be jittered. Light that moves with a surface
// is lost: history is found where a surface was in the world.
olx_result olx_vulkan_record_denoise(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                     const olx_vulkan_view *view, const olx_vulkan_settings *settings);

// What the composite pass adds to targets.color.
enum { OLX_VULKAN_ADD_DIFFUSE = 1, OLX_VULKAN_ADD_GLOSSY = 2 };
olx_result olx_vulkan_record_composite(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                       const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t add);

// The baseline that light field probes replace (octalux/sample.h, olx_classic_irradiance): a field's classic maps on
// the device.
typedef struct olx_vulkan_classic olx_vulkan_classic;

// Copy the classic maps of `field` beside `uploaded`, which was made from it, and make the pass. OLX_ERROR_ARGUMENT
// when the field was baked without. On success *classic is the caller's to destroy, before the field; on failure it is
// NULL.
olx_result olx_vulkan_classic_create(olx_vulkan_field *uploaded, const olx_field *field, olx_vulkan_classic **classic);
// NULL is allowed.
void olx_vulkan_classic_destroy(olx_vulkan_classic *classic);

// The descriptor set that shaders/lib/classic.glsl reads beside the field's, and its layout. Both belong to `classic`.
VkDescriptorSetLayout olx_vulkan_classic_set_layout(const olx_vulkan_classic *classic);
VkDescriptorSet olx_vulkan_classic_set(const olx_vulkan_classic *classic);

// Diffuse and glossy: targets.irradiance and targets.glossy from classic maps, instead of the passes above. Binds
// descriptor set 3, too. The frame must be of the same uploaded field.
olx_result olx_vulkan_record_classic(const olx_vulkan_frame *frame, const olx_vulkan_classic *classic,
                                     VkCommandBuffer commands, const olx_vulkan_view *view,
                                     const olx_vulkan_settings *settings);

// ---- Lights that change: a field on the device that follows a relighter (octalux/relight.h) by copies of the maps
// that it changed.
typedef struct olx_vulkan_update olx_vulkan_update;

typedef struct olx_vulkan_update_settings {
  // Copied by one call at most, 1 to 2^28; default 8 MiB. A call can copy a part in any case. What is left waits for
  // the next call, and nothing waits for ever.
  uint32_t bytes;
  uint32_t in_flight; // calls whose commands may be pending together, 1 to 8; default 2
} olx_vulkan_update_settings;

olx_vulkan_update_settings olx_vulkan_update_settings_default(void);

// The work that a call did.
typedef struct olx_vulkan_update_stats {
  uint64_t bytes, waiting_bytes; // copied; changed, and not copied yet
  uint32_t tiles;                // of light field maps, up to 32 x 32 texels each
  uint32_t volume_probes;        // of the irradiance volume
} olx_vulkan_update_stats;

// Host-visible memory for in_flight times the bytes of a call. `uploaded` was made from the relighter's field or from
// the one that it was made from; both must outlive the update. OLX_ERROR_ARGUMENT for settings out of range and another
// field. On success *update is the caller's to destroy, on failure it is NULL.
olx_result olx_vulkan_update_create(olx_vulkan_field *uploaded, const olx_relight *relight,
                                    const olx_vulkan_update_settings *settings, olx_vulkan_update **update);
// NULL is allowed. Nothing that was recorded with it may be pending.
void olx_vulkan_update_destroy(olx_vulkan_update *update);

// Copy what olx_relight_frame has changed since. Call outside a render pass and not during olx_relight_frame, in a
// command buffer for the queue on which the field is used; the one that was recorded in_flight calls ago must have
// finished. The copies wait for all commands before and all commands after wait for them; they are not copied a second
// time, so the commands have to be submitted. Nothing is recorded when nothing has changed. stats may be NULL.
olx_result olx_vulkan_record_update(olx_vulkan_update *update, VkCommandBuffer commands,
                                    olx_vulkan_update_stats *stats);

// ---- Lights that change: frames of a relighter made on the device, as compute passes. The host of a relighter
// (octalux/relight.h) goes on as before, and calls olx_vulkan_record_relight in the place of olx_relight_frame and
// olx_vulkan_record_update.
typedef struct olx_vulkan_relight olx_vulkan_relight;

typedef struct olx_vulkan_relight_settings {
  uint32_t in_flight; // calls whose commands may be pending together, 1 to 8; default 2
} olx_vulkan_relight_settings;

olx_vulkan_relight_settings olx_vulkan_relight_settings_default(void);

// What olx_vulkan_relight_create would allocate; staging_bytes counts 8 bytes for 64 surfels and frame in flight that
// stay. Allocates no memory itself. Fails like olx_vulkan_relight_create.
olx_result olx_vulkan_relight_measure(olx_vulkan_field *uploaded, olx_relight *relight,
                                      const olx_vulkan_relight_settings *settings, olx_vulkan_sizes *sizes);

// Take over the frames of a relighter that has made none yet: its light goes to the device, and olx_relight_frame is an
// error from then on. Lights and settings stay the relighter's: budgets, samples, what sleeps. `uploaded` was made from
// the relighter's field or from the one that it was made from; both must outlive this. OLX_ERROR_ARGUMENT, with a
// message, for settings out of range, another field, a relighter with frames or with an occlusion function (shadow rays
// are traced through the field); OLX_ERROR_UNSUPPORTED where surfels and their links, or sites, or 20 bytes for each
// texel that a frame lights would not fit into a storage buffer of the device. Submits to the queue and waits, as
// creating a field does. On success *created is the caller's to destroy, on failure it is NULL and the relighter as
// before.
olx_result olx_vulkan_relight_create(olx_vulkan_field *uploaded, olx_relight *relight,
                                     const olx_vulkan_relight_settings *settings, olx_vulkan_relight **created);
// NULL is allowed. Nothing that was recorded with it may be pending. The relighter makes no more frames.
void olx_vulkan_relight_destroy(olx_vulkan_relight *relight);

// The work that a frame does.
typedef struct olx_vulkan_relight_stats {
  uint32_t surfels_lit, surfels_gathered; // get a sample of direct light; gather light from others
  uint64_t texels;                        // of light field probes
  uint32_t volume_probes;
  uint32_t awake; // tiles, surfels and volume probes that wait, as far as is known; 0: everything has arrived
} olx_vulkan_relight_stats;

// Record one frame, seen from `eye` (metres): schedule here, light there, and the field's light is that of this frame
// for all commands after. Call outside a render pass, in a command buffer for the queue on which the field is used; the
// one that was recorded in_flight calls ago must have finished, because how much light it changed is read now. Waits
// for nothing. The frame waits for all commands before; it has to be submitted, in the order of the calls. Binds
// compute pipelines, sets 0 and 1, and push constants. Nothing is recorded when nothing is awake. stats may be NULL. It
// differs from olx_relight_frame in that tiles and volume probes are woken by a round of bounces in_flight frames
// later, and in that the budget counts shadow rays that no light needs, being behind its surface.
olx_result olx_vulkan_record_relight(olx_vulkan_relight *relight, VkCommandBuffer commands, olx_vec3 eye,
                                     olx_vulkan_relight_stats *stats);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
