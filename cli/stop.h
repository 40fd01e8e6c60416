// Stopping on a signal: SIGINT, SIGTERM and SIGHUP end every command within a second, with exit code 128 + the signal's
// number.
//
// A thread waits for them. Work that can be cancelled is, and ends in good order; what cannot, or takes too long, is
// left at once, after tidying. A second signal leaves at once, too.
#ifndef OCTALUX_CLI_STOP_H
#define OCTALUX_CLI_STOP_H

#include <stdbool.h>

// Begin to wait for signals, in the name of a command. Before any other thread is started.
void stop_watch(const char *command);

// Give signals their usual meaning back, before another program takes over.
void stop_hand_over(void);

// Between these two the work queries stop_requested often enough to end by itself.
void stop_work_begin(void);
void stop_work_end(void);

// Whether a signal came.
bool stop_requested(void);

// The exit code: 128 + the signal's number when one came, else `code`.
int stop_exit_code(int code);

// A temporary folder that goes, with the files in it, when the program is left at once. NULL: none any more. The path
// is copied.
void stop_remove_folder(const char *path);

#endif
