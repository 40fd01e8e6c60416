// Rasterises cube maps of many probes in one submission, and reads them back.
#include "cube_raster.h"

#include "cube_pass.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct cube_raster {
  gpu_device *device;
  cube_scene scene;
  float near;
  cube_pass pass;    // of the faces that were asked for last
  gpu_buffer texels; // of the probes of one submission
  olx_bake_raster interface;
  char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE + VK_MAX_DRIVER_NAME_SIZE + VK_MAX_DRIVER_INFO_SIZE + 4];
};

// Nothing nearer to a probe than this share of the scene's diagonal is drawn.
static const float near_share = 1e-6f;

// Makes the pass and the buffer fit what is asked for.
static bool prepare(cube_raster *r, uint32_t count, uint32_t side) {
  gpu_device *d = r->device;
  const VkDeviceSize bytes = (VkDeviceSize)count * CUBE_FACES * side * side * sizeof(uint32_t);
  if (r->pass.side != side) {
    cube_pass_destroy(d, &r->pass);
    if (!cube_pass_create(d, &r->scene, side, r->near, &r->pass)) {
      cube_pass_destroy(d, &r->pass);
      return false;
    }
  }
  if (r->texels.bytes >= bytes) return true;
  gpu_buffer_destroy(d, &r->texels);
  return gpu_buffer_create(d, "cube maps", bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, &r->texels);
}

static const char *look(void *user, const olx_vec3 *positions, uint32_t count, uint32_t side, uint32_t *triangles) {
  cube_raster *r = user;
  gpu_device *d = r->device;
  const VkDeviceSize face_bytes = (VkDeviceSize)side * side * sizeof *triangles;
  if (!prepare(r, count, side) || !gpu_commands_begin(d)) return d->problem;
  for (uint32_t i = 0; i < count * CUBE_FACES; i++) {
    cube_pass_record(d, &r->pass, &r->scene, positions[i / CUBE_FACES], i % CUBE_FACES, &r->texels, i * face_bytes);
  }
  gpu_memory_barrier(d, d->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                     VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
  if (!gpu_commands_run(d)) return d->problem;
  memcpy(triangles, r->texels.mapped, count * CUBE_FACES * face_bytes);
  return d->validation_messages ? "the validation layers found fault (see above)" : NULL;
}

static float diagonal_of(const olx_scene_content *c) {
  const float x = c->bounds_max.x - c->bounds_min.x, y = c->bounds_max.y - c->bounds_min.y,
              z = c->bounds_max.z - c->bounds_min.z;
  return sqrtf(x * x + y * y + z * z);
}

bool cube_raster_create(gpu_device *d, const olx_scene *scene, cube_raster **raster) {
  const olx_scene_content content = olx_scene_get_content(scene);
  *raster = NULL;
  cube_raster *r = calloc(1, sizeof *r);
  if (!r) return gpu_fail(d, "out of memory");
  r->device = d;
  r->near = near_share * diagonal_of(&content);
  snprintf(r->name, sizeof r->name, "%s, %s %s", d->properties.deviceName, d->driver.driverName, d->driver.driverInfo);
  for (char *c = r->name; *c; c++) {
    if (*c == '\n' || *c == '\r') *c = ' ';
  }
  r->interface = (olx_bake_raster){.name = r->name, .look = look, .user = r};
  if (cube_scene_create(d, &content, &r->scene)) {
    *raster = r;
    return true;
  }
  cube_raster_destroy(r);
  return false;
}

void cube_raster_destroy(cube_raster *r) {
  if (!r) return;
  cube_pass_destroy(r->device, &r->pass);
  cube_scene_destroy(r->device, &r->scene);
  gpu_buffer_destroy(r->device, &r->texels);
  free(r);
}

const olx_bake_raster *cube_raster_interface(const cube_raster *r) { return &r->interface; }
