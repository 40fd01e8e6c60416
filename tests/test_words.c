// Tests that text from files is shown in the library's own words and cannot control a terminal: escaped messages, JSON
// whose strings and members are unambiguous, images of another kind, and correct counts where memory ends.
#include "core/hooks.h"
#include "core/name.h"
#include "core/result.h"
#include "scene/import/json_value.h"
#include "scene/name_index.h"
#include "scene/scene_build.h"
#include "scene_files.h"

#include <octalux/bake.h>
#include <octalux/place.h>
#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_printable(const char *text, const char *expected) {
  char printable[256];
  olx_printable(text, printable, sizeof printable);
  assert_string_equal(printable, expected);
}

static void control_characters_are_escaped(void **state) {
  (void)state;
  assert_printable("plain", "plain");
  assert_printable("\x1b[2J", "\\x1b[2J");
  assert_printable("a\nb\tc\rd\x7f", "a\\x0ab\\x09c\\x0dd\\x7f");
  assert_printable("K\xc3\xb6ln \xe2\x80\x93 \xf0\x9f\x92\xa1", "K\xc3\xb6ln \xe2\x80\x93 \xf0\x9f\x92\xa1");
  assert_printable("\xc2\x9b"
                   "31m",
                   "\\xc2\\x9b31m"); // U+009B begins a command, as ESC [ does
  assert_printable("\x9b"
                   "31m\xe2\x80",
                   "\\x9b31m\\xe2\\x80");
  assert_printable("\xc2\xa0", "\xc2\xa0");
}

