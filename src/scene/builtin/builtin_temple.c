// Builds the temple, after Wang's iconic temple (Fig. 1.1): a corridor between colossal pillars, stairs on both sides
// to galleries with pillars, arcades and blind arches, and open space under stairs and galleries.
#include "core/result.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/builtin_shapes.h"

// Half the width and half the length of the hall; heights of its storeys.
static const float half_width = 10.0f, half_length = 10.0f, height = 8.4f, beam = 8.0f;
static const float gallery = 3.0f, soffit = 2.75f, edge = 7.4f;
// Positions of the rows of pillars; a bay is 5 m long, except shorter ones at the ends.
static const float inner_row = 2.7f, outer_row = 7.75f, pillar_z[2] = {2.5f, 7.5f}, bay_middle = 5.0f;
// Dimensions of the flights of stairs, between their parapets.
static const float flight_foot = 3.5f, flight_begin = 2.4f, flight_end = 8.4f;

typedef struct palette {
  uint32_t pale_tile, dark_tile, gallery_floor, stair, plaster, ceiling, limestone, porphyry, serpentine, gilding,
      bronze, enamel, red_cloth, blue_cloth;
} palette;

static olx_result mix_palette(olx_scene *s, palette *p) {
  OLX_TRY(olx_add_glossy(s, "pale marble tiles", olx_v3(0.62f, 0.58f, 0.5f), 0.0f, 0.12f, &p->pale_tile));
  OLX_TRY(olx_add_glossy(s, "dark marble tiles", olx_v3(0.13f, 0.12f, 0.14f), 0.0f, 0.16f, &p->dark_tile));
  OLX_TRY(olx_add_glossy(s, "gallery floor", olx_v3(0.48f, 0.38f, 0.3f), 0.0f, 0.2f, &p->gallery_floor));
  OLX_TRY(olx_add_glossy(s, "stair stone", olx_v3(0.6f, 0.56f, 0.48f), 0.0f, 0.45f, &p->stair));
  OLX_TRY(olx_add_glossy(s, "plaster", olx_v3(0.68f, 0.62f, 0.52f), 0.0f, 0.7f, &p->plaster));
  OLX_TRY(olx_add_matte(s, "ceiling", olx_v3(0.62f, 0.58f, 0.52f), &p->ceiling));
  OLX_TRY(olx_add_glossy(s, "limestone", olx_v3(0.66f, 0.59f, 0.47f), 0.0f, 0.5f, &p->limestone));
  OLX_TRY(olx_add_glossy(s, "porphyry pillar", olx_v3(0.5f, 0.16f, 0.12f), 0.0f, 0.2f, &p->porphyry));
  OLX_TRY(olx_add_glossy(s, "serpentine pillar", olx_v3(0.16f, 0.36f, 0.24f), 0.0f, 0.25f, &p->serpentine));
  OLX_TRY(olx_add_glossy(s, "gilded relief", olx_v3(0.9f, 0.68f, 0.3f), 1.0f, 0.28f, &p->gilding));
  OLX_TRY(olx_add_glossy(s, "bronze", olx_v3(0.55f, 0.36f, 0.2f), 1.0f, 0.38f, &p->bronze));
  OLX_TRY(olx_add_glossy(s, "blue enamel", olx_v3(0.08f, 0.18f, 0.5f), 0.0f, 0.15f, &p->enamel));
  OLX_TRY(olx_add_matte(s, "red cloth", olx_v3(0.62f, 0.08f, 0.06f), &p->red_cloth));
  return olx_add_matte(s, "blue cloth", olx_v3(0.1f, 0.2f, 0.58f), &p->blue_cloth);
}

// A quarter of the hall. Each is described as the quarter of x > 0 and z > 0 and mirrored.
typedef struct quarter {
  olx_scene *scene;
  const palette *materials;
  bool left, back;
} quarter;

static olx_vec3 put(const quarter *q, float x, float y, float z) {
  return olx_v3(q->left ? -x : x, y, q->back ? -z : z);
}

