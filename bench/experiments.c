// Lists the experiments that octalux-bench knows, in the order of the papers.
#include "experiment_list.h"
#include "wang/wang.h"

const experiment experiments[] = {
    {"mcguire-table1", "McGuire et al. 2017, Table 1", "the time of indirect light, diffuse and glossy",
     "The paper\u2019s times are a GPU\u2019s, ours those of one core for as many pixels: what can be compared is how "
     "times follow from "
     "scenes, probes and texels. octalux-bench-gpu measures the same rows on a GPU.",
     .run = run_mcguire_table1},
    {"mcguire-leaks", "McGuire et al. 2017, Figures 10, 11, 12 and 13",
     "light and darkness that leak through walls and out of buried probes",
     "Indirect diffuse light, seen from one camera a figure, against the path tracer. \u201cField\u201d weighs "
     "irradiance "
     "probes by their filtered visibility, \u201cat surfaces\u201d is the light stored there, which renderers show by "
     "default, \u201cno visibility\u201d interpolates the same maps trilinearly, "
     "\u201cclassic\u201d is the baseline, irradiance probes without visibility, on the same grid, wherever they are, "
     "and in Figure 10 also without those inside geometry. Figures 11 and 13 also trace the light field probes: one "
     "ray a pixel, raw, and denoised over 64 frames, with the noise they have. Times are of the diffuse pass and of "
     "denoising, one frame on one processor.",
     .run = run_mcguire_leaks},
    {"mcguire-area-light", "McGuire et al. 2017, Figure 14", "an area light found by rays through the field alone",
     "The lamp is either sampled by direct lighting, as usual, or left to the rays that gather indirect light, with no "
     "term for "
     "direct light at all. Final pictures against the path tracer, through pixel centres.",
     .run = run_mcguire_area_light},
    {"mcguire-single-probe", "McGuire et al. 2017, Figure 17", "a hall that one light field probe sees whole",
     "One probe holds the whole light field of a star-shaped volume: no ray is left without an answer. Diffuse light "
     "comes from the "
     "irradiance probes of the same grid, or is gathered by rays. Eight probes stand beside it for comparison.",
     .run = run_mcguire_single_probe},
    {"mcguire-resolution", "McGuire et al. 2017, Figure 18", "texels of light field maps against glossy light",
     "The paper shows that the resolution of light field maps decides how sharp reflections can be, and little else.",
     .run = run_mcguire_resolution},
    {"mcguire-count", "McGuire et al. 2017, Figure 19", "the number of probes against diffuse light",
     "The paper shows that the number of probes decides diffuse interreflection, and hardly glossy reflections as long "
     "as "
     "some probe sees most surfaces. Irradiance probes stand where light field probes do.",
     .run = run_mcguire_count},
    {"wang-table1", "Wang 2018, Table 5.1", "the time of the glossy pass with grids and with placed probes",
     "All surfaces glossy, light of one bounce, one ray a pixel. \u201cTimes as fast\u201d is against the first row of "
     "the scene; a "
     "CPU\u2019s core and a GPU are compared by these ratios alone.",
     .run = run_wang_table1, .scene = wang_scene_name, .takes = TAKES_SIZES},
    {"wang-table2", "Wang 2018, Table 5.2", "memory of grids and of placed probes",
     "Maps as stored, reckoned at 512\u00b2 texels; octree and bricks as they are for the maps that were baked, with "
     "which both grow. The fields are those of wang-table1, which takes their time in octalux-bench all. The thesis "
     "counts 32 "
     "and 24 probes for the temple\u2019s grid, 128 and 256 for Sponza\u2019s; its printed sums stand here as they "
     "are.",
     .run = run_wang_table2, .scene = wang_scene_name, .takes = TAKES_SIZES},
    {"wang-quality", "Wang 2018, sections 5.1.1, 5.1.2 and 5.2",
     "grids and placed probes of equal quality, count and time",
     "Glossy light of one bounce, mean over the scene\u2019s cameras, of the same fields as wang-table1, which takes "
     "their time in octalux-bench all. The thesis shows single grids; whether other shapes of grid do better is what "
     "octalux-bench wang-probes asks.",
     .run = run_wang_quality, .scene = wang_scene_name, .takes = TAKES_SIZES},
    {"dissertation-rooms", "Dissertation draft 2022, Figures 5.1 to 5.5",
     "a room behind a wall that is whole, or open at one end",
     "The dissertation\u2019s two scenes, sixteen probes each: behind a whole wall the far room is black, and through "
     "an opening light "
     "reaches it after many reflections. Our rooms have no outside that could be seen, so there is no Figure 5.5.",
     .run = run_dissertation_rooms},
    {"dissertation-table1", "Dissertation draft 2022, Table 6.1", "time and memory of both methods",
     "Published memory is for maps of 128\u00b2 texels. 149.25 KB are irradiance of four bytes a texel and radiance "
     "with four smaller "
     "levels; 576 KB are 36 bytes a texel. Published times are a GPU\u2019s; ours are of one core, for as many pixels.",
     .run = run_dissertation_table1},
    {"bounces", "McGuire et al. 2017, section 5.2; dissertation draft 2022, section 4.3.3",
     "further bounces from irradiance maps, or by rays between surfaces",
     "The Cornell box with 4x4x4 probes after 1, 2, 4 and many bounces of diffuse light, against as many of the path "
     "tracer. Bounces "
     "take their light from the irradiance maps of the bounce before, or from what probes store where a ray ends.",
     .run = run_bounces},
    {"relight", "Dissertation of 2022, section 6.2", "lights that move: one bounce a frame, against a fresh bake",
     "Irradiance at what a camera sees, against a bake of the changed scene, in each of 30 frames after a light moved. "
     "A frame of default budgets gives surfels a sample of direct light, carries light one bounce further over links, "
     "and renews tiles of texels, those first that have waited longest for their distance; shadow rays meet the "
     "scene's triangles. Rays and processor time are those of all 30 frames, which do nothing once light has settled.",
     .run = run_relight},
    {"sh", "McGuire et al. 2017, section 7",
     "irradiance as spherical harmonics of second and third order, beside octahedral maps",
     "The paper leaves harmonics to the future: less memory, but they ring, and more bytes are read. Distance moments "
     "stay "
     "octahedral here, because ringing there would leak, and are of one size for each group of three rows: what "
     "differs in it "
     "is the form of irradiance alone. Bakes are the same but for the last step, which projects the maps and fits the "
     "harmonics to the same surfaces.",
     .run = run_sh},
    {"surfaces", "docs/baking.md",
     "light stored at surfaces, with default settings, placed probes beside the scene's grid",
     "Probes are placed and baked as the commands do it when nothing else is said (512\u00b2 texels; 64\u00b2 with "
     "--quick). Errors "
     "of pictures are free of the reference's noise and hold that of the bake. Blocks darker than a hundredth of the "
     "picture do "
     "not count among the brightest and darkest. The second bake has other random numbers. Modes are light stored at "
     "surfaces, "
     "irradiance probes, rays gathered in one picture, and one ray a pixel denoised over frames; the irradiance volume "
     "is judged "
     "in free space. Sealed rooms have no light behind their wall, so that all of it is a leak.",
     .run = run_surfaces, .scene = surfaces_scene, .set = surfaces_set, .takes = TAKES_SETS},
    {"wang", "Wang 2018, chapter 5 and appendix A",
     "Tables 5.1 and 5.2 with the thesis\u2019s maps and all of its sets",
     "As wang-table1, wang-table2 and wang-quality, with maps of 512\u00b2 texels, and with the series of sets in the "
     "appendix unless --short leaves them out.",
     .run = run_wang, .scene = wang_scene_name, .takes = TAKES_SIZES | TAKES_SHORT, .alone = true},
    {"wang-probes", "Wang 2018, section 5.1", "how few probes do as well as a grid",
     "Several shapes of grid with the same number of probes, and placed probes against the one whose glossy layer has "
     "the least "
     "error; with --probes these sets alone, against the first.",
     .run = run_wang_probes, .scene = wang_scene_name, .takes = TAKES_SIZES | TAKES_SETS, .alone = true},
};
const uint32_t experiment_count = sizeof experiments / sizeof *experiments;
