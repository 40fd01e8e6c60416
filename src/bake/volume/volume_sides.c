// Separates the sides of a cell, and the space outside all rooms: places spread over the cell are connected where they
// see each other, and unconnected sets of places are separated by planes of triangles between them.
#include "bake/volume/volume_sides.h"

#include "core/sampling.h"
#include "scene/bvh.h"

enum {
  LATTICE = 4, // places along each axis
  PLACES = LATTICE * LATTICE * LATTICE,
  PAIRS = 256,                                 // of places that are not connected yet and may see each other
  PLANES = 32,                                 // that are tried for a division
  DEPTH = 3,                                   // divisions one after the other
  OUTER_FACES = OLX_VOLUME_MOST_SPLITS - DEPTH // around a side
};

// The outermost places lie this share of the lift of places on surfaces within the cell: a wall that cuts off less is
// not seen, and a surface either has a cell or is lifted into the next one.
static const float INSET = 0.5f;
// Probes keep this share of a cell's side off surfaces.
static const float CLEARANCE = 1.0f / 16.0f;
// Half the diagonal of a cell and the clearance of its corners, in sides.
static const float UNTOUCHED = 0.93f;

typedef struct cell_places {
  const olx_volume_space *space;
  olx_vec3 low;
  float side, lift;
  olx_vec3 places[PLACES];
  uint8_t part[PLACES]; // a place of the same connected part, the root of a tree
  uint64_t free;        // bit n: place n is in the space that the volume covers
  uint64_t shut_out;    // bit n: it is outside that space
  olx_volume_sides *out;
} cell_places;

olx_vec3 olx_volume_corner(olx_vec3 low, float side, uint32_t corner) {
  return olx_madd(low, olx_v3((float)(corner & 1), (float)(corner >> 1 & 1), (float)(corner >> 2)), side);
}

static void spread_places(cell_places *c) {
  static const float third = 1.0f / 3.0f;
  const float inset = INSET * c->lift / c->side;
  const float steps[LATTICE] = {inset, third, 2.0f * third, 1.0f - inset};
  c->free = c->shut_out = 0;
  for (uint32_t i = 0; i < PLACES; i++) {
    const olx_vec3 step = olx_v3(steps[i % 4], steps[i / 4 % 4], steps[i / 16]);
    c->places[i] = olx_madd(c->low, step, c->side);
    c->part[i] = (uint8_t)i;
    if (olx_volume_space_holds(c->space, c->places[i])) c->free |= 1ull << i;
    else if (olx_volume_space_shuts_out(c->space, c->places[i])) c->shut_out |= 1ull << i;
  }
}

static uint32_t root_of(cell_places *c, uint32_t place) {
  while (c->part[place] != place) place = c->part[place];
  return place;
}

static void connect(cell_places *c, uint32_t a, uint32_t b) {
  if (!(c->free >> a & c->free >> b & 1)) return;
  const uint32_t i = root_of(c, a), k = root_of(c, b);
  if (i == k || !olx_bvh_is_clear(c->space->scene->bvh, c->places[a], c->places[b])) return;
  if (i < k) c->part[k] = (uint8_t)i;
  else c->part[i] = (uint8_t)k;
}

// Neighbours first, then pairs from all over the cell.
static void connect_places(cell_places *c) {
  for (uint32_t i = 0; i < PLACES; i++) {
    if (i % 4 < 3) connect(c, i, i + 1);
    if (i / 4 % 4 < 3) connect(c, i, i + 4);
    if (i / 16 < 3) connect(c, i, i + 16);
  }
  for (uint32_t i = 0; i < PAIRS; i++) {
    const uint32_t hash = olx_hash(i);
    connect(c, hash % PLACES, hash / PLACES % PLACES);
  }
  for (uint32_t i = 0; i < PLACES; i++) c->part[i] = (uint8_t)root_of(c, i);
}

// Returns the places of the part that has most of the set.
static uint64_t largest_part(const cell_places *c, uint64_t set) {
  uint64_t parts[PLACES] = {0}, best = 0;
  for (uint32_t i = 0; i < PLACES; i++) {
    if (set >> i & 1) parts[c->part[i]] |= 1ull << i;
  }
  for (uint32_t i = 0; i < PLACES; i++) {
    if (__builtin_popcountll(parts[i]) > __builtin_popcountll(best)) best = parts[i];
  }
  return best;
}

// Finds the plane of the first triangle between two places.
static bool plane_between(const olx_scene *scene, olx_vec3 from, olx_vec3 to, olx_vec3 *normal, float *offset) {
  const olx_ray ray = {from, olx_sub(to, from), 0.0f, 1.0f};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  if (hit.triangle == OLX_NO_HIT) return false;
  const uint32_t *corner = scene->indices + 3 * (size_t)hit.triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], d = scene->positions[corner[2]];
  *normal = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(d, a)));
  *offset = olx_dot(*normal, a);
  return olx_length(*normal) > 0.5f;
}

