// Applies events and held keys to the viewer's state: its camera, its modes, and the lights.
#include "view_input.h"
#include "view_lights.h"

#include <math.h>
#include <string.h>

static const float RADIANS_A_PIXEL = 0.004f, FAST = 4.0f, SLOW = 0.25f, RADIANS_A_SECOND = 0.5f;

int view_key_named(const char *name) {
  static const char *const names[VIEW_KEYS] = {
      [VIEW_KEY_SHIFT] = "SHIFT",         [VIEW_KEY_CONTROL] = "CONTROL", [VIEW_KEY_TAB] = "TAB",
      [VIEW_KEY_ESCAPE] = "ESCAPE",       [VIEW_KEY_UP] = "UP",           [VIEW_KEY_DOWN] = "DOWN",
      [VIEW_KEY_LEFT] = "LEFT",           [VIEW_KEY_RIGHT] = "RIGHT",     [VIEW_KEY_PAGE_UP] = "PAGE_UP",
      [VIEW_KEY_PAGE_DOWN] = "PAGE_DOWN", [VIEW_KEY_F12] = "F12"};
  if (name[0] > ' ' && name[0] < 127 && !name[1])
    return name[0] >= 'a' && name[0] <= 'z' ? name[0] - 'a' + 'A' : name[0];
  for (int key = VIEW_KEY_SHIFT; key < VIEW_KEYS; key++) {
    if (strcmp(names[key], name) == 0) return key;
  }
  return 0;
}

void view_input_push(view_input *input, view_event event) {
  if (input->event_count < VIEW_EVENTS_MAX) input->events[input->event_count++] = event;
}

static uint32_t next_of(uint32_t value, uint32_t count, bool back) { return (value + (back ? count - 1 : 1)) % count; }

// Returns the next selector that the field contains and the device supports; the search over all probes and the best
// selector follow.
static uint32_t next_select(const view_facts *facts, uint32_t select, bool back) {
  for (;;) {
    select = next_of(select, OLX_SELECT_BEST + 1, back);
    if (select >= OLX_SELECT_EXHAUSTIVE) return select;
    const bool runs = select == OLX_SELECT_CAGE || select == OLX_SELECT_BRICKS || select == OLX_SELECT_VORONOI;
    if (runs && facts->field.select_mask >> select & 1u) return select;
  }
}

static uint32_t next_overlay(const view_facts *facts, uint32_t overlay, bool back) {
  do overlay = next_of(overlay, VIEW_OVERLAYS, back);
  while (!view_has_overlay(&facts->field, overlay));
  return overlay;
}

static void choose_camera(const view_facts *facts, uint32_t index, view_state *state, view_camera *camera) {
  state->camera = index;
  *camera = view_camera_of(&facts->cameras[index]);
}

// Returns the next map to show, from the one of the probe that resolves the ray through those of all probes.
static uint32_t next_probe(const view_facts *facts, uint32_t probe, bool back) {
  const uint32_t count = facts->field.probes.count;
  return next_of(probe == VIEW_ANSWERING ? count : probe, count + 1, back);
}

// Returns the next light that the arrow keys move, or none after the last one.
static uint32_t next_light(const view_state *s, bool back) {
  const uint32_t count = s->lights.count, next = next_of(s->light == VIEW_NO_LIGHT ? count : s->light, count + 1, back);
  return next == count ? VIEW_NO_LIGHT : next;
}

// Cycles through no ball, a matte one, and a chrome one.
static void next_ball(view_state *s, bool back) {
  const bool chrome = s->object_metallic > 0.5f;
  const uint32_t next =
      next_of(s->object ? (chrome ? VIEW_CHROME + 1u : VIEW_MATTE + 1u) : 0, VIEW_FINISH_COUNT + 1, back);
  s->object = next > 0;
  if (!s->object) return;
  s->object_roughness = VIEW_FINISHES[next - 1].roughness;
  s->object_metallic = VIEW_FINISHES[next - 1].metallic;
}

static void set_exposure(view_state *s, float exposure) {
  s->exposure = exposure;
  s->auto_exposure = false;
}

