// What src/block wants of libc, where there is none: compilers make instructions of it.
#ifndef OLX_FREESTANDING_STRING_H
#define OLX_FREESTANDING_STRING_H

#define memcpy __builtin_memcpy
#define memset __builtin_memset

#endif
