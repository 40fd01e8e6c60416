// Maps that a relighter has changed, copied to a field on the device: whole irradiance maps, tiles and borders of light
// field maps.
#include "core/hooks.h"
#include "shade/relighter.h"
#include "vulkan/map_copies.h"

static const char WHAT[] = "updates of a field on the device";

enum { MOST_IN_FLIGHT = 8, COPY_ALIGNMENT = 16, TEXEL_BYTES = 4 };

// Everything that changes by itself is a unit: irradiance maps first, then for each light field probe its tiles and its
// border.
struct olx_vulkan_update {
  olx_vulkan_field *gpu;
  const olx_relight *relight;
  olx_vulkan_update_settings settings;
  uint32_t units, maps, parts; // maps: of irradiance; parts: of a light field map
  uint32_t *copied;            // the frame of the relighter from which the device has a unit
  uint32_t next;               // unit to begin with, so that none starves
  uint32_t scanned;            // frame of the relighter of which nothing waits
  olx_staging staging;         // a slot for each frame in flight
  uint32_t slot_bytes, slot, used;
};

typedef struct update_call {
  olx_vulkan_update *update;
  olx_map_copies radiance, irradiance;
} update_call;

olx_vulkan_update_settings olx_vulkan_update_settings_default(void) {
  return (olx_vulkan_update_settings){.bytes = 4 << 20, .in_flight = 2};
}

static uint32_t changed_frame(const olx_vulkan_update *u, uint32_t unit) {
  return unit < u->maps ? u->relight->map_frames[unit] : u->relight->tile_frames[unit - u->maps];
}

static bool is_border(const olx_vulkan_update *u, uint32_t unit) {
  return unit >= u->maps && (unit - u->maps) % u->parts == u->parts - 1;
}

// The rectangles of which a unit consists, and the number of its map.
static uint32_t unit_parts(const olx_vulkan_update *u, uint32_t unit, uint32_t *map, olx_map_part parts[4]) {
  const olx_relight *r = u->relight;
  if (unit < u->maps) {
    *map = unit;
    parts[0] = (olx_map_part){-1, -1, r->field.irradiance_stride, r->field.irradiance_stride};
    return 1;
  }
  const uint32_t part = (unit - u->maps) % u->parts, n = r->field.n, side = r->tile_side;
  *map = (unit - u->maps) / u->parts;
  if (!is_border(u, unit)) {
    const uint32_t tiles = n / side;
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

static uint32_t unit_bytes(const olx_vulkan_update *u, uint32_t unit) {
  olx_map_part parts[4];
  uint32_t map, bytes = 0;
  const uint32_t count = unit_parts(u, unit, &map, parts);
  for (uint32_t i = 0; i < count; i++) bytes += part_bytes(&parts[i]);
  return bytes;
}

// ---- Making it

static olx_result check(const olx_vulkan_field *gpu, const olx_relight *relight, const olx_vulkan_update_settings *s) {
  const olx_gpu_maps *radiance = &gpu->maps[0], *irradiance = &gpu->maps[OLX_BINDING_IRRADIANCE - OLX_BINDING_RADIANCE];
  const olx_field *f = &relight->field;
  if (radiance->count != f->info.probe_count || irradiance->count != f->info.irradiance_probe_count ||
      radiance->stride != f->stride || irradiance->stride != f->irradiance_stride) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: the relighter's field has maps of other number or size", WHAT);
  }
  if (relight->on_device) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: the relighter's frames are made on a device", WHAT);
  }
  if (s->in_flight < 1 || s->in_flight > MOST_IN_FLIGHT) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u frames in flight: must be from 1 to %d", WHAT, s->in_flight,
                    MOST_IN_FLIGHT);
  }
  if (s->bytes >= 1 && s->bytes <= 1u << 28) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u bytes a frame: must be from 1 to 2^28", WHAT, s->bytes);
}

static olx_result build(olx_vulkan_update *u) {
  const olx_relight *r = u->relight;
  u->maps = r->counts[0];
  u->parts = r->tiles_a_probe + 1;
  u->units = u->maps + r->counts[1] * u->parts;
  u->copied = olx_allocate_zero(u->units, sizeof *u->copied);
  if (!u->copied) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  // The largest of each kind.
  const uint32_t kinds[] = {0, u->maps, u->maps + u->parts - 1};
  u->slot_bytes = aligned(u->settings.bytes);
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
  u->relight = relight;
  u->settings = *settings;
  const olx_result result = build(u);
  if (result == OLX_OK) *update = u;
  else olx_vulkan_update_destroy(u);
  if (result == OLX_OK) field->relit = true;
  return result;
}

