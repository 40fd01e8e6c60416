// What tests of field files share: a folder for one file, shapes of fields, a file in memory to be
// damaged and sealed again.
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
static const synthetic_shape third_order = {
    .grid = {1, 1, 1}, .irradiance_grid = {2, 1, 3}, .n = 16, .irradiance_n = 16, .irradiance_form = OLX_IRRADIANCE_SH3};
static const synthetic_shape without_probe_light = {.grid = {3, 2, 2}, .n = 16};
static const synthetic_shape least = {.grid = {1, 4, 1}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8};

// A new folder; tearing down takes away the file at `path` and fails when another was left behind.
typedef struct field_fixture {
  char folder[64], path[96];
} field_fixture;
int field_set_up(void **state);
int field_tear_down(void **state);

// Files in a folder but those whose names begin with a dot.
uint32_t field_files_in(const char *folder);
// The bytes of such a field's file at the fixture's path, to be given to olx_release.
unsigned char *field_written(field_fixture *f, const synthetic_shape *shape, size_t *size_bytes);

// A file in memory; `bytes` is to be given to olx_release, the others point into it.
typedef struct field_image {
  unsigned char *bytes;
  size_t size_bytes;
  olx_file_header *header;
  olx_file_chunk *chunks;
  olx_file_info *info;
  uint32_t sealed; // chunks that the file was written with
} field_image;
field_image field_image_load(field_fixture *f, const synthetic_shape *shape);
void *field_chunk(const field_image *i, olx_chunk_kind kind);

// Make every checksum right again: all, or those of the table and the header.
void field_seal(const field_image *i);
void field_seal_table(const field_image *i);

// The last error holds these words.
void assert_says(const char *expected);
// Opening fails, or only verifying, with this result and these words.
void assert_field_refused(const field_image *i, olx_result expected, const char *message);
void assert_field_unverified(const field_image *i, olx_result expected, const char *message);
void assert_field_sound(const field_image *i);

#endif
