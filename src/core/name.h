// Names of fixed size, which are cut between characters.
#ifndef OLX_CORE_NAME_H
#define OLX_CORE_NAME_H

#include <string.h>

// Copies a text into a name of `size_bytes`, at least 1, including the terminator. A longer text is cut where a
// character of UTF-8 begins.
static inline void olx_copy_name(const char *text, char *name, size_t size_bytes) {
  size_t length = strnlen(text, size_bytes - 1);
  while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80) --length;
  memcpy(name, text, length);
  name[length] = 0;
}

#endif
