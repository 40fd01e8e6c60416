// Builds a sparse voxel octree level by level (Wang 2018, section 4.2): subdivides where triangles lie, and gives each
// leaf the four best of the probes that see it.
#include "bake/selectors/octree_build.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/selector_data.h"
#include "scene/bvh.h"
#include "scene/triangle_box.h"

#include <string.h>

enum {
  NODES_A_JOB = 64,
  EMPTY_SAMPLES = 8 // sample rays that decide whether a probe sees an empty leaf above the finest level
};
// Margin by which voxels are grown against rounding, in sides of the finest voxel.
static const float SLACK = 1e-3f;

// The coordinates of a voxel among 2^level along each axis.
typedef struct voxel {
  uint16_t x, y, z;
} voxel;

// The inner nodes of one level, in order, each with the triangles that touch it.
typedef struct tree_level {
  uint32_t count;
  voxel *voxels;
  size_t *first; // count + 1
  uint32_t *triangles;
} tree_level;

// The output of one job: which children of its nodes are inner nodes, and the probes chosen for those that are leaves.
typedef struct batch {
  uint8_t *inner_mask; // one bit per child of each node
  void *codes;
  uint32_t leaf_count;
  tree_level children; // children that are inner nodes
  olx_result result;
} batch;

typedef struct octree_build {
  const olx_selector_input *input;
  olx_vec3 low;
  float side;      // side of the root, metres
  uint32_t levels; // levels of subdivision
  uint32_t code_bytes;
  uint32_t level; // level of the nodes that are being subdivided
  const tree_level *nodes;
  batch *batches;
} octree_build;

typedef struct candidate {
  float score;
  uint32_t probe;
} candidate;

static bool is_better(candidate a, candidate b) {
  return a.score > b.score || (a.score == b.score && a.probe < b.probe);
}

static void sift_down(candidate *heap, uint32_t count, uint32_t at) {
  for (uint32_t child; (child = 2 * at + 1) < count; at = child) {
    if (child + 1 < count && is_better(heap[child + 1], heap[child])) child++;
    if (!is_better(heap[child], heap[at])) return;
    const candidate swap = heap[at];
    heap[at] = heap[child];
    heap[child] = swap;
  }
}

// ---- Which triangles touch a voxel

static void place_triangle(const octree_build *b, uint32_t triangle, olx_vec3 corners[3]) {
  const olx_scene *scene = b->input->scene;
  const float scale = (float)(1u << b->levels) / b->side;
  for (uint32_t i = 0; i < 3; i++) {
    corners[i] = olx_scale(olx_sub(scene->positions[scene->indices[3 * (size_t)triangle + i]], b->low), scale);
  }
}

static voxel child_of(voxel v, uint32_t child) {
  return (voxel){(uint16_t)(2 * v.x + (child & 1u)), (uint16_t)(2 * v.y + (child >> 1 & 1u)),
                 (uint16_t)(2 * v.z + (child >> 2))};
}

// Returns the centre of a voxel, in sides of the finest voxels.
static olx_vec3 voxel_centre(const octree_build *b, voxel v, uint32_t level) {
  const float side = (float)(1u << (b->levels - level));
  return olx_v3(((float)v.x + 0.5f) * side, ((float)v.y + 0.5f) * side, ((float)v.z + 0.5f) * side);
}

// Returns a mask of the node's children, on the level being subdivided, that the triangle touches.
static uint8_t children_touched(const octree_build *b, voxel v, uint32_t triangle) {
  olx_vec3 corners[3];
  place_triangle(b, triangle, corners);
  const float half = 0.5f * (float)(1u << (b->levels - b->level - 1)) + SLACK;
  uint32_t mask = 0;
  for (uint32_t child = 0; child < 8; child++) {
    const olx_vec3 centre = voxel_centre(b, child_of(v, child), b->level + 1);
    const olx_vec3 relative[3] = {olx_sub(corners[0], centre), olx_sub(corners[1], centre),
                                  olx_sub(corners[2], centre)};
    if (olx_triangle_touches_cube(relative, half)) mask |= 1u << child;
  }
  return (uint8_t)mask;
}

