// Stores the light between two bounces as units of the store, at most once a second.
#include "light/solution/light_checkpoint.h"

#include "core/hooks.h"
#include "core/result.h"

// Least time between checkpoints: shorter work is cheaper to repeat.
static const double BOUNCE_SECONDS = 1.0;

static void put_state(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_bounce_state *s = &((const olx_light_checkpoint *)user)->state;
  olx_bytes_put(to, &s->done, 1, sizeof s->done);
  olx_bytes_put(to, s->light, (size_t)OLX_BOUNCES_KEPT * s->surfel_count, sizeof *s->light);
  olx_bytes_put(to, s->irradiance, s->surfel_count, sizeof *s->irradiance);
  olx_bytes_put(to, s->passed_on, s->surfel_count, sizeof *s->passed_on);
}

static olx_result take_state(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  olx_bounce_state *s = &((olx_light_checkpoint *)user)->state;
  olx_bytes_copy(from, &s->done, 1, sizeof s->done);
  olx_bytes_copy(from, s->light, (size_t)OLX_BOUNCES_KEPT * s->surfel_count, sizeof *s->light);
  olx_bytes_copy(from, s->irradiance, s->surfel_count, sizeof *s->irradiance);
  olx_bytes_copy(from, s->passed_on, s->surfel_count, sizeof *s->passed_on);
  return OLX_OK;
}

static olx_unit_stage bounce_of(olx_light_checkpoint *c) {
  return (olx_unit_stage){"bounce", c->round, 1, c, NULL, put_state, take_state, OLX_PARTS_ALL};
}

// Loads a checkpoint; a damaged one is ignored.
static void load_bounce(void *user, olx_bounce_state *state) {
  olx_light_checkpoint *c = user;
  olx_unit_store *store = c->light->settings.store;
  const olx_unit_stage stage = bounce_of(c);
  c->state = *state;
  if (olx_units_have(store, &stage) && olx_units_load(store, &stage) == OLX_OK) *state = c->state;
}

static olx_result save_bounce(void *user, const olx_bounce_state *state) {
  olx_light_checkpoint *c = user;
  const olx_unit_stage stage = bounce_of(c);
  if (olx_seconds() - c->last < BOUNCE_SECONDS) return OLX_OK;
  c->state = *state;
  OLX_TRY(olx_unit_keep(c->light->settings.store, &stage));
  c->last = olx_seconds();
  return OLX_OK;
}

// Steps that end in the same round differ in their number of bounces, by which checkpoints are distinguished.
olx_bounce_keeper olx_light_checkpoint_begin(olx_light_checkpoint *c, olx_scene_light *l, bool all) {
  *c = (olx_light_checkpoint){
      .light = l, .round = 4 * l->round + 2 * (l->phase == OLX_LIGHT_DIRECT) + all, .last = olx_seconds()};
  return (olx_bounce_keeper){c, load_bounce, save_bounce};
}
