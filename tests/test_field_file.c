// Tests that reading a field file gives the data that was written to it.
#include "field_fixture.h"

#include "core/file.h"
#include "core/hooks.h"
#include "field/texels.h"

static const synthetic_shape single = {.grid = {1, 1, 1}, .irradiance_grid = {1, 1, 1}, .n = 128, .irradiance_n = 32};
static const synthetic_shape second_order = {
    .grid = {1, 2, 1}, .irradiance_grid = {2, 1, 3}, .n = 8, .irradiance_n = 8, .irradiance_form = OLX_IRRADIANCE_SH2};
// A shape without irradiance probes, with a selector between the required chunks and the last.
static const synthetic_shape relit_alone = {
    .grid = {2, 2, 1}, .n = 8, .select_mask = 1u << OLX_SELECT_VORONOI, .relight_surfels = 5};

static uint32_t bordered(const void *map, uint32_t n, size_t texel_bytes, int32_t x, int32_t y) {
  uint32_t texel = 0;
  memcpy(&texel, (const char *)map + ((size_t)(y + 1) * (n + 2) + (size_t)(x + 1)) * texel_bytes, texel_bytes);
  return texel;
}

// Asserts that a bordered map is the given one with the border that continues it on the sphere.
static void assert_map(const void *stored, const void *map, uint32_t n, size_t texel_bytes) {
  const int32_t size = (int32_t)n;
  for (int32_t y = -1; y <= size; y++) {
    for (int32_t x = -1; x <= size; x++) {
      int32_t source_x, source_y;
      olx_border_source(x, y, size, &source_x, &source_y);
      uint32_t expected = 0;
      memcpy(&expected, (const char *)map + ((size_t)source_y * n + (size_t)source_x) * texel_bytes, texel_bytes);
      assert_int_equal(bordered(stored, n, texel_bytes, x, y), expected);
    }
  }
}

static void assert_classic(const olx_field *field, const olx_field_header *header) {
  const olx_classic_maps *maps = &field->classic;
  const uint32_t size = header->info.classic.size;
  assert_int_equal(maps->size, size);
  assert_int_equal(field->info.classic.size, size);
  if (size == 0) {
    assert_int_equal(field->info.bytes.classic, 0);
    return;
  }
  assert_int_equal(field->info.classic.cube_size, header->info.classic.cube_size);
  assert_true(field->info.classic.sharpness == header->info.classic.sharpness);
  assert_memory_equal(maps->table, header->classic_table, 4 * OLX_CLASSIC_TABLE_ENTRIES);
  synthetic_classic *expected = olx_allocate(1, sizeof *expected);
  for (uint32_t i = 0; i < header->info.irradiance.probe_count; i++) {
    const olx_classic_record record = synthetic_classic_maps(size, i, header->irradiance_positions[i], expected);
    assert_map(maps->irradiance + maps->irradiance_texels * i, record.irradiance, size, 4);
    for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
      const uint32_t *stored = maps->radiance + maps->radiance_texels * i + maps->level_first[level];
      assert_map(stored, record.radiance[level], olx_classic_side(size, level), 4);
    }
    assert_memory_equal(&maps->boxes[i], &record.box, sizeof record.box);
  }
  olx_release(expected);
}

static void assert_relight(const olx_field *field, const synthetic_shape *shape) {
  const olx_relight_data *d = &field->relight;
  assert_int_equal(field->info.relight.surfels, shape->relight_surfels);
  if (shape->relight_surfels == 0) {
    assert_null(d->header);
    assert_int_equal(field->info.bytes.relight + field->info.relight.links, 0);
    return;
  }
  size_t size_bytes;
  void *written = synthetic_relight(shape, &size_bytes);
  assert_int_equal(field->info.bytes.relight, size_bytes);
  assert_memory_equal(d->header, written, size_bytes);
  olx_release(written);
  const olx_relight_header *h = d->header;
  assert_int_equal(h->surfels, shape->relight_surfels);
  assert_int_equal(field->info.relight.links, h->links);
  assert_int_equal(size_bytes, 64 + 108ull * h->surfels + 4ull * (h->surfels + 1) + 8ull * h->links + 8ull * h->blocks +
                                   4ull * (h->sites + 1) + 8ull * h->entries + 4);
  // Each array begins where the array before it ends.
  assert_ptr_equal(d->surfels, h + 1);
  assert_ptr_equal(d->link_starts, d->surfels + h->surfels);
  assert_ptr_equal(d->links, d->link_starts + h->surfels + 1);
  assert_ptr_equal(d->blocks, d->links + h->links);
  assert_ptr_equal(d->entry_starts, d->blocks + h->blocks);
  assert_ptr_equal(d->entries, d->entry_starts + h->sites + 1);
  assert_ptr_equal(d->volume_starts, d->entries + h->entries);
  assert_ptr_equal(d->volume_links, d->volume_starts + 1);
}

