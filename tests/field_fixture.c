// Gives tests of field files a folder, a small field written to it, and the means to damage the file and seal its
// checksums again.
#include "field_fixture.h"

#include <dirent.h>
#include <unistd.h>

int field_set_up(void **state) {
  field_fixture *f = calloc(1, sizeof *f);
  snprintf(f->folder, sizeof f->folder, "/tmp/octalux-field-XXXXXX");
  if (!mkdtemp(f->folder)) return -1;
  snprintf(f->path, sizeof f->path, "%s/a.olx", f->folder);
  *state = f;
  return 0;
}

int field_tear_down(void **state) {
  field_fixture *f = *state;
  unlink(f->path);
  const int result = rmdir(f->folder); // fails when any other file was left behind
  free(f);
  return result;
}

uint32_t field_files_in(const char *folder) {
  uint32_t count = 0;
  DIR *directory = opendir(folder);
  for (const struct dirent *entry; (entry = readdir(directory));) {
    count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  }
  closedir(directory);
  return count;
}

unsigned char *field_written(field_fixture *f, const synthetic_shape *shape, size_t *size_bytes) {
  uint64_t file_bytes = 0;
  assert_int_equal(synthetic_write(f->path, shape, &file_bytes), OLX_OK);
  unsigned char *bytes = synthetic_read_file(f->path, size_bytes);
  assert_non_null(bytes);
  assert_int_equal(file_bytes, *size_bytes);
  return bytes;
}

field_image field_image_load(field_fixture *f, const synthetic_shape *shape) {
  field_image i;
  i.bytes = field_written(f, shape, &i.size_bytes);
  i.header = (olx_file_header *)i.bytes;
  i.chunks = (olx_file_chunk *)(i.bytes + sizeof(olx_file_header));
  i.info = (olx_file_info *)(i.bytes + i.chunks[OLX_CHUNK_INFO].offset);
  i.sealed = i.header->chunk_count;
  return i;
}

void *field_chunk(const field_image *i, olx_chunk_kind kind) { return i->bytes + i->chunks[kind].offset; }

olx_file_chunk *field_chunk_of_type(const field_image *i, uint32_t type) {
  for (uint32_t k = 0; k < i->sealed; k++) {
    if (i->chunks[k].type == type) return &i->chunks[k];
  }
  fail_msg("no chunk %s", olx_chunk_type_name(type).text);
  return NULL;
}

void field_seal(const field_image *i) {
  for (uint32_t k = 0; k < i->sealed; k++) {
    i->chunks[k].hash = olx_content_hash(i->bytes + i->chunks[k].offset, i->chunks[k].size_bytes);
  }
  i->header->table_hash = olx_content_hash(i->chunks, i->sealed * sizeof(olx_file_chunk));
  i->header->header_hash = olx_content_hash(i->header, 56);
}

void field_seal_table(const field_image *i) {
  i->header->table_hash = olx_content_hash(i->chunks, i->header->chunk_count * sizeof(olx_file_chunk));
  i->header->header_hash = olx_content_hash(i->header, 56);
}

void assert_says(const char *expected) {
  if (!strstr(olx_last_error(), expected)) fail_msg("\"%s\" is not in \"%s\"", expected, olx_last_error());
}

void assert_field_refused(const field_image *i, olx_result expected, const char *message) {
  olx_field *field = (olx_field *)(uintptr_t)1;
  const olx_result result = olx_field_open_memory(i->bytes, i->size_bytes, &field);
  if (result != expected) fail_msg("result %d, not %d: %s", (int)result, (int)expected, olx_last_error());
  assert_null(field);
  assert_says(message);
  assert_says("field in memory: ");
}

void assert_field_unverified(const field_image *i, olx_result expected, const char *message) {
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i->bytes, i->size_bytes, &field), OLX_OK);
  const olx_result result = olx_field_verify(field);
  if (result != expected) fail_msg("result %d, not %d: %s", (int)result, (int)expected, olx_last_error());
  assert_says(message);
  olx_field_close(field);
}

void assert_field_sound(const field_image *i) {
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i->bytes, i->size_bytes, &field), OLX_OK);
  if (olx_field_verify(field) != OLX_OK) fail_msg("%s", olx_last_error());
  olx_field_close(field);
}
