// octalux render: renders images of a scene by path tracing or from a field, on the CPU or with indirect light from a
// Vulkan device.
#include "commands.h"
#include "exposure.h"
#include "files.h"
#include "options.h"
#include "probe_markers.h"
#include "relit_field.h"
#include "report.h"
#include "sample_options.h"
#include "scene_options.h"
#include "stop.h"
#include "vulkan_render.h"

#include <octalux/limits.h>
#include <octalux/render.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define NOT_GIVEN (UINT32_MAX - 1)

// The options of the command. 0 means not given where 0 is invalid; NOT_GIVEN elsewhere.
typedef struct render_options {
  const char *scene, *output, *png, *field, *camera, *from_camera;
  uint32_t method, size[2], spp, bounces, diffuse, diffuse_samples, glossy_samples, seed, threads, device;
  uint32_t mode, gather_samples, frames, cut, denoise, ray_spacing, emitters, relight;
  olx_sample_settings sample;
  scene_options loading;
  float exposure, dim_lobe;
  bool standard_error, show_probes, centered, validate, progress, json;
} render_options;

enum { DEVICE_CPU, DEVICE_VULKAN };

// The three ways to light an image from a field (section 5 of the paper), in the order of --mode's words.
enum { MODE_GATHER, MODE_DENOISED, MODE_PREFILTERED };

enum { DEFAULT_FRAMES = 64, DEFAULT_GATHER_SAMPLES = 64 };

static olx_denoise_settings denoise_settings(uint32_t choice) {
  return choice == 0   ? olx_denoise_settings_none()
         : choice == 1 ? olx_denoise_settings_published()
                       : olx_denoise_settings_default();
}

// Expands --mode into the settings that it abbreviates, unless more specific options override them.
static void apply_mode(const render_options *o, olx_render_settings *settings) {
  if (o->mode == MODE_GATHER) {
    const uint32_t count = o->gather_samples ? o->gather_samples : DEFAULT_GATHER_SAMPLES;
    settings->spp = 1;
    settings->diffuse_samples = settings->glossy_samples = count;
  }
  if (o->mode == MODE_GATHER || o->mode == MODE_DENOISED) settings->diffuse = OLX_DIFFUSE_TRACED;
  // Irradiance excludes direct light of emitters, so that rays have to find it.
  if (o->emitters) settings->diffuse = OLX_DIFFUSE_TRACED;
}

static olx_render_settings resolve(const render_options *o, const olx_field *field) {
  olx_render_settings settings = olx_render_settings_default((olx_method)o->method);
  if (o->size[0]) {
    settings.width = o->size[0];
    settings.height = o->size[1];
  }
  apply_mode(o, &settings);
  if (o->spp) settings.spp = o->spp;
  if (o->bounces != NOT_GIVEN) settings.bounces = o->bounces;
  // An image from the field has the field's bounces plus the one at the visible surface.
  else if (o->method == OLX_METHOD_PATH && field) settings.bounces = olx_field_describe(field).bounces.count + 1;
  if (o->diffuse != NOT_GIVEN) settings.diffuse = (olx_diffuse)o->diffuse;
  if (o->diffuse_samples) settings.diffuse_samples = o->diffuse_samples;
  if (o->glossy_samples) settings.glossy_samples = o->glossy_samples;
  settings.standard_error = o->standard_error;
  settings.seed = o->seed;
  settings.centered = o->centered;
  settings.dim_lobe = o->dim_lobe;
  settings.denoise = denoise_settings(o->denoise);
  if (o->ray_spacing) settings.denoise.ray_spacing = o->ray_spacing;
  settings.threads = o->threads;
  settings.sample = o->sample;
  settings.sample.emitters = o->emitters != 0;
  return settings;
}

static int check_frames(render_options *o) {
  if (o->mode == MODE_DENOISED && !o->frames) o->frames = DEFAULT_FRAMES;
  if (o->frames && (o->method != OLX_METHOD_FIELD || o->mode == MODE_GATHER)) {
    return usage_error("render", "--frames goes with --method field and --mode denoised or prefiltered");
  }
  if (o->gather_samples && o->mode != MODE_GATHER)
    return usage_error("render", "--gather-samples goes with --mode gather");
  if (o->ray_spacing && !o->frames) return usage_error("render", "--ray-spacing goes with --frames");
  if (o->from_camera && !o->frames) return usage_error("render", "--from-camera goes with --frames");
  if (o->cut && (!o->from_camera || o->cut >= o->frames)) {
    return usage_error("render", "--cut goes with --from-camera, and is less than --frames");
  }
  const bool stored = o->diffuse != NOT_GIVEN ? o->diffuse != OLX_DIFFUSE_TRACED : o->mode == MODE_PREFILTERED;
  if (o->emitters && stored) {
    return usage_error("render",
                       "--emitters traced needs traced diffuse light: --mode gather or denoised, or --diffuse traced");
  }
  return EXIT_DONE;
}

