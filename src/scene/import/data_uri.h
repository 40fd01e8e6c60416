// Decodes bytes that are embedded in text as data: URIs.
#ifndef OLX_SCENE_DATA_URI_H
#define OLX_SCENE_DATA_URI_H

#include <octalux/base.h>

bool olx_is_data_uri(const char *uri);

// Decodes a Base64 data: URI into memory that the caller owns. Returns false when the text is not such a URI, with
// *bytes NULL; or when memory runs out, with *size_bytes SIZE_MAX.
bool olx_data_uri_decode(const char *uri, uint8_t **bytes, size_t *size_bytes);

#endif
