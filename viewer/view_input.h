// Input from users and scripts: a queue of events, the held keys, and their effects.
#ifndef OCTALUX_VIEW_INPUT_H
#define OCTALUX_VIEW_INPUT_H

#include "view_camera.h"
#include "view_state.h"

// Codes of keys: printable keys are their upper-case character; the others follow.
enum {
  VIEW_KEY_SHIFT = 128,
  VIEW_KEY_CONTROL,
  VIEW_KEY_TAB,
  VIEW_KEY_ESCAPE,
  VIEW_KEY_UP,
  VIEW_KEY_DOWN,
  VIEW_KEY_LEFT,
  VIEW_KEY_RIGHT,
  VIEW_KEY_PAGE_UP,
  VIEW_KEY_PAGE_DOWN,
  VIEW_KEY_F12,
  VIEW_KEYS
};

// Returns the code of a key's name ("W", "TAB", "PAGE_UP"); 0 for unknown names.
int view_key_named(const char *name);

typedef enum view_event_kind {
  VIEW_EVENT_PRESS,
  VIEW_EVENT_RELEASE,
  VIEW_EVENT_LOOK,  // the mouse was dragged by x, y pixels
  VIEW_EVENT_CLICK, // at x, y, 0..1 in the image
  VIEW_EVENT_WHEEL, // by y
  VIEW_EVENT_LIGHT, // moves light number `key` to x, y, z, or turns it to that direction
  VIEW_EVENT_DIM,   // sets light number `key` to x times its strength in the scene
  VIEW_EVENT_FORGET // releases all held keys, because the window lost focus
} view_event_kind;

typedef struct view_event {
  view_event_kind kind;
  int key;
  float x, y, z;
} view_event;

enum { VIEW_EVENTS_MAX = 256 };

typedef struct view_input {
  view_event events[VIEW_EVENTS_MAX]; // events beyond the capacity are dropped
  uint32_t event_count;
  bool held[VIEW_KEYS];
} view_input;

void view_input_push(view_input *input, view_event event);

// Applies queued events, and held keys over `seconds`, to the state and the camera.
void view_input_apply(view_input *input, float seconds, const view_facts *facts, view_state *state,
                      view_camera *camera);

#endif
