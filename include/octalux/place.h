// Placing probes: finds a set of positions from which a scene's surfaces are seen. Part of liboctalux-bake.
//
// Placement works on any soup of triangles: open, two-sided, intersecting. It answers three questions.
//
// Which space matters? The bounds (or the description's box of playable space) are divided into voxels; voxels that
// touch a surface are solid. The rest is flooded from the cameras; without cameras, every space counts that light
// reaches, except for very small ones. Whether a place is inside geometry is decided by the share of back faces seen
// from there *and* by the number of surfaces around it in several directions, never by one of them alone.
//
// Which surfaces matter? Surfels represent what that space sees. Positions are chosen by one set of surfels and judged
// by another. Surfels lie where rays arrive that leave the space from everywhere in all directions, so a surface counts
// as much as it is seen. They replace Wang's visibility atlas (section 3.2.1) without unwrapping anything. Both sides
// of a triangle are surfaces of their own.
//
// Where do probes go? OLX_PLACE_GRID puts them on a regular grid and reports which of them are inside geometry.
// OLX_PLACE_COVER picks from many candidates, always the one that adds most, until the wanted coverage, count or memory
// is reached, and then moves and swaps probes as long as that covers more. A surfel is *covered* when a probe sees it
// *well*: in line of sight, not at a grazing angle, and with a texel small enough on the surface; better angles and
// smaller texels are preferred where they cost no coverage. OLX_PLACE_SDF and OLX_PLACE_MEDIAL are the methods of
// Wang's thesis (section 3.1): one probe for each cluster of the skeleton of free space, but at the member nearest to
// the cluster's mean, not at the mean. Small clusters are dropped.
//
// Probes may then be moved to where they see better (section 3.2): `optimize`.
//
// Everything is deterministic: the same scene and settings give the same probes, with any number of threads.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_PLACE_H
#define OCTALUX_PLACE_H

#include <octalux/field.h>
#include <octalux/scene.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef enum olx_place_method {
  OLX_PLACE_GRID = 0,
  OLX_PLACE_SDF,    // skeleton: the voxels far from surfaces (section 3.1.1)
  OLX_PLACE_MEDIAL, // skeleton: the medial axis by shrinking balls (section 3.1.2; Ma et al. 2012)
  OLX_PLACE_COVER
} olx_place_method;

// Returns a method's name: "grid", "sdf", "medial" or "cover".
const char *olx_place_method_name(olx_place_method method);

// How probes are moved after placement. Each round visits every probe: it computes the reward with the probe at each of
// eight support probes, the corners of a cube around it.
typedef enum olx_place_optimizer {
  OLX_OPTIMIZE_NONE = 0,
  OLX_OPTIMIZE_GRADIENT, // to the best support probe when that is better (section 3.2.2), else the cube is halved
  OLX_OPTIMIZE_GIBBS     // to a place drawn between the support probes, accepted by the ratio of the rewards (sections
                         // 3.2.3, 3.2.4)
} olx_place_optimizer;

// Returns an optimizer's name: "none", "gradient" or "gibbs".
const char *olx_place_optimizer_name(olx_place_optimizer optimizer);

// The reward of a set of probes for each surfel. A probe that sees the surfel has a fitness: the mean of the cosine at
// the surfel and of the distance in diagonals of the scene.
typedef enum olx_place_reward {
  OLX_REWARD_BEST = 0, // the best probe's fitness
  OLX_REWARD_SUM       // the sum over all probes (equations 3.1, 3.2); seeing what others miss earns nothing extra
} olx_place_reward;

// Returns a reward's name: "best" or "sum".
const char *olx_place_reward_name(olx_place_reward reward);

// The origin of a probe's position.
typedef enum olx_probe_origin {
  OLX_ORIGIN_PINNED = 0, // the description pins it
  OLX_ORIGIN_GRID,       // a point of a regular grid
  OLX_ORIGIN_SKELETON,   // a point of the skeleton of free space, where surfaces are far
  OLX_ORIGIN_SPACE,      // spread over the free space
  OLX_ORIGIN_TARGET,     // chosen to see a surfel that no other candidate saw
  OLX_ORIGIN_MOVED       // any other, moved to where it covers more
} olx_probe_origin;

// Returns an origin's name: "pinned", "grid", "skeleton", "space", "target" or "moved".
const char *olx_probe_origin_name(olx_probe_origin origin);

