#include "vulkan/gpu_relight.h"
#include "vulkan/map_copies.h"

enum { WORD = sizeof(uint32_t), MOST_UPDATE_BYTES = 65536 };

// ---- What is known of the frames before

// The changes of the frame that wrote a slot of the results mean as much as they would have on the CPU, only later.
static void read_results(olx_vulkan_relight *v) {
  olx_relight *r = v->relight;
  if (!v->written[v->slot]) return;
  v->written[v->slot] = false;
  const float *results = v->results + 2 * (size_t)r->counts[0] * v->slot;
  for (uint32_t i = 0; i < r->counts[0]; i++) {
    r->changed[i] = results[2 * i];
    r->mean[i] = results[2 * i + 1];
    r->unpacked[i] += r->changed[i];
  }
  olx_relit_pass_on(r);
}

// Maps to pack: scheduled ones, and those that others' light has changed.
static void choose_packs(olx_vulkan_relight *v) {
  olx_relight *r = v->relight;
  const float texels = (float)(r->map_size * r->map_size);
  v->pack_count = 0;
  for (uint32_t i = 0; i < r->counts[0]; i++) {
    if (!r->in_frame[i] && !olx_relit_pack_due(r, i, r->mean[i] * texels)) continue;
    r->unpacked[i] = 0.0f;
    v->packs[v->pack_count++] = i;
  }
}

// ---- What a frame needs from the host

static void order(const olx_vulkan_relight *v, VkCommandBuffer commands, VkPipelineStageFlags before,
                  VkPipelineStageFlags after) {
  const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
  v->gpu->context.vk.CmdPipelineBarrier(commands, before, after, 0, 1, &barrier, 0, NULL, 0, NULL);
}

// Between two steps.
static void next_step(const olx_vulkan_relight *v, VkCommandBuffer commands) {
  const VkPipelineStageFlags ours = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  order(v, commands, ours, ours);
}

static void update_state(const olx_vulkan_relight *v, VkCommandBuffer commands, uint32_t at, const uint32_t *words,
                         uint32_t count) {
  for (uint32_t done = 0; done < count;) {
    const uint32_t rest = count - done, most = MOST_UPDATE_BYTES / WORD, part = rest < most ? rest : most;
    v->gpu->context.vk.CmdUpdateBuffer(commands, v->buffers[OLX_BUFFER_STATE].buffer,
                                       ((VkDeviceSize)OLX_RELIGHT_HEADER_WORDS + at + done) * WORD,
                                       (VkDeviceSize)part * WORD, words + done);
    done += part;
  }
}

static void write_job(uint32_t *words, uint32_t probe, uint32_t flags, uint32_t rounds, uint32_t tile,
                      const olx_relit_probe *p, float history) {
  const uint32_t job[OLX_JOB_WORDS] = {probe,
                                       flags,
                                       rounds,
                                       tile,
                                       olx_float_bits(p->position.x),
                                       olx_float_bits(p->position.y),
                                       olx_float_bits(p->position.z),
                                       olx_float_bits(history)};
  memcpy(words, job, sizeof job);
}

static void update_jobs(olx_vulkan_relight *v, VkCommandBuffer commands, uint32_t *flags) {
  const olx_relight *r = v->relight;
  *flags = 0;
  for (uint32_t i = 0; i < r->scheduled_count; i++) {
    const olx_relit_probe *p = &r->probes[0][r->scheduled[i]];
    const uint32_t own =
        (p->rounds == 0 ? OLX_JOB_FIXED : 0u) | (r->varying && p->rounds < OLX_RELIT_ROUNDS ? OLX_JOB_VARYING : 0u);
    write_job(v->jobs + i * OLX_JOB_WORDS, r->scheduled[i], own, p->rounds, 0, p,
              p->updates > 0 ? r->settings.history : 0.0f);
    *flags |= own;
  }
  update_state(v, commands, v->constants.jobs, v->jobs, r->scheduled_count * OLX_JOB_WORDS);
  for (uint32_t i = 0; i < r->tile_count; i++) {
    const olx_relit_tile *t = &r->tiles[i];
    write_job(v->jobs + i * OLX_JOB_WORDS, t->probe, 0, 0, t->tile, &r->probes[1][t->probe], 0.0f);
  }
  update_state(v, commands, v->constants.tiles, v->jobs, r->tile_count * OLX_JOB_WORDS);
  update_state(v, commands, v->constants.packs, v->packs, v->pack_count);
}

