// Marches eight rays at once on vectors of eight lanes, with the arithmetic of ray_image.h, march_hiz.c and
// probe_trace.c, operation by operation. A lane takes the next ray when its own is finished.
#include "trace/march_wide.h"

#include "trace/march.h"

#if OLX_WIDE

// Two groups of lanes take turns, so that one computes while the other waits for memory. Finished lanes are renewed
// only once there are WORTH_RENEWING of them.
enum { LANES = OLX_WIDE_LANES, GROUPS = 2, WORTH_RENEWING = 2 };
#define NO_JOB UINT32_MAX

typedef struct wide_axis {
  reals begin, travel, inverse;
  words step, ahead, first;
} wide_axis;

// The jobs to trace, and their answers.
typedef struct work {
  const olx_field *field;
  const olx_probe_job *jobs;
  olx_probe_answer *answers;
  uint32_t next, count;
} work;

// The state of eight rays. A lane's level is 0 at texels and one more than the pyramid's level at nodes: a node is
// 4^level texels wide.
typedef struct lanes {
  const olx_field *field;
  // Values for each level.
  words first_node, tiles_across;

  // Rays.
  uint32_t job[LANES]; // NO_JOB: none
  olx_march march[LANES];
  addresses distances[2], nodes[2]; // of four lanes each
  reals ox, oy, oz, dx, dy, dz, t_min, t_max, closest, miss_squared;
  // Bits of lanes: those that march, and those that have finished a piece. All other lanes have no ray.
  uint32_t walking, waiting;

  // Pieces.
  wide_axis u, v;
  reals t_begin, t_end, rise, near, slope, sign_x, sign_y, sign_z, slack;

  // The place that the march has reached.
  words x, y, level, by_v;
  reals s, t, node_least_squared;
  words steps;
} lanes;

// These are plane_at, next_cut and sign_after of probe_trace.c, eight lanes wide.
WIDE reals plane_at(reals o, reals d) { return pick(d == 0.0f, splat(-INFINITY), -o / d); }

WIDE reals cut_at(reals plane, reals t, reals next) { return pick(plane > t, least(next, plane), next); }

WIDE reals sign_after(reals o, reals d, reals plane, reals t) {
  const reals moving = sign_not_zero(d);
  return pick(d == 0.0f, sign_not_zero(o), pick(t >= plane, moving, -moving));
}

typedef struct wide_end {
  reals u, v, inverse;
  words centre;
} wide_end;

WIDE wide_end end_at(const lanes *l, reals sign_x, reals sign_y, reals sign_z, reals t) {
  const words infinite = t == INFINITY;
  const reals x = sign_x * pick(infinite, l->dx, l->ox + l->dx * t), y = pick(infinite, l->dy, l->oy + l->dy * t),
              z = sign_z * pick(infinite, l->dz, l->oz + l->dz * t), sum = x + sign_y * y + z;
  const reals closest = OLX_CENTRE_SHARE * (magnitude(l->ox) + magnitude(l->oy) + magnitude(l->oz));
  const words centre = ~infinite & (sum <= closest), upper = sign_y > 0.0f;
  const reals inverse = 1.0f / pick(centre, most(closest, splat(0x1p-100f)), sum);
  const float half = 0.5f * (float)l->field->n;
  const reals across = x * inverse, along = z * inverse, zero = splat(0.0f), one = splat(1.0f);
  return (wide_end){.u = half + half * sign_x * clamped(pick(upper, across, 1.0f - along), zero, one),
                    .v = half + half * sign_z * clamped(pick(upper, along, 1.0f - across), zero, one),
                    .inverse = pick(infinite, zero, inverse),
                    .centre = centre};
}

