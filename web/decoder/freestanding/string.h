// The functions of libc that src/block needs, where there is no libc: compilers replace them by instructions.
#ifndef OLX_FREESTANDING_STRING_H
#define OLX_FREESTANDING_STRING_H

#define memcpy __builtin_memcpy
#define memset __builtin_memset

#endif