// Returns the mean normal of the triangles whose masks include the child. Each unit normal is flipped to the side of
// the sum so far: the probes' visibility decides which side counts. The mean is 0 when no triangle touches the child.
static olx_vec3 mean_normal(const octree_build *b, const uint32_t *triangles, const uint8_t *masks, size_t count,
                            uint32_t child) {
  olx_vec3 sum = olx_splat(0.0f);
  for (size_t i = 0; i < count; i++) {
    if (!(masks[i] >> child & 1u)) continue;
    olx_vec3 corners[3];
    place_triangle(b, triangles[i], corners);
    const olx_vec3 normal = olx_normalize(olx_cross(olx_sub(corners[1], corners[0]), olx_sub(corners[2], corners[0])));
    sum = olx_madd(sum, normal, olx_dot(sum, normal) < 0.0f ? -1.0f : 1.0f);
  }
  return olx_normalize(sum);
}

// ---- The probes of a leaf

typedef struct leaf_box {
  olx_vec3 centre;
  float half;
  bool finest, empty;
  olx_vec3 normal; // 0 when empty
  uint32_t seed;
} leaf_box;

// Returns whether a probe sees a point, or with `to_box`, whether it sees where the line to the point enters the box.
static bool sees(const octree_build *b, uint32_t probe, olx_vec3 point, const leaf_box *box, bool to_box) {
  const olx_vec3 origin = b->input->positions[probe], direction = olx_sub(point, origin);
  float t_max = 1.0f;
  if (to_box) {
    const float length = olx_max(fabsf(direction.x), olx_max(fabsf(direction.y), fabsf(direction.z)));
    // The point is the centre, so the line enters through the face across its largest component.
    if (length <= box->half) return true;
    t_max = 1.0f - box->half * (1.0f + 2.0f * SLACK) / length;
  }
  const olx_ray ray = {.origin = origin, .direction = direction, .t_max = t_max};
  return t_max <= 0.0f || !olx_bvh_occluded(b->input->scene->bvh, &ray);
}

static bool sees_leaf(const octree_build *b, uint32_t probe, const leaf_box *box) {
  if (!box->empty) return sees(b, probe, box->centre, box, true);
  if (box->finest) return sees(b, probe, box->centre, box, false);
  for (uint32_t i = 0; i < EMPTY_SAMPLES; i++) {
    const olx_vec3 random = {olx_unit_float(olx_hash3(3 * i, box->seed, 0)),
                             olx_unit_float(olx_hash3(3 * i + 1, box->seed, 0)),
                             olx_unit_float(olx_hash3(3 * i + 2, box->seed, 0))};
    const olx_vec3 offset = olx_sub(olx_scale(random, 2.0f), olx_splat(1.0f));
    if (sees(b, probe, olx_madd(box->centre, offset, box->half), box, false)) return true;
  }
  return false;
}

// Returns the score of a probe: n . p / d for a leaf with a surface, 1 / d for an empty leaf.
static float score(const octree_build *b, uint32_t probe, const leaf_box *box) {
  const olx_vec3 offset = olx_sub(b->input->positions[probe], box->centre);
  const float squared = olx_dot(offset, offset);
  if (!(squared > 0.0f)) return INFINITY;
  return box->empty ? 1.0f / sqrtf(squared) : fabsf(olx_dot(box->normal, offset)) / squared;
}

// Chooses the probes that see the leaf, in descending order of score, until there are enough.
static void choose(const octree_build *b, const leaf_box *box, candidate *heap, uint32_t choices[OLX_CHOICES]) {
  uint32_t count = 0, known = 0;
  for (uint32_t i = 0; i < b->input->count; i++) {
    if (!(b->input->flags[i] & OLX_PROBE_BURIED)) heap[count++] = (candidate){score(b, i, box), i};
  }
  for (uint32_t i = count / 2; i-- > 0;) sift_down(heap, count, i);
  while (count > 0 && known < OLX_CHOICES) {
    const uint32_t probe = heap[0].probe;
    heap[0] = heap[--count];
    sift_down(heap, count, 0);
    if (sees_leaf(b, probe, box)) choices[known++] = probe;
  }
  while (known < OLX_CHOICES) choices[known++] = OLX_NO_PROBE;
}