WIDE void set_axis(wide_axis *a, words which, reals begin, reals end, reals sign, uint32_t n) {
  const int32_t half = (int32_t)n / 2;
  const words lowest = (sign > 0.0f) & half, last = lowest + (half - 1);
  const words first = pick_word(begin > real(last), last, pick_word(begin > real(lowest), truncated(begin), lowest));
  const reals travel = end - begin;
  const words moving = magnitude(travel) > OLX_STILL_TEXELS, forward = travel > 0.0f;
  const reals inverse = pick(moving, (1.0f + 0x1p-21f) / travel, splat(OLX_NEVER));
  a->begin = pick(which, pick(moving, begin, real(first) + 0.5f), a->begin);
  a->travel = pick(which, (reals)(moving & (words)travel), a->travel);
  a->inverse = pick(which, inverse, a->inverse);
  a->step = pick_word(which, moving & (-2 * forward - 1), a->step);
  a->ahead = pick_word(which, (~moving | forward) & 1, a->ahead);
  a->first = pick_word(which, first, a->first);
}

// Sets the next piece of the lanes in `which`; it begins where the last one ended.
WIDE void set_pieces(lanes *l, words which) {
  const reals t_begin = l->t_end;
  const reals plane_x = plane_at(l->ox, l->dx), plane_y = plane_at(l->oy, l->dy), plane_z = plane_at(l->oz, l->dz);
  const reals t_end = cut_at(plane_z, t_begin, cut_at(plane_y, t_begin, cut_at(plane_x, t_begin, l->t_max)));
  const reals sign_x = sign_after(l->ox, l->dx, plane_x, t_begin), sign_y = sign_after(l->oy, l->dy, plane_y, t_begin),
              sign_z = sign_after(l->oz, l->dz, plane_z, t_begin);
  wide_end begin = end_at(l, sign_x, sign_y, sign_z, t_begin), end = end_at(l, sign_x, sign_y, sign_z, t_end);
  const words still = begin.centre | end.centre;
  begin.u = pick(begin.centre, end.u, begin.u);
  begin.v = pick(begin.centre, end.v, begin.v);
  end.u = pick(still, begin.u, end.u);
  end.v = pick(still, begin.v, end.v);
  set_axis(&l->u, which, begin.u, end.u, sign_x, l->field->n);
  set_axis(&l->v, which, begin.v, end.v, sign_z, l->field->n);
  const words finite = t_end < INFINITY;
  const reals rise =
      pick(finite, (t_end - t_begin) * end.inverse, 1.0f / (sign_x * l->dx + sign_y * l->dy + sign_z * l->dz));
  l->t_begin = pick(which, t_begin, l->t_begin);
  l->t_end = pick(which, t_end, l->t_end);
  l->rise = pick(which, rise, l->rise);
  l->near = pick(which, begin.inverse, l->near);
  l->slope = pick(which, end.inverse - begin.inverse, l->slope);
  l->sign_x = pick(which, sign_x, l->sign_x);
  l->sign_y = pick(which, sign_y, l->sign_y);
  l->sign_z = pick(which, sign_z, l->sign_z);
  l->slack = pick(which, OLX_PARAMETER_ROUNDING * (reals)(finite & (words)t_end), l->slack);

  const int32_t top = (int32_t)l->field->pyramid.levels;
  const words begin_level = pick_word(t_begin <= l->t_min, splat_word(1), splat_word(top)), shift = 2 * begin_level;
  l->level = pick_word(which, begin_level, l->level);
  l->x = pick_word(which, l->u.first >> shift, l->x);
  l->y = pick_word(which, l->v.first >> shift, l->y);
  l->s = pick(which, splat(-1.0f), l->s);
  l->t = pick(which, t_begin, l->t);
  l->by_v = ~which & l->by_v;
}

WIDE olx_image_axis axis_of(const wide_axis *a, uint32_t lane) {
  return (olx_image_axis){.begin = a->begin[lane],
                          .travel = a->travel[lane],
                          .inverse = a->inverse[lane],
                          .step = a->step[lane],
                          .ahead = a->ahead[lane],
                          .first = a->first[lane]};
}

