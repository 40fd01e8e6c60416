// Surfels: the surface points at which the scene's light is gathered, one per cell of surface. Their spacing is
// proportional to the geometric mean distance to what each sees, so that they are dense near other surfaces. Ward's
// harmonic mean would put most surfels where walls meet, although light is as smooth there as elsewhere.
#ifndef OLX_LIGHT_LIGHT_SURFELS_H
#define OLX_LIGHT_LIGHT_SURFELS_H

#include "core/parallel.h"
#include "light/surfels/lamp_light.h"
#include "light/surfels/surface_cells.h"
#include "scene/surface.h"

// A point of a surface that a ray of a probe or a surfel hit.
typedef struct olx_surfel_point {
  uint64_t key; // key of its finest cell
  uint32_t triangle;
  float u, v;      // barycentric weights of the second and third corner
  float footprint; // metres: spacing of the points that hit this surface; no cell needs to be smaller
  bool back_face;
} olx_surfel_point;

olx_surfel_point olx_surfel_point_make(const olx_cell_grid *grid, const olx_surface *surface, const olx_ray_hit *hit,
                                       float footprint);
// Returns the relative area that a point of a cell represents: points were sampled by rays that spread out.
static inline float olx_surfel_point_area(const olx_surfel_point *point) { return point->footprint * point->footprint; }
// Returns the surface at a point, with its vertex normal for shading.
olx_surface olx_surfel_point_surface(const olx_scene *scene, const olx_surfel_point *point);

typedef struct olx_light_surfel {
  uint64_t cell;
  olx_surfel_point point;
  olx_vec3 position, normal;         // position, and geometric normal on the surfel's side
  float side;                        // side of its cell, metres
  float nearest;                     // metres to the nearest surface that its exploring rays hit; INFINITY for none
  uint32_t first_point, point_count; // range of its points in olx_light_surfels.points
  uint32_t next;                     // the next surfel of the same cell, which this one does not see; OLX_CELL_NONE:
                                     // none
} olx_light_surfel;

typedef struct olx_light_surfels {
  const olx_scene *scene;
  olx_cell_grid grid;
  uint32_t seed; // seed of random numbers
  float spacing; // side of a cell as a share of the geometric mean distance
  uint32_t threads;
  olx_task *task;           // may be NULL
  olx_surfel_point *points; // in olx_cell_order, batch after batch
  uint32_t point_count;
  olx_light_surfel *surfels;
  uint32_t count, capacity;
  uint8_t *marks;       // of each surfel: OLX_SURFEL_UNEVEN, OLX_SURFEL_SEES_SKY; NULL: not known yet
  olx_cell_table table; // from cells to surfels; from divided cells to the first surfel in their parts, marked
                        // OLX_CELL_DIVIDED
  uint64_t rays;        // rays cast to explore distances
  olx_near_lamps lamps; // surfaces near lamps
} olx_light_surfels;

#define OLX_CELL_DIVIDED 0x80000000u

// What direct light says of a surfel's cell and cells near it: the sun reaches them in part, or much of the sky does.
enum { OLX_SURFEL_UNEVEN = 1, OLX_SURFEL_SEES_SKY = 2 };

static inline uint8_t olx_surfel_marks(const olx_light_surfels *surfels, uint32_t surfel) {
  return surfels->marks ? surfels->marks[surfel] : 0;
}

static inline bool olx_surfel_is_uneven(const olx_light_surfels *surfels, uint32_t surfel) {
  return olx_surfel_marks(surfels, surfel) & OLX_SURFEL_UNEVEN;
}

static inline bool olx_surfel_sees_sky(const olx_light_surfels *surfels, uint32_t surfel) {
  return olx_surfel_marks(surfels, surfel) & OLX_SURFEL_SEES_SKY;
}

olx_result olx_light_surfels_create(olx_light_surfels *surfels, const olx_scene *scene, float spacing, uint32_t seed,
                                    uint32_t threads);
void olx_light_surfels_free(olx_light_surfels *surfels);

// Adds surfels for points that no cell covers yet. The points are copied; their order does not matter.
olx_result olx_light_surfels_add(olx_light_surfels *surfels, const olx_surfel_point *points, uint32_t count);

enum { OLX_CELL_PARTS = 8 };

// Divides the cell of `whole`, which is that of surfel number `surfel` or a part of it. parts[0] receives `whole` with
// the part of the cell in which it lies, and the next elements a place in each other part that has points, near the
// part's middle. Returns the number of parts; 0 where points are too few or too far apart to divide the cell.
uint32_t olx_light_surfels_part(const olx_light_surfels *surfels, uint32_t surfel, const olx_light_surfel *whole,
                                olx_light_surfel parts[OLX_CELL_PARTS]);

// Returns whether nothing occludes a nearby surface from a surfel.
bool olx_light_surfels_see(const olx_light_surfels *surfels, const olx_light_surfel *surfel,
                           const olx_surface *surface);

// Returns the key of the smallest cell of a table that holds a point with the given finest key; 0 when there is none.
uint64_t olx_light_surfels_cell(const olx_cell_table *table, uint64_t finest_key);

// The surfel that covers a point.
typedef struct olx_surfel_found {
  uint32_t surfel; // OLX_CELL_NONE when there is none
  float side;      // side of the smallest cell that holds both, metres; 0 when it is the surfel's own cell
} olx_surfel_found;

// Finds the surfel whose cell holds a point with the given finest key and that sees the surface there. Where that part
// of a divided cell has none, finds the surfel of the smallest cell around it, provided that it sees the surface and
// that the cell's side is at most `most_side` metres.
olx_surfel_found olx_light_surfels_find(const olx_light_surfels *surfels, uint64_t finest_key,
                                        const olx_surface *surface, float most_side);

#endif
