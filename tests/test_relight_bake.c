// Tests what a bake stores for relighting, in a closed room whose light is known: surfels, links between them, and
// sites of texels.
#include "core/pack.h"
#include "field/field_data.h"
#include "field/maps.h"
#include "scene_files.h"
#include "tiny_scenes.h"

#include <octalux/bake.h>

// Makes a cube of 2 m with walls of one albedo and a point light.
static olx_scene *room(float albedo, olx_vec3 lamp, float intensity) {
  olx_scene *scene = tiny_scene();
  olx_material walls = olx_material_default();
  walls.base_color = olx_splat(albedo);
  tiny_box(scene, &walls);
  const olx_light light = {.type = OLX_LIGHT_POINT, .position = lamp, .emission = olx_splat(intensity)};
  ASSERT_OK(olx_scene_add_light(scene, &light));
  return tiny_finish(scene);
}

static olx_field *bake(const scene_folder *folder, const olx_scene *scene, uint32_t bounces, bool probe_light) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = settings.irradiance_grid = (olx_grid){olx_splat(-0.5f), olx_splat(1.0f), {2, 2, 2}};
  settings.probe_light = probe_light;
  settings.radiance_size = 32;
  settings.irradiance_size = 16;
  settings.bounces = bounces;
  settings.threads = 2;
  settings.relight = true;
  char path[400];
  snprintf(path, sizeof path, "%s/field.olx", folder->path);
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_field *field = NULL;
  ASSERT_OK(olx_field_open(path, &field));
  ASSERT_OK(olx_field_verify(field));
  return field;
}

// Returns the sum of the weights of a surfel's links.
static olx_vec3 sum_of_links(const olx_relight_data *d, uint32_t surfel) {
  olx_vec3 sum = {0};
  for (uint32_t i = d->link_starts[surfel]; i < d->link_starts[surfel + 1]; i++) {
    const olx_vec3 weight = olx_rgb9e5_unpack(d->links[i].weight);
    assert_true(olx_finite(weight) && weight.x >= 0.0f && weight.y >= 0.0f && weight.z >= 0.0f);
    sum = olx_add(sum, weight);
  }
  return sum;
}

// Asserts that at each corner of a block the weights of a site sum to 255, and that texels that see a surface have a
// site.
static void assert_sites(const olx_field *field) {
  const olx_relight_data *d = &field->relight;
  for (uint32_t site = 0; site < d->header->sites; site++) {
    uint32_t sum[4] = {0};
    for (uint32_t i = d->entry_starts[site]; i < d->entry_starts[site + 1]; i++) {
      for (uint32_t corner = 0; corner < 4; corner++) sum[corner] += d->entries[i].weights[corner];
    }
    for (uint32_t corner = 0; corner < 4; corner++) assert_int_equal(sum[corner], 255);
  }
  const uint32_t side = field->n / OLX_RELIGHT_BLOCK;
  for (uint32_t i = 0; i < d->header->blocks; i++) {
    bool sky = true;
    for (uint32_t texel = 0; texel < 16; texel++) {
      const uint32_t x = i % side * 4 + texel % 4, y = i / side % side * 4 + texel / 4;
      sky &= olx_texel_is_sky(field, i / (side * side), olx_map_index(field->stride, (int32_t)x, (int32_t)y));
    }
    assert_true((d->blocks[i].first_site == OLX_RELIGHT_NO_SITE) == sky);
  }
}

// Asserts that surfels are on the walls of a room from -1 to 1, slightly inside, and face it.
static void assert_surfels_on_walls(const olx_relight_data *d) {
  for (uint32_t i = 0; i < d->header->surfels; i++) {
    const olx_vec3 normal = olx_normal_unpack((uint16_t)d->surfels[i].normal);
    for (uint32_t k = 0; k < OLX_RELIGHT_POINTS; k++) {
      const olx_vec3 p = olx_load3(d->surfels[i].points[k]);
      const float inside = 1.0f + olx_dot(p, normal);
      if (!(inside > 0.0f && inside < 0.01f))
        fail_msg("surfel %u point %u: %g %g %g normal %g %g %g", i, k, p.x, p.y, p.z, normal.x, normal.y, normal.z);
      assert_true(inside > 0.0f && inside < 0.01f && olx_max3(olx_max_each(p, olx_negate(p))) < 1.0f);
    }
  }
}

