// Sampling a baked field on the CPU: rays, irradiance and glossy light. No call allocates, and only the ..._check
// functions fail; any number of threads may sample one field.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_SAMPLE_H
#define OCTALUX_SAMPLE_H

#include <octalux/base.h>
#include <octalux/field.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef enum olx_tracer {
  OLX_TRACER_TEXEL = 0, // visits every texel on the ray's path: slow, the reference
  // These give the same answers as OLX_TRACER_TEXEL to the last bit.
  OLX_TRACER_TWO_LEVEL = 1, // McGuire et al. sections 4.1, 4.2: skips blocks of 16 x 16 texels by their least distance
  OLX_TRACER_HIZ = 2        // Wang section 4.3: marches a pyramid of smallest distances; the fastest
} olx_tracer;

typedef enum olx_visibility {
  OLX_VISIBILITY_NONE = 0,     // trilinear interpolation alone, which leaks; for comparison
  OLX_VISIBILITY_CHEBYSHEV = 1 // McGuire et al. section 5.2 with the refinements that docs/studies/leaks.md measures
} olx_visibility;

typedef enum olx_hits {
  OLX_HITS_SHADED = 0, // the surface stored in the texel, shaded for the ray's own direction
  OLX_HITS_STORED = 1  // radiance as the probe saw it, lobes averaged over views: a cheap reference; needs probe light
} olx_hits;

typedef struct olx_sample_settings {
  olx_tracer tracer;         // default OLX_TRACER_HIZ
  olx_select select;         // default OLX_SELECT_BEST; OLX_SELECT_EXHAUSTIVE replaces one that the field does not have
  olx_visibility visibility; // default OLX_VISIBILITY_CHEBYSHEV
  uint32_t max_probes;       // the most probes through which a ray is traced; once its selector has named some and
                             // names no more, at most two others are asked; default 16; 0 finds nothing
  bool keep_buried;          // also use buried probes (inside geometry; the published failure, Fig. 10); default false
  bool emitters;             // count light that comes straight from an emitter or the sky; default false, because
                             // direct lighting samples those already (docs/maths.md, "Light, layers, bounces")
  olx_hits hits;             // the kind of light at a hit; default OLX_HITS_SHADED, and always that in a field whose
                             // lights have changed since it was baked, because stored radiance is out of date there
  float surface_tolerance;   // how far a surface may lie from its place in the bake and still get its stored light, in
                             // footprints of texels (their side on the surface): for hosts that draw levels of
                             // detail or displaced surfaces; 0 to OLX_MOST_SURFACE_TOLERANCE, default 0
  bool visibility_only;      // rays find what they hit without its light: radiance, lobe and emission are 0, and
                             // `emitter` is true only in the sky; so traced light is 0, too. Default false; devices
                             // ignore it
} olx_sample_settings;

#define OLX_MOST_SURFACE_TOLERANCE 16.0f

olx_sample_settings olx_sample_settings_default(void);

// Returns OLX_ERROR_ARGUMENT, with a message, when `settings` name a selector or a kind of hit light that the field was
// baked without, an enumerator that does not exist, or a surface tolerance out of range. Sampling with such settings is
// safe: OLX_SELECT_EXHAUSTIVE and the defaults replace them.
olx_result olx_sample_settings_check(const olx_field *field, const olx_sample_settings *settings);

typedef enum olx_trace_status {
  OLX_TRACE_MISS = 0, // the ray leaves the scene or reaches t_max
  OLX_TRACE_HIT = 1,  // a surface that a probe sees
  // Unresolved: no probe sees where the ray goes. The values are those of the surface behind which it vanished least
  // deep; where no probe was asked they are 0. A ray that vanished by less than 1.5 footprints is taken to end there,
  // and is a HIT. Both find the surface's light without direct light and emission (docs/maths.md, "Light at the end of
  // a ray").
  OLX_TRACE_UNKNOWN = 2
} olx_trace_status;