void olx_vulkan_update_destroy(olx_vulkan_update *u) {
  if (!u) return;
  olx_staging_destroy(&u->gpu->context, &u->staging);
  olx_release(u->copied);
  olx_release(u);
}

// ---- Recording

static void copy_part(olx_vulkan_update *u, olx_map_copies *copies, uint32_t map, const uint32_t *texels,
                      const olx_map_part *part) {
  const uint32_t stride = copies->maps->stride, x = (uint32_t)(part->x + 1), y = (uint32_t)(part->y + 1);
  const VkDeviceSize offset = (VkDeviceSize)u->slot * u->slot_bytes + u->used;
  for (uint32_t row = 0; row < part->height; row++) {
    memcpy(u->staging.mapped + offset + (size_t)row * part->width * TEXEL_BYTES,
           texels + (size_t)(y + row) * stride + x, (size_t)part->width * TEXEL_BYTES);
  }
  u->used += part_bytes(part);
  olx_map_copies_add(copies, map, part, offset);
}

static void copy_unit(update_call *call, uint32_t unit) {
  olx_vulkan_update *u = call->update;
  const olx_field *f = &u->relight->field;
  olx_map_part parts[4];
  uint32_t map;
  const uint32_t count = unit_parts(u, unit, &map, parts);
  const bool irradiance = unit < u->maps;
  const uint32_t *texels = irradiance ? f->irradiance + f->irradiance_texels * map : f->radiance + f->texels * map;
  for (uint32_t i = 0; i < count; i++) {
    copy_part(u, irradiance ? &call->irradiance : &call->radiance, map, texels, &parts[i]);
  }
  u->copied[unit] = changed_frame(u, unit);
}

static void count_unit(const olx_vulkan_update *u, uint32_t unit, uint32_t bytes, olx_vulkan_update_stats *stats) {
  stats->bytes += bytes;
  if (unit < u->maps) stats->irradiance_maps++;
  else if (!is_border(u, unit)) stats->radiance_tiles++;
}

// All units once, from the one where the last call left off; what does not fit any more waits.
static void copy_changes(update_call *call, olx_vulkan_update_stats *stats) {
  olx_vulkan_update *u = call->update;
  uint32_t first_left = UINT32_MAX;
  for (uint32_t i = 0; i < u->units; i++) {
    const uint32_t unit = (u->next + i) % u->units;
    if (changed_frame(u, unit) == u->copied[unit]) continue;
    const uint32_t bytes = unit_bytes(u, unit);
    if (first_left != UINT32_MAX || u->used + bytes > u->slot_bytes) {
      if (first_left == UINT32_MAX) first_left = unit;
      stats->waiting_bytes += bytes;
      continue;
    }
    if (u->used == 0) olx_map_copies_begin(u->gpu, call->radiance.commands);
    copy_unit(call, unit);
    count_unit(u, unit, bytes, stats);
  }
  if (first_left != UINT32_MAX) u->next = first_left;
  else u->scanned = u->relight->frame;
}

olx_result olx_vulkan_record_update(olx_vulkan_update *u, VkCommandBuffer commands, olx_vulkan_update_stats *stats) {
  olx_vulkan_update_stats own;
  if (!stats) stats = &own;
  *stats = (olx_vulkan_update_stats){.bytes = 0};
  if (u->scanned == u->relight->frame) return OLX_OK;
  update_call call = {.update = u,
                      .radiance = olx_map_copies_of(u->gpu, OLX_BINDING_RADIANCE, u->staging.buffer, commands),
                      .irradiance = olx_map_copies_of(u->gpu, OLX_BINDING_IRRADIANCE, u->staging.buffer, commands)};
  u->used = 0;
  copy_changes(&call, stats);
  if (u->used == 0) return OLX_OK;
  olx_map_copies_record(&call.radiance);
  olx_map_copies_record(&call.irradiance);
  olx_map_copies_end(u->gpu, commands);
  u->slot = (u->slot + 1) % u->settings.in_flight;
  return OLX_OK;
}