static uint32_t swap_bits(uint32_t open, uint32_t a, uint32_t b) {
  return (open & ~(a | b)) | (open & a ? b : 0) | (open & b ? a : 0);
}

static olx_result block(const quarter *q, const char *name, olx_vec3 low, olx_vec3 high, uint32_t open,
                        uint32_t material) {
  const olx_vec3 a = put(q, low.x, low.y, low.z), b = put(q, high.x, high.y, high.z);
  if (q->left) open = swap_bits(open, OLX_OPEN_X0, OLX_OPEN_X1);
  if (q->back) open = swap_bits(open, OLX_OPEN_Z0, OLX_OPEN_Z1);
  return olx_add_block(q->scene, name, olx_min_each(a, b), olx_max_each(a, b), open, material);
}

static olx_result extrusion(const quarter *q, const char *name, const olx_extrusion *solid, uint32_t material) {
  const bool along_x = solid->axis == OLX_ALONG_X;
  const bool turn_outline = along_x ? q->back : q->left, turn_ends = along_x ? q->left : q->back;
  olx_vec2 outline[64];
  olx_extrusion mirrored = *solid;
  for (uint32_t i = 0; i < solid->points; i++) {
    outline[i] = solid->outline[i];
    if (turn_outline) outline[i].x = -outline[i].x;
  }
  mirrored.outline = outline;
  if (turn_ends) {
    mirrored.low = -solid->high;
    mirrored.high = -solid->low;
    mirrored.low_open = solid->high_open;
    mirrored.high_open = solid->low_open;
  }
  return olx_add_extrusion(q->scene, name, &mirrored, material);
}

// Adds walls and ceiling, and a chequered floor of tiles one metre wide.
static olx_result add_shell(olx_scene *scene, const palette *p) {
  const uint32_t walls[6] = {p->plaster, p->plaster, OLX_NO_FACE, p->ceiling, p->plaster, p->plaster};
  OLX_TRY(olx_add_room(scene, "hall", olx_v3(-half_width, 0.0f, -half_length), olx_v3(half_width, height, half_length),
                       walls));
  for (int x = -10; x < 10; x++) {
    for (int z = -10; z < 10; z++) {
      const float x0 = (float)x, x1 = x0 + 1.0f, z0 = (float)z, z1 = z0 + 1.0f;
      const olx_vec3 tile[4] = {{x0, 0.0f, z0}, {x0, 0.0f, z1}, {x1, 0.0f, z1}, {x1, 0.0f, z0}};
      OLX_TRY(olx_add_quad(scene, "floor", tile, (x + z) & 1 ? p->dark_tile : p->pale_tile));
    }
  }
  return OLX_OK;
}

// Adds a pillar with plinth, base, a swelling shaft, capital and abacus, which is sunk slightly into what it carries.
static olx_result add_pillar(const quarter *q, float x, float z, float low, float high, float r, uint32_t material) {
  const float foot = low + 0.13f, head = high - 0.13f, half = 1.46f * r, sunk = 0.02f;
  const olx_vec2 profile[] = {{1.34f * r, foot},         {1.4f * r, foot + 0.05f},  {1.34f * r, foot + 0.11f},
                              {1.06f * r, foot + 0.17f}, {r, foot + 0.26f},         {0.97f * r, 0.5f * (foot + head)},
                              {0.86f * r, head - 0.4f},  {0.98f * r, head - 0.35f}, {0.9f * r, head - 0.3f},
                              {1.04f * r, head - 0.16f}, {1.32f * r, head}};
  const bool grounded = low == 0.0f;
  OLX_TRY(block(q, "plinth", olx_v3(x - half, grounded ? low : low - sunk, z - half),
                olx_v3(x + half, low + 0.15f, z + half), grounded ? OLX_OPEN_Y0 : 0, q->materials->limestone));
  OLX_TRY(
      olx_add_lathe(q->scene, "pillar", put(q, x, 0.0f, z), profile, sizeof profile / sizeof *profile, 32, material));
  return block(q, "abacus", olx_v3(x - half, high - 0.15f, z - half), olx_v3(x + half, high + sunk, z + half), 0,
               q->materials->limestone);
}

