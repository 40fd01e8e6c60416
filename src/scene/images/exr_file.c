// Reads OpenEXR images from a mapping of the file, through callbacks of OpenEXR's C core, and converts its errors to
// messages. Sizes and chunks are checked before pixels are decoded.
#include "scene/images/exr_file.h"

#include "core/result.h"

#include <stdio.h>
#include <string.h>

static const unsigned char exr_magic[] = {0x76, 0x2F, 0x31, 0x01};

bool olx_is_exr(const void *data, size_t size_bytes) {
  return size_bytes >= sizeof exr_magic && memcmp(data, exr_magic, sizeof exr_magic) == 0;
}

static void on_error(exr_const_context_t context, exr_result_t code, const char *message) {
  (void)code;
  void *user = NULL;
  if (!context || exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user) return;
  olx_exr_file *file = user;
  if (!file->message[0]) snprintf(file->message, sizeof file->message, "%s", message);
}

static int64_t on_read(exr_const_context_t context, void *user, void *data, uint64_t size_bytes, uint64_t offset,
                       exr_stream_error_func_ptr_t error) {
  const olx_exr_file *file = user;
  const uint64_t total = file->mapped.size_bytes;
  if (offset > total) {
    error(context, EXR_ERR_READ_IO, "the file ends before byte %llu", (unsigned long long)offset);
    return -1;
  }
  const uint64_t available = total - offset < size_bytes ? total - offset : size_bytes;
  if (available > 0) memcpy(data, (const uint8_t *)file->mapped.data + offset, available);
  return (int64_t)available;
}

static int64_t on_size(exr_const_context_t context, void *user) {
  (void)context;
  return (int64_t)((const olx_exr_file *)user)->mapped.size_bytes;
}

// Rejects files of other formats with a clear message, because OpenEXR's own describes only their bytes.
static olx_result check_kind(const char *path, const olx_mapped_file *mapped) {
  const unsigned char *data = mapped->data;
  if (mapped->size_bytes == 0) return olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  if (olx_is_exr(data, mapped->size_bytes)) return OLX_OK;
  const bool png = mapped->size_bytes >= 4 && memcmp(data, "\x89PNG", 4) == 0;
  const bool jpeg = mapped->size_bytes >= 3 && memcmp(data, "\xFF\xD8\xFF", 3) == 0;
  return olx_fail(OLX_ERROR_FORMAT, "%s: not an OpenEXR image%s, which holds light as it is (`render -o FILE.exr`)",
                  path,
                  png    ? " but a PNG"
                  : jpeg ? " but a JPEG"
                         : "");
}

static olx_result fail(const olx_exr_file *file, exr_result_t code) {
  if (code == EXR_ERR_OUT_OF_MEMORY) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for the image", file->path);
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s", file->path,
                  file->message[0] ? file->message : exr_get_default_error_message(code));
}

#define EXR_TRY(call)                                                                                                  \
  do {                                                                                                                 \
    const exr_result_t exr_try_code_ = (call);                                                                         \
    if (exr_try_code_ != EXR_ERR_SUCCESS) return exr_try_code_;                                                        \
  } while (0)

// Reads the size of the image, after unsupported kinds of OpenEXR files have been rejected.
static olx_result read_header(olx_exr_file *file) {
  exr_storage_t storage;
  exr_attr_box2i_t window;
  memset(&window, 0, sizeof window);
  exr_result_t code = exr_get_storage(file->context, 0, &storage);
  if (code == EXR_ERR_SUCCESS && storage != EXR_STORAGE_SCANLINE) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: a tiled or deep image; only scanlines are read", file->path);
  }
  if (code == EXR_ERR_SUCCESS) code = exr_get_data_window(file->context, 0, &window);
  if (code != EXR_ERR_SUCCESS) return fail(file, code);
  const int64_t width = (int64_t)window.max.x - window.min.x + 1, height = (int64_t)window.max.y - window.min.y + 1;
  if (width < 1 || height < 1 || width > OLX_EXR_MAX_SIZE || height > OLX_EXR_MAX_SIZE) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %lld x %lld pixels; width and height must be 1 to %d", file->path,
                    (long long)width, (long long)height, OLX_EXR_MAX_SIZE);
  }
  file->width = (uint32_t)width;
  file->height = (uint32_t)height;
  file->first_row = window.min.y;
  return OLX_OK;
}

