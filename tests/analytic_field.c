// Makes fields of rooms and boxes in memory, whose distances, normals and light follow in closed form, for tests of the
// runtime.
#include "analytic_field.h"

#include "core/hooks.h"
#include "core/sampling.h"
#include "field/geometry_map_encode.h"
#include "field/surface_encode.h"
#include "field/texels.h"
#include "select/cage.h"

#include <stdlib.h>

static void slabs(const analytic_box *box, olx_vec3 o, olx_vec3 d, float *near, float *far, int *near_axis,
                  int *far_axis) {
  *near = -INFINITY;
  *far = INFINITY;
  *near_axis = *far_axis = 0;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const float da = olx_component(d, axis), oa = olx_component(o, axis);
    float t0 = (olx_component(box->min, axis) - oa) / da, t1 = (olx_component(box->max, axis) - oa) / da;
    if (da == 0.0f) {
      const bool inside = oa >= olx_component(box->min, axis) && oa <= olx_component(box->max, axis);
      t0 = inside ? -INFINITY : INFINITY;
      t1 = inside ? INFINITY : -INFINITY;
    }
    if (t0 > t1) {
      const float swap = t0;
      t0 = t1;
      t1 = swap;
    }
    if (t0 > *near) {
      *near = t0;
      *near_axis = (int)axis;
    }
    if (t1 < *far) {
      *far = t1;
      *far_axis = (int)axis;
    }
  }
}

static olx_vec3 axis_normal(int axis, olx_vec3 direction) {
  const float s = olx_component(direction, (uint32_t)axis) > 0.0f ? -1.0f : 1.0f;
  return olx_v3(axis == 0 ? s : 0.0f, axis == 1 ? s : 0.0f, axis == 2 ? s : 0.0f);
}

analytic_hit analytic_cast(const analytic_scene *scene, olx_vec3 origin, olx_vec3 direction) {
  float near, far;
  int near_axis, far_axis;
  slabs(&scene->room, origin, direction, &near, &far, &near_axis, &far_axis);
  analytic_hit hit = {far, axis_normal(far_axis, direction)};
  if (scene->open && far_axis == 1 && direction.y > 0.0f) hit.t = INFINITY;
  for (uint32_t i = 0; i < scene->box_count; i++) {
    slabs(&scene->boxes[i], origin, direction, &near, &far, &near_axis, &far_axis);
    if (near < far && near > 1e-5f && near < hit.t) hit = (analytic_hit){near, axis_normal(near_axis, direction)};
  }
  return hit;
}

olx_vec3 analytic_radiance(olx_vec3 p, olx_vec3 n) {
  return olx_v3(1.0f + 0.5f * sinf(p.x + n.x), 1.0f + 0.5f * cosf(p.y + n.y), 1.0f + 0.5f * sinf(p.z - n.z));
}

olx_vec3 analytic_albedo(olx_vec3 p, olx_vec3 n) {
  return olx_v3(0.5f + 0.3f * sinf(2.0f * p.x + n.y), 0.5f + 0.3f * cosf(p.z - n.x), 0.5f + 0.3f * sinf(p.y + n.z));
}

static void *zeroed(size_t count, size_t size) {
  void *memory = calloc(count, size);
  if (!memory) abort();
  return memory;
}

static void fill_probe(const analytic_scene *scene, olx_field *f, uint32_t probe, uint32_t *radiance, uint16_t *normal,
                       uint16_t *distance) {
  const int32_t n = (int32_t)f->n;
  for (int32_t y = -1; y <= n; y++) {
    for (int32_t x = -1; x <= n; x++) {
      int32_t sx, sy;
      olx_border_source(x, y, n, &sx, &sy);
      const olx_vec3 d = olx_texel_direction((uint32_t)sx, (uint32_t)sy, f->n);
      const analytic_hit hit = analytic_cast(scene, f->probe_positions[probe], d);
      const size_t index = f->texels * probe + olx_map_index(f->stride, x, y);
      distance[index] = olx_half_pack(hit.t / f->distance_scale);
      normal[index] = olx_normal_pack(hit.normal);
      const olx_vec3 p = olx_madd(f->probe_positions[probe], d, hit.t);
      radiance[index] = olx_r11g11b10f_pack(hit.t < INFINITY ? analytic_radiance(p, hit.normal) : olx_splat(4.0f));
    }
  }
}