static int check_device(const render_options *o) {
  if (o->validate && o->device != DEVICE_VULKAN) return usage_error("render", "--validate goes with --device vulkan");
  if (o->device != DEVICE_VULKAN) return EXIT_DONE;
  if (o->method == OLX_METHOD_PATH) return usage_error("render", "--device vulkan goes with --method field or classic");
  if (o->standard_error) return usage_error("render", "--standard-error goes with --device cpu");
  return EXIT_DONE;
}

// Rejects contradictory options; returns 0 when there are none.
static int check_options(render_options *o) {
  const bool exr = ends_with(o->output, ".exr");
  if (!exr && !is_output_named(o->output, ".png")) {
    return usage_error("render", "-o: '%s' ends in neither .exr nor .png", o->output);
  }
  if (o->png && (!exr || !is_output_named(o->png, ".png"))) {
    return usage_error("render", "--png FILE.png goes with -o FILE.exr");
  }
  if (!exr) o->png = o->output;
  if (o->method == NOT_GIVEN) o->method = o->field ? OLX_METHOD_FIELD : OLX_METHOD_PATH;
  if (o->method != OLX_METHOD_PATH && !o->field) {
    return usage_error("render", o->method == OLX_METHOD_FIELD ? "--method field needs --field FILE.olx"
                                                               : "--method classic needs --field FILE.olx");
  }
  const bool traces = o->diffuse == OLX_DIFFUSE_TRACED || o->emitters;
  if ((o->method != OLX_METHOD_FIELD && o->mode != NOT_GIVEN) || (o->method == OLX_METHOD_CLASSIC && traces)) {
    return usage_error("render", "--mode, --diffuse traced and --emitters traced go with --method field");
  }
  if (o->relight && o->method != OLX_METHOD_FIELD) {
    return usage_error("render", "--relight goes with --method field");
  }
  if (o->relight && o->diffuse == OLX_DIFFUSE_IRRADIANCE) {
    return usage_error("render", "irradiance probes are not lit anew: --diffuse irradiance does not go with --relight");
  }
  if (o->show_probes && (!o->field || !o->png)) {
    return usage_error("render", "--show-probes needs --field and a .png to draw into");
  }
  if (o->exposure > 0.0f && !o->png) return usage_error("render", "--exposure needs a .png to apply to");
  const int code = check_frames(o);
  return code == EXIT_DONE ? check_device(o) : code;
}

static void print_relighting(cJSON *object, cJSON *passes, const relit_field *relit, const vulkan_timing *timing) {
  add_number(passes, "relight", relit->seconds);
  cJSON *relight = cJSON_AddObjectToObject(object, "relight");
  add_number(relight, "frames", relit->frames);
  add_number(relight, "awake", relit->last.awake);
  if (timing->device[0]) add_number(relight, "copied_bytes", (double)timing->updated_bytes);
}

static int print_render_json(const olx_render_stats *stats, const vulkan_timing *timing, const relit_field *relit,
                             const olx_image *image) {
  cJSON *object = cJSON_CreateObject();
  add_number(object, "width", image->width);
  add_number(object, "height", image->height);
  add_number(object, "seconds", stats->seconds);
  cJSON *passes = cJSON_AddObjectToObject(object, "passes");
  add_number(passes, "primary", stats->primary_seconds);
  add_number(passes, "direct", stats->direct_seconds);
  add_number(passes, "indirect_diffuse", stats->diffuse_seconds);
  add_number(passes, "indirect_glossy", stats->glossy_seconds);
  add_number(passes, "denoise", stats->denoise_seconds);
  if (timing->device[0]) {
    cJSON_AddStringToObject(object, "device", timing->device);
    add_number(passes, "upload", timing->upload_seconds);
    if (relit->relight) add_number(passes, "update", timing->update_seconds);
  }
  if (relit->relight) print_relighting(object, passes, relit, timing);
  add_number(object, "rays", (double)stats->rays);
  add_number(object, "field_rays", (double)stats->field_rays);
  add_number(object, "field_unresolved", (double)stats->field_unresolved);
  add_number(object, "field_steps", (double)stats->field_steps);
  add_number(object, "field_probes", (double)stats->field_probes);
  return print_json("render", object);
}

