// Finds which probes are neighbours by a Delaunay triangulation of their positions (Qhull), with special cases for
// coincident positions and for sets that lie in one plane.
#include "bake/selectors/delaunay.h"

#include "core/hooks.h"
#include "core/result.h"

#include <libqhull_r/qhull_ra.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  LATTICE = 1 << 20,         // lattice points along the longest side of the bounds
  MAX_ALL_NEIGHBOURS = 4096, // most probes that may all be neighbours of each other
  EDGES = 12                 // directed edges of a tetrahedron
};
// Height over a plane, as a share of the longest side, below which sites count as lying in it: rounding to the lattice
// may tilt planes slightly.
static const double FLAT = 1e-4;
// Tetrahedra are also flat below this value of six times the volume over the cube of the longest edge.
static const double SLIVER = 1e-4;

// The position of one probe, or of several that coincide.
typedef struct site {
  int32_t place[3]; // lattice coordinates
  uint32_t probe;
} site;

typedef struct delaunay {
  uint32_t probe_count, place_count;
  site *sites;         // one per probe, ordered by place
  uint32_t *place_of;  // index of each probe's place
  uint32_t *begin;     // place_count + 1: where each place begins in `sites`
  double (*points)[3]; // coordinates of the places
  uint64_t *edges;     // edges between places: from << 32 | to, in both directions, in ascending order
  size_t *edge_begin;  // place_count + 1: where the edges of each place begin
  size_t edge_count;
} delaunay;

static int compare_sites(const void *left, const void *right) {
  const site *a = left, *b = right;
  for (int i = 0; i < 3; i++) {
    if (a->place[i] != b->place[i]) return a->place[i] < b->place[i] ? -1 : 1;
  }
  return a->probe < b->probe ? -1 : a->probe > b->probe;
}

static int compare_edges(const void *left, const void *right) {
  const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
  return a < b ? -1 : a > b;
}

static int32_t on_lattice(float x, float low, double extent) {
  return extent > 0.0 ? (int32_t)lround(((double)x - (double)low) / extent * LATTICE) : 0;
}

// Rounds positions to places, sorts them, and merges equal ones.
static void find_places(delaunay *d, const olx_vec3 *positions) {
  const uint32_t count = d->probe_count;
  olx_vec3 low = positions[0], high = positions[0];
  for (uint32_t i = 1; i < count; i++) {
    low = olx_min_each(low, positions[i]);
    high = olx_max_each(high, positions[i]);
  }
  const double extent =
      fmax((double)high.x - (double)low.x, fmax((double)high.y - (double)low.y, (double)high.z - (double)low.z));
  for (uint32_t i = 0; i < count; i++) {
    d->sites[i] = (site){.place = {on_lattice(positions[i].x, low.x, extent), on_lattice(positions[i].y, low.y, extent),
                                   on_lattice(positions[i].z, low.z, extent)},
                         .probe = i};
  }
  qsort(d->sites, count, sizeof *d->sites, compare_sites);
  for (uint32_t i = 0; i < count; i++) {
    if (i == 0 || memcmp(d->sites[i].place, d->sites[i - 1].place, sizeof d->sites[i].place) != 0) {
      for (int axis = 0; axis < 3; axis++) d->points[d->place_count][axis] = d->sites[i].place[axis] / (double)LATTICE;
      d->begin[d->place_count++] = i;
    }
    d->place_of[d->sites[i].probe] = d->place_count - 1;
  }
  d->begin[d->place_count] = count;
}

