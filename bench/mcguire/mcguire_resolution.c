// Repeats Figure 18 of McGuire et al. 2017: errors for light field maps of growing numbers of texels.
#include "experiment_list.h"
#include "field_sweep.h"

static const sweep_step cornell[] = {{{2, 2, 2}, 16}, {{2, 2, 2}, 64}, {{2, 2, 2}, 256}};
static const sweep_step living_room[] = {{{4, 4, 4}, 64}, {{4, 4, 4}, 256}, {{4, 4, 4}, 1024}};
static const sweep_scene scenes[] = {
    {"builtin:cornell-glossy", NULL, cornell, sizeof cornell / sizeof *cornell},
    {"living-room", "sofa", living_room, sizeof living_room / sizeof *living_room},
};

static const bench_plot plots[] = {
    {"Error against memory: glossy light", "mib", "glossy_relative_mse", "scene", true, true},
    {"Error against memory: diffuse light", "mib", "diffuse_relative_mse", "scene", true, true},
    {"Time of a glossy ray", "mib", "glossy_us", "scene", true, false},
};

olx_result run_mcguire_resolution(bench *b) {
  return run_sweep(b, scenes, sizeof scenes / sizeof *scenes, OLX_LAYER_INDIRECT_GLOSSY,
                   "The same probes with maps of 64\u00b2, 256\u00b2 and 1024\u00b2 texels (cornell-glossy 16\u00b2, "
                   "64\u00b2, 256\u00b2)",
                   plots, sizeof plots / sizeof *plots);
}
