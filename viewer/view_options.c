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

bool view_options_read(int argc, char **argv, view_options *o, int *exit_code) {
  *o = (view_options){.size = {1280, 720}, .state = default_state()};
  view_state *s = &o->state;
  uint32_t scale_percent = 100, emitters = 0;
  bool json = false;
  sample_options sample = SAMPLE_OPTIONS_DEFAULT;
  const option options[] = {
      {"--field", OPTION_TEXT, &o->field, "FILE.olx", "the field that gives indirect light", 1, 0},
      {"--size", OPTION_SIZE, o->size, "1280x720", "pixels; default 1280x720", 1, OLX_PICTURE_SIZE_MOST},
      {"--camera", OPTION_TEXT, &o->camera, "NAME", "a camera of the scene to begin with; default: the first", 0, 0},
      {"--exposure", OPTION_REAL, &s->exposure, "X",
       "multiply light before the tone map; default: follows the picture in a window, else 1", 0, 0},
      {"--auto-exposure", OPTION_FLAG, &s->auto_exposure, NULL, "let the exposure follow the picture", 0, 0},
      {"--scale", OPTION_COUNT, &scale_percent, "PERCENT", "pixels lit along a side, of those shown; default 100", 12,
       100},
      {"--relight", OPTION_FLAG, &o->relight, NULL,
       "let indirect light follow lights that move; a field of bake --relight", 0, 0},
      {"--object", OPTION_TEXT, &o->object, "X,Y,Z", "put a ball there, in metres", 0, 0},
      GROUP_ROW("Quality"),
      {"--mode", OPTION_CHOICE, &s->mode, VIEW_MODE_WORDS,
       "irradiance and glossy rays; one ray a lobe, denoised; rays as they are; eye rays through the field alone", 0,
       0},
      {"--denoise", OPTION_CHOICE, &s->denoise, VIEW_DENOISE_WORDS, "how frames are filtered; default adaptive", 0, 0},
      {"--gather-samples", OPTION_COUNT, &s->gather_samples, "N",
       "gather: rays a lobe, pixel and frame; frames add up; default 4", 1, 4096},
      GROUP_ROW("Pictures and scripts"),
      {"--frames", OPTION_COUNT, &o->frames, "N", "leave after N frames", 1, 100000000},
      {"--screenshot", OPTION_TEXT, &o->screenshot, "FILE.png", "write the last frame; without --frames, the first", 0,
       0},
      {"--script", OPTION_TEXT, &o->script, "FILE", "play keys, mouse and window from a file, then leave", 0, 0},
      {"--offscreen", OPTION_FLAG, &o->offscreen, NULL, "open no window", 0, 0},
      {"--panel", OPTION_FLAG, &o->panel, NULL, "keep the panel in screenshots", 0, 0},
      GROUP_ROW("Models"),
      SCENE_OPTION_ROWS(o->loading),
      RESEARCH_ROW,
      {"--overlay", OPTION_CHOICE, &s->overlay, VIEW_OVERLAY_WORDS, "what is painted over the picture; default none", 0,
       0},
      {"--pick", OPTION_TEXT, &o->pick, "X,Y", "ask the ray of this pixel, as a click does", 0, 0},
      {"--emitters", OPTION_CHOICE, &emitters, "sampled|traced",
       "lamps with an area: sampled by direct light, or found by rays; default sampled", 0, 0},
      SAMPLE_OPTION_ROWS(sample),
      {"--no-wait", OPTION_FLAG, &o->no_wait, NULL, "do not wait for the display between frames", 0, 0},
      {"--validate", OPTION_FLAG, &o->validate, NULL, "check every call with the validation layers", 0, 0},
      {"--json", OPTION_FLAG, &json, NULL, "refused: a viewer shows pictures, and has no numbers to print", 0, 0},
  };
  command_line line = {.name = "view",
                       .summary = "Fly through a scene that a field lights, on Vulkan.",
                       .example = "octalux view room.gltf --field room.olx",
                       .arguments = {"SCENE"},
                       .options = options,
                       .option_count = sizeof options / sizeof options[0]};
  if (!parse_options(&line, argc, argv, exit_code)) return false;
  if (json) {
    *exit_code =
        usage_error("view", "--json: a viewer shows pictures, and has no numbers to print; --screenshot writes a "
                            "picture, `octalux-bench-gpu --json` measures");
    return false;
  }
  o->scene = line.given[0];
  s->scale = (float)scale_percent / 100.0f;
  s->emitters = emitters == 1;
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
