// Tests that the writer of field files refuses data that readers would refuse, and leaves no incomplete file.
#include "field_fixture.h"

#include "core/hooks.h"

#include <signal.h>
#include <sys/resource.h>

static void test_writer_refuses_what_readers_would(void **state) {
  const field_fixture *f = *state;
  olx_field_header header = synthetic_header(&small);
  const olx_field_info good = header.info;
  olx_field_writer *writer;
#define REFUSED(change, message)                                                                                       \
  header.info.change;                                                                                                  \
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_ERROR_ARGUMENT);                            \
  assert_null(writer);                                                                                                 \
  assert_says(message);                                                                                                \
  header.info = good
  REFUSED(maps.size = 12, "radiance size 12");
  REFUSED(irradiance.size = 4, "irradiance size 4");
  REFUSED(probes.count = 11, "not the number of probes");
  REFUSED(maps.distance_scale_metres = 0.0f, "distance scale 0");
  REFUSED(probes.grid.spacing.x = 2.0f, "light field probe 1 stands at");
  REFUSED(probes.has_grid = false, "needs light field probes on a grid");
#undef REFUSED
#define REFUSED_LIGHT(change, message)                                                                                 \
  do {                                                                                                                 \
    olx_field_light light = synthetic_lights[2];                                                                       \
    light.change;                                                                                                      \
    header.lights = &light;                                                                                            \
    header.light_count = 1;                                                                                            \
    assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_ERROR_ARGUMENT);                          \
    assert_says(message);                                                                                              \
  } while (0)
  REFUSED_LIGHT(type = 3, "light 0: unknown type");
  REFUSED_LIGHT(position.y = NAN, "light 0: impossible position");
  REFUSED_LIGHT(emission.z = INFINITY, "light 0: impossible emission");
#undef REFUSED_LIGHT
  assert_int_equal(field_files_in(f->folder), 0);
  synthetic_header_release(&header);
}

// Classic maps require irradiance probes, and so does radiance.
static void test_writer_keeps_probe_light_together(void **state) {
  const field_fixture *f = *state;
  synthetic_shape shape = without_probe_light;
  shape.classic_size = 64;
  assert_int_equal(synthetic_write(f->path, &shape, NULL), OLX_ERROR_ARGUMENT);
  assert_says("classic maps, but no irradiance probes");
  const synthetic_shape *shapes[] = {&without_probe_light, &small};
  for (int i = 0; i < 2; i++) {
    olx_field_header header = synthetic_header(shapes[i]);
    olx_field_writer *writer;
    assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
    synthetic_header_release(&header);
    uint32_t radiance[16 * 16];
    uint16_t normal[16 * 16], distance[16 * 16];
    synthetic_light_maps(16, 0, radiance, normal, distance);
    const uint32_t *wrong = i == 0 ? radiance : NULL;
    assert_int_equal(olx_field_writer_probe(writer, 0, 0, wrong, normal, distance), OLX_ERROR_ARGUMENT);
    assert_says("radiance goes with irradiance probes");
    olx_field_writer_discard(writer);
  }
  assert_int_equal(field_files_in(f->folder), 0);
}