static void subtract(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

// Returns whether all sites lie in one plane: takes the site farthest from the first, then the one farthest from the
// line through both, then the one farthest from the plane of the three. The set is flat when any of these distances is
// small.
static bool all_in_one_plane(const delaunay *d) {
  double edge[3] = {0}, normal[3] = {0}, farthest = 0.0;
  for (uint32_t i = 1; i < d->place_count; i++) {
    double offset[3];
    subtract(d->points[i], d->points[0], offset);
    if (dot(offset, offset) > farthest) {
      farthest = dot(offset, offset);
      memcpy(edge, offset, sizeof edge);
    }
  }
  double widest = 0.0, highest = 0.0;
  for (uint32_t i = 1; i < d->place_count; i++) {
    double offset[3], across[3];
    subtract(d->points[i], d->points[0], offset);
    cross(edge, offset, across);
    if (dot(across, across) > widest) {
      widest = dot(across, across);
      memcpy(normal, across, sizeof normal);
    }
  }
  if (widest <= FLAT * FLAT * farthest) return true;
  for (uint32_t i = 1; i < d->place_count; i++) {
    double offset[3];
    subtract(d->points[i], d->points[0], offset);
    highest = fmax(highest, fabs(dot(offset, normal)) / sqrt(widest));
  }
  return highest <= FLAT;
}

// Returns whether four places lie in a plane up to the joggle and the lattice. On the hull of a grid, such tetrahedra
// connect places that have others between them.
static bool is_sliver(const delaunay *d, const uint32_t corners[4]) {
  double sides[3][3], normal[3], longest = 0.0;
  for (int i = 0; i < 3; i++) {
    subtract(d->points[corners[i + 1]], d->points[corners[0]], sides[i]);
    longest = fmax(longest, dot(sides[i], sides[i]));
  }
  cross(sides[0], sides[1], normal);
  return fabs(dot(normal, sides[2])) <= SLIVER * longest * sqrt(longest);
}

// Collects the edges of all tetrahedra except slivers, in both directions, each once.
static olx_result find_edges(delaunay *d, qhT *qh) {
  facetT *facet;
  size_t tetrahedra = 0, count = 0;
  FORALLfacets {
    if (!facet->upperdelaunay) tetrahedra++;
  }
  d->edges = olx_allocate(tetrahedra, EDGES * sizeof *d->edges);
  if (!d->edges) return OLX_ERROR_MEMORY;
  FORALLfacets {
    if (facet->upperdelaunay) continue;
    vertexT *vertex, **vertexp;
    uint32_t corners[4] = {0}, known = 0;
    FOREACHvertex_(facet->vertices) {
      if (known < 4) corners[known++] = (uint32_t)qh_pointid(qh, vertex->point);
    }
    if (known < 4 || is_sliver(d, corners)) continue;
    for (uint32_t i = 0; i < known; i++) {
      for (uint32_t k = 0; k < known; k++) {
        if (i != k) d->edges[count++] = (uint64_t)corners[i] << 32 | corners[k];
      }
    }
  }
  qsort(d->edges, count, sizeof *d->edges, compare_edges);
  for (size_t i = 0; i < count; i++) {
    if (i == 0 || d->edges[i] != d->edges[i - 1]) d->edges[d->edge_count++] = d->edges[i];
  }
  return OLX_OK;
}

static void index_edges(delaunay *d) {
  size_t e = 0;
  for (uint32_t place = 0; place <= d->place_count; place++) {
    while (e < d->edge_count && d->edges[e] >> 32 < place) e++;
    d->edge_begin[place] = e;
  }
}

// Runs Qhull, with its input joggled by random numbers of a fixed seed (QJ, QR-n) and its output and warnings
// suppressed.
static olx_result triangulate(delaunay *d) {
  char *message = NULL, command[] = "qhull d QJ QR-12345 Pp";
  size_t message_bytes = 0;
  FILE *messages = open_memstream(&message, &message_bytes);
  if (!messages) return OLX_ERROR_MEMORY;
  qhT qhull;
  qh_zero(&qhull, messages);
  olx_result result = OLX_OK;
  const int code = qh_new_qhull(&qhull, 3, (int)d->place_count, d->points[0], False, command, NULL, messages);
  if (code == 0) result = find_edges(d, &qhull);
  int kept = 0, blocks = 0;
  qh_freeqhull(&qhull, !qh_ALL);
  qh_memfreeshort(&qhull, &kept, &blocks);
  fclose(messages);
  if (code != 0) {
    result = olx_fail(OLX_ERROR_ARGUMENT, "bake: Qhull cannot triangulate %u probes: %.200s", d->probe_count, message);
  }
  free(message);
  return result;
}

// Makes every place a neighbour of every other.
static olx_result connect_all(delaunay *d) {
  const uint32_t count = d->place_count;
  if (d->probe_count > MAX_ALL_NEIGHBOURS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: %u probes in one plane are too many for the selector 'voronoi' (%d)",
                    d->probe_count, MAX_ALL_NEIGHBOURS);
  }
  d->edges = olx_allocate((size_t)count * count, sizeof *d->edges);
  if (!d->edges) return OLX_ERROR_MEMORY;
  for (uint32_t i = 0; i < count; i++) {
    for (uint32_t k = 0; k < count; k++) {
      if (i != k) d->edges[d->edge_count++] = (uint64_t)i << 32 | k;
    }
  }
  return OLX_OK;
}

