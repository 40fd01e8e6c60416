// Records the denoiser's passes: they mix a frame's rays into the histories of both lobes, and filter these along rows
// and columns.
#include "core/vec.h"
#include "shade/ray_turn.h"
#include "vulkan/vulkan_frame.h"

#include <math.h>

static const uint32_t ACCUMULATE_WORDS[] = {
#include "accumulate.spv.inc"
};
const olx_pass_code olx_accumulate_pass = {"accumulate", ACCUMULATE_WORDS, sizeof ACCUMULATE_WORDS};

static const uint32_t FILTER_WORDS[] = {
#include "filter.spv.inc"
};
const olx_pass_code olx_filter_pass = {"filter", FILTER_WORDS, sizeof FILTER_WORDS};

// A view for the denoiser: the depth of a pixel along the viewing axis is scale / (depth image - offset).
typedef struct camera {
  olx_gpu_camera constants;
  bool mirrored;
  float depth_scale, depth_offset;
} camera;

typedef struct vec3d {
  double x, y, z;
} vec3d;

static double dot(vec3d a, vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec3d sub(vec3d a, vec3d b) { return (vec3d){a.x - b.x, a.y - b.y, a.z - b.z}; }
static vec3d add(vec3d a, vec3d b) { return (vec3d){a.x + b.x, a.y + b.y, a.z + b.z}; }
static vec3d scaled(vec3d a, double s) { return (vec3d){a.x * s, a.y * s, a.z * s}; }
static vec3d cross(vec3d a, vec3d b) {
  return (vec3d){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Returns a point of the clip volume in world space, relative to the eye.
static vec3d from_eye(const olx_vulkan_view *view, double x, double y, double depth) {
  const float *m = view->clip_to_world;
  double p[4];
  for (int i = 0; i < 4; i++)
    p[i] = (double)m[i] * x + (double)m[4 + i] * y + (double)m[8 + i] * depth + (double)m[12 + i];
  const vec3d eye = {(double)view->eye.x, (double)view->eye.y, (double)view->eye.z};
  return sub((vec3d){p[0] / p[3], p[1] / p[3], p[2] / p[3]}, eye);
}

// Returns whether the camera puts a point where the view does.
static bool agrees(const olx_vulkan_view *view, const camera *c, vec3d forward, vec3d right, vec3d up, double shift_x,
                   double shift_y, double depth) {
  const double metres = (double)c->depth_scale / (depth - (double)c->depth_offset);
  const vec3d along = add(forward, add(scaled(right, 0.5 + shift_x), scaled(up, shift_y - 0.5)));
  const vec3d error = sub(scaled(along, metres), from_eye(view, 0.5, 0.5, depth));
  return dot(error, error) <= 1e-6 * metres * metres * dot(along, along);
}

static olx_result find_camera(const olx_vulkan_frame *f, const olx_vulkan_view *view, const char *name, camera *c) {
  // These depths are far from the eye, where a position in single precision is more accurate.
  const double step = view->empty_depth > 0.5f ? -0.01 : 0.01, far_depth = (double)view->empty_depth + step,
               near_depth = far_depth + step;
  const vec3d middle = from_eye(view, 0, 0, near_depth);
  vec3d right = sub(from_eye(view, 1, 0, near_depth), middle), up = sub(middle, from_eye(view, 0, 1, near_depth));
  vec3d forward = cross(up, right);
  forward = scaled(forward, 1 / sqrt(dot(forward, forward)));
  c->mirrored = dot(forward, middle) < 0;
  if (c->mirrored) forward = scaled(forward, -1);
  const double a = dot(forward, middle), b = dot(forward, from_eye(view, 0, 0, far_depth));
  const double offset = (a * near_depth - b * far_depth) / (a - b);
  right = scaled(right, 1 / a);
  up = scaled(up, 1 / a);
  const double shift_x = dot(middle, right) / (a * dot(right, right)), shift_y = dot(middle, up) / (a * dot(up, up));
  c->depth_scale = (float)(a * (near_depth - offset));
  c->depth_offset = (float)offset;
  c->constants =
      (olx_gpu_camera){.eye = {view->eye.x, view->eye.y, view->eye.z, (float)(shift_x * f->width / 2)},
                       .right = {(float)right.x, (float)right.y, (float)right.z, (float)(-shift_y * f->height / 2)},
                       .up = {(float)up.x, (float)up.y, (float)up.z, 0.0f}};
  if (agrees(view, c, forward, right, up, shift_x, shift_y, near_depth + 5 * step)) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "denoise: %s view's clip_to_world is not that of a perspective from its eye",
                  name);
}

static uint32_t packed_size(const olx_vulkan_frame *f) { return f->width | f->height << 16; }

static void record(const olx_vulkan_frame *f, VkCommandBuffer commands, VkPipeline pipeline, VkPipelineLayout layout,
                   VkDescriptorSet set, uint32_t constant_bytes, const void *constants) {
  const olx_vulkan_functions *vk = &f->field->context.vk;
  vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, NULL);
  vk->CmdPushConstants(commands, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, constant_bytes, constants);
  olx_vulkan_dispatch(f, commands);
}

uint32_t olx_gpu_turn_flags(const olx_vulkan_denoise *denoise) {
  const olx_ray_turn turn = olx_ray_turn_of(denoise->filters.ray_spacing, denoise->frame);
  if (turn.spacing == 1) return 0;
  return OLX_TURN_SPARSE | (turn.x ? OLX_TURN_X : 0u) | (turn.y ? OLX_TURN_Y : 0u);
}

static void record_accumulate(const olx_vulkan_frame *f, VkCommandBuffer commands, const olx_vulkan_view *view,
                              const olx_vulkan_settings *s, const camera *now, const camera *before) {
  const olx_denoise_settings *filters = &s->denoise.filters;
  olx_accumulate_constants constants = {
      .now = now->constants,
      .before = before->constants,
      .size = packed_size(f),
      .flags = s->denoise.lobes | olx_gpu_turn_flags(&s->denoise) | (s->denoise.frame == 0 ? OLX_DENOISE_RESTART : 0u) |
               (f->image_flags & OLX_FRAME_NORMAL_UNORM ? OLX_DENOISE_NORMAL_UNORM : 0u) |
               (now->mirrored ? OLX_DENOISE_MIRRORED : 0u) | (before->mirrored ? OLX_DENOISE_MIRRORED_BEFORE : 0u),
      .empty_depth = view->empty_depth,
      .diffuse_history = filters->diffuse.history,
      .diffuse_still_history = filters->diffuse.still_history,
      .glossy_history = filters->glossy.history,
      .glossy_still_history = filters->glossy.still_history,
  };
  constants.now.up.w = now->depth_scale;
  constants.before.up.w = now->depth_offset;
  const olx_gpu_denoiser *d = &f->denoiser;
  record(f, commands, d->accumulate, d->accumulate_layout, d->accumulate_sets[s->denoise.frame & 1u], sizeof constants,
         &constants);
}

// Records the filters of all lobes along rows or columns; they need no barrier between them.
static void record_filters(const olx_vulkan_frame *f, VkCommandBuffer commands, const olx_vulkan_settings *s,
                           const camera *now, bool columns) {
  for (uint32_t lobe = 0; lobe < 2; lobe++) {
    if (!(s->denoise.lobes & (lobe ? OLX_VULKAN_LOBE_GLOSSY : OLX_VULKAN_LOBE_DIFFUSE))) continue;
    const olx_lobe_filter *filter = lobe ? &s->denoise.filters.glossy : &s->denoise.filters.diffuse;
    const olx_filter_constants constants = {
        .camera = now->constants,
        .size = packed_size(f),
        .flags = (lobe ? OLX_DENOISE_GLOSSY : OLX_DENOISE_DIFFUSE) | (columns ? OLX_DENOISE_COLUMNS : 0u) |
                 (now->mirrored ? OLX_DENOISE_MIRRORED : 0u) | olx_gpu_turn_flags(&s->denoise),
        .radius_pixels = filter->radius_pixels,
        .stride_pixels = filter->stride_pixels,
        .reach = filter->reach,
        .dim_lobe = olx_vulkan_dim_lobe(s),
    };
    const olx_gpu_denoiser *d = &f->denoiser;
    record(f, commands, d->filter, d->filter_layout, d->filter_sets[lobe][s->denoise.frame & 1u], sizeof constants,
           &constants);
  }
}

// Prepares the histories of lobes that are not denoised, which are bound although nothing has written to them.
static void prepare_bystanders(const olx_vulkan_frame *f, const olx_vulkan_denoise *denoise, VkCommandBuffer commands) {
  static const uint32_t kinds[] = {OLX_HISTORY_DIFFUSE, OLX_HISTORY_GLOSSY},
                        lobes[] = {OLX_VULKAN_LOBE_DIFFUSE, OLX_VULKAN_LOBE_GLOSSY};
  for (uint32_t i = 0; i < 2; i++) {
    const bool bystander = f->history.lobes & lobes[i] && !(denoise->lobes & lobes[i]);
    if (bystander && denoise->frame == 0)
      olx_gpu_history_barrier(&f->field->context, &f->history, kinds[i], true, commands);
  }
}

olx_result olx_vulkan_record_denoise(const olx_vulkan_frame *f, VkCommandBuffer commands, const olx_vulkan_view *view,
                                     const olx_vulkan_settings *settings) {
  OLX_TRY(olx_vulkan_check_settings(f, settings));
  const olx_vulkan_denoise *denoise = &settings->denoise;
  if (!denoise->lobes) return olx_fail(OLX_ERROR_ARGUMENT, "denoise: the settings name no lobe");
  camera now, before;
  OLX_TRY(find_camera(f, view, "the", &now));
  before = now;
  if (denoise->frame > 0) OLX_TRY(find_camera(f, &denoise->previous, "the previous", &before));
  const olx_vulkan_context *c = &f->field->context;
  olx_gpu_history_barrier(c, &f->history, OLX_HISTORY_GUIDE, denoise->frame == 0, commands);
  prepare_bystanders(f, denoise, commands);
  record_accumulate(f, commands, view, settings, &now, &before);
  for (uint32_t columns = 0; columns < 2; columns++) {
    olx_gpu_history_barrier(c, &f->history, OLX_HISTORY_GUIDE, false, commands);
    record_filters(f, commands, settings, &now, columns != 0);
  }
  return OLX_OK;
}
