// Encodes bytes in base64 and as data: URIs, for the glTF files that tests make.
#include "data_uris.h"

#include <stdlib.h>
#include <string.h>

void encode_base64(const uint8_t *bytes, size_t size_bytes, char *text) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < size_bytes; i += 3) {
    uint32_t bits = (uint32_t)bytes[i] << 16;
    if (i + 1 < size_bytes) bits |= (uint32_t)bytes[i + 1] << 8;
    if (i + 2 < size_bytes) bits |= bytes[i + 2];
    *text++ = digits[bits >> 18];
    *text++ = digits[(bits >> 12) & 63];
    *text++ = i + 1 < size_bytes ? digits[(bits >> 6) & 63] : '=';
    *text++ = i + 2 < size_bytes ? digits[bits & 63] : '=';
  }
  *text = 0;
}

char *make_data_uri(const void *data, size_t size_bytes) {
  static const char head[] = "data:application/octet-stream;base64,";
  char *uri = malloc(sizeof head + size_bytes * 2 + 8);
  memcpy(uri, head, sizeof head);
  encode_base64(data, size_bytes, uri + sizeof head - 1);
  return uri;
}
