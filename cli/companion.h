// Programs of ours that lie beside each other: one hands over to another.
#ifndef OCTALUX_CLI_COMPANION_H
#define OCTALUX_CLI_COMPANION_H

// Runs a program beside this one in its place; argv[0] is replaced. Returns only when that fails: an exit code, after a
// line that says why. `missing` is what is wrong when it is not there.
int start_companion(const char *command, const char *program, const char *missing, char **argv);

#endif
