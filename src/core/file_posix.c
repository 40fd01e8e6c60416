// Writes files that are complete or absent, by a temporary file that is synced and renamed, and maps files into memory
// for reading.
#include "core/file.h"

#include "core/hooks.h"
#include "core/result.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

// The place to which an output is written.
typedef struct output_place {
  bool stream;   // an existing node that is written directly; false for a file that is put into place
  bool replaces; // a file with `status` exists
  struct stat status;
  char target[PATH_MAX]; // the file to which links lead
} output_place;

static bool is_standard_output(const char *path) { return strcmp(path, "-") == 0; }

static olx_result refuse(const char *path, const char *why) {
  return olx_fail(OLX_ERROR_FILE, "%s: cannot write: %s", path, why);
}

static const char *describe_node(mode_t mode) {
  return S_ISDIR(mode)    ? "it is a folder"
         : S_ISBLK(mode)  ? "it is a block device"
         : S_ISSOCK(mode) ? "it is a socket"
         : S_ISCHR(mode)  ? "it is a character device, and this format is not written in order"
                          : "it is a pipe, and this format is not written in order";
}

// Returns the length of a path's folder with its last slash; 0 without one.
static int folder_length(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? (int)(slash - path) + 1 : 0;
}

// Follows the links in place->target to the file to which they lead, which need not exist.
static olx_result follow_links(const char *path, output_place *place) {
  enum { MOST_LINKS = 40 };
  char link[PATH_MAX], next[PATH_MAX];
  for (int i = 0; i < MOST_LINKS; i++) {
    const ssize_t length = readlink(place->target, link, sizeof link - 1);
    if (length < 0) return OLX_OK;
    link[length] = 0;
    const int folder = link[0] == '/' ? 0 : folder_length(place->target);
    if (snprintf(next, sizeof next, "%.*s%s", folder, place->target, link) >= (int)sizeof next) {
      return refuse(path, strerror(ENAMETOOLONG));
    }
    memcpy(place->target, next, sizeof next);
  }
  return refuse(path, strerror(ELOOP));
}

static olx_result find_place(const char *path, bool in_order, output_place *place) {
  *place = (output_place){.stream = is_standard_output(path)};
  if (place->stream) {
    return in_order ? OLX_OK : refuse("standard output", "this format is not written in order, so it needs a file");
  }
  if (snprintf(place->target, sizeof place->target, "%s", path) >= (int)sizeof place->target) {
    return refuse(path, strerror(ENAMETOOLONG));
  }
  if (stat(path, &place->status) != 0) return follow_links(path, place);
  const mode_t mode = place->status.st_mode;
  place->stream = in_order && (S_ISCHR(mode) || S_ISFIFO(mode));
  if (place->stream) return OLX_OK;
  if (!S_ISREG(mode)) return refuse(path, describe_node(mode));
  place->replaces = true;
  struct stat followed;
  OLX_TRY(follow_links(path, place));
  const bool same = stat(place->target, &followed) == 0 && followed.st_dev == place->status.st_dev &&
                    followed.st_ino == place->status.st_ino;
  return same ? OLX_OK : refuse(path, "its link does not lead to a file with a name");
}

// Returns the folder of a file.
static void folder_of(const char *target, char folder[PATH_MAX]) {
  const int length = folder_length(target);
  snprintf(folder, PATH_MAX, "%.*s", length ? length : 1, length ? target : ".");
}

olx_result olx_output_check(const char *path, bool in_order) {
  output_place place;
  char folder[PATH_MAX];
  OLX_TRY(find_place(path, in_order, &place));
  if (is_standard_output(path)) {
    const int flags = fcntl(STDOUT_FILENO, F_GETFL);
    return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY ? OLX_OK : refuse("standard output", "it is closed");
  }
  folder_of(place.target, folder);
  const bool may = place.stream ? faccessat(AT_FDCWD, path, W_OK, AT_EACCESS) == 0
                                : faccessat(AT_FDCWD, folder, W_OK | X_OK, AT_EACCESS) == 0;
  return may ? OLX_OK : refuse(path, strerror(errno));
}

static bool find_file(const char *path, struct stat *status) {
  return stat(path, status) == 0 && S_ISREG(status->st_mode);
}

