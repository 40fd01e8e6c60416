// A field whose light follows the lights of a scene, which may have changed since it was baked.
#ifndef OCTALUX_CLI_RELIT_FIELD_H
#define OCTALUX_CLI_RELIT_FIELD_H

#include <octalux/scene.h>

typedef struct relit_field {
  olx_relight *relight;
  uint32_t frames; // number of frames that it took
  olx_relight_stats last;
  double seconds;
} relit_field;

// Relights `field` by the scene's lights for at most `frames` frames, seen from `eye`; fewer when nothing changes any
// more. Shadow rays are cast against the scene's triangles. On success the caller frees relit->relight; on failure it
// is NULL.
olx_result relit_field_make(const olx_scene *scene, const olx_field *field, olx_vec3 eye, uint32_t frames,
                            uint32_t threads, relit_field *relit);

#endif
