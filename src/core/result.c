// Keeps the message of each thread's last failure, and names results and the version.
#include "core/result.h"

#include <stdarg.h>
#include <stdio.h>

static _Thread_local char last_error[1024];

olx_result olx_fail(olx_result result, const char *format, ...) {
  // A message may quote the previous one, so the new one is built in a separate buffer.
  char message[sizeof last_error];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  olx_printable(message, last_error, sizeof last_error);
  return result;
}

const char *olx_last_error(void) { return last_error; }

const char *olx_result_name(olx_result result) {
  switch (result) {
  case OLX_OK: return "ok";
  case OLX_ERROR_ARGUMENT: return "argument out of range";
  case OLX_ERROR_MEMORY: return "out of memory";
  case OLX_ERROR_FILE: return "file error";
  case OLX_ERROR_FORMAT: return "malformed data";
  case OLX_ERROR_VERSION: return "incompatible version";
  case OLX_ERROR_CHECKSUM: return "checksum mismatch";
  case OLX_ERROR_UNSUPPORTED: return "unsupported";
  case OLX_ERROR_EMPTY: return "nothing to work on";
  case OLX_ERROR_CANCELLED: return "cancelled";
  case OLX_ERROR_GPU: return "graphics device error";
  case OLX_ERROR_INCOMPLETE: return "incomplete";
  }
  return "unknown result";
}

#define OLX_STRING_(x) #x
#define OLX_STRING(x) OLX_STRING_(x)

const char *olx_version(void) {
  return OLX_STRING(OLX_VERSION_MAJOR) "." OLX_STRING(OLX_VERSION_MINOR) "." OLX_STRING(OLX_VERSION_PATCH);
}