static void print_render(const char *path, const olx_render_stats *stats, const relit_field *relit,
                         const olx_image *image) {
  printf("%s: %ux%u in %.2f seconds\n", path, image->width, image->height, stats->seconds);
  printf("  rays cast           %" PRIu64 "\n", stats->rays);
  if (relit->relight) {
    printf("  relit               in %u frames, %.2f seconds; %u parts of its light under way\n", relit->frames,
           relit->seconds, relit->last.awake);
  }
  if (stats->field_rays == 0) return;
  printf("  rays through field  %" PRIu64 ", %.2f %% of them unresolved\n", stats->field_rays,
         100.0 * (double)stats->field_unresolved / (double)stats->field_rays);
}

static int save_picture(const render_options *o, const olx_field *field, const olx_camera *camera, olx_image *image) {
  if (stop_requested()) return failure("render", "%s: interrupted, nothing written", o->output);
  if (o->output != o->png && olx_image_save(image, o->output) != OLX_OK) return library_failure("render");
  if (!o->png) return EXIT_DONE;
  if (o->show_probes) draw_probe_markers(field, camera, image);
  const float exposure = o->exposure > 0.0f ? o->exposure : 1.0f;
  const olx_result result = olx_image_save_layer_png(image, OLX_LAYER_BEAUTY, exposure, o->png);
  if (result != OLX_OK) return library_failure("render");
  warn_about_exposure(o->png, image, exposure);
  return EXIT_DONE;
}

static olx_vec3 between(olx_vec3 a, olx_vec3 b, float t) {
  return (olx_vec3){a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t};
}

// Sets the camera of each frame: constantly `to`; or in equal steps from `from` to `to` in the last frame; or `from`,
// and `to` after the cut.
static void move_camera(const render_options *o, const olx_camera *from, const olx_camera *to, olx_camera *cameras) {
  for (uint32_t i = 0; i < o->frames; i++) {
    const bool after_cut = o->cut && i >= o->frames - o->cut;
    const float t = after_cut ? 1.0f : o->cut ? 0.0f : (float)i / (float)(o->frames > 1 ? o->frames - 1 : 1);
    cameras[i] = *to;
    cameras[i].eye = between(from->eye, to->eye, t);
    cameras[i].target = between(from->target, to->target, t);
    cameras[i].up = between(from->up, to->up, t);
    cameras[i].fov_y_degrees = from->fov_y_degrees + (to->fov_y_degrees - from->fov_y_degrees) * t;
  }
}

// Creates the camera of each frame, or the only camera; NULL, with *result, on failure. The caller frees them.
static olx_camera *make_cameras(const render_options *o, const olx_scene *scene, const olx_camera *camera,
                                olx_result *result) {
  olx_camera from = *camera;
  *result = o->from_camera ? olx_scene_find_camera(scene, o->from_camera, &from) : OLX_OK;
  if (*result != OLX_OK) return NULL;
  olx_camera *cameras = malloc((o->frames ? o->frames : 1) * sizeof *cameras);
  if (!cameras) *result = OLX_ERROR_MEMORY;
  else if (o->frames) move_camera(o, &from, camera, cameras);
  else cameras[0] = *camera;
  return cameras;
}

// The inputs and the results of rendering an image.
typedef struct render_job {
  const render_options *options;
  const olx_scene *scene;
  const olx_field *field; // as baked
  relit_field relit;      // without a relighter the field is unchanged
  const olx_camera *cameras;
  const olx_progress *progress;
  olx_image image;
  olx_render_stats stats;
  vulkan_timing timing;
  char problem[VULKAN_PROBLEM_BYTES]; // error of the Vulkan device; empty: none
} render_job;

static olx_result render_on_cpu(render_job *job) {
  const olx_render_settings settings = resolve(job->options, job->field);
  const olx_field *field = job->relit.relight ? olx_relight_field(job->relit.relight) : job->field;
  if (!job->options->frames) {
    return olx_render(job->scene, field, job->cameras, &settings, job->progress, &job->image, &job->stats);
  }
  return olx_render_frames(job->scene, field, job->cameras, job->options->frames, &settings, job->progress, &job->image,
                           &job->stats);
}

// Renders surfaces and direct light on the CPU, indirect light on the GPU.
static olx_result render_on_vulkan(render_job *job) {
#ifdef OLX_HAS_VULKAN
  const olx_render_settings settings = resolve(job->options, job->field);
  const vulkan_request request = {.scene = job->scene,
                                  .field = job->field,
                                  .relight = job->relit.relight,
                                  .cameras = job->cameras,
                                  .camera_count = job->options->frames ? job->options->frames : 1,
                                  .denoised = job->options->frames != 0,
                                  .settings = &settings,
                                  .validate = job->options->validate,
                                  .progress = job->progress};
  return vulkan_render(&request, &job->image, &job->stats, &job->timing, job->problem);
#else
  snprintf(job->problem, sizeof job->problem, "this program was built without the Vulkan runtime");
  return OLX_OK;
#endif
}

