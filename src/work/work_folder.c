// Keeps units as files in a folder: finds them by name, renames them into place from temporary names, and verifies
// their hashes. The folder is held open from the first access, so that nobody can replace it.
#include "work/work_folder.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MOST_STAGE = 15, NAME_BYTES = 64, OPEN_ATTEMPTS = 16, ALONE_ATTEMPTS = 100, ENDS_EARLY = -1 };

#define SUFFIX ".unit"
#define MAGIC "OLXUNIT1"

static const olx_unit_name manifest_name = {"manifest", 0, 0, OLX_PARTS_ALL};

struct olx_work_folder {
  int descriptor;
  char path[PATH_MAX];
  olx_manifest manifest;
  uint64_t key; // hash of the manifest without the parts of the scene
  olx_scene_parts edited;
  uint64_t bytes;
  bool full; // the last result to be stored found no space
};

// The header of a unit's file.
typedef struct unit_header {
  char magic[8];
  uint64_t key, size_bytes, hash;
  char stage[MOST_STAGE + 1];
  uint32_t round, unit;
  uint64_t header_hash; // hash of everything before it
} unit_header;

_Static_assert(sizeof(unit_header) == OLX_UNIT_HEADER_BYTES && offsetof(unit_header, header_hash) == 56,
               "no padding that hashes would see");

// ---- Manifests

void olx_manifest_add(olx_manifest *manifest, const char *name, const char *value) {
  const size_t length = strlen(manifest->text);
  snprintf(manifest->text + length, sizeof manifest->text - length, "%s %s\n", name, value);
}

void olx_manifest_add_hash(olx_manifest *manifest, const char *name, uint64_t hash) {
  char value[24];
  snprintf(value, sizeof value, "%016llx", (unsigned long long)hash);
  olx_manifest_add(manifest, name, value);
}

olx_manifest_value olx_manifest_find(const olx_manifest *manifest, const char *name) {
  olx_manifest_value value = {""};
  const size_t length = strlen(name);
  for (const char *line = manifest->text; *line;) {
    const char *end = strchr(line, '\n');
    if (!end) break;
    if (strncmp(line, name, length) == 0 && line[length] == ' ') {
      snprintf(value.text, sizeof value.text, "%.*s", (int)(end - line - (ptrdiff_t)length - 1), line + length + 1);
    }
    line = end + 1;
  }
  return value;
}

// ---- Parts of the scene

typedef struct part_list {
  char names[OLX_MOST_SCENE_PARTS][32];
  uint32_t count;
} part_list;

static part_list parts_of(const olx_manifest *manifest) {
  part_list list = {.count = 0};
  const olx_manifest_value names = olx_manifest_find(manifest, "parts-of-scene");
  for (const char *word = names.text; *word && list.count < OLX_MOST_SCENE_PARTS; word += strspn(word, " ")) {
    const size_t end = strcspn(word, " ");
    snprintf(list.names[list.count++], sizeof *list.names, "%.*s", (int)end, word);
    word += end;
  }
  return list;
}

static bool has_part(olx_scene_parts parts, uint32_t i) { return parts == OLX_PARTS_ALL || parts >> i & 1u; }

uint64_t olx_manifest_key(const olx_manifest *manifest, olx_scene_parts parts) {
  const part_list list = parts_of(manifest);
  char text[OLX_MOST_SCENE_PARTS * sizeof(olx_manifest_value)] = "";
  size_t length = 0;
  for (uint32_t i = 0; i < list.count; i++) {
    if (!has_part(parts, i)) continue;
    const olx_manifest_value value = olx_manifest_find(manifest, list.names[i]);
    length += (size_t)snprintf(text + length, sizeof text - length, "%u %s\n", i, value.text);
  }
  return olx_content_hash(text, length);
}

olx_scene_parts olx_manifest_differing(const olx_manifest *a, const olx_manifest *b) {
  const part_list list = parts_of(a);
  olx_scene_parts parts = 0;
  for (uint32_t i = 0; i < list.count; i++) {
    const olx_manifest_value one = olx_manifest_find(a, list.names[i]), other = olx_manifest_find(b, list.names[i]);
    if (strcmp(one.text, other.text) != 0) parts |= 1u << i;
  }
  return parts;
}

