// Builds rooms in which light leaks when probes are interpolated without visibility: rooms separated by a wall, thin
// objects before walls, pillars that bury probes, and a labyrinth.
#include "core/result.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/builtin_shapes.h"

static olx_result add_room_materials(olx_scene *scene, olx_plan *plan) {
  OLX_TRY(olx_add_matte(scene, "floor", olx_v3(0.55f, 0.5f, 0.45f), &plan->floor_material));
  OLX_TRY(olx_add_matte(scene, "ceiling", olx_splat(0.75f), &plan->ceiling_material));
  return olx_add_matte(scene, "wall", olx_splat(0.7f), &plan->wall_material);
}

// Builds two rooms of 4 m x 4 m, 3 m high, separated by a wall from wall[0] to wall[1], with a light in the left one
// only. 16 probes as in the dissertation's experiment, two columns on either side of the wall. Where the plan leaves
// the wall open, the gap is `gap` metres wide.
static olx_result build_two_rooms(olx_scene *scene, const char *const cells[2], const float wall[2], float gap) {
  const float x[4] = {-4.1f, wall[0], wall[1], 4.1f};
  const float z[3] = {-2.0f, 2.0f - gap, 2.0f};
  olx_plan plan = {.cells = cells, .columns = 3, .rows = 2, .x = x, .z = z, .floor = 0.0f, .ceiling = 3.0f};
  OLX_TRY(add_room_materials(scene, &plan));
  OLX_TRY(olx_add_plan(scene, "rooms", &plan));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(-2.1f, 2.98f, 0.0f), 1.0f, olx_splat(12.0f)));
  olx_set_probes(scene, olx_v3(-3.0f, 0.75f, -1.0f), olx_v3(3.0f, 2.25f, 1.0f), 4, 2, 2);
  OLX_TRY(olx_add_view(scene, "lit", olx_v3(-3.8f, 1.6f, -1.6f), olx_v3(-0.3f, 1.2f, 1.3f), 60.0f));
  return olx_add_view(scene, "dark", olx_v3(3.8f, 1.6f, -1.6f), olx_v3(0.3f, 1.2f, 1.3f), 60.0f);
}

// A wall 0.2 m thick, in the middle.
static const float middle_wall[2] = {-0.1f, 0.1f};
static const char *const sealed_cells[2] = {".#.", ".#."};

olx_result olx_build_two_rooms_sealed(olx_scene *scene) {
  return build_two_rooms(scene, sealed_cells, middle_wall, OLX_ROOMS_GAP);
}

// The wall is offset so that no plane of a probe grid is likely to coincide with it.
olx_result olx_build_two_rooms_sealed_of(olx_scene *scene, float thickness) {
  if (!(thickness >= 0.01f && thickness <= 1.0f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "builtin:two-rooms-sealed: a wall of %g metres is not within 0.01 to 1",
                    (double)thickness);
  }
  const float wall[2] = {0.137f, 0.137f + thickness};
  return build_two_rooms(scene, sealed_cells, wall, OLX_ROOMS_GAP);
}

olx_result olx_build_two_rooms_gap(olx_scene *scene) { return olx_build_two_rooms_gap_of(scene, OLX_ROOMS_GAP); }

olx_result olx_build_two_rooms_gap_of(olx_scene *scene, float gap) {
  static const char *const cells[2] = {".#.", "..."};
  if (!(gap >= 0.01f && gap <= 3.99f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "builtin:two-rooms-gap: a gap of %g metres is not within 0.01 to 3.99",
                    (double)gap);
  }
  OLX_TRY(build_two_rooms(scene, cells, middle_wall, gap));
  // The view is along the end of the wall, past which light falls into the other room.
  return olx_add_view(scene, "both", olx_v3(2.4f, 1.5f, 1.7f), olx_v3(-1.2f, 1.2f, 0.6f), 70.0f);
}

// Builds a room with thin objects before surfaces: a picture one centimetre before a wall, and a rug one centimetre
// thick.
olx_result olx_build_parlour(olx_scene *scene) {
  uint32_t white, floor, green, frame, rug;
  OLX_TRY(olx_add_matte(scene, "white", olx_splat(0.75f), &white));
  OLX_TRY(olx_add_matte(scene, "floor", olx_v3(0.5f, 0.4f, 0.3f), &floor));
  OLX_TRY(olx_add_matte(scene, "green wall", olx_v3(0.35f, 0.5f, 0.35f), &green));
  OLX_TRY(olx_add_matte(scene, "frame", olx_v3(0.6f, 0.5f, 0.3f), &frame));
  OLX_TRY(olx_add_matte(scene, "rug", olx_v3(0.6f, 0.15f, 0.12f), &rug));
  const uint32_t materials[6] = {white, white, floor, white, green, white};
  OLX_TRY(olx_add_room(scene, "room", olx_v3(-2.0f, 0.0f, -2.5f), olx_v3(2.0f, 2.6f, 2.5f), materials));
  OLX_TRY(olx_add_box(scene, "picture", olx_v3(-0.53f, 1.11f, -2.49f), olx_v3(0.61f, 1.87f, -2.46f), frame));
  OLX_TRY(olx_add_block(scene, "rug", olx_v3(-1.13f, 0.0f, -1.07f), olx_v3(0.97f, 0.01f, 0.58f), OLX_OPEN_Y0, rug));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(0.9f, 2.58f, 0.8f), 0.6f, olx_v3(14.0f, 13.0f, 11.0f)));
  olx_set_probes(scene, olx_v3(-1.2f, 0.7f, -1.6f), olx_v3(1.2f, 1.9f, 1.6f), 3, 2, 3);
  OLX_TRY(olx_add_view(scene, "picture", olx_v3(-1.3f, 1.2f, -1.2f), olx_v3(0.05f, 1.45f, -2.48f), 55.0f));
  return olx_add_view(scene, "rug", olx_v3(-1.6f, 1.3f, 1.7f), olx_v3(-0.1f, 0.0f, -0.25f), 55.0f);
}