// Tiles name the same blocks as those of the probe alone.
static void assert_tiles(const olx_field *field, uint32_t probe, const olx_surface_maker *maker) {
  const olx_field_surfaces *s = &field->surfaces;
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    const olx_tiled_maps *all = &s->tiled[map], *own = &maker->maps[map];
    const uint32_t bytes = olx_surface_block_bytes(map);
    for (uint32_t i = 0; i < s->tile_side * s->tile_side; i++) {
      const uint32_t word = all->words[olx_first_tile(field, probe) + i], count = olx_tile_blocks(word);
      assert_int_equal(word >> OLX_TILE_FORM_SHIFT, own->words[i] >> OLX_TILE_FORM_SHIFT);
      assert_true((uint64_t)olx_tile_first(word) + count <= all->count);
      if (count == 0) continue;
      assert_memory_equal((const char *)all->blocks + (size_t)olx_tile_first(word) * bytes,
                          (const char *)own->blocks + (size_t)olx_tile_first(own->words[i]) * bytes,
                          (size_t)count * bytes);
    }
  }
  assert_true(!s->base && !s->specular && !s->direct && !s->indirect);
}

static void assert_surfaces(const olx_field *field, uint32_t probe, const uint16_t *distance,
                            synthetic_surfaces_room *room) {
  const olx_field_surfaces *s = &field->surfaces;
  const uint32_t n = field->n;
  olx_surface_maps maps = synthetic_surface_maps(n, probe, distance, room);
  if (field->info.maps.compressed) {
    olx_surface_maker maker;
    synthetic_surface_tiles(n, distance, &maker, &maps);
    assert_tiles(field, probe, &maker);
    olx_surface_maker_free(&maker);
  } else {
    assert_map(s->base + field->texels * probe, maps.base, n, 4);
    assert_map(s->specular + field->texels * probe, maps.specular, n, 2);
    assert_map(s->direct + field->texels * probe, maps.direct, n, 4);
    assert_map(s->indirect + field->texels * probe, maps.indirect, n, 4);
  }
  const int32_t size = (int32_t)n;
  for (int32_t y = -1; y <= size; y++) {
    for (int32_t x = -1; x <= size; x++) {
      int32_t source_x, source_y;
      olx_border_source(x, y, size, &source_x, &source_y);
      const olx_vec3 stored = olx_texel_emission(field, probe, olx_map_index(field->stride, x, y));
      assert_int_equal(olx_rgb9e5_pack(stored), maps.emission[(uint32_t)source_y * n + (uint32_t)source_x]);
    }
  }
}

// Returns the half float that is nearest to a texel's distance.
static uint16_t distance_code(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  const size_t texel = olx_map_index(field->stride, (int32_t)x, (int32_t)y);
  return olx_half_pack(olx_texel_distance(field, probe, texel) / field->distance_scale);
}

// Asserts that points are within a quarter of a footprint of their planes, that the planes' normals are near, and that
// texels at no distance are sky.
static void assert_geometry(const olx_field *field, uint32_t probe, const synthetic_geometry *geometry) {
  assert_true(!field->distance && !field->normal && field->planes.count > 0);
  for (uint32_t i = 0; i < geometry->n * geometry->n; i++) {
    const uint32_t x = i % geometry->n, y = i / geometry->n;
    const olx_geometry_texel truth = synthetic_geometry_texel(geometry, x, y);
    const size_t at = olx_map_index(field->stride, (int32_t)x, (int32_t)y);
    const olx_texel_geometry seen = olx_texel_geometry_of(field, probe, at);
    const bool sky = !(truth.distance > 0.0f && truth.distance < INFINITY);
    assert_int_equal(olx_texel_is_sky(field, probe, at), sky);
    if (sky) continue;
    const olx_vec3 direction = olx_texel_direction(x, y, geometry->n);
    const float off = (seen.distance - truth.distance) * olx_dot(seen.normal, direction);
    assert_true(fabsf(off) <= 0.2505f * truth.distance * 3.5449077f * 1.53f / (float)geometry->n);
    assert_true(olx_dot(seen.normal, truth.normal) > 0.799f);
  }
}