bool olx_same_file(const char *a, const char *b) {
  struct stat first, second;
  return find_file(a, &first) && find_file(b, &second) && first.st_dev == second.st_dev &&
         first.st_ino == second.st_ino;
}

static olx_result open_stream(const char *path, olx_output_file *file) {
  struct stat status;
  file->stream = true;
  file->descriptor = is_standard_output(path) ? STDOUT_FILENO : open(path, O_WRONLY | O_NOCTTY | O_CLOEXEC);
  if (file->descriptor < 0) return refuse(path, strerror(errno));
  if (is_standard_output(path) ||
      (fstat(file->descriptor, &status) == 0 && (S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode)))) {
    return OLX_OK;
  }
  return refuse(path, "another file has taken its place");
}

static olx_result open_file(const output_place *place, olx_output_file *file) {
  char folder[PATH_MAX];
  folder_of(place->target, folder);
  file->name = olx_copy_string(place->target + folder_length(place->target));
  if (!file->name) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", file->path);
  // A user who may not read the replaced file must not be able to read its successor.
  const int error = olx_temporary_create(folder, place->replaces ? 0600 : 0666, &file->temporary);
  if (error) return olx_fail(OLX_ERROR_FILE, "%s: cannot create: %s", file->path, strerror(error));
  file->descriptor = file->temporary.descriptor;
  file->replaces = place->replaces;
  file->owner = place->status.st_uid;
  file->group = place->status.st_gid;
  file->mode = place->status.st_mode & 07777;
  return OLX_OK;
}

static olx_result open_output(const char *path, bool in_order, olx_output_file *file) {
  output_place place;
  *file = (olx_output_file){.descriptor = -1};
  OLX_TRY(find_place(path, in_order, &place));
  file->path = olx_copy_string(is_standard_output(path) ? "standard output" : path);
  if (!file->path) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  const olx_result result = place.stream ? open_stream(path, file) : open_file(&place, file);
  if (result != OLX_OK) olx_output_discard(file);
  return result;
}

olx_result olx_output_open(const char *path, olx_output_file *file) { return open_output(path, false, file); }

olx_result olx_output_open_in_order(const char *path, olx_output_file *file) { return open_output(path, true, file); }

// Waits until a non-blocking stream accepts more bytes.
static bool wait_for_room(const olx_output_file *file) {
  struct pollfd poller = {.fd = file->descriptor, .events = POLLOUT};
  return errno == EINTR || (errno == EAGAIN && poll(&poller, 1, -1) >= 0);
}

static olx_result write_all(olx_output_file *file, bool at, uint64_t offset, const void *data, size_t size_bytes) {
  const char *bytes = data;
  while (size_bytes > 0) {
    const ssize_t written =
        at ? pwrite(file->descriptor, bytes, size_bytes, (off_t)offset) : write(file->descriptor, bytes, size_bytes);
    if (written < 0 && wait_for_room(file)) continue;
    if (written <= 0) return olx_fail(OLX_ERROR_FILE, "%s: cannot write: %s", file->path, strerror(errno));
    bytes += written;
    offset += (uint64_t)written;
    size_bytes -= (size_t)written;
  }
  return OLX_OK;
}

olx_result olx_output_write(olx_output_file *file, const void *data, size_t size_bytes) {
  return write_all(file, false, 0, data, size_bytes);
}

olx_result olx_output_write_at(olx_output_file *file, uint64_t offset, const void *data, size_t size_bytes) {
  return write_all(file, true, offset, data, size_bytes);
}

static olx_result refuse_spool(const olx_output_file *output, const char *what, int error) {
  return olx_fail(OLX_ERROR_FILE, "%s: cannot %s a temporary file: %s", output->path, what, strerror(error));
}