WIDE olx_piece piece_of(const lanes *l, uint32_t lane) {
  return (olx_piece){.u = axis_of(&l->u, lane),
                     .v = axis_of(&l->v, lane),
                     .t_begin = l->t_begin[lane],
                     .t_end = l->t_end[lane],
                     .rise = l->rise[lane],
                     .near = l->near[lane],
                     .slope = l->slope[lane],
                     .sign_x = l->sign_x[lane],
                     .sign_y = l->sign_y[lane],
                     .sign_z = l->sign_z[lane],
                     .slack = l->slack[lane]};
}

// Gives a lane the next ray that is not empty; false when there is none.
WIDE bool take_job(work *w, lanes *l, uint32_t lane) {
  for (; w->next < w->count; w->next++) {
    const olx_probe_ray *ray = &w->jobs[w->next].ray;
    if (ray->t_min < ray->t_max) break;
    w->answers[w->next] = olx_probe_clear(w->field, ray, 0);
  }
  if (w->next == w->count) return false;
  const olx_probe_job *job = &w->jobs[w->next];
  olx_march *m = &l->march[lane];
  *m = olx_begin_march(w->field, job->probe, &job->ray);
  l->job[lane] = w->next++;
  l->distances[lane / 4][lane % 4] = (int64_t)(m->geometry ? m->least : m->distance); // blocks are not read through it
  l->nodes[lane / 4][lane % 4] = (int64_t)m->least;
  l->ox[lane] = job->ray.origin.x, l->oy[lane] = job->ray.origin.y, l->oz[lane] = job->ray.origin.z;
  l->dx[lane] = job->ray.direction.x, l->dy[lane] = job->ray.direction.y, l->dz[lane] = job->ray.direction.z;
  l->t_min[lane] = l->t_end[lane] = job->ray.t_min; // the first piece begins here
  l->t_max[lane] = job->ray.t_max;
  l->closest[lane] = m->closest;
  l->miss_squared[lane] = m->miss_squared;
  l->steps[lane] = 0;
  return true;
}

WIDE uint32_t steps_of(const lanes *l, uint32_t lane) { return (uint32_t)l->steps[lane] + l->march[lane].steps; }

WIDE void finish(work *w, lanes *l, uint32_t lane, olx_verdict verdict, olx_probe_answer answer) {
  answer.status = verdict == OLX_VERDICT_HIT ? OLX_TRACE_HIT : OLX_TRACE_UNKNOWN;
  answer.steps = steps_of(l, lane);
  w->answers[l->job[lane]] = answer;
  l->job[lane] = NO_JOB;
  l->walking &= ~(1u << lane);
  l->waiting |= 1u << lane;
}

// Moves waiting lanes to the next piece of their ray, or to another ray.
WIDE void renew(work *w, lanes *l) {
  while (l->waiting) {
    uint32_t handed_on = 0;
    for (uint32_t left = l->waiting; left; left &= left - 1) {
      const uint32_t lane = (uint32_t)__builtin_ctz(left);
      if (l->job[lane] != NO_JOB) {
        if (l->t_end[lane] < l->t_max[lane]) continue;
        w->answers[l->job[lane]] = olx_probe_clear(w->field, l->march[lane].ray, steps_of(l, lane));
        l->job[lane] = NO_JOB;
      }
      if (!take_job(w, l, lane)) l->waiting &= ~(1u << lane);
      else if (l->t_min[lane] > 0.0f) handed_on |= 1u << lane;
    }
    set_pieces(l, mask_of(l->waiting));
    l->walking |= l->waiting;
    l->waiting = 0;
    for (; handed_on; handed_on &= handed_on - 1) { // the first texel often hides these
      const uint32_t lane = (uint32_t)__builtin_ctz(handed_on);
      const olx_piece p = piece_of(l, lane);
      olx_probe_answer answer = {.status = OLX_TRACE_MISS};
      const olx_verdict verdict = olx_visit_first(&l->march[lane], &p, &answer);
      if (verdict != OLX_VERDICT_CLEAR) finish(w, l, lane, verdict, answer);
    }
  }
}

