// The frame that Octalux's binary files share: a header, a table of chunks, the chunks, every byte under a hash or
// required to be zero. docs/format.md, "Layout", is the specification.
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
  uint64_t record_bytes;  // what belongs together: one probe, one vertex
  uint32_t element_bytes; // a texel or another smallest unit of a record
  uint32_t zero_a;
  uint64_t hash; // of size_bytes bytes at offset
  uint64_t zero_b[2];
} olx_file_chunk;

_Static_assert(sizeof(olx_file_header) == 64 && offsetof(olx_file_header, header_hash) == 56, "docs/format.md");
_Static_assert(sizeof(olx_file_chunk) == 64 && offsetof(olx_file_chunk, hash) == 40, "docs/format.md");
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "files are read in place");

// What distinguishes one kind of file from another.
typedef struct olx_file_kind {
  const char *magic; // 8 bytes
  uint32_t version;
  const char *noun;   // "field file": for messages
  const char *remedy; // what to do about an older file, for messages: "; bake it again"
} olx_file_kind;

// A file in memory. The chunk table may be read once olx_chunk_file_check has passed it.
typedef struct olx_chunk_file {
  const void *data;
  size_t size_bytes;
  const char *name; // for messages
} olx_chunk_file;

// What a chunk must be.
typedef struct olx_chunk_shape {
  uint32_t type;
  uint32_t element_bytes;
  uint64_t record_bytes;
  uint64_t size_bytes;
} olx_chunk_shape;

// Records of so many elements of so many bytes.
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

// The four characters of a type for messages; other bytes become '?'.
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

// XXH3, 64 bits, seed 0.
uint64_t olx_content_hash(const void *data, size_t size_bytes);

// Whether the checksum of what was read is the one that is stored. In builds for coverage-guided fuzzing (OLX_FUZZ)
// every checksum is right, so that what lies behind checksums is met; nothing else may be built so.
static inline bool olx_checksum_holds(uint64_t computed, uint64_t stored) {
#ifdef OLX_ANY_CHECKSUM
  return (void)computed, (void)stored, true;
#else
  return computed == stored;
#endif
}

// Header and chunk table: magic, version, checksums, and chunks that follow each other to the file's end. Magic and
// version come first, because only they mean the same in every version. The chunks themselves are not read.
olx_result olx_chunk_file_check(const olx_chunk_file *file, const olx_file_kind *kind);

// The only chunk of a type; *found is NULL when there is none.
olx_result olx_chunk_find_any(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// The one chunk of a type that every reader must find.
olx_result olx_chunk_find(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// Finds the one chunk of shape->type and checks that it has the sizes of `shape`; *data is its first byte.
olx_result olx_chunk_find_shaped(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data);
// A chunk that may be missing, in which case *found is NULL, but is flagged optional when it is there.
olx_result olx_chunk_find_optional(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found);
// Finds an optional chunk and checks that it has the sizes of `shape`; *data is NULL when it is missing.
olx_result olx_chunk_find_optional_shaped(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data);
// Finds an optional chunk of a single record that says which other chunks there are, and checks its checksum, too.
olx_result olx_chunk_find_header(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data);
// A chunk that is there when the chunk of type `header` says so (`wanted`), and only then.
olx_result olx_chunk_find_wanted(const olx_chunk_file *file, const olx_chunk_shape *shape, uint32_t header, bool wanted,
                                 const void **data);
// The origin that positions in a file are relative to: chunk ORIG, three doubles, which a file has when it is not 0.
// Readers must know it, so it is not flagged optional.
#define OLX_CHUNK_ORIGIN_ROW ((olx_chunk_row){OLX_FOUR_CC('O', 'R', 'I', 'G'), 8, 3, 1})
bool olx_origin_is_stored(const double origin[3]);
olx_result olx_chunk_find_origin(const olx_chunk_file *file, double origin[3]);
// OLX_ERROR_UNSUPPORTED when a chunk is neither optional nor the origin nor among the `count` shapes.
olx_result olx_chunk_refuse_unknown(const olx_chunk_file *file, const olx_chunk_shape *shapes, uint32_t count);
// The checksum of chunk `index`, and the zero bytes after it.
olx_result olx_chunk_check_content(const olx_chunk_file *file, uint32_t index);

// The table's entry for a chunk of that shape; `flags`: 0 or OLX_CHUNK_OPTIONAL.
olx_file_chunk olx_chunk_entry(const olx_chunk_shape *shape, uint32_t flags, uint64_t offset, uint64_t hash);
// The header over a complete table.
olx_file_header olx_chunk_header(const olx_file_kind *kind, const olx_file_chunk *table, uint32_t count,
                                 uint64_t file_bytes);
// Write a whole file, data[i] being the content of shapes[i]: beside, synced, renamed.
olx_result olx_chunk_file_write(const char *path, const olx_file_kind *kind, const olx_chunk_shape *shapes,
                                const void *const *data, uint32_t count, uint64_t *file_bytes);

#endif
