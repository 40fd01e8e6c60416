// Simulates a bake on many machines: what its units took in a real bake, scaled to more probes, is dealt to the
// machines by the rule that deals real units (work/unit_deal.h), in simulated time.
//
//   farm-simulation UNITS.jsonl PROBES NODES [MB_A_SECOND] [LOADING_SECONDS] [CLOCK_FACTOR] [PLAN_SECONDS]
//
// UNITS.jsonl is what `octalux bake --fresh --keep-work --progress=json` printed. The stages follow each other as
// there. A stage's further units take what measured units took, chosen at random; light field probes number PROBES, and
// what is computed for all probes at once grows with them, unless PLAN_SECONDS tells what the plan takes. The light of
// the scene grows like the probes until its links fill the memory that they may take. Each node reads and writes
// MB_A_SECOND (default 500) and loads the scene for LOADING_SECONDS (default 5). CLOCK_FACTOR is for units that were
// timed on a busy machine: the processor time of that bake as a share of its time by the clock.
#include "light/scene_light.h"
#include "options.h"
#include "studies.h"
#include "work/unit_deal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = BENCH_PROGRAM " farm-simulation";

enum { MOST_STAGES = 64, MOST_NODES = 1 << 12, LONGEST_NAME = 16 };

#define SHORTEST_PAUSE_SECONDS 0.001 // between two looks at what a node waits for, as octalux-bake-mpi does
#define LONGEST_PAUSE_SECONDS 0.1

// How nodes go on from a stage.
typedef enum stage_kind {
  STAGE_ONCE,  // one unit, which every node loads before it goes on
  STAGE_AWAIT, // nodes go on when all units are stored
  STAGE_SHARE  // nodes go on when they have nothing to compute; the field needs it
} stage_kind;

typedef struct unit_cost {
  double seconds, bytes;
} unit_cost;

typedef struct sim_stage {
  char name[LONGEST_NAME];
  uint32_t round, measured, capacity, count;
  stage_kind kind;
  unit_cost *costs;      // of measured units
  double factor;         // costs of one unit in the large bake, as a multiple of measured ones
  double *finished;      // by unit: when its result was stored; infinite before it is begun
  uint32_t begun;        // units
  double last;           // when the last one that was begun is stored
  double waited, worked; // node-seconds
  double twice;          // of `worked`, for units that another node had begun
} sim_stage;

typedef struct node {
  olx_unit_deal deal;
  double time, waiting_since; // waiting_since: negative unless it waits
  uint32_t stage;
  bool dealt, done;
} node;

typedef struct simulation {
  sim_stage stages[MOST_STAGES];
  uint32_t stage_count, node_count;
  double bytes_a_second, loading_seconds;
  node nodes[MOST_NODES];
  double now;          // time at which is_stored is asked
  double read_seconds; // node-seconds of reading
  double end;          // of the last node, before the units are collected
} simulation;

// ---- What was measured

static stage_kind kind_of(const char *name) {
  static const char *const of_light[] = {"cast", "direct", "final", "record"};
  if (strcmp(name, "plan") == 0 || strcmp(name, "light") == 0) return STAGE_ONCE;
  for (size_t i = 0; i < sizeof of_light / sizeof *of_light; i++) {
    if (strcmp(name, of_light[i]) == 0) return STAGE_AWAIT;
  }
  return STAGE_SHARE;
}

static sim_stage *stage_for(simulation *s, const char *name, uint32_t round) {
  for (uint32_t i = 0; i < s->stage_count; i++) {
    if (strcmp(s->stages[i].name, name) == 0 && s->stages[i].round == round) return &s->stages[i];
  }
  if (s->stage_count == MOST_STAGES) return NULL;
  sim_stage *stage = &s->stages[s->stage_count++];
  *stage = (sim_stage){.round = round, .kind = kind_of(name), .factor = 1.0};
  snprintf(stage->name, sizeof stage->name, "%s", name);
  return stage;
}

static bool add_cost(sim_stage *stage, unit_cost cost) {
  if (stage->measured == stage->capacity) {
    stage->capacity = stage->capacity ? 2 * stage->capacity : 64;
    unit_cost *larger = realloc(stage->costs, stage->capacity * sizeof *larger);
    if (!larger) return false;
    stage->costs = larger;
  }
  stage->costs[stage->measured++] = cost;
  return true;
}

