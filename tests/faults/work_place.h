// A place for work folders in tests, and the calls of the file system that a program makes there.
#ifndef OLX_TESTS_FAULTS_WORK_PLACE_H
#define OLX_TESTS_FAULTS_WORK_PLACE_H

#include "core/hooks.h"
#include "core/result.h"
#include "work/unit_store.h"

enum { WORK_DISK_MOST_CALLS = 64 };

// The program's calls of the file system, in order: 'w'rite, 's'ync of a file, 'f'older synced, 'r'ename, 'u'nlinking
// of a unit, unlinking of the 'm'anifest.
typedef struct work_disk_calls {
  char calls[WORK_DISK_MOST_CALLS];
  uint32_t count;
  int write_error;       // with which further writes fail; 0: they do not
  const char *spoilt;    // the name of a file that cannot be read
  int open_error;        // with which opening it fails, or
  int read_error;        // with which reading it fails
  int descriptor;        // of that file
  uint32_t most_unlinks; // unless 0, how many files can be removed, as if the program were killed then
  uint32_t unlinks;
} work_disk_calls;

// The calls of a program that uses any function of this file: all of them go through it.
extern work_disk_calls work_disk;

typedef struct work_place {
  char parent[200], folder[256], file[512];
} work_place;

// Set up and tear down a test in a folder of its own; *state becomes the work_place, and work_disk is cleared.
int work_place_create(void **state);
int work_place_remove(void **state);
// A test that runs in a place of its own.
#define IN_A_PLACE(test) cmocka_unit_test_setup_teardown(test, work_place_create, work_place_remove)

// Returns the path of a file in the work folder, or beside it for a name that begins with "../".
const char *work_place_file(work_place *p, const char *name);
// Returns the number of a folder's entries.
uint32_t count_files(const char *folder);
bool file_exists(const char *path);
// Changes one bit of a byte of a file.
void flip_byte(const char *path, long at);

// Returns the manifest of a bake of a scene, with the stages that the tests use.
olx_manifest work_place_manifest(const char *scene, const char *instructions);
olx_result work_place_open_as(const work_place *p, const olx_manifest *manifest, olx_work_lock lock, bool fresh,
                              olx_work_folder **folder);
// Opens the folder for the bake of scene "a"; it must succeed.
olx_work_folder *work_place_open(const work_place *p);

// Store a text as the result of a unit, or check that it is the one stored.
void put_unit_text(olx_work_folder *folder, const olx_unit_name *name, const char *text);
void holds_unit_text(const olx_work_folder *folder, const olx_unit_name *name, const char *text);

#endif
