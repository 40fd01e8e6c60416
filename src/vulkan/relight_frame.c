// Records frames of a relighter: chooses what they light as the CPU does, and decides when their results are read.
#include "core/distribution.h"
#include "vulkan/map_copies.h"
#include "vulkan/vulkan_relight.h"

enum {
  WORD = sizeof(uint32_t),
  MOST_UPDATE_BYTES = 65536,
  MOST_GROUPS = 65535, // the most workgroups along an axis that every device supports
  PLACE_RAYS = 4       // of a place in one dispatch: some devices limit a dispatch's time or its loops
};

// ---- Results of earlier frames

// Reads the results of a completed frame. They have the meaning that they would have on the CPU, only later.
static void read_results(olx_vulkan_relight *v) {
  olx_relight_reading *reading = &v->readings[v->slot];
  const float *results = v->results + (size_t)v->result_words * v->slot;
  double change = 0.0, sum = 0.0;
  if (!reading->written) return;
  reading->written = false;
  for (uint32_t i = 0; OLX_RELIGHT_GROUP * i < reading->turns.count; i++) {
    change += (double)results[2 * i];
    sum += (double)results[2 * i + 1];
  }
  olx_relit_links_followed(v->schedule, &reading->turns, change, sum);
}

// ---- Contents of a frame

typedef struct frame_plan {
  olx_relit_surfel_turns surfels;
  olx_relit_link_turns links;
  olx_relit_tile_turns tiles;
  olx_relit_volume_turns volume;
} frame_plan;

static frame_plan plan_frame(const olx_vulkan_relight *v, olx_vec3 eye) {
  frame_plan plan;
  plan.surfels = olx_relit_take_surfels(v->schedule);
  plan.links = olx_relit_take_links(v->schedule);
  plan.tiles = olx_relit_take_tiles(v->schedule, eye, (uint64_t)plan.surfels.count * olx_relit_surfel_rays(v->lights));
  plan.volume = olx_relit_take_volume(v->schedule);
  return plan;
}

static bool is_idle(const frame_plan *plan) {
  return plan->surfels.count == 0 && plan->links.count == 0 && plan->tiles.count == 0 && plan->volume.count == 0;
}

// ---- Transfers from the host

static void order(const olx_vulkan_relight *v, VkCommandBuffer commands, VkPipelineStageFlags before,
                  VkPipelineStageFlags after) {
  const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
  v->gpu->context.vk.CmdPipelineBarrier(commands, before, after, 0, 1, &barrier, 0, NULL, 0, NULL);
}

// Records the barrier between two steps of a frame.
static void next_step(const olx_vulkan_relight *v, VkCommandBuffer commands) {
  const VkPipelineStageFlags ours = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  order(v, commands, ours, ours);
}

static void update(const olx_vulkan_relight *v, VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize to,
                   const void *data, size_t bytes) {
  for (size_t done = 0; done < bytes; done += MOST_UPDATE_BYTES) {
    const size_t rest = bytes - done, part = rest < MOST_UPDATE_BYTES ? rest : MOST_UPDATE_BYTES;
    v->gpu->context.vk.CmdUpdateBuffer(commands, buffer, to + done, part, (const char *)data + done);
  }
}

static VkDeviceSize state_at(uint32_t word) { return ((VkDeviceSize)OLX_RELIGHT_HEADER_WORDS + word) * WORD; }

static void update_state(const olx_vulkan_relight *v, VkCommandBuffer commands, uint32_t at, const void *words,
                         size_t count) {
  update(v, commands, v->buffers[OLX_BUFFER_STATE].buffer, state_at(at), words, count * WORD);
}

static olx_gpu_vec4 with(olx_vec3 a, float w) { return (olx_gpu_vec4){a.x, a.y, a.z, w}; }

static olx_gpu_light gpu_light(const olx_light *l, float near_radius) {
  const bool area = l->type == OLX_LIGHT_RECT || l->type == OLX_LIGHT_TRIANGLE;
  return (olx_gpu_light){.emission = with(l->emission, near_radius),
                         .position = with(l->position, 0.0f),
                         .edge_u = with(area ? l->edge_u : l->direction, 0.0f),
                         .edge_v = with(l->edge_v, 0.0f),
                         .type = l->type,
                         .both_sides = l->both_sides,
                         .cosine_inner = l->cosine_inner,
                         .cosine_outer = l->cosine_outer};
}

// Copies the points of surfaces near lamps, and their number and that of the lights.
static void update_lamp_points(const olx_vulkan_relight *v, VkCommandBuffer commands) {
  enum { PART = 256 };
  const olx_near_lamps *lamps = &v->lights->lamps;
  const uint32_t counts[] = {v->lights->count, lamps->count};
  olx_gpu_lamp_point points[PART];
  update(v, commands, v->buffers[OLX_BUFFER_STATE].buffer, offsetof(olx_gpu_relight, light_count), counts,
         sizeof counts);
  for (uint32_t first = 0; first < lamps->count; first += PART) {
    const uint32_t left = lamps->count - first, count = left < PART ? left : PART;
    for (uint32_t i = 0; i < count; i++) {
      const olx_lamp_point *p = &lamps->points[first + i];
      points[i] = (olx_gpu_lamp_point){with(p->position, lamps->sums[first + i]), with(p->normal, p->soft_squared),
                                       with(p->intensity, olx_distribution_probability(lamps->sums, first + i))};
    }
    update_state(v, commands, v->constants.lamp_points + first * OLX_LAMP_POINT_WORDS, points,
                 (size_t)count * OLX_LAMP_POINT_WORDS);
  }
}

