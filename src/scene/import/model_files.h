// The files of a model: which may be read, and how Assimp reads them.
#ifndef OLX_SCENE_MODEL_FILES_H
#define OLX_SCENE_MODEL_FILES_H

#include "scene/scene_data.h"

struct aiScene;

// Rejects a file that a model names and that lies neither in the parent of the model's folder nor below it, unless the
// scene is loaded with allow_outside. Links are resolved first. A file that does not exist passes.
olx_result olx_model_file_check(const olx_scene *scene, const char *model_path, const char *path);

// Locates a file that a model names relative to itself. MTL files from Windows use backslashes; glTF escapes characters
// with % and two hexadecimal digits; any other % is itself.
void olx_model_file_locate(const char *model_path, const char *name, char *path, size_t size_bytes);

// Reads an OBJ model with Assimp; each file passes the check above. Material files must begin with a material, are read
// once, and their materials are counted. `steps` are Assimp's. The caller releases *source with aiReleaseImport.
olx_result olx_model_read(const char *path, unsigned steps, olx_scene *scene, const struct aiScene **source);

#endif