olx_result olx_spool_append(olx_spool *spool, const olx_output_file *output, const void *data, size_t size_bytes) {
  const char *bytes = data;
  if (!spool->file.open) {
    const int error = olx_temporary_create_at(output->temporary.folder, 0600, &spool->file);
    if (error) return refuse_spool(output, "create", error);
  }
  while (size_bytes > 0) {
    const ssize_t written = pwrite(spool->file.descriptor, bytes, size_bytes, (off_t)spool->size_bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return refuse_spool(output, "write", errno);
    bytes += written;
    spool->size_bytes += (uint64_t)written;
    size_bytes -= (size_t)written;
  }
  return OLX_OK;
}

olx_result olx_spool_read(const olx_spool *spool, const olx_output_file *output, uint64_t offset, void *data,
                          size_t size_bytes) {
  char *bytes = data;
  while (size_bytes > 0) {
    const ssize_t got = pread(spool->file.descriptor, bytes, size_bytes, (off_t)offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return refuse_spool(output, "read", got < 0 ? errno : EIO);
    bytes += got;
    offset += (uint64_t)got;
    size_bytes -= (size_t)got;
  }
  return OLX_OK;
}

void olx_spool_discard(olx_spool *spool) {
  olx_temporary_discard(&spool->file);
  *spool = (olx_spool){0};
}

olx_result olx_output_reserve(olx_output_file *file, uint64_t size_bytes) {
  if (file->stream) return OLX_OK;
  while (fallocate(file->descriptor, 0, 0, (off_t)size_bytes) != 0) {
    if (errno == EINTR) continue;
    if (errno == EOPNOTSUPP || errno == ENOSYS) break;
    return olx_fail(OLX_ERROR_FILE, "%s: cannot reserve %llu bytes: %s", file->path, (unsigned long long)size_bytes,
                    strerror(errno));
  }
  return OLX_OK;
}

// Gives the file the owner and the permissions of the file that it replaces, as far as the system permits.
static void keep_owner_and_mode(const olx_output_file *file) {
  const bool owned = fchown(file->descriptor, file->owner, file->group) == 0;
  // Set-user-ID permissions of another owner are not kept.
  if (!owned) (void)!fchown(file->descriptor, (uid_t)-1, file->group);
  (void)fchmod(file->descriptor, owned ? file->mode : file->mode & 0777);
}

olx_result olx_output_commit(olx_output_file *file) {
  int error = 0;
  if (file->stream) {
    if (file->descriptor != STDOUT_FILENO && close(file->descriptor) != 0) error = errno;
    file->descriptor = -1;
  } else {
    if (file->replaces) keep_owner_and_mode(file);
    error = olx_temporary_put(&file->temporary, file->name);
  }
  const olx_result result =
      error ? olx_fail(OLX_ERROR_FILE, "%s: cannot write: %s", file->path, strerror(error)) : OLX_OK;
  olx_output_discard(file);
  return result;
}

void olx_output_discard(olx_output_file *file) {
  if (file->stream && file->descriptor >= 0 && file->descriptor != STDOUT_FILENO) close(file->descriptor);
  olx_temporary_discard(&file->temporary);
  olx_release(file->name);
  olx_release(file->path);
  *file = (olx_output_file){.descriptor = -1};
}

olx_result olx_write_file(const char *path, const void *data, size_t size_bytes) {
  olx_output_file file;
  OLX_TRY(olx_output_open_in_order(path, &file));
  const olx_result result = olx_output_write(&file, data, size_bytes);
  if (result != OLX_OK) {
    olx_output_discard(&file);
    return result;
  }
  return olx_output_commit(&file);
}

olx_result olx_map_file(const char *path, olx_mapped_file *file) {
  *file = (olx_mapped_file){0};
  const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); // a pipe must not wait for its writer
  if (descriptor < 0) return olx_fail(OLX_ERROR_FILE, "%s: cannot open: %s", path, strerror(errno));
  struct stat status;
  olx_result result = OLX_OK;
  if (fstat(descriptor, &status) != 0) {
    result = olx_fail(OLX_ERROR_FILE, "%s: cannot read: %s", path, strerror(errno));
  } else if (!S_ISREG(status.st_mode)) {
    result = olx_fail(OLX_ERROR_FILE, "%s: not a regular file", path);
  } else if (status.st_size == 0) {
    file->data = "";
  } else {
    void *data = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_SHARED, descriptor, 0);
    if (data == MAP_FAILED) {
      result = olx_fail(OLX_ERROR_FILE, "%s: cannot map: %s", path, strerror(errno));
    } else {
      *file = (olx_mapped_file){.data = data, .size_bytes = (size_t)status.st_size};
    }
  }
  close(descriptor);
  return result;
}

void olx_unmap_file(olx_mapped_file *file) {
  if (file->size_bytes > 0) munmap((void *)(uintptr_t)file->data, file->size_bytes);
  *file = (olx_mapped_file){0};
}
