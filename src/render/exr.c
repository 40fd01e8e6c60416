// Reads and writes multi-layer images of floats with OpenEXR's C core.
#include "render/image_io.h"

#include "core/file.h"
#include "core/result.h"
#include "scene/images/exr_file.h"

#include <stdio.h>
#include <string.h>

#include <OpenEXR/openexr.h>

// The stream of a file that is being written, and the first error that OpenEXR reported.
typedef struct exr_stream {
  const char *path;
  olx_output_file *output;
  bool write_failed; // the reason is in olx_last_error
  char message[256];
} exr_stream;

#define BOUNCES_ATTRIBUTE "octaluxBounces"

static void channel_name(olx_layer layer, uint32_t component, char name[64]) {
  const char *components = layer == OLX_LAYER_NORMAL ? "XYZ" : layer == OLX_LAYER_DEPTH ? "Z" : "RGB";
  if (layer == OLX_LAYER_BEAUTY) snprintf(name, 64, "%c", components[component]);
  else snprintf(name, 64, "%s.%c", olx_layer_name(layer), components[component]);
}

// Finds the layer and the component of a channel; false for channels of other programs.
static bool find_channel(const char *name, olx_layer *layer, uint32_t *component) {
  for (uint32_t l = 0; l < OLX_LAYER_COUNT; ++l) {
    for (uint32_t c = 0; c < olx_layer_channels((olx_layer)l); ++c) {
      char candidate[64];
      channel_name((olx_layer)l, c, candidate);
      if (strcmp(name, candidate) != 0) continue;
      *layer = (olx_layer)l;
      *component = c;
      return true;
    }
  }
  return false;
}

static void on_error(exr_const_context_t context, exr_result_t code, const char *message) {
  (void)code;
  void *user = NULL;
  if (!context || exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user) return;
  exr_stream *stream = user;
  if (!stream->message[0]) snprintf(stream->message, sizeof stream->message, "%s", message);
}

static int64_t on_write(exr_const_context_t context, void *user, const void *data, uint64_t size_bytes, uint64_t offset,
                        exr_stream_error_func_ptr_t error) {
  exr_stream *stream = user;
  if (olx_output_write_at(stream->output, offset, data, (size_t)size_bytes) == OLX_OK) return (int64_t)size_bytes;
  stream->write_failed = true;
  error(context, EXR_ERR_WRITE_IO, "cannot write");
  return -1;
}

static exr_context_initializer_t initializer(exr_stream *stream) {
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.error_handler_fn = on_error;
  settings.user_data = stream;
  settings.max_image_width = OLX_PICTURE_SIZE_MOST;
  settings.max_image_height = OLX_PICTURE_SIZE_MOST;
  settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
  return settings;
}

static olx_result stream_failure(const exr_stream *stream, exr_result_t code) {
  if (stream->write_failed) return OLX_ERROR_FILE;
  if (code == EXR_ERR_OUT_OF_MEMORY) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for the image", stream->path);
  return olx_fail(OLX_ERROR_FILE, "%s: %s", stream->path,
                  stream->message[0] ? stream->message : exr_get_default_error_message(code));
}

#define EXR_TRY(call)                                                                                                  \
  do {                                                                                                                 \
    const exr_result_t exr_try_code_ = (call);                                                                         \
    if (exr_try_code_ != EXR_ERR_SUCCESS) return exr_try_code_;                                                        \
  } while (0)

static exr_result_t write_header(exr_context_t context, const olx_exr_picture *picture) {
  int part = 0;
  EXR_TRY(exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part));
  EXR_TRY(exr_initialize_required_attr_simple(context, part, (int32_t)picture->width, (int32_t)picture->height,
                                              EXR_COMPRESSION_ZIP));
  for (uint32_t i = 0; i < picture->channel_count; ++i) {
    EXR_TRY(exr_add_channel(context, part, picture->channels[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1));
  }
  if (picture->bounces) EXR_TRY(exr_attr_set_int(context, part, BOUNCES_ATTRIBUTE, *picture->bounces));
  return exr_write_header(context);
}

// Returns the position of a channel in its layer from `row` on; NULL values when the image has no such layer.
static olx_exr_target find_target(void *user, const char *channel, uint32_t row) {
  const olx_image *image = user;
  olx_layer layer;
  uint32_t component;
  if (!find_channel(channel, &layer, &component) || !image->layers[layer]) return (olx_exr_target){.pixels = NULL};
  return (olx_exr_target){.pixels = &image->layers[layer][(size_t)row * image->width].x + component,
                          .pixel_bytes = sizeof(olx_vec3),
                          .line_bytes = (int32_t)(image->width * sizeof(olx_vec3))};
}

// Points a channel of a chunk at its values from `row` on.
static void take_channel(exr_coding_channel_info_t *channel, const olx_exr_picture *picture, uint32_t row) {
  for (uint32_t i = 0; i < picture->channel_count; ++i) {
    const olx_exr_channel *c = &picture->channels[i];
    if (strcmp(c->name, channel->channel_name) != 0) continue;
    channel->encode_from_ptr = (const uint8_t *)(c->values + (size_t)row * picture->width * c->stride_floats);
    channel->user_bytes_per_element = sizeof(float);
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_pixel_stride = (int32_t)(c->stride_floats * sizeof(float));
    channel->user_line_stride = (int32_t)(picture->width * c->stride_floats * sizeof(float));
  }
}