// ---- One level

typedef struct job_scratch {
  uint8_t *masks; // a mask for each triangle of the job's nodes
  candidate *heap;
} job_scratch;

static void fill_leaf(const octree_build *b, batch *out, const job_scratch *scratch, voxel v, uint32_t node,
                      uint32_t child) {
  const tree_level *nodes = b->nodes;
  const size_t first = nodes->first[node], count = nodes->first[node + 1] - first;
  const voxel leaf = child_of(v, child);
  const float unit = b->side / (float)(1u << b->levels);
  const uint8_t *masks = scratch->masks + (first - nodes->first[node / NODES_A_JOB * NODES_A_JOB]);
  leaf_box box = {.centre = olx_madd(b->low, voxel_centre(b, leaf, b->level + 1), unit),
                  .half = 0.5f * unit * (float)(1u << (b->levels - b->level - 1)),
                  .finest = b->level + 1 == b->levels,
                  .normal = mean_normal(b, nodes->triangles + first, masks, count, child),
                  .seed = olx_hash3(leaf.x, leaf.y, leaf.z + (b->level << 16))};
  box.empty = olx_dot(box.normal, box.normal) == 0.0f;
  uint32_t choices[OLX_CHOICES];
  choose(b, &box, scratch->heap, choices);
  for (uint32_t i = 0; i < OLX_CHOICES; i++) {
    olx_probe_code_store(out->codes, b->code_bytes, (size_t)out->leaf_count * OLX_CHOICES + i, choices[i]);
  }
  out->leaf_count++;
}

static void fill_inner(const octree_build *b, batch *out, const job_scratch *scratch, voxel v, uint32_t node,
                       uint32_t child) {
  const tree_level *nodes = b->nodes;
  const size_t base = nodes->first[node / NODES_A_JOB * NODES_A_JOB];
  tree_level *children = &out->children;
  size_t used = children->first[children->count];
  for (size_t i = nodes->first[node]; i < nodes->first[node + 1]; i++) {
    if (scratch->masks[i - base] >> child & 1u) children->triangles[used++] = nodes->triangles[i];
  }
  children->voxels[children->count++] = child_of(v, child);
  children->first[children->count] = used;
}

// Finds which children each node has, and allocates room for them.
static bool prepare(const octree_build *b, batch *out, job_scratch *scratch, uint32_t begin, uint32_t end) {
  const tree_level *nodes = b->nodes;
  const bool finest = b->level + 1 == b->levels;
  const size_t base = nodes->first[begin];
  size_t references = 0;
  uint32_t inner = 0;
  scratch->masks = olx_allocate(nodes->first[end] - base, 1);
  scratch->heap = olx_allocate(b->input->count, sizeof *scratch->heap);
  out->inner_mask = olx_allocate_zero(end - begin, 1);
  if (!scratch->masks || !scratch->heap || !out->inner_mask) return false;
  for (uint32_t node = begin; node < end; node++) {
    uint8_t touched = 0;
    for (size_t i = nodes->first[node]; i < nodes->first[node + 1]; i++) {
      const uint8_t mask = children_touched(b, nodes->voxels[node], nodes->triangles[i]);
      scratch->masks[i - base] = mask;
      touched |= mask;
      references += (uint32_t)__builtin_popcount(mask);
    }
    if (finest) continue;
    out->inner_mask[node - begin] = touched;
    inner += (uint32_t)__builtin_popcount(touched);
  }
  const uint32_t leaves = 8 * (end - begin) - inner;
  out->codes = olx_allocate((size_t)leaves * OLX_CHOICES, b->code_bytes);
  tree_level *children = &out->children;
  children->voxels = olx_allocate(inner, sizeof *children->voxels);
  children->first = olx_allocate_zero((size_t)inner + 1, sizeof *children->first);
  children->triangles = olx_allocate(finest ? 0 : references, sizeof *children->triangles);
  return out->codes && children->voxels && children->first && children->triangles;
}

