// Layered float images through OpenEXR's C core.
#include "render/image_io.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"

#include <stdio.h>
#include <string.h>

#include <OpenEXR/openexr.h>

// What the stream callbacks of one file work on, and the first complaint OpenEXR had.
typedef struct exr_stream {
  const char *path;
  olx_output_file *output;       // when writing
  const olx_mapped_file *mapped; // when reading
  bool write_failed;             // olx_last_error holds why
  char message[256];
} exr_stream;

#define BOUNCES_ATTRIBUTE "octaluxBounces"

static void channel_name(olx_layer layer, uint32_t component, char name[64]) {
  const char *components = layer == OLX_LAYER_NORMAL ? "XYZ" : layer == OLX_LAYER_DEPTH ? "Z" : "RGB";
  if (layer == OLX_LAYER_BEAUTY) snprintf(name, 64, "%c", components[component]);
  else snprintf(name, 64, "%s.%c", olx_layer_name(layer), components[component]);
}

// Which layer and component a channel holds; false for channels of other programs.
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

static int64_t on_read(exr_const_context_t context, void *user, void *data, uint64_t size_bytes, uint64_t offset,
                       exr_stream_error_func_ptr_t error) {
  const exr_stream *stream = user;
  const uint64_t total = stream->mapped->size_bytes;
  if (offset > total) {
    error(context, EXR_ERR_READ_IO, "the file ends before byte %llu", (unsigned long long)offset);
    return -1;
  }
  const uint64_t available = total - offset < size_bytes ? total - offset : size_bytes;
  if (available > 0) memcpy(data, (const uint8_t *)stream->mapped->data + offset, available);
  return (int64_t)available;
}

static int64_t on_size(exr_const_context_t context, void *user) {
  (void)context;
  return (int64_t)((const exr_stream *)user)->mapped->size_bytes;
}

// OpenEXR's own words for a file of another kind are about its bytes.
static olx_result check_kind(const char *path, const olx_mapped_file *mapped) {
  static const unsigned char magic[] = {0x76, 0x2F, 0x31, 0x01};
  const unsigned char *data = mapped->data;
  if (mapped->size_bytes == 0) return olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  if (mapped->size_bytes >= sizeof magic && memcmp(data, magic, sizeof magic) == 0) return OLX_OK;
  const bool png = mapped->size_bytes >= 4 && memcmp(data, "\x89PNG", 4) == 0;
  const bool jpeg = mapped->size_bytes >= 3 && memcmp(data, "\xFF\xD8\xFF", 3) == 0;
  return olx_fail(OLX_ERROR_FORMAT, "%s: not an OpenEXR image%s, which holds light as it is (`render -o FILE.exr`)",
                  path,
                  png    ? " but a PNG"
                  : jpeg ? " but a JPEG"
                         : "");
}

static exr_context_initializer_t initializer(exr_stream *stream) {
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.error_handler_fn = on_error;
  settings.user_data = stream;
  settings.max_image_width = OLX_IMAGE_MAX_SIZE;
  settings.max_image_height = OLX_IMAGE_MAX_SIZE;
  settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
  return settings;
}