// Reads the 16 bits of each lane's node or texel; the result is undefined for lanes at geometry blocks.
WIDE words codes_at(const lanes *l, words texel, words block) {
  const words x = l->x, y = l->y, first = __builtin_ia32_permvarsi256(l->first_node, l->level),
              tiles = __builtin_ia32_permvarsi256(l->tiles_across, l->level);
  const words node = first + ((((y >> 2) * tiles + (x >> 2)) << 4) + ((y & 3) << 2) + (x & 3));
  const words index = pick_word(texel, (y + 1) * (int32_t)l->field->stride + x + 1, node) & ~block;
  words code;
  for (uint32_t half = 0; half < 2; half++) {
    const four_words i =
        half ? __builtin_shufflevector(index, index, 4, 5, 6, 7) : __builtin_shufflevector(index, index, 0, 1, 2, 3);
    const four_words is_texel =
        half ? __builtin_shufflevector(texel, texel, 4, 5, 6, 7) : __builtin_shufflevector(texel, texel, 0, 1, 2, 3);
    const addresses from = __builtin_convertvector(is_texel, addresses),
                    map = (from & l->distances[half]) | (~from & l->nodes[half]);
    const addresses at = map + __builtin_convertvector(i, addresses) * 2;
    for (uint32_t k = 0; k < 4; k++) code[half * 4 + k] = *(const uint16_t *)at[k];
  }
  return code & 0x7FFF;
}

WIDE reals crossing(const wide_axis *a, words line) { return (real(line) - a->begin) * a->inverse; }

// This is olx_texel_at, eight lanes wide.
WIDE words texel_at(const wide_axis *a, reals s, words inclusive) {
  const words guess = truncated(a->begin + a->travel * s), before = (guess - a->first) * a->step <= 0;
  const words x = pick_word(before, a->first, guess);
  const reals entered = crossing(a, x + 1 - a->ahead), left = crossing(a, x + a->ahead);
  const words in = before | (entered < s) | (inclusive & (entered == s)), out = (left < s) | (inclusive & (left == s));
  return x + (a->step & out) - (a->step & ~(in | out));
}

// What lanes find at their node or texel, which they leave at s1, t1.
typedef struct wide_look {
  reals s1, t1, stored, least_squared;
  words by_v;
  uint32_t clear, at_end, at_texel; // bits of lanes; clear: in front of the whole node or texel
} wide_look;

WIDE wide_look look(lanes *l) {
  const words shift = l->level * 2, texel = l->level == 0;
  const reals su = crossing(&l->u, (l->x + l->u.ahead) << shift), sv = crossing(&l->v, (l->y + l->v.ahead) << shift);
  const reals s1 = least(su, sv);
  const words at_end = s1 >= 1.0f;
  const reals t1 = pick(at_end, l->t_end, l->t_begin + l->rise * s1 / (l->near + l->slope * s1));
  const reals begin = l->t - l->closest, end = t1 - l->closest;
  const reals far_squared = most(l->miss_squared + begin * begin, l->miss_squared + end * end);
  const reals along = most(-begin, end) + l->slack;
  const reals reach_squared = (l->miss_squared + along * along) * (1.0f + 0x1p-16f);
  const words block = (l->level <= 1) & (l->field->geometry ? -1 : 0); // of geometry, which visit_blocks reads
  const words code = codes_at(l, texel, block);
  const reals stored = (reals)(code << 13) * 0x1p112f * l->field->distance_scale, least_squared = stored * stored;
  const words passed = texel & (far_squared < l->node_least_squared); // passed without a read
  l->steps += mask_of(l->walking) & (1 + passed) & ~block;
  const words clear =
      passed | (texel & (code == 0x7C00)) | ((pick(texel, far_squared, reach_squared) < least_squared) & ~block);
  return (wide_look){.s1 = s1,
                     .t1 = t1,
                     .stored = stored,
                     .least_squared = least_squared,
                     .by_v = su > sv,
                     .clear = bits(clear) & l->walking,
                     .at_end = bits(at_end),
                     .at_texel = bits(texel) & l->walking};
}