olx_manifest_value olx_manifest_part_names(const olx_manifest *manifest, olx_scene_parts parts) {
  const part_list list = parts_of(manifest);
  olx_manifest_value names = {""};
  size_t length = 0;
  for (uint32_t i = 0; i < list.count; i++) {
    if (!(parts >> i & 1u)) continue;
    length +=
        (size_t)snprintf(names.text + length, sizeof names.text - length, "%s%s", length ? " " : "", list.names[i]);
  }
  return names;
}

static bool is_part(const part_list *list, const char *name) {
  for (uint32_t i = 0; i < list->count; i++) {
    if (strcmp(list->names[i], name) == 0) return true;
  }
  return false;
}

// Returns the manifest without the lines of parts of the scene.
static olx_manifest identity_of(const olx_manifest *manifest) {
  const part_list list = parts_of(manifest);
  olx_manifest identity = {""};
  size_t length = 0;
  for (const char *line = manifest->text; *line;) {
    const size_t size = strcspn(line, "\n") + (strchr(line, '\n') != NULL);
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(line, " "), line);
    if (!is_part(&list, name)) {
      memcpy(identity.text + length, line, size);
      length += size;
    }
    line += size;
  }
  return identity;
}

// Returns whether a folder's bake is the wanted one, but for parts of the scene.
static bool is_same_but_for_scene(const olx_manifest *is, const olx_manifest *wanted) {
  const olx_manifest a = identity_of(is), b = identity_of(wanted);
  return strcmp(a.text, b.text) == 0;
}

static olx_result refuse_other_bake(const olx_work_folder *f, const olx_work_folder_settings *settings) {
  const olx_manifest *wanted = settings->manifest;
  const bool alone = settings->lock == OLX_WORK_ALONE; // a part cannot forget what others made
  const bool edited = alone && is_same_but_for_scene(&f->manifest, wanted);
  char name[64] = "";
  for (const char *line = wanted->text; *line; line = strchr(line, '\n') + 1) {
    snprintf(name, sizeof name, "%.*s", (int)strcspn(line, " "), line);
    const olx_manifest_value is = olx_manifest_find(&f->manifest, name), want = olx_manifest_find(wanted, name);
    if (strcmp(is.text, want.text) == 0) continue;
    return olx_fail(OLX_ERROR_ARGUMENT,
                    "%s: the work folder is of another bake, with '%s %s' in place of '%s %s'; %sname another folder%s",
                    f->path, name, *is.text ? is.text : "(not known)", name, want.text,
                    alone ? "begin again with --fresh, or " : "",
                    edited ? ", or reuse what still holds with --keep-work" : "");
  }
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: the work folder is of another bake", f->path);
}

// ---- Files

static void file_of(const olx_unit_name *name, char file[NAME_BYTES]) {
  snprintf(file, NAME_BYTES, "%.*s-%u-%u" SUFFIX, MOST_STAGE, name->stage, name->round, name->unit);
}

static bool skip_number(const char **text) {
  const size_t digits = strspn(*text, "0123456789");
  *text += digits;
  return digits > 0 && digits <= 10;
}

static bool is_unit_name(const char *name) {
  const size_t letters = strspn(name, "abcdefghijklmnopqrstuvwxyz");
  if (letters == 0 || letters > MOST_STAGE || name[letters] != '-') return false;
  const char *rest = name + letters + 1;
  return skip_number(&rest) && *rest++ == '-' && skip_number(&rest) && strcmp(rest, SUFFIX) == 0;
}

// Returns whether the manifest accounts for a file: it lists the stages whose units the folder may hold.
static bool is_named(const olx_work_folder *f, const char *file) {
  char stage[MOST_STAGE + 1] = "";
  if (!is_unit_name(file)) return false;
  memcpy(stage, file, strspn(file, "abcdefghijklmnopqrstuvwxyz"));
  const olx_manifest_value stages = olx_manifest_find(&f->manifest, "stages");
  const size_t length = strlen(stage);
  for (const char *word = stages.text; *word; word += strspn(word, " ")) {
    const size_t end = strcspn(word, " ");
    if (end == length && strncmp(word, stage, length) == 0) return true;
    word += end;
  }
  return false;
}

