#!/usr/bin/env bash
# limited.sh SECONDS COMMAND...: run a command of which no process may use more than so many seconds of processor time,
# which other work on the machine lengthens little. What waits without working is for the caller to end.
ulimit -S -t "$1" && shift && exec "$@"