// Writable views of a field's surface maps while they are filled.
typedef struct surface_maps {
  uint32_t *base, *direct, *indirect, *emission, *tiles;
  uint16_t *specular;
} surface_maps;

static void fill_surface(const analytic_scene *scene, const olx_field *f, uint32_t probe, int32_t x, int32_t y,
                         const surface_maps *maps) {
  int32_t sx, sy;
  olx_border_source(x, y, (int32_t)f->n, &sx, &sy);
  const olx_vec3 d = olx_texel_direction((uint32_t)sx, (uint32_t)sy, f->n);
  const analytic_hit hit = analytic_cast(scene, f->probe_positions[probe], d);
  if (!(hit.t < INFINITY)) return;
  const size_t index = f->texels * probe + olx_map_index(f->stride, x, y);
  const olx_vec3 p = olx_madd(f->probe_positions[probe], d, hit.t), albedo = analytic_albedo(p, hit.normal);
  const olx_texel_material_codes material = olx_material_pack(albedo, 1.0f, 0.0f, 0.0f);
  maps->base[index] = material.base;
  maps->specular[index] = material.specular;
  const olx_vec3 sent = olx_scale(analytic_radiance(p, hit.normal), OLX_PI);
  maps->indirect[index] = olx_rgb9e5_pack(olx_v3(sent.x / albedo.x, sent.y / albedo.y, sent.z / albedo.z));
}

// Points every tile that holds sky to the one tile of the sky's emission; texels that are not sky do not read it.
static void fill_emission(const olx_field *f, uint32_t probe, const surface_maps *maps) {
  const uint32_t side = f->surfaces.tile_side;
  for (uint32_t i = 0; i < f->n * f->n; i++) {
    const uint32_t x = i % f->n, y = i / f->n;
    const size_t at = f->texels * probe + olx_map_index(f->stride, (int32_t)x, (int32_t)y);
    const size_t tile = (size_t)y / OLX_EMISSION_TILE * side + x / OLX_EMISSION_TILE;
    if (f->distance[at] == 0x7C00) maps->emission[(size_t)side * side * probe + tile] = 1;
  }
}

static void fill_surfaces(const analytic_scene *scene, olx_field *f, uint32_t count) {
  const uint32_t side = f->n / OLX_EMISSION_TILE;
  const size_t texels = f->texels * count;
  const surface_maps maps = {.base = zeroed(texels, 4),
                             .direct = zeroed(texels, 4),
                             .indirect = zeroed(texels, 4),
                             .emission = zeroed((size_t)side * side * count, 4),
                             .tiles = zeroed(OLX_EMISSION_TILE_TEXELS, 4),
                             .specular = zeroed(texels, 2)};
  f->surfaces = (olx_field_surfaces){.base = maps.base,
                                     .specular = maps.specular,
                                     .direct = maps.direct,
                                     .indirect = maps.indirect,
                                     .emission = maps.emission,
                                     .tiles = maps.tiles,
                                     .tile_side = side,
                                     .tile_count = 1};
  for (uint32_t i = 0; i < OLX_EMISSION_TILE_TEXELS; i++) maps.tiles[i] = olx_rgb9e5_pack(olx_splat(4.0f));
  const int32_t n = (int32_t)f->n;
  for (uint32_t probe = 0; probe < count; probe++) {
    for (int32_t y = -1; y <= n; y++) {
      for (int32_t x = -1; x <= n; x++) fill_surface(scene, f, probe, x, y, &maps);
    }
    fill_emission(f, probe, &maps);
  }
}