typedef struct olx_trace_hit {
  olx_trace_status status;
  float distance_metres; // along the ray; infinite for a miss to the sky
  olx_vec3 position;
  olx_vec3 normal;   // of the surface, on the side of the probe that saw it
  olx_vec3 radiance; // reflected by the surface along the ray: linear Rec.709, W/(sr m^2); 0 for a miss
  olx_vec3 lobe;     // the specular lobe's part of `radiance`, without highlights of lights without area, as if light
                     // came from all directions alike; 0 with OLX_HITS_STORED
  olx_vec3 emission; // sent by an emitter towards the probe, or by the sky along the ray; not part of `radiance`
  bool emitter;      // the ray ends at an emitter or in the sky; false where it vanished
  uint32_t probe;    // the probe that resolved the ray or saw it vanish; UINT32_MAX: none was asked
  uint32_t texel;    // of the probe's maps, border included: (y + 1) * (n + 2) + x + 1; 0 for a miss
  float footprint_metres; // of the texel that was hit: stored distance times the square root of its solid angle
  uint32_t texel_steps;   // number of texels, blocks and nodes of pyramids that were read, over all probes
  uint32_t probes_tried;
} olx_trace_hit;

// Traces the ray from `origin` (metres) along the unit vector `direction` to its first hit within t_max_metres, above 0
// (INFINITY for no limit). An origin that is not finite, a direction that is far from a unit vector, and any other
// limit give OLX_TRACE_UNKNOWN, and no probe is asked. McGuire et al. section 4, Listing 1.
olx_trace_hit olx_trace(const olx_field *field, const olx_sample_settings *settings, olx_vec3 origin,
                        olx_vec3 direction, float t_max_metres);

// Traces `count` rays at once: hits[i] equals the result of olx_trace for origins[i] and directions[i] to the last bit.
// In a field with bricks, 16 rays and more are traced side by side, which is fastest for rays that start near each
// other in similar directions; fewer rays are traced one after the other.
void olx_trace_rays(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                    const olx_vec3 *origins, const olx_vec3 *directions, float t_max_metres, olx_trace_hit *hits);

// Returns the indirect irradiance in W/m^2 on a surface at `position` with unit normal `normal`, seen from the
// direction `view` (unit, from the surface to the eye; pass the normal where there is no eye). Diffuse light leaving
// the surface is albedo * irradiance / pi. McGuire et al. section 5.2. 0 in a field without probe light
// (olx_probe_light_check). All numbers must be finite.
olx_vec3 olx_irradiance(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position, olx_vec3 normal,
                        olx_vec3 view);

// Evaluates olx_irradiance at `count` points: irradiance[i], in W/m^2, equals to the last bit its result for
// positions[i], normals[i] and views[i].
void olx_irradiance_points(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                           const olx_vec3 *positions, const olx_vec3 *normals, const olx_vec3 *views,
                           olx_vec3 *irradiance);

// Returns the indirect irradiance in W/m^2 on a static surface, one that was in the scene when the field was baked,
// from the light that the field stores for surfaces (docs/maths.md, "Light on surfaces"). It is more accurate than
// olx_irradiance and lets no light through walls. Where nothing is stored for the surface, it is the light of a
// parallel surface less than half a texel before or behind it; where there is none either, it is olx_volume_irradiance
// for the shading normal, a little above the surface. Use olx_volume_irradiance for moving objects. Diffuse light
// leaving the surface is albedo * irradiance / pi.
// - `position`: metres, on the surface to within a small share of a texel's footprint (settings->surface_tolerance).
// - `geometric_normal`: unit, of the triangle, on the side towards the eye. It decides which stored surfaces are this
//   one.
// - `shading_normal`: unit. Light is stored for the normal interpolated over the triangle, so smooth surfaces without a
//   normal map pass the geometric normal here too, and others the normal that the map makes of the geometric normal.
//   Where the two differ, stored light changes in each channel as olx_volume_irradiance does without what comes from
//   below the surface, by a factor of at most 4, as far as that is as bright as the stored light; else by half of one
//   plus the cosine between both normals.
// - `view`: unit, from the surface to the eye; pass the geometric normal where there is no eye.
// Numbers that are not finite give 0. Light is read from the best max_probes, at most 128, of the point's brick (of
// its cage in a field without bricks), and where none of them sees the surface, from the best two of all; with
// OLX_SELECT_EXHAUSTIVE from the best max_probes of all. The settings surface_tolerance, keep_buried and, for
// olx_irradiance, visibility have an effect too.
olx_vec3 olx_surface_irradiance(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                                olx_vec3 geometric_normal, olx_vec3 shading_normal, olx_vec3 view);

