// Holds the table of the kinds of chunks in a field file, and answers what follows from it alone: shapes, which chunks
// a description calls for, and which lie on a device.
#include "field/field_chunks.h"

static uint64_t one(const olx_field_info *info) { return (void)info, 1; }
static uint64_t probes(const olx_field_info *info) { return info->probes.count; }
static uint64_t irradiance_probes(const olx_field_info *info) { return info->irradiance.probe_count; }
static uint64_t volume_probes(const olx_field_info *info) { return info->volume.probe_count; }
static uint64_t classic_probes(const olx_field_info *info) { return info->classic.size ? irradiance_probes(info) : 0; }
static uint64_t seen_probes(const olx_field_info *info) { return info->irradiance.probe_count ? probes(info) : 0; }

static uint64_t square(uint64_t side) { return side * side; }
static uint64_t texels(const olx_field_info *info) { return square((uint64_t)info->maps.size + 2); }
static uint64_t blocks(const olx_field_info *info) { return square(info->maps.size / OLX_BLOCK_SIDE); }
static uint64_t tiles(const olx_field_info *info) { return square(info->maps.size / OLX_EMISSION_TILE); }
static uint64_t irradiance_texels(const olx_field_info *info) { return square((uint64_t)info->irradiance.size + 2); }
static uint64_t classic_texels(const olx_field_info *info) { return square((uint64_t)info->classic.size + 2); }

static uint64_t classic_radiance(const olx_field_info *info) {
  return olx_classic_first(info->classic.size, OLX_CLASSIC_LEVELS);
}

static uint64_t harmonics(const olx_field_info *info) {
  return olx_harmonics_halves(olx_irradiance_bands(info->irradiance.form));
}

static uint64_t least_nodes(const olx_field_info *info) {
  return olx_pyramid_shape_of(info->maps.size, info->maps.geometry_blocks).least_nodes;
}

static uint64_t greatest_nodes(const olx_field_info *info) {
  return olx_pyramid_shape_of(info->maps.size, info->maps.geometry_blocks).greatest_nodes;
}

static bool in_every_field(const olx_field_info *info) { return (void)info, true; }
static bool has_probe_light(const olx_field_info *info) { return info->irradiance.probe_count > 0; }
static bool has_harmonics(const olx_field_info *info) { return olx_irradiance_bands(info->irradiance.form) > 0; }
static bool has_tiles(const olx_field_info *info) { return info->maps.compressed; }
static bool has_geometry_blocks(const olx_field_info *info) { return info->maps.geometry_blocks; }
static bool has_geometry_texels(const olx_field_info *info) { return !info->maps.geometry_blocks; }

static const olx_chunk_need always = {in_every_field, NULL}, probe_light = {has_probe_light, "no irradiance probes"},
                            geometry_texels = {has_geometry_texels, "geometry in blocks"},
                            geometry_blocks = {has_geometry_blocks, NULL}, surface_tiles = {has_tiles, NULL};

#define TYPE(a, b, c, d) .type = OLX_FOUR_CC(a, b, c, d)
#define DATA(member) .data = offsetof(olx_field, member)
#define BYTES(member) .bytes = offsetof(olx_bytes_info, member)

