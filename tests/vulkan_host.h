// A host to test the recorded passes with: a device, images of a room as a renderer would have drawn them, and the
// passes' outputs, read back.
#ifndef OLX_TESTS_VULKAN_HOST_H
#define OLX_TESTS_VULKAN_HOST_H

#include "analytic_field.h"
#include "gpu_memory.h"

// Opens the device that the tests of a program share: any device will do, also a CPU. Its driver stays loaded. Returns
// false when there is none; tests that call host_need_device are then skipped.
bool host_open_device(gpu_device *device, bool validate);
void host_need_device(const gpu_device *device);
// Returns 0, or 1 when the validation layers name an object that was not destroyed.
int host_close_device(gpu_device *device);

// Input images: depth, normal, albedo, roughness, and those that a test may add to the targets: geometric normal,
// vertex normal, dynamic.
enum { HOST_GEOMETRIC_NORMAL = 4, HOST_VERTEX_NORMAL, HOST_DYNAMIC, HOST_INPUTS, HOST_OUTPUTS = 3 };

// A view along -z with reversed, infinite depth: HOST_NEAR / distance. Pixel (x, y) of width * height; `shift` moves
// the picture over the image plane, in pixels, as a jittered projection does.
#define HOST_NEAR 0.1f
#define HOST_SPREAD 0.8f
typedef struct host_view {
  const analytic_scene *scene;
  olx_vec3 eye;
  uint32_t width, height;
  olx_vec2 shift;
  float bend; // strength of bent normals: the vertex normal is slightly off the geometric one, the shading normal more
} host_view;

// A pixel of the host's picture: each has another roughness, metallic and weight; the four columns at the left are
// empty.
typedef struct host_pixel {
  bool empty;
  float depth;  // value of the depth image
  float metres; // distance along the viewing axis, in metres
  olx_vec3 position, geometric_normal, vertex_normal, view, color;
  olx_vec3 stored_normal, normal; // in the image of normals, and as the passes take it: turned towards the eye
  bool dynamic; // dynamic in every other square of 4 x 4 pixels, as on a chessboard
  float roughness, metallic, weight;
} host_pixel;

host_pixel host_pixel_at(const host_view *view, uint32_t x, uint32_t y);
// Returns the view's parameters for the passes.
olx_vulkan_view host_vulkan_view(const host_view *view);

typedef struct host_images {
  gpu_device *device;
  uint32_t width, height;
  gpu_buffer staging;
  gpu_image inputs[HOST_INPUTS], outputs[HOST_OUTPUTS]; // outputs are irradiance, glossy light and color
  olx_vulkan_targets targets;
} host_images;

// Makes the images, with normals of the given format; fails the test when anything fails.
host_images host_images_make(gpu_device *device, uint32_t width, uint32_t height, VkFormat normal);
// Returns an input that targets may name.
olx_vulkan_image host_input(const host_images *host, uint32_t input);
void host_images_free(host_images *host);

// Record commands that fill the inputs with what a view shows and clear outputs to HOST_BEFORE, and commands that copy
// the outputs to where host_output reads them.
#define HOST_BEFORE olx_v3(0.5f, 0.25f, 0.125f)
void host_upload(host_images *host, const host_view *view);
void host_download(host_images *host);
olx_vec3 host_output(const host_images *host, uint32_t image, uint32_t pixel, float *alpha);

// A room with a box in it, and a field of 2 x 2 x 2 probes that light it (analytic_field_free).
extern const analytic_scene HOST_ROOM;
olx_field *host_field_make(uint32_t size, uint32_t irradiance_size);

// A field of host_field_make on the CPU and on the device. The test adds images and a frame.
typedef struct host_fixture {
  gpu_device *device;
  uint32_t messages; // number of messages of the validation layers at the beginning
  olx_field *field;
  olx_vulkan_field *uploaded;
  host_images images;
  olx_vulkan_frame *frame;
} host_fixture;

// Makes a fixture, or skips the test when there is no device.
host_fixture host_fixture_make(gpu_device *device, uint32_t size, uint32_t irradiance_size);
void host_fixture_add_frame(host_fixture *fixture);
// Frees a fixture, and fails the test when the validation layers have found a fault.
void host_fixture_free(host_fixture *fixture);

#endif
