// Stores the voxels of a whole scene as bricks of bits, and floods the free ones, 64 at a time.
#include "place/space/world.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

#define COLUMN_0 0x0101010101010101u
#define COLUMN_7 0x8080808080808080u
enum { SIDE = OLX_WORLD_SIDE, BRICK_VOXELS = SIDE * SIDE * SIDE };

// Bits of olx_world.flags. The first three hold for all voxels of an open brick.
enum { OPEN_REACHED = 1, OPEN_OUT = 2, OPEN_SEEN = 4, QUEUED = 8, TOUCHED = 16, MARKED = 32 };

static const olx_world_bits ALL_BITS = {
    {~(uint64_t)0, ~(uint64_t)0, ~(uint64_t)0, ~(uint64_t)0, ~(uint64_t)0, ~(uint64_t)0, ~(uint64_t)0, ~(uint64_t)0}};

static uint32_t count_bits(const olx_world_bits *bits) {
  uint32_t count = 0;
  for (int z = 0; z < SIDE; z++) count += (uint32_t)__builtin_popcountll(bits->z[z]);
  return count;
}

uint64_t olx_world_brick_count(const uint32_t voxels[3]) {
  uint64_t total = 1;
  for (int axis = 0; axis < 3; axis++) total *= (voxels[axis] + SIDE - 1) / SIDE;
  return total;
}

static uint32_t brick_of(const olx_world *w, const uint32_t voxel[3]) {
  return voxel[0] / SIDE + w->bricks[0] * (voxel[1] / SIDE + w->bricks[1] * (voxel[2] / SIDE));
}

static void brick_corner(const olx_world *w, uint32_t brick, uint32_t voxel[3]) {
  voxel[0] = SIDE * (brick % w->bricks[0]);
  voxel[1] = SIDE * (brick / w->bricks[0] % w->bricks[1]);
  voxel[2] = SIDE * (brick / w->bricks[0] / w->bricks[1]);
}

static uint64_t voxel_bit(const uint32_t voxel[3]) {
  return (uint64_t)1 << (voxel[0] % SIDE + SIDE * (voxel[1] % SIDE));
}

static bool has_bit(const olx_world_bits *bits, const uint32_t voxel[3]) {
  return (bits->z[voxel[2] % SIDE] & voxel_bit(voxel)) != 0;
}

static olx_world_brick *stored_brick(const olx_world *w, uint32_t brick) {
  return w->slots[brick] == OLX_OPEN_BRICK ? NULL : &w->stored[w->slots[brick]];
}

// First pass: marks the bricks that surfaces touch. Threads may mark the same brick concurrently with the same value.
static void mark_brick(void *user, const int32_t c[3]) {
  const olx_world *w = user;
  uint8_t *flags = &w->flags[(uint32_t)c[0] + w->bricks[0] * ((uint32_t)c[1] + w->bricks[1] * (uint32_t)c[2])];
  __atomic_store_n(flags, MARKED, __ATOMIC_RELAXED);
}

// Second pass: marks the voxels that surfaces touch, in the bricks that the first pass marked.
static void mark_voxel(void *user, const int32_t c[3]) {
  const olx_world *w = user;
  const uint32_t voxel[3] = {(uint32_t)c[0], (uint32_t)c[1], (uint32_t)c[2]};
  olx_world_brick *brick = stored_brick(w, brick_of(w, voxel));
  if (brick) __atomic_fetch_or(&brick->solid.z[voxel[2] % SIDE], voxel_bit(voxel), __ATOMIC_RELAXED);
}

// Returns whether the box ends inside the brick.
static bool is_cut(const olx_world *w, const uint32_t corner[3]) {
  for (int axis = 0; axis < 3; axis++) {
    if (corner[axis] < w->begin[axis] || corner[axis] + SIDE > w->lattice.count[axis]) return true;
  }
  return false;
}

// Marks voxels beyond the box as solid.
static void close_beyond(const olx_world *w, const uint32_t corner[3], olx_world_brick *brick) {
  for (uint32_t i = 0; i < BRICK_VOXELS; i++) {
    const uint32_t voxel[3] = {corner[0] + i % SIDE, corner[1] + i / SIDE % SIDE, corner[2] + i / (SIDE * SIDE)};
    bool within = true;
    for (int axis = 0; axis < 3; axis++) {
      within = within && voxel[axis] >= w->begin[axis] && voxel[axis] < w->lattice.count[axis];
    }
    if (!within) brick->solid.z[voxel[2] % SIDE] |= voxel_bit(voxel);
  }
}