static olx_gpu_vec4 with_zero(olx_vec3 a) { return (olx_gpu_vec4){a.x, a.y, a.z, 0.0f}; }

static void update_lights(olx_vulkan_relight *v, VkCommandBuffer commands) {
  const olx_relight *r = v->relight;
  if (v->light_changes == r->light_changes) return;
  v->light_changes = r->light_changes;
  update_state(v, commands, v->constants.lights, &r->light_count, 1);
  for (uint32_t i = 0; i < r->light_count; i++) {
    const olx_relight_light *l = &r->lights[i];
    const bool area = l->type == OLX_RELIGHT_RECT || l->type == OLX_RELIGHT_TRIANGLE;
    const olx_gpu_light light = {.emission = with_zero(l->emission),
                                 .position = with_zero(l->position),
                                 .edge_u = with_zero(area ? l->edge_u : l->direction),
                                 .edge_v = with_zero(l->edge_v),
                                 .type = l->type,
                                 .both_sides = l->both_sides,
                                 .cosine_inner = l->cosine_inner,
                                 .cosine_outer = l->cosine_outer};
    uint32_t words[OLX_LIGHT_WORDS];
    memcpy(words, &light, sizeof words);
    update_state(v, commands, v->constants.lights + 1 + i * OLX_LIGHT_WORDS, words, OLX_LIGHT_WORDS);
  }
}

// ---- Passes

typedef struct dispatch {
  olx_relight_pass pass;
  olx_relight_group group;
  bool texels;            // are the places
  uint32_t threads, rows; // along x, rounded up to whole workgroups, and workgroups along y
  uint32_t call;          // OLX_CALL_*
} dispatch;

static void record(const olx_vulkan_relight *v, VkCommandBuffer commands, const dispatch *d) {
  if (d->rows == 0 || d->threads == 0) return;
  const olx_vulkan_functions *vk = &v->gpu->context.vk;
  const olx_gpu_group *g = &v->groups[d->group];
  const VkDescriptorSet sets[] = {g->own[d->texels], g->field};
  vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, v->pipelines[d->pass]);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, g->layout, 0, g->field ? 2 : 1, sets, 0, NULL);
  vk->CmdPushConstants(commands, g->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof d->call, &d->call);
  vk->CmdDispatch(commands, (d->threads + OLX_RELIGHT_GROUP - 1) / OLX_RELIGHT_GROUP, d->rows, 1);
}

// Whether a dispatch of rays has any to lights whose light is to be found.
static bool chunk_counts(const olx_relight *r, uint32_t chunk, uint32_t flags) {
  const uint32_t samples = r->settings.light_samples, first = chunk * OLX_RELIGHT_RAYS / samples,
                 last = ((chunk + 1) * OLX_RELIGHT_RAYS - 1) / samples;
  for (uint32_t i = first; i <= last && i < r->light_count; i++) {
    if (flags & (olx_relit_varies(&r->lights[i]) ? OLX_JOB_VARYING : OLX_JOB_FIXED)) return true;
  }
  return false;
}

static void record_direct(const olx_vulkan_relight *v, VkCommandBuffer commands, bool texels, uint32_t flags) {
  const olx_relight *r = v->relight;
  dispatch d = {.pass = OLX_PASS_BEGIN,
                .group = OLX_GROUP_TRACE,
                .texels = texels,
                .threads = texels ? r->tile_side * r->tile_side : (uint32_t)r->surfaces,
                .rows = texels ? r->tile_count : r->scheduled_count,
                .call = texels ? OLX_CALL_TEXELS : OLX_CALL_SURFACES};
  if (d.rows == 0 || flags == 0) return;
  record(v, commands, &d);
  d.pass = OLX_PASS_DIRECT;
  for (uint32_t chunk = 0; chunk < olx_relight_chunks(r, r->light_count); chunk++) {
    if (!chunk_counts(r, chunk, flags)) continue;
    d.call = olx_relight_rays_call(r, texels, chunk);
    next_step(v, commands);
    record(v, commands, &d);
  }
}

