// Selects the importer of a model by its file name, and turns problems with vertices and triangles into warnings.
#include "scene/import/import_model.h"
#include "scene/scene_build.h"

#include "core/result.h"

#include <string.h>
#include <strings.h>

static bool has_extension(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length >= tail && strcasecmp(path + length - tail, extension) == 0;
}

// Returns the largest factor by which a transform stretches an axis.
static double largest_scale(const olx_affine *a) {
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) {
    largest = fmax(largest, sqrt(a->m[0][c] * a->m[0][c] + a->m[1][c] * a->m[1][c] + a->m[2][c] * a->m[2][c]));
  }
  return largest;
}

void olx_note_farthest(olx_model_notes *notes, float farthest, const olx_affine *transform) {
  const float apart = (float)largest_scale(transform) * (nextafterf(farthest, INFINITY) - farthest);
  if (!(apart > notes->apart)) return;
  notes->apart = apart;
  notes->farthest = farthest;
}

// Warns about vertices far from the model's own origin, where floats are coarse.
static void warn_about_coarse_vertices(const char *path, const olx_model_notes *notes, olx_scene *scene) {
  const float diagonal = olx_length(olx_sub(scene->made_of.max, scene->made_of.min));
  if (!(notes->apart > 0x1p-18f * diagonal)) return;
  olx_scene_warn(scene,
                 "%s: vertices are up to %g from the model's own zero, where floats are %g m apart: keep vertices near "
                 "it, and move the model by a node or by \"translate\"",
                 path, (double)notes->farthest, (double)notes->apart);
}

void olx_warn_about_model(const char *path, const olx_model_notes *notes, olx_scene *scene) {
  if (notes->absent_triangles) {
    olx_scene_warn(scene, "%s: skipped %llu triangles of materials whose opacity is below their cutoff", path,
                   (unsigned long long)notes->absent_triangles);
  }
  if (notes->thin_faces) {
    olx_scene_warn(scene, "%s: skipped %llu points and lines", path, (unsigned long long)notes->thin_faces);
  }
  olx_scene_warn_about_rest(scene, path);
  warn_about_coarse_vertices(path, notes, scene);
}

olx_result olx_import_model(const char *path, const olx_placement *placement, olx_scene *scene) {
  const olx_affine transform = olx_affine_from_placement(placement, scene->origin);
  if (has_extension(path, ".obj")) return olx_import_obj(path, &transform, scene);
  if (has_extension(path, ".gltf") || has_extension(path, ".glb")) return olx_import_gltf(path, &transform, scene);
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: not a model: expected .gltf, .glb or .obj", path);
}