static olx_result no_memory(const olx_world *w) {
  return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u bricks of voxels", w->brick_total);
}

static olx_result too_many(const olx_world *w) {
  return olx_fail(OLX_ERROR_ARGUMENT, "place: too many voxels of %g m", (double)w->lattice.size);
}

static olx_result store_bricks(olx_world *w) {
  for (uint32_t i = 0; i < w->brick_total; i++) {
    uint32_t corner[3];
    brick_corner(w, i, corner);
    const bool kept = w->flags[i] == MARKED || is_cut(w, corner);
    w->slots[i] = kept ? w->stored_count++ : OLX_OPEN_BRICK;
    w->flags[i] = 0;
  }
  if (w->stored_count > OLX_WORLD_STORED) return too_many(w);
  w->stored_capacity = w->stored_count;
  w->stored = olx_allocate_zero(w->stored_count, sizeof *w->stored);
  if (!w->stored) return no_memory(w);
  for (uint32_t i = 0; i < w->brick_total; i++) {
    uint32_t corner[3];
    brick_corner(w, i, corner);
    if (is_cut(w, corner)) close_beyond(w, corner, stored_brick(w, i));
  }
  return OLX_OK;
}

static olx_result mark_world(olx_world *w, uint32_t threads) {
  olx_lattice coarse = w->lattice;
  coarse.size *= SIDE;
  // Grown so that no voxel is marked whose brick is not.
  coarse.slack = 0.01f + w->lattice.slack;
  for (int axis = 0; axis < 3; axis++) coarse.count[axis] = w->bricks[axis];
  OLX_TRY(olx_mark_cells(w->scene, &coarse, true, threads, mark_brick, w));
  OLX_TRY(store_bricks(w));
  return olx_mark_cells(w->scene, &w->lattice, false, threads, mark_voxel, w);
}

olx_result olx_world_create(const olx_scene *scene, olx_box box, const olx_lattice *lattice, const uint32_t begin[3],
                            uint32_t threads, olx_world *w) {
  *w = (olx_world){.scene = scene, .box = box, .lattice = *lattice, .begin = {begin[0], begin[1], begin[2]}};
  const uint64_t total = olx_world_brick_count(lattice->count);
  if (total > OLX_WORLD_BRICKS)
    return olx_fail(OLX_ERROR_ARGUMENT, "place: too many voxels of %g m", (double)lattice->size);
  w->brick_total = (uint32_t)total;
  uint32_t longest = 0;
  for (int axis = 0; axis < 3; axis++) {
    w->bricks[axis] = (lattice->count[axis] + SIDE - 1) / SIDE;
    longest = w->bricks[axis] > longest ? w->bricks[axis] : longest;
  }
  olx_world_cut(w, longest * SIDE, (const int32_t[3]){0});
  w->slots = olx_allocate(total, sizeof *w->slots);
  w->flags = olx_allocate_zero(total, 1);
  w->queue = olx_allocate(total, sizeof *w->queue);
  w->touched = olx_allocate(total, sizeof *w->touched);
  olx_result result = OLX_ERROR_MEMORY;
  if (w->slots && w->flags && w->queue && w->touched) result = mark_world(w, threads);
  else no_memory(w);
  if (result != OLX_OK) olx_world_free(w);
  return result;
}

void olx_world_free(olx_world *w) {
  olx_release(w->slots);
  olx_release(w->flags);
  olx_release(w->stored);
  olx_release(w->queue);
  olx_release(w->touched);
  w->slots = w->queue = w->touched = NULL;
  w->flags = NULL;
  w->stored = NULL;
}

void olx_world_cut(olx_world *w, uint32_t tile_edge, const int32_t first[3]) {
  w->tile_edge = tile_edge;
  w->tile_total = 1;
  for (int axis = 0; axis < 3; axis++) {
    const int32_t edge = (int32_t)tile_edge, within = (first[axis] % edge + edge) % edge;
    w->shift[axis] = (uint32_t)within;
    w->first_tile[axis] = (first[axis] - within) / edge;
    w->tiles[axis] = (w->lattice.count[axis] + w->shift[axis] + tile_edge - 1) / tile_edge;
    w->tile_total *= w->tiles[axis];
  }
}