// Evaluates olx_surface_irradiance at `count` points: irradiance[i], in W/m^2, equals to the last bit its result for
// positions[i], geometric_normals[i], shading_normals[i] and views[i].
void olx_surface_irradiance_points(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                                   const olx_vec3 *positions, const olx_vec3 *geometric_normals,
                                   const olx_vec3 *shading_normals, const olx_vec3 *views, olx_vec3 *irradiance);

// Returns the indirect irradiance in W/m^2 anywhere in free space, for moving objects and for volumes, from the field's
// irradiance volume (docs/maths.md, "The irradiance volume"). It lets no light through surfaces that were there when
// the field was baked.
// - `position`: metres.
// - `normal`: unit, of the object's surface; a place is looked up 1/65536 of the side of the volume's largest cells in
// front of it. Where the volume has no cell, because neither cameras nor light field probes reach that space, this is
// 0: light of another room would be a leak. In a field without a volume (olx_field_info.volume.probe_count is 0) it is
// olx_irradiance with default settings: 0 without probe light. Numbers that are not finite give 0.
olx_vec3 olx_volume_irradiance(const olx_field *field, olx_vec3 position, olx_vec3 normal);

// Evaluates olx_volume_irradiance at `count` points: irradiance[i], in W/m^2, equals to the last bit its result for
// positions[i] and normals[i].
void olx_volume_irradiance_points(const olx_field *field, uint32_t count, const olx_vec3 *positions,
                                  const olx_vec3 *normals, olx_vec3 *irradiance);

// Returns OLX_ERROR_ARGUMENT, with a message, when the field was baked without probe light (octalux/bake.h):
// OLX_HITS_SHADED then replaces OLX_HITS_STORED, and olx_irradiance and olx_probe_irradiance are 0.
olx_result olx_probe_light_check(const olx_field *field);

// Returns the irradiance in W/m^2 that irradiance probe `index` (< irradiance.probe_count) stores for surfaces of unit
// normal `normal`: not interpolated, and with the ringing of spherical harmonics, so that it may be below 0 where
// olx_irradiance returns 0. 0 for any other index.
olx_vec3 olx_probe_irradiance(const olx_field *field, uint32_t index, olx_vec3 normal);

// Estimates by one ray the light that a GGX lobe of the given roughness (perceptual, 0..1; 0 is a mirror) gathers.
// Traces the reflection drawn by `random` (two numbers in [0, 1)) and returns its radiance, in which the light of a
// second ray replaces the `lobe` of a glossy surface. *weight receives the BRDF times cosine over the pdf for Fresnel
// reflectance 1, or 0 when the reflection lies below the surface and no ray was traced. *half_cosine receives the
// cosine for Fresnel (view . half), and *hit, which may be NULL, what the first ray found: a miss when none was traced.
olx_vec3 olx_glossy(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position, olx_vec3 normal,
                    olx_vec3 view, float roughness, olx_vec2 random, float *weight, float *half_cosine,
                    olx_trace_hit *hit);

// Evaluates olx_glossy at `count` points: radiance[i], weights[i] and half_cosines[i] equal to the last bit its results
// for positions[i], normals[i], views[i], roughness[i] and random[i]; half_cosines[i] is undefined where weights[i] is
// 0.
void olx_glossy_rays(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                     const olx_vec3 *positions, const olx_vec3 *normals, const olx_vec3 *views, const float *roughness,
                     const olx_vec2 *random, olx_vec3 *radiance, float *weights, float *half_cosines);

// The classic method, which light field probes replace (docs/baking.md, "Classic maps"): irradiance and prefiltered
// radiance of the irradiance probes around a point, interpolated without visibility. Of `settings`, only keep_buried
// has an effect. Light directly from emitters or the sky is left out.

// Returns OLX_ERROR_ARGUMENT, with a message, when the field was baked without classic maps. The functions below then
// return 0.
olx_result olx_classic_check(const olx_field *field);

// Returns the indirect irradiance in W/m^2 on a surface at `position` with unit normal `normal`.
olx_vec3 olx_classic_irradiance(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                                olx_vec3 normal);

// Returns the light that a GGX lobe of the given roughness (perceptual, 0..1) reflects towards `view` (unit, from the
// surface to the eye), with Fresnel reflectance `f0` at normal incidence and `f90` at grazing angles: prefiltered
// radiance, looked up where the mirror ray leaves each probe's box, times the lobe's reflectance from a table (split
// sum).
olx_vec3 olx_classic_glossy(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position,
                            olx_vec3 normal, olx_vec3 view, float roughness, olx_vec3 f0, float f90);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
