// Lighting many surface points at once, so that rays go to the ray caster in packets: direct light through both lobes,
// diffuse light of earlier bounces from irradiance maps, and reflections cast as rays.
//
// A renderer finds glossy light by tracing through the field; the baker has the triangles, so its reflections are
// exact. The light at their ends depends on no viewpoint other than their own.
#ifndef OLX_BAKE_SHADE_BATCH_H
#define OLX_BAKE_SHADE_BATCH_H

#include "bake/scratch_pool.h"
#include "light/scene_light.h"
#include "scene/emitters.h"
#include "scene/surface.h"
#include "shade/irradiance.h"

#include <stdatomic.h>

enum {
  OLX_BATCH_POINTS = 1024,
  OLX_KEPT_BOUNCES = 4 // bounces whose irradiance is kept: reflections of reflections reach back that far
};

// Surface points and the light that leaves them towards `view`.
typedef struct olx_shade_batch {
  uint32_t count;
  uint32_t light_samples; // shadow rays of a point to each light that varies
  bool sparing;           // where no point of a few sees a light, few of the others send shadow rays to it
  bool averages_lobes;    // wide specular lobes count as matte: for light that is looked at from elsewhere
  olx_surface surface[OLX_BATCH_POINTS];
  olx_vec3 view[OLX_BATCH_POINTS];     // unit, from the surface
  uint32_t seed[OLX_BATCH_POINTS];     // points that share it share out the samples of a light between them
  uint32_t sequence[OLX_BATCH_POINTS]; // the point's number among those with its seed
  olx_vec3 diffuse[OLX_BATCH_POINTS];  // reflectance over pi of all that is not traced as a reflection
  bool reflects[OLX_BATCH_POINTS];     // has a specular lobe of its own
  olx_vec3 radiance[OLX_BATCH_POINTS]; // without the surface's own emission
  uint32_t lit_like[OLX_BATCH_POINTS]; // the point, not after it, whose shadow rays to lights that vary count for it
  // How many rays of the diffuse lobe look for lights at the point on average: shadow rays count for the rest. At first
  // 0.
  float scattered[OLX_BATCH_POINTS];
} olx_shade_batch;

// A ray along which light is reflected to a point of olx_shade_scratch.roots.
typedef struct olx_shade_path {
  uint32_t root, from; // indices of the points that receives the light at last, and that the ray leaves
  bool diffuse;        // drawn from the diffuse lobe: brings light of emitters and the sky only
  olx_vec3 throughput;
  olx_vec3 direction;
  float pdf; // over solid angle; 0 for a mirror
} olx_shade_path;

// Working memory of one thread.
typedef struct olx_shade_scratch {
  olx_shade_batch roots, reflected[2];
  olx_ray rays[2 * OLX_BATCH_POINTS];
  olx_ray_hit hits[2 * OLX_BATCH_POINTS];
  uint8_t occluded[OLX_BATCH_POINTS];
  uint32_t lit_point[OLX_BATCH_POINTS];
  uint32_t ray_of[OLX_BATCH_POINTS]; // that a point sends to a light
  olx_light_sample light[OLX_BATCH_POINTS];
  olx_shade_path paths[2][2 * OLX_BATCH_POINTS]; // one through each lobe at most
  uint32_t slot[OLX_BATCH_POINTS];               // which sample of a tile a point of `roots` is
  uint32_t owner[OLX_BATCH_POINTS];              // which point lights a sample
  olx_vec3 directions[OLX_BATCH_POINTS];         // of a tile's samples
  float weights[OLX_BATCH_POINTS];               // their shares of solid angle
} olx_shade_scratch;

// Irradiance of bounces in maps of the irradiance probes, with border: that of bounce k is at k mod (OLX_KEPT_BOUNCES +
// 1).
typedef struct olx_bounce_maps {
  uint32_t size; // texels along a side
  olx_vec3 *irradiance[OLX_KEPT_BOUNCES + 1];
  olx_irradiance_source sources[OLX_KEPT_BOUNCES + 1]; // what reads them
} olx_bounce_maps;

