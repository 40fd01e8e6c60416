// Lists the studies that octalux-bench knows, and starts them with their arguments.
#include "studies.h"

#include "companion.h"
#include "options.h"

enum { ANY = 1 << 16 };

const bench_study studies[] = {
    {"speed", NULL, 0, ANY, "a bake against Embree casting the rays from its probes alone", study_bake_speed},
    {"gpu", NULL, 0, ANY, "milliseconds of each pass on a Vulkan device (octalux-bench-gpu)", study_gpu},
    {"runtime-speed", "FIELD.olx [COUNT]", 1, 2, "nanoseconds of each query, on one thread", study_runtime_speed},
    {"selector-speed", "FIELD.olx [COUNT]", 1, 2, "nanoseconds of finding probes, by selector", study_selector_speed},
    {"ray-race", "SCENE FIELD.olx [RAYS]", 2, 3, "rays through a field against ray casting, in turns", study_ray_race},
    {"glossy-speed", "SCENE WIDTH HEIGHT ROUNDS FIELD.olx:texel|two-level|hiz:SELECTOR...", 5, ANY,
     "the glossy pass through several fields, in turns", study_glossy_speed},
    {"glossy-quality", "SCENE FIELD.olx WIDTH HEIGHT SPP PATHS KEPT", 7, 7, "glossy light against path tracing",
     study_glossy_quality},
    {"glossy-oracle", "SCENE FIELD.olx [PIXELS]", 2, 3, "where the error of glossy light comes from",
     study_glossy_oracle},
    {"glossy-causes", "SCENE FIELD.olx [PIXELS] [RAYS]", 2, 4, "which rays of glossy light are wrong, and by how much",
     study_glossy_causes},
    {"viewpoint-limit", "SCENE FIELD.olx [RAYS]", 2, 3, "the least error that texels of probes leave",
     study_viewpoint_limit},
    {"probe-sets", "SCENE PIXELS FIELD.olx...", 3, ANY, "sets of probes along the very same rays", study_probe_sets},
    {"placement-check", "[--ball METRES] SCENE RAYS PROBES.json...", 3, ANY,
     "what sets of probes see, by rays that placing never used", study_placement_check},
    {"light-quality", "SCENE [PROBES.json|-] [NOISE] [SPACING] [MAP] [POINTS] [PATHS] [BOUNCES]", 1, 8,
     "solved light against path tracing, at points", study_light_quality},
    {"light-picture", "SCENE PROBES.json|- NOISE IMAGE.exr [CAMERA] [WIDTH HEIGHT]", 4, 7,
     "a picture of solved light, and of where it is interpolated", study_light_picture},
    {"block-quality", "FIELD.olx [TOLERANCE] [LEAST_COSINE] [SCENE]", 1, 4, "bytes and errors of blocks of texels",
     study_block_quality},
    {"farm-simulation", "UNITS.jsonl PROBES NODES [MB_A_SECOND] [LOADING_SECONDS] [CLOCK_FACTOR] [PLAN_SECONDS]", 3, 7,
     "how long a bake takes on many machines, by the rule that deals its units", study_farm_simulation},
    {"relight-causes", "SCENE MOVED CAMERA [MAP] [NOISE] [X Y Z]", 3, 8,
     "relit light against fresh bakes, bounce by bounce", study_relight_causes},
    {"seams", "SCENE FIELD.olx IMAGE.exr [CAMERA]", 3, 4, "whether a picture shows the borders of cages", study_seams},
    {"scene-arrays", "SCENE FOLDER [CAMERA]", 2, 3, "a scene as plain arrays, for other renderers", study_scene_arrays},
};
const uint32_t study_count = sizeof studies / sizeof *studies;

int run_study(const bench_study *s, int argc, char **argv) {
  const uint32_t count = (uint32_t)argc - 1;
  if (count >= s->least && count <= s->most) return s->run(argc, argv);
  return usage_error(BENCH_PROGRAM, "%s takes other arguments: %s", s->name, s->arguments);
}

int study_gpu(int argc, char **argv) {
  (void)argc;
  return start_companion(BENCH_PROGRAM " gpu", "octalux-bench-gpu", "this build has no Vulkan runtime", argv);
}
