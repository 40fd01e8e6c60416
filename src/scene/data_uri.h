// Bytes that are written into a text: data: URIs.
#ifndef OLX_SCENE_DATA_URI_H
#define OLX_SCENE_DATA_URI_H

#include <octalux/base.h>

bool olx_is_data_uri(const char *uri);

// Decode a data: URI in base64 into memory that is the caller's. False when it is none, with *bytes NULL; or when there
// is no memory, with *size_bytes SIZE_MAX.
bool olx_data_uri_decode(const char *uri, uint8_t **bytes, size_t *size_bytes);

#endif