// Finds the middle of the wall between two places, or its face where its two faces are not parallel.
static bool wall_between(const cell_places *c, uint32_t a, uint32_t b, olx_vec3 *normal, float *offset) {
  olx_vec3 back;
  float back_offset;
  const olx_scene *scene = c->space->scene;
  if (!plane_between(scene, c->places[a], c->places[b], normal, offset)) return false;
  if (!plane_between(scene, c->places[b], c->places[a], &back, &back_offset)) return true;
  const float cosine = olx_dot(*normal, back);
  if (fabsf(cosine) > 0.999f) *offset = 0.5f * (*offset + (cosine > 0.0f ? back_offset : -back_offset));
  return true;
}

static uint64_t in_front(const cell_places *c, uint64_t set, olx_vec3 normal, float offset) {
  uint64_t front = 0;
  for (uint32_t i = 0; i < PLACES; i++) {
    if (set >> i & 1 && olx_dot(normal, c->places[i]) > offset) front |= 1ull << i;
  }
  return front;
}

// Finds the plane that leaves most places with their own part, if any is better than none.
static bool divide(const cell_places *c, uint64_t set, olx_volume_split *split, uint64_t *front) {
  int most = __builtin_popcountll(largest_part(c, set));
  bool found = false;
  for (uint32_t i = 0, tried = 0; i < 64 * PLANES && tried < PLANES; i++) {
    const uint32_t hash = olx_hash(i), a = hash % PLACES, b = hash / PLACES % PLACES;
    olx_vec3 normal;
    float offset;
    if (!(set >> a & set >> b & 1) || c->part[a] == c->part[b]) continue;
    tried++;
    if (!wall_between(c, a, b, &normal, &offset)) continue;
    const uint64_t before = in_front(c, set, normal, offset), behind = set & ~before;
    const int right = __builtin_popcountll(largest_part(c, before)) + __builtin_popcountll(largest_part(c, behind));
    if (right <= most || !before || !behind) continue;
    most = right;
    found = true;
    *front = before;
    *split = (olx_volume_split){.normal = {normal.x, normal.y, normal.z}, .offset = offset};
  }
  return found;
}

static olx_vec3 find_anchor(const cell_places *c, uint64_t part) {
  olx_vec3 middle = {0}, anchor = {0};
  float nearest = INFINITY;
  for (uint32_t i = 0; i < PLACES; i++) {
    if (part >> i & 1) middle = olx_add(middle, c->places[i]);
  }
  middle = olx_scale(middle, 1.0f / (float)__builtin_popcountll(part));
  for (uint32_t i = 0; i < PLACES; i++) {
    const float distance = olx_length(olx_sub(c->places[i], middle));
    if (!(part >> i & 1) || distance >= nearest) continue;
    nearest = distance;
    anchor = c->places[i];
  }
  return anchor;
}

static bool is_clear_of_surfaces(const cell_places *c, olx_vec3 place, float clearance) {
  return olx_bvh_distance(c->space->scene->bvh, place, clearance) >= clearance;
}

// Returns the place that the anchor reaches on a straight line towards a corner, a little before the surface that ends
// the line.
static olx_vec3 way_towards(const cell_places *c, olx_vec3 anchor, olx_vec3 corner) {
  const olx_vec3 way = olx_sub(corner, anchor);
  const float length = olx_length(way), margin = CLEARANCE * c->side;
  if (length <= margin) return anchor;
  const olx_ray ray = {anchor, olx_scale(way, 1.0f / length), 0.0f, length + margin};
  const olx_ray_hit hit = olx_bvh_intersect(c->space->scene->bvh, &ray);
  const float free = hit.triangle == OLX_NO_HIT ? length : hit.t;
  return olx_madd(anchor, ray.direction, olx_max(olx_min(free, length) - margin, 0.5f * free));
}

static olx_vec3 find_stand_in(const cell_places *c, uint64_t part, olx_vec3 anchor, olx_vec3 corner) {
  const float clearance = 0.5f * CLEARANCE * c->side;
  olx_vec3 best = way_towards(c, anchor, corner);
  float nearest = is_clear_of_surfaces(c, best, 0.5f * clearance) ? olx_length(olx_sub(best, corner)) : INFINITY;
  for (uint32_t i = 0; i < PLACES; i++) {
    const float distance = olx_length(olx_sub(c->places[i], corner));
    if (!(part >> i & 1) || distance >= nearest || !is_clear_of_surfaces(c, c->places[i], clearance)) continue;
    nearest = distance;
    best = c->places[i];
  }
  return best;
}

// Returns whether a corner is in the space of a side: seen from the place that is nearest to it, or from the anchor.
static bool has_corner(const cell_places *c, uint64_t part, olx_vec3 anchor, olx_vec3 corner) {
  if (!is_clear_of_surfaces(c, corner, CLEARANCE * c->side)) return false;
  uint32_t near = 0;
  float nearest = INFINITY;
  for (uint32_t i = 0; i < PLACES; i++) {
    const float distance = olx_length(olx_sub(c->places[i], corner));
    if (!(part >> i & 1) || distance >= nearest) continue;
    nearest = distance;
    near = i;
  }
  const olx_bvh *bvh = c->space->scene->bvh;
  return olx_bvh_is_clear(bvh, c->places[near], corner) || olx_bvh_is_clear(bvh, anchor, corner);
}