// Bytes that are not UTF-8: overlong forms, halves of surrogate pairs, and codes above U+10FFFF.
static void bytes_that_are_not_utf8_are_escaped(void **state) {
  (void)state;
  static const char *const wrong[][2] = {{"\xc0\x80", "\\xc0\\x80"},
                                         {"\xc1\xbf", "\\xc1\\xbf"},
                                         {"\xe0\x80\x9b", "\\xe0\\x80\\x9b"}, // U+009B begins a command
                                         {"\xe0\x9f\xbf", "\\xe0\\x9f\\xbf"},
                                         {"\xed\xa0\x80", "\\xed\\xa0\\x80"},
                                         {"\xed\xbf\xbf", "\\xed\\xbf\\xbf"},
                                         {"\xf0\x80\x80\x9b", "\\xf0\\x80\\x80\\x9b"},
                                         {"\xf0\x8f\xbf\xbf", "\\xf0\\x8f\\xbf\\xbf"},
                                         {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"},
                                         {"\xf5\x80\x80\x80", "\\xf5\\x80\\x80\\x80"},
                                         {"\xff", "\\xff"}};
  static const char *const right[] = {"\xdf\xbf",         "\xe0\xa0\x80",     "\xec\xbf\xbf",     "\xed\x80\x80",
                                      "\xed\x9f\xbf",     "\xee\x80\x80",     "\xef\xbf\xbf",     "\xf0\x90\x80\x80",
                                      "\xf1\x80\x80\x80", "\xf3\xbf\xbf\xbf", "\xf4\x80\x80\x80", "\xf4\x8f\xbf\xbf"};
  for (uint32_t i = 0; i < sizeof wrong / sizeof *wrong; i++) assert_printable(wrong[i][0], wrong[i][1]);
  for (uint32_t i = 0; i < sizeof right / sizeof *right; i++) assert_printable(right[i], right[i]);
}

static void what_does_not_fit_is_cut_whole(void **state) {
  (void)state;
  char small[6];
  olx_printable("ab\x1b", small, sizeof small);
  assert_string_equal(small, "ab");
  olx_printable("abcdefgh", small, sizeof small);
  assert_string_equal(small, "abcde");
  olx_printable("abcd\xc3\xb6", small, sizeof small);
  assert_string_equal(small, "abcd");
}

// Returns what remains of a text in a name of `size_bytes`.
static const char *name_of(const char *text, size_t size_bytes) {
  static char name[16];
  memset(name, 'z', sizeof name);
  olx_copy_name(text, name, size_bytes);
  return name;
}

static void names_are_cut_between_characters(void **state) {
  (void)state;
  assert_string_equal(name_of("lamp", 5), "lamp");
  assert_string_equal(name_of("lamp", 4), "lam");
  assert_string_equal(name_of("lamp", 1), "");
  assert_string_equal(name_of("K\xc3\xb6ln", 6), "K\xc3\xb6ln");
  assert_string_equal(name_of("K\xc3\xb6ln", 4), "K\xc3\xb6");
  assert_string_equal(name_of("K\xc3\xb6ln", 3), "K");
  assert_string_equal(name_of("a\xf0\x9f\x92\xa1", 6), "a\xf0\x9f\x92\xa1");
  for (size_t size_bytes = 2; size_bytes < 6; size_bytes++) {
    assert_string_equal(name_of("a\xf0\x9f\x92\xa1", size_bytes), "a");
  }
}

static char logged[1024];

static void keep_message(void *user, olx_log_level level, const char *message) {
  (void)user, (void)level;
  snprintf(logged, sizeof logged, "%s", message);
}

static void messages_and_warnings_are_printable(void **state) {
  (void)state;
  olx_fail(OLX_ERROR_FORMAT, "%s: broken", "evil\x1b]0;title\x07");
  assert_string_equal(olx_last_error(), "evil\\x1b]0;title\\x07: broken");
  olx_scene scene = {0};
  olx_set_hooks(&(olx_hooks){.log = keep_message});
  olx_scene_warn(&scene, "material %s", "\x1b[31m");
  olx_scene_log_warnings(&scene);
  olx_set_hooks(NULL);
  assert_string_equal(logged, "material \\x1b[31m");
  assert_string_equal(scene.warnings[0], logged);
  olx_scene_release_arrays(&scene);
}

static void assert_json_refused(const char *text, size_t size_bytes, const char *part) {
  cJSON *root = NULL;
  if (olx_json_parse("file.json", text, size_bytes, &root) == OLX_OK) fail_msg("taken: %s", text);
  assert_null(root);
  if (!strstr(olx_last_error(), part)) fail_msg("\"%s\" does not say \"%s\"", olx_last_error(), part);
}

#define ASSERT_JSON_REFUSED(text, part) assert_json_refused((text), sizeof(text) - 1, (part))

static void json_refuses_nul_in_strings(void **state) {
  (void)state;
  ASSERT_JSON_REFUSED("{\"model\":\n \"a.obj\\u0000.json\"}", "file.json: line 2: a NUL character inside a string");
  ASSERT_JSON_REFUSED("{\"mo\0del\": 1}", "line 1: a NUL character inside a string");
  ASSERT_JSON_REFUSED("{\"a\": \"\\\\\\u0000\"}", "a NUL character");
  static const char escaped[] = "{\"a\": \"\\\\u0000 \\\" \\u00e9\"}\0\0"; // a backslash, and padding behind the text
  cJSON *root = NULL;
  assert_int_equal(olx_json_parse("file.json", escaped, sizeof escaped, &root), OLX_OK);
  assert_string_equal(root->child->valuestring, "\\u0000 \" \xc3\xa9");
  cJSON_Delete(root);
}

static void json_refuses_twins(void **state) {
  (void)state;
  ASSERT_JSON_REFUSED("{\"a\": 1, \"b\": 2, \"a\": 3}", "file.json: a: there twice in one object");
  ASSERT_JSON_REFUSED("{\"nodes\": [{}, {\"mesh\": 0, \"mesh\": 1}]}", "nodes[1].mesh: there twice in one object");
  ASSERT_JSON_REFUSED("[{\"x\": {\"y\": 1, \"\\u0079\": 1}}]", "[0].x.y: there twice");
  static const char fine[] = "{\"a\": {\"a\": 1}, \"A\": [{\"a\": 1}, {\"a\": 1}]}";
  cJSON *root = NULL;
  assert_int_equal(olx_json_parse("file.json", fine, sizeof fine - 1, &root), OLX_OK);
  cJSON_Delete(root);
}

// Every reader of JSON refuses objects with two members of the same name.
static void files_of_json_refuse_twins(void **state) {
  olx_scene *scene = NULL;
  olx_probe_set set;
  const char *path = scene_folder_write_text(*state, "d.json", "{\"model\": \"builtin:cornell\", \"model\": \"x\"}");
  assert_int_equal(olx_scene_load(path, &scene), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "d.json: model: there twice"));
  path = scene_folder_write_text(*state, "m.gltf", "{\"asset\": {\"version\": \"2.0\", \"version\": \"1.0\"}}");
  assert_int_equal(olx_scene_load(path, &scene), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "m.gltf: asset.version: there twice"));
  path = scene_folder_write_text(*state, "p.json", "{\"version\": 1, \"probes\": [], \"probes\": []}");
  assert_int_equal(olx_probe_set_load(path, (const double[3]){0}, &set), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "p.json: probes: there twice"));
}