static olx_result render_job_run(render_job *job) {
  const render_options *o = job->options;
  if (o->relight) {
    const olx_result result =
        relit_field_make(job->scene, job->field, job->cameras[0].eye, o->relight, o->threads, &job->relit);
    if (result != OLX_OK) return result;
  }
  return o->device == DEVICE_VULKAN ? render_on_vulkan(job) : render_on_cpu(job);
}

static int render_picture(const render_options *o, const olx_scene *scene, const olx_field *field,
                          const command_files *files) {
  olx_camera camera;
  olx_result result;
  if (olx_scene_find_camera(scene, o->camera, &camera) != OLX_OK) return library_failure("render");
  olx_camera *cameras = make_cameras(o, scene, &camera, &result);
  if (!cameras) return library_failure("render");
  progress_line line;
  progress_begin(&line, "render", o->progress);
  const olx_progress progress = progress_of(&line);
  render_job job = {.options = o, .scene = scene, .field = field, .cameras = cameras, .progress = &progress};
  result = render_job_run(&job);
  progress_end(&line);
  free(cameras);
  olx_relight_free(job.relit.relight);
  if (*job.problem) return failure("render", "--device vulkan: %s", job.problem);
  if (result == OLX_ERROR_CANCELLED) return failure("render", "%s: interrupted, nothing written", o->output);
  if (result != OLX_OK) return library_failure("render");
  int code = save_picture(o, field, &camera, &job.image);
  if (code == EXIT_DONE && o->json) code = print_render_json(&job.stats, &job.timing, &job.relit, &job.image);
  if (code == EXIT_DONE && !o->json) {
    print_beside_outputs(files);
    print_render(o->output, &job.stats, &job.relit, &job.image);
  }
  olx_image_free(&job.image);
  return code;
}

static int render_scene(const render_options *o, const command_files *files) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  int code = load_scene("render", o->scene, &o->loading, &scene);
  if (code != EXIT_DONE) return code;
  code = check_scene_files("render", files, scene);
  if (code != EXIT_DONE) {
    olx_scene_free(scene);
    return code;
  }
  if (o->field && olx_field_open(o->field, &field) != OLX_OK) code = library_failure("render");
  else code = render_picture(o, scene, field, files);
  olx_field_close(field);
  olx_scene_free(scene);
  return code;
}

static const option render_basic_options[] = {
    {"-o", OPTION_TEXT, offsetof(render_options, output), "FILE", ".exr: every layer, linear; .png, or -: tone-mapped",
     1},
    {"--png", OPTION_TEXT, offsetof(render_options, png), "FILE.png", "beside an .exr, the same picture tone-mapped"},
    {"--field", OPTION_TEXT, offsetof(render_options, field), "FILE.olx", "the field that gives indirect light"},
    {"--camera", OPTION_TEXT, offsetof(render_options, camera), "NAME", "a camera of the scene; default: the first"},
    {"--size", OPTION_SIZE, offsetof(render_options, size), "1280x720", "pixels; default 1280x720", 1,
     OLX_PICTURE_SIZE_MOST},
    {"--spp", OPTION_COUNT, offsetof(render_options, spp), "N",
     "camera samples a pixel; default 64 for path, 4 for field", 1, OLX_PICTURE_SPP_MOST},
    {"--exposure", OPTION_REAL, offsetof(render_options, exposure), "X",
     "multiply light before the tone map of a .png; default 1"},
    {"--show-probes", OPTION_FLAG, offsetof(render_options, show_probes), NULL, "draw the field's probes into a .png"},
    {"--device", OPTION_CHOICE, offsetof(render_options, device), "cpu|vulkan",
     "where to compute indirect light; vulkan: camera samples through pixel centres; default cpu"},
    {"--threads", OPTION_COUNT, offsetof(render_options, threads), "N",
     "default 0: every processor; the image is the same", 0, 4096},
    {0}};

