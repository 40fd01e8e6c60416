// Marks a function that is also compiled for wider instruction sets; the widest one that the machine has is chosen when
// the program starts. Without contraction, all versions round alike.
#ifndef OLX_CORE_WIDEST_H
#define OLX_CORE_WIDEST_H

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) &&                       \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OLX_WIDEST __attribute__((target_clones("avx2", "default")))
#else
#define OLX_WIDEST
#endif

#endif
