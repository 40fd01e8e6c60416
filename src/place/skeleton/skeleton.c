// Places probes on the skeleton of free space, found by the distance transform or by medial balls (Wang 2018, section
// 3.1) and clustered to the requested number of probes.
#include "place/skeleton/skeleton.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"

// A voxel is not on the skeleton when the distance grows by more than this per voxel towards a neighbour.
#define FAR_GROWTH 0.5
#define FAR_LEAST 2.0 // voxels
#define MOST_ITEMS 16384u
#define PLACES_A_LOOK 4096u // positions between checks for cancellation

static bool is_far(const olx_voxels *v, size_t voxel, double least) {
  uint32_t c[3];
  const double own = sqrt((double)v->distance[voxel]);
  if (own < least) return false;
  olx_voxel_coordinates(v, voxel, c);
  for (int32_t i = 0; i < 27; i++) {
    const int64_t step[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    bool within = true;
    for (int axis = 0; axis < 3; axis++) {
      within = within && c[axis] + step[axis] >= 0 && c[axis] + step[axis] < v->count[axis];
    }
    if (!within) continue;
    const int64_t other = (int64_t)voxel + step[0] + (int64_t)v->count[0] * (step[1] + (int64_t)v->count[1] * step[2]);
    const double length = sqrt((double)(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]));
    if (sqrt((double)v->distance[other]) - own > FAR_GROWTH * length) return false;
  }
  return true;
}

static double least_distance(const olx_space *space) {
  double largest = 0.0;
  for (size_t i = 0; i < space->place_count; i++) {
    const double distance = sqrt((double)space->voxels.distance[space->places[i]]);
    if (distance > largest) largest = distance;
  }
  return 0.5 * largest < FAR_LEAST ? 0.5 * largest : FAR_LEAST;
}

static float diagonal(const olx_space *space) {
  return olx_length(olx_sub(space->scene->bounds_max, space->scene->bounds_min));
}

static void set_position(olx_cluster_item *item, olx_vec3 place, float scale) {
  item->place = place;
  item->features[0] = place.x * scale;
  item->features[1] = place.y * scale;
  item->features[2] = place.z * scale;
}

olx_result olx_far_voxels(const olx_space *space, olx_cluster_item **items, uint32_t *count) {
  const double least = least_distance(space);
  size_t found = 0, nth = 0;
  uint32_t used = 0;
  for (size_t i = 0; i < space->place_count; i++) {
    if (i % PLACES_A_LOOK == 0) OLX_TRY(olx_check_cancelled());
    found += is_far(&space->voxels, space->places[i], least);
  }
  const size_t most = found < MOST_ITEMS ? found : MOST_ITEMS;
  *count = 0;
  *items = olx_allocate_zero(most, sizeof **items);
  if (!*items) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %zu voxels", most);
  const float scale = 1.0f / diagonal(space);
  olx_result result = OLX_OK;
  for (size_t i = 0; i < space->place_count && used < most && result == OLX_OK; i++) {
    if (i % PLACES_A_LOOK == 0) result = olx_check_cancelled();
    if (!is_far(&space->voxels, space->places[i], least)) continue;
    // Evenly thinned where there are too many.
    if (nth++ * most < used * found) continue;
    set_position(&(*items)[used++], olx_voxel_centre(&space->voxels, space->places[i]), scale);
  }
  *count = used;
  if (result != OLX_OK) {
    olx_release(*items);
    *items = NULL;
  }
  return result;
}

static olx_result expect_probes(olx_result result, uint32_t probe_count, olx_candidate **probes, const char *what) {
  if (result == OLX_OK && probe_count == 0) result = olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: %s", what);
  if (result == OLX_OK) return OLX_OK;
  olx_release(*probes);
  *probes = NULL;
  return result;
}

olx_result olx_place_sdf(const olx_space *space, uint32_t wanted, uint32_t threads, olx_candidate **probes,
                         uint32_t *probe_count, uint32_t *candidates) {
  olx_cluster_item *items;
  OLX_TRY(olx_far_voxels(space, &items, candidates));
  const olx_result result = olx_place_clusters(space, items, *candidates, wanted, threads, probes, probe_count);
  olx_release(items);
  return expect_probes(result, *probe_count, probes,
                       "no voxel that may hold one is far from surfaces; try more voxels");
}

// Weights of features in clusters, where a position has weight 1 per diagonal: for a right angle between normals, and
// for the radius.
#define NORMAL_WEIGHT 0.05f
#define RADIUS_WEIGHT 1.0f

static void set_item(olx_cluster_item *item, const olx_medial_ball *ball, float scale) {
  const olx_vec3 n = ball->normal;
  // The outer product of the normal, so that a ball between two walls is the same from either side.
  const float tensor[6] = {
      n.x * n.x, n.y * n.y, n.z * n.z, 1.4142136f * n.x * n.y, 1.4142136f * n.y * n.z, 1.4142136f * n.z * n.x};
  set_position(item, ball->centre, scale);
  for (int i = 0; i < 6; i++) item->features[3 + i] = NORMAL_WEIGHT * tensor[i];
  item->features[9] = RADIUS_WEIGHT * ball->radius * scale;
}

static olx_result cluster_balls(const olx_space *space, const olx_medial_ball *balls, uint32_t count,
                                const olx_place_settings *settings, olx_candidate **probes, uint32_t *probe_count,
                                uint32_t *candidates) {
  const uint32_t most = count < MOST_ITEMS ? count : MOST_ITEMS;
  olx_cluster_item *items = olx_allocate_zero(most, sizeof *items);
  if (!items) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u balls", most);
  const float least = (float)least_distance(space) * space->voxels.size, scale = 1.0f / diagonal(space);
  uint32_t used = 0;
  for (uint64_t i = 0; i < most; i++) {
    const olx_medial_ball *ball = &balls[i * count / most];
    if (ball->radius >= least && olx_space_allows(space, ball->centre)) set_item(&items[used++], ball, scale);
  }
  *candidates = used;
  const olx_result result =
      olx_place_clusters(space, items, used, settings->count, settings->threads, probes, probe_count);
  olx_release(items);
  return result;
}

olx_result olx_place_medial(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                            olx_candidate **probes, uint32_t *probe_count, uint32_t *candidates) {
  olx_medial_ball *balls = NULL;
  uint32_t count = 0;
  olx_result result = olx_area_balls(space, sight, settings, &balls, &count);
  if (result == OLX_OK) result = cluster_balls(space, balls, count, settings, probes, probe_count, candidates);
  olx_release(balls);
  return expect_probes(result, *probe_count, probes,
                       "no ball that touches two surfaces has its centre where one may be");
}
