// Handles the signals that end the program on a thread, so that the reaction is ordinary code rather than a signal
// handler.
#include "stop.h"

#include "clock.h"
#include "options.h"

#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// Time that work has to end by itself. It is extended on a busy machine, where the work gets little processor time, but
// not when the work uses none, because then it waits for something.
#define PATIENCE_SECONDS 0.7
#define MOST_PATIENCE_SECONDS 5.0
#define BUSY_SECONDS 0.35 // seconds of processor time
#define WAITING_SECONDS 0.01

// The state of signals, which exists once per process.
static struct {
  const char *command;
  sigset_t signals, usual;
  atomic_int signal;
  atomic_bool working;
  pthread_mutex_t folder_lock;
  char folder[4096];
} stop = {.folder_lock = PTHREAD_MUTEX_INITIALIZER};

static void remove_folder(void) {
  pthread_mutex_lock(&stop.folder_lock);
  DIR *entries = stop.folder[0] ? opendir(stop.folder) : NULL;
  for (struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
    unlinkat(dirfd(entries), entry->d_name, 0); // fails for the folder itself and its parent
  }
  if (entries) closedir(entries);
  if (stop.folder[0]) rmdir(stop.folder);
  pthread_mutex_unlock(&stop.folder_lock);
}

_Noreturn static void leave_at_once(void) {
  char line[128];
  remove_folder();
  // Written without stdio streams, because another thread may hold their locks.
  const int length = snprintf(line, sizeof line, "%s%.64s: interrupted\n", program_prefix(stop.command), stop.command);
  (void)!write(STDERR_FILENO, line, (size_t)length);
  _exit(128 + stop.signal);
}

// Waits as long as the work, while `working`, may continue; returns false when another signal arrives.
static bool wait_while(bool working) {
  const struct timespec slice = {.tv_nsec = 20000000L};
  const double start = clock_seconds(CLOCK_MONOTONIC), spent = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  while (stop.working == working) {
    if (sigtimedwait(&stop.signals, NULL, &slice) >= 0) return false;
    const double waited = clock_seconds(CLOCK_MONOTONIC) - start;
    const double used = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - spent;
    if (waited < PATIENCE_SECONDS) continue;
    if (waited > MOST_PATIENCE_SECONDS || used > BUSY_SECONDS || used < WAITING_SECONDS) return false;
  }
  return true;
}

static void *wait_for_signal(void *user) {
  (void)user;
  int number = 0;
  while (sigwait(&stop.signals, &number) != 0) {}
  stop.signal = number;
  // Work that has ended by itself gets the same time again to exit.
  if (stop.working && wait_while(true)) wait_while(false);
  leave_at_once();
}

void stop_watch(const char *command) {
  pthread_t thread;
  struct sigaction before;
  stop.command = command;
  sigemptyset(&stop.signals);
  sigaddset(&stop.signals, SIGINT);
  sigaddset(&stop.signals, SIGTERM);
  // Under nohup, SIGHUP stays ignored.
  if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN) sigaddset(&stop.signals, SIGHUP);
  // Shells ignore SIGINT for background programs, and an ignored signal would never be received.
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
  signal(SIGXFSZ, SIG_IGN); // exceeding the limit of a file's size becomes a write error with a message
  pthread_sigmask(SIG_BLOCK, &stop.signals, &stop.usual);
  if (pthread_create(&thread, NULL, wait_for_signal, NULL) == 0) pthread_detach(thread);
  else pthread_sigmask(SIG_SETMASK, &stop.usual, NULL);
}

void stop_hand_over(void) {
  signal(SIGXFSZ, SIG_DFL);
  pthread_sigmask(SIG_SETMASK, &stop.usual, NULL);
}

void stop_work_begin(void) { stop.working = true; }
void stop_work_end(void) { stop.working = false; }

bool stop_requested(void) { return stop.signal != 0; }

int stop_exit_code(int code) { return stop_requested() && code != 0 ? 128 + stop.signal : code; }

void stop_remove_folder(const char *path) {
  pthread_mutex_lock(&stop.folder_lock);
  snprintf(stop.folder, sizeof stop.folder, "%s", path ? path : "");
  pthread_mutex_unlock(&stop.folder_lock);
}