static olx_result stream_failure(const exr_stream *stream, olx_result kind, exr_result_t code) {
  if (stream->write_failed) return OLX_ERROR_FILE;
  if (code == EXR_ERR_OUT_OF_MEMORY) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for the image", stream->path);
  return olx_fail(kind, "%s: %s", stream->path,
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

// Point a channel of a chunk at the rows of its layer from `row` on; false when the image has no place for it.
static bool attach_channel(exr_coding_channel_info_t *channel, const olx_image *image, uint32_t row) {
  olx_layer layer;
  uint32_t component;
  if (!find_channel(channel->channel_name, &layer, &component) || !image->layers[layer]) return false;
  float *pixels = &image->layers[layer][(size_t)row * image->width].x + component;
  channel->decode_to_ptr = (uint8_t *)pixels;
  channel->user_bytes_per_element = sizeof(float);
  channel->user_data_type = EXR_PIXEL_FLOAT;
  channel->user_pixel_stride = sizeof(olx_vec3);
  channel->user_line_stride = (int32_t)(image->width * sizeof(olx_vec3));
  return true;
}

// Point a channel of a chunk at its values from `row` on.
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
  if (code != EXR_ERR_SUCCESS) return stream_failure(stream, OLX_ERROR_FILE, code);
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  code = write_header(context, picture);
  if (code == EXR_ERR_SUCCESS) code = write_chunks(context, picture, &pipeline);
  exr_encoding_destroy(context, &pipeline);
  const exr_result_t finish_code = exr_finish(&context);
  if (code == EXR_ERR_SUCCESS) code = finish_code;
  return code == EXR_ERR_SUCCESS ? OLX_OK : stream_failure(stream, OLX_ERROR_FILE, code);
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
  // Beyond what the attribute holds, and infinite: -1.
  const int32_t bounces = image->bounces <= INT32_MAX ? (int32_t)image->bounces : -1;
  const olx_exr_picture picture = {.width = image->width,
                                   .height = image->height,
                                   .channels = channels,
                                   .channel_count = count,
                                   .bounces = image->bounces_known ? &bounces : NULL};
  return olx_exr_write(&picture, path);
}

static olx_result check_channel(const exr_stream *stream, const exr_attr_chlist_entry_t *channel) {
  if (channel->x_sampling != 1 || channel->y_sampling != 1) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: channel %s is subsampled", stream->path, channel->name.str);
  }
  if (channel->pixel_type != EXR_PIXEL_HALF && channel->pixel_type != EXR_PIXEL_FLOAT) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: channel %s holds integers, not light", stream->path, channel->name.str);
  }
  return OLX_OK;
}

// The layers whose every channel is there.
static olx_result find_layers(const exr_stream *stream, exr_const_context_t context, uint32_t *layer_mask) {
  const exr_attr_chlist_t *channels = NULL;
  const exr_result_t code = exr_get_channels(context, 0, &channels);
  if (code != EXR_ERR_SUCCESS) return stream_failure(stream, OLX_ERROR_FORMAT, code);
  uint32_t found[OLX_LAYER_COUNT] = {0};
  for (int i = 0; i < channels->num_channels; ++i) {
    olx_layer layer;
    uint32_t component;
    if (!find_channel(channels->entries[i].name.str, &layer, &component)) continue;
    OLX_TRY(check_channel(stream, &channels->entries[i]));
    found[layer] |= 1u << component;
  }
  *layer_mask = 0;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (found[layer] == (1u << olx_layer_channels((olx_layer)layer)) - 1) *layer_mask |= 1u << layer;
  }
  if (*layer_mask == 0) return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: no channels R G B", stream->path);
  return OLX_OK;
}

// The size of the image, after the kinds of file that are not read have been turned away.
static olx_result read_header(const exr_stream *stream, exr_const_context_t context, exr_attr_box2i_t *window) {
  exr_storage_t storage;
  exr_result_t code = exr_get_storage(context, 0, &storage);
  if (code == EXR_ERR_SUCCESS && storage != EXR_STORAGE_SCANLINE) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: a tiled or deep image; only scanlines are read", stream->path);
  }
  if (code == EXR_ERR_SUCCESS) code = exr_get_data_window(context, 0, window);
  if (code != EXR_ERR_SUCCESS) return stream_failure(stream, OLX_ERROR_FORMAT, code);
  const int64_t width = (int64_t)window->max.x - window->min.x + 1, height = (int64_t)window->max.y - window->min.y + 1;
  if (width < 1 || height < 1 || width > OLX_IMAGE_MAX_SIZE || height > OLX_IMAGE_MAX_SIZE) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %lld x %lld pixels; width and height must be 1 to %d", stream->path,
                    (long long)width, (long long)height, OLX_IMAGE_MAX_SIZE);
  }
  return OLX_OK;
}

