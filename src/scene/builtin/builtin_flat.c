// Builds a furnished flat: a living room with sun through a wide window and a floor of polished boards, and a corridor
// that receives light only through an open door.
#include "core/result.h"
#include "scene/builtin/builtin_furniture.h"
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/builtin_shapes.h"

// The interior of the living room, the corridor behind the wall with the door, and the height of both.
static const float room_left = -3.0f, room_right = 3.0f, room_back = -2.3f, room_front = 2.3f, height = 2.6f;
static const float corridor_near = 2.42f, corridor_far = 3.72f, corridor_end = 4.2f;
static const float outside = 0.3f; // thickness of outer walls
// The window in the left wall, and the door.
static const float window_near = 1.5f, window_far = -1.5f, sill = 0.45f, lintel = 2.3f;
static const float door_left = 1.45f, door_right = 2.35f, door_height = 2.05f;

enum { BOARDS = 4, COVERS = 6 };

typedef struct palette {
  uint32_t plaster, ochre, ceiling, white_paint, boards[BOARDS], oak, walnut, sofa_cloth, chair_cloth, rug, rug_border,
      curtain, brass, shade, clay, leaf, ceramic, mirror, covers[COVERS];
} palette;

static olx_result mix_woods(olx_scene *s, palette *p) {
  static const char *const names[BOARDS] = {"board 1", "board 2", "board 3", "board 4"};
  static const olx_vec3 tints[BOARDS] = {
      {0.43f, 0.27f, 0.15f}, {0.38f, 0.23f, 0.12f}, {0.47f, 0.3f, 0.17f}, {0.35f, 0.21f, 0.12f}};
  for (uint32_t i = 0; i < BOARDS; i++) {
    OLX_TRY(olx_add_glossy(s, names[i], tints[i], 0.0f, 0.16f + 0.02f * (float)i, &p->boards[i]));
  }
  OLX_TRY(olx_add_glossy(s, "oak", olx_v3(0.55f, 0.4f, 0.25f), 0.0f, 0.4f, &p->oak));
  return olx_add_glossy(s, "walnut", olx_v3(0.2f, 0.12f, 0.07f), 0.0f, 0.22f, &p->walnut);
}

static olx_result mix_cloths(olx_scene *s, palette *p) {
  OLX_TRY(olx_add_matte(s, "sofa cloth", olx_v3(0.16f, 0.3f, 0.33f), &p->sofa_cloth));
  OLX_TRY(olx_add_matte(s, "armchair cloth", olx_v3(0.62f, 0.3f, 0.1f), &p->chair_cloth));
  OLX_TRY(olx_add_matte(s, "rug", olx_v3(0.62f, 0.55f, 0.45f), &p->rug));
  OLX_TRY(olx_add_matte(s, "rug border", olx_v3(0.42f, 0.1f, 0.08f), &p->rug_border));
  OLX_TRY(olx_add_matte(s, "curtain cloth", olx_v3(0.72f, 0.68f, 0.6f), &p->curtain));
  return olx_add_matte(s, "shade cloth", olx_v3(0.8f, 0.7f, 0.52f), &p->shade);
}

static olx_result mix_covers(olx_scene *s, palette *p) {
  static const char *const names[COVERS] = {"red cover",   "blue cover",  "green cover",
                                            "cream cover", "black cover", "yellow cover"};
  static const olx_vec3 tints[COVERS] = {{0.45f, 0.07f, 0.06f}, {0.08f, 0.14f, 0.36f}, {0.09f, 0.25f, 0.13f},
                                         {0.68f, 0.62f, 0.5f},  {0.05f, 0.05f, 0.06f}, {0.65f, 0.45f, 0.1f}};
  for (uint32_t i = 0; i < COVERS; i++) OLX_TRY(olx_add_matte(s, names[i], tints[i], &p->covers[i]));
  return OLX_OK;
}

