// The frame that Octalux's binary files share: a header, a table of chunks, and the chunks, every byte covered by a
// hash or required to be zero. docs/format.md, "Layout", is the specification.
#ifndef OLX_CORE_CHUNK_FILE_H
#define OLX_CORE_CHUNK_FILE_H

#include <octalux/base.h>

enum {
  OLX_CHUNK_ALIGNMENT = 64,
  OLX_CHUNK_MAX_COUNT = 256,
  OLX_CHUNK_OPTIONAL = 1 // a flag: readers that do not know the chunk skip it
};

#define OLX_FOUR_CC(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

typedef struct olx_file_header {
  uint8_t magic[8];
  uint32_t version;
  uint32_t chunk_count;
  uint64_t file_bytes;
  uint64_t table_hash; // of the whole chunk table
  uint64_t zero[3];
  uint64_t header_hash; // of the 56 bytes before it
} olx_file_header;

typedef struct olx_file_chunk {
  uint32_t type;
  uint32_t flags;
  uint64_t offset;
  uint64_t size_bytes;
  uint64_t record_bytes;  // of a unit such as one probe or one vertex
  uint32_t element_bytes; // of a texel or another smallest unit of a record
  uint32_t zero_a;
  uint64_t hash; // of the size_bytes bytes at offset
  uint64_t zero_b[2];
} olx_file_chunk;

_Static_assert(sizeof(olx_file_header) == 64 && offsetof(olx_file_header, header_hash) == 56, "docs/format.md");
_Static_assert(sizeof(olx_file_chunk) == 64 && offsetof(olx_file_chunk, hash) == 40, "docs/format.md");
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "files are read in place");

// The properties that distinguish one kind of file from another.
typedef struct olx_file_kind {
  const char *magic; // 8 bytes
  uint32_t version;
  const char *noun;   // such as "field file", for messages
  const char *remedy; // for messages, what to do about an older file: "; bake it again"
} olx_file_kind;

// A file in memory. The chunk table may be read once olx_chunk_file_check has accepted it.
typedef struct olx_chunk_file {
  const void *data;
  size_t size_bytes;
  const char *name; // for messages
} olx_chunk_file;

// The type and the sizes that a chunk must have.
typedef struct olx_chunk_shape {
  uint32_t type;
  uint32_t element_bytes;
  uint64_t record_bytes;
  uint64_t size_bytes;
} olx_chunk_shape;

// The shape of a chunk of `records` records of `elements` elements of `element_bytes` bytes each.
typedef struct olx_chunk_row {
  uint32_t type, element_bytes;
  uint64_t elements, records;
} olx_chunk_row;

static inline olx_chunk_shape olx_chunk_shape_of(const olx_chunk_row *row) {
  const uint64_t record_bytes = row->elements * row->element_bytes;
  return (olx_chunk_shape){.type = row->type,
                           .element_bytes = row->element_bytes,
                           .record_bytes = record_bytes,
                           .size_bytes = record_bytes * row->records};
}

// Returns the four characters of a type for messages; other bytes become '?'.
typedef struct olx_chunk_name {
  char text[5];
} olx_chunk_name;
olx_chunk_name olx_chunk_type_name(uint32_t type);

static inline uint64_t olx_align_chunk(uint64_t offset) {
  return (offset + (OLX_CHUNK_ALIGNMENT - 1)) & ~(uint64_t)(OLX_CHUNK_ALIGNMENT - 1);
}

static inline const olx_file_chunk *olx_chunk_table(const olx_chunk_file *file) {
  return (const void *)((const char *)file->data + sizeof(olx_file_header));
}

// Returns the XXH3 hash with 64 bits and seed 0.
uint64_t olx_content_hash(const void *data, size_t size_bytes);

// Returns whether a computed checksum equals the stored one. In builds for coverage-guided fuzzing (OLX_FUZZ) every
// checksum counts as right, so that the code behind checksums is reached; no other build may define it.
static inline bool olx_checksum_holds(uint64_t computed, uint64_t stored) {
#ifdef OLX_ANY_CHECKSUM
  return (void)computed, (void)stored, true;
#else
  return computed == stored;
#endif
}

// Checks header and chunk table: magic, version, checksums, and that chunks follow each other to the file's end. Magic
// and version come first, because only they have the same meaning in every version. The chunks themselves are not read.
olx_result olx_chunk_file_check(const olx_chunk_file *file, const olx_file_kind *kind);

// Finds the only chunk of a type; *found is NULL when there is none.
olx_result olx_chunk_find_any(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// Finds the one chunk of a type, which must be present.
olx_result olx_chunk_find(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// Finds the one chunk of shape->type and checks that it has the sizes of `shape`; *data is its first byte.
olx_result olx_chunk_find_shaped(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data);
// Finds a chunk that may be missing, and then *found is NULL; a chunk that is present must be flagged optional.
olx_result olx_chunk_find_optional(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// Finds an optional chunk and checks that it has the sizes of `shape`; *data is NULL when it is missing.
olx_result olx_chunk_find_optional_shaped(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data);
// Finds an optional chunk and checks that it is one record of bytes, of any number; *found is NULL when it is missing.
olx_result olx_chunk_find_bytes(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// Finds an optional chunk of a single record that says which other chunks there are, and checks its checksum too.
olx_result olx_chunk_find_header(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data);
// Finds a chunk that must be present when the chunk of type `header` announces it (`wanted`), and absent otherwise.
olx_result olx_chunk_find_wanted(const olx_chunk_file *file, const olx_chunk_shape *shape, uint32_t header, bool wanted,
                                 const void **data);
// The origin to which positions in a file are relative: chunk ORIG, three doubles, present where the origin is not 0.
// Readers must know it, so it is not flagged optional.
#define OLX_CHUNK_ORIGIN_ROW ((olx_chunk_row){OLX_FOUR_CC('O', 'R', 'I', 'G'), 8, 3, 1})
bool olx_origin_is_stored(const double origin[3]);
olx_result olx_chunk_find_origin(const olx_chunk_file *file, double origin[3]);
// Returns OLX_ERROR_UNSUPPORTED when a chunk is not optional, not the origin, and not among the `count` shapes.
olx_result olx_chunk_refuse_unknown(const olx_chunk_file *file, const olx_chunk_shape *shapes, uint32_t count);
// Checks the checksum of chunk `index`, and that the bytes after it are zero.
olx_result olx_chunk_check_content(const olx_chunk_file *file, uint32_t index);

// Returns the table's entry for a chunk of that shape; `flags` is 0 or OLX_CHUNK_OPTIONAL.
olx_file_chunk olx_chunk_entry(const olx_chunk_shape *shape, uint32_t flags, uint64_t offset, uint64_t hash);
// Returns the header for a complete table.
olx_file_header olx_chunk_header(const olx_file_kind *kind, const olx_file_chunk *table, uint32_t count,
                                 uint64_t file_bytes);
// Writes a whole file from the contents data[i] of shapes[i], into a temporary file that is synced and renamed.
olx_result olx_chunk_file_write(const char *path, const olx_file_kind *kind, const olx_chunk_shape *shapes,
                                const void *const *data, uint32_t count, uint64_t *file_bytes);

#endif
