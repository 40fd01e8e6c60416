// Casts rays against the scene's triangles with Embree, one at a time or in packets of 16; filters let rays pass the
// masked-out parts of surfaces.
#include "scene/bvh.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "scene/surface.h"

#include <embree3/rtcore.h>
#include <stdio.h>
#include <string.h>

#define OLX_PACKET 16

typedef struct olx_bvh_tree {
  olx_bvh handle, light_handle; // of this tree
  const olx_scene *scene;
  RTCDevice device;
  RTCScene accelerator;
  // Maps Embree's triangles, which are numbered within a geometry, to the scene's: triangle_of[first[geometry] +
  // primitive]. Geometry 0 holds the opaque triangles, geometry 1 the alpha-masked ones. NULL in a scene without masks,
  // where the numbers are the same.
  uint32_t *triangle_of;
  uint32_t first[2];
  char message[256]; // the last error that Embree reported while the device was set up
} olx_bvh_tree;

static uint32_t scene_triangle(const olx_bvh_tree *bvh, uint32_t geometry, uint32_t primitive) {
  return bvh->triangle_of ? bvh->triangle_of[bvh->first[geometry] + primitive] : primitive;
}

static void remember_message(void *user, enum RTCError code, const char *text) {
  olx_bvh_tree *bvh = user;
  snprintf(bvh->message, sizeof bvh->message, "error %d: %s", (int)code, text ? text : "");
}

static bool is_masked(const olx_scene *scene, uint32_t triangle) {
  return scene->materials[scene->material_index[triangle]].alpha_cutoff > 0.0f;
}

// What Embree hands from a query to the filter.
typedef struct query_context {
  struct RTCIntersectContext embree; // the first member: Embree knows this one alone
  bool follows_light;
  float *passing; // of a single ray, whose light the filter multiplies by what surfaces let through; NULL: others
} query_context;

// Returns whether a query meets the masked surface at a point.
static bool meets(const query_context *query, const olx_scene *scene, uint32_t triangle, float u, float v) {
  if (query->passing) {
    *query->passing *= 1.0f - olx_surface_opacity(scene, triangle, u, v);
    return *query->passing <= 0.0f;
  }
  return query->follows_light ? olx_surface_stops_light(scene, triangle, u, v)
                              : olx_surface_present(scene, triangle, u, v);
}

// Embree's filter, by which rays pass through masked-out parts. A packet's hits are arrays of N: Ng_x, Ng_y, Ng_z, u,
// v, primID, in that order.
static void filter_masked(const struct RTCFilterFunctionNArguments *arguments) {
  const olx_bvh_tree *bvh = arguments->geometryUserPtr;
  const query_context *query = (const query_context *)arguments->context;
  const size_t n = arguments->N;
  const float *u = (const float *)arguments->hit + 3 * n, *v = u + n;
  const unsigned int *primitive = (const unsigned int *)arguments->hit + 5 * n;
  for (size_t i = 0; i < n; i++) {
    if (arguments->valid[i] == 0) continue;
    const uint32_t triangle = scene_triangle(bvh, 1, primitive[i]);
    if (!meets(query, bvh->scene, triangle, u[i], v[i])) arguments->valid[i] = 0;
  }
}

static olx_result split_by_mask(olx_bvh_tree *bvh) {
  const olx_scene *scene = bvh->scene;
  uint32_t masked = 0;
  for (uint32_t t = 0; t < scene->triangle_count; t++) masked += is_masked(scene, t);
  bvh->first[1] = scene->triangle_count - masked;
  if (masked == 0) return OLX_OK;
  bvh->triangle_of = olx_allocate(scene->triangle_count, sizeof *bvh->triangle_of);
  if (!bvh->triangle_of)
    return olx_fail(OLX_ERROR_MEMORY, "ray caster: no memory for %u triangles", scene->triangle_count);
  uint32_t next[2] = {0, bvh->first[1]};
  for (uint32_t t = 0; t < scene->triangle_count; t++) bvh->triangle_of[next[is_masked(scene, t)]++] = t;
  return OLX_OK;
}

