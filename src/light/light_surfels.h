// Surfels: the points of the scene's surfaces at which its light is gathered, one in each cell of surface, dense where
// other surfaces are near: spaced by the geometric mean distance of what each sees. Ward's harmonic mean spends most
// surfels where walls meet, though light there is as smooth as elsewhere.
#ifndef OLX_LIGHT_LIGHT_SURFELS_H
#define OLX_LIGHT_LIGHT_SURFELS_H

#include "core/parallel.h"
#include "light/surface_cells.h"
#include "scene/surface.h"

// A point of a surface that a probe or a ray met.
typedef struct olx_surface_point {
  uint64_t key; // of its finest cell
  uint32_t triangle;
  float u, v;      // barycentric weights of the second and third corner
  float footprint; // metres: how far apart the points were that met this surface; no cell need be smaller
  bool back_face;
} olx_surface_point;

olx_surface_point olx_surface_point_make(const olx_cell_grid *grid, const olx_surface *surface, const olx_ray_hit *hit,
                                         float footprint);
// The surface there, with its vertex normal to shade by.
olx_surface olx_surface_point_surface(const olx_scene *scene, const olx_surface_point *point);

typedef struct olx_light_surfel {
  uint64_t cell;
  olx_surface_point point;
  olx_vec3 position, normal; // geometric normal, on the side of the surfel
  float side;                // of its cell, metres
  float nearest;             // metres to the nearest surface among those that its exploring rays met; INFINITY for none
  uint32_t first_point, point_count; // those that it stands for, in olx_light_surfels.points
  uint32_t next;                     // another of the same cell, which this one does not see; OLX_CELL_NONE: no more
} olx_light_surfel;

typedef struct olx_light_surfels {
  const olx_scene *scene;
  olx_cell_grid grid;
  uint32_t seed; // of random numbers
  float spacing; // sides of cells as a share of the geometric mean distance
  uint32_t threads;
  olx_task *task;            // may be NULL
  olx_surface_point *points; // in olx_cell_order, batch after batch
  uint32_t point_count;
  olx_light_surfel *surfels;
  uint32_t count, capacity;
  olx_cell_table table; // cells to surfels; divided ones to the first of those in their parts, marked OLX_CELL_DIVIDED
  uint64_t rays;        // cast to explore
} olx_light_surfels;

#define OLX_CELL_DIVIDED 0x80000000u

olx_result olx_light_surfels_create(olx_light_surfels *surfels, const olx_scene *scene, float spacing, uint32_t seed,
                                    uint32_t threads);
void olx_light_surfels_free(olx_light_surfels *surfels);

// Adds surfels for points that no cell serves yet. The points are copied; their order does not matter.
olx_result olx_light_surfels_add(olx_light_surfels *surfels, const olx_surface_point *points, uint32_t count);

// Whether nothing lies between a surfel and a surface beside it.
bool olx_light_surfels_see(const olx_light_surfels *surfels, const olx_light_surfel *surfel,
                           const olx_surface *surface);

// Whether nothing lies between two surfels side by side.
bool olx_light_surfels_beside(const olx_light_surfels *surfels, const olx_light_surfel *one,
                              const olx_light_surfel *other);

// The surfel that serves a point.
typedef struct olx_surfel_found {
  uint32_t surfel; // OLX_CELL_NONE when there is none
  float side;      // of the smallest cell that holds both, metres; 0 when it is the surfel's own
} olx_surfel_found;

// The surfel whose cell holds a point with that finest key and that sees the surface there; where that part of a
// divided cell has none, the surfel that stands for the smallest cell around it, when it sees the surface and that
// cell's side is at most `most_side` metres.
olx_surfel_found olx_light_surfels_find(const olx_light_surfels *surfels, uint64_t finest_key,
                                        const olx_surface *surface, float most_side);

#endif
