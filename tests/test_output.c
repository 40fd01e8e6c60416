// Tests outputs: what may be written and how, what remains when a program dies while it writes, and what happens to
// files that are replaced. All tests of temporary files use unnamed and named ones.
#include "core/file.h"
#include "core/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

// When it is true, openat, which replaces the C library's, behaves as on a file system without unnamed files.
static bool without_unnamed;

int openat(int folder, const char *path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if (without_unnamed && (flags & O_TMPFILE) == O_TMPFILE) {
    errno = EOPNOTSUPP;
    return -1;
  }
  return (int)syscall(SYS_openat, folder, path, flags, mode);
}

typedef struct folder {
  char path[200], file[256], other[256];
} folder;

static int create_folder(void **state) {
  folder *f = calloc(1, sizeof *f);
  const char *base = getenv("TMPDIR");
  snprintf(f->path, sizeof f->path, "%s/octalux-output-XXXXXX", base && *base ? base : "/tmp");
  if (!f || !mkdtemp(f->path)) return -1;
  snprintf(f->file, sizeof f->file, "%s/out.bin", f->path);
  snprintf(f->other, sizeof f->other, "%s/other.bin", f->path);
  without_unnamed = false;
  *state = f;
  return 0;
}

static int create_folder_named(void **state) {
  const int result = create_folder(state);
  without_unnamed = true;
  return result;
}

// Counts the entries of the folder, including hidden ones; `remove` unlinks them.
static uint32_t list_entries(const folder *f, bool remove) {
  uint32_t count = 0;
  DIR *entries = opendir(f->path);
  assert_non_null(entries);
  for (struct dirent *entry; (entry = readdir(entries));) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
    if (remove) unlinkat(dirfd(entries), entry->d_name, 0);
    count++;
  }
  closedir(entries);
  return count;
}

static int remove_folder(void **state) {
  folder *f = *state;
  list_entries(f, true);
  rmdir(f->path);
  free(f);
  return 0;
}

static void assert_content(const char *path, const char *wanted) {
  char content[64] = "";
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  const size_t length = fread(content, 1, sizeof content - 1, file);
  assert_int_equal(fclose(file), 0);
  content[length] = 0;
  assert_string_equal(content, wanted);
}

static void assert_refused(const char *path, bool in_order, const char *why) {
  olx_output_file file;
  assert_int_equal(olx_output_check(path, in_order), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), why));
  const olx_result result = in_order ? olx_output_open_in_order(path, &file) : olx_output_open(path, &file);
  assert_int_equal(result, OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), why));
}

static olx_result write_text(const char *path, const char *text) { return olx_write_file(path, text, strlen(text)); }

// ---- what is written

static void a_character_device_is_written_and_stays(void **state) {
  const folder *f = *state;
  struct stat status;
  // Root makes a null device for the test; other users write to the system's, which they cannot replace in any case.
  const bool own = mknod(f->file, S_IFCHR | 0666, makedev(1, 3)) == 0 && open(f->file, O_WRONLY | O_CLOEXEC) >= 0;
  const char *path = own ? f->file : "/dev/null";
  assert_int_equal(olx_output_check(path, true), OLX_OK);
  assert_int_equal(write_text(path, "gone"), OLX_OK);
  assert_int_equal(stat(path, &status), 0);
  assert_true(S_ISCHR(status.st_mode));
  assert_refused(path, false, "character device");
  assert_int_equal(write_text("/dev/full", "too much"), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "/dev/full: cannot write: No space left"));
}

static void *read_pipe(void *user) {
  char *text = user;
  const int descriptor = open(text, O_RDONLY | O_CLOEXEC);
  const ssize_t length = read(descriptor, text, 63);
  text[length > 0 ? length : 0] = 0;
  close(descriptor);
  return NULL;
}

static void a_pipe_is_written_and_stays(void **state) {
  const folder *f = *state;
  char text[256];
  pthread_t reader;
  struct stat status;
  snprintf(text, sizeof text, "%s", f->file);
  assert_int_equal(mkfifo(f->file, 0666), 0);
  assert_refused(f->file, false, "it is a pipe, and this format is not written in order");
  assert_int_equal(pthread_create(&reader, NULL, read_pipe, text), 0);
  assert_int_equal(write_text(f->file, "through"), OLX_OK);
  pthread_join(reader, NULL);
  assert_string_equal(text, "through");
  assert_int_equal(stat(f->file, &status), 0);
  assert_true(S_ISFIFO(status.st_mode));
}