// Embree calls this while it builds, on any thread.
static bool may_go_on(void *user, double done) {
  (void)done;
  return !olx_task_cancelled(user);
}

// Attaches geometry 0 or 1. Returns false when Embree is out of memory.
static bool attach_geometry(olx_bvh_tree *bvh, uint32_t geometry_id, uint32_t triangle_count, RTCBuffer vertices) {
  if (triangle_count == 0) return true;
  const olx_scene *scene = bvh->scene;
  RTCGeometry geometry = rtcNewGeometry(bvh->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!geometry) return false;
  rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, sizeof(olx_vec3),
                       scene->vertex_count);
  const size_t stride = 3 * sizeof(uint32_t);
  uint32_t *indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, stride, triangle_count);
  if (indices) {
    for (uint32_t i = 0; i < triangle_count; i++) {
      memcpy(indices + 3 * (size_t)i, scene->indices + 3 * (size_t)scene_triangle(bvh, geometry_id, i), stride);
    }
    if (geometry_id == 1) {
      rtcSetGeometryUserData(geometry, bvh);
      rtcSetGeometryIntersectFilterFunction(geometry, filter_masked);
      rtcSetGeometryOccludedFilterFunction(geometry, filter_masked);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(bvh->accelerator, geometry, geometry_id);
  }
  rtcReleaseGeometry(geometry);
  return indices != NULL;
}

static const char *const instruction_names[] = {"best", "sse2", "sse4.2", "avx", "avx2", "avx512"};

// Returns the widest of the instruction sets that Embree can use which the processor supports.
static olx_instructions best_instructions(void) {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return OLX_INSTRUCTIONS_AVX512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return OLX_INSTRUCTIONS_AVX2;
  if (__builtin_cpu_supports("avx")) return OLX_INSTRUCTIONS_AVX;
  return __builtin_cpu_supports("sse4.2") ? OLX_INSTRUCTIONS_SSE42 : OLX_INSTRUCTIONS_SSE2;
}

// Builds on one thread: the order of triangles in a leaf, which decides between coincident hits, must not depend on the
// number of processors.
static olx_result create_device(olx_bvh_tree *bvh) {
  const olx_instructions wanted = bvh->scene->load.instructions;
  char settings[64] = "threads=1,set_affinity=0";
  if (wanted > best_instructions()) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "ray caster: this processor does not have the instructions %s",
                    wanted <= OLX_INSTRUCTIONS_AVX512 ? instruction_names[wanted] : "that are named");
  }
  if (wanted) snprintf(settings, sizeof settings, "threads=1,set_affinity=0,isa=%s", instruction_names[wanted]);
  bvh->device = rtcNewDevice(settings);
  return OLX_OK;
}

