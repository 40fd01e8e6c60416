// Tests baking against scenes whose light is known, such as spheres and boxes that return the light they receive,
// mirrors and skies. Tests of the file show that it is whole or untouched whatever happens, and the same for any number
// of threads.
#include "bake/irradiance/quadrature.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/sampling.h"
#include "field/field_file.h"
#include "field/texels.h"
#include "made_scenes.h"
#include "scene/scene_build.h"

#include <octalux/bake.h>

#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

// ---- a folder for each test

typedef struct folder {
  char path[200], file[256];
} folder;

static int make_folder(void **state) {
  folder *f = calloc(1, sizeof *f);
  snprintf(f->path, sizeof f->path, "%s/octalux-bake-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (!mkdtemp(f->path)) return -1;
  snprintf(f->file, sizeof f->file, "%s/field.olx", f->path);
  *state = f;
  return 0;
}

static uint32_t count_files(const folder *f, bool remove_them) {
  DIR *directory = opendir(f->path);
  uint32_t count = 0;
  for (struct dirent *entry; (entry = readdir(directory));) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
    char path[600];
    snprintf(path, sizeof path, "%s/%s", f->path, entry->d_name);
    if (remove_them) unlink(path);
    count++;
  }
  closedir(directory);
  return count;
}

static int remove_folder(void **state) {
  folder *f = *state;
  count_files(f, true);
  rmdir(f->path);
  free(f);
  return 0;
}

// ---- scenes

static olx_scene *begin_scene(void) { return olx_allocate_zero(1, sizeof(olx_scene)); }

static uint32_t add_material(olx_scene *scene, olx_vec3 color, float metallic, float roughness, olx_vec3 emission) {
  olx_material material = olx_material_default();
  material.base_color = color;
  material.metallic = metallic;
  material.roughness = roughness;
  material.emission = emission;
  uint32_t index = 0;
  assert_int_equal(olx_scene_add_material(scene, &material, &index), OLX_OK);
  return index;
}

enum { SPHERE_SIDE = 64 };

// Adds a sphere of radius 1 around the origin, seen from inside, made from the octahedral map.
static void add_sphere(olx_scene *scene, uint32_t material) {
  enum { N = SPHERE_SIDE, CORNERS = (N + 1) * (N + 1) };
  olx_vec3 *positions = olx_allocate(CORNERS, sizeof *positions), *normals = olx_allocate(CORNERS, sizeof *normals);
  uint32_t *indices = olx_allocate(6 * N * N, sizeof *indices), count = 0;
  for (uint32_t i = 0; i < CORNERS; i++) {
    positions[i] = olx_octahedral_decode((olx_vec2){(float)(i % (N + 1)) / N, (float)(i / (N + 1)) / N});
    normals[i] = olx_negate(positions[i]);
  }
  for (uint32_t y = 0; y < N; y++) {
    for (uint32_t x = 0; x < N; x++) {
      const uint32_t a = y * (N + 1) + x, b = a + 1, c = a + N + 1, d = c + 1;
      // The quads' diagonals follow the folds of the map, so that edges of the halves are those of the octahedron.
      const bool falling = (x < N / 2) == (y < N / 2);
      const uint32_t order[6] = {a, b, falling ? c : d, falling ? b : a, d, c};
      memcpy(indices + count, order, sizeof order);
      count += 6;
    }
  }
  for (uint32_t t = 0; t < count; t += 3) {
    const olx_vec3 p = positions[indices[t]], q = positions[indices[t + 1]], r = positions[indices[t + 2]];
    if (olx_dot(olx_cross(olx_sub(q, p), olx_sub(r, p)), p) > 0.0f) {
      const uint32_t swap = indices[t + 1];
      indices[t + 1] = indices[t + 2];
      indices[t + 2] = swap;
    }
  }
  assert_int_equal(olx_scene_add_mesh(scene, "sphere", positions, normals, NULL, CORNERS, indices, count / 3, material),
                   OLX_OK);
  olx_release(positions);
  olx_release(normals);
  olx_release(indices);
}

static void add_point_light(olx_scene *scene, olx_vec3 position, float intensity) {
  const olx_light light = {.type = OLX_LIGHT_POINT, .position = position, .emission = olx_splat(intensity)};
  assert_int_equal(olx_scene_add_light(scene, &light), OLX_OK);
}

static olx_scene *finish_scene(olx_scene *scene) {
  assert_int_equal(olx_scene_finish(scene), OLX_OK);
  return scene;
}

static olx_grid grid_of(olx_vec3 origin, olx_vec3 spacing, uint32_t nx, uint32_t ny, uint32_t nz) {
  return (olx_grid){.origin = origin, .spacing = spacing, .count = {nx, ny, nz}};
}

