// The rows of classic probes' parity test: one for each function of shaders/lib/classic.glsl. C and GLSL read this.
#ifndef PARITY_CLASSIC_ROWS_H
#define PARITY_CLASSIC_ROWS_H

#define PARITY_CLASSIC_ITEMS 4096 // of every row: a multiple of the workgroup
#define PARITY_CLASSIC_RESULTS 20 // words an item may give

#define ROW_olx_classic_color 0
#define ROW_olx_classic_vector 1
#define ROW_olx_classic_parallax 2
#define ROW_olx_classic_reflectance 3
#define ROW_olx_classic_side 4
#define ROW_olx_classic_radiance 5
#define ROW_olx_classic_weigh 6
#define ROW_olx_classic_irradiance 7
#define ROW_olx_classic_glossy 8

#endif
