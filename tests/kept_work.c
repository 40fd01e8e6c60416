// Bakes a square under a lamp into a kept work folder, and reads and replaces the files of that folder. What is kept is
// small, because fuzzers change it thousands of times.
#include "kept_work.h"

#include <octalux/bake.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char scene_text[] =
    "{\"model\": \"square.obj\", \"lights\": [{\"type\": \"point\", \"position\": [0.5, 0.5, 0.4], "
    "\"intensity\": [1, 1, 1]}]}";

static void path_in(const scene_folder *folder, const char *name, char path[700]) {
  snprintf(path, 700, "%s/work%s%s", folder->path, name[0] ? "/" : "", name);
}

olx_result kept_work_bake(const scene_folder *folder) {
  char work[700], output[700];
  olx_scene *scene;
  path_in(folder, "", work);
  snprintf(output, sizeof output, "%s/kept.olx", folder->path);
  scene_folder_write_text(folder, "square.obj", scene_files_obj);
  olx_result result = olx_scene_load(scene_folder_write_text(folder, "kept.json", scene_text), &scene);
  if (result != OLX_OK) return result;
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = (olx_grid){.origin = {0.5f, 0.5f, 0.3f}, .spacing = {1, 1, 1}, .count = {1, 1, 1}};
  settings.radiance_size = 16;
  settings.volume_cells = 4;
  settings.noise = 1.0f;
  settings.threads = 1;
  settings.work = (olx_bake_work){.folder = work, .keep = true};
  result = olx_bake(scene, &settings, output, NULL, NULL);
  olx_scene_free(scene);
  return result;
}

static bool read_file(const char *path, kept_work_file *file) {
  struct stat status;
  FILE *stream = fopen(path, "rb");
  if (!stream || fstat(fileno(stream), &status) != 0) return false;
  file->size_bytes = (size_t)status.st_size;
  file->bytes = malloc(file->size_bytes + 1);
  const bool whole = file->bytes && fread(file->bytes, 1, file->size_bytes, stream) == file->size_bytes;
  return fclose(stream) == 0 && whole;
}

static int by_name(const void *a, const void *b) {
  return strcmp(((const kept_work_file *)a)->name, ((const kept_work_file *)b)->name);
}

bool kept_work_read(const scene_folder *folder, kept_work *work) {
  char path[700];
  path_in(folder, "", path);
  DIR *directory = opendir(path);
  bool whole = directory != NULL;
  *work = (kept_work){.count = 0};
  for (const struct dirent *entry; whole && (entry = readdir(directory));) {
    if (entry->d_name[0] == '.') continue;
    kept_work_file *file = &work->files[work->count];
    whole = work->count < KEPT_WORK_FILES && strlen(entry->d_name) < sizeof file->name;
    if (!whole) break;
    strcpy(file->name, entry->d_name);
    path_in(folder, file->name, path);
    whole = read_file(path, file);
    work->count++;
  }
  if (directory) closedir(directory);
  qsort(work->files, work->count, sizeof *work->files, by_name);
  return whole;
}

void kept_work_free(kept_work *work) {
  for (uint32_t i = 0; i < work->count; i++) free(work->files[i].bytes);
  *work = (kept_work){.count = 0};
}

static void empty_folder(const scene_folder *folder) {
  char path[700];
  path_in(folder, "", path);
  DIR *directory = opendir(path);
  for (const struct dirent *entry; directory && (entry = readdir(directory));) {
    char file[700];
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
    path_in(folder, entry->d_name, file);
    unlink(file);
  }
  if (directory) closedir(directory);
}

void kept_work_remove(const scene_folder *folder) {
  char path[700];
  path_in(folder, "", path);
  empty_folder(folder);
  rmdir(path);
}

static bool write_file(const char *path, const uint8_t *bytes, size_t size_bytes) {
  FILE *stream = fopen(path, "wb");
  const bool written = stream && fwrite(bytes, 1, size_bytes, stream) == size_bytes;
  return stream && fclose(stream) == 0 && written;
}

bool kept_work_write(const scene_folder *folder, const kept_work *work, uint32_t changed, const uint8_t *bytes,
                     size_t size_bytes) {
  char path[700];
  path_in(folder, "", path);
  empty_folder(folder);
  mkdir(path, 0700);
  bool written = true;
  for (uint32_t i = 0; i < work->count && written; i++) {
    const kept_work_file *file = &work->files[i];
    path_in(folder, file->name, path);
    written = write_file(path, i == changed ? bytes : file->bytes, i == changed ? size_bytes : file->size_bytes);
  }
  return written;
}