const olx_chunk_traits olx_chunk_kinds[OLX_CHUNK_KINDS] = {
    [OLX_CHUNK_INFO] = {{TYPE('I', 'N', 'F', 'O'), sizeof(olx_file_info), 1}, .records_of = one, .need = &always},
    [OLX_CHUNK_PROBE_POSITIONS] = {{TYPE('P', 'P', 'O', 'S'), 4, 3, DATA(probe_positions)},
                                   .records_of = probes,
                                   .need = &always,
                                   .open = olx_probe_positions_open},
    [OLX_CHUNK_PROBE_FLAGS] = {{TYPE('P', 'F', 'L', 'G'), 1, 1, DATA(probe_flags)},
                               .records_of = probes,
                               .need = &always,
                               .open = olx_probe_flags_open,
                               .verify = olx_probe_flags_verify},
    [OLX_CHUNK_RADIANCE] = {{TYPE('R', 'A', 'D', 'I'), 4, .elements_of = texels, DATA(radiance), BYTES(radiance)},
                            .records_of = seen_probes,
                            .need = &probe_light,
                            .on_device = true,
                            .verify = olx_radiance_verify},
    [OLX_CHUNK_NORMAL] = {{TYPE('N', 'O', 'R', 'M'), 2, .elements_of = texels, DATA(normal), BYTES(normal)},
                          .records_of = probes,
                          .need = &geometry_texels,
                          .on_device = true},
    [OLX_CHUNK_DISTANCE] = {{TYPE('D', 'I', 'S', 'T'), 2, .elements_of = texels, DATA(distance), BYTES(distance)},
                            {TYPE('G', 'E', 'O', 'M'), sizeof(olx_geometry_block), .elements_of = blocks,
                             DATA(geometry), BYTES(geometry)},
                            has_geometry_blocks,
                            .records_of = probes,
                            .need = &always,
                            .on_device = true,
                            .verify = olx_geometry_verify},
    [OLX_CHUNK_LEAST] = {{TYPE('D', 'M', 'I', 'N'), 2, .elements_of = least_nodes, DATA(least), BYTES(pyramid)},
                         .records_of = probes,
                         .need = &always,
                         .on_device = true},
    [OLX_CHUNK_GREATEST] = {{TYPE('D', 'M', 'A', 'X'), 2, .elements_of = greatest_nodes, DATA(greatest),
                             BYTES(pyramid)},
                            .records_of = probes,
                            .need = &always},
    [OLX_CHUNK_IRRADIANCE_POSITIONS] = {{TYPE('I', 'P', 'O', 'S'), 4, 3, DATA(irradiance_positions)},
                                        .records_of = irradiance_probes,
                                        .need = &probe_light,
                                        .open = olx_irradiance_positions_open},
    [OLX_CHUNK_IRRADIANCE_FLAGS] = {{TYPE('I', 'F', 'L', 'G'), 1, 1, DATA(irradiance_flags)},
                                    .records_of = irradiance_probes,
                                    .need = &probe_light,
                                    .open = olx_irradiance_flags_open,
                                    .verify = olx_irradiance_flags_verify},
    [OLX_CHUNK_IRRADIANCE] = {{TYPE('I', 'R', 'R', 'A'), 4, .elements_of = irradiance_texels, DATA(irradiance),
                               BYTES(irradiance)},
                              {TYPE('I', 'R', 'S', 'H'), 2, .elements_of = harmonics, DATA(harmonics),
                               BYTES(irradiance)},
                              has_harmonics,
                              .records_of = irradiance_probes,
                              .need = &probe_light,
                              .on_device = true,
                              .verify = olx_irradiance_verify},
    [OLX_CHUNK_MOMENTS] = {{TYPE('M', 'O', 'M', 'E'), 4, .elements_of = irradiance_texels, DATA(moments),
                            BYTES(moments)},
                           .records_of = irradiance_probes,
                           .need = &probe_light,
                           .on_device = true,
                           .verify = olx_moments_verify},
    [OLX_CHUNK_BASE] = {{TYPE('B', 'A', 'S', 'E'), 4, .elements_of = texels, DATA(surfaces.base), BYTES(material)},
                        {TYPE('T', 'B', 'A', 'S'), 4, .elements_of = tiles,
                         DATA(surfaces.tiled[OLX_SURFACE_BASE].words), BYTES(material)},
                        has_tiles,
                        .records_of = probes,
                        .need = &always,
                        .on_device = true,
                        .verify = olx_surfaces_verify},
    [OLX_CHUNK_SPECULAR] = {{TYPE('S', 'P', 'E', 'C'), 2, .elements_of = texels, DATA(surfaces.specular),
                             BYTES(material)},
                            {TYPE('T', 'R', 'E', 'F'), 4, .elements_of = tiles,
                             DATA(surfaces.tiled[OLX_SURFACE_SPECULAR].words), BYTES(material)},
                            has_tiles,
                            .records_of = probes,
                            .need = &always,
                            .on_device = true},
    [OLX_CHUNK_DIRECT] = {{TYPE('D', 'I', 'R', 'E'), 4, .elements_of = texels, DATA(surfaces.direct), BYTES(direct)},
                          {TYPE('T', 'D', 'I', 'R'), 4, .elements_of = tiles,
                           DATA(surfaces.tiled[OLX_SURFACE_DIRECT].words), BYTES(direct)},
                          has_tiles,
                          .records_of = probes,
                          .need = &always,
                          .on_device = true},
    [OLX_CHUNK_INDIRECT] = {{TYPE('I', 'N', 'D', 'I'), 4, .elements_of = texels, DATA(surfaces.indirect),
                             BYTES(indirect)},
                            {TYPE('T', 'I', 'N', 'D'), 4, .elements_of = tiles,
                             DATA(surfaces.tiled[OLX_SURFACE_INDIRECT].words), BYTES(indirect)},
                            has_tiles,
                            .records_of = probes,
                            .need = &always,
                            .on_device = true},
    [OLX_CHUNK_EMISSION] = {{TYPE('E', 'M', 'I', 'S'), 4, .elements_of = tiles, DATA(surfaces.emission),
                             BYTES(emission)},
                            .records_of = probes,
                            .need = &always,
                            .on_device = true},
    [OLX_CHUNK_LIGHTS] = {{TYPE('L', 'I', 'T', 'E'), sizeof(olx_field_light), 1},
                          .need = &always,
                          .on_device = true,
                          .open = olx_lights_open},
    [OLX_CHUNK_VORONOI] = {{TYPE('V', 'O', 'R', 'O'), 1},
                           .records_of = one,
                           .on_device = true,
                           .open = olx_voronoi_open,
                           .verify = olx_voronoi_chunk_verify},
    [OLX_CHUNK_OCTREE] = {{TYPE('O', 'C', 'T', 'R'), 1},
                          .records_of = one,
                          .open = olx_octree_open,
                          .verify = olx_octree_chunk_verify},
    [OLX_CHUNK_BRICKS] = {{TYPE('B', 'R', 'I', 'K'), 1},
                          .records_of = one,
                          .on_device = true,
                          .open = olx_brick_chunk_open},
    [OLX_CHUNK_CLASSIC] = {{TYPE('C', 'L', 'A', 'S'), sizeof(olx_classic_header), 1},
                           .records_of = one,
                           .part = OLX_PART_CLASSIC,
                           .open = olx_classic_open,
                           .verify = olx_classic_table_verify},
    [OLX_CHUNK_CLASSIC_IRRADIANCE] = {{TYPE('C', 'I', 'R', 'R'), 4, .elements_of = classic_texels},
                                      .records_of = classic_probes,
                                      .part = OLX_PART_CLASSIC,
                                      .on_device = true,
                                      .verify = olx_classic_irradiance_verify},
    [OLX_CHUNK_CLASSIC_RADIANCE] = {{TYPE('C', 'R', 'A', 'D'), 4, .elements_of = classic_radiance},
                                    .records_of = classic_probes,
                                    .part = OLX_PART_CLASSIC,
                                    .on_device = true,
                                    .verify = olx_classic_radiance_verify},
    [OLX_CHUNK_CLASSIC_BOXES] = {{TYPE('C', 'B', 'O', 'X'), 4, 6},
                                 .records_of = classic_probes,
                                 .part = OLX_PART_CLASSIC},
    [OLX_CHUNK_VOLUME] = {{TYPE('V', 'O', 'L', 'U'), 1},
                          .records_of = one,
                          .part = OLX_PART_VOLUME,
                          .on_device = true,
                          .open = olx_field_volume_open},
    [OLX_CHUNK_VOLUME_POSITIONS] = {{TYPE('V', 'P', 'O', 'S'), 4, 3},
                                    .records_of = volume_probes,
                                    .part = OLX_PART_VOLUME},
    [OLX_CHUNK_VOLUME_IRRADIANCE] = {{TYPE('V', 'I', 'R', 'R'), 2, OLX_VOLUME_HALVES},
                                     .records_of = volume_probes,
                                     .part = OLX_PART_VOLUME,
                                     .on_device = true,
                                     .verify = olx_volume_verify},
    [OLX_CHUNK_ORIGIN] = {{TYPE('O', 'R', 'I', 'G'), 8, 3},
                          .records_of = one,
                          .part = OLX_PART_ORIGIN,
                          .open = olx_origin_open},
    [OLX_CHUNK_EMISSION_TILES] = {{TYPE('E', 'T', 'I', 'L'), 4, OLX_EMISSION_TILE_TEXELS},
                                  .need = &always,
                                  .on_device = true,
                                  .open = olx_emission_tiles_open},
    [OLX_CHUNK_PLANES] = {{TYPE('P', 'L', 'A', 'N'), sizeof(olx_plane_code), 1},
                          .need = &geometry_blocks,
                          .on_device = true,
                          .open = olx_planes_open},
    [OLX_CHUNK_BASE_POOL] = {{TYPE('P', 'B', 'A', 'S'), sizeof(olx_bc1_block), 1},
                             .need = &surface_tiles,
                             .on_device = true,
                             .open = olx_pools_open},
    [OLX_CHUNK_SPECULAR_POOL] = {{TYPE('P', 'R', 'E', 'F'), sizeof(olx_bc5_block), 1},
                                 .need = &surface_tiles,
                                 .on_device = true},
    [OLX_CHUNK_DIRECT_POOL] = {{TYPE('P', 'D', 'I', 'R'), sizeof(olx_bc6h_block), 1},
                               .need = &surface_tiles,
                               .on_device = true},
    [OLX_CHUNK_INDIRECT_POOL] = {{TYPE('P', 'I', 'N', 'D'), sizeof(olx_bc6h_block), 1},
                                 .need = &surface_tiles,
                                 .on_device = true},
    [OLX_CHUNK_RELIGHT] = {{TYPE('R', 'L', 'I', 'T'), 1},
                           .records_of = one,
                           .part = OLX_PART_RELIGHT,
                           .open = olx_relight_open},
};

const olx_chunk_form *olx_chunk_form_of(const olx_field_info *info, olx_chunk_kind kind) {
  const olx_chunk_traits *k = &olx_chunk_kinds[kind];
  return k->is_other && k->is_other(info) ? &k->other : &k->form;
}

void olx_chunk_shapes(const olx_field_info *info, olx_chunk_shape shapes[OLX_CHUNK_KINDS]) {
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    const olx_chunk_form *form = olx_chunk_form_of(info, k);
    const olx_chunk_row row = {.type = form->type,
                               .element_bytes = form->element_bytes,
                               .elements = form->elements_of ? form->elements_of(info) : form->elements,
                               .records = olx_chunk_kinds[k].records_of ? olx_chunk_kinds[k].records_of(info) : 0};
    shapes[k] = olx_chunk_shape_of(&row);
  }
}

bool olx_chunk_is_required(const olx_field_info *info, olx_chunk_kind kind) {
  const olx_chunk_need *need = olx_chunk_kinds[kind].need;
  return need && need->holds(info);
}

bool olx_chunk_is_on_device(olx_chunk_kind kind) { return olx_chunk_kinds[kind].on_device; }