// Copies the lights of the relighter and those of the field.
static void update_lights(olx_vulkan_relight *v, VkCommandBuffer commands) {
  const olx_relit_lights *lights = v->lights;
  const olx_vulkan_field *gpu = v->gpu;
  const uint32_t changes = olx_relit_light_changes(v->schedule);
  if (v->light_changes == changes) return;
  v->light_changes = changes;
  for (uint32_t i = 0; i < lights->count; i++) {
    const olx_gpu_light light = gpu_light(&lights->lights[i], lights->lamps.radius ? lights->lamps.radius[i] : 0.0f);
    update_state(v, commands, v->constants.lights + i * OLX_LIGHT_WORDS, &light, OLX_LIGHT_WORDS);
  }
  update_lamp_points(v, commands);
  const uint32_t count = lights->packed_count > gpu->light_room ? 0 : lights->packed_count;
  update(v, commands, gpu->buffer, gpu->words[OLX_WORDS_LIGHTS].offset, lights->packed, count * sizeof *lights->packed);
  update(v, commands, gpu->buffer, offsetof(olx_field_constants, light_count), &count, sizeof count);
}

// ---- Passes

// Records a dispatch of `threads`, rounded up to whole workgroups.
static void record(const olx_vulkan_relight *v, VkCommandBuffer commands, olx_relight_pass pass, uint64_t threads,
                   const olx_gpu_relight_call *call) {
  if (threads == 0) return;
  const olx_vulkan_functions *vk = &v->gpu->context.vk;
  const olx_gpu_group *g = &v->groups[olx_relight_group_of(pass)];
  const VkDescriptorSet sets[] = {g->own, g->field};
  const uint32_t groups = (uint32_t)((threads + OLX_RELIGHT_GROUP - 1) / OLX_RELIGHT_GROUP),
                 along = groups < MOST_GROUPS ? groups : MOST_GROUPS;
  vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, v->pipelines[pass]);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, g->layout, 0, 2, sets, 0, NULL);
  vk->CmdPushConstants(commands, g->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof *call, call);
  vk->CmdDispatch(commands, along, (groups + along - 1) / along, 1);
  next_step(v, commands);
}

// Advances past the rays of a dispatch. Those to surfaces near lamps come after those to lights.
static void skip_rays(const olx_relit_lights *lights, olx_gpu_relight_call *call) {
  for (uint32_t i = 0; i < call->rays; i++) {
    if (++call->light_sample <
        (call->light < lights->count ? olx_relit_samples(lights, call->light) : OLX_LAMP_SAMPLES))
      continue;
    call->light_sample = 0;
    call->light++;
  }
}

// Records successive dispatches, each with a few of the `left` rays of every place. Without lights, one dispatch writes
// darkness.
static void record_rays(const olx_vulkan_relight *v, VkCommandBuffer commands, olx_relight_pass pass,
                        olx_gpu_relight_call call, uint32_t left) {
  call.flags = OLX_CALL_BEGINS;
  for (;;) {
    call.rays = left < PLACE_RAYS ? left : PLACE_RAYS;
    left -= call.rays;
    if (left == 0) call.flags |= OLX_CALL_ENDS;
    record(v, commands, pass, call.count, &call);
    if (left == 0) return;
    skip_rays(v->lights, &call);
    call.flags = 0;
  }
}

static void record_values(const olx_vulkan_relight *v, VkCommandBuffer commands, bool all) {
  const olx_gpu_relight_call surfels = {.count = v->constants.surfels, .flags = all ? OLX_CALL_ALL : 0};
  record(v, commands, OLX_RELIGHT_VALUES, surfels.count, &surfels);
}

static void record_bounce(olx_vulkan_relight *v, VkCommandBuffer commands, const olx_relit_link_turns *turns) {
  const olx_gpu_relight_call call = {
      .first = turns->first, .count = turns->count, .flags = turns->shines ? OLX_CALL_SHINES : 0};
  const VkBufferCopy region = {state_at(v->constants.sums), (VkDeviceSize)v->result_words * WORD * v->slot,
                               (VkDeviceSize)v->result_words * WORD};
  record_values(v, commands, false);
  record(v, commands, OLX_RELIGHT_BOUNCE, call.count, &call);
  v->gpu->context.vk.CmdCopyBuffer(commands, v->buffers[OLX_BUFFER_STATE].buffer, v->buffers[OLX_BUFFER_RESULTS].buffer,
                                   1, &region);
  next_step(v, commands);
  v->readings[v->slot] = (olx_relight_reading){.written = true, .turns = *turns};
  record_values(v, commands, true);
}

// ---- Copies into the field

