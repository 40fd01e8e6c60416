// A scene's light as the direct pass samples it: a list of lamps, each with the views from which its shadow maps are
// drawn.
//
// Suns, points and spots are one lamp each. Light with an extent becomes several: emissive surfaces are points on them
// with a hemisphere of shadow views each, the environment is distant lamps sampled by irradiance. Each of these lamps
// is as wide as its share of the whole, so that its highlight and the edges of its shadows have a width. Their light
// approximates what the path tracer calls direct: shadows of wide lamps consist of overlapping steps.
#ifndef OCTALUX_VIEWER_LAMP_SAMPLES_H
#define OCTALUX_VIEWER_LAMP_SAMPLES_H

#include <octalux/scene.h>

enum { LAMP_MAX = 96, LAMP_MAX_VIEWS = 256, LAMP_MAX_SAMPLES = 32 };

typedef struct lamp_settings {
  uint32_t map_size;        // width of a shadow map in texels; default 512
  uint32_t sun_tiles;       // maps of a sun along a side, 1 to 8; default 4
  uint32_t surface_samples; // points on all emissive surfaces together, 0 to 32; default 8
  uint32_t sky_samples;     // distant lamps for the environment, 0 to 32; default 12
} lamp_settings;

lamp_settings lamp_settings_default(void);

typedef enum lamp_kind { LAMP_DISTANT = 0, LAMP_POINT = 1, LAMP_SPOT = 2, LAMP_SURFACE = 3 } lamp_kind;

// A lamp, with the layout of viewer/shaders/direct_light.comp.
typedef struct lamp {
  float position[3];
  uint32_t kind;
  float direction[3]; // direction of travel of the light; for surfaces the normal
  float extent;       // radius in metres of a surface, sine of the half angle of a distant lamp, otherwise 0
  float emission
      [3]; // irradiance at normal incidence (distant), radiant intensity (point, spot), intensity along the normal
           // (surface)
  uint32_t first_view;
  float cosine_inner, cosine_outer;
  uint32_t
      tiles; // distant: tiles x tiles views, by rows; else 1. Points and surfaces have six views: +x -x +y -y +z -z
  uint32_t both_sides; // surfaces only: the other side emits as well
} lamp;

typedef struct lamp_view {
  float world_to_clip[16]; // columns; depth is 1 near and 0 far
  float texel;             // width of a shadow map's texel: in metres (distant), otherwise per metre of distance
  float unused[3];
} lamp_view;

typedef struct lamp_list {
  uint32_t lamp_count, view_count;
  uint32_t left_out; // number of the scene's lights that exceed a list's capacity
  lamp lamps[LAMP_MAX];
  lamp_view views[LAMP_MAX_VIEWS];
} lamp_list;

// Creates the list; returns false when memory runs out.
bool lamp_list_make(const olx_scene_content *content, const lamp_settings *settings, lamp_list *list);

#endif