// Reports the instructions in use; Embree may be built without the widest that the processor has.
olx_bvh_engine olx_bvh_describe(const olx_bvh *bvh) {
  const olx_instructions wanted = bvh->tree->scene->load.instructions;
  uint32_t used = wanted ? wanted : best_instructions();
  if (used == OLX_INSTRUCTIONS_AVX512 &&
      !rtcGetDeviceProperty(bvh->tree->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
    used = OLX_INSTRUCTIONS_AVX2;
  if (used >= OLX_INSTRUCTIONS_AVX &&
      !rtcGetDeviceProperty(bvh->tree->device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED))
    used = OLX_INSTRUCTIONS_SSE42;
  const ssize_t version = rtcGetDeviceProperty(bvh->tree->device, RTC_DEVICE_PROPERTY_VERSION);
  return (olx_bvh_engine){(uint32_t)version, instruction_names[used]};
}

static olx_result build(olx_bvh_tree *bvh) {
  const olx_scene *scene = bvh->scene;
  OLX_TRY(create_device(bvh));
  if (!bvh->device) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "ray caster: Embree refused to start (error %d)",
                    (int)rtcGetDeviceError(NULL));
  }
  rtcSetDeviceErrorFunction(bvh->device, remember_message, bvh);
  bvh->accelerator = rtcNewScene(bvh->device);
  // Embree reads vertices 16 bytes at a time, so the last one needs padding.
  const size_t vertices_bytes = (size_t)scene->vertex_count * sizeof(olx_vec3);
  RTCBuffer vertices = rtcNewBuffer(bvh->device, vertices_bytes + 16);
  if (bvh->accelerator && vertices) {
    memcpy(rtcGetBufferData(vertices), scene->positions, vertices_bytes);
    rtcSetSceneFlags(bvh->accelerator, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(bvh->accelerator, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneProgressMonitorFunction(bvh->accelerator, may_go_on, olx_task_current());
    if (attach_geometry(bvh, 0, bvh->first[1], vertices) &&
        attach_geometry(bvh, 1, scene->triangle_count - bvh->first[1], vertices)) {
      rtcCommitScene(bvh->accelerator);
    }
    rtcSetSceneProgressMonitorFunction(bvh->accelerator, NULL, NULL);
  }
  if (vertices) rtcReleaseBuffer(vertices);
  const enum RTCError error = rtcGetDeviceError(bvh->device);
  if (error == RTC_ERROR_NONE) return OLX_OK;
  if (error == RTC_ERROR_CANCELLED) return olx_fail(OLX_ERROR_CANCELLED, "ray caster: cancelled while Embree built it");
  return olx_fail(error == RTC_ERROR_OUT_OF_MEMORY ? OLX_ERROR_MEMORY : OLX_ERROR_UNSUPPORTED,
                  "ray caster: Embree could not build over %u triangles (%s)", scene->triangle_count, bvh->message);
}

olx_result olx_bvh_create(olx_scene *scene) {
  olx_bvh_tree *tree = olx_allocate_zero(1, sizeof *tree);
  if (!tree) return olx_fail(OLX_ERROR_MEMORY, "ray caster: no memory");
  tree->scene = scene;
  tree->handle = (olx_bvh){.tree = tree};
  tree->light_handle = (olx_bvh){.tree = tree, .follows_light = true};
  scene->bvh = &tree->handle;
  scene->light_bvh = &tree->light_handle;
  olx_result result;
  OLX_TRY_GOTO(split_by_mask(tree), failed);
  OLX_TRY_GOTO(build(tree), failed);
  return OLX_OK;
failed:
  olx_bvh_free(scene);
  return result;
}

void olx_bvh_free(olx_scene *scene) {
  if (!scene->bvh) return;
  olx_bvh_tree *tree = scene->bvh->tree;
  if (tree->accelerator) rtcReleaseScene(tree->accelerator);
  if (tree->device) rtcReleaseDevice(tree->device);
  olx_release(tree->triangle_of);
  olx_release(tree);
  scene->bvh = scene->light_bvh = NULL;
}

static query_context make_context(const olx_bvh *bvh, bool coherent) {
  query_context context = {.follows_light = bvh->follows_light};
  rtcInitIntersectContext(&context.embree);
  context.embree.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

static struct RTCRay single_ray(const olx_ray *ray) {
  return (struct RTCRay){
      .org_x = ray->origin.x,
      .org_y = ray->origin.y,
      .org_z = ray->origin.z,
      .tnear = ray->t_min,
      .dir_x = ray->direction.x,
      .dir_y = ray->direction.y,
      .dir_z = ray->direction.z,
      .tfar = ray->t_max,
      .mask = UINT32_MAX,
  };
}

olx_ray_hit olx_bvh_intersect(const olx_bvh *bvh, const olx_ray *ray) {
  if (!(ray->t_max >= ray->t_min)) return (olx_ray_hit){.triangle = OLX_NO_HIT};
  query_context context = make_context(bvh, false);
  struct RTCRayHit query = {.ray = single_ray(ray), .hit.geomID = RTC_INVALID_GEOMETRY_ID};
  rtcIntersect1(bvh->tree->accelerator, &context.embree, &query);
  // Without a hit tfar is still t_max.
  if (bvh->log) olx_ray_log_add(bvh->log, ray->origin, ray->direction, query.ray.tfar);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return (olx_ray_hit){.triangle = OLX_NO_HIT};
  return (olx_ray_hit){.triangle = scene_triangle(bvh->tree, query.hit.geomID, query.hit.primID),
                       .t = query.ray.tfar,
                       .u = query.hit.u,
                       .v = query.hit.v};
}

static bool is_stopped(const olx_bvh *bvh, const olx_ray *ray, float *passing) {
  if (!(ray->t_max >= ray->t_min)) return true;
  query_context context = make_context(bvh, false);
  context.passing = passing;
  struct RTCRay query = single_ray(ray);
  rtcOccluded1(bvh->tree->accelerator, &context.embree, &query);
  if (bvh->log) olx_ray_log_add(bvh->log, ray->origin, ray->direction, ray->t_max);
  return query.tfar < 0.0f;
}

bool olx_bvh_occluded(const olx_bvh *bvh, const olx_ray *ray) { return is_stopped(bvh, ray, NULL); }

float olx_bvh_transmittance(const olx_bvh *bvh, const olx_ray *ray) {
  float passing = 1.0f;
  return is_stopped(bvh, ray, &passing) ? 0.0f : passing;
}

static float segment_distance(olx_vec3 p, olx_vec3 a, olx_vec3 b) {
  const olx_vec3 along = olx_sub(b, a);
  const float length = olx_dot(along, along);
  const float t = length > 0.0f ? olx_clamp(olx_dot(olx_sub(p, a), along) / length, 0.0f, 1.0f) : 0.0f;
  return olx_length(olx_sub(p, olx_madd(a, along, t)));
}

// Returns the distance to the triangle's plane where the point projects into the triangle, otherwise to the nearest
// edge.
static float triangle_distance(olx_vec3 p, olx_vec3 a, olx_vec3 b, olx_vec3 c) {
  const olx_vec3 n = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  if (olx_dot(olx_cross(olx_sub(b, a), olx_sub(p, a)), n) >= 0.0f &&
      olx_dot(olx_cross(olx_sub(c, b), olx_sub(p, b)), n) >= 0.0f &&
      olx_dot(olx_cross(olx_sub(a, c), olx_sub(p, c)), n) >= 0.0f) {
    return fabsf(olx_dot(olx_sub(p, a), n));
  }
  return olx_min(segment_distance(p, a, b), olx_min(segment_distance(p, b, c), segment_distance(p, c, a)));
}

static bool shrink_query(struct RTCPointQueryFunctionArguments *arguments) {
  const olx_bvh_tree *bvh = arguments->userPtr;
  const olx_scene *scene = bvh->scene;
  const uint32_t *i = scene->indices + 3 * (size_t)scene_triangle(bvh, arguments->geomID, arguments->primID);
  struct RTCPointQuery *query = arguments->query;
  const float distance = triangle_distance(olx_v3(query->x, query->y, query->z), scene->positions[i[0]],
                                           scene->positions[i[1]], scene->positions[i[2]]);
  if (!(distance < query->radius)) return false;
  query->radius = distance;
  return true;
}

float olx_bvh_distance(const olx_bvh *bvh, olx_vec3 point, float limit) {
  struct RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  struct RTCPointQuery query = {.x = point.x, .y = point.y, .z = point.z, .radius = limit};
  rtcPointQuery(bvh->tree->accelerator, &query, &context, shrink_query, bvh->tree);
  return query.radius;
}

// Initializes the members of a packet that do not vary with its rays.
static void init_packet(struct RTCRay16 *packet) {
  for (uint32_t i = 0; i < OLX_PACKET; i++) {
    packet->time[i] = 0.0f;
    packet->mask[i] = UINT32_MAX;
    packet->id[i] = 0;
    packet->flags[i] = 0;
  }
}

// Packs 16 rays. A ray that ends before it starts is not traced.
static void pack_rays(const olx_ray *rays, struct RTCRay16 *packet, int *valid) {
  for (uint32_t i = 0; i < OLX_PACKET; i++) {
    packet->org_x[i] = rays[i].origin.x;
    packet->org_y[i] = rays[i].origin.y;
    packet->org_z[i] = rays[i].origin.z;
    packet->dir_x[i] = rays[i].direction.x;
    packet->dir_y[i] = rays[i].direction.y;
    packet->dir_z[i] = rays[i].direction.z;
    packet->tnear[i] = rays[i].t_min;
    packet->tfar[i] = rays[i].t_max;
  }
  for (uint32_t i = 0; i < OLX_PACKET; i++) valid[i] = packet->tfar[i] >= packet->tnear[i] ? -1 : 0;
}

// Pads the last rays of an array, which do not fill a packet, with rays that are not traced.
static const olx_ray *fill_up(const olx_ray *rays, uint32_t count, olx_ray padded[OLX_PACKET]) {
  if (count >= OLX_PACKET) return rays;
  for (uint32_t i = 0; i < OLX_PACKET; i++) {
    padded[i] = i < count ? rays[i] : (olx_ray){.direction = {0.0f, 0.0f, 1.0f}, .t_min = 0.0f, .t_max = -1.0f};
  }
  return padded;
}

void olx_bvh_intersect_many(const olx_bvh *bvh, const olx_ray *rays, uint32_t count, bool coherent, olx_ray_hit *hits) {
  query_context context = make_context(bvh, coherent);
  struct RTCRayHit16 packet;
  _Alignas(64) int valid[OLX_PACKET];
  olx_ray padded[OLX_PACKET];
  init_packet(&packet.ray);
  for (uint32_t start = 0; start < count; start += OLX_PACKET) {
    const uint32_t here = count - start < OLX_PACKET ? count - start : OLX_PACKET;
    pack_rays(fill_up(rays + start, here, padded), &packet.ray, valid);
    for (uint32_t i = 0; i < OLX_PACKET; i++) packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, bvh->tree->accelerator, &context.embree, &packet);
    for (uint32_t i = 0; i < here; i++) {
      const uint32_t geometry = packet.hit.geomID[i];
      hits[start + i] = geometry == RTC_INVALID_GEOMETRY_ID
                            ? (olx_ray_hit){.triangle = OLX_NO_HIT}
                            : (olx_ray_hit){.triangle = scene_triangle(bvh->tree, geometry, packet.hit.primID[i]),
                                            .t = packet.ray.tfar[i],
                                            .u = packet.hit.u[i],
                                            .v = packet.hit.v[i]};
    }
  }
}

void olx_bvh_occluded_many(const olx_bvh *bvh, const olx_ray *rays, uint32_t count, bool coherent, uint8_t *occluded) {
  query_context context = make_context(bvh, coherent);
  struct RTCRay16 packet;
  _Alignas(64) int valid[OLX_PACKET];
  olx_ray padded[OLX_PACKET];
  init_packet(&packet);
  for (uint32_t start = 0; start < count; start += OLX_PACKET) {
    const uint32_t here = count - start < OLX_PACKET ? count - start : OLX_PACKET;
    pack_rays(fill_up(rays + start, here, padded), &packet, valid);
    rtcOccluded16(valid, bvh->tree->accelerator, &context.embree, &packet);
    // Embree sets tfar of an occluded ray to minus infinity.
    for (uint32_t i = 0; i < here; i++) occluded[start + i] = valid[i] == 0 || packet.tfar[i] < packet.tnear[i];
  }
}
