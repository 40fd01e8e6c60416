// Fields on their way elsewhere: packed for shipping, and unpacked. Part of liboctalux-bake; a program that calls nothing else of it
// links zstd, and neither Embree nor any importer's library.
#ifndef OCTALUX_EXPORT_H
#define OCTALUX_EXPORT_H

#include <octalux/field.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

// ---- Packing: a field (.olx) is stored smaller (.olxz) and comes back to the last byte (docs/format.md, "Packed fields"). A packed
// field cannot be sampled; the runtime refuses it with a message.

typedef struct olx_pack_settings {
  uint32_t level;   // of zstd, 1 (fast) to 22 (small); default 19
  uint32_t threads; // 0, the default: as many as the machine has; the bytes do not depend on it
} olx_pack_settings;

olx_pack_settings olx_pack_settings_default(void);

#define OLX_PACKED_MOST_CHUNKS 255

// What is in a packed field.
typedef struct olx_packed_chunk {
  char type[5]; // its four characters, those that are not printable as '?'
  uint64_t field_bytes, packed_bytes;
} olx_packed_chunk;

typedef struct olx_packed_info {
  uint64_t field_bytes;  // of the field file that comes back
  uint64_t packed_bytes; // of the packed file
  uint32_t chunk_count;  // 1 to OLX_PACKED_MOST_CHUNKS
  olx_packed_chunk chunks[OLX_PACKED_MOST_CHUNKS];
} olx_packed_info;

// Pack the field at `field_path` into `path`: beside, synced, renamed. Every checksum of the field is checked before. The bytes depend on
// the field, the level and the version of zstd alone. Takes some 20 MiB of memory a thread, whatever the field's size. OLX_ERROR_ARGUMENT
// for settings out of range, OLX_ERROR_UNSUPPORTED for a field of more chunks than OLX_PACKED_MOST_CHUNKS, and what olx_field_open and
// olx_field_verify say of a damaged field. `info` may be NULL.
olx_result olx_field_pack(const char *field_path, const olx_pack_settings *settings, const char *path,
                          const olx_progress *progress, olx_packed_info *info);

typedef struct olx_unpack_settings {
  uint64_t most_bytes; // a field file larger than this is refused before space is taken for it; default 2^35
  uint32_t threads;    // 0, the default: as many as the machine has
} olx_unpack_settings;

olx_unpack_settings olx_unpack_settings_default(void);

// Unpack `packed_path` into the field file that it was made from: beside, synced, renamed. `path` may be NULL: then everything is checked
// and nothing written. Takes some 3 MiB of memory a thread, whatever the file says. OLX_ERROR_FORMAT or OLX_ERROR_CHECKSUM for a damaged
// file, OLX_ERROR_UNSUPPORTED for a field larger than settings->most_bytes. `info` may be NULL.
olx_result olx_field_unpack(const char *packed_path, const olx_unpack_settings *settings, const char *path,
                            const olx_progress *progress, olx_packed_info *info);

// Whether a file begins as packed fields do; false when it cannot be read.
bool olx_is_packed_field(const char *path);

// What a packed file says of itself, once its header and its tables are found to be sound. The chunks are not read.
olx_result olx_packed_describe(const char *path, olx_packed_info *info);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
