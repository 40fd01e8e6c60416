// Measures how long a bake takes to capture its probes when a Vulkan device rasterises what they see, beside rays.
#include "capture_ways.h"

#include <math.h>

#ifdef OLX_HAS_VULKAN
#include "cube_raster.h"
#endif

static const bench_column columns[] = {
    {"capture", "capture", BENCH_NAME, NULL, "how light field probes look around"},
    {"device", "device", BENCH_NAME, NULL, NULL},
    {"capture_s", "time", BENCH_TIME, "s", "processor time of the stage that finds what they see, with its light"},
    {"raster_s", "of it cube maps", BENCH_TIME, "s", "drawn and read back"},
};

static void add_row(bench *b, bench_table *table, const char *name, const char *device, const bench_field *made) {
  FINDINGS_ROW(&b->found, table, TEXT_CELL(name), TEXT_CELL(device), NUMBER_CELL(made->capture_seconds),
               NUMBER_CELL(made->raster_seconds > 0.0 ? made->raster_seconds : NAN));
}

#ifdef OLX_HAS_VULKAN
static olx_result add_rasterised(bench *b, bench_table *table, const olx_scene *scene, const bench_probes *probes,
                                 const bench_bake *bake) {
  gpu_device device;
  if (!gpu_device_open(&(gpu_device_options){.device = UINT32_MAX}, &device)) {
    bench_progress(b, "no probes are rasterised: %s", device.problem);
    return OLX_OK;
  }
  cube_raster *raster;
  olx_result result = OLX_OK;
  if (cube_raster_create(&device, scene, &raster)) {
    bench_bake own = *bake;
    bench_field made;
    own.raster = cube_raster_interface(raster);
    own.classic_size = 0;
    result = bench_bake_field(b, scene, probes, &own, &made);
    if (result == OLX_OK) add_row(b, table, "cube maps", device.properties.deviceName, &made);
    bench_field_close(&made);
    cube_raster_destroy(raster);
  } else {
    bench_progress(b, "no probes are rasterised: %s", device.problem);
  }
  gpu_device_close(&device);
  return result;
}
#else
static olx_result add_rasterised(bench *b, bench_table *table, const olx_scene *scene, const bench_probes *probes,
                                 const bench_bake *bake) {
  (void)table;
  (void)scene;
  (void)probes;
  (void)bake;
  bench_progress(b, "no probes are rasterised: built without the Vulkan runtime");
  return OLX_OK;
}
#endif

olx_result compare_capture(bench *b, const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                           const bench_field *cast) {
  bench_table *table = findings_table(&b->found, "capture",
                                      "Time of capturing light field probes by rays and by cube maps, two-rooms-sealed",
                                      columns, sizeof columns / sizeof *columns, NULL, 0);
  add_row(b, table, "rays", "processor", cast);
  return add_rasterised(b, table, scene, probes, bake);
}