// Builds a box with four cylinders. The centre one is tall enough to bury both probes of its column, the right one
// buries the lower probe of its own (McGuire et al. Fig. 10).
olx_result olx_build_pillars(olx_scene *scene) {
  uint32_t white, floor, red, blue, pillar;
  OLX_TRY(olx_add_matte(scene, "white", olx_splat(0.75f), &white));
  OLX_TRY(olx_add_matte(scene, "floor", olx_v3(0.6f, 0.58f, 0.55f), &floor));
  OLX_TRY(olx_add_matte(scene, "red wall", olx_v3(0.6f, 0.2f, 0.15f), &red));
  OLX_TRY(olx_add_matte(scene, "blue wall", olx_v3(0.2f, 0.3f, 0.6f), &blue));
  OLX_TRY(olx_add_matte(scene, "pillar", olx_v3(0.7f, 0.68f, 0.62f), &pillar));
  const uint32_t materials[6] = {red, blue, floor, white, white, white};
  OLX_TRY(olx_add_room(scene, "box", olx_v3(-3.0f, 0.0f, -3.0f), olx_v3(3.0f, 3.0f, 3.0f), materials));
  OLX_TRY(olx_add_cylinder(scene, "centre pillar", olx_v3(0.0f, 0.0f, 0.0f), 0.6f, 2.6f, pillar));
  OLX_TRY(olx_add_cylinder(scene, "right pillar", olx_v3(2.0f, 0.0f, -2.0f), 0.5f, 1.5f, pillar));
  OLX_TRY(olx_add_cylinder(scene, "left pillar", olx_v3(-1.2f, 0.0f, -1.1f), 0.35f, 2.0f, pillar));
  OLX_TRY(olx_add_cylinder(scene, "near pillar", olx_v3(1.1f, 0.0f, 1.2f), 0.4f, 1.2f, pillar));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(-1.3f, 2.98f, 1.3f), 1.0f, olx_v3(14.0f, 13.0f, 11.0f)));
  olx_set_probes(scene, olx_v3(-2.0f, 0.75f, -2.0f), olx_v3(2.0f, 2.25f, 2.0f), 3, 2, 3);
  OLX_TRY(olx_add_view(scene, "corner", olx_v3(-2.7f, 2.6f, 2.7f), olx_v3(0.7f, 0.4f, -0.9f), 65.0f));
  return olx_add_view(scene, "side", olx_v3(2.7f, 1.6f, 2.7f), olx_v3(-0.6f, 0.9f, -0.8f), 65.0f);
}

// Builds a chamber inside a ring of corridors, with its door away from the lights, so that only reflected light reaches
// it. The middle probes are in the chamber, the others in the ring (McGuire et al. Figs. 11 and 13).
olx_result olx_build_labyrinth(olx_scene *scene) {
  static const char *const cells[7] = {
      ".......", //
      ".##.##.", //
      ".#...#.", //
      ".#...#.", //
      ".#...#.", //
      ".#####.", //
      ".......",
  };
  static const float lines[8] = {-4.0f, -1.5f, -1.3f, -0.5f, 0.5f, 1.3f, 1.5f, 4.0f};
  olx_plan plan = {.cells = cells, .columns = 7, .rows = 7, .x = lines, .z = lines, .floor = 0.0f, .ceiling = 3.0f};
  OLX_TRY(add_room_materials(scene, &plan));
  OLX_TRY(olx_add_plan(scene, "labyrinth", &plan));
  uint32_t pillar;
  OLX_TRY(olx_add_matte(scene, "pillar", olx_v3(0.65f, 0.45f, 0.3f), &pillar));
  OLX_TRY(olx_add_cylinder(scene, "pillar", olx_v3(-2.2f, 0.0f, -2.2f), 0.25f, 2.4f, pillar));
  OLX_TRY(olx_add_cylinder(scene, "pillar", olx_v3(2.2f, 0.0f, -2.2f), 0.25f, 2.4f, pillar));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(-2.75f, 2.98f, -3.3f), 0.8f, olx_splat(30.0f)));
  OLX_TRY(olx_add_ceiling_light(scene, olx_v3(-2.75f, 2.98f, 2.75f), 0.8f, olx_splat(20.0f)));
  olx_set_probes(scene, olx_v3(-2.75f, 0.75f, -2.75f), olx_v3(2.75f, 2.25f, 2.75f), 3, 2, 3);
  OLX_TRY(olx_add_view(scene, "chamber", olx_v3(1.1f, 1.6f, 1.1f), olx_v3(-0.5f, 1.1f, -1.4f), 75.0f));
  OLX_TRY(olx_add_view(scene, "door", olx_v3(1.6f, 2.2f, -3.8f), olx_v3(-0.3f, 0.9f, -0.8f), 70.0f));
  return olx_add_view(scene, "ring", olx_v3(3.8f, 1.8f, 3.8f), olx_v3(0.0f, 1.0f, 2.0f), 70.0f);
}
