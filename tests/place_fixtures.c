// Makes the rooms, settings and assertions that tests of placement share.
#include "place_fixtures.h"

#include "made_scenes.h"
#include "scene/builtin/builtin_shapes.h"
#include "scene/bvh.h"
#include "tiny_scenes.h"

olx_place_settings quick_settings(const olx_scene *scene, olx_place_method method) {
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.method = method;
  settings.surfels = 1500;
  settings.candidates = 150;
  settings.voxels = 36;
  settings.refinements = 1;
  settings.rounds = 6;
  settings.resolution = 128;
  return settings;
}

olx_place_settings quicker_settings(const olx_scene *scene, olx_place_method method) {
  olx_place_settings settings = quick_settings(scene, method);
  settings.surfels = 375;
  settings.candidates = 75;
  settings.resolution = 32;
  return settings;
}

olx_probe_set place(const olx_scene *scene, const olx_place_settings *settings) {
  olx_probe_set set;
  ASSERT_OK(olx_place(scene, settings, NULL, &set));
  return set;
}

olx_scene *load(const char *name) {
  olx_scene *scene;
  ASSERT_OK(olx_scene_load(name, &scene));
  return scene;
}

uint32_t matte(olx_scene *scene) {
  const olx_material material = tiny_lambert(0.5f, 0.0f);
  return made_material(scene, &material);
}

olx_scene *start_room(void) {
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene), materials[6] = {m, m, m, m, m, m};
  ASSERT_OK(olx_add_room(scene, "room", olx_v3(-2, 0, -2), olx_v3(2, 2, 2), materials));
  return scene;
}

olx_scene *start_divided_room(void) {
  olx_scene *scene = start_room();
  made_quad(scene, olx_v3(0, 1, -0.4f), olx_v3(0, 2, 0), olx_v3(0, 0, 3.2f), matte(scene));
  return scene;
}

olx_scene *load_ruled_room(void) {
  olx_scene *scene = made_finish(start_divided_room());
  olx_probe_rules *rules = &scene->probe_rules;
  rules->pinned = olx_allocate(2, sizeof *rules->pinned);
  rules->forbidden = olx_allocate(1, sizeof *rules->forbidden);
  assert_true(rules->pinned && rules->forbidden);
  rules->pinned[0] = olx_v3(-1.9f, 0.1f, -1.9f);
  rules->pinned[1] = olx_v3(1.0f, 1.0f, 1.0f);
  rules->pinned_count = 2;
  rules->forbidden[0] = (olx_box){{-0.6f, 0.0f, -2.0f}, {2.0f, 2.0f, 0.2f}};
  rules->forbidden_count = 1;
  rules->has_playable = true;
  rules->playable = (olx_box){{-2, 0, -2}, {2, 1.5f, 2}};
  rules->min_distance = 0.4f;
  return scene;
}

void expect_rules_kept(const olx_scene *scene, const olx_probe_set *set) {
  const olx_probe_rules *rules = &scene->probe_rules;
  assert_true(set->count >= rules->pinned_count);
  for (uint32_t i = 0; i < set->count; i++) {
    const olx_vec3 p = set->probes[i].position;
    const bool pinned = i < rules->pinned_count;
    assert_true((set->probes[i].origin == OLX_ORIGIN_PINNED) == pinned);
    if (pinned) {
      assert_memory_equal(&p, &rules->pinned[i], sizeof p);
      continue;
    }
    for (uint32_t k = 0; k < rules->forbidden_count; k++) assert_false(box_holds(&rules->forbidden[k], p));
    assert_true(box_holds(&rules->playable, p));
    assert_true(olx_bvh_distance(scene->bvh, p, 10.0f) >= rules->min_distance);
    for (uint32_t k = 0; k < i; k++) {
      assert_true(olx_length(olx_sub(p, set->probes[k].position)) >= rules->min_distance);
    }
  }
}

void expect_outside_the_centre_pillar(const olx_probe_set *set) {
  for (uint32_t i = 0; i < set->count; i++) {
    const olx_vec3 p = set->probes[i].position;
    assert_true(p.x * p.x + p.z * p.z > 0.55f * 0.55f || p.y > 2.6f);
  }
}

bool same_probes(const olx_probe_set *a, const olx_probe_set *b) {
  if (a->count != b->count) return false;
  for (uint32_t i = 0; i < a->count; i++) {
    const olx_placed_probe *p = &a->probes[i], *q = &b->probes[i];
    if (memcmp(&p->position, &q->position, sizeof p->position) != 0) return false;
    if (p->origin != q->origin || p->gain != q->gain || p->buried != q->buried) return false;
  }
  return a->report.coverage == b->report.coverage && a->report.coverage_by_area == b->report.coverage_by_area;
}

bool box_holds(const olx_box *box, olx_vec3 p) {
  return p.x >= box->min.x && p.y >= box->min.y && p.z >= box->min.z && p.x <= box->max.x && p.y <= box->max.y &&
         p.z <= box->max.z;
}

bool refuse(void *user, const char *stage, float done) {
  (void)user;
  (void)stage;
  (void)done;
  return false;
}