static void assert_irradiance(const olx_field *field, const synthetic_shape *shape, uint32_t probe,
                              const uint32_t *map) {
  const olx_irradiance_form form = shape->irradiance_form;
  assert_int_equal(field->info.irradiance.form, form);
  if (form == OLX_IRRADIANCE_OCTAHEDRAL) {
    assert_map(field->irradiance + field->irradiance_texels * probe, map, shape->irradiance_n, 4);
    return;
  }
  const uint32_t size_bytes = form == OLX_IRRADIANCE_SH2 ? 24 : 56;
  uint16_t halves[OLX_HARMONICS_MOST_HALVES];
  synthetic_harmonics(form, probe, halves);
  assert_memory_equal(field->harmonics + (size_t)field->harmonic_halves * probe, halves, size_bytes);
  assert_int_equal(field->info.bytes.irradiance, size_bytes * field->info.irradiance.probe_count);
  assert_null(field->irradiance);
}

static void assert_round_trip(field_fixture *f, const synthetic_shape *shape) {
  olx_field *field;
  size_t size_bytes;
  olx_release(field_written(f, shape, &size_bytes));
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);

  olx_field_header header = synthetic_header(shape);
  const uint32_t n = shape->n, m = shape->irradiance_n;
  uint32_t *color = olx_allocate(256 * 256, 4), *moments = olx_allocate(256 * 256, 4);
  uint16_t *normal = olx_allocate(256 * 256, 2), *distance = olx_allocate(256 * 256, 2);
  synthetic_surfaces_room *room = olx_allocate(1, sizeof *room);
  assert_int_equal(field->info.scene.light_count, SYNTHETIC_LIGHTS);
  assert_memory_equal(field->surfaces.lights, synthetic_lights, sizeof synthetic_lights);
  for (uint32_t i = 0; i < header.info.probes.count; i++) {
    synthetic_light_maps(n, i, color, normal, distance);
    if (header.info.irradiance.probe_count) assert_map(field->radiance + field->texels * i, color, n, 4);
    if (field->geometry) {
      assert_geometry(field, i, &(synthetic_geometry){n, normal, distance});
    } else {
      assert_map(field->normal + field->texels * i, normal, n, 2);
      assert_map(field->distance + field->texels * i, distance, n, 2);
    }
    for (uint32_t y = 0; y < n; y++) {
      for (uint32_t x = 0; x < n; x++) {
        const olx_pyramid_shape *pyramid = &field->pyramid;
        for (uint32_t level = 0; level < pyramid->levels; level++) {
          const uint32_t shift = olx_pyramid_shift(level);
          const uint32_t node = pyramid->first[level] + olx_pyramid_index(pyramid->side[level], x >> shift, y >> shift);
          if (level < pyramid->least_level) continue;
          const uint16_t code = distance_code(field, i, x, y);
          assert_true(field->least[(size_t)pyramid->least_nodes * i + node] <= code);
          if (level < pyramid->greatest_level) continue;
          assert_true(field->greatest[(size_t)pyramid->greatest_nodes * i + node] >= code);
        }
      }
    }
    assert_surfaces(field, i, distance, room);
    const olx_vec3 position = olx_field_probe_position(field, i);
    assert_memory_equal(&position, &header.probe_positions[i], sizeof position);
    assert_int_equal(olx_field_probe_buried(field, i), synthetic_flags(i));
  }
  assert_true((field->radiance != NULL) == (header.info.irradiance.probe_count > 0));
  for (uint32_t i = 0; i < header.info.irradiance.probe_count; i++) {
    synthetic_irradiance_maps(m, i, color, moments);
    assert_irradiance(field, shape, i, color);
    assert_map(field->moments + field->irradiance_texels * i, moments, m, 4);
    assert_memory_equal(&field->irradiance_positions[i], &header.irradiance_positions[i], sizeof(olx_vec3));
    assert_int_equal(field->irradiance_flags[i], synthetic_flags(i));
  }
  assert_classic(field, &header);
  assert_relight(field, shape);
  olx_release(room);
  olx_release(color);
  olx_release(moments);
  olx_release(normal);
  olx_release(distance);
  synthetic_header_release(&header);
  olx_field_close(field);
}