static olx_bake_settings small_settings(const olx_scene *scene, olx_grid grid, uint32_t bounces) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = settings.irradiance_grid = grid;
  settings.probe_light = true;
  settings.radiance_size = 32;
  settings.irradiance_size = 16;
  settings.bounces = bounces;
  settings.threads = 2;
  return settings;
}

// Returns settings for tests in which the accuracy of light does not matter.
static olx_bake_settings rough_settings(const olx_scene *scene, olx_grid grid, uint32_t bounces) {
  olx_bake_settings settings = small_settings(scene, grid, bounces);
  settings.noise = 0.1f;
  return settings;
}

static olx_field *bake_field(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                             olx_bake_stats *stats) {
  assert_int_equal(olx_bake(scene, settings, path, NULL, stats), OLX_OK);
  olx_field *field = NULL;
  assert_int_equal(olx_field_open(path, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  return field;
}

static size_t texel_at(uint32_t stride, uint32_t x, uint32_t y) { return (size_t)(y + 1) * stride + x + 1; }

// Asserts that a packed value is among those that values within `tolerance` of `truth` take once they are packed into
// R11G11B10F.
static void assert_packed_near(uint32_t packed, float truth, float tolerance) {
  const olx_vec3 low = olx_r11g11b10f_unpack(olx_r11g11b10f_pack(olx_splat(truth * (1.0f - tolerance))));
  const olx_vec3 high = olx_r11g11b10f_unpack(olx_r11g11b10f_pack(olx_splat(truth * (1.0f + tolerance))));
  const olx_vec3 v = olx_r11g11b10f_unpack(packed);
  if (v.x >= low.x && v.x <= high.x && v.y >= low.y && v.y <= high.y && v.z >= low.z && v.z <= high.z) return;
  fail_msg("(%g, %g, %g) where %g belongs", (double)v.x, (double)v.y, (double)v.z, (double)truth);
}

static float geometric_sum(float ratio, uint32_t terms) {
  float sum = 0.0f, term = 1.0f;
  for (uint32_t i = 0; i < terms; i++, term *= ratio) sum += term;
  return sum;
}

// ---- light

// In a sphere with a point light at its centre, every bounce adds the albedo times the previous one, everywhere.
static void sphere_follows_the_series(void **state) {
  const folder *f = *state;
  const float albedo = 0.6f, intensity = 3.0f;
  olx_scene *scene = begin_scene();
  add_sphere(scene, add_material(scene, olx_splat(albedo), 0.0f, 1.0f, olx_splat(0.0f)));
  add_point_light(scene, olx_splat(0.0f), intensity);
  finish_scene(scene);
  const uint32_t bounces[] = {0, 1, 2, 7};
  for (uint32_t b = 0; b < 4; b++) {
    const olx_grid grid = grid_of(olx_splat(-0.3f), olx_splat(0.6f), 2, 2, 2);
    const olx_bake_settings settings = small_settings(scene, grid, bounces[b]);
    olx_field *field = bake_field(scene, &settings, f->file, NULL);
    const float radiance = albedo * intensity / OLX_PI * geometric_sum(albedo, bounces[b] + 1);
    for (uint32_t probe = 0; probe < 8; probe++) {
      for (uint32_t y = 0; y < field->n; y++) {
        for (uint32_t x = 0; x < field->n; x++) {
          const size_t texel = probe * field->texels + texel_at(field->stride, x, y);
          assert_packed_near(field->radiance[texel], radiance, 0.005f);
          assert_false(olx_texel_emits(field, probe, texel - probe * field->texels));
        }
      }
      for (uint32_t y = 0; y < field->irradiance_n; y++) {
        for (uint32_t x = 0; x < field->irradiance_n; x++) {
          const size_t texel = probe * field->irradiance_texels + texel_at(field->irradiance_stride, x, y);
          assert_packed_near(field->irradiance[texel], OLX_PI * radiance, 0.005f);
        }
      }
    }
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// In a closed box that emits, probes see the emission too, while irradiance leaves it out.
static void glowing_box_follows_the_series(void **state) {
  const folder *f = *state;
  const float albedo = 0.5f, emission = 2.0f;
  olx_scene *scene = begin_scene();
  made_box(scene, olx_splat(-1.0f), olx_splat(1.0f), false,
           add_material(scene, olx_splat(albedo), 0.0f, 1.0f, olx_splat(emission)));
  finish_scene(scene);
  enum { PROBES = 2 };
  for (uint32_t bounces = 0; bounces < 4; bounces++) {
    const olx_grid grid = grid_of(olx_v3(-0.4f, 0.1f, -0.2f), olx_splat(0.8f), PROBES, 1, 1);
    olx_bake_settings settings = small_settings(scene, grid, bounces);
    settings.light_samples = 16;
    settings.irradiance_size = 64;
    olx_field *field = bake_field(scene, &settings, f->file, NULL);
    const float reflected = emission * albedo * geometric_sum(albedo, bounces + 1);
    double sum = 0.0, solid_angle = 0.0;
    for (uint32_t probe = 0; probe < PROBES; probe++) {
      for (uint32_t i = 0; i < field->n * field->n; i++) {
        const uint32_t x = i % field->n, y = i / field->n;
        const size_t texel = probe * field->texels + texel_at(field->stride, x, y);
        const double angle = olx_texel_solid_angle(x, y, field->n);
        sum += angle * (double)olx_r11g11b10f_unpack(field->radiance[texel]).x;
        solid_angle += angle;
        assert_true(olx_texel_emits(field, probe, texel - probe * field->texels));
      }
      for (uint32_t i = 0; i < field->irradiance_n * field->irradiance_n; i++) {
        const size_t texel = probe * field->irradiance_texels +
                             texel_at(field->irradiance_stride, i % field->irradiance_n, i / field->irradiance_n);
        assert_packed_near(field->irradiance[texel], OLX_PI * reflected, 0.005f);
      }
    }
    assert_float_equal((float)(sum / solid_angle), emission + reflected, 0.005f * (emission + reflected));
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// From the centre of a spherical mirror every ray comes back: light multiplies by the reflectance at normal incidence.
static void mirrors_reflect_mirrors(void **state) {
  const folder *f = *state;
  const float reflectance = 0.8f, emission = 1.0f;
  olx_scene *scene = begin_scene();
  add_sphere(scene, add_material(scene, olx_splat(reflectance), 1.0f, 0.0f, olx_splat(emission)));
  finish_scene(scene);
  for (uint32_t bounces = 0; bounces < 4; bounces++) {
    const olx_bake_settings settings =
        small_settings(scene, grid_of(olx_splat(0.0f), olx_splat(0.0f), 1, 1, 1), bounces);
    olx_field *field = bake_field(scene, &settings, f->file, NULL);
    const float reflected = emission * reflectance * geometric_sum(reflectance, bounces + 1);
    for (uint32_t i = 0; i < field->n * field->n; i++) {
      const size_t texel = texel_at(field->stride, i % field->n, i / field->n);
      assert_packed_near(field->radiance[texel], emission + reflected, 0.005f);
    }
    for (uint32_t i = 0; i < field->irradiance_n * field->irradiance_n; i++) {
      const size_t texel = texel_at(field->irradiance_stride, i % field->irradiance_n, i / field->irradiance_n);
      assert_packed_near(field->irradiance[texel], OLX_PI * reflected, 0.005f);
    }
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// Between walls of rough metal, the single-scattering model loses a little light at every reflection and never gains
// any.
static void metal_is_not_black(void **state) {
  const folder *f = *state;
  const float reflectance = 0.8f, emission = 1.0f;
  olx_scene *scene = begin_scene();
  add_sphere(scene, add_material(scene, olx_splat(reflectance), 1.0f, 0.4f, olx_splat(emission)));
  finish_scene(scene);
  static const uint32_t counts[] = {0, 1, 2, 3, 8}; // four surfaces pass a ray on, and the next one counts as matte
  for (uint32_t k = 0; k < sizeof counts / sizeof *counts; k++) {
    const uint32_t bounces = counts[k];
    const olx_bake_settings settings =
        small_settings(scene, grid_of(olx_splat(0.0f), olx_splat(0.0f), 1, 1, 1), bounces);
    olx_field *field = bake_field(scene, &settings, f->file, NULL);
    const float least = emission * geometric_sum(0.95f * reflectance, bounces + 2) - emission;
    const float most = emission * geometric_sum(1.01f * reflectance, bounces + 2) - emission;
    for (uint32_t i = 0; i < field->irradiance_n * field->irradiance_n; i++) {
      const size_t texel = texel_at(field->irradiance_stride, i % field->irradiance_n, i / field->irradiance_n);
      const float irradiance = olx_r11g11b10f_unpack(field->irradiance[texel]).x;
      assert_in_range((uint64_t)(1000.0f * irradiance), (uint64_t)(985.0f * OLX_PI * least),
                      (uint64_t)(1015.0f * OLX_PI * most));
    }
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// ---- geometry

static float distance_in_box(olx_vec3 position, olx_vec3 direction, float half) {
  const float p[3] = {position.x, position.y, position.z}, d[3] = {direction.x, direction.y, direction.z};
  float nearest = INFINITY;
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (d[axis] == 0.0f) continue;
    nearest = olx_min(nearest, ((d[axis] > 0.0f ? half : -half) - p[axis]) / d[axis]);
  }
  return nearest;
}

static void distances_are_those_of_the_box(void **state) {
  const folder *f = *state;
  olx_scene *scene = begin_scene();
  made_box(scene, olx_splat(-2.0f), olx_splat(2.0f), false,
           add_material(scene, olx_splat(0.5f), 0.0f, 1.0f, olx_splat(0.0f)));
  finish_scene(scene);
  const olx_vec3 position = olx_v3(0.5f, -0.3f, 0.9f);
  olx_bake_settings settings = small_settings(scene, grid_of(position, olx_splat(0.0f), 1, 1, 1), 0);
  settings.irradiance_size = 128;
  olx_field *field = bake_field(scene, &settings, f->file, NULL);
  const float scale = field->distance_scale;
  assert_float_equal(scale, 4.0f * sqrtf(3.0f), 1e-5f);
  for (uint32_t i = 0; i < field->n * field->n; i++) {
    const uint32_t x = i % field->n, y = i / field->n;
    const olx_vec3 d = olx_texel_direction(x, y, field->n);
    const float truth = distance_in_box(position, d, 2.0f);
    const size_t texel = texel_at(field->stride, x, y);
    assert_float_equal(olx_texel_distance(field, 0, texel), truth, truth * 0x1p-10f);
    const olx_vec3 hit = olx_madd(position, d, truth), n = olx_texel_normal(field, 0, texel);
    assert_true(olx_dot(n, d) < 0.0f);
    assert_true(olx_max3(olx_v3(fabsf(n.x), fabsf(n.y), fabsf(n.z))) > 0.9999f);
    // The normal belongs to the wall that the ray hit.
    assert_float_equal(olx_dot(n, hit), -2.0f, 2e-3f);
  }
  // Towards the wall straight ahead the lobe sees distances r / cos; their mean over cos^e is r (e + 1) / e, that of
  // their squares r^2 (e + 1) / (e - 1).
  const float e = OLX_MOMENTS_EXPONENT, r = 2.0f - 0.9f;
  const size_t centre = texel_at(field->irradiance_stride, 64, 127); // the texel towards +z, where v = 1
  const uint32_t packed = field->moments[centre];
  assert_float_equal(olx_half_unpack((uint16_t)packed) * scale, r * (e + 1.0f) / e, 0.005f * r);
  assert_float_equal(olx_half_unpack((uint16_t)(packed >> 16)) * scale * scale, r * r * (e + 1.0f) / (e - 1.0f),
                     0.01f * r * r);
  olx_field_close(field);
  olx_scene_free(scene);
}

// A floor under a bright sky: rays that miss it have an infinite distance.
static void sky_is_infinitely_far(void **state) {
  const folder *f = *state;
  olx_scene *scene = begin_scene();
  const olx_vec3 corners[4] = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  const uint32_t indices[6] = {0, 2, 1, 0, 3, 2};
  const uint32_t material = add_material(scene, olx_splat(0.5f), 0.0f, 1.0f, olx_splat(0.0f));
  assert_int_equal(olx_scene_add_mesh(scene, "floor", corners, NULL, NULL, 4, indices, 2, material), OLX_OK);
  scene->environment.radiance = olx_splat(2.0f);
  finish_scene(scene);
  const olx_bake_settings settings =
      small_settings(scene, grid_of(olx_v3(0.0f, 0.5f, 0.0f), olx_splat(0.0f), 1, 1, 1), 1);
  olx_field *field = bake_field(scene, &settings, f->file, NULL);
  for (uint32_t i = 0; i < field->n * field->n; i++) {
    const uint32_t x = i % field->n, y = i / field->n;
    const olx_vec3 d = olx_texel_direction(x, y, field->n);
    const size_t texel = texel_at(field->stride, x, y);
    const bool sky = d.y > -0.2f; // the floor begins at sin = 0.33 to 0.45
    if (sky) {
      assert_true(olx_texel_is_sky(field, 0, texel));
      assert_packed_near(field->radiance[texel], 2.0f, 0.001f);
    } else if (d.y < -0.55f) {
      assert_float_equal(olx_texel_distance(field, 0, texel), -0.5f / d.y, 1e-3f);
    }
  }
  // Straight up the lobe contains nothing but sky; straight down it contains light that the floor reflects, and no sky.
  const size_t up = texel_at(field->irradiance_stride, 8, 8), down = texel_at(field->irradiance_stride, 0, 0);
  assert_float_equal(olx_half_unpack((uint16_t)field->moments[up]), 1.0f, 1e-3f);
  assert_float_equal(olx_half_unpack((uint16_t)(field->moments[up] >> 16)), 1.0f, 1e-3f);
  // The floor sees the whole sky and sends a radiance of 0.5 * 2. It fills more than half of the cosine lobe straight
  // down, so irradiance is between pi / 2 and pi.
  const float from_floor = olx_r11g11b10f_unpack(field->irradiance[down]).x;
  assert_true(from_floor > 0.5f * OLX_PI && from_floor < OLX_PI);
  assert_float_equal(olx_r11g11b10f_unpack(field->irradiance[up]).x, 0.0f, 0.05f);
  olx_field_close(field);
  olx_scene_free(scene);
}

// ---- the file

static char *read_bytes(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  if (!file) return NULL;
  struct stat status;
  assert_int_equal(fstat(fileno(file), &status), 0);
  *size = (size_t)status.st_size;
  char *bytes = malloc(*size + 1);
  assert_int_equal(fread(bytes, 1, *size, file), *size);
  fclose(file);
  return bytes;
}

// Makes a room with every kind of material and light.
static olx_scene *busy_scene(void) {
  olx_scene *scene = begin_scene();
  const uint32_t matt = add_material(scene, olx_v3(0.7f, 0.5f, 0.3f), 0.0f, 1.0f, olx_splat(0.0f));
  olx_material plastic = olx_material_default();
  plastic.specular_weight = 1.0f;
  plastic.roughness = 0.3f;
  uint32_t shiny;
  assert_int_equal(olx_scene_add_material(scene, &plastic, &shiny), OLX_OK);
  const uint32_t metal = add_material(scene, olx_splat(0.8f), 1.0f, 0.2f, olx_splat(0.0f));
  made_box(scene, olx_splat(-1.0f), olx_splat(1.0f), false, matt);
  made_box(scene, olx_v3(-0.8f, -1.0f, -0.7f), olx_v3(-0.2f, -0.1f, -0.1f), true, shiny);
  made_box(scene, olx_v3(0.1f, -1.0f, 0.2f), olx_v3(0.7f, -0.3f, 0.9f), true, metal);
  add_point_light(scene, olx_v3(0.3f, 0.6f, -0.4f), 1.5f);
  assert_int_equal(olx_scene_add_rect_light(scene, olx_v3(0.0f, 0.95f, 0.0f), olx_v3(0.4f, 0.0f, 0.0f),
                                            olx_v3(0.0f, 0.0f, 0.4f), olx_v3(9.0f, 8.0f, 7.0f)),
                   OLX_OK);
  return finish_scene(scene);
}

static void bytes_do_not_depend_on_threads(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  olx_bake_settings settings = rough_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 1, 2), 2);
  settings.relight = true;
  const uint32_t threads[] = {1, 2, 5, 5};
  size_t size = 0, first_size = 0;
  char *first = NULL;
  for (uint32_t i = 0; i < 4; i++) {
    settings.threads = threads[i];
    olx_bake_stats stats;
    olx_field *field = bake_field(scene, &settings, f->file, &stats);
    assert_true(field->info.relight.links > 0 && field->relight.header->volume_links > 0);
    olx_field_close(field);
    char *bytes = read_bytes(f->file, &size);
    assert_int_equal(stats.file_bytes, size);
    assert_int_equal(stats.primary_rays, 4 * 32 * 32 * 4);
    assert_true(stats.rays > stats.primary_rays);
    assert_true(stats.peak_memory_bytes > 0 && stats.seconds > 0.0 && stats.embree_seconds == 0.0);
    if (first) {
      assert_int_equal(size, first_size);
      assert_memory_equal(bytes, first, size);
      free(bytes);
    } else {
      first = bytes;
      first_size = size;
    }
  }
  // Measuring Embree's time does not change the file.
  settings.measure_embree = true;
  olx_bake_stats stats;
  olx_field_close(bake_field(scene, &settings, f->file, &stats));
  char *bytes = read_bytes(f->file, &size);
  assert_int_equal(size, first_size);
  assert_memory_equal(bytes, first, size);
  assert_true(stats.embree_seconds > 0.0);
  free(bytes);
  free(first);
  olx_scene_free(scene);
}

// ---- what settings change

static double mean_irradiance(const olx_field *field) {
  const size_t count = (size_t)field->info.irradiance.probe_count * (16 + 2) * (16 + 2);
  double sum = 0.0;
  for (size_t i = 0; i < count; i++) sum += (double)olx_r11g11b10f_unpack(field->irradiance[i]).y;
  return sum / (double)count;
}

static void another_seed_draws_other_noise_alone(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  olx_bake_settings settings = small_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 1, 2), 2);
  olx_field *first = bake_field(scene, &settings, f->file, NULL);
  settings.seed = 7;
  olx_field *other = bake_field(scene, &settings, f->file, NULL);
  const size_t texels = (size_t)4 * (32 + 2) * (32 + 2);
  const size_t blocks = (size_t)first->n / 4 * first->n / 4 * first->info.probes.count;
  assert_memory_equal(first->geometry, other->geometry, blocks * sizeof *first->geometry);
  assert_memory_not_equal(first->radiance, other->radiance, texels * sizeof *first->radiance);
  const double mean = mean_irradiance(first), again = mean_irradiance(other);
  assert_true(again != mean);
  assert_true(fabs(again / mean - 1.0) < 0.02);
  olx_field_close(first);
  olx_field_close(other);
  olx_scene_free(scene);
}

// Every legal combination of sizes and samples works with the tiles that the work is divided into.
static void sizes_and_samples_combine(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  olx_bake_settings settings = rough_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(0.0f), 1, 1, 1), 1);
  const uint32_t cases[][3] = {{8, 8, 1}, {8, 32, 8}, {16, 64, 3}, {64, 8, 5}, {32, 256, 7}, {128, 16, 1}};
  for (uint32_t i = 0; i < 6; i++) {
    settings.radiance_size = cases[i][0];
    settings.irradiance_size = cases[i][1];
    settings.samples = cases[i][2];
    olx_field *field = bake_field(scene, &settings, f->file, NULL);
    const olx_field_info info = olx_field_describe(field);
    assert_int_equal(info.maps.size, cases[i][0]);
    assert_int_equal(info.irradiance.size, cases[i][1]);
    assert_int_equal(info.maps.samples, cases[i][2]);
    assert_int_equal(info.bounces.count, 1);
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

typedef struct watch {
  uint32_t calls, calls_for_light; // calls of all stages, and of those after the selectors
  float stop_at, last;
} watch;

static bool watch_progress(void *user, const char *stage, float done) {
  watch *w = user;
  w->calls++;
  w->calls_for_light += strcmp(stage, "selectors") != 0;
  assert_true(stage[0] != 0);
  assert_true(done >= w->last && done <= 1.0f);
  w->last = done;
  return done < w->stop_at;
}

static bool keeps(const olx_scene *scene, olx_bake_settings settings, const folder *f) {
  olx_bake_sizes sizes;
  assert_int_equal(olx_bake_measure(scene, &settings, f->file, &sizes), OLX_OK);
  assert_true((sizes.irradiance_probes > 0) == olx_bake_keeps_probe_light(&settings));
  return sizes.irradiance_probes > 0;
}

// Probe light is kept when it is requested, when other data is stored at irradiance probes or settings say how these
// get their light, and when there is no volume to answer in their place.
static void probe_light_is_kept_where_something_needs_it(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  olx_bake_settings plain = small_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 2, 2), 1);
  plain.probe_light = false;
  assert_false(keeps(scene, plain, f));
  assert_false(olx_bake_settings_default(scene).probe_light);
  for (uint32_t i = 0; i < 6; i++) {
    olx_bake_settings settings = plain;
    switch (i) {
    case 0: settings.probe_light = true; break;
    case 1: settings.classic = true; break;
    case 2: settings.irradiance_form = OLX_IRRADIANCE_SH2; break;
    case 3: settings.bounce_gather = OLX_GATHER_TRACED; break;
    case 4: settings.volume_cells = 0; break;
    case 5: settings.light = OLX_LIGHT_REFERENCE; break;
    }
    assert_true(keeps(scene, settings, f));
  }
  plain.relight = true; // relighting lights surfels, not probes
  assert_false(keeps(scene, plain, f));
  plain.irradiance_grid.count[0] = plain.irradiance_size = 0; // settings of irradiance probes that shape nothing
  assert_false(keeps(scene, plain, f));
  olx_scene_free(scene);
}

// Asserts that both files have the same chunks, except the description and probe light; returns how many.
static uint32_t assert_in_both(const olx_file_header *a, const olx_file_header *b) {
  const olx_file_chunk *in_a = (const void *)(a + 1), *in_b = (const void *)(b + 1);
  uint32_t alike = 0;
  for (uint32_t i = 0; i < a->chunk_count; i++) {
    if (in_a[i].type == OLX_FOUR_CC('I', 'N', 'F', 'O')) continue;
    uint32_t k = 0;
    while (k < b->chunk_count && in_b[k].type != in_a[i].type) k++;
    assert_true(k < b->chunk_count);
    assert_int_equal(in_a[i].size_bytes, in_b[k].size_bytes);
    assert_int_equal(in_a[i].hash, in_b[k].hash);
    alike++;
  }
  return alike;
}

// Leaving probe light out changes no byte of the other chunks.
static void probe_light_stands_beside_the_rest(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  olx_bake_settings settings = rough_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 2, 2), 1);
  olx_bake_stats with, without;
  size_t size;
  olx_field_close(bake_field(scene, &settings, f->file, &with));
  char *full = read_bytes(f->file, &size);
  settings.probe_light = false;
  olx_field *field = bake_field(scene, &settings, f->file, &without);
  assert_int_equal(field->info.irradiance.probe_count, 0);
  olx_field_close(field);
  char *plain = read_bytes(f->file, &size);
  const olx_file_header *a = (const void *)plain, *b = (const void *)full;
  assert_int_equal(assert_in_both(a, b), a->chunk_count - 1);
  assert_int_equal(a->chunk_count + 5, b->chunk_count);
  assert_true(without.file_bytes < with.file_bytes && without.rays < with.rays);
  assert_true(without.irradiance_seconds == 0.0 && without.irradiance_buried == 0);
  free(full);
  free(plain);
  olx_scene_free(scene);
}

static void bad_settings_are_refused(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  const olx_bake_settings good = small_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 2, 2), 1);
  for (uint32_t i = 0; i < 14; i++) {
    olx_bake_settings bad = good;
    switch (i) {
    case 0: bad.radiance_size = 4; break;
    case 1: bad.radiance_size = 4096; break;
    case 2: bad.radiance_size = 100; break;
    case 3: bad.irradiance_size = 512; break;
    case 4: bad.irradiance_size = 0; break;
    case 5: bad.samples = 0; break;
    case 6: bad.samples = 9; break;
    case 7: bad.light_samples = 0; break;
    case 8: bad.light_samples = 65; break;
    case 9: bad.bounces = 257; break;
    case 10: bad.grid.count[1] = 0; break;
    case 11: bad.irradiance_grid.spacing.y = 0.0f; break;
    case 12: bad.grid.origin.x = NAN; break;
    case 13: bad.grid.count[0] = bad.grid.count[1] = bad.grid.count[2] = 1u << 30; break;
    }
    assert_int_equal(olx_bake(scene, &bad, f->file, NULL, NULL), OLX_ERROR_ARGUMENT);
    assert_true(strlen(olx_last_error()) > 10);
    assert_int_equal(count_files(f, false), 0);
  }
  olx_scene_free(scene);
}