static void subdivide(void *user, uint32_t index) {
  const octree_build *b = user;
  batch *out = &b->batches[index];
  const uint32_t begin = index * NODES_A_JOB;
  const uint32_t end = begin + NODES_A_JOB < b->nodes->count ? begin + NODES_A_JOB : b->nodes->count;
  job_scratch scratch = {0};
  if (prepare(b, out, &scratch, begin, end)) {
    for (uint32_t node = begin; node < end; node++) {
      for (uint32_t child = 0; child < 8; child++) {
        const bool inner = (out->inner_mask[node - begin] >> child & 1u) != 0;
        (inner ? fill_inner : fill_leaf)(b, out, &scratch, b->nodes->voxels[node], node, child);
      }
    }
  } else {
    out->result = OLX_ERROR_MEMORY;
  }
  olx_release(scratch.masks);
  olx_release(scratch.heap);
}

static void free_level(tree_level *level) {
  olx_release(level->voxels);
  olx_release(level->first);
  olx_release(level->triangles);
  *level = (tree_level){0};
}

// ---- The whole tree

// A level of the tree as the file stores it: the masks of its nodes, and the codes of the children that are leaves.
typedef struct finished_level {
  uint32_t node_count, leaf_count;
  uint8_t *inner_mask;
  void *codes;
} finished_level;

// Concatenates the batches in order.
static bool gather(const octree_build *b, uint32_t batch_count, finished_level *done, tree_level *next) {
  size_t triangles = 0;
  *done = (finished_level){.node_count = b->nodes->count};
  for (uint32_t i = 0; i < batch_count; i++) {
    const batch *from = &b->batches[i];
    done->leaf_count += from->leaf_count;
    next->count += from->children.count;
    triangles += from->children.first[from->children.count];
  }
  const size_t choice_bytes = (size_t)OLX_CHOICES * b->code_bytes;
  done->inner_mask = olx_allocate(done->node_count, 1);
  done->codes = olx_allocate(done->leaf_count, choice_bytes);
  next->voxels = olx_allocate(next->count, sizeof *next->voxels);
  next->first = olx_allocate_zero((size_t)next->count + 1, sizeof *next->first);
  next->triangles = olx_allocate(triangles, sizeof *next->triangles);
  if (!done->inner_mask || !done->codes || !next->voxels || !next->first || !next->triangles) return false;
  uint32_t nodes = 0, leaves = 0, inner = 0;
  for (uint32_t i = 0; i < batch_count; i++) {
    const batch *from = &b->batches[i];
    const tree_level *children = &from->children;
    const uint32_t own = done->node_count - nodes < NODES_A_JOB ? done->node_count - nodes : NODES_A_JOB;
    const size_t base = next->first[inner];
    memcpy(done->inner_mask + nodes, from->inner_mask, own);
    memcpy((char *)done->codes + leaves * choice_bytes, from->codes, from->leaf_count * choice_bytes);
    memcpy(next->voxels + inner, children->voxels, children->count * sizeof *next->voxels);
    memcpy(next->triangles + base, children->triangles, children->first[children->count] * sizeof *next->triangles);
    for (uint32_t k = 1; k <= children->count; k++) next->first[inner + k] = base + children->first[k];
    nodes += own;
    leaves += from->leaf_count;
    inner += children->count;
  }
  return true;
}

static olx_result build_level(octree_build *b, const tree_level *nodes, finished_level *done, tree_level *next) {
  const uint32_t batch_count = (nodes->count + NODES_A_JOB - 1) / NODES_A_JOB;
  b->nodes = nodes;
  b->batches = olx_allocate_zero(batch_count, sizeof *b->batches);
  if (!b->batches) return OLX_ERROR_MEMORY;
  olx_result result = olx_parallel_for(batch_count, b->input->threads, subdivide, b, b->input->task, 0);
  for (uint32_t i = 0; i < batch_count && result == OLX_OK; i++) result = b->batches[i].result;
  if (result == OLX_OK && !gather(b, batch_count, done, next)) result = OLX_ERROR_MEMORY;
  for (uint32_t i = 0; i < batch_count; i++) {
    olx_release(b->batches[i].inner_mask);
    olx_release(b->batches[i].codes);
    free_level(&b->batches[i].children);
  }
  olx_release(b->batches);
  return result;
}

