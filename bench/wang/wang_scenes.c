// Holds the rows of the tables in Wang's thesis (2018) with the times that it states, for comparison.
#include "wang.h"

// clang-format off
#define GRID(x, y, z) {.grid = {x, y, z}, .texels = 512}
#define SKELETON(how, n) {.method = OLX_PLACE_##how, .count = n, .optimize = OLX_OPTIMIZE_GIBBS, .texels = 512}
#define COVER(n) {.method = OLX_PLACE_COVER, .count = n, .texels = 512}
#define ORIGINAL OLX_TRACER_TWO_LEVEL
#define HIZ OLX_TRACER_HIZ
#define COUNT(array) (sizeof(array) / sizeof *(array))

// The times are those of Table 5.1, on a GTX 1060 at 1900x1080; docs/results.md lists where section 5.1 and the figures
// differ.
static const wang_row cornell_rows[] = {
    {GRID(2, 2, 2), ORIGINAL, OLX_SELECT_CAGE, "Table 5.1, Fig. 5.1", 11.3, 0},
    {GRID(2, 2, 2), HIZ, OLX_SELECT_CAGE, "Table 5.1", 8.2, 0},
    {SKELETON(SDF, 7), ORIGINAL, OLX_SELECT_OCTREE, "Table 5.1", 7.8, 0},
    {SKELETON(SDF, 7), HIZ, OLX_SELECT_OCTREE, "Table 5.1, Fig. 5.1", 6.1, 0},
    {SKELETON(SDF, 7), HIZ, OLX_SELECT_VORONOI, NULL, 0, 0},
    {SKELETON(SDF, 7), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
    {COVER(7), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
};

static const wang_row temple_rows[] = {
    {GRID(4, 2, 4), ORIGINAL, OLX_SELECT_CAGE, "Table 5.1, Fig. 5.2", 27.7, 2.70e-3},
    {GRID(4, 2, 4), HIZ, OLX_SELECT_CAGE, NULL, 0, 0},
    {GRID(2, 2, 4), ORIGINAL, OLX_SELECT_CAGE, "Table 5.1, Fig. 5.5", 32.5, 0},
    {SKELETON(SDF, 16), HIZ, OLX_SELECT_OCTREE, "Table 5.1, Fig. 5.2", 17.3, 2.78e-3},
    {SKELETON(SDF, 16), HIZ, OLX_SELECT_VORONOI, NULL, 0, 0},
    {SKELETON(SDF, 16), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
    {SKELETON(MEDIAL, 16), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
    {COVER(16), ORIGINAL, OLX_SELECT_BRICKS, NULL, 0, 0},
    {COVER(16), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
    {GRID(4, 4, 4), ORIGINAL, OLX_SELECT_CAGE, "Figs. 5.8, A.17-A.20", 0, 0},
    {SKELETON(MEDIAL, 79), HIZ, OLX_SELECT_OCTREE, "Fig. 5.8, not in A.1", 0, 0},
    {SKELETON(MEDIAL, 63), HIZ, OLX_SELECT_OCTREE, "Fig. A.2", 0, 0},
    {SKELETON(MEDIAL, 48), HIZ, OLX_SELECT_OCTREE, "Fig. A.3", 0, 0},
    {SKELETON(MEDIAL, 43), HIZ, OLX_SELECT_OCTREE, "Fig. A.4", 0, 0},
    {SKELETON(MEDIAL, 36), HIZ, OLX_SELECT_OCTREE, "Fig. A.5", 0, 0},
};

static const wang_row sponza_rows[] = {
    {GRID(8, 4, 4), ORIGINAL, OLX_SELECT_CAGE, "Table 5.1, Fig. 5.4", 30.0, 1.05e-2},
    {GRID(8, 4, 4), HIZ, OLX_SELECT_CAGE, NULL, 0, 0},
    {SKELETON(MEDIAL, 64), ORIGINAL, OLX_SELECT_OCTREE, "Table 5.1, Figs. 5.4, A.9", 23.1, 1.10e-2},
    {SKELETON(MEDIAL, 64), HIZ, OLX_SELECT_OCTREE, "Table 5.1", 24.8, 0},
    {GRID(6, 3, 3), ORIGINAL, OLX_SELECT_CAGE, "Table 5.1, Fig. 5.6", 24.1, 4.14e-2},
    {SKELETON(MEDIAL, 54), ORIGINAL, OLX_SELECT_OCTREE, "Table 5.1", 20.6, 0},
    {SKELETON(MEDIAL, 54), HIZ, OLX_SELECT_OCTREE, "Table 5.1, Figs. 5.6, A.10", 19.0, 1.27e-2},
    {SKELETON(MEDIAL, 54), HIZ, OLX_SELECT_VORONOI, NULL, 0, 0},
    {SKELETON(MEDIAL, 54), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
    {COVER(54), ORIGINAL, OLX_SELECT_BRICKS, NULL, 0, 0},
    {COVER(54), HIZ, OLX_SELECT_BRICKS, NULL, 0, 0},
    {GRID(3, 3, 3), ORIGINAL, OLX_SELECT_CAGE, "Fig. 5.9", 20.0, 2.41e-2},
    {GRID(16, 8, 4), ORIGINAL, OLX_SELECT_CAGE, "Figs. A.21-A.25", 0, 0},
    {SKELETON(MEDIAL, 87), HIZ, OLX_SELECT_OCTREE, "Fig. A.7", 0, 0},
    {SKELETON(MEDIAL, 74), HIZ, OLX_SELECT_OCTREE, "Fig. A.8", 0, 0},
};

static const uint32_t cornell_8[][3] = {{2, 2, 2}, {4, 2, 1}, {2, 4, 1}, {1, 4, 2}, {2, 1, 4}, {1, 2, 4}};
static const wang_size cornell_sizes[] = {{8, cornell_8, COUNT(cornell_8)}};
static const uint32_t temple_32[][3] = {{4, 2, 4}, {2, 2, 8}, {4, 1, 8}, {2, 4, 4}, {4, 4, 2}, {3, 2, 5}};
static const wang_size temple_sizes[] = {{32, temple_32, COUNT(temple_32)}};
static const uint32_t sponza_128[][3] = {{8, 4, 4}, {16, 2, 4}, {8, 2, 8}, {10, 3, 4}};
static const wang_size sponza_sizes[] = {{128, sponza_128, COUNT(sponza_128)}};

const wang_scene wang_scenes[WANG_SCENES] = {
    {"cornell-glossy", "cornell-wang", cornell_rows, COUNT(cornell_rows), cornell_sizes, COUNT(cornell_sizes)},
    {"temple", "temple-wang", temple_rows, COUNT(temple_rows), temple_sizes, COUNT(temple_sizes)},
    {"sponza", "sponza-wang", sponza_rows, COUNT(sponza_rows), sponza_sizes, COUNT(sponza_sizes)},
};
// clang-format on

const char *wang_scene_name(uint32_t index) { return index < WANG_SCENES ? wang_scenes[index].name : NULL; }
