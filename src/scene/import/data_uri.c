// Decodes Base64 in data: URIs: digits of both alphabets, with or without padding. Text with any other character is
// rejected.
#include "scene/import/data_uri.h"

#include "core/hooks.h"

#include <string.h>

bool olx_is_data_uri(const char *uri) { return strncmp(uri, "data:", 5) == 0; }

// Returns the value of a Base64 digit, in both alphabets; -1 for other characters.
static int digit_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

static bool decode_digits(const char *text, size_t length, uint8_t *bytes) {
  uint32_t bits = 0, held = 0;
  for (size_t i = 0; i < length; ++i) {
    const int value = digit_value(text[i]);
    if (value < 0) return false;
    bits = bits << 6 | (uint32_t)value;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    *bytes++ = (uint8_t)(bits >> held);
  }
  return true;
}

bool olx_data_uri_decode(const char *uri, uint8_t **bytes, size_t *size_bytes) {
  *bytes = NULL;
  *size_bytes = 0;
  const char *comma = strchr(uri, ',');
  if (!olx_is_data_uri(uri) || !comma || comma - uri < 7 || strncmp(comma - 7, ";base64", 7) != 0) return false;
  size_t length = strlen(comma + 1);
  while (length && comma[length] == '=') --length;
  if (length % 4 == 1) return false;
  *size_bytes = length / 4 * 3 + (length % 4 ? length % 4 - 1 : 0);
  *bytes = olx_allocate(*size_bytes, 1);
  if (!*bytes) *size_bytes = SIZE_MAX;
  if (*bytes && decode_digits(comma + 1, length, *bytes)) return true;
  olx_release(*bytes);
  *bytes = NULL;
  return false;
}
