#!/usr/bin/env bash
# limited.sh SECONDS COMMAND...: runs a command none of whose processes may use more than so many seconds of processor
# time, which other work on the machine lengthens little. The caller has to end a process that waits without working.
ulimit -S -t "$1" && shift && exec "$@"