static olx_result start_root(const octree_build *b, tree_level *root) {
  const uint32_t triangles = b->input->scene->triangle_count;
  root->voxels = olx_allocate_zero(1, sizeof *root->voxels);
  root->first = olx_allocate_zero(2, sizeof *root->first);
  root->triangles = olx_allocate(triangles, sizeof *root->triangles);
  if (!root->voxels || !root->first || !root->triangles) return OLX_ERROR_MEMORY;
  root->count = 1;
  root->first[1] = triangles;
  for (uint32_t i = 0; i < triangles; i++) root->triangles[i] = i;
  return OLX_OK;
}

// Concatenates the nodes and the choices of all levels.
static olx_result assemble(const octree_build *b, const finished_level *done, void **data, size_t *size_bytes) {
  uint64_t inner_nodes = 0;
  for (uint32_t level = 0; level < b->levels; level++) inner_nodes += done[level].node_count;
  if (inner_nodes > OLX_OCTREE_MAX_INNER) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: an octree of %llu inner nodes is too large",
                    (unsigned long long)inner_nodes);
  }
  const size_t node_count = 1 + 8 * inner_nodes, leaf_count = 1 + 7 * inner_nodes;
  const size_t choice_bytes = (size_t)OLX_CHOICES * b->code_bytes;
  *size_bytes = sizeof(olx_octree_header) + node_count * sizeof(uint32_t) + leaf_count * choice_bytes;
  *data = olx_allocate(*size_bytes, 1);
  if (!*data) return OLX_ERROR_MEMORY;
  olx_octree_header *header = *data;
  *header = (olx_octree_header){.levels = b->levels, .inner_nodes = (uint32_t)inner_nodes};
  uint32_t *nodes = (uint32_t *)(header + 1), inner = 0, leaves = 0;
  char *codes = (char *)(nodes + node_count);
  *nodes++ = 1 + 8 * inner++;
  for (uint32_t level = 0; level < b->levels; level++) {
    for (size_t child = 0; child < 8 * (size_t)done[level].node_count; child++) {
      const bool is_inner = (done[level].inner_mask[child / 8] >> child % 8 & 1u) != 0;
      *nodes++ = is_inner ? 1 + 8 * inner++ : OLX_OCTREE_LEAF | leaves++;
    }
    memcpy(codes, done[level].codes, done[level].leaf_count * choice_bytes);
    codes += done[level].leaf_count * choice_bytes;
  }
  return OLX_OK;
}

static olx_result build_levels(octree_build *b, finished_level *done, void **data, size_t *size_bytes) {
  tree_level nodes = {0};
  olx_result result = start_root(b, &nodes);
  for (b->level = 0; b->level < b->levels && result == OLX_OK; b->level++) {
    tree_level next = {0};
    result = build_level(b, &nodes, &done[b->level], &next);
    free_level(&nodes);
    nodes = next;
  }
  free_level(&nodes);
  return result == OLX_OK ? assemble(b, done, data, size_bytes) : result;
}

olx_result olx_octree_build(const olx_selector_input *input, void **data, size_t *size_bytes) {
  *data = NULL;
  if (input->count > OLX_MAX_CODED_PROBES) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: the selector 'octree' takes at most %d probes, not %u",
                    OLX_MAX_CODED_PROBES, input->count);
  }
  octree_build b = {.input = input,
                    .low = input->scene->bounds_min,
                    .side = olx_octree_side(input->scene->bounds_min, input->scene->bounds_max),
                    .levels = olx_octree_levels(input->radiance_size),
                    .code_bytes = olx_probe_code_bytes(input->count)};
  finished_level done[OLX_OCTREE_MAX_LEVELS] = {{0}};
  const olx_result result = build_levels(&b, done, data, size_bytes);
  for (uint32_t level = 0; level < b.levels; level++) {
    olx_release(done[level].inner_mask);
    olx_release(done[level].codes);
  }
  if (result != OLX_ERROR_MEMORY) return result;
  return olx_fail(result, "bake: out of memory for an octree of %u levels", b.levels);
}
