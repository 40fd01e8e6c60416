// Runs frames of a relighter until the light of a field matches the current lights of a scene.
#include "relit_field.h"

#include "stop.h"

enum { MOST_LIGHTS = 256 };

static olx_result run_frames(olx_vec3 eye, uint32_t frames, relit_field *relit) {
  olx_result result = OLX_OK;
  relit->last.awake = 1;
  while (!stop_requested() && relit->frames < frames && relit->last.awake > 0 && result == OLX_OK) {
    result = olx_relight_frame(relit->relight, eye, &relit->last);
    relit->frames++;
    relit->seconds += relit->last.seconds;
  }
  return stop_requested() ? OLX_ERROR_CANCELLED : result;
}

olx_result relit_field_make(const olx_scene *scene, const olx_field *field, olx_vec3 eye, uint32_t frames,
                            uint32_t threads, relit_field *relit) {
  *relit = (relit_field){.frames = 0};
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = (void *)(uintptr_t)scene; // the scene is only read
  settings.threads = threads;
  olx_light lights[MOST_LIGHTS];
  uint32_t count;
  olx_result result = olx_scene_relight_lights(scene, lights, MOST_LIGHTS, &count);
  if (result == OLX_OK) result = olx_relight_create(field, &settings, &relit->relight);
  if (result == OLX_OK) result = olx_relight_set_lights(relit->relight, lights, count);
  if (result == OLX_OK) result = run_frames(eye, frames, relit);
  if (result == OLX_OK) return OLX_OK;
  olx_relight_free(relit->relight);
  relit->relight = NULL;
  return result;
}