static void record_reflect(const olx_vulkan_relight *v, VkCommandBuffer commands) {
  const olx_relight *r = v->relight;
  const dispatch kinds[] = {
      {.threads = (uint32_t)r->surfaces / 4, .rows = r->scheduled_count, .call = OLX_CALL_SURFACES},
      {.texels = true, .threads = r->tile_side * r->tile_side / 16, .rows = r->tile_count, .call = OLX_CALL_TEXELS}};
  for (uint32_t i = 0; i < 2; i++) {
    dispatch d = kinds[i];
    d.pass = OLX_PASS_REFLECT;
    d.group = OLX_GROUP_LOOKUP;
    record(v, commands, &d);
  }
}

static void record_maps(const olx_vulkan_relight *v, VkCommandBuffer commands, olx_relight_pass pass, uint32_t call,
                        uint32_t threads, uint32_t rows) {
  const dispatch d = {.pass = pass, .group = OLX_GROUP_MAPS, .threads = threads, .rows = rows, .call = call};
  record(v, commands, &d);
  next_step(v, commands);
}

// Conjugate gradients, as olx_relit_fit_solve has them; unknowns are a workgroup a probe.
static void record_fit(const olx_vulkan_relight *v, VkCommandBuffer commands) {
  const olx_relight *r = v->relight;
  const uint32_t points = v->constants.points, probes = r->counts[0], unknowns = probes * OLX_CORRECTION_CELLS;
  if (points == 0 || r->settings.fit_steps == 0) return;
  record_maps(v, commands, OLX_PASS_PREDICT, OLX_CALL_RESIDUAL, points, probes);
  record_maps(v, commands, OLX_PASS_GATHER, OLX_CALL_RESIDUAL, unknowns, 1);
  for (uint32_t step = 0; step < r->settings.fit_steps; step++) {
    const uint32_t norm = step % 2;
    record_maps(v, commands, OLX_PASS_PREDICT, OLX_CALL_MULTIPLY, points, probes);
    record_maps(v, commands, OLX_PASS_GATHER, OLX_CALL_MULTIPLY, unknowns, 1);
    record_maps(v, commands, OLX_PASS_ADVANCE, OLX_CALL_ADVANCE + norm, unknowns, 1);
    record_maps(v, commands, OLX_PASS_ADVANCE, OLX_CALL_TURN + norm, unknowns, 1);
  }
}

static void record_irradiance(const olx_vulkan_relight *v, VkCommandBuffer commands) {
  const olx_relight *r = v->relight;
  const uint32_t scheduled = r->scheduled_count;
  record_maps(v, commands, OLX_PASS_EXACT, 0, r->map_size * r->map_size, scheduled);
  record_maps(v, commands, OLX_PASS_POINTS, 0, v->constants.points, scheduled);
  record_fit(v, commands);
  record_maps(v, commands, OLX_PASS_FINISH, 0, r->counts[0] * OLX_RELIGHT_GROUP, 1);
}

// ---- Into the field

static void copy_tile(olx_vulkan_relight *v, olx_map_copies *copies, uint32_t index) {
  const olx_relight *r = v->relight;
  const olx_relit_tile *t = &r->tiles[index];
  const uint32_t n = r->field.n, side = r->tile_side, tiles = n / side, tx = t->tile % tiles, ty = t->tile / tiles;
  const uint32_t first = v->constants.tile_packed + index * (side * side + OLX_RELIT_TILE_BORDER),
                 strips = first + side * side, corners = strips + 4 * side;
  const int32_t x = (int32_t)(tx * side), y = (int32_t)(ty * side), end = (int32_t)n;
  const int32_t back_x = end - x - (int32_t)side, back_y = end - y - (int32_t)side; // where the border repeats an edge
  const bool left = tx == 0, right = tx == tiles - 1, top = ty == 0, bottom = ty == tiles - 1;
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
      {top && left, {end, end, 1, 1}, corners}, // which repeat the corners across
      {top && right, {-1, end, 1, 1}, corners + 1},
      {bottom && left, {end, -1, 1, 1}, corners + 2},
      {bottom && right, {-1, -1, 1, 1}, corners + 3},
  };
  for (uint32_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    if (parts[i].has) olx_map_copies_add(copies, t->probe, &parts[i].part, (VkDeviceSize)parts[i].at * WORD);
  }
}

