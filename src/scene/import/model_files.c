// Decides which files a model may read, for every importer: a model is not trusted to name arbitrary files of the
// machine. Assimp opens all of its files through this, each material file once.
#include "scene/import/model_files.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/import/import_limits.h"
#include "scene/sources.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>

#include <ctype.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
  MOST_PATH = 4096,
  LEAST_TEXT = 8 // bytes below which Assimp refuses a file of text
};

// Finds the folder that contains `path`, with links resolved; false when it cannot be found.
static bool folder_of(const char *path, char folder[static MOST_PATH]) {
  char named[MOST_PATH];
  const char *slash = strrchr(path, '/');
  const int length = !slash ? 1 : slash == path ? 1 : (int)(slash - path);
  if (snprintf(named, sizeof named, "%.*s", length, slash ? path : ".") >= (int)sizeof named) return false;
  char *resolved = realpath(named, NULL);
  const bool fits = resolved && strlen(resolved) < MOST_PATH;
  if (fits) snprintf(folder, MOST_PATH, "%s", resolved);
  free(resolved);
  return fits;
}

olx_result olx_model_file_check(const olx_scene *scene, const char *model_path, const char *path) {
  if (scene->load.allow_outside) return OLX_OK;
  char folder[MOST_PATH];
  char *resolved = realpath(path, NULL);
  if (!resolved) return OLX_OK;
  olx_result result = OLX_OK;
  if (!folder_of(model_path, folder)) {
    result = olx_fail(OLX_ERROR_FILE, "%s: its folder cannot be found", model_path);
  } else {
    const size_t length = (size_t)(strrchr(folder, '/') - folder); // length of the parent's path; 0 for the root
    if (strncmp(resolved, folder, length) != 0 || resolved[length] != '/') {
      folder[length] = 0;
      result = olx_fail(OLX_ERROR_UNSUPPORTED,
                        "%s: it names %s, which lies outside %s (--allow-outside reads it, or "
                        "olx_scene_load_settings.allow_outside)",
                        model_path, resolved, folder);
    }
  }
  free(resolved);
  return result;
}

// Returns the byte that `text` escapes as % and two hexadecimal digits; 0 where it begins with no such escape.
static char escaped_byte(const char *text) {
  if (text[0] != '%' || !isxdigit((unsigned char)text[1]) || !isxdigit((unsigned char)text[2])) return 0;
  const char digits[3] = {text[1], text[2], 0};
  return (char)strtoul(digits, NULL, 16);
}

void olx_model_file_locate(const char *model_path, const char *name, char *path, size_t size_bytes) {
  const char *slash = strrchr(model_path, '/');
  const int folder = name[0] == '/' || !slash ? 0 : (int)(slash - model_path) + 1;
  snprintf(path, size_bytes, "%.*s%s", folder, model_path, name);
  if (access(path, R_OK) == 0) return;
  char *out = path + folder;
  for (const char *in = out; *in; ++in, ++out) {
    const char escaped = escaped_byte(in);
    *out = escaped ? escaped : *in == '\\' ? '/' : *in;
    if (escaped) in += 2;
  }
  *out = 0;
}

typedef struct file_identity {
  dev_t device;
  ino_t inode;
} file_identity;

// The state of reading one model.
typedef struct model_reader {
  struct aiFileIO io;
  const char *path;
  olx_scene *scene;
  file_identity *seen; // files read so far, except the model's own
  uint32_t seen_count;
  uint64_t materials; // number of materials that material files define
  olx_result result;  // the first error; its message is the last error
} model_reader;

// A file that Assimp has opened.
typedef struct open_file {
  struct aiFile file;
  olx_mapped_file mapped;
  const char *data;
  size_t size_bytes, position;
} open_file;

static size_t read_some(struct aiFile *file, char *buffer, size_t size, size_t count) {
  open_file *open = (open_file *)(void *)file->UserData;
  if (!size) return 0;
  const size_t left = (open->size_bytes - open->position) / size, taken = count < left ? count : left;
  if (taken) memcpy(buffer, open->data + open->position, taken * size);
  open->position += taken * size;
  return taken;
}

static size_t write_nothing(struct aiFile *file, const char *buffer, size_t size, size_t count) {
  (void)file, (void)buffer, (void)size, (void)count;
  return 0;
}

static size_t tell_position(struct aiFile *file) { return ((open_file *)(void *)file->UserData)->position; }

static size_t tell_size(struct aiFile *file) { return ((open_file *)(void *)file->UserData)->size_bytes; }

static void flush_nothing(struct aiFile *file) { (void)file; }

static enum aiReturn seek_to(struct aiFile *file, size_t offset, enum aiOrigin origin) {
  open_file *open = (open_file *)(void *)file->UserData;
  const size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? open->position : open->size_bytes;
  const size_t position = base + offset; // a negative offset wraps around to the intended position
  if (position > open->size_bytes) return aiReturn_FAILURE;
  open->position = position;
  return aiReturn_SUCCESS;
}

