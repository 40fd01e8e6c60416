// Parses the command line of octalux view into the viewer's initial state.
#include "view_options.h"
#include "options.h"
#include "sample_options.h"

#include <octalux/limits.h>

#include <stdio.h>
#include <string.h>

void view_word(const char *words, uint32_t index, char *word, size_t size) {
  for (; index > 0 && *words; index--) {
    words += strcspn(words, "|");
    if (*words) words++;
  }
  snprintf(word, size, "%.*s", (int)strcspn(words, "|"), words);
}

static view_state default_state(void) {
  return (view_state){.tracer = OLX_TRACER_HIZ,
                      .select = OLX_SELECT_BEST,
                      .visibility = true,
                      .direct = true,
                      .diffuse = true,
                      .glossy = true,
                      .denoise = 2,
                      .ray_spacing = 1,
                      .gather_samples = 4,
                      .scale = 1.0f,
                      .probe = VIEW_ANSWERING,
                      .light = VIEW_NO_LIGHT,
                      .object_roughness = 0.1f,
                      .object_metallic = 1.0f,
                      .panel = true};
}

// Parses numbers separated by commas, and nothing else.
static bool parse_numbers(const char *text, int count, float *numbers) {
  char rest;
  if (count == 2) return sscanf(text, "%f,%f%c", &numbers[0], &numbers[1], &rest) == 2;
  return sscanf(text, "%f,%f,%f%c", &numbers[0], &numbers[1], &numbers[2], &rest) == 3;
}

static bool check(view_options *o) {
  view_state *s = &o->state;
  if (o->json) {
    usage_error("view", "--json: a viewer shows pictures, and has no numbers to print; --screenshot writes a picture, "
                        "`octalux-bench-gpu --json` measures");
    return false;
  }
  if (o->pick) {
    float *p = o->pick_pixel;
    if (!parse_numbers(o->pick, 2, p) ||
        !(p[0] >= 0 && p[0] < (float)o->size[0] && p[1] >= 0 && p[1] < (float)o->size[1])) {
      usage_error("view", "--pick: '%s' is not a pixel X,Y of the picture", o->pick);
      return false;
    }
    s->picked = true;
    s->pick[0] = (p[0] + 0.5f) / (float)o->size[0];
    s->pick[1] = (p[1] + 0.5f) / (float)o->size[1];
  }
  if (o->object && !parse_numbers(o->object, 3, &s->object_position.x)) {
    usage_error("view", "--object: '%s' is not a place X,Y,Z", o->object);
    return false;
  }
  s->object = o->object != NULL;
  if (o->screenshot && !ends_with(o->screenshot, ".png")) {
    usage_error("view", "--screenshot: %s does not end in .png", o->screenshot);
    return false;
  }
  if (s->emitters && s->mode == VIEW_PREFILTERED) {
    usage_error("view", "--emitters traced needs traced diffuse light: --mode gather or denoised");
    return false;
  }
  if (o->offscreen && !o->frames && !o->script && !o->screenshot) {
    usage_error("view", "--offscreen needs --frames, --script or --screenshot");
    return false;
  }
  return true;
}

static const option view_basic_options[] = {
    {"--field", OPTION_TEXT, offsetof(view_options, field), "FILE.olx", "the field that gives indirect light", 1},
    {"--size", OPTION_SIZE, offsetof(view_options, size), "1280x720", "pixels; default 1280x720", 1,
     OLX_PICTURE_SIZE_MOST},
    {"--camera", OPTION_TEXT, offsetof(view_options, camera), "NAME",
     "a camera of the scene to begin with; default: the first"},
    {"--exposure", OPTION_REAL, offsetof(view_options, state.exposure), "X",
     "multiply light before the tone map; default: follows the picture in a window, else 1"},
    {"--auto-exposure", OPTION_FLAG, offsetof(view_options, state.auto_exposure), NULL,
     "let the exposure follow the picture"},
    {"--scale", OPTION_COUNT, offsetof(view_options, scale_percent), "PERCENT",
     "pixels lit along a side, of those shown; default 100", 12, 100},
    {"--relight", OPTION_FLAG, offsetof(view_options, relight), NULL,
     "let indirect light follow lights that move; a field of bake --relight"},
    {"--object", OPTION_TEXT, offsetof(view_options, object), "X,Y,Z", "put a ball there, in metres"},
    {0}};

