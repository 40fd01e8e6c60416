// A scene's light as the direct pass samples it: a list of lamps, each with the views from which its shadows are drawn.
//
// Suns, points and spots are one lamp each. Light with an extent becomes several: emissive surfaces are points on them
// with a hemisphere of shadow views each, the environment is distant lamps drawn by its radiance. Every such lamp is as
// broad as its share of the whole, so that its highlight and its shadows' edges have a width. The light that they cast
// is what the path tracer calls direct, approximately: shadows of wide lamps are made of overlapping steps.
#ifndef OCTALUX_VIEWER_LAMP_SAMPLES_H
#define OCTALUX_VIEWER_LAMP_SAMPLES_H

#include <octalux/scene.h>

enum { LAMP_MAX = 96, LAMP_MAX_VIEWS = 256, LAMP_MAX_SAMPLES = 32, LAMP_MAX_TILES = 8 };

typedef struct lamp_settings {
  uint32_t map_size;        // width of a shadow map in texels; default 512
  uint32_t sun_tiles;       // maps of a sun along a side, 1 to 8; default 4
  uint32_t surface_samples; // points on all emissive surfaces together, 0 to 32; default 8
  uint32_t sky_samples;     // distant lamps for the environment, 0 to 32; default 12
} lamp_settings;

lamp_settings lamp_settings_default(void);

typedef enum lamp_kind { LAMP_DISTANT = 0, LAMP_POINT = 1, LAMP_SPOT = 2, LAMP_SURFACE = 3 } lamp_kind;

// A lamp, laid out as shaders/direct_light.comp declares it.
typedef struct lamp {
  float position[3];
  uint32_t kind;
  float direction[3]; // of travel; of a surface: its normal
  float extent;       // radius in metres of a surface, sine of the half angle of a distant lamp, else 0
  float emission
      [3]; // irradiance facing it (distant), radiant intensity (point, spot), intensity along the normal (surface)
  uint32_t first_view;
  float cosine_inner, cosine_outer;
  uint32_t
      tiles; // distant: tiles x tiles views, by rows; else 1. Points and surfaces have six views: +x -x +y -y +z -z
  uint32_t both_sides; // of a surface: the other side shines as well
} lamp;

typedef struct lamp_view {
  float world_to_clip[16]; // columns; depth is 1 near and 0 far
  float texel;             // width of a texel of the map: in metres (distant), else for each metre of distance
  float unused[3];
} lamp_view;

typedef struct lamp_list {
  uint32_t lamp_count, view_count;
  uint32_t left_out; // lights of the scene beyond what a list can hold
  lamp lamps[LAMP_MAX];
  lamp_view views[LAMP_MAX_VIEWS];
} lamp_list;

// False: out of memory.
bool lamp_list_make(const olx_scene_content *content, const lamp_settings *settings, lamp_list *list);

#endif
