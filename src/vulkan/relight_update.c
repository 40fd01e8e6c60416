// Copies light that a relighter has changed to a field on the device: tiles and borders of light field maps, irradiance
// of the volume, and lights.
#include "core/hooks.h"
#include "core/result.h"
#include "relight/relighter.h"
#include "vulkan/map_copies.h"

static const char WHAT[] = "updates of a field on the device";

enum { MOST_IN_FLIGHT = 8, COPY_ALIGNMENT = 16, TEXEL_BYTES = 4, UPDATED_MAPS = 2, VOLUME_PART = 1024 };

// Updates a field in units that change independently: for each light field probe its tiles and its border, then parts
// of the volume's probes, then all lights.
struct olx_vulkan_update {
  olx_vulkan_field *gpu;
  const olx_field *field;             // of the relighter
  const olx_relit_schedule *schedule; // of the relighter
  const uint32_t *part_frames;        // of the schedule
  olx_vulkan_update_settings settings;
  uint32_t units, parts;     // parts: units of a light field map
  uint32_t maps_end, lights; // the first unit of the volume, and the unit of lights
  uint32_t *copied;          // of each unit: the frame that the device has; of lights: their count of changes
  uint32_t next;             // the unit with which the next call begins, so that none starves
  bool scanned;              // nothing of frame `scanned_frame` waits, nor do lights
  uint32_t scanned_frame;
  olx_staging staging; // one slot for each frame in flight
  uint32_t slot_bytes, slot, used;
};

typedef struct update_call {
  olx_vulkan_update *update;
  VkCommandBuffer commands;
  olx_map_copies direct, indirect;
} update_call;

olx_vulkan_update_settings olx_vulkan_update_settings_default(void) {
  return (olx_vulkan_update_settings){.bytes = 8 << 20, .in_flight = 2};
}

static uint32_t changed_frame(const olx_vulkan_update *u, uint32_t unit) {
  if (unit < u->maps_end) return u->part_frames[unit];
  return unit < u->lights ? olx_relit_volume_frame(u->schedule) : olx_relit_light_changes(u->schedule);
}

static bool is_border(const olx_vulkan_update *u, uint32_t unit) { return unit % u->parts == u->parts - 1; }

// Returns the rectangles of which a unit of a map consists.
static uint32_t map_parts(const olx_vulkan_update *u, uint32_t unit, olx_map_part parts[4]) {
  const uint32_t part = unit % u->parts, n = u->field->n, side = olx_relit_tile_side(n), tiles = n / side;
  if (!is_border(u, unit)) {
    parts[0] = (olx_map_part){(int32_t)(part % tiles * side), (int32_t)(part / tiles * side), side, side};
    return 1;
  }
  parts[0] = (olx_map_part){-1, -1, n + 2, 1};
  parts[1] = (olx_map_part){-1, (int32_t)n, n + 2, 1};
  parts[2] = (olx_map_part){-1, 0, 1, n};
  parts[3] = (olx_map_part){(int32_t)n, 0, 1, n};
  return 4;
}

static uint32_t aligned(uint32_t bytes) { return (bytes + COPY_ALIGNMENT - 1) / COPY_ALIGNMENT * COPY_ALIGNMENT; }

static uint32_t part_bytes(const olx_map_part *part) { return aligned(TEXEL_BYTES * part->width * part->height); }

// Returns the number of volume probes in a unit.
static uint32_t volume_probes(const olx_vulkan_update *u, uint32_t unit) {
  const uint32_t first = (unit - u->maps_end) * VOLUME_PART, all = u->field->info.volume.probe_count;
  return all - first < VOLUME_PART ? all - first : VOLUME_PART;
}

static uint32_t light_count(const olx_vulkan_update *u) {
  const uint32_t count = u->field->surfaces.light_count;
  return count > u->gpu->light_room ? 0 : count;
}

static uint32_t unit_bytes(const olx_vulkan_update *u, uint32_t unit) {
  if (unit == u->lights) return aligned(light_count(u) * (uint32_t)sizeof(olx_field_light)) + COPY_ALIGNMENT;
  if (unit >= u->maps_end) return aligned(volume_probes(u, unit) * OLX_VOLUME_HALVES * (uint32_t)sizeof(uint16_t));
  olx_map_part parts[4];
  uint32_t bytes = 0;
  const uint32_t count = map_parts(u, unit, parts);
  for (uint32_t i = 0; i < count; i++) bytes += UPDATED_MAPS * part_bytes(&parts[i]);
  return bytes;
}

