// Tests the Voronoi selector (Wang 2018, section 4.1): the nearest probe is found, neighbours are those of a Delaunay
// triangulation where one exists and otherwise all probes, and a map names those closest in angle.
#include "bake/selectors/delaunay.h"
#include "bake/selectors/voronoi_build.h"
#include "core/hooks.h"
#include "core/octahedral.h"
#include "made_scenes.h"
#include "select/voronoi.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 512 };

// ---- neighbours

static olx_vec3 random_point(uint32_t seed, uint32_t i) {
  const olx_vec2 a = made_random(seed, 2 * i), b = made_random(seed, 2 * i + 1);
  return olx_v3(8.0f * a.x - 3.0f, 5.0f * a.y, 6.0f * b.x);
}

static bool are_neighbours(const olx_neighbours *n, uint32_t a, uint32_t b) {
  for (size_t e = n->first[a]; e < n->first[a + 1]; e++) {
    if (n->neighbour[e] == b) return true;
  }
  return false;
}

// Computes neighbours and checks that they are in ascending order, that no probe is its own neighbour, and that the
// relation is symmetric.
static olx_neighbours neighbours_of(const olx_vec3 *positions, uint32_t count) {
  olx_neighbours n;
  if (olx_neighbours_create(positions, count, &n) != OLX_OK) fail_msg("%s", olx_last_error());
  for (uint32_t i = 0; i < count; i++) {
    for (size_t e = n.first[i]; e < n.first[i + 1]; e++) {
      assert_in_range(n.neighbour[e], 0, count - 1);
      assert_int_not_equal(n.neighbour[e], i);
      if (e > n.first[i]) assert_true(n.neighbour[e] > n.neighbour[e - 1]);
      assert_true(are_neighbours(&n, n.neighbour[e], i));
    }
  }
  return n;
}

static void assert_all_neighbours(const olx_vec3 *positions, uint32_t count) {
  olx_neighbours n = neighbours_of(positions, count);
  for (uint32_t i = 0; i < count; i++) assert_int_equal(n.first[i + 1] - n.first[i], count - 1);
  olx_neighbours_free(&n);
}

// Computes the centre of the sphere through four points; returns false when they are in a plane.
static bool circumcentre(const olx_vec3 *p, const uint32_t corners[4], double centre[3], double *radius_squared) {
  double m[3][4];
  const olx_vec3 a = p[corners[0]];
  for (int i = 0; i < 3; i++) {
    const olx_vec3 q = p[corners[i + 1]];
    const double d[3] = {(double)q.x - (double)a.x, (double)q.y - (double)a.y, (double)q.z - (double)a.z};
    for (int k = 0; k < 3; k++) m[i][k] = d[k];
    m[i][3] = 0.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }
  for (int i = 0; i < 3; i++) {
    int pivot = i;
    for (int k = i + 1; k < 3; k++) pivot = fabs(m[k][i]) > fabs(m[pivot][i]) ? k : pivot;
    for (int c = 0; c < 4; c++) {
      const double swap = m[i][c];
      m[i][c] = m[pivot][c];
      m[pivot][c] = swap;
    }
    if (fabs(m[i][i]) < 1e-9) return false;
    for (int k = 0; k < 3; k++) {
      const double factor = m[k][i] / m[i][i];
      for (int c = 0; c < 4 && k != i; c++) m[k][c] -= factor * m[i][c];
    }
  }
  *radius_squared = 0;
  const double origin[3] = {(double)a.x, (double)a.y, (double)a.z};
  for (int i = 0; i < 3; i++) {
    const double offset = m[i][3] / m[i][i];
    centre[i] = origin[i] + offset;
    *radius_squared += offset * offset;
  }
  return true;
}