static void images_of_another_kind_are_named(void **state) {
  olx_image image;
  const char *path = scene_folder_write_text(*state, "b.png", "\x89PNG\r\n\x1a\nand so on");
  assert_int_equal(olx_image_load(path, &image), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "b.png: not an OpenEXR image but a PNG"));
  path = scene_folder_write_text(*state, "c.exr", "no picture");
  assert_int_equal(olx_image_load(path, &image), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "c.exr: not an OpenEXR image,"));
}

static size_t refused_bytes;

static void *allocate_less(void *user, size_t size_bytes) {
  (void)user;
  return size_bytes > refused_bytes ? NULL : aligned_alloc(64, (size_bytes + 63) & ~(size_t)63);
}

static void release_memory(void *user, void *memory) {
  (void)user;
  free(memory);
}

// The message states the true number of probes, also when the field has no irradiance probes.
static void memory_ends_with_a_true_count(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  refused_bytes = 2u << 20; // less than eight probes need, and more than any allocation before them
  olx_set_hooks(&(olx_hooks){.allocate = allocate_less, .release = release_memory});
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load("builtin:cornell", &scene), OLX_OK);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 8;
  settings.irradiance_grid = settings.grid;
  settings.light = OLX_LIGHT_REFERENCE;
  const olx_result result = olx_bake(scene, &settings, path, NULL, NULL);
  olx_scene_free(scene);
  olx_set_hooks(NULL);
  assert_int_equal(result, OLX_ERROR_MEMORY);
  if (!strstr(olx_last_error(), "8 irradiance probes")) fail_msg("%s", olx_last_error());
}

static void names_are_found_in_order(void **state) {
  (void)state;
  olx_name_index index = {0};
  char name[32];
  for (uint32_t i = 0; i < 1000; i++) {
    snprintf(name, sizeof name, "name %u", i % 500);
    assert_int_equal(olx_name_index_add(&index, name), OLX_OK);
  }
  for (uint32_t i = 0; i < 500; i++) {
    snprintf(name, sizeof name, "name %u", i);
    const uint32_t first = olx_name_index_find(&index, name, OLX_NO_ELEMENT);
    assert_int_equal(first, i);
    assert_int_equal(olx_name_index_find(&index, name, first), i + 500);
    assert_int_equal(olx_name_index_find(&index, name, i + 500), OLX_NO_ELEMENT);
  }
  assert_int_equal(olx_name_index_find(&index, "none", OLX_NO_ELEMENT), OLX_NO_ELEMENT);
  olx_name_index_free(&index);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(control_characters_are_escaped),
      cmocka_unit_test(bytes_that_are_not_utf8_are_escaped),
      cmocka_unit_test(what_does_not_fit_is_cut_whole),
      cmocka_unit_test(names_are_cut_between_characters),
      cmocka_unit_test(messages_and_warnings_are_printable),
      cmocka_unit_test(json_refuses_nul_in_strings),
      cmocka_unit_test(json_refuses_twins),
      IN_FOLDER(files_of_json_refuse_twins),
      IN_FOLDER(images_of_another_kind_are_named),
      IN_FOLDER(memory_ends_with_a_true_count),
      cmocka_unit_test(names_are_found_in_order),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