static olx_result mix_palette(olx_scene *s, palette *p) {
  OLX_TRY(mix_woods(s, p));
  OLX_TRY(mix_cloths(s, p));
  OLX_TRY(mix_covers(s, p));
  OLX_TRY(olx_add_matte(s, "plaster", olx_v3(0.78f, 0.76f, 0.71f), &p->plaster));
  OLX_TRY(olx_add_matte(s, "ochre wall", olx_v3(0.62f, 0.45f, 0.26f), &p->ochre));
  OLX_TRY(olx_add_matte(s, "ceiling", olx_splat(0.82f), &p->ceiling));
  OLX_TRY(olx_add_glossy(s, "white paint", olx_v3(0.8f, 0.79f, 0.76f), 0.0f, 0.35f, &p->white_paint));
  OLX_TRY(olx_add_glossy(s, "brass", olx_v3(0.82f, 0.62f, 0.3f), 1.0f, 0.25f, &p->brass));
  OLX_TRY(olx_add_matte(s, "clay", olx_v3(0.5f, 0.26f, 0.16f), &p->clay));
  OLX_TRY(olx_add_glossy(s, "leaf", olx_v3(0.12f, 0.3f, 0.08f), 0.0f, 0.45f, &p->leaf));
  OLX_TRY(olx_add_glossy(s, "ceramic", olx_v3(0.75f, 0.76f, 0.78f), 0.0f, 0.12f, &p->ceramic));
  return olx_add_glossy(s, "mirror", olx_splat(0.9f), 1.0f, 0.03f, &p->mirror);
}

// Adds boards along x, 16 cm wide, with joints at different positions in each row.
static olx_result add_boards(olx_scene *scene, const palette *p) {
  const float left = room_left - outside, right = corridor_end + outside, back = room_back - outside, broad = 0.16f;
  const float front = corridor_far + outside;
  for (uint32_t row = 0; back + broad * (float)row < front; row++) {
    const float z0 = back + broad * (float)row, z1 = olx_min(z0 + broad, front);
    float x = left;
    for (uint32_t i = 0; x < right; i++) {
      const uint32_t cut = (row * 7u + i * 5u + row * i) % 11u;
      const float next = olx_min(x + 0.9f + 0.13f * (float)cut, right);
      const olx_vec3 board[4] = {{x, 0.0f, z0}, {x, 0.0f, z1}, {next, 0.0f, z1}, {next, 0.0f, z0}};
      OLX_TRY(olx_add_quad(scene, "floor board", board, p->boards[(cut + row) % BOARDS]));
      x = next;
    }
  }
  return OLX_OK;
}

static olx_result add_wall(olx_scene *scene, olx_vec3 low, olx_vec3 high, uint32_t material) {
  return olx_add_block(scene, "wall", low, high, OLX_OPEN_Y0 | OLX_OPEN_Y1, material);
}

// Adds the floor slab, the ceiling and the walls without openings. Walls end in the ceiling slab and below the boards.
static olx_result add_shell(olx_scene *scene, const palette *p) {
  const float left = room_left - outside, right = corridor_end + outside, back = room_back - outside;
  const float front = corridor_far + outside, foot = -0.05f, head = height + 0.05f;
  OLX_TRY(add_boards(scene, p));
  OLX_TRY(olx_add_block(scene, "floor slab", olx_v3(left, -0.25f, back), olx_v3(right, 0.0f, front), OLX_OPEN_Y1,
                        p->plaster));
  OLX_TRY(olx_add_box(scene, "ceiling", olx_v3(left, height, back), olx_v3(right, height + 0.2f, front), p->ceiling));
  OLX_TRY(add_wall(scene, olx_v3(left, foot, back), olx_v3(right, head, room_back), p->ochre));
  OLX_TRY(add_wall(scene, olx_v3(left, foot, corridor_far), olx_v3(right, head, front), p->plaster));
  OLX_TRY(add_wall(scene, olx_v3(room_right, foot, room_back), olx_v3(right, head, corridor_near), p->plaster));
  return add_wall(scene, olx_v3(corridor_end, foot, corridor_near), olx_v3(right, head, corridor_far), p->plaster);
}

