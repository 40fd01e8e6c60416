// Lists the built-in scenes by name, and builds the one that a name refers to.
#include "scene/builtin/builtin.h"

#include "core/result.h"
#include "scene/builtin/builtin_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct builtin_entry {
  const char *name;
  olx_result (*build)(olx_scene *scene);
} builtin_entry;

static const builtin_entry entries[] = {
    {"cornell", olx_build_cornell},
    {"cornell-glossy", olx_build_cornell_glossy},
    {"furnace", olx_build_furnace},
    {"two-rooms-sealed", olx_build_two_rooms_sealed},
    {"two-rooms-gap", olx_build_two_rooms_gap},
    {"parlour", olx_build_parlour},
    {"pillars", olx_build_pillars},
    {"labyrinth", olx_build_labyrinth},
    {"holodeck", olx_build_holodeck},
    {"area-light", olx_build_area_light},
    {"temple", olx_build_temple},
    {"statue", olx_build_statue},
    {"flat", olx_build_flat},
};

#define ENTRY_COUNT (sizeof entries / sizeof *entries)

const char *olx_builtin_name(uint32_t index) { return index < ENTRY_COUNT ? entries[index].name : NULL; }

// Parses a name of the form "PREFIX:METRES"; false for any other name.
static bool names_metres(const char *name, const char *prefix, float *metres) {
  const size_t length = strlen(prefix);
  if (strncmp(name, prefix, length) != 0 || name[length] != ':') return false;
  const char *number = name + length + 1;
  char *end;
  *metres = strtof(number, &end);
  if (end == number || *end) *metres = NAN;
  return true;
}

olx_result olx_builtin_build(const char *name, olx_scene *scene) {
  float metres;
  if (names_metres(name, "two-rooms-gap", &metres)) return olx_build_two_rooms_gap_of(scene, metres);
  if (names_metres(name, "two-rooms-sealed", &metres)) return olx_build_two_rooms_sealed_of(scene, metres);
  char names[512];
  size_t used = 0;
  for (size_t i = 0; i < ENTRY_COUNT; i++) {
    if (strcmp(entries[i].name, name) == 0) return entries[i].build(scene);
    used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", entries[i].name);
  }
  return olx_fail(OLX_ERROR_ARGUMENT, "no built-in scene named \"%s\"; there are %s", name, names);
}