static void copy_to_field(olx_vulkan_relight *v, VkCommandBuffer commands) {
  const olx_relight *r = v->relight;
  if (r->tile_count == 0 && v->pack_count == 0) return;
  olx_map_copies radiance =
                     olx_map_copies_of(v->gpu, OLX_BINDING_RADIANCE, v->buffers[OLX_BUFFER_TEXELS].buffer, commands),
                 irradiance =
                     olx_map_copies_of(v->gpu, OLX_BINDING_IRRADIANCE, v->buffers[OLX_BUFFER_PACKED].buffer, commands);
  olx_map_copies_begin(v->gpu, commands);
  for (uint32_t i = 0; i < r->tile_count; i++) copy_tile(v, &radiance, i);
  const olx_map_part whole = {-1, -1, r->field.irradiance_stride, r->field.irradiance_stride};
  for (uint32_t i = 0; i < v->pack_count; i++) {
    olx_map_copies_add(&irradiance, v->packs[i], &whole, (VkDeviceSize)v->packs[i] * r->field.irradiance_texels * WORD);
  }
  olx_map_copies_record(&radiance);
  olx_map_copies_record(&irradiance);
  olx_map_copies_end(v->gpu, commands);
}

static void copy_results(olx_vulkan_relight *v, VkCommandBuffer commands) {
  const VkDeviceSize bytes = 2 * (VkDeviceSize)v->constants.probes * WORD;
  const VkBufferCopy region = {((VkDeviceSize)OLX_RELIGHT_HEADER_WORDS + v->constants.changes) * WORD, bytes * v->slot,
                               bytes};
  v->gpu->context.vk.CmdCopyBuffer(commands, v->buffers[OLX_BUFFER_STATE].buffer, v->buffers[OLX_BUFFER_RESULTS].buffer,
                                   1, &region);
  v->written[v->slot] = true;
}

// ---- A frame

static void record_frame(olx_vulkan_relight *v, VkCommandBuffer commands, bool fits) {
  olx_relight *r = v->relight;
  uint32_t flags;
  order(v, commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
        VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT);
  update_lights(v, commands);
  update_jobs(v, commands, &flags);
  next_step(v, commands);
  record_direct(v, commands, false, flags);
  record_direct(v, commands, true, OLX_JOB_FIXED | OLX_JOB_VARYING);
  next_step(v, commands);
  record_reflect(v, commands);
  next_step(v, commands);
  if (fits) record_irradiance(v, commands);
  record_maps(v, commands, OLX_PASS_PACK, 0, (uint32_t)r->field.irradiance_texels, v->pack_count);
  copy_to_field(v, commands);
  if (fits) copy_results(v, commands);
  order(v, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT);
}

static uint32_t frames_under_way(const olx_vulkan_relight *v) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < v->settings.in_flight; i++) count += v->written[i];
  return count;
}

olx_result olx_vulkan_record_relight(olx_vulkan_relight *v, VkCommandBuffer commands, olx_vec3 eye,
                                     olx_vulkan_relight_stats *stats) {
  olx_relight *r = v->relight;
  read_results(v);
  olx_relit_begin_frame(r, eye);
  choose_packs(v);
  const bool fits = olx_relit_fits(r);
  if (fits || r->tile_count || v->pack_count) record_frame(v, commands, fits);
  olx_relit_count_updates(r);
  v->slot = (v->slot + 1) % v->settings.in_flight;
  if (!stats) return OLX_OK;
  *stats = (olx_vulkan_relight_stats){.irradiance_probes = r->scheduled_count,
                                      .irradiance_maps = v->pack_count,
                                      .radiance_tiles = r->tile_count,
                                      .surface_texels = r->scheduled_count * r->surfaces,
                                      .radiance_texels = (uint64_t)r->tile_count * r->tile_side * r->tile_side,
                                      .awake = olx_relit_count_awake(r),
                                      .under_way = frames_under_way(v)};
  return OLX_OK;
}
