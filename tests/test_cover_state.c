// Tests the matrix from which the method cover chooses probes: its packed bits agree with its rows.
#include "made_scenes.h"
#include "place/cover/cover_state.h"
#include "place/space/space_find.h"
#include "place_fixtures.h"
#include "tiny_scenes.h"

#include "core/hooks.h"

enum { COMMON = 500, RARE = 300, DENSE = 2000, CANDIDATES = 70 };

// Checks weights computed from packed bits against those computed from the rows.
static void expect_same_weights(const olx_cover_state *s) {
  olx_cover_open open;
  ASSERT_OK(olx_cover_open_create(s, &open));
  olx_cover_find_open(s, &open);
  for (uint32_t i = 0; i < s->candidate_count; i++) {
    const uint64_t plain = olx_cover_open_weight(s, &open, olx_cover_row(s, i));
    assert_int_equal(olx_cover_candidate_weight(s, &open, i), plain);
  }
  olx_cover_open_free(&open);
}

static void surfels_of(const olx_space *space, const olx_sight *sight, uint32_t points, uint32_t seed,
                       olx_surfels *surfels) {
  ASSERT_OK(olx_surfels_create(space, sight, OLX_SPREAD_RAYS, points, seed, 1, surfels));
  ASSERT_OK(olx_surfels_ask(space, sight, NULL, 0, seed, 1, surfels));
}

// Weights agree without picks, with some picks, and with rare columns behind the common ones, which begin in the middle
// of a word.
static void bits_weigh_as_rows_do(void **state) {
  (void)state;
  olx_scene *scene = made_finish(start_divided_room());
  const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  const olx_sight sight = olx_sight_create(olx_length(olx_sub(scene->bounds_max, scene->bounds_min)),
                                           settings.min_cosine, settings.max_footprint, settings.resolution);
  olx_space space;
  ASSERT_OK(olx_space_create(scene, settings.voxels, 1, &space));
  olx_surfels atlas, sample;
  surfels_of(&space, &sight, COMMON, 1, &atlas);
  surfels_of(&space, &sight, DENSE, 2, &sample);
  olx_candidate *candidates;
  uint32_t count;
  ASSERT_OK(olx_candidates_create(&space, &settings.grid, CANDIDATES, 3, &candidates, &count));
  olx_cover_state s;
  ASSERT_OK(olx_cover_state_create(&space, &sight, &atlas, RARE, count, 1, 2, &s));
  ASSERT_OK(olx_cover_add_candidates(&s, candidates, count / 2, NULL));
  expect_same_weights(&s);
  ASSERT_OK(olx_cover_pick(&s, s.candidates[0], olx_cover_row(&s, 0)));
  expect_same_weights(&s);
  uint8_t *views = olx_allocate(sample.count, 1);
  assert_non_null(views);
  ASSERT_OK(olx_count_views(&space, &sight, &s.picks[0].place, 1, &sample, 1, 1, views, NULL));
  ASSERT_OK(olx_cover_renew(&s, &sample, views));
  assert_true(s.columns.count > s.common && s.common % 64 != 0);
  ASSERT_OK(olx_cover_add_candidates(&s, candidates + count / 2, count - count / 2, NULL));
  expect_same_weights(&s);
  olx_release(views);
  olx_release(candidates);
  olx_surfels_free(&sample);
  olx_cover_state_free(&s);
  olx_space_free(&space);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bits_weigh_as_rows_do),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