olx_tile olx_world_tile(const olx_world *w, uint32_t index, uint32_t overlap) {
  olx_tile tile = {.index = index,
                   .cell = {index % w->tiles[0], index / w->tiles[0] % w->tiles[1], index / w->tiles[0] / w->tiles[1]}};
  for (int axis = 0; axis < 3; axis++) {
    const uint32_t begin = tile.cell[axis] * w->tile_edge, end = begin + w->tile_edge, shift = w->shift[axis];
    const uint32_t count = w->lattice.count[axis], last = end - shift;
    tile.core_from[axis] = begin > shift ? begin - shift : 0;
    tile.core_to[axis] = last < count ? last : count;
    tile.from[axis] = tile.core_from[axis] > overlap ? tile.core_from[axis] - overlap : 0;
    tile.to[axis] = tile.core_to[axis] + overlap < count ? tile.core_to[axis] + overlap : count;
  }
  return tile;
}

float olx_world_diagonal(const olx_world *w) {
  const float tile = sqrtf(3.0f) * (float)w->tile_edge * w->lattice.size;
  return w->tile_total > 1 ? tile : olx_length(olx_sub(w->scene->bounds_max, w->scene->bounds_min));
}

uint32_t olx_world_tile_of(const olx_world *w, olx_vec3 p) {
  uint32_t c[3];
  olx_world_nearest(w, p, c);
  for (int axis = 0; axis < 3; axis++) c[axis] = (c[axis] + w->shift[axis]) / w->tile_edge;
  return c[0] + w->tiles[0] * (c[1] + w->tiles[1] * c[2]);
}

bool olx_world_at(const olx_world *w, olx_vec3 p, uint32_t voxel[3]) {
  const olx_vec3 q = olx_scale(olx_sub(p, w->lattice.low), 1.0f / w->lattice.size);
  const float along[3] = {q.x, q.y, q.z};
  for (int axis = 0; axis < 3; axis++) {
    if (!(along[axis] >= 0.0f && along[axis] < (float)w->lattice.count[axis])) return false;
    voxel[axis] = (uint32_t)along[axis];
  }
  return true;
}

void olx_world_nearest(const olx_world *w, olx_vec3 p, uint32_t voxel[3]) {
  const olx_vec3 q = olx_scale(olx_sub(p, w->lattice.low), 1.0f / w->lattice.size);
  const float along[3] = {q.x, q.y, q.z};
  for (int axis = 0; axis < 3; axis++) {
    voxel[axis] = (uint32_t)olx_clamp(along[axis], 0.0f, (float)(w->lattice.count[axis] - 1));
  }
}

olx_vec3 olx_world_centre(const olx_world *w, const uint32_t voxel[3]) {
  const olx_vec3 middle = {(float)voxel[0] + 0.5f, (float)voxel[1] + 0.5f, (float)voxel[2] + 0.5f};
  return olx_madd(w->lattice.low, middle, w->lattice.size);
}

static olx_voxel_state state_of_open(uint8_t flags) {
  if (flags & OPEN_OUT) return OLX_VOXEL_OUT;
  return flags & OPEN_REACHED ? OLX_VOXEL_REACHED : OLX_VOXEL_CUT_OFF;
}

olx_voxel_state olx_world_state(const olx_world *w, const uint32_t voxel[3]) {
  const uint32_t index = brick_of(w, voxel);
  const olx_world_brick *brick = stored_brick(w, index);
  if (!brick) return state_of_open(w->flags[index]);
  if (has_bit(&brick->solid, voxel)) return OLX_VOXEL_SOLID;
  if (has_bit(&brick->out, voxel)) return OLX_VOXEL_OUT;
  return has_bit(&brick->reached, voxel) ? OLX_VOXEL_REACHED : OLX_VOXEL_CUT_OFF;
}

static void queue_brick(olx_world *w, uint32_t index) {
  if (!(w->flags[index] & TOUCHED)) w->touched[w->touched_count++] = index;
  if (!(w->flags[index] & QUEUED)) w->queue[w->queue_count++] = index;
  w->flags[index] |= TOUCHED | QUEUED;
}

