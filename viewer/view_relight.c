// Runs a relighter beside the viewer's images, on a separate thread or in step with them, and uploads its changes to
// the device.
#include "view_relight.h"
#include "view_lights.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LIGHTS = 256 };

struct view_relight {
  olx_relight *relight;
  olx_vulkan_update *update;
  olx_light scene_lights[MOST_LIGHTS], lights[MOST_LIGHTS];
  uint32_t light_count;
  bool lights_changed;
  olx_relight_stats stats; // statistics of the last frame
  olx_result result;
  char message[256]; // message of a failed frame, because messages are local to their thread
  olx_vec3 eye;
  // The thread. Members above belong to it while `running`; members below do not.
  pthread_t thread;
  bool has_thread;
  pthread_mutex_t lock;
  pthread_cond_t wake;
  bool running, leave; // protected by the lock
  view_lights wanted;  // set by the images' thread
  bool lights_wanted;
};

static void run_frame(view_relight *r) {
  r->result = OLX_OK;
  if (r->lights_changed) r->result = olx_relight_set_lights(r->relight, r->lights, r->light_count);
  r->lights_changed = false;
  if (r->result == OLX_OK) r->result = olx_relight_frame(r->relight, r->eye, &r->stats);
  if (r->result != OLX_OK) strncpy(r->message, olx_last_error(), sizeof r->message - 1);
}

static void *run_frames(void *user) {
  view_relight *r = user;
  pthread_mutex_lock(&r->lock);
  for (;;) {
    while (!r->running && !r->leave) pthread_cond_wait(&r->wake, &r->lock);
    if (r->leave) break;
    pthread_mutex_unlock(&r->lock);
    run_frame(r);
    pthread_mutex_lock(&r->lock);
    r->running = false;
  }
  pthread_mutex_unlock(&r->lock);
  return NULL;
}

static bool is_running(view_relight *r) {
  if (!r->has_thread) return false;
  pthread_mutex_lock(&r->lock);
  const bool running = r->running;
  pthread_mutex_unlock(&r->lock);
  return running;
}

static void set_running(view_relight *r) {
  pthread_mutex_lock(&r->lock);
  r->running = true;
  pthread_cond_signal(&r->wake);
  pthread_mutex_unlock(&r->lock);
}

static olx_result make(const olx_scene *scene, const olx_field *field, olx_vulkan_field *uploaded, view_relight *r) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = (void *)(uintptr_t)scene; // the scene is only read
  const olx_vulkan_update_settings copies = olx_vulkan_update_settings_default();
  olx_result result = olx_scene_relight_lights(scene, r->scene_lights, MOST_LIGHTS, &r->light_count);
  if (result == OLX_OK) result = olx_relight_create(field, &settings, &r->relight);
  if (result == OLX_OK) result = olx_vulkan_update_create(uploaded, r->relight, &copies, &r->update);
  return result;
}

view_relight *view_relight_create(gpu_device *d, const olx_scene *scene, const olx_field *field,
                                  olx_vulkan_field *uploaded, bool in_step) {
  view_relight *r = calloc(1, sizeof *r);
  if (!r) {
    gpu_fail(d, "out of memory for the relighter");
    return NULL;
  }
  pthread_mutex_init(&r->lock, NULL);
  pthread_cond_init(&r->wake, NULL);
  bool fine = gpu_check_library(d, make(scene, field, uploaded, r));
  if (fine && !in_step) {
    r->has_thread = pthread_create(&r->thread, NULL, run_frames, r) == 0;
    fine = r->has_thread || gpu_fail(d, "no thread for the relighter");
  }
  if (fine) return r;
  view_relight_destroy(r);
  return NULL;
}

void view_relight_destroy(view_relight *r) {
  if (!r) return;
  if (r->has_thread) {
    pthread_mutex_lock(&r->lock);
    r->leave = true;
    pthread_cond_signal(&r->wake);
    pthread_mutex_unlock(&r->lock);
    pthread_join(r->thread, NULL);
  }
  pthread_cond_destroy(&r->wake);
  pthread_mutex_destroy(&r->lock);
  olx_vulkan_update_destroy(r->update);
  olx_relight_free(r->relight);
  free(r);
}

// Sets the lights. Only the images' thread uses this copy; a frame of the relighter takes it over when it begins.
void view_relight_lights(view_relight *r, const view_lights *lights) {
  r->wanted = *lights;
  r->lights_wanted = true;
}

static void begin_frame(view_relight *r, olx_vec3 eye) {
  r->eye = eye;
  if (r->lights_wanted) {
    memcpy(r->lights, r->scene_lights, sizeof r->lights);
    view_lights_relit(&r->wanted, r->lights, r->light_count);
    r->lights_changed = true;
    r->lights_wanted = false;
  }
  if (r->has_thread) set_running(r);
  else run_frame(r);
}

bool view_relight_record(gpu_device *d, view_relight *r, olx_vec3 eye, VkCommandBuffer commands,
                         view_relight_times *t) {
  t->on = true;
  t->copied_bytes = 0;
  if (is_running(r)) return true;
  if (!r->has_thread) begin_frame(r, eye);
  if (r->result != OLX_OK) return gpu_fail(d, "%s", r->message);
  olx_vulkan_update_stats copied;
  if (!gpu_check_library(d, olx_vulkan_record_update(r->update, commands, &copied))) return false;
  t->copied_bytes = copied.bytes;
  t->waiting_bytes = copied.waiting_bytes;
  t->awake = r->stats.awake;
  t->milliseconds = (float)(1e3 * r->stats.seconds);
  t->history[t->frames++ % VIEW_HISTORY] = t->milliseconds;
  if (r->has_thread) begin_frame(r, eye);
  return true;
}