static int compare_probes(const void *left, const void *right) {
  const uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
  return a < b ? -1 : a > b;
}

// Appends the other probes of a place to `list` unless that is NULL. Returns their number.
static size_t list_place(const delaunay *d, uint32_t place, uint32_t probe, uint32_t *list) {
  size_t count = 0;
  for (uint32_t i = d->begin[place]; i < d->begin[place + 1]; i++) {
    if (d->sites[i].probe == probe) continue;
    if (list) list[count] = d->sites[i].probe;
    count++;
  }
  return count;
}

// Lists the neighbours of a probe: those at its own place and at neighbouring ones. Returns their number.
static size_t list_neighbours(const delaunay *d, uint32_t probe, uint32_t *list) {
  const uint32_t place = d->place_of[probe];
  size_t count = list_place(d, place, probe, list);
  for (size_t e = d->edge_begin[place]; e < d->edge_begin[place + 1]; e++) {
    count += list_place(d, (uint32_t)d->edges[e], probe, list ? list + count : NULL);
  }
  return count;
}

static olx_result list_all(const delaunay *d, olx_neighbours *neighbours) {
  size_t total = 0;
  neighbours->first = olx_allocate((size_t)d->probe_count + 1, sizeof *neighbours->first);
  if (!neighbours->first) return OLX_ERROR_MEMORY;
  for (uint32_t i = 0; i < d->probe_count; i++) {
    neighbours->first[i] = total;
    total += list_neighbours(d, i, NULL);
  }
  neighbours->first[d->probe_count] = total;
  neighbours->neighbour = olx_allocate(total, sizeof *neighbours->neighbour);
  if (!neighbours->neighbour) return OLX_ERROR_MEMORY;
  for (uint32_t i = 0; i < d->probe_count; i++) {
    uint32_t *list = neighbours->neighbour + neighbours->first[i];
    qsort(list, list_neighbours(d, i, list), sizeof *list, compare_probes);
  }
  return OLX_OK;
}

static olx_result find_neighbours(delaunay *d, const olx_vec3 *positions, olx_neighbours *neighbours) {
  const uint32_t count = d->probe_count;
  d->sites = olx_allocate(count, sizeof *d->sites);
  d->place_of = olx_allocate(count, sizeof *d->place_of);
  d->begin = olx_allocate((size_t)count + 1, sizeof *d->begin);
  d->points = olx_allocate(count, sizeof *d->points);
  d->edge_begin = olx_allocate((size_t)count + 1, sizeof *d->edge_begin);
  if (!d->sites || !d->place_of || !d->begin || !d->points || !d->edge_begin) return OLX_ERROR_MEMORY;
  find_places(d, positions);
  OLX_TRY(d->place_count < 5 || all_in_one_plane(d) ? connect_all(d) : triangulate(d));
  index_edges(d);
  return list_all(d, neighbours);
}

olx_result olx_neighbours_create(const olx_vec3 *positions, uint32_t count, olx_neighbours *neighbours) {
  *neighbours = (olx_neighbours){0};
  delaunay d = {.probe_count = count};
  olx_result result = find_neighbours(&d, positions, neighbours);
  olx_release(d.sites);
  olx_release(d.place_of);
  olx_release(d.begin);
  olx_release(d.points);
  olx_release(d.edges);
  olx_release(d.edge_begin);
  if (result == OLX_OK) return OLX_OK;
  olx_neighbours_free(neighbours);
  if (result == OLX_ERROR_MEMORY) return olx_fail(result, "bake: out of memory for the neighbours of %u probes", count);
  return result;
}

void olx_neighbours_free(olx_neighbours *neighbours) {
  olx_release(neighbours->first);
  olx_release(neighbours->neighbour);
  *neighbours = (olx_neighbours){0};
}