static void press(int key, bool back, const view_facts *facts, view_state *s, view_camera *camera) {
  if (key >= '1' && key < '1' + VIEW_MODES) s->mode = (uint32_t)(key - '1');
  switch (key) {
  case 'O': s->overlay = next_overlay(facts, s->overlay, back); break;
  case 'T': s->tracer = next_of(s->tracer, OLX_TRACER_HIZ + 1, back); break;
  case 'B': s->select = next_select(facts, s->select, back); break;
  case 'C': choose_camera(facts, next_of(s->camera, facts->camera_count, back), s, camera); break;
  case 'N':
    s->probe = next_probe(facts, s->probe, back);
    if (s->probe == facts->field.probes.count) s->probe = VIEW_ANSWERING;
    break;
  case 'J': s->auto_exposure = !s->auto_exposure; break;
  case 'R': s->direct = !s->direct; break;
  case 'F': s->diffuse = !s->diffuse; break;
  case 'G': s->glossy = !s->glossy; break;
  case 'L': s->emitters = !s->emitters; break;
  case 'V': s->visibility = !s->visibility; break;
  case 'X': next_ball(s, back); break;
  case 'M': s->light = next_light(s, back); break;
  case 'K':
    if (s->light < s->lights.count) s->lights.strength[s->light] = s->lights.strength[s->light] > 0.0f ? 0.0f : 1.0f;
    break;
  case '=': set_exposure(s, fminf(s->exposure * 1.25f, 1e4f)); break;
  case '-': set_exposure(s, fmaxf(s->exposure / 1.25f, 1e-4f)); break;
  case ']': s->scale = fminf(s->scale * 2.0f, 1.0f); break;
  case '[': s->scale = fmaxf(s->scale * 0.5f, 0.125f); break;
  case VIEW_KEY_TAB: s->panel = !s->panel; break;
  case 'P':
  case VIEW_KEY_F12: s->take_screenshot = true; break;
  case VIEW_KEY_ESCAPE: s->quit = true; break;
  default: break;
  }
}

static float held_way(const view_input *input, int forth, int back) {
  return (float)input->held[forth] - (float)input->held[back];
}

static void turn_sun(const view_input *input, float seconds, view_state *s) {
  const float step = RADIANS_A_SECOND * seconds * (input->held[VIEW_KEY_SHIFT] ? FAST : 1.0f);
  const float up = held_way(input, VIEW_KEY_PAGE_UP, VIEW_KEY_PAGE_DOWN) + held_way(input, VIEW_KEY_UP, VIEW_KEY_DOWN);
  view_lights_move(&s->lights, s->light, held_way(input, VIEW_KEY_RIGHT, VIEW_KEY_LEFT) * step, up * step, 0.0f, 0.0f);
}

static void fly(const view_input *input, float seconds, view_state *s, view_camera *camera) {
  float metres = s->speed * seconds;
  if (input->held[VIEW_KEY_SHIFT]) metres *= FAST;
  if (input->held[VIEW_KEY_CONTROL]) metres *= SLOW;
  view_camera_move(camera, held_way(input, 'D', 'A') * metres, held_way(input, 'E', 'Q') * metres,
                   held_way(input, 'W', 'S') * metres);
  // The arrow keys move a light, or else the object, in their direction in the image, along the floor. Suns move across
  // the sky.
  const float right = held_way(input, VIEW_KEY_RIGHT, VIEW_KEY_LEFT) * metres,
              away = held_way(input, VIEW_KEY_UP, VIEW_KEY_DOWN) * metres;
  if (s->light < s->lights.count) {
    const float up = held_way(input, VIEW_KEY_PAGE_UP, VIEW_KEY_PAGE_DOWN) * metres;
    if (s->lights.light[s->light].type == OLX_LIGHT_SUN) turn_sun(input, seconds, s);
    else view_lights_move(&s->lights, s->light, right, up, away, camera->yaw);
    return;
  }
  if (!s->object) return;
  s->object_position.x += cosf(camera->yaw) * right + sinf(camera->yaw) * away;
  s->object_position.y += held_way(input, VIEW_KEY_PAGE_UP, VIEW_KEY_PAGE_DOWN) * metres;
  s->object_position.z += sinf(camera->yaw) * right - cosf(camera->yaw) * away;
}

void view_input_apply(view_input *input, float seconds, const view_facts *facts, view_state *state,
                      view_camera *camera) {
  for (uint32_t i = 0; i < input->event_count; i++) {
    const view_event *e = &input->events[i];
    switch (e->kind) {
    case VIEW_EVENT_PRESS:
      input->held[e->key] = true;
      press(e->key, input->held[VIEW_KEY_SHIFT], facts, state, camera);
      break;
    case VIEW_EVENT_RELEASE: input->held[e->key] = false; break;
    case VIEW_EVENT_LOOK: view_camera_turn(camera, e->x * RADIANS_A_PIXEL, -e->y * RADIANS_A_PIXEL); break;
    case VIEW_EVENT_CLICK:
      state->picked = true;
      state->pick[0] = e->x;
      state->pick[1] = e->y;
      break;
    case VIEW_EVENT_WHEEL: state->speed = fminf(fmaxf(state->speed * powf(1.2f, e->y), 1e-3f), 1e4f); break;
    case VIEW_EVENT_LIGHT: view_lights_place(&state->lights, (uint32_t)e->key, (olx_vec3){e->x, e->y, e->z}); break;
    case VIEW_EVENT_DIM:
      if ((uint32_t)e->key < state->lights.count) state->lights.strength[e->key] = e->x;
      break;
    case VIEW_EVENT_FORGET: memset(input->held, 0, sizeof input->held); break;
    }
  }
  input->event_count = 0;
  fly(input, seconds, state, camera);
}