// ---- Creation

static olx_result check(const olx_vulkan_field *gpu, const olx_relight *relight, const olx_vulkan_update_settings *s) {
  if (!olx_gpu_field_relights(gpu, &relight->field)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: the relighter's field has maps of other number or size", WHAT);
  }
  if (s->in_flight < 1 || s->in_flight > MOST_IN_FLIGHT) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u frames in flight: must be from 1 to %d", WHAT, s->in_flight,
                    MOST_IN_FLIGHT);
  }
  if (s->bytes >= 1 && s->bytes <= 1u << 28) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u bytes a frame: must be from 1 to 2^28", WHAT, s->bytes);
}

static olx_result build(olx_vulkan_update *u) {
  const olx_field_info *info = &u->field->info;
  u->parts = olx_relit_tiles_a_map(u->field->n) + 1;
  u->maps_end = info->probes.count * u->parts;
  u->lights = u->maps_end + (info->volume.probe_count + VOLUME_PART - 1) / VOLUME_PART;
  u->units = u->lights + 1;
  u->copied = olx_allocate_zero(u->units, sizeof *u->copied);
  if (!u->copied) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  // The largest unit of each kind decides.
  const uint32_t kinds[] = {0, u->parts - 1, u->maps_end},
                 lights = u->gpu->light_room * (uint32_t)sizeof(olx_field_light);
  u->slot_bytes = aligned(u->settings.bytes);
  if (u->slot_bytes < aligned(lights) + COPY_ALIGNMENT) u->slot_bytes = aligned(lights) + COPY_ALIGNMENT;
  for (uint32_t i = 0; i < 3; i++) {
    const uint32_t bytes = unit_bytes(u, kinds[i]);
    if (u->slot_bytes < bytes) u->slot_bytes = bytes;
  }
  return olx_staging_create(&u->gpu->context, (VkDeviceSize)u->slot_bytes * u->settings.in_flight, WHAT, &u->staging);
}

olx_result olx_vulkan_update_create(olx_vulkan_field *field, const olx_relight *relight,
                                    const olx_vulkan_update_settings *settings, olx_vulkan_update **update) {
  *update = NULL;
  OLX_TRY(check(field, relight, settings));
  olx_vulkan_update *u = olx_allocate_zero(1, sizeof *u);
  if (!u) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for its handle", WHAT);
  u->gpu = field;
  u->field = &relight->field;
  u->schedule = relight->schedule;
  u->part_frames = olx_relit_part_frames(u->schedule);
  u->settings = *settings;
  const olx_result result = build(u);
  if (result == OLX_OK) *update = u;
  else olx_vulkan_update_destroy(u);
  return result;
}

void olx_vulkan_update_destroy(olx_vulkan_update *u) {
  if (!u) return;
  olx_staging_destroy(&u->gpu->context, &u->staging);
  olx_release(u->copied);
  olx_release(u);
}

// ---- Recording

static VkDeviceSize staged_at(const olx_vulkan_update *u) { return (VkDeviceSize)u->slot * u->slot_bytes + u->used; }

static void copy_part(olx_vulkan_update *u, olx_map_copies *copies, uint32_t map, const uint32_t *texels,
                      const olx_map_part *part) {
  const uint32_t stride = copies->maps->stride, x = (uint32_t)(part->x + 1), y = (uint32_t)(part->y + 1);
  const VkDeviceSize offset = staged_at(u);
  for (uint32_t row = 0; row < part->height; row++) {
    memcpy(u->staging.mapped + offset + (size_t)row * part->width * TEXEL_BYTES,
           texels + (size_t)(y + row) * stride + x, (size_t)part->width * TEXEL_BYTES);
  }
  u->used += part_bytes(part);
  olx_map_copies_add(copies, map, part, offset);
}

static void copy_words(update_call *call, const void *data, uint32_t bytes, VkDeviceSize to) {
  olx_vulkan_update *u = call->update;
  const VkDeviceSize offset = staged_at(u);
  if (bytes == 0) return;
  memcpy(u->staging.mapped + offset, data, bytes);
  u->used += aligned(bytes);
  const VkBufferCopy region = {.srcOffset = offset, .dstOffset = to, .size = bytes};
  u->gpu->context.vk.CmdCopyBuffer(call->commands, u->staging.buffer, u->gpu->buffer, 1, &region);
}

