// Repeats Figure 19 of McGuire et al. 2017: errors and times for growing numbers of probes.
#include "experiment_list.h"
#include "field_sweep.h"

static const sweep_step cornell[] = {{{1, 2, 1}, 64}, {{2, 2, 2}, 64}, {{4, 4, 4}, 64}};
static const sweep_step living_room[] = {{{1, 4, 1}, 256}, {{4, 4, 4}, 256}, {{8, 4, 8}, 256}};
static const sweep_scene scenes[] = {
    {"builtin:cornell-glossy", NULL, cornell, sizeof cornell / sizeof *cornell},
    {"living-room", "sofa", living_room, sizeof living_room / sizeof *living_room},
};

static const bench_plot plots[] = {
    {"Error against probes: diffuse light", "probes", "diffuse_relative_mse", "scene", true, true},
    {"Error against probes: glossy light", "probes", "glossy_relative_mse", "scene", true, true},
    {"Time of a glossy ray", "probes", "glossy_us", "scene", true, false},
};

olx_result run_mcguire_count(bench *b) {
  return run_sweep(b, scenes, sizeof scenes / sizeof *scenes, OLX_LAYER_INDIRECT_DIFFUSE,
                   "More probes with maps of the same size (living room 256\u00b2, cornell-glossy 64\u00b2)", plots,
                   sizeof plots / sizeof *plots);
}