// Marks as reached those of the voxels that can be.
static void enter(olx_world *w, uint32_t index, const olx_world_bits *by) {
  olx_world_brick *brick = stored_brick(w, index);
  if (!brick) {
    if (w->flags[index] & (OPEN_REACHED | OPEN_OUT) || count_bits(by) == 0) return;
    w->flags[index] |= OPEN_REACHED;
    queue_brick(w, index);
    return;
  }
  uint64_t any = 0;
  for (int z = 0; z < SIDE; z++) {
    const uint64_t new = by->z[z] & ~(brick->solid.z[z] | brick->out.z[z] | brick->reached.z[z]);
    brick->reached.z[z] |= new;
    any |= new;
  }
  if (any) queue_brick(w, index);
}

// Marks as reached what is connected within the brick.
static void grow(olx_world_brick *brick) {
  uint64_t *r = brick->reached.z;
  for (bool grown = true; grown;) {
    grown = false;
    for (int z = 0; z < SIDE; z++) {
      uint64_t more = (r[z] << 1 & ~COLUMN_0) | (r[z] >> 1 & ~COLUMN_7) | r[z] << 8 | r[z] >> 8;
      if (z > 0) more |= r[z - 1];
      if (z + 1 < SIDE) more |= r[z + 1];
      more &= ~(brick->solid.z[z] | brick->out.z[z] | r[z]);
      r[z] |= more;
      grown |= more != 0;
    }
  }
}

// Passes the flood on through a face: along axis face / 2, backwards when face is even.
static void pass(olx_world *w, uint32_t index, uint32_t face, const olx_world_bits *from) {
  const uint32_t stride[3] = {1, w->bricks[0], w->bricks[0] * w->bricks[1]}, axis = face / 2;
  uint32_t corner[3];
  brick_corner(w, index, corner);
  if (face & 1 ? corner[axis] / SIDE + 1 == w->bricks[axis] : corner[axis] == 0) return;
  olx_world_bits through = {{0}};
  for (int z = 0; z < SIDE && axis < 2; z++) {
    const uint64_t bits = from->z[z];
    if (axis == 0) through.z[z] = face & 1 ? bits >> 7 & COLUMN_0 : bits << 7 & COLUMN_7;
    else through.z[z] = face & 1 ? bits >> 56 : bits << 56;
  }
  if (axis == 2) through.z[face & 1 ? 0 : SIDE - 1] = from->z[face & 1 ? SIDE - 1 : 0];
  enter(w, face & 1 ? index + stride[axis] : index - stride[axis], &through);
}

static uint64_t count_touched(const olx_world *w) {
  uint64_t count = 0;
  for (uint32_t i = 0; i < w->touched_count; i++) {
    const olx_world_brick *brick = stored_brick(w, w->touched[i]);
    count += brick ? count_bits(&brick->reached) : BRICK_VOXELS;
  }
  return count;
}

uint64_t olx_world_flood(olx_world *w, const uint32_t voxel[3]) {
  olx_world_bits seed = {{0}};
  seed.z[voxel[2] % SIDE] = voxel_bit(voxel);
  for (uint32_t i = 0; i < w->touched_count; i++) w->flags[w->touched[i]] &= (uint8_t)~TOUCHED;
  w->touched_count = 0;
  enter(w, brick_of(w, voxel), &seed);
  while (w->queue_count > 0) {
    const uint32_t index = w->queue[--w->queue_count];
    olx_world_brick *brick = stored_brick(w, index);
    w->flags[index] &= (uint8_t)~QUEUED;
    if (brick) grow(brick);
    for (uint32_t face = 0; face < 6; face++) pass(w, index, face, brick ? &brick->reached : &ALL_BITS);
  }
  return count_touched(w);
}

void olx_world_forget(olx_world *w) {
  for (uint32_t i = 0; i < w->brick_total; i++) w->flags[i] &= OPEN_OUT;
  for (uint32_t i = 0; i < w->stored_count; i++) w->stored[i].reached = w->stored[i].seen = (olx_world_bits){{0}};
  w->touched_count = 0;
}

void olx_world_put_aside(olx_world *w) {
  for (uint32_t i = 0; i < w->touched_count; i++) {
    olx_world_brick *brick = stored_brick(w, w->touched[i]);
    uint8_t *flags = &w->flags[w->touched[i]];
    for (int z = 0; brick && z < SIDE; z++) {
      brick->seen.z[z] |= brick->reached.z[z];
      brick->reached.z[z] = 0;
    }
    if (!brick) *flags = (uint8_t)((*flags & ~OPEN_REACHED) | OPEN_SEEN);
  }
}

