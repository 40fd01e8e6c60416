// Imports the textures of glTF materials: images in files, views and URIs, and transforms of texture coordinates, which
// are applied to vertices.
#include "scene/gltf/gltf_texture.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_buffer.h"
#include "scene/import/data_uri.h"

#include <stdio.h>
#include <string.h>

// ---- Coordinates

// Reads the transform T R S of the extension: v is downwards, and rotation is counter-clockwise as displayed.
static void read_transform(const cJSON *transform, olx_gltf_placement *place) {
  float offset[2] = {0.0f, 0.0f}, scale[2] = {1.0f, 1.0f}, rotation = 0.0f;
  olx_json_floats(olx_json_member(transform, "offset"), offset, 2);
  olx_json_floats(olx_json_member(transform, "scale"), scale, 2);
  olx_json_float(olx_json_member(transform, "rotation"), &rotation);
  const float c = cosf(rotation), s = sinf(rotation);
  const float rows[2][3] = {{c * scale[0], s * scale[1], offset[0]}, {-s * scale[0], c * scale[1], offset[1]}};
  memcpy(place->rows, rows, sizeof rows);
}

static void read_set(const cJSON *object, uint32_t *set) {
  bool valid;
  olx_json_index(olx_json_member(object, "texCoord"), UINT32_MAX, set, &valid);
}

olx_gltf_placement olx_gltf_read_placement(const cJSON *info) {
  const cJSON *transform = olx_gltf_extension(info, "KHR_texture_transform");
  olx_gltf_placement place = {.rows = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}}};
  read_set(info, &place.set);
  if (!transform) return place;
  read_set(transform, &place.set);
  read_transform(transform, &place);
  return place;
}

bool olx_gltf_same_placement(const olx_gltf_placement *a, const olx_gltf_placement *b) {
  bool same = a->set == b->set;
  for (int i = 0; i < 6; ++i) same = same && a->rows[i / 3][i % 3] == b->rows[i / 3][i % 3];
  return same;
}

bool olx_gltf_find_placement(olx_gltf_placements *placements, const olx_gltf_placement *place, uint32_t *number) {
  for (*number = 0; *number < placements->count; ++*number) {
    if (olx_gltf_same_placement(&placements->places[*number], place)) return true;
  }
  if (placements->count == 2) return false;
  placements->places[placements->count++] = *place;
  return true;
}

olx_vec2 olx_gltf_place_uv(const olx_gltf_placement *place, olx_vec2 uv) {
  const float(*m)[3] = place->rows;
  return (olx_vec2){m[0][0] * uv.x + m[0][1] * uv.y + m[0][2], m[1][0] * uv.x + m[1][1] * uv.y + m[1][2]};
}

// ---- Samplers

static bool mirrors(const cJSON *sampler) {
  const uint64_t mirrored_repeat = 33648;
  uint64_t along_u, along_v;
  olx_json_size(sampler, "wrapS", 0, &along_u);
  olx_json_size(sampler, "wrapT", 0, &along_v);
  return along_u == mirrored_repeat || along_v == mirrored_repeat;
}

olx_result olx_gltf_check_samplers(const olx_gltf *gltf) {
  uint32_t mirrored = 0;
  for (uint32_t i = 0; i < gltf->textures.count; ++i) {
    uint32_t sampler;
    if (!olx_gltf_index(gltf->textures.elements[i], "sampler", gltf->samplers.count, &sampler)) {
      return olx_gltf_fail(gltf, "textures", i, "its sampler does not exist");
    }
    mirrored += sampler != OLX_GLTF_NONE && mirrors(gltf->samplers.elements[sampler]);
  }
  if (mirrored) {
    olx_scene_warn(gltf->scene, "%s: %u textures repeat without being mirrored, as MIRRORED_REPEAT would have it",
                   gltf->path, mirrored);
  }
  return OLX_OK;
}

// ---- Images

struct olx_gltf_image {
  uint8_t *decoded; // decoded data: URI
  size_t size_bytes;
};