// Adds the left wall around the window, and the wall with the door to the corridor.
static olx_result add_openings(olx_scene *scene, const palette *p) {
  const float left = room_left - outside, foot = -0.05f, head = height + 0.05f;
  OLX_TRY(add_wall(scene, olx_v3(left, foot, room_back), olx_v3(room_left, head, window_far), p->plaster));
  OLX_TRY(add_wall(scene, olx_v3(left, foot, window_near), olx_v3(room_left, head, corridor_far), p->plaster));
  OLX_TRY(olx_add_block(scene, "parapet", olx_v3(left, foot, window_far), olx_v3(room_left, sill, window_near),
                        OLX_OPEN_Y0 | OLX_OPEN_Z0 | OLX_OPEN_Z1, p->plaster));
  OLX_TRY(olx_add_block(scene, "lintel", olx_v3(left, lintel, window_far), olx_v3(room_left, head, window_near),
                        OLX_OPEN_Y1 | OLX_OPEN_Z0 | OLX_OPEN_Z1, p->plaster));
  OLX_TRY(add_wall(scene, olx_v3(room_left, foot, room_front), olx_v3(door_left, head, corridor_near), p->plaster));
  OLX_TRY(add_wall(scene, olx_v3(door_right, foot, room_front), olx_v3(room_right, head, corridor_near), p->plaster));
  return olx_add_block(scene, "lintel", olx_v3(door_left, door_height, room_front),
                       olx_v3(door_right, head, corridor_near), OLX_OPEN_Y1 | OLX_OPEN_X0 | OLX_OPEN_X1, p->plaster);
}

// Adds sill, frame and bars of the window, and the curtains beside it.
static olx_result add_window(olx_scene *scene, const palette *p) {
  const float x0 = room_left - 0.16f, x1 = room_left - 0.1f, bar = 0.06f;
  OLX_TRY(olx_add_box(scene, "sill", olx_v3(room_left - 0.22f, sill, window_far),
                      olx_v3(room_left + 0.08f, sill + 0.035f, window_near), p->white_paint));
  for (uint32_t i = 0; i < 4; i++) {
    const float z = window_far + (window_near - window_far - bar) * (float)i / 3.0f;
    OLX_TRY(
        olx_add_box(scene, "window bar", olx_v3(x0, sill + 0.035f, z), olx_v3(x1, lintel, z + bar), p->white_paint));
  }
  for (uint32_t i = 0; i < 3; i++) {
    static const float heights[3] = {0.485f, 1.72f, 2.24f};
    OLX_TRY(olx_add_box(scene, "window bar", olx_v3(x0 + 0.002f, heights[i], window_far),
                        olx_v3(x1 - 0.002f, heights[i] + bar, window_near), p->white_paint));
  }
  for (uint32_t side = 0; side < 2; side++) {
    const olx_cloth cloth = {.top = {room_left + 0.11f, 2.42f, side ? window_near - 0.12f : window_far - 0.45f},
                             .across = {0.0f, 0.0f, 0.57f},
                             .down = {0.0f, -2.38f, 0.0f},
                             .waves = 5.0f,
                             .depth = 0.045f};
    OLX_TRY(olx_add_cloth(scene, "curtain", &cloth, p->curtain));
  }
  return olx_add_box(scene, "curtain rod", olx_v3(room_left + 0.1f, 2.42f, window_far - 0.5f),
                     olx_v3(room_left + 0.12f, 2.44f, window_near + 0.5f), p->brass);
}

// Adds the doors: the living room's is open into the corridor, those of other rooms are closed.
static olx_result add_doors(olx_scene *scene, const palette *p) {
  const float jamb = 0.06f, near = room_front - 0.015f, far = corridor_near + 0.015f;
  OLX_TRY(olx_add_box(scene, "jamb", olx_v3(door_left - 0.01f, 0.0f, near), olx_v3(door_left + jamb, door_height, far),
                      p->white_paint));
  OLX_TRY(olx_add_box(scene, "jamb", olx_v3(door_right - jamb, 0.0f, near),
                      olx_v3(door_right + 0.01f, door_height, far), p->white_paint));
  OLX_TRY(olx_add_box(scene, "jamb", olx_v3(door_left, door_height - jamb, near + 0.003f),
                      olx_v3(door_right, door_height + 0.01f, far - 0.003f), p->white_paint));
  const olx_stand hinge = {scene, olx_v3(door_right - jamb, 0.0f, corridor_near), 1.9f};
  OLX_TRY(olx_add_solid(&hinge, "door", olx_v3(-0.78f, 0.01f, -0.02f), olx_v3(0.0f, door_height - jamb - 0.01f, 0.02f),
                        p->white_paint));
  for (uint32_t i = 0; i < 2; i++) {
    const float x = i ? 1.2f : -1.8f;
    OLX_TRY(olx_add_box(scene, "shut door", olx_v3(x, 0.0f, corridor_far - 0.03f),
                        olx_v3(x + 0.9f, 2.05f, corridor_far + 0.01f), p->oak));
  }
  return OLX_OK;
}