// Lights are part of the header, and surfaces are required with every probe.
static void test_writer_wants_surfaces(void **state) {
  const field_fixture *f = *state;
  olx_field_header header = synthetic_header(&least);
  olx_field_writer *writer;
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  uint32_t radiance[8 * 8], moments[8 * 8];
  uint16_t normal[8 * 8], distance[8 * 8];
  for (uint32_t i = 0; i < 4; i++) {
    synthetic_light_maps(8, i, radiance, normal, distance);
    assert_int_equal(olx_field_writer_probe(writer, i, 0, radiance, normal, distance), OLX_OK);
  }
  synthetic_irradiance_maps(8, 0, radiance, moments);
  assert_int_equal(olx_field_writer_irradiance(writer, 0, 0, radiance, moments), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("surfaces of 0 of 4 light field probes written");
  assert_int_equal(field_files_in(f->folder), 0);
}

static olx_field_writer *begin(const field_fixture *f, const synthetic_shape *shape) {
  olx_field_header header = synthetic_header(shape);
  olx_field_writer *writer;
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  return writer;
}

static void test_writer_keeps_order(void **state) {
  const field_fixture *f = *state;
  olx_field_writer *writer = begin(f, &small);
  uint32_t radiance[16 * 16], moments[16 * 16];
  uint16_t normal[16 * 16], distance[16 * 16];
  synthetic_light_maps(16, 0, radiance, normal, distance);
  assert_int_equal(olx_field_writer_probe(writer, 1, 0, radiance, normal, distance), OLX_ERROR_ARGUMENT);
  assert_says("light field probe 1 written where 0 comes next");
  assert_int_equal(olx_field_writer_probe(writer, 0, 0, radiance, normal, distance), OLX_OK);
  assert_int_equal(olx_field_writer_probe(writer, 0, 0, radiance, normal, distance), OLX_ERROR_ARGUMENT);
  synthetic_surfaces_room *room = olx_allocate(1, sizeof *room);
  const olx_surface_maps maps = synthetic_surface_maps(16, 0, distance, room);
  assert_int_equal(olx_field_writer_surface(writer, 1, &maps), OLX_ERROR_ARGUMENT);
  assert_says("surfaces of probe 1 written where 0 comes next");
  assert_int_equal(olx_field_writer_surface(writer, 0, &maps), OLX_OK);
  olx_release(room);
  synthetic_irradiance_maps(8, 0, radiance, moments);
  assert_int_equal(olx_field_writer_irradiance(writer, 3, 0, radiance, moments), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_field_writer_irradiance(writer, 0, 0, radiance, moments), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("1 of 12 light field probes and 1 of 6 irradiance probes");

  synthetic_shape without = classic;
  without.classic_size = 0;
  olx_field_header header = synthetic_header(&classic);
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  assert_int_equal(synthetic_write_probes(writer, &without), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("classic maps of 0 of 6 irradiance probes written");
  assert_int_equal(field_files_in(f->folder), 0);
}

// Relighting data comes once, after the last surfaces, and only if the header announced it.
static void test_writer_wants_relighting_last(void **state) {
  const field_fixture *f = *state;
  const char *untimely = "relighting that the header does not have, twice, or before the last surfaces";
  size_t size_bytes;
  void *data = synthetic_relight(&relit, &size_bytes);
  synthetic_shape bare = relit;
  bare.relight_surfels = 0;

  olx_field_writer *writer = begin(f, &relit);
  assert_int_equal(olx_field_writer_relight(writer, data, size_bytes), OLX_ERROR_ARGUMENT);
  assert_says(untimely);
  assert_int_equal(synthetic_write_probes(writer, &bare), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("what relighting needs was not written");

  writer = begin(f, &bare);
  assert_int_equal(synthetic_write_probes(writer, &bare), OLX_OK);
  assert_int_equal(olx_field_writer_relight(writer, data, size_bytes), OLX_ERROR_ARGUMENT);
  assert_says(untimely);
  olx_field_writer_discard(writer);
  assert_int_equal(field_files_in(f->folder), 0);

  // A refused structure does not count: a valid one may still follow it, but not twice.
  writer = begin(f, &relit);
  assert_int_equal(synthetic_write_probes(writer, &bare), OLX_OK);
  assert_int_equal(olx_field_writer_relight(writer, data, size_bytes - 4), OLX_ERROR_FORMAT);
  assert_says("bytes where its contents take");
  assert_int_equal(olx_field_writer_relight(writer, data, size_bytes), OLX_OK);
  assert_int_equal(olx_field_writer_relight(writer, data, size_bytes), OLX_ERROR_ARGUMENT);
  assert_says(untimely);
  uint64_t file_bytes;
  assert_int_equal(olx_field_writer_commit(writer, &file_bytes), OLX_OK);
  size_t written_bytes, again_bytes;
  unsigned char *written = synthetic_read_file(f->path, &written_bytes);
  assert_int_equal(written_bytes, file_bytes);
  assert_int_equal(synthetic_write(f->path, &relit, NULL), OLX_OK);
  unsigned char *again = synthetic_read_file(f->path, &again_bytes);
  assert_int_equal(written_bytes, again_bytes);
  assert_memory_equal(written, again, written_bytes);
  olx_release(written);
  olx_release(again);
  olx_release(data);
}

static void test_old_file_survives(void **state) {
  field_fixture *f = *state;
  size_t size_bytes, size_after;
  unsigned char *before = field_written(f, &least, &size_bytes);

  olx_field_writer_discard(NULL);
  olx_field_writer_discard(begin(f, &small));
  olx_field_writer *writer = begin(f, &small);
  assert_int_equal(synthetic_write_probes(writer, &small), OLX_OK);
  assert_true(field_files_in(f->folder) <= 2); // the new file has no name, or a temporary one
  olx_field_writer_discard(writer);
  assert_int_equal(field_files_in(f->folder), 1);

  // A limit on the size of files acts like a full disk: it is noticed at the start or, where space cannot be reserved,
  // later.
  struct rlimit limit;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  const struct rlimit low = {.rlim_cur = 20000, .rlim_max = limit.rlim_max};
  olx_field_header header = synthetic_header(&small);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
  const olx_result at_once = olx_field_writer_create(f->path, &header, &writer);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
  if (at_once == OLX_OK) olx_field_writer_discard(writer);
  else assert_int_equal(at_once, OLX_ERROR_FILE);

  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
  const olx_result later = synthetic_write_probes(writer, &small);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
  signal(SIGXFSZ, handler);
  assert_int_equal(later, OLX_ERROR_FILE);
  assert_says("cannot write");
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_FILE);
  synthetic_header_release(&header);

  assert_int_equal(field_files_in(f->folder), 1);
  unsigned char *after = synthetic_read_file(f->path, &size_after);
  assert_int_equal(size_bytes, size_after);
  assert_memory_equal(before, after, size_bytes);
  olx_release(before);
  olx_release(after);
}

static void test_folder_that_cannot_be_written(void **state) {
  (void)state;
  assert_int_equal(synthetic_write("/nonexistent-folder/a.olx", &least, NULL), OLX_ERROR_FILE);
  assert_says("/nonexistent-folder/a.olx: cannot create");
  assert_int_equal(synthetic_write("/proc/a.olx", &least, NULL), OLX_ERROR_FILE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_writer_refuses_what_readers_would, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_writer_keeps_probe_light_together, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_writer_wants_surfaces, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_writer_keeps_order, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_writer_wants_relighting_last, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_old_file_survives, field_set_up, field_tear_down),
      cmocka_unit_test(test_folder_that_cannot_be_written),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