// Reads the lines of units that were made; returns whether there were any, up to the probes.
static bool read_units(simulation *s, FILE *file, double clock_factor) {
  char line[512], name[LONGEST_NAME], found[8];
  while (fgets(line, sizeof line, file)) {
    uint32_t round, unit, count;
    unit_cost cost;
    if (sscanf(line,
               "{\"stage\":\"%15[a-z]\",\"round\":%u,\"unit\":%u,\"count\":%u,\"found\":%7[a-z],\"seconds\":%lf,"
               "\"bytes\":%lf}",
               name, &round, &unit, &count, found, &cost.seconds, &cost.bytes) != 7 ||
        strcmp(found, "false") != 0)
      continue;
    sim_stage *stage = stage_for(s, name, round);
    cost.seconds *= clock_factor;
    if (!stage || !add_cost(stage, cost)) return false;
  }
  return s->stage_count > 0 && strcmp(s->stages[s->stage_count - 1].name, "probe") == 0;
}

static double total_of(const sim_stage *stage, bool bytes) {
  double sum = 0.0;
  for (uint32_t i = 0; i < stage->measured; i++) sum += bytes ? stage->costs[i].bytes : stage->costs[i].seconds;
  return sum;
}

static double link_bytes(const simulation *s) {
  double sum = 0.0;
  for (uint32_t i = 0; i < s->stage_count; i++) {
    if (strcmp(s->stages[i].name, "cast") == 0) sum += total_of(&s->stages[i], true);
  }
  return sum;
}

// Sets how many units each stage of the large bake has, and what one costs.
static bool scale(simulation *s, double probes, double plan_seconds) {
  const double ratio = probes / s->stages[s->stage_count - 1].measured;
  const double most_link_bytes = (double)olx_scene_light_most_link_bytes();
  const double room = fmax(1.0, most_link_bytes / fmax(1.0, link_bytes(s)));
  const double surface = fmin(ratio, room);
  for (uint32_t i = 0; i < s->stage_count; i++) {
    sim_stage *stage = &s->stages[i];
    const bool of_light = stage->kind == STAGE_AWAIT || strcmp(stage->name, "light") == 0;
    const double growth = of_light ? surface : strcmp(stage->name, "facts") == 0 ? 1.0 : ratio;
    const bool in_units = stage->kind == STAGE_AWAIT || strcmp(stage->name, "probe") == 0 ||
                          strcmp(stage->name, "classic") == 0 || strcmp(stage->name, "volume") == 0;
    stage->count = in_units ? (uint32_t)ceil(stage->measured * growth) : stage->measured;
    stage->factor = growth * stage->measured / stage->count;
    if (strcmp(stage->name, "plan") == 0 && plan_seconds > 0.0) stage->costs[0].seconds = plan_seconds / stage->factor;
    stage->finished = malloc(stage->count * sizeof *stage->finished);
    if (!stage->finished) return false;
    for (uint32_t unit = 0; unit < stage->count; unit++) stage->finished[unit] = INFINITY;
  }
  return true;
}

static unit_cost cost_of(const sim_stage *stage, uint32_t unit) {
  uint32_t chosen = unit * UINT32_C(2654435761);
  chosen = (chosen ^ chosen >> 15) * UINT32_C(2246822519);
  const unit_cost cost = stage->costs[(chosen ^ chosen >> 13) % stage->measured];
  return (unit_cost){cost.seconds * stage->factor, cost.bytes * stage->factor};
}

static double stage_bytes(const sim_stage *stage) {
  double sum = 0.0;
  for (uint32_t unit = 0; unit < stage->count; unit++) sum += cost_of(stage, unit).bytes;
  return sum;
}

// ---- Nodes in simulated time

typedef struct look {
  const simulation *simulation;
  const sim_stage *stage;
} look;

static bool is_stored(const void *user, uint32_t unit) {
  const look *l = user;
  return l->stage->finished[unit] <= l->simulation->now;
}