static void test_round_trip(void **state) {
  assert_round_trip(*state, &classic);
  assert_round_trip(*state, &relit);
  assert_round_trip(*state, &relit_alone);
  assert_round_trip(*state, &small);
  assert_round_trip(*state, &single);
  assert_round_trip(*state, &least);
  assert_round_trip(*state, &second_order);
  assert_round_trip(*state, &third_order);
  assert_round_trip(*state, &without_probe_light);
  assert_round_trip(*state, &of_blocks);
  assert_round_trip(*state, &of_planes);
}

// Decodes direct light from words and blocks, as docs/format.md describes them.
static olx_vec3 light_inside(const olx_field *field, uint32_t probe, int32_t x, int32_t y) {
  const olx_tiled_maps *maps = &field->surfaces.tiled[OLX_SURFACE_DIRECT];
  const olx_bc6h_block *blocks = maps->blocks;
  const uint32_t side = field->n / 8, column = (uint32_t)x, row = (uint32_t)y,
                 word = maps->words[(side * probe + row / 8) * side + column / 8], first = word & 0x3FFFFFFFu;
  if (word == 0) return olx_splat(0.0f);
  if (word >> 30 == 1) return olx_bc6h_texel(&blocks[first], row % 8 / 2 * 4 + column % 8 / 2);
  return olx_bc6h_texel(&blocks[first + row % 8 / 4 * 2 + column % 8 / 4], row % 4 * 4 + column % 4);
}

// A border texel equals the inner texel that it repeats, and rows for devices that cannot read blocks equal the decoded
// texels.
static void test_texels_of_tiles(void **state) {
  field_fixture *f = *state;
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, &of_blocks, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  const int32_t n = (int32_t)field->n;
  uint32_t base[18], direct[18], indirect[18];
  uint16_t specular[18];
  for (int32_t i = 0; i < 18 * 18; i++) {
    const int32_t x = i % 18 - 1, y = i / 18 - 1;
    int32_t source_x, source_y;
    olx_border_source(x, y, n, &source_x, &source_y);
    const uint32_t probe = (uint32_t)i % field->info.probes.count;
    const size_t inside = olx_map_index(field->stride, source_x, source_y);
    const size_t at = olx_map_index(field->stride, x, y);
    const olx_vec3 light = olx_texel_direct(field, probe, at),
                   expected = light_inside(field, probe, source_x, source_y);
    assert_memory_equal(&light, &expected, sizeof light);
    olx_surface_row(field, OLX_SURFACE_BASE, probe, (uint32_t)(y + 1), base);
    olx_surface_row(field, OLX_SURFACE_SPECULAR, probe, (uint32_t)(y + 1), specular);
    olx_surface_row(field, OLX_SURFACE_DIRECT, probe, (uint32_t)(y + 1), direct);
    olx_surface_row(field, OLX_SURFACE_INDIRECT, probe, (uint32_t)(y + 1), indirect);
    assert_int_equal(base[x + 1], olx_tiled_base(field, probe, inside));
    assert_int_equal(specular[x + 1], olx_tiled_specular(field, probe, inside));
    assert_int_equal(direct[x + 1], olx_rgb9e5_pack(light));
    assert_int_equal(indirect[x + 1], olx_rgb9e5_pack(olx_texel_indirect(field, probe, at)));
    const olx_bsdf bsdf = olx_texel_material(field, probe, at);
    const olx_reflectance r = olx_reflectance_unpack(specular[x + 1] >> 8);
    const olx_bsdf made = olx_bsdf_make(olx_base_color_unpack(base[x + 1]), r.metallic,
                                        (float)(specular[x + 1] & 255u) * (1.0f / 255.0f), r.specular_weight);
    assert_memory_equal(&bsdf, &made, sizeof bsdf);
  }
  olx_field_close(field);
}