static olx_result add_pillars(const quarter *q) {
  for (uint32_t i = 0; i < 2; i++) {
    OLX_TRY(add_pillar(q, inner_row, pillar_z[i], 0.0f, beam, 0.36f, q->materials->porphyry));
    OLX_TRY(add_pillar(q, outer_row, pillar_z[i], gallery, beam, 0.26f, q->materials->serpentine));
  }
  return OLX_OK;
}

// Adds steps of 26 x 20 cm on a slab; the space under it is open at both sides.
static olx_result add_flight(const quarter *q) {
  enum { STEPS = 15, POINTS = 2 * STEPS + 3 };
  const float tread = (edge - flight_foot) / STEPS, rise = gallery / STEPS;
  olx_vec2 outline[POINTS] = {{flight_foot, 0.0f}};
  for (uint32_t i = 0; i < STEPS; i++) {
    const float top = i + 1 == STEPS ? gallery : rise * (float)(i + 1);
    outline[2 * i + 1] = (olx_vec2){flight_foot + tread * (float)i, top};
    outline[2 * i + 2] = (olx_vec2){i + 1 == STEPS ? edge : flight_foot + tread * (float)(i + 1), top};
  }
  outline[POINTS - 2] = (olx_vec2){edge, soffit};
  outline[POINTS - 1] = (olx_vec2){edge - soffit * tread / rise, 0.0f};
  const olx_extrusion stairs = {.outline = outline,
                                .points = POINTS,
                                .axis = OLX_ALONG_Z,
                                .low = flight_begin,
                                .high = flight_end,
                                .open_sides = 1ull << (POINTS - 1) | 1ull << (POINTS - 3)};
  return extrusion(q, "stairs", &stairs, q->materials->stair);
}

// Adds the parts beside a flight: a sloping parapet, and at its foot a pedestal with a gilded ball.
static olx_result add_flight_side(const quarter *q, float z) {
  const float thick = 0.09f, x = flight_foot + 0.05f, half = 0.2f;
  const olx_vec2 outline[] = {{3.56f, 0.0f}, {3.7f, 0.0f}, {7.5f, 2.85f}, {7.5f, 3.4f}, {3.56f, 0.45f}};
  const olx_extrusion parapet = {
      .outline = outline, .points = 5, .axis = OLX_ALONG_Z, .low = z - thick, .high = z + thick, .open_sides = 1};
  OLX_TRY(extrusion(q, "parapet", &parapet, q->materials->limestone));
  OLX_TRY(block(q, "pedestal", olx_v3(x - half, 0.0f, z - half), olx_v3(x + half, 1.15f, z + half), OLX_OPEN_Y0,
                q->materials->limestone));
  enum { RINGS = 10 };
  olx_vec2 ball[RINGS + 1];
  for (uint32_t i = 0; i <= RINGS; i++) {
    const float angle = OLX_PI * ((float)i / RINGS - 0.5f);
    ball[i] = (olx_vec2){i == 0 || i == RINGS ? 0.0f : 0.2f * cosf(angle), 1.33f + 0.2f * sinf(angle)};
  }
  return olx_add_lathe(q->scene, "ball", put(q, x, 0.0f, z), ball, RINGS + 1, 24, q->materials->gilding);
}

// Adds the gallery's slab, in three parts so that it joins the flight in the middle without a face between.
static olx_result add_gallery(const quarter *q) {
  const float z[4] = {0.0f, flight_begin, flight_end, half_length};
  const uint32_t around = OLX_OPEN_X1 | OLX_OPEN_Z0 | OLX_OPEN_Z1;
  for (uint32_t i = 0; i < 3; i++) {
    OLX_TRY(block(q, "gallery", olx_v3(edge, soffit, z[i]), olx_v3(half_width, gallery, z[i + 1]),
                  i == 1 ? around | OLX_OPEN_X0 : around, q->materials->gallery_floor));
  }
  return OLX_OK;
}

