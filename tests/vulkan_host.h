// A host that the recorded passes are tested with: a device, images of a room as a renderer would have drawn them, and
// what the passes write, read back.
#ifndef OLX_TESTS_VULKAN_HOST_H
#define OLX_TESTS_VULKAN_HOST_H

#include "analytic_field.h"
#include "gpu_memory.h"

// The device that the tests of a program share: any will do, a CPU one too. Its driver stays loaded. False: there is
// none, and tests that call host_need_device are skipped.
bool host_open_device(gpu_device *device, bool validate);
void host_need_device(const gpu_device *device);
// 0; 1 when the validation layers name something that was not destroyed.
int host_close_device(gpu_device *device);

// Inputs: depth, normal, albedo, roughness, and what a test may add to the targets: geometric normal, vertex normal,
// dynamic.
enum { HOST_GEOMETRIC_NORMAL = 4, HOST_VERTEX_NORMAL, HOST_DYNAMIC, HOST_INPUTS, HOST_OUTPUTS = 3 };

// A view along -z with reversed, endless depth: HOST_NEAR / distance. Pixel (x, y) of width * height; `shift` moves the
// picture over the image plane, in pixels, as a jittered projection does.
#define HOST_NEAR 0.1f
#define HOST_SPREAD 0.8f
typedef struct host_view {
  const analytic_scene *scene;
  olx_vec3 eye;
  uint32_t width, height;
  olx_vec2 shift;
  float bend; // how far normals are bent: the vertex normal a little off the geometric one, the shading normal more
} host_view;

// What the host has rendered: every pixel of another roughness, metallic and weight; its four columns at the left show
// nothing.
typedef struct host_pixel {
  bool empty;
  float depth;  // as the depth image has it
  float metres; // along the viewing axis
  olx_vec3 position, normal, geometric_normal, vertex_normal, view, color;
  bool dynamic; // squares of 4 x 4 pixels, as on a chessboard
  float roughness, metallic, weight;
} host_pixel;

host_pixel host_pixel_at(const host_view *view, uint32_t x, uint32_t y);
// For the passes.
olx_vulkan_view host_vulkan_view(const host_view *view);

typedef struct host_images {
  gpu_device *device;
  uint32_t width, height;
  gpu_buffer staging;
  gpu_image inputs[HOST_INPUTS], outputs[HOST_OUTPUTS]; // outputs: irradiance, glossy, color
  olx_vulkan_targets targets;
} host_images;

// Asserts that nothing fails. Normals are of the given format.
host_images host_images_make(gpu_device *device, uint32_t width, uint32_t height, VkFormat normal);
// An input that targets may name.
olx_vulkan_image host_input(const host_images *host, uint32_t input);
void host_images_free(host_images *host);

// Record filling the inputs with what a view shows, and making outputs HOST_BEFORE; and copying the outputs to where
// host_output reads them.
#define HOST_BEFORE olx_v3(0.5f, 0.25f, 0.125f)
void host_upload(host_images *host, const host_view *view);
void host_download(host_images *host);
olx_vec3 host_output(const host_images *host, uint32_t image, uint32_t pixel, float *alpha);

// A room with a box in it, and a field of 2 x 2 x 2 probes that light it (analytic_field_free).
extern const analytic_scene HOST_ROOM;
olx_field *host_field_make(uint32_t size, uint32_t irradiance_size);

// That field on both sides. Images and a frame are the test's to add.
typedef struct host_fixture {
  gpu_device *device;
  uint32_t messages; // of the validation layers, before
  olx_field *field;
  olx_vulkan_field *uploaded;
  host_images images;
  olx_vulkan_frame *frame;
} host_fixture;

// The test is skipped when there is no device.
host_fixture host_fixture_make(gpu_device *device, uint32_t size, uint32_t irradiance_size);
void host_fixture_add_frame(host_fixture *fixture);
// The validation layers must have found nothing.
void host_fixture_free(host_fixture *fixture);

#endif