static olx_result add_rug(const olx_stand *stand, olx_vec2 half, const palette *p) {
  const float border = 0.16f, thick = 0.012f;
  OLX_TRY(
      olx_add_solid(stand, "rug border", olx_v3(-half.x, 0.0f, -half.y), olx_v3(half.x, thick, half.y), p->rug_border));
  return olx_add_solid(stand, "rug", olx_v3(-half.x + border, 0.0f, -half.y + border),
                       olx_v3(half.x - border, thick + 0.003f, half.y - border), p->rug);
}

// Adds a bowl and two books on the coffee table.
static olx_result lay_table(olx_scene *scene, const palette *p, olx_vec3 top) {
  const olx_vec2 bowl[] = {{0.05f, 0.0f}, {0.06f, 0.012f}, {0.13f, 0.07f}, {0.15f, 0.1f},
                           {0.14f, 0.1f}, {0.12f, 0.07f},  {0.05f, 0.02f}, {0.0f, 0.018f}};
  const olx_stand books = {scene, olx_add(top, olx_v3(0.3f, 0.0f, 0.02f)), 0.3f};
  OLX_TRY(olx_add_lathe(scene, "bowl", olx_add(top, olx_v3(-0.15f, 0.0f, 0.0f)), bowl, 8, 40, p->ceramic));
  OLX_TRY(olx_add_solid(&books, "book", olx_v3(-0.11f, 0.0f, -0.15f), olx_v3(0.11f, 0.03f, 0.15f), p->covers[1]));
  return olx_add_solid(&books, "book", olx_v3(-0.09f, 0.03f, -0.12f), olx_v3(0.1f, 0.055f, 0.14f), p->covers[3]);
}

static olx_result furnish_room(olx_scene *scene, const palette *p) {
  const olx_stand sofa = {scene, olx_v3(0.0f, 0.0f, -1.8f), 0.0f}, chair = {scene, olx_v3(-1.75f, 0.0f, 0.75f), 2.3f},
                  table = {scene, olx_v3(0.0f, 0.012f, -0.45f), 0.0f}, rug = {scene, olx_v3(0.0f, 0.0f, -0.35f), 0.0f},
                  books = {scene, olx_v3(2.1f, 0.0f, room_back + 0.15f), 0.0f},
                  lamp = {scene, olx_v3(-1.5f, 0.0f, -1.85f), 0.0f}, plant = {scene, olx_v3(-2.5f, 0.0f, -1.85f), 0.0f};
  OLX_TRY(add_rug(&rug, (olx_vec2){1.5f, 1.0f}, p));
  OLX_TRY(olx_add_sofa(&sofa, 2.2f, 3, p->sofa_cloth, p->walnut));
  OLX_TRY(olx_add_sofa(&chair, 0.95f, 1, p->chair_cloth, p->walnut));
  OLX_TRY(olx_add_table(&table, olx_v3(1.1f, 0.4f, 0.6f), p->walnut, p->brass));
  OLX_TRY(lay_table(scene, p, olx_v3(0.0f, 0.412f, -0.45f)));
  OLX_TRY(olx_add_bookcase(&books, olx_v3(1.4f, 2.05f, 0.28f), 6, p->oak, p->covers, COVERS, 7));
  OLX_TRY(olx_add_floor_lamp(&lamp, p->brass, p->shade, olx_v3(2.4f, 1.7f, 1.0f)));
  OLX_TRY(olx_add_plant(&plant, 1.35f, p->clay, p->leaf));
  for (uint32_t i = 0; i < 3; i++) {
    const olx_stand wall = {scene, olx_v3(-0.78f + 0.78f * (float)i, 1.55f, room_back), 0.0f};
    const uint32_t fields[3] = {p->covers[i], p->covers[3], p->covers[(i + 4) % COVERS]};
    OLX_TRY(olx_add_picture(&wall, (olx_vec2){0.56f, 0.7f}, p->walnut, fields));
  }
  return OLX_OK;
}

