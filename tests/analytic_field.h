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
  float t; // infinite when the ray meets the sky
  olx_vec3 normal;
} analytic_hit;

analytic_hit analytic_cast(const analytic_scene *scene, olx_vec3 origin, olx_vec3 direction);

// Returns the radiance that identifies a place: positive, smooth in position, different on each side of a box.
olx_vec3 analytic_radiance(olx_vec3 position, olx_vec3 normal);

// Reflectance from 0.2 to 0.8 that identifies a place.
olx_vec3 analytic_albedo(olx_vec3 position, olx_vec3 normal);

// Makes every map of a grid of probes. Surfaces are Lambertian with analytic_albedo, with indirect light of pi *
// analytic_radiance / analytic_albedo and no direct light; the sky's radiance is 4. Irradiance maps hold the constant
// `irradiance` of the radiance's pattern and the exact moments of one texel. Free with analytic_field_free.
olx_field *analytic_field_make(const analytic_scene *scene, const olx_grid *grid, uint32_t n, uint32_t irradiance_n);
void analytic_field_free(olx_field *field);

// Replaces the texels of surfaces by blocks.
void analytic_field_compress(olx_field *field);
// Replaces distances and normals by geometry blocks.
void analytic_field_block_geometry(olx_field *field);

// Adds classic maps of `size` texels along a side with random contents, for tests of which texels are read. Remove them
// before the field is freed.
void analytic_field_add_classic(olx_field *field, uint32_t size);
void analytic_field_remove_classic(olx_field *field);

#endif