// Finds the first set voxel, relative to the brick's corner.
static bool first_of(const olx_world_bits *bits, uint32_t voxel[3]) {
  for (uint32_t z = 0; z < SIDE; z++) {
    if (!bits->z[z]) continue;
    const uint32_t at = (uint32_t)__builtin_ctzll(bits->z[z]);
    voxel[0] += at % SIDE;
    voxel[1] += at / SIDE;
    voxel[2] += z;
    return true;
  }
  return false;
}

bool olx_world_next_free(const olx_world *w, uint32_t *index, uint32_t voxel[3]) {
  for (; *index < w->brick_total; ++*index) {
    const olx_world_brick *brick = stored_brick(w, *index);
    brick_corner(w, *index, voxel);
    if (!brick && !(w->flags[*index] & (OPEN_REACHED | OPEN_OUT | OPEN_SEEN))) return true;
    olx_world_bits left = {{0}};
    for (int z = 0; brick && z < SIDE; z++) {
      left.z[z] = ~(brick->solid.z[z] | brick->out.z[z] | brick->reached.z[z] | brick->seen.z[z]);
    }
    if (first_of(&left, voxel)) return true;
  }
  return false;
}

// Finds the nth voxel of a brick whose bit is set; there are more than `nth`.
static bool nth_of(const olx_world *w, uint32_t index, olx_world_bits bits, uint64_t nth, uint32_t voxel[3]) {
  for (int z = 0; z < SIDE; z++) {
    for (; nth > 0 && bits.z[z]; nth--) bits.z[z] &= bits.z[z] - 1;
    if (bits.z[z]) break;
  }
  brick_corner(w, index, voxel);
  return first_of(&bits, voxel);
}

bool olx_world_nth_reached(const olx_world *w, uint64_t nth, uint32_t voxel[3]) {
  for (uint32_t i = 0; i < w->touched_count; i++) {
    const olx_world_brick *brick = stored_brick(w, w->touched[i]);
    const olx_world_bits bits = brick ? brick->reached : ALL_BITS;
    const uint32_t count = count_bits(&bits);
    if (nth < count) return nth_of(w, w->touched[i], bits, nth, voxel);
    nth -= count;
  }
  return false;
}

static olx_world_bits reached_bits(const olx_world *w, uint32_t index) {
  const olx_world_brick *brick = stored_brick(w, index);
  if (brick) return brick->reached;
  return w->flags[index] & OPEN_REACHED ? ALL_BITS : (olx_world_bits){{0}};
}

uint32_t olx_world_spread(const olx_world *w, uint32_t wanted, olx_vec3 *centres) {
  uint64_t passed = 0;
  uint32_t found = 0;
  for (uint32_t i = 0; i < w->brick_total && found < wanted; i++) {
    const olx_world_bits bits = reached_bits(w, i);
    const uint32_t count = count_bits(&bits);
    uint64_t nth = (2 * (uint64_t)found + 1) * w->reached_count / (2 * (uint64_t)wanted);
    while (found < wanted && nth < passed + count) {
      uint32_t voxel[3];
      if (nth_of(w, i, bits, nth - passed, voxel)) centres[found++] = olx_world_centre(w, voxel);
      nth = (2 * (uint64_t)found + 1) * w->reached_count / (2 * (uint64_t)wanted);
    }
    passed += count;
  }
  return found;
}

uint64_t olx_world_count_reached(const olx_world *w) {
  uint64_t count = 0;
  for (uint32_t i = 0; i < w->brick_total; i++) {
    const olx_world_bits bits = reached_bits(w, i);
    count += count_bits(&bits);
  }
  return count;
}

bool olx_world_has_free(const olx_world *w) {
  if (w->stored_count < w->brick_total) return true;
  for (uint32_t i = 0; i < w->stored_count; i++) {
    if (count_bits(&w->stored[i].solid) < BRICK_VOXELS) return true;
  }
  return false;
}