// Every chunk lies inside the file: asked before memory is taken, so that a short file cannot claim gigabytes.
static exr_result_t check_chunks(exr_const_context_t context, const exr_attr_box2i_t *window) {
  int32_t lines = 0;
  EXR_TRY(exr_get_scanlines_per_chunk(context, 0, &lines));
  if (lines < 1) return EXR_ERR_FILE_BAD_HEADER;
  for (int64_t y = window->min.y; y <= window->max.y; y += lines) {
    exr_chunk_info_t chunk;
    EXR_TRY(exr_read_scanline_chunk_info(context, 0, (int)y, &chunk));
  }
  return EXR_ERR_SUCCESS;
}

static exr_result_t read_chunks(exr_const_context_t context, const exr_attr_box2i_t *window, const olx_image *image,
                                exr_decode_pipeline_t *pipeline) {
  int32_t lines = 0;
  EXR_TRY(exr_get_scanlines_per_chunk(context, 0, &lines));
  for (uint32_t row = 0; row < image->height; row += (uint32_t)lines) {
    exr_chunk_info_t chunk;
    EXR_TRY(exr_read_scanline_chunk_info(context, 0, window->min.y + (int)row, &chunk));
    if (row == 0) EXR_TRY(exr_decoding_initialize(context, 0, &chunk, pipeline));
    else EXR_TRY(exr_decoding_update(context, 0, &chunk, pipeline));
    for (int16_t i = 0; i < pipeline->channel_count; ++i) {
      if (!attach_channel(&pipeline->channels[i], image, row)) pipeline->channels[i].decode_to_ptr = NULL;
    }
    if (row == 0) EXR_TRY(exr_decoding_choose_default_routines(context, 0, pipeline));
    EXR_TRY(exr_decoding_run(context, 0, pipeline));
  }
  return EXR_ERR_SUCCESS;
}

static olx_result read_stream(exr_stream *stream, exr_const_context_t context, olx_image *image) {
  exr_attr_box2i_t window;
  uint32_t layer_mask = 0;
  OLX_TRY(read_header(stream, context, &window));
  OLX_TRY(find_layers(stream, context, &layer_mask));
  exr_result_t code = check_chunks(context, &window);
  if (code != EXR_ERR_SUCCESS) return stream_failure(stream, OLX_ERROR_FORMAT, code);
  OLX_TRY(olx_image_create((uint32_t)(window.max.x - window.min.x + 1), (uint32_t)(window.max.y - window.min.y + 1),
                           layer_mask, image));
  exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
  int32_t bounces;
  image->bounces_known = exr_attr_get_int(context, 0, BOUNCES_ATTRIBUTE, &bounces) == EXR_ERR_SUCCESS;
  if (image->bounces_known) image->bounces = bounces < 0 ? OLX_BOUNCES_INFINITE : (uint32_t)bounces;
  stream->message[0] = 0; // that another program's file lacks the attribute is no complaint
  code = read_chunks(context, &window, image, &pipeline);
  exr_decoding_destroy(context, &pipeline);
  if (code == EXR_ERR_SUCCESS) return OLX_OK;
  olx_image_free(image);
  return stream_failure(stream, OLX_ERROR_FORMAT, code);
}

olx_result olx_exr_load(const char *path, olx_image *image) {
  olx_mapped_file mapped;
  OLX_TRY(olx_map_file(path, &mapped));
  olx_result result = check_kind(path, &mapped);
  if (result != OLX_OK) {
    olx_unmap_file(&mapped);
    return result;
  }
  exr_stream stream = {.path = path, .mapped = &mapped};
  exr_context_initializer_t settings = initializer(&stream);
  settings.read_fn = on_read;
  settings.size_fn = on_size;
  exr_context_t context = NULL;
  const exr_result_t code = exr_start_read(&context, path, &settings);
  if (code == EXR_ERR_SUCCESS) {
    result = read_stream(&stream, context, image);
    exr_finish(&context);
  } else {
    result = stream_failure(&stream, OLX_ERROR_FORMAT, code);
  }
  olx_unmap_file(&mapped);
  return result;
}
