// Finds how much memory and disk space there is, from Linux; where Linux does not report it, no bake is refused.
#include "bake/cost/available.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

// Code and tables of the program and its libraries that a bake reads: 12 MiB were measured.
enum { PROGRAM_KIBIBYTES = 16 << 10 };

// Reads the number that a file holds; UINT64_MAX when the file holds no number but "max".
static uint64_t number_in(const char *path) {
  FILE *file = fopen(path, "r");
  unsigned long long number = 0;
  const bool found = file && fscanf(file, "%llu", &number) == 1;
  if (file) fclose(file);
  return found ? number : UINT64_MAX;
}

static uint64_t machine_memory(void) {
  FILE *file = fopen("/proc/meminfo", "r");
  char line[128];
  unsigned long long kibibytes;
  uint64_t bytes = UINT64_MAX;
  while (file && bytes == UINT64_MAX && fgets(line, sizeof line, file)) {
    if (sscanf(line, "MemAvailable: %llu kB", &kibibytes) == 1) bytes = (uint64_t)kibibytes * 1024;
  }
  if (file) fclose(file);
  return bytes;
}

// Returns the bytes of files that the control group holds in memory, and that give way to programs.
static uint64_t cached_files(const char *folder) {
  char path[PATH_MAX], line[128];
  unsigned long long bytes, sum = 0;
  snprintf(path, sizeof path, "%s/memory.stat", folder);
  FILE *file = fopen(path, "r");
  while (file && fgets(line, sizeof line, file)) {
    if (sscanf(line, "active_file %llu", &bytes) == 1 || sscanf(line, "inactive_file %llu", &bytes) == 1) sum += bytes;
  }
  if (file) fclose(file);
  return sum;
}

uint64_t olx_available_to_group(const char *folder) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/memory.max", folder);
  const uint64_t most = number_in(path);
  snprintf(path, sizeof path, "%s/memory.current", folder);
  const uint64_t used = number_in(path), cached = cached_files(folder);
  if (most == UINT64_MAX || used == UINT64_MAX) return UINT64_MAX;
  const uint64_t kept = used > cached ? used - cached : 0;
  return kept < most ? most - kept : 0;
}

uint64_t olx_available_memory(void) {
  const uint64_t machine = machine_memory(), group = olx_available_to_group("/sys/fs/cgroup");
  return group < machine ? group : machine;
}

olx_process_memory olx_own_memory(void) {
  FILE *file = fopen("/proc/self/status", "r");
  char line[128];
  unsigned long long kibibytes, most = 0, anonymous = 0, files = 0, shared = 0;
  while (file && fgets(line, sizeof line, file)) {
    if (sscanf(line, "VmHWM: %llu kB", &kibibytes) == 1) most = kibibytes;
    if (sscanf(line, "RssAnon: %llu kB", &kibibytes) == 1) anonymous = kibibytes;
    if (sscanf(line, "RssFile: %llu kB", &kibibytes) == 1) files = kibibytes;
    if (sscanf(line, "RssShmem: %llu kB", &kibibytes) == 1) shared = kibibytes;
  }
  if (file) fclose(file);
  if (anonymous && files < PROGRAM_KIBIBYTES) files = PROGRAM_KIBIBYTES;
  return (olx_process_memory){(anonymous + files + shared) * 1024, most * 1024};
}

uint64_t olx_available_disk(const char *path) {
  struct stat status;
  struct statvfs system;
  char folder[4096];
  if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) return UINT64_MAX;
  const char *slash = strrchr(path, '/');
  snprintf(folder, sizeof folder, "%.*s", !slash || slash == path ? 1 : (int)(slash - path), slash ? path : ".");
  if (statvfs(folder, &system) != 0) return UINT64_MAX;
  return (uint64_t)system.f_bavail * system.f_frsize;
}
