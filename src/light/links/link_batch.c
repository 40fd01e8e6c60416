// Allocates memory for links, either as ordinary memory or as a mapped file without a name, and takes the pages of such
// a file out of memory.
#include "light/links/link_batch.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/temporary.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

// Maps a file of that size. The room on the disk is reserved, because a mapped file that finds none ends the program.
static olx_result map_file(const char *folder, size_t size_bytes, void **memory) {
  olx_temporary file;
  int error = olx_temporary_create(folder, 0600, &file);
  if (error) return olx_fail(OLX_ERROR_FILE, "%s: no file for links: %s", folder, strerror(error));
  error = posix_fallocate(file.descriptor, 0, (off_t)size_bytes);
  void *mapped = error ? MAP_FAILED : mmap(NULL, size_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.descriptor, 0);
  olx_temporary_discard(&file); // the mapping keeps the file
  if (error)
    return olx_fail(OLX_ERROR_FILE, "%s: no room for %zu bytes of links: %s", folder, size_bytes, strerror(error));
  if (mapped == MAP_FAILED)
    return olx_fail(OLX_ERROR_MEMORY, "%s: %zu bytes of links cannot be mapped", folder, size_bytes);
  *memory = mapped;
  return OLX_OK;
}

static olx_result allocate(const olx_link_batch *batch, size_t size_bytes, void **memory) {
  if (batch->folder) return map_file(batch->folder, size_bytes, memory);
  *memory = olx_allocate(size_bytes, 1);
  if (*memory) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %zu bytes of links of %u surfels", size_bytes,
                  batch->count);
}

static void release(const olx_link_batch *batch, void *memory, size_t size_bytes) {
  if (!batch->folder) olx_release(memory);
  else if (memory) munmap(memory, size_bytes);
}

static size_t link_count(const olx_link_batch *batch) { return (size_t)batch->count * batch->rays; }

olx_result olx_link_batch_allocate(olx_link_batch *batch, bool fixed) {
  void *memory;
  OLX_TRY(allocate(batch, link_count(batch) * sizeof *batch->links, &memory));
  batch->links = memory;
  if (!fixed) return OLX_OK;
  const olx_result result = allocate(batch, link_count(batch) * sizeof *batch->fixed, &memory);
  if (result == OLX_OK) batch->fixed = memory;
  else olx_link_batch_release(batch);
  return result;
}

void olx_link_batch_release(olx_link_batch *batch) {
  release(batch, batch->links, link_count(batch) * sizeof *batch->links);
  olx_link_batch_release_fixed(batch);
  batch->links = NULL;
}

void olx_link_batch_release_fixed(olx_link_batch *batch) {
  release(batch, batch->fixed, link_count(batch) * sizeof *batch->fixed);
  batch->fixed = NULL;
}

// Takes every page that the range touches out of memory. What was written stays in the file.
static void rest(const void *memory, size_t first_byte, size_t end_byte) {
  const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), first = ((uintptr_t)memory + first_byte) / page * page;
  if (end_byte > first_byte) madvise((void *)first, (uintptr_t)memory + end_byte - first, MADV_DONTNEED);
}

void olx_link_batch_rest(const olx_link_batch *batch, uint32_t first, uint32_t end) {
  if (!batch->folder || !batch->links) return;
  const size_t begin = (size_t)first * batch->rays, last = (size_t)end * batch->rays;
  rest(batch->links, begin * sizeof *batch->links, last * sizeof *batch->links);
  if (batch->fixed) rest(batch->fixed, begin * sizeof *batch->fixed, last * sizeof *batch->fixed);
}