static void copy_lights(update_call *call) {
  const olx_vulkan_update *u = call->update;
  const uint32_t count = light_count(u);
  copy_words(call, u->field->surfaces.lights, count * (uint32_t)sizeof(olx_field_light),
             u->gpu->words[OLX_WORDS_LIGHTS].offset);
  copy_words(call, &count, sizeof count, offsetof(olx_field_constants, light_count));
}

static void copy_volume(update_call *call, uint32_t unit) {
  const olx_vulkan_update *u = call->update;
  const uint32_t probe_bytes = OLX_VOLUME_HALVES * (uint32_t)sizeof(uint16_t),
                 first = (unit - u->maps_end) * VOLUME_PART;
  copy_words(call, u->field->volume.irradiance + (size_t)first * OLX_VOLUME_HALVES,
             volume_probes(u, unit) * probe_bytes,
             u->gpu->words[OLX_WORDS_VOLUME_LIGHT].offset + (VkDeviceSize)first * probe_bytes);
}

static void copy_map(update_call *call, uint32_t unit) {
  olx_vulkan_update *u = call->update;
  const olx_field *f = u->field;
  olx_map_part parts[4];
  const uint32_t count = map_parts(u, unit, parts), probe = unit / u->parts;
  const size_t first = f->texels * probe;
  for (uint32_t i = 0; i < count; i++) {
    copy_part(u, &call->direct, probe, f->surfaces.direct + first, &parts[i]);
    copy_part(u, &call->indirect, probe, f->surfaces.indirect + first, &parts[i]);
  }
}

static void copy_unit(update_call *call, uint32_t unit, olx_vulkan_update_stats *stats) {
  olx_vulkan_update *u = call->update;
  if (unit == u->lights) {
    copy_lights(call);
  } else if (unit >= u->maps_end) {
    copy_volume(call, unit);
    stats->volume_probes += volume_probes(u, unit);
  } else {
    copy_map(call, unit);
    stats->tiles += !is_border(u, unit);
  }
  u->copied[unit] = changed_frame(u, unit);
}

// Visits every unit once, from the one where the last call stopped, and copies what has changed; what does not fit
// waits for the next call. The first to be copied always fits.
static void copy_changes(update_call *call, olx_vulkan_update_stats *stats) {
  olx_vulkan_update *u = call->update;
  const uint32_t budget = aligned(u->settings.bytes);
  uint32_t first_left = UINT32_MAX;
  for (uint32_t i = 0; i < u->units; i++) {
    const uint32_t unit = (u->next + i) % u->units;
    if (changed_frame(u, unit) == u->copied[unit]) continue;
    const uint32_t bytes = unit_bytes(u, unit);
    if (first_left != UINT32_MAX || (u->used > 0 && u->used + bytes > budget)) {
      if (first_left == UINT32_MAX) first_left = unit;
      stats->waiting_bytes += bytes;
      continue;
    }
    if (u->used == 0) olx_map_copies_begin(u->gpu, call->commands);
    copy_unit(call, unit, stats);
    stats->bytes += bytes;
  }
  if (first_left != UINT32_MAX) u->next = first_left;
  u->scanned = first_left == UINT32_MAX;
  u->scanned_frame = olx_relit_frames(u->schedule);
}

olx_result olx_vulkan_record_update(olx_vulkan_update *u, VkCommandBuffer commands, olx_vulkan_update_stats *stats) {
  olx_vulkan_update_stats own;
  if (!stats) stats = &own;
  *stats = (olx_vulkan_update_stats){.bytes = 0};
  if (u->scanned && u->scanned_frame == olx_relit_frames(u->schedule)) return OLX_OK;
  update_call call = {.update = u,
                      .commands = commands,
                      .direct = olx_map_copies_of(u->gpu, OLX_BINDING_DIRECT, u->staging.buffer, commands),
                      .indirect = olx_map_copies_of(u->gpu, OLX_BINDING_INDIRECT, u->staging.buffer, commands)};
  u->used = 0;
  copy_changes(&call, stats);
  if (u->used == 0) return OLX_OK;
  olx_map_copies_record(&call.direct);
  olx_map_copies_record(&call.indirect);
  olx_map_copies_end(u->gpu, commands);
  u->slot = (u->slot + 1) % u->settings.in_flight;
  return OLX_OK;
}
