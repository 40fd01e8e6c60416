// Defines what ESSL 3.00, the language of WebGL2, lacks of GLSL 4.60, so that the library is the same text in both.
// WebGL has no `precise`, so values that decide may there differ by the last bit from place to place.
// It has no twin in C.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_LANGUAGE_GLSL
#define OLX_LANGUAGE_GLSL

#ifdef GL_ES
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2D;
precision highp usampler2DArray;

#define precise

uint bitfieldReverse(uint x) {
  x = x >> 1 & 0x55555555u | (x & 0x55555555u) << 1;
  x = x >> 2 & 0x33333333u | (x & 0x33333333u) << 2;
  x = x >> 4 & 0x0F0F0F0Fu | (x & 0x0F0F0F0Fu) << 4;
  x = x >> 8 & 0x00FF00FFu | (x & 0x00FF00FFu) << 8;
  return x >> 16 | x << 16;
}

// Returns the index of the highest bit that is 1, or -1.
int findMSB(uint x) {
  int bit = -1;
  for (int step = 16; step > 0; step >>= 1) {
    bool above = x >> step != 0u;
    bit += above ? step : 0;
    x = above ? x >> step : x;
  }
  return bit + int(x);
}
#endif

#endif