// Adds a parapet on the gallery's edge, with a coping and a gilded panel on both sides.
static olx_result add_parapet(const quarter *q, float z0, float z1, uint32_t open) {
  const float x = edge + 0.1f, panel = 0.24f;
  OLX_TRY(block(q, "parapet", olx_v3(x - 0.08f, gallery - 0.02f, z0), olx_v3(x + 0.08f, gallery + 0.9f, z1), open,
                q->materials->limestone));
  OLX_TRY(block(q, "coping", olx_v3(x - 0.14f, gallery + 0.88f, z0), olx_v3(x + 0.14f, gallery + 1.02f, z1), open,
                q->materials->stair));
  return block(q, "panel", olx_v3(x - 0.11f, gallery + 0.2f, z0 + panel), olx_v3(x + 0.11f, gallery + 0.7f, z1 - panel),
               0, q->materials->gilding);
}

// Adds a decorated wall between two upper pillars: an arch from the stairs onto the gallery, a band around it, a
// cornice, and gilded and enamelled reliefs on both sides.
static olx_result add_arcade(const quarter *q) {
  const float top = beam + 0.02f, shelf = 6.8f, x = outer_row, z = bay_middle, begin = pillar_z[0], end = pillar_z[1];
  const olx_arch arch = {.center = z, .base = gallery - 0.02f, .width = 3.5f, .spring = 4.6f, .rise = 1.3f};
  const olx_arch inset = {.center = z, .base = arch.base, .width = 3.4f, .spring = 4.6f, .rise = 1.25f};

  olx_vec2 outline[OLX_ARCHED_WALL_POINTS], band[OLX_ARCH_BAND_POINTS];
  olx_arched_wall(&arch, begin, end, top, outline);
  olx_arch_band(&inset, 0.2f, band);
  const olx_extrusion wall = {
      .outline = outline, .points = OLX_ARCHED_WALL_POINTS, .axis = OLX_ALONG_X, .low = x - 0.12f, .high = x + 0.12f};
  const olx_extrusion frame = {
      .outline = band, .points = OLX_ARCH_BAND_POINTS, .axis = OLX_ALONG_X, .low = x - 0.17f, .high = x + 0.17f};
  OLX_TRY(extrusion(q, "arcade", &wall, q->materials->limestone));
  OLX_TRY(extrusion(q, "arch", &frame, q->materials->stair));
  OLX_TRY(block(q, "cornice", olx_v3(x - 0.22f, shelf, begin), olx_v3(x + 0.22f, shelf + 0.14f, end),
                OLX_OPEN_Z0 | OLX_OPEN_Z1, q->materials->stair));
  for (uint32_t side = 0; side < 2; side++) {
    const float middle = z + (side ? 2.06f : -2.06f), relief = x + 0.15f;
    OLX_TRY(block(q, "relief", olx_v3(2.0f * x - relief, 4.0f, middle - 0.14f), olx_v3(relief, 5.6f, middle + 0.14f), 0,
                  q->materials->enamel));
  }
  return block(q, "relief", olx_v3(x - 0.16f, 6.2f, z - 1.2f), olx_v3(x + 0.16f, 6.55f, z + 1.2f), 0,
               q->materials->gilding);
}

