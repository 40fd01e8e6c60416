// Fixtures that tests of field files share: a folder for one file, shapes of fields, and a file in memory to be damaged
// and sealed again.
#ifndef FIELD_FIXTURE_H
#define FIELD_FIXTURE_H

#include "synthetic_field.h"

#include "field/field_file.h"

#include <octalux/octalux.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static const synthetic_shape small = {.grid = {3, 2, 2}, .irradiance_grid = {2, 1, 3}, .n = 16, .irradiance_n = 8};
static const synthetic_shape of_blocks = {
    .grid = {3, 2, 2}, .irradiance_grid = {1, 1, 1}, .n = 16, .irradiance_n = 8, .compressed = true};
static const synthetic_shape of_planes = {.grid = {3, 2, 2}, .n = 64, .compressed = true, .geometry_blocks = true};
static const synthetic_shape classic = {
    .grid = {2, 1, 1}, .irradiance_grid = {2, 1, 3}, .n = 8, .irradiance_n = 8, .classic_size = 64};
static const synthetic_shape relit = {
    .grid = {2, 1, 1}, .irradiance_grid = {2, 1, 3}, .n = 16, .irradiance_n = 8, .relight_surfels = 21};
static const synthetic_shape third_order = {.grid = {1, 1, 1},
                                            .irradiance_grid = {2, 1, 3},
                                            .n = 16,
                                            .irradiance_n = 16,
                                            .irradiance_form = OLX_IRRADIANCE_SH3};
static const synthetic_shape without_probe_light = {.grid = {3, 2, 2}, .n = 16};
static const synthetic_shape least = {.grid = {1, 4, 1}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8};

// A new folder; tearing it down removes the file at `path` and fails when any other file was left behind.
typedef struct field_fixture {
  char folder[64], path[96];
} field_fixture;
int field_set_up(void **state);
int field_tear_down(void **state);

// Returns the number of files in a folder, except those whose names begin with a dot.
uint32_t field_files_in(const char *folder);
// Returns the bytes of a field file of this shape, written to the fixture's path; to be given to olx_release.
unsigned char *field_written(field_fixture *f, const synthetic_shape *shape, size_t *size_bytes);

// A file in memory; `bytes` is to be given to olx_release, the others point into it.
typedef struct field_image {
  unsigned char *bytes;
  size_t size_bytes;
  olx_file_header *header;
  olx_file_chunk *chunks;
  olx_file_info *info;
  uint32_t sealed; // number of chunks that the file was written with
} field_image;
field_image field_image_load(field_fixture *f, const synthetic_shape *shape);
void *field_chunk(const field_image *i, olx_chunk_kind kind);
// Returns the table's entry of the chunk of that type, which the file has.
olx_file_chunk *field_chunk_of_type(const field_image *i, uint32_t type);

// Make all checksums right again, or only those of the table and the header.
void field_seal(const field_image *i);
void field_seal_table(const field_image *i);

// Checks that the last error's message contains these words.
void assert_says(const char *expected);
// Check that opening the file, or only verifying it, fails with this result and a message that contains these words.
void assert_field_refused(const field_image *i, olx_result expected, const char *message);
void assert_field_unverified(const field_image *i, olx_result expected, const char *message);
void assert_field_sound(const field_image *i);

#endif