static exr_result_t write_chunks(exr_context_t context, const olx_exr_picture *picture,
                                 exr_encode_pipeline_t *pipeline) {
  int32_t lines = 0;
  EXR_TRY(exr_get_scanlines_per_chunk(context, 0, &lines));
  for (uint32_t row = 0; row < picture->height; row += (uint32_t)lines) {
    exr_chunk_info_t chunk;
    EXR_TRY(exr_write_scanline_chunk_info(context, 0, (int)row, &chunk));
    if (row == 0) EXR_TRY(exr_encoding_initialize(context, 0, &chunk, pipeline));
    else EXR_TRY(exr_encoding_update(context, 0, &chunk, pipeline));
    for (int16_t i = 0; i < pipeline->channel_count; ++i) take_channel(&pipeline->channels[i], picture, row);
    if (row == 0) EXR_TRY(exr_encoding_choose_default_routines(context, 0, pipeline));
    EXR_TRY(exr_encoding_run(context, 0, pipeline));
  }
  return EXR_ERR_SUCCESS;
}

static olx_result write_stream(exr_stream *stream, const olx_exr_picture *picture) {
  exr_context_initializer_t settings = initializer(stream);
  settings.write_fn = on_write;
  exr_context_t context = NULL;
  exr_result_t code = exr_start_write(&context, stream->path, EXR_WRITE_FILE_DIRECTLY, &settings);
  if (code != EXR_ERR_SUCCESS) return stream_failure(stream, code);
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  code = write_header(context, picture);
  if (code == EXR_ERR_SUCCESS) code = write_chunks(context, picture, &pipeline);
  exr_encoding_destroy(context, &pipeline);
  const exr_result_t finish_code = exr_finish(&context);
  if (code == EXR_ERR_SUCCESS) code = finish_code;
  return code == EXR_ERR_SUCCESS ? OLX_OK : stream_failure(stream, code);
}

olx_result olx_exr_write(const olx_exr_picture *picture, const char *path) {
  olx_output_file output;
  OLX_TRY(olx_output_open(path, &output));
  exr_stream stream = {.path = path, .output = &output};
  const olx_result result = write_stream(&stream, picture);
  if (result == OLX_OK) return olx_output_commit(&output);
  olx_output_discard(&output);
  return result;
}

olx_result olx_exr_save(const olx_image *image, const char *path) {
  olx_exr_channel channels[3 * OLX_LAYER_COUNT];
  uint32_t count = 0;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!image->layers[layer]) continue;
    for (uint32_t component = 0; component < olx_layer_channels((olx_layer)layer); ++component) {
      channel_name((olx_layer)layer, component, channels[count].name);
      channels[count].values = &image->layers[layer]->x + component;
      channels[count++].stride_floats = 3;
    }
  }
  // Infinite bounces, and numbers too large for the attribute, are stored as -1.
  const int32_t bounces = image->bounces <= INT32_MAX ? (int32_t)image->bounces : -1;
  const olx_exr_picture picture = {.width = image->width,
                                   .height = image->height,
                                   .channels = channels,
                                   .channel_count = count,
                                   .bounces = image->bounces_known ? &bounces : NULL};
  return olx_exr_write(&picture, path);
}

// The channels found, as a mask of components for each layer.
typedef struct found_layers {
  uint32_t components[OLX_LAYER_COUNT];
} found_layers;

static bool note_channel(void *user, const char *channel) {
  olx_layer layer;
  uint32_t component;
  if (!find_channel(channel, &layer, &component)) return false;
  ((found_layers *)user)->components[layer] |= 1u << component;
  return true;
}

// Finds the layers all of whose channels were found.
static olx_result find_layers(const olx_exr_file *file, uint32_t *layer_mask) {
  found_layers found = {{0}};
  OLX_TRY(olx_exr_find_channels(file, note_channel, &found));
  *layer_mask = 0;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (found.components[layer] == (1u << olx_layer_channels((olx_layer)layer)) - 1) *layer_mask |= 1u << layer;
  }
  if (*layer_mask == 0) return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: no channels R G B", file->path);
  return OLX_OK;
}

static olx_result read_image(olx_exr_file *file, olx_image *image) {
  uint32_t layer_mask = 0;
  int32_t bounces;
  OLX_TRY(find_layers(file, &layer_mask));
  OLX_TRY(olx_image_create(file->width, file->height, layer_mask, image));
  image->bounces_known = exr_attr_get_int(file->context, 0, BOUNCES_ATTRIBUTE, &bounces) == EXR_ERR_SUCCESS;
  if (image->bounces_known) image->bounces = bounces < 0 ? OLX_BOUNCES_INFINITE : (uint32_t)bounces;
  const olx_result result = olx_exr_read(file, find_target, image);
  if (result != OLX_OK) olx_image_free(image);
  return result;
}

olx_result olx_exr_load(const char *path, olx_image *image) {
  olx_exr_file file;
  olx_result result = olx_exr_open(path, &file);
  if (result == OLX_OK) result = read_image(&file, image);
  olx_exr_close(&file);
  return result;
}
