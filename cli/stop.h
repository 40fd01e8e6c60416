// Stops on signals: SIGINT, SIGTERM and SIGHUP end every command within a second, with exit code 128 + the signal's
// number.
//
// A thread waits for signals. Work that can be cancelled is cancelled and ends in order; work that cannot, or that
// takes too long, is ended at once, after clean-up. A second signal ends the program at once as well.
#ifndef OCTALUX_CLI_STOP_H
#define OCTALUX_CLI_STOP_H

#include <stdbool.h>

// Begins to wait for signals, in the name of a command. The caller calls this before it starts any other thread.
void stop_watch(const char *command);

// Restores the default handling of signals, before another program replaces this one.
void stop_hand_over(void);

// Mark the beginning and the end of work that queries stop_requested often enough to end by itself.
void stop_work_begin(void);
void stop_work_end(void);

// Returns whether a signal was received.
bool stop_requested(void);

// Returns the exit code: 128 + the signal's number when a signal kept the work from being finished (`code` is not 0),
// otherwise `code`.
int stop_exit_code(int code);

// Registers a temporary folder, which is removed with its files when the program is ended at once. With NULL there is
// no such folder. The path is copied.
void stop_remove_folder(const char *path);

#endif
