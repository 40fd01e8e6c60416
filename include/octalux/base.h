// Octalux: results, vectors, hooks and progress, shared by every other public header.
//
// Threads: every function of Octalux may be called from any thread. A handle (olx_field, olx_scene, ...) that is not
// being created or destroyed may be read by any number of threads at once; relighters and the objects of
// octalux/vulkan.h have stricter rules, which their headers state. The last message is kept per thread.
//
// Pointers may be NULL only where this is said, and arrays where they have no elements. A structure of settings begins
// as its ..._default function returns it; zeros are other settings, and some of them are refused.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_BASE_H
#define OCTALUX_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

#define OLX_VERSION_MAJOR 0
#define OLX_VERSION_MINOR 1
#define OLX_VERSION_PATCH 0

// Returns the version of the linked library as "major.minor.patch". Never NULL; static storage.
const char *olx_version(void);

// The result of every fallible call. Anything from outside (files, memory, settings) leads to one of these. An index or
// enumerator out of range leads to the value that the function documents, and to a name that begins with "unknown";
// nothing is read out of bounds. A NULL that is not allowed is a programming error: debug builds may assert, and
// release builds hold no assertion that could end the host.
typedef enum olx_result {
  OLX_OK = 0,
  OLX_ERROR_ARGUMENT = 1,    // a setting outside its documented range
  OLX_ERROR_MEMORY = 2,      // an allocation failed
  OLX_ERROR_FILE = 3,        // a file could not be found, read, or written
  OLX_ERROR_FORMAT = 4,      // a file is not what its name or header says, or contradicts itself
  OLX_ERROR_VERSION = 5,     // a file was written by another, incompatible version
  OLX_ERROR_CHECKSUM = 6,    // stored and computed checksum differ
  OLX_ERROR_UNSUPPORTED = 7, // well formed, but not supported by this build
  OLX_ERROR_EMPTY = 8,       // a scene or field with nothing to work on
  OLX_ERROR_CANCELLED = 9,   // the progress callback requested a stop
  OLX_ERROR_GPU = 10,        // the graphics device refused or was lost
  OLX_ERROR_INCOMPLETE = 11  // results of other bakes are not there yet: try again later (octalux/bake.h)
} olx_result;

// Returns a short English name of the result ("out of memory"). Never NULL; static storage.
const char *olx_result_name(olx_result result);

// Returns the message of the last failed call on this thread, saying what failed and where; "" when none has failed.
// Valid until the next failing call on the same thread.
const char *olx_last_error(void);

typedef struct olx_vec2 {
  float x, y;
} olx_vec2;

typedef struct olx_vec4 {
  float x, y, z, w;
} olx_vec4;

typedef struct olx_vec3 {
  float x, y, z;
} olx_vec3;

// The most that a coordinate of scenes, lights, cameras, placed probes and bakes may differ from 0, in metres:
// positions beyond are refused, or left out of a scene with a warning. Fields and functions that sample them have no
// such limit. Scenes far from 0 store their positions relative to an origin of their own (octalux/scene.h).
#define OLX_POSITION_LIMIT_METRES 2e7

typedef enum olx_log_level { OLX_LOG_INFO = 0, OLX_LOG_WARNING = 1, OLX_LOG_ERROR = 2 } olx_log_level;

// Hooks by which a host replaces what the library takes from the system. A NULL member keeps the default; when
// `allocate` or `release` is NULL, both do. Hooks are called from any thread, and from several at once. The libraries
// that liboctalux-bake links (Embree, importers, zlib, zstd) still allocate their own memory.
typedef struct olx_hooks {
  void *user; // passed to every hook

  // Memory, aligned to 64 bytes. `allocate` returns NULL when there is none. Default: aligned_alloc and free.
  void *(*allocate)(void *user, size_t size_bytes);
  void (*release)(void *user, void *memory);

  // Messages, one line without newline, cut to 1,023 bytes like those of olx_last_error. Default: warnings and errors
  // to standard error.
  void (*log)(void *user, olx_log_level level, const char *message);

  // Run job(job_user, i) for every i in [0, count), in any order and on any threads, and return when all have finished.
  // Default: POSIX threads. `threads` is the number that the caller requests (0: as many as the machine has).
  void (*parallel_for)(void *user, uint32_t count, uint32_t threads, void (*job)(void *job_user, uint32_t index),
                       void *job_user);
} olx_hooks;

// Installs hooks for the whole process; NULL restores the defaults. Call it before any other function, never while
// another call is running.
void olx_set_hooks(const olx_hooks *hooks);

// Progress of long work. `report` may be NULL, and so may a pointer to this structure. It is called from one thread at
// a time, which need not be the caller's, at most some ten times a second, with a short name of the stage and the share
// of the whole that is done, 0..1; returning false cancels the work, which then returns OLX_ERROR_CANCELLED and leaves
// no partial output.
typedef struct olx_progress {
  bool (*report)(void *user, const char *stage, float done);
  void *user;
} olx_progress;

// Copies `text`, which may come from a file, in a form that is safe for a terminal: control characters and bytes that
// are not UTF-8 become \xNN. The copy is cut to size_bytes, at least 1, including the terminator; 4 bytes for every
// byte and 1 for the terminator always suffice. Messages of olx_last_error, of the log and of olx_scene_warning are
// printable already.
void olx_printable(const char *text, char *printable, size_t size_bytes);

// Runs work(user) on the calling thread, and reports to `progress` during those of its calls on this thread that take
// no progress themselves (loading and cooking a scene, comparing images). These end with OLX_ERROR_CANCELLED soon after
// `report` has returned false. The reported share is always 0, because nobody knows how much work there is; `stage` is
// the reported name. Calls that take a progress should be given one of their own, because this one does not reach into
// all of their work. Returns the result of `work`. Importers' libraries are not interrupted.
olx_result olx_watch(const olx_progress *progress, const char *stage, olx_result (*work)(void *user), void *user);

// Outputs. A regular file is written to a temporary file in its folder, which is synced and renamed when it is
// complete, so that no reader ever sees a part of it and a killed program leaves the old one. Links are followed: the
// file to which they lead is replaced, with its owner and mode where that is permitted. Formats that are written in
// order (JSON, PNG, HTML, glTF, KTX2, gzip, .olxs) may also go to character devices, to pipes, and, by the name "-", to
// standard output; folders, block devices and sockets are refused. A build for no particular system
// (-DOCTALUX_SYSTEM=plain) refuses all outputs with OLX_ERROR_UNSUPPORTED.

// Checks before long work whether an output could be written at `path`: returns OLX_OK, or OLX_ERROR_FILE with the
// reason in olx_last_error.
olx_result olx_output_check(const char *path, bool in_order);

// Returns whether both paths lead to the same regular file, by device and inode; in a build for no particular system,
// whether the paths are the same text.
bool olx_same_file(const char *a, const char *b);

// Writes a whole output in order.
olx_result olx_write_file(const char *path, const void *data, size_t size_bytes);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