// Adds one storey of one bay of the outer wall: a lining with a blind arch through its whole depth, and a panel in the
// arch.
static olx_result add_blind_arch(const quarter *q, const olx_arch *arch, float z0, float z1, float top, uint64_t open,
                                 uint32_t panel) {
  const float depth = 0.1f, half = 0.3f * arch->width;
  olx_vec2 outline[OLX_ARCHED_WALL_POINTS];
  olx_arched_wall(arch, z0, z1, top, outline);
  const olx_extrusion lining = {.outline = outline,
                                .points = OLX_ARCHED_WALL_POINTS,
                                .axis = OLX_ALONG_X,
                                .low = half_width - depth,
                                .high = half_width,
                                .high_open = true,
                                .open_sides = open | OLX_WALL_BASE | OLX_WALL_ENDS};
  OLX_TRY(extrusion(q, "blind arch", &lining, q->materials->limestone));
  return block(q, "panel", olx_v3(half_width - 0.05f, arch->base + 0.4f, arch->center - half),
               olx_v3(half_width, arch->spring, arch->center + half), OLX_OPEN_X1, panel);
}

// Adds the outer wall on both storeys: one arch per bay and pilasters between them.
static olx_result add_outer_wall(const quarter *q) {
  const float upper_top = 6.3f, ends[4] = {-pillar_z[0], pillar_z[0], pillar_z[1], half_length};
  for (uint32_t bay = 0; bay < 3; bay++) {
    // The bay in the middle belongs to both quarters.
    if (bay == 0 && q->back) continue;
    const float z0 = ends[bay], z1 = ends[bay + 1], middle = 0.5f * (z0 + z1), width = 0.55f * (z1 - z0);
    const olx_arch lower = {.center = middle, .base = 0.0f, .width = width, .spring = 1.5f, .rise = 0.7f};
    const olx_arch upper = {.center = middle, .base = gallery, .width = width, .spring = 4.7f, .rise = 0.8f};
    OLX_TRY(add_blind_arch(q, &lower, z0, z1, soffit, OLX_WALL_TOP, q->materials->bronze));
    OLX_TRY(add_blind_arch(q, &upper, z0, z1, upper_top, 0, bay & 1 ? q->materials->gilding : q->materials->enamel));
  }
  for (uint32_t i = 0; i < 2; i++) {
    const float x0 = half_width - 0.16f, x1 = half_width - 0.08f, z0 = pillar_z[i] - 0.3f, z1 = pillar_z[i] + 0.3f;
    OLX_TRY(block(q, "pilaster", olx_v3(x0, 0.0f, z0), olx_v3(x1, soffit, z1), OLX_OPEN_Y0 | OLX_OPEN_Y1,
                  q->materials->plaster));
    OLX_TRY(block(q, "pilaster", olx_v3(x0, gallery, z0), olx_v3(x1, upper_top + 0.1f, z1), OLX_OPEN_Y0,
                  q->materials->plaster));
  }
  return OLX_OK;
}

// Adds the end of the hall: an arch with an urn at the corridor, and panels beside it on both storeys.
static olx_result add_end_wall(const quarter *q) {
  const olx_arch arch = {.center = 0.0f, .base = 0.0f, .width = 2.8f, .spring = 3.6f, .rise = 1.4f};
  const float z = half_length;
  olx_vec2 outline[OLX_ARCHED_WALL_POINTS];
  olx_arched_wall(&arch, -2.4f, 2.4f, 6.2f, outline);
  const olx_extrusion portal = {.outline = outline,
                                .points = OLX_ARCHED_WALL_POINTS,
                                .axis = OLX_ALONG_Z,
                                .low = z - 0.2f,
                                .high = z,
                                .high_open = true,
                                .open_sides = OLX_WALL_BASE};
  const olx_vec2 urn[] = {{0.2f, 0.68f}, {0.12f, 0.8f},  {0.14f, 0.9f},  {0.32f, 1.15f}, {0.4f, 1.45f}, {0.34f, 1.75f},
                          {0.2f, 1.9f},  {0.17f, 2.02f}, {0.28f, 2.14f}, {0.28f, 2.18f}, {0.0f, 2.18f}};
  OLX_TRY(extrusion(q, "portal", &portal, q->materials->limestone));
  OLX_TRY(block(q, "panel", olx_v3(-1.0f, 1.0f, z - 0.06f), olx_v3(1.0f, 4.2f, z), OLX_OPEN_Z1, q->materials->enamel));
  OLX_TRY(block(q, "pedestal", olx_v3(-0.4f, 0.0f, z - 1.1f), olx_v3(0.4f, 0.7f, z - 0.3f), OLX_OPEN_Y0,
                q->materials->stair));
  OLX_TRY(olx_add_lathe(q->scene, "urn", put(q, 0.0f, 0.0f, z - 0.7f), urn, sizeof urn / sizeof *urn, 32,
                        q->materials->bronze));
  for (uint32_t side = 0; side < 2; side++) {
    const quarter half = {q->scene, q->materials, side == 1, q->back};
    OLX_TRY(
        block(&half, "panel", olx_v3(4.4f, 0.5f, z - 0.07f), olx_v3(6.8f, 2.3f, z), OLX_OPEN_Z1, q->materials->bronze));
    OLX_TRY(block(&half, "panel", olx_v3(4.4f, 3.6f, z - 0.07f), olx_v3(6.8f, 6.2f, z), OLX_OPEN_Z1,
                  q->materials->gilding));
  }
  return OLX_OK;
}