// A field without irradiance probes reports none, and functions that read probe light say how to get it.
static void test_opens_without_probe_light(void **state) {
  field_fixture *f = *state;
  size_t size_bytes;
  olx_release(field_written(f, &without_probe_light, &size_bytes));
  olx_field *field;
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  const olx_field_info info = olx_field_describe(field);
  assert_int_equal(info.irradiance.probe_count + info.irradiance.buried + info.irradiance.size, 0);
  assert_int_equal(info.irradiance.grid.count[0] + info.irradiance.grid.count[1] + info.irradiance.grid.count[2], 0);
  assert_int_equal(info.bytes.radiance + info.bytes.irradiance + info.bytes.moments, 0);
  assert_int_equal(info.bytes.normal, 12 * 18 * 18 * 2);
  assert_null(field->radiance);
  assert_int_equal(olx_probe_light_check(field), OLX_ERROR_ARGUMENT);
  assert_says(f->path);
  assert_says("bake --probe-light");
  olx_sample_settings settings = olx_sample_settings_default();
  assert_int_equal(olx_sample_settings_check(field, &settings), OLX_OK);
  settings.hits = OLX_HITS_STORED;
  assert_int_equal(olx_sample_settings_check(field, &settings), OLX_ERROR_ARGUMENT);
  assert_says("bake --probe-light");
  olx_field_close(field);
}

// By default a field without probe light gives no light from irradiance probes, and shades hits instead of reading
// stored radiance.
static void test_samples_without_probe_light(void **state) {
  field_fixture *f = *state;
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, &without_probe_light, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  olx_sample_settings shaded = olx_sample_settings_default(), stored = shaded;
  stored.hits = OLX_HITS_STORED;
  const olx_vec3 origin = {0.1f, 0.5f, 0.2f}, up = {0.0f, 1.0f, 0.0f};
  uint32_t reflecting = 0;
  for (uint32_t i = 0; i < 64; i++) {
    const olx_vec3 direction = olx_texel_direction(i % 8, i / 8, 8);
    const olx_trace_hit a = olx_trace(field, &shaded, origin, direction, INFINITY),
                        b = olx_trace(field, &stored, origin, direction, INFINITY);
    assert_memory_equal(&a.radiance, &b.radiance, sizeof a.radiance);
    reflecting += a.radiance.x > 0.0f;
    const olx_vec3 none[] = {olx_irradiance(field, &shaded, origin, direction, direction),
                             olx_probe_irradiance(field, i, direction),
                             olx_volume_irradiance(field, origin, direction)};
    for (int k = 0; k < 3; k++) assert_true(none[k].x == 0.0f && none[k].y == 0.0f && none[k].z == 0.0f);
  }
  assert_true(reflecting > 0);
  // Where no light is stored there is none, and normal maps change nothing.
  const olx_vec3 light = olx_surface_irradiance(field, &shaded, olx_v3(90.0f, 90.0f, 90.0f), up, up, up);
  assert_true(light.x == 0.0f && light.y == 0.0f && light.z == 0.0f);
  assert_true(olx_field_irradiance_probe_buried(field, 0));
  olx_field_close(field);
}

// One near and one far texel, with the near one marked as an emitter, change the nodes that contain them and no others.
static void test_pyramids_bound_their_nodes(void **state) {
  (void)state;
  for (uint32_t n = 8; n <= 2048; n *= 2) {
    const olx_pyramid_shape shape = olx_pyramid_shape_of(n, false);
    const uint32_t near_x = n - 1, near_y = n / 2, far_x = n / 2 - 1, far_y = 3;
    uint16_t *distance = olx_allocate((size_t)n * n, 2), *nearest = olx_allocate(shape.least_nodes, 2),
             *farthest = olx_allocate(shape.greatest_nodes, 2);
    for (size_t i = 0; i < (size_t)n * n; i++) distance[i] = 0x3400;
    distance[near_y * n + near_x] = 0x8000 | 0x3000;
    distance[far_y * n + far_x] = 0x7C00;
    const olx_pyramid_base base = olx_pyramid_over_texels(distance, n);
    olx_pyramid_make(&shape, &base, nearest, farthest);
    uint32_t nodes = 0;
    for (uint32_t level = 0; level < shape.levels; level++) {
      const uint32_t side = shape.side[level], shift = olx_pyramid_shift(level);
      assert_int_equal(side << shift, n);
      for (uint32_t y = 0; y < side; y++) {
        for (uint32_t x = 0; x < side; x++, nodes++) {
          const uint32_t at = shape.first[level] + olx_pyramid_index(side, x, y);
          const bool near = x == near_x >> shift && y == near_y >> shift,
                     far = x == far_x >> shift && y == far_y >> shift;
          assert_int_equal(nearest[at], near ? 0x3000 : 0x3400);
          if (level >= shape.greatest_level) assert_int_equal(farthest[at], far ? 0x7C00 : 0x3400);
        }
      }
    }
    assert_int_equal(nodes, shape.least_nodes);
    olx_release(distance);
    olx_release(nearest);
    olx_release(farthest);
  }
}