// The seconds for which the node that makes a step of the light reads the links of the round before it.
static double read_before(const simulation *s, uint32_t stage) {
  if (stage == 0 || s->stages[stage - 1].kind != STAGE_AWAIT) return 0.0;
  return stage_bytes(&s->stages[stage - 1]) / s->bytes_a_second;
}

static void work(simulation *s, node *n, uint32_t unit) {
  sim_stage *stage = &s->stages[n->stage];
  const unit_cost cost = cost_of(stage, unit);
  const double reading = stage->kind == STAGE_ONCE ? read_before(s, n->stage) : 0.0;
  const double seconds = reading + cost.seconds + cost.bytes / s->bytes_a_second;
  n->time += seconds;
  s->read_seconds += reading;
  if (stage->finished[unit] < INFINITY) stage->twice += seconds;
  else stage->begun++;
  stage->worked += seconds;
  if (n->time < stage->finished[unit]) stage->finished[unit] = n->time;
  if (stage->finished[unit] > stage->last) stage->last = stage->finished[unit];
}

// Lets the node wait for the whole stage; returns whether it is there.
static bool wait_for(simulation *s, node *n, sim_stage *stage) {
  if (stage->begun == stage->count && stage->last <= n->time) return n->waiting_since = -1.0, true;
  if (n->waiting_since < 0.0) n->waiting_since = n->time;
  const double pause = fmin(fmax(0.1 * (n->time - n->waiting_since), SHORTEST_PAUSE_SECONDS), LONGEST_PAUSE_SECONDS);
  n->time += pause;
  stage->waited += pause;
  (void)s;
  return false;
}

static void go_on(simulation *s, node *n) {
  n->stage++;
  n->dealt = false;
  n->done = n->stage == s->stage_count;
}

static void visit_once(simulation *s, node *n, sim_stage *stage) {
  if (stage->begun == 0 && olx_unit_is_dealt(&n->deal, 0)) {
    work(s, n, 0);
    go_on(s, n);
  } else if (wait_for(s, n, stage)) {
    const double seconds = stage_bytes(stage) / s->bytes_a_second;
    n->time += seconds;
    s->read_seconds += seconds;
    go_on(s, n);
  }
}

// Lets the node do the next thing: compute a unit, wait a little, or go on to the next stage.
static void visit(simulation *s, node *n) {
  sim_stage *stage = &s->stages[n->stage];
  const uint32_t part = (uint32_t)(n - s->nodes) + 1;
  uint32_t unit;
  s->now = n->time;
  if (!n->dealt) n->deal = olx_unit_deal_begin(stage->name, stage->round, stage->count, part, s->node_count);
  n->deal.helps = true;
  n->dealt = true;
  if (stage->kind == STAGE_ONCE) visit_once(s, n, stage);
  else if (olx_unit_deal_next(&n->deal, is_stored, &(look){s, stage}, &unit)) work(s, n, unit);
  else if (stage->kind == STAGE_SHARE || wait_for(s, n, stage)) go_on(s, n);
}

static void run(simulation *s) {
  for (uint32_t i = 0; i < s->node_count; i++) s->nodes[i] = (node){.time = s->loading_seconds, .waiting_since = -1.0};
  for (;;) {
    node *next = NULL;
    for (uint32_t i = 0; i < s->node_count; i++) {
      node *n = &s->nodes[i];
      if (!n->done && (!next || n->time < next->time)) next = n;
    }
    if (!next) break;
    visit(s, next);
  }
  for (uint32_t i = 0; i < s->node_count; i++) s->end = fmax(s->end, s->nodes[i].time);
}

// ---- The report

typedef struct totals {
  double work, bytes, chain,
      solver_bytes; // seconds of all units; their bytes; seconds of single units; memory of light
  double field_bytes;
} totals;

static totals add_up(const simulation *s) {
  totals t = {0};
  for (uint32_t i = 0; i < s->stage_count; i++) {
    const sim_stage *stage = &s->stages[i];
    double seconds = 0.0, bytes = stage_bytes(stage);
    for (uint32_t unit = 0; unit < stage->count; unit++) seconds += cost_of(stage, unit).seconds;
    t.work += seconds;
    t.bytes += bytes;
    if (stage->count == 1) t.chain += seconds;
    if (strcmp(stage->name, "cast") == 0) t.solver_bytes += bytes;
    if (stage->kind == STAGE_SHARE) t.field_bytes += bytes;
  }
  return t;
}

