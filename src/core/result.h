// Failures with a message: every fallible function returns olx_fail(...) or forwards with OLX_TRY.
#ifndef OLX_CORE_RESULT_H
#define OLX_CORE_RESULT_H

#include <octalux/base.h>

// Stores a printf-style message as this thread's last error and returns `result`.
olx_result olx_fail(olx_result result, const char *format, ...) __attribute__((format(printf, 2, 3)));

#define OLX_TRY(call)                                                                                                  \
  do {                                                                                                                 \
    const olx_result olx_try_result_ = (call);                                                                         \
    if (olx_try_result_ != OLX_OK) return olx_try_result_;                                                             \
  } while (0)

// Forwards a failure like OLX_TRY, but jumps to a clean-up label; needs a local variable named `result`.
#define OLX_TRY_GOTO(call, label)                                                                                      \
  do {                                                                                                                 \
    result = (call);                                                                                                   \
    if (result != OLX_OK) goto label;                                                                                  \
  } while (0)

#endif
