// Tests light that is passed over links, bounce after bounce: its sums, and that solving resumes between any two
// bounces with the same bits.
#include "core/hooks.h"
#include "core/result.h"
#include "light/links/light_bounces.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { SURFELS = 3, RAYS = 2, BOUNCES = 64 };

// Links in a ring: surfel 0 is lit, 0 and 1 see each other, 1 sees 2, and 2 sees 0; there is one chain of mirrors.
typedef struct ring {
  olx_link links[SURFELS * RAYS];
  olx_fixed_light fixed[SURFELS];
  float worth[SURFELS];
  olx_link_batch batch;
  olx_light_links all;
  olx_vec3 direct[SURFELS], irradiance[SURFELS], passed_on[SURFELS];
} ring;

static olx_link link_to(uint32_t end, uint32_t chain, float weight) {
  return (olx_link){end | chain << OLX_LINK_CHAIN_SHIFT, olx_rgb9e5_pack(olx_splat(weight))};
}

static void make_ring(ring *r) {
  memset(r, 0, sizeof *r);
  r->links[0] = link_to(1, 0, 0.75f);
  r->links[1] = link_to(OLX_LINK_NOWHERE, 0, 0.0f);
  r->links[2] = link_to(0, 0, 0.5f);
  r->links[3] = link_to(2, 1, 0.875f);
  r->links[4] = link_to(0, 2, 0.625f);
  r->links[5] = link_to(1, 0, 0.9375f);
  for (uint32_t i = 0; i < SURFELS; i++) r->worth[i] = RAYS;
  r->direct[0] = olx_v3(4.0f, 2.0f, 1.0f);
  r->batch = (olx_link_batch){.count = SURFELS, .rays = RAYS, .links = r->links};
  r->all = (olx_light_links){.batches = &r->batch, .batch_count = 1, .fixed = r->fixed, .worth = r->worth};
}

// A callback's state that keeps the light after some bounce, and cancels there.
typedef struct keeper {
  uint32_t at;
  bool loads;
  uint32_t done;
  olx_vec3 light[OLX_BOUNCES_KEPT * SURFELS], irradiance[SURFELS], passed_on[SURFELS];
} keeper;

static void copy(olx_vec3 *to, const olx_vec3 *from, uint32_t count) { memcpy(to, from, count * sizeof *to); }

static olx_result save(void *user, const olx_bounce_state *state) {
  keeper *k = user;
  assert_int_equal(state->surfel_count, SURFELS);
  if (k->loads || state->done != k->at) return OLX_OK;
  k->done = state->done;
  copy(k->light, state->light, OLX_BOUNCES_KEPT * SURFELS);
  copy(k->irradiance, state->irradiance, SURFELS);
  copy(k->passed_on, state->passed_on, SURFELS);
  return OLX_ERROR_CANCELLED;
}

static void load(void *user, olx_bounce_state *state) {
  const keeper *k = user;
  if (!k->loads) return;
  state->done = k->done;
  copy(state->light, k->light, OLX_BOUNCES_KEPT * SURFELS);
  copy(state->irradiance, k->irradiance, SURFELS);
  copy(state->passed_on, k->passed_on, SURFELS);
}

static olx_result solve(ring *r, keeper *k, uint32_t *done) {
  const olx_bounce_keeper kept = {k, load, save};
  return olx_bounces_solve(&r->all, SURFELS, 1, &(olx_surfel_direct){.all = r->direct}, BOUNCES, k ? &kept : NULL,
                           r->irradiance, r->passed_on, done);
}

static void light_of_a_few_bounces_is_a_sum_over_paths(void **state) {
  (void)state;
  ring r;
  uint32_t done;
  make_ring(&r);
  const olx_bounce_keeper none = {&(keeper){.at = UINT32_MAX}, load, save};
  assert_int_equal(olx_bounces_solve(&r.all, SURFELS, 1, &(olx_surfel_direct){.all = r.direct}, 2, &none, r.irradiance,
                                     r.passed_on, &done),
                   OLX_OK);
  assert_int_equal(done, 2);
  assert_true(r.irradiance[1].x == 4.0f * 0.25f);            // one reflection: from surfel 0
  assert_true(r.irradiance[0].x == 4.0f * 0.25f * 0.375f);   // two reflections: from surfel 0 to 1 and back
  assert_true(r.irradiance[2].x == 4.0f * 0.25f * 0.46875f); // two reflections: from surfel 0 over 1
  assert_true(r.passed_on[1].x == r.irradiance[1].x);        // no direct light, and the light of one bounce
  assert_true(r.passed_on[0].x == 4.0f);
}

// Surfel 0 has 4 W/m^2 of direct light, 1 of them from the sky. What a ray found itself, its link does not carry.
static void a_link_carries_the_direct_light_that_its_ray_did_not_find(void **state) {
  (void)state;
  const olx_vec3 sky[SURFELS] = {{1.0f, 1.0f, 1.0f}};
  const struct {
    uint32_t flags;
    const olx_vec3 *sky;
    float carried;
  } cases[] = {{0, sky, 4.0f},
               {OLX_LINK_LIT, sky, 1.0f},
               {OLX_LINK_LIT | OLX_LINK_SKY_LIT, sky, 0.0f},
               {OLX_LINK_LIT | OLX_LINK_SKY_LIT, NULL, 0.0f}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    ring r;
    uint32_t done;
    make_ring(&r);
    r.links[2].end |= cases[i].flags; // from surfel 1 to surfel 0, with a weight of 0.5, one of two rays
    const olx_surfel_direct direct = {r.direct, cases[i].sky};
    assert_int_equal(olx_bounces_solve(&r.all, SURFELS, 1, &direct, 1, NULL, r.irradiance, r.passed_on, &done), OLX_OK);
    assert_true(r.irradiance[1].x == cases[i].carried * 0.25f);
  }
}

static void solving_goes_on_after_any_bounce(void **state) {
  (void)state;
  ring whole, parted;
  uint32_t done, bounces;
  make_ring(&whole);
  assert_int_equal(solve(&whole, NULL, &bounces), OLX_OK);
  assert_in_range(bounces, OLX_BOUNCES_KEPT + 2, BOUNCES - 1); // ends when less than a thousandth is missing
  for (uint32_t at = 1; at < bounces; at++) {
    keeper k = {.at = at};
    make_ring(&parted);
    assert_int_equal(solve(&parted, &k, &done), OLX_ERROR_CANCELLED);
    assert_int_equal(done, at);
    k.loads = true;
    make_ring(&parted);
    assert_int_equal(solve(&parted, &k, &done), OLX_OK);
    assert_int_equal(done, bounces);
    assert_memory_equal(parted.irradiance, whole.irradiance, sizeof whole.irradiance);
    assert_memory_equal(parted.passed_on, whole.passed_on, sizeof whole.passed_on);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(light_of_a_few_bounces_is_a_sum_over_paths),
      cmocka_unit_test(a_link_carries_the_direct_light_that_its_ray_did_not_find),
      cmocka_unit_test(solving_goes_on_after_any_bounce),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
