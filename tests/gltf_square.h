// Models of a square in glTF, and assertions about the scenes that they load as.
#ifndef TESTS_GLTF_SQUARE_H
#define TESTS_GLTF_SQUARE_H

#include "gltf_maker.h"
#include "scene/surface.h"
#include "scene_files.h"

// A unit square in the xy plane that faces +z; v = 0 at the top.
extern const float square_positions[12], square_normals[12], square_uvs[8];
extern const uint16_t square_indices[6];

// The TGA of scene_files_tga: upper left red, upper right green, lower left blue, lower right white with alpha 0.
#define FOUR_COLORS "data:image/png;base64,AAACAAAAAAAAAAAAAgACACAoAAD//wD/AP//AAD/////AA=="

// Writes a model into the folder and returns its path, made.gltf. The arguments are those of gltf_maker_text.
const char *write_square_model(const gltf_maker *m, const scene_folder *folder, const char *primitive,
                               const char *nodes, const char *more);
// Loads a scene; the test fails where it cannot be loaded.
olx_scene *load_model(const char *path);
// Asserts that loading made.gltf fails with this result, and that the message contains `part` and the file's name.
void assert_model_refused(const char *path, olx_result expected, const char *part);
void assert_model_warned(const olx_scene *scene, const char *part);
void assert_near_number(float a, float b, float tolerance);
void assert_near_vector(olx_vec3 v, float x, float y, float z, float tolerance);

// Returns the unit normal that the winding of a triangle's corners gives.
olx_vec3 winding_normal(const olx_scene *scene, uint32_t triangle);
// Returns the surface that a downward ray from z = 1 meets on the square.
olx_surface look_at_square(const olx_scene *scene, float x, float y);

// Adds accessors of the square's positions, normals, coordinates and indices; returns the index of the first.
uint32_t add_square(gltf_maker *m);
// Returns a primitive of accessors 0 to 3 and material 0 with further attributes, in a buffer that the next call
// reuses.
const char *square_with(const char *attributes);

// Members of a reference to a texture that transform its coordinates.
#define TRANSFORM(what) ", \"extensions\": {\"KHR_texture_transform\": {" what "}}"

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

#endif