static void fill_irradiance(const analytic_scene *scene, olx_field *f, uint32_t probe, uint32_t *irradiance,
                            uint32_t *moments) {
  const int32_t n = (int32_t)f->irradiance_n;
  for (int32_t y = -1; y <= n; y++) {
    for (int32_t x = -1; x <= n; x++) {
      int32_t sx, sy;
      olx_border_source(x, y, n, &sx, &sy);
      const olx_vec3 d = olx_texel_direction((uint32_t)sx, (uint32_t)sy, f->irradiance_n);
      const float t = analytic_cast(scene, f->irradiance_positions[probe], d).t / f->distance_scale;
      const float r = t < 1.0f ? t : 1.0f;
      const size_t index = f->irradiance_texels * probe + olx_map_index(f->irradiance_stride, x, y);
      moments[index] = (uint32_t)olx_half_pack(r) | (uint32_t)olx_half_pack(r * r) << 16;
      irradiance[index] = olx_r11g11b10f_pack(olx_splat((float)(probe + 1)));
    }
  }
}

olx_field *analytic_field_make(const analytic_scene *scene, const olx_grid *grid, uint32_t n, uint32_t irradiance_n) {
  const uint32_t count = grid->count[0] * grid->count[1] * grid->count[2];
  olx_field *f = zeroed(1, sizeof *f);
  const float scale = olx_length(olx_sub(scene->room.max, scene->room.min));
  f->info = (olx_field_info){.probes.count = count,
                             .irradiance.probe_count = count,
                             .probes.has_grid = true,
                             .probes.grid = *grid,
                             .irradiance.grid = *grid,
                             .maps.size = n,
                             .irradiance.size = irradiance_n,
                             .select_mask = 1u << OLX_SELECT_CAGE,
                             .maps.distance_scale_metres = scale,
                             .scene.bounds_min = scene->room.min,
                             .scene.bounds_max = scene->room.max};
  f->n = n;
  f->stride = n + 2;
  f->texels = (size_t)f->stride * f->stride;
  f->pyramid = olx_pyramid_shape_of(n, false);
  f->irradiance_n = irradiance_n;
  f->irradiance_stride = irradiance_n + 2;
  f->irradiance_texels = (size_t)f->irradiance_stride * f->irradiance_stride;
  f->distance_scale = scale;
  olx_vec3 *positions = zeroed(count, sizeof *positions);
  uint8_t *flags = zeroed(count, 1);
  for (uint32_t i = 0; i < count; i++) positions[i] = olx_grid_position(grid, i);
  f->probe_positions = f->irradiance_positions = positions;
  f->probe_flags = f->irradiance_flags = flags;
  uint32_t *radiance = zeroed(f->texels * count, 4), *irradiance = zeroed(f->irradiance_texels * count, 4),
           *moments = zeroed(f->irradiance_texels * count, 4);
  uint16_t *normal = zeroed(f->texels * count, 2), *distance = zeroed(f->texels * count, 2),
           *least = zeroed((size_t)f->pyramid.least_nodes * count, 2),
           *greatest = zeroed((size_t)f->pyramid.greatest_nodes * count, 2);
  f->radiance = radiance;
  f->normal = normal;
  f->distance = distance;
  f->least = least;
  f->greatest = greatest;
  f->irradiance = irradiance;
  f->moments = moments;
  for (uint32_t i = 0; i < count; i++) {
    fill_probe(scene, f, i, radiance, normal, distance);
    const olx_pyramid_base base = olx_pyramid_over_texels(distance + f->texels * i + f->stride + 1, f->stride);
    olx_pyramid_make(&f->pyramid, &base, least + (size_t)f->pyramid.least_nodes * i,
                     greatest + (size_t)f->pyramid.greatest_nodes * i);
    fill_irradiance(scene, f, i, irradiance, moments);
  }
  fill_surfaces(scene, f, count);
  return f;
}

// Copies the inside of a probe's bordered map, without its border.
static void copy_inside(const olx_field *f, const void *map, uint32_t probe, size_t texel_bytes, void *inside) {
  const char *from = (const char *)map + f->texels * probe * texel_bytes;
  for (uint32_t y = 0; y < f->n; y++) {
    memcpy((char *)inside + y * f->n * texel_bytes, from + olx_map_index(f->stride, 0, (int32_t)y) * texel_bytes,
           f->n * texel_bytes);
  }
}