static olx_result decode_image(olx_gltf *gltf, uint32_t image, const char *uri, olx_gltf_bytes *bytes) {
  olx_gltf_image *kept = &gltf->image_data[image];
  if (!kept->decoded && !olx_data_uri_decode(uri, &kept->decoded, &kept->size_bytes)) {
    if (kept->size_bytes == SIZE_MAX) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
    return olx_gltf_fail(gltf, "images", image, "its data: URI is not in base64");
  }
  *bytes = (olx_gltf_bytes){kept->decoded, kept->size_bytes};
  return OLX_OK;
}

static olx_result request_embedded(const olx_gltf *gltf, olx_material_import *import, uint32_t image,
                                   olx_gltf_bytes bytes, olx_texture_use use, uint32_t *number) {
  char label[4200];
  snprintf(label, sizeof label, "%.4100s: images[%u]", gltf->path, image);
  return olx_texture_table_request(&import->textures, label, bytes.size_bytes ? (const void *)bytes.data : "",
                                   bytes.size_bytes, use, number);
}

static olx_result request_image(olx_gltf *gltf, olx_material_import *import, uint32_t image, olx_texture_use use,
                                uint32_t *number) {
  const cJSON *element = gltf->images.elements[image];
  const char *uri = olx_json_text(element, "uri");
  uint32_t view;
  olx_gltf_bytes bytes = {NULL, 0};
  if (uri[0] && !olx_is_data_uri(uri)) return olx_import_texture_file(import, uri, use, number);
  if (uri[0]) {
    OLX_TRY(decode_image(gltf, image, uri, &bytes));
  } else {
    // olx_gltf_check_images has checked that the view exists.
    olx_gltf_index(element, "bufferView", gltf->views.count, &view);
    if (view == OLX_GLTF_NONE) return olx_gltf_fail(gltf, "images", image, "it has neither a uri nor a bufferView");
    OLX_TRY(olx_gltf_view_bytes(gltf, view, &bytes));
  }
  return request_embedded(gltf, import, image, bytes, use, number);
}

// Finds the image of a texture: its source, or else its image in WebP. *image is OLX_GLTF_NONE when it has neither.
static bool find_image(const olx_gltf *gltf, uint32_t texture, uint32_t *image) {
  const cJSON *element = gltf->textures.elements[texture];
  if (!olx_gltf_index(element, "source", gltf->images.count, image)) return false;
  if (*image != OLX_GLTF_NONE) return true;
  return olx_gltf_index(olx_gltf_extension(element, "EXT_texture_webp"), "source", gltf->images.count, image);
}

// Reports a texture without an image: one of a kind that is not supported is rejected, one of no kind left out.
static olx_result report_imageless(const olx_gltf *gltf, olx_material_import *import, uint32_t texture) {
  static const char *const kinds[] = {"KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
    if (!olx_gltf_extension(gltf->textures.elements[texture], kinds[i])) continue;
    return olx_fail(
        OLX_ERROR_UNSUPPORTED,
        "%s: textures[%u]: its only image is one of %s, which is not supported: give it a source in PNG, JPEG or WebP",
        gltf->path, texture, kinds[i]);
  }
  char label[4200];
  snprintf(label, sizeof label, "%.4100s: textures[%u]", gltf->path, texture);
  return olx_texture_table_leave_out(&import->textures, label, "it has no image");
}

olx_result olx_gltf_request_texture(olx_gltf *gltf, olx_material_import *import, uint32_t texture, olx_texture_use use,
                                    uint32_t *number) {
  uint32_t image;
  *number = OLX_NO_TEXTURE;
  if (!gltf->image_data) gltf->image_data = olx_allocate_zero(gltf->images.count, sizeof *gltf->image_data);
  if (!gltf->image_data) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  if (!find_image(gltf, texture, &image)) {
    return olx_gltf_fail(gltf, "textures", texture, "its image does not exist");
  }
  if (image == OLX_GLTF_NONE) return report_imageless(gltf, import, texture);
  return request_image(gltf, import, image, use, number);
}

void olx_gltf_release_images(olx_gltf *gltf) {
  for (uint32_t i = 0; gltf->image_data && i < gltf->images.count; ++i) olx_release(gltf->image_data[i].decoded);
  olx_release(gltf->image_data);
}
