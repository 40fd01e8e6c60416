// Fields made from analytic scenes of axis-aligned boxes, without files or ray casters: for tests of the runtime.
#ifndef OLX_TESTS_ANALYTIC_FIELD_H
#define OLX_TESTS_ANALYTIC_FIELD_H

#include "field/field_data.h"

// A room (seen from inside) with solid boxes in it. An open room has no ceiling: rays through it see the sky.
typedef struct analytic_box {
  olx_vec3 min, max;
} analytic_box;

typedef struct analytic_scene {
  analytic_box room;
  bool open;
  uint32_t box_count;
  analytic_box boxes[4];
} analytic_scene;

typedef struct analytic_hit {
  float t; // infinite for the sky
  olx_vec3 normal;
} analytic_hit;

analytic_hit analytic_cast(const analytic_scene *scene, olx_vec3 origin, olx_vec3 direction);

// Radiance that tells places apart: positive, smooth in position, different on each side of a box.
olx_vec3 analytic_radiance(olx_vec3 position, olx_vec3 normal);

// Reflectance that tells places apart, from 0.2 to 0.8.
olx_vec3 analytic_albedo(olx_vec3 position, olx_vec3 normal);

// Every map of a grid of probes; surfaces are Lambertian with analytic_albedo, get pi * analytic_radiance /
// analytic_albedo of indirect light and no direct light, and the sky has a radiance of 4; irradiance maps hold the
// radiance's constant `irradiance` and exact moments of one texel. Free with analytic_field_free.
olx_field *analytic_field_make(const analytic_scene *scene, const olx_grid *grid, uint32_t n, uint32_t irradiance_n);
void analytic_field_free(olx_field *field);

// Surfaces become blocks, in place of texels.
void analytic_field_compress(olx_field *field);
// Distances and normals become geometry blocks.
void analytic_field_block_geometry(olx_field *field);

// Classic maps of `size` texels along a side, at random: for tests that ask what is read, not what it looks like. Take
// them away before the field is freed.
void analytic_field_add_classic(olx_field *field, uint32_t size);
void analytic_field_remove_classic(olx_field *field);

#endif