typedef struct olx_place_settings {
  olx_place_method method; // default OLX_PLACE_COVER
  // The number of probes, including pinned ones (except with OLX_PLACE_GRID). OLX_PLACE_COVER ends at the first limit
  // that it meets; with neither count nor budget these are `coverage` and 65,536 probes. OLX_PLACE_SDF and
  // OLX_PLACE_MEDIAL form this many clusters, or fewer where the skeleton has no more; without a count, as many as make
  // clusters 0.15 diagonals wide.
  uint32_t count;   // 1 to 65,536; 0 (the default): not set
  float coverage;   // share of what can be covered, within [0, 1]; 0 (the default): 0.999, and 1 with a count or budget
  double budget_mb; // megabytes (10^6 bytes) that the field may take at `resolution` (olx_place_report.field_bytes),
                    // below 1e12; 0 (the default): not limited. OLX_PLACE_GRID keeps all its probes
  uint32_t views;   // probes that must see each surfel, 1 to 8; default 1
  olx_grid grid;    // OLX_PLACE_GRID: positions of its probes, at most 65,536; OLX_PLACE_COVER: a sixth of its
                    // candidates. With every method it must hold 1 to 2^20 positions. Default: the scene's
  uint32_t resolution; // texels along a light field map, a power of two, 8 to 2048; default 512
  float min_cosine;    // below this cosine between surface normal and line of sight a surfel is seen at grazing angle;
                       // within [0, 1); default 0.02
  float max_footprint; // largest side, on the surface, of a texel that covers it, as a share of the diagonal of the
                       // scene's bounds, or of a tile where there are several; above 0, at most 1e6;
                       // default 0.05
  olx_place_optimizer optimize; // default OLX_OPTIMIZE_NONE
  olx_place_reward reward;      // default OLX_REWARD_BEST
  uint32_t rounds;              // most rounds of the optimizer, 1 to 10,000; default 50; it ends when all is covered
  uint32_t surfels;    // that positions are chosen by, 64 to 1,048,576, fewer where they would take more than 256 MB;
                       // default 14,000. A tile has as many as its share of 2^20 voxels of space, at least 256. An
                       // optimizer uses at most 2,048
  uint32_t candidates; // 16 to 16,384; default 2,000; a tile has a share likewise, at least 64
  // The edge of a voxel in metres, within [0, 1e6]; 0 (the default): 0.25, so that a door of one metre is open wherever
  // its frame lies, or a twelfth of the median height from floors to what is above them where that is more. Space
  // longer than 160 voxels is covered in tiles of 128^3 voxels by OLX_PLACE_COVER, and measured in such tiles for
  // OLX_PLACE_GRID, both without an optimizer; the edge is doubled until the voxels fit into memory
  // (report.voxel_metres). Otherwise space is one tile, which has 160 voxels along its longest side when this is 0, and
  // otherwise as many as it takes, 512 at most.
  float voxel_size;
  // The number of voxels along the longest side of space, which then is one tile; 8 to 512, at most 2^23 in all; 0 (the
  // default): determined by voxel_size.
  uint32_t voxels;
  uint32_t refinements; // rounds in which probes may move or be swapped, 0 to 64; default 8
  uint32_t seed;
  uint32_t threads; // 0: as many as the machine has; the result does not depend on it
  bool marks;       // also fill olx_probe_set.marks; default false
  bool field_size;  // also compute olx_place_report.field_bytes, which takes rays; always true with a budget; default
                    // false
} olx_place_settings;

// Returns the default settings. `scene` may be NULL: then the grid has no probes, and olx_scene_probe_grid must set it.
olx_place_settings olx_place_settings_default(const olx_scene *scene);

typedef struct olx_placed_probe {
  olx_vec3 position;
  olx_probe_origin origin;
  float gain;  // share that this probe covers and no earlier probe of the list does (olx_place_report)
  bool buried; // inside geometry: a probe of a grid or a pinned one
} olx_placed_probe;