// Gives an open brick its own bits.
static olx_result store_brick(olx_world *w, uint32_t index) {
  if (w->stored_count == w->stored_capacity) {
    const uint32_t capacity = w->stored_capacity + w->stored_capacity / 4 + 64;
    olx_world_brick *stored = olx_allocate(capacity, sizeof *stored);
    if (!stored) return no_memory(w);
    memcpy(stored, w->stored, w->stored_count * sizeof *stored);
    olx_release(w->stored);
    w->stored = stored;
    w->stored_capacity = capacity;
  }
  w->slots[index] = w->stored_count;
  w->stored[w->stored_count++] =
      (olx_world_brick){.reached = w->flags[index] & OPEN_REACHED ? ALL_BITS : (olx_world_bits){{0}}};
  w->flags[index] &= (uint8_t) ~(OPEN_REACHED | OPEN_OUT | OPEN_SEEN);
  return OLX_OK;
}

olx_result olx_world_leave_out(olx_world *w, const uint32_t voxel[3], const olx_world_bits *bits) {
  const uint32_t index = brick_of(w, voxel);
  if (w->slots[index] == OLX_OPEN_BRICK && count_bits(bits) == BRICK_VOXELS) {
    w->flags[index] |= OPEN_OUT;
    return OLX_OK;
  }
  if (w->slots[index] == OLX_OPEN_BRICK) OLX_TRY(store_brick(w, index));
  for (int z = 0; z < SIDE; z++) stored_brick(w, index)->out.z[z] |= bits->z[z];
  return OLX_OK;
}

// A copy of the reached voxels, to restore them.
typedef struct reached_copy {
  olx_world_bits *stored;
  uint8_t *flags;
} reached_copy;

// Turns everything that is reached into seen.
static void set_aside(olx_world *w, reached_copy *copy) {
  memcpy(copy->flags, w->flags, w->brick_total);
  for (uint32_t i = 0; i < w->brick_total; i++) {
    if (w->flags[i] & OPEN_REACHED) w->flags[i] = (uint8_t)((w->flags[i] & ~OPEN_REACHED) | OPEN_SEEN);
  }
  for (uint32_t i = 0; i < w->stored_count; i++) {
    copy->stored[i] = w->stored[i].seen = w->stored[i].reached;
    w->stored[i].reached = (olx_world_bits){{0}};
  }
}

static void restore(olx_world *w, const reached_copy *copy) {
  for (uint32_t i = 0; i < w->brick_total; i++) {
    w->flags[i] = (uint8_t)((w->flags[i] & OPEN_OUT) | (copy->flags[i] & OPEN_REACHED));
  }
  for (uint32_t i = 0; i < w->stored_count; i++) {
    w->stored[i].reached = copy->stored[i];
    w->stored[i].seen = (olx_world_bits){{0}};
  }
  w->touched_count = 0;
}

static void leave_flooded_out(olx_world *w) {
  for (uint32_t i = 0; i < w->touched_count; i++) {
    olx_world_brick *brick = stored_brick(w, w->touched[i]);
    uint8_t *flags = &w->flags[w->touched[i]];
    for (int z = 0; brick && z < SIDE; z++) {
      brick->out.z[z] |= brick->reached.z[z];
      brick->reached.z[z] = 0;
    }
    if (!brick) *flags = (uint8_t)((*flags & ~OPEN_REACHED) | OPEN_OUT);
  }
}

olx_result olx_world_sift(olx_world *w, olx_world_keeps keeps, void *user) {
  reached_copy copy = {olx_allocate(w->stored_count, sizeof *copy.stored), olx_allocate(w->brick_total, 1)};
  uint32_t brick = 0, voxel[3];
  olx_result result = copy.stored && copy.flags ? OLX_OK : no_memory(w);
  if (result == OLX_OK) set_aside(w, &copy);
  while (result == OLX_OK && olx_world_next_free(w, &brick, voxel)) {
    if (keeps(user, w, olx_world_flood(w, voxel))) olx_world_put_aside(w);
    else leave_flooded_out(w);
  }
  if (result == OLX_OK) restore(w, &copy);
  olx_release(copy.stored);
  olx_release(copy.flags);
  return result;
}

void olx_world_take_back(olx_world *w) {
  for (uint32_t i = 0; i < w->brick_total; i++) w->flags[i] &= (uint8_t)~OPEN_OUT;
  for (uint32_t i = 0; i < w->stored_count; i++) w->stored[i].out = (olx_world_bits){{0}};
}
