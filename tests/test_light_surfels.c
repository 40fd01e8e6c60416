// Tests which places share the light of a surfel.
#include "light/surfels/light_surfels.h"
#include "made_scenes.h"
#include "scene/scene_build.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// A pane of any opacity parts the ceiling above it from its own underside, which faces the same way.
static void surfels_do_not_share_light_through_a_pane(void **state) {
  (void)state;
  for (float alpha = 0.0f; alpha < 1.0f; alpha += 0.4f) {
    olx_scene *scene = made_scene();
    olx_material pane = olx_material_default();
    pane.blended = true;
    pane.alpha = alpha;
    pane.alpha_cutoff = 0.5f;
    made_square(scene, 0.0f, made_material(scene, &pane));
    made_square(scene, 1.0f, made_material(scene, &(olx_material){.alpha = 1.0f}));
    made_finish(scene);
    olx_light_surfels surfels;
    assert_int_equal(olx_light_surfels_create(&surfels, scene, 0.2f, 0, 1), OLX_OK);
    const olx_vec3 down = {0.0f, -1.0f, 0.0f};
    const olx_light_surfel above = {.position = {0.1f, 0.2f, 0.1f}, .normal = down};
    const olx_surface below = {.position = {0.0f, -0.2f, 0.0f}, .geometric_normal = down};
    assert_true(olx_light_surfels_see(&surfels, &above, &below) == (alpha == 0.0f));
    olx_light_surfels_free(&surfels);
    olx_scene_free(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(surfels_do_not_share_light_through_a_pane)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