// Copies a tile, whose words begin at `first`, and the texels of the map's border that repeat it.
static void copy_tile(const olx_vulkan_relight *v, olx_map_copies *copies, const olx_relit_tile *tile, uint32_t first) {
  const uint32_t n = v->gpu->constants.n, side = v->constants.tile_side, strips = first + side * side,
                 corners = strips + 4 * side;
  const int32_t x = (int32_t)tile->first_x, y = (int32_t)tile->first_y, end = (int32_t)n;
  const int32_t back_x = end - x - (int32_t)side, back_y = end - y - (int32_t)side; // where the border repeats an edge
  const bool left = x == 0, right = back_x == 0, top = y == 0, bottom = back_y == 0;
  const struct {
    bool has;
    olx_map_part part;
    uint32_t at;
  } parts[] = {
      {true, {x, y, side, side}, first},
      {top, {back_x, -1, side, 1}, strips},
      {bottom, {back_x, end, side, 1}, strips + side},
      {left, {-1, back_y, 1, side}, strips + 2 * side},
      {right, {end, back_y, 1, side}, strips + 3 * side},
      {top && left, {end, end, 1, 1}, corners}, // repeated at the opposite corners
      {top && right, {-1, end, 1, 1}, corners + 1},
      {bottom && left, {end, -1, 1, 1}, corners + 2},
      {bottom && right, {-1, -1, 1, 1}, corners + 3},
  };
  for (uint32_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    if (parts[i].has) olx_map_copies_add(copies, tile->probe, &parts[i].part, state_at(parts[i].at));
  }
}

static void copy_tiles(const olx_vulkan_relight *v, VkCommandBuffer commands, const olx_relit_tile_turns *turns) {
  const VkBuffer state = v->buffers[OLX_BUFFER_STATE].buffer;
  const olx_gpu_relight *c = &v->constants;
  olx_map_copies direct = olx_map_copies_of(v->gpu, OLX_BINDING_DIRECT, state, commands),
                 indirect = olx_map_copies_of(v->gpu, OLX_BINDING_INDIRECT, state, commands);
  olx_map_copies_begin(v->gpu, commands);
  for (uint32_t slot = 0; slot < turns->count; slot++) {
    const olx_relit_tile *tile = &turns->tiles[slot];
    if (slot < turns->lit) copy_tile(v, &direct, tile, c->tile_direct + c->tile_words * slot);
    copy_tile(v, &indirect, tile, c->tile_indirect + c->tile_words * slot);
  }
  olx_map_copies_record(&direct);
  olx_map_copies_record(&indirect);
  olx_map_copies_end(v->gpu, commands);
}

static void record_tiles(const olx_vulkan_relight *v, VkCommandBuffer commands, const olx_relit_tile_turns *turns) {
  const uint32_t texels = turns->side * turns->side;
  const olx_gpu_relight_call lit = {.count = turns->lit * texels}, interpolated = {.count = turns->count * texels};
  if (turns->count == 0) return;
  if (lit.count > 0) record_rays(v, commands, OLX_RELIGHT_TEXELS, lit, v->lights->rays);
  record(v, commands, OLX_RELIGHT_INTERPOLATE, interpolated.count, &interpolated);
  copy_tiles(v, commands, turns);
}

// ---- A frame

static void record_frame(olx_vulkan_relight *v, VkCommandBuffer commands, const frame_plan *plan) {
  const olx_relit_surfel_turns *s = &plan->surfels;
  const olx_gpu_relight_call surfels = {.first = s->first, .count = s->count, .round = s->round, .before = s->before},
                             probes = {.first = plan->volume.first, .count = plan->volume.count};
  order(v, commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
        VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT);
  update_lights(v, commands);
  update_state(v, commands, v->constants.tiles, plan->tiles.tiles, (size_t)plan->tiles.count * OLX_TILE_WORDS);
  next_step(v, commands);
  if (surfels.count > 0) {
    record_rays(v, commands, OLX_RELIGHT_SURFELS, surfels, olx_relit_surfel_rays(v->lights));
  }
  if (plan->links.count > 0) record_bounce(v, commands, &plan->links);
  record_tiles(v, commands, &plan->tiles);
  record(v, commands, OLX_RELIGHT_VOLUME, probes.count, &probes);
  order(v, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT);
}

olx_result olx_vulkan_record_relight(olx_vulkan_relight *v, VkCommandBuffer commands, olx_vec3 eye,
                                     olx_vulkan_relight_stats *stats) {
  read_results(v);
  olx_relit_begin_frame(v->schedule);
  const frame_plan plan = plan_frame(v, eye);
  if (!is_idle(&plan)) record_frame(v, commands, &plan);
  v->slot = (v->slot + 1) % v->settings.in_flight;
  if (!stats) return OLX_OK;
  *stats = (olx_vulkan_relight_stats){.surfels_lit = plan.surfels.count,
                                      .surfels_gathered = plan.links.count,
                                      .texels = (uint64_t)plan.tiles.count * plan.tiles.side * plan.tiles.side,
                                      .volume_probes = plan.volume.count,
                                      .awake = olx_relit_awake(v->schedule)};
  return OLX_OK;
}
