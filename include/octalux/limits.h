// The least and the greatest values of settings. Every function that takes a setting checks it against these and
// returns OLX_ERROR_ARGUMENT beyond them. The command line's options have the same limits, and so have the sizes of
// maps in field files.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_LIMITS_H
#define OCTALUX_LIMITS_H

// Maps of probes: texels along a side, powers of two.
enum {
  OLX_RADIANCE_SIZE_LEAST = 8,
  OLX_RADIANCE_SIZE_MOST = 2048,
  OLX_IRRADIANCE_SIZE_LEAST = 8,
  OLX_IRRADIANCE_SIZE_MOST = 256,
  OLX_CLASSIC_SIZE_LEAST = 32,
  OLX_CLASSIC_SIZE_MOST = 256,
  OLX_CLASSIC_CUBE_SIZE_LEAST = 32,
  OLX_CLASSIC_CUBE_SIZE_MOST = 1024,
  OLX_CLASSIC_SHARPNESS_LEAST = 64,
  OLX_CLASSIC_SHARPNESS_MOST = 65536
};

// Bakes (octalux/bake.h). Settings without a least value here may be 0, except numbers of probes.
enum {
  OLX_BAKE_PROBES_MOST = 1 << 20, // of each kind
  OLX_SAMPLES_LEAST = 1,
  OLX_SAMPLES_MOST = 8,
  OLX_LIGHT_SAMPLES_LEAST = 1,
  OLX_LIGHT_SAMPLES_MOST = 64,
  OLX_BOUNCES_MOST = 256,
  OLX_REFERENCE_PATHS_LEAST = 1,
  OLX_REFERENCE_PATHS_MOST = 65536,
  OLX_VOLUME_CELLS_MOST = 256
};
#define OLX_NOISE_LEAST 0.001f
#define OLX_NOISE_MOST 1.0f

// Placement (octalux/place.h).
enum {
  OLX_PLACE_PROBES_MOST = 65536,
  OLX_PLACE_VIEWS_LEAST = 1,
  OLX_PLACE_VIEWS_MOST = 8,
  OLX_PLACE_SURFELS_LEAST = 64,
  OLX_PLACE_SURFELS_MOST = 1 << 20,
  OLX_PLACE_CANDIDATES_LEAST = 16,
  OLX_PLACE_CANDIDATES_MOST = 1 << 14,
  OLX_PLACE_VOXELS_LEAST = 8,
  OLX_PLACE_VOXELS_MOST = 512,
  OLX_PLACE_REFINEMENTS_MOST = 64,
  OLX_PLACE_ROUNDS_LEAST = 1,
  OLX_PLACE_ROUNDS_MOST = 10000
};

// Pictures (octalux/render.h); the least value of each is 1.
enum {
  OLX_PICTURE_SIZE_MOST = 16384, // pixels along each side
  OLX_PICTURE_SPP_MOST = 1 << 20,
  OLX_PICTURE_LOBE_SAMPLES_MOST = 4096 // diffuse or glossy rays
};

#endif
