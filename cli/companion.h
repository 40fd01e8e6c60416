// Starts programs of the project that are installed beside each other.
#ifndef OCTALUX_CLI_COMPANION_H
#define OCTALUX_CLI_COMPANION_H

// Replaces this process by a program beside it; argv[0] is replaced. Returns only on failure: an exit code, after a
// line with the reason. `missing` is the message when the program does not exist.
int start_companion(const char *command, const char *program, const char *missing, char **argv);

#endif