// Adds beams under the ceiling from wall to wall.
static olx_result add_beams(const quarter *q) {
  for (uint32_t i = 0; i < 2; i++) {
    OLX_TRY(block(q, "beam", olx_v3(-half_width, height - 0.15f, pillar_z[i] - 0.2f),
                  olx_v3(half_width, height, pillar_z[i] + 0.2f), OLX_OPEN_X0 | OLX_OPEN_X1 | OLX_OPEN_Y1,
                  q->materials->limestone));
  }
  return OLX_OK;
}

// Adds the architraves of a row of pillars, from end to end.
static olx_result add_architraves(const quarter *q) {
  const float rows[2] = {inner_row, outer_row};
  for (uint32_t i = 0; i < 2; i++) {
    OLX_TRY(block(q, "architrave", olx_v3(rows[i] - 0.33f, beam, -half_length),
                  olx_v3(rows[i] + 0.33f, height, half_length), OLX_OPEN_Y1 | OLX_OPEN_Z0 | OLX_OPEN_Z1,
                  q->materials->limestone));
  }
  return OLX_OK;
}

// Adds a banner high between two inner pillars, and a half-drawn curtain below the gallery's edge.
static olx_result add_cloths(const quarter *q) {
  const olx_cloth banner = {.top = put(q, inner_row, 7.1f, 4.1f),
                            .across = put(q, 0.0f, 0.0f, 1.8f),
                            .down = {0.0f, -2.9f, 0.0f},
                            .waves = 1.5f,
                            .depth = 0.09f};
  const olx_cloth curtain = {.top = put(q, outer_row, 2.7f, 0.75f),
                             .across = put(q, 0.0f, 0.0f, 1.05f),
                             .down = {0.0f, -2.65f, 0.0f},
                             .waves = 4.0f,
                             .depth = 0.06f};
  const bool red = q->left == q->back;
  OLX_TRY(block(q, "rod", olx_v3(inner_row - 0.03f, 7.07f, pillar_z[0]), olx_v3(inner_row + 0.03f, 7.13f, pillar_z[1]),
                0, q->materials->bronze));
  OLX_TRY(block(q, "rod", olx_v3(outer_row - 0.03f, 2.67f, 0.0f),
                olx_v3(outer_row + 0.03f, soffit + 0.01f, flight_begin - 0.2f), OLX_OPEN_Z0, q->materials->bronze));
  OLX_TRY(olx_add_cloth(q->scene, "banner", &banner, red ? q->materials->red_cloth : q->materials->blue_cloth));
  return olx_add_cloth(q->scene, "curtain", &curtain, red ? q->materials->blue_cloth : q->materials->red_cloth);
}

