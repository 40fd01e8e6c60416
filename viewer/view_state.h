// The state of the viewer, what it shows and how: one struct that options, keys, scripts and the panel change, and that
// the renderer reads.
#ifndef OCTALUX_VIEW_STATE_H
#define OCTALUX_VIEW_STATE_H

#include <octalux/sample.h>
#include <octalux/scene.h>

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The method of rendering (McGuire et al. 2017, section 5; VIEW_PROBES is Figure 20).
typedef enum view_mode {
  VIEW_PREFILTERED = 0, // diffuse light stored at surfaces, glossy light by one ray per pixel, denoised
  VIEW_DENOISED,        // one diffuse and one glossy ray per pixel, denoised
  VIEW_GATHER,          // unfiltered rays, accumulated while nothing moves: the reference
  VIEW_PROBES,          // no triangles: one ray per pixel from the eye through the field
  VIEW_MODES
} view_mode;
#define VIEW_MODE_WORDS "prefiltered|denoised|gather|probes"
#define VIEW_DENOISE_WORDS "none|published|adaptive"

// What is drawn over the image.
typedef enum view_overlay {
  VIEW_NO_OVERLAY = 0,
  VIEW_PROBE_INDEX,      // light field probes as balls, in the colours that other overlays use
  VIEW_PROBE_RADIANCE,   // light field probes as balls that show their radiance
  VIEW_PROBE_IRRADIANCE, // irradiance probes as balls that show their irradiance
  VIEW_WEIGHTS,          // irradiance probes that light a pixel: their colours mixed by weight
  VIEW_ANSWER,           // the probe that resolved the mirror ray of a pixel (Figure 5)
  VIEW_UNRESOLVED,       // pixels whose mirror ray stays unresolved
  VIEW_STEPS,            // texels that the mirror ray read
  VIEW_MAP,              // the octahedral map of a probe, and the image of the picked pixel's ray in it (Figure 4)
  VIEW_OVERLAYS
} view_overlay;
// Returns whether a field has the data that an overlay shows.
static inline bool view_has_overlay(const olx_field_info *field, uint32_t overlay) {
  const bool of_probe_light = overlay == VIEW_PROBE_IRRADIANCE || overlay == VIEW_WEIGHTS;
  return !of_probe_light || field->irradiance.probe_count > 0;
}
#define VIEW_OVERLAY_WORDS "none|probes|radiance|irradiance|weights|answer|unresolved|steps|map"

#define VIEW_TRACER_WORDS "texel|two-level|hiz"
#define VIEW_HITS_WORDS "shaded|stored"
#define VIEW_SELECT_WORDS "cage|voronoi|octree|bricks|exhaustive|best"

// Formats the word at an index of a list like those above for display.
void view_word(const char *words, uint32_t index, char *word, size_t size);

// Returns whether rays find the emitters in a mode.
static inline bool view_meets_emitters(uint32_t mode, bool emitters) {
  return emitters && (mode == VIEW_DENOISED || mode == VIEW_GATHER);
}

enum { VIEW_LIGHTS_MAX = 16 };

// The properties of the scene's light that the user may change.
typedef struct view_lights {
  uint32_t count; // of the scene's suns, points and spots; further ones are not changed
  olx_light light[VIEW_LIGHTS_MAX];
  float strength[VIEW_LIGHTS_MAX]; // factors of their emission
  float surfaces, sky;             // factors of lights with an extent, and of the environment
} view_lights;

// A finish of the ball.
typedef struct view_finish {
  const char *name;
  float roughness, metallic;
} view_finish;
enum { VIEW_MATTE, VIEW_CHROME, VIEW_FINISH_COUNT };
static const view_finish VIEW_FINISHES[VIEW_FINISH_COUNT] = {{"matte", 1.0f, 0.0f}, {"chrome", 0.05f, 1.0f}};

#define VIEW_NO_LIGHT UINT32_MAX // value of view_state.light: the arrow keys move the object

#define VIEW_ANSWERING UINT32_MAX // value of view_state.probe: the probe that resolved the picked ray

typedef struct view_state {
  uint32_t mode, overlay;
  uint32_t tracer, select, hits; // olx_tracer, olx_select, olx_hits
  bool visibility, keep_buried;
  bool emitters;                // rays find lights with an extent; impossible with irradiance probes
  bool direct, diffuse, glossy; // layers that are added up
  uint32_t denoise;             // index into VIEW_DENOISE_WORDS
  uint32_t ray_spacing;         // pixels between the rays of a frame that is denoised, 1 or 2
  uint32_t gather_samples;      // rays per lobe, pixel and frame
  float dim_lobe;
  float exposure;
  bool auto_exposure; // adapts the exposure to the image
  float scale;        // lit pixels per displayed pixel, along a side; 0.125 to 1
  float probe_radius; // radius of the balls in metres
  uint32_t probe;     // probe whose map is shown
  bool picked;
  float pick[2]; // in the image, 0..1 from its upper left corner
  bool object;   // show a ball that is not in the scene
  olx_vec3 object_position;
  float object_radius, object_roughness, object_metallic;
  view_lights lights;
  uint32_t light;  // light that the arrow keys move
  float speed;     // speed of the camera in metres per second
  uint32_t camera; // the scene's camera that was chosen last
  bool panel;
  bool take_screenshot, quit;
} view_state;

enum { VIEW_PASSES_MAX = 12, VIEW_HISTORY = 120 };

// The cost of relighting beside the images.
typedef struct view_relight_times {
  bool on;
  float milliseconds; // elapsed time of the relighter's last frame
  float history[VIEW_HISTORY];
  uint32_t frames, awake;               // number of frames; of tiles, surfels and volume probes that wait
  uint64_t copied_bytes, waiting_bytes; // bytes copied for this picture, and bytes still to be copied
} view_relight_times;

// Milliseconds of each pass on the device, the newest last.
typedef struct view_timings {
  uint32_t pass_count;
  const char *names[VIEW_PASSES_MAX];
  float latest[VIEW_PASSES_MAX];
  float history[VIEW_PASSES_MAX][VIEW_HISTORY];
  float total[VIEW_HISTORY];
  uint32_t frames; // number of frames so far
  view_relight_times relight;
} view_timings;

// The device's result for the picked pixel.
typedef struct view_pick {
  bool valid; // the pixel shows a surface
  float position[3], normal[3], direction[3];
  uint32_t status; // olx_trace_status of its mirror ray
  float distance_metres;
  uint32_t probe, steps, probes_tried;
} view_pick;

// Constants of a session of the viewer.
typedef struct view_facts {
  char device[256];
  char scene_name[256];
  olx_field_info field;
  const olx_camera *cameras;
  uint32_t camera_count;
} view_facts;

#ifdef __cplusplus
}
#endif

#endif