static void test_describes(void **state) {
  field_fixture *f = *state;
  size_t size_bytes;
  olx_release(field_written(f, &small, &size_bytes));
  olx_field *field;
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  const olx_field_info info = olx_field_describe(field);
  assert_int_equal(info.probes.count, 12);
  assert_int_equal(info.irradiance.probe_count, 6);
  assert_int_equal(info.probes.buried, 4);
  assert_int_equal(info.irradiance.buried, 2);
  assert_true(info.probes.has_grid);
  assert_int_equal(info.probes.grid.count[0], 3);
  assert_int_equal(info.probes.grid.count[1], 2);
  assert_int_equal(info.probes.grid.count[2], 2);
  const olx_vec3 origin = info.probes.grid.origin, spacing = info.probes.grid.spacing;
  assert_true(origin.x == -1.0f && origin.y == 0.25f && origin.z == -0.5f);
  assert_true(spacing.x == 1.0f && spacing.y == 1.0f && spacing.z == 1.0f);
  assert_int_equal(info.irradiance.grid.count[2], 3);
  assert_true(info.irradiance.grid.spacing.y == 0.0f);
  assert_int_equal(info.maps.size, 16);
  assert_int_equal(info.irradiance.size, 8);
  assert_int_equal(info.select_mask, 1);
  assert_true(info.maps.distance_scale_metres == 12.5f);
  assert_true(info.scene.bounds_min.z == -4.5f && info.scene.bounds_max.y == 3.0f);
  assert_int_equal(info.bounces.count, 3);
  assert_int_equal(info.maps.samples, 2);
  assert_true(info.scene.hash == 0x0123456789ABCDEFu);
  assert_int_equal(info.bytes.file, size_bytes);
  assert_int_equal(info.bytes.radiance, 12 * 18 * 18 * 4);
  assert_int_equal(info.bytes.normal, 12 * 18 * 18 * 2);
  assert_int_equal(info.bytes.distance, 12 * 18 * 18 * 2);
  assert_int_equal(info.bytes.pyramid, 12 * 4 * 4 * 2 * 2);
  assert_int_equal(info.bytes.irradiance, 6 * 10 * 10 * 4);
  assert_int_equal(info.bytes.moments, 6 * 10 * 10 * 4);
  assert_int_equal(info.bytes.selectors, 0);
  assert_int_equal(info.bytes.material, 12 * 18 * 18 * 6);
  assert_int_equal(info.bytes.direct, 12 * 18 * 18 * 4);
  assert_int_equal(info.bytes.indirect, 12 * 18 * 18 * 4);
  // Four tiles a probe, of which odd probes hold the lower two alone.
  assert_int_equal(info.bytes.emission, 12 * 4 * 4 + 6 * (4 + 2) * 64 * 4);
  assert_int_equal(info.scene.light_count, 3);
  assert_false(info.maps.compressed);
  olx_field_close(field);
}

// A tile takes 16 bytes and 1 or 4 blocks of each kind, 56 bytes together, where texels take 14 each and have borders.
static void test_describes_tiles(void **state) {
  field_fixture *f = *state;
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, &of_blocks, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  const olx_field_info info = olx_field_describe(field);
  assert_true(info.maps.compressed);
  const uint64_t tiles = 12 * 4, blocks = 8 * 4 * 4 + 4 * 4; // in every third probe each tile is of one surface
  assert_int_equal(info.bytes.material, tiles * 8 + blocks * (8 + 16));
  assert_int_equal(info.bytes.direct, tiles * 4 + blocks * 16);
  assert_int_equal(info.bytes.indirect, tiles * 4 + blocks * 16);
  olx_field_close(field);
}

static void test_same_input_same_bytes(void **state) {
  size_t first_size, second_size;
  unsigned char *first = field_written(*state, &small, &first_size),
                *second = field_written(*state, &small, &second_size);
  assert_int_equal(first_size, second_size);
  assert_memory_equal(first, second, first_size);
  olx_release(first);
  olx_release(second);
}