// By definition two points are neighbours when a sphere through them and two others has no point inside.
static void test_neighbours_share_empty_spheres(void **state) {
  (void)state;
  enum { COUNT = 24 };
  olx_vec3 p[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) p[i] = random_point(1, i);
  bool expected[COUNT][COUNT] = {{false}};
  uint32_t c[4];
  for (c[0] = 0; c[0] < COUNT; c[0]++) {
    for (c[1] = c[0] + 1; c[1] < COUNT; c[1]++) {
      for (c[2] = c[1] + 1; c[2] < COUNT; c[2]++) {
        for (c[3] = c[2] + 1; c[3] < COUNT; c[3]++) {
          double centre[3], radius_squared;
          bool empty = circumcentre(p, c, centre, &radius_squared);
          for (uint32_t i = 0; i < COUNT && empty; i++) {
            if (i == c[0] || i == c[1] || i == c[2] || i == c[3]) continue;
            const double x = (double)p[i].x - centre[0], y = (double)p[i].y - centre[1], z = (double)p[i].z - centre[2];
            empty = x * x + y * y + z * z >= radius_squared;
          }
          for (int i = 0; i < 4 && empty; i++) {
            for (int k = 0; k < 4; k++) expected[c[i]][c[k]] = true;
          }
        }
      }
    }
  }
  olx_neighbours n = neighbours_of(p, COUNT);
  for (uint32_t i = 0; i < COUNT; i++) {
    for (uint32_t k = 0; k < COUNT; k++) {
      if (i != k) assert_int_equal(are_neighbours(&n, i, k), expected[i][k]);
    }
  }
  olx_neighbours_free(&n);
}

static void test_few_probes_all_neighbour(void **state) {
  (void)state;
  olx_vec3 p[4];
  for (uint32_t i = 0; i < 4; i++) p[i] = random_point(2, i);
  for (uint32_t count = 1; count <= 4; count++) assert_all_neighbours(p, count);
}

static void test_flat_probes_all_neighbour(void **state) {
  (void)state;
  olx_vec3 p[20];
  for (uint32_t i = 0; i < 20; i++) p[i] = olx_v3(1.0f + 0.1f * (float)i, 2.0f - 0.3f * (float)i, 0.7f);
  assert_all_neighbours(p, 20); // points on a line
  for (uint32_t i = 0; i < 20; i++) p[i] = olx_v3((float)(i % 5), 2.5f, (float)(i / 5));
  assert_all_neighbours(p, 20); // points in a level plane
  for (uint32_t i = 0; i < 20; i++) {
    const olx_vec3 q = random_point(3, i);
    p[i] = olx_v3(q.x, q.z, 100.0f + 0.3f * q.x - 0.7f * q.z);
  }
  assert_all_neighbours(p, 20); // points in a tilted plane, off by rounding
  for (uint32_t i = 0; i < 20; i++) p[i] = olx_v3(3.0f, 4.0f, 5.0f);
  assert_all_neighbours(p, 20); // points at one position
}

static void test_probes_in_one_place_share_their_neighbours(void **state) {
  (void)state;
  enum { COUNT = 30 };
  olx_vec3 p[COUNT + 2];
  for (uint32_t i = 0; i < COUNT; i++) p[i] = random_point(4, i);
  p[COUNT] = p[7];
  p[COUNT + 1] = p[7];
  olx_neighbours alone = neighbours_of(p, COUNT), n = neighbours_of(p, COUNT + 2);
  for (uint32_t i = 0; i < COUNT; i++) {
    if (i == 7) continue;
    assert_int_equal(are_neighbours(&n, 7, i), are_neighbours(&alone, 7, i));
    for (uint32_t copy = COUNT; copy < COUNT + 2; copy++) {
      assert_int_equal(are_neighbours(&n, copy, i), are_neighbours(&alone, 7, i));
    }
  }
  assert_true(are_neighbours(&n, 7, COUNT) && are_neighbours(&n, COUNT + 1, 7) && are_neighbours(&n, COUNT, COUNT + 1));
  olx_neighbours_free(&alone);
  olx_neighbours_free(&n);
}

static uint32_t make_grid(olx_vec3 *p, uint32_t side, olx_vec3 origin, float spacing) {
  for (uint32_t i = 0; i < side * side * side; i++) {
    p[i] = olx_madd(origin, olx_v3((float)(i % side), (float)(i / side % side), (float)(i / side / side)), spacing);
  }
  return side * side * side;
}