// Adds a lamp below a ceiling: a housing whose whole underside emits.
static olx_result add_lamp(const quarter *q, olx_vec3 low, olx_vec3 high, olx_vec3 radiance) {
  const olx_vec3 a = put(q, low.x, low.y, low.z), b = put(q, high.x, low.y, high.z), size = olx_sub(high, low);
  OLX_TRY(block(q, "lamp", low, high, OLX_OPEN_Y0 | OLX_OPEN_Y1, q->materials->bronze));
  return olx_scene_add_rect_light(q->scene, olx_scale(olx_add(a, b), 0.5f), olx_v3(size.x, 0.0f, 0.0f),
                                  olx_v3(0.0f, 0.0f, size.z), radiance);
}

static olx_result add_quarter(const quarter *q) {
  OLX_TRY(add_pillars(q));
  OLX_TRY(add_flight(q));
  OLX_TRY(add_flight_side(q, flight_begin));
  OLX_TRY(add_flight_side(q, flight_end));
  OLX_TRY(add_gallery(q));
  OLX_TRY(add_parapet(q, 0.0f, flight_begin, OLX_OPEN_Z0));
  OLX_TRY(add_parapet(q, flight_end, half_length, OLX_OPEN_Z1));
  OLX_TRY(add_arcade(q));
  OLX_TRY(add_outer_wall(q));
  OLX_TRY(add_cloths(q));
  OLX_TRY(add_lamp(q, olx_v3(8.6f, 2.65f, 4.25f), olx_v3(9.2f, soffit, 5.75f), olx_v3(20.0f, 16.0f, 11.0f)));
  const olx_vec3 warm = {20.0f, 15.5f, 10.0f}, cool = {13.0f, 15.5f, 19.0f};
  return add_lamp(q, olx_v3(8.5f, 8.25f, 4.0f), olx_v3(9.5f, height, 6.0f), q->left ? cool : warm);
}

static olx_result add_views(olx_scene *scene) {
  OLX_TRY(olx_add_view(scene, "corridor", olx_v3(0.5f, 1.7f, 9.0f), olx_v3(-0.2f, 2.9f, 0.0f), 65.0f));
  OLX_TRY(olx_add_view(scene, "stairs", olx_v3(-2.3f, 1.7f, -0.3f), olx_v3(7.4f, 2.9f, 4.6f), 65.0f));
  OLX_TRY(olx_add_view(scene, "gallery", olx_v3(8.8f, 4.65f, 2.1f), olx_v3(8.3f, 4.3f, -6.0f), 65.0f));
  OLX_TRY(olx_add_view(scene, "parapet", olx_v3(-8.3f, 4.75f, -1.0f), olx_v3(6.0f, 2.4f, 2.6f), 65.0f));
  return olx_add_view(scene, "under-stairs", olx_v3(6.1f, 1.5f, 0.9f), olx_v3(6.7f, 0.95f, 7.0f), 70.0f);
}

olx_result olx_build_temple(olx_scene *scene) {
  palette materials;
  OLX_TRY(mix_palette(scene, &materials));
  OLX_TRY(add_shell(scene, &materials));
  for (uint32_t i = 0; i < 4; i++) {
    const quarter q = {scene, &materials, (i & 1) != 0, (i & 2) != 0};
    OLX_TRY(add_quarter(&q));
  }
  for (uint32_t i = 0; i < 2; i++) {
    const quarter side = {scene, &materials, i == 1, false}, end = {scene, &materials, false, i == 1};
    OLX_TRY(add_architraves(&side));
    OLX_TRY(add_end_wall(&end));
    OLX_TRY(add_beams(&end));
    OLX_TRY(add_lamp(&end, olx_v3(-0.8f, 8.2f, 3.8f), olx_v3(0.8f, height, 6.2f), olx_v3(34.0f, 31.0f, 26.0f)));
  }
  // The lowest outer probes are under galleries and stairs.
  olx_set_probes(scene, olx_v3(-8.7f, 1.0f, -9.0f), olx_v3(8.7f, 5.5f, 9.0f), 5, 3, 5);
  return add_views(scene);
}