void analytic_field_compress(olx_field *f) {
  const size_t texels = (size_t)f->n * f->n, tiles = texels / OLX_TILE_TEXELS;
  const uint32_t probes = f->info.probes.count;
  const olx_field_surfaces plain = f->surfaces;
  uint32_t *base = zeroed(texels, 4), *direct = zeroed(texels, 4), *indirect = zeroed(texels, 4);
  uint16_t *specular = zeroed(texels, 2), *distance = zeroed(texels, 2);
  uint32_t *words[OLX_SURFACE_MAPS];
  char *pools[OLX_SURFACE_MAPS];
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    words[map] = zeroed(tiles * probes, sizeof *words[map]);
    pools[map] = zeroed(4 * tiles * probes, olx_surface_block_bytes(map));
    f->surfaces.tiled[map] = (olx_tiled_maps){words[map], pools[map], 0};
  }
  olx_surface_maker maker;
  if (olx_surface_maker_create(f->n, &maker) != OLX_OK) abort();
  const olx_surface_texels inside = {base, specular, direct, indirect, distance};
  for (uint32_t probe = 0; probe < probes; probe++) {
    copy_inside(f, plain.base, probe, 4, base);
    copy_inside(f, plain.specular, probe, 2, specular);
    copy_inside(f, plain.direct, probe, 4, direct);
    copy_inside(f, plain.indirect, probe, 4, indirect);
    copy_inside(f, f->distance, probe, 2, distance);
    if (olx_surface_maker_encode(&maker, &inside, f->n, 1) != OLX_OK) abort();
    for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
      const olx_tiled_maps *own = &maker.maps[map];
      uint32_t *used = &f->surfaces.tiled[map].count;
      for (size_t i = 0; i < tiles; i++) words[map][tiles * probe + i] = own->words[i] ? own->words[i] + *used : 0;
      memcpy(pools[map] + (size_t)*used * olx_surface_block_bytes(map), own->blocks,
             (size_t)own->count * olx_surface_block_bytes(map));
      *used += own->count;
    }
  }
  olx_surface_maker_free(&maker);
  f->info.maps.compressed = true;
  f->surfaces.tile_side = f->n / OLX_TILE_SIDE;
  f->surfaces.base = f->surfaces.direct = f->surfaces.indirect = NULL;
  f->surfaces.specular = NULL;
  const void *done[] = {plain.base, plain.specular, plain.direct, plain.indirect, base,
                        specular,   direct,         indirect,     distance};
  for (size_t i = 0; i < sizeof done / sizeof *done; i++) free((void *)(uintptr_t)done[i]);
}

static olx_geometry_texel look_at(const void *field, uint32_t x, uint32_t y) {
  const olx_field *f = field; // a field of one probe
  const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
  return (olx_geometry_texel){olx_texel_distance(f, 0, texel), olx_texel_normal(f, 0, texel)};
}

void analytic_field_block_geometry(olx_field *f) {
  const uint32_t count = f->info.probes.count, side = f->n / OLX_BLOCK_SIDE, blocks = side * side;
  olx_geometry_block *geometry = zeroed((size_t)count * blocks, sizeof *geometry);
  olx_plane_code *planes = zeroed((size_t)count * blocks * OLX_BLOCK_TEXELS, sizeof *planes);
  uint16_t *least = zeroed(blocks, 2), *greatest = zeroed(blocks, 2);
  uint32_t used = 0;
  f->pyramid = olx_pyramid_shape_of(f->n, true);
  olx_geometry_maker maker;
  if (olx_geometry_maker_create(f->n, &maker) != OLX_OK) abort();
  for (uint32_t probe = 0; probe < count; probe++) {
    olx_field one = *f;
    one.distance += f->texels * probe;
    one.normal += f->texels * probe;
    if (olx_geometry_maker_encode(&maker, f->n, 1, look_at, &one) != OLX_OK) abort();
    const olx_pyramid_base base = olx_pyramid_over_blocks(&maker.map, f->n, f->distance_scale, least, greatest);
    olx_pyramid_make(&f->pyramid, &base, (uint16_t *)(uintptr_t)f->least + (size_t)f->pyramid.least_nodes * probe,
                     (uint16_t *)(uintptr_t)f->greatest + (size_t)f->pyramid.greatest_nodes * probe);
    for (uint32_t i = 0; i < blocks; i++) {
      olx_geometry_block *block = &geometry[(size_t)blocks * probe + i];
      *block = maker.map.blocks[i];
      if (block->words[3] >> 30 == OLX_GEOMETRY_POOL) block->words[0] += used;
    }
    for (uint32_t i = 0; i < maker.map.pool.count; i++) planes[used++] = maker.map.pool.planes[i];
  }
  olx_geometry_maker_free(&maker);
  free(least);
  free(greatest);
  free((void *)(uintptr_t)f->distance);
  free((void *)(uintptr_t)f->normal);
  f->distance = f->normal = NULL;
  f->info.maps.geometry_blocks = true;
  f->geometry = geometry;
  f->planes = (olx_plane_pool){planes, used};
}