// Every triangulation of a grid contains the grid's edges and stays inside its cells, whatever diagonals it chooses.
static void test_regular_grid(void **state) {
  (void)state;
  enum { SIDE = 6 };
  static olx_vec3 p[SIDE * SIDE * SIDE];
  const struct {
    olx_vec3 origin;
    float spacing;
  } places[] = {{{0, 0, 0}, 1.0f}, {{-1234.5f, 77.7f, 3.3f}, 0.1f}, {{0, 0, 0}, 1e-12f}};
  for (size_t place = 0; place < sizeof places / sizeof places[0]; place++) {
    const uint32_t count = make_grid(p, SIDE, places[place].origin, places[place].spacing);
    olx_neighbours n = neighbours_of(p, count);
    for (uint32_t i = 0; i < count; i++) {
      for (uint32_t k = 0; k < count; k++) {
        const uint32_t dx = (uint32_t)abs((int)(i % SIDE) - (int)(k % SIDE)),
                       dy = (uint32_t)abs((int)(i / SIDE % SIDE) - (int)(k / SIDE % SIDE)),
                       dz = (uint32_t)abs((int)(i / SIDE / SIDE) - (int)(k / SIDE / SIDE));
        if (dx + dy + dz == 1) assert_true(are_neighbours(&n, i, k));
        if (dx > 1 || dy > 1 || dz > 1) assert_false(are_neighbours(&n, i, k));
      }
    }
    olx_neighbours again = neighbours_of(p, count);
    assert_memory_equal(again.first, n.first, (count + 1) * sizeof *n.first);
    assert_memory_equal(again.neighbour, n.neighbour, n.first[count] * sizeof *n.neighbour);
    olx_neighbours_free(&again);
    olx_neighbours_free(&n);
  }
}

static void test_too_many_probes_in_a_plane_are_refused(void **state) {
  (void)state;
  const uint32_t count = 5000;
  olx_vec3 *p = calloc(count, sizeof *p);
  for (uint32_t i = 0; i < count; i++) p[i] = olx_v3((float)(i % 71), 0.0f, (float)(i / 71));
  olx_neighbours n;
  assert_int_equal(olx_neighbours_create(p, count, &n), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "in one plane"));
  assert_null(n.first);
  free(p);
}

// ---- maps

// A field that has only the parts that selectors read.
typedef struct made_field {
  olx_field field;
  uint8_t flags[MOST];
} made_field;

static void build(const olx_vec3 *positions, const uint8_t *flags, uint32_t count, uint32_t threads, made_field *f) {
  memset(f, 0, sizeof *f);
  if (flags) memcpy(f->flags, flags, count);
  f->field.info.probes.count = count;
  f->field.probe_positions = positions;
  f->field.probe_flags = f->flags;
  f->field.name = (char *)(uintptr_t) "made";
  const olx_selector_input input = {.positions = positions, .flags = f->flags, .count = count, .threads = threads};
  void *data;
  if (olx_voronoi_build(&input, &data, &f->field.select_bytes[OLX_SELECT_VORONOI]) != OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
  f->field.select_data[OLX_SELECT_VORONOI] = data;
  assert_int_equal(olx_voronoi_check(&f->field), OLX_OK);
  if (olx_voronoi_verify(&f->field) != OLX_OK) fail_msg("%s", olx_last_error());
}

static void release(made_field *f) { olx_release((void *)(uintptr_t)f->field.select_data[OLX_SELECT_VORONOI]); }

// Compares the nearest probe with a search of all, for few probes and for many.
static void check_nearest(const olx_vec3 *p, const uint8_t *flags, uint32_t count, uint32_t seed) {
  static made_field f;
  build(p, flags, count, 1, &f);
  for (uint32_t q = 0; q < 2000; q++) {
    // Query points are also at probes, halfway between two, and far away, where there are ties and near planes.
    const uint32_t a = q * 7 % count, b = q * 13 % count;
    const olx_vec3 point = q % 4 == 0   ? p[a]
                           : q % 4 == 1 ? olx_mix3(p[a], p[b], 0.5f)
                                        : olx_scale(random_point(seed, q), q % 4 == 2 ? 1.0f : 5.0f);
    for (int buried = 0; buried < 2; buried++) {
      uint32_t expected = OLX_NO_PROBE;
      float least = INFINITY;
      for (uint32_t i = 0; i < count; i++) {
        const olx_vec3 offset = olx_sub(p[i], point);
        if ((flags[i] && !buried) || olx_dot(offset, offset) >= least) continue;
        least = olx_dot(offset, offset);
        expected = i;
      }
      assert_int_equal(olx_voronoi_nearest(&f.field, point, buried), expected);
    }
  }
  release(&f);
}

static void test_nearest_is_the_nearest(void **state) {
  (void)state;
  static olx_vec3 p[MOST];
  uint8_t flags[MOST];
  const uint32_t counts[] = {1, 2, 7, 64, 65, 66, 127, 128, 255, 256, MOST};
  for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
    for (uint32_t i = 0; i < MOST; i++) {
      p[i] = random_point(5, i);
      flags[i] = i % 3 == 1 ? OLX_PROBE_BURIED : 0;
    }
    check_nearest(p, flags, counts[c], 6);
  }
  const uint32_t count = make_grid(p, 7, olx_v3(-3, 0, 1), 0.5f); // a grid, where ties are everywhere
  memset(flags, 0, sizeof flags);
  check_nearest(p, flags, count, 7);
  for (uint32_t i = 0; i < 100; i++) p[i] = olx_v3(1, 2, 3);
  check_nearest(p, flags, 100, 8);
}