// Checks a material file: properties before the first material crash Assimp, and every material costs it tens of
// kilobytes.
static olx_result check_material_file(model_reader *reader, const char *path, const open_file *file) {
  const char *line = file->data, *const end = line + file->size_bytes;
  bool begun = false;
  for (unsigned number = 1; line < end; ++number) {
    const char *stop = memchr(line, '\n', (size_t)(end - line));
    if (!stop) stop = end;
    while (line < stop && isspace((unsigned char)*line)) ++line;
    const bool material = stop - line >= 7 && memcmp(line, "newmtl", 6) == 0;
    if (line < stop && *line != '#' && !begun && !material) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: line %u: expected newmtl before anything else", path, number);
    }
    begun |= material;
    reader->materials += material;
    line = stop + 1;
  }
  return olx_import_check_limit(reader->scene, OLX_LIMIT_MATERIALS, reader->scene->material_count + reader->materials,
                                path, "newmtl");
}

// Finds whether a file has been read before; marks it as read.
static olx_result note_file(model_reader *reader, const char *path, bool *before) {
  struct stat status;
  *before = false;
  if (stat(path, &status) != 0) return olx_fail(OLX_ERROR_FILE, "%s: cannot be read", path);
  for (uint32_t i = 0; i < reader->seen_count; ++i) {
    *before |= reader->seen[i].device == status.st_dev && reader->seen[i].inode == status.st_ino;
  }
  if (*before) return OLX_OK;
  const uint32_t count = reader->seen_count;
  if ((count & (count - 1)) == 0) { // grows the capacity to the next power of two
    file_identity *grown = olx_allocate(count ? (size_t)count * 2 : 1, sizeof *grown);
    if (!grown) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
    if (count) memcpy(grown, reader->seen, count * sizeof *grown);
    olx_release(reader->seen);
    reader->seen = grown;
  }
  reader->seen[reader->seen_count++] = (file_identity){status.st_dev, status.st_ino};
  return OLX_OK;
}

static olx_result check_opened(model_reader *reader, const char *path, open_file *file) {
  if (strcmp(path, reader->path) == 0) return OLX_OK;
  bool before;
  const uint64_t materials = reader->materials;
  OLX_TRY(note_file(reader, path, &before));
  if (!before) OLX_TRY(check_material_file(reader, path, file));
  if (reader->materials > materials && file->size_bytes >= LEAST_TEXT) return OLX_OK;
  // A file whose materials are known, or that is too short to name one, is replaced by a comment.
  static const char nothing[] = "# no further materials\n";
  file->data = nothing;
  file->size_bytes = sizeof nothing - 1;
  return OLX_OK;
}

static void close_opened(open_file *file) {
  olx_unmap_file(&file->mapped);
  olx_release(file);
}

static struct aiFile *open_for_assimp(struct aiFileIO *io, const char *path, const char *mode) {
  model_reader *reader = (model_reader *)(void *)io->UserData;
  if (reader->result != OLX_OK || strchr(mode, 'w') || access(path, R_OK) != 0) return NULL;
  if (strcmp(path, reader->path) != 0) reader->result = olx_model_file_check(reader->scene, reader->path, path);
  open_file *file = reader->result == OLX_OK ? olx_allocate_zero(1, sizeof *file) : NULL;
  if (!file) return NULL;
  file->file = (struct aiFile){.ReadProc = read_some,
                               .WriteProc = write_nothing,
                               .TellProc = tell_position,
                               .FileSizeProc = tell_size,
                               .SeekProc = seek_to,
                               .FlushProc = flush_nothing,
                               .UserData = (aiUserData)(void *)file};
  reader->result = olx_map_file(path, &file->mapped);
  file->data = file->mapped.data;
  file->size_bytes = file->mapped.size_bytes;
  if (reader->result == OLX_OK) reader->result = olx_scene_note_source(reader->scene, path);
  if (reader->result == OLX_OK) reader->result = check_opened(reader, path, file);
  if (reader->result == OLX_OK) return &file->file;
  close_opened(file);
  return NULL;
}

static void close_for_assimp(struct aiFileIO *io, struct aiFile *file) {
  (void)io;
  close_opened((open_file *)(void *)file->UserData);
}

olx_result olx_model_read(const char *path, unsigned steps, olx_scene *scene, const struct aiScene **source) {
  // Guards Assimp's global error string.
  static pthread_mutex_t assimp_lock = PTHREAD_MUTEX_INITIALIZER;
  char error[512] = "";
  model_reader reader = {.path = path, .scene = scene};
  reader.io = (struct aiFileIO){
      .OpenProc = open_for_assimp, .CloseProc = close_for_assimp, .UserData = (aiUserData)(void *)&reader};
  pthread_mutex_lock(&assimp_lock);
  *source = aiImportFileEx(path, steps, &reader.io);
  if (!*source) snprintf(error, sizeof error, "%.400s", aiGetErrorString());
  pthread_mutex_unlock(&assimp_lock);
  olx_release(reader.seen);
  if (reader.result != OLX_OK) {
    if (*source) aiReleaseImport(*source);
    *source = NULL;
    return reader.result;
  }
  for (char *c = error; *c; ++c) {
    if (*c == '\n' || *c == '\r') *c = ' ';
  }
  if (*source) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: cannot be read: %s", path, error[0] ? error : "no reason given");
}