// Reads the geometry blocks that lanes have reached. Lanes in front of all planes of their block continue; the others
// visit its texels, and are finished where that ends their ray.
WIDE void visit_blocks(work *w, lanes *l, wide_look *seen) {
  const uint32_t which = bits(l->level == 1) & l->walking;
  if (!which) return;
  reals base[2] = {splat(0.0f), splat(0.0f)}, slope[2] = {splat(0.0f), splat(0.0f)};
  uint32_t pooled = 0;
  for (uint32_t left = which; left; left &= left - 1) {
    const uint32_t lane = (uint32_t)__builtin_ctz(left);
    olx_march *m = &l->march[lane];
    olx_read_block(m, l->x[lane], l->y[lane]);
    const uint32_t form = m->block->words[3] >> 30, second = form == OLX_GEOMETRY_TWO;
    pooled |= (uint32_t)(form > OLX_GEOMETRY_TWO) << lane;
    base[0][lane] = m->planes[0].base, slope[0][lane] = m->planes[0].slope;
    base[1][lane] = m->planes[second].base, slope[1][lane] = m->planes[second].slope;
  }
  const reals begin = l->t - l->slack, end = seen->t1 + l->slack;
  words behind = splat_word(0);
  for (uint32_t k = 0; k < 2; k++) { // as in olx_plane_clears; 0 times infinity is never behind
    behind |= (base[k] + slope[k] * begin > 1.0f) | (base[k] + slope[k] * end > 1.0f);
  }
  seen->clear |= which & ~(bits(behind) | pooled);
  // olx_visit_block also judges blocks whose planes lie in the pool.
  for (uint32_t left = which & ~seen->clear; left; left &= left - 1) {
    const uint32_t lane = (uint32_t)__builtin_ctz(left);
    const olx_piece p = piece_of(l, lane);
    olx_probe_answer answer = {.status = OLX_TRACE_MISS};
    const olx_verdict verdict = olx_visit_block(&l->march[lane], &p, l->x[lane], l->y[lane], l->s[lane], l->t[lane],
                                                l->by_v[lane] != 0, seen->t1[lane], &answer);
    if (verdict == OLX_VERDICT_CLEAR) seen->clear |= 1u << lane;
    else finish(w, l, lane, verdict, answer);
  }
}

// Judges the surfels of texels that are not clear, and finishes lanes whose ray they end.
WIDE void judge(work *w, lanes *l, wide_look *seen) {
  for (uint32_t which = seen->at_texel & ~seen->clear; which; which &= which - 1) {
    const uint32_t lane = (uint32_t)__builtin_ctz(which);
    const olx_piece p = piece_of(l, lane);
    olx_probe_answer answer = {.status = OLX_TRACE_MISS};
    const olx_cell cell = {l->x[lane], l->y[lane], l->t[lane]};
    const olx_verdict verdict =
        olx_judge_surfel(&l->march[lane], &p, cell, seen->t1[lane], seen->stored[lane], &answer);
    if (verdict == OLX_VERDICT_CLEAR) seen->clear |= 1u << lane;
    else finish(w, l, lane, verdict, answer);
  }
}

// Prefetches what the texels of a node and a surfel among them will read: four rows and a normal.
WIDE void fetch_ahead(const lanes *l, uint32_t lane) {
  const olx_march *m = &l->march[lane];
  const int32_t x = l->x[lane], y = l->y[lane], first_row = y & ~3;
  for (int32_t row = 0; row < 4; row++) {
    __builtin_prefetch(m->distance + olx_map_index(m->field->stride, x, first_row + row));
  }
  __builtin_prefetch(m->field->normal + m->field->texels * m->probe + olx_map_index(m->field->stride, x, y));
}