// Returns the light that a surfel receives over its links.
static olx_vec3 gathered(const olx_relight_data *d, uint32_t surfel, const olx_vec3 *values) {
  olx_vec3 sum = {0};
  for (uint32_t i = d->link_starts[surfel]; i < d->link_starts[surfel + 1]; i++) {
    const olx_vec3 light = values[olx_relight_link_from(&d->links[i])];
    sum = olx_add(sum, olx_mul(olx_rgb9e5_unpack(d->links[i].weight), light));
  }
  return sum;
}

// Computes the irradiance of surfels by passing light over the stored links until it settles.
static void settle(const olx_relight_data *d, const olx_vec3 *direct, olx_vec3 *irradiance) {
  const uint32_t surfels = d->header->surfels;
  olx_vec3 *values = olx_allocate(surfels, sizeof *values);
  for (uint32_t i = 0; i < surfels; i++) irradiance[i] = olx_splat(0.0f);
  for (uint32_t bounce = 0; bounce < 32; bounce++) {
    for (uint32_t i = 0; i < surfels; i++) values[i] = olx_add(direct[i], irradiance[i]);
    for (uint32_t i = 0; i < surfels; i++) irradiance[i] = gathered(d, i, values);
  }
  olx_release(values);
}

// In a closed room all light that a surface receives comes from walls, which reflect a share of what they receive: the
// weights of links sum to that share. A lamp in the middle gives the walls a direct light computed here; passed over
// the links it becomes the baked light, except for some noise of the bake.
static void relighting_holds_the_light_of_a_closed_room(void **state) {
  const float albedo = 0.6f, intensity = 2.0f;
  olx_scene *scene = room(albedo, olx_splat(0.0f), intensity);
  olx_field *field = bake(*state, scene, 16, false);
  const olx_relight_data *d = &field->relight;
  const uint32_t surfels = d->header->surfels;
  assert_int_equal(field->info.irradiance.probe_count, 0);
  assert_int_equal(d->header->blocks, 8 * 8 * 8);
  assert_true(surfels > 100);
  assert_surfels_on_walls(d);
  assert_sites(field);
  double weights = 0.0, off = 0.0, light = 0.0;
  olx_vec3 *direct = olx_allocate(surfels, sizeof *direct), *irradiance = olx_allocate(surfels, sizeof *irradiance);
  for (uint32_t i = 0; i < surfels; i++) {
    const uint32_t links = d->link_starts[i + 1] - d->link_starts[i];
    assert_true(links > 0 && links <= 256);
    const olx_vec3 sum = sum_of_links(d, i);
    assert_true(fabsf(sum.y / albedo - 1.0f) < 0.15f);
    weights += (double)sum.y / surfels;
    direct[i] = olx_splat(0.0f);
    for (uint32_t k = 0; k < OLX_RELIGHT_POINTS; k++) {
      const olx_vec3 p = olx_load3(d->surfels[i].points[k]);
      const float cosine = -olx_dot(p, olx_normal_unpack((uint16_t)d->surfels[i].normal)) / olx_length(p);
      direct[i] = olx_add(direct[i], olx_splat(intensity * cosine / olx_dot(p, p) / OLX_RELIGHT_POINTS));
    }
  }
  settle(d, direct, irradiance);
  for (uint32_t i = 0; i < surfels; i++) {
    const float baked = olx_rgb9e5_unpack(d->surfels[i].irradiance).y;
    off += (double)olx_square(irradiance[i].y - baked);
    light += (double)olx_square(baked);
  }
  print_message("links weigh %.4f on average, relit light is off by %.4f\n", weights, sqrt(off / light));
  assert_true(fabs(weights / (double)albedo - 1.0) < 0.02);
  assert_true(sqrt(off / light) < 0.05);
  olx_release(direct);
  olx_release(irradiance);
  olx_field_close(field);
  olx_scene_free(scene);
}

// Black walls pass no light on: their field is valid, and has surfels without links.
static void relighting_may_have_little_to_hold(void **state) {
  olx_scene *scene = room(0.0f, olx_splat(0.1f), 1.0f);
  olx_field *field = bake(*state, scene, 2, true);
  assert_non_null(field->relight.header);
  assert_true(field->info.relight.surfels > 0);
  assert_int_equal(field->info.relight.links, 0);
  assert_int_equal(field->relight.header->volume_links, 0);
  olx_field_close(field);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(relighting_holds_the_light_of_a_closed_room, scene_folder_set_up,
                                      scene_folder_tear_down),
      cmocka_unit_test_setup_teardown(relighting_may_have_little_to_hold, scene_folder_set_up, scene_folder_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