// From the middle of a grid, the neighbour straight along an axis is the next probe on that axis, not one of those
// behind it in the same direction; a map names at most four neighbours, by rising angle.
static void test_maps_point_at_neighbours(void **state) {
  (void)state;
  static olx_vec3 p[125];
  static made_field f;
  const uint32_t count = make_grid(p, 5, olx_v3(-2, -2, -2), 1.0f), middle = 62;
  build(p, NULL, count, 1, &f);
  olx_neighbours n = neighbours_of(p, count);
  for (uint32_t i = 0; i < 500; i++) {
    const olx_vec3 direction = olx_sub(random_point(7, i), olx_v3(1, 2.5f, 3));
    uint32_t choices[OLX_CHOICES];
    olx_voronoi_neighbours(&f.field, middle, direction, choices);
    const uint32_t texel_x = (uint32_t)(olx_octahedral_encode(direction).x * OLX_VORONOI_SIZE),
                   texel_y = (uint32_t)(olx_octahedral_encode(direction).y * OLX_VORONOI_SIZE);
    const olx_vec3 centre = olx_texel_direction(texel_x, texel_y, OLX_VORONOI_SIZE);
    float last = 1.1f;
    for (uint32_t k = 0; k < OLX_CHOICES; k++) {
      assert_true(are_neighbours(&n, middle, choices[k]));
      const float cosine = olx_dot(centre, olx_normalize(p[choices[k]]));
      assert_true(cosine <= last + 1e-4f);
      last = cosine;
    }
    for (size_t e = n.first[middle]; e < n.first[middle + 1]; e++) {
      const uint32_t other = n.neighbour[e];
      if (other == choices[0] || other == choices[1] || other == choices[2] || other == choices[3]) continue;
      assert_true(olx_dot(centre, olx_normalize(p[other])) <= last + 1e-4f);
    }
  }
  olx_neighbours_free(&n);
  release(&f);
}

// On a line all probes are neighbours, and many are in the same direction: the nearest comes first.
static void test_of_one_direction_the_nearest_comes_first(void **state) {
  (void)state;
  olx_vec3 p[9];
  static made_field f;
  for (uint32_t i = 0; i < 9; i++) p[i] = olx_v3(0.1f, 0.37f * (float)i, 0.2f);
  build(p, NULL, 9, 1, &f);
  uint32_t choices[OLX_CHOICES];
  olx_voronoi_neighbours(&f.field, 4, olx_v3(0.02f, 1.0f, 0.01f), choices);
  const uint32_t up[OLX_CHOICES] = {5, 6, 7, 8};
  assert_memory_equal(choices, up, sizeof up);
  olx_voronoi_neighbours(&f.field, 4, olx_v3(0.02f, -1.0f, 0.01f), choices);
  const uint32_t down[OLX_CHOICES] = {3, 2, 1, 0};
  assert_memory_equal(choices, down, sizeof down);
  release(&f);
}