// Moves lanes. Those whose node is clear go on to the next node, ascend where that has another parent, or wait at the
// end of the piece. All others descend.
WIDE void move(lanes *l, const wide_look *seen) {
  const uint32_t ended = seen->clear & seen->at_end;
  l->waiting |= ended;
  l->walking &= ~ended;
  const words forward = mask_of(seen->clear & ~ended), down = mask_of(l->walking & ~seen->clear & ~seen->at_texel);
  const int32_t levels = (int32_t)l->field->pyramid.levels;
  const words next_x = l->x + (l->u.step & ~seen->by_v), next_y = l->y + (l->v.step & seen->by_v);
  const words moved = (next_x ^ l->x) | (next_y ^ l->y);
  const words up = ((moved >> 2) != 0) & (l->level < levels),
              up_again = ((moved >> 4) != 0) & (l->level < (levels > 1));
  const words above = -up - up_again, level = l->level + pick_word(forward, above, down), shift = above * 2,
              below = level * 2;
  const words child_x = texel_at(&l->u, l->s, splat_word(-1)) >> below,
              child_y = texel_at(&l->v, l->s, l->by_v) >> below;
  l->x = pick_word(forward, next_x >> shift, pick_word(down, child_x, l->x));
  l->y = pick_word(forward, next_y >> shift, pick_word(down, child_y, l->y));
  l->level = pick_word(forward | down, level, l->level);
  l->s = pick(forward, seen->s1, l->s);
  l->t = pick(forward, seen->t1, l->t);
  l->by_v = pick_word(forward, seen->by_v, l->by_v);
  const words to_texels = down & (level == 0);
  l->node_least_squared = pick(to_texels, seen->least_squared, l->node_least_squared);
  for (uint32_t left = bits(to_texels); left; left &= left - 1) fetch_ahead(l, (uint32_t)__builtin_ctz(left));
}

WIDE void begin_lanes(lanes *l, const olx_field *field) {
  l->field = field;
  l->waiting = (1u << LANES) - 1;
  for (uint32_t k = 0; k < field->pyramid.levels; k++) {
    l->first_node[k + 1] = (int32_t)field->pyramid.first[k];
    l->tiles_across[k + 1] = (int32_t)(field->pyramid.side[k] >> 2);
  }
  for (uint32_t lane = 0; lane < LANES; lane++) {
    l->job[lane] = NO_JOB;
    l->distances[lane / 4][lane % 4] = (int64_t)(field->geometry ? field->least : field->distance);
    l->nodes[lane / 4][lane % 4] = (int64_t)field->least;
  }
}

WIDE_CODE void olx_march_wide(const olx_field *field, const olx_probe_job *jobs, uint32_t count,
                              olx_probe_answer *answers) {
  work w = {.field = field, .jobs = jobs, .answers = answers, .count = count};
  lanes group[GROUPS] = {0};
  for (uint32_t g = 0; g < GROUPS; g++) begin_lanes(&group[g], field);
  for (;;) {
    bool going[GROUPS], any = false;
    for (uint32_t g = 0; g < GROUPS; g++) {
      lanes *l = &group[g];
      if (!l->walking || __builtin_popcount(l->waiting) >= WORTH_RENEWING) renew(&w, l);
      going[g] = l->walking != 0;
      any |= going[g];
    }
    if (!any) return;
    wide_look seen[GROUPS];
    for (uint32_t g = 0; g < GROUPS; g++) {
      if (going[g]) seen[g] = look(&group[g]);
    }
    for (uint32_t g = 0; g < GROUPS; g++) {
      if (!going[g]) continue;
      if (field->geometry) visit_blocks(&w, &group[g], &seen[g]);
      else judge(&w, &group[g], &seen[g]);
    }
    for (uint32_t g = 0; g < GROUPS; g++) {
      if (going[g]) move(&group[g], &seen[g]);
    }
  }
}

bool olx_march_wide_available(const olx_field *field) { return olx_wide_available() && field->pyramid.side[0] >= 4; }

#endif