// Adds a small table with two chairs against the right wall.
static olx_result furnish_corner(olx_scene *scene, const palette *p) {
  const olx_stand table = {scene, olx_v3(2.45f, 0.0f, -0.2f), 0.0f},
                  left = {scene, olx_v3(2.4f, 0.0f, 0.55f), OLX_PI + 0.15f},
                  right = {scene, olx_v3(1.85f, 0.0f, -0.25f), 1.5f};
  const olx_vec2 vase[] = {{0.04f, 0.0f},  {0.055f, 0.01f}, {0.075f, 0.1f},  {0.06f, 0.19f}, {0.03f, 0.24f},
                           {0.04f, 0.27f}, {0.032f, 0.27f}, {0.024f, 0.24f}, {0.0f, 0.2f}};
  OLX_TRY(olx_add_table(&table, olx_v3(0.8f, 0.74f, 0.9f), p->oak, p->oak));
  OLX_TRY(olx_add_chair(&left, p->oak));
  OLX_TRY(olx_add_chair(&right, p->oak));
  return olx_add_lathe(scene, "vase", olx_v3(2.5f, 0.74f, -0.25f), vase, 9, 32, p->ceramic);
}

// Adds a console with a lamp that is off, below a mirror, and a runner.
static olx_result furnish_corridor(olx_scene *scene, const palette *p) {
  const olx_stand console = {scene, olx_v3(-0.2f, 0.0f, corridor_far - 0.17f), OLX_PI},
                  runner = {scene, olx_v3(0.2f, 0.0f, 0.5f * (corridor_near + corridor_far)), 0.0f},
                  mirror = {scene, olx_v3(-0.2f, 1.45f, corridor_far), OLX_PI},
                  plant = {scene, olx_v3(3.75f, 0.0f, corridor_far - 0.4f), 1.0f};
  const uint32_t glass[3] = {p->mirror, p->mirror, p->mirror};
  OLX_TRY(add_rug(&runner, (olx_vec2){2.4f, 0.4f}, p));
  OLX_TRY(olx_add_table(&console, olx_v3(0.9f, 0.78f, 0.3f), p->walnut, p->walnut));
  OLX_TRY(olx_add_picture(&mirror, (olx_vec2){0.7f, 0.9f}, p->brass, glass));
  return olx_add_plant(&plant, 1.1f, p->ceramic, p->leaf);
}

static olx_result add_daylight(olx_scene *scene) {
  scene->environment.radiance = olx_v3(1.3f, 1.6f, 2.1f);
  const olx_light sun = {.type = OLX_LIGHT_SUN,
                         .direction = olx_normalize(olx_v3(0.78f, -0.5f, -0.3f)),
                         .emission = olx_v3(26.0f, 22.5f, 17.0f)};
  return olx_scene_add_light(scene, &sun);
}

olx_result olx_build_flat(olx_scene *scene) {
  palette materials;
  OLX_TRY(mix_palette(scene, &materials));
  OLX_TRY(add_shell(scene, &materials));
  OLX_TRY(add_openings(scene, &materials));
  OLX_TRY(add_window(scene, &materials));
  OLX_TRY(add_doors(scene, &materials));
  OLX_TRY(furnish_room(scene, &materials));
  OLX_TRY(furnish_corner(scene, &materials));
  OLX_TRY(furnish_corridor(scene, &materials));
  OLX_TRY(add_daylight(scene));
  olx_set_probes(scene, olx_v3(-2.4f, 0.95f, -1.2f), olx_v3(2.4f, 2.1f, 3.1f), 4, 2, 4);
  OLX_TRY(olx_add_view(scene, "room", olx_v3(2.55f, 1.5f, 1.95f), olx_v3(-1.0f, 0.85f, -1.2f), 58.0f));
  OLX_TRY(olx_add_view(scene, "door", olx_v3(-0.9f, 1.5f, -0.9f), olx_v3(1.9f, 1.15f, 2.6f), 62.0f));
  return olx_add_view(scene, "corridor", olx_v3(-2.7f, 1.5f, 3.25f), olx_v3(1.6f, 1.1f, 3.0f), 60.0f);
}