static void unwritable_path_fails_before_light_is_gathered(void **state) {
  (void)state;
  olx_scene *scene = busy_scene();
  const olx_bake_settings settings = small_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 2, 2), 1);
  watch w = {.stop_at = 2.0f};
  const olx_progress progress = {watch_progress, &w};
  assert_int_equal(olx_bake(scene, &settings, "/nonexistent/folder/field.olx", &progress, NULL), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "/nonexistent/folder/field.olx"));
  assert_int_equal(w.calls_for_light, 0);
  olx_scene_free(scene);
}

static void says(olx_result result, olx_result wanted, const char *words) {
  assert_int_equal(result, wanted);
  if (!strstr(olx_last_error(), words)) fail_msg("'%s' does not say '%s'", olx_last_error(), words);
}

// A part has a work folder and no output, which a limit on memory does not change.
static void a_part_with_too_little_memory_names_its_work_folder(void **state) {
  const folder *f = *state;
  char work[300], words[400];
  olx_scene *scene = busy_scene();
  olx_bake_settings settings = small_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 1, 1, 1), 1);
  olx_bake_memory memory;
  snprintf(work, sizeof work, "%s/work", f->path);
  snprintf(words, sizeof words, "%s: a limit of 0 MB of memory is too low", work);
  settings.memory_limit_bytes = 1;
  settings.work = (olx_bake_work){.folder = work, .part = 1, .parts = 1};
  says(olx_bake(scene, &settings, NULL, NULL, NULL), OLX_ERROR_MEMORY, words);
  says(olx_bake(scene, &settings, f->file, NULL, NULL), OLX_ERROR_MEMORY, words);
  settings.work.folder = NULL;
  says(olx_bake(scene, &settings, NULL, NULL, NULL), OLX_ERROR_ARGUMENT, "bake: a part needs a work folder");
  says(olx_bake_measure_memory(scene, &settings, f->file, NULL, &memory), OLX_ERROR_ARGUMENT,
       "bake: a part needs a work folder");
  assert_int_equal(count_files(f, false), 0);
  olx_scene_free(scene);
}