static void standard_output_is_written(void **state) {
  const folder *f = *state;
  fflush(stdout);
  const int kept = dup(STDOUT_FILENO), redirected = open(f->other, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  assert_true(dup2(redirected, STDOUT_FILENO) >= 0);
  const olx_result checked = olx_output_check("-", true), first = write_text("-", "one, "),
                   second = write_text("-", "two");
  dup2(kept, STDOUT_FILENO);
  close(kept);
  close(redirected);
  assert_true(checked == OLX_OK && first == OLX_OK && second == OLX_OK);
  assert_content(f->other, "one, two");
  assert_refused("-", false, "standard output: cannot write: this format is not written in order");
  assert_int_equal(access("-", F_OK), -1);
}

static void folders_devices_and_sockets_are_refused(void **state) {
  const folder *f = *state;
  assert_refused(f->path, true, "it is a folder");
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  memcpy(address.sun_path, f->other, strnlen(f->other, sizeof address.sun_path - 1));
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  assert_int_equal(bind(listener, (const struct sockaddr *)&address, sizeof address), 0);
  assert_refused(f->other, true, "it is a socket");
  close(listener);
  if (mknod(f->file, S_IFBLK | 0666, makedev(7, 200)) != 0) return; // only root can make a device
  assert_refused(f->file, true, "it is a block device");
  assert_refused(f->file, false, "it is a block device");
}

// ---- links, owners and rights

static void links_are_followed(void **state) {
  const folder *f = *state;
  char link[300], chain[300];
  struct stat status;
  snprintf(link, sizeof link, "%s/link", f->path);
  snprintf(chain, sizeof chain, "%s/chain", f->path);
  assert_int_equal(symlink("out.bin", link), 0);
  assert_int_equal(symlink(link, chain), 0);
  assert_int_equal(write_text(chain, "made"), OLX_OK); // the link's target does not exist yet
  assert_content(f->file, "made");
  assert_int_equal(write_text(chain, "replaced"), OLX_OK);
  assert_content(f->file, "replaced");
  assert_int_equal(lstat(link, &status), 0);
  assert_true(S_ISLNK(status.st_mode));
  assert_int_equal(lstat(chain, &status), 0);
  assert_true(S_ISLNK(status.st_mode));
  assert_int_equal(list_entries(f, false), 3);
}

static void links_in_a_circle_are_refused(void **state) {
  const folder *f = *state;
  assert_int_equal(symlink("other.bin", f->file), 0);
  assert_int_equal(symlink("out.bin", f->other), 0);
  assert_refused(f->file, false, "out.bin: cannot write: Too many levels of symbolic links");
}

static void mode_and_owner_of_a_replaced_file_are_kept(void **state) {
  const folder *f = *state;
  const mode_t modes[] = {0600, 0644, 0666, 0751};
  for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
    struct stat status;
    assert_int_equal(write_text(f->file, "old"), OLX_OK);
    assert_int_equal(chmod(f->file, modes[i]), 0);
    const bool given = chown(f->file, 1234, 5678) == 0; // only root can give files away
    assert_int_equal(write_text(f->file, "new"), OLX_OK);
    assert_int_equal(stat(f->file, &status), 0);
    assert_int_equal(status.st_mode & 07777, modes[i]);
    assert_int_equal(status.st_uid, given ? 1234 : geteuid());
    if (given) assert_int_equal(status.st_gid, 5678);
    assert_content(f->file, "new");
  }
}

static void what_is_unfinished_is_no_more_public_than_what_it_replaces(void **state) {
  const folder *f = *state;
  olx_output_file file;
  struct stat status;
  assert_int_equal(write_text(f->file, "secret"), OLX_OK);
  assert_int_equal(chmod(f->file, 0600), 0);
  assert_int_equal(olx_output_open(f->file, &file), OLX_OK);
  assert_int_equal(fstat(file.descriptor, &status), 0);
  assert_int_equal(status.st_mode & 0777, 0600);
  olx_output_discard(&file);
}

static void the_same_file_is_found_by_device_and_inode(void **state) {
  const folder *f = *state;
  char link[300];
  snprintf(link, sizeof link, "%s/link", f->path);
  assert_false(olx_same_file(f->file, f->file)); // no file exists yet
  assert_int_equal(write_text(f->file, "a"), OLX_OK);
  assert_int_equal(write_text(f->other, "a"), OLX_OK);
  assert_int_equal(symlink("out.bin", link), 0);
  assert_true(olx_same_file(f->file, f->file));
  assert_true(olx_same_file(f->file, link));
  assert_false(olx_same_file(f->file, f->other));
  assert_int_equal(unlink(f->other), 0);
  assert_int_equal(linkat(AT_FDCWD, f->file, AT_FDCWD, f->other, 0), 0);
  assert_true(olx_same_file(f->file, f->other));
  assert_false(olx_same_file("/dev/null", "/dev/null")); // writing to a device destroys nothing
}

