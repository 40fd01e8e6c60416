// Lamps without area that hang close to surfaces, such as in their own fixtures.
//
// A lamp lights a surface by the inverse square of their distance, so that a ray which happens to end within a few
// centimetres of it brings many thousands of times the mean, and no number of rays makes the mean certain. The light
// that surfaces near a lamp reflect is therefore sampled from the lamp: rays of equal light leave it, and each that
// ends nearby leaves a point that reflects this light as a matte surface does. Rays from elsewhere that end near the
// lamp do not see its direct light, because these points already stand for it (Keller, Instant Radiosity, SIGGRAPH
// 1997, for surfaces near lamps only).
//
// The light of a point grows without bound towards the point. Close to a surface, where rays find its light easily,
// they therefore bring a part of it, and points the rest: nothing is lost (Kollig and Keller, Illumination in the
// Presence of Weak Singularities, MCQMC 2004). Both parts count by the balance heuristic there, so that rays bring
// little where the lit spot is small. Bakes and renderers find the surfaces by triangles. Relighting finds them by the
// field, and casts no such rays.
#ifndef OLX_FIELD_NEAR_LAMPS_H
#define OLX_FIELD_NEAR_LAMPS_H

#include "core/vec.h"

#include <octalux/base.h>
#include <octalux/light.h>

enum {
  OLX_LAMP_RAYS = 1024,     // the most rays of a lamp
  OLX_LEAST_LAMP_RAYS = 64, // the fewest of a lamp, even where all lamps then exceed `all_rays`
};

// What a ray from a lamp meets.
typedef struct olx_lamp_sight {
  float distance;            // metres; INFINITY: the sky
  bool known;                // the members below have a meaning
  olx_vec3 position, normal; // of the surface, on the lamp's side; position: off the surface
  olx_vec3 albedo;           // as of a matte surface
  uint64_t needs;            // bits for the caller, who gets those of all points
} olx_lamp_sight;

// Finds what `count` rays from a place meet.
typedef void (*olx_lamp_look)(const void *user, olx_vec3 from, const olx_vec3 *directions, uint32_t count,
                              olx_lamp_sight *sights);

typedef struct olx_lamp_view {
  olx_lamp_look look;
  const void *user;
  uint32_t all_rays; // of all lamps, as far as OLX_LEAST_LAMP_RAYS allows
  uint32_t rays;     // of a lamp, at most OLX_LAMP_RAYS
} olx_lamp_view;

// A point near a lamp, which reflects some of its light.
typedef struct olx_lamp_point {
  olx_vec3 position, normal; // position: off the surface
  olx_vec3 intensity;        // reflected along the normal, W/sr; elsewhere times the cosine
  float soft_squared;        // square of the distance within which rays bring a part of its light, m^2
  float density;             // with which points are drawn on the surface around it, 1/m^2
} olx_lamp_point;

typedef struct olx_near_lamps {
  float *radius; // of each light, metres: the surfaces within it have points; NULL: no light has any
  olx_lamp_point *points;
  float *sums; // distribution of the points' light
  float light; // luminance of all points' intensity, W/sr
  float reach; // metres: longer rays bring no light of any surface near a lamp
  uint32_t count;
  uint64_t needs; // of the points' sights
  uint64_t rays;  // rays cast to find the points
} olx_near_lamps;

// Finds the points of all point and spot lights. A lamp near which more than one ray in eight ends at a surface that is
// not known gets none. On failure nothing has to be freed.
olx_result olx_near_lamps_create(olx_near_lamps *lamps, const olx_light *lights, uint32_t count,
                                 const olx_lamp_view *view);
void olx_near_lamps_free(olx_near_lamps *lamps);

// The light of a point at a place.
typedef struct olx_lamp_ray {
  olx_vec3 direction, target; // unit, towards the point; the point's position
  olx_vec3 irradiance;        // W/m^2 on a surface that faces the point, divided by the point's probability
} olx_lamp_ray;

// Draws a point by a random number in [0, 1), with the share of its light that rays from the place do not bring;
// returns false when it does not shine on the place.
bool olx_near_lamps_draw(const olx_near_lamps *lamps, olx_vec3 position, float random, olx_lamp_ray *ray);
// Draws a point for a place whose rays bring none of its light. Places within sqrt(soft_squared) of the point get no
// more than they would get at that distance.
bool olx_near_lamps_draw_soft(const olx_near_lamps *lamps, olx_vec3 position, float random, olx_lamp_ray *ray);

// Returns what a ray finds of the light of lamp `number` on a surface, as radiance without shadows: what the surface
// reflects as a matte one, times the share that the points of olx_near_lamps_draw leave to rays. The distance of `end`
// is the ray's length, and `direction` is unit.
olx_vec3 olx_near_lamps_found(const olx_near_lamps *lamps, const olx_light *light, uint32_t number,
                              const olx_lamp_sight *end, olx_vec3 direction);

// Draws one of the points, of which there must be some, by a random number in [0, 1).
const olx_lamp_point *olx_near_lamps_pick(const olx_near_lamps *lamps, float random, float *probability);

#endif