static void test_degenerate_sets_have_maps(void **state) {
  (void)state;
  static made_field f;
  uint32_t choices[OLX_CHOICES];
  const olx_vec3 p[3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 4}};
  build(p, NULL, 1, 1, &f);
  olx_voronoi_neighbours(&f.field, 0, olx_v3(1, 0, 0), choices);
  assert_int_equal(choices[0], OLX_NO_PROBE);
  release(&f);
  // A copy of the probe at the same position comes last.
  build(p, NULL, 3, 1, &f);
  olx_voronoi_neighbours(&f.field, 0, olx_v3(0, 0, -1), choices);
  assert_int_equal(choices[0], 2);
  assert_int_equal(choices[1], 1);
  assert_int_equal(choices[2], OLX_NO_PROBE);
  // A zero direction, or one that is not finite, still gives only neighbours.
  const olx_vec3 nonsense[] = {{0, 0, 0}, {NAN, 1, 0}, {INFINITY, INFINITY, 0}, {-INFINITY, 0, 1e38f}, {1e-45f, 0, 0}};
  for (size_t i = 0; i < sizeof nonsense / sizeof nonsense[0]; i++) {
    olx_voronoi_neighbours(&f.field, 0, nonsense[i], choices);
    assert_int_equal(choices[0], 2);
  }
  release(&f);
}

static void test_buried_probes_are_nobodys_neighbours(void **state) {
  (void)state;
  static olx_vec3 p[60];
  static made_field f;
  uint8_t flags[60] = {0};
  for (uint32_t i = 0; i < 60; i++) {
    p[i] = random_point(8, i);
    flags[i] = i % 4 == 1 ? OLX_PROBE_BURIED : 0;
  }
  build(p, flags, 60, 1, &f);
  for (uint32_t i = 0; i < 60; i++) {
    for (uint32_t q = 0; q < 50; q++) {
      uint32_t choices[OLX_CHOICES];
      olx_voronoi_neighbours(&f.field, i, olx_sub(random_point(9, q), p[i]), choices);
      for (uint32_t k = 0; k < OLX_CHOICES; k++) {
        if (flags[i]) assert_int_equal(choices[k], OLX_NO_PROBE);
        else assert_false(flags[choices[k]]);
      }
    }
  }
  release(&f);
}

static void test_bytes_do_not_depend_on_threads(void **state) {
  (void)state;
  static olx_vec3 p[300];
  for (uint32_t i = 0; i < 300; i++) p[i] = random_point(10, i);
  static made_field one, other;
  build(p, NULL, 300, 1, &one); // with more than 255 probes, an index takes two bytes
  for (uint32_t threads = 2; threads <= 5; threads += 3) {
    build(p, NULL, 300, threads, &other);
    assert_int_equal(one.field.select_bytes[OLX_SELECT_VORONOI], other.field.select_bytes[OLX_SELECT_VORONOI]);
    assert_int_equal(one.field.select_bytes[OLX_SELECT_VORONOI], 16 + 300 * (16 * 16 * 4 + 1) * 2);
    assert_memory_equal(one.field.select_data[OLX_SELECT_VORONOI], other.field.select_data[OLX_SELECT_VORONOI],
                        one.field.select_bytes[OLX_SELECT_VORONOI]);
    release(&other);
  }
  release(&one);
}

// ---- what a file may not hold