static void test_two_fields_at_once(void **state) {
  field_fixture *f = *state;
  size_t size_bytes;
  unsigned char *bytes = field_written(f, &single, &size_bytes);
  olx_field *in_memory, *mapped;
  assert_int_equal(olx_field_open_memory(bytes, size_bytes, &in_memory), OLX_OK);
  assert_int_equal(synthetic_write(f->path, &small, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &mapped), OLX_OK);
  assert_int_equal(olx_field_describe(in_memory).maps.size, 128);
  assert_int_equal(olx_field_describe(mapped).maps.size, 16);
  // The mapping outlives the file's name.
  assert_int_equal(synthetic_write(f->path, &least, NULL), OLX_OK);
  assert_int_equal(olx_field_verify(mapped), OLX_OK);
  assert_int_equal(olx_field_verify(in_memory), OLX_OK);
  olx_field_close(in_memory);
  olx_field_close(mapped);
  olx_field_close(NULL);
  olx_release(bytes);
}

static void test_opening_names_the_file(void **state) {
  const field_fixture *f = *state;
  olx_field *field;
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FILE);
  assert_null(field);
  assert_says(f->path);
  assert_int_equal(olx_field_open(f->folder, &field), OLX_ERROR_FILE);
  assert_int_equal(olx_write_file(f->path, "", 0), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FORMAT);
  assert_says(f->path);
  assert_int_equal(olx_write_file(f->path, "#?RADIANCE\n", 11), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FORMAT);
}

static void test_says_which_option_is_missing(void **state) {
  const field_fixture *f = *state;
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, &least, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  assert_int_equal(olx_classic_check(field), OLX_ERROR_ARGUMENT);
  assert_says(f->path);
  assert_says("bake --classic");
  olx_field_close(field);
  assert_int_equal(synthetic_write(f->path, &classic, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  assert_int_equal(olx_classic_check(field), OLX_OK);
  olx_relight *relight;
  const olx_relight_settings settings = olx_relight_settings_default();
  assert_int_equal(olx_relight_create(field, &settings, &relight), OLX_ERROR_ARGUMENT);
  assert_null(relight);
  assert_says("bake --relight");
  olx_field_close(field);
}

// A host may pass any number: nothing is read out of bounds, and the host is not aborted.
static void test_answers_numbers_out_of_range(void **state) {
  const field_fixture *f = *state;
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, &least, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  const olx_field_info info = olx_field_describe(field);
  const uint32_t beyond[] = {info.probes.count, info.irradiance.probe_count, 999, UINT32_MAX};
  for (uint32_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
    if (beyond[i] >= info.probes.count) {
      const olx_vec3 position = olx_field_probe_position(field, beyond[i]);
      assert_true(isnan(position.x) && isnan(position.y) && isnan(position.z));
      assert_true(olx_field_probe_buried(field, beyond[i]));
    }
    if (beyond[i] < info.irradiance.probe_count) continue;
    assert_true(olx_field_irradiance_probe_buried(field, beyond[i]));
    const olx_vec3 irradiance = olx_probe_irradiance(field, beyond[i], olx_v3(0.0f, 1.0f, 0.0f));
    assert_true(irradiance.x == 0.0f && irradiance.y == 0.0f && irradiance.z == 0.0f);
  }
  olx_sample_settings settings = olx_sample_settings_default();
  settings.select = (olx_select)(OLX_SELECT_BEST + 1);
  assert_int_equal(olx_sample_settings_check(field, &settings), OLX_ERROR_ARGUMENT);
  assert_says(f->path);
  settings = olx_sample_settings_default();
  settings.tracer = (olx_tracer)77;
  assert_int_equal(olx_sample_settings_check(field, &settings), OLX_ERROR_ARGUMENT);
  olx_field_close(field);
  assert_string_equal(olx_select_name((olx_select)(OLX_SELECT_BEST + 1)), "unknown");
  assert_string_equal(olx_select_name((olx_select)-1), "unknown");
  assert_string_equal(olx_irradiance_form_name((olx_irradiance_form)(OLX_IRRADIANCE_SH3 + 1)), "unknown");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_round_trip, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_texels_of_tiles, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_describes_tiles, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_opens_without_probe_light, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_samples_without_probe_light, field_set_up, field_tear_down),
      cmocka_unit_test(test_pyramids_bound_their_nodes),
      cmocka_unit_test_setup_teardown(test_describes, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_same_input_same_bytes, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_two_fields_at_once, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_opening_names_the_file, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_says_which_option_is_missing, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_answers_numbers_out_of_range, field_set_up, field_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
