// A limit on what a piece of work may take: a signal after seconds of this process's processor time, which other work
// on the machine does not use up.
#pragma once

#include <signal.h>
#include <sys/time.h>

enum { PROCESSOR_ALARM = SIGPROF };

// Raises PROCESSOR_ALARM after so many seconds from now, and only then; 0 seconds call it off.
static inline void set_processor_alarm(unsigned seconds) {
  setitimer(ITIMER_PROF, &(struct itimerval){.it_value = {.tv_sec = (time_t)seconds}}, NULL);
}