static void test_spoilt_maps_are_refused(void **state) {
  (void)state;
  static olx_vec3 p[10];
  for (uint32_t i = 0; i < 10; i++) p[i] = random_point(11, i);
  static made_field f;
  build(p, NULL, 10, 1, &f);
  olx_field *field = &f.field;
  olx_voronoi_header *header = (void *)(uintptr_t)field->select_data[OLX_SELECT_VORONOI];
  uint8_t *codes = (uint8_t *)(header + 1);
  size_t *bytes = &field->select_bytes[OLX_SELECT_VORONOI];
  const size_t whole = *bytes;
  for (size_t short_by = 1; short_by <= whole; short_by += whole / 7) {
    *bytes = whole - short_by;
    assert_int_equal(olx_voronoi_check(field), OLX_ERROR_FORMAT);
  }
  *bytes = whole + 1;
  assert_int_equal(olx_voronoi_check(field), OLX_ERROR_FORMAT);
  *bytes = whole;
  const uint32_t sizes[] = {0, 1, 2, 8, 15, 17, 32, 128, 0x80000000u, UINT32_MAX};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    header->size = sizes[i];
    assert_int_equal(olx_voronoi_check(field), OLX_ERROR_FORMAT);
  }
  header->size = OLX_VORONOI_SIZE;
  uint8_t *tree = codes + 10 * 256 * 4;
  for (uint32_t i = 0; i < 10; i++) {
    const uint8_t was = tree[i], other = tree[(i + 1) % 10];
    const uint8_t wrong[] = {other, 10, 254, 255};
    for (uint32_t k = 0; k < 4; k++) {
      tree[i] = wrong[k];
      assert_int_equal(olx_voronoi_verify(field), OLX_ERROR_FORMAT);
      assert_non_null(strstr(olx_last_error(), "no probe, or one again"));
    }
    tree[i] = was;
  }
  const uint8_t first = tree[0];
  tree[0] = tree[9]; // a point in the wrong half of the tree
  tree[9] = first;
  assert_int_equal(olx_voronoi_verify(field), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "order"));
  tree[9] = tree[0];
  tree[0] = first;
  assert_int_equal(olx_voronoi_verify(field), OLX_OK);
  header->zero[2] = 1;
  assert_int_equal(olx_voronoi_check(field), OLX_ERROR_FORMAT);
  header->zero[2] = 0;
  field->info.probes.count = 65536;
  assert_int_equal(olx_voronoi_check(field), OLX_ERROR_FORMAT);
  field->info.probes.count = 10;
  assert_int_equal(olx_voronoi_check(field), OLX_OK);

  const size_t last_texel = 10 * 256 * 4 - 4;
  const uint8_t good[4] = {codes[last_texel], codes[last_texel + 1], codes[last_texel + 2], codes[last_texel + 3]};
  const uint8_t bad[][4] = {{10, 0, 1, 2}, {254, 0, 1, 2}, {9, 0, 1, 2},  {0, 0, 1, 2},
                            {3, 1, 2, 3},  {255, 0, 1, 2}, {0, 1, 255, 2}};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    memcpy(codes + last_texel, bad[i], 4);
    assert_int_equal(olx_voronoi_verify(field), OLX_ERROR_FORMAT);
    assert_non_null(strstr(olx_last_error(), "probe 9, texel 255"));
    // Whatever a map contains, the selector names no probe that does not exist.
    uint32_t choices[OLX_CHOICES];
    olx_voronoi_neighbours(field, 9, olx_texel_direction(15, 15, 16), choices);
    for (uint32_t k = 0; k < OLX_CHOICES; k++) assert_true(choices[k] < 10 || choices[k] == OLX_NO_PROBE);
  }
  memcpy(codes + last_texel, good, 4);
  assert_int_equal(olx_voronoi_verify(field), OLX_OK);
  release(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_neighbours_share_empty_spheres),
      cmocka_unit_test(test_few_probes_all_neighbour),
      cmocka_unit_test(test_flat_probes_all_neighbour),
      cmocka_unit_test(test_probes_in_one_place_share_their_neighbours),
      cmocka_unit_test(test_regular_grid),
      cmocka_unit_test(test_too_many_probes_in_a_plane_are_refused),
      cmocka_unit_test(test_nearest_is_the_nearest),
      cmocka_unit_test(test_maps_point_at_neighbours),
      cmocka_unit_test(test_of_one_direction_the_nearest_comes_first),
      cmocka_unit_test(test_degenerate_sets_have_maps),
      cmocka_unit_test(test_buried_probes_are_nobodys_neighbours),
      cmocka_unit_test(test_bytes_do_not_depend_on_threads),
      cmocka_unit_test(test_spoilt_maps_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