static uint32_t make_side(cell_places *c, uint64_t part) {
  const uint32_t number = c->out->side_count++;
  olx_volume_side *side = &c->out->sides[number];
  *side = (olx_volume_side){.anchor = find_anchor(c, part)};
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) {
    const olx_vec3 corner = olx_volume_corner(c->low, c->side, i);
    if (has_corner(c, part, side->anchor, corner)) side->corners |= 1u << i;
    else side->stand_ins[i] = find_stand_in(c, part, side->anchor, corner);
  }
  return OLX_VOLUME_CELL | number;
}

// Finds the plane of an outer face that has all places of the space in a region before it and most of those that are
// shut out behind it, or the reverse.
static bool shut_out(const cell_places *c, uint64_t region, uint64_t part, olx_volume_split *split,
                     bool *inside_before) {
  const uint64_t inside = region & c->free, outside = region & c->shut_out;
  int most = 0;
  for (uint32_t i = 0, tried = 0; outside && i < 64 * PLANES && tried < PLANES; i++) {
    const uint32_t hash = olx_hash(i), a = hash % PLACES, b = hash / PLACES % PLACES;
    olx_vec3 normal;
    float offset;
    if (!(part >> a & outside >> b & 1)) continue;
    tried++;
    if (!plane_between(c->space->scene, c->places[b], c->places[a], &normal, &offset)) continue;
    // The plane lies half a lift outside the face, so that rounding includes neither places on the face nor places in
    // its corners.
    offset += olx_dot(normal, c->places[b]) > offset ? 0.5f * c->lift : -0.5f * c->lift;
    const uint64_t before = in_front(c, inside | outside, normal, offset);
    const bool first = before >> a & 1;
    const uint64_t behind = first ? ~before : before;
    if (inside & behind || __builtin_popcountll(outside & behind) <= most) continue;
    most = __builtin_popcountll(outside & behind);
    *inside_before = first;
    *split = (olx_volume_split){.normal = {normal.x, normal.y, normal.z}, .offset = offset};
  }
  return most > 0;
}

// Builds the side of a part, and outer faces around it, one after the other: what these shut out has no cell, and no
// light from within.
static uint32_t make_shell(cell_places *c, uint64_t part, uint64_t region, uint32_t faces) {
  olx_volume_split split;
  bool inside_before;
  if (faces == 0 || !shut_out(c, region, part, &split, &inside_before)) return make_side(c, part);
  const uint32_t number = c->out->split_count++;
  const uint64_t before = in_front(c, region, olx_load3(split.normal), split.offset);
  const uint32_t inside = make_shell(c, part, region & (inside_before ? before : ~before), faces - 1);
  split.front = inside_before ? inside : 0;
  split.behind = inside_before ? 0 : inside;
  c->out->splits[number] = split;
  return OLX_VOLUME_SPLIT | number;
}

static uint32_t make_end(cell_places *c, uint64_t set, uint64_t region) {
  const uint64_t part = largest_part(c, set);
  return part ? make_shell(c, part, region, OUTER_FACES) : 0;
}

// Makes the entry of a set of places. `region` has all places on this side of the planes so far, `set` those of them
// that are in the space.
static uint32_t make_entry(cell_places *c, uint64_t set, uint64_t region, uint32_t depth) {
  olx_volume_split split;
  uint64_t front;
  if (depth == DEPTH || largest_part(c, set) == set || !divide(c, set, &split, &front)) return make_end(c, set, region);
  const uint32_t number = c->out->split_count++;
  const uint64_t before = in_front(c, region, olx_load3(split.normal), split.offset);
  split.behind = make_entry(c, set & ~front, region & ~before, depth + 1);
  split.front = make_entry(c, front, before, depth + 1);
  c->out->splits[number] = split;
  return OLX_VOLUME_SPLIT | number;
}

void olx_volume_sides_find(const olx_volume_space *space, olx_vec3 low, float side, float lift, olx_volume_sides *out) {
  cell_places c = {.space = space, .low = low, .side = side, .lift = lift, .out = out};
  *out = (olx_volume_sides){0};
  const olx_vec3 middle = olx_add(low, olx_splat(0.5f * side));
  if (olx_bvh_distance(space->scene->bvh, middle, UNTOUCHED * side) >= UNTOUCHED * side) {
    if (!olx_volume_space_holds(space, middle)) return;
    out->sides[out->side_count++] = (olx_volume_side){.anchor = middle, .corners = (1u << OLX_VOLUME_CORNERS) - 1};
    out->root = OLX_VOLUME_CELL;
    return;
  }
  spread_places(&c);
  connect_places(&c);
  out->root = make_entry(&c, c.free, ~0ull, 0);
}
