// Makes text from files safe for terminals and logs. No other code escapes such text.
#include <octalux/base.h>

#include <assert.h>
#include <stdio.h>
#include <string.h>

// Returns whether the second byte of a UTF-8 character of three or four bytes leaves room for a shorter form, makes
// half of a surrogate pair, or exceeds U+10FFFF.
static bool second_is_wrong(const unsigned char *text) {
  return (text[0] == 0xE0 && text[1] < 0xA0) || (text[0] == 0xED && text[1] >= 0xA0) ||
         (text[0] == 0xF0 && text[1] < 0x90) || (text[0] == 0xF4 && text[1] >= 0x90);
}

// Returns the number of bytes of the UTF-8 character at `text`; 0 when it is invalid or a control character.
static size_t character_bytes(const unsigned char *text) {
  if (text[0] < 0x80) return text[0] >= 0x20 && text[0] != 0x7F ? 1 : 0;
  const size_t count = text[0] >= 0xC2 && text[0] <= 0xDF   ? 2
                       : text[0] >= 0xE0 && text[0] <= 0xEF ? 3
                       : text[0] >= 0xF0 && text[0] <= 0xF4 ? 4
                                                            : 0;
  for (size_t i = 1; i < count; i++) {
    if ((text[i] & 0xC0) != 0x80) return 0;
  }
  if (text[0] == 0xC2 && text[1] < 0xA0) return 0; // the control characters U+0080 to U+009F
  return count && second_is_wrong(text) ? 0 : count;
}

void olx_printable(const char *text, char *printable, size_t size_bytes) {
  assert(text && printable && size_bytes > 0);
  const unsigned char *in = (const unsigned char *)text;
  size_t used = 0;
  while (*in) {
    const size_t count = character_bytes(in), needed = count ? count : 4;
    if (used + needed + 1 > size_bytes) break;
    if (count) memcpy(printable + used, in, count);
    else snprintf(printable + used, 5, "\\x%02x", *in);
    used += needed;
    in += count ? count : 1;
  }
  printable[used] = 0;
}
