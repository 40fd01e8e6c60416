// Small scene files for tests: a temporary folder, and texts to put into it.
#ifndef OLX_TESTS_SCENE_FILES_H
#define OLX_TESTS_SCENE_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct scene_folder {
  char path[256];
} scene_folder;

// Create a new folder under TMPDIR.
bool scene_folder_create(scene_folder *folder);
// Remove the folder with everything in it.
void scene_folder_remove(const scene_folder *folder);
// Returns a set-up function for cmocka: *state becomes a new folder, and messages are discarded.
int scene_folder_set_up(void **state);
int scene_folder_tear_down(void **state);
// Write a file and return its path, which is valid for the next three calls on this thread.
const char *scene_folder_write(const scene_folder *folder, const char *name, const void *data, size_t size_bytes);
const char *scene_folder_write_text(const scene_folder *folder, const char *name, const char *text);

// Makes a glTF text whose single mesh is a unit square in the xy plane facing +z, two triangles, with normals and uvs
// (v = 0 at the top, y = 1). `materials` and `nodes` are JSON lists; `mesh_material` is the primitive's material or -1;
// `more` is appended to the root object and starts with a comma unless it is empty. The buffer of a `binary` text is
// the binary chunk of the .glb around it. Free it.
char *scene_files_gltf(const char *materials, int mesh_material, const char *nodes, const char *more, bool binary);
// Makes a square as a .glb in *data, to be freed; returns its size.
size_t scene_files_glb(const char *materials, int mesh_material, const char *nodes, const char *more, uint8_t **data);

// Makes a 2 x 2 image file (TGA): upper left red, upper right green, lower left blue, lower right white with alpha 0.
size_t scene_files_tga(uint8_t data[34]);

// An OBJ square in the xy plane facing +z with texture coordinates, one quad, material "square" of square.mtl.
extern const char scene_files_obj[];

// Finds a file of the real scenes in the first folder of OCTALUX_SCENES, or in ../shared/scenes; false when it is
// missing.
bool scene_files_real(const char *name, char *path, size_t size_bytes);

#endif
