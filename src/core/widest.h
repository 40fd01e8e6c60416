// Before a function that is written for any machine: it is compiled for wider ones too, and chosen when the program
// starts. Without contraction all of them round alike.
#ifndef OLX_CORE_WIDEST_H
#define OLX_CORE_WIDEST_H

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) &&                       \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OLX_WIDEST __attribute__((target_clones("avx2", "default")))
#else
#define OLX_WIDEST
#endif

#endif
