// Encoding of bytes as text: base64, and data: URIs.
#ifndef OLX_TESTS_DATA_URIS_H
#define OLX_TESTS_DATA_URIS_H

#include <stddef.h>
#include <stdint.h>

// Writes four digits for every three bytes begun, and a terminating zero.
void encode_base64(const uint8_t *bytes, size_t size_bytes, char *text);

// Returns `size_bytes` of data as a URI: "data:application/octet-stream;base64,...". Free it.
char *make_data_uri(const void *data, size_t size_bytes);

#endif