static void cancelling_keeps_the_old_file(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  const olx_bake_settings settings = rough_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 2, 2), 2);
  const float stops[] = {0.0f, 0.5f, 0.9f, 2.0f};
  for (uint32_t i = 0; i < 4; i++) {
    FILE *old = fopen(f->file, "wb");
    fputs("old", old);
    fclose(old);
    watch w = {.stop_at = stops[i]};
    const olx_progress progress = {watch_progress, &w};
    const olx_result result = olx_bake(scene, &settings, f->file, &progress, NULL);
    assert_int_equal(count_files(f, false), 1);
    if (stops[i] > 1.0f) {
      assert_int_equal(result, OLX_OK);
      assert_float_equal(w.last, 1.0f, 0.0f);
      continue;
    }
    // Reports are rare, so this bake ended before the report that would have cancelled it.
    if (result == OLX_OK) continue;
    assert_int_equal(result, OLX_ERROR_CANCELLED);
    size_t size = 0;
    char *bytes = read_bytes(f->file, &size);
    assert_int_equal(size, 3);
    assert_memory_equal(bytes, "old", 3);
    free(bytes);
  }
  olx_scene_free(scene);
}

// A bake that is killed at any moment leaves the old file or the whole new one. OCTALUX_KILLS sets the number of kills.
static void killing_leaves_old_or_new(void **state) {
  const folder *f = *state;
  olx_scene *scene = busy_scene();
  olx_bake_settings settings = rough_settings(scene, grid_of(olx_splat(-0.5f), olx_splat(1.0f), 2, 1, 2), 1);
  olx_bake_stats stats;
  settings.samples = 1;
  olx_field_close(bake_field(scene, &settings, f->file, &stats));
  size_t old_size = 0, new_size = 0;
  char *old_bytes = read_bytes(f->file, &old_size);
  settings.samples = 2;
  olx_field_close(bake_field(scene, &settings, f->file, &stats));
  char *new_bytes = read_bytes(f->file, &new_size);
  const double seconds = stats.seconds + stats.write_seconds;
  const uint32_t kills = getenv("OCTALUX_KILLS") ? (uint32_t)atoi(getenv("OCTALUX_KILLS")) : 8;
  for (uint32_t i = 0; i < kills; i++) {
    FILE *file = fopen(f->file, "wb");
    assert_int_equal(fwrite(old_bytes, 1, old_size, file), old_size);
    fclose(file);
    const pid_t child = fork();
    if (child == 0) _exit(olx_bake(scene, &settings, f->file, NULL, NULL) == OLX_OK ? 0 : 1);
    const double moment = seconds * 1.2 * (double)olx_unit_float(olx_hash(i));
    const struct timespec wait = {(time_t)moment, (long)((moment - floor(moment)) * 1e9)};
    nanosleep(&wait, NULL);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    size_t size = 0;
    char *bytes = read_bytes(f->file, &size);
    const bool is_old = size == old_size && memcmp(bytes, old_bytes, size) == 0;
    const bool is_new = size == new_size && memcmp(bytes, new_bytes, size) == 0;
    assert_true(is_old || is_new);
    free(bytes);
  }
  free(old_bytes);
  free(new_bytes);
  olx_scene_free(scene);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)

int main(void) {
  const struct CMUnitTest tests[] = {
      IN_FOLDER(sphere_follows_the_series),
      IN_FOLDER(glowing_box_follows_the_series),
      IN_FOLDER(mirrors_reflect_mirrors),
      IN_FOLDER(metal_is_not_black),
      IN_FOLDER(distances_are_those_of_the_box),
      IN_FOLDER(sky_is_infinitely_far),
      IN_FOLDER(bytes_do_not_depend_on_threads),
      IN_FOLDER(another_seed_draws_other_noise_alone),
      IN_FOLDER(sizes_and_samples_combine),
      IN_FOLDER(probe_light_is_kept_where_something_needs_it),
      IN_FOLDER(probe_light_stands_beside_the_rest),
      IN_FOLDER(bad_settings_are_refused),
      IN_FOLDER(unwritable_path_fails_before_light_is_gathered),
      IN_FOLDER(a_part_with_too_little_memory_names_its_work_folder),
      IN_FOLDER(cancelling_keeps_the_old_file),
      IN_FOLDER(killing_leaves_old_or_new),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
