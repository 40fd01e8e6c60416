// Fields that tests bake for themselves.
#ifndef OLX_TESTS_BAKED_FIELD_H
#define OLX_TESTS_BAKED_FIELD_H

#include <octalux/bake.h>

// Bakes, opens and verifies a field, and fails the test when any of it fails. The file is already deleted. `stats` may
// be NULL. Close the field with olx_field_close.
olx_field *baked_field(const olx_scene *scene, const olx_bake_settings *settings, olx_bake_stats *stats);

// Assert that the number of threads does not change a byte.
void baked_field_at_any_threads(const olx_scene *scene, const olx_bake_settings *settings);

#endif