// The key of a unit: of the bake, and of the parts of the scene that the unit depends on. The manifest has key 0.
static uint64_t key_of(const olx_work_folder *f, const olx_unit_name *name) {
  const uint64_t keys[] = {f->key, olx_manifest_key(&f->manifest, name->parts)};
  return f->key ? olx_content_hash(keys, sizeof keys) : 0;
}

static unit_header header_of(const olx_work_folder *f, const olx_unit_name *name, const void *data, size_t size_bytes) {
  unit_header header = {.key = key_of(f, name),
                        .size_bytes = size_bytes,
                        .hash = olx_content_hash(data, size_bytes),
                        .round = name->round,
                        .unit = name->unit};
  memcpy(header.magic, MAGIC, sizeof header.magic);
  snprintf(header.stage, sizeof header.stage, "%s", name->stage);
  header.header_hash = olx_content_hash(&header, offsetof(unit_header, header_hash));
  return header;
}

static int write_all(int descriptor, const void *data, size_t size_bytes) {
  const char *bytes = data;
  while (size_bytes > 0) {
    const ssize_t written = write(descriptor, bytes, size_bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : EIO;
    bytes += written;
    size_bytes -= (size_t)written;
  }
  return 0;
}

static int write_unit(const olx_work_folder *f, const olx_unit_name *name, const void *data, size_t size_bytes) {
  char file[NAME_BYTES];
  olx_temporary temporary;
  const unit_header header = header_of(f, name, data, size_bytes);
  file_of(name, file);
  int error = olx_temporary_create_at(f->descriptor, 0600, &temporary);
  if (error) return error;
  error = write_all(temporary.descriptor, &header, sizeof header);
  if (!error) error = write_all(temporary.descriptor, data, size_bytes);
  if (!error) return olx_temporary_put(&temporary, file);
  olx_temporary_discard(&temporary);
  return error;
}

static bool is_file(const olx_work_folder *f, const char *file, struct stat *status) {
  return fstatat(f->descriptor, file, status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(status->st_mode);
}

static uint64_t stored_bytes(const olx_work_folder *f, const olx_unit_name *name) {
  char file[NAME_BYTES];
  struct stat status;
  file_of(name, file);
  return is_file(f, file, &status) ? (uint64_t)status.st_size : 0;
}

olx_result olx_work_folder_put(olx_work_folder *f, const olx_unit_name *name, const void *data, size_t size_bytes) {
  const uint64_t replaced = stored_bytes(f, name);
  const int error = write_unit(f, name, data, size_bytes);
  f->full = error == ENOSPC || error == EDQUOT;
  if (error) {
    char file[NAME_BYTES];
    file_of(name, file);
    return olx_fail(OLX_ERROR_FILE, "%s/%s: cannot write: %s", f->path, file, strerror(error));
  }
  f->bytes += sizeof(unit_header) + size_bytes;
  f->bytes -= f->bytes < replaced ? f->bytes : replaced;
  return OLX_OK;
}

void olx_work_folder_drop(olx_work_folder *f, const olx_unit_name *name) {
  char file[NAME_BYTES];
  struct stat status;
  file_of(name, file);
  if (is_file(f, file, &status)) unlinkat(f->descriptor, file, 0);
}

// Returns 0, ENDS_EARLY, or the error number.
static int read_all(int descriptor, void *data, size_t size_bytes) {
  char *bytes = data;
  while (size_bytes > 0) {
    const ssize_t got = read(descriptor, bytes, size_bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return got < 0 ? errno : ENDS_EARLY;
    bytes += got;
    size_bytes -= (size_t)got;
  }
  return 0;
}

// Returns whether a header is undamaged, of whichever scene.
static bool is_header(const olx_unit_name *name, const unit_header *h) {
  return memcmp(h->magic, MAGIC, sizeof h->magic) == 0 && h->round == name->round && h->unit == name->unit &&
         strncmp(h->stage, name->stage, sizeof h->stage) == 0 &&
         olx_checksum_holds(olx_content_hash(h, offsetof(unit_header, header_hash)), h->header_hash);
}

static int open_unit(const olx_work_folder *f, const char *file) {
  return openat(f->descriptor, file, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
}

// A header that is damaged or cannot be read counts as stored: reading the unit reports it.
olx_unit_state olx_work_folder_look(const olx_work_folder *f, const olx_unit_name *name) {
  char file[NAME_BYTES];
  struct stat status;
  unit_header header;
  file_of(name, file);
  if (!is_file(f, file, &status)) return OLX_UNIT_ABSENT;
  const int descriptor = open_unit(f, file);
  if (descriptor < 0) return OLX_UNIT_STORED;
  const bool stale =
      read_all(descriptor, &header, sizeof header) == 0 && is_header(name, &header) && header.key != key_of(f, name);
  close(descriptor);
  return stale ? OLX_UNIT_STALE : OLX_UNIT_STORED;
}

bool olx_work_folder_has(const olx_work_folder *f, const olx_unit_name *name) {
  return olx_work_folder_look(f, name) == OLX_UNIT_STORED;
}

// Explains why a file was not read whole. One that cannot be read now is not damaged for all that.
static olx_result refuse_file(const char *path, int error) {
  if (error == 0 || error == ENDS_EARLY) return olx_fail(OLX_ERROR_CHECKSUM, "%s: is damaged", path);
  return olx_fail(OLX_ERROR_FILE, "%s: cannot read: %s", path, strerror(error));
}

// Reads the bytes after a header that is valid.
static olx_result read_content(int descriptor, const unit_header *h, const char *path, void **data) {
  *data = olx_allocate(h->size_bytes, 1);
  if (!*data)
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %llu bytes", path, (unsigned long long)h->size_bytes);
  const int error = read_all(descriptor, *data, h->size_bytes);
  if (!error && olx_checksum_holds(olx_content_hash(*data, h->size_bytes), h->hash)) return OLX_OK;
  olx_release(*data);
  *data = NULL;
  return refuse_file(path, error);
}

static olx_result read_unit(const olx_work_folder *f, const olx_unit_name *name, bool stale, int descriptor,
                            const char *path, void **data, size_t *size_bytes) {
  unit_header header;
  struct stat status;
  if (fstat(descriptor, &status) != 0) return refuse_file(path, errno);
  if (!S_ISREG(status.st_mode)) return olx_fail(OLX_ERROR_INCOMPLETE, "%s: not a regular file", path);
  const int error = read_all(descriptor, &header, sizeof header);
  const bool whole =
      !error && is_header(name, &header) && (uint64_t)status.st_size == sizeof header + header.size_bytes;
  if (!whole) return refuse_file(path, error);
  if (stale != (header.key != key_of(f, name))) return olx_fail(OLX_ERROR_INCOMPLETE, "%s: is of another scene", path);
  *size_bytes = header.size_bytes;
  return read_content(descriptor, &header, path, data);
}

// What is no file, such as a link, counts as no unit.
static olx_result refuse_open(const char *path, int error) {
  const bool absent = error == ENOENT || error == ELOOP;
  return olx_fail(absent ? OLX_ERROR_INCOMPLETE : OLX_ERROR_FILE, "%s: cannot open: %s", path, strerror(error));
}

static olx_result get(const olx_work_folder *f, const olx_unit_name *name, bool stale, void **data,
                      size_t *size_bytes) {
  char file[NAME_BYTES], path[PATH_MAX + NAME_BYTES];
  file_of(name, file);
  snprintf(path, sizeof path, "%s/%s", f->path, file);
  *data = NULL;
  *size_bytes = 0;
  const int descriptor = open_unit(f, file);
  if (descriptor < 0) return refuse_open(path, errno);
  const olx_result result = read_unit(f, name, stale, descriptor, path, data, size_bytes);
  close(descriptor);
  return result;
}

olx_result olx_work_folder_get(const olx_work_folder *f, const olx_unit_name *name, void **data, size_t *size_bytes) {
  return get(f, name, false, data, size_bytes);
}

void olx_work_folder_get_stale(const olx_work_folder *f, const olx_unit_name *name, void **data, size_t *size_bytes) {
  if (get(f, name, true, data, size_bytes) != OLX_OK) *data = NULL;
}

// ---- The folder

// The content of a folder.
typedef struct folder_content {
  uint64_t bytes; // total size of units
  bool foreign;   // it holds something that is neither a unit of the manifest's stages nor a temporary file
} folder_content;

static bool is_manifest(const char *file) {
  char own[NAME_BYTES];
  file_of(&manifest_name, own);
  return strcmp(file, own) == 0;
}

// Visits every entry, and removes units with `remove`. The manifest stays, because a program that is killed here leaves
// units that only the manifest accounts for.
static olx_result go_through(const olx_work_folder *f, bool remove, folder_content *content) {
  *content = (folder_content){0};
  const int descriptor = openat(f->descriptor, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR *entries = descriptor < 0 ? NULL : fdopendir(descriptor);
  if (!entries) {
    if (descriptor >= 0) close(descriptor);
    return olx_fail(OLX_ERROR_FILE, "%s: cannot read: %s", f->path, strerror(errno));
  }
  for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
    struct stat status;
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
    const bool unit = is_named(f, entry->d_name) && is_file(f, entry->d_name, &status);
    content->bytes += unit ? (uint64_t)status.st_size : 0;
    content->foreign |= !unit && !olx_is_temporary_name(entry->d_name);
    if (unit && remove && !is_manifest(entry->d_name)) unlinkat(f->descriptor, entry->d_name, 0);
  }
  closedir(entries);
  return OLX_OK;
}

static void set_manifest(olx_work_folder *f, const olx_manifest *manifest) {
  const olx_manifest identity = identity_of(manifest);
  f->manifest = *manifest;
  f->key = olx_content_hash(identity.text, strlen(identity.text));
}

// Reads the manifest. Its own file is stored with key 0, because no manifest is known yet.
static olx_result read_manifest(olx_work_folder *f) {
  void *data;
  size_t size_bytes;
  olx_manifest manifest = {""};
  f->key = 0;
  const olx_result result = olx_work_folder_get(f, &manifest_name, &data, &size_bytes);
  if (result == OLX_ERROR_FILE) return result;
  if (result == OLX_ERROR_INCOMPLETE) return olx_fail(OLX_ERROR_FILE, "%s", olx_last_error());
  if (result != OLX_OK) {
    return olx_fail(result, "%s; nothing says what the folder's other files are: remove it by hand", olx_last_error());
  }
  const bool fits = size_bytes < sizeof manifest.text;
  if (fits) memcpy(manifest.text, data, size_bytes);
  olx_release(data);
  if (!fits) return olx_fail(OLX_ERROR_FORMAT, "%s: its manifest is too long", f->path);
  set_manifest(f, &manifest);
  return OLX_OK;
}

static olx_result write_manifest(olx_work_folder *f, const olx_manifest *manifest) {
  f->key = 0;
  OLX_TRY(olx_work_folder_put(f, &manifest_name, manifest->text, strlen(manifest->text)));
  set_manifest(f, manifest);
  return OLX_OK;
}

static bool is_being_cleared(const olx_work_folder *f) { return *olx_manifest_find(&f->manifest, "cleared").text; }

// Removes all units. The manifest says so first, so that the next program continues with the removal where this one is
// killed; a full disk does not keep the units from being removed.
static olx_result clear(olx_work_folder *f) {
  folder_content content;
  olx_manifest marked = f->manifest;
  olx_manifest_add(&marked, "cleared", "yes");
  if (write_manifest(f, &marked) != OLX_OK) olx_log(OLX_LOG_WARNING, "%s", olx_last_error());
  OLX_TRY(go_through(f, true, &content));
  f->bytes = 0;
  return OLX_OK;
}

// Clears the folder. The new manifest replaces the old one once the old one's units are gone.
static olx_result begin_again(olx_work_folder *f, const olx_manifest *manifest) {
  OLX_TRY(clear(f));
  return write_manifest(f, manifest);
}

static olx_result use_manifest(olx_work_folder *f, const olx_work_folder_settings *settings) {
  const olx_manifest *manifest = settings->manifest;
  folder_content content;
  OLX_TRY(read_manifest(f));
  if (manifest && (settings->fresh || is_being_cleared(f))) return begin_again(f, manifest);
  if (is_being_cleared(f)) return olx_fail(OLX_ERROR_FILE, "%s: its bake is finished, and its units are gone", f->path);
  OLX_TRY(go_through(f, false, &content));
  f->bytes = content.bytes;
  if (!manifest || strcmp(manifest->text, f->manifest.text) == 0) return OLX_OK;
  if (!settings->edited || !is_same_but_for_scene(&f->manifest, manifest)) return refuse_other_bake(f, settings);
  f->edited = olx_manifest_differing(manifest, &f->manifest);
  return write_manifest(f, manifest); // units keep their keys, by which it shows which of them still hold
}

// Writes the manifest or compares it with the existing one; other programs may write the same manifest at the same
// time.
static olx_result settle_manifest(olx_work_folder *f, const olx_work_folder_settings *settings) {
  folder_content content;
  if (olx_work_folder_has(f, &manifest_name)) return use_manifest(f, settings);
  if (!settings->manifest) return olx_fail(OLX_ERROR_FILE, "%s: not a work folder: it has no manifest", f->path);
  OLX_TRY(go_through(f, false, &content));
  if (!content.foreign) return write_manifest(f, settings->manifest);
  if (olx_work_folder_has(f, &manifest_name)) return use_manifest(f, settings);
  return olx_fail(OLX_ERROR_FILE, "%s: not a work folder: it has no manifest, and there are files in it", f->path);
}

static olx_result refuse_folder(const olx_work_folder *f, const char *why) {
  return olx_fail(OLX_ERROR_FILE, "%s: cannot be a work folder: %s", f->path, why);
}

static olx_result open_existing(olx_work_folder *f) {
  struct stat status;
  f->descriptor = open(f->path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (f->descriptor < 0) {
    if (errno == ENOTDIR || errno == ELOOP) return refuse_folder(f, "it is a file or a link");
    return refuse_folder(f, strerror(errno));
  }
  if (fstat(f->descriptor, &status) != 0) return refuse_folder(f, strerror(errno));
  if (status.st_uid != geteuid()) return refuse_folder(f, "it is another user's");
  if (status.st_mode & 077) return refuse_folder(f, "others may look into it (its mode must be 0700)");
  return OLX_OK;
}

// Leaves no folder behind that it made where the file system does not support folders of one user.
static olx_result open_folder(olx_work_folder *f, bool make) {
  const bool made = make && mkdir(f->path, 0700) == 0;
  if (make && !made && errno != EEXIST) {
    return olx_fail(OLX_ERROR_FILE, "%s: cannot create: %s", f->path, strerror(errno));
  }
  const olx_result result = open_existing(f);
  if (result != OLX_OK && made) rmdir(f->path);
  return result;
}

static olx_result lock_folder(const olx_work_folder *f, olx_work_lock lock) {
  const int operation = lock == OLX_WORK_ALONE ? LOCK_EX : LOCK_SH;
  if (flock(f->descriptor, operation | LOCK_NB) == 0 || errno != EWOULDBLOCK) return OLX_OK;
  return olx_fail(OLX_ERROR_FILE, "%s: another bake works in this folder", f->path);
}

// Returns whether the folder still has its name; the program that had locked it may have removed it.
static bool still_there(const olx_work_folder *f) {
  struct stat opened, named;
  return fstat(f->descriptor, &opened) == 0 && lstat(f->path, &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

static olx_result open_locked(olx_work_folder *f, const olx_work_folder_settings *settings) {
  for (uint32_t attempt = 0; attempt < OPEN_ATTEMPTS; attempt++) {
    OLX_TRY(open_folder(f, settings->manifest != NULL));
    OLX_TRY(lock_folder(f, settings->lock));
    if (still_there(f)) {
      if (settings->lock == OLX_WORK_ALONE) olx_temporary_reclaim(f->descriptor, false);
      return settle_manifest(f, settings);
    }
    close(f->descriptor);
    f->descriptor = -1;
  }
  return refuse_folder(f, "others keep removing it");
}

// Copies the path without trailing slashes, which would follow a link.
static olx_result copy_path(olx_work_folder *f, const char *path) {
  size_t length = strlen(path);
  while (length > 1 && path[length - 1] == '/') length--;
  if (length == 0 || length >= sizeof f->path) return olx_fail(OLX_ERROR_FILE, "'%s': cannot be a work folder", path);
  memcpy(f->path, path, length);
  return OLX_OK;
}

olx_result olx_work_folder_open(const char *path, const olx_work_folder_settings *settings, olx_work_folder **folder) {
  olx_work_folder *f = olx_allocate_zero(1, sizeof *f);
  *folder = NULL;
  if (!f) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  f->descriptor = -1;
  olx_result result = copy_path(f, path);
  if (result == OLX_OK) result = open_locked(f, settings);
  if (result == OLX_OK) *folder = f;
  else olx_work_folder_close(f);
  return result;
}

void olx_work_folder_close(olx_work_folder *f) {
  if (!f) return;
  if (f->descriptor >= 0) close(f->descriptor);
  olx_release(f);
}

// Waits until no other program has the folder open, which parts that look for what is left to do have for a moment.
// Returns false when one of them keeps it.
static bool gets_alone(const olx_work_folder *f) {
  const struct timespec pause = {.tv_nsec = 50000000};
  for (uint32_t attempt = 0; attempt < ALONE_ATTEMPTS; attempt++) {
    if (flock(f->descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
    nanosleep(&pause, NULL);
  }
  return false;
}

void olx_work_folder_remove(olx_work_folder *f) {
  if (!gets_alone(f)) {
    olx_log(OLX_LOG_WARNING, "%s: the work folder stays: another part works in it", f->path);
    olx_work_folder_close(f);
    return;
  }
  if (!still_there(f)) { // another program has joined the same results
    olx_work_folder_close(f);
    return;
  }
  if (clear(f) == OLX_OK) olx_work_folder_drop(f, &manifest_name);
  olx_temporary_reclaim(f->descriptor, true);
  if (rmdir(f->path) != 0) olx_log(OLX_LOG_WARNING, "%s: the work folder stays: %s", f->path, strerror(errno));
  olx_work_folder_close(f);
}

// Returns whether a unit may hold for this scene, as one that cannot be read now.
static bool may_hold(const olx_work_folder *f, const char *file) {
  unit_header header;
  const int descriptor = open_unit(f, file);
  if (descriptor < 0) return true;
  const int error = read_all(descriptor, &header, sizeof header);
  close(descriptor);
  if (error) return error != ENDS_EARLY;
  const uint32_t count = parts_of(&f->manifest).count;
  for (olx_scene_parts parts = 0; parts < 1u << count; parts++) {
    if (header.key == key_of(f, &(olx_unit_name){.parts = parts})) return true;
  }
  return false;
}

void olx_work_folder_tidy(olx_work_folder *f) {
  const int descriptor = openat(f->descriptor, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR *entries = descriptor < 0 ? NULL : fdopendir(descriptor);
  if (!entries && descriptor >= 0) close(descriptor);
  for (const struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
    struct stat status;
    const bool unit = is_named(f, entry->d_name) && is_file(f, entry->d_name, &status);
    if (unit && !is_manifest(entry->d_name) && !may_hold(f, entry->d_name)) unlinkat(f->descriptor, entry->d_name, 0);
  }
  if (entries) closedir(entries);
}

olx_scene_parts olx_work_folder_edited(const olx_work_folder *f) { return f->edited; }
const olx_manifest *olx_work_folder_manifest(const olx_work_folder *f) { return &f->manifest; }
uint64_t olx_work_folder_bytes(const olx_work_folder *f) { return f->bytes; }
bool olx_work_folder_is_full(const olx_work_folder *f) { return f->full; }
