// Plays scripts in place of a user: parses them line by line, and pushes the events of each frame.
#include "view_script.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum script_word {
  PRESS,
  HOLD,
  LOOK,
  PICK,
  WHEEL,
  FRAMES,
  RESIZE,
  SCREENSHOT,
  LIGHT,
  DIM,
  QUIT,
  WORDS
} script_word;

enum { LINE_MAX_BYTES = 1024, MOST_WORDS = 5 };

typedef struct script_line {
  script_word word;
  int key;
  float x, y, z;
  uint32_t count;
  char *path;
} script_line;

struct view_script {
  script_line *lines;
  size_t count, next;
  uint32_t wait;
  int held; // key to release when the wait ends
};

static const char *const word_names[WORDS] = {"press",  "hold",       "look",  "pick", "wheel", "frames",
                                              "resize", "screenshot", "light", "dim",  "quit"};

static bool parse_number(const char *text, float *value) {
  char *end;
  *value = strtof(text, &end);
  return end != text && !*end && *value >= -1e6f && *value <= 1e6f;
}

static bool parse_count(const char *text, uint32_t *count) {
  float value;
  if (!parse_number(text, &value) || value < 0.0f) return false;
  *count = (uint32_t)value;
  return true;
}

static bool parse_key(const char *name, int *key) {
  *key = view_key_named(name);
  return *key != 0;
}

static bool parse_size(const char *text, script_line *line) {
  unsigned width, height;
  char rest;
  if (sscanf(text, "%5ux%5u%c", &width, &height, &rest) != 2 || width > 16384 || height > 16384) return false;
  line->x = (float)width;
  line->y = (float)height;
  return true;
}

static bool parse_light(const char *text, script_line *line) {
  if (!parse_count(text, &line->count) || line->count >= VIEW_LIGHTS_MAX) return false;
  line->key = (int)line->count;
  return true;
}

static bool parse_words(char **words, int count, script_line *line) {
  static const int wanted[WORDS] = {2, 3, 3, 3, 2, 2, 2, 2, 5, 3, 1};
  int word = 0;
  while (word < WORDS && strcmp(word_names[word], words[0]) != 0) word++;
  if (word == WORDS || count != wanted[word]) return false;
  line->word = (script_word)word;
  switch (line->word) {
  case PRESS: return parse_key(words[1], &line->key);
  case HOLD: return parse_key(words[1], &line->key) && parse_count(words[2], &line->count);
  case LOOK:
  case PICK: return parse_number(words[1], &line->x) && parse_number(words[2], &line->y);
  case WHEEL: return parse_number(words[1], &line->y);
  case FRAMES: return parse_count(words[1], &line->count);
  case RESIZE: return parse_size(words[1], line);
  case SCREENSHOT: line->path = strdup(words[1]); return line->path != NULL;
  case LIGHT:
    return parse_light(words[1], line) && parse_number(words[2], &line->x) && parse_number(words[3], &line->y) &&
           parse_number(words[4], &line->z);
  case DIM: return parse_light(words[1], line) && parse_number(words[2], &line->x) && line->x >= 0.0f;
  case QUIT: return true;
  case WORDS: return false;
  }
  return false;
}

// Splits a line into words; a comment has none.
static int split(char *text, char **words, int most) {
  int count = 0;
  text[strcspn(text, "#\r\n")] = 0;
  for (char *word = strtok(text, " \t"); word; word = strtok(NULL, " \t")) {
    if (count < most) words[count] = word;
    count++;
  }
  return count;
}

static bool read_lines(view_script *script, FILE *file, const char *path) {
  char text[LINE_MAX_BYTES];
  for (unsigned number = 1; fgets(text, sizeof text, file); number++) {
    char *words[MOST_WORDS];
    const int count = split(text, words, MOST_WORDS);
    if (count == 0) continue;
    script_line line = {.path = NULL}, *lines = realloc(script->lines, (script->count + 1) * sizeof *lines);
    if (!lines) return false;
    script->lines = lines;
    if (count > MOST_WORDS || !parse_words(words, count, &line)) {
      fprintf(stderr, "octalux view: %s:%u: '%s' is no line of a script\n", path, number, words[0]);
      return false;
    }
    lines[script->count++] = line;
  }
  return !ferror(file);
}

view_script *view_script_open(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file) {
    fprintf(stderr, "octalux view: %s: cannot be read\n", path);
    return NULL;
  }
  view_script *script = calloc(1, sizeof *script);
  const bool read = script && read_lines(script, file, path);
  fclose(file);
  if (read) return script;
  view_script_free(script);
  return NULL;
}

void view_script_free(view_script *script) {
  if (!script) return;
  for (size_t i = 0; i < script->count; i++) free(script->lines[i].path);
  free(script->lines);
  free(script);
}

static void push(view_input *input, view_event_kind kind, int key, float x, float y) {
  view_input_push(input, (view_event){.kind = kind, .key = key, .x = x, .y = y});
}

static void play(view_script *script, const script_line *line, const uint32_t size[2], view_input *input,
                 view_script_wishes *wishes) {
  switch (line->word) {
  case PRESS:
    push(input, VIEW_EVENT_PRESS, line->key, 0, 0);
    push(input, VIEW_EVENT_RELEASE, line->key, 0, 0);
    break;
  case HOLD:
    push(input, VIEW_EVENT_PRESS, line->key, 0, 0);
    script->held = line->key;
    script->wait = line->count;
    break;
  case LOOK: push(input, VIEW_EVENT_LOOK, 0, line->x, line->y); break;
  case PICK:
    push(input, VIEW_EVENT_CLICK, 0, (line->x + 0.5f) / (float)size[0], (line->y + 0.5f) / (float)size[1]);
    break;
  case WHEEL: push(input, VIEW_EVENT_WHEEL, 0, 0, line->y); break;
  case FRAMES: script->wait = line->count; break;
  case RESIZE:
    wishes->resize = true;
    wishes->size[0] = (uint32_t)line->x;
    wishes->size[1] = (uint32_t)line->y;
    break;
  case SCREENSHOT: wishes->screenshot = line->path; break;
  case LIGHT: view_input_push(input, (view_event){VIEW_EVENT_LIGHT, line->key, line->x, line->y, line->z}); break;
  case DIM: push(input, VIEW_EVENT_DIM, line->key, line->x, 0); break;
  case QUIT: wishes->quit = true; break;
  case WORDS: break;
  }
}

bool view_script_step(view_script *script, const uint32_t size[2], view_input *input, view_script_wishes *wishes) {
  *wishes = (view_script_wishes){.quit = false};
  if (script->wait > 0) script->wait--;
  while (script->wait == 0) {
    if (script->held) push(input, VIEW_EVENT_RELEASE, script->held, 0, 0);
    script->held = 0;
    // One frame has one size and yields one image.
    if (wishes->resize || wishes->screenshot || wishes->quit) return true;
    if (script->next == script->count) return false;
    play(script, &script->lines[script->next++], size, input, wishes);
  }
  return true;
}