static inline const olx_irradiance_source *olx_bounce_source(const olx_bounce_maps *maps, uint32_t bounce) {
  return &maps->sources[bounce % (OLX_KEPT_BOUNCES + 1)];
}

// What lighting needs to know of the bake.
typedef struct olx_shade_context {
  const olx_scene *scene;
  olx_sample_settings sample;
  uint32_t seed; // of the bake: keys of random numbers are mixed with it; 0 leaves them as they are
  uint32_t group_count;
  float least_light_pdf;           // of a point on an emitter, over area
  olx_vec3 lights_min, lights_max; // bounds of the emitters
  bool reflected_lights;           // some light has an area, so that a reflected ray can meet it
  float share_distance;            // points of a texel that lie this close together share one look-up of irradiance
  const olx_scene_light *light;   // solved for the whole scene, where irradiance is looked up; NULL: in maps of bounces
  const olx_bounce_maps *bounces; // the gather's, once it has any
  olx_scratch_pool pool;
  atomic_uint_fast64_t rays;
  atomic_bool out_of_memory;
} olx_shade_context;

void olx_shade_context_begin(olx_shade_context *context, const olx_scene *scene, uint32_t seed);

// Returns a probe's or a point's key for random numbers, in this bake.
static inline uint32_t olx_shade_key(const olx_shade_context *context, uint32_t key) { return key ^ context->seed; }
void olx_shade_context_end(olx_shade_context *context);

// Returns a thread's working memory for one job, or NULL after recording that it could not be allocated.
olx_shade_scratch *olx_shade_scratch_take(olx_shade_context *context);
void olx_shade_scratch_give(olx_shade_context *context, olx_shade_scratch *scratch);
// Returns OLX_ERROR_MEMORY after a thread could not allocate its working memory, because the results of its jobs are
// missing then.
olx_result olx_shade_check_memory(olx_shade_context *context);

// Empties a batch.
void olx_shade_batch_begin(olx_shade_batch *batch, uint32_t light_samples);

// Appends the surface at `hit` to the batch, seen along `direction`; its radiance starts at 0. Returns its index.
uint32_t olx_shade_append(olx_shade_context *context, olx_shade_batch *batch, const olx_ray_hit *hit,
                          olx_vec3 direction, uint32_t seed, uint32_t sequence);

// Updates what depends on a point's albedo, after the albedo was changed.
void olx_shade_refresh(olx_shade_batch *batch, uint32_t point);

// Returns how many rays of the diffuse lobe should look for lights at a point, at most 1: none where every light is so
// small that shadow rays find it far better.
float olx_shade_scattering(const olx_shade_context *context, const olx_surface *surface);

// Adds the light of emitters, through both lobes, except what only a reflected ray can find.
void olx_shade_direct(olx_shade_context *context, olx_shade_scratch *scratch, olx_shade_batch *batch);

// Adds the diffuse reflection of the solution's irradiance, where there is a solution, or else of the irradiance of
// bounce `bounce`.
void olx_shade_diffuse(olx_shade_context *context, olx_shade_batch *batch, uint32_t bounce);

// The light that a reflected ray brings.
enum {
  OLX_REFLECT_LIGHTS = 1,  // of emitters and the sky, at its end: part of direct light
  OLX_REFLECT_BOUNCES = 2, // of surfaces
};

// Casts rays from the first `count` points of scratch->roots, and adds to the points the light that the rays find when
// surfaces carry direct light and `bounces` - 1 further bounces. The caller has filled scratch->paths[0] but for its
// direction and pdf. `what` selects from the light that reflected rays bring.
void olx_shade_reflections(olx_shade_context *context, olx_shade_scratch *scratch, uint32_t count, uint32_t bounces,
                           uint32_t what);

#endif