static const option render_quality_options[] = {
    {"--method", OPTION_CHOICE, offsetof(render_options, method), "field|path|classic",
     "classic: from the maps of bake --classic; default: field with --field, else path"},
    {"--mode", OPTION_CHOICE, offsetof(render_options, mode), "gather|denoised|prefiltered",
     "field: gather by rays; one ray a lobe, denoised; or irradiance and glossy rays; default prefiltered"},
    {"--diffuse", OPTION_CHOICE, offsetof(render_options, diffuse), "surface|irradiance|traced",
     "field: diffuse light stored at surfaces, at irradiance probes, or from rays; default surface"},
    {"--glossy-samples", OPTION_COUNT, offsetof(render_options, glossy_samples), "N",
     "field: glossy rays a sample; default 4", 1, OLX_PICTURE_LOBE_SAMPLES_MOST},
    {"--diffuse-samples", OPTION_COUNT, offsetof(render_options, diffuse_samples), "N",
     "field: rays a sample when traced; default 64", 1, 4096},
    {"--gather-samples", OPTION_COUNT, offsetof(render_options, gather_samples), "N",
     "gather: rays a lobe and pixel; default 64", 1, OLX_PICTURE_LOBE_SAMPLES_MOST},
    {"--bounces", OPTION_BOUNCES, offsetof(render_options, bounces), "N|inf",
     "path: indirect bounces; default: as --field gives, else inf", 0, 1024},
    {"--standard-error", OPTION_FLAG, offsetof(render_options, standard_error), NULL,
     "also a layer with beauty's standard error"},
    {"--seed", OPTION_COUNT, offsetof(render_options, seed), "N", "another one gives other noise; default 0", 0,
     UINT32_MAX},
    {0}};

static const option render_frame_options[] = {
    {"--frames", OPTION_COUNT, offsetof(render_options, frames), "N",
     "denoised, prefiltered: make N frames as in real time, keep the last; denoised: 64", 1, 100000},
    {"--denoise", OPTION_CHOICE, offsetof(render_options, denoise), "none|published|adaptive",
     "how frames are filtered; default adaptive"},
    {"--ray-spacing", OPTION_COUNT, offsetof(render_options, ray_spacing), "1|2",
     "frames: 2 traces one pixel of each 2x2 a frame, in turn: a quarter of the rays; default 1", 1, 2},
    {"--from-camera", OPTION_TEXT, offsetof(render_options, from_camera), "NAME",
     "frames: begin here and glide to --camera"},
    {"--cut", OPTION_COUNT, offsetof(render_options, cut), "N", "frames: no glide, but a cut before the last N", 1,
     100000},
    {"--relight", OPTION_COUNT, offsetof(render_options, relight), "N",
     "field of bake --relight: follow SCENE's lights for N frames first, fewer when all is settled", 1, 100000},
    {0}};

static const option render_research_options[] = {
    {"--centered", OPTION_FLAG, offsetof(render_options, centered), NULL, "all samples through the pixel's centre"},
    {"--emitters", OPTION_CHOICE, offsetof(render_options, emitters), "sampled|traced",
     "lamps with an area: sampled by direct light, or found by rays; default sampled"},
    {"--dim-lobe", OPTION_REAL, offsetof(render_options, dim_lobe), "F",
     "do not trace rough lobes that reflect less than this share"},
    {0}};

static const option validate_option[] = {
    {"--validate", OPTION_FLAG, 0, NULL, "vulkan: check every call with the validation layers"}, {0}};

int command_render(int argc, char **argv) {
  render_options o = {.method = NOT_GIVEN,
                      .bounces = NOT_GIVEN,
                      .diffuse = NOT_GIVEN,
                      .mode = NOT_GIVEN,
                      .denoise = 2,
                      .sample = olx_sample_settings_default()};
  command_line line = {.name = "render",
                       .summary = "Render a picture of a scene, its indirect light from a field or path traced.",
                       .example = "octalux render room.gltf --field room.olx -o room.exr --png room.png",
                       .arguments = {"SCENE"},
                       .tables = {{render_basic_options, &o},
                                  {progress_option, &o.progress},
                                  {json_option, &o.json},
                                  {render_quality_options, &o, "Quality"},
                                  {render_frame_options, &o, "Frames as in real time"},
                                  {scene_loading_options, &o.loading, "Models"},
                                  {render_research_options, &o, RESEARCH},
                                  {sample_options, &o.sample},
                                  {validate_option, &o.validate}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  o.scene = line.given[0];
  code = check_options(&o);
  if (code != EXIT_DONE) return code;
  const bool exr = o.output != o.png;
  const command_files files = {.inputs = {o.scene, o.field},
                               .outputs = {{exr ? o.output : NULL, false}, {o.png, true}}};
  code = check_files("render", &files, o.json);
  if (code != EXIT_DONE) return code;
  if (o.method != OLX_METHOD_PATH && o.bounces != NOT_GIVEN) {
    warn("--bounces changes nothing here; a field's bounces are chosen when it is baked");
  }
  return render_scene(&o, &files);
}