static exr_result_t check_chunks(const olx_exr_file *file) {
  int32_t lines = 0;
  EXR_TRY(exr_get_scanlines_per_chunk(file->context, 0, &lines));
  if (lines < 1) return EXR_ERR_FILE_BAD_HEADER;
  for (int64_t row = 0; row < file->height; row += lines) {
    exr_chunk_info_t chunk;
    EXR_TRY(exr_read_scanline_chunk_info(file->context, 0, file->first_row + (int)row, &chunk));
  }
  return EXR_ERR_SUCCESS;
}

olx_result olx_exr_open(const char *path, olx_exr_file *file) {
  *file = (olx_exr_file){.path = path};
  OLX_TRY(olx_map_file(path, &file->mapped));
  OLX_TRY(check_kind(path, &file->mapped));
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.error_handler_fn = on_error;
  settings.user_data = file;
  settings.read_fn = on_read;
  settings.size_fn = on_size;
  settings.max_image_width = settings.max_image_height = OLX_EXR_MAX_SIZE;
  settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
  exr_result_t code = exr_start_read(&file->context, path, &settings);
  if (code != EXR_ERR_SUCCESS) return fail(file, code);
  OLX_TRY(read_header(file));
  code = check_chunks(file);
  return code == EXR_ERR_SUCCESS ? OLX_OK : fail(file, code);
}

void olx_exr_close(olx_exr_file *file) {
  if (file->context) exr_finish(&file->context);
  olx_unmap_file(&file->mapped);
}

static olx_result check_channel(const olx_exr_file *file, const exr_attr_chlist_entry_t *channel) {
  if (channel->x_sampling != 1 || channel->y_sampling != 1) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: channel %s is subsampled", file->path, channel->name.str);
  }
  if (channel->pixel_type != EXR_PIXEL_HALF && channel->pixel_type != EXR_PIXEL_FLOAT) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: channel %s holds integers, not light", file->path, channel->name.str);
  }
  return OLX_OK;
}

olx_result olx_exr_find_channels(const olx_exr_file *file, bool (*wants)(void *user, const char *channel), void *user) {
  const exr_attr_chlist_t *channels = NULL;
  const exr_result_t code = exr_get_channels(file->context, 0, &channels);
  if (code != EXR_ERR_SUCCESS) return fail(file, code);
  for (int i = 0; i < channels->num_channels; ++i) {
    if (wants(user, channels->entries[i].name.str)) OLX_TRY(check_channel(file, &channels->entries[i]));
  }
  return OLX_OK;
}

static void attach(exr_coding_channel_info_t *channel, olx_exr_target target) {
  channel->decode_to_ptr = (uint8_t *)target.pixels;
  if (!target.pixels) return;
  channel->user_bytes_per_element = sizeof(float);
  channel->user_data_type = EXR_PIXEL_FLOAT;
  channel->user_pixel_stride = target.pixel_bytes;
  channel->user_line_stride = target.line_bytes;
}

static exr_result_t read_chunks(const olx_exr_file *file,
                                olx_exr_target (*target)(void *user, const char *channel, uint32_t row), void *user,
                                exr_decode_pipeline_t *pipeline) {
  int32_t lines = 0;
  EXR_TRY(exr_get_scanlines_per_chunk(file->context, 0, &lines));
  for (uint32_t row = 0; row < file->height; row += (uint32_t)lines) {
    exr_chunk_info_t chunk;
    EXR_TRY(exr_read_scanline_chunk_info(file->context, 0, file->first_row + (int)row, &chunk));
    if (row == 0) EXR_TRY(exr_decoding_initialize(file->context, 0, &chunk, pipeline));
    else EXR_TRY(exr_decoding_update(file->context, 0, &chunk, pipeline));
    for (int16_t i = 0; i < pipeline->channel_count; ++i) {
      exr_coding_channel_info_t *channel = &pipeline->channels[i];
      attach(channel, target(user, channel->channel_name, row));
    }
    if (row == 0) EXR_TRY(exr_decoding_choose_default_routines(file->context, 0, pipeline));
    EXR_TRY(exr_decoding_run(file->context, 0, pipeline));
  }
  return EXR_ERR_SUCCESS;
}

olx_result olx_exr_read(olx_exr_file *file, olx_exr_target (*target)(void *user, const char *channel, uint32_t row),
                        void *user) {
  exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
  file->message[0] = 0; // a missing attribute in another program's file is not an error
  const exr_result_t code = read_chunks(file, target, user, &pipeline);
  exr_decoding_destroy(file->context, &pipeline);
  return code == EXR_ERR_SUCCESS ? OLX_OK : fail(file, code);
}