// How well the probes cover the scene, judged by surfels that the placement did not use. Shares are of what the space
// that matters sees, each surface weighted by how often it is seen, unless area is named.
typedef struct olx_place_report {
  uint64_t surfels;        // held out from placement
  double coverage;         // seen well by at least `views` probes
  double visible;          // in line of sight of at least one probe, at any angle and distance
  double coverage_by_area; // like coverage, but each surface is weighted by its area that is seen from anywhere
  double coverable;        // 1 - grazing - restricted
  double grazing;          // not covered: at grazing angles or with too large a texel from wherever a probe may be
  double restricted;       // not covered: seen only from where no probe may be: because of the description's
                           // overrides, or within a voxel of surfaces
  double missed;           // not covered but coverable: by more probes, or with a higher wanted coverage
  double unreachable;      // of all surface, by area: no side of it is seen from the space that matters
  double reached_m2;       // square metres of sides of surfaces that are seen from the space that matters
  double unreached_m2;     // of those that face free space which no opening of two voxels or more connects with it
  uint32_t buried;         // probes inside geometry (buried), which no lookup uses
  uint32_t rejected;       // OLX_PLACE_GRID: grid points left out because of the description's overrides
  uint32_t candidates;     // number of positions that were considered
  double coverage_before;  // coverage before an optimizer moved probes; 0 without one. By OLX_REWARD_BEST no move gives
                           // up a surfel that only one probe sees
  double reward_before;    // the mean reward of surfels before the optimizer, by settings.reward
  double reward_after;     // and after it, never less
  uint32_t rounds;         // of the optimizer
  uint64_t space_voxels;   // of the space that matters
  uint32_t tiles;          // the number of tiles in which space was covered
  uint64_t field_bytes;    // that a field of these probes is expected to take, baked with default settings and maps of
                           // `resolution` texels along a side (olx_bake_sizes.expected_bytes); 0 unless
                           // settings.field_size or a budget asks for it
  float voxel_metres;
  double seconds;
} olx_place_report;

// Kinds of marks in a picture beside the probes.
typedef enum olx_place_mark_kind {
  OLX_MARK_SKELETON = 0, // a place of the skeleton of free space; radius: how far surfaces are
  OLX_MARK_MISSED,       // a surface that is not covered but could be
  OLX_MARK_HOPELESS,     // a surface that cannot be covered: grazing or restricted (olx_place_report)
  OLX_MARK_UNREACHED     // a surface of free space that is not reached
} olx_place_mark_kind;

typedef struct olx_place_mark {
  olx_vec3 position;
  float radius; // metres; 0 on surfaces
  olx_place_mark_kind kind;
} olx_place_mark;

typedef struct olx_probe_set {
  uint32_t count;
  olx_placed_probe *probes;
  uint32_t mark_count; // 0 unless settings.marks
  olx_place_mark
      *marks; // the skeleton (of OLX_PLACE_MEDIAL its balls, else the far voxels; none in tiles), then held-out surfels
  olx_place_settings settings; // those of the placement, with a budget as `count` and a coverage of 0 as its default
  olx_place_report report;
  double origin[3]; // positions are relative to it: the scene's origin
  uint64_t scene_hash;
} olx_probe_set;

// Places probes in `scene`. The overrides of its description (docs/scenes.md: pinned, forbidden, playable,
// min_distance) apply to every method. OLX_ERROR_EMPTY, with a message that says why, when there is nothing to place
// in: no volume, no free space outside geometry, no surface that space sees. OLX_ERROR_ARGUMENT for settings out of
// range, for more pinned probes than `count`, and for a budget that holds no probe. On success the caller must free the
// set; on failure it has no probes.
olx_result olx_place(const olx_scene *scene, const olx_place_settings *settings, const olx_progress *progress,
                     olx_probe_set *set);
// Releases probes and marks; the struct itself is the caller's.
void olx_probe_set_free(olx_probe_set *set);

// Writes the set as JSON (docs/placement.md), through a temporary file that is synced and renamed. The bytes depend on
// the set alone. Positions are written in scene coordinates, in double precision.
olx_result olx_probe_set_save(const olx_probe_set *set, const char *path);
// Reads a file of olx_probe_set_save, or any JSON object whose "probes" is a list of objects with a "position".
// Settings that are missing are 0, except the method, OLX_PLACE_COVER, and `views`, 1; a missing origin of a probe is
// OLX_ORIGIN_PINNED. Budget, grid and report are not read and 0. Positions become relative to `origin`, the scene's
// (NULL: 0). Errors name the file and the element: OLX_ERROR_FORMAT for a file without probes or with a position beyond
// OLX_POSITION_LIMIT_METRES, OLX_ERROR_VERSION for another version of the format. On success the caller must free the
// set; on failure it has no probes.
olx_result olx_probe_set_load(const char *path, const double origin[3], olx_probe_set *set);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