void analytic_field_free(olx_field *f) {
  const olx_field_surfaces *s = &f->surfaces;
  const void *blocks[] = {f->probe_positions, f->probe_flags,
                          f->radiance,        f->normal,
                          f->distance,        f->least,
                          f->greatest,        f->irradiance,
                          f->moments,         s->base,
                          s->specular,        s->direct,
                          s->indirect,        s->emission,
                          s->tiles,           s->tiled[0].words,
                          s->tiled[1].words,  s->tiled[2].words,
                          s->tiled[3].words,  s->tiled[0].blocks,
                          s->tiled[1].blocks, s->tiled[2].blocks,
                          s->tiled[3].blocks, f->geometry,
                          f->planes.planes,   f};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) free((void *)(uintptr_t)blocks[i]);
}

static uint32_t *random_colors(size_t count, uint32_t seed) {
  uint32_t *codes = olx_allocate(count, sizeof *codes);
  for (size_t i = 0; i < count; i++) {
    const float a = olx_unit_float(olx_hash2((uint32_t)i, seed)), b = olx_unit_float(olx_hash2((uint32_t)i, seed + 1));
    codes[i] = olx_r11g11b10f_pack(olx_v3(a, b, 0.25f + a * b));
  }
  return codes;
}

void analytic_field_add_classic(olx_field *field, uint32_t size) {
  const uint32_t probes = field->info.irradiance.probe_count;
  olx_classic_maps *maps = &field->classic;
  *maps = (olx_classic_maps){.size = size,
                             .irradiance_texels = (size_t)(size + 2) * (size + 2),
                             .radiance_texels = olx_classic_first(size, OLX_CLASSIC_LEVELS)};
  for (uint32_t i = 0; i < OLX_CLASSIC_LEVELS; i++) maps->level_first[i] = olx_classic_first(size, i);
  maps->irradiance = random_colors(maps->irradiance_texels * probes, 1);
  maps->radiance = random_colors(maps->radiance_texels * probes, 3);
  uint32_t *table = olx_allocate(OLX_CLASSIC_TABLE_ENTRIES, sizeof *table);
  for (uint32_t i = 0; i < OLX_CLASSIC_TABLE_ENTRIES; i++) {
    const float a = olx_unit_float(olx_hash2(i, 5));
    table[i] = olx_half_pack(a) | (uint32_t)olx_half_pack(1.0f - a) << 16;
  }
  maps->table = table;
  olx_classic_box *boxes = olx_allocate(probes, sizeof *boxes);
  for (uint32_t i = 0; i < probes; i++) {
    const olx_vec3 p = field->irradiance_positions[i],
                   some = {0.3f + 0.1f * (float)(i % 5), 0.5f, 0.4f + 0.2f * (float)(i % 3)};
    boxes[i] = (olx_classic_box){olx_sub(p, some), olx_add(p, olx_scale(some, 2.0f))};
  }
  maps->boxes = boxes;
  field->info.classic.size = size;
}

void analytic_field_remove_classic(olx_field *field) {
  olx_release((void *)(uintptr_t)field->classic.irradiance);
  olx_release((void *)(uintptr_t)field->classic.radiance);
  olx_release((void *)(uintptr_t)field->classic.table);
  olx_release((void *)(uintptr_t)field->classic.boxes);
}