// ---- temporary files

static void die_in_the_midst(const folder *f, int signal_number) {
  const pid_t child = fork();
  if (child == 0) {
    olx_output_file file;
    if (olx_output_open(f->file, &file) != OLX_OK || olx_output_write(&file, "half", 4) != OLX_OK) _exit(1);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
    _exit(2);
  }
  int status;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFSIGNALED(status));
  assert_int_equal(WTERMSIG(status), signal_number);
}

static void a_killed_writer_leaves_nothing(void **state) {
  const folder *f = *state;
  const int signals[] = {SIGKILL, SIGHUP, SIGXFSZ};
  assert_int_equal(write_text(f->file, "old"), OLX_OK);
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
    die_in_the_midst(f, signals[i]);
    assert_content(f->file, "old");
    if (!without_unnamed) assert_int_equal(list_entries(f, false), 1);
  }
  // A file with a temporary name is removed by the next output in the folder.
  assert_int_equal(write_text(f->other, "next"), OLX_OK);
  assert_int_equal(list_entries(f, false), 2);
}

static void a_living_writer_keeps_its_file(void **state) {
  const folder *f = *state;
  olx_output_file file;
  assert_int_equal(olx_output_open(f->file, &file), OLX_OK);
  assert_int_equal(olx_output_write(&file, "whole", 5), OLX_OK);
  for (int i = 0; i < 3; i++) assert_int_equal(write_text(f->other, "another"), OLX_OK);
  assert_int_equal(olx_output_commit(&file), OLX_OK);
  assert_content(f->file, "whole");
  assert_int_equal(list_entries(f, false), 2);
}

// A program that is killed between linking and renaming leaves a file with such a name. Another machine's may be in use:
// not all file systems that machines share know each other's locks.
static void only_temporary_files_of_ours_are_reclaimed(void **state) {
  const folder *f = *state;
  char stale[32], another_machines[32];
  olx_temporary_name(0, another_machines);
  another_machines[sizeof ".octalux-" - 1] ^= 1; // a digit of the machine
  const char *const kept[] = {".octalux-0123abc.tmp", ".octalux-0123abcX.tmp",  ".octalux-0123abcd.tmp2",
                              "octalux-0123abcd.tmp", ".octalux-0123abcde.tmp", "out.tmp-0123abcd",
                              another_machines};
  char path[300];
  olx_temporary_name(0, stale);
  snprintf(path, sizeof path, "%s/%s", f->path, stale);
  assert_int_equal(write_text(path, "stale"), OLX_OK);
  for (size_t i = 0; i < sizeof kept / sizeof *kept; i++) {
    snprintf(path, sizeof path, "%s/%s", f->path, kept[i]);
    assert_int_equal(write_text(path, "kept"), OLX_OK);
  }
  snprintf(path, sizeof path, "%s/.octalux-89abcdef.tmp", f->path); // a link is neither followed nor removed
  assert_int_equal(symlink(kept[0], path), 0);
  assert_int_equal(write_text(f->file, "next"), OLX_OK);
  assert_int_equal(list_entries(f, false), sizeof kept / sizeof *kept + 2);
  snprintf(path, sizeof path, "%s/%s", f->path, stale);
  assert_int_equal(access(path, F_OK), -1);
}

static void names_of_any_length_can_be_written(void **state) {
  const folder *f = *state;
  char path[600];
  snprintf(path, sizeof path, "%s/%0255d", f->path, 7);
  assert_int_equal(write_text(path, "long"), OLX_OK);
  assert_content(path, "long");
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, create_folder, remove_folder)
#define BOTH_WAYS(test)                                                                                                \
  IN_FOLDER(test), { #test " (named)", test, create_folder_named, remove_folder, NULL }

int main(void) {
  const struct CMUnitTest tests[] = {
      IN_FOLDER(a_character_device_is_written_and_stays),
      IN_FOLDER(a_pipe_is_written_and_stays),
      IN_FOLDER(standard_output_is_written),
      IN_FOLDER(folders_devices_and_sockets_are_refused),
      IN_FOLDER(links_in_a_circle_are_refused),
      IN_FOLDER(the_same_file_is_found_by_device_and_inode),
      BOTH_WAYS(links_are_followed),
      BOTH_WAYS(mode_and_owner_of_a_replaced_file_are_kept),
      BOTH_WAYS(what_is_unfinished_is_no_more_public_than_what_it_replaces),
      BOTH_WAYS(a_killed_writer_leaves_nothing),
      BOTH_WAYS(a_living_writer_keeps_its_file),
      BOTH_WAYS(only_temporary_files_of_ours_are_reclaimed),
      BOTH_WAYS(names_of_any_length_can_be_written),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