static const option view_quality_options[] = {
    {"--mode", OPTION_CHOICE, offsetof(view_options, state.mode), VIEW_MODE_WORDS,
     "irradiance and glossy rays; one ray a lobe, denoised; rays as they are; eye rays through the field alone"},
    {"--denoise", OPTION_CHOICE, offsetof(view_options, state.denoise), VIEW_DENOISE_WORDS,
     "how frames are filtered; default adaptive"},
    {"--ray-spacing", OPTION_COUNT, offsetof(view_options, state.ray_spacing), "1|2",
     "2 traces one pixel of each 2x2 a frame, in turn: a quarter of the rays; default 1", 1, 2},
    {"--gather-samples", OPTION_COUNT, offsetof(view_options, state.gather_samples), "N",
     "gather: rays a lobe, pixel and frame; frames add up; default 4", 1, 4096},
    {0}};

static const option view_picture_options[] = {
    {"--frames", OPTION_COUNT, offsetof(view_options, frames), "N", "leave after N frames", 1, 100000000},
    {"--screenshot", OPTION_TEXT, offsetof(view_options, screenshot), "FILE.png",
     "write the last frame; without --frames and --script, the first"},
    {"--script", OPTION_TEXT, offsetof(view_options, script), "FILE",
     "play keys, mouse and window from a file, then leave"},
    {"--offscreen", OPTION_FLAG, offsetof(view_options, offscreen), NULL, "open no window"},
    {"--panel", OPTION_FLAG, offsetof(view_options, panel), NULL, "keep the panel in screenshots"},
    {0}};

static const option view_research_options[] = {
    {"--overlay", OPTION_CHOICE, offsetof(view_options, state.overlay), VIEW_OVERLAY_WORDS,
     "what is painted over the picture; default none"},
    {"--pick", OPTION_TEXT, offsetof(view_options, pick), "X,Y", "ask the ray of this pixel, as a click does"},
    {"--emitters", OPTION_CHOICE, offsetof(view_options, emitters), "sampled|traced",
     "lamps with an area: sampled by direct light, or found by rays; default sampled"},
    {0}};

static const option view_last_options[] = {
    {"--no-wait", OPTION_FLAG, offsetof(view_options, no_wait), NULL, "do not wait for the display between frames"},
    {"--validate", OPTION_FLAG, offsetof(view_options, validate), NULL, "check every call with the validation layers"},
    {"--json", OPTION_FLAG, offsetof(view_options, json), NULL,
     "refused: a viewer shows pictures, and has no numbers to print"},
    {0},
};

bool view_options_read(int argc, char **argv, view_options *o, int *exit_code) {
  *o = (view_options){.size = {1280, 720}, .scale_percent = 100, .state = default_state()};
  view_state *s = &o->state;
  olx_sample_settings sample = olx_sample_settings_default();
  command_line line = {.name = "view",
                       .summary = "Fly through a scene that a field lights, on Vulkan.",
                       .example = "octalux view room.gltf --field room.olx",
                       .arguments = {"SCENE"},
                       .tables = {{view_basic_options, o},
                                  {view_quality_options, o, "Quality"},
                                  {view_picture_options, o, "Pictures and scripts"},
                                  {scene_loading_options, &o->loading, "Models"},
                                  {view_research_options, o, RESEARCH},
                                  {sample_options, &sample},
                                  {view_last_options, o}}};
  if (!parse_options(&line, argc, argv, exit_code)) return false;
  o->scene = line.given[0];
  s->scale = (float)o->scale_percent / 100.0f;
  s->emitters = o->emitters == 1;
  // Offscreen and scripted images must not depend on earlier frames, unless the options request it.
  s->auto_exposure |= s->exposure <= 0.0f && !o->offscreen && !o->script && !o->screenshot;
  if (s->exposure <= 0.0f) s->exposure = 1.0f;
  s->tracer = sample.tracer;
  s->select = sample.select;
  s->hits = sample.hits;
  s->visibility = sample.visibility == OLX_VISIBILITY_CHEBYSHEV;
  s->keep_buried = sample.keep_buried;
  if (o->screenshot && !o->frames && !o->script) o->frames = 1;
  if (check(o)) return true;
  *exit_code = EXIT_USAGE;
  return false;
}
