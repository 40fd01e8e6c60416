// Imports model files, and records problems that importers of all formats report.
#ifndef OLX_SCENE_IMPORT_MODEL_H
#define OLX_SCENE_IMPORT_MODEL_H

#include "scene/affine.h"

// What is left out of a model or coarse in it, for one warning of each kind.
typedef struct olx_model_notes {
  uint64_t absent_triangles; // triangles of materials whose opacity is below their cutoff
  uint64_t thin_faces;       // points and lines
  float farthest,
      apart; // the largest coordinate of the coarsest vertices, and the spacing of floats there, in metres
} olx_model_notes;

// Records the largest coordinate of vertices that are floats in their file and are placed by `transform`.
void olx_note_farthest(olx_model_notes *notes, float farthest, const olx_affine *transform);

void olx_warn_about_model(const char *path, const olx_model_notes *notes, olx_scene *scene);

// Append a file's content, placed by `placement`.
olx_result olx_import_obj(const char *path, const olx_affine *placement, olx_scene *scene);
olx_result olx_import_gltf(const char *path, const olx_affine *placement, olx_scene *scene);

#endif
