// The experiments in the order of the papers.
#include "experiment_list.h"

const experiment experiments[] = {
    {"mcguire-leaks", "McGuire et al. 2017, Figures 10, 11, 12 and 13",
     "light and darkness that leak through walls and out of buried probes",
     "Indirect diffuse light, seen from one camera a figure, against the path tracer. \u201cNo visibility\u201d "
     "interpolates "
     "the same irradiance maps trilinearly and asks probes inside geometry too; \u201cfield\u201d weighs them by their "
     "filtered visibility. Figure 11 also gathers through the light field probes, by one ray a pixel, and denoised "
     "over 64 "
     "frames. Times are those of the diffuse pass and of denoising, one frame on one processor.",
     run_mcguire_leaks},
    {"mcguire-resolution", "McGuire et al. 2017, Figure 18", "texels of light field maps against glossy light",
     "The paper shows that the resolution of light field maps decides how sharp reflections can be, and little else.",
     run_mcguire_resolution},
    {"mcguire-count", "McGuire et al. 2017, Figure 19", "the number of probes against diffuse light",
     "The paper shows that the number of probes decides diffuse interreflection, and hardly glossy reflections as long "
     "as "
     "some probe sees most surfaces. Irradiance probes stand where light field probes do.",
     run_mcguire_count},
};
const uint32_t experiment_count = sizeof experiments / sizeof *experiments;