static void print_stages(const simulation *s, double node_seconds) {
  printf("%-12s %5s %8s %12s %10s %10s %10s\n", "stage", "round", "units", "seconds each", "work %", "twice %",
         "waiting %");
  for (uint32_t i = 0; i < s->stage_count; i++) {
    const sim_stage *stage = &s->stages[i];
    printf("%-12s %5u %8u %12.3f %10.2f %10.2f %10.2f\n", stage->name, stage->round, stage->count,
           total_of(stage, false) * stage->factor / stage->measured, 100.0 * stage->worked / node_seconds,
           100.0 * stage->twice / node_seconds, 100.0 * stage->waited / node_seconds);
  }
}

static void report(const simulation *s) {
  const totals t = add_up(s);
  const double collecting = 2.0 * t.field_bytes / s->bytes_a_second, end = s->end + collecting;
  const double alone = s->loading_seconds + t.work + (t.bytes + t.field_bytes) / s->bytes_a_second;
  const double node_seconds = s->node_count * end;
  double idle = s->node_count * s->end;
  for (uint32_t i = 0; i < s->node_count; i++) idle -= s->nodes[i].time;
  print_stages(s, node_seconds);
  printf("one node      %.0f s: %.0f s of units, %.1f GB to write, %.1f GB of them the field\n", alone, t.work,
         t.bytes * 1e-9, t.field_bytes * 1e-9);
  printf("%4u nodes    %.0f s, of which one node collects the field for %.0f s\n", s->node_count, end, collecting);
  printf("efficiency    %.1f %%; %.1f %% until the field is collected\n", 100.0 * alone / node_seconds,
         100.0 * (alone - collecting) / (s->node_count * s->end));
  printf("of node time  loading %.2f %%, reading %.2f %%, idle at the end %.2f %%, while the "
         "field is collected %.2f %%\n",
         100.0 * s->node_count * s->loading_seconds / node_seconds, 100.0 * s->read_seconds / node_seconds,
         100.0 * idle / node_seconds, 100.0 * (s->node_count - 1) * collecting / node_seconds);
  printf("serial chain  %.0f s of single units; the solver holds %.2f GB of links\n", t.chain, t.solver_bytes * 1e-9);
  printf("file server   %.0f MB/s on average\n", t.bytes * 1e-6 / s->end);
}

static double number(int argc, char **argv, int at, double otherwise) { return at < argc ? atof(argv[at]) : otherwise; }

int study_farm_simulation(int argc, char **argv) {
  const double probes = atof(argv[2]), nodes = atof(argv[3]), factor = number(argc, argv, 6, 1.0);
  if (!(probes >= 1.0 && probes <= 1e7 && nodes >= 1.0 && nodes <= MOST_NODES && factor > 0.0))
    return usage_error(NAME, "PROBES is from 1 to 10000000, NODES from 1 to %d, CLOCK_FACTOR above 0", MOST_NODES);
  simulation *s = calloc(1, sizeof *s);
  FILE *file = fopen(argv[1], "r");
  int code = EXIT_DONE;
  if (s) {
    s->node_count = (uint32_t)nodes;
    s->bytes_a_second = 1e6 * fmax(1e-3, number(argc, argv, 4, 500.0));
    s->loading_seconds = number(argc, argv, 5, 5.0);
  }
  if (!s || !file) code = failure(NAME, "%s: cannot open", argv[1]);
  else if (!read_units(s, file, factor)) code = failure(NAME, "%s: not the units of a whole bake", argv[1]);
  else if (!scale(s, probes, number(argc, argv, 7, 0.0))) code = failure(NAME, "out of memory");
  if (code == EXIT_DONE) {
    run(s);
    report(s);
  }
  if (file) fclose(file);
  for (uint32_t i = 0; s && i < s->stage_count; i++) {
    free(s->stages[i].costs);
    free(s->stages[i].finished);
  }
  free(s);
  return code;
}
